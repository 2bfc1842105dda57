/* The complete description of the one crossing that survives. */
#ifndef GRAY_GEOM_HIT_H
#define GRAY_GEOM_HIT_H

#include "math/vec3.h"

#include <stdbool.h>
#include <stdint.h>

/* A surface point in the object space of the shape, filled by shape_describe. */
struct surface {
    struct vec3 point;          /* in the shape's object space */
    struct vec3 normal;         /* geometric, outward (of the CSG result), any length > 0 */
    struct vec3 shading_normal; /* interpolated where the mesh has vertex normals, else = normal; any length > 0 */
    struct vec3 pattern_point;  /* in the object space of the operand that made the surface (= point outside CSG) */
    struct vec3 pattern_normal; /* geometric, in that space, as the operand has it (not flipped) */
    bool has_uv;
    bool has_colour;
    struct vec3 colour; /* of the vertices, interpolated */
    double u, v;
    struct vec3 dpdu, dpdv; /* object space; zero when has_uv is false */
    double error;  /* bound of the distance between `point` and the true surface, object units, from rounding */
    uint32_t leaf; /* CSG operand, else 0 */
    uint32_t material_slot; /* per-face materials of a mesh; 0 = the only one */
};

struct hit {
    double t;
    struct vec3 point;            /* world */
    struct vec3 view;             /* unit, to where the ray came from */
    struct vec3 normal_geometric; /* unit, outward, world */
    struct vec3 normal;           /* unit, interpolated where there are vertex normals; outward side as given */
    struct vec3 pattern_point, pattern_normal;
    bool has_uv, has_colour;
    struct vec3 colour; /* of the vertices, interpolated */
    double u, v;
    struct vec3 dpdu, dpdv; /* world */
    struct vec3 raise;      /* what one unit along the operand's outward normal is in the world; where relief asks */
    double offset;          /* a secondary ray starts this far (world units) from point along the normal */
    double footprint;       /* diameter of the ray's cone here, world units; 0 = unknown */
    double pattern_scale;   /* pattern-space units per world unit (largest stretch); for filtering */
    bool front;             /* the ray came from outside: dot(view, normal_geometric) >= 0 */
    uint32_t placed;        /* index of the placed primitive */
    uint32_t leaf, part;
    uint32_t material;      /* index into the world's materials */
    bool on_sphere, on_box; /* what kind of shape (CSG: operand) made the surface; some mappings depend on it */
    double time;
};

#endif
