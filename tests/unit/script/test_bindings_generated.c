/* Generated from the table of functions: every argument of every form of every gr function and node method, left out,
 * of a wrong type, out of its range, NaN, infinite, with a wrong number of entries: the message names line, function
 * and argument. And with everything right, every form runs. */
#include "base/document.h"
#include "base/fault.h"
#include "script/document.h"
#include "tests/unit/call_makers.h"
#include "tests/unit/script_host.h"

#include <limits.h>

/* Wrong arguments, until NULL. `which` counts from 0. */
static const char *wrong_text(const struct script_parameter *p, int which, char *out, size_t size) {
    const char *list[16] = {NULL};
    int count = 0;
    bool number = p->kind == KIND_NUMBER || p->kind == KIND_WHOLE || p->kind == KIND_SIZE || p->kind == KIND_PAIR;
    bool triple = p->kind == KIND_POINT || p->kind == KIND_DIRECTION || p->kind == KIND_COLOUR ||
                  p->kind == KIND_TRIPLE || p->kind == KIND_SIZE || p->kind == KIND_BACKGROUND;
    list[count++] = p->kind == KIND_BOOLEAN ? "'yes'" : "true";
    list[count++] = "print";
    if (number) {
        list[count++] = "0 / 0";
        list[count++] = "1 / 0";
    }
    if (triple) {
        list[count++] = "{1, 2}";
        list[count++] = "{1, 2, 3, 4}";
        list[count++] = "{1, 0 / 0, 3}";
        list[count++] = "{1, 2, 1 / 0}";
        list[count++] = "{1, {}, 3}";
    }
    if (p->kind == KIND_WHOLE)
        list[count++] = "1.5";
    if (p->flags & NOT_ZERO)
        list[count++] = "0";
    if (p->kind == KIND_CHOICE || p->kind == KIND_AXIS || p->kind == KIND_BACKGROUND)
        list[count++] = "'sideways'";
    if (p->kind == KIND_FILE || p->kind == KIND_OUTPUT || p->kind == KIND_IMAGE)
        list[count++] = "''";
    if (p->kind == KIND_NODE || p->kind == KIND_NODES || p->kind == KIND_LIGHTS)
        list[count++] = p->kind == KIND_NODE ? "glass" : "{glass}";
    if (p->kind == KIND_LIGHTS || p->kind == KIND_NODES)
        list[count++] = "{nil, lamp}";
    if (p->kind == KIND_MATERIAL)
        list[count++] = "ball";
    if (p->kind == KIND_POINTS || p->kind == KIND_PAIRS) {
        list[count++] = "{{0}}";
        list[count++] = "{7}";
        list[count++] = p->kind == KIND_POINTS ? "{{0, 0, 0 / 0}}" : "{{0, 0 / 0}}";
    }
    if (p->kind == KIND_INTERVAL) {
        list[count++] = "{1}";
        list[count++] = "{2, 1}";
        list[count++] = "{1, 0 / 0}";
    }
    if (p->kind == KIND_CAUSTICS) {
        list[count++] = "{photons = 1.5}";
        list[count++] = "{photons = -1}";
        list[count++] = "{photons = 1e9}";
        list[count++] = "{photons = {}}";
        list[count++] = "{radius = 0}";
        list[count++] = "{radius = 1 / 0}";
        list[count++] = "{photon = 7}";
        list[count++] = "{7}";
        list[count++] = "-1";
        list[count++] = "0 / 0";
    }
    if (p->kind == KIND_FOG || p->kind == KIND_MEDIUM)
        list[count++] = "glass";
    if (p->kind == KIND_STOPS) {
        list[count++] = "{{0, 1, 1}}";
        list[count++] = "{7}";
        list[count++] = "{{0, 1, 1, 0 / 0}}";
    }
    if (p->kind == KIND_FUNCTION) {
        bool takes_vectors = p->flags & OR_PROFILE || strstr(p->help, "an offset");
        list[count++] = takes_vectors ? "function(d) return d.w.x end" : "function(p) return {p.x, 0, 0} end";
        list[count++] = "function(p, s) return s.u end";
        list[count++] = "function(p) end";
        list[count++] = "math.random";
        list[count++] = "'f'";
    }
    if (p->kind == KIND_NUMBERS) {
        list[count++] = "{1, 0 / 0, 1}";
        list[count++] = "{1, {}, 1}";
        list[count++] = "{1, 2}";
        if (p->low != 0 || p->high != 0) {
            list[count++] = "{1, -1, 1}";
            list[count++] = "-1";
        }
    }
    if (p->kind == KIND_ROWS || p->kind == KIND_CURVES) {
        list[count++] = "{7}";
        list[count++] = p->kind == KIND_ROWS ? "{{0, 1}, {0 / 0, 1}}" : "{{{0, 0}, {1, 0 / 0}, {1, 1}}}";
        list[count++] = p->kind == KIND_ROWS ? "{{1, 2}, {1, 2, 3}}" : "{{{0, 0}, {1}, {1, 1}}}";
    }
    if (p->kind == KIND_MATERIALS) {
        list[count++] = "{ball}";
        list[count++] = "{red = ball}";
        list[count++] = "{[print] = glass}";
        list[count++] = "{}";
    }
    if (p->kind == KIND_QUATERNION) {
        list[count++] = "{1, 2, 3}";
        list[count++] = "{1, 2, 3, 0 / 0}";
        list[count++] = "{1, 2, {}, 3}";
    }
    if (p->kind == KIND_PAIR) {
        list[count++] = "{1}";
        list[count++] = "{1, 2, 3}";
        list[count++] = "{1, 0 / 0}";
        list[count++] = "{{}, 1}";
    }
    if (p->kind == KIND_FACES) {
        list[count++] = "{{0, 1, 0 / 0}}";
        list[count++] = "{{0, 1, -1}}";
        list[count++] = "{{0, 1, 99}}";
        list[count++] = "{{0, 1}}";
        list[count++] = "{7}";
    }
    bool bounded = number && (p->low != 0 || p->high != 0);
    if (which < count)
        return list[which];
    if (bounded && which == count && isfinite(p->low)) {
        (void)snprintf(out, size, "%.17g", p->flags & LOW_OPEN ? p->low : p->low - 1);
        return out;
    }
    if (bounded && which == count + 1 && isfinite(p->low)) {
        (void)snprintf(out, size, "%.17g",
                       isfinite(p->high) ? (p->flags & HIGH_OPEN ? p->high : p->high + 1) : p->low - 2);
        return out;
    }
    return NULL;
}

