/* What nodes of glTF do to their meshes: flat maps, morphs, skins, instances, and all of them at a time. */
#include "tests/unit/model_makers.h"

#ifdef HAVE_JANSSON

/* A file with the bytes as buffer 0 and view 0; `rest` is everything else. The bytes start with the corners {0, 0, 0},
 * {1, 0, 0}, {0, 1, 0} of a triangle: accessor 0 of most tests. */
static bool parse_with(struct model *model, const struct bytes *data, const char *rest,
                       const struct model_options *options, struct error *error) {
    struct bytes text = {0};
    bytes_print(&text, "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":%zu,\"uri\":\"data:;base64,",
                data->size);
    write_base64(&text, data);
    bytes_print(&text, "\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":%zu}],", data->size);
    bytes_add(&text, rest, strlen(rest));
    bytes_add(&text, "}", 1);
    bool ok = parse_model(model, "t.gltf", text.data, text.size, options, error);
    bytes_free(&text);
    return ok;
}

static void add_triangle(struct bytes *b) {
    for (int i = 0; i < 9; i++)
        bytes_float(b, i == 3 || i == 7, false);
}

static void add_floats(struct bytes *b, const double *numbers, size_t count) {
    for (size_t i = 0; i < count; i++)
        bytes_float(b, numbers[i], false);
}

#define POSITIONS "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}"
#define ACCESSOR(offset, component, count, type)                                                                       \
    "{\"bufferView\":0,\"byteOffset\":" #offset ",\"componentType\":" #component ",\"count\":" #count                  \
    ",\"type\":\"" type "\"}"

/* Vertex `v` of the mesh of a node, in the model's space. */
static struct vec3 vertex_of(const struct model *model, uint32_t node, uint32_t v) {
    const struct model_node *nodes = model_nodes(model);
    uint32_t count;
    const double(*vertices)[3] = mesh_vertices(model_meshes(model)[nodes[node].mesh].mesh, &count);
    struct vec3 p = {vertices[v][0], vertices[v][1], vertices[v][2]};
    for (uint32_t at = node; at != MODEL_NONE; at = nodes[at].parent)
        p = affine_point(&nodes[at].parent_from_node.forward, p);
    return p;
}

#define CHECK_POINT(p, px, py, pz)                                                                                     \
    do {                                                                                                               \
        struct vec3 point = (p);                                                                                       \
        CHECK_NEAR(point.x, px, 1e-6);                                                                                 \
        CHECK_NEAR(point.y, py, 1e-6);                                                                                 \
        CHECK_NEAR(point.z, pz, 1e-6);                                                                                 \
    } while (0)

TEST(a_gltf_node_scaled_flat_is_a_flat_mesh_with_everything_below_it) {
    struct bytes b = {0};
    struct model model;
    struct error error = {0};
    add_triangle(&b);
    /* A turn about x by 90 degrees takes y to z; the parent then makes z 0. */
    CHECK(parse_with(&model, &b,
                     "\"accessors\":[" POSITIONS "],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
                     "\"nodes\":[{\"scale\":[2,3,0],\"translation\":[0,0,7],\"children\":[1,2,3,4]},"
                     "{\"mesh\":0,\"translation\":[1,0,5]},"
                     "{\"mesh\":0,\"rotation\":[0.3826834323650898,0,0,0.9238795325112867]},"
                     "{\"mesh\":0,\"scale\":[0,0,1]},{\"mesh\":0,\"matrix\":[1,0,0,0,0,0,0,0,0,0,1,0,0,0,0,1]}]",
                     NULL, &error));
    CHECK_TEXT(error.text, "");
    /* The two that have no area are named together. */
    CHECK_EQ_INT(model.meshes.count, 2);
    CHECK_EQ_INT(model.warning_count, 1);
    CHECK_TEXT(model.warnings[0], "t.gltf: nodes[3] and 1 more: it is scaled to nothing and not shown");
    CHECK_POINT(vertex_of(&model, 2, 1), 4, 0, 7);
    CHECK_POINT(vertex_of(&model, 2, 2), 2, 3, 7);
    CHECK_POINT(vertex_of(&model, 4, 2), 0, 3 * sqrt(0.5), 7);
    model_destroy(&model);
    bytes_free(&b);
}

