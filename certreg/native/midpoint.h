/* The implicit midpoint rule: Newton's method for the middle velocities, halving the step where it fails. Whatever
 * root is found, the energy of a step falls by what damping takes.
 *
 * Included with RULE, UNKNOWNS, BODY, BASIN, RESIDUAL, SOLVE, STEP, SPEED, ESCAPE and RECORD defined. The unknowns
 * end with the middle angular velocity; six begin with the middle velocity. */
#include <math.h>
#include <string.h>

#define SHIFTS (UNKNOWNS - 3)

/* The middle velocities by Newton's method from the present ones; 0 if it does not converge. */
static int middle_of(const double state[CERTREG_QUATERNION_STATE], const double body[BODY], double step,
                     const struct certreg_settings *settings, double middle[UNKNOWNS])
{
    double residual[UNKNOWNS], jacobian[UNKNOWNS * UNKNOWNS], change[UNKNOWNS], before = INFINITY;
    memcpy(middle, state + CERTREG_QUATERNION_STATE_V, SHIFTS * sizeof(double));
    memcpy(middle + SHIFTS, state + CERTREG_QUATERNION_STATE_OMEGA, 3 * sizeof(double));
    for (int64_t k = 0; k < settings->newton_steps; k++) {
        RESIDUAL(state, body, middle, &step, residual, jacobian);
        if (!SOLVE(jacobian, residual, change))
            return 0;
        double speed = 0, size = 0, shifted = 0, moved = 0;
        for (int i = 0; i < UNKNOWNS; i++)
            middle[i] -= change[i];
        for (int i = 0; i < SHIFTS; i++)
            speed += middle[i] * middle[i], shifted += change[i] * change[i];
        for (int i = SHIFTS; i < UNKNOWNS; i++)
            size += middle[i] * middle[i], moved += change[i] * change[i];
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
static double advance(double state[CERTREG_QUATERNION_STATE], const double body[BODY], double step,
                      const struct certreg_settings *settings)
{
    double middle[UNKNOWNS], next[CERTREG_QUATERNION_STATE], *q = next + CERTREG_QUATERNION_STATE_Q;
    for (int64_t k = 0; k <= settings->halvings; k++, step /= 2) {
        if (!middle_of(state, body, step, settings, middle))
            continue;
        STEP(state, body, middle, &step, next);
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
    const double *body = batch->bodies + i * BODY, *basin = batch->basins + i * BASIN;
    double *state = batch->states + i * CERTREG_QUATERNION_STATE;
    double perturbation = settings->first_perturbation, time = 0, speed;
    int end = CERTREG_GO_ON;
    int64_t taken = 0;
    batch->escapes[i] = 0;
    for (;; taken++) {
        SPEED(state, body, &speed);
        if (batch->log)
            RECORD(batch->log, taken, time, state, body);
        if (speed < settings->squared_tolerance) {
            end = ESCAPE(state, body, basin, settings, &perturbation);
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

void RULE(const struct certreg_batch *batch, const struct certreg_settings *settings)
{
    for (int64_t i = 0; i < batch->count; i++)
        run_one(batch, settings, i);
}
