/* The search of one heading for every instruction set, and which of them this processor has. Included by search.c. */
#include "search/search_sheet.h"

#include "shared/vector_portable.h"

#include "search/search_body.h"

#if defined(__x86_64__) && defined(__GNUC__)
#define HAS_X86 1
#include "shared/vector_avx2.h"

#include "search/search_body.h"

#include "shared/vector_avx512.h"

#include "search/search_body.h"
#endif

static const kernel *kernel_of(int32_t instructions)
{
#ifdef HAS_X86
    static const kernel *const kernels[INSTRUCTION_SETS] = {&kernel_portable, &kernel_avx2, &kernel_avx512};
#else
    static const kernel *const kernels[INSTRUCTION_SETS] = {&kernel_portable};
#endif
    const int32_t set = instructions_for(instructions);
    return set < 0 ? NULL : kernels[set];
}
