/* Pixel traces: the trace reports what was computed, and its parts add up to the sum. */
#include "film/aov.h"
#include "material/material_inputs.h"
#include "render/pixel_trace.h"
#include "tests/harness.h"
#include "tests/stage.h"
#include "world/node_path.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* --- the parts of a ray add up to its colour --- */

static double difference(struct colour a, struct colour b) {
    return colour_max_abs(colour_sub(a, b)) / (1 + colour_max_abs(a));
}

struct tally {
    double worst;
    int rays, kinds[4], limits, blocked, reached, excluded, fogged, absorbed, holes, links, neighbours;
};

static void check_ray(struct tally *tally, const struct pixel_trace_ray *ray) {
    tally->rays++;
    tally->kinds[ray->kind]++;
    tally->limits += ray->cut == RAY_OVER_LIMIT;
    if (!ray->begun)
        return;
    struct colour whole = colour_add(colour_mul(ray->seen, ray->left), ray->in_scattered);
    tally->worst = fmax(tally->worst, difference(whole, ray->brings));
    tally->fogged += ray->in_scattered.r != 0;
    tally->absorbed += ray->left.r < 1 && ray->in_scattered.r == 0;
    struct colour holes = {0, 0, 0}, surface = colour_add(ray->direct, ray->bsdf.emission), lights = ray->ambient;
    for (const struct pixel_trace_light *light = ray->lights; light; light = light->next) {
        lights = colour_add(lights, light->colour);
        tally->blocked += light->lit == PIXEL_TRACE_LIGHT_BLOCKED;
        tally->reached += light->lit == PIXEL_TRACE_LIGHT_REACHES;
        tally->excluded += light->lit == PIXEL_TRACE_LIGHT_NOT_OURS;
        if (light->lit == PIXEL_TRACE_LIGHT_REACHES && !light->area_light) {
            struct colour own = colour_mul(colour_scale(light->light->colour, light->strength), light->reflected);
            own = colour_scale(own, (double)light->arrived / (double)light->asked);
            tally->worst = fmax(tally->worst, difference(own, light->colour));
        }
    }
    for (const struct pixel_trace_link *link = ray->links; link; link = link->next)
        tally->links++;
    for (const struct pixel_trace_ray *child = ray->first; child; child = child->next) {
        struct colour part = colour_mul(child->weight, child->brings);
        if (child->kind == RAY_HOLE)
            holes = colour_add(holes, part);
        else
            surface = colour_add(surface, part);
        check_ray(tally, child);
    }
    if (!ray->met || ray->cut != RAY_FOLLOWED)
        return;
    tally->holes += ray->opacity < 1;
    tally->worst = fmax(tally->worst, difference(colour_add(lights, ray->photons), ray->direct));
    if (ray->shaded)
        holes = colour_add_scaled(holes, surface, ray->opacity);
    tally->worst = fmax(tally->worst, difference(holes, ray->seen));
}

struct check {
    const struct stage *stage;
    struct tally tally;
    int pixels, wrong, marked;
};

static bool check_pixel_trace(void *context, struct pixel_trace *pixel_trace, struct error *error) {
    struct check *check = context;
    struct colour sum = {0, 0, 0};
    double count = 0;
    (void)error;
    check->pixels++;
    check->marked += pixel_trace->marked;
    for (const struct pixel_trace_sample *sample = pixel_trace->sample; sample; sample = sample->next) {
        if (sample->counts) {
            sum = colour_add(sum, sample->colour);
            count++;
        }
        check->tally.worst = fmax(check->tally.worst, difference(sample->first->brings, sample->colour));
        check_ray(&check->tally, sample->first);
    }
    struct colour reported = {(double)pixel_trace->rgb[0], (double)pixel_trace->rgb[1], (double)pixel_trace->rgb[2]};
    struct colour have = stage_pixel(check->stage, pixel_trace->x, pixel_trace->y);
    check->wrong += reported.r != have.r || reported.g != have.g || reported.b != have.b;
    check->wrong += difference(colour_scale(sum, 1 / count), reported) > 1e-6; /* the film is single precision */
    return true;
}

