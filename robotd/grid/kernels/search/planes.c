/* Filling the planes of a search_map, or what a changed window of the map changes in them. */
#include "search/planes.h"

#include <string.h>

#include "search/planes_layout.h"
#include "shared/arena.h"
#include "shared/bits.h"

/* The map as rows of words, with a margin of what lies outside: one word of columns and MARGIN rows. */
#define MARGIN (2 * WINDOW + RING)

typedef struct {
    const search_map *map;
    int32_t words;                     /* of a row, margins included */
    int32_t first, last;               /* the words that a change can reach; `seen` has one more, to widen from */
    uint64_t *blocking, *grown, *seen; /* [rows + 2 * MARGIN][words] */
} bitmaps;

int64_t search_cells_size(const search_map *map)
{
    return (int64_t)(GROWN + map->levels) * (strips(map) + 4) * strip_size(map);
}

int64_t search_pooled_size(const search_map *map)
{
    int64_t size = 0;
    for (int i = 0; i < POOLS; i++)
        size += (int64_t)pooled_size(map, pools[i]);
    return size;
}

static int32_t row_words(const search_map *map)
{
    return up(map->cols, 64) + 2;
}

static int64_t bitmap_size(const search_map *map)
{
    return (int64_t)(block_rows(map, WINDOW) * WINDOW + 2 * MARGIN) * row_words(map);
}

int64_t search_planes_scratch_words(const search_map *map)
{
    const int64_t near_words = (int64_t)map->rows * map->cols / 8 + 1;
    return 3 * bitmap_size(map) > near_words ? 3 * bitmap_size(map) : near_words;
}

static uint64_t packed(const uint8_t *row, int32_t first, int32_t cols, uint64_t outside)
{
    uint64_t word = 0;
    if (first >= cols)
        return outside;
    if (first + 64 <= cols)
        return whole_word(row + first);
    for (int32_t col = first; col < cols; col++)
        word |= (uint64_t)row[col] << (col - first);
    return word | outside << (cols - first);
}

/* Words of a row from a first to before a last, of which the margins are outside. */
static void pack_row(const search_map *map, const uint8_t *cells, int32_t row, int32_t outside, int32_t first,
                     int32_t last, uint64_t *words)
{
    const uint64_t beyond = outside ? ~(uint64_t)0 : 0;
    const int32_t inside_first = first > 1 ? first : 1, inside_last = clamp(last, 0, row_words(map) - 1);
    for (int32_t w = first; w < last; w++)
        words[w] = beyond;
    if (row < 0 || row >= map->rows)
        return;
    for (int32_t w = inside_first; w < inside_last; w++)
        words[w] = packed(cells + (size_t)row * (size_t)map->cols, 64 * (w - 1), map->cols, beyond);
}

/* Rows of 16 cells into the columns of a plane. */
static void fill_cells(const search_map *map, int32_t which, const uint8_t *cells, int32_t outside, int32_t first,
                       int32_t last, uint64_t *row_bits)
{
    uint16_t *plane = cell_plane(map, which);
    const int32_t stride = strip_size(map);
    for (int32_t row = first; row < last; row++) {
        pack_row(map, cells, row, outside, 0, row_words(map), row_bits);
        for (int32_t w = -2; w < strips(map) + 2; w++)
            plane[(size_t)(w + 2) * (size_t)stride + (size_t)(row + WINDOW)] =
                (uint16_t)(row_bits[(w >> 2) + 1] >> (16 * (w & 3)));
    }
}

static uint64_t *bitmap_row(const bitmaps *maps, uint64_t *bitmap, int32_t row)
{
    return bitmap + (size_t)(row + MARGIN) * (size_t)maps->words;
}

/* Offsets (row, col) of a key. */
typedef struct {
    int32_t count;
    int32_t at[(2 * RING + 1) * (2 * RING + 1)][2];
} offsets;

