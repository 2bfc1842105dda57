/* A path of eyes or directions has one point for each frame, linear between those of the command line. The files are
 * those of a run: atomic, and they replace only pictures. */
#include "output/view.h"

#include "base/file.h"
#include "base/mem.h"
#include "image/image.h"
#include "image/light_field_view.h"
#include "image/png_write.h"
#include "light/sky.h"
#include "math/elementary.h"
#include "output/animation.h"
#include "output/picture_files.h"
#include "session/text.h"

#include <stdlib.h>
#include <string.h>

enum { POINTS_LIMIT = 64, PANORAMA_WIDTH = 640, PANORAMA_HEIGHT = 480, PANORAMA_FOV = 50 };

/* What is shown: a light field, or a sky around the eye. */
struct show {
    const struct options *options;
    struct picture_files files;
    struct pool *pool;
    bool is_field;
    struct light_field field;
    struct image *image;
    struct sky sky;
    struct tone tone;
    struct vec3 points[POINTS_LIMIT]; /* of the path */
    uint32_t point_count, frames, width, height;
    float (*light)[3]; /* of the picture */
    uint8_t *rgb;      /* of a frame; borrowed */
};

/* --- the command line --- */

/* "X,Y,Z:X,Y,Z"; a number that is missing at the end is 0. */
static bool read_points(struct show *show, const char *option, const char *text, uint32_t numbers,
                        struct error *error) {
    for (const char *at = text; show->point_count < POINTS_LIMIT;) {
        double v[3] = {0, 0, 0};
        uint32_t count = 0;
        for (char *end; count < numbers; at = end + 1) {
            v[count++] = strtod(at, &end);
            if (end == at || !isfinite(v[count - 1]))
                return error_set(error, ERROR_USAGE, "%s %.600s: needs numbers with commas between them", option, text);
            at = end;
            if (*end != ',')
                break;
        }
        show->points[show->point_count++] = vec3_make(v[0], v[1], v[2]);
        if (*at == '\0' && count >= 2)
            return true;
        if (*at != ':' || count < 2)
            return error_set(error, ERROR_USAGE, "%s %.600s: needs %s, and ':' between several", option, text,
                             numbers == 3 ? "X,Y or X,Y,Z" : "LON,LAT");
        at++;
    }
    return error_set(error, ERROR_USAGE, "%s: a path has at most %d points", option, POINTS_LIMIT);
}

static bool check_options(const struct show *show, struct error *error) {
    const struct options *options = show->options;
    const char *of_field = options->eyes            ? "--eye"
                           : options->focus > 0     ? "--focus"
                           : options->aperture > 0  ? "--aperture"
                           : options->contact_sheet ? "--contact-sheet"
                                                    : NULL;
    const char *of_panorama = options->directions ? "--direction" : options->fov > 0 ? "--fov" : NULL;
    const char *name = options->scripts[0], *wrong = show->is_field ? of_panorama : of_field;
    bool animates = options->animation != ANIMATION_NONE;
    if (!options->output)
        return error_set(error, ERROR_USAGE, "view needs -o FILE");
    if (wrong)
        return error_set(error, ERROR_USAGE, "%s is not for %.600s, which is a %s", wrong, name,
                         show->is_field ? "light field" : "panorama");
    if (show->frames > 1 && !animates && !output_name_numbered(options->output))
        return error_set(error, ERROR_USAGE, "-o %.600s: frames need an animation, such as x.gif, or a name with %%d",
                         options->output);
    if (animates && options_output_is_stream(options))
        return error_set(error, ERROR_USAGE, "-o -: an animation needs the name of a file");
    return !options->contact_sheet || (!animates && !options->width && !options->eyes && show->frames == 1) ||
           error_set(error, ERROR_USAGE, "--contact-sheet is one picture of all views: no --size, --eye or --frames");
}

/* --- the file --- */

