/* The switches over the kinds of lights. Sampling: a disc is the square mapped concentrically (Shirley and Chiu, "A Low
 * Distortion Map Between Disk and Square", JGT 1997). A sphere is sampled by solid angle within its cone
 * (Shirley, Wang, Zimmerman, "Monte Carlo Techniques for Direct Lighting Calculations", TOG 1996), so every sample
 * counts the same and the emitter's cosine is in it already; so is a rectangle (sampling.c), and a disc that appears
 * large, through its square. Other discs and parallelograms and meshes are sampled by area with weight cos / (pi d^2)
 * each, triangles of a mesh in proportion to the light they send. */
#include "light/light.h"

#include "base/error.h"
#include "expr/expr_field.h"
#include "image/transfer.h"
#include "light/light_bounds.h"
#include "light/light_mesh.h"
#include "light/light_shapes_internal.h"
#include "light/sky_light_internal.h"
#include "math/elementary.h"
#include "math/frame.h"

/* A disc whose square fills more than this solid angle is sampled by that of the square, although a fifth of the square
 * is outside the disc: bench/area_lights.c. */
static const double disc_by_angle = 1.5;

void light_decode(struct light *light) {
    if (!light->has_display)
        return;
    struct colour c = light->colour, d = light->display;
    struct colour decoded = transfer_decode_colour((struct transfer_function){TRANSFER_SRGB, 0}, d);
    light->colour = colour_make(d.r != 0 ? c.r / d.r * decoded.r : 0, d.g != 0 ? c.g / d.g * decoded.g : 0,
                                d.b != 0 ? c.b / d.b * decoded.b : 0);
    light->has_display = false;
}

bool light_prepare(struct light *light, struct arena *arena, struct pool *pool, struct error *error) {
    switch (light->kind) {
    case LIGHT_SKY:
        light->table = sky_table_build(light->sky, arena, pool);
        return light->table || error_no_memory(error, "the light of the sky");
    case LIGHT_PARALLELOGRAM:
    case LIGHT_DISC:
        light_plane_prepare(light);
        break;
    case LIGHT_SPHERE:
    case LIGHT_MESH:
        POINT_LIGHTS(LIST_LABEL)
        break;
    }
    return true;
}

bool light_set_profile(struct light *light, const struct expr_program *profile, struct error *error) {
    light->profile = profile;
    return expr_field_reads_only(profile, EXPR_POINT_INPUTS, "the colour of a light may depend only on the direction",
                                 error) &&
           (expr_field_largest(profile, &light->profile_largest) || error_no_memory(error, "a light"));
}

/* Of the light that leaves in a direction, of any length. */
static struct colour colour_along(const struct light *light, struct vec3 direction) {
    if (!light->profile)
        return light->colour;
    return colour_mul(light->colour, expr_field_at(light->profile, vec3_normalize(direction)));
}

/* --- delta lights --- */

bool light_middle(const struct light *light, struct light_target *out) {
    switch (light->kind) {
    case LIGHT_POINT:
    case LIGHT_SPOT:
        SURFACE_LIGHTS(LIST_LABEL)
        *out = (struct light_target){light->position, false};
        return true;
    case LIGHT_DIRECTIONAL:
        *out = (struct light_target){vec3_negate(light->direction), true};
        return true;
    case LIGHT_MESH:
    case LIGHT_SKY:
        break;
    }
    return false;
}

bool light_arrive(const struct light *light, struct vec3 point, struct light_arrival *out) {
    if (!light_middle(light, &out->middle))
        return false;
    /* Its light is the same everywhere. */
    if (out->middle.distant) {
        out->direction = out->middle.at;
        out->distance = INFINITY;
        out->strength = 1;
        out->colour = light->colour;
        return true;
    }
    struct vec3 to_light = vec3_sub(out->middle.at, point);
    out->distance = vec3_length(to_light);
    /* No direction leads to the light. */
    if (!(out->distance > 0))
        return false;
    out->direction = vec3_scale(to_light, 1 / out->distance);
    out->colour = colour_along(light, vec3_negate(out->direction));
    out->strength = light_attenuation(light, out->distance);
    switch (light->kind) {
    case LIGHT_SPOT:
        out->strength *= light_cone(light, vec3_negate(out->direction));
        break;
    case LIGHT_POINT:
    case LIGHT_DIRECTIONAL:
    case LIGHT_MESH:
    case LIGHT_SKY:
        SURFACE_LIGHTS(LIST_LABEL)
        break;
    }
    return true;
}

