/* Hints in messages about misspelt names. When an argument is nil, or Lua calls or indexes nil, the text of the running
 * line is read again. Names in it that are neither local nor global are likely errors, and the nearest name that has a
 * value is suggested. This happens only when a message is printed, and once for each line that creates a shape without
 * a material. */
#include "sandbox/hints.h"

#include "base/file.h"
#include "base/suggestion.h"
#include "sandbox/lexer.h"
#include "sandbox/libraries_internal.h"
#include "sandbox/sandbox.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TEXT_LIMIT = 4096, NAMES_LIMIT = 2000, NAME_SIZE = 64, HINT_BYTES_LIMIT = 1 << 26 };

/* The running function, and the text from its line on; a copy in the arena of the call. */
struct running {
    lua_State *L;
    lua_Debug at;
    const char *text;
    size_t size;
};

static bool read_text(struct sandbox *sandbox, struct running *running, const char *path) {
    struct file_bytes bytes;
    struct error error = {0};
    if (!path_policy_map(files_policy(sandbox, path), path, FILE_LIMIT, &bytes, &error))
        return false;
    const char *from = (const char *)bytes.data, *end = from + bytes.size;
    sandbox->hint_bytes += bytes.size;
    for (int line = 1; from && line < running->at.currentline; line++) {
        from = memchr(from, '\n', (size_t)(end - from));
        from += from != NULL;
    }
    if (from) {
        running->size = (size_t)(end - from) < TEXT_LIMIT ? (size_t)(end - from) : TEXT_LIMIT;
        running->text = arena_copy_text(&sandbox->call, from, running->size);
    }
    file_unmap(&bytes);
    return running->text != NULL;
}

/* Pushes the value of a local variable, an upvalue or a global; *is_global says which. */
static void push_variable(const struct running *running, const char *name, bool *is_global) {
    lua_State *L = running->L;
    lua_Debug at = running->at;
    int base = lua_gettop(L);
    const char *other;
    *is_global = false;
    lua_pushnil(L);
    bool found = false;
    for (int n = 1; (other = lua_getlocal(L, &at, n)) != NULL; n++) {
        if (strcmp(other, name) == 0) { /* the last one shadows those before it */
            lua_replace(L, base + 1);
            found = true;
        } else {
            lua_pop(L, 1);
        }
    }
    lua_getinfo(L, "f", &at);
    for (int n = 1; !found && (other = lua_getupvalue(L, base + 2, n)) != NULL; n++) {
        if (strcmp(other, name) == 0) {
            lua_replace(L, base + 1);
            found = true;
        } else {
            lua_pop(L, 1);
        }
    }
    if (!found) {
        *is_global = true;
        lua_rawgeti(L, LUA_REGISTRYINDEX, LUA_RIDX_GLOBALS);
        lua_pushstring(L, name);
        lua_rawget(L, -2);
        lua_replace(L, base + 1);
    }
    lua_settop(L, base + 1);
}

/* Whether the globals of the function are those of the script; other environments may have more names. */
static bool has_usual_globals(const struct running *running) {
    lua_State *L = running->L;
    bool is_global;
    push_variable(running, "_ENV", &is_global);
    lua_rawgeti(L, LUA_REGISTRYINDEX, LUA_RIDX_GLOBALS);
    bool usual = is_global || lua_rawequal(L, -1, -2); /* a function that uses no global has no _ENV */
    lua_pop(L, 2);
    return usual;
}

/* False: no Lua function runs, or its text cannot be read. */
static bool find_running(struct sandbox *sandbox, lua_State *L, struct running *running) {
    *running = (struct running){.L = L};
    if (!lua_checkstack(L, 20))
        return false;
    for (int level = 0; lua_getstack(L, level, &running->at); level++) {
        lua_getinfo(L, "Sl", &running->at);
        if (running->at.currentline <= 0)
            continue;
        const char *source = running->at.source;
        return source[0] == '@' && has_usual_globals(running) && read_text(sandbox, running, source + 1);
    }
    return false;
}

static bool is_nil_global(const struct running *running, const char *name) {
    bool is_global;
    push_variable(running, name, &is_global);
    bool nil = is_global && lua_isnil(running->L, -1);
    lua_pop(running->L, 1);
    return nil;
}

static bool copy_name(const struct token *token, char name[NAME_SIZE]) {
    static const char *const keywords[] = {"and",      "break",  "do",   "else", "elseif", "end",  "false", "for",
                                           "function", "goto",   "if",   "in",   "local",  "nil",  "not",   "or",
                                           "repeat",   "return", "then", "true", "until",  "while"};
    if (token->kind != TOKEN_NAME || token->length >= NAME_SIZE)
        return false;
    memcpy(name, token->text, token->length);
    name[token->length] = '\0';
    for (size_t i = 0; i < sizeof keywords / sizeof *keywords; i++)
        if (strcmp(name, keywords[i]) == 0)
            return false;
    return true;
}

