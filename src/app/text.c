/* All functions go character by character and write at once, so they need no memory and have no limit. */
#include "app/text.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Length of the well-formed UTF-8 sequence at `at`, or 0 (RFC 3629: no overlong forms, no surrogates, up to U+10FFFF).
 */
static size_t utf8_length(const unsigned char *at) {
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    size_t length = at[0] < 0x80 ? 1 : at[0] >> 5 == 6 ? 2 : at[0] >> 4 == 14 ? 3 : at[0] >> 3 == 30 ? 4 : 0;
    if (length < 2)
        return length;
    uint32_t code = at[0] & (0xffu >> (length + 1));
    for (size_t i = 1; i < length; i++) {
        if ((at[i] & 0xc0) != 0x80)
            return 0;
        code = code << 6 | (at[i] & 0x3fu);
    }
    return code < least[length] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000) ? 0 : length;
}

static bool is_control(const unsigned char *at, size_t length) {
    bool upper = at[0] >= 0x80 && at[0] < 0xa0; /* a lone byte */
    return length < 2 ? (at[0] < 32 && at[0] != '\t') || at[0] == 127 || upper : at[0] == 0xc2 && at[1] < 0xa0;
}

static void print_cleaned(FILE *stream, const char *text, bool continued) {
    for (const unsigned char *at = (const unsigned char *)text; *at;) {
        size_t length = utf8_length(at), whole = length > 0 ? length : 1;
        bool next_line = continued && at[0] == '\n' && at[1] == ' ' && at[2] == ' ';
        if (is_control(at, length) && !next_line)
            (void)fputc('?', stream);
        else
            (void)fwrite(at, 1, whole, stream);
        at += whole;
    }
    (void)fputc('\n', stream);
}

void text_print_line(FILE *stream, const char *text) {
    print_cleaned(stream, text, false);
}

void text_print_lines(FILE *stream, const char *text) {
    print_cleaned(stream, text, true);
}

void text_print_json(FILE *stream, const char *text) {
    const unsigned char *at = (const unsigned char *)text;
    (void)fputc('"', stream);
    while (*at) {
        size_t length = utf8_length(at);
        if (length == 0)
            (void)fputs("\\ufffd", stream);
        else if (*at == '"' || *at == '\\')
            (void)fprintf(stream, "\\%c", *at);
        else if (*at < 32 || *at == 127)
            (void)fprintf(stream, "\\u%04x", *at);
        else
            (void)fwrite(at, 1, length, stream);
        at += length ? length : 1;
    }
    (void)fputc('"', stream);
}
