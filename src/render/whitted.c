/* Adaptive anti-aliasing. A part of a tile samples its pixels and the rim of one pixel around them once (a pixel's
 * first sample depends only on the pixel, so two parts that share a rim agree). It marks pixels by the differences of
 * neighbours, samples the marked ones N x N times, and is final. */
#include "render/whitted_internal.h"

#include "base/clock.h"
#include "base/mem.h"
#include "film/path_film.h"
#include "math/elementary.h"
#include "photon/photon_trace.h"
#include "render/sample_internal.h"

#include <math.h>

/* --- the cut-off of rays --- */

static double largest(struct colour c) {
    double max = c.r > c.g ? c.r : c.g;
    return c.b > max ? c.b : max;
}

/* The squared distance of two colours is never larger: with these tolerances no pixel is marked. */
static const double tolerance_of_all = 3;

/* The largest radiance that a ray can find: the sky, a visible light, an emissive surface, the medium, or a white
 * surface in the light of all lights, each at the distance where it has its nominal colour. Closer to a light with
 * falloff it may be brighter, so the bound holds for usual scenes only. */
static double brightest_of_scene(const struct render_job *job) {
    const struct world *world = job->world;
    double max = sky_brightest(&world->sky), lit = largest(job->ambient);
    for (uint32_t i = 0; i < world->light_count; i++) {
        const struct light *light = &world->lights[i];
        double own = light_brightest(light);
        lit += own;
        if (light->visible && own > max)
            max = own;
    }
    max = math_max(max, lit + world->emission_bound);
    return math_max(max, medium_brightest(world_outside(world)));
}

/* The weight of a ray in its pixel below which it changes the picture by less than settings.cutoff of white: this
 * limit, divided by the largest radiance in this scene and by the factor by which the tone of the picture file raises
 * small differences. 0: every ray counts. */
static double cutoff_weight(const struct render_job *job) {
    const struct tone *tone = &job->settings.tone;
    double brightest = brightest_of_scene(job), cutoff = job->settings.cutoff;
    if (cutoff <= 0)
        return 0;
    if (tone->exposure > 0)
        cutoff /= el_exp2(tone->exposure);
    if (tone->curve == TONE_FUNCTION)
        cutoff /= math_max(tone_table_slope(tone->table), 1);
    if (tone->srgb)
        cutoff /= 12.92; /* the slope of the transfer function in the dark */
    return brightest > 1 ? cutoff / brightest : cutoff;
}

/* Before the first tile; without photons there is no map. */
static bool send_photons(struct whitted *whitted, struct renderer *renderer, int workers, struct render_statistics *out,
                         struct error *error) {
    if (renderer->job->settings.caustics.photons == 0)
        return true;
    const struct render_job *job = renderer->job;
    const struct photon_scene scene = {job->world, &job->settings};
    bool ok = photons_send(&whitted->caustics, &scene, renderer->pool, out, error);
    for (int i = 0; i < workers; i++)
        renderer->workers[i].state.caustics = &whitted->caustics;
    return ok;
}

/* Pixels are sampled again. */
static bool samples_again(const struct settings *settings) {
    return settings->full || settings->side_tolerance < tolerance_of_all ||
           settings->corner_tolerance < tolerance_of_all;
}

/* With blur, nothing is narrow. */
static bool draw_thin(struct whitted *whitted, const struct renderer *renderer, struct error *error) {
    const struct settings *settings = &renderer->job->settings;
    if (settings->aa_pattern == AA_GRID || settings->samples == 1 || whitted->blurred || !samples_again(settings))
        return true;
    return thin_map_build(&whitted->thin, renderer, whitted->filter.radius - 0.5, error);
}

bool whitted_create(struct whitted *whitted, struct renderer *renderer, int workers,
                    struct render_statistics *statistics, struct error *error) {
    whitted->cutoff = cutoff_weight(renderer->job);
    filter_init(&whitted->filter, renderer->job->settings.filter);
    whitted->blurred = renderer->timed || renderer->camera.lens.aperture > 0;
    whitted->full = renderer->job->settings.full || whitted->blurred;
    whitted->fine = renderer->job->settings.aa_pattern != AA_GRID && samples_again(&renderer->job->settings);
    whitted->workers = mem_alloc_zero((size_t)workers, sizeof *whitted->workers);
    if (!whitted->workers)
        return error_no_memory(error, "the workers of a render");
    whitted->worker_count = workers;
    double line_width = settings_line_width(&renderer->job->settings);
    for (int i = 0; i < workers && line_width > 0; i++) {
        if (!contour_init(&whitted->workers[i].contour, line_width))
            return error_no_memory(error, "the workers of a render");
    }
    return draw_thin(whitted, renderer, error) && send_photons(whitted, renderer, workers, statistics, error);
}

