/* The messages of a window: commands of the supervisor, replies of the render process, and where the overlay is in the
 * memory of the film, which both map. */
#ifndef GRAY_PREVIEW_PREVIEW_MESSAGES_H
#define GRAY_PREVIEW_PREVIEW_MESSAGES_H

#include "inspect/pick.h"
#include "render/headlight.h"
#include "render/overlay.h"
#include "scene/change.h"
#include "session/messages.h"

/* Zero value: none. */
struct view_overlay_request {
    struct overlay_request lines; /* none: OVERLAY_NONE */
    bool outline;                 /* of the node with this serial ... */
    uint32_t serial;
    uint64_t route; /* ... on this route (route_hash); 0: on all routes */
    uint64_t solid; /* of an operand: the route to the combined solid that it is in; else 0 */
};

struct view_overlay {
    bool stopped; /* before they were complete */
    bool has_lines, has_outline;
    struct film_rectangle outline; /* of the film, from 0; outside it the node is not visible */
};

/* Their offsets, for a picture in a window. */
struct view_overlay_buffers {
    float (*lines)[4]; /* as overlay_lines makes them */
    uint8_t *shows;    /* by pixel: not 0 where the node is visible */
};

/* A point of a picture, by pixels of the whole, as a camera sees it. */
struct view_point {
    struct camera camera; /* its view a direction */
    bool own;             /* the camera of the script */
    double x, y;
};

/* A pass of a picture in a window. */
struct pass_view {
    struct camera camera;       /* its view a direction */
    double exposure;            /* stops: it decides which pixels are sampled again */
    uint32_t divide;            /* one pixel represents a square with this side; from 1 */
    bool plain;                 /* one sample a pixel, coarse soft light; or it walks: */
    bool walks;                 /* one sample of the integrator for each pixel, by a device, not denoised */
    bool headlight;             /* plain, and made by render_headlight ... */
    enum headlight_shows shows; /* ... which shows this */
    uint32_t samples;        /* not 0: so many for each pixel, with integrators that are progressive, then denoised */
    uint32_t kept;           /* samples of the pass before, which had all pixels: the pass goes on with the next */
    bool own;                /* the camera, lens and motion of the script */
    uint32_t width, height;  /* not 0: so many pixels in place of those of the picture, in the memory of the command */
    struct view_point patch; /* of HEADLIGHT_FACTORS: it is shown there */
};

/* Lights of a scene are reported in groups of this size. */
enum { LIGHTS_PER_MESSAGE = 32 };
struct light_info {
    uint32_t kind;       /* an enum light_kind, for its name */
    uint32_t properties; /* of enum light_property */
    bool has_position;   /* its position is known */
    struct vec3 position;
    struct colour colour;
    struct vec3 direction, edge1, edge2; /* as in struct light, zero if it has none */
    double radius, cos_outer;
    bool moves, turns, sizes; /* the possible edits */
};

enum preview_reply_kind {
    REPLY_BUILT /* the world, for the first time */,
    REPLY_PASS,
    REPLY_PICKED,
    REPLY_CHANGED,
    REPLY_PIXEL_TRACE,
    REPLY_LIGHTS,
    REPLY_OVERLAY,
    REPLY_NODES
};
/* The result of a command of the window; the render process waits for the next one. */
struct preview_reply {
    enum preview_reply_kind kind;
    struct picture_report report; /* of BUILT (its bounds) and PASS */
    struct picked picked;
    struct view_overlay overlay; /* of PASS, PICKED and OVERLAY: the parts that were requested and made */
    double built;                /* of BUILT: when, on clock_now */
    uint32_t added; /* of BUILT: nodes that the script has added by gr.change_add; of CHANGED: those there */
    uint32_t owned; /* of BUILT: materials of gr.change_own */
    uint32_t root;  /* of BUILT: the serial of the root, and the space of its children */
    char root_name[PICK_NAME];
    struct affine world_from_root;
    uint32_t light_count; /* of BUILT, CHANGED and LIGHTS: all of them; those reported begin with first_light, from 0 */
    uint32_t first_light;
    struct node_rows nodes; /* of NODES */
    struct light_info lights[LIGHTS_PER_MESSAGE];
    char text[512]; /* of CHANGED: why an edit failed, or empty */
    bool walks;     /* passes that walk are quick enough now */
    bool unbuilt;   /* of CHANGED: the building of the world was stopped; the next pass starts it again */
};

enum preview_command_kind {
    COMMAND_END,
    COMMAND_PASS,
    COMMAND_PICK,
    COMMAND_CHANGE,
    COMMAND_PIXEL_TRACE,
    COMMAND_LIGHTS,
    COMMAND_OVERLAY,
    COMMAND_NODES
};
struct preview_command {
    enum preview_command_kind kind;
    bool quit;             /* of END: the window was closed */
    struct pass_view view; /* of PASS, PICK, PIXEL_TRACE and OVERLAY */
    struct view_overlay_request
        overlay;            /* of PASS: made after it; of OVERLAY. After PICK the outline is that of the picked node */
    double x, y;            /* of PICK and PIXEL_TRACE: pixels of the whole picture */
    int32_t up;             /* of PICK: nodes above the one that is hit, or operands below it */
    bool probes;            /* of PICK: only where the object is; no outline */
    bool by_node;           /* of PICK: not at x, y, but this node */
    struct node_query node; /* of PICK; of NODES: whose children */
    uint32_t first_light;   /* of CHANGE and LIGHTS: report lights from this one on, counted from 0 */
    struct change change;
    bool present; /* of CHANGE: it is applied; else it is undone */
    bool more;    /* of CHANGE: another change follows at once */
    void *block;  /* the memory that came along, or NULL; set by the receiver */
};

/* The body of a message. False: its size, a text or its kind is not valid, and `out` is not to be used. */
bool preview_reply_read(const struct message *message, struct preview_reply *out);
bool preview_command_read(const struct message *message, struct preview_command *out);

/* Where the overlay of a picture in a window is in that memory: behind the layers. */
void view_overlay_buffers(const struct picture_request *request, void *block, struct view_overlay_buffers *buffers);
/* The film of a pass in the same memory: the rectangle of the picture, divided. */
struct film pass_film(const struct picture_request *request, void *block, uint32_t divide);

#endif
