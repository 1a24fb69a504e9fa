/* Cells of a byte each made into bits. */
#ifndef ROBOTD_BITS_H
#define ROBOTD_BITS_H

#include <stdint.h>
#include <string.h>

/* Eight bytes of 0 or 1 as eight bits, the first one lowest. */
static inline uint64_t eight_cells(const uint8_t *cells)
{
    uint64_t eight;
    memcpy(&eight, cells, 8);
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    eight = __builtin_bswap64(eight);
#endif
    return eight * UINT64_C(0x0102040810204080) >> 56; /* no two partial products meet in one bit */
}

static inline uint64_t whole_word(const uint8_t *cells)
{
    uint64_t bits = 0;
    for (int i = 0; i < 8; i++)
        bits |= eight_cells(cells + 8 * i) << 8 * i;
    return bits;
}

#endif
