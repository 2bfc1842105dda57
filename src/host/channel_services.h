/* What the child asks of the supervisor, said over the channel. */
#ifndef GRAY_HOST_CHANNEL_SERVICES_H
#define GRAY_HOST_CHANNEL_SERVICES_H

#include "base/share.h"
#include "session/channel.h"
#include "session/services.h"

struct child_link {
    struct error_stream *stream; /* of the control that child_link_services got */
    struct channel channel;      /* to the supervisor */
    struct share memory;         /* the film of the picture being made */
    bool broken;                 /* a message was not delivered: this process is of no use any more */
};

/* The services point to `link`, which must stay where it is. */
struct child_services child_link_services(struct child_link *link, struct control *control);
void child_link_close(struct child_link *link);

#endif
