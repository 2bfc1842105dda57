/* The nodes of glTF: the tree of the scene with its transforms. Source: Khronos Group, "glTF 2.0 Specification"
 * (ISO/IEC 12113:2022), section 3.5. */
#ifdef HAVE_JANSSON

#include "formats/gltf_node_internal.h"

#include "math/elementary.h"
#include "math/range.h"

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

/* --- cameras and lights --- */

static double number_or(const json_t *object, const char *key, double otherwise) {
    const json_t *value = json_object_get(object, key);
    return json_is_number(value) ? json_number_value(value) : otherwise;
}

static bool affine_in_range(const struct affine *a) {
    bool fine = true;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++)
            fine = fine && number_in_range(a->m[i][k]);
    return fine;
}

/* The name of the object, else of its node. */
static bool name_of(struct gltf *g, const json_t *object, const json_t *node, const char **out) {
    *out = gltf_name(g, object);
    if (*out && !**out)
        *out = gltf_name(g, node);
    return *out != NULL;
}

/* Whether the numbers make a camera. */
static bool lens_of(const json_t *source, struct model_camera *camera) {
    const char *type = json_string_value(json_object_get(source, "type"));
    const json_t *perspective = json_object_get(source, "perspective");
    const json_t *orthographic = json_object_get(source, "orthographic");
    if (type && strcmp(type, "perspective") == 0) {
        camera->vertical_angle = number_or(perspective, "yfov", 0);
        camera->aspect = fmax(number_or(perspective, "aspectRatio", 0), 0);
        return camera->vertical_angle > 0 && camera->vertical_angle < PI && number_in_range(camera->aspect);
    }
    for (int i = 0; i < 2; i++)
        camera->half_size[i] = fabs(number_or(orthographic, i ? "ymag" : "xmag", 0));
    return type && strcmp(type, "orthographic") == 0 && camera->half_size[0] > 0 && camera->half_size[1] > 0 &&
           number_in_range(camera->half_size[0]) && number_in_range(camera->half_size[1]);
}

static bool read_camera(struct gltf *g, const json_t *node, const struct affine *model_from_node, const char *where) {
    if (!json_object_get(node, "camera"))
        return true;
    uint32_t index;
    struct model_camera camera = {.model_from_camera = *model_from_node};
    if (!gltf_index(g, node, "camera", "cameras", &index, where))
        return false;
    const json_t *source = json_array_get(gltf_array(g, "cameras"), index);
    if (!lens_of(source, &camera) || !affine_in_range(model_from_node)) {
        gltf_lacks(g, where, "its camera is left out: it is no perspective or orthographic view of finite size");
        return true;
    }
    struct model_camera *room = list_room(&g->model->cameras, 1, sizeof *room);
    if (!room)
        return error_no_memory(g->error, g->path);
    *room = camera;
    g->model->cameras.count++;
    return name_of(g, source, node, &room->name);
}

/* Whether the numbers make a light. */
static bool shine_of(const json_t *source, struct model_light *light) {
    static const char *const kinds[] = {"directional", "point", "spot"};
    const char *type = json_string_value(json_object_get(source, "type"));
    const json_t *spot = json_object_get(source, "spot");
    const json_t *colour = json_object_get(source, "color");
    double light_of[3] = {1, 1, 1}, strength = fmax(number_or(source, "intensity", 1), 0);
    bool known = false;
    for (int i = 0; type && i < 3; i++)
        if (strcmp(type, kinds[i]) == 0) {
            light->kind = (enum model_light_kind)i;
            known = true;
        }
    for (size_t i = 0; colour && i < 3; i++)
        light_of[i] = fmax(json_number_value(json_array_get(colour, i)), 0);
    light->intensity = vec3_scale(vec3_make(light_of[0], light_of[1], light_of[2]), strength);
    light->range = fmax(number_or(source, "range", 0), 0);
    light->outer = number_or(spot, "outerConeAngle", PI / 4);
    light->inner = number_or(spot, "innerConeAngle", 0);
    return known && vec3_within(light->intensity, NUMBER_LIMIT) && number_in_range(light->range) && light->inner >= 0 &&
           light->outer > 0 && light->inner <= light->outer && light->outer <= PI / 2 + 1e-6;
}

/* KHR_lights_punctual. */
static bool read_light(struct gltf *g, const json_t *node, const struct affine *model_from_node, const char *where) {
    const json_t *reference = json_object_get(json_object_get(node, "extensions"), "KHR_lights_punctual");
    const json_t *lights =
        json_object_get(json_object_get(json_object_get(g->root, "extensions"), "KHR_lights_punctual"), "lights");
    uint64_t index;
    if (!reference)
        return true;
    if (!gltf_whole(g, reference, "light", UINT64_MAX, &index, where))
        return false;
    const json_t *source = index < json_array_size(lights) ? json_array_get(lights, (size_t)index) : NULL;
    struct model_light light = {.model_from_light = *model_from_node};
    if (!shine_of(source, &light) || !affine_in_range(model_from_node)) {
        gltf_lacks(g, where, "its light is left out: it is no directional, point or spot light of finite numbers");
        return true;
    }
    struct model_light *room = list_room(&g->model->lights, 1, sizeof *room);
    if (!room)
        return error_no_memory(g->error, g->path);
    *room = light;
    g->model->lights.count++;
    return name_of(g, source, node, &room->name);
}

/* --- the tree --- */

struct visit {
    uint32_t node, parent; /* in the file; in the model */
    struct affine model_from_parent;
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
    node->name = gltf_name(g, source);
    node->parent = visit.parent;
    node->parent_from_node = placement;
    struct affine model_from_node = affine_compose(&visit.model_from_parent, &placement.forward);
    if (!node->name || !read_camera(g, source, &model_from_node, where) ||
        !read_light(g, source, &model_from_node, where))
        return false;
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
        below[i] = (struct visit){(uint32_t)index, number, model_from_node};
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
            *visit = (struct visit){(uint32_t)index, MODEL_NONE, affine_identity()};
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
            *visit = (struct visit){(uint32_t)i, MODEL_NONE, affine_identity()};
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

/* --- animations --- */

/* The largest time of the inputs, which the format states. */
static double duration_of(const struct gltf *g, const json_t *samplers) {
    double duration = 0;
    for (size_t i = 0; i < json_array_size(samplers); i++) {
        const json_t *input = json_object_get(json_array_get(samplers, i), "input");
        json_int_t index = json_is_integer(input) ? json_integer_value(input) : -1;
        const json_t *accessor = index >= 0 ? json_array_get(gltf_array(g, "accessors"), (size_t)index) : NULL;
        duration = fmax(duration, json_number_value(json_array_get(json_object_get(accessor, "max"), 0)));
    }
    return duration;
}

bool gltf_read_animations(struct gltf *g) {
    const json_t *animations = gltf_array(g, "animations");
    for (size_t i = 0; i < json_array_size(animations); i++) {
        const json_t *source = json_array_get(animations, i);
        struct model_animation *room = list_room(&g->model->animations, 1, sizeof *room);
        if (!room)
            return error_no_memory(g->error, g->path);
        *room = (struct model_animation){gltf_name(g, source), duration_of(g, json_object_get(source, "samplers"))};
        if (!room->name)
            return false;
        g->model->animations.count++;
    }
    return true;
}

#else
/* This file is empty without jansson. */
typedef int gltf_node_is_empty;
#endif