TEST(gltf_morph_targets_have_the_weights_of_the_mesh_or_of_the_node) {
    static const double difference[] = {0, 0, 2, 0, 0, 2, 0, 0, 4};
    struct bytes b = {0};
    struct model model;
    struct error error = {0};
    add_triangle(&b);
    add_floats(&b, difference, 9);
    CHECK(parse_with(
        &model, &b,
        "\"accessors\":[" POSITIONS "," ACCESSOR(
            36, 5126, 3, "VEC3") "],"
                                 "\"meshes\":[{\"weights\":[0.5,0],\"primitives\":[{\"attributes\":{\"POSITION\":0},"
                                 "\"targets\":[{\"POSITION\":1},{\"POSITION\":1}]}]}],"
                                 "\"nodes\":[{\"mesh\":0},{\"mesh\":0,\"weights\":[1,0.25]},{\"mesh\":0}]",
        NULL, &error));
    CHECK_TEXT(error.text, "");
    CHECK_EQ_INT(model.meshes.count, 2);
    CHECK_EQ_INT(model_nodes(&model)[0].mesh, model_nodes(&model)[2].mesh);
    CHECK_POINT(vertex_of(&model, 0, 1), 1, 0, 1);
    CHECK_POINT(vertex_of(&model, 0, 2), 0, 1, 2);
    CHECK_POINT(vertex_of(&model, 1, 2), 0, 1, 5);
    model_destroy(&model);
    bytes_free(&b);
}

/* Joints and weights in bytes, and the matrices of two joints of which the second one moves by -1 along z. */
static void add_skin(struct bytes *b) {
    static const uint8_t joints[3][4] = {{0, 1, 9, 9}, {1, 0, 9, 9}, {0, 1, 9, 9}};
    static const uint8_t weights[3][4] = {{255, 0, 0, 0}, {255, 0, 0, 0}, {51, 204, 0, 0}};
    add_triangle(b);
    bytes_add(b, joints, sizeof joints);
    bytes_add(b, weights, sizeof weights);
    for (int joint = 0; joint < 2; joint++)
        for (int i = 0; i < 16; i++)
            bytes_float(b, i == 14 ? -joint : i % 5 == 0, false);
}

#define SKIN                                                                                                           \
    "\"accessors\":[" POSITIONS "," ACCESSOR(                                                                          \
        36, 5121, 3, "VEC4") ",{\"bufferView\":0,\"byteOffset\":48,"                                                   \
                             "\"componentType\":5121,\"count\":3,\"type\":\"VEC4\",\"normalized\":true}," ACCESSOR(    \
                                 60, 5126, 2, "MAT4") "],"                                                             \
                                                      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,"  \
                                                      "\"JOINTS_0\":1,\"WEIGHTS_0\":2}}]}],"

TEST(gltf_skins_move_vertices_by_their_joints_and_not_by_the_node) {
    struct bytes b = {0};
    struct model model;
    struct error error = {0};
    add_skin(&b);
    CHECK(parse_with(&model, &b,
                     SKIN "\"skins\":[{\"joints\":[1,2],\"inverseBindMatrices\":3}],\"nodes\":["
                          "{\"mesh\":0,\"skin\":0,\"translation\":[100,0,0],\"scale\":[0,0,0]},"
                          "{\"translation\":[0,10,0],\"children\":[2]},{\"translation\":[0,0,5]}]",
                     NULL, &error));
    CHECK_TEXT(error.text, "");
    CHECK_EQ_INT(model.warning_count, 0);
    CHECK_POINT(vertex_of(&model, 1, 0), 0, 10, 0);
    CHECK_POINT(vertex_of(&model, 1, 1), 1, 10, 4);
    CHECK_POINT(vertex_of(&model, 1, 2), 0, 11, 3.2);
    model_destroy(&model);
    bytes_free(&b);
}

