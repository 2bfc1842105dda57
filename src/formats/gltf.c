/* glTF 2.0, as JSON with buffers in other files or inside it, and as GLB. Source: Khronos Group, "glTF 2.0
 * Specification" (ISO/IEC 12113:2022). jansson parses the JSON. The reader takes the nodes of the scene with their
 * transforms, their meshes (triangles, strips, fans; position, normal, first texture coordinates, first colour),
 * materials and pictures. It ignores skins, morphs, animations, cameras and lights. A required extension that the
 * reader does not know is an error.
 *
 * Any number of primitives may use one accessor, so a small file can request very large meshes. A multiple of the
 * size of the file bounds everything that is made from it. */
#include "formats/gltf_data_internal.h"
#include "formats/gltf_material_internal.h"

#ifndef HAVE_JANSSON

bool gltf_load(struct model *model, const uint8_t *data, size_t size, struct error *error) {
    (void)data, (void)size;
    return error_set(error, ERROR_SCENE, "%s: this build cannot read glTF (it was made without jansson)", model->path);
}

const char *gltf_library(void) {
    return "none";
}

#else

#include "base/hash.h"
#include "formats/gltf_internal.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>

/* Vertices and corners per byte of the file, and a minimum for every file. */
enum { MADE_PER_BYTE = 8, MADE_FREE = 1 << 20 };
/* jansson needs about 40 bytes for a number and 300 for an object. */
enum { OBJECT_LIMIT = 1 << 20, VALUE_LIMIT = 1 << 24 };

bool gltf_fail(const struct gltf *g, const char *where, const char *format, ...) {
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    for (char *c = text; *c; c++)
        if ((unsigned char)*c < 0x20 || *c == 0x7f)
            *c = '?';
    return error_set(g->error, ERROR_SCENE, "%s: %s: %s", g->path, where, text);
}

json_t *gltf_array(const struct gltf *g, const char *name) {
    json_t *array = json_object_get(g->root, name);
    return json_is_array(array) ? array : NULL;
}

bool gltf_whole(const struct gltf *g, const json_t *object, const char *key, uint64_t otherwise, uint64_t *out,
                const char *where) {
    const json_t *value = json_object_get(object, key);
    *out = otherwise;
    if (!value)
        return true;
    double x = json_number_value(value);
    if (!json_is_number(value) || !(x >= 0 && x <= 0x1p53 && x == floor(x)))
        return gltf_fail(g, where, "%s is not a whole number >= 0", key);
    *out = (uint64_t)x;
    return true;
}

bool gltf_index(const struct gltf *g, const json_t *object, const char *key, const char *of, uint32_t *out,
                const char *where) {
    uint64_t index, count = json_array_size(gltf_array(g, of));
    if (!gltf_whole(g, object, key, UINT64_MAX, &index, where))
        return false;
    *out = MODEL_NONE;
    if (index == UINT64_MAX)
        return true;
    if (index >= count)
        return gltf_fail(g, where, "%s is %llu, but there are only %llu %s", key, (unsigned long long)index,
                         (unsigned long long)count, of);
    *out = (uint32_t)index;
    return true;
}

bool gltf_numbers(const struct gltf *g, const json_t *object, const char *key, double *out, int count,
                  const char *where) {
    const json_t *array = json_object_get(object, key);
    if (!array)
        return true;
    if (!json_is_array(array) || json_array_size(array) != (size_t)count)
        return gltf_fail(g, where, "%s is not an array of %d numbers", key, count);
    for (int i = 0; i < count; i++) {
        const json_t *value = json_array_get(array, (size_t)i);
        assert(isfinite(json_number_value(value))); /* JSON has only finite numbers; 0 if it is not a number */
        if (!json_is_number(value))
            return gltf_fail(g, where, "%s[%d] is not a finite number", key, i);
        out[i] = json_number_value(value);
    }
    return true;
}

/* --- meshes --- */

struct primitive {
    char where[96];
    uint32_t position, normal, uv, colour, indices, material;
    uint64_t mode;
};

