/* Placements as a shift and a number of a linear map: a million pots in rows share one map, and cost 56 bytes each
 * instead of the 192 of a map with its inverse. A hash over the bits finds the equal ones; the newest is asked first.
 */
#include "base/hash.h"
#include "base/mem.h"
#include "world/flatten.h"

#include <string.h>

struct linear_table {
    uint32_t *slots; /* number of a map and 1, or 0 */
    uint64_t mask;
};

static uint64_t hash_of(const struct linear_map *map) {
    return hash_bytes(map, sizeof map->forward + sizeof map->inverse, 0);
}

static bool same(const struct linear_map *a, const struct linear_map *b) {
    return memcmp(a, b, sizeof a->forward + sizeof a->inverse) == 0;
}

static uint32_t *find(const struct flattening *f, const struct linear_map *map) {
    const struct linear_table *table = f->linear_table;
    uint64_t at = hash_of(map) & table->mask;
    while (table->slots[at] && !same(&f->world->linear_maps[table->slots[at] - 1], map))
        at = (at + 1) & table->mask;
    return &table->slots[at];
}

/* Room for one more map, in the list and in the table, which is at most half full. */
static bool grow(struct flattening *f) {
    struct world *world = f->world;
    if (world->linear_count < f->linear_capacity)
        return true;
    uint32_t capacity = f->linear_capacity ? f->linear_capacity * 2 : 64;
    struct linear_map *maps = mem_resize_array(world->linear_maps, capacity, sizeof *maps);
    if (!maps)
        return false;
    world->linear_maps = maps;
    if (!f->linear_table && !(f->linear_table = mem_alloc_zero(1, sizeof *f->linear_table)))
        return false;
    uint32_t *slots = mem_alloc_zero((size_t)capacity * 2, sizeof *slots);
    if (!slots)
        return false;
    mem_free(f->linear_table->slots);
    *f->linear_table = (struct linear_table){slots, (uint64_t)capacity * 2 - 1};
    f->linear_capacity = capacity;
    for (uint32_t i = 0; i < world->linear_count; i++)
        *find(f, &maps[i]) = i + 1;
    return true;
}

bool flatten_map(struct flattening *f, const struct transform *world_from_object, struct primitive *out) {
    struct transform nothing = transform_identity();
    struct world *world = f->world;
    if (memcmp(&nothing, world_from_object, sizeof nothing) == 0) {
        out->linear = LINEAR_NONE;
        return true;
    }
    struct linear_map map = {.stretch = transform_stretch(world_from_object)};
    const double(*forward)[4] = world_from_object->forward.m, (*inverse)[4] = world_from_object->inverse.m;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            map.forward[i][j] = forward[i][j];
            map.inverse[i][j] = inverse[i][j];
        }
    }
    out->shift = vec3_make(forward[0][3], forward[1][3], forward[2][3]);
    out->shift_back = vec3_make(inverse[0][3], inverse[1][3], inverse[2][3]);
    out->linear = world->linear_count - 1;
    if (world->linear_count > 0 && same(&map, &world->linear_maps[out->linear]))
        return true;
    if (!grow(f))
        return error_no_memory(f->error, "the places of the scene");
    uint32_t *slot = find(f, &map);
    if (*slot == 0) {
        world->linear_maps[world->linear_count++] = map;
        *slot = world->linear_count;
    }
    out->linear = *slot - 1;
    return true;
}

void flatten_map_end(struct flattening *f) {
    if (f->linear_table)
        mem_free(f->linear_table->slots);
    mem_free(f->linear_table);
    f->linear_table = NULL;
    /* Give back what doubling took too much; without success it is kept. */
    struct world *world = f->world;
    struct linear_map *maps = mem_resize_array(world->linear_maps, world->linear_count, sizeof *maps);
    world->linear_maps = maps ? maps : world->linear_maps;
}
