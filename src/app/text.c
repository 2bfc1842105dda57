/* All functions go character by character and write at once, so they need no memory and have no limit. */
#include "app/text.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

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

size_t text_clean_piece(const char *text, char piece[8], size_t *taken) {
    const unsigned char *at = (const unsigned char *)text;
    size_t length = utf8_length(at);
    *taken = length ? length : 1;
    if (is_control(at, length)) {
        piece[0] = '?';
        return 1;
    }
    memcpy(piece, text, *taken);
    return *taken;
}

void text_print(FILE *stream, const char *text) {
    char piece[8];
    for (size_t taken; *text; text += taken) {
        size_t size = text_clean_piece(text, piece, &taken);
        (void)fwrite(*text == '\n' ? text : piece, 1, size, stream);
    }
}

void text_print_line(FILE *stream, const char *text) {
    print_cleaned(stream, text, false);
}

void text_print_lines(FILE *stream, const char *text) {
    print_cleaned(stream, text, true);
}

size_t text_json_piece(const char *text, char piece[8], size_t *taken) {
    const unsigned char *at = (const unsigned char *)text;
    size_t length = utf8_length(at);
    *taken = length ? length : 1;
    if (length == 0)
        return (size_t)snprintf(piece, 8, "\\ufffd");
    if (*at == '"' || *at == '\\')
        return (size_t)snprintf(piece, 8, "\\%c", *at);
    if (*at < 32 || *at == 127)
        return (size_t)snprintf(piece, 8, "\\u%04x", *at);
    memcpy(piece, at, length);
    return length;
}

void text_print_json(FILE *stream, const char *text) {
    char piece[8];
    (void)fputc('"', stream);
    for (size_t taken; *text; text += taken) {
        size_t size = text_json_piece(text, piece, &taken);
        (void)fwrite(piece, 1, size, stream);
    }
    (void)fputc('"', stream);
}

void text_time(double seconds, char *out, size_t size) {
    unsigned long whole = seconds < 1e9 ? (unsigned long)(seconds + 0.5) : 1000000000;
    if (whole < 60)
        (void)snprintf(out, size, "%lu s", whole);
    else if (whole < 3600)
        (void)snprintf(out, size, "%lu min %lu s", whole / 60, whole % 60);
    else
        (void)snprintf(out, size, "%lu h %lu min", whole / 3600, whole / 60 % 60);
}
