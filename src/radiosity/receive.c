#include "radiosity/receive_internal.h"

#include "base/random.h"
#include "light/light_edit.h"
#include "material/bsdf_select.h"
#include "material/classic.h"
#include "material/material_eval.h"
#include "math/elementary.h"
#include "world/joint.h"
#include "world/world_describe.h"

#include <math.h>

enum { HOLES = 200, BURYING = 16 };
static const struct joint no_joint = {.joined = JOINED_NOT};
static const struct material_context context;

/* --- primitives and materials --- */

bool receive_is_emissive(const struct world *world, uint32_t material) {
    const struct surface_material *surface = &world->surfaces.materials[material];
    return surface->phong.unlit || colour_max_abs(surface_emission_bound(&world->surfaces, surface)) > 0;
}

static bool shows_inside(const struct world *world, uint32_t material) {
    const struct surface_material *surface = &world->surfaces.materials[material];
    return world->material_has_medium[material] || surface_has_holes(surface) || surface->phong.two_sided ||
           receive_is_emissive(world, material);
}

void receive_find_buries(const struct world *world, uint8_t *buries) {
    for (uint32_t i = 0; i < world->primitive_count; i++) {
        const struct geometry *geometry = primitive_geometry(world, i);
        const struct mesh *mesh = geometry_mesh(geometry);
        buries[i] = geometry_is_closed(geometry) && (!mesh || mesh_is_outward(mesh)) &&
                    !primitive_has_material(world, i, shows_inside);
    }
}

/* --- positions of a side --- */

struct receiver {
    const struct receiver_input *input;
    struct world_scratch *scratch;
    uint32_t vertex;
    bool back;
    uint64_t key;
    double area; /* a third of its patches */
    uint32_t burying[BURYING], burying_count;
};

/* A random order of a stratum for each position. */
static struct sample2 stratified(const struct receiver *receiver, uint32_t position, uint64_t dimension) {
    enum { SIDE = 8 };
    _Static_assert((int)SIDE * (int)SIDE == (int)RECEIVE_POSITIONS, "a square of cells");
    uint64_t key = random_combine(receiver->key, dimension);
    uint32_t cell = sample_permute(position, RECEIVE_POSITIONS, key);
    return sample_cell(key, cell % SIDE, cell / SIDE, SIDE);
}

static struct receiver receiver_make(const struct receiver_input *input, uint32_t side, struct world_scratch *scratch) {
    const struct patches *patches = &input->radiosity->patches;
    struct receiver out = {.input = input,
                           .scratch = scratch,
                           .vertex = side / 2,
                           .back = side & 1,
                           .key = random_combine(input->seed, side)};
    struct box box = box_empty();
    uint64_t own = patch_vertex_at(patches, out.vertex)->primitive;
    for (size_t i = patches->first[out.vertex]; i < patches->first[out.vertex + 1]; i++) {
        struct vec3 c[3];
        patch_corners(patches, patches->of_vertex[i], c);
        out.area += patch_area(c) / 3;
        for (int k = 0; k < 3; k++)
            box = box_add_point(box, c[k]);
    }
    uint32_t found[WORLD_NESTING], count = world_closed_in(patches->world, &box, found, WORLD_NESTING);
    for (uint32_t i = 0; i < count && i < WORLD_NESTING && out.burying_count < BURYING; i++)
        if (found[i] != own && input->buries[found[i]])
            out.burying[out.burying_count++] = found[i];
    return out;
}

/* A position on a patch of the vertex, and the patch. */
static struct vec3 position_of(const struct receiver *receiver, uint32_t position, uint32_t *patch) {
    const struct patches *patches = &receiver->input->radiosity->patches;
    const size_t end = patches->first[receiver->vertex + 1];
    double until = 3 * receiver->area * stratified(receiver, position, 0).x;
    struct sample2 xi = stratified(receiver, position, 1);
    struct vec3 c[3];
    size_t i = patches->first[receiver->vertex];
    for (;; i++) {
        patch_corners(patches, patches->of_vertex[i], c);
        double area = patch_area(c);
        if (until < area || i + 1 == end)
            break;
        until -= area;
    }
    *patch = patches->of_vertex[i];
    /* The density of its own share is 6 x (1 - x): the inverse of 3 x^2 - 2 x^3. */
    double share = 0.5 - el_sin(el_asin(1 - 2 * xi.x) / 3);
    struct vec3 at = vec3_all(0);
    int others = 0;
    for (int k = 0; k < 3; k++) {
        bool own = patch_at(patches, *patch)->vertex[k] == receiver->vertex;
        double rest = others == 0 ? xi.y : 1 - xi.y;
        others += !own;
        at = vec3_add_scaled(at, c[k], own ? share : (1 - share) * rest);
    }
    return at;
}

