/* The state of a call of gr. */
#include "call/context.h"

#include "math/elementary.h"

#include <lauxlib.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

struct script_context *context_of(lua_State *L) {
    return (struct script_context *)sandbox_of(L);
}

void context_begin_call(struct script_context *context, const struct script_function *function) {
    context->function = function;
    context->sandbox.running = (struct running_function){.owner = owner_words(function->owner), .name = function->name};
    arena_reset(&context->sandbox.call);
}

static const char functions = 0; /* the table of gr's own functions is in the registry under its address */

void context_keep_functions(lua_State *L) {
    lua_rawsetp(L, LUA_REGISTRYINDEX, &functions);
}

void context_push_functions(lua_State *L) {
    lua_rawgetp(L, LUA_REGISTRYINDEX, &functions);
}

bool context_is_gr(lua_State *L, int index) {
    if (!lua_istable(L, index) || !lua_getmetatable(L, index)) /* few tables have one */
        return false;
    lua_getfield(L, LUA_REGISTRYINDEX, LUA_LOADED_TABLE);
    lua_getfield(L, -1, "gr");
    bool same = lua_rawequal(L, index, -1);
    lua_pop(L, 3);
    return same;
}

void context_note_line(struct script_context *context) {
    lua_Debug frame;
    context->scene.line = 0;
    if (!sandbox_find_frame(context->sandbox.lua, &frame))
        return;
    if (frame.source != context->line_source) { /* otherwise the file is that of the node before */
        context->line_source = frame.source;
        context->scene.file = scene_keep_text(&context->scene, sandbox_frame_file(&frame));
    }
    context->scene.line = context->scene.file ? (uint32_t)frame.currentline : 0;
}

/* What a function has warned of. */
struct function_warnings {
    const struct script_function *function;
    unsigned bits;
    struct function_warnings *next;
};

/* The warnings of the function that runs. */
static struct function_warnings *warnings_of(struct script_context *context) {
    struct function_warnings *own = context->warned;
    while (own && own->function != context->function)
        own = own->next;
    if (own)
        return own;
    own = arena_alloc(&context->sandbox.keep, sizeof *own);
    if (!own)
        sandbox_raise_no_memory(&context->sandbox);
    *own = (struct function_warnings){.function = context->function, .next = context->warned};
    context->warned = own;
    return own;
}

void context_warn_once(struct script_context *context, unsigned bit, const char *format, ...) {
    struct function_warnings *own = warnings_of(context);
    if (own->bits & bit)
        return;
    own->bits |= bit;
    va_list arguments;
    va_start(arguments, format);
    sandbox_warn_list(&context->sandbox, format, arguments);
    va_end(arguments);
}

/* {200, 50, 50}: bytes, where numbers from 0 to 1 are meant. */
void context_warn_of_bytes(struct script_context *context, const char *name, struct colour c) {
    bool whole = c.r == floor(c.r) && c.g == floor(c.g) && c.b == floor(c.b);
    double max = colour_max_abs(c);
    if (whole && max > 10 && max <= 255 && c.r >= 0 && c.g >= 0 && c.b >= 0)
        context_warn_once(context, WARNED_BYTES,
                          "%s {%g, %g, %g} looks like bytes; colours are numbers from 0 to 1, as {%.3g, %.3g, %.3g}",
                          name, c.r, c.g, c.b, c.r / 255, c.g / 255, c.b / 255);
}

/* The length of a name up to its last dot, which is not its first letter. */
static int without_ending(const char *name, int length) {
    int at = length;
    while (at > 0 && name[at - 1] != '.')
        at--;
    return at > 1 ? at - 1 : length;
}

void context_picture_name(const struct script_context *context, const char *end, char *out, size_t size) {
    context_name_of_picture(context->sandbox.files.path, end, out, size);
}

void context_name_of_picture(const char *path, const char *end, char *out, size_t size) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    int length = without_ending(name, (int)strlen(name));
    if (strcasecmp(name + length, ".gz") == 0) /* a model has another one before it */
        length = without_ending(name, length);
    while (length > 1 && name[0] == '.') /* a picture has no hidden name */
        name++, length--;
    (void)snprintf(out, size, "%.*s%s", length, name, end);
}

/* In twelfths of pi: exact, or with five digits of pi. Fractions with whole numbers of degrees do not exist. */
void context_warn_of_radians(struct script_context *context, const char *name, double degrees) {
    double twelfths = 12 * fabs(degrees) / PI, whole = round(twelfths);
    if (whole >= 1 && whole <= 48 && fabs(twelfths - whole) < 2e-5)
        context_warn_once(context, WARNED_RADIANS,
                          "%s %.6g is %.3g pi: angles are in degrees, and math.deg(x) makes them", name, degrees,
                          degrees / PI);
}

void *context_array(struct script_context *context, size_t count, size_t size) {
    void *array = arena_alloc_array(&context->sandbox.call, count > 0 ? count : 1, size);
    if (!array)
        sandbox_raise_no_memory(&context->sandbox);
    return array;
}

/* Saved edits count textures among the materials of a scene. */
struct script_texture *context_keep_texture(struct script_context *context, const struct script_texture *value,
                                            struct error *error) {
    struct script_texture *out = arena_alloc(&context->scene.arena, sizeof *out);
    if (!out) {
        error_no_memory(error, "a texture");
        return NULL;
    }
    *out = *value;
    context->scene.material_count++;
    return out;
}
