/* The most probable poses by bounds that hold: blocks of cells first, then their cells, then the bodies of the beams.
 *
 * A pose is an answer if it misses few enough readings, so everything here counts misses and stops where there are too
 * many. (1) Per heading, the heads of all beams are looked up in the pooled planes: no cell of a block explains more
 * readings than the block. (2) The most promising blocks give a first best rank. (3) In the blocks that can still hold
 * an answer, heads and ends of bodies are counted cell by cell, 256 at a time; (4) for the cells that are left, the
 * bodies are walked. Whatever the order, what is returned depends on the ranks alone.
 */
#include "search/search.h"

#include <string.h>

#include "search/search_masks.h"
#include "search/search_units.h"
#include "shared/arena.h"

#define HOPES 64 /* this many bounds at a time are made finer, and the windows tried that they lead to */
#define STEPS 12
#define FEW_WINDOWS 1 /* as many windows are looked at sooner than the blocks in them are bounded */

static int32_t key_of(const search_map *map, const beam *b)
{
    const int32_t ring = 2 * RING + 1;
    int8_t keys[2];
    if (b->level > 0)
        return key_of_level(map, b->level);
    if (b->at.cells < map->blocked_by)
        return 0;
    for (int which = 0; which < 2; which++) {
        const int32_t *end = which == 0 || map->blocked_by == 1 ? b->last : b->before;
        const int32_t row = end[0] - b->at.head[0] + RING, col = end[1] - b->at.head[1] + RING;
        keys[which] = row >= 0 && row < ring && col >= 0 && col < ring ? map->key_of[row * ring + col] : 0;
    }
    return keys[0] == keys[1] ? keys[0] : 0;
}

/* Put the heads of the hits on a grid of blocks, unless they are there; coarser grids come first. */
static void pool_beams(worker *self, int which)
{
    const search_job *job = self->shared->job;
    const int32_t pool = pools[which];
    if (which < self->drawn)
        return;
    self->drawn = which + 1;
    self->hits = 0;
    for (int32_t i = 0; i < job->reading_count; i++) {
        const beam *b = self->beams + i;
        if (b->is_miss)
            continue;
        const int32_t row = floor_div(b->at.head[0], pool), col = floor_div(b->at.head[1], pool);
        self->pooled[which][self->hits++] = (pooled_beam){
            pooled_phase(job->map, pool, key_of(job->map, b), b->at.head[0] - row * pool, b->at.head[1] - col * pool),
            floor_div(col, 64), row, (uint64_t)(col & 63)};
    }
}

static int64_t looked_at(const worker *self)
{
    return self->work + self->at.work;
}

static void draw(worker *self, int32_t heading)
{
    const search *s = self->shared;
    s->with->draw_heading(s->job, heading, self->beams);
    self->drawn = 0;
}

static uint64_t *counter_of(const search *s, int32_t heading, int32_t unit)
{
    return s->counters + ((size_t)heading * (size_t)s->units + (size_t)unit) * (size_t)(s->job->bits * 8);
}

/* Bound the ranks of the blocks of a tile. */
static void bound_tile(worker *self, int which, const int32_t *tile, uint64_t *counter)
{
    const search *s = self->shared;
    pool_beams(self, which);
    self->work += self->hits;
    s->with->bound_tile(&s->grids[which], self->pooled[which], self->hits, tile, s->job->bits, counter);
}

/* Bound the ranks of all units at one heading. */
static void bound_heading(worker *self, int32_t heading)
{
    search *s = self->shared;
    uint64_t where[8];
    draw(self, heading);
    for (int32_t unit = 0; unit < s->units; unit++) {
        uint64_t *counter = counter_of(s, heading, unit);
        bound_tile(self, 0, s->tiles[unit], counter);
        memcpy(where, s->open[unit], sizeof where);
        s->bounds[(size_t)heading * (size_t)s->units + (size_t)unit] =
            greatest_of(counter, s->job->bits, where) + s->misses;
    }
}

