/* Test vectors of the conditions, $header.
 *
 * main returns the number of failures, at most 100. Compile it with ${name}_event.c. */
#include "${name}_event.h"

#include <math.h>
#include <stdio.h>

static const char *const runs[] = {
$runs};

static const struct {
    int run;
    int64_t t;
$fields    int event;
    double expected; /* of truth values 0, 1, 2; NAN is an UNKNOWN number */
} steps[] = {
$steps};

static ${name}_t monitor;

int main(void)
{
    const size_t count = sizeof steps / sizeof steps[0];
    int failures = 0;
    for (size_t k = 0; k < count; k++) {
        if (k == 0 || steps[k].run != steps[k - 1].run) {
            ${name}_reset(&monitor);
        }
        (void)${name}_step(&monitor, steps[k].t$arguments);
        const double got = (double)monitor.$got, expected = steps[k].expected;
        const bool unknown = isnan(got) && isnan(expected);
        if (!unknown && !(fabs(got - expected) <= 1e-9 * fabs(expected))) {
            printf("%s, at %lld ns: expected %.17g, got %.17g\n", runs[steps[k].run],
                   (long long)steps[k].t, expected, got);
            failures++;
        }
    }
    return failures < 100 ? failures : 100;
}
