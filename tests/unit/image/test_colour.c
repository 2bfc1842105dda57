/* Classic and linear colours (docs/colour.md): what is decoded, what is encoded, and what stays as it is. */
#include "tests/harness.h"
#include "tests/stage.h"

#include "base/file.h"
#include "image/levels.h"
#include "image/png_write.h"
#include "image/tone.h"
#include "light/light.h"
#include "material/material_eval.h"
#include "material/material_inputs.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <zlib.h>

static const struct transfer_function srgb_transfer = {TRANSFER_SRGB, 0};

static double decoded(double c) {
    return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}

/* A picture of all bytes. */
static struct image *ramp(struct error *error) {
    uint8_t texels[256 * 4];
    for (int i = 0; i < 256; i++)
        texels[4 * i] = texels[4 * i + 1] = texels[4 * i + 2] = (uint8_t)i, texels[4 * i + 3] = (uint8_t)(255 - i);
    return image_create("ramp", 256, 1, 8, texels, error);
}

TEST(a_decoded_picture_gives_back_its_bytes_where_it_is_encoded) {
    struct error error = {.kind = ERROR_NONE};
    const struct tone srgb = {.srgb = true};
    struct image *image = ramp(&error), *linear = image_decode(image, srgb_transfer, &error);
    CHECK(linear != NULL && linear != image && image_decode(image, srgb_transfer, &error) == linear);
    CHECK_EQ_INT(image_bits(linear), 16);
    for (uint32_t i = 0; i < 256; i++) {
        struct rgba texel = image_texel(linear, i, 0);
        CHECK_NEAR(texel.r, decoded(i / 255.0), 1e-5);
        CHECK_NEAR(texel.a, (255 - i) / 255.0, 1e-12);
        CHECK_EQ_INT((int)(255 * tone_apply(&srgb, texel.r) + 0.5), (int)i);
    }
    CHECK(image_memory(image) > image_memory(linear));
    image_release(image);
}

TEST(black_and_white_average_as_light_in_the_levels_of_a_decoded_picture) {
    struct error error = {.kind = ERROR_NONE};
    static const uint8_t texels[8] = {0, 0, 0, 255, 255, 255, 255, 255};
    struct image *image = image_create("two", 2, 1, 8, texels, &error),
                 *linear = image_decode(image, srgb_transfer, &error);
    const struct image_point all = {0.5, 0.5, 1, 1};
    const struct image_sampling sampling = {IMAGE_MIPMAP, IMAGE_CLAMP, IMAGE_CLAMP};
    CHECK_NEAR(image_lookup(linear, all, sampling).r, 0.5, 1e-4);
    image_release(image);
}

TEST(pictures_of_light_are_linear_already) {
    struct error error = {.kind = ERROR_NONE};
    static const float texels[4] = {0.25f, 2, 0.5f, 1};
    struct image *image = image_create("light", 1, 1, 32, texels, &error);
    CHECK(image_decode(image, srgb_transfer, &error) == image);
    image_release(image);
}

/* The picture over an input of a material, as a world holds it. */
static struct image *in_world(struct stage *s, struct image *image, enum material_input input,
                              enum texture_encoding encoding, enum colour_pipeline colour) {
    const struct texture_image lookup = {.image = image, .mapping = MAPPING_UV, .encoding = encoding};
    struct material *m = stage_phong(s, colour_all(1), colour_all(1), 10);
    const struct texture *texture = texture_keep(&s->scene.arena, texture_image(&lookup, NULL), &s->error);
    CHECK(texture && material_multiply(m, input, texture, &s->scene.arena, &s->error));
    struct node *root = stage_group(s, s->root);
    stage_cube(s, root, m);
    s->settings.colour = colour;
    CHECK(stage_build(s, root, ACCEL_AUTO));
    for (uint32_t i = 0; i < s->world.surfaces.textures.count; i++)
        if (s->world.surfaces.textures.operations[i].kind == TEXTURE_IMAGE)
            return s->world.surfaces.textures.operations[i].image.image;
    return NULL;
}

