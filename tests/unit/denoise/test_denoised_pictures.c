/* --denoise and layers of light: bytes of denoised pictures do not depend on how they were made, and the sum of the
 * light is the picture. */
#define _GNU_SOURCE
#include "film/aov.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

/* A ball on a floor under a lamp that is seen, with a mirror. */
#define SCENE                                                                                                          \
    "local r = gr.node('root')\n"                                                                                      \
    "r:add_child(gr.plane{normal = {0, 1, 0}, distance = -1, material = gr.material{kd = {.6, .5, .4}}})\n"            \
    "r:add_child(gr.sphere{material = gr.material{kd = {.7, .2, .2}}})\n"                                              \
    "r:add_child(gr.sphere{centre = {2, 0, 0}, material = gr.material{kd = {.1, .1, .1}, ks = {1, 1, 1}, reflect = "   \
    ".8}})\n"                                                                                                          \
    "r:add_child(gr.sphere{centre = {-2, 2.5, 0}, radius = .5, material = gr.material{kd = {0, 0, 0}, emission = "     \
    "{9, 8, 7}}})\n"                                                                                                   \
    "gr.render{node = r, file = 'out.png', width = 90, height = 70, eye = {0, 1, 7}, target = {0, .5, 0}, fov = 45, "  \
    "integrator = 'path', spp = 4, background = {.2, .25, .3}"
#define PLAIN SCENE "}\n"
#define DENOISED SCENE ", denoise = true}\n"

TEST(a_denoised_picture_is_another_one_with_the_same_bytes_however_it_was_made) {
    test_write_text(test_path("scene.lua"), PLAIN);
    test_write_text(test_path("field.lua"), DENOISED);
    test_shell_errors(
        "$gray -q scene.lua -o raw.pfm && $gray -q scene.lua --denoise -o one.pfm && ! cmp -s raw.pfm one.pfm", 0,
        NULL);
    test_shell_errors("$gray -q field.lua -j 3 -o two.pfm && cmp one.pfm two.pfm", 0, NULL);
    test_shell_errors("$gray -q scene.lua --denoise=gray --no-fork -o three.pfm && cmp one.pfm three.pfm", 0, NULL);
    test_shell_errors("for i in 1 2 3; do $gray -q scene.lua --denoise -o four.pfm --shard $i/3; done; "
                      "$gray -q merge four.pfm.*.part && cmp one.pfm four.pfm",
                      0, NULL);
    test_shell_errors(
        "$gray -q scene.lua --denoise --aov raw,variance -o five.pfm && cmp one.pfm five.pfm && cmp raw.pfm "
        "five.raw.pfm && test -s five.variance.pfm",
        0, NULL);
}

/* Of a PFM file of that width: whether its rectangle is the other file. */
static bool is_part(const char *whole, int width, int height, int x0, int y0, const char *part, int part_width,
                    int part_height) {
    size_t whole_size = 0, part_size = 0;
    char *a = test_read_file(test_path(whole), &whole_size), *b = test_read_file(test_path(part), &part_size);
    size_t row = (size_t)part_width * 12;
    bool same = a && b && whole_size > (size_t)(width * height * 12) && part_size > row * (size_t)part_height;
    for (int y = 0; same && y < part_height; y++) {
        const char *p = a + whole_size - (size_t)((y0 + y + 1) * width - x0) * 12; /* from the bottom */
        same = memcmp(p, b + part_size - (size_t)(y + 1) * row, row) == 0;
    }
    free(a);
    free(b);
    return same;
}

TEST(a_crop_is_denoised_as_the_whole_picture) {
    test_write_text(test_path("scene.lua"), PLAIN);
    test_shell_errors(
        "$gray -q scene.lua --denoise -o whole.pfm && $gray -q scene.lua --denoise --crop 41,33,20,11 -o part.pfm", 0,
        NULL);
    CHECK(is_part("whole.pfm", 90, 70, 41, 33, "part.pfm", 20, 11));
    test_shell_errors(
        "for i in 1 2; do $gray -q scene.lua --denoise --crop 41,33,20,11 -o merged.pfm --shard $i/2; done; "
        "$gray -q merge merged.pfm.*.part && cmp part.pfm merged.pfm",
        0, NULL);
    test_shell_errors("$gray -q scene.lua --denoise --crop 41,33,20,11 --aov raw,depth -o layers.pfm && "
                      "$gray -q scene.lua --crop 41,33,20,11 --aov depth -o raw.pfm && cmp raw.pfm layers.raw.pfm && "
                      "cmp raw.depth.pfm layers.depth.pfm",
                      0, NULL);
}

