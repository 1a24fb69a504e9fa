/* The most probable poses by bounds that hold: blocks of cells first, then their cells, then the bodies of the beams.
 *
 * A pose is an answer if it misses few enough readings, so everything here counts misses and stops where there are too
 * many. (1) Per heading, the heads of all beams are looked up in the pooled planes: no cell of a block explains more
 * readings than the block. (2) The most promising blocks give a first best rank. (3) In the blocks that can still hold
 * an answer, heads and ends of bodies are counted cell by cell, 256 at a time; (4) for the cells that are left, the
 * bodies are walked. Whatever the order, what is returned depends on the ranks alone.
 */
#include <pthread.h>
#include <string.h>

#include "planes_layout.h"
#include "search.h"

#define BITS_MAX 16
#define THREADS_MAX 16
#define SEEDS 16
#define FAR_CELLS 268435456.0

typedef uint16_t window __attribute__((vector_size(32), aligned(2), may_alias)); /* a row of 16 cells in each lane */
typedef uint64_t pair __attribute__((vector_size(32), aligned(2), may_alias));

/* A reading at a heading; offsets are (row, col) from the robot's cell. */
typedef struct {
    double step[2];
    int32_t start[2], cells;        /* of the chain that is the body, without the robot's own cell where it starts elsewhere */
    int32_t head[2], last[2], before[2]; /* the last cell of the body, and the one before it */
    int32_t is_miss;
} beam;

/* A head as the grid of blocks sees it. */
typedef struct {
    const uint64_t *phase;
    int32_t word, row;
    uint64_t shift;
} pooled_beam;

/* The counters of one window. */
typedef struct {
    int32_t row, col, bits, start, radius;
    int32_t middle[2];              /* all that are alive are at most radius from it */
    window alive, misses[BITS_MAX + 1];
    window *maybe;                  /* [readings]: from where the end of each beam is right */
} sheet;

typedef struct {
    void (*draw_heading)(const search_job *, int32_t, int32_t, beam *);
    void (*bound_tile)(const search_job *, const pooled_beam *, int32_t, const int32_t *, uint64_t *);
    int (*count_ends)(const search_job *, const beam *, sheet *, int32_t);
    int (*count_bodies)(const search_job *, const beam *, sheet *);
} kernel;

static inline int32_t whole(double value) /* floor, of what fits */
{
    const int32_t truncated = (int32_t)value;
    return truncated - (value < truncated);
}

static inline int32_t nearest(double cells)
{
    return whole((cells < -FAR_CELLS ? -FAR_CELLS : cells > FAR_CELLS ? FAR_CELLS : cells) + 0.5);
}

static inline int32_t larger(int32_t a, int32_t b)
{
    return a > b ? a : b;
}

/* No cell that blocks is nearer than this. */
static inline int32_t clearance(const search_map *map, int32_t row, int32_t col)
{
    const int32_t outside = larger(larger(-row, row - map->rows + 1), larger(-col, col - map->cols + 1));
    if (outside > 0)
        return map->outside_blocks ? 0 : outside;
    return map->near[(size_t)row * (size_t)map->cols + (size_t)col];
}

/* Put a square around the cells that are left. */
static void surround(sheet *at)
{
    uint32_t cols = 0;
    int32_t first = WINDOW, last = 0;
    for (int32_t row = 0; row < WINDOW; row++)
        if (at->alive[row]) {
            cols |= at->alive[row];
            first = first < row ? first : row;
            last = row;
        }
    const int32_t left = __builtin_ctz(cols | 1u << 16), right = 31 - __builtin_clz(cols | 1);
    at->middle[0] = at->row + (first + last) / 2;
    at->middle[1] = at->col + (left + right) / 2;
    at->radius = larger(last - first + 1, right - left + 1) / 2;
}

#define XOR3_(a, b, c) ((a) ^ (b) ^ (c))
#define MAJORITY_(a, b, c) (((a) & (b)) | ((c) & ((a) ^ (b))))