TEST(gltf_skins_with_joints_that_do_not_exist_or_in_a_ring_end_with_an_answer) {
    static const char *const cases[][2] = {
        {"\"skins\":[{\"joints\":[1]}],\"nodes\":[{\"mesh\":0,\"skin\":0},{}]",
         "t.gltf: meshes[0].primitives[0]: joint 1, but the skin has only 1"},
        {"\"skins\":[{\"joints\":[1,7]}],\"nodes\":[{\"mesh\":0,\"skin\":0},{}]",
         "t.gltf: skins[0]: joint 1 does not exist"},
        {"\"skins\":[{\"joints\":[]}],\"nodes\":[{\"mesh\":0,\"skin\":0},{}]", "t.gltf: skins[0]: it has no joints"},
        {"\"skins\":[{\"joints\":[1,1,1],\"inverseBindMatrices\":3}],\"nodes\":[{\"mesh\":0,\"skin\":0},{}]",
         "t.gltf: skins[0]: accessors[3] does not have a matrix for each of the 3 joints"},
        {"\"scenes\":[{\"nodes\":[0]}],\"skins\":[{\"joints\":[1,2]}],\"nodes\":[{\"mesh\":0,\"skin\":0},"
         "{\"children\":[2]},{\"children\":[1]}]",
         ""}};
    struct bytes b = {0};
    add_skin(&b);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char rest[2000];
        struct model model;
        struct error error = {0};
        (void)snprintf(rest, sizeof rest, "%s%s", SKIN, cases[i][0]);
        CHECK_EQ_INT(parse_with(&model, &b, rest, NULL, &error), cases[i][1][0] == '\0');
        CHECK_TEXT(error.text, cases[i][1]);
        if (error.kind == ERROR_NONE)
            model_destroy(&model);
    }
    bytes_free(&b);
}

#define INSTANCING(attributes) "\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{" attributes "}}}"

TEST(gltf_instances_share_the_mesh_of_their_node) {
    static const double shifts[] = {1, 2, 3, 4, 5, 6}, scales[] = {1, 1, 1, 2, 0, 2};
    struct bytes b = {0};
    struct model model;
    struct error error = {0};
    add_triangle(&b);
    add_floats(&b, shifts, 6);
    add_floats(&b, scales, 6);
    CHECK(parse_with(
        &model, &b,
        "\"accessors\":[" POSITIONS "," ACCESSOR(36, 5126, 2, "VEC3") "," ACCESSOR(
            60, 5126, 2,
            "VEC3") "],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
                    "\"extensionsRequired\":[\"EXT_mesh_gpu_instancing\"],\"nodes\":[{\"mesh\":0,\"name\":\"tree\","
                    "\"translation\":[0,0,10]," INSTANCING("\"TRANSLATION\":1,\"SCALE\":2") "},{\"mesh\":0}]",
        NULL, &error));
    CHECK_TEXT(error.text, "");
    CHECK_EQ_INT(model.warning_count, 0);
    CHECK_EQ_INT(model.nodes.count, 4);
    CHECK_EQ_INT(model.meshes.count, 2); /* the second instance is flat */
    CHECK_TEXT(model_nodes(&model)[1].name, "tree");
    CHECK_EQ_INT(model_nodes(&model)[1].mesh, model_nodes(&model)[3].mesh);
    CHECK_POINT(vertex_of(&model, 1, 1), 2, 2, 13);
    CHECK_POINT(vertex_of(&model, 2, 1), 6, 5, 16);
    model_destroy(&model);
    /* A count without bytes is refused. */
    CHECK(!parse_with(
        &model, &b,
        "\"accessors\":[" POSITIONS ",{\"componentType\":5126,\"count\":900000000,\"type\":\"VEC3\"}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0," INSTANCING(
            "\"TRANSLATION\":1") "}]",
        NULL, &error));
    CHECK_TEXT(error.text, "t.gltf: nodes[0]: accessors[1] does not have the TRANSLATION of its instances");
    bytes_free(&b);
}

TEST(gltf_instances_have_as_many_scales_as_translations_even_none) {
    static const double scales[] = {1, 1, 1, 1, 1, 1};
    struct bytes b = {0};
    struct model model;
    struct error error = {0};
    add_triangle(&b);
    add_floats(&b, scales, 6);
    CHECK(
        !parse_with(&model, &b,
                    "\"accessors\":[" POSITIONS "," ACCESSOR(36, 5126, 0, "VEC3") "," ACCESSOR(
                        36, 5126, 2, "VEC3") "],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
                                             "\"nodes\":[{\"mesh\":0," INSTANCING("\"TRANSLATION\":1,\"SCALE\":2") "}]",
                    NULL, &error));
    CHECK_TEXT(error.text, "t.gltf: nodes[0]: accessors[2] does not have the SCALE of its instances");
    bytes_free(&b);
}

/* `count` times the text, with commas between. */
static void add_repeated(struct bytes *b, const char *text, int count) {
    for (int i = 0; i < count; i++)
        bytes_print(b, "%s%s", i ? "," : "", text);
}

