/* docs/language.md, the reference of the scene language, against the table of gr functions and against the program. */
#define _GNU_SOURCE
#include "script/table_internal.h"
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Whether `word` in back quotes is in the text from `begin` up to `end`. */
static bool is_quoted_in(const char *begin, const char *end, const char *word) {
    char quoted[80];
    (void)snprintf(quoted, sizeof quoted, "`%s`", word);
    const char *found = strstr(begin, quoted);
    return found && found < end;
}

/* Finds the chapter ("## ...") in which a line begins with the call "gr.NAME(" or "node:NAME("; false: it is not
 * listed. */
static bool find_chapter(const char *page, const struct script_function *function, const char **begin,
                         const char **end) {
    static const char *const owners[] = {[OWNER_GR] = "gr.", [OWNER_NODE] = "node:"};
    char call[80];
    (void)snprintf(call, sizeof call, "\n`%s%s(", owners[function->owner], function->name);
    const char *at = strstr(page, call);
    if (!at)
        return false;
    *end = strstr(at, "\n## ");
    if (!*end)
        *end = page + strlen(page);
    *begin = page;
    for (const char *next = page; (next = strstr(next, "\n## ")) && next < at; next++)
        *begin = next;
    return true;
}

TEST(language_page_lists_every_function_with_all_its_arguments) {
    char *page = test_read_file("docs/language.md", NULL);
    CHECK(page != NULL);
    if (!page)
        return;
    for (int i = 0; i < function_count(); i++) {
        const struct script_function *function = function_at(i);
        const char *begin, *end;
        if (!find_chapter(page, function, &begin, &end)) {
            test_fail(__FILE__, __LINE__, "%s is not in docs/language.md", function->name);
            continue;
        }
        /* node:render has the arguments of gr.render */
        for (int other = 0; other < function_count(); other++) {
            const struct script_function *render = function_at(other);
            if (function->owner == OWNER_NODE && strcmp(function->name, "render") == 0 && render->owner == OWNER_GR &&
                strcmp(render->name, "render") == 0)
                CHECK(find_chapter(page, render, &begin, &end));
        }
        for (int k = 0; k < function->parameter_count; k++) {
            const char *name = function->parameters[k].name;
            if (strcmp(name, "self") != 0 && !is_quoted_in(begin, end, name))
                test_fail(__FILE__, __LINE__, "argument %s of %s is not in its chapter of docs/language.md", name,
                          function->name);
        }
    }
    free(page);
}

TEST(language_page_lists_every_function_of_numbers_and_vectors) {
    char *page = test_read_file("docs/language.md", NULL);
    CHECK(page != NULL);
    const struct value_function *function;
    for (size_t i = 0; page && (function = value_function_at(i)) != NULL; i++) {
        char call[64];
        (void)snprintf(call, sizeof call, "gr.%s", function->name);
        const char *at = strstr(page, call);
        while (at && strchr("({", at[strlen(call)]) == NULL)
            at = strstr(at + 1, call);
        if (!at)
            test_fail(__FILE__, __LINE__, "%s is not in docs/language.md", call);
    }
    free(page);
}

static void copy_into_test_folder(const char *folder, const char *name) {
    char from[256], to[1024];
    size_t size = 0;
    (void)snprintf(from, sizeof from, "%s/%s", folder, name);
    (void)snprintf(to, sizeof to, "%s/%s", test_folder(), name);
    char *bytes = test_read_file(from, &size);
    FILE *copy = fopen(to, "wb");
    CHECK(bytes && copy && fwrite(bytes, 1, size, copy) == size && fclose(copy) == 0);
    free(bytes);
}

/* The first block is a scene with a mark where the others are inserted. */
TEST(language_page_has_examples_that_render_without_a_warning) {
    static const char *const textures[] = {"bricks_height.png", "checker.png", "earth.png",       "leaves_mask.png",
                                           "sky_letters.png",   "star.png",    "weave_normal.png"};
    static const char mark[] = "-- the example\n";
    for (size_t i = 0; i < sizeof textures / sizeof *textures; i++)
        copy_into_test_folder("textures", textures[i]);
    copy_into_test_folder("data/fonts", "gray-round.ttf");
    copy_into_test_folder("data/models", "knot.ply");
    char *page = test_read_file("docs/language.md", NULL), *head = NULL, *tail = NULL;
    int count = 0;
    for (char *block = page; block && (block = strstr(block, "```lua\n")) != NULL; count++) {
        char *begin = block + 7, *end = strstr(begin, "```"), *scene = NULL;
        CHECK(end != NULL);
        if (!end)
            break;
        *end = '\0';
        if (!head) {
            head = begin;
            tail = strstr(head, mark);
            CHECK(tail != NULL);
            if (!tail)
                break;
            *tail = '\0';
            begin = tail; /* nothing instead of the mark */
            tail += strlen(mark);
        }
        CHECK(asprintf(&scene, "%s%s%s", head, begin, tail) > 0);
        struct test_result result = test_gray_scene(scene, "scene.lua", NULL);
        /* Where an optional library is missing, its examples end with the line that says so. */
        bool is_without_library = strstr(result.err, "it was made without ") != NULL;
        if (!is_without_library && (result.status != 0 || strstr(result.err, "warning")))
            test_fail(__FILE__, __LINE__, "%s\n%s", begin, result.err);
        test_free_result(&result);
        free(scene);
        block = end + 3;
    }
    CHECK(count >= 20);
    free(page);
}
