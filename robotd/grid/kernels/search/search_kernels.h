/* The search of one heading for every instruction set, and which of them this processor has. Included by search.c. */
#include "search/search_sheet.h"

#define NAME(x) x##_portable
#define TARGET
#define VECTOR 16
#define FUNNEL(a, b, n) ((a) >> (n) | ((b) + (b)) << (63 - (n)))
#define SLIDE(a, b, n) ((a) >> (n) | (b) << 1 << (WINDOW - 1 - (n)))
#define XOR3(a, b, c) XOR3_(a, b, c)
#define MAJORITY(a, b, c) MAJORITY_(a, b, c)
#include "search/search_body.h"

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#define HAS_X86 1

#define NAME(x) x##_avx2
#define TARGET __attribute__((target("avx2")))
#define VECTOR 32
#define FUNNEL(a, b, n)                                                                                                \
    ((VEC)_mm256_or_si256(_mm256_srl_epi64((__m256i)(a), _mm_cvtsi64_si128((long long)(n))),                           \
                          _mm256_sll_epi64((__m256i)(b), _mm_cvtsi64_si128((long long)(64 - (n))))))
#define SLIDE(a, b, n)                                                                                                 \
    ((window)_mm256_or_si256(_mm256_srl_epi16((__m256i)(a), _mm_cvtsi32_si128(n)),                                     \
          _mm256_sll_epi16((__m256i)(b), _mm_cvtsi32_si128(WINDOW - (n)))))
#define XOR3(a, b, c) XOR3_(a, b, c)
#define MAJORITY(a, b, c) MAJORITY_(a, b, c)
#include "search/search_body.h"

#define TERNARY(a, b, c, table) ((VEC)_mm512_ternarylogic_epi64((__m512i)(a), (__m512i)(b), (__m512i)(c), table))
#define NAME(x) x##_avx512
#define TARGET __attribute__((target("avx512f,avx512bw,avx512vl,avx512vbmi2")))
#define VECTOR 64
#define FUNNEL(a, b, n) ((VEC)_mm512_shrdv_epi64((__m512i)(a), (__m512i)(b), _mm512_set1_epi64((long long)(n))))
#define SLIDE(a, b, n) ((window)_mm256_shrdv_epi16((__m256i)(a), (__m256i)(b), _mm256_set1_epi16((short)(n))))
#define XOR3(a, b, c) TERNARY(a, b, c, 0x96)
#define MAJORITY(a, b, c) TERNARY(a, b, c, 0xE8)
#include "search/search_body.h"
#endif

static const kernel *kernel_of(int32_t instructions)
{
#ifdef HAS_X86
    const int32_t best = __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") &&
                                 __builtin_cpu_supports("avx512vbmi2")
                             ? 2
                         : __builtin_cpu_supports("avx2") ? 1
                                                          : 0;
    static const kernel *const kernels[] = {&kernel_portable, &kernel_avx2, &kernel_avx512};
#else
    const int32_t best = 0;
    static const kernel *const kernels[] = {&kernel_portable};
#endif
    return instructions > best ? NULL : kernels[instructions < 0 ? best : instructions];
}
