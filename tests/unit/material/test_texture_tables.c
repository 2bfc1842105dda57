/* The tables of textures and bumps of a world: at a hit, lists of instructions give the values of the authored trees,
 * which are evaluated by recursion here. */
#include "base/fault.h"
#include "material/material_inputs.h"
#include "tests/harness.h"
#include "tests/stage.h"
#include "tests/unit/surface_makers.h"

#include <math.h>
#include <string.h>

enum { MATERIALS = 24, TEXTURES = 40 };

struct authored_materials {
    struct stage stage;
    struct image *image;
    const struct texture *textures[TEXTURES]; /* all kinds except those that materials make */
    uint32_t texture_count;
    struct material *materials[MATERIALS];
    struct node *nodes[MATERIALS];
};

static const struct texture *keep(struct authored_materials *a, struct texture texture) {
    const struct texture *kept = texture_keep(&a->stage.scene.arena, texture, &a->stage.error);
    CHECK(kept != NULL);
    return kept;
}

static const struct texture *any_texture(struct authored_materials *a, struct test_random *random) {
    return a->textures[(uint32_t)test_uniform(random, 0, a->texture_count)];
}

/* One of several textures over existing parts, so that trees share parts. */
static struct texture any_over_any(struct authored_materials *a, struct test_random *random) {
    struct texture_image image = {.image = a->image, .mapping = MAPPING_UV};
    const struct texture *first = any_texture(a, random), *second = any_texture(a, random);
    double x = test_uniform(random, 0.1, 1);
    const struct texture some[] = {texture_constant(colour_make(x, 0.5, 1 - x)),
                                   *texture_parameter(INPUT_KS),
                                   texture_vertex_colour(),
                                   texture_image(&image, NULL),
                                   texture_image(&image, first),
                                   texture_marble(x, 3, 4, 0),
                                   texture_wood(x, 5, 1),
                                   texture_mix(first, second, any_texture(a, random)),
                                   texture_multiply(first, second),
                                   texture_map(first, FUNCTION_GREEN, 0),
                                   texture_map(first, FUNCTION_COMPLEMENT, 0)};
    return some[(uint32_t)test_uniform(random, 0, sizeof some / sizeof some[0])];
}

static void make_materials(struct authored_materials *a, struct test_random *random) {
    static const uint8_t texels[16] = {10, 20, 30, 102, 200, 100, 0, 255, 0, 90, 180, 255, 60, 50, 40, 200};
    struct stage *s = &a->stage;
    struct arena *arena = &s->scene.arena;
    a->image = image_create("four", 2, 2, 8, texels, &s->error);
    a->textures[a->texture_count++] = keep(a, texture_number(0.5));
    while (a->texture_count < TEXTURES) {
        struct texture texture = any_over_any(a, random);
        texture.shared = a->texture_count % 3 == 0;
        const struct texture *kept = keep(a, texture);
        a->textures[a->texture_count++] = kept;
    }
    for (int i = 0; i < MATERIALS; i++) {
        bool derived = i > 0 && i % 2;
        struct material *m = derived ? scene_material(&s->scene, MATERIAL_BUMP, a->materials[i - 1], &s->error)
                                     : stage_phong(s, colour_make(0.25, 0.5, 0.75), colour_all(0.125), 9);
        CHECK(material_multiply(m, (enum material_input)(i % INPUT_COUNT), any_texture(a, random), arena, &s->error));
        struct bump bump = {
            .kind = i % 3 ? MATERIAL_BUMP : MATERIAL_NORMAL, .height = 0.25, .texture = any_texture(a, random)};
        CHECK(!derived || material_add_bump(m, &bump, arena, &s->error));
        a->materials[i] = m;
        a->nodes[i] = stage_cube(s, s->root, m);
        /* A torus shows images with the mapping that was requested. */
        a->nodes[i]->shape = (struct shape){.kind = SHAPE_TORUS, .torus = {1, 0.2}};
    }
}