/* How many blocks are open after the word. */
static int block_depth(const struct token *word, int depth) {
    static const char *const begin[] = {"function", "if", "do", "repeat"}, *const end[] = {"end", "until"};
    for (size_t i = 0; i < sizeof begin / sizeof *begin; i++)
        if (token_is(word, TOKEN_NAME, begin[i]))
            return depth + 1;
    for (size_t i = 0; i < sizeof end / sizeof *end; i++)
        if (token_is(word, TOKEN_NAME, end[i]))
            return depth - 1;
    return depth;
}

/* Visits the tokens of the running line, and of the following lines while a bracket is open. w[1] is visited, between
 * its neighbours. Functions on the line are skipped, because they do not run: their names have other values. If the
 * running function begins on this line, nothing is skipped. */
static bool find_token(const struct running *running,
                       bool (*visit)(const struct running *, const struct token *w, void *), void *wanted) {
    struct lexer lexer = {running->text, running->text + running->size, 1};
    struct token w[4] = {{0}};
    int depth = 0, inside = 0;
    bool is_outermost = running->at.linedefined != running->at.currentline;
    w[2] = lexer_next(&lexer);
    w[3] = lexer_next(&lexer);
    do {
        w[0] = w[1], w[1] = w[2], w[2] = w[3];
        w[3] = lexer_next(&lexer);
        if (is_outermost && (inside > 0 || token_is(&w[1], TOKEN_NAME, "function")))
            inside = block_depth(&w[1], inside);
        else if (w[1].kind != TOKEN_END && visit(running, w, wanted))
            return true;
        depth += token_is_symbol(&w[1], '(') || token_is_symbol(&w[1], '{');
        depth -= token_is_symbol(&w[1], ')') || token_is_symbol(&w[1], '}');
    } while (w[2].kind != TOKEN_END && (depth > 0 || w[2].line == 1));
    return false;
}

struct declared {
    const char *name;
    bool in_parameters, in_names; /* after `function`, up to the closing bracket; after `local` or `for` */
};

/* A name that the line declares: a parameter, a local variable, a variable of a loop. */
static bool visit_declared(const struct running *running, const struct token *w, void *wanted) {
    struct declared *declared = wanted;
    (void)running;
    bool is_function = token_is(&w[1], TOKEN_NAME, "function");
    if (is_function || token_is(&w[1], TOKEN_NAME, "local") || token_is(&w[1], TOKEN_NAME, "for")) {
        declared->in_parameters = is_function;
        declared->in_names = !is_function;
        return false;
    }
    if (declared->in_parameters && token_is_symbol(&w[1], ')'))
        declared->in_parameters = false;
    if (declared->in_names && w[1].kind != TOKEN_NAME && !token_is_symbol(&w[1], ','))
        declared->in_names = false;
    if (declared->in_names && token_is(&w[1], TOKEN_NAME, "in"))
        declared->in_names = false;
    return (declared->in_parameters || declared->in_names) && token_is(&w[1], TOKEN_NAME, declared->name);
}

/* If the running function begins on the line, this may find names of other functions of the line. */
static bool is_declared_here(const struct running *running, const char *name) {
    struct declared declared = {.name = name};
    return running->at.linedefined == running->at.currentline && find_token(running, visit_declared, &declared);
}

/* A single name: no field, and not left of an assignment. */
static bool is_variable(const struct token *w, char name[NAME_SIZE]) {
    bool is_field = token_is_symbol(&w[0], '.') || token_is_symbol(&w[0], ':');
    bool is_assigned = token_is_symbol(&w[2], '=') && !token_is_symbol(&w[3], '=');
    return !is_field && !is_assigned && copy_name(&w[1], name);
}

static bool visit_nil(const struct running *running, const struct token *w, void *wanted) {
    char *name = wanted;
    return is_variable(w, name) && is_nil_global(running, name) && !is_declared_here(running, name);
}

struct field_search {
    const char *const *names;
    const char *rest, *function;
    const char *field; /* whose list the tokens are in; NULL: none */
    int depth, entry;
    struct nil_field *out;
    char value[NAME_SIZE];
};

/* Whether w[1] is a name of its own: `VARIABLE ,` and not `VARIABLE . name`, VARIABLE(...) or `VARIABLE + 1`. */
static bool is_whole_value(const struct running *running, const struct token *w, char name[NAME_SIZE]) {
    bool ends = token_is_symbol(&w[2], ',') || token_is_symbol(&w[2], '}') || token_is_symbol(&w[2], ';');
    return ends && copy_name(&w[1], name) && is_nil_global(running, name);
}