TEST(pictures_are_decoded_where_they_are_read_as_colours) {
    for (int input = 0; input < INPUT_COUNT; input++) {
        for (int encoding = 0; encoding < 3; encoding++) {
            struct stage s;
            stage_begin(&s, 1);
            struct image *image = ramp(&s.error);
            bool colour = input == INPUT_KD || input == INPUT_KS || input == INPUT_EMISSION ||
                          input == INPUT_TRANSMISSION_COLOUR || input == INPUT_COAT_COLOUR ||
                          input == INPUT_FUZZ_COLOUR || input == INPUT_SUBSURFACE_COLOUR;
            bool expected = encoding == ENCODING_SRGB || (encoding == ENCODING_AUTO && colour);
            enum material_input at = (enum material_input)input;
            struct image *linear = in_world(&s, image, at, (enum texture_encoding)encoding, COLOUR_LINEAR);
            CHECK(linear && (linear != image) == expected);
            CHECK(in_world(&s, image, at, (enum texture_encoding)encoding, COLOUR_CLASSIC) == image);
            CHECK(in_world(&s, image, at, (enum texture_encoding)encoding, COLOUR_AUTO) == image);
            stage_end(&s);
            image_release(image);
        }
    }
}

static void keep_last(void *context, const struct material *link, const struct surface_inputs *inputs) {
    (void)link;
    *(struct surface_inputs *)context = *inputs;
}

TEST(a_pixel_trace_reports_the_decoded_colours_of_the_picture) {
    struct stage s;
    struct surface_inputs reported = {.kd = {0, 0, 0}};
    struct hit hit = {.has_uv = true, .u = 0.25, .v = 0.5, .normal = {0, 0, 1}, .view = {0, 0, 1}};
    stage_begin(&s, 1);
    struct image *image = ramp(&s.error);
    CHECK(in_world(&s, image, INPUT_KD, ENCODING_AUTO, COLOUR_LINEAR));
    CHECK(material_observe(&s.world.surfaces, &hit, s.world.authored.materials[0],
                           &(struct material_context){.thin = false}, keep_last, &reported));
    CHECK_NEAR(reported.kd.r, decoded(64 / 255.0) * (255 - 64) / 255, 1e-4); /* with its alpha, over black */
    stage_end(&s);
    image_release(image);
}

/* The byte of the first pixel of a picture that is all background. */
static int background_byte(const char *field, const char *options) {
    char text[512], path[512];
    struct error error;
    (void)snprintf(text, sizeof text,
                   "gr.render{node = gr.node('n'), file = 'x.png', width = 4, height = 4, eye = {0, 0, 5}, "
                   "background = {0.5, 0.5, 0.5}%s}\n",
                   field);
    struct test_result result = test_gray_scene(text, options, NULL);
    CHECK_EQ_INT(result.status, 0);
    test_free_result(&result);
    (void)snprintf(path, sizeof path, "%s/x.png", test_folder());
    struct image *image = image_read(path, &error);
    int byte = image ? (int)(255 * image_texel(image, 0, 0).r + 0.5) : -1;
    image_release(image);
    return byte;
}

/* --- what a PNG file states --- */

static void one_colour(void *context, uint32_t y, uint8_t *line) {
    (void)y;
    memcpy(line, context, 3);
}

/* A picture of one pixel with a chunk before its texels. */
static void write_stated(const char *path, uint8_t colour[3], const char *kind, const void *bytes, size_t size) {
    struct error error;
    struct file_bytes file;
    CHECK(png_write_from(FILE_AT(path),
                         &(struct png_source){.width = 1, .height = 1, .bytes = one_colour, .context = colour}, NULL,
                         &error));
    if (!kind)
        return;
    CHECK(file_map(path, 1 << 20, &file, &error));
    uint8_t chunk[4096];
    uint32_t crc = (uint32_t)crc32_z(crc32_z(0, (const uint8_t *)kind, 4), bytes, size);
    for (int k = 0; k < 4; k++) {
        chunk[k] = (uint8_t)(size >> (24 - 8 * k));
        chunk[8 + size + (size_t)k] = (uint8_t)(crc >> (24 - 8 * k));
    }
    memcpy(chunk + 4, kind, 4);
    memcpy(chunk + 8, bytes, size);
    FILE *out = fopen(path, "wb");
    CHECK(out && fwrite(file.data, 33, 1, out) == 1 && fwrite(chunk, size + 12, 1, out) == 1 &&
          fwrite(file.data + 33, file.size - 33, 1, out) == 1 && fclose(out) == 0);
    file_unmap(&file);
}

