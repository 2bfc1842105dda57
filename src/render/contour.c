/* Lines of a part of a tile. One sample in the centre of each pixel finds the pixels that an edge crosses. These are
 * sampled again at CELLS x CELLS positions, and the edges between neighbouring positions give points of the edge. The
 * distance of a pixel from the nearest point determines how much of it the line covers. The result is a function of the
 * pixel and its surroundings, so parts, tiles and crops agree. */
#include "render/contour_internal.h"
#include "render/sample_internal.h"

#include "base/mem.h"

#include <math.h>

enum { CELLS = 4, MEDIA_LIMIT = 16 };
/* The cosine of 30 degrees; the number of pixels by which one part of an object must be nearer than another part to
 * give a line. */
static const double crease_cosine = 0.86602540378443865, gap = 4;

/* Pixels around the part that its lines depend on, because an edge in them may cover a pixel of the part. */
static int margin_of(double width) {
    return (int)floor(width / 2 + 1);
}

bool contour_init(struct contour *contour, double width) {
    contour->width = width;
    contour->rim = margin_of(width) + 1;
    size_t side = FILM_TILE + 2 * (size_t)contour->rim;
    contour->samples = mem_alloc_zero(side * side, sizeof *contour->samples);
    return contour->samples != NULL;
}

void contour_destroy(struct contour *contour) {
    mem_free(contour->samples);
}

/* Through (x, y) of the picture. Boundaries between media are ignored. */
static struct contour_sample sample_at(const struct renderer *renderer, struct worker *worker, double x, double y) {
    const struct world *world = renderer->job->world;
    struct contour_sample sample = {.primitive = WORLD_NOTHING};
    const struct camera_view view = camera_view_at(&renderer->camera, x, y);
    sample.view = view.number;
    struct ray ray;
    struct hit hit;
    if (view.depth || !renderer_middle_ray(renderer, x, y, &ray))
        return sample;
    bool met = world_nearest(world, &ray, &worker->scratch, &hit);
    for (int i = 0; met && i < MEDIA_LIMIT && world->material_has_medium[hit.material]; i++) {
        ray = hit_ray(&hit, &ray, ray.direction, ray.media);
        met = world_nearest(world, &ray, &worker->scratch, &hit);
    }
    if (!met)
        return sample;
    sample.point = hit.point;
    sample.normal = hit.front ? hit.normal : vec3_negate(hit.normal);
    sample.pixel = hit.footprint;
    sample.primitive = hit.primitive;
    sample.material = hit.material;
    return sample;
}

/* Whether an edge is between two neighbouring samples. A surface that curves away stays near the tangent plane of one
 * of them, and so gives no edge. */
static bool has_edge(const struct contour_sample *a, const struct contour_sample *b) {
    if (a->view != b->view)
        return false;
    if (a->primitive != b->primitive || a->material != b->material)
        return true;
    if (a->primitive == WORLD_NOTHING)
        return false;
    struct vec3 apart = vec3_sub(b->point, a->point);
    double off = math_min(fabs(vec3_dot(apart, a->normal)), fabs(vec3_dot(apart, b->normal)));
    return vec3_dot(a->normal, b->normal) < crease_cosine || off > gap * math_max(a->pixel, b->pixel);
}

/* Updates the pixels of a part that are near an edge that crosses (x, y). */
static void add_edge(struct contour *contour, double x, double y) {
    const struct film_rectangle *tile = &contour->tile;
    int margin = margin_of(contour->width);
    int64_t px = (int64_t)floor(x), py = (int64_t)floor(y);
    for (int64_t ny = py - margin; ny <= py + margin; ny++) {
        for (int64_t nx = px - margin; nx <= px + margin; nx++) {
            if (nx < tile->x0 || nx >= tile->x1 || ny < tile->y0 || ny >= tile->y1)
                continue;
            double dx = (double)nx + 0.5 - x, dy = (double)ny + 0.5 - y;
            float squared = (float)(dx * dx + dy * dy);
            float *own = &contour->squared[(ny - tile->y0) * FILM_TILE + nx - tile->x0];
            *own = squared < *own ? squared : *own;
        }
    }
}

