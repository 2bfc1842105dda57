/* Saving the image as it is shown, the camera, and the edits. Existing files are never overwritten. */
#include "viewer/viewer_save.h"

#include "base/file.h"
#include "base/file_output.h"
#include "image/png_write.h"
#include "scene/edits.h"

#include <stdio.h>
#include <string.h>

enum { NAME = 4096, NUMBERS = 10000 };

/* The name that the user has chosen, or a free one beside the picture. */
static bool free_name(const struct viewer *viewer, const char *picture, const char *what, const char *extension,
                      char *name, struct error *error) {
    const char *slash = strrchr(picture, '/'), *dot = strrchr(picture, '.');
    size_t stem = dot && (!slash || dot > slash + 1) && dot != picture ? (size_t)(dot - picture) : strlen(picture);
    if (viewer->save_as[0] != '\0') {
        (void)snprintf(name, NAME, "%s", viewer->save_as);
        return !file_exists(name) ||
               error_set(error, ERROR_SCENE, "%.400s: the file exists, and the window replaces none", name);
    }
    for (int i = 1; i < NUMBERS; i++) {
        int length = snprintf(name, NAME, "%.*s%s%d.%s", (int)stem, picture, what, i, extension);
        if (length < NAME && !file_exists(name))
            return true;
    }
    return error_set(error, ERROR_SCENE, "%.400s: no free file name is left for the view", picture);
}

static void image_row(void *context, uint32_t y, uint8_t *line) {
    const struct viewer *viewer = context;
    size_t bytes = 3 * (size_t)viewer->request.width;
    memcpy(line, viewer->window.image + y * bytes, bytes);
}

bool viewer_save_image(const struct viewer *viewer, const struct file_target *picture, char *name,
                       struct error *error) {
    const struct file_target target = {.path = name, .rules = picture->rules};
    const struct png_source source = {.width = viewer->request.width,
                                      .height = viewer->request.height,
                                      .bytes = image_row,
                                      .context = (void *)(uintptr_t)viewer,
                                      .srgb = viewer->request.settings.tone.srgb};
    return free_name(viewer, picture->path, "-view", "png", name, error) &&
           png_write_from(&target, &source, NULL, error);
}

static bool put_line(void *context, const char *line) {
    struct file_output *file = context;
    struct error ignored; /* committing the file reports it */
    return file_output_write(file, line, strlen(line), &ignored);
}

/* Calls that give the picture these changes, between the lines of a file. */
struct lua_text {
    const char *head, *tail;
    const struct change_list *changes;
    const struct camera *camera; /* NULL: the script's; so is the exposure */
    const double *exposure;
};

static bool write_lua(const struct viewer *viewer, const struct file_target *picture, const char *what,
                      const struct lua_text *text, char *name, struct error *error) {
    const struct file_target target = {.path = name, .rules = picture->rules};
    struct file_output file;
    if (!free_name(viewer, picture->path, what, "lua", name, error) || !file_output_open(&file, &target, error))
        return false;
    if (put_line(&file, text->head) &&
        edits_write_lua(text->changes, viewer->request.file, text->camera, text->exposure, put_line, &file) &&
        put_line(&file, text->tail))
        return file_output_commit(&file, error);
    file_output_abandon(&file);
    return error_set(error, ERROR_MACHINE, "%.400s cannot be written", name);
}

bool viewer_save_camera(const struct viewer *viewer, const struct file_target *picture, char *name,
                        struct error *error) {
    static const struct change_list none;
    struct camera c = viewer->camera_moved ? fly_camera_current(&viewer->fly_camera) : viewer->request.camera;
    char table[1024];
    (void)snprintf(table, sizeof table,
                   "return {\n  eye = {%.17g, %.17g, %.17g},\n  view = {%.17g, %.17g, %.17g},\n"
                   "  up = {%.17g, %.17g, %.17g},\n  fov = %.17g,\n}\n",
                   c.eye.x, c.eye.y, c.eye.z, c.view.x, c.view.y, c.view.z, c.up.x, c.up.y, c.up.z, c.fov);
    const struct lua_text text = {
        "-- A camera saved from the window. A scene that requires this file (its name without .lua) before gr.render\n"
        "-- renders the picture with it. The file also returns the camera as a table.\n",
        table, &none, &c, NULL};
    return write_lua(viewer, picture, "-view", &text, name, error);
}

bool viewer_save_edits(const struct viewer *viewer, const struct file_target *picture, char *name,
                       struct error *error) {
    struct camera camera = fly_camera_current(&viewer->fly_camera);
    double exposure = viewer->request.settings.tone.exposure;
    bool exposed = exposure < viewer->script_exposure || exposure > viewer->script_exposure;
    const struct lua_text text = {
        "-- Edits made in the window. gray SCENE --edits FILE has them, and a scene that requires this file (its name\n"
        "-- without .lua) before gr.render.\n",
        "", &viewer->edit.steps.now, viewer->camera_moved ? &camera : NULL, exposed ? &exposure : NULL};
    return write_lua(viewer, picture, "-changes", &text, name, error);
}