/* The mean of its three channels, which are not decoded. */
TEST(a_picture_of_emission_luminance_is_a_number) {
    uint8_t colour[3] = {128, 64, 200};
    struct error error;
    write_stated(test_path("number.png"), colour, NULL, NULL, 0);
    struct test_result result = test_gray_scene(
        "local m = gr.openpbr_material{base_weight=0, specular_weight=0, emission_luminance=gr.texture('number.png'),\n"
        "                             emission_color={1, .5, 0}}\n"
        "gr.render{node=gr.rectangle{material=m, corner={-5,-5,0}, along={10,0,0}, up={0,10,0}}, file='x.pfm', "
        "width=2,\n"
        "          height=2, spp=1, eye={0,0,5}, integrator='path', background={0,0,0}}\n",
        "scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    test_free_result(&result);
    struct image *image = image_read(test_path("x.pfm"), &error);
    CHECK(image != NULL);
    struct rgba texel = image ? image_texel(image, 0, 0) : (struct rgba){0, 0, 0, 0};
    CHECK_NEAR(texel.r, (128 + 64 + 200) / 765.0, 1e-6);
    CHECK_NEAR(texel.g, (128 + 64 + 200) / 765.0 / 2, 1e-6);
    CHECK_NEAR(texel.b, 0, 0);
    image_release(image);
}

TEST(a_png_file_states_its_transfer_function) {
    static const struct {
        const char *kind, *bytes;
        size_t size;
        struct transfer_function transfer;
        const char *warning;
    } rows[] = {
        {NULL, NULL, 0, {TRANSFER_UNSTATED, 0}, NULL},
        {"sRGB", "\0", 1, {TRANSFER_SRGB, 0}, NULL},
        {"gAMA", "\0\1\x86\xa0", 4, {TRANSFER_POWER, 1}, NULL}, /* 100000 */
        {"gAMA", "\0\0\xc3\x50", 4, {TRANSFER_POWER, 2}, NULL}, /* 50000 */
        {"gAMA", "\0\0\0\0", 4, {TRANSFER_UNSTATED, 0}, NULL},  /* invalid */
        {"cICP", "\1\x0d\0\1", 4, {TRANSFER_SRGB, 0}, NULL},
        {"cICP", "\1\x08\0\1", 4, {TRANSFER_POWER, 1}, NULL},
        {"cICP", "\1\1\0\1", 4, {TRANSFER_BT709, 0}, NULL},
        {"cICP", "\x0c\x0d\0\1", 4, {TRANSFER_SRGB, 0}, "primaries"}, /* Display P3 */
        {"cICP", "\x09\x10\0\1", 4, {TRANSFER_SRGB, 0}, "PQ"},
        {"iCCP", "Adobe RGB (1998)\0\0broken", 24, {TRANSFER_SRGB, 0}, "'Adobe RGB (1998)'"},
        {"iCCP", "sRGB IEC61966-2.1\0\0broken", 25, {TRANSFER_SRGB, 0}, NULL},
    };
    struct error error = {.kind = ERROR_NONE};
    const char *path = test_path("stated.png");
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        write_stated(path, (uint8_t[]){192, 128, 64}, rows[i].kind, rows[i].bytes, rows[i].size);
        struct image *image = image_read(path, &error);
        CHECK(image != NULL);
        CHECK(transfer_same(image->transfer, rows[i].transfer));
        CHECK((image_colours(image) != NULL) == (rows[i].warning != NULL));
        CHECK(!rows[i].warning || strstr(image_colours(image), rows[i].warning));
        image_release(image);
    }
}

