/* Integers as they stand in a payload: little-endian, two's complement, anywhere. */
#ifndef BP_LITTLE_ENDIAN_H
#define BP_LITTLE_ENDIAN_H

#include <stddef.h>
#include <stdint.h>

static inline void bp_put_u8(uint8_t *at, uint8_t value)
{
    at[0] = value;
}

static inline void bp_put_u16(uint8_t *at, uint16_t value)
{
    at[0] = (uint8_t)(value & 0xFFu);
    at[1] = (uint8_t)(value >> 8);
}

static inline void bp_put_u32(uint8_t *at, uint32_t value)
{
    bp_put_u16(at, (uint16_t)(value & 0xFFFFu));
    bp_put_u16(at + 2, (uint16_t)(value >> 16));
}

static inline void bp_put_u64(uint8_t *at, uint64_t value)
{
    bp_put_u32(at, (uint32_t)(value & 0xFFFFFFFFu));
    bp_put_u32(at + 4, (uint32_t)(value >> 32));
}

static inline uint8_t bp_get_u8(const uint8_t *at)
{
    return at[0];
}

static inline uint16_t bp_get_u16(const uint8_t *at)
{
    return (uint16_t)(at[0] | (unsigned)at[1] << 8);
}

static inline uint32_t bp_get_u32(const uint8_t *at)
{
    return bp_get_u16(at) | (uint32_t)bp_get_u16(at + 2) << 16;
}

static inline uint64_t bp_get_u64(const uint8_t *at)
{
    return bp_get_u32(at) | (uint64_t)bp_get_u32(at + 4) << 32;
}

/* C leaves open what becomes of an unsigned value beyond the signed range: so it is never converted. */

static inline int16_t bp_get_i16(const uint8_t *at)
{
    const uint16_t value = bp_get_u16(at);
    return (int16_t)(value <= INT16_MAX ? (int32_t)value : (int32_t)value - 65536);
}

static inline int32_t bp_get_i32(const uint8_t *at)
{
    const uint32_t value = bp_get_u32(at);
    return value <= INT32_MAX ? (int32_t)value : -(int32_t)(UINT32_MAX - value) - 1;
}

static inline void bp_copy(uint8_t *to, const uint8_t *from, size_t size)
{
    for (size_t i = 0; i < size; i++)
        to[i] = from[i];
}

#endif
