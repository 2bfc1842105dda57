/* Source positions, warnings and errors of a running script. The position is that of the nearest Lua function on the
 * stack with a known line, so that gr functions called through pcall or other C functions still name the script's line.
 */
#include "script/context_internal.h"

#include "base/hash.h"

#include <assert.h>
#include <lauxlib.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

struct script_context *context_of(lua_State *L) {
    return *(struct script_context **)lua_getextraspace(L);
}

/* The nearest Lua function on the stack with a known line. */
static bool find_frame(lua_State *L, lua_Debug *frame) {
    for (int level = 0; lua_getstack(L, level, frame); level++) {
        lua_getinfo(L, "l", frame);
        if (frame->currentline > 0 && lua_getinfo(L, "S", frame))
            return true;
    }
    return false;
}

static const char *frame_file(const lua_Debug *frame) {
    return frame->source[0] == '@' ? frame->source + 1 : frame->short_src;
}

void context_where(const struct script_context *context, char *out, size_t size) {
    lua_Debug frame;
    if (find_frame(context->lua, &frame))
        snprintf(out, size, "%s:%d: ", frame_file(&frame), frame.currentline);
    else
        snprintf(out, size, "%s: ", context->path);
}

void context_note_line(struct script_context *context) {
    lua_Debug frame;
    context->scene.line = 0;
    if (!find_frame(context->lua, &frame))
        return;
    if (frame.source != context->line_source) { /* otherwise the file is that of the node before */
        context->line_source = frame.source;
        context->scene.file = scene_keep_text(&context->scene, frame_file(&frame));
    }
    context->scene.line = context->scene.file ? (uint32_t)frame.currentline : 0;
}

bool context_is_new_line(struct script_context *context) {
    lua_Debug frame;
    if (!find_frame(context->lua, &frame))
        return true;
    const struct script_line line = {frame.source, frame.currentline};
    uint64_t hash = hash_bytes(&line.source, sizeof line.source, (uint64_t)line.number);
    struct script_line *slot = &context->checked_lines[hash % CHECKED_LINES];
    bool is_new = slot->source != line.source || slot->number != line.number;
    *slot = line;
    return is_new;
}

const char *function_title(const struct script_function *function, char out[96]) {
    snprintf(out, 96, "%s%s", function->owner == OWNER_GR ? "gr." : "node:", function->name);
    return out;
}

/* Names may contain line ends. */
void context_compose(const struct script_context *context, const char *text, char *out, size_t size) {
    char title[96] = "";
    if (context->function)
        function_title(context->function, title);
    size_t used = (size_t)snprintf(out, size, "%s%s%s", title, context->function ? ": " : "", text);
    assert(used < size); /* large enough for a title and the longest text */
    if (context->subject)
        snprintf(out + used, size - used, " (node '%.200s')", context->subject);
    for (char *end = out; (end = strpbrk(end, "\n\r"));)
        *end = '?';
}

static void warn(struct script_context *context, const char *format, va_list arguments) {
    char text[1024], where[PATH_SIZE + 32], line[1536], message[PATH_SIZE + 2048];
    vsnprintf(text, sizeof text, format, arguments);
    context_compose(context, text, line, sizeof line);
    context_where(context, where, sizeof where);
    snprintf(message, sizeof message, "%swarning: %s", where, line);
    limits_count_output(context, strlen(message));
    context->host->message(context->host->context, SCRIPT_WARNING, message);
}

void context_warn(struct script_context *context, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    warn(context, format, arguments);
    va_end(arguments);
}

void context_warn_once(struct script_context *context, unsigned bit, const char *format, ...) {
    uint8_t *bits = &context->warned[function_index(context->function)];
    if (*bits & bit)
        return;
    *bits = (uint8_t)(*bits | bit);
    va_list arguments;
    va_start(arguments, format);
    warn(context, format, arguments);
    va_end(arguments);
}

/* {200, 50, 50}: bytes, where numbers from 0 to 1 are meant. */
void context_warn_of_bytes(struct script_context *context, const char *name, struct vec3 c) {
    bool whole = c.x == floor(c.x) && c.y == floor(c.y) && c.z == floor(c.z);
    double max = vec3_max_abs(c);
    if (whole && max > 10 && max <= 255 && c.x >= 0 && c.y >= 0 && c.z >= 0)
        context_warn_once(context, WARNED_BYTES,
                          "%s {%g, %g, %g} looks like bytes; colours are numbers from 0 to 1, as {%.3g, %.3g, %.3g}",
                          name, c.x, c.y, c.z, c.x / 255, c.y / 255, c.z / 255);
}