static bool read_primitive(struct gltf *g, const json_t *source, struct primitive *p) {
    const json_t *attributes = json_object_get(source, "attributes");
    return gltf_index(g, attributes, "POSITION", "accessors", &p->position, p->where) &&
           gltf_index(g, attributes, "NORMAL", "accessors", &p->normal, p->where) &&
           gltf_index(g, attributes, "TEXCOORD_0", "accessors", &p->uv, p->where) &&
           gltf_index(g, attributes, "COLOR_0", "accessors", &p->colour, p->where) &&
           gltf_index(g, source, "indices", "accessors", &p->indices, p->where) &&
           gltf_index(g, source, "material", "materials", &p->material, p->where) &&
           gltf_whole(g, source, "mode", 4, &p->mode, p->where);
}

static bool produce(struct gltf *g, uint64_t count, const char *where) {
    uint64_t limit = g->bytes * MADE_PER_BYTE + MADE_FREE;
    if (count > limit || g->produced > limit - count)
        return gltf_fail(g, where, "more vertices than a file of %llu bytes can describe",
                         (unsigned long long)g->bytes);
    g->produced += count;
    return true;
}

/* The vertices that a primitive uses, as a list or as a range. */
struct corners {
    uint32_t *index; /* NULL: 0, 1, 2 ... */
    uint64_t count, first, vertices;
    uint64_t available; /* number of vertices in the accessors */
};

static bool read_corners(struct gltf *g, const struct primitive *p, uint64_t available, struct corners *out) {
    *out = (struct corners){.count = available, .vertices = available, .available = available};
    if (p->indices == MODEL_NONE)
        return produce(g, 2 * available, p->where);
    struct gltf_accessor a;
    if (!gltf_accessor(g, p->indices, &a) || !produce(g, a.count, p->where))
        return false;
    out->count = a.count;
    out->index = mem_alloc((size_t)a.count * sizeof *out->index);
    if (!out->index)
        return error_no_memory(g->error, g->path);
    if (!gltf_accessor_read_whole(g, p->indices, &a, out->index))
        return false;
    /* Only the vertices between the smallest and the largest index are read. */
    uint32_t min = UINT32_MAX, max = 0;
    for (uint64_t i = 0; i < a.count; i++) {
        min = out->index[i] < min ? out->index[i] : min;
        max = out->index[i] > max ? out->index[i] : max;
    }
    if (a.count && max >= available)
        return gltf_fail(g, p->where, "vertex %u, but there are only %llu, counted from 0", max,
                         (unsigned long long)available);
    out->first = a.count ? min : 0;
    out->vertices = a.count ? (uint64_t)max - min + 1 : 0;
    return produce(g, out->vertices, p->where);
}

/* Reads one attribute for the vertices of the primitive, `kept` numbers of each. */
struct attribute {
    double *numbers;
    int components; /* of each vertex */
};

static bool read_attribute(struct gltf *g, const struct primitive *p, uint32_t accessor, int min,
                           const struct corners *corners, struct attribute *out) {
    struct gltf_accessor a;
    if (!gltf_accessor(g, accessor, &a))
        return false;
    if (a.components < min || a.components > 4)
        return gltf_fail(g, p->where, "accessors[%u] has %d numbers an element, not %d", accessor, a.components, min);
    if (a.count != corners->available)
        return gltf_fail(g, p->where, "accessors[%u] has %llu elements for %llu vertices", accessor,
                         (unsigned long long)a.count, (unsigned long long)corners->available);
    /* Every primitive that uses the accessor reads its sparse part once. */
    if (!produce(g, a.sparse_count, p->where))
        return false;
    size_t count;
    bool beyond = __builtin_mul_overflow((size_t)corners->vertices, (size_t)a.components, &count);
    assert(!beyond); /* produce() bounds the vertices */
    (void)beyond;
    out->numbers = mem_alloc_zero(count, sizeof *out->numbers);
    if (!out->numbers)
        return error_no_memory(g->error, g->path);
    out->components = a.components;
    return gltf_accessor_read(g, accessor, &a, corners->first, corners->vertices, out->numbers);
}

