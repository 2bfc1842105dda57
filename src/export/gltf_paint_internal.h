/* The materials of a glTF file: the inverse of formats/gltf_material.c. */
#ifndef GRAY_EXPORT_GLTF_PAINT_INTERNAL_H
#define GRAY_EXPORT_GLTF_PAINT_INTERNAL_H

#include "base/list.h"
#include "export/gltf_file_internal.h"
#include "export/gltf_surface_internal.h"

enum { GLTF_BAKED_CELL = 6 }; /* texels of a triangle in a baked picture at least */
/* The side of a baked picture, texels: smaller where many may be baked. */
static inline uint32_t gltf_baked_size(const struct world *world) {
    uint32_t count = world->prototype_count;
    return count <= 32 ? 1024 : count <= 256 ? 512 : count <= 1024 ? 256 : 128;
}

struct gltf_painter {
    struct gltf_buffer *buffer;
    const struct world *world;
    struct pool *pool;
    bool linear;            /* colours of the world are linear light */
    struct key_map *images; /* by address: their views of the buffer */
};

/* Linear light, not below 0, for a colour of the world. */
struct colour gltf_light_of(const struct gltf_painter *painter, struct colour colour);

/* The pictures that are baked. */
#define GLTF_MAPS(X)                                                                                                   \
    X(GLTF_BASE, "base")                                                                                               \
    X(GLTF_ROUGH, "rough")                                                                                             \
    X(GLTF_EMISSION, "emission")                                                                                       \
    X(GLTF_NORMAL, "normal")
enum gltf_map { GLTF_MAPS(LIST_MEMBER) };
enum { GLTF_MAP_COUNT = LIST_COUNT(GLTF_MAPS) };

/* What is the same for all triangles of a surface. */
struct gltf_paint {
    uint32_t maps[GLTF_MAP_COUNT];    /* views of PNG files, or GLTF_NONE */
    double strongest;                 /* of the emission */
    bool baked, has_holes, has_veils; /* opacities of 0, and between 0 and 1 */
    bool by_vertex;                   /* colours are those of the vertices */
};
/* Bakes what no material of glTF states; the surface may be unfolded for it. Errors: no memory, cancelled. */
bool gltf_paint_make(const struct gltf_painter *painter, uint32_t primitive, struct gltf_surface *surface,
                     struct gltf_paint *out, struct error *error);
/* Pushes a table with what a material of the world is on the surface, for gltf_scene.lua. May raise. */
void gltf_paint_push(lua_State *L, const struct gltf_painter *painter, uint32_t material,
                     const struct gltf_surface *surface, const struct gltf_paint *paint);

#endif