/* --- samples --- */

bool light_context_make(const struct light *light, struct vec3 point, struct vec3 from, struct light_context *out) {
    out->point = point;
    out->from = from;
    out->single = out->by_angle = false;
    out->shares_cells = out->bounded = true;
    switch (light->kind) {
    case LIGHT_PARALLELOGRAM: {
        const struct light_plane *plane = &light->plane;
        out->shares_cells = light->emissive; /* existing pictures keep the positions of docs/language.md 7.1 */
        out->corner = light->corner;
        out->edge1 = light->edge1;
        out->edge2 = light->edge2;
        out->weight = intensity_of(plane->area);
        if (light_planar_is_behind(light, plane->across, from))
            return false;
        out->by_angle = light->emissive && spherical_rectangle_make(&plane->frame, light->corner, from, &out->seen);
        if (!out->by_angle)
            out->axis = plane->normal;
        return true;
    }
    case LIGHT_DISC:
        out->axis = light->direction;
        out->right = light->plane.right;
        out->up = light->plane.up;
        light_context_square(out, light->position, light->radius);
        out->weight = light->radius * light->radius; /* of the area pi r^2 */
        if (light_planar_is_behind(light, light->direction, from))
            return false;
        out->by_angle = light->emissive &&
                        spherical_rectangle_make(&light->plane.frame, out->corner, from, &out->seen) &&
                        out->seen.angle > disc_by_angle;
        return true;
    case LIGHT_SPHERE:
        if (light_sphere_context(light, out))
            return true;
        out->single = !light->emissive; /* from inside, the target is its centre */
        return out->single;
    case LIGHT_MESH:
        light_mesh_context(light->mesh, out);
        return light->mesh->count > 0;
    case LIGHT_SKY:
        out->bounded = false;
        return true;
        POINT_LIGHTS(LIST_LABEL)
        out->bounded = false;
        out->single = true;
        break;
    }
    return true;
}

struct vec3 light_target_at(const struct light *light, const struct light_context *context, struct sample2 xi) {
    if (context->by_angle)
        return spherical_rectangle_point(&context->seen, xi);
    switch (light->kind) {
    case LIGHT_PARALLELOGRAM:
        return vec3_add_scaled(vec3_add_scaled(light->corner, light->edge1, xi.x), light->edge2, xi.y);
    case LIGHT_DISC:
        return light_disc_target(light, context, xi);
    case LIGHT_SPHERE:
        return context->single ? light->position : light_sphere_target(light, context, xi);
    case LIGHT_MESH:
    case LIGHT_SKY:
        POINT_LIGHTS(LIST_LABEL)
        break;
    }
    return light->position;
}

/* From the intensity of radiance 1. */
static double pdf_of(double weight) {
    return weight > 0 ? 1 / radiance_of(weight) : 0;
}

static struct light_sample delta_sample(const struct light *light, const struct light_context *context,
                                        struct sample2 xi) {
    struct light_arrival arrival;
    if (!light_arrive(light, context->point, &arrival))
        return (struct light_sample){.pdf = 1, .is_delta = true};
    struct colour radiance = colour_scale(arrival.colour, arrival.strength);
    return (struct light_sample){
        .direction = arrival.direction,
        .target = {context->single ? arrival.middle.at : light_target_at(light, context, xi), arrival.middle.distant},
        .radiance = radiance,
        .pdf = 1,
        .intensity = radiance,
        .is_delta = true};
}

/* A lamp with a surface of its own: `weight` is the intensity of radiance 1. */
static struct light_sample surface_sample(const struct light *light, const struct light_context *context,
                                          struct vec3 target, double weight) {
    struct colour colour = colour_along(light, vec3_sub(context->from, target));
    return (struct light_sample){.direction = vec3_normalize(vec3_sub(target, context->point)),
                                 .target = {target, false},
                                 .radiance = colour,
                                 .pdf = pdf_of(weight),
                                 .intensity = colour_scale(colour, weight)};
}

