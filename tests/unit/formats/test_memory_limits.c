/* --script-memory limits everything that a scene makes the program allocate: memory to decode files, the structures for
 * a picture, the picture itself. Each attack ends with one line and status 1, and no process takes more than the limit
 * plus a tenth beyond the memory of an empty script; with a picture, three quarters of the limit more. */
#include "base/error.h"
#include "base/mem.h"
#include "film/tile_file.h"
#include "formats/font.h"
#include "formats/model.h"
#include "image/exr.h"
#include "image/jpeg_read.h"
#include "render/render.h"
#include "session/options.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#ifdef HAVE_JPEG
#include <jpeglib.h>
#endif

#define MATERIAL "material=gr.material({1,1,1},{0,0,0},1)"

enum { KIB_OF_LIMIT = 16 << 10 };

/* A program without the limit must not take the machine's memory. */
static void guard(void) {
    struct rlimit limit;
    CHECK(getrlimit(RLIMIT_AS, &limit) == 0);
    limit.rlim_cur = (rlim_t)2 << 30;
    if (!test_has_sanitizer())
        CHECK(setrlimit(RLIMIT_AS, &limit) == 0);
}

static void forget(struct test_result result) {
    test_free_result(&result);
}

/* The memory of an empty script; to be called after files are made. */
static long memory_of_nothing(void) {
    struct test_result plain = test_gray_scene("local x = 1", "scene.lua", NULL);
    CHECK_EQ_INT(plain.status, 0);
    forget(plain);
    return test_children_used().kibibytes;
}

static void check_memory(const char *what, long without, long limit) {
    long more = test_children_used().kibibytes - without;
    if (!test_has_sanitizer() && more > limit * 11 / 10)
        test_fail(__FILE__, __LINE__, "%s: %ld KiB over an empty script for a limit of %ld", what, more, limit);
}

/* The scene ends with one line that contains these words, and status 1. */
static void check_line(const char *text, const char *arguments, const char *words) {
    struct test_result result = test_gray_scene(text, arguments, NULL);
    const char *end = strchr(result.err, '\n');
    if (result.status != 1 || !strstr(result.err, words) || !end || end[1] != '\0')
        test_fail(__FILE__, __LINE__, "%s: status %d: %.500s", text, result.status, result.err);
    forget(result);
}

/* --- files that need more memory than there is --- */

/* A file with this beginning followed by a hole. */
static void write_sparse(const char *name, const void *head, size_t head_size, off_t size) {
    test_write_file(test_path(name), head, head_size);
    CHECK(truncate(test_path(name), size) == 0);
}

static void write_sparse_text(const char *name, const char *head, off_t size) {
    write_sparse(name, head, strlen(head), size);
}

static void write_sparse_stl(const char *name, uint32_t triangles) {
    uint8_t head[84] = {0};
    for (int k = 0; k < 4; k++)
        head[80 + k] = (uint8_t)(triangles >> 8 * k);
    write_sparse(name, head, sizeof head, 84 + 50 * (off_t)triangles);
}

static uint8_t *put_big_endian(uint8_t *at, uint32_t value) {
    for (int k = 0; k < 4; k++)
        *at++ = (uint8_t)(value >> (24 - 8 * k));
    return at;
}

static void write_chunk(FILE *file, const char *kind, const uint8_t *data, uint32_t size) {
    uint8_t number[4];
    (void)put_big_endian(number, size);
    (void)fwrite(number, 1, 4, file);
    (void)fwrite(kind, 1, 4, file);
    (void)fwrite(data, 1, size, file);
    uLong check = crc32(crc32(0, (const uint8_t *)kind, 4), data, size);
    (void)put_big_endian(number, (uint32_t)check);
    (void)fwrite(number, 1, 4, file);
}

/* One bit a pixel, all black: a few KB for many pixels. */
static void write_black_png(const char *name, uint32_t width, uint32_t height) {
    static const uint8_t signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    uint8_t header[13] = {0};
    uLong raw = (((uLong)width + 7) / 8 + 1) * height, packed = compressBound(raw);
    uint8_t *zeros = calloc(1, raw), *data = malloc(packed);
    CHECK(zeros && data && compress2(data, &packed, zeros, raw, 9) == Z_OK);
    header[8] = 1;
    (void)put_big_endian(put_big_endian(header, width), height);
    FILE *file = fopen(test_path(name), "wb");
    CHECK(file != NULL);
    (void)fwrite(signature, 1, sizeof signature, file);
    write_chunk(file, "IHDR", header, sizeof header);
    write_chunk(file, "IDAT", data, (uint32_t)packed);
    write_chunk(file, "IEND", header, 0);
    (void)fclose(file);
    free(zeros);
    free(data);
}

/* A text repeated many times, compressed. */
static void write_gzip(const char *name, const char *text, int times) {
    gzFile file = gzopen(test_path(name), "wb1");
    for (int k = 0; k < times; k++)
        CHECK(gzputs(file, text) > 0);
    CHECK(gzclose(file) == Z_OK);
}

