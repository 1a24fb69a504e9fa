/* One buffer that arrays are taken from, one after the other. Nothing is ever allocated here: the caller brings the
 * buffer, and learns how large it must be from an arena that has none, from which the same arrays are taken. */
#ifndef ROBOTD_ARENA_H
#define ROBOTD_ARENA_H

#include <stddef.h>
#include <stdint.h>

typedef struct {
    uint64_t *buffer; /* NULL: only the size is wanted */
    size_t used;      /* words */
} arena;

static inline void *take_bytes(arena *from, size_t bytes)
{
    void *taken = from->buffer == NULL ? NULL : from->buffer + from->used;
    from->used += (bytes + 7) / 8;
    return taken;
}

/* An array of this many of what a pointer points to. */
#define TAKE(from, pointer, count) ((pointer) = take_bytes(from, (size_t)(count) * sizeof *(pointer)))

#endif
