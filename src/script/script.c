/* Runs one scene: a fresh Lua state on our allocator, one protected call around everything, then the state is closed
 * and after it the scene. Invariant: after every error lua_close is called first, then the arenas are destroyed;
 * nothing else is owned here. */
#include "script/context_internal.h"

#include "base/file.h"
#include "script/hints_internal.h"
#include "script/lenient_internal.h"
#include "script/order_internal.h"
#include "script/record_internal.h"

#include <assert.h>
#include <lauxlib.h>
#include <lualib.h>
#include <stdio.h>
#include <string.h>

/* -D name=value: globals set before the run. A value that is a Lua literal counts as that (number, quoted string, true,
 * false, nil, a table of literals), anything else is a string. Tables are evaluated without any globals. */

/* Evaluates `return VALUE` in an empty environment. False: it is no literal; the stack is as before. */
static bool evaluate(lua_State *L, const char *value) {
    int top = lua_gettop(L);
    lua_pushfstring(L, "return %s", value);
    const char *text = lua_tostring(L, -1);
    if (luaL_loadbufferx(L, text, strlen(text), "=-D", "t") == LUA_OK) {
        lua_newtable(L);
        const char *environment = lua_setupvalue(L, -2, 1);
        assert(environment); /* every chunk has one */
        (void)environment;
        if (lua_pcall(L, 0, 1, 0) == LUA_OK) {
            lua_replace(L, top + 1);
            lua_settop(L, top + 1);
            return true;
        }
    }
    lua_settop(L, top);
    return false;
}

static void push_value(lua_State *L, const char *value) {
    size_t length = strlen(value);
    if (lua_stringtonumber(L, value) == length + 1)
        return;
    if (strcmp(value, "true") == 0 || strcmp(value, "false") == 0) {
        lua_pushboolean(L, value[0] == 't');
        return;
    }
    if (strcmp(value, "nil") == 0) {
        lua_pushnil(L);
        return;
    }
    char first = value[0], last = length > 0 ? value[length - 1] : '\0';
    bool quoted = length >= 2 && (first == '"' || first == '\'') && last == first;
    bool table = first == '{' && last == '}' && !strstr(value, "function");
    if (quoted && evaluate(L, value)) {
        if (lua_type(L, -1) == LUA_TSTRING)
            return;
        lua_pop(L, 1);
    } else if (table && evaluate(L, value)) {
        return;
    }
    lua_pushstring(L, value);
}

void define_open(lua_State *L) {
    const struct script_options *options = context_of(L)->options;
    for (int k = 0; k < options->define_count; k++) {
        push_value(L, options->defines[k].value);
        lua_setglobal(L, options->defines[k].name);
    }
}

/* The length of the source position at the start of a message, "scene.lua:12: " or that of a chunk from a string; 0
 * when it has none.
 */
static size_t position_length(const struct script_context *context, const char *message) {
    size_t length = strncmp(message, "[string \"", 9) == 0 ? strcspn(message, "]") + 1 : 0;
    for (const struct source_name *source = context->sources; source && length == 0; source = source->next) {
        size_t name = strlen(source->path);
        if (strncmp(message, source->path, name) == 0 && message[name] == ':')
            length = name;
    }
    size_t digits = length > 0 && message[length] == ':' ? strspn(message + length + 1, "0123456789") : 0;
    const char *end = message + length + 1 + digits;
    return digits > 0 && end[0] == ':' && end[1] == ' ' ? (size_t)(end + 2 - message) : 0;
}

/* The message from its innermost source position on, which is the most precise: coroutine.wrap and error add others
 * before it. Paths that Lua has shortened are written in full. NULL without memory. */
static const char *innermost(struct script_context *context, const char *message, bool *has_position) {
    message = files_unshorten(context, message);
    size_t outer = message ? position_length(context, message) : 0;
    *has_position = outer > 0;
    const char *inner = outer > 0 ? files_unshorten(context, message + outer) : message;
    return inner && outer > 0 && position_length(context, inner) == 0 ? message : inner;
}

