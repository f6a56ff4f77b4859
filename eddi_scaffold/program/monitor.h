$banner
#ifndef $guard
#define $guard

#include <stdbool.h>
#include <stdint.h>

$types#endif

${enums}typedef struct {
    bool started;
    int64_t last;  /* time of the last step */
    int64_t since; /* time of the first sample of full windows */
    $results
$fields} ${name}_t;

/* Forget everything. Call it before the first step. */
void ${name}_reset(${name}_t *m);

/* One step. ${rate}t_ns: any clock, within +-2^62; the same time again is ignored,
 * an earlier one: the clock went back, all is forgotten first.
 *
$variables *
 * Compile with -ffp-contract=off and without -ffast-math. */
$signature;

#endif
