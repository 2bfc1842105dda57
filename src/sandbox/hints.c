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
#include "sandbox/syntax_hints_internal.h"

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

static bool read_text_up_to(struct sandbox *sandbox, struct running *running, const char *path, size_t limit) {
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
        running->size = (size_t)(end - from) < limit ? (size_t)(end - from) : limit;
        running->text = arena_copy_text(&sandbox->call, from, running->size);
    }
    file_unmap(&bytes);
    return running->text != NULL;
}

static bool read_text(struct sandbox *sandbox, struct running *running, const char *path) {
    return read_text_up_to(sandbox, running, path, TEXT_LIMIT);
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
    if (!sandbox_find_frame(L, &running->at))
        return false;
    const char *source = running->at.source;
    return source[0] == '@' && has_usual_globals(running) && read_text(sandbox, running, source + 1);
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

/* "; there is no meshes.load, meshes has convert, smooth ...": for tables with functions, as modules are. gr has many
 * functions that modules do not have. */
static const char *module_words(struct sandbox *sandbox, const struct names *names, const char *table,
                                const char *field) {
    enum { SHOWN = 16 };
    char list[512] = "";
    for (size_t i = 0, used = 0; i < names->count && i < SHOWN && used + NAME_SIZE < sizeof list; i++)
        used += (size_t)snprintf(list + used, sizeof list - used, "%s%.40s", i > 0 ? ", " : "", names->list[i]);
    if (names->count == 0)
        return "";
    return arena_format(&sandbox->call, "; there is no %s.%s; %s has %s%s", table, field, table, list,
                        names->count > SHOWN ? " ..." : "");
}

static const char *field_words(struct sandbox *sandbox, const struct running *running, const char *field) {
    struct access access = {.field = field};
    struct names names = {0};
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
    else if (lua_istable(L, -1) && !words[0])
        words = module_words(sandbox, &names, access.table, field);
    lua_pop(L, 1);
    return words ? words : "";
}

/* The name in "... a TYPE value (KIND 'NAME')". */
static bool read_culprit(const char *message, const char *type, const char *kind, char name[NAME_SIZE]) {
    char begin[40];
    (void)snprintf(begin, sizeof begin, " a %s value (%s '", type, kind);
    const char *at = strstr(message, begin);
    size_t length = at ? strcspn(at + strlen(begin), "'\n") : 0;
    if (length == 0 || length >= NAME_SIZE || strncmp(at + strlen(begin) + length, "');", 3) == 0) /* has a hint */
        return false;
    memcpy(name, at + strlen(begin), length);
    name[length] = '\0';
    return true;
}

/* Visits every `NAME = ...` of the file up to the running line with the five tokens after `=`; returns its words. */
static const char *find_setting(struct sandbox *sandbox, const struct running *running, const char *name,
                                const char *(*visit)(struct sandbox *, const struct token *)) {
    struct running file = {.L = running->L, .at = {.currentline = 1}};
    struct token w[7] = {{0}};
    const char *words = "";
    if (!read_text_up_to(sandbox, &file, running->at.source + 1, FILE_LIMIT))
        return "";
    struct lexer lexer = {file.text, file.text + file.size, 1};
    do {
        memmove(w, w + 1, 6 * sizeof *w);
        w[6] = lexer_next(&lexer);
        if (!token_is(&w[0], TOKEN_NAME, name) || !token_is_symbol(&w[1], '='))
            continue;
        const char *found = visit(sandbox, w + 2);
        words = found ? found : words;
    } while (w[0].kind != TOKEN_END || w[6].kind != TOKEN_END ? w[0].line <= running->at.currentline : false);
    return words;
}

/* = LIBRARY.FIELD, which the sandbox does not have: `local execute = os.execute`. */
static const char *visit_alias(struct sandbox *sandbox, const struct token *w) {
    char library[NAME_SIZE], field[NAME_SIZE];
    bool is_field = token_is_symbol(&w[1], '.') && copy_name(&w[0], library) && copy_name(&w[2], field);
    if (!is_field || token_is_symbol(&w[3], '(') || sandbox->options->no_sandbox || !libraries_lack(library, field))
        return NULL;
    return arena_format(&sandbox->call, "; the sandbox has no %s.%s (docs/security.md)", library, field);
}

/* = io.open(...), which returned nil and a reason that the script did not read. */
static const char *visit_open(struct sandbox *sandbox, const struct token *w) {
    bool opens =
        token_is(&w[0], TOKEN_NAME, "io") && token_is_symbol(&w[1], '.') && token_is(&w[2], TOKEN_NAME, "open");
    if (!opens || !sandbox->refused[0])
        return NULL;
    return arena_format(&sandbox->call, "; io.open returned nil, because %s", sandbox->refused);
}

static const char *visit_nil_value(struct sandbox *sandbox, const struct token *w) {
    const char *words = visit_alias(sandbox, w);
    return words ? words : visit_open(sandbox, w);
}

/* = require 'MODULE', or require('MODULE'). */
static const char *visit_require(struct sandbox *sandbox, const struct token *w) {
    const struct token *module = token_is_symbol(&w[1], '(') ? &w[2] : &w[1];
    if (!token_is(&w[0], TOKEN_NAME, "require") || module->kind != TOKEN_STRING || module->length > NAME_SIZE)
        return NULL;
    return arena_format(&sandbox->call, "; the module '%.*s' returns nothing: its last line must return its table",
                        (int)module->length, module->text);
}

/* "; --dialect processing has a function size": the dialects of the library that set this global. */
static const char *dialect_words(struct sandbox *sandbox, const char *name) {
    const char *library = sandbox->options->library_folder;
    struct path_policy_entry *entries;
    char path[PATH_SIZE], found[128] = "";
    size_t count = 0;
    if (library && !sandbox->files.dialect && snprintf(path, sizeof path, "%s/dialects", library) < PATH_SIZE)
        count = path_policy_list(sandbox->path_policy, path, 1000, &sandbox->call, &entries);
    for (size_t i = 0; i < count; i++) {
        struct running file = {.at = {.currentline = 1}};
        struct token w[4] = {{0}};
        bool sets = false;
        if (snprintf(path, sizeof path, "%s/dialects/%s", library, entries[i].name) >= PATH_SIZE ||
            !read_text_up_to(sandbox, &file, path, FILE_LIMIT))
            continue;
        struct lexer lexer = {file.text, file.text + file.size, 1};
        do {
            memmove(w, w + 1, 3 * sizeof *w);
            w[3] = lexer_next(&lexer);
            bool begins = w[1].line > w[0].line && w[1].text && (w[1].text == file.text || w[1].text[-1] == '\n');
            sets = sets ||
                   (begins && token_is(&w[1], TOKEN_NAME, "function") && token_is(&w[2], TOKEN_NAME, name) &&
                    token_is_symbol(&w[3], '(')) ||
                   (begins && token_is(&w[1], TOKEN_NAME, name) && token_is_symbol(&w[2], '='));
        } while (!sets && w[3].kind != TOKEN_END);
        size_t used = strlen(found);
        if (sets)
            (void)snprintf(found + used, sizeof found - used, "%s%.*s", used ? " or " : "",
                           (int)strcspn(entries[i].name, "."), entries[i].name);
    }
    return found[0] ? arena_format(&sandbox->call, "; another program has '%s': --dialect %s", name, found) : "";
}

/* Of a global that is nil: gr has it, a dialect has it, or there is a similar name. */
static const char *global_words(struct sandbox *sandbox, const struct running *running, const char *name) {
    lua_State *L = running->L;
    bool is_global;
    push_variable(running, "gr", &is_global);
    bool of_gr = lua_istable(L, -1);
    if (of_gr) {
        lua_pushstring(L, name);
        of_gr = lua_rawget(L, -2) != LUA_TNIL;
        lua_pop(L, 1);
    }
    lua_pop(L, 1);
    const char *others = dialect_words(sandbox, name);
    if (of_gr)
        return arena_format(&sandbox->call, "; did you mean 'gr.%s'?%s%s", name, others && others[0] ? " (" : "",
                            others && others[0] ? arena_format(&sandbox->call, "%s)", others + 2) : "");
    if (others && others[0])
        return others;
    const char *meant = nearest_variable(sandbox, running, name);
    return meant ? arena_format(&sandbox->call, "; did you mean '%s'?", meant) : "";
}

const char *hint_of_lua_error(lua_State *L, const char *message) {
    struct sandbox *sandbox = sandbox_of(L);
    struct running running;
    char name[NAME_SIZE];
    bool field = read_culprit(message, "nil", "field", name);
    bool global = !field && read_culprit(message, "nil", "global", name);
    bool local = !field && !global &&
                 (read_culprit(message, "nil", "local", name) || read_culprit(message, "nil", "upvalue", name));
    bool module =
        !field && !global && !local &&
        (read_culprit(message, "boolean", "local", name) || read_culprit(message, "boolean", "upvalue", name) ||
         read_culprit(message, "boolean", "global", name));
    if (!field && !global && !local && !module)
        return hint_of_syntax(sandbox, message);
    if (!find_running(sandbox, L, &running))
        return "";
    const char *words = global   ? global_words(sandbox, &running, name)
                        : local  ? find_setting(sandbox, &running, name, visit_nil_value)
                        : module ? find_setting(sandbox, &running, name, visit_require)
                                 : field_words(sandbox, &running, name);
    return words ? words : "";
}

/* :NAME, of a method. */
static bool visit_method(const struct running *running, const struct token *w, void *wanted) {
    (void)running;
    return token_is_symbol(&w[0], ':') && token_is(&w[1], TOKEN_NAME, wanted);
}

bool hint_has_colon(struct sandbox *sandbox, const char *method) {
    struct running running;
    return find_running(sandbox, sandbox->lua, &running) &&
           find_token(&running, visit_method, (void *)(uintptr_t)method);
}