static struct hit random_hit(struct test_random *random) {
    double x = test_uniform(random, -3, 3), y = test_uniform(random, -3, 3), z = test_uniform(random, -3, 3);
    return (struct hit){.pattern_point = {x, y, z},
                        .pattern_normal = {0, 0, 1},
                        .normal = {0, 0, 1},
                        .normal_geometric = {0, 0, 1},
                        .view = {0, 0, 1},
                        .raise = {0, 0, 1},
                        .along_a = {1, 0, 0},
                        .along_b = {0, 1, 0},
                        .pattern_scale = 1,
                        .footprint = 0.01,
                        .has_uv = true,
                        .u = test_uniform(random, 0, 1),
                        .v = test_uniform(random, 0, 1),
                        .dpdu = {1, 0, 0},
                        .dpdv = {0, 1, 0},
                        .has_colour = true,
                        .colour = {0.25, 0.5, 1}};
}

static bool same_inputs(const struct surface_inputs *a, const struct surface_inputs *b) {
    const double left[] = {a->kd.r,      a->kd.g,       a->kd.b,       a->ks.r,      a->ks.g,    a->ks.b,
                           a->normal.x,  a->normal.y,   a->normal.z,   a->shininess, a->reflect, a->refract,
                           a->roughness, a->emission.r, a->emission.g, a->opacity};
    const double right[] = {b->kd.r,      b->kd.g,       b->kd.b,       b->ks.r,      b->ks.g,    b->ks.b,
                            b->normal.x,  b->normal.y,   b->normal.z,   b->shininess, b->reflect, b->refract,
                            b->roughness, b->emission.r, b->emission.g, b->opacity};
    return memcmp(left, right, sizeof left) == 0;
}

static bool same_colour(struct colour a, struct colour b) {
    return memcmp(&a, &b, sizeof a) == 0;
}

/* The inputs by their definition: the texture of the authored material, alone. */
static void check_input(const struct material *authored, enum material_input input, const struct hit *hit,
                        const struct surface_inputs *got) {
    const struct texture *texture = authored->inputs[input];
    if (!texture || input > INPUT_KS)
        return;
    const struct phong *numbers = &material_origin(authored)->phong;
    /* Each input is its number times a texture. */
    struct colour number = input == INPUT_KD ? numbers->kd : numbers->ks, value = input == INPUT_KD ? got->kd : got->ks;
    if (texture->operation.kind == TEXTURE_MULTIPLY && texture->parts[PART_B]->size == 1 &&
        texture->parts[PART_B]->operation.kind != TEXTURE_PARAMETER)
        CHECK(same_colour(value, colour_mul(number, texture_colour_at(texture->parts[PART_B], hit))));
}

static void check_as_authored(const struct world *world, struct test_random *random) {
    for (uint32_t i = 0; i < world->material_count; i++) {
        const struct surface_material *flat = &world->surfaces.materials[i];
        const struct material *authored = world->authored.materials[i];
        CHECK(flat->needs_footprint == material_has_image(authored));
        CHECK(surface_has_holes(flat) == (authored->inputs[INPUT_OPACITY] != NULL));
        CHECK(surface_albedo_bound(&world->surfaces, flat) == surface_albedo_bound_of(authored));
        CHECK(same_colour(surface_emission(&world->surfaces, flat), material_emission(authored)));
        CHECK(same_colour(surface_emission_bound(&world->surfaces, flat), material_emission_bound(authored)));
        for (int k = 0; k < 20; k++) {
            struct hit hit = random_hit(random);
            struct surface_inputs together, apart;
            material_inputs_at(&world->surfaces, flat, &hit, &together);
            surface_inputs_of(authored, &hit, &apart);
            CHECK(same_inputs(&together, &apart));
            for (int input = 0; input < INPUT_OPACITY; input++)
                check_input(authored, (enum material_input)input, &hit, &together);
        }
    }
}

TEST(materials_of_a_world_read_from_its_tables_what_the_authored_ones_read_from_trees) {
    static struct authored_materials a;
    struct test_random random = {5};
    a = (struct authored_materials){.texture_count = 0};
    stage_begin(&a.stage, 1);
    make_materials(&a, &random);
    CHECK(stage_build(&a.stage, a.stage.root, ACCEL_AUTO));
    struct world *world = &a.stage.world;
    CHECK_EQ_INT(world->material_count, MATERIALS);
    CHECK_EQ_INT(world->surfaces.bump_count, MATERIALS / 2);
    check_as_authored(world, &random);
    for (int i = 0; i < MATERIALS; i += 2) /* colours change, the kinds of inputs do not */
        a.materials[i]->phong.kd = colour_make(0.5, 0.25, 1);
    world_update_materials(world);
    check_as_authored(world, &random);
    stage_end(&a.stage);
    image_release(a.image);
}

