/* Fonts other than ordinary TrueType: cubic outlines (Type 1), bitmaps (BDF), a compressed font that claims to be huge
 * (WOFF), and letters whose contours have no length. They are made here from their specifications. Sources: Adobe,
 * "Adobe Type 1 Font Format" (1990); Adobe, "Glyph Bitmap Distribution Format"; W3C, "WOFF File Format 1.0"; Apple,
 * "TrueType Reference Manual". */
#include "base/fault.h"
#include "base/mem.h"
#include "formats/font.h"
#include "tests/unit/model_makers.h"

#include <math.h>

#ifdef HAVE_FREETYPE

static bool lay_out(const void *data, size_t size, const char *text, struct arena *arena, struct font_text *out,
                    struct error *error) {
    *error = (struct error){0};
    return font_layout(&(struct font_file){"t.font", data, size}, text, arena, out, error);
}

static void expect_refused(const void *data, size_t size, const char *text, const char *words) {
    struct arena arena = {0};
    struct font_text out;
    struct error error;
    bool read = lay_out(data, size, text, &arena, &out, &error);
    if (read || !strstr(error.text, words))
        test_fail(__FILE__, __LINE__, "%s, not '%s'", read ? "is read" : error.text, words);
    arena_destroy(&arena);
}

/* A number of a charstring (Type 1, 6.2), from -1131 to 1131. */
static void put_number(struct bytes *b, int value) {
    int far = abs(value) - 108;
    if (far < 0)
        bytes_number(b, (uint64_t)(value + 139), 1, true);
    else
        bytes_number(b, (uint64_t)((value > 0 ? 247 : 251) * 256 + far), 2, true);
}

static void put_command(struct bytes *b, int command, int count, const int *numbers) {
    for (int i = 0; i < count; i++)
        put_number(b, numbers[i]);
    bytes_number(b, (uint64_t)command, 1, true);
}

static void put_charstring(struct bytes *b, const char *name, const struct bytes *code) {
    bytes_print(b, "/%s %zu RD ", name, code->size);
    bytes_add(b, code->data, code->size);
    bytes_print(b, " ND\n");
}

/* The letter A: a lens between two cubic arcs, 600 wide and 300 high at its controls. */
static void make_type1(struct bytes *font) {
    enum { HSBW = 13, RMOVETO = 21, RRCURVETO = 8, CLOSEPATH = 9, ENDCHAR = 14 };
    struct bytes private = {0}, nothing = {0}, lens = {0};
    put_command(&nothing, HSBW, 2, (const int[]){0, 500});
    put_command(&nothing, ENDCHAR, 0, NULL);
    put_command(&lens, HSBW, 2, (const int[]){0, 700});
    put_command(&lens, RMOVETO, 2, (const int[]){50, 200});
    put_command(&lens, RRCURVETO, 6, (const int[]){200, 300, 200, 0, 200, -300});
    put_command(&lens, RRCURVETO, 6, (const int[]){-200, -300, -200, 0, -200, 300});
    put_command(&lens, CLOSEPATH, 0, NULL);
    put_command(&lens, ENDCHAR, 0, NULL);
    bytes_print(&private, "\xff\xff\xff\xff dup /Private 8 dict dup begin\n"
                          "/RD {string currentfile exch readstring pop} executeonly def\n/ND {noaccess def} def\n"
                          "/NP {noaccess put} def\n/BlueValues [] def\n/lenIV -1 def\n/password 5839 def\n"
                          "2 index /CharStrings 2 dict dup begin\n");
    put_charstring(&private, ".notdef", &nothing);
    put_charstring(&private, "A", &lens);
    bytes_print(&private, "end\nend\nreadonly put\nnoaccess put\ndup /FontName get exch definefont pop\n"
                          "mark currentfile closefile\n");
    bytes_print(
        font,
        "%%!PS-AdobeFont-1.0: Lens\n/FontName /Lens def\n/FontMatrix [0.001 0 0 0.001 0 0] readonly def\n"
        "/Encoding StandardEncoding def\n/FontBBox {0 -100 700 500} readonly def\n/PaintType 0 def\n/FontType 1 def\n"
        "currentfile eexec\n");
    uint16_t key = 55665; /* Type 1, 7.1 */
    for (size_t i = 0; i < private.size; i++) {
        uint8_t coded = private.data[i] ^ (uint8_t)(key >> 8);
        key = (uint16_t)((coded + key) * 52845u + 22719u);
        bytes_add(font, &coded, 1);
    }
    for (int i = 0; i < 8; i++)
        bytes_print(font, "\n0000000000000000000000000000000000000000000000000000000000000000");
    bytes_print(font, "\ncleartomark\n");
    bytes_free(&private), bytes_free(&nothing), bytes_free(&lens);
}

