/* pairs in a fixed order. Lua's own order of string keys depends on a random seed, so scenes built from tables would
 * differ from run to run. Here: 1..n in order, other numbers ascending, false, true, strings in byte order, our handles
 * by age, then the rest in Lua's order. A table that is a pure sequence takes one pass and no memory; others cost a
 * list of their keys and a heap sort. Entries removed during the traversal are skipped, as with Lua's own. */
#include "compat/traverse.h"

#include "base/sort.h"
#include "call/handle.h"

#include <assert.h>
#include <lauxlib.h>
#include <string.h>

enum sort_rank { RANK_SEQUENCE, RANK_NUMBER, RANK_BOOLEAN, RANK_STRING, RANK_HANDLE, RANK_OTHER };

/* A key and its order. `slot` is its index in the list of keys and decides between equal keys. */
struct key {
    enum sort_rank rank;
    uint32_t slot;
    union {
        lua_Integer integer; /* sequence, boolean, handle */
        lua_Number number;
        struct {
            const char *bytes;
            size_t size;
        } string;
    };
};

static int compare_bytes(const struct key *a, const struct key *b) {
    size_t size = a->string.size < b->string.size ? a->string.size : b->string.size;
    int order = memcmp(a->string.bytes, b->string.bytes, size);
    if (order != 0)
        return order;
    return a->string.size < b->string.size ? -1 : a->string.size > b->string.size;
}

static bool comes_before(const void *one, const void *other) {
    const struct key *a = one, *b = other;
    if (a->rank != b->rank)
        return a->rank < b->rank;
    int order = 0;
    switch (a->rank) {
    case RANK_SEQUENCE:
    case RANK_BOOLEAN:
    case RANK_HANDLE:
        order = a->integer < b->integer ? -1 : a->integer > b->integer;
        break;
    case RANK_NUMBER:
        order = a->number < b->number ? -1 : a->number > b->number;
        break;
    case RANK_STRING:
        order = compare_bytes(a, b);
        break;
    case RANK_OTHER:
        break;
    }
    return order != 0 ? order < 0 : a->slot < b->slot;
}

static struct key make_key(lua_State *L, int index, lua_Unsigned length, uint32_t slot) {
    struct key key = {.rank = RANK_OTHER, .slot = slot};
    const struct handle *handle;
    switch (lua_type(L, index)) {
    case LUA_TNUMBER:
        if (lua_isinteger(L, index) && (lua_Unsigned)lua_tointeger(L, index) - 1 < length) {
            key.rank = RANK_SEQUENCE;
            key.integer = lua_tointeger(L, index);
        } else {
            key.rank = RANK_NUMBER;
            key.number = lua_tonumber(L, index);
        }
        break;
    case LUA_TBOOLEAN:
        key.rank = RANK_BOOLEAN;
        key.integer = lua_toboolean(L, index);
        break;
    case LUA_TSTRING:
        key.rank = RANK_STRING;
        key.string.bytes = lua_tolstring(L, index, &key.string.size);
        break;
    case LUA_TUSERDATA:
        handle = handle_at(L, index);
        if (handle) {
            key.rank = RANK_HANDLE;
            key.integer = handle->serial;
        }
        break;
    default:
        break;
    }
    return key;
}

/* Of a pure sequence: the control variable is the index. Upvalue 1: the length at the start. */
static int next_in_sequence(lua_State *L) {
    lua_Integer length = lua_tointeger(L, lua_upvalueindex(1)), k = lua_isnoneornil(L, 2) ? 0 : luaL_checkinteger(L, 2);
    luaL_checktype(L, 1, LUA_TTABLE); /* a script may call it with anything */
    while (++k <= length) {
        lua_pushinteger(L, k);
        if (lua_rawgeti(L, 1, k) != LUA_TNIL)
            return 2;
        lua_pop(L, 2);
    }
    lua_pushnil(L);
    return 1;
}

/* Upvalues: the list of keys, their sorted struct keys, how many are visited, how many there are. */
static int next_of_list(lua_State *L) {
    const struct key *keys = lua_touserdata(L, lua_upvalueindex(2));
    lua_Integer k = lua_tointeger(L, lua_upvalueindex(3)), count = lua_tointeger(L, lua_upvalueindex(4));
    luaL_checktype(L, 1, LUA_TTABLE);
    while (k < count) {
        lua_rawgeti(L, lua_upvalueindex(1), (lua_Integer)keys[k++].slot + 1);
        lua_pushvalue(L, -1);
        if (lua_rawget(L, 1) != LUA_TNIL) {
            lua_pushinteger(L, k);
            lua_replace(L, lua_upvalueindex(3));
            return 2;
        }
        lua_pop(L, 2);
    }
    lua_pushinteger(L, k);
    lua_replace(L, lua_upvalueindex(3));
    lua_pushnil(L);
    return 1;
}

/* Whether the keys are 1..n and nothing else; counts them all. */
static bool is_sequence(lua_State *L, int table, lua_Unsigned *length, lua_Unsigned *count) {
    *length = lua_rawlen(L, table);
    *count = 0;
    bool sequence = true;
    for (lua_pushnil(L); lua_next(L, table); lua_pop(L, 1)) {
        ++*count;
        sequence = sequence && lua_isinteger(L, -2) && (lua_Unsigned)lua_tointeger(L, -2) - 1 < *length;
    }
    return sequence;
}

static int fixed_pairs_continue(lua_State *L, int status, lua_KContext context) {
    (void)L;
    (void)status;
    (void)context;
    return 3;
}

static int fixed_pairs(lua_State *L) {
    luaL_checkany(L, 1);
    if (luaL_getmetafield(L, 1, "__pairs") != LUA_TNIL) {
        lua_pushvalue(L, 1);
        lua_callk(L, 1, 3, 0, fixed_pairs_continue);
        return 3;
    }
    luaL_checktype(L, 1, LUA_TTABLE);
    lua_settop(L, 1);
    lua_Unsigned length, count;
    if (is_sequence(L, 1, &length, &count)) {
        lua_pushinteger(L, (lua_Integer)length);
        lua_pushcclosure(L, next_in_sequence, 1);
    } else {
        lua_createtable(L, (int)(count & INT32_MAX), 0); /* a hint; Lua's tables end below 2^32 entries */
        struct key *keys = lua_newuserdatauv(L, (size_t)count * sizeof *keys, 0);
        uint32_t slot = 0;
        for (lua_pushnil(L); slot < count; lua_pop(L, 1)) {
            int more = lua_next(L, 1);
            assert(more); /* they were counted just now */
            (void)more;
            keys[slot] = make_key(L, -2, length, slot);
            lua_pushvalue(L, -2);
            lua_rawseti(L, 2, (lua_Integer)++slot);
        }
        lua_settop(L, 3);
        sort_items(keys, slot, sizeof *keys, comes_before);
        lua_pushinteger(L, 0);
        lua_pushinteger(L, (lua_Integer)slot);
        lua_pushcclosure(L, next_of_list, 4);
    }
    lua_pushvalue(L, 1);
    lua_pushnil(L);
    return 3;
}

void traverse_open(lua_State *L) {
    lua_pushcfunction(L, fixed_pairs);
    lua_setglobal(L, "pairs");
}
