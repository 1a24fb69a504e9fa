/* Beams drawn on the grid, and put into groups that share a chain of cells. drawing.py does the same in NumPy.
 *
 * The rules of ray.py and probe.py, rounded as they are (the build forbids contraction; sines and cosines come from
 * NumPy). Directions that are nearly the same are tried as one group; it is one only if its least and its greatest step
 * give the same chain, since floor(0.5 + k * step) never falls as the step grows. Otherwise its beams are put into groups
 * of exactly equal steps.
 */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "draw.h"

#define FAR_CELLS 268435456.0
#define DIRECTIONS 1073741824.0
#define TURN 6.283185307179586

typedef struct {
    double step[2];
    int64_t start[2];
    int64_t direction;
    int32_t length;
    int32_t head[2];
} beam;

static inline double nearest(double cells)
{
    const double bounded = cells < -FAR_CELLS ? -FAR_CELLS : cells > FAR_CELLS ? FAR_CELLS : cells;
    return floor(bounded + 0.5);
}

static inline beam draw(const draw_job *job, int32_t reading, int32_t heading)
{
    const size_t headings = (size_t)job->heading_count, number = (size_t)reading * headings + (size_t)heading;
    const double *r = job->readings + 5 * (size_t)reading, *h = job->headings + heading;
    const double ahead[2] = {job->ahead[number], job->ahead[(size_t)job->reading_count * headings + number]};
    const double row = (h[headings] * r[2] + h[2 * headings] * r[3]) / job->resolution_m;
    const double col = (h[2 * headings] * r[2] - h[headings] * r[3]) / job->resolution_m;
    const double range_cells = r[1] / job->resolution_m;
    const double dominant = fmax(fabs(ahead[0]), fabs(ahead[1]));
    const double free_cells = fmax(fmin(range_cells - job->error_radius_cells, job->reach_cells), 0.0);
    beam b;
    b.step[0] = ahead[0] / dominant;
    b.step[1] = ahead[1] / dominant;
    b.start[0] = (int64_t)nearest(row);
    b.start[1] = (int64_t)nearest(col);
    b.direction = (int64_t)rint((h[0] + r[0]) * (DIRECTIONS / TURN)) & ((int64_t)DIRECTIONS - 1);
    b.length = (int32_t)fmax(ceil(free_cells * dominant), 1.0) + (b.start[0] != 0 || b.start[1] != 0);
    const int is_miss = r[4] > 0.0;
    b.head[0] = is_miss ? NO_HEAD : (int32_t)nearest(row + range_cells * ahead[0]);
    b.head[1] = is_miss ? NO_HEAD : (int32_t)nearest(col + range_cells * ahead[1]);
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
    uint64_t hash = 0;
    for (int i = 0; i < 5; i++)
        hash = mixed(hash, key[i]);
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
        memcpy(steps, b->step, sizeof b->step);
        memcpy(steps + 2, b->step, sizeof b->step);
    }
    for (int axis = 0; axis < 2; axis++) {
        steps[axis] = b->step[axis] < steps[axis] ? b->step[axis] : steps[axis];
        steps[axis + 2] = b->step[axis] > steps[axis + 2] ? b->step[axis] : steps[axis + 2];
    }
    job->sizes[group] = b->length > job->sizes[group] ? b->length : job->sizes[group];
}

static int is_one_chain(const draw_job *job, int32_t group)
{
    const double *s = job->steps + 4 * (size_t)group;
    if (s[0] == s[2] && s[1] == s[3])
        return 1;
    for (int32_t k = 0; k < job->sizes[group]; k++)
        if (floor(0.5 + k * s[0]) != floor(0.5 + k * s[2]) || floor(0.5 + k * s[1]) != floor(0.5 + k * s[3]))
            return 0;
    return 1;
}

static void share_out(draw_job *job)
{
    const size_t beams = (size_t)job->reading_count * (size_t)job->heading_count;
    job->keys = job->spare;
    job->steps = (double *)(job->spare + 10 * beams);
    job->sizes = (int32_t *)(job->spare + 18 * beams);
    job->drawn = job->sizes + 2 * beams;
    job->table = job->drawn + 4 * beams;
}