TEST(a_world_holds_each_texture_once_and_its_parts_before_it) {
    static struct authored_materials a;
    struct test_random random = {6};
    a = (struct authored_materials){.texture_count = 0};
    stage_begin(&a.stage, 1);
    make_materials(&a, &random);
    CHECK(stage_build(&a.stage, a.stage.root, ACCEL_AUTO));
    const struct texture_tables *tables = &a.stage.world.surfaces.textures;
    const struct texture *const *authored = a.stage.world.authored.textures;
    /* Each input that is multiplied makes one texture, and may read a parameter. */
    CHECK(tables->count > MATERIALS);
    CHECK(tables->count <= a.texture_count + MATERIALS + INPUT_COUNT);
    for (uint32_t i = 0; i < tables->count; i++) {
        CHECK(tables->operations[i].kind == authored[i]->operation.kind);
        for (int k = 0; k < TEXTURE_PARTS; k++) {
            uint32_t found = 0, part = UINT32_MAX;
            for (uint32_t j = 0; j < tables->count; j++)
                if (authored[j] == authored[i]->parts[k])
                    found++, part = j;
            CHECK(authored[i]->parts[k] ? found == 1 && part < i : found == 0);
        }
    }
    stage_end(&a.stage);
    image_release(a.image);
}

/* --- the stack of values --- */

struct deep {
    struct arena arena;
    struct error error;
    struct test_random random;
};

static const struct texture *kept(struct deep *deep, struct texture texture) {
    const struct texture *out = texture_keep(&deep->arena, texture, &deep->error);
    CHECK(out != NULL);
    return out;
}

/* Products of ten thousand of them are not 0. */
static const struct texture *any_number(struct deep *deep) {
    return kept(deep, texture_number(test_uniform(&deep->random, 0.99, 1.01)));
}

static struct colour by_recursion(const struct texture *texture) {
    const struct texture *const *parts = texture->parts;
    if (texture->operation.kind == TEXTURE_CONSTANT)
        return texture->operation.constant.colour;
    if (texture->operation.kind == TEXTURE_MULTIPLY)
        return colour_mul(by_recursion(parts[PART_A]), by_recursion(parts[PART_B]));
    double ratio = by_recursion(parts[PART_RATIO]).r;
    return colour_add(colour_scale(by_recursion(parts[PART_A]), ratio),
                      colour_scale(by_recursion(parts[PART_B]), 1 - ratio));
}

/* The smallest tree that needs so many values: 1 + 2 S(d - 1), or 1 + 3 S(d - 2) textures. */
static const struct texture *smallest(struct deep *deep, int depth) {
    if (depth < 2)
        return any_number(deep);
    if (depth % 2 == 0)
        return kept(deep, texture_multiply(smallest(deep, depth - 1), smallest(deep, depth - 1)));
    const struct texture *parts[3];
    for (int i = 0; i < 3; i++)
        parts[i] = smallest(deep, depth - 2);
    return kept(deep, texture_mix(parts[0], parts[1], parts[2]));
}

static void check_value(const struct texture *texture) {
    struct hit hit = {.u = 0};
    struct colour wanted = by_recursion(texture);
    CHECK(texture->depth <= TEXTURE_DEPTH && isfinite(wanted.r));
    CHECK(same_colour(texture_colour_at(texture, &hit), wanted));
    CHECK(texture_number_at(texture, &hit) == wanted.r);
}

TEST(chains_of_textures_on_each_side_need_two_or_three_values_at_a_time) {
    for (int side = 0; side < 5; side++) {
        struct deep deep = {.random = {3}};
        const struct texture *a = any_number(&deep), *b = any_number(&deep), *chain = a;
        while (chain->size + 3 <= TEXTURE_SIZE) {
            const struct texture over[] = {texture_mix(chain, b, a), texture_mix(b, chain, a), texture_mix(a, b, chain),
                                           texture_multiply(chain, a), texture_multiply(b, chain)};
            chain = kept(&deep, over[side]);
        }
        CHECK(chain->size > TEXTURE_SIZE - 3);
        CHECK_EQ_INT(chain->depth, side < 3 ? 3 : 2);
        check_value(chain);
        arena_destroy(&deep.arena);
    }
}

