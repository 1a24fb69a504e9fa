/* Drawing beams on the grid: what Python calls. */
#ifndef ROBOTD_DRAW_H
#define ROBOTD_DRAW_H

#include <stdint.h>

#include "shared/shared.h"

typedef struct {
    const double *readings; /* [reading_count][5]: bearing, range [m], (x, y) of the beam's start [m], is a miss */
    const double *headings; /* [3][heading_count]: angle, its sine and cosine */
    double *ahead; /* [3][reading_count * heading_count]: each beam's bearing in the map, its sine, its cosine */
    int32_t reading_count;
    int32_t heading_count;
    double resolution_m;
    double error_radius_cells;
    double reach_cells;
    int32_t slots;       /* of a batch, wanted at first; then what a batch may have */
    uint64_t *scratch;   /* draw_scratch_words() of it, from which come: */
    int64_t *keys;       /* [2 * beams][5], of groups */
    double *steps;       /* [2 * beams][4]: least and greatest (row, col) step of each group */
    int32_t *sizes;      /* [2 * beams]: cells of each group's chain */
    int32_t *drawn;      /* [beams][4]: group, length, (row, col) of the head, or NO_HEAD twice */
    int32_t *batch_of;   /* [2 * beams]: of each group */
    int32_t *table;      /* [table_size] */
    int32_t table_size;  /* a power of two, more than twice the beams */
    int32_t group_count; /* what was drawn */
    int32_t cell_count;
    int32_t longest;
} draw_job;

/* How much scratch the drawing needs. */
int64_t draw_scratch_words(draw_job *job);

/* Add up the bearings; their sines and cosines come from NumPy. */
void find_bearings(const draw_job *job);

/* Draw the beams and put those of one direction and start into groups, at most 2 * beams. Returns how many numbers
 * draw_chains writes at most. */
int64_t draw_groups(draw_job *job);

/* Draw the chains, and list the beams by batch and heading, into these numbers; `drawn` tells where each part is. */
void draw_chains(const draw_job *job, int32_t *numbers, drawn_beams *drawn);

#endif