static void write_repeated(const char *name, const char *head, const char *text, int times, const char *tail) {
    FILE *file = fopen(test_path(name), "wb");
    CHECK(file != NULL);
    (void)fputs(head, file);
    for (int k = 0; k < times; k++)
        (void)fputs(text, file);
    (void)fputs(tail, file);
    CHECK(fclose(file) == 0);
}

/* A square of n x n vertices, whose corners are smoothed and welded. */
static void write_grid(const char *name, int n) {
    FILE *file = fopen(test_path(name), "wb");
    CHECK(file != NULL);
    for (int k = 0; k < n * n; k++)
        (void)fprintf(file, "v %d %d %d\n", k % n, k * 7919 % 13, k / n);
    for (int k = 0; k < n * n - n; k++) {
        if (k % n + 1 < n)
            (void)fprintf(file, "f %d %d %d\nf %d %d %d\n", k + 1, k + 2, k + n + 1, k + 2, k + n + 2, k + n + 1);
    }
    CHECK(fclose(file) == 0);
}

struct attack {
    const char *file, *scene; /* a format string for the name */
};

static void check_attacks(const struct attack *attacks, size_t count) {
    long without = memory_of_nothing();
    for (size_t i = 0; i < count; i++) {
        char text[512], words[256];
        (void)snprintf(text, sizeof text, attacks[i].scene, attacks[i].file);
        (void)snprintf(words, sizeof words, "%s: needs more than the 16 MiB of --script-memory", attacks[i].file);
        check_line(text, "-j 2 --script-time 5 --script-memory 16 scene.lua", words);
        check_memory(attacks[i].file, without, KIB_OF_LIMIT);
    }
}

#define MESH "gr.mesh{file='%s', " MATERIAL "}"
#define IMAGE "gr.texture('%s')"

