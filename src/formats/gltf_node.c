/* The nodes of glTF: the tree of the scene with its transforms. Source: Khronos Group, "glTF 2.0 Specification"
 * (ISO/IEC 12113:2022), section 3.5. */
#ifdef HAVE_JANSSON

#include "formats/gltf_node_internal.h"

#include <math.h>
#include <stdio.h>

static bool read_placement(struct gltf *g, const json_t *source, struct transform *out, bool *singular,
                           const char *where) {
    double m[16], t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
    *out = transform_identity();
    *singular = false;
    if (json_object_get(source, "matrix")) {
        struct affine forward;
        if (!gltf_numbers(g, source, "matrix", m, 16, where))
            return false;
        /* glTF stores columns. */
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 4; k++)
                forward.m[i][k] = m[4 * k + i];
        *singular = !transform_from_affine(&forward, out);
        return true;
    }
    if (!gltf_numbers(g, source, "translation", t, 3, where) || !gltf_numbers(g, source, "rotation", q, 4, where) ||
        !gltf_numbers(g, source, "scale", s, 3, where))
        return false;
    double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    *singular = s[0] == 0 || s[1] == 0 || s[2] == 0;
    if (!(length > 0 && isfinite(length)))
        return gltf_fail(g, where, "its rotation is no quaternion");
    if (*singular)
        return true;
    /* The matrix of the unit quaternion; its inverse is its transpose. */
    double x = q[0] / length, y = q[1] / length, z = q[2] / length, w = q[3] / length;
    struct affine r = {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 0},
                        {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), 0},
                        {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), 0}}};
    struct transform turn = {.forward = r};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++)
            turn.inverse.m[i][k] = k < 3 ? r.m[k][i] : 0;
    struct transform scale = transform_scale(vec3_make(s[0], s[1], s[2]));
    struct transform move = transform_translate(vec3_make(t[0], t[1], t[2]));
    *out = transform_compose(&turn, &scale);
    *out = transform_compose(&move, out);
    return true;
}

struct visit {
    uint32_t node, parent; /* in the file; in the model */
};

/* Adds one node to the model and its children to the stack. */
static bool read_node(struct gltf *g, struct visit visit, uint8_t *seen, struct list *stack) {
    char where[64];
    (void)snprintf(where, sizeof where, "nodes[%u]", visit.node);
    if (seen[visit.node]++)
        return gltf_fail(g, where, "it has two parents, or is below itself");
    const json_t *source = json_array_get(gltf_array(g, "nodes"), visit.node);
    struct transform placement;
    bool singular;
    if (!read_placement(g, source, &placement, &singular, where))
        return false;
    if (singular) {
        model_warn(g->model, "%s: %s: it is scaled to nothing and not shown", g->path, where);
        return true;
    }
    /* Numbers are those of the model: nodes that are not shown have none. */
    uint32_t number = (uint32_t)g->model->nodes.count;
    struct model_node *node = model_add_node(g->model, g->error);
    if (!node || !gltf_index(g, source, "mesh", "meshes", &node->mesh, where))
        return false;
    const char *name = json_string_value(json_object_get(source, "name"));
    if (name)
        node->name = arena_copy_text(&g->model->arena, name, strlen(name));
    if (!node->name)
        return error_no_memory(g->error, g->path);
    node->parent = visit.parent;
    node->parent_from_node = placement;
    const json_t *children = json_object_get(source, "children");
    size_t count = json_array_size(children);
    struct visit *below = list_room(stack, count ? count : 1, sizeof *below);
    if (!below)
        return error_no_memory(g->error, g->path);
    /* The last one first, since a stack returns them in the other order. */
    for (size_t i = 0; i < count; i++) {
        const json_t *child = json_array_get(children, count - 1 - i);
        json_int_t index = json_integer_value(child);
        if (!json_is_integer(child) || index < 0 || (size_t)index >= json_array_size(gltf_array(g, "nodes")))
            return gltf_fail(g, where, "a child that does not exist");
        below[i] = (struct visit){(uint32_t)index, number};
    }
    stack->count += count;
    return true;
}

/* The roots: those of the scene; in a file without scenes, all nodes without a parent. */
static bool push_roots(struct gltf *g, struct list *stack) {
    const json_t *nodes = gltf_array(g, "nodes"), *scenes = gltf_array(g, "scenes");
    size_t count = json_array_size(nodes);
    uint32_t scene;
    if (!gltf_index(g, g->root, "scene", "scenes", &scene, "scene"))
        return false;
    const json_t *roots = json_object_get(json_array_get(scenes, scene == MODEL_NONE ? 0 : scene), "nodes");
    if (json_array_size(scenes)) {
        for (size_t i = json_array_size(roots); i-- > 0;) {
            const json_t *root = json_array_get(roots, i);
            json_int_t index = json_integer_value(root);
            struct visit *visit = list_room(stack, 1, sizeof *visit);
            if (!json_is_integer(root) || index < 0 || (size_t)index >= count)
                return gltf_fail(g, "scenes", "a root that does not exist");
            if (!visit)
                return error_no_memory(g->error, g->path);
            *visit = (struct visit){(uint32_t)index, MODEL_NONE};
            stack->count++;
        }
        return true;
    }
    /* Without scenes the roots are those nodes that are nobody's child. */
    uint8_t *child = mem_alloc_zero(count ? count : 1, 1);
    bool ok = child != NULL;
    for (size_t i = 0; ok && i < count; i++) {
        const json_t *children = json_object_get(json_array_get(nodes, i), "children");
        for (size_t k = 0; k < json_array_size(children); k++) {
            json_int_t index = json_integer_value(json_array_get(children, k));
            if (index >= 0 && (size_t)index < count)
                child[index] = 1;
        }
    }
    for (size_t i = count; ok && i-- > 0;) {
        struct visit *visit = child[i] ? NULL : list_room(stack, 1, sizeof *visit);
        ok = child[i] || visit;
        if (visit) {
            *visit = (struct visit){(uint32_t)i, MODEL_NONE};
            stack->count++;
        }
    }
    mem_free(child);
    return ok || error_no_memory(g->error, g->path);
}

bool gltf_read_nodes(struct gltf *g) {
    size_t count = json_array_size(gltf_array(g, "nodes"));
    struct list stack = {0};
    uint8_t *seen = mem_alloc_zero(count ? count : 1, 1);
    bool ok = seen ? push_roots(g, &stack) : error_no_memory(g->error, g->path);
    while (ok && stack.count > 0) {
        struct visit visit = ((struct visit *)stack.items)[--stack.count];
        ok = read_node(g, visit, seen, &stack);
    }
    mem_free(seen);
    list_destroy(&stack);
    if (!ok || g->model->nodes.count)
        return ok;
    /* A library of meshes: all of them, at their own positions. */
    for (uint32_t i = 0; i < g->model->meshes.count; i++) {
        struct model_node *node = model_add_node(g->model, g->error);
        if (!node)
            return false;
        node->mesh = i;
    }
    return true;
}

#else
/* This file is empty without jansson. */
typedef int gltf_node_is_empty;
#endif