/* Look at the windows of a tile that can hold an answer, after bounding the finer blocks in those that are hopeful. */
static void search_tile(worker *self, int32_t heading, int which, const int32_t *tile, const uint64_t *hopeful)
{
    const search *s = self->shared;
    const int32_t pool = pools[which], times = WINDOW / pool, bits = s->job->bits;
    uint64_t windows[8], finer[8], counter[8 * BITS_MAX];
    if (windows_of(hopeful, times, windows) > FEW_WINDOWS && which + 1 < POOLS) {
        for (int quarter = 0; quarter < 4; quarter++) {
            const int right = quarter & 1, low = quarter >> 1;
            const int32_t part[2] = {2 * tile[0] + right, 2 * tile[1] + 8 * low};
            uint64_t any = 0;
            for (int i = 0; i < 4; i++)
                any |= hopeful[4 * low + i] >> (32 * right) & UINT64_C(0xffffffff);
            if (any == 0)
                continue;
            bound_tile(self, which + 1, part, counter);
            reach(counter, bits, s->asked - s->misses, finer);
            for (int i = 0; i < 8; i++)
                finer[i] &= doubled(hopeful[4 * low + i / 2], right);
            search_tile(self, heading, which + 1, part, finer);
        }
        return;
    }
    for (int32_t i = 0; i < 8; i += times)
        for (; windows[i]; windows[i] &= windows[i] - 1)
            search_window(self, heading, (tile[1] + i) * pool, (64 * tile[0] + __builtin_ctzll(windows[i])) * pool);
}

/* Look at the windows of a unit that can hold an answer. */
static void search_unit(worker *self, int32_t heading, int32_t unit)
{
    const search *s = self->shared;
    const int32_t *tile = s->tiles[unit];
    uint64_t hopeful[8];
    if (!s->job->by_blocks) {
        search_window(self, heading, tile[0], tile[1]);
        return;
    }
    reach(counter_of(s, heading, unit), s->job->bits, s->asked - s->misses, hopeful);
    for (int i = 0; i < 8; i++)
        hopeful[i] &= s->open[unit][i];
    search_tile(self, heading, 0, tile, hopeful);
}

/* Go from a unit to the smallest block in it that seems best; returns its bound, and the window that holds it. */
static int32_t descend(worker *self, int32_t heading, int32_t unit, int32_t *place)
{
    const search *s = self->shared;
    int32_t part[2] = {s->tiles[unit][0], s->tiles[unit][1]}, bound = 0;
    uint64_t where[8], counter[8 * BITS_MAX];
    memcpy(counter, counter_of(s, heading, unit), (size_t)(8 * s->job->bits) * sizeof *counter);
    for (int which = 0; which < POOLS; which++) {
        int32_t row = 0;
        if (which > 0)
            bound_tile(self, which, part, counter);
        if (which == 0)
            memcpy(where, s->open[unit], sizeof where);
        else
            memset(where, 0xff, sizeof where);
        bound = greatest_of(counter, s->job->bits, where);
        while (where[row] == 0)
            row++;
        place[0] = (part[1] + row) * pools[which] / WINDOW * WINDOW;
        place[1] = (64 * part[0] + __builtin_ctzll(where[row])) * pools[which] / WINDOW * WINDOW;
        part[0] = (64 * part[0] + __builtin_ctzll(where[row])) / 32;
        part[1] = (part[1] + row) / 4 * 8;
    }
    return bound + s->misses;
}

/* Whether a unit can hold an answer at a heading. */
static int may_hold(const search *s, int32_t heading, int32_t unit)
{
    return !s->job->by_blocks || s->bounds[(size_t)heading * (size_t)s->units + (size_t)unit] >= s->asked;
}

/* Search the units of a heading that can hold an answer, as far as its share of the budget goes: one at least. */
static void search_heading(worker *self, place_in_search *at)
{
    search *s = self->shared;
    const int64_t before = looked_at(self);
    int drawn = 0;
    for (; at->unit < s->units; at->unit++) {
        if (!may_hold(s, at->heading, at->unit))
            continue;
        if (looked_at(self) - before > s->share)
            return;
        if (!drawn)
            draw(self, at->heading);
        drawn = 1;
        search_unit(self, at->heading, at->unit);
    }
}

/* Make the bound of a hope finer. */
static void make_finer(worker *self, hope *h)
{
    draw(self, h->heading);
    h->bound = descend(self, h->heading, h->unit, h->place);
}

static void work(void *shared, int32_t number)
{
    search *s = shared;
    worker *self = &s->workers[number];
    for (int32_t next; (next = take_one(&s->next, s->taken)) >= 0;)
        if (s->phase == BOUNDING)
            bound_heading(self, next);
        else if (s->phase == HOPING)
            make_finer(self, &s->some[next]);
        else
            search_heading(self, &s->together[next]);
}

