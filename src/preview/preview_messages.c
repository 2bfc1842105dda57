/* The film of a picture in a window is followed in its memory by the layers, and these by the overlay: lines, four
 * floats a pixel, and the outline, a byte. */
#include "preview/preview_messages.h"

#include "film/aov.h"

#include <string.h>

_Static_assert(sizeof(struct preview_reply) <= MESSAGE_SIZE_LIMIT &&
                   sizeof(struct preview_command) <= MESSAGE_SIZE_LIMIT,
               "a message has room for them");

static bool ends_with_zero(const char *text, size_t size) {
    return memchr(text, '\0', size) != NULL;
}

static bool reply_is_valid(const struct preview_reply *reply) {
    const struct picked *picked = &reply->picked;
    const char *const words[] = {picked->name, picked->shape, picked->material, picked->parent_name, reply->root_name};
    bool sound = (unsigned)reply->kind <= REPLY_NODES && reply->nodes.count <= NODE_ROWS &&
                 ends_with_zero(reply->text, sizeof reply->text) &&
                 ends_with_zero(picked->node_path, sizeof picked->node_path);
    for (uint32_t i = 0; sound && i < reply->nodes.count; i++)
        sound = ends_with_zero(reply->nodes.rows[i].name, NODE_NAME) &&
                ends_with_zero(reply->nodes.rows[i].kind, sizeof reply->nodes.rows[i].kind);
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        sound = sound && ends_with_zero(words[i], PICK_NAME);
    return sound;
}

bool preview_reply_read(const struct message *message, struct preview_reply *out) {
    if (message->kind != MESSAGE_PREVIEW_REPLY || message->size != sizeof *out)
        return false;
    memcpy(out, message->body.bytes, sizeof *out);
    out->report.rays.device = (struct device_statistics){0}; /* has a text, and only the supervisor fills it */
    return reply_is_valid(out);
}

bool preview_command_read(const struct message *message, struct preview_command *out) {
    if (message->kind != MESSAGE_PREVIEW_COMMAND || message->size != sizeof *out)
        return false;
    memcpy(out, message->body.bytes, sizeof *out);
    return true;
}

void view_overlay_buffers(const struct picture_request *request, void *block, struct view_overlay_buffers *buffers) {
    struct film film = {.width = request->width, .height = request->height, .record = request->record};
    size_t pixels = (size_t)request->width * request->height;
    film_layout_layers(&film, block, AOV_ALL); /* the offset of the layers is the same for every mask */
    float *behind = film.layers[0] + pixels * aov_layers(request->layers & AOV_ALL) * 3;
    buffers->lines = (float(*)[4])(void *)behind;
    buffers->shows = (uint8_t *)(behind + 4 * pixels);
}

struct film pass_film(const struct picture_request *request, void *block, uint32_t divide) {
    struct film film = {.x0 = request->x0 / divide,
                        .y0 = request->y0 / divide,
                        .full_width = (request->full_width + divide - 1) / divide,
                        .full_height = (request->full_height + divide - 1) / divide};
    uint32_t right = film.x0 + (request->width + divide - 1) / divide;
    uint32_t bottom = film.y0 + (request->height + divide - 1) / divide;
    right = right > film.full_width ? film.full_width : right;
    bottom = bottom > film.full_height ? film.full_height : bottom;
    film_layout(&film, block, right - film.x0, bottom - film.y0, request->record);
    return film;
}
