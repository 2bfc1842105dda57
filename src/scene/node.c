/* Building the authoring tree. */
#include "scene/node.h"

#include "material/material_inputs.h"

#include <stddef.h>
#include <string.h>

void scene_init(struct scene *scene, struct assets *assets) {
    *scene = (struct scene){.assets = assets, .epoch = assets ? ++assets->epochs : 0};
}

void scene_destroy(struct scene *scene) {
    arena_destroy(&scene->arena);
}

struct scene_snapshot scene_snapshot(struct scene *scene) {
    scene->kept_nodes = scene->node_total;
    scene->escaped = false;
    memset(scene->names, 0, sizeof scene->names); /* names of newer nodes are freed with them */
    return (struct scene_snapshot){.arena = arena_mark(&scene->arena),
                                   .node_total = scene->node_total,
                                   .warned_room = scene->warned_room,
                                   .warned = scene->warned,
                                   .last_material = scene->last_material,
                                   .meshes = scene->assets->meshes};
}

void scene_rewind(struct scene *scene, const struct scene_snapshot *snapshot) {
    memset(scene->names, 0, sizeof scene->names);
    scene_forget_changes(scene); /* nodes that are freed may be among them */
    scene_note_change(scene);
    scene->node_total = snapshot->node_total;
    scene->warned_room = snapshot->warned_room;
    scene->warned = snapshot->warned;
    scene->last_material = snapshot->last_material;
    scene->file = NULL;
    scene->line = 0;
    scene->epoch = ++scene->assets->epochs;
    assets_drop_meshes(scene->assets, snapshot->meshes);
    arena_rewind(&scene->arena, snapshot->arena);
}

static size_t node_size(enum node_kind kind) {
    switch (kind) {
    case NODE_GROUP:
        return offsetof(struct node, joint_x);
    case NODE_JOINT:
        return offsetof(struct node, shape);
    case NODE_GEOMETRY:
    case NODE_CSG:
        return sizeof(struct node);
    }
    return sizeof(struct node);
}

const char *scene_keep_text(struct scene *scene, const char *text) {
    size_t length = strlen(text);
    const char **slot = &scene->names[hash_bytes(text, length, 0) % SCENE_NAMES];
    if (!*slot || strcmp(*slot, text) != 0)
        *slot = arena_copy_text(&scene->arena, text, length);
    return *slot;
}

struct node *scene_node(struct scene *scene, enum node_kind kind, const char *name, struct error *error) {
    struct node *node = arena_alloc(&scene->arena, node_size(kind));
    if (node)
        node->name = scene_keep_text(scene, name);
    if (!node || !node->name) {
        error_no_memory(error, "a node");
        return NULL;
    }
    node->kind = kind;
    node->serial = scene->node_count++;
    node->index = scene->node_total++;
    node->parent_from_node = transform_identity();
    if (kind == NODE_GEOMETRY || kind == NODE_CSG) {
        node->file = scene->file;
        node->line = scene->line;
    }
    return node;
}

struct node *scene_combine(struct scene *scene, const char *name, enum node_csg operation, struct node *const *operands,
                           uint32_t count, struct error *error) {
    struct node *node = scene_node(scene, NODE_CSG, name, error);
    struct node **own = node ? arena_alloc_array(&scene->arena, count, sizeof *own) : NULL;
    if (!own) {
        error_no_memory(error, "a combined solid");
        return NULL;
    }
    for (uint32_t i = 0; i < count; i++)
        own[i] = operands[i], operands[i]->has_parent = true;
    node->operation = operation;
    node->operands = own;
    node->operand_count = count;
    return node;
}

bool node_holds(const struct node *node, const struct node *part, int *budget) {
    if (node == part)
        return true;
    for (const struct node_child *child = node->first_child; child && --*budget > 0; child = child->next)
        if (node_holds(child->node, part, budget))
            return true;
    for (uint32_t i = 0; node->kind == NODE_CSG && i < node->operand_count && --*budget > 0; i++)
        if (node_holds(node->operands[i], part, budget))
            return true;
    return false;
}

bool node_add_child(struct scene *scene, struct node *parent, struct node *child, struct error *error) {
    struct node_child *link = arena_alloc(&scene->arena, sizeof *link);
    if (!link)
        return error_no_memory(error, "a child of a node");
    link->node = child;
    scene_note_reference(scene, parent->index);
    if (parent->last_child)
        parent->last_child->next = link;
    else
        parent->first_child = link;
    parent->last_child = link;
    parent->child_count++;
    child->has_parent = true;
    return true;
}

