/* The table as documents: the manual page's list of functions (plain text, 100 columns) and the annotation file for
 * editors (LuaLS, `---@meta`). Text grows in the caller's arena; NULL without memory. */
#include "script/document.h"

#include "base/arena.h"
#include "base/unreachable.h"
#include "script/table_internal.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { COLUMNS = 100, LINE_SIZE = 1024, CHOICES_SIZE = 256 };

/* Text that grows by doubling; abandoned blocks stay in the arena, at most as much again. */
struct document {
    struct arena *arena;
    char *text;
    size_t used, capacity;
    bool failed;
};

__attribute__((format(printf, 2, 3))) static void add(struct document *document, const char *format, ...) {
    char line[LINE_SIZE];
    va_list arguments;
    va_start(arguments, format);
    size_t size = (size_t)vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    assert(size < sizeof line); /* the texts of the table are constant, and tests write all of them */
    if (document->used + size + 1 > document->capacity) {
        size_t capacity = 2 * document->capacity + LINE_SIZE;
        char *grown = arena_alloc(document->arena, capacity);
        if (!grown) {
            document->failed = true;
            document->used = document->capacity = 0;
            return;
        }
        if (document->used > 0)
            memcpy(grown, document->text, document->used);
        document->text = grown;
        document->capacity = capacity;
    }
    memcpy(document->text + document->used, line, size + 1);
    document->used += size;
}

/* Breaks words into lines of COLUMNS characters, every line but the first indented; `column` is the start of the first
 * one. */
static void add_filled(struct document *document, int indent, int column, const char *text) {
    bool first = true;
    while (*text) {
        int length = (int)strcspn(text, " ");
        if (!first && column + 1 + length > COLUMNS) {
            add(document, "\n%*s", indent, "");
            column = indent;
        } else if (!first) {
            add(document, " ");
            column++;
        }
        first = false;
        add(document, "%.*s", length, text);
        column += length;
        text += length;
        while (*text == ' ')
            text++;
    }
    add(document, "\n");
}

/* "> 0 and < 180", or "". */
static void range_words(const struct script_parameter *p, char *out, size_t size) {
    out[0] = '\0';
    if (p->low == 0 && p->high == 0) {
        snprintf(out, size, "%s", p->flags & NOT_ZERO ? "not 0" : "");
        return;
    }
    bool high = p->high < (double)INFINITY;
    if (high && !(p->flags & (LOW_OPEN | HIGH_OPEN)) && p->low >= 0)
        snprintf(out, size, "%.15g to %.15g", p->low, p->high);
    else if (high)
        snprintf(out, size, "%s %.15g and %s %.15g", p->flags & LOW_OPEN ? ">" : ">=", p->low,
                 p->flags & HIGH_OPEN ? "<" : "<=", p->high);
    else
        snprintf(out, size, "%s %.15g", p->flags & LOW_OPEN ? ">" : ">=", p->low);
}

static void choices_words(const struct script_parameter *p, const char *separator, char *out, size_t size) {
    size_t used = 0;
    out[0] = '\0';
    for (const char *word = p->choices; word && *word;) {
        int length = (int)strcspn(word, " ");
        used += (size_t)snprintf(out + used, size - used, "%s'%.*s'", used == 0 ? "" : separator, length, word);
        word += length + (word[length] == ' ');
    }
}

/* "radius (a number, > 0; default 1): Radius." */
static void describe_parameter(const struct script_parameter *p, char out[LINE_SIZE]) {
    char range[96], choices[CHOICES_SIZE];
    bool is_long = p->choices && strlen(p->choices) > 60; /* more than a line holds */
    range_words(p, range, sizeof range);
    choices_words(p, is_long ? ", " : "|", choices, sizeof choices);
    bool or_texture = p->flags & OR_TEXTURE && p->kind != KIND_IMAGE;
    size_t used =
        (size_t)snprintf(out, LINE_SIZE, "%s (%s%s", p->name, p->kind == KIND_CHOICE ? choices : kind_words(p->kind),
                         or_texture            ? " or a texture"
                         : p->flags & OR_CURVE ? " or a function"
                                               : "");
    if (range[0])
        used += (size_t)snprintf(out + used, LINE_SIZE - used, ", %s", range);
    if (p->unit)
        used += (size_t)snprintf(out + used, LINE_SIZE - used, ", in %s", p->unit);
    if (p->fallback)
        used += (size_t)snprintf(out + used, LINE_SIZE - used, "; default %.*s", (int)strcspn(p->fallback, "|"),
                                 p->fallback);
    else if (p->flags & OPTIONAL)
        used += (size_t)snprintf(out + used, LINE_SIZE - used, "; optional");
    snprintf(out + used, LINE_SIZE - used, "): %s", p->help);
}

/* A form may continue with any number of nodes. */
static bool takes_more(const struct script_function *function) {
    for (int k = 0; k < function->parameter_count; k++)
        if (function->parameters[k].flags & REST)
            return true;
    return false;
}

