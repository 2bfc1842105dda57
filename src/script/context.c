/* Places, warnings and errors of a running script. A place is the nearest Lua function on the stack with a known line,
 * so that gr functions called through pcall or other C functions still name the script's line. */
#include "script/context.h"

#include <assert.h>
#include <lauxlib.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

struct script_context *context_of(lua_State *L) {
    return *(struct script_context **)lua_getextraspace(L);
}

void context_where(const struct script_context *context, char *out, size_t size) {
    lua_Debug argument_path;
    for (int level = 0; lua_getstack(context->lua, level, &argument_path); level++) {
        lua_getinfo(context->lua, "Sl", &argument_path);
        if (argument_path.currentline <= 0)
            continue;
        const char *name = argument_path.source[0] == '@' ? argument_path.source + 1 : argument_path.short_src;
        snprintf(out, size, "%s:%d: ", name, argument_path.currentline);
        return;
    }
    snprintf(out, size, "%s: ", context->path);
}

const char *function_title(const struct script_function *function, char out[96]) {
    snprintf(out, 96, "%s%s", function->owner == OWNER_GR ? "gr." : "node:", function->name);
    return out;
}

/* "gr.sphere: TEXT (node 'eye')", one line whatever names say. */
static void compose(const struct script_context *context, const char *text, char *out, size_t size) {
    char title[96] = "";
    if (context->function)
        function_title(context->function, title);
    size_t used = (size_t)snprintf(out, size, "%s%s%s", title, context->function ? ": " : "", text);
    assert(used < size); /* there is room for a title and the longest text */
    if (context->subject)
        snprintf(out + used, size - used, " (node '%.200s')", context->subject);
    for (char *end = out; (end = strpbrk(end, "\n\r"));)
        *end = '?';
}

static void warn(struct script_context *context, const char *format, va_list arguments) {
    char text[1024], where[PATH_SIZE + 32], line[1536], message[PATH_SIZE + 2048];
    vsnprintf(text, sizeof text, format, arguments);
    compose(context, text, line, sizeof line);
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

_Noreturn static void raise_text(struct script_context *context, const char *text) {
    char where[PATH_SIZE + 32];
    context_where(context, where, sizeof where);
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
    compose(context, text, line, sizeof line);
    raise_text(context, line);
}

/* The value says nothing: C functions that a script has put into __close are called with it. */
void context_raise_fatal(lua_State *L) {
    lua_pushnil(L);
    lua_error(L);
    __builtin_unreachable();
}

void context_raise_error(struct script_context *context, const struct error *error) {
    if (error->kind == ERROR_SCENE && !error->elsewhere && !error->limit)
        context_raise(context, "%s", error->text);
    context->fatal = *error;
    if (error->limit) {
        char where[PATH_SIZE + 32], line[1536];
        compose(context, error->text, line, sizeof line);
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
