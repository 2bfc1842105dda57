/* Untrusted text for a terminal and for JSON: well-formed UTF-8 is unchanged, byte by byte (RFC 3629); terminal
 * controls and invalid UTF-8 are escaped. */
#include "session/text.h"
#include "tests/harness.h"

#include <stdlib.h>
#include <string.h>

static char *printed(void (*print)(FILE *, const char *), const char *text) {
    char *out = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&out, &size);
    print(stream, text);
    CHECK(fclose(stream) == 0);
    return out;
}

static void print_error(FILE *stream, const char *text) {
    text_print_message(stream, TEXT_ERROR, text);
}

static void expect(void (*print)(FILE *, const char *), const char *text, const char *wanted) {
    char *out = printed(print, text);
    CHECK_TEXT(out, wanted);
    free(out);
}

TEST(well_formed_utf8_of_every_length_stays) {
    static const char *const texts[] = {"plain",        "tab\there",    "\xC3\xA4",         "\xE2\x82\xAC",
                                        "\xED\x9F\xBF", "\xEE\x80\x80", "\xF0\x90\x80\x80", "\xF4\x8F\xBF\xBF",
                                        "\xC2\xA0"};
    char line[64];
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        (void)snprintf(line, sizeof line, "%s\n", texts[i]);
        expect(text_print_line, texts[i], line);
        expect(print_error, texts[i], line);
        expect(text_print, texts[i], texts[i]);
    }
    expect(text_print_json, "\xC3\xA4 \xE2\x82\xAC \xF4\x8F\xBF\xBF", "\"\xC3\xA4 \xE2\x82\xAC \xF4\x8F\xBF\xBF\"");
}

/* Overlong forms, surrogates, beyond U+10FFFF, missing or lone continuation bytes, a truncated text. */
TEST(bytes_that_are_no_utf8_become_one_replacement_each) {
    static const struct {
        const char *text, *json;
    } all[] = {{"\xC0\xAF", "\"\\ufffd\\ufffd\""},
               {"\xE0\x80\xAF", "\"\\ufffd\\ufffd\\ufffd\""},
               {"\xF0\x80\x80\xAF", "\"\\ufffd\\ufffd\\ufffd\\ufffd\""},
               {"\xED\xA0\x80", "\"\\ufffd\\ufffd\\ufffd\""},
               {"\xF4\x90\x80\x80", "\"\\ufffd\\ufffd\\ufffd\\ufffd\""},
               {"\xF8\x88\x80\x80", "\"\\ufffd\\ufffd\\ufffd\\ufffd\""},
               {"\xE2\x82", "\"\\ufffd\\ufffd\""},
               {"\xC3x", "\"\\ufffdx\""},
               {"\x80", "\"\\ufffd\""}};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
        expect(text_print_json, all[i].text, all[i].json);
    /* On a terminal lone bytes that are not controls are unchanged, as in the file names they come from. */
    expect(text_print_line, "\xC3x\xFF", "\xC3x\xFF\n");
}

TEST(nothing_steers_a_terminal) {
    for (int c = 1; c < 256; c++) {
        bool control = (c < 32 && c != '\t') || c == 127 || (c >= 0x80 && c < 0xa0);
        const char text[] = {(char)c, '\0'};
        char wanted[] = {control ? '?' : (char)c, '\n', '\0'};
        expect(text_print_line, text, wanted);
    }
    for (int c = 0x80; c < 0xa0; c++) {
        const char text[] = {'\xC2', (char)c, 'x', '\0'};
        expect(text_print_line, text, "?x\n");
    }
    expect(text_print_line, "a\n  b", "a?  b\n");
    expect(print_error, "a\n  b\nc\n d\n", "a\n  b?c? d?\n");
    expect(text_print, "a\nb\x1b[1m\r", "a\nb?[1m?");
    expect(text_print_json, "a\"\\\n\x7f\x01", "\"a\\\"\\\\\\u000a\\u007f\\u0001\"");
}

static void keep(void *context, const char *text) {
    (void)snprintf(context, 400, "%s", text);
}

TEST(the_conversions_of_a_text_writer_are_words_and_json) {
    char out[400] = "";
    struct text_writer writer = {.put = keep, .context = out};
    text_writer_put(&writer, "%i%s|%n|%q|%u|%d|%g|%v", 2, "a", "b\nc", "d\"\xff", 3000000000U, -7, 1.0 / 3,
                    vec3_make(1, 2.5, -3));
    text_writer_put(&writer, "|%j|%j|%a|%b%b", 0.1, INFINITY, vec3_make(1, NAN, -3), true, false);
    text_writer_flush(&writer);
    CHECK_TEXT(out, "  a|b?c|\"d\\\"\\ufffd\"|3000000000|-7|0.333333|(1, 2.5, -3)"
                    "|0.10000000000000001|null|[1,null,-3]|truefalse");
}
