#include "base/json_write.h"

#include "base/terminal_text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void json_number(char out[JSON_NUMBER], double number) {
    for (int digits = 15; digits <= 17; digits++) {
        (void)snprintf(out, JSON_NUMBER, "%.*g", digits, number);
        if (strtod(out, NULL) == number)
            break;
    }
}

size_t json_piece(const char *text, char piece[JSON_PIECE], size_t *taken) {
    const unsigned char *at = (const unsigned char *)text;
    size_t length = utf8_length(at);
    enum character_class class = character_class_of(at);
    *taken = length ? length : 1;
    if (length == 0)
        return (size_t)snprintf(piece, JSON_PIECE, "\\ufffd");
    if (*at == '"' || *at == '\\')
        return (size_t)snprintf(piece, JSON_PIECE, "\\%c", *at);
    if (*at < ' ' || (class != CHARACTER_SHOWN && class != CHARACTER_INVISIBLE))
        return (size_t)snprintf(piece, JSON_PIECE, "\\u%04x", (unsigned)utf8_code(at, length) & 0xffff);
    memcpy(piece, at, length);
    return length;
}
