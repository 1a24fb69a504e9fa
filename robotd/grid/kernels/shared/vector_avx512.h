/* Vectors of 64 bytes for processors with AVX-512 and its funnel shifts. See vector.h. */
#include <immintrin.h>

#include "shared/vector_forget.h"

#define NAME(x) x##_avx512
#define TARGET __attribute__((target("avx512f,avx512bw,avx512vl,avx512vbmi2,bmi2")))
#define VECTOR 64
#define FUNNEL(a, b, n) ((VEC)_mm512_shrdv_epi64((__m512i)(a), (__m512i)(b), _mm512_set1_epi64((long long)(n))))
#define SLIDE(a, b, n) _mm256_shrdv_epi16((__m256i)(a), (__m256i)(b), _mm256_set1_epi16((short)(n)))
#define ANY(a) ((uint64_t)_mm512_reduce_or_epi64((__m512i)(a)))
#define IS_ZERO(a) (_mm512_test_epi64_mask((__m512i)(a), (__m512i)(a)) == 0)
#define TERNARY(a, b, c, table) ((VEC)_mm512_ternarylogic_epi64((__m512i)(a), (__m512i)(b), (__m512i)(c), table))
#define XOR3(a, b, c) TERNARY(a, b, c, 0x96)
#define MAJORITY(a, b, c) TERNARY(a, b, c, 0xE8)

#include "shared/vector.h"
