/* See animation.h. Frames are read back from their files when the animation is assembled, so every format has the bytes
 * of the PNG files. */
#include "output/animation.h"

#include "base/mem.h"
#include "image/png_write.h"
#include "output/layers_internal.h"
#include "output/tool_internal.h"
#include "settings/frame.h"

#include <stdio.h>
#include <string.h>

void animation_init(struct animation *animation, const struct options *options, const struct picture_files *files) {
    *animation = (struct animation){.format = options->animation,
                                    .files = files,
                                    .rate = FRAME_RATE_DEFAULT,
                                    .incomplete = options->shards > 0 || options->shards_of_pictures > 1};
}

void animation_restart(struct animation *animation) {
    for (uint32_t index = 0; index < animation->count; index++)
        mem_free((void *)(uintptr_t)animation->frames[index]);
    animation->count = animation->last = 0;
}

bool animation_streams(const struct animation *animation, const struct picture_request *request) {
    return options_output_is_stream(animation->files->options) && request->frame.number > 0;
}

static struct file_target target_of(const struct animation *animation) {
    return (struct file_target){.path = animation->files->options->output, .rules = &animation->files->animation};
}

/* All frames have the same size, and their numbers increase. */
static bool check_frame(struct animation *animation, const struct picture_request *request, uint32_t number,
                        struct error *error) {
    uint32_t width = request->shown.x1 - request->shown.x0, height = request->shown.y1 - request->shown.y0;
    if (number <= animation->last)
        return error_set(error, ERROR_USAGE, "-o %.600s: frame %u comes after frame %u; a file has one animation",
                         animation->files->options->output, number, animation->last);
    if (animation->last > 0 && (width != animation->width || height != animation->height))
        return error_set(error, ERROR_SCENE, "-o %.600s: frame %u has %u x %u pixels, and the first one %u x %u",
                         animation->files->options->output, number, width, height, animation->width, animation->height);
    return true;
}

bool animation_begin(struct animation *animation, const struct picture_request *request, uint32_t number,
                     struct error *error) {
    const struct options *options = animation->files->options;
    bool streams = animation_streams(animation, request), first = animation->last == 0;
    if (animation->format == ANIMATION_NONE && !streams)
        return true;
    if (!check_frame(animation, request, number, error))
        return false;
    if (animation->format == ANIMATION_WEBP && !webp_can_write())
        return error_set(error, ERROR_SCENE, WEBP_MISSING, options->output) || error_elsewhere(error);
    const struct file_target target = target_of(animation);
    if (first && !streams && !file_output_check(&target, error))
        return error_elsewhere(error);
    double rate = options->script.frames.rate > 0 ? options->script.frames.rate : FRAME_RATE_DEFAULT;
    animation->rate = request->frame.number > 0 ? request->frame.rate : rate;
    animation->loops = request->frame.number > 0 ? request->frame.loops : options->script.frames.loops;
    animation->srgb = request->settings.tone.srgb;
    animation->width = request->shown.x1 - request->shown.x0;
    animation->height = request->shown.y1 - request->shown.y0;
    animation->last = number;
    return true;
}

bool animation_lock(struct animation *animation, struct error *error) {
    char folder[NAME_LIMIT], name[NAME_LIMIT + 8];
    const struct file_target target = {.path = name, .rules = &animation->files->picture};
    if (animation->format == ANIMATION_NONE || animation->lock.open ||
        !animation_folder(animation->files->options->output, folder))
        return true;
    (void)snprintf(name, sizeof name, "%s/lock", folder);
    return file_lock_take(&animation->lock, &target, animation->incomplete) ||
           error_set(error, ERROR_USAGE, "%.600s: another run writes its frames into this folder", folder) ||
           error_elsewhere(error);
}

bool animation_add(struct animation *animation, const char *name, struct error *error) {
    if (animation->format == ANIMATION_NONE)
        return true;
    if (animation->count == animation->room) {
        uint32_t room = 2 * animation->room + 64;
        const char **more = mem_resize_array(animation->frames, room, sizeof *more);
        if (!more)
            return error_no_memory(error, "the frames");
        animation->frames = more;
        animation->room = room;
    }
    size_t size = strlen(name) + 1;
    char *copy = mem_alloc(size);
    if (!copy)
        return error_no_memory(error, "the frames");
    memcpy(copy, name, size);
    animation->frames[animation->count++] = copy;
    return true;
}

