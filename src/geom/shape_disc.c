/* The disc: of the plane's points those whose distance from the centre, by Pythagoras in units of the radius, lies
 * between that of the hole and 1. */
#include "geom/shape_disc.h"

struct flat flat_disc(struct vec3 centre, struct vec3 normal, double radius, double inner) {
    struct flat f = {.kind = FLAT_DISC, .origin = centre, .normal = vec3_normalize(normal), .inner = inner / radius};
    flat_across(f.normal, &f.u, &f.v);
    f.u = vec3_scale(f.u, radius);
    f.v = vec3_scale(f.v, radius);
    return f;
}

void disc_image(const struct flat *f, struct surface *out) {
    out->u = (1 + out->u) / 2;
    out->v = (1 + out->v) / 2;
    out->dpdu = vec3_scale(f->u, 2);
    out->dpdv = vec3_scale(f->v, 2);
}
