#include "tests/unit/model_makers.h"
#include "tests/unit/surface_makers.h"

#include "formats/model_node.h"
#include "image/png_write.h"

#ifndef HAVE_JANSSON

TEST(gltf_without_its_parser_says_so) {
    check_text_refused("t.gltf", "{}", "t.gltf: this build cannot read glTF (it was made without jansson)");
}

#else

#define ASSET "\"asset\":{\"version\":\"2.0\"}"
/* Three corners (float), followed by three indices (u8). */
#define TRIANGLE_URI "data:application/gltf-buffer;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAECAA=="
#define TRIANGLE                                                                                                       \
    "\"buffers\":[{\"byteLength\":40,\"uri\":\"" TRIANGLE_URI                                                          \
    "\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},"                                                          \
    "{\"buffer\":0,\"byteOffset\":36,\"byteLength\":3}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,"      \
    "\"count\":3,\"type\":\"VEC3\"},{\"bufferView\":1,\"componentType\":5121,\"count\":3,\"type\":\"SCALAR\"}]"
#define MESH "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}]"

static bool parse_text(struct model *model, const char *text, struct error *error) {
    return parse_model(model, "t.gltf", text, strlen(text), NULL, error);
}

TEST(gltf_and_glb_give_the_mesh_that_obj_gives) {
    struct maker m = {0};
    maker_sphere(&m, 6);
    maker_round(&m);
    struct mesh *wanted = maker_mesh(&m);
    for (int binary = 0; binary < 2; binary++) {
        struct bytes b = {0};
        struct model model;
        struct error error;
        binary ? write_glb(&b, &m) : write_gltf(&b, &m);
        bool ok = parse_model(&model, binary ? "t.glb" : "t", b.data, b.size, NULL, &error);
        CHECK_TEXT(error.text, "");
        if (ok) {
            CHECK(same_faces(only_mesh(&model), wanted));
            CHECK(mesh_is_closed(only_mesh(&model)));
            model_destroy(&model);
        }
        bytes_free(&b);
    }
    mesh_release(wanted);
    maker_free(&m);
}

TEST(gltf_buffers_and_pictures_may_be_files_beside_it) {
    char path[400];
    uint8_t *bytes;
    struct bytes b = {0};
    for (int i = 0; i < 9; i++)
        bytes_float(&b, i == 3 || i == 7, false);
    bytes_number(&b, 0x020100, 4, false);
    (void)snprintf(path, sizeof path, "%s/my data.bin", test_folder());
    test_write_file(path, b.data, b.size);
    bytes = b.data;
    (void)snprintf(path, sizeof path, "%s/t.gltf", test_folder());
    test_write_text(path, "{" ASSET
                          ",\"buffers\":[{\"byteLength\":40,\"uri\":\"my%20data.bin\"}],\"bufferViews\":[{\"buffer\":0,"
                          "\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":3}],\"accessors\":[{"
                          "\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},{\"bufferView\":1,"
                          "\"componentType\":5121,\"count\":3,\"type\":\"SCALAR\"}]," MESH
                          ",\"images\":[{\"uri\":\"gone.png\"}],\"textures\":[{\"source\":0}],\"materials\":[{"
                          "\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}}]}");
    struct model model;
    struct model_options options = {0};
    struct error error = {0};
    CHECK(model_read(&model, path, &options, &error));
    CHECK_TEXT(error.text, "");
    if (error.kind == ERROR_NONE) {
        CHECK_EQ_INT(mesh_triangle_count(only_mesh(&model)), 1);
        CHECK_EQ_INT(model.warning_count, 1);
        model_destroy(&model);
    }
    free(bytes);
}

/* The point in the space of node `name`. */
static struct vec3 position_of(const struct node *node, const char *name, struct vec3 p, bool *found) {
    if (strcmp(node->name, name) == 0) {
        *found = true;
        return affine_point(&node->parent_from_node.forward, p);
    }
    for (const struct node_child *c = node->first_child; c && !*found; c = c->next) {
        struct vec3 q = position_of(c->node, name, p, found);
        if (*found)
            return affine_point(&node->parent_from_node.forward, q);
    }
    return p;
}

