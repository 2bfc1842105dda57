/* The tables of textures and bumps of a world: at a hit, materials by index give the values of the authored trees. */
#include "material/material_inputs.h"
#include "tests/harness.h"
#include "tests/stage.h"

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
    const struct texture some[] = {texture_constant(vec3_make(x, 0.5, 1 - x)),
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
                                     : stage_phong(s, vec3_make(0.25, 0.5, 0.75), vec3_all(0.125), 9);
        CHECK(material_multiply(m, (enum material_input)(i % INPUT_COUNT), any_texture(a, random), arena, &s->error));
        struct bump bump = {.kind = i % 3 ? MATERIAL_BUMP : MATERIAL_NORMAL,
                            .height = 0.25,
                            .texture.authored = any_texture(a, random)};
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
    const double left[] = {a->kd.x,      a->kd.y,       a->kd.z,       a->ks.x,      a->ks.y,    a->ks.z,
                           a->normal.x,  a->normal.y,   a->normal.z,   a->shininess, a->reflect, a->refract,
                           a->roughness, a->emission.x, a->emission.y, a->opacity};
    const double right[] = {b->kd.x,      b->kd.y,       b->kd.z,       b->ks.x,      b->ks.y,    b->ks.z,
                            b->normal.x,  b->normal.y,   b->normal.z,   b->shininess, b->reflect, b->refract,
                            b->roughness, b->emission.x, b->emission.y, b->opacity};
    return memcmp(left, right, sizeof left) == 0;
}

static void check_as_authored(const struct world *world, struct test_random *random) {
    for (uint32_t i = 0; i < world->material_count; i++) {
        const struct material *flat = &world->materials[i], *authored = world->authored.materials[i];
        CHECK(flat->textures == world->textures && flat->bumps == world->bumps && !authored->textures);
        CHECK(material_has_image(flat) == material_has_image(authored));
        CHECK(material_has_bump(flat) == material_has_bump(authored));
        CHECK(material_has_holes(flat) == material_has_holes(authored));
        CHECK(material_specular(flat) == material_specular(authored));
        CHECK(material_albedo_bound(flat) == material_albedo_bound(authored));
        for (int k = 0; k < 20; k++) {
            struct hit hit = random_hit(random);
            struct surface_inputs by_index, by_pointer;
            material_inputs_at(flat, &hit, &by_index);
            material_inputs_at(authored, &hit, &by_pointer);
            CHECK(same_inputs(&by_index, &by_pointer));
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
    CHECK_EQ_INT(world->bump_count, MATERIALS / 2);
    check_as_authored(world, &random);
    for (int i = 0; i < MATERIALS; i += 2) /* colours change, the kinds of inputs do not */
        a.materials[i]->phong.kd = vec3_make(0.5, 0.25, 1);
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
    const struct world *world = &a.stage.world;
    /* Each input that is multiplied makes one texture, and may read a parameter. */
    CHECK(world->texture_count > MATERIALS);
    CHECK(world->texture_count <= a.texture_count + MATERIALS + INPUT_COUNT);
    for (uint32_t i = 0; i < world->texture_count; i++) {
        struct texture own = world->textures[i];
        union texture_ref *parts[TEXTURE_PARTS];
        uint32_t size = 1;
        for (int k = texture_parts(&own, parts); k-- > 0;) {
            CHECK(parts[k]->index < i || (own.kind == TEXTURE_IMAGE && parts[k]->index == TEXTURE_NONE));
            size += parts[k]->index < i ? world->textures[parts[k]->index].size : 0;
        }
        CHECK_EQ_INT(own.size, size);
    }
    stage_end(&a.stage);
    image_release(a.image);
}
