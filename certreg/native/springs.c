/* One pass over points whose springs are matrices, as that of sums.c: points side by side in lanes, 256 of them summed
 * plainly, and such blocks with what rounding takes from each sum kept. */
#include "springs.h"

#include "unpacked.h"

#define BLOCK 256

/* Entries of a row of six in two rows of three: those of point l stand at 2 l and 2 l + 1. */
#define HALVES(l, k) (2 * l + k)

struct block {
    lanes sum[CERTREG_SPRINGS];
};

INLINE void load(const double *from, const double origin[3], lanes out[3])
{
    const char *data = (const char *)from;
    unpack(doubles(data), doubles(data + 8 * LANES), doubles(data + 16 * LANES), out);
    for (int k = 0; k < 3; k++)
        out[k] -= origin[k];
}

/* The six entries of L of LANES points. */
INLINE void load_factors(const double *from, lanes out[6])
{
    static const double none[3] = {0.0, 0.0, 0.0};
    lanes first[3], then[3];
    load(from, none, first);
    load(from + 3 * LANES, none, then);
    for (int k = 0; k < 3; k++) {
        out[k] = PICKED(first[k], then[k], HALVES, 0);
        out[3 + k] = PICKED(first[k], then[k], HALVES, 1);
    }
}

/* Add LANES points. */
INLINE void take(struct block *to, const double *source, const double *target, const double *factors,
                 const double origin[6])
{
    lanes x[3], y[3], l[6], *const sum = to->sum;
    load(source, origin, x);
    load(target, origin + 3, y);
    load_factors(factors, l);
    const lanes w[6] = {l[0] * l[0], l[0] * l[1], l[0] * l[3], l[1] * l[1] + l[2] * l[2],
                        l[1] * l[3] + l[2] * l[4], l[3] * l[3] + l[4] * l[4] + l[5] * l[5]};
    const lanes xx[6] = {x[0] * x[0], x[0] * x[1], x[0] * x[2], x[1] * x[1], x[1] * x[2], x[2] * x[2]};
    const lanes p[3] = {w[0] * y[0] + w[1] * y[1] + w[2] * y[2], w[1] * y[0] + w[3] * y[1] + w[4] * y[2],
                        w[2] * y[0] + w[4] * y[1] + w[5] * y[2]};
    for (int entry = 0; entry < 6; entry++) {
        sum[CERTREG_SPRINGS_STIFFNESS + entry] += w[entry];
        for (int j = 0; j < 3; j++)
            sum[CERTREG_SPRINGS_SOURCE + 3 * entry + j] += w[entry] * x[j];
        for (int jk = 0; jk < 6; jk++)
            sum[CERTREG_SPRINGS_SCATTER + 6 * entry + jk] += w[entry] * xx[jk];
    }
    for (int a = 0; a < 3; a++) {
        sum[CERTREG_SPRINGS_TARGET + a] += p[a];
        for (int k = 0; k < 3; k++)
            sum[CERTREG_SPRINGS_CROSS + 3 * a + k] += p[a] * x[k];
    }
    sum[CERTREG_SPRINGS_SPREAD] += p[0] * y[0] + p[1] * y[1] + p[2] * y[2];
}

/* Add less than LANES points, with others whose springs are zero. */
static void take_last(struct block *to, int64_t n, const double *source, const double *target, const double *factors,
                      const double origin[6])
{
    double x[3 * LANES], y[3 * LANES], l[6 * LANES] = {0.0};
    for (int k = 0; k < 3 * LANES; k++) {
        x[k] = k < 3 * n ? source[k] : origin[k % 3];
        y[k] = k < 3 * n ? target[k] : origin[3 + k % 3];
    }
    memcpy(l, factors, (size_t)(6 * n) * sizeof *l);
    take(to, x, y, l, origin);
}

void certreg_springs(int64_t n, const double *source, const double *target, const double *factors,
                     const double origin[6], double sums[CERTREG_SPRINGS][2])
{
    struct kept total[CERTREG_SPRINGS];
    memset(total, 0, sizeof total);
    for (int64_t first = 0; first < n; first += BLOCK) {
        const int64_t end = n - first < BLOCK ? n : first + BLOCK;
        struct block block;
        int64_t i = first;
        memset(&block, 0, sizeof block);
        for (; i + LANES <= end; i += LANES)
            take(&block, source + 3 * i, target + 3 * i, factors + 6 * i, origin);
        if (i < end)
            take_last(&block, end - i, source + 3 * i, target + 3 * i, factors + 6 * i, origin);
        for (int k = 0; k < CERTREG_SPRINGS; k++)
            keep(&total[k], block.sum[k]);
    }
    for (int k = 0; k < CERTREG_SPRINGS; k++)
        fold(&total[k], sums[k]);
}

void certreg_many_springs(int64_t count, int64_t n, const double *source, const double *target, const double *factors,
                          const int64_t strides[3], const double *origins, double *sums)
{
    for (int64_t k = 0; k < count; k++)
        certreg_springs(n, source + strides[0] * k, target + strides[1] * k, factors + strides[2] * k,
                        origins + 6 * k, (double(*)[2])(sums + 2 * CERTREG_SPRINGS * k));
}