_Noreturn static void raise_text(struct script_context *context, const char *text) {
    char where[PATH_SIZE + 32];
    context_where(context, where, sizeof where);
    snprintf(context->raised, sizeof context->raised, "%s", text);
    lua_pushfstring(context->lua, "%s%s", where, text);
    lua_error(context->lua);
    __builtin_unreachable();
}

void context_raise(struct script_context *context, const char *format, ...) {
    char text[1024], line[1536];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    context_compose(context, text, line, sizeof line);
    raise_text(context, line);
}

/* The value has no meaning: C functions that a script has stored in __close are called with it. */
void context_raise_fatal(lua_State *L) {
    lua_pushnil(L);
    lua_error(L);
    __builtin_unreachable();
}

void context_raise_error(struct script_context *context, const struct error *error) {
    context->unforgivable = error->refused;
    if (error->kind == ERROR_SCENE && !error->elsewhere && !error->limit)
        context_raise(context, "%s", error->text);
    context->fatal = *error;
    if (error->limit) {
        char where[PATH_SIZE + 32], line[1536];
        context_compose(context, error->text, line, sizeof line);
        context_where(context, where, sizeof where);
        (void)error_set_limit(&context->fatal, "%s%s", where, line);
    }
    context_raise_fatal(context->lua);
}

void context_raise_no_memory(struct script_context *context) {
    struct error error;
    error_no_memory(&error, context->function->name);
    context_raise_error(context, &error);
}

/* Handles: the Lua values for nodes, materials, lights and textures. A handle is a userdata with a tag and a pointer
 * into the scene's arena, without finalizer: the scene outlives the Lua state. A ghost is the handle of an object that
 * this version does not support; it exists with --lenient only and is accepted everywhere (lenient_internal.h). */

#define HANDLE_NAME(type, name, words) [type] = (name),
#define HANDLE_WORDS(type, name, words) [type] = (words),
static const char *const type_names[] = {HANDLE_LIST(HANDLE_NAME)};

const char *handle_words(enum handle_type type) {
    static const char *const words[] = {HANDLE_LIST(HANDLE_WORDS)};
    return words[type];
}

const void *handle_key(enum handle_type type) {
    return type_names[type];
}

void handle_push(lua_State *L, enum handle_type type, void *pointer) {
    struct script_context *context = context_of(L);
    struct handle *handle = lua_newuserdatauv(L, sizeof *handle, 0);
    *handle = (struct handle){.type = type, .serial = context->handle_count++, .pointer = pointer};
    lua_rawgetp(L, LUA_REGISTRYINDEX, type_names[type]);
    lua_setmetatable(L, -2);
    if (context->lists_handles)
        frames_list_handle(L, handle->serial);
}

const struct handle *handle_at(lua_State *L, int index) {
    const struct handle *handle = lua_touserdata(L, index);
    if (!handle)
        return NULL;
    /* Scripts get no light userdata, and all other userdata have metatables. */
    bool has_metatable = lua_getmetatable(L, index);
    assert(has_metatable);
    (void)has_metatable;
    const void *metatable = lua_topointer(L, -1);
    lua_pop(L, 1);
    const struct script_context *context = context_of(L);
    for (int type = 0; type < HANDLE_TYPES; type++)
        if (context->metatables[type] == metatable)
            return handle;
    return NULL;
}

const char *value_words(lua_State *L, int index) {
    const struct handle *handle = handle_at(L, index);
    if (handle)
        return handle_words(handle->type);
    switch (lua_type(L, index)) {
    case LUA_TNIL:
        return "nil";
    case LUA_TNONE:
        return "nothing";
    case LUA_TBOOLEAN:
        return "a boolean";
    case LUA_TNUMBER:
        return "a number";
    case LUA_TSTRING:
        return "a string";
    case LUA_TTABLE:
        return "a table";
    case LUA_TFUNCTION:
        return "a function";
    case LUA_TTHREAD:
        return "a coroutine";
    default:
        return "a userdata";
    }
}

/* The argument types that a value can have, judged by its Lua type alone: bits. Strings that are numbers are both, a
 * ghost is any handle.
 */