/* The text with every line indented, and two blanks for a tab. */
static const char *indent(struct arena *arena, const char *text) {
    size_t size = 3;
    for (const char *c = text; *c; c++)
        size += *c == '\n' ? 3 : *c == '\t' ? 2 : 1;
    char *out = arena_alloc(arena, size), *to = out;
    if (!out)
        return NULL;
    *to++ = ' ';
    *to++ = ' ';
    for (const char *c = text; *c; c++) {
        *to++ = *c == '\t' ? ' ' : *c;
        if (*c == '\t' || *c == '\n')
            *to++ = ' ';
        if (*c == '\n')
            *to++ = ' ';
    }
    *to = '\0';
    return out;
}

/* Whether a function of gr raised this message, and would not under --lenient. */
static bool is_forgivable(const struct script_context *context, const char *message) {
    size_t length = strlen(message), raised = strlen(context->raised);
    return !context->lenient && !context->unforgivable && raised > 0 && length >= raised &&
           strcmp(message + length - raised, context->raised) == 0;
}

/* The message handler: writes the complete first line and the traceback while the stack still exists. */
static int describe_error(lua_State *L) {
    struct script_context *context = context_of(L);
    if (context->ended || context->fatal.kind != ERROR_NONE) /* the context has the error */
        return 1;
    context->lua = L;
    char where[PATH_SIZE + 32];
    context_where(context, where, sizeof where);
    const char *message;
    if (lua_type(L, 1) == LUA_TSTRING || luaL_getmetafield(L, 1, "__tostring") != LUA_TNIL)
        message = luaL_tolstring(L, 1, NULL);
    else
        message = lua_pushfstring(L, "the script raised %s", value_words(L, 1));
    bool has_position;
    message = innermost(context, message, &has_position);
    if (!message) {
        error_no_memory(&context->fatal, "the script");
        return 1;
    }
    size_t first = strcspn(message, "\n");
    char frame[FRAME_WORDS];
    frames_name_frame(context, frame);
    error_set(&context->failure, ERROR_SCENE, "%s%.*s%s%s", has_position ? "" : where, (int)first, message,
              hint_of_lua_error(L, message), frame);
    const char *rest = message + first + (message[first] == '\n');
    luaL_traceback(L, L, *rest ? rest : NULL, 1);
    if (is_forgivable(context, message)) {
        lua_pushliteral(L, "\n--lenient gets over this error");
        lua_concat(L, 2);
    }
    context->traceback = indent(context->out, lua_tostring(L, -1));
    lua_settop(L, 1); /* load also calls this, if its text is nested too deeply, and returns the message */
    return 1;
}

static int run_scene(lua_State *L) {
    struct script_context *context = context_of(L);
    sandbox_open(L);
    protect_open(L);
    files_open(L);
    streams_open(L);
    traverse_open(L);
    compat_open(L);
    handles_open(L);
    dispatch_open(L);
    lenient_open(L);
    record_open(L);
    frames_open(L);
    library_open(L);
    define_open(L);
    lua_settop(L, 0);
    limits_open(L);
    dialect_run(L);
    if (files_load(L, context->path) != LUA_OK)
        return lua_error(L);
    lua_call(L, 0, 0);
    dialect_finish(L);
    return 0;
}

/* The result of the protected call as one error. */
static bool conclude(struct script_context *context, int status, struct error *error) {
    if (context->fatal.kind != ERROR_NONE) {
        *error = context->fatal;
        return false;
    }
    if (status == LUA_OK || context->ended)
        return true;
    if (context->limits.memory_out)
        return error_set(error, ERROR_SCENE, "%s: %s", context->path, context->limits.memory_words);
    if (status == LUA_ERRMEM)
        return error_set(error, ERROR_MACHINE, "%s: out of memory for the script", context->path);
    *error = context->failure;
    return false;
}

static bool choose_order(struct script_context *context, struct error *error) {
    struct order_finding finding;
    if (!order_detect(context->path, context->options->library_folder, context->path_policy, &finding, error))
        return false;
    context->only_named_pictures = finding.only_named_pictures;
    switch (context->options->transform_order) {
    case SCRIPT_ORDER_NEW:
        context->scene.order = ORDER_NEW;
        return true;
    case SCRIPT_ORDER_OLD:
        context->scene.order = ORDER_OLD;
        return true;
    case SCRIPT_ORDER_SEPARATE:
        context->scene.order = ORDER_SEPARATE;
        return true;
    case SCRIPT_ORDER_AUTO:
        break;
    }
    context->scene.order = finding.order;
    if (finding.order != ORDER_OLD)
        return true;
    char text[PATH_SIZE + 600];
    snprintf(text, sizeof text,
             "%s: old transform order, because %s; set it with --transform-order old or gr.transform_order('old')",
             context->path, finding.reason);
    context->host->message(context->host->context, SCRIPT_NOTICE, text);
    return true;
}

