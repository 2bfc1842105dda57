/* The OBJ reader: every variant of the syntax, every error with its line, numbers correctly rounded. */
#include "base/mem.h"
#include "formats/decimal_internal.h"
#include "tests/harness.h"
#include "tests/unit/model_makers.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The only mesh of the model in the bytes. */
static struct mesh *parse_bytes(const char *text, size_t size, struct error *error) {
    static const struct model_options single = {.single_file = true};
    struct model model;
    if (!parse_model(&model, "t.obj", text, size, &single, error))
        return NULL;
    struct mesh *mesh = mesh_share(only_mesh(&model));
    model_destroy(&model);
    return mesh;
}

static struct mesh *parse(const char *text) {
    struct error error;
    struct mesh *mesh = parse_bytes(text, strlen(text), &error);
    if (!mesh)
        test_fail(__FILE__, __LINE__, "%s\nwas refused: %s", text, error.text);
    return mesh;
}

/* Two triangles over four vertices; uvs and normals are compared if the mesh has them. */
static const double square[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0.5}, {0, 1, 0}};
static const double square_uvs[3][2] = {{0, 0}, {1, 0.25}, {0.5, 1}};
static const double square_normals[2][3] = {{0, 0, 1}, {0.6, 0, 0.8}};
static const uint32_t starts[3] = {0, 3, 6}, corners[6] = {0, 1, 2, 0, 2, 3};

static struct mesh_input square_input(const uint32_t *uv_index, const uint32_t *normal_index) {
    struct mesh_input input = {.name = "t.obj",
                               .vertex_count = 4,
                               .face_count = 2,
                               .vertices = square,
                               .face_start = starts,
                               .vertex_index = corners};
    if (uv_index)
        input.uv_count = 3, input.uvs = square_uvs, input.uv_index = uv_index;
    if (normal_index)
        input.normal_count = 2, input.normals = square_normals, input.normal_index = normal_index;
    return input;
}

static void check_same(const char *text, const struct mesh_input *input) {
    struct mesh *mesh = parse(text);
    if (mesh && !mesh_equals_input(mesh, input))
        test_fail(__FILE__, __LINE__, "%s\ngives another mesh", text);
    mesh_release(mesh);
}

#define QUADRANGLE "v 0 0 0\nv 1 0 0\nv 1 1 .5\nv 0 1 0\n"

