/* The services of the supervisor over the channel. */
#ifndef GRAY_HOST_CHANNEL_SERVICES_H
#define GRAY_HOST_CHANNEL_SERVICES_H

#include "base/share.h"
#include "session/messages.h"
#include "session/services.h"

struct channel_services {
    struct error_stream *stream; /* of the control that channel_services_make got */
    struct channel channel;      /* to the supervisor */
    struct share memory;         /* the film of the picture being made */
    bool broken;                 /* a message was not delivered: this process is of no use any more */
};

/* The services point to `link`, which must stay where it is. */
struct host_services channel_services_make(struct channel_services *link, struct control *control);
void channel_services_close(struct channel_services *link);

#endif
