/* The Lua library, by scripts with its claims: tests/library/claims_*.lua. Each runs in the program with --check, so
 * that the renderer accepts or refuses the meshes that it uses in CSG. A false claim ends the script with its sentence.
 */
#include "tests/harness.h"

#include "formats/font.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void claims_hold(const char *name) {
    char root[2048], arguments[8192];
    if (!getcwd(root, sizeof root))
        test_fail(__FILE__, __LINE__, "no working directory");
    (void)snprintf(arguments, sizeof arguments, "-q --check --allow-read %s %s/tests/library/%s.lua", root, root, name);
    struct test_result result = test_gray(NULL, arguments);
    if (result.status != 0)
        test_fail(__FILE__, __LINE__, "%s: status %d: %s", name, result.status, result.err);
    test_free_result(&result);
}

TEST(library_solids_have_the_numbers_of_the_textbook_and_are_closed) {
    claims_hold("claims_solids");
}

TEST(library_fractals_have_the_counts_areas_and_volumes_of_their_formulas) {
    claims_hold("claims_fractals");
}

TEST(library_terrain_follows_its_seed_and_erosion_makes_no_soil) {
    claims_hold("claims_terrain");
}

TEST(library_words_grow_as_they_should_and_the_turtle_walks_the_curve_of_hilbert) {
    claims_hold("claims_lsystem");
}

TEST(library_scattered_points_keep_their_distance_and_leave_no_holes) {
    claims_hold("claims_scatter");
}

TEST(library_gears_touch_and_do_not_cut_into_each_other) {
    claims_hold("claims_gear");
}

TEST(library_curves_patches_lofts_and_knots_are_closed_with_the_volumes_of_their_formulas) {
    claims_hold("claims_curves");
}

TEST(library_colours_and_easings_begin_and_end_where_they_should) {
    claims_hold("claims_colour");
}

TEST(library_patterns_have_their_closed_forms_and_no_seams_at_the_lattice) {
    claims_hold("claims_patterns");
}

TEST(library_functions_and_those_of_users_are_recorded_with_the_bits_of_lua) {
    claims_hold("claims_functions");
}

TEST(functions_that_students_write_are_recorded_or_refused_with_their_line) {
    claims_hold("claims_student_functions");
}

TEST(library_solids_of_functions_are_distances_or_bounds_of_them) {
    claims_hold("claims_sdf");
}

TEST(library_polygons_are_cut_into_triangles_and_drawn_out_into_closed_solids) {
    claims_hold("claims_polygon");
}

TEST(library_text_has_the_areas_of_its_pen_and_is_closed_letter_by_letter) {
    claims_hold("claims_text");
}

TEST(letters_that_a_font_lacks_are_named_in_one_warning_for_each_text) {
    struct test_result result = test_gray_scene("local text = require 'text'\n"
                                                "text.letters 'A\xcf\x88 \xcf\x89\\n\xcf\x88'\n"
                                                "text.letters '\xc3\x84\xc3\x9f\xe2\x82\xac'\n",
                                                "--check scene.lua", NULL);
    CHECK(strstr(result.err, "scene.lua:2: text.letters: warning: the built-in font has no letter for "
                             "\"\xcf\x88\", \"\xcf\x89\"\n"));
    CHECK(!strstr(result.err, "scene.lua:3:"));
    test_free_result(&result);
    if (!FONTS_READABLE)
        test_lacks("FreeType");
    size_t size;
    char *font = test_read_file("data/fonts/gray-round.ttf", &size);
    test_write_file(test_path("round.ttf"), font, size);
    free(font);
    result = test_gray_scene("gr.glyphs('round.ttf', '\xcf\x88\xcf\x88')\n"
                             "gr.glyphs('round.ttf', '\xc3\x84\xc2\xa0\xce\xb1\xce\xb2\xce\xb3\xce\xb4\xce\xb5"
                             "\xce\xb6\xce\xb7\xce\xb8\xce\xb9\xce\xba')\n",
                             "--check scene.lua", NULL);
    CHECK(strstr(result.err, "scene.lua:1: warning: gr.glyphs: round.ttf has no letter for \"\xcf\x88\" "));
    CHECK(strstr(result.err, "round.ttf has no letter for \"\xce\xb1\", ") &&
          strstr(result.err, "\"\xce\xb8\" and 2 others"));
    test_free_result(&result);
}

/* Every Lua block of the page, as a separate scene; an example may name the font in the same folder. */
TEST(library_examples_of_the_documentation_run) {
    char *page = test_read_file("docs/library.md", NULL), path[1024];
    size_t size;
    char *font = test_read_file("data/fonts/gray-round.ttf", &size);
    CHECK(page && font);
    (void)snprintf(path, sizeof path, "%s/gray-round.ttf", test_folder());
    FILE *copy = fopen(path, "wb");
    CHECK(copy && fwrite(font, 1, size, copy) == size && fclose(copy) == 0);
    int count = 0;
    for (char *block = page; (block = strstr(block, "```lua\n"));) {
        char *begin = block + 7, *end = strstr(begin, "```");
        CHECK(end != NULL);
        *end = '\0';
        struct test_result result = test_gray_scene(begin, "-q --check scene.lua", NULL);
        if (result.status != 0)
            test_fail(__FILE__, __LINE__, "%s\n%s", begin, result.err);
        test_free_result(&result);
        block = end + 3;
        count++;
    }
    CHECK(count >= 11);
    free(page);
    free(font);
}
