/* Reads a scene in JSON. Each object with a type is a call of that function of gr with the other members as fields, so
 * names, ranges, defaults and errors are those of the table of functions, and nothing here knows a shape. Values are
 * made from the innermost outwards; what `define` names is made at its first use. */
#include "script/scene_json_internal.h"

#include "base/file.h"
#include "base/suggestion.h"
#include "formats/json_text.h"
#include "math/range.h"
#include "script/dispatch_internal.h"
#include "script/script_internal.h"
#include "script/table_internal.h"

#include <lauxlib.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

bool scene_json_is_named(const char *path) {
    size_t length = strlen(path);
    return length > 5 && strcasecmp(path + length - 5, ".json") == 0;
}

#ifndef HAVE_JANSSON

void scene_json_run(lua_State *L) {
    struct sandbox *sandbox = sandbox_enter(L);
    sandbox_raise(sandbox, "this build cannot read JSON (it was made without jansson)");
}

#else

/* Of values in each other, through `ref`, too. */
enum { DEPTH = 1000, PATH = 4 * DEPTH + 8 };

/* Stack indices. made: the table of what `define` has made; true while it is being made. calls: those of the functions
 * that a file may name, by their names. */
struct scene_reader {
    lua_State *L;
    struct script *script;
    json_t *defined;
    int depth, made, calls[2], add_child;
    /* The way to the value that is read, for messages: a member by its key, or an entry by its index if the key is
     * NULL. Within `define` it begins there. */
    struct {
        const char *key;
        size_t index;
    } path[PATH];
    int path_start, path_end;
};

/* --- messages --- */

static void enter(struct scene_reader *r, const char *key, size_t index) {
    r->path[r->path_end].key = key;
    r->path[r->path_end++].index = index;
}

/* Of a deep one, the outer part. */
static void print_position(const struct scene_reader *r, char *out, size_t size) {
    size_t used = 0;
    for (int k = r->path_start; k < r->path_end && used + 4 <= size; k++, used = strlen(out))
        if (r->path[k].key)
            (void)snprintf(out + used, size - used, "%s%.80s", used > 0 ? "." : "", r->path[k].key);
        else
            (void)snprintf(out + used, size - used, "[%zu]", r->path[k].index);
}

static bool has_parameter(const struct script_function *function, const char *name, size_t length) {
    for (int k = 0; k < function->parameter_count; k++)
        if (strlen(function->parameters[k].name) == length && memcmp(function->parameters[k].name, name, length) == 0)
            return true;
    return false;
}

/* The argument that the error is about ends the position: "gr.material: kd[2] must ..." is about kd[1], as JSON counts
 * from 0. */
static void print_argument(const struct script_context *context, char *error, char *out, size_t size) {
    static const char unknown[] = "unknown field '";
    const struct script_function *function = context->function;
    char *text = strstr(error, ": "), *end;
    if (!text || !function || !context->sandbox.running.name)
        return;
    text += 2;
    if (strncmp(text, unknown, sizeof unknown - 1) == 0) {
        text += sizeof unknown - 1;
        (void)snprintf(out, size, ".%.*s", (int)strcspn(text, "'"), text);
        return;
    }
    size_t length = strspn(text, "abcdefghijklmnopqrstuvwxyz0123456789_");
    if (length == 0 || !has_parameter(function, text, length))
        return;
    size_t used = (size_t)snprintf(out, size, ".%.*s", (int)length, text);
    for (char *at = text + length; at[0] == '[' && used < size; at = end + 1) {
        unsigned long index = strtoul(at + 1, &end, 10);
        if (*end != ']' || index == 0)
            return;
        char digits[24];
        int count = snprintf(digits, sizeof digits, "%lu", index - 1);
        memmove(at + 1 + count, end, strlen(end) + 1);
        memcpy(at + 1, digits, (size_t)count);
        end = at + 1 + count;
        used += (size_t)snprintf(out + used, size - used, "[%s]", digits);
    }
}

/* After "x.json: ": "nodes[3].material.kd: ". */
static void locate(const struct sandbox *sandbox, char *out, size_t size) {
    struct script_context *context = context_of(sandbox->lua);
    char position[400] = "", argument[256] = "";
    print_position(script_of(context)->reader, position, sizeof position);
    print_argument(context, context->sandbox.raised, argument, sizeof argument);
    if (position[0] || argument[0])
        (void)snprintf(out, size, "%s%s: ", position, argument + (position[0] == '\0' && argument[0] == '.'));
}