/* --- streams --- */

static bool stream_open(struct animation *animation, struct error *error) {
    const struct file_target target = {.path = "-", .rules = &animation->files->picture};
    const struct animation_source source = {
        .width = animation->width, .height = animation->height, .rate = animation->rate};
    char head[Y4M_HEAD_SIZE];
    size_t size = y4m_head(&source, head);
    return animation->stream.open || (file_output_open(&animation->stream, &target, error) &&
                                      file_output_write(&animation->stream, head, size, error));
}

bool animation_put(struct animation *animation, const struct picture *picture, struct error *error) {
    size_t pixels = (size_t)animation->width * animation->height;
    uint8_t *rgb = mem_alloc(3 * pixels), *frame = mem_alloc(Y4M_FRAME_HEAD + 3 * pixels);
    bool ok = (rgb && frame) || error_no_memory(error, "a frame");
    ok = ok && picture_write_bytes(animation->files, picture, rgb, error) && stream_open(animation, error);
    if (ok) {
        y4m_frame(rgb, pixels, frame);
        ok = file_output_write(&animation->stream, frame, Y4M_FRAME_HEAD + 3 * pixels, error);
    }
    mem_free(rgb);
    mem_free(frame);
    return ok;
}

/* --- files --- */

static bool read_frame(void *context, uint32_t index, uint8_t *rgb, struct error *error) {
    const struct animation *animation = context;
    if (file_interrupted(&animation->files->interrupt, 0))
        return error_set(error, ERROR_CANCELLED, "%.600s: interrupted", animation->files->options->output);
    return png_frame_read(animation->frames[index], animation->width, animation->height, rgb, error);
}

bool animation_write(const struct picture_files *files, const struct animation_source *source, struct error *error) {
    const struct file_target target = {.path = files->options->output, .rules = &files->animation};
    switch (files->options->animation) {
    case ANIMATION_APNG:
        return apng_write(&target, source, error);
    case ANIMATION_GIF:
        return gif_write(&target, source, files->options->frame_palettes, error);
    case ANIMATION_WEBP:
        return webp_write(&target, source, error);
    case ANIMATION_Y4M:
        return y4m_write(&target, source, error);
    case ANIMATION_MP4:
    case ANIMATION_WEBM:
        return encoder_write(&target, source, files->options->animation, error);
    case ANIMATION_NONE:
        break;
    }
    return true;
}

/* A contact sheet: the frames in rows, each reduced by a whole number; a pixel is the mean of a square of pixels. */
struct sheet {
    uint32_t columns, rows, reduction, width, height; /* width, height: of a small picture */
    uint8_t *rgb;
};

static struct sheet sheet_layout(const struct animation *animation) {
    enum { SIDE = 2048 };
    struct sheet sheet = {.columns = 1, .reduction = 1};
    while (sheet.columns * sheet.columns < animation->count)
        sheet.columns++;
    sheet.rows = (animation->count + sheet.columns - 1) / sheet.columns;
    while ((uint64_t)sheet.columns * (animation->width / sheet.reduction) > SIDE &&
           animation->width / (sheet.reduction + 1) > 0 && animation->height / (sheet.reduction + 1) > 0)
        sheet.reduction++;
    sheet.width = animation->width / sheet.reduction;
    sheet.height = animation->height / sheet.reduction;
    return sheet;
}

static void put_small(const struct animation *animation, struct sheet *sheet, uint32_t index, const uint8_t *rgb) {
    uint32_t n = sheet->reduction, stride = sheet->columns * sheet->width;
    uint8_t *corner = sheet->rgb + 3 * ((size_t)(index / sheet->columns) * sheet->height * stride +
                                        (size_t)(index % sheet->columns) * sheet->width);
    for (uint32_t y = 0; y < sheet->height; y++) {
        for (uint32_t x = 0; x < sheet->width; x++) {
            for (uint32_t c = 0; c < 3; c++) {
                uint32_t sum = 0;
                for (uint32_t k = 0; k < n * n; k++)
                    sum += rgb[3 * ((size_t)(y * n + k / n) * animation->width + x * n + k % n) + c];
                corner[3 * ((size_t)y * stride + x) + c] = (uint8_t)((2 * sum + n * n) / (2 * n * n));
            }
        }
    }
}