/* relMSE of a picture of size x size pixels: the mean of (x - r)^2 / (r^2 + .01). */
static double error_of(const char *name, const char *reference, int size) {
    size_t count = (size_t)(3 * size * size), bytes = count * sizeof(float), sizes[2] = {0, 0};
    char *files[2] = {test_read_file(test_path(name), &sizes[0]), test_read_file(test_path(reference), &sizes[1])};
    double sum = 0;
    CHECK(files[0] && files[1] && sizes[0] > bytes && sizes[1] > bytes);
    for (size_t i = 0; i < count; i++) {
        float x, r;
        memcpy(&x, files[0] + sizes[0] - bytes + i * sizeof x, sizeof x);
        memcpy(&r, files[1] + sizes[1] - bytes + i * sizeof r, sizeof r);
        sum += ((double)x - (double)r) * ((double)x - (double)r) / ((double)r * (double)r + 0.01);
    }
    free(files[0]);
    free(files[1]);
    return sum / (double)count;
}

/* The glass reflects a bright wall and shows a dark one. Chance chooses for each sample; the share of reflection, which
 * has no noise, tells the denoiser where the rim is. Without it, more than a fifth would remain. */
TEST(denoising_leaves_less_than_a_fifth_of_the_error_of_glass_between_bright_and_dark_walls) {
    double raw = 0, denoised = 0;
    test_write_text(
        test_path("glass.lua"),
        "local n = gr.node('n')\n"
        "local function wall(z, v) n:add_child(gr.rectangle{corner = {-20, -20, z}, along = {40, 0, 0}, "
        "up = {0, 40, 0}, material = gr.material{two_sided = true, kd = {.5, .5, .5}, emission = {v, v, v}}}) end\n"
        "wall(-6, .05) wall(6, 1)\n"
        "n:add_child(gr.sphere{material = gr.difresnel_material(gr.rr_material({0, 0, 0}, {1, 1, 1}, 150, 1, 1, "
        "1.5))})\n"
        "gr.render{node = n, file = 'g.png', width = 48, height = 48, integrator = 'path', max_depth = 6, eye = {0, 0, "
        "4}, target = {0, 0, 0}, fov = 35, background = {0, 0, 0}}\n");
    test_shell_errors(
        "$gray -q glass.lua --spp 512 --seed 9 -o reference.pfm && for i in 1 2 3; do $gray -q glass.lua --spp 16 "
        "--seed $i --denoise --aov raw -o $i.pfm || exit 1; done",
        0, NULL);
    for (int seed = 1; seed <= 3; seed++) {
        char names[2][32];
        (void)snprintf(names[0], sizeof names[0], "%d.pfm", seed);
        (void)snprintf(names[1], sizeof names[1], "%d.raw.pfm", seed);
        denoised += error_of(names[0], "reference.pfm", 48);
        raw += error_of(names[1], "reference.pfm", 48);
    }
    CHECK(denoised < raw / 5);
}

/* The guides have the colours under a gloss, a coat and on a metal. Without them, these squares had 4 to 11 times the
 * error of matt ones. */