/* Nodes times primitives, targets or variants that make no vertex: a megabyte took minutes. */
TEST(gltf_files_cannot_have_primitives_read_more_often_than_their_size_allows) {
    static const char *const cases[][3] = {
        {"{\"attributes\":{\"POSITION\":0}}", "{\"mode\":0}", "{\"mesh\":0,\"scale\":[1,1,0]}"},
        {"{\"attributes\":{\"POSITION\":0},\"targets\":[{}]}", "{\"mode\":0,\"targets\":[{},{},{}]}",
         "{\"mesh\":0,\"weights\":[0]}"},
        {"{\"attributes\":{\"POSITION\":0}}",
         "{\"mode\":0,\"extensions\":{\"KHR_materials_variants\":{\"mappings\":[{},{},{},{}]}}}",
         "{\"mesh\":0,\"scale\":[1,1,0]}"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct bytes b = {0}, rest = {0};
        struct model model;
        struct error error = {0};
        struct model_options options = {.variant = i == 2 ? "v" : NULL};
        add_triangle(&b);
        bytes_print(&rest,
                    "\"accessors\":[" POSITIONS "],\"extensions\":{\"KHR_materials_variants\":{\"variants\":["
                    "{\"name\":\"v\"}]}},\"meshes\":[{\"primitives\":[%s,",
                    cases[i][0]);
        add_repeated(&rest, cases[i][1], 400);
        bytes_print(&rest, "]}],\"nodes\":[");
        add_repeated(&rest, cases[i][2], 400);
        bytes_add(&rest, "]", 2);
        CHECK(!parse_with(&model, &b, (const char *)rest.data, &options, &error));
        CHECK(strstr(error.text, "t.gltf: meshes[0].primitives[") && strstr(error.text, ": more vertices than a file"));
        bytes_free(&b);
        bytes_free(&rest);
    }
}

TEST(gltf_files_cannot_have_more_materials_of_nodes_than_their_size_allows) {
    struct bytes b = {0}, rest = {0};
    struct model model;
    struct error error = {0};
    add_triangle(&b);
    bytes_print(&rest, "\"accessors\":[" POSITIONS "],\"materials\":[");
    add_repeated(&rest, "{}", 1000);
    bytes_print(&rest, "],\"meshes\":[{\"primitives\":[");
    for (int i = 0; i < 1000; i++)
        bytes_print(&rest, "%s{\"attributes\":{\"POSITION\":0},\"material\":%d}", i ? "," : "", i);
    bytes_print(&rest, "]}],\"nodes\":[");
    add_repeated(&rest, "{\"mesh\":0}", 3000);
    bytes_add(&rest, "]", 2);
    CHECK(!parse_with(&model, &b, (const char *)rest.data, NULL, &error));
    CHECK(strstr(error.text, "t.gltf: nodes[") && strstr(error.text, ": more vertices than a file"));
    bytes_free(&b);
    bytes_free(&rest);
}

/* The second vertex of the triangle at a time of animation `name`. */
static struct vec3 moved(const struct bytes *b, const char *name, double time) {
    static const char rest[] =
        "\"accessors\":[" POSITIONS "," ACCESSOR(36, 5126, 2, "SCALAR") "," ACCESSOR(44, 5126, 2, "VEC3") "," ACCESSOR(
            68, 5126, 2,
            "VEC4") "," ACCESSOR(100, 5126, 6,
                                 "VEC3") "," ACCESSOR(172, 5126, 2,
                                                      "SCALAR") "],"
                                                                "\"meshes\":[{\"primitives\":[{\"attributes\":{"
                                                                "\"POSITION\":0},\"targets\":[{\"POSITION\":0}]}]}],"
                                                                "\"nodes\":[{\"mesh\":0,\"translation\":[0,0,1],"
                                                                "\"rotation\":[0,0,0,1],\"scale\":[1,1,1]}],"
                                                                "\"animations\":["
                                                                "{\"name\":\"slide\",\"channels\":[{\"sampler\":0,"
                                                                "\"target\":{\"node\":0,\"path\":\"translation\"}}],"
                                                                "\"samplers\":[{\"input\":1,\"output\":2}]},"
                                                                "{\"name\":\"jump\",\"channels\":[{\"sampler\":0,"
                                                                "\"target\":{\"node\":0,\"path\":\"translation\"}}],"
                                                                "\"samplers\":[{\"input\":1,\"output\":2,"
                                                                "\"interpolation\":\"STEP\"}]},"
                                                                "{\"name\":\"turn\",\"channels\":[{\"sampler\":0,"
                                                                "\"target\":{\"node\":0,\"path\":\"rotation\"}}],"
                                                                "\"samplers\":[{\"input\":1,\"output\":3}]},"
                                                                "{\"name\":\"curve\",\"channels\":[{\"sampler\":0,"
                                                                "\"target\":{\"node\":0,\"path\":\"scale\"}}],"
                                                                "\"samplers\":[{\"input\":1,\"output\":4,"
                                                                "\"interpolation\":\"CUBICSPLINE\"}]},"
                                                                "{\"name\":\"grow\",\"channels\":[{\"sampler\":0,"
                                                                "\"target\":{\"node\":0,\"path\":\"weights\"}}],"
                                                                "\"samplers\":[{\"input\":1,\"output\":5}]}]";
    struct model_options options = {.animated = true, .time = time, .animation = name};
    struct model model;
    struct error error = {0};
    struct vec3 p = {0, 0, 0};
    if (parse_with(&model, b, rest, &options, &error)) {
        p = vertex_of(&model, 0, 1);
        model_destroy(&model);
    }
    CHECK_TEXT(error.text, "");
    return p;
}

TEST(gltf_animations_move_nodes_and_weights_at_a_time) {
    static const double keys[] = {1, 3, 0, 0, 0, 4, 8, 0, 0, 0, 0, 1, 0, 0, -0.7071067811865476, -0.7071067811865476};
    /* Before, at and after each key: tangents 0 and scale 1, then tangent {3, 0, 0} and scale 2. */
    static const double curve[] = {0, 0, 0, 1, 1, 1, 0, 0, 0, 3, 0, 0, 2, 1, 1, 0, 0, 0}, weights[] = {0, 1};
    struct bytes b = {0};
    add_triangle(&b);
    add_floats(&b, keys, 16);
    add_floats(&b, curve, 18);
    add_floats(&b, weights, 2);
    CHECK_POINT(moved(&b, "slide", 0), 1, 0, 0);
    CHECK_POINT(moved(&b, "slide", 1.5), 2, 2, 0);
    CHECK_POINT(moved(&b, "1", 99), 5, 8, 0);
    CHECK_POINT(moved(&b, "jump", 2.9), 1, 0, 0);
    CHECK_POINT(moved(&b, "jump", 3), 5, 8, 0);
    /* A quarter turn about z, by the shorter arc. */
    CHECK_POINT(moved(&b, "turn", 2), sqrt(0.5), sqrt(0.5), 1);
    /* t = 1/2: 1/2 1 + 1/2 2 + 2 (1/8 - 1/4) 3. */
    CHECK_POINT(moved(&b, "curve", 2), 0.75, 0, 1);
    CHECK_POINT(moved(&b, "grow", 2.5), 1.75, 0, 1);
    bytes_free(&b);
}

TEST(a_variant_of_gltf_materials_is_chosen_by_its_name) {
    static const char rest[] =
        "\"accessors\":[" POSITIONS "],\"extensions\":{\"KHR_materials_variants\":{\"variants\":["
        "{\"name\":\"day\"},{\"name\":\"night\"}]}},\"extensionsUsed\":[\"KHR_materials_variants\"],"
        "\"materials\":[{\"name\":\"white\"},{\"name\":\"black\"}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"material\":0,\"extensions\":{"
        "\"KHR_materials_variants\":{\"mappings\":[{\"material\":1,\"variants\":[1]}]}}}]}]";
    static const char *const cases[][2] = {{NULL, "white"}, {"day", "white"}, {"night", "black"}};
    struct bytes b = {0};
    struct model model;
    struct error error = {0};
    add_triangle(&b);
    for (size_t i = 0; i < 3; i++) {
        struct model_options options = {.variant = cases[i][0]};
        CHECK(parse_with(&model, &b, rest, &options, &error));
        CHECK_TEXT(((const char **)model_meshes(&model)->slot_names.items)[0], cases[i][1]);
        CHECK_EQ_INT(model.warning_count, 0);
        model_destroy(&model);
    }
    struct model_options options = {.variant = "dusk"};
    CHECK(!parse_with(&model, &b, rest, &options, &error));
    CHECK_TEXT(error.text, "t.gltf: variant: the file has no 'dusk'; it has 'day', 'night'");
    bytes_free(&b);
}

TEST(gltf_meshes_have_second_texture_coordinates) {
    static const double uvs[] = {0, 0, 0, 0, 0, 0, 0.25, 0.5, 1.25, 0.5, 0.25, 0.5};
    struct bytes b = {0};
    struct model model;
    struct error error = {0};
    struct surface surface;
    struct ray ray = {.origin = {0.25, 0.25, 1}, .direction = {0, 0, -1}, .t_max = INFINITY};
    add_triangle(&b);
    add_floats(&b, uvs, 12);
    CHECK(parse_with(
        &model, &b,
        "\"accessors\":[" POSITIONS "," ACCESSOR(36, 5126, 3, "VEC2") "," ACCESSOR(
            60, 5126, 3, "VEC2") "],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1,"
                                 "\"TEXCOORD_1\":2}}]}]",
        NULL, &error));
    CHECK_TEXT(error.text, "");
    mesh_describe(model_meshes(&model)->mesh, &ray, &(struct crossing){.u = 0.5, .v = 0.25}, &surface);
    CHECK(surface.has_uv && surface.has_second);
    CHECK_NEAR(surface.u, 0, 0);
    CHECK_NEAR(surface.second.u, 0.75, 1e-12);
    CHECK_NEAR(surface.second.v, 0.5, 1e-12);
    model_destroy(&model);
    bytes_free(&b);
}

TEST(an_animation_that_a_file_does_not_have_is_an_error_that_names_what_it_has) {
    struct model_options options = {.animated = true, .animation = "run"};
    struct bytes b = {0};
    struct model model;
    struct error error = {0};
    add_triangle(&b);
    CHECK(!parse_with(&model, &b, "\"animations\":[{\"name\":\"walk\"},{}]", &options, &error));
    CHECK_TEXT(error.text, "t.gltf: animation: the file has no 'run'; it has 'walk', ''");
    bytes_free(&b);
}

TEST(an_optional_extension_of_gltf_is_never_an_error) {
    struct bytes b = {0};
    struct model model;
    struct error error = {0};
    add_triangle(&b);
    static const char one[] =
        "\"extensionsUsed\":[\"KHR_draco_mesh_compression\",\"XYZ_unknown\"],\"accessors\":[" POSITIONS
        ",{\"componentType\":5123,\"count\":3,\"type\":\"SCALAR\"}],\"meshes\":[{\"primitives\":["
        "{\"attributes\":{\"POSITION\":0},\"indices\":1},{\"attributes\":{\"POSITION\":0}}]}]";
    CHECK(parse_with(&model, &b, one, NULL, &error));
    CHECK_TEXT(error.text, "");
    CHECK_EQ_INT(mesh_triangle_count(model_meshes(&model)[0].mesh), 1);
    CHECK_EQ_INT(model.warning_count, 3);
    CHECK_TEXT(model.warnings[1], "t.gltf: XYZ_unknown is not read");
    CHECK_TEXT(model.warnings[2], "t.gltf: meshes[0].primitives[0]: it is left out: the file does not have its "
                                  "vertices in a form that gray reads");
    model_destroy(&model);
    /* A fallback buffer without bytes, and nothing else to show. */
    CHECK(!parse_with(&model, &b,
                      "\"extensionsUsed\":[\"EXT_meshopt_compression\"],\"accessors\":[{\"bufferView\":1,"
                      "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],\"bufferViews\":[{},{\"buffer\":1,"
                      "\"byteLength\":36,\"extensions\":{\"EXT_meshopt_compression\":{\"buffer\":0}}}],\"buffers\":[{},"
                      "{\"byteLength\":36}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]",
                      NULL, &error));
    CHECK_TEXT(error.text, "t.gltf: meshes[0].primitives[0]: it is left out: the file does not have its vertices in a "
                           "form that gray reads");
    bytes_free(&b);
}

TEST(gltf_files_with_skins_and_animations_survive_changes_and_failed_allocations) {
    struct bytes b = {0}, text = {0};
    add_skin(&b);
    bytes_print(&text, "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":%zu,\"uri\":\"data:;base64,",
                b.size);
    write_base64(&text, &b);
    bytes_print(&text,
                "\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":%zu}],%s\"skins\":[{\"joints\":[1,2],"
                "\"inverseBindMatrices\":3}],\"nodes\":[{\"mesh\":0,\"skin\":0,\"children\":[3]},{\"children\":[2]},{},"
                "{\"mesh\":0,\"scale\":[1,1,0]," INSTANCING("\"TRANSLATION\":0") "}]}",
                b.size, SKIN);
    check_changed_anywhere("t.gltf", &text, 2000);
    check_failed_allocations("t.gltf", &text);
    bytes_free(&text);
    bytes_free(&b);
}

#endif
