/* Classic and linear colours (docs/colour.md): what is decoded, what is encoded, and what stays as it is. */
#include "tests/harness.h"
#include "tests/stage.h"

#include "image/levels.h"
#include "image/tone.h"
#include "material/material_inputs.h"

#include <math.h>
#include <stdio.h>

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
    struct image *image = ramp(&error), *linear = image_linear(image, &error);
    CHECK(linear != NULL && linear != image && image_linear(image, &error) == linear);
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
    struct image *image = image_create("two", 2, 1, 8, texels, &error), *linear = image_linear(image, &error);
    const struct image_point all = {0.5, 0.5, 1, 1};
    const struct image_sampling sampling = {IMAGE_MIPMAP, IMAGE_CLAMP, IMAGE_CLAMP};
    CHECK_NEAR(image_lookup(linear, all, sampling).r, 0.5, 1e-4);
    image_release(image);
}

TEST(pictures_of_light_are_linear_already) {
    struct error error = {.kind = ERROR_NONE};
    static const float texels[4] = {0.25f, 2, 0.5f, 1};
    struct image *image = image_create("light", 1, 1, 32, texels, &error);
    CHECK(image_linear(image, &error) == image);
    image_release(image);
}

/* The picture over an input of a material, as a world holds it. */
static struct image *in_world(struct stage *s, struct image *image, enum material_input input,
                              enum texture_encoding encoding, enum colour_pipeline colour) {
    const struct texture_image lookup = {.image = image, .mapping = MAPPING_UV, .encoding = encoding};
    struct material *m = stage_phong(s, vec3_all(1), vec3_all(1), 10);
    const struct texture *texture = texture_keep(&s->scene.arena, texture_image(&lookup, NULL), &s->error);
    CHECK(texture && material_multiply(m, input, texture, &s->scene.arena, &s->error));
    struct node *root = stage_group(s, s->root);
    stage_cube(s, root, m);
    s->settings.colour = colour;
    CHECK(stage_build(s, root, ACCEL_AUTO));
    for (uint32_t i = 0; i < s->world.texture_count; i++)
        if (s->world.textures[i].kind == TEXTURE_IMAGE)
            return s->world.textures[i].image.lookup.image;
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
                          input == INPUT_FUZZ_COLOUR;
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
    free(result.out);
    free(result.err);
    (void)snprintf(path, sizeof path, "%s/x.png", test_folder());
    struct image *image = image_read_png(path, &error);
    int byte = image ? (int)(255 * image_texel(image, 0, 0).r + 0.5) : -1;
    image_release(image);
    return byte;
}

TEST(paths_mean_linear_colours_unless_something_else_is_said) {
    CHECK_EQ_INT(background_byte("", "-q scene.lua"), 128);
    CHECK_EQ_INT(background_byte(", colour = 'linear'", "-q scene.lua"), 188);
    CHECK_EQ_INT(background_byte("", "-q --colour linear scene.lua"), 188);
    CHECK_EQ_INT(background_byte(", colour = 'classic'", "-q --colour linear scene.lua"), 128);
    CHECK_EQ_INT(background_byte(", srgb = false", "-q --colour linear scene.lua"), 128);
    CHECK_EQ_INT(background_byte("", "-q --integrator path --spp 1 scene.lua"), 188);
    CHECK_EQ_INT(background_byte(", srgb = false", "-q --integrator path --spp 1 scene.lua"), 128);
    CHECK_EQ_INT(background_byte("", "-q --integrator path --spp 1 --colour classic scene.lua"), 128);
}