void whitted_destroy(struct whitted *whitted) {
    photon_map_destroy(&whitted->caustics);
    thin_map_destroy(&whitted->thin);
    for (int i = 0; i < whitted->worker_count; i++)
        contour_destroy(&whitted->workers[i].contour);
    mem_free(whitted->workers);
}

void whitted_add_statistics(const struct whitted *whitted, const struct renderer *renderer,
                            struct render_statistics *out) {
    for (int i = 0; whitted->workers && i < pool_workers(renderer->pool); i++)
        out->marked_pixels += whitted->workers[i].marked, out->late_pixels += whitted->workers[i].late;
}

/* The first pass is kept: a viewer may show it, and the resampled pixels. Behind it, the alpha of the pixel
 * (film_alpha). */
struct film_record whitted_record(const struct settings *settings) {
    return (struct film_record){.floats = settings->transparent ? 4 : 3, .marks = 1};
}

/* --- marks --- */

static double clamp01(double c) {
    return c >= 1 ? 1 : c > 0 ? c : 0;
}

/* The difference in the picture file counts. */
static struct colour toned(const struct tone *tone, struct colour c) {
    if (tone_is_plain(tone))
        return c;
    return colour_make(tone_apply(tone, c.r), tone_apply(tone, c.g), tone_apply(tone, c.b));
}

static struct colour clamped(struct colour c) {
    return colour_make(clamp01(c.r), clamp01(c.g), clamp01(c.b));
}

static double squared_distance(struct colour a, struct colour b) {
    struct colour d = colour_sub(clamped(a), clamped(b));
    return colour_dot(d, d);
}

/* The fraction of the tolerances for colours on different surfaces, and for a colour compared with the mean of two
 * opposite neighbours. */
static const double fine_share = 1.0 / 16;
/* The cosine of the angle between two normals at an edge. */
static const double edge_cosine = 0.8;

/* A part of a tile at work. */
struct part {
    const struct whitted *whitted;
    struct renderer *renderer;
    struct worker *worker;
    struct whitted_worker *own;
    struct film_rectangle area; /* with the rim, as far as that is in the picture */
    bool has_alpha;
    bool has_first; /* the first pass is made */
    bool has_views; /* neighbours may be in another view */
};

static size_t index_of(const struct part *part, int64_t x, int64_t y) {
    return (size_t)(y - part->area.y0) * (FILM_TILE + 2) + (size_t)(x - part->area.x0);
}

static struct colour *first_at(const struct part *part, int64_t x, int64_t y) {
    return &part->own->first[index_of(part, x, y)];
}

static struct camera_view view_of(const struct part *part, int64_t x, int64_t y) {
    return camera_view_at(&part->renderer->camera, (double)x + 0.5, (double)y + 0.5);
}

/* Whether a pixel may be compared with the one at that offset: that is in the area and in the same view. */
static bool has_neighbour(const struct part *part, int64_t x, int64_t y, int dx, int dy) {
    const struct film_rectangle *area = &part->area;
    int64_t nx = x + dx, ny = y + dy;
    if (nx < area->x0 || nx >= area->x1 || ny < area->y0 || ny >= area->y1)
        return false;
    return !part->has_views || view_of(part, x, y).number == view_of(part, nx, ny).number;
}

/* Whether two first samples are on different surfaces, on different sides of an edge, or on different sides of the
 * border of a shadow. */
static bool surfaces_differ(const struct camera_hit *a, const struct camera_hit *b) {
    if (a->primitive != b->primitive || a->material != b->material || a->lights != b->lights)
        return true;
    return a->primitive != WORLD_NOTHING && vec3_dot(a->normal, b->normal) < edge_cosine;
}

