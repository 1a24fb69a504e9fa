/* The poses that explain the most readings, found without counting all: what Python calls.
 *
 * No allocation here: every buffer comes from the caller. search_twin.py gives the same answers.
 */
#ifndef ROBOTD_SEARCH_H
#define ROBOTD_SEARCH_H

#include <stdint.h>

#include "search/planes.h"
#include "shared/shared.h"

typedef struct {
    const search_map *map;
    const double *readings; /* [reading_count][4]: range [cells], (x, y) of the beam's start [m], is a miss; the sooner
                                * neighbours lie in different directions, the sooner bad poses are given up */
    const double *headings; /* [heading_count][2]: sine and cosine */
    const double *sines;    /* [heading_count][reading_count], of each beam's bearing in the map */
    const double *cosines;
    const int32_t *levels; /* [reading_count], of each range */
    const double *radii;   /* [map->levels]: error radius [cells] */
    int32_t reading_count, heading_count;
    double resolution_m, reach_cells;
    int32_t area[4];      /* rows from [0] to before [1], columns from [2] to before [3] */
    const int32_t *spans; /* [area rows][2]: first column and the one after the last */
    int32_t by_blocks;    /* whether blocks are bounded first, or the few windows of the area are looked at at once */
    int32_t slack, least_rank;
    int64_t budget; /* of what is looked at: heads in tiles of blocks, readings at windows, steps along bodies */
    int32_t limit;  /* of poses that are returned */
    int32_t bits;   /* planes of a counter, at least 3; 2^bits > reading_count */
    int32_t threads;
    int32_t instructions; /* as in count_feasible */
    uint64_t *scratch;    /* search_scratch_words() of it */
    int32_t *poses;       /* [2 * limit + 256][4]: heading, row, column, rank */
    int32_t best_rank;    /* out */
    int32_t least;        /* out: every pose of at least this rank is returned, and no other */
    int32_t pose_count;   /* out */
    int32_t is_complete;  /* out: whether the budget was enough */
} search_job;

/* How much scratch a search needs. */
int64_t search_scratch_words(const search_job *job);

/* Search. Returns 0, having done nothing, if the processor does not have these instructions. */
int32_t search_poses(search_job *job);

#endif