TEST(a_texture_under_gloss_or_coat_or_of_a_metal_is_denoised_as_sharply_as_a_matt_one) {
    static const char *const layers[] = {"specular_weight = 0", "specular_roughness = .35",
                                         "coat_weight = 1, coat_roughness = .3",
                                         "base_metalness = 1, specular_roughness = .6"};
    double errors[4];
    for (int i = 0; i < 4; i++) {
        char text[2048];
        (void)snprintf(
            text, sizeof text,
            "local function squares(p) return gr.mix(gr.vec(.8, .8, .7), gr.vec(.1, .2, .5), gr.step(.5, (p.x * 6 // 1 "
            "+ "
            "p.y * 6 // 1) %% 2)) end\n"
            "gr.render{node = gr.rectangle{corner = {-2, -2, 0}, along = {4, 0, 0}, up = {0, 4, 0}, material = "
            "gr.openpbr_material{base_color = squares, %s}}, file = 'g.png', width = 40, height = 40, integrator "
            "= 'path', max_depth = 3, eye = {0, 0, 5}, target = {0, 0, 0}, fov = 20, background = {0, 0, 0}, lights = "
            "{gr.area_light{corner = {-5, 3, 5}, v1 = {3, 0, 0}, v2 = {0, 2, 1}, emission = {9, 8, 7}}, "
            "gr.sky_light{sky = {.3, .3, .4}}}}\n",
            layers[i]);
        test_write_text(test_path("squares.lua"), text);
        test_shell_errors("$gray -q squares.lua --spp 128 --seed 9 -o reference.pfm && $gray -q squares.lua --spp 4 "
                          "--denoise -o a.pfm",
                          0, NULL);
        errors[i] = error_of("a.pfm", "reference.pfm", 40);
    }
    for (int i = 1; i < 4; i++)
        CHECK(errors[i] < 1.5 * errors[0]);
}

/* Of a PFM file of that size: the mean of its red values. */
static double mean_of(const char *name, int width, int height) {
    size_t count = (size_t)(3 * width * height), bytes = count * sizeof(float), size = 0;
    char *file = test_read_file(test_path(name), &size);
    double sum = 0;
    CHECK(file && size > bytes);
    for (size_t i = 0; i < count; i += 3) {
        float x;
        memcpy(&x, file + size - bytes + i * sizeof x, sizeof x);
        sum += (double)x;
    }
    free(file);
    return 3 * sum / (double)count;
}

/* The floor beside a ball of glass, with the light that the ball focuses. Paths that meet the lamp by chance lose a
 * third of it to the clamp. */
TEST(caustics_of_photons_pass_the_clamp_and_the_denoiser) {
    test_write_text(
        test_path("glass.lua"),
        "local n = gr.node('n')\n"
        "n:add_child(gr.plane{normal = {0, 1, 0}, distance = -1, material = gr.openpbr_material{base_color = {.7, .7, "
        ".7}}})\n"
        "n:add_child(gr.sphere{material = gr.openpbr_material{transmission_weight = 1, specular_roughness = 0}})\n"
        "gr.render{node = n, file = 'g.png', width = 40, height = 30, integrator = 'path', spp = 16, eye = {1.35, 4, "
        "2.2}, "
        "target = {1.35, -1, .9}, fov = 22, background = {.05, .05, .06}, lights = {gr.spherical_light{position = {-6, "
        "9, "
        "-4}, radius = .5, emission = {190, 180, 160}}, gr.sky_light{sky = {.05, .05, .06}}}}\n");
    test_shell_errors("$gray -q glass.lua --spp 128 --caustics 60000 -o reference.pfm && "
                      "$gray -q glass.lua --caustics 60000 --clamp 3 --denoise -o photons.pfm && "
                      "$gray -q glass.lua --clamp 3 --denoise -o paths.pfm",
                      0, NULL);
    const double reference = mean_of("reference.pfm", 40, 30);
    CHECK_NEAR(mean_of("photons.pfm", 40, 30), reference, 0.03 * reference);
    CHECK(mean_of("paths.pfm", 40, 30) < 0.9 * reference);
}

TEST(denoise_none_leaves_the_noise_of_a_scene_that_asks_for_denoising) {
    test_write_text(test_path("scene.lua"), PLAIN);
    test_write_text(test_path("asks.lua"), DENOISED);
    test_shell_errors(
        "$gray -q scene.lua -o raw.pfm && $gray -q asks.lua -o denoised.pfm && ! cmp -s raw.pfm denoised.pfm && "
        "$gray -q asks.lua --denoise=none -o none.pfm && cmp raw.pfm none.pfm",
        0, NULL);
}

