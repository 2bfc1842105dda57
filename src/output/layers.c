/* The name of a layer comes before the extension of the picture, which selects the format of both. */
#include "output/layers_internal.h"

#include "film/aov.h"
#include "image/exr.h"
#include "image/picture_file.h"
#include "image/png_write.h"

#include <stdio.h>
#include <string.h>

bool layers_name(const char *name, const char *layer, char out[LAYER_NAME_LIMIT], struct error *error) {
    const char *slash = strrchr(name, '/'), *base = slash ? slash + 1 : name, *dot = strrchr(base, '.');
    int stem = (int)(dot && dot > base ? dot - name : (ptrdiff_t)strlen(name));
    if (snprintf(out, LAYER_NAME_LIMIT, "%.*s.%s%s", stem, name, layer, name + stem) >= LAYER_NAME_LIMIT)
        return error_set(error, ERROR_SCENE, "%s: with %s in it the name is longer than %d bytes", name, layer,
                         LAYER_NAME_LIMIT - 1);
    return true;
}

struct layer_rows {
    enum aov aov;
    uint32_t width;
    const float (*values)[3];
    struct aov_scale scale;
    const struct tone *tone;
};

/* The colour of a pixel in a PNG file. The picture before denoising is shown as the picture is. */
static void layer_colour(const struct layer_rows *rows, uint32_t x, uint32_t y, double rgb[3]) {
    const float *values = rows->values[(size_t)y * rows->width + x];
    aov_colour(rows->aov, &rows->scale, values, rgb);
    for (int c = 0; c < 3 && rows->aov == AOV_RAW; c++)
        rgb[c] = tone_apply(rows->tone, (double)values[c]);
}

static void layer_row(void *context, uint32_t y, uint8_t *line) {
    const struct layer_rows *rows = context;
    for (uint32_t x = 0; x < rows->width; x++) {
        double rgb[3];
        layer_colour(rows, x, y, rgb);
        for (uint32_t c = 0; c < 3; c++)
            line[3 * x + c] = png_write_byte(rgb[c]);
    }
}

static void layer_row_16(void *context, uint32_t y, uint16_t *line) {
    const struct layer_rows *rows = context;
    for (uint32_t x = 0; x < rows->width; x++) {
        double rgb[3];
        layer_colour(rows, x, y, rgb);
        for (uint32_t c = 0; c < 3; c++)
            line[3 * x + c] = tone_word(rgb[c]);
    }
}

static void layer_row_linear(void *context, uint32_t y, float *line) {
    const struct layer_rows *rows = context;
    memcpy(line, rows->values + (size_t)y * rows->width, rows->width * sizeof *rows->values);
}

bool layers_write_exr(const struct file_target *target, const struct film *film, const float *alpha,
                      struct error *error) {
    static const char *const light[3] = {"R", "G", "B"};
    struct exr_channel channels[4 + 3 * AOV_COUNT];
    char names[AOV_COUNT][3][32]; /* "normal.X" */
    uint32_t count = 0, floats = sizeof *film->pixels / sizeof(float);
    size_t pixels = (size_t)film->width * film->height;
    for (int c = 0; c < 3; c++)
        channels[count++] = (struct exr_channel){light[c], &film->pixels[0].rgb[c], floats};
    if (alpha)
        channels[count++] = (struct exr_channel){"A", alpha, 1};
    for (int i = 0; i < AOV_COUNT; i++) {
        if (!(film->layer_mask >> i & 1))
            continue;
        const float(*values)[3] = (const float(*)[3])(film->layers + aov_layer(film->layer_mask, (enum aov)i) * pixels);
        const char *letters = aov_channels((enum aov)i);
        for (int c = 0; letters[c]; c++) {
            (void)snprintf(names[i][c], sizeof names[i][c], "%s.%c", aov_name((enum aov)i), letters[c]);
            channels[count++] = (struct exr_channel){names[i][c], &values[0][c], 3};
        }
    }
    return exr_write_channels(target, film->width, film->height, channels, count, error);
}

bool layers_write(const struct file_target *picture, const struct film *film, const struct tone *tone,
                  bool deep_picture, struct error *error) {
    size_t pixels = (size_t)film->width * film->height;
    char name[LAYER_NAME_LIMIT];
    const struct file_target target = {.path = name, .rules = picture->rules};
    for (int i = 0; i < AOV_COUNT && picture_format(picture->path) != PICTURE_EXR; i++) {
        if (!(film->layer_mask >> i & 1))
            continue;
        /* The values of a layer lie behind those of the layers before it. */
        struct layer_rows rows = {.aov = (enum aov)i, .width = film->width, .tone = tone};
        rows.values = (const float(*)[3])(film->layers + aov_layer(film->layer_mask, rows.aov) * pixels);
        rows.scale = aov_scale(rows.aov, rows.values, pixels);
        if (!layers_name(picture->path, aov_name(rows.aov), name, error))
            return false;
        struct picture_source source = {film->width,
                                        film->height,
                                        layer_row,
                                        layer_row_16,
                                        layer_row_linear,
                                        &rows,
                                        deep_picture || rows.aov == AOV_DEPTH,
                                        rows.aov == AOV_RAW && tone->srgb,
                                        false,
                                        false,
                                        NULL};
        if (!picture_file_write(&target, &source, NULL, error))
            return false;
    }
    return true;
}
