/* Work shared out among threads. */
#ifndef ROBOTD_THREADS_H
#define ROBOTD_THREADS_H

#include <pthread.h>
#include <stdint.h>

#include "shared/shared.h"

/* Threads that stay from one piece of work to the next, since to start one takes as long as a small piece does. */
typedef struct {
    void (*task)(void *shared, int32_t number);
    void *shared;
    pthread_mutex_t lock;
    pthread_cond_t begun, left;
    int32_t piece;   /* how many there were so far */
    int32_t is_open; /* whether the last of them may still be joined */
    int32_t is_over; /* whether no other comes */
    int32_t joined;  /* how many are at it, but for the caller */
    int32_t started;
    pthread_t handles[THREADS_MAX];
    int32_t taken; /* of the numbers from 1, one for each that was started */
} crew;

/* Begin with this many threads, at most THREADS_MAX, the caller's own being one. The tasks take what is to be done one by
 * one, so that a thread that could not be started, or comes late, is no harm. */
void crew_begin(crew *c, void (*task)(void *shared, int32_t number), void *shared, int32_t threads);

/* Call the task from all threads at once, each with its number, and wait for those that came. */
void crew_work(crew *c);

/* End the threads. */
void crew_end(crew *c);

/* All three, for a single piece of work. */
void share_among_threads(void (*task)(void *shared, int32_t number), void *shared, int32_t threads);

/* The next of this many pieces of work, or -1 if all are taken. */
static inline int32_t take_one(int32_t *next, int32_t count)
{
    const int32_t one = __atomic_fetch_add(next, 1, __ATOMIC_RELAXED);
    return one < count ? one : -1;
}

#endif
