/* Light that comes straight from the lights of the scene. A light at a place, or one that is shaded as from its centre,
 * is one evaluation times the share of its shadow rays that arrive; of a lamp every shadow ray is evaluated by itself.
 * The places of a light's samples are cells of the unit square, parted once more among the samples of a pixel. */
#include "render/direct.h"

#include "base/random.h"
#include "math/sampling.h"

enum { AREA_BATCH = 256 }; /* shadow rays of one hit that are asked together */

/* A ray from the surface, on the side that `towards` lies on. */
static struct vec3 off_surface(const struct hit *hit, struct vec3 towards) {
    double side = vec3_dot(towards, hit->normal_geometric) < 0 ? -hit->offset : hit->offset;
    return vec3_add_scaled(hit->point, hit->normal_geometric, side);
}

static bool is_free(struct tracer *tracer, struct vec3 from, struct vec3 direction, double t_max, double time) {
    struct ray shadow = {.origin = from, .direction = direction, .t_max = t_max, .time = time};
    tracer->shadow_rays++;
    return !world_any(tracer->job->world, &shadow, tracer->scratch);
}

/* The shadow rays of one hit to a light with an extent, asked batch by batch. */
struct fan {
    const struct light *light;
    struct light_frame frame;
    struct vec3 from;
    uint32_t side; /* side x side rays */
    uint64_t key;
    uint32_t turn, turns;
};

static struct fan fan_make(const struct tracer *tracer, const struct light *light, uint32_t number, uint64_t key) {
    struct fan fan = {.light = light, .key = key};
    fan.side = (uint32_t)(light->samples ? light->samples : tracer->job->settings.area_samples);
    /* Lights of SPEC 1.4 keep their jitter; the others share the cells among the samples of a pixel. */
    bool parted = light->emits || light->kind != LIGHT_PARALLELOGRAM;
    fan.turns = parted ? tracer->strata.side : 1;
    fan.turn = parted ? sample_turn(&tracer->strata, number) : 0;
    return fan;
}

static struct vec3 fan_target(const struct fan *fan, uint32_t cell) {
    uint32_t i = cell % fan->side, j = cell / fan->side;
    struct sample2 place = fan->turns > 1 ? sample_cell_part(fan->key, i, j, fan->side, fan->turn, fan->turns)
                                          : sample_cell(fan->key, i, j, fan->side);
    return light_target(fan->light, &fan->frame, fan->from, place);
}

/* The share of a light that reaches the hit: 0 or 1 for a point, of jittered shadow rays for an extent. */
static double visible_share(struct tracer *tracer, const struct light *light, uint32_t number, const struct hit *hit,
                            uint64_t key) {
    const struct world *world = tracer->job->world;
    if (light->kind == LIGHT_DIRECTIONAL) {
        struct vec3 to_light = vec3_negate(light->direction);
        return is_free(tracer, off_surface(hit, to_light), to_light, INFINITY, hit->time);
    }
    struct vec3 from = off_surface(hit, vec3_sub(light->position, hit->point));
    if (!light_has_extent(light))
        return is_free(tracer, from, vec3_sub(light->position, from), 1, hit->time);
    struct fan fan = fan_make(tracer, light, number, key);
    fan.from = from;
    if (!light_frame_make(light, fan.from, &fan.frame))
        return is_free(tracer, fan.from, vec3_sub(light->position, fan.from), 1, hit->time);
    uint32_t all = fan.side * fan.side, seen = 0, have = 0;
    struct vec3 targets[AREA_BATCH];
    for (uint32_t cell = 0; cell < all; cell++) {
        targets[have++] = fan_target(&fan, cell);
        if (have < AREA_BATCH && cell + 1 < all)
            continue;
        seen += world_count_visible(world, fan.from, hit->time, fan.frame.corner, fan.frame.edge1, fan.frame.edge2,
                                    targets, have, tracer->scratch);
        have = 0;
        if (tracer->pool && pool_cancelled(tracer->pool))
            return 0;
    }
    tracer->shadow_rays += all;
    return (double)seen / (double)all;
}