TEST(a_mesh_file_that_needs_more_memory_than_allowed_is_one_line) {
    static const struct attack attacks[] = {
        {"sparse.stl", MESH},
        {"sparse.stl", "gr.mesh{file='%s', weld=true, smooth=30, flip=true, " MATERIAL "}"},
        {"corners.stl", MESH}, /* fits, but its results do not */
        {"sparse.obj", MESH},
        {"sparse.obj", "pcall(gr.mesh, {file='%s', " MATERIAL "})"},
        {"sparse.obj", "coroutine.wrap(pcall)(gr.mesh, {file='%s', " MATERIAL "})"},
        {"sparse.obj", "local t <close> = setmetatable({}, {__close = function() while true do end end}) " MESH},
        {"lines.obj", MESH},
        {"grid.obj", "gr.mesh{file='%s', weld=true, smooth=30, flip=true, " MATERIAL "}"},
        {"sparse.ply", MESH},
        {"vertices.ply", MESH},
        {"ascii.ply", MESH},
        {"ascii.stl", MESH},
        {"packed.obj.gz", MESH},
        {"with_library.obj", MESH},
    };
    guard();
    write_sparse_stl("sparse.stl", 2000000);
    write_sparse_stl("corners.stl", 200000);
    write_sparse_text("sparse.obj", "v 0 0 0\n", 1 << 28);
    write_repeated("lines.obj", "", "v 1 2 3\n", 1000000, "f 1 2 3\n");
    write_grid("grid.obj", 260);
    write_sparse_text("sparse.ply", "ply\nformat binary_little_endian 1.0\n", 1 << 28);
    write_sparse_text("vertices.ply",
                      "ply\nformat binary_little_endian 1.0\nelement vertex 1000000\nproperty float x\n"
                      "property float y\nproperty float z\nelement face 1\n"
                      "property list uchar int vertex_indices\nend_header\n",
                      12000000 + 200);
    write_repeated("ascii.ply",
                   "ply\nformat ascii 1.0\nelement vertex 800000\nproperty float x\nproperty float y\n"
                   "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n",
                   "1 2 3\n", 800000, "3 0 1 2\n");
    write_repeated("ascii.stl", "solid x\n",
                   "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n",
                   150000, "endsolid x\n");
    write_gzip("packed.obj.gz", "v 1 2 3\n", 1900000);
    write_sparse_text("big.mtl", "newmtl a\n", 1 << 27);
    test_write_text(test_path("with_library.obj"), "mtllib big.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    check_attacks(attacks, sizeof attacks / sizeof *attacks);
}

TEST(a_gltf_file_that_needs_more_memory_than_allowed_is_one_line) {
    static const char external[] =
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"uri\":\"big.bin\",\"byteLength\":120000000}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":120000000}],\"accessors\":[{\"bufferView\":0,"
        "\"componentType\":5126,\"count\":9999999,\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":[{\"attributes\":"
        "{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0}]}";
    static const char claimed[] = "{\"asset\":{\"version\":\"2.0\"},\"accessors\":[{\"componentType\":5126,"
                                  "\"count\":520000,\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":[{\"attributes\":"
                                  "{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0}]}";
    static const struct attack attacks[] = {
        {"values.gltf", MESH}, {"objects.gltf", MESH},  {"nested.gltf", MESH},
        {"sparse.glb", MESH},  {"external.gltf", MESH}, {"claimed.gltf", MESH},
    };
    test_need_json();
    guard();
    write_repeated("values.gltf", "{\"asset\":{\"version\":\"2.0\"},\"x\":[0", ",0", 2000000, "]}");
    write_repeated("objects.gltf", "{\"asset\":{\"version\":\"2.0\"},\"x\":[0", ",{}", 300000, "]}");
    write_repeated("nested.gltf", "{\"asset\":{\"version\":\"2.0\"},\"x\":[0", ",[[[[[[[]]]]]]]", 80000, "]}");
    write_sparse_text("sparse.glb", "glTF", 1 << 28);
    write_sparse_text("big.bin", "", 120000000);
    test_write_text(test_path("external.gltf"), external);
    test_write_text(test_path("claimed.gltf"), claimed);
    check_attacks(attacks, sizeof attacks / sizeof *attacks);
}

#ifdef HAVE_JPEG
static void write_jpeg(const char *name, uint32_t width, uint32_t height, bool progressive) {
    struct jpeg_compress_struct jpeg;
    struct jpeg_error_mgr errors;
    uint8_t *line = malloc(3 * (size_t)width);
    FILE *file = fopen(test_path(name), "wb");
    CHECK(file && line);
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    jpeg_stdio_dest(&jpeg, file);
    jpeg.image_width = width;
    jpeg.image_height = height;
    jpeg.input_components = 3;
    jpeg.in_color_space = JCS_RGB;
    jpeg_set_defaults(&jpeg);
    jpeg_set_quality(&jpeg, 30, TRUE);
    if (progressive)
        jpeg_simple_progression(&jpeg);
    jpeg_start_compress(&jpeg, TRUE);
    for (uint32_t y = 0; y < height; y++) {
        JSAMPROW row = line;
        for (uint32_t x = 0; x < 3 * width; x++)
            line[x] = (uint8_t)(7 * (x / 64 + y / 64));
        (void)jpeg_write_scanlines(&jpeg, &row, 1);
    }
    jpeg_finish_compress(&jpeg);
    jpeg_destroy_compress(&jpeg);
    (void)fclose(file);
    free(line);
}

/* For a progressive file libjpeg holds all coefficients in its own memory. */
TEST(a_jpeg_that_needs_more_memory_than_allowed_is_one_line) {
    static const struct attack attacks[] = {
        {"large.jpg", IMAGE}, {"progressive.jpg", IMAGE}, {"medium.jpg", IMAGE}, {"sparse.jpg", IMAGE}};
    guard();
    write_jpeg("large.jpg", 3000, 3000, false);
    write_jpeg("progressive.jpg", 3000, 2000, true);
    write_jpeg("medium.jpg", 1300, 1300, true); /* its texels alone would fit */
    write_sparse("sparse.jpg", "\xff\xd8\xff\xe0", 4, 1 << 28);
    check_attacks(attacks, sizeof attacks / sizeof *attacks);
}
#endif

TEST(a_picture_file_that_needs_more_memory_than_allowed_is_one_line) {
    static const struct attack attacks[] = {
        {"sparse.png", IMAGE},
        {"black.png", IMAGE},
        {"black.png", "gr.render{node=gr.node'n', file='o.png', width=8, height=8, eye={0,0,9}, sky='%s'}"},
        {"black.png", "gr.sky_cross('%s')"},
        {"black.png", "gr.sky_map('%s')"},
        {"black.png", "pcall(gr.texture, '%s')"},
        {"mips.png", IMAGE}, /* fits, but not with its mip levels */
        {"sparse.pfm", IMAGE},
        {"texels.pfm", IMAGE},
        {"sparse.hdr", IMAGE},
    };
    guard();
    write_sparse("sparse.png", "\x89PNG\r\n\x1a\n", 8, 1 << 28);
    write_black_png("black.png", 8192, 4096);
    write_black_png("mips.png", 2000, 2000);
    write_sparse_text("sparse.pfm", "PF\n4000 3000\n-1.0\n", 18 + 12 * 12000000);
    write_sparse_text("texels.pfm", "Pf\n1000 1000\n-1.0\n", 18 + 4 * 1000000);
    write_sparse_text("sparse.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1500 +X 1500\n", 4 * 2250000 + 100);
    check_attacks(attacks, sizeof attacks / sizeof *attacks);
}

TEST(an_exr_that_needs_more_memory_than_allowed_is_one_line) {
    static const struct attack attacks[] = {{"large.exr", IMAGE}, {"sparse.exr", IMAGE}};
    test_need_exr();
    struct test_result made = test_gray_scene(
        "gr.render{node=gr.node'n', file='large.exr', width=1200, height=1000, eye={0,0,9}}", "-q scene.lua", NULL);
    CHECK_EQ_INT(made.status, 0);
    forget(made);
    write_sparse("sparse.exr", "\x76\x2f\x31\x01", 4, 1 << 28);
    /* Writing the file took memory, too: the measurement begins with the next process. */
    guard();
    for (size_t i = 0; i < sizeof attacks / sizeof *attacks; i++) {
        char text[256], words[256];
        (void)snprintf(text, sizeof text, attacks[i].scene, attacks[i].file);
        (void)snprintf(words, sizeof words, "%s: needs more than the 16 MiB of --script-memory\n", attacks[i].file);
        check_line(text, "--script-memory 16 scene.lua", words);
    }
}

TEST(a_font_that_needs_more_memory_than_allowed_is_one_line) {
    static const struct attack attacks[] = {{"sparse.ttf", "gr.glyphs('%s', '')"}};
    if (!FONTS_READABLE)
        test_lacks("gray was built without FreeType");
    guard();
    write_sparse("sparse.ttf", "\0\1\0\0", 4, 200 << 20);
    check_attacks(attacks, 1);
}

TEST(lua_and_text_files_that_need_more_memory_than_allowed_are_one_line) {
    static const struct attack attacks[] = {
        {"sparse.lua", "dofile('%s')"},
        {"sparse.lua", "loadfile('%s')"},
        {"sparse.lua", "require 'sparse' -- %s"},
        {"sparse.lua", "pcall(dofile, '%s')"},
        {"sparse.lua", "xpcall(dofile, print, '%s')"},
    };
    static const char *const texts[] = {
        "io.open('sparse.txt'):read('a')",
        "for l in io.lines('sparse.txt') do end",
        "io.input('sparse.txt') io.read('a')",
        "local t = {} for k in io.lines('sparse.txt', 1024) do t[#t + 1] = k .. #t end",
        "local t = {} for k = 1, 1e6 do t[k] = io.open('sparse.txt') t[k]:read(1) end",
    };
    guard();
    write_sparse_text("sparse.lua", "-- x\n", 200 << 20);
    write_sparse_text("sparse.txt", "x", 1 << 28);
    check_attacks(attacks, sizeof attacks / sizeof *attacks);
    long without = memory_of_nothing();
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        check_line(texts[i], "--script-memory 4 scene.lua", "the script used up its memory of 4 MiB");
        check_memory(texts[i], without, KIB_OF_LIMIT); /* an eighth of what the files above took */
    }
    struct test_result result = test_gray(NULL, "--script-memory 16 sparse.lua");
    CHECK_EQ_INT(result.status, 1);
    CHECK_TEXT(result.err, "sparse.lua: needs more than the 16 MiB of --script-memory\n");
    forget(result);
    check_memory("the scene", without, KIB_OF_LIMIT);
}

/* The result of a call may be far larger than its arguments. */
TEST(arguments_that_need_more_memory_than_allowed_are_one_line) {
    static const char *const texts[] = {
        "local p = {0, 0, 0} local v = {} for i = 1, 4e5 do v[i] = p end gr.mesh{verts=v, faces={{0, 1, 2}}, " MATERIAL
        "}",
        "local f = {} for i = 1, 1000 do f[i] = 0 end local t = {} for i = 1, 10000 do t[i] = f end\n"
        "gr.mesh{verts={{0, 0, 0}}, faces=t, " MATERIAL "}",
        "local p = {0, 0, 0} local v = {} for i = 1, 4e5 do v[i] = p end gr.instances{of=gr.sphere{}, at=v}",
        "local p, v = {0, 0, 0}, {} for i = 1, 3e5 do v[i] = p end pcall(gr.instances, {of=gr.sphere{}, at=v})",
    };
    long without = memory_of_nothing();
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        check_line(texts[i], "-j 2 --script-time 5 --script-memory 16 scene.lua",
                   "the script used up its memory of 16 MiB");
        check_memory(texts[i], without, KIB_OF_LIMIT);
    }
}

/* One after the other: memory of a refused object is freed, memory of a finished one is counted. */
TEST(files_count_together_and_what_is_read_again_counts_once) {
    write_grid("grid.obj", 100);
    write_black_png("small.png", 1000, 600);
    long without = memory_of_nothing();
    struct test_result result =
        test_gray_scene("for k = 1, 200 do gr.texture('small.png') gr.mesh{file='grid.obj', " MATERIAL "} end",
                        "--script-memory 16 scene.lua", NULL);
    CHECK_TEXT(result.err, "scene.lua: no picture was rendered, because the script did not call gr.render\n");
    CHECK_EQ_INT(result.status, 0);
    forget(result);
    check_memory("read again", without, KIB_OF_LIMIT);
    check_line("for k = 1, 200 do gr.mesh{file='grid.obj', smooth=k / 2, " MATERIAL "} end",
               "--script-memory 16 scene.lua", "grid.obj: needs more than the 16 MiB of --script-memory\n");
    check_memory("read in other ways", without, KIB_OF_LIMIT);
}

TEST(assets_of_earlier_scripts_do_not_add_up_without_end) {
    char arguments[2048] = "--script-memory 16 -q", name[64], text[256];
    for (int k = 0; k < 12; k++) {
        (void)snprintf(name, sizeof name, "picture%d.png", k);
        write_black_png(name, 1500, 1300);
        (void)snprintf(text, sizeof text, "gr.texture('picture%d.png')", k);
        (void)snprintf(name, sizeof name, "scene%d.lua", k);
        test_write_text(test_path(name), text);
        (void)strcat(strcat(arguments, " "), name);
    }
    long without = memory_of_nothing();
    struct test_result result = test_gray(NULL, arguments);
    CHECK_TEXT(result.err, "");
    CHECK_EQ_INT(result.status, 0);
    forget(result);
    check_memory("twelve scripts", without, 3 * KIB_OF_LIMIT); /* 160 MiB if all were kept */
}

/* --- what is built for a picture --- */

#define RENDER(more) "gr.render{node=n, file='o.png', width=8, height=8, eye={0, 0, 9}, lights={}" more "}"
#define DOUBLED(times)                                                                                                 \
    "local n = gr.node('leaf') n:add_child(gr.sphere{" MATERIAL "})\n"                                                 \
    "for i = 1, " #times " do local a, b = gr.node('a'), gr.node('b') a:translate(2 ^ i, 0, 0)\n"                      \
    "a:add_child(n) b:add_child(a) b:add_child(n) n = b end\n"
#define MANY(count)                                                                                                    \
    "local s, p, n = gr.sphere{" MATERIAL "}, {}, gr.node('n')\n"                                                      \
    "for i = 1, " #count " do p[i] = {i, 0, 0} end n:add_child(gr.instances{of=s, at=p}) p = nil collectgarbage()\n"

static const char too_much[] = "gr.render: the picture needs too much memory: --script-memory allows ";

/* A tree of nodes with two children each, 2^26 spheres in all. */
TEST(spheres_by_doubling_end_with_one_line_before_memory_is_taken) {
    static const char caught[] = DOUBLED(26) "while true do pcall(function() " RENDER("") " end) end";
    guard();
    long without = memory_of_nothing();
    check_line(DOUBLED(26) RENDER(""), "-j 2 --script-memory 1024 scene.lua", too_much);
    check_line(DOUBLED(26) RENDER(""), "-j 2 --script-memory 1G --check scene.lua", too_much);
    check_line(caught, "-j 2 --script-memory 1G scene.lua", too_much);
    check_memory("2^26 spheres", without, KIB_OF_LIMIT);
}

TEST(a_world_that_needs_more_memory_than_allowed_is_one_line) {
    static const char *const texts[] = {
        DOUBLED(18) RENDER(""),
        DOUBLED(19) RENDER(", accel='none'"),
        DOUBLED(17) RENDER(", accel='kdtree'"),
        DOUBLED(18) RENDER(", accel='grid'"),
        DOUBLED(18) RENDER(", accel='bvh'"),
        /* a map of its own for each */
        "local n, s = gr.node('n'), gr.sphere{" MATERIAL "} local p, t = {}, {}\n"
        "for i = 1, 60000 do p[i], t[i] = {i, 0, 0}, i / 1000 end\n"
        "n:add_child(gr.instances{of=s, at=p, turn=t}) p, t = nil, nil collectgarbage()\n" RENDER(""),
        /* which light shines on which node */
        MANY(
            20000) "local l = {} for i = 1, 1500 do l[i] = gr.light{position={0, 9, 0}, colour={1, 1, 1}, include={s}} "
                   "end\n" RENDER(", lights=l"),
        /* the index of a mesh */
        "local n = gr.node('n') n:add_child(gr.mesh{file='grid.obj', " MATERIAL "})\n" RENDER(", accel='kdtree'"),
        /* a combined solid of many parts */
        "local n, c = gr.node('n'), {} for i = 1, 3000 do c[i] = gr.sphere('s' .. i, {i % 50 / 9, i // 50 / 9, 0}, 1) "
        "end\n"
        "local u = gr.union(c) for k = 1, 40 do local i = gr.node('i' .. k) i:translate(k / 7, 0, 0)\n"
        "i:add_child(gr.difference(u, gr.sphere('t' .. k, {k, 0, 0}, 2))) n:add_child(i) end\n" RENDER(""),
    };
    guard();
    write_grid("grid.obj", 230);
    long without = memory_of_nothing();
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        check_line(texts[i], "-q -j 2 --script-memory 16 scene.lua", too_much);
        check_memory(texts[i], without, KIB_OF_LIMIT * 7 / 4);
    }
}

