/* glTF files (.gltf, .glb): scenes with their tree, materials, lights, camera and animation (docs/export.md). */
#ifndef GRAY_EXPORT_GLTF_WRITE_H
#define GRAY_EXPORT_GLTF_WRITE_H

#include "base/error.h"
#include "base/pool.h"
#include "formats/list.h"
#include "world/world.h"

struct gltf_options {
    double tolerance; /* units of the scene; 0: a thousandth of each shape's size */
    bool linear;      /* the colours of the world are linear light */
    struct pool *pool;
};

/* A moment. */
struct gltf_moment {
    const struct world *world;
    const struct scene *scene;
    const struct node *root;     /* of the world */
    const struct camera *camera; /* or NULL; its view is a direction */
    const struct lens *lens;
    double aspect; /* of the picture: width over height */
    bool is_frame; /* of an animation: its motion is that from frame to frame */
    double time;   /* of the frame, seconds */
};

struct gltf_scene;
/* Owner: the caller, gltf_scene_destroy. NULL: no memory. */
struct gltf_scene *gltf_scene_create(const struct gltf_options *options);
void gltf_scene_destroy(struct gltf_scene *scene);
/* The first moment is the scene at rest; from the later ones the file has the poses of the same nodes. The nodes and
 * the world may go afterwards. Errors: no memory, cancelled. */
bool gltf_scene_add(struct gltf_scene *scene, const struct gltf_moment *moment, struct error *error);
typedef void gltf_warn(void *context, const char *text);
/* The bytes of a GLB, or else of a glTF file with its buffer in it; `warn` is called for each kind of thing that the
 * file lacks. Errors: no memory, too large. */
bool gltf_scene_write(struct gltf_scene *scene, bool binary, gltf_warn *warn, void *context, struct list *out,
                      struct error *error);

#endif
