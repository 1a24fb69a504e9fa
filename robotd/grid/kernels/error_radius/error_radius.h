/* The smallest error radius of every cell (localization/reference/smallest_error.py): what Python calls. */
#ifndef ROBOTD_ERROR_RADIUS_H
#define ROBOTD_ERROR_RADIUS_H

#include <stdint.h>

#include "shared/shared.h"

typedef struct {
    packed_map map;     /* where the robot may stand, and what stops a beam; its grown cells are not used */
    int32_t origin_row; /* where the map's first cell lies */
    int32_t origin_col;
    int32_t map_rows;
    int32_t map_cols;
    const uint16_t *distances; /* [map_rows][map_cols]: what an end there needs */
    uint16_t outside;          /* what an end outside needs */
    const int32_t *chains;     /* [][2]: (row, col) of the cells of bodies */
    const uint16_t *lengths;   /* for each of these cells: what a body needs that is stopped there */
    const int32_t *readings; /* [reading_count][4]: first cell of the body and end, (row, col) of the head or NO_HEAD */
    int32_t reading_count;
    int32_t wanted;   /* how many readings must be feasible, at least 1 */
    uint16_t *needed; /* [threads][reading_count][2048], for the kernel's own use */
    uint16_t *errors; /* [map_rows][map_cols]: written for free cells alone */
    int32_t threads;  /* at most THREADS_MAX */
} errors_job;

/* Find, for every free cell, the smallest error with which this many readings are feasible; 65535 if none is. */
void share_errors(errors_job *job);

#endif
