/* A state that hardly moves: may it end there, or is it to be perturbed off a saddle? And the log.
 *
 * Formulas of the dynamics are generated; here is the logic, and the linear algebra of three
 * dimensions. evaluator.py does the same where nothing is compiled. */
#include "loops.h"

#include <math.h>
#include <string.h>

#include "dynamics.h"
#include "jacobi.h"

#define NO_TORQUE 1e-12 /* of the curvature: less is rounding, and must not choose a side */
#define SWEEPS 12       /* of Jacobi's method; the sixth changes nothing any more */

/* The unit quaternion of a rotation matrix: the largest of the four squares decides (Shepperd). */
static void quaternion_of(const double r[9], double q[4])
{
    const double trace = r[0] + r[4] + r[8];
    const double squares[4] = {trace, 2 * r[0] - trace, 2 * r[4] - trace, 2 * r[8] - trace};
    double norm = 0;
    int k = 0;
    for (int i = 1; i < 4; i++)
        if (squares[i] > squares[k])
            k = i;
    switch (k) {
    case 0: q[0] = 1 + trace, q[1] = r[7] - r[5], q[2] = r[2] - r[6], q[3] = r[3] - r[1]; break;
    case 1: q[0] = r[7] - r[5], q[1] = 1 + squares[1], q[2] = r[1] + r[3], q[3] = r[2] + r[6]; break;
    case 2: q[0] = r[2] - r[6], q[1] = r[1] + r[3], q[2] = 1 + squares[2], q[3] = r[5] + r[7]; break;
    default: q[0] = r[3] - r[1], q[1] = r[2] + r[6], q[2] = r[5] + r[7], q[3] = 1 + squares[3];
    }
    for (int i = 0; i < 4; i++)
        norm += q[i] * q[i];
    norm = sqrt(norm);
    for (int i = 0; i < 4; i++)
        q[i] /= norm;
}

/* l1 - q^T K q + omega^T J omega / 4 as a sum of squares (no cancellation); per unit of mass. */
static double height(const double q[4], double rotational, const double basin[CERTREG_BASIN])
{
    double sum = rotational / 2;
    for (int k = 0; k < 4; k++) {
        const double *axis = basin + CERTREG_BASIN_QUATERNIONS + 4 * k;
        const double along = q[0] * axis[0] + q[1] * axis[1] + q[2] * axis[2] + q[3] * axis[3];
        sum += basin[CERTREG_BASIN_GAPS + k] * along * along;
    }
    return sum;
}

/* The least eigenvalue of a symmetric 3 x 3 matrix and its unit eigenvector, by Jacobi rotations. */
static double least_curvature(const double g[9], double axis[3])
{
    double a[9], v[9];
    memcpy(a, g, sizeof a);
    certreg_jacobi(a, v, 3, SWEEPS);
    int k = 0;
    for (int i = 1; i < 3; i++)
        if (a[4 * i] < a[4 * k])
            k = i;
    for (int i = 0; i < 3; i++)
        axis[i] = v[3 * i + k];
    return a[4 * k];
}

/* q (0, a) + c q: the quaternion q turned by a half angle whose cosine is c, sine times axis a. */
void certreg_turn(double q[4], double c, const double a[3])
{
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    q[0] = c * w - x * a[0] - y * a[1] - z * a[2];
    q[1] = c * x + w * a[0] - z * a[1] + y * a[2];
    q[2] = c * y + z * a[0] + w * a[1] - x * a[2];
    q[3] = c * z - y * a[0] + x * a[1] + w * a[2];
}

/* Taylor's series, to the last bits for at most 1/2; beyond, those of half the angle, doubled. */
double certreg_sine(double angle, double *cosine)
{
    const double square = angle * angle;
    double sine = 1;
    if (fabs(angle) > 0.5) {
        const double s = certreg_sine(angle / 2, cosine), c = *cosine, norm = c * c + s * s;
        *cosine = (c * c - s * s) / norm;
        return 2 * c * s / norm;
    }
    *cosine = 1;
    for (int k = 16; k > 0; k -= 2) {
        *cosine = 1 - square / (k * (k - 1)) * *cosine;
        sine = 1 - square / (k * (k + 1)) * sine;
    }
    return angle * sine;
}

/* Whether a slow body may stop at a quaternion; CERTREG_PERTURBED if it may be at a saddle.
 *
 * sin^2 of half the angle to the optima is at most the height over the barrier. The height never
 * rises: the exact motion stays as near. In the basin but not near it only needs more time. */
static int ending(const double q[4], double rotational, const double basin[CERTREG_BASIN],
                  const struct certreg_settings *settings)
{
    const double above = height(q, rotational, basin), *gaps = basin + CERTREG_BASIN_GAPS;
    int k = 1; /* of the first eigenvalue that is not optimal */
    while (k < 4 && gaps[k] == 0)
        k++;
    if (k == 4)
        return CERTREG_AT_REST;
    if (!(above < settings->basin_share * gaps[k]))
        return CERTREG_PERTURBED;
    if (!(above < settings->rest_share * gaps[k]))
        return CERTREG_GO_ON;
    return k == 1 ? CERTREG_CONVERGED : CERTREG_AT_REST;
}

