/* The counting of one tile, written once and compiled for several instruction sets (shared/vector.h). */

#define VECTORS (TILE / LANES)
#define AT(words, i) (*(const VEC *)((words) + (i) * LANES))

#define CELLS VEC
#define ADDER(x) NAME(x)
#define SUM3 XOR3
#define CARRY3 MAJORITY
#include "shared/carry_save.h"

static inline TARGET uint64_t NAME(any)(const VEC *words)
{
    VEC all = words[0];
    for (int i = 1; i < VECTORS; i++)
        all |= words[i];
    return ANY(all);
}

/* Of the free cells of a tile leave those from which one of a few beams may be feasible: at a miss all, else those that see
 * something that can end it. Returns whether any is left; if none is, the chains need not be walked. */
static inline TARGET int NAME(narrow)(const count_job *job, const int32_t *tile, const int32_t *beam,
                                      const int32_t *end, const bodies *kept)
{
    const size_t stride = column_of(&job->map);
    VEC *free = (VEC *)(kept->planes + (size_t)job->drawn.slots * TILE), seen[VECTORS] = {{0}};
    const uint64_t columns = NAME(any)(free);
    for (; beam < end; beam += 3) {
        if (beam[1] == NO_HEAD)
            return 1;
        const size_t at = seen_from(job, tile, beam + 1);
        const uint64_t shift = (uint64_t)(beam[2] & 63);
        if ((columns_from(job->map.ending + at, stride, shift) & columns) == 0)
            continue;
        for (int i = 0; i < VECTORS; i++)
            seen[i] |= FUNNEL(AT(job->map.grown + at, i), AT(job->map.grown + at + stride, i), shift);
    }
    for (int i = 0; i < VECTORS; i++)
        free[i] &= seen[i];
    return NAME(any)(free) != 0;
}

/* Walk one chain and keep, for its slots, the free cells that are not blocked so far. */
static inline TARGET void NAME(walk)(const count_job *job, const int32_t *tile, int32_t group, const bodies *kept,
                                     const int twice)
{
    const size_t stride = column_of(&job->map);
    const count_job own = *job; /* a copy, that nothing written can change */
    const int32_t place[2] = {tile[0], tile[1]};
    const int32_t all_free = job->drawn.slots, none = job->drawn.slots + 1;
    const int32_t *offset = job->drawn.chains + 3 * (size_t)job->drawn.groups[group];
    const int32_t *end = job->drawn.chains + 3 * (size_t)job->drawn.groups[group + 1];
    VEC open[VECTORS], met[VECTORS] = {{0}};
    for (int i = 0; i < VECTORS; i++)
        open[i] = AT(kept->planes + (size_t)all_free * TILE, i);
    uint64_t columns = NAME(any)(open);
    int32_t plane = all_free, is_new = 0;
    while (offset < end && columns != 0) {
        const int32_t *last = end - offset > 3 * RUN ? offset + 3 * RUN : end;
        VEC all_gone = {0};
        int32_t slot;
        do {
            const size_t at = seen_from(&own, place, offset);
            const uint64_t shift = (uint64_t)(offset[1] & 63);
            slot = offset[2];
            offset += 3;
            if ((columns_from(own.map.stopping + at, stride, shift) & columns) == 0)
                continue;
            const uint64_t *low = own.map.blocking + at, *high = low + stride;
            for (int i = 0; i < VECTORS; i++) {
                const VEC blocking = FUNNEL(AT(low, i), AT(high, i), shift);
                VEC gone = open[i] & blocking;
                if (twice) {
                    gone &= met[i];
                    met[i] |= blocking;
                }
                open[i] ^= gone;
                all_gone |= gone;
            }
        } while (slot < 0 && offset < last);
        if (!IS_ZERO(all_gone)) {
            columns = NAME(any)(open);
            is_new = 1;
        }
        if (slot < 0)
            continue;
        if (is_new) {
            plane = columns != 0 ? slot : none;
            VEC *cells = (VEC *)(kept->planes + (size_t)slot * TILE);
            for (int i = 0; i < VECTORS; i++)
                cells[i] = open[i];
            is_new = 0;
        }
        kept->columns[slot] = columns;
        kept->plane_of[slot] = plane;
    }
    for (; offset < end; offset += 3) /* all is blocked from here on */
        if (offset[2] >= 0) {
            kept->columns[offset[2]] = 0;
            kept->plane_of[offset[2]] = none;
        }
}

