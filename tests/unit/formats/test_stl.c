#include "tests/unit/model_makers.h"

#include <zlib.h>

#define FACET "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"

TEST(stl_text_and_binary_are_closed_solids_again) {
    struct maker m = {0};
    maker_sphere(&m, 6);
    maker_round(&m);
    struct mesh *wanted = maker_mesh(&m);
    static const char *const names[] = {"solid ball", "made by a program"};
    for (int kind = 0; kind < 3; kind++) { /* text; binary that begins with "solid"; binary */
        struct bytes b = {0};
        struct model model;
        struct error error;
        write_stl(&b, &m, kind > 0, names[kind == 2]);
        CHECK(parse_model(&model, kind == 1 ? "t.bin" : "t.stl", b.data, b.size, NULL, &error));
        CHECK_TEXT(error.text, "");
        if (error.kind == ERROR_NONE) {
            uint32_t vertices;
            CHECK(same_faces(only_mesh(&model), wanted));
            CHECK(mesh_is_closed(only_mesh(&model)));
            (void)mesh_vertices(only_mesh(&model), &vertices);
            CHECK_EQ_INT(vertices, 4 * 6 * 6 + 2);
            model_destroy(&model);
        }
        bytes_free(&b);
    }
    mesh_release(wanted);
    maker_free(&m);
}

TEST(stl_text_may_be_loud_and_hold_several_solids) {
    static const char text[] = "SOLID a b c\r\nFACET NORMAL nan nan nan OUTER LOOP\r\nVERTEX 0 0 0 Vertex 1e0 0 0\r\n"
                               "vertex 0 1 0\r\nENDLOOP ENDFACET\r\nENDSOLID a b c\r\n\r\nsolid\r\n" FACET "endsolid";
    struct model model;
    struct error error;
    CHECK(parse_model(&model, "t.STL", text, strlen(text), NULL, &error));
    CHECK_TEXT(error.text, "");
    CHECK_EQ_INT(mesh_triangle_count(only_mesh(&model)), 2);
    model_destroy(&model);
}

TEST(stl_errors_name_the_line) {
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"solid a\n", "t.stl: no triangles in this STL text"},
        {"solid ", "t.stl: no triangles in this STL text"},
        {"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid",
         "t.stl:6: 'vertex' is found where a finite number must be"},
        {"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 nan\n",
         "t.stl:4: 'nan' is found where a finite number must be"},
        {"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1e999\n",
         "t.stl:4: '1e999' is found where a finite number must be"},
        {"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nvertex 1 1 0\n",
         "t.stl:7: 'vertex' is found where endloop must be"},
        {"solid a\nfacet normal 0 0",
         "t.stl: no faces in this file (t.stl:2: the file ends in a triangle, which is left out)"},
        {"solid a\nendsolid a\n", "t.stl: no triangles in this STL text"},
        {"solid a\nface 1 2 3\n",
         "t.stl: no faces in this file (t.stl:2: 1 line with a keyword that gray does not read, the first here: "
         "'face' (1))"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        check_text_refused("t.stl", cases[i].text, cases[i].message);
    struct maker m = {0};
    maker_sphere(&m, 1);
    maker_round(&m);
    struct bytes b = {0};
    write_stl(&b, &m, true, "x");
    check_refused("t.stl", b.data, 40, "t.stl: byte 40: a binary STL file has at least 84 bytes");
    check_refused("t.stl", b.data, b.size - 51,
                  "t.stl: byte 80: 8 triangles need 484 bytes, but the file has only 433");
    float bad = INFINITY;
    memcpy(b.data + 84 + 50 + 12, &bad, 4);
    check_refused("t.stl", b.data, b.size, "t.stl: byte 146: a coordinate is not a finite number");
    memset(b.data + 80, 0xff, 4);
    check_refused("t.stl", b.data, b.size,
                  "t.stl: byte 80: 4294967295 triangles need 214748364834 bytes, but the file has only 484");
    bytes_free(&b);
    maker_free(&m);
}

TEST(stl_survives_cuts_changes_and_failed_allocations) {
    struct maker m = {0};
    maker_sphere(&m, 2);
    maker_round(&m);
    for (int binary = 0; binary < 2; binary++) {
        struct bytes b = {0};
        write_stl(&b, &m, binary, "solid thing");
        check_cut_anywhere("t.stl", &b, 7);
        check_changed_anywhere("t.stl", &b, 2000);
        check_failed_allocations("t.stl", &b);
        bytes_free(&b);
    }
    maker_free(&m);
}

