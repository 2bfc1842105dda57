/* Files a script names: Lua files through require, dofile and loadfile, meshes and images. Everything is read through
 * base/file.h. A relative name is looked for in (docs/language.md 12.3): the scene's folder, the working directory,
 * Assets/ beside and above the scene, and the bare file name in the scene's folder; then below these folders
 * (search.c), and at last among the pictures that come with the program. */
#include "sandbox/files.h"

#include "base/file.h"
#include "base/suggestion.h"
#include "sandbox/hints.h"
#include "sandbox/sandbox.h"

#include <lauxlib.h>
#include <limits.h>
#include <lualib.h>
#include <stdio.h>
#include <string.h>

static bool try_file(const struct sandbox *sandbox, char out[PATH_SIZE], const char *folder, const char *separator,
                     const char *name) {
    int length = snprintf(out, PATH_SIZE, "%s%s%s", folder, separator, name);
    return (size_t)length < PATH_SIZE && path_policy_is_readable(sandbox->path_policy, out);
}

bool files_find(struct sandbox *sandbox, const char *name, char out[PATH_SIZE]) {
    if (name[0] == '/')
        return try_file(sandbox, out, "", "", name);
    const char *folder = sandbox->files.folder, *slash = strrchr(name, '/');
    return try_file(sandbox, out, folder, "", name) || try_file(sandbox, out, "", "", name) ||
           try_file(sandbox, out, folder, "Assets/", name) || try_file(sandbox, out, folder, "../Assets/", name) ||
           (slash && try_file(sandbox, out, folder, "", slash + 1));
}

/* A digit, ".0", then no digit: Lua 5.4 writes 3.0 as "3.0", older versions as "3". */
static bool is_tail(const char *start, const char *dot) {
    bool digits = dot > start && dot[-1] >= '0' && dot[-1] <= '9';
    return digits && dot[0] == '.' && dot[1] == '0' && !(dot[2] >= '0' && dot[2] <= '9');
}

const char *files_repair_number(struct sandbox *sandbox, const char *name) {
    const char *dot = name;
    while (*dot && !is_tail(name, dot))
        dot++;
    if (!*dot)
        return name;
    char *repaired = arena_alloc(&sandbox->call, strlen(name) + 1);
    if (!repaired)
        return NULL;
    char *to = repaired;
    for (const char *from = name; *from;) {
        if (is_tail(name, from))
            from += 2;
        else
            *to++ = *from++;
    }
    if (!sandbox->files.number_repaired) {
        char where[PATH_SIZE + 32], text[2 * PATH_SIZE];
        sandbox->files.number_repaired = true;
        sandbox_where(sandbox, where, sizeof where);
        snprintf(text, sizeof text, "%s'%.1000s' is read as '%.1000s': whole numbers in file names lose their .0",
                 where, name, repaired);
        sandbox_message(sandbox, SCRIPT_NOTICE, text);
    }
    return repaired;
}

/* No file has a longer name; the error does not show the whole name. */
static bool name_fits(const char *name, struct error *error) {
    if (strlen(name) >= PATH_MAX)
        return error_set(error, ERROR_SCENE, "cannot find '%.60s...': a path has at most %d bytes", name, PATH_MAX - 1);
    for (const char *part = name; *part; part += strspn(part, "/")) {
        size_t length = strcspn(part, "/");
        if (length > NAME_MAX)
            return error_set(error, ERROR_SCENE, "cannot find '%.60s...': the name of a file has at most %d bytes",
                             name, NAME_MAX);
        part += length;
    }
    return true;
}

/* Looks for a file that is not where the scene names it; the first time for each name with a notice. *found is NULL if
 * there is none. */
static bool search_file(struct sandbox *sandbox, const char *name, const char **found, struct error *error) {
    if (!search_find(&sandbox->files.search, sandbox->path_policy, sandbox->files.folder, name, found))
        return error_no_memory(error, "the names of files");
    if (!*found)
        return true;
    for (const struct source_name *known = sandbox->files.found_names; known; known = known->next)
        if (strcmp(known->path, name) == 0)
            return true;
    struct source_name *known = arena_alloc(&sandbox->keep, sizeof *known);
    const char *copy = known ? arena_copy_text(&sandbox->keep, name, strlen(name)) : NULL;
    if (!copy)
        return error_no_memory(error, "the names of files");
    *known = (struct source_name){.path = copy, .next = sandbox->files.found_names};
    sandbox->files.found_names = known;
    char where[PATH_SIZE + 32], text[3 * PATH_SIZE];
    sandbox_where(sandbox, where, sizeof where);
    snprintf(text, sizeof text, "%s'%.1000s' was found as '%s'", where, name, *found);
    sandbox_message(sandbox, SCRIPT_NOTICE, text);
    return true;
}

