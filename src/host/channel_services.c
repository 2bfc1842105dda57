/* Each question is a frame and, where there is one, its answer. When the supervisor cannot be reached every question
 * fails as "cancelled", which ends the scripts. */
#include "host/channel_services.h"

#include <errno.h>
#include <string.h>

static bool nobody_there(struct child_link *link, struct error *error) {
    link->broken = true;
    return error_set(error, ERROR_CANCELLED, "the supervising process is gone");
}

static void note(struct child_link *link, bool sent) {
    link->broken = link->broken || !sent;
}

static bool link_begin(void *context, const struct picture_request *request, struct film *film, bool *already,
                       struct error *error) {
    struct child_link *link = context;
    struct frame frame;
    size_t bytes;
    if (!film_size_layered(request->width, request->height, request->record, marks_layers(request), &bytes, error))
        return false;
    if (!channel_send(&link->channel, FRAME_BEGIN, request, sizeof *request, -1) ||
        channel_receive(&link->channel, &frame) != CHANNEL_FRAME || frame.kind != FRAME_FILM)
        return nobody_there(link, error);
    if (!frame.body.answer.ok) {
        *error = frame.body.answer.error;
        return false;
    }
    *already = frame.body.answer.already;
    if (request->check || *already)
        return true;
    bool attached =
        frame.descriptor >= 0
            ? share_attach(&link->memory, frame.descriptor, bytes, error)
            : error_set(error, ERROR_MACHINE, "the memory of the picture cannot be reached: %s", strerror(EMFILE));
    if (!attached) { /* the supervisor has begun the picture */
        note(link, channel_send(&link->channel, FRAME_ABANDON, NULL, 0, -1));
        return false;
    }
    film_place(film, link->memory.block, request->width, request->height, request->record);
    film_place_layers(film, link->memory.block, request->layers);
    return true;
}

static bool link_news(void *context, const struct studio_news *news, struct studio_order *order, struct error *error) {
    struct child_link *link = context;
    struct frame frame;
    if (!channel_send(&link->channel, FRAME_NEWS, news, sizeof *news, -1) ||
        channel_receive(&link->channel, &frame) != CHANNEL_FRAME || frame.kind != FRAME_ORDER)
        return nobody_there(link, error);
    *order = frame.body.order;
    return true;
}

static void link_abandon(void *context) {
    struct child_link *link = context;
    share_destroy(&link->memory);
    note(link, channel_send(&link->channel, FRAME_ABANDON, NULL, 0, -1));
}

static bool link_done(void *context, const struct picture_report *report, struct error *error) {
    struct child_link *link = context;
    struct frame frame;
    share_destroy(&link->memory);
    if (!channel_send(&link->channel, FRAME_DONE, report, sizeof *report, -1) ||
        channel_receive(&link->channel, &frame) != CHANNEL_FRAME || frame.kind != FRAME_ANSWER)
        return nobody_there(link, error);
    if (!frame.body.answer.ok)
        *error = frame.body.answer.error;
    return frame.body.answer.ok;
}

static void link_line(void *context, enum line_kind kind, const char *text) {
    struct child_link *link = context;
    bool sent = channel_send_line(&link->channel, kind, text);
    if (sent)
        error_stream_note_sent(link->stream);
    note(link, sent);
}

static void link_script_ended(void *context, int index, int status) {
    struct child_link *link = context;
    struct frame_script script = {index, status};
    /* A script that ended because the channel did not work has not ended by itself. */
    if (!link->broken)
        note(link, channel_send(&link->channel, FRAME_SCRIPT, &script, sizeof script, -1));
}

static void link_read(void *context, const char *path, const struct file_version *version, bool written) {
    struct child_link *link = context;
    struct frame_read read = {.version = *version, .written = written};
    size_t length = strlen(path);
    if (length < sizeof read.path) /* else its identity is enough */
        memcpy(read.path, path, length);
    note(link, channel_send(&link->channel, FRAME_READ, &read, sizeof read, -1));
}

static bool link_again(void *context) {
    struct child_link *link = context;
    struct frame frame;
    return channel_send(&link->channel, FRAME_AGAIN, NULL, 0, -1) &&
           channel_receive(&link->channel, &frame) == CHANNEL_FRAME && frame.kind == FRAME_ANSWER &&
           frame.body.answer.ok;
}

struct child_services child_link_services(struct child_link *link, struct control *control) {
    link->stream = &control->error_stream;
    return (struct child_services){.context = link,
                                   .control = control,
                                   .begin = link_begin,
                                   .news = link_news,
                                   .abandon = link_abandon,
                                   .done = link_done,
                                   .line = link_line,
                                   .script_ended = link_script_ended,
                                   .read = link_read,
                                   .again = link_again};
}

void child_link_close(struct child_link *link) {
    share_destroy(&link->memory);
    channel_close(&link->channel);
}
