/* Rays of a pinhole go through the scene in packets of 8 x 8 pixels; those of other cameras one by one. */
#include "render/headlight.h"

#include "base/mem.h"
#include "material/bsdf_select.h"
#include "material/material_eval.h"
#include "math/elementary.h"
#include "radiosity/radiosity.h"
#include "render/camera.h"
#include "world/packet.h"
#include "world/world_describe.h"

#include <float.h>
#include <math.h>

enum { SIDE = 8, HOLES = 16 }; /* of a packet; that a ray may pass */
enum { STRIPS = (FILM_TILE + SIDE - 1) / SIDE };
/* The share of light from everywhere, and of reflected or transmitted light in the colour of a surface. */
static const double ambient = 0.25, glossy = 0.6;
/* How well a surface needs to be located, in pixels. */
static const double tolerance = 0.25;

_Static_assert((int)SIDE *SIDE == (int)PACKET_RAYS, "a patch is a packet");

struct headlight {
    const struct render_job *job;
    struct pool *pool;
    struct camera_frame camera;
    struct world_scratch *scratch;  /* by worker */
    _Atomic uint32_t *rows_done;    /* by tile: rows of squares */
    double brightness;              /* that undoes the exposure */
    const struct radiosity *stored; /* light of diffuse surfaces, or NULL */
    enum headlight_shows shows;
    uint8_t state;
    uint32_t patch;
    double nearest, farthest; /* of all finite objects, from the eye; of depths */
    bool plain;
    bool coarse;
};

/* The surface in the other pictures. */
static struct colour describe(const struct headlight *headlight, const struct hit *hit, const struct bsdf *bsdf) {
    struct vec3 n = bsdf->side;
    double distance = vec3_length(vec3_sub(hit->point, headlight->camera.eye));
    struct colour colour =
        headlight->shows == HEADLIGHT_NORMALS
            ? colour_make(0.5 + 0.5 * n.x, 0.5 + 0.5 * n.y, 0.5 + 0.5 * n.z)
            : colour_all((headlight->farthest - distance) / (headlight->farthest - headlight->nearest + DBL_MIN));
    return colour_scale(colour, headlight->brightness);
}

/* From blue for 0 over green to red for 1. */
static struct colour heat(const struct headlight *headlight, double share) {
    double t = math_min(math_max(share, 0), 1), high = math_max(2 * t - 1, 0);
    return colour_scale(colour_make(high, math_min(2 * t, 1) - high, math_max(1 - 2 * t, 0)), headlight->brightness);
}

/* What a surface reflects of the stored light, and its mirrors of the light at the eye. False: it has none. */
static bool shade_stored(const struct headlight *headlight, const struct hit *hit, const struct bsdf *bsdf,
                         struct colour *out) {
    struct colour light, shiny = {0, 0, 0};
    if (!headlight->stored || bsdf->dark || !radiosity_light(headlight->stored, hit, &light))
        return false;
    for (int i = 0; i < bsdf->count; i++)
        if (lobe_flags(bsdf->lobes[i].kind) & BSDF_TRACED)
            shiny = colour_add_scaled(shiny, bsdf->lobes[i].weight, ambient);
    *out = colour_add(bsdf->emission, colour_mul(bsdf_diffuse(bsdf), light));
    *out = colour_add_scaled(*out, shiny, headlight->brightness);
    return true;
}

static bool is_of_patch(const struct headlight *headlight, const struct hit *hit) {
    const struct patches *patches = &headlight->stored->patches;
    uint32_t patch;
    double shares[3];
    return hit->primitive == patch_primitive(patches, headlight->patch) && patches_find(patches, hit, &patch, shares) &&
           patch == headlight->patch;
}

/* The form factor from the surface to the patch: four equal parts of it are visible or not, and are seen as discs are
 * (J. Wallace and others as in radiosity.h). */