/* The bytes of the middle of a picture that an unlit square fills. */
static void unlit_bytes(const char *material, const char *options, int out[3]) {
    char text[1024], path[512];
    struct error error;
    (void)snprintf(text, sizeof text,
                   "local m = gr.material{kd = %s, lit = false}\n"
                   "local square = gr.cube{name = 'square', material = m, corner = {-2, -2, -4}, size = {4, 4, 4}}\n"
                   "gr.render{node = square, file = 'x.png', width = 3, height = 3, eye = {0, 0, 5}, fov = 20, "
                   "background = {0, 0, 0}}\n",
                   material);
    struct test_result result = test_gray_scene(text, options, NULL);
    CHECK_EQ_INT(result.status, 0);
    test_free_result(&result);
    (void)snprintf(path, sizeof path, "%s/x.png", test_folder());
    struct image *image = image_read(path, &error);
    CHECK(image != NULL);
    struct rgba texel = image_texel(image, 1, 1);
    out[0] = (int)(255 * texel.r + 0.5);
    out[1] = (int)(255 * texel.g + 0.5);
    out[2] = (int)(255 * texel.b + 0.5);
    image_release(image);
}

TEST(an_unlit_square_gives_back_the_bytes_of_its_colour_in_both_pipelines) {
    static const char *const same[] = {"'#c08040'",
                                       "gr.srgb('#c08040')",
                                       "gr.srgb(192 / 255, 128 / 255, 64 / 255)",
                                       "gr.srgb{192 / 255, 128 / 255, 64 / 255}",
                                       "gr.texture('plain.png')",
                                       "gr.texture{file = 'plain.png', encoding = 'srgb'}",
                                       "gr.texture('stated.png')",
                                       "gr.mix_texture('#c08040', '#c08040', 0.5)",
                                       "gr.multiply_texture('#c08040', 1)"};
    static const char *const options[] = {"-q scene.lua", "-q --colour linear scene.lua",
                                          "-q --integrator path --spp 1 scene.lua"};
    char path[512];
    (void)snprintf(path, sizeof path, "%s/plain.png", test_folder());
    write_stated(path, (uint8_t[]){192, 128, 64}, NULL, NULL, 0);
    (void)snprintf(path, sizeof path, "%s/stated.png", test_folder());
    write_stated(path, (uint8_t[]){192, 128, 64}, "sRGB", "\0", 1);
    for (size_t i = 0; i < sizeof same / sizeof *same; i++) {
        for (size_t k = 0; k < sizeof options / sizeof *options; k++) {
            int bytes[3];
            unlit_bytes(same[i], options[k], bytes);
            CHECK_EQ_INT(bytes[0], 192);
            CHECK_EQ_INT(bytes[1], 128);
            CHECK_EQ_INT(bytes[2], 64);
        }
    }
}

TEST(numbers_are_light_in_linear_colours_and_files_may_say_that_they_are) {
    static const struct {
        const char *colour;
        double power; /* light is the number of the file to this power; 0: sRGB */
    } rows[] = {{"{128 / 255, 128 / 255, 128 / 255}", 1},
                {"gr.linear('#808080')", 0},
                {"gr.texture{file = 'plain.png', encoding = 'linear'}", 1},
                {"gr.texture{file = 'plain.png', encoding = 2}", 2},
                {"gr.texture('light.png')", 1},
                {"gr.texture{file = 'light.png', encoding = 'srgb'}", 0},
                {"gr.texture('square.png')", 2}};
    static const struct tone srgb = {.srgb = true};
    uint8_t grey[] = {128, 128, 128};
    char path[512];
    (void)snprintf(path, sizeof path, "%s/plain.png", test_folder());
    write_stated(path, grey, NULL, NULL, 0);
    (void)snprintf(path, sizeof path, "%s/light.png", test_folder());
    write_stated(path, grey, "gAMA", "\0\1\x86\xa0", 4);
    (void)snprintf(path, sizeof path, "%s/square.png", test_folder());
    write_stated(path, grey, "gAMA", "\0\0\xc3\x50", 4);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        int bytes[3];
        double light = rows[i].power > 0 ? pow(128 / 255.0, rows[i].power) : decoded(128 / 255.0);
        unlit_bytes(rows[i].colour, "-q --colour linear scene.lua", bytes);
        CHECK_EQ_INT(bytes[1], (int)(255 * tone_apply(&srgb, light) + 0.5));
    }
}