#define NAME(x) x##_portable
#define TARGET
#define VECTOR 16
#define FUNNEL(a, b, n) ((a) >> (n) | ((b) + (b)) << (63 - (n)))
#define XOR3(a, b, c) XOR3_(a, b, c)
#define MAJORITY(a, b, c) MAJORITY_(a, b, c)
#include "search_body.h"

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#define HAS_X86 1

#define NAME(x) x##_avx2
#define TARGET __attribute__((target("avx2")))
#define VECTOR 32
#define FUNNEL(a, b, n)                                                                                                \
    ((VEC)_mm256_or_si256(_mm256_srl_epi64((__m256i)(a), _mm_cvtsi64_si128((long long)(n))),                           \
                          _mm256_sll_epi64((__m256i)(b), _mm_cvtsi64_si128((long long)(64 - (n))))))
#define XOR3(a, b, c) XOR3_(a, b, c)
#define MAJORITY(a, b, c) MAJORITY_(a, b, c)
#include "search_body.h"

#define TERNARY(a, b, c, table) ((VEC)_mm512_ternarylogic_epi64((__m512i)(a), (__m512i)(b), (__m512i)(c), table))
#define NAME(x) x##_avx512
#define TARGET __attribute__((target("avx512f,avx512bw,avx512vl,avx512vbmi2")))
#define VECTOR 64
#define FUNNEL(a, b, n) ((VEC)_mm512_shrdv_epi64((__m512i)(a), (__m512i)(b), _mm512_set1_epi64((long long)(n))))
#define XOR3(a, b, c) TERNARY(a, b, c, 0x96)
#define MAJORITY(a, b, c) TERNARY(a, b, c, 0xE8)
#include "search_body.h"
#endif

static const kernel *kernel_of(int32_t instructions)
{
#ifdef HAS_X86
    const int32_t best = __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") &&
                                 __builtin_cpu_supports("avx512vbmi2")
                             ? 2
                         : __builtin_cpu_supports("avx2") ? 1
                                                          : 0;
    static const kernel *const kernels[] = {&kernel_portable, &kernel_avx2, &kernel_avx512};
#else
    const int32_t best = 0;
    static const kernel *const kernels[] = {&kernel_portable};
#endif
    return instructions > best ? NULL : kernels[instructions < 0 ? best : instructions];
}

/* All that the threads share. A unit is what is bounded at once: a tile of blocks, or one window. */
typedef struct {
    search_job *job;
    const kernel *with;
    int32_t units, stride;          /* stride: readings are taken in an order that jumps round the robot */
    int32_t (*tiles)[2];            /* [units]: column of words and first row of blocks, or row and column of a window */
    uint64_t *counters;             /* [headings][units][bits][8], if by blocks */
    int32_t *bounds;                /* [headings][units] */
    int32_t *order;                 /* [headings]: the best bound first */
    int32_t next, bounding;
    int32_t least;                  /* what a pose must explain to be returned, as far as is known */
    pthread_mutex_t lock;
} search;

typedef struct {
    search *shared;
    beam *beams;                    /* [readings] */
    pooled_beam *pooled;            /* [readings] */
    sheet at;
} worker;

static int32_t units_of(const search_job *job)
{
    if (job->by_blocks)
        return block_words(job->map) * (block_rows(job->map) / 8);
    return up(job->area[1] - job->area[0], WINDOW) * up(job->area[3] - job->area[2], WINDOW);
}

static size_t worker_words(const search_job *job)
{
    return (size_t)job->reading_count * ((sizeof(beam) + sizeof(pooled_beam) + sizeof(window)) / 8 + 1) + 8;
}

int64_t search_size(const search_job *job)
{
    const int64_t units = units_of(job), headings = job->heading_count;
    return (job->by_blocks ? headings * units * job->bits * 8 : 0) + units + (headings * units + headings) / 2 + 2 +
           THREADS_MAX * (int64_t)worker_words(job);
}

