/* The implicit midpoint rule: Newton's method for the middle angular velocity, halving the step
 * where it fails. Whatever root is found, the energy of a step falls by what damping takes. */
#include "loops.h"

#include <math.h>
#include <string.h>

#include "dynamics.h"

/* The solution of a 3 x 3 system by Cramer's rule with cross products; 0 where it is singular. */
static int solve3(const double a[9], const double b[3], double x[3])
{
    const double c[9] = {a[4] * a[8] - a[5] * a[7], a[5] * a[6] - a[3] * a[8], a[3] * a[7] - a[4] * a[6],
                         a[2] * a[7] - a[1] * a[8], a[0] * a[8] - a[2] * a[6], a[1] * a[6] - a[0] * a[7],
                         a[1] * a[5] - a[2] * a[4], a[2] * a[3] - a[0] * a[5], a[0] * a[4] - a[1] * a[3]};
    const double determinant = a[0] * c[0] + a[1] * c[1] + a[2] * c[2];
    for (int i = 0; i < 3; i++)
        x[i] = (c[i] * b[0] + c[3 + i] * b[1] + c[6 + i] * b[2]) / determinant;
    return isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2]);
}

/* The middle angular velocity by Newton's method from the present one; 0 if it does not converge. */
static int middle_of(const double state[CERTREG_QUATERNION_STATE], const double body[CERTREG_BODY], double step,
                     const struct certreg_settings *settings, double middle[3])
{
    double residual[3], jacobian[9], change[3], before = INFINITY;
    memcpy(middle, state + CERTREG_QUATERNION_STATE_OMEGA, 3 * sizeof(double));
    for (int64_t k = 0; k < settings->newton_steps; k++) {
        certreg_midpoint_residual(state, body, middle, &step, residual, jacobian);
        if (!solve3(jacobian, residual, change))
            return 0;
        double size = 0, moved = 0;
        for (int i = 0; i < 3; i++) {
            middle[i] -= change[i];
            size += middle[i] * middle[i];
            moved += change[i] * change[i];
        }
        if (step * step * size > settings->largest_turn * settings->largest_turn)
            return 0;
        /* the last digits: no longer falling, or nothing left to fall */
        if (step * step * moved <= settings->newton_tolerance * settings->newton_tolerance &&
            (moved >= before / 4 || moved == 0))
            return 1;
        before = moved;
    }
    return 0;
}

/* One step of at most `step`, halved until Newton converges; the step taken, or 0. */
static double advance(double state[CERTREG_QUATERNION_STATE], const double body[CERTREG_BODY], double step,
                      const struct certreg_settings *settings)
{
    double middle[3], next[CERTREG_QUATERNION_STATE], *q = next + CERTREG_QUATERNION_STATE_Q;
    for (int64_t k = 0; k <= settings->halvings; k++, step /= 2) {
        if (!middle_of(state, body, step, settings, middle))
            continue;
        certreg_midpoint_step(state, body, middle, &step, next);
        double norm = 0; /* |q| is kept up to rounding: take the rounding out */
        for (int i = 0; i < 4; i++)
            norm += q[i] * q[i];
        norm = sqrt(norm);
        for (int i = 0; i < 4; i++)
            q[i] /= norm;
        memcpy(state, next, sizeof next);
        return step;
    }
    return 0;
}

static void run_one(const struct certreg_batch *batch, const struct certreg_settings *settings, int64_t i)
{
    const double *body = batch->bodies + i * CERTREG_BODY, *basin = batch->basins + i * CERTREG_BASIN;
    double *state = batch->states + i * CERTREG_QUATERNION_STATE;
    double perturbation = settings->first_perturbation, time = 0, speed;
    int end = CERTREG_GO_ON;
    int64_t taken = 0;
    batch->escapes[i] = 0;
    for (;; taken++) {
        certreg_quaternion_squared_speed(state, body, &speed);
        if (batch->log)
            certreg_record_quaternion(batch->log, taken, time, state, body);
        if (speed < settings->squared_tolerance) {
            end = certreg_escape_quaternion(state, body, basin, settings, &perturbation);
            batch->escapes[i] += end == CERTREG_PERTURBED;
        } else
            end = CERTREG_GO_ON;
        if (end == CERTREG_CONVERGED || end == CERTREG_AT_REST || taken >= settings->max_steps ||
            speed != speed)
            break;
        const double step = advance(state, body, batch->steps[i * CERTREG_STEP + CERTREG_STEP_H], settings);
        if (step == 0)
            break;
        time += step;
    }
    batch->status[i] = end == CERTREG_PERTURBED ? CERTREG_GO_ON : end;
    batch->taken[i] = taken;
    batch->times[i] = time;
}

void certreg_midpoint_single(const struct certreg_batch *batch, const struct certreg_settings *settings)
{
    for (int64_t i = 0; i < batch->count; i++)
        run_one(batch, settings, i);
}
