/* A ray at the surface between two media: the same for camera rays and for photons. */
#ifndef GRAY_RENDER_INTERFACE_H
#define GRAY_RENDER_INTERFACE_H

#include "material/material.h"
#include "render/media.h"

struct interface {
    struct vec3 side, geometric_side; /* the normals, unit, turned to where the ray came from */
    bool passes;                      /* refracted light gets through; the three below hold */
    struct vec3 through;              /* unit direction behind the surface, of a smooth one */
    double eta;                       /* index on the ray's side / index behind */
    struct medium_stack behind;
};

/* Turns the normals; for a look that refracts also finds what is behind, and Fresnel's share of both amounts. */
void interface_make(const struct hit *hit, const struct medium_stack *media, struct surface_look *look,
                    struct interface *out);
/* Directions (unit) of a smooth surface's mirror, and of what one facet of a rough surface reflects and refracts. */
struct vec3 interface_mirror(const struct interface *interface, struct vec3 view);
struct vec3 interface_facet_mirror(const struct interface *interface, struct vec3 facet, struct vec3 view);
struct vec3 interface_facet_through(const struct interface *interface, struct vec3 facet, struct vec3 view);
/* The ray that goes on in `direction`, off the surface by the hit's own offset. */
struct ray interface_ray(const struct hit *hit, const struct ray *from, struct vec3 direction,
                         const struct medium_stack *media);

#endif