/* 10 million at the default of 4 GiB, scaled. */
TEST(instances_render_within_a_limit_of_430_bytes_for_each) {
    long without = memory_of_nothing();
    struct test_result result = test_gray_scene(MANY(150000) RENDER(""), "-q -j 2 --script-memory 64M scene.lua", NULL);
    CHECK_TEXT(result.err, "");
    CHECK_EQ_INT(result.status, 0);
    forget(result);
    check_memory("instances", without, 4 * KIB_OF_LIMIT * 7 / 4);
}

TEST_LONG(ten_million_instances_render_at_the_defaults) {
    struct test_result result = test_gray_scene(MANY(10000000) RENDER(""), "-q scene.lua", NULL);
    CHECK_TEXT(result.err, "");
    CHECK_EQ_INT(result.status, 0);
    forget(result);
}

/* Worlds are freed: each of these fits, all together do not. */
TEST(worlds_one_after_the_other_fit_where_one_does) {
    long without = memory_of_nothing();
    struct test_result result = test_gray_scene(MANY(30000) "for k = 1, 12 do " RENDER("") " end",
                                                "-q -j 2 --script-memory 16 scene.lua", NULL);
    CHECK_TEXT(result.err, "");
    CHECK_EQ_INT(result.status, 0);
    forget(result);
    check_memory("twelve worlds", without, KIB_OF_LIMIT * 7 / 4);
}

