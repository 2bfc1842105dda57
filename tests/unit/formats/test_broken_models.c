/* Broken mesh files of every kind through the whole program: one script for each, one line for each, status 1. Claims
 * of a header are limited by the bytes that follow, so nothing here takes much time or memory. */
#include "tests/unit/model_makers.h"

enum { CASES = 64, NAME = 40 };

static char names[CASES][NAME];
static int case_count;

/* A file of these bytes and a script that reads it. */
static void add_file(const char *name, const void *data, size_t size) {
    char path[500], text[200];
    (void)snprintf(path, sizeof path, "%s/%s", test_folder(), name);
    test_write_file(path, data, size);
    (void)snprintf(path, sizeof path, "%s/%d.lua", test_folder(), case_count);
    (void)snprintf(text, sizeof text, "gr.render{node = gr.mesh('m', '%s'), file = 'x.png', width = 4, height = 4}\n",
                   name);
    test_write_text(path, text);
    (void)snprintf(names[case_count++], NAME, "%s", name);
}

static void add_text(const char *name, const char *text) {
    add_file(name, text, strlen(text));
}

/* The whole file, with `size` bytes at `at` replaced by the number, cut to `length`. */
static void add_changed(const char *name, const struct bytes *b, size_t at, uint64_t bits, int size, size_t length) {
    uint8_t *copy = malloc(b->size);
    memcpy(copy, b->data, b->size);
    for (int i = 0; i < size; i++)
        copy[at + (size_t)i] = (uint8_t)(bits >> 8 * i);
    add_file(name, copy, length);
    free(copy);
}

static size_t offset_of(const struct bytes *b, const char *word) {
    for (size_t i = 0; i + strlen(word) <= b->size; i++)
        if (memcmp(b->data + i, word, strlen(word)) == 0)
            return i;
    test_fail(__FILE__, __LINE__, "no '%s'", word);
    return 0;
}

