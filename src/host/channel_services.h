/* The services of the supervisor over the channel. */
#ifndef GRAY_HOST_CHANNEL_SERVICES_H
#define GRAY_HOST_CHANNEL_SERVICES_H

#include "base/share.h"
#include "session/messages.h"
#include "session/services.h"

struct channel_services {
    struct error_stream *stream; /* of the control passed to channel_services_make */
    struct channel channel;      /* to the supervisor */
    struct share memory;         /* the film of the current picture */
    struct share large;          /* that of a larger pass */
    struct picture_request request;
    bool broken;     /* a message was not delivered: this process must end */
    bool unanswered; /* MESSAGE_DONE is sent, its answer is not yet received */
    bool failed;     /* the last picture could not be written: `failure`, not yet reported */
    struct error failure;
};

/* The services point to `link`, which must not move. */
struct host_services channel_services_make(struct channel_services *link, struct control *control);
void channel_services_close(struct channel_services *link);

#endif
