/* Files that are there stay. The scene is one that the tests render, and the settings lead the editor to the library
 * and its annotations. */
#include "host/first_scene.h"

#include "base/file_output.h"
#include "session/text.h"

#include <stdio.h>
#include <string.h>

static const char scene[] =
    "-- A first scene.            gray first.lua                renders it into first.png\n"
    "-- Change a number here and  gray -gui --watch first.lua   shows it at once.\n"
    "-- What does a word mean?    gray --man sphere\n"
    "\n"
    "-- Materials: kd is the colour, ks the highlight (shininess: how small), reflect the share of mirrored light.\n"
    "local red = gr.material{kd = {0.8, 0.15, 0.1}, ks = {0.5, 0.5, 0.5}, shininess = 60}\n"
    "local mirror = gr.material{kd = {0.1, 0.1, 0.1}, ks = {0.9, 0.9, 0.9}, shininess = 200, reflect = 0.8}\n"
    "local floor = gr.material{kd = {0.75, 0.72, 0.65}}\n"
    "\n"
    "-- Solids: x points to the right, y up, z towards the camera. Every size is in the same unit.\n"
    "local ball = gr.sphere{radius = 1, material = red}\n"
    "ball:translate(-1.2, 1, 0)\n"
    "local box = gr.box{min = {-0.8, 0, -0.8}, max = {0.8, 1.6, 0.8}, material = mirror}\n"
    "box:rotate('y', 35)\n"
    "box:translate(1.1, 0, -0.5)\n"
    "local ground = gr.plane{normal = {0, 1, 0}, material = floor}\n"
    "\n"
    "-- The picture: what is in it, from where it is seen, and what lights it.\n"
    "gr.render{\n"
    "    node = gr.node{children = {ball, box, ground}},\n"
    "    width = 640, height = 400,\n"
    "    eye = {0, 2.5, 8}, target = {0, 0.8, 0}, fov = 32,\n"
    "    background = {0.55, 0.7, 0.9}, ambient = {0.4, 0.4, 0.4},\n"
    "    lights = {gr.area_light{corner = {-5, 8, 5}, v1 = {2, 0, 0}, v2 = {0, 0, 2}, colour = {0.8, 0.8, 0.75}}},\n"
    "}\n";

/* Writes the text into a new file in the folder and says so; a file that is there stays. */
static bool write_new(const char *folder, const char *name, const char *text, struct error *error) {
    static const struct file_rules rules = {.never_replace = true};
    char path[FILE_NAME_SIZE], line[FILE_NAME_SIZE + 64];
    (void)snprintf(path, sizeof path, "%.4000s%s%s", folder, folder[0] ? "/" : "", name);
    bool is_there = file_exists(path);
    struct file_output file = {0};
    if (!is_there) {
        const struct file_target target = {.path = path, .rules = &rules};
        if (!file_output_open(&file, &target, error) || !file_output_write(&file, text, strlen(text), error) ||
            !file_output_commit(&file, error)) {
            file_output_abandon(&file);
            return false;
        }
    }
    (void)snprintf(line, sizeof line, is_there ? "%s is there and stays as it is" : "%s is written", path);
    text_print_line(stdout, line);
    return true;
}

int first_scene_write(const struct options *options, const char *library) {
    const char *folder = options->script_count > 0 ? options->scripts[0] : "";
    char settings[2 * FILE_NAME_SIZE], line[FILE_NAME_SIZE + 64];
    struct error error = {.kind = ERROR_USAGE, .text = "--init takes the name of one folder"};
    int size = snprintf(settings, sizeof settings,
                        "{\n    \"runtime.version\": \"Lua 5.4\",\n    \"workspace.library\": [\"%s\"],\n"
                        "    \"workspace.checkThirdParty\": false\n}\n",
                        library ? library : "");
    bool can_name = library && !strpbrk(library, "\"\\\n") && size < (int)sizeof settings;
    if (options->script_count > 1 || !write_new(folder, "first.lua", scene, &error) ||
        (can_name && !write_new(folder, ".luarc.json", settings, &error))) {
        return text_print_error(&error);
    }
    (void)snprintf(line, sizeof line, "next: %s%.4000s%sgray first.lua", folder[0] ? "cd " : "", folder,
                   folder[0] ? " && " : "");
    text_print_line(stdout, line);
    return 0;
}
