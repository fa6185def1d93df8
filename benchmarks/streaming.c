/* What memory can do: the sum of an array, read once, with as many loads under way as there can be. */
#include <stdint.h>
#include <string.h>

typedef double lanes __attribute__((vector_size(64)));

double benchmark_sum(const double *values, int64_t count)
{
    lanes sum[4] = {{0}};
    double total = 0.0;
    int64_t i = 0;
    for (; i + 32 <= count; i += 32)
        for (int k = 0; k < 4; k++) {
            lanes part;
            memcpy(&part, values + i + 8 * k, sizeof part);
            sum[k] += part;
        }
    for (; i < count; i++)
        total += values[i];
    for (int k = 0; k < 4; k++)
        for (int lane = 0; lane < 8; lane++)
            total += sum[k][lane];
    return total;
}