TEST(colours_of_the_screen_are_accepted_for_lights_fogs_and_skies) {
    static const char *const fields[] = {
        "background = '#404040'", "background = gr.srgb('#404040')",
        "background = {0, 0, 0}, fog = gr.uniform_fog{colour = '#404040', density = 1e6}"};
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
        for (int linear = 0; linear < 2; linear++) {
            char text[512], path[512];
            struct error error;
            (void)snprintf(text, sizeof text,
                           "gr.render{node = gr.node('n'), file = 'x.png', width = 2, height = 2, eye = {0, 0, 5}, "
                           "%s}\n",
                           fields[i]);
            struct test_result result =
                test_gray_scene(text, linear ? "-q --colour linear scene.lua" : "-q scene.lua", NULL);
            CHECK_EQ_INT(result.status, 0);
            test_free_result(&result);
            (void)snprintf(path, sizeof path, "%s/x.png", test_folder());
            struct image *image = image_read(path, &error);
            CHECK(image != NULL);
            CHECK_EQ_INT((int)(255 * image_texel(image, 0, 0).r + 0.5), 64);
            image_release(image);
        }
    }
    struct light light = {.colour = {0.5, 0, 2}, .display = {0.25, 0, 1}, .has_display = true};
    light_decode(&light);
    CHECK_NEAR(light.colour.r, 2 * decoded(0.25), 1e-12);
    CHECK_NEAR(light.colour.g, 0, 0);
    CHECK_NEAR(light.colour.b, 2, 1e-12);
}

TEST(errors_of_colours_of_the_screen_name_what_is_accepted) {
    static const char *const rows[][2] = {
        {"gr.material{kd = '#12345'}",
         "scene.lua:1: gr.material: '#12345' is not a colour; colours are '#rgb' or '#rrggbb'"},
        {"gr.material{kd = {1, 0, 0}, absorption = '#123456'}", "absorption must be light: gr.linear"},
        {"gr.material{kd = 'red'}", "kd must be a colour {r, g, b}"},
        {"gr.srgb(1)", "a colour is needed"},
        {"gr.texture{file = 'x.png', encoding = -1}", "encoding must be"},
        {"gr.texture{file = 'x.png', encoding = 'rgb'}", "encoding must be 'auto', 'srgb' or 'linear'"}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct test_result result = test_gray_scene(rows[i][0], "-q scene.lua", NULL);
        CHECK_EQ_INT(result.status, 1);
        CHECK(strstr(result.err, rows[i][1]) != NULL);
        test_free_result(&result);
    }
}

TEST(encoding_classic_pictures_is_reported_and_so_are_unknown_colours) {
    write_stated(test_path("adobe.png"), (uint8_t[]){192, 128, 64}, "iCCP", "Adobe RGB (1998)\0\0broken", 24);
    static const struct {
        const char *options, *report;
    } rows[] = {{"--srgb scene.lua", "--colour linear"},
                {"scene.lua", NULL},
                {"--colour linear scene.lua", "adobe.png has the colour profile 'Adobe RGB (1998)'"}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct test_result result =
            test_gray_scene("local c = gr.cube{name = 'c', material = gr.material{kd = gr.texture('adobe.png')}}\n"
                            "gr.render{node = c, file = 'x.png', width = 2, height = 2, eye = {0, 0, 5}}\n",
                            rows[i].options, NULL);
        CHECK_EQ_INT(result.status, 0);
        CHECK(rows[i].report ? strstr(result.err, rows[i].report) != NULL : strstr(result.err, "linear") == NULL);
        test_free_result(&result);
    }
}

TEST(paths_mean_linear_colours_unless_something_else_is_said) {
    CHECK_EQ_INT(background_byte("", "-q scene.lua"), 128);
    CHECK_EQ_INT(background_byte(", colour = 'linear'", "-q scene.lua"), 188);
    CHECK_EQ_INT(background_byte("", "-q --colour linear scene.lua"), 188);
    CHECK_EQ_INT(background_byte(", colour = 'classic'", "-q --colour linear scene.lua"), 188);
    CHECK_EQ_INT(background_byte(", colour = 'classic'", "-q --default colour=linear scene.lua"), 128);
    CHECK_EQ_INT(background_byte(", srgb = false", "-q --colour linear scene.lua"), 128);
    CHECK_EQ_INT(background_byte("", "-q --integrator path --spp 1 scene.lua"), 188);
    CHECK_EQ_INT(background_byte(", srgb = false", "-q --integrator path --spp 1 scene.lua"), 128);
    CHECK_EQ_INT(background_byte("", "-q --integrator path --spp 1 --colour classic scene.lua"), 128);
}
