/* Bump maps after J. Blinn, "Simulation of Wrinkled Surfaces", SIGGRAPH 1978: were the point P moved by F along the
 * normal, the new normal would be N' = N + F_v (P_u x n) + F_u (n x P_v), N = P_u x P_v, where F times the change of n
 * itself is left out as small. This is done in object space, in which heights are given, and transformed as a whole:
 * with n the world vector of one step along the object's normal (hit->raise), the formula holds under any affine map.
 * It is applied to the interpolated normal as a turn by D / |N|, so wrinkles lie on smooth meshes, too.
 *
 * The derivatives of F are central differences of the filtered picture over one texel or one footprint, whichever is
 * more: continuous where the lookup is, and averaged away with distance like colours.
 *
 * Normal maps: red, green and blue are the new normal along the picture's right, its top and the old normal, as glTF
 * 2.0 (section 3.9.3) has them, made orthogonal to the normal. The colour that says "no slope" is 128 of 255, as
 * programs write it. */
#include "material/bump.h"

#include "material/texture_function_internal.h"
#include "material/texture_mapping_internal.h"
#include "math/frame.h"

struct bump bump_make(enum material_kind kind, const struct texture *texture) {
    bool is_normal = kind == MATERIAL_NORMAL;
    return (struct bump){.kind = kind,
                         .height = is_normal ? 1 : BUMP_HEIGHT,
                         .relative = !is_normal && texture_as_image(texture),
                         .texture = texture};
}

static double height_at(const struct texture_image *image, struct texcoord at, double du, double dv) {
    at.u += du;
    at.v += dv;
    struct rgba texel = texture_texel(image, &at);
    return (texel.r + texel.g + texel.b) / 3;
}

/* The distance of the two lookups of the image. */
static double step_of(double width, uint32_t texels) {
    double texel = 1 / (double)texels;
    return width > texel ? math_min(width, 1) : texel;
}

