/* The channel between supervisor and render process: a pair of sockets that keep the boundaries of messages. A message
 * is a kind and a body, whose size is fixed by the kind, or a text (messages.h). */
#ifndef GRAY_SESSION_CHANNEL_H
#define GRAY_SESSION_CHANNEL_H

#include "base/error.h"
#include "session/messages.h"

#include <stdbool.h>
#include <stddef.h>

struct channel {
    int descriptor;
};

/* Two ends of a new channel; both are closed on exec. */
bool channel_pair(struct channel ends[2], struct error *error);
void channel_close(struct channel *channel);

/* Blocks until the message is handed over; false when the other side is gone. descriptor: one to pass along, or -1. */
bool channel_send(struct channel *channel, enum message_kind kind, const void *body, size_t size, int descriptor);
bool channel_send_line(struct channel *channel, enum line_kind kind, const char *text);

enum channel_result { CHANNEL_MESSAGE, CHANNEL_END, CHANNEL_BROKEN };
/* Blocks for one message. END: the other side is gone. BROKEN: the message is not valid. */
enum channel_result channel_receive(struct channel *channel, struct message *message);

#endif
