/* Vectors of 16 bytes in plain C: what follows is compiled for any processor. See vector.h. */
#include "shared/vector_forget.h"

#define NAME(x) x##_portable
#define TARGET
#define VECTOR 16
#define FUNNEL(a, b, n) ((a) >> (n) | ((b) + (b)) << (63 - (n)))
#define SLIDE(a, b, n) ((a) >> (n) | (b) << 1 << (15 - (n)))
#define ANY(a) ((a)[0] | (a)[1])
#define IS_ZERO(a) (ANY(a) == 0)
#define XOR3(a, b, c) ((a) ^ (b) ^ (c))
#define MAJORITY(a, b, c) (((a) & (b)) | ((c) & ((a) ^ (b))))

#include "shared/vector.h"
