/* Different estimators of the same light agree: sampling lights, sampling BSDFs and both; the tree of lights and
 * uniform choice; the path tracer and a tracer of a page that knows neither lights nor weights. */
#include "base/random.h"
#include "material/material_eval.h"
#include "math/frame.h"
#include "shape/planar.h"
#include "tests/harness.h"
#include "tests/unit/path_estimate.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static struct material *glowing(struct stage *s, double emission) {
    struct material *material = stage_phong(s, colour_all(0), colour_all(0), 1);
    material->phong.emission = colour_all(emission);
    return material;
}

static struct material *rough_metal(struct stage *s, double roughness) {
    struct material *material = stage_phong(s, colour_all(0), colour_all(0.9), 1);
    material->phong.reflect = 1;
    material->phong.roughness = roughness;
    return material;
}

static struct node *ball(struct stage *s, const struct material *material, struct vec3 centre, double radius) {
    struct node *node = stage_sphere(s, s->root, material);
    stage_scale(s, node, radius, radius, radius);
    stage_move(s, node, centre.x, centre.y, centre.z);
    return node;
}

/* --- the plates of Veach and Guibas ("Optimally Combining Sampling Techniques for Monte Carlo Rendering", 1995) --- */

static void begin_plates(struct stage *s) {
    static const double radii[] = {0.4, 0.6, 0.8, 1}, roughness[] = {0.3, 0.45, 0.6};
    stage_begin(s, 1);
    s->camera = (struct camera){{0, 2, 13}, {0, -0.1, -1}, {0, 1, 0}, 22};
    for (int i = 0; i < 4; i++)
        (void)ball(s, glowing(s, 1.5 / (radii[i] * radii[i])), vec3_make(-4.5 + 3 * i, 4.6, -3), radii[i]);
    for (int i = 0; i < 3; i++) { /* from the furthest and highest to the nearest and lowest */
        struct node *plate = stage_cube(s, s->root, rough_metal(s, roughness[i]));
        stage_move(s, plate, -0.5, -0.5, -0.5);
        stage_scale(s, plate, 9, 0.1, 1.6);
        stage_rotate(s, plate, 0, 24 - 8 * i);
        stage_move(s, plate, 0, 1.6 - 1.1 * i, -2.6 + 1.8 * i);
    }
}

/* BSDFs alone rarely hit the small lamps: they get `more` times as many samples. */
static void check_plates(struct effort effort, int more, double precision, double of_bsdfs) {
    static const char *const claims[] = {"plates: both and lights alone", "plates: both and BSDFs alone"};
    for (int seed = 1; seed <= effort.seeds; seed++) {
        struct estimate by[3];
        for (int strategy = PATH_STRATEGY_MIS; strategy <= PATH_STRATEGY_BSDF; strategy++) {
            struct stage s;
            begin_plates(&s);
            s.settings.path_strategy = (enum path_strategy)strategy;
            const struct effort spent = {effort.size, effort.samples * (strategy == PATH_STRATEGY_BSDF ? more : 1), 1};
            by[strategy] = estimate_render_twice(&s, &spent, 3, seed + 10 * strategy);
            stage_end(&s);
        }
        for (int i = 0; i < 2; i++)
            estimate_check_equal(claims[i], by[PATH_STRATEGY_MIS], by[PATH_STRATEGY_LIGHTS + i], seed,
                                 i == 0 ? precision : of_bsdfs);
        /* On plates as rough as these lights alone have about the same error. */
        CHECK(by[PATH_STRATEGY_MIS].error < 1.25 * by[PATH_STRATEGY_LIGHTS].error);
        CHECK(by[PATH_STRATEGY_MIS].error < sqrt(more) * by[PATH_STRATEGY_BSDF].error);
    }
}