static void offsets_of(const search_map *map, int32_t key, offsets *of)
{
    of->count = 0;
    for (int32_t i = 0; key > 0 && key < map->sectors && i < (2 * RING + 1) * (2 * RING + 1); i++)
        if (map->key_of[i] == key) {
            of->at[of->count][0] = i / (2 * RING + 1) - RING;
            of->at[of->count++][1] = i % (2 * RING + 1) - RING;
        }
}

/* seen = grown & ~(every cell where a body of this key may have ended is blocking). */
static void look_back(const bitmaps *maps, const offsets *of, int32_t row)
{
    const int32_t words = maps->words, first = maps->first, last = clamp(maps->last + 1, 0, words);
    const uint64_t beyond = maps->map->outside_blocks ? ~(uint64_t)0 : 0;
    uint64_t *seen = bitmap_row(maps, maps->seen, row);
    const uint64_t *grown = bitmap_row(maps, maps->grown, row);
    memset(seen + first, of->count ? 0xff : 0, (size_t)(last - first) * sizeof *seen);
    for (int32_t i = 0; i < of->count; i++) {
        const uint64_t *from = bitmap_row(maps, maps->blocking, row + of->at[i][0]);
        const int32_t c = of->at[i][1];
        for (int32_t w = first; w < last; w++) {
            const uint64_t left = w > 0 ? from[w - 1] : beyond, right = w + 1 < words ? from[w + 1] : beyond;
            seen[w] &= c == 0 ? from[w] : c > 0 ? from[w] >> c | right << (64 - c) : from[w] << -c | left >> (64 + c);
        }
    }
    for (int32_t w = first; w < last; w++)
        seen[w] = grown[w] & ~seen[w];
}

/* Every cell becomes the OR of the 2 step x 2 step cells from it on, where it was that of step x step. */
static void widen(const bitmaps *maps, int32_t first, int32_t last, int32_t step, uint64_t outside)
{
    const int32_t end = clamp(maps->last, 0, maps->words - 1);
    for (int32_t row = first; row < last; row++) {
        uint64_t *seen = bitmap_row(maps, maps->seen, row);
        for (int32_t w = maps->first; w < end; w++)
            seen[w] |= seen[w] >> step | seen[w + 1] << (64 - step);
        /* Of a word that is not the last of its row the end is wrong now: it is the one more, and nobody deals it. */
        seen[end] |= seen[end] >> step | outside << (64 - step);
    }
    for (int32_t row = first; row + step < last; row++) {
        uint64_t *seen = bitmap_row(maps, maps->seen, row);
        const uint64_t *below = bitmap_row(maps, maps->seen, row + step);
        for (int32_t w = maps->first; w <= end; w++)
            seen[w] |= below[w];
    }
}

/* Bits 0, pool, 2 pool, ... of a word, side by side. */
static inline uint64_t gathered(uint64_t word, int32_t pool)
{
    if (pool == 16)
        return (word & UINT64_C(0x0001000100010001)) * UINT64_C(0x1000200040008000) >> 60;
    if (pool == 8)
        return (word & UINT64_C(0x0101010101010101)) * UINT64_C(0x0102040810204080) >> 56;
    if (pool == 4) {
        word &= UINT64_C(0x1111111111111111);
        word = (word | word >> 3) & UINT64_C(0x0303030303030303);
        word = (word | word >> 6) & UINT64_C(0x000f000f000f000f);
        word = (word | word >> 12) & UINT64_C(0x000000ff000000ff);
        return (word | word >> 24) & UINT64_C(0xffff);
    }
    word &= UINT64_C(0x5555555555555555);
    word = (word | word >> 1) & UINT64_C(0x3333333333333333);
    word = (word | word >> 2) & UINT64_C(0x0f0f0f0f0f0f0f0f);
    word = (word | word >> 4) & UINT64_C(0x00ff00ff00ff00ff);
    word = (word | word >> 8) & UINT64_C(0x0000ffff0000ffff);
    return (word | word >> 16) & UINT64_C(0xffffffff);
}

