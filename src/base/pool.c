/* The pool: threads sleep on a condition until a run begins; then all of them and the caller claim items from one
 * atomic counter until none is left. The run is over when the last worker that joined it has left. */
#include "base/pool.h"
#include "base/clock.h"

#include "base/fault.h"
#include "base/mem.h"

#include <limits.h>
#include <linux/futex.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

enum { POOL_LIMIT = 1024 };

struct pool_thread {
    struct pool *pool;
    pthread_t thread;
    int worker;
};

struct pool {
    pthread_mutex_t mutex;
    pthread_cond_t start, finish;
    uint64_t generation; /* counts runs that wake threads; a thread joins each once */
    uint64_t runs;       /* counts all of them */
    int active;          /* threads still inside the current run */
    bool stop;
    pool_function *fn;
    void *context;
    uint32_t count;
    _Atomic uint64_t next;
    _Atomic bool cancelled;
    const _Atomic int *watched; /* cancels too, or NULL */
    void (*poll)(void *context);
    void *poll_context;
    double polled; /* seconds: when, by worker 0 */
    int workers;
    struct pool_thread *threads; /* workers - 1 of them */
};

void pool_poll(struct pool *pool, int worker) {
    if (worker != 0 || !pool->poll)
        return;
    double now = clock_now();
    if (now - pool->polled < 0.005)
        return;
    pool->poll(pool->poll_context);
    pool->polled = now;
}

static void work(struct pool *pool, int worker) {
    for (;;) {
        pool_poll(pool, worker);
        if (pool_cancelled(pool))
            return;
        uint64_t item = atomic_fetch_add_explicit(&pool->next, 1, memory_order_relaxed);
        if (item >= pool->count)
            return;
        pool->fn(pool->context, (uint32_t)item, worker);
    }
}

static void *thread_main(void *argument) {
    struct pool_thread *self = argument;
    struct pool *pool = self->pool;
    uint64_t seen = 0;
    (void)pthread_mutex_lock(&pool->mutex);
    for (;;) {
        while (!pool->stop && pool->generation == seen)
            (void)pthread_cond_wait(&pool->start, &pool->mutex);
        if (pool->stop)
            break;
        seen = pool->generation;
        (void)pthread_mutex_unlock(&pool->mutex);
        work(pool, self->worker);
        (void)pthread_mutex_lock(&pool->mutex);
        if (--pool->active == 0)
            (void)pthread_cond_signal(&pool->finish);
    }
    (void)pthread_mutex_unlock(&pool->mutex);
    return NULL;
}

/* The system's default is not used: it follows `ulimit -s`, and is 2 MiB if that is unlimited. Only used pages take
 * memory. */
static const size_t stack_size = (size_t)32 << 20;

static int start_thread(pthread_t *thread, void *(*fn)(void *argument), void *argument) {
    pthread_attr_t attributes;
    if (fault_now(FAULT_OF_CALL))
        return EAGAIN;
    int failure = pthread_attr_init(&attributes);
    if (failure != 0)
        return failure;
    (void)pthread_attr_setstacksize(&attributes, stack_size);
    failure = pthread_create(thread, &attributes, fn, argument);
    (void)pthread_attr_destroy(&attributes);
    return failure;
}

/* Raises the limit of the calling thread, which must be the first one of the process, as far as the system lets it. */
static bool stack_is_large(void) {
    struct rlimit limit;
    if (getrlimit(RLIMIT_STACK, &limit) != 0)
        return false;
    if (limit.rlim_cur >= stack_size)
        return true;
    if (limit.rlim_max < stack_size)
        return false;
    limit.rlim_cur = stack_size;
    return setrlimit(RLIMIT_STACK, &limit) == 0;
}

struct deep_call {
    void (*fn)(void *context);
    void *context;
};

static void *call_main(void *argument) {
    const struct deep_call *call = argument;
    call->fn(call->context);
    return NULL;
}

bool pool_call_with_stack(void (*fn)(void *context), void *context, struct error *error) {
    struct deep_call call = {fn, context};
    pthread_t thread;
    if (stack_is_large()) {
        fn(context);
        return true;
    }
    int failure = start_thread(&thread, call_main, &call);
    if (failure != 0)
        return error_set(error, ERROR_MACHINE, "gray: there is no stack of %zu MiB (ulimit -s allows less): %s",
                         stack_size >> 20, strerror(failure));
    (void)pthread_join(thread, NULL);
    return true;
}

struct pool *pool_create(int threads, char warning[256]) {
    warning[0] = '\0';
    long online = sysconf(_SC_NPROCESSORS_ONLN);
    int wanted = threads > 0 ? threads : online > 0 ? (int)online : 1;
    if (wanted > POOL_LIMIT)
        wanted = POOL_LIMIT;
    struct pool *pool = mem_alloc_zero(1, sizeof *pool);
    if (!pool)
        return NULL;
    pool->threads = mem_alloc_zero((size_t)wanted, sizeof *pool->threads);
    if (!pool->threads) {
        mem_free(pool);
        return NULL;
    }
    (void)pthread_mutex_init(&pool->mutex, NULL);
    (void)pthread_cond_init(&pool->start, NULL);
    (void)pthread_cond_init(&pool->finish, NULL);
    pool->workers = 1;
    /* The caller of pool_run is the first worker. Fewer threads are no error. */
    for (int i = 0; i < wanted - 1; i++) {
        pool->threads[i] = (struct pool_thread){.pool = pool, .worker = i + 1};
        int failure = start_thread(&pool->threads[i].thread, thread_main, &pool->threads[i]);
        if (failure != 0) {
            (void)snprintf(warning, 256, "only %d of %d threads could be started: %s", pool->workers, wanted,
                           strerror(failure));
            break;
        }
        pool->workers++;
    }
    return pool;
}

