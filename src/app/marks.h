/* Marks: what lies over the picture in a window and is found by rays, so that only the child can make it: the lines of
 * --overlay, and which pixels show the node that is selected. The child leaves them in the memory of the film, behind
 * its layers, and says so with its news; the supervisor takes a copy before it sends another order. */
#ifndef GRAY_APP_MARKS_H
#define GRAY_APP_MARKS_H

#include "render/overlay.h"
#include "world/path.h"

struct picture_request;

/* Zero value: none. */
struct marks_wish {
    struct overlay_wish lines; /* none: OVERLAY_NONE */
    bool outline;              /* of the node with this serial ... */
    uint32_t serial;
    uint64_t way;   /* ... on this way, as marks_way tells it; 0: on all ways */
    uint64_t solid; /* of an operand: the way to the combined solid that it is in; else 0 */
};

struct marks {
    bool stopped; /* before they were complete */
    bool has_lines, has_outline;
    struct film_rectangle outline; /* of the film, from 0; outside of it nothing is of the node */
};

/* Where they are, for a picture in a window. */
struct marks_place {
    float (*lines)[4]; /* as overlay_lines makes them */
    uint8_t *shows;    /* by pixel: not 0 where the node is seen */
};

/* How many layers of three floats a pixel the memory of the film has, marks included. */
uint32_t marks_layers(const struct picture_request *request);
void marks_place(const struct picture_request *request, void *block, struct marks_place *place);

/* A number for a way to a node, so that of a node under several parents one can be told. */
uint64_t marks_way(const struct scene_step *steps, uint32_t depth);

/* Makes what is wished for, as the camera of the job sees it. False: no memory, or no such camera, or cancelled. */
bool marks_make(const struct render_job *job, const struct node *root, struct pool *pool, const struct marks_wish *wish,
                const struct marks_place *place, struct marks *marks, struct error *error);

#endif
