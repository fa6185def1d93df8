/* One trajectory loop: included with LOOP, STATE, BODY, BASIN, STEPS, ADVANCE, ESCAPE, RECORD defined; every
 * record of a step begins with h.
 *
 * A lane whose body came to its end takes the next one, so that all lanes work to the end. What a lane
 * has to be looked at for (slow, not a number, out of steps, logged) is rare: the loop itself
 * only steps, and tests all lanes at once. */
struct NAMED(LOOP, _lanes) {
    lanes one[STATE], other[STATE], body[BODY], step[STEPS];
    int64_t which[LANES];    /* -1: none */
    int64_t start[LANES];    /* the tick of its step 0 */
    int64_t passed[LANES];   /* the tick at which it is not looked at: it was, before a perturbation */
    double perturbation[LANES];
    int64_t waiting, live, due; /* the next body; how many run; the tick when the first is out of steps */
};

/* The next body for a lane from a tick on, or one that stands still and is never slow. */
static void NAMED(LOOP, _take)(struct NAMED(LOOP, _lanes) *own, lanes *state, int lane, int64_t tick,
                               const struct certreg_batch *batch, const struct certreg_settings *settings)
{
    const int64_t i = own->waiting < batch->count ? own->waiting++ : -1;
    own->which[lane] = i, own->start[lane] = tick, own->passed[lane] = -1;
    own->perturbation[lane] = settings->first_perturbation;
    own->live += i >= 0;
    for (int k = 0; k < BODY; k++)
        AT(own->body[k], lane) = i < 0 ? 0 : batch->bodies[i * BODY + k];
    for (int k = 0; k < STATE; k++)
        AT(state[k], lane) = i < 0 ? 1 : batch->states[i * STATE + k];
    for (int k = 0; k < STEPS; k++)
        AT(own->step[k], lane) = i < 0 ? 0 : batch->steps[i * STEPS + k];
    if (i >= 0)
        batch->escapes[i] = 0;
}

/* What becomes of a lane at a tick; `next` is overwritten where that is not the step just made. */
static void NAMED(LOOP, _look)(struct NAMED(LOOP, _lanes) *own, const lanes *state, lanes *next, int lane,
                               int64_t tick, double speed, const struct certreg_batch *batch,
                               const struct certreg_settings *settings)
{
    const int64_t i = own->which[lane];
    const int64_t taken = tick - own->start[lane];
    const int slow = speed < settings->squared_tolerance;
    const int last = taken >= settings->max_steps || speed != speed; /* NaN stays NaN */
    if (!(slow || last || batch->log) || i < 0 || own->passed[lane] == tick)
        return;
    const double *body = batch->bodies + i * BODY;
    const double time = (double)taken * batch->steps[i * STEPS + CERTREG_STEP_H];
    double alone[STATE];
    int end = CERTREG_GO_ON;
    for (int k = 0; k < STATE; k++)
        alone[k] = AT(state[k], lane);
    if (batch->log)
        RECORD(batch->log, taken, time, alone, body);
    if (slow)
        end = ESCAPE(alone, body, batch->basins + i * BASIN, settings, own->perturbation + lane);
    batch->escapes[i] += end == CERTREG_PERTURBED;
    if (end == CERTREG_CONVERGED || end == CERTREG_AT_REST || last) {
        batch->status[i] = end == CERTREG_PERTURBED ? CERTREG_GO_ON : end;
        batch->taken[i] = taken;
        batch->times[i] = time;
        for (int k = 0; k < STATE; k++)
            batch->states[i * STATE + k] = alone[k];
        own->live--;
        NAMED(LOOP, _take)(own, next, lane, tick + 1, batch, settings);
    } else if (end == CERTREG_PERTURBED) { /* the step is to be made from where the perturbation led */
        own->start[lane]++, own->passed[lane] = tick + 1;
        for (int k = 0; k < STATE; k++)
            AT(next[k], lane) = alone[k];
    }
}

static __attribute__((noinline)) void NAMED(LOOP, _look_at_all)(
    struct NAMED(LOOP, _lanes) *own, const lanes *state, lanes *next, int64_t tick, const lanes *speed,
    const struct certreg_batch *batch, const struct certreg_settings *settings)
{
    for (int lane = 0; lane < LANES; lane++)
        NAMED(LOOP, _look)(own, state, next, lane, tick, AT(*speed, lane), batch, settings);
    own->due = INT64_MAX;
    for (int lane = 0; lane < LANES; lane++) {
        const int64_t due = own->start[lane] + settings->max_steps;
        if (batch->log)
            own->due = tick + 1;
        else if (own->which[lane] >= 0 && due < own->due)
            own->due = due;
    }
}

void LOOP(const struct certreg_batch *batch, const struct certreg_settings *settings)
{
    struct NAMED(LOOP, _lanes) own = {.due = 0};
    lanes *state = own.one, *next = own.other, speed;
    for (int lane = 0; lane < LANES; lane++)
        NAMED(LOOP, _take)(&own, state, lane, 0, batch, settings);
    for (int64_t tick = 0; own.live; tick++) {
        ADVANCE(state, own.body, own.step, next, &speed);
        if (tick >= own.due || !all_above(speed, settings->squared_tolerance))
            NAMED(LOOP, _look_at_all)(&own, state, next, tick, &speed, batch, settings);
        lanes *const done = state;
        state = next, next = done;
    }
}
#undef LOOP
#undef STATE
#undef BODY
#undef BASIN
#undef STEPS
#undef ADVANCE
#undef ESCAPE
#undef RECORD
