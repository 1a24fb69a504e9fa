/* The hot loops of robotd/grid/kernels: what Python calls. No allocation: every buffer comes from the caller.
 *
 * This file is also read by cffi, which knows no preprocessor: declarations only. layout.py describes the arrays.
 *
 * A map is packed into words of 64 cells of one row; bit b of word w is column 64 w + b. Words of one column of words
 * lie next to each other, row after row, so that a vector holds the same word of successive rows and any shift of the
 * map is two loads and one funnel shift. Round the map lie two columns of words and 32 rows of ones on every side:
 * whatever is outside is occupied, without a branch. A tile is 32 rows of one column of words. Counters are bit-sliced.
 */

typedef struct {
    const uint64_t *occupied;  /* [words + 4][rows + 64] */
    const uint64_t *grown;     /* the same, grown by the error radius */
    int32_t words;             /* columns of words in the map */
    int32_t rows;              /* rows of the map, rounded up to whole tiles */
    const int32_t *tiles;      /* [tile_count][2]: column of words, first row */
    int32_t tile_count;
    const int32_t *chains;     /* [][3]: (row, col) offset, and the slot that keeps what is free up to here, or -1 */
    const int32_t *groups;     /* [group_count + 1]: first cell of each chain */
    const int32_t *batches;    /* [batch_count + 1]: first group of each batch */
    int32_t batch_count;
    const int32_t *lists;      /* [batch_count * headings + 1]: first beam of each batch and heading */
    const int32_t *beams;      /* [][3]: slot of the body, (row, col) of the head */
    int32_t slots;
    int32_t headings;
    int32_t bits;              /* planes of a counter, at least 3 */
    uint64_t *counters;        /* [tile_count][headings][bits][32] */
    uint64_t *kept;            /* [threads][slots + 1][32], for the kernel's own use */
} count_job;

/* Count every beam at every cell from which it is feasible, or take it back.
 * `instructions` is -1 for the best set of this processor, else 0 portable, 1 AVX2, 2 AVX-512. Returns 0, having done
 * nothing, if the processor does not have it. */
int32_t count_feasible(const count_job *job, int32_t subtract, int32_t threads, int32_t instructions);

/* Which instructions the counting uses on this processor. */
const char *instruction_set(void);

/* The greatest count in [n][bits][32]. */
uint32_t greatest(const uint64_t *counters, int64_t n, int32_t bits);

/* Set the bits of the counts that reach `least` in masks[headings][rows][words]. */
void at_least(const uint64_t *counters, const int32_t *tiles, int32_t tile_count, int32_t headings, int32_t bits,
              uint32_t least, int32_t rows, int32_t words, uint64_t *masks);

typedef struct {
    const double *readings;    /* [reading_count][5]: bearing, range [m], (x, y) of the beam's start [m], is a miss */
    const double *headings;    /* [heading_count][3]: angle, its sine and cosine */
    const double *ahead;       /* [reading_count * heading_count][2]: sine and cosine of each beam's bearing in the map */
    int32_t reading_count;
    int32_t heading_count;
    double resolution_m;
    double error_radius_cells;
    double reach_cells;
    int32_t *table;            /* [table_size], a power of two, more than twice the beams */
    int32_t table_size;
    int64_t *keys;             /* [2 * beams][5], of groups */
    double *steps;             /* [2 * beams][4]: least and greatest (row, col) step of each group */
    int32_t *sizes;            /* [2 * beams]: cells of each group's chain */
    int32_t *drawn;            /* [beams][4]: group, length, (row, col) of the head */
} draw_job;

/* Draw the beams and put those of one direction and start into groups: returns their number, at most 2 * beams. */
int32_t draw_groups(const draw_job *job);

/* Draw the chains, and list the beams by batch and heading. Returns the number of batches; `slots` is at least the
 * greatest size, and no batch has more of them. */
int32_t draw_chains(const draw_job *job, int32_t group_count, int32_t slots, int32_t *chains, int32_t *groups,
                    int32_t *batches, int32_t *batch_of, int32_t *lists, int32_t *beams);

/* Lower the cells that beams run through and raise those they end in (occupancy.py), and put the cells whose value
 * changed into `changed`, ascending. Returns how many. `before` is scratch, as large as `cells`. */
int64_t insert_beams(uint8_t *cells, int32_t rows, int32_t cols, const double *beams, const int64_t *hits, int32_t count,
                     const uint8_t *lower, const uint8_t *raise, int32_t all_at_once, uint8_t *before, int64_t *changed);