void pool_destroy(struct pool *pool) {
    if (!pool)
        return;
    (void)pthread_mutex_lock(&pool->mutex);
    pool->stop = true;
    (void)pthread_cond_broadcast(&pool->start);
    (void)pthread_mutex_unlock(&pool->mutex);
    for (int i = 0; i < pool->workers - 1; i++)
        (void)pthread_join(pool->threads[i].thread, NULL);
    (void)pthread_cond_destroy(&pool->finish);
    (void)pthread_cond_destroy(&pool->start);
    (void)pthread_mutex_destroy(&pool->mutex);
    mem_free(pool->threads);
    mem_free(pool);
}

int pool_workers(const struct pool *pool) {
    return pool->workers;
}

bool pool_run(struct pool *pool, uint32_t count, pool_function *fn, void *context) {
    /* One item is not worth waking threads. */
    bool is_serial = pool->workers == 1 || count <= 1;
    pool->runs++;
    (void)pthread_mutex_lock(&pool->mutex);
    pool->fn = fn;
    pool->context = context;
    pool->count = count;
    atomic_store_explicit(&pool->next, 0, memory_order_relaxed);
    if (!is_serial) {
        pool->active = pool->workers - 1;
        pool->generation++;
        (void)pthread_cond_broadcast(&pool->start);
    }
    (void)pthread_mutex_unlock(&pool->mutex);
    work(pool, 0);
    if (!is_serial) {
        (void)pthread_mutex_lock(&pool->mutex);
        while (pool->active > 0) {
            if (!pool->poll) {
                (void)pthread_cond_wait(&pool->finish, &pool->mutex);
                continue;
            }
            /* Other threads still work on long items: keep polling for a request to stop. */
            struct timespec until;
            (void)clock_gettime(CLOCK_REALTIME, &until);
            until.tv_nsec += 5000000;
            if (until.tv_nsec >= 1000000000) {
                until.tv_nsec -= 1000000000;
                until.tv_sec++;
            }
            if (pthread_cond_timedwait(&pool->finish, &pool->mutex, &until) != 0) {
                (void)pthread_mutex_unlock(&pool->mutex);
                pool->poll(pool->poll_context);
                (void)pthread_mutex_lock(&pool->mutex);
            }
        }
        (void)pthread_mutex_unlock(&pool->mutex);
    }
    return !pool_cancelled(pool);
}

void pool_cancel(struct pool *pool) {
    atomic_store_explicit(&pool->cancelled, true, memory_order_relaxed);
}

void pool_watch(struct pool *pool, const _Atomic int *flag) {
    pool->watched = flag;
}

void pool_reset_cancel(struct pool *pool) {
    atomic_store_explicit(&pool->cancelled, false, memory_order_relaxed);
}

bool pool_cancelled(const struct pool *pool) {
    return atomic_load_explicit(&pool->cancelled, memory_order_relaxed) ||
           (pool->watched && atomic_load_explicit(pool->watched, memory_order_relaxed) != 0);
}

void pool_set_poll(struct pool *pool, void (*poll)(void *context), void *context) {
    pool->poll = poll;
    pool->poll_context = context;
}

/* --- threads beside a pool --- */

struct waiting_thread {
    struct pool_threads *all;
    pthread_t thread;
    uint32_t item;
};

struct pool_threads {
    pool_function *fn;
    void *context;
    int first_worker;
    uint32_t count;
    struct waiting_thread threads[];
};

static void *waiting_main(void *argument) {
    const struct waiting_thread *self = argument;
    self->all->fn(self->all->context, self->item, self->all->first_worker + (int)self->item);
    return NULL;
}

struct pool_threads *pool_threads_start(uint32_t count, int first_worker, pool_function *fn, void *context) {
    struct pool_threads *all = mem_alloc(sizeof *all + count * sizeof *all->threads);
    if (!all)
        return NULL;
    *all = (struct pool_threads){.fn = fn, .context = context, .first_worker = first_worker};
    while (all->count < count) {
        struct waiting_thread *next = &all->threads[all->count];
        *next = (struct waiting_thread){.all = all, .item = all->count};
        if (start_thread(&next->thread, waiting_main, next) != 0)
            break;
        all->count++;
    }
    if (all->count > 0)
        return all;
    mem_free(all);
    return NULL;
}

void pool_threads_join(struct pool_threads *threads) {
    for (uint32_t i = 0; threads && i < threads->count; i++)
        (void)pthread_join(threads->threads[i].thread, NULL);
    mem_free(threads);
}

/* --- events --- */

/* A futex: the kernel compares the number and sleeps in one step, so no signal is lost (U. Drepper, "Futexes Are
 * Tricky", 2011). */
void pool_signal(struct pool_event *event) {
    atomic_fetch_add(&event->signals, 1);
    (void)syscall(SYS_futex, &event->signals, FUTEX_WAKE, INT_MAX, NULL, NULL, 0);
}

void pool_wait(struct pool_event *event, uint32_t seen, double seconds) {
    const struct timespec limit = {0, (long)(seconds * 1e9)};
    if (atomic_load(&event->signals) == seen)
        (void)syscall(SYS_futex, &event->signals, FUTEX_WAIT, seen, &limit, NULL, 0);
}

struct pool_progress pool_progress(const struct pool *pool) {
    uint64_t begun = atomic_load_explicit(&pool->next, memory_order_relaxed);
    return (struct pool_progress){pool->runs, begun < pool->count ? (uint32_t)begun : pool->count, pool->count};
}
