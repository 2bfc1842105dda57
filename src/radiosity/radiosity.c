#include "radiosity/radiosity.h"

#include "base/mem.h"
#include "base/version.h"
#include "export/model_write.h"
#include "image/png_write.h"
#include "radiosity/receive_internal.h"
#include "world/world_lights.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { PROBES = 16384, PROBES_LIMIT = 256 }; /* rays for a digest: in all, and to a primitive */
enum { PASSES = 10000, RAYS_USUAL = 256, SMOOTH_STEPS = 2 };
enum { FINEST = 16 }; /* edges of patches are not divided below this part of the longest */
static const double first_contrast = 0.1, border_contrast = 0.3;

static void drop_factors(struct radiosity *radiosity) {
    mem_free(radiosity->first);
    mem_free(radiosity->receivers);
    radiosity->first = NULL;
    radiosity->receivers = NULL;
}

void radiosity_destroy(struct radiosity *radiosity) {
    drop_factors(radiosity);
    patches_destroy(&radiosity->patches);
    mem_free(radiosity->sides);
    *radiosity = (struct radiosity){.store = radiosity->store};
}

static void show_growth(const struct radiosity *radiosity) {
    if (radiosity->watch.grown)
        radiosity->watch.grown(radiosity->watch.context, radiosity);
}

static uint32_t side_count(const struct radiosity *radiosity) {
    return 2 * (uint32_t)radiosity->patches.vertices.count;
}

/* --- direct light and rays --- */

struct preparation {
    struct radiosity *out;
    const struct radiosity_input *input;
    struct world_lights lights;
    struct receiver_input receivers;
    struct arena arena;
    struct world_scratch *scratches; /* of each worker */
    uint32_t *sides, count;          /* those that send rays */
    uint32_t *targets;
    double *until;
};

static void find_direct_of(void *context, uint32_t side, int worker) {
    struct preparation *p = context;
    if (p->out->sides[side].area < 0)
        receive_direct(&p->receivers, side, &p->scratches[worker], &p->out->sides[side]);
}

static void find_rays_of(void *context, uint32_t item, int worker) {
    struct preparation *p = context;
    receive_rays(&p->receivers, p->sides[item], &p->scratches[worker], &p->out->sides[p->sides[item]],
                 p->targets + (size_t)item * p->receivers.rays);
}

static bool run(struct preparation *p, uint32_t count, pool_function *function, struct error *error) {
    bool whole = pool_run(p->input->pool, count, function, p), failed = false;
    for (int i = 0; i < pool_workers(p->input->pool); i++)
        failed = failed || p->scratches[i].failed;
    if (failed)
        return error_no_memory(error, "radiosity");
    return whole || error_set(error, ERROR_CANCELLED, "stopped while radiosity was computed");
}

/* The direct light of all vertices whose patches have changed: one of their vertices is new. */
static bool find_direct(struct preparation *p, uint32_t old_vertices, struct error *error) {
    struct radiosity *out = p->out;
    struct side_light *sides = mem_resize_array(out->sides, side_count(out), sizeof *sides);
    out->sides = sides ? sides : out->sides;
    if (!sides || !patches_index(&out->patches, error))
        return error_no_memory(error, "radiosity");
    for (uint32_t i = 0; i < 3 * out->patches.all.count; i++) {
        const uint32_t *vertex = patch_at(&out->patches, i / 3)->vertex, own = vertex[i % 3];
        if (vertex[0] >= old_vertices || vertex[1] >= old_vertices || vertex[2] >= old_vertices)
            sides[2 * own].area = sides[2 * own + 1].area = -1;
    }
    return run(p, side_count(out), find_direct_of, error);
}

/* --- adaptive division --- */

static double mean_light(const struct radiosity *radiosity) {
    double sum = 0, area = 0;
    for (uint32_t i = 0; i < side_count(radiosity); i++) {
        const struct side_light *side = &radiosity->sides[i];
        sum += side->area * colour_max_abs(side->light);
        area += side->area;
    }
    return area > 0 ? sum / area : 0;
}

