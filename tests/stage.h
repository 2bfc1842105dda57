/* A scene, a world and a render without Lua or files, for tests of colours before they are rounded to bytes. */
#ifndef GRAY_TESTS_STAGE_H
#define GRAY_TESTS_STAGE_H

#include "render/integrator.h"
#include "render/render.h"
#include "world/world.h"

struct stage {
    struct assets assets;
    struct scene scene;
    struct pool *pool;
    struct arena arena;
    struct world world;
    struct error error;
    int warnings;
    struct node *root;
    struct light lights[20];
    struct scene_light authored[20]; /* what there is to say of them beside the light itself */
    uint32_t light_count;
    struct sky sky;
    struct colour ambient;
    const struct fog *fog;
    const struct medium *medium; /* around all solids, in the place of a fog */
    struct settings settings;
    struct camera camera;
    struct render_statistics statistics;
    struct film film; /* of the last stage_render */
};

/* What a film keeps of a pixel with this integrator and default settings. */
static inline struct film_record stage_record(enum integrator_kind integrator) {
    struct settings settings = settings_default();
    settings.integrator = integrator;
    return render_record(&settings);
}
/* An empty root, no lights, black sky, ambient 0, camera at (0,0,10) looking at -z, fov 50, default settings except
 * that no ray is cut off and radiosity has few patches. */
void stage_begin(struct stage *s, int threads);
void stage_end(struct stage *s);
/* Begins with a white floor at y = 0 (normal +y), one light that the caller fills in, one sample per pixel. */
void stage_floor(struct stage *s);
/* The mean square error of a pixel whose value should be 1/2, over 64 seeds: with 8 x 8 samples each, or as the mean of
 * 64 pictures with one sample. */
double stage_variance_about_half(struct stage *s, bool single);
/* The lights as a world is built from. */
const struct scene_light *stage_lights(struct stage *s);
bool stage_build(struct stage *s, struct node *root, enum accel_kind accel);
/* Builds the world of s->root and renders; the film lives until the next render or the end. Failures fail the test. */
bool stage_render(struct stage *s, uint32_t width, uint32_t height);
/* The job that stage_render renders, for other queries; borrows the stage's world and film. */
struct render_job stage_job(struct stage *s, uint32_t width, uint32_t height);
struct colour stage_pixel(const struct stage *s, uint32_t x, uint32_t y);

struct material *stage_phong(struct stage *s, struct colour kd, struct colour ks, double shininess);
struct material *stage_glass(struct stage *s, double reflect, double refract, double ior);
/* Invisible, with the medium inside. */
struct material *stage_filling(struct stage *s, const struct medium *medium);
struct node *stage_group(struct stage *s, struct node *parent);
struct node *stage_sphere(struct stage *s, struct node *parent, const struct material *material);
struct node *stage_cube(struct stage *s, struct node *parent, const struct material *material);
void stage_move(struct stage *s, struct node *node, double x, double y, double z);
/* So many intersections of two balls, which cover each other for a camera at +z. */
void stage_lenses(struct stage *s, const struct material *material, int count);
void stage_scale(struct stage *s, struct node *node, double x, double y, double z);
void stage_rotate(struct stage *s, struct node *node, int axis, double degrees);
void stage_point_light(struct stage *s, struct vec3 position, struct colour colour);

#endif