static void turn_by_heights(const struct surface_bump *bump, const struct texture_image *image, const struct hit *hit,
                            struct vec3 *normal) {
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
    double height = bump->relative ? bump->height * sqrt(area) : bump->height;
    struct vec3 up = bump->relative ? hit->normal_geometric : hit->raise;
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

/* The hit moved in its tangent plane, by s along a and t along b in the space of patterns; image coordinates change too
 * if the shape supplies their tangents. */
static struct hit moved(const struct hit *hit, struct vec3 a, struct vec3 b, double s, double t) {
    struct hit out = *hit;
    struct vec3 step = vec3_add(vec3_scale(hit->along_a, s), vec3_scale(hit->along_b, t));
    out.pattern_point = vec3_add_scaled(vec3_add_scaled(hit->pattern_point, a, s), b, t);
    out.pattern_normal =
        vec3_add_scaled(vec3_add_scaled(hit->pattern_normal, a, s * hit->curvature), b, t * hit->curvature);
    double uu = vec3_length_squared(hit->dpdu), vv = vec3_length_squared(hit->dpdv);
    double uv = vec3_dot(hit->dpdu, hit->dpdv), determinant = uu * vv - uv * uv;
    if (!(determinant > 0) || !isfinite(determinant))
        return out;
    double wu = vec3_dot(step, hit->dpdu), wv = vec3_dot(step, hit->dpdv);
    double du = (vv * wu - uv * wv) / determinant, dv = (uu * wv - uv * wu) / determinant;
    out.u += du;
    out.v += dv;
    return out;
}

/* The slopes of the surface along the tangents of the object's space. The differences are as wide as the footprint, at
 * least 2^-17 of the coordinates (the cube root of the rounding error, where central differences are best). */
static bool slopes_by_differences(const struct surface_bump *bump, const struct texture_tables *textures,
                                  const struct hit *hit, double slopes[2]) {
    struct vec3 a, b;
    double step = math_max(0.5 * hit->footprint * hit->pattern_scale, 0x1p-17 * vec3_max_abs(hit->pattern_point));
    if (!(step > 0))
        return false;
    frame_tangents(vec3_normalize(hit->pattern_normal), &a, &b);
    const struct hit at[4] = {moved(hit, a, b, step, 0), moved(hit, a, b, -step, 0), moved(hit, a, b, 0, step),
                              moved(hit, a, b, 0, -step)};
    double height[4], scale = bump->height / (2 * step);
    for (int i = 0; i < 4; i++) {
        struct texture_reader reader;
        texture_reader_init(&reader, &at[i], textures, NULL);
        height[i] = texture_read(bump->program, &reader).r;
    }
    slopes[0] = scale * (height[0] - height[1]);
    slopes[1] = scale * (height[2] - height[3]);
    return true;
}

/* The same formula with the tangents of the object's space. A recorded function has derivatives, except where it
 * jumps. */
static void turn_by_texture(const struct surface_bump *bump, const struct texture_tables *textures,
                            const struct hit *hit, struct vec3 *normal) {
    struct vec3 n = vec3_cross(hit->along_a, hit->along_b);
    double area = vec3_length(n), slopes[2];
    if (!(area > 0) || !isfinite(area))
        return;
    bool has_derivatives = bump->texture != TEXTURE_NONE &&
                           texture_function_slopes(&textures->operations[bump->texture], hit, bump->height, slopes);
    if (!has_derivatives && !slopes_by_differences(bump, textures, hit, slopes))
        return;
    if (slopes[0] == 0 && slopes[1] == 0)
        return;
    struct vec3 up = hit->raise;
    struct vec3 d = vec3_add(vec3_scale(vec3_cross(hit->along_a, up), slopes[1]),
                             vec3_scale(vec3_cross(up, hit->along_b), slopes[0]));
    double outward = vec3_dot(n, hit->normal_geometric) < 0 ? -1 / area : 1 / area;
    struct vec3 turned = vec3_add_scaled(*normal, d, outward);
    if (vec3_length_squared(turned) > 0)
        *normal = vec3_normalize(turned);
}

/* The new normal has x along the right of the image, y along its top and z along the old normal; dpdv goes down. */
static void turn_along(double x, double y, double z, struct vec3 dpdu, struct vec3 dpdv, struct vec3 *normal) {
    struct vec3 n = *normal, right = vec3_add_scaled(dpdu, n, -vec3_dot(dpdu, n));
    if ((x == 0 && y == 0) || !(vec3_length_squared(right) > 0))
        return;
    right = vec3_normalize(right);
    struct vec3 top = vec3_cross(n, right);
    if (vec3_dot(top, dpdv) > 0)
        top = vec3_negate(top);
    struct vec3 turned = vec3_add_scaled(vec3_add_scaled(vec3_scale(n, z), right, x), top, y);
    if (vec3_length_squared(turned) > 0)
        *normal = vec3_normalize(turned);
}

static void turn_to_colours(const struct surface_bump *bump, const struct texture_image *image, const struct hit *hit,
                            struct vec3 *normal) {
    struct texcoord at;
    if (!texture_coordinates(image, hit, &at))
        return;
    struct rgba texel = texture_texel(image, &at);
    double neutral = image_bits(image->image) == 8 ? 128.0 / 255 : 32768.0 / 65535;
    if (!(texel.a > 0))
        return;
    double x = 2 * bump->height * (texel.r / texel.a - neutral);
    double y = 2 * bump->height * (texel.g / texel.a - neutral), z = 2 * texel.b / texel.a - 1;
    turn_along(x, y, z, at.dpdu, at.dpdv, normal);
}

/* The same with the coordinates that the shape supplies; no slope is 0.5, since no file has rounded it. */
static void turn_to_texture(const struct surface_bump *bump, const struct texture_tables *textures,
                            const struct hit *hit, struct vec3 *normal) {
    struct texture_reader reader;
    texture_reader_init(&reader, hit, textures, NULL);
    struct colour colour = texture_read(bump->program, &reader);
    double x = 2 * bump->height * (colour.r - 0.5), y = 2 * bump->height * (colour.g - 0.5);
    struct vec3 down = bump->from_above ? hit->dpdv : vec3_negate(hit->dpdv);
    turn_along(x, y, 2 * colour.b - 1, hit->dpdu, down, normal);
}

static void turn(const struct surface_bump *bump, const struct texture_tables *textures, const struct hit *hit,
                 struct vec3 *normal) {
    const struct texture_operation *single =
        bump->texture != TEXTURE_NONE ? &textures->operations[bump->texture] : NULL;
    bool by_colours = bump->kind == MATERIAL_NORMAL, is_image = single && single->kind == TEXTURE_IMAGE;
    if (by_colours && is_image)
        turn_to_colours(bump, &single->image, hit, normal);
    else if (by_colours)
        turn_to_texture(bump, textures, hit, normal);
    else if (is_image)
        turn_by_heights(bump, &single->image, hit, normal);
    else
        turn_by_texture(bump, textures, hit, normal);
}

static bool turn_all(const struct surface_tables *tables, const struct surface_material *material, bool of_coat,
                     const struct hit *hit, struct vec3 *normal) {
    bool any = false;
    for (uint32_t i = 0; i < material->bump_count; i++) {
        const struct surface_bump *bump = &tables->bumps[material->first_bump + i];
        if (bump->of_coat != of_coat)
            continue;
        turn(bump, &tables->textures, hit, normal);
        any = true;
    }
    return any;
}

void bump_turn_normal(const struct surface_tables *tables, const struct surface_material *material,
                      const struct hit *hit, struct vec3 *normal) {
    (void)turn_all(tables, material, false, hit, normal);
}

bool bump_turn_coat(const struct surface_tables *tables, const struct surface_material *material, const struct hit *hit,
                    struct vec3 *normal) {
    return turn_all(tables, material, true, hit, normal);
}
