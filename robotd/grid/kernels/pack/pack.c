/* 64 cells a word, words of one column together: packed_map.py says how. */
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "pack/pack.h"

/* Eight bytes of 0 or 1 as eight bits, the first one lowest. */
static inline uint64_t octet(const uint8_t *cells)
{
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    uint64_t eight;
    memcpy(&eight, cells, 8);
    return eight * UINT64_C(0x0102040810204080) >> 56; /* no two partial products meet in one bit */
#else
    uint64_t bits = 0;
    for (int i = 0; i < 8; i++)
        bits |= (uint64_t)cells[i] << i;
    return bits;
#endif
}

static inline uint64_t whole_word(const uint8_t *cells)
{
    uint64_t bits = 0;
    for (int i = 0; i < 8; i++)
        bits |= octet(cells + 8 * i) << 8 * i;
    return bits;
}

void pack_cells(const uint8_t *mask, int32_t cols, const int32_t *window, int32_t top, int32_t left,
                int32_t stride, uint64_t *words)
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
