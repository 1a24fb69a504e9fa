/* Whole numbers: rounding without a call, for numbers less than 2^51 either way, and bounds. */
#ifndef ROBOTD_NUMBERS_H
#define ROBOTD_NUMBERS_H

#include <stdint.h>

static inline int64_t floor_of(double value)
{
    const int64_t cut = (int64_t)value;
    return cut - ((double)cut > value);
}

static inline int64_t ceiling_of(double value)
{
    const int64_t cut = (int64_t)value;
    return cut + ((double)cut < value);
}

/* To the nearest, ties to even. */
static inline int64_t nearest_of(double value)
{
    const double large = 6755399441055744.0; /* 1.5 * 2^52: what is added to it loses its fraction */
    return (int64_t)(value + large - large);
}

/* Floor, of what fits. */
static inline int32_t whole(double value)
{
    const int32_t cut = (int32_t)value;
    return cut - (value < cut);
}

static inline int32_t smaller(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

static inline int32_t larger(int32_t a, int32_t b)
{
    return a > b ? a : b;
}

static inline int32_t clamp(int32_t value, int32_t low, int32_t high)
{
    return value < low ? low : value > high ? high : value;
}

#endif
