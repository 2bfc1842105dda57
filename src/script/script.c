/* Runs one scene: a fresh Lua state on our allocator, one protected call around everything, then the state is closed
 * and after it the scene. Invariant: after every error lua_close is called first, then the arenas are destroyed;
 * nothing else is owned here. */
#include "script/script.h"
#include "script/script_internal.h"

#include "base/file.h"
#include "compat/compat.h"
#include "compat/dialect.h"
#include "compat/lenient.h"
#include "compat/lenient_handles.h"
#include "compat/lenient_picture.h"
#include "compat/order.h"
#include "compat/traverse.h"
#include "formats/model.h"
#include "record/record.h"
#include "sandbox/embedded.h"
#include "sandbox/hints.h"
#include "script/dispatch_internal.h"
#include "script/gr_model_internal.h"
#include "script/gr_textures_internal.h"
#include "script/model_scene_internal.h"
#include "script/scene_json_internal.h"
#include "script/scene_write_internal.h"

#include <assert.h>
#include <lauxlib.h>
#include <lualib.h>
#include <stdio.h>
#include <string.h>

/* -D name=value: globals set before the run. */
static void define_open(lua_State *L) {
    const struct script_options *options = sandbox_of(L)->options;
    for (int k = 0; k < options->define_count; k++) {
        compat_push_literal(L, options->defines[k].value);
        lua_setglobal(L, options->defines[k].name);
    }
}

/* The length of the source position at the start of a message, "scene.lua:12: " or that of a chunk from a string; 0
 * when it has none. */
