/* What the proofs of many optima and their caller agree on; see native/optima.py. */
#ifndef CERTREG_CERTIFYING_H
#define CERTREG_CERTIFYING_H

#include <stdint.h>

#define CERTREG_MOST_POINTS 65536 /* of a problem that is proved here */

/* A dyadic number is a mantissa and an exponent. */
struct certreg_pairs {
    int64_t count;
    const double *source; /* rows of three, of all problems */
    const double *target;
    const double *weights;
    const int64_t *sizes;  /* count, points */
    const int64_t *starts; /* count x 3: first rows of source, target, weights */
    int64_t *quaternions;  /* count x 4 */
    int64_t *mu;           /* count x 2, dyadic */
    int64_t *delta;
    int64_t *sine;         /* sin^2 of half the angle */
    double *poses;         /* count x 16 */
    uint8_t *proved;       /* count; where it is 0, nothing else is written */
};

void certreg_prove_optima(const struct certreg_pairs *pairs);

#endif
