/* Finishing: bloom, vignette, gray, edges, FXAA and dithering, by closed forms, and whole pictures however they are
 * divided. */
#define _GNU_SOURCE
#include "image/blue_noise_internal.h"
#include "image/finish.h"
#include "image/fxaa_internal.h"
#include "image/png_write.h"
#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

enum { W = 90, H = 70 };
static const struct finish_area all = {0, 0, W, H, W, H};

/* Pixels of a picture; index them by [y * W + x]. */
typedef float pixels[W * H][3];

static void fill_random(pixels p, double lo, double hi, uint64_t seed) {
    struct test_random random = {seed};
    for (int i = 0; i < W * H; i++)
        for (int c = 0; c < 3; c++)
            p[i][c] = (float)test_uniform(&random, lo, hi);
}

static void put(float pixel[3], double r, double g, double b) {
    pixel[0] = (float)r;
    pixel[1] = (float)g;
    pixel[2] = (float)b;
}

static void expect_fxaa_keeps(pixels p) {
    static pixels out;
    fxaa_apply(&all, (const float(*)[3])p, out);
    CHECK(memcmp(out, p, sizeof out) == 0);
}

TEST(fxaa_leaves_constants_and_edges_along_an_axis_alone) {
    struct test_random random = {3};
    static pixels p;
    for (int round = 0; round < 60; round++) {
        double a[3], b[3];
        for (int c = 0; c < 3; c++) {
            a[c] = test_uniform(&random, 0, 1);
            b[c] = round % 3 == 0 ? a[c] : test_uniform(&random, 0, 1);
        }
        int cut = (int)test_uniform(&random, 1, 69);
        for (int i = 0; i < W * H; i++) {
            const double *own = (round % 2 ? i / W : i % W) < cut ? a : b;
            put(p[i], own[0], own[1], own[2]);
        }
        expect_fxaa_keeps(p);
    }
}

/* The coverage of pixel x, y by the half plane y > k x + d, by many points. */
static double coverage(double k, double d, int x, int y) {
    int inside = 0;
    for (int i = 0; i < 256; i++)
        inside += y + (i / 16 + 0.5) / 16 > k * (x + (i % 16 + 0.5) / 16) + d;
    return inside / 256.0;
}

TEST(fxaa_halves_the_error_of_slanting_edges_or_more) {
    static pixels p, out;
    for (int slope = 1; slope < 8; slope++) {
        double k = slope / 24.0, before = 0, after = 0;
        for (int i = 0; i < W * H; i++) {
            double value = i / W + 0.5 > k * (i % W + 0.5) + 20.3;
            put(p[i], value, value, value);
        }
        fxaa_apply(&all, (const float(*)[3])p, out);
        for (int i = 0; i < W * H; i++) {
            double exact = coverage(k, 20.3, i % W, i / W);
            before += fabs((double)p[i][0] - exact);
            after += fabs((double)out[i][0] - exact);
        }
        if (!(after < before / 2))
            test_fail(__FILE__, __LINE__, "slope %g: error %g, before %g", k, after, before);
    }
}

TEST(a_vignette_follows_the_law_of_cosines) {
    static pixels p;
    struct error error;
    for (int i = 0; i < W * H; i++)
        put(p[i], 1, 2, 0.5);
    const struct finish finish = {.vignette = 0.75};
    CHECK(finish_light(&finish, 0, &all, p, &error));
    for (int i = 0; i < W * H; i++) {
        double dx = i % W + 0.5 - W / 2.0, dy = i / W + 0.5 - H / 2.0;
        double cosine = 1 / sqrt(1 + (dx * dx + dy * dy) / (W * W / 4.0 + H * H / 4.0));
        double factor = 0.25 + 0.75 * pow(cosine, 4);
        CHECK_NEAR(p[i][0], factor, 1e-6);
        CHECK_NEAR(p[i][1], 2 * factor, 2e-6);
        CHECK_NEAR(p[i][2], 0.5 * factor, 1e-6);
    }
}

