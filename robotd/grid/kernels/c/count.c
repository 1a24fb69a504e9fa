/* Rank over all poses: bit-packed planes shared by direction, carry-save adders, tiles that stay in the cache.
 *
 * For one direction the bodies of all beams are prefixes of one chain of cells: the chain is walked once per tile, and
 * every beam takes the blocked set as it is after its own length. Its plane of feasible cells waits with the others of
 * its heading until there are seven, which are added to the heading's counters at once.
 */
#include <pthread.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "kernels.h"

#define TILE 32
#define NO_HEAD INT32_MIN
#define THREADS_MAX 16

static inline int32_t clamp(int32_t value, int32_t low, int32_t high)
{
    return value < low ? low : value > high ? high : value;
}

#define NAME(x) x##_portable
#define TARGET
#define VECTOR 16
#define AND_NOT(a, b, c) ((a | b) & ~c)
#define XOR3(a, b, c) (a ^ b ^ c)
#define MAJORITY(a, b, c) ((a & b) | (c & (a ^ b)))
#include "count_body.h"

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#define HAS_X86 1

#define NAME(x) x##_avx2
#define TARGET __attribute__((target("avx2")))
#define VECTOR 32
#define AND_NOT(a, b, c) ((a | b) & ~c)
#define XOR3(a, b, c) (a ^ b ^ c)
#define MAJORITY(a, b, c) ((a & b) | (c & (a ^ b)))
#include "count_body.h"

#define TERNARY(a, b, c, table) ((VEC)_mm512_ternarylogic_epi64((__m512i)(a), (__m512i)(b), (__m512i)(c), table))
#define NAME(x) x##_avx512
#define TARGET __attribute__((target("avx512f")))
#define VECTOR 64
#define AND_NOT(a, b, c) TERNARY(a, b, c, 0x54)
#define XOR3(a, b, c) TERNARY(a, b, c, 0x96)
#define MAJORITY(a, b, c) TERNARY(a, b, c, 0xE8)
#include "count_body.h"
#endif

typedef enum { PORTABLE, AVX2, AVX512 } level;

static level best_level(void)
{
#ifdef HAS_X86
    if (__builtin_cpu_supports("avx512f"))
        return AVX512;
    if (__builtin_cpu_supports("avx2"))
        return AVX2;
#endif
    return PORTABLE;
}

const char *instruction_set(void)
{
    static const char *const names[] = {"portable", "avx2", "avx512"};
    return names[best_level()];
}

typedef struct {
    const count_job *job;
    int32_t *next;
    int32_t number;
    int32_t subtract;
    level level;
} worker;

/* n - s = ~(~n + s), so taking away is adding to the complement. */
static void complement(const count_job *job, int32_t tile)
{
    const size_t size = (size_t)job->headings * (size_t)job->bits * TILE;
    uint64_t *counters = job->counters + (size_t)tile * size;
    for (size_t i = 0; i < size; i++)
        counters[i] = ~counters[i];
}

static void count_tile(const worker *self, int32_t tile)
{
    const count_job *job = self->job;
    uint64_t *pending = job->pending + (size_t)self->number * (size_t)job->headings * 7 * TILE;
    int32_t *waiting = job->waiting + (size_t)self->number * (size_t)job->headings;
#ifdef HAS_X86
    if (self->level == AVX512) {
        count_tile_avx512(job, tile, (vec_avx512 *)pending, waiting);
        return;
    }
    if (self->level == AVX2) {
        count_tile_avx2(job, tile, (vec_avx2 *)pending, waiting);
        return;
    }
#endif
    count_tile_portable(job, tile, (vec_portable *)pending, waiting);
}

static void *work(void *argument)
{
    const worker *self = argument;
    for (;;) {
        const int32_t tile = __atomic_fetch_add(self->next, 1, __ATOMIC_RELAXED);
        if (tile >= self->job->tile_count)
            return NULL;
        if (self->subtract)
            complement(self->job, tile);
        count_tile(self, tile);
        if (self->subtract)
            complement(self->job, tile);
    }
}

static void run(const count_job *job, int32_t subtract, int32_t threads, level with)
{
    int32_t next = 0;
    worker workers[THREADS_MAX];
    pthread_t handles[THREADS_MAX];
    int32_t started = 1;
    for (int32_t i = 0; i < threads && i < THREADS_MAX; i++)
        workers[i] = (worker){job, &next, i, subtract, with};
    while (started < threads && started < THREADS_MAX &&
           pthread_create(&handles[started], NULL, work, &workers[started]) == 0)
        started++;
    work(&workers[0]); /* a thread that could not be started is no harm: the tiles are taken one by one */
    for (int32_t i = 1; i < started; i++)
        pthread_join(handles[i], NULL);
}

int32_t count_feasible(const count_job *job, int32_t subtract, int32_t threads, int32_t instructions)
{
    const level best = best_level();
    if (instructions > (int32_t)best)
        return 0;
    run(job, subtract, threads, instructions < 0 ? best : (level)instructions);
    return 1;
}

static uint32_t greatest_of(const uint64_t *counter, int32_t bits)
{
    uint64_t best[TILE];
    uint32_t value = 0;
    memset(best, 0xff, sizeof best);
    for (int32_t bit = bits - 1; bit >= 0; bit--) {
        const uint64_t *plane = counter + (size_t)bit * TILE;
        uint64_t any = 0;
        for (int i = 0; i < TILE; i++)
            any |= best[i] & plane[i];
        if (any == 0)
            continue;
        value |= (uint32_t)1 << bit;
        for (int i = 0; i < TILE; i++)
            best[i] &= plane[i];
    }
    return value;
}

uint32_t greatest(const uint64_t *counters, int64_t n, int32_t bits)
{
    uint32_t best = 0;
    for (int64_t i = 0; i < n; i++) {
        const uint32_t value = greatest_of(counters + (size_t)i * (size_t)bits * TILE, bits);
        best = value > best ? value : best;
    }
    return best;
}

/* Compare bit by bit from the top: greater so far, or equal so far. */
static void reach(const uint64_t *counter, int32_t bits, uint32_t least, uint64_t *mask)
{
    uint64_t equal[TILE];
    memset(equal, 0xff, sizeof equal);
    memset(mask, 0, sizeof equal);
    for (int32_t bit = bits - 1; bit >= 0; bit--) {
        const uint64_t *plane = counter + (size_t)bit * TILE;
        const uint64_t wanted = (least >> bit) & 1 ? ~(uint64_t)0 : 0;
        for (int i = 0; i < TILE; i++) {
            mask[i] |= equal[i] & plane[i] & ~wanted;
            equal[i] &= ~(plane[i] ^ wanted);
        }
    }
    for (int i = 0; i < TILE; i++)
        mask[i] |= equal[i];
}

void at_least(const uint64_t *counters, const int32_t *tiles, int32_t tile_count, int32_t headings, int32_t bits,
              uint32_t least, int32_t rows, int32_t words, uint64_t *masks)
{
    uint64_t mask[TILE];
    for (int32_t tile = 0; tile < tile_count; tile++) {
        uint64_t *corner = masks + (size_t)tiles[2 * tile + 1] * (size_t)words + (size_t)tiles[2 * tile];
        for (int32_t heading = 0; heading < headings; heading++) {
            reach(counters, bits, least, mask);
            counters += (size_t)bits * TILE;
            uint64_t *to = corner + (size_t)heading * (size_t)rows * (size_t)words;
            for (int i = 0; i < TILE; i++)
                to[(size_t)i * (size_t)words] = mask[i];
        }
    }
}