static void add_texts(void) {
    add_text("o1.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    add_text("o2.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -9\n");
    add_text("o3.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999999999\n");
    add_text("o4.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    add_text("o5.obj", "v 0 0 1e999\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    add_text("o6.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n");
    add_text("o7.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3/x\n");
    add_text("o8.obj", "v 0 0 0\nv 1 0 0\nv 0 1");
    add_text("m1.mtl", "\xff\xfen");
    case_count--; /* the model that names it is the test case */
    add_text("m1.obj", "mtllib m1.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
    add_text("p1.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n");
    add_text("p2.ply", "ply\nformat strange 1.0\nend_header\n");
#define PLY_HEAD(vertices, faces)                                                                                      \
    "ply\nformat ascii 1.0\nelement vertex " vertices "\nproperty float x\nproperty float y\nproperty float z\n"       \
    "element face " faces "\nproperty list uchar int vertex_indices\nend_header\n"
    add_text("p3.ply", PLY_HEAD("5", "1") "0 0 0\n1 0 0\n0 1 0\n");
    add_text("p4.ply", PLY_HEAD("3", "1") "0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n");
    add_text("p5.ply", PLY_HEAD("3", "1") "0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n");
    add_text("p6.ply", PLY_HEAD("1000000000", "1") "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    add_text("p7.ply", PLY_HEAD("3", "99999999999999999999") "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    add_text("p8.ply", PLY_HEAD("3", "1") "0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n");
    add_text("s1.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n");
    add_text("s2.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 nan\nvertex 0 1 0\nendloop\n"
                       "endfacet\nendsolid x\n");
    add_text("z1.obj.gz", "\x1f\x8b\x08");
}

static void add_binaries(const struct maker *m) {
    struct bytes ply = {0}, big = {0}, stl = {0};
    write_ply(&ply, m, PLY_LITTLE);
    write_ply(&big, m, PLY_BIG);
    write_stl(&stl, m, true, "x");
    size_t data = offset_of(&ply, "end_header\n") + 11, faces = data + 12 * (size_t)m->vertex_count;
    add_changed("b1.ply", &ply, 0, 'p', 1, ply.size - 5);
    add_changed("b2.ply", &ply, data + 12, 0x7fc00000, 4, ply.size);
    add_changed("b3.ply", &ply, faces + 1, 0x7fffffff, 4, ply.size);
    add_changed("b4.ply", &ply, faces, 255, 1, ply.size);
    add_changed("b5.ply", &big, offset_of(&big, "end_header\n") + 11 + 12, 0xc07f, 2,
                big.size); /* NaN, big end first */
    add_changed("b6.ply", &big, 0, 'p', 1, big.size - 7);
    add_changed("b7.stl", &stl, 0, 'x', 1, stl.size - 70);
    add_changed("b8.stl", &stl, 80, 215000000, 4, stl.size); /* 10 GB */
    add_changed("b9.stl", &stl, 84 + 12, 0x7fc00000, 4, stl.size);
    add_changed("b10.stl", &stl, 0, 'x', 1, 83);
    struct bytes claimed = {0};
    bytes_print(&claimed, "ply\nformat binary_little_endian 1.0\nelement vertex 900000000\nproperty float x\n"
                          "property float y\nproperty float z\nend_header\n0123456789");
    add_file("b11.ply", claimed.data, claimed.size);
    bytes_free(&ply), bytes_free(&big), bytes_free(&stl), bytes_free(&claimed);
}

#ifdef HAVE_JANSSON
static void replace(struct bytes *out, const struct bytes *in, const char *word, const char *by) {
    size_t at = offset_of(in, word);
    bytes_add(out, in->data, at);
    bytes_add(out, by, strlen(by));
    bytes_add(out, in->data + at + strlen(word), in->size - at - strlen(word));
}

static void add_gltf(const struct maker *m) {
    static const struct {
        const char *word, *by;
    } changes[] = {
        {"\"count\":", "\"count\":1000000000,\"was\":"},
        {"\"byteLength\":", "\"byteLength\":10000000000,\"was\":"},
        {"\"POSITION\":0", "\"POSITION\":77"},
        {"\"POSITION\":0", "\"POSITION\":-1"},
        {"\"mesh\":0", "\"mesh\":5"},
        {"\"buffer\":0", "\"buffer\":9"},
        {"\"version\":\"2.0\"", "\"version\":\"1.0\""},
        {"5126", "5999"},
    };
    struct bytes gltf = {0}, glb = {0};
    write_gltf(&gltf, m);
    write_glb(&glb, m);
    for (size_t i = 0; i < sizeof changes / sizeof changes[0]; i++) {
        struct bytes changed = {0};
        char name[20];
        (void)snprintf(name, sizeof name, "g%zu.gltf", i);
        replace(&changed, &gltf, changes[i].word, changes[i].by);
        add_file(name, changed.data, changed.size);
        bytes_free(&changed);
    }
    size_t text = glb.data[12] | (size_t)glb.data[13] << 8, positions = 20 + text + 8;
    add_changed("cut.gltf", &gltf, 0, '{', 1, gltf.size / 2);
    add_changed("h1.glb", &glb, 0, 'g', 1, glb.size - 9);
    add_changed("h2.glb", &glb, 8, 0xfffffff0, 4, glb.size);
    add_changed("h3.glb", &glb, 12, 0xfffffff0, 4, glb.size);
    add_changed("h4.glb", &glb, positions, 0x7fc00000, 4, glb.size);
    add_changed("h5.glb", &glb, positions + 12 * (size_t)m->vertex_count, 0x7fffffff, 4, glb.size);
    add_changed("h6.glb", &glb, 0, 'g', 1, 11);
    bytes_free(&gltf), bytes_free(&glb);
}
#endif

TEST(broken_mesh_files_of_every_kind_are_one_line_each_and_status_1) {
    struct maker m = {0};
    maker_sphere(&m, 3);
    maker_round(&m);
    case_count = 0;
    add_texts();
    add_binaries(&m);
#ifdef HAVE_JANSSON
    add_gltf(&m);
#endif
    maker_free(&m);
    char arguments[1000] = "-q";
    for (int i = 0; i < case_count; i++)
        (void)snprintf(arguments + strlen(arguments), sizeof arguments - strlen(arguments), " %d.lua", i);
    struct test_result result = test_gray(NULL, arguments);
    CHECK_EQ_INT(result.status, 1);
    /* Lines without indentation are messages; the others give the position in the script. */
    int seen = 0;
    for (char *line = strtok(result.err, "\n"); line; line = strtok(NULL, "\n")) {
        if (line[0] == ' ')
            continue;
        char script[30];
        const char *file = seen < case_count && strcmp(names[seen], "m1.obj") == 0 ? "m1.mtl" : names[seen];
        (void)snprintf(script, sizeof script, "%d.lua:1: ", seen);
        if (seen >= case_count || strncmp(line, script, strlen(script)) != 0 || !strstr(line, file))
            test_fail(__FILE__, __LINE__, "the line for %s is: %s", file, line);
        seen++;
    }
    CHECK_EQ_INT(seen, case_count);
    test_free_result(&result);
}