/* How different the light is at the ends of an edge: at most 1 on each side. */
static double contrast(const struct radiosity *radiosity, uint32_t a, uint32_t b, double mean) {
    double largest = 0;
    for (uint32_t back = 0; back < 2; back++) {
        const struct side_light *x = &radiosity->sides[2 * a + back], *y = &radiosity->sides[2 * b + back];
        /* Patches at the border of another solid are partly inside of it. */
        if ((x->buried > 0) != (y->buried > 0) || (x->buried > 0 && x->buried < 1 && y->buried < 1))
            largest = math_max(largest, border_contrast);
        double level = colour_max_abs(x->light) + colour_max_abs(y->light) + mean;
        if (x->area > 0 && y->area > 0 && level > 0)
            largest = math_max(largest, colour_max_abs(colour_sub(x->light, y->light)) / level);
    }
    return largest;
}

/* Marks the edges whose contrast, times their share of the longest, is above a limit. */
static bool mark_edges(const struct radiosity *radiosity, double limit, struct key_map *edges) {
    const struct patches *patches = &radiosity->patches;
    double mean = mean_light(radiosity);
    for (uint32_t i = 0; i < 3 * patches->all.count; i++) {
        const uint32_t *vertex = patch_at(patches, i / 3)->vertex;
        uint32_t a = vertex[i % 3], b = vertex[(i + 1) % 3];
        double length = vec3_length(vec3_sub(patch_vertex_at(patches, a)->point, patch_vertex_at(patches, b)->point));
        double share = math_min(length / patches->edge, 1);
        if (share * FINEST > 1 && contrast(radiosity, a, b, mean) * sqrt(share) > limit && !patches_mark(edges, a, b))
            return false;
    }
    return true;
}

/* Divides patches where direct light changes, those of most contrast first if there may not be enough patches. */
static bool refine(struct preparation *p, struct error *error) {
    struct radiosity *out = p->out;
    bool done = true, ok = true;
    for (double limit = first_contrast; ok && limit < 1;) {
        struct key_map edges = {0};
        uint32_t old = (uint32_t)out->patches.vertices.count;
        ok = mark_edges(out, limit, &edges) || error_no_memory(error, "radiosity");
        size_t count = edges.count;
        ok = ok && patches_divide(&out->patches, &edges, p->input->limit, &done, error);
        key_map_destroy(&edges);
        if (count == 0)
            return ok;
        if (!done)
            limit *= 1.5;
        else
            ok = ok && find_direct(p, old, error);
    }
    return ok;
}

/* What bright patches reflect is sampled like light of lights: the shares of both sides of each. */
static bool find_bright_patches(struct preparation *p) {
    const struct patches *patches = &p->out->patches;
    double sum = 0;
    p->until = mem_alloc(2 * patches->all.count * sizeof *p->until);
    for (uint32_t i = 0; p->until && i < 2 * patches->all.count; i++) {
        struct vec3 c[3];
        patch_corners(patches, i / 2, c);
        sum += patch_area(c) * receive_brightness(p->out, i / 2, i % 2);
        p->until[i] = sum;
    }
    for (uint32_t i = 0; p->until && i < 2 * patches->all.count; i++)
        p->until[i] /= sum;
    p->receivers.until = p->until;
    p->receivers.power = sum;
    return p->until != NULL;
}