#define PREPARATION                                                                                                    \
    "glass = gr.rr_material({1, 1, 1}, {1, 1, 1}, 10, 0.5, 0.5, 1.5) "                                                 \
    "sheet = gr.mesh(glass, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}})\n"                                         \
    "ball = gr.sphere('ball')\n"                                                                                       \
    "lamp = gr.light({0, 0, 0}, {1, 1, 1}, {1, 0, 0}); mist = gr.uniform_fog{density = 1}; "                           \
    "smoke = gr.medium{scattering = {1, 1, 1}}\n"

/* The call stands in line 4. */
static bool run_call(const char *call, struct error *error) {
    char text[CALL_SIZE + 512];
    (void)snprintf(text, sizeof text, PREPARATION "%s\n", call);
    struct listener listener = {.renders = 0};
    return listen_to_text(&listener, text, NULL, error);
}

static void expect_named(const struct script_function *function, const struct script_parameter *p, const char *call) {
    struct error error;
    char title[96];
    (void)snprintf(title, sizeof title, "%s%s", function->owner == OWNER_GR ? "gr." : "node:", function->name);
    if (run_call(call, &error)) {
        test_fail(__FILE__, __LINE__, "%s is accepted", call);
        return;
    }
    if (!strstr(error.text, "scene.lua:4: ") || !strstr(error.text, title) || !strstr(error.text, p->name))
        test_fail(__FILE__, __LINE__, "%s: \"%s\" does not name line 4, %s and %s", call, error.text, title, p->name);
    if (error.kind != ERROR_SCENE)
        test_fail(__FILE__, __LINE__, "%s: the kind of the error is %d", call, (int)error.kind);
}

