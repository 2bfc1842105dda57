/* The view of a render. */
#ifndef GRAY_RENDER_PATH_VIEW_INTERNAL_H
#define GRAY_RENDER_PATH_VIEW_INTERNAL_H

#include "render/path_internal.h"
#include "render/path_view.h"

/* False: it has more closed solids than a view has room for, or its camera moves. */
bool path_view_make(const struct renderer *renderer, struct path_view *view);

#endif
