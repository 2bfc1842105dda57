/* What previews show of radiosity: the stored light, and form factors to a patch. */
#include "base/random.h"
#include "math/elementary.h"
#include "math/frame.h"
#include "radiosity/radiosity.h"
#include "render/camera.h"
#include "render/headlight.h"
#include "render/overlay.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <math.h>
#include <string.h>

enum { SIZE = 40 };
static const double pi = 3.14159265358979323846;

static void add_planar(struct stage *s, struct vec3 corner, struct vec3 along, struct vec3 up, struct colour kd) {
    struct node *node = stage_cube(s, s->root, stage_phong(s, kd, colour_all(0), 1));
    node->shape = (struct shape){.kind = SHAPE_PLANAR, .planar = planar_parallelogram(corner, along, up)};
}

/* A floor, a wall to the left and a ball above the floor, in the light of a lamp. job: its picture, for views. */
static void begin(struct stage *s, struct radiosity *radiosity, struct render_job *job) {
    stage_begin(s, 2);
    add_planar(s, vec3_make(-2, -1, 2), vec3_make(4, 0, 0), vec3_make(0, 0, -4), colour_make(0.8, 0.6, 0.4));
    add_planar(s, vec3_make(-2, -1, 2), vec3_make(0, 0, -4), vec3_make(0, 3, 0), colour_make(0.3, 0.7, 0.5));
    (void)stage_sphere(s, s->root, stage_phong(s, colour_all(0.7), colour_all(0), 1));
    stage_point_light(s, vec3_make(1, 3, 2), colour_all(1));
    s->camera.fov = 30;
    s->settings.integrator = INTEGRATOR_RADIOSITY;
    s->settings.radiosity_patches = 3000;
    s->settings.samples = 1;
    CHECK(stage_render(s, SIZE, SIZE));
    *job = stage_job(s, SIZE, SIZE);
    job->film = &s->film;
    job->radiosity = radiosity;
}

static void end(struct stage *s, struct radiosity *radiosity) {
    radiosity_destroy(radiosity);
    stage_end(s);
}

static void show(struct stage *s, const struct render_job *job, const struct headlight_request *request) {
    struct render_statistics statistics = {0};
    for (uint32_t i = 0; i < film_tile_count(&s->film); i++)
        atomic_store(&s->film.tiles[i], FILM_TILE_WANTED);
    CHECK(render_headlight(job, request, s->pool, &statistics, &s->error));
}

TEST(preview_of_radiosity_is_its_picture_where_nothing_shines) {
    struct stage s;
    struct radiosity radiosity = {0};
    struct render_job job;
    struct render_statistics statistics = {0};
    static struct film_pixel picture[SIZE * SIZE];
    begin(&s, &radiosity, &job);
    for (uint32_t i = 0; i < film_tile_count(&s.film); i++)
        atomic_store(&s.film.tiles[i], FILM_TILE_WANTED);
    CHECK(render_run(&job, s.pool, &statistics, &s.error));
    memcpy(picture, s.film.pixels, sizeof picture);
    show(&s, &job, &(struct headlight_request){.state = FILM_TILE_DONE});
    for (int i = 0; i < SIZE * SIZE; i++)
        for (int c = 0; c < 3; c++)
            CHECK_NEAR((double)s.film.pixels[i].rgb[c], (double)picture[i].rgb[c], 1e-6);
    /* A solution of another world is not shown. */
    radiosity.patches.world = NULL;
    show(&s, &job, &(struct headlight_request){.state = FILM_TILE_DONE});
    CHECK(memcmp(picture, s.film.pixels, sizeof picture) != 0);
    end(&s, &radiosity);
}

/* The form factor of a colour from blue (2^-16) over green to red (1); black: 0. */
static double factor_of(const float rgb[3]) {
    double t = rgb[0] > 0 ? (1 + (double)rgb[0]) / 2 : (1 - (double)rgb[2]) / 2;
    return rgb[0] + rgb[1] + rgb[2] > 0 ? el_exp2(16 * (t - 1)) : 0;
}

/* The share of rays from the surface, by the cosine, that meet the patch. */
static double brute_factor(const struct stage *s, const struct radiosity *radiosity, uint32_t patch,
                           const struct hit *hit, struct world_scratch *scratch) {
    enum { SIDE = 100 };
    uint32_t met = 0, found;
    struct vec3 normal = hit->front ? hit->normal : vec3_negate(hit->normal), a, b;
    frame_tangents(normal, &a, &b);
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        double u = (i % SIDE + random_unit(random_combine(1, i))) / SIDE,
               v = 2 * pi * (i / SIDE + random_unit(random_combine(2, i))) / SIDE, r = sqrt(u);
        struct vec3 d = vec3_add_scaled(vec3_scale(normal, sqrt(1 - u)), a, r * el_cos(v));
        struct ray from = {.direction = vec3_negate(hit->view)}, ray;
        struct hit next;
        double shares[3];
        d = vec3_add_scaled(d, b, r * el_sin(v));
        ray = hit_ray(hit, &from, d, NULL);
        met += world_nearest(&s->world, &ray, scratch, &next) &&
               patches_find(&radiosity->patches, &next, &found, shares) && found == patch;
    }
    return (double)met / (SIDE * SIDE);
}