static void write_function(struct document *document, const struct script_function *function) {
    char title[96];
    function_title(function, title);
    for (int k = 0; k < FORM_LIMIT && function->forms[k]; k++) {
        const char *form = function->forms[k], *separator = "";
        int index;
        bool optional;
        add(document, "%s(", title);
        while (form_next(function, &form, &index, &optional)) {
            add(document, "%s%s%s", separator, function->parameters[index].name, optional ? "?" : "");
            separator = ", ";
        }
        add(document, "%s)\n", takes_more(function) ? ", ..." : function_renders(function) ? ", fields?" : "");
    }
    if (function_takes_names(function))
        add(document, "%s{%s = ..., ...}\n", title, function->parameters[function->owner == OWNER_NODE].name);
    add(document, "    ");
    add_filled(document, 4, 4, function->help);
    for (int k = function->owner == OWNER_NODE; k < function->parameter_count; k++) {
        char line[LINE_SIZE];
        describe_parameter(&function->parameters[k], line);
        add(document, "      ");
        add_filled(document, 10, 6, line);
    }
    add(document, "\n");
}

const char *script_manual(struct arena *arena) {
    struct document document = {.arena = arena};
    for (int k = 0; k < function_count(); k++)
        write_function(&document, function_at(k));
    for (size_t k = 0; value_function_at(k); k++) {
        const struct value_function *function = value_function_at(k);
        add(&document, "gr.%s(%s)\n    ", function->name, function->parameters);
        add_filled(&document, 4, 4, function->help);
        add(&document, "\n");
    }
    return document.failed ? NULL : document.text;
}

#define KIND_ANNOTATION(kind, name, words, annotation, like) [kind] = (annotation),

static const char *annotation_kind(const struct script_parameter *p, char out[CHOICES_SIZE]) {
    static const char *const annotations[] = {KIND_LIST(KIND_ANNOTATION)};
    if (p->kind == KIND_COLOUR && (p->flags & (OR_PROFILE | OR_FUNCTION)))
        return "gr.triple|string|gr.texture|function";
    if (p->kind == KIND_IMAGE && (p->flags & OR_TEXTURE))
        return "string|gr.texture|function";
    if (annotations[p->kind])
        return annotations[p->kind];
    choices_words(p, "|", out, CHOICES_SIZE);
    if (p->flags & OR_NUMBER)
        (void)snprintf(out + strlen(out), CHOICES_SIZE - strlen(out), "|number");
    if (p->flags & OR_CURVE)
        (void)snprintf(out + strlen(out), CHOICES_SIZE - strlen(out), "|fun(x: number): number");
    return out;
}

static const char *annotation_type(const struct script_parameter *p, char out[CHOICES_SIZE]) {
    const char *type = annotation_kind(p, out);
    if (!(p->flags & OR_TEXTURE) || p->kind == KIND_IMAGE)
        return type;
    snprintf(out, 200, "%s|gr.texture|function", type);
    return out;
}

static const char *annotation_result(const struct script_function *function) {
    switch (function->result) {
    case RESULT_NOTHING:
    case RESULT_FRAMES:
        return NULL;
    case RESULT_SELF:
    case RESULT_NODE:
        return "gr.node";
    case RESULT_MATERIAL:
        return "gr.material";
    case RESULT_LIGHT:
        return "gr.light";
    case RESULT_TEXTURE:
        return "gr.texture";
    case RESULT_BOUNDS:
        return "number[], number[]";
    case RESULT_FACES:
        return "number[][], integer[][]";
    case RESULT_FOG:
        return "gr.fog";
    case RESULT_SKY:
        return "gr.sky";
    case RESULT_GLYPHS:
        return "gr.glyphs";
    }
    UNREACHABLE("a result of no kind");
}

static void annotate_fields(struct document *document, const struct script_function *function) {
    const char *owner = function->owner == OWNER_NODE ? "node." : "";
    add(document, "---@class gr.%s%s.fields\n", owner, function->name);
    for (int k = function->owner == OWNER_NODE; k < function->parameter_count; k++) {
        const struct script_parameter *p = &function->parameters[k];
        char type[CHOICES_SIZE], line[LINE_SIZE];
        describe_parameter(p, line);
        add(document, "---@field %s%s %s %s\n", p->name, p->flags & OPTIONAL ? "?" : "", annotation_type(p, type),
            line);
    }
    add(document, "\n");
}

/* ": gr.node", if a function returns a value. */
static void add_result(struct document *document, const struct script_function *function) {
    const char *result = annotation_result(function);
    if (result)
        add(document, ": %s", result);
}

static void annotate_overload(struct document *document, const struct script_function *function, const char *form) {
    const char *separator = "";
    int index;
    bool optional;
    add(document, "---@overload fun(");
    if (function->owner == OWNER_NODE) {
        add(document, "self: gr.node");
        separator = ", ";
    }
    while (form_next(function, &form, &index, &optional)) {
        char type[CHOICES_SIZE];
        const struct script_parameter *p = &function->parameters[index];
        add(document, "%s%s%s: %s", separator, p->name, optional ? "?" : "", annotation_type(p, type));
        separator = ", ";
    }
    add(document, "%s)", takes_more(function) ? ", ...: gr.node" : "");
    add_result(document, function);
    add(document, "\n");
}

