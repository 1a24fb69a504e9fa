/* Beams drawn on the grid, and put into groups that share a chain of cells. draw_twin.py does the same in NumPy.
 *
 * Directions that are nearly the same are tried as one group; it is one only if its least and its greatest step
 * give the same chain, since floor(0.5 + k * step) never falls as the step grows. Otherwise its beams are put into groups
 * of exactly equal steps.
 */
#include "draw/draw.h"

#include <stddef.h>
#include <string.h>

#include "draw/reading_on_grid.h"
#include "shared/arena.h"

#define DIRECTIONS 1073741824.0
#define TURN 6.283185307179586

typedef struct {
    reading_on_grid at;
    int64_t direction;
    int32_t length; /* of its chain, which begins with the robot's own cell */
} beam;

void find_bearings(const draw_job *job)
{
    double *bearing = job->ahead;
    for (int32_t reading = 0; reading < job->reading_count; reading++)
        for (int32_t heading = 0; heading < job->heading_count; heading++)
            *bearing++ = job->readings[5 * (size_t)reading] + job->headings[heading];
}

static inline beam draw(const draw_job *job, int32_t reading, int32_t heading)
{
    const size_t headings = (size_t)job->heading_count, number = (size_t)reading * headings + (size_t)heading;
    const size_t count = (size_t)job->reading_count * headings;
    const double *r = job->readings + 5 * (size_t)reading, *h = job->headings + heading;
    const double *bearing = job->ahead + number, turned_sin = h[headings], turned_cos = h[2 * headings];
    const double row = (turned_sin * r[2] + turned_cos * r[3]) / job->resolution_m;
    const double col = (turned_cos * r[2] - turned_sin * r[3]) / job->resolution_m;
    beam b;
    b.at = draw_reading(row, col, bearing[count], bearing[2 * count], r[1] / job->resolution_m, job->error_radius_cells,
                        job->reach_cells);
    if (r[4] > 0.0)
        b.at.head[0] = b.at.head[1] = NO_HEAD;
    b.direction = nearest_of(*bearing * (DIRECTIONS / TURN)) & ((int64_t)DIRECTIONS - 1);
    b.length = b.at.cells + (b.at.start[0] != 0 || b.at.start[1] != 0);
    return b;
}

static inline uint64_t mixed(uint64_t hash, int64_t value)
{
    hash = (hash ^ (uint64_t)value) * UINT64_C(0x9E3779B97F4A7C15);
    return hash ^ hash >> 29;
}

/* Return the group of a key, a new one if nobody had it before. */
static int32_t group_of(const draw_job *job, const int64_t *key, int32_t *count)
{
    const uint64_t hash = mixed(mixed((uint64_t)key[0], key[1] ^ key[2] * 3), key[3] ^ key[4]);
    for (uint64_t at = hash >> 20;; at++) {
        int32_t *entry = job->table + (at & (uint64_t)(job->table_size - 1));
        if (*entry < 0) {
            *entry = (*count)++;
            memcpy(job->keys + 5 * (size_t)*entry, key, 5 * sizeof *key);
            job->sizes[*entry] = 0;
            return *entry;
        }
        if (memcmp(job->keys + 5 * (size_t)*entry, key, 5 * sizeof *key) == 0)
            return *entry;
    }
}

static void join(const draw_job *job, int32_t group, const beam *b)
{
    double *steps = job->steps + 4 * (size_t)group;
    if (job->sizes[group] == 0) {
        memcpy(steps, b->at.step, sizeof b->at.step);
        memcpy(steps + 2, b->at.step, sizeof b->at.step);
    }
    for (int axis = 0; axis < 2; axis++) {
        steps[axis] = b->at.step[axis] < steps[axis] ? b->at.step[axis] : steps[axis];
        steps[axis + 2] = b->at.step[axis] > steps[axis + 2] ? b->at.step[axis] : steps[axis + 2];
    }
    job->sizes[group] = b->length > job->sizes[group] ? b->length : job->sizes[group];
}

