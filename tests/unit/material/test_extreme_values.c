/* Numbers at the ends of their range. Every numeric argument of every gr function takes each value of a list of
 * extremes, the scene is rendered with all layers, and the result is one line or a finite picture. */
#include "base/mem.h"
#include "film/aov.h"
#include "film/tile_file.h"
#include "formats/json_text.h"
#include "formats/model.h"
#include "image/exr.h"
#include "render/render.h"
#include "tests/stage.h"
#include "tests/unit/call_makers.h"
#include "tests/unit/script_host.h"
#include "world/world.h"

#include <float.h>
#include <signal.h>
#include <sys/time.h>

enum { SIDE = 6, TEXT_SIZE = 8192 };

/* A summary of a script's pictures. */
struct gallery {
    struct pool *pool;
    struct assets assets;
    int pictures;
    int max; /* numbers of an argument that are tried one by one */
    bool is_long;
    bool finite, clamped;
    char first[160]; /* the position of the first number that is not finite */
};

static _Atomic int out_of_time;

static void ring(int number) {
    (void)number;
    out_of_time = 1;
}

static void set_clock(int milliseconds) {
    struct itimerval timer = {.it_value = {milliseconds / 1000, milliseconds % 1000 * 1000}};
    (void)signal(SIGVTALRM, ring);
    out_of_time = 0;
    CHECK(setitimer(ITIMER_VIRTUAL, &timer, NULL) == 0);
}

static void note(struct gallery *gallery, const char *what, uint32_t x, uint32_t y, const float *rgb) {
    if (gallery->finite)
        (void)snprintf(gallery->first, sizeof gallery->first, "%s at %u %u is %g %g %g", what, x, y, (double)rgb[0],
                       (double)rgb[1], (double)rgb[2]);
    gallery->finite = false;
}

static bool all_finite(const float *rgb) {
    return isfinite(rgb[0]) && isfinite(rgb[1]) && isfinite(rgb[2]);
}

static void point_at(struct gallery *gallery, const struct film *film) {
    size_t count = (size_t)film->width * film->height;
    for (size_t i = 0; i < count; i++) {
        uint32_t x = (uint32_t)i % film->width, y = (uint32_t)i / film->width;
        if (!all_finite(film->pixels[i].rgb))
            note(gallery, "the picture", x, y, film->pixels[i].rgb);
        if (!all_finite(&film->floats[3 * i]))
            note(gallery, "the first pass", x, y, &film->floats[3 * i]);
        for (int aov = 0; aov < AOV_COUNT; aov++) {
            if (film->layer_mask >> aov & 1 &&
                !all_finite(film->layers[aov_layer(film->layer_mask, (enum aov)aov) * count + i]))
                note(gallery, aov_name((enum aov)aov), x, y,
                     film->layers[aov_layer(film->layer_mask, (enum aov)aov) * count + i]);
        }
    }
}

static void hear(void *context, enum script_message kind, const char *text) {
    (void)context, (void)kind, (void)text;
}

static void hear_of_scene(void *context, const char *text) {
    (void)context, (void)text;
}

static bool is_stopped(void *context) {
    (void)context;
    return out_of_time != 0;
}

static bool render_small(void *context, const struct render_request *request, struct error *error) {
    struct gallery *gallery = context;
    struct world world = {0};
    struct arena arena = {0};
    struct film film = {0};
    struct render_statistics statistics = {0};
    struct render_job job = {.world = &world,
                             .camera = request->camera,
                             .settings = request->settings,
                             .width = SIDE,
                             .height = SIDE,
                             .ambient = request->ambient,
                             .film = &film};
    char warning[256];
    struct render_area area;
    size_t bytes;
    job.settings.aov = AOV_ALL;
    job.settings.keep_first = true;
    job.settings.samples = 2;
    job.settings.area_samples = 2;
    job.settings.reflect_limit = job.settings.refract_limit = 3;
    if (job.settings.caustics.photons > 200)
        job.settings.caustics.photons = 200;
    gallery->pictures++;
    if (!render_prepare(&job, &area, warning, error) ||
        !film_size_layered(SIDE, SIDE, render_record(&job.settings), aov_layers(AOV_ALL), &bytes, error))
        return false;
    void *block = mem_alloc_zero(1, bytes);
    film_layout(&film, block, SIDE, SIDE, render_record(&job.settings));
    film_layout_layers(&film, block, AOV_ALL);
    film.full_width = film.full_height = SIDE;
    const struct world_input input = {.scene = request->scene,
                                      .root = request->root,
                                      .lights = request->lights,
                                      .light_count = request->light_count,
                                      .sky = &request->sky,
                                      .outside = &request->outside,
                                      .shutter = job.settings.shutter,
                                      .accel = job.settings.accel,
                                      .warn = hear_of_scene};
    bool ok = world_build(&world, &input, &arena, gallery->pool, error) &&
              render_run(&job, gallery->pool, &statistics, error);
    if (ok)
        point_at(gallery, &film);
    gallery->clamped = gallery->clamped || statistics.clamped > 0;
    mem_free(block);
    world_destroy(&world);
    arena_destroy(&arena);
    pool_reset_cancel(gallery->pool);
    return ok;
}

/* False: refused. */
static bool run_text(struct gallery *gallery, const char *text, struct error *error) {
    const struct script_options options = {.transform_order = SCRIPT_ORDER_NEW, .library_folder = "lua"};
    const struct script_host host = {.context = gallery,
                                     .assets = &gallery->assets,
                                     .settings = settings_default(),
                                     .render = render_small,
                                     .message = hear,
                                     .cancelled = is_stopped};
    struct arena arena = {0};
    const char *traceback = NULL;
    const char *path = test_path("scene.lua");
    (void)remove(path); /* as in listen_to_text */
    test_write_text(path, text);
    gallery->pictures = 0;
    gallery->finite = true;
    gallery->clamped = false;
    *error = (struct error){0};
    set_clock(3000 * (int)test_slowness());
    bool done = script_run(path, &options, &host, &arena, &traceback, error);
    set_clock(0);
    arena_destroy(&arena);
    return done;
}

static void open_gallery(struct gallery *gallery) {
    char warning[256];
    *gallery = (struct gallery){.pool = pool_create(1, warning)};
    CHECK(gallery->pool != NULL);
    pool_watch(gallery->pool, &out_of_time);
    write_files();
}

static void close_gallery(struct gallery *gallery) {
    pool_destroy(gallery->pool);
    assets_destroy(&gallery->assets);
}

/* The scene around the tested call. */
static const char preparation[] =
    "white = gr.material({0.8, 0.8, 0.8}, {0.5, 0.5, 0.5}, 20)\n"
    "glass = gr.rr_material({0.5, 0.5, 0.5}, {1, 1, 1}, 10, 0.5, 0.5, 1.5)\n"
    "sheet = gr.mesh(glass, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}})\n"
    "ball = gr.sphere('ball') ball:set_material(glass)\n"
    "root = gr.node('root')\n"
    "floor = gr.plane{name = 'floor', normal = {0, 1, 0}, distance = -1.5, material = white} root:add_child(floor)\n"
    "mirror = gr.sphere{name = 'mirror', centre = {2, 0, -2}, material = gr.material{kd = {0.1, 0.1, 0.1}, ks = {1, 1, "
    "1}, reflect = 0.9}} root:add_child(mirror)\n"
    "lamp = gr.light({4, 5, 6}, {1, 1, 1}, {1, 0, 0}); mist = gr.uniform_fog{density = 0.1}; "
    "smoke = gr.medium{scattering = {1, 2, 3}}\n"
    "function show(t) t.file = 'x.png' t.width = 6 t.height = 6 t.eye = t.eye or {0, 1, 7} t.node = t.node or root\n"
    "if not t.view then t.target = t.target or {0, 0, 0} end t.lights = t.lights or {lamp} gr.render(t) end\n";