void draw_groups(draw_job *job)
{
    int32_t count = 0;
    share_out(job);
    memset(job->table, 0xff, (size_t)job->table_size * sizeof *job->table);
    int32_t *drawn = job->drawn;
    for (int32_t reading = 0; reading < job->reading_count; reading++)
        for (int32_t heading = 0; heading < job->heading_count; heading++, drawn += 4) {
            const beam b = draw(job, reading, heading);
            const int64_t key[5] = {b.direction, 0, b.start[0], b.start[1], 0};
            drawn[0] = group_of(job, key, &count);
            drawn[1] = b.length;
            drawn[2] = b.head[0];
            drawn[3] = b.head[1];
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
            int64_t key[5] = {0, 0, b.start[0], b.start[1], 1};
            memcpy(key, b.step, sizeof b.step);
            drawn[0] = group_of(job, key, &count);
            join(job, drawn[0], &b);
        }
    job->group_count = count;
    job->cell_count = job->longest = 0;
    for (int32_t group = 0; group < count; group++) {
        job->cell_count += job->sizes[group];
        job->longest = job->sizes[group] > job->longest ? job->sizes[group] : job->longest;
    }
}

static void chain(const draw_job *job, int32_t group, int32_t *cells)
{
    const double *steps = job->steps + 4 * (size_t)group;
    const int64_t *start = job->keys + 5 * (size_t)group + 2;
    const int32_t lead = start[0] != 0 || start[1] != 0;
    for (int32_t i = 0; i < job->sizes[group]; i++) {
        cells[3 * i] = i < lead ? 0 : (int32_t)(start[0] + (int64_t)floor(0.5 + (i - lead) * steps[0]));
        cells[3 * i + 1] = i < lead ? 0 : (int32_t)(start[1] + (int64_t)floor(0.5 + (i - lead) * steps[1]));
        cells[3 * i + 2] = -1;
    }
}

int32_t draw_chains(const draw_job *job, int32_t slots, int32_t *chains, int32_t *groups, int32_t *batches,
                    int32_t *batch_of, int32_t *lists, int32_t *beams)
{
    const int32_t beam_count = job->reading_count * job->heading_count, group_count = job->group_count;
    groups[0] = 0;
    for (int32_t group = 0; group < group_count; group++) {
        groups[group + 1] = groups[group] + job->sizes[group];
        chain(job, group, chains + 3 * (size_t)groups[group]);
    }
    for (int32_t i = 0; i < beam_count; i++)
        chains[3 * (size_t)(groups[job->drawn[4 * i]] + job->drawn[4 * i + 1] - 1) + 2] = 0;
    int32_t batch = 0, used = 0;
    batches[0] = 0;
    for (int32_t group = 0; group < group_count; group++) {
        int32_t wanted = 0;
        for (int32_t cell = groups[group]; cell < groups[group + 1]; cell++)
            wanted += chains[3 * (size_t)cell + 2] == 0;
        if (used + wanted > slots) {
            batches[++batch] = group;
            used = 0;
        }
        for (int32_t cell = groups[group]; cell < groups[group + 1]; cell++)
            if (chains[3 * (size_t)cell + 2] == 0)
                chains[3 * (size_t)cell + 2] = used++;
        batch_of[group] = batch;
    }
    batches[++batch] = group_count;
    const size_t list_count = (size_t)batch * (size_t)job->heading_count;
    memset(lists, 0, (list_count + 1) * sizeof *lists);
    for (int32_t i = 0; i < beam_count; i++)
        lists[(size_t)batch_of[job->drawn[4 * i]] * (size_t)job->heading_count + (size_t)(i % job->heading_count)]++;
    int32_t total = 0;
    for (size_t i = 0; i <= list_count; i++) {
        total += lists[i];
        lists[i] = total;
    }
    for (int32_t i = beam_count - 1; i >= 0; i--) { /* from the end: then every list's bound arrives at its beginning */
        const int32_t *d = job->drawn + 4 * (size_t)i;
        const size_t list = (size_t)batch_of[d[0]] * (size_t)job->heading_count + (size_t)(i % job->heading_count);
        int32_t *b = beams + 3 * (size_t)--lists[list];
        b[0] = chains[3 * (size_t)(groups[d[0]] + d[1] - 1) + 2];
        b[1] = d[2];
        b[2] = d[3];
    }
    return batch;
}
