/* See oidn_internal.h. */
#include "output/oidn_internal.h"

#include "base/file.h"
#include "base/mem.h"
#include "image/float_write.h"
#include "image/image.h"
#include "output/tool_internal.h"

#include <stdio.h>

static char *const arguments[] = {(char[]){"oidnDenoise"},  (char[]){"--hdr"},
                                  (char[]){"colour.pfm"},   (char[]){"--alb"},
                                  (char[]){"albedo.pfm"},   (char[]){"--nrm"},
                                  (char[]){"normal.pfm"},   (char[]){"-o"},
                                  (char[]){"denoised.pfm"}, NULL};

enum input { INPUT_COLOUR, INPUT_ALBEDO, INPUT_NORMAL, INPUTS };
static const char *const input_names[INPUTS] = {"colour.pfm", "albedo.pfm", "normal.pfm"};
static const char output_name[] = "denoised.pfm";

struct input_rows {
    const struct denoise_source *source;
    struct denoise_pixel *row;
    enum input input;
};

static float value_of(const struct denoise_pixel *pixel, enum input input, int channel) {
    float a = 0, b = 0;
    switch (input) {
    case INPUT_COLOUR:
        return pixel->share * pixel->colour[0][channel] + (1 - pixel->share) * pixel->colour[1][channel];
    case INPUT_ALBEDO:
        a = pixel->features[0][DENOISE_ALBEDO + channel];
        b = pixel->features[1][DENOISE_ALBEDO + channel];
        break;
    case INPUT_NORMAL:
        a = pixel->features[0][DENOISE_NORMAL + channel];
        b = pixel->features[1][DENOISE_NORMAL + channel];
        break;
    case INPUTS:
        break;
    }
    return pixel->share * a + (1 - pixel->share) * b;
}

static void input_row(void *context, uint32_t y, float *line) {
    struct input_rows *rows = context;
    rows->source->row(rows->source->context, y, rows->row);
    for (uint32_t x = 0; x < rows->source->width; x++)
        for (int c = 0; c < 3; c++)
            line[3 * x + (uint32_t)c] = value_of(&rows->row[x], rows->input, c);
}

enum { PATH_LIMIT = 4096 };

static bool join(const char *folder, const char *name, char out[PATH_LIMIT], struct error *error) {
    return snprintf(out, PATH_LIMIT, "%s/%s", folder, name) < PATH_LIMIT ||
           error_set(error, ERROR_MACHINE, "%.200s...: the name of the temporary folder is too long", folder);
}

static bool write_inputs(const struct denoise_source *source, const char *folder, struct error *error) {
    struct input_rows rows = {.source = source, .row = mem_alloc_zero(source->width, sizeof *rows.row)};
    bool ok = rows.row || error_no_memory(error, "a picture that is denoised");
    for (int i = 0; i < INPUTS && ok; i++) {
        char path[PATH_LIMIT];
        const struct file_target target = {.path = path};
        rows.input = (enum input)i;
        ok = join(folder, input_names[i], path, error) &&
             pfm_write(&target, source->width, source->height, input_row, &rows, error);
    }
    mem_free(rows.row);
    return ok;
}

static bool run_program(const char *folder, const struct file_interrupt *interrupt, struct error *error) {
    const struct tool tool = {"--denoise=oidn", arguments, folder, -1, interrupt};
    pid_t child = 0;
    return tool_start(&tool, &child, error) && tool_wait(&tool, child, error);
}

static bool read_output(const struct denoise_source *source, const char *folder, float (*out)[3], struct error *error) {
    char path[PATH_LIMIT];
    struct error reason = {0};
    if (!join(folder, output_name, path, error))
        return false;
    struct image *image = image_read(path, &reason);
    if (!image && reason.kind == ERROR_MACHINE) {
        *error = reason;
        return false;
    }
    if (!image)
        return error_set(error, ERROR_MACHINE, "--denoise=oidn: oidnDenoise wrote no PFM file that gray can read");
    uint32_t width = image_width(image), height = image_height(image);
    bool fits = width == source->width && height == source->height;
    for (uint32_t y = 0; y < height && fits; y++) {
        for (uint32_t x = 0; x < width; x++) {
            struct rgba texel = image_texel(image, x, y);
            float *rgb = out[(size_t)y * width + x];
            rgb[0] = (float)texel.r;
            rgb[1] = (float)texel.g;
            rgb[2] = (float)texel.b;
        }
    }
    image_release(image);
    return fits || error_set(error, ERROR_MACHINE,
                             "--denoise=oidn: oidnDenoise made a picture of %u x %u pixels instead of %u x %u", width,
                             height, source->width, source->height);
}

bool oidn_run(const struct denoise_source *source, const struct file_interrupt *interrupt, float (*out)[3],
              struct error *error) {
    char folder[PATH_LIMIT];
    if (!file_make_temporary_folder(folder, sizeof folder, error))
        return false;
    bool ok = write_inputs(source, folder, error) && run_program(folder, interrupt, error) &&
              read_output(source, folder, out, error);
    file_remove_temporary_folder(folder);
    return ok;
}
