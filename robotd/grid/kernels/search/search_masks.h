/* Bit-sliced counters of the blocks of one tile, and masks of blocks: eight rows of 64. Included by search.c. */
#include <stdint.h>
#include <string.h>

/* The greatest count among some blocks; of these, those that have it are left. */
static int32_t greatest_of(const uint64_t *counter, int32_t bits, uint64_t *where)
{
    int32_t value = 0;
    for (int32_t bit = bits - 1; bit >= 0; bit--) {
        uint64_t any = 0;
        for (int i = 0; i < 8; i++)
            any |= where[i] & counter[8 * bit + i];
        if (any == 0)
            continue;
        value |= 1 << bit;
        for (int i = 0; i < 8; i++)
            where[i] &= counter[8 * bit + i];
    }
    return value;
}

/* The blocks of a tile that reach a count. */
static void reach(const uint64_t *counter, int32_t bits, int32_t least, uint64_t *mask)
{
    uint64_t equal[8];
    memset(equal, 0xff, sizeof equal);
    memset(mask, least < 0 ? 0xff : 0, sizeof equal);
    for (int32_t bit = bits - 1; bit >= 0; bit--) {
        const uint64_t wanted = (least >> bit) & 1 ? ~(uint64_t)0 : 0;
        for (int i = 0; i < 8; i++) {
            mask[i] |= equal[i] & counter[8 * bit + i] & ~wanted;
            equal[i] &= ~(counter[8 * bit + i] ^ wanted);
        }
    }
    for (int i = 0; i < 8; i++)
        mask[i] |= equal[i];
}

/* Which columns of a row of blocks have one in them that is set, for blocks this many times as large. */
static uint64_t joined(uint64_t row, int32_t times)
{
    static const uint64_t firsts[] = {~UINT64_C(0), UINT64_C(0x5555555555555555), UINT64_C(0x1111111111111111),
                                      UINT64_C(0x0101010101010101)};
    for (int32_t step = 1; step < times; step *= 2)
        row |= row >> step;
    return row & firsts[__builtin_ctz((uint32_t)times)];
}

/* Half a row of blocks, each of them twice, for a grid that is twice as fine. */
static uint64_t doubled(uint64_t row, int right)
{
    uint64_t word = row >> (32 * right) & UINT64_C(0xffffffff);
    word = (word | word << 16) & UINT64_C(0x0000ffff0000ffff);
    word = (word | word << 8) & UINT64_C(0x00ff00ff00ff00ff);
    word = (word | word << 4) & UINT64_C(0x0f0f0f0f0f0f0f0f);
    word = (word | word << 2) & UINT64_C(0x3333333333333333);
    word = (word | word << 1) & UINT64_C(0x5555555555555555);
    return word | word << 1;
}

/* The windows of a tile in which a block is hopeful, row by row; returns how many. */
static int32_t windows_of(const uint64_t *hopeful, int32_t times, uint64_t *windows)
{
    int32_t count = 0;
    for (int32_t i = 0; i < 8; i += times) {
        windows[i] = hopeful[i];
        for (int32_t j = 1; j < times; j++)
            windows[i] |= hopeful[i + j];
        windows[i] = joined(windows[i], times);
        count += __builtin_popcountll(windows[i]);
    }
    return count;
}
