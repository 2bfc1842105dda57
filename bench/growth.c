/* The cost of a ray in growing scenes: meshes from 10 to 10 million triangles, from 1 to 10 million instances of a
 * mesh, a mesh in a stadium beside the same mesh alone. Ray times are processor time of one thread, the best of several
 * rounds; building uses the given number of threads.
 *
 *   growth [--most N] [--threads N] [--models FOLDER] [--svg FILE] [triangles] [instances] [stadium] */
#include "base/isa.h"
#include "bench/rays_scenes.h"
#include "mesh/mesh.h"
#include "scene/node.h"
#include "world/packet.h"
#include "world/world.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { SIDE = 320, ROUNDS = 3, MAX_ROWS = 64 };

/* One line of the table. Per ray: nanoseconds, triangles tested, nodes of hierarchies visited. */
struct row {
    const char *series;
    double objects, build_seconds, bytes_each;
    double camera_ns, chord_ns, tests, steps;
};

struct bench {
    struct row rows[MAX_ROWS];
    int count, threads;
    double max;
    const char *models, *svg;
    struct pool *pool;
};

static double seconds(clockid_t clock) {
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static struct mesh *mesh_of(const struct bench_scene *scene, uint32_t first, uint32_t count) {
    double(*vertices)[3] = malloc(scene->vertex_count * sizeof *vertices);
    uint32_t *starts = malloc(((size_t)count + 1) * sizeof *starts);
    struct error error;
    if (!vertices || !starts)
        exit(3);
    for (uint32_t i = 0; i < scene->vertex_count; i++)
        for (int k = 0; k < 3; k++)
            vertices[i][k] = (double)scene->vertices[i][k];
    for (uint32_t i = 0; i <= count; i++)
        starts[i] = 3 * i;
    struct mesh_input input = {.name = scene->name,
                               .vertex_count = scene->vertex_count,
                               .face_count = count,
                               .vertices = (const double(*)[3])vertices,
                               .face_start = starts,
                               .vertex_index = scene->corners[first]};
    struct mesh *mesh = mesh_create(&input, &error);
    free(vertices);
    free(starts);
    if (!mesh)
        exit(3);
    return mesh;
}

static uint64_t dice;

static double roll(void) {
    uint64_t x = dice += UINT64_C(0x9e3779b97f4a7c15);
    x = (x ^ x >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ x >> 27) * UINT64_C(0x94d049bb133111eb);
    return (double)((x ^ x >> 31) >> 11) * 0x1p-53;
}

static struct vec3 vector(const float v[3]) {
    return vec3_make((double)v[0], (double)v[1], (double)v[2]);
}

static void camera_rays(const struct bench_scene *scene, struct ray *rays) {
    struct vec3 eye = vector(scene->eye), view = vec3_normalize(vec3_sub(vector(scene->target), eye));
    struct vec3 right = vec3_normalize(vec3_cross(view, vec3_make(0, 1, 0))), up = vec3_cross(right, view);
    double path_policy = tan((double)scene->field * M_PI / 360);
    for (int i = 0; i < SIDE * SIDE; i++) { /* in patches of 8 x 8 pixels */
        int patch = i / 64, x = patch % (SIDE / 8) * 8 + i % 8, y = patch / (SIDE / 8) * 8 + i / 8 % 8;
        double a = path_policy * ((x + 0.5) / SIDE * 2 - 1), b = path_policy * (1 - (y + 0.5) / SIDE * 2);
        rays[i] = (struct ray){.origin = eye, .t_max = INFINITY};
        rays[i].direction = vec3_add_scaled(vec3_add_scaled(view, right, a), up, b);
    }
}

/* From a random point in the box to another. */
static void chords(const struct box *box, struct ray *rays) {
    dice = 1;
    for (int i = 0; i < SIDE * SIDE; i++) {
        double p[6];
        for (int k = 0; k < 6; k++) {
            double lo = vec3_get(box->min, k % 3), hi = vec3_get(box->max, k % 3);
            p[k] = lo + roll() * (hi - lo);
        }
        rays[i] = (struct ray){.origin = {p[0], p[1], p[2]}, .t_max = INFINITY};
        rays[i].direction = vec3_sub(vec3_make(p[3], p[4], p[5]), rays[i].origin);
    }
}

/* Nanoseconds per ray through the world; optionally the tests and node visits of one round. */
static double trace(const struct world *world, const struct ray *rays, int count, struct world_scratch *scratch,
                    struct row *row) {
    double best = INFINITY;
    for (int round = 0; round < ROUNDS; round++) {
        struct triangle_cost before = scratch->geom.cost;
        double start = seconds(CLOCK_THREAD_CPUTIME_ID);
        for (int i = 0; i < count; i++) {
            uint32_t primitive;
            struct crossing crossing;
            (void)world_nearest_crossing(world, &rays[i], scratch, &primitive, &crossing);
        }
        best = fmin(best, 1e9 * (seconds(CLOCK_THREAD_CPUTIME_ID) - start) / fmax(count, 1));
        if (row && round == 0) {
            row->tests = (double)(scratch->geom.cost.triangle_tests - before.triangle_tests) / count;
            row->steps = (double)(scratch->geom.cost.hierarchy_steps - before.hierarchy_steps) / count;
        }
    }
    return best;
}

/* The same in packets, as the renderer traces camera rays. */
static double trace_together(const struct world *world, const struct ray *rays, int count,
                             struct world_scratch *scratch) {
    static struct ray_packet packet;
    static struct packet_answer answers[PACKET_RAYS];
    double start = seconds(CLOCK_THREAD_CPUTIME_ID);
    for (int first = 0; first < count; first += PACKET_RAYS) {
        packet.count = (uint32_t)(count - first < PACKET_RAYS ? count - first : PACKET_RAYS);
        packet.origin = rays[first].origin;
        packet.t_min = packet.time = 0;
        for (uint32_t i = 0; i < packet.count; i++) {
            const struct ray *ray = &rays[first + (int)i];
            packet.direction[0][i] = ray->direction.x;
            packet.direction[1][i] = ray->direction.y;
            packet.direction[2][i] = ray->direction.z;
            packet.t_max[i] = ray->t_max;
        }
        ray_packet_pad(&packet);
        (void)world_nearest_packet(world, &packet, scratch, answers);
    }
    return 1e9 * (seconds(CLOCK_THREAD_CPUTIME_ID) - start) / fmax(count, 1);
}

/* A world of meshes with one or many instances each. */
struct setup {
    struct assets assets;
    struct scene scene;
    struct arena arena;
    struct world world;
    struct node *root;
    struct error error;
};

static void setup_begin(struct setup *setup) {
    *setup = (struct setup){0};
    scene_init(&setup->scene, &setup->assets);
    setup->root = scene_node(&setup->scene, NODE_GROUP, "root", &setup->error);
}

static struct node *setup_add(struct setup *setup, struct node *parent, struct mesh *mesh) {
    struct node *node = scene_node(&setup->scene, NODE_GEOMETRY, "mesh", &setup->error);
    node->shape = (struct shape){.kind = SHAPE_MESH, .mesh = mesh};
    if (!node_add_child(&setup->scene, parent, node, &setup->error))
        exit(3);
    return node;
}

static double setup_build(struct setup *setup, struct pool *pool) {
    struct sky sky = {.kind = SKY_CONSTANT};
    double start = seconds(CLOCK_MONOTONIC);
    const struct world_input input = {.scene = &setup->scene, .root = setup->root, .sky = &sky, .accel = ACCEL_AUTO};
    if (!world_build(&setup->world, &input, &setup->arena, pool, &setup->error)) {
        fprintf(stderr, "growth: %s\n", setup->error.text);
        exit(3);
    }
    return seconds(CLOCK_MONOTONIC) - start;
}

static void setup_end(struct setup *setup) {
    world_destroy(&setup->world);
    arena_destroy(&setup->arena);
    scene_destroy(&setup->scene);
}

static void finish_row(struct bench *bench, struct setup *setup, const struct bench_scene *view, struct row *row) {
    static struct ray rays[SIDE * SIDE];
    struct world_scratch scratch;
    if (!world_scratch_init(&scratch, &setup->world))
        exit(3);
    camera_rays(view, rays);
    row->camera_ns = trace(&setup->world, rays, SIDE * SIDE, &scratch, row);
    struct box box = box_empty();
    for (uint32_t i = 0; i < setup->world.primitive_count; i++)
        box = box_join(box, setup->world.boxes[i]);
    chords(&box, rays);
    row->chord_ns = trace(&setup->world, rays, SIDE * SIDE, &scratch, NULL);
    world_scratch_destroy(&scratch);
    printf("%-12s %10.0f %10.3f %8.1f %9.1f %9.1f %9.1f %8.1f\n", row->series, row->objects, row->build_seconds,
           row->bytes_each, row->camera_ns, row->chord_ns, row->tests, row->steps);
    fflush(stdout);
    if (bench->count < MAX_ROWS)
        bench->rows[bench->count++] = *row;
}

static void measure_mesh(struct bench *bench, const char *series, const struct bench_scene *scene) {
    struct row row = {.series = series, .objects = scene->triangle_count};
    struct mesh *mesh = mesh_of(scene, 0, scene->triangle_count);
    size_t bare = mesh_memory(mesh);
    struct setup setup;
    setup_begin(&setup);
    (void)setup_add(&setup, setup.root, mesh);
    row.build_seconds = setup_build(&setup, bench->pool);
    row.bytes_each = (double)(mesh_memory(mesh) - bare) / scene->triangle_count;
    finish_row(bench, &setup, scene, &row);
    setup_end(&setup);
    mesh_release(mesh);
}

static void grow_triangles(struct bench *bench) {
    for (int depth = 1; 4 * pow(4, depth) <= bench->max; depth++) {
        struct bench_scene scene = {.name = "sierpinski"};
        bench_sierpinski(&scene, depth);
        measure_mesh(bench, "sierpinski", &scene);
        bench_scene_free(&scene);
    }
    for (double wanted = 10; wanted <= bench->max; wanted *= 10) {
        struct bench_scene scene = {.name = "terrain"};
        bench_terrain(&scene, (int)(sqrt(wanted / 2) + 1.5));
        measure_mesh(bench, "terrain", &scene);
        bench_scene_free(&scene);
    }
}

/* A field of pyramids of 1,024 triangles in rows. */
static void grow_instances(struct bench *bench) {
    struct bench_scene scene = {.name = "sierpinski"};
    bench_sierpinski(&scene, 4);
    struct mesh *mesh = mesh_of(&scene, 0, scene.triangle_count);
    for (double count = 1; count <= bench->max; count *= 10) {
        uint32_t side = (uint32_t)ceil(sqrt(count));
        double(*at)[3] = malloc((size_t)count * sizeof *at);
        if (!at)
            exit(3);
        for (uint32_t i = 0; i < (uint32_t)count; i++) {
            at[i][0] = 1.2 * (i % side) - 0.6 * side;
            at[i][1] = 0;
            at[i][2] = -1.2 * (i / side);
        }
        struct placements placements = {.count = (uint32_t)count, .at = (const double(*)[3])at};
        struct bench_scene view = scene;
        memcpy(view.eye, (float[3]){0, 2, 4}, sizeof view.eye);
        memcpy(view.target, (float[3]){0, 0.9f, 0}, sizeof view.target);
        view.field = 50;
        struct row row = {.series = "instances", .objects = count};
        struct setup setup;
        setup_begin(&setup);
        struct node *many = scene_node(&setup.scene, NODE_GROUP, "many", &setup.error);
        many->placements = &placements;
        (void)setup_add(&setup, many, mesh);
        if (!node_add_child(&setup.scene, setup.root, many, &setup.error))
            exit(3);
        row.build_seconds = setup_build(&setup, bench->pool);
        row.bytes_each =
            (double)(world_primitive_memory(&setup.world) + scene_accel_memory(&setup.world.accel)) / count;
        finish_row(bench, &setup, &view, &row);
        setup_end(&setup);
        free(at);
    }
    mesh_release(mesh);
    bench_scene_free(&scene);
}

/* --- a mesh in a stadium --- */

static int keep_those_that_meet(const struct world *world, struct ray *rays, int count, uint32_t primitive_wanted,
                                uint32_t triangles, struct world_scratch *scratch) {
    int kept = 0;
    for (int i = 0; i < count; i++) {
        uint32_t primitive;
        struct crossing crossing;
        if (world_nearest_crossing(world, &rays[i], scratch, &primitive, &crossing) && primitive == primitive_wanted &&
            crossing.part < triangles)
            rays[kept++] = rays[i];
    }
    return kept;
}

/* Camera rays that meet the mesh: alone, with the stadium as a second mesh, and as one mesh with it. */
static void stadium(struct bench *bench, const char *name, const struct bench_scene *mesh) {
    static struct ray rays[SIDE * SIDE];
    struct bench_scene scene = {.name = "stadium"};
    double ns[3], together[3];
    int count = 0;
    bench_stadium(&scene, mesh);
    uint32_t own = mesh->triangle_count, all = scene.triangle_count;
    struct mesh *single = mesh_of(&scene, 0, own), *stadium = mesh_of(&scene, own, all - own),
                *one = mesh_of(&scene, 0, all);
    struct setup setups[3];
    struct world_scratch scratch[3];
    for (int kind = 0; kind < 3; kind++) {
        setup_begin(&setups[kind]);
        (void)setup_add(&setups[kind], setups[kind].root, kind == 2 ? one : single);
        if (kind == 1)
            (void)setup_add(&setups[kind], setups[kind].root, stadium);
        (void)setup_build(&setups[kind], bench->pool);
        if (!world_scratch_init(&scratch[kind], &setups[kind].world))
            exit(3);
        ns[kind] = together[kind] = INFINITY;
    }
    camera_rays(&scene, rays);
    count = keep_those_that_meet(&setups[0].world, rays, SIDE * SIDE, 0, own, &scratch[0]);
    /* Interleaved, so that all three run under the same conditions. */
    for (int again = 0; again < 30; again++) {
        for (int kind = 0; kind < 3; kind++) {
            ns[kind] = fmin(ns[kind], trace(&setups[kind].world, rays, count, &scratch[kind], NULL));
            together[kind] = fmin(together[kind], trace_together(&setups[kind].world, rays, count, &scratch[kind]));
        }
    }
    for (int kind = 0; kind < 3; kind++) {
        world_scratch_destroy(&scratch[kind]);
        setup_end(&setups[kind]);
    }
    printf("%-15s %8u %6d | %7.1f %7.1f %7.1f %5.2f %5.2f | %7.1f %7.1f %7.1f %5.2f %5.2f\n", name, own, count, ns[0],
           ns[1], ns[2], ns[0] / ns[1], ns[0] / ns[2], together[0], together[1], together[2], together[0] / together[1],
           together[0] / together[2]);
    fflush(stdout);
    mesh_release(single);
    mesh_release(stadium);
    mesh_release(one);
    bench_scene_free(&scene);
}

static void stadiums(struct bench *bench) {
    static const char *const names[] = {"teapot", "stanford-bunny", "nefertiti"};
    printf("\nCamera rays that meet a mesh in a stadium, ns a ray; ratio: alone to in the stadium\n");
    printf("%-15s %8s %6s | %s | %s\n", "mesh", "triangles", "rays", "alone   as two  as one  ratios, single rays",
           "the same in packets");
    struct bench_scene pyramid = {.name = "sierpinski"};
    bench_sierpinski(&pyramid, 7);
    stadium(bench, "sierpinski", &pyramid);
    bench_scene_free(&pyramid);
    for (int i = 0; i < 3 && bench->models; i++) {
        struct bench_scene mesh = {.name = "mesh"};
        char path[4096];
        snprintf(path, sizeof path, "%s/%s.obj", bench->models, names[i]);
        if (bench_load_obj(&mesh, path))
            stadium(bench, names[i], &mesh);
        else
            printf("%-20s left out: %s cannot be read\n", names[i], path);
        bench_scene_free(&mesh);
    }
}

/* --- the plot: both axes by powers of ten --- */

static void draw(const struct bench *bench) {
    enum { WIDTH = 760, HEIGHT = 460, LEFT = 70, TOP = 30, ACROSS = 560, DOWN = 380 };
    static const char *const colours[] = {"#c04040", "#3060c0", "#309050"};
    static const char *const series[] = {"sierpinski", "terrain", "instances"};
    FILE *out = fopen(bench->svg, "w");
    if (!out) {
        fprintf(stderr, "growth: %s cannot be written\n", bench->svg);
        exit(3);
    }
    fprintf(out,
            "<svg xmlns='http://www.w3.org/2000/svg' width='%d' height='%d' font-family='sans-serif' font-size='12'>\n",
            WIDTH, HEIGHT);
    fprintf(out,
            "<rect width='100%%' height='100%%' fill='white'/><text x='%d' y='20'>nanoseconds a ray: camera (line), "
            "chord (dashes)</text>\n",
            LEFT);
    for (int decade = 0; decade <= 7; decade++)
        fprintf(out, "<path d='M%d %dV%d' stroke='#ddd'/><text x='%d' y='%d' text-anchor='middle'>10^%d</text>\n",
                LEFT + decade * ACROSS / 7, TOP, TOP + DOWN, LEFT + decade * ACROSS / 7, TOP + DOWN + 18, decade);
    for (int decade = 1; decade <= 4; decade++)
        fprintf(out, "<path d='M%d %dH%d' stroke='#ddd'/><text x='%d' y='%d' text-anchor='end'>10^%d</text>\n", LEFT,
                TOP + DOWN - (decade - 1) * DOWN / 3, LEFT + ACROSS, LEFT - 8, TOP + DOWN - (decade - 1) * DOWN / 3 + 4,
                decade);
    for (int s = 0; s < 3; s++) {
        fprintf(out, "<text x='%d' y='%d' fill='%s'>%s</text>\n", LEFT + ACROSS + 15, TOP + 20 + 18 * s, colours[s],
                series[s]);
        for (int kind = 0; kind < 2; kind++) {
            fprintf(out, "<path fill='none' stroke='%s' stroke-width='2'%s d='", colours[s],
                    kind ? " stroke-dasharray='5 4'" : "");
            char move = 'M';
            for (int i = 0; i < bench->count; i++) {
                const struct row *row = &bench->rows[i];
                if (strcmp(row->series, series[s]) != 0)
                    continue;
                double x = LEFT + log10(row->objects) * ACROSS / 7;
                double y = TOP + DOWN - (log10(kind ? row->chord_ns : row->camera_ns) - 1) * DOWN / 3;
                fprintf(out, "%c%.1f %.1f", move, x, y);
                move = 'L';
            }
            fprintf(out, "'/>\n");
        }
    }
    fprintf(out, "</svg>\n");
    fclose(out);
}

int main(int argc, char **argv) {
    struct bench bench = {.max = 1e7, .threads = 0};
    bool triangles = false, instances = false, in_stadium = false;
    for (int i = 1; i < argc; i++) {
        const char *word = argv[i], *value = i + 1 < argc ? argv[i + 1] : NULL;
        if (strcmp(word, "triangles") == 0) {
            triangles = true;
        } else if (strcmp(word, "instances") == 0) {
            instances = true;
        } else if (strcmp(word, "stadium") == 0) {
            in_stadium = true;
        } else if (value && strcmp(word, "--most") == 0) {
            bench.max = atof(argv[++i]);
        } else if (value && strcmp(word, "--threads") == 0) {
            bench.threads = atoi(argv[++i]);
        } else if (value && strcmp(word, "--models") == 0) {
            bench.models = argv[++i];
        } else if (value && strcmp(word, "--svg") == 0) {
            bench.svg = argv[++i];
        } else {
            fprintf(stderr, "usage: growth [--most N] [--threads N] [--models FOLDER] [--svg FILE] "
                            "[triangles] [instances] [stadium]\n");
            return 2;
        }
    }
    char warning[256];
    bool all = !triangles && !instances && !in_stadium;
    bench.pool = pool_create(bench.threads, warning);
    if (!bench.pool)
        return 3;
    if (all || triangles || instances)
        printf("%-12s %10s %10s %8s %9s %9s %9s %8s\n", "", "things", "build s", "bytes", "camera ns", "chord ns",
               "tests", "steps");
    if (all || triangles)
        grow_triangles(&bench);
    if (all || instances)
        grow_instances(&bench);
    if (all || in_stadium)
        stadiums(&bench);
    if (bench.svg)
        draw(&bench);
    pool_destroy(bench.pool);
    return 0;
}
