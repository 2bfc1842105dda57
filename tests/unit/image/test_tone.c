/* Output values: transfer curves, 16-bit PNG, PFM, Radiance HDR. */
#include "image/exr.h"
#include "image/float_write.h"
#include "image/image.h"
#include "image/png_write.h"
#include "image/tone.h"
#include "image/tone_lookup.h"
#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

TEST(tone_curves_follow_their_formulas) {
    struct tone tone = {0};
    CHECK(tone_is_plain(&tone));
    CHECK_NEAR(tone_apply(&tone, 1.7), 1.7, 0);
    tone.exposure = 2.5;
    CHECK_NEAR(tone_apply(&tone, 0.3), 0.3 * pow(2, 2.5), 1e-15);
    tone = (struct tone){.curve = TONE_REINHARD};
    CHECK_NEAR(tone_apply(&tone, 3), 0.75, 1e-15);
    tone.curve = TONE_FILMIC;
    CHECK_NEAR(tone_apply(&tone, 1), 2.54 / 3.16, 1e-15);
    /* Values of the standard: 0.5 is 0.735357, 0.001 is on the straight part; the ends stay. */
    tone = (struct tone){.srgb = true};
    CHECK_NEAR(tone_apply(&tone, 0.5), 0.735357, 1e-6);
    CHECK_NEAR(tone_apply(&tone, 0.001), 0.01292, 1e-12);
    CHECK_NEAR(tone_apply(&tone, 1), 1, 1e-12);
    CHECK_NEAR(tone_apply(&tone, 0), 0, 0);
}

TEST(tone_curves_rise_and_stay_below_their_limit) {
    for (int curve = TONE_REINHARD; curve <= TONE_FILMIC; curve++) {
        struct tone tone = {.curve = (enum tone_curve)curve};
        double before = -1;
        for (double c = 0; c < 1e6; c = c * 1.1 + 1e-3) {
            double now = tone_apply(&tone, c);
            CHECK(now > before && now < 1.04);
            before = now;
        }
    }
}

/* --- tone curves by functions --- */

static double gamma_curve(double x) {
    return pow(x, 1 / 2.4);
}
static double reinhard_curve(double x) {
    return tone_apply(&(struct tone){.curve = TONE_REINHARD}, x);
}
static double filmic_curve(double x) {
    return tone_apply(&(struct tone){.curve = TONE_FILMIC}, x);
}
static double same_curve(double x) {
    return x;
}

static void fill_table(struct tone_table *table, double (*curve)(double x)) {
    for (int i = 0; i < TONE_ENTRIES; i++)
        table->values[i] = (float)curve(tone_table_light(i));
}

TEST(lights_of_a_table_rise_from_0_to_65280_by_at_most_a_128th) {
    CHECK(tone_table_light(0) == 0 && tone_table_light(1) == 0x1p-22 && tone_table_light(128) == 0x1p-15);
    CHECK(tone_table_light(TONE_ENTRIES - 1) == 65280);
    for (int i = 1; i < TONE_ENTRIES; i++) {
        double light = tone_table_light(i), before = tone_table_light(i - 1);
        CHECK(light > before && (double)(float)light == light);
        CHECK(i <= 128 ? light - before == 0x1p-22 : light - before <= before / 128);
    }
}

TEST(the_table_of_the_identity_changes_no_float) {
    static struct tone_table table;
    const struct tone tone = {.curve = TONE_FUNCTION, .table = &table};
    struct test_random random = {18};
    fill_table(&table, same_curve);
    for (int i = 0; i < 1000000; i++) {
        double light = (double)(float)exp(test_uniform(&random, -30, log(65280)));
        if (tone_apply(&tone, light) != light)
            test_fail(__FILE__, __LINE__, "%.17g becomes %.17g", light, tone_apply(&tone, light));
    }
    for (int i = 0; i < TONE_ENTRIES; i++)
        CHECK(tone_apply(&tone, tone_table_light(i)) == tone_table_light(i));
    CHECK_NEAR(tone_table_slope(&table), 1, 0);
}

