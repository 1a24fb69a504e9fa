/* What is bounded at once: tiles of blocks that have a cell where poses are asked for; or the windows of a small area.
 * Included by search.c. */
#include "search/search_window.h"

/* At most. */
static int32_t units_of(const search_job *job)
{
    if (job->by_blocks)
        return block_words(job->map, WINDOW) * (block_rows(job->map, WINDOW) / 8);
    return up(job->area[1] - job->area[0], WINDOW) * up(job->area[3] - job->area[2], WINDOW);
}

/* Which blocks of a row of a tile are in the area. */
static uint64_t within(const search_job *job, const int32_t *tile, int32_t i)
{
    const int32_t row = (tile[1] + i) * WINDOW, first = 64 * tile[0];
    if (row + WINDOW <= job->area[0] || row >= job->area[1])
        return 0;
    const int32_t low = clamp(job->area[2] / WINDOW - first, 0, 63),
                  high = clamp(up(job->area[3], WINDOW) - first, 0, 64);
    return high <= low ? 0 : ~UINT64_C(0) >> (64 - high) & ~UINT64_C(0) << low;
}

/* Those of them that have a free cell: most of a long corridor's map is ground where nobody stands. */
static uint64_t with_free(const search_job *job, const int32_t *tile, int32_t i)
{
    const search_map *map = job->map;
    uint64_t blocks = 0;
    for (uint64_t left = within(job, tile, i); left; left &= left - 1) {
        const int32_t block = __builtin_ctzll(left), row = (tile[1] + i) * WINDOW;
        const window cells =
            *(const window *)(cell_plane(map, FREE) + (size_t)(64 * tile[0] + block + 2) * (size_t)strip_size(map) +
                              (size_t)(row + WINDOW));
        const pair four = (pair)cells;
        if (four[0] | four[1] | four[2] | four[3])
            blocks |= UINT64_C(1) << block;
    }
    return blocks;
}

/* Add a tile, if there is anything in it. */
static void place_tile(search *s, int32_t word, int32_t row)
{
    const int32_t tile[2] = {word, row};
    uint64_t any = 0;
    for (int32_t i = 0; i < 8; i++)
        any |= s->open[s->units][i] = with_free(s->job, tile, i);
    if (any == 0)
        return;
    memcpy(s->tiles[s->units++], tile, sizeof tile);
}

static void place_units(search *s)
{
    const search_job *job = s->job;
    s->units = 0;
    if (!job->by_blocks) {
        for (int32_t row = job->area[0]; row < job->area[1]; row += WINDOW)
            for (int32_t col = job->area[2]; col < job->area[3]; col += WINDOW) {
                s->tiles[s->units][0] = row;
                s->tiles[s->units++][1] = col;
            }
        return;
    }
    const int32_t high = 8 * WINDOW, wide = 64 * WINDOW;
    for (int32_t row = job->area[0] / high; row * high < job->area[1]; row++)
        for (int32_t word = job->area[2] / wide; word * wide < job->area[3]; word++)
            place_tile(s, word, 8 * row);
}
