/* The smallest error radius of every cell: per tile, what every reading needs at each cell, and then the quantile of it.
 *
 * Bodies are walked 64 cells at a time; a cell is touched once by every reading, where its beam is stopped. The quantile
 * is found bit by bit from the top, by counting which readings need less: that runs over all cells of a row at once.
 */
#include "error_radius/error_radius.h"

#include <stddef.h>
#include <string.h>

#include "shared/packed.h"
#include "shared/threads.h"

#define WORD WORD_CELLS
#define NEVER UINT16_MAX

typedef struct {
    const errors_job *job;
    const int32_t *tile;
    uint64_t free[TILE];
    uint16_t *needed; /* [reading_count][TILE][WORD] */
} place;

/* Write down what cells need whose beams are stopped here. */
static void stop(uint64_t stopped, uint16_t length, uint16_t *needed)
{
    for (; stopped != 0; stopped &= stopped - 1)
        needed[__builtin_ctzll(stopped)] = length;
}

static void walk(const place *at, const int32_t *reading, uint16_t *needed)
{
    const errors_job *job = at->job;
    const size_t stride = column_of(&job->map);
    uint64_t open[TILE], met[TILE];
    memcpy(open, at->free, sizeof open);
    memset(met, job->map.blocked_by > 1 ? 0 : 0xff, sizeof met);
    memset(needed, 0, TILE * WORD * sizeof *needed);
    for (int32_t cell = reading[0]; cell < reading[1]; cell++) {
        const int32_t *offset = job->chains + 2 * (size_t)cell, shift = offset[1] & 63;
        const uint64_t *blocking = words_at(&job->map, job->map.blocking, at->tile, offset[0], offset[1]);
        uint64_t stopped[TILE], any = 0, left = 0;
        for (int i = 0; i < TILE; i++) {
            const uint64_t here = funnel(blocking[i], blocking[stride + i], shift);
            stopped[i] = open[i] & met[i] & here;
            met[i] |= here;
            open[i] &= ~stopped[i];
            any |= stopped[i];
            left |= open[i];
        }
        if (any != 0)
            for (int i = 0; i < TILE; i++)
                stop(stopped[i], job->lengths[cell], needed + i * WORD);
        if (left == 0)
            return;
    }
}

static int32_t clip(int32_t value, int32_t most)
{
    return value < 0 ? 0 : value > most ? most : value;
}

/* Raise what a row of cells needs to what the ends of their beams need. */
static void raise_row(const errors_job *job, int32_t row, int32_t col, uint16_t *needed)
{
    const int inside = row >= 0 && row < job->map_rows;
    const int32_t first = inside ? clip(-col, WORD) : WORD, end = inside ? clip(job->map_cols - col, WORD) : WORD;
    const uint16_t *distances = job->distances + (inside ? (ptrdiff_t)row * job->map_cols + col : 0);
    if (first == 0 && end == WORD) { /* most often: a loop that can be vectorized */
        for (int i = 0; i < WORD; i++)
            needed[i] = needed[i] > distances[i] ? needed[i] : distances[i];
        return;
    }
    for (int i = 0; i < WORD; i++) {
        const uint16_t distance = i >= first && i < end ? distances[i] : job->outside;
        needed[i] = needed[i] > distance ? needed[i] : distance;
    }
}

/* How many readings need no more than `bound`, cell by cell. */
static void count(const place *at, int row, const uint16_t *bound, uint16_t *counts)
{
    uint16_t here[WORD] = {0}, limit[WORD];
    memcpy(limit, bound, sizeof limit);
    for (int32_t reading = 0; reading < at->job->reading_count; reading++) {
        const uint16_t *needed = at->needed + ((size_t)reading * TILE + (size_t)row) * WORD;
        for (int i = 0; i < WORD; i++)
            here[i] += needed[i] <= limit[i];
    }
    memcpy(counts, here, sizeof here);
}

/* The greatest number that any reading needs in a row, NEVER not counted. */
static uint16_t greatest_needed(const place *at, int row)
{
    uint16_t most[WORD] = {0}, greatest = 0;
    for (int32_t reading = 0; reading < at->job->reading_count; reading++) {
        const uint16_t *needed = at->needed + ((size_t)reading * TILE + (size_t)row) * WORD;
        for (int i = 0; i < WORD; i++) {
            const uint16_t value = needed[i] == NEVER ? 0 : needed[i];
            most[i] = most[i] > value ? most[i] : value;
        }
    }
    for (int i = 0; i < WORD; i++)
        greatest = greatest > most[i] ? greatest : most[i];
    return greatest;
}

/* The smallest numbers that are enough for `wanted` readings: those below which there are fewer. */
static void quantile(const place *at, int row, uint16_t *found)
{
    const int32_t wanted = at->job->wanted;
    const uint16_t greatest = greatest_needed(at, row);
    uint16_t bound[WORD], counts[WORD];
    memset(found, 0, WORD * sizeof *found);
    for (int32_t bit = 1 << 15; bit != 0; bit >>= 1) {
        if (bit > greatest)
            continue;
        for (int i = 0; i < WORD; i++)
            bound[i] = (uint16_t)(found[i] | (bit - 1));
        count(at, row, bound, counts);
        for (int i = 0; i < WORD; i++)
            found[i] |= counts[i] < wanted ? (uint16_t)bit : 0;
    }
    count(at, row, found, counts);
    for (int i = 0; i < WORD; i++)
        found[i] = counts[i] < wanted ? NEVER : found[i];
}

static void solve(place *at)
{
    const errors_job *job = at->job;
    const int32_t top = at->tile[1] - job->origin_row, left = at->tile[0] * WORD - job->origin_col;
    memcpy(at->free, words_at(&job->map, job->map.free, at->tile, 0, 0), sizeof at->free);
    for (int32_t number = 0; number < job->reading_count; number++) {
        const int32_t *reading = job->readings + 4 * (size_t)number;
        uint16_t *needed = at->needed + (size_t)number * TILE * WORD;
        walk(at, reading, needed);
        if (reading[2] == NO_HEAD)
            continue;
        for (int row = 0; row < TILE; row++)
            if (at->free[row] != 0)
                raise_row(job, top + row + reading[2], left + reading[3], needed + row * WORD);
    }
    for (int row = 0; row < TILE; row++) {
        uint16_t found[WORD];
        if (at->free[row] == 0)
            continue;
        quantile(at, row, found);
        for (uint64_t free = at->free[row]; free != 0; free &= free - 1) {
            const int col = __builtin_ctzll(free);
            job->errors[(size_t)(top + row) * (size_t)job->map_cols + (size_t)(left + col)] = found[col];
        }
    }
}

/* What the threads share. */
typedef struct {
    const errors_job *job;
    int32_t next; /* tile */
} solving;

static void solve_tiles(void *shared, int32_t number)
{
    solving *all = shared;
    const errors_job *job = all->job;
    place at = {.job = job};
    at.needed = job->needed + (size_t)number * (size_t)job->reading_count * TILE * WORD;
    for (int32_t tile; (tile = take_one(&all->next, job->map.tile_count)) >= 0;) {
        at.tile = job->map.tiles + 2 * (size_t)tile;
        solve(&at);
    }
}

void share_errors(errors_job *job)
{
    solving all = {job, 0};
    unfold(&job->map);
    share_among_threads(solve_tiles, &all, job->threads);
}