TEST(tables_of_usual_curves_are_within_half_a_level_of_them) {
    static struct tone_table table;
    const struct tone tone = {.curve = TONE_FUNCTION, .table = &table};
    static double (*const curves[])(double x) = {reinhard_curve, filmic_curve, gamma_curve};
    for (int k = 0; k < 3; k++) {
        double levels = curves[k] == gamma_curve ? 255 : 65535;
        fill_table(&table, curves[k]);
        for (double light = 0; light < 60000; light = light * 1.0007 + 1e-9)
            CHECK_NEAR(tone_apply(&tone, light), curves[k](light), 0.5 / levels);
    }
}

TEST(a_table_holds_beside_its_lights_and_leaves_nan) {
    static struct tone_table table;
    const struct tone tone = {.exposure = 1, .curve = TONE_FUNCTION, .table = &table};
    for (int i = 0; i < TONE_ENTRIES; i++)
        table.values[i] = (float)(i + 1);
    CHECK(tone_apply(&tone, -1) == 1 && tone_apply(&tone, -INFINITY) == 1 && tone_apply(&tone, 0) == 1);
    CHECK(tone_apply(&tone, 32640) == 4096 && tone_apply(&tone, 1e300) == 4096 && tone_apply(&tone, INFINITY) == 4096);
    CHECK(isnan(tone_apply(&tone, NAN)));
    CHECK_NEAR(tone_apply(&tone, 0x1p-24), 1.5, 0); /* exposure comes first */
    CHECK_NEAR(tone_table_slope(&table), 0x1p22, 0);
    CHECK(!tone_is_plain(&tone));
}

/* Light of all strengths up to 6: a lamp seen from near, a bright sky, shadows. */
#define LIT_SCENE                                                                                                      \
    "local r, m = gr.node('root'), gr.material({.8, .5, .3}, {.6, .6, .6}, 20)\n"                                      \
    "r:add_child(gr.geometry('ball', gr.sphere(m)))\n"                                                                 \
    "r:add_child(gr.box{min = {-3, -1.3, -3}, max = {3, -1, 3}, material = m})\n"                                      \
    "local l = gr.light({2, 3, 2}, {6, 5, 4}, {.2, 0, .1})\n"                                                          \
    "local function picture(file, tone)\n"                                                                             \
    "  gr.render{node = r, file = file, width = 150, height = 100, eye = {0, 1, 5}, target = {0, 0, 0}, lights = "     \
    "{l},\n"                                                                                                           \
    "    ambient = {.2, .2, .2}, background = {.3, 2, 6}, exposure = .3, tone = tone}\n"                               \
    "end\n"

static void run_scene(const char *script, const char *options) {
    struct test_result result = test_gray_scene(script, options, NULL);
    if (result.status != 0)
        test_fail(__FILE__, __LINE__, "%s", result.err);
    test_free_result(&result);
}

/* The largest difference of bytes. */
static int largest_difference(const char *one, const char *other) {
    struct test_picture a = test_read_picture(test_path(one)), b = test_read_picture(test_path(other));
    int max = 0;
    CHECK(a.width == b.width && a.height == b.height);
    for (size_t i = 0; i < (size_t)3 * a.width * a.height; i++)
        max = abs(a.rgb[i] - b.rgb[i]) > max ? abs(a.rgb[i] - b.rgb[i]) : max;
    free(a.rgb);
    free(b.rgb);
    return max;
}

TEST(pictures_through_a_function_are_those_of_the_same_curve) {
    run_scene(LIT_SCENE "picture('none.png', 'none')\n"
                        "picture('same.png', function(x) return x end)\n"
                        "picture('reinhard.png', 'reinhard')\n"
                        "picture('by_hand.png', function(x) return x / (1 + x) end)\n"
                        "local calls = 0\n"
                        "picture('half.png', function(x) calls = calls + 1 return math.min(x, 1) / 2 end)\n"
                        "assert(calls == 4096)\n",
              "-q scene.lua");
    CHECK_EQ_INT(largest_difference("none.png", "same.png"), 0);
    CHECK(largest_difference("reinhard.png", "by_hand.png") <= 1);
    CHECK(largest_difference("none.png", "reinhard.png") > 50);
    struct test_picture half = test_read_picture(test_path("half.png"));
    uint8_t max = 0;
    for (size_t i = 0; i < (size_t)3 * half.width * half.height; i++)
        max = half.rgb[i] > max ? half.rgb[i] : max;
    CHECK_EQ_INT(max, 128);
    free(half.rgb);
}

