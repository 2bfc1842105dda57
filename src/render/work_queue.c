/* Items are numbered: first the whole tiles, then the quarters of the others, so giving one out is counting. The lock
 * is held for that and while `more` looks for new items, never while a worker works or waits.
 *
 * What follows when no item is left is the business of `more`: a pass, or tiles that another process hands out.
 *
 * No signal is lost: a worker reads the number of signals before it finds that there is no item, and it sleeps only if
 * the number is still the same (base/pool.h). */
#include "render/work_queue_internal.h"

void work_queue_begin(struct work_queue *queue) {
    (void)pthread_mutex_init(&queue->mutex, NULL);
    if (!queue->event)
        queue->event = &queue->own;
}

void work_queue_destroy(struct work_queue *queue) {
    (void)pthread_mutex_destroy(&queue->mutex);
}

void work_queue_set(struct work_queue *queue, const uint32_t *tiles, uint32_t whole, uint32_t tail) {
    queue->tiles = tiles;
    queue->whole = whole;
    queue->tail = tail;
    queue->next = 0;
}

static struct work_item item_of(const struct work_queue *queue, uint32_t number) {
    if (number < queue->whole)
        return (struct work_item){queue->tiles[number], WORK_WHOLE, 0};
    uint32_t divided = (number - queue->whole) / WORK_QUARTERS, quarter = (number - queue->whole) % WORK_QUARTERS;
    return (struct work_item){queue->tiles[queue->whole + divided], quarter, divided};
}

struct film_rectangle work_item_part(struct film_rectangle tile, const struct work_item *item) {
    uint32_t x = tile.x0 + (tile.x1 - tile.x0 + 1) / 2, y = tile.y0 + (tile.y1 - tile.y0 + 1) / 2;
    bool right = item->quarter % 2 == 1, low = item->quarter / 2 % 2 == 1;
    if (item->quarter == WORK_WHOLE)
        return tile;
    return (struct film_rectangle){right ? x : tile.x0, low ? y : tile.y0, right ? tile.x1 : x, low ? tile.y1 : y};
}

static bool has_item(const struct work_queue *queue) {
    return queue->next < queue->whole + WORK_QUARTERS * queue->tail;
}

/* The lock is held. What `more` finds is of interest for the workers that wait, too: it may be several items, or the
 * end of the work. */
static enum work_answer find_item(struct work_queue *queue) {
    if (queue->over)
        return WORK_OVER;
    if (has_item(queue))
        return WORK_HERE;
    enum work_answer answer = queue->more ? queue->more(queue->context, queue) : WORK_OVER;
    queue->over = answer == WORK_OVER;
    if (answer != WORK_LATER)
        pool_signal(queue->event);
    return answer;
}

static enum work_answer try_to_take(struct work_queue *queue, struct work_item *item, uint32_t *seen) {
    *seen = atomic_load(&queue->event->signals);
    (void)pthread_mutex_lock(&queue->mutex);
    enum work_answer answer = find_item(queue);
    if (answer == WORK_HERE) {
        *item = item_of(queue, queue->next++);
        queue->out++;
    }
    (void)pthread_mutex_unlock(&queue->mutex);
    return answer;
}

enum work_answer work_queue_take(struct work_queue *queue, double patience, struct work_item *item) {
    uint32_t seen;
    enum work_answer answer = try_to_take(queue, item, &seen);
    if (answer != WORK_LATER)
        return answer;
    pool_wait(queue->event, seen, patience);
    return try_to_take(queue, item, &seen);
}

double work_queue_left(struct work_queue *queue) {
    (void)pthread_mutex_lock(&queue->mutex);
    const uint32_t whole = queue->next < queue->whole ? queue->whole - queue->next : 0;
    const uint32_t quarters = queue->whole + WORK_QUARTERS * queue->tail - queue->next - whole;
    (void)pthread_mutex_unlock(&queue->mutex);
    return whole + (double)quarters / WORK_QUARTERS;
}

/* The lock is held. */
static enum work_result add_quarter(struct work_queue *queue, const struct work_item *item, enum work_result result) {
    if (result == WORK_SKIPPED)
        return result;
    queue->parts[item->divided].done++;
    if (result == WORK_FAILED)
        queue->parts[item->divided].failed++;
    if (queue->parts[item->divided].done < WORK_QUARTERS)
        return WORK_SKIPPED;
    return queue->parts[item->divided].failed > 0 ? WORK_FAILED : WORK_DONE;
}

enum work_result work_queue_give_back(struct work_queue *queue, const struct work_item *item, enum work_result result) {
    (void)pthread_mutex_lock(&queue->mutex);
    enum work_result of_tile = item->quarter == WORK_WHOLE ? result : add_quarter(queue, item, result);
    bool last = --queue->out == 0 && !has_item(queue);
    (void)pthread_mutex_unlock(&queue->mutex);
    if (last && queue->more)
        pool_signal(queue->event);
    return of_tile;
}
