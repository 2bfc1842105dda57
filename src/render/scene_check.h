/* A look at a scene before its first ray, for mistakes that give a valid picture of nothing: no shape in view, shapes
 * smaller than a pixel, no light, an eye or a light inside an opaque solid, solids without points; and for what changes
 * nothing: photons with nothing that focuses them, inputs of materials that need another one; for transparent surfaces
 * that count as thin walls because they are open; and for light from under surfaces, which Whitted's integrator does
 * not follow. The same for all integrators, except for these two. */
#ifndef GRAY_RENDER_SCENE_CHECK_H
#define GRAY_RENDER_SCENE_CHECK_H

#include "render/render.h"

#define SCENE_FAULTS(X)                                                                                                \
    X(FAULT_EMPTY)                                                                                                     \
    X(FAULT_VIEW)                                                                                                      \
    X(FAULT_SIZE)                                                                                                      \
    X(FAULT_LIGHT)                                                                                                     \
    X(FAULT_EYE)                                                                                                       \
    X(FAULT_LIGHT_INSIDE)                                                                                              \
    X(FAULT_SOLID) X(FAULT_CAUSTICS) X(FAULT_FIELD) X(FAULT_THIN_WALL) X(FAULT_SUBSURFACE) X(FAULT_DISPERSION)
enum scene_fault { SCENE_FAULTS(LIST_MEMBER) };

/* Calls `notice` with a sentence for each mistake; the world is built. *noticed: a bit of each kind whose sentence was
 * given, which is not given again. */
void scene_check(const struct render_job *job, unsigned *noticed, world_warning *notice, void *context);

#endif