TEST(obj_spellings_of_a_plain_square_are_one_mesh) {
    struct mesh_input input = square_input(NULL, NULL);
    const char *const texts[] = {
        QUADRANGLE "f 1 2 3\nf 1 3 4\n",
        QUADRANGLE "f 1 2 3\nf 1 3 4",
        QUADRANGLE "f -4 -3 -2\nf -4 -2 -1\n",
        QUADRANGLE "f +1 2/ 3//\nf 1 3/ 4\n",
        "\xef\xbb\xbf" QUADRANGLE "f 1 2 3\nf 1 3 4\n",
        "f 1 2 3\nf 1 3 4\n" QUADRANGLE,
        "v 0 0 0\r\nv 1 0 0\r\nv 1 1 .5\r\nv 0 1 0\r\nf 1 2 3\r\nf 1 3 4\r\n",
        "v 0 0 0\rv 1 0 0\rv 1 1 .5\rv 0 1 0\rf 1 2 3\rf 1 3 4",
        "v 0 0 0 \\\n\nv 1 \\\r\n 0 0\nv 1\\\n1\\\r.5\nv 0 1 0\nf \\\n1 2\\\n3\nf 1 3 4\\",
        "\tv\t0  0 0\n\n  v 1 0 0  \nv 1e0 +1.0 5e-1\nv 0e9 10E-1 .0\n f   1 2   3 \nf 1\t3 4\t\n\n",
        "v 0 0 0 1\nv 1 0 0 1.0\nv 1 1 .5 1\nv 0 1 0 .25\nf 1 2 3\nf 1 3 4\n",
        "# a comment that ends in \\\nv 0 0 0 # one\nv 1 0 0#two\nv 1 1 .5\nv 0 1 0\nf 1 2 3 # f 4 5 6\nf 1 3 4#\n",
        "mtllib a.mtl\no thing\n" QUADRANGLE "g a b\nusemtl red\ns off\nl 1 2 3\np 1\nvp 0.5 1\ncstype bezier\n"
        "curv 0 1 1 2 3 \\\n 4\nf 1 2 3\n?odd word\nvtx 1\nfoo 9 9 9\ns 1\nf 1 3 4\nend\n",
        QUADRANGLE "vt 0 0\nvn 0 0 1\nf 1 2 3\nf 1 3 4\n",
        "v 0 0 0\nv 1 0 0\nv 1 1 .5\nf -3 -2 -1\nv 0 1 0\nf -4 -2 -1\n",
        QUADRANGLE "fo 1 2 3\nfo 1 3 4\n",
        QUADRANGLE "f 1 2 3\nf 2 9\nf\nf 1 3 4\n",
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        check_same(texts[i], &input);
}

#define UVS "vt 0\nvt 1 .25\nvt .5 1 7\n"
#define NORMALS "vn 0 0 1\nvn .6 0 .8\n"

TEST(obj_spellings_of_corners_with_uvs_and_normals_are_one_mesh) {
    static const uint32_t uvs[6] = {0, 1, 2, 0, 2, 1}, normals[6] = {0, 0, 1, 1, 1, 0};
    struct mesh_input both = square_input(uvs, normals), uv = square_input(uvs, NULL),
                      normal = square_input(NULL, normals);
    check_same(QUADRANGLE UVS NORMALS "f 1/1/1 2/2/1 3/3/2\nf 1/1/2 3/3/2 4/2/1\n", &both);
    check_same(NORMALS UVS QUADRANGLE "f -4/-3/-2 -3/-2/-2 -2/-1/-1\nf -4/-3/-1 -2/-1/-1 -1/-2/-2\n", &both);
    check_same(QUADRANGLE UVS NORMALS "f 1/-3/1 -3/2/1 3/3/-1\nf 1/1/2 3/3/2 4/2/1\n", &both);
    check_same(QUADRANGLE UVS "f 1/1 2/2 3/3\nf 1/1 3/3 4/2\n", &uv);
    check_same(QUADRANGLE UVS NORMALS "f 1/1/ 2/2 3/3\nf 1/1/ 3/3/ 4/2/\n", &uv);
    check_same(QUADRANGLE NORMALS "f 1//1 2//1 3//2\nf 1//2 3//2 4//1\n", &normal);
    check_same(QUADRANGLE UVS NORMALS "f 1//1 2//1 3//2\nf 1//2 3//2 4//1\n", &normal);
}

TEST(obj_corners_may_lack_what_others_have) {
    static const uint32_t none = UINT32_MAX;
    const uint32_t normals[6] = {none, none, none, 1, none, 0}, uvs[6] = {none, 2, none, none, none, none};
    struct mesh_input input = square_input(uvs, normals);
    check_same(QUADRANGLE UVS NORMALS "f 1 2/3 3\nf 1//2 3 4//1\n", &input);
}

TEST(obj_polygons_keep_their_corners) {
    static const uint32_t quad_start[2] = {0, 4}, quad[4] = {0, 1, 2, 3};
    struct mesh_input input = {.name = "t.obj",
                               .vertex_count = 4,
                               .face_count = 1,
                               .vertices = square,
                               .face_start = quad_start,
                               .vertex_index = quad};
    check_same(QUADRANGLE "f 1 2 3 4\n", &input);
    struct mesh *mesh = parse(QUADRANGLE "f 1 2 3 4\n");
    CHECK_EQ_INT(mesh_triangle_count(mesh), 2);
    mesh_release(mesh);
}

TEST(obj_errors_name_the_line) {
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"", "t.obj: no faces in this file"},
        {"v 0 0 0\n", "t.obj: no faces in this file"},
        {"# only a comment", "t.obj: no faces in this file"},
        {"v 0 0\n", "t.obj:1: v needs 3 numbers, not 2"},
        {"v\n", "t.obj:1: v needs 3 numbers, not 0"},
        {"\r\nv 0 0 x\n", "t.obj:2: 'x' is not a finite number"},
        {"v 0 0 1,5\n", "t.obj:1: '1,5' is not a finite number"},
        {"\n\nv nan 0 0\n", "t.obj:3: 'nan' is not a finite number"},
        {"v inf 0 0\n", "t.obj:1: 'inf' is not a finite number"},
        {"v 1e999 0 0\n", "t.obj:1: '1e999' is not a finite number"},
        {"v 0x10 0 0\n", "t.obj:1: '0x10' is not a finite number"},
        {"v 1 2 3 red\n", "t.obj:1: 'red' is not a finite number"},
        {"v 1 2 3..\n", "t.obj:1: '3..' is not a finite number"},
        {"v . 2 3\n", "t.obj:1: '.' is not a finite number"},
        {"v 1e 2 3\n", "t.obj:1: '1e' is not a finite number"},
        {QUADRANGLE "f 1 2\n",
         "t.obj: no faces in this file (t.obj:5: f needs at least 3 corners: the face is left out)"},
        {QUADRANGLE "f 1 \\\n2\n",
         "t.obj: no faces in this file (t.obj:5: f needs at least 3 corners: the face is left out)"},
        {"v 0 0 1.#IND\n", "t.obj:1: '1.#IND' is not a finite number"},
        {"v 0 0 0\nv 0 -nan(ind) 1e999\nv 1 0 0\nf 1 3 2\n", "t.obj:2: '-nan(ind)' is not a finite number"},
        {QUADRANGLE "v nan 0 0\nv 0 inf 0\nf 1 2 3\nf 6 1 2\n", "t.obj:6: 'inf' is not a finite number"},
        {QUADRANGLE "f 1 2 \\\n x\n", "t.obj:6: 'x' is not a corner of a face (7, 7/1, 7//3 or 7/1/3)"},
        {QUADRANGLE "f 0 1 2\n", "t.obj:5: '0' has the index 0, but indices count from 1"},
        {QUADRANGLE "f 1 2 5\nf 1 2 3\n", "t.obj:5: vertex index 5, but the file has only 4"},
        {QUADRANGLE "f 1 2 6\nf 1 2 7\nf 7 1 2\nv 0 0 0", "t.obj:5: vertex index 6, but the file has only 5"},
        {QUADRANGLE "f 1 2 -5\n", "t.obj:5: vertex index -5, but only 4 were read so far"},
        {QUADRANGLE "f 1 2 99999999999999999999\n", "t.obj:5: '99999999999999999999' has an index that is too large"},
        {QUADRANGLE "f 1 2 4294967295\n", "t.obj:5: '4294967295' has an index that is too large"},
        {QUADRANGLE "f 1.0 2.0 3.0\n", "t.obj:5: '1.0' is not a corner of a face (7, 7/1, 7//3 or 7/1/3)"},
        {QUADRANGLE "f 1/1/1/1 2 3\n", "t.obj:5: '1/1/1/1' is not a corner of a face (7, 7/1, 7//3 or 7/1/3)"},
        {QUADRANGLE "f /1 2 3\n", "t.obj:5: '/1' is not a corner of a face (7, 7/1, 7//3 or 7/1/3)"},
        {QUADRANGLE "f 1 2 -\n", "t.obj:5: '-' is not a corner of a face (7, 7/1, 7//3 or 7/1/3)"},
        {"# text\n\x7f"
         "ELF x\n",
         "t.obj:2: '?ELF' is not an OBJ keyword: is this a text file?"},
        {"\x89PNG\r\n\x1a\n", "t.obj:2: '?' is not an OBJ keyword: is this a text file?"},
        {"\xff\xfev", "t.obj:1: this is UTF-16 text; gray reads plain ASCII and UTF-8"},
        {"v 0 0 aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa\n",
         "t.obj:1: 'aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa...' is not a finite number"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct error error;
        struct mesh *mesh = parse_bytes(cases[i].text, strlen(cases[i].text), &error);
        CHECK(mesh == NULL);
        CHECK_TEXT(error.text, cases[i].message);
        CHECK_EQ_INT(error.kind, ERROR_SCENE);
        mesh_release(mesh);
    }
}