static bool open_panorama(struct show *show, struct error *error) {
    const char *name = show->options->scripts[0];
    struct error reason = {0};
    show->image = image_read(name, error);
    if (!show->image)
        return false;
    show->sky = (struct sky){.kind = SKY_MAP, .image = show->image};
    bool is_map = image_width(show->image) == 2 * image_height(show->image);
    if (!is_map && !sky_from_cross(show->image, false, &show->sky, &reason))
        return error_set(error, ERROR_SCENE,
                         "%.600s: is %u x %u; a panorama is twice as wide as high, or a 4 x 3 cross of six faces", name,
                         image_width(show->image), image_height(show->image));
    show->tone.srgb = image_bits(show->image) == 32;
    show->width = PANORAMA_WIDTH;
    show->height = PANORAMA_HEIGHT;
    return true;
}

static bool open_file(struct show *show, struct error *error) {
    const char *name = show->options->scripts[0];
    struct file_source source;
    uint8_t head[8];
    if (!file_source_open(&source, name, error))
        return false;
    show->is_field = file_source_read(&source, 0, head, sizeof head) && light_field_is(head, sizeof head);
    file_source_close(&source);
    const char *dot = strrchr(name, '.');
    if (!show->is_field && !(dot && picture_format(name) == PICTURE_LIGHT_FIELD))
        return open_panorama(show, error);
    if (!light_field_open(&show->field, name, error))
        return false;
    show->is_field = true;
    show->tone = show->field.head.tone;
    show->width = show->field.head.width;
    show->height = show->field.head.height;
    return true;
}

/* --- pictures --- */

static struct vec3 point_of_frame(const struct show *show, uint32_t frame) {
    uint32_t steps = show->options->script.frames.loops ? show->frames : show->frames - 1;
    double t = steps > 0 ? (double)frame / steps * (show->point_count - 1) : 0;
    uint32_t first = (uint32_t)t;
    if (first + 1 >= show->point_count)
        return show->points[show->point_count - 1];
    struct vec3 a = show->points[first], b = show->points[first + 1];
    return t == first ? a : vec3_add_scaled(a, vec3_sub(b, a), t - first);
}

static struct light_field_camera camera_of_frame(const struct show *show, uint32_t frame) {
    struct vec3 eye = point_of_frame(show, frame);
    double focus = show->options->focus > 0 ? show->options->focus : show->field.head.screen - eye.z;
    return (struct light_field_camera){eye.x, eye.y, eye.z, focus, show->options->aperture, show->width, show->height};
}

/* The plane in focus is in front of the eye and of the cameras. */
static bool check_focus(const struct show *show, uint32_t frame, struct error *error) {
    struct light_field_camera camera = camera_of_frame(show, frame);
    return (camera.focus > 0 && camera.focus + camera.z > 0) ||
           error_set(error, ERROR_USAGE, "--eye: %g is behind the plane in focus, %g from the cameras", camera.z,
                     camera.focus + camera.z);
}

/* One row of a panorama. */
struct turned {
    struct show *show;
    struct vec3 forward, right, up;
    double pixel;
};

static void turned_row(void *context, uint32_t y, int worker) {
    const struct turned *turned = context;
    struct show *show = turned->show;
    (void)worker;
    for (uint32_t x = 0; x < show->width; x++) {
        struct vec3 d = vec3_add_scaled(turned->forward, turned->right, (x + 0.5 - show->width / 2.0) * turned->pixel);
        d = vec3_add_scaled(d, turned->up, (show->height / 2.0 - y - 0.5) * turned->pixel);
        struct colour c = sky_colour(&show->sky, vec3_normalize(d), turned->pixel);
        float *out = show->light[(size_t)y * show->width + x];
        out[0] = (float)c.r, out[1] = (float)c.g, out[2] = (float)c.b;
    }
}

