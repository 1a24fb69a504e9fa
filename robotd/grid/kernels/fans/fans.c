/* Counting poses that cannot be excluded: per tile and fan, the paths of cells that may be free, line by line. */
#include "fans/fans.h"

#include <stddef.h>
#include <string.h>

#include "shared/packed.h"
#include "shared/threads.h"

/* One line of a fan: where paths end, for every cell of the window; and what is open, for one cell more on either side. */
typedef struct {
    int32_t first, last;
    uint64_t paths[WINDOW_CELLS_MAX][TILE];
    uint64_t open[WINDOW_CELLS_MAX + 2][TILE];
} line;

typedef struct {
    const fan_job *job;
    const int32_t *tile;
    uint64_t *counters; /* of the tile */
} place;

/* What is open on a line, `along` lines and from `first` - 1 to `last` + 1 cells aside of the robot's own. */
static void look(const place *at, const int32_t *fan, int32_t along, int32_t first, int32_t last, line *to)
{
    const fan_job *job = at->job;
    const size_t stride = column_of(&job->map);
    to->first = first;
    to->last = last;
    for (int32_t aside = first - 1; aside <= last + 1; aside++) {
        const int32_t row = fan[0] == 0 ? along : aside, col = fan[0] == 0 ? aside : along, shift = col & 63;
        const uint64_t *blocking = words_at(&job->map, job->map.blocking, at->tile, row, col);
        uint64_t *open = to->open[aside - first + 1];
        for (int i = 0; i < TILE; i++)
            open[i] = ~funnel(blocking[i], blocking[stride + i], shift);
    }
}

/* Lead the paths that end in one cell on to one of the next line. A path that steps sideways leaves the cell by its side or by
 * its front: one of these two neighbours is open. */
static void step(const line *from, const line *to, int32_t before, int32_t aside, uint64_t *path)
{
    const uint64_t *old = from->paths[before - from->first], *front = to->open[before - to->first + 1];
    const uint64_t *side = from->open[before - from->first + 1 + (aside > before ? 1 : -1)];
    const int front_known = before >= to->first - 1 && before <= to->last + 1;
    if (aside == before || !front_known)
        for (int i = 0; i < TILE; i++)
            path[i] |= old[i];
    else
        for (int i = 0; i < TILE; i++)
            path[i] |= old[i] & (side[i] | front[i]);
}

/* Lead all paths on to a line, from the one before by steps between two bounds; from nowhere, they begin there. */
static void advance(const line *from, line *to, int32_t least, int32_t greatest)
{
    for (int32_t aside = to->first; aside <= to->last; aside++) {
        uint64_t *path = to->paths[aside - to->first];
        memset(path, from == NULL ? 0xff : 0, TILE * sizeof *path);
        if (from != NULL) {
            const int32_t low = aside - greatest > from->first ? aside - greatest : from->first;
            const int32_t high = aside - least < from->last ? aside - least : from->last;
            for (int32_t before = low; before <= high; before++)
                step(from, to, before, aside, path);
        }
        for (int i = 0; i < TILE; i++)
            path[i] &= to->open[aside - to->first + 1][i];
    }
}

/* Keep the cells from which a path leads to the line; returns whether there are any. */
static int keep(const line *to, uint64_t *passed)
{
    uint64_t any = 0;
    for (int i = 0; i < TILE; i++) {
        uint64_t ends = 0;
        for (int32_t aside = 0; aside <= to->last - to->first; aside++)
            ends |= to->paths[aside][i];
        passed[i] &= ends;
        any |= passed[i];
    }
    return any != 0;
}

static void count(const place *at, const int32_t *beam, const uint64_t *passed)
{
    const fan_job *job = at->job;
    uint64_t carry[TILE], any = 0;
    memcpy(carry, passed, sizeof carry);
    if (beam[2] >= 0) {
        const uint64_t *head = words_at(&job->map, job->grown[beam[2]], at->tile, beam[3], beam[4]);
        const size_t stride = column_of(&job->map);
        const int32_t shift = beam[4] & 63;
        for (int i = 0; i < TILE; i++)
            carry[i] &= funnel(head[i], head[stride + i], shift);
    }
    for (int i = 0; i < TILE; i++)
        any |= carry[i];
    const uint64_t flip = job->subtract ? ~(uint64_t)0 : 0;
    uint64_t *counter = at->counters + (size_t)beam[1] * (size_t)job->bits * TILE;
    for (int32_t bit = 0; bit < job->bits && any != 0; bit++, counter += TILE) {
        any = 0;
        for (int i = 0; i < TILE; i++) {
            const uint64_t old = counter[i];
            counter[i] = old ^ carry[i];
            carry[i] &= old ^ flip;
            any |= carry[i];
        }
    }
}

static void count_fan(const place *at, int32_t number)
{
    const fan_job *job = at->job;
    const int32_t *fan = job->lines + 7 * (size_t)number, end = job->lists[number + 1];
    line lines[2];
    uint64_t passed[TILE];
    memcpy(passed, words_at(&job->map, job->map.free, at->tile, 0, 0), sizeof passed);
    const line *before = NULL;
    if (fan[6]) {
        look(at, fan, 0, 0, 0, &lines[1]);
        advance(NULL, &lines[1], 0, 0);
        before = &lines[1];
    }
    int32_t crossed = 0;
    for (int32_t i = job->lists[number]; i < end; i++) {
        const int32_t *beam = job->beams + 5 * (size_t)i;
        for (; crossed < beam[0]; crossed++) {
            const int32_t *window = job->windows + 2 * (size_t)(fan[5] + crossed);
            line *to = &lines[crossed & 1];
            look(at, fan, fan[1] * (fan[2] + crossed), window[0], window[1], to);
            /* From its own cell the robot reaches all of the first window. */
            advance(before, to, crossed == 0 ? window[0] : fan[3], crossed == 0 ? window[1] : fan[4]);
            before = to;
            if (!keep(to, passed))
                return;
        }
        count(at, beam, passed);
    }
}

/* What the threads share. */
typedef struct {
    const fan_job *job;
    int32_t next; /* tile */
} counting;

static void count_tiles(void *shared, int32_t number)
{
    counting *all = shared;
    const fan_job *job = all->job;
    const size_t size = (size_t)job->headings * (size_t)job->bits * TILE;
    (void)number;
    for (int32_t tile; (tile = take_one(&all->next, job->map.tile_count)) >= 0;) {
        const place at = {job, job->map.tiles + 2 * (size_t)tile, job->counters + (size_t)tile * size};
        for (int32_t fan = 0; fan < job->fan_count; fan++)
            count_fan(&at, fan);
    }
}

void count_fans(fan_job *job)
{
    counting all = {job, 0};
    unfold(&job->map);
    share_among_threads(count_tiles, &all, job->threads);
}