static void place_units(search *s)
{
    const search_job *job = s->job;
    s->units = 0;
    if (!job->by_blocks) {
        for (int32_t row = job->area[0]; row < job->area[1]; row += WINDOW)
            for (int32_t col = job->area[2]; col < job->area[3]; col += WINDOW) {
                s->tiles[s->units][0] = row;
                s->tiles[s->units++][1] = col;
            }
        return;
    }
    const int32_t high = 8 * job->map->pool, wide = 64 * job->map->pool;
    for (int32_t row = job->area[0] / high; row * high < job->area[1]; row++)
        for (int32_t word = job->area[2] / wide; word * wide < job->area[3]; word++) {
            s->tiles[s->units][0] = word;
            s->tiles[s->units++][1] = 8 * row;
        }
}

/* Set alive the cells of a window where poses are asked for. */
static int open_window(const search_job *job, int32_t row, int32_t col, sheet *at)
{
    const search_map *map = job->map;
    const uint16_t *plane = cell_plane(map, FREE);
    const int32_t stride = strip_size(map), shift = col & (WINDOW - 1);
    const uint16_t *low = plane + (ptrdiff_t)(col / WINDOW + 2) * stride + row + WINDOW, *high = low + stride;
    uint16_t any = 0, cells[WINDOW] = {0};
    at->row = row;
    at->col = col;
    for (int32_t i = 0; i < WINDOW; i++) {
        if (row + i < job->area[0] || row + i >= job->area[1])
            continue;
        const int32_t *span = job->spans + 2 * (size_t)(row + i - job->area[0]);
        const int32_t first = clamp(span[0] - col, 0, WINDOW), last = clamp(span[1] - col, first, WINDOW);
        cells[i] = (uint16_t)((low[i] >> shift | high[i] << (WINDOW - shift)) & ((1 << last) - (1 << first)));
        any |= cells[i];
    }
    memcpy(&at->alive, cells, sizeof cells);
    return any != 0;
}

/* What the cells of a sheet missed. */
static int32_t misses_at(const sheet *at, int32_t row, int32_t col)
{
    int32_t value = 0;
    for (int32_t bit = 0; bit < at->bits; bit++)
        value |= ((at->misses[bit][row] >> col) & 1) << bit;
    return value - at->start;
}

/* Keep alive but the cell that missed least; returns what it missed. */
static int32_t keep_best(sheet *at)
{
    int32_t best = INT32_MAX, kept[2] = {0, 0};
    for (int32_t row = 0; row < WINDOW; row++)
        for (int32_t col = 0; col < WINDOW; col++)
            if ((at->alive[row] >> col) & 1 && misses_at(at, row, col) < best) {
                best = misses_at(at, row, col);
                kept[0] = row;
                kept[1] = col;
            }
    at->alive = (window){0};
    at->alive[kept[0]] = (uint16_t)(1 << kept[1]);
    return best;
}

static void raise_least(search *s, int32_t least)
{
    if (least > s->least)
        __atomic_store_n(&s->least, least, __ATOMIC_RELAXED);
}

static void found_rank(search *s, int32_t rank)
{
    if (rank <= s->job->best_rank)
        return;
    s->job->best_rank = rank;
    if (rank >= s->job->least_rank)
        raise_least(s, rank - s->job->slack);
}

/* Drop the poses that are no answers any more; if too many are left, ask for more. */
static void compact(search *s)
{
    search_job *job = s->job;
    for (;;) {
        int32_t kept = 0, lowest = INT32_MAX;
        for (int32_t i = 0; i < job->pose_count; i++) {
            const int32_t *pose = job->poses + 4 * (size_t)i;
            if (pose[3] < s->least)
                continue;
            memmove(job->poses + 4 * (size_t)kept++, pose, 4 * sizeof *pose);
            lowest = pose[3] < lowest ? pose[3] : lowest;
        }
        job->pose_count = kept;
        if (kept <= job->limit)
            return;
        raise_least(s, lowest + 1);
    }
}

