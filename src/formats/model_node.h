/* From a model to nodes and materials of a scene. */
#ifndef GRAY_FORMATS_MODEL_NODE_H
#define GRAY_FORMATS_MODEL_NODE_H

#include "formats/model.h"
#include "scene/node.h"

/* The model of a file, from the store or read into it. `path` is for messages, `canonical` identifies the file. *fresh:
 * it was read now, so its warnings have not been reported yet. Owned by the store. */
const struct model *model_asset(struct assets *assets, const char *path, const char *canonical,
                                const struct model_options *options, bool *fresh, struct error *error);

struct model_placing {
    const char *name;                /* of the node */
    const struct material *material; /* for everything; NULL: the file's own */
    enum node_cull cull;
    /* Materials for the parts of these names, before `material` and the file's. */
    const char *const *part_names;
    const struct material *const *part_materials;
    uint32_t part_count;
};

/* Whether the model has a part of that name; and their names, one after the other: the index-th, or NULL. */
bool model_has_part(const struct model *model, const char *name);
const char *model_part(const struct model *model, size_t index);

/* A model with one mesh becomes one geometry node, others a group with the file's nodes below it; a mesh that the file
 * places several times is one mesh. Everything is made in the scene's arena, pictures come from its store. */
struct node *model_add_nodes(struct scene *scene, const struct model *model, const struct model_placing *placing,
                             struct error *error);

#endif
