/* A sweep into the occupancy grid: each cell is a 256-state machine, and two tables say what a beam does to it.
 *
 * The rule of ray.py: a beam is sampled once per cell of its dominant axis, at start + k * step. Products and sums are
 * rounded one by one (the build forbids contraction), and in the order of insert_twin.py; so the cells are those of NumPy.
 */
#include "insert/insert.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "draw/reading_on_grid.h"

typedef struct {
    double row, col, row_step, col_step;
    int64_t first, last; /* the samples first <= k < last are those inside the grid */
} beam;

#define RUN 128 /* samples whose cells are found at a time */

/* Bound the k at which start + k * step can lie in [0, size): one to spare at either end, for what rounding does. */
static void bound(beam *b, double start, double step, double size)
{
    if (step == 0.0)
        return;
    const double enter = step > 0.0 ? -start / step : (size - start) / step;
    const double leave = step > 0.0 ? (size - start) / step : -start / step;
    if (enter - 2.0 > (double)b->first)
        b->first = enter - 2.0 > (double)b->last ? b->last : (int64_t)(enter - 2.0);
    if (leave + 2.0 < (double)b->last)
        b->last = leave + 2.0 < (double)b->first ? b->first : (int64_t)(leave + 2.0);
}

static inline int is_inside(const beam *b, int64_t k, int32_t rows, int32_t cols)
{
    const double row = b->row + (double)k * b->row_step, col = b->col + (double)k * b->col_step;
    return row >= 0.0 && col >= 0.0 && row < (double)rows && col < (double)cols;
}

/* Neither coordinate ever turns back, however it is rounded: what lies between two samples inside is inside. */
static void clip(beam *b, double samples, int32_t rows, int32_t cols)
{
    b->first = 0;
    b->last = samples < 9e15 ? (int64_t)samples : (int64_t)9e15;
    /* Most beams are inside from end to end, and bounds take divisions. */
    if (b->first < b->last && is_inside(b, b->first, rows, cols) && is_inside(b, b->last - 1, rows, cols))
        return;
    bound(b, b->row, b->row_step, rows);
    bound(b, b->col, b->col_step, cols);
    while (b->first < b->last && !is_inside(b, b->first, rows, cols))
        b->first++;
    while (b->first < b->last && !is_inside(b, b->last - 1, rows, cols))
        b->last--;
}

/* Find the cells of some samples that are inside; compilers make vector code of this. */
static inline void find_cells(const beam *b, int64_t first, int32_t count, int32_t cols, uint32_t *cells)
{
    for (int32_t i = 0; i < count; i++) {
        const double k = (double)first + (double)i;
        cells[i] = (uint32_t)(int32_t)(b->row + k * b->row_step) * (uint32_t)cols +
                   (uint32_t)(int32_t)(b->col + k * b->col_step);
    }
}

/* to[cell] = table[from[cell]] for the cells that a beam runs through. */
static void run_through(const beam *b, int32_t cols, const uint8_t *table, const uint8_t *from, uint8_t *to)
{
    uint32_t cells[RUN];
    for (int64_t k = b->first; k < b->last; k += RUN) {
        const int32_t count = b->last - k < RUN ? (int32_t)(b->last - k) : RUN;
        find_cells(b, k, count, cols, cells);
        for (int32_t i = 0; i < count; i++)
            to[cells[i]] = table[from[cells[i]]];
    }
}

static inline double in_cells(double at_m, double origin_m, double resolution_m)
{
    return (at_m - origin_m) / resolution_m;
}

/* The cell of a point, -1 outside the grid. */
static int64_t end_of(const insert_job *job, double x_m, double y_m)
{
    const double row = in_cells(y_m, job->origin_y_m, job->resolution_m);
    const double col = in_cells(x_m, job->origin_x_m, job->resolution_m);
    const int is_inside = row >= 0.0 && row < (double)job->rows && col >= 0.0 && col < (double)job->cols;
    return is_inside ? (int64_t)row * job->cols + (int64_t)col : -1;
}

