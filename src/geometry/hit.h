/* The complete description of the nearest crossing. */
#ifndef GRAY_GEOMETRY_HIT_H
#define GRAY_GEOMETRY_HIT_H

#include "math/colour.h"
#include "math/ray.h"
#include "math/vec3.h"

#include <stdbool.h>
#include <stdint.h>

/* The position of the whole primitive relative to the tangent plane of the hit: unknown; behind it (convex shapes); in
 * it (planar shapes); unknown, but the triangle of the hit is in it (meshes). */
enum hit_convexity { CONVEXITY_NONE, CONVEXITY_BEHIND, CONVEXITY_PLANAR, CONVEXITY_FACETS };

/* The second texture coordinates of a mesh, with the derivatives of the point. */
struct second_uv {
    double u, v;
    struct vec3 dpdu, dpdv;
};

/* A surface point in the object space of the shape, filled by shape_describe. */
struct surface {
    struct vec3 point;          /* in the shape's object space */
    struct vec3 normal;         /* geometric, outward (of the CSG result), any length > 0 */
    struct vec3 shading_normal; /* interpolated where the mesh has vertex normals, else = normal; any length > 0 */
    struct vec3 pattern_point;  /* in the object space of the operand that made the surface (= point outside CSG) */
    struct vec3 pattern_normal; /* geometric, in that space, as the operand has it (not flipped) */
    bool has_uv;
    bool has_colour;
    struct colour colour; /* of the vertices, interpolated */
    double u, v;
    struct vec3 dpdu, dpdv; /* object space; zero when has_uv is false */
    bool has_second;
    struct second_uv second; /* object space; not set when has_second is false */
    double error;  /* bound of the distance between `point` and the true surface, object units, from rounding */
    double behind; /* of a hair: as in struct hit, object units; else 0 */
    uint32_t leaf; /* CSG operand, else 0 */
    uint32_t material_slot; /* per-face materials of a mesh; 0 = the only one */
};

/* A surface without image coordinates outside CSG, written field by field: clearing this much memory takes longer than
 * computing the point. */
static inline void surface_make(struct surface *out, struct vec3 point, struct vec3 normal, double error) {
    const struct vec3 zero = {0, 0, 0};
    out->point = out->pattern_point = point;
    out->normal = out->shading_normal = out->pattern_normal = normal;
    out->has_uv = out->has_colour = out->has_second = false;
    out->dpdu = out->dpdv = zero;
    out->colour = colour_all(0);
    out->u = out->v = 0;
    out->error = error;
    out->behind = 0;
    out->leaf = out->material_slot = 0;
}

/* A secondary ray starts this many errors off the surface. */
enum { HIT_OFFSET_ERRORS = 16 };

struct hit {
    double t;
    struct vec3 point;            /* world */
    struct vec3 view;             /* unit, to where the ray came from */
    struct vec3 normal_geometric; /* unit, outward, world */
    struct vec3 normal;           /* unit, interpolated where there are vertex normals; outward side as given */
    struct vec3 pattern_point, pattern_normal;
    bool has_uv, has_colour, has_second;
    struct colour colour; /* of the vertices, interpolated */
    double u, v;
    struct second_uv second; /* world; not set when has_second is false */
    struct vec3 dpdu, dpdv;  /* world; for spheres only if bumps or functions need them */
    /* If bumps or functions need them: the world vectors of one unit along the operand's outward normal and along its
     * tangents by frame_tangents; the derivatives of pattern_normal along these if known (spheres), else 0. */
    struct vec3 raise, along_a, along_b;
    double curvature;
    double offset;        /* a secondary ray starts this far (world units) from point along the normal */
    double behind;        /* half the width of a hair, which is a ribbon that faces each ray; 0 for other surfaces */
    double footprint;     /* diameter of the ray's cone here, world units; 0 = unknown */
    double pattern_scale; /* pattern-space units per world unit (largest stretch); for filtering */
    bool front;           /* the ray came from outside: dot(view, normal_geometric) >= 0 */
    uint32_t primitive;   /* index of the primitive */
    uint32_t leaf, part;
    uint32_t material; /* index into the world's materials */
    uint32_t solid;    /* number of the solid behind the surface (material/medium.h), if light may pass it */
    enum hit_convexity convexity;
    double time;
};

