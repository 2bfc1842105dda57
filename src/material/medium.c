/* See medium.h. */
#include "material/medium.h"

#include "math/elementary.h"

/* The law of Beer, Lambert and Bouguer. */
static struct vec3 absorption_transmittance(const struct medium *medium, double distance) {
    struct vec3 a = medium->absorption;
    return (struct vec3){a.x > 0 ? el_exp(-a.x * distance) : 1, a.y > 0 ? el_exp(-a.y * distance) : 1,
                         a.z > 0 ? el_exp(-a.z * distance) : 1};
}

bool medium_transmittance(enum medium_ray kind, const struct fog *fog, const struct ray *ray, double distance,
                          struct medium_effect *out) {
    out->transmittance = vec3_all(1);
    out->source = vec3_all(0);
    if (ray->media && ray->media->count > 0) {
        if (!(ABSORPTION_AFFECTS & kind))
            return false;
        out->transmittance = absorption_transmittance(&ray->media->entries[ray->media->count - 1], distance);
        return true;
    }
    if (!fog || !(FOG_AFFECTS & kind) || (fog->clear_sky && distance == INFINITY))
        return false;
    struct vec3 direction = vec3_scale(ray->direction, 1 / vec3_length(ray->direction));
    out->transmittance = vec3_all(fog_transmittance(fog, ray->origin, direction, distance));
    out->source = fog->colour;
    return true;
}
