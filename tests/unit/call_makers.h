/* Calls of gr functions as Lua text, made from the table of functions: each form with right arguments, or with one of
 * them replaced. Used by the tests that go over all of them. */
#ifndef GRAY_TESTS_CALL_MAKERS_H
#define GRAY_TESTS_CALL_MAKERS_H

#include "formats/font.h"
#include "script/table_internal.h"
#include "tests/harness.h"
#include "tests/unit/file_makers.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CALL_SIZE = 2048 };

/* The files that the right arguments name. */
static inline void write_files(void) {
    char path[512];
    write_white_png("cross.png", 8, 6);
    write_white_png("square.png", 8, 8);
    (void)snprintf(path, sizeof path, "%s/flag.obj", test_folder());
    test_write_text(path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    (void)snprintf(path, sizeof path, "%s/letters.ttf", test_folder());
    size_t length;
    char *font = test_read_file("data/fonts/gray-round.ttf", &length);
    FILE *copy = fopen(path, "wb");
    CHECK(font && copy && fwrite(font, 1, length, copy) == length);
    CHECK(fclose(copy) == 0);
    free(font);
}

/* Functions that need a library this build lacks only report that. */
static inline bool can_run(const struct script_function *function) {
    return strcmp(function->name, "glyphs") != 0 || strcmp(font_library(), "none") != 0;
}

static inline bool function_is_square(const char *help) {
    return strncmp(help, "A square picture", 16) == 0;
}

/* A right argument, as Lua text. */
static inline void right_text(const struct script_parameter *p, char *out, size_t size) {
    bool bounded = p->low != 0 || p->high != 0;
    double middle = !bounded ? 1 : isfinite(p->high) ? fmax(p->low, floor(p->low / 2 + p->high / 2)) : p->low + 1;
    const char *text = "nil";
    switch (p->kind) {
    case KIND_NUMBER: /* edges are shorter than half of a shape's sides */
        (void)snprintf(out, size, "%.17g", strstr(p->help, "rounded edges") ? 0.25 : middle);
        return;
    case KIND_WHOLE:
        (void)snprintf(out, size, "%.0f", middle > 16 && p->low <= 16 ? 16 : middle);
        return;
    case KIND_BOOLEAN:
        text = "true";
        break;
    case KIND_TEXT:
        text = strcmp(p->name, "code") == 0 ? "'v0 = p.x; result v0'" : "'thing'";
        break;
    case KIND_FILE:
        text = strcmp(p->name, "font") == 0 ? "'letters.ttf'" : "'flag.obj'";
        break;
    case KIND_OUTPUT:
        text = "'out.png'";
        break;
    case KIND_CHOICE:
    case KIND_AXIS:
        (void)snprintf(out, size, "'%.*s'", (int)strcspn(p->choices, " "), p->choices);
        return;
    case KIND_POINT:
    case KIND_DIRECTION:
    case KIND_COLOUR:
    case KIND_TRIPLE:
    case KIND_BACKGROUND:
        text = p->high == 1                     ? "{0.5, 1, 0}"
               : strcmp(p->name, "target") == 0 ? "{3, 2, 1}"
                                                : "{1, 2, 3}"; /* not at the position of a light or of the camera */
        if (strcmp(p->name, "max") == 0 || strcmp(p->name, "b") == 0 || strcmp(p->name, "up") == 0)
            text = "{4, 3, 8}"; /* corners and edges of one shape differ */
        if (strcmp(p->name, "c") == 0)
            text = "{-2, 5, 1}";
        break;
    case KIND_INTERVAL:
        text = "{1, 2}";
        break;
    case KIND_SIZE:
    case KIND_PAIR:
        text = "2";
        break;
    case KIND_NODE:
        text = strcmp(p->name, "node") == 0 ? "gr.sphere('other')" : "ball"; /* none is its own child */
        break;
    case KIND_MATERIAL:
        text = "glass";
        break;
    case KIND_QUATERNION:
        text = "{1, 2, 3, 4}";
        break;
    case KIND_MATERIALS:
        text = "{glass}";
        break;
    case KIND_IMAGE: /* the faces of a sky are square */
        text = function_is_square(p->help) ? "'square.png'" : "'cross.png'";
        break;
    case KIND_NODES:
        text = "{ball, ball}";
        break;
    case KIND_LIGHTS:
        text = "{lamp, lamp}";
        break;
    case KIND_POINTS:
        text = strcmp(p->name, "bounds") == 0 ? "{{-1, -1, -1}, {1, 1, 1}}" : "{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}";
        if (strstr(p->help, "16")) /* patches */
            text = "{{0,0,0},{1,0,0},{2,0,0},{3,0,0},{0,1,1},{1,1,1},{2,1,1},{3,1,1},"
                   "{0,2,0},{1,2,0},{2,2,0},{3,2,0},{0,3,0},{1,3,0},{2,3,0},{3,3,0}}";
        break;
    case KIND_NUMBERS:
        text = strcmp(p->name, "densities") == 0 ? "{1, 2, 3, 4, 5, 6}" : "{1, 2, 1}"; /* {1, 2, 3} cells */
        if (strcmp(p->name, "matrix") == 0)
            text = "{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}";
        if (strcmp(p->name, "linear") == 0)
            text = "{0, 1, 0, 1, 0, 0, 0, 0, 2}";
        break;
    case KIND_ROWS:
        text = strcmp(p->name, "heights") == 0   ? "{{2, 3}, {3, 2}}"
               : strcmp(p->name, "at") == 0      ? "{{0, 0, 0}, {1, 2, 3}, {3, 0, 1}}"
               : strcmp(p->name, "spheres") == 0 ? "{{0, 0, 0, 1}, {1, 0, 0, 1, 2}}"
                                                 : "{{0, 0, 0, 1, 1, 1, 1}}";
        break;
    case KIND_CURVES:
        text = "{{{0.1, 0.1}, {0.2, 0.1}, {0.1, 0.2}}}";
        break;
    case KIND_CALLBACK:
        text = "function() return {node = ball, file = 'f.png', width = 4, height = 4, eye = {0, 0, 5}} end";
        break;
    case KIND_FUNCTION:
        text = strcmp(p->name, "density") == 0 ? "function(p) return p.x * p.x end"
                                               : "function(p) return p.x * p.x + p.y - p.z end";
        break;
    case KIND_PAIRS:
        text = "{{0, 0}, {1, 0}, {1, 1}}";
        break;
    case KIND_FACES:
        text = strstr(p->help, "16") ? "{{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15}}" : "{{0, 1, 2}}";
        break;
    case KIND_CAUSTICS:
        text = "{photons = 64, radius = 0.5}";
        break;
    case KIND_FOG:
        text = "mist";
        break;
    case KIND_MEDIUM:
        text = "smoke";
        break;
    case KIND_STOPS:
        text = "{{-1, 0, 0, 0}, {1, 1, 1, 1}}";
        break;
    case KIND_COUNT:
        break;
    }
    (void)snprintf(out, size, "%s", text);
}

static inline void begin_call(const struct script_function *function, char call[CALL_SIZE]) {
    bool is_of_mesh = function->result == RESULT_FACES || strcmp(function->name, "displace") == 0;
    (void)snprintf(call, CALL_SIZE, "%s%s",
                   function->owner == OWNER_GR ? "gr."
                   : is_of_mesh                ? "sheet:"
                                               : "ball:",
                   function->name);
}

static inline void append(char call[CALL_SIZE], const char *text) {
    size_t used = strlen(call);
    (void)snprintf(call + used, CALL_SIZE - used, "%s", text);
}

/* A call in that form; argument `wrong` (a parameter's index, or -1) is replaced. */
static inline void positional_call(const struct script_function *function, const char *form, int wrong,
                                   const char *with, char call[CALL_SIZE]) {
    int index;
    bool optional;
    const char *separator = "(";
    begin_call(function, call);
    while (form_next(function, &form, &index, &optional)) {
        char text[256];
        right_text(&function->parameters[index], text, sizeof text);
        append(call, separator);
        append(call, index == wrong ? with : text);
        separator = ", ";
    }
    append(call, separator[0] == '(' ? "()" : ")");
}

/* The required fields of the table form, without `wrong`. Meshes need vertices and faces, or a file. */
static inline bool is_needed(const struct script_function *function, int index) {
    const struct script_parameter *p = &function->parameters[index];
    bool mesh_table = strcmp(p->name, "verts") == 0 || strcmp(p->name, "faces") == 0;
    bool partner = (strcmp(p->name, "normals") == 0 || strcmp(p->name, "uvs") == 0) && p->kind != KIND_FACES;
    bool one_of = strcmp(p->name, "heights") == 0 || strcmp(p->name, "spheres") == 0 || strcmp(p->name, "bounds") == 0;
    one_of = one_of || (strcmp(function->name, "model") == 0 && strcmp(p->name, "file") == 0);
    one_of = one_of || (strcmp(function->name, "frames") == 0 && strcmp(p->name, "count") == 0);
    bool area_light_colour = function->result == RESULT_LIGHT && strcmp(p->name, "colour") == 0; /* or an emission */
    return !(p->flags & OPTIONAL) || mesh_table || partner || one_of || area_light_colour;
}

static inline void table_call(const struct script_function *function, int wrong, const char *with,
                              char call[CALL_SIZE]) {
    const char *separator = "{";
    begin_call(function, call);
    for (int k = function->owner == OWNER_NODE; k < function->parameter_count; k++) {
        char text[256];
        if (k != wrong && !is_needed(function, k))
            continue;
        right_text(&function->parameters[k], text, sizeof text);
        append(call, separator);
        append(call, function->parameters[k].name);
        append(call, " = ");
        append(call, k == wrong ? with : text);
        separator = ", ";
    }
    append(call, separator[0] == '{' ? "{}" : "}");
}

static inline bool has_table_form(const struct script_function *function) {
    return function->owner == OWNER_GR || function->result == RESULT_NOTHING;
}

/* Some fields exclude or need others. */
static inline bool goes_with_the_others(const struct script_function *function, int p) {
    const char *name = function->parameters[p].name;
    bool excludes = strcmp(name, "file") == 0 && !(function->parameters[p].kind == KIND_OUTPUT);
    excludes = excludes || strcmp(name, "image") == 0;
    if (strcmp(function->name, "implicit") == 0 && (strcmp(name, "radius") == 0 || strcmp(name, "centre") == 0))
        return false; /* in place of bounds */
    if (strcmp(function->name, "height_field") == 0 && (strcmp(name, "columns") == 0 || strcmp(name, "rows") == 0))
        return false; /* without heights */
    if (strcmp(function->name, "frames") == 0 && strcmp(name, "seconds") == 0)
        return false; /* in place of count */
    if (strcmp(function->name, "daylight") == 0 && (strcmp(name, "time") == 0 || name[0] == 'p' || name[0] == 'z'))
        return false; /* a known place, and what needs it */
    if (strcmp(function->name, "medium") == 0 && strstr("density temperature bound corner size cells", name))
        return false; /* each needs another one */
    return !(excludes && (strstr(function->name, "mesh") || strstr(function->name, "height"))) &&
           !strstr(name, "materials") && strcmp(name, "ior") != 0 && strcmp(name, "refract") != 0 &&
           strcmp(name, "target_to") != 0;
}

#endif
