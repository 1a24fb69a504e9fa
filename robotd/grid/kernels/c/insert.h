/* A sweep into the occupancy grid: what Python calls. */

/* Lower the cells that beams run through and raise those they end in (occupancy.py), and put the cells whose value
 * changed into `changed`, ascending. Returns how many. `before` is scratch, as large as `cells`. */
int64_t insert_beams(uint8_t *cells, int32_t rows, int32_t cols, const double *beams, const int64_t *hits, int32_t count,
                     const uint8_t *lower, const uint8_t *raise, int32_t all_at_once, uint8_t *before, int64_t *changed);
