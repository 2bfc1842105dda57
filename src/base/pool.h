/* A blocking parallel-for on pthreads. The caller works too (worker 0); items are claimed with an atomic counter.
 * Cancelling skips the remaining items; the functions poll pool_cancelled in long items.
 * Results must not depend on which worker ran an item. */
#ifndef GRAY_BASE_POOL_H
#define GRAY_BASE_POOL_H

#include "base/error.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

struct pool;

/* threads: 1..1024 in all, the caller included; 0 = one per online processor. If the system refuses to start some
 * threads, fewer are used and *warning is set to a sentence, else to "". NULL only without memory. */
struct pool *pool_create(int threads, char warning[256]);
void pool_destroy(struct pool *pool);
/* Calls the function with a stack of the size that threads of a pool have: a path may be reflected and refracted a
 * thousand times, solids are nested ten thousand deep, each time a deeper call. If `ulimit -s` does not allow this for
 * the calling thread, the function runs on another thread while the caller waits. False: no such thread could be
 * created, and the function was not called. */
bool pool_call_with_stack(void (*fn)(void *context), void *context, struct error *error);
int pool_workers(const struct pool *pool); /* worker indices are 0 .. pool_workers - 1 */

typedef void pool_function(void *context, uint32_t item, int worker);
/* Runs fn for items 0 .. count-1 and returns when all are done or skipped; false if it was cancelled. A pool of one
 * thread runs them in order. Not reentrant: an item must not call pool_run on the same pool. */
bool pool_run(struct pool *pool, uint32_t count, pool_function *fn, void *context);

/* Async-signal-safe and thread-safe. The flag stays until pool_reset_cancel. */
void pool_cancel(struct pool *pool);
/* A flag elsewhere (in memory shared with another process, say) that cancels as well, as soon as it is not 0. */
void pool_watch(struct pool *pool, const _Atomic int *flag);
void pool_reset_cancel(struct pool *pool);
bool pool_cancelled(const struct pool *pool);
/* Called (from worker 0's thread, every 10 ms or so while it works) during pool_run; may call pool_cancel. */
void pool_set_poll(struct pool *pool, void (*poll)(void *context), void *context);
/* For long items: that call, if the worker is worker 0 and it is due. */
void pool_poll(struct pool *pool, int worker);

/* Something that threads wait for, of this process or, in shared memory, of another. Zero-initialised. Whoever changes
 * what they wait for signals the event and never waits: a process that ends at any moment harms no other. */
struct pool_event {
    _Atomic uint32_t signals;
};
void pool_signal(struct pool_event *event);
/* seen: event->signals before the caller looked whether it has to wait. Returns after the first signal since then, or
 * after that many seconds (below 1). */
void pool_wait(struct pool_event *event, uint32_t seen, double seconds);

/* Threads beside those of a pool, for what mostly waits: each runs fn for one of the items 0 .. count - 1,
 * as worker first_worker + item. NULL: none could be started; fewer are no error. */
struct pool_threads;
struct pool_threads *pool_threads_start(uint32_t count, int first_worker, pool_function *fn, void *context);
void pool_threads_join(struct pool_threads *threads); /* until all have ended, without polls; or NULL */

/* Counts of the current run, or of the last one; for the thread that calls pool_run, and its poll. */
struct pool_progress {
    uint64_t runs;         /* since the pool was made */
    uint32_t begun, count; /* items */
};
struct pool_progress pool_progress(const struct pool *pool);

#endif
