/* Cells packed into words, 64 of one row in each: what Python calls. */
#ifndef ROBOTD_PACK_H
#define ROBOTD_PACK_H

#include <stdint.h>

/* Set the bits of the words that hold cells of a window (first row, end row, first column, end column) from a mask
 * [rows][cols] of 0 and 1, also those of other cells in these words. The mask begins at `top`, `left` within the words
 * [][stride], the padding included. */
void pack_cells(const uint8_t *mask, int32_t cols, const int32_t *window, int32_t top, int32_t left, int32_t stride,
                uint64_t *words);

#endif
