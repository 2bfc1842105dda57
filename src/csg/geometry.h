/* The geometry of a primitive: a shape or a CSG solid. Each query is one two-way switch; the results are those of
 * shape.h and csg.h, in object space. */
#ifndef GRAY_CSG_GEOMETRY_H
#define GRAY_CSG_GEOMETRY_H

#include "base/bundle.h"
#include "csg/csg.h"
#include "shape/shape.h"

/* Borrows what the shape or the solid points to. */
struct geometry {
    const struct csg *csg; /* the solid; NULL: it is the shape */
    struct shape shape;    /* anything where csg is set */
};

static inline struct geometry geometry_of_shape(const struct shape *shape) {
    return (struct geometry){NULL, *shape};
}
static inline struct geometry geometry_of_csg(const struct csg *csg) {
    return (struct geometry){.csg = csg};
}
/* The mesh that it is, or NULL. */
static inline const struct mesh *geometry_mesh(const struct geometry *geometry) {
    return !geometry->csg && geometry->shape.kind == SHAPE_MESH ? geometry->shape.mesh : NULL;
}
/* The shape with that surface: the shape itself, or the leaf of the solid that made the surface (hit->leaf). */
static inline const struct shape *geometry_shape(const struct geometry *geometry, uint32_t leaf) {
    return geometry->csg ? &geometry->csg->leaves[leaf].shape : &geometry->shape;
}

/* The name of the kind of a shape; "csg" for a solid. */
static inline const char *geometry_kind_name(const struct geometry *geometry) {
    return geometry->csg ? "csg" : shape_kind_name(geometry->shape.kind);
}
static inline struct box geometry_bounds(const struct geometry *geometry) {
    return geometry->csg ? geometry->csg->bounds : shape_bounds(&geometry->shape);
}
static inline struct box geometry_bounds_under(const struct geometry *geometry, const struct affine *map) {
    return geometry->csg ? box_transform(map, &geometry->csg->bounds) : shape_bounds_under(&geometry->shape, map);
}
static inline bool geometry_is_closed(const struct geometry *geometry) {
    return geometry->csg ? !geometry->csg->clipped : shape_is_closed(&geometry->shape);
}
/* CONVEXITY_NONE for a solid: its leaves have their own convexity (csg->convexity). */
static inline enum hit_convexity geometry_convexity(const struct geometry *geometry) {
    return geometry->csg ? CONVEXITY_NONE : shape_convexity(&geometry->shape);
}
static inline enum shape_area geometry_area(const struct geometry *geometry) {
    return geometry->csg ? SHAPE_AREA_UNKNOWN : shape_area(&geometry->shape);
}
static inline bool geometry_nearest(const struct geometry *geometry, const struct ray *ray,
                                    struct geom_scratch *scratch, struct crossing *out) {
    return geometry->csg ? csg_nearest(geometry->csg, ray, scratch, out)
                         : shape_nearest(&geometry->shape, ray, scratch, out);
}
static inline bool geometry_any(const struct geometry *geometry, const struct ray *ray, struct geom_scratch *scratch) {
    return geometry->csg ? csg_any(geometry->csg, ray, scratch) : shape_any(&geometry->shape, ray, scratch);
}
static inline bool geometry_contains(const struct geometry *geometry, struct vec3 point, struct geom_scratch *scratch) {
    return geometry->csg ? csg_contains(geometry->csg, point, scratch)
                         : shape_contains(&geometry->shape, point, scratch);
}
static inline void geometry_describe(const struct geometry *geometry, const struct ray *ray,
                                     const struct crossing *crossing, struct surface *out) {
    if (geometry->csg)
        csg_describe(geometry->csg, ray, crossing, out);
    else
        shape_describe(&geometry->shape, ray, crossing, out);
}
static inline uint32_t geometry_scratch_need(const struct geometry *geometry) {
    return geometry->csg ? geometry->csg->max_crossings : shape_scratch_need(&geometry->shape);
}
/* What it points to (base/bundle.h). */
static inline void geometry_bundle(struct bundle *bundle, struct geometry *geometry) {
    if (geometry->csg)
        csg_bundle(bundle, &geometry->csg);
    else
        shape_bundle(bundle, &geometry->shape);
}

#endif
