/* Beams on a map of chances: how likely is it that a beam ended where it did?
 *
 * Nothing but sums, products and quotients, one by one and in the order of the twin, so that the results are NumPy's
 * to the last bit (the build forbids contraction).
 */
#include "weigh/weigh.h"

#include "cast/cast.h"
#include "draw/reading_on_grid.h"

static const double ASIDE[3] = {-1.4142135623730951, 0.0, 1.4142135623730951}; /* in spreads across the beam */
static const double SHARE[3] = {0.25, 0.5, 0.25};
static const double PEAK = 0.36755259694786135; /* of Student's t with three degrees of freedom */
static const double FAR = 8.0;                  /* in spreads along the beam: from here on nothing matters */
static const double STOPPED = 0.02;             /* a beam of which no more than this is left is stopped */

typedef struct {
    const uint8_t *cells, *skips;
    int32_t rows, cols;
    const double *stops;
} chance_map;

typedef struct {
    double row_step, col_step, pace; /* from one sample to the next */
    double range, spread, end;
    int64_t last; /* the sample that is nearest to the range */
    int is_miss;
    double faded[SKIP_MAX + 1]; /* what is left of a beam after this many unknown cells */
} ray;

static inline double density(double off, double spread)
{
    const double t = off / spread, tail = 1.0 + t * t / 3.0;
    return PEAK / (tail * tail * spread);
}

/* Follow one ray; obstacles side by side are one obstacle, as likely to be there as its likeliest cell. */
static void follow(const chance_map *map, const ray *r, double start_row, double start_col, double share,
                   double *chances)
{
    double left = 1.0, through = 1.0;
    for (int64_t k = 0;;) {
        const double way = (double)k * r->pace;
        if (way > r->end || left < STOPPED)
            break;
        const double row = start_row + (double)k * r->row_step, col = start_col + (double)k * r->col_step;
        int value = UNKNOWN, skip = 1;
        if (row >= 0.0 && col >= 0.0 && row < (double)map->rows && col < (double)map->cols) {
            const int64_t at_row = (int32_t)row, at_col = (int32_t)col;
            value = map->cells[at_row * map->cols + at_col];
            skip = map->skips[at_row * map->cols + at_col];
        }
        const double stop = map->stops[value];
        const int ends_here = !r->is_miss && r->last >= k && r->last < k + skip;
        if (value < UNKNOWN) {
            if (ends_here)
                chances[IN_VACANT] += share * left * stop;
            through = 1.0;
        } else if (value == UNKNOWN) {
            if (ends_here)
                chances[IN_UNKNOWN] += share * (left * r->faded[r->last - k]) * stop;
            left *= r->faded[skip];
        } else if (1.0 - stop < through) {
            const double newly = 1.0 - (1.0 - stop) / through;
            through = 1.0 - stop;
            if (!r->is_miss)
                chances[AS_MAPPED] += share * left * newly * density(r->range - way, r->spread);
            left *= 1.0 - newly;
        }
        k += skip;
    }
    if (r->is_miss)
        chances[AS_MAPPED] += share * left;
}

void weigh_beams(const uint8_t *cells, const uint8_t *skips, int32_t rows, int32_t cols, const double *stops,
                 const double *poses, int32_t pose_count, const double *beams, int32_t beam_count, double *chances)
{
    const chance_map map = {cells, skips, rows, cols, stops};
    for (int32_t i = 0; i < pose_count; i++) {
        const double *pose = poses + 4 * i, cos = pose[2], sin = pose[3];
        for (int32_t j = 0; j < beam_count; j++, chances += CLASSES) {
            const double *beam = beams + 8 * j;
            const double row_way = sin * beam[2] + cos * beam[3], col_way = cos * beam[2] - sin * beam[3];
            const direction way = direction_of(row_way, col_way);
            const int is_miss = beam[7] > 0.0;
            const double pace = 1.0 / way.dominant;
            ray r = {way.step[0],
                     way.step[1],
                     pace,
                     beam[4],
                     beam[5],
                     is_miss ? beam[4] : beam[4] + FAR * beam[5],
                     (int64_t)(beam[4] / pace + 0.5),
                     is_miss,
                     {1.0}};
            for (int i = 1; i <= SKIP_MAX; i++)
                r.faded[i] = r.faded[i - 1] * (1.0 - stops[UNKNOWN] * pace);
            const double row = pose[0] + (sin * beam[0] + cos * beam[1]);
            const double col = pose[1] + (cos * beam[0] - sin * beam[1]);
            chances[AS_MAPPED] = chances[IN_UNKNOWN] = chances[IN_VACANT] = 0.0;
            for (int side = 0; side < 3; side++) {
                const double aside = ASIDE[side] * beam[6];
                follow(&map, &r, row + aside * col_way, col - aside * row_way, SHARE[side], chances);
            }
        }
    }
}