static struct light_sample planar_sample(const struct light *light, const struct light_context *context,
                                         struct sample2 xi) {
    struct vec3 target = light_target_at(light, context, xi);
    double weight = context->by_angle ? intensity_of(context->seen.angle)
                                      : weight_of_area(context->weight, context->axis, vec3_sub(context->from, target));
    struct light_sample sample = surface_sample(light, context, target, weight);
    sample.target.at = light_planar_before(light, context->from, target);
    return sample;
}

static struct light_sample sky_sample(const struct light *light, struct sample2 xi) {
    struct sky_sample sky = sky_table_sample(light->sky, light->table, xi);
    return (struct light_sample){.direction = sky.direction,
                                 .target = {sky.direction, true},
                                 .radiance = colour_mul(sky.radiance, light->colour),
                                 .pdf = sky.pdf,
                                 .intensity = colour_mul(sky.intensity, light->colour)};
}

struct light_sample light_sample(const struct light *light, const struct light_context *context, struct sample2 xi) {
    struct light_sample sample;
    if (light_is_delta(light))
        return delta_sample(light, context, xi);
    switch (light->kind) {
    case LIGHT_PARALLELOGRAM:
        return planar_sample(light, context, xi);
    case LIGHT_DISC:
        sample = planar_sample(light, context, xi);
        if (context->by_angle && light_is_beside_disc(light, sample.target.at))
            sample.radiance = sample.intensity = colour_all(0);
        return sample;
    case LIGHT_SPHERE:
        return surface_sample(light, context, light_sphere_target(light, context, xi), context->weight);
    case LIGHT_MESH:
        return light_mesh_sample(light->mesh, context, xi);
    case LIGHT_SKY:
        return sky_sample(light, xi);
        POINT_LIGHTS(LIST_LABEL)
        break;
    }
    return delta_sample(light, context, xi);
}

static double planar_pdf(const struct light_context *context, const struct light_hit *hit) {
    if (context->by_angle)
        return 1 / context->seen.angle;
    return pdf_of(weight_of_area(context->weight, context->axis, vec3_sub(context->from, hit->point)));
}

double light_pdf(const struct light *light, const struct light_context *context, struct vec3 direction,
                 const struct light_hit *hit) {
    if (light_is_delta(light))
        return 0;
    switch (light->kind) {
    case LIGHT_PARALLELOGRAM:
    case LIGHT_DISC:
        return planar_pdf(context, hit);
    case LIGHT_SPHERE:
        return pdf_of(context->weight);
    case LIGHT_MESH:
        return light_mesh_pdf(light->mesh, context, hit);
    case LIGHT_SKY:
        return sky_table_pdf(light->table, direction);
        POINT_LIGHTS(LIST_LABEL)
        break;
    }
    return 0;
}

/* --- radiance along rays --- */

static bool surface_meets_ray(const struct light *light, const struct ray *ray, double *t) {
    switch (light->kind) {
    case LIGHT_PARALLELOGRAM:
        return light_parallelogram_meets_ray(light, ray, t);
    case LIGHT_DISC:
        return light_disc_meets_ray(light, ray, t);
    case LIGHT_SPHERE:
        return light_sphere_meets_ray(light, ray, t);
    case LIGHT_MESH:
    case LIGHT_SKY:
        POINT_LIGHTS(LIST_LABEL)
        break;
    }
    return false;
}

bool light_meets_ray(const struct light *light, const struct ray *ray, struct light_hit *hit) {
    if (!surface_meets_ray(light, ray, &hit->t))
        return false;
    hit->point = ray_at(ray, hit->t);
    hit->triangle = 0;
    return true;
}

struct colour light_emitted(const struct light *light, const struct ray *ray, const struct light_hit *hit) {
    const struct light_triangle *t;
    switch (light->kind) {
        POINT_LIGHTS(LIST_LABEL)
        break;
        SURFACE_LIGHTS(LIST_LABEL)
        return colour_along(light, vec3_negate(ray->direction));
    case LIGHT_MESH:
        t = &light->mesh->triangles[hit->triangle];
        if (light->mesh->one_sided && !(vec3_dot(t->normal, ray->direction) < 0))
            break;
        return light_triangle_radiance(t);
    case LIGHT_SKY:
        /* As its samples: mip levels would carry light to where their density is low. */
        return colour_mul(sky_colour(light->sky, vec3_normalize(ray->direction), 0), light->colour);
    }
    return colour_all(0);
}

