/* A definition for each function that makes an object, one for each kind of argument, and one for each kind of object,
 * which is any of its functions or a reference. What a schema cannot say (a sorted interval, rows of equal length)
 * remains to the reader. */
#include "script/schema.h"

#include "base/document.h"
#include "base/unreachable.h"
#include "script/scene_json_internal.h"
#include "script/table_internal.h"

#include <math.h>
#include <string.h>

#define REF(name) "{\"$ref\": \"#/$defs/" name "\"}"
#define LIST_OF(item) "{\"type\": \"array\", \"items\": " item "}"
#define TUPLE(count)                                                                                                   \
    "{\"type\": \"array\", \"items\": {\"type\": \"number\"}, \"minItems\": " count ", \"maxItems\": " count "}"
#define ANY_OF(...) "{\"anyOf\": [" __VA_ARGS__ "]}"
#define NUMBER "{\"type\": \"number\"}"
#define STRING "{\"type\": \"string\"}"
#define NUMBERS LIST_OF(NUMBER)

/* The kinds with one schema for all parameters; NULL: the others. */
static const char *schema_of_kind(enum argument_kind kind) {
    switch (kind) {
    case KIND_NUMBER:
    case KIND_WHOLE:
    case KIND_CHOICE:
    case KIND_AXIS:
        return NULL;
    case KIND_BOOLEAN:
        return "{\"type\": \"boolean\"}";
    case KIND_TEXT:
        return "{\"type\": [\"string\", \"number\"]}";
    case KIND_FILE:
    case KIND_OUTPUT:
        return STRING;
    case KIND_POINT:
    case KIND_DIRECTION:
    case KIND_TRIPLE:
        return REF("triple");
    case KIND_COLOUR:
        return ANY_OF(REF("triple") ", " STRING);
    case KIND_SIZE:
        return ANY_OF(NUMBER ", " REF("triple") ", " STRING);
    case KIND_INTERVAL:
        return TUPLE("2");
    case KIND_QUATERNION:
        return TUPLE("4");
    case KIND_PAIR:
        return ANY_OF(NUMBER ", " TUPLE("2"));
    case KIND_NODE:
        return REF("node");
    case KIND_MATERIAL:
        return REF("material");
    case KIND_MATERIALS:
        return ANY_OF(
            LIST_OF(REF("material")) ", {\"type\": \"object\", \"additionalProperties\": " REF("material") "}");
    case KIND_IMAGE:
        return ANY_OF(STRING ", " REF("texture"));
    case KIND_BACKGROUND:
        return ANY_OF(REF("triple") ", " STRING ", " REF("sky") ", " REF("texture"));
    case KIND_FOG:
        return REF("fog");
    case KIND_MEDIUM:
        return REF("medium");
    case KIND_CAUSTICS:
        return ANY_OF(NUMBER ", {\"type\": \"object\", \"properties\": {\"photons\": " NUMBER ", \"radius\": " NUMBER
                             "}, \"additionalProperties\": false}");
    case KIND_NODES:
        return LIST_OF(REF("node"));
    case KIND_LIGHTS:
        return LIST_OF(REF("light"));
    case KIND_POINTS:
        return LIST_OF(REF("triple"));
    case KIND_PAIRS:
        return LIST_OF(TUPLE("2"));
    case KIND_STOPS:
        return LIST_OF(TUPLE("4"));
    case KIND_FACES:
        return LIST_OF(LIST_OF("{\"type\": \"number\", \"minimum\": 0}"));
    case KIND_NUMBERS:
        return ANY_OF(NUMBER ", " NUMBERS);
    case KIND_ROWS:
        return LIST_OF(NUMBERS);
    case KIND_CURVES:
        return LIST_OF(LIST_OF(TUPLE("2")));
    case KIND_FUNCTION:
        return REF("texture");
    case KIND_CALLBACK:
        return "false";
    case KIND_COUNT:
        break;
    }
    UNREACHABLE("a parameter of no kind");
}

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