TEST(the_smallest_tree_that_needs_17_values_is_evaluated_and_one_for_18_is_too_large) {
    struct deep deep = {.random = {3}};
    const struct texture *tree = NULL;
    uint32_t power = 1; /* of 3 */
    for (int depth = 1; depth <= TEXTURE_DEPTH; depth++) {
        power *= depth % 2 ? 1 : 3;
        tree = smallest(&deep, depth);
        CHECK_EQ_INT(tree->depth, depth);
        CHECK_EQ_INT(tree->size, depth % 2 ? (3 * power - 1) / 2 : power);
        check_value(tree);
    }
    struct texture larger = texture_multiply(tree, tree);
    CHECK_EQ_INT(larger.depth, TEXTURE_DEPTH + 1);
    CHECK(!texture_keep(&deep.arena, larger, &deep.error));
    arena_destroy(&deep.arena);
}

TEST(random_trees_give_the_values_of_recursion_bit_by_bit) {
    for (uint32_t round = 1; round <= 20; round++) {
        struct deep deep = {.random = {round}};
        const struct texture *all[60] = {any_number(&deep)};
        for (int i = 1; i < 60; i++) {
            const struct texture *parts[3];
            for (int k = 0; k < 3; k++)
                parts[k] = all[(int)(i * sqrt(test_uniform(&deep.random, 0, 1)))];
            struct texture next =
                i % 3 ? texture_mix(parts[0], parts[1], parts[2]) : texture_multiply(parts[0], parts[1]);
            all[i] = i > 4 && next.size <= TEXTURE_SIZE / 8 ? kept(&deep, next) : any_number(&deep);
            check_value(all[i]);
        }
        arena_destroy(&deep.arena);
    }
}

/* Chains of decorators on many nodes have one list in all. */
TEST(a_texture_over_a_listed_one_adds_only_its_own_instructions) {
    struct deep deep = {.random = {3}};
    struct texture_builder builder = {.count = 0};
    const struct texture *a = any_number(&deep), *chain[100] = {a};
    uint32_t program, before = 0;
    for (int i = 1; i < 100; i++)
        chain[i] = kept(&deep, texture_multiply(chain[i - 1], a));
    for (int i = 1; i < 100; i++) {
        CHECK(texture_builder_add(&builder, chain[i], false, &program));
        CHECK_EQ_INT(builder.instruction_count - before, i == 1 ? 3 : 2);
        CHECK_EQ_INT(builder.programs[program].count, 2 * i + 1);
        before = builder.instruction_count;
    }
    texture_builder_destroy(&builder);
    builder = (struct texture_builder){.count = 0};
    for (int i = 100; i-- > 1;) { /* and the other way round */
        CHECK(texture_builder_add(&builder, chain[i], false, &program));
        CHECK_EQ_INT(builder.instruction_count, 199);
    }
    texture_builder_destroy(&builder);
    arena_destroy(&deep.arena);
}

TEST(tables_of_materials_survive_any_allocation_that_fails) {
#ifndef GRAY_FAULTS
    test_skip("failures on demand are only in builds with GRAY_FAULTS");
#endif
    static struct authored_materials a;
    struct test_random random = {7};
    int failed = 0;
    bool built = false;
    a = (struct authored_materials){.texture_count = 0};
    stage_begin(&a.stage, 1);
    make_materials(&a, &random);
    for (uint64_t at = 1; !built; at++) {
        const struct material *materials[MATERIALS];
        struct surface_tables tables;
        struct arena arena = {.head = NULL};
        for (int i = 0; i < MATERIALS; i++)
            materials[i] = a.materials[i];
        fault_at(FAULT_OF_ALLOCATION, at);
        built = surface_tables_build(&tables, materials, MATERIALS, false, &arena, NULL);
        fault_at(FAULT_OF_ALLOCATION, 0);
        failed += !built;
        arena_destroy(&arena);
    }
    CHECK(failed > 8);
    stage_end(&a.stage);
    image_release(a.image);
}
