/* Corner cases of the readers, one short file each: accepted, or refused with these words. */
#include "formats/decimal_internal.h"
#include "image/image.h"
#include "tests/unit/model_makers.h"

#include "base/fault.h"

#include <math.h>

struct corner {
    const char *name, *text, *words; /* NULL: it is accepted */
};

#define HEAD "{\"asset\":{\"version\":\"2.0\"},"
/* Three corners and a list of three indices, in 39 bytes. */
#define BUFFER                                                                                                         \
    "\"buffers\":[{\"uri\":\"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAECAA==\"}],"               \
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":3}],"
#define POINTS "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}"
#define INDICES "{\"bufferView\":1,\"componentType\":5121,\"count\":3,\"type\":\"SCALAR\"}"
#define TRIANGLE BUFFER "\"accessors\":[" POINTS "," INDICES "],"
#define ONE "{\"attributes\":{\"POSITION\":0},\"indices\":1}"
#define MESH "\"meshes\":[{\"primitives\":[" ONE "]}]"

static const struct corner corners[] = {
    {"a.gltf", HEAD TRIANGLE MESH "}", NULL},
    {"a.gltf",
     HEAD BUFFER "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"normalized\":true,\"count\":3,\"type\":"
                 "\"VEC3\"}," INDICES "]," MESH "}",
     NULL},
    {"bom.gltf", "\xef\xbb\xbf" HEAD TRIANGLE MESH "}", NULL},
    {"bom", "\xef\xbb\xbf " HEAD TRIANGLE MESH "}", NULL},
    {"folder.x/bom", HEAD TRIANGLE MESH "}", NULL},
    {"a.gltf", "[1]", "an object must be at the top"},
    {"a.gltf", HEAD "\"extensionsRequired\":[\"x\\u0001\\u007f\"]}", "the file needs 'x\?\?'"},
    {"a.gltf", HEAD "\"extensionsRequired\":[5]}", "something without a name"},
    {"a.gltf",
     HEAD BUFFER "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":1,\"type\":\"MAT3\"}],"
                 "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]}",
     "has 9 numbers an element"},
    {"a.gltf",
     HEAD "\"accessors\":[{\"componentType\":5126,\"count\":400000,\"type\":\"VEC3\"}],\"meshes\":[{"
          "\"primitives\":[{\"attributes\":{\"POSITION\":0}},{\"attributes\":{\"POSITION\":0}}]}]}",
     "more vertices than a file of"},
    {"a.gltf",
     HEAD BUFFER "\"accessors\":[" POINTS ",{\"componentType\":5121,\"count\":2000000,\"type\":\"SCALAR\"}]," MESH "}",
     "more vertices than a file of"},
    {"a.gltf",
     HEAD BUFFER "\"accessors\":[" POINTS ",{\"bufferView\":1,\"componentType\":5121,\"count\":3,\"type\":"
                 "\"SCALAR\",\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":1,\"componentType\":5121},\"values\":{"
                 "\"bufferView\":1}}}]," MESH "}",
     "it cannot be the indices of vertices"},
    /* sparse elements before and after the two vertices that the indices name */
    {"a.gltf",
     HEAD
     "\"buffers\":[{\"uri\":\"data:;base64,AQIBAAI=\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":3},{"
     "\"buffer\":0,\"byteOffset\":3,\"byteLength\":2}],\"accessors\":[{\"componentType\":5120,\"count\":4,"
     "\"type\":\"VEC3\",\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":1,\"componentType\":5121},"
     "\"values\":{\"bufferView\":0}}},{\"bufferView\":0,\"componentType\":5121,\"count\":3,\"type\":\"SCALAR\"}]," MESH
     "}",
     "no faces"},
    {"a.gltf",
     HEAD
     "\"buffers\":[{\"uri\":\"data:;base64,AAEAAwE=\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":3},{"
     "\"buffer\":0,\"byteOffset\":3,\"byteLength\":2}],\"accessors\":[{\"componentType\":5120,\"count\":4,"
     "\"type\":\"VEC3\",\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":1,\"componentType\":5121},"
     "\"values\":{\"bufferView\":0}}},{\"bufferView\":0,\"componentType\":5121,\"count\":3,\"type\":\"SCALAR\"}]," MESH
     "}",
     "no faces"},
    {"a.gltf",
     HEAD "\"buffers\":[{\"uri\":\"data:x\"}],\"bufferViews\":[{\"buffer\":0}],\"accessors\":[" POINTS "],"
          "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]}",
     "a data URI that is not base64"},
    {"a.gltf",
     HEAD "\"buffers\":[{\"uri\":\"data:;base64,==\"}],\"bufferViews\":[{\"buffer\":0}],\"accessors\":[" POINTS
          "],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]}",
     "3 elements of 12 bytes do not fit"},
    {"a.gltf",
     HEAD "\"buffers\":[{\"uri\":\"a%2fb%2F%4g%g4%4%00%zz%/\"}],\"bufferViews\":[{\"buffer\":0}],\"accessors\":[" POINTS
          "],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]}",
     "the file 'a/b/%4g%g4%4%00%zz%/' is not there"},
    {"a.gltf", HEAD TRIANGLE MESH ",\"nodes\":[{\"mesh\":0,\"children\":[-1,77,1.5]},{\"children\":[0]}]}",
     "a child that does not exist"},
    {"a.gltf", HEAD TRIANGLE MESH ",\"nodes\":[{\"mesh\":0},{\"children\":[0]}]}", NULL},
    {"a.gltf", HEAD TRIANGLE MESH ",\"scenes\":[{\"nodes\":[-1]}],\"nodes\":[{\"mesh\":0}]}",
     "a root that does not exist"},
    {"a.gltf", HEAD TRIANGLE MESH ",\"nodes\":[{\"mesh\":0,\"children\":[-1]}]}", "a child that does not exist"},
    {"a.gltf",
     HEAD TRIANGLE MESH ",\"materials\":[{\"emissiveFactor\":[1,1,1],\"emissiveTexture\":{\"index\":0}}],"
                        "\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"gone.png\"}]}",
     NULL},
    /* OBJ and MTL */
    {"a.obj", "\xfe\xff", "this is UTF-16 text"},
    {"a.obj", "\xff\xfe", "this is UTF-16 text"},
    {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nfx 1 2 3\nfo 1 2 3\nf 1/", NULL},
    {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -", "is not a corner of a face"},
    {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 3/", NULL},
    {"a.obj", "", "no faces in this file"},
    {"a.obj",
     "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
     "endsolid x\n",
     NULL},
    {"a.obj", "solid x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", NULL},
    {"a", "solid", "no faces in this file"},
    {"a.obj", "mtllib corner.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n", NULL},
    {"a.obj", "mtllib nothing corner.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n", NULL},
    {"a.obj", "mtllib corner.mtl nothing corner.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n", NULL},
    {"a.obj", "mtllib wrong.mtl\nv 0 0 0\n", "wrong.mtl:2: a value is not a finite number"},
    {"a.obj", "mtllib long.mtl\nv 0 0 0\n", "long.mtl:2: a value is not a finite number"},
    {"a.obj", "mtllib bom.mtl\nmtllib tiny.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl b\nf 1 2 3\n", NULL},
    /* STL */
    {"a.stl",
     "\xef\xbb\xbfsolid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
     "endfacet\nendsolid x\n",
     NULL},
    {"a.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0", "the file ends in a triangle"},
    {"a.stl", "so", "a binary STL file has at least 84 bytes"},
    {"a.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 ", "the file ends in a triangle"},
    /* PLY */
    {"a.ply", "ply\r", "the file ends before end_header"},
    {"a.ply", "ply\nend_header\n", "comes before the format"},
    {"a.ply", "ply\nformat ascii 1.0\nformat ascii 1.0\n", "is given a second time"},
    {"a.ply", "ply\nformat xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx 1.0\n", "is none of ascii"},
    {"a.ply", "ply\nformat\n", "'' is none of ascii"},
    {"a.ply", "ply\nformat ascii 1.0\nelement aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa 5\n",
     "needs a name and a count"},
    {"a.ply",
     "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
     "0 0 0\r",
     "no faces"},
    {"a.ply", "ply\nformat binary_little_endian 1.0\nelement other 3\nproperty char a\nend_header\n12",
     "the file ends too early"},
    {"a.ply", "ply\nformat binary_little_endian 1.0\nelement other 3\nproperty short a\nend_header\n12345",
     "the file ends too early"},
    {"a.ply",
     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
     "property float u\nproperty float v\nelement face 1\nproperty list uchar int vertex_indices\n"
     "property list uchar float texcoord\nend_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2 6 0 0 1 0 0 1\n",
     NULL},
};

static void put(const char *name, const char *text) {
    test_write_text(test_path(name), text);
}

static void expect(const char *name, const void *data, size_t size, const char *words) {
    struct model model;
    struct error error;
    bool ok = parse_model(&model, test_path(name), data, size, NULL, &error);
    if (ok != !words || (words && !strstr(error.text, words)))
        test_fail(__FILE__, __LINE__, "%s, %.60s: %s, not '%s'", name, (const char *)data, ok ? "is read" : error.text,
                  words ? words : "read");
    if (ok)
        model_destroy(&model);
}

TEST(corners_of_the_mesh_readers_are_read_or_reported) {
    put("corner.mtl", "newmtl a\rKd\v1\f1 1\r\nNs 5\nillum 9.5\n-\nmap_Kd\t-texres 5 -\n");
    put("wrong.mtl", "newmtl a\nNs\n");
    put("long.mtl", "newmtl a\nNs xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx\n");
    put("bom.mtl", "\xef\xbb\xbfnewmtl b\nillum 11\nillum -1\n");
    put("tiny.mtl", "#");
    for (size_t i = 0; i < sizeof corners / sizeof corners[0]; i++) {
#ifndef HAVE_JANSSON
        if (strstr(corners[i].name, ".gl") || strchr(corners[i].text, '{'))
            continue;
#endif
        expect(corners[i].name, corners[i].text, strlen(corners[i].text), corners[i].words);
    }
}

static char *repeated(const char *before, const char *piece, int count, const char *after) {
    size_t length = strlen(piece);
    char *text = malloc(strlen(before) + length * (size_t)count + strlen(after) + 1), *to = stpcpy(text, before);
    for (int i = 0; i < count; i++)
        to = stpcpy(to, piece);
    strcpy(to, after);
    return text;
}

static void expect_repeated(const char *name, const char *before, const char *piece, int count, const char *after,
                            const char *words) {
    char *text = repeated(before, piece, count, after);
    expect(name, text, strlen(text), words);
    free(text);
}

TEST(mesh_files_with_too_many_of_anything_are_errors) {
    char name[64];
    char *text = malloc(1 << 20);
    size_t used = (size_t)sprintf(text, "ply\nformat ascii 1.0\n");
    for (int i = 0; i < 65; i++)
        used += (size_t)sprintf(text + used, "element e%d 0\n", i);
    expect("a.ply", text, used, "is one too many");
    expect_repeated("a.ply", "ply\nformat ascii 1.0\nelement x 0\n", "property int a\n", 513, "", "is one too many");
    put("many.mtl", "newmtl a\n");
    (void)snprintf(name, sizeof name, "a.obj");
    expect_repeated(name, "mtllib ", "x", 4100, "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", NULL);
    expect_repeated(name, "mtllib many.mtl\nusemtl ", "x", 300, "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", NULL);
    expect(name, "mtllib a\0b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 47, NULL);
    char *library = repeated("", "newmtl a\n", 65537, "");
    put("many.mtl", library);
    expect(name, "mtllib many.mtl\n", 16, "many.mtl:65537: more than 65536 materials");
    free(library);
    free(text);
#ifdef HAVE_JANSSON
    expect_repeated("a.gltf", HEAD "\"x\":", "[", 8388609, "", "more than 8388608 lists");
    expect_repeated("a.gltf", HEAD "\"x\":[1", ",", 16777217, "]}", "16777216 values");
    expect_repeated("a.gltf", HEAD "\"materials\":[{}", ",{}", 65536, "]}", "materials: more than 65536");
    /* more warnings than are kept */
    expect_repeated("a.gltf", HEAD TRIANGLE "\"meshes\":[{\"primitives\":[" ONE,
                    ",{\"attributes\":{\"POSITION\":0},\"mode\":0}", 30, "]}]}", NULL);
    /* more slots in a mesh than are searched, and a repeated one */
    struct bytes b = {0};
    bytes_print(&b, "%s", HEAD TRIANGLE "\"materials\":[{}");
    for (int i = 1; i < 300; i++)
        bytes_print(&b, ",{}");
    bytes_print(&b, "],\"meshes\":[{\"primitives\":[" ONE);
    for (int i = 0; i < 310; i++)
        bytes_print(&b, ",{\"attributes\":{\"POSITION\":0},\"indices\":1,\"material\":%d}", i < 300 ? i : 299);
    bytes_print(&b, "]}]}");
    expect("a.gltf", b.data, b.size, NULL);
    bytes_free(&b);
#endif
}

#ifdef HAVE_JANSSON
TEST(a_second_binary_chunk_of_a_glb_is_passed_over) {
    struct maker m = {0};
    struct bytes b = {0};
    maker_sphere(&m, 3);
    write_glb(&b, &m);
    bytes_number(&b, 4, 4, false);
    bytes_add(&b, "BIN\0abcd", 8);
    b.data[8] = (uint8_t)b.size, b.data[9] = (uint8_t)(b.size >> 8), b.data[10] = (uint8_t)(b.size >> 16);
    expect("a.glb", b.data, b.size, NULL);
    bytes_free(&b);
    maker_free(&m);
}

/* Files without scenes, without nodes, and with more children than a stack begins with. */
TEST(any_allocation_may_fail_while_nodes_are_read) {
#ifndef GRAY_FAULTS
    test_skip("allocations fail on demand only in builds with GRAY_FAULTS");
#endif
    struct bytes b = {0};
    check_failed_allocations("t.gltf", &(struct bytes){(uint8_t *)(uintptr_t)(HEAD TRIANGLE MESH "}"),
                                                       sizeof(HEAD TRIANGLE MESH "}") - 1, 0});
    bytes_print(&b, "%s", HEAD TRIANGLE MESH ",\"nodes\":[{\"mesh\":0,\"children\":[1");
    for (int i = 2; i < 150; i++)
        bytes_print(&b, ",%d", i);
    bytes_print(&b, "]}");
    for (int i = 1; i < 150; i++)
        bytes_print(&b, ",{\"mesh\":0}");
    bytes_print(&b, "]}");
    check_failed_allocations("t.gltf", &b);
    bytes_free(&b);
}
#endif

/* A limit that the test sets replaces the limit of 32-bit indices. */
static void expect_max(const char *name, const void *data, size_t size, size_t max, const char *words) {
    struct model model;
    struct error error;
    struct model_options options = {.max = max};
    bool ok = parse_model(&model, test_path(name), data, size, &options, &error);
    if (ok != !words || (words && !strstr(error.text, words)))
        test_fail(__FILE__, __LINE__, "%s, at most %zu: %s, not '%s'", name, max, ok ? "is read" : error.text,
                  words ? words : "read");
    if (ok)
        model_destroy(&model);
}

TEST(more_than_an_index_can_name_is_an_error_of_every_reader) {
    static const char obj[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 4\n";
    static const char names[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nusemtl b\nusemtl c\nusemtl d\nf 1 2 3\n";
    static const char ply[] = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                              "property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
                              "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 2 1\n";
    static const char strip[] = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                                "property float z\nelement tristrips 1\nproperty list uchar int vertex_indices\n"
                                "end_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n4 0 1 2 3\n";
    static const char stl[] = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                              "endloop\nendfacet\nendsolid\n";
    expect_max("t.obj", obj, strlen(obj), 6, NULL);
    expect_max("t.obj", obj, strlen(obj), 5, "t.obj:8: more corners than an index can name");
    expect_max("t.obj", obj, strlen(obj), 3, "t.obj:4: more elements than an index can name");
    expect_max("t.obj", names, strlen(names), 4, NULL);
    expect_max("t.obj", names, strlen(names), 3, "out of memory");
    expect_max("t.ply", ply, strlen(ply), 6, NULL);
    expect_max("t.ply", ply, strlen(ply), 5, "more corners than an index can name");
    expect_max("t.ply", ply, strlen(ply), 2, "more corners than an index can name");
    expect_max("t.ply", strip, strlen(strip), 6, NULL);
    expect_max("t.ply", strip, strlen(strip), 5, "more corners than an index can name");
    expect_max("t.stl", stl, strlen(stl), 3, NULL);
    expect_max("t.stl", stl, strlen(stl), 2, "t.stl:8: too many triangles");
    struct maker m = {0};
    struct bytes b = {0};
    maker_sphere(&m, 3);
    write_stl(&b, &m, true, "ball");
    expect_max("t.stl", b.data, b.size, 5, "triangles are too many");
    bytes_free(&b);
    /* More vertices than corners; the readers have no separate check for that. */
    bytes_print(&b, "ply\nformat ascii 1.0\nelement vertex 7\nproperty float x\nproperty float y\nproperty float z\n"
                    "element face 1\nproperty list uchar int vertex_indices\nend_header\n");
    for (int i = 0; i < 7; i++)
        bytes_print(&b, "%d %d 0\n", i, i * i);
    bytes_print(&b, "3 0 1 2\n");
    expect_max("t.ply", b.data, b.size, 6, "more than 6 vertices or corners");
    bytes_free(&b);
#ifdef HAVE_JANSSON
    static const char gltf[] = HEAD TRIANGLE "\"meshes\":[{\"primitives\":[" ONE "," ONE "]}]}";
    expect_max("t.gltf", gltf, strlen(gltf), 6, NULL);
    expect_max("t.gltf", gltf, strlen(gltf), 5, "too many vertices");
    /* three vertices, each of them twice */
    bytes_print(&b, "%s",
                HEAD
                "\"buffers\":[{\"uri\":\"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAECAAEC\"}],"
                "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,"
                "\"byteLength\":6}],\"accessors\":[" POINTS
                ",{\"bufferView\":1,\"componentType\":5121,\"count\":6,\"type\":\"SCALAR\"}]," MESH "}");
    expect_max("t.gltf", b.data, b.size, 6, NULL);
    expect_max("t.gltf", b.data, b.size, 5, "more than 5 vertices or corners");
    bytes_free(&b);
#endif
    maker_free(&m);
}

/* Lists that grow while they are filled, and one that is full when its end is added. */
TEST(any_allocation_may_fail_while_long_lists_grow) {
#ifndef GRAY_FAULTS
    test_skip("allocations fail on demand only in builds with GRAY_FAULTS");
#endif
    struct bytes b = {0};
    bytes_print(&b, "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nusemtl x\nf 1 2 3\n");
    for (int i = 0; i < 300; i++)
        bytes_print(&b, "usemtl m%d\ng g%d\nf 1/1/1 2 3//1\n", i % 70, i % 3);
    check_failed_allocations("t.obj", &b);
    bytes_free(&b);
    bytes_add(&b, (const char[80]){0}, 80);
    bytes_number(&b, 100, 4, false);
    for (int i = 0; i < 100; i++) {
        for (int k = 0; k < 12; k++)
            bytes_float(&b, k == 6 || k == 10 ? 1 : k % 3 == 2 ? i : 0, false);
        bytes_number(&b, 0, 2, false);
    }
    check_failed_allocations("t.stl", &b);
    bytes_free(&b);
    /* strips and faces with texture coordinates, in both orders */
    for (int order = 0; order < 2; order++) {
        bytes_print(&b, "ply\nformat ascii 1.0\nelement vertex 150\nproperty float x\nproperty float y\n"
                        "property float z\n");
        for (int k = 0; k < 2; k++)
            bytes_print(&b, k == order ? "element tristrips 1\nproperty list int int vertex_indices\n"
                                       : "element face 40\nproperty list uchar int vertex_indices\n"
                                         "property list uchar float texcoord\n");
        bytes_print(&b, "end_header\n");
        for (int i = 0; i < 150; i++)
            bytes_print(&b, "%d %d %d\n", i / 2, i % 2, i % 7);
        for (int k = 0; k < 2; k++) {
            for (int i = 0; k != order && i < 40; i++)
                bytes_print(&b, "6 %d %d %d %d %d %d 12 0 0 1 0 1 1 0 1 0 0 1 1\n", i, i + 1, i + 2, i + 3, i + 5,
                            i + 4);
            if (k == order)
                bytes_print(&b, "150");
            for (int i = 0; k == order && i < 150; i++)
                bytes_print(&b, i == 149 ? " %d\n" : " %d", i);
        }
        check_failed_allocations("t.ply", &b);
        bytes_free(&b);
    }
    /* many strips of one triangle, whose number is not known in advance */
    bytes_print(&b, "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                    "element tristrips 3\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n");
    for (int k = 0; k < 3; k++) {
        bytes_print(&b, "200");
        for (int i = 0; i < 200; i++)
            bytes_print(&b, " %d", i % 3);
        bytes_print(&b, "\n");
    }
    check_failed_allocations("t.ply", &b);
    bytes_free(&b);
}

TEST(texture_coordinates_that_are_no_numbers_are_left_out) {
    struct bytes b = {0};
    bytes_print(&b, "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                    "property float z\nelement face 1\nproperty list uchar uchar vertex_indices\n"
                    "property list uchar float texcoord\nend_header\n");
    for (int k = 0; k < 9; k++)
        bytes_float(&b, k == 3 || k == 7, false);
    bytes_add(&b, "\3\0\1\2\6", 5);
    for (int k = 0; k < 6; k++)
        bytes_float(&b, k == 4 ? (double)INFINITY : 0.5, false);
    struct model model;
    struct error error;
    CHECK(parse_model(&model, "t.ply", b.data, b.size, NULL, &error));
    CHECK_TEXT(error.text, "");
    char warning[200];
    (void)snprintf(warning, sizeof warning,
                   "t.ply: byte %zu: texture coordinates are not finite: faces that use them have none", b.size);
    CHECK_EQ_INT(model.warning_count, 1);
    CHECK_TEXT(model.warnings[0], warning);
    model_destroy(&model);
    bytes_free(&b);
}

/* gzip members whose parts do not align with the blocks passed to zlib: an empty one, a name of 10,000 bytes, and
 * megabytes. */
TEST(gzip_of_any_length_is_read_piece_by_piece) {
    char line[4096];
    (void)snprintf(
        line, sizeof line,
        "cd '%s' && { printf 'v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n'; yes '# nothing' | head -n 60000; } "
        ">t.obj && { printf '\\037\\213\\010\\010\\0\\0\\0\\0\\0\\003'; head -c 10000 /dev/zero | tr '\\0' n; "
        "printf '\\0'; gzip -n <t.obj | tail -c +11; gzip -n </dev/null; } >t.obj.gz",
        test_folder());
    test_need_tools("gzip");
    CHECK(system(line) == 0);
    struct bytes b = {0};
    b.data = (uint8_t *)test_read_file(test_path("t.obj.gz"), &b.size);
    CHECK(b.data != NULL);
    expect("t.obj.gz", b.data, b.size, NULL);
    check_failed_allocations("t.obj.gz", &b);
    bytes_free(&b);
}

TEST(names_in_a_library_without_a_scene_are_kept_as_they_are) {
    static const char text[] = "newmtl a\nmap_Kd x\\y.png\n";
    struct model model = {.path = "d/t.obj", .options.single_file = true};
    struct error error = {0};
    CHECK(mtl_load(&model, "d/t.mtl", text, strlen(text), &error));
    CHECK(model.materials.count == 1 && strstr(model_materials(&model)[0].map_kd.name, "y.png"));
    model_destroy(&model);
}

#ifdef HAVE_JANSSON
/* Each of 400 primitives uses three vertices and passes twice over 2,000 sparse ones. */
TEST(sparse_parts_that_are_walked_through_too_often_are_refused) {
    enum { SPARSE = 2000 };
    struct bytes b = {0}, buffer = {0};
    for (int i = 0; i < SPARSE; i++)
        bytes_number(&buffer, (uint64_t)i, 2, false);
    bytes_add(&buffer, "\0\1\2\0", 4);
    buffer.data = realloc(buffer.data, buffer.size + 12 * SPARSE);
    memset(buffer.data + buffer.size, 0, 12 * SPARSE);
    size_t used = buffer.size;
    buffer.size += 12 * SPARSE;
    bytes_print(&b, HEAD "\"buffers\":[{\"uri\":\"data:;base64,");
    write_base64(&b, &buffer);
    bytes_print(&b,
                "\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":%d},{\"buffer\":0,\"byteOffset\":%d,"
                "\"byteLength\":3},{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%d}],\"accessors\":[{"
                "\"componentType\":5126,\"count\":%d,\"type\":\"VEC3\",\"sparse\":{\"count\":%d,\"indices\":{"
                "\"bufferView\":0,\"componentType\":5123},\"values\":{\"bufferView\":2}}}," INDICES
                "],\"meshes\":[{\"primitives\":[",
                2 * SPARSE, 2 * SPARSE, used, 12 * SPARSE, SPARSE, SPARSE);
    for (int i = 0; i < 400; i++)
        bytes_print(&b, "%s{\"attributes\":{\"POSITION\":0,\"NORMAL\":0},\"indices\":1}", i ? "," : "");
    bytes_print(&b, "]}]}");
    expect("t.gltf", b.data, b.size, "more vertices than a file of");
    bytes_free(&b), bytes_free(&buffer);
}

TEST(a_single_file_has_no_warning_of_missing_pictures) {
    static const char text[] = HEAD TRIANGLE MESH ",\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{"
                                                  "\"index\":0}}}],\"textures\":[{\"source\":0}],"
                                                  "\"images\":[{\"uri\":\"gone.png\"}]}";
    for (int single_file = 0; single_file < 2; single_file++) {
        struct model model;
        struct error error;
        struct model_options options = {.single_file = single_file};
        CHECK(parse_model(&model, "t.gltf", text, strlen(text), &options, &error));
        CHECK_EQ_INT(model.warning_count, 1 - single_file);
        model_destroy(&model);
    }
}
#endif

TEST(numbers_of_any_length_are_read_exactly_or_refused) {
    double x = 7;
    char *much = malloc(200000);
    static const char sign[] = "-";
    CHECK(decimal_read(sign, sign, &x) == NULL && decimal_read(sign, sign + 1, &x) == NULL);
    memset(much, '0', 200000);
    much[1] = '.';
    CHECK(decimal_read(much, much + 150000, &x) == much + 150000 && x == 0);
    much[149999] = '1';
    CHECK(decimal_read(much, much + 150000, &x) == NULL); /* too long for the rest of the file */
    memset(much, '9', 1300);
    CHECK(decimal_read(much, much + 1300, &x) == NULL);
    CHECK(decimal_read(much, much + 300, &x) == much + 300 && x > 9e299);
    static const char large[] = "1e400", small[] = "1e-400";
    CHECK(decimal_read(large, large + 5, &x) == NULL);
    CHECK(decimal_read(small, small + 6, &x) == small + 6 && x == 0);
    free(much);
}