TEST(tone_on_the_command_line_wins_over_functions_and_words) {
    static const char script[] = LIT_SCENE "picture('function.png', function(x) return x * x end)\n"
                                           "picture('word.png', 'filmic')\n"
                                           "picture('option.png')\n";
    run_scene(script, "-q --tone none scene.lua");
    CHECK_EQ_INT(largest_difference("function.png", "option.png"), 0);
    run_scene(script, "-q --tone reinhard scene.lua");
    CHECK_EQ_INT(largest_difference("function.png", "option.png"), 0);
    CHECK_EQ_INT(largest_difference("word.png", "option.png"), 0);
}

TEST(a_steep_tone_function_traces_the_rays_that_it_shows) {
    static const char script[] =
        LIT_SCENE "local mirror = gr.material{kd = {0, 0, 0}, ks = {1, 1, 1}, shininess = 9, reflect = REFLECT}\n"
                  "r:add_child(gr.sphere{centre = {-1.5, 0, 1}, radius = .8, material = mirror})\n"
                  "picture('all.png', function(x) return 2e4 * x end)\n";
    run_scene(script, "-q -D REFLECT=0.00001 --cutoff 0 scene.lua");
    CHECK(rename(test_path("all.png"), test_path("every.png")) == 0);
    run_scene(script, "-q -D REFLECT=0 --cutoff 0 scene.lua");
    CHECK(largest_difference("all.png", "every.png") > 20);
    run_scene(script, "-q -D REFLECT=0.00001 scene.lua");
    CHECK(largest_difference("all.png", "every.png") <= 1);
}

enum { W = 300, H = 7 };

static float light(uint32_t x, uint32_t y, int channel) {
    if (y == 3) /* long runs */
        return channel == 1 ? 0 : 0.5f;
    if (y == 4)
        return 0;
    return (float)(ldexp(1 + (double)(x * 7 + y * 13 + (unsigned)channel * 29) / 4096,
                         (int)(x / (y == 5 ? 1 : 40)) % 60 - 30));
}

static void light_row(void *context, uint32_t y, float *line) {
    uint32_t width = *(uint32_t *)context;
    for (uint32_t x = 0; x < width; x++)
        for (int c = 0; c < 3; c++)
            line[3 * x + (uint32_t)c] = light(x, y, c);
}

TEST(pfm_holds_the_very_floats_from_the_bottom_up) {
    char path[512], header[32];
    uint32_t width = W;
    struct error error = {0};
    (void)snprintf(path, sizeof path, "%s/a.pfm", test_folder());
    CHECK(pfm_write(FILE_AT(path), W, H, light_row, &width, &error));
    size_t size, start = (size_t)snprintf(header, sizeof header, "PF\n%d %d\n-1.0\n", W, H);
    char *file = test_read_file(path, &size);
    CHECK_EQ_INT(size, start + W * H * 12);
    CHECK(memcmp(file, header, start) == 0);
    for (uint32_t y = 0; y < H; y++) {
        for (uint32_t x = 0; x < W; x++) {
            float rgb[3];
            memcpy(rgb, file + start + ((size_t)(H - 1 - y) * W + x) * 12, 12);
            CHECK(rgb[0] == light(x, y, 0) && rgb[1] == light(x, y, 1) && rgb[2] == light(x, y, 2));
        }
    }
    free(file);
}

/* An independent reader, from the format's description. */
static void read_hdr(const uint8_t *data, size_t size, uint32_t width, uint8_t *pixels) {
    size_t at = 0;
    for (uint32_t y = 0; y < H; y++) {
        uint8_t *row = pixels + (size_t)y * width * 4;
        if (width < 8) {
            memcpy(row, data + at, (size_t)width * 4);
            at += (size_t)width * 4;
            continue;
        }
        CHECK(data[at] == 2 && data[at + 1] == 2 && data[at + 2] == width >> 8 && data[at + 3] == (width & 255));
        at += 4;
        for (uint32_t c = 0; c < 4; c++) {
            for (uint32_t x = 0; x < width;) {
                uint32_t count = data[at++];
                bool run = count > 128;
                count = run ? count - 128 : count;
                CHECK(count > 0 && x + count <= width && at < size);
                for (uint32_t i = 0; i < count; i++)
                    row[4 * (x + i) + c] = data[run ? at : at + i];
                at += run ? 1 : count;
                x += count;
            }
        }
    }
    CHECK_EQ_INT(at, size);
}

