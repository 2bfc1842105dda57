/* The one C function behind every gr function and node method: reads the arguments that the table's row describes, runs
 * the row's plain C function, and returns its result. Names that do not exist are errors with a suggestion, or with
 * --lenient ghosts. */
#include "script/dispatch_internal.h"

#include "base/suggestion.h"
#include "base/version.h"
#include "call/arguments.h"
#include "compat/lenient.h"
#include "compat/lenient_handles.h"
#include "formats/font.h"
#include "record/record.h"
#include "script/gr_frames_internal.h"
#include "script/gr_model_internal.h"
#include "script/gr_words_internal.h"
#include "script/scene_write_internal.h"
#include "script/table_internal.h"
#include "settings/foreign_words.h"

#include <assert.h>
#include <lauxlib.h>
#include <limits.h>
#include <string.h>

static void push_numbers(lua_State *L, const double numbers[3]) {
    lua_createtable(L, 3, 0);
    for (int k = 0; k < 3; k++) {
        lua_pushnumber(L, numbers[k]);
        lua_rawseti(L, -2, k + 1);
    }
}

static int answer_bounds(lua_State *L, const struct box *box) {
    push_numbers(L, (const double[3]){box->min.x, box->min.y, box->min.z});
    push_numbers(L, (const double[3]){box->max.x, box->max.y, box->max.z});
    return 2;
}

static int answer_faces(lua_State *L, const struct mesh *mesh) {
    uint32_t count, corners;
    const double(*vertices)[3] = mesh_vertices(mesh, &count);
    lua_createtable(L, (int)(count & INT_MAX), 0);
    for (uint32_t i = 0; i < count; i++) {
        push_numbers(L, vertices[i]);
        lua_rawseti(L, -2, (lua_Integer)i + 1);
    }
    count = mesh_face_count(mesh);
    lua_createtable(L, (int)(count & INT_MAX), 0);
    for (uint32_t f = 0; f < count; f++) {
        const uint32_t *face = mesh_face(mesh, f, &corners);
        lua_createtable(L, (int)(corners & INT_MAX), 0);
        for (uint32_t k = 0; k < corners; k++) {
            lua_pushinteger(L, (lua_Integer)face[k]);
            lua_rawseti(L, -2, (lua_Integer)k + 1);
        }
        lua_rawseti(L, -2, (lua_Integer)f + 1);
    }
    return 2;
}

/* A table for each letter: its number, its position and its contours as gr.prism accepts them. */
static int answer_glyphs(lua_State *L, const struct font_text *text) {
    lua_createtable(L, (int)text->count, 4);
    for (uint32_t i = 0; i < text->count; i++) {
        const struct font_glyph *glyph = &text->glyphs[i];
        lua_createtable(L, 0, 5);
        lua_pushinteger(L, glyph->code);
        lua_setfield(L, -2, "code");
        lua_pushnumber(L, glyph->x);
        lua_setfield(L, -2, "x");
        lua_pushnumber(L, glyph->advance);
        lua_setfield(L, -2, "advance");
        lua_pushboolean(L, glyph->missing);
        lua_setfield(L, -2, "missing");
        /* Its contours: lists of pairs. */
        lua_createtable(L, (int)glyph->contour_count, 0);
        for (uint32_t c = 0; c < glyph->contour_count; c++) {
            uint32_t first = glyph->starts[c], count = glyph->starts[c + 1] - first;
            lua_createtable(L, (int)count, 0);
            for (uint32_t k = 0; k < count; k++) {
                lua_createtable(L, 2, 0);
                for (int d = 0; d < 2; d++) {
                    lua_pushnumber(L, glyph->points[first + k][d]);
                    lua_rawseti(L, -2, d + 1);
                }
                lua_rawseti(L, -2, (lua_Integer)k + 1);
            }
            lua_rawseti(L, -2, (lua_Integer)c + 1);
        }
        lua_setfield(L, -2, "contours");
        lua_rawseti(L, -2, (lua_Integer)i + 1);
    }
    /* The measures of the text. */
    lua_pushnumber(L, text->width);
    lua_setfield(L, -2, "width");
    lua_pushnumber(L, text->ascender);
    lua_setfield(L, -2, "ascender");
    lua_pushnumber(L, text->descender);
    lua_setfield(L, -2, "descender");
    lua_pushnumber(L, text->line);
    lua_setfield(L, -2, "line");
    return 1;
}
_Static_assert(RESULT_FRAMES == 12, "a new result kind needs its line in answer()");