TEST(gltf_nodes_have_matrices_or_parts_and_share_their_mesh) {
    static const char text[] = "{" ASSET "," TRIANGLE "," MESH ",\"scene\":0,\"scenes\":[{\"nodes\":[2]}],\"nodes\":["
                               "{\"name\":\"a\",\"mesh\":0,\"translation\":[1,2,3],\"scale\":[2,2,2],\"rotation\":[0,0,"
                               "0.7071067811865476,0.7071067811865476]},"
                               "{\"name\":\"b\",\"mesh\":0,\"matrix\":[0,1,0,0,-1,0,0,0,0,0,1,0,5,0,0,1]},"
                               "{\"name\":\"root\",\"children\":[0,1,4],\"translation\":[0,0,10]},"
                               "{\"name\":\"elsewhere\",\"mesh\":0},{\"name\":\"flat\",\"mesh\":0,\"scale\":[1,0,1]}]}";
    struct model model;
    struct error error;
    CHECK(parse_text(&model, text, &error));
    CHECK_TEXT(error.text, "");
    CHECK_EQ_INT(model.nodes.count, 5);
    CHECK_EQ_INT(model.warning_count, 0);
    struct assets assets = {0};
    struct scene scene;
    struct model_placing placing = {.name = "all"};
    scene_init(&scene, &assets);
    struct node *root = model_add_nodes(&scene, &model, &placing, &error);
    CHECK_EQ_INT(root->kind, NODE_GROUP);
    bool found = false;
    struct vec3 p = position_of(root, "a", vec3_make(1, 0, 0), &found);
    CHECK(found);
    CHECK_NEAR(p.x, 1, 1e-12);
    CHECK_NEAR(p.y, 4, 1e-12);
    CHECK_NEAR(p.z, 13, 1e-12);
    found = false;
    p = position_of(root, "b", vec3_make(1, 0, 0), &found);
    CHECK(found);
    CHECK_NEAR(p.x, 5, 1e-12);
    CHECK_NEAR(p.y, 1, 1e-12);
    CHECK_NEAR(p.z, 10, 1e-12);
    struct node *first = root->first_child->node->first_child->node;
    CHECK_EQ_INT(first->kind, NODE_GEOMETRY);
    CHECK(first->shape.mesh == first->shape.mesh);
    CHECK_EQ_INT(first->slot_count, 1);
    CHECK_NEAR(first->slots[0]->phong.kd.g, 1, 0);
    scene_destroy(&scene);
    assets_destroy(&assets);
    model_destroy(&model);
}