/* Share what was taken among the threads. */
static void share(search *s, int32_t taken)
{
    s->next = 0;
    s->taken = taken;
    crew_work(&s->threads);
    s->work = 0;
    for (int32_t i = 0; i < THREADS_MAX; i++)
        s->work += looked_at(&s->workers[i]);
}

/* From now on answers must come near what was found. */
static void look_up(search *s)
{
    s->asked = s->least;
    s->reached = s->job->best_rank;
}

/* Take the next headings that can hold an answer, after those whose share was too small. Returns how many. */
static int32_t take_some(search *s, int32_t *next)
{
    int32_t taken = 0;
    for (int32_t i = 0; i < s->taken; i++)
        if (s->together[i].unit < s->units)
            s->together[taken++] = s->together[i];
    for (; taken < TOGETHER && *next < s->ordered; ++*next) {
        int32_t unit = 0;
        while (unit < s->units && !may_hold(s, s->order[*next], unit))
            unit++;
        if (unit < s->units)
            s->together[taken++] = (place_in_search){s->order[*next], unit};
    }
    return taken;
}

/* Search the headings that can hold an answer, some at a time, until this much of the budget is spent. */
static void search_all(search *s, int64_t budget)
{
    int32_t next = 0, taken;
    s->taken = 0;
    for (look_up(s); (taken = take_some(s, &next)) > 0; look_up(s)) {
        s->share = (budget - s->work) / taken;
        if (s->share <= 0) {
            s->job->is_complete = 0;
            return;
        }
        share(s, taken);
        if (s->job->pose_count > s->job->limit)
            compact(s);
    }
}

/* The best first; equal ones stay in their order. */
static void sort_best(hope *hopes, int32_t count)
{
    for (int32_t i = 0; i < count; i++) {
        int32_t first = i;
        for (int32_t j = i + 1; j < count; j++)
            first = hopes[j].bound > hopes[first].bound ? j : first;
        const hope chosen = hopes[first];
        memmove(hopes + i + 1, hopes + i, (size_t)(first - i) * sizeof *hopes);
        hopes[i] = chosen;
    }
}

/* The best of all bounds, at most one for each heading, the best first. */
static int32_t hopes_of(const search *s, hope *hopes)
{
    int32_t count = 0;
    for (int32_t heading = 0; heading < s->job->heading_count; heading++) {
        hope best = {-1, heading, 0, {0, 0}};
        for (int32_t unit = 0; unit < s->units; unit++) {
            const int32_t bound = s->bounds[(size_t)heading * (size_t)s->units + (size_t)unit];
            if (bound > best.bound)
                best = (hope){bound, heading, unit, {s->tiles[unit][0], s->tiles[unit][1]}};
        }
        if (best.bound >= s->least)
            hopes[count++] = best;
    }
    sort_best(hopes, count);
    return count;
}

/* Try the window that a hope leads to: a better rank than was seen so far may be reached there. */
static void try_hope(search *s, worker *first, const hope *h)
{
    look_up(s);
    s->asked = larger(s->least, s->job->best_rank + 1);
    if (h->place[0] >= s->job->map->rows || h->place[1] >= s->job->map->cols || allowed_misses(s) < 0 ||
        !open_window(s->job, h->place[0], h->place[1], &first->at))
        return;
    draw(first, h->heading);
    if (s->with->count_ends(s->job, first->beams, &first->at, allowed_misses(s)))
        try_best(first);
}

/* Make some bounds finer, and try the best of them. */
static void try_some(search *s, worker *first, hope *hopes, int32_t count)
{
    s->phase = HOPING;
    s->some = hopes;
    share(s, count);
    sort_best(hopes, count);
    for (int32_t i = 0; i < count && hopes[i].bound > s->job->best_rank && hopes[i].bound >= s->least; i++)
        try_hope(s, first, hopes + i);
}

/* How far down the rank that is asked for goes at a time. */
static int32_t step_of(const search_job *job)
{
    return larger(1, job->reading_count / STEPS);
}

/* Look at the best bounds first: some rank is reached there. Where it is far from the bounds they tell little, and are
 * alike at most headings: then others are tried as well. Returns the best bound of all. */
