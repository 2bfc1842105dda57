/* --dialect NAME|FILE.lua: a file of Lua that runs before the scene, with the same globals and in the same sandbox. It
 * defines the functions of another program by those of gr. It may return a table: its field `methods` has functions
 * that become methods of nodes, its field `finish` is a function that is called after the scene
 * (docs/dialects.md). */
#include "compat/dialect.h"

#include "base/file.h"
#include "call/handle.h"
#include "sandbox/hints.h"

#include <lauxlib.h>
#include <stdio.h>
#include <string.h>

static bool is_file_name(const char *dialect) {
    size_t length = strlen(dialect);
    return strchr(dialect, '/') || (length > 4 && strcmp(dialect + length - 4, ".lua") == 0);
}

bool dialect_file(const struct script_options *options, char *out, size_t size) {
    const char *dialect = options->dialect, *library = options->library_folder;
    if (!dialect)
        return false;
    int length = is_file_name(dialect) ? snprintf(out, size, "%s", dialect)
                 : library             ? snprintf(out, size, "%s/dialects/%s.lua", library, dialect)
                                       : -1;
    return length >= 0 && (size_t)length < size;
}

bool dialect_add_folder(const struct script_options *options, struct path_policy *path_policy, struct error *error) {
    char file[PATH_SIZE];
    if (!dialect_file(options, file, sizeof file))
        return true;
    char *slash = strrchr(file, '/');
    if (slash)
        slash[slash == file] = '\0';
    return path_policy_add(path_policy, slash ? file : ".", PATH_POLICY_IMPLIED, error);
}

bool dialect_find(struct sandbox *sandbox, struct error *error) {
    const char *dialect = sandbox->options->dialect;
    char file[PATH_SIZE];
    struct file_bytes bytes;
    if (!dialect)
        return true;
    bool found = dialect_file(sandbox->options, file, sizeof file);
    if (!is_file_name(dialect) && !(found && file_is_regular(file)))
        return error_set(error, ERROR_USAGE, "--dialect: there is no dialect '%.100s'%s", dialect,
                         hint_of_dialect(sandbox, dialect));
    if (!found)
        return error_set(error, ERROR_USAGE, "--dialect: %.100s...: the path is too long", dialect);
    if (!file_map(file, FILE_LIMIT, &bytes, error)) /* reported like a scene that cannot be read */
        return false;
    file_unmap(&bytes);
    sandbox->files.dialect = arena_copy_text(&sandbox->keep, file, strlen(file));
    return sandbox->files.dialect || error_no_memory(error, "the dialect");
}

/* Stack: the table of methods, that of the nodes. */
static void add_methods(lua_State *L) {
    for (lua_pushnil(L); lua_next(L, -3);) {
        if (lua_type(L, -2) != LUA_TSTRING || !lua_isfunction(L, -1))
            luaL_error(L, "%s: methods must hold functions by name", sandbox_of(L)->files.dialect);
        lua_pushvalue(L, -2);
        lua_insert(L, -2);
        lua_rawset(L, -4);
    }
}

void dialect_run(lua_State *L) {
    const struct sandbox *sandbox = sandbox_of(L);
    if (!sandbox->files.dialect)
        return;
    if (files_load(L, sandbox->files.dialect) != LUA_OK)
        lua_error(L);
    lua_call(L, 0, 1);
    int result = lua_gettop(L);
    if (lua_isnil(L, result))
        return;
    if (!lua_istable(L, result))
        luaL_error(L, "%s: a dialect returns a table or nothing, not %s", sandbox->files.dialect,
                   value_words(L, result));
    lua_pushliteral(L, "methods");
    if (lua_rawget(L, result) == LUA_TTABLE) {
        handle_push_methods(L);
        add_methods(L);
    }
    lua_pushliteral(L, "finish");
    lua_rawget(L, result);
    if (!lua_isnil(L, -1) && !lua_isfunction(L, -1))
        luaL_error(L, "%s: finish must be a function, not %s", sandbox->files.dialect, value_words(L, -1));
    lua_rawsetp(L, LUA_REGISTRYINDEX, &sandbox->files.dialect);
    lua_settop(L, result - 1);
}

void dialect_finish(lua_State *L) {
    const struct sandbox *sandbox = sandbox_of(L);
    if (sandbox->files.dialect && lua_rawgetp(L, LUA_REGISTRYINDEX, &sandbox->files.dialect) == LUA_TFUNCTION)
        lua_call(L, 0, 0);
}