static int is_one_chain(const draw_job *job, int32_t group)
{
    const double *s = job->steps + 4 * (size_t)group;
    if (s[0] == s[2] && s[1] == s[3])
        return 1;
    for (int32_t k = 0; k < job->sizes[group]; k++)
        if (floor_of(0.5 + k * s[0]) != floor_of(0.5 + k * s[2]) ||
            floor_of(0.5 + k * s[1]) != floor_of(0.5 + k * s[3]))
            return 0;
    return 1;
}

static void share_scratch(draw_job *job, arena *from)
{
    const size_t beams = (size_t)job->reading_count * (size_t)job->heading_count;
    job->table_size = 2;
    while ((size_t)job->table_size <= 2 * beams)
        job->table_size *= 2;
    TAKE(from, job->keys, 10 * beams);
    TAKE(from, job->steps, 8 * beams);
    TAKE(from, job->sizes, 2 * beams);
    TAKE(from, job->drawn, 4 * beams);
    TAKE(from, job->batch_of, 2 * beams);
    TAKE(from, job->table, job->table_size);
}

int64_t draw_scratch_words(draw_job *job)
{
    arena sizes = arena_in(NULL);
    share_scratch(job, &sizes);
    return arena_words(&sizes);
}

/* How many numbers the drawing takes at most, now that the groups are known; and how many slots a batch may have. */
static int64_t room_for_chains(draw_job *job)
{
    const int64_t beams = (int64_t)job->reading_count * job->heading_count;
    if (beams <= job->slots)
        job->slots = beams > 1 ? (int32_t)beams : 1;
    else if (job->slots < 2 * job->longest)
        job->slots = 2 * job->longest;
    const int64_t parts = 2 * beams / job->slots + 1, batches = parts < job->group_count ? parts : job->group_count;
    return 3 * (int64_t)job->cell_count + job->group_count + 1 + 3 * beams + batches + 1 +
           batches * job->heading_count + 1;
}

int64_t draw_groups(draw_job *job)
{
    int32_t count = 0;
    arena scratch = arena_in(job->scratch);
    share_scratch(job, &scratch);
    memset(job->table, 0xff, (size_t)job->table_size * sizeof *job->table);
    int32_t *drawn = job->drawn;
    for (int32_t reading = 0; reading < job->reading_count; reading++)
        for (int32_t heading = 0; heading < job->heading_count; heading++, drawn += 4) {
            const beam b = draw(job, reading, heading);
            const int64_t key[5] = {b.direction, 0, b.at.start[0], b.at.start[1], 0};
            drawn[0] = group_of(job, key, &count);
            drawn[1] = b.length;
            drawn[2] = b.at.head[0];
            drawn[3] = b.at.head[1];
            join(job, drawn[0], &b);
        }
    const int32_t tried = count;
    int32_t differ = 0;
    for (int32_t group = 0; group < tried; group++)
        if (!is_one_chain(job, group)) {
            job->sizes[group] = 0;
            differ++;
        }
    drawn = job->drawn;
    for (int32_t reading = 0; differ && reading < job->reading_count; reading++)
        for (int32_t heading = 0; heading < job->heading_count; heading++, drawn += 4) {
            if (job->sizes[drawn[0]] != 0)
                continue;
            const beam b = draw(job, reading, heading);
            int64_t key[5] = {0, 0, b.at.start[0], b.at.start[1], 1};
            memcpy(key, b.at.step, sizeof b.at.step);
            drawn[0] = group_of(job, key, &count);
            join(job, drawn[0], &b);
        }
    job->group_count = count;
    job->cell_count = job->longest = 0;
    for (int32_t group = 0; group < count; group++) {
        job->cell_count += job->sizes[group];
        job->longest = job->sizes[group] > job->longest ? job->sizes[group] : job->longest;
    }
    return room_for_chains(job);
}