/* What rays of all sides meet, and from that the receivers of each side. */
static bool find_rays(struct preparation *p, struct error *error) {
    struct radiosity *out = p->out;
    for (uint32_t i = 0; i < side_count(out); i++)
        out->sides[i].unshot = out->sides[i].light;
    p->sides = mem_alloc((size_t)side_count(out) * sizeof *p->sides);
    for (uint32_t i = 0; p->sides && i < side_count(out); i++)
        if (out->sides[i].area > 0)
            p->sides[p->count++] = i;
    if (p->sides && p->count == 0)
        return error_set(
            error, ERROR_SCENE,
            "--integrator radiosity needs a diffuse surface with an end and an area, and the scene has none");
    p->targets = mem_alloc((size_t)p->count * p->receivers.rays * sizeof *p->targets);
    if (!p->sides || !p->targets || !find_bright_patches(p))
        return error_no_memory(error, "radiosity");
    if (!patches_index_space(&out->patches, p->input->pool, error))
        return false;
    show_growth(out);
    if (!run(p, p->count, find_rays_of, error))
        return false;
    const size_t all = (size_t)p->count * p->receivers.rays;
    if (!patches_group(p->targets, all, side_count(out), &out->first, &out->receivers))
        return error_no_memory(error, "radiosity");
    for (size_t i = 0; i < out->first[side_count(out)]; i++)
        out->receivers[i] = p->sides[out->receivers[i] / p->receivers.rays];
    return true;
}

/* --- preparation --- */

/* Lights are sampled, and rays meet emitters: neither can be done with one that has no end. */
static bool check_emitters(const struct world *world, struct error *error) {
    for (uint32_t i = 0; i < world->primitive_count; i++) {
        const struct box *box = &world->boxes[i];
        if (!box_is_empty(box) && !(vec3_finite(box->min) && vec3_finite(box->max)) &&
            primitive_has_material(world, i, receive_is_emissive))
            return error_set(error, ERROR_SCENE,
                             "--integrator radiosity: '%.100s' emits light and has no end; emitters have to be finite",
                             primitive_node(world, i)->name);
    }
    return true;
}

static bool begin_preparation(struct preparation *p, struct error *error) {
    const struct world *world = p->input->world;
    struct world_lights_options options = {p->input->background, LIGHT_CHOICE_TREE};
    int workers = pool_workers(p->input->pool);
    p->receivers = (struct receiver_input){.radiosity = p->out,
                                           .lights = &p->lights,
                                           .buries = mem_alloc_zero((size_t)world->primitive_count + 1, 1),
                                           .emissive = mem_alloc_zero((size_t)world->material_count + 1, 1),
                                           .bounds = box_empty(),
                                           .seed = random_combine(p->input->seed, UINT64_C(0x7261646973)),
                                           .rays = p->input->rays ? p->input->rays : RAYS_USUAL};
    p->scratches = mem_alloc_zero((size_t)workers, sizeof *p->scratches);
    bool ok = p->receivers.buries && p->receivers.emissive && p->scratches;
    for (int i = 0; ok && i < workers; i++)
        ok = world_scratch_init(&p->scratches[i], world);
    if (!ok)
        return error_no_memory(error, "radiosity");
    receive_find_buries(world, p->receivers.buries);
    for (uint32_t i = 0; i < world->material_count; i++)
        p->receivers.emissive[i] = receive_is_emissive(world, i);
    for (uint32_t i = 0; i < world->primitive_count; i++)
        p->receivers.bounds = box_join(p->receivers.bounds, world->boxes[i]);
    if (!check_emitters(world, error) ||
        !world_lights_build(&p->lights, world, options, &p->arena, p->input->pool, error))
        return false;
    if (p->lights.area_light_count > 0 || p->lights.sampler.infinite_count > 0)
        p->receivers.bounds = box_grow(p->receivers.bounds, INFINITY);
    return true;
}

/* What the solution depends on. Numbers of lights and materials, placements and meshes are complete; other shapes,
 * textures and skies are seen by rays. */
