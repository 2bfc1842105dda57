/* The work of a render, for all of its workers: whole tiles in their order, quarters of the last ones, pass after pass,
 * or what another process hands out. An item is given to one worker. A worker that finds none waits until one comes or
 * the work is over. */
#ifndef GRAY_RENDER_WORK_QUEUE_INTERNAL_H
#define GRAY_RENDER_WORK_QUEUE_INTERNAL_H

#include "base/pool.h"
#include "film/film.h"

#include <pthread.h>

enum { WORK_QUARTERS = 4, WORK_WHOLE = WORK_QUARTERS, WORK_TAIL = 64 };
struct work_item {
    uint32_t tile;
    uint32_t quarter; /* below WORK_QUARTERS, or WORK_WHOLE */
    uint32_t divided; /* of a quarter: of its tile among those that are divided, from 0 */
};
enum work_result { WORK_SKIPPED, WORK_FAILED, WORK_DONE };

enum work_answer { WORK_HERE /* there is an item */, WORK_LATER /* there may be one later */, WORK_OVER };

struct work_queue {
    pthread_mutex_t mutex;
    struct pool_event *event; /* workers wait for it; the queue's own, or that of who hands out tiles */
    struct pool_event own;
    const uint32_t *tiles; /* in their order; owned by the caller */
    uint32_t whole, tail;  /* so many tiles are whole items, and so many after them four quarters each */
    uint32_t next;         /* number of the next item */
    uint32_t out;          /* items that workers have */
    bool over;
    struct {
        uint8_t done, failed; /* quarters */
    } parts[WORK_TAIL];
    /* Or NULL: the work is over after the last item. Called, by one worker at a time, when no item is left; may set
     * items (work_queue_set). WORK_HERE: it has. It is called again after an event and when the last item of all
     * workers is given back. */
    enum work_answer (*more)(void *context, struct work_queue *queue);
    void *context;
};

/* The queue is zero-initialised, `more` and, or NULL, `event` are set. */
void work_queue_begin(struct work_queue *queue);
void work_queue_destroy(struct work_queue *queue);
/* Sets the items, before the first worker comes or in `more`. tail: at most WORK_TAIL. */
void work_queue_set(struct work_queue *queue, const uint32_t *tiles, uint32_t whole, uint32_t tail);
/* Waits at most `patience` seconds (below 1) for an item: WORK_LATER then. */
enum work_answer work_queue_take(struct work_queue *queue, double patience, struct work_item *item);
/* How much is left that no worker has, in tiles; of this moment. */
double work_queue_left(struct work_queue *queue);
/* The worker gives the item back. Returns the result of its tile: of a quarter WORK_SKIPPED, until the last one comes
 * back. */
enum work_result work_queue_give_back(struct work_queue *queue, const struct work_item *item, enum work_result result);
/* The pixels of an item: its tile or a quarter of it, which may be empty. */
struct film_rectangle work_item_part(struct film_rectangle tile, const struct work_item *item);

#endif