/* The use of the call's result, X. */
static const char *use_of(const struct script_function *function) {
    switch (function->result) {
    case RESULT_NODE:
        return "root:add_child(X) show{caustics = 50}";
    case RESULT_MATERIAL:
        return "ball:set_material(X) root:add_child(ball) c = gr.cube('c') c:set_material(X) root:add_child(c) "
               "floor:set_material(X) show{caustics = 50}";
    case RESULT_LIGHT:
        return "root:add_child(ball) show{lights = {X}}";
    case RESULT_TEXTURE:
        return strcmp(function->name, "bump") == 0
                   ? "ball:set_bump(X) floor:set_bump(X) root:add_child(ball) show{}"
                   : "ball:set_texture(X) floor:set_texture(X) root:add_child(ball) show{}";
    case RESULT_FOG:
        return "root:add_child(ball) show{fog = X}";
    case RESULT_MEDIUM:
        return "root:add_child(ball) show{medium = X, integrator = 'path'}";
    case RESULT_SKY:
        return "root:add_child(ball) show{background = X, lights = {gr.sky_light{sky = X}}}";
    case RESULT_SELF:
    case RESULT_NOTHING:
    case RESULT_BOUNDS:
    case RESULT_FACES:
    case RESULT_GLYPHS:
    case RESULT_FRAMES:
        break;
    }
    return strstr(function->name, "render") ? "" : "root:add_child(ball) show{} show{}";
}

static bool is_numeric(enum argument_kind kind) {
    switch (kind) {
    case KIND_NUMBER:
    case KIND_WHOLE:
    case KIND_POINT:
    case KIND_DIRECTION:
    case KIND_COLOUR:
    case KIND_TRIPLE:
    case KIND_SIZE:
    case KIND_INTERVAL:
    case KIND_QUATERNION:
    case KIND_PAIR:
    case KIND_BACKGROUND:
    case KIND_CAUSTICS:
    case KIND_POINTS:
    case KIND_PAIRS:
    case KIND_STOPS:
    case KIND_NUMBERS:
    case KIND_ROWS:
    case KIND_CURVES:
        return true;
    case KIND_BOOLEAN:
    case KIND_TEXT:
    case KIND_FILE:
    case KIND_OUTPUT:
    case KIND_CHOICE:
    case KIND_AXIS:
    case KIND_NODE:
    case KIND_MATERIAL:
    case KIND_MATERIALS:
    case KIND_IMAGE:
    case KIND_FOG:
    case KIND_MEDIUM:
    case KIND_NODES:
    case KIND_LIGHTS:
    case KIND_FACES:
    case KIND_FUNCTION:
    case KIND_CALLBACK:
    case KIND_COUNT:
        break;
    }
    return false;
}

static bool begins_number(const char *at) {
    return (*at >= '0' && *at <= '9') || (*at == '-' && at[1] >= '0' && at[1] <= '9');
}

/* `text` with its number `which` (from 0), or with `which` = -1 all of them, replaced; false: there are fewer. */
static bool replace_number(const char *text, int which, const char *with, char *out, size_t size) {
    int number = 0;
    bool replaced = false;
    size_t used = 0;
    out[0] = '\0';
    for (const char *at = text; *at && used + 64 < size;) {
        size_t length = begins_number(at) ? strspn(at, "0123456789.-") : 1;
        bool here = begins_number(at) && (which < 0 || number == which);
        number += begins_number(at);
        used +=
            (size_t)snprintf(out + used, size - used, "%.*s", here ? (int)strlen(with) : (int)length, here ? with : at);
        replaced = replaced || here;
        at += length;
    }
    return replaced;
}