static bool append(struct gltf *g, struct list *list, const double *from, uint64_t count, int components, int kept) {
    double *to = list_room(list, (size_t)count, (size_t)kept * sizeof *to);
    if (!to)
        return error_no_memory(g->error, g->path);
    for (uint64_t i = 0; i < count; i++)
        for (int k = 0; k < kept; k++)
            *to++ = from[i * (uint64_t)components + (uint64_t)k];
    list->count += count;
    return true;
}

static bool append_colours(struct gltf *g, struct list *list, const double *from, uint64_t count, int components) {
    float *to = list_room(list, (size_t)count, 3 * sizeof *to);
    if (!to)
        return error_no_memory(g->error, g->path);
    for (uint64_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            double x = from ? from[i * (uint64_t)components + (uint64_t)k] : 1;
            *to++ = (float)(x < 0 ? 0 : x > 1 ? 1 : x);
        }
    list->count += count;
    return true;
}

/* The attributes that all primitives of a mesh must have so that its tables stay parallel. */
struct mesh_plan {
    bool normals, uvs, colours;
};

static bool add_vertices(struct gltf *g, const struct primitive *p, const struct corners *corners,
                         const struct mesh_plan *plan, struct model_mesh *mesh) {
    const struct {
        uint32_t accessor;
        int min, kept;
        struct list *list;
        bool colour;
    } tables[] = {{p->position, 3, 3, &mesh->vertices, false},
                  {p->normal, 3, 3, &mesh->normals, false},
                  {p->uv, 2, 2, &mesh->uvs, false},
                  {p->colour, 3, 3, &mesh->colours, true}};
    for (size_t t = 0; t < sizeof tables / sizeof tables[0]; t++) {
        struct attribute attribute = {0};
        bool given = tables[t].accessor != MODEL_NONE;
        if (!given && !(tables[t].colour && plan->colours))
            continue;
        bool ok = !given || read_attribute(g, p, tables[t].accessor, tables[t].min, corners, &attribute);
        double *numbers = attribute.numbers;
        int components = attribute.components;
        for (uint64_t i = 0; ok && t == 2 && i < corners->vertices; i++) /* v from below */
            numbers[i * (uint64_t)components + 1] = 1 - numbers[i * (uint64_t)components + 1];
        ok = ok &&
             (tables[t].colour ? append_colours(g, tables[t].list, numbers, corners->vertices, components)
                               : append(g, tables[t].list, numbers, corners->vertices, components, tables[t].kept));
        mem_free(numbers);
        if (!ok)
            return false;
    }
    return true;
}

/* The first indices of this primitive's vertices in the tables, and its material. */
struct buffer_bases {
    uint32_t vertex, normal, uv;
    uint32_t slot;
};

static bool add_triangle(struct gltf *g, struct model_mesh *mesh, const struct mesh_plan *plan,
                         const struct buffer_bases *bases, const uint32_t corner[3]) {
    uint32_t *start = list_room(&mesh->starts, 1, sizeof *start);
    uint32_t *index = list_room(&mesh->vertex_index, 3, sizeof *index);
    uint32_t *normal = plan->normals ? list_room(&mesh->normal_index, 3, sizeof *normal) : NULL;
    uint32_t *uv = plan->uvs ? list_room(&mesh->uv_index, 3, sizeof *uv) : NULL;
    if (!start || !index || (plan->normals && !normal) || (plan->uvs && !uv) ||
        !list_add_index(&mesh->face_slot, bases->slot))
        return error_no_memory(g->error, g->path);
    *start = (uint32_t)mesh->vertex_index.count;
    mesh->starts.count++;
    mesh->vertex_index.count += 3;
    for (int k = 0; k < 3; k++) {
        index[k] = bases->vertex + corner[k];
        if (normal)
            normal[k] = bases->normal == MODEL_NONE ? MODEL_NONE : bases->normal + corner[k];
        if (uv)
            uv[k] = bases->uv == MODEL_NONE ? MODEL_NONE : bases->uv + corner[k];
    }
    mesh->normal_index.count += normal ? 3 : 0;
    mesh->uv_index.count += uv ? 3 : 0;
    return true;
}

