/* See light_mesh.h. A light sample has the radiance divided by the density of samples. */
#include "light/light_mesh.h"

#include "base/arena.h"
#include "light/light_shapes_internal.h"
#include "math/frame.h"
#include "math/sampling.h"

#include <math.h>

/* Its reciprocal is the largest finite one. */
static const double dark = 1e-300;

bool light_mesh_begin(struct light_mesh_builder *builder, uint64_t count, struct arena *arena) {
    *builder = (struct light_mesh_builder){.one_sided = true, .bounds = box_empty()};
    builder->triangles = arena_alloc_array(arena, count, sizeof *builder->triangles);
    builder->until = arena_alloc_array(arena, count, sizeof *builder->until);
    return builder->triangles && builder->until;
}

void light_mesh_add(struct light_mesh_builder *builder, const struct vec3 corners[3], double sign, double size,
                    struct colour emission) {
    struct light_triangle *t = &builder->triangles[builder->count];
    t->corner = corners[0];
    t->edge1 = vec3_sub(corners[1], corners[0]);
    t->edge2 = vec3_sub(corners[2], corners[0]);
    struct vec3 across = vec3_cross(t->edge1, t->edge2);
    double luminance = light_luminance(emission), area = vec3_length(across) / 2, weight = area * luminance;
    if (!(weight > 0) || area < dark || luminance < dark)
        return;
    t->normal = vec3_scale(across, sign / (2 * area));
    t->intensity = colour_scale(emission, 1 / radiance_of(luminance)); /* times the sum, once it is known */
    t->density = luminance;                                            /* over the sum */
    t->offset = size * 0x1p-40;
    t->primitive = builder->primitive;
    t->part = builder->part;
    for (int i = 0; i < 3; i++)
        builder->bounds = box_add_point(builder->bounds, corners[i]);
    builder->sum += weight;
    builder->until[builder->count++] = builder->sum;
}

void light_mesh_end(struct light_mesh_builder *builder, struct colour colour, struct light_mesh *out) {
    for (uint32_t i = 0; i < builder->count; i++) {
        struct light_triangle *t = &builder->triangles[i];
        builder->until[i] = i + 1 < builder->count ? builder->until[i] / builder->sum : 1;
        t->intensity = colour_mul(colour_scale(t->intensity, builder->sum), colour);
        t->density /= builder->sum;
    }
    *out = (struct light_mesh){.triangles = builder->triangles,
                               .until = builder->until,
                               .count = builder->count,
                               .one_sided = builder->one_sided};
    if (builder->count > 0) {
        out->centre = vec3_scale(vec3_add(builder->bounds.min, builder->bounds.max), 0.5);
        out->radius = vec3_length(vec3_sub(builder->bounds.max, out->centre)) * (1 + 0x1p-40);
    }
}

static bool is_before(const struct light_triangle *t, uint32_t primitive, uint32_t part) {
    return t->primitive != primitive ? t->primitive < primitive : t->part < part;
}