/* Finds the edges in a pixel, and those between it and the pixels to the right and below. */
static void refine(struct contour *contour, const struct renderer *renderer, struct worker *worker, int64_t x,
                   int64_t y) {
    struct contour_sample cells[CELLS + 1][CELLS + 1];
    for (int j = 0; j <= CELLS; j++)
        for (int i = 0; i <= CELLS; i++)
            cells[j][i] = sample_at(renderer, worker, (double)x + (i + 0.5) / CELLS, (double)y + (j + 0.5) / CELLS);
    for (int j = 0; j < CELLS; j++) {
        for (int i = 0; i < CELLS; i++) {
            double along = (i + 0.5) / CELLS, down = (j + 0.5) / CELLS;
            if (has_edge(&cells[j][i], &cells[j][i + 1]))
                add_edge(contour, (double)x + (i + 1.0) / CELLS, (double)y + down);
            if (has_edge(&cells[j][i], &cells[j + 1][i]))
                add_edge(contour, (double)x + along, (double)y + (j + 1.0) / CELLS);
        }
    }
}

static struct contour_sample *coarse_at(const struct contour *contour, int64_t x, int64_t y) {
    int64_t side = FILM_TILE + 2 * contour->rim;
    return &contour->samples[(y - contour->tile.y0 + contour->rim) * side + x - contour->tile.x0 + contour->rim];
}

/* Whether the pixel differs from a pixel around it. */
static bool is_crossed(const struct contour *contour, const struct film_rectangle *area, int64_t x, int64_t y) {
    const struct contour_sample *own = coarse_at(contour, x, y);
    for (int64_t ny = y - 1; ny <= y + 1; ny++)
        for (int64_t nx = x - 1; nx <= x + 1; nx++)
            if (nx >= area->x0 && nx < area->x1 && ny >= area->y0 && ny < area->y1 &&
                has_edge(own, coarse_at(contour, nx, ny)))
                return true;
    return false;
}

bool contour_find(struct contour *contour, const struct renderer *renderer, struct worker *worker,
                  const struct film_rectangle *tile) {
    if (!(contour->width > 0))
        return true;
    const struct render_job *job = renderer->job;
    uint32_t rim = (uint32_t)contour->rim;
    struct film_rectangle area = film_rectangle_grown(tile, rim, job->width, job->height);
    struct film_rectangle near = film_rectangle_grown(tile, rim - 1, job->width, job->height);
    contour->tile = *tile;
    for (int i = 0; i < FILM_TILE * FILM_TILE; i++)
        contour->squared[i] = INFINITY;
    /* One sample for each pixel finds where edges may be. */
    for (int64_t y = area.y0; y < area.y1; y++) {
        if (renderer_stopped(renderer, worker))
            return false;
        for (int64_t x = area.x0; x < area.x1; x++)
            *coarse_at(contour, x, y) = sample_at(renderer, worker, (double)x + 0.5, (double)y + 0.5);
    }
    /* Only pixels with an edge are sampled more finely. */
    for (int64_t y = near.y0; y < near.y1; y++) {
        if (renderer_stopped(renderer, worker))
            return false;
        for (int64_t x = near.x0; x < near.x1; x++) {
            if (is_crossed(contour, &area, x, y))
                refine(contour, renderer, worker, x, y);
        }
    }
    return true;
}

/* The overlap of a line and of the pixel, across the line. */
double contour_coverage(const struct contour *contour, int64_t x, int64_t y) {
    if (!(contour->width > 0))
        return 0;
    double squared = (double)contour->squared[(y - contour->tile.y0) * FILM_TILE + x - contour->tile.x0];
    double overlap = contour->width / 2 + 0.5 - sqrt(squared), max = math_min(contour->width, 1);
    return overlap > max ? max : overlap > 0 ? overlap : 0;
}