/* Whether the pixel may contain a thin primitive in front of the hit of one of the first samples in it or around it. */
static bool has_thin(const struct part *part, int64_t x, int64_t y) {
    double nearness = part->whitted->fine ? (double)thin_map_at(&part->whitted->thin, x, y) : 0;
    if (!(nearness > 0))
        return false;
    bool pair = part->renderer->camera.lens.stereo == STEREO_ANAGLYPH; /* a sample has two rays */
    for (int dy = -1; dy <= 1; dy++)
        for (int dx = -1; dx <= 1; dx++)
            if (pair || (has_neighbour(part, x, y, dx, dy) &&
                         part->own->hits[index_of(part, x + dx, y + dy)].t * nearness >= 1))
                return true;
    return false;
}

/* The reasons to mark a pixel, all from first samples. If the result is true, `mark` is set. */

static double tolerance_towards(const struct part *part, int dx, int dy) {
    const struct settings *settings = &part->renderer->job->settings;
    return dx == 0 || dy == 0 ? settings->side_tolerance : settings->corner_tolerance;
}

/* With these tolerances, fine differences count. */
static bool is_fine(const struct part *part, double tolerance) {
    return part->whitted->fine && tolerance < tolerance_of_all;
}

static bool differs_from_neighbour(const struct part *part, int64_t x, int64_t y, struct observed_mark *mark) {
    const struct tone *tone = &part->renderer->job->settings.tone;
    const struct camera_hit *hits = part->own->hits;
    struct colour own = toned(tone, *first_at(part, x, y));
    for (int dy = -1; dy <= 1; dy++) {
        for (int dx = -1; dx <= 1; dx++) {
            int64_t nx = x + dx, ny = y + dy;
            if ((dx == 0 && dy == 0) || !has_neighbour(part, x, y, dx, dy))
                continue;
            double tolerance = tolerance_towards(part, dx, dy), fine = tolerance * fine_share;
            double alpha =
                part->own->seen_through[index_of(part, x, y)] - part->own->seen_through[index_of(part, nx, ny)];
            double distance = squared_distance(own, toned(tone, *first_at(part, nx, ny))) + 3 * alpha * alpha;
            *mark = (struct observed_mark){MARK_COLOUR, dx, dy, distance, tolerance};
            if (distance > tolerance)
                return true;
            *mark = (struct observed_mark){MARK_SURFACE, dx, dy, distance, fine};
            if (distance > fine && is_fine(part, tolerance) &&
                surfaces_differ(&hits[index_of(part, x, y)], &hits[index_of(part, nx, ny)]))
                return true;
        }
    }
    return false;
}

/* Whether the colour is not between those of two opposite neighbours. This finds details of textures, noise of shadows
 * and edges in mirrors, but not gradients. */
static bool has_detail(const struct part *part, int64_t x, int64_t y, struct observed_mark *mark) {
    static const int steps[][2] = {{1, 0}, {0, 1}, {1, 1}, {-1, 1}};
    const struct tone *tone = &part->renderer->job->settings.tone;
    struct colour own = toned(tone, *first_at(part, x, y));
    for (int i = 0; i < 4; i++) {
        int dx = steps[i][0], dy = steps[i][1];
        double tolerance = tolerance_towards(part, dx, dy), fine = tolerance * fine_share;
        if (!is_fine(part, tolerance) || !has_neighbour(part, x, y, dx, dy) || !has_neighbour(part, x, y, -dx, -dy))
            continue;
        struct colour a = clamped(toned(tone, *first_at(part, x - dx, y - dy))),
                      b = clamped(toned(tone, *first_at(part, x + dx, y + dy)));
        double distance = squared_distance(own, colour_scale(colour_add(a, b), 0.5));
        *mark = (struct observed_mark){MARK_DETAIL, dx, dy, distance, fine};
        if (distance > fine)
            return true;
    }
    return false;
}

static bool is_marked(const struct part *part, int64_t x, int64_t y) {
    struct observed_mark mark;
    if (part->has_views && view_of(part, x, y).depth)
        return false;
    bool marked = differs_from_neighbour(part, x, y, &mark) || (part->whitted->fine && has_detail(part, x, y, &mark));
    if (!marked && has_thin(part, x, y)) {
        mark = (struct observed_mark){.reason = MARK_THIN};
        marked = true;
    }
    if (marked)
        OBSERVE(part->worker->state.observer, OBSERVED_MARK, .mark = mark);
    return marked;
}

/* --- samples of a pixel --- */

/* The N x N samples of a pixel. Most are on a rotated grid. Near thin lines, and with a lens or motion, they are
 * jittered, so that the mean is unbiased. Near small primitives they are on the grid without rotation, which has the
 * smallest maximum gap. */