static double largest(struct colour c) {
    double max = c.r > c.g ? c.r : c.g;
    return c.b > max ? c.b : max;
}

static double mesh_brightest(const struct light_mesh *mesh) {
    double max = 0;
    for (uint32_t i = 0; i < mesh->count; i++)
        max = math_max(max, largest(light_triangle_radiance(&mesh->triangles[i])));
    return max;
}

double light_brightest(const struct light *light) {
    double max = largest(light->colour);
    switch (light->kind) {
    case LIGHT_SKY:
        return max * sky_brightest(light->sky);
    case LIGHT_MESH:
        return mesh_brightest(light->mesh);
        POINT_LIGHTS(LIST_LABEL)
        SURFACE_LIGHTS(LIST_LABEL)
        break;
    }
    return light->profile ? max * light->profile_largest : max;
}

bool light_surface_box(const struct light *light, struct box *out) {
    switch (light->kind) {
    case LIGHT_PARALLELOGRAM:
        *out = light_parallelogram_box(light);
        return true;
    case LIGHT_DISC:
        *out = light_disc_box(light);
        return true;
    case LIGHT_SPHERE:
        *out = light_box_centred(light->position, vec3_all(light->radius));
        return true;
    case LIGHT_MESH:
    case LIGHT_SKY:
        POINT_LIGHTS(LIST_LABEL)
        break;
    }
    return false;
}

/* --- bounds --- */

uint32_t light_part_count(const struct light *light) {
    switch (light->kind) {
    case LIGHT_MESH:
        return light->mesh->count;
    case LIGHT_SKY:
        POINT_LIGHTS(LIST_LABEL)
        SURFACE_LIGHTS(LIST_LABEL)
        break;
    }
    return 1;
}

enum light_extent light_bounds_of(const struct light *light, uint32_t part, struct light_bounds *out) {
    struct vec3 across;
    *out = (struct light_bounds){.box = {light->position, light->position}, .range = INFINITY};
    (void)light_surface_box(light, &out->box);
    out->axis = vec3_make(0, 1, 0); /* uniform in all directions */
    out->cos_theta_o = -1;
    out->cos_theta_e = 1;
    switch (light->kind) {
    case LIGHT_POINT:
        light_bounds_fade(light, out);
        break;
    case LIGHT_SPOT:
        light_bounds_fade(light, out);
        out->axis = light->direction;
        out->cos_theta_o = math_max(-1, math_min(1, light->cos_outer) - 0x1p-40);
        break;
    case LIGHT_PARALLELOGRAM:
        if (light_is_delta(light)) {
            light_bounds_fade(light, out);
            break;
        }
        across = vec3_cross(light->edge1, light->edge2);
        light_bounds_shine(light, vec3_normalize(across), intensity_of(vec3_length(across)), out);
        break;
    case LIGHT_DISC:
        if (light_is_delta(light)) {
            light_bounds_fade(light, out);
            break;
        }
        light_bounds_shine(light, light->direction, light->radius * light->radius, out); /* the area is pi r^2 */
        break;
    case LIGHT_SPHERE:
        if (light_is_delta(light)) {
            light_bounds_fade(light, out);
            break;
        }
        light_bounds_emit(light_strength(light) * light->radius * light->radius, out); /* as a disc in all directions */
        break;
    case LIGHT_MESH:
        light_triangle_bounds(light->mesh, part, out);
        break;
    case LIGHT_DIRECTIONAL:
    case LIGHT_SKY:
        return light_magnitude(light->colour) > 0 ? LIGHT_EXTENT_INFINITE : LIGHT_EXTENT_NONE;
    }
    return light_bounds_finish(out) ? LIGHT_EXTENT_BOUNDED : LIGHT_EXTENT_NONE;
}

/* --- photons --- */

