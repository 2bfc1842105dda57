/* Any bytes as a light field: views with finite numbers that can be drawn, or one line that names the file. */
#define _GNU_SOURCE
#include "base/mem.h"
#include "image/light_field_view.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void draw(struct light_field *field, struct pool *pool, struct error *error) {
    enum { WIDTH = 5, HEIGHT = 4 };
    struct light_field_camera camera = {field->head.spacing / 3,
                                        0,
                                        field->head.screen / 9,
                                        field->head.screen,
                                        field->head.spacing,
                                        WIDTH,
                                        HEIGHT,
                                        false};
    float out[WIDTH * HEIGHT][3];
    (void)light_field_clamp(&field->head, &camera);
    if (light_field_draw(field, &camera, pool, out, error))
        for (int i = 0; i < WIDTH * HEIGHT * 3; i++)
            if (isnan(out[i / 3][i % 3]))
                abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static struct pool *pool;
    struct light_field field;
    struct error error = {0};
    char path[64], warning[256];
    int descriptor = memfd_create("fuzz.lf", MFD_CLOEXEC);
    pool = pool ? pool : pool_create(1, warning);
    if (!pool || descriptor < 0 || write(descriptor, data, size) != (ssize_t)size)
        abort();
    (void)snprintf(path, sizeof path, "/proc/self/fd/%d", descriptor);
    bool taken = light_field_open(&field, path, &error);
    if (taken)
        draw(&field, pool, &error);
    if ((!taken && error.kind == ERROR_NONE) ||
        (error.kind != ERROR_NONE && (!strstr(error.text, path) || strchr(error.text, '\n'))))
        abort();
    light_field_close(&field);
    (void)close(descriptor);
    return 0;
}
