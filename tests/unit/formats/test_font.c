#include "base/mem.h"
#include "formats/font.h"
#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char font_path[] = "data/fonts/gray-round.ttf";

#ifndef HAVE_FREETYPE

TEST(fonts_without_their_library_are_one_line) {
    struct arena arena = {0};
    struct font_text text;
    struct error error = {0};
    CHECK(!font_layout(&(struct font_file){font_path, NULL, 0}, "a", &arena, &text, &error));
    CHECK_TEXT(error.text, "data/fonts/gray-round.ttf: this build cannot read fonts (it was made without FreeType)");
    CHECK_TEXT(font_library(), "none");
    test_lacks("gray was built without FreeType");
}

#else

struct font {
    uint8_t *data;
    size_t size;
};

static struct font read_font(void) {
    struct font font = {0};
    font.data = (uint8_t *)test_read_file(font_path, &font.size);
    CHECK(font.data != NULL);
    return font;
}

/* From a copy of exactly this size, so that the sanitizer detects every read outside it. */
static bool lay_out(const uint8_t *data, size_t size, const char *text, struct arena *arena, struct font_text *out,
                    struct error *error) {
    uint8_t *copy = malloc(size ? size : 1);
    if (size)
        memcpy(copy, data, size);
    *error = (struct error){0};
    bool done = font_layout(&(struct font_file){"t.ttf", copy, size}, text, arena, out, error);
    free(copy);
    return done;
}

/* Every number is finite, every contour has complete pieces, every letter is in order. */
static void check_text(const struct font_text *text) {
    for (uint32_t k = 0; k < text->count; k++) {
        const struct font_glyph *glyph = &text->glyphs[k];
        CHECK(isfinite(glyph->x) && isfinite(glyph->advance));
        for (uint32_t c = 0; c < glyph->contour_count; c++) {
            uint32_t count = glyph->starts[c + 1] - glyph->starts[c];
            CHECK(count > 0 && count % 3 == 0);
            for (uint32_t p = glyph->starts[c]; p < glyph->starts[c + 1]; p++)
                CHECK(isfinite(glyph->points[p][0]) && isfinite(glyph->points[p][1]));
        }
    }
}

/* Area inside cubic pieces by Green's theorem, each a closed form: the integral of x dy - y dx over a piece. */
static double area_of(const struct font_glyph *glyph) {
    double twice = 0;
    for (uint32_t c = 0; c < glyph->contour_count; c++) {
        uint32_t first = glyph->starts[c], count = glyph->starts[c + 1] - first;
        for (uint32_t k = 0; k < count; k += 3) {
            const double *p[4];
            for (uint32_t j = 0; j < 4; j++)
                p[j] = glyph->points[first + (k + j) % count];
            static const double weights[4][4] = {{0, 6, 3, 1}, {-6, 0, 3, 3}, {-3, -3, 0, 6}, {-1, -3, -6, 0}};
            for (int i = 0; i < 4; i++)
                for (int j = 0; j < 4; j++)
                    twice += weights[i][j] * p[i][0] * p[j][1] / 10;
        }
    }
    return twice / 2;
}

TEST(font_letters_have_the_areas_of_the_pen_that_drew_them) {
    struct arena arena = {0};
    struct font font = read_font();
    struct font_text text;
    struct error error;
    CHECK(lay_out(font.data, font.size, "Io-", &arena, &text, &error));
    CHECK_TEXT(error.text, "");
    CHECK_EQ_INT(text.count, 3);
    check_text(&text);
    /* A stroke 0.105 em wide and 0.7 em long, with round ends. */
    double pen = 0.9 * 0.7 / 6, pi = 3.14159265358979;
    CHECK_NEAR(fabs(area_of(&text.glyphs[0])), 0.7 * pen + pi * pen * pen / 4, 2e-4);
    CHECK_NEAR(fabs(area_of(&text.glyphs[2])), 1.8 * 0.7 / 6 * pen + pi * pen * pen / 4, 2e-4);
    CHECK_EQ_INT(text.glyphs[0].contour_count, 1);
    CHECK_EQ_INT(text.glyphs[1].contour_count, 2);
    CHECK_NEAR(text.width, text.glyphs[2].x + text.glyphs[2].advance, 1e-12);
    CHECK(text.ascender > 0.7 && text.descender < -0.2 && text.line > 1);
    arena_destroy(&arena);
    free(font.data);
}