static double form_factor(const struct headlight *headlight, struct world_scratch *scratch, const struct ray *from,
                          const struct hit *hit, struct vec3 normal) {
    enum { PARTS = 4 };
    const struct patches *patches = &headlight->stored->patches;
    struct vec3 c[3];
    double factor = 0;
    patch_corners(patches, headlight->patch, c);
    const double area = patch_area(c) / PARTS;
    for (int i = 0; i < PARTS; i++) {
        const double share[3] = {i == 0 || i == 3 ? 4 : 1, i == 1 || i == 3 ? 4 : 1, i == 2 || i == 3 ? 4 : 1};
        struct vec3 to = vec3_negate(hit->point);
        for (int k = 0; k < 3; k++)
            to = vec3_add_scaled(to, c[k], share[k] / (share[0] + share[1] + share[2]));
        struct ray ray = hit_ray(hit, from, to, from->media);
        struct hit occluder;
        bool met = world_nearest_surface(headlight->job->world, &ray, scratch, &occluder) && occluder.t < 1 - 1e-6;
        double squared = vec3_length_squared(to);
        double cosines = vec3_dot(to, normal) * fabs(vec3_dot(to, vec3_normalize(patch_normal(c)))) / squared;
        if (!met || is_of_patch(headlight, &occluder))
            factor += math_max(0, cosines) * area / (PI * squared + area);
    }
    return factor;
}

/* The patch itself is white. */
static struct colour show_factor(const struct headlight *headlight, struct world_scratch *scratch,
                                 const struct ray *from, const struct hit *hit, struct vec3 normal) {
    if (is_of_patch(headlight, hit))
        return colour_all(headlight->brightness);
    double factor = form_factor(headlight, scratch, from, hit, normal);
    return factor > 0 ? heat(headlight, 1 + el_log2(factor) / 16) : colour_all(0);
}

static struct colour shade(const struct headlight *headlight, const struct ray *ray, const struct hit *hit,
                           const struct bsdf *bsdf) {
    struct colour stored;
    if (shade_stored(headlight, hit, bsdf, &stored))
        return stored;
    struct vec3 to_eye = vec3_negate(vec3_normalize(ray->direction));
    struct colour colour = bsdf->albedo;
    double share =
        glossy * math_max(0, 1 - colour_max_abs(colour)); /* what a coat reflects does not hide the colour below */
    for (int i = 0; i < bsdf->count; i++) {
        if (lobe_flags(bsdf->lobes[i].kind) & BSDF_TRACED)
            colour = colour_add_scaled(colour, bsdf->lobes[i].weight, share);
    }
    double largest = colour_max_abs(colour), facing = fabs(vec3_dot(bsdf->side, to_eye));
    double light = headlight->brightness * (ambient + (1 - ambient) * facing) / math_max(1, largest);
    return colour_add(colour_scale(colour, light), bsdf->emission);
}

/* The colour along a ray. met: its hit, or NULL. */
static struct colour colour_of(const struct headlight *headlight, struct world_scratch *scratch, struct ray ray,
                               const struct packet_answer *met) {
    const struct world *world = headlight->job->world;
    struct hit hit;
    struct bsdf bsdf;
    bool found = met != NULL;
    if (met)
        world_describe(world, &ray, met->primitive, &met->crossing, &hit);
    if (headlight->coarse)
        hit.footprint = 0;
    for (int i = 0; found && i < HOLES; i++) {
        material_eval(&world->surfaces, &hit, NULL, NULL, &bsdf);
        if (bsdf.opacity >= 0.5 && headlight->shows == HEADLIGHT_FACTORS)
            return show_factor(headlight, scratch, &ray, &hit, bsdf.side);
        if (bsdf.opacity >= 0.5)
            return headlight->shows == HEADLIGHT_SURFACES ? shade(headlight, &ray, &hit, &bsdf)
                                                          : describe(headlight, &hit, &bsdf);
        ray = hit_ray(&hit, &ray, ray.direction, ray.media);
        found = world_nearest_surface(world, &ray, scratch, &hit);
    }
    if (headlight->shows != HEADLIGHT_SURFACES)
        return colour_all(0);
    return sky_colour(&world->sky, vec3_normalize(ray.direction), ray.footprint.spread);
}