/* Values that have an effect only together with others; V stands for the value. */
static const char *const combinations[] = {
    "root:add_child(ball) show{aperture = 0.1, focus = V}",
    "root:add_child(ball) show{aperture = V}",
    "root:add_child(ball) show{aperture = 0.1, focus_point = {V, V, V}}",
    "root:add_child(ball) show{aperture = 0.1, focus_point = {0, 0, V}}",
    "root:add_child(ball) show{aperture = V, focus = V}",
    "root:add_child(ball) show{aperture = 0.1, blades = 5, blade_angle = V}",
    "root:add_child(ball) show{stereo = 'side', eye_distance = V}",
    "root:add_child(ball) show{stereo = 'side', screen = V}",
    "root:add_child(ball) show{stereo = 'anaglyph', screen = V, eye_distance = V}",
    "root:add_child(ball) show{stereo = 'anaglyph', focus = V}",
    "root:add_child(ball) show{projection = 'orthographic', view_height = V}",
    "root:add_child(ball) show{projection = 'orthographic', shift_x = V, shift_y = V}",
    "root:add_child(ball) show{projection = 'orthographic', view_height = V, shift_x = V, aperture = V, focus = V}",
    "root:add_child(ball) show{projection = 'fisheye', shift_x = V, angle = 90}",
    "root:add_child(ball) show{projection = 'fisheye', angle = V}",
    "root:add_child(ball) show{projection = 'panorama', shift_x = V, shift_y = V}",
    "root:add_child(ball) show{shift_x = V, shift_y = V}",
    "root:add_child(ball) show{fov = V}",
    "root:add_child(ball) show{fov = 179.99999999, shift_x = V}",
    "root:add_child(ball) show{eye = {V, V, V}}",
    "root:add_child(ball) show{eye = {V, 0, 0}, target = {V, 0, 1}}",
    "root:add_child(ball) show{eye = {0, V, 0}, target = {0, 0, 0}, up = {0, V, V}}",
    "root:add_child(ball) show{view = {V, V, V}, up = {V, -1, V}}",
    "root:add_child(ball) show{target = {V, V, V}}",
    "root:add_child(ball) show{eye_to = {V, V, V}}",
    "root:add_child(ball) show{eye_to = {V, V, V}, target_to = {V, V, 0}, up_to = {V, V, 1}}",
    "root:add_child(ball) show{view = {0, 0, -1}, view_to = {V, V, V}}",
    "root:add_child(ball) ball:velocity(V, V, V) show{shutter = {0, V}}",
    "root:add_child(ball) ball:velocity(1, 0, 0) show{shutter = {V, V}}",
    "root:add_child(ball) ball:velocity(V, 0, 0) show{shutter = {0, 1}}",
    "b = gr.sphere('b') b:scale(V, V, V) b:translate(V, V, V) ball:moves_to(b) root:add_child(ball) show{}",
    "b = gr.sphere('b') b:rotate('x', V) b:scale(V, 1, 1) ball:moves_to(b) root:add_child(ball) show{shutter = {0, 1}}",
    "ball:scale(V, V, V) ball:translate(V, V, V) root:add_child(ball) show{eye = {V, V, V}, target = {0, 1, 0}}",
    "ball:scale(V, V, V) ball:scale(V, V, V) ball:scale(V, V, V) root:add_child(ball) show{}",
    "for i = 1, 12 do ball:scale(V, V, V) end root:add_child(ball) show{}",
    "n = ball for i = 1, 12 do m = gr.node('m') m:scale(V, 1, 1) m:add_child(n) n = m end root:add_child(n) show{}",
    "n = ball for i = 1, 12 do m = gr.node('m') m:translate(V, V, V) m:scale(V, V, V) m:add_child(n) n = m end "
    "root:add_child(n) show{}",
    "root:rotate('x', V) root:rotate_axis({V, V, V}, V) root:rotate_quat(V, V, V, V) root:add_child(ball) show{}",
    "u = gr.union('u', ball, gr.cube('c')) u:scale(V, V, V) root:add_child(u) show{}",
    "ball:scale(V, V, V) root:add_child(gr.difference('d', gr.cube('c'), ball)) show{}",
    "ball:translate(V, 0, 0) root:add_child(gr.intersection('i', gr.cube('c'), ball, gr.plane{normal = {0, 1, 0}, "
    "distance = V})) show{}",
    "root:add_child(gr.inverse(gr.sphere{radius = V})) show{}",
    "root:add_child(gr.clipped_by{object = ball, by = gr.box{min = {-V, -V, -V}, max = {V, V, V}}}) show{}",
    "root:add_child(gr.bounded_by{object = ball, by = gr.sphere{radius = V}}) show{}",
    "root:add_child(gr.mesh{material = glass, verts = {{V, 0, 0}, {0, V, 0}, {0, 0, V}, {0, 0, 0}}, faces = {{0, 2, "
    "1}, "
    "{0, 1, 3}, {0, 3, 2}, {1, 2, 3}}}) show{caustics = 20}",
    "root:add_child(gr.mesh{material = white, verts = {{V, 0, 0}, {0, 1, 0}, {0, 0, 1}}, faces = {{0, 1, 2}}, normals "
    "= "
    "{{V, V, V}, {1, V, 0}, {0, 0, V}}, uvs = {{V, V}, {0, V}, {V, 0}}}:set_texture('square.png')) show{}",
    "root:add_child(ball) show{caustics = {photons = 60, radius = V}}",
    "root:add_child(ball) show{caustics = 60, lights = {gr.light({0, 3, 0}, {V, V, V})}}",
    "root:add_child(ball) show{caustics = 60, lights = {gr.light{position = {0, 3, 0}, colour = {V, 1, 1}, intensity = "
    "V}}}",
    "root:add_child(ball) show{caustics = 60, lights = {gr.area_light{corner = {0, 3, 0}, v1 = {1, 0, 0}, v2 = {0, 0, "
    "1}, emission = {V, V, V}}}}",
    "root:add_child(ball) show{caustics = 60, lights = {gr.spherical_light{position = {0, 3, 0}, radius = 0.5, "
    "emission "
    "= {V, 1, V}, colour = {V, V, 1}}}}",
    "root:add_child(ball) show{lights = {gr.area_light{corner = {0, 3, 0}, v1 = {V, 0, 0}, v2 = {0, 0, V}, emission = "
    "{V, V, V}, visible = true}}}",
    "root:add_child(ball) show{lights = {gr.area_light{corner = {V, V, V}, v1 = {V, V, 0}, v2 = {0, V, V}, colour = "
    "{V, V, V}, falloff = {V, V, V}}}}",
    "root:add_child(ball) show{lights = {gr.disc_light{position = {V, V, V}, normal = {V, V, V}, radius = V, emission "
    "= "
    "{V, V, V}}}}",
    "root:add_child(ball) show{lights = {gr.disc_light{position = {0, 3, 0}, normal = {0, -1, 0}, radius = V, emission "
    "= {1, 1, V}, visible = true}}}",
    "root:add_child(ball) show{lights = {gr.spherical_light{position = {0, V, 0}, radius = V, emission = {V, V, V}, "
    "visible = true}}}",
    "root:add_child(ball) show{lights = {gr.spherical_light{position = {0, 3, 0}, radius = V, emission = {1, 1, 1}}}}",
    "root:add_child(ball) show{lights = {gr.light{position = {V, V, V}, colour = {V, V, V}, range = V}}}",
    "root:add_child(ball) show{lights = {gr.light{position = {V, V, V}, colour = {V, V, V}, intensity = V}}}",
    "root:add_child(ball) show{lights = {gr.spot_light{position = {0, V, 0}, target = {V, 0, V}, colour = {V, V, V}, "
    "falloff = {0, 0, V}}}}",
    "root:add_child(ball) show{lights = {gr.directional_light({V, V, V}, {V, V, V})}}",
    "m = gr.mesh{material = gr.material{kd = {0, 0, 0}, emission = {V, V, V}}, verts = {{0, 3, 0}, {1, 3, 0}, {0, 3, "
    "1}}, faces = {{0, 1, 2}}} root:add_child(m) root:add_child(ball) show{lights = {gr.mesh_light{mesh = m}}}",
    "m = gr.mesh{material = white, verts = {{0, 3, 0}, {V, 3, 0}, {0, 3, V}, {V, V, V}}, faces = {{0, 1, 2}, {1, 2, "
    "3}}} root:add_child(m) root:add_child(ball) show{lights = {gr.mesh_light{mesh = m, emission = {V, V, V}}}}",
    "m = gr.mesh{material = white, verts = {{0, 3, 0}, {1, 3, 0}, {0, 3, 1}}, faces = {{0, 1, 2}}} "
    "root:add_child(ball) "
    "show{caustics = 60, lights = {gr.mesh_light{mesh = m, emission = {V, V, V}}}}",
    "root:add_child(ball) s = gr.sky_map{image = 'square.png', intensity = V, rotation = V} show{background = s, "
    "lights "
    "= {gr.sky_light{sky = s, colour = {V, V, V}}}}",
    "root:add_child(ball) s = gr.sky_gradient{stops = {{-1, V, V, V}, {1, V, 0, V}}, intensity = V} show{background = "
    "s, lights = {gr.sky_light{sky = s}}}",
    "root:add_child(ball) s = gr.sky_gradient{stops = {{V, V, 0, 1}, {V, 1, 0, V}}} show{background = s}",
    "root:add_child(ball) s = gr.clear_sky{sun = {V, V, V}, ground = {V, V, V}, intensity = V} show{background = s, "
    "lights = {gr.sky_light{sky = s}}}",
    "root:add_child(ball) show{background = {V, V, V}, ambient = {V, V, V}, lights = {gr.sky_light{sky = {V, V, V}, "
    "colour = {V, V, V}}}}",
    "m = gr.material{kd = {V, V, V}, ks = {V, V, V}, reflect = 1, shininess = V} ball:set_material(m) "
    "floor:set_material(m) root:add_child(ball) show{lights = {gr.light({0, 3, 3}, {V, V, V})}}",
    "m = gr.rr_material{kd = {V, 0, 1}, ks = {V, 1, 0}, reflect = 0.5, refract = 0.5, ior = V} ball:set_material(m) "
    "floor:set_material(m) root:add_child(ball) show{caustics = 20}",
    "m = gr.material{kd = {V, V, V}, ks = {V, V, V}, reflect = 1, roughness = V, emission = {V, V, V}} "
    "ball:set_material(m) floor:set_material(m) root:add_child(ball) show{}",
    "m = gr.material{kd = {0, V, 1}, ks = {0, V, -V}, reflect = 1, emission = {-V, V, 0}} floor:set_material(m) "
    "ball:set_material(m) root:add_child(ball) show{lights = {gr.light({0, 3, 3}, {V, -V, 0}), gr.light({1, 3, 3}, "
    "{-V, "
    "V, V})}}",
    "m = gr.difresnel_material(gr.rr_material{kd = {1, 1, 1}, ks = {V, V, V}, reflect = 1, refract = 1, ior = V}) "
    "ball:set_material(m) root:add_child(ball) show{caustics = 20}",
    "m = gr.rr_material{kd = {0, 0, 0}, ks = {1, 1, 1}, refract = 1, ior = 1.5, absorption = {V, V, V}} "
    "ball:set_material(m) root:add_child(ball) show{caustics = 20}",
    "m = gr.marble_pnd_material{material = white, f = V, multiplier = V, vein_frequency = V, mix = {V, V, V}} "
    "floor:set_material(m) ball:set_material(m) root:add_child(ball) show{}",
    "m = gr.wood_pnd_material{material = white, f = V, density = V, interp = 1, mix = {V, V, V}} "
    "floor:set_material(m) ball:set_material(m) root:add_child(ball) show{}",
    "m = gr.image_material{material = gr.material{kd = {V, V, V}}, image = 'square.png', tiles = {V, V}, offset = {V, "
    "V}} floor:set_material(m) ball:set_material(m) root:add_child(ball) show{}",
    "for _, f in ipairs{'nearest', 'bilinear', 'mipmap'} do for _, w in ipairs{'clamp', 'repeat', 'mirror'} do "
    "floor:set_texture(gr.texture{file = 'square.png', tiles = V, offset = V, filter = f, wrap = w}) show{} end end",
    "m = gr.bump_material{material = white, image = 'square.png', height = V, tiles = V} floor:set_material(m) "
    "ball:set_material(m) root:add_child(ball) show{}",
    "m = gr.bump_material{material = white, image = 'square.png', height = V, kind = 'normal', offset = V} "
    "floor:set_material(m) ball:set_material(m) root:add_child(ball) show{}",
    "root:add_child(ball) show{fog = gr.uniform_fog{density = V, colour = {V, V, V}}}",
    "root:add_child(ball) show{fog = gr.uniform_fog{density = V, squared = true}}",
    "root:add_child(ball) show{fog = gr.linear_fog{near = V, far = V, colour = {V, 1, 1}}}",
    "root:add_child(ball) show{fog = gr.linear_fog{near = 0, far = V}}",
    "root:add_child(ball) show{fog = gr.height_fog{density = V, base = V, scale = V, colour = {V, V, V}}}",
    "root:add_child(ball) show{fog = gr.height_fog{density = 1, base = 0, scale = V}}",
    "root:add_child(ball) show{fog = gr.height_fog{density = 1, base = V}}",
    "root:add_child(ball) show{fog = gr.fog_profile{profile = {{0, V}, {1, V}, {V, V}}, colour = {V, V, V}}}",
    "root:add_child(ball) show{fog = gr.fog_profile{profile = {{0, 1}, {0, V}, {1, 0}}}}",
    "root:add_child(ball) show{fog = gr.fog_grid{corner = {-V, -V, -V}, size = {V, V, V}, cells = {2, 2, 2}, densities "
    "= V}}",
    "root:add_child(ball) show{fog = gr.fog_grid{corner = {-1, -1, -1}, size = V, cells = {2, 2, 2}, densities = V, "
    "colour = {V, V, V}}}",
    "root:add_child(gr.instances{of = ball, at = {{V, V, V}, {0, 0, 0}}, turn = V, size = V}) show{}",
    "root:add_child(gr.instances{of = ball, at = {{V, 0, 0, 0, 0, V, 0, 0, 0, 0, V, 0}, {1, V, 0, 0, 0, 1, V, 0, V, 0, "
    "1, V}}}) show{}",
    "root:add_child(gr.joint('j', {V, V, V}, {V, V, V}):add_child(ball)) show{}",
    "root:add_child(gr.cylinder{from = {V, 0, 0}, to = {0, V, 0}, radius = V, material = glass}) show{}",
    "root:add_child(gr.cone{from = {0, 0, 0}, to = {0, V, 0}, radius = V, from_radius = V, material = glass}) show{}",
    "root:add_child(gr.torus{major = V, minor = V, material = glass}) show{}",
    "root:add_child(gr.quadric{xx = V, yy = V, zz = V, xy = V, x = V, constant = -V, material = glass}) show{}",
    "root:add_child(gr.quadric{xx = V, yy = 1, constant = -V, min = {-V, -V, -V}, max = {V, V, V}, material = glass}) "
    "show{}",
    "root:add_child(gr.superellipsoid{e = V, n = V, material = glass}) show{}",
    "root:add_child(gr.prism{outline = {{0, 0}, {V, 0}, {V, V}}, from = -V, to = V, material = glass}) show{}",
    "root:add_child(gr.lathe{points = {{V, 0}, {1, V}, {V, V}}, spline = 'b-spline', material = glass}) show{}",
    "root:add_child(gr.sweep{points = {{0, 0, 0}, {V, 1, 0}, {0, V, 1}}, radii = V, material = glass}) show{}",
    "root:add_child(gr.sweep{points = {{0, 0, 0}, {1, 1, 0}, {0, 1, 1}}, radii = {1, V, V}, material = glass}) show{}",
    "root:add_child(gr.curve{points = {{0, 0, 0}, {V, 1, 0}, {0, V, 1}}, widths = V, material = glass}) show{}",
    "root:add_child(gr.height_field{heights = {{0, V}, {V, 1}}, floor = -V, smooth = true, material = glass}) show{}",
    "root:add_child(gr.blob{spheres = {{0, 0, 0, V, V}, {1, 0, 0, 1, V}}, threshold = V, material = glass}) show{}",
    "root:add_child(gr.blob{cylinders = {{0, 0, 0, V, V, V, V, V}}, threshold = V, material = glass}) show{}",
    "root:add_child(gr.disc{centre = {0, V, 0}, normal = {V, V, V}, radius = V, inner = 0, material = glass}) show{}",
    "root:add_child(gr.ellipsoid{centre = {V, 0, 0}, radii = {V, V, 1}, material = glass}) show{}",
    "root:add_child(gr.polygon{points = {{0, 0, 0}, {V, 0, 0}, {V, V, 0}, {0, V, 0}}, material = glass}) show{}",
    "root:add_child(gr.rectangle{corner = {V, V, V}, along = {V, 0, 0}, up = {0, V, 0}, material = glass}) show{}",
    "root:add_child(ball) show{cutoff = 0, side_tolerance = V, corner_tolerance = V}",
    "root:add_child(ball) show{exposure = V}",
    "root:add_child(ball) gr.change_add_light({V, V, V}, {V, V, V}) show{}",
    "root:add_child(ball) gr.change_light(1, {V, V, V}, {V, V, V}, {V, 0, 0, 0, V, 0, 0, 0, V}) show{}",
    "root:add_child(ball) gr.change_view('x.png', {V, V, V}, {V, 0, V}, {0, V, V}, 50) show{}",
    "root:add_child(ball) gr.change_node('ball', 0, {V, 0, 0, V, 0, V, 0, V, 0, 0, V, V}) show{}",
    "root:add_child(ball) gr.change_look(1, 'ks', {V, V, V}) gr.change_look(1, 'kd', {V, V, V}) show{}",
    "root:add_child(ball) gr.change_look(1, 'ior', {V}) gr.change_look(1, 'shininess', {V}) show{}",
    "root:add_child(ball) gr.change_look(1, 'emission', {V, V, V}) gr.change_look(2, 'absorption', {V, V, V}) show{}",
};

