/* Hints are Lua (hints.lua), in a state of their own: it runs while the state of the script handles an error, and
 * outside of its limits. Of that state only values are read, in ways that allocate nothing and so cannot raise. */
#include "sandbox/hints.h"

#include "base/file.h"
#include "base/suggestion.h"
#include "sandbox/embedded.h"
#include "sandbox/lexer.h"
#include "sandbox/libraries_internal.h"
#include "sandbox/sandbox.h"

#include <lualib.h>
#include <stdlib.h>
#include <string.h>

enum { READ_AGAIN_LIMIT = 1 << 26 };

extern const char *const hints_lua[];

/* A call of a function of hints.lua, and its answer. */
struct question {
    const char *function, *texts[2];
    const char *const *names; /* the last argument, a list */
    size_t count;
    lua_State *script; /* its running function: `at` */
    lua_Debug at;
    struct nil_field *answer;
};

/* --- what Lua calls --- */

static struct question *question_of(lua_State *H) {
    lua_rawgetp(H, LUA_REGISTRYINDEX, hints_lua);
    struct question *question = lua_touserdata(H, -1);
    lua_pop(H, 1);
    return question;
}

/* A name that the running function sees, with the value on top of its state: into the table on H, or at `slot` there if
 * it is the wanted one. Returns whether it is. */
static bool see(lua_State *H, lua_State *L, const char *name, const char *wanted, int slot) {
    bool same = wanted && strcmp(name, wanted) == 0;
    if (same)
        lua_copy(L, -1, slot);
    if (!wanted && name[0] != '(') {
        lua_pushboolean(H, !lua_isnil(L, -1));
        lua_setfield(H, -2, name);
    }
    return same;
}

/* Sees the globals, the upvalues and the local variables, the last of a name last. wanted: pushes its value on the
 * other state. Returns whether that is a global. */
static bool visit_names(lua_State *H, const char *wanted) {
    const struct question *question = question_of(H);
    lua_State *L = question->script;
    lua_Debug at = question->at;
    const char *name;
    int slot = lua_gettop(L) + 1;
    lua_pushnil(L);
    lua_getinfo(L, "f", &at);
    lua_rawgeti(L, LUA_REGISTRYINDEX, LUA_RIDX_GLOBALS);
    bool is_global = true;
    for (lua_pushnil(L); lua_next(L, slot + 2); lua_pop(L, 1))
        if (lua_type(L, -2) == LUA_TSTRING)
            (void)see(H, L, lua_tostring(L, -2), wanted, slot);
    for (int n = 1; (name = lua_getupvalue(L, slot + 1, n)) != NULL; lua_pop(L, 1), n++)
        is_global &= !see(H, L, name, wanted, slot);
    for (int n = 1; (name = lua_getlocal(L, &at, n)) != NULL; lua_pop(L, 1), n++)
        is_global &= !see(H, L, name, wanted, slot);
    lua_settop(L, slot);
    return is_global;
}

/* Returns the file of the running function, the line, and whether it begins there; nothing if none runs or its globals
 * are not those of the script: other environments may have more names. */
static int running(lua_State *H) {
    struct question *question = question_of(H);
    lua_State *L = question->script;
    if (!lua_checkstack(L, 20) || !sandbox_find_frame(L, &question->at) || question->at.source[0] != '@')
        return 0;
    bool is_global = visit_names(H, "_ENV");
    lua_rawgeti(L, LUA_REGISTRYINDEX, LUA_RIDX_GLOBALS);
    bool usual = is_global || lua_rawequal(L, -1, -2); /* a function that uses no global has no _ENV */
    lua_pop(L, 2);
    if (!usual)
        return 0;
    lua_pushstring(H, question->at.source + 1);
    lua_pushinteger(H, question->at.currentline);
    lua_pushboolean(H, question->at.linedefined == question->at.currentline);
    return 3;
}

/* Returns the names that the running function sees: true if they have a value. */
static int variables(lua_State *H) {
    lua_newtable(H);
    (void)visit_names(H, NULL);
    return 1;
}

/* keys(VARIABLE): the list of its names if it is a table, else nil; and whether it is a global. */
static int keys(lua_State *H) {
    lua_State *L = question_of(H)->script;
    bool is_global = visit_names(H, lua_tostring(H, 1));
    if (lua_istable(L, -1))
        lua_newtable(H);
    else
        lua_pushnil(H);
    lua_Integer count = 0;
    for (lua_pushnil(L); lua_istable(L, -2) && lua_next(L, -2); lua_pop(L, 1)) {
        if (lua_type(L, -2) != LUA_TSTRING)
            continue;
        lua_pushstring(H, lua_tostring(L, -2));
        lua_rawseti(H, -2, ++count);
    }
    lua_pushboolean(H, is_global);
    return 2;
}

