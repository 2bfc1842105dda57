#include "export/print_check.h"

#include "export/solid_cast_internal.h"
#include "export/triangles_internal.h"
#include "math/elementary.h"
#include "math/portable.h"

/* Of faces at 45 degrees, which printers can build without support, and a little more. */
static const double supported_sine = 0.7133;

enum { SAMPLES = 10000, DIRECTIONS = 360 };

struct checker {
    const struct export_model *model;
    struct print_report *report;
    struct vec3 moment; /* volume times the centre of mass */
    double plate;       /* what is below this z stands on it */
    double down;        /* minus the z of the lowest normal */
    struct solid_probe probe;
};

static void add_triangle(struct checker *checker, const struct vec3 c[3]) {
    struct print_report *report = checker->report;
    struct vec3 normal = triangle_normal(c);
    double area = 0.5 * vec3_length(normal), volume = vec3_dot(c[0], vec3_cross(c[1], c[2])) / 6;
    struct vec3 sum = vec3_add(c[0], vec3_add(c[1], c[2]));
    report->volume += volume;
    report->area += area;
    checker->moment = vec3_add_scaled(checker->moment, sum, volume / 4);
    double down = area > 0 ? -normal.z / (2 * area) : 0;
    if (down <= 0)
        return;
    if (math_max(c[0].z, math_max(c[1].z, c[2].z)) < checker->plate)
        report->contact_area += area * down;
    else if (down > supported_sine)
        report->overhang_area += area;
}

static void add_all(struct checker *checker) {
    struct box box = box_empty();
    for (size_t i = 0; i < checker->model->parts.count; i++) {
        const struct export_part *part = &export_parts(checker->model)[i];
        for (size_t v = 0; v < part->points.count; v++)
            box = box_add_point(box, export_points(part)[v]);
    }
    checker->report->box = box;
    checker->plate = box.min.z + checker->model->tolerance;
    for (size_t i = 0; i < checker->model->parts.count; i++) {
        const struct export_part *part = &export_parts(checker->model)[i];
        for (size_t t = 0; t < part->triangles.count; t++) {
            struct vec3 corners[3];
            export_corners(part, t, corners);
            add_triangle(checker, corners);
        }
    }
}

/* In every direction some point of contact is beyond the centre of mass. */
static bool is_standing(const struct checker *checker) {
    struct vec3 centre = vec3_scale(checker->moment, 1 / checker->report->volume);
    for (int i = 0; i < DIRECTIONS; i++) {
        double sine, cosine, farthest = -INFINITY;
        el_sincos(2 * PI * i / DIRECTIONS, &sine, &cosine);
        for (size_t k = 0; k < checker->model->parts.count; k++) {
            const struct export_part *part = &export_parts(checker->model)[k];
            for (size_t v = 0; v < part->points.count; v++) {
                struct vec3 at = export_points(part)[v];
                if (at.z < checker->plate)
                    farthest = math_max(farthest, cosine * (at.x - centre.x) + sine * (at.y - centre.y));
            }
        }
        if (farthest < 0)
            return false;
    }
    return true;
}

/* --- walls and overhangs, exactly --- */

/* From a point of the surface inwards to where the line leaves the solid. */
static double thickness_at(struct checker *checker, const struct solid_crossing *at) {
    struct solid_probe *probe = &checker->probe;
    solid_cast(probe, at->point, vec3_negate(at->normal));
    for (uint32_t i = 0; i < probe->count; i++)
        if (probe->found[i].t > 1e-3 * checker->model->tolerance && !probe->found[i].enter)
            return probe->found[i].t;
    return INFINITY;
}

static void measure_sample(struct checker *checker, const struct vec3 c[3], uint32_t sample) {
    double u = sqrt(math_fmod(sample * 0.7548776662466927 + 0.5, 1)),
           v = math_fmod(sample * 0.5698402909980532 + 0.5, 1);
    struct vec3 point = vec3_scale(c[0], 1 - u);
    point = vec3_add_scaled(vec3_add_scaled(point, c[1], u * (1 - v)), c[2], u * v);
    struct vec3 normal = vec3_normalize(triangle_normal(c));
    struct solid_crossing surface;
    if (!(vec3_length(normal) > 0) ||
        !solid_cast_near(&checker->probe, point, normal, 2 * checker->model->tolerance, &surface))
        return;
    if (-surface.normal.z > checker->down && surface.point.z > checker->plate) {
        checker->down = -surface.normal.z;
        checker->report->overhang_at = surface.point;
    }
    double thickness = thickness_at(checker, &surface);
    if (thickness < checker->report->thinnest) {
        checker->report->thinnest = thickness;
        checker->report->thinnest_at = surface.point;
    }
}

/* Samples evenly over the area of a part: each triangle has the samples that begin in it, where all triangles lie one
 * after the other. */
static bool measure_part(struct checker *checker, const struct export_part *part, struct pool *pool,
                         struct error *error) {
    double area = 0, before = 0;
    uint32_t sample = 0;
    struct vec3 c[3];
    bool ok = solid_probe_init(&checker->probe, part->csg);
    for (size_t t = 0; t < part->triangles.count; t++) {
        export_corners(part, t, c);
        area += vec3_length(triangle_normal(c));
    }
    for (size_t t = 0; ok && t < part->triangles.count; t++) {
        export_corners(part, t, c);
        before += vec3_length(triangle_normal(c));
        for (; (sample + 0.5) * area < before * SAMPLES && !pool_cancelled(pool); sample++)
            measure_sample(checker, c, sample);
    }
    if (ok)
        solid_probe_destroy(&checker->probe);
    if (!ok || checker->probe.failed)
        return error_no_memory(error, "the walls of a model");
    return !pool_cancelled(pool) || error_set(error, ERROR_CANCELLED, "stopped while a model was measured");
}

bool print_check(const struct export_model *model, struct pool *pool, struct print_report *out, struct error *error) {
    struct checker checker = {.model = model, .report = out, .down = 1e-6};
    *out = (struct print_report){.closed = true, .thinnest = INFINITY};
    add_all(&checker);
    out->is_standing = out->volume > 0 && is_standing(&checker);
    for (size_t i = 0; i < model->parts.count; i++) {
        out->closed = out->closed && export_parts(model)[i].closed;
        if (!measure_part(&checker, &export_parts(model)[i], pool, error))
            return false;
    }
    if (checker.down > 1e-6)
        out->overhang = el_asin(math_min(checker.down, 1)) * 180 / PI;
    return true;
}