static void put_value(const char *text, const char *value, char *out, size_t size) {
    size_t used = 0;
    out[0] = '\0';
    for (const char *at = text; *at && used + 64 < size; at++) {
        bool single = *at == 'V' && (at == text || !strchr("abcdefghijklmnopqrstuvwxyz_", at[-1]));
        used += (size_t)snprintf(out + used, size - used, single ? "(%.*s)" : "%.*s", single ? (int)strlen(value) : 1,
                                 single ? value : at);
    }
}

static int trials, refusals;

/* One line, or a finite picture. */
static void try_scene(struct gallery *gallery, const char *label, const char *scene, bool must_refuse) {
    static char text[TEXT_SIZE];
    struct error error;
    (void)snprintf(text, sizeof text, "%s%s\n", preparation, scene);
    bool done = run_text(gallery, text, &error);
    trials++;
    refusals += !done;
    if (done && must_refuse)
        test_fail(__FILE__, __LINE__, "%s is accepted", label);
    if (done && !gallery->finite)
        test_fail(__FILE__, __LINE__, "%s: %s", label, gallery->first);
    if (out_of_time)
        test_fail(__FILE__, __LINE__, "%s: takes longer than 3 s", label);
    if (!done && (error.kind != ERROR_SCENE || error.text[0] == '\0' || strchr(error.text, '\n')))
        test_fail(__FILE__, __LINE__, "%s: kind %d: %s", label, (int)error.kind, error.text);
}

