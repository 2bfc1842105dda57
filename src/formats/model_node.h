/* From a model to nodes and materials of a scene. */
#ifndef GRAY_FORMATS_MODEL_NODE_H
#define GRAY_FORMATS_MODEL_NODE_H

#include "formats/model.h"
#include "scene/node.h"

/* The model of a file, from the store or read into it. `path` is for messages, `canonical` identifies the file.
 * *fresh: it was read now, so its warnings have not been reported yet. Owned by the store. */
struct model *model_asset(struct assets *assets, const char *path, const char *canonical,
                          const struct model_options *options, bool *fresh, struct error *error);

struct model_placing {
    const char *name;                /* of the node */
    const struct material *material; /* the material of everything; NULL: the file's own materials */
    enum node_cull cull;
    enum node_walls walls;
    /* Materials for the parts of these names; they precede `material` and the file's materials. */
    const char *const *part_names;
    const struct material *const *part_materials;
    uint32_t part_count;
};

/* Whether the model has a part of that name; and the index-th of the names, or NULL after the last one. */
bool model_has_part(const struct model *model, const char *name);
const char *model_part(const struct model *model, size_t index);

/* A model with one mesh becomes one geometry node. Other models become a group with the nodes of the file; if the
 * file positions a mesh several times, all nodes share it. Everything is allocated in the scene's arena; pictures
 * come from its store. Those that cannot be used have no effect: the model gets warnings, each once. */
struct node *model_add_nodes(struct scene *scene, struct model *model, const struct model_placing *placing,
                             struct error *error);

#endif
