/* Work shared out among threads. */
#include "shared/threads.h"

#include <stddef.h>

/* Join each piece of work that is still open, until no other comes. */
static void *serve(void *argument)
{
    crew *c = argument;
    pthread_mutex_lock(&c->lock);
    const int32_t number = ++c->taken;
    for (int32_t last = 0; !c->is_over;) {
        if (!c->is_open || c->piece == last) {
            pthread_cond_wait(&c->begun, &c->lock);
            continue;
        }
        last = c->piece;
        c->joined++;
        pthread_mutex_unlock(&c->lock);
        c->task(c->shared, number);
        pthread_mutex_lock(&c->lock);
        if (--c->joined == 0)
            pthread_cond_signal(&c->left);
    }
    pthread_mutex_unlock(&c->lock);
    return NULL;
}

void crew_begin(crew *c, void (*task)(void *shared, int32_t number), void *shared, int32_t threads)
{
    c->task = task;
    c->shared = shared;
    c->piece = c->is_open = c->is_over = c->joined = c->started = c->taken = 0;
    pthread_mutex_init(&c->lock, NULL);
    pthread_cond_init(&c->begun, NULL);
    pthread_cond_init(&c->left, NULL);
    while (c->started + 1 < threads && c->started + 1 < THREADS_MAX)
        if (pthread_create(&c->handles[c->started++], NULL, serve, c) != 0) {
            c->started--;
            break;
        }
}

void crew_work(crew *c)
{
    pthread_mutex_lock(&c->lock);
    c->piece++;
    c->is_open = 1;
    pthread_cond_broadcast(&c->begun);
    pthread_mutex_unlock(&c->lock);
    c->task(c->shared, 0);
    pthread_mutex_lock(&c->lock);
    /* Who has not come by now finds nothing left to do, and is not waited for: on a busy machine that may be long. */
    c->is_open = 0;
    while (c->joined > 0)
        pthread_cond_wait(&c->left, &c->lock);
    pthread_mutex_unlock(&c->lock);
}

void crew_end(crew *c)
{
    pthread_mutex_lock(&c->lock);
    c->is_over = 1;
    pthread_cond_broadcast(&c->begun);
    pthread_mutex_unlock(&c->lock);
    for (int32_t i = 0; i < c->started; i++)
        pthread_join(c->handles[i], NULL);
    pthread_cond_destroy(&c->left);
    pthread_cond_destroy(&c->begun);
    pthread_mutex_destroy(&c->lock);
}

void share_among_threads(void (*task)(void *shared, int32_t number), void *shared, int32_t threads)
{
    crew c;
    crew_begin(&c, task, shared, threads);
    crew_work(&c);
    crew_end(&c);
}