TEST(every_form_of_every_function_runs_with_right_arguments) {
    write_files();
    for (int f = 0; f < function_count(); f++) {
        const struct script_function *function = function_at(f);
        if (!can_run(function))
            continue;
        for (int k = 0; k < FORM_LIMIT && function->forms[k]; k++) {
            char call[CALL_SIZE];
            struct error error;
            positional_call(function, function->forms[k], -1, "", call);
            if (strncmp(call, "gr.csg", 6) != 0 && !run_call(call, &error))
                test_fail(__FILE__, __LINE__, "%s: %s", call, error.text);
        }
        for (int p = function->owner == OWNER_NODE; p < function->parameter_count && has_table_form(function); p++) {
            char call[CALL_SIZE], text[256];
            struct error error;
            if (!goes_with_the_others(function, p))
                continue;
            right_text(&function->parameters[p], text, sizeof text);
            table_call(function, p, text, call);
            bool later = strstr(function->parameters[p].help, "ot implemented") != NULL; /* the manual says so */
            if (!run_call(call, &error) && !(later && strstr(error.text, "is not implemented")))
                test_fail(__FILE__, __LINE__, "%s: %s", call, error.text);
        }
    }
}

/* Which kinds of shape are under a node. */
struct kinds {
    struct listener listener;
    bool made[SHAPE_KIND_COUNT], csg;
};

static void note_kinds(struct listener *listener, const struct render_request *request) {
    struct kinds *kinds = (struct kinds *)(void *)listener;
    for (const struct node_child *child = request->root->first_child; child; child = child->next) {
        if (child->node->kind == NODE_GEOMETRY)
            kinds->made[child->node->shape.kind] = true;
        else if (child->node->kind == NODE_CSG)
            kinds->csg = true;
    }
}

static void note_kinds_of(struct kinds *kinds, const char *call) {
    char text[CALL_SIZE + 512];
    struct error error;
    (void)snprintf(text, sizeof text,
                   PREPARATION "root = gr.node('root')\nroot:add_child(%s)\n"
                               "gr.render{node = root, file = 'x.png', width = 4, height = 4, eye = {0, 0, 9}}\n",
                   call);
    if (!listen_to_text(&kinds->listener, text, NULL, &error))
        test_fail(__FILE__, __LINE__, "%s: %s", call, error.text);
}

TEST(every_kind_of_shape_is_made_by_a_function) {
    write_files();
    struct kinds kinds = {.listener = {.seen = note_kinds}};
    note_kinds_of(&kinds, "gr.box{min = {0, 0, 0}, max = {1, 1, 1}, edge = 0.1}");
    for (int f = 0; f < function_count(); f++) {
        const struct script_function *function = function_at(f);
        if (function->owner != OWNER_GR || function->result != RESULT_NODE)
            continue;
        char call[CALL_SIZE];
        positional_call(function, function->forms[0], -1, "", call);
        note_kinds_of(&kinds, call);
    }
    CHECK(kinds.csg);
    for (int kind = 0; kind < SHAPE_KIND_COUNT; kind++)
        if (!kinds.made[kind])
            test_fail(__FILE__, __LINE__, "no gr function makes the shape '%s'",
                      shape_kind_name((enum shape_kind)kind));
}

/* Likewise of the chains of materials. */
struct material_kinds {
    struct listener listener;
    bool made[MATERIAL_KIND_COUNT];
};

static void note_materials(struct listener *listener, const struct render_request *request) {
    struct material_kinds *kinds = (struct material_kinds *)(void *)listener;
    for (const struct material *link = request->root->material; link; link = link->base)
        kinds->made[link->kind] = true;
}

static void make_material(struct material_kinds *kinds, const char *call) {
    char text[CALL_SIZE + 512];
    struct error error;
    (void)snprintf(text, sizeof text,
                   PREPARATION "root = gr.sphere(%s)\n"
                               "gr.render{node = root, file = 'x.png', width = 4, height = 4, eye = {0, 0, 9}}\n",
                   call);
    if (!listen_to_text(&kinds->listener, text, NULL, &error))
        test_fail(__FILE__, __LINE__, "%s: %s", call, error.text);
}