static void report(search *s, int32_t heading, const sheet *at)
{
    search_job *job = s->job;
    pthread_mutex_lock(&s->lock);
    for (int32_t row = 0; row < WINDOW; row++)
        for (uint32_t left = at->alive[row]; left; left &= left - 1) {
            const int32_t col = __builtin_ctz(left), rank = job->reading_count - misses_at(at, row, col);
            found_rank(s, rank);
            if (rank < s->least)
                continue;
            const int32_t pose[4] = {heading, at->row + row, at->col + col, rank};
            memcpy(job->poses + 4 * (size_t)job->pose_count++, pose, sizeof pose);
        }
    if (job->pose_count > 2 * job->limit)
        compact(s);
    pthread_mutex_unlock(&s->lock);
}

static int32_t allowed_misses(const search *s)
{
    return s->job->reading_count - __atomic_load_n(&s->least, __ATOMIC_RELAXED);
}

/* Look at a window cell by cell. */
static void search_window(worker *self, int32_t heading, int32_t row, int32_t col)
{
    search *s = self->shared;
    const int32_t allowed = allowed_misses(s);
    if (allowed < 0 || !open_window(s->job, row, col, &self->at))
        return;
    if (s->with->count_ends(s->job, self->beams, &self->at, allowed) &&
        s->with->count_bodies(s->job, self->beams, &self->at))
        report(s, heading, &self->at);
}

static void greatest_of(const uint64_t *counter, int32_t bits, int32_t *value, uint64_t *where)
{
    memset(where, 0xff, 8 * sizeof *where);
    *value = 0;
    for (int32_t bit = bits - 1; bit >= 0; bit--) {
        uint64_t any = 0;
        for (int i = 0; i < 8; i++)
            any |= where[i] & counter[8 * bit + i];
        if (any == 0)
            continue;
        *value |= 1 << bit;
        for (int i = 0; i < 8; i++)
            where[i] &= counter[8 * bit + i];
    }
}

/* The blocks of a tile that reach a count. */
static void reach(const uint64_t *counter, int32_t bits, int32_t least, uint64_t *mask)
{
    uint64_t equal[8];
    memset(equal, 0xff, sizeof equal);
    memset(mask, least < 0 ? 0xff : 0, sizeof equal);
    for (int32_t bit = bits - 1; bit >= 0; bit--) {
        const uint64_t wanted = (least >> bit) & 1 ? ~(uint64_t)0 : 0;
        for (int i = 0; i < 8; i++) {
            mask[i] |= equal[i] & counter[8 * bit + i] & ~wanted;
            equal[i] &= ~(counter[8 * bit + i] ^ wanted);
        }
    }
    for (int i = 0; i < 8; i++)
        mask[i] |= equal[i];
}

static int32_t pool_beams(worker *self)
{
    const search_job *job = self->shared->job;
    const search_map *map = job->map;
    const size_t size = phase_size(map);
    const int32_t pool = map->pool, ring = 2 * RING + 1;
    int32_t count = 0;
    for (int32_t i = 0; i < job->reading_count; i++) {
        const beam *b = self->beams + i;
        if (b->is_miss)
            continue;
        int32_t keys[2];
        for (int which = 0; which < 2; which++) {
            const int32_t *end = which == 0 || map->blocked_by == 1 ? b->last : b->before;
            const int32_t row = end[0] - b->head[0] + RING, col = end[1] - b->head[1] + RING;
            const int inside = row >= 0 && row < ring && col >= 0 && col < ring;
            keys[which] = inside && b->cells >= map->blocked_by ? map->key_of[row * ring + col] : 0;
        }
        const int32_t key = keys[0] == keys[1] ? keys[0] : 0;
        const int32_t row = floor_div(b->head[0], pool), col = floor_div(b->head[1], pool);
        const int32_t phase = (key * pool + b->head[0] - row * pool) * pool + b->head[1] - col * pool;
        self->pooled[count++] =
            (pooled_beam){map->pooled + (size_t)phase * size, floor_div(col, 64), row, (uint64_t)(col & 63)};
    }
    return count;
}