TEST(a_gray_picture_is_the_luminance) {
    static pixels p, q;
    struct error error;
    fill_random(p, -1, 3, 5);
    memcpy(q, p, sizeof p);
    const struct finish finish = {.gray = true};
    CHECK(finish_light(&finish, 0, &all, p, &error));
    for (int i = 0; i < W * H; i++) {
        double y = 0.2126 * (double)q[i][0] + 0.7152 * (double)q[i][1] + 0.0722 * (double)q[i][2];
        for (int c = 0; c < 3; c++)
            CHECK_NEAR(p[i][c], y, 1e-6);
    }
}

TEST(bloom_leaves_pictures_without_light_above_white_alone) {
    static pixels p, q;
    struct error error;
    fill_random(p, 0, 1, 6);
    memcpy(q, p, sizeof p);
    const struct finish finish = {.bloom = 1};
    CHECK(finish_light(&finish, 0, &all, p, &error));
    CHECK(memcmp(p, q, sizeof p) == 0);
    /* An exposure of one stop doubles it. */
    CHECK(finish_light(&finish, 1, &all, p, &error));
    CHECK(memcmp(p, q, sizeof p) != 0);
}

TEST(bloom_adds_its_share_of_the_light_above_white_around_it) {
    static pixels p;
    struct error error;
    memset(p, 0, sizeof p);
    put(p[35 * W + 45], 5, 2.5, 0);
    const struct finish finish = {.bloom = 0.3};
    CHECK(finish_light(&finish, 0, &all, p, &error));
    double sums[3] = {-5, -2.5, 0};
    for (int i = 0; i < W * H; i++)
        for (int c = 0; c < 3; c++)
            sums[c] += (double)p[i][c];
    /* 4/5 of the light is above white. */
    CHECK_NEAR(sums[0], 0.3 * 4, 1e-4);
    CHECK_NEAR(sums[1], 0.3 * 2, 1e-4);
    CHECK_NEAR(sums[2], 0, 0);
    for (int d = 1; d < 9; d++) {
        float right = p[35 * W + 45 + d][0], left = p[35 * W + 45 - d][0], below = p[(35 + d) * W + 45][0];
        CHECK(right == left && right == below && (d == 1 || right <= p[35 * W + 45 + d - 1][0]));
    }
    CHECK(p[0][0] == 0);
}

TEST(edges_of_steps_and_ramps_are_their_gradients) {
    static pixels p, q;
    struct error error;
    const struct finish finish = {.edges = true};
    for (int i = 0; i < W * H; i++) {
        double step = i % W >= 40, ramp = i / W * 0.01;
        put(p[i], step, step, step);
        put(q[i], ramp, ramp, ramp);
    }
    CHECK(finish_display(&finish, &all, p, &error) && finish_display(&finish, &all, q, &error));
    for (int i = 0; i < W * H; i++) {
        int x = i % W, y = i / W;
        for (int c = 0; c < 3; c++) {
            CHECK_NEAR(p[i][c], x == 39 || x == 40, 1e-6);
            CHECK_NEAR(q[i][c], y == 0 || y == H - 1 ? 0.01 : 0.02, 1e-6);
        }
    }
}

TEST(a_part_with_its_rim_is_that_part_of_the_finished_picture) {
    static pixels p, light, display;
    struct error error;
    const struct finish finish = {.bloom = 0.5, .vignette = 0.5, .edges = false, .fxaa = true};
    fill_random(p, 0, 1.5, 8);
    uint32_t rim = finish_rim(&finish, H);
    CHECK(rim > FXAA_RIM && rim < 32);
    memcpy(light, p, sizeof p);
    CHECK(finish_light(&finish, 0.5, &all, light, &error));
    memcpy(display, light, sizeof p);
    CHECK(finish_display(&finish, &all, display, &error));
    const struct finish_area part = {3, 2, W - 3, H - 2, W, H};
    static float cut[(W - 3) * (H - 2)][3];
    for (uint32_t y = 0; y < part.height; y++)
        memcpy(cut[y * part.width], p[(y + part.y0) * W + part.x0], part.width * sizeof *cut);
    CHECK(finish_light(&finish, 0.5, &part, cut, &error));
    CHECK(finish_display(&finish, &part, cut, &error));
    for (uint32_t y = rim; y < part.height; y++)
        for (uint32_t x = rim; x < part.width; x++)
            CHECK(memcmp(cut[y * part.width + x], display[(y + part.y0) * W + x + part.x0], sizeof *cut) == 0);
}