TEST(font_kerning_and_missing_letters_are_reported) {
    struct arena arena = {0};
    struct font font = read_font();
    struct font_text pair, single;
    struct error error;
    CHECK(lay_out(font.data, font.size, "AV", &arena, &pair, &error));
    CHECK(lay_out(font.data, font.size, "A", &arena, &single, &error));
    CHECK_NEAR(pair.glyphs[1].x, single.width - 0.08, 1e-12);
    CHECK(lay_out(font.data, font.size, "A\xcf\x88\xf0\x9f\x98\x80 \xc3\xa9", &arena, &pair, &error));
    CHECK_EQ_INT(pair.count, 5);
    CHECK(!pair.glyphs[0].missing && pair.glyphs[1].missing && pair.glyphs[2].missing && !pair.glyphs[4].missing);
    CHECK_EQ_INT(pair.glyphs[1].code, 0x3c8);
    CHECK_EQ_INT(pair.glyphs[2].code, 0x1f600);
    CHECK_EQ_INT(pair.glyphs[3].contour_count, 0);
    CHECK_EQ_INT(pair.glyphs[4].code, 0xe9);
    arena_destroy(&arena);
    free(font.data);
}

TEST(font_texts_that_are_no_utf8_are_errors) {
    static const char *const wrong[] = {
        "\x80", "A\xc3", "\xc0\xaf", "\xe0\x80\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xf8\x88\x80\x80", "a\nb"};
    struct arena arena = {0};
    struct font font = read_font();
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        struct font_text text;
        struct error error;
        CHECK(!lay_out(font.data, font.size, wrong[k], &arena, &text, &error));
        CHECK_EQ_INT(error.kind, ERROR_SCENE);
        CHECK(strstr(error.text, "text ") == error.text);
    }
    char *long_text = malloc(FONT_TEXT_LIMIT + 2);
    memset(long_text, ' ', FONT_TEXT_LIMIT + 1);
    long_text[FONT_TEXT_LIMIT + 1] = '\0';
    struct font_text text;
    struct error error;
    CHECK(!lay_out(font.data, font.size, long_text, &arena, &text, &error));
    CHECK_TEXT(error.text, "text is longer than 100000 letters");
    free(long_text);
    arena_destroy(&arena);
    free(font.data);
}

/* A text or one line that names the file. */
static void expect_answer(const uint8_t *data, size_t size) {
    struct arena arena = {0};
    struct font_text text;
    struct error error;
    if (lay_out(data, size, "Ago:&\xc3\xa9", &arena, &text, &error))
        check_text(&text);
    else if (error.kind == ERROR_NONE || strncmp(error.text, "t.ttf: ", 7) != 0 || strchr(error.text, '\n'))
        test_fail(__FILE__, __LINE__, "%zu bytes: \"%s\"", size, error.text);
    arena_destroy(&arena);
}

TEST(font_cut_anywhere_or_with_any_changed_byte_is_text_or_one_line) {
    struct font font = read_font();
    uint32_t random = 1;
    for (size_t size = 0; size < font.size; size += 1 + size / 40)
        expect_answer(font.data, size);
    for (int round = 0; round < 3000; round++) {
        random = random * 1664525u + 1013904223u;
        /* Half of them in the tables at the front, which contain all offsets. */
        size_t at = (random >> 8) % (round % 2 ? font.size : 700);
        uint8_t old = font.data[at];
        random = random * 1664525u + 1013904223u;
        font.data[at] = (uint8_t)(round % 3 == 0 ? 0xff : round % 3 == 1 ? 0x7f : random >> 24);
        expect_answer(font.data, font.size);
        font.data[at] = old;
    }
    free(font.data);
}

TEST(font_survives_failed_allocations) {
    struct font font = read_font();
    struct arena arena = {0};
    struct font_text text;
    struct error error;
    uint64_t before = mem_allocations();
    CHECK(lay_out(font.data, font.size, "Ag", &arena, &text, &error));
    uint64_t count = mem_allocations() - before;
    arena_destroy(&arena);
    for (uint64_t k = 1; k <= count; k++) {
        mem_fail_at(k);
        bool done = lay_out(font.data, font.size, "Ag", &arena, &text, &error);
        mem_fail_at(0);
        CHECK(done || error.kind == ERROR_MACHINE);
        arena_destroy(&arena);
    }
    free(font.data);
}

#endif
