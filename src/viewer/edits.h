/* Edits made in a window: steps, each with its inverse, that can be undone and made again, and the changes that hold
 * now. Knows no window and no scene. */
#ifndef GRAY_VIEWER_EDITS_H
#define GRAY_VIEWER_EDITS_H

#include "render/settings.h"
#include "scene/change.h"

struct edit {
    struct change before, after; /* of the same target */
    bool had, has;               /* there was one before; there is one after */
};

/* Zero value: nothing was changed. Owner: the caller; edits_destroy gives it back. */
struct edits {
    struct edit *steps;
    uint32_t count, at, room; /* steps at .. count - 1 were undone */
    struct change_list now;
};

/* Makes a change (or, with `present` false, takes it back): one more step, what was undone is forgotten. join: it is
 * part of the last step if that has the same target (a thing that is dragged). False: no memory, or too many. */
bool edits_make(struct edits *edits, const struct change *change, bool present, bool join);
/* *target: what is different now. False: there is nothing to undo, or to make again. */
bool edits_undo(struct edits *edits, struct change *target);
bool edits_redo(struct edits *edits, struct change *target);
void edits_destroy(struct edits *edits);

/* What a Lua file must say to give a picture these changes: calls of gr.change_... with every digit. `put` is given
 * line after line. camera, exposure: NULL where the script's own hold. False: put said so. */
bool edits_write_lua(const struct change_list *changes, const char *picture, const struct camera *camera,
                     const double *exposure, bool (*put)(void *context, const char *line), void *context);

#endif
