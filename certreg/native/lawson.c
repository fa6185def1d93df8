/* Lawson's iteration: fits of least squares whose weights grow with the residuals that they leave.
 *
 * Proposals: refutations have a margin far above their rounding, and the checker decides. */
#include "lawson.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "jacobi.h"

#define LANES 4 /* on every processor: how many there are tells what is added first */
_Static_assert(LANES <= CERTREG_LAWSON_SPARE, "rows are filled up to whole vectors");

typedef double lanes __attribute__((vector_size(8 * LANES)));
typedef lanes loose __attribute__((aligned(8), may_alias));
typedef int64_t masks __attribute__((vector_size(8 * LANES)));

#define SWEEPS 8           /* of Jacobi's method; four are usual */
#define NEGLIGIBLE 0x1p-64 /* of the matrix: such an entry moves no eigenvalue by a rounding */
/* As in certificate/infeasibility_weights.py. */
#define ROUNDS 100
#define WEIGHT_MAX 65535.0
#define MARGIN 1e-9
#define FIT_STEPS 80 /* 5 to 20 decide most sets; what is left is within 2 percent of its bounds */
static const int64_t sizes[] = {3, 4, 5, 6, 8, 12, 20, 40};
#define SIZES ((int)(sizeof sizes / sizeof *sizes))

/* Rows in columns that are filled up with rows of weight 0. */
struct rows {
    int64_t count;
    double *columns[6], *squares; /* points about the first; squared bounds */
    double *shares, *weights, *ratios, *some;
};

struct fit {
    double rotation[9], shift[3];
    double spread, value, bound; /* of weighted squares: both clouds, the largest eigenvalue, bounds */
};

static inline int64_t filled(int64_t count) { return (count + LANES - 1) / LANES * LANES; }

static inline double total(lanes x)
{
    double sum = 0;
    for (int lane = 0; lane < LANES; lane++)
        sum += x[lane];
    return sum;
}

static inline lanes larger(lanes a, lanes b)
{
    const masks which = a > b;
    return (lanes)((which & (masks)a) | (~which & (masks)b));
}

static struct rows room_for(int64_t count, double *scratch)
{
    struct rows rows = {.count = count};
    const int64_t size = count + CERTREG_LAWSON_SPARE;
    double **const parts[] = {&rows.squares, &rows.shares, &rows.weights, &rows.ratios, &rows.some};
    for (int c = 0; c < 6; c++, scratch += size)
        rows.columns[c] = scratch;
    for (int k = 0; k < 5; k++, scratch += size)
        *parts[k] = scratch;
    return rows;
}

/* One row of the problem at a place; beyond the last one points at the first, with its bound. */
static inline void gather(struct rows *rows, int64_t place, int64_t height, const double *columns, int64_t row,
                          int64_t first)
{
    for (int c = 0; c < 6; c++)
        rows->columns[c][place] = columns[c * height + row] - columns[c * height + first];
    rows->squares[place] = columns[6 * height + row] * columns[6 * height + row];
}

static inline double magnitude_of(const double *a)
{
    double size = 0;
    for (int k = 0; k < 16; k++)
        size = fmax(size, fabs(a[k]));
    return size;
}

