/* Numbers and strings as JSON has them. */
#ifndef GRAY_BASE_JSON_WRITE_H
#define GRAY_BASE_JSON_WRITE_H

#include <lua.h>
#include <stddef.h>

enum { JSON_NUMBER = 32, JSON_PIECE = 8 };

/* The shortest decimal number of 15 to 17 digits that reads back equal; of a finite number. */
void json_number(char out[JSON_NUMBER], double number);
/* Inside of the quotes: the bytes for the next *taken bytes of a text with NUL at its end; returns how many. A byte that
 * is no UTF-8 becomes U+FFFD. */
size_t json_piece(const char *text, char piece[JSON_PIECE], size_t *taken);

/* For Lua: the text in quotes, and whether it is UTF-8 as a whole. */
int json_quote(lua_State *L);

#endif
