/* Rank over all poses: bit-packed planes shared by direction, carry-save adders, tiles that stay in the cache.
 *
 * For one direction the bodies of all beams are prefixes of one chain of cells. Directions are taken in batches: per tile,
 * the chains of a batch are walked once, and what is free up to the end of each body is kept. Then, heading by heading, the
 * beams of the batch are counted seven at a time: what is kept of the body, and the grown map seen from the head. So
 * the counters of one heading stay in the first-level cache, and what is kept of a batch in the second. What a tile sees
 * of the map at an offset is looked at only where it can matter: its columns, taken together over 32 rows, tell.
 */
#include "count/count.h"

#include <stddef.h>
#include <string.h>

#include "shared/arena.h"
#include "shared/packed.h"
#include "shared/threads.h"

#define FEW 7
#define FOUND_MAX 112 /* sixteen sevens */
#define RUN 8         /* this many cells of a chain are walked before it is asked what is left */

/* What one thread keeps of the bodies of a batch in one tile: the free cells that each leaves open. Bodies of one chain
 * that leave the same cells share a plane. */
typedef struct {
    uint64_t *planes;  /* [slots + 3][32]; the last three are all free cells, none, and all cells */
    uint64_t *columns; /* [slots]: the columns of the tile that have an open cell */
    int32_t *plane_of; /* [slots] */
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
    const int is_near = word <= (uint32_t)job->map.words + 2 && row <= (uint32_t)job->map.rows + TILE;
    return is_near ? word * column_of(&job->map) + row : 0;
}

/* Of columns that were taken together over the rows of a tile: those that its cells see. */
static inline uint64_t columns_from(const uint64_t *low, size_t stride, uint64_t shift)
{
    return low[0] >> shift | low[stride] << 1 << (63 - shift);
}

#include "shared/vector_portable.h"

#include "count/count_body.h"

#if defined(__x86_64__) && defined(__GNUC__)
#define HAS_X86 1
#include "shared/vector_avx2.h"

#include "count/count_body.h"

#include "shared/vector_avx512.h"

#include "count/count_body.h"
#endif

/* What the threads share. */
typedef struct {
    const count_job *job;
    bodies kept[THREADS_MAX];
    int32_t instructions;
    int32_t next; /* tile */
} counting;

/* n - s = ~(~n + s), so taking away is adding to the complement. */
static void complement(const count_job *job, int32_t tile)
{
    const size_t size = (size_t)job->headings * (size_t)job->bits * TILE;
    uint64_t *counters = job->counters + (size_t)tile * size;
    for (size_t i = 0; i < size; i++)
        counters[i] = ~counters[i];
}

static void count_tile(const counting *all, int32_t tile, const bodies *kept)
{
    const count_job *job = all->job;
    static const int32_t here[2] = {0, 0};
    memcpy(kept->planes + (size_t)job->drawn.slots * TILE,
           job->map.free + seen_from(job, job->map.tiles + 2 * tile, here), TILE * sizeof *kept->planes);
#ifdef HAS_X86
    if (all->instructions == AVX512) {
        count_tile_avx512(job, tile, kept);
        return;
    }
    if (all->instructions == AVX2) {
        count_tile_avx2(job, tile, kept);
        return;
    }
#endif
    count_tile_portable(job, tile, kept);
}

static void count_tiles(void *shared, int32_t number)
{
    counting *all = shared;
    const count_job *job = all->job;
    const bodies *kept = &all->kept[number];
    uint64_t *after = kept->planes + (size_t)job->drawn.slots * TILE + TILE;
    memset(after, 0, TILE * sizeof *after);
    memset(after + TILE, 0xff, TILE * sizeof *after);
    for (int32_t tile; (tile = take_one(&all->next, job->map.tile_count)) >= 0;) {
        if (job->subtract)
            complement(job, tile);
        count_tile(all, tile, kept);
        if (job->subtract)
            complement(job, tile);
    }
}

/* Take what each thread needs from an arena. */
static void share_scratch(const count_job *job, arena *from, bodies *kept)
{
    const size_t slots = (size_t)job->drawn.slots;
    for (int32_t i = 0; i < clamp(job->threads, 1, THREADS_MAX); i++) {
        TAKE(from, kept[i].planes, (slots + 3) * TILE);
        TAKE(from, kept[i].columns, slots);
        TAKE(from, kept[i].plane_of, slots);
    }
}

int64_t count_scratch_words(const count_job *job)
{
    bodies none[THREADS_MAX];
    arena sizes = arena_in(NULL);
    share_scratch(job, &sizes, none);
    return arena_words(&sizes);
}

int32_t count_feasible(count_job *job)
{
    counting all = {.job = job, .instructions = instructions_for(job->instructions)};
    arena scratch = arena_in(job->scratch);
    if (all.instructions < 0)
        return 0;
    unfold(&job->map);
    share_scratch(job, &scratch, all.kept);
    share_among_threads(count_tiles, &all, job->threads);
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

#define HEAT_BITS 16

/* Keep the greater of two counts of each cell; both bit-sliced. */
static void keep_greater(uint64_t *best, const uint64_t *counter, int32_t bits)
{
    uint64_t greater[TILE], equal[TILE];
    memset(greater, 0, sizeof greater);
    memset(equal, 0xff, sizeof equal);
    for (int32_t bit = bits - 1; bit >= 0; bit--) {
        const uint64_t *kept = best + (size_t)bit * TILE, *other = counter + (size_t)bit * TILE;
        for (int i = 0; i < TILE; i++) {
            greater[i] |= equal[i] & other[i] & ~kept[i];
            equal[i] &= ~(other[i] ^ kept[i]);
        }
    }
    for (int32_t bit = 0; bit < bits; bit++) {
        uint64_t *kept = best + (size_t)bit * TILE;
        const uint64_t *other = counter + (size_t)bit * TILE;
        for (int i = 0; i < TILE; i++)
            kept[i] = (kept[i] & ~greater[i]) | (other[i] & greater[i]);
    }
}

/* Enter one row of a tile: the counts of 64 cells, of which the first is column `left` of what is looked at. */
static void enter_row(const heat_job *job, const uint64_t *counts, int32_t left, uint8_t *levels)
{
    for (int32_t b = left < 0 ? -left : 0; b < 64 && left + b < job->cols; b++) {
        uint64_t count = 0;
        for (int32_t bit = 0; bit < job->bits; bit++)
            count |= (counts[(size_t)bit * TILE] >> b & 1) << bit;
        const uint8_t level = (uint8_t)(count * 255 / (uint64_t)job->readings);
        uint8_t *to = levels + (left + b) / job->block;
        *to = level > *to ? level : *to;
    }
}

void heat(const heat_job *job)
{
    const size_t across = (size_t)((job->cols + job->block - 1) / job->block), size = (size_t)job->bits * TILE;
    uint64_t best[HEAT_BITS * TILE];
    for (int32_t tile = 0; tile < job->tile_count; tile++) {
        const uint64_t *counters = job->counters + (size_t)tile * (size_t)job->headings * size;
        memcpy(best, counters, size * sizeof *best);
        for (int32_t heading = 1; heading < job->headings; heading++)
            keep_greater(best, counters + (size_t)heading * size, job->bits);
        const int32_t left = job->tiles[2 * tile] * 64 - job->first[1];
        for (int32_t i = 0; i < TILE; i++) {
            const int32_t row = job->tiles[2 * tile + 1] + i - job->first[0];
            if (row >= 0 && row < job->rows)
                enter_row(job, best + i, left, job->levels + (size_t)(row / job->block) * across);
        }
    }
}
