/* Growing a set of cells by a disk: what Python calls. */
#ifndef ROBOTD_GROW_H
#define ROBOTD_GROW_H

#include <stdint.h>

typedef struct {
    const uint8_t *mask; /* [rows][cols], 0 or 1 */
    int32_t rows;
    int32_t cols;
    int32_t outside;        /* whether what lies beyond the grid is in the set */
    int32_t reach;          /* the disk's radius in whole cells, at most 254 */
    const uint8_t *heights; /* [2 * reach + 1]: how far each column of the disk reaches up and down */
    int32_t first_row;      /* the window of cells that are wanted, not empty */
    int32_t end_row;
    int32_t first_col;
    int32_t end_col;
    uint8_t *grown; /* [rows][cols], changed in the window alone */
    uint8_t *ways;  /* [rows of the window + 2 * reach][columns + 2 * reach], for the kernel's own use */
} grow_job;

/* Set the cells of the window from which the disk meets the set, clear the others. */
void grow_disk(const grow_job *job);

#endif