/* One row of cells goes to one row of blocks in all its column phases. */
static void deal_row(const bitmaps *maps, int32_t pool, int32_t key, int32_t row)
{
    const search_map *map = maps->map;
    const int32_t block = floor_div(row, pool), each = 64 / pool, stride = pooled_stride(map, pool);
    const size_t size = phase_size(map, pool);
    const uint64_t *seen = bitmap_row(maps, maps->seen, row), ones = (UINT64_C(1) << each) - 1;
    uint64_t *phase = pooled_phase(map, pool, key, row - block * pool, 0) + 2 * (ptrdiff_t)stride + (block + ABOVE);
    for (int32_t w = maps->first; w < maps->last; w++) {
        const int32_t first = (w - 1) * each; /* the first block of this word */
        if (first >= up(map->cols, pool) + up(BEYOND, pool))
            break;
        uint64_t *to = phase + (ptrdiff_t)floor_div(first, 64) * stride;
        for (int32_t c = 0; c < pool; c++, to += size)
            *to = (*to & ~(ones << (first & 63))) | gathered(seen[w] >> c, pool) << (first & 63);
    }
}

/* Rows from a first to before a last, as far as the pooled planes go. */
static void deal(const bitmaps *maps, int32_t pool, int32_t key, int32_t first, int32_t last)
{
    const int32_t low = -up(pool + BEYOND, pool) * pool;
    const int32_t high = (up(maps->map->rows, pool) + up(BEYOND, pool)) * pool;
    for (int32_t row = clamp(first, low, high); row < clamp(last, low, high); row++)
        deal_row(maps, pool, key, row);
}

static const uint8_t *grown_on(const search_map *map, int32_t level)
{
    return map->grown + (size_t)level * (size_t)map->rows * (size_t)map->cols;
}

static void fill_pooled(const bitmaps *maps, int32_t first, int32_t last)
{
    const search_map *map = maps->map;
    const int32_t low = -2 * WINDOW, high = (up(map->rows, WINDOW) + 1) * WINDOW;
    first = clamp(first - RING - WINDOW, low, high);
    last = clamp(last + RING, low, high);
    const int32_t deepest = last + WINDOW, words = maps->words;
    const int32_t left = clamp(maps->first - 1, 0, words), right = clamp(maps->last + 2, 0, words);
    for (int32_t row = first - RING; row < deepest + RING; row++)
        pack_row(map, map->blocking, row, map->outside_blocks, left, right, bitmap_row(maps, maps->blocking, row));
    for (int32_t key = 0; key < map->keys; key++) {
        const uint64_t outside = far_heads(map, key) ? ~(uint64_t)0 : 0;
        offsets of;
        offsets_of(map, key, &of);
        for (int32_t row = first; (key == 0 || key >= map->sectors) && row < deepest; row++)
            pack_row(map, grown_on(map, level_of_key(map, key)), row, map->outside_ends, left, right,
                     bitmap_row(maps, maps->grown, row));
        for (int32_t row = first; row < deepest; row++)
            look_back(maps, &of, row);
        for (int32_t step = 1; step < WINDOW; step *= 2) {
            widen(maps, first, deepest, step, outside);
            if (2 * step >= pools[POOLS - 1])
                deal(maps, 2 * step, key, first, last);
        }
    }
}

static inline uint8_t nearer(uint8_t a, uint8_t b)
{
    return a < b ? a : b;
}

