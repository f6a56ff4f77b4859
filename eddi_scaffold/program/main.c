$banner
#include "${name}_$kind.h"

#include <math.h>
#include <stdio.h>

/* ---- 1. Variables: where the values come from; each is read once in a step ---- */

$stubs/* ---- 4. Main ---- */

/* Wait for the next step and return its time; ends the
 * program by returning false. */
static bool next_step(int64_t *t_ns)
{
$next_step}

static ${name}_t monitor; /* too large for some stacks */

int main(void)
{
    int64_t t = 0;
$declared
    ${name}_reset(&monitor);
    while (next_step(&t)) {
$read        (void)${name}_step(&monitor, $arguments);
$results    }
    return 0;
}