TEST(photons_that_need_more_memory_than_allowed_are_one_line) {
    static const char text[] =
        "local n = gr.node('n') n:add_child(gr.sphere{material=gr.material{kd={0, 0, 0}, ks={1, 1, 1}, shininess=100,\n"
        "refract=0.9, reflect=0.1, ior=1.5}})\n"
        "n:add_child(gr.cube{corner={-50, -3, -50}, size={100, 1, 100}, " MATERIAL "})\n"
        "local l = gr.light{position={0, 9, 0}, colour={1, 1, 1}, intensity=100}\n" RENDER(
            ", lights={l}, caustics=600000");
    long without = memory_of_nothing();
    check_line(text, "-q -j 2 --script-memory 16 scene.lua", too_much);
    check_memory("photons", without, KIB_OF_LIMIT * 7 / 4);
}

/* --- the picture itself --- */

TEST(a_picture_that_needs_more_memory_than_allowed_is_one_line) {
    static const char format[] =
        "gr.render{node=gr.node('n'), file='o.%s', width=%d, height=%d, eye={0, 0, 9}, lights={}}";
    static const struct {
        const char *extension;
        int width, height;
    } pictures[] = {{"png", 1000, 1000}, {"exr", 1000, 1000}, {"pfm", 40000, 40000}, {"hdr", 1 << 20, 2048}};
    char text[256];
    long without = memory_of_nothing();
    guard();
    for (size_t i = 0; i < sizeof pictures / sizeof *pictures; i++) {
        if (strcmp(pictures[i].extension, "exr") == 0 && !exr_can_write())
            continue;
        (void)snprintf(text, sizeof text, format, pictures[i].extension, pictures[i].width, pictures[i].height);
        check_line(text, "-j 2 --script-memory 16 scene.lua", too_much);
        check_memory(pictures[i].extension, without, KIB_OF_LIMIT);
    }
    /* The sizes in scenes are limited, but the command line may request any size. */
    (void)snprintf(text, sizeof text, format, "png", 640, 480);
    struct test_result small = test_gray_scene(text, "-q -j 2 --script-memory 16 scene.lua", NULL);
    struct test_result large = test_gray_scene(text, "-q -j 2 --script-memory 16 --size 1000x1000 scene.lua", NULL);
    CHECK_TEXT(small.err, "");
    CHECK_TEXT(large.err, "");
    CHECK_EQ_INT(small.status, 0);
    CHECK_EQ_INT(large.status, 0);
    forget(small);
    forget(large);
}