TEST(cameras_lights_and_animations_of_gltf_are_listed_with_the_transforms_of_their_nodes) {
    static const char text[] =
        "{" ASSET "," TRIANGLE "," MESH ",\"nodes\":[{\"mesh\":0,\"translation\":[0,0,10],\"children\":[1,2,3,4]},"
        "{\"camera\":0,\"name\":\"front\",\"rotation\":[0,1,0,0],\"translation\":[1,2,3]},{\"camera\":1},"
        "{\"camera\":2},{\"extensions\":{\"KHR_lights_punctual\":{\"light\":1}}},"
        "{\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}},\"scale\":[2,3,4]},"
        "{\"extensions\":{\"KHR_lights_punctual\":{\"light\":2}}},"
        "{\"extensions\":{\"KHR_lights_punctual\":{\"light\":9}}}],"
        "\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":0.5,\"aspectRatio\":1.5,\"znear\":1}},"
        "{\"name\":\"plan\",\"type\":\"orthographic\",\"orthographic\":{\"xmag\":3,\"ymag\":2,\"znear\":0,"
        "\"zfar\":1}},{\"type\":\"perspective\",\"perspective\":{\"yfov\":0}}],"
        "\"animations\":[{\"name\":\"walk\",\"channels\":[],\"samplers\":[{\"input\":0,\"output\":0}]},{}],"
        "\"extensionsUsed\":[\"KHR_lights_punctual\"],\"extensions\":{\"KHR_lights_punctual\":{\"lights\":["
        "{\"type\":\"spot\",\"name\":\"key\",\"color\":[1,0.5,0],\"intensity\":40,\"range\":7,"
        "\"spot\":{\"innerConeAngle\":0.1,\"outerConeAngle\":0.2}},{\"type\":\"directional\"},"
        "{\"type\":\"point\",\"intensity\":3}]}}}";
    struct model model;
    struct error error;
    CHECK(parse_text(&model, text, &error));
    CHECK_TEXT(error.text, "");
    CHECK_EQ_INT(model.cameras.count, 2);
    CHECK_EQ_INT(model.lights.count, 3);
    CHECK_EQ_INT(model.animations.count, 2);
    /* One warning for the camera without an angle, one for the light that does not exist. */
    CHECK_EQ_INT(model.warning_count, 2);
    const struct model_camera *camera = model_cameras(&model);
    struct vec3 at = affine_point(&camera->model_from_camera, vec3_make(0, 0, -1));
    CHECK_TEXT(camera[0].name, "front");
    CHECK(camera[0].vertical_angle == 0.5 && camera[0].aspect == 1.5);
    CHECK(at.x == 1 && at.y == 2 && at.z == 14);
    CHECK_TEXT(camera[1].name, "plan");
    CHECK(camera[1].vertical_angle == 0 && camera[1].half_size[0] == 3 && camera[1].half_size[1] == 2);
    const struct model_light *sun = model_lights(&model), *spot = sun + 1, *point = sun + 2;
    CHECK_EQ_INT(sun->kind, MODEL_LIGHT_DIRECTIONAL);
    CHECK(sun->intensity.r == 1 && sun->range == 0 && sun->model_from_light.m[2][3] == 10);
    CHECK_EQ_INT(spot->kind, MODEL_LIGHT_SPOT);
    CHECK_TEXT(spot->name, "key");
    CHECK(spot->intensity.r == 40 && spot->intensity.g == 20 && spot->intensity.b == 0 && spot->range == 7);
    CHECK(spot->inner == 0.1 && spot->outer == 0.2);
    CHECK_EQ_INT(point->kind, MODEL_LIGHT_POINT);
    CHECK(point->intensity.b == 3);
    CHECK_TEXT(model_animations(&model)[0].name, "walk");
    model_destroy(&model);
}

TEST(gltf_file_with_one_mesh_is_one_geometry_node) {
    struct model model;
    struct error error;
    CHECK(parse_text(&model,
                     "{" ASSET "," TRIANGLE "," MESH ",\"nodes\":[{\"children\":[1],\"translation\":[0,0,1]},"
                     "{\"mesh\":0,\"translation\":[0,1,0]}]}",
                     &error));
    CHECK_TEXT(error.text, "");
    struct assets assets = {0};
    struct scene scene;
    scene_init(&scene, &assets);
    struct material red = {.depth = 1};
    struct model_placing placing = {.name = "one", .material = &red};
    struct node *node = model_add_nodes(&scene, &model, &placing, &error);
    CHECK_EQ_INT(node->kind, NODE_GEOMETRY);
    CHECK_TEXT(node->name, "one");
    CHECK(node->material == &red);
    struct vec3 p = affine_point(&node->parent_from_node.forward, vec3_make(1, 0, 0));
    CHECK_NEAR(p.x + 10 * p.y + 100 * p.z, 111, 0);
    scene_destroy(&scene);
    assets_destroy(&assets);
    model_destroy(&model);
}

/* One primitive from a JSON text for its mesh, accessors and views over a buffer. */
static bool parse_parts(struct model *model, const struct bytes *buffer, const char *json, struct error *error) {
    struct bytes text = {0}, b = {0};
    bytes_print(&text, "{" ASSET ",\"buffers\":[{\"byteLength\":%zu}],%s}", buffer->size, json);
    write_glb_of(&b, &text, buffer);
    bool ok = parse_model(model, "t.glb", b.data, b.size, NULL, error);
    bytes_free(&text);
    bytes_free(&b);
    return ok;
}

