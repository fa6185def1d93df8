/* What the batches of small problems and their caller agree on; stationary.py does the same. */
#ifndef CERTREG_STATIONARY_H
#define CERTREG_STATIONARY_H

#include "layout.h"

#include <stdint.h>

/* Problems one after another in every array; a step of 0 shares an array among all of them. What is
 * written is described in native/stationary.py. */
struct certreg_clouds {
    int64_t count;
    int64_t points;
    const double *sources; /* points x 3 each */
    const double *targets;
    const double *weights; /* points each */
    int64_t source_step;      /* doubles from one problem to the next */
    int64_t target_step;
    int64_t weight_step;
    double *scratch;      /* CERTREG_SCRATCH doubles per point */
    int *exponents;       /* count x 2 */
    double *means;        /* records of layout.h: means */
    double *cross;        /* count x 9 */
    double *scatter;      /* count x 6 */
    double *spreads;      /* spreads */
    double *values;       /* count x 4 */
    double *vectors;      /* count x 16 */
    double *residual;     /* count */
    double *ratios;       /* count x 12 */
    double *translations; /* count x 12 */
    double *rmse;         /* count x 4 */
};

#define CERTREG_SIDE_BY_SIDE 8 /* problems at most: one in each lane */
#define CERTREG_SCRATCH (7 * CERTREG_SIDE_BY_SIDE)

void certreg_stationary_poses(const struct certreg_clouds *clouds);

#endif
