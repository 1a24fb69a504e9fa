/* Counting feasible poses: what Python calls. No allocation: every buffer comes from the caller.
 *
 * The headers are also read by cffi, which knows no preprocessor: declarations only. packed_map.py and
 * draw_kernel.py describe the arrays.
 *
 * A map is packed into words of 64 cells of one row; bit b of word w is column 64 w + b. Words of one column of words
 * lie next to each other, row after row, so that a vector holds the same word of successive rows and any shift of the
 * map is two loads and one funnel shift. Round the map lie two columns of words and 32 rows on every side that are all
 * ones or all zeros, as what is outside: no branch asks. A tile is 32 rows of one column of words. Counters are
 * bit-sliced.
 */

typedef struct {
    const uint64_t *planes;    /* [5][words + 4][rows + 64], one after the other: */
    const uint64_t *free;      /* where the robot may stand */
    const uint64_t *blocking;  /* what stops a beam */
    const uint64_t *grown;     /* what ends a beam, grown by the error radius */
    const uint64_t *stopping;  /* OR of 32 rows of blocking from each on: columns in which a beam can stop */
    const uint64_t *ending;    /* the same of grown: columns in which a beam can end */
    int32_t blocked_by;        /* how many blocking cells block a body, 1 or 2 */
    int32_t words;             /* columns of words in the map */
    int32_t rows;              /* rows of the map, rounded up to whole tiles */
    const int32_t *tiles;      /* [tile_count][2]: column of words, first row */
    int32_t tile_count;
    const int32_t *drawn;      /* the beams, part by part (draw_kernel.py): */
    const int32_t *chains;     /* [][3]: (row, col) offset, and the slot that keeps what is free up to here, or -1 */
    const int32_t *groups;     /* [group_count + 1]: first cell of each chain */
    const int32_t *batches;    /* [batch_count + 1]: first group of each batch */
    int32_t batch_count;
    const int32_t *lists;      /* [batch_count * headings + 1]: first beam of each batch and heading */
    const int32_t *beams;      /* [][3]: slot of the body, (row, col) of the head, NO_HEAD for a miss */
    int32_t slots;
    int32_t headings;
    int32_t bits;              /* planes of a counter, at least 3 */
    uint64_t *counters;        /* [tile_count][headings][bits][32] */
    uint64_t *spare;           /* [threads][(slots + 3) * 32 + 2 * slots], for the kernel's own use */
} count_job;

/* Count every beam at every cell from which it is feasible, or take it back.
 * `instructions` is -1 for the best set of this processor, else 0 portable, 1 AVX2, 2 AVX-512. Returns 0, having done
 * nothing, if the processor does not have it. */
int32_t count_feasible(count_job *job, int32_t subtract, int32_t threads, int32_t instructions);

/* Which instructions the counting uses on this processor. */
const char *instruction_set(void);

/* The greatest count in [n][bits][32]. */
uint32_t greatest(const uint64_t *counters, int64_t n, int32_t bits);

/* Set the bits of the counts that reach `least` in masks[headings][rows][words]. */
void at_least(const uint64_t *counters, const int32_t *tiles, int32_t tile_count, int32_t headings, int32_t bits,
              uint32_t least, int32_t rows, int32_t words, uint64_t *masks);