static bool add_triangles(struct gltf *g, const struct primitive *p, const struct corners *corners,
                          const struct mesh_plan *plan, const struct buffer_bases *bases, struct model_mesh *mesh) {
    uint64_t step = p->mode == 4 ? 3 : 1;
    for (uint64_t i = 0; i + 2 < corners->count; i += step) {
        uint64_t at[3] = {i, i + 1, i + 2};
        if (p->mode == 5 && i % 2)
            at[1] = i + 2, at[2] = i + 1;
        if (p->mode == 6)
            at[0] = 0;
        uint32_t corner[3];
        for (int k = 0; k < 3; k++)
            corner[k] = (uint32_t)((corners->index ? corners->index[at[k]] : at[k]) - corners->first);
        bool line = corner[0] == corner[1] || corner[1] == corner[2] || corner[0] == corner[2];
        if (!line && !add_triangle(g, mesh, plan, bases, corner))
            return false;
    }
    return true;
}

static bool add_primitive(struct gltf *g, const struct primitive *p, const struct mesh_plan *plan, uint32_t slot,
                          struct model_mesh *mesh) {
    struct gltf_accessor a;
    if (p->position == MODEL_NONE)
        return gltf_fail(g, p->where, "it has no POSITION");
    if (!gltf_accessor(g, p->position, &a))
        return false;
    struct corners corners;
    struct buffer_bases bases = {(uint32_t)mesh->vertices.count,
                                 p->normal == MODEL_NONE ? MODEL_NONE : (uint32_t)mesh->normals.count,
                                 p->uv == MODEL_NONE ? MODEL_NONE : (uint32_t)mesh->uvs.count, slot};
    bool ok = read_corners(g, p, a.count, &corners);
    if (ok && mesh->vertices.count + corners.vertices > model_max(g->model))
        ok = gltf_fail(g, p->where, "too many vertices");
    ok = ok && add_vertices(g, p, &corners, plan, mesh) && add_triangles(g, p, &corners, plan, &bases, mesh);
    mem_free(corners.index);
    return ok;
}

/* The slot of a material in this mesh. A mesh has few materials: a linear search finds them. */
static bool slot_of(struct gltf *g, struct model_mesh *mesh, uint32_t material, uint32_t *slot) {
    uint32_t *slots = mesh->slots.items;
    if (material == MODEL_NONE)
        material = (uint32_t)g->model->materials.count - 1;
    size_t first = mesh->slots.count > 256 ? mesh->slots.count - 256 : 0;
    for (size_t i = first; i < mesh->slots.count; i++)
        if (slots[i] == material) {
            *slot = (uint32_t)i;
            return true;
        }
    *slot = (uint32_t)mesh->slots.count;
    const char **name = list_room(&mesh->slot_names, 1, sizeof *name);
    if (!name || !list_add_index(&mesh->slots, material))
        return error_no_memory(g->error, g->path);
    *name = model_materials(g->model)[material].name;
    mesh->slot_names.count++;
    return true;
}

static bool read_mesh(struct gltf *g, size_t number, const json_t *source) {
    const json_t *primitives = json_object_get(source, "primitives");
    const char *name = json_string_value(json_object_get(source, "name"));
    struct model_mesh *mesh = model_add_mesh(g->model, g->error);
    if (!mesh)
        return false;
    if (name) {
        mesh->name = arena_format(&g->model->arena, "%s: mesh '%.200s'", g->path, name);
        if (!mesh->name)
            return error_no_memory(g->error, g->path);
    }
    struct mesh_plan plan = {0};
    struct primitive p;
    /* The first pass finds what the mesh has: its arrays are the same for all primitives. */
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < json_array_size(primitives); i++) {
            (void)snprintf(p.where, sizeof p.where, "meshes[%zu].primitives[%zu]", number, i);
            if (!read_primitive(g, json_array_get(primitives, i), &p))
                return false;
            if (p.mode > 6)
                return gltf_fail(g, p.where, "the mode %llu is unknown", (unsigned long long)p.mode);
            if (p.mode < 4) {
                if (pass == 0)
                    model_warn(g->model, "%s: %s: points and lines are not shown", g->path, p.where);
                continue;
            }
            plan.normals |= p.normal != MODEL_NONE;
            plan.uvs |= p.uv != MODEL_NONE;
            plan.colours |= p.colour != MODEL_NONE;
            uint32_t slot;
            if (pass == 1 && (!slot_of(g, mesh, p.material, &slot) || !add_primitive(g, &p, &plan, slot, mesh)))
                return false;
        }
    return true;
}