/* FIELD = VARIABLE and FIELD = {VARIABLE, ...}, where the variable is nil. */
static bool visit_field(const struct running *running, const struct token *w, void *wanted) {
    struct field_search *search = wanted;
    if (search->field) { /* in the list of a field, after its brace */
        bool opens = token_is_symbol(&w[1], '{') || token_is_symbol(&w[1], '(') || token_is_symbol(&w[1], '[');
        bool closes = token_is_symbol(&w[1], '}') || token_is_symbol(&w[1], ')') || token_is_symbol(&w[1], ']');
        search->depth += opens - closes;
        search->entry += search->depth == 1 && token_is_symbol(&w[1], ',');
        bool begins = token_is_symbol(&w[0], '{') || token_is_symbol(&w[0], ',');
        *search->out = (struct nil_field){search->field, search->entry, NULL};
        if (search->depth == 1 && begins && is_whole_value(running, w, search->value))
            return true;
        search->field = search->depth > 0 ? search->field : NULL;
        return false;
    }
    if (search->rest && token_is(&w[0], TOKEN_NAME, search->function) && token_is_symbol(&w[1], '{'))
        *search =
            (struct field_search){search->names, search->rest, search->function, search->rest, 1, 1, search->out, ""};
    if (!token_is_symbol(&w[1], '='))
        return false;
    for (const char *const *name = search->names; *name; name++) {
        if (!token_is(&w[0], TOKEN_NAME, *name))
            continue;
        *search->out = (struct nil_field){*name, 0, NULL};
        if (is_whole_value(running, w + 1, search->value))
            return true;
        if (token_is_symbol(&w[2], '{')) {
            search->field = *name;
            search->depth = 0;
            search->entry = 1;
        }
    }
    return false;
}

