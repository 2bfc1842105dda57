/* Source positions, warnings and errors of a running script. The position is that of the nearest Lua function on the
 * stack with a known line, so that C functions called through pcall or other C functions still name the script's
 * line. */
#include "sandbox/sandbox.h"

#include "base/hash.h"
#include "sandbox/libraries_internal.h"
#include "sandbox/protect.h"
#include "sandbox/streams_internal.h"

#include <assert.h>
#include <lauxlib.h>
#include <string.h>

enum { CHECKED_LINES = 1024 };

struct sandbox *sandbox_of(lua_State *L) {
    return *(struct sandbox **)lua_getextraspace(L);
}

/* --- begin and end --- */

bool sandbox_begin(struct sandbox *sandbox, struct error *error) {
    struct files *files = &sandbox->files;
    limits_begin(&sandbox->limits, sandbox->options);
    const char *slash = strrchr(files->path, '/');
    size_t length = slash ? (size_t)(slash - files->path) + 1 : 0;
    if (strlen(files->path) >= PATH_SIZE - 64)
        return error_set(error, ERROR_SCENE, "%.100s...: the path is too long", files->path);
    memcpy(files->folder, files->path, length);
    sandbox->checked_lines = arena_alloc_array(&sandbox->keep, CHECKED_LINES, sizeof *sandbox->checked_lines);
    return sandbox->checked_lines || error_no_memory(error, "the script");
}

void sandbox_open(lua_State *L) {
    libraries_open(L);
    protect_open(L);
    files_open(L);
    streams_open(L);
}

uint64_t sandbox_end(struct sandbox *sandbox) {
    streams_close(sandbox);
    if (sandbox->hints)
        lua_close(sandbox->hints);
    arena_destroy(&sandbox->files.search.arena);
    arena_destroy(&sandbox->call);
    arena_destroy(&sandbox->keep);
    return limits_end(&sandbox->limits);
}

bool sandbox_is_over(const struct sandbox *sandbox) {
    return sandbox->ended || sandbox->fatal.kind != ERROR_NONE || sandbox->limits.memory_out;
}

struct sandbox *sandbox_enter(lua_State *L) {
    struct sandbox *sandbox = sandbox_of(L);
    sandbox->lua = L;
    sandbox->running = (struct running_function){0};
    return sandbox;
}

/* --- positions --- */

bool sandbox_is_library(const struct sandbox *sandbox, const char *source) {
    const char *library = sandbox->options->library_folder;
    size_t length = library ? strlen(library) : 0;
    return length > 0 && source[0] == '@' && strncmp(source + 1, library, length) == 0 && source[length + 1] == '/';
}

/* The frame of sandbox_find_frame; *entry is the function of the library that it called: in line 0 if there is none. */
static bool find_frame(lua_State *L, lua_Debug *frame, lua_Debug *entry) {
    const struct sandbox *sandbox = sandbox_of(L);
    lua_Debug at;
    bool found = false;
    entry->currentline = 0;
    for (int level = 0; lua_getstack(L, level, &at); level++) {
        lua_getinfo(L, "l", &at);
        if (at.currentline <= 0 || !lua_getinfo(L, "S", &at))
            continue;
        bool of_scene = !sandbox_is_library(sandbox, at.source);
        if (!found || of_scene)
            *frame = at;
        found = true;
        if (of_scene)
            return true;
        *entry = at;
    }
    entry->currentline = 0;
    return found;
}

bool sandbox_find_frame(lua_State *L, lua_Debug *frame) {
    lua_Debug entry;
    return find_frame(L, frame, &entry);
}

const char *sandbox_frame_file(const lua_Debug *frame) {
    return frame->source[0] == '@' ? frame->source + 1 : frame->short_src;
}

void sandbox_where(const struct sandbox *sandbox, char *out, size_t size) {
    lua_Debug frame, entry;
    if (!find_frame(sandbox->lua, &frame, &entry)) {
        int length = snprintf(out, size, "%s: ", sandbox->files.path);
        if (sandbox->locate && (size_t)length < size)
            sandbox->locate(sandbox, out + length, size - (size_t)length);
        return;
    }
    int length = snprintf(out, size, "%s:%d: ", sandbox_frame_file(&frame), frame.currentline);
    if (entry.currentline == 0 || !lua_getinfo(sandbox->lua, "n", &entry) || !entry.name || (size_t)length >= size)
        return;
    const char *module = strrchr(entry.source, '/') + 1; /* below the folder of the library */
    snprintf(out + length, size - (size_t)length, "%.*s.%.60s: ", (int)strcspn(module, "."), module, entry.name);
}

/* Whether the message begins with "PATH:LINE: " of a file of the library; the length of that. */
static size_t library_position(const struct sandbox *sandbox, const char *message) {
    char source[PATH_SIZE + 1];
    size_t path = strcspn(message, ":");
    (void)snprintf(source, sizeof source, "@%.*s", (int)path, message);
    size_t digits = message[path] ? strspn(message + path + 1, "0123456789") : 0;
    const char *end = message + path + 1 + digits;
    return digits > 0 && strncmp(end, ": ", 2) == 0 && sandbox_is_library(sandbox, source) ? path + digits + 3 : 0;
}