bool files_search(void *user, const char *folder, const char *name, const char **path, bool *refused,
                  struct error *error) {
    struct sandbox *sandbox = user;
    *path = NULL;
    *refused = !search_may(sandbox->path_policy, folder, name);
    return *refused || strlen(name) >= PATH_SIZE || search_file(sandbox, name, path, error);
}

static bool outside(const char *name, struct error *error) {
    return error_set(error, ERROR_SCENE,
                     "'%s' lies outside the folders that scenes may read (--allow-read DIR adds one)", name);
}

/* The error of a file that is nowhere, with the name of one that is spelt like it. */
static bool not_found(struct sandbox *sandbox, const char *name, struct error *error) {
    const char *folder = sandbox->files.folder, *slash = strrchr(name, '/');
    int length = (int)strlen(folder);
    char looked_in[3 * PATH_SIZE] = "";
    struct suggestion suggestion;
    suggest_begin(&suggestion, slash ? slash + 1 : name);
    for (uint32_t i = 0; i < sandbox->files.search.count; i++) {
        const char *file = strrchr(sandbox->files.search.files[i], '/');
        suggest_offer(&suggestion, file ? file + 1 : sandbox->files.search.files[i]);
    }
    if (length == 0)
        snprintf(looked_in, sizeof looked_in, " (looked in ., Assets, ../Assets)");
    else
        snprintf(looked_in, sizeof looked_in, " (looked in %.*s, ., %sAssets, %s../Assets)", length - 1, folder, folder,
                 folder);
    const char *meant = suggestion.best;
    if (name[0] == '~')
        return error_set(
            error, ERROR_SCENE,
            "cannot find '%s': '~' is not expanded; write the whole path of your home folder, and allow it "
            "with --allow-read DIR",
            name);
    return error_set(error, ERROR_SCENE, "cannot find '%s'%s%s%s%s", name, name[0] == '/' ? "" : looked_in,
                     meant ? "; did you mean '" : "", meant ? meant : "", meant ? "'?" : "");
}

bool files_require(struct sandbox *sandbox, const char *name, char out[PATH_SIZE], struct error *error) {
    if (!name_fits(name, error))
        return false;
    if (files_find(sandbox, name, out))
        return true;
    const char *repaired = files_repair_number(sandbox, name), *found;
    if (!repaired)
        return error_no_memory(error, "the name of a file");
    if (repaired != name && files_find(sandbox, repaired, out))
        return true;
    if (!search_may(sandbox->path_policy, sandbox->files.folder, name))
        return outside(name, error);
    if (!search_file(sandbox, name, &found, error) ||
        (!found && repaired != name && !search_file(sandbox, repaired, &found, error)))
        return false;
    if (found && strlen(found) < PATH_SIZE) {
        memcpy(out, found, strlen(found) + 1);
        return true;
    }
    const char *library = sandbox->options->library_folder;
    if (library && !strchr(name, '/') && try_file(sandbox, out, library, PATH_POLICY_TEXTURES "/", name))
        return true;
    if (path_policy_is_outside(sandbox->path_policy, name))
        return outside(name, error);
    return not_found(sandbox, name, error);
}

/* Lua shortens a long file name to "..." and its end, LUA_IDSIZE - 1 characters in total. */
const char *files_unshorten(struct sandbox *sandbox, const char *message) {
    enum { TAIL = LUA_IDSIZE - 4 };
    if (strncmp(message, "...", 3) != 0)
        return message;
    for (const struct source_name *source = sandbox->files.sources; source; source = source->next) {
        size_t length = strlen(source->path);
        if (length < LUA_IDSIZE || strncmp(message + 3, source->path + length - TAIL, TAIL) != 0)
            continue;
        if (message[3 + TAIL] == ':')
            return arena_format(&sandbox->keep, "%s%s", source->path, message + 3 + TAIL);
    }
    return message;
}

/* Raises an error that does not come from a gr function. */
_Noreturn static void raise_outside(lua_State *L, const struct error *error) {
    struct sandbox *sandbox = sandbox_enter(L);
    sandbox_raise_error(sandbox, error);
}

