/* The nodes of glTF: the tree of the scene with its transforms. Source: Khronos Group, "glTF 2.0 Specification"
 * (ISO/IEC 12113:2022), section 3.5. */
#ifdef HAVE_JANSSON

#include "formats/gltf_node_internal.h"

#include "formats/gltf_animation_internal.h"
#include "formats/gltf_data_internal.h"
#include "formats/gltf_mesh_internal.h"
#include "math/elementary.h"
#include "math/range.h"

#include <math.h>
#include <stdio.h>

struct tree {
    struct gltf *g;
    const json_t *nodes;
    const json_t *(*samplers)[GLTF_PATHS]; /* of the animation, or NULL */
    struct affine *model_from;             /* of every node; NULL: the file has no skins */
    uint8_t *seen;
    struct list stack; /* struct visit */
};

/* --- transforms --- */

/* Translation, rotation and scale. False: the rotation is none. A map without an inverse has no finite one. */
static bool compose_parts(const double t[3], const double q[4], const double s[3], struct transform *out) {
    double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(length > 0 && isfinite(length)))
        return false;
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

/* glTF stores columns. */
static struct affine from_columns(const double m[16]) {
    struct affine out;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++)
            out.m[i][k] = m[4 * k + i];
    return out;
}

/* The transform of a node at the time of the options; its inverse is not finite if it has none. */
static bool read_placement(const struct tree *tree, uint32_t index, struct transform *out) {
    static const char *const keys[] = {"translation", "rotation", "scale"};
    struct gltf *g = tree->g;
    const json_t *source = json_array_get(tree->nodes, index);
    char where[64];
    (void)snprintf(where, sizeof where, "nodes[%u]", index);
    const json_t *const *samplers = tree->samplers ? tree->samplers[index] : NULL;
    bool moves = samplers && (samplers[GLTF_TRANSLATION] || samplers[GLTF_ROTATION] || samplers[GLTF_SCALE]);
    if (json_object_get(source, "matrix") && !moves) {
        double m[16];
        if (!gltf_numbers(g, source, "matrix", m, 16, where))
            return false;
        *out = transform_identity();
        out->forward = from_columns(m);
        if (!transform_from_affine(&out->forward, out))
            out->inverse.m[0][0] = INFINITY;
        return true;
    }
    double parts[3][4] = {{0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}};
    for (int path = GLTF_TRANSLATION; path <= GLTF_SCALE; path++) {
        int width = path == GLTF_ROTATION ? 4 : 3;
        if (!gltf_numbers(g, source, keys[path], parts[path], width, where) ||
            (moves && samplers[path] &&
             !gltf_sample(g, samplers[path], (enum gltf_path)path, parts[path], (size_t)width)))
            return false;
    }
    return compose_parts(parts[0], parts[1], parts[2], out) || gltf_fail(g, where, "its rotation is no quaternion");
}

/* The number of a child, or MODEL_NONE. */
static uint32_t child_of(const struct tree *tree, const json_t *list, size_t i) {
    const json_t *child = json_array_get(list, i);
    json_int_t index = json_is_integer(child) ? json_integer_value(child) : -1;
    return index >= 0 && (size_t)index < json_array_size(tree->nodes) ? (uint32_t)index : MODEL_NONE;
}

/* The transform of every node from the model's space, for joints: parents first, each node once. A node below itself
 * counts as a root. */