TEST(radiance_pictures_read_back_within_their_mantissa) {
    static const uint32_t widths[] = {W, 8, 5};
    for (int i = 0; i < 3; i++) {
        char path[512], header[128];
        uint32_t width = widths[i];
        struct error error = {0};
        (void)snprintf(path, sizeof path, "%s/a.hdr", test_folder());
        CHECK(hdr_write(FILE_AT(path), width, H, light_row, &width, &error));
        size_t size, start = (size_t)snprintf(header, sizeof header,
                                              "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %u\n", H, width);
        char *file = test_read_file(path, &size);
        CHECK(size > start && memcmp(file, header, start) == 0);
        uint8_t *pixels = calloc((size_t)width * H, 4);
        read_hdr((const uint8_t *)file + start, size - start, width, pixels);
        for (uint32_t p = 0; p < width * H; p++) {
            const uint8_t *rgbe = pixels + 4 * (size_t)p;
            double max = 0;
            for (int c = 0; c < 3; c++)
                max = fmax(max, (double)light(p % width, p / width, c));
            for (int c = 0; c < 3; c++) {
                double value = rgbe[3] ? ldexp(rgbe[c], rgbe[3] - 136) : 0,
                       wanted = (double)light(p % width, p / width, c);
                CHECK(value <= wanted && wanted - value <= max / 128);
            }
        }
        free(pixels);
        free(file);
    }
}

TEST(radiance_pixels_of_odd_light_are_defined) {
    uint8_t out[4];
    hdr_pixel((const float[3]){-1, 0, NAN}, out);
    CHECK(out[0] == 0 && out[1] == 0 && out[2] == 0 && out[3] == 0);
    hdr_pixel((const float[3]){1, 0.5f, 0}, out);
    CHECK(out[0] == 128 && out[1] == 64 && out[2] == 0 && out[3] == 129);
    hdr_pixel((const float[3]){INFINITY, 1, 0}, out);
    CHECK(out[0] == 128 && out[3] == 255);
}

static void word_row(void *context, uint32_t y, uint16_t *line) {
    (void)context;
    for (uint32_t i = 0; i < 3 * 64; i++)
        line[i] = (uint16_t)(i * 341 + y * 77);
}

TEST(deep_png_holds_sixteen_bits) {
    struct error error = {0};
    const char *path = test_path("a.png");
    CHECK(
        png_write_from(FILE_AT(path), &(struct png_source){.width = 64, .height = 5, .words = word_row}, NULL, &error));
    struct image *image = image_read(path, &error);
    CHECK(image != NULL);
    for (uint32_t y = 0; y < 5 && image; y++) {
        for (uint32_t x = 0; x < 64; x++) {
            struct rgba c = image_texel(image, x, y);
            CHECK_NEAR(c.r * 65535, (uint16_t)(3 * x * 341 + y * 77), 1e-6);
            CHECK_NEAR(c.b * 65535, (uint16_t)((3 * x + 2) * 341 + y * 77), 1e-6);
        }
    }
    if (image)
        image_release(image);
    CHECK_EQ_INT(tone_word(0.5), 32768);
    CHECK_EQ_INT(tone_word(7), 65535);
    CHECK_EQ_INT(tone_word((double)NAN), 0);
}

static void check_lookup(struct tone_lookup *lookup, float light) {
    const uint8_t exact = png_write_byte(tone_apply(&lookup->tone, (double)light));
    uint8_t found;
    tone_lookup_bytes(lookup, &light, 1, &found);
    if (found != exact)
        test_fail(__FILE__, __LINE__, "%a: %d in place of %d", (double)light, found, exact);
}