static void chain(const draw_job *job, int32_t group, int32_t *cells)
{
    const double *steps = job->steps + 4 * (size_t)group;
    const int64_t *start = job->keys + 5 * (size_t)group + 2;
    const int32_t lead = start[0] != 0 || start[1] != 0;
    for (int32_t i = 0; i < job->sizes[group]; i++) {
        cells[3 * i] = i < lead ? 0 : (int32_t)(start[0] + floor_of(0.5 + (i - lead) * steps[0]));
        cells[3 * i + 1] = i < lead ? 0 : (int32_t)(start[1] + floor_of(0.5 + (i - lead) * steps[1]));
        cells[3 * i + 2] = -1;
    }
}

/* Put groups into batches, and give every end of a body a slot of its batch. Returns the number of batches. */
static int32_t share_slots(const draw_job *job, const int32_t *groups, int32_t *chains, int32_t *batches)
{
    int32_t batch = 0, used = 0;
    batches[0] = 0;
    for (int32_t group = 0; group < job->group_count; group++) {
        int32_t wanted = 0;
        for (int32_t cell = groups[group]; cell < groups[group + 1]; cell++)
            wanted += chains[3 * (size_t)cell + 2] == 0;
        if (used + wanted > job->slots) {
            batches[++batch] = group;
            used = 0;
        }
        for (int32_t cell = groups[group]; cell < groups[group + 1]; cell++)
            if (chains[3 * (size_t)cell + 2] == 0)
                chains[3 * (size_t)cell + 2] = used++;
        job->batch_of[group] = batch;
    }
    batches[++batch] = job->group_count;
    return batch;
}

/* List the beams by batch and heading. */
static void list_beams(const draw_job *job, const int32_t *groups, const int32_t *chains, int32_t batches,
                       int32_t *lists, int32_t *beams)
{
    const int32_t headings = job->heading_count, beam_count = job->reading_count * headings;
    const size_t list_count = (size_t)batches * (size_t)headings;
    memset(lists, 0, (list_count + 1) * sizeof *lists);
    for (int32_t i = 0, heading = 0; i < beam_count; i++, heading = heading + 1 < headings ? heading + 1 : 0)
        lists[(size_t)job->batch_of[job->drawn[4 * (size_t)i]] * (size_t)headings + (size_t)heading]++;
    int32_t total = 0;
    for (size_t i = 0; i <= list_count; i++) {
        total += lists[i];
        lists[i] = total;
    }
    int32_t heading = headings;
    for (int32_t i = beam_count - 1; i >= 0; i--) { /* from the end: then every list's bound arrives at its beginning */
        const int32_t *d = job->drawn + 4 * (size_t)i;
        heading = heading > 0 ? heading - 1 : headings - 1;
        int32_t *b = beams + 3 * (size_t)--lists[(size_t)job->batch_of[d[0]] * (size_t)headings + (size_t)heading];
        b[0] = chains[3 * (size_t)(groups[d[0]] + d[1] - 1) + 2];
        b[1] = d[2];
        b[2] = d[3];
    }
}

void draw_chains(const draw_job *job, int32_t *numbers, drawn_beams *drawn)
{
    const int32_t beam_count = job->reading_count * job->heading_count, group_count = job->group_count;
    int32_t *chains = numbers, *groups = chains + 3 * (size_t)job->cell_count;
    int32_t *beams = groups + group_count + 1, *batches = beams + 3 * (size_t)beam_count;
    groups[0] = 0;
    for (int32_t group = 0; group < group_count; group++) {
        groups[group + 1] = groups[group] + job->sizes[group];
        chain(job, group, chains + 3 * (size_t)groups[group]);
    }
    for (int32_t i = 0; i < beam_count; i++)
        chains[3 * (size_t)(groups[job->drawn[4 * i]] + job->drawn[4 * i + 1] - 1) + 2] = 0;
    const int32_t batch_count = share_slots(job, groups, chains, batches);
    int32_t *lists = batches + batch_count + 1;
    list_beams(job, groups, chains, batch_count, lists, beams);
    *drawn = (drawn_beams){chains,          groups,      beams,      batches,     lists,
                           job->cell_count, group_count, beam_count, batch_count, job->heading_count,
                           job->slots};
}