/* The largest eigenvalue of Davenport's matrix of y x^T, and its unit vector. */
static double top_vector(const double c[9], double q[4])
{
    const double w[3] = {c[7] - c[5], c[2] - c[6], c[3] - c[1]};
    const double s[3] = {c[5] + c[7], c[2] + c[6], c[1] + c[3]};
    double a[16] = {c[0] + c[4] + c[8], w[0], w[1], w[2], w[0], c[0] - c[4] - c[8], s[2], s[1],
                    w[1], s[2], c[4] - c[0] - c[8], s[0], w[2], s[1], s[0], c[8] - c[0] - c[4]};
    double v[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const double negligible = NEGLIGIBLE * magnitude_of(a);
    int turned = 1, best = 0;
    for (int sweep = 0; sweep < SWEEPS && turned; sweep++) {
        turned = 0;
        for (int i = 0; i < 3; i++)
            for (int j = i + 1; j < 4; j++) {
                const double coupling = a[4 * i + j], apart = a[4 * j + j] - a[4 * i + i];
                if (!(fabs(coupling) > negligible))
                    continue;
                const double root = sqrt(apart * apart + 4 * coupling * coupling);
                const double t = 2 * coupling / (apart + (apart < 0 ? -root : root));
                const double cosine = 1 / sqrt(t * t + 1), sine = t * cosine;
                certreg_turn_pair(a, 4, i, j, 4, 1, cosine, sine);
                certreg_turn_pair(a, 4, i, j, 1, 4, cosine, sine);
                certreg_turn_pair(v, 4, i, j, 4, 1, cosine, sine);
                turned = 1;
            }
    }
    for (int i = 1; i < 4; i++)
        if (a[5 * i] > a[5 * best])
            best = i;
    for (int i = 0; i < 4; i++)
        q[i] = v[4 * i + best];
    return a[5 * best];
}

static inline void rotation_of(const double q[4], double turn[9])
{
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    turn[0] = w * w + x * x - y * y - z * z, turn[1] = 2 * (x * y - w * z), turn[2] = 2 * (x * z + w * y);
    turn[3] = 2 * (x * y + w * z), turn[4] = w * w - x * x + y * y - z * z, turn[5] = 2 * (y * z - w * x);
    turn[6] = 2 * (x * z - w * y), turn[7] = 2 * (y * z + w * x), turn[8] = w * w - x * x - y * y + z * z;
}

/* The motion of least squares of the first `count` rows, weighted; weights beyond them are 0. */
static void fitted(const struct rows *rows, int64_t count, const double *weights, struct fit *fit)
{
    lanes sums[8] = {{0}}, products[10] = {{0}};
    double means[6], cross[9], q[4];
    for (int64_t k = 0; k < count; k += LANES) {
        const lanes w = *(const loose *)(weights + k);
        for (int c = 0; c < 6; c++)
            sums[c] += w * *(const loose *)(rows->columns[c] + k);
        sums[6] += w, sums[7] += w * *(const loose *)(rows->squares + k);
    }
    for (int c = 0; c < 6; c++)
        means[c] = total(sums[c]) / total(sums[6]);
    fit->bound = total(sums[7]);
    for (int64_t k = 0; k < count; k += LANES) {
        const lanes w = *(const loose *)(weights + k);
        lanes p[6], y[3];
        for (int c = 0; c < 6; c++)
            p[c] = *(const loose *)(rows->columns[c] + k) - means[c];
        for (int i = 0; i < 3; i++) {
            y[i] = w * p[3 + i];
            products[9] += y[i] * p[3 + i] + w * p[i] * p[i];
            for (int j = 0; j < 3; j++)
                products[3 * i + j] += y[i] * p[j];
        }
    }
    for (int c = 0; c < 9; c++)
        cross[c] = total(products[c]);
    fit->spread = total(products[9]);
    fit->value = top_vector(cross, q);
    rotation_of(q, fit->rotation);
    for (int i = 0; i < 3; i++) {
        const double *turn = fit->rotation + 3 * i;
        fit->shift[i] = means[3 + i] - turn[0] * means[0] - turn[1] * means[1] - turn[2] * means[2];
    }
}

/* Squared ratios of distance to bound of the first `count` rows, and the largest. */
static double measured(const struct rows *rows, int64_t count, const struct fit *fit)
{
    lanes top = {0};
    double largest = 0;
    for (int64_t k = 0; k < count; k += LANES) {
        lanes square = {0}, x[3];
        for (int j = 0; j < 3; j++)
            x[j] = *(const loose *)(rows->columns[j] + k);
        for (int i = 0; i < 3; i++) {
            const double *turn = fit->rotation + 3 * i;
            const lanes off = *(const loose *)(rows->columns[3 + i] + k) - fit->shift[i] - turn[0] * x[0] -
                              turn[1] * x[1] - turn[2] * x[2];
            square += off * off;
        }
        square /= *(const loose *)(rows->squares + k);
        *(loose *)(rows->ratios + k) = square;
        if (k + LANES <= count)
            top = larger(top, square);
        else
            for (int64_t one = k; one < count; one++)
                largest = fmax(largest, rows->ratios[one]);
    }
    for (int lane = 0; lane < LANES; lane++)
        largest = fmax(largest, top[lane]);
    return largest;
}

static int refutes(const struct fit *fit)
{
    return fit->spread - 2 * fit->value - fit->bound > MARGIN * (fit->spread + fit->bound);
}

/* Integer weights of the first `count` rows that refute them; 0 where none were found. */
static int refuted(struct rows *rows, int64_t count)
{
    const int64_t end = filled(count);
    for (int64_t k = 0; k < end; k++)
        rows->shares[k] = k < count;
    for (int step = 0; step < ROUNDS; step++) {
        struct fit fit;
        double largest = 0;
        for (int64_t k = 0; k < end; k++) {
            rows->weights[k] = rows->shares[k] / rows->squares[k];
            largest = rows->weights[k] > largest ? rows->weights[k] : largest;
        }
        for (int64_t k = 0; k < end; k++)
            rows->weights[k] = ceil(rows->weights[k] * (WEIGHT_MAX / largest));
        fitted(rows, count, rows->weights, &fit);
        if (refutes(&fit))
            return 1;
        if (!(measured(rows, count, &fit) > 1))
            return 0;
        largest = 0;
        for (int64_t k = 0; k < end; k++) {
            rows->shares[k] *= sqrt(rows->ratios[k]);
            largest = rows->shares[k] > largest ? rows->shares[k] : largest;
        }
        for (int64_t k = 0; k < end; k++)
            rows->shares[k] /= largest;
    }
    return 0;
}

struct load {
    double size;
    int64_t place;
};

static int descending(const void *one, const void *other)
{
    const struct load *a = one, *b = other;
    return a->size != b->size ? (a->size < b->size) - (a->size > b->size) : (a->place > b->place) - (a->place < b->place);
}

/* The first row and the others, those of most weight first. */
static void sorted(struct rows *rows, int64_t count, int64_t *numbers, struct load *loads)
{
    double *const parts[] = {rows->columns[0], rows->columns[1], rows->columns[2], rows->columns[3],
                             rows->columns[4], rows->columns[5], rows->squares, rows->weights};
    for (int64_t k = 1; k < count; k++)
        loads[k] = (struct load){rows->weights[k] * rows->squares[k], k};
    qsort(loads + 1, (size_t)(count - 1), sizeof *loads, descending);
    for (int part = 0; part < 8; part++) {
        memcpy(rows->some, parts[part], sizeof(double) * (size_t)count);
        for (int64_t k = 1; k < count; k++)
            parts[part][k] = rows->some[loads[k].place];
    }
    int64_t *const before = (int64_t *)rows->some;
    memcpy(before, numbers, sizeof *numbers * (size_t)count);
    for (int64_t k = 1; k < count; k++)
        numbers[k] = before[loads[k].place];
}

/* So few of the first rows that they refute still. */
static int64_t fewest(struct rows *rows, int64_t count)
{
    for (int k = 0; k < SIZES && sizes[k] < count - 1; k++) {
        struct fit fit;
        const int64_t few = sizes[k] + 1;
        memset(rows->some, 0, sizeof(double) * (size_t)filled(few));
        memcpy(rows->some, rows->weights, sizeof(double) * (size_t)few);
        fitted(rows, few, rows->some, &fit);
        if (refutes(&fit))
            return few;
    }
    return count;
}

int64_t certreg_refutation(int64_t height, const double *columns, int64_t *numbers, int64_t count, int64_t *weights,
                           double *scratch)
{
    struct rows rows = room_for(count, scratch);
    struct load *const loads = (struct load *)(rows.some + count + CERTREG_LAWSON_SPARE);
    int64_t found = 0, before = 0;
    for (int64_t k = 0; k < count + CERTREG_LAWSON_SPARE; k++)
        gather(&rows, k, height, columns, numbers[k < count ? k : 0], numbers[0]);
    while (count != before && refuted(&rows, count)) {
        before = count;
        sorted(&rows, count, numbers, loads);
        found = count = fewest(&rows, count);
        for (int64_t k = 0; k < count; k++)
            weights[k] = (int64_t)rows.weights[k];
    }
    return found;
}

/* Lawson's iteration for all rows of a set, until they fit, cannot fit, or steps are used up. */
static void least_ratio(struct rows *rows, double *pose)
{
    const int64_t count = rows->count, end = filled(count);
    double best = INFINITY;
    for (int64_t k = 0; k < end; k++)
        rows->weights[k] = k < count ? 1.0 / (double)count : 0;
    for (int step = 0; step < FIT_STEPS; step++) {
        struct fit fit;
        lanes lower = {0}, sums = {0};
        for (int64_t k = 0; k < end; k++)
            rows->some[k] = rows->weights[k] / rows->squares[k];
        fitted(rows, count, rows->some, &fit);
        const double largest = measured(rows, count, &fit);
        if (largest < best) {
            best = largest;
            memcpy(pose, fit.rotation, sizeof fit.rotation);
            memcpy(pose + 9, fit.shift, sizeof fit.shift);
        }
        for (int64_t k = 0; k < end; k++)
            rows->some[k] = rows->weights[k] * sqrt(rows->ratios[k]);
        for (int64_t k = 0; k < end; k += LANES) {
            lower += *(const loose *)(rows->weights + k) * *(const loose *)(rows->ratios + k);
            sums += *(const loose *)(rows->some + k);
        }
        const double sum = total(sums);
        if (!(largest > 1 && total(lower) <= 1 && sum > 0))
            break;
        for (int64_t k = 0; k < end; k++)
            rows->weights[k] = rows->some[k] / sum;
    }
}

void certreg_lawson_fits(int64_t height, const double *columns, int64_t sets, const uint8_t *inside, double *poses,
                         double *weights, double *scratch)
{
    for (int64_t set = 0; set < sets; set++, inside += height, weights += height, poses += 12) {
        struct rows rows = room_for(height, scratch);
        int64_t first = 0, count = 0;
        for (int64_t row = 0; row < height; row++) {
            weights[row] = 0;
            if (inside[row]) {
                first = count ? first : row;
                gather(&rows, count++, height, columns, row, first);
            }
        }
        rows.count = count;
        for (int64_t k = count; k < filled(count); k++)
            gather(&rows, k, height, columns, first, first);
        least_ratio(&rows, poses);
        for (int64_t row = 0, k = 0; row < height; row++)
            if (inside[row])
                weights[row] = rows.weights[k++];
        for (int i = 0; i < 3; i++) { /* back to the origin of the columns */
            const double *turn = poses + 3 * i;
            poses[9 + i] += columns[(3 + i) * height + first];
            for (int j = 0; j < 3; j++)
                poses[9 + i] -= turn[j] * columns[j * height + first];
        }
    }
}
