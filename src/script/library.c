/* Scripts use names of Lua's libraries for their own things (`table = gr.node('table')`). The modules that come with
 * the program must not stumble over that: their files see the globals as they were before the script began. What such a
 * file adds (`readobj`) becomes a global of the script, and names it does not find are looked for there. */
#include "script/context.h"

#include "base/file.h"

#include <string.h>

static const char key = 0; /* the table stands in the registry under its address */

void library_open(lua_State *L) {
    lua_newtable(L);
    lua_pushglobaltable(L);
    for (lua_pushnil(L); lua_next(L, -2);) {
        lua_pushvalue(L, -2);
        lua_insert(L, -2); /* the table, _G, key, key, value */
        lua_rawset(L, -5);
    }
    lua_createtable(L, 0, 2);
    lua_pushvalue(L, -2);
    lua_setfield(L, -2, "__index");
    lua_insert(L, -2);
    lua_setfield(L, -2, "__newindex");
    lua_setmetatable(L, -2);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &key);
}

void library_adopt(lua_State *L, const char *path) {
    const char *folder = context_of(L)->options->library_folder;
    char library[PATH_SIZE], file[PATH_SIZE];
    if (!folder || !folder[0] || !file_canonical(folder, library, sizeof library) ||
        !file_canonical(path, file, sizeof file))
        return;
    size_t length = strlen(library);
    if (strncmp(file, library, length) != 0 || file[length] != '/')
        return;
    lua_rawgetp(L, LUA_REGISTRYINDEX, &key);
    if (!lua_setupvalue(L, -2, 1))
        lua_pop(L, 1);
}
