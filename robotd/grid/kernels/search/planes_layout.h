/* Where things lie in the planes of a search_map: shared by what fills them and what reads them. */
#ifndef ROBOTD_PLANES_LAYOUT_H
#define ROBOTD_PLANES_LAYOUT_H

#include <stddef.h>
#include <stdint.h>

#include "search/planes.h"
#include "shared/numbers.h"

#define WINDOW 16
#define NEAR_MAX 63
#define RING 16 /* offsets of a body's end from its head that have a key reach so far */

enum {
    FREE,
    BLOCKING,
    GROWN /* on the first level; the others follow */
};

static inline int32_t up(int32_t value, int32_t step)
{
    return (value + step - 1) / step;
}

static inline int32_t floor_div(int32_t value, int32_t step) /* step is a power of two */
{
    return (value & -step) / step;
}

/* Cells: columns of 16, and rows with a window's margin on either side. */
static inline int32_t strips(const search_map *map)
{
    return up(map->cols, WINDOW);
}

static inline int32_t strip_size(const search_map *map)
{
    return (up(map->rows, WINDOW) + 2) * WINDOW;
}

static inline uint16_t *cell_plane(const search_map *map, int32_t which)
{
    return map->cells + (size_t)which * (size_t)(strips(map) + 4) * (size_t)strip_size(map);
}

/* Pooled: words of 64 blocks, two of them and ABOVE rows of blocks before the map. The two words after a phase are those
 * before the next one, and the last phase of a key has its own: keys differ far outside, and a bit that two of them
 * share would make a bound too low. Up to BEYOND cells outside, planes may differ from what they are farther away, since
 * bodies end there inside the map; RIM is that in the smallest blocks. */
#define POOLS 4
static const int32_t pools[POOLS] = {16, 8, 4, 2};
#define BEYOND 8 /* the reach of keys */
#define RIM (BEYOND / 2)
#define TILE_HEIGHT 8             /* rows of blocks that are looked at together */
#define ABOVE (TILE_HEIGHT + RIM) /* one row less would do, if no phase shifted the rim by up to a block */
#define BELOW (RIM + TILE_HEIGHT)

static inline int32_t block_rows(const search_map *map, int32_t pool)
{
    return up(up(map->rows, pool), TILE_HEIGHT) * TILE_HEIGHT;
}

static inline int32_t block_words(const search_map *map, int32_t pool)
{
    return up(up(map->cols, pool), 64);
}

static inline int32_t pooled_stride(const search_map *map, int32_t pool)
{
    return ABOVE + block_rows(map, pool) + BELOW;
}

static inline size_t phase_size(const search_map *map, int32_t pool)
{
    return (size_t)(block_words(map, pool) + 2) * (size_t)pooled_stride(map, pool);
}

/* Of all phases of a key. */
static inline size_t key_size(const search_map *map, int32_t pool)
{
    return (size_t)(pool * pool) * phase_size(map, pool) + 2 * (size_t)pooled_stride(map, pool);
}

static inline size_t pooled_size(const search_map *map, int32_t pool)
{
    return (size_t)map->keys * key_size(map, pool);
}

static inline uint64_t *pooled_phase(const search_map *map, int32_t pool, int32_t key, int32_t row, int32_t col)
{
    uint64_t *first = map->pooled;
    for (int i = 0; pools[i] != pool; i++)
        first += pooled_size(map, pools[i]);
    return first + (size_t)key * key_size(map, pool) + (size_t)(row * pool + col) * phase_size(map, pool);
}

/* The key of a level but the first, which tells no directions apart: its readings are few. */
static inline int32_t key_of_level(const search_map *map, int32_t level)
{
    return map->sectors - 1 + level;
}

static inline int32_t level_of_key(const search_map *map, int32_t key)
{
    return key < map->sectors ? 0 : key - map->sectors + 1;
}

/* Whether a head far outside can be met: not if it ends nothing, or if the body has been blocked before. */
static inline int32_t far_heads(const search_map *map, int32_t key)
{
    return map->outside_ends && !(map->outside_blocks && key > 0 && key < map->sectors);
}

/* Whether 64 columns of blocks from one on lie farther outside than BEYOND, all of them. */
static inline int far_words(int32_t words, int32_t word, uint64_t shift)
{
    return word < -2 || word > words || (word == -2 && shift < RIM) || (word == words && shift >= RIM);
}

/* The same for TILE_HEIGHT rows of them. */
static inline int far_rows(int32_t rows, int32_t row)
{
    return row < -ABOVE || row >= rows + RIM;
}

#endif
