/* The sums over points whose springs are matrices, exactly, by sums of products of short integers in doubles.
 *
 * All numbers of a cloud, and all factors, are cut into limbs of 22 bits over one power of two [Ozaki2012]. A limb is
 * at most 2^22 in size, whatever rounding the processor is told to use, so 256 products of two add up within 2^52:
 * nothing rounds, in any order, with or without fused operations. So W, x x^T and p = W y are made, in limbs again,
 * and each sum is one of products of limbs of two columns: of W with 1, x, x x^T; of p with 1, x, y. */
#include "exact_springs.h"

#include "exact.h"

#include <stdlib.h>
#include <string.h>

#define BITS 22
#define BLOCK 256 /* points: 2 BITS + 8 <= 53 */
#define MOST CERTREG_LIMBS
#define PLACES CERTREG_LIMB_PLACES
#define INLINE static inline __attribute__((always_inline))
#ifdef __AVX512F__
#define LANES 8
#define ROWS 6 /* of limbs whose sums of products are taken at once, */
#else
#define LANES 4
#define ROWS 3
#endif
#define COLUMNS 4 /* with so many others: the sums and what they need fit into the registers */
#define STEPS (BLOCK / LANES)
#define MOST_ROWS (6 * 2 * MOST + ROWS)
#define MOST_COLUMNS (1 + 3 * MOST + 6 * 2 * MOST + COLUMNS)

typedef double lanes __attribute__((vector_size(8 * LANES)));
typedef int64_t masks __attribute__((vector_size(8 * LANES)));
typedef lanes column[STEPS];

enum { X = 0, Y = 1, L = 2 };

/* Numbers of a group, all at most 2^(top - 1) in size: limb k of 0, 1, ... counts 2^(top - BITS (k + 1)). */
typedef struct {
    int64_t lowest, top; /* over 2^-1074: the lowest bit that is set; and as above */
    int limbs;
} range;

typedef struct {
    column x[3][MOST], y[3][MOST], factor[6][MOST];
    column xx[6][2 * MOST], w[6][2 * MOST], p[3][3 * MOST], one, none;
    int nx[3], ny[3], nl[6], nxx[6], nw[6], np[3]; /* limbs that are used: of a column of zeros none */
} block;

/* A column of limbs of entry `index`, each counting 2^(-BITS place). */
typedef struct {
    const lanes *limb;
    int place, index;
} row;

/* The same; the sum of products with row r is that of number sum + stride r.index. */
typedef struct {
    const lanes *limb;
    int place, sum, stride;
} other;

typedef int64_t totals[CERTREG_SPRINGS + 1][PLACES]; /* the last is of what was added to fill up */

static const int upper[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};

static int range_of(int64_t n, const double *values, range *found)
{
    int64_t lowest = INT64_MAX, most = 0, least = 2047;
    for (int64_t k = 0; k < n; k++) {
        uint64_t bits;
        memcpy(&bits, values + k, sizeof bits);
        const int64_t e = bits >> 52 & 2047;
        const uint64_t size = (bits & ((UINT64_C(1) << 52) - 1)) | UINT64_C(1) << 52;
        if (bits << 1 == 0)
            continue;
        const int64_t last = e - 1 + __builtin_ctzll(size);
        lowest = last < lowest ? last : lowest;
        most = e > most ? e : most;
        least = e < least ? e : least;
    }
    *found = (range){lowest, most + 53, 0}; /* below 2^(top - 1 - 1074) */
    if (most == 2047)
        return CERTREG_NOT_FINITE;
    if (most == 0) {
        const int zeros = least == 2047;
        *found = (range){INT64_MAX, 1074, 1};
        return zeros ? CERTREG_SUMMED : CERTREG_NO_MEMORY;
    }
    found->limbs = (int)((found->top - lowest + BITS - 1) / BITS);
    /* The processor may be told to take numbers below the normal range as 0: these are refused. */
    return least >= 1 && most >= 64 && most <= 1984 && found->limbs <= MOST ? CERTREG_SUMMED : CERTREG_NO_MEMORY;
}

INLINE lanes nearest(lanes value)
{
    const lanes shift = (lanes){0} + 0x1.8p52;
    return (value + shift) - shift; /* an integer, whatever the rounding */
}