TEST(finishing_is_safe_for_any_number) {
    static const float wild[] = {0, -0.0f, 1, -3, 1e38f, -1e38f, 1e-45f, NAN, INFINITY, -INFINITY};
    static pixels p;
    struct error error;
    struct test_random random = {9};
    for (int i = 0; i < W * H; i++)
        for (int c = 0; c < 3; c++)
            p[i][c] = wild[(int)test_uniform(&random, 0, 10)];
    const struct finish finish = {.bloom = 1, .vignette = 1, .gray = true, .edges = true, .fxaa = true};
    CHECK(finish_light(&finish, 100, &all, p, &error) && finish_light(&finish, -100, &all, p, &error));
    fill_random(p, 0, 1, 2);
    CHECK(finish_display(&finish, &all, p, &error));
    const struct finish_area dot = {0, 0, 1, 1, 1, 1};
    CHECK(finish_light(&finish, 0, &dot, p, &error) && finish_display(&finish, &dot, p, &error));
    for (size_t i = 0; i < sizeof wild / sizeof *wild; i++)
        for (int dither = DITHER_NONE; dither <= DITHER_BLUE; dither++)
            CHECK(wild[i] > 0 || dither_byte((enum dither)dither, 1, 2, (double)wild[i]) == 0);
}

TEST(dithered_bytes_are_next_to_the_number_and_have_its_mean) {
    for (int dither = DITHER_ORDERED; dither <= DITHER_BLUE; dither++) {
        uint32_t side = dither == DITHER_ORDERED ? 8 : 64;
        for (int step = 0; step <= 2550; step += dither == DITHER_BLUE ? 17 : 1) {
            double c = step / 2550.0, sum = 0;
            for (uint32_t y = 0; y < side; y++) {
                for (uint32_t x = 0; x < side; x++) {
                    uint8_t byte = dither_byte((enum dither)dither, x, y, c);
                    CHECK(byte == dither_byte((enum dither)dither, x + 7 * side, y + side, c));
                    CHECK(fabs(byte - 255 * c) < 1);
                    CHECK(step % 10 != 0 || byte == step / 10);
                    sum += byte;
                }
            }
            CHECK_NEAR(sum / (side * side), 255 * c, 0.5 / (side * side) + 1e-9);
        }
    }
    for (int step = 0; step < 100; step++)
        CHECK(dither_byte(DITHER_NONE, 5, 3, step / 99.0) == png_write_byte(step / 99.0));
}

/* The power of a pattern of blue noise at low frequencies is a small part of that of white noise. */
TEST(the_mask_is_blue_noise) {
    enum { SIDE = BLUE_NOISE_SIDE };
    static bool seen[SIDE * SIDE];
    for (int i = 0; i < SIDE * SIDE; i++) {
        CHECK(blue_noise[i] < SIDE * SIDE && !seen[blue_noise[i]]);
        seen[blue_noise[i]] = true;
    }
    for (int level = 1; level < 8; level++) {
        double low = 0, share = level / 8.0, white = share * (1 - share) * SIDE * SIDE;
        int count = 0;
        for (int v = -6; v <= 6; v++) {
            for (int u = 0; u <= 6; u++) {
                if (u * u + v * v > 36 || (u == 0 && v <= 0))
                    continue;
                double re = 0, im = 0;
                for (int i = 0; i < SIDE * SIDE; i++) {
                    double angle = 2 * M_PI * (u * (i % SIDE) + v * (i / SIDE)) / SIDE;
                    double value = blue_noise[i] < share * SIDE * SIDE;
                    re += value * cos(angle);
                    im += value * sin(angle);
                }
                low += re * re + im * im;
                count++;
            }
        }
        if (!(low / count < 0.1 * white))
            test_fail(__FILE__, __LINE__, "level %d: %g of white noise", level, low / count / white);
    }
}