bool script_path_policy(const char *path, const struct script_options *options, struct path_policy *path_policy,
                        struct error *error) {
    bool ok = path_policy_add_scene(path_policy, path, options->library_folder, error) &&
              dialect_add_folder(options, path_policy, error);
    for (int k = 0; ok && k < options->allow_read_count; k++)
        ok = path_policy_add(path_policy, options->allow_read[k], PATH_POLICY_READ, error);
    for (int k = 0; ok && k < options->allow_write_count; k++)
        ok = path_policy_add(path_policy, options->allow_write[k], PATH_POLICY_WRITE, error);
    return ok;
}

/* What the pointers in it lead to stays the same while the epoch does, but for the lights and the table of the tone. */
struct digest render_request_digest(const struct render_request *request) {
    const struct tone_table *table = request->settings.tone.table;
    struct digest digest = {request->scene->epoch, table != NULL};
    struct render_request shown;
    memcpy(&shown, request, sizeof shown);
    shown.file = shown.where = NULL;
    shown.frame = (struct frame){0};
    shown.lights = NULL;
    shown.settings.tone.table = NULL;
    digest = digest_bytes(&shown, sizeof shown, digest);
    if (table)
        digest = digest_bytes(table, sizeof *table, digest);
    return digest_bytes(request->lights, request->light_count * sizeof *request->lights, digest);
}

static bool prepare(struct script_context *context, struct path_policy *path_policy, struct error *error) {
    const char *slash = strrchr(context->path, '/');
    size_t length = slash ? (size_t)(slash - context->path) + 1 : 0;
    if (strlen(context->path) >= PATH_SIZE - 64)
        return error_set(error, ERROR_SCENE, "%.100s...: the path is too long", context->path);
    memcpy(context->folder, context->path, length);
    context->warned = arena_alloc(&context->keep, (size_t)function_count());
    context->checked_lines = arena_alloc_array(&context->keep, CHECKED_LINES, sizeof *context->checked_lines);
    if (!context->warned || !context->checked_lines || !lenient_begin(context))
        return error_no_memory(error, "the script");
    struct file_bytes bytes; /* an unreadable file is reported before anything else, in one line */
    if (!file_map(context->path, FILE_LIMIT, &bytes, error))
        return false;
    file_unmap(&bytes);
    if (!context->options->no_sandbox) {
        if (!script_path_policy(context->path, context->options, path_policy, error))
            return false;
        context->path_policy = path_policy;
    }
    return dialect_find(context, error) && choose_order(context, error);
}

bool script_run(const char *path, const struct script_options *options, const struct script_host *host,
                struct arena *arena, const char **traceback, struct error *error) {
    struct script_context context = {.options = options, .host = host, .out = arena, .path = path};
    *traceback = NULL;
    scene_init(&context.scene, host->assets);
    struct path_policy path_policy = {0};
    /* The message if the message handler failed. */
    error_set(&context.failure, ERROR_SCENE, "%s: an error while an error was reported", path);
    limits_begin(&context);
    bool done = prepare(&context, &path_policy, error);
    lua_State *L = done ? lua_newstate(limits_allocate, &context) : NULL;
    if (done && !L)
        done = error_no_memory(error, "the script");
    if (L) {
        *(struct script_context **)lua_getextraspace(L) = &context;
        context.lua = L;
        lua_pushcfunction(L, describe_error);
        lua_pushcfunction(L, run_scene);
        done = conclude(&context, lua_pcall(L, 0, 0, 1), error);
        context.lua = NULL;
        if (context.lenient && (done || error->kind == ERROR_SCENE))
            lenient_last_picture(&context, !done);
        *traceback = done || error->kind != ERROR_SCENE ? NULL : context.traceback;
        lua_close(L);
    }
    recorder_destroy(context.recorder);
    streams_close(&context);
    path_policy_destroy(&path_policy);
    scene_destroy(&context.scene);
    arena_destroy(&context.search.arena);
    arena_destroy(&context.call);
    arena_destroy(&context.keep);
    limits_end(&context);
    return done;
}