/* read(path, line, limit): the text from the line on, or nil. */
static int read_text(lua_State *H) {
    struct sandbox *sandbox = sandbox_of(H);
    const char *path = lua_tostring(H, 1);
    size_t limit = (size_t)lua_tointeger(H, 3);
    struct file_bytes bytes;
    struct error error = {0};
    if (!path_policy_map(files_policy(sandbox, path), path, FILE_LIMIT, &bytes, &error))
        return 0;
    const char *from = (const char *)bytes.data, *end = from + bytes.size;
    sandbox->hint_bytes += bytes.size;
    for (lua_Integer line = 1; from && line < lua_tointeger(H, 2); line++) {
        from = memchr(from, '\n', (size_t)(end - from));
        from += from != NULL;
    }
    size_t left = from ? (size_t)(end - from) : 0, size = left < limit ? left : limit;
    const char *copy = from ? arena_copy_text(&sandbox->call, from, size) : NULL;
    file_unmap(&bytes); /* before anything may raise */
    lua_pushlstring(H, copy, copy ? size : 0);
    return copy != NULL;
}

/* tokens(text, statement): a list of {KIND = text, line =, at =, begins =}; `statement`: up to the end of the first
 * line, or of its last bracket, and some more. */
static int tokens(lua_State *H) {
    static const char *const kinds[] = {
        [TOKEN_NAME] = "name", [TOKEN_STRING] = "string", [TOKEN_NUMBER] = "number", [TOKEN_SYMBOL] = "symbol"};
    size_t size;
    const char *text = lua_tolstring(H, 1, &size);
    struct lexer lexer = {text, text + size, 1};
    struct token token;
    int depth = 0, more = lua_toboolean(H, 2) ? 4 : -1;
    lua_settop(H, 1);
    lua_newtable(H);
    for (lua_Integer n = 1; more != 0 && (token = lexer_next(&lexer)).kind != TOKEN_END; n++) {
        /* Brackets; `more` tokens follow the end of the statement. */
        depth += token_is_symbol(&token, '(') || token_is_symbol(&token, '{');
        depth -= token_is_symbol(&token, ')') || token_is_symbol(&token, '}');
        more -= token.line > 1 && depth <= 0;
        /* The table of the token. */
        lua_createtable(H, 0, 4);
        lua_pushlstring(H, token.text, token.length);
        lua_setfield(H, -2, kinds[token.kind]);
        lua_pushinteger(H, token.line);
        lua_setfield(H, -2, "line");
        lua_pushinteger(H, token.text - text + 1);
        lua_setfield(H, -2, "at");
        lua_pushboolean(H, token.text == text || token.text[-1] == '\n');
        lua_setfield(H, -2, "begins");
        lua_rawseti(H, 2, n);
    }
    return 1;
}

/* nearest(word, list): the most similar of them, or nil. */
static int nearest(lua_State *H) {
    struct suggestion suggestion;
    suggest_begin(&suggestion, lua_tostring(H, 1));
    for (lua_Integer n = 1; lua_rawgeti(H, 2, n) == LUA_TSTRING; n++) {
        suggest_offer(&suggestion, lua_tostring(H, -1)); /* the list keeps it */
        lua_pop(H, 1);
    }
    lua_pushstring(H, suggestion.best);
    return 1;
}

static int lacks(lua_State *H) {
    lua_pushboolean(H, !sandbox_of(H)->options->no_sandbox && libraries_lack(lua_tostring(H, 1), lua_tostring(H, 2)));
    return 1;
}

static int refused(lua_State *H) {
    const char *words = sandbox_of(H)->refused;
    lua_pushstring(H, words[0] ? words : NULL);
    return 1;
}

/* The file that the position at the start of a message is in, or nil. */
static int source_of(lua_State *H) {
    const char *message = lua_tostring(H, 1);
    const struct source_name *source = sandbox_of(H)->files.sources;
    while (source &&
           (strncmp(message, source->path, strlen(source->path)) != 0 || message[strlen(source->path)] != ':'))
        source = source->next;
    lua_pushstring(H, source ? source->path : NULL);
    return 1;
}

/* The paths of the dialects of the library; none if one is in use. */
static int dialects(lua_State *H) {
    struct sandbox *sandbox = sandbox_of(H);
    const char *library = sandbox->options->library_folder;
    struct path_policy_entry *entries;
    char path[PATH_SIZE];
    size_t count = 0;
    lua_newtable(H);
    if (library && !sandbox->files.dialect && snprintf(path, sizeof path, "%s/dialects", library) < PATH_SIZE)
        count = path_policy_list(sandbox->path_policy, path, 1000, &sandbox->call, &entries);
    for (size_t i = 0; i < count; i++) {
        lua_pushfstring(H, "%s/%s", path, entries[i].name);
        lua_rawseti(H, 1, (lua_Integer)i + 1);
    }
    return 1;
}