/* The call and the use of its result; only a mesh light requires a mesh. */
static void scene_of(const struct script_function *function, const char *call, char *out, size_t size) {
    bool mesh = strcmp(function->name, "mesh_light") == 0;
    (void)snprintf(out, size, "%sX = %s\n%s", mesh ? "ball = sheet " : "", call, use_of(function));
}

static void try_call(struct gallery *gallery, const struct script_function *function, const char *call,
                     bool must_refuse) {
    char scene[CALL_SIZE + 512];
    scene_of(function, call, scene, sizeof scene);
    try_scene(gallery, call, scene, must_refuse);
}

/* In every numeric argument of every function: in all numbers of it, and in each of the first ones. */
static void try_everywhere(struct gallery *gallery, const char *value, bool must_refuse) {
    for (int f = 0; f < function_count(); f++) {
        const struct script_function *function = function_at(f);
        for (int p = function->owner == OWNER_NODE; p < function->parameter_count; p++) {
            char call[CALL_SIZE], right[256], with[512], all[512] = "";
            if (!is_numeric(function->parameters[p].kind) || !goes_with_the_others(function, p))
                continue;
            /* Millions of triangles; displacements_that_are_impossible_are_refused. */
            if (!gallery->is_long && strcmp(function->name, "displace") == 0)
                continue;
            right_text(&function->parameters[p], right, sizeof right);
            for (int which = -1; which < gallery->max && replace_number(right, which, value, with, sizeof with);
                 which++) {
                if (strcmp(with, all) == 0) /* of one number */
                    continue;
                if (which < 0)
                    (void)snprintf(all, sizeof all, "%s", with);
                if (has_table_form(function)) {
                    table_call(function, p, with, call);
                    try_call(gallery, function, call, must_refuse);
                }
                for (int k = 0; k < FORM_LIMIT && function->forms[k] && !has_table_form(function); k++) {
                    positional_call(function, function->forms[k], p, with, call);
                    if (strstr(call, with))
                        try_call(gallery, function, call, must_refuse);
                }
            }
        }
    }
}

static void try_combinations(struct gallery *gallery, const char *value) {
    for (size_t i = 0; i < sizeof combinations / sizeof combinations[0]; i++) {
        char scene[TEXT_SIZE / 2];
        put_value(combinations[i], value, scene, sizeof scene);
        try_scene(gallery, scene, scene, false);
    }
}

/* Every numeric argument of every function. */
static void try_values(const char *const *values, bool must_refuse, bool combinations_too, bool is_long) {
    struct gallery gallery;
    open_gallery(&gallery);
    gallery.max = is_long ? 9 : 1;
    gallery.is_long = is_long;
    for (; *values; values++) {
        try_everywhere(&gallery, *values, must_refuse);
        if (combinations_too)
            try_combinations(&gallery, *values);
    }
    CHECK(trials > 500);
    close_gallery(&gallery);
}

TEST(numbers_beyond_1e30_are_refused_in_every_argument) {
    try_values((const char *const[]){"1e31", NULL}, true, false, false);
}

TEST(numbers_of_1e30_give_one_line_or_a_finite_picture) {
    try_values((const char *const[]){"1e30", NULL}, false, true, false);
}

TEST(numbers_of_minus_1e30_give_one_line_or_a_finite_picture) {
    try_values((const char *const[]){"-1e30", NULL}, false, true, false);
}

TEST(numbers_without_a_reciprocal_give_one_line_or_a_finite_picture) {
    try_values((const char *const[]){"3e-320", NULL}, false, true, false);
}

TEST(the_smallest_numbers_give_one_line_or_a_finite_picture) {
    try_values((const char *const[]){"5e-324", NULL}, false, true, false);
}

TEST_LONG(numbers_just_beyond_1e30_or_not_finite_are_refused_in_every_argument) {
    try_values((const char *const[]){"1.0000000000000001e30", "-1.0001e30", "1e40", "-1e308", "1e308", "(-1/0)",
                                     "(1/0)", "(0/0)", NULL},
               true, false, true);
}

TEST_LONG(extreme_numbers_of_every_size_give_one_line_or_a_finite_picture) {
    try_values((const char *const[]){"1e29",   "1e25",    "-1e20",   "1e15",   "1e10",    "-1e6",   "1e-10",  "1e-20",
                                     "-1e-25", "1e-30",   "1e-31",   "1e-100", "-1e-154", "1e-160", "1e-300", "1e-308",
                                     "1e-310", "-3e-320", "-5e-324", "0",      "-0.0",    NULL},
               false, true, true);
}

