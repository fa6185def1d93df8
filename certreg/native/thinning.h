/* Rows struck from a graph whose rows are bits, by thinning.c. */
#ifndef CERTREG_THINNING_H
#define CERTREG_THINNING_H

#include <stdint.h>

/* near: `words` words for each of `rows` rows, its neighbours. alive: those left. A row needs `least` - 1
 * neighbours that are alive. clique: rows that are not tried. degrees: neighbours alive of a row that is.
 * failed: of each row the degree at which its neighbours took too many colours, or -1. order, queue: room
 * for as many numbers as there are rows; masks: for two rows of bits. */
struct certreg_thinning {
    int64_t rows, words, least, count; /* count: of those alive */
    int64_t tried, next, spare;        /* of a pass: rows in `order`, how many are behind; of its last row */
    uint64_t *near;
    const uint64_t *clique;
    uint64_t *alive, *masks;
    int64_t *degrees, *failed, *order, *queue;
};

/* Counts; then strikes rows with too few neighbours until none is left that has so few. */
void certreg_thin(struct certreg_thinning *thinning);

/* One row struck, and then those with too few neighbours. */
void certreg_strike(struct certreg_thinning *thinning, int64_t row);

/* Two neighbours, both alive, are none any more; then rows with too few neighbours are struck. */
void certreg_cut(struct certreg_thinning *thinning, int64_t row, int64_t other);

/* Strikes rows whose neighbours take fewer than `least` - 1 colours, those with few neighbours first, until
 * none falls or too few are left. Their numbers, and how many. */
int64_t certreg_strike_by_colours(struct certreg_thinning *thinning, int64_t *struck);

/* A pass over the rows that are alive and not of the clique, those with few neighbours first: whenever asked, the
 * next that may fall if enough rows of the clique beside it must be left out; -1 at the end, or where too few are
 * left. spare: with one more than so many left out it falls: it, the others of the clique beside it, and one row
 * of each colour of its other neighbours are fewer than `least` then. */
void certreg_begin(struct certreg_thinning *thinning);
int64_t certreg_next(struct certreg_thinning *thinning);

/* How many colours the rows take that stand in `masks`, each the first that none of its neighbours has; or
 * `most` + 1. */
int64_t certreg_colours(struct certreg_thinning *thinning, int64_t most);

#endif