TEST(merge_denoises_parts_with_features_unless_denoise_none_leaves_the_noise) {
    test_write_text(test_path("scene.lua"), PLAIN);
    test_shell_errors(
        "$gray -q scene.lua -o raw.pfm && $gray -q scene.lua --denoise -o denoised.pfm && for i in 1 2; do $gray -q "
        "scene.lua --denoise -o a.pfm --shard $i/2 && $gray -q scene.lua -o b.pfm --shard $i/2 || exit 1; done",
        0, NULL);
    test_shell_errors(
        "$gray merge -q a.pfm.*.part && cmp a.pfm denoised.pfm && $gray merge -q --denoise a.pfm.*.part && "
        "cmp a.pfm denoised.pfm && $gray merge -q --denoise=none a.pfm.*.part && cmp a.pfm raw.pfm && "
        "$gray merge -q --denoise=none b.pfm.*.part && cmp b.pfm raw.pfm && rm b.pfm",
        0, NULL);
    test_shell_errors("$gray merge --denoise b.pfm.*.part", 2,
                      "b.pfm: its parts cannot be denoised: they were rendered without --denoise\n");
    test_shell_errors("test -e b.pfm", 1, NULL);
}

/* The line about samples is printed when rendering is over. Denoising then takes seconds. */
TEST(a_signal_ends_denoising_at_once) {
    test_write_text(test_path("scene.lua"), PLAIN);
    for (int i = 0; i < 2; i++) {
        static const char *const names[] = {"TERM", "HUP"};
        char line[512];
        (void)snprintf(
            line, sizeof line,
            "rm -f said; $gray scene.lua --denoise --time-limit 0.01 --size 800x600 -o big.png 2>said & p=$!; "
            "await 'grep -q \"per pixel\" said'; kill -%s $p; wait "
            "$p; s=$?; cat said >&2; test -e big.png && exit 1; exit $s",
            names[i]);
        test_shell_errors(line, 130, "gray: interrupted, big.png is not written\n");
    }
}

/* A stand-in that never answers. What was rendered is kept, and another denoiser continues with it. */
TEST(a_signal_ends_the_program_that_denoises_and_the_tiles_are_kept) {
    test_write_text(test_path("scene.lua"), PLAIN);
    test_shell_errors(
        "mkdir bin tmp && printf '#!/bin/sh\\ntouch ../../started\\nexec sleep 100\\n' > bin/oidnDenoise && chmod +x "
        "bin/oidnDenoise && $gray -q scene.lua --denoise -o one.pfm && $gray -q scene.lua -o raw.png",
        0, NULL);
    test_shell_errors(
        "PATH=$PWD/bin:$PATH TMPDIR=$PWD/tmp $gray scene.lua --denoise=oidn -o a.pfm --checkpoint c & p=$!; "
        "await 'test -e started'; kill -TERM $p; wait $p; s=$?; test -e a.pfm && "
        "exit 1; rmdir tmp && exit $s",
        130,
        "gray: interrupted, a.pfm is not written\ngray: notice: c holds 9 of 9 tiles of a.pfm (--resume continues)\n");
    test_shell_errors(
        "$gray -q scene.lua --denoise -o a.pfm --checkpoint c --resume && cmp a.pfm one.pfm && rm started && mkdir "
        "tmp && ! test -e c",
        0, NULL);
    test_shell_errors("PATH=$PWD/bin:$PATH TMPDIR=$PWD/tmp $gray scene.lua --denoise=oidn -o a.png --partial & p=$!; "
                      "await 'test -e started'; kill -TERM $p; wait $p; s=$?; test -e a.png && "
                      "exit 1; $gray compare -q a.partial.png raw.png && exit $s",
                      130, "gray: notice: a.partial.png holds 9 of 9 tiles");
}

