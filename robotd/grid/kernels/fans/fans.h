/* Counting poses that cannot be excluded (localization/conservative/conservative_poses.py): what Python calls.
 *
 * A fan is all beams that the error bounds allow, as windows of cells on successive lines of the grid (grid/fans.py).
 */

enum { WINDOW_CELLS_MAX = 32 };

typedef struct {
    const uint64_t *free;     /* [words + 4][rows + 64]: where the robot may be */
    const uint64_t *blocking; /* the same: what surely stops a beam */
    uint64_t *const *grown;   /* [radii], the same: what may end one, grown by each radius */
    int32_t words;            /* columns of words in the map */
    int32_t rows;             /* rows of the map, rounded up to whole tiles */
    const int32_t *tiles;     /* [tile_count][2]: column of words, first row */
    int32_t tile_count;
    const int32_t *lines;     /* [fan_count][7]: axis, way, first line, least and greatest step aside, first window, at home */
    const int32_t *windows;   /* [][2]: first and last cell aside, at most WINDOW_CELLS_MAX of them */
    const int32_t *lists;     /* [fan_count + 1]: first beam of each fan */
    int32_t fan_count;
    const int32_t *beams;     /* [][5]: lines crossed, ascending in a fan; heading; radius or -1; (row, col) of the head */
    int32_t headings;
    int32_t bits;             /* planes of a counter */
    uint64_t *counters;       /* [tile_count][headings][bits][32] */
} fan_job;

/* Count every beam at every cell whose fan lets a path through and whose head may be an obstacle, or take it back. */
void count_fans(const fan_job *job, int32_t subtract, int32_t threads);
