/* A look at a scene before its first ray, for mistakes that give a valid picture of nothing: no shape in view, shapes
 * smaller than a pixel, no light, an eye or a light inside an opaque solid, solids without points; and for what changes
 * nothing: photons with nothing that focuses them, inputs of materials that need another one. The same for all
 * integrators. */
#ifndef GRAY_RENDER_FIRST_LOOK_H
#define GRAY_RENDER_FIRST_LOOK_H

#include "render/render.h"

#define FIRST_LOOKS(X)                                                                                                 \
    X(LOOK_EMPTY)                                                                                                      \
    X(LOOK_VIEW) X(LOOK_SIZE) X(LOOK_LIGHT) X(LOOK_EYE) X(LOOK_LAMP) X(LOOK_SOLID) X(LOOK_CAUSTICS) X(LOOK_FIELD)
enum first_look { FIRST_LOOKS(LIST_MEMBER) };

/* Calls `notice` with a sentence for each mistake; the world is built. *noticed: a bit of each kind whose sentence was
 * given, which is not given again. */
void first_look(const struct render_job *job, unsigned *noticed, world_warning *notice, void *context);

#endif