/* The stand-in looks at its arguments and its files, and answers with the albedo. */
TEST(open_image_denoise_is_given_three_pictures_and_its_answer_is_the_picture) {
    test_write_text(test_path("scene.lua"), PLAIN);
    test_shell_errors(
        "mkdir bin && printf '#!/bin/sh\\ntest \"$*\" = \"--hdr colour.pfm --alb albedo.pfm --nrm normal.pfm -o "
        "denoised.pfm\" && head -c 2 colour.pfm | grep -q PF && test -s normal.pfm && cp albedo.pfm denoised.pfm\\n' "
        "> bin/oidnDenoise && chmod +x bin/oidnDenoise",
        0, NULL);
    test_shell_errors(
        "mkdir tmp; PATH=$PWD/bin:$PATH TMPDIR=$PWD/tmp $gray -q scene.lua --denoise=oidn -o out.pfm && rmdir tmp", 0,
        NULL);
    test_shell_errors("$gray -q scene.lua --denoise -o own.pfm && ! cmp -s own.pfm out.pfm", 0, NULL);
    test_shell_errors(
        "printf '#!/bin/sh\\nexit 3\\n' > bin/oidnDenoise; PATH=$PWD/bin:$PATH $gray -q scene.lua --denoise=oidn", 3,
        "--denoise=oidn: oidnDenoise failed (status 3)\n");
    test_shell_errors(
        "printf '#!/bin/sh\\nexit 0\\n' > bin/oidnDenoise; PATH=$PWD/bin:$PATH $gray -q scene.lua --denoise=oidn", 3,
        "--denoise=oidn: oidnDenoise wrote no PFM file that gray can read\n");
    test_shell_errors(
        "printf '#!/bin/sh\necho text > denoised.pfm\n' > bin/oidnDenoise; PATH=$PWD/bin:$PATH $gray -q scene.lua "
        "--denoise=oidn",
        3, "--denoise=oidn: oidnDenoise wrote no PFM file that gray can read\n");
    test_shell_errors(
        "printf '#!/bin/sh\nprintf \"PF\\n1 1\\n-1.0\\n0123456789ab\" > denoised.pfm\n' > bin/oidnDenoise; "
        "PATH=$PWD/bin:$PATH $gray -q scene.lua --denoise=oidn",
        3, "oidnDenoise made a picture of 1 x 1 pixels instead of ");
    test_shell_errors("PATH=$PWD/none $gray -q scene.lua --denoise=oidn", 3,
                      "--denoise=oidn: there is no program oidnDenoise on PATH\n");
    test_shell_errors("$gray --denoise=other scene.lua", 2, "--denoise needs one of auto|none|gray|oidn, not 'other'");
}

TEST(the_raw_layer_is_the_picture_without_denoising_in_every_format) {
    test_write_text(test_path("scene.lua"), PLAIN);
    test_shell_errors(
        "for e in png pfm hdr; do for more in --seed=1 --deep '--exposure=1 --tone=filmic' --colour=classic; do "
        "$gray -q scene.lua --denoise --aov raw $more -o layers.$e && $gray -q scene.lua $more -o noisy.$e && "
        "cmp noisy.$e layers.raw.$e || exit 9; done; done; ! cmp -s layers.png layers.raw.png",
        0, NULL);
}

TEST(layers_of_light_belong_to_the_path_tracer) {
    test_write_text(test_path("scene.lua"), PLAIN);
    test_shell_errors(
        "$gray -q scene.lua --aov all && ls out.transmission_indirect.png out.raw.png out.depth.png >ls.txt", 0, NULL);
    test_write_text(test_path("whitted.lua"), "gr.render(gr.node('r'), 'w.png', 4, 4, {0, 0, 5}, {0, 0, -1}, "
                                              "{0, 1, 0}, 40, {1, 1, 1}, {})\n");
    test_shell_errors("$gray -q whitted.lua --aov all && test ! -e w.raw.png && test -e w.lights.png", 0, NULL);
    test_shell_errors("$gray -q whitted.lua --aov emission", 2, "--aov emission is a layer of --integrator path only");
}

static const float *layer(const struct stage *s, enum aov aov, size_t at) {
    return s->film.layers[aov_layer(s->film.layer_mask, aov) * s->film.width * s->film.height + at];
}

