/* The Lua libraries of a scene. Scenes are untrusted: the lists below name the functions that are known to be harmless;
 * everything else in a library (of this or a later Lua) is removed. No function starts programs, loads machine code or
 * byte code, changes the locale or reads the environment; debug only shows the position of a script. Functions for
 * files are in files.c and streams.c, functions that could catch or avoid a limit in protect.c. With --no-sandbox
 * nothing is removed. */
#include "sandbox/libraries_internal.h"

#include "math/elementary.h"
#include "math/exact.h"
#include "sandbox/embedded.h"
#include "sandbox/sandbox.h"

#include <assert.h>
#include <lauxlib.h>
#include <lualib.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* os.exit ends the script, not the program: finished pictures are kept, and the next script runs. */
static int end_script(lua_State *L) {
    struct sandbox *sandbox = sandbox_of(L);
    sandbox->lua = L;
    bool well = lua_isnoneornil(L, 1) || (lua_isboolean(L, 1) ? lua_toboolean(L, 1) : luaL_checkinteger(L, 1) == 0);
    if (!well) {
        char where[PATH_SIZE + 32];
        sandbox_where(sandbox, where, sizeof where);
        error_set(&sandbox->fatal, ERROR_SCENE, "%sos.exit: the script reports a failure", where);
    }
    sandbox->ended = true;
    sandbox_raise_fatal(L);
}

/* debug.getinfo([thread,] function or level [, what]): source, short_src, currentline, and nothing that can be
 * called. */
static int position_info(lua_State *L) {
    lua_State *from = L;
    int at = 1;
    lua_Debug frame;
    /* The coroutine is an optional first argument. */
    if (lua_isthread(L, 1)) {
        from = lua_tothread(L, 1);
        at = 2;
    }
    /* A function, or a level of the stack. */
    if (lua_isfunction(L, at)) {
        lua_pushvalue(L, at);
        lua_xmove(L, from, 1);
        lua_getinfo(from, ">Sl", &frame);
    } else {
        lua_Integer level = luaL_checkinteger(L, at);
        if (level < 0 || level > 1000000 || !lua_getstack(from, (int)level, &frame)) {
            lua_pushnil(L);
            return 1;
        }
        lua_getinfo(from, "Sl", &frame);
    }
    /* The position only. */
    lua_createtable(L, 0, 3);
    lua_pushlstring(L, frame.source, frame.srclen);
    lua_setfield(L, -2, "source");
    lua_pushstring(L, frame.short_src);
    lua_setfield(L, -2, "short_src");
    lua_pushinteger(L, frame.currentline);
    lua_setfield(L, -2, "currentline");
    return 1;
}

/* The environment may contain secrets; only variables for this program are visible. */
static int environment_variable(lua_State *L) {
    const char *name = luaL_checkstring(L, 1);
    lua_pushstring(L, strncmp(name, "GRAY_", 5) == 0 ? getenv(name) : NULL);
    return 1;
}

/* Generational collection has been the source of most memory errors of Lua 5.4 (lua.org/bugs.html): a request for it
 * has a result but no effect. Upvalue 1: Lua's own function. */
static int collect_garbage(lua_State *L) {
    const char *option = luaL_optstring(L, 1, "collect");
    if (strcmp(option, "generational") == 0 || strcmp(option, "incremental") == 0) {
        lua_pushliteral(L, "incremental");
        return 1;
    }
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    lua_call(L, lua_gettop(L) - 1, LUA_MULTRET);
    return lua_gettop(L);
}

/* Lua's warn(text, ...), with the line of the scene. Control messages ("@on") have no effect. */
static int warn(lua_State *L) {
    for (int k = 1; k == 1 || k <= lua_gettop(L); k++)
        (void)luaL_checkstring(L, k);
    lua_concat(L, lua_gettop(L));
    if (*lua_tostring(L, 1) == '@')
        return 0;
    struct sandbox *sandbox = sandbox_of(L);
    const struct running_function outer = sandbox->running; /* it does not warn */
    sandbox->running = (struct running_function){0};
    sandbox_warn(sandbox, "%s", lua_tostring(L, 1));
    sandbox->running = outer;
    return 0;
}

struct allowed {
    const char *library, *names; /* separated by blanks, one before and one after */
};