TEST(every_kind_of_material_is_made_by_a_function) {
    write_files();
    struct material_kinds kinds = {.listener = {.seen = note_materials}};
    for (int f = 0; f < function_count(); f++) {
        const struct script_function *function = function_at(f);
        char call[CALL_SIZE], word[61];
        if (function->owner != OWNER_GR || function->result != RESULT_MATERIAL)
            continue;
        positional_call(function, function->forms[0], -1, "", call);
        make_material(&kinds, call);
        for (int p = 0; p < function->parameter_count; p++) { /* and with each word of an enumeration */
            const char *words = function->parameters[p].kind == KIND_CHOICE ? function->parameters[p].choices : "";
            for (int length; sscanf(words, " %60s%n", word, &length) == 1; words += length) {
                char quoted[64];
                (void)snprintf(quoted, sizeof quoted, "'%s'", word);
                table_call(function, p, quoted, call);
                make_material(&kinds, call);
            }
        }
    }
    for (int kind = 0; kind < MATERIAL_KIND_COUNT; kind++)
        if (!kinds.made[kind])
            test_fail(__FILE__, __LINE__, "no gr function makes a material of kind %d", kind);
}

/* Whichever allocation fails once the call has begun. Lua survives most of its own failures by collecting garbage. */
static void fail_in_call(const char *call) {
    for (uint64_t k = 1;; k++) {
        char text[CALL_SIZE + 512];
        struct error error = {0};
        struct listener listener = {.fail_at = k};
        (void)snprintf(
            text, sizeof text,
            PREPARATION "gr.render{node = ball, file = 'x.png', width = 4, height = 4, eye = {0, 0, 9}}\n%s\n", call);
        bool done = listen_to_text(&listener, text, NULL, &error);
        bool over = fault_count(FAULT_OF_ALLOCATION) < listener.failing;
        fault_at(FAULT_OF_ALLOCATION, 0);
        if (!done && error.kind != ERROR_MACHINE)
            test_fail(__FILE__, __LINE__, "allocation %llu of %s: kind %d: %s", (unsigned long long)k, call,
                      (int)error.kind, error.text);
        if (over || listener.failing == 0)
            break;
    }
}

TEST(memory_may_end_in_every_form_of_every_function) {
#ifndef GRAY_FAULTS
    test_skip("allocations fail on demand only in builds with GRAY_FAULTS");
#endif
    write_files();
    for (int f = 0; f < function_count(); f++) {
        const struct script_function *function = function_at(f);
        char call[CALL_SIZE], text[256];
        if (!can_run(function))
            continue;
        for (int k = 0; k < FORM_LIMIT && function->forms[k]; k++) {
            positional_call(function, function->forms[k], -1, "", call);
            fail_in_call(call);
        }
        for (int p = function->owner == OWNER_NODE; p < function->parameter_count && has_table_form(function); p++) {
            if (!(function->parameters[p].flags & OPTIONAL) || !goes_with_the_others(function, p))
                continue;
            right_text(&function->parameters[p], text, sizeof text);
            table_call(function, p, text, call);
            fail_in_call(call);
        }
    }
}

TEST(every_missing_argument_is_named) {
    write_files();
    for (int f = 0; f < function_count(); f++) {
        const struct script_function *function = function_at(f);
        for (int k = 0; k < FORM_LIMIT && function->forms[k]; k++) {
            const char *form = function->forms[k];
            int index;
            bool optional;
            while (form_next(function, &form, &index, &optional)) {
                char call[CALL_SIZE];
                positional_call(function, function->forms[k], index, "nil", call);
                if (!optional)
                    expect_named(function, &function->parameters[index], call);
            }
        }
        for (int p = function->owner == OWNER_NODE; p < function->parameter_count && has_table_form(function); p++) {
            char call[CALL_SIZE];
            table_call(function, p, "nil", call);
            if (!(function->parameters[p].flags & OPTIONAL))
                expect_named(function, &function->parameters[p], call);
        }
    }
}

TEST(every_wrong_positional_argument_is_named) {
    write_files();
    for (int f = 0; f < function_count(); f++) {
        const struct script_function *function = function_at(f);
        for (int k = 0; k < FORM_LIMIT && function->forms[k]; k++) {
            const char *form = function->forms[k], *with;
            int index;
            bool optional;
            while (form_next(function, &form, &index, &optional)) {
                char call[CALL_SIZE], buffer[64];
                /* Where there are named fields, too, these take all wrong values. */
                const int count = has_table_form(function) ? 2 : INT_MAX;
                for (int w = 0;
                     w < count && (with = wrong_text(&function->parameters[index], w, buffer, sizeof buffer)); w++) {
                    positional_call(function, function->forms[k], index, with, call);
                    expect_named(function, &function->parameters[index], call);
                }
            }
        }
    }
}

