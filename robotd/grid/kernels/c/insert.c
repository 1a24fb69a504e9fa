/* A sweep into the occupancy grid: each cell is a 256-state machine, and two tables say what a beam does to it.
 *
 * The rule of ray.py: a beam is sampled once per cell of its dominant axis, at start + k * step. Products and sums are
 * rounded one by one (the build forbids contraction), and in the order of inserting.py; so the cells are those of NumPy.
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

static inline double in_cells(double at_m, double origin_m, double resolution_m)
{
    return (at_m - origin_m) / resolution_m;
}

static void draw(const insert_job *job, int32_t i)
{
    const double *r = job->readings + 5 * (size_t)i, sine = job->ahead[i], cosine = job->ahead[job->count + i];
    const double x_m = job->robot_x_m + job->robot_cos * r[2] - job->robot_sin * r[3];
    const double y_m = job->robot_y_m + job->robot_sin * r[2] + job->robot_cos * r[3];
    const double end_row = in_cells(y_m + r[1] * sine, job->origin_y_m, job->resolution_m);
    const double end_col = in_cells(x_m + r[1] * cosine, job->origin_x_m, job->resolution_m);
    const double dominant = fmax(fabs(sine), fabs(cosine));
    beam *b = (beam *)job->beams + i;
    b->row = in_cells(y_m, job->origin_y_m, job->resolution_m);
    b->col = in_cells(x_m, job->origin_x_m, job->resolution_m);
    b->row_step = sine / dominant;
    b->col_step = cosine / dominant;
    b->samples = ceil(fmax(r[1] / job->resolution_m, 0.0) * dominant);
    const int ends_inside =
        end_row >= 0.0 && end_row < (double)job->rows && end_col >= 0.0 && end_col < (double)job->cols;
    job->hits[i] = ends_inside && !(r[4] > 0.0) ? (int64_t)end_row * job->cols + (int64_t)end_col : -1;
}

/* Every beam after the other: the last one through a cell has the last word. */
static void one_by_one(uint8_t *cells, int32_t rows, int32_t cols, const beam *beams, const int64_t *hits, int32_t count,
                       const uint8_t *lower, const uint8_t *higher)
{
    for (int32_t i = 0; i < count; i++) {
        const span s = samples_of(&beams[i], rows, cols);
        for (int64_t k = s.first; k < s.last; k++) {
            const int64_t cell = cell_at(&beams[i], k, rows, cols);
            if (cell >= 0 && cell != hits[i])
                cells[cell] = lower[cells[cell]];
        }
        if (hits[i] >= 0)
            cells[hits[i]] = higher[cells[hits[i]]];
    }
}

/* Each cell once, from the value it had before; a hit beats all misses. */
static void at_once(uint8_t *cells, int32_t rows, int32_t cols, const beam *beams, const int64_t *hits, int32_t count,
                    const uint8_t *lower, const uint8_t *higher, const uint8_t *before)
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
            cells[hits[i]] = higher[before[hits[i]]];
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

int64_t insert_sweep(const insert_job *job)
{
    for (int32_t i = 0; i < job->count; i++)
        draw(job, i);
    const beam *drawn = (const beam *)job->beams;
    const span touched = rows_touched(job->rows, job->cols, drawn, job->hits, job->count);
    if (touched.first >= touched.last)
        return 0;
    const int64_t first = touched.first * job->cols, last = touched.last * job->cols;
    memcpy(job->before + first, job->cells + first, (size_t)(last - first));
    if (job->all_at_once)
        at_once(job->cells, job->rows, job->cols, drawn, job->hits, job->count, job->lower, job->higher, job->before);
    else
        one_by_one(job->cells, job->rows, job->cols, drawn, job->hits, job->count, job->lower, job->higher);
    return differences(job->cells, job->before, first, last, job->changed);
}
