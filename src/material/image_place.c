/* The mappings of the language (SPEC 1.2 and 2.1) and those by a shape's own parameters. Lookups are as wide as the
 * ray's cone: the footprint over the speed at which the place moves. */
#include "material/image_place.h"

#include "math/elementary.h"

static const double pi = 3.14159265358979323846;

/* u grows with the angle about y, v from the north pole down (SPEC 1.2, and 2.1 for the classic variant). */
static void place_on_sphere(const struct hit *hit, bool classic, struct image_place *place) {
    struct vec3 from_centre = hit->on_sphere ? hit->pattern_normal : hit->pattern_point;
    struct vec3 p = vec3_normalize(from_centre);
    double y = p.y < -1 ? -1 : p.y > 1 ? 1 : p.y;
    *place = (struct image_place){.wrap_u = IMAGE_REPEAT, .wrap_v = IMAGE_CLAMP};
    if (classic) {
        place->u = 0.5 + el_atan2(p.z, p.x) / (2 * pi);
        place->v = 0.5 - el_asin(y) / pi;
    } else {
        place->u = (el_atan2(-p.z, -p.x) + pi) / (2 * pi);
        place->v = el_acos(y) / pi;
    }
    double radius = hit->on_sphere ? vec3_length(from_centre) : vec3_length(hit->pattern_point);
    double width = radius > 0 ? hit->footprint * hit->pattern_scale / radius : 0;
    double ring = sqrt(1 - y * y);
    place->width_v = width / pi;
    place->width_u = width < 2 * pi * ring ? width / (2 * pi * ring) : width > 0 ? 1 : 0;
    if (hit->on_sphere) {
        place->dpdu = hit->dpdu;
        place->dpdv = hit->dpdv;
    }
}

/* The sides stand upright and alike; front, top and bottom meet at the edges (SPEC 1.2). A box brings these parameters
 * itself; other shapes are seen from the direction of their normal. */
static void place_on_cube(const struct hit *hit, struct image_place *place) {
    struct vec3 p = hit->pattern_point, n = hit->pattern_normal;
    double width = hit->footprint * hit->pattern_scale;
    *place = (struct image_place){.wrap_u = IMAGE_CLAMP, .wrap_v = IMAGE_CLAMP, .width_u = width, .width_v = width};
    if (hit->on_box && hit->has_uv) {
        double du = vec3_length(hit->dpdu), dv = vec3_length(hit->dpdv);
        place->u = hit->u;
        place->v = hit->v;
        place->width_u = du > 0 ? hit->footprint / du : 0;
        place->width_v = dv > 0 ? hit->footprint / dv : 0;
        place->dpdu = hit->dpdu;
        place->dpdv = hit->dpdv;
        return;
    }
    double x = fabs(n.x), y = fabs(n.y), z = fabs(n.z);
    if (z >= x && z >= y) {
        place->u = n.z > 0 ? p.x : 1 - p.x;
        place->v = 1 - p.y;
    } else if (x >= y) {
        place->u = n.x > 0 ? 1 - p.z : p.z;
        place->v = 1 - p.y;
    } else {
        place->u = p.x;
        place->v = n.y > 0 ? p.z : 1 - p.z;
    }
}

/* vt counts v from the bottom of the image (OBJ), image rows from the top. */
static void place_by_uv(const struct hit *hit, const struct material *material, struct image_place *place) {
    double du = vec3_length(hit->dpdu), dv = vec3_length(hit->dpdv);
    *place = (struct image_place){.u = hit->u,
                                  .v = 1 - hit->v,
                                  .width_u = du > 0 ? hit->footprint / du : 0,
                                  .width_v = dv > 0 ? hit->footprint / dv : 0,
                                  .wrap_u = material->image.wrap,
                                  .wrap_v = material->image.wrap,
                                  .dpdu = hit->dpdu,
                                  .dpdv = vec3_negate(hit->dpdv)};
}

/* Several pictures side by side, or a part of one. */
static void stretch(const struct material *material, struct image_place *place) {
    const double *scale = material->image.scale, *offset = material->image.offset;
    place->u = scale[0] * place->u + offset[0];
    place->v = 1 - (scale[1] * (1 - place->v) + offset[1]);
    place->width_u *= fabs(scale[0]);
    place->width_v *= fabs(scale[1]);
    place->dpdu = scale[0] != 0 ? vec3_scale(place->dpdu, 1 / scale[0]) : vec3_all(0);
    place->dpdv = scale[1] != 0 ? vec3_scale(place->dpdv, 1 / scale[1]) : vec3_all(0);
    place->wrap_u = material->image.wrap;
    place->wrap_v = material->image.wrap_v;
}

bool image_place(const struct material *material, const struct hit *hit, struct image_place *out) {
    switch (material->image.mapping) {
    case MAPPING_SPHERE:
        place_on_sphere(hit, false, out);
        break;
    case MAPPING_SPHERE_CLASSIC:
        place_on_sphere(hit, true, out);
        break;
    case MAPPING_CUBE:
        place_on_cube(hit, out);
        break;
    case MAPPING_UV:
    case MAPPING_BY_SHAPE:
        if (hit->on_sphere)
            place_on_sphere(hit, material->image.mapping == MAPPING_UV, out);
        else if (!hit->has_uv)
            return false;
        else if (hit->on_box)
            place_on_cube(hit, out);
        else
            place_by_uv(hit, material, out);
        break;
    }
    if (material->image.apart)
        stretch(material, out);
    if (material->image.flip_u) {
        out->u = 1 - out->u;
        out->dpdu = vec3_negate(out->dpdu);
    }
    return true;
}

struct rgba image_at(const struct material *material, const struct image_place *place) {
    return image_lookup(material->image.image, place->u, place->v, place->width_u, place->width_v,
                        material->image.filter, place->wrap_u, place->wrap_v);
}
