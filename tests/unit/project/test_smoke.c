/* Every demo and every classic scene of the repository in a tiny size, from another folder: they render without a
 * warning or a notice, and the pictures are not empty. make test runs them with sanitizers. */
#include "tests/harness.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SCENES = 200, PICTURES = 20 };

static int by_name(const void *a, const void *b) {
    return strcmp(*(char *const *)a, *(char *const *)b);
}

/* The names in a folder with this extension, sorted; from malloc. */
static int names_in(const char *folder, const char *end, char *names[SCENES]) {
    DIR *all = opendir(folder);
    int count = 0;
    for (struct dirent *entry; all && (entry = readdir(all)) && count < SCENES;) {
        size_t length = strlen(entry->d_name), tail = strlen(end);
        if (length >= tail && strcmp(entry->d_name + length - tail, end) == 0)
            names[count++] = strdup(entry->d_name);
    }
    if (all)
        (void)closedir(all);
    qsort(names, (size_t)count, sizeof *names, by_name);
    return count;
}

/* Writes the models that the scenes read: not in parallel with other tests. */
static bool is_maker(const char *name) {
    return strncmp(name, "make_", 5) == 0;
}

/* Required by the scenes in the same folder. */
static bool is_module(const char *name) {
    return strcmp(name, "studio.lua") == 0;
}

static bool is_heavy(const char *name) {
    return strcmp(name, "10demo.lua") == 0 || strcmp(name, "14demo.lua") == 0;
}

/* At least one picture of the asked size that shows more than one colour. */
static void check_pictures(const char *scene, int number) {
    int seen = 0;
    for (int k = 1; k <= PICTURES; k++) {
        char path[700];
        (void)snprintf(path, sizeof path, "%s/%d-%02d.png", test_folder(), number, k);
        if (access(path, F_OK) != 0)
            break;
        struct test_picture p = test_read_picture(path);
        bool varied = false;
        for (size_t i = 3; p.rgb && i < 3 * (size_t)p.width * p.height; i++)
            varied = varied || p.rgb[i] != p.rgb[i - 3];
        if (p.width != 64 || p.height != 48 || !varied)
            test_fail(__FILE__, __LINE__, "%s: picture %d of %u x %u is not as it should be", scene, k, p.width,
                      p.height);
        seen++;
        free(p.rgb);
    }
    if (seen == 0)
        test_fail(__FILE__, __LINE__, "%s: no picture", scene);
}

/* options: more words of the command line. */
static void smoke_with(const char *options, const char *folder, const char *end, bool heavy) {
    char root[2048], *names[SCENES];
    if (!getcwd(root, sizeof root))
        test_fail(__FILE__, __LINE__, "no working directory");
    int count = names_in(folder, end, names);
    CHECK(count > 0);
    for (int k = 0; k < count; k++) {
        char arguments[8192];
        (void)snprintf(arguments, sizeof arguments,
                       "--progress=none -D quick=true --size 64x48 --default samples=1 --default area_samples=1 "
                       "--default spp=1 -o %d-%%02d.png %s %s/%s/%s",
                       k, options, root, folder, names[k]);
        if (heavy == is_heavy(names[k]) && !is_maker(names[k]) && !is_module(names[k])) {
            struct test_result result = test_gray(NULL, arguments);
            if (result.status != 0 || result.err[0])
                test_fail(__FILE__, __LINE__, "%s/%s: status %d: %s", folder, names[k], result.status, result.err);
            else
                check_pictures(names[k], k);
            test_free_result(&result);
        }
        free(names[k]);
    }
}

static void smoke(const char *folder, const char *end, bool heavy) {
    smoke_with("", folder, end, heavy);
}

TEST(smoke_every_demo_renders_in_small_from_any_folder_without_a_warning) {
    smoke("data", "demo.lua", false);
}

/* data/meshes.lua may have this name because no scene in its folder requires the module by that name; the module has a
 * second name. */
static bool is_the_one_allowed(const char *folder, const char *scene) {
    char *scenes[SCENES];
    bool allowed = strcmp(folder, "data") == 0 && strcmp(scene, "meshes.lua") == 0;
    int count = allowed ? names_in(folder, ".lua", scenes) : 0;
    for (int i = 0; i < count; i++) {
        char path[1024];
        (void)snprintf(path, sizeof path, "%s/%s", folder, scenes[i]);
        char *text = test_read_file(path, NULL);
        if (!text || strstr(text, "require 'meshes'") || strstr(text, "require('meshes')") ||
            strstr(text, "require \"meshes\""))
            test_fail(__FILE__, __LINE__, "%s would get data/meshes.lua; the module is mesh_tools, too", path);
        free(text);
        free(scenes[i]);
    }
    return allowed;
}

/* The folder of a script is searched before the library: a scene named like a module would replace it for all scenes in
 * the folder. */
TEST(smoke_no_scene_has_the_name_of_a_library_module) {
    static const char *const folders[] = {"data", "data/classic"};
    char *modules[SCENES], *scenes[SCENES];
    int module_count = names_in("lua", ".lua", modules);
    for (int f = 0; f < 2; f++) {
        int count = names_in(folders[f], ".lua", scenes);
        for (int i = 0; i < count; i++) {
            for (int k = 0; k < module_count; k++)
                if (strcmp(scenes[i], modules[k]) == 0 && !is_the_one_allowed(folders[f], scenes[i]))
                    test_fail(__FILE__, __LINE__, "%s/%s hides the module", folders[f], scenes[i]);
            free(scenes[i]);
        }
    }
    for (int k = 0; k < module_count; k++)
        free(modules[k]);
    CHECK(module_count > 5);
}

TEST(smoke_scenes_of_shapes_meshes_and_bump_maps_render_in_small) {
    smoke("data", "solids.lua", false);
    smoke("data", "swept.lua", false);
    smoke("data", "meshes.lua", false);
    smoke("data", "relief.lua", false);
}

TEST(smoke_scenes_of_combined_solids_render_in_small) {
    smoke("data/csg", ".lua", false);
    smoke("data/functions", ".lua", false);
}

TEST(smoke_path_traced_demos_render_in_small_from_any_folder_without_a_warning) {
    smoke("data/path", ".lua", false);
}

/* 13 seconds of processor time in the release build. */
TEST(smoke_pictures_of_the_gallery_render_in_small) {
    if (strcmp(GRAY_CONFIG, "release") != 0)
        test_skip("too slow in this build; the release build renders them");
    smoke("data/gallery", ".lua", false);
}

TEST(smoke_animations_and_drawn_pictures_render_in_small) {
    smoke_with("--frames 1-25/8", "data/animation", ".lua", false);
    smoke("data", "styles.lua", false);
}

TEST(smoke_scenes_of_light_and_air_render_in_small) {
    smoke("data", "light.lua", false);
    smoke("data", "pyramid-fog.lua", false);
}

/* As drafts, if they support it. */
TEST(smoke_every_demo_of_the_library_renders_in_small) {
    smoke("data/library", ".lua", false);
}

TEST(smoke_every_classic_scene_renders_in_small) {
    smoke("data/classic", ".lua", false);
}

/* A hundred thousand polygons: without the sanitizers a second or two. */
TEST(smoke_the_final_scenes_render_in_small) {
    if (strcmp(GRAY_CONFIG, "release") != 0)
        test_skip("too slow in this build; the release build renders them");
    smoke("data", "demo.lua", true);
}