static void store(struct film_pixel *pixel, struct colour colour) {
    const double parts[3] = {colour.r, colour.g, colour.b};
    for (int c = 0; c < 3; c++)
        pixel->rgb[c] = isfinite(parts[c]) ? (float)math_min(math_max(parts[c], 0), 1e30) : 0;
}

/* Other lenses: a ray through the middle of each pixel. */
static void render_single(const struct headlight *headlight, struct world_scratch *scratch, uint32_t x, uint32_t y,
                          struct film_pixel *pixel) {
    struct ray ray;
    struct packet_answer met;
    struct colour colour = {0, 0, 0};
    uint64_t before = geom_work(&scratch->geom);
    if (camera_ray_through(&headlight->camera, x + 0.5, y + 0.5, (struct sample2){0.5, 0.5}, NULL, &ray)) {
        bool found = world_nearest_crossing(headlight->job->world, &ray, scratch, &met.primitive, &met.crossing);
        colour = colour_of(headlight, scratch, ray, found ? &met : NULL);
        if (headlight->shows == HEADLIGHT_COST)
            colour = heat(headlight, el_log2(1 + (double)(geom_work(&scratch->geom) - before)) / 12);
    }
    store(pixel, colour);
}

/* The pixels of a patch, at most 8 x 8. */
static void render_patch(const struct headlight *headlight, struct world_scratch *scratch,
                         const struct film_rectangle *r) {
    const struct film *film = headlight->job->film;
    struct ray_packet packet = {.origin = headlight->camera.eye};
    struct packet_answer answers[PACKET_RAYS];
    struct ray rays[PACKET_RAYS];
    for (uint32_t y = r->y0; y < r->y1; y++) {
        for (uint32_t x = r->x0; x < r->x1; x++) {
            struct ray ray = rays[packet.count] = camera_ray(&headlight->camera, x + 0.5, y + 0.5);
            packet.direction[0][packet.count] = ray.direction.x;
            packet.direction[1][packet.count] = ray.direction.y;
            packet.direction[2][packet.count] = ray.direction.z;
            packet.t_max[packet.count++] = ray.t_max;
        }
    }
    ray_packet_pad(&packet);
    uint64_t met = world_nearest_packet(headlight->job->world, &packet, scratch, answers);
    uint32_t width = r->x1 - r->x0;
    for (uint32_t i = 0; i < packet.count; i++) {
        size_t at = (size_t)(r->y0 - film->y0 + i / width) * film->width + (r->x0 - film->x0 + i % width);
        store(&film->pixels[at], colour_of(headlight, scratch, rays[i], met >> i & 1 ? &answers[i] : NULL));
    }
}

static void render_square(const struct headlight *headlight, struct world_scratch *scratch,
                          const struct film_rectangle *r) {
    const struct film *film = headlight->job->film;
    if (headlight->plain)
        render_patch(headlight, scratch, r);
    for (uint32_t v = r->y0; !headlight->plain && v < r->y1; v++)
        for (uint32_t u = r->x0; u < r->x1; u++)
            render_single(headlight, scratch, u, v,
                          &film->pixels[(size_t)(v - film->y0) * film->width + (u - film->x0)]);
}

/* A pool_function: some rows of a tile. Few tiles would leave threads without work, and a tile of a costly solid takes
 * too long to stop. Squares that are not rendered are missing in the count of the tile, which is not done then. */
