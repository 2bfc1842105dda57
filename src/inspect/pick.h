/* What stands at a place of the picture: the first thing on the way through it, and which node that belongs to. */
#ifndef GRAY_INSPECT_PICK_H
#define GRAY_INSPECT_PICK_H

#include "session/messages.h"
#include "world/path.h"

/* A name cut to this size; control characters become '?'. */
void pick_words(char out[PICK_NAME], const char *text);

/* A number for a way to a node, so that of a node under several parents one can be told. */
uint64_t route_hash(const struct scene_step *steps, uint32_t depth);

/* The ray through (x, y) of the whole picture, in pixels, with the camera of the job as it is at time 0. up: so many
 * nodes above the one that was hit; below 0: so many operands below it, if it is a combined solid. False: no memory, or
 * no such camera. */
bool pick_at(const struct render_job *job, const struct node *root, double x, double y, int32_t up, struct picked *out,
             struct error *error);

#endif