/* The first triangle that is not before that part. */
static uint32_t first_from(const struct light_mesh *mesh, uint32_t primitive, uint32_t part) {
    uint32_t low = 0, high = mesh->count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (is_before(&mesh->triangles[middle], primitive, part))
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

uint32_t light_mesh_find(const struct light_mesh *mesh, uint32_t primitive, uint32_t part) {
    uint32_t first = first_from(mesh, primitive, part);
    const struct light_triangle *t = &mesh->triangles[first];
    return first < mesh->count && t->primitive == primitive && t->part == part ? first : LIGHT_NONE;
}

/* Uniform over the triangle, for x and y of the unit interval. */
static struct vec3 triangle_point(const struct light_triangle *t, double x, double y) {
    double root = sqrt(x < 1 ? x : 1);
    struct vec3 point = vec3_add_scaled(t->corner, t->edge1, root * (1 - y));
    return vec3_add_scaled(point, t->edge2, root * y);
}

/* A point of the mesh for a point of the unit square: uniform on the triangle selected by xi.x. */
struct light_point {
    const struct light_triangle *triangle;
    struct vec3 xi;
};

/* xi.x, rescaled to the unit interval within the share of its triangle. */
static struct light_point light_mesh_point(const struct light_mesh *mesh, struct sample2 xi) {
    uint64_t chosen = sample_entry(mesh->until, mesh->count, xi.x);
    double begin = chosen > 0 ? mesh->until[chosen - 1] : 0, share = mesh->until[chosen] - begin;
    double x = share > 0 ? (xi.x - begin) / share : 0.5;
    const struct light_triangle *t = &mesh->triangles[chosen];
    return (struct light_point){t, triangle_point(t, x, xi.y)};
}

struct colour light_triangle_radiance(const struct light_triangle *triangle) {
    return colour_scale(triangle->intensity, radiance_of(triangle->density));
}

/* A square behind the mesh, perpendicular to the cone of its ball; none for a point in the ball. */
void light_mesh_context(const struct light_mesh *mesh, struct light_context *out) {
    struct vec3 to_centre = vec3_sub(mesh->centre, out->from);
    double distance = vec3_length(to_centre), sine = mesh->radius / distance;
    out->bounded = sine < 0.999;
    if (!out->bounded)
        return;
    out->axis = vec3_scale(to_centre, 1 / distance);
    frame_tangents(out->axis, &out->right, &out->up);
    double behind = (distance + mesh->radius) * 1.001;
    light_context_square(out, vec3_add_scaled(out->from, out->axis, behind),
                         behind * sine / sqrt((1 - sine) * (1 + sine)));
}

/* A point of a triangle that is sampled with that density by area. */
static struct light_sample sample_at(const struct light_mesh *mesh, const struct light_triangle *t, struct vec3 at,
                                     struct vec3 point, struct vec3 from, double density) {
    struct vec3 away = vec3_sub(from, at);
    double squared = vec3_length_squared(away), across = vec3_dot(t->normal, away);
    double weight = squared > 0 && (across > 0 || !mesh->one_sided) ? fabs(across) / (squared * sqrt(squared)) : 0;
    struct vec3 target = vec3_add_scaled(at, t->normal, across > 0 ? t->offset : -t->offset);
    return (struct light_sample){.direction = vec3_normalize(vec3_sub(target, point)),
                                 .target = {target, false},
                                 .radiance = light_triangle_radiance(t),
                                 .pdf = weight > 0 ? density / weight : 0,
                                 .intensity = colour_scale(t->intensity, weight),
                                 .triangle = (uint32_t)(t - mesh->triangles)};
}

struct light_sample light_mesh_sample(const struct light_mesh *mesh, const struct light_context *context,
                                      struct sample2 xi) {
    struct light_point at = light_mesh_point(mesh, xi);
    return sample_at(mesh, at.triangle, at.xi, context->point, context->from, at.triangle->density);
}

/* By solid angle, of a density by area. */
static double pdf_at(const struct light_mesh *mesh, struct vec3 from, const struct light_hit *hit, double density) {
    const struct light_triangle *t = &mesh->triangles[hit->triangle];
    struct vec3 away = vec3_sub(from, hit->point);
    bool back = mesh->one_sided && !(vec3_dot(t->normal, away) > 0);
    double weight = back ? 0 : weight_of_area(1, t->normal, away);
    return weight > 0 ? density / weight : 0;
}

double light_mesh_pdf(const struct light_mesh *mesh, const struct light_context *context, const struct light_hit *hit) {
    return pdf_at(mesh, context->from, hit, mesh->triangles[hit->triangle].density);
}

struct colour light_mesh_colour(const struct light_mesh *mesh) {
    struct colour sum = {0, 0, 0};
    for (uint32_t i = 0; i < mesh->count; i++)
        sum = colour_add_scaled(sum, mesh->triangles[i].intensity, mesh->until[i] - (i > 0 ? mesh->until[i - 1] : 0));
    return colour_scale(sum, mesh->one_sided ? 0.25 : 0.5);
}

struct light_photon light_mesh_photon(const struct light_mesh *mesh, struct vec3 direction, struct sample2 xi) {
    struct light_point point = light_mesh_point(mesh, xi);
    const struct light_triangle *t = point.triangle;
    double cosine = vec3_dot(t->normal, direction), side = cosine > 0 ? t->offset : -t->offset;
    double shines = cosine > 0 || !mesh->one_sided ? fabs(cosine) : 0;
    return (struct light_photon){vec3_add_scaled(point.xi, t->normal, side), direction,
                                 colour_scale(t->intensity, shines)};
}

/* --- one triangle --- */

static double triangle_area(const struct light_triangle *t) {
    return vec3_length(vec3_cross(t->edge1, t->edge2)) / 2;
}

/* Whether a triangle appears so large that samples by solid angle have less noise than samples by area, and how to
 * sample it. If its edges are below a third of the distance, samples by area already have nearly equal weights. */
static bool is_large(const struct light_triangle *t, struct vec3 from, struct spherical_triangle *seen) {
    double squared = vec3_length_squared(vec3_sub(t->corner, from));
    double edges = vec3_length_squared(t->edge1) + vec3_length_squared(t->edge2);
    return 8 * edges > squared && spherical_triangle_make(t->corner, t->edge1, t->edge2, from, seen);
}

struct light_sample light_triangle_sample(const struct light_mesh *mesh, uint32_t triangle, struct vec3 point,
                                          struct vec3 from, struct sample2 xi) {
    const struct light_triangle *t = &mesh->triangles[triangle];
    struct spherical_triangle seen;
    if (!is_large(t, from, &seen))
        return sample_at(mesh, t, triangle_point(t, xi.x, xi.y), point, from, 1 / triangle_area(t));
    struct light_sample sample = sample_at(mesh, t, spherical_triangle_point(&seen, xi), point, from, 1);
    sample.pdf = sample.pdf > 0 ? 1 / seen.angle : 0;
    return sample;
}

double light_triangle_pdf(const struct light_mesh *mesh, struct vec3 from, const struct light_hit *hit) {
    const struct light_triangle *t = &mesh->triangles[hit->triangle];
    struct spherical_triangle seen;
    double by_area = pdf_at(mesh, from, hit, 1 / triangle_area(t));
    return by_area > 0 && is_large(t, from, &seen) ? 1 / seen.angle : by_area;
}

bool light_triangle_meets_ray(const struct light_mesh *mesh, uint32_t triangle, const struct ray *ray,
                              struct light_hit *hit) {
    const struct light_triangle *t = &mesh->triangles[triangle];
    double across = vec3_dot(t->normal, ray->direction);
    if (across == 0 || (mesh->one_sided && across > 0))
        return false;
    hit->t = vec3_dot(t->normal, vec3_sub(t->corner, ray->origin)) / across;
    if (!light_plane_is_met(ray, hit->t, across, t->offset * 0x1p40))
        return false;
    hit->point = ray_at(ray, hit->t);
    hit->triangle = triangle;
    /* Barycentric coordinates: ratios of areas. */
    struct vec3 p = vec3_sub(hit->point, t->corner);
    double area = vec3_dot(vec3_cross(t->edge1, t->edge2), t->normal);
    double u = vec3_dot(vec3_cross(p, t->edge2), t->normal) / area;
    double v = vec3_dot(vec3_cross(t->edge1, p), t->normal) / area;
    return u >= 0 && v >= 0 && u + v <= 1;
}

struct box light_triangle_box(const struct light_mesh *mesh, uint32_t triangle) {
    const struct light_triangle *t = &mesh->triangles[triangle];
    struct box box = {t->corner, t->corner};
    box = box_add_point(box, vec3_add(t->corner, t->edge1));
    return box_add_point(box, vec3_add(t->corner, t->edge2));
}

void light_triangle_bounds(const struct light_mesh *mesh, uint32_t triangle, struct light_bounds *out) {
    const struct light_triangle *t = &mesh->triangles[triangle];
    out->box = light_triangle_box(mesh, triangle);
    light_bounds_emit(intensity_of(light_magnitude(light_triangle_radiance(t)) * triangle_area(t)), out);
    out->axis = t->normal;
    out->cos_theta_o = 1;
    out->cos_theta_e = 0;
    out->two_sided = !mesh->one_sided;
}
