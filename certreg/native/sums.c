/* One pass over the points of two clouds, at the speed of memory.
 *
 * Points are taken side by side in lanes, shifted by the origin, and summed: 256 of them plainly,
 * and such blocks with what rounding takes from each sum kept [Knuth1997, 4.2.2]. So the error is
 * that of a sum of 256 terms, however many there are. All arithmetic is on lanes of doubles, the
 * same for every type and layout, to the bit. */
#include "sums.h"

#include "unpacked.h"

#define BLOCK 256
typedef float singles __attribute__((vector_size(4 * LANES)));

/* How points stand in memory; the first three are taken as vectors. */
enum layout { ROWS, ROWS_OF_SINGLES, COLUMNS, ANY };

/* Sums over the points of a block. */
struct block {
    places signs;
    lanes mass, spread, source[3], target[3], scatter[6], cross[9];
};

struct total {
    places signs;
    struct kept of[CERTREG_SUMS];
};

INLINE lanes widened(const char *data)
{
    singles values;
    memcpy(&values, data, sizeof values);
    return __builtin_convertvector(values, lanes);
}

/* Coordinates of LANES points less the origin; `count` of them are there, the others get 0. */
INLINE void load(const struct certreg_columns *from, int64_t first, int count, enum layout layout,
                 const double origin[3], lanes out[3])
{
    const char *data = from->data + first * from->row;
    if (layout == ROWS)
        unpack(doubles(data), doubles(data + 8 * LANES), doubles(data + 16 * LANES), out);
    else if (layout == ROWS_OF_SINGLES)
        unpack(widened(data), widened(data + 4 * LANES), widened(data + 8 * LANES), out);
    else if (layout == COLUMNS)
        for (int k = 0; k < 3; k++)
            out[k] = doubles(data + k * from->column);
    else
        for (int l = 0; l < LANES; l++)
            for (int k = 0; k < 3; k++)
                out[k][l] = l < count ? certreg_entry(from, first + l, k) : origin[k];
    for (int k = 0; k < 3; k++)
        out[k] -= origin[k];
}

INLINE lanes load_weights(const struct certreg_columns *from, int64_t first, int count,
                          enum layout layout)
{
    lanes w = {0};
    if (layout != ANY)
        return doubles(from->data + 8 * first);
    for (int l = 0; l < count; l++)
        w[l] = certreg_entry(from, first + l, 0);
    return w;
}

/* LANES points from the one with the number `first` on. */
INLINE void take(struct block *sum, const struct certreg_points *points, int64_t first, int count,
                 enum layout layout, int weighted)
{
    lanes x[3] = {{0}}, y[3] = {{0}}, w = {0};
    load(&points->source, first, count, layout, points->origin, x);
    load(&points->target, first, count, layout, points->origin + 3, y);
    if (weighted)
        w = load_weights(&points->weights, first, count, layout);
    lanes spread = {0};
    sum->mass += w;
    sum->signs |= (places)w;
    for (int k = 0; k < 3; k++) {
        lanes weighed = weighted ? w * y[k] : y[k];
        sum->target[k] += weighed;
        spread += weighed * y[k];
        for (int j = 0; j < 3; j++)
            sum->cross[3 * k + j] += weighed * x[j];
    }
    sum->spread += spread;
    for (int k = 0, at = 0; k < 3; k++) {
        lanes weighed = weighted ? w * x[k] : x[k];
        sum->source[k] += weighed;
        for (int j = k; j < 3; j++)
            sum->scatter[at++] += weighed * x[j];
    }
}

/* Inline: a loop's own sums come in registers, and a call would have them copied twice. */
INLINE void add_block(struct total *total, const struct block *sum)
{
    total->signs |= sum->signs;
    keep(&total->of[CERTREG_SUMS_MASS], sum->mass);
    keep(&total->of[CERTREG_SUMS_SPREAD], sum->spread);
    for (int k = 0; k < 3; k++) {
        keep(&total->of[CERTREG_SUMS_SOURCE + k], sum->source[k]);
        keep(&total->of[CERTREG_SUMS_TARGET + k], sum->target[k]);
    }
    for (int k = 0; k < 6; k++)
        keep(&total->of[CERTREG_SUMS_SCATTER + k], sum->scatter[k]);
    for (int k = 0; k < 9; k++)
        keep(&total->of[CERTREG_SUMS_CROSS + k], sum->cross[k]);
}

/* At most a block of points in any layout. */
INLINE void add_some(struct total *total, const struct certreg_points *points, int64_t first, int64_t count,
                     int weighted)
{
    struct block sum = {0};
    int64_t at = 0;
    for (; at + LANES <= count; at += LANES)
        take(&sum, points, first + at, LANES, ANY, weighted);
    if (at < count)
        take(&sum, points, first + at, (int)(count - at), ANY, weighted);
    add_block(total, &sum);
}

static __attribute__((noinline)) void add_any(struct total *total, const struct certreg_points *points,
                                              int64_t first, int64_t count)
{
    if (points->weights.data)
        add_some(total, points, first, count, 1);
    else
        add_some(total, points, first, count, 0);
}

/* Layout and presence of weights are constants here: each caller gets a loop of its own. */
INLINE void pass(const struct certreg_points *points, enum layout layout, int weighted,
                 struct total *total)
{
    int64_t first = 0;
    for (; first + BLOCK <= points->count; first += BLOCK) {
        struct block sum = {0};
        for (int64_t at = 0; at < BLOCK; at += LANES)
            take(&sum, points, first + at, LANES, layout, weighted);
        add_block(total, &sum);
    }
    add_any(total, points, first, points->count - first);
}

static enum layout layout_of(const struct certreg_columns *points)
{
    if (points->single)
        return points->row == 12 && points->column == 4 ? ROWS_OF_SINGLES : ANY;
    if (points->row == 8)
        return COLUMNS;
    return points->row == 24 && points->column == 8 ? ROWS : ANY;
}

static void pass_any(const struct certreg_points *points, struct total *total)
{
    enum layout layout = layout_of(&points->source);
    int weighted = points->weights.data != 0;
    if (layout != layout_of(&points->target) ||
        (weighted && (points->weights.row != 8 || points->weights.single)))
        layout = ANY;
#define CASE(LAYOUT)                                                                                \
    case LAYOUT:                                                                                    \
        if (weighted)                                                                               \
            pass(points, LAYOUT, 1, total);                                                         \
        else                                                                                        \
            pass(points, LAYOUT, 0, total);                                                         \
        break;
    switch (layout) {
        CASE(ROWS)
        CASE(ROWS_OF_SINGLES)
        CASE(COLUMNS)
    case ANY:
        for (int64_t first = 0; first < points->count; first += BLOCK)
            add_any(total, points, first,
                    points->count - first < BLOCK ? points->count - first : BLOCK);
    }
}

void certreg_sums(const struct certreg_points *points, double sums[CERTREG_SUMS][2], int *negative)
{
    struct total total = {0};
    pass_any(points, &total);
    for (int which = 0; which < CERTREG_SUMS; which++)
        fold(&total.of[which], sums[which]);
    if (!points->weights.data)
        sums[CERTREG_SUMS_MASS][0] = (double)points->count;
    *negative = 0;
    for (int lane = 0; lane < LANES; lane++)
        *negative |= total.signs[lane] < 0;
}