/* {"description": ..., "anyOf": [...]}: the kind, and what its flags accept beside it. */
static void add_parameter(struct document *document, const struct script_parameter *p) {
    static const struct {
        unsigned flag;
        const char *schema;
    } others[] = {{OR_TEXTURE, REF("texture")},
                  {OR_PROFILE | OR_FUNCTION, REF("texture")},
                  {OR_NUMBER, NUMBER},
                  {OR_FILE, STRING},
                  {OR_COMPASS, "{\"type\": \"object\", \"required\": [\"azimuth\", \"elevation\"]}"},
                  {OR_PAIR, TUPLE("2")},
                  {OR_SKY, REF("sky")}};
    const char *schema = schema_of_kind(p->kind);
    bool has_words = p->choices && p->choices[0];
    document_add(document, "\"%s\": {\"anyOf\": [", strcmp(p->name, "type") == 0 ? SCENE_JSON_FIELD_TYPE : p->name);
    if (schema)
        document_add(document, "%s", schema);
    else if (p->kind == KIND_NUMBER || p->kind == KIND_WHOLE)
        add_scalar(document, p);
    if (!schema && has_words) {
        document_add(document, p->kind == KIND_NUMBER ? ", {\"enum\": [" : "{\"enum\": [");
        add_words(document, p);
        document_add(document, "]}");
    }
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (p->flags & others[i].flag)
            document_add(document, ", %s", others[i].schema);
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
        document_add(document, ",\n   \"children\": " LIST_OF(REF("node")));
    if (function->result == RESULT_NODE)
        document_add(document, ",\n   \"transform\": " REF("transform"));
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

/* A kind of object: a reference, or one of the functions that make it. The type chooses its definition, so a checker
 * tries no other. */
static void add_result(struct document *document, const char *name, enum result_kind result) {
    const char *separator = "";
    document_add(document,
                 ",\n \"%s\": {\"if\": {\"required\": [\"ref\"]}, \"then\": " REF(
                     "ref") ", \"else\": {\"type\": \"object\", "
                            "\"required\": [\"type\"], \"properties\": {\"type\": {\"enum\": [",
                 name);
    for (int k = 0; k < function_count(); k++)
        if (function_at(k)->owner == OWNER_GR && function_at(k)->result == result) {
            document_add(document, "%s\"%s\"", separator, function_at(k)->name);
            separator = ", ";
        }
    document_add(document, "]}}, \"allOf\": [");
    separator = "";
    for (int k = 0; k < function_count(); k++)
        if (function_at(k)->owner == OWNER_GR && function_at(k)->result == result) {
            document_add(document,
                         "%s\n  {\"if\": {\"properties\": {\"type\": {\"const\": \"%s\"}}}, \"then\": {\"$ref\": "
                         "\"#/$defs/gr.%s\"}}",
                         separator, function_at(k)->name, function_at(k)->name);
            separator = ",";
        }
    document_add(document, "]}}");
}

void script_json_schema(struct document *document) {
    static const struct {
        enum result_kind kind;
        const char *name;
    } results[] = {{RESULT_NODE, "node"},       {RESULT_MATERIAL, "material"}, {RESULT_LIGHT, "light"},
                   {RESULT_TEXTURE, "texture"}, {RESULT_FOG, "fog"},           {RESULT_MEDIUM, "medium"},
                   {RESULT_SKY, "sky"}};
    const char *separator = "";
    document_add(document,
                 "{\"$schema\": \"https://json-schema.org/draft/2020-12/schema\",\n"
                 "\"title\": \"A scene of gray\", \"type\": \"object\", \"required\": [\"gray\", \"nodes\"],\n"
                 "\"additionalProperties\": false, \"properties\": {\n"
                 " \"gray\": {\"const\": %d},\n"
                 " \"define\": {\"type\": \"object\", \"additionalProperties\": {\"type\": \"object\", "
                 "\"required\": [\"type\"]}},\n"
                 " \"nodes\": {\"type\": \"array\", \"minItems\": 1, \"items\": " REF(
                     "node") "},\n"
                             " \"transform_order\": {\"enum\": [",
                 SCENE_JSON_VERSION);
    add_words(document, &function_find(OWNER_GR, "transform_order")->parameters[0]);
    document_add(document, "]},\n"
                           " \"defaults\": {\"enum\": [\"light\", \"classic\"]},\n"
                           " \"time\": {\"type\": \"number\", \"minimum\": 0},\n"
                           " \"picture\": {\"type\": \"object\", \"properties\": {\n"
                           "   \"type\": {\"enum\": [");
    for (int k = 0; k < function_count(); k++)
        if (function_at(k)->owner == OWNER_GR && function_renders(function_at(k))) {
            document_add(document, "%s\"%s\"", separator, function_at(k)->name);
            separator = ", ";
        }
    document_add(document, "]}");
    add_fields(document, function_find(OWNER_GR, "render"), "node");
    document_add(
        document,
        "}},\n\"$defs\": {\n"
        " \"ref\": {\"type\": \"object\", \"properties\": {\"ref\": " STRING "}, \"required\": [\"ref\"], "
        "\"additionalProperties\": false},\n"
        " \"triple\": " ANY_OF(TUPLE(
            "3") ", {\"type\": \"object\", \"minProperties\": 3, \"maxProperties\": 3, "
                 "\"additionalProperties\": " NUMBER
                 "}") ",\n"
                      " \"transform\": {\"type\": \"array\", \"items\": {\"type\": \"object\", \"minProperties\": 1, "
                      "\"maxProperties\": 1, \"additionalProperties\": false, \"properties\": {");
    separator = "\n   ";
    for (int k = 0; k < function_count(); k++) {
        const struct script_function *function = function_at(k);
        if (function->owner != OWNER_NODE || function->result != RESULT_SELF)
            continue;
        document_add(document, "%s\"%s\": true", separator, function->name);
        separator = ",\n   ";
    }
    document_add(document, "}}}");
    for (size_t i = 0; i < sizeof results / sizeof *results; i++) {
        add_result(document, results[i].name, results[i].kind);
        for (int k = 0; k < function_count(); k++)
            if (function_at(k)->owner == OWNER_GR && function_at(k)->result == results[i].kind)
                add_function(document, function_at(k));
    }
    document_add(document, "\n}}\n");
}
