/* Bump maps and normal maps: normals by closed forms, through the same functions as in pictures. */
#include "material/material_eval.h"
#include "material/material_inputs.h"
#include "material/texture_mapping_internal.h"
#include "tests/harness.h"
#include "tests/stage.h"
#include "tests/unit/mesh_makers.h"

#include <math.h>
#include <stdlib.h>

/* The value of a texel, 0 .. 1 per channel. */
typedef struct colour painter(double x, double y);

static struct image *paint(painter *colour, uint32_t width, uint32_t height, int bits) {
    struct error error = {0};
    uint16_t *words = malloc((size_t)width * height * 4 * sizeof *words);
    uint8_t *bytes = (uint8_t *)words;
    for (uint32_t i = 0; i < width * height; i++) {
        struct colour c = colour(((i % width) + 0.5) / width, ((i / width) + 0.5) / height);
        double rgba[4] = {c.r, c.g, c.b, 1};
        for (uint32_t k = 0; k < 4; k++) {
            if (bits == 16)
                words[4 * (size_t)i + k] = (uint16_t)(rgba[k] * 65535 + 0.5);
            else
                bytes[4 * (size_t)i + k] = (uint8_t)(rgba[k] * 255 + 0.5);
        }
    }
    struct image *image = image_create("test", width, height, bits, words, &error);
    CHECK(image != NULL);
    free(words);
    return image;
}

static struct colour half(double x, double y) {
    (void)x, (void)y;
    return colour_all(0.5);
}

/* 16-bit integers at the centres of 255 texels. */
#define RAMP (65280.0 / 65535)

static struct colour ramp_right(double x, double y) {
    (void)y;
    return colour_all(RAMP * x);
}

static struct colour ramp_down(double x, double y) {
    (void)x;
    return colour_all(RAMP * y);
}

static struct colour waves(double x, double y) {
    const double turn = 6.283185307179586;
    return colour_all(0.5 + 0.2 * sin(turn * 2 * x) + 0.2 * cos(turn * y));
}

static struct colour stripes(double x, double y) {
    (void)y;
    return colour_all(fmod(x * 128, 1) < 0.5 ? 0 : 1);
}

static struct colour neutral_blue(double x, double y) {
    (void)x, (void)y;
    return colour_make(128.0 / 255, 128.0 / 255, 1);
}

/* About (0.6, 0, 0.8), in bytes. */
static struct colour tilted_right(double x, double y) {
    (void)x, (void)y;
    return colour_make(204.0 / 255, 128.0 / 255, 230.0 / 255);
}

static struct colour tilted_up(double x, double y) {
    (void)x, (void)y;
    return colour_make(128.0 / 255, 204.0 / 255, 230.0 / 255);
}

static struct bump bump_of(struct stage *s, enum material_kind kind, struct image *image, double height, bool flip_u) {
    const struct texture_image lookup = {
        .image = image, .mapping = MAPPING_BY_SHAPE, .filter = IMAGE_MIPMAP, .wrap = IMAGE_REPEAT, .flip_u = flip_u};
    const struct texture *texture = texture_keep(&s->scene.arena, texture_image(&lookup, NULL), &s->error);
    CHECK(texture != NULL);
    return (struct bump){.kind = kind, .height = height, .texture = texture};
}

static struct material *raised_white(struct stage *s, const struct bump *bump) {
    struct material *m =
        scene_material(&s->scene, bump->kind, stage_phong(s, colour_all(1), colour_all(0), 1), &s->error);
    CHECK(material_add_bump(m, bump, &s->scene.arena, &s->error));
    return m;
}

static struct material *bump_over(struct stage *s, enum material_kind kind, struct image *image, double height) {
    struct bump bump = bump_of(s, kind, image, height, false);
    return raised_white(s, &bump);
}

/* Holes where the image is black. */
static struct material *cut_out(struct stage *s, struct image *image, struct material *base) {
    struct material *m = scene_material(&s->scene, MATERIAL_IMAGE, base, &s->error);
    struct texture_image picture = {.image = image, .mapping = MAPPING_BY_SHAPE};
    CHECK(material_cut(m, &picture, 0, &s->scene.arena, &s->error));
    return m;
}

