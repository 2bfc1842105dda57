/* Dealing in turns that go forwards and backwards ("snake draft"): whoever gets the dearest tile of one turn gets the
 * cheapest of the next. The order of equal costs is the tiles' own scrambled number, so that neighbours, which cost
 * alike, go to different shards. */
#include "render/shard.h"

#include "base/mem.h"
#include "base/random.h"

#include <stdlib.h>

struct tile_cost {
    uint64_t cost, scrambled;
    uint32_t tile;
};

static int dearest_first(const void *a, const void *b) {
    const struct tile_cost *x = a, *y = b;
    if (x->cost != y->cost)
        return x->cost < y->cost ? 1 : -1;
    return x->scrambled < y->scrambled ? -1 : x->scrambled > y->scrambled;
}

bool shard_choose(const uint64_t *cost, struct film *film, uint32_t shard, uint32_t shards) {
    uint32_t count = film_tile_count(film);
    struct tile_cost *order = mem_alloc_zero(count, sizeof *order);
    if (!order)
        return false;
    for (uint32_t tile = 0; tile < count; tile++)
        order[tile] = (struct tile_cost){cost[tile], random_mix(tile), tile};
    qsort(order, count, sizeof *order, dearest_first);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t turn = i / shards, place = i % shards;
        uint32_t owner = turn % 2 ? shards - 1 - place : place;
        if (owner != shard - 1 && atomic_load(&film->tiles[order[i].tile]) == FILM_TILE_WANTED)
            atomic_store(&film->tiles[order[i].tile], FILM_TILE_ELSEWHERE);
    }
    mem_free(order);
    return true;
}