double light_divided_extent(const struct light *light) {
    switch (light->kind) {
    case LIGHT_PARALLELOGRAM:
        return vec3_length(light->edge1) + vec3_length(light->edge2);
    case LIGHT_DISC:
    case LIGHT_SPHERE:
    case LIGHT_MESH:
    case LIGHT_SKY:
        POINT_LIGHTS(LIST_LABEL)
        break;
    }
    return 0;
}

bool light_emitter_make(const struct light *light, uint32_t i, uint32_t j, uint32_t parts, struct light_emitter *out) {
    *out = (struct light_emitter){.light = light, .centre = light->position, .side = 1.0 / parts, .even = true};
    out->low[0] = i * out->side;
    out->low[1] = j * out->side;
    switch (light->kind) {
    case LIGHT_POINT:
        return true;
    case LIGHT_SPOT:
        out->even = false;
        return true;
    case LIGHT_PARALLELOGRAM:
        out->even = !light->emissive;
        light_parallelogram_emitter(out);
        return true;
    case LIGHT_DISC:
        out->even = !light->emissive;
        out->radius = light->radius;
        frame_tangents(light->direction, &out->right, &out->up);
        return true;
    case LIGHT_SPHERE:
        out->radius = light->radius;
        return true;
    case LIGHT_MESH:
        out->centre = light->mesh->centre;
        out->radius = light->mesh->radius;
        return light->mesh->count > 0;
    case LIGHT_DIRECTIONAL:
        out->domain = LIGHT_DOMAIN_PARALLEL;
        frame_tangents(light->direction, &out->right, &out->up);
        return true;
    case LIGHT_SKY:
        out->domain = LIGHT_DOMAIN_ENVIRONMENT;
        return true;
    }
    return false;
}

double light_emitter_shine(const struct light_emitter *emitter, struct vec3 direction) {
    const struct light *light = emitter->light;
    if (emitter->even)
        return 1;
    switch (light->kind) {
    case LIGHT_SPOT:
        return light_cone(light, direction);
    case LIGHT_PARALLELOGRAM:
        return light_planar_shine(light, vec3_normalize(vec3_cross(light->edge1, light->edge2)), direction);
    case LIGHT_DISC:
        return light_planar_shine(light, light->direction, direction);
    case LIGHT_POINT:
    case LIGHT_DIRECTIONAL:
    case LIGHT_SPHERE:
    case LIGHT_MESH:
    case LIGHT_SKY:
        break;
    }
    return 1;
}

bool light_emitter_shines_near(const struct light_emitter *emitter, struct vec3 axis, double cos_half) {
    const struct light *light = emitter->light;
    switch (light->kind) {
    case LIGHT_SPOT: {
        double angle = el_acos(math_max(-1, math_min(1, vec3_dot(axis, light->direction))));
        double outer = el_acos(math_max(-1, math_min(1, light->cos_outer)));
        return angle < outer + el_acos(cos_half);
    }
    case LIGHT_PARALLELOGRAM: /* behind its plane in some directions, behind it between them */
    case LIGHT_DISC:
        return false;
    case LIGHT_POINT:
    case LIGHT_DIRECTIONAL:
    case LIGHT_SPHERE:
    case LIGHT_MESH:
    case LIGHT_SKY:
        break;
    }
    return true;
}

struct colour light_emitter_colour(const struct light_emitter *emitter) {
    const struct light *light = emitter->light;
    switch (light->kind) {
    case LIGHT_MESH:
        return light_mesh_colour(light->mesh);
    case LIGHT_SKY:
        POINT_LIGHTS(LIST_LABEL)
        SURFACE_LIGHTS(LIST_LABEL)
        break;
    }
    return light->profile ? colour_scale(light->colour, light->profile_largest) : light->colour;
}

double light_emitter_unit(const struct light_emitter *emitter) {
    const struct light *light = emitter->light;
    double part = emitter->side * emitter->side;
    if (light_is_delta(light))
        return part;
    switch (light->kind) {
    case LIGHT_PARALLELOGRAM:
        return intensity_of(vec3_length(vec3_cross(light->edge1, light->edge2))) * part;
    case LIGHT_DISC:
        return intensity_of(PI * light->radius * light->radius) * part;
    case LIGHT_SPHERE:
        return light->radius * light->radius; /* of the area pi r^2 across every direction */
    case LIGHT_MESH:
    case LIGHT_SKY:
        POINT_LIGHTS(LIST_LABEL)
        break;
    }
    return part;
}

