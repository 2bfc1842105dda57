/* One bad element is not a bad file: it is left out, with one warning for its kind, and nothing is lost without a word.
 */
#include "tests/unit/model_makers.h"

#include <math.h>

#define SQUARES "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 3 0 0\nv 3 1 0\nv 2 1 0\n"

static bool parse_text(struct model *model, const char *path, const char *text, const struct model_options *options) {
    static const struct model_options single = {.single_file = true};
    struct error error;
    bool ok = parse_model(model, path, text, strlen(text), options ? options : &single, &error);
    if (!ok)
        test_fail(__FILE__, __LINE__, "%s: %s", path, error.text);
    return ok;
}

static struct surface surface_of(const struct model *model, uint32_t triangle) {
    struct crossing crossing = {.part = triangle, .u = 0.25, .v = 0.25};
    struct ray ray = test_ray(vec3_make(0, 0, 1), vec3_make(0, 0, -1));
    struct surface surface;
    mesh_describe(only_mesh(model), &ray, &crossing, &surface);
    return surface;
}

struct left {
    const char *path, *text;
    uint32_t triangles;
    const char *warning; /* the only one, behind the path; NULL: there is none */
};

static void check_left(const struct left *cases, size_t count) {
    for (size_t i = 0; i < count; i++) {
        struct model model;
        if (!parse_text(&model, cases[i].path, cases[i].text, NULL))
            continue;
        CHECK_EQ_INT(mesh_triangle_count(only_mesh(&model)), cases[i].triangles);
        if (model.warning_count != (cases[i].warning != NULL) ||
            (cases[i].warning && strcmp(model.warnings[0] + strlen(cases[i].path), cases[i].warning) != 0))
            test_fail(__FILE__, __LINE__, "%s\nhas %d warnings: %s", cases[i].text, model.warning_count,
                      model.warning_count ? model.warnings[0] : "");
        model_destroy(&model);
    }
}

#define NO_NORMAL "an index of vn that does not exist: its face is flat"
#define NO_COORDINATES "an index of vt that does not exist: its face has no texture coordinates"

TEST(obj_elements_that_are_wrong_are_left_out_with_one_warning) {
    static const struct left cases[] = {
        {"t.obj", SQUARES "vn 0 0 1\nf 1//1 2//1 3//1 4//2\nf 5//1 6//1 7//1 8//1\n", 4, ":10: " NO_NORMAL},
        {"t.obj", SQUARES "vn 0 0 1\nf 1//1 2//3 3//2\nf 5//-1 6//-2 7//0\n", 2,
         ":10: " NO_NORMAL " (4 times, the first here)"},
        {"t.obj", SQUARES "f 5//-1 6 7\nf 1//9 2//9 3//1\nvn 0 0 1\n", 2,
         ":9: " NO_NORMAL " (3 times, the first here)"},
        {"t.obj", SQUARES "f 1/99999999999999999999 2 3\nf 5/1 6/2 7\nvt 0\nvt 0\n", 2, ":9: " NO_COORDINATES},
        {"t.obj", SQUARES "vn nan 0 0\nvn 0 0 1\nf 1//1 2//2 3//2\n", 1,
         ":9: vn needs 3 finite numbers: faces that use it are flat"},
        {"t.obj", SQUARES "vn 0 1\nvn 0 0 x\nvn 0 0 1e31\nvn 1.#QNAN 0 0\nf 1//1 2//2 3//2\n", 1,
         ":9: vn needs 3 finite numbers: faces that use it are flat (4 times, the first here)"},
        {"t.obj", SQUARES "vt -inf 0\nf 1/1 2/1 3/1\n", 1,
         ":9: vt needs finite numbers: faces that use it have no texture coordinates"},
        {"t.obj", SQUARES "v 0 nan 0\nv inf 0 0\nf 1 2 3\n", 1,
         ":9: a vertex is not finite, and no face uses it (2 times, the first here)"},
        {"t.obj", SQUARES "f 1 2\nf 1 2 3\nf 7\nf 1 99\nf\n", 1,
         ":9: f needs at least 3 corners: the face is left out (4 times, the first here)"},
        {"t.obj", SQUARES "V 0 0 0\nf 1 2 3\nF 1 2 3\nl 1 2\nF 5 6 7\n", 1,
         ":9: 4 lines with a keyword that gray does not read, the first here: 'V' (1), 'F' (2), 'l' (1)"},
        {"t.obj",
         SQUARES "f\xc2\xa0"
                 "5 6 7\nf 1 2 3\n",
         1, ":9: 1 line with a keyword that gray does not read, the first here: 'f\\xc2\\xa05' (1)"},
        {"t.obj", SQUARES "a\nb\nc\nd\ne\nfff\ngg\nh\nf 1 2 3\n", 1,
         ":9: 8 lines with a keyword that gray does not read, the first here: 'a' (1), 'b' (1), 'c' (1), 'd' (1), "
         "'e' (1), 'fff' (1) and others"},
        {"t.obj", "# text\ng a\ns 1\ns off\nvp 0\ncstype bezier\ndeg 3\nend\nlod 1\n" SQUARES "f 1 2 3\n", 1, NULL},
    };
    check_left(cases, sizeof cases / sizeof *cases);
}

