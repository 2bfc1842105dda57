/* The solids that light may pass, by primitive, and their media that are given by place. */
#ifndef GRAY_WORLD_SOLIDS_INTERNAL_H
#define GRAY_WORLD_SOLIDS_INTERNAL_H

#include "world/flatten_internal.h"

/* Sets world->media.solids and first_solid; the world has its primitives and materials. Errors: no memory. */
bool solids_make(struct flattening *f);

/* A medium with a density, in the space of one solid. */
struct local_medium {
    uint32_t solid;
    struct medium inner; /* behind the surface of a material */
    struct medium_placement placement;
};
/* Puts them where their solids are. */
void solids_update_media(struct world *world);

#endif