/* A row of vectors of the cells from which a beam is feasible. */
static inline TARGET VEC NAME(plane)(const source *beam, int i)
{
    return FUNNEL(AT(beam->low, i), AT(beam->high, i), beam->shift) & AT(beam->body, i);
}

/* counter += carry, from a bit on; all vectors together, since what a branch does is hard to foresee. */
static inline TARGET void NAME(ripple)(uint64_t *counter, VEC *carry, int32_t bit, int32_t bits)
{
    for (; bit < bits; bit++) {
        VEC *n = (VEC *)counter + bit * VECTORS, all = {0};
        for (int i = 0; i < VECTORS; i++)
            all |= carry[i];
        if (IS_ZERO(all))
            return;
        for (int i = 0; i < VECTORS; i++) {
            const VEC old = n[i];
            n[i] = old ^ carry[i];
            carry[i] &= old;
        }
    }
}

/* counter += 3 beams or fewer: what add_seven does of more. */
static inline TARGET void NAME(add_few)(uint64_t *counter, const source *beams, int32_t count, int32_t bits)
{
    VEC carries[VECTORS];
    for (int i = 0; i < VECTORS; i++) {
        const VEC none = {0}, first = NAME(plane)(beams, i);
        const VEC second = count > 1 ? NAME(plane)(beams + 1, i) : none;
        const VEC third = count > 2 ? NAME(plane)(beams + 2, i) : none;
        VEC *n = (VEC *)counter + i;
        const VEC n0 = n[0], n1 = n[VECTORS], ones = XOR3(first, second, third), twos = MAJORITY(first, second, third);
        const VEC carry = n0 & ones;
        n[0] = n0 ^ ones;
        n[VECTORS] = XOR3(n1, twos, carry);
        carries[i] = MAJORITY(n1, twos, carry);
    }
    NAME(ripple)(counter, carries, 2, bits);
}

/* counter += 7 beams: carry-save adders make a number of three bits of their planes, and it ripples up the counter. */
static inline TARGET void NAME(add_seven)(uint64_t *counter, const source *beams, int32_t bits)
{
    VEC carries[VECTORS];
    for (int i = 0; i < VECTORS; i++) {
        VEC plane[7];
        for (int beam = 0; beam < 7; beam++)
            plane[beam] = NAME(plane)(beams + beam, i);
        carries[i] = NAME(add_three_bits)((VEC *)counter + i, VECTORS, NAME(sum_of_seven)(plane));
    }
    NAME(ripple)(counter, carries, 3, bits);
}

/* counter += times, wherever the robot may stand. */
static TARGET void NAME(add_everywhere)(uint64_t *counter, const uint64_t *free, uint32_t times, int32_t bits)
{
    for (int i = 0; i < VECTORS; i++) {
        const VEC here = AT(free, i);
        VEC *n = (VEC *)counter + i, carry = {0};
        for (int32_t bit = 0; bit < bits; bit++) {
            const VEC old = n[bit * VECTORS], add = here & -(uint64_t)(times >> bit & 1);
            n[bit * VECTORS] = XOR3(old, add, carry);
            carry = MAJORITY(old, add, carry);
        }
    }
}

/* Find the beams of a list that have something to say of a tile. Most do not: their bodies are blocked from all of it,
 * or all that they leave open lies in columns in which no beam ends. And a miss whose body nothing blocks says the same of
 * all free cells: these are counted in `everywhere`. Returns how many of the first `most` were found, and where to go on. */