TEST(gltf_strips_fans_and_lists_without_indices_are_triangles) {
    static const struct {
        int mode;
        uint32_t count, corners[9];
    } cases[] = {{4, 1, {0, 1, 2}}, {5, 3, {0, 1, 2, 1, 3, 2, 2, 3, 4}}, {6, 3, {0, 1, 2, 0, 2, 3, 0, 3, 4}}};
    struct bytes buffer = {0};
    for (int i = 0; i < 5; i++) {
        bytes_float(&buffer, i, false);
        bytes_float(&buffer, i % 2, false);
        bytes_float(&buffer, i * i, false);
    }
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char json[500];
        struct model model;
        struct error error;
        (void)snprintf(json, sizeof json,
                       "\"meshes\":[{\"primitives\":[{\"mode\":%d,\"attributes\":{\"POSITION\":0}}]}],\"accessors\":[{"
                       "\"bufferView\":0,\"componentType\":5126,\"count\":5,\"type\":\"VEC3\"}],\"bufferViews\":[{"
                       "\"buffer\":0,\"byteLength\":60}]",
                       cases[i].mode);
        bool ok = parse_parts(&model, &buffer, json, &error);
        CHECK_TEXT(error.text, "");
        if (!ok)
            continue;
        uint32_t corners;
        CHECK_EQ_INT(mesh_face_count(only_mesh(&model)), cases[i].count);
        for (uint32_t f = 0; f < cases[i].count; f++)
            CHECK(memcmp(mesh_face(only_mesh(&model), f, &corners), cases[i].corners + 3 * f, 12) == 0);
        model_destroy(&model);
    }
    bytes_free(&buffer);
}

TEST(gltf_accessors_of_all_kinds_are_read) {
    /* Interleaved: position (u16 normalized, 3 + pad), uv (u8 normalized, 2 + pad), colour (u8, 4), normal (i8, 3 +
     * pad). */
    struct bytes buffer = {0};
    static const uint16_t positions[3][3] = {{0, 0, 0}, {65535, 0, 0}, {0, 65535, 0}};
    static const uint8_t uvs[3][2] = {{0, 0}, {255, 0}, {0, 255}};
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            bytes_number(&buffer, positions[i][k], 2, false);
        bytes_number(&buffer, 0, 2, false);
        bytes_add(&buffer, uvs[i], 2);
        bytes_number(&buffer, 0, 2, false);
        bytes_number(&buffer, i == 0 ? 0xff0000ff : 0xffff0000, 4, false);
        bytes_number(&buffer, 0x007f0000, 4, false);
    }
    bytes_number(&buffer, 0, 2, false), bytes_number(&buffer, 1, 2, false), bytes_number(&buffer, 2, 2, false);
    bytes_number(&buffer, 0, 2, false);
    /* Sparse: vertex 2 of the positions moves to (0, 32767/65535...). */
    bytes_number(&buffer, 2, 4, false);
    bytes_number(&buffer, 0, 2, false), bytes_number(&buffer, 65535, 2, false), bytes_number(&buffer, 65535, 2, false);
    bytes_number(&buffer, 0, 2, false);
    struct model model;
    struct error error;
    bool ok = parse_parts(
        &model, &buffer,
        "\"extensionsRequired\":[\"KHR_mesh_quantization\"],\"meshes\":[{\"primitives\":[{\"attributes\":{"
        "\"POSITION\":0,\"TEXCOORD_0\":1,\"COLOR_0\":2,\"NORMAL\":3},\"indices\":4}]}],\"bufferViews\":["
        "{\"buffer\":0,\"byteLength\":60,\"byteStride\":20},{\"buffer\":0,\"byteOffset\":60,\"byteLength\":6},"
        "{\"buffer\":0,\"byteOffset\":68,\"byteLength\":4},{\"buffer\":0,\"byteOffset\":72,\"byteLength\":6}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5123,\"normalized\":true,\"count\":3,\"type\":\"VEC3\","
        "\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":2,\"componentType\":5125},\"values\":{\"bufferView\":3}}},"
        "{\"bufferView\":0,\"byteOffset\":8,\"componentType\":5121,\"normalized\":true,\"count\":3,\"type\":\"VEC2\"},"
        "{\"bufferView\":0,\"byteOffset\":12,\"componentType\":5121,\"normalized\":true,\"count\":3,\"type\":\"VEC4\"},"
        "{\"bufferView\":0,\"byteOffset\":16,\"componentType\":5120,\"normalized\":true,\"count\":3,\"type\":\"VEC3\"},"
        "{\"bufferView\":1,\"componentType\":5123,\"count\":3,\"type\":\"SCALAR\"}]",
        &error);
    CHECK_TEXT(error.text, "");
    bytes_free(&buffer);
    if (!ok)
        return;
    uint32_t count;
    const double(*v)[3] = mesh_vertices(only_mesh(&model), &count);
    CHECK_EQ_INT(count, 3);
    CHECK_NEAR(v[1][0], 1, 0);
    CHECK_NEAR(v[2][1], 1, 0);
    CHECK_NEAR(v[2][2], 1, 0);
    struct crossing crossing = {.u = 0.25, .v = 0.5};
    struct ray ray = test_ray(vec3_make(0, 0, 1), vec3_make(0, 0, -1));
    struct surface s;
    mesh_describe(only_mesh(&model), &ray, &crossing, &s);
    CHECK(s.has_uv && s.has_colour);
    CHECK_NEAR(s.u, 0.25, 1e-12);
    CHECK_NEAR(1 - s.v, 0.5, 1e-12); /* glTF counts v from the top */
    CHECK_NEAR(s.colour.r, 0.25, 1e-6);
    CHECK_NEAR(s.colour.b, 0.75, 1e-6);
    CHECK_NEAR(vec3_normalize(s.shading_normal).z, 1, 1e-12);
    model_destroy(&model);
}

