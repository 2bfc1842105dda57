/* The triangles of a mesh light, in world space. As a whole (light_mesh_sample) a triangle is chosen in proportion to
 * its area times the luminance of its emission; light samplers choose each triangle for itself
 * (light_triangle_sample). */
#ifndef GRAY_LIGHT_LIGHT_MESH_H
#define GRAY_LIGHT_LIGHT_MESH_H

#include "light/light.h"
#include "math/box.h"

struct light_triangle {
    struct vec3 corner, edge1, edge2, normal; /* normal: unit */
    struct colour intensity;                  /* classic, of its radiance over the density of samples by area */
    double density;                           /* of samples by area */
    double offset;                            /* shadow rays end this far from it */
    uint32_t primitive, part;                 /* its origin: a primitive, and the triangle there */
};
struct light_mesh {
    const struct light_triangle *triangles; /* by primitive, then by part */
    const double *until;                    /* until[i]: share of the unit interval up to and with triangle i */
    uint32_t count;
    bool one_sided; /* normals point outwards, and light comes from that side only */
    bool shown;     /* rays hit the meshes of which it was made */
    struct vec3 centre;
    double radius; /* of a ball around all of it */
};

/* Construction: begin, add each triangle, end. */
struct light_mesh_builder {
    struct light_triangle *triangles;
    double *until;
    uint32_t count;
    bool one_sided;           /* to be set by the caller before the end */
    uint32_t primitive, part; /* of the next triangle; never decreasing */
    struct box bounds;
    double sum; /* of areas times luminances */
};
/* Room for `count` triangles in the arena. False: no memory. */
bool light_mesh_begin(struct light_mesh_builder *builder, uint64_t count, struct arena *arena);
/* corners: world space; sign: -1 to reverse the normal; size: the largest coordinate that the
 * corners were computed from. Triangles without area or light are left out. */
void light_mesh_add(struct light_mesh_builder *builder, const struct vec3 corners[3], double sign, double size,
                    struct colour emission);
/* colour: multiplies all emissions. */
void light_mesh_end(struct light_mesh_builder *builder, struct colour colour, struct light_mesh *out);

/* The triangle made from that part of a primitive; LIGHT_NONE: it emits no light. */
uint32_t light_mesh_find(const struct light_mesh *mesh, uint32_t primitive, uint32_t part);

/* The cases of LIGHT_MESH, for light.c. */
void light_mesh_context(const struct light_mesh *mesh, struct light_context *out);
struct light_sample light_mesh_sample(const struct light_mesh *mesh, const struct light_context *context,
                                      struct sample2 xi);
double light_mesh_pdf(const struct light_mesh *mesh, const struct light_context *context, const struct light_hit *hit);
struct light_photon light_mesh_photon(const struct light_mesh *mesh, struct vec3 direction, struct sample2 xi);
/* Approximately the mean over points and directions. */
struct colour light_mesh_colour(const struct light_mesh *mesh);
/* The radiance of a triangle. */
struct colour light_triangle_radiance(const struct light_triangle *triangle);

/* One triangle, for a point and a ray that starts at `from` next to it: uniform over its solid angle if that is large,
 * otherwise over its area. */
struct light_sample light_triangle_sample(const struct light_mesh *mesh, uint32_t triangle, struct vec3 point,
                                          struct vec3 from, struct sample2 xi);
double light_triangle_pdf(const struct light_mesh *mesh, struct vec3 from, const struct light_hit *hit);
/* The hit of a ray on a triangle, with t in the ray's interval; for meshes that are not in the scene. */
bool light_triangle_meets_ray(const struct light_mesh *mesh, uint32_t triangle, const struct ray *ray,
                              struct light_hit *hit);
struct box light_triangle_box(const struct light_mesh *mesh, uint32_t triangle);
/* Its part of light_bounds_of. */
struct light_bounds;
void light_triangle_bounds(const struct light_mesh *mesh, uint32_t triangle, struct light_bounds *out);

#endif