/* The surface at a position, seen from the side. False: there is none, or *buried: it is inside of another solid. */
static bool hit_of(const struct receiver *receiver, uint32_t position, struct hit *hit, bool *buried) {
    const struct patches *patches = &receiver->input->radiosity->patches;
    uint32_t patch, inside;
    struct vec3 point = position_of(receiver, position, &patch);
    *buried = false;
    if (!patches_hit(patches, patch, point, receiver->scratch, hit))
        return false;
    hit->view = receiver->back ? vec3_negate(hit->normal_geometric) : hit->normal_geometric;
    hit->front = !receiver->back;
    if (receiver->burying_count == 0)
        return true;
    const struct inside_query query = {vec3_add_scaled(hit->point, hit->view, hit->offset), 0, receiver->burying,
                                       receiver->burying_count};
    *buried = world_containing(patches->world, &query, receiver->scratch, &inside, 1) > 0;
    return !*buried;
}

static struct light_receiver light_receiver_of(const struct hit *hit) {
    return (struct light_receiver){.point = hit->point,
                                   .from = vec3_add_scaled(hit->point, hit->view, hit->offset),
                                   .normal = hit->view,
                                   .primitive = hit->primitive};
}

static double power_weight(double pdf, double other) {
    return pdf * pdf / (pdf * pdf + other * other);
}

/* How many rays there are for a sample of a light. */
static double rays_per_sample(const struct receiver_input *input) {
    return input->rays / (double)RECEIVE_POSITIONS;
}

/* --- samples of lights --- */

/* The intensity that arrives from a sample of a light. */
static struct colour light_of_sample(const struct receiver *receiver, const struct hit *hit, uint32_t position) {
    const struct world_lights *lights = receiver->input->lights;
    const struct light_receiver at = light_receiver_of(hit);
    struct world_light_sample sample;
    double pmf, t;
    struct light_part part =
        light_sampler_sample(&lights->sampler, at.point, at.normal, stratified(receiver, position, 2).x, &pmf);
    if (part.light == LIGHT_NONE || !world_lights_sample(lights, &at, part, stratified(receiver, position, 3), &sample))
        return colour_all(0);
    double cosine = vec3_dot(sample.direction, hit->view);
    if (!(cosine > 0))
        return colour_all(0);
    struct ray shadow = {.origin = at.from, .direction = light_target_from(&sample.target, at.from), .t_max = INFINITY};
    struct hit_skip skip = sample.skip_primitive ? (struct hit_skip){sample.skip_primitive, 0}
                                                 : hit_skip_from(hit, hit->front ? 1 : -1, shadow.direction);
    shadow.skip_primitive = skip.primitive;
    shadow.skip_part = skip.part;
    receiver->scratch->light = sample.light % WORLD_SHADOW_CACHE;
    struct colour radiance = sample.radiance;
    if (sample.decided) {
        radiance = world_lights_seen_by(lights, &at, &sample, &shadow, receiver->scratch, &t);
    } else {
        shadow.t_max = light_target_end(&sample.target);
        radiance = colour_scale(radiance, world_lights_visible(lights, &shadow, receiver->scratch));
    }
    double pdf = pmf * sample.pdf, weight = 1;
    if (!sample.is_delta)
        weight = power_weight(pdf, intensity_of(cosine) * rays_per_sample(receiver->input));
    return colour_scale(radiance, intensity_of(cosine) * weight / pdf);
}

