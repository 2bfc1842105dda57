/* gr.frames, and the frame that is drawn. */
#ifndef GRAY_SCRIPT_GR_FRAMES_INTERNAL_H
#define GRAY_SCRIPT_GR_FRAMES_INTERNAL_H

#include "call/function.h"
#include "script/script.h"

#include <lua.h>

struct script_animation {
    struct frame frame;     /* the one that is drawn; number 0: none */
    struct shutter shutter; /* in frames: of gr.frames */
    bool runs;              /* in gr.frames */
};

/* Calls `draw` of gr.frames for its frames and renders them; may raise. */
int frames_run(lua_State *L, const struct script_result *result);
void frames_open(lua_State *L); /* gr.time, gr.clock and gr.frame */

#endif
