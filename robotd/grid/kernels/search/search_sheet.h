/* What the search keeps of a beam, of a grid of blocks and of a window of 16 x 16 cells. Included by search.c. */
#include <string.h>

#include "draw/reading_on_grid.h"
#include "search/planes_layout.h"
#include "search/search.h"
#include "shared/numbers.h"

#define BITS_MAX 16

typedef uint16_t window __attribute__((vector_size(32), aligned(2), may_alias)); /* a row of 16 cells in each lane */
typedef uint64_t pair __attribute__((vector_size(32), aligned(2), may_alias));

/* A reading at a heading, and the last cell of its body, and the one before it. */
typedef struct {
    reading_on_grid at;
    int32_t last[2], before[2];
    int32_t is_miss, level;
} beam;

/* A head as the grid of blocks sees it. */
typedef struct {
    const uint64_t *phase;
    int32_t word, row;
    uint64_t shift;
} pooled_beam;

/* A grid of blocks. */
typedef struct {
    int32_t pool, words, rows;
    ptrdiff_t stride;
} grid;

/* The counters of one window. */
typedef struct {
    int32_t row, col, bits, start, radius;
    int64_t work;      /* what was looked at in all windows so far */
    int32_t middle[2]; /* all that are alive are at most radius from it */
    window alive, misses[BITS_MAX + 1];
    window *maybe; /* [readings]: from where the end of each beam is right */
} sheet;

typedef struct {
    void (*draw_heading)(const search_job *, int32_t, beam *);
    void (*bound_tile)(const grid *, const pooled_beam *, int32_t, const int32_t *, int32_t, uint64_t *);
    int (*count_ends)(const search_job *, const beam *, sheet *, int32_t);
    int (*count_bodies)(const search_job *, const beam *, sheet *);
} kernel;

/* No cell that blocks is nearer than this. */
static inline int32_t clearance(const search_map *map, int32_t row, int32_t col)
{
    const int32_t outside = larger(larger(-row, row - map->rows + 1), larger(-col, col - map->cols + 1));
    if (outside > 0)
        return map->outside_blocks ? 0 : outside;
    return map->near[(size_t)row * (size_t)map->cols + (size_t)col];
}

/* Put a square around the cells that are left. */
static void surround(sheet *at)
{
    uint32_t cols = 0;
    int32_t first = WINDOW, last = 0;
    for (int32_t row = 0; row < WINDOW; row++)
        if (at->alive[row]) {
            cols |= at->alive[row];
            first = first < row ? first : row;
            last = row;
        }
    const int32_t left = __builtin_ctz(cols | 1u << 16), right = 31 - __builtin_clz(cols | 1);
    at->middle[0] = at->row + (first + last) / 2;
    at->middle[1] = at->col + (left + right) / 2;
    at->radius = larger(last - first + 1, right - left + 1) / 2;
}

/* Set alive the cells of a window where poses are asked for. */
static int open_window(const search_job *job, int32_t row, int32_t col, sheet *at)
{
    const search_map *map = job->map;
    const uint16_t *plane = cell_plane(map, FREE);
    const int32_t stride = strip_size(map), shift = col & (WINDOW - 1);
    const uint16_t *low = plane + (ptrdiff_t)(col / WINDOW + 2) * stride + row + WINDOW, *high = low + stride;
    uint16_t any = 0, cells[WINDOW] = {0};
    at->row = row;
    at->col = col;
    for (int32_t i = 0; i < WINDOW; i++) {
        if (row + i < job->area[0] || row + i >= job->area[1])
            continue;
        const int32_t *span = job->spans + 2 * (size_t)(row + i - job->area[0]);
        const int32_t first = clamp(span[0] - col, 0, WINDOW), last = clamp(span[1] - col, first, WINDOW);
        const uint32_t both = low[i] | (uint32_t)high[i] << WINDOW; /* an int, which a uint16_t becomes, has no room */
        cells[i] = (uint16_t)(both >> shift & ((1u << last) - (1u << first)));
        any |= cells[i];
    }
    memcpy(&at->alive, cells, sizeof cells);
    return any != 0;
}

/* What the cells of a sheet missed. */
static int32_t misses_at(const sheet *at, int32_t row, int32_t col)
{
    int32_t value = 0;
    for (int32_t bit = 0; bit < at->bits; bit++)
        value |= ((at->misses[bit][row] >> col) & 1) << bit;
    return value - at->start;
}

/* Keep alive but the cell that missed least; returns what it missed. */
static int32_t keep_best(sheet *at)
{
    int32_t best = INT32_MAX, kept[2] = {0, 0};
    for (int32_t row = 0; row < WINDOW; row++)
        for (int32_t col = 0; col < WINDOW; col++)
            if ((at->alive[row] >> col) & 1 && misses_at(at, row, col) < best) {
                best = misses_at(at, row, col);
                kept[0] = row;
                kept[1] = col;
            }
    at->alive = (window){0};
    at->alive[kept[0]] = (uint16_t)(1 << kept[1]);
    return best;
}
