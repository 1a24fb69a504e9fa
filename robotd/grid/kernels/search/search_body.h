/* The search of one heading, written once and compiled for several instruction sets (shared/vector.h). */

#define VECTORS (8 / LANES)

#define CELLS VEC
#define ADDER(x) NAME(x)
#define SUM3 XOR3
#define CARRY3 MAJORITY
#include "shared/carry_save.h"

#define CELLS window
#define ADDER(x) NAME(window_##x)
#define SUM3(a, b, c) ((a) ^ (b) ^ (c))
#define CARRY3(a, b, c) (((a) & (b)) | ((c) & ((a) ^ (b))))
#include "shared/carry_save.h"

/* Where to find what the blocks of a tile may meet at a head. */
static inline TARGET const uint64_t *NAME(place)(const grid *of, const pooled_beam *b, const int32_t *tile,
                                                 uint64_t *shift)
{
    const int32_t word = tile[0] + b->word, row = tile[1] + b->row;
    const int far = far_words(of->words, word, b->shift);
    /* All that is far away is the same, and stands after the rim on the right and below. */
    *shift = far ? RIM : b->shift;
    return b->phase + (ptrdiff_t)((far ? of->words : word) + 2) * of->stride +
           (far_rows(of->rows, row) ? of->rows + RIM : row) + ABOVE;
}

/* Bound the ranks of all blocks of a tile from above: how many heads may lie on what ends beams. */
static TARGET void NAME(bound_tile)(const grid *of, const pooled_beam *beams, int32_t count, const int32_t *tile,
                                    int32_t bits, uint64_t *counter)
{
    VEC n[BITS_MAX * VECTORS];
    memset(n, 0, (size_t)(bits * 8) * sizeof(uint64_t));
    int32_t first = 0;
    for (; first + 7 <= count; first += 7) {
        const uint64_t *from[7];
        uint64_t shift[7];
        for (int32_t i = 0; i < 7; i++)
            from[i] = NAME(place)(of, beams + first + i, tile, &shift[i]);
        for (int v = 0; v < VECTORS; v++) {
            VEC plane[7];
            for (int32_t i = 0; i < 7; i++) {
                const uint64_t *at = from[i] + v * LANES;
                plane[i] = FUNNEL(*(const VEC *)at, *(const VEC *)(at + of->stride), shift[i]);
            }
            const VEC carry = NAME(add_three_bits)(n + v, VECTORS, NAME(sum_of_seven)(plane));
            NAME(carry_on)(n + v, VECTORS, 3, bits, carry);
        }
    }
    for (; first < count; first++) {
        uint64_t shift;
        const uint64_t *from = NAME(place)(of, beams + first, tile, &shift);
        for (int v = 0; v < VECTORS; v++) {
            const uint64_t *at = from + v * LANES;
            const VEC one = FUNNEL(*(const VEC *)at, *(const VEC *)(at + of->stride), shift);
            NAME(carry_on)(n + v, VECTORS, 0, bits, one);
        }
    }
    memcpy(counter, n, (size_t)(bits * 8) * sizeof(uint64_t));
}

/* What the cells of a window see at an offset. */
static inline TARGET window NAME(seen)(const search_map *map, const uint16_t *plane, int32_t row, int32_t col)
{
    const size_t stride = (size_t)strip_size(map);
    const uint32_t strip = (uint32_t)(floor_div(col, WINDOW) + 2), from = (uint32_t)(row + WINDOW);
    const int is_near = strip <= (uint32_t)strips(map) + 2 && from <= stride - WINDOW;
    const uint16_t *at = plane + (is_near ? strip * stride + from : 0); /* all that is far outside is like the corner */
    return (window)SLIDE(*(const window *)at, *(const window *)(at + stride), col & (WINDOW - 1));
}

static inline TARGET int NAME(any)(window cells)
{
    const pair four = (pair)cells;
    return (four[0] | four[1] | four[2] | four[3]) != 0;
}

/* The cells from which a beam may be feasible: its head is right, and the end of its body is not blocked. */
static inline TARGET window NAME(maybe)(const search_map *map, const beam *b, int32_t row, int32_t col)
{
    window blocked = NAME(seen)(map, cell_plane(map, BLOCKING), row + b->last[0], col + b->last[1]);
    if (map->blocked_by > 1)
        blocked &= NAME(seen)(map, cell_plane(map, BLOCKING), row + b->before[0], col + b->before[1]);
    if (b->is_miss)
        return ~blocked;
    return NAME(seen)(map, cell_plane(map, GROWN + b->level), row + b->at.head[0], col + b->at.head[1]) & ~blocked;
}

