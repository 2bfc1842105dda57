/* Nothing that is there is ever overwritten. */
#include "app/souvenir.h"

#include "base/file.h"
#include "image/png_write.h"

#include <stdio.h>
#include <string.h>

enum { NAME = 4096, NUMBERS = 10000 };

static bool free_name(const char *picture, const char *extension, char *name, struct error *error) {
    const char *slash = strrchr(picture, '/'), *dot = strrchr(picture, '.');
    size_t stem = dot && (!slash || dot > slash + 1) && dot != picture ? (size_t)(dot - picture) : strlen(picture);
    for (int i = 1; i < NUMBERS; i++) {
        int length = snprintf(name, NAME, "%.*s-view%d.%s", (int)stem, picture, i, extension);
        if (length < NAME && !file_is_regular(name) && !file_is_folder(name))
            return true;
    }
    return error_set(error, ERROR_SCENE, "%.400s: there is no free name for what is shown", picture);
}

static void row(void *context, uint32_t y, uint8_t *line) {
    const struct live *live = context;
    size_t bytes = 3 * (size_t)live->request.width;
    memcpy(line, live->canvas + y * bytes, bytes);
}

bool souvenir_picture(const struct live *live, const char *picture_name, char *name, struct error *error) {
    return free_name(picture_name, "png", name, error) &&
           png_write(name, live->request.width, live->request.height, row, (void *)(uintptr_t)live, error);
}

bool souvenir_camera(const struct live *live, const char *picture_name, char *name, struct error *error) {
    struct camera c = live->flown ? walk_camera(&live->walk) : live->request.camera;
    struct file_output file;
    char text[1024];
    int length =
        snprintf(text, sizeof text,
                 "-- A camera found by walking: local camera = dofile('...'), then eye = camera.eye and so on.\n"
                 "return {\n  eye = {%.17g, %.17g, %.17g},\n  view = {%.17g, %.17g, %.17g},\n"
                 "  up = {%.17g, %.17g, %.17g},\n  fov = %.17g,\n}\n",
                 c.eye.x, c.eye.y, c.eye.z, c.view.x, c.view.y, c.view.z, c.up.x, c.up.y, c.up.z, c.fov);
    if (!free_name(picture_name, "lua", name, error) || !file_output_open(&file, name, error))
        return false;
    if (file_output_write(&file, text, (size_t)length, error))
        return file_output_commit(&file, error);
    file_output_abandon(&file);
    return false;
}
