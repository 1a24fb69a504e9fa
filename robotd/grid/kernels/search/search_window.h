/* What the threads share, and how one of them looks at a window. Included by search.c. */
#include <pthread.h>

#include "search/search_kernels.h"
#include "shared/threads.h"

#define TOGETHER 4 /* headings that are searched before what they reached raises what is asked for */

/* A unit at a heading that seems good, and the window of it that does. */
typedef struct {
    int32_t bound, heading, unit, place[2];
} hope;

/* A heading, and the unit of it that is searched next. */
typedef struct {
    int32_t heading, unit;
} place_in_search;

struct search;

/* What one of them keeps. */
typedef struct {
    struct search *shared;
    beam *beams;                /* [readings] */
    pooled_beam *pooled[POOLS]; /* [readings], of the heads of hits */
    int32_t hits;
    int32_t drawn; /* on how many grids they lie for this heading */
    int64_t work;  /* how many heads in tiles of blocks it looked at so far */
    sheet at;
} worker;

/* All that the threads share. A unit is what is bounded at once: a tile of blocks, or one window. */
typedef struct search {
    search_job *job;
    const kernel *with;
    grid grids[POOLS];
    int32_t units;
    int32_t (*tiles)[2]; /* [units]: column of words and first row of blocks, or row and column of a window */
    uint64_t (*open)[8]; /* [units], if by blocks: which of the blocks have a cell where a pose may be */
    uint64_t *counters;  /* [headings][units][bits][8], if by blocks */
    int32_t *bounds;     /* [headings][units] */
    int32_t *order;      /* [ordered]: the headings that can hold an answer, the best bound first */
    int32_t ordered;
    hope *hopes;                        /* [headings] */
    hope *some;                         /* of them, those that are made finer */
    place_in_search together[TOGETHER]; /* the headings that are searched at a time */
    int32_t next, taken;                /* of these */
    int64_t work;                       /* what all of them have looked at */
    int64_t share;                      /* how much each of these headings may cost */
    enum {
        BOUNDING,
        HOPING,
        RANKING,
        COLLECTING
    } phase;        /* ranking: only the best rank is sought */
    int32_t misses; /* how many readings met nothing */
    int32_t least;  /* what a pose must explain to be returned, as far as is known */
    int32_t asked;  /* what it was before these headings: what is looked at must not depend on which of them is first */
    int32_t reached; /* the best rank, then */
    pthread_mutex_t lock;
    crew threads;
    worker workers[THREADS_MAX];
} search;

static void raise_least(search *s, int32_t least)
{
    s->least = larger(s->least, least);
}

static void found_rank(search *s, int32_t rank)
{
    if (rank <= s->job->best_rank)
        return;
    s->job->best_rank = rank;
    if (s->phase == RANKING)
        raise_least(s, rank + 1);
    else if (rank >= s->job->least_rank)
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
            if (rank < s->least || s->phase == RANKING)
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
    return s->job->reading_count - s->asked;
}

/* Work out the rank of the cell that seems best: some rank that is reached, so that answers must come near it. */
static void try_best(worker *self)
{
    search *s = self->shared;
    const window alive = self->at.alive;
    window misses[BITS_MAX + 1];
    memcpy(misses, self->at.misses, sizeof misses);
    const int32_t seen = keep_best(&self->at);
    if (s->job->reading_count - seen > s->reached && s->with->count_bodies(s->job, self->beams, &self->at)) {
        pthread_mutex_lock(&s->lock);
        found_rank(s, s->job->reading_count - keep_best(&self->at));
        pthread_mutex_unlock(&s->lock);
    }
    self->at.alive = alive;
    memcpy(self->at.misses, misses, sizeof misses);
}

/* Give up the cells that have missed too many by now. */
static int drop(worker *self)
{
    const int32_t allowed = allowed_misses(self->shared);
    int any = 0;
    for (int32_t row = 0; row < WINDOW; row++)
        for (uint32_t left = self->at.alive[row]; left; left &= left - 1) {
            const int32_t col = __builtin_ctz(left);
            if (misses_at(&self->at, row, col) > allowed)
                self->at.alive[row] &= (uint16_t)~(1u << col);
            else
                any = 1;
        }
    return any;
}

/* Look at a window cell by cell. */
static void search_window(worker *self, int32_t heading, int32_t row, int32_t col)
{
    search *s = self->shared;
    const int32_t allowed = allowed_misses(s);
    if (allowed < 0 || row >= s->job->map->rows || col >= s->job->map->cols ||
        !open_window(s->job, row, col, &self->at) || !s->with->count_ends(s->job, self->beams, &self->at, allowed))
        return;
    if (!s->job->by_blocks) {
        try_best(self);
        if (!drop(self))
            return;
    }
    if (s->with->count_bodies(s->job, self->beams, &self->at))
        report(s, heading, &self->at);
}
