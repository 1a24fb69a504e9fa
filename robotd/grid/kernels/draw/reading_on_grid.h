/* How a reading is drawn on the grid: start, body, head. The one place in C; drawn.py is the one in Python.
 *
 * Rounded as NumPy does it (the build forbids contraction; sines and cosines come from NumPy).
 */
#ifndef ROBOTD_READING_ON_GRID_H
#define ROBOTD_READING_ON_GRID_H

#include <stdint.h>

#include "shared/numbers.h"
#include "shared/shared.h"

/* Where a beam goes: the step of (row, col) from one of its samples to the next, one of which is 1 or -1; and how many
 * samples there are to a cell's length. */
typedef struct {
    double step[2], dominant;
} direction;

static inline direction direction_of(double sine, double cosine)
{
    const double tall = sine < 0.0 ? -sine : sine, wide = cosine < 0.0 ? -cosine : cosine;
    direction d;
    d.dominant = tall > wide ? tall : wide;
    d.step[0] = sine / d.dominant;
    d.step[1] = cosine / d.dominant;
    return d;
}

/* A reading at a heading; offsets are (row, col) from the robot's cell. */
typedef struct {
    double step[2];
    int32_t start[2];
    int32_t cells; /* of the body, from the start on */
    int32_t head[2];
} reading_on_grid;

/* The cell of a point; what is farther than FAR_CELLS counts as being so far. */
static inline int32_t cell_at(double cells)
{
    return whole((cells < -FAR_CELLS ? -FAR_CELLS : cells > FAR_CELLS ? FAR_CELLS : cells) + 0.5);
}

/* Cells from sample to sample of a body of this many cells of length; the one that it starts in is always there. */
static inline int32_t body_cells(double length_cells, double dominant)
{
    const int32_t cells = length_cells > 0.0 ? -whole(-(length_cells * dominant)) : 1;
    return cells < 1 ? 1 : cells;
}

/* A coordinate of the k-th cell of a body. */
static inline int32_t body_cell(const reading_on_grid *r, int axis, int32_t k)
{
    return r->start[axis] + whole(0.5 + k * r->step[axis]);
}

/* Draw a reading that starts at (row, col) [cells from the robot], along the sine and cosine of its bearing in the map. */
static inline reading_on_grid draw_reading(double row, double col, double sine, double cosine, double range_cells,
                                           double error_radius_cells, double reach_cells)
{
    const direction ahead = direction_of(sine, cosine);
    const double shortened = range_cells - error_radius_cells;
    reading_on_grid r;
    r.step[0] = ahead.step[0];
    r.step[1] = ahead.step[1];
    r.start[0] = cell_at(row);
    r.start[1] = cell_at(col);
    r.cells = body_cells(shortened < reach_cells ? shortened : reach_cells, ahead.dominant);
    r.head[0] = cell_at(row + range_cells * sine);
    r.head[1] = cell_at(col + range_cells * cosine);
    return r;
}

#endif
