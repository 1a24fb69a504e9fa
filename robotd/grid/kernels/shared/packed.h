/* Looking at packed maps (packed_map.py). */
#ifndef ROBOTD_PACKED_H
#define ROBOTD_PACKED_H

#include <stddef.h>
#include <stdint.h>

#include "shared/numbers.h"
#include "shared/shared.h"

#define TILE TILE_ROWS

/* Words of one column, padding included. */
static inline size_t column_of(const packed_map *map)
{
    return (size_t)map->rows + 2 * TILE;
}

/* Find the planes in their array. */
static inline void unfold(packed_map *map)
{
    const size_t plane = (size_t)(map->words + 2 * PAD_WORDS) * column_of(map);
    map->free = map->planes;
    map->blocking = map->planes + plane;
    map->grown = map->planes + 2 * plane;
    map->stopping = map->planes + 3 * plane;
    map->ending = map->planes + 4 * plane;
}

/* The words of a plane that hold, from bit `col & 63` on, what the cells of a tile see at an offset; their right neighbours
 * are a column on. */
static inline const uint64_t *words_at(const packed_map *map, const uint64_t *plane, const int32_t *tile, int32_t row,
                                       int32_t col)
{
    const int32_t word = clamp(tile[0] + (col >> 6), -PAD_WORDS, map->words);
    const int32_t first = clamp(tile[1] + row, -TILE, map->rows);
    return plane + (size_t)(word + PAD_WORDS) * column_of(map) + (size_t)(first + TILE);
}

/* The low 64 bits of (high, low) >> shift, 0 <= shift < 64. */
static inline uint64_t funnel(uint64_t low, uint64_t high, int32_t shift)
{
    return low >> shift | (high << 1) << (63 - shift);
}

#endif
