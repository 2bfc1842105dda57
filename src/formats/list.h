/* A growing array for readers of files. It grows by half of its size. */
#ifndef GRAY_FORMATS_LIST_H
#define GRAY_FORMATS_LIST_H

#include "base/mem.h"

#include <assert.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* Owner: its holder, who calls list_destroy. Zero value: empty. */
struct list {
    void *items;
    size_t count, capacity;
};

/* Room for `more` items of `size` bytes after the last one; NULL: no memory. The caller increases count. */
static inline void *list_room(struct list *list, size_t more, size_t size) {
    if (!list->items || list->capacity - list->count < more) {
        size_t min, capacity = list->capacity + list->capacity / 2 + 64;
        bool beyond = __builtin_add_overflow(list->count, more, &min);
        assert(!beyond); /* the size of a file bounds both */
        (void)beyond;
        if (capacity < min)
            capacity = min;
        void *items = mem_resize_array(list->items, capacity, size);
        if (!items)
            return NULL;
        list->items = items;
        list->capacity = capacity;
    }
    return (char *)list->items + list->count * size;
}

/* Copies so many items to the end. False: no memory. */
static inline bool list_add(struct list *list, const void *items, size_t count, size_t size) {
    char *room = list_room(list, count, size);
    if (!room)
        return false;
    if (count > 0)
        memcpy(room, items, count * size);
    list->count += count;
    return true;
}

static inline bool list_add_index(struct list *list, uint32_t index) {
    return list_add(list, &index, 1, sizeof index);
}

static inline bool list_add_bytes(struct list *list, const void *bytes, size_t size) {
    return list_add(list, bytes, size, 1);
}

/* Little-endian. */
static inline bool list_add_number(struct list *list, uint32_t number, size_t size) {
    const uint8_t little[4] = {(uint8_t)number, (uint8_t)(number >> 8), (uint8_t)(number >> 16),
                               (uint8_t)(number >> 24)};
    return list_add_bytes(list, little, size);
}

static inline void list_destroy(struct list *list) {
    mem_free(list->items);
    *list = (struct list){0};
}

#endif