static void render_strip(void *context, uint32_t item, int worker) {
    const struct headlight *headlight = context;
    const struct film *film = headlight->job->film;
    uint32_t tile = item / STRIPS;
    struct film_rectangle whole = film_tile_rectangle(film, tile);
    uint32_t y = whole.y0 + item % STRIPS * SIDE, rows = (whole.y1 - whole.y0 + SIDE - 1) / SIDE;
    if (y >= whole.y1 || atomic_load_explicit(&film->tiles[tile], memory_order_relaxed) == FILM_TILE_DONE)
        return;
    for (uint32_t x = whole.x0; x < whole.x1; x += SIDE) {
        struct film_rectangle r = {x, y, x + SIDE < whole.x1 ? x + SIDE : whole.x1,
                                   y + SIDE < whole.y1 ? y + SIDE : whole.y1};
        pool_poll(headlight->pool, worker);
        if (pool_cancelled(headlight->pool))
            return;
        render_square(headlight, &headlight->scratch[worker], &r);
    }
    if (atomic_fetch_add(&headlight->rows_done[tile], 1) + 1 == rows)
        atomic_store_explicit(&film->tiles[tile], headlight->state, memory_order_release);
}

static void measure_depths(struct headlight *headlight) {
    struct box bounds = world_finite_bounds(headlight->job->world);
    struct vec3 before = vec3_sub(bounds.min, headlight->camera.eye),
                behind = vec3_sub(headlight->camera.eye, bounds.max);
    headlight->nearest = vec3_length(vec3_max(vec3_max(before, behind), vec3_all(0)));
    headlight->farthest = vec3_length(vec3_max(vec3_negate(before), vec3_negate(behind)));
}

bool render_headlight(const struct render_job *job, const struct headlight_request *request, struct pool *pool,
                      struct render_statistics *statistics, struct error *error) {
    const enum headlight_shows shows = request->shows;
    struct headlight headlight = {.job = job,
                                  .pool = pool,
                                  .shows = shows,
                                  .coarse = request->coarse,
                                  .state = request->state,
                                  .brightness = el_exp2(-job->settings.tone.exposure)};
    struct settings settings = job->settings;
    char warning[256];
    int workers = pool_workers(pool);
    settings.lens.aperture = 0;
    if (settings.integrator == INTEGRATOR_RADIOSITY && job->radiosity && job->radiosity->patches.world == job->world)
        headlight.stored = job->radiosity;
    headlight.patch = request->patch;
    if (shows == HEADLIGHT_FACTORS && (!headlight.stored || request->patch == PATCH_NONE))
        headlight.shows = HEADLIGHT_SURFACES;
    if (!camera_prepare(&job->camera, &settings, (struct picture_size){job->width, job->height}, &headlight.camera,
                        warning, error))
        return false;
    headlight.plain = camera_is_plain(&headlight.camera) && shows != HEADLIGHT_COST;
    if (shows == HEADLIGHT_DEPTH)
        measure_depths(&headlight);
    headlight.scratch = mem_alloc_zero((size_t)workers, sizeof *headlight.scratch);
    headlight.rows_done = mem_alloc_zero(film_tile_count(job->film), sizeof *headlight.rows_done);
    bool ok = headlight.scratch && headlight.rows_done;
    for (int i = 0; ok && i < workers; i++)
        ok = world_scratch_init(&headlight.scratch[i], job->world);
    for (int i = 0; ok && i < workers; i++)
        headlight.scratch[i].geom.tolerance = (float)(tolerance * headlight.camera.spread);
    bool complete = ok && pool_run(pool, STRIPS * film_tile_count(job->film), render_strip, &headlight);
    for (int i = 0; headlight.scratch && i < workers; i++) {
        ok = ok && !headlight.scratch[i].failed;
        world_scratch_destroy(&headlight.scratch[i]);
    }
    mem_free(headlight.scratch);
    mem_free(headlight.rows_done);
    statistics->camera_rays += (uint64_t)job->film->width * job->film->height;
    if (!ok)
        return error_no_memory(error, "the preview of a picture");
    return complete || error_set(error, ERROR_CANCELLED, "stopped while rendering");
}
