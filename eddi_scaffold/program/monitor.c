$banner
#include "${name}_$kind.h"

#include <math.h>
$texts
#ifdef __FAST_MATH__
#error "-ffast-math has no NaN: compile without it"
#endif

${functions}static void forget(${name}_t *m)
{
$forget}

void ${name}_reset(${name}_t *m)
{
    m->started = false;
    m->last = 0;
    m->since = 0;
$reset    forget(m);
}

$signature
{
$body}
