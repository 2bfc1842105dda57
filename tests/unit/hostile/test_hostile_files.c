/* Malicious files: they are in tests/hostile/files, whose expected.txt has a row for each: how it is read, the file,
 * the exit status, the first line on standard error. Files that scripts read share one run of the program with one
 * script each, since a script that fails does not prevent the next from running. */
#include "tests/harness.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { ROWS_MAX = 400 };

struct row {
    char *how, *file, *line;
    int status;
};

static char folder[512];
static char *table_text;
static struct row rows[ROWS_MAX];
static int row_count;

static void copy_files(void) {
    (void)snprintf(folder, sizeof folder, "%s/files", test_folder());
    CHECK(mkdir(folder, 0777) == 0);
    DIR *stream = opendir("tests/hostile/files");
    CHECK(stream != NULL);
    for (struct dirent *entry; stream && (entry = readdir(stream)) != NULL;) {
        char from[400], to[1024];
        size_t size = 0;
        if (entry->d_name[0] == '.')
            continue;
        (void)snprintf(from, sizeof from, "tests/hostile/files/%.200s", entry->d_name);
        (void)snprintf(to, sizeof to, "%s/%.200s", folder, entry->d_name);
        char *bytes = test_read_file(from, &size);
        if (bytes)
            test_write_file(to, bytes, size);
        free(bytes);
    }
    if (stream)
        (void)closedir(stream);
}

static void read_table(void) {
    row_count = 0;
    table_text = test_read_file("tests/hostile/files/expected.txt", NULL);
    CHECK(table_text != NULL);
    char *rest = table_text;
    for (char *line; table_text && (line = strsep(&rest, "\n")) != NULL;) {
        if (line[0] == '\0' || line[0] == '#')
            continue;
        struct row *row = &rows[row_count];
        row->how = strsep(&line, "\t");
        row->file = strsep(&line, "\t");
        char *status = strsep(&line, "\t");
        row->status = status ? atoi(status) : -1;
        row->line = line;
        CHECK(row->file && row->line && row_count < ROWS_MAX - 1);
        row_count++;
    }
}

/* Whether this build reads files of this kind. */
static bool is_read(const struct row *row) {
    const char *end = strrchr(row->file, '.');
    (void)end;
#ifndef HAVE_JANSSON
    if (strcmp(end, ".gltf") == 0 || strcmp(end, ".glb") == 0)
        return false;
#endif
#ifndef HAVE_JPEG
    if (strcmp(end, ".jpg") == 0)
        return false;
#endif
#ifndef HAVE_EXR
    if (strcmp(end, ".exr") == 0)
        return false;
#endif
#ifndef HAVE_FREETYPE
    if (strcmp(end, ".ttf") == 0)
        return false;
#endif
    return true;
}

/* Stars in the pattern match anything. */
static bool matches(const char *pattern, const char *text) {
    for (; *pattern && *pattern != '*'; pattern++, text++)
        if (*pattern != *text)
            return false;
    if (*pattern == '\0')
        return *text == '\0';
    for (; *text; text++)
        if (matches(pattern + 1, text))
            return true;
    return matches(pattern + 1, text);
}

static void check_line(const struct row *row, const char *line) {
    if (!matches(row->line, line))
        test_fail(__FILE__, __LINE__, "%s says \"%s\", not \"%s\"", row->file, line, row->line);
}

/* The next message: indented lines give the position in the script. */
static char *next_message(char **rest) {
    char *line = strsep(rest, "\n");
    while (line && (line[0] == ' ' || line[0] == '\0'))
        line = strsep(rest, "\n");
    return line;
}

/* All files that are read in the same way and must end with this status; use: the script with %s for the file, or NULL:
 * the file is the script. */
