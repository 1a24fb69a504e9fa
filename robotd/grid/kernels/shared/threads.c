/* Work shared out among threads. */
#include "shared/threads.h"

#include <pthread.h>
#include <stddef.h>

typedef struct {
    void (*task)(void *, int32_t);
    void *shared;
    int32_t number;
} start;

static void *begin(void *argument)
{
    const start *own = argument;
    own->task(own->shared, own->number);
    return NULL;
}

void share_among_threads(void (*task)(void *shared, int32_t number), void *shared, int32_t threads)
{
    start starts[THREADS_MAX];
    pthread_t handles[THREADS_MAX];
    int32_t started = 1;
    while (started < threads && started < THREADS_MAX) {
        starts[started] = (start){task, shared, started};
        if (pthread_create(&handles[started], NULL, begin, &starts[started]) != 0)
            break;
        started++;
    }
    task(shared, 0);
    for (int32_t i = 1; i < started; i++)
        pthread_join(handles[i], NULL);
}