static int answer(lua_State *L, const struct script_function *function, const struct script_result *result) {
    if (function->in_lua)
        return words_answer(L, function);
    switch (function->result) {
    case RESULT_NOTHING:
        return 0;
    case RESULT_SELF:
        lua_pushvalue(L, 1);
        return 1;
    case RESULT_NODE:
        handle_push(L, HANDLE_NODE, result->pointer);
        return 1;
    case RESULT_MATERIAL:
        handle_push(L, HANDLE_MATERIAL, result->pointer);
        return 1;
    case RESULT_LIGHT:
        handle_push(L, HANDLE_LIGHT, result->pointer);
        return 1;
    case RESULT_TEXTURE:
        handle_push(L, HANDLE_TEXTURE, result->pointer);
        return 1;
    case RESULT_BOUNDS:
        return answer_bounds(L, result->pointer);
    case RESULT_FACES:
        return answer_faces(L, result->mesh);
    case RESULT_FOG:
        handle_push(L, HANDLE_FOG, result->pointer);
        return 1;
    case RESULT_MEDIUM:
        handle_push(L, HANDLE_MEDIUM, result->pointer);
        return 1;
    case RESULT_SKY:
        handle_push(L, HANDLE_SKY, result->pointer);
        return 1;
    case RESULT_GLYPHS:
        return answer_glyphs(L, result->pointer);
    case RESULT_FRAMES:
        return frames_run(L, result);
    }
    return 0;
}

/* The node before the colon. */
static struct node *self_of(struct script_context *c, const struct script_function *function) {
    const struct handle *handle = handle_at(c->sandbox.lua, 1);
    if (!handle || handle->type != HANDLE_NODE) {
        const char *given = value_words(c->sandbox.lua, 1);
        char title[96];
        (void)sandbox_enter(c->sandbox.lua);
        sandbox_raise(&c->sandbox, "%s must be called with a colon on a node, as in n:%s(...), not on %s",
                      function_title(function, title), function->name, given);
    }
    return handle->pointer;
}

/* Whether it creates a shape without a material: a warning may have to name its line. */
static bool lacks_material(const struct script_function *function, const struct script_value *args) {
    for (int k = 0; function->result == RESULT_NODE && k < function->parameter_count; k++)
        if (function->parameters[k].kind == KIND_MATERIAL)
            return !args[k].given;
    return false;
}

static int dispatch(lua_State *L) {
    const struct script_function *function = lua_touserdata(L, lua_upvalueindex(1));
    struct script_context *c = context_of(L);
    struct script_value args[PARAMETER_LIMIT];
    if (c->sandbox.ended || c->sandbox.fatal.kind != ERROR_NONE) /* a finalizer of the script that runs after its end */
        sandbox_raise_fatal(L);
    c->sandbox.lua = L;
    const char *activity = record_activity(L);
    if (activity) {
        char title[96];
        luaL_error(L, "%s cannot be called by a %s", function_title(function, title), activity);
    }
    memset(args, 0, (size_t)function->parameter_count * sizeof *args);
    context_begin_call(c, function);
    c->scene.line = 0;
    struct script_result result = {0};
    if (c->lenient) {
        int substitutes = lenient_call(c, function, &result);
        return substitutes >= 0 ? substitutes : answer(L, function, &result);
    }
    int first = 1;
    if (function->owner == OWNER_NODE) {
        struct node *node = self_of(c, function);
        args[0] = (struct script_value){.given = true, .node = node};
        c->sandbox.running.subject = node->name;
        first = 2;
    }
    if (c->noted)
        scene_write_begin(c);
    (void)arguments_read(c, function, first, args); /* there are no ghosts */
    if (lacks_material(function, args))
        context_note_line(c);

    struct error error = {0};
    if (!function->run(c, args, &result, &error))
        sandbox_raise_error(&c->sandbox, &error);
    if (c->noted)
        scene_write_call(c, function, args, &result);
    return answer(L, function, &result);
}

/* Pushes the function of that owner whose name has the same letters, as in addChild; false: there is none. */
static bool push_alike(lua_State *L, enum function_owner owner, const char *name) {
    for (int k = 0; k < function_count(); k++) {
        const char *a = function_at(k)->name, *b = name;
        while (*a && *b) {
            a += *a == '_', b += *b == '_';
            if ((*a | ' ') != (*b | ' '))
                break;
            a++, b++;
        }
        if (function_at(k)->owner == owner && *a == '\0' && *b == '\0') {
            dispatch_push(L, function_at(k));
            return true;
        }
    }
    return false;
}

/* With --lenient: pushes a function of almost that name, or a ghost, with a warning. */
static void push_substitute(struct script_context *c, enum function_owner owner, const char *name) {
    const char *before = owner_words(owner);
    c->sandbox.running.name = NULL;
    if (push_alike(c->sandbox.lua, owner, name)) {
        sandbox_warn(&c->sandbox, "%s%.100s exists only in another spelling", before, name);
        return;
    }
    sandbox_warn(&c->sandbox, "%s%.100s does not exist and is ignored", before, name);
    lenient_push_ghost(c->sandbox.lua, name, owner == OWNER_NODE);
}

