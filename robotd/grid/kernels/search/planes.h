/* What the search keeps of a map: what Python calls. search_kernel.py describes the arrays; no allocation here.
 *
 * Cells: bitmaps in columns of 16 cells, `cells[2 + levels][strips + 4][strip_rows]`: word w + 2 of row r + 16 holds columns
 * 16 w to 16 w + 15, so that a window of 16 x 16 cells anywhere is two loads of 16 rows and a shift. Around the map lie
 * what is outside. Pooled: for each key and each phase of a grid of blocks of pool x pool cells, a bit for each block,
 * `pooled[keys][pool * pool][words + 2][block_rows]`, and two columns more for each key. Near: the Chebyshev distance of
 * each cell to the nearest that blocks, `near[rows][cols]`, at most 63.
 */
#ifndef ROBOTD_SEARCH_PLANES_H
#define ROBOTD_SEARCH_PLANES_H

#include <stdint.h>

typedef struct {
    int32_t rows, cols; /* of the map */
    int32_t levels;     /* how many error radii there are */
    int32_t keys;       /* of pooled planes: those of the first level, and one of each other */
    int32_t sectors;    /* how many directions of approach are told apart on the first level, and one for all */
    int32_t outside_blocks, outside_ends, blocked_by;
    const uint8_t *free, *blocking; /* [rows][cols] */
    const uint8_t *grown;           /* [levels][rows][cols] */
    const int8_t *key_of;           /* [33][33], on the first level: the key of a body that ends at an offset from its
                                     * head, 0 if it has none */
    uint16_t *cells;
    uint64_t *pooled;
    uint8_t *near;
} search_map;

/* How many cells of `cells` and words of `pooled`, and how many words of scratch to fill them. */
int64_t search_cells_size(const search_map *map);
int64_t search_pooled_size(const search_map *map);
int64_t search_planes_scratch_words(const search_map *map);

/* Make everything that depends on the cells of a window. */
void search_prepare(const search_map *map, int32_t row_first, int32_t row_last, int32_t col_first, int32_t col_last,
                    uint64_t *scratch);

#endif