void receive_direct(const struct receiver_input *input, uint32_t side, struct world_scratch *scratch,
                    struct side_light *out) {
    const struct world *world = input->radiosity->patches.world;
    const struct receiver receiver = receiver_make(input, side, scratch);
    struct colour light = {0, 0, 0}, reflectance = {0, 0, 0};
    uint32_t count = 0, buried = 0;
    for (uint32_t i = 0; i < RECEIVE_POSITIONS; i++) {
        struct hit hit;
        struct bsdf bsdf;
        bool inside, found = hit_of(&receiver, i, &hit, &inside);
        buried += inside;
        if (!found)
            continue;
        material_eval(&world->surfaces, &hit, NULL, &context, &bsdf);
        if (bsdf.opacity < 0.5)
            continue;
        struct colour own = bsdf_diffuse(&bsdf);
        reflectance = colour_add(reflectance, own);
        if (!colour_is_black(own))
            light = colour_add(light, light_of_sample(&receiver, &hit, i));
        count++;
    }
    *out = (struct side_light){.buried = buried / (double)RECEIVE_POSITIONS};
    if (count == 0 || colour_is_black(reflectance))
        return;
    out->reflectance = colour_min(colour_scale(reflectance, 1.0 / count), colour_all(1));
    out->light = colour_scale(light, 1.0 / count);
    out->area = receiver.area * count / RECEIVE_POSITIONS;
    out->weight = 1 / (count * rays_per_sample(input));
}

/* --- rays --- */

/* A ray from a receiver, until it ends. */
struct receiver_ray {
    const struct receiver *receiver;
    struct light_receiver from;
    struct vec3 direction;
    double pdf; /* of all rays for a sample of a light */
    struct ray ray;
    struct colour light; /* that it meets, weighted */
};

static void meet(struct receiver_ray *r, struct colour radiance, double pdf) {
    r->light = colour_add_scaled(r->light, radiance, power_weight(r->pdf, pdf));
}

static void meet_area_lights(struct receiver_ray *r, double t_max) {
    const struct world_lights *lights = r->receiver->input->lights;
    struct world_lights_traversal traversal;
    struct light_hit hit;
    uint32_t number;
    struct ray ray = r->ray;
    if (lights->area_light_count == 0)
        return;
    ray.t_max = t_max;
    world_lights_met_begin(&traversal, lights, &ray);
    while (world_lights_met_next(&traversal, &number, &hit))
        if (world_lights_illuminate(lights, number, r->from.primitive))
            meet(r, light_emitted(&lights->lights[number], &ray, &hit),
                 world_lights_pdf(lights, &r->from, number, r->direction, &hit));
}

static void meet_sky(struct receiver_ray *r) {
    const struct world_lights *lights = r->receiver->input->lights;
    const struct light_hit hit = {.t = INFINITY};
    for (uint32_t i = 0; i < lights->sampler.infinite_count; i++) {
        uint32_t number = lights->sampler.infinite[i];
        const struct light *light = &lights->lights[number];
        if (!light_is_delta(light) && world_lights_illuminate(lights, number, r->from.primitive))
            meet(r, light_emitted(light, &r->ray, &hit),
                 world_lights_pdf(lights, &r->from, number, r->direction, &hit));
    }
}

/* Follows the ray to a surface that is no hole there. */
static bool follow_ray(struct receiver_ray *r, uint64_t key, struct hit *hit) {
    const struct receiver_input *input = r->receiver->input;
    const struct world *world = input->radiosity->patches.world;
    for (int i = 0; i < HOLES; i++) {
        if (!world_nearest(world, &r->ray, r->receiver->scratch, hit)) {
            meet_area_lights(r, INFINITY);
            meet_sky(r);
            return false;
        }
        meet_area_lights(r, hit->t);
        bool holes = primitive_prototype(world, hit->primitive)->holes;
        bool shines = input->emissive[hit->material] || input->lights->of_primitive[hit->primitive] != LIGHT_NONE;
        struct bsdf bsdf;
        if (!holes && !shines)
            return true;
        material_eval(&world->surfaces, hit, NULL, &context, &bsdf);
        if (!holes || bsdf.opacity >= 1 || random_unit(random_combine(key, (uint64_t)i)) < bsdf.opacity) {
            if (shines)
                meet(r, world_lights_radiance(input->lights, r->from.primitive, hit, bsdf.emission),
                     world_lights_pdf_of_hit(input->lights, &r->from, r->direction, hit));
            return true;
        }
        r->ray = joint_ray_through_hole(&no_joint, hit, &r->ray, NULL);
    }
    return false;
}

/* --- light that patches reflect --- */

/* Where a ray meets a patch: the shares of its sides that reflect light, and what they reflect of the light of samples
 * of lights. pdf: of positions on bright patches, by solid angle. */
