/* Doubles as integers times powers of two, and long numbers that take them up: for exact.c and exact_springs.c. */
#ifndef CERTREG_EXPONENTS_H
#define CERTREG_EXPONENTS_H

#include <stdint.h>
#include <string.h>

#ifdef __SIZEOF_INT128__

typedef struct {
    int64_t m, e;
} number;

/* Of the numbers other than 0 in a group of columns: where the lowest bit is set, over 2^-1074; the
 * least and the largest exponent over 2^-1074, of the last place. */
typedef struct {
    int64_t lowest, least, most;
} range;

/* The number m 2^(2^step e - 1074), |m| < 2^(52 + 2^step). */
static inline __attribute__((always_inline)) number split(double value, range *seen, const int step)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    const int64_t biased = bits >> 52 & 2047, normal = biased != 0, e = biased - normal;
    const int64_t size = (int64_t)(bits & ((UINT64_C(1) << 52) - 1)) | normal << 52;
    const int64_t m = size << (e & ((1 << step) - 1)), sign = -(int64_t)(bits >> 63);
    if (size != 0) {
        const int64_t lowest = e + __builtin_ctzll((uint64_t)size);
        seen->lowest = lowest < seen->lowest ? lowest : seen->lowest;
        seen->least = e < seen->least ? e : seen->least;
        seen->most = e > seen->most ? e : seen->most;
    }
    return (number){(m ^ sign) - sign, e >> step};
}

/* Add value 2^shift to a long number of `count` words. */
static inline void add_shifted(uint64_t *words, int64_t count, __int128 value, int64_t shift)
{
    const int bits = shift & 63;
    const uint64_t sign = value < 0 ? UINT64_MAX : 0, top = (uint64_t)(value >> 64);
    const unsigned __int128 moved = (unsigned __int128)value << bits;
    const uint64_t parts[3] = {
        (uint64_t)moved, (uint64_t)(moved >> 64), bits ? top >> (64 - bits) | sign << bits : sign};
    uint64_t carry = 0;
    for (int64_t k = shift >> 6, part = 0; k < count; k++, part++) {
        const uint64_t given = part < 3 ? parts[part] : sign;
        if (part >= 3 && given + carry == 0)
            return; /* the words above stay as they are */
        const unsigned __int128 total = (unsigned __int128)words[k] + given + carry;
        words[k] = (uint64_t)total;
        carry = (uint64_t)(total >> 64);
    }
}

#endif
#endif
