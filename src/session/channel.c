/* Messages over SOCK_SEQPACKET: the kernel keeps one send as one receive, so a message is never read in part and
 * threads may send without a lock. A received message is used only after message_is_valid. */
#define _GNU_SOURCE
#include "session/channel.h"

#include "base/fault.h"
#include <errno.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

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
    /* Where this process has no descriptor left, that of a film is lost; whoever needs it sees that. */
    bool lost = (packet.msg_flags & MSG_CTRUNC) != 0;
    bool sound = (size_t)got >= sizeof word && (packet.msg_flags & MSG_TRUNC) == 0 &&
                 (!lost || (message->kind == MESSAGE_FILM && message->descriptor < 0)) && message_is_valid(message) &&
                 (message->descriptor < 0 || message->kind == MESSAGE_FILM);
    if (sound)
        return CHANNEL_MESSAGE;
    if (message->descriptor >= 0)
        (void)close(message->descriptor);
    message->descriptor = -1;
    return CHANNEL_BROKEN;
}