struct reflection {
    uint32_t patch;
    double shares[3], sum, pdf;
    struct colour light;
};

double receive_brightness(const struct radiosity *radiosity, uint32_t patch, bool back) {
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        const struct side_light *side = &radiosity->sides[2 * patch_at(&radiosity->patches, patch)->vertex[k] + back];
        sum += colour_max_abs(colour_mul(side->reflectance, side->unshot));
    }
    return sum / 3;
}

static bool find_reflection(const struct receiver_ray *r, const struct hit *hit, struct reflection *out) {
    const struct receiver_input *input = r->receiver->input;
    const struct radiosity *radiosity = input->radiosity;
    const double cosine = fabs(vec3_dot(r->direction, hit->normal_geometric));
    const struct vec3 to = vec3_sub(hit->point, r->from.point);
    *out = (struct reflection){0};
    if (!patches_find(&radiosity->patches, hit, &out->patch, out->shares))
        return false;
    for (int k = 0; k < 3; k++) {
        uint32_t number = 2 * patch_at(&radiosity->patches, out->patch)->vertex[k] + !hit->front;
        const struct side_light *side = &radiosity->sides[number];
        out->shares[k] = side->area > 0 ? out->shares[k] : 0;
        out->sum += out->shares[k];
        out->light = colour_add_scaled(out->light, colour_mul(side->reflectance, side->unshot), out->shares[k]);
    }
    if (out->sum > 0)
        out->light = colour_scale(out->light, 1 / out->sum);
    if (input->power > 0)
        out->pdf = receive_brightness(radiosity, out->patch, !hit->front) / input->power * vec3_dot(to, to) / cosine;
    return true;
}

/* The side of a vertex of a hit, by the shares of those that reflect light; the ray meets what its patch reflects. */
static uint32_t find_target(struct receiver_ray *r, const struct hit *hit, double choice) {
    struct reflection there;
    int k = 0;
    if (!find_reflection(r, hit, &there))
        return SIDE_NONE;
    if (there.pdf > 0)
        meet(r, there.light, there.pdf);
    choice *= there.sum;
    while (k < 2 && choice >= there.shares[k])
        choice -= there.shares[k++];
    return there.shares[k] > 0
               ? 2 * patch_at(&r->receiver->input->radiosity->patches, there.patch)->vertex[k] + !hit->front
               : SIDE_NONE;
}

static struct receiver_ray start_ray(const struct receiver *receiver, const struct hit *from, struct vec3 direction) {
    struct receiver_ray r = {.receiver = receiver, .from = light_receiver_of(from), .direction = direction};
    const struct ray start = {.origin = r.from.from};
    r.pdf = intensity_of(vec3_dot(direction, from->view)) * rays_per_sample(receiver->input);
    r.ray = hit_ray(from, &start, direction, NULL);
    return r;
}

/* The intensity that arrives from a position on a bright patch, which is chosen by brightness and area. */
static struct colour light_of_patch(const struct receiver *receiver, const struct hit *from, uint32_t position) {
    const struct receiver_input *input = receiver->input;
    const struct patches *patches = &input->radiosity->patches;
    const double choice = stratified(receiver, position, 5).x;
    const uint32_t side = (uint32_t)sample_entry(input->until, 2 * patches->all.count, choice);
    const struct sample2 xi = stratified(receiver, position, 6);
    const double root = sqrt(xi.x), shares[3] = {1 - root, root * (1 - xi.y), root * xi.y};
    struct vec3 c[3], point = {0, 0, 0};
    struct reflection there;
    struct hit hit;
    patch_corners(patches, side / 2, c);
    for (int k = 0; k < 3; k++)
        point = vec3_add_scaled(point, c[k], shares[k]);
    struct receiver_ray r = start_ray(receiver, from, vec3_normalize(vec3_sub(point, from->point)));
    if (!(r.pdf > 0) || !follow_ray(&r, random_combine(receiver->key, position), &hit) ||
        !find_reflection(&r, &hit, &there) || there.patch != side / 2 || hit.front == (side & 1))
        return colour_all(0);
    return colour_scale(there.light, r.pdf / rays_per_sample(input) * power_weight(there.pdf, r.pdf) / there.pdf);
}

