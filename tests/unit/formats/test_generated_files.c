/* Small files of every kind that gray reads, written by a generator that knows what is right for each. */
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The next line of a text, which is cut there; NULL at its end. */
static char *next_line(char **text) {
    char *line = *text, *end = strchr(line, '\n');
    if (!end)
        return NULL;
    *end = '\0';
    *text = end + 1;
    return line;
}

static struct test_result run(const char *name) {
    char path[200], command[4400];
    (void)snprintf(path, sizeof path, "tests/scripts/%s.lua", name);
    char *script = realpath(path, NULL);
    (void)snprintf(command, sizeof command, "-j 1 --allow-write . %s", script);
    free(script);
    return test_gray(test_folder(), command);
}

TEST(pictures_of_extensions_are_their_factors_at_each_point) {
    test_need_json();
    struct test_result result = run("layer_maps");
    CHECK_EQ_INT(result.status, 0);
    CHECK_TEXT(result.err, "");
    test_free_result(&result);
}

/* The lines of the generator and the warnings of gray are in the order of the files. */
TEST(small_files_of_every_kind_have_their_triangles_their_colours_and_one_warning_each) {
    test_need_json();
    test_need_exr();
    struct test_result result = run("generated_files");
    CHECK_EQ_INT(result.status, 0);
    char *out = result.out, *err = result.err, *due, *warning = NULL;
    while ((due = next_line(&out))) {
        char file[64], *words = strchr(due, '\t');
        if (!words) {
            CHECK(atoi(due) >= 200);
            continue;
        }
        (void)snprintf(file, sizeof file, "warning: gr.mesh: %.*s:", (int)(words - due), due);
        warning = next_line(&err);
        if (!warning || !strstr(warning, file) || !strstr(warning, words + 1))
            test_fail(__FILE__, __LINE__, "%s, not %s", warning ? warning : "no warning", due);
    }
    CHECK_TEXT(err, ""); /* none is left */
    test_free_result(&result);
    /* Each is a scene, too. */
    test_shell("$gray -q --size 16x9 --spp 1 --denoise=none *.obj *.ply *.stl *.gltf *.glb 2>/dev/null;"
               " echo $?; ls *.obj *.ply *.stl *.gltf *.glb | wc -l; ls *.png | wc -l",
               0, "0\n244\n244\n");
}
