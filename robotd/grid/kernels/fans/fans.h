/* Counting poses that cannot be excluded (localization/conservative/conservative_poses.py): what Python calls.
 *
 * A fan is all beams that the error bounds allow, as windows of cells on successive lines of the grid (grid/fans.py).
 */
#ifndef ROBOTD_FANS_H
#define ROBOTD_FANS_H

#include <stdint.h>

#include "shared/shared.h"

enum {
    WINDOW_CELLS_MAX = 32
};

typedef struct {
    packed_map map;         /* where the robot may be, and what surely stops a beam; its grown cells are not used */
    uint64_t *const *grown; /* [radii], planes as the map's: what may end a beam, grown by each radius */
    const int32_t
        *lines; /* [fan_count][7]: axis, way, first line, least and greatest step aside, first window, at home */
    const int32_t *windows; /* [][2]: first and last cell aside, at most WINDOW_CELLS_MAX of them */
    const int32_t *lists;   /* [fan_count + 1]: first beam of each fan */
    int32_t fan_count;
    const int32_t *beams; /* [][5]: lines crossed, ascending in a fan; heading; radius or -1; (row, col) of the head */
    int32_t headings;
    int32_t bits;       /* planes of a counter */
    uint64_t *counters; /* [tile_count][headings][bits][32] */
    int32_t subtract;   /* take the beams back */
    int32_t threads;
} fan_job;

/* Count every beam at every cell whose fan lets a path through and whose head may be an obstacle, or take it back. */
void count_fans(fan_job *job);

#endif