/* The language allows colours above 1 and below 0; only coefficients of media have a minimum, and shares a maximum. */
TEST(every_colour_may_be_as_large_as_1e30_in_either_direction) {
    struct gallery gallery;
    open_gallery(&gallery);
    for (int f = 0; f < function_count(); f++) {
        const struct script_function *function = function_at(f);
        for (int p = 0; p < function->parameter_count && has_table_form(function); p++) {
            char call[CALL_SIZE];
            struct error error;
            if (function->parameters[p].kind != KIND_COLOUR || function->parameters[p].high == 1)
                continue;
            for (int sign = 0; sign < 2; sign++) {
                char scene[TEXT_SIZE / 2], text[TEXT_SIZE];
                bool bounded = function->parameters[p].high != 0;
                table_call(function, p, sign && !bounded ? "{-1e30, 0, 1e30}" : "{1e30, 0, 1e30}", call);
                scene_of(function, call, scene, sizeof scene);
                (void)snprintf(text, sizeof text, "%s%s\n", preparation, scene);
                if (!run_text(&gallery, text, &error) && !strstr(error.text, " is not implemented"))
                    test_fail(__FILE__, __LINE__, "%s: %s", call, error.text);
            }
        }
    }
    close_gallery(&gallery);
}

/* The messages for small values that are refused. */
TEST(what_cannot_be_divided_by_is_named) {
    static const struct corner refused[] = {
        {"show{aperture = 0.1, focus = 5e-324}", "focus is too small: 4.94066e-324"},
        {"show{aperture = 0.1, focus = 1e-31}", "focus is too small: 1e-31"},
        {"show{stereo = 'side', screen = 1e-310}", "screen is too small: 1e-310"},
        {"show{stereo = 'anaglyph', focus = 1e-310}", "screen is too small: 1e-310"},
        {"for i = 1, 11 do ball:scale(1e30, 1e30, 1e30) end root:add_child(ball) show{}",
         "node 'ball': its transforms and those above it multiply to numbers that are too large or too small"},
        {"for i = 1, 11 do ball:scale(1e-30, 1, 1) end root:add_child(gr.union('u', ball, gr.cube('c'))) show{}",
         "node 'ball': its transforms"},
        {"for i = 1, 11 do ball:scale(1e-30, 1, 1) end m = gr.node('m') m:moves_to(ball) root:add_child(m) "
         "m:add_child(gr.cube('c')) show{}",
         "node 'ball': its transforms"},
        {"show{aperture = 0.1, focus = 1e-30}", NULL},
        {"show{stereo = 'side', screen = 1e-30}", NULL},
        {"ball:scale(1, 1e-320, 1) root:add_child(ball) show{}", NULL},
    };
    struct gallery gallery;
    open_gallery(&gallery);
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++) {
        char text[TEXT_SIZE];
        struct error error;
        (void)snprintf(text, sizeof text, "%s%s\n", preparation, refused[i].text);
        bool done = run_text(&gallery, text, &error);
        if (done != !refused[i].words || (refused[i].words && !strstr(error.text, refused[i].words)))
            test_fail(__FILE__, __LINE__, "%s: %s", refused[i].text, done ? "accepted" : error.text);
        CHECK(gallery.finite);
    }
    close_gallery(&gallery);
}

/* --- the whole program --- */

/* The floats of a PFM picture: how many are not finite, and how many are the largest. */
static void count_floats(const char *name, size_t *not_finite, size_t *largest) {
    size_t size, begun = 0;
    char *bytes = test_read_file(test_path(name), &size);
    *not_finite = *largest = 0;
    if (!bytes) {
        test_fail(__FILE__, __LINE__, "there is no %s", name);
        return;
    }
    for (int lines = 0; lines < 3 && begun < size; begun++)
        lines += bytes[begun] == '\n';
    CHECK((size - begun) % 12 == 0 && size > begun);
    for (size_t at = begun; at + 4 <= size; at += 4) {
        float value;
        memcpy(&value, bytes + at, sizeof value);
        *not_finite += isfinite(value) ? 0 : 1;
        *largest += fabsf(value) == FLT_MAX ? 1 : 0;
    }
    free(bytes);
}

static int format_count(const char *text, const char *words) {
    int count = 0;
    for (; (text = strstr(text, words)); text++)
        count++;
    return count;
}

static const char clamped_words[] = "light beyond the largest float is clamped to it";

/* Brighter than the largest float, in a mirror and behind glass as well; one lamp has negative light and cancels
 * another. */
static const char bright_scene[] =
    "m = gr.material{kd = {1e30, 1, 0}, ks = {1e30, 0, -1e30}, reflect = 1, emission = {0, 0, -1e20}}\n"
    "b = gr.sphere('b') b:set_material(m) f = gr.plane{normal = {0, 1, 0}, distance = -1, material = m}\n"
    "r = gr.node('r') r:add_child(b) r:add_child(f)\n"
    "gr.render{node = r, file = FILE, width = 16, height = 12, eye = {0, 1, 5}, target = {0, 0, 0}, samples = 2,\n"
    "  background = {1e30, -1e30, 1}, lights = {gr.light({0, 3, 3}, {1e30, -1e30, 0}), gr.light({1, 3, 3}, {-1e30, "
    "1e30, 1e30})}}\n";

static void bright_text(const char *file, char *out, size_t size) {
    const char *at = strstr(bright_scene, "FILE");
    (void)snprintf(out, size, "%.*s'%s'%s", (int)(at - bright_scene), bright_scene, file, at + 4);
}

/* The layers of `mask` beside x.pfm are there, and finite. */
static void check_layers(uint32_t mask) {
    for (int i = 0; i < AOV_COUNT; i++) {
        char name[64];
        size_t not_finite, largest;
        if (!(mask >> i & 1))
            continue;
        (void)snprintf(name, sizeof name, "x.%s.pfm", aov_name((enum aov)i));
        count_floats(name, &not_finite, &largest);
        CHECK(not_finite == 0);
    }
}

TEST(light_beyond_the_largest_float_is_clamped_with_one_warning) {
    char scene[2048];
    size_t not_finite, largest;
    bright_text("x.pfm", scene, sizeof scene);
    struct test_result r = test_gray_scene(scene, "--aov all -write-pre-aa pre- scene.lua", NULL);
    CHECK_EQ_INT(r.status, 0);
    if (format_count(r.err, clamped_words) != 1 || format_count(r.err, "x.pfm: light") != 1)
        test_fail(__FILE__, __LINE__, "%s", r.err);
    count_floats("x.pfm", &not_finite, &largest);
    CHECK(not_finite == 0 && largest > 0);
    count_floats("pre-x.pfm", &not_finite, &largest);
    CHECK(not_finite == 0 && largest > 0);
    check_layers(AOV_ALL & ~AOV_PATH);
    test_free_result(&r);
    r = test_gray_scene(scene, "-q --integrator path --spp 4 --aov all scene.lua", NULL);
    CHECK_EQ_INT(r.status, 0);
    count_floats("x.pfm", &not_finite, &largest);
    CHECK(not_finite == 0);
    check_layers(AOV_ALL);
    test_free_result(&r);
    r = test_gray_scene(scene, "-q scene.lua", NULL);
    CHECK_TEXT(r.err, "");
    test_free_result(&r);
}

