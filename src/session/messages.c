/* Of the render process nothing is trusted but what frame_is_sound has checked. The film of a picture in a window is
 * followed in its memory by the layers, and these by the overlay: lines, four floats a pixel, and the outline, a byte.
 */
#include "session/messages.h"

#include "render/aov.h"

#include <string.h>

static bool ends_with_zero(const char *text, size_t size) {
    return memchr(text, '\0', size) != NULL;
}

static bool news_is_sound(const struct studio_news *news) {
    const struct picked *picked = &news->picked;
    const char *const words[] = {picked->name, picked->shape, picked->material, picked->parent_name, news->root_name};
    bool sound = (unsigned)news->kind <= NEWS_MARKS && ends_with_zero(news->text, sizeof news->text) &&
                 ends_with_zero(picked->path, sizeof picked->path);
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        sound = sound && ends_with_zero(words[i], PICK_WORDS);
    return sound;
}

bool frame_is_sound(const struct frame *frame) {
    size_t before_text = offsetof(struct frame_line, text);
    const struct picture_request *request = &frame->body.request;
    switch (frame->kind) {
    case FRAME_LINE:
        return frame->size > before_text && frame->size <= sizeof frame->body.line &&
               (unsigned)frame->body.line.kind <= LINE_OUTPUT &&
               ends_with_zero(frame->body.line.text, frame->size - before_text);
    case FRAME_BEGIN:
        return frame->size == sizeof *request && ends_with_zero(request->file, sizeof request->file) &&
               request->width >= 1 && request->height >= 1 && request->full_width <= 1u << 20 &&
               request->full_height <= 1u << 20 && request->width <= request->full_width &&
               request->height <= request->full_height && request->x0 <= request->full_width - request->width &&
               request->y0 <= request->full_height - request->height && request->exposure >= -100 &&
               request->exposure <= 100 && request->curve <= TONE_FILMIC && film_record_valid(request->record) &&
               request->overlay <= OVERLAY_OF_GRID && (unsigned)request->lens.projection <= PROJECTION_PANORAMA &&
               (unsigned)request->lens.stereo <= STEREO_ANAGLYPH;
    case FRAME_DONE:
        return frame->size == sizeof frame->body.report;
    case FRAME_NEWS:
        return frame->size == sizeof frame->body.news && news_is_sound(&frame->body.news);
    case FRAME_ORDER:
        return frame->size == sizeof frame->body.order;
    case FRAME_ABANDON:
    case FRAME_AGAIN:
        return frame->size == 0;
    case FRAME_READ:
        return frame->size == sizeof frame->body.read &&
               ends_with_zero(frame->body.read.path, sizeof frame->body.read.path);
    case FRAME_SCRIPT:
        return frame->size == sizeof frame->body.script;
    case FRAME_FILM:
    case FRAME_ANSWER:
        return frame->size == sizeof frame->body.answer &&
               ends_with_zero(frame->body.answer.error.text, sizeof frame->body.answer.error.text);
    }
    return false;
}

/* Room for both parts of the overlay. */
enum { OVERLAY_LAYERS = 2 };

uint32_t marks_layers(const struct picture_request *request) {
    return aov_layers(request->layers & AOV_ALL) + (request->in_window ? OVERLAY_LAYERS : 0);
}

void marks_place(const struct picture_request *request, void *block, struct marks_place *place) {
    struct film film = {.width = request->width, .height = request->height, .record = request->record};
    size_t pixels = (size_t)request->width * request->height;
    film_place_layers(&film, block, AOV_ALL); /* any mask gives the place where layers begin */
    float *behind = film.layers[0] + pixels * aov_layers(request->layers & AOV_ALL) * 3;
    place->lines = (float(*)[4])(void *)behind;
    place->shows = (uint8_t *)(behind + 4 * pixels);
}

struct film live_film(const struct picture_request *request, void *block, uint32_t divide) {
    struct film film = {.x0 = request->x0 / divide,
                        .y0 = request->y0 / divide,
                        .full_width = (request->full_width + divide - 1) / divide,
                        .full_height = (request->full_height + divide - 1) / divide};
    uint32_t right = film.x0 + (request->width + divide - 1) / divide;
    uint32_t bottom = film.y0 + (request->height + divide - 1) / divide;
    right = right > film.full_width ? film.full_width : right;
    bottom = bottom > film.full_height ? film.full_height : bottom;
    film_place(&film, block, right - film.x0, bottom - film.y0, request->record);
    return film;
}