/* The shading normal of the material and the hit of a ray. */
static bool shading_normal(struct stage *s, struct ray ray, struct hit *hit, struct vec3 *normal) {
    struct world_scratch scratch;
    struct surface_inputs inputs;
    if (!world_scratch_init(&scratch, &s->world))
        return false;
    *normal = vec3_all(0);
    bool met = world_nearest(&s->world, &ray, &scratch, hit);
    if (met) {
        material_inputs_at(&s->world.surfaces, &s->world.surfaces.materials[hit->material], hit, &inputs);
        *normal = inputs.normal;
    }
    world_scratch_destroy(&scratch);
    return met;
}

static struct ray down_z(double x, double y) {
    return (struct ray){.origin = {x, y, 50}, .direction = {0, 0, -1}, .t_max = INFINITY};
}

static void check_vector(struct vec3 a, struct vec3 b, double tolerance) {
    CHECK_NEAR(vec3_length(vec3_sub(a, b)), 0, tolerance);
}

static void random_transform(struct stage *s, struct test_random *random, struct node *node) {
    stage_scale(s, node, test_uniform(random, 0.4, 2), test_uniform(random, -2, -0.4), test_uniform(random, 0.4, 2));
    for (int axis = 0; axis < 3; axis++)
        stage_rotate(s, node, axis, test_uniform(random, 0, 360));
    stage_scale(s, node, test_uniform(random, 0.5, 2), test_uniform(random, 0.5, 2), test_uniform(random, 0.5, 2));
}

static struct node *add_shape(struct stage *s, struct shape shape, const struct material *material) {
    struct node *node = stage_sphere(s, s->root, material);
    node->shape = shape;
    return node;
}

