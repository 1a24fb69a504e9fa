/* The counting of one tile, written once and compiled for several instruction sets: count.c includes this file with
 *   NAME(x)          the name of x for this instruction set
 *   TARGET           the attribute that allows its instructions
 *   VECTOR           how many bytes a vector has
 *   AND_NOT(a, b, c) (a | b) & ~c        XOR3(a, b, c)  a ^ b ^ c        MAJORITY(a, b, c)  two of them or more
 */

typedef uint64_t NAME(vec) __attribute__((vector_size(VECTOR), aligned(8), may_alias));
#define VEC NAME(vec)
#define LANES ((int)(VECTOR / sizeof(uint64_t)))
#define VECTORS (TILE / LANES)

/* Where the words of a shifted map begin for one tile, and by how many bits they are shifted. */
static inline TARGET const uint64_t *NAME(source)(const count_job *job, const uint64_t *map, const int32_t *tile,
                                                  const int32_t *offset)
{
    const int32_t word = clamp(tile[0] + (offset[1] >> 6), -2, job->words);
    const int32_t row = clamp(tile[1] + offset[0], -TILE, job->rows);
    return map + (size_t)(word + 2) * (size_t)(job->rows + 2 * TILE) + (size_t)(row + TILE);
}

/* blocked |= the map seen from `offset`. */
static inline TARGET void NAME(block)(const count_job *job, const int32_t *tile, const int32_t *offset, VEC *blocked)
{
    const uint64_t *low = NAME(source)(job, job->occupied, tile, offset);
    const uint64_t *high = low + job->rows + 2 * TILE;
    const uint64_t shift = (uint64_t)(offset[1] & 63), back = 63 - shift;
    for (int i = 0; i < VECTORS; i++) {
        const VEC a = *(const VEC *)(low + i * LANES), b = *(const VEC *)(high + i * LANES);
        blocked[i] |= (a >> shift) | ((b + b) << back);
    }
}

/* plane = the cells from which the head is on the grown map and the body is not blocked. */
static inline TARGET void NAME(feasible)(const count_job *job, const int32_t *tile, const int32_t *head,
                                         const VEC *blocked, VEC *plane)
{
    if (head[0] == NO_HEAD) {
        for (int i = 0; i < VECTORS; i++)
            plane[i] = ~blocked[i];
        return;
    }
    const uint64_t *low = NAME(source)(job, job->grown, tile, head);
    const uint64_t *high = low + job->rows + 2 * TILE;
    const uint64_t shift = (uint64_t)(head[1] & 63), back = 63 - shift;
    for (int i = 0; i < VECTORS; i++) {
        const VEC a = *(const VEC *)(low + i * LANES), b = *(const VEC *)(high + i * LANES);
        plane[i] = AND_NOT((a >> shift), ((b + b) << back), blocked[i]);
    }
}

/* counter += the seven planes: carry-save adders make of them a three-bit number, which ripples up the counter. */
static TARGET void NAME(add_seven)(VEC *counter, const VEC *planes, int32_t bits)
{
    for (int i = 0; i < VECTORS; i++) {
        const VEC *p = planes + i;
        const VEC a = p[0], b = p[VECTORS], c = p[2 * VECTORS], d = p[3 * VECTORS];
        const VEC e = p[4 * VECTORS], f = p[5 * VECTORS], g = p[6 * VECTORS];
        const VEC sum = XOR3(a, b, c), more = XOR3(d, e, f);
        const VEC carry1 = MAJORITY(a, b, c), carry2 = MAJORITY(d, e, f), carry3 = MAJORITY(sum, more, g);
        const VEC ones = XOR3(sum, more, g), twos = XOR3(carry1, carry2, carry3);
        const VEC fours = MAJORITY(carry1, carry2, carry3);
        VEC *n = counter + i;
        const VEC n0 = n[0], n1 = n[VECTORS], n2 = n[2 * VECTORS];
        VEC carry = n0 & ones;
        n[0] = n0 ^ ones;
        n[VECTORS] = XOR3(n1, twos, carry);
        carry = MAJORITY(n1, twos, carry);
        n[2 * VECTORS] = XOR3(n2, fours, carry);
        carry = MAJORITY(n2, fours, carry);
        for (int32_t bit = 3; bit < bits; bit++) {
            const VEC old = n[bit * VECTORS];
            n[bit * VECTORS] = old ^ carry;
            carry &= old;
        }
    }
}