enum {
    LIKE_NUMBER = 1 << HANDLE_TYPES,
    LIKE_BOOLEAN = LIKE_NUMBER << 1,
    LIKE_TEXT = LIKE_NUMBER << 2,
    LIKE_TABLE = LIKE_NUMBER << 3,
    LIKE_FUNCTION = LIKE_NUMBER << 4,
    LIKE_HANDLE = LIKE_NUMBER - 1, /* bit `type` for each type of handle */
};

static int kinds_of(lua_State *L, int index) {
    const struct handle *handle = handle_at(L, index);
    if (handle)
        return handle->type == HANDLE_GHOST ? LIKE_HANDLE : 1 << handle->type;
    return (lua_isnumber(L, index) ? LIKE_NUMBER : 0) | (lua_isboolean(L, index) ? LIKE_BOOLEAN : 0) |
           (lua_isstring(L, index) ? LIKE_TEXT : 0) | (lua_istable(L, index) ? LIKE_TABLE : 0) |
           (lua_isfunction(L, index) ? LIKE_FUNCTION : 0);
}

bool argument_resembles(lua_State *L, int index, enum kind kind, unsigned flags) {
    static const int wanted[KIND_COUNT] = {
        [KIND_NUMBER] = LIKE_NUMBER,
        [KIND_WHOLE] = LIKE_NUMBER,
        [KIND_BOOLEAN] = LIKE_BOOLEAN,
        [KIND_TEXT] = LIKE_TEXT,
        [KIND_FILE] = LIKE_TEXT,
        [KIND_OUTPUT] = LIKE_TEXT,
        [KIND_CHOICE] = LIKE_TEXT,
        [KIND_AXIS] = LIKE_TEXT,
        [KIND_POINT] = LIKE_TABLE,
        [KIND_DIRECTION] = LIKE_TABLE,
        [KIND_COLOUR] = LIKE_TABLE | LIKE_TEXT,
        [KIND_TRIPLE] = LIKE_TABLE,
        [KIND_SIZE] = LIKE_TABLE | LIKE_NUMBER,
        [KIND_INTERVAL] = LIKE_TABLE,
        [KIND_QUATERNION] = LIKE_TABLE,
        [KIND_PAIR] = LIKE_TABLE | LIKE_NUMBER,
        [KIND_NODE] = 1 << HANDLE_NODE,
        [KIND_MATERIAL] = 1 << HANDLE_MATERIAL,
        [KIND_MATERIALS] = LIKE_TABLE,
        [KIND_IMAGE] = LIKE_TEXT | 1 << HANDLE_TEXTURE,
        [KIND_BACKGROUND] = LIKE_TABLE | LIKE_TEXT | LIKE_FUNCTION | 1 << HANDLE_SKY,
        [KIND_FOG] = 1 << HANDLE_FOG,
        [KIND_CAUSTICS] = LIKE_TABLE | LIKE_NUMBER,
        [KIND_NODES] = LIKE_TABLE,
        [KIND_LIGHTS] = LIKE_TABLE,
        [KIND_POINTS] = LIKE_TABLE,
        [KIND_PAIRS] = LIKE_TABLE,
        [KIND_STOPS] = LIKE_TABLE,
        [KIND_FACES] = LIKE_TABLE,
        [KIND_NUMBERS] = LIKE_TABLE | LIKE_NUMBER,
        [KIND_ROWS] = LIKE_TABLE,
        [KIND_CURVES] = LIKE_TABLE,
        [KIND_FUNCTION] = LIKE_FUNCTION | 1 << HANDLE_TEXTURE,
        [KIND_CALLBACK] = LIKE_FUNCTION,
    };
    assert(wanted[kind]); /* every kind has a case */
    int accepted = wanted[kind] |
                   (flags & (OR_TEXTURE | OR_PROFILE | OR_FUNCTION) ? 1 << HANDLE_TEXTURE | LIKE_FUNCTION : 0) |
                   (flags & OR_CURVE ? LIKE_FUNCTION : 0);
    return (kinds_of(L, index) & accepted) != 0;
}

/* tostring(handle): without an address, so that a script always prints the same. */
static int handle_text(lua_State *L) {
    const struct handle *handle = handle_at(L, 1);
    assert(handle); /* scripts cannot reach the metatable */
    if (handle->type == HANDLE_NODE)
        lua_pushfstring(L, "node '%s'", ((const struct node *)handle->pointer)->name);
    else
        lua_pushstring(L, type_names[handle->type]);
    return 1;
}

