/* The triangles of a lamp that is a mesh, in world space. A triangle is drawn in proportion to its area times the
 * luminance of its emission. */
#ifndef GRAY_LIGHT_LIGHT_MESH_H
#define GRAY_LIGHT_LIGHT_MESH_H

#include "light/light.h"
#include "math/box.h"

struct light_triangle {
    struct vec3 corner, edge1, edge2, normal; /* normal: unit */
    struct vec3 intensity;                    /* classic, of its radiance over the density of samples by area */
    double density;                           /* of samples by area */
    double offset;                            /* shadow rays end this far from it */
    uint32_t primitive, part;                 /* what it was made of: a primitive, and which triangle there */
};
struct light_mesh {
    const struct light_triangle *triangles; /* by primitive, then by part */
    const double *until;                    /* until[i]: share of the unit interval up to and with triangle i */
    uint32_t count;
    bool one_sided; /* normals point outwards, and light comes from that side only */
    bool shown;     /* rays meet the meshes that it was made of */
    struct vec3 centre;
    double radius; /* of a ball round all of it */
};

/* How a mesh is made: begin, add each triangle, end. */
struct light_mesh_builder {
    struct light_triangle *triangles;
    double *until;
    uint32_t count;
    bool one_sided;           /* to be set by the caller before the end */
    uint32_t primitive, part; /* of the triangle that is added next; never falling */
    struct box bounds;
    double sum; /* of areas times luminances */
};
/* Room for `count` triangles in the arena. False: no memory. */
bool light_mesh_begin(struct light_mesh_builder *builder, uint64_t count, struct arena *arena);
/* corners: world space; sign: -1 where the normal is to point to the other side; size: the largest coordinate that the
 * corners were computed from. Triangles without area or light are left out. */
void light_mesh_add(struct light_mesh_builder *builder, const struct vec3 corners[3], double sign, double size,
                    struct vec3 emission);
/* colour: multiplies all emissions. */
void light_mesh_end(struct light_mesh_builder *builder, struct vec3 colour, struct light_mesh *out);

/* The triangle that was made of that part of a primitive; LIGHT_NONE: it sends no light. */
uint32_t light_mesh_find(const struct light_mesh *mesh, uint32_t primitive, uint32_t part);

/* A place on it, for one in the unit square: uniform on the triangle that the place's x falls on. */
struct light_point {
    const struct light_triangle *triangle;
    struct vec3 xi;
};
struct light_point light_mesh_point(const struct light_mesh *mesh, struct sample2 xi);
/* The cases of LIGHT_MESH, for light.c. */
void light_mesh_context(const struct light_mesh *mesh, struct light_context *out);
struct light_sample light_mesh_sample(const struct light_mesh *mesh, const struct light_context *context,
                                      struct sample2 xi);
double light_mesh_pdf(const struct light_mesh *mesh, const struct light_context *context, const struct light_hit *hit);
struct light_photon light_mesh_photon(const struct light_mesh *mesh, struct vec3 direction, struct sample2 xi);
/* The mean over places and directions, about. */
struct vec3 light_mesh_colour(const struct light_mesh *mesh);
/* Its part of light_bounds_of. */
struct light_bounds;
void light_mesh_bounds(const struct light_mesh *mesh, struct light_bounds *out);
/* The radiance of a triangle. */
struct vec3 light_triangle_radiance(const struct light_triangle *triangle);

#endif