#define FAIL(r, ...) sandbox_raise(sandbox_enter((r)->L), __VA_ARGS__)

_Noreturn static void fail_unknown(struct scene_reader *r, const char *what, const struct suggestion *s) {
    if (s->best)
        FAIL(r, "%s '%.100s' does not exist; did you mean '%s'?", what, s->word, s->best);
    FAIL(r, "%s '%.100s' does not exist; near it are %s, %s and %s", what, s->word, s->near[0], s->near[1], s->near[2]);
}

/* --- values --- */

static void push_value(struct scene_reader *r, const json_t *json);

static void push_entry(struct scene_reader *r, size_t index, const json_t *json) {
    enter(r, NULL, index);
    push_value(r, json);
    r->path_end--;
}

static void push_list(struct scene_reader *r, const json_t *list) {
    size_t count = json_array_size(list);
    lua_createtable(r->L, (int)count, 0);
    for (size_t i = 0; i < count; i++) {
        push_entry(r, i, json_array_get(list, i));
        lua_rawseti(r->L, -2, (lua_Integer)i + 1);
    }
}

static bool is_call(const json_t *value) {
    return json_is_object(value) &&
           (json_is_string(json_object_get(value, "type")) || json_is_string(json_object_get(value, "ref")));
}

/* An object of a kind that only functions make; its position is set. */
static void check_type(struct scene_reader *r, const struct script_function *function, const json_t *value) {
    const char *key = r->path[r->path_end - 1].key;
    for (int k = 0; json_is_object(value) && !is_call(value) && k < function->parameter_count; k++) {
        const struct script_parameter *p = &function->parameters[k];
        bool is_node = p->kind == KIND_NODE;
        if ((is_node || p->kind == KIND_MATERIAL) && strcmp(p->name, key) == 0)
            FAIL(r, "it must have a type, as in {\"type\": \"%s\"}", is_node ? "sphere" : "material");
    }
}

/* A table of the members, without those of that list, which ends with NULL: the fields of a function, or NULL. */
static void push_fields(struct scene_reader *r, const struct script_function *function, const json_t *object,
                        const char *const *without) {
    lua_createtable(r->L, 0, (int)json_object_size(object));
    for (void *at = json_object_iter((json_t *)(uintptr_t)object); at;
         at = json_object_iter_next((json_t *)(uintptr_t)object, at)) {
        const char *key = json_object_iter_key(at);
        const char *const *other = without;
        while (*other && strcmp(*other, key) != 0)
            other++;
        if (*other)
            continue;
        enter(r, key, 0);
        if (function)
            check_type(r, function, json_object_iter_value(at));
        push_value(r, json_object_iter_value(at));
        r->path_end--;
        bool is_type = function && strcmp(key, SCENE_JSON_FIELD_TYPE) == 0 && has_parameter(function, "type", 4);
        lua_setfield(r->L, -2, is_type ? "type" : key);
    }
}

/* Whether a file may name it: it makes what a scene consists of, or it is a method that changes its node. */
static bool may_be_named(const struct script_function *function, enum function_owner owner) {
    enum {
        OBJECTS = 1 << RESULT_NODE | 1 << RESULT_MATERIAL | 1 << RESULT_LIGHT | 1 << RESULT_TEXTURE | 1 << RESULT_FOG |
                  1 << RESULT_MEDIUM | 1 << RESULT_SKY
    };
    return function->owner == owner &&
           (owner == OWNER_GR ? OBJECTS >> function->result & 1 : function->result == RESULT_SELF);
}

/* Pushes the function, too. */
static const struct script_function *find_function(struct scene_reader *r, enum function_owner owner,
                                                   const char *name) {
    if (lua_getfield(r->L, r->calls[owner], name) == LUA_TFUNCTION)
        return dispatch_function(r->L);
    struct suggestion suggestion;
    suggest_begin(&suggestion, name);
    for (int k = 0; k < function_count(); k++)
        if (may_be_named(function_at(k), owner))
            suggest_offer(&suggestion, function_at(k)->name);
    fail_unknown(r, owner == OWNER_GR ? "the type" : "the method", &suggestion);
}