static void rows(void *context, uint32_t y, uint8_t *line) {
    (void)context;
    for (int x = 0; x < 4; x++, line += 3) {
        line[0] = (uint8_t)(60 * x);
        line[1] = (uint8_t)(60 * y);
        line[2] = 255;
    }
}

TEST(gltf_materials_and_embedded_pictures_become_ours) {
    struct error error = {0};
    const char *path = test_path("p.png");
    CHECK(png_write_from(FILE_AT(path), &(struct png_source){.width = 4, .height = 4, .bytes = rows}, NULL, &error));
    size_t size;
    char *png = test_read_file(path, &size);
    struct bytes buffer = {0};
    for (int i = 0; i < 9; i++)
        bytes_float(&buffer, i == 3 || i == 7, false);
    for (int i = 0; i < 6; i++)
        bytes_float(&buffer, i == 2 || i == 5, false);
    bytes_add(&buffer, png, size);
    free(png);
    char json[3000];
    (void)snprintf(
        json, sizeof json,
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1},\"material\":0},{"
        "\"attributes\":{"
        "\"POSITION\":0},\"material\":1},{\"attributes\":{\"POSITION\":0}}]}],\"accessors\":[{\"bufferView\":0,"
        "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},{\"bufferView\":1,\"componentType\":5126,\"count\":3,"
        "\"type\":\"VEC2\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,"
        "\"byteLength\":24},{\"buffer\":0,\"byteOffset\":60,\"byteLength\":%zu}],\"images\":[{\"bufferView\":2,"
        "\"mimeType\":"
        "\"image/"
        "png\"}],\"samplers\":[{\"wrapS\":33071,\"wrapT\":33648,\"magFilter\":9728}],\"textures\":[{\"source\":0,"
        "\"sampler\":0}],\"materials\":[{\"name\":\"picture\",\"doubleSided\":true,\"pbrMetallicRoughness\":{"
        "\"baseColorFactor\":[0.5,1,1,1],\"metallicFactor\":0,\"roughnessFactor\":0.5,\"baseColorTexture\":{\"index\":"
        "0,"
        "\"extensions\":{\"KHR_texture_transform\":{\"scale\":[2,3],\"offset\":[0.5,0.25]}}}}},{"
        "\"pbrMetallicRoughness\":{"
        "\"baseColorFactor\":[1,0.5,0,1],\"roughnessFactor\":0}}]",
        size);
    struct model model;
    bool ok = parse_parts(&model, &buffer, json, &error);
    CHECK_TEXT(error.text, "");
    bytes_free(&buffer);
    if (!ok)
        return;
    const struct model_material *m = model_materials(&model);
    CHECK_EQ_INT(model_meshes(&model)[0].slots.count, 3);
    CHECK(m[0].map_kd.image && image_width(m[0].map_kd.image) == 4);
    CHECK_EQ_INT(m[0].map_kd.wrap_u, IMAGE_CLAMP);
    CHECK_EQ_INT(m[0].map_kd.wrap_v, IMAGE_MIRROR);
    CHECK_EQ_INT(m[0].map_kd.filter, IMAGE_NEAREST);
    CHECK_NEAR(m[0].map_kd.offset[1], 1 - 3 - 0.25, 0);
    CHECK_NEAR(m[0].kd.r, 0.5, 0);
    CHECK(m[0].layered && m[1].layered && !m[2].layered);
    CHECK_NEAR(m[0].layers.base_metalness, 0, 0);
    CHECK(m[0].two_sided);
    CHECK_NEAR(m[0].roughness, 0.5, 0);
    CHECK_NEAR(m[1].kd.g, 0.5, 0);
    CHECK_NEAR(m[1].layers.base_metalness, 1, 0);
    CHECK_NEAR(m[1].roughness, 0, 0);
    struct assets assets = {0};
    struct scene scene;
    struct model_placing placing = {.name = "m"};
    scene_init(&scene, &assets);
    struct node *node = model_add_nodes(&scene, &model, &placing, &error);
    /* The texel at uv: (2 u + 0.5, 3 v + 0.25) counted from the top, clamped and mirrored. */
    struct hit hit = {.has_uv = true, .u = 0.05, .v = 1 - 0.125};
    struct surface_inputs inputs;
    surface_inputs_of(node->slots[0], &hit, &inputs);
    CHECK_NEAR(inputs.kd.r, 0.5 * 120 / 255.0, 1e-12);
    CHECK_NEAR(inputs.kd.g, 120 / 255.0, 1e-12);
    CHECK_NEAR(inputs.kd.b, 1, 1e-12);
    hit = (struct hit){.has_colour = true, .colour = {0.5, 0.25, 0}};
    surface_inputs_of(node->slots[2], &hit, &inputs);
    CHECK_NEAR(inputs.kd.g, 0.25, 0);
    scene_destroy(&scene);
    assets_destroy(&assets);
    model_destroy(&model);
}

