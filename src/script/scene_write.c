/* Records the calls of a scene that is written, and writes it: scene_write.lua has the records and the text. */
#include "script/scene_write_internal.h"

#include "base/document.h"
#include "base/json_write.h"
#include "base/lua_fields.h"
#include "base/terminal_text.h"
#include "expr/expr_text.h"
#include "sandbox/embedded.h"
#include "script/gr_model_internal.h"
#include "script/scene_json_internal.h"
#include "script/script_internal.h"
#include "script/table_internal.h"

#include <lauxlib.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern const char *const scene_write_lua[];

static const char writer = 0; /* the functions of scene_write.lua are in the registry under this address */

/* Pushes a function of scene_write.lua. */
static void push_writer(lua_State *L, const char *name) {
    luaL_checkstack(L, 20, NULL);
    lua_rawgetp(L, LUA_REGISTRYINDEX, &writer);
    lua_getfield(L, -1, name);
    lua_remove(L, -2);
}

/* --- what Lua calls --- */

static int address(lua_State *L) {
    const struct handle *handle = handle_at(L, 1);
    lua_pushlightuserdata(L, handle ? handle->pointer : NULL);
    return 1;
}

/* The function of a picture that texture:at has made, or NULL. */
static int image_function(lua_State *L) {
    const struct script_texture *texture = lua_touserdata(L, 1);
    lua_pushlightuserdata(L, texture->function);
    return 1;
}

/* The positional forms of a method: "axis angle". */
static int forms(lua_State *L) {
    const struct script_function *function = function_find(OWNER_NODE, luaL_checkstring(L, 1));
    lua_newtable(L);
    for (int i = 0; i < FORM_LIMIT && function->forms[i]; i++) {
        lua_pushstring(L, function->forms[i]);
        lua_rawseti(L, -2, i + 1);
    }
    return 1;
}

/* --- records --- */

/* The program of a Lua function, with its pictures by the addresses of their functions. */
static void note_function(struct script_context *context, const struct script_parameter *p,
                          const struct script_value *value) {
    lua_State *L = context->sandbox.lua;
    struct expr_images images = {0};
    struct document code = {.arena = &context->sandbox.call};
    struct error error = {0};
    const struct expr_program *program =
        value->texture ? value->texture->texture->operation.recorded.program : value->program;
    if (!program)
        sandbox_raise(&context->sandbox, "%s is a function that is not recorded, so it cannot be written", p->name);
    if (!expr_write_text(program, &code, &images, &error))
        sandbox_raise_error(&context->sandbox, &error);
    push_writer(L, "program");
    lua_pushstring(L, p->name);
    lua_pushlstring(L, code.text, code.used);
    lua_createtable(L, images.count, 0);
    for (int k = 0; k < images.count; k++) {
        lua_pushlightuserdata(L, (void *)(uintptr_t)images.items[k]);
        lua_rawseti(L, -2, k + 1);
    }
    lua_call(L, 3, 0);
}

/* A file as gray has found it, so that the text may be elsewhere than the script: relative to the text if it is below
 * its folder. The name remains if it is one of the pictures that come with gray, or if nothing is found. */
static void push_file(struct script_context *context, const char *name) {
    const struct script_host *host = script_of(context)->host;
    const char *library = context->sandbox.options->library_folder,
               *slash = host->text_file ? strrchr(host->text_file, '/') : NULL;
    size_t folder = slash ? (size_t)(slash + 1 - host->text_file) : 0;
    char found[PATH_SIZE], textures[PATH_SIZE];
    (void)snprintf(textures, sizeof textures, "%s" PATH_POLICY_TEXTURES, library ? library : "/");
    if (!files_find(&context->sandbox, name, found) || strncmp(found, textures, strlen(textures)) == 0)
        lua_pushstring(context->sandbox.lua, name);
    else
        lua_pushstring(context->sandbox.lua,
                       strncmp(found, host->text_file ? host->text_file : "", folder) == 0 ? found + folder : found);
}

