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

/* Arrays begin at cache lines: a vector of 64 bytes that lies across two of them costs two loads. */
#define LINE_WORDS 8

static inline arena arena_in(uint64_t *buffer)
{
    const size_t past = (uintptr_t)buffer / sizeof *buffer % LINE_WORDS;
    return (arena){buffer == NULL ? NULL : buffer + (LINE_WORDS - past) % LINE_WORDS, 0};
}

/* How large the buffer must be, wherever it may begin. */
static inline int64_t arena_words(const arena *from)
{
    return (int64_t)from->used + LINE_WORDS - 1;
}

static inline void *take_bytes(arena *from, size_t bytes)
{
    const size_t lines = (bytes + LINE_WORDS * sizeof *from->buffer - 1) / (LINE_WORDS * sizeof *from->buffer);
    void *taken = from->buffer == NULL ? NULL : from->buffer + from->used;
    from->used += lines * LINE_WORDS;
    return taken;
}

/* An array of this many of what a pointer points to. */
#define TAKE(from, pointer, count) ((pointer) = take_bytes(from, (size_t)(count) * sizeof *(pointer)))

#endif
