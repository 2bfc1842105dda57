/* A definition for each function that makes an object, one for each kind of argument, and one for each kind of object,
 * which is any of its functions or a reference. What a schema cannot say (a sorted interval, rows of equal length)
 * remains to the reader. */
#include "script/schema.h"

#include "base/document.h"
#include "script/scene_json_internal.h"
#include "script/table_internal.h"

#include <math.h>
#include <string.h>

extern const char *const schema_txt[];

static void add_words(struct document *document, const struct script_parameter *p) {
    const char *separator = "";
    for (const char *word = p->choices; *word; separator = ", ") {
        int length = (int)strcspn(word, " ");
        document_add(document, "%s\"%.*s\"", separator, length, word);
        if (p->kind == KIND_AXIS)
            document_add(document, ", \"%c\"", word[0] - 'a' + 'A');
        word += length + (word[length] == ' ');
    }
}

static void add_scalar(struct document *document, const struct script_parameter *p) {
    bool is_bounded = p->low != 0 || p->high != 0;
    document_add(document, "{\"type\": \"%s\"", p->kind == KIND_WHOLE ? "integer" : "number");
    if (is_bounded)
        document_add(document, ", \"%s\": %.17g", p->flags & LOW_OPEN ? "exclusiveMinimum" : "minimum", p->low);
    if (is_bounded && isfinite(p->high))
        document_add(document, ", \"%s\": %.17g", p->flags & HIGH_OPEN ? "exclusiveMaximum" : "maximum", p->high);
    document_add(document, "}");
}

static void add_reference(struct document *document, const char *name) {
    document_add(document, "{\"$ref\": \"#/$defs/%s\"}", name);
}

/* {"description": ..., "anyOf": [...]}: the kind, and what its flags accept beside it. */
static void add_parameter(struct document *document, const struct script_parameter *p) {
#define KIND_NAME(kind, word, ...) [kind] = "kind." word,
    static const char *const kinds[] = {KIND_LIST(KIND_NAME)};
    static const struct {
        unsigned flag;
        const char *name;
    } others[] = {{OR_TEXTURE, "texture"},
                  {OR_PROFILE | OR_FUNCTION, "texture"},
                  {OR_NUMBER, "kind.number"},
                  {OR_FILE, "kind.file"},
                  {OR_COMPASS, "compass"},
                  {OR_PAIR, "kind.interval"},
                  {OR_SKY, "sky"}};
    const bool is_number = p->kind == KIND_NUMBER || p->kind == KIND_WHOLE;
    const bool is_word = p->kind == KIND_CHOICE || p->kind == KIND_AXIS;
    document_add(document, "\"%s\": {\"anyOf\": [", strcmp(p->name, "type") == 0 ? SCENE_JSON_FIELD_TYPE : p->name);
    if (is_number)
        add_scalar(document, p);
    else if (!is_word)
        add_reference(document, kinds[p->kind]);
    if ((is_number || is_word) && p->choices && p->choices[0]) {
        document_add(document, is_number ? ", {\"enum\": [" : "{\"enum\": [");
        add_words(document, p);
        document_add(document, "]}");
    }
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        if (!(p->flags & others[i].flag))
            continue;
        document_add(document, ", ");
        add_reference(document, others[i].name);
    }
    document_add(document, "], \"description\": \"");
    for (const char *c = p->help; *c; c++)
        document_add(document, *c == '"' || *c == '\\' ? "\\%c" : "%c", *c);
    document_add(document, "\"}");
}

/* The members after the type: fields, then what every node has. */
static void add_fields(struct document *document, const struct script_function *function, const char *without) {
    bool has_children = false;
    for (int k = function->owner == OWNER_NODE; k < function->parameter_count; k++) {
        const struct script_parameter *p = &function->parameters[k];
        if (strcmp(p->name, without) == 0)
            continue;
        has_children |= strcmp(p->name, "children") == 0;
        document_add(document, ",\n   ");
        add_parameter(document, p);
    }
    if (function->result == RESULT_NODE && !has_children)
        document_add(document, ",\n   \"children\": {\"$ref\": \"#/$defs/kind.nodes\"}");
    if (function->result == RESULT_NODE)
        document_add(document, ",\n   \"transform\": {\"$ref\": \"#/$defs/transform\"}");
    document_add(document, "},\n  \"additionalProperties\": false");
}