/* --- files of tiles --- */

TEST(files_of_tiles_of_any_size_take_the_memory_of_one_record) {
    static const char text[] =
        "gr.render{node=gr.node('n'), file='o.png', width=8, height=8, eye={0, 0, 9}, lights={}}";
    static const char *const names[] = {"o.png.checkpoint", "o.png.1-of-2.part"};
    static const uint8_t head[16] = {'G', 'R', 'A', 'Y', 'T', 'I', 'L', 'E', TILE_FILE_FORMAT, 0, 0, 0, FILM_TILE};
    guard();
    long without = memory_of_nothing();
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        write_sparse(names[i], head, sizeof head, 1 << 30);
        struct test_result result =
            test_gray_scene(text, i == 0 ? "-q -j 2 --resume scene.lua" : "-q merge o.png.1-of-2.part", NULL);
        CHECK_EQ_INT(result.status, 1);
        CHECK(strstr(result.err, "is damaged") != NULL);
        forget(result);
        check_memory(names[i], without, KIB_OF_LIMIT);
        CHECK(unlink(test_path(names[i])) == 0);
    }
}

/* A huge file instead of a finished picture: it is read in blocks, and the picture is made again. */
TEST(a_file_over_a_finished_picture_takes_no_memory) {
    static const char text[] =
        "gr.render{node=gr.node('n'), file='o.png', width=8, height=8, eye={0, 0, 9}, lights={}}\n"
        "if io.open('again.txt') then gr.render{node=gr.node('n'), file='p.png', width=8, height=8, eye={0, 0, 9}, "
        "lights={}}\n"
        "else gr.render{node=gr.node('n'), file='/nowhere/p.png', width=8, height=8, eye={0, 0, 9}, lights={}} end";
    long without = memory_of_nothing();
    struct test_result result = test_gray_scene(text, "-q --checkpoint c.tiles scene.lua", NULL);
    CHECK_EQ_INT(result.status, 1);
    CHECK(access(test_path("c.tiles"), F_OK) == 0);
    forget(result);
    CHECK(truncate(test_path("o.png"), 300 << 20) == 0);
    result = test_gray_scene(text, "-q --checkpoint c.tiles --resume scene.lua", NULL);
    forget(result);
    check_memory("a finished picture", without, KIB_OF_LIMIT);
    struct stat status;
    CHECK(stat(test_path("o.png"), &status) == 0 && status.st_size < 1 << 20);
}

