/* Vectors of 32 bytes for processors with AVX2. See vector.h. */
#include <immintrin.h>

#include "shared/vector_forget.h"

#define NAME(x) x##_avx2
#define TARGET __attribute__((target("avx2,bmi2")))
#define VECTOR 32
#define FUNNEL(a, b, n)                                                                                                \
    ((VEC)_mm256_or_si256(_mm256_srl_epi64((__m256i)(a), _mm_cvtsi64_si128((long long)(n))),                           \
                          _mm256_sll_epi64((__m256i)(b), _mm_cvtsi64_si128((long long)(64 - (n))))))
#define SLIDE(a, b, n)                                                                                                 \
    _mm256_or_si256(_mm256_srl_epi16((__m256i)(a), _mm_cvtsi32_si128(n)),                                              \
                    _mm256_sll_epi16((__m256i)(b), _mm_cvtsi32_si128(16 - (n))))
#define ANY(a) ((a)[0] | (a)[1] | (a)[2] | (a)[3])
#define IS_ZERO(a) _mm256_testz_si256((__m256i)(a), (__m256i)(a))
#define XOR3(a, b, c) ((a) ^ (b) ^ (c))
#define MAJORITY(a, b, c) (((a) & (b)) | ((c) & ((a) ^ (b))))

#include "shared/vector.h"
