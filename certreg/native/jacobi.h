/* Eigenvalues and eigenvectors of a small symmetric matrix. */
#ifndef CERTREG_JACOBI_H
#define CERTREG_JACOBI_H
#include <math.h>

#define CERTREG_NO_TURN 0x1p-70 /* radians, about: of an entry of a unit vector no double has such digits */

/* Columns p and q of an n x n matrix turned in their plane, with `step` n and `along` 1; rows, with 1 and n. */
static inline void certreg_turn_pair(double *a, int n, int p, int q, int step, int along, double c, double s)
{
    for (int i = 0; i < n; i++) {
        double *const one = a + step * i + along * p, *const other = a + step * i + along * q;
        const double x = *one, y = *other;
        *one = c * x - s * y, *other = s * x + c * y;
    }
}

/* Of a symmetric n x n matrix: its eigenvalues on its diagonal, and unit eigenvectors, columns of v, by `sweeps` rounds
 * of Jacobi's rotations. */
static inline __attribute__((always_inline)) void certreg_jacobi(double *a, double *v, int n, int sweeps)
{
    for (int i = 0; i < n * n; i++)
        v[i] = i % (n + 1) == 0;
    for (int sweep = 0; sweep < sweeps; sweep++)
        for (int p = 0; p < n - 1; p++)
            for (int q = p + 1; q < n; q++) {
                const double apart = a[n * q + q] - a[n * p + p], off = 2 * a[n * p + q];
                if (fabs(off) <= CERTREG_NO_TURN * fabs(apart))
                    continue;
                const double theta = apart / off;
                const double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
                const double c = 1 / sqrt(t * t + 1), s = t * c;
                certreg_turn_pair(a, n, p, q, n, 1, c, s);
                certreg_turn_pair(a, n, p, q, 1, n, c, s);
                certreg_turn_pair(v, n, p, q, n, 1, c, s);
            }
}
#endif
