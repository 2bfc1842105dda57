/* Each request is a message, and its answer if it has one. When the supervisor cannot be reached, every request
 * fails as "cancelled", which ends the scripts. */
#include "host/channel_services.h"

#include "device/device_link.h"
#include "formats/list.h"
#include "preview/preview_messages.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

static bool nobody_there(struct channel_services *link, struct error *error) {
    link->broken = true;
    return error_set(error, ERROR_CANCELLED, "the supervising process is gone");
}

static void note(struct channel_services *link, bool sent) {
    link->broken = link->broken || !sent;
}

static bool link_begin(void *context, const struct picture_request *request, struct film *film, bool *already,
                       struct error *error) {
    struct channel_services *link = context;
    struct message message;
    size_t bytes;
    if (!picture_film_size(request, &bytes, error))
        return false;
    if (!channel_send(&link->channel, MESSAGE_BEGIN, request, sizeof *request, -1) ||
        channel_receive(&link->channel, &message) != CHANNEL_MESSAGE || message.kind != MESSAGE_FILM)
        return nobody_there(link, error);
    if (!message.body.answer.ok) {
        *error = message.body.answer.error;
        return false;
    }
    *already = message.body.answer.already;
    if (request->check || *already)
        return true;
    bool attached =
        message.descriptor >= 0
            ? share_attach(&link->memory, message.descriptor, bytes, error)
            : error_set(error, ERROR_MACHINE, "the memory of the picture cannot be reached: %s", strerror(EMFILE));
    if (!attached) { /* the supervisor has started the picture */
        note(link, channel_send(&link->channel, MESSAGE_ABANDON, NULL, 0, -1));
        return false;
    }
    picture_film_layout(request, link->memory.block, film);
    link->request = *request;
    return true;
}

/* The memory of a larger pass comes with its command. It stays mapped until the next such memory comes. */
static bool attach_large(struct channel_services *link, int descriptor, struct preview_command *command,
                         struct error *error) {
    struct picture_request request;
    size_t bytes;
    command->block = NULL;
    if (descriptor < 0 && command->view.width == 0)
        return true;
    share_destroy(&link->large);
    if (!picture_request_enlarge(&link->request, command->view.width, command->view.height, &request) ||
        !picture_film_size(&request, &bytes, error) || descriptor < 0) {
        if (descriptor >= 0)
            (void)close(descriptor);
        return nobody_there(link, error);
    }
    if (!share_attach(&link->large, descriptor, bytes, error))
        return false;
    command->block = link->large.block;
    return true;
}

static bool link_reply(void *context, const struct preview_reply *reply, struct preview_command *command,
                       struct error *error) {
    struct channel_services *link = context;
    struct message message;
    if (!channel_send(&link->channel, MESSAGE_PREVIEW_REPLY, reply, sizeof *reply, -1) ||
        channel_receive(&link->channel, &message) != CHANNEL_MESSAGE || !preview_command_read(&message, command))
        return nobody_there(link, error);
    return attach_large(link, message.descriptor, command, error);
}

static void link_abandon(void *context) {
    struct channel_services *link = context;
    share_destroy(&link->memory);
    share_destroy(&link->large);
    note(link, channel_send(&link->channel, MESSAGE_ABANDON, NULL, 0, -1));
}

static void link_wait(void *context) {
    struct channel_services *link = context;
    struct message message;
    if (!link->unanswered)
        return;
    link->unanswered = false;
    if (channel_receive(&link->channel, &message) != CHANNEL_MESSAGE || message.kind != MESSAGE_ANSWER) {
        link->failed = !nobody_there(link, &link->failure);
    } else if (!message.body.answer.ok) {
        link->failed = true;
        link->failure = message.body.answer.error;
    }
}

static bool link_settle(void *context, struct error *error) {
    struct channel_services *link = context;
    link_wait(link);
    if (!link->failed)
        return true;
    link->failed = false;
    *error = link->failure;
    return false;
}

static bool link_done(void *context, const struct picture_report *report, bool early, struct error *error) {
    struct channel_services *link = context;
    share_destroy(&link->memory);
    share_destroy(&link->large);
    if (!channel_send(&link->channel, MESSAGE_DONE, report, sizeof *report, -1))
        return nobody_there(link, error);
    link->unanswered = true;
    return early || link_settle(link, error);
}

/* Sends a request for a model, and receives the answer. */
static bool ask_for_model(struct channel_services *link, const struct model_request *request, struct message *message,
                          struct error *error) {
    link_wait(link);
    if (!channel_send(&link->channel, MESSAGE_MODEL, request, sizeof *request, -1) ||
        channel_receive(&link->channel, message) != CHANNEL_MESSAGE || message->kind != MESSAGE_FILM)
        return nobody_there(link, error);
    if (!message->body.answer.ok)
        *error = message->body.answer.error;
    return message->body.answer.ok;
}