/* Traces every seventh pixel of the picture and compares it with the film. */
static struct check print_picture(struct stage *s, uint32_t width, uint32_t height) {
    enum { MAX = 2000 };
    static uint32_t pixels[MAX][2];
    uint32_t count = 0;
    struct check check = {.stage = s};
    CHECK(stage_render(s, width, height));
    for (uint32_t i = 0; i < width * height && count < MAX; i += 7, count++) {
        pixels[count][0] = i % width;
        pixels[count][1] = i / width;
    }
    struct render_job job = {.world = &s->world,
                             .camera = s->camera,
                             .settings = s->settings,
                             .width = width,
                             .height = height,
                             .ambient = s->ambient};
    CHECK(render_pixels(&job, s->pool, (struct pixel_list){(const uint32_t(*)[2])pixels, count}, check_pixel_trace,
                        &check, &s->error));
    CHECK_EQ_INT(check.pixels, count);
    CHECK_EQ_INT(check.wrong, 0);
    CHECK(check.marked > 0);
    CHECK(check.tally.worst < 1e-12);
    return check;
}

/* A mirror, marble, absorbing glass, a rough surface, an emitter, and shadows between them. */
static void fill_stage(struct stage *s) {
    struct material *mirror = stage_phong(s, colour_make(0.2, 0.3, 0.2), colour_all(0.7), 30);
    mirror->phong.reflect = 0.6;
    struct material *marble = scene_material(&s->scene, MATERIAL_MARBLE, mirror, &s->error);
    CHECK(material_mix_kd(marble, texture_marble(0.7, 3, 2, 1), texture_constant(colour_make(0.9, 0.2, 0.1)),
                          &s->scene.arena, &s->error));
    struct material *glass = stage_glass(s, 0.2, 0.7, 1.5);
    glass->phong.absorption = colour_make(0.3, 0.1, 0.05);
    struct material *rough = stage_phong(s, colour_all(0.4), colour_all(0.5), 10);
    rough->phong.reflect = 0.5;
    rough->phong.roughness = 0.3;
    rough->phong.emission = colour_make(0.05, 0, 0.02);
    struct node *ball = stage_sphere(s, s->root, marble);
    stage_move(s, ball, -1.2, 0, 0);
    struct node *clear = stage_sphere(s, s->root, glass);
    stage_move(s, clear, 1, 0.2, 1);
    struct node *floor = stage_cube(s, s->root, rough);
    stage_scale(s, floor, 12, 0.2, 12);
    stage_move(s, floor, -6, -1.6, -6);
    stage_point_light(s, vec3_make(4, 6, 5), colour_make(0.8, 0.7, 0.6));
    stage_point_light(s, vec3_make(-3, 5, -2), colour_make(0.3, 0.4, 0.6));
    s->lights[s->light_count++] = (struct light){.kind = LIGHT_PARALLELOGRAM,
                                                 .position = {0, 5, 3.5},
                                                 .corner = {-1, 5, 3},
                                                 .edge1 = {2, 0, 0},
                                                 .edge2 = {0, 0, 1},
                                                 .colour = {0.3, 0.3, 0.3},
                                                 .falloff = {1, 0.01, 0}};
    const struct node **not_lit = arena_alloc_array(&s->scene.arena, 1, sizeof *not_lit);
    not_lit[0] = floor;
    s->authored[1].exclude = not_lit;
    s->authored[1].exclude_count = 1;
    s->ambient = colour_all(0.2);
    s->sky = (struct sky){.kind = SKY_GRADIENT};
}

TEST(the_parts_of_every_traced_ray_add_up_to_its_radiance) {
    struct stage s;
    stage_begin(&s, 2);
    fill_stage(&s);
    struct tally t = print_picture(&s, 60, 44).tally;
    CHECK(t.rays > 2000 && t.kinds[RAY_REFLECTED] > 100 && t.kinds[RAY_REFRACTED] > 100);
    CHECK(t.excluded > 0 && t.limits > 0 && t.blocked > 0 && t.reached > 0 && t.absorbed > 0);
    stage_end(&s);
}