static struct digest digest_of(const struct preparation *p) {
    const struct radiosity_input *input = p->input;
    const struct world *world = input->world;
    const double numbers[] = {input->background, input->limit, input->rays, (double)input->seed, input->error_share};
    const double fair = PROBES / (world->primitive_count + 1.0);
    const uint32_t probes = (uint32_t)math_min(math_max(fair, 2), PROBES_LIMIT);
    struct box bounds = world_finite_bounds(world);
    struct digest digest = digest_bytes(GRAY_VERSION, sizeof GRAY_VERSION, (struct digest){1, 1});
    digest = digest_bytes(numbers, sizeof numbers, digest);
    digest = digest_bytes(world->boxes, world->primitive_count * sizeof *world->boxes, digest);
    /* Lights: all numbers. */
    for (uint32_t i = 0; i < world->light_count; i++) {
        const struct light *l = &world->lights[i];
        const struct vec3 positions[] = {l->position, l->corner, l->edge1, l->edge2, l->direction};
        const double of_light[] = {l->kind,       l->colour.r,   l->colour.g, l->colour.b,  l->falloff[0],
                                   l->falloff[1], l->falloff[2], l->range,    l->intensity, l->cos_inner,
                                   l->cos_outer,  l->radius,     l->emissive, l->one_sided, light_brightest(l)};
        digest = digest_bytes(of_light, sizeof of_light, digest_bytes(positions, sizeof positions, digest));
    }
    /* Materials: what they reflect and emit in the mean. */
    for (uint32_t i = 0; i < world->material_count; i++) {
        const struct surface_material *surface = &world->surfaces.materials[i];
        const struct colour colours[] = {surface_diffuse(&world->surfaces, surface),
                                         surface_emission(&world->surfaces, surface)};
        digest = digest_bytes(colours, sizeof colours, digest);
    }
    /* Meshes: all triangles. */
    for (uint32_t i = 0; i < world->prototype_count; i++) {
        const struct mesh *mesh = geometry_mesh(&world->prototypes[i].geometry);
        struct vec3 corners[3];
        uint32_t slot;
        for (uint32_t k = 0; mesh && k < mesh_triangle_count(mesh); k++) {
            mesh_triangle(mesh, k, corners, &slot);
            digest = digest_bytes(corners, sizeof corners, digest_bytes(&slot, sizeof slot, digest));
        }
    }
    /* Primitives: their placement, and what random rays meet. */
    for (uint32_t i = 0; i < world->primitive_count; i++) {
        const uint32_t flags[] = {patches_kind(world, i), primitive_prototype(world, i)->holes, p->receivers.buries[i]};
        const struct transform placement = world_placement(world, i, 0);
        const struct box *own = &world->boxes[i], box = box_meet(*own, box_is_empty(&bounds) ? *own : bounds);
        digest = digest_bytes(flags, sizeof flags, digest);
        digest = digest_bytes(&placement.forward, sizeof placement.forward, digest);
        for (uint32_t k = 0; !box_is_empty(&box) && k < probes; k++)
            digest = receive_probe(&p->receivers, i, &box, random_combine(p->receivers.seed, (uint64_t)i * PROBES + k),
                                   &p->scratches[0], digest);
    }
    return digest;
}

static bool solve(struct preparation *p, struct error *error) {
    struct radiosity *out = p->out;
    bool ok = patches_build(&out->patches, p->input->world, p->input->limit, p->input->pool, error) &&
              find_direct(p, 0, error) && refine(p, error) && find_rays(p, error);
    for (uint32_t i = 0; ok && i < p->count; i++)
        out->sides[p->sides[i]].unshot = colour_sub(out->sides[p->sides[i]].light, out->sides[p->sides[i]].unshot);
    return ok;
}

static void end_preparation(struct preparation *p) {
    world_lights_destroy(&p->lights);
    for (int i = 0; p->scratches && i < pool_workers(p->input->pool); i++)
        world_scratch_destroy(&p->scratches[i]);
    arena_destroy(&p->arena);
    mem_free(p->scratches);
    mem_free(p->receivers.buries);
    mem_free(p->receivers.emissive);
    mem_free(p->sides);
    mem_free(p->targets);
    mem_free(p->until);
}

bool radiosity_prepare(struct radiosity *radiosity, const struct radiosity_input *input, struct error *error) {
    struct preparation p = {.out = radiosity, .input = input};
    *radiosity = (struct radiosity){0};
    bool ok = begin_preparation(&p, error) && solve(&p, error);
    end_preparation(&p);
    if (!ok)
        radiosity_destroy(radiosity);
    return ok;
}

