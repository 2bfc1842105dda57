/* Memory that supervisor and render process share from the fork on, for data that changes too often or is too urgent
 * for the channel. The supervisor uses what it reads here for display only. */
#ifndef GRAY_SESSION_CONTROL_H
#define GRAY_SESSION_CONTROL_H

#include "base/pool.h"
#include "render/time_estimate.h"
#include "session/standard_streams.h"

#include <stdatomic.h>
#include <stdint.h>

/* In a farm tiles are distributed while the picture is rendered; the picture ends at HANDOUT_CLOSED. */
enum handout { HANDOUT_NONE, HANDOUT_OPEN, HANDOUT_CLOSED };

enum cancel { CANCEL_NOTHING, CANCEL_ALL /* cancel the picture, end the script */, CANCEL_PASS /* of a window */ };

enum { FRAMES_OVER = INT32_MAX };

struct control {
    _Atomic int cancel;                         /* an enum cancel, set by the supervisor */
    _Atomic uint32_t tiles_done;                /* of the picture being made */
    _Atomic uint32_t tiles;                     /* 0 until its scene is built */
    _Atomic uint32_t handout;                   /* an enum handout */
    struct pool_event handed;                   /* signalled when tiles are handed out, and at HANDOUT_CLOSED */
    _Atomic int drain;                          /* not 0: finish the started tiles, begin no others */
    struct progress_estimate progress_estimate; /* the progress of the picture, if requested */
    _Atomic uint32_t next_frame; /* that the window wants of an animation; 0: the first one, or FRAMES_OVER */
    _Atomic uint32_t build_step; /* of building the world, from 1; 0: it is built */
    _Atomic uint32_t build_done; /* thousandths of that step */
    _Atomic float unshot;        /* share of the light of radiosity that is not yet shot; 0: none is computed */
    _Atomic uint32_t lost;       /* not 0: the render process could not write all of its standard output */
    struct error_stream error_stream;
};

#endif
