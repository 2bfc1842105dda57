/* From a world to a model: its solids as closed meshes. */
#ifndef GRAY_EXPORT_MODEL_BUILD_H
#define GRAY_EXPORT_MODEL_BUILD_H

#include "base/pool.h"
#include "export/model_write.h"
#include "world/world.h"

struct model_build_input {
    const struct world *world; /* at time 0 */
    const char *name;          /* of the model */
    double tolerance;          /* 0: a thousandth of the size */
    bool linear;               /* the colours of the world are linear light */
    bool corners;              /* have the colours of textures */
    struct arena *arena;       /* of the world */
    struct pool *pool;
    void (*notice)(void *context, const char *text);
    void *context;
};

/* Solids whose boxes touch are united into one part. Meshes that stand alone keep their triangles; all others are
 * meshed within the tolerance. Errors: a surface that is open, a solid without end (named), an empty model, and those
 * of solid_mesh_build. */
bool model_build(const struct model_build_input *input, struct export_model *out, struct error *error);

#endif
