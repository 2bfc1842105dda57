/* What CONTRIBUTING.md promises of the tree: its recipes, each a diff in tests/recipes whose first line names the tests
 * that it must pass; and what the pieces of a path do not call. */
#define _GNU_SOURCE
#include "tests/harness.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Calls `visit` with the name of every recipe ("lobe") and its text. */
static void each_recipe(void (*visit)(const char *name, const char *text)) {
    DIR *folder = opendir("tests/recipes");
    int count = 0;
    CHECK(folder != NULL);
    for (struct dirent *entry; folder && (entry = readdir(folder)) != NULL;) {
        char path[512], name[256];
        size_t length = strlen(entry->d_name);
        if (length < 6 || strcmp(entry->d_name + length - 5, ".diff") != 0)
            continue;
        (void)snprintf(path, sizeof path, "tests/recipes/%s", entry->d_name);
        (void)snprintf(name, sizeof name, "%.*s", (int)length - 5, entry->d_name);
        char *text = test_read_file(path, NULL);
        CHECK(text != NULL);
        if (text)
            visit(name, text);
        free(text);
        count++;
    }
    if (folder)
        (void)closedir(folder);
    CHECK_EQ_INT(count, 6);
}

static int count_of(const char *text, const char *word) {
    int count = 0;
    for (const char *at = text; (at = strstr(at, word)) != NULL; at++)
        count++;
    return count;
}

/* The table has a row "| [NAME](tests/recipes/NAME.diff) | FILES | ...". */
static void check_files(const char *name, const char *text) {
    char *page = test_read_file("CONTRIBUTING.md", NULL), link[300];
    (void)snprintf(link, sizeof link, "(tests/recipes/%s.diff) | ", name);
    const char *row = page ? strstr(page, link) : NULL;
    int files = count_of(text, "\n+++ b/src/") + count_of(text, "\n+++ b/tests/");
    if (!row)
        test_fail(__FILE__, __LINE__, "the table of CONTRIBUTING.md has no row of %s", name);
    else if (atoi(row + strlen(link)) != files)
        test_fail(__FILE__, __LINE__, "%s changes %d files, not as many as its row says", name, files);
    free(page);
}

TEST(recipes_change_as_many_files_as_contributing_says) {
    each_recipe(check_files);
}

static void need_patch(void) {
    if (system("command -v patch >/dev/null") != 0)
        test_skip("needs patch");
}

static void check_applies(const char *name, const char *text) {
    char line[512];
    (void)text;
    (void)snprintf(line, sizeof line, "patch -p1 -f -s --dry-run <tests/recipes/%s.diff >%s 2>&1", name,
                   test_path("out.txt"));
    if (system(line) == 0)
        return;
    char *said = test_read_file(test_path("out.txt"), NULL);
    test_fail(__FILE__, __LINE__, "tests/recipes/%s.diff does not apply to the tree any more:\n%s", name,
              said ? said : "");
    free(said);
}

TEST(recipes_apply_to_the_tree) {
    need_patch();
    each_recipe(check_applies);
}

static char words[1024]; /* the tests of all recipes */

static void add_words(const char *name, const char *text) {
    static const char begin[] = "Tests: ";
    CHECK(strncmp(text, begin, sizeof begin - 1) == 0);
    size_t used = strlen(words);
    (void)snprintf(words + used, sizeof words - used, " %.*s", (int)strcspn(text + 7, "\n"), text + 7);
    (void)name;
}

TEST_LONG(the_pieces_of_a_path_call_no_allocator_no_pointer_and_not_themselves) {
    char root[4096], *line = NULL;
    if (test_has_sanitizer())
        test_skip("compiles a build of its own");
    CHECK(realpath(".", root) != NULL);
    if (asprintf(&line, "unset MAKEFLAGS MFLAGS MAKELEVEL; '%s/tools/pieces.sh' \"$PWD/pieces\"", root) < 0)
        exit(1);
    test_shell(line, 0, "no allocator, no call through a pointer, no recursion");
    free(line);
}

/* All together, in a copy of the tree with its objects, so that only what they change is compiled. */
TEST_LONG(recipes_compile_keep_the_layers_and_pass_their_tests) {
    char root[4096], *line = NULL;
    need_patch();
    if (test_has_sanitizer())
        test_skip("compiles the release build");
    CHECK(realpath(".", root) != NULL);
    each_recipe(add_words);
    if (asprintf(&line,
                 "set -e; unset MAKEFLAGS MFLAGS MAKELEVEL GRAY_TEST_BINARY; "
                 "(cd '%s' && tar c --exclude=./build --exclude=./.git --exclude=./gallery .) | tar x; "
                 "mkdir build; if [ -d '%s/build/release' ]; then cp -a '%s/build/release' build; fi; "
                 "for recipe in tests/recipes/*.diff; do patch -p1 -f -s <$recipe; done; "
                 "make -s -j$(nproc) WERROR=1 all build-tests; ./gray --annotations >lua/gr.lua; make -s layers; "
                 "build/release/tests/run annotation_file language_page documents%s",
                 root, root, root, words) < 0)
        exit(1);
    test_shell(line, 0, " passed, 0 failed, 0 skipped");
    free(line);
}
