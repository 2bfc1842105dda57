/* Reading, writing and printing of scenes. Text for standard error goes to the host, which ensures that it is not
 * mistaken for the program's: the stream behind io.stderr calls it (fopencookie(3)), and so does the stream of
 * io.stdout and print if standard output is used for the picture. Files are opened by base/path_policy.h: regular files
 * only, below the folders of the list. Everything written counts towards the output limit, on standard output too.
 * Refusals are returned like any failure of io.open: nil, a sentence, a number. */
#define _GNU_SOURCE
#include "sandbox/streams_internal.h"

#include "base/fault.h"
#include "sandbox/libraries_internal.h"
#include "sandbox/sandbox.h"

#include <errno.h>
#include <lauxlib.h>
#include <lualib.h>
#include <stdio.h>
#include <string.h>

/* The memory that the C library uses for an open stream and its buffer. */
enum { STREAM_COST = 9 << 10 };

static int close_stream(lua_State *L) {
    luaL_Stream *stream = luaL_checkudata(L, 1, LUA_FILEHANDLE);
    mem_unreserve(STREAM_COST);
    return luaL_fileresult(L, fclose(stream->f) == 0, NULL);
}

/* Why a name was refused, for messages. */
static const char *refusal(const struct sandbox *sandbox, const char *name, bool write) {
    if (errno != EACCES || !sandbox->path_policy)
        return strerror(errno);
    if (write)
        return "scenes cannot write files (--allow-write DIR allows it)";
    if (path_policy_is_outside(sandbox->path_policy, name))
        return "lies outside the folders that scenes may read (--allow-read DIR adds one)";
    return "cannot be read by scenes, or is not a regular file";
}

static bool is_mode(const char *mode) {
    if (*mode == '\0' || !strchr("rwa", *mode))
        return false;
    mode++;
    mode += *mode == '+';
    return strspn(mode, "b") == strlen(mode);
}

/* A message that consists of a long name would have no room for the reason. */
static void push_failure(lua_State *L, const char *name, const char *why) {
    enum { SHOWN = 60, LONG = 512 };
    if (strlen(name) <= LONG) {
        lua_pushfstring(L, "%s: %s", name, why);
        return;
    }
    lua_pushlstring(L, name, SHOWN);
    lua_pushfstring(L, "%s...: %s", lua_tostring(L, -1), why);
    lua_remove(L, -2);
}

/* Where a file to read is, if not at its name: where meshes and images are looked for. A mesh, which readers of courses
 * open so, may also be in another folder of the scene. */
static bool find_to_read(struct sandbox *sandbox, const char *name, char found[PATH_SIZE]) {
    const char *ending = strrchr(name, '.');
    struct error ignored;
    return files_find(sandbox, name, found) ||
           (ending && strcmp(ending, ".obj") == 0 && files_require(sandbox, name, found, &ignored));
}

/* Pushes the stream, or nil, a sentence and a number. Reading looks in the working directory first, as always. */
static int open_stream(lua_State *L, const char *name, const char *mode) {
    struct sandbox *sandbox = sandbox_of(L);
    char found[PATH_SIZE];
    bool write = mode[0] != 'r' || strchr(mode, '+');
    const char *path = name;
    if (!write && !path_policy_is_readable(sandbox->path_policy, name) && find_to_read(sandbox, name, found))
        path = found;
    luaL_Stream *stream = lua_newuserdatauv(L, sizeof *stream, 0);
    stream->closef = NULL; /* closed, for its finalizer */
    luaL_setmetatable(L, LUA_FILEHANDLE);
    if (!mem_reserve(STREAM_COST))
        limits_end_for_memory(L);
    stream->f = path_policy_stream(sandbox->path_policy, path, mode);
    if (!stream->f)
        mem_unreserve(STREAM_COST);
    if (stream->f) {
        stream->closef = close_stream;
        return 1;
    }
    int why = errno;
    lua_pushnil(L);
    push_failure(L, name, refusal(sandbox, name, write));
    (void)snprintf(sandbox->refused, sizeof sandbox->refused, "%s", lua_tostring(L, -1));
    lua_pushinteger(L, why);
    return 3;
}

