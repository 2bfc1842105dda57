/* Nothing that comes from the render process is used before message_is_valid has checked it. The film of a picture in a
 * window is followed in its memory by the layers, and these by the overlay: lines, four floats a pixel, and the
 * outline, a byte. */
#define _GNU_SOURCE
#include "session/messages.h"

#include "base/fault.h"
#include "film/aov.h"
#include "settings/setting.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

static bool ends_with_zero(const char *text, size_t size) {
    return memchr(text, '\0', size) != NULL;
}

static bool shown_is_valid(const struct picture_request *request) {
    const struct film_rectangle *shown = &request->shown;
    return shown->x0 >= request->x0 && shown->x1 > shown->x0 && shown->x1 <= request->x0 + request->width &&
           shown->y0 >= request->y0 && shown->y1 > shown->y0 && shown->y1 <= request->y0 + request->height;
}

static bool frame_is_valid(const struct frame *frame) {
    return frame->number == 0 || (frame->number <= frame->count && frame->count <= FRAMES_MAX &&
                                  frame->rate >= FRAME_RATE_MIN && frame->rate <= FRAME_RATE_MAX);
}

static bool settings_fit(const struct picture_request *request) {
    bool fine = settings_are_valid(&request->settings);
    for (int i = 0; i < TONE_ENTRIES && fine && request->settings.tone.curve == TONE_FUNCTION; i++)
        fine = isfinite(request->tone_table.values[i]);
    return fine;
}

bool message_is_valid(const struct message *message) {
    size_t before_text = offsetof(struct message_line, text);
    const struct picture_request *request = &message->body.request;
    /* The size of a body is that of its kind; what is used as an index, a size or a text is checked, too. */
    switch (message->kind) {
    case MESSAGE_LINE:
        return message->size > before_text && message->size <= sizeof message->body.line &&
               (unsigned)message->body.line.kind <= LINE_OUTPUT &&
               ends_with_zero(message->body.line.text, message->size - before_text);
    case MESSAGE_BEGIN:
        return message->size == sizeof *request && ends_with_zero(request->file, sizeof request->file) &&
               request->width >= 1 && request->height >= 1 && request->full_width <= 1u << 20 &&
               request->full_height <= 1u << 20 && request->width <= request->full_width &&
               request->height <= request->full_height && request->x0 <= request->full_width - request->width &&
               request->y0 <= request->full_height - request->height && shown_is_valid(request) &&
               settings_fit(request) && frame_is_valid(&request->frame) && film_record_valid(request->record);
    case MESSAGE_DONE:
        return message->size == sizeof message->body.report;
    case MESSAGE_PREVIEW_REPLY:
    case MESSAGE_PREVIEW_COMMAND:
    case MESSAGE_WINDOW:
        return message->size <= sizeof message->body.bytes;
    case MESSAGE_MODEL:
        return message->size == sizeof message->body.model && message->body.model.role <= MODEL_SCENE &&
               ends_with_zero(message->body.model.file, sizeof message->body.model.file);
    case MESSAGE_DEVICE:
        return message->size == sizeof message->body.device && message->body.device.slots >= 1 &&
               message->body.device.slots <= DEVICE_SLOTS && message->body.device.room <= DEVICE_ROOM &&
               message->body.device.size <= SIZE_MAX / 2;
    case MESSAGE_MODEL_WRITE:
    case MESSAGE_MODEL_END:
    case MESSAGE_ABANDON:
    case MESSAGE_FRAME:
    case MESSAGE_AGAIN:
        return message->size == 0;
    case MESSAGE_READ:
        return message->size == sizeof message->body.read &&
               ends_with_zero(message->body.read.path, sizeof message->body.read.path);
    case MESSAGE_SCRIPT:
        return message->size == sizeof message->body.script;
    case MESSAGE_FILM:
    case MESSAGE_ANSWER:
        return message->size == sizeof message->body.answer &&
               ends_with_zero(message->body.answer.error.text, sizeof message->body.answer.error.text);
    }
    return false;
}

struct tone picture_tone(const struct picture_request *request) {
    struct tone tone = request->settings.tone;
    tone.table = tone.curve == TONE_FUNCTION ? &request->tone_table : NULL;
    return tone;
}

bool picture_request_enlarge(const struct picture_request *request, uint32_t width, uint32_t height,
                             struct picture_request *out) {
    double across = (double)width / request->width, down = (double)height / request->height;
    double full_width = floor(across * request->full_width + 0.5),
           full_height = floor(down * request->full_height + 0.5);
    *out = *request;
    if (width < request->width || height < request->height || full_width > 1 << 20 || full_height > 1 << 20)
        return false;
    out->width = width;
    out->height = height;
    out->full_width = (uint32_t)full_width;
    out->full_height = (uint32_t)full_height;
    out->x0 = (uint32_t)math_min(floor(across * request->x0 + 0.5), full_width - width);
    out->y0 = (uint32_t)math_min(floor(down * request->y0 + 0.5), full_height - height);
    out->shown = (struct film_rectangle){out->x0, out->y0, out->x0 + width, out->y0 + height};
    out->layers = out->in_window = 0;
    return true;
}