/* Two passes over a rectangle; what lies outside of it counts only where it is outside of the map, too. */
static void distances(const search_map *map, const int32_t *box, uint8_t *near)
{
    const int32_t height = box[1] - box[0], width = box[3] - box[2];
    const uint8_t far = NEAR_MAX, rim = map->outside_blocks ? 0 : NEAR_MAX;
    for (int32_t pass = 0; pass < 2; pass++)
        for (int32_t i = 0; i < height; i++) {
            const int32_t row = pass == 0 ? i : height - 1 - i, before = pass == 0 ? row - 1 : row + 1;
            const int at_rim = box[0] + before < 0 || box[0] + before >= map->rows;
            const uint8_t *other = before < 0 || before >= height ? NULL : near + (size_t)before * (size_t)width;
            const uint8_t none = at_rim ? rim : far, left = box[2] == 0 ? rim : far,
                          right = box[3] == map->cols ? rim : far;
            uint8_t *line = near + (size_t)row * (size_t)width;
            const uint8_t *cells = map->blocking + (size_t)(box[0] + row) * (size_t)map->cols + box[2];
            for (int32_t col = 0; col < width; col++) {
                uint8_t best = other == NULL ? none : other[col];
                best = nearer(best, col == 0 ? left : other == NULL ? none : other[col - 1]);
                best = nearer(best, col + 1 == width ? right : other == NULL ? none : other[col + 1]);
                best = nearer((uint8_t)(best + 1), far);
                line[col] = pass == 1 ? nearer(line[col], best) : cells[col] ? 0 : best;
            }
            for (int32_t col = 1; pass == 0 && col < width; col++)
                line[col] = nearer(line[col], (uint8_t)(line[col - 1] + 1));
            for (int32_t col = width - 2; pass == 1 && col >= 0; col--)
                line[col] = nearer(line[col], (uint8_t)(line[col + 1] + 1));
        }
}

static void fill_near(const search_map *map, const int32_t *box, uint8_t *scratch)
{
    const int32_t sizes[2] = {map->rows, map->cols};
    int32_t inner[4], outer[4];
    for (int i = 0; i < 4; i++) {
        inner[i] = clamp(box[i] + (i % 2 ? NEAR_MAX : -NEAR_MAX), 0, sizes[i / 2]);
        outer[i] = clamp(box[i] + (i % 2 ? 2 * NEAR_MAX : -2 * NEAR_MAX), 0, sizes[i / 2]);
    }
    const size_t width = (size_t)(outer[3] - outer[2]);
    distances(map, outer, scratch);
    for (int32_t row = inner[0]; row < inner[1]; row++)
        memcpy(map->near + (size_t)row * (size_t)map->cols + inner[2],
               scratch + (size_t)(row - outer[0]) * width + (inner[2] - outer[2]), (size_t)(inner[3] - inner[2]));
}

static void fill_outside(const search_map *map)
{
    const int32_t outside[3] = {0, map->outside_blocks, map->outside_ends};
    const size_t size = (size_t)(strips(map) + 4) * (size_t)strip_size(map);
    for (int32_t which = 0; which < GROWN + map->levels; which++)
        memset(cell_plane(map, which), outside[which < GROWN ? which : GROWN] ? 0xff : 0, size * sizeof *map->cells);
    for (int i = 0; i < POOLS; i++)
        for (int32_t key = 0; key < map->keys; key++)
            memset(pooled_phase(map, pools[i], key, 0, 0), far_heads(map, key) ? 0xff : 0,
                   key_size(map, pools[i]) * sizeof *map->pooled);
}

void search_prepare(const search_map *map, int32_t row_first, int32_t row_last, int32_t col_first, int32_t col_last,
                    uint64_t *scratch)
{
    const int32_t box[4] = {row_first, row_last, col_first, col_last};
    const size_t size = (size_t)bitmap_size(map);
    const int32_t words = row_words(map);
    const bitmaps maps = {map,
                          words,
                          clamp(floor_div(col_first - RING - WINDOW, 64) + 1, 0, words),
                          clamp(floor_div(col_last + RING, 64) + 2, 0, words),
                          scratch,
                          scratch + size,
                          scratch + 2 * size};
    if (row_first == 0 && row_last == map->rows && col_first == 0 && col_last == map->cols)
        fill_outside(map);
    fill_cells(map, FREE, map->free, 0, row_first, row_last, scratch);
    fill_cells(map, BLOCKING, map->blocking, map->outside_blocks, row_first, row_last, scratch);
    for (int32_t level = 0; level < map->levels; level++)
        fill_cells(map, GROWN + level, grown_on(map, level), map->outside_ends, row_first, row_last, scratch);
    fill_pooled(&maps, row_first, row_last);
    fill_near(map, box, (uint8_t *)scratch);
}