static bool draw_panorama(struct show *show, uint32_t frame, struct error *error) {
    struct vec3 at = point_of_frame(show, frame);
    double fov = show->options->fov > 0 ? show->options->fov : PANORAMA_FOV, sine[2], cosine[2];
    el_sincos(at.x * (PI / 180), &sine[0], &cosine[0]);
    el_sincos(at.y * (PI / 180), &sine[1], &cosine[1]);
    /* A map has -z in its middle, a cross +z. */
    double front = show->sky.kind == SKY_MAP ? -1 : 1;
    struct turned turned = {.show = show, .pixel = 2 * el_tan(fov * (PI / 360)) / show->height};
    turned.forward = vec3_make(-front * sine[0] * cosine[1], sine[1], front * cosine[0] * cosine[1]);
    turned.right = vec3_make(-front * cosine[0], 0, -front * sine[0]);
    turned.up = vec3_cross(turned.right, turned.forward);
    return pool_run(show->pool, show->height, turned_row, &turned) || error_set(error, ERROR_CANCELLED, "interrupted");
}

static bool draw(struct show *show, uint32_t frame, struct error *error) {
    if (!show->is_field)
        return draw_panorama(show, frame, error);
    struct light_field_camera camera = camera_of_frame(show, frame);
    (void)light_field_clamp(&show->field.head, &camera);
    return light_field_draw(&show->field, &camera, show->pool, show->light, error);
}

/* All views of the field in one picture. */
static bool draw_all_views(struct show *show, struct error *error) {
    const struct light_field_head *head = &show->field.head;
    const struct light_field_part all = {0, 0, head->columns, head->rows};
    if (!light_field_load_part(&show->field, &all, show->pool, error))
        return false;
    for (uint32_t y = 0; y < show->height; y++) {
        for (uint32_t x = 0; x < show->width; x++) {
            const float *view = show->field.views[y / head->height * head->columns + x / head->width];
            size_t at = (size_t)(y % head->height) * head->width + x % head->width;
            memcpy(show->light[(size_t)y * show->width + x], view + at * LIGHT_FIELD_NUMBERS, sizeof *show->light);
        }
    }
    return true;
}

/* --- files --- */

static void row_light(void *context, uint32_t y, float *line) {
    const struct show *show = context;
    memcpy(line, show->light[(size_t)y * show->width], show->width * sizeof *show->light);
}

static double number_at(const struct show *show, uint32_t y, uint32_t i) {
    return tone_apply(&show->tone, (double)show->light[(size_t)y * show->width + i / 3][i % 3]);
}

static void row_bytes(void *context, uint32_t y, uint8_t *line) {
    const struct show *show = context;
    for (uint32_t i = 0; i < 3 * show->width; i++)
        line[i] = png_write_byte(number_at(show, y, i));
}

static void row_words(void *context, uint32_t y, uint16_t *line) {
    const struct show *show = context;
    for (uint32_t i = 0; i < 3 * show->width; i++)
        line[i] = tone_word(number_at(show, y, i));
}

static bool write_picture(struct show *show, uint32_t frame, struct error *error) {
    const struct options *options = show->options;
    const struct picture_source source = {.width = show->width,
                                          .height = show->height,
                                          .bytes = row_bytes,
                                          .words = row_words,
                                          .light = row_light,
                                          .context = show,
                                          .deep = options->settings.deep,
                                          .srgb = show->tone.srgb};
    char name[NAME_LIMIT];
    const struct file_target target = {.path = name, .rules = &show->files.picture};
    return (output_name(options->output, frame + 1, name, sizeof name) ||
            error_set(error, ERROR_USAGE, "-o: the name is longer than %d bytes", NAME_LIMIT - 1)) &&
           picture_file_write(&target, &source, show->pool, error);
}

static void frame_row(void *context, uint32_t y, int worker) {
    const struct show *show = context;
    (void)worker;
    row_bytes(context, y, show->rgb + (size_t)3 * show->width * y);
}