static bool compose_separately(struct scene *scene, struct node *node, enum node_step step,
                               const struct transform *by) {
    if (!node->separate) {
        node->separate = arena_alloc_array(&scene->arena, NODE_STEPS, sizeof *node->separate);
        if (!node->separate)
            return false;
        scene_note_reference(scene, node->index);
        for (int i = 0; i < NODE_STEPS; i++)
            node->separate[i] = transform_identity();
        /* Transforms composed before the order was chosen stay innermost. */
        node->separate[NODE_SCALE] = node->parent_from_node;
    }
    node->separate[step] = transform_compose(by, &node->separate[step]);
    struct transform turned = transform_compose(&node->separate[NODE_ROTATE], &node->separate[NODE_SCALE]);
    node->parent_from_node = transform_compose(&node->separate[NODE_TRANSLATE], &turned);
    return true;
}

static struct digest digest_of_pose(const struct node *node) {
    return digest_bytes(&node->parent_from_node, sizeof node->parent_from_node, (struct digest){0});
}

static void note_pose(struct scene *scene, struct node *node) {
    struct scene_changes *changes = &scene->changes;
    if (changes->other || node->posed)
        return;
    changes->other = changes->posed_count == SCENE_POSED_MAX;
    if (changes->other)
        return;
    node->posed = true;
    changes->posed[changes->posed_count++] = (struct posed_node){node, digest_of_pose(node)};
}

bool scene_has_changes(const struct scene *scene) {
    const struct scene_changes *changes = &scene->changes;
    for (uint32_t i = 0; !changes->other && i < changes->posed_count; i++)
        if (!digest_equal(digest_of_pose(changes->posed[i].node), changes->posed[i].before))
            return true;
    return changes->other;
}

void scene_forget_changes(struct scene *scene) {
    for (uint32_t i = 0; i < scene->changes.posed_count; i++)
        scene->changes.posed[i].node->posed = false;
    scene->changes.posed_count = 0;
    scene->changes.other = false;
}

bool node_transform(struct scene *scene, struct node *node, enum node_step step, const struct transform *by) {
    note_pose(scene, node);
    switch (scene->order) {
    case TRANSFORM_ORDER_NEW:
        node->parent_from_node = transform_compose(by, &node->parent_from_node);
        return true;
    case TRANSFORM_ORDER_OLD:
        node->parent_from_node = transform_compose(&node->parent_from_node, by);
        return true;
    case TRANSFORM_ORDER_SEPARATE:
        return compose_separately(scene, node, step, by);
    }
    return true;
}

void node_reset_transform(struct scene *scene, struct node *node) {
    note_pose(scene, node);
    scene->changes.other = scene->changes.other || node->singular;
    node->parent_from_node = transform_identity();
    node->singular = false;
    for (int i = 0; node->separate && i < NODE_STEPS; i++)
        node->separate[i] = transform_identity();
}

struct transform node_parent_from_node(const struct node *node) {
    if (node->kind != NODE_JOINT)
        return node->parent_from_node;
    struct transform about_x = transform_rotate(0, node->joint_x.init);
    struct transform about_y = transform_rotate(1, node->joint_y.init);
    struct transform joint = transform_compose(&about_x, &about_y);
    return transform_compose(&node->parent_from_node, &joint);
}

bool scene_warns(struct scene *scene, const struct node *node) {
    if (node->index >= scene->warned_room) {
        uint8_t *warned = arena_alloc_array(&scene->arena, scene->node_total, sizeof *warned);
        if (!warned)
            return true;
        if (scene->warned_room > 0)
            memcpy(warned, scene->warned, scene->warned_room);
        scene->warned = warned;
        scene->warned_room = scene->node_total;
    }
    bool first = !scene->warned[node->index];
    scene->warned[node->index] = 1;
    return first;
}

struct material *scene_material(struct scene *scene, enum material_kind kind, const struct material *base,
                                struct error *error) {
    int depth = base ? base->depth + 1 : 1;
    if (depth > MATERIAL_DEPTH) {
        error_set(error, ERROR_SCENE, "more than %d materials are nested", MATERIAL_DEPTH);
        return NULL;
    }
    struct material *material = arena_alloc(&scene->arena, sizeof *material);
    if (!material) {
        error_no_memory(error, "a material");
        return NULL;
    }
    material_derive(material, kind, base);
    material->serial = ++scene->material_count;
    material->older = scene->last_material;
    scene->last_material = material;
    return material;
}

/* Placements are converted to maps one by one, only while the scene is flattened. */

struct transform placement_transform(const struct placements *p, uint32_t i) {
    struct transform out = transform_identity();
    if (p->matrices) {
        (void)transform_from_affine(&p->matrices[i], &out); /* it was checked on input */
        return out;
    }
    if (p->size)
        out = transform_scale(vec3_all(p->size[p->one_size ? 0 : i]));
    if (p->turn) {
        struct transform turn = transform_rotate(p->axis, p->turn[p->one_turn ? 0 : i]);
        out = transform_compose(&turn, &out);
    }
    struct transform move = transform_translate(vec3_make(p->at[i][0], p->at[i][1], p->at[i][2]));
    return transform_compose(&move, &out);
}
