/* See whitted.h. A path is (ray, key, counters): the key makes every random number a function of pixel, sample and the
 * way through the tree of rays. */
#include "render/whitted.h"

#include "base/random.h"
#include "math/sampling.h"

struct path {
    uint64_t key;
    int reflections, refractions; /* so far, from the camera */
};

static struct vec3 trace(struct tracer *tracer, const struct ray *ray, struct path path);

/* --- light that arrives directly --- */

enum { AREA_BATCH = 256 }; /* shadow rays of one hit that are asked together */

/* The share of a light that reaches the hit: 0 or 1 for a point, shadow rays to jittered cells for a parallelogram. */
static double visible_share(struct tracer *tracer, const struct light *light, const struct hit *hit, uint64_t key) {
    const struct world *world = tracer->job->world;
    struct ray shadow = {.t_min = 0, .t_max = 1, .time = hit->time};
    /* Off the surface on the light's side. */
    struct vec3 to_light = vec3_sub(light->position, hit->point);
    double side = vec3_dot(to_light, hit->normal_geometric) < 0 ? -hit->offset : hit->offset;
    shadow.origin = vec3_add_scaled(hit->point, hit->normal_geometric, side);
    if (light->kind == LIGHT_POINT) {
        shadow.direction = vec3_sub(light->position, shadow.origin);
        tracer->shadow_rays++;
        return world_any(world, &shadow, tracer->scratch) ? 0 : 1;
    }
    uint32_t n = (uint32_t)tracer->job->settings.area_samples, all = n * n, seen = 0, have = 0;
    struct vec3 targets[AREA_BATCH];
    for (uint32_t cell = 0; cell < all; cell++) {
        struct sample2 place = sample_cell(key, cell % n, cell / n, n);
        struct vec3 target = vec3_add_scaled(light->corner, light->edge1, place.x);
        targets[have++] = vec3_add_scaled(target, light->edge2, place.y);
        if (have < AREA_BATCH && cell + 1 < all)
            continue;
        seen += world_count_visible(world, shadow.origin, hit->time, light->corner, light->edge1, light->edge2, targets,
                                    have, tracer->scratch);
        have = 0;
        if (tracer->pool && pool_cancelled(tracer->pool))
            return 0;
    }
    tracer->shadow_rays += all;
    return (double)seen / (double)all;
}

static struct vec3 own_light(struct tracer *tracer, const struct hit *hit, const struct shading *shading,
                             struct vec3 normal, bool dark_side, uint64_t key) {
    const struct world *world = tracer->job->world;
    struct vec3 sum = vec3_mul(tracer->job->ambient, shading->ambient);
    for (uint32_t i = 0; i < world->light_count && !dark_side; i++) {
        const struct light *light = &world->lights[i];
        struct vec3 to_light = vec3_sub(light->position, hit->point);
        double distance = vec3_length(to_light);
        if (!(distance > 0))
            continue;
        to_light = vec3_scale(to_light, 1 / distance);
        struct vec3 reflected = shading_evaluate(shading, normal, hit->view, to_light);
        if (reflected.x == 0 && reflected.y == 0 && reflected.z == 0)
            continue;
        double share = visible_share(tracer, light, hit, random_combine(key, i));
        if (share == 0)
            continue;
        struct vec3 arriving = vec3_scale(light->colour, share * light_attenuation(light, distance));
        sum = vec3_add(sum, vec3_mul(arriving, reflected));
    }
    return sum;
}

/* --- secondary rays --- */

/* The two sides of the surface for a ray that crosses it here: the relative index of refraction, and the stack behind. */
static double cross_surface(const struct hit *hit, double ior, const struct media *media, struct media *behind) {
    media_copy(behind, media);
    double here = media_ior(media);
    if (hit->front) {
        media_enter(behind, hit->placed, ior);
        return here / ior;
    }
    bool known = false;
    for (uint32_t i = 0; i < media->count; i++)
        known = known || media->entries[i].placed == hit->placed;
    media_leave(behind, hit->placed);
    /* An open surface seen from behind: the ray was in this material although nobody saw it enter. */
    return (known ? here : ior) / media_ior(behind);
}

static struct ray secondary_ray(const struct hit *hit, const struct ray *from, struct vec3 direction,
                                const struct media *media) {
    double side = vec3_dot(direction, hit->normal_geometric) < 0 ? -hit->offset : hit->offset;
    return (struct ray){.origin = vec3_add_scaled(hit->point, hit->normal_geometric, side),
                        .direction = direction,
                        .t_min = 0,
                        .t_max = INFINITY,
                        .time = from->time,
                        .footprint = {hit->footprint, from->footprint.spread},
                        .media = media};
}

/* `side`: the normal turned to the ray's side. A reflection about an interpolated normal may point into the surface: the
 * geometric normal then takes its place. */
static struct vec3 reflect_outwards(const struct hit *hit, struct vec3 side, struct vec3 geometric_side) {
    struct vec3 direction = shading_reflect(side, hit->view);
    return vec3_dot(direction, geometric_side) > 0 ? direction : shading_reflect(geometric_side, hit->view);
}

static bool is_black(struct vec3 c) {
    return c.x == 0 && c.y == 0 && c.z == 0;
}