/* A lamp: every shadow ray shades by itself, with the cosine at the lamp. Rays that cannot bring light are not asked.
 */
static struct vec3 lamp_light(struct tracer *tracer, const struct light *light, uint32_t number, const struct hit *hit,
                              const struct shading *shading, struct vec3 normal, uint64_t key) {
    struct vec3 sum = {0, 0, 0};
    struct fan fan = fan_make(tracer, light, number, key);
    /* What is lit is the ray's side, wherever the middle of the lamp may be. */
    fan.from = off_surface(hit, hit->front ? hit->normal_geometric : vec3_negate(hit->normal_geometric));
    if (!light_frame_make(light, fan.from, &fan.frame))
        return sum;
    uint32_t all = fan.side * fan.side, have = 0;
    struct vec3 targets[AREA_BATCH], carried[AREA_BATCH];
    bool visible[AREA_BATCH];
    for (uint32_t cell = 0; cell < all; cell++) {
        struct vec3 target = fan_target(&fan, cell);
        struct vec3 to_light = vec3_normalize(vec3_sub(target, hit->point));
        struct vec3 reflected = shading_evaluate(shading, normal, hit->view, to_light);
        double weight = light_target_weight(light, &fan.frame, hit->point, target);
        if (weight > 0 && (reflected.x != 0 || reflected.y != 0 || reflected.z != 0)) {
            targets[have] = target;
            carried[have++] = vec3_scale(reflected, weight);
        }
        if (have == 0 || (have < AREA_BATCH && cell + 1 < all))
            continue;
        (void)world_visible(tracer->job->world, fan.from, hit->time, fan.frame.corner, fan.frame.edge1, fan.frame.edge2,
                            targets, have, tracer->scratch, visible);
        tracer->shadow_rays += have;
        for (uint32_t i = 0; i < have; i++)
            sum = visible[i] ? vec3_add(sum, carried[i]) : sum;
        have = 0;
    }
    return vec3_scale(vec3_mul(light->colour, sum), 1 / (double)all);
}

/* One light shaded as from one place. */
static struct vec3 light_from_place(struct tracer *tracer, const struct light *light, uint32_t number,
                                    const struct hit *hit, const struct shading *shading, struct vec3 normal,
                                    uint64_t key) {
    bool distant = light->kind == LIGHT_DIRECTIONAL;
    struct vec3 to_light = distant ? vec3_negate(light->direction) : vec3_sub(light->position, hit->point);
    double distance = distant ? 1 : vec3_length(to_light), strength = 1;
    if (!(distance > 0))
        return vec3_all(0);
    if (!distant) {
        to_light = vec3_scale(to_light, 1 / distance);
        strength = light_attenuation(light, distance) * light_cone(light, vec3_negate(to_light));
    }
    struct vec3 reflected = shading_evaluate(shading, normal, hit->view, to_light);
    if (strength == 0 || (reflected.x == 0 && reflected.y == 0 && reflected.z == 0))
        return vec3_all(0);
    double share = visible_share(tracer, light, number, hit, key);
    return share == 0 ? vec3_all(0) : vec3_mul(vec3_scale(light->colour, share * strength), reflected);
}

struct vec3 direct_light(struct tracer *tracer, const struct hit *hit, const struct shading *shading,
                         struct vec3 normal, bool dark_side, uint64_t key) {
    const struct world *world = tracer->job->world;
    struct vec3 sum = vec3_mul(tracer->job->ambient, shading->ambient);
    for (uint32_t i = 0; i < world->light_count && !dark_side; i++) {
        const struct light *light = &world->lights[i];
        if (light->lit && !light->lit[hit->placed])
            continue;
        uint64_t light_key = random_combine(key, i);
        sum = vec3_add(sum, light->emits ? lamp_light(tracer, light, i, hit, shading, normal, light_key)
                                         : light_from_place(tracer, light, i, hit, shading, normal, light_key));
    }
    return sum;
}
