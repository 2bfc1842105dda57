/* Everything that the pages of docs/ name exists: tests, files, other pages and their sections. */
#include "tests/harness.h"

#include <ctype.h>
#include <dirent.h>
#include <fnmatch.h>
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { WORD = 512 };

/* Calls `visit` for every page of docs/ and of the root and of data/, with its text. */
static void each_page(void (*visit)(const char *name, char *text)) {
    static const char *const folders[] = {".", "docs", "docs/design", "docs/lab", "data"};
    int count = 0;
    for (size_t i = 0; i < sizeof folders / sizeof *folders; i++) {
        DIR *folder = opendir(folders[i]);
        CHECK(folder != NULL);
        for (struct dirent *entry; folder && (entry = readdir(folder)) != NULL;) {
            char path[512];
            size_t length = strlen(entry->d_name);
            if (length < 3 || strcmp(entry->d_name + length - 3, ".md") != 0)
                continue;
            (void)snprintf(path, sizeof path, "%s/%s", folders[i], entry->d_name);
            char *text = test_read_file(path, NULL);
            CHECK(text != NULL);
            if (text)
                visit(path, text);
            free(text);
            count++;
        }
        if (folder)
            (void)closedir(folder);
    }
    CHECK(count > 20);
}

/* Takes the next text in back quotes from a page. */
static bool next_quoted(const char **at, char word[WORD]) {
    for (const char *begin = strchr(*at, '`'); begin; begin = strchr(*at, '`')) {
        size_t length = strcspn(begin + 1, "`\n");
        *at = begin + 1 + length + (begin[1 + length] == '`');
        if (length == 0 || length >= WORD || begin[1 + length] != '`')
            continue;
        memcpy(word, begin + 1, length);
        word[length] = '\0';
        return true;
    }
    return false;
}

/* A test name or a part of one: lower-case letters with at least two underscores, "..." for omitted parts. */
static bool is_test_name(const char *word) {
    int underscores = 0;
    for (const char *c = word; *c; c++) {
        underscores += *c == '_';
        if (!isalnum((unsigned char)*c) && *c != '_' && strncmp(c, "...", 3) != 0 && *c != '.')
            return false;
    }
    const char *dot = strchr(word, '.');
    return underscores >= 2 && islower((unsigned char)*word) && (!dot || strncmp(dot, "...", 3) == 0);
}

/* Whether a source of tests/unit/ defines a test that matches the pattern: tests of an optional library are compiled
 * only if it is installed. */
static bool test_is_in_sources(const char *pattern) {
    bool found = false;
    glob_t sources;
    CHECK(glob("tests/unit/*/test_*.c", 0, NULL, &sources) == 0);
    for (size_t i = 0; i < sources.gl_pathc && !found; i++) {
        char name[WORD];
        char *text = test_read_file(sources.gl_pathv[i], NULL);
        for (const char *at = text; at && !found && (at = strstr(at, "\nTEST")) != NULL;) {
            at += strcspn(at, "(");
            size_t length = strcspn(at, ")");
            if (length == 0 || length >= sizeof name)
                continue;
            at++, length--;
            memcpy(name, at, length);
            name[length] = '\0';
            found = fnmatch(pattern, name, 0) == 0;
        }
        free(text);
    }
    globfree(&sources);
    return found;
}

static void tests_of_page(const char *page, char *text) {
    static const char *const pages[] = {"docs/lab/status.md", "docs/lab/reliability.md", "docs/lab/long-tests.md",
                                        "docs/solids.md"};
    char word[WORD], pattern[2 * WORD];
    bool is_listed = false;
    for (size_t i = 0; i < sizeof pages / sizeof *pages; i++)
        is_listed = is_listed || strcmp(page, pages[i]) == 0;
    if (!is_listed)
        return;
    int count = 0;
    for (const char *at = text; next_quoted(&at, word);) {
        if (!is_test_name(word))
            continue;
        char *to = pattern;
        *to++ = '*';
        for (const char *from = word; *from;) {
            bool left_out = *from == '.';
            *to++ = left_out ? '*' : *from;
            from += left_out ? 3 : 1;
        }
        memcpy(to, "*", 2);
        if (!test_is_named(pattern) && !test_is_in_sources(pattern))
            test_fail(__FILE__, __LINE__, "%s names the test %s, which does not exist", page, word);
        count++;
    }
    CHECK(count > 0);
}

