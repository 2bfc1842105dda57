/* Grids from files: every type and encoding gives the same values, and a file that does not fit is one line. */
#include "tests/harness.h"

#include "formats/voxels.h"

#include <stdio.h>
#include <string.h>

static const char head[] = "NRRD0004\n# comment\ntype: %s\ndimension: 3\nsizes: 2 1 3\nkey:=value\nendian: little\n"
                           "encoding: raw\n\n";

/* The voxels 0 to 5 in a type. */
static size_t make_file(const char *type, size_t bytes, uint8_t out[512]) {
    size_t size = (size_t)snprintf((char *)out, 512, head, type);
    for (int i = 0; i < 6; i++) {
        const float f = (float)i;
        const double d = i;
        const uint16_t n = (uint16_t)i;
        memcpy(out + size, bytes == 8 ? (const void *)&d : bytes == 4 ? (const void *)&f : (const void *)&n, bytes);
        size += bytes;
    }
    return size;
}

TEST(nrrd_files_of_every_type_give_their_values) {
    static const struct {
        const char *type;
        size_t bytes;
    } types[] = {{"float", 4}, {"double", 8},         {"uint8", 1}, {"uchar", 1},
                 {"int16", 2}, {"unsigned short", 2}, {"short", 2}, {"Unsigned Char", 1}};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        uint8_t bytes[512];
        struct arena arena = {0};
        struct error error = {0};
        struct voxels voxels = {.values = NULL};
        size_t size = make_file(types[i].type, types[i].bytes, bytes);
        if (!voxels_parse_nrrd("a.nrrd", bytes, size, &arena, &voxels, &error)) {
            test_fail(__FILE__, __LINE__, "%s: %s", types[i].type, error.text);
            continue;
        }
        CHECK(voxels.count[0] == 2 && voxels.count[1] == 1 && voxels.count[2] == 3);
        for (int k = 0; k < 6; k++)
            CHECK_NEAR((double)voxels.values[k], k, 0);
        arena_destroy(&arena);
    }
}

static void expect(const char *text, const char *message) {
    struct arena arena = {0};
    struct error error = {0};
    struct voxels voxels;
    CHECK(!voxels_parse_nrrd("a.nrrd", (const uint8_t *)text, strlen(text), &arena, &voxels, &error));
    CHECK_TEXT(error.text, message);
    arena_destroy(&arena);
}

#define START "NRRD0005\ntype: uint8\ndimension: 3\n"

TEST(what_is_wrong_with_an_nrrd_file_is_one_line) {
    expect("P6 3 3", "a.nrrd is no NRRD file");
    expect("NRRD0004\ntype: block\n\n",
           "a.nrrd: values of type 'block' are not supported (float, double, uint8, int16, uint16)");
    expect("NRRD0004\ndimension: 4\n\n", "a.nrrd: dimension is 4; a grid of single numbers has 3");
    expect("NRRD0004\nendian: big\n\n", "a.nrrd: endian is 'big'; only little is supported");
    expect(START "encoding: ascii\n\n", "a.nrrd: encoding is 'ascii'; raw and gzip are supported");
    expect(START "data file: a.raw\n\n",
           "a.nrrd: the field 'data file' is not supported; the data must follow the header");
    expect(START "encoding: raw\n\n", "a.nrrd: the field 'sizes' is missing in the header");
    expect(START "sizes: 1 1 9999\n\n", "a.nrrd: 9999 voxels along an axis; 1 to 4096 are possible");
    expect(START "sizes: 1 1\n\n", "a.nrrd: sizes must be three numbers, not '1 1'");
    expect(START "encoding: raw\nsizes: 2 2 1\n\nabc",
           "a.nrrd: 2 x 2 x 1 voxels of 1 bytes are 4 bytes, but there are 3");
    expect(START "encoding: gzip\nsizes: 2 2 1\n\nabc", "a.nrrd: the gzip data are broken or end after 0 of 4 bytes");
    expect(START "encoding: gzip\nsizes: 4096 4096 4096\n\nabc",
           "a.nrrd: 3 bytes of gzip data cannot hold 68719476736 bytes");
    expect(START "sizes: 1 1 1\nencoding: raw", "a.nrrd: the header has no end: an empty line is missing");
}