static bool is_dialect(const struct sandbox *sandbox, const char *path) {
    return sandbox->files.dialect && strcmp(path, sandbox->files.dialect) == 0;
}

const struct path_policy *files_policy(const struct sandbox *sandbox, const char *path) {
    return is_dialect(sandbox, path) || strcmp(path, sandbox->files.path) == 0 ? NULL : sandbox->path_policy;
}

static const char key = 0; /* the globals that our own modules see are in the registry under its address */

/* The chunk on top of the stack, from the file `path`, sees these globals if it is one of ours. */
static void adopt_library(lua_State *L, const char *path) {
    const char *folder = sandbox_of(L)->options->library_folder;
    char library[PATH_SIZE], file[PATH_SIZE];
    if (!folder || !folder[0] || !file_canonical(folder, library, sizeof library) ||
        !file_canonical(path, file, sizeof file))
        return;
    size_t length = strlen(library);
    if (strncmp(file, library, length) != 0 || file[length] != '/')
        return;
    lua_rawgetp(L, LUA_REGISTRYINDEX, &key);
    if (!lua_setupvalue(L, -2, 1))
        lua_pop(L, 1); /* byte code (without the sandbox) may have no globals */
}

const char *files_hint_of_missing_scene(struct sandbox *sandbox) {
    struct file_search *search = &sandbox->files.search;
    const char *path = sandbox->files.path, *with_ending = arena_format(&sandbox->call, "%s.lua", path), *found;
    struct file_identity identity;
    if (!with_ending || file_identity_of(path, &identity))
        return "";
    if (!file_is_regular(with_ending))
        with_ending = NULL;
    (void)search_find(search, sandbox->path_policy, sandbox->files.folder, path, &found); /* lists the files */
    return hint_of_missing(sandbox, path, with_ending, search->files, search->count);
}

/* Pushes the chunk, or a message. Raises only before the file is mapped, so the file is always unmapped. A first line
 * that starts with # is skipped, but not its line end, so that line numbers stay correct. */
static bool contains(const char *text, size_t size, const char *word) {
    const size_t length = strlen(word);
    for (size_t at = 0; at + length <= size; at++)
        if (text[at] == word[0] && memcmp(text + at, word, length) == 0)
            return true;
    return false;
}

/* Notes how the scene renders: by positions, as scenes of other programs do, or by fields. */
static void note_style(struct sandbox *sandbox, const char *text, size_t size) {
    sandbox->is_positional = contains(text, size, "gr.render(") && !contains(text, size, "gr.render{") &&
                             !contains(text, size, "gr.render {") && !contains(text, size, "gr.frames");
}

/* With its byte order mark, or without: one of the first two bytes is 0. */
static bool is_utf_16(const uint8_t *data, size_t size) {
    return size >= 2 && (memcmp(data, "\xff\xfe", 2) == 0 || memcmp(data, "\xfe\xff", 2) == 0 || !data[0] != !data[1]);
}

int files_load(lua_State *L, const char *path) {
    struct sandbox *sandbox = sandbox_of(L);
    struct source_name *source = arena_alloc(&sandbox->keep, sizeof *source);
    char *name = source ? arena_format(&sandbox->keep, "@%s", path) : NULL;
    struct error error = {0};
    if (!name) {
        (void)error_no_memory(&error, path);
        if (error.limit)
            raise_outside(L, &error);
        lua_pushliteral(L, "not enough memory");
        return LUA_ERRMEM;
    }
    *source = (struct source_name){.path = name + 1, .next = sandbox->files.sources};
    sandbox->files.sources = source;
    struct file_bytes bytes;
    if (!path_policy_map(files_policy(sandbox, path), path, FILE_LIMIT, &bytes, &error)) {
        if (error.kind != ERROR_SCENE || error.limit)
            raise_outside(L, &error);
        lua_pushstring(L, error.text);
        return LUA_ERRFILE;
    }
    const char *text = (const char *)bytes.data;
    size_t size = bytes.size;
    if (size >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0) {
        text += 3;
        size -= 3;
    }
    if (is_utf_16(bytes.data, bytes.size)) {
        lua_pushfstring(L, "%s:1: this is UTF-16 text; save it as UTF-8", path);
        file_unmap(&bytes);
        return LUA_ERRSYNTAX;
    }
    if (size > 0 && text[0] == '#') {
        const char *end = memchr(text, '\n', size);
        size -= end ? (size_t)(end - text) : size;
        text = end ? end : text;
    }
    if (strcmp(path, sandbox->files.path) == 0)
        note_style(sandbox, text, size);
    int status = luaL_loadbufferx(L, size > 0 ? text : "", size, name, sandbox->options->no_sandbox ? "bt" : "t");
    const char *other = status == LUA_ERRSYNTAX && strcmp(path, sandbox->files.path) == 0
                            ? hint_of_file(sandbox, path, bytes.data, bytes.size)
                            : NULL;
    file_unmap(&bytes);
    if (other) {
        lua_pushstring(L, other); /* the name of the scene comes before it */
        lua_replace(L, -2);
    }
    if (status == LUA_OK && !is_dialect(sandbox, path)) /* a dialect has the globals of the scene */
        adopt_library(L, path);
    return status;
}