TEST(the_pixel_trace_of_fog_lamps_and_blurred_lenses_is_the_picture) {
    const struct fog fog = {.kind = FOG_EXPONENTIAL, .colour = {0.5, 0.6, 0.7}, .density = 0.05};
    struct stage s;
    stage_begin(&s, 2);
    fill_stage(&s);
    s.fog = &fog;
    s.lights[2].emissive = true;
    s.settings.cutoff = 0.01;
    CHECK(print_picture(&s, 40, 30).tally.fogged > 100);
    s.settings.lens.aperture = 0.2;
    s.settings.samples = 2;
    s.settings.tone = (struct tone){.exposure = 1, .curve = TONE_FILMIC, .srgb = true};
    CHECK(print_picture(&s, 30, 22).tally.fogged > 100);
    s.settings.lens.aperture = 0;
    s.settings.lens.stereo = STEREO_SIDE;
    s.settings.lens.eye_distance = 0.3;
    s.settings.lens.screen = 10;
    s.settings.pixel_corner = true;
    s.settings.caustics = (struct caustics){2000, 0};
    CHECK(print_picture(&s, 30, 22).tally.fogged > 100);
    stage_end(&s);
}

/* Paths that split without end: rays beyond the limit are counted, and the colour is still the picture's. */
TEST(a_pixel_trace_that_is_too_long_counts_what_it_leaves_out) {
    struct stage s;
    struct pixel_trace pixel_trace;
    stage_begin(&s, 1);
    stage_sphere(&s, s.root, stage_glass(&s, 0.5, 0.5, 1.5));
    pixel_trace_init(&pixel_trace, 0, 0);
    struct pixel_sample position = {0, 0, 0.5, 0.5, 0, 1};
    struct ray ray = {.direction = {0, 0, -1}};
    struct observed_end end = {true, colour_all(1), colour_all(1), colour_all(0), colour_all(1)};
    OBSERVE(&pixel_trace.observer, OBSERVED_SAMPLE_BEGIN, .sample.position = &position);
    for (int i = 0; i < PIXEL_TRACE_RAYS + 10; i++) {
        OBSERVE(&pixel_trace.observer, OBSERVED_RAY_SENT, .sent = {RAY_CAMERA, colour_all(1), RAY_FOLLOWED});
        OBSERVE(&pixel_trace.observer, OBSERVED_RAY_BEGIN, .begin = {&ray, NULL, NULL, INFINITY, 1, 0});
        OBSERVE(&pixel_trace.observer, OBSERVED_RAY_SENT, .sent = {RAY_REFLECTED, colour_all(1), RAY_FOLLOWED});
        CHECK_EQ_INT(pixel_trace.mute, i >= PIXEL_TRACE_RAYS);
        OBSERVE(&pixel_trace.observer, OBSERVED_RAY_END, .end = end);
    }
    OBSERVE(&pixel_trace.observer, OBSERVED_SAMPLE_END, .sample = {&position, colour_all(1)});
    CHECK_EQ_INT(pixel_trace.rays, PIXEL_TRACE_RAYS);
    CHECK_EQ_INT(pixel_trace.omitted, 10);
    CHECK(!pixel_trace.failed);
    pixel_trace_destroy(&pixel_trace);
    stage_end(&s);
}

/* --- node paths --- */

static bool note_path(void *context, uint32_t first, uint32_t count, const struct scene_step *steps, uint32_t depth) {
    char(*texts)[200] = context;
    for (uint32_t i = first; i < first + count; i++)
        (void)node_path_text(steps, depth, texts[i], sizeof texts[i]);
    return true;
}

