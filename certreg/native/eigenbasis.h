/* What the fixed-point eigenbasis of eigenbasis.c and its caller agree on. */
#include <stdint.h>

#define CERTREG_FIXED_WORDS 4 /* of 64 bits, low first, in two's complement; three are behind the point */

/* The eigenvalues, descending, then unit eigenvectors row by row of a symmetric 4 x 4 matrix whose largest entry is
 * from 1/2 to 1; upper: what stands on its diagonal and above. 0 where they are left to others: values nearer to
 * each other than 2^-12, or no wide integers. */
int certreg_eigenbasis(const uint64_t *upper, uint64_t *found);
