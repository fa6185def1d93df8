/* Cliques of a graph whose rows are bits, by cliques.c. */
#ifndef CERTREG_CLIQUES_H
#define CERTREG_CLIQUES_H

#include <stdint.h>

/* near: `words` words for each row, its neighbours. alive: rows that count, as bits. */

/* Twice how many triangles each row that is alive is of. */
void certreg_triangles(int64_t words, const uint64_t *near, const uint64_t *alive, int64_t *counts);

/* A clique that holds a row: the neighbour of most that are left is taken, the first of them, again and again. Its
 * other rows, as they are taken, and how many. counts: room for a number a row; left: for one row of bits. */
int64_t certreg_greedy_clique(int64_t words, const uint64_t *near, const uint64_t *alive, int64_t row, int64_t *clique,
                              int64_t *counts, uint64_t *left);

/* All cliques of `size` rows, each once, with its rows ascending. path: those taken, `depth` of them; left: after
 * each which may follow, `size` rows of bits. It begins with depth 0 and all rows left, and is over with depth -1.
 * Each look takes one of the steps, a clique `dear` more; below 0 it ends. */
struct certreg_enumeration {
    int64_t words, size, depth, steps, dear;
    const uint64_t *near;
    uint64_t *left;
    int64_t *path;
};

/* The next cliques, up to so many; how many. */
int64_t certreg_cliques(struct certreg_enumeration *search, int64_t most, int64_t *cliques);

#endif
