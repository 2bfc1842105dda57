/* Which tiles of a picture belong to which of several machines, decided by each of them alone and the same on all. */
#ifndef GRAY_RENDER_SHARD_H
#define GRAY_RENDER_SHARD_H

#include "render/film.h"

/* cost: of every tile of the film, in any unit. Marks the tiles that belong to other shards (1 <= shard <= shards).
 * False: no memory. The tiles are dealt out from the dearest to the cheapest, forwards and backwards in turn, so every
 * shard gets as many tiles as any other, or one more, and nearly the same cost. Reserves nothing that outlives it. */
bool shard_choose(const uint64_t *cost, struct film *film, uint32_t shard, uint32_t shards);

#endif
