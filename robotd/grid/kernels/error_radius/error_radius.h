/* The smallest error radius of every cell (localization/reference/smallest_error.py): what Python calls. */

typedef struct {
    const uint64_t *free;      /* [words + 4][rows + 64]: where the robot may stand */
    const uint64_t *blocking;  /* the same: what stops a beam */
    int32_t blocked_by;        /* how many blocking cells block a body, 1 or 2 */
    int32_t words;             /* columns of words in the map */
    int32_t rows;              /* rows of the map, rounded up to whole tiles */
    const int32_t *tiles;      /* [tile_count][2]: column of words, first row */
    int32_t tile_count;
    int32_t origin_row;        /* where the map's first cell lies */
    int32_t origin_col;
    int32_t map_rows;
    int32_t map_cols;
    const uint16_t *distances; /* [map_rows][map_cols]: what an end there needs */
    uint16_t outside;          /* what an end outside needs */
    const int32_t *chains;     /* [][2]: (row, col) of the cells of bodies */
    const uint16_t *lengths;   /* for each of these cells: what a body needs that is stopped there */
    const int32_t *readings;   /* [reading_count][4]: first cell of the body and end, (row, col) of the head or NO_HEAD */
    int32_t reading_count;
    int32_t wanted;            /* how many readings must be feasible, at least 1 */
    uint16_t *needed;          /* [threads][reading_count][2048], for the kernel's own use */
    uint16_t *errors;          /* [map_rows][map_cols]: written for free cells alone */
} errors_job;

/* Find, for every free cell, the smallest error with which so many readings are feasible; 65535 if none is. */
void share_errors(const errors_job *job, int32_t threads);