static const struct allowed allowed_names[] = {
    {LUA_GNAME, " _G _VERSION assert collectgarbage dofile error getmetatable ipairs load loadfile next pairs pcall "
                "print rawequal rawget rawlen rawset require select setmetatable tonumber tostring type warn xpcall "
                "coroutine debug io math os package string table utf8 "},
    {LUA_COLIBNAME, " close create isyieldable resume running status wrap yield "},
    {LUA_TABLIBNAME, " concat insert move pack remove sort unpack "},
    {LUA_STRLIBNAME,
     " byte char dump find format gmatch gsub len lower match pack packsize rep reverse sub unpack upper "},
    {LUA_MATHLIBNAME, " abs acos asin atan atan2 ceil cos cosh deg exp floor fmod frexp huge ldexp log log10 max "
                      "maxinteger min mininteger modf pi pow rad random randomseed sin sinh sqrt tan tanh tointeger "
                      "type ult "},
    {LUA_UTF8LIBNAME, " char charpattern codepoint codes len offset "},
    {LUA_OSLIBNAME, " clock date difftime exit getenv remove rename time "},
    {LUA_IOLIBNAME, " close flush input lines open output read stderr stdin stdout type write "},
    {LUA_LOADLIBNAME, " config cpath loaded path preload searchers searchpath "},
    {LUA_DBLIBNAME, " getinfo traceback "},
};

/* Functions of Lua 5.4 that older versions did not have. */
static const struct allowed removed_names[] = {
    {LUA_OSLIBNAME, " execute setlocale tmpname "},
    {LUA_IOLIBNAME, " popen tmpfile "},
    {LUA_LOADLIBNAME, " loadlib "},
    {LUA_DBLIBNAME, " debug gethook getlocal getmetatable getregistry getupvalue getuservalue sethook setlocal "
                    "setmetatable setupvalue setuservalue upvalueid upvaluejoin "},
};

static bool is_allowed(const char *names, const char *name) {
    char word[64];
    int length = snprintf(word, sizeof word, " %s ", name);
    return (size_t)length < sizeof word && strstr(names, word);
}

bool libraries_lack(const char *library, const char *name) {
    for (size_t k = 0; k < sizeof removed_names / sizeof removed_names[0]; k++)
        if (strcmp(removed_names[k].library, library) == 0 && is_allowed(removed_names[k].names, name))
            return true;
    return false;
}

static void keep_allowed(lua_State *L, const struct allowed *allowed) {
    lua_getglobal(L, allowed->library);
    lua_pushnil(L);
    while (lua_next(L, -2)) {
        lua_pop(L, 1);
        assert(lua_type(L, -1) == LUA_TSTRING);
        if (is_allowed(allowed->names, lua_tostring(L, -1)))
            continue;
        lua_pushvalue(L, -1); /* a field may be cleared while its table is traversed */
        lua_pushnil(L);
        lua_rawset(L, -4);
    }
    lua_pop(L, 1);
}

static void set_function(lua_State *L, const char *library, const char *name, lua_CFunction function) {
    lua_getglobal(L, library);
    lua_pushcfunction(L, function);
    lua_setfield(L, -2, name);
    lua_pop(L, 1);
}

void libraries_take_nan(lua_State *L) {
    for (int k = 1; k <= lua_gettop(L); k++)
        if (lua_type(L, k) == LUA_TNUMBER && isnan(lua_tonumber(L, k))) {
            lua_pushnumber(L, invalid());
            lua_replace(L, k);
        }
}

/* string.pack: the bytes of a NaN are the same on every machine. Upvalue 1: Lua's own. */
static int pack(lua_State *L) {
    libraries_take_nan(L);
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    lua_call(L, lua_gettop(L) - 1, 1);
    return 1;
}

