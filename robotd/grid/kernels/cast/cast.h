/* Wall fields and beams cast on them: what Python calls. cast_kernel.py describes the codes. */
#ifndef ROBOTD_CAST_H
#define ROBOTD_CAST_H

#include <stdint.h>

enum {
    REACH_CELLS = 8,
    FAR_CODE = REACH_CELLS * REACH_CELLS,
    DEPTH_CELLS = 4,
    SKIP_MAX = 15,
    ENDS = 0,
    BLOCKS = 255
};

/* codes[rows][cols] of walls[rows][cols], 0 or 1; `scratch` has 2 * rows * cols + 2 * (cols + 16) bytes. */
void wall_codes(const uint8_t *walls, int32_t rows, int32_t cols, uint8_t *scratch, int8_t *codes);

/* skips[rows + 2][cols + 2] of cells that end a beam and of others that stop it; `scratch` has as many bytes, and
 * cols + 2 + 30 more. */
void skip_codes(const uint8_t *ends, const uint8_t *blocks, int32_t rows, int32_t cols, uint8_t *scratch,
                uint8_t *skips);

/* How far each of beams[beam_count][4] goes from each of poses[pose_count][4], and the code of what stops it. */
void cast_beams(const uint8_t *skips, int32_t rows, int32_t cols, const double *beams, int32_t beam_count,
                const double *poses, int32_t pose_count, int32_t blocked_by, double *ways, uint8_t *stops);

#endif
