/* Rank over all poses: bit-packed planes shared by direction, carry-save adders, tiles that stay in the cache.
 *
 * For one direction the bodies of all beams are prefixes of one chain of cells. Directions are taken in batches: per tile,
 * the chains of a batch are walked once, and what is free up to the end of each body is kept. Then, heading by heading, the
 * beams of the batch are counted seven at a time: what is kept of the body, and the grown map seen from the head. So
 * the counters of one heading stay in the first-level cache, and what is kept of a batch in the second. What a tile sees
 * of the map at an offset is looked at only where it can matter: its columns, taken together over 32 rows, tell.
 */
#include <pthread.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "count/count.h"
#include "draw/draw.h"

#define TILE 32
#define THREADS_MAX 16
#define FEW 7
#define FOUND_MAX 112 /* sixteen sevens */
#define RUN 8         /* so many cells of a chain are walked before it is asked what is left */

/* What one thread keeps of the bodies of a batch in one tile: the free cells that each leaves open. Bodies of one chain
 * that leave the same cells share a plane. */
typedef struct {
    uint64_t *planes;   /* [slots + 3][32]; the last three are all free cells, none, and all cells */
    uint64_t *columns;  /* [slots]: the columns of the tile that have an open cell */
    int32_t *plane_of;  /* [slots] */
} bodies;

/* Where to find the plane of one beam in one tile. */
typedef struct {
    const uint64_t *low, *high; /* what lies at the head, from bit `shift` on */
    uint64_t shift;
    const uint64_t *body;
} source;

/* Where in a plane the words are that hold, from bit `offset[1] & 63` on, what the cells of a tile see at an offset. All
 * that lies farther outside than the padding is like its first corner. */
static inline size_t seen_from(const count_job *job, const int32_t *tile, const int32_t *offset)
{
    const uint32_t word = (uint32_t)(tile[0] + 2 + (offset[1] >> 6)), row = (uint32_t)(tile[1] + TILE + offset[0]);
    const int is_near = word <= (uint32_t)job->words + 2 && row <= (uint32_t)job->rows + TILE;
    return is_near ? word * ((size_t)job->rows + 2 * TILE) + row : 0;
}

/* Of columns that were taken together over the rows of a tile: those that its cells see. */
static inline uint64_t columns_from(const uint64_t *low, size_t stride, uint64_t shift)
{
    return low[0] >> shift | low[stride] << 1 << (63 - shift);
}

#define NAME(x) x##_portable
#define TARGET
#define VECTOR 16
#define FUNNEL(a, b, n) ((a) >> (n) | ((b) + (b)) << (63 - (n)))
#define ANY(a) ((a)[0] | (a)[1])
#define IS_ZERO(a) (ANY(a) == 0)
#define XOR3(a, b, c) (a ^ b ^ c)
#define MAJORITY(a, b, c) ((a & b) | (c & (a ^ b)))
#include "count/count_body.h"

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#define HAS_X86 1

#define NAME(x) x##_avx2
#define TARGET __attribute__((target("avx2,bmi2")))
#define VECTOR 32
#define FUNNEL(a, b, n)                                                                                                \
    ((VEC)_mm256_or_si256(_mm256_srl_epi64((__m256i)(a), _mm_cvtsi64_si128((long long)(n))),                           \
                          _mm256_sll_epi64((__m256i)(b), _mm_cvtsi64_si128((long long)(64 - (n))))))
#define ANY(a) ((a)[0] | (a)[1] | (a)[2] | (a)[3])
#define IS_ZERO(a) _mm256_testz_si256((__m256i)(a), (__m256i)(a))
#define XOR3(a, b, c) (a ^ b ^ c)
#define MAJORITY(a, b, c) ((a & b) | (c & (a ^ b)))
#include "count/count_body.h"

#define TERNARY(a, b, c, table) ((VEC)_mm512_ternarylogic_epi64((__m512i)(a), (__m512i)(b), (__m512i)(c), table))
#define NAME(x) x##_avx512
#define TARGET __attribute__((target("avx512f,avx512vbmi2,bmi2")))
#define VECTOR 64
#define FUNNEL(a, b, n) ((VEC)_mm512_shrdv_epi64((__m512i)(a), (__m512i)(b), _mm512_set1_epi64((long long)(n))))
#define ANY(a) ((uint64_t)_mm512_reduce_or_epi64((__m512i)(a)))
#define IS_ZERO(a) (_mm512_test_epi64_mask((__m512i)(a), (__m512i)(a)) == 0)
#define XOR3(a, b, c) TERNARY(a, b, c, 0x96)
#define MAJORITY(a, b, c) TERNARY(a, b, c, 0xE8)
#include "count/count_body.h"
#endif

typedef enum { PORTABLE, AVX2, AVX512 } level;

static level best_level(void)
{
#ifdef HAS_X86
    if (!__builtin_cpu_supports("bmi2"))
        return PORTABLE;
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vbmi2"))
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

static void count_tile(const worker *self, int32_t tile, const bodies *kept)
{
    const count_job *job = self->job;
    static const int32_t here[2] = {0, 0};
    memcpy(kept->planes + (size_t)job->slots * TILE, job->free + seen_from(job, job->tiles + 2 * tile, here),
           TILE * sizeof *kept->planes);
#ifdef HAS_X86
    if (self->level == AVX512) {
        count_tile_avx512(job, tile, kept);
        return;
    }
    if (self->level == AVX2) {
        count_tile_avx2(job, tile, kept);
        return;
    }
#endif
    count_tile_portable(job, tile, kept);
}

static void *work(void *argument)
{
    const worker *self = argument;
    const size_t slots = (size_t)self->job->slots, size = (slots + 3) * TILE;
    uint64_t *planes = self->job->spare + (size_t)self->number * (size + 2 * slots), *columns = planes + size;
    const bodies kept = {planes, columns, (int32_t *)(columns + slots)};
    memset(planes + (slots + 1) * TILE, 0, TILE * sizeof *planes);
    memset(planes + (slots + 2) * TILE, 0xff, TILE * sizeof *planes);
    for (;;) {
        const int32_t tile = __atomic_fetch_add(self->next, 1, __ATOMIC_RELAXED);
        if (tile >= self->job->tile_count)
            return NULL;
        if (self->subtract)
            complement(self->job, tile);
        count_tile(self, tile, &kept);
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

int32_t count_feasible(count_job *job, int32_t subtract, int32_t threads, int32_t instructions)
{
    const size_t size = ((size_t)job->words + 4) * ((size_t)job->rows + 2 * TILE);
    job->free = job->planes;
    job->blocking = job->free + size;
    job->grown = job->blocking + size;
    job->stopping = job->grown + size;
    job->ending = job->stopping + size;
    job->chains = job->drawn + job->drawn[0];
    job->groups = job->drawn + job->drawn[1];
    job->beams = job->drawn + job->drawn[2];
    job->batches = job->drawn + job->drawn[3];
    job->lists = job->drawn + job->drawn[4];
    job->batch_count = (int32_t)(job->lists - job->batches) - 1;
    job->slots = job->drawn[6];
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
