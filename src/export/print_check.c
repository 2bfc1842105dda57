#include "export/print_check.h"

#include "base/mem.h"
#include "export/solid_cast_internal.h"
#include "export/solid_mesh_internal.h"
#include "math/elementary.h"
#include "math/frame.h"

/* Of faces at 45 degrees, which printers can build without support, and a little more. */
static const double supported_sine = 0.7133;

enum { SAMPLES = 10000, CHUNK = 100, DIRECTIONS = 360 };

/* --- sums over triangles --- */

struct sums {
    const struct export_model *model;
    struct print_report *report;
    struct vec3 moment; /* volume times the centre of mass */
    double lowest;
};

static void corners_at(const struct export_part *part, size_t triangle, struct vec3 out[3]) {
    const struct export_triangle *at = (struct export_triangle *)part->triangles.items + triangle;
    for (int k = 0; k < 3; k++)
        out[k] = ((struct vec3 *)part->points.items)[at->vertex[k]];
}

static void add_triangle(struct sums *sums, const struct vec3 c[3]) {
    struct print_report *report = sums->report;
    struct vec3 normal = vec3_cross(vec3_sub(c[1], c[0]), vec3_sub(c[2], c[0]));
    double area = 0.5 * vec3_length(normal), volume = vec3_dot(c[0], vec3_cross(c[1], c[2])) / 6;
    struct vec3 sum = vec3_add(c[0], vec3_add(c[1], c[2]));
    report->volume += volume;
    report->area += area;
    sums->moment = vec3_add_scaled(sums->moment, sum, volume / 4);
    double down = area > 0 ? -normal.z / (2 * area) : 0;
    if (down <= 0)
        return;
    if (fmax(c[0].z, fmax(c[1].z, c[2].z)) < sums->lowest + sums->model->tolerance) {
        report->contact_area += area * down;
        return;
    }
    if (down > supported_sine)
        report->overhang_area += area;
}

static void add_all(struct sums *sums) {
    struct box box = box_empty();
    for (size_t i = 0; i < sums->model->parts.count; i++) {
        const struct export_part *part = &export_parts(sums->model)[i];
        for (size_t v = 0; v < part->points.count; v++)
            box = box_add_point(box, ((struct vec3 *)part->points.items)[v]);
    }
    sums->report->box = box;
    sums->lowest = box.min.z;
    for (size_t i = 0; i < sums->model->parts.count; i++) {
        const struct export_part *part = &export_parts(sums->model)[i];
        for (size_t t = 0; t < part->triangles.count; t++) {
            struct vec3 corners[3];
            corners_at(part, t, corners);
            add_triangle(sums, corners);
        }
    }
}

/* In every direction some point of contact is beyond the centre of mass. */
static bool is_standing(const struct sums *sums) {
    struct vec3 centre = vec3_scale(sums->moment, 1 / sums->report->volume);
    for (int i = 0; i < DIRECTIONS; i++) {
        double sine, cosine, farthest = -INFINITY;
        el_sincos(2 * PI * i / DIRECTIONS, &sine, &cosine);
        for (size_t k = 0; k < sums->model->parts.count; k++) {
            const struct export_part *part = &export_parts(sums->model)[k];
            for (size_t v = 0; v < part->points.count; v++) {
                struct vec3 at = ((struct vec3 *)part->points.items)[v];
                if (at.z < sums->lowest + sums->model->tolerance)
                    farthest = fmax(farthest, cosine * (at.x - centre.x) + sine * (at.y - centre.y));
            }
        }
        if (farthest < 0)
            return false;
    }
    return true;
}

/* --- walls and overhangs, exactly --- */

struct wall {
    double thickness, down; /* the thinnest, and minus the z of the normal that is lowest */
    struct vec3 at, down_at;
};
/* Samples of one part, evenly over its area. */
struct wall_search {
    const struct export_part *part;
    double tolerance, *areas; /* up to each triangle */
    uint32_t count;           /* samples */
    struct solid_probe *probes;
    double lowest;      /* z of the plate, and of what stands on it */
    struct wall *walls; /* of each chunk */
};

/* From a point of the surface inwards to where the line leaves the solid. */
static double thickness_at(struct solid_probe *probe, const struct solid_crossing *at, double tolerance) {
    struct vec3 inward = vec3_negate(at->normal);
    solid_cast(probe, at->point, inward);
    for (uint32_t i = 0; i < probe->count; i++)
        if (probe->found[i].t > 1e-3 * tolerance && !probe->found[i].enter)
            return probe->found[i].t;
    return INFINITY;
}