TEST(sampling_lights_and_bsdfs_and_both_agree_on_the_plates) {
    check_plates((struct effort){16, 512, 1}, 1, 0.005, 0.02);
}
TEST_LONG(sampling_lights_and_bsdfs_and_both_agree_on_the_plates_for_every_seed) {
    check_plates((struct effort){16, 12288, 3}, 8, 0.001, 0.001);
}

/* --- brute force --- */

/* A sky, emitting surfaces of several kinds, and surfaces that are matt, rough metal and rough glass. */
static void begin_mixed_scene(struct stage *s) {
    stage_begin(s, 1);
    s->sky.colour = colour_make(0.3, 0.3, 0.3);
    struct node *floor = stage_sphere(s, s->root, stage_phong(s, colour_all(0.7), colour_all(0), 1));
    floor->shape = (struct shape){.kind = SHAPE_PLANAR, .planar = planar_plane(vec3_make(0, 1, 0), -1)};
    (void)ball(s, rough_metal(s, 0.7), vec3_make(-1.2, 0, 0), 1);
    struct material *glass = stage_glass(s, 0, 1, 2.5); /* of a low index would have brighter and rarer directions */
    glass->fresnel = true;
    glass->phong.roughness = 1;
    (void)ball(s, glass, vec3_make(1.2, 0, 0.4), 0.9);
    (void)ball(s, glowing(s, 2), vec3_make(0, 2.6, -0.5), 0.8);
    struct node *box = stage_cube(s, s->root, glowing(s, 1)); /* without a sampler of its own */
    stage_scale(s, box, 0.8, 1.6, 0.8);
    stage_move(s, box, -3, -1, 0.6);
    struct material *both = stage_phong(s, colour_all(0.5), colour_all(0), 1); /* emits and scatters */
    both->phong.emission = colour_all(0.4);
    both->phong.two_sided = true;
    struct node *sheet = stage_sphere(s, s->root, both);
    sheet->shape = (struct shape){
        .kind = SHAPE_PLANAR,
        .planar = planar_parallelogram(vec3_make(2.4, -1, -2), vec3_make(0, 0, 3), vec3_make(0.6, 2.5, 0))};
    s->camera = (struct camera){{0, 0.6, 6}, {0, 0, -1}, {0, 1, 0}, 50};
}

enum { BRUTE_DEPTH = 3, BRUTE_SETS = 64 };

/* The numbers of path i of a set: each dimension is a multiple of an irrational number, modulo 1, from a random start.
 * The numbers are powers of the root of x^7 = x + 1, so that the points fill the cube of six dimensions evenly. */
static struct sample2 brute_numbers(const double start[2 * BRUTE_DEPTH], uint64_t i, int vertex) {
    static const double root = 1.1127756842787054706;
    double at[2];
    for (int k = 0; k < 2; k++) {
        double x = start[2 * vertex + k] + (double)i * pow(root, -(2 * vertex + k + 1));
        at[k] = x - floor(x);
    }
    return (struct sample2){at[0], at[1]};
}

/* Uniform over the sphere, or over the half before an opaque surface. */
static struct vec3 uniform_direction(struct sample2 xi, const struct vec3 *side) {
    double y = side ? xi.x : 1 - 2 * xi.x, level = sqrt(fmax(0, 1 - y * y)), angle = 2 * pi * xi.y;
    struct vec3 axis = side ? *side : vec3_make(0, 1, 0), right, up;
    frame_tangents(axis, &right, &up);
    struct vec3 across = vec3_add(vec3_scale(right, level * cos(angle)), vec3_scale(up, level * sin(angle)));
    return vec3_add_scaled(across, axis, y);
}

