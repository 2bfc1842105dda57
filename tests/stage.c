/* See stage.h. */
#include "tests/stage.h"

#include "film/aov.h"
#include "render/integrator.h"
#include "tests/harness.h"

#include <stdlib.h>
#include <string.h>

static void count_warning(void *context, const char *text) {
    (void)text;
    ((struct stage *)context)->warnings++;
}

void stage_begin(struct stage *s, int threads) {
    char warning[256];
    memset(s, 0, sizeof *s);
    scene_init(&s->scene, &s->assets);
    s->pool = pool_create(threads, warning);
    s->root = scene_node(&s->scene, NODE_GROUP, "root", &s->error);
    s->sky = (struct sky){.kind = SKY_CONSTANT};
    s->settings = settings_default();
    s->settings.cutoff = 0;
    s->settings.radiosity_patches = 500;
    s->camera = (struct camera){{0, 0, 10}, {0, 0, -1}, {0, 1, 0}, 50};
}

void stage_end(struct stage *s) {
    free(s->film.pixels);
    world_destroy(&s->world);
    arena_destroy(&s->arena);
    scene_destroy(&s->scene);
    assets_destroy(&s->assets);
    pool_destroy(s->pool);
}

void stage_floor(struct stage *s) {
    stage_begin(s, 1);
    struct node *node = stage_cube(s, s->root, stage_phong(s, colour_all(1), colour_all(0), 1));
    stage_move(s, node, -0.5, -1, -0.5);
    stage_scale(s, node, 40, 1, 40);
    s->settings.full = true;
    s->settings.samples = 1;
    s->light_count = 1;
}

double stage_variance_about_half(struct stage *s, bool single) {
    double error = 0;
    for (uint64_t seed = 0; seed < 64; seed++) {
        double mean = 0;
        for (uint64_t i = 0; i < (single ? 64 : 1); i++) {
            s->settings.seed = single ? 1000 + seed * 64 + i : seed;
            s->settings.samples = single ? 1 : 8;
            CHECK(stage_render(s, 1, 1));
            mean += stage_pixel(s, 0, 0).r / (single ? 64 : 1);
        }
        error += (mean - 0.5) * (mean - 0.5);
    }
    return error / 64;
}

const struct scene_light *stage_lights(struct stage *s) {
    for (uint32_t i = 0; i < s->light_count; i++)
        s->authored[i].light = s->lights[i];
    return s->authored;
}

bool stage_build(struct stage *s, struct node *root, enum accel_kind accel) {
    world_destroy(&s->world);
    arena_reset(&s->arena);
    const struct medium outside = s->medium ? *s->medium : medium_outside(s->fog);
    const struct world_input input = {.scene = &s->scene,
                                      .root = root,
                                      .lights = stage_lights(s),
                                      .light_count = s->light_count,
                                      .sky = &s->sky,
                                      .outside = &outside,
                                      .shutter = s->settings.shutter,
                                      .accel = accel,
                                      .warn = count_warning,
                                      .warn_context = s,
                                      .linear_colours = settings_linear(&s->settings)};
    return world_build(&s->world, &input, &s->arena, s->pool, &s->error);
}

struct render_job stage_job(struct stage *s, uint32_t width, uint32_t height) {
    return (struct render_job){.world = &s->world,
                               .camera = s->camera,
                               .settings = s->settings,
                               .width = width,
                               .height = height,
                               .ambient = s->ambient,
                               .background_lights = true,
                               .film = &s->film};
}

bool stage_render(struct stage *s, uint32_t width, uint32_t height) {
    struct render_job job = stage_job(s, width, height);
    char warning[256];
    size_t bytes;
    struct render_area area;
    bool ok = stage_build(s, s->root, s->settings.accel) && render_prepare(&job, &area, warning, &s->error) &&
              film_size_layered(area.width, area.height, render_record(&s->settings), aov_layers(s->settings.aov),
                                &bytes, &s->error);
    if (ok) {
        free(s->film.pixels);
        film_layout(&s->film, calloc(1, bytes), area.width, area.height, render_record(&s->settings));
        film_layout_layers(&s->film, s->film.pixels, s->settings.aov);
        s->film.x0 = area.x0;
        s->film.y0 = area.y0;
        s->film.full_width = width;
        s->film.full_height = height;
        ok = render_run(&job, s->pool, &s->statistics, &s->error);
    }
    if (!ok)
        test_fail(__FILE__, __LINE__, "render: %s", s->error.text);
    return ok;
}