TEST(every_wrong_named_field_is_named) {
    write_files();
    for (int f = 0; f < function_count(); f++) {
        const struct script_function *function = function_at(f);
        const char *with;
        for (int p = function->owner == OWNER_NODE; p < function->parameter_count && has_table_form(function); p++) {
            char call[CALL_SIZE], buffer[64];
            for (int w = 0; (with = wrong_text(&function->parameters[p], w, buffer, sizeof buffer)); w++) {
                if (strcmp(function->name, "model") == 0 && strcmp(with, "{}") == 0)
                    continue; /* no materials for the parts of a file are right */
                table_call(function, p, with, call);
                expect_named(function, &function->parameters[p], call);
            }
        }
    }
}

TEST(names_in_the_forms_are_parameters) {
    for (int f = 0; f < function_count(); f++) {
        const struct script_function *function = function_at(f);
        CHECK(function->parameter_count <= PARAMETER_LIMIT);
        for (int other = 0; other < f; other++)
            CHECK(function_at(other)->owner != function->owner ||
                  strcmp(function_at(other)->name, function->name) != 0);
        for (int k = 0; k < FORM_LIMIT && function->forms[k]; k++) {
            const char *form = function->forms[k];
            int index, words = 0, found = 0;
            bool optional;
            for (const char *c = form; *c; c++)
                words += *c != ' ' && (c == form || c[-1] == ' ');
            while (form_next(function, &form, &index, &optional))
                found++;
            if (words != found)
                test_fail(__FILE__, __LINE__, "%s: \"%s\" names no parameter", function->name, form);
        }
        for (int p = 0; p < function->parameter_count; p++)
            CHECK(function->parameters[p].name && function->parameters[p].help);
    }
}

/* LuaLS checks calls against these lines: a method has no field for its node, and each result has a line. */
TEST(annotations_have_the_fields_and_results_of_calls) {
    char *file = test_read_file("lua/gr.lua", NULL);
    CHECK(file != NULL);
    if (!file)
        return;
    const char *fields = strstr(file, "---@class gr.node.render.fields\n---@field file? string");
    CHECK(fields &&
          strstr(fields, "---@overload fun(self: gr.node, fields: gr.node.render.fields)\nfunction node:render("));
    CHECK(strstr(file, "---@return number[]\n---@return number[]\nfunction node:bounds()"));
    CHECK(strstr(file, "---@return number[][]\n---@return integer[][]\nfunction node:faces()"));
    CHECK(strstr(file, "---@return gr.glyphs\n"));
    for (size_t k = 0; value_function_at(k); k++) {
        char text[200];
        (void)snprintf(text, sizeof text, "\n---@return %.20s", value_function_at(k)->result);
        text[strcspn(text, ",")] = '\0';
        CHECK(strstr(file, text) != NULL);
    }
    free(file);
}

TEST(annotation_file_is_current) {
    struct arena arena = {0};
    struct document document = {.arena = &arena};
    script_annotations(&document);
    const char *annotations = document.failed ? NULL : document.text;
    char *file = test_read_file("lua/gr.lua", NULL);
    CHECK(annotations != NULL && file != NULL);
    if (annotations && file && strcmp(annotations, file) != 0)
        test_fail(__FILE__, __LINE__, "write it again: ./gray --annotations > lua/gr.lua");
    free(file);
    arena_destroy(&arena);
}

TEST(manual_has_at_most_100_columns_and_every_function) {
    struct arena arena = {0};
    struct document document = {.arena = &arena};
    script_describe_function(&document, NULL);
    const char *manual = document.failed ? NULL : document.text;
    CHECK(manual != NULL);
    for (const char *line = manual; line && *line;) {
        size_t length = strcspn(line, "\n");
        if (length > 100)
            test_fail(__FILE__, __LINE__, "%.*s", (int)length, line);
        line += length + (line[length] == '\n');
    }
    for (int f = 0; f < function_count() && manual; f++) {
        char title[96];
        (void)snprintf(title, sizeof title, "%s%s(",
                       function_at(f)->owner == OWNER_GR ? "gr." : "node:", function_at(f)->name);
        if (!strstr(manual, title))
            test_fail(__FILE__, __LINE__, "%s is not in the manual", title);
    }
    arena_destroy(&arena);
}