static inline TARGET int32_t NAME(telling)(const count_job *job, const int32_t *tile, const int32_t **next,
                                           const int32_t *end, const bodies *kept, source *found, int32_t count,
                                           uint32_t *everywhere)
{
    const count_job own = *job; /* a copy, that what is written cannot change */
    const bodies open = *kept;
    const int32_t place[2] = {tile[0], tile[1]};
    const size_t stride = column_of(&own.map);
    const uint64_t *all = open.planes + (size_t)(own.drawn.slots + 2) * TILE;
    const int32_t *beam = *next;
    uint32_t all_over = 0;
    for (; beam < end && count < FOUND_MAX; beam += 3) {
        const int32_t slot = beam[0], plane = open.plane_of[slot];
        const uint64_t *body = open.planes + (size_t)plane * TILE;
        if (beam[1] == NO_HEAD) {
            const int32_t free = plane == own.drawn.slots;
            found[count] = (source){all, all, 0, body};
            all_over += (uint32_t)free;
            count += !free & (open.columns[slot] != 0);
        } else {
            const size_t at = seen_from(&own, place, beam + 1);
            const uint64_t shift = (uint64_t)(beam[2] & 63);
            found[count] = (source){own.map.grown + at, own.map.grown + at + stride, shift, body};
            count += (columns_from(own.map.ending + at, stride, shift) & open.columns[slot]) != 0;
        }
    }
    *next = beam;
    *everywhere += all_over;
    return count;
}

static TARGET void NAME(count_list)(const count_job *job, const int32_t *tile, const int32_t *beam, const int32_t *end,
                                    const bodies *kept, uint64_t *counter)
{
    const uint64_t *free = kept->planes + (size_t)job->drawn.slots * TILE, *none = free + TILE;
    source found[FOUND_MAX];
    int32_t count = 0;
    uint32_t everywhere = 0;
    while (beam < end) {
        count = NAME(telling)(job, tile, &beam, end, kept, found, count, &everywhere);
        int32_t added = 0;
        for (; added + 7 <= count; added += 7)
            NAME(add_seven)(counter, found + added, job->bits);
        memmove(found, found + added, (size_t)(count - added) * sizeof *found);
        count -= added;
    }
    if (count > 3) {
        while (count < 7)
            found[count++] = (source){none, none, 0, none};
        NAME(add_seven)(counter, found, job->bits);
    } else if (count > 0) {
        NAME(add_few)(counter, found, count, job->bits);
    }
    if (everywhere > 0)
        NAME(add_everywhere)(counter, free, everywhere, job->bits);
}

static TARGET void NAME(count_tile)(const count_job *job, int32_t number, const bodies *kept)
{
    const int32_t *tile = job->map.tiles + 2 * number;
    const size_t counter_size = (size_t)job->bits * TILE;
    uint64_t *counters = job->counters + (size_t)number * (size_t)job->headings * counter_size;
    for (int32_t batch = 0; batch < job->drawn.batch_count; batch++) {
        const int32_t *list = job->drawn.lists + (size_t)batch * (size_t)job->headings;
        if (job->drawn.batch_count == 1 && list[job->headings] - list[0] <= FEW &&
            !NAME(narrow)(job, tile, job->drawn.beams + 3 * (size_t)list[0],
                          job->drawn.beams + 3 * (size_t)list[job->headings], kept))
            continue;
        for (int32_t group = job->drawn.batches[batch]; group < job->drawn.batches[batch + 1]; group++)
            if (job->map.blocked_by > 1)
                NAME(walk)(job, tile, group, kept, 1);
            else
                NAME(walk)(job, tile, group, kept, 0);
        for (int32_t heading = 0; heading < job->headings; heading++)
            NAME(count_list)(job, tile, job->drawn.beams + 3 * (size_t)list[heading],
                             job->drawn.beams + 3 * (size_t)list[heading + 1], kept,
                             counters + (size_t)heading * counter_size);
    }
}

#undef AT
#undef VECTORS