static bool pose_joints(struct tree *tree) {
    enum { NEW, OPEN, DONE };
    size_t count = json_array_size(tree->nodes);
    if (json_array_size(gltf_array(tree->g, "skins")) == 0 || count == 0)
        return true;
    uint32_t *parent = mem_alloc(count * sizeof *parent), *path = mem_alloc(count * sizeof *path);
    uint8_t *state = mem_alloc_zero(count, 1);
    tree->model_from = mem_alloc(count * sizeof *tree->model_from);
    bool ok = (parent && path && state && tree->model_from) || error_no_memory(tree->g->error, tree->g->path);
    for (size_t i = 0; ok && i < count; i++)
        parent[i] = MODEL_NONE;
    for (size_t i = 0; ok && i < count; i++) {
        const json_t *children = json_object_get(json_array_get(tree->nodes, i), "children");
        struct transform local;
        for (size_t k = 0; k < json_array_size(children); k++) {
            uint32_t child = child_of(tree, children, k);
            if (child != MODEL_NONE)
                parent[child] = (uint32_t)i;
        }
        ok = read_placement(tree, (uint32_t)i, &local);
        if (ok)
            tree->model_from[i] = local.forward;
    }
    for (size_t i = 0; ok && i < count; i++) {
        size_t depth = 0;
        for (uint32_t at = (uint32_t)i; at != MODEL_NONE && state[at] == NEW; at = parent[at]) {
            state[at] = OPEN;
            path[depth++] = at;
        }
        while (depth > 0) {
            uint32_t at = path[--depth];
            if (parent[at] != MODEL_NONE && state[parent[at]] == DONE)
                tree->model_from[at] = affine_compose(&tree->model_from[parent[at]], &tree->model_from[at]);
            state[at] = DONE;
        }
    }
    mem_free(parent);
    mem_free(path);
    mem_free(state);
    return ok;
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

static bool keep(struct gltf *g, struct list *list, const void *item, size_t size) {
    void *room = list_room(list, 1, size);
    if (!room)
        return error_no_memory(g->error, g->path);
    memcpy(room, item, size);
    list->count++;
    return true;
}

/* Whether the numbers make a camera. */
static bool lens_of(const json_t *source, struct model_camera *camera) {
    const char *type = json_string_value(json_object_get(source, "type"));
    const json_t *perspective = json_object_get(source, "perspective");
    const json_t *orthographic = json_object_get(source, "orthographic");
    if (type && strcmp(type, "perspective") == 0) {
        camera->vertical_angle = number_or(perspective, "yfov", 0);
        camera->aspect = math_max(number_or(perspective, "aspectRatio", 0), 0);
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
    return name_of(g, source, node, &camera.name) && keep(g, &g->model->cameras, &camera, sizeof camera);
}

/* Whether the numbers make a light. */
static bool shine_of(const json_t *source, struct model_light *light) {
    static const char *const kinds[] = {"directional", "point", "spot"};
    const char *type = json_string_value(json_object_get(source, "type"));
    const json_t *spot = json_object_get(source, "spot");
    const json_t *colour = json_object_get(source, "color");
    double light_of[3] = {1, 1, 1}, strength = math_max(number_or(source, "intensity", 1), 0);
    bool known = false;
    for (int i = 0; type && i < 3; i++)
        if (strcmp(type, kinds[i]) == 0) {
            light->kind = (enum model_light_kind)i;
            known = true;
        }
    for (size_t i = 0; colour && i < 3; i++)
        light_of[i] = math_max(json_number_value(json_array_get(colour, i)), 0);
    light->intensity = colour_scale(colour_make(light_of[0], light_of[1], light_of[2]), strength);
    light->range = math_max(number_or(source, "range", 0), 0);
    light->outer = number_or(spot, "outerConeAngle", PI / 4);
    light->inner = number_or(spot, "innerConeAngle", 0);
    return known && colour_within(light->intensity, NUMBER_LIMIT) && number_in_range(light->range) &&
           light->inner >= 0 && light->outer > 0 && light->inner <= light->outer && light->outer <= PI / 2 + 1e-6;
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
    return name_of(g, source, node, &light.name) && keep(g, &g->model->lights, &light, sizeof light);
}

/* --- meshes of nodes --- */

/* The weights of the morph targets: of the animation, else of the node, else of the mesh. *own: not of the mesh. */
static bool read_weights(const struct tree *tree, uint32_t index, const json_t *mesh, double **out, size_t *count,
                         bool *own) {
    struct gltf *g = tree->g;
    const json_t *primitives = json_object_get(mesh, "primitives");
    const json_t *weights = json_object_get(json_array_get(tree->nodes, index), "weights");
    const json_t *sampler = tree->samplers ? tree->samplers[index][GLTF_WEIGHTS] : NULL;
    *count = json_array_size(json_object_get(json_array_get(primitives, 0), "targets"));
    *own = *count > 0 && (weights || sampler);
    if (*count == 0)
        return true;
    if (!gltf_produce(g, *count, "weights"))
        return false;
    *out = mem_alloc_zero(*count, sizeof **out);
    if (!*out)
        return error_no_memory(g->error, g->path);
    if (sampler)
        return gltf_sample(g, sampler, GLTF_WEIGHTS, *out, *count);
    weights = weights ? weights : json_object_get(mesh, "weights");
    for (size_t i = 0; i < *count; i++)
        (*out)[i] = json_number_value(json_array_get(weights, i));
    return true;
}

/* The maps of the joints of a skin. */
static bool read_skin(const struct tree *tree, uint32_t index, struct affine **out, size_t *count) {
    struct gltf *g = tree->g;
    char where[64];
    (void)snprintf(where, sizeof where, "skins[%u]", index);
    const json_t *skin = json_array_get(gltf_array(g, "skins"), index), *joints = json_object_get(skin, "joints");
    uint32_t accessor;
    struct gltf_accessor a = {0};
    *count = json_array_size(joints);
    if (*count == 0)
        return gltf_fail(g, where, "it has no joints");
    if (!gltf_index(g, skin, "inverseBindMatrices", "accessors", &accessor, where) ||
        (accessor != MODEL_NONE && !gltf_accessor(g, accessor, &a)) || !gltf_produce(g, *count + a.sparse_count, where))
        return false;
    bool given = a.data || a.sparse_count;
    if (given && (a.components != 16 || a.count < *count))
        return gltf_fail(g, where, "accessors[%u] does not have a matrix for each of the %zu joints", accessor, *count);
    double *matrices = mem_alloc(*count * 16 * sizeof *matrices);
    *out = mem_alloc(*count * sizeof **out);
    bool ok = (matrices && *out) || error_no_memory(g->error, g->path);
    ok = ok && (!given || gltf_accessor_read(g, accessor, &a, 0, *count, matrices));
    for (size_t i = 0; ok && i < *count; i++) {
        uint32_t joint = child_of(tree, joints, i);
        struct affine bind = given ? from_columns(matrices + 16 * i) : affine_identity();
        ok = joint != MODEL_NONE || gltf_fail(g, where, "joint %zu does not exist", i);
        if (ok)
            (*out)[i] = affine_compose(&tree->model_from[joint], &bind);
    }
    mem_free(matrices);
    return ok;
}

/* The number of the mesh, in the model, as a node shows it. A mesh that no node changes is made once. */
static bool make_mesh(const struct tree *tree, uint32_t index, uint32_t mesh, uint32_t skin,
                      const struct affine *projection, uint32_t *out) {
    struct gltf *g = tree->g;
    struct gltf_deformation by = {.projection = projection};
    double *weights = NULL;
    struct affine *joints = NULL;
    bool own;
    bool ok =
        read_weights(tree, index, json_array_get(gltf_array(g, "meshes"), mesh), &weights, &by.weight_count, &own);
    if (ok && skin != MODEL_NONE)
        ok = read_skin(tree, skin, &joints, &by.joint_count);
    by.weights = weights;
    by.joints = joints;
    bool plain = !own && !joints && !projection;
    if (ok && (!plain || g->plain[mesh] == MODEL_NONE)) {
        ok = gltf_read_mesh(g, mesh, &by);
        *out = (uint32_t)g->model->meshes.count - 1;
        if (plain)
            g->plain[mesh] = *out;
    } else if (ok) {
        *out = g->plain[mesh];
    }
    mem_free(weights);
    mem_free(joints);
    /* The scene has a list of the mesh's materials for each node. */
    char where[64];
    (void)snprintf(where, sizeof where, "nodes[%u]", index);
    return ok && gltf_produce(g, model_meshes(g->model)[*out].slots.count, where);
}

/* One more node of the model. */
static bool add_node(struct gltf *g, const char *name, uint32_t parent, const struct transform *placement) {
    struct model_node *node = model_add_node(g->model, g->error);
    if (!node)
        return false;
    node->name = name;
    node->parent = parent;
    node->parent_from_node = *placement;
    return true;
}

/* --- instances --- */

/* EXT_mesh_gpu_instancing: the mesh of a node once for each element of some accessors. */
struct instances {
    uint64_t count;
    double *parts[3]; /* translations, rotations, scales; NULL: none */
};

static bool read_instances(struct gltf *g, const json_t *attributes, struct instances *out, const char *where) {
    static const char *const keys[] = {"TRANSLATION", "ROTATION", "SCALE"};
    for (int k = 0; k < 3; k++) {
        uint32_t accessor;
        struct gltf_accessor a;
        int width = k == GLTF_ROTATION ? 4 : 3;
        if (!gltf_index(g, attributes, keys[k], "accessors", &accessor, where))
            return false;
        if (accessor == MODEL_NONE)
            continue;
        if (!gltf_accessor(g, accessor, &a))
            return false;
        bool other_count = (out->parts[0] || out->parts[1]) && a.count != out->count; /* also beside a count of 0 */
        if (!a.data || a.components != width || a.sparse_count || other_count)
            return gltf_fail(g, where, "accessors[%u] does not have the %s of its instances", accessor, keys[k]);
        /* A node takes as much memory as some vertices. */
        if (!gltf_produce(g, 8 * a.count, where))
            return false;
        out->count = a.count;
        out->parts[k] = mem_alloc((size_t)a.count * (size_t)width * sizeof(double));
        if (!out->parts[k])
            return error_no_memory(g->error, g->path);
        if (!gltf_accessor_read(g, accessor, &a, 0, a.count, out->parts[k]))
            return false;
    }
    return true;
}

/* Whether the map leaves an area of anything. */
static bool keeps_area(const struct affine *map) {
    const double(*m)[4] = map->m;
    struct vec3 x = {m[0][0], m[1][0], m[2][0]}, y = {m[0][1], m[1][1], m[2][1]}, z = {m[0][2], m[1][2], m[2][2]};
    return vec3_max_abs(vec3_cross(x, y)) > 0 || vec3_max_abs(vec3_cross(y, z)) > 0 ||
           vec3_max_abs(vec3_cross(z, x)) > 0;
}

/* The mesh below node `parent` of the model, at a place in it; without an inverse, as a mesh of its own. */
static bool add_mesh_node(const struct tree *tree, uint32_t index, uint32_t mesh, uint32_t parent,
                          const struct transform *placement, const char *where) {
    struct gltf *g = tree->g;
    struct transform identity = transform_identity();
    bool singular = !transform_is_finite(placement);
    uint32_t number;
    if (singular && !keeps_area(&placement->forward)) {
        gltf_lacks(g, where, "it is scaled to nothing and not shown");
        return true;
    }
    if (!make_mesh(tree, index, mesh, MODEL_NONE, singular ? &placement->forward : NULL, &number) ||
        !add_node(g, model_nodes(g->model)[parent].name, parent, singular ? &identity : placement))
        return false;
    model_nodes(g->model)[g->model->nodes.count - 1].mesh = number;
    return true;
}

static bool add_instances(const struct tree *tree, uint32_t index, uint32_t mesh, uint32_t parent,
                          const struct transform *outer, const char *where) {
    static const double none[3][4] = {{0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}};
    const json_t *extensions = json_object_get(json_array_get(tree->nodes, index), "extensions");
    const json_t *extension = json_object_get(extensions, "EXT_mesh_gpu_instancing");
    struct instances all = {0};
    bool ok = read_instances(tree->g, json_object_get(extension, "attributes"), &all, where);
    for (uint64_t i = 0; ok && i < all.count; i++) {
        const double *part[3];
        struct transform placement = transform_identity();
        for (int k = 0; k < 3; k++)
            part[k] = all.parts[k] ? all.parts[k] + i * (k == GLTF_ROTATION ? 4 : 3) : none[k];
        ok = compose_parts(part[0], part[1], part[2], &placement) ||
             gltf_fail(tree->g, where, "the rotation of instance %llu is no quaternion", (unsigned long long)i);
        placement = transform_compose(outer, &placement);
        ok = ok && add_mesh_node(tree, index, mesh, parent, &placement, where);
    }
    for (int k = 0; k < 3; k++)
        mem_free(all.parts[k]);
    return ok;
}

/* The mesh of a node: in it, or a copy in each of its instances. outer: the map of the mesh; only if it has no inverse
 * it is not the identity. */
static bool show_mesh(const struct tree *tree, uint32_t index, uint32_t number, const struct transform *outer,
                      const char *where) {
    struct gltf *g = tree->g;
    const json_t *source = json_array_get(tree->nodes, index);
    const char *name = model_nodes(g->model)[number].name;
    struct transform identity = transform_identity();
    uint32_t mesh, skin, made;
    if (!gltf_index(g, source, "mesh", "meshes", &mesh, where) || !gltf_index(g, source, "skin", "skins", &skin, where))
        return false;
    if (mesh == MODEL_NONE)
        return true;
    /* The joints place a mesh with a skin, not its node. */
    if (skin != MODEL_NONE) {
        if (!make_mesh(tree, index, mesh, skin, NULL, &made) || !add_node(g, name, MODEL_NONE, &identity))
            return false;
        model_nodes(g->model)[g->model->nodes.count - 1].mesh = made;
        return true;
    }
    if (json_object_get(json_object_get(source, "extensions"), "EXT_mesh_gpu_instancing"))
        return add_instances(tree, index, mesh, number, outer, where);
    if (!transform_is_finite(outer))
        return add_mesh_node(tree, index, mesh, number, outer, where);
    if (!make_mesh(tree, index, mesh, MODEL_NONE, NULL, &made))
        return false;
    model_nodes(g->model)[number].mesh = made;
    return true;
}

/* --- the tree --- */

/* A node of the file below one of the model. `rest`: what parents without an inverse leave to the meshes below them; it
 * has no finite inverse then. */
struct visit {
    uint32_t node, parent;
    struct transform rest;
    struct affine model_from_parent;
};

/* Every node is on the stack once at most, so that equal children in a long list are an error at once. */
static bool claim(struct tree *tree, uint32_t node) {
    char where[64];
    (void)snprintf(where, sizeof where, "nodes[%u]", node);
    return !tree->seen[node]++ || gltf_fail(tree->g, where, "it has two parents, or is below itself");
}

/* Adds one node to the model and its children to the stack. */
static bool read_node(struct tree *tree, struct visit visit) {
    struct gltf *g = tree->g;
    char where[64];
    (void)snprintf(where, sizeof where, "nodes[%u]", visit.node);
    const json_t *source = json_array_get(tree->nodes, visit.node);
    struct transform placement, rest = visit.rest;
    const char *name = gltf_name(g, source);
    if (!name || !read_placement(tree, visit.node, &placement))
        return false;
    struct affine model_from_node = affine_compose(&visit.model_from_parent, &placement.forward);
    /* From the first map without an inverse on, nodes stay where their parents are, and meshes move. */
    bool singular = !transform_is_finite(&visit.rest) || !transform_is_finite(&placement);
    if (singular) {
        rest = transform_compose(&visit.rest, &placement);
        rest.inverse.m[0][0] = INFINITY;
        placement = transform_identity();
    }
    uint32_t number = (uint32_t)g->model->nodes.count;
    if (!add_node(g, name, visit.parent, &placement) || !read_camera(g, source, &model_from_node, where) ||
        !read_light(g, source, &model_from_node, where) || !show_mesh(tree, visit.node, number, &rest, where))
        return false;
    const json_t *children = json_object_get(source, "children");
    size_t count = json_array_size(children);
    struct visit *below = list_room(&tree->stack, count ? count : 1, sizeof *below);
    if (!below)
        return error_no_memory(g->error, g->path);
    /* The last one first, since a stack returns them in the other order. */
    for (size_t i = 0; i < count; i++) {
        uint32_t child = child_of(tree, children, count - 1 - i);
        if (child == MODEL_NONE)
            return gltf_fail(g, where, "a child that does not exist");
        if (!claim(tree, child))
            return false;
        below[i] = (struct visit){child, number, rest, model_from_node};
    }
    tree->stack.count += count;
    return true;
}

static bool push_root(struct tree *tree, uint32_t node) {
    if (!claim(tree, node))
        return false;
    struct visit *visit = list_room(&tree->stack, 1, sizeof *visit);
    if (!visit)
        return error_no_memory(tree->g->error, tree->g->path);
    *visit = (struct visit){node, MODEL_NONE, transform_identity(), affine_identity()};
    tree->stack.count++;
    return true;
}

/* The roots: those of the scene; in a file without scenes, all nodes without a parent. */
static bool push_roots(struct tree *tree) {
    struct gltf *g = tree->g;
    const json_t *scenes = gltf_array(g, "scenes");
    size_t count = json_array_size(tree->nodes);
    uint32_t scene;
    if (!gltf_index(g, g->root, "scene", "scenes", &scene, "scene"))
        return false;
    const json_t *roots = json_object_get(json_array_get(scenes, scene == MODEL_NONE ? 0 : scene), "nodes");
    if (json_array_size(scenes)) {
        for (size_t i = json_array_size(roots); i-- > 0;) {
            uint32_t root = child_of(tree, roots, i);
            if (root == MODEL_NONE)
                return gltf_fail(g, "scenes", "a root that does not exist");
            if (!push_root(tree, root))
                return false;
        }
        return true;
    }
    /* In a file without scenes, the nodes without a parent are the roots. */
    uint8_t *is_child = mem_alloc_zero(count ? count : 1, 1);
    bool ok = is_child || error_no_memory(g->error, g->path);
    for (size_t i = 0; ok && i < count; i++) {
        const json_t *children = json_object_get(json_array_get(tree->nodes, i), "children");
        for (size_t k = 0; k < json_array_size(children); k++) {
            uint32_t child = child_of(tree, children, k);
            if (child != MODEL_NONE)
                is_child[child] = 1;
        }
    }
    for (size_t i = count; ok && i-- > 0;)
        ok = is_child[i] || push_root(tree, (uint32_t)i);
    mem_free(is_child);
    return ok;
}

bool gltf_read_nodes(struct gltf *g) {
    struct tree tree = {.g = g, .nodes = gltf_array(g, "nodes")};
    size_t count = json_array_size(tree.nodes), meshes = json_array_size(gltf_array(g, "meshes"));
    tree.seen = mem_alloc_zero(count ? count : 1, 1);
    g->plain = mem_alloc((meshes ? meshes : 1) * sizeof *g->plain);
    bool ok = (tree.seen && g->plain) || error_no_memory(g->error, g->path);
    for (size_t i = 0; ok && i < meshes; i++)
        g->plain[i] = MODEL_NONE;
    ok = ok && gltf_choose_animation(g, &tree.samplers) && pose_joints(&tree) && push_roots(&tree);
    while (ok && tree.stack.count > 0) {
        struct visit visit = ((struct visit *)tree.stack.items)[--tree.stack.count];
        ok = read_node(&tree, visit);
    }
    /* A library of meshes: all of them, at their own positions. */
    bool library = ok && g->model->nodes.count == 0;
    for (uint32_t i = 0; ok && library && i < meshes; i++) {
        struct gltf_deformation none = {0};
        struct transform identity = transform_identity();
        ok = gltf_read_mesh(g, i, &none) && add_node(g, "", MODEL_NONE, &identity);
        if (ok)
            model_nodes(g->model)[i].mesh = i;
    }
    mem_free(tree.samplers);
    mem_free(tree.model_from);
    mem_free(tree.seen);
    list_destroy(&tree.stack);
    return ok;
}

#else
/* This file is empty without jansson. */
typedef int gltf_node_is_empty;
#endif