/* One line for each result: LuaLS numbers them. */
static void annotate_results(struct document *document, const char *results) {
    while (*results) {
        size_t length = strcspn(results, ",");
        add(document, "---@return %.*s\n", (int)length, results);
        results += length;
        results += strspn(results, ", ");
    }
}

static void annotate_function(struct document *document, const struct script_function *function) {
    const char *form = function->forms[0], *result = annotation_result(function), *separator = "";
    bool table_form = function_takes_names(function), optional;
    int index;
    char names[LINE_SIZE] = "";
    add(document, "---%s\n", function->help);
    while (form_next(function, &form, &index, &optional)) {
        char type[CHOICES_SIZE], line[LINE_SIZE];
        const struct script_parameter *p = &function->parameters[index];
        describe_parameter(p, line);
        add(document, "---@param %s%s %s %s\n", p->name, optional ? "?" : "", annotation_type(p, type), line);
        size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, "%s%s", separator, p->name);
        separator = ", ";
    }
    if (takes_more(function)) {
        size_t used = strlen(names);
        add(document, "---@param ... gr.node\n");
        snprintf(names + used, sizeof names - used, ", ...");
    }
    if (function_renders(function)) {
        size_t used = strlen(names);
        add(document, "---@param fields? gr.%s%s.fields Fields that are no arguments before it\n",
            function->owner == OWNER_NODE ? "node." : "", function->name);
        (void)snprintf(names + used, sizeof names - used, ", fields");
    }
    if (result)
        annotate_results(document, result);
    for (int k = 1; k < FORM_LIMIT && function->forms[k]; k++)
        annotate_overload(document, function, function->forms[k]);
    if (table_form) {
        const char *self = function->owner == OWNER_NODE ? "self: gr.node, " : "";
        add(document, "---@overload fun(%sfields: gr.%s%s.fields)", self, self[0] ? "node." : "", function->name);
        add_result(document, function);
        add(document, "\n");
    }
    add(document, "function %s%s(%s) end\n\n", function->owner == OWNER_GR ? "gr." : "node:", function->name, names);
}

const char *script_annotations(struct arena *arena) {
    struct document document = {.arena = arena};
    add(&document,
        "---@meta\n\n"
        "-- The gr functions for editors that understand LuaLS annotations. Written by `gray --annotations` from\n"
        "-- the table in src/script/table.c; a test checks that it is current.\n\n"
        "---@alias gr.triple number[] three numbers: a point, a direction, a colour\n"
        "---@class gr.material\n---@class gr.light\n---@class gr.texture\n"
        "---@field at fun(self: gr.texture, u: number, v: number): gr.vector, number\n---@class gr.fog\n---@class "
        "gr.sky\n");
    add(&document,
        "---@class gr.vector: number[]\n---@field x number\n---@field y number\n---@field z number\n"
        "---@field dot fun(self: gr.vector, b: gr.triple): number\n"
        "---@field cross fun(self: gr.vector, b: gr.triple): gr.vector\n"
        "---@field length fun(self: gr.vector): number\n---@field normalize fun(self: gr.vector): gr.vector\n"
        "---@field mix fun(self: gr.vector, b: gr.triple, t: any): gr.vector\n"
        "---@field clamp fun(self: gr.vector, low: any, high: any): gr.vector\n"
        "---@operator add(any): gr.vector\n---@operator sub(any): gr.vector\n---@operator mul(any): gr.vector\n"
        "---@operator div(any): gr.vector\n---@operator unm: gr.vector\n");
    add(&document, "---@class gr.glyph\n---@field code integer\n---@field x number\n---@field advance number\n"
                   "---@field missing boolean\n---@field contours number[][][]\n"
                   "---@class gr.glyphs: gr.glyph[]\n---@field width number\n---@field ascender number\n"
                   "---@field descender number\n---@field line number\n"
                   "---@class gr.node\n"
                   "local node = {}\n\ngr = {}\n\n---The version of the renderer.\ngr.version = ''\n"
                   "---In an animation: the seconds since its first frame, else 0.\ngr.time = 0.0\n"
                   "---Its argument t, from 0 to 1.\ngr.clock = 0.0\n"
                   "---The number of the frame, from 1; 0 outside of animations.\ngr.frame = 0\n\n");
    for (int k = 0; k < function_count(); k++) {
        const struct script_function *function = function_at(k);
        if (function_takes_names(function))
            annotate_fields(&document, function);
        annotate_function(&document, function);
    }
    for (size_t k = 0; value_function_at(k); k++) {
        const struct value_function *function = value_function_at(k);
        add(&document, "---%s\n", function->help);
        annotate_results(&document, function->result);
        add(&document, "function gr.%s(%s) end\n\n", function->name, function->parameters);
    }
    return document.failed ? NULL : document.text;
}