static void sheet_row(void *context, uint32_t y, uint8_t *line) {
    const struct sheet *sheet = context;
    size_t size = 3 * (size_t)sheet->columns * sheet->width;
    memcpy(line, sheet->rgb + y * size, size);
}

static bool write_sheet(const struct animation *animation, struct error *error) {
    struct sheet sheet = sheet_layout(animation);
    char name[LAYER_NAME_LIMIT];
    const struct file_target target = {.path = name, .rules = &animation->files->beside};
    if (!animation->files->options->contact_sheet)
        return true;
    if (!animation_sheet_name(animation->files->options->output, name, error))
        return false;
    /* One frame at a time is in memory beside the sheet. */
    sheet.rgb = mem_alloc_zero((size_t)sheet.columns * sheet.width, (size_t)3 * sheet.rows * sheet.height);
    uint8_t *rgb = mem_alloc((size_t)3 * animation->width * animation->height);
    bool ok = (sheet.rgb && rgb) || error_no_memory(error, "the contact sheet");
    for (uint32_t index = 0; ok && index < animation->count; index++) {
        ok = png_frame_read(animation->frames[index], animation->width, animation->height, rgb, error);
        if (ok)
            put_small(animation, &sheet, index, rgb);
    }
    const struct png_source source = {.width = sheet.columns * sheet.width,
                                      .height = sheet.rows * sheet.height,
                                      .bytes = sheet_row,
                                      .context = &sheet,
                                      .srgb = animation->srgb};
    ok = ok && png_write_from(&target, &source, NULL, error);
    mem_free(sheet.rgb);
    mem_free(rgb);
    return ok;
}

/* The animation is written even if a frame cannot be removed. */
static void remove_frames(const struct animation *animation) {
    struct error ignored;
    struct file_identity identity;
    for (uint32_t index = 0; index < animation->count; index++) {
        const struct file_target target = {.path = animation->frames[index], .rules = &animation->files->picture};
        if (file_identity_of(target.path, &identity))
            (void)file_output_remove(&target, identity, &ignored);
    }
}

bool animation_take_files(struct animation *animation, const char *const *names, uint32_t count, struct error *error) {
    const struct frame_options *options = &animation->files->options->script.frames;
    struct png_frame first;
    const struct file_target target = target_of(animation);
    if (!png_frame_head(names[0], &first, error) || !file_output_check(&target, error))
        return false;
    animation->width = first.width;
    animation->height = first.height;
    animation->srgb = first.srgb;
    animation->borrowed = true;
    animation->loops = options->loops;
    animation->rate = options->rate > 0 ? options->rate : FRAME_RATE_DEFAULT;
    for (uint32_t index = 0; index < count; index++) {
        if (!animation_add(animation, names[index], error))
            return false;
    }
    return true;
}

bool animation_finish(struct animation *animation, struct error *error) {
    if (animation->stream.open && !file_output_commit(&animation->stream, error))
        return false;
    if (animation->format == ANIMATION_NONE || animation->count == 0 || animation->incomplete)
        return true;
    const struct animation_source source = {.width = animation->width,
                                            .height = animation->height,
                                            .count = animation->count,
                                            .rate = animation->rate,
                                            .loops = animation->loops,
                                            .srgb = animation->srgb,
                                            .frame = read_frame,
                                            .context = animation};
    if (!animation_write(animation->files, &source, error) || !write_sheet(animation, error))
        return false;
    if (!animation->files->options->keep_frames && !animation->borrowed)
        remove_frames(animation);
    animation_restart(animation);
    return true;
}

void animation_destroy(struct animation *animation, uint32_t *left) {
    char folder[NAME_LIMIT];
    *left = animation->count;
    file_output_abandon(&animation->stream);
    animation_restart(animation);
    mem_free(animation->frames);
    file_lock_release(&animation->lock);
    if (animation->format != ANIMATION_NONE && animation_folder(animation->files->options->output, folder))
        (void)file_remove_empty_folder(folder);
    *animation = (struct animation){0};
}