/* "./mod.lua" is reported as "mod.lua". */
static const char *plain_path(const char *path) {
    return path[0] == '.' && path[1] == '/' ? path + 2 : path;
}

bool files_on_path(const struct sandbox *sandbox, const char *templates, const char *file, char path[PATH_SIZE]) {
    for (const char *template = templates; *template;) {
        size_t length = strcspn(template, ";"), used = 0;
        for (size_t k = 0; k < length && used < PATH_SIZE; k++) {
            if (template[k] == '?')
                used += (size_t)snprintf(path + used, PATH_SIZE - used, "%s", file);
            else
                path[used++] = template[k];
        }
        template += length + (template[length] == ';');
        if (used == 0 || used >= PATH_SIZE)
            continue;
        path[used] = '\0';
        if (path_policy_is_readable(sandbox->path_policy, path))
            return true;
    }
    return false;
}

/* Raises the error of a module that is nowhere, with the name of one that is spelt like it: a module of the library, or
 * a Lua file of the scene. */
_Noreturn static void no_module(struct sandbox *sandbox, const char *module) {
    const char *library = sandbox->options->library_folder;
    struct path_policy_entry *entries;
    struct suggestion suggestion;
    suggest_begin(&suggestion, module);
    size_t count = library ? path_policy_list(sandbox->path_policy, library, 1000, &sandbox->call, &entries) : 0;
    for (size_t i = 0; i < count + sandbox->files.search.count; i++) {
        const char *path = i < count ? entries[i].name : sandbox->files.search.files[i - count],
                   *slash = strrchr(path, '/');
        const char *name = slash ? slash + 1 : path, *dot = strrchr(name, '.');
        const char *plain =
            dot && strcmp(dot, ".lua") == 0 ? arena_format(&sandbox->call, "%.*s", (int)(dot - name), name) : NULL;
        if (plain)
            suggest_offer(&suggestion, plain);
    }
    if (suggestion.best)
        sandbox_raise(sandbox,
                      "require: cannot find module '%.200s' (no such file on package.path); did you mean '%s'?", module,
                      suggestion.best);
    sandbox_raise(sandbox, "require: cannot find module '%.200s' (no such file on package.path)", module);
}

/* A module that is not on package.path: its file, found elsewhere, or NULL. `file` is its name without .lua. */
static const char *search_elsewhere(struct sandbox *sandbox, const char *file) {
    struct error error = {0};
    const char *name = arena_format(&sandbox->call, "%s.lua", file), *found = NULL;
    if (!name) {
        (void)error_no_memory(&error, "the name of a module");
        sandbox_raise_error(sandbox, &error);
    }
    if (strlen(name) >= PATH_SIZE)
        return NULL;
    if (!search_may(sandbox->path_policy, sandbox->files.folder, name)) {
        (void)outside(name, &error);
        sandbox_raise(sandbox, "require: %s", error.text);
    }
    if (!search_file(sandbox, name, &found, &error))
        sandbox_raise_error(sandbox, &error);
    return found;
}

/* The file of one of our modules. False: there is none of this name. */
static bool module_of_library(const struct sandbox *sandbox, const char *name, char file[PATH_SIZE]) {
    const char *library = sandbox->options->library_folder;
    if (!library || strpbrk(name, "./\\"))
        return false;
    int length = snprintf(file, PATH_SIZE, "%s/%s.lua", library, name);
    return (size_t)length < PATH_SIZE && file_is_regular(file);
}