void libraries_open(lua_State *L) {
    static const luaL_Reg libraries[] = {
        {LUA_GNAME, luaopen_base},        {LUA_LOADLIBNAME, luaopen_package}, {LUA_COLIBNAME, luaopen_coroutine},
        {LUA_TABLIBNAME, luaopen_table},  {LUA_IOLIBNAME, luaopen_io},        {LUA_OSLIBNAME, luaopen_os},
        {LUA_STRLIBNAME, luaopen_string}, {LUA_MATHLIBNAME, luaopen_math},    {LUA_UTF8LIBNAME, luaopen_utf8},
        {LUA_DBLIBNAME, luaopen_debug},
    };
    for (size_t k = 0; k < sizeof libraries / sizeof libraries[0]; k++) {
        luaL_requiref(L, libraries[k].name, libraries[k].func, 1);
        lua_pop(L, 1);
    }
    embedded_open(L);
    set_function(L, "os", "exit", end_script);
    set_function(L, LUA_GNAME, "warn", warn);
    lua_getglobal(L, LUA_STRLIBNAME);
    lua_getfield(L, -1, "pack");
    lua_pushcclosure(L, pack, 1);
    lua_setfield(L, -2, "pack");
    lua_pop(L, 1);
    if (sandbox_of(L)->options->no_sandbox)
        return;
    for (size_t k = 0; k < sizeof allowed_names / sizeof allowed_names[0]; k++)
        keep_allowed(L, &allowed_names[k]);
    set_function(L, "debug", "getinfo", position_info);
    set_function(L, "os", "getenv", environment_variable);
    lua_getglobal(L, "collectgarbage");
    lua_pushcclosure(L, collect_garbage, 1);
    lua_setglobal(L, "collectgarbage");
    /* Files are userdata with finalizers; a script that could reach their metatable could replace the finalizer. */
    luaL_getmetatable(L, LUA_FILEHANDLE);
    lua_pushliteral(L, "file");
    lua_setfield(L, -2, "__metatable");
    lua_pop(L, 1);
}

/* Makes Lua use the project's elementary functions.
 *
 * Lua's library and its ^ operator call libm, whose last bits differ between processors; scene scripts place things
 * with them, so pictures would differ too. Symbols defined by the executable come before those of shared libraries (ELF
 * interposition; System V ABI, "Shared Object Dependencies"), and before archive members when Lua is linked statically:
 * either way Lua finds these.
 *
 * Covered is every inexact libm function that Lua 5.4 refers to in any configuration (compatibility functions
 * included); floor, ceil, sqrt, fmod, frexp and ldexp are exact and stay the library's. Compile with -fno-builtin, so
 * that the compiler does not take these definitions for the functions it knows. Arguments and results as in <math.h>,
 * except that errno is left alone. */

#define LIBM_ONE(name)                                                                                                 \
    __attribute__((visibility("default"))) double name(double x);                                                      \
    double name(double x) {                                                                                            \
        return el_##name(x);                                                                                           \
    }
#define LIBM_TWO(name)                                                                                                 \
    __attribute__((visibility("default"))) double name(double x, double y);                                            \
    double name(double x, double y) {                                                                                  \
        return el_##name(x, y);                                                                                        \
    }

LIBM_ONE(sin)
LIBM_ONE(cos)
LIBM_ONE(tan)
LIBM_ONE(asin)
LIBM_ONE(acos)
LIBM_TWO(atan2)
LIBM_ONE(exp)
LIBM_ONE(log)
LIBM_ONE(log2)
LIBM_ONE(log10)
LIBM_TWO(pow)
LIBM_ONE(sinh)
LIBM_ONE(cosh)
LIBM_ONE(tanh)

/* Makes Lua write a NaN as "nan" on every machine.
 *
 * Of 0/0 x86-64 makes a NaN with a sign and ARM one without; the C library writes the sign as "-nan", and a script can
 * read it. Lua turns every number into text by snprintf, or by its checked form where Lua was compiled so, with a
 * format of one conversion: tostring, "..", string.format. Here a NaN loses its sign first. */

static int write_text(char *text, size_t size, const char *format, va_list arguments) {
    const char *conversion = format[0] == '%' ? format + 1 + strspn(format + 1, "-+ #0123456789.") : "";
    bool one_number = conversion[0] && strchr("aAeEfFgG", conversion[0]) && !conversion[1];
    if (one_number) {
        va_list copy;
        va_copy(copy, arguments);
        double number = va_arg(copy, double);
        va_end(copy);
        if (isnan(number) && signbit(number))
            return snprintf(text, size, format, -number);
    }
    return vsnprintf(text, size, format, arguments);
}

__attribute__((visibility("default"))) int snprintf(char *text, size_t size, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    int length = write_text(text, size, format, arguments);
    va_end(arguments);
    return length;
}

__attribute__((visibility("default"))) int __snprintf_chk(char *text, size_t size, int flag, size_t room,
                                                          const char *format, ...);
int __snprintf_chk(char *text, size_t size, int flag, size_t room, const char *format, ...) {
    (void)flag;
    va_list arguments;
    va_start(arguments, format);
    int length = write_text(text, size < room ? size : room, format, arguments);
    va_end(arguments);
    return length;
}
