/* Edits of the window, as calls. */
#ifndef GRAY_SCRIPT_GR_CHANGES_INTERNAL_H
#define GRAY_SCRIPT_GR_CHANGES_INTERNAL_H

#include "scene/change.h"
#include "script/script.h"

struct changed_view;
struct script_context;

/* The changes that a script has made, in order; in sandbox.keep. */
struct script_changes {
    struct change *list;
    uint32_t count, room, added, owned;
    struct changed_view *views; /* the newest first */
    bool reported;              /* warnings that were omitted */
};

/* The changes by gr.change_... are applied to the scene before a picture is rendered, and undone after it. */
bool changes_begin(struct script_context *context, struct render_request *request, struct changed_scene *changed,
                   struct error *error);

#endif