/* Every direction in which a vertex may send light is as likely. */
static double brute_force(const struct stage *s, struct world_scratch *scratch, struct ray ray, int depth,
                          const double start[2 * BRUTE_DEPTH], uint64_t number) {
    const struct material_context context = {.total_reflection = true};
    struct medium_stack media = {.media = &s->world.media};
    struct hit hit;
    struct bsdf bsdf;
    double sum = 0, weight = 1;
    ray.media = &media;
    for (int i = 0; weight > 0; i++) {
        if (!world_nearest(&s->world, &ray, scratch, &hit))
            return sum + weight * s->sky.colour.r;
        material_eval(&s->world.surfaces, &hit, ray.media, &context, &bsdf);
        sum += weight * bsdf.emission.r;
        if (i == depth)
            break;
        uint32_t transmit = bsdf_lobes_with(&bsdf, BSDF_TRANSMITS);
        struct vec3 wi = uniform_direction(brute_numbers(start, number, i), transmit ? NULL : &bsdf.geometric_side);
        bool through = !(vec3_dot(wi, bsdf.geometric_side) > 0);
        uint32_t lobes = through ? transmit : BSDF_ALL;
        lobes &= ~bsdf_lobes_with(&bsdf, BSDF_EXPONENT); /* highlights stand for what the rough mirror shows */
        double angle = transmit ? 4 * pi : 2 * pi;
        weight *= lobes ? bsdf_eval(&bsdf, lobes, BSDF_RADIANCE, hit.view, wi).r * angle : 0;
        ray = hit_ray(&hit, &ray, wi, &media);
        if (through)
            medium_stack_cross(&media, &bsdf.boundary);
    }
    return sum;
}

/* The error is that of independent sets of paths. */
static struct estimate brute_force_mean(const struct stage *s, struct vec3 direction, int depth, uint64_t paths,
                                        uint64_t seed) {
    struct world_scratch scratch;
    double sum = 0, squares = 0, start[2 * BRUTE_DEPTH];
    const struct ray ray = {.origin = s->camera.eye, .direction = direction, .t_max = INFINITY, .time = 0.5};
    CHECK(world_scratch_init(&scratch, &s->world));
    for (uint64_t set = 0; set < BRUTE_SETS; set++) {
        double of_set = 0, count = (double)(paths / BRUTE_SETS);
        for (uint64_t d = 0; d < 2 * BRUTE_DEPTH; d++)
            start[d] = random_unit(random_combine(random_combine(seed, set), d));
        for (uint64_t i = 0; i < paths / BRUTE_SETS; i++)
            of_set += brute_force(s, &scratch, ray, depth, start, i);
        sum += of_set / count;
        squares += of_set / count * (of_set / count);
    }
    world_scratch_destroy(&scratch);
    double mean = sum / BRUTE_SETS;
    return (struct estimate){mean, sqrt((squares / BRUTE_SETS - mean * mean) / (BRUTE_SETS - 1))};
}

/* At places on the floor, the metal, the glass, the sheet and near the box. */
static void turn_camera(struct stage *s, size_t i) {
    static const double targets[][3] = {{0, -1, 0.5}, {-1.2, 0, 1}, {1.2, 0.1, 1.3}, {2.7, 0.2, -0.5}, {-2, -1, -1}};
    s->camera.view = vec3_sub(vec3_make(targets[i][0], targets[i][1], targets[i][2]), s->camera.eye);
    s->camera.fov = 1e-6;
}

enum { TARGETS = 5, DEPTH = 3 };

/* How much larger the effort for each target is than that for the sheet, for equal errors. */
static const int target_effort[TARGETS] = {2, 2, 48, 1, 3};

static struct effort effort_for(size_t target, struct effort effort) {
    effort.samples *= target_effort[target];
    return effort;
}

static void check_brute_force(struct effort effort, uint64_t paths, double precision) {
    struct stage s;
    begin_mixed_scene(&s);
    for (size_t i = 0; i < TARGETS; i++) {
        const struct effort by_path = effort_for(i, effort);
        turn_camera(&s, i);
        for (int seed = 1; seed <= effort.seeds; seed++) {
            struct estimate path = estimate_render(&s, &by_path, DEPTH, seed);
            struct estimate brute = brute_force_mean(&s, s.camera.view, DEPTH, paths * (i == 2 ? 14 : 1),
                                                     random_combine(i, (uint64_t)seed));
            estimate_check_equal("brute force", brute, path, seed, precision);
        }
    }
    stage_end(&s);
}