TEST(documents_name_tests_that_exist) {
    each_page(tests_of_page);
}

/* Pages that may name files that do not exist: coverage results, files that a reader creates, old files. */
static bool is_of_another_time(const char *page) {
    return strstr(page, "coverage.md") || strstr(page, "CONTRIBUTING.md") || strstr(page, "notebook.md");
}

/* A program in bench/ is named without the extension of its source. */
static bool is_there(const char *name) {
    char source[WORD + 2];
    (void)snprintf(source, sizeof source, "%s.c", name);
    return access(name, F_OK) == 0 || access(source, F_OK) == 0;
}

static void files_of_page(const char *page, char *text) {
    static const char *const folders[] = {"tests/", "src/", "data/", "docs/", "tools/", "bench/", "lua/", "textures/"};
    char word[WORD];
    for (const char *at = text; !is_of_another_time(page) && next_quoted(&at, word);) {
        bool is_file = false;
        for (size_t i = 0; i < sizeof folders / sizeof *folders; i++)
            is_file = is_file || strncmp(word, folders[i], strlen(folders[i])) == 0;
        if (is_file && !strpbrk(word, " *<>{}") && !strstr(word, "...") && !strstr(word, "NAME") && !is_there(word))
            test_fail(__FILE__, __LINE__, "%s names %s, which does not exist", page, word);
    }
}

TEST(documents_name_files_that_exist) {
    each_page(files_of_page);
}

/* The anchor of a heading: lower case, hyphens for blanks, without other punctuation. */
static void anchor_of(const char *heading, char out[WORD]) {
    size_t used = 0;
    for (; *heading && *heading != '\n' && used + 1 < WORD; heading++) {
        if (isalnum((unsigned char)*heading) || *heading == '_' || *heading == '-')
            out[used++] = (char)tolower((unsigned char)*heading);
        else if (*heading == ' ')
            out[used++] = '-';
    }
    out[used] = '\0';
}

static bool has_anchor(const char *text, const char *anchor) {
    for (const char *line = text; line; line = strchr(line, '\n')) {
        char own[WORD];
        line += *line == '\n';
        const char *heading = line + strspn(line, "#");
        if (heading == line || *heading != ' ')
            continue;
        anchor_of(heading + 1, own);
        if (strcmp(own, anchor) == 0)
            return true;
    }
    return false;
}

static void links_of_page(const char *page, char *text) {
    for (const char *at = text; (at = strstr(at, "](")) != NULL;) {
        char target[WORD], path[2 * WORD];
        at += 2;
        size_t length = strcspn(at, ")\n");
        if (length >= sizeof target || memchr(at, ':', length) || memchr(at, ' ', length))
            continue;
        memcpy(target, at, length);
        target[length] = '\0';
        char *anchor = strchr(target, '#');
        if (anchor)
            *anchor++ = '\0';
        const char *slash = strrchr(page, '/');
        (void)snprintf(path, sizeof path, "%.*s/%s", (int)(slash - page), page, target);
        if (target[0] && access(path, F_OK) != 0) {
            test_fail(__FILE__, __LINE__, "%s has a link to %s, which does not exist", page, target);
            continue;
        }
        char *other = anchor && target[0] ? test_read_file(path, NULL) : NULL;
        if (anchor && !has_anchor(target[0] ? other : text, anchor))
            test_fail(__FILE__, __LINE__, "%s has a link to %s#%s, which is no heading there", page, target, anchor);
        free(other);
    }
}

TEST(documents_have_links_that_lead_somewhere) {
    each_page(links_of_page);
}

static void lines_of_page(const char *page, char *text) {
    bool code = false;
    int number = 1;
    for (const char *line = text; *line; number++) {
        size_t length = strcspn(line, "\n");
        bool fence = strncmp(line, "```", 3) == 0;
        code = code != fence;
        if (length > 200 && !code && *line != '|' && strncmp(line, "    ", 4) != 0 && strncmp(line, "  |", 3) != 0)
            test_fail(__FILE__, __LINE__, "%s:%d is longer than 200 characters", page, number);
        line += length + (line[length] == '\n');
    }
}

TEST(documents_have_lines_of_at_most_200_characters_outside_of_tables_and_code) {
    each_page(lines_of_page);
}
