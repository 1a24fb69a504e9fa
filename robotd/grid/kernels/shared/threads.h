/* Work shared out among threads. */
#ifndef ROBOTD_THREADS_H
#define ROBOTD_THREADS_H

#include <stdint.h>

#include "shared/shared.h"

/* Call a task from this many threads at once, at most THREADS_MAX, each with its number, and wait for all. The tasks take
 * what is to be done one by one, so that a thread that could not be started is no harm. */
void share_among_threads(void (*task)(void *shared, int32_t number), void *shared, int32_t threads);

/* The next of this many pieces of work, or -1 if all are taken. */
static inline int32_t take_one(int32_t *next, int32_t count)
{
    const int32_t one = __atomic_fetch_add(next, 1, __ATOMIC_RELAXED);
    return one < count ? one : -1;
}

#endif
