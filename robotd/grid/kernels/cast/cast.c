/* Wall fields and beams cast on them. cast_twin.py does the same in NumPy.
 *
 * Both fields are worked out in two passes of bytes, 16 to a vector: along the columns the way to the nearest source,
 * capped, then along the rows the least over the few neighbours that the cap leaves.
 */
#include "cast/cast.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define ALONG 1e-300

static inline uint8_t smaller(uint8_t a, uint8_t b)
{
    return a < b ? a : b;
}

static inline uint8_t larger(uint8_t a, uint8_t b)
{
    return a > b ? a : b;
}

/* ways = rows to the nearest cell of the same column whose value is `source`, at most `cap`. */
static void along_columns(const uint8_t *cells, int32_t rows, int32_t cols, uint8_t source, uint8_t cap, uint8_t *ways)
{
    for (int32_t row = 0; row < rows; row++) {
        const uint8_t *cell = cells + (size_t)row * (size_t)cols;
        uint8_t *way = ways + (size_t)row * (size_t)cols;
        if (row == 0)
            for (int32_t col = 0; col < cols; col++)
                way[col] = cell[col] == source ? 0 : cap;
        else
            for (int32_t col = 0; col < cols; col++) {
                const uint8_t more = smaller((uint8_t)(way[col - cols] + 1), cap);
                way[col] = cell[col] == source ? 0 : more;
            }
    }
    for (int32_t row = rows - 2; row >= 0; row--) {
        uint8_t *way = ways + (size_t)row * (size_t)cols;
        for (int32_t col = 0; col < cols; col++)
            way[col] = smaller(way[col], (uint8_t)(way[col + cols] + 1));
    }
}

/* squares = least of way^2 + step^2 over the neighbours along the row, at most reach^2, itself in place of the ways. */
static void along_row(uint8_t *restrict ways, int32_t cols, int32_t reach, uint8_t *restrict padded)
{
    const uint8_t far = (uint8_t)(reach * reach);
    memset(padded, far, (size_t)cols + 2 * REACH_CELLS);
    uint8_t *middle = padded + REACH_CELLS;
    for (int32_t col = 0; col < cols; col++)
        ways[col] = middle[col] = (uint8_t)(ways[col] * ways[col]);
    for (int32_t step = 1; step < reach; step++) {
        const uint8_t square = (uint8_t)(step * step), *left = middle - step, *right = middle + step;
        for (int32_t col = 0; col < cols; col++) {
            const uint8_t nearest = (uint8_t)(smaller(left[col], right[col]) + square);
            ways[col] = smaller(ways[col], nearest);
        }
    }
}

void wall_codes(const uint8_t *walls, int32_t rows, int32_t cols, uint8_t *scratch, int8_t *codes)
{
    const size_t cells = (size_t)rows * (size_t)cols;
    uint8_t *outside = scratch, *inside = scratch + cells, *padded = scratch + 2 * cells;
    along_columns(walls, rows, cols, 1, REACH_CELLS, outside);
    along_columns(walls, rows, cols, 0, DEPTH_CELLS, inside);
    for (int32_t row = 0; row < rows; row++) {
        const size_t first = (size_t)row * (size_t)cols;
        along_row(outside + first, cols, REACH_CELLS, padded);
        along_row(inside + first, cols, DEPTH_CELLS, padded);
        for (int32_t col = 0; col < cols; col++)
            codes[first + col] = (int8_t)(outside[first + col] - inside[first + col]);
    }
}

