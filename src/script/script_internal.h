/* One run of a script. */
#ifndef GRAY_SCRIPT_SCRIPT_INTERNAL_H
#define GRAY_SCRIPT_SCRIPT_INTERNAL_H

#include "call/context.h"
#include "script/gr_changes_internal.h"
#include "script/gr_frames_internal.h"
#include "script/script.h"

struct script {
    struct script_context context; /* the first member: Lua's extra space points to both */
    const struct script_host *host;
    struct arena *out; /* the caller's arena, for the traceback */
    const char *traceback;
    struct error failure;                       /* the message of a script error, made by the message handler */
    bool only_named_pictures, several_pictures; /* struct order_finding */
    bool studio_noticed;
    bool is_json; /* the scene is no script */
    struct scene_reader *reader; /* of a scene in JSON, while it is read */
    double time; /* of the picture, in seconds since the first frame; of frames it is that of the frame */
    struct node *fitted; /* what a camera without a place shows; NULL: the picture's node */
    uint32_t pictures; /* that gr.render has made */
    uint32_t unnamed;  /* pictures without a file name so far */
    struct script_changes changes;
    struct script_animation animation;
    struct script_model *models; /* the nodes of files, the newest first (gr_model.c) */
};

static inline struct script *script_of(const struct script_context *context) {
    return (struct script *)(uintptr_t)context;
}

/* Opens a fresh Lua state for a scene. May raise. */
void script_open(lua_State *L);

#endif