static void draw(const insert_job *job, int32_t i)
{
    const double *r = job->readings + 5 * (size_t)i, sine = job->ahead[i], cosine = job->ahead[job->count + i];
    const double x_m = job->robot_x_m + job->robot_cos * r[2] - job->robot_sin * r[3];
    const double y_m = job->robot_y_m + job->robot_sin * r[2] + job->robot_cos * r[3];
    const direction ahead = direction_of(sine, cosine);
    beam *b = (beam *)job->beams + i;
    b->row = in_cells(y_m, job->origin_y_m, job->resolution_m);
    b->col = in_cells(x_m, job->origin_x_m, job->resolution_m);
    b->row_step = ahead.step[0];
    b->col_step = ahead.step[1];
    clip(b, ceil(fmax(r[1] / job->resolution_m, 0.0) * ahead.dominant), job->rows, job->cols);
    job->hits[i] = r[4] > 0.0 ? -1 : end_of(job, x_m + r[1] * cosine, y_m + r[1] * sine);
}

/* Lower the cells that no beam has met, of those that a beam runs through. */
static void presume(const insert_job *job, const beam *b)
{
    uint32_t cells[RUN];
    const uint8_t lowered = job->lower[job->unseen];
    for (int64_t k = b->first; k < b->last; k += RUN) {
        const int32_t count = b->last - k < RUN ? (int32_t)(b->last - k) : RUN;
        find_cells(b, k, count, job->cols, cells);
        for (int32_t i = 0; i < count; i++)
            job->cells[cells[i]] = job->cells[cells[i]] == job->unseen ? lowered : job->cells[cells[i]];
    }
}

/* Every beam after the other: the last one through a cell has the last word. */
static void one_by_one(const insert_job *job, const beam *beams)
{
    for (int32_t i = 0; i < job->measured; i++) {
        uint8_t *hit = job->hits[i] >= 0 ? job->cells + job->hits[i] : NULL;
        const uint8_t raised = hit ? job->higher[*hit] : 0; /* whether the beam runs through its own end or not */
        run_through(&beams[i], job->cols, job->lower, job->cells, job->cells);
        if (hit)
            *hit = raised;
    }
}

/* Each cell once, from the value it had before; a hit beats all misses. */
static void at_once(const insert_job *job, const beam *beams)
{
    for (int32_t i = 0; i < job->measured; i++)
        run_through(&beams[i], job->cols, job->lower, job->before, job->cells);
    for (int32_t i = 0; i < job->measured; i++)
        if (job->hits[i] >= 0)
            job->cells[job->hits[i]] = job->higher[job->before[job->hits[i]]];
}

typedef struct {
    int64_t first, last;
} span;

static void reach(span *rows, int64_t row)
{
    rows->first = row < rows->first ? row : rows->first;
    rows->last = row >= rows->last ? row + 1 : rows->last;
}

/* The rows that any beam touches. */
static span rows_touched(const insert_job *job, const beam *beams)
{
    span touched = {job->rows, 0};
    for (int32_t i = 0; i < job->count; i++) {
        const beam *b = beams + i;
        if (b->first < b->last) {
            reach(&touched, (int64_t)(b->row + (double)b->first * b->row_step));
            reach(&touched, (int64_t)(b->row + (double)(b->last - 1) * b->row_step));
        }
        if (job->hits[i] >= 0)
            reach(&touched, job->hits[i] / job->cols);
    }
    return touched;
}

/* Eight cells at a time are passed over if they are as before; of the others each is put down, and counts if it changed. */
static int64_t differences(const uint8_t *cells, const uint8_t *before, int64_t first, int64_t last, int64_t *changed)
{
    int64_t found = 0;
    for (int64_t i = first; i < last;) {
        uint64_t now, then;
        while (i + 8 <= last && (memcpy(&now, cells + i, 8), memcpy(&then, before + i, 8), now == then))
            i += 8;
        for (const int64_t end = i + 8 < last ? i + 8 : last; i < end; i++) {
            changed[found] = i;
            found += cells[i] != before[i];
        }
    }
    return found;
}

int64_t insert_sweep(const insert_job *job)
{
    for (int32_t i = 0; i < job->count; i++)
        draw(job, i);
    const beam *drawn = (const beam *)job->beams;
    const span touched = rows_touched(job, drawn);
    if (touched.first >= touched.last)
        return 0;
    const int64_t first = touched.first * job->cols, last = touched.last * job->cols;
    memcpy(job->before + first, job->cells + first, (size_t)(last - first));
    if (job->all_at_once)
        at_once(job, drawn);
    else
        one_by_one(job, drawn);
    for (int32_t i = job->measured; i < job->count; i++)
        presume(job, drawn + i);
    return differences(job->cells, job->before, first, last, job->changed);
}