/* All of the scene is behind the surface, as outside of a room: no ray can meet anything. */
static bool sees_nothing(const struct box *bounds, const struct hit *from) {
    double far = math_max(vec3_max_abs(bounds->min), vec3_max_abs(bounds->max));
    bool nothing = isfinite(far);
    for (unsigned k = 0; nothing && k < 8; k++)
        nothing = vec3_dot(from->view, vec3_sub(box_corner(bounds, k), from->point)) <= 0x1p-44 * far;
    return nothing;
}

void receive_rays(const struct receiver_input *input, uint32_t side, struct world_scratch *scratch,
                  struct side_light *out, uint32_t *targets) {
    const struct world *world = input->radiosity->patches.world;
    const struct receiver receiver = receiver_make(input, side, scratch);
    const uint32_t n = (uint32_t)lround(sqrt(input->rays)), each = input->rays / RECEIVE_POSITIONS;
    const uint64_t key = random_combine(receiver.key, 4);
    struct colour sum = {0, 0, 0};
    for (uint32_t i = 0; i < input->rays; i++)
        targets[i] = SIDE_NONE;
    for (uint32_t i = 0; i < RECEIVE_POSITIONS; i++) {
        struct hit from, hit;
        struct bsdf bsdf;
        bool buried;
        if (!hit_of(&receiver, i, &from, &buried) || sees_nothing(&input->bounds, &from))
            continue;
        if (primitive_prototype(world, from.primitive)->holes) {
            material_eval(&world->surfaces, &from, NULL, &context, &bsdf);
            if (bsdf.opacity < 0.5)
                continue;
        }
        if (input->power > 0)
            sum = colour_add_scaled(sum, light_of_patch(&receiver, &from, i), each);
        for (uint32_t k = 0; k < each; k++) {
            uint32_t cell = sample_permute(i * each + k, input->rays, key);
            uint64_t own = random_combine(key, input->rays + cell);
            const struct sample2 xi = sample_cell(key, cell % n, cell / n, n);
            struct receiver_ray r = start_ray(&receiver, &from, sample_cosine(from.view, xi));
            if (follow_ray(&r, own, &hit))
                targets[i * each + k] = find_target(&r, &hit, random_unit(own));
            sum = colour_add(sum, r.light);
        }
    }
    out->light = colour_add_scaled(out->light, sum, out->weight);
}

/* --- digests --- */

struct digest receive_probe(const struct receiver_input *input, uint32_t primitive, const struct box *box, uint64_t key,
                            struct world_scratch *scratch, struct digest digest) {
    const struct world *world = input->lights->world;
    const struct vec3 size = vec3_sub(box->max, box->min);
    struct world_light_sample sample;
    struct crossing crossing;
    struct hit hit;
    struct bsdf bsdf;
    double pmf, x[10];
    for (int i = 0; i < 10; i++)
        x[i] = random_unit(random_combine(key, (uint64_t)i));
    const struct vec3 through = vec3_add(box->min, vec3_make(x[0] * size.x, x[1] * size.y, x[2] * size.z));
    struct ray ray = {.direction = vec3_make(x[3] - 0.5, x[4] - 0.5, x[5] - 0.5), .t_max = INFINITY};
    ray.origin = vec3_add_scaled(through, ray.direction, -x[6] * vec3_max_abs(size));
    if (!world_nearest_of(world, primitive, &ray, scratch, &crossing))
        return digest;
    world_describe(world, &ray, primitive, &crossing, &hit);
    material_eval(&world->surfaces, &hit, NULL, &context, &bsdf);
    const struct colour colours[] = {bsdf_diffuse(&bsdf), bsdf.emission};
    const double numbers[] = {crossing.t, bsdf.opacity, hit.normal.x, hit.normal.y, hit.normal.z};
    digest = digest_bytes(numbers, sizeof numbers, digest_bytes(colours, sizeof colours, digest));
    const struct light_receiver at = light_receiver_of(&hit);
    struct light_part part = light_sampler_sample(&input->lights->sampler, at.point, at.normal, x[7], &pmf);
    if (part.light == LIGHT_NONE ||
        !world_lights_sample(input->lights, &at, part, (struct sample2){x[8], x[9]}, &sample))
        return digest;
    digest = digest_bytes(&sample.radiance, sizeof sample.radiance, digest);
    return digest_bytes(&sample.direction, sizeof sample.direction, digest);
}