void skip_codes(const uint8_t *ends, const uint8_t *blocks, int32_t rows, int32_t cols, uint8_t *scratch,
                uint8_t *skips)
{
    const int32_t wide = cols + 2, high = rows + 2;
    uint8_t *stops = scratch, *padded = scratch + (size_t)wide * (size_t)high;
    memset(stops, 1, (size_t)wide * (size_t)high);
    for (int32_t row = 0; row < rows; row++) {
        uint8_t *stop = stops + (size_t)(row + 1) * (size_t)wide + 1;
        const size_t first = (size_t)row * (size_t)cols;
        for (int32_t col = 0; col < cols; col++)
            stop[col] = ends[first + col] | blocks[first + col];
    }
    along_columns(stops, high, wide, 1, SKIP_MAX, skips);
    for (int32_t row = 0; row < high; row++) {
        uint8_t *skip = skips + (size_t)row * (size_t)wide, *middle = padded + SKIP_MAX;
        memset(padded, SKIP_MAX, (size_t)wide + 2 * SKIP_MAX);
        memcpy(middle, skip, (size_t)wide);
        for (int32_t step = 1; step < SKIP_MAX; step++) {
            const uint8_t *left = middle - step, *right = middle + step;
            for (int32_t col = 0; col < wide; col++)
                skip[col] = smaller(skip[col], larger(smaller(left[col], right[col]), (uint8_t)step));
        }
        const uint8_t *stop = stops + (size_t)row * (size_t)wide;
        for (int32_t col = 0; col < wide; col++)
            skip[col] = stop[col] ? BLOCKS : skip[col];
        if (row == 0 || row == high - 1)
            continue;
        const uint8_t *end = ends + (size_t)(row - 1) * (size_t)cols;
        for (int32_t col = 0; col < cols; col++)
            skip[col + 1] = end[col] ? ENDS : skip[col + 1];
    }
}

/* The cell of a point on a side, which rounding does not take round the corner. */
static inline int64_t cell_of(double at, int64_t cell, int64_t skip)
{
    const int64_t found = (int64_t)at + 1, least = cell - skip + 1, most = cell + skip - 1;
    return found < least ? least : found > most ? most : found;
}

static double cast(const uint8_t *skips, int32_t rows, int32_t cols, const double *start, const double *ahead,
                   int32_t blocked_by, uint8_t *stops)
{
    *stops = BLOCKS;
    if (!(start[0] >= 0.0 && start[1] >= 0.0 && start[0] < cols - 2 && start[1] < rows - 2))
        return 0.0;
    int64_t col = (int64_t)start[0] + 1, row = (int64_t)start[1] + 1;
    /* A beam that runs along a side never crosses it. */
    const int32_t along_x = fabs(ahead[0]) < ALONG, along_y = fabs(ahead[1]) < ALONG;
    const double per_col = along_x ? 0.0 : 1.0 / ahead[0], never_x = along_x ? INFINITY : 0.0;
    const double per_row = along_y ? 0.0 : 1.0 / ahead[1], never_y = along_y ? INFINITY : 0.0;
    const int32_t right = ahead[0] > 0.0, up = ahead[1] > 0.0;
    double way = 0.0, run_way = 0.0;
    for (int32_t met = 0, in_run = 0;;) {
        const uint8_t code = skips[(size_t)row * (size_t)cols + (size_t)col];
        const int32_t meets = code == ENDS || code == BLOCKS;
        if (meets && !in_run) {
            run_way = way;
            *stops = code;
        }
        in_run = meets;
        met += meets;
        if ((meets && met >= blocked_by) || col == 0 || row == 0 || col == cols - 1 || row == rows - 1)
            return run_way;
        const int64_t skip = meets ? 1 : code;
        const int64_t side_x = right ? col - 1 + skip : col - skip, side_y = up ? row - 1 + skip : row - skip;
        const double to_x = ((double)side_x - start[0]) * per_col + never_x;
        const double to_y = ((double)side_y - start[1]) * per_row + never_y;
        if (to_x <= to_y) {
            way = to_x;
            row = cell_of(start[1] + way * ahead[1], row, skip);
            col += right ? skip : -skip;
        } else {
            way = to_y;
            col = cell_of(start[0] + way * ahead[0], col, skip);
            row += up ? skip : -skip;
        }
    }
}

void cast_beams(const uint8_t *skips, int32_t rows, int32_t cols, const double *beams, int32_t beam_count,
                const double *poses, int32_t pose_count, int32_t blocked_by, double *ways, uint8_t *stops)
{
    for (int32_t number = 0; number < pose_count; number++, poses += 4) {
        const double cos = poses[2], sin = poses[3];
        for (int32_t i = 0; i < beam_count; i++) {
            const double *beam = beams + 4 * (size_t)i;
            const double start[2] = {poses[0] + (cos * beam[0] - sin * beam[1]),
                                     poses[1] + (sin * beam[0] + cos * beam[1])};
            const double ahead[2] = {cos * beam[2] - sin * beam[3], sin * beam[2] + cos * beam[3]};
            *ways++ = cast(skips, rows, cols, start, ahead, blocked_by, stops++);
        }
    }
}
