/* The implicit midpoint rule on general springs: Newton's method for the middle velocities, halving the step
 * where it fails. Whatever root is found, the energy of a step falls by what damping takes. */
#include "loops.h"

#include <math.h>
#include <string.h>

#include "spring_dynamics.h"

/* The solution of a 6 x 6 system by elimination with pivots, in b; 0 where it is singular. */
static int solve6(double a[6][6], double b[6])
{
    for (int k = 0; k < 6; k++) {
        int pivot = k;
        for (int i = k + 1; i < 6; i++)
            if (fabs(a[i][k]) > fabs(a[pivot][k]))
                pivot = i;
        for (int j = k; j < 6; j++) {
            const double kept = a[k][j];
            a[k][j] = a[pivot][j], a[pivot][j] = kept;
        }
        const double kept = b[k];
        b[k] = b[pivot], b[pivot] = kept;
        for (int i = k + 1; i < 6; i++) {
            const double share = a[i][k] / a[k][k];
            for (int j = k; j < 6; j++)
                a[i][j] -= share * a[k][j];
            b[i] -= share * b[k];
        }
    }
    for (int k = 5; k >= 0; k--) {
        for (int j = k + 1; j < 6; j++)
            b[k] -= a[k][j] * b[j];
        b[k] /= a[k][k];
        if (!isfinite(b[k]))
            return 0;
    }
    return 1;
}

/* The middle velocities by Newton's method from the present ones; 0 if it does not converge. */
static int middle_of(const double state[CERTREG_QUATERNION_STATE], const double body[CERTREG_SPRING_BODY],
                     double step, const struct certreg_settings *settings, double middle[6])
{
    double residual[6], jacobian[6][6], before = INFINITY;
    memcpy(middle, state + CERTREG_QUATERNION_STATE_V, 3 * sizeof(double));
    memcpy(middle + 3, state + CERTREG_QUATERNION_STATE_OMEGA, 3 * sizeof(double));
    for (int64_t k = 0; k < settings->newton_steps; k++) {
        certreg_spring_midpoint_residual(state, body, middle, &step, residual, &jacobian[0][0]);
        if (!solve6(jacobian, residual))
            return 0;
        double speed = 0, size = 0, shifted = 0, moved = 0;
        for (int i = 0; i < 3; i++) {
            middle[i] -= residual[i], middle[3 + i] -= residual[3 + i];
            speed += middle[i] * middle[i], size += middle[3 + i] * middle[3 + i];
            shifted += residual[i] * residual[i], moved += residual[3 + i] * residual[3 + i];
        }
        if (step * step * size > settings->largest_turn * settings->largest_turn)
            return 0;
        moved += shifted / (1 + speed);
        /* the last digits: no longer falling, or nothing left to fall */
        if (step * step * moved <= settings->newton_tolerance * settings->newton_tolerance &&
            (moved >= before / 4 || moved == 0))
            return 1;
        before = moved;
    }
    return 0;
}

/* One step of at most `step`, halved until Newton converges; the step taken, or 0. */
static double advance(double state[CERTREG_QUATERNION_STATE], const double body[CERTREG_SPRING_BODY], double step,
                      const struct certreg_settings *settings)
{
    double middle[6], next[CERTREG_QUATERNION_STATE], *q = next + CERTREG_QUATERNION_STATE_Q;
    for (int64_t k = 0; k <= settings->halvings; k++, step /= 2) {
        if (!middle_of(state, body, step, settings, middle))
            continue;
        certreg_spring_midpoint_step(state, body, middle, &step, next);
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
    const double *body = batch->bodies + i * CERTREG_SPRING_BODY;
    double *state = batch->states + i * CERTREG_QUATERNION_STATE;
    double perturbation = settings->first_perturbation, time = 0, speed;
    int end = CERTREG_GO_ON;
    int64_t taken = 0;
    batch->escapes[i] = 0;
    for (;; taken++) {
        certreg_spring_squared_speed(state, body, &speed);
        if (batch->log)
            certreg_record_spring(batch->log, taken, time, state, body);
        if (speed < settings->squared_tolerance) {
            end = certreg_escape_spring(state, body, 0, settings, &perturbation);
            batch->escapes[i] += end == CERTREG_PERTURBED;
        } else
            end = CERTREG_GO_ON;
        if (end == CERTREG_AT_REST || taken >= settings->max_steps || speed != speed)
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

void certreg_spring_midpoint_single(const struct certreg_batch *batch, const struct certreg_settings *settings)
{
    for (int64_t i = 0; i < batch->count; i++)
        run_one(batch, settings, i);
}
