/* Counting feasible poses: what Python calls. */
#ifndef ROBOTD_COUNT_H
#define ROBOTD_COUNT_H

#include "shared/shared.h"

typedef struct {
    packed_map map;
    drawn_beams drawn;
    int32_t headings;
    int32_t bits;         /* planes of a counter, at least 3 */
    uint64_t *counters;   /* [tile_count][headings][bits][32] */
    int32_t subtract;     /* take the beams back */
    int32_t threads;      /* at most THREADS_MAX */
    int32_t instructions; /* PORTABLE and the like, or -1 for the best that this processor has */
    uint64_t *scratch;    /* count_scratch_words() of it */
} count_job;

/* How much scratch this many threads need. */
int64_t count_scratch_words(const count_job *job);

/* Count every beam at every cell from which it is feasible, or take it back. Returns 0, having done nothing, if the
 * processor does not have these instructions. */
int32_t count_feasible(count_job *job);

/* The greatest count in [n][bits][32]. */
uint32_t greatest(const uint64_t *counters, int64_t n, int32_t bits);

/* Set the bits of the counts that reach `least` in masks[headings][rows][words]. */
void at_least(const uint64_t *counters, const int32_t *tiles, int32_t tile_count, int32_t headings, int32_t bits,
              uint32_t least, int32_t rows, int32_t words, uint64_t *masks);

/* The greatest count of each cell over all headings, as levels[][] from 0 to 255, which is a count of `readings`; a level
 * is the greatest of `block` x `block` cells. */
typedef struct {
    const uint64_t *counters; /* [tile_count][headings][bits][32] */
    const int32_t *tiles;     /* [tile_count][2] */
    int32_t tile_count;
    int32_t headings; /* at least 1 */
    int32_t bits;     /* at most 16 */
    int32_t readings; /* at least 1 */
    int32_t first[2]; /* row and column, counted from the first tile, of the first cell to look at */
    int32_t rows;     /* to look at */
    int32_t cols;
    int32_t block;
    uint8_t *levels; /* [ceil(rows / block)][ceil(cols / block)], zeros */
} heat_job;

void heat(const heat_job *job);

#endif