static size_t position_length(const struct sandbox *sandbox, const char *message) {
    size_t length = strncmp(message, "[string \"", 9) == 0 ? strcspn(message, "]") + 1 : 0;
    for (const struct source_name *source = sandbox->files.sources; source && length == 0; source = source->next) {
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
static const char *innermost(struct sandbox *sandbox, const char *message, bool *has_position) {
    message = files_unshorten(sandbox, message);
    size_t outer = message ? position_length(sandbox, message) : 0;
    *has_position = outer > 0;
    const char *inner = outer > 0 ? files_unshorten(sandbox, message + outer) : message;
    return inner && outer > 0 && position_length(sandbox, inner) == 0 ? message : inner;
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

/* Whether a function of gr raised this message, and would not under --lenient, and the scene may be one of another
 * program. */
static bool is_forgivable(const struct script_context *context, const char *message) {
    const struct sandbox *sandbox = &context->sandbox;
    size_t length = strlen(message), raised = strlen(sandbox->raised);
    return !context->lenient && sandbox->is_positional && !sandbox->unforgivable && raised > 0 && length >= raised &&
           strcmp(message + length - raised, sandbox->raised) == 0;
}

/* The message handler: writes the complete first line and the traceback while the stack still exists. */
static int describe_error(lua_State *L) {
    struct script *script = script_of(context_of(L));
    struct sandbox *sandbox = &script->context.sandbox;
    if (sandbox->ended || sandbox->fatal.kind != ERROR_NONE) /* the sandbox has the error */
        return 1;
    sandbox->lua = L;
    char where[PATH_SIZE + 32];
    sandbox_where(sandbox, where, sizeof where);
    const char *message;
    if (lua_type(L, 1) == LUA_TSTRING || luaL_getmetafield(L, 1, "__tostring") != LUA_TNIL)
        message = sandbox_relocate(L, luaL_tolstring(L, 1, NULL));
    else
        message = lua_pushfstring(L, "the script raised %s", value_words(L, 1));
    bool has_position;
    message = innermost(sandbox, message, &has_position);
    has_position |= message && script->is_json && strncmp(message, where, strcspn(where, ":") + 1) == 0;
    if (!message) {
        error_no_memory(&sandbox->fatal, "the script");
        return 1;
    }
    size_t first = strcspn(message, "\n");
    error_set(&script->failure, ERROR_SCENE, "%s%.*s%s%s", has_position ? "" : where, (int)first, message,
              hint_of_lua_error(L, message), sandbox->error_suffix);
    const char *rest = message + first + (message[first] == '\n');
    luaL_traceback(L, L, *rest ? rest : NULL, embedded_end(L, 1));
    if (strcmp(lua_tostring(L, -1), "stack traceback:\n\t[C]: in ?") == 0) { /* of a syntax error */
        lua_pushliteral(L, "");
        lua_replace(L, -2);
    }
    if (is_forgivable(&script->context, message)) {
        lua_pushliteral(L, "\n--lenient gets over this error");
        lua_concat(L, 2);
    }
    const char *below = lua_tostring(L, -1);
    script->traceback = below[0] && !script->is_json ? indent(script->out, below) : NULL;
    lua_settop(L, 1); /* load also calls this, if its text is nested too deeply, and returns the message */
    return 1;
}

static void run_file(lua_State *L, const char *path) {
    if (files_load(L, path) != LUA_OK)
        (void)lua_error(L);
    lua_call(L, 0, 0);
}

void script_open(lua_State *L) {
    const struct script *script = script_of(context_of(L));
    sandbox_open(L);
    traverse_open(L);
    compat_open(L);
    handles_open(L);
    dispatch_open(L);
    if (script->context.lenient)
        lenient_open(L);
    record_open(L);
    textures_open(L);
    frames_open(L);
    files_save_globals(L);
    define_open(L);
    lua_settop(L, 0);
    limits_open(L);
    dialect_run(L);
    if (script->context.sandbox.options->edits)
        run_file(L, script->context.sandbox.options->edits);
    if (script->context.sandbox.options->edits_text) {
        if (luaL_loadstring(L, script->context.sandbox.options->edits_text) != LUA_OK)
            (void)lua_error(L);
        lua_call(L, 0, 0);
    }
    if (script->host->write_scene)
        scene_write_open(L);
}

static int run_scene(lua_State *L) {
    const struct script *script = script_of(context_of(L));
    script_open(L);
    if (script->context.scene.is_model)
        model_scene_run(L);
    else if (script->is_json)
        scene_json_run(L);
    else
        run_file(L, script->context.sandbox.files.path);
    models_report_unused(script);
    dialect_finish(L);
    return 0;
}

/* The result of the protected call as one error. */
static bool conclude(struct script *script, int status, struct error *error) {
    const struct sandbox *sandbox = &script->context.sandbox;
    if (sandbox->fatal.kind != ERROR_NONE) {
        *error = sandbox->fatal;
        return false;
    }
    if (status == LUA_OK || sandbox->ended)
        return true;
    if (sandbox->limits.memory_out)
        return error_set(error, ERROR_SCENE, "%s: %s", sandbox->files.path, sandbox->limits.memory_words);
    if (status == LUA_ERRMEM)
        return error_set(error, ERROR_MACHINE, "%s: out of memory for the script", sandbox->files.path);
    *error = script->failure;
    return false;
}

static bool choose_order(struct script *script, struct error *error) {
    const struct sandbox *sandbox = &script->context.sandbox;
    struct scene *scene = &script->context.scene;
    const char *path = sandbox->files.path;
    struct order_finding finding;
    if (script->context.scene.is_model || script->is_json) {
        script->only_named_pictures = true;
        return true;
    }
    if (!order_detect(path, sandbox->options->library_folder, sandbox->path_policy, &finding, error))
        return false;
    script->only_named_pictures = finding.only_named_pictures;
    script->several_pictures = finding.several_pictures;
    /* An option goes before what the script looks like. */
    switch (sandbox->options->transform_order) {
    case SCRIPT_ORDER_NEW:
        scene->order = TRANSFORM_ORDER_NEW;
        return true;
    case SCRIPT_ORDER_OLD:
        scene->order = TRANSFORM_ORDER_OLD;
        return true;
    case SCRIPT_ORDER_SEPARATE:
        scene->order = TRANSFORM_ORDER_SEPARATE;
        return true;
    case SCRIPT_ORDER_AUTO:
        break;
    }
    scene->order = finding.order;
    if (finding.order != TRANSFORM_ORDER_OLD)
        return true;
    char text[PATH_SIZE + 600];
    snprintf(text, sizeof text,
             "%s: old transform order, because %s; set it with --transform-order old or gr.transform_order('old')",
             path, finding.reason);
    sandbox_message(sandbox, SCRIPT_NOTICE, text);
    return true;
}

/* Of a file that the command line names; NULL: none. */
static bool add_folder_of(const char *file, struct path_policy *path_policy, struct error *error) {
    char folder[PATH_SIZE];
    const char *slash = file ? strrchr(file, '/') : NULL;
    (void)snprintf(folder, sizeof folder, "%.*s.", slash ? (int)(slash + 1 - file) : 0, file ? file : "");
    return !file || path_policy_add(path_policy, folder, PATH_POLICY_IMPLIED, error);
}

bool script_path_policy(const char *path, const struct script_options *options, struct path_policy *path_policy,
                        struct error *error) {
    bool ok = path_policy_add_scene(path_policy, path, options->library_folder, error) &&
              dialect_add_folder(options, path_policy, error) && add_folder_of(options->sky, path_policy, error) &&
              add_folder_of(options->edits, path_policy, error);
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
    shown.time = 0;
    shown.lights = NULL;
    shown.settings.tone.table = NULL;
    digest = digest_bytes(&shown, sizeof shown, digest);
    if (table)
        digest = digest_bytes(table, sizeof *table, digest);
    return digest_bytes(request->lights, request->light_count * sizeof *request->lights, digest);
}

/* --lenient: a picture of the scene if gr.render made none. `failed`: the script ended with an error. */
static void render_last_picture(struct script *script, bool failed) {
    enum { SIDE = 256 };
    struct script_context *c = &script->context;
    const struct script_host *host = script->host;
    const struct lenient *lenient = c->lenient;
    /* A picture, an error that forbids one, or an empty scene: there is none to make. */
    char name[PATH_SIZE], text[3 * PATH_SIZE];
    if (script->pictures > 0 || lenient->refused || c->sandbox.fatal.kind != ERROR_NONE)
        return;
    struct node *root = lenient_root(c);
    if (!root)
        return;
    /* A small picture from the fitted camera, with the lights of the script. */
    context_picture_name(c, "-lenient.png", name, sizeof name);
    struct render_request request = {.where = c->sandbox.files.path,
                                     .scene = &c->scene,
                                     .root = root,
                                     .file = name,
                                     .width = SIDE,
                                     .height = SIDE,
                                     .ambient = {0.3, 0.3, 0.3},
                                     .lights = lenient->lights,
                                     .light_count = lenient->light_count,
                                     .sky = {.kind = SKY_GRADIENT},
                                     .keep = true,
                                     .settings = host->settings};
    lenient_camera(root, &request.camera);
    request.settings.view_is_target = false;
    request.settings.lens = (struct lens){.projection = request.settings.lens.projection,
                                          .view_height = request.settings.lens.view_height,
                                          .angle = request.settings.lens.angle,
                                          .focus = 1,
                                          .screen = 1};
    /* Without a light there is one at the eye. */
    struct scene_light above = {
        .light = {
            .kind = LIGHT_POINT, .position = request.camera.eye, .colour = {0.7, 0.7, 0.7}, .falloff = {1, 0, 0}}};
    if (lenient->light_count == 0) {
        request.lights = &above;
        request.light_count = 1;
    }
    /* It is rendered, and a message says so. */
    struct error error = {0};
    limits_pause(&c->sandbox.limits);
    bool done = host->render(host->context, &request, &error);
    limits_resume(&c->sandbox.limits);
    if (done)
        snprintf(text, sizeof text, "%s: %s: the picture of --lenient shows node '%.200s'", c->sandbox.files.path,
                 failed ? "an error ended the script" : "the script has rendered no picture", root->name);
    else
        snprintf(text, sizeof text, "%s: warning: no picture of --lenient: %s", c->sandbox.files.path, error.text);
    sandbox_message(&c->sandbox, done ? SCRIPT_NOTICE : SCRIPT_WARNING, text);
}

static bool prepare(struct script *script, struct path_policy *path_policy, struct error *error) {
    struct sandbox *sandbox = &script->context.sandbox;
    if (!sandbox_begin(sandbox, error))
        return false;
    if (sandbox->options->lenient && !lenient_begin(&script->context))
        return error_no_memory(error, "the script");
    struct file_bytes bytes; /* an unreadable file is reported before anything else, in one line */
    bool is_there = file_map(sandbox->files.path, FILE_LIMIT, &bytes, error);
    if (is_there)
        file_unmap(&bytes);
    else if (error->kind != ERROR_SCENE)
        return false;
    struct error ignored;
    if (!sandbox->options->no_sandbox) {
        if (!script_path_policy(sandbox->files.path, sandbox->options, path_policy, is_there ? error : &ignored))
            return false;
        sandbox->path_policy = path_policy;
    }
    if (!is_there) {
        const struct error plain = *error;
        return error_set(error, ERROR_SCENE, "%s%s", plain.text, files_hint_of_missing_scene(sandbox));
    }
    return dialect_find(sandbox, error) && choose_order(script, error);
}

static struct sandbox sandbox_of_script(const char *path, const struct script_options *options,
                                        const struct script_host *host) {
    return (struct sandbox){.options = options,
                            .host = {.context = host->context,
                                     .message = host->message,
                                     .cancelled = host->cancelled,
                                     .error_text = host->error_text,
                                     .output_is_error = host->output_is_error,
                                     .prints = host->prints},
                            .files = {.path = path}};
}

bool script_run(const char *path, const struct script_options *options, const struct script_host *host,
                struct arena *arena, const char **traceback, struct error *error) {
    struct script script = {.host = host, .out = arena};
    struct sandbox *sandbox = &script.context.sandbox;
    *traceback = NULL;
    *sandbox = sandbox_of_script(path, options, host);
    scene_init(&script.context.scene, host->assets);
    script.context.scene.is_model = model_is_named(path);
    script.is_json = scene_json_is_named(path);
    struct path_policy path_policy = {0};
    /* The message if the message handler failed. */
    error_set(&script.failure, ERROR_SCENE, "%s: an error while an error was reported", path);
    bool done = prepare(&script, &path_policy, error);
    lua_State *L = done ? lua_newstate(limits_allocate, &sandbox->limits) : NULL;
    if (done && !L)
        done = error_no_memory(error, "the script");
    if (L) {
        *(struct sandbox **)lua_getextraspace(L) = sandbox;
        sandbox->lua = L;
        lua_pushcfunction(L, describe_error);
        lua_pushcfunction(L, run_scene);
        done = conclude(&script, lua_pcall(L, 0, 0, 1), error);
        sandbox->lua = NULL;
        if (script.context.lenient && (done || error->kind == ERROR_SCENE))
            render_last_picture(&script, !done);
        *traceback = done || error->kind != ERROR_SCENE ? NULL : script.traceback;
        lua_close(L);
    }
    recorder_destroy(sandbox->recorder);
    path_policy_destroy(&path_policy);
    scene_destroy(&script.context.scene);
    host->assets->memory += sandbox_end(sandbox); /* what is still allocated belongs to the assets */
    return done;
}
