/* The exact Euclidean distance transform in two passes: along the columns the way to the nearest source of each, then
 * along the rows the lower envelope of one parabola a column, found in one sweep to and fro (Meijster, Roerdink and
 * Hesselink, "A general algorithm for computing distance transforms in linear time", 2000). Whole numbers throughout.
 */
#include "distance/distance.h"

#include <stddef.h>

#include "shared/numbers.h"

/* One row farther; what is beyond the limit stays there. */
static inline int32_t next(int32_t way, uint8_t source, int32_t limit)
{
    return source ? 0 : way >= limit ? NOWHERE : way + 1;
}

/* along = rows to the nearest source of the same column, for the rows of the window and the columns first to end. */
static void along_columns(const distance_job *job, int32_t first, int32_t end)
{
    const int32_t top = larger(0, job->first_row - job->limit), bottom = smaller(job->rows, job->end_row + job->limit);
    int32_t *way = job->spare;
    for (int32_t col = first; col < end; col++)
        way[col] = job->outside && top == 0 ? 0 : NOWHERE;
    for (int32_t row = top; row < job->end_row; row++) {
        const uint8_t *sources = job->sources + (size_t)row * (size_t)job->cols;
        for (int32_t col = first; col < end; col++)
            way[col] = next(way[col], sources[col], job->limit);
        if (row < job->first_row)
            continue;
        int32_t *along = job->along + (size_t)(row - job->first_row) * (size_t)job->cols;
        for (int32_t col = first; col < end; col++)
            along[col] = way[col];
    }
    for (int32_t col = first; col < end; col++)
        way[col] = job->outside && bottom == job->rows ? 0 : NOWHERE;
    for (int32_t row = bottom - 1; row >= job->first_row; row--) {
        const uint8_t *sources = job->sources + (size_t)row * (size_t)job->cols;
        for (int32_t col = first; col < end; col++)
            way[col] = next(way[col], sources[col], job->limit);
        if (row >= job->end_row)
            continue;
        int32_t *along = job->along + (size_t)(row - job->first_row) * (size_t)job->cols;
        for (int32_t col = first; col < end; col++)
            along[col] = smaller(along[col], way[col]);
    }
}

/* Parabolas of the lower envelope, from left to right: whose column, how high, and from which column on each is least. */
typedef struct {
    int32_t *column, *height, *from;
    int32_t last;
} envelope;

static inline int32_t value(int32_t at, int32_t column, int32_t height)
{
    return (at - column) * (at - column) + height;
}

static inline void put(envelope *e, const distance_job *job, int32_t column, int32_t way)
{
    if (way == NOWHERE)
        return;
    const int32_t height = way * way;
    while (e->last >= 0 &&
           value(e->from[e->last], e->column[e->last], e->height[e->last]) > value(e->from[e->last], column, height))
        e->last--;
    int32_t from = job->first_col;
    if (e->last >= 0) {
        const int32_t other = e->column[e->last];
        from = 1 + (column * column - other * other + height - e->height[e->last]) / (2 * (column - other));
        if (from >= job->end_col)
            return;
    }
    e->last++;
    e->column[e->last] = column;
    e->height[e->last] = height;
    e->from[e->last] = from;
}

static void along_row(const distance_job *job, const int32_t *along, int32_t first, int32_t end, int32_t *squares)
{
    const int32_t size = job->cols + 2, farthest = job->limit * job->limit;
    envelope e = {job->spare, job->spare + size, job->spare + 2 * (size_t)size, -1};
    if (job->outside && first == 0)
        put(&e, job, -1, 0);
    for (int32_t col = first; col < end; col++)
        put(&e, job, col, along[col]);
    if (job->outside && end == job->cols)
        put(&e, job, job->cols, 0);
    if (e.last < 0) {
        for (int32_t col = job->first_col; col < job->end_col; col++)
            squares[col] = NOWHERE;
        return;
    }
    for (int32_t col = job->end_col - 1; col >= job->first_col; col--) {
        const int32_t square = value(col, e.column[e.last], e.height[e.last]);
        squares[col] = square <= farthest ? square : NOWHERE;
        e.last -= col == e.from[e.last];
    }
}

void squared_distances(const distance_job *job)
{
    const int32_t first = larger(0, job->first_col - job->limit), end = smaller(job->cols, job->end_col + job->limit);
    along_columns(job, first, end);
    for (int32_t row = job->first_row; row < job->end_row; row++)
        along_row(job, job->along + (size_t)(row - job->first_row) * (size_t)job->cols, first, end,
                  job->squares + (size_t)row * (size_t)job->cols);
}
