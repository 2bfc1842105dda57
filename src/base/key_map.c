#include "base/key_map.h"

#include "base/mem.h"
#include "base/random.h"

static struct key_entry *slot_of(const struct key_map *map, uint64_t key) {
    size_t at = random_mix(key) & (map->capacity - 1);
    while (map->entries[at].key && map->entries[at].key != key)
        at = (at + 1) & (map->capacity - 1);
    return &map->entries[at];
}

uint32_t *key_map_find(const struct key_map *map, uint64_t key) {
    struct key_entry *entry = map->capacity ? slot_of(map, key) : NULL;
    return entry && entry->key ? &entry->value : NULL;
}

static bool grow(struct key_map *map) {
    struct key_map larger = {.capacity = map->capacity ? map->capacity * 2 : 1024, .count = map->count};
    larger.entries = mem_alloc_zero(larger.capacity, sizeof *larger.entries);
    if (!larger.entries)
        return false;
    for (size_t i = 0; i < map->capacity; i++)
        if (map->entries[i].key)
            *slot_of(&larger, map->entries[i].key) = map->entries[i];
    mem_free(map->entries);
    *map = larger;
    return true;
}

bool key_map_add(struct key_map *map, uint64_t key, uint32_t value) {
    if (2 * map->count >= map->capacity && !grow(map))
        return false;
    *slot_of(map, key) = (struct key_entry){key, value};
    map->count++;
    return true;
}

void key_map_destroy(struct key_map *map) {
    mem_free(map->entries);
    *map = (struct key_map){0};
}
