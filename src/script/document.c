/* The table as documents: entries of the manual, and the annotation file for editors (LuaLS, `---@meta`). */
#include "script/document.h"

#include "base/document.h"
#include "base/unreachable.h"
#include "script/table_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { CHOICES_SIZE = 256 };

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
static void describe_parameter(const struct script_parameter *p, char out[DOCUMENT_LINE]) {
    char range[96], choices[CHOICES_SIZE];
    bool is_long = p->choices && strlen(p->choices) > 60; /* more than a line holds */
    range_words(p, range, sizeof range);
    choices_words(p, is_long ? ", " : "|", choices, sizeof choices);
    const char *more = p->flags & OR_TEXTURE && p->kind != KIND_IMAGE    ? " or a texture"
                       : p->flags & OR_CURVE                             ? " or a function"
                       : p->flags & OR_COMPASS                           ? " or {azimuth = ..., elevation = ...}"
                       : p->flags & OR_PAIR                              ? " or two numbers"
                       : p->flags & OR_SKY                               ? " or a sky"
                       : p->flags & OR_FILE                              ? ", a function or the name of a file"
                       : p->kind == KIND_BOOLEAN && p->flags & OR_NUMBER ? " or a number"
                       : p->kind == KIND_NUMBER && choices[0]            ? " or "
                                                                         : "";
    size_t used = (size_t)snprintf(out, DOCUMENT_LINE, "%s (%s%s%s", p->name,
                                   p->kind == KIND_CHOICE ? choices : kind_words(p->kind), more,
                                   p->kind == KIND_NUMBER ? choices : "");
    if (range[0])
        used += (size_t)snprintf(out + used, DOCUMENT_LINE - used, ", %s", range);
    if (p->unit)
        used += (size_t)snprintf(out + used, DOCUMENT_LINE - used, ", in %s", p->unit);
    if (p->fallback)
        used += (size_t)snprintf(out + used, DOCUMENT_LINE - used, "; default %.*s", (int)strcspn(p->fallback, "|"),
                                 p->fallback);
    else if (p->flags & OPTIONAL)
        used += (size_t)snprintf(out + used, DOCUMENT_LINE - used, "; optional");
    snprintf(out + used, DOCUMENT_LINE - used, "): %s", p->help);
}

/* A form may continue with any number of nodes. */
static bool takes_more(const struct script_function *function) {
    for (int k = 0; k < function->parameter_count; k++)
        if (function->parameters[k].flags & REST)
            return true;
    return false;
}

/* "gr.sphere(centre, radius, material?)", a line for each form, the table form last. */
static void function_forms(const struct script_function *function, struct document *out) {
    char title[96];
    function_title(function, title);
    for (int k = 0; k < FORM_LIMIT && function->forms[k]; k++) {
        const char *form = function->forms[k], *separator = "";
        int index;
        bool optional;
        document_add(out, "%s%s(", k > 0 ? "\n" : "", title);
        while (form_next(function, &form, &index, &optional)) {
            document_add(out, "%s%s%s", separator, function->parameters[index].name, optional ? "?" : "");
            separator = ", ";
        }
        document_add(out, "%s)", takes_more(function) ? ", ..." : function_renders(function) ? ", fields?" : "");
    }
    if (function_takes_names(function))
        document_add(out, "\n%s{%s = ..., ...}", title, function->parameters[function->owner == OWNER_NODE].name);
}

/* An entry for the parameter: "(a number, > 0; default 1): Radius." */
static void add_parameter(struct document *document, const struct script_parameter *p) {
    char line[DOCUMENT_LINE];
    describe_parameter(p, line);
    document_entry(document, DOCUMENT_ARGUMENT, p->name, line + strlen(p->name) + 1);
}

static void describe_function(struct document *document, const struct script_function *function) {
    struct document forms = {.arena = document->arena};
    function_forms(function, &forms);
    document_entry(document, DOCUMENT_FUNCTION, forms.text ? forms.text : "", function->help);
    document->failed = document->failed || forms.failed;
    for (int k = function->owner == OWNER_NODE; k < function->parameter_count; k++)
        add_parameter(document, &function->parameters[k]);
    document_gap(document);
}

static void describe_value_function(struct document *document, const struct value_function *function) {
    char term[256];
    (void)snprintf(term, sizeof term, "gr.%s(%s)", function->name, function->parameters);
    document_entry(document, DOCUMENT_FUNCTION, term, function->help);
    document_gap(document);
}

void script_describe_function(struct document *document, const char *name) {
    for (int f = 0; f < function_count(); f++)
        if (!name || strcmp(function_at(f)->name, name) == 0)
            describe_function(document, function_at(f));
    for (size_t k = 0; value_function_at(k); k++)
        if (!name || strcmp(value_function_at(k)->name, name) == 0)
            describe_value_function(document, value_function_at(k));
}

