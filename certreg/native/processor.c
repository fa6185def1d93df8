/* How wide the instructions are that this processor has and its system keeps: which library to load.
 *
 * The levels of x86-64 are those of its psABI, and of the compilers' -march=x86-64-v3 and -v4; 1 on every
 * other processor. */
int certreg_level(void);

#if defined(__x86_64__)
#include <cpuid.h>
#include <stdint.h>

#define BIT(k) (UINT32_C(1) << (k))
#define SSE3_TO_V2 (BIT(0) | BIT(9) | BIT(13) | BIT(19) | BIT(20) | BIT(23)) /* of leaf 1, ecx */
#define AVX_FMA_MOVBE_F16C (BIT(12) | BIT(22) | BIT(27) | BIT(28) | BIT(29)) /* the same; 27: xgetbv */
#define AVX2_BMI (BIT(3) | BIT(5) | BIT(8))                                   /* of leaf 7, ebx */
#define AVX512_F_DQ_CD_BW_VL (BIT(16) | BIT(17) | BIT(28) | BIT(30) | BIT(31))
#define LZCNT BIT(5)                                                          /* of leaf 80000001, ecx */
#define YMM (BIT(1) | BIT(2)) /* registers that the system saves, of xgetbv */
#define ZMM (YMM | BIT(5) | BIT(6) | BIT(7))

static int has(uint32_t found, uint32_t wanted) { return (found & wanted) == wanted; }

static uint32_t saved_registers(void)
{
    uint32_t low, high;
    __asm__ volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    return low;
}

int certreg_level(void)
{
    uint32_t a, b, c, d, first, seventh, extended;
    if (!__get_cpuid(1, &a, &b, &first, &d) || !__get_cpuid_count(7, 0, &a, &seventh, &c, &d) ||
        !__get_cpuid(0x80000001, &a, &b, &extended, &d))
        return 1;
    if (!has(first, SSE3_TO_V2 | AVX_FMA_MOVBE_F16C) || !has(seventh, AVX2_BMI) || !has(extended, LZCNT) ||
        !has(saved_registers(), YMM))
        return 1;
    return has(seventh, AVX512_F_DQ_CD_BW_VL) && has(saved_registers(), ZMM) ? 4 : 3;
}

#else

int certreg_level(void) { return 1; }

#endif
