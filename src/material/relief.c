/* Bump maps after J. Blinn, "Simulation of Wrinkled Surfaces", SIGGRAPH 1978: were the point P moved by F along the
 * normal, the new normal would be N' = N + F_v (P_u x n) + F_u (n x P_v), N = P_u x P_v, where F times the change of n
 * itself is left out as small. That is done in the object's own space, where heights are told, and mapped as a whole:
 * with n the world vector of one step along the object's normal (hit->raise), the formula holds under any affine map.
 * It is applied to the interpolated normal as a turn by D / |N|, so wrinkles lie on smooth meshes, too.
 *
 * The derivatives of F are central differences of the filtered picture over one texel or one footprint, whichever is
 * more: continuous where the lookup is, and averaged away with distance like colours.
 *
 * Normal maps: red, green and blue are the new normal along the picture's right, its top and the old normal, as glTF
 * 2.0 (section 3.9.3) has them, made orthogonal to the normal. The colour that says "no slope" is 128 of 255, as
 * programs write it. */
#include "material/relief.h"

#include "material/texture_mapping.h"

static double height_at(const struct texture_image *image, struct texcoord at, double du, double dv) {
    at.u += du;
    at.v += dv;
    struct rgba texel = texture_texel(image, &at);
    return (texel.r + texel.g + texel.b) / 3;
}

/* How far the two looks at the picture are apart. */
static double step_of(double width, uint32_t texels) {
    double texel = 1 / (double)texels;
    return width > texel ? fmin(width, 1) : texel;
}

static void turn_by_heights(const struct relief *relief, const struct hit *hit, struct vec3 *normal) {
    const struct texture_image *image = &relief->image;
    struct texcoord at;
    if (!texture_coordinates(image, hit, &at))
        return;
    struct vec3 n = vec3_cross(at.dpdu, at.dpdv);
    double area = vec3_length(n);
    if (!(area > 0) || !isfinite(area))
        return;
    double step_u = step_of(at.width_u, image_width(image->image));
    double step_v = step_of(at.width_v, image_height(image->image));
    double f_u = height_at(image, at, 0.5 * step_u, 0) - height_at(image, at, -0.5 * step_u, 0);
    double f_v = height_at(image, at, 0, 0.5 * step_v) - height_at(image, at, 0, -0.5 * step_v);
    double height = relief->relative ? relief->height * sqrt(area) : relief->height;
    struct vec3 up = relief->relative ? hit->normal_geometric : hit->raise;
    f_u *= height / step_u;
    f_v *= height / step_v;
    if (f_u == 0 && f_v == 0)
        return;
    struct vec3 d = vec3_add(vec3_scale(vec3_cross(at.dpdu, up), f_v), vec3_scale(vec3_cross(up, at.dpdv), f_u));
    double outward = vec3_dot(n, hit->normal_geometric) < 0 ? -1 / area : 1 / area;
    struct vec3 turned = vec3_add_scaled(*normal, d, outward);
    if (vec3_length_squared(turned) > 0)
        *normal = vec3_normalize(turned);
}

static void turn_to_colours(const struct relief *relief, const struct hit *hit, struct vec3 *normal) {
    struct texcoord at;
    if (!texture_coordinates(&relief->image, hit, &at))
        return;
    struct rgba texel = texture_texel(&relief->image, &at);
    double flat = image_bits(relief->image.image) == 8 ? 128.0 / 255 : 32768.0 / 65535;
    if (!(texel.a > 0))
        return;
    double x = 2 * relief->height * (texel.r / texel.a - flat);
    double y = 2 * relief->height * (texel.g / texel.a - flat), z = 2 * texel.b / texel.a - 1;
    struct vec3 n = *normal, right = vec3_add_scaled(at.dpdu, n, -vec3_dot(at.dpdu, n));
    if ((x == 0 && y == 0) || !(vec3_length_squared(right) > 0))
        return;
    right = vec3_normalize(right);
    struct vec3 top = vec3_cross(n, right);
    if (vec3_dot(top, at.dpdv) > 0)
        top = vec3_negate(top);
    struct vec3 turned = vec3_add_scaled(vec3_add_scaled(vec3_scale(n, z), right, x), top, y);
    if (vec3_length_squared(turned) > 0)
        *normal = vec3_normalize(turned);
}

void relief_turn(const struct relief *relief, const struct hit *hit, struct vec3 *normal) {
    if (relief->below)
        relief_turn(relief->below, hit, normal);
    if (relief->kind == MATERIAL_NORMAL)
        turn_to_colours(relief, hit, normal);
    else
        turn_by_heights(relief, hit, normal);
}