/* --- nodes --- */

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
    /* In a file without scenes, the nodes without a parent are the roots. */
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

static bool read_nodes(struct gltf *g) {
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

/* --- the file --- */

static bool check_extensions(const struct gltf *g) {
    static const char *const known[] = {
        "KHR_materials_ior",        "KHR_materials_transmission", "KHR_materials_specular",
        "KHR_materials_volume",     "KHR_materials_unlit",        "KHR_materials_emissive_strength",
        "KHR_texture_transform",    "KHR_mesh_quantization",      "KHR_materials_clearcoat",
        "KHR_materials_sheen",      "KHR_lights_punctual",        "KHR_materials_iridescence",
        "KHR_materials_anisotropy", "KHR_materials_dispersion",
    };
    const json_t *required = gltf_array(g, "extensionsRequired");
    for (size_t i = 0; i < json_array_size(required); i++) {
        const char *name = json_string_value(json_array_get(required, i));
        bool found = false;
        for (size_t k = 0; name && k < sizeof known / sizeof known[0]; k++)
            found |= strcmp(name, known[k]) == 0;
        if (!found)
            return gltf_fail(g, "extensionsRequired", "the file needs '%.100s', which is not supported",
                             name ? name : "something without a name");
    }
    return true;
}

/* One warning each for extensions that would change the picture. */
static void warn_of_extensions(const struct gltf *g) {
    static const char *const without_effect[] = {"KHR_lights_punctual",
                                                 "KHR_materials_iridescence",
                                                 "KHR_materials_anisotropy",
                                                 "KHR_materials_dispersion",
                                                 "KHR_materials_pbrSpecularGlossiness",
                                                 "KHR_materials_diffuse_transmission",
                                                 "KHR_texture_basisu",
                                                 "EXT_texture_webp",
                                                 "EXT_mesh_gpu_instancing",
                                                 "KHR_materials_variants"};
    const json_t *used = gltf_array(g, "extensionsUsed");
    for (size_t i = 0; i < json_array_size(used); i++) {
        const char *name = json_string_value(json_array_get(used, i));
        for (size_t k = 0; name && k < sizeof without_effect / sizeof *without_effect; k++)
            if (strcmp(name, without_effect[k]) == 0)
                model_warn(g->model, "%s: %s is not read", g->path, name);
    }
}

static bool load(struct gltf *g) {
    const char *version = json_string_value(json_object_get(json_object_get(g->root, "asset"), "version"));
    if (!version || version[0] != '2')
        return gltf_fail(g, "asset", "glTF of version 2 is read, this file is of version '%.20s'",
                         version ? version : "none");
    if (!check_extensions(g))
        return false;
    warn_of_extensions(g);
    g->buffer_count = json_array_size(gltf_array(g, "buffers"));
    g->buffers = mem_alloc_zero(g->buffer_count ? g->buffer_count : 1, sizeof *g->buffers);
    if (!g->buffers)
        return error_no_memory(g->error, g->path);
    if (!gltf_read_materials(g))
        return false;
    const json_t *meshes = gltf_array(g, "meshes");
    for (size_t i = 0; i < json_array_size(meshes); i++)
        if (!read_mesh(g, i, json_array_get(meshes, i)))
            return false;
    return read_nodes(g);
}

/* Bounds the memory that jansson needs before it starts. */
static bool check_json(const struct gltf *g, const char *text, size_t size) {
    size_t objects = 0, values = 0;
    bool string = false;
    for (size_t i = 0; i < size; i++) {
        if (string && text[i] == '\\')
            i++;
        else if (text[i] == '"')
            string = !string;
        else if (!string) {
            objects += text[i] == '{' || text[i] == '[';
            values += text[i] == ',';
        }
    }
    if (objects > OBJECT_LIMIT || values > VALUE_LIMIT)
        return gltf_fail(g, "its JSON", "more than %d objects or %d values", OBJECT_LIMIT, VALUE_LIMIT);
    return true;
}

/* jansson reports lack of memory as a syntax error, and its allocator has no context for an error. Hence this
 * variable outside of struct gltf; it is valid from the start of a parse to its end. */
static _Thread_local bool json_memory_failed;

static void *json_memory(size_t size) {
    void *block = mem_alloc(size);
    json_memory_failed |= block == NULL;
    return block;
}

static bool parse_json(struct gltf *g, const char *text, size_t size) {
    if (!check_json(g, text, size))
        return false;
    /* jansson allocates from base/mem.h. Its hash seed depends on all bytes of the file, so that a file cannot contain
     * names that collide, and the library needs no random numbers. */
    json_set_alloc_funcs(json_memory, mem_free);
    json_object_seed((size_t)hash_bytes(text, size, 1) | 1);
    json_error_t error;
    json_memory_failed = false;
    g->root = json_loadb(text, size, 0, &error);
    if (json_memory_failed) /* characters may be missing then even if the text seems complete */
        return error_no_memory(g->error, g->path);
    if (g->root)
        return json_is_object(g->root) || gltf_fail(g, "its JSON", "an object must be at the top");
    for (char *c = error.text; *c; c++)
        if ((unsigned char)*c < 0x20 || *c == 0x7f)
            *c = '?';
    return error_set(g->error, ERROR_SCENE, "%s:%d: broken JSON: %s", g->path, error.line, error.text);
}

/* The two chunks of a GLB (section 4.4); a file with another start is JSON as a whole. */
static bool split(struct gltf *g, const uint8_t *data, size_t size, const char **text, size_t *length) {
    *text = (const char *)data;
    *length = size;
    if (size >= 3 && memcmp(data, "\xef\xbb\xbf", 3) == 0)
        *text += 3, *length -= 3;
    if (size < 4 || memcmp(data, "glTF", 4) != 0)
        return true;
    if (size < 20)
        return gltf_fail(g, "byte 0", "a GLB has at least 20 bytes, this has %zu", size);
    uint32_t version = scan_u32(data + 4, false), whole = scan_u32(data + 8, false);
    if (version != 2)
        return gltf_fail(g, "byte 4", "GLB of version 2 is read, this is of version %u", version);
    if (whole > size)
        return gltf_fail(g, "byte 8", "the file promises %u bytes, but has only %zu", whole, size);
    /* The chunks: JSON, then at most one of bytes; others are skipped. */
    size_t at = 12;
    for (int chunk = 0; at + 8 <= whole; chunk++) {
        size_t bytes = scan_u32(data + at, false);
        uint32_t kind = scan_u32(data + at + 4, false);
        if (bytes > whole - at - 8) {
            char where[40];
            (void)snprintf(where, sizeof where, "byte %zu", at);
            return gltf_fail(g, where, "a chunk of %zu bytes, but only %zu follow", bytes, whole - at - 8);
        }
        if (chunk == 0 && kind != 0x4e4f534a)
            return gltf_fail(g, "byte 12", "the first chunk is not JSON");
        if (chunk == 0) {
            *text = (const char *)data + at + 8;
            *length = bytes;
        } else if (kind == 0x004e4942 && !g->binary) {
            g->binary = data + at + 8;
            g->binary_size = bytes;
        }
        at += 8 + bytes;
    }
    return true;
}

const char *gltf_library(void) {
    return "jansson " JANSSON_VERSION;
}

bool gltf_load(struct model *model, const uint8_t *data, size_t size, struct error *error) {
    struct gltf g = {.model = model, .path = model->path, .error = error, .bytes = size};
    const char *text;
    size_t length;
    bool ok = split(&g, data, size, &text, &length) && parse_json(&g, text, length) && load(&g);
    for (size_t i = 0; g.buffers && i < g.buffer_count; i++) {
        mem_free(g.buffers[i].decoded);
        file_unmap(&g.buffers[i].file);
    }
    for (size_t i = 0; g.images && i < g.image_count; i++)
        image_release(g.images[i]);
    mem_free(g.buffers);
    mem_free(g.images);
    json_decref(g.root);
    return ok;
}

#endif