static void note(struct script_context *context, int index, const struct script_parameter *p,
                 const struct script_value *value) {
    lua_State *L = context->sandbox.lua;
    if (p->kind == KIND_CALLBACK)
        return;
    if (lua_isfunction(L, index)) {
        note_function(context, p, value);
        return;
    }
    push_writer(L, "note");
    lua_pushstring(L, p->name);
    if (value->text && (p->kind == KIND_FILE || p->kind == KIND_IMAGE || p->kind == KIND_NUMBERS))
        push_file(context, value->text);
    else if (p->kind == KIND_WHOLE && value->given) /* without the fraction that gr dropped */
        lua_pushnumber(L, value->number);
    else if (p->kind == KIND_NUMBER && lua_isnumber(L, index)) /* not as a string */
        lua_pushnumber(L, lua_tonumber(L, index));
    else
        lua_pushvalue(L, index);
    lua_call(L, 2, 0);
}

void scene_write_begin(struct script_context *context) {
    lua_State *L = context->sandbox.lua;
    push_writer(L, "begin");
    lua_call(L, 0, 0);
}

/* Operands stand alone, in a list, or without a name in a table: their record is a list. */
static void note_rest(struct script_context *context, const struct script_function *function,
                      const struct script_value *args) {
    lua_State *L = context->sandbox.lua;
    int index;
    if (!function_rest(function, &index) || !args[index].given)
        return;
    push_writer(L, "nodes");
    lua_pushstring(L, function->parameters[index].name);
    lua_createtable(L, (int)args[index].count, 0);
    for (uint32_t i = 0; i < args[index].count; i++) {
        lua_pushlightuserdata(L, args[index].nodes[i]);
        lua_rawseti(L, -2, (lua_Integer)i + 1);
    }
    lua_call(L, 2, 0);
}

void scene_write_call(struct script_context *context, const struct script_function *function,
                      const struct script_value *args, const struct script_result *result) {
    static const char *const orders[] = {TRANSFORM_ORDERS(LIST_WORD)};
    lua_State *L = context->sandbox.lua;
    if (function->in_lua || function_renders(function) || function->result == RESULT_FRAMES)
        return;
    const bool may_turn = context->scene.is_model && function->result == RESULT_NODE;
    const struct model *model = may_turn ? models_find(context, result->pointer) : NULL;
    note_rest(context, function, args);
    if (function->owner == OWNER_NODE && function->result == RESULT_SELF) {
        push_writer(L, "called");
        lua_pushlightuserdata(L, args[SELF].node);
        lua_pushstring(L, function->name);
        lua_pushstring(L, orders[context->scene.order]);
        lua_call(L, 3, 0);
    } else if (function->owner == OWNER_GR && result->pointer) {
        push_writer(L, "made");
        lua_pushlightuserdata(L, result->pointer);
        lua_pushstring(L, function->name);
        lua_call(L, 2, 0);
    }
    if (model) { /* without materials it is lighter than in a script */
        push_writer(L, "model");
        lua_pushlightuserdata(L, result->pointer);
        if (model->materials.count == 0)
            lua_pushnumber(L, STUDIO_GRAY);
        else
            lua_pushnil(L);
        lua_pushboolean(L, models_turn(context).forward.m[1][1] != 1);
        lua_call(L, 3, 0);
    }
}

void scene_write_object(lua_State *L, const void *object, const char *kind) {
    push_writer(L, "object");
    lua_insert(L, -2);
    lua_pushlightuserdata(L, (void *)(uintptr_t)object);
    lua_pushstring(L, kind);
    lua_call(L, 3, 0);
}

/* --- pictures --- */

