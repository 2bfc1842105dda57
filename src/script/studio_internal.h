/* A picture of a scene without a camera or without any light. */
#ifndef GRAY_SCRIPT_STUDIO_INTERNAL_H
#define GRAY_SCRIPT_STUDIO_INTERNAL_H

#include "scene/node.h"
#include "script/script.h"

#include <stdbool.h>

/* What a picture without `eye` is to show, and from which side. */
struct framing {
    struct vec3 view, up;      /* zero: from the front, a little from above and from the right */
    double fov, aspect;        /* degrees; width over height */
    const struct vec3 *target; /* the middle of the picture; NULL: that of the scene */
};

/* The camera for it. */
struct framed {
    struct vec3 eye, target;
    double distance;    /* between them */
    double view_height; /* for an orthographic picture */
};

struct framed studio_frame(struct node *root, const struct framing *framing);

/* Whether no material below the root emits light or is shown without light. Errors: no memory. */
bool studio_is_dark(const struct scene *scene, const struct node *root, struct arena *arena, bool *dark,
                    struct error *error);

enum { STUDIO_LIGHTS = 2 };
/* Lights a request whose camera and settings are complete: key, fill and sky. `lights` is the caller's memory. even:
 * the background is the same in all directions. */
void studio_light(struct render_request *request, bool even, struct scene_light lights[STUDIO_LIGHTS]);
/* The kd of a level ground that is as bright as the even background, seen along `view`: it shows only its shadow. */
double studio_ground(const struct settings *settings, struct vec3 view);

#endif