TEST(paths_to_instances_name_every_node_and_index_on_them) {
    struct stage s;
    stage_begin(&s, 1);
    const struct material *m = stage_phong(&s, colour_all(0.5), colour_all(0), 1);
    struct node *pair = stage_group(&s, s.root), *other = stage_group(&s, s.root);
    struct node *ball = stage_sphere(&s, pair, m);
    CHECK(node_add_child(&s.scene, other, pair, &s.error) &&
          node_add_child(&s.scene, ball, stage_cube(&s, pair, m), &s.error));
    static const double at[3][3] = {{0, 0, 0}, {5, 0, 0}, {9, 0, 0}};
    struct placements *positions = arena_alloc(&s.scene.arena, sizeof *positions);
    *positions = (struct placements){.count = 3, .at = at};
    other->placements = positions;
    CHECK(stage_build(&s, s.root, ACCEL_AUTO));
    char texts[16][200] = {{0}};
    CHECK(world_visit_node_paths(&s.world, s.root, note_path, texts, &s.error));
    CHECK_EQ_INT(s.world.primitive_count, 12); /* ball, its cube, the cube; four times */
    char expected[200];
    (void)snprintf(expected, sizeof expected, "%s#0 / %s#1 / %s#3 / %s#4", s.root->name, pair->name, ball->name,
                   ball->first_child->node->name);
    CHECK_TEXT(texts[1], expected);
    (void)snprintf(expected, sizeof expected, "%s#0 / %s#2 [3] / %s#1 / %s#4", s.root->name, other->name, pair->name,
                   ball->first_child->node->name);
    CHECK_TEXT(texts[11], expected);
    const uint32_t wanted[2] = {1, 11};
    const char *found[2];
    CHECK(world_find_node_paths(&s.world, s.root, (struct primitive_list){wanted, 2}, &s.arena, found, &s.error));
    CHECK_TEXT(found[0], texts[1]);
    CHECK_TEXT(found[1], texts[11]);
    /* A short buffer truncates the text; the full length is returned. */
    struct scene_step step = {s.root, 0};
    char small[4];
    CHECK_EQ_INT(node_path_text(&step, 1, small, sizeof small), strlen(s.root->name) + 2);
    CHECK_EQ_INT(strlen(small), 3);
    stage_end(&s);
}

/* --- the program --- */

static void release(struct test_result result) {
    test_free_result(&result);
}

/* Compares "x":X,"y":Y ... "bytes":[R,G,B] of the first `count` traces with the picture; lines printed by the scene and
 * traces of later pictures are skipped. */
static int compare_lines(const char *scene, const char *lines, const struct test_picture *picture, int count) {
    int compared = 0;
    for (const char *line = lines; *line && compared < count; line = strchr(line, '\n') + 1) {
        unsigned x = 0, y = 0, rgb[3] = {999, 999, 999};
        const char *position = strstr(line, "\"x\":"), *bytes = strstr(line, "\"bytes\":["), *end = strchr(line, '\n');
        if (line[0] != '{' && end)
            continue;
        if (!end || !position || !bytes || bytes > end || sscanf(position, "\"x\":%u,\"y\":%u", &x, &y) != 2 ||
            sscanf(bytes, "\"bytes\":[%u,%u,%u]", &rgb[0], &rgb[1], &rgb[2]) != 3) {
            test_fail(__FILE__, __LINE__, "%s: no story in: %.200s", scene, line);
            return compared;
        }
        const uint8_t *have = picture->rgb + 3 * ((size_t)y * picture->width + x);
        if (have[0] != rgb[0] || have[1] != rgb[1] || have[2] != rgb[2])
            test_fail(__FILE__, __LINE__, "%s: pixel %u,%u is %u %u %u in the picture, told as %u %u %u", scene, x, y,
                      have[0], have[1], have[2], rgb[0], rgb[1], rgb[2]);
        compared++;
    }
    return compared;
}

/* The first picture of a scene, not denoised, and the traces of `count` random pixels. */
static void print_scene(const char *path, uint32_t width, uint32_t height, int count, const char *options) {
    char root[2048], file[4096];
    struct test_random random = {7};
    size_t room = 8192 + (size_t)count * 24, used = 0;
    char *words = malloc(room);
    if (!words || !getcwd(root, sizeof root))
        return;
    const char *format =
        "-q --denoise=none %s --allow-read %s --size %ux%u --shard-pictures 1/1000 -o %s/story-%%d.png %s/%s";
    (void)snprintf(words, room, format, options, root, width, height, test_folder(), root, path);
    struct test_result made = test_gray(NULL, words);
    if (made.status != 0)
        test_fail(__FILE__, __LINE__, "%s: status %d: %s", path, made.status, made.err);
    release(made);
    (void)snprintf(file, sizeof file, "%s/story-1.png", test_folder());
    struct test_picture picture = test_read_picture(file);
    used =
        (size_t)snprintf(words, room, "-q --json --denoise=none %s --allow-read %s --size %ux%u -o story-%%d.png %s/%s",
                         options, root, width, height, root, path);
    for (int i = 0; i < count; i++) {
        uint32_t x = (uint32_t)test_uniform(&random, 0, width), y = (uint32_t)test_uniform(&random, 0, height);
        used += (size_t)snprintf(words + used, room - used, " --pixel %u,%u", x, y);
    }
    struct test_result reported = test_gray(NULL, words);
    if (reported.status != 0)
        test_fail(__FILE__, __LINE__, "%s: status %d: %s", path, reported.status, reported.err);
    if (picture.rgb)
        CHECK_EQ_INT(compare_lines(path, reported.out, &picture, count), count);
    free(picture.rgb);
    free(words);
    release(reported);
}