/* --- whole pictures --- */

#define SCENE                                                                                                          \
    "local r = gr.node('root')\n"                                                                                      \
    "r:add_child(gr.geometry('ball', gr.sphere(gr.material({.8, .3, .2}, {5, 5, 5}, 200))))\n"                         \
    "local l = gr.light({4, 5, 6}, {.9, .9, .9}, {1, 0, 0})\n"                                                         \
    "gr.render{node = r, file = 'out.png', width = 230, height = 150, eye = {0, 0, 6}, fov = 40, lights = {l},\n"      \
    "  ambient = {.2, .2, .2}, background = {.3, .5, 2}"
#define FINISHED SCENE ", bloom = .5, vignette = .4, gray = true, edges = true, fxaa = true, dither = 'blue'}\n"

static void put_scenes(void) {
    test_write_text(test_path("scene.lua"), FINISHED);
    test_write_text(test_path("plain.lua"), SCENE "}\n");
}

TEST(options_and_fields_of_finishing_are_the_same) {
    put_scenes();
    test_shell_errors(
        "$gray -q scene.lua && mv out.png a.png && $gray -q plain.lua --bloom .5 --vignette .4 --gray --edges --fxaa "
        "--dither blue && cmp out.png a.png && $gray -q plain.lua && ! cmp -s out.png a.png",
        0, NULL);
    static const char *const each[] = {"--bloom .5", "--vignette .4", "--gray",          "--edges",
                                       "--fxaa",     "--dither blue", "--dither ordered"};
    for (size_t i = 0; i < sizeof each / sizeof *each; i++) {
        char line[200];
        (void)snprintf(line, sizeof line, "$gray -q plain.lua %s -o b.png && ! cmp -s out.png b.png", each[i]);
        test_shell_errors(line, 0, NULL);
    }
}

TEST(finished_pictures_of_shards_and_of_resumed_runs_have_the_bytes_of_one_run) {
    put_scenes();
    test_shell_errors("$gray -q scene.lua -o one.png", 0, NULL);
    test_shell_errors(
        "for i in 1 2 3; do $gray -q scene.lua --shard $i/3; done; $gray merge out.png.*.part && cmp out.png one.png",
        0, NULL);
    test_shell_errors("$gray -q -j 1 scene.lua -ss 12 -full -o two.png", 0, NULL);
    test_shell_errors(
        "$gray -q -j 1 scene.lua -ss 12 -full --checkpoint c --checkpoint-every 0 & p=$!; sleep 0.2; kill -9 $p; "
        "wait $p 2>/dev/null; $gray -q scene.lua -ss 12 -full --checkpoint c --resume && cmp out.png two.png",
        0, NULL);
}

TEST(parts_of_other_finishing_do_not_belong_together) {
    put_scenes();
    test_shell_errors(
        "$gray -q plain.lua --shard 1/2 && $gray -q plain.lua --fxaa --shard 2/2; $gray merge out.png.*.part", 1,
        "it was made with different options");
}

/* The rows of a PNG file that belong to a rectangle of a larger one. */
static void expect_cut(const char *part, const char *whole, uint32_t x0, uint32_t y0) {
    struct test_picture a = test_read_picture(test_path(part)), b = test_read_picture(test_path(whole));
    for (uint32_t y = 0; a.rgb && b.rgb && y < a.height; y++)
        CHECK(memcmp(a.rgb + (size_t)3 * y * a.width, b.rgb + 3 * ((size_t)(y + y0) * b.width + x0),
                     (size_t)3 * a.width) == 0);
    free(a.rgb);
    free(b.rgb);
}