enum pixel_positions { POSITIONS_GRID, POSITIONS_ROTATED, POSITIONS_JITTERED };
struct pixel_pattern {
    const struct whitted *whitted;
    const struct settings *settings;
    int64_t x, y;
    uint64_t pixel; /* its number */
    enum pixel_positions positions;
    bool first_counts; /* the first sample is the one in the middle */
};

static enum pixel_positions positions_of(const struct whitted *whitted, const struct settings *settings, int64_t x,
                                         int64_t y) {
    if (settings->aa_pattern == AA_GRID || settings->samples == 1)
        return POSITIONS_GRID;
    uint32_t thin = thin_map_flags(&whitted->thin, x, y);
    if (whitted->blurred || thin & THIN_LINE)
        return POSITIONS_JITTERED;
    return thin & THIN_SMALL ? POSITIONS_GRID : POSITIONS_ROTATED;
}

static struct pixel_pattern pattern_of(const struct whitted *whitted, const struct renderer *renderer, int64_t x,
                                       int64_t y) {
    const struct settings *settings = &renderer->job->settings;
    enum pixel_positions positions = positions_of(whitted, settings, x, y);
    bool centred = (settings->samples & 1) && !settings->pixel_corner && !whitted->blurred;
    return (struct pixel_pattern){.whitted = whitted,
                                  .settings = settings,
                                  .x = x,
                                  .y = y,
                                  .pixel = (uint64_t)y * renderer->job->width + (uint64_t)x,
                                  .positions = positions,
                                  .first_counts = centred && positions != POSITIONS_JITTERED};
}

static struct sample2 position_of(const struct pixel_pattern *pattern, int k) {
    int n = pattern->settings->samples;
    struct sampler sampler = sampler_make(pattern->settings->seed, pattern->pixel, (uint64_t)k + 1, (uint32_t)n);
    switch (pattern->positions) {
    case POSITIONS_GRID:
        break;
    case POSITIONS_ROTATED:
        return sampler_pixel_rotated(&sampler);
    case POSITIONS_JITTERED:
        return sampler_pixel_jittered(&sampler);
    }
    return (struct sample2){(k % n + 0.5) / n, (k / n + 0.5) / n};
}

/* Sample k of N x N. */
static struct pixel_sample sample_of_pattern(const struct pixel_pattern *pattern, int k) {
    struct filter_sample at = filter_sample(&pattern->whitted->filter, position_of(pattern, k));
    return (struct pixel_sample){pattern->x, pattern->y, at.x, at.y, (uint64_t)k + 1, at.weight};
}

/* Mean of the N x N samples, weighted by the filter; where one of them is the first sample again it is not traced
 * twice. *seen_through: of the first sample, then their mean. */
static struct colour all_samples(const struct part *part, int64_t x, int64_t y, const struct colour *first,
                                 double *seen_through) {
    struct renderer *renderer = part->renderer;
    int n = renderer->job->settings.samples;
    struct pixel_pattern pattern = pattern_of(part->whitted, renderer, x, y);
    bool reuse = pattern.first_counts;
    struct batch *batch = &part->worker->batch;
    struct colour sum = {0, 0, 0};
    double weights = 0, through = 0;
    int centre = reuse ? n / 2 * n + n / 2 : -1;
    for (int begin = 0; begin < n * n; begin += PACKET_RAYS) {
        int end = begin + PACKET_RAYS < n * n ? begin + PACKET_RAYS : n * n;
        /* The samples of a packet, without the one that is known. */
        batch->count = 0;
        for (int k = begin; k < end; k++) {
            if (k == centre && !first)
                batch->positions[batch->count++] = renderer_first_sample(renderer, x, y);
            else if (k != centre)
                batch->positions[batch->count++] = sample_of_pattern(&pattern, k);
        }
        renderer_sample_batch(renderer, part->worker);
        /* Their weighted sum, in the order of the pattern. */
        uint32_t next = 0;
        for (int k = begin; k < end; k++) {
            bool is_first = k == centre && first;
            double weight = is_first ? 1 : batch->positions[next].weight;
            through += weight * (is_first ? *seen_through : batch->seen_through[next]);
            sum = colour_add(sum, colour_scale(is_first ? *first : batch->colours[next++], weight));
            weights += weight;
        }
    }
    *seen_through = clamp01(through / weights);
    return colour_scale(sum, 1 / weights);
}