TEST(obj_faces_without_usable_normals_are_flat_and_the_others_keep_theirs) {
    struct model model;
    if (!parse_text(&model, "t.obj",
                    SQUARES "vn 0 1 1\nvn nan 0 0\nf 1//1 2//1 3//2\nf 5//1 6//1 7//9\nf 5//1 6//1 7//1\n", NULL))
        return;
    for (uint32_t t = 0; t < 3; t++)
        CHECK_NEAR(vec3_normalize(surface_of(&model, t).shading_normal).z, t < 2 ? 1 : sqrt(0.5), 1e-12);
    CHECK_EQ_INT(model.warning_count, 2);
    model_destroy(&model);
}

TEST(obj_read_leniently_keeps_every_face_of_the_strict_reading) {
    static const char *const texts[] = {
        SQUARES "vn 0 0 1\nf 1//1 2//1 3//1 4//2\nf 5//1 6//1 7//1 8//-7\n",
        SQUARES "vt 0 0\nf 1/1 2/0 3/9 4/1\nf 5 6 7/8 8\n",
        SQUARES "v nan 0 0\nvn nan 0 0\nf 1//1 2//1 3//1\nf 1 2\n",
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        struct model strict, lenient;
        if (!parse_text(&strict, "t.obj", texts[i], NULL))
            continue;
        if (parse_text(&lenient, "t.obj", texts[i], &(struct model_options){.single_file = true, .forgive = true})) {
            CHECK(same_faces(only_mesh(&strict), only_mesh(&lenient)));
            CHECK_EQ_INT(lenient.warning_count, strict.warning_count);
            model_destroy(&lenient);
        }
        model_destroy(&strict);
    }
    struct model model;
    static const struct model_options forgiving = {.single_file = true, .forgive = true};
    if (parse_text(&model, "t.obj", SQUARES "v nan 0 0\nf 1 2 3\nf 1 2 99\nf 9 1 2\nf 1 0 3\n", &forgiving)) {
        CHECK_EQ_INT(mesh_triangle_count(only_mesh(&model)), 1);
        model_destroy(&model);
    }
    struct error error;
    CHECK(!parse_model(&model, "t.obj", "f 0 -1 0\n", 9, &forgiving, &error));
    CHECK_TEXT(error.text, "t.obj: the file has no vertices");
}

TEST(colours_of_obj_vertices_are_shown_and_multiply_the_materials_of_the_file) {
    static const struct {
        const char *text;
        struct colour colour; /* of the first triangle */
        uint32_t white;       /* the material of faces without one */
    } cases[] = {
        {"v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nf 1 2 3\n", {1, 0, 0}, 0},
        {"v 0 0 0 1 0 .5 0\nv 1 0 0 1 0 .5 0\nv 0 1 0 1 0 .5 0\nf 1 2 3\n", {0, 0.5, 0}, 0},
        {"v 0 0 0 255 51 0\nv 1 0 0 255 51 0\nv 0 1 0 255 51 0\nf 1 2 3\n", {1, 0.2, 0}, 0},
        {"v 0 0 0\nv 1 0 0 nan 0 0\nv 0 1 0 0 0 0\nf 1 2 3\n", {0.75, 0.75, 0.75}, 0},
        {"mtllib m.mtl\nv 0 0 0 0 0 1\nv 1 0 0 0 0 1\nv 0 1 0 0 0 1\nusemtl a\nf 1 2 3\n", {0, 0, 1}, MODEL_NONE},
        {"mtllib m.mtl\nv 0 0 0 0 0 1\nv 1 0 0 0 0 1\nv 0 1 0 0 0 1\nf 1 2 3\nusemtl a\nf 1 2 3\n", {0, 0, 1}, 1},
    };
    test_write_text(test_path("m.mtl"), "newmtl a\nKd 1 1 0.5\n");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct model model;
        if (!parse_text(&model, test_path("t.obj"), cases[i].text, &(struct model_options){0}))
            continue;
        struct surface surface = surface_of(&model, 0);
        CHECK(surface.has_colour && colour_max_abs(colour_sub(surface.colour, cases[i].colour)) < 1e-6);
        for (size_t k = 0; k < model.materials.count; k++)
            CHECK(model_materials(&model)[k].by_vertex);
        const uint32_t *slots = model_meshes(&model)->slots.items;
        bool has_white = false;
        for (size_t k = 0; k < model_meshes(&model)->slots.count; k++)
            has_white |= cases[i].white != MODEL_NONE && slots[k] == cases[i].white;
        CHECK_EQ_INT(has_white, cases[i].white != MODEL_NONE);
        CHECK_EQ_INT(model.warning_count, strstr(cases[i].text, "nan") != NULL);
        model_destroy(&model);
    }
}