/* Calls a method of the node on top: a list has its arguments, a table its fields, and else it is the argument. */
static void call_method(struct scene_reader *r, const char *name, const json_t *value) {
    static const char *const none[] = {NULL};
    lua_State *L = r->L;
    int count = 1;
    enter(r, name, 0);
    luaL_checkstack(L, 20, NULL);
    const struct script_function *function = find_function(r, OWNER_NODE, name);
    lua_pushvalue(L, -2);
    if (json_is_array(value)) {
        enum { ARGUMENTS = 8 };
        count = (int)json_array_size(value);
        if (count > ARGUMENTS)
            FAIL(r, "a method has at most %d arguments", ARGUMENTS);
        for (int i = 0; i < count; i++)
            push_entry(r, (size_t)i, json_array_get(value, (size_t)i));
    } else if (json_is_object(value) && !is_call(value)) {
        push_fields(r, function, value, none);
    } else {
        push_value(r, value);
    }
    lua_call(L, count + 1, 0);
    r->path_end--;
}

static void push_node(struct scene_reader *r, const json_t *list, size_t index) {
    const json_t *json = json_array_get(list, index);
    enter(r, NULL, index);
    push_value(r, json);
    const struct handle *handle = handle_at(r->L, -1);
    if (!handle || handle->type != HANDLE_NODE)
        FAIL(r, "it must be a node, such as {\"type\": \"sphere\"}, not %s",
             json_is_array(json)               ? "a list"
             : json_is_object(json) && !handle ? "an object without a type"
                                               : value_words(r->L, -1));
    r->path_end--;
}

/* To the node on top. */
static void add_children(struct scene_reader *r, const char *key, const json_t *children) {
    lua_State *L = r->L;
    enter(r, key, 0);
    if (!json_is_array(children))
        FAIL(r, "it must be a list of nodes");
    for (size_t i = 0; i < json_array_size(children); i++) {
        lua_pushvalue(L, r->add_child);
        lua_pushvalue(L, -2);
        push_node(r, children, i);
        lua_call(L, 2, 0);
    }
    r->path_end--;
}

static void transform(struct scene_reader *r, const json_t *calls) {
    enter(r, "transform", 0);
    if (!json_is_array(calls))
        FAIL(r, "it must be a list such as [{\"translate\": [1, 0, 0]}]");
    for (size_t i = 0; i < json_array_size(calls); i++) {
        json_t *call = json_array_get(calls, i);
        void *at = json_is_object(call) ? json_object_iter(call) : NULL;
        enter(r, NULL, i);
        if (!at || json_object_size(call) != 1)
            FAIL(r, "it must be an object with one method, as {\"translate\": [1, 0, 0]}");
        call_method(r, json_object_iter_key(at), json_object_iter_value(at));
        r->path_end--;
    }
    r->path_end--;
}

/* The object that a function of gr makes. */
static void push_object(struct scene_reader *r, const json_t *object, const char *type) {
    static const char *const own[] = {"type", "transform", "children", NULL};
    static const char *const of_group[] = {"type", "transform", NULL}, *const type_only[] = {"type", NULL};
    lua_State *L = r->L;
    const struct script_function *function = find_function(r, OWNER_GR, type);
    const json_t *children = json_object_get(object, "children"), *calls = json_object_get(object, "transform");
    bool is_node = function->result == RESULT_NODE, is_group = children && has_parameter(function, "children", 8);
    push_fields(r, function, object, !is_node ? type_only : is_group ? of_group : own);
    lua_call(L, 1, 1);
    if (is_node && !is_group && children)
        add_children(r, "children", children);
    if (is_node && calls)
        transform(r, calls);
}

static void push_reference(struct scene_reader *r, const char *name) {
    lua_State *L = r->L;
    const json_t *json = json_object_get(r->defined, name);
    lua_getfield(L, r->made, name);
    if (lua_isuserdata(L, -1))
        return;
    if (!lua_isnil(L, -1))
        FAIL(r, "'%.100s' would be a part of itself", name);
    if (!json) {
        struct suggestion suggestion;
        const char *key;
        json_t *value;
        suggest_begin(&suggestion, name);
        json_object_foreach(r->defined, key, value) suggest_offer(&suggestion, key);
        if (suggestion.best)
            fail_unknown(r, "the name", &suggestion);
        FAIL(r, "the name '%.100s' is not in define", name);
    }
    lua_pushboolean(L, 1);
    lua_setfield(L, r->made, name);
    lua_pop(L, 1);
    const int start = r->path_start;
    r->path_start = r->path_end;
    enter(r, "define", 0);
    enter(r, name, 0);
    if (!is_call(json))
        FAIL(r, "it must be an object with a type, such as {\"type\": \"sphere\"}");
    push_value(r, json);
    r->path_end = r->path_start;
    r->path_start = start;
    lua_pushvalue(L, -1);
    lua_setfield(L, r->made, name);
}