TEST(gltf_errors_name_the_element) {
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"{\n\"asset\":{]", "t.gltf:2: broken JSON: string or '}' expected near ']' (column 10); a comma may be too many"},
        {"[]", "t.gltf: its JSON: an object must be at the top"},
        {"{}", "t.gltf: asset: glTF of version 2 is read, this file is of version 'none'"},
        {"{\"asset\":{\"version\":\"1.0\"}}",
         "t.gltf: asset: glTF of version 2 is read, this file is of version '1.0'"},
        {"{" ASSET "}", "t.gltf: no faces in this file"},
        {"{" ASSET ",\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]}",
         "t.gltf: extensionsRequired: the file needs 'KHR_draco_mesh_compression', which is not supported; "
         "export it without compression"},
        {"{" ASSET "," MESH "}", "t.gltf: meshes[0].primitives[0]: POSITION is 0, but there are only 0 accessors"},
        {"{" ASSET "," TRIANGLE ",\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":1}}]}]}",
         "t.gltf: meshes[0].primitives[0]: accessors[1] has 1 numbers an element, not 3"},
        {"{" ASSET "," TRIANGLE ",\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":0}]}]}",
         "t.gltf: accessors[0]: it cannot be the indices of vertices"},
        {"{" ASSET "," TRIANGLE ",\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"mode\":7}]}]}",
         "t.gltf: meshes[0].primitives[0]: the mode 7 is unknown"},
        {"{" ASSET "," TRIANGLE "," MESH ",\"nodes\":[{\"mesh\":1}]}",
         "t.gltf: nodes[0]: mesh is 1, but there are only 1 meshes"},
        {"{" ASSET "," TRIANGLE "," MESH ",\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"children\":[0]}]}",
         "t.gltf: nodes[0]: it has two parents, or is below itself"},
        {"{" ASSET "," TRIANGLE "," MESH ",\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"children\":[9]}]}",
         "t.gltf: nodes[0]: a child that does not exist"},
        {"{" ASSET "," TRIANGLE "," MESH ",\"nodes\":[{\"mesh\":0,\"scale\":[1,2]}]}",
         "t.gltf: nodes[0]: scale is not an array of 3 numbers"},
        {"{" ASSET ",\"buffers\":[{\"byteLength\":10000000000,\"uri\":\"" TRIANGLE_URI
         "\"}],\"bufferViews\":[{\"buffer\":0,"
         "\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}]"
         "," MESH "}",
         "t.gltf: meshes[0].primitives[0]: indices is 1, but there are only 1 accessors"},
        {"{" ASSET ",\"buffers\":[{\"byteLength\":10000000000,\"uri\":\"" TRIANGLE_URI
         "\"}],\"bufferViews\":[{\"buffer\":0,"
         "\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],"
         "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]}",
         "t.gltf: buffers[0]: it promises 10000000000 bytes, but there are only 40"},
        {"{" ASSET ",\"buffers\":[{\"byteLength\":40,\"uri\":\"no.bin\"}],\"bufferViews\":[{\"buffer\":0,"
         "\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],"
         "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]}",
         "t.gltf: buffers[0]: the file 'no.bin' is not there"},
        {"{" ASSET ",\"buffers\":[{\"byteLength\":40,\"uri\":\"" TRIANGLE_URI "\"}],\"bufferViews\":[{\"buffer\":0,"
         "\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}],"
         "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]}",
         "t.gltf: accessors[0]: 4 elements of 12 bytes do not fit into its 36 bytes"},
        {"{" ASSET ",\"accessors\":[{\"componentType\":5126,\"count\":4000000000,\"type\":\"VEC3\"}],"
         "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]}",
         "t.gltf: meshes[0].primitives[0]: more vertices than a file of 155 bytes can describe"},
        {"{" ASSET ",\"buffers\":[{\"byteLength\":9,\"uri\":\"data:;base64,AA?A\"}],\"bufferViews\":[{\"buffer\":0,"
         "\"byteLength\":3}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}],"
         "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]}",
         "t.gltf: buffers[0]: a character that is not base64"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        check_text_refused("t.gltf", cases[i].text, cases[i].message);
}