#define HEAD "ply\nformat ascii 1.0\n"
#define XYZ "property float x\nproperty float y\nproperty float z\n"
#define FACES "property list uchar int vertex_indices\n"
#define RGB "property uchar red\nproperty uchar green\nproperty uchar blue\n"
#define POINTS "0 0 0\n1 0 0\n0 1 0\n1 1 0\n"

TEST(ply_elements_that_are_wrong_are_left_out_with_one_warning) {
    static const struct left cases[] = {
        {"t.ply",
         HEAD "element vertex 4\n" XYZ "element face 4\n" FACES "end_header\n" POINTS "3 0 1 2\n2 0 1\n0\n3 1 2 3\n", 2,
         ":15: a face needs at least 3 corners: it is left out (2 times, the first here)"},
        {"t.ply",
         HEAD "element vertex 4\n" XYZ "element face 1\n" FACES "end_header\n0 0 0\n1 0 0\n0 1 0\nnan inf 0\n3 0 1 2\n",
         1, ":13: a vertex is not finite, and no face uses it"},
        {"t.ply",
         HEAD "element vertex 3\n" XYZ "property float nx\nproperty float ny\nproperty float nz\nelement face 1\n" FACES
              "end_header\n0 0 0 nan 0 0\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n",
         1, ":13: a normal is not finite: faces that use it are flat"},
        {"t.ply",
         HEAD "element vertex 3\n" XYZ "property float u\nproperty float v\nelement face 1\n" FACES
              "end_header\n0 0 0 0 0\n1 0 0 0 1e999\n0 1 0 0 1.#INF\n3 0 1 2\n",
         1, ":13: texture coordinates are not finite: faces that use them have none (2 times, the first here)"},
        {"t.ply",
         HEAD "element vertex 3\n" XYZ "element edge 2\nproperty int a\nelement face 1\n" FACES
              "element camera 1\nproperty float x\nend_header\n0 0 0\n1 0 0\n0 1 0\n1\n2\n3 0 1 2\n7\n",
         1, ": elements that gray does not show: 'edge' (2), 'camera' (1)"},
        {"t.ply",
         "\xef\xbb\xbf" HEAD "element vertex 3\n" XYZ "element face 1\n" FACES
         "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
         1, NULL},
        {"t.ply",
         HEAD "element vertex 3\n" XYZ RGB "element face 1\n" FACES RGB
              "end_header\n0 0 0 1 2 3\n1 0 0 1 2 3\n0 1 0 1 2 3\n3 0 1 2 1 2 3\n",
         1, ":16: the faces have colours, which are not shown: the vertices have colours"},
    };
    check_left(cases, sizeof cases / sizeof *cases);
}

TEST(ply_colours_of_faces_are_shown) {
    static const char *const colours[] = {
        RGB, "property float diffuse_red\nproperty float diffuse_green\nproperty float diffuse_blue\n"};
    for (int i = 0; i < 2; i++)
        for (int weld = 0; weld < 2; weld++) {
            char text[800];
            struct model model;
            (void)snprintf(text, sizeof text,
                           HEAD "element vertex 4\n" XYZ "element face 2\n" FACES
                                "%selement tristrips 1\nproperty list int int vertex_indices\nend_header\n" POINTS
                                "3 0 1 2 %s 0 0\n3 1 3 2 0 0 %s\n3 0 1 3\n",
                           colours[i], i ? "1" : "255", i ? "1" : "255");
            if (!parse_text(&model, "t.ply", text, &(struct model_options){.single_file = true, .weld = weld}))
                continue;
            for (uint32_t t = 0; t < 3; t++) {
                struct surface surface = surface_of(&model, t);
                CHECK(surface.has_colour && surface.colour.r == (t != 1) && surface.colour.g == (t == 2) &&
                      surface.colour.b == (t != 0));
            }
            CHECK(model_materials(&model)[0].by_vertex && model_materials(&model)[0].kd.r == 1);
            CHECK_EQ_INT(model.warning_count, 0);
            model_destroy(&model);
        }
}

