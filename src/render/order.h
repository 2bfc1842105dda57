/* In which order tiles are made: the picture does not depend on it, but the view during rendering and the time estimate
 * do. */
#ifndef GRAY_RENDER_ORDER_H
#define GRAY_RENDER_ORDER_H

#include "render/film.h"
#include "render/settings.h"

#include <stdbool.h>

/* out[k] is the k-th tile to be made; room for film_tile_count(film). False: no memory. */
bool tile_order(const struct film *film, enum order order, uint32_t *out);

#endif