TEST(what_a_script_prints_after_a_picture_follows_its_pixel_traces) {
    static const char scene[] =
        "local r = gr.node('r')\nr:add_child(gr.geometry('ball', gr.sphere('plain')))\n"
        "for i = 1, 5 do\n"
        "    gr.render{node=r, file='p%d.png', width=40, height=30, eye={0, 0, 4}, view={0, 0, -1}, "
        "up={0, 1, 0}, fov=40, lights={gr.light({4, 5, 6}, {1, 1, 1}, {1, 0, 0})}}\n"
        "    print('after ' .. i)\nend\n";
    char words[8192] = "-q --json scene.lua";
    for (int i = 0; i < 200; i++)
        (void)snprintf(words + strlen(words), sizeof words - strlen(words), " --pixel %d,%d", i % 40, i / 40 * 5);
    struct test_result reported = test_gray_scene(scene, words, NULL);
    CHECK_EQ_INT(reported.status, 0);
    const char *line = reported.out;
    for (int picture = 1; picture <= 5; picture++) {
        char after[20];
        for (int i = 0; i < 200 && line; i++) {
            const char *end = strchr(line, '\n');
            CHECK(end && line[0] == '{' && end[-1] == '}');
            line = end ? end + 1 : NULL;
        }
        (void)snprintf(after, sizeof after, "after %d\n", picture);
        CHECK(line && strncmp(line, after, strlen(after)) == 0);
        line = line ? line + strlen(after) : NULL;
    }
    CHECK(line && *line == '\0');
    release(reported);
}

