/* A sweep into the occupancy grid: each cell is a 256-state machine, and two tables say what a beam does to it.
 *
 * The rule of ray.py: a beam is sampled once per cell of its dominant axis, at start + k * step. Products and sums are
 * rounded one by one (the build forbids contraction), so the cells are those of NumPy.
 */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "insert.h"

typedef struct {
    double row, col, row_step, col_step, samples;
} beam;

typedef struct {
    int64_t first, last; /* samples first <= k < last are the ones inside the grid, and perhaps some outside */
} span;

/* Where start + k * step can lie in [0, size): one to spare at either end, for what rounding does. */
static span inside(span s, double start, double step, double size)
{
    if (step == 0.0)
        return s;
    const double enter = step > 0.0 ? -start / step : (size - start) / step;
    const double leave = step > 0.0 ? (size - start) / step : -start / step;
    if (enter - 2.0 > (double)s.first)
        s.first = enter - 2.0 > (double)s.last ? s.last : (int64_t)(enter - 2.0);
    if (leave + 2.0 < (double)s.last)
        s.last = leave + 2.0 < (double)s.first ? s.first : (int64_t)(leave + 2.0);
    return s;
}

static span samples_of(const beam *b, int32_t rows, int32_t cols)
{
    const span all = {0, b->samples < 9e15 ? (int64_t)b->samples : (int64_t)9e15};
    return inside(inside(all, b->row, b->row_step, rows), b->col, b->col_step, cols);
}

static inline int64_t cell_at(const beam *b, int64_t k, int32_t rows, int32_t cols)
{
    const double row = b->row + (double)k * b->row_step, col = b->col + (double)k * b->col_step;
    if (!(row >= 0.0 && col >= 0.0 && row < (double)rows && col < (double)cols))
        return -1;
    return (int64_t)(int32_t)row * cols + (int32_t)col;
}

/* Every beam after the other: the last one through a cell has the last word. */
static void one_by_one(uint8_t *cells, int32_t rows, int32_t cols, const beam *beams, const int64_t *hits, int32_t count,
                       const uint8_t *lower, const uint8_t *raise)
{
    for (int32_t i = 0; i < count; i++) {
        const span s = samples_of(&beams[i], rows, cols);
        for (int64_t k = s.first; k < s.last; k++) {
            const int64_t cell = cell_at(&beams[i], k, rows, cols);
            if (cell >= 0 && cell != hits[i])
                cells[cell] = lower[cells[cell]];
        }
        if (hits[i] >= 0)
            cells[hits[i]] = raise[cells[hits[i]]];
    }
}

/* Each cell once, from the value it had before; a hit beats all misses. */
static void at_once(uint8_t *cells, int32_t rows, int32_t cols, const beam *beams, const int64_t *hits, int32_t count,
                    const uint8_t *lower, const uint8_t *raise, const uint8_t *before)
{
    for (int32_t i = 0; i < count; i++) {
        const span s = samples_of(&beams[i], rows, cols);
        for (int64_t k = s.first; k < s.last; k++) {
            const int64_t cell = cell_at(&beams[i], k, rows, cols);
            if (cell >= 0)
                cells[cell] = lower[before[cell]];
        }
    }
    for (int32_t i = 0; i < count; i++)
        if (hits[i] >= 0)
            cells[hits[i]] = raise[before[hits[i]]];
}

/* The rows that any beam can touch. */
static span rows_touched(int32_t rows, int32_t cols, const beam *beams, const int64_t *hits, int32_t count)
{
    span touched = {rows, 0};
    for (int32_t i = 0; i < count; i++) {
        const span s = samples_of(&beams[i], rows, cols);
        const double ends[2] = {beams[i].row + (double)s.first * beams[i].row_step,
                                beams[i].row + (double)s.last * beams[i].row_step};
        for (int end = 0; end < 2 && s.first < s.last; end++) {
            const int64_t row = ends[end] < 0.0 ? 0 : ends[end] < (double)rows ? (int64_t)ends[end] : rows - 1;
            touched.first = row < touched.first ? row : touched.first;
            touched.last = row >= touched.last ? row + 1 : touched.last;
        }
        if (hits[i] >= 0) {
            touched.first = hits[i] / cols < touched.first ? hits[i] / cols : touched.first;
            touched.last = hits[i] / cols >= touched.last ? hits[i] / cols + 1 : touched.last;
        }
    }
    return touched;
}

static int64_t differences(const uint8_t *cells, const uint8_t *before, int64_t first, int64_t last, int64_t *changed)
{
    int64_t found = 0;
    for (int64_t i = first; i < last; i++) {
        uint64_t now, then;
        while (i + 8 <= last && (memcpy(&now, cells + i, 8), memcpy(&then, before + i, 8), now == then))
            i += 8;
        const int64_t end = i + 8 < last ? i + 8 : last;
        for (; i < end; i++)
            if (cells[i] != before[i])
                changed[found++] = i;
        i--;
    }
    return found;
}

int64_t insert_beams(uint8_t *cells, int32_t rows, int32_t cols, const double *beams, const int64_t *hits, int32_t count,
                     const uint8_t *lower, const uint8_t *raise, int32_t all_at_once, uint8_t *before, int64_t *changed)
{
    const beam *drawn = (const beam *)beams;
    const span touched = rows_touched(rows, cols, drawn, hits, count);
    if (touched.first >= touched.last)
        return 0;
    const int64_t first = touched.first * cols, last = touched.last * cols;
    memcpy(before + first, cells + first, (size_t)(last - first));
    if (all_at_once)
        at_once(cells, rows, cols, drawn, hits, count, lower, raise, before);
    else
        one_by_one(cells, rows, cols, drawn, hits, count, lower, raise);
    return differences(cells, before, first, last, changed);
}
