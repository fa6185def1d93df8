/* The pose of two clouds in floating point, by one call: the sums over the points about the mean of a
 * few, and Horn's closed form. Whether its numbers are to be relied on is left to the caller. */
#include "pose.h"

#define LANES 4 /* one would do; the narrowest vectors divide fastest */
#include "lanes.h"
#include "eigen.h"

#define SAMPLE 32 /* points, whose mean is the origin */

static void near_mean(const struct certreg_columns *from, int64_t count, double mean[3])
{
    const int64_t step = count > SAMPLE ? count / SAMPLE : 1;
    int64_t taken = 0;
    mean[0] = mean[1] = mean[2] = 0;
    for (int64_t row = 0; row < count; row += step, taken++)
        for (int k = 0; k < 3; k++)
            mean[k] += certreg_entry(from, row, k);
    for (int k = 0; k < 3; k++)
        mean[k] /= (double)taken;
}

/* One lane holds the numbers, the others the same. */
static void turned(const double cross[9], double pose[CERTREG_POSE])
{
    lanes entries[9], matrix[16], values[4], vectors[16], turn[9], squares = {0};
    for (int i = 0; i < 9; i++)
        entries[i] = all(cross[i]);
    davenport(entries, matrix);
    eigenbasis(matrix, values, vectors);
    rotation(vectors, turn);
    for (int i = 0; i < 16; i++)
        squares += matrix[i] * matrix[i];
    for (int k = 0; k < 4; k++)
        pose[CERTREG_POSE_QUATERNION + k] = vectors[k][0];
    for (int k = 0; k < 9; k++)
        pose[CERTREG_POSE_ROTATION + k] = turn[k][0];
    pose[CERTREG_POSE_GAP] = values[0][0] - values[1][0];
    pose[CERTREG_POSE_NORM] = sqrt(squares[0]);
    pose[CERTREG_POSE_RESIDUAL] = residual_of(matrix, values, vectors)[0];
}

void certreg_pose(struct certreg_points *points, int fixed, double pose[CERTREG_POSE])
{
    double sums[CERTREG_SUMS][2], total[CERTREG_SUMS], *cross = pose + CERTREG_POSE_CROSS;
    double x[3], y[3], *means = pose + CERTREG_POSE_MEANS;
    int negative;
    near_mean(&points->source, points->count, points->origin);
    near_mean(&points->target, points->count, points->origin + 3);
    for (int k = 0; fixed && k < 6; k++)
        points->origin[k] = 0;
    certreg_sums(points, sums, &negative);
    for (int which = 0; which < CERTREG_SUMS; which++)
        total[which] = sums[which][0] + sums[which][1];
    const double *scatter = total + CERTREG_SUMS_SCATTER, mass = total[CERTREG_SUMS_MASS];
    for (int k = 0; k < 3; k++) {
        x[k] = fixed ? 0 : total[CERTREG_SUMS_SOURCE + k];
        y[k] = fixed ? 0 : total[CERTREG_SUMS_TARGET + k];
        means[k] = points->origin[k] + x[k] / mass;
        means[3 + k] = points->origin[3 + k] + y[k] / mass;
    }
    for (int i = 0; i < 9; i++)
        cross[i] = total[CERTREG_SUMS_CROSS + i] - y[i / 3] * (x[i % 3] / mass);
    turned(cross, pose);
    for (int k = 0; k < 3; k++) {
        const double *row = pose + CERTREG_POSE_ROTATION + 3 * k;
        double moved = 0;
        for (int j = 0; j < 3; j++)
            moved += row[j] * means[j];
        pose[CERTREG_POSE_TRANSLATION + k] = means[3 + k] - moved;
    }
    pose[CERTREG_POSE_MASS] = negative ? NAN : mass;
    pose[CERTREG_POSE_SOURCE] = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
    pose[CERTREG_POSE_SCATTER] = scatter[0] + scatter[3] + scatter[5];
    pose[CERTREG_POSE_TARGET] = y[0] * y[0] + y[1] * y[1] + y[2] * y[2];
    pose[CERTREG_POSE_SPREAD] = total[CERTREG_SUMS_SPREAD];
}
