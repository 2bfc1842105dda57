/* Picking: the first hit of the ray through a point of the picture, and its node. */
#ifndef GRAY_INSPECT_PICK_H
#define GRAY_INSPECT_PICK_H

#include "session/messages.h"
#include "world/path.h"

/* A name cut to this size; control characters become '?'. */
void pick_copy_name(char out[PICK_NAME], const char *text);

/* A number for a route to a node: it distinguishes the routes to a node with several parents. */
uint64_t route_hash(const struct scene_step *steps, uint32_t depth);

struct pick_query {
    double x, y; /* pixels of the whole picture */
    int32_t up;  /* levels above the node that is hit; if negative, levels of operands below it, in a combined solid */
};
/* What the ray through a pixel hits, with the camera of the job as it is at time 0. False: no memory, or no such
 * camera. */
bool pick_at(const struct render_job *job, const struct node *root, struct pick_query query, struct picked *out,
             struct error *error);

#endif