void radiosity_warn(const struct world *world, world_warning *warn, void *context) {
    uint32_t i = 0;
    char text[512];
    while (i < world->primitive_count && patches_kind(world, i) != PATCHES_BARE)
        i++;
    if (i == world->primitive_count)
        return;
    (void)snprintf(
        text, sizeof text,
        "'%.100s' is open or without end, so radiosity has no patches there: it shows the lights alone, like "
        "all such objects",
        primitive_node(world, i)->name);
    warn(context, text);
}

/* --- solution --- */

static double power_of(const struct side_light *side, struct colour light) {
    struct colour reflected = colour_abs(colour_mul(side->reflectance, light));
    return side->area * (reflected.r + reflected.g + reflected.b);
}

/* A side gives its unshot light to all that its surface is seen from. */
static void shoot(struct radiosity *radiosity, uint32_t from) {
    struct side_light *side = &radiosity->sides[from];
    const struct colour shot = colour_mul(side->reflectance, side->unshot);
    side->unshot = colour_all(0);
    for (size_t i = radiosity->first[from]; i < radiosity->first[from + 1]; i++) {
        struct side_light *to = &radiosity->sides[radiosity->receivers[i]];
        const struct colour add = colour_scale(shot, to->weight);
        to->light = colour_add(to->light, add);
        to->unshot = colour_add(to->unshot, add);
    }
}

static void show_unshot(const struct radiosity *radiosity, double share) {
    if (radiosity->store)
        atomic_store_explicit(radiosity->store->unshot, (float)share, memory_order_relaxed);
}

bool radiosity_shoot(struct radiosity *radiosity, double error_share, struct pool *pool) {
    const uint32_t count = side_count(radiosity);
    for (int pass = 0; pass < PASSES; pass++) {
        double all = 0, unshot = 0, largest = 0;
        for (uint32_t i = 0; i < count; i++) {
            const struct side_light *side = &radiosity->sides[i];
            double own = power_of(side, side->unshot);
            all += power_of(side, side->light);
            unshot += own;
            largest = math_max(largest, own);
        }
        radiosity->left = all > 0 ? unshot / all : 0;
        show_unshot(radiosity, radiosity->left);
        if (!(radiosity->left > error_share))
            return true;
        show_growth(radiosity);
        if (pool_cancelled(pool))
            return false;
        /* All that have at least half of the largest, by number. */
        for (uint32_t i = 0; i < count; i++)
            if (power_of(&radiosity->sides[i], radiosity->sides[i].unshot) >= 0.5 * largest)
                shoot(radiosity, i);
    }
    return true;
}

/* The mean over the patches of the vertex of a side, weighted as products of hat functions, which keeps the power. */
static struct colour smooth(const struct radiosity *radiosity, uint32_t own, const struct colour *from) {
    const struct patches *patches = &radiosity->patches;
    struct colour sum = {0, 0, 0};
    double weights = 0;
    if (!(radiosity->sides[own].area > 0))
        return from[own];
    for (size_t i = patches->first[own / 2]; i < patches->first[own / 2 + 1]; i++) {
        struct vec3 c[3];
        patch_corners(patches, patches->of_vertex[i], c);
        double area = patch_area(c);
        for (int k = 0; k < 3; k++) {
            const uint32_t side = 2 * patch_at(patches, patches->of_vertex[i])->vertex[k] + own % 2;
            double weight = radiosity->sides[side].area > 0 ? area * (side == own ? 2 : 1) : 0;
            sum = colour_add_scaled(sum, from[side], weight);
            weights += weight;
        }
    }
    return colour_scale(sum, 1 / weights);
}