static void pack(struct bytes *out, const struct bytes *in) {
    z_stream stream = {0};
    uint8_t buffer[4096];
    CHECK(deflateInit2(&stream, 9, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY) == Z_OK);
    stream.next_in = in->data;
    stream.avail_in = (uInt)in->size;
    int status = Z_OK;
    while (status == Z_OK) {
        stream.next_out = buffer;
        stream.avail_out = sizeof buffer;
        status = deflate(&stream, Z_FINISH);
        bytes_add(out, buffer, sizeof buffer - stream.avail_out);
    }
    (void)deflateEnd(&stream);
}

TEST(gzip_of_every_format_is_read) {
    struct maker m = {0};
    maker_sphere(&m, 4);
    maker_round(&m);
    struct mesh *wanted = maker_mesh(&m);
    static const char *const paths[] = {"t.obj.gz", "t.ply.gz",  "t.ply.GZ", "t.stl.gz",
                                        "t.stl.gz", "t.gltf.gz", "t.glb.gz"};
    for (int kind = 0; kind < 7; kind++) {
        struct bytes plain = {0}, packed = {0};
        struct model model;
        struct error error;
        if (kind == 0)
            write_obj(&plain, &m);
        else if (kind < 3)
            write_ply(&plain, &m, kind == 1 ? PLY_ASCII : PLY_BIG);
        else if (kind < 5)
            write_stl(&plain, &m, kind == 4, "solid x");
        else if (kind == 5)
            write_gltf(&plain, &m);
        else
            write_glb(&plain, &m);
        pack(&packed, &plain);
#ifndef HAVE_JANSSON
        if (kind >= 5) {
            check_refused(paths[kind], packed.data, packed.size, NULL);
            bytes_free(&plain), bytes_free(&packed);
            continue;
        }
#endif
        bool ok = parse_model(&model, paths[kind], packed.data, packed.size, NULL, &error);
        CHECK_TEXT(error.text, "");
        CHECK(ok && same_faces(only_mesh(&model), wanted));
        if (ok)
            model_destroy(&model);
        bytes_free(&plain);
        bytes_free(&packed);
    }
    mesh_release(wanted);
    maker_free(&m);
}

TEST(gzip_that_is_broken_or_grows_beyond_reason_is_refused) {
    struct bytes zeros = {0}, packed = {0}, text = {0}, whole = {0};
    char *block = calloc(1, 1 << 20);
    for (int i = 0; i < 64; i++)
        bytes_add(&zeros, block, 1 << 20);
    free(block);
    pack(&packed, &zeros);
    check_refused("bomb.obj.gz", packed.data, packed.size, NULL);
    bytes_print(&text, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    pack(&whole, &text);
    check_refused("t.obj.gz", whole.data, whole.size - 9, NULL);
    check_refused("t.obj.gz", whole.data, 10, "t.obj.gz: byte 10: the gzip data end too early");
    struct bytes two = {0};
    bytes_add(&two, whole.data, whole.size);
    bytes_add(&two, "x", 1);
    char message[100];
    (void)snprintf(message, sizeof message, "t.obj.gz: byte %zu: other bytes follow the gzip data", whole.size);
    check_refused("t.obj.gz", two.data, two.size, message);
    /* Two members are one text. */
    struct model model;
    struct error error;
    struct bytes more = {0}, face = {0};
    bytes_print(&face, "f 3 2 1\n");
    bytes_add(&more, whole.data, whole.size);
    pack(&more, &face);
    CHECK(parse_model(&model, "t.obj.gz", more.data, more.size, NULL, &error));
    CHECK_TEXT(error.text, "");
    if (error.kind == ERROR_NONE) {
        CHECK_EQ_INT(mesh_face_count(only_mesh(&model)), 2);
        model_destroy(&model);
    }
    whole.data[whole.size - 6] ^= 1; /* the checksum */
    check_refused("t.obj.gz", whole.data, whole.size, NULL);
    check_changed_anywhere("t.obj.gz", &more, 3000);
    check_failed_allocations("t.obj.gz", &more);
    bytes_free(&zeros), bytes_free(&packed), bytes_free(&text), bytes_free(&whole), bytes_free(&two), bytes_free(&more);
    bytes_free(&face);
}