TEST(fonts_with_cubic_outlines_keep_their_control_points) {
    static const double lens[6][2] = {{0.05, 0.2}, {0.25, 0.5}, {0.45, 0.5}, {0.65, 0.2}, {0.45, -0.1}, {0.25, -0.1}};
    struct bytes font = {0};
    struct arena arena = {0};
    struct font_text text;
    struct error error;
    make_type1(&font);
    bool read = lay_out(font.data, font.size, "A", &arena, &text, &error);
    CHECK_TEXT(error.text, "");
    if (read && text.glyphs[0].contour_count == 1) {
        const struct font_glyph *glyph = &text.glyphs[0];
        CHECK(!glyph->missing);
        CHECK_NEAR(glyph->advance, 0.7, 1e-12);
        CHECK_EQ_INT(glyph->starts[1] - glyph->starts[0], 6);
        /* The contour may begin with any of its points and run in either direction. */
        for (int i = 0; i < 6; i++) {
            double nearest = 1;
            for (int k = 0; k < 6; k++)
                nearest = fmin(nearest, hypot(glyph->points[k][0] - lens[i][0], glyph->points[k][1] - lens[i][1]));
            CHECK_NEAR(nearest, 0, 1e-12);
        }
    } else {
        test_fail(__FILE__, __LINE__, "one contour is wanted");
    }
    arena_destroy(&arena);
    bytes_free(&font);
}

TEST(fonts_with_pictures_of_letters_are_refused) {
    static const char bdf[] =
        "STARTFONT 2.1\nFONT -x-x-medium-r-normal--8-80-75-75-c-80-iso10646-1\nSIZE 8 75 75\nFONTBOUNDINGBOX 8 8 0 0\n"
        "STARTPROPERTIES 2\nFONT_ASCENT 8\nFONT_DESCENT 0\nENDPROPERTIES\nCHARS 1\nSTARTCHAR A\nENCODING 65\n"
        "SWIDTH 500 0\nDWIDTH 8 0\nBBX 8 8 0 0\nBITMAP\nFF\n81\n81\n81\n81\n81\n81\nFF\nENDCHAR\nENDFONT\n";
    expect_refused(bdf, strlen(bdf), "A", "t.font: this font has pictures of its letters, not outlines");
}

/* 72 bytes that claim half a gigabyte: memory for the unpacked font is requested first. */
TEST(fonts_that_need_too_much_memory_are_refused) {
    struct bytes woff = {0};
    const uint32_t unpacked = 0x20000000, packed = 8, total = 44 + 20 + 8;
    bytes_print(&woff, "wOFF");
    bytes_number(&woff, 0x00010000, 4, true);
    bytes_number(&woff, total, 4, true);
    bytes_number(&woff, 1, 2, true);
    bytes_number(&woff, 0, 2, true);
    bytes_number(&woff, 12 + 16 + unpacked, 4, true);
    for (int i = 0; i < 6; i++) /* the version, no metadata, no private block */
        bytes_number(&woff, 0, 4, true);
    bytes_print(&woff, "glyf");
    bytes_number(&woff, 64, 4, true);
    bytes_number(&woff, packed, 4, true);
    bytes_number(&woff, unpacked, 4, true);
    bytes_number(&woff, 0, 4, true);
    bytes_add(&woff, "12345678", 8);
    expect_refused(woff.data, woff.size, "A", "t.font: broken font: it asks for too much memory");
    bytes_free(&woff);
    static const uint8_t one[1];
    expect_refused(one, ((size_t)1 << 30) + 1, "A", "t.font: the file is too large for a font");
}

