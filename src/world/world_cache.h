/* What a frame of an animation takes over from the frame before. */
#ifndef GRAY_WORLD_WORLD_CACHE_H
#define GRAY_WORLD_WORLD_CACHE_H

#include "world/world.h"

/* Instead of world_destroy: keeps it for the next frame. The script must not have ended then. */
void world_keep(struct world *world, struct world_cache *cache);
/* Frees the tables, but not the accelerator: the next frame is not one of this scene. */
void world_cache_drop_tables(struct world_cache *cache);
void world_cache_destroy(struct world_cache *cache);
struct flattening;
/* The tables of the frame before with the changes of the scene, in f->world. *reused: false if there are none that fit;
 * then f->arena and f->log are those of new tables, if they may be kept. */
bool kept_tables_reuse(struct flattening *f, const struct world_input *input, bool *reused);

#endif
