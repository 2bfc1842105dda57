/* A table from 64-bit keys to numbers: open addressing, at most half full. */
#ifndef GRAY_BASE_KEY_MAP_H
#define GRAY_BASE_KEY_MAP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Keys are not 0. Zero value: empty. Owner: its holder, key_map_destroy. */
struct key_map {
    struct key_entry {
        uint64_t key;
        uint32_t value;
    } * entries;
    size_t capacity, count;
};

/* The place of its value, or NULL. */
uint32_t *key_map_find(const struct key_map *map, uint64_t key);
/* Adds a key that is not there. False: no memory. */
bool key_map_add(struct key_map *map, uint64_t key, uint32_t value);
void key_map_destroy(struct key_map *map);

#endif