TEST(gltf_numbers_that_are_none_and_vertices_that_do_not_exist_are_errors) {
    struct bytes buffer = {0};
    struct error error;
    struct model model;
    static const char json[] =
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],\"accessors\":[{"
        "\"bufferView\":0,"
        "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},{\"bufferView\":1,\"componentType\":5121,\"count\":3,"
        "\"type\":\"SCALAR\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,"
        "\"byteLength\":3}]";
    for (int i = 0; i < 9; i++)
        bytes_float(&buffer, i == 3 || i == 7, false);
    bytes_number(&buffer, 0x030100, 4, false);
    CHECK(!parse_parts(&model, &buffer, json, &error));
    CHECK_TEXT(error.text, "t.glb: meshes[0].primitives[0]: vertex 3, but there are only 3, counted from 0");
    buffer.data[38] = 2;
    float bad = NAN;
    memcpy(buffer.data + 16, &bad, 4);
    CHECK(!parse_parts(&model, &buffer, json, &error));
    CHECK_TEXT(error.text, "t.glb: accessors[0]: element 1 is not a finite number");
    bytes_free(&buffer);
}

TEST(gltf_survives_cuts_changes_and_failed_allocations) {
    struct maker m = {0};
    maker_sphere(&m, 2);
    maker_round(&m);
    for (int binary = 0; binary < 2; binary++) {
        struct bytes b = {0};
        binary ? write_glb(&b, &m) : write_gltf(&b, &m);
        check_cut_anywhere(binary ? "t.glb" : "t.gltf", &b, 5);
        check_changed_anywhere(binary ? "t.glb" : "t.gltf", &b, 3000);
        check_failed_allocations(binary ? "t.glb" : "t.gltf", &b);
        bytes_free(&b);
    }
    maker_free(&m);
}

#endif