static int compare_names(const void *a, const void *b) {
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* Names that have a value, in byte order, because the traversal of a table has no fixed order. */
struct names {
    const char **list;
    size_t count;
};

static void add_name(struct sandbox *sandbox, struct names *names, const char *name) {
    const char *copy = names->count < NAMES_LIMIT ? arena_copy_text(&sandbox->call, name, strlen(name)) : NULL;
    if (copy)
        names->list[names->count++] = copy;
}

static void add_keys(struct sandbox *sandbox, lua_State *L, struct names *names) {
    for (lua_pushnil(L); lua_next(L, -2); lua_pop(L, 1))
        if (lua_type(L, -2) == LUA_TSTRING)
            add_name(sandbox, names, lua_tostring(L, -2));
}

static const char *nearest(struct names *names, const char *name) {
    struct suggestion suggestion;
    qsort(names->list, names->count, sizeof *names->list, compare_names);
    suggest_begin(&suggestion, name);
    for (size_t i = 0; i < names->count; i++)
        suggest_offer(&suggestion, names->list[i]);
    return suggestion.best;
}

static bool begin_names(struct sandbox *sandbox, struct names *names) {
    *names = (struct names){.list = arena_alloc_array(&sandbox->call, NAMES_LIMIT, sizeof *names->list)};
    return names->list != NULL;
}

/* The variable with the most similar name. */
static const char *nearest_variable(struct sandbox *sandbox, const struct running *running, const char *name) {
    struct names names;
    lua_State *L = running->L;
    lua_Debug at = running->at;
    const char *other;
    if (!begin_names(sandbox, &names))
        return NULL;
    for (int n = 1; (other = lua_getlocal(L, &at, n)) != NULL; lua_pop(L, 1), n++)
        if (other[0] != '(' && !lua_isnil(L, -1))
            add_name(sandbox, &names, other);
    lua_getinfo(L, "f", &at);
    for (int n = 1; (other = lua_getupvalue(L, -1, n)) != NULL; lua_pop(L, 1), n++)
        if (!lua_isnil(L, -1))
            add_name(sandbox, &names, other);
    lua_pop(L, 1);
    lua_rawgeti(L, LUA_REGISTRYINDEX, LUA_RIDX_GLOBALS);
    add_keys(sandbox, L, &names);
    lua_pop(L, 1);
    return nearest(&names, name);
}

static const char *nil_words(struct sandbox *sandbox, const struct running *running, const char *name) {
    const char *meant = nearest_variable(sandbox, running, name);
    const char *words = meant ? arena_format(&sandbox->call, "; '%s' is nil, did you mean '%s'?", name, meant)
                              : arena_format(&sandbox->call, "; '%s' is nil", name);
    return words ? words : "";
}

const char *hint_of_nil(struct sandbox *sandbox) {
    struct running running;
    char name[NAME_SIZE];
    if (!find_running(sandbox, sandbox->lua, &running) || !find_token(&running, visit_nil, name))
        return "";
    return nil_words(sandbox, &running, name);
}

bool hint_find_nil_field(struct sandbox *sandbox, const char *const *names, const char *rest, struct nil_field *out) {
    struct running running;
    struct field_search search = {.names = names, .rest = rest, .function = sandbox->running.name, .out = out};
    if (sandbox->hint_bytes > HINT_BYTES_LIMIT) /* a long generated script is not read for each of its lines */
        return false;
    if (!find_running(sandbox, sandbox->lua, &running) || !find_token(&running, visit_field, &search))
        return false;
    out->words = nil_words(sandbox, &running, search.value);
    return true;
}

/* Errors of Lua. */

struct access {
    const char *field;
    char table[NAME_SIZE];
};

/* TABLE.FIELD, where TABLE is a variable. */
static bool visit_access(const struct running *running, const struct token *w, void *wanted) {
    struct access *access = wanted;
    (void)running;
    bool before = token_is_symbol(&w[0], '.') || token_is_symbol(&w[0], ':');
    return !before && token_is_symbol(&w[2], '.') && token_is(&w[3], TOKEN_NAME, access->field) &&
           copy_name(&w[1], access->table);
}

static const char *field_words(struct sandbox *sandbox, const struct running *running, const char *field) {
    struct access access = {.field = field};
    struct names names;
    lua_State *L = running->L;
    bool is_global;
    if (!find_token(running, visit_access, &access))
        return "";
    push_variable(running, access.table, &is_global);
    const char *words = "", *meant = NULL;
    if (lua_istable(L, -1) && is_global && !sandbox->options->no_sandbox && libraries_lack(access.table, field))
        words = arena_format(&sandbox->call, "; the sandbox has no %s.%s (docs/security.md)", access.table, field);
    else if (lua_istable(L, -1) && begin_names(sandbox, &names)) {
        add_keys(sandbox, L, &names);
        meant = nearest(&names, field);
    }
    if (meant)
        words = arena_format(&sandbox->call, "; did you mean '%s.%s'?", access.table, meant);
    lua_pop(L, 1);
    return words ? words : "";
}

/* The name in "... a nil value (KIND 'NAME')". */
static bool read_culprit(const char *message, const char *kind, char name[NAME_SIZE]) {
    char begin[40];
    (void)snprintf(begin, sizeof begin, " a nil value (%s '", kind);
    const char *at = strstr(message, begin);
    size_t length = at ? strcspn(at + strlen(begin), "'\n") : 0;
    if (length == 0 || length >= NAME_SIZE)
        return false;
    memcpy(name, at + strlen(begin), length);
    name[length] = '\0';
    return true;
}

/* A variable that is nil and was set at the beginning of the file, as in `local execute = os.execute`. */
static const char *alias_words(struct sandbox *sandbox, const struct running *running, const char *name) {
    struct running file = {.L = running->L, .at = {.currentline = 1}};
    struct token w[5] = {{0}};
    char library[NAME_SIZE], field[NAME_SIZE];
    if (sandbox->options->no_sandbox || !read_text(sandbox, &file, running->at.source + 1))
        return "";
    struct lexer lexer = {file.text, file.text + file.size, 1};
    do {
        for (int k = 0; k < 4; k++)
            w[k] = w[k + 1];
        w[4] = lexer_next(&lexer);
        if (token_is(&w[0], TOKEN_NAME, name) && token_is_symbol(&w[1], '=') && token_is_symbol(&w[3], '.') &&
            copy_name(&w[2], library) && copy_name(&w[4], field) && libraries_lack(library, field)) {
            const char *words =
                arena_format(&sandbox->call, "; the sandbox has no %s.%s (docs/security.md)", library, field);
            return words ? words : "";
        }
    } while (w[4].kind != TOKEN_END && w[4].line <= running->at.currentline);
    return "";
}

const char *hint_of_lua_error(lua_State *L, const char *message) {
    struct sandbox *sandbox = sandbox_of(L);
    struct running running;
    char name[NAME_SIZE];
    bool field = read_culprit(message, "field", name), global = !field && read_culprit(message, "global", name);
    bool local = !field && !global && (read_culprit(message, "local", name) || read_culprit(message, "upvalue", name));
    if ((!field && !global && !local) || !find_running(sandbox, L, &running))
        return "";
    if (local)
        return alias_words(sandbox, &running, name);
    if (field)
        return field_words(sandbox, &running, name);
    const char *meant = nearest_variable(sandbox, &running, name);
    const char *words = meant ? arena_format(&sandbox->call, "; did you mean '%s'?", meant) : NULL;
    return words ? words : "";
}