void whitted_repeat(const struct whitted *whitted, struct renderer *renderer, struct worker *worker, int64_t x,
                    int64_t y) {
    const struct film *film = renderer->job->film;
    int n = renderer->job->settings.samples;
    bool marked = film->marked[(size_t)(y - film->y0) * film->width + (size_t)(x - film->x0)];
    struct pixel_pattern pattern = pattern_of(whitted, renderer, x, y);
    bool has_first = !whitted->full || renderer->job->settings.keep_first, reuse = pattern.first_counts;
    struct pixel_sample position = renderer_first_sample(renderer, x, y);
    if (has_first || reuse)
        (void)renderer_sample(renderer, worker, &position);
    for (int k = 0; marked && k < n * n && !renderer_stopped(renderer, worker); k++) {
        if (reuse && k == n / 2 * n + n / 2)
            continue;
        position = sample_of_pattern(&pattern, k);
        (void)renderer_sample(renderer, worker, &position);
    }
}

/* --- the two passes --- */

static void store(float out[3], struct colour colour) {
    out[0] = (float)colour.r;
    out[1] = (float)colour.g;
    out[2] = (float)colour.b;
}

static void store_alpha(const struct part *part, size_t at, double alpha) {
    struct film *film = part->renderer->job->film;
    if (part->has_alpha)
        film->floats[at * film->record.floats + 3] = (float)alpha;
}

static void finish_pixel(const struct part *part, int64_t x, int64_t y) {
    struct film *film = part->renderer->job->film;
    size_t at = (size_t)(y - film->y0) * film->width + (size_t)(x - film->x0);
    const struct colour *first = part->has_first ? first_at(part, x, y) : NULL;
    bool full = part->whitted->full, marked = full || is_marked(part, x, y);
    double through = first ? part->own->seen_through[index_of(part, x, y)] : 0;
    struct colour colour = marked ? all_samples(part, x, y, first, &through) : *first;
    double line = contour_coverage(&part->own->contour, x, y);
    struct colour first_colour = first ? *first : colour;
    if (line > 0) {
        colour = colour_scale(colour, 1 - line);
        first_colour = colour_scale(first_colour, 1 - line);
    }
    store(film->pixels[at].rgb, colour);
    store(&film->floats[at * film->record.floats], first_colour);
    store_alpha(part, at, 1 - through * (1 - line));
    film->marked[at] = marked;
    part->own->marked += marked;
    struct pixel_pattern pattern = pattern_of(part->whitted, part->renderer, x, y);
    OBSERVE(part->worker->state.observer, OBSERVED_PIXEL,
            .pixel = {.colour = colour,
                      .samples = marked ? part->renderer->job->settings.samples : 0,
                      .full = full,
                      .first_counts = !marked || pattern.first_counts});
}

/* The first samples of a small square go together. */
enum { PATCH = 8 };
_Static_assert((int)(PATCH *PATCH) == (int)PACKET_RAYS, "a patch is a packet");

static void sample_patch(const struct part *part, int64_t x0, int64_t y0) {
    struct batch *batch = &part->worker->batch;
    batch->count = 0;
    for (int64_t y = y0; y < y0 + PATCH && y < part->area.y1; y++) {
        for (int64_t x = x0; x < x0 + PATCH && x < part->area.x1; x++)
            batch->positions[batch->count++] = renderer_first_sample(part->renderer, x, y);
    }
    batch->camera_hits = part->whitted->fine ? part->own->patch : NULL;
    renderer_sample_batch(part->renderer, part->worker);
    batch->camera_hits = NULL;
    for (uint32_t i = 0; i < batch->count; i++) {
        size_t at = index_of(part, batch->positions[i].x, batch->positions[i].y);
        part->own->first[at] = batch->colours[i];
        part->own->seen_through[at] = batch->seen_through[i];
        if (part->whitted->fine)
            part->own->hits[at] = part->own->patch[i];
    }
}

/* --- when --time-limit is over --- */

static bool is_late(const struct renderer *renderer) {
    double limit = renderer->job->settings.time_limit;
    return limit > 0 && clock_now() - renderer->begun >= limit;
}

/* Rows that the time did not suffice for: first samples without resampling if all of the tile has them, else one sample
 * for each patch. */
