/* What this processor has. */
#include "shared/shared.h"

const char *instruction_name(int32_t set)
{
    static const char *const names[INSTRUCTION_SETS] = {"portable", "avx2", "avx512"};
    return names[set];
}

static int32_t best_instructions(void)
{
#if defined(__x86_64__) && defined(__GNUC__)
    if (!__builtin_cpu_supports("bmi2") || !__builtin_cpu_supports("avx2"))
        return PORTABLE;
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") &&
        __builtin_cpu_supports("avx512vbmi2"))
        return AVX512;
    return AVX2;
#else
    return PORTABLE;
#endif
}

int32_t instructions_for(int32_t wanted)
{
    const int32_t best = best_instructions();
    return wanted > best ? -1 : wanted < 0 ? best : wanted;
}
