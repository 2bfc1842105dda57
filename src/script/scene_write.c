/* Records the calls of a scene that is written, and writes it: scene_write.lua has the records and the text. */
#include "script/scene_write_internal.h"

#include "base/mem.h"
#include "expr/expr_text.h"
#include "sandbox/embedded.h"
#include "script/gr_model_internal.h"
#include "script/script_internal.h"

#include <lauxlib.h>
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

/* The text as a JSON string; nil if it is not UTF-8. */
static int quote(lua_State *L) {
    size_t length;
    const char *text = luaL_checklstring(L, 1, &length);
    luaL_Buffer out;
    luaL_buffinit(L, &out);
    luaL_addchar(&out, '"');
    for (size_t i = 0; i < length; i++) {
        unsigned char c = (unsigned char)text[i];
        char escape[8];
        size_t more = c < 0x80 ? 0 : c >= 0xf0 && c < 0xf5 ? 3 : c >= 0xe0 ? 2 : c >= 0xc2 ? 1 : 9;
        if (c >= 0xf5 || more > length - i - 1)
            return 0;
        for (size_t k = 1; k <= more; k++)
            if (((unsigned char)text[i + k] & 0xc0) != 0x80)
                return 0;
        if (c == '"' || c == '\\')
            luaL_addchar(&out, '\\');
        if (c < ' ') {
            (void)snprintf(escape, sizeof escape, "\\u%04x", c);
            luaL_addstring(&out, escape);
        } else {
            luaL_addlstring(&out, text + i, more + 1);
        }
        i += more;
    }
    luaL_addchar(&out, '"');
    luaL_pushresult(&out);
    return 1;
}

/* Of a light that came with a model: {model = address of its node, index = number}; nil of any other object. */
static int model_light(lua_State *L) {
    (void)L;
    return 0;
}

/* The text of a program that C owns becomes one of Lua. Arguments: the function, a name, the text, a table. */
static int call_with_code(lua_State *L) {
    lua_pushstring(L, lua_touserdata(L, 3));
    lua_replace(L, 3);
    lua_call(L, 3, 0);
    return 0;
}

/* The function of a picture that texture:at has made, or NULL. */
static int image_function(lua_State *L) {
    const struct script_texture *texture = lua_touserdata(L, 1);
    lua_pushlightuserdata(L, texture->function);
    return 1;
}

/* --- records --- */

/* The program of a Lua function, with its pictures by the addresses of their functions. */
static void note_function(struct script_context *context, const struct script_parameter *p,
                          const struct script_value *value) {
    lua_State *L = context->sandbox.lua;
    struct expr_images images = {0};
    struct error error = {0};
    const struct expr_program *program =
        value->texture ? value->texture->texture->operation.recorded.program : value->program;
    if (!program)
        sandbox_raise(&context->sandbox, "%s is a function that is not recorded, so it cannot be written", p->name);
    push_writer(L, "program");
    lua_pushstring(L, p->name);
    char *code = expr_write_text(program, &images, &error);
    if (!code)
        sandbox_raise_error(&context->sandbox, &error);
    lua_pushlightuserdata(L, code);
    lua_createtable(L, images.count, 0);
    for (int k = 0; k < images.count; k++) {
        lua_pushlightuserdata(L, (void *)(uintptr_t)images.items[k]);
        lua_rawseti(L, -2, k + 1);
    }
    lua_pushcfunction(L, call_with_code);
    lua_insert(L, -5);
    int status = lua_pcall(L, 4, 0, 0);
    mem_free(code);
    if (status != LUA_OK)
        lua_error(L);
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
    note_rest(context, function, args);
    if (function->owner == OWNER_NODE && function->result == RESULT_SELF) {
        push_writer(L, "called");
        lua_pushlightuserdata(L, args[SELF].node);
        lua_pushstring(L, function->name);
        lua_pushstring(L, orders[context->scene.order]);
        lua_newtable(L);
        for (int i = 0; i < FORM_LIMIT && function->forms[i]; i++) {
            lua_pushstring(L, function->forms[i]);
            lua_rawseti(L, -2, i + 1);
        }
        lua_call(L, 4, 0);
    } else if (function->owner == OWNER_GR && result->pointer) {
        push_writer(L, "made");
        lua_pushlightuserdata(L, result->pointer);
        lua_pushstring(L, function->name);
        lua_call(L, 2, 0);
    }
}

/* --- pictures --- */

/* Arguments: the request. Returns the text. */
static int write_picture(lua_State *L) {
    const struct render_request *request = lua_touserdata(L, 1);
    struct script_context *context = context_of(L);
    push_writer(L, "picture");
    lua_pushstring(L, context->function->name);
    lua_pushlightuserdata(L, request->root);
    lua_createtable(L, 0, 3);
    lua_pushboolean(L, !script_of(context)->only_named_pictures);
    lua_setfield(L, -2, "classic");
    lua_pushnumber(L, request->time);
    lua_setfield(L, -2, "time");
    if (request->frame.number > 0) { /* in seconds already */
        lua_createtable(L, 2, 0);
        lua_pushnumber(L, request->settings.shutter.open);
        lua_rawseti(L, -2, 1);
        lua_pushnumber(L, request->settings.shutter.close);
        lua_rawseti(L, -2, 2);
        lua_setfield(L, -2, "shutter");
    }
    lua_call(L, 3, 1);
    return 1;
}

bool scene_write_picture(struct script_context *context, const struct render_request *request, struct error *error) {
    lua_State *L = context->sandbox.lua;
    const struct script_host *host = script_of(context)->host;
    size_t length;
    if (request->changed)
        return error_set(error, ERROR_SCENE, "a scene with saved edits cannot be written");
    lua_pushcfunction(L, write_picture);
    lua_pushlightuserdata(L, (void *)(uintptr_t)request);
    int status = lua_pcall(L, 1, 1, 0);
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
    static const luaL_Reg helpers[] = {{"address", address},
                                       {"quote", quote},
                                       {"image_function", image_function},
                                       {"model_light", model_light},
                                       {NULL, NULL}};
    embedded_run(L, scene_write_lua, helpers);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &writer);
    context_of(L)->noted = note;
}