TEST(brute_force_agrees_where_all_lights_have_bodies_or_are_skies) {
    check_brute_force((struct effort){8, 24, 1}, 24000, 0.05);
}
TEST_LONG(brute_force_agrees_where_all_lights_have_bodies_or_are_skies_for_every_seed) {
    check_brute_force((struct effort){16, 1024, 3}, 1280000, 0.001);
}

/* The same with directions of the BSDF, of which fewer have light. */
static void check_bsdf_sampling(struct effort both, struct effort bsdf_effort, double precision) {
    struct stage s;
    begin_mixed_scene(&s);
    for (size_t i = 0; i < TARGETS; i++) {
        /* Less for the glass, which few directions lead through to a lamp. */
        const int part = i == 2 ? 2 : 1;
        struct effort by_both = effort_for(i, both), by_bsdf = effort_for(i, bsdf_effort);
        by_both.samples /= part;
        by_bsdf.samples /= part;
        turn_camera(&s, i);
        for (int seed = 1; seed <= both.seeds; seed++) {
            s.settings.path_strategy = PATH_STRATEGY_MIS;
            struct estimate a = estimate_render(&s, &by_both, DEPTH, seed);
            s.settings.path_strategy = PATH_STRATEGY_BSDF;
            struct estimate b = estimate_render(&s, &by_bsdf, DEPTH, seed + 10);
            estimate_check_equal("sky and lamps: both and BSDFs alone", a, b, seed, precision * part);
        }
    }
    stage_end(&s);
}

TEST(sampling_bsdfs_alone_agrees_where_all_lights_have_bodies_or_are_skies) {
    check_bsdf_sampling((struct effort){8, 48, 1}, (struct effort){8, 96, 1}, 0.04);
}
TEST_LONG(sampling_bsdfs_alone_agrees_where_all_lights_have_bodies_or_are_skies_for_every_seed) {
    check_bsdf_sampling((struct effort){16, 640, 3}, (struct effort){16, 2560, 3}, 0.001);
}

/* --- a thousand lamps --- */

enum { BRIGHT_COUNT = 1000 };

static struct vec3 bright_centre(uint64_t i) {
    return vec3_make(2.8 * random_unit(random_combine(3, i)) - 1.4, 2.9,
                     -0.2 * ((double)i + random_unit(random_combine(4, i))));
}

/* One mesh of triangles that face down. */
static void add_bright_mesh(struct stage *s, const struct material *material) {
    static double vertices[3 * BRIGHT_COUNT][3];
    static uint32_t start[BRIGHT_COUNT + 1], index[3 * BRIGHT_COUNT];
    for (uint32_t i = 0; i < BRIGHT_COUNT; i++) {
        struct vec3 c = bright_centre(i);
        const double corners[3][3] = {{c.x, c.y, c.z}, {c.x + 0.1, c.y, c.z}, {c.x, c.y, c.z + 0.1}};
        memcpy(vertices[3 * (size_t)i], corners, sizeof corners);
        for (uint32_t k = 0; k < 3; k++)
            index[3 * i + k] = 3 * i + k;
        start[i + 1] = 3 * (i + 1);
    }
    const struct mesh_input input = {.name = "mesh",
                                     .vertex_count = 3 * BRIGHT_COUNT,
                                     .face_count = BRIGHT_COUNT,
                                     .vertices = (const double(*)[3])vertices,
                                     .face_start = start,
                                     .vertex_index = index};
    struct node *node = stage_sphere(s, s->root, material);
    node->shape = (struct shape){.kind = SHAPE_MESH, .mesh = assets_mesh(&s->assets, &input, &s->error)};
}