static void measure_sample(struct wall_search *search, struct solid_probe *probe, uint32_t sample, struct wall *wall) {
    size_t low = 0, high = search->part->triangles.count - 1;
    double at = search->areas[high] * (sample + 0.5) / search->count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (search->areas[middle] < at)
            low = middle + 1;
        else
            high = middle;
    }
    struct vec3 c[3];
    corners_at(search->part, low, c);
    double u = sqrt(fmod(sample * 0.7548776662466927 + 0.5, 1)), v = fmod(sample * 0.5698402909980532 + 0.5, 1);
    struct vec3 point = vec3_scale(c[0], 1 - u);
    point = vec3_add_scaled(vec3_add_scaled(point, c[1], u * (1 - v)), c[2], u * v);
    struct vec3 normal = vec3_normalize(vec3_cross(vec3_sub(c[1], c[0]), vec3_sub(c[2], c[0])));
    struct solid_crossing surface;
    if (!(vec3_length(normal) > 0) || !solid_cast_near(probe, point, normal, 2 * search->tolerance, &surface))
        return;
    if (-surface.normal.z > wall->down && surface.point.z > search->lowest) {
        wall->down = fmin(-surface.normal.z, 1);
        wall->down_at = surface.point;
    }
    double thickness = thickness_at(probe, &surface, search->tolerance);
    if (thickness < wall->thickness) {
        wall->thickness = thickness;
        wall->at = surface.point;
    }
}

static void measure_chunk(void *context, uint32_t item, int worker) {
    struct wall_search *search = context;
    search->walls[item] = (struct wall){.thickness = INFINITY, .down = 1e-6};
    for (uint32_t i = item * CHUNK; i < (item + 1) * CHUNK && i < search->count; i++)
        measure_sample(search, &search->probes[worker], i, &search->walls[item]);
}

static bool measure_part(const struct export_model *model, const struct export_part *part, struct pool *pool,
                         struct print_report *report, struct error *error) {
    int workers = pool_workers(pool);
    size_t triangles = part->triangles.count;
    uint32_t chunks = SAMPLES / CHUNK;
    struct wall_search search = {.part = part,
                                 .tolerance = model->tolerance,
                                 .areas = mem_alloc(triangles * sizeof *search.areas),
                                 .count = SAMPLES,
                                 .lowest = report->box.min.z + model->tolerance,
                                 .probes = solid_probes(part->csg, workers),
                                 .walls = mem_alloc_zero(chunks, sizeof *search.walls)};
    double area = 0;
    for (size_t t = 0; search.areas && t < triangles; t++) {
        struct vec3 c[3];
        corners_at(part, t, c);
        area += 0.5 * vec3_length(vec3_cross(vec3_sub(c[1], c[0]), vec3_sub(c[2], c[0])));
        search.areas[t] = area;
    }
    bool ok = (search.areas && search.walls && search.probes) || error_no_memory(error, "the walls of a model");
    ok = ok && (pool_run(pool, chunks, measure_chunk, &search) ||
                error_set(error, ERROR_CANCELLED, "stopped while a model was measured"));
    for (uint32_t i = 0; ok && i < chunks; i++) {
        const struct wall *wall = &search.walls[i];
        double overhang = wall->down > 1e-6 ? el_asin(wall->down) * 180 / PI : 0;
        if (wall->thickness < report->thinnest) {
            report->thinnest = wall->thickness;
            report->thinnest_at = wall->at;
        }
        if (overhang > report->overhang) {
            report->overhang = overhang;
            report->overhang_at = wall->down_at;
        }
    }
    solid_probes_destroy(search.probes, workers);
    mem_free(search.walls);
    mem_free(search.areas);
    return ok;
}

bool print_check(const struct export_model *model, struct pool *pool, struct print_report *out, struct error *error) {
    struct sums sums = {.model = model, .report = out};
    *out = (struct print_report){.closed = true, .thinnest = INFINITY};
    add_all(&sums);
    out->is_standing = out->volume > 0 && is_standing(&sums);
    for (size_t i = 0; i < model->parts.count; i++) {
        const struct export_part *part = &export_parts(model)[i];
        out->closed = out->closed && part->closed;
        if (!measure_part(model, part, pool, out, error))
            return false;
    }
    return true;
}