TEST(ply_binary_data_behind_a_header_of_cr_may_begin_with_the_byte_of_lf) {
    struct bytes b = {0};
    bytes_print(&b, "ply\rformat binary_little_endian 1.0\relement vertex 3\rproperty uchar x\rproperty uchar y\r"
                    "property uchar z\relement face 1\rproperty list uchar uchar vertex_indices\rend_header\r");
    bytes_add(&b, "\n\0\0\0\1\0\0\0\1\3\0\1\2", 13);
    struct model model;
    struct error error;
    CHECK(parse_model(&model, "t.ply", b.data, b.size, NULL, &error));
    CHECK_TEXT(error.text, "");
    CHECK_NEAR(mesh_bounds(only_mesh(&model)).max.x, 10, 0);
    model_destroy(&model);
    bytes_free(&b);
}

TEST(ply_picture_of_its_comment_is_that_of_its_texture_coordinates) {
    struct model model;
    test_write_text(test_path("a b.png"), "x");
    static const char text[] = HEAD "comment TextureFile a b.png\nelement vertex 3\n" XYZ
                                    "property float u\nproperty float v\nelement face 1\n" FACES
                                    "end_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n";
    if (!parse_text(&model, test_path("t.ply"), text, &(struct model_options){0}))
        return;
    CHECK_TEXT(model_materials(&model)[0].map_kd.path, test_path("a b.png"));
    CHECK_EQ_INT(model.warning_count, 0);
    model_destroy(&model);
}

#define FACET(x) "facet normal 0 0 1\nouter loop\nvertex " x " 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"

TEST(stl_text_is_read_as_programs_write_it) {
    static const struct left cases[] = {
        {"t.stl", "solid a\rsolid a\r" FACET("0") "endsolid a\rendsolid a\r", 1, NULL},
        {"t.stl",
         "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nend loop\nEND FACET\n"
         "end solid a\n",
         1, NULL},
        {"t.stl", FACET("0") FACET("2"), 2, NULL},
        {"t.stl", "\xef\xbb\xbf\r\nsolid\n" FACET("0"), 1, NULL},
        {"t.stl", "solid a\n" FACET("0") "endsolid a\nsolid b\n" FACET("2") "endsolid\n\x1a\x1a", 2, NULL},
        {"t.stl", "solid a\n" FACET("0") "endsolida\nmade by a program\n", 1,
         ":10: 1 line with a keyword that gray does not read, the first here: 'made' (1)"},
        {"t.stl", "solid a\n" FACET("0") "facet normal 0 0 1\nouter loop\nvert", 1,
         ":11: the file ends in a triangle, which is left out"},
        {"t.stl", "solid a\n" FACET("0") "facet normal 0 0 1\nouter loop\nvertex 2 0 0\nvertex 3 0 0\nvertex 2 1 0\n",
         1, ":14: the file ends in a triangle, which is left out"},
    };
    check_left(cases, sizeof cases / sizeof *cases);
    struct model model;
    struct error error;
    static const char padded[] = "solid a\n" FACET("0") "endsolid a\n\0\0\0\0\0\0";
    CHECK(parse_model(&model, "t.stl", padded, sizeof padded, NULL, &error));
    CHECK_EQ_INT(model.warning_count, 0);
    model_destroy(&model);
}

TEST(text_of_two_bytes_a_letter_is_named_in_every_format) {
    static const char *const words[] = {"# x", "ply", "solid"}, *const paths[] = {"t.obj", "t.ply", "t.stl"};
    for (int i = 0; i < 12; i++) {
        struct bytes b = {0};
        char message[80];
        bool big = i / 3 % 2;
        if (i < 6)
            bytes_add(&b, big ? "\xfe\xff" : "\xff\xfe", 2);
        for (const char *c = words[i % 3]; *c; c++)
            bytes_number(&b, (uint64_t)*c, 2, big);
        (void)snprintf(message, sizeof message, "%s:1: this is UTF-16 text; gray reads plain ASCII and UTF-8",
                       paths[i % 3]);
        check_refused(paths[i % 3], b.data, b.size, message);
        bytes_free(&b);
    }
}