static int io_open(lua_State *L) {
    const char *name = luaL_checkstring(L, 1), *mode = luaL_optstring(L, 2, "r");
    if (!is_mode(mode))
        return luaL_argerror(L, 2, "invalid mode");
    return open_stream(L, name, mode);
}

static void open_or_raise(lua_State *L, const char *name, const char *mode) {
    if (open_stream(L, name, mode) > 1)
        luaL_error(L, "%s", lua_tostring(L, -2));
}

/* io.lines(name, ...): the lines of a new stream, with that stream as the value to be closed. Upvalue 1: Lua's
 * own, for the default input. */
static int io_lines(lua_State *L) {
    if (lua_isnoneornil(L, 1)) {
        lua_pushvalue(L, lua_upvalueindex(1));
        lua_insert(L, 1);
        lua_call(L, lua_gettop(L) - 1, LUA_MULTRET);
        return lua_gettop(L);
    }
    int formats = lua_gettop(L) - 1;
    open_or_raise(L, luaL_checkstring(L, 1), "r");
    lua_replace(L, 1);
    lua_getfield(L, 1, "lines");
    lua_pushvalue(L, 1);
    for (int k = 0; k < formats; k++)
        lua_pushvalue(L, 2 + k);
    lua_call(L, 1 + formats, 1);
    lua_pushnil(L);
    lua_pushnil(L);
    lua_pushvalue(L, 1);
    return 4;
}

/* io.input and io.output: a name becomes a stream first. Upvalues: Lua's own function, the mode. */
static int io_default(lua_State *L) {
    lua_settop(L, 1);
    if (lua_type(L, 1) == LUA_TSTRING) {
        open_or_raise(L, lua_tostring(L, 1), lua_tostring(L, lua_upvalueindex(2)));
        lua_replace(L, 1);
    }
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    lua_call(L, 1, 1);
    return 1;
}

static bool is_silent(const struct sandbox *sandbox) {
    return sandbox->is_silent && sandbox->is_silent(sandbox->recorder);
}

/* io.write and file:write. Upvalue 1: Lua's own. */
static int counted_write(lua_State *L) {
    size_t size = 0;
    if (is_silent(sandbox_of(L)))
        lua_settop(L, luaL_testudata(L, 1, LUA_FILEHANDLE) ? 1 : 0);
    for (int k = 1; k <= lua_gettop(L); k++)
        size += lua_type(L, k) == LUA_TSTRING ? (size_t)lua_rawlen(L, k) : lua_type(L, k) == LUA_TNUMBER ? 24 : 0;
    limits_output(L, size);
    libraries_take_nan(L);
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    lua_call(L, lua_gettop(L) - 1, LUA_MULTRET);
    return lua_gettop(L);
}

static int print(lua_State *L) {
    const struct sandbox *sandbox = sandbox_of(L);
    FILE *out = sandbox->output ? sandbox->output : stdout;
    int count = lua_gettop(L);
    if (is_silent(sandbox))
        return 0;
    for (int k = 1; k <= count; k++) {
        size_t size;
        const char *text = luaL_tolstring(L, k, &size);
        limits_output(L, size + 1);
        if (k > 1)
            (void)fputc('\t', out);
        (void)fwrite(text, 1, size, out);
        lua_pop(L, 1);
    }
    (void)fputc('\n', out);
    return 0;
}

static int answer_change(lua_State *L, bool done, const char *name) {
    if (done) {
        lua_pushboolean(L, 1);
        return 1;
    }
    int why = errno;
    lua_pushnil(L);
    lua_pushfstring(L, "%s: %s", name, refusal(sandbox_of(L), name, true));
    lua_pushinteger(L, why);
    return 3;
}

static int os_remove(lua_State *L) {
    const char *name = luaL_checkstring(L, 1);
    return answer_change(L, path_policy_remove(sandbox_of(L)->path_policy, name), name);
}