/* Adds the functions that have this parameter with the same description; false if an earlier one has it. */
static bool add_owners(struct document *out, const struct script_function *owner, const struct script_parameter *p) {
    char line[DOCUMENT_LINE], other[DOCUMENT_LINE], title[96];
    const char *separator = " Of ";
    bool found = false;
    describe_parameter(p, line);
    document_add(out, "%s", line + strlen(p->name) + 1);
    for (int f = 0; f < function_count(); f++) {
        const struct script_function *function = function_at(f);
        found = found || function == owner;
        for (int k = function->owner == OWNER_NODE; k < function->parameter_count; k++) {
            if (strcmp(function->parameters[k].name, p->name) != 0)
                continue;
            describe_parameter(&function->parameters[k], other);
            if (strcmp(line, other) != 0)
                continue;
            if (!found)
                return false;
            function_title(function, title);
            document_add(out, "%s%s", separator, title);
            separator = ", ";
        }
    }
    return true;
}

void script_describe_field(struct document *document, const char *name) {
    for (int f = 0; f < function_count(); f++) {
        const struct script_function *function = function_at(f);
        for (int k = function->owner == OWNER_NODE; k < function->parameter_count; k++) {
            struct document text = {.arena = document->arena};
            if (strcmp(function->parameters[k].name, name) == 0 &&
                add_owners(&text, function, &function->parameters[k]))
                document_entry(document, DOCUMENT_ARGUMENT, name, text.text ? text.text : "");
            document->failed = document->failed || text.failed;
        }
    }
}

void script_each_name(void (*visit)(void *context, const char *owner, const char *name, const char *help),
                      void *context) {
    for (int f = 0; f < function_count(); f++)
        visit(context, function_at(f)->owner == OWNER_GR ? "gr." : "node:", function_at(f)->name, function_at(f)->help);
    for (size_t k = 0; value_function_at(k); k++)
        visit(context, "gr.", value_function_at(k)->name, value_function_at(k)->help);
    for (int f = 0; f < function_count(); f++)
        for (int k = function_at(f)->owner == OWNER_NODE; k < function_at(f)->parameter_count; k++)
            visit(context, "", function_at(f)->parameters[k].name, function_at(f)->parameters[k].help);
}

#define KIND_ANNOTATION(kind, name, words, annotation, like) [kind] = (annotation),

static const char *annotation_kind(const struct script_parameter *p, char out[CHOICES_SIZE]) {
    static const char *const annotations[] = {KIND_LIST(KIND_ANNOTATION)};
    if (p->kind == KIND_COLOUR && (p->flags & (OR_PROFILE | OR_FUNCTION)))
        return "gr.triple|string|gr.texture|function";
    if (p->kind == KIND_NUMBERS && (p->flags & OR_FILE))
        return "number|number[]|string|gr.texture|function";
    if (p->kind == KIND_IMAGE && (p->flags & OR_TEXTURE))
        return "string|gr.texture|function";
    if (p->kind == KIND_IMAGE && (p->flags & OR_SKY))
        return "string|gr.texture|gr.sky";
    if (p->kind == KIND_TEXT && (p->flags & OR_PAIR))
        return "string|number[]";
    if (p->kind == KIND_BOOLEAN && (p->flags & OR_NUMBER))
        return "boolean|number";
    if (p->kind == KIND_DIRECTION && (p->flags & OR_COMPASS))
        return "gr.triple|{azimuth: number, elevation: number}";
    choices_words(p, "|", out, CHOICES_SIZE);
    if (p->kind == KIND_NUMBER && out[0])
        return strcat(out, "|number");
    if (annotations[p->kind])
        return annotations[p->kind];
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
    if (function->passes)
        return "gr.render.fields";
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
    case RESULT_MEDIUM:
        return "gr.medium";
    case RESULT_SKY:
        return "gr.sky";
    case RESULT_GLYPHS:
        return "gr.glyphs";
    }
    UNREACHABLE("a result of no kind");
}

static void annotate_fields(struct document *document, const struct script_function *function) {
    const char *owner = function->owner == OWNER_NODE ? "node." : "";
    document_add(document, "---@class gr.%s%s.fields%s\n", owner, function->name,
                 function->passes ? ": gr.render.fields" : "");
    for (int k = function->owner == OWNER_NODE; k < function->parameter_count; k++) {
        const struct script_parameter *p = &function->parameters[k];
        char type[CHOICES_SIZE], line[DOCUMENT_LINE];
        describe_parameter(p, line);
        document_add(document, "---@field %s%s %s %s\n", p->name, p->flags & OPTIONAL ? "?" : "",
                     annotation_type(p, type), line);
    }
    document_add(document, "\n");
}

/* ": gr.node", if a function returns a value. */
static void add_result(struct document *document, const struct script_function *function) {
    const char *result = annotation_result(function);
    if (result)
        document_add(document, ": %s", result);
}

