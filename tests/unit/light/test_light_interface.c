/* The contract of every kind of light: samples have the density of light_pdf and the radiance that a ray sees, and
 * photons carry the same light. A switch over all kinds makes the examples, so that a new kind is tested, too. */
#include "base/random.h"
#include "light/light_bounds.h"
#include "light/light_edit.h"
#include "light/light_mesh.h"
#include "light/light_sampler.h"
#include "light/sky_light_internal.h"
#include "math/frame.h"
#include "tests/harness.h"
#include "tests/unit/call_makers.h"
#include "tests/unit/colour_length.h"
#include "tests/unit/script_host.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* --- an example of every kind --- */

struct example {
    struct arena arena;
    struct pool *pool;
    struct light light;
    struct light_mesh mesh;
    struct sky sky;
};

/* A closed tetrahedron of edge 2 `size` / sqrt(2) with faces of different light. */
static void make_mesh(struct example *e, struct vec3 middle, double size) {
    static const double corners[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    static const int faces[4][3] = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
    struct light_mesh_builder builder;
    CHECK(light_mesh_begin(&builder, 4, &e->arena));
    for (int f = 0; f < 4; f++) {
        struct vec3 at[3];
        for (int k = 0; k < 3; k++) {
            const double *c = corners[faces[f][k]];
            at[k] = vec3_add_scaled(middle, vec3_make(c[0], c[1], c[2]), size / 2);
        }
        light_mesh_add(&builder, at, 1, 3, colour_make(1 + f, 2, 3));
    }
    light_mesh_end(&builder, e->light.colour, &e->mesh);
    e->light.mesh = &e->mesh;
}

/* Above the origin, with a size of about `size`, visible from below; `area_light`: with a radiance even if it is
 * optional for the kind.
 */
static void example_begin(struct example *e, enum light_kind kind, bool area_light, double size) {
    char warning[256];
    struct error error;
    const double s = size;
    *e = (struct example){.pool = pool_create(1, warning)};
    e->light = (struct light){.kind = kind, .colour = {3, 2, 1}, .falloff = {0.5, 0.25, 0.125}};
    e->light.position = vec3_make(0.3, 2, 0.2);
    switch (kind) {
    case LIGHT_POINT:
        break;
    case LIGHT_PARALLELOGRAM:
        e->light.emissive = area_light;
        e->light.edge1 = vec3_make(s, 0, 0.2 * s);
        e->light.edge2 = vec3_make(0, 0.1 * s, s); /* not at right angles */
        e->light.corner =
            vec3_add_scaled(vec3_add_scaled(e->light.position, e->light.edge1, -0.5), e->light.edge2, -0.5);
        break;
    case LIGHT_DIRECTIONAL:
        e->light.direction = vec3_normalize(vec3_make(0.3, -1, 0.2));
        break;
    case LIGHT_SPOT:
        e->light.direction = vec3_normalize(vec3_make(0.1, -1, 0.1));
        e->light.cos_inner = 0.9;
        e->light.cos_outer = 0.7;
        break;
    case LIGHT_DISC:
        e->light.emissive = area_light;
        e->light.direction = vec3_normalize(vec3_make(0.2, -1, 0));
        e->light.radius = s / 2;
        e->light.one_sided = true;
        break;
    case LIGHT_SPHERE:
        e->light.emissive = area_light;
        e->light.radius = s / 2;
        break;
    case LIGHT_MESH:
        e->light.emissive = true;
        make_mesh(e, e->light.position, s / 2);
        break;
    case LIGHT_SKY:
        e->light.emissive = true;
        sky_make_clear(vec3_normalize(vec3_make(1, 1, -1)), 3, colour_all(0.15), &e->sky);
        e->light.sky = &e->sky;
        break;
    }
    CHECK(light_prepare(&e->light, &e->arena, e->pool, &error));
}

static void example_end(struct example *e) {
    arena_destroy(&e->arena);
    pool_destroy(e->pool);
}

static struct sample2 xi_of(uint64_t seed, uint64_t index) {
    return (struct sample2){random_unit(random_combine(seed, 2 * index)),
                            random_unit(random_combine(seed, 2 * index + 1))};
}

/* The intersection of a ray and a triangle of a mesh (Moeller and Trumbore 1997). */
static bool triangle_meets_ray(const struct light_triangle *t, const struct ray *ray, struct light_hit *hit) {
    struct vec3 p = vec3_cross(ray->direction, t->edge2), off = vec3_sub(ray->origin, t->corner);
    double det = vec3_dot(t->edge1, p), u = vec3_dot(off, p) / det;
    struct vec3 q = vec3_cross(off, t->edge1);
    double v = vec3_dot(ray->direction, q) / det;
    hit->t = vec3_dot(t->edge2, q) / det;
    hit->point = ray_at(ray, hit->t);
    return u >= 0 && v >= 0 && u + v <= 1 && hit->t > 0;
}

/* Every hit of a ray on the light: at most one, except for a mesh. */
static int meet(const struct light *light, const struct ray *ray, struct light_hit hits[8]) {
    int count = 0;
    for (uint32_t i = 0; light->mesh && i < light->mesh->count; i++) {
        hits[count].triangle = i;
        count += triangle_meets_ray(&light->mesh->triangles[i], ray, &hits[count]);
    }
    if (light->mesh)
        return count;
    hits[0].t = INFINITY;
    return light_properties(light) & LIGHT_IS_ENVIRONMENT || light_meets_ray(light, ray, &hits[0]);
}

/* A light as a point sees it, or one triangle of it alone. */
struct sampled {
    const struct light *light;
    const struct light_context *context;
    uint32_t triangle; /* LIGHT_NONE: all of the light */
};

static double density(const struct sampled *s, struct vec3 direction) {
    struct ray ray = {.origin = s->context->from, .direction = direction, .t_max = INFINITY};
    struct light_hit hits[8];
    double sum = 0;
    int count = meet(s->light, &ray, hits);
    for (int i = 0; i < count; i++) {
        if (s->triangle == LIGHT_NONE)
            sum += light_pdf(s->light, s->context, direction, &hits[i]);
        else if (s->triangle == hits[i].triangle)
            sum += light_triangle_pdf(s->light->mesh, s->context->from, &hits[i]);
    }
    return sum;
}

static struct light_sample sample_of(const struct sampled *s, struct sample2 xi) {
    if (s->triangle == LIGHT_NONE)
        return light_sample(s->light, s->context, xi);
    return light_triangle_sample(s->light->mesh, s->triangle, s->context->point, s->context->from, xi);
}

/* The hit nearest to the target of a sample. */
static bool hit_of_sample(const struct light *light, const struct light_context *context,
                          const struct light_sample *sample, struct ray *ray, struct light_hit *hit) {
    struct light_hit hits[8];
    *ray = (struct ray){.origin = context->from, .t_max = INFINITY};
    ray->direction = light_target_from(&sample->target, context->from);
    int count = meet(light, ray, hits);
    for (int i = 0; i < count; i++)
        if (i == 0 || fabs(hits[i].t - 1) < fabs(hit->t - 1))
            *hit = hits[i];
    return count > 0;
}

/* Near lamps are sampled by solid angle if possible, far ones by area. */
#define FOR_EVERY_AREA_LIGHT(e, context)                                                                               \
    for (int kind_ = 0; kind_ < LIGHT_KIND_COUNT; kind_++)                                                             \
        for (int far_ = 0; far_ < 2; far_++)                                                                           \
            for (bool once_ = area_light_begin(&(e), (enum light_kind)kind_, far_, &(context)); once_;                 \
                 once_ = (example_end(&(e)), false))

static bool area_light_begin(struct example *e, enum light_kind kind, bool far, struct light_context *context) {
    const struct vec3 from = {0, far ? -1 : 0.4, 0.1};
    example_begin(e, kind, true, 1.5);
    e->light.edge1.z = far ? e->light.edge1.z : 0; /* at right angles: by solid angle */
    e->light.edge2.y = far ? e->light.edge2.y : 0;
    struct error error;
    CHECK(kind == LIGHT_SKY || light_prepare(&e->light, &e->arena, e->pool, &error));
    struct light_sample sample;
    bool made = light_context_make(&e->light, from, from, context);
    if (made)
        sample = light_sample(&e->light, context, (struct sample2){0.5, 0.5});
    if (made && !sample.is_delta)
        return true;
    CHECK(made);
    example_end(e);
    return false;
}

/* --- densities --- */

/* Cells of equal solid angle (Archimedes), with the poles away from the lamps; a fine grid within each cell gives its
 * share by light_pdf. */
enum { ROWS = 12, COLUMNS = 24, FINE = 40, CELLS = ROWS * COLUMNS };

static struct vec3 grid_direction(double row, double column) {
    double x = 1 - 2 * row / ROWS, turn = 2 * pi * column / COLUMNS, level = sqrt(1 - x * x);
    return vec3_make(x, level * cos(turn), level * sin(turn));
}

static int cell_of(struct vec3 d) {
    double turn = atan2(d.z, d.y) / (2 * pi);
    int row = (int)((1 - d.x) / 2 * ROWS), column = (int)((turn < 0 ? turn + 1 : turn) * COLUMNS);
    return (row < ROWS ? row : ROWS - 1) * COLUMNS + (column < COLUMNS ? column : COLUMNS - 1);
}

static double share_of_cell(const struct sampled *s, int cell) {
    double sum = 0;
    for (int k = 0; k < FINE * FINE; k++) {
        double row = cell / COLUMNS + (k / FINE + 0.5) / FINE, column = cell % COLUMNS + (k % FINE + 0.5) / FINE;
        sum += density(s, grid_direction(row, column));
    }
    return sum * 4 * pi / ((double)CELLS * FINE * FINE);
}

static void check_density(const char *name, const struct sampled *s) {
    enum { N = 40000 };
    static int counted[CELLS];
    int lost = 0, used = 0;
    double chi = 0, all = 0, rest = 0, rest_counted = 0;
    memset(counted, 0, sizeof counted);
    for (uint64_t i = 0; i < N; i++) {
        struct light_sample sample = sample_of(s, xi_of(77, i));
        bool on = colour_max_abs(sample.intensity) > 0;
        lost += !on;
        counted[cell_of(sample.direction)] += on;
    }
    for (int cell = 0; cell < CELLS; cell++) {
        double share = share_of_cell(s, cell), expected = share * N;
        all += share;
        if (expected < 20) { /* too few for the normal approximation: joined into one cell */
            rest += expected;
            rest_counted += counted[cell];
            continue;
        }
        chi += (counted[cell] - expected) * (counted[cell] - expected) / expected;
        used++;
    }
    if (rest > 20)
        chi += (rest_counted - rest) * (rest_counted - rest) / rest;
    /* Samples that miss the light are not in the integral. */
    CHECK_NEAR(all, 1 - (double)lost / N, 0.01);
    if (chi > used + 1 + 5 * sqrt(2.0 * (used + 1)))
        test_fail(__FILE__, __LINE__, "%s: chi-square %g in %d cells", name, chi, used);
}

TEST(samples_of_every_lamp_have_the_density_that_pdf_states) {
    struct example e;
    struct light_context context;
    FOR_EVERY_AREA_LIGHT(e, context)
    check_density(light_kind_name(e.light.kind), &(struct sampled){&e.light, &context, LIGHT_NONE});
}

/* Rays start closer to a sphere than directions to its other points are exact. */
TEST(samples_for_a_point_on_the_inside_of_a_sphere_have_all_directions) {
    enum { N = 100000, BINS = 20 };
    const struct vec3 outward = vec3_normalize(vec3_make(1, 2, -2));
    const struct light ball = {.kind = LIGHT_SPHERE, .colour = {1, 1, 1}, .emissive = true, .radius = 8};
    const struct vec3 point = vec3_scale(outward, 8), from = vec3_scale(outward, 8 - 0x1p-42);
    struct light_context context;
    int counted[BINS] = {0};
    double chi = 0;
    CHECK(light_context_make(&ball, point, from, &context));
    for (uint64_t i = 0; i < N; i++) {
        double cosine = vec3_dot(light_sample(&ball, &context, xi_of(5, i)).direction, outward);
        int bin = (int)((1 + cosine) / 2 * BINS);
        counted[bin < BINS ? bin : BINS - 1]++;
    }
    for (int i = 0; i < BINS; i++)
        chi += pow(counted[i] - N / (double)BINS, 2) / (N / (double)BINS);
    CHECK(chi < BINS + 5 * sqrt(2.0 * BINS));
}

TEST(samples_for_a_point_on_the_outside_of_a_sphere_stay_below_its_horizon) {
    const struct vec3 outward = vec3_normalize(vec3_make(1, 2, -2));
    const struct light ball = {.kind = LIGHT_SPHERE, .colour = {1, 1, 1}, .emissive = true, .radius = 8};
    const struct vec3 point = vec3_scale(outward, 8), from = vec3_scale(outward, 8 + 0x1p-42);
    struct light_context context;
    double highest = -1;
    CHECK(light_context_make(&ball, point, from, &context));
    for (uint64_t i = 0; i < 100000; i++)
        highest = fmax(highest, vec3_dot(light_sample(&ball, &context, xi_of(5, i)).direction, outward));
    CHECK(highest < 1e-5);
}

/* From near and far, from above the middle and from the side: by solid angle and by area. */
TEST(samples_of_single_triangles_have_the_density_that_pdf_states) {
    static const struct vec3 points[] = {{0.3, 1.6, 0.4}, {0.5, 1.1, 0.2},  {0.3, 0.6, -0.2},
                                         {1.1, 1.2, 0.9}, {0.3, -2.5, 0.2}, {0.31, 2.8, 0.19}};
    for (size_t i = 0; i < sizeof points / sizeof *points; i++) {
        struct example e;
        example_begin(&e, LIGHT_MESH, true, 1.5);
        e.mesh.one_sided = false;
        for (uint32_t triangle = 0; triangle < e.mesh.count; triangle++) {
            struct light_context context;
            CHECK(light_context_make(&e.light, points[i], points[i], &context));
            check_density("triangle", &(struct sampled){&e.light, &context, triangle});
        }
        example_end(&e);
    }
}

TEST(the_mean_of_one_over_pdf_is_the_solid_angle_of_a_lamp) {
    enum { N = 40000, SIDE = 400 };
    struct example e;
    struct light_context context;
    FOR_EVERY_AREA_LIGHT(e, context) {
        double mean = 0, angle = 0;
        for (uint64_t i = 0; i < N; i++) {
            struct light_sample sample = light_sample(&e.light, &context, xi_of(5, i));
            mean += colour_max_abs(sample.intensity) > 0 ? 1 / sample.pdf / N : 0;
        }
        for (int i = 0; i < SIDE * SIDE; i++) {
            struct vec3 d = grid_direction((i / SIDE + 0.5) / SIDE * ROWS, (i % SIDE + 0.5) / SIDE * COLUMNS);
            struct ray ray = {.origin = context.from, .direction = d, .t_max = INFINITY};
            struct light_hit hits[8];
            int count = meet(&e.light, &ray, hits);
            for (int k = 0; k < count; k++) /* each triangle of a mesh that faces the point separately */
                angle += light_pdf(&e.light, &context, d, &hits[k]) > 0 ? 4 * pi / (SIDE * SIDE) : 0;
        }
        CHECK_NEAR(mean / angle, 1, 0.03);
    }
}

/* --- radiance --- */

TEST(a_sample_of_every_lamp_has_the_radiance_of_a_ray_that_meets_it) {
    struct example e;
    struct light_context context;
    FOR_EVERY_AREA_LIGHT(e, context) {
        int on = 0;
        for (uint64_t i = 0; i < 500; i++) {
            struct light_sample sample = light_sample(&e.light, &context, xi_of(9, i));
            struct ray ray;
            struct light_hit hit;
            CHECK(!sample.is_delta);
            CHECK_NEAR(vec3_length(sample.direction), 1, 1e-12);
            if (!(colour_max_abs(sample.intensity) > 0))
                continue;
            on++;
            if (!hit_of_sample(&e.light, &context, &sample, &ray, &hit))
                continue; /* on its rim */
            struct colour seen = light_emitted(&e.light, &ray, &hit);
            CHECK_NEAR(light_pdf(&e.light, &context, sample.direction, &hit) / sample.pdf, 1, 1e-6);
            CHECK_NEAR(colour_length(colour_sub(seen, sample.radiance)), 0, 1e-6);
            CHECK(colour_max_abs(seen) <= light_brightest(&e.light) * (1 + 1e-9));
            /* The pi between radiance and classic intensity (docs/design/light.md). */
            struct colour unit = colour_scale(sample.intensity, pi * sample.pdf);
            CHECK_NEAR(colour_length(colour_sub(unit, sample.radiance)), 0, 1e-9);
        }
        CHECK(on > 200);
    }
}

TEST(a_light_without_emission_shades_from_one_direction_and_has_no_density) {
    int delta = 0;
    for (int kind = 0; kind < LIGHT_KIND_COUNT; kind++) {
        struct example e;
        struct light_context context;
        struct vec3 from = {0.1, 0, 0.2};
        example_begin(&e, (enum light_kind)kind, false, 1);
        struct light_arrival arrival;
        CHECK(light_context_make(&e.light, from, from, &context));
        for (uint64_t i = 0; i < 20 && light_is_delta(&e.light); i++) {
            struct light_sample sample = light_sample(&e.light, &context, xi_of(3, i));
            struct light_hit hit = {.t = 1, .point = sample.target.at};
            CHECK(light_arrive(&e.light, from, &arrival));
            CHECK(sample.is_delta && sample.pdf == 1);
            CHECK(light_pdf(&e.light, &context, sample.direction, &hit) == 0);
            CHECK(vec3_length(vec3_sub(sample.direction, arrival.direction)) == 0);
            CHECK_NEAR(sample.intensity.r, e.light.colour.r * arrival.strength, 1e-15);
            CHECK(sample.intensity.r > 0);
            CHECK(context.single == (vec3_length(vec3_sub(sample.target.at, arrival.middle.at)) == 0));
            delta += i == 0;
        }
        CHECK(light_is_delta(&e.light) || !light_arrive(&e.light, from, &arrival));
        example_end(&e);
    }
    CHECK(delta >= 6);
}

/* --- photons --- */

enum { GRID = 24, SAMPLES = 16, PHOTONS = 100000 };
static const double floor_radius = 2;

/* The light on a disc in the plane y = 0, by samples. */
static struct colour flux_by_samples(const struct light *light) {
    struct colour sum = {0, 0, 0};
    for (uint64_t k = 0; k < GRID * GRID; k++) {
        struct sample2 at = {((double)(k / GRID) + 0.5) / GRID, ((double)(k % GRID) + 0.5) / GRID};
        struct sample2 round = sample_disc(at);
        struct vec3 from = {floor_radius * round.x, 0, floor_radius * round.y};
        struct light_context context;
        for (uint64_t i = 0; i < SAMPLES && light_context_make(light, from, from, &context); i++) {
            struct light_sample sample = light_sample(light, &context, xi_of(k, i));
            if (sample.direction.y > 0)
                sum = colour_add_scaled(sum, sample.intensity, sample.direction.y);
        }
    }
    return colour_scale(sum, pi * floor_radius * floor_radius / (GRID * GRID * SAMPLES));
}

/* A uniformly drawn photon and the inverse of its density: LOCAL over all directions, others over a perpendicular
 * square that contains the disc. */
static struct light_photon photon_at(const struct light_emitter *emitter, uint64_t index) {
    struct sample2 a = xi_of(11, index), b = xi_of(12, index);
    struct vec3 direction = grid_direction(a.x * ROWS, a.y * COLUMNS);
    if (emitter->domain == LIGHT_DOMAIN_LOCAL) {
        struct light_photon photon = light_photon(emitter, direction, b);
        photon.power = colour_scale(photon.power, 4 * pi);
        return photon;
    }
    struct light_photon photon = light_photon(emitter, direction, b);
    struct vec3 right, up;
    frame_tangents(photon.direction, &right, &up);
    photon.origin = vec3_add_scaled(vec3_scale(right, floor_radius * (2 * a.x - 1)), up, floor_radius * (2 * a.y - 1));
    photon.origin = vec3_add_scaled(photon.origin, photon.direction, -10);
    photon.power = colour_scale(photon.power, 4 * floor_radius * floor_radius);
    return photon;
}

static struct colour flux_by_photons(const struct light *light) {
    struct light_emitter emitter;
    struct colour sum = {0, 0, 0};
    if (!light_emitter_make(light, 0, 0, 1, &emitter))
        return sum;
    for (uint64_t i = 0; i < PHOTONS; i++) {
        struct light_photon photon = photon_at(&emitter, i);
        if (!(photon.direction.y < 0) || !(photon.origin.y > 0))
            continue;
        double length = -photon.origin.y / photon.direction.y;
        struct vec3 landed = vec3_add_scaled(photon.origin, photon.direction, length);
        if (landed.x * landed.x + landed.z * landed.z < floor_radius * floor_radius)
            sum = colour_add_scaled(sum, photon.power, light_photon_attenuation(light, length) / PHOTONS);
    }
    return sum;
}

TEST(photons_of_every_light_carry_the_power_of_its_samples) {
    for (int kind = 0; kind < LIGHT_KIND_COUNT; kind++) {
        for (int area_light = 0; area_light < 2; area_light++) {
            struct example e;
            /* Without emission it is sampled as if from its centre: small, so that positions do not matter. */
            example_begin(&e, (enum light_kind)kind, area_light, area_light ? 1.2 : 0.2);
            struct colour sampled = flux_by_samples(&e.light), sent = flux_by_photons(&e.light);
            CHECK(sampled.r > 0);
            CHECK_NEAR(sent.r / sampled.r, 1, 0.03);
            CHECK_NEAR(sent.b / sampled.b, 1, 0.03);
            example_end(&e);
        }
    }
}

TEST(photons_of_the_parts_of_a_light_are_those_of_the_whole) {
    for (int kind = 0; kind < LIGHT_KIND_COUNT; kind++) {
        struct example e;
        double units[2] = {0, 0};
        example_begin(&e, (enum light_kind)kind, true, 1);
        uint32_t max = light_divided_extent(&e.light) > 0 ? 2 : 1;
        for (uint32_t parts = 1; parts <= max; parts++) {
            for (uint32_t part = 0; part < parts * parts; part++) {
                struct light_emitter emitter;
                CHECK(light_emitter_make(&e.light, part % parts, part / parts, parts, &emitter));
                units[parts - 1] += light_emitter_unit(&emitter);
                for (uint64_t i = 0; i < 100 && emitter.domain == LIGHT_DOMAIN_LOCAL; i++) {
                    struct light_photon photon = photon_at(&emitter, i);
                    CHECK(vec3_length(vec3_sub(photon.origin, emitter.centre)) <= emitter.radius * (1 + 1e-9));
                }
            }
        }
        CHECK(max == 1 || fabs(units[1] / units[0] - 1) < 1e-12);
        example_end(&e);
    }
}

/* --- from afar --- */

/* The importance is 0 only if no sample brings light; otherwise it is about as large as the light of the samples. */
TEST(the_bounds_of_every_light_hold_its_samples) {
    for (int kind = 0; kind < LIGHT_KIND_COUNT; kind++) {
        for (int area_light = 0; area_light < 2; area_light++) {
            struct example e;
            struct light_bounds bounds[64]; /* of its parts */
            example_begin(&e, (enum light_kind)kind, area_light, 0.4);
            uint32_t parts = light_part_count(&e.light);
            enum light_extent extent = LIGHT_EXTENT_NONE;
            CHECK(parts > 0 && parts <= 64);
            for (uint32_t k = 0; k < parts; k++) {
                extent = light_bounds_of(&e.light, k, &bounds[k]);
                CHECK(extent != LIGHT_EXTENT_NONE);
            }
            int lit = 0;
            for (uint64_t i = 0; i < 400 && extent == LIGHT_EXTENT_BOUNDED; i++) {
                struct sample2 a = xi_of(41, i), b = xi_of(42, i);
                struct vec3 from = {8 * a.x - 4, 8 * a.y - 2, 8 * b.x - 4}, normal = {0, i % 2 ? -0.6 : 0.8, 0.6};
                struct light_context context;
                double brought = 0, importance = 0;
                for (uint32_t k = 0; k < parts; k++)
                    importance += light_bounds_importance(&bounds[k], from, vec3_normalize(normal));
                for (uint64_t k = 0; k < 64 && light_context_make(&e.light, from, from, &context); k++) {
                    struct light_sample sample = light_sample(&e.light, &context, xi_of(43, k));
                    double cosine = fabs(vec3_dot(sample.direction, vec3_normalize(normal)));
                    brought += (sample.intensity.r + sample.intensity.g + sample.intensity.b) / 3 * cosine / 64;
                }
                CHECK(importance > 0 || !(brought > 0));
                CHECK(brought < 3 * importance + 1e-12);
                lit += brought > 0.2 * importance && brought > 0;
            }
            CHECK(extent == LIGHT_EXTENT_INFINITE || lit > 20);
            struct box box;
            CHECK(!light_surface_box(&e.light, &box) ||
                  (box_contains(&box, e.light.position) && extent == LIGHT_EXTENT_BOUNDED));
            example_end(&e);
        }
    }
}

/* --- listings and the language --- */

TEST(every_kind_of_light_has_a_name_of_its_own_and_edits_by_what_it_has) {
    for (int kind = 0; kind < LIGHT_KIND_COUNT; kind++) {
        const char *name = light_kind_name((enum light_kind)kind);
        struct example e;
        struct vec3 before, after;
        for (int other = 0; other < kind; other++)
            CHECK(strcmp(name, light_kind_name((enum light_kind)other)) != 0);
        CHECK(strlen(name) > 1);
        example_begin(&e, (enum light_kind)kind, true, 1);
        unsigned has = light_properties(&e.light);
        if (light_centre(&e.light, &before) && light_can_move(&e.light)) {
            light_move(&e.light, vec3_make(1, 2, 3));
            CHECK(light_centre(&e.light, &after) && vec3_length(vec3_sub(after, before)) > 3);
        }
        CHECK(light_can_move(&e.light) == ((has & LIGHT_HAS_POSITION) != 0));
        CHECK(!(has & LIGHT_HAS_DIRECTION) || vec3_max_abs(e.light.direction) > 0);
        CHECK(!(has & LIGHT_HAS_RADIUS) || e.light.radius > 0);
        CHECK(!(has & LIGHT_HAS_EDGES) || vec3_max_abs(e.light.edge1) > 0);
        CHECK(!(has & LIGHT_HAS_CONE) || e.light.cos_outer < 1);
        example_end(&e);
    }
}

static unsigned kinds_made;

static void note_kinds(struct listener *listener, const struct render_request *request) {
    (void)listener;
    for (uint32_t i = 0; i < request->light_count; i++)
        kinds_made |= 1U << request->lights[i].light.kind;
}

TEST(every_kind_of_light_has_a_function_of_the_language) {
    write_files();
    kinds_made = 0;
    for (int f = 0; f < function_count(); f++) {
        const struct script_function *function = function_at(f);
        char call[CALL_SIZE], text[CALL_SIZE + 512];
        struct listener listener = {.seen = note_kinds};
        struct error error;
        if (function->result != RESULT_LIGHT)
            continue;
        table_call(function, -1, "", call);
        (void)snprintf(text, sizeof text,
                       "sheet = gr.mesh(gr.material({1, 1, 1}, {0, 0, 0}, 1), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, "
                       "{{0, 1, 2}})\nball = gr.sphere('ball')\nlight = %s\n"
                       "gr.render{node = sheet, file = 'x.png', width = 4, height = 4, eye = {0, 0, 9}, "
                       "lights = {light}}\n",
                       call);
        if (!listen_to_text(&listener, text, NULL, &error))
            test_fail(__FILE__, __LINE__, "%s: %s", call, error.text);
    }
    CHECK(kinds_made == (1U << LIGHT_KIND_COUNT) - 1);
}
