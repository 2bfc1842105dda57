/* Both functions go byte by byte and write at once, so they need no memory and have no limit. */
#include "app/text.h"

#include <stddef.h>
#include <stdint.h>

void text_print_line(FILE *stream, const char *text) {
    for (const char *at = text; *at; at++) {
        unsigned char c = (unsigned char)*at;
        (void)fputc((c < 32 && c != '\n' && c != '\t') || c == 127 ? '?' : c, stream);
    }
    (void)fputc('\n', stream);
}

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