static void annotate_overload(struct document *document, const struct script_function *function, const char *form) {
    const char *separator = "";
    int index;
    bool optional;
    document_add(document, "---@overload fun(");
    if (function->owner == OWNER_NODE) {
        document_add(document, "self: gr.node");
        separator = ", ";
    }
    while (form_next(function, &form, &index, &optional)) {
        char type[CHOICES_SIZE];
        const struct script_parameter *p = &function->parameters[index];
        document_add(document, "%s%s%s: %s", separator, p->name, optional ? "?" : "", annotation_type(p, type));
        separator = ", ";
    }
    document_add(document, "%s)", takes_more(function) ? ", ...: gr.node" : "");
    add_result(document, function);
    document_add(document, "\n");
}

/* One line for each result: LuaLS numbers them. */
static void annotate_results(struct document *document, const char *results) {
    while (*results) {
        size_t length = strcspn(results, ",");
        document_add(document, "---@return %.*s\n", (int)length, results);
        results += length;
        results += strspn(results, ", ");
    }
}

static void annotate_function(struct document *document, const struct script_function *function) {
    const char *form = function->forms[0], *result = annotation_result(function), *separator = "";
    bool table_form = function_takes_names(function), optional;
    int index;
    char names[DOCUMENT_LINE] = "";
    document_add(document, "---%s\n", function->help);
    /* The parameters of the first form. */
    while (form_next(function, &form, &index, &optional)) {
        char type[CHOICES_SIZE], line[DOCUMENT_LINE];
        const struct script_parameter *p = &function->parameters[index];
        describe_parameter(p, line);
        document_add(document, "---@param %s%s %s %s\n", p->name, optional ? "?" : "", annotation_type(p, type), line);
        size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, "%s%s", separator, p->name);
        separator = ", ";
    }
    if (takes_more(function)) {
        size_t used = strlen(names);
        document_add(document, "---@param ... gr.node\n");
        snprintf(names + used, sizeof names - used, ", ...");
    }
    if (function_renders(function)) {
        size_t used = strlen(names);
        document_add(document, "---@param fields? gr.%s%s.fields Fields that are no arguments before it\n",
                     function->owner == OWNER_NODE ? "node." : "", function->name);
        (void)snprintf(names + used, sizeof names - used, ", fields");
    }
    /* Its result, the other forms, and the form with named fields. */
    if (result)
        annotate_results(document, result);
    for (int k = 1; k < FORM_LIMIT && function->forms[k]; k++)
        annotate_overload(document, function, function->forms[k]);
    if (table_form) {
        const char *self = function->owner == OWNER_NODE ? "self: gr.node, " : "";
        document_add(document, "---@overload fun(%sfields: gr.%s%s.fields)", self, self[0] ? "node." : "",
                     function->name);
        add_result(document, function);
        document_add(document, "\n");
    }
    /* The function itself. */
    document_add(document, "function %s%s(%s) end\n\n", function->owner == OWNER_GR ? "gr." : "node:", function->name,
                 names);
}

void script_annotations(struct document *document) {
    document_add(
        document,
        "---@meta\n\n"
        "-- The gr functions for editors that understand LuaLS annotations. Written by `gray --annotations` from\n"
        "-- the table in src/script/table.c; a test checks that it is current.\n\n"
        "---@alias gr.triple number[] three numbers: a point, a direction, a colour\n"
        "---@class gr.material\n---@class gr.light\n---@class gr.texture\n"
        "---@field at fun(self: gr.texture, u: number, v: number): gr.vector, number\n---@class gr.fog\n"
        "---@class gr.medium\n---@class gr.sky\n");
    document_add(
        document,
        "---@class gr.vector: number[]\n---@field x number\n---@field y number\n---@field z number\n"
        "---@field dot fun(self: gr.vector, b: gr.triple): number\n"
        "---@field cross fun(self: gr.vector, b: gr.triple): gr.vector\n"
        "---@field length fun(self: gr.vector): number\n---@field normalize fun(self: gr.vector): gr.vector\n"
        "---@field mix fun(self: gr.vector, b: gr.triple, t: any): gr.vector\n"
        "---@field clamp fun(self: gr.vector, low: any, high: any): gr.vector\n"
        "---@operator add(any): gr.vector\n---@operator sub(any): gr.vector\n---@operator mul(any): gr.vector\n"
        "---@operator div(any): gr.vector\n---@operator unm: gr.vector\n");
    document_add(document, "---@class gr.glyph\n---@field code integer\n---@field x number\n---@field advance number\n"
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
            annotate_fields(document, function);
        annotate_function(document, function);
    }
    for (size_t k = 0; value_function_at(k); k++) {
        const struct value_function *function = value_function_at(k);
        document_add(document, "---%s\n", function->help);
        annotate_results(document, function->result);
        document_add(document, "function gr.%s(%s) end\n\n", function->name, function->parameters);
    }
}