TEST(a_finished_crop_is_exactly_that_part_of_the_finished_picture) {
    put_scenes();
    test_shell_errors(
        "$gray -q scene.lua -write-pre-aa p- -write-aa-targets t- && $gray -q scene.lua --crop 61,30,90,99 -o cut.png "
        "-write-pre-aa p- -write-aa-targets t-",
        0, NULL);
    expect_cut("cut.png", "out.png", 61, 30);
    expect_cut("p-cut.png", "p-out.png", 61, 30);
    expect_cut("t-cut.png", "t-out.png", 61, 30);
}

TEST(floats_have_finished_light_but_no_edges_and_no_dithering) {
    put_scenes();
    test_shell_errors(
        "$gray -q scene.lua -o a.pfm && $gray -q plain.lua --bloom .5 --vignette .4 --gray -o b.pfm && cmp a.pfm "
        "b.pfm && $gray -q plain.lua -o c.pfm && ! cmp -s a.pfm c.pfm && $gray -q plain.lua --edges --fxaa --dither "
        "ordered -o d.pfm && cmp c.pfm d.pfm",
        0, NULL);
    test_shell_errors(
        "$gray -q plain.lua --deep -o a.png && $gray -q plain.lua --deep --dither blue -o b.png && cmp a.png b.png", 0,
        NULL);
}

/* The colours of a PFM file, top row first. */
static bool read_light(const char *name, pixels out) {
    size_t size = 0, bytes = sizeof(pixels);
    char *file = test_read_file(test_path(name), &size);
    bool ok = file && size > bytes;
    for (int y = 0; ok && y < H; y++)
        memcpy(out[(H - 1 - y) * W], file + size - bytes + (size_t)y * bytes / H, bytes / H);
    free(file);
    return ok;
}

TEST(finishing_of_path_traced_pictures_is_that_of_their_light) {
    static pixels light, finished;
    struct error error;
    const struct finish finish = {.bloom = 0.5, .vignette = 0.4};
    put_scenes();
    test_shell_errors(
        "o='-q plain.lua --integrator path --spp 4 --size 90x70'; for d in '' --denoise; do $gray $o $d -o a$d.pfm && "
        "$gray $o $d --bloom .5 --vignette .4 -o b$d.pfm || exit 1; done; $gray $o -o a.png && for f in edges fxaa "
        "gray "
        "'dither blue'; do $gray $o --$f -o b.png && ! cmp -s a.png b.png || exit 1; done",
        0, NULL);
    static const char *const names[][2] = {{"a.pfm", "b.pfm"}, {"a--denoise.pfm", "b--denoise.pfm"}};
    for (int i = 0; i < 2; i++) {
        CHECK(read_light(names[i][0], light) && read_light(names[i][1], finished));
        CHECK(finish_light(&finish, 0, &all, light, &error));
        for (int k = 0; k < W * H; k++)
            for (int c = 0; c < 3; c++)
                CHECK_NEAR((double)finished[k][c], (double)light[k][c], 1e-6);
    }
}

TEST(wrong_values_of_finishing_are_refused) {
    static const struct {
        const char *field, *option, *says, *says_of_option;
    } wrong[] = {
        {"bloom = 1.5", "--bloom 1.5", "scene.lua:4: gr.render: bloom must be between 0 and 1",
         "--bloom needs a number from 0 to 1, not '1.5'"},
        {"bloom = -1", "--bloom nan", "bloom", "--bloom needs a number from 0 to 1, not 'nan'"},
        {"vignette = 2", "--vignette 2", "vignette", "--vignette needs a number from 0 to 1, not '2'"},
        {"dither = 'red'", "--dither red", "dither", "--dither needs one of none|ordered|blue, not 'red'"},
        {"fxaa = 3", "--fxaa=3", "fxaa", "--fxaa"},
        {"gray = 'yes'", "--gray=1", "gray", "--gray"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        char text[2048], line[200];
        (void)snprintf(text, sizeof text, SCENE ", %s}\n", wrong[i].field);
        test_write_text(test_path("scene.lua"), text);
        test_shell_errors("$gray -q scene.lua", 1, wrong[i].says);
        (void)snprintf(line, sizeof line, "$gray -q scene.lua %s", wrong[i].option);
        test_shell_errors(line, 2, wrong[i].says_of_option);
    }
}
