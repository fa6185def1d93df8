/* A slow body on general springs: is it at rest, or at a saddle? And the log.
 *
 * Formulas are generated; here is the logic, and the linear algebra of six dimensions.
 * spring_runs.py does the same where nothing is compiled. */
#include "loops.h"

#include <math.h>
#include <string.h>

#include "spring_dynamics.h"

#define FLAT 1e-9     /* of the largest curvature: less is none, as along a shift that no spring resists */
#define NO_PULL 1e-12 /* of the largest curvature: less is rounding, and must not choose a side */
#define SWEEPS 16

/* Eigenvalues of a symmetric 6 x 6 matrix, on its diagonal, and unit eigenvectors, columns of v, by Jacobi
 * rotations. */
static void eigenbasis(double a[6][6], double v[6][6])
{
    memset(v, 0, 36 * sizeof(double));
    for (int i = 0; i < 6; i++)
        v[i][i] = 1;
    for (int sweep = 0; sweep < SWEEPS; sweep++)
        for (int p = 0; p < 5; p++)
            for (int q = p + 1; q < 6; q++) {
                if (a[p][q] == 0)
                    continue;
                const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
                const double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
                const double c = 1 / sqrt(t * t + 1), s = t * c;
                for (int i = 0; i < 6; i++) {
                    const double x = a[i][p], y = a[i][q];
                    a[i][p] = c * x - s * y, a[i][q] = s * x + c * y;
                }
                for (int i = 0; i < 6; i++) {
                    const double x = a[p][i], y = a[q][i];
                    a[p][i] = c * x - s * y, a[q][i] = s * x + c * y;
                }
                for (int i = 0; i < 6; i++) {
                    const double x = v[i][p], y = v[i][q];
                    v[i][p] = c * x - s * y, v[i][q] = s * x + c * y;
                }
            }
}

/* Moves a body off a saddle along the direction of lowest curvature, downhill. */
static void perturb(double *state, const double along[6], double pull, double *size,
                    const struct certreg_settings *settings)
{
    int largest = 0;
    for (int i = 1; i < 6; i++)
        if (fabs(along[i]) > fabs(along[largest]))
            largest = i;
    const double amount = (pull == 0 ? along[largest] : pull) < 0 ? -*size : *size;
    double sine[3], angle = 0;
    for (int i = 0; i < 3; i++) {
        state[CERTREG_QUATERNION_STATE_C + i] += amount * along[i];
        angle += along[3 + i] * along[3 + i];
    }
    angle = sqrt(angle);
    for (int i = 0; i < 3; i++)
        sine[i] = angle > 0 ? sin(amount * angle / 2) * along[3 + i] / angle : 0;
    certreg_turn(state + CERTREG_QUATERNION_STATE_Q, cos(amount * angle / 2), sine);
    *size = fmin(*size * settings->perturbation_growth, settings->largest_perturbation);
}

/* Where all curvatures are positive or none, a body whose springs would take it no further than rest allows
 * is at rest: Newton's step is that far. */
int certreg_escape_spring(double state[CERTREG_QUATERNION_STATE], const double body[CERTREG_SPRING_BODY],
                          const double *basin, const struct certreg_settings *settings, double *perturbation)
{
    double a[6][6], v[6][6], force[6], along[6], largest = 0, distance = 0;
    int least = 0, stalled = 1;
    (void)basin;
    certreg_spring_curvature(state, body, &a[0][0], force);
    eigenbasis(a, v);
    for (int k = 0; k < 6; k++) {
        largest = fmax(largest, fabs(a[k][k]));
        least = a[k][k] < a[least][least] ? k : least;
    }
    for (int k = 0; k < 6; k++) {
        double pull = 0;
        for (int i = 0; i < 6; i++)
            pull += v[i][k] * force[i];
        along[k] = fabs(pull) > NO_PULL * largest ? pull : 0;
        stalled = stalled && !(fabs(pull) > settings->stalled_torque * largest);
        if (a[k][k] > FLAT * largest)
            distance += pull / a[k][k] * (pull / a[k][k]);
    }
    if (a[least][least] < -FLAT * largest) {
        double down[6];
        if (!stalled)
            return CERTREG_GO_ON;
        for (int i = 0; i < 6; i++)
            down[i] = v[i][least];
        perturb(state, down, along[least], perturbation, settings);
        return CERTREG_PERTURBED;
    }
    return distance <= 4 * settings->rest_share ? CERTREG_AT_REST : CERTREG_GO_ON;
}

void certreg_record_spring(struct certreg_log *log, int64_t step, double time, const double *state,
                           const double *body)
{
    double *row = certreg_log_row(log, step, CERTREG_SPRING_SAMPLE);
    if (!row)
        return;
    row[CERTREG_SPRING_SAMPLE_TIME] = time;
    memcpy(row + CERTREG_SPRING_SAMPLE_STATE, state, CERTREG_QUATERNION_STATE * sizeof(double));
    certreg_spring_energies(state, body, row + CERTREG_SPRING_SAMPLE_ENERGIES);
}