TEST(one_warning_for_each_picture_that_is_clamped) {
    char scene[4096] = "", one[2048];
    for (int i = 0; i < 3; i++) {
        char name[16];
        (void)snprintf(name, sizeof name, "%c.pfm", 'a' + i);
        bright_text(name, one, sizeof one);
        append(scene, one);
    }
    append(scene, "gr.render{node = gr.sphere('s'), file = 'dark.pfm', width = 8, height = 8, eye = {0, 0, 5}}\n");
    struct test_result r = test_gray_scene(scene, "scene.lua", NULL);
    CHECK_EQ_INT(r.status, 0);
    CHECK_EQ_INT(format_count(r.err, clamped_words), 3);
    CHECK_EQ_INT(format_count(r.err, "dark.pfm: light"), 0);
    test_free_result(&r);
}

/* Radiance pictures end below the largest float; EXR and PNG pictures are read back by the program itself. */
TEST(clamped_light_can_be_read_back_in_every_format) {
    static const char *const names[] = {"x.pfm", "x.hdr", "x.png", "x.exr"};
    size_t count = exr_can_write() ? 4 : 3;
    for (size_t i = 0; i < count; i++) {
        char scene[4096];
        size_t not_finite, largest;
        bright_text(names[i], scene, sizeof scene);
        struct test_result r =
            test_gray_scene(scene, "--exposure 100 --tone filmic --srgb --aov depth,normal scene.lua", NULL);
        CHECK_EQ_INT(r.status, 0);
        CHECK_EQ_INT(format_count(r.err, clamped_words), 1);
        test_free_result(&r);
        (void)snprintf(scene, sizeof scene,
                       "gr.render{node = gr.node('n'), file = 'back.pfm', width = 16, height = 8, eye = {0, 0, 0}, "
                       "projection = 'panorama', background = gr.sky_map{image = '%s'}}\n",
                       names[i]);
        r = test_gray_scene(scene, "scene.lua", NULL);
        if (r.status != 0)
            test_fail(__FILE__, __LINE__, "%s: %s", names[i], r.err);
        test_free_result(&r);
        count_floats("back.pfm", &not_finite, &largest);
        CHECK(not_finite == 0);
    }
}

TEST(pixels_that_are_inspected_have_no_numbers_that_json_lacks) {
    char scene[2048];
    bright_text("x.pfm", scene, sizeof scene);
    struct test_result r = test_gray_scene(scene, "--pixel 8,6 --pixel 0,0 --pixel 3,11 --json scene.lua", NULL);
    CHECK_EQ_INT(r.status, 0);
    CHECK(strlen(r.out) > 1000 && !strstr(r.out, "nan") && !strstr(r.out, "inf,") && !strstr(r.out, ":inf"));
    test_free_result(&r);
}

TEST(numbers_of_options_are_finite) {
    static const char *const options[] = {"--exposure 1e308",      "--exposure nan",      "--exposure -101",
                                          "-side-tolerance inf",   "-side-tolerance nan", "-corner-tolerance 1e309",
                                          "--cutoff nan",          "--cutoff 1e308",      "--checkpoint-every inf",
                                          "--script-time 1e999",   "--caustics 1e308",    "--pixel nan,1",
                                          "-corner-tolerance -inf"};
    for (size_t i = 0; i < sizeof options / sizeof options[0]; i++) {
        char arguments[128];
        (void)snprintf(arguments, sizeof arguments, "%s scene.lua", options[i]);
        struct test_result r =
            test_gray_scene("gr.render{node = gr.sphere('s'), file = 'o.pfm', width = 4, height = 4, "
                            "eye = {0, 0, 5}}\n",
                            arguments, NULL);
        if (r.status != 2 || format_count(r.err, "\n") > 2)
            test_fail(__FILE__, __LINE__, "%s: status %d: %s", options[i], r.status, r.err);
        test_free_result(&r);
    }
}

TEST(the_ends_of_the_ranges_of_options_give_a_finite_picture) {
    static const char *const options[] = {"--exposure 100",
                                          "--exposure -100",
                                          "-side-tolerance 1e308",
                                          "-corner-tolerance 5e-324",
                                          "--cutoff 5e-324",
                                          "--cutoff 1",
                                          "--script-time 1e308",
                                          "--checkpoint-every 1e308 --checkpoint c",
                                          "--checkpoint-every 5e-324 --checkpoint d"};
    for (size_t i = 0; i < sizeof options / sizeof options[0]; i++) {
        char arguments[128], scene[2048];
        size_t not_finite, largest;
        bright_text("x.pfm", scene, sizeof scene);
        (void)snprintf(arguments, sizeof arguments, "%s scene.lua", options[i]);
        struct test_result r = test_gray_scene(scene, arguments, NULL);
        if (r.status != 0)
            test_fail(__FILE__, __LINE__, "%s: status %d: %s", options[i], r.status, r.err);
        count_floats("x.pfm", &not_finite, &largest);
        CHECK(not_finite == 0);
        test_free_result(&r);
    }
}

/* --- files --- */

/* A file as a mesh, or the error message. */
struct model_case {
    const char *name, *text, *words; /* NULL: it is drawn */
};

#define OBJ_REST "v 0 0 0\nv 1 0 0\nf 1 2 3\n"
#define PLY_HEAD                                                                                                       \
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"               \
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
#define STL_FACET(x)                                                                                                   \
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex " x " 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"       \
    "endsolid a\n"
#define GLTF(node, material)                                                                                           \
    "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":36,\"uri\":\"data:application/octet-stream;"        \
    "base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],"  \
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],\"materials\":[{"         \
    "\"pbrMetallicRoughness\":{\"metallicFactor\":0}" material "}],\"meshes\":[{\"primitives\":[{\"material\":0,"      \
    "\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0" node "}],\"scenes\":[{\"nodes\":[0]}]}"
#define LIMIT_WORDS " is not between -1e+30 and 1e+30"