const char *sandbox_relocate(lua_State *L, const char *message) {
    struct sandbox *sandbox = sandbox_of(L);
    const char *full = files_unshorten(sandbox, message);
    size_t length = full ? library_position(sandbox, full) : 0;
    char where[PATH_SIZE + 128];
    if (length == 0)
        return message;
    sandbox->lua = L;
    sandbox_where(sandbox, where, sizeof where);
    if (library_position(sandbox, where) > 0) /* the library is the scene */
        return message;
    size_t first = strcspn(full, "\n");
    return lua_pushfstring(L, "%s%s (in %s)%s", where, lua_pushlstring(L, full + length, first - length),
                           lua_pushlstring(L, full, length - 2), full + first);
}

bool sandbox_is_new_line(struct sandbox *sandbox, const void *key) {
    lua_Debug frame;
    if (!sandbox_find_frame(sandbox->lua, &frame))
        return true;
    const struct script_line line = {frame.source, key, frame.currentline};
    uint64_t hash = hash_bytes(&line, offsetof(struct script_line, number), (uint64_t)line.number);
    struct script_line *slot = &sandbox->checked_lines[hash % CHECKED_LINES];
    bool is_new = slot->source != line.source || slot->key != line.key || slot->number != line.number;
    *slot = line;
    return is_new;
}

/* --- messages --- */

/* Names may contain line ends. */
void sandbox_compose(const struct sandbox *sandbox, const char *text, char *out, size_t size) {
    const struct running_function *running = &sandbox->running;
    size_t used = running->name ? (size_t)snprintf(out, size, "%s%s: %s", running->owner, running->name, text)
                                : (size_t)snprintf(out, size, "%s", text);
    assert(used < size); /* large enough for a title and the longest text */
    if (running->subject)
        snprintf(out + used, size - used, " (node '%.200s')", running->subject);
    for (char *end = out; (end = strpbrk(end, "\n\r"));)
        *end = '?';
}

void sandbox_message(const struct sandbox *sandbox, enum script_message kind, const char *text) {
    sandbox->host.message(sandbox->host.context, kind, text);
}

void sandbox_warn_line(struct sandbox *sandbox, const char *line) {
    char where[PATH_SIZE + 32], message[PATH_SIZE + 2048];
    sandbox_where(sandbox, where, sizeof where);
    snprintf(message, sizeof message, "%swarning: %s", where, line);
    limits_count_output(&sandbox->limits, strlen(message));
    sandbox_message(sandbox, SCRIPT_WARNING, message);
}

void sandbox_warn_list(struct sandbox *sandbox, const char *format, va_list arguments) {
    char text[1024], line[1536];
    vsnprintf(text, sizeof text, format, arguments);
    sandbox_compose(sandbox, text, line, sizeof line);
    sandbox_warn_line(sandbox, line);
}

void sandbox_warn(struct sandbox *sandbox, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    sandbox_warn_list(sandbox, format, arguments);
    va_end(arguments);
}

/* --- errors --- */

void sandbox_raise(struct sandbox *sandbox, const char *format, ...) {
    char text[1024], where[PATH_SIZE + 32];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    sandbox_compose(sandbox, text, sandbox->raised, sizeof sandbox->raised);
    sandbox_where(sandbox, where, sizeof where);
    lua_pushfstring(sandbox->lua, "%s%s", where, sandbox->raised);
    lua_error(sandbox->lua);
    __builtin_unreachable();
}

/* The value has no meaning: C functions that a script has stored in __close are called with it. */
void sandbox_raise_fatal(lua_State *L) {
    lua_pushnil(L);
    lua_error(L);
    __builtin_unreachable();
}

void sandbox_raise_error(struct sandbox *sandbox, const struct error *error) {
    sandbox->unforgivable = error->refused;
    if (error->kind == ERROR_SCENE && !error->elsewhere && !error->limit)
        sandbox_raise(sandbox, "%s", error->text);
    sandbox->fatal = *error;
    if (error->limit) {
        char where[PATH_SIZE + 32], line[1536];
        sandbox_compose(sandbox, error->text, line, sizeof line);
        sandbox_where(sandbox, where, sizeof where);
        (void)error_set_limit(&sandbox->fatal, "%s%s", where, line);
    }
    sandbox_raise_fatal(sandbox->lua);
}

void sandbox_raise_no_memory(struct sandbox *sandbox) {
    struct error error;
    error_no_memory(&error, sandbox->running.name ? sandbox->running.name : "the script");
    sandbox_raise_error(sandbox, &error);
}

/* --- values --- */

/* The words of a type of userdata, or NULL. They stay in the metatable. */
static const char *own_words(lua_State *L, int index) {
    if (lua_type(L, index) != LUA_TUSERDATA || luaL_getmetafield(L, index, WORDS_FIELD) == LUA_TNIL)
        return NULL;
    const char *words = lua_tostring(L, -1);
    lua_pop(L, 1);
    return words;
}

const char *value_words(lua_State *L, int index) {
    const char *own = own_words(L, index);
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
        return own ? own : "a userdata";
    }
}