static void push_value(struct scene_reader *r, const json_t *json) {
    static const char *const none[] = {NULL};
    lua_State *L = r->L;
    if (++r->depth > DEPTH)
        FAIL(r, "more than %d values are in each other", DEPTH);
    luaL_checkstack(L, 20, NULL);
    switch (json_typeof(json)) {
    case JSON_OBJECT: {
        const json_t *ref = json_object_get(json, "ref"), *type = json_object_get(json, "type");
        if (json_is_string(ref) && json_object_size(json) > 1)
            FAIL(r, "an object with ref has no other fields");
        else if (json_is_string(ref))
            push_reference(r, json_string_value(ref));
        else if (json_is_string(type))
            push_object(r, json, json_string_value(type));
        else if (type || ref)
            FAIL(r, "type and ref must be words, as in {\"type\": \"sphere\"}");
        else
            push_fields(r, NULL, json, none);
        break;
    }
    case JSON_ARRAY:
        push_list(r, json);
        break;
    case JSON_STRING:
        lua_pushlstring(L, json_string_value(json), json_string_length(json));
        break;
    case JSON_INTEGER:
        lua_pushinteger(L, json_integer_value(json));
        break;
    case JSON_REAL:
        lua_pushnumber(L, json_real_value(json));
        break;
    case JSON_TRUE:
    case JSON_FALSE:
        lua_pushboolean(L, json_is_true(json));
        break;
    case JSON_NULL:
        FAIL(r, "null is no value; leave the field out");
    }
    r->depth--;
}

/* --- the file --- */

static const char *const top_names[] = {"gray", "define", "nodes", "picture", "transform_order", "defaults", "time"};

static void check_top(struct scene_reader *r, const json_t *root) {
    struct sandbox *sandbox = sandbox_enter(r->L);
    const json_t *version = json_object_get(root, "gray"), *define = json_object_get(root, "define");
    const char *key;
    json_t *value;
    if (!json_is_integer(version))
        sandbox_raise(sandbox, "it is no scene of gray: \"gray\": %d is missing at the top", SCENE_JSON_VERSION);
    if (json_integer_value(version) != SCENE_JSON_VERSION)
        sandbox_raise(sandbox, "it is of version %lld; this gray reads version %d",
                      (long long)json_integer_value(version), SCENE_JSON_VERSION);
    json_object_foreach((json_t *)(uintptr_t)root, key, value) {
        struct suggestion suggestion;
        bool known = false;
        suggest_begin(&suggestion, key);
        for (size_t i = 0; i < sizeof top_names / sizeof *top_names; i++) {
            known |= strcmp(top_names[i], key) == 0;
            suggest_offer(&suggestion, top_names[i]);
        }
        if (!known && has_parameter(function_find(OWNER_GR, "render"), key, strlen(key)))
            sandbox_raise(sandbox, "the field '%s' belongs in picture", key);
        if (!known)
            fail_unknown(r, "the field", &suggestion);
    }
    if (define && !json_is_object(define))
        sandbox_raise(sandbox, "define: it must be an object, {\"NAME\": {\"type\": ...}}");
    if (json_array_size(json_object_get(root, "nodes")) == 0) /* of anything else, too */
        sandbox_raise(sandbox, "nodes must be a list of at least one node, as in \"nodes\": [{\"type\": \"sphere\"}]");
    value = json_object_get(root, "picture");
    if (value && !json_is_object(value))
        sandbox_raise(sandbox, "picture: it must be an object with the fields of gr.render");
    if (json_object_get(value, "node"))
        sandbox_raise(sandbox, "picture: unknown field 'node'; the list nodes has them");
}

