/* Registers by simulation with nothing but dynamics.c: the scheme of the paper, step by step.
 *
 *   cc -std=c99 -O2 example.c dynamics.c -lm -o example && ./example < survey.txt
 *
 * Reads 23 numbers of a body, 18 of a state, then step, tolerance and the largest number of steps;
 * prints the number of steps taken and the last state. dynamics.h says what the numbers are. */
#include <stdio.h>
#include <string.h>

#include "dynamics.h"

static int read_numbers(double *numbers, int count)
{
    for (int k = 0; k < count; k++)
        if (scanf("%lf", numbers + k) != 1)
            return 0;
    return 1;
}

int main(void)
{
    double body[23], state[18], control[3], next[18], squared_speed;
    long steps = 0;
    if (!read_numbers(body, 23) || !read_numbers(state, 18) || !read_numbers(control, 3)) {
        fprintf(stderr, "expected 44 numbers: body (23), state (18), step, tolerance, steps\n");
        return 2;
    }
    for (;; steps++) {
        certreg_euler_step(state, body, control, next, &squared_speed);
        if (squared_speed < control[1] * control[1] || steps >= (long)control[2])
            break;
        memcpy(state, next, sizeof state);
    }
    printf("%ld\n", steps);
    for (int k = 0; k < 18; k++)
        printf("%.17g\n", state[k]);
    return 0;
}