/* All floats where a byte ends, their neighbours, and any others; one table for tone after tone. */
TEST(a_lookup_of_bytes_is_exact_for_every_tone) {
    static struct tone_lookup lookup;
    static struct tone_table table;
    struct test_random random = {4};
    for (int i = 0; i < TONE_ENTRIES; i++)
        table.values[i] = (float)(i % 300) / 300;
    for (int round = 0; round < 16; round++) {
        const struct tone tone = {.exposure = round % 2 ? 0 : 0.5 * round - 3,
                                  .curve = (enum tone_curve)(round / 4),
                                  .srgb = round / 2 % 2,
                                  .table = &table};
        tone_lookup_set(&lookup, &tone);
        for (int k = 0; k < 2; k++)
            for (int byte = 1; byte < 256; byte++) {
                uint32_t low = 0, high = 0x7f800000;
                float light;
                while (high - low > 1) {
                    const uint32_t middle = low + (high - low) / 2;
                    memcpy(&light, &middle, sizeof light);
                    *(png_write_byte(tone_apply(&tone, (double)light)) < byte ? &low : &high) = middle;
                }
                for (uint32_t bits = low - 3; bits < low + 5; bits++) {
                    memcpy(&light, &bits, sizeof light);
                    check_lookup(&lookup, light);
                }
            }
        for (int i = 0; i < 100000; i++) {
            check_lookup(&lookup, (float)test_uniform(&random, 0, 1.5));
            check_lookup(&lookup, (float)exp(test_uniform(&random, -14, 14)));
        }
        const float odd[] = {0, -0.0f, -1, NAN, INFINITY, -INFINITY, 1e-40f, 0x1p-16f, 0x1p16f};
        for (size_t i = 0; i < sizeof odd / sizeof *odd; i++)
            check_lookup(&lookup, odd[i]);
    }
}

static const char bright_scene[] =
    "local function r(t) t.node = gr.node('n'); t.width = 4; t.height = 4; t.eye = {0, 0, 0}\n"
    "t.background = {0.25, 2, 0.5}; gr.render(t) end\n"
    "r{file = 'plain.png'} r{file = 'light.HDR'} r{file = 'light.pfm', exposure = 3}\n"
    "r{file = 'bright.png', exposure = 1} r{file = 'curve.png', tone = 'reinhard'} r{file = 'srgb.png', srgb = true}\n"
    "r{file = 'deep.png', deep = true}\n";

static void expect_pixel(const char *name, uint8_t r, uint8_t g, uint8_t b) {
    struct test_picture picture = test_read_picture(test_path(name));
    if (!picture.rgb || picture.rgb[0] != r || picture.rgb[1] != g || picture.rgb[2] != b)
        test_fail(__FILE__, __LINE__, "%s is not %d %d %d", name, r, g, b);
    free(picture.rgb);
}

TEST(a_picture_may_be_exr_where_its_library_is) {
    struct test_result result = test_gray_scene("gr.render{node = gr.node('n'), file = 'light.exr', width = 2, height "
                                                "= 2, eye = {0, 0, 5}, background = {0.25, 2, "
                                                "0.5}}\n",
                                                "scene.lua", NULL);
    CHECK_EQ_INT(result.status, exr_can_write() ? 0 : 1);
    struct error error = {0};
    struct image *image = exr_can_write() ? image_read(test_path("light.exr"), &error) : NULL;
    if (image) {
        struct rgba c = image_texel(image, 1, 1);
        CHECK(c.r == 0.25 && c.g == 2 && c.b == 0.5);
    }
    CHECK((image != NULL) == exr_can_write());
    CHECK(exr_can_write() || strstr(result.err, "OpenEXR"));
    image_release(image);
    test_free_result(&result);
}

TEST(the_extension_sets_the_format_and_tone_is_only_for_png) {
    struct test_result result = test_gray_scene(bright_scene, "scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    expect_pixel("plain.png", 64, 255, 128);
    expect_pixel("bright.png", 128, 255, 255);
    expect_pixel("curve.png", 51, 170, 85);
    expect_pixel("srgb.png", 137, 255, 188);
    char path[512];
    size_t size;
    float rgb[3] = {0};
    (void)snprintf(path, sizeof path, "%s/light.pfm", test_folder());
    char *file = test_read_file(path, &size);
    CHECK(file && size == 12 + 1 + 48 * 4 - 1);
    if (file)
        memcpy(rgb, file + size - 12, 12);
    CHECK(rgb[0] == 0.25f && rgb[1] == 2 && rgb[2] == 0.5f);
    free(file);
    (void)snprintf(path, sizeof path, "%s/light.HDR", test_folder());
    file = test_read_file(path, &size);
    CHECK(file && strncmp(file, "#?RADIANCE\n", 11) == 0);
    free(file);
    test_free_result(&result);
}
