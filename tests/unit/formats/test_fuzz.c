/* Inputs that fuzzers have found, and their seeds, through the same targets in every build: a target aborts if its
 * claim is broken. The list of targets here must be that of tests/fuzz. */
#include "tests/harness.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#define TARGETS(X)                                                                                                     \
    X(bitmap)                                                                                                          \
    X(bundle) X(expr) X(font) X(messages) X(gltf) X(gz) X(jpeg) X(light) X(light_field) X(merge) X(mtl) X(obj)         \
        X(options) X(order) X(ply) X(png) X(resume) X(scene_json) X(script) X(stl) X(tiles) X(voxels)

/* The total size of the inputs of a target. */
struct inputs {
    uint8_t *bytes[4096];
    size_t sizes[4096];
    char names[4096][64];
    int count;
};

static void read_inputs(struct inputs *inputs, const char *kind, const char *target) {
    char folder[256];
    struct dirent **entries;
    (void)snprintf(folder, sizeof folder, "tests/fuzz/%s/%s", kind, target);
    int count = scandir(folder, &entries, NULL, alphasort);
    for (int i = 0; i < count; i++) {
        char path[1024];
        (void)snprintf(path, sizeof path, "%s/%.200s", folder, entries[i]->d_name);
        if (entries[i]->d_name[0] != '.' && inputs->count < 4096) {
            int at = inputs->count++;
            (void)snprintf(inputs->names[at], sizeof inputs->names[at], "%.20s/%.40s", kind, entries[i]->d_name);
            inputs->bytes[at] = (uint8_t *)test_read_file(path, &inputs->sizes[at]);
            CHECK(inputs->bytes[at] != NULL);
        }
        free(entries[i]);
    }
    if (count >= 0)
        free(entries);
}

/* The name is the last line in the output of a test that crashed. */
static void feed(const char *target, int (*input)(const uint8_t *data, size_t size)) {
    static struct inputs inputs;
    read_inputs(&inputs, "found", target);
    read_inputs(&inputs, "corpus", target);
    CHECK(inputs.count > 0);
    (void)input((const uint8_t *)"", 0);
    for (int i = 0; i < inputs.count; i++) {
        /* In a buffer of the exact size, so that a sanitizer detects a read past the end. */
        uint8_t *exact = malloc(inputs.sizes[i] > 0 ? inputs.sizes[i] : 1);
        CHECK(exact != NULL);
        memcpy(exact, inputs.bytes[i], inputs.sizes[i]);
        printf("    %s of %s\n", inputs.names[i], target);
        (void)fflush(stdout);
        (void)input(exact, inputs.sizes[i]);
        free(exact);
        free(inputs.bytes[i]);
    }
    /* A few bytes that claim to be large are refused before memory is allocated for them. */
    struct rusage usage;
    (void)getrusage(RUSAGE_SELF, &usage);
    CHECK(usage.ru_maxrss < 2 << 20); /* KiB */
}

#define REPLAY(target)                                                                                                 \
    int fuzz_##target##_input(const uint8_t *data, size_t size);                                                       \
    TEST(fuzz_inputs_of_##target##_do_no_harm) {                                                                       \
        feed(#target, fuzz_##target##_input);                                                                          \
    }
TARGETS(REPLAY)

TEST(fuzz_targets_are_all_fed) {
    static const char *const names[] = {
#define NAME(target) #target,
        TARGETS(NAME)};
    int count = 0;
    DIR *folder = opendir("tests/fuzz");
    for (struct dirent *entry; folder && (entry = readdir(folder)) != NULL;) {
        char name[64] = "";
        char dot[2];
        if (sscanf(entry->d_name, "fuzz_%63[^.].%1[c]", name, dot) != 2)
            continue;
        bool known = false;
        for (size_t i = 0; i < sizeof names / sizeof *names; i++)
            known = known || strcmp(names[i], name) == 0;
        if (!known)
            test_fail(__FILE__, __LINE__, "tests/fuzz/%s is not in the list", entry->d_name);
        count++;
    }
    if (folder)
        (void)closedir(folder);
    CHECK_EQ_INT(count, sizeof names / sizeof *names);
}