TEST(obj_cut_anywhere_is_a_mesh_or_an_error) {
    static const char text[] = QUADRANGLE UVS NORMALS "f 1/1/1 2/2/1 \\\r\n 3/3/2 # x\r\nf -4/1/2 3//2 4\r\ng \\\n a";
    for (size_t size = 0; size < sizeof text; size++) {
        struct error error;
        struct mesh *mesh = parse_bytes(text, size, &error);
        CHECK(mesh || (error.kind == ERROR_SCENE && strncmp(error.text, "t.obj:", 6) == 0));
        mesh_release(mesh);
    }
}

TEST(obj_lines_of_megabytes_are_read) {
    enum { SIDES = 5000, FILLER = 4 << 20 };
    size_t size = 0, room = (size_t)FILLER + SIDES * 80;
    char *text = malloc(room);
    text[size++] = '#';
    memset(text + size, 'x', FILLER);
    size += FILLER;
    text[size++] = '\n';
    for (int i = 0; i < SIDES; i++)
        size += (size_t)snprintf(text + size, room - size, "v %.17g %.17g 0\n", cos(i * 2 * M_PI / SIDES),
                                 sin(i * 2 * M_PI / SIDES));
    text[size++] = 'f';
    for (int i = 1; i <= SIDES; i++)
        size += (size_t)snprintf(text + size, room - size, " %d", i);
    struct error error;
    struct mesh *mesh = parse_bytes(text, size, &error);
    CHECK(mesh != NULL);
    if (mesh)
        CHECK_EQ_INT(mesh_triangle_count(mesh), SIDES - 2);
    mesh_release(mesh);
    free(text);
}

static void check_number(const char *text) {
    double value = -1, wanted = strtod(text, NULL);
    const char *end = text + strlen(text), *after = decimal_read(text, end, &value);
    if (isinf(wanted)) {
        CHECK(after == NULL);
        return;
    }
    if (after != end || memcmp(&value, &wanted, sizeof value) != 0)
        test_fail(__FILE__, __LINE__, "%s gives %.17g, not %.17g", text, value, wanted);
}