/* A square in z = 0 with vt from its lower left corner. */
static struct mesh *square_mesh(bool smooth) {
    static const double vertices[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    static const double uvs[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    static const double normals[4][3] = {{-1, 0, 2}, {1, 0, 2}, {1, 0, 2}, {-1, 0, 2}};
    static const uint32_t starts[2] = {0, 4}, corners[4] = {0, 1, 2, 3};
    struct mesh_input input = {.name = "square",
                               .vertex_count = 4,
                               .face_count = 1,
                               .vertices = vertices,
                               .face_start = starts,
                               .vertex_index = corners,
                               .uv_count = 4,
                               .uvs = uvs,
                               .uv_index = corners};
    if (smooth) {
        input.normal_count = 4;
        input.normals = normals;
        input.normal_index = corners;
    }
    struct error error = {0};
    return mesh_create(&input, &error);
}

static uint32_t fill_shapes(struct shape out[8], struct mesh *mesh) {
    uint32_t count = 0;
    out[count++] = (struct shape){.kind = SHAPE_SPHERE, .sphere = {{0.3, 0, 0}, 1.5}};
    out[count++] = (struct shape){.kind = SHAPE_BOX, .box = {{-1, -1, -1}, {1, 2, 1}}};
    out[count++] = (struct shape){.kind = SHAPE_ELLIPSOID, .ellipsoid = {{0, 0, 0}, {1, 1.5, 0.7}}};
    out[count++] = (struct shape){.kind = SHAPE_TORUS, .torus = {1, 0.4}};
    out[count++] = (struct shape){.kind = SHAPE_MESH, .mesh = mesh};
    return count;
}

TEST(bump_maps_of_constant_pictures_leave_every_bit_of_the_normal) {
    struct mesh *mesh = square_mesh(true);
    struct image *level = paint(half, 37, 20, 8), *blue = paint(neutral_blue, 16, 16, 8);
    struct test_random random = {5};
    struct shape shapes[8];
    uint32_t count = fill_shapes(shapes, mesh), met = 0;
    for (uint32_t i = 0; i < 2 * count; i++) {
        struct stage s;
        stage_begin(&s, 1);
        struct material *m = i % 2 ? bump_over(&s, MATERIAL_BUMP, level, 3) : bump_over(&s, MATERIAL_NORMAL, blue, 1);
        random_transform(&s, &random, add_shape(&s, shapes[i / 2], m));
        CHECK(stage_build(&s, s.root, ACCEL_AUTO));
        for (int k = 0; k < 400; k++) {
            struct hit hit;
            struct vec3 normal = {0, 0, 0};
            struct ray ray = down_z(test_uniform(&random, -2, 2), test_uniform(&random, -2, 2));
            ray.footprint.spread = k % 3 ? 0 : test_uniform(&random, 0, 0.02);
            if (!shading_normal(&s, ray, &hit, &normal))
                continue;
            met++;
            CHECK(memcmp(&normal, &hit.normal, sizeof normal) == 0);
        }
        stage_end(&s);
    }
    CHECK(met > 1000);
    image_release(level);
    image_release(blue);
    mesh_release(mesh);
}

/* Heights that rise evenly to the right by h over a face are a plane: z = h x before the map. */
TEST(bump_ramp_tilts_the_normal_by_the_closed_form_under_affine_maps) {
    struct image *right = paint(ramp_right, 255, 4, 16), *down = paint(ramp_down, 4, 255, 16);
    struct test_random random = {11};
    int met = 0;
    for (int i = 0; i < 60; i++) {
        struct stage s;
        stage_begin(&s, 1);
        double height = test_uniform(&random, -0.8, 0.8);
        struct material *m = bump_over(&s, MATERIAL_BUMP, i % 2 ? down : right, height);
        struct node *node = stage_cube(&s, s.root, m);
        random_transform(&s, &random, node);
        CHECK(stage_build(&s, s.root, ACCEL_AUTO));
        struct transform map = node_parent_from_node(node);
        for (int k = 0; k < 20; k++) {
            /* Towards a point of the face z = 1, from outside. */
            struct vec3 p = {test_uniform(&random, 0.05, 0.95), test_uniform(&random, 0.05, 0.95), 1};
            struct vec3 from = affine_point(&map.forward, vec3_add(p, vec3_make(0.1, 0.2, 1)));
            struct vec3 to = affine_point(&map.forward, p);
            struct ray ray = {.origin = from, .direction = vec3_sub(to, from), .t_max = INFINITY};
            struct hit hit;
            struct vec3 normal = {0, 0, 0};
            if (!shading_normal(&s, ray, &hit, &normal) || fabs(hit.pattern_point.z - 1) > 1e-9)
                continue;
            met++;
            struct vec3 tilted = i % 2 ? vec3_make(0, RAMP * height, 1) : vec3_make(-RAMP * height, 0, 1);
            check_vector(normal, vec3_normalize(transform_normal(&map, tilted)), 1e-9);
        }
        stage_end(&s);
    }
    CHECK(met > 1000);
    image_release(right);
    image_release(down);
}

/* The real surface: a ball with radius 1 + h F; its normal by differences. The terms that Blinn neglects are of order h
 * F. */
TEST(bumps_on_a_ball_are_the_normals_of_the_ball_with_those_heights) {
    const double height = 1e-3, pi = 3.14159265358979323846, e = 1e-5;
    struct image *image = paint(waves, 1024, 512, 16);
    struct stage s;
    stage_begin(&s, 1);
    (void)stage_sphere(&s, s.root, bump_over(&s, MATERIAL_BUMP, image, height));
    CHECK(stage_build(&s, s.root, ACCEL_AUTO));
    double max = 0;
    for (int i = 0; i < 300; i++) {
        double a = 0.4 + 2.3 * i / 300, b = -0.9 + 1.8 * ((i * 37) % 300) / 300;
        struct vec3 direction = {sin(b) * sin(a), cos(a), cos(b) * sin(a)};
        struct ray ray = {.origin = vec3_scale(direction, 9), .direction = vec3_negate(direction), .t_max = INFINITY};
        struct vec3 corners[4], normal, p[4];
        struct hit hit;
        CHECK(shading_normal(&s, ray, &hit, &normal));
        const double steps[4][2] = {{e, 0}, {-e, 0}, {0, e}, {0, -e}};
        for (int k = 0; k < 4; k++) {
            double a1 = a + steps[k][0], b1 = b + steps[k][1];
            corners[k] = vec3_make(sin(b1) * sin(a1), cos(a1), cos(b1) * sin(a1));
            double u = (atan2(-corners[k].z, -corners[k].x) + pi) / (2 * pi), v = a1 / pi;
            p[k] = vec3_scale(corners[k], 1 + height * waves(u, v).r);
        }
        struct vec3 real = vec3_normalize(vec3_cross(vec3_sub(p[0], p[1]), vec3_sub(p[2], p[3])));
        real = vec3_dot(real, direction) < 0 ? vec3_negate(real) : real;
        max = fmax(max, vec3_length(vec3_sub(real, direction)));
        check_vector(normal, real, 2e-5);
    }
    CHECK(max > 1e-3);
    stage_end(&s);
    image_release(image);
}

TEST(bump_heights_rise_out_of_the_hollow_that_an_operand_leaves) {
    struct image *image = paint(ramp_right, 255, 4, 16);
    struct stage s;
    stage_begin(&s, 1);
    struct material *m = bump_over(&s, MATERIAL_BUMP, image, 0.5);
    struct node *outer = stage_cube(&s, s.root, m), *inner = scene_node(&s.scene, NODE_GEOMETRY, "inner", &s.error);
    s.root->first_child = s.root->last_child = NULL;
    inner->shape = (struct shape){.kind = SHAPE_BOX, .box = {{0.1, 0.1, 0.5}, {0.9, 0.9, 2}}};
    inner->material = m;
    struct node *csg = scene_combine(&s.scene, "csg", NODE_DIFFERENCE, (struct node *[]){outer, inner}, 2, &s.error);
    CHECK(node_add_child(&s.scene, s.root, csg, &s.error));
    CHECK(stage_build(&s, s.root, ACCEL_AUTO));
    struct hit hit;
    struct vec3 normal = {0, 0, 0};
    /* The floor of the hollow is the inner box's side -z, whose pictures run to the left. */
    CHECK(shading_normal(&s, down_z(0.5, 0.5), &hit, &normal));
    CHECK_NEAR(hit.normal_geometric.z, 1, 0);
    check_vector(normal, vec3_normalize(vec3_make(RAMP * 0.5 / 0.8, 0, 1)), 1e-9);
    stage_end(&s);
    image_release(image);
}

TEST(normal_maps_turn_to_where_their_colours_point) {
    struct image *right = paint(tilted_right, 8, 8, 8), *up = paint(tilted_up, 8, 8, 8);
    double slope = 2 * 76.0 / 255, rise = 2 * 230.0 / 255 - 1;
    struct mesh *mesh = square_mesh(false);
    struct shape shapes[2] = {{.kind = SHAPE_MESH, .mesh = mesh}, {.kind = SHAPE_BOX, .box = {{0, 0, -1}, {1, 1, 0}}}};
    for (int i = 0; i < 8; i++) {
        struct stage s;
        stage_begin(&s, 1);
        struct bump map = bump_of(&s, MATERIAL_NORMAL, i & 1 ? up : right, 1, (i & 4) != 0);
        struct material *m = raised_white(&s, &map);
        (void)add_shape(&s, shapes[i >> 1 & 1], m);
        CHECK(stage_build(&s, s.root, ACCEL_AUTO));
        struct hit hit;
        struct vec3 normal, wanted = i & 1 ? vec3_make(0, slope, rise) : vec3_make(i & 4 ? -slope : slope, 0, rise);
        CHECK(shading_normal(&s, down_z(0.3, 0.6), &hit, &normal));
        check_vector(normal, vec3_normalize(wanted), 1e-9);
        stage_end(&s);
    }
    image_release(right);
    image_release(up);
    mesh_release(mesh);
}

TEST(bump_maps_turn_the_interpolated_normal_of_smooth_meshes) {
    struct image *image = paint(ramp_right, 255, 4, 16);
    struct mesh *mesh = square_mesh(true);
    struct stage s;
    stage_begin(&s, 1);
    (void)add_shape(&s, (struct shape){.kind = SHAPE_MESH, .mesh = mesh}, bump_over(&s, MATERIAL_BUMP, image, 0.25));
    CHECK(stage_build(&s, s.root, ACCEL_AUTO));
    struct hit hit;
    struct vec3 normal = {0, 0, 0};
    CHECK(shading_normal(&s, down_z(0.75, 0.5), &hit, &normal));
    CHECK(hit.normal.x > 0.2);
    struct vec3 wanted = vec3_normalize(vec3_add(hit.normal, vec3_make(-RAMP * 0.25, 0, 0)));
    check_vector(normal, wanted, 1e-9);
    stage_end(&s);
    image_release(image);
    mesh_release(mesh);
}

TEST(bumps_finer_than_a_pixel_average_to_flat) {
    struct image *image = paint(stripes, 256, 4, 8);
    struct stage s;
    stage_begin(&s, 1);
    (void)stage_cube(&s, s.root, bump_over(&s, MATERIAL_BUMP, image, 0.05));
    CHECK(stage_build(&s, s.root, ACCEL_AUTO));
    double near_tilt = 0, far_tilt = 0;
    for (int i = 0; i < 200; i++) {
        struct hit hit;
        struct vec3 normal = {0, 0, 0};
        struct ray ray = down_z(0.2 + 0.003 * i, 0.5);
        CHECK(shading_normal(&s, ray, &hit, &normal));
        near_tilt = fmax(near_tilt, fabs(normal.x));
        ray.footprint.width = 0.1;
        CHECK(shading_normal(&s, ray, &hit, &normal));
        far_tilt = fmax(far_tilt, fabs(normal.x));
    }
    CHECK(near_tilt > 0.9);
    CHECK(far_tilt < 0.01);
    stage_end(&s);
    image_release(image);
}

/* Heights, given or by default, scale with the object: twice the object, twice the bumps, the same bits of the normals.
 */
TEST(bumps_grow_with_the_object_bit_by_bit) {
    struct image *image = paint(waves, 64, 64, 16);
    struct vec3 first[2] = {{0, 0, 0}};
    for (int turn = 0; turn < 26; turn++) {
        int i = turn / 2 - 6;
        bool relative = turn % 2;
        struct stage s;
        stage_begin(&s, 1);
        struct bump map = bump_of(&s, MATERIAL_BUMP, image, BUMP_HEIGHT, false);
        map.relative = relative;
        struct material *m = raised_white(&s, &map);
        double size = ldexp(1, 3 * i);
        stage_scale(&s, stage_cube(&s, s.root, m), size, size, size);
        CHECK(stage_build(&s, s.root, ACCEL_AUTO));
        struct hit hit;
        struct vec3 normal = {0, 0, 0};
        struct ray ray = down_z(0.3 * size, 0.6 * size);
        ray.origin.z = 50 * size;
        CHECK(shading_normal(&s, ray, &hit, &normal));
        if (i == -6)
            first[relative] = normal;
        CHECK(fabs(normal.x) > 1e-3 && fabs(normal.y) > 1e-3);
        CHECK(memcmp(&normal, &first[relative], sizeof normal) == 0);
        stage_end(&s);
    }
    image_release(image);
}

static struct colour left_half(double x, double y) {
    (void)y;
    return colour_all(x < 0.5 ? 1 : 0);
}

TEST(pictures_of_opacity_cut_holes_that_show_what_is_behind) {
    struct image *image = paint(left_half, 64, 64, 8);
    struct stage s;
    stage_begin(&s, 1);
    struct material *red = stage_phong(&s, colour_make(1, 0, 0), colour_all(0), 1);
    red->phong.unlit = true;
    struct material *cut = cut_out(&s, image, red);
    struct mesh *mesh = square_mesh(false);
    struct node *card = add_shape(&s, (struct shape){.kind = SHAPE_MESH, .mesh = mesh}, cut);
    stage_scale(&s, card, 2, 2, 1);
    stage_move(&s, card, -1, -1, 0);
    s.sky.colour = colour_make(0, 0, 1);
    s.camera.fov = 6;
    CHECK(stage_render(&s, 20, 20));
    for (uint32_t x = 0; x < 20; x++) {
        if (x == 9 || x == 10)
            continue; /* the edge between the halves of the picture */
        CHECK_NEAR(stage_pixel(&s, x, 7).r, x < 10, 1e-6);
        CHECK_NEAR(stage_pixel(&s, x, 7).b, x >= 10, 1e-6);
    }
    stage_end(&s);
    image_release(image);
    mesh_release(mesh);
}

TEST(light_falls_through_the_holes_of_pictures_of_opacity) {
    struct image *image = paint(left_half, 64, 64, 8);
    struct mesh *mesh = square_mesh(false);
    for (int i = 0; i < 3; i++) {
        struct stage s;
        stage_begin(&s, 1);
        struct material *cut = cut_out(&s, image, stage_phong(&s, colour_all(1), colour_all(0), 1));
        struct node *card = add_shape(&s, (struct shape){.kind = SHAPE_MESH, .mesh = mesh}, cut);
        stage_scale(&s, card, 4, 4, 1);
        stage_move(&s, card, -2, -2, 4);
        stage_rotate(&s, card, 1, 60); /* out of the camera's way */
        struct node *wall = stage_cube(&s, s.root, stage_phong(&s, colour_all(1), colour_all(0), 1));
        stage_scale(&s, wall, 20, 20, 1);
        stage_move(&s, wall, -10, -10, -1);
        s.settings.accel = (enum accel_kind[]){ACCEL_AUTO, ACCEL_GRID, ACCEL_NONE}[i];
        s.lights[s.light_count++] = (struct light){.kind = LIGHT_DIRECTIONAL,
                                                   .direction = vec3_normalize(vec3_make(-sqrt(3) / 2, 0, -0.5)),
                                                   .colour = {1, 1, 1},
                                                   .falloff = {1, 0, 0}};
        s.camera.fov = 40;
        CHECK(stage_render(&s, 60, 20));
        /* On the line y = 0 of the wall the card's shadow is 4 / cos 60 wide; only its left half exists. */
        int dark = 0, all = 0;
        for (uint32_t x = 0; x < 60; x++) {
            double at = ((double)x + 0.5 - 30) / 10 * 10 * tan(20 * 3.14159265358979 / 180);
            all++;
            dark += stage_pixel(&s, x, 10).r == 0;
            if (fabs(at) < 3.8 && (fabs(at) > 0.5))
                CHECK_NEAR(stage_pixel(&s, x, 10).r, at < 0 ? 0 : 0.5, 1e-6);
        }
        CHECK(dark * 10 > all * 2);
        stage_end(&s);
    }
    image_release(image);
    mesh_release(mesh);
}

/* Tiled and moved: u becomes su u + ou, v counted from below likewise; footprints and tangents follow. */
TEST(tiles_and_offsets_place_pictures_by_the_formula_on_every_mapping) {
    struct test_random random = {41};
    for (int i = 0; i < 600; i++) {
        struct hit hit = {.has_uv = true,
                          .u = test_uniform(&random, 0, 1),
                          .v = test_uniform(&random, 0, 1),
                          .dpdu = {test_uniform(&random, 0.5, 2), 0.1, 0},
                          .dpdv = {0.2, test_uniform(&random, 0.5, 2), 0},
                          .footprint = 0.01,
                          .pattern_scale = 1};
        enum surface_layout layout = (enum surface_layout)(i % 3);
        hit.pattern_normal = vec3_normalize(
            vec3_make(test_uniform(&random, -1, 1), test_uniform(&random, -0.9, 0.9), test_uniform(&random, -1, 1)));
        hit.pattern_point = hit.pattern_normal;
        enum texture_mapping mapping = texture_mapping_on(i % 2 ? MAPPING_UV : MAPPING_BY_SHAPE, layout);
        struct texture_image plain = {.mapping = mapping, .wrap = IMAGE_MIRROR};
        struct texture_image tiled = plain;
        tiled.apart = true;
        double scale[2] = {test_uniform(&random, -3, 3), test_uniform(&random, -3, 3)};
        double offset[2] = {test_uniform(&random, -3, 3), test_uniform(&random, -3, 3)};
        for (int k = 0; k < 2; k++)
            tiled.scale[k] = scale[k], tiled.offset[k] = offset[k];
        tiled.wrap_v = IMAGE_CLAMP;
        struct texcoord a, b;
        CHECK(texture_coordinates(&plain, &hit, &a) && texture_coordinates(&tiled, &hit, &b));
        CHECK_NEAR(b.u, scale[0] * a.u + offset[0], 1e-12);
        CHECK_NEAR(1 - b.v, scale[1] * (1 - a.v) + offset[1], 1e-12);
        CHECK_NEAR(b.width_u, a.width_u * fabs(scale[0]), 1e-12);
        CHECK_NEAR(b.width_v, a.width_v * fabs(scale[1]), 1e-12);
        check_vector(vec3_scale(b.dpdu, scale[0]), a.dpdu, 1e-12);
        check_vector(vec3_scale(b.dpdv, scale[1]), a.dpdv, 1e-12);
        CHECK(b.wrap_u == IMAGE_MIRROR && b.wrap_v == IMAGE_CLAMP);
    }
}
