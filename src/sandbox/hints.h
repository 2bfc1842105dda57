/* Hints about misspelt names in messages. Texts are in the arena of the call, and "" if there is no hint. */
#ifndef GRAY_SANDBOX_HINTS_H
#define GRAY_SANDBOX_HINTS_H

#include <lua.h>
#include <stdbool.h>
#include <stddef.h>

struct sandbox;

/* "; 'redd' is nil, did you mean 'red'?": about the first name in the running call that is an undefined global. */
const char *hint_of_nil(struct sandbox *sandbox);
/* FIELD = VARIABLE, or FIELD = {..., VARIABLE, ...}, with an undefined global. */
struct nil_field {
    const char *field;
    int entry; /* of the list, from 1; 0: the field is the variable */
    const char *words;
};
/* The first one in the running call whose field is among the names; once for each line and function. rest: the field of
 * entries without names, as in FUNCTION{a, b}; NULL: there are none. */
bool hint_find_nil_field(struct sandbox *sandbox, const char *const *names, size_t count, const char *rest,
                         struct nil_field *out);
/* Whether the running call has a colon before the name of this method. */
bool hint_has_colon(struct sandbox *sandbox, const char *method);
/* A hint for a syntax error, for "attempt to call a nil value (field 'x')" and similar errors. Must not raise: it is
 * called while an error is handled. */
const char *hint_of_lua_error(lua_State *L, const char *message);
/* What a file is that Lua cannot compile, and what to do with it: "is a picture; ..."; NULL: it may be a script with an
 * error. */
const char *hint_of_file(struct sandbox *sandbox, const char *path, const void *data, size_t size);
/* After the error of a scene that is not there: "; did you mean ...", of a file that is or one in a list; or what to
 * type instead, as in `gray help`; or "". */
const char *hint_of_missing(struct sandbox *sandbox, const char *path, const char *there, const char *const *files,
                            size_t count);
/* "; did you mean ...; the library has ...": about a dialect that it does not have. */
const char *hint_of_dialect(struct sandbox *sandbox, const char *name);

#endif
