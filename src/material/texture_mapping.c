/* The mappings of the language (docs/language.md 6.2) and those by the coordinates that a shape supplies. Lookups are
 * as wide as the ray's cone: the footprint divided by the derivative of the position with respect to u and v. */
#include "material/texture_mapping_internal.h"

#include "math/elementary.h"

enum texture_mapping texture_mapping_on(enum texture_mapping mapping, enum surface_layout layout) {
    static const enum texture_mapping on[][SURFACE_LAYOUTS] = {
        [MAPPING_SPHERE] = {MAPPING_SPHERE, MAPPING_SPHERE, MAPPING_BALL},
        [MAPPING_CUBE] = {MAPPING_CUBE, MAPPING_FACES, MAPPING_CUBE},
        [MAPPING_UV] = {MAPPING_UV, MAPPING_FACES, MAPPING_BALL_CLASSIC},
        [MAPPING_BY_SHAPE] = {MAPPING_UV, MAPPING_FACES, MAPPING_BALL},
        [MAPPING_FACES] = {MAPPING_FACES, MAPPING_FACES, MAPPING_FACES},
        [MAPPING_BALL] = {MAPPING_BALL, MAPPING_BALL, MAPPING_BALL},
        [MAPPING_BALL_CLASSIC] = {MAPPING_BALL_CLASSIC, MAPPING_BALL_CLASSIC, MAPPING_BALL_CLASSIC}};
    return on[mapping][layout];
}

/* u grows with the angle about y, v from the north pole down (docs/language.md 6.2). */
static void by_direction(const struct hit *hit, struct vec3 direction, bool classic, struct texcoord *at) {
    struct vec3 p = vec3_normalize(direction);
    double y = p.y < -1 ? -1 : p.y > 1 ? 1 : p.y;
    *at = (struct texcoord){.wrap_u = IMAGE_REPEAT, .wrap_v = IMAGE_CLAMP};
    if (classic) {
        at->u = 0.5 + el_atan2(p.z, p.x) / (2 * PI);
        at->v = 0.5 - el_asin(y) / PI;
    } else {
        at->u = (el_atan2(-p.z, -p.x) + PI) / (2 * PI);
        at->v = el_acos(y) / PI;
    }
    double radius = vec3_length(direction);
    double width = radius > 0 ? hit->footprint * hit->pattern_scale / radius : 0;
    double ring = sqrt(1 - y * y);
    at->width_v = width / PI;
    at->width_u = width < 2 * PI * ring ? width / (2 * PI * ring) : width > 0 ? 1 : 0;
}

/* The pattern_normal of a ball points from its centre. */
static void on_ball(const struct hit *hit, bool classic, struct texcoord *at) {
    by_direction(hit, hit->pattern_normal, classic, at);
    at->dpdu = hit->dpdu;
    at->dpdv = hit->dpdv;
}

/* A hit of a box contains the parameters of on_cube already. */
static void on_faces(const struct hit *hit, struct texcoord *at) {
    double du = vec3_length(hit->dpdu), dv = vec3_length(hit->dpdv);
    *at = (struct texcoord){.u = hit->u,
                            .v = hit->v,
                            .width_u = du > 0 ? hit->footprint / du : 0,
                            .width_v = dv > 0 ? hit->footprint / dv : 0,
                            .wrap_u = IMAGE_CLAMP,
                            .wrap_v = IMAGE_CLAMP,
                            .dpdu = hit->dpdu,
                            .dpdv = hit->dpdv};
}

/* The sides are upright and alike; front, top and bottom meet at the edges (docs/language.md 6.2). Shapes are seen
 * from the direction of their normal. */
static void on_cube(const struct hit *hit, struct texcoord *at) {
    struct vec3 p = hit->pattern_point, n = hit->pattern_normal;
    double width = hit->footprint * hit->pattern_scale;
    *at = (struct texcoord){.wrap_u = IMAGE_CLAMP, .wrap_v = IMAGE_CLAMP, .width_u = width, .width_v = width};
    double x = fabs(n.x), y = fabs(n.y), z = fabs(n.z);
    if (z >= x && z >= y) {
        at->u = n.z > 0 ? p.x : 1 - p.x;
        at->v = 1 - p.y;
    } else if (x >= y) {
        at->u = n.x > 0 ? 1 - p.z : p.z;
        at->v = 1 - p.y;
    } else {
        at->u = p.x;
        at->v = n.y > 0 ? p.z : 1 - p.z;
    }
}

