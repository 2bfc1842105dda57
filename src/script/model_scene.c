/* A model on the command line is the argument of a scene that gray holds (model_scene.lua); what it needs of gray. */
#include "script/model_scene_internal.h"

#include "base/lua_fields.h"
#include "sandbox/embedded.h"
#include "script/gr_model_internal.h"
#include "script/script_internal.h"
#include "script/studio_internal.h"
#include "settings/setting.h"

#include <lauxlib.h>
#include <string.h>

extern const char *const model_scene_lua[];

/* Whether the command line sets the field of gr.render, and the text of its option. */
static int chosen(lua_State *L) {
    const struct script_options *options = sandbox_of(L)->options;
    const char *field = luaL_checkstring(L, 1);
    for (int i = 0; i < setting_field_count; i++) {
        if (strcmp(setting_table[i].field, field) != 0)
            continue;
        lua_pushboolean(L, script_option_chosen(options, i));
        return 1;
    }
    return 0;
}

static int is_animated(lua_State *L) {
    lua_pushboolean(L, models_find(context_of(L), handle_at(L, 1)->pointer)->animations.count > 0);
    return 1;
}

static int fit_to(lua_State *L) {
    script_of(context_of(L))->fitted = handle_at(L, 1)->pointer;
    return 0;
}

/* The kd of the ground, from the direction of view. */
static int ground(lua_State *L) {
    const struct script *script = script_of(context_of(L));
    struct vec3 view = {luaL_optnumber(L, 1, 0), luaL_optnumber(L, 2, 0), luaL_optnumber(L, 3, 0)};
    struct settings settings = script->host->settings;
    int integrator = SETTING_INDEX(integrator);
    if (!script_option_chosen(script->context.sandbox.options, integrator))
        settings.integrator = INTEGRATOR_PATH;
    lua_pushnumber(L, studio_ground(&settings, view));
    return 1;
}

/* The light of the model's lights in its middle: of a node, its middle and its radius. */
static int light_in_middle(lua_State *L) {
    const struct script_context *context = context_of(L);
    const struct model *model = models_find(context, handle_at(L, 1)->pointer);
    struct transform turn = models_turn(context);
    struct vec3 middle = {luaL_checknumber(L, 2), luaL_checknumber(L, 3), luaL_checknumber(L, 4)};
    lua_pushnumber(L, models_light_at(model, affine_point(&turn.inverse, middle), luaL_checknumber(L, 5)));
    return 1;
}

/* Ends the run with a complete message: about the file, or with a second argument about the command line. */
static int fail(lua_State *L) {
    struct sandbox *sandbox = sandbox_enter(L);
    struct error error = {0};
    (void)error_set(&error, lua_isnoneornil(L, 2) ? ERROR_SCENE : ERROR_USAGE, "%s", luaL_checkstring(L, 1));
    (void)error_elsewhere(&error);
    sandbox_raise_error(sandbox, &error);
}

/* Adds a name and what comes before it. */
static void add_name(luaL_Buffer *out, const char *before, const char *name) {
    luaL_addstring(out, before);
    luaL_addchar(out, '\'');
    for (; *name; name++)
        luaL_addchar(out, (unsigned char)*name < ' ' || *name == 0x7f ? '?' : *name);
    luaL_addchar(out, '\'');
}

/* The names in the model of a node, a line for each kind. Materials without a name are left out: nothing can name
 * them. */
static int contents(lua_State *L) {
    const struct model *model = models_find(context_of(L), handle_at(L, 1)->pointer);
    const char *before;
    luaL_Buffer out;
    luaL_buffinit(L, &out);
#define NAMES(member, all)                                                                                             \
    before = #member ": ";                                                                                             \
    for (size_t i = 0; i < model->member.count; i++) {                                                                 \
        const char *name = model_##member(model)[i].name;                                                              \
        if (!(all) && !(name && name[0]))                                                                              \
            continue;                                                                                                  \
        add_name(&out, before, name);                                                                                  \
        before = ", ";                                                                                                 \
    }                                                                                                                  \
    luaL_addstring(&out, before[0] == ',' ? "\n" : #member ": none\n");
    NAMES(cameras, true)
    NAMES(lights, true)
    NAMES(materials, false)
    NAMES(animations, true)
#undef NAMES
    luaL_pushresult(&out);
    return 1;
}

void model_scene_run(lua_State *L) {
    static const luaL_Reg helpers[] = {{"chosen", chosen},
                                       {"ground", ground},
                                       {"fail", fail},
                                       {"is_animated", is_animated},
                                       {"fit_to", fit_to},
                                       {"contents", contents},
                                       {"light_in_middle", light_in_middle},
                                       {NULL, NULL}};
    const struct script *script = script_of(context_of(L));
    const struct script_options *options = script->context.sandbox.options;
    const char *path = script->context.sandbox.files.path, *slash = strrchr(path, '/');
    embedded_run(L, model_scene_lua, helpers);
    lua_getfield(L, LUA_REGISTRYINDEX, LUA_LOADED_TABLE); /* -D may have replaced the global */
    lua_getfield(L, -1, "gr");
    lua_remove(L, -2);
    lua_pushstring(L, path);
    lua_pushstring(L, slash ? slash + 1 : path);
    lua_createtable(L, 0, 5);
    field_text(L, "camera", options->camera);
    field_flag(L, "sky", options->sky != NULL);
    field_flag(L, "checks", script->host->checks);
    field_flag(L, "moves", script->host->frame.number > 0);
    struct frame last = script->host->frame;
    last.number = last.count;
    field_number(L, "seconds", frame_time(&last));
    lua_call(L, 4, 0);
}
