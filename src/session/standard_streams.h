/* Standard output and standard error of the supervisor. A reader that stopped reading must not keep it from its
 * signals: a write waits until the stream takes something, or until a signal that ends the run is pending. */
#ifndef GRAY_SESSION_STANDARD_STREAMS_H
#define GRAY_SESSION_STANDARD_STREAMS_H

#include <stdbool.h>
#include <stdio.h>

struct standard_stream {
    int descriptor;
    bool waits;        /* a pipe, a terminal or the like */
    bool given_up;     /* the run was ended while this stream waited; nothing more is written */
    const bool *ended; /* standard_streams.ended */
};
/* Zero value: not begun. */
struct standard_streams {
    struct standard_stream out, err;
    bool ended;      /* set when the signal has been read: from then on a stream that takes nothing is given up soon */
    FILE *before[2]; /* stdout and stderr as they were */
};

/* From now on stdout and stderr write so. SIGINT, SIGTERM and SIGHUP must be blocked. The struct must stay until
 * standard_streams_end. Without memory nothing changes. */
void standard_streams_begin(struct standard_streams *streams);
/* Writes what is buffered, and puts the streams back. Also for the process that fork has made. */
void standard_streams_end(struct standard_streams *streams);

#endif
