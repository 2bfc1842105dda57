#include "base/json_write.h"

#include "base/terminal_text.h"

#include <lauxlib.h>
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

int json_quote(lua_State *L) {
    size_t length;
    const char *text = luaL_checklstring(L, 1, &length);
    bool is_utf8 = true;
    luaL_Buffer out;
    luaL_buffinit(L, &out);
    luaL_addchar(&out, '"');
    for (size_t i = 0, taken; i < length; i += taken) {
        char piece[JSON_PIECE];
        is_utf8 = is_utf8 && utf8_length((const unsigned char *)text + i) > 0;
        luaL_addlstring(&out, piece, json_piece(text + i, piece, &taken));
    }
    luaL_addchar(&out, '"');
    luaL_pushresult(&out);
    lua_pushboolean(L, is_utf8);
    return 2;
}