TEST(numbers_of_mesh_files_have_the_limit_of_scripts) {
    static const struct model_case cases[] = {
        {"a.obj", "v 1e31 0 0\n" OBJ_REST, "a.obj: a number of vertex 1" LIMIT_WORDS},
        {"b.obj", "v 0 1 -1e308\n" OBJ_REST, "b.obj: a number of vertex 1" LIMIT_WORDS},
        {"c.obj", "v 0 1e30 0\n" OBJ_REST, NULL},
        /* These are left out. */
        {"d.obj", "v 0 1 0\nvt 1e200 0\nv 0 0 0\nv 1 0 0\nf 1/1 2/1 3/1\n", NULL},
        {"e.obj", "v 0 1 0\nvn 0 -1e200 0\nv 0 0 0\nv 1 0 0\nf 1//1 2//1 3//1\n", NULL},
        {"f.obj", "mtllib kd.mtl\nusemtl m\nv 0 1 0\n" OBJ_REST, NULL},
        {"g.obj", "mtllib ke.mtl\nusemtl m\nv 0 1 0\n" OBJ_REST, NULL},
        {"h.obj", "mtllib map.mtl\nusemtl m\nv 0 1 0\n" OBJ_REST, "h.obj: a number of material 1" LIMIT_WORDS},
        {"i.obj", "mtllib fine.mtl\nusemtl m\nv 0 1 0\n" OBJ_REST, NULL},
        {"a.ply", PLY_HEAD "0 0 1e31\n1 0 0\n0 1 0\n3 0 1 2\n", "a.ply: a number of vertex 1" LIMIT_WORDS},
        {"b.ply", PLY_HEAD "0 0 0\n1 0 0\n0 -1e30 0\n3 0 1 2\n", NULL},
        {"a.stl", STL_FACET("-1e31"), "a.stl: a number of vertex 1" LIMIT_WORDS},
        {"b.stl", STL_FACET("1e30"), NULL},
        {"a.gltf", GLTF(",\"translation\":[1e31,0,0]", ""), "a.gltf: the transform of node 1"},
        {"b.gltf", GLTF(",\"scale\":[1,1e-320,1]", ""), NULL}, /* without an inverse it is flat */
        {"c.gltf", GLTF(",\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,0,1e300,0,1]", ""), "c.gltf: the transform of node 1"},
        {"d.gltf", GLTF("", ",\"emissiveFactor\":[0,1e40,0]"), "d.gltf: a number of material 1" LIMIT_WORDS},
        {"e.gltf", GLTF(",\"translation\":[1e30,0,0],\"rotation\":[1e200,0,0,1]", ""), "e.gltf"},
        {"f.gltf", GLTF(",\"translation\":[1e30,0,0]", ",\"emissiveFactor\":[0,1e30,0]"), NULL},
    };
    struct gallery gallery;
    open_gallery(&gallery);
    test_write_text(test_path("kd.mtl"), "newmtl m\nKd 1 1 1e31\n");
    test_write_text(test_path("ke.mtl"), "newmtl m\nKe -1e308\n");
    test_write_text(test_path("map.mtl"), "newmtl m\nmap_Kd -s 1e31 1 1 square.png\n");
    test_write_text(test_path("fine.mtl"), "newmtl m\nKd 1e30 -1e30 1\nKs 1e30\nNs 1e30\nKe 1e30\nNi 1e30\nillum 7\n"
                                           "map_Kd -s 1e30 1e30 1 -o -1e30 1e30 square.png\n");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[TEXT_SIZE];
        struct error error;
        if (strstr(cases[i].name, ".gltf") && strcmp(json_text_library(), "none") == 0)
            continue;
        test_write_text(test_path(cases[i].name), cases[i].text);
        (void)snprintf(text, sizeof text, "%sroot:add_child(gr.mesh{file = '%s'}) show{}\n", preparation,
                       cases[i].name);
        bool done = run_text(&gallery, text, &error);
        if (done != !cases[i].words || (cases[i].words && !strstr(error.text, cases[i].words)))
            test_fail(__FILE__, __LINE__, "%s: %s", cases[i].name, done ? "accepted" : error.text);
        CHECK(gallery.finite);
    }
    close_gallery(&gallery);
}

/* A PFM picture of one row with these values. */
static void write_strange_pfm(const char *name, const char *scale) {
    const float values[] = {INFINITY, -INFINITY, NAN, FLT_MAX, -FLT_MAX, 1e30F, 1e-45F, -NAN, 0, 1, 3e38F, 2};
    char bytes[128];
    int head = snprintf(bytes, sizeof bytes, "PF\n4 1\n%s\n", scale);
    memcpy(bytes + head, values, sizeof values);
    test_write_file(test_path(name), bytes, (size_t)head + sizeof values);
}

TEST(pictures_that_hold_strange_numbers_give_finite_pictures) {
    static const char *const uses[] = {
        "s = gr.sky_map{image = P} root:add_child(ball) show{background = s, lights = {gr.sky_light{sky = s}}}",
        "s = gr.sky_map{image = P, intensity = 1e30} root:add_child(ball) show{background = s, lights = "
        "{gr.sky_light{sky = s, colour = {1e30, -1e30, 0}}}, caustics = 50}",
        "floor:set_texture(P) root:add_child(ball) show{caustics = 50}",
        "floor:set_bump(P) ball:set_bump(P) root:add_child(ball) show{}",
        "for _, c in ipairs{'kd', 'ks', 'emission', 'opacity'} do floor:set_material(gr.image_material{material = "
        "white, "
        "image = P, channel = c}) show{} end",
        "floor:set_material(gr.bump_material{material = white, image = P, kind = 'normal', height = 1e30}) show{}",
        "floor:set_material(gr.td_cube_material(white, P)) ball:set_material(gr.td_sphere_material(white, P)) "
        "root:add_child(ball) show{}",
        "root:add_child(gr.height_field{image = P}) show{}",
    };
    static const char *const names[] = {"one.pfm", "large.pfm", "small.pfm"};
    struct gallery gallery;
    open_gallery(&gallery);
    write_strange_pfm("one.pfm", "-1");
    write_strange_pfm("large.pfm", "-1e30");
    write_strange_pfm("small.pfm", "-1e-30");
    for (size_t n = 0; n < sizeof names / sizeof names[0]; n++) {
        for (size_t i = 0; i < sizeof uses / sizeof uses[0]; i++) {
            char scene[TEXT_SIZE / 2];
            (void)snprintf(scene, sizeof scene, "P = '%s' %s", names[n], uses[i]);
            try_scene(&gallery, scene, scene, false);
        }
    }
    close_gallery(&gallery);
}

/* A tile with correct checksums whose colour is not a number. */
TEST(tiles_with_colours_that_are_not_finite_are_refused) {
    static const float strange[] = {NAN, INFINITY, -INFINITY};
    for (size_t i = 0; i < sizeof strange / sizeof strange[0]; i++) {
        for (int first = 0; first < 2; first++) {
            char scene[2048], name[512];
            bright_text("x.png", scene, sizeof scene);
            struct test_result r = test_gray_scene(scene, "-q --shard 1/1 scene.lua", NULL);
            CHECK_EQ_INT(r.status, 0);
            test_free_result(&r);
            struct tile_file file;
            struct error error;
            (void)snprintf(name, sizeof name, "%s", test_path("x.png.1-of-1.part"));
            if (!tile_file_read(name, &file, &error)) {
                test_fail(__FILE__, __LINE__, "%s", error.text);
                return;
            }
            size_t bytes;
            uint32_t restored, twice;
            CHECK(film_size(file.picture.width, file.picture.height, file.picture.record, &bytes, &error));
            void *block = mem_alloc_zero(1, bytes);
            struct film film = {0};
            film_layout(&film, block, file.picture.width, file.picture.height, file.picture.record);
            film.full_width = film.width;
            film.full_height = film.height;
            tile_file_restore(&file, &film, &restored, &twice);
            CHECK(restored == 1);
            film.marked[17] = 1;
            (first ? &film.floats[3 * 17] : film.pixels[17].rgb)[1] = strange[i];
            CHECK(tile_file_write(FILE_AT(name), NULL, 0, &file.picture, &film, &error));
            tile_file_close(&file);
            mem_free(block);
            CHECK(!tile_file_read(name, &file, &error) && strstr(error.text, "a colour that is not finite"));
            r = test_gray(NULL, "merge x.png.1-of-1.part -o merged.pfm");
            if (r.status != 1 || format_count(r.err, "\n") != 1 || !strstr(r.err, "not finite"))
                test_fail(__FILE__, __LINE__, "status %d: %s", r.status, r.err);
            test_free_result(&r);
        }
    }
}