/* Bound the ranks of all units at one heading. */
static void bound_heading(worker *self, int32_t heading)
{
    search *s = self->shared;
    const search_job *job = s->job;
    int32_t *bounds = s->bounds + (size_t)heading * (size_t)s->units;
    s->with->draw_heading(job, heading, s->stride, self->beams);
    const int32_t count = job->by_blocks ? pool_beams(self) : 0;
    for (int32_t unit = 0; unit < s->units; unit++) {
        const int32_t *tile = s->tiles[unit];
        if (!job->by_blocks) {
            const int some = open_window(job, tile[0], tile[1], &self->at) && allowed_misses(s) >= 0 &&
                             s->with->count_ends(job, self->beams, &self->at, allowed_misses(s));
            bounds[unit] = some ? job->reading_count - keep_best(&self->at) : -1;
            continue;
        }
        uint64_t where[8], *counter = s->counters + ((size_t)heading * (size_t)s->units + (size_t)unit) * (size_t)(job->bits * 8);
        s->with->bound_tile(job, self->pooled, count, tile, counter);
        greatest_of(counter, job->bits, &bounds[unit], where);
        bounds[unit] += job->reading_count - count;
    }
}

static int32_t misses_of_heading(const search *s)
{
    int32_t misses = 0;
    for (int32_t i = 0; i < s->job->reading_count; i++)
        misses += s->job->readings[5 * (size_t)i + 4] > 0.0;
    return misses;
}

/* Look at the windows of a unit that can hold an answer. */
static void search_unit(worker *self, int32_t heading, int32_t unit)
{
    search *s = self->shared;
    const search_job *job = s->job;
    const int32_t *tile = s->tiles[unit], pool = job->map->pool, each = WINDOW / pool;
    if (!job->by_blocks) {
        search_window(self, heading, tile[0], tile[1]);
        return;
    }
    uint64_t mask[8];
    const uint64_t *counter = s->counters + ((size_t)heading * (size_t)s->units + (size_t)unit) * (size_t)(job->bits * 8);
    reach(counter, job->bits, __atomic_load_n(&s->least, __ATOMIC_RELAXED) - misses_of_heading(s), mask);
    for (int32_t i = 0; i < 8; i += each) {
        uint64_t any = each == 2 ? mask[i] | mask[i + 1] : mask[i];
        any = each == 2 ? (any | any >> 1) & UINT64_C(0x5555555555555555) : any;
        for (; any; any &= any - 1) {
            const int32_t row = (tile[1] + i) * pool, col = (64 * tile[0] + __builtin_ctzll(any)) * pool;
            if (row < job->map->rows && col < job->map->cols)
                search_window(self, heading, row, col);
        }
    }
}

/* The rank of the most promising cell of a unit: some rank that is reached, so that answers must come near it. */
static void try_unit(worker *self, int32_t heading, int32_t unit)
{
    search *s = self->shared;
    const search_job *job = s->job;
    int32_t place[2] = {s->tiles[unit][0], s->tiles[unit][1]}, value;
    s->with->draw_heading(job, heading, s->stride, self->beams);
    if (job->by_blocks) {
        uint64_t where[8];
        int i = 0;
        greatest_of(s->counters + ((size_t)heading * (size_t)s->units + (size_t)unit) * (size_t)(job->bits * 8), job->bits,
                    &value, where);
        while (where[i] == 0)
            i++;
        const int32_t row = (place[1] + i) * job->map->pool;
        place[1] = (64 * place[0] + __builtin_ctzll(where[i])) * job->map->pool / WINDOW * WINDOW;
        place[0] = row / WINDOW * WINDOW;
    }
    if (place[0] >= job->map->rows || place[1] >= job->map->cols || allowed_misses(s) < 0 ||
        !open_window(job, place[0], place[1], &self->at) ||
        !s->with->count_ends(job, self->beams, &self->at, allowed_misses(s)))
        return;
    keep_best(&self->at);
    if (s->with->count_bodies(job, self->beams, &self->at)) {
        for (int32_t row = 0; row < WINDOW; row++)
            if (self->at.alive[row])
                found_rank(s, job->reading_count - misses_at(&self->at, row, __builtin_ctz(self->at.alive[row])));
    }
}