/* A part that claims 81 million pixels and holds one tile. */
TEST(merge_takes_no_memory_for_tiles_that_no_part_has) {
    enum { SIDE = 9000 };
    static float zeros[FILM_TILE * FILM_TILE * 8];
    struct film film = {0};
    struct tile_picture picture = {.number = 1,
                                   .full_width = SIDE,
                                   .full_height = SIDE,
                                   .width = SIDE,
                                   .record = stage_record(INTEGRATOR_WHITTED),
                                   .height = SIDE,
                                   .shard = 1,
                                   .shards = 1,
                                   .whole = true,
                                   .name = "o.png"};
    struct error error;
    film_layout(&film, zeros, FILM_TILE, FILM_TILE, stage_record(INTEGRATOR_WHITTED));
    film.full_width = film.full_height = SIDE;
    atomic_store(&film.tiles[0], FILM_TILE_DONE);
    CHECK(tile_file_write(FILE_AT(test_path("forged.part")), NULL, 0, &picture, &film, &error));
    /* The film would be a file in memory of 2 GB. */
    struct rlimit limit = {100 << 20, 100 << 20};
    CHECK(setrlimit(RLIMIT_FSIZE, &limit) == 0);
    long without = memory_of_nothing();
    struct test_result result = test_gray(NULL, "-q merge forged.part");
    CHECK_EQ_INT(result.status, 1);
    CHECK(strstr(result.err, "tiles are in no part") != NULL);
    forget(result);
    check_memory("a forged part", without, KIB_OF_LIMIT);
}

/* --- sizes on the command line --- */

static bool option_of(const char *option, const char *text, struct options *options, struct error *error) {
    struct arena arena = {0};
    char *words[] = {(char[]){"gray"}, strdup(option), strdup(text), (char[]){"scene.lua"}};
    bool ok = options_parse(options, 4, words, &arena, error);
    free(words[1]);
    free(words[2]);
    arena_destroy(&arena);
    return ok;
}

TEST(sizes_have_units_and_a_plain_number_is_in_mebibytes) {
    static const struct {
        const char *text;
        uint64_t bytes;
    } sizes[] = {{"1", MEBIBYTE},           {"64", 64 * MEBIBYTE},     {"64M", 64 * MEBIBYTE},
                 {"64m", 64 * MEBIBYTE},    {"64MB", 64 * MEBIBYTE},   {"64MiB", 64 * MEBIBYTE},
                 {"64 mib", 64 * MEBIBYTE}, {"2G", 2 * GIBIBYTE},      {"2g", 2 * GIBIBYTE},
                 {"512K", 512 * KIBIBYTE},  {"512kb", 512 * KIBIBYTE}, {"3T", 3072 * GIBIBYTE},
                 {"1K", KIBIBYTE},          {"007M", 7 * MEBIBYTE},    {"1024T", 1024 * 1024 * GIBIBYTE}};
    static const char *const none[] = {"",
                                       "0",
                                       "0M",
                                       "-1",
                                       "+1",
                                       "M",
                                       "1.5G",
                                       "64Q",
                                       "64 ",
                                       "64M ",
                                       " 64M",
                                       "64Mi",
                                       "64iB",
                                       "64MM",
                                       "0x40",
                                       "1e3",
                                       "1B",
                                       "64M64",
                                       "64  M",
                                       "1025T",
                                       "18446744073709551615T",
                                       "18446744073709551616",
                                       "99999999999999999999G"};
    static const char *const names[] = {"--script-memory", "--script-output", "--picture-bytes"};
    struct options options;
    struct error error;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
            bool ok = option_of(names[i], sizes[k].text, &options, &error);
            uint64_t bytes = i == 0   ? options.script.memory_limit
                             : i == 1 ? options.script.output_limit
                                      : options.picture_bytes;
            if (!ok || bytes != sizes[k].bytes)
                test_fail(__FILE__, __LINE__, "%s %s: %s", names[i], sizes[k].text, ok ? "another size" : error.text);
        }
        for (size_t k = 0; k < sizeof none / sizeof *none; k++) {
            bool ok = option_of(names[i], none[k], &options, &error);
            if (ok || error.kind != ERROR_USAGE || !strstr(error.text, "needs a size from 1K to 1024T"))
                test_fail(__FILE__, __LINE__, "%s '%s': %s", names[i], none[k], ok ? "taken" : error.text);
        }
    }
}