/* A primitive or triangle that the ray is known not to hit, as in ray->skip_primitive and ray->skip_part. */
struct hit_skip {
    uint32_t primitive, part;
};
/* A ray leaves the surface in `direction` from the side `side` (the sign of the distance of its origin along
 * normal_geometric). It cannot hit its primitive, or its triangle, again if no part of it is on that side. Directions
 * within 2^-20 of the surface are tested, because of rounding. */
static inline struct hit_skip hit_skip_from(const struct hit *hit, double side, struct vec3 direction) {
    double rise = vec3_dot(direction, hit->normal_geometric), min = 0x1p-20 * vec3_max_abs(direction);
    bool away = (side < 0 ? -rise : rise) > min;
    if (!away || hit->convexity == CONVEXITY_NONE || (hit->convexity == CONVEXITY_BEHIND && side < 0))
        return (struct hit_skip){0, 0};
    return (struct hit_skip){hit->primitive + 1, hit->convexity == CONVEXITY_FACETS ? hit->part + 1 : 0};
}
/* The same for whole primitives. */
static inline uint32_t hit_skip_primitive_from(const struct hit *hit, double side, struct vec3 direction) {
    struct hit_skip skip = hit_skip_from(hit, side, direction);
    return skip.part ? 0 : skip.primitive;
}

/* Where a ray starts that goes on from the hit of `from` to the other side of a hair: on the line through the point
 * where `from` meets the ribbon. A ray that goes straight on starts there, and meets all other hairs that are near. A
 * refracted one may turn towards the middle of the hair by the sine s, at the angle a to the hair: it is nearest to the
 * middle at most s / sin^2 a times half a width further on. The difference of the unit directions is at least s. The
 * start is at most 4 half widths behind, so light that runs along the hair may meet it once more. */
static inline struct vec3 hit_start_behind(const struct hit *hit, const struct ray *from, struct vec3 direction) {
    struct vec3 unit = vec3_normalize(direction);
    double turned = vec3_length(vec3_add(unit, hit->view)), along = vec3_dot(unit, vec3_normalize(hit->dpdu));
    double past = math_min(turned / math_max(1 - along * along, 0x1p-40), 4);
    double rounding = hit->offset + 0x1p-42 * vec3_max_abs(from->origin);
    return vec3_add_scaled(ray_at(from, hit->t), unit, rounding + hit->behind * past);
}
/* Where a ray starts that leaves the hit of `from` in a direction. */
static inline struct vec3 hit_start(const struct hit *hit, const struct ray *from, struct vec3 direction) {
    double rise = vec3_dot(direction, hit->normal_geometric);
    if (hit->behind > 0 && (hit->front ? rise <= 0 : rise >= 0))
        return hit_start_behind(hit, from, direction);
    return vec3_add_scaled(hit->point, hit->normal_geometric, rise < 0 ? -hit->offset : hit->offset);
}
/* The ray that continues from the hit of `from` in a direction, with the hit's offset from the surface. */
static inline struct ray hit_ray(const struct hit *hit, const struct ray *from, struct vec3 direction,
                                 const struct medium_stack *media) {
    double side = vec3_dot(direction, hit->normal_geometric) < 0 ? -hit->offset : hit->offset;
    struct hit_skip skip = hit_skip_from(hit, side, direction);
    return (struct ray){.origin = hit_start(hit, from, direction),
                        .direction = direction,
                        .t_min = 0,
                        .t_max = INFINITY,
                        .time = from->time,
                        .footprint = {hit->footprint, from->footprint.spread},
                        .media = media,
                        .skip_primitive = skip.primitive,
                        .skip_part = skip.part};
}

#endif