static void add_function(struct document *document, const struct script_function *function) {
    int rest;
    document_add(document, ",\n \"gr.%s\": {\"type\": \"object\", \"properties\": {\n   \"type\": {\"const\": \"%s\"}",
                 function->name, function->name);
    add_fields(document, function, "");
    document_add(document, ", \"required\": [\"type\"");
    for (int k = 0; !function_rest(function, &rest) && k < function->parameter_count; k++)
        if (!(function->parameters[k].flags & OPTIONAL))
            document_add(document, ", \"%s\"", function->parameters[k].name);
    document_add(document, "]}");
}

/* The names of the functions of that owner and result, with what stands around each. */
static void add_names(struct document *document, enum function_owner owner, enum result_kind result, const char *before,
                      const char *after) {
    const char *separator = "";
    for (int k = 0; k < function_count(); k++) {
        const struct script_function *function = function_at(k);
        bool renders = result == RESULT_NOTHING && function_renders(function);
        if (function->owner != owner || !(renders || (result != RESULT_NOTHING && function->result == result)))
            continue;
        document_add(document, "%s%s%s%s", separator, before, function->name, after);
        separator = ",\n   ";
    }
}

/* A kind of object: a reference, or one of the functions that make it. The type chooses its definition, so a checker
 * tries no other. */
static void add_result(struct document *document, const char *name, enum result_kind result) {
    document_add(document, ",\n \"%s\": {\"if\": {\"required\": [\"ref\"]}, \"then\": ", name);
    add_reference(document, "ref");
    document_add(document, ", \"else\": {\"type\": \"object\", \"required\": [\"type\"], \"properties\": {\"type\": "
                           "{\"enum\": [");
    add_names(document, OWNER_GR, result, "\"", "\"");
    document_add(document, "]}}, \"allOf\": [");
    for (int k = 0, count = 0; k < function_count(); k++) {
        const struct script_function *function = function_at(k);
        if (function->owner != OWNER_GR || function->result != result)
            continue;
        document_add(document,
                     "%s\n  {\"if\": {\"properties\": {\"type\": {\"const\": \"%s\"}}}, \"then\": {\"$ref\": "
                     "\"#/$defs/gr.%s\"}}",
                     count++ ? "," : "", function->name, function->name);
    }
    document_add(document, "]}}");
    for (int k = 0; k < function_count(); k++)
        if (function_at(k)->owner == OWNER_GR && function_at(k)->result == result)
            add_function(document, function_at(k));
}

void script_json_schema(struct document *document) {
    static const struct {
        enum result_kind kind;
        const char *name;
    } results[] = {{RESULT_NODE, "node"},       {RESULT_MATERIAL, "material"}, {RESULT_LIGHT, "light"},
                   {RESULT_TEXTURE, "texture"}, {RESULT_FOG, "fog"},           {RESULT_MEDIUM, "medium"},
                   {RESULT_SKY, "sky"}};
    for (const char *const *line = schema_txt; *line; line++) {
        if (strcmp(*line, "@version") == 0)
            document_add(document, "%d", SCENE_JSON_VERSION);
        else if (strcmp(*line, "@orders") == 0)
            add_words(document, &function_find(OWNER_GR, "transform_order")->parameters[0]);
        else if (strcmp(*line, "@pictures") == 0)
            add_names(document, OWNER_GR, RESULT_NOTHING, "\"", "\"");
        else if (strcmp(*line, "@picture") == 0)
            add_fields(document, function_find(OWNER_GR, "render"), "node");
        else if (strcmp(*line, "@methods") == 0)
            add_names(document, OWNER_NODE, RESULT_SELF, "\"", "\": true");
        else if (strcmp(*line, "@results") == 0)
            for (size_t i = 0; i < sizeof results / sizeof *results; i++)
                add_result(document, results[i].name, results[i].kind);
        else
            document_add(document, "%s\n", *line);
    }
}