/* A place on a disc across; *height: of the ball over it, in radii. */
static struct vec3 round_position(const struct light_emitter *emitter, struct vec3 right, struct vec3 up,
                                  struct sample2 xi, double *height) {
    struct sample2 round = sample_disc(xi);
    double radius = emitter->light->radius, squared = 1 - round.x * round.x - round.y * round.y;
    *height = squared > 0 ? sqrt(squared) : 0;
    return vec3_add_scaled(vec3_add_scaled(emitter->centre, right, radius * round.x), up, radius * round.y);
}

/* A point of a light that is not a mesh; the photon starts there. */
static struct vec3 emitter_point(const struct light_emitter *emitter, struct vec3 direction, struct sample2 xi) {
    const struct light *light = emitter->light;
    struct sample2 part = {emitter->low[0] + emitter->side * xi.x, emitter->low[1] + emitter->side * xi.y};
    struct vec3 right, up, at;
    double height;
    switch (light->kind) {
    case LIGHT_PARALLELOGRAM:
        return vec3_add_scaled(vec3_add_scaled(light->corner, light->edge1, part.x), light->edge2, part.y);
    case LIGHT_DISC:
        return round_position(emitter, emitter->right, emitter->up, part, &height);
    case LIGHT_SPHERE: /* its projection along the direction */
        frame_tangents(direction, &right, &up);
        at = round_position(emitter, right, up, part, &height);
        return light->emissive && height > 0 ? vec3_add_scaled(at, direction, light->radius * height) : at;
    case LIGHT_MESH:
    case LIGHT_SKY:
        POINT_LIGHTS(LIST_LABEL)
        break;
    }
    return emitter->centre;
}

struct light_photon light_photon(const struct light_emitter *emitter, struct vec3 direction, struct sample2 xi) {
    const struct light *light = emitter->light;
    struct light_photon photon = {.direction = direction};
    struct light_sample sample;
    switch (light->kind) {
    case LIGHT_POINT:
    case LIGHT_SPOT:
        SURFACE_LIGHTS(LIST_LABEL)
        photon.origin = emitter_point(emitter, direction, xi);
        photon.power = colour_scale(colour_along(light, direction),
                                    light_emitter_shine(emitter, direction) * light_emitter_unit(emitter));
        break;
    case LIGHT_MESH:
        return light_mesh_photon(light->mesh, direction, xi);
    case LIGHT_DIRECTIONAL:
        photon.direction = light->direction;
        photon.power = light->colour;
        break;
    case LIGHT_SKY:
        sample = sky_sample(light, xi);
        photon.direction = vec3_negate(sample.direction);
        photon.power = sample.intensity;
        break;
    }
    return photon;
}

double light_photon_attenuation(const struct light *light, double length) {
    if (!light_is_delta(light))
        return 1;
    switch (light->kind) {
    case LIGHT_POINT:
    case LIGHT_SPOT:
        SURFACE_LIGHTS(LIST_LABEL)
        return length * length * light_attenuation(light, length);
    case LIGHT_DIRECTIONAL:
    case LIGHT_MESH:
    case LIGHT_SKY:
        break;
    }
    return 1;
}

static void bundle_triangles(struct bundle *bundle, void *light_mesh) {
    struct light_mesh *mesh = light_mesh;
    BUNDLE(bundle, mesh->triangles, mesh->count, NULL);
    BUNDLE(bundle, mesh->until, mesh->count, NULL);
}

void light_bundle(struct bundle *bundle, void *any) {
    struct light *light = any;
    BUNDLE(bundle, light->profile, 1, expr_program_bundle);
    BUNDLE(bundle, light->mesh, 1, bundle_triangles);
    BUNDLE(bundle, light->sky, 1, sky_bundle);
    sky_table_bundle(bundle, &light->table);
    BUNDLE(bundle, light->lit, light->lit_count, NULL);
}