/* What the fields of gr.render do not say. */
static void set_state(struct scene_reader *r, const json_t *root) {
    static const char *const orders[] = {TRANSFORM_ORDERS(LIST_WORD)};
    struct sandbox *sandbox = sandbox_enter(r->L);
    const json_t *order = json_object_get(root, "transform_order"), *defaults = json_object_get(root, "defaults"),
                 *time = json_object_get(root, "time");
    const char *word = json_string_value(defaults);
    if (defaults && (!word || (strcmp(word, "classic") != 0 && strcmp(word, "light") != 0)))
        sandbox_raise(sandbox, "defaults must be \"light\" or \"classic\"");
    r->script->only_named_pictures = !word || strcmp(word, "light") == 0;
    if (time && (!json_is_number(time) || !(json_number_value(time) >= 0) || !number_in_range(json_number_value(time))))
        sandbox_raise(sandbox, "time must be a number of seconds, from 0 to %g", NUMBER_LIMIT);
    r->script->time = json_number_value(time);
    for (int k = 0; order && (word = json_string_value(order)) && k < (int)(sizeof orders / sizeof *orders); k++)
        if (strcmp(orders[k], word) == 0) {
            r->script->context.scene.order = (enum transform_order)k;
            order = NULL;
        }
    if (order)
        sandbox_raise(sandbox, "transform_order must be \"new\", \"old\" or \"separate\"");
}

/* The node of the picture: several are the children of one. */
static void push_root(struct scene_reader *r, const json_t *nodes) {
    const char *name;
    json_t *value;
    if (json_array_size(nodes) > 1) {
        dispatch_push(r->L, function_find(OWNER_GR, "node"));
        lua_pushliteral(r->L, "scene");
        lua_call(r->L, 1, 1);
        add_children(r, "nodes", nodes);
    } else {
        enter(r, "nodes", 0);
        push_node(r, nodes, 0);
        r->path_end--;
    }
    json_object_foreach(r->defined, name, value) { /* those that nothing uses, for their errors */
        push_reference(r, name);
        lua_pop(r->L, 1);
    }
}

static void render(struct scene_reader *r, const json_t *root) {
    static const char *const own[] = {"type", NULL};
    lua_State *L = r->L;
    const json_t *picture = json_object_get(root, "picture");
    const char *type = json_string_value(json_object_get(picture, "type"));
    const struct script_function *function = function_find(OWNER_GR, type ? type : "render");
    push_root(r, json_object_get(root, "nodes"));
    enter(r, "picture", 0);
    if (!function || !function_renders(function))
        FAIL(r, "the type must be \"render\", \"render_skybox\" or \"light_field\"");
    if (picture)
        push_fields(r, function, picture, own);
    else
        lua_newtable(L);
    lua_insert(L, -2);
    lua_setfield(L, -2, "node");
    dispatch_push(L, function);
    lua_insert(L, -2);
    lua_call(L, 1, 0);
    r->path_end--;
}

static json_t *read_file(lua_State *L, const char *path) {
    struct sandbox *sandbox = sandbox_enter(L);
    struct error error = {0};
    struct file_bytes bytes;
    json_t *root = NULL;
    if (file_map(path, FILE_LIMIT, &bytes, &error)) {
        const char *text = (const char *)bytes.data;
        size_t mark = bytes.size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
        root = json_text_parse(path, text + mark, bytes.size - mark, true, &sandbox->keep, &error);
        file_unmap(&bytes);
    }
    if (root)
        return root;
    if (error.kind == ERROR_SCENE)
        (void)error_elsewhere(&error);
    sandbox_raise_error(sandbox, &error);
}

void scene_json_run(lua_State *L) {
    struct script *script = script_of(context_of(L));
    struct scene_reader reader = {.L = L, .script = script};
    json_t *root = read_file(L, script->context.sandbox.files.path);
    lua_newtable(L);
    reader.made = lua_gettop(L);
    for (int owner = 0; owner < 2; owner++) {
        lua_newtable(L);
        reader.calls[owner] = lua_gettop(L);
        for (int k = 0; k < function_count(); k++) {
            if (!may_be_named(function_at(k), (enum function_owner)owner))
                continue;
            dispatch_push(L, function_at(k));
            lua_setfield(L, -2, function_at(k)->name);
        }
    }
    dispatch_push(L, function_find(OWNER_NODE, "add_child"));
    reader.add_child = lua_gettop(L);
    reader.defined = json_object_get(root, "define");
    script->reader = &reader;
    script->context.sandbox.locate = locate;
    check_top(&reader, root);
    set_state(&reader, root);
    render(&reader, root);
    script->context.sandbox.locate = NULL;
    script->reader = NULL;
}

#endif