static bool is_same_file(const char *one, const char *other) {
    char a[PATH_SIZE], b[PATH_SIZE];
    return file_canonical(one, a, sizeof a) && file_canonical(other, b, sizeof b) && strcmp(a, b) == 0;
}

/* A file of the scene with the name of one of our modules is loaded in its place, with a notice. */
static void note_shadowed(struct sandbox *sandbox, const char *module, const char *found) {
    char file[PATH_SIZE], where[PATH_SIZE + 32], text[3 * PATH_SIZE];
    if (!module_of_library(sandbox, module, file) || is_same_file(found, file))
        return;
    sandbox_where(sandbox, where, sizeof where);
    snprintf(text, sizeof text, "%s'%s' is %s, which hides the module of the library with this name", where, module,
             found);
    sandbox_message(sandbox, SCRIPT_NOTICE, text);
}

/* package.searchers[2]: Lua files along package.path. Upvalue 1: the package table. Scripts for Lua 5.0 also wrote the
 * extension .lua. */
static int search_module(lua_State *L) {
    struct sandbox *sandbox = sandbox_enter(L);
    arena_reset(&sandbox->call);
    const char *module = luaL_checkstring(L, 1);
    lua_getfield(L, lua_upvalueindex(1), "path");
    const char *templates = lua_tostring(L, -1);
    if (!templates)
        sandbox_raise(sandbox, "require: package.path must be a string");
    char path[PATH_SIZE];
    const char *file = luaL_gsub(L, module, ".", "/"), *found = path;
    bool on_path = files_on_path(sandbox, templates, file, path);
    size_t length = strlen(module);
    if (!on_path && length > 4 && strcmp(module + length - 4, ".lua") == 0) {
        lua_pushlstring(L, module, length - 4);
        file = lua_tostring(L, -1);
        on_path = files_on_path(sandbox, templates, file, path);
    }
    if (!on_path) {
        lua_getfield(L, lua_upvalueindex(1), "searchers");
        if (lua_type(L, -1) == LUA_TTABLE &&
            lua_rawlen(L, -1) > 2) { /* the script has added its own searchers: they are called next */
            lua_pushfstring(L, "no file '%s.lua' on package.path", module);
            return 1;
        }
        found = templates[0] ? search_elsewhere(sandbox, file) : NULL; /* '': the script requests no file */
        if (!found && sandbox->replace_module) {
            sandbox->replace_module(L, module);
            return 1;
        }
        if (!found)
            no_module(sandbox, module);
    }
    note_shadowed(sandbox, module, plain_path(found));
    if (files_load(L, plain_path(found)) != LUA_OK)
        return lua_error(L); /* the message names the file and its line */
    lua_pushstring(L, plain_path(found));
    return 2;
}

/* Index 1 holds a file name: finds it and loads it. */
static int load_named(lua_State *L) {
    struct sandbox *sandbox = sandbox_enter(L);
    arena_reset(&sandbox->call);
    char path[PATH_SIZE];
    struct error error = {0};
    if (files_require(sandbox, luaL_checkstring(L, 1), path, &error))
        return files_load(L, path);
    lua_pushstring(L, error.text);
    return LUA_ERRFILE;
}

static int dofile_continue(lua_State *L, int status, lua_KContext base) {
    (void)status;
    (void)base;
    return lua_gettop(L) - 1;
}

static int file_do(lua_State *L) {
    lua_settop(L, 1);
    if (load_named(L) != LUA_OK) {
        const char *message = lua_tostring(L, -1); /* the result of loading is always a string on failure */
        if (message[0] == '\'' || strncmp(message, "cannot find", 11) == 0)
            return luaL_error(L, "dofile: %s", message);
        return lua_error(L);
    }
    lua_callk(L, 0, LUA_MULTRET, 0, dofile_continue);
    return dofile_continue(L, 0, 0);
}

static int file_load(lua_State *L) {
    bool has_environment = !lua_isnone(L, 3);
    lua_settop(L, 3);
    if (load_named(L) != LUA_OK) {
        lua_pushnil(L);
        lua_insert(L, -2);
        return 2;
    }
    if (has_environment) {
        lua_pushvalue(L, 3);
        if (!lua_setupvalue(L, -2, 1))
            lua_pop(L, 1);
    }
    return 1;
}