/* --- the call --- */

/* Argument 1: the question. */
static int answer(lua_State *H) {
    static const luaL_Reg helpers[] = {
        {"running", running},     {"variables", variables}, {"keys", keys},   {"read", read_text},
        {"tokens", tokens},       {"nearest", nearest},     {"lacks", lacks}, {"refused", refused},
        {"source_of", source_of}, {"dialects", dialects},   {NULL, NULL}};
    struct question *question = lua_touserdata(H, 1);
    struct arena *arena = &sandbox_of(H)->call;
    if (lua_getglobal(H, "hints") != LUA_TTABLE) { /* the first one */
        luaL_openlibs(H);
        embedded_open(H);
        embedded_run(H, hints_lua, helpers);
        lua_pushvalue(H, -1);
        lua_setglobal(H, "hints");
    }
    lua_pushlightuserdata(H, question);
    lua_rawsetp(H, LUA_REGISTRYINDEX, hints_lua);
    lua_getfield(H, -1, question->function);
    for (int i = 0; i < 2; i++)
        lua_pushstring(H, question->texts[i]);
    lua_newtable(H);
    for (size_t i = 0; i < question->count; i++) {
        lua_pushstring(H, question->names[i]);
        lua_rawseti(H, -2, (lua_Integer)i + 1);
    }
    lua_call(H, 3, 3);
    const char *texts[2];
    for (int i = 0; i < 2; i++) {
        const char *text = lua_isstring(H, i - 3) ? lua_tostring(H, i - 3) : NULL;
        texts[i] = text ? arena_copy_text(arena, text, strlen(text)) : NULL;
    }
    *question->answer = (struct nil_field){texts[1], (int)lua_tointeger(H, -1), texts[0]};
    return 0;
}

/* The words of the answer, or NULL. */
static const char *ask(struct sandbox *sandbox, struct question question) {
    struct nil_field found = {0};
    if (!question.answer)
        question.answer = &found;
    *question.answer = found;
    if (!sandbox->hints) {
        sandbox->hints = luaL_newstate();
        if (!sandbox->hints)
            return NULL;
        *(struct sandbox **)lua_getextraspace(sandbox->hints) = sandbox;
    }
    lua_State *H = sandbox->hints;
    int top = question.script ? lua_gettop(question.script) : 0;
    lua_pushcfunction(H, answer);
    lua_pushlightuserdata(H, &question);
    (void)lua_pcall(H, 1, 0, 0); /* without memory there is no hint */
    lua_settop(H, 0);
    if (question.script)
        lua_settop(question.script, top);
    return question.answer->words;
}

static const char *or_nothing(const char *words) {
    return words ? words : "";
}

const char *hint_of_nil(struct sandbox *sandbox) {
    return or_nothing(ask(sandbox, (struct question){.function = "nil_value", .script = sandbox->lua}));
}

bool hint_find_nil_field(struct sandbox *sandbox, const char *const *names, size_t count, const char *rest,
                         struct nil_field *out) {
    const struct question question = {.function = "nil_field",
                                      .texts = {rest, sandbox->running.name},
                                      .names = names,
                                      .count = count,
                                      .script = sandbox->lua,
                                      .answer = out};
    /* A long generated script is not read for each of its lines. */
    return sandbox->hint_bytes <= READ_AGAIN_LIMIT && ask(sandbox, question) && out->field;
}

bool hint_has_colon(struct sandbox *sandbox, const char *method) {
    return ask(sandbox, (struct question){.function = "has_colon", .texts = {method}, .script = sandbox->lua});
}

const char *hint_of_lua_error(lua_State *L, const char *message) {
    return or_nothing(ask(sandbox_of(L), (struct question){.function = "lua_error", .texts = {message}, .script = L}));
}

const char *hint_of_file(struct sandbox *sandbox, const char *path, const void *data, size_t size) {
    const char *start = arena_copy_text(&sandbox->call, data, size < 16 ? size : 16);
    return ask(sandbox, (struct question){.function = "other_file", .texts = {path, start}});
}

const char *hint_of_missing(struct sandbox *sandbox, const char *path, const char *there, const char *const *files,
                            size_t count) {
    const struct question question = {
        .function = "missing_scene", .texts = {path, there}, .names = files, .count = count};
    return or_nothing(ask(sandbox, question));
}

const char *hint_of_dialect(struct sandbox *sandbox, const char *name) {
    return or_nothing(ask(sandbox, (struct question){.function = "unknown_dialect", .texts = {name}}));
}
