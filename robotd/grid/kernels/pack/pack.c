/* 64 cells a word, words of one column together: packed_map.py says how. */
#include "pack/pack.h"

#include <stddef.h>

#include "shared/bits.h"

void pack_cells(const uint8_t *mask, int32_t cols, const int32_t *window, int32_t top, int32_t left, int32_t stride,
                uint64_t *words)
{
    for (int32_t word = (left + window[2]) / 64; word <= (left + window[3] - 1) / 64; word++) {
        const int32_t first = 64 * word - left; /* the column of bit 0 */
        for (int32_t row = window[0]; row < window[1]; row++) {
            const uint8_t *line = mask + (size_t)row * (size_t)cols;
            uint64_t *at = words + (size_t)word * (size_t)stride + (size_t)(top + row);
            if (first >= 0 && first + 64 <= cols) {
                *at = whole_word(line + first);
                continue;
            }
            for (int32_t bit = first < 0 ? -first : 0; bit < 64 && first + bit < cols; bit++)
                *at = (*at & ~((uint64_t)1 << bit)) | (uint64_t)line[first + bit] << bit;
        }
    }
}
