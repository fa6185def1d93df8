/* A slow body on general springs: is it at rest, or at a saddle? And the log.
 *
 * Formulas are generated; here is the logic, and the linear algebra of six dimensions.
 * runs.py does the same where nothing is compiled. */
#include "loops.h"

#include <math.h>
#include <string.h>

#include "jacobi.h"
#include "spring_dynamics.h"

#define FLAT 1e-9     /* of the largest curvature: less is none, as along a shift that no spring resists */
#define NO_PULL 1e-12 /* of the largest curvature: less is rounding, and must not choose a side */
#define SWEEPS 16     /* of Jacobi's method */

/* Moves a body off a saddle along the direction of lowest curvature, downhill. */
static void perturb(double *state, const double along[6], double pull, double *size,
                    const struct certreg_settings *settings)
{
    int largest = 0;
    for (int i = 1; i < 6; i++)
        if (fabs(along[i]) > fabs(along[largest]))
            largest = i;
    const double amount = (pull == 0 ? along[largest] : pull) < 0 ? -*size : *size;
    double sine[3], cosine, angle = 0;
    for (int i = 0; i < 3; i++) {
        state[CERTREG_QUATERNION_STATE_C + i] += amount * along[i];
        angle += along[3 + i] * along[3 + i];
    }
    angle = sqrt(angle);
    const double half = certreg_sine(amount * angle / 2, &cosine);
    for (int i = 0; i < 3; i++)
        sine[i] = angle > 0 ? half * along[3 + i] / angle : 0;
    certreg_turn(state + CERTREG_QUATERNION_STATE_Q, cosine, sine);
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
    certreg_jacobi(&a[0][0], &v[0][0], 6, SWEEPS);
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