static int os_rename(lua_State *L) {
    const char *from = luaL_checkstring(L, 1), *to = luaL_checkstring(L, 2);
    return answer_change(L, path_policy_rename(sandbox_of(L)->path_policy, from, to), from);
}

/* package.searchpath(name, templates [, separator [, replacement]]). */
static int search_path(lua_State *L) {
    const char *name = luaL_checkstring(L, 1), *templates = luaL_checkstring(L, 2);
    const char *separator = luaL_optstring(L, 3, "."), *replacement = luaL_optstring(L, 4, "/");
    char path[PATH_SIZE];
    if (*separator)
        name = luaL_gsub(L, name, separator, replacement);
    if (files_on_path(sandbox_of(L), templates, name, path)) {
        lua_pushstring(L, path);
        return 1;
    }
    lua_pushnil(L);
    lua_pushfstring(L, "no file '%s' on the path", name);
    return 2;
}

/* Replaces a function, which becomes upvalue 1 of the new one; further upvalues are above it on the stack. */
static void replace(lua_State *L, const char *name, lua_CFunction function, const char *mode) {
    lua_getfield(L, -1, name);
    if (mode)
        lua_pushstring(L, mode);
    lua_pushcclosure(L, function, mode ? 2 : 1);
    lua_setfield(L, -2, name);
}

static ssize_t write_to_host(void *cookie, const char *text, size_t size) {
    const struct sandbox *sandbox = cookie;
    sandbox->host.error_text(sandbox->host.context, text, size);
    return (ssize_t)size;
}

/* Replaces the process's stream of that name in the table io, which is on top of the stack, by a stream to the host. It
 * has no buffer, so that its output appears before the next message of the program. */
static FILE *redirect(lua_State *L, const char *name) {
    struct sandbox *sandbox = sandbox_of(L);
    FILE *stream = MAY_GIVE_NULL(fopencookie(sandbox, "w", (cookie_io_functions_t){.write = write_to_host}));
    if (!stream) {
        error_no_memory(&sandbox->fatal, "the streams of the script");
        sandbox_raise_fatal(L);
    }
    (void)setvbuf(stream, NULL, _IONBF, 0);
    lua_getfield(L, -1, name);
    luaL_Stream *handle = luaL_checkudata(L, -1, LUA_FILEHANDLE);
    handle->f = stream;
    lua_pop(L, 1);
    return stream;
}

void streams_close(struct sandbox *sandbox) {
    if (sandbox->output)
        (void)fclose(sandbox->output);
    if (sandbox->errors)
        (void)fclose(sandbox->errors);
}

void streams_open(lua_State *L) {
    struct sandbox *sandbox = sandbox_of(L);
    /* Standard streams and files of io. */
    lua_getglobal(L, "io");
    if (sandbox->host.error_text && !sandbox->options->no_sandbox)
        sandbox->errors = redirect(L, "stderr");
    if (sandbox->host.error_text && sandbox->host.output_is_error)
        sandbox->output = redirect(L, "stdout");
    replace(L, "open", io_open, NULL);
    replace(L, "lines", io_lines, NULL);
    replace(L, "input", io_default, "r");
    replace(L, "output", io_default, "w");
    replace(L, "write", counted_write, NULL);
    luaL_getmetatable(L, LUA_FILEHANDLE);
    lua_getfield(L, -1, "__index");
    replace(L, "write", counted_write, NULL);
    lua_pop(L, 3);
    lua_pushcfunction(L, print);
    lua_setglobal(L, "print");
    if (sandbox->options->no_sandbox)
        return;
    /* Functions of os and package that take names of files. */
    lua_getglobal(L, "os");
    lua_pushcfunction(L, os_remove);
    lua_setfield(L, -2, "remove");
    lua_pushcfunction(L, os_rename);
    lua_setfield(L, -2, "rename");
    lua_pop(L, 1);
    lua_getglobal(L, "package");
    lua_pushcfunction(L, search_path);
    lua_setfield(L, -2, "searchpath");
    lua_pop(L, 1);
}
