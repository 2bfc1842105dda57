/* Vectors, and the functions of gr on numbers and vectors. */
#ifndef GRAY_RECORD_VECTOR_H
#define GRAY_RECORD_VECTOR_H

#include <lua.h>
#include <stdbool.h>

/* A function of gr that reads Lua values directly: it has no row in the table, and its arguments and effects are
 * described in text. */
struct value_function {
    const char *name, *parameters, *help;
    const char *result; /* its type in annotations */
    lua_CFunction run;
};
struct value_functions {
    const struct value_function *functions;
    int count;
};
extern const struct value_functions vector_functions;

void vectors_open(lua_State *L); /* adds the metatable */
bool is_vector(lua_State *L, int index);
/* An operator (LUA_OPADD ...) on the components of its arguments, which are vectors, tables or numbers. */
int vector_arithmetic(lua_State *L, int operator);
/* Makes a vector of the three values on top, in their place. */
void push_vector(lua_State *L);

struct image_function;
/* Pushes the colour of a picture, multiplied by alpha, and alpha. Arguments 2 and 3 are u and v; there are no more. */
int push_image_value(lua_State *L, const struct image_function *function);

#endif