static void finish_late(struct part *part, const struct film_rectangle *rows, bool has_first) {
    struct film *film = part->renderer->job->film;
    struct batch *batch = &part->worker->batch;
    for (int64_t y0 = rows->y0; y0 < rows->y1; y0 += PATCH) {
        for (int64_t x0 = rows->x0; x0 < rows->x1; x0 += PATCH) {
            int64_t x1 = x0 + PATCH < rows->x1 ? x0 + PATCH : rows->x1;
            int64_t y1 = y0 + PATCH < rows->y1 ? y0 + PATCH : rows->y1;
            batch->count = !has_first;
            batch->positions[0] = renderer_first_sample(part->renderer, (x0 + x1) / 2, (y0 + y1) / 2);
            if (!has_first)
                renderer_sample_batch(part->renderer, part->worker);
            for (int64_t i = 0; i < (x1 - x0) * (y1 - y0); i++) {
                int64_t x = x0 + i % (x1 - x0), y = y0 + i / (x1 - x0);
                size_t at = (size_t)(y - film->y0) * film->width + (size_t)(x - film->x0);
                struct colour colour = has_first ? *first_at(part, x, y) : batch->colours[0];
                store(film->pixels[at].rgb, colour);
                store(&film->floats[at * film->record.floats], colour);
                store_alpha(part, at,
                            1 - (has_first ? part->own->seen_through[index_of(part, x, y)] : batch->seen_through[0]));
                film->marked[at] = 0;
            }
            part->own->late += (uint64_t)((x1 - x0) * (y1 - y0));
        }
    }
}

/* For a viewer: the current first pass, and the pixels to be resampled. */
static void show_refined(const struct part *part, const struct film_rectangle *tile) {
    struct film *film = part->renderer->job->film;
    for (int64_t y = tile->y0; y < tile->y1; y++) {
        for (int64_t x = tile->x0; x < tile->x1; x++) {
            size_t at = (size_t)(y - film->y0) * film->width + (size_t)(x - film->x0);
            store(film->pixels[at].rgb, *first_at(part, x, y));
            film->marked[at] = part->whitted->full || is_marked(part, x, y) ? FILM_MARK_WAITS : 0;
        }
    }
}

bool whitted_render(struct whitted *whitted, struct renderer *renderer, struct worker *worker,
                    const struct film_rectangle *tile) {
    const struct settings *settings = &renderer->job->settings;
    struct part part = {.whitted = whitted,
                        .renderer = renderer,
                        .worker = worker,
                        .own = &whitted->workers[worker->index],
                        .has_first = !whitted->full || settings->keep_first,
                        .has_views = camera_has_views(&renderer->camera),
                        .has_alpha = film_has_alpha(renderer->job->film->record)};
    const struct film_rectangle area =
        film_rectangle_grown(tile, whitted->full ? 0 : 1, renderer->job->width, renderer->job->height);
    part.area = area;
    for (int64_t y = area.y0; y < area.y1 && part.has_first; y += PATCH) {
        for (int64_t x = area.x0; x < area.x1; x += PATCH) {
            if (renderer_stopped(renderer, worker))
                return false;
            if (is_late(renderer)) {
                finish_late(&part, tile, false);
                return !renderer_stopped(renderer, worker);
            }
            sample_patch(&part, x, y);
        }
        renderer_tile_goes_on(renderer, worker,
                              math_min(0.5, (double)(y + PATCH - area.y0) / (double)(2 * (area.y1 - area.y0))));
    }
    if (settings->show_refined && part.has_first)
        show_refined(&part, tile);
    if (!contour_find(&part.own->contour, renderer, worker, tile))
        return false;
    double before = part.has_first ? 0.5 : 0; /* the part of the work that the first pass is */
    for (int64_t y = tile->y0; y < tile->y1; y++) {
        if (is_late(renderer)) {
            finish_late(&part, &(struct film_rectangle){tile->x0, (uint32_t)y, tile->x1, tile->y1}, part.has_first);
            return !renderer_stopped(renderer, worker);
        }
        for (int64_t x = tile->x0; x < tile->x1; x++) {
            if (renderer_stopped(renderer, worker))
                return false;
            finish_pixel(&part, x, y);
        }
        renderer_tile_goes_on(renderer, worker,
                              before + (1 - before) * (double)(y + 1 - tile->y0) / (double)(tile->y1 - tile->y0));
    }
    return true;
}