/* Count what the ends of the beams say; returns whether any cell is left. Counters begin so that they overflow with
 * one miss more than allowed. */
static TARGET int NAME(count_ends)(const search_job *job, const beam *beams, sheet *at, int32_t allowed)
{
    const search_map *map = job->map;
    const int32_t count = job->reading_count;
    at->bits = 3;
    while (allowed >> at->bits)
        at->bits++;
    at->start = (1 << at->bits) - 1 - allowed;
    for (int32_t bit = 0; bit < at->bits; bit++)
        at->misses[bit] = (window){0} - (uint16_t)((at->start >> bit) & 1);
    for (int32_t first = 0; first < count; first += 7) {
        window miss[7] = {{0}};
        for (int32_t i = 0; i < 7 && first + i < count; i++) {
            at->maybe[first + i] = NAME(maybe)(map, beams + first + i, at->row, at->col);
            miss[i] = ~at->maybe[first + i];
        }
        const window over = NAME(window_add_three_bits)(at->misses, 1, NAME(window_sum_of_seven)(miss));
        const window carry = NAME(window_carry_on)(at->misses, 1, 3, at->bits, over);
        at->alive &= ~carry;
        at->work += 7;
        if (!NAME(any)(at->alive))
            return 0;
    }
    return 1;
}

/* The cells, among some, from which a body meets too many cells that block. Steps are skipped as long as nothing that
 * blocks is near the middle of the cells that are left. */
static TARGET window NAME(blocked)(const search_map *map, const beam *b, sheet *at, window cells)
{
    window once = {0}, blocked = {0};
    for (int32_t k = b->at.start[0] == 0 && b->at.start[1] == 0; k < b->at.cells;) {
        at->work++;
        const int32_t row = body_cell(&b->at, 0, k), col = body_cell(&b->at, 1, k);
        const int32_t clear = clearance(map, at->middle[0] + row, at->middle[1] + col) - at->radius;
        if (clear > 0) {
            k += clear;
            continue;
        }
        const window here = NAME(seen)(map, cell_plane(map, BLOCKING), at->row + row, at->col + col);
        if (map->blocked_by > 1)
            blocked |= once & here;
        else
            blocked |= here;
        once |= here;
        if (!NAME(any)(cells & ~blocked))
            break;
        k++;
    }
    return blocked & cells;
}

static TARGET int NAME(count_bodies)(const search_job *job, const beam *beams, sheet *at)
{
    surround(at);
    for (int32_t i = 0; i < job->reading_count; i++) {
        const window cells = at->alive & at->maybe[i];
        if (!NAME(any)(cells))
            continue;
        const window blocked = NAME(blocked)(job->map, beams + i, at, cells);
        if (!NAME(any)(blocked))
            continue;
        const window dead = NAME(window_carry_on)(at->misses, 1, 0, at->bits, blocked);
        if (!NAME(any)(at->alive & dead))
            continue;
        at->alive &= ~dead;
        if (!NAME(any)(at->alive))
            return 0;
        surround(at);
    }
    return 1;
}

/* Draw the beams of one heading. */
static TARGET void NAME(draw_heading)(const search_job *job, int32_t heading, beam *beams)
{
    const double *h = job->headings + 2 * (size_t)heading;
    const double *sines = job->sines + (size_t)heading * (size_t)job->reading_count;
    const double *cosines = job->cosines + (size_t)heading * (size_t)job->reading_count;
    for (int32_t i = 0; i < job->reading_count; i++) {
        const double *r = job->readings + 4 * (size_t)i;
        const int starts_here = r[1] == 0.0 && r[2] == 0.0;
        const double start_row = starts_here ? 0.0 : (h[0] * r[1] + h[1] * r[2]) / job->resolution_m;
        const double start_col = starts_here ? 0.0 : (h[1] * r[1] - h[0] * r[2]) / job->resolution_m;
        beam *b = beams + i;
        b->level = job->levels[i];
        b->at = draw_reading(start_row, start_col, sines[i], cosines[i], r[0], job->radii[b->level], job->reach_cells);
        b->is_miss = r[3] > 0.0;
        for (int axis = 0; axis < 2; axis++) {
            b->last[axis] = body_cell(&b->at, axis, b->at.cells - 1);
            if (job->map->blocked_by > 1)
                b->before[axis] = b->at.cells < 2 ? 0 : body_cell(&b->at, axis, b->at.cells - 2);
        }
    }
}

static const kernel NAME(kernel) = {NAME(draw_heading), NAME(bound_tile), NAME(count_ends), NAME(count_bodies)};

#undef VECTORS
