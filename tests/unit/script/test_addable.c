/* The list of what a window adds, and the fields of its calls. */
#include "tests/harness.h"

#include "script/addable.h"
#include "script/table_internal.h"

#include <stdio.h>
#include <string.h>

static bool is_listed(const char *name) {
    char begin[96];
    (void)snprintf(begin, sizeof begin, "gr.%s{", name);
    for (const char *const *row = addable_txt; *row; row += ADDABLE_COLUMNS) {
        if (strncmp(row[ADDABLE_CALL], begin, strlen(begin)) == 0)
            return true;
    }
    return false;
}

/* Other names of the same shapes, and what needs nodes or files that exist. */
static bool is_other_name(const char *name) {
    static const char *const names[] = {"nh_sphere", "nh_box", "geometry",     "fast_mesh",
                                        "vn_mesh",   "model",  "fast_vn_mesh", "displace"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (strcmp(name, names[i]) == 0)
            return true;
    }
    return false;
}

TEST(every_shape_and_every_light_of_the_language_can_be_added) {
    for (int i = 0; i < function_count(); i++) {
        const struct script_function *function = function_at(i);
        bool shape = false, node = false;
        for (int k = 0; k < function->parameter_count; k++) {
            shape = shape || function->parameters[k].kind == KIND_MATERIAL;
            node = node || function->parameters[k].kind == KIND_NODE || function->parameters[k].kind == KIND_NODES;
        }
        bool adds = (function->result == RESULT_NODE && shape && !node) || function->result == RESULT_LIGHT;
        if (function->owner == OWNER_GR && adds && !is_other_name(function->name) && !is_listed(function->name))
            test_fail(__FILE__, __LINE__, "gr.%s is not in addable.txt", function->name);
    }
}

TEST(every_call_that_can_be_added_has_room) {
    for (const char *const *row = addable_txt; *row; row += ADDABLE_COLUMNS)
        CHECK(strlen(row[ADDABLE_CALL]) < 512 && row[ADDABLE_TITLE][0] != '\0');
}

TEST(fields_of_a_call_are_found_changed_and_left_out) {
    static const char call[] = "gr.prism{outline = {{1, 0}, {0, ', }'}}, to = 2, name = 'a, \\'b = 3'}";
    char out[200];
    CHECK(call_function(call) && strcmp(call_function(call)->name, "prism") == 0);
    CHECK(!call_function("gr.prism") && !call_function("require('knot').named{}") && !call_function("gr.a.b{}"));
    CHECK(call_field(call, "outline", out, sizeof out));
    CHECK_TEXT(out, "{{1, 0}, {0, ', }'}}");
    CHECK(call_field(call, "name", out, sizeof out));
    CHECK_TEXT(out, "'a, \\'b = 3'");
    CHECK(!call_field(call, "b", out, sizeof out) && !call_field(call, "t", out, sizeof out));
    CHECK(call_set_field(call, "to", "-1", out, sizeof out));
    CHECK_TEXT(out, "gr.prism{outline = {{1, 0}, {0, ', }'}}, to = -1, name = 'a, \\'b = 3'}");
    CHECK(call_set_field(call, "name", "", out, sizeof out));
    CHECK_TEXT(out, "gr.prism{outline = {{1, 0}, {0, ', }'}}, to = 2}");
    CHECK(call_set_field("gr.cube{size = 2}", "size", "", out, sizeof out));
    CHECK_TEXT(out, "gr.cube{}");
    CHECK(call_set_field("gr.cube{a = 1, size = 2}", "a", "", out, sizeof out));
    CHECK_TEXT(out, "gr.cube{size = 2}");
    CHECK(call_set_field("gr.cube{}", "size", "3", out, sizeof out));
    CHECK_TEXT(out, "gr.cube{size = 3}");
    CHECK(call_set_field(out, "corner", "{0, 0, 0}", out + 100, 100));
    CHECK_TEXT(out + 100, "gr.cube{size = 3, corner = {0, 0, 0}}");
    CHECK(!call_set_field(call, "to", "1000", out, 20));
}

TEST(numbers_of_a_default_are_read) {
    double n[3];
    CHECK(call_numbers("{1, -2.5, .5}", n) && n[0] == 1 && n[1] == -2.5 && n[2] == 0.5);
    CHECK(call_numbers("30, or inner", n) && n[0] == 30);
    CHECK(call_numbers("2", n) && n[2] == 2);
    CHECK(!call_numbers("infinite", n) && !call_numbers("radius/2", n) && !call_numbers("", n) &&
          !call_numbers("{1, 2}", n));
}