static int32_t seed(search *s, worker *first)
{
    const int32_t all = hopes_of(s, s->hopes), best = all ? s->hopes[0].bound : 0;
    for (int32_t i = 0; i < all; i++)
        s->order[i] = s->hopes[i].heading;
    s->ordered = all;
    for (int32_t i = 0; i < all && best - s->job->best_rank > step_of(s->job); i += HOPES)
        try_some(s, first, s->hopes + i, clamp(all - i, 0, HOPES));
    return best;
}

/* All headings, those in the middle first: where only a few are asked for, one of these is the likeliest. */
static void from_the_middle(search *s)
{
    const int32_t count = s->job->heading_count;
    for (int32_t i = 0; i < count; i++)
        s->order[i] = count / 2 + (i % 2 ? -(i + 1) / 2 : i / 2);
    s->ordered = count;
}

/* Find the best rank, if it may be far from what was seen: ask for high ranks first, then for lower ones, since that is
 * much faster than asking for all that lie above a low one. */
static void rank(search *s, int32_t bound)
{
    search_job *job = s->job;
    const int32_t step = step_of(job);
    const int32_t low = larger(job->least_rank, larger(1, job->best_rank + 1));
    s->phase = RANKING;
    for (int32_t least = larger(bound - step, low);; least = larger(least - step, low)) {
        if (job->best_rank >= job->least_rank && least <= job->best_rank + step / 2)
            return;
        s->least = least;
        search_all(s, job->budget / 2);
        if (job->best_rank >= least || least == low)
            return;
    }
}

/* Take all that a search keeps from an arena. */
static void share_scratch(search *s, const search_job *job, arena *from)
{
    const size_t units = (size_t)units_of(job), headings = (size_t)job->heading_count;
    const size_t readings = (size_t)job->reading_count;
    TAKE(from, s->tiles, units);
    TAKE(from, s->open, job->by_blocks ? units : 0);
    TAKE(from, s->bounds, headings * units);
    TAKE(from, s->order, headings);
    TAKE(from, s->hopes, headings);
    for (int32_t i = 0; i < clamp(job->threads, 1, THREADS_MAX); i++) {
        worker *w = &s->workers[i];
        TAKE(from, w->beams, readings);
        for (int which = 0; which < POOLS; which++)
            TAKE(from, w->pooled[which], readings);
        TAKE(from, w->at.maybe, readings);
    }
    TAKE(from, s->counters, job->by_blocks ? headings * units * (size_t)job->bits * 8 : 0);
}

int64_t search_scratch_words(const search_job *job)
{
    search none;
    arena sizes = arena_in(NULL);
    share_scratch(&none, job, &sizes);
    return arena_words(&sizes);
}

/* Begin with nothing found. */
static void begin(search *s, search_job *job)
{
    arena scratch = arena_in(job->scratch);
    s->job = job;
    for (int i = 0; i < POOLS; i++)
        s->grids[i] = (grid){pools[i], block_words(job->map, pools[i]), block_rows(job->map, pools[i]),
                             pooled_stride(job->map, pools[i])};
    for (int32_t i = 0; i < job->reading_count; i++)
        s->misses += job->readings[4 * (size_t)i + 3] > 0.0;
    share_scratch(s, job, &scratch);
    for (int32_t i = 0; i < THREADS_MAX; i++)
        s->workers[i].shared = s;
    place_units(s);
    job->best_rank = job->pose_count = 0;
    job->is_complete = 1;
    s->least = s->asked = larger(1, job->least_rank - job->slack);
}

int32_t search_poses(search_job *job)
{
    search s = {.with = kernel_of(job->instructions)};
    if (s.with == NULL)
        return 0;
    begin(&s, job);
    pthread_mutex_init(&s.lock, NULL);
    crew_begin(&s.threads, work, &s, job->threads);
    if (job->by_blocks) {
        s.phase = BOUNDING;
        share(&s, job->heading_count);
        rank(&s, seed(&s, &s.workers[0]));
    } else
        from_the_middle(&s);
    s.phase = COLLECTING;
    s.least = larger(1, larger(job->least_rank, job->best_rank) - job->slack);
    if (!job->by_blocks || job->best_rank >= job->least_rank) {
        job->is_complete = 1; /* whatever was left out before: all that comes near is looked at now */
        search_all(&s, job->budget);
        compact(&s);
    }
    if (job->best_rank < job->least_rank) {
        job->best_rank = job->pose_count = 0;
        s.least = larger(1, job->least_rank - job->slack);
    }
    job->least = s.least;
    crew_end(&s.threads);
    pthread_mutex_destroy(&s.lock);
    return 1;
}
