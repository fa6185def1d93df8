/* The eigenvalues of the pencil (G, J) are those of L^-1 G L^-T, J = L L^T, by Jacobi's rotations. */
#include "pencil.h"
#include "jacobi.h"

#define SWEEPS 10 /* four are usual */

/* A = R(q)^T C, and G of it. */
static void hessian_of(const double q[4], const double c[9], double g[9])
{
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double r[9] = {
        w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y),
        2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x),
        2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z};
    double a[9];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            a[3 * i + j] = r[i] * c[j] + r[3 + i] * c[3 + j] + r[6 + i] * c[6 + j];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            g[3 * i + j] = -(a[3 * i + j] + a[3 * j + i]);
    g[0] = 2 * (a[4] + a[8]), g[4] = 2 * (a[0] + a[8]), g[8] = 2 * (a[0] + a[4]);
}

/* L, row by row; 0 where there is none. */
static int root_of(const double j[6], double l[9])
{
    l[0] = sqrt(j[0]);
    l[3] = j[1] / l[0], l[6] = j[2] / l[0];
    l[4] = sqrt(j[3] - l[3] * l[3]);
    l[7] = (j[4] - l[6] * l[3]) / l[4];
    l[8] = sqrt(j[5] - l[6] * l[6] - l[7] * l[7]);
    return l[0] > 0 && l[4] > 0 && l[8] > 0;
}

/* The columns of a matrix, `along` from entry to entry, become L^-1 times them. */
static void solve(const double l[9], double *rows, int step, int along)
{
    for (int k = 0; k < 3; k++) {
        double *v = rows + step * k;
        v[0] /= l[0];
        v[along] = (v[along] - l[3] * v[0]) / l[4];
        v[2 * along] = (v[2 * along] - l[6] * v[0] - l[7] * v[along]) / l[8];
    }
}

int certreg_pencil(const double q[4], const double cross[9], const double inertia[6], double ratios[3])
{
    double g[9], l[9], vectors[9];
    if (!root_of(inertia, l))
        return 0;
    hessian_of(q, cross, g);
    solve(l, g, 1, 3);
    solve(l, g, 3, 1);
    certreg_jacobi(g, vectors, 3, SWEEPS);
    for (int k = 0; k < 3; k++)
        ratios[k] = g[4 * k];
    for (int k = 0; k < 3; k++) {
        const int i = k % 2;
        const double low = fmin(ratios[i], ratios[i + 1]), high = fmax(ratios[i], ratios[i + 1]);
        ratios[i] = low, ratios[i + 1] = high;
    }
    return 1;
}
