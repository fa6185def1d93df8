/* What the pass over the points and its caller agree on. */
#ifndef CERTREG_SUMS_H
#define CERTREG_SUMS_H

/* The record `sums` of layout.h holds, with deviations x, y of source and target from their origins,
 * each times the weight and summed: 1; y.y; x, y; x x^T; y x^T. */
#include "layout.h"
#include <stdint.h>
#include <string.h>

/* Columns of numbers anywhere in memory: entry (i, k) stands `i * row + k * column` bytes on. */
struct certreg_columns {
    const char *data;
    int64_t row;
    int64_t column;
    int single; /* nonzero: of type float; otherwise double */
};

static inline __attribute__((always_inline, unused)) double certreg_entry(const struct certreg_columns *from,
                                                                         int64_t row, int64_t column)
{
    const char *place = from->data + row * from->row + column * from->column;
    double value;
    float single;
    if (from->single) {
        memcpy(&single, place, sizeof single);
        return single;
    }
    memcpy(&value, place, sizeof value);
    return value;
}

struct certreg_points {
    int64_t count;
    struct certreg_columns source;  /* three columns */
    struct certreg_columns target;  /* three columns */
    struct certreg_columns weights; /* one; no data: all weights are one */
    double origin[6];               /* of the source, of the target */
};

/* Each sum as a value and what rounding left of it; and whether any weight has the sign of -1. A
 * coordinate or weight that is not finite makes its sum (x, y, 1) not finite, too. */
void certreg_sums(const struct certreg_points *points, double sums[CERTREG_SUMS][2], int *negative);

#endif