struct colour stage_pixel(const struct stage *s, uint32_t x, uint32_t y) {
    const float *rgb = s->film.pixels[(size_t)y * s->film.width + x].rgb;
    return colour_make((double)rgb[0], (double)rgb[1], (double)rgb[2]);
}

struct material *stage_phong(struct stage *s, struct colour kd, struct colour ks, double shininess) {
    struct material *material = scene_material(&s->scene, MATERIAL_PHONG, NULL, &s->error);
    material->phong.kd = kd;
    material->phong.ks = ks;
    material->phong.shininess = shininess;
    material->phong.ior = 1;
    return material;
}

struct material *stage_filling(struct stage *s, const struct medium *medium) {
    static struct texture hole;
    hole = texture_number(0);
    struct material *material = stage_phong(s, colour_all(0), colour_all(0), 1);
    material->medium = medium;
    material->inputs[INPUT_OPACITY] = &hole;
    return material;
}

struct material *stage_glass(struct stage *s, double reflect, double refract, double ior) {
    struct material *material = stage_phong(s, colour_all(0), colour_all(1), 1);
    material->phong.reflect = reflect;
    material->phong.refract = refract;
    material->phong.ior = ior;
    material->phong.has_ior = true;
    return material;
}

static struct node *add(struct stage *s, struct node *parent, enum node_kind kind, const char *name) {
    struct node *node = scene_node(&s->scene, kind, name, &s->error);
    CHECK(node_add_child(&s->scene, parent, node, &s->error));
    return node;
}

struct node *stage_group(struct stage *s, struct node *parent) {
    return add(s, parent, NODE_GROUP, "group");
}

struct node *stage_sphere(struct stage *s, struct node *parent, const struct material *material) {
    struct node *node = add(s, parent, NODE_GEOMETRY, "sphere");
    node->shape = (struct shape){.kind = SHAPE_SPHERE, .sphere = {{0, 0, 0}, 1}};
    node->material = material;
    return node;
}

struct node *stage_cube(struct stage *s, struct node *parent, const struct material *material) {
    struct node *node = add(s, parent, NODE_GEOMETRY, "cube");
    node->shape = (struct shape){.kind = SHAPE_BOX, .box = {{0, 0, 0}, {1, 1, 1}}};
    node->material = material;
    return node;
}

void stage_move(struct stage *s, struct node *node, double x, double y, double z) {
    struct transform t = transform_translate(vec3_make(x, y, z));
    CHECK(node_transform(&s->scene, node, NODE_TRANSLATE, &t));
}

void stage_scale(struct stage *s, struct node *node, double x, double y, double z) {
    struct transform t = transform_scale(vec3_make(x, y, z));
    CHECK(node_transform(&s->scene, node, NODE_SCALE, &t));
}

void stage_rotate(struct stage *s, struct node *node, int axis, double degrees) {
    struct transform t = transform_rotate(axis, degrees);
    CHECK(node_transform(&s->scene, node, NODE_ROTATE, &t));
}

void stage_point_light(struct stage *s, struct vec3 position, struct colour colour) {
    s->lights[s->light_count++] =
        (struct light){.kind = LIGHT_POINT, .position = position, .colour = colour, .falloff = {1, 0, 0}};
}

void stage_lenses(struct stage *s, const struct material *material, int count) {
    struct node *group = scene_node(&s->scene, NODE_GROUP, "operands", &s->error);
    for (int i = 0; i < count; i++) {
        struct node *balls[2] = {stage_sphere(s, group, material), stage_sphere(s, group, material)};
        stage_move(s, balls[0], -1.5, 0.3 * i, -0.4 * i);
        stage_move(s, balls[1], -1.1, 0.3 * i, 0.3 - 0.4 * i);
        struct node *lens = scene_combine(&s->scene, "lens", NODE_INTERSECTION, balls, 2, &s->error);
        CHECK(lens && node_add_child(&s->scene, s->root, lens, &s->error));
    }
}
