/* Snell, Fresnel, the stack of media, and rough surfaces as facets. No energy is lost at a rough surface: light that a
 * facet sends to the wrong side is turned back, as by one more facet, and a facet that reflects totally where the
 * surface as a whole does not gives way to the surface. */
#include "render/interface.h"

void interface_make(const struct hit *hit, const struct medium_stack *media, struct surface_look *look,
                    struct interface *out) {
    /* The ray's side of the surface; interpolated normals follow the geometric one. */
    out->geometric_side = hit->front ? hit->normal_geometric : vec3_negate(hit->normal_geometric);
    out->side = hit->front ? look->normal : vec3_negate(look->normal);
    if (!(vec3_dot(out->side, hit->view) > 0))
        out->side = out->geometric_side;
    out->passes = false;
    if (!look->fresnel && look->refract == 0)
        return;
    struct medium medium = {hit->placed, look->has_ior ? look->ior : 1, look->absorption};
    struct medium_boundary boundary = {medium, hit->front};
    out->eta = medium_stack_eta(media, &boundary);
    medium_stack_copy(&out->behind, media);
    medium_stack_cross(&out->behind, &boundary);
    out->passes = shading_refract(out->side, hit->view, out->eta, &out->through);
    /* About an interpolated normal the ray may not leave its side of the surface: the geometric one takes over. */
    if (out->passes && vec3_dot(out->through, out->geometric_side) >= 0)
        out->passes = shading_refract(out->geometric_side, hit->view, out->eta, &out->through);
    if (look->fresnel) {
        look->reflect = shading_fresnel(vec3_dot(out->side, hit->view), out->eta);
        look->refract = 1 - look->reflect;
    }
}

/* A reflection about an interpolated normal may point into the surface: the geometric normal then takes its place. */
struct vec3 interface_mirror(const struct interface *interface, struct vec3 view) {
    struct vec3 direction = shading_reflect(interface->side, view);
    return vec3_dot(direction, interface->geometric_side) > 0 ? direction
                                                              : shading_reflect(interface->geometric_side, view);
}

static struct vec3 fold(struct vec3 direction, struct vec3 to_side) {
    double height = vec3_dot(direction, to_side);
    return height < 0 ? vec3_add_scaled(direction, to_side, -2 * height) : direction;
}

struct vec3 interface_facet_mirror(const struct interface *interface, struct vec3 facet, struct vec3 view) {
    return fold(shading_reflect(facet, view), interface->geometric_side);
}

struct vec3 interface_facet_through(const struct interface *interface, struct vec3 facet, struct vec3 view) {
    struct vec3 direction;
    if (!shading_refract(facet, view, interface->eta, &direction))
        return interface->through;
    return fold(direction, vec3_negate(interface->geometric_side));
}

struct ray interface_ray(const struct hit *hit, const struct ray *from, struct vec3 direction,
                         const struct medium_stack *media) {
    double side = vec3_dot(direction, hit->normal_geometric) < 0 ? -hit->offset : hit->offset;
    return (struct ray){.origin = vec3_add_scaled(hit->point, hit->normal_geometric, side),
                        .direction = direction,
                        .t_min = 0,
                        .t_max = INFINITY,
                        .time = from->time,
                        .footprint = {hit->footprint, from->footprint.spread},
                        .media = media,
                        .passes = hit_passes(hit, direction)};
}