/* The half-angle quaternion of a turn downhill along the direction of lowest curvature; 0 in a valley,
 * and where the springs turn the body away themselves. */
static int perturbation_of(const double hessian[9], const double torque[3], double *angle,
                   const struct certreg_settings *settings, double *cosine, double sine[3])
{
    double axis[3], size = 0;
    int largest = 0;
    if (least_curvature(hessian, axis) >= 0)
        return 0;
    for (int i = 0; i < 9; i++)
        size = fmax(size, fabs(hessian[i]));
    for (int i = 0; i < 3; i++) {
        if (fabs(torque[i]) > settings->stalled_torque * size)
            return 0;
        if (fabs(axis[i]) > fabs(axis[largest]))
            largest = i;
    }
    double along = axis[0] * torque[0] + axis[1] * torque[1] + axis[2] * torque[2];
    if (fabs(along) <= NO_TORQUE * size)
        along = axis[largest];
    const double sign = along < 0 ? -1 : 1;
    const double half = sign * certreg_sine(*angle / 2, cosine);
    for (int i = 0; i < 3; i++)
        sine[i] = half * axis[i];
    *angle = fmin(*angle * settings->perturbation_growth, settings->largest_perturbation);
    return 1;
}

int certreg_escape_matrix(double state[CERTREG_MATRIX_STATE], const double body[CERTREG_BODY],
                          const double basin[CERTREG_BASIN],
                          const struct certreg_settings *settings, double *perturbation)
{
    double q[4], energies[CERTREG_ENERGIES], hessian[9], torque[3], cosine, sine[3], turned[9];
    double *r = state + CERTREG_MATRIX_STATE_R;
    quaternion_of(r, q);
    certreg_energies(state, body, energies);
    const int end = ending(q, energies[CERTREG_ENERGIES_ROTATION], basin, settings);
    if (end != CERTREG_PERTURBED)
        return end;
    certreg_curvature(state, body, hessian, torque);
    if (!perturbation_of(hessian, torque, perturbation, settings, &cosine, sine))
        return CERTREG_GO_ON;
    const double w = cosine, x = sine[0], y = sine[1], z = sine[2];
    const double m[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                         2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                         2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            turned[3 * i + j] = r[3 * i] * m[j] + r[3 * i + 1] * m[3 + j] + r[3 * i + 2] * m[6 + j];
    memcpy(r, turned, sizeof turned);
    return CERTREG_PERTURBED;
}

int certreg_escape_quaternion(double state[CERTREG_QUATERNION_STATE], const double body[CERTREG_BODY],
                              const double basin[CERTREG_BASIN],
                              const struct certreg_settings *settings, double *perturbation)
{
    double energies[CERTREG_ENERGIES], hessian[9], torque[3], cosine, sine[3];
    double *q = state + CERTREG_QUATERNION_STATE_Q;
    certreg_quaternion_energies(state, body, energies);
    const int end = ending(q, energies[CERTREG_ENERGIES_ROTATION], basin, settings);
    if (end != CERTREG_PERTURBED)
        return end;
    certreg_quaternion_curvature(state, body, hessian, torque);
    if (!perturbation_of(hessian, torque, perturbation, settings, &cosine, sine))
        return CERTREG_GO_ON;
    certreg_turn(q, cosine, sine);
    return CERTREG_PERTURBED;
}

/* A row for the next sample, or null if this step is not one. */
double *certreg_log_row(struct certreg_log *log, int64_t step, int64_t width)
{
    if (step % log->stride)
        return 0;
    if (log->count == log->capacity) {
        for (int64_t k = 1; 2 * k < log->capacity; k++)
            memcpy(log->rows + k * width, log->rows + 2 * k * width, (size_t)width * sizeof(double));
        log->count = (log->capacity + 1) / 2;
        log->stride *= 2;
        if (step % log->stride)
            return 0;
    }
    return log->rows + width * log->count++;
}

void certreg_record_matrix(struct certreg_log *log, int64_t step, double time, const double *state,
                           const double *body)
{
    double *row = certreg_log_row(log, step, CERTREG_MATRIX_SAMPLE);
    if (!row)
        return;
    row[CERTREG_MATRIX_SAMPLE_TIME] = time;
    memcpy(row + CERTREG_MATRIX_SAMPLE_STATE, state, CERTREG_MATRIX_STATE * sizeof(double));
    certreg_energies(state, body, row + CERTREG_MATRIX_SAMPLE_ENERGIES);
}

void certreg_record_quaternion(struct certreg_log *log, int64_t step, double time, const double *state,
                               const double *body)
{
    double *row = certreg_log_row(log, step, CERTREG_QUATERNION_SAMPLE);
    if (!row)
        return;
    row[CERTREG_QUATERNION_SAMPLE_TIME] = time;
    memcpy(row + CERTREG_QUATERNION_SAMPLE_STATE, state, CERTREG_QUATERNION_STATE * sizeof(double));
    certreg_quaternion_energies(state, body, row + CERTREG_QUATERNION_SAMPLE_ENERGIES);
}