static struct vec3 follow_mirror(struct tracer *tracer, const struct hit *hit, const struct ray *ray,
                                 struct vec3 direction, struct path path) {
    if (path.reflections >= tracer->job->settings.reflect_limit)
        return vec3_all(0);
    struct ray reflected = secondary_ray(hit, ray, direction, ray->media);
    tracer->reflected_rays++;
    return trace(tracer, &reflected,
                 (struct path){random_combine(path.key, UINT32_MAX), path.reflections + 1, path.refractions});
}

static struct vec3 follow_refraction(struct tracer *tracer, const struct hit *hit, const struct ray *ray,
                                     struct vec3 direction, const struct media *behind, struct path path) {
    if (path.refractions >= tracer->job->settings.refract_limit)
        return vec3_all(0);
    struct ray refracted = secondary_ray(hit, ray, direction, behind);
    tracer->refracted_rays++;
    return trace(tracer, &refracted,
                 (struct path){random_combine(path.key, (uint64_t)UINT32_MAX + 1), path.reflections, path.refractions + 1});
}

/* --- one hit --- */

static struct vec3 shade(struct tracer *tracer, const struct ray *ray, const struct hit *hit, struct path path) {
    const struct settings *settings = &tracer->job->settings;
    struct surface_look look;
    material_look(tracer->job->world->materials[hit->material], hit, &look);
    /* The ray's side of the surface; interpolated normals follow the geometric one. */
    struct vec3 geometric_side = hit->front ? hit->normal_geometric : vec3_negate(hit->normal_geometric);
    struct vec3 side = hit->front ? hit->normal : vec3_negate(hit->normal);
    if (!(vec3_dot(side, hit->view) > 0))
        side = geometric_side;

    /* What the interface does to the amounts. */
    struct media behind;
    struct vec3 through = {0, 0, 0};
    bool passes = false;
    if (look.fresnel || look.refract != 0) {
        double eta = cross_surface(hit, look.has_ior ? look.ior : 1, ray->media, &behind);
        passes = shading_refract(side, hit->view, eta, &through);
        if (look.fresnel) {
            look.reflect = shading_fresnel(vec3_dot(side, hit->view), eta);
            look.refract = 1 - look.reflect;
        }
    }
    bool dark_side = !hit->front && !look.two_sided;
    struct vec3 normal = look.two_sided && !hit->front ? vec3_negate(hit->normal) : hit->normal;
    struct shading shading;
    material_shading(&look, settings->specular, settings->ambient_plain, &shading);
    struct vec3 colour = own_light(tracer, hit, &shading, normal, dark_side, path.key);

    struct vec3 mirror = {0, 0, 0}, refraction = {0, 0, 0};
    for (int i = 0; i < shading.count; i++) {
        if (shading.lobes[i].kind == LOBE_MIRROR)
            mirror = vec3_add(mirror, shading.lobes[i].weight);
        if (shading.lobes[i].kind == LOBE_REFRACT)
            refraction = vec3_add(refraction, shading.lobes[i].weight);
    }
    /* Total internal reflection: the refracted share turns back, or is lost. Fresnel's has none left by itself. */
    if (!passes) {
        if (settings->use_tir)
            mirror = vec3_add(mirror, refraction);
        refraction = vec3_all(0);
    }
    if (!is_black(mirror)) {
        struct vec3 direction = reflect_outwards(hit, side, geometric_side);
        colour = vec3_add(colour, vec3_mul(mirror, follow_mirror(tracer, hit, ray, direction, path)));
    }
    if (!is_black(refraction)) {
        struct vec3 light = follow_refraction(tracer, hit, ray, through, &behind, path);
        colour = vec3_add(colour, vec3_mul(refraction, light));
    }
    return colour;
}

static struct vec3 trace(struct tracer *tracer, const struct ray *ray, struct path path) {
    const struct world *world = tracer->job->world;
    struct hit hit;
    if (tracer->pool && pool_cancelled(tracer->pool))
        return vec3_all(0); /* deep paths through glass grow exponentially */
    if (!world_nearest(world, ray, tracer->scratch, &hit))
        return sky_colour(&world->sky, vec3_normalize(ray->direction), ray->footprint.spread);
    return shade(tracer, ray, &hit, path);
}

struct vec3 whitted_trace(struct tracer *tracer, const struct ray *ray, uint64_t key) {
    struct ray from_eye = *ray;
    from_eye.media = tracer->eye_media;
    return trace(tracer, &from_eye, (struct path){.key = key});
}

void whitted_eye_media(const struct world *world, struct vec3 eye, struct world_scratch *scratch, struct media *out) {
    uint32_t inside[MEDIA_LIMIT];
    uint32_t count = world_containing(world, eye, scratch, inside, MEDIA_LIMIT);
    out->count = 0;
    for (uint32_t i = 0; i < count; i++) {
        const struct placed *placed = &world->placed[inside[i]];
        uint32_t material = placed->shape.kind == SHAPE_CSG ? placed->shape.csg->leaves[0].material : placed->material;
        double ior;
        if (material_is_transparent(world->materials[material], &ior))
            media_enter(out, inside[i], ior);
    }
}