static void *work(void *argument)
{
    worker *self = argument;
    search *s = self->shared;
    for (;;) {
        const int32_t next = __atomic_fetch_add(&s->next, 1, __ATOMIC_RELAXED);
        if (next >= s->job->heading_count)
            return NULL;
        if (s->bounding) {
            bound_heading(self, next);
            continue;
        }
        const int32_t heading = s->order[next];
        int drawn = 0;
        for (int32_t unit = 0; unit < s->units; unit++) {
            if (s->bounds[(size_t)heading * (size_t)s->units + (size_t)unit] < __atomic_load_n(&s->least, __ATOMIC_RELAXED))
                continue;
            if (!drawn)
                s->with->draw_heading(s->job, heading, s->stride, self->beams);
            drawn = 1;
            search_unit(self, heading, unit);
        }
    }
}

static void share(search *s, worker *workers, int bounding)
{
    pthread_t handles[THREADS_MAX];
    int32_t started = 1;
    s->next = 0;
    s->bounding = bounding;
    while (started < s->job->threads && started < THREADS_MAX &&
           pthread_create(&handles[started], NULL, work, &workers[started]) == 0)
        started++;
    work(&workers[0]);
    for (int32_t i = 1; i < started; i++)
        pthread_join(handles[i], NULL);
}

/* Look at the best bounds first; sort the headings by theirs. */
static void seed(search *s, worker *first)
{
    const int32_t headings = s->job->heading_count;
    int32_t tried[SEEDS], count = 0;
    for (; count < SEEDS; count++) {
        int32_t best = -1;
        for (int32_t i = 0; i < headings * s->units; i++) {
            int again = 0;
            for (int32_t j = 0; j < count; j++)
                again |= tried[j] == i;
            if (!again && (best < 0 || s->bounds[i] > s->bounds[best]))
                best = i;
        }
        if (best < 0 || s->bounds[best] < s->least)
            break;
        tried[count] = best;
        try_unit(first, best / s->units, best % s->units);
    }
    for (int32_t heading = 0; heading < headings; heading++)
        s->order[heading] = heading;
}

/* About 0.618 of the readings, and nothing in common with their number. */
static int32_t stride_of(int32_t count)
{
    for (int32_t stride = (int32_t)(0.618 * count); stride > 1; stride--) {
        int32_t a = stride, b = count;
        while (b) {
            const int32_t rest = a % b;
            a = b;
            b = rest;
        }
        if (a == 1)
            return stride;
    }
    return 1;
}

int32_t search_poses(search_job *job)
{
    const kernel *with = kernel_of(job->instructions);
    if (with == NULL)
        return 0;
    search s = {.job = job, .with = with, .stride = stride_of(job->reading_count)};
    worker workers[THREADS_MAX];
    uint64_t *scratch = job->scratch;
    s.tiles = (int32_t(*)[2])scratch;
    scratch += units_of(job);
    place_units(&s);
    s.bounds = (int32_t *)scratch;
    s.order = s.bounds + (size_t)job->heading_count * (size_t)s.units;
    scratch += ((size_t)job->heading_count * (size_t)s.units + (size_t)job->heading_count) / 2 + 1;
    for (int32_t i = 0; i < THREADS_MAX; i++) {
        workers[i].shared = &s;
        workers[i].beams = (beam *)scratch;
        workers[i].pooled = (pooled_beam *)(workers[i].beams + job->reading_count);
        workers[i].at.maybe = (window *)(workers[i].pooled + job->reading_count);
        scratch += worker_words(job);
    }
    s.counters = scratch;
    pthread_mutex_init(&s.lock, NULL);
    job->best_rank = job->pose_count = 0;
    s.least = larger(1, job->least_rank - job->slack);
    share(&s, workers, 1);
    seed(&s, workers);
    share(&s, workers, 0);
    compact(&s);
    if (job->best_rank < job->least_rank) {
        job->best_rank = job->pose_count = 0;
        s.least = larger(1, job->least_rank - job->slack);
    }
    job->least = s.least;
    pthread_mutex_destroy(&s.lock);
    return 1;
}