static bool link_solution(void *context, const struct model_request *request, struct list *bytes, struct error *error) {
    struct message message;
    struct share memory;
    if (!ask_for_model(context, request, &message, error))
        return false;
    if (message.descriptor < 0)
        return true;
    if (!share_attach(&memory, message.descriptor, 0, error))
        return false;
    bool ok = list_add_bytes(bytes, memory.block, memory.size) || error_no_memory(error, "radiosity");
    share_destroy(&memory);
    return ok;
}

static bool link_model(void *context, const struct model_request *request, const void *bytes, struct error *error) {
    struct channel_services *link = context;
    struct message message;
    struct share memory;
    if (!ask_for_model(link, request, &message, error))
        return false;
    if (!bytes)
        return true;
    if (message.descriptor < 0)
        return error_set(error, ERROR_MACHINE, "the memory of the model cannot be reached: %s", strerror(EMFILE));
    if (!share_attach(&memory, message.descriptor, request->size, error))
        return false;
    memcpy(memory.block, bytes, request->size);
    share_destroy(&memory);
    if (!channel_send(&link->channel, MESSAGE_MODEL_WRITE, NULL, 0, -1) ||
        channel_receive(&link->channel, &message) != CHANNEL_MESSAGE || message.kind != MESSAGE_ANSWER)
        return nobody_there(link, error);
    if (!message.body.answer.ok)
        *error = message.body.answer.error;
    return message.body.answer.ok;
}

static void link_model_end(void *context) {
    struct channel_services *link = context;
    note(link, channel_send(&link->channel, MESSAGE_MODEL_END, NULL, 0, -1));
}

/* Asks for memory; its descriptor, or -1. */
static int ask_for_device(struct channel_services *link, struct device_request request, struct error *error) {
    struct message message;
    if (!channel_send(&link->channel, MESSAGE_DEVICE, &request, sizeof request, -1) ||
        channel_receive(&link->channel, &message) != CHANNEL_MESSAGE || message.kind != MESSAGE_FILM) {
        (void)nobody_there(link, error);
        return -1;
    }
    if (!message.body.answer.ok)
        *error = message.body.answer.error;
    else if (message.descriptor < 0)
        (void)error_set(error, ERROR_MACHINE, "the memory of a device cannot be reached: %s", strerror(EMFILE));
    return message.body.answer.ok ? message.descriptor : -1;
}

static bool link_device(void *context, const struct bundle *scene, uint32_t slots, uint32_t room, struct share *orders,
                        struct error *error) {
    struct channel_services *link = context;
    struct share memory;
    int descriptor = ask_for_device(link, (struct device_request){bundle_size(scene), slots, room}, error);
    if (descriptor < 0 || !share_attach(&memory, descriptor, bundle_size(scene), error))
        return false;
    bundle_write(scene, memory.block);
    share_destroy(&memory);
    descriptor = ask_for_device(link, (struct device_request){0, slots, room}, error);
    return descriptor >= 0 &&
           share_attach(orders, descriptor, device_link_size((struct device_slots){slots, room}), error);
}

static void link_line(void *context, enum line_kind kind, const char *text) {
    struct channel_services *link = context;
    bool sent = channel_send_line(&link->channel, kind, text);
    if (sent)
        error_stream_note_sent(link->stream);
    note(link, sent);
}

static void link_script_ended(void *context, int index, int status) {
    struct channel_services *link = context;
    struct message_script script = {index, status};
    /* A script that ended because the channel failed did not end normally. */
    if (!link->broken)
        note(link, channel_send(&link->channel, MESSAGE_SCRIPT, &script, sizeof script, -1));
}

static void link_read(void *context, const char *path, const struct file_version *version, bool written) {
    struct channel_services *link = context;
    struct message_read read = {.version = *version, .written = written};
    size_t length = strlen(path);
    if (length < sizeof read.path) /* else its identity is enough */
        memcpy(read.path, path, length);
    note(link, channel_send(&link->channel, MESSAGE_READ, &read, sizeof read, -1));
}

static void link_frame(void *context) {
    struct channel_services *link = context;
    note(link, channel_send(&link->channel, MESSAGE_FRAME, NULL, 0, -1));
}

static bool link_again(void *context) {
    struct channel_services *link = context;
    struct message message;
    return channel_send(&link->channel, MESSAGE_AGAIN, NULL, 0, -1) &&
           channel_receive(&link->channel, &message) == CHANNEL_MESSAGE && message.kind == MESSAGE_ANSWER &&
           message.body.answer.ok;
}

struct host_services channel_services_make(struct channel_services *link, struct control *control) {
    link->stream = &control->error_stream;
    return (struct host_services){.context = link,
                                  .control = control,
                                  .begin = link_begin,
                                  .reply = link_reply,
                                  .abandon = link_abandon,
                                  .done = link_done,
                                  .wait = link_wait,
                                  .settle = link_settle,
                                  .model = link_model,
                                  .model_end = link_model_end,
                                  .solution = link_solution,
                                  .device = link_device,
                                  .line = link_line,
                                  .script_ended = link_script_ended,
                                  .read = link_read,
                                  .frame = link_frame,
                                  .again = link_again};
}

void channel_services_close(struct channel_services *link) {
    share_destroy(&link->memory);
    share_destroy(&link->large);
    channel_close(&link->channel);
}