static int by_name(const void *a, const void *b) {
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static bool is_heavy(const char *name) {
    static const char *const heavy[] = {"03demo.lua", "07demo.lua", "10demo.lua",
                                        "11demo.lua", "14demo.lua", "solids.lua"};
    for (size_t i = 0; i < sizeof heavy / sizeof *heavy; i++)
        if (strcmp(name, heavy[i]) == 0)
            return true;
    return false;
}

/* The scenes of data/; some take seconds even for the smallest picture. */
static void print_demos(uint32_t width, uint32_t height, int count, const char *options, bool heavy) {
    char *names[100];
    int found = 0;
    DIR *folder = opendir("data");
    for (struct dirent *entry; folder && (entry = readdir(folder)) && found < 100;) {
        size_t length = strlen(entry->d_name);
        if (length > 4 && strcmp(entry->d_name + length - 4, ".lua") == 0 && strcmp(entry->d_name, "stage.lua") != 0 &&
            strcmp(entry->d_name, "room.lua") != 0)
            names[found++] = strdup(entry->d_name);
    }
    if (folder)
        (void)closedir(folder);
    CHECK(found >= 14);
    qsort(names, (size_t)found, sizeof *names, by_name);
    for (int i = 0; i < found; i++) {
        char path[300];
        (void)snprintf(path, sizeof path, "data/%s", names[i]);
        if (heavy || !is_heavy(names[i]))
            print_scene(path, width, height, count, options);
        free(names[i]);
    }
}

TEST(traced_pixels_have_the_bytes_of_the_picture_on_the_demos) {
    print_demos(32, 24, 8, "-D quick=true", false);
}

TEST_LONG(a_thousand_traced_pixels_have_the_bytes_of_the_picture_on_every_demo) {
    print_demos(160, 120, 1000, "", true);
}

TEST(traced_pixels_have_the_bytes_of_pictures_with_tone_depth_of_field_and_caustics) {
    print_scene("data/06demo.lua", 40, 30, 20, "--srgb --tone filmic --exposure 1 -full -ss 2");
    print_scene("data/06demo.lua", 40, 30, 20, "--caustics 3000 --pixel-sample corner --specular blinn -use-tir");
}

static const char scene[] =
    "local r = gr.node('root')\n"
    "local m = gr.material({0.8, 0.3, 0.2}, {0.5, 0.5, 0.5}, 20)\n"
    "local ball = gr.geometry('ball', gr.sphere(gr.marble_pnd_material(m, 1, 5, 7, 0, {0.1, 0.2, 0.3})))\n"
    "r:add_child(ball)\n"
    "local lid = gr.geometry('lid', gr.cube(m))\n"
    "lid:scale(4, 0.2, 4) lid:translate(-2, 3, -2)\n"
    "r:add_child(lid)\n"
    "gr.render(r, 'out.png', 21, 21, {0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 40, {0.2, 0.2, 0.2},\n"
    "          {gr.light({0, 9, 0}, {0.9, 0.9, 0.9}, {1, 0, 0}), gr.light({0, 2, 8}, {0.5, 0.5, 0.5}, {1, 0, 0})})\n";

static void says(const struct test_result *result, const char *text) {
    if (!strstr(result->out, text))
        test_fail(__FILE__, __LINE__, "no \"%s\" in:\n%s", text, result->out);
}

TEST(a_pixel_trace_names_nodes_decorators_lights_and_their_occluders) {
    struct test_result result = test_gray_scene(scene, "--pixel 10,9 scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    says(&result, "out.png, pixel 10,9 of 21 x 21");
    says(&result, "meets root#0 / ball#2, sphere, part 0, from outside, at distance 5.0");
    says(&result, "phong: kd (0.8, 0.3, 0.2) ks (0.5, 0.5, 0.5) shininess 20");
    says(&result, "marble: kd (");
    says(&result, "light 1, point light at (0, 9, 0) of (0.9, 0.9, 0.9): distance ");
    says(&result, "blocked by root#0 / lid#4");
    says(&result, "light 2, point light at (0, 2, 8)");
    says(&result, ", seen: (");
    says(&result, "times 255, rounded: ");
    release(result);
    CHECK(access(test_path("out.png"), F_OK) != 0); /* nothing is rendered */
    result = test_gray_scene(NULL, "--pixel 0,0 --deep scene.lua", NULL);
    says(&result, "hits nothing: background, the gradient");
    says(&result, "times 65535, rounded: ");
    release(result);
}

TEST(a_dumped_scene_lists_every_primitive_with_its_path) {
    struct test_result result = test_gray_scene(scene, "--dump-scene scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    says(&result, "out.png: 2 primitives, 0 triangles, 2 materials, 2 lights");
    says(&result, "(-1, -1, -1) to (1, 1, 1)  root#0 / ball#2\n");
    says(&result, "(-2, 3, -2) to (2, 3.2, 2)  root#0 / lid#4\n");
    says(&result, "point light of (0.5, 0.5, 0.5) at (0, 2, 8)");
    release(result);
    result = test_gray_scene(NULL, "--dump-scene --json scene.lua", NULL);
    says(&result, "{\"picture\":\"out.png\",\"primitives\":[{\"number\":1,\"node\":\"root#0 / ball#2\"");
    says(&result, "\"world_from_object\":[4,0,0,-2,0,0.20000000000000001,0,3,0,0,4,-2]");
    release(result);
}

TEST(questions_about_a_scene_go_with_no_other_work) {
    struct test_result result = test_gray_scene(scene, "--pixel 21,0 scene.lua", NULL);
    CHECK_EQ_INT(result.status, 2);
    CHECK(strstr(result.err, "--pixel 21,0 is not in the picture of 21 x 21"));
    release(result);
    static const char *const wrong[] = {"--pixel 3 scene.lua", "--pixel 3,-1 scene.lua", "--json scene.lua",
                                        "--pixel 1,1 --check scene.lua", "--dump-scene --shard 1/2 scene.lua"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        result = test_gray_scene(NULL, wrong[i], NULL);
        CHECK_EQ_INT(result.status, 2);
        release(result);
    }
}
