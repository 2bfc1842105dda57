/* Textures as values, and the inputs of materials that take them. Every kind is made by a switch without `default`, so
 * that a new kind is named here by the compiler. */
#include "material/material_inputs.h"
#include "material/material_mapping.h"
#include "material/texture_mapping_internal.h"
#include "math/frame.h"
#include "math/noise.h"
#include "tests/harness.h"
#include "tests/stage.h"
#include "tests/unit/colour_length.h"
#include "tests/unit/surface_makers.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct palette {
    struct arena arena;
    struct error error;
    struct image *image; /* 2 x 2, one colour with alpha 0.4: (10, 20, 30) of 255 */
};

static void palette_init(struct palette *p) {
    static const uint8_t texel[4] = {10, 20, 30, 102};
    uint8_t texels[16];
    *p = (struct palette){0};
    for (size_t i = 0; i < 4; i++)
        memcpy(texels + 4 * i, texel, 4);
    p->image = image_create("even", 2, 2, 8, texels, &p->error);
    CHECK(p->image != NULL);
}

static void palette_destroy(struct palette *p) {
    image_release(p->image);
    arena_destroy(&p->arena);
}

static const struct texture *keep(struct palette *p, struct texture texture) {
    const struct texture *kept = texture_keep(&p->arena, texture, &p->error);
    CHECK(kept != NULL);
    return kept;
}

static const struct texture *number(struct palette *p, double x) {
    return keep(p, texture_number(x));
}

static const struct texture *colour(struct palette *p, double r, double g, double b) {
    return keep(p, texture_constant(colour_make(r, g, b)));
}

static struct texture_image picture(const struct palette *p, enum texture_alpha alpha) {
    return (struct texture_image){.image = p->image, .mapping = MAPPING_UV, .alpha = alpha};
}

/* A point of a square that supplies coordinates, with vertex colours. */
static struct hit hit_at(double x, double y, double z) {
    return (struct hit){.pattern_point = {x, y, z},
                        .pattern_normal = {0, 0, 1},
                        .normal = {0, 0, 1},
                        .normal_geometric = {0, 0, 1},
                        .view = {0, 0, 1},
                        .raise = {0, 0, 1},
                        .has_uv = true,
                        .u = 0.5,
                        .v = 0.5,
                        .dpdu = {1, 0, 0},
                        .dpdv = {0, 1, 0},
                        .has_colour = true,
                        .colour = {0.25, 0.5, 1}};
}

static struct hit random_hit(struct test_random *random) {
    double x = test_uniform(random, -3, 3), y = test_uniform(random, -3, 3);
    return hit_at(x, y, test_uniform(random, -3, 3));
}