void files_open(lua_State *L) {
    struct sandbox *sandbox = sandbox_of(L);
    lua_getglobal(L, "package");
    lua_createtable(L, 2, 0);
    lua_getfield(L, -2, "searchers");
    lua_rawgeti(L, -1, 1); /* package.preload */
    lua_rawseti(L, -3, 1);
    lua_pop(L, 1);
    lua_pushvalue(L, -2);
    lua_pushcclosure(L, search_module, 1);
    lua_rawseti(L, -2, 2);
    lua_setfield(L, -2, "searchers");

    const char *f = sandbox->files.folder, *library = sandbox->options->library_folder;
    lua_pushfstring(L, "%s?.lua;%s?/init.lua;./?.lua;%slua/?.lua;%s../lua/?.lua", f, f, f, f);
    if (library) {
        lua_pushfstring(L, "%s;%s/?.lua", lua_tostring(L, -1), library);
        lua_remove(L, -2);
    }
    const char *slash = sandbox->files.dialect ? strrchr(sandbox->files.dialect, '/') : NULL;
    if (sandbox->files.dialect) {
        lua_pushlstring(L, sandbox->files.dialect, slash ? (size_t)(slash - sandbox->files.dialect) + 1 : 0);
        lua_pushfstring(L, "%s;%s?.lua", lua_tostring(L, -2), lua_tostring(L, -1));
        lua_replace(L, -3);
        lua_pop(L, 1);
    }
    lua_setfield(L, -2, "path");
    lua_pushliteral(L, "");
    lua_setfield(L, -2, "cpath");
    lua_pop(L, 1);

    lua_pushcfunction(L, file_do);
    lua_setglobal(L, "dofile");
    lua_pushcfunction(L, file_load);
    lua_setglobal(L, "loadfile");
}

/* Scripts use names of Lua's libraries for their own variables (`table = gr.node('table')`). The modules that come with
 * the program must still work: their files see the globals as they were before the script began. What such a file adds
 * (`readobj`) becomes a global of the script, and names that it does not find are looked up there. Their `require`
 * finds our modules, even if files of the same names are in the folder of the scene. */

static const char hidden = 0; /* likewise: our modules whose names files of the script also have, by name */

/* The file of one of our modules, if `require` of the script would find another file first. */
static bool is_hidden(lua_State *L, const char *name, char file[PATH_SIZE]) {
    const struct sandbox *sandbox = sandbox_of(L);
    char found[PATH_SIZE];
    if (!module_of_library(sandbox, name, file))
        return false;
    lua_getfield(L, LUA_REGISTRYINDEX, LUA_LOADED_TABLE);
    bool has_path = lua_getfield(L, -1, LUA_LOADLIBNAME) == LUA_TTABLE && lua_getfield(L, -1, "path") == LUA_TSTRING;
    bool taken = has_path && files_on_path(sandbox, lua_tostring(L, -1), name, found) && !is_same_file(found, file);
    lua_settop(L, 1);
    return taken;
}

/* `require` as our modules see it. Upvalue 1: the script's. */
static int library_require(lua_State *L) {
    char file[PATH_SIZE];
    const char *name = luaL_checkstring(L, 1);
    lua_settop(L, 1);
    if (!is_hidden(L, name, file)) {
        lua_pushvalue(L, lua_upvalueindex(1));
        lua_insert(L, 1);
        lua_call(L, 1, LUA_MULTRET);
        return lua_gettop(L);
    }
    lua_rawgetp(L, LUA_REGISTRYINDEX, &hidden);
    if (lua_getfield(L, 2, name) != LUA_TNIL)
        return 1;
    if (files_load(L, file) != LUA_OK)
        return lua_error(L);
    lua_pushvalue(L, 1);
    lua_pushstring(L, file);
    lua_call(L, 2, 1);
    lua_pushvalue(L, -1);
    lua_setfield(L, 2, name);
    return 1;
}

void files_save_globals(lua_State *L) {
    lua_newtable(L);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &hidden);
    lua_newtable(L);
    lua_pushglobaltable(L);
    for (lua_pushnil(L); lua_next(L, -2);) {
        lua_pushvalue(L, -2);
        lua_insert(L, -2); /* the table, _G, key, key, value */
        lua_rawset(L, -5);
    }
    lua_getfield(L, -2, "require");
    lua_pushcclosure(L, library_require, 1);
    lua_setfield(L, -3, "require");
    lua_createtable(L, 0, 2);
    lua_pushvalue(L, -2);
    lua_setfield(L, -2, "__index");
    lua_insert(L, -2);
    lua_setfield(L, -2, "__newindex");
    lua_setmetatable(L, -2);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &key);
}