/* Diffuse, glossy, mirroring and clear balls under a lamp, in a box that closes the scene. The picture and each layer
 * are rounded to float: 8 roundings of at most 2^-24 of the picture. */
static void check_layers_of_light(enum stereo stereo) {
    enum { SIZE = 40 };
    struct stage s;
    stage_begin(&s, 2);
    struct material *glossy = stage_phong(&s, colour_make(0.2, 0.1, 0.1), colour_make(0.5, 0.6, 0.7), 10);
    struct material *area_light = stage_phong(&s, colour_all(0), colour_all(0), 1);
    area_light->phong.emission = colour_make(5, 4, 3);
    const struct material *materials[] = {stage_phong(&s, colour_make(0.7, 0.6, 0.2), colour_all(0), 1), glossy,
                                          stage_glass(&s, 1, 0, 1), stage_glass(&s, 1, 1, 1.5), area_light};
    for (int i = 0; i < 5; i++)
        stage_move(&s, stage_sphere(&s, s.root, materials[i]), 2.2 * (i - 2), i == 4 ? 1.5 : 0, 0);
    struct node *wall = stage_cube(&s, s.root, materials[0]);
    stage_scale(&s, wall, 30, 30, 1);
    stage_move(&s, wall, -15, -15, -5);
    s.settings.integrator = INTEGRATOR_PATH;
    s.settings.path_samples = 16;
    s.settings.aov = AOV_PATH;
    s.settings.lens.stereo = stereo;
    CHECK(stage_render(&s, SIZE, SIZE));
    double sums[AOV_COUNT] = {0};
    for (size_t i = 0; i < SIZE * SIZE; i++)
        for (int c = 0; c < 3; c++) {
            double sum = 0, picture = (double)s.film.pixels[i].rgb[c];
            for (int aov = AOV_EMISSION; aov < AOV_COUNT; aov++) {
                sum += (double)layer(&s, (enum aov)aov, i)[c];
                sums[aov] += (double)layer(&s, (enum aov)aov, i)[c];
            }
            CHECK_NEAR(sum, picture, 8 * 0x1p-24 * picture);
            CHECK(layer(&s, AOV_RAW, i)[c] == s.film.pixels[i].rgb[c] && layer(&s, AOV_VARIANCE, i)[c] >= 0);
        }
    /* Into a ball and out of it are two events; there is no medium. */
    for (int aov = AOV_EMISSION; aov < AOV_VOLUME_DIRECT; aov++)
        CHECK(aov == AOV_TRANSMISSION_DIRECT || sums[aov] > 0);
    stage_end(&s);
}

TEST(the_sum_of_the_layers_of_light_is_the_picture) {
    check_layers_of_light(STEREO_NONE);
}

TEST(the_sum_of_the_layers_of_light_is_the_picture_for_two_eyes_in_two_colours) {
    check_layers_of_light(STEREO_ANAGLYPH);
}

/* At depth 1 there is no indirect light, at depth 0 only emission. */
TEST(layers_of_light_follow_the_depth_of_paths) {
    for (int depth = 0; depth < 2; depth++) {
        struct stage s;
        stage_begin(&s, 1);
        struct material *area_light = stage_phong(&s, colour_all(0.5), colour_all(0), 1);
        area_light->phong.emission = colour_all(1);
        stage_sphere(&s, s.root, area_light);
        stage_move(&s, stage_sphere(&s, s.root, area_light), 1.5, 0, 0);
        s.settings.integrator = INTEGRATOR_PATH;
        s.settings.path_samples = 4;
        s.settings.max_depth = depth;
        s.settings.aov = AOV_LIGHT;
        CHECK(stage_render(&s, 24, 24));
        double direct = 0, indirect = 0;
        for (size_t i = 0; i < 24 * 24; i++) {
            direct += (double)layer(&s, AOV_DIFFUSE_DIRECT, i)[0];
            indirect += (double)layer(&s, AOV_DIFFUSE_INDIRECT, i)[0];
        }
        CHECK(indirect == 0 && (direct > 0) == (depth == 1));
        stage_end(&s);
    }
}
