/* Test vectors, $header.
 *
 * main returns the number of failures, at most 100. Compile it with ${name}_${kind}.c.$missed */
#include "${name}_${kind}.h"

#include <math.h>
#include <stdio.h>

static const char *const runs[] = {
$runs};

/* Run, nanoseconds, result, what is expected, arguments. NAN is an UNKNOWN number. */
static const double steps[][$columns] = {
$steps};

${hazards}int main(void)
{
    static ${name}_t monitor;
    int run = -1, failures = 0;
    for (size_t k = 0; k < sizeof steps / sizeof steps[0]; k++) {
        const double *s = steps[k];
        if (run != (int)s[0]) {
            run = (int)s[0];
            ${name}_reset(&monitor);
        }
        (void)${name}_step(&monitor, (int64_t)s[1]$arguments);
        if (s[2] < 0) {
            continue; /* nothing is expected yet */
        }
        const double got = (double)monitor.$verdict;
        const bool equal = (isnan(got) && isnan(s[3])) || fabs(got - s[3]) <= 1e-9 * fabs(s[3]);
        if (!equal$active) {
            printf("%s, at %.0f ns: expected %.17g, got %.17g\n", runs[run], s[1], s[3], got);
            failures++;
        }
    }
    return failures < 100 ? failures : 100;
}