/* The light of the studio around a model, which scripts do not have: its boxes as lights, and its sky. */
static void set_model_light(lua_State *L, const struct render_request *request) {
    const struct scene_light *lights = request->lights;
    for (uint32_t i = 0; i < request->light_count; i++) {
        lua_newtable(L);
        field_numbers(L, "corner", &lights[i].light.corner.x, 3);
        field_numbers(L, "v1", &lights[i].light.edge1.x, 3);
        field_numbers(L, "v2", &lights[i].light.edge2.x, 3);
        field_numbers(L, "emission", &lights[i].light.colour.r, 3);
        field_flag(L, "visible", true);
        scene_write_object(L, &lights[i], "area_light");
        push_writer(L, "add_light");
        lua_pushlightuserdata(L, (void *)(uintptr_t)&lights[i]);
        lua_call(L, 1, 0);
    }
    field_numbers(L, "background", &request->sky.colour.r, 3);
    field_numbers(L, "ambient", &request->ambient.r, 3);
}

/* The camera of a model is fitted to a part of the scene. */
static void set_model_camera(lua_State *L, const struct render_request *request) {
    const struct lens *lens = &request->settings.lens;
    field_numbers(L, "eye", &request->camera.eye.x, 3);
    field_numbers(L, request->settings.view_is_target ? "target" : "view", &request->camera.view.x, 3);
    field_number(L, "fov", request->camera.fov);
    if (lens->projection == PROJECTION_ORTHOGRAPHIC)
        field_number(L, "view_height", lens->view_height);
}

/* Arguments: the request. Returns the text. */
static int write_picture(lua_State *L) {
    const struct render_request *request = lua_touserdata(L, 1);
    struct script_context *context = context_of(L);
    push_writer(L, "picture");
    lua_pushstring(L, context->function->name);
    lua_pushlightuserdata(L, request->root);
    lua_createtable(L, 0, 5);
    field_number(L, "version", SCENE_JSON_VERSION);
    field_flag(L, "classic", !script_of(context)->only_named_pictures);
    field_flag(L, "lua", script_of(context)->host->text_is_lua);
    field_flag(L, "spins", context->scene.spins);
    field_number(L, "time", request->time);
    if (request->frame.number > 0) { /* in seconds already */
        const struct shutter *shutter = &request->settings.shutter;
        field_numbers(L, "shutter", (const double[]){shutter->open, shutter->close}, 2);
    }
    lua_newtable(L);
    if (context->scene.is_model)
        set_model_camera(L, request);
    if (context->scene.is_model && context->scene.studio)
        set_model_light(L, request);
    lua_call(L, 4, 1);
    return 1;
}

bool scene_write_picture(struct script_context *context, const struct render_request *request, struct error *error) {
    lua_State *L = context->sandbox.lua;
    const struct script_host *host = script_of(context)->host;
    size_t length;
    if (request->changed || script_of(context)->changes.views)
        return error_set(error, ERROR_SCENE, "a scene with saved edits cannot be written");
    lua_pushcfunction(L, write_picture);
    lua_pushlightuserdata(L, (void *)(uintptr_t)request);
    limits_resume(&context->sandbox.limits); /* the picture's time does not count, but this does */
    (void)lua_gc(L, LUA_GCSTOP);             /* a third of the time; it runs where memory ends */
    int status = lua_pcall(L, 1, 1, 0);
    (void)lua_gc(L, LUA_GCRESTART);
    limits_pause(&context->sandbox.limits);
    context->sandbox.lua = L;
    const char *text = lua_tolstring(L, -1, &length);
    bool ok = status == LUA_OK && host->write_scene(host->context, request, text, length, error);
    if (status != LUA_OK && sandbox_is_over(&context->sandbox))
        *error = context->sandbox.fatal;
    else if (status != LUA_OK)
        (void)error_set(error, ERROR_SCENE, "%s", text ? text : "out of memory for the text of the scene");
    lua_pop(L, 1);
    return ok;
}

void scene_write_open(lua_State *L) {
    static const luaL_Reg helpers[] = {
        {"address", address}, {"quote", json_quote}, {"forms", forms}, {"image_function", image_function}, {NULL, NULL}};
    embedded_run(L, scene_write_lua, helpers);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &writer);
    context_of(L)->noted = note;
}