static bool same(struct vec3 a, struct vec3 b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

static bool same_colour(struct colour a, struct colour b) {
    return a.r == b.r && a.g == b.g && a.b == b.b;
}

/* --- every kind --- */

/* {0.5 + 0.1 * p.x, s.v, s.normal.z} */
static const struct expr_program *program(struct palette *p) {
    struct expr_graph graph = {.count = 0};
    struct expr_program *out = arena_alloc(&p->arena, sizeof *out);
    uint32_t x = expr_operation(&graph, EXPR_MULTIPLY, expr_float(&graph, 0.1), expr_input(&graph, EXPR_POINT_X), 0);
    const uint32_t outputs[3] = {expr_operation(&graph, EXPR_ADD, expr_float(&graph, 0.5), x, 0),
                                 expr_input(&graph, EXPR_V), expr_input(&graph, EXPR_NORMAL_Z)};
    CHECK(out && expr_compile(&graph, outputs, 3, &p->arena, out, &p->error));
    expr_graph_destroy(&graph);
    return out;
}

/* One texture of the kind, and its value at the hit by definition. */
static const struct texture *make(struct palette *p, enum texture_kind kind, const struct hit *hit,
                                  struct colour *wanted) {
    struct vec3 at = hit->pattern_point;
    struct texture_image image = picture(p, ALPHA_COVERS);
    double ratio = noise_wood(at.x, at.y, at.z, 3, 5, 1);
    switch (kind) {
    case TEXTURE_CONSTANT:
        *wanted = colour_make(0.1, 0.2, 0.7);
        return colour(p, 0.1, 0.2, 0.7);
    case TEXTURE_PARAMETER: /* there is no material */
        *wanted = colour_all(1);
        return texture_parameter(INPUT_KD);
    case TEXTURE_VERTEX_COLOUR:
        *wanted = hit->colour;
        return keep(p, texture_vertex_colour());
    case TEXTURE_IMAGE:
        /* premultiplied by alpha, over white */
        *wanted = colour_make(0.4 * 10 / 255 + 0.6, 0.4 * 20 / 255 + 0.6, 0.4 * 30 / 255 + 0.6);
        return keep(p, texture_image(&image, number(p, 1)));
    case TEXTURE_MARBLE:
        *wanted = colour_all(noise_marble(at, 2, 3, 4, 0));
        return keep(p, texture_marble(2, 3, 4, 0));
    case TEXTURE_WOOD:
        *wanted = colour_all(ratio);
        return keep(p, texture_wood(3, 5, 1));
    case TEXTURE_MIX:
        *wanted = colour_make(ratio * 0.5, ratio * 0.25 + (1 - ratio), ratio);
        return keep(p, texture_mix(colour(p, 0.5, 0.25, 1), colour(p, 0, 1, 0), keep(p, texture_wood(3, 5, 1))));
    case TEXTURE_MULTIPLY:
        *wanted = colour_make(0.5 * ratio, 0.25 * ratio, ratio);
        return keep(p, texture_multiply(colour(p, 0.5, 0.25, 1), keep(p, texture_wood(3, 5, 1))));
    case TEXTURE_MAP:
        *wanted = colour_make(0.9, 0.8, 0.3);
        return keep(p, texture_map(colour(p, 0.1, 0.2, 0.7), FUNCTION_COMPLEMENT, 0));
    case TEXTURE_FUNCTION:
        *wanted = colour_make(0.5 + 0.1 * at.x, hit->v, hit->normal.z);
        return keep(p, texture_function(program(p), true, colour_all(0.5), colour_all(1)));
    }
    return NULL;
}

TEST(every_kind_of_texture_is_what_its_definition_says) {
    struct palette p;
    struct test_random random = {3};
    palette_init(&p);
    for (int kind = 0; kind < TEXTURE_KIND_COUNT; kind++)
        for (int i = 0; i < 50; i++) {
            struct hit hit = random_hit(&random);
            struct colour wanted;
            const struct texture *texture = make(&p, (enum texture_kind)kind, &hit, &wanted);
            CHECK(texture && texture->operation.kind == (enum texture_kind)kind);
            CHECK_NEAR(colour_length(colour_sub(texture_colour_at(texture, &hit), wanted)), 0, 1e-14);
            CHECK_NEAR(texture_number_at(texture, &hit), (wanted.r + wanted.g + wanted.b) / 3, 1e-14);
        }
    palette_destroy(&p);
}

TEST(a_mix_of_any_two_kinds_lies_where_its_ratio_says_and_products_commute) {
    struct palette p;
    struct test_random random = {5};
    palette_init(&p);
    for (int a = 0; a < TEXTURE_KIND_COUNT; a++)
        for (int b = 0; b < TEXTURE_KIND_COUNT; b++) {
            struct hit hit = random_hit(&random);
            struct colour va, vb;
            const struct texture *ta = make(&p, (enum texture_kind)a, &hit, &va);
            const struct texture *tb = make(&p, (enum texture_kind)b, &hit, &vb);
            struct texture only_a = texture_mix(ta, tb, number(&p, 1)), only_b = texture_mix(ta, tb, number(&p, 0));
            struct texture middle = texture_mix(ta, tb, number(&p, 0.5));
            struct colour half = colour_scale(colour_add(va, vb), 0.5);
            CHECK(same_colour(texture_colour_at(&only_a, &hit), texture_colour_at(ta, &hit)));
            CHECK(same_colour(texture_colour_at(&only_b, &hit), texture_colour_at(tb, &hit)));
            CHECK_NEAR(colour_length(colour_sub(texture_colour_at(&middle, &hit), half)), 0, 1e-14);
            struct texture ab = texture_multiply(ta, tb), ba = texture_multiply(tb, ta);
            CHECK(same_colour(texture_colour_at(&ab, &hit), texture_colour_at(&ba, &hit)));
            CHECK_NEAR(texture_number_at(&ab, &hit), texture_number_at(ta, &hit) * texture_number_at(tb, &hit), 1e-15);
        }
    palette_destroy(&p);
}

TEST(a_shared_texture_gives_the_values_of_a_single_one) {
    struct palette p;
    struct test_random random = {7};
    palette_init(&p);
    for (int kind = 0; kind < TEXTURE_KIND_COUNT; kind++) {
        struct hit hit = random_hit(&random);
        struct colour ignored;
        struct texture shared = *make(&p, (enum texture_kind)kind, &hit, &ignored);
        shared.shared = true;
        struct texture_builder builder = {.count = 0};
        struct texture_tables tables;
        struct texture_reader reader;
        uint32_t as_colour, as_number;
        CHECK(texture_builder_add(&builder, &shared, false, &as_colour) &&
              texture_builder_add(&builder, &shared, true, &as_number) &&
              texture_builder_finish(&builder, &p.arena, &tables));
        texture_reader_init(&reader, &hit, &tables, NULL);
        for (int i = 0; i < 2; i++) {
            CHECK(same_colour(texture_read(as_colour, &reader), texture_colour_at(&shared, &hit)));
            CHECK(texture_read(as_number, &reader).r == texture_number_at(&shared, &hit));
        }
        CHECK_EQ_INT(reader.count, 2); /* the colour and the number */
        texture_builder_destroy(&builder);
    }
    palette_destroy(&p);
}

TEST(every_kind_stays_below_its_bound_and_constants_are_their_average) {
    struct palette p;
    struct test_random random = {9};
    palette_init(&p);
    for (int kind = 0; kind < TEXTURE_KIND_COUNT; kind++)
        for (int i = 0; i < 100; i++) {
            struct hit hit = random_hit(&random);
            struct colour ignored;
            const struct texture *texture = make(&p, (enum texture_kind)kind, &hit, &ignored);
            struct colour value = texture_colour_at(texture, &hit);
            struct colour bound = texture_estimate(texture, NULL, TEXTURE_LARGEST);
            struct colour average = texture_estimate(texture, NULL, TEXTURE_AVERAGE);
            CHECK(value.r <= bound.r + 1e-15 && value.g <= bound.g + 1e-15 && value.b <= bound.b + 1e-15);
            CHECK(average.r <= bound.r + 1e-15 && average.g <= bound.g + 1e-15 && average.b <= bound.b + 1e-15);
            if (texture->operation.kind == TEXTURE_CONSTANT ||
                texture->operation.kind == TEXTURE_IMAGE) /* the image is uniform */
                CHECK_NEAR(colour_length(colour_sub(average, value)), 0, 1e-14);
        }
    palette_destroy(&p);
}

/* --- the parts of kinds --- */

TEST(the_number_of_a_colour_is_its_mean_and_that_of_a_number_is_exact) {
    struct hit hit = hit_at(0, 0, 0);
    struct test_random random = {11};
    for (int i = 0; i < 1000; i++) {
        double x = test_uniform(&random, -5, 5), y = test_uniform(&random, -5, 5), z = test_uniform(&random, -5, 5);
        struct texture exact = texture_number(x), mixed = texture_constant(colour_make(x, y, z));
        CHECK(texture_number_at(&exact, &hit) == x && same_colour(texture_colour_at(&exact, &hit), colour_all(x)));
        CHECK(texture_number_at(&mixed, &hit) == (x + y + z) / 3);
    }
}

TEST(alpha_of_an_image_covers_is_ignored_darkens_is_undone_or_is_read_alone) {
    struct palette p;
    struct hit hit = hit_at(0, 0, 0);
    palette_init(&p);
    const struct texture *white = number(&p, 1);
    const double red = 10 / 255.0, wanted[] = {0.4 * red + 0.6, red, 0.4 * red, red, 0.4};
    for (int alpha = ALPHA_COVERS; alpha <= ALPHA_ONLY; alpha++) {
        struct texture_image image = picture(&p, (enum texture_alpha)alpha);
        struct texture over = texture_image(&image, white);
        CHECK_NEAR(texture_colour_at(&over, &hit).r, wanted[alpha], 1e-15);
        struct hit bare = hit;
        bare.has_uv = false; /* the surface has no coordinates: the texture below is used */
        CHECK(same_colour(texture_colour_at(&over, &bare), colour_all(1)));
    }
    palette_destroy(&p);
}

TEST(functions_of_textures_follow_their_formulas) {
    struct palette p;
    struct hit hit = hit_at(0, 0, 0);
    struct test_random random = {13};
    palette_init(&p);
    for (int function = 0; function < FUNCTION_COUNT; function++)
        for (int i = 0; i < 100; i++) {
            double x = test_uniform(&random, -0.5, 1.5), amount = test_uniform(&random, 0, 1), wanted = NAN;
            const struct texture *of = colour(&p, x, 2 * x, 3 * x);
            struct texture map = texture_map(of, (enum texture_function)function, amount);
            switch ((enum texture_function)function) {
            case FUNCTION_RED:
                wanted = x;
                break;
            case FUNCTION_GREEN:
                wanted = 2 * x;
                break;
            case FUNCTION_BLUE:
                wanted = 3 * x;
                break;
            case FUNCTION_COMPLEMENT:
                wanted = 1 - x;
                break;
            case FUNCTION_SATURATE:
                wanted = fmin(fmax(x, 0), 1);
                break;
            case FUNCTION_STEP:
                wanted = x >= amount;
                break;
            }
            CHECK_NEAR(texture_colour_at(&map, &hit).r, wanted, 1e-9);
        }
    palette_destroy(&p);
}

TEST(a_tree_that_doubles_with_each_level_is_refused_before_it_is_too_large) {
    struct palette p;
    palette_init(&p);
    const struct texture *tree = number(&p, 1);
    int levels = 0;
    while (levels < 100) {
        const struct texture *next = texture_keep(&p.arena, texture_multiply(tree, tree), &p.error);
        if (!next)
            break;
        tree = next;
        levels++;
    }
    CHECK_EQ_INT(levels, 13); /* 2^(n + 1) - 1 textures */
    CHECK_TEXT(p.error.text, "more than 16384 textures are in one");
    palette_destroy(&p);
}

/* --- inputs --- */

static void *field_of(struct surface_inputs *inputs, enum material_input input, bool *is_colour) {
    *is_colour = input == INPUT_KD || input == INPUT_KS || input == INPUT_EMISSION;
    switch (input) {
    case INPUT_KD:
        return &inputs->kd;
    case INPUT_KS:
        return &inputs->ks;
    case INPUT_SHININESS:
        return &inputs->shininess;
    case INPUT_REFLECT:
        return &inputs->reflect;
    case INPUT_REFRACT:
        return &inputs->refract;
    case INPUT_ROUGHNESS:
        return &inputs->roughness;
    case INPUT_EMISSION:
        return &inputs->emission;
    case INPUT_OPACITY:
        return &inputs->opacity;
    case INPUT_BASE_WEIGHT:
    case INPUT_DIFFUSE_ROUGHNESS:
    case INPUT_METALNESS:
    case INPUT_SPECULAR_WEIGHT:
    case INPUT_SPECULAR_ANISOTROPY:
    case INPUT_SPECULAR_IOR:
    case INPUT_TRANSMISSION_COLOUR:
    case INPUT_SUBSURFACE_WEIGHT:
    case INPUT_SUBSURFACE_COLOUR:
    case INPUT_SUBSURFACE_RADIUS:
    case INPUT_COAT_WEIGHT:
    case INPUT_FILM_WEIGHT:
    case INPUT_FILM_THICKNESS:
    case INPUT_COAT_COLOUR:
    case INPUT_COAT_ROUGHNESS:
    case INPUT_COAT_ANISOTROPY:
    case INPUT_COAT_IOR:
    case INPUT_COAT_DARKENING:
    case INPUT_FUZZ_WEIGHT:
    case INPUT_FUZZ_COLOUR:
    case INPUT_FUZZ_ROUGHNESS:
        return NULL; /* of layered materials alone (test_openpbr.c) */
    }
    return NULL;
}

static struct material base_material(void) {
    struct material base;
    material_derive(&base, MATERIAL_PHONG, NULL);
    base.phong = (struct phong){.kd = {0.1, 0.2, 0.3},
                                .ks = {0.4, 0.5, 0.6},
                                .shininess = 7,
                                .reflect = 0.8,
                                .refract = 0.9,
                                .roughness = 0.25,
                                .ior = 1.5,
                                .emission = {3, 4, 5}};
    return base;
}

TEST(a_texture_multiplies_the_number_of_every_input_and_no_other) {
    struct palette p;
    struct hit hit = hit_at(1, 2, 3);
    palette_init(&p);
    const struct texture *half = number(&p, 0.5);
    struct material base = base_material();
    struct surface_inputs plain;
    surface_inputs_of(&base, &hit, &plain);
    for (int input = 0; input < INPUT_COUNT; input++) {
        struct material over;
        struct surface_inputs inputs;
        material_derive(&over, MATERIAL_IMAGE, &base);
        CHECK(material_multiply(&over, (enum material_input)input, half, &p.arena, &p.error));
        surface_inputs_of(&over, &hit, &inputs);
        for (int other = 0; other < INPUT_COUNT; other++) {
            bool is_colour;
            const double *before = field_of(&plain, (enum material_input)other, &is_colour);
            const double *after = field_of(&inputs, (enum material_input)other, &is_colour);
            for (int i = 0; before && i < (is_colour ? 3 : 1); i++)
                CHECK(after[i] == (other == input ? 0.5 : 1) * before[i]);
        }
        base.phong.shininess += 1; /* later changes of the base's numbers count */
        surface_inputs_of(&over, &hit, &inputs);
        CHECK(inputs.shininess == base.phong.shininess * (input == INPUT_SHININESS ? 0.5 : 1));
        surface_inputs_of(&base, &hit, &plain);
    }
    palette_destroy(&p);
}

/* The result of the chain of decorators, link by link. */
TEST(marble_over_wood_over_an_image_is_what_the_decorators_made_bit_by_bit) {
    struct palette p;
    struct test_random random = {17};
    palette_init(&p);
    struct material base = base_material(), image, wood, marble;
    struct texture_image even = picture(&p, ALPHA_COVERS);
    struct colour brown = {0.3, 0.2, 0.1}, blue = {0, 0.1, 0.9};
    material_derive(&image, MATERIAL_IMAGE, &base);
    CHECK(material_cover(&image, INPUT_KD, &even, &p.arena, &p.error));
    material_derive(&wood, MATERIAL_WOOD, &image);
    CHECK(material_mix_kd(&wood, texture_wood(3, 5, 1), texture_constant(brown), &p.arena, &p.error));
    material_derive(&marble, MATERIAL_MARBLE, &wood);
    CHECK(material_mix_kd(&marble, texture_marble(2, 3, 4, 1), texture_constant(blue), &p.arena, &p.error));
    for (int i = 0; i < 1000; i++) {
        struct hit hit = random_hit(&random);
        struct vec3 at = hit.pattern_point;
        struct colour kd = base.phong.kd;
        struct surface_inputs inputs;
        struct rgba texel = image_lookup(p.image, (struct image_point){0.5, 0.5, 0, 0},
                                         (struct image_sampling){IMAGE_NEAREST, IMAGE_CLAMP, IMAGE_CLAMP});
        kd = colour_add(colour_make(texel.r, texel.g, texel.b), colour_scale(kd, 1 - texel.a));
        double ratio = noise_wood(at.x, at.y, at.z, 3, 5, 1);
        kd = colour_add(colour_scale(kd, ratio), colour_scale(brown, 1 - ratio));
        ratio = noise_marble(at, 2, 3, 4, 1);
        kd = colour_add(colour_scale(kd, ratio), colour_scale(blue, 1 - ratio));
        surface_inputs_of(&marble, &hit, &inputs);
        CHECK(same_colour(inputs.kd, kd));
        CHECK(same_colour(inputs.ks, base.phong.ks) && inputs.shininess == 7 && inputs.opacity == 1);
    }
    palette_destroy(&p);
}

TEST(a_thousand_decorators_are_evaluated_in_order) {
    struct palette p;
    struct hit hit = hit_at(0.3, 0.7, -0.2);
    palette_init(&p);
    static struct material chain[MATERIAL_DEPTH];
    double ratio = noise_wood(0.3, 0.7, -0.2, 3, 5, 1), kd = 0.1;
    chain[0] = base_material();
    for (int i = 1; i < MATERIAL_DEPTH; i++) {
        material_derive(&chain[i], MATERIAL_WOOD, &chain[i - 1]);
        CHECK(
            material_mix_kd(&chain[i], texture_wood(3, 5, 1), texture_constant(colour_all(i % 2)), &p.arena, &p.error));
        kd = kd * ratio + (i % 2) * (1 - ratio);
    }
    struct surface_inputs inputs;
    surface_inputs_of(&chain[MATERIAL_DEPTH - 1], &hit, &inputs);
    CHECK(inputs.kd.r == kd);
    CHECK_EQ_INT(chain[MATERIAL_DEPTH - 1].depth, MATERIAL_DEPTH);
    palette_destroy(&p);
}

TEST(metalness_moves_kd_to_ks_and_loses_nothing) {
    struct palette p;
    struct hit hit = hit_at(1, 2, 3);
    palette_init(&p);
    for (int i = 0; i <= 10; i++) {
        struct material base = base_material(), metal;
        struct surface_inputs inputs;
        double m = i / 10.0;
        material_derive(&metal, MATERIAL_PHONG, &base);
        CHECK(material_mix_metal(&metal, number(&p, m), &p.arena, &p.error));
        surface_inputs_of(&metal, &hit, &inputs);
        CHECK_NEAR(inputs.kd.r, 0.1 * (1 - m), 1e-16);
        CHECK_NEAR(inputs.ks.r, 0.1 * m + 0.4 * (1 - m), 1e-16);
        CHECK(inputs.shininess == 7 && inputs.reflect == 0.8);
    }
    palette_destroy(&p);
}

/* --- bump maps --- */

/* Rises by 1/255 per texel along u. */
static struct image *ramp(struct error *error) {
    static uint8_t texels[256 * 4];
    for (int i = 0; i < 256; i++) {
        memset(texels + (ptrdiff_t)4 * i, i, 3);
        texels[4 * i + 3] = 255;
    }
    return image_create("ramp", 256, 1, 8, texels, error);
}

TEST(bumps_of_any_texture_tilt_the_normal_by_the_slope_of_their_height) {
    struct palette p;
    palette_init(&p);
    struct image *image = ramp(&p.error);
    struct texture_image inputs = {
        .image = image, .mapping = MAPPING_UV, .filter = IMAGE_BILINEAR, .wrap = IMAGE_CLAMP};
    const struct texture *height = keep(&p, texture_image(&inputs, NULL));
    for (int i = 0; i < 20; i++) {
        double size = ldexp(1, i - 10), factor = 0.1 * (i % 5);
        struct hit hit = hit_at(0.5 * size, 0.5 * size, 0);
        hit.dpdu.x = hit.dpdv.y = size;
        frame_tangents(hit.pattern_normal, &hit.along_a, &hit.along_b);
        struct material base = base_material(), bumped;
        struct bump bump = {.kind = MATERIAL_BUMP, .height = factor * size, .texture = height};
        struct surface_inputs flat;
        material_derive(&bumped, MATERIAL_BUMP, &base);
        CHECK(material_add_bump(&bumped, &bump, &p.arena, &p.error));
        surface_inputs_of(&bumped, &hit, &flat);
        double slope = factor * 256 / 255; /* of height over x, 256 texels wide */
        struct vec3 wanted = vec3_normalize(vec3_make(-slope, 0, 1));
        CHECK_NEAR(vec3_length(vec3_sub(flat.normal, wanted)), 0, 1e-6);
        CHECK(material_has_image(&bumped));
    }
    image_release(image);
    palette_destroy(&p);
}

TEST(normals_of_any_texture_point_where_its_colour_says) {
    struct palette p;
    palette_init(&p);
    for (int i = 0; i < 3; i++) {
        static const struct vec3 wanted[] = {{0.6, 0, 0.8}, {0, 0.6, 0.8}, {0, 0, 1}};
        struct hit hit = hit_at(0.3, 0.7, 0.1);
        struct material base = base_material(), turned;
        struct surface_inputs inputs;
        struct vec3 c = vec3_scale(vec3_add(wanted[i], vec3_all(1)), 0.5);
        struct bump map = {.kind = MATERIAL_NORMAL, .height = 1, .texture = colour(&p, c.x, c.y, c.z)};
        material_derive(&turned, MATERIAL_NORMAL, &base);
        CHECK(material_add_bump(&turned, &map, &p.arena, &p.error));
        surface_inputs_of(&turned, &hit, &inputs);
        CHECK_NEAR(vec3_length(vec3_sub(inputs.normal, wanted[i])), 0, 1e-15);
    }
    palette_destroy(&p);
}

TEST(bumps_of_patterns_grow_with_the_object_and_leave_flat_heights_bit_by_bit) {
    struct palette p;
    palette_init(&p);
    struct hit hit = hit_at(0.3, 0.7, 0.1);
    frame_tangents(hit.pattern_normal, &hit.along_a, &hit.along_b);
    struct material base = base_material(), flat, bumped;
    struct surface_inputs inputs, scaled;
    struct bump even = {.kind = MATERIAL_BUMP, .height = 3, .texture = number(&p, 0.7)};
    struct bump wood = {.kind = MATERIAL_BUMP, .height = 0.05, .texture = keep(&p, texture_wood(3, 5, 1))};
    material_derive(&flat, MATERIAL_BUMP, &base);
    CHECK(material_add_bump(&flat, &even, &p.arena, &p.error));
    surface_inputs_of(&flat, &hit, &inputs);
    CHECK(same(inputs.normal, hit.normal));
    material_derive(&bumped, MATERIAL_BUMP, &base);
    CHECK(material_add_bump(&bumped, &wood, &p.arena, &p.error));
    surface_inputs_of(&bumped, &hit, &inputs);
    CHECK(!same(inputs.normal, hit.normal));
    CHECK_NEAR(vec3_length(inputs.normal), 1, 1e-15);
    /* The object, with its bumps, is eight times as large in the world: the normals are the same. */
    hit.along_a = vec3_scale(hit.along_a, 8);
    hit.along_b = vec3_scale(hit.along_b, 8);
    hit.raise = vec3_scale(hit.raise, 8);
    hit.dpdu = vec3_scale(hit.dpdu, 8);
    hit.dpdv = vec3_scale(hit.dpdv, 8);
    surface_inputs_of(&bumped, &hit, &scaled);
    CHECK(same(inputs.normal, scaled.normal));
    palette_destroy(&p);
}

/* --- mappings --- */

/* A point of a ball of radius 2 whose shape supplies no coordinates; `normal` is a unit vector. */
static struct hit ball_hit(struct vec3 normal) {
    struct hit hit = hit_at(0, 0, 0);
    hit.pattern_normal = hit.normal = hit.normal_geometric = normal;
    hit.pattern_point = vec3_add_scaled(vec3_make(5, 6, 7), normal, 2);
    hit.has_uv = false;
    return hit;
}

TEST(mappings_become_those_of_the_shape_that_shows_them) {
    struct palette p;
    palette_init(&p);
    struct vec3 n = vec3_make(0.6, 0.64, 0.48);
    struct hit ball = ball_hit(n), box = hit_at(0, 0, 0);
    box.u = 0.25, box.v = 0.125;
    for (int asked = 0; asked < 4; asked++) {
        static const enum texture_mapping mappings[] = {MAPPING_SPHERE, MAPPING_CUBE, MAPPING_UV, MAPPING_BY_SHAPE};
        struct texture_image image = {.image = p.image, .mapping = mappings[asked]};
        struct texcoord at;
        CHECK(texture_mapping_on(image.mapping, LAYOUT_UV) ==
              (image.mapping == MAPPING_BY_SHAPE ? MAPPING_UV : image.mapping));
        CHECK(asked < 2 || !texture_coordinates(&image, &ball, &at));
        image.mapping = texture_mapping_on(mappings[asked], LAYOUT_SPHERE);
        CHECK(texture_coordinates(&image, &ball, &at));
        double turn = atan2(n.z, n.x) / 6.283185307179586;
        if (image.mapping != MAPPING_CUBE) { /* from the centre at any position: half a turn apart */
            CHECK_NEAR(at.u, mappings[asked] == MAPPING_UV ? 0.5 + turn : turn, 1e-15);
            CHECK_NEAR(at.v, acos(n.y) / 3.141592653589793, 1e-15);
        }
        image.mapping = texture_mapping_on(mappings[asked], LAYOUT_FACES);
        CHECK(texture_coordinates(&image, &box, &at));
        if (image.mapping != MAPPING_SPHERE) /* of the face, from the top */
            CHECK(at.u == 0.25 && at.v == 0.125 && at.wrap_u == IMAGE_CLAMP);
        /* A second call changes nothing. */
        for (int layout = 0; layout < SURFACE_LAYOUTS; layout++) {
            enum texture_mapping on = texture_mapping_on(mappings[asked], (enum surface_layout)layout);
            CHECK(texture_mapping_on(on, (enum surface_layout)layout) == on);
        }
    }
    palette_destroy(&p);
}

TEST(spheres_show_letters_unmirrored_from_outside_where_the_mapping_says_so) {
    struct palette p;
    palette_init(&p);
    static const enum texture_mapping mappings[] = {MAPPING_SPHERE, MAPPING_BALL, MAPPING_BALL_CLASSIC};
    for (int k = 0; k < 3; k++)
        for (int step = 0; step < 6; step++) {
            double angle = 0.4 + step;
            struct vec3 n = vec3_normalize(vec3_make(cos(angle), 0.3, sin(angle)));
            struct vec3 right = vec3_cross(vec3_negate(n), vec3_make(0, 1, 0)); /* of the viewer, who looks along -n */
            struct hit here = ball_hit(n), beside = ball_hit(vec3_normalize(vec3_add_scaled(n, right, 1e-3)));
            here.pattern_point = here.pattern_normal, beside.pattern_point = beside.pattern_normal;
            here.dpdu = vec3_scale(right, -1); /* of the classic mapping: u runs to the left */
            for (int outside = 0; outside < 2; outside++) {
                struct texture_image image = {.image = p.image, .mapping = mappings[k], .outside = outside};
                struct texcoord at, next;
                CHECK(texture_coordinates(&image, &here, &at) && texture_coordinates(&image, &beside, &next));
                CHECK((next.u > at.u) == outside);
                CHECK(mappings[k] == MAPPING_SPHERE || (vec3_dot(at.dpdu, right) > 0) == outside);
                CHECK(at.v == next.v || fabs(at.v - next.v) < 1e-5);
            }
        }
    palette_destroy(&p);
}

/* Images with other mappings below each kind of texture are found in every branch of the tree. */
TEST(a_copy_for_a_layout_changes_every_image_and_shares_what_its_tree_shares) {
    struct palette p;
    palette_init(&p);
    struct texture_image lookup = picture(&p, ALPHA_COVERS);
    lookup.mapping = MAPPING_BY_SHAPE;
    struct texture shared = texture_image(&lookup, colour(&p, 0.5, 0.25, 1));
    shared.shared = true;
    const struct texture *image = keep(&p, shared), *red = keep(&p, texture_map(image, FUNCTION_RED, 0));
    const struct texture *tree = keep(&p, texture_mix(keep(&p, texture_multiply(image, red)), red, image));
    struct material base = base_material(), covered, raised;
    struct bump bump = {.kind = MATERIAL_BUMP, .height = 1, .texture = tree};
    struct material_mapping mapping = {.arena = &p.arena};
    material_derive(&covered, MATERIAL_IMAGE, &base);
    CHECK(material_multiply(&covered, INPUT_KD, tree, &p.arena, &p.error));
    material_derive(&raised, MATERIAL_BUMP, &covered);
    CHECK(material_add_bump(&raised, &bump, &p.arena, &p.error));
    struct hit ball = ball_hit(vec3_make(0.6, 0.64, 0.48)), square = hit_at(0, 0, 0);
    CHECK(material_on_layout(&mapping, &raised, LAYOUT_UV, &p.error) == &raised);
    CHECK(material_on_layout(&mapping, &base, LAYOUT_SPHERE, &p.error) == &base);
    const struct material *on = material_on_layout(&mapping, &raised, LAYOUT_SPHERE, &p.error);
    CHECK(on && on != &raised && on == material_on_layout(&mapping, &raised, LAYOUT_SPHERE, &p.error));
    CHECK(on->base == material_on_layout(&mapping, &covered, LAYOUT_SPHERE, &p.error) && on->base->base == &base);
    const struct texture *copy = on->inputs[INPUT_KD]->parts[PART_B];
    const struct texture *ratio = copy->parts[PART_RATIO], *product = copy->parts[PART_A];
    CHECK(copy == on->bump->texture && ratio == product->parts[PART_A] && ratio->shared);
    CHECK(ratio->operation.image.mapping == MAPPING_BALL && image->operation.image.mapping == MAPPING_BY_SHAPE);
    /* Without coordinates the original shows what is below its image; the copy shows the image, which is uniform. */
    struct surface_inputs bare, shown, flat;
    surface_inputs_of(&covered, &ball, &bare);
    surface_inputs_of(on->base, &ball, &shown);
    surface_inputs_of(&covered, &square, &flat);
    CHECK(!same_colour(bare.kd, shown.kd) && same_colour(shown.kd, flat.kd));
    base.phong.kd = colour_scale(base.phong.kd, 2); /* later changes of the base reach copies */
    surface_inputs_of(on->base, &ball, &bare);
    CHECK(same_colour(bare.kd, colour_scale(shown.kd, 2)));
    palette_destroy(&p);
}

TEST(a_material_on_shapes_of_several_layouts_has_one_number_and_an_index_for_each) {
    struct stage s;
    struct palette p;
    palette_init(&p);
    stage_begin(&s, 1);
    struct texture_image lookup = picture(&p, ALPHA_COVERS);
    lookup.mapping = MAPPING_BY_SHAPE;
    struct material *plain = stage_phong(&s, colour_all(1), colour_all(0), 1);
    struct material *m = scene_material(&s.scene, MATERIAL_IMAGE, plain, &s.error);
    CHECK(material_cover(m, INPUT_KD, &lookup, &s.scene.arena, &s.error));
    for (int i = 0; i < 6; i++) {
        struct node *node = i % 2 ? stage_cube(&s, s.root, m) : stage_sphere(&s, s.root, i == 4 ? plain : m);
        if (i == 3)
            node->shape = (struct shape){.kind = SHAPE_TORUS, .torus = {1, 0.2}};
    }
    CHECK(stage_build(&s, s.root, ACCEL_AUTO));
    CHECK_EQ_INT(s.world.material_number_count, 2);
    CHECK_EQ_INT(s.world.material_count, 4);
    for (uint32_t i = 0; i < s.world.material_count; i++)
        CHECK_EQ_INT(s.world.material_numbers[i], i == 3 ? 1 : 0);
    stage_end(&s);
    palette_destroy(&p);
}

/* --- the language --- */

static const char *const two_pictures =
    "local function picture(file, material)\n"
    "  local root = gr.node('root')\n"
    "  root:add_child(gr.sphere{material = material})\n"
    "  gr.render{node = root, file = file, width = 24, height = 24, eye = {0, 0, 4}, view = {0, 0, -1},\n"
    "            up = {0, 1, 0}, fov = 40, ambient = {.3, .3, .3}, lights = {gr.light({3, 3, 5}, {1, 1, 1}, {1, 0, "
    "0})}}\n"
    "end\n";

static void check_equal(const char *first, const char *second) {
    char scene[4096];
    (void)snprintf(scene, sizeof scene, "%spicture('a.png', %s)\npicture('b.png', %s)\n", two_pictures, first, second);
    struct test_result result = test_gray_scene(scene, "-q scene.lua", NULL);
    CHECK_TEXT(result.err, "");
    CHECK_EQ_INT(result.status, 0);
    test_free_result(&result);
    size_t size_a, size_b;
    char path[2][512];
    for (int i = 0; i < 2; i++)
        (void)snprintf(path[i], sizeof path[i], "%s/%s", test_folder(), i ? "b.png" : "a.png");
    char *a = test_read_file(path[0], &size_a), *b = test_read_file(path[1], &size_b);
    CHECK(a && b && size_a == size_b && memcmp(a, b, size_a) == 0);
    free(a);
    free(b);
}

/* The Lua expression for a texture of the kind; NULL: scripts cannot make one. */
static const char *in_words(enum texture_kind kind) {
    switch (kind) {
    case TEXTURE_CONSTANT:
        return "{.2, .4, .6}";
    case TEXTURE_PARAMETER:
    case TEXTURE_VERTEX_COLOUR:
    case TEXTURE_MAP: /* for inputs that are fractions */
        return NULL;
    case TEXTURE_IMAGE:
        return "gr.texture('a.png')";
    case TEXTURE_MARBLE:
        return "gr.marble_texture(2, 3, 4)";
    case TEXTURE_WOOD:
        return "gr.wood_texture(3, 5)";
    case TEXTURE_MIX:
        return "gr.mix_texture(1, {0, 1, 0}, .25)";
    case TEXTURE_MULTIPLY:
        return "gr.multiply_texture(.5, {0, 1, 0})";
    case TEXTURE_FUNCTION:
        return "gr.fn(function(p) return math.sin(3 * p.x) end)";
    }
    return NULL;
}

TEST(every_kind_that_scripts_can_make_is_taken_as_colour_number_and_height) {
    char scene[8192];
    int length =
        snprintf(scene, sizeof scene, "%spicture('a.png', gr.material({1, 1, 1}, {0, 0, 0}, 1))\n", two_pictures);
    for (int kind = 0; kind < TEXTURE_KIND_COUNT; kind++) {
        const char *words = in_words((enum texture_kind)kind);
        if (!words)
            continue;
        bool is_handle = kind != TEXTURE_CONSTANT;
        length += snprintf(scene + length, sizeof scene - (size_t)length,
                           "picture('b.png', gr.material{kd = %s, ks = %s, emission = %s, reflect = %s, bump = %s})\n",
                           words, words, words, is_handle ? words : "0", is_handle ? words : "'a.png'");
    }
    struct test_result result = test_gray_scene(scene, "-q scene.lua", NULL);
    CHECK_TEXT(result.err, "");
    CHECK_EQ_INT(result.status, 0);
    test_free_result(&result);
}

TEST(a_marble_decorator_is_a_mix_of_a_marble_texture) {
    check_equal("gr.marble_pnd_material(gr.material({.8, .7, .6}, {.2, .2, .2}, 10), 2, 3, 4, 1, {.1, .2, .3})",
                "gr.material{kd = gr.mix_texture({.8, .7, .6}, {.1, .2, .3}, gr.marble_texture(2, 3, 4, 1)),"
                " ks = {.2, .2, .2}, shininess = 10}");
}

TEST(textures_of_one_number_are_that_number_in_every_input) {
    check_equal("gr.material{kd = {.5, .25, 1}, ks = {.5, .5, .5}, shininess = 8, reflect = .5, roughness = .25,"
                " emission = {.125, .25, 0}, opacity = .5}",
                "gr.material{kd = gr.multiply_texture({.5, .25, 1}, 1), ks = gr.multiply_texture(.5, 1),"
                " shininess = gr.multiply_texture(2, 4), reflect = gr.multiply_texture(.5, 1),"
                " roughness = gr.multiply_texture(.5, .5), emission = gr.multiply_texture({.125, .25, 0}, 1),"
                " opacity = gr.multiply_texture(1, .5)}");
}

/* A TGA of two pixels, `bytes` each, top row first. */
static void write_pair(const char *name, int type, int bytes, const void *pixels) {
    uint8_t file[18 + 8] = {0, 0, (uint8_t)type, [12] = 2, [14] = 1, [16] = (uint8_t)(8 * bytes), [17] = 32};
    memcpy(file + 18, pixels, (size_t)bytes * 2);
    test_write_file(test_path(name), file, 18 + (size_t)bytes * 2);
}

/* The filter takes one texel: between two of them colours are weighted by alpha. */
TEST(the_alpha_of_a_texture_may_be_the_opacity_of_the_surface) {
    write_pair("cut.tga", 2, 4, "\x20\x40\xff\xff\x20\xf0\x10\x40");
    write_pair("colour.tga", 2, 3, "\x20\x40\xff\x20\xf0\x10");
    write_pair("opacity.tga", 3, 1, "\xff\x40");
#define CUT "gr.texture{file = 'cut.tga', filter = 'nearest', alpha = true}"
#define COLOUR "gr.texture{file = 'colour.tga', filter = 'nearest'}"
#define OPACITY "gr.texture{file = 'opacity.tga', filter = 'nearest'}"
    check_equal("gr.material{kd = " CUT ", ks = {1, 1, 1}}",
                "gr.material{kd = " COLOUR ", ks = {1, 1, 1}, opacity = " OPACITY "}");
    check_equal("gr.image_material(gr.material{kd = {.5, 1, 1}}, " CUT ")",
                "gr.image_material{material = gr.image_material(gr.material{kd = {.5, 1, 1}}, " COLOUR "),"
                " image = " OPACITY ", channel = 'opacity'}");
    check_equal("gr.openpbr_material{base_color = " CUT "}",
                "gr.openpbr_material{base_color = " COLOUR ", geometry_opacity = " OPACITY "}");
    /* The opacity of one is alpha, and other inputs read the colour alone. */
    check_equal("gr.material{kd = {1, 0, 0}, opacity = " CUT ", emission = " CUT "}",
                "gr.material{kd = {1, 0, 0}, opacity = " OPACITY ", emission = " COLOUR "}");
}
