#include "tests/unit/model_makers.h"

#define HEAD "ply\nformat ascii 1.0\n"
#define XYZ "property float x\nproperty float y\nproperty float z\n"
#define FACES "property list uchar int vertex_indices\n"
#define PLAIN HEAD "element vertex 3\n" XYZ "element face 1\n" FACES "end_header\n"
#define POINTS "0 0 0\n1 0 0\n0 1 0\n"

static struct mesh_input triangle_input(void) {
    static const double vertices[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    static const uint32_t starts[2] = {0, 3}, corners[3] = {0, 1, 2};
    return (struct mesh_input){
        .vertex_count = 3, .face_count = 1, .vertices = vertices, .face_start = starts, .vertex_index = corners};
}

TEST(ply_of_every_kind_gives_the_same_mesh) {
    struct maker m = {0};
    maker_sphere(&m, 6);
    maker_round(&m);
    struct mesh *wanted = maker_mesh(&m);
    for (int kind = PLY_ASCII; kind <= PLY_BIG; kind++) {
        struct bytes b = {0};
        struct model model;
        struct error error;
        write_ply(&b, &m, (enum ply_kind)kind);
        CHECK(parse_model(&model, "t.ply", b.data, b.size, NULL, &error));
        CHECK_TEXT(error.text, "");
        if (error.kind == ERROR_NONE) {
            CHECK(same_faces(only_mesh(&model), wanted));
            CHECK(mesh_is_closed(only_mesh(&model)));
            model_destroy(&model);
        }
        bytes_free(&b);
    }
    mesh_release(wanted);
    maker_free(&m);
}

TEST(ply_properties_of_all_types_in_any_order_are_read) {
    static const struct {
        const char *name;
        int size;
    } types[] = {{"char", 1}, {"uint8", 1}, {"short", 2}, {"uint16", 2}, {"int32", 4}, {"uint", 4}, {"float64", 8}};
    struct mesh_input wanted = triangle_input();
    for (int big = 0; big < 2; big++)
        for (size_t t = 0; t < sizeof types / sizeof types[0]; t++) {
            struct bytes b = {0};
            bool real = types[t].size == 8;
            /* unknown elements of every form before, between and after */
            bytes_print(
                &b, "ply\r\nformat binary_%s_endian 1.0\r\nelement junk 3\r\nproperty %s a\r\nproperty double b\r\n",
                big ? "big" : "little", types[t].name);
            bytes_print(&b, "element lists 2\r\nproperty list ushort %s c\r\nproperty char d\r\n", types[t].name);
            bytes_print(
                &b,
                "element vertex 3\r\nproperty %s z\r\nproperty short confidence\r\nproperty %s y\r\nproperty %s x\r\n",
                types[t].name, types[t].name, types[t].name);
            bytes_print(&b,
                        "element face 1\r\nproperty float quality\r\nproperty list %s %s vertex_index\r\nproperty "
                        "uchar flags\r\n",
                        real ? "uint" : types[t].name, real ? "int" : types[t].name);
            bytes_print(&b, "element tail 1\r\nproperty int e\r\nend_header\r\n");
            for (int i = 0; i < 3; i++) {
                bytes_number(&b, 0x7f7f7f7f7f7f7f7f, types[t].size, big);
                bytes_number(&b, 7, 8, big);
            }
            for (uint64_t i = 0; i < 2; i++) {
                bytes_number(&b, i + 1, 2, big);
                for (uint64_t k = 0; k <= i; k++)
                    bytes_number(&b, 5, types[t].size, big);
                bytes_number(&b, 6, 1, big);
            }
            for (int i = 0; i < 3; i++)
                for (int k = 2; k >= 0; k--) {
                    if (real)
                        bytes_double(&b, wanted.vertices[i][k], big);
                    else
                        bytes_number(&b, (uint64_t)wanted.vertices[i][k], types[t].size, big);
                    if (k == 2)
                        bytes_number(&b, 9, 2, big);
                }
            bytes_float(&b, 3, big);
            bytes_number(&b, 3, real ? 4 : types[t].size, big);
            for (uint64_t k = 0; k < 3; k++)
                bytes_number(&b, k, real ? 4 : types[t].size, big);
            bytes_number(&b, 1, 1, big);
            bytes_number(&b, 1, 4, big);
            struct model model;
            struct error error;
            if (!parse_model(&model, "t.ply", b.data, b.size, NULL, &error))
                test_fail(__FILE__, __LINE__, "%s %d: %s", types[t].name, big, error.text);
            else {
                CHECK(mesh_equals_input(only_mesh(&model), &wanted));
                model_destroy(&model);
            }
            bytes_free(&b);
        }
}

TEST(ply_strips_are_triangles_that_all_face_one_side) {
    static const char text[] =
        HEAD "element vertex 6\n" XYZ "element tristrips 1\nproperty list int int vertex_indices\n"
             "end_header\n0 0 0\n0 1 0\n1 0 0\n1 1 0\n2 0 0\n2 1 0\n"
             "11 0 1 2 3 4 5 -1 1 0 1 2\n";
    static const uint32_t corners[15] = {0, 1, 2, 1, 3, 2, 2, 3, 4, 3, 5, 4, 0, 2, 1};
    struct model model;
    struct error error;
    CHECK(parse_model(&model, "t.ply", text, strlen(text), NULL, &error));
    CHECK_TEXT(error.text, "");
    uint32_t count;
    CHECK_EQ_INT(mesh_face_count(only_mesh(&model)), 5);
    for (uint32_t f = 0; f < 5; f++)
        CHECK(memcmp(mesh_face(only_mesh(&model), f, &count), corners + 3 * f, 3 * sizeof *corners) == 0);
    model_destroy(&model);
}

TEST(ply_normals_uvs_and_colours_are_used_at_the_surface) {
    static const char *const texts[] = {
        HEAD "element vertex 3\n" XYZ "property float nx\nproperty float ny\nproperty float nz\nproperty float s\n"
             "property float t\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n" FACES
             "end_header\n0 0 0 0 0 1 0 0 255 0 0\n1 0 0 0 0 1 1 0 0 255 0\n0 1 0 0 1 0 0 1 0 0 255\n3 0 1 2\n",
        HEAD "element vertex 3\n" XYZ "property float nx\nproperty float ny\nproperty float nz\n"
             "property float red\nproperty float green\nproperty float blue\nelement face 1\n"
             "property list uchar float texcoord\n" FACES
             "end_header\n0 0 0 0 0 1 1 0 0\n1 0 0 0 0 1 0 1 0\n0 1 0 0 1 0 0 0 1\n6 0 0 1 0 0 1 3 0 1 2\n"};
    for (int i = 0; i < 2; i++) {
        struct model model;
        struct error error;
        bool ok = parse_model(&model, "t.ply", texts[i], strlen(texts[i]), NULL, &error);
        CHECK_TEXT(error.text, "");
        if (!ok)
            continue;
        struct ray ray = test_ray(vec3_make(0.25, 0.5, 1), vec3_make(0, 0, -1));
        struct crossing crossing;
        struct surface surface;
        struct geom_scratch scratch;
        CHECK(geom_scratch_init(&scratch, 16));
        CHECK(mesh_nearest(only_mesh(&model), &ray, ACCEL_NONE, &scratch, &crossing));
        mesh_describe(only_mesh(&model), &ray, &crossing, &surface);
        CHECK(surface.has_uv && surface.has_colour);
        CHECK_NEAR(surface.u, 0.25, 1e-12);
        CHECK_NEAR(surface.v, 0.5, 1e-12);
        CHECK_NEAR(surface.colour.r, 0.25, 1e-6);
        CHECK_NEAR(surface.colour.g, 0.25, 1e-6);
        CHECK_NEAR(surface.colour.b, 0.5, 1e-6);
        CHECK_NEAR(surface.shading_normal.y, 0.5, 1e-12);
        CHECK_NEAR(surface.shading_normal.z, 0.5, 1e-12);
        CHECK_EQ_INT(model.materials.count, 1);
        CHECK(model_materials(&model)[0].by_vertex);
        geom_scratch_destroy(&scratch);
        model_destroy(&model);
    }
}

TEST(ply_strips_beside_faces_with_uvs_have_none) {
    static const char strips[] = "element tristrips 1\nproperty list int int vertex_indices\n";
    static const char faces[] = "element face 1\nproperty list uchar float texcoord\n" FACES;
    for (int first = 0; first < 2; first++) {
        struct bytes b = {0};
        struct model model;
        struct error error;
        bytes_print(&b, HEAD "element vertex 3\n" XYZ "%s%send_header\n" POINTS "%s%s", first ? strips : faces,
                    first ? faces : strips, first ? "3 2 1 0\n" : "6 0 0 1 0 0 1 3 0 1 2\n",
                    first ? "6 0 0 1 0 0 1 3 0 1 2\n" : "3 2 1 0\n");
        bool ok = parse_model(&model, "t.ply", b.data, b.size, NULL, &error);
        CHECK_TEXT(error.text, "");
        for (uint32_t t = 0; ok && t < 2; t++) {
            struct crossing crossing = {.part = t, .u = 0.25, .v = 0.5};
            struct ray ray = test_ray(vec3_make(0, 0, 1), vec3_make(0, 0, -1));
            struct surface s;
            mesh_describe(only_mesh(&model), &ray, &crossing, &s);
            CHECK_EQ_INT(s.has_uv, t == (first ? 1 : 0));
        }
        if (ok)
            model_destroy(&model);
        bytes_free(&b);
    }
}

TEST(ply_errors_name_the_line) {
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"", "t.ply:1: a PLY file begins with the line 'ply'"},
        {"PLY\n", "t.ply:1: a PLY file begins with the line 'ply'"},
        {"ply\n", "t.ply:1: the file ends before end_header"},
        {"ply\nelement vertex 3\n", "t.ply:2: 'element' comes before the format"},
        {"ply\nformat text 1.0\n", "t.ply:2: 'text' is none of ascii, binary_little_endian, binary_big_endian"},
        {HEAD "property int x\n", "t.ply:3: 'property' comes before the first element"},
        {HEAD "element vertex -3\n", "t.ply:3: '-3' is not a count"},
        {HEAD "element vertex 99999999999999999999999\n", "t.ply:3: '99999999999999999999999' is not a count"},
        {HEAD "element vertex 3 4\n", "t.ply:3: 'element' needs a name and a count"},
        {HEAD "element vertex 1\nproperty half x\n",
         "t.ply:4: 'half' is not a type of number (char, uchar, short, ushort, int, uint, float, double)"},
        {HEAD "element vertex 1\n" XYZ "property float x\n", "t.ply:7: 'x' repeats an earlier property"},
        {HEAD "element face 1\nproperty list float int vertex_indices\n",
         "t.ply:4: 'float' cannot count the entries of a list"},
        {HEAD "element face 1\nproperty list int float vertex_indices\n",
         "t.ply:4: 'vertex_indices' must be whole numbers"},
        {HEAD "elephant 1\n", "t.ply:3: 'elephant' is not a word of a PLY header"},
        {HEAD "element vertex 1\nproperty float x\nend_header\n0\n", "t.ply: the vertices have no x, y and z"},
        {PLAIN POINTS, "t.ply:13: the header promises 1 of 'face', but the file is too short for them"},
        {PLAIN "0 0 0\n1 0\n0 1 0\n3 0 1 2\n", "t.ply:11: the line ends too early"},
        {PLAIN "0 0 0\n1 0 0 7\n0 1 0\n3 0 1 2\n", "t.ply:11: more numbers on this line than the header says"},
        {PLAIN "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", "t.ply:11: not a finite number"},
        {PLAIN "0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n", "t.ply:11: not a finite number"},
        {PLAIN POINTS "3 0 1 3\n", "t.ply:13: vertex 3, but the file has 3, counted from 0"},
        {PLAIN POINTS "3 0 1 -1\n", "t.ply:13: vertex -1, but the file has 3, counted from 0"},
        {PLAIN POINTS "3 0 1 0.5\n", "t.ply:13: vertex 0.5, but the file has 3, counted from 0"},
        {PLAIN POINTS "2 0 1\n",
         "t.ply: no faces in this file (t.ply:13: a face needs at least 3 corners: it is left out)"},
        {PLAIN POINTS "3 0 1 nan\n", "t.ply:13: vertex nan, but the file has 3, counted from 0"},
        {PLAIN POINTS "4 0 1 2\n", "t.ply:13: the line ends too early"},
        {PLAIN POINTS "200 0 1 2\n", "t.ply:13: a list of 200 entries does not fit into the file"},
        {HEAD "element vertex 3\n" XYZ "end_header\n" POINTS, "t.ply: no faces in this file"},
        {HEAD "element vertex 4000000000000\n" XYZ "element face 1\n" FACES "end_header\n" POINTS "3 0 1 2\n",
         "t.ply: 4000000000000 vertices are too many"},
        {HEAD "element vertex 400000000\n" XYZ "element face 1\n" FACES "end_header\n" POINTS "3 0 1 2\n",
         "t.ply:10: the header promises 400000000 of 'vertex', but the file is too short for them"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        check_text_refused("t.ply", cases[i].text, cases[i].message);
}

TEST(ply_binary_errors_name_the_byte) {
    struct maker m = {0};
    maker_sphere(&m, 1);
    maker_round(&m);
    struct bytes b = {0};
    write_ply(&b, &m, PLY_LITTLE);
    size_t body = b.size - m.vertex_count * 12 - m.face_count * 13;
    float bad = NAN;
    uint8_t saved[4];
    char message[200];
    memcpy(saved, b.data + body + 16, 4);
    memcpy(b.data + body + 16, &bad, 4);
    (void)snprintf(message, sizeof message, "t.ply: byte %zu: not a finite number", body + 16);
    check_refused("t.ply", b.data, b.size, message);
    memcpy(b.data + body + 16, saved, 4);
    size_t face = body + m.vertex_count * 12;
    b.data[face + 5] = 200;
    (void)snprintf(message, sizeof message, "t.ply: byte %zu: vertex 200, but the file has %u, counted from 0",
                   face + 5, m.vertex_count);
    check_refused("t.ply", b.data, b.size, message);
    b.data[face] = 255;
    (void)snprintf(message, sizeof message, "t.ply: byte %zu: a list of 255 entries does not fit into the file", face);
    check_refused("t.ply", b.data, b.size, message);
    bytes_free(&b);
    maker_free(&m);
}

TEST(ply_survives_cuts_changes_and_failed_allocations) {
    struct maker m = {0};
    maker_sphere(&m, 2);
    maker_round(&m);
    for (int kind = PLY_ASCII; kind <= PLY_BIG; kind++) {
        struct bytes b = {0};
        write_ply(&b, &m, (enum ply_kind)kind);
        check_cut_anywhere("t.ply", &b, 3);
        check_changed_anywhere("t.ply", &b, 2000);
        check_failed_allocations("t.ply", &b);
        bytes_free(&b);
    }
    maker_free(&m);
}

TEST(ply_real_model_has_its_triangles) {
    struct model model;
    struct model_options options = {0};
    struct error error = {0};
    char *there = test_read_file("../shared/models/igea.ply", NULL);
    if (!there)
        test_skip("../shared/models is not there");
    free(there);
    CHECK(model_read(&model, "../shared/models/igea.ply", &options, &error));
    CHECK_TEXT(error.text, "");
    CHECK_EQ_INT(mesh_triangle_count(only_mesh(&model)), 268686);
    CHECK(mesh_is_closed(only_mesh(&model)));
    model_destroy(&model);
}