static void check_scripts(const char *how, const char *use, const char *options, int status) {
    char arguments[4000], path[1024], text[400], position[40];
    int count = 0;
    (void)snprintf(arguments, sizeof arguments, "-q -j 1 %s", options);
    for (int i = 0; i < row_count; i++) {
        if (strcmp(rows[i].how, how) != 0 || rows[i].status != status || !is_read(&rows[i]))
            continue;
        char *end = arguments + strlen(arguments);
        size_t room = sizeof arguments - strlen(arguments);
        if (use) {
            (void)snprintf(path, sizeof path, "%s/%d.lua", folder, i);
            (void)snprintf(text, sizeof text, use, rows[i].file);
            test_write_text(path, text);
            (void)snprintf(end, room, " %d.lua", i);
        } else {
            (void)snprintf(end, room, " %s", rows[i].file);
        }
        count++;
    }
    if (count == 0)
        return;
    struct test_result result = test_gray(folder, arguments);
    char *rest = result.err;
    if (result.status != status)
        test_fail(__FILE__, __LINE__, "%s: the status is %d, not %d", how, result.status, status);
    for (int i = 0; i < row_count; i++) {
        if (strcmp(rows[i].how, how) != 0 || rows[i].status != status || !is_read(&rows[i]) ||
            strcmp(rows[i].line, "-") == 0)
            continue;
        char *line = next_message(&rest);
        (void)snprintf(position, sizeof position, "%d.lua:1: ", i);
        size_t skipped = line && strncmp(line, position, strlen(position)) == 0 ? strlen(position) : 0;
        check_line(&rows[i], line ? line + skipped : "nothing");
    }
    char *more = next_message(&rest);
    if (more)
        test_fail(__FILE__, __LINE__, "%s: one line more: %s", how, more);
    test_free_result(&result);
}

/* Those that are read by the program itself, one run for each. */
static void check_runs(const char *how, const char *arguments) {
    for (int i = 0; i < row_count; i++) {
        char text[600];
        if (strcmp(rows[i].how, how) != 0)
            continue;
        (void)snprintf(text, sizeof text, arguments, rows[i].file);
        struct test_result result = test_gray(folder, text);
        char *rest = result.err, *line = next_message(&rest);
        if (result.status != rows[i].status)
            test_fail(__FILE__, __LINE__, "%s ends with %d", rows[i].file, result.status);
        size_t skipped = line && strncmp(line, "scene.lua:1: ", 13) == 0 ? 13 : 0;
        check_line(&rows[i], line ? line + skipped : "nothing");
        CHECK(next_message(&rest) == NULL);
        test_free_result(&result);
    }
}

static void begin(void) {
    copy_files();
    read_table();
}

TEST(hostile_files_are_two_hundred_and_more_and_each_has_its_row) {
    begin();
    int unread = 0;
    DIR *stream = opendir(folder);
    for (struct dirent *entry; stream && (entry = readdir(stream)) != NULL;) {
        bool found = entry->d_name[0] == '.' || strcmp(entry->d_name, "expected.txt") == 0;
        for (int i = 0; i < row_count; i++) /* a material library is read by the mesh of the same name */
            found =
                found || strcmp(rows[i].file, entry->d_name) == 0 ||
                (strstr(entry->d_name, ".mtl") && strncmp(rows[i].file, entry->d_name, strlen(entry->d_name) - 3) == 0);
        unread += !found;
    }
    if (stream)
        (void)closedir(stream);
    CHECK_EQ_INT(unread, 0);
    CHECK(row_count >= 200);
    free(table_text);
}

TEST(hostile_mesh_files_are_one_line_each) {
    begin();
    for (int status = 0; status < 2; status++)
        check_scripts("mesh", "gr.mesh('m', '%s')\n", "", status);
    free(table_text);
}

TEST(hostile_pictures_skies_and_fonts_are_one_line_each) {
    begin();
    for (int status = 0; status < 2; status++) {
        check_scripts("picture", "gr.sphere('s'):set_texture('%s')\n", "", status);
        check_scripts("sky", "gr.sky_map{image='%s'}\n", "", status);
        check_scripts("font", "gr.glyphs{font='%s', text='A'}\n", "", status);
    }
    free(table_text);
}

TEST(hostile_scripts_as_data_and_other_files_as_scenes_are_one_line_each) {
    begin();
    for (int status = 0; status < 2; status++) {
        check_scripts("data", "dofile '%s'\n", "--script-time 0.1 --script-memory 64", status);
        check_scripts("scene", NULL, "", status);
    }
    free(table_text);
}

TEST(hostile_parts_and_checkpoints_are_one_line_each) {
    char path[1024];
    begin();
    check_runs("merge", "merge -q -o merged.png %s");
    (void)snprintf(path, sizeof path, "%s/scene.lua", folder);
    test_write_text(path, "gr.render{node=gr.sphere('s'), file='r.png', width=8, height=8, eye={0,0,4}}\n");
    check_runs("resume", "-q --checkpoint %s --resume scene.lua");
    free(table_text);
}