TEST(decimal_numbers_are_correctly_rounded) {
    static const char *const special[] = {
        "0",
        "-0",
        "+0",
        "0.0",
        "00012",
        "1.",
        ".5",
        "-.5e1",
        "9007199254740993",
        "9007199254740992e22",
        "9007199254740993e-1",
        "1e22",
        "1e23",
        "1e-22",
        "1e-23",
        "8.5e-27",
        "5e-324",
        "2.4703282292062327e-324",
        "2.4703282292062328e-324",
        "1.7976931348623157e308",
        "1.7976931348623159e308",
        "2.2250738585072011e-308",
        "18446744073709551615",
        "18446744073709551616",
        "9999999999999999999",
        "9999999999999999999e-27",
        "0.00000000000000000000000000000000000000000000000000000000000000001",
        "1e400",
        "1e-400",
        "0e999999999",
        "1000000000000000000000000000000",
        "0.500000000000000166533453693773481063544750213623046875",
        "9007199254740992.5",
        "9007199254740993.5",
        "4503599627370496.5",
        "4503599627370497.5",
        "3.14159265358979323846264338327950288419716939937510582097494459",
    };
    for (size_t i = 0; i < sizeof special / sizeof special[0]; i++)
        check_number(special[i]);
    struct test_random random = {7};
    for (int i = 0; i < 200000; i++) {
        static const char *const formats[] = {"%.6f",  "%.17g", "%.9g",  "%.3e", "%.15f",
                                              "%.18e", "%.16g", "%.25f", "%.0f"};
        char text[400];
        double x = ldexp(test_uniform(&random, -1, 1), (int)test_uniform(&random, -60, 60));
        (void)snprintf(text, sizeof text, formats[i % 9], x);
        check_number(text);
    }
    /* Halfway cases: a double plus half a unit in the last place, with digits that state it exactly or slightly differ.
     */
    for (int i = 0; i < 50000; i++) {
        char text[64];
        double x = floor(test_uniform(&random, 1e15, 9e15));
        int tenths = (int)test_uniform(&random, 0, 1000);
        (void)snprintf(text, sizeof text, "%.0f.%03de-%d", x, tenths, i % 9);
        check_number(text);
        (void)snprintf(text, sizeof text, "%.0f.5", floor(x / 2) + 2251799813685248.0);
        check_number(text);
    }
}

TEST(obj_real_models_have_their_triangles) {
    static const struct {
        const char *name;
        uint32_t triangles;
    } models[] = {
        {"stanford-bunny", 69451}, {"nefertiti", 99938}, {"teapot", 6320},  {"cow", 5804},  {"spot", 5856},
        {"fandisk", 12946},        {"cessna", 7446},     {"ateneav", 1121}, {"pyramid", 6}, {"tetrahedron", 4}};
    char *smallest = test_read_file("../shared/models/tetrahedron.obj", NULL);
    if (!smallest)
        test_skip("../shared/models is not there");
    free(smallest);
    for (size_t i = 0; i < sizeof models / sizeof models[0]; i++) {
        char path[100];
        (void)snprintf(path, sizeof path, "../shared/models/%s.obj", models[i].name);
        struct error error = {0};
        struct model model;
        bool ok = model_read(&model, path, &(struct model_options){.single_file = true}, &error);
        CHECK_TEXT(error.text, "");
        if (!ok)
            continue;
        const struct mesh *mesh = only_mesh(&model);
        CHECK_EQ_INT(mesh_triangle_count(mesh) + mesh_dropped_faces(mesh), models[i].triangles);
        model_destroy(&model);
    }
}

TEST(obj_file_that_is_missing_is_named) {
    struct error error = {0};
    struct model model;
    CHECK(!model_read(&model, "no/such/file.obj", &(struct model_options){.single_file = true}, &error));
    CHECK(strncmp(error.text, "no/such/file.obj: ", 18) == 0);
    CHECK_EQ_INT(error.kind, ERROR_SCENE);
}

TEST(obj_survives_every_failed_allocation) {
    static const char text[] = QUADRANGLE UVS NORMALS "f 1/1/1 2/2/1 3/3/2\nf 1/1/2 3/3/2 4/2/1\n";
    struct error error;
    uint64_t before = mem_allocations();
    mesh_release(parse_bytes(text, sizeof text - 1, &error));
    uint64_t count = mem_allocations() - before;
    if (count == 0)
        test_skip("this build cannot make allocations fail");
    for (uint64_t k = 1; k <= count; k++) {
        mem_fail_at(k);
        struct mesh *mesh = parse_bytes(text, sizeof text - 1, &error);
        mem_fail_at(0);
        CHECK(mesh || error.kind == ERROR_MACHINE);
        mesh_release(mesh);
    }
}
