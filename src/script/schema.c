/* --json-schema: schema.lua writes it from the table of functions, which it gets here. */
#include "script/schema.h"

#include "base/document.h"
#include "base/lua_fields.h"
#include "sandbox/embedded.h"
#include "script/scene_json_internal.h"
#include "script/table_internal.h"

#include <lauxlib.h>
#include <lualib.h>

extern const char *const schema_lua[];

static void push_parameter(lua_State *L, const struct script_parameter *p) {
    static const struct {
        unsigned flag;
        const char *name;
    } others[] = {{OR_TEXTURE, "texture"},
                  {OR_PROFILE | OR_FUNCTION, "texture"},
                  {OR_NUMBER, "kind.number"},
                  {OR_FILE, "kind.file"},
                  {OR_COMPASS, "compass"},
                  {OR_PAIR, "kind.interval"},
                  {OR_SKY, "sky"}};
    lua_newtable(L);
    field_text(L, "name", p->name);
    field_text(L, "kind", kind_name(p->kind));
    field_text(L, "help", p->help);
    field_text(L, "choices", p->choices ? p->choices : "");
    field_number(L, "low", p->low);
    field_number(L, "high", p->high);
    field_flag(L, "low_open", p->flags & LOW_OPEN);
    field_flag(L, "high_open", p->flags & HIGH_OPEN);
    field_flag(L, "optional", p->flags & OPTIONAL);
    lua_newtable(L);
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        if (!(p->flags & others[i].flag))
            continue;
        lua_pushstring(L, others[i].name);
        lua_rawseti(L, -2, (lua_Integer)lua_rawlen(L, -2) + 1);
    }
    lua_setfield(L, -2, "others");
}

static void push_function(lua_State *L, const struct script_function *function) {
    static const char *const results[] = {RESULT_KINDS(LIST_WORD)};
    const int first = function->owner == OWNER_NODE; /* behind the node itself */
    int unused;
    lua_newtable(L);
    field_text(L, "name", function->name);
    field_text(L, "owner", first ? "node" : "gr");
    field_text(L, "result", results[function->result]);
    field_flag(L, "renders", function_renders(function));
    field_flag(L, "has_rest", function_rest(function, &unused));
    lua_newtable(L);
    for (int k = first; k < function->parameter_count; k++) {
        push_parameter(L, &function->parameters[k]);
        lua_rawseti(L, -2, k - first + 1);
    }
    lua_setfield(L, -2, "parameters");
}

static int write_schema(lua_State *L) {
    static const luaL_Reg none[] = {{NULL, NULL}};
    luaL_openlibs(L);
    embedded_open(L);
    embedded_run(L, schema_lua, none);
    lua_newtable(L);
    for (int k = 0; k < function_count(); k++) {
        push_function(L, function_at(k));
        lua_rawseti(L, -2, k + 1);
    }
    lua_pushinteger(L, SCENE_JSON_VERSION);
    lua_call(L, 2, 1);
    return 1;
}

void script_json_schema(struct document *document) {
    lua_State *L = luaL_newstate();
    document->failed = !L;
    if (!L)
        return;
    lua_pushcfunction(L, write_schema);
    if (lua_pcall(L, 0, 1, 0) == LUA_OK)
        document_lines(document, lua_tostring(L, -1));
    else
        document->failed = true;
    lua_close(L);
}