/* A power of two in the normal range. */
static double power(int64_t exponent)
{
    const uint64_t bits = (uint64_t)(1023 + exponent) << 52;
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static int is_any(masks mask)
{
    int64_t all = 0;
    for (int lane = 0; lane < LANES; lane++)
        all |= mask[lane];
    return all != 0;
}

/* Cut one of `width` columns into limbs; how many are used. */
static int cut(const double *from, int64_t count, int width, const range *of, column *limb)
{
    const double scale = power(1074 - of->top);
    masks left[MOST + 1] = {{0}}; /* whether something is left before limb k */
    for (int step = 0; step < STEPS; step++) {
        lanes rest = {0};
        for (int lane = 0; lane < LANES; lane++)
            rest[lane] = step * LANES + lane < count ? from[(step * LANES + lane) * width] : 0.0;
        rest *= scale;
        left[0] |= rest != 0.0;
        for (int k = 0; k < of->limbs; k++) {
            rest *= 0x1p22;
            limb[k][step] = nearest(rest);
            rest -= limb[k][step];
            left[k + 1] |= rest != 0.0;
        }
    }
    int used = of->limbs;
    while (used > 0 && !is_any(left[used - 1]))
        used--;
    return used;
}

static void cut_all(block *in, int64_t count, const double *const from[3], const range of[3])
{
    for (int k = 0; k < 3; k++) {
        in->nx[k] = cut(from[X] + k, count, 3, &of[X], in->x[k]);
        in->ny[k] = cut(from[Y] + k, count, 3, &of[Y], in->y[k]);
    }
    for (int k = 0; k < 6; k++)
        in->nl[k] = cut(from[L] + k, count, 6, &of[L], in->factor[k]);
}

/* Add the products of two numbers to a third, of a + b limbs, before they carry. */
INLINE void multiply_known(column *product, const column *one, const int a, const column *another, const int b)
{
    if (a == 0 || b == 0)
        return;
    for (int step = 0; step < STEPS; step++) {
        lanes total[3 * MOST];
        for (int k = 1; k < a + b; k++)
            total[k] = product[k][step];
        for (int i = 0; i < a; i++)
            for (int j = 0; j < b; j++)
                total[i + j + 1] += one[i][step] * another[j][step];
        for (int k = 1; k < a + b; k++)
            product[k][step] = total[k];
    }
}

/* The same: for the usual numbers of limbs the compiler keeps them in registers. */
static void multiply(column *product, const column *one, int a, const column *another, int b)
{
    if (a == 3 && b == 3)
        multiply_known(product, one, 3, another, 3);
    else if (a == 6 && b == 3)
        multiply_known(product, one, 6, another, 3);
    else if (a == 4 && b == 4)
        multiply_known(product, one, 4, another, 4);
    else
        multiply_known(product, one, a, another, b);
}

static void carry(column *number, int limbs)
{
    for (int step = 0; step < STEPS; step++)
        for (int k = limbs - 1; k > 0; k--) {
            const lanes more = nearest(number[k][step] * 0x1p-22);
            number[k][step] -= more * 0x1p22;
            number[k - 1][step] += more;
        }
}

static int larger(int a, int b) { return a > b ? a : b; }

/* W_ab, a <= b, from the columns of L, and how many limbs it takes. */
static void make_spring(block *of, int a, int b)
{
    static const int place[3][3] = {{0, 1, 3}, {0, 2, 4}, {0, 0, 5}}; /* of L by columns */
    const int entry = upper[a][b];
    int limbs = 0;
    for (int k = 0; k <= a; k++)
        if (of->nl[place[k][a]] && of->nl[place[k][b]])
            limbs = larger(limbs, of->nl[place[k][a]] + of->nl[place[k][b]]);
    memset(of->w[entry], 0, (size_t)limbs * sizeof(column));
    for (int k = 0; k <= a; k++)
        if (of->nl[place[k][a]] && of->nl[place[k][b]])
            multiply(of->w[entry], of->factor[place[k][a]], of->nl[place[k][a]], of->factor[place[k][b]],
                     of->nl[place[k][b]]);
    carry(of->w[entry], limbs);
    of->nw[entry] = limbs;
}

static void make_products(block *of)
{
    for (int a = 0; a < 3; a++)
        for (int b = a; b < 3; b++) {
            const int entry = upper[a][b];
            of->nxx[entry] = of->nx[a] && of->nx[b] ? of->nx[a] + of->nx[b] : 0;
            memset(of->xx[entry], 0, (size_t)of->nxx[entry] * sizeof(column));
            multiply(of->xx[entry], of->x[a], of->nx[a], of->x[b], of->nx[b]);
            carry(of->xx[entry], of->nxx[entry]);
            make_spring(of, a, b);
        }
    for (int a = 0; a < 3; a++) {
        of->np[a] = 0;
        for (int b = 0; b < 3; b++)
            of->np[a] = larger(of->np[a], of->nw[upper[a][b]] + of->ny[b]);
        memset(of->p[a], 0, (size_t)of->np[a] * sizeof(column));
        for (int b = 0; b < 3; b++)
            multiply(of->p[a], of->w[upper[a][b]], of->nw[upper[a][b]], of->y[b], of->ny[b]);
        carry(of->p[a], of->np[a]);
    }
}

/* The sums of the products of ROWS and COLUMNS limbs. */
INLINE void add_tile(const row *rows, const other *columns, totals sums)
{
    lanes total[ROWS][COLUMNS];
    for (int i = 0; i < ROWS; i++)
        for (int j = 0; j < COLUMNS; j++)
            total[i][j] = (lanes){0};
    for (int step = 0; step < STEPS; step++)
        for (int i = 0; i < ROWS; i++)
            for (int j = 0; j < COLUMNS; j++)
                total[i][j] += rows[i].limb[step] * columns[j].limb[step];
    for (int i = 0; i < ROWS; i++)
        for (int j = 0; j < COLUMNS; j++) {
            double sum = 0.0;
            for (int lane = 0; lane < LANES; lane++)
                sum += total[i][j][lane];
            sums[columns[j].sum + columns[j].stride * rows[i].index][rows[i].place + columns[j].place] += (int64_t)sum;
        }
}

/* All of them; the lists have room for what fills up their last tile. */
static void add_products(row *rows, int r, other *columns, int c, const lanes *none, totals sums)
{
    for (; r % ROWS; r++)
        rows[r] = (row){none, 0, 0};
    for (; c % COLUMNS; c++)
        columns[c] = (other){none, 0, CERTREG_SPRINGS, 0};
    for (int i = 0; i < r; i += ROWS)
        for (int j = 0; j < c; j += COLUMNS)
            add_tile(rows + i, columns + j, sums);
}

static int list_rows(const column *number, int limbs, int index, row *rows)
{
    for (int k = 0; k < limbs; k++)
        rows[k] = (row){number[k], k + 1, index};
    return limbs;
}

static int list_columns(const column *number, int limbs, int sum, int stride, other *columns)
{
    for (int k = 0; k < limbs; k++)
        columns[k] = (other){number[k], k + 1, sum, stride};
    return limbs;
}

static void add_block(const block *of, totals sums)
{
    row rows[MOST_ROWS];
    other columns[MOST_COLUMNS];
    int r = 0, c = 1;
    for (int entry = 0; entry < 6; entry++)
        r += list_rows(of->w[entry], of->nw[entry], entry, rows + r);
    columns[0] = (other){of->one, 0, CERTREG_SPRINGS_STIFFNESS, 1};
    for (int j = 0; j < 3; j++)
        c += list_columns(of->x[j], of->nx[j], CERTREG_SPRINGS_SOURCE + j, 3, columns + c);
    for (int jk = 0; jk < 6; jk++)
        c += list_columns(of->xx[jk], of->nxx[jk], CERTREG_SPRINGS_SCATTER + jk, 6, columns + c);
    add_products(rows, r, columns, c, of->none, sums);
    r = 0, c = 1;
    for (int a = 0; a < 3; a++)
        r += list_rows(of->p[a], of->np[a], a, rows + r);
    columns[0] = (other){of->one, 0, CERTREG_SPRINGS_TARGET, 1};
    for (int k = 0; k < 3; k++)
        c += list_columns(of->x[k], of->nx[k], CERTREG_SPRINGS_CROSS + k, 3, columns + c);
    add_products(rows, r, columns, c, of->none, sums);
    for (int a = 0; a < 3; a++) {
        r = list_rows(of->p[a], of->np[a], 0, rows);
        c = list_columns(of->y[a], of->ny[a], CERTREG_SPRINGS_SPREAD, 0, columns);
        add_products(rows, r, columns, c, of->none, sums);
    }
    for (int k = 0; k < CERTREG_SPRINGS; k++)
        for (int place = PLACES - 1; place > 0; place--) {
            const int64_t more = sums[k][place] >> BITS;
            sums[k][place] -= more * (INT64_C(1) << BITS);
            sums[k][place - 1] += more;
        }
}

int certreg_limb_springs(
    int64_t n, const double *source, const double *target, const double *factors, int64_t *sums, int64_t about[6])
{
    const double *const from[3] = {source, target, factors};
    range of[3];
    totals total;
    for (int k = 0; k < 3; k++) {
        const int refused = range_of((k == L ? 6 : 3) * n, from[k], &of[k]);
        if (refused)
            return refused;
        about[k] = of[k].top, about[3 + k] = of[k].lowest;
    }
    void *const memory = malloc(sizeof(block) + sizeof(lanes));
    if (memory == NULL)
        return CERTREG_NO_MEMORY;
    block *const in = (block *)(((uintptr_t)memory + sizeof(lanes) - 1) / sizeof(lanes) * sizeof(lanes));
    memset(total, 0, sizeof total);
    memset(in->none, 0, sizeof in->none);
    for (int step = 0; step < STEPS; step++)
        in->one[step] = (lanes){0} + 1.0;
    for (int64_t i = 0; i < n; i += BLOCK) {
        const int64_t count = n - i < BLOCK ? n - i : BLOCK;
        const double *const rows[3] = {source + 3 * i, target + 3 * i, factors + 6 * i};
        cut_all(in, count, rows, of);
        make_products(in);
        add_block(in, total);
    }
    free(memory);
    memcpy(sums, total, CERTREG_SPRINGS * sizeof *total);
    return CERTREG_SUMMED;
}