static void binary_stl(struct bytes *b, const char *header, uint32_t count, const uint16_t *attributes,
                       uint32_t facets) {
    char start[80] = "";
    memcpy(start, header, strlen(header));
    bytes_add(b, start, sizeof start);
    bytes_number(b, count, 4, false);
    for (uint32_t f = 0; f < facets; f++) {
        for (int k = 0; k < 12; k++)
            bytes_float(b, (k == 6) + (k == 10) + (k % 3 == 2 ? (double)f : 0), false);
        bytes_number(b, attributes[f], 2, false);
    }
}

TEST(stl_binary_with_more_or_less_than_its_count_is_read_with_a_warning) {
    static const struct {
        uint32_t count, facets;
        size_t more; /* bytes */
        uint32_t triangles;
        const char *warning;
    } cases[] = {
        {2, 2, 0, 2, NULL},
        {1, 3, 0, 3, "t.stl: byte 80: the file states 1 triangles, but has bytes for 3: all are shown"},
        {0, 3, 0, 3, "t.stl: byte 80: the file states 0 triangles, but has bytes for 3: all are shown"},
        {2, 2, 7, 2, "t.stl: byte 184: 7 bytes follow the 2 triangles and are left out"},
        {3, 2, 49, 2, "t.stl: byte 233: the file ends in the last triangle, which is left out"},
    };
    static const uint16_t none[3] = {0};
    static const char rest[50] = {0};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct bytes b = {0};
        struct model model;
        struct error error;
        binary_stl(&b, "x", cases[i].count, none, cases[i].facets);
        bytes_add(&b, rest, cases[i].more);
        CHECK(parse_model(&model, "t.stl", b.data, b.size, NULL, &error));
        CHECK_TEXT(error.text, "");
        if (error.kind == ERROR_NONE) {
            CHECK_EQ_INT(mesh_triangle_count(only_mesh(&model)), cases[i].triangles);
            CHECK_EQ_INT(model.warning_count, cases[i].warning != NULL);
            if (model.warning_count)
                CHECK_TEXT(model.warnings[0], cases[i].warning);
            model_destroy(&model);
        }
        bytes_free(&b);
    }
    /* Bytes that are no triangles are not read as some. */
    struct bytes b = {0};
    struct model model;
    struct error error;
    binary_stl(&b, "x", 1, none, 1);
    for (int i = 0; i < 50; i++)
        bytes_number(&b, 0xff, 1, false);
    CHECK(parse_model(&model, "t.stl", b.data, b.size, NULL, &error));
    CHECK_EQ_INT(mesh_triangle_count(only_mesh(&model)), 1);
    CHECK_TEXT(model.warnings[0],
               "t.stl: byte 80: the file states 1 triangles, but has bytes for 2: the others are left "
               "out");
    model_destroy(&model);
    bytes_free(&b);
}

TEST(stl_colours_of_both_conventions_are_shown) {
    static const struct {
        const char *header;
        uint16_t attributes[3];
        struct colour colours[3];
    } cases[] = {
        {"x", {0x8000 | 31 << 10, 0x8000 | 31, 0}, {{1, 0, 0}, {0, 0, 1}, {0.8, 0.8, 0.8}}},
        {"x COLOR=\xff\x33\x01\xff", {31, 31 << 10, 0x8000}, {{1, 0, 0}, {0, 0, 1}, {1, 0.2, 1 / 255.0}}},
        {"COLOR=\xff\x33\x01\xff", {0, 0, 0}, {{1, 0.2, 1 / 255.0}, {1, 0.2, 1 / 255.0}, {1, 0.2, 1 / 255.0}}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct bytes b = {0};
        struct model model;
        struct error error;
        binary_stl(&b, cases[i].header, 3, cases[i].attributes, 3);
        CHECK(parse_model(&model, "t.stl", b.data, b.size, NULL, &error));
        CHECK_TEXT(error.text, "");
        for (uint32_t t = 0; t < 3; t++) {
            struct surface surface = surface_of(&model, t);
            CHECK(surface.has_colour && colour_max_abs(colour_sub(surface.colour, cases[i].colours[t])) < 1e-6);
        }
        CHECK(model_materials(&model)[0].by_vertex);
        model_destroy(&model);
        bytes_free(&b);
    }
    struct bytes b = {0};
    struct model model;
    struct error error;
    binary_stl(&b, "x", 1, (const uint16_t[]){1234}, 1); /* without bit 15 it is no colour */
    CHECK(parse_model(&model, "t.stl", b.data, b.size, NULL, &error));
    CHECK(!surface_of(&model, 0).has_colour && model.materials.count == 0);
    model_destroy(&model);
    bytes_free(&b);
}