/* Below the ceiling of a corridor of 3 x 3 x 200: balls, or the triangles of a mesh. */
static void begin_corridor(struct stage *s, enum light_choice choice, bool mesh) {
    stage_begin(s, 1);
    s->settings.light_choice = choice;
    const struct material *bright = glowing(s, 100);
    for (uint64_t i = 0; i < BRIGHT_COUNT && !mesh; i++)
        (void)ball(s, bright, bright_centre(i), 0.04);
    if (mesh)
        add_bright_mesh(s, bright);
    struct material *grey = stage_phong(s, colour_all(0.6), colour_all(0), 1);
    grey->phong.two_sided = true;
    struct node *walls = stage_cube(s, s->root, grey);
    stage_scale(s, walls, 3, 3, 202);
    stage_move(s, walls, -1.5, 0, -201);
    s->camera.fov = 1e-6;
}

static void turn_camera_in_corridor(struct stage *s, int i) {
    double z = -(10 + 19.3 * i);
    s->camera.eye = vec3_make(0, 1.5, z);
    s->camera.view = i % 3 == 1 ? vec3_make(-1.5, -0.3, 0) : vec3_make(0.25 * (i % 5) - 0.5, -1.5, 0);
    s->camera.up = vec3_make(0, 0, 1);
}

/* With few samples, since the variance of many falls faster. */
static void check_corridor_variance(bool mesh) {
    const struct effort effort = {16, 16, 1};
    double error[2][10];
    for (int uniform = 0; uniform < 2; uniform++) {
        struct stage s;
        begin_corridor(&s, uniform ? LIGHT_CHOICE_UNIFORM : LIGHT_CHOICE_TREE, mesh);
        for (int i = 0; i < 10; i++) {
            turn_camera_in_corridor(&s, i);
            error[uniform][i] = estimate_render(&s, &effort, 1, 1).error;
        }
        stage_end(&s);
    }
    for (int i = 0; i < 10; i++)
        CHECK(error[0][i] > 0 && error[0][i] * error[0][i] * 10 <= error[1][i] * error[1][i]);
}

TEST(a_thousand_lamps_have_a_tenth_of_the_variance_of_uniform_choice_at_ten_points) {
    check_corridor_variance(false);
}
TEST(a_mesh_of_a_thousand_lamps_has_a_tenth_of_the_variance_of_uniform_choice_at_ten_points) {
    check_corridor_variance(true);
}

static void check_corridor(bool mesh, struct effort by_tree, struct effort by_uniform, double precision) {
    const int step = by_tree.seeds > 1 ? 1 : 4;
    struct stage tree, uniform;
    begin_corridor(&tree, LIGHT_CHOICE_TREE, mesh);
    begin_corridor(&uniform, LIGHT_CHOICE_UNIFORM, mesh);
    for (int seed = 1; seed <= by_tree.seeds; seed++) {
        for (int i = 0; i < 10; i += step) {
            turn_camera_in_corridor(&tree, i);
            turn_camera_in_corridor(&uniform, i);
            estimate_check_equal(mesh ? "mesh of 1,000 lamps: tree and uniform choice"
                                      : "1,000 lamps: tree and uniform choice",
                                 estimate_render(&tree, &by_tree, 1, seed),
                                 estimate_render(&uniform, &by_uniform, 1, seed), seed, precision);
        }
    }
    stage_end(&tree);
    stage_end(&uniform);
}

TEST(the_tree_of_a_thousand_lamps_agrees_with_uniform_choice) {
    check_corridor(false, (struct effort){8, 64, 1}, (struct effort){8, 1024, 1}, 0.02);
    check_corridor(true, (struct effort){8, 64, 1}, (struct effort){8, 1024, 1}, 0.02);
}
TEST_LONG(the_tree_of_a_thousand_lamps_agrees_with_uniform_choice_at_ten_points_for_every_seed) {
    check_corridor(false, (struct effort){8, 2048, 3}, (struct effort){8, 16384, 3}, 0.001);
    check_corridor(true, (struct effort){8, 2048, 3}, (struct effort){8, 16384, 3}, 0.001);
}
