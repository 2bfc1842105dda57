/* The queue of a render: every item goes to one worker, and workers wait for items without polling. */
#include "render/work_queue_internal.h"
#include "tests/harness.h"

#include <pthread.h>
#include <sched.h>
#include <stdlib.h>

enum { TILES = 500, TAIL = 40, WORKERS = 4, PASSES = 5 };

static const double long_time = 0.9; /* of a wait that a signal ends */

struct crew {
    struct work_queue queue;
    uint32_t tiles[TILES];
    _Atomic uint32_t times[TILES][WORK_QUARTERS + 1]; /* that an item was taken */
    _Atomic uint32_t taken, results[3];
    uint32_t passes; /* changed under the lock of the queue */
};

static struct crew *new_crew(void) {
    struct crew *crew = calloc(1, sizeof *crew);
    for (uint32_t i = 0; i < TILES; i++)
        crew->tiles[i] = TILES - 1 - i;
    return crew;
}

static void *work(void *context) {
    struct crew *crew = context;
    struct work_item item;
    for (;;) {
        enum work_answer answer = work_queue_take(&crew->queue, long_time, &item);
        if (answer == WORK_OVER)
            return NULL;
        if (answer == WORK_LATER)
            continue;
        crew->taken++;
        crew->times[item.tile][item.quarter]++;
        crew->results[work_queue_give_back(&crew->queue, &item, item.tile == 3 ? WORK_FAILED : WORK_DONE)]++;
    }
}

static void start(struct crew *crew, pthread_t threads[WORKERS]) {
    for (int i = 0; i < WORKERS; i++)
        CHECK(pthread_create(&threads[i], NULL, work, crew) == 0);
}

static void join(pthread_t threads[WORKERS]) {
    for (int i = 0; i < WORKERS; i++)
        CHECK(pthread_join(threads[i], NULL) == 0);
}

TEST(each_item_is_given_out_once_and_a_tile_of_quarters_ends_with_the_last_one) {
    struct crew *crew = new_crew();
    pthread_t threads[WORKERS];
    work_queue_begin(&crew->queue);
    work_queue_set(&crew->queue, crew->tiles, TILES - TAIL, TAIL);
    start(crew, threads);
    join(threads);
    work_queue_destroy(&crew->queue);
    for (uint32_t i = 0; i < TILES; i++) {
        bool divided = i >= TILES - TAIL;
        CHECK_EQ_INT(crew->times[crew->tiles[i]][WORK_WHOLE], !divided);
        for (int quarter = 0; quarter < WORK_QUARTERS; quarter++)
            CHECK_EQ_INT(crew->times[crew->tiles[i]][quarter], divided);
    }
    CHECK_EQ_INT(crew->results[WORK_FAILED], 1); /* tile 3, once, although all its quarters failed */
    CHECK_EQ_INT(crew->results[WORK_DONE], TILES - 1);
    CHECK_EQ_INT(crew->results[WORK_SKIPPED], TAIL * (WORK_QUARTERS - 1));
    free(crew);
}

TEST(quarters_follow_all_whole_tiles_in_their_order) {
    struct work_queue queue = {0};
    const uint32_t tiles[3] = {7, 5, 9};
    struct work_item item;
    work_queue_begin(&queue);
    work_queue_set(&queue, tiles, 2, 1);
    for (uint32_t i = 0; i < 2 + WORK_QUARTERS; i++) {
        CHECK_EQ_INT(work_queue_take(&queue, 0, &item), WORK_HERE);
        CHECK_EQ_INT(item.tile, tiles[i < 2 ? i : 2]);
        CHECK_EQ_INT(item.quarter, i < 2 ? WORK_WHOLE : i - 2);
    }
    CHECK_EQ_INT(work_queue_take(&queue, 0, &item), WORK_OVER);
    work_queue_destroy(&queue);
}

/* A pass begins when all items of the one before are given back. */
static enum work_answer next_pass(void *context, struct work_queue *queue) {
    struct crew *crew = context;
    if (queue->out > 0)
        return WORK_LATER;
    CHECK_EQ_INT(crew->taken, (crew->passes + 1) * TILES);
    if (++crew->passes == PASSES)
        return WORK_OVER;
    work_queue_set(queue, crew->tiles, TILES, 0);
    return WORK_HERE;
}

TEST(a_pass_begins_after_the_last_item_of_the_pass_before_and_wakes_all_workers) {
    struct crew *crew = new_crew();
    pthread_t threads[WORKERS];
    crew->queue.more = next_pass;
    crew->queue.context = crew;
    work_queue_begin(&crew->queue);
    work_queue_set(&crew->queue, crew->tiles, TILES, 0);
    start(crew, threads);
    join(threads);
    work_queue_destroy(&crew->queue);
    for (uint32_t i = 0; i < TILES; i++)
        CHECK_EQ_INT(crew->times[i][WORK_WHOLE], PASSES);
    free(crew);
}

/* What another process hands out: one tile for each number, and -1 at the end. */
static _Atomic int handed_out;

static enum work_answer handed(void *context, struct work_queue *queue) {
    struct crew *crew = context;
    int number = atomic_exchange(&handed_out, 0);
    if (number < 0)
        return WORK_OVER;
    if (number == 0)
        return WORK_LATER;
    work_queue_set(queue, &crew->tiles[number], 1, 0);
    return WORK_HERE;
}

/* If signals were lost, each of 500 would cost a wait of .9 s, and the test would not end. */
TEST(a_waiting_worker_wakes_when_an_item_comes_and_at_the_end) {
    struct crew *crew = new_crew();
    struct pool_event event = {0};
    pthread_t threads[WORKERS];
    crew->queue = (struct work_queue){.event = &event, .more = handed, .context = crew};
    work_queue_begin(&crew->queue);
    start(crew, threads);
    for (int number = 1; number < TILES; number++) {
        handed_out = number;
        pool_signal(&event);
        while (crew->taken < (uint32_t)number)
            CHECK(sched_yield() == 0);
    }
    handed_out = -1;
    pool_signal(&event);
    join(threads);
    work_queue_destroy(&crew->queue);
    for (uint32_t i = 1; i < TILES; i++)
        CHECK_EQ_INT(crew->times[crew->tiles[i]][WORK_WHOLE], 1);
    free(crew);
}

TEST(a_wait_for_items_ends_after_its_time_so_that_a_request_to_stop_is_seen) {
    struct crew *crew = new_crew();
    struct work_item item;
    handed_out = 0;
    crew->queue.more = handed;
    crew->queue.context = crew;
    work_queue_begin(&crew->queue);
    CHECK_EQ_INT(work_queue_take(&crew->queue, 0.001, &item), WORK_LATER);
    handed_out = -1;
    CHECK_EQ_INT(work_queue_take(&crew->queue, 0.001, &item), WORK_OVER);
    CHECK_EQ_INT(work_queue_take(&crew->queue, 0.001, &item), WORK_OVER);
    work_queue_destroy(&crew->queue);
    free(crew);
}
