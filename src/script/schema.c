/* --json-schema: schema.lua writes it from the table of functions, which it gets here. */
#include "script/schema.h"

#include "base/document.h"
#include "base/json_write.h"
#include "sandbox/embedded.h"
#include "script/scene_json_internal.h"
#include "script/table_internal.h"

#include <lauxlib.h>
#include <lualib.h>

extern const char *const schema_lua[];

static int write_schema(lua_State *L) {
    static const luaL_Reg helpers[] = {{"quote", json_quote}, {NULL, NULL}};
    luaL_openlibs(L);
    embedded_open(L);
    embedded_run(L, schema_lua, helpers);
    lua_newtable(L);
    for (int k = 0; k < function_count(); k++) {
        function_push(L, function_at(k));
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