TEST(sizes_in_words_are_whole_and_short) {
    static const struct {
        uint64_t bytes;
        const char *words;
    } sizes[] = {{64 * MEBIBYTE, "64 MiB"},
                 {4096 * MEBIBYTE, "4096 MiB"},
                 {65536 * MEBIBYTE, "64 GiB"},
                 {10241 * MEBIBYTE, "10241 MiB"},
                 {512 * KIBIBYTE, "512 KiB"},
                 {1025 * KIBIBYTE, "1025 KiB"},
                 {1000, "1000 bytes"},
                 {UINT64_MAX, "18446744073709551615 bytes"},
                 {1024 * 1024 * GIBIBYTE, "1024 TiB"}};
    char words[SIZE_WORDS];
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        CHECK_TEXT(size_words(sizes[i].bytes, words), sizes[i].words);
}

/* --- the account --- */

TEST(an_account_counts_what_is_held_and_refuses_what_is_beyond) {
    struct mem_account account = {.limit = 1 << 20, .option = "--x", .words = "x allows no more"};
    struct error error;
    CHECK(mem_charge(&account) == NULL && mem_charged() == &account);
    char *a = mem_alloc(1000), *b = mem_alloc_zero(10, 100), *c = mem_alloc_aligned(64, 1000);
    CHECK(a && b && c && account.held >= 3000 && account.held < 4000);
    CHECK(!mem_alloc(1 << 20) && !mem_alloc_zero(1 << 10, 1 << 10) && !mem_alloc_aligned(64, 1 << 20));
    CHECK(!mem_resize(a, 1 << 20) && !mem_reserve(1 << 20));
    CHECK(!mem_alloc_zero(SIZE_MAX / 2, 4)); /* is not a size */
    CHECK_EQ_INT((long long)mem_refusals(), 5);
    CHECK(!error_no_memory(&error, "a mesh") && error.limit && error.kind == ERROR_SCENE);
    CHECK_TEXT(error.text, "out of memory for a mesh: x allows no more");
    CHECK(!error_of_file(&error, "a.obj", 4));
    CHECK_TEXT(error.text, "a.obj: needs more than the 1 MiB of --x");
    a = mem_resize(a, 500000);
    CHECK(a && account.held > 500000 && mem_reserve(400000) && !mem_alloc(200000));
    mem_unreserve(400000);
    char *d = mem_alloc(200000);
    CHECK(d != NULL);
    a = mem_resize(a, 10);
    mem_free(a), mem_free(b), mem_free(c), mem_free(d), mem_free(NULL);
    CHECK_EQ_INT((long long)account.held, 0);
    a = mem_resize_known(NULL, 5, 100000);
    CHECK(a && account.held >= 100000 && !mem_resize_known(a, 100000, 2 << 20));
    a = mem_resize_known(a, 100000, 50);
    CHECK(a && account.held < 100 && !mem_resize_known(a, 50, SIZE_MAX) && !mem_resize_known(a, 50, 0));
    CHECK_EQ_INT((long long)account.held, 0);
    CHECK(mem_charge(NULL) == &account && mem_refusals() == 0);
    CHECK(!error_no_memory(&error, "a mesh") && !error.limit && error.kind == ERROR_MACHINE);
}

/* Blocks grow up to the limit. */
TEST(an_arena_uses_nearly_all_that_an_account_allows) {
    struct mem_account account = {.limit = 3 << 20, .option = "--x", .words = "x"};
    struct arena arena = {0};
    (void)mem_charge(&account);
    while (arena_alloc(&arena, 1000))
        continue;
    CHECK(arena.total > (size_t)account.limit * 9 / 10);
    arena_destroy(&arena);
    CHECK_EQ_INT((long long)account.held, 0);
    (void)mem_charge(NULL);
}
