/* One trajectory loop: included with LOOP, STATE, STEPS, ADVANCE, SETTLE, RECORD defined.
 *
 * A lane whose instance ended takes the next one, so that all lanes work to the end. */
void LOOP(const struct certreg_batch *batch, const struct certreg_settings *settings)
{
    lanes state[STATE] = {0}, next[STATE], body[CERTREG_BODY] = {0}, step[STEPS] = {0}, speed;
    long instance[LANES], taken[LANES], waiting = 0, live = 0;
    double kick[LANES];
    int passed[LANES]; /* looked at already, before the step that comes */
    int changed = 1;   /* a lane's state is not what `next` was computed from */

    for (int lane = 0; lane < LANES; lane++)
        instance[lane] = -1, taken[lane] = 0, passed[lane] = 0;
    for (;;) {
        for (int lane = 0; changed && lane < LANES; lane++) {
            if (instance[lane] >= 0 || waiting == batch->count)
                continue;
            const long i = waiting++;
            instance[lane] = i, taken[lane] = 0, passed[lane] = 0, kick[lane] = settings->first_kick;
            batch->escapes[i] = 0;
            live++;
            for (int k = 0; k < CERTREG_BODY; k++)
                AT(body[k], lane) = batch->bodies[i * CERTREG_BODY + k];
            for (int k = 0; k < STATE; k++)
                AT(state[k], lane) = batch->states[i * STATE + k];
            for (int k = 0; k < STEPS; k++)
                AT(step[k], lane) = batch->steps[i * STEPS + k];
        }
        if (!live)
            break;
        changed = 0;
        ADVANCE(state, body, step, next, &speed);
        for (int lane = 0; lane < LANES; lane++) {
            const long i = instance[lane];
            const int slow = AT(speed, lane) < settings->squared_tolerance;
            const int last = taken[lane] >= settings->max_steps;
            if (!(slow || last || batch->log) || i < 0 || passed[lane])
                continue;
            const double *alone_body = batch->bodies + i * CERTREG_BODY;
            double alone[STATE];
            int end = CERTREG_GO_ON;
            for (int k = 0; k < STATE; k++)
                alone[k] = AT(state[k], lane);
            if (batch->log)
                RECORD(batch->log, taken[lane], (double)taken[lane] * batch->steps[i * STEPS], alone,
                       alone_body);
            if (slow)
                end = SETTLE(alone, alone_body, batch->basins + i * CERTREG_BASIN, settings, kick + lane);
            passed[lane] = 1;
            if (end == CERTREG_KICKED) {
                batch->escapes[i]++;
                for (int k = 0; k < STATE; k++)
                    AT(state[k], lane) = alone[k];
                changed = 1;
            }
            if (end == CERTREG_CONVERGED || end == CERTREG_AT_REST || last) {
                batch->status[i] = end == CERTREG_KICKED ? CERTREG_GO_ON : end;
                batch->taken[i] = taken[lane];
                batch->times[i] = (double)taken[lane] * batch->steps[i * STEPS];
                for (int k = 0; k < STATE; k++)
                    batch->states[i * STATE + k] = alone[k];
                instance[lane] = -1;
                live--;
                changed = 1;
            }
        }
        if (changed)
            continue;
        for (int k = 0; k < STATE; k++)
            state[k] = next[k];
        for (int lane = 0; lane < LANES; lane++)
            taken[lane]++, passed[lane] = 0;
    }
}
#undef LOOP
#undef STATE
#undef STEPS
#undef ADVANCE
#undef SETTLE
#undef RECORD
