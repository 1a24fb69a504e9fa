/* The hot loops of robotd/grid/kernels: what Python calls. C99, no allocation: every buffer comes from the caller.
 *
 * This file is also read by cffi, which knows no preprocessor: declarations only.
 *
 * Layout (layout.py says the same in Python). A map is packed into words of 64 cells of one row; bit b of word w is
 * column 64 w + b. Words of one column of words lie next to each other, row after row, so that a vector holds the
 * same word of successive rows and any shift of the map is two loads and one funnel shift. Round the map lie two
 * columns of words and 32 rows of ones on every side, so that nothing outside needs a branch: it is occupied.
 * A tile is 32 rows of one column of words. Counters are bit-sliced: bit p of all 64 counts of a word is one word.
 */

typedef struct {
    const uint64_t *occupied;  /* [words + 4][rows + 64] */
    const uint64_t *grown;     /* the same, grown by the error radius */
    int32_t words;             /* columns of words in the map */
    int32_t rows;              /* rows of the map, rounded up to whole tiles */
    const int32_t *tiles;      /* [tile_count][2]: column of words, first row */
    int32_t tile_count;
    const int32_t *chains;     /* [][2]: (row, col) offsets, the bodies of all groups one after the other */
    const int32_t *groups;     /* [group_count + 1][2]: first offset, first beam of each group */
    int32_t group_count;
    const int32_t *beams;      /* [][4]: heading, length of the body, (row, col) of the head; by group, then by length */
    int32_t headings;
    int32_t bits;              /* planes of a counter, at least 3 */
    uint64_t *counters;        /* [tile_count][headings][bits][32] */
    uint64_t *pending;         /* [threads][headings][7][32], for the kernel's own use */
    int32_t *waiting;          /* [threads][headings], likewise */
} count_job;

/* Count every beam at every cell from which it is feasible, or take it back.
 * `instructions` is -1 for the best set of this processor, else 0 portable, 1 AVX2, 2 AVX-512. Returns 0, having done
 * nothing, if the processor does not have it. */
int32_t count_feasible(const count_job *job, int32_t subtract, int32_t threads, int32_t instructions);

/* The greatest count in [n][bits][32]. */
uint32_t greatest(const uint64_t *counters, int64_t n, int32_t bits);

/* Set the bits of the counts that reach `least` in masks[headings][rows][words]. */
void at_least(const uint64_t *counters, const int32_t *tiles, int32_t tile_count, int32_t headings, int32_t bits,
              uint32_t least, int32_t rows, int32_t words, uint64_t *masks);

/* Lower the cells that beams run through and raise those they end in (occupancy.py), and put the cells whose value
 * changed into `changed`, ascending. Returns how many. `before` is scratch, as large as `cells`. */
int64_t insert_beams(uint8_t *cells, int32_t rows, int32_t cols, const double *beams, const int64_t *hits, int32_t count,
                     const uint8_t *lower, const uint8_t *raise, int32_t all_at_once, uint8_t *before, int64_t *changed);

/* Which instructions the counting uses on this processor. */
const char *instruction_set(void);
