/* A sweep into the occupancy grid: each cell is a 256-state machine, and two tables say what a beam does to it.
 *
 * The rule of ray.py: a beam is sampled once per cell of its dominant axis, at start + k * step, for the k of
 * [first, last). Products and sums are rounded one by one (the build forbids contraction), so the cells are those of
 * NumPy.
 */
#include <math.h>
#include <stddef.h>
#include <stdint.h>

#include "kernels.h"

typedef struct {
    double row, col, row_step, col_step, first, last;
} beam;

static inline int64_t cell_at(const beam *b, double k, int32_t rows, int32_t cols)
{
    const double row = b->row + k * b->row_step, col = b->col + k * b->col_step;
    if (!(row >= 0.0 && col >= 0.0 && row < (double)rows && col < (double)cols))
        return -1;
    return (int64_t)row * cols + (int64_t)col;
}

/* Remember a cell that is touched for the first time, with the value it had: seen[cell] is a mark, not the value. */
static inline int64_t touch(uint8_t *seen, int64_t *touched, int64_t count, int64_t cell)
{
    if (seen[cell] == 0) {
        seen[cell] = 1;
        touched[count++] = cell;
    }
    return count;
}

static int64_t one_by_one(uint8_t *cells, int32_t rows, int32_t cols, const beam *beams, const int64_t *hits,
                          int32_t count, const uint8_t *lower, const uint8_t *raise)
{
    (void)rows;
    for (int32_t i = 0; i < count; i++) {
        for (double k = beams[i].first; k < beams[i].last; k += 1.0) {
            const int64_t cell = cell_at(&beams[i], k, rows, cols);
            if (cell >= 0 && cell != hits[i])
                cells[cell] = lower[cells[cell]];
        }
        if (hits[i] >= 0)
            cells[hits[i]] = raise[cells[hits[i]]];
    }
    return 0;
}