static uint32_t table_of(const uint8_t *font, const char *tag) {
    for (unsigned i = 0; i < (unsigned)(font[4] << 8 | font[5]); i++) {
        const uint8_t *row = font + 12 + 16 * i;
        if (memcmp(row, tag, 4) == 0)
            return (uint32_t)row[8] << 24 | (uint32_t)row[9] << 16 | (uint32_t)row[10] << 8 | row[11];
    }
    test_fail(__FILE__, __LINE__, "no table %s", tag);
    return 0;
}

/* Our own font with the same letter everywhere: a point, a right triangle with legs of 300, and a point. */
static struct bytes font_of_triangles(void) {
    struct bytes letter = {0}, font = {0};
    font.data = (uint8_t *)test_read_file("data/fonts/gray-round.ttf", &font.size);
    CHECK(font.data != NULL);
    bytes_number(&letter, 3, 2, true);
    for (int i = 0; i < 4; i++)
        bytes_number(&letter, i < 2 ? 0 : 300, 2, true);
    bytes_add(&letter,
              "\0\0\0\3\0\4\0\0"
              "\1\1\1\1\1",
              13); /* the last points, no program, flags: on the curve */
    static const int steps[2][5] = {{10, 0, 300, -300, 50}, {10, 0, 0, 300, 50}};
    for (int axis = 0; axis < 2; axis++)
        for (int i = 0; i < 5; i++)
            bytes_number(&letter, (uint16_t)(steps[axis][i] - (i == 1 ? 10 : 0)), 2, true);
    uint32_t loca = table_of(font.data, "loca"), glyf = table_of(font.data, "glyf"), head = table_of(font.data, "head");
    uint32_t count =
        (uint32_t)font.data[table_of(font.data, "maxp") + 4] << 8 | font.data[table_of(font.data, "maxp") + 5];
    bool wide = font.data[head + 51];
    for (uint32_t i = 0; i < count; i++) {
        uint32_t at[2];
        for (uint32_t k = 0; k < 2; k++) {
            const uint8_t *entry = font.data + loca + (i + k) * (wide ? 4 : 2);
            at[k] = wide ? (uint32_t)entry[0] << 24 | (uint32_t)entry[1] << 16 | (uint32_t)entry[2] << 8 | entry[3]
                         : 2 * ((uint32_t)entry[0] << 8 | entry[1]);
        }
        if (at[1] - at[0] >= letter.size)
            memcpy(font.data + glyf + at[0], letter.data, letter.size);
    }
    bytes_free(&letter);
    return font;
}

TEST(contours_without_length_are_left_out) {
    struct bytes font = font_of_triangles();
    struct arena arena = {0};
    struct font_text text;
    struct error error;
    CHECK(lay_out(font.data, font.size, "B", &arena, &text, &error));
    CHECK_TEXT(error.text, "");
    CHECK_EQ_INT(text.glyphs[0].contour_count, 1);
    CHECK_EQ_INT(text.glyphs[0].starts[0], 0);
    CHECK_EQ_INT(text.glyphs[0].starts[1], 9);
    arena_destroy(&arena);
    expect_refused(font.data, font.size, "B\x7f", "text holds the control character 127 at letter 2");
    expect_refused(font.data, font.size, "B\n", "text holds the control character 10 at letter 2");
#ifdef GRAY_FAULTS
    fault_at(FAULT_OF_CALL, 1);
    expect_refused(font.data, font.size, "B", "t.font: this font has pictures of its letters, not outlines");
    fault_at(FAULT_OF_CALL, 2); /* while the outline is traversed */
    expect_refused(font.data, font.size, "B", "t.font: not a font that can be read");
#endif
    bytes_free(&font);
}

/* All numbers are divided by the units per em. */
TEST(fonts_without_units_are_refused) {
    struct bytes font = font_of_triangles();
    memset(font.data + table_of(font.data, "head") + 18, 0, 2);
    expect_refused(font.data, font.size, "B", "t.font: ");
    bytes_free(&font);
}

#endif
