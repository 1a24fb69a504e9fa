/* Rounding without a call, for the sources; not read by cffi. All for numbers less than 2^51 either way. */
#ifndef ROBOTD_ROUNDING_H
#define ROBOTD_ROUNDING_H

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

static inline double least_of(double a, double b)
{
    return a < b ? a : b;
}

static inline double greatest_of(double a, double b)
{
    return a > b ? a : b;
}

#endif