/* vt counts v from the bottom of the image (OBJ), image rows from the top. */
static void by_uv(const struct hit *hit, const struct texture_image *image, struct texcoord *at) {
    struct second_uv uv = {hit->u, hit->v, hit->dpdu, hit->dpdv};
    if (image->second)
        uv = hit->second;
    double du = vec3_length(uv.dpdu), dv = vec3_length(uv.dpdv);
    *at = (struct texcoord){.u = uv.u,
                            .v = 1 - uv.v,
                            .width_u = du > 0 ? hit->footprint / du : 0,
                            .width_v = dv > 0 ? hit->footprint / dv : 0,
                            .wrap_u = image->wrap,
                            .wrap_v = image->wrap,
                            .dpdu = uv.dpdu,
                            .dpdv = vec3_negate(uv.dpdv)};
}

/* The linear map of a turned image; the derivatives follow its inverse. */
static void turn(const struct texture_image *image, struct texcoord *at) {
    const double *scale = image->scale, *cross = image->cross;
    double u = at->u, v = 1 - at->v, width_u = at->width_u, width_v = at->width_v;
    double determinant = scale[0] * scale[1] - cross[0] * cross[1], per = determinant != 0 ? 1 / determinant : 0;
    struct vec3 along_u = at->dpdu, along_v = vec3_negate(at->dpdv);
    at->u = scale[0] * u + cross[0] * v + image->offset[0];
    at->v = 1 - (cross[1] * u + scale[1] * v + image->offset[1]);
    at->width_u = fabs(scale[0]) * width_u + fabs(cross[0]) * width_v;
    at->width_v = fabs(cross[1]) * width_u + fabs(scale[1]) * width_v;
    at->dpdu = vec3_scale(vec3_add_scaled(vec3_scale(along_u, scale[1]), along_v, -cross[1]), per);
    at->dpdv = vec3_scale(vec3_add_scaled(vec3_scale(along_v, -scale[0]), along_u, cross[0]), per);
}

/* Repetitions of an image, or a part of it. */
static void stretch(const struct texture_image *image, struct texcoord *at) {
    const double *scale = image->scale, *offset = image->offset;
    at->wrap_u = image->wrap;
    at->wrap_v = image->wrap_v;
    if (image->cross[0] != 0 || image->cross[1] != 0) {
        turn(image, at);
        return;
    }
    at->u = scale[0] * at->u + offset[0];
    at->v = 1 - (scale[1] * (1 - at->v) + offset[1]);
    at->width_u *= fabs(scale[0]);
    at->width_v *= fabs(scale[1]);
    at->dpdu = scale[0] != 0 ? vec3_scale(at->dpdu, 1 / scale[0]) : vec3_all(0);
    at->dpdv = scale[1] != 0 ? vec3_scale(at->dpdv, 1 / scale[1]) : vec3_all(0);
}

static void mirror(struct texcoord *at) {
    at->u = 1 - at->u;
    at->dpdu = vec3_negate(at->dpdu);
}

static bool is_spherical(enum texture_mapping mapping) {
    switch (mapping) {
    case MAPPING_SPHERE:
    case MAPPING_BALL:
    case MAPPING_BALL_CLASSIC:
        return true;
    case MAPPING_CUBE:
    case MAPPING_UV:
    case MAPPING_BY_SHAPE:
    case MAPPING_FACES:
        break;
    }
    return false;
}

bool texture_coordinates(const struct texture_image *image, const struct hit *hit, struct texcoord *out) {
    switch (image->mapping) {
    case MAPPING_SPHERE:
        by_direction(hit, hit->pattern_point, false, out);
        break;
    case MAPPING_CUBE:
        on_cube(hit, out);
        break;
    case MAPPING_UV:
    case MAPPING_BY_SHAPE:
        if (!hit->has_uv || (image->second && !hit->has_second))
            return false;
        by_uv(hit, image, out);
        break;
    case MAPPING_FACES:
        on_faces(hit, out);
        break;
    case MAPPING_BALL:
        on_ball(hit, false, out);
        break;
    case MAPPING_BALL_CLASSIC:
        on_ball(hit, true, out);
        break;
    }
    if (image->outside && is_spherical(image->mapping))
        mirror(out);
    if (image->apart)
        stretch(image, out);
    if (image->flip_u)
        mirror(out);
    return true;
}

struct rgba texture_texel(const struct texture_image *image, const struct texcoord *at) {
    return image_lookup(image->image, (struct image_point){at->u, at->v, at->width_u, at->width_v},
                        (struct image_sampling){image->filter, at->wrap_u, at->wrap_v});
}
