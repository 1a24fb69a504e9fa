/* What several kernels take from Python. The headers that Python reads are declarations and constants: cffi knows no
 * preprocessor, and build.py leaves its lines out. */
#ifndef ROBOTD_SHARED_H
#define ROBOTD_SHARED_H

#include <stdint.h>

enum {
    TILE_ROWS = 32,
    WORD_CELLS = 64,
    PAD_WORDS = 2, /* columns of words on either side of a map */
    THREADS_MAX = 16,
    FAR_CELLS = 268435456, /* heads that are farther away count as being so far */
    NO_HEAD = -1073741824  /* in place of a head's row and column: the reading is a miss */
};

/* A map as bitmaps (packed_map.py). */
typedef struct {
    const uint64_t *planes;   /* [5][words + 4][rows + 64], one after the other: */
    const uint64_t *free;     /* where the robot may stand */
    const uint64_t *blocking; /* what stops a beam */
    const uint64_t *grown;    /* what ends a beam, grown by the error radius */
    const uint64_t *stopping; /* OR of 32 rows of blocking from each on: columns in which a beam can stop */
    const uint64_t *ending;   /* the same of grown: columns in which a beam can end */
    int32_t blocked_by;       /* how many blocking cells block a body, 1 or 2 */
    int32_t words;            /* columns of words in the map */
    int32_t rows;             /* rows of the map, rounded up to whole tiles */
    const int32_t *tiles;     /* [tile_count][2]: column of words, first row */
    int32_t tile_count;
} packed_map;

/* Readings drawn at all headings (draw_kernel.py). */
typedef struct {
    int32_t *chains;  /* [cell_count][3]: (row, col) offset, and the slot that keeps what is free up to here, or -1 */
    int32_t *groups;  /* [group_count + 1]: first cell of each chain */
    int32_t *beams;   /* [beam_count][3]: slot of the body, (row, col) of the head, NO_HEAD for a miss */
    int32_t *batches; /* [batch_count + 1]: first group of each batch */
    int32_t *lists;   /* [batch_count * heading_count + 1]: first beam of each batch and heading */
    int32_t cell_count, group_count, beam_count, batch_count, heading_count;
    int32_t slots; /* no batch has more than this many */
} drawn_beams;

/* Sets of instructions that kernels are compiled for, each after those that it outdoes. */
enum {
    PORTABLE,
    AVX2,
    AVX512,
    INSTRUCTION_SETS
};

/* What a set is called. */
const char *instruction_name(int32_t set);

/* The best set of this processor for -1; another, if the processor has it; else -1. */
int32_t instructions_for(int32_t wanted);

#endif