bool radiosity_finish(struct radiosity *radiosity, double error_share, struct pool *pool, struct error *error) {
    const uint32_t count = side_count(radiosity);
    struct colour *direct = mem_alloc(count * sizeof *direct), *indirect = mem_alloc(count * sizeof *indirect);
    struct colour *smoothed = mem_alloc(count * sizeof *smoothed);
    bool ok = (direct && indirect && smoothed) || error_no_memory(error, "radiosity");
    for (uint32_t i = 0; ok && i < count; i++)
        direct[i] = colour_sub(radiosity->sides[i].light, radiosity->sides[i].unshot);
    if (ok && !radiosity_shoot(radiosity, error_share, pool))
        ok = error_set(error, ERROR_CANCELLED, "stopped while radiosity was computed");
    for (uint32_t i = 0; ok && i < count; i++)
        indirect[i] = colour_sub(radiosity->sides[i].light, direct[i]);
    for (int step = 0; ok && step < SMOOTH_STEPS; step++) {
        for (uint32_t i = 0; i < count; i++)
            smoothed[i] = smooth(radiosity, i, indirect);
        memcpy(indirect, smoothed, count * sizeof *indirect);
    }
    for (uint32_t i = 0; ok && i < count; i++)
        radiosity->sides[i].light = colour_add(direct[i], indirect[i]);
    drop_factors(radiosity);
    mem_free(direct);
    mem_free(indirect);
    mem_free(smoothed);
    return ok;
}

/* --- solutions that are kept --- */

struct kept_head {
    uint64_t vertices, patches;
    double edge, left;
};

bool radiosity_write(const struct radiosity *radiosity, struct list *out) {
    const struct patches *patches = &radiosity->patches;
    const struct kept_head head = {patches->vertices.count, patches->all.count, patches->edge, radiosity->left};
    return list_add_bytes(out, &head, sizeof head) &&
           list_add_bytes(out, patches->vertices.items, head.vertices * sizeof(struct patch_vertex)) &&
           list_add_bytes(out, patches->all.items, head.patches * sizeof(struct patch)) &&
           list_add_bytes(out, radiosity->sides, 2 * head.vertices * sizeof *radiosity->sides);
}

/* Whether all numbers are what a solution may have. */
static bool is_valid(const struct radiosity *radiosity) {
    const struct patches *patches = &radiosity->patches;
    const uint32_t primitives = patches->world->primitive_count;
    bool valid = isfinite(patches->edge) && patches->edge > 0;
    for (uint32_t i = 0; valid && i < patches->vertices.count; i++)
        valid = vec3_finite(patch_vertex_at(patches, i)->point) && patch_vertex_at(patches, i)->primitive < primitives;
    for (uint32_t i = 0; valid && i < 3 * patches->all.count; i++)
        valid = patch_at(patches, i / 3)->vertex[i % 3] < patches->vertices.count;
    for (uint32_t i = 0; valid && i < side_count(radiosity); i++) {
        const struct side_light *side = &radiosity->sides[i];
        valid = side->area >= 0 && isfinite(colour_max_abs(side->light)) && isfinite(colour_max_abs(side->reflectance));
    }
    return valid;
}

bool radiosity_read(struct radiosity *out, const struct radiosity_input *input, const struct list *bytes,
                    struct error *error) {
    struct patches *patches = &out->patches;
    struct kept_head head = {0};
    const char *at = bytes->items;
    if (bytes->count >= sizeof head)
        memcpy(&head, at, sizeof head);
    bool fits = head.vertices > 0 && head.vertices < UINT32_MAX / 2 && head.patches < UINT32_MAX / 3 &&
                bytes->count == sizeof head + head.patches * sizeof(struct patch) +
                                    head.vertices * (sizeof(struct patch_vertex) + 2 * sizeof(struct side_light));
    at += sizeof head;
    if (fits) {
        *patches = (struct patches){.world = input->world, .edge = head.edge};
        if (!list_add(&patches->vertices, at, head.vertices, sizeof(struct patch_vertex)) ||
            !list_add(&patches->all, at + head.vertices * sizeof(struct patch_vertex), head.patches,
                      sizeof(struct patch)) ||
            !(out->sides = mem_alloc(2 * head.vertices * sizeof *out->sides)))
            return error_no_memory(error, "radiosity");
        memcpy(out->sides, at + head.vertices * sizeof(struct patch_vertex) + head.patches * sizeof(struct patch),
               2 * head.vertices * sizeof *out->sides);
        out->left = head.left;
    }
    return fits && is_valid(out) ? patches_index_space(patches, input->pool, error)
                                 : error_set(error, ERROR_SCENE, "the solution of radiosity that was kept is damaged");
}