void handles_open(lua_State *L) {
    struct script_context *context = context_of(L);
    for (int type = 0; type < HANDLE_TYPES; type++) {
        lua_createtable(L, 0, 4);
        lua_pushstring(L, type_names[type]);
        lua_setfield(L, -2, "__name");
        lua_pushstring(L, type_names[type]); /* the result of getmetatable; setmetatable is refused */
        lua_setfield(L, -2, "__metatable");
        lua_pushcfunction(L, handle_text);
        lua_setfield(L, -2, "__tostring");
        context->metatables[type] = lua_topointer(L, -1);
        lua_rawsetp(L, LUA_REGISTRYINDEX, type_names[type]);
    }
}

/* "Did you mean": the optimal string alignment form of the Damerau-Levenshtein distance (insert, delete, replace, swap
 * of neighbours), letters compared without case. A suggestion is made when at most a third of the word, and at least
 * one letter, has to change. Words longer than WORD_LIMIT are ignored. */

enum { WORD_LIMIT = 40 };

static int lower(char c) {
    return c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c;
}

static size_t smaller(size_t a, size_t b) {
    return a < b ? a : b;
}

static size_t distance(const char *a, size_t a_length, const char *b, size_t b_length) {
    size_t rows[3][WORD_LIMIT + 1]; /* of the matrix: row i is rows[i % 3] */
    for (size_t j = 0; j <= b_length; j++)
        rows[0][j] = j;
    for (size_t i = 1; i <= a_length; i++) {
        size_t *row = rows[i % 3], *above = rows[(i + 2) % 3], *above2 = rows[(i + 1) % 3];
        row[0] = i;
        for (size_t j = 1; j <= b_length; j++) {
            size_t cost = lower(a[i - 1]) != lower(b[j - 1]);
            row[j] = smaller(smaller(above[j] + 1, row[j - 1] + 1), above[j - 1] + cost);
            bool swapped = i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
            if (swapped)
                row[j] = smaller(row[j], above2[j - 2] + 1);
        }
    }
    return rows[a_length % 3][b_length];
}

void suggest_begin(struct suggestion *suggestion, const char *word) {
    size_t third = strlen(word) / 3;
    *suggestion = (struct suggestion){.word = word, .distance = (third > 0 ? third : 1) + 1};
}

void suggest_offer(struct suggestion *suggestion, const char *candidate) {
    size_t a_length = strlen(suggestion->word), b_length = strlen(candidate);
    if (a_length > WORD_LIMIT || b_length > WORD_LIMIT)
        return;
    size_t d = distance(suggestion->word, a_length, candidate, b_length);
    if (d < suggestion->distance) { /* the first of equally near words is kept, so the result depends only on the order
                                       of the candidates */
        suggestion->distance = d;
        suggestion->best = candidate;
    }
}

const struct script_parameter *function_rest(const struct script_function *function, int *index) {
    for (*index = 0; *index < function->parameter_count; (*index)++)
        if (function->parameters[*index].flags & REST)
            return &function->parameters[*index];
    return NULL;
}

void context_check_fields(struct script_context *c, const struct script_function *function, int table) {
    lua_State *L = c->lua;
    const char *unknown = NULL;
    int skip = function->owner == OWNER_NODE; /* `self` is no field */
    for (lua_pushnil(L); lua_next(L, table); lua_pop(L, 1)) {
        int rest;
        if (lua_isinteger(L, -2) && function_rest(function, &rest))
            continue;
        if (lua_type(L, -2) != LUA_TSTRING)
            context_raise(c, "fields need names, as in %s = ...", function->parameters[skip].name);
        const char *field = lua_tostring(L, -2);
        bool known = false;
        for (int k = skip; k < function->parameter_count && !known; k++)
            known = strcmp(function->parameters[k].name, field) == 0;
        if (!known && (!unknown || strcmp(field, unknown) < 0))
            unknown = field;
    }
    if (!unknown)
        return;
    struct suggestion suggestion;
    suggest_begin(&suggestion, unknown);
    for (int k = skip; k < function->parameter_count; k++)
        suggest_offer(&suggestion, function->parameters[k].name);
    if (suggestion.best)
        context_raise(c, "unknown field '%.100s'; did you mean '%s'?", unknown, suggestion.best);
    char fields[700] = "";
    for (int k = skip; k < function->parameter_count && strlen(fields) < sizeof fields - 60; k++)
        snprintf(fields + strlen(fields), sizeof fields - strlen(fields), "%s%s", k > skip ? ", " : "",
                 function->parameters[k].name);
    context_raise(c, "unknown field '%.100s'; the fields are %s", unknown, fields);
}
