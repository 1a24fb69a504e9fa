/* Vectors for a body that is written once and compiled for several instruction sets, each of which says:
 *   NAME(x)          the name of x for this instruction set
 *   TARGET           the attribute that allows its instructions
 *   VECTOR           how many bytes a vector has
 *   FUNNEL(a, b, n)  the low 64 bits of (b, a) >> n, lane by lane, 0 <= n < 64
 *   SLIDE(a, b, n)   for 16 lanes of 16 bits, the low 16 bits of (b, a) >> n, lane by lane, 0 <= n < 16
 *   ANY(a)           the OR of its lanes
 *   IS_ZERO(a)       whether that is 0
 *   XOR3(a, b, c)    a ^ b ^ c           MAJORITY(a, b, c)  two of them or more
 * Another set is one more header like vector_avx2.h, a line in cpu.c, and a line where a body is included.
 */
typedef uint64_t NAME(vec) __attribute__((vector_size(VECTOR), aligned(8), may_alias));
#define VEC NAME(vec)
#define LANES ((int)(VECTOR / sizeof(uint64_t)))
