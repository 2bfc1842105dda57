/* The solids that light may pass, by primitive. */
#ifndef GRAY_WORLD_SOLIDS_INTERNAL_H
#define GRAY_WORLD_SOLIDS_INTERNAL_H

#include "world/flatten_internal.h"

/* Sets world->media.solids and first_solid; the world has its primitives and materials. Errors: no memory. */
bool solids_make(struct flattening *f);

#endif