static bool find_solution(struct preparation *p, struct error *error) {
    struct radiosity *out = p->out;
    const struct radiosity_store *store = out->store;
    struct list bytes = {0};
    bool keeps = store && store->load, ok = !keeps || store->load(store->context, out->digest, &bytes, error);
    if (ok && bytes.count > 0) {
        ok = radiosity_read(out, p->input, &bytes, error);
    } else if (ok) {
        show_unshot(out, 1);
        ok = solve(p, error) && radiosity_finish(out, p->input->error_share, p->input->pool, error);
        show_unshot(out, 0);
        if (ok && keeps && radiosity_write(out, &bytes)) /* without memory it is not kept */
            store->save(store->context, out->digest, &bytes);
    }
    list_destroy(&bytes);
    return ok;
}

bool radiosity_update(struct radiosity *radiosity, const struct radiosity_input *input, struct error *error) {
    struct radiosity next = {.watch = input->watch, .store = radiosity->store};
    struct preparation p = {.out = &next, .input = input};
    bool ok = begin_preparation(&p, error), same = false;
    if (ok) {
        next.digest = digest_of(&p);
        same = digest_equal(next.digest, radiosity->digest);
        ok = same || find_solution(&p, error);
    }
    end_preparation(&p);
    if (same)
        radiosity->patches.world = input->world;
    if (!ok || same) {
        radiosity_destroy(&next);
        return ok;
    }
    radiosity_destroy(radiosity);
    *radiosity = next;
    radiosity->watch = (struct radiosity_watch){0};
    return true;
}

bool radiosity_bake(const struct radiosity *radiosity, const struct tone *tone, enum model_format format,
                    struct list *out) {
    const struct patches *patches = &radiosity->patches;
    struct vec3 *points = mem_alloc(patches->vertices.count * sizeof *points);
    uint8_t(*colours)[3] = mem_alloc(patches->vertices.count * sizeof *colours);
    bool ok = points && colours;
    for (uint32_t i = 0; ok && i < patches->vertices.count; i++) {
        const struct side_light *side = &radiosity->sides[2 * i];
        side += !(side->area > 0);
        const struct colour light = colour_mul(side->reflectance, side->light);
        points[i] = patch_vertex_at(patches, i)->point;
        for (int k = 0; k < 3; k++)
            colours[i][k] = png_write_byte(tone_apply(tone, colour_get(light, k)));
    }
    const struct coloured_mesh mesh = {points, (const uint8_t(*)[3])colours, patches->all.items,
                                       patches->vertices.count, patches->all.count};
    ok = ok && coloured_mesh_write(&mesh, format, out);
    mem_free(points);
    mem_free(colours);
    return ok;
}

bool radiosity_light(const struct radiosity *radiosity, const struct hit *hit, struct colour *light) {
    uint32_t patch;
    double shares[3], sum = 0;
    *light = colour_all(0);
    if (!patches_find(&radiosity->patches, hit, &patch, shares))
        return false;
    for (int k = 0; k < 3; k++) {
        const struct side_light *side =
            &radiosity->sides[2 * patch_at(&radiosity->patches, patch)->vertex[k] + !hit->front];
        if (!(side->area > 0))
            continue;
        *light = colour_add_scaled(*light, side->light, shares[k]);
        sum += shares[k];
    }
    if (sum > 0)
        *light = colour_scale(*light, 1 / sum);
    return sum > 0;
}