TEST(form_factors_in_a_preview_are_shares_of_rays_that_meet_the_patch) {
    struct stage s;
    struct radiosity radiosity = {0};
    struct render_job job;
    struct render_statistics statistics = {0};
    struct camera_frame frame;
    struct world_scratch scratch;
    char warning[256];
    begin(&s, &radiosity, &job);
    job.settings.radiosity_patches = s.settings.radiosity_patches = 200; /* large ones */
    for (uint32_t i = 0; i < film_tile_count(&s.film); i++)
        atomic_store(&s.film.tiles[i], FILM_TILE_WANTED);
    CHECK(render_run(&job, s.pool, &statistics, &s.error));
    CHECK(camera_prepare(&job.camera, &job.settings, (struct picture_size){SIZE, SIZE}, &frame, warning, &s.error));
    CHECK(world_scratch_init(&scratch, &s.world));
    double sum = 0, brute_sum = 0;
    for (uint32_t patch = 0; patch < radiosity.patches.all.count; patch += 7) {
        show(&s, &job, &(struct headlight_request){HEADLIGHT_FACTORS, false, FILM_TILE_DONE, patch});
        for (uint32_t pixel = 5; pixel < SIZE * SIZE; pixel += 97) {
            struct ray ray;
            struct hit hit;
            uint32_t own;
            double shares[3], factor = factor_of(s.film.pixels[pixel].rgb);
            if (!camera_ray_through(&frame, pixel % SIZE + 0.5, (uint32_t)(pixel / SIZE) + 0.5,
                                    (struct sample2){0.5, 0.5}, NULL, &ray) ||
                !world_nearest(&s.world, &ray, &scratch, &hit) ||
                (patches_find(&radiosity.patches, &hit, &own, shares) && own == patch))
                continue;
            double brute = brute_factor(&s, &radiosity, patch, &hit, &scratch);
            CHECK_NEAR(factor, brute, 0.3 * brute + 3e-3); /* a quarter of a patch is visible or not */
            sum += factor;
            brute_sum += brute;
        }
    }
    CHECK(brute_sum > 0.1);
    CHECK_NEAR(sum, brute_sum, 0.05 * brute_sum);
    world_scratch_destroy(&scratch);
    end(&s, &radiosity);
}

TEST(patches_over_a_picture_have_lines_through_all_their_corners_that_are_seen) {
    struct stage s;
    struct radiosity radiosity = {0};
    struct render_job job;
    struct render_statistics statistics = {0};
    struct camera_frame frame;
    char warning[256];
    static float lines[SIZE * SIZE][4];
    const struct overlay_request request = {OVERLAY_OF_PATCHES, OVERLAY_BOXES, 1};
    begin(&s, &radiosity, &job);
    CHECK(overlay_lines(&job, s.pool, &request, lines, &s.error));
    for (int i = 0; i < SIZE * SIZE; i++)
        CHECK(lines[i][3] >= 1); /* nothing is solved yet */
    for (uint32_t i = 0; i < film_tile_count(&s.film); i++)
        atomic_store(&s.film.tiles[i], FILM_TILE_WANTED);
    CHECK(render_run(&job, s.pool, &statistics, &s.error) && overlay_lines(&job, s.pool, &request, lines, &s.error));
    CHECK(camera_prepare(&job.camera, &job.settings, (struct picture_size){SIZE, SIZE}, &frame, warning, &s.error));
    int seen = 0;
    for (uint32_t i = 0; i < radiosity.patches.vertices.count; i++) {
        double x, y;
        if (!camera_project(&frame, patch_vertex_at(&radiosity.patches, i)->point, &x, &y) ||
            !(x >= 1 && x < SIZE - 1 && y >= 1 && y < SIZE - 1))
            continue;
        CHECK(lines[(size_t)y * SIZE + (size_t)x][3] < 1);
        seen++;
    }
    CHECK(seen > 100);
    end(&s, &radiosity);
}

TEST(patches_without_radiosity_are_refused_with_one_line) {
    test_write_text(test_path("scene.lua"),
                    "gr.render{node = gr.sphere{}, file = 'a.png', width = 8, height = 8, eye = {0, 0, 5}, "
                    "background = {1, 1, 1}}\n");
    test_shell_errors("$gray -q scene.lua --overlay patches", 2,
                      "--overlay patches shows those of --integrator radiosity");
    test_shell_errors("$gray -q scene.lua --overlay patches --integrator radiosity", 0, NULL);
}