static TARGET void NAME(add_one)(VEC *counter, const VEC *plane, int32_t bits)
{
    for (int i = 0; i < VECTORS; i++) {
        VEC carry = plane[i];
        for (int32_t bit = 0; bit < bits; bit++) {
            const VEC old = counter[bit * VECTORS + i];
            counter[bit * VECTORS + i] = old ^ carry;
            carry &= old;
        }
    }
}

static inline TARGET int NAME(is_empty)(const VEC *plane)
{
    VEC any = plane[0];
    for (int i = 1; i < VECTORS; i++)
        any |= plane[i];
    uint64_t all = 0;
    for (int lane = 0; lane < LANES; lane++)
        all |= any[lane];
    return all == 0;
}

/* A group of one beam: where its head is nowhere on an obstacle, or no longer, the rest of its body need not be walked. */
static inline TARGET int NAME(lone)(const count_job *job, const int32_t *tile, const int32_t *chain, const int32_t *beam,
                                    VEC *plane)
{
    VEC blocked[VECTORS] = {0};
    NAME(block)(job, tile, chain, blocked);
    for (int32_t step = 1; step < beam[1];) {
        NAME(feasible)(job, tile, beam + 2, blocked, plane);
        if (NAME(is_empty)(plane))
            return 0;
        const int32_t stop = beam[1] < step + 16 ? beam[1] : step + 16;
        for (; step < stop; step++)
            NAME(block)(job, tile, chain + 2 * step, blocked);
    }
    NAME(feasible)(job, tile, beam + 2, blocked, plane);
    return !NAME(is_empty)(plane);
}

static TARGET void NAME(count_tile)(const count_job *job, int32_t number, VEC *pending, int32_t *waiting)
{
    const int32_t *tile = job->tiles + 2 * number;
    VEC *counters = (VEC *)(job->counters + (size_t)number * (size_t)job->headings * (size_t)job->bits * TILE);
    const size_t counter_size = (size_t)job->bits * VECTORS, pending_size = (size_t)(7 * VECTORS);
    memset(waiting, 0, (size_t)job->headings * sizeof *waiting);
    for (int32_t group = 0; group < job->group_count; group++) {
        const int32_t *chain = job->chains + 2 * (size_t)job->groups[2 * group];
        const int32_t *beam = job->beams + 4 * (size_t)job->groups[2 * group + 1];
        const int32_t *end = job->beams + 4 * (size_t)job->groups[2 * group + 3];
        if (end - beam == 4) {
            VEC *seven = pending + (size_t)beam[0] * pending_size;
            if (!NAME(lone)(job, tile, chain, beam, seven + (size_t)waiting[beam[0]] * VECTORS))
                continue;
            if (++waiting[beam[0]] == 7) {
                NAME(add_seven)(counters + (size_t)beam[0] * counter_size, seven, job->bits);
                waiting[beam[0]] = 0;
            }
            continue;
        }
        VEC blocked[VECTORS] = {0};
        for (int32_t step = 0; beam < end; beam += 4) {
            for (; step < beam[1]; step++)
                NAME(block)(job, tile, chain + 2 * step, blocked);
            VEC *seven = pending + (size_t)beam[0] * pending_size;
            NAME(feasible)(job, tile, beam + 2, blocked, seven + (size_t)waiting[beam[0]] * VECTORS);
            if (++waiting[beam[0]] == 7) {
                NAME(add_seven)(counters + (size_t)beam[0] * counter_size, seven, job->bits);
                waiting[beam[0]] = 0;
            }
        }
    }
    for (int32_t heading = 0; heading < job->headings; heading++) {
        VEC *seven = pending + (size_t)heading * pending_size, *counter = counters + (size_t)heading * counter_size;
        const int32_t left = waiting[heading];
        if (left >= 3) {
            memset(seven + (size_t)left * VECTORS, 0, (size_t)(7 - left) * TILE * sizeof(uint64_t));
            NAME(add_seven)(counter, seven, job->bits);
            continue;
        }
        for (int32_t plane = 0; plane < left; plane++)
            NAME(add_one)(counter, seven + (size_t)plane * VECTORS, job->bits);
    }
}

#undef VEC
#undef LANES
#undef VECTORS
#undef NAME
#undef TARGET
#undef VECTOR
#undef AND_NOT
#undef XOR3
#undef MAJORITY
