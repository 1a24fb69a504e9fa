/* Beams on a map of chances: what Python calls. */
#ifndef ROBOTD_WEIGH_H
#define ROBOTD_WEIGH_H

#include <stdint.h>

enum {
    AS_MAPPED,
    IN_UNKNOWN,
    IN_VACANT,
    CLASSES
};
enum {
    UNKNOWN = 128
};

/* Weigh where each of `beam_count` beams ended, as seen from each of `pose_count` poses (weigh_kernel.py).
 * `skips` say how far to the next cell of another kind, up to 15;
 * `stops[256]` is the chance that a cell of a value stops a beam; `poses[][4]` are row, column, cosine, sine;
 * `beams[][8]` are x and y of the start, cosine and sine of the bearing, the range, its spread along and across the
 * beam, and 1 for a miss, all in cells. `chances[pose_count][beam_count][3]` is filled. */
void weigh_beams(const uint8_t *cells, const uint8_t *skips, int32_t rows, int32_t cols, const double *stops,
                 const double *poses, int32_t pose_count, const double *beams, int32_t beam_count, double *chances);

#endif