_Noreturn static void no_such_name(struct script_context *c, enum function_owner owner, const char *name) {
    const char *before = owner_words(owner);
    c->sandbox.running.name = NULL;
    const char *use = owner == OWNER_GR ? foreign_function(name) : foreign_method(name);
    if (use)
        sandbox_raise(&c->sandbox, "%s%.100s does not exist; use %s", before, name, use);
    struct suggestion suggestion;
    suggest_begin(&suggestion, name);
    for (int k = 0; k < function_count(); k++)
        if (function_at(k)->owner == owner)
            suggest_offer(&suggestion, function_at(k)->name);
    for (size_t k = 0; owner == OWNER_GR && value_function_at(k); k++)
        suggest_offer(&suggestion, value_function_at(k)->name);
    if (suggestion.best)
        sandbox_raise(&c->sandbox, "%s%.100s does not exist; did you mean %s%s?", before, name, before,
                      suggestion.best);
    sandbox_raise(&c->sandbox, "%s%.100s does not exist (gray --man lists all)", before, name);
}

/* gr.NAME for a name that does not exist. With --lenient the ghost is stored in the table, so there is one warning. */
static int missing_function(lua_State *L) {
    struct script_context *c = context_of(L);
    c->sandbox.lua = L;
    c->sandbox.running.subject = NULL;
    if (lua_type(L, 2) != LUA_TSTRING) {
        lua_pushnil(L);
        return 1;
    }
    if (!c->lenient)
        no_such_name(c, OWNER_GR, lua_tostring(L, 2));
    lua_settop(L, 2);
    push_substitute(c, OWNER_GR, lua_tostring(L, 2));
    lua_pushvalue(L, 2);
    lua_pushvalue(L, 3);
    lua_rawset(L, 1);
    return 1;
}

/* node.NAME: the methods; upvalue 1 is their table. */
static int node_index(lua_State *L) {
    lua_settop(L, 2);
    lua_pushvalue(L, 2);
    if (lua_rawget(L, lua_upvalueindex(1)) != LUA_TNIL)
        return 1;
    struct script_context *c = context_of(L);
    c->sandbox.lua = L;
    const struct handle *handle = handle_at(L, 1);
    assert(handle && handle->type == HANDLE_NODE); /* scripts cannot reach the metatable */
    c->sandbox.running.subject = ((const struct node *)handle->pointer)->name;
    if (lua_type(L, 2) != LUA_TSTRING)
        return 1;
    if (models_push_field(L, handle->pointer, lua_tostring(L, 2)))
        return 1;
    if (!c->lenient)
        no_such_name(c, OWNER_NODE, lua_tostring(L, 2));
    lua_settop(L, 2);
    if (lenient_own_field(L))
        return 1;
    lua_settop(L, 2);
    push_substitute(c, OWNER_NODE, lua_tostring(L, 2));
    lua_pushvalue(L, 2);
    lua_pushvalue(L, 3);
    lua_rawset(L, lua_upvalueindex(1));
    return 1;
}

void dispatch_push(lua_State *L, const struct script_function *function) {
    lua_pushlightuserdata(L, (void *)(uintptr_t)function);
    lua_pushcclosure(L, dispatch, 1);
}

const struct script_function *dispatch_function(lua_State *L) {
    (void)lua_getupvalue(L, -1, 1);
    const struct script_function *function = lua_touserdata(L, -1);
    lua_pop(L, 1);
    return function;
}

static void push_functions(lua_State *L, enum function_owner owner) {
    lua_createtable(L, 0, function_count());
    for (int k = 0; k < function_count(); k++) {
        if (function_at(k)->owner != owner)
            continue;
        dispatch_push(L, function_at(k));
        lua_setfield(L, -2, function_at(k)->name);
    }
}

static void set_index(lua_State *L, const void *metatable_key, lua_CFunction function, int upvalues) {
    lua_pushcclosure(L, function, upvalues);
    lua_rawgetp(L, LUA_REGISTRYINDEX, metatable_key);
    lua_insert(L, -2);
    lua_setfield(L, -2, "__index");
    lua_pop(L, 1);
}

void dispatch_open(lua_State *L) {
    /* Methods of nodes. */
    push_functions(L, OWNER_NODE);
    set_index(L, handle_key(HANDLE_NODE), node_index, 1);

    /* Functions of gr; --lenient keeps them as they are. */
    if (context_of(L)->lenient) {
        push_functions(L, OWNER_GR);
        context_keep_functions(L);
    }
    push_functions(L, OWNER_GR);
    for (size_t k = 0; value_function_at(k); k++) {
        lua_pushcfunction(L, value_function_at(k)->run);
        lua_setfield(L, -2, value_function_at(k)->name);
    }
    lua_pushstring(L, GRAY_VERSION);
    lua_setfield(L, -2, "version");
    /* A name that does not exist is an error with a suggestion. */
    lua_createtable(L, 0, 2);
    lua_pushcfunction(L, missing_function);
    lua_setfield(L, -2, "__index");
    lua_pushboolean(L, 0);
    lua_setfield(L, -2, "__metatable");
    lua_setmetatable(L, -2);
    /* gr is a global and a module. */
    lua_getfield(L, LUA_REGISTRYINDEX, LUA_LOADED_TABLE);
    lua_pushvalue(L, -2);
    lua_setfield(L, -2, "gr");
    lua_pop(L, 1);
    lua_setglobal(L, "gr");
}