static bool frame_bytes(void *context, uint32_t index, uint8_t *rgb, struct error *error) {
    struct show *show = context;
    show->rgb = rgb;
    return draw(show, index, error) &&
           (pool_run(show->pool, show->height, frame_row, show) || error_set(error, ERROR_CANCELLED, "interrupted"));
}

static bool write_animation(struct show *show, struct error *error) {
    const struct frame_options *frames = &show->options->script.frames;
    const struct animation_source source = {.width = show->width,
                                            .height = show->height,
                                            .count = show->frames,
                                            .rate = frames->rate > 0 ? frames->rate : FRAME_RATE_DEFAULT,
                                            .loops = frames->loops,
                                            .srgb = show->tone.srgb,
                                            .frame = frame_bytes,
                                            .context = show};
    return animation_write(&show->files, &source, error);
}

static bool write_all(struct show *show, struct error *error) {
    if (show->options->contact_sheet)
        return draw_all_views(show, error) && write_picture(show, 0, error);
    if (show->options->animation != ANIMATION_NONE)
        return write_animation(show, error);
    bool ok = true;
    for (uint32_t frame = 0; ok && frame < show->frames; frame++)
        ok = draw(show, frame, error) && write_picture(show, frame, error);
    return ok;
}

/* One warning for all frames. */
static void warn_of_eyes(const struct show *show) {
    bool outside = false;
    for (uint32_t frame = 0; frame < show->frames && show->is_field && !outside; frame++) {
        struct light_field_camera camera = camera_of_frame(show, frame);
        outside = light_field_clamp(&show->field.head, &camera);
    }
    if (outside && !show->options->quiet)
        text_print_message(stderr, TEXT_WARNING,
                           "gray: warning: --eye: rays from outside of the field are taken from its border");
}

static bool prepare(struct show *show, struct error *error) {
    const struct options *options = show->options;
    const struct light_field_head *head = &show->field.head;
    const char *path = options->eyes ? options->eyes : options->directions;
    char warning[256];
    struct file_identity identity;
    show->frames = options->script.frames.selection.step > 0 ? options->script.frames.selection.last : 1;
    if (!check_options(show, error))
        return false;
    show->point_count = !path;
    if (path && !read_points(show, options->eyes ? "--eye" : "--direction", path, options->eyes ? 3 : 2, error))
        return false;
    for (uint32_t frame = 0; frame < show->frames && show->is_field; frame++)
        if (!check_focus(show, frame, error))
            return false;
    if (options->width) {
        show->width = (uint32_t)options->width;
        show->height = (uint32_t)options->height;
    }
    if (options->contact_sheet) {
        show->width *= head->columns;
        show->height *= head->rows;
    }
    if (file_identity_of(options->scripts[0], &identity))
        picture_files_keep(&show->files, identity, false);
    show->pool = pool_create(options->threads, warning);
    show->light = mem_alloc_zero((size_t)show->width * show->height, sizeof *show->light);
    return (show->pool && show->light) || error_no_memory(error, "the picture");
}

int view_run(const struct options *options) {
    struct error error;
    /* Not on the stack, which may be small. */
    struct show *show = mem_alloc_zero(1, sizeof *show);
    bool ok = show || error_no_memory(&error, "the picture");
    if (ok) {
        show->options = options;
        picture_files_init(&show->files, options);
        ok = open_file(show, &error) && prepare(show, &error);
    }
    if (ok) {
        warn_of_eyes(show);
        ok = write_all(show, &error);
    }
    if (show) {
        mem_free(show->light);
        pool_destroy(show->pool);
        light_field_close(&show->field);
        image_release(show->image);
        picture_files_destroy(&show->files);
        mem_free(show);
    }
    if (ok)
        return 0;
    char line[sizeof error.text + 16];
    (void)snprintf(line, sizeof line, "gray: %s", error.text);
    text_print_message(stderr, TEXT_ERROR, line);
    return (int)error.kind;
}
