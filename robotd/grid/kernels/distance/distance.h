/* The squared Euclidean distance to the nearest source: what Python calls. */
#ifndef ROBOTD_DISTANCE_H
#define ROBOTD_DISTANCE_H

#include <stdint.h>

enum {
    NOWHERE = 2147483647
};

typedef struct {
    const uint8_t *sources; /* [rows][cols], 0 or 1 */
    int32_t rows;
    int32_t cols;
    int32_t outside;   /* whether what lies beyond the grid is a source */
    int32_t limit;     /* farther than this many cells is nowhere; its square must fit */
    int32_t first_row; /* the window of cells whose distance is wanted, not empty */
    int32_t end_row;
    int32_t first_col;
    int32_t end_col;
    int32_t *squares; /* [rows][cols], changed in the window alone */
    int32_t *along;   /* [rows of the window][cols], for the kernel's own use */
    int32_t *spare;   /* [3 * (cols + 2)], the same */
} distance_job;

/* Write the squared distance from each cell of the window to the nearest source, NOWHERE if none is near enough. */
void squared_distances(const distance_job *job);

#endif
