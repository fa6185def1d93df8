/* What the pose of two clouds and its caller agree on; problem/fast_pose.py does the same. */
#ifndef CERTREG_POSE_H
#define CERTREG_POSE_H

#include "sums.h"

/* The pose, then what decides whether it is one: the mass; squared lengths of the sums of the deviations
 * and sums of their squares; l1 - l2 of Davenport's matrix, its Frobenius norm, the residual of its
 * eigenvectors; the cross-covariance, by rows; at the end the weighted means of source and target. Where
 * a weight has the sign of -1 the mass is NaN. */
enum {
    CERTREG_POSE_QUATERNION = 0,
    CERTREG_POSE_ROTATION = 4,
    CERTREG_POSE_TRANSLATION = 13,
    CERTREG_POSE_MASS = 16,
    CERTREG_POSE_SOURCE,
    CERTREG_POSE_SCATTER,
    CERTREG_POSE_TARGET,
    CERTREG_POSE_SPREAD,
    CERTREG_POSE_GAP,
    CERTREG_POSE_NORM,
    CERTREG_POSE_RESIDUAL,
    CERTREG_POSE_CROSS,
    CERTREG_POSE_MEANS = CERTREG_POSE_CROSS + 9,
    CERTREG_POSE = CERTREG_POSE_MEANS + 6
};

/* The origin is written, too. With `fixed` it is zero, and so are the means and the translation: a rotation
 * alone, of sums that are not about the means. */
void certreg_pose(struct certreg_points *points, int fixed, double pose[CERTREG_POSE]);

#endif
