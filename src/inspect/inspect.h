/* Queries about a scene, made instead of rendering it: the trace of a pixel, and the flattened world as a
 * table. */
#ifndef GRAY_INSPECT_INSPECT_H
#define GRAY_INSPECT_INSPECT_H

#include "render/pixel_trace.h"
#include "render/render.h"
#include "session/text.h"
#include "world/node_path.h"

/* A picture to be rendered: its name, its world, and the tree from which the world was built. */
struct inspected {
    const char *file;
    const struct render_job *job; /* with its world */
    const struct node *root;
    struct pool *pool; /* for pixels */
    bool json;         /* else in words */
};

/* --pixel: renders pixels {x, y} of the whole picture and prints their traces, in words or as one line of JSON each.
 * With --noise or --time-limit the pixels have as many samples as with --spp alone.
 * Errors: a pixel is not in the picture (ERROR_USAGE), those of render_pixels. */
bool inspect_pixels(const struct inspected *picture, const uint32_t (*pixels)[2], uint32_t count,
                    struct text_writer *writer, struct error *error);
/* --dump-scene: all primitives, in flattening order, then lights and materials. */
bool inspect_world(const struct inspected *picture, struct text_writer *writer, struct error *error);
/* --dump-expr: the Lua functions of the picture that were recorded (textures, implicit solids, lights, sky, fog), as
 * lists of operations. */
void inspect_functions(const struct inspected *picture, struct text_writer *writer);

/* A trace with the node paths that its text needs. */
struct trace_names {
    uint32_t count;
    uint32_t *primitives; /* ascending */
    const char **paths;
};
struct trace_report {
    const struct inspected *picture;
    const struct pixel_trace *pixel_trace;
    struct trace_names names;
};
const char *trace_path(const struct trace_report *report, uint32_t primitive); /* never NULL */
void pixel_trace_print(const struct trace_report *report, struct text_writer *writer);
void pixel_trace_print_json(const struct trace_report *report, struct text_writer *writer);

/* Words for kinds. */
const char *inspect_ray(enum ray_kind kind);

#endif
