/* The counting of one tile, written once and compiled for several instruction sets: count.c includes this file with
 *   NAME(x)          the name of x for this instruction set
 *   TARGET           the attribute that allows its instructions
 *   VECTOR           how many bytes a vector has
 *   FUNNEL(a, b, n)  the low 64 bits of (b, a) >> n, lane by lane, 0 <= n < 64
 *   XOR3(a, b, c)    a ^ b ^ c           MAJORITY(a, b, c)  two of them or more
 */

typedef uint64_t NAME(vec) __attribute__((vector_size(VECTOR), aligned(8), may_alias));
#define VEC NAME(vec)
#define LANES ((int)(VECTOR / sizeof(uint64_t)))
#define VECTORS (TILE / LANES)
#define AT(words, i) (*(const VEC *)((words) + (i) * LANES))

/* Walk the chains of a batch and keep, in its slots, the free cells that are not blocked so far. */
static inline TARGET void NAME(walk)(const count_job *job, const int32_t *tile, int32_t batch, uint64_t *kept,
                                     const int twice)
{
    static const int32_t here[2] = {0, 0};
    const size_t stride = (size_t)job->rows + 2 * TILE;
    const uint64_t *free = seen_from(job, job->free, tile, here);
    for (int32_t group = job->batches[batch]; group < job->batches[batch + 1]; group++) {
        VEC open[VECTORS], met[VECTORS] = {{0}};
        for (int i = 0; i < VECTORS; i++)
            open[i] = AT(free, i);
        for (int32_t cell = job->groups[group]; cell < job->groups[group + 1]; cell++) {
            const int32_t *offset = job->chains + 3 * (size_t)cell;
            const uint64_t *low = seen_from(job, job->blocking, tile, offset), *high = low + stride;
            const uint64_t shift = (uint64_t)(offset[1] & 63);
            for (int i = 0; i < VECTORS; i++) {
                const VEC blocking = FUNNEL(AT(low, i), AT(high, i), shift);
                if (twice) {
                    open[i] &= ~(met[i] & blocking);
                    met[i] |= blocking;
                } else
                    open[i] &= ~blocking;
            }
            if (offset[2] < 0)
                continue;
            VEC *slot = (VEC *)(kept + (size_t)offset[2] * TILE);
            for (int i = 0; i < VECTORS; i++)
                slot[i] = open[i];
        }
    }
}

/* counter += 7 beams: carry-save adders make a number of three bits of their planes, and it ripples up the counter. */
static inline TARGET void NAME(add_seven)(uint64_t *counter, const source *beams, int32_t bits)
{
    for (int i = 0; i < VECTORS; i++) {
        VEC plane[7];
        for (int beam = 0; beam < 7; beam++) {
            const source *b = beams + beam;
            plane[beam] = FUNNEL(AT(b->low, i), AT(b->high, i), b->shift) & AT(b->body, i);
        }
        const VEC sum = XOR3(plane[0], plane[1], plane[2]), more = XOR3(plane[3], plane[4], plane[5]);
        const VEC carry1 = MAJORITY(plane[0], plane[1], plane[2]), carry2 = MAJORITY(plane[3], plane[4], plane[5]);
        const VEC carry3 = MAJORITY(sum, more, plane[6]);
        const VEC ones = XOR3(sum, more, plane[6]), twos = XOR3(carry1, carry2, carry3);
        const VEC fours = MAJORITY(carry1, carry2, carry3);
        VEC *n = (VEC *)counter + i;
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

static inline TARGET source NAME(source_of)(const count_job *job, const int32_t *tile, const int32_t *beam,
                                            const uint64_t *kept)
{
    const uint64_t *body = kept + (size_t)beam[0] * TILE, *everything = kept + (size_t)(job->slots + 1) * TILE;
    if (beam[1] == NO_HEAD)
        return (source){everything, everything, 0, body};
    const uint64_t *low = seen_from(job, job->grown, tile, beam + 1);
    return (source){low, low + (size_t)job->rows + 2 * TILE, (uint64_t)(beam[2] & 63), body};
}

static TARGET void NAME(count_tile)(const count_job *job, int32_t number, uint64_t *kept)
{
    const int32_t *tile = job->tiles + 2 * number;
    const size_t counter_size = (size_t)job->bits * TILE;
    uint64_t *counters = job->counters + (size_t)number * (size_t)job->headings * counter_size;
    const uint64_t *nothing = kept + (size_t)job->slots * TILE;
    for (int32_t batch = 0; batch < job->batch_count; batch++) {
        if (job->blocked_by > 1)
            NAME(walk)(job, tile, batch, kept, 1);
        else
            NAME(walk)(job, tile, batch, kept, 0);
        const int32_t *list = job->lists + (size_t)batch * (size_t)job->headings;
        for (int32_t heading = 0; heading < job->headings; heading++) {
            for (int32_t first = list[heading]; first < list[heading + 1]; first += 7) {
                source beams[7];
                for (int32_t i = 0; i < 7; i++)
                    beams[i] = first + i < list[heading + 1]
                                   ? NAME(source_of)(job, tile, job->beams + 3 * (size_t)(first + i), kept)
                                   : (source){nothing, nothing, 0, nothing};
                NAME(add_seven)(counters + (size_t)heading * counter_size, beams, job->bits);
            }
        }
    }
}

#undef AT
#undef VEC
#undef LANES
#undef VECTORS
#undef NAME
#undef TARGET
#undef VECTOR
#undef FUNNEL
#undef XOR3
#undef MAJORITY
