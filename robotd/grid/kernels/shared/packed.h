/* Packed maps (packed_map.py), for the sources; not read by cffi. */
#ifndef ROBOTD_PACKED_H
#define ROBOTD_PACKED_H

#include <stddef.h>
#include <stdint.h>

#define TILE 32

static inline int32_t clamp(int32_t value, int32_t low, int32_t high)
{
    return value < low ? low : value > high ? high : value;
}

/* The words that hold, from bit `col & 63` on, what the cells of a tile see at an offset; their right neighbours are
 * rows + 2 * TILE words on. */
static inline const uint64_t *words_at(const uint64_t *map, int32_t words, int32_t rows, const int32_t *tile, int32_t row,
                                       int32_t col)
{
    const int32_t word = clamp(tile[0] + (col >> 6), -2, words);
    const int32_t first = clamp(tile[1] + row, -TILE, rows);
    return map + (size_t)(word + 2) * ((size_t)rows + 2 * TILE) + (size_t)(first + TILE);
}

/* The low 64 bits of (high, low) >> shift, 0 <= shift < 64. */
static inline uint64_t funnel(uint64_t low, uint64_t high, int32_t shift)
{
    return low >> shift | (high << 1) << (63 - shift);
}

#endif
