/* Edits made in a window: steps, each with its inverse, that can be undone and redone, and the current changes.
 * Independent of window and scene. */
#ifndef GRAY_SCENE_EDITS_H
#define GRAY_SCENE_EDITS_H

#include "scene/change.h"
#include "settings/settings.h"

struct edit {
    struct change before, after; /* of the same target */
    bool had, has;               /* whether a change existed before the step, and whether after it */
};

/* Zero value: no changes. Owner: the caller; edits_destroy releases it. */
struct edits {
    struct edit *steps;
    uint32_t count, at, room; /* steps at .. count - 1 were undone */
    struct change_list now;
};

/* Makes a change (or, with `present` false, removes it): adds a step and deletes undone steps. join: it becomes part of
 * the last step if that has the same target (while the user drags something). False: no memory, or too many. */
bool edits_make(struct edits *edits, const struct change *change, bool present, bool join);
/* *target: what has changed. False: there is nothing to undo, or to redo. */
bool edits_undo(struct edits *edits, struct change *target);
bool edits_redo(struct edits *edits, struct change *target);
/* Whether the steps between two moments, now and when steps.at was `from`, have changed what would be written. */
bool edits_differ(const struct edits *edits, uint32_t from);
void edits_destroy(struct edits *edits);

/* Writes the Lua calls of gr.change_... that give a picture these changes, with every digit. `put` receives each line.
 * camera, exposure: NULL for those of the script. False: put returned false. */
bool edits_write_lua(const struct change_list *changes, const char *picture, const struct camera *camera,
                     const double *exposure, bool (*put)(void *context, const char *line), void *context);

#endif