/* Room for both parts of the overlay. */
enum { OVERLAY_LAYERS = 2 };

bool picture_film_size(const struct picture_request *request, size_t *bytes, struct error *error) {
    uint32_t layers = aov_layers(request->layers & AOV_ALL) + (request->in_window ? OVERLAY_LAYERS : 0);
    return film_size_layered(request->width, request->height, request->record, layers, bytes, error);
}

void picture_film_layout(const struct picture_request *request, void *block, struct film *film) {
    film_layout(film, block, request->width, request->height, request->record);
    film_layout_layers(film, block, request->layers & AOV_ALL);
    film->x0 = request->x0;
    film->y0 = request->y0;
    film->full_width = request->full_width;
    film->full_height = request->full_height;
}

/* Messages over SOCK_SEQPACKET: the kernel delivers each send as one receive, so a message is never read in part, and
 * threads may send without a lock. A received message is used only after message_is_valid. */

bool channel_pair(struct channel ends[2], struct error *error) {
    int descriptors[2];
    if (MAY_FAIL(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, descriptors)) != 0)
        return error_set(error, ERROR_MACHINE, "gray: the render process cannot be reached: %s", strerror(errno));
    ends[0].descriptor = descriptors[0];
    ends[1].descriptor = descriptors[1];
    return true;
}

void channel_close(struct channel *channel) {
    if (channel->descriptor >= 0)
        (void)close(channel->descriptor);
    channel->descriptor = -1;
}

/* A descriptor travels in a control message; the union gives it the alignment it needs. */
union control_space {
    struct cmsghdr header;
    char bytes[CMSG_SPACE(sizeof(int))];
};

bool channel_send(struct channel *channel, enum message_kind kind, const void *body, size_t size, int descriptor) {
    uint32_t word = (uint32_t)kind;
    struct iovec parts[2] = {{&word, sizeof word}, {(void *)(uintptr_t)body, size}};
    struct msghdr packet = {.msg_iov = parts, .msg_iovlen = size > 0 ? 2 : 1};
    union control_space control;
    memset(&control, 0, sizeof control);
    if (descriptor >= 0) {
        packet.msg_control = &control;
        packet.msg_controllen = sizeof control.bytes;
        struct cmsghdr *header = CMSG_FIRSTHDR(&packet);
        header->cmsg_level = SOL_SOCKET;
        header->cmsg_type = SCM_RIGHTS;
        header->cmsg_len = CMSG_LEN(sizeof(int));
        memcpy(CMSG_DATA(header), &descriptor, sizeof descriptor);
    }
    ssize_t sent;
    do {
        sent = MAY_FAIL(sendmsg(channel->descriptor, &packet, MSG_NOSIGNAL));
    } while (sent < 0 && errno == EINTR);
    return sent >= 0;
}

bool channel_send_line(struct channel *channel, enum line_kind kind, const char *text) {
    struct message_line line = {.kind = kind};
    size_t length = strlen(text);
    if (length >= sizeof line.text) {
        length = sizeof line.text - 1;
        memcpy(line.text, text, length);
        memcpy(line.text + length - 3, "...", 3);
    } else {
        memcpy(line.text, text, length);
    }
    return channel_send(channel, MESSAGE_LINE, &line, offsetof(struct message_line, text) + length + 1, -1);
}

enum channel_result channel_receive(struct channel *channel, struct message *message) {
    uint32_t word = 0;
    struct iovec parts[2] = {{&word, sizeof word}, {&message->body, sizeof message->body}};
    union control_space control;
    struct msghdr packet = {
        .msg_iov = parts, .msg_iovlen = 2, .msg_control = &control, .msg_controllen = sizeof control.bytes};
    ssize_t got;
    do {
        got = MAY_FAIL(recvmsg(channel->descriptor, &packet, MSG_CMSG_CLOEXEC));
    } while (got < 0 && errno == EINTR);
    message->descriptor = -1;
    if (got <= 0)
        return CHANNEL_END;
    struct cmsghdr *header = CMSG_FIRSTHDR(&packet);
    if (header && header->cmsg_level == SOL_SOCKET && header->cmsg_type == SCM_RIGHTS)
        memcpy(&message->descriptor, CMSG_DATA(header), sizeof message->descriptor);
    message->kind = (enum message_kind)word;
    message->size = (size_t)got - sizeof word;
    /* If this process has no free descriptor, that of a film is lost; the code that needs it checks this. */
    bool lost = (packet.msg_flags & MSG_CTRUNC) != 0;
    bool sound = (size_t)got >= sizeof word && (packet.msg_flags & MSG_TRUNC) == 0 &&
                 (!lost || (message->kind == MESSAGE_FILM && message->descriptor < 0)) && message_is_valid(message) &&
                 (message->descriptor < 0 || message->kind == MESSAGE_FILM ||
                  message->kind == MESSAGE_PREVIEW_COMMAND || message->kind == MESSAGE_WINDOW);
    if (sound)
        return CHANNEL_MESSAGE;
    if (message->descriptor >= 0)
        (void)close(message->descriptor);
    message->descriptor = -1;
    return CHANNEL_BROKEN;
}
