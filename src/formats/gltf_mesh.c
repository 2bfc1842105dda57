/* The meshes of glTF: triangles, strips and fans of all primitives in one table. Source: Khronos Group, "glTF 2.0
 * Specification" (ISO/IEC 12113:2022), section 3.7.2. */
#ifdef HAVE_JANSSON

#include "formats/gltf_mesh_internal.h"

#include "formats/gltf_data_internal.h"

#include <assert.h>
#include <stdio.h>

struct primitive {
    char where[96];
    const json_t *source;
    uint32_t position, normal, uv, second_uv, colour, indices, material;
    uint32_t joints[2], weights[2]; /* four joints of a vertex each */
    uint64_t mode;
};

/* The material of the chosen variant, if the primitive has one of its own for it. */
static bool read_variant(struct gltf *g, struct primitive *p) {
    const json_t *extension = json_object_get(json_object_get(p->source, "extensions"), "KHR_materials_variants");
    const json_t *mappings = json_object_get(extension, "mappings");
    for (size_t i = 0; g->variant != MODEL_NONE && i < json_array_size(mappings); i++) {
        const json_t *mapping = json_array_get(mappings, i), *variants = json_object_get(mapping, "variants");
        if (!gltf_produce(g, 1 + json_array_size(variants), p->where))
            return false;
        for (size_t k = 0; k < json_array_size(variants); k++)
            if (json_integer_value(json_array_get(variants, k)) == (json_int_t)g->variant)
                return gltf_index(g, mapping, "material", "materials", &p->material, p->where);
    }
    return true;
}

static bool read_primitive(struct gltf *g, const json_t *source, struct primitive *p) {
    const json_t *attributes = json_object_get(source, "attributes");
    p->source = source;
    if (json_object_get(attributes, "JOINTS_2"))
        gltf_lacks(g, p->where, "only the first 8 joints of a vertex are read");
    return gltf_index(g, attributes, "JOINTS_0", "accessors", &p->joints[0], p->where) &&
           gltf_index(g, attributes, "JOINTS_1", "accessors", &p->joints[1], p->where) &&
           gltf_index(g, attributes, "WEIGHTS_0", "accessors", &p->weights[0], p->where) &&
           gltf_index(g, attributes, "WEIGHTS_1", "accessors", &p->weights[1], p->where) &&
           gltf_index(g, attributes, "POSITION", "accessors", &p->position, p->where) &&
           gltf_index(g, attributes, "NORMAL", "accessors", &p->normal, p->where) &&
           gltf_index(g, attributes, "TEXCOORD_0", "accessors", &p->uv, p->where) &&
           gltf_index(g, attributes, "TEXCOORD_1", "accessors", &p->second_uv, p->where) &&
           gltf_index(g, attributes, "COLOR_0", "accessors", &p->colour, p->where) &&
           gltf_index(g, source, "indices", "accessors", &p->indices, p->where) &&
           gltf_index(g, source, "material", "materials", &p->material, p->where) && read_variant(g, p) &&
           gltf_whole(g, source, "mode", 4, &p->mode, p->where);
}

/* Leaves out attributes whose bytes only an unknown extension has. False: the primitive cannot be shown. */
static bool keep_readable(struct gltf *g, struct primitive *p) {
    if (json_array_size(gltf_array(g, "extensionsUsed")) == 0 && !json_object_get(p->source, "extensions"))
        return true;
    uint32_t *attributes[] = {&p->normal, &p->uv, &p->second_uv, &p->colour, &p->joints[0], &p->joints[1]};
    if ((p->position != MODEL_NONE && !gltf_has_bytes(g, p->position)) ||
        (p->indices != MODEL_NONE && !gltf_has_bytes(g, p->indices))) {
        gltf_lacks(g, p->where, "it is left out: the file does not have its vertices in a form that gray reads");
        return false;
    }
    for (size_t i = 0; i < sizeof attributes / sizeof attributes[0]; i++)
        if (*attributes[i] != MODEL_NONE && !gltf_has_bytes(g, *attributes[i])) {
            gltf_lacks(g, p->where, "an attribute is left out: the file does not have it in a form that gray reads");
            *attributes[i] = MODEL_NONE;
        }
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
        return gltf_produce(g, 2 * available, p->where);
    struct gltf_accessor a;
    if (!gltf_accessor(g, p->indices, &a) || !gltf_produce(g, a.count, p->where))
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
    return gltf_produce(g, out->vertices, p->where);
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
    if (!gltf_produce(g, a.sparse_count, p->where))
        return false;
    size_t count;
    bool beyond = __builtin_mul_overflow((size_t)corners->vertices, (size_t)a.components, &count);
    assert(!beyond); /* gltf_produce() bounds the vertices */
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

/* --- deformation --- */

/* Adds the weighted differences of the morph targets. */
static bool morph(struct gltf *g, const struct primitive *p, const struct corners *corners, const char *attribute,
                  const struct gltf_deformation *by, struct attribute *to) {
    const json_t *targets = json_object_get(p->source, "targets");
    for (size_t k = 0; k < by->weight_count && k < json_array_size(targets); k++) {
        const json_t *target = json_array_get(targets, k);
        uint32_t accessor;
        if (json_object_get(target, "TEXCOORD_0") || json_object_get(target, "COLOR_0"))
            gltf_lacks(g, p->where, "morphs of colours and of texture coordinates are not read");
        if (by->weights[k] == 0)
            continue;
        if (!gltf_index(g, target, attribute, "accessors", &accessor, p->where))
            return false;
        struct attribute by_target = {0};
        bool ok = accessor == MODEL_NONE || (gltf_produce(g, corners->vertices, p->where) &&
                                             read_attribute(g, p, accessor, 3, corners, &by_target));
        for (uint64_t i = 0; ok && by_target.numbers && i < corners->vertices; i++)
            for (uint64_t c = 0; c < 3; c++)
                to->numbers[i * (uint64_t)to->components + c] +=
                    by->weights[k] * by_target.numbers[i * (uint64_t)by_target.components + c];
        mem_free(by_target.numbers);
        if (!ok)
            return false;
    }
    return true;
}

/* The joints and weights of the vertices. */
struct skinning {
    struct attribute joints[2], weights[2];
};

static bool read_skinning(struct gltf *g, const struct primitive *p, const struct corners *corners,
                          const struct gltf_deformation *by, struct skinning *out) {
    for (int k = 0; by->joints && k < 2; k++) {
        if (p->joints[k] == MODEL_NONE || p->weights[k] == MODEL_NONE)
            continue;
        if (!read_attribute(g, p, p->joints[k], 4, corners, &out->joints[k]) ||
            !read_attribute(g, p, p->weights[k], 4, corners, &out->weights[k]))
            return false;
        for (uint64_t i = 0; i < 4 * corners->vertices; i++) {
            double joint = out->joints[k].numbers[i];
            if (out->weights[k].numbers[i] != 0 && !(joint >= 0 && joint < (double)by->joint_count))
                return gltf_fail(g, p->where, "joint %.0f, but the skin has only %zu", joint, by->joint_count);
        }
    }
    return true;
}

static void skinning_destroy(struct skinning *skinning) {
    for (int k = 0; k < 2; k++) {
        mem_free(skinning->joints[k].numbers);
        mem_free(skinning->weights[k].numbers);
    }
}

/* The weighted mean of the maps of a vertex's joints; the first joint if it has no weight. */
static struct affine mean_of_joints(const struct skinning *skinning, uint64_t vertex, const struct affine *joints) {
    struct affine sum = {0};
    double total = 0;
    for (int k = 0; k < 2 && skinning->joints[k].numbers; k++)
        for (uint64_t i = 4 * vertex; i < 4 * vertex + 4; i++) {
            double weight = skinning->weights[k].numbers[i];
            if (weight == 0)
                continue;
            const struct affine *joint = &joints[(size_t)skinning->joints[k].numbers[i]];
            total += weight;
            for (int row = 0; row < 3; row++)
                for (int column = 0; column < 4; column++)
                    sum.m[row][column] += weight * joint->m[row][column];
        }
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++)
            sum.m[row][column] /= total;
    return total != 0 ? sum : joints[0];
}

/* Normals as the triangles around them turn: by the cofactors, which exist without an inverse, too. */
static struct vec3 turn_normal(const struct affine *map, struct vec3 normal) {
    const double(*m)[4] = map->m;
    struct vec3 x = {m[0][0], m[1][0], m[2][0]}, y = {m[0][1], m[1][1], m[2][1]}, z = {m[0][2], m[1][2], m[2][2]};
    return vec3_add_scaled(vec3_add_scaled(vec3_scale(vec3_cross(y, z), normal.x), vec3_cross(z, x), normal.y),
                           vec3_cross(x, y), normal.z);
}

/* Positions or normals under the maps of the joints, or under the flat one. */
static void deform(const struct corners *corners, const struct skinning *skinning, const struct gltf_deformation *by,
                   bool is_normal, struct attribute *to) {
    for (uint64_t i = 0; i < corners->vertices; i++) {
        double *at = to->numbers + i * (uint64_t)to->components;
        struct vec3 v = {at[0], at[1], at[2]};
        struct affine map = skinning->joints[0].numbers ? mean_of_joints(skinning, i, by->joints) : *by->projection;
        v = is_normal ? turn_normal(&map, v) : affine_point(&map, v);
        at[0] = v.x, at[1] = v.y, at[2] = v.z;
    }
}

/* The attributes that all primitives of a mesh must have so that its tables stay parallel. */
struct mesh_plan {
    bool normals, uvs, second_uvs, colours;
};

static bool add_vertices(struct gltf *g, const struct primitive *p, const struct corners *corners,
                         const struct mesh_plan *plan, const struct gltf_deformation *by, struct model_mesh *mesh) {
    enum { POSITION, NORMAL, UV, SECOND_UV, COLOUR };
    struct skinning skinning = {0};
    /* Beside others with second coordinates, the first ones are both. */
    uint32_t second = !plan->second_uvs || p->second_uv == MODEL_NONE ? p->uv : p->second_uv;
    const struct {
        uint32_t accessor;
        int min, kept;
        struct list *list;
    } tables[] = {[POSITION] = {p->position, 3, 3, &mesh->vertices},
                  [NORMAL] = {p->normal, 3, 3, &mesh->normals},
                  [UV] = {p->uv, 2, 2, &mesh->uvs},
                  [SECOND_UV] = {plan->second_uvs ? second : MODEL_NONE, 2, 2, &mesh->second_uvs},
                  [COLOUR] = {p->colour, 3, 3, &mesh->colours}};
    bool fine = read_skinning(g, p, corners, by, &skinning), moves = by->projection || skinning.joints[0].numbers;
    for (size_t t = 0; fine && t < sizeof tables / sizeof tables[0]; t++) {
        struct attribute attribute = {0};
        bool given = tables[t].accessor != MODEL_NONE;
        if (!given && !(t == COLOUR && plan->colours))
            continue;
        bool ok = !given || read_attribute(g, p, tables[t].accessor, tables[t].min, corners, &attribute);
        if (ok && t <= NORMAL)
            ok = morph(g, p, corners, t == NORMAL ? "NORMAL" : "POSITION", by, &attribute);
        if (ok && t <= NORMAL && moves)
            deform(corners, &skinning, by, t == NORMAL, &attribute);
        double *numbers = attribute.numbers;
        int components = attribute.components;
        for (uint64_t i = 0; ok && (t == UV || t == SECOND_UV) && i < corners->vertices; i++) /* v from below */
            numbers[i * (uint64_t)components + 1] = 1 - numbers[i * (uint64_t)components + 1];
        bool opaque = true;
        for (uint64_t i = 0; ok && t == COLOUR && components == 4 && i < corners->vertices; i++)
            opaque = opaque && numbers[i * 4 + 3] >= 1;
        if (!opaque)
            gltf_lacks(g, p->where, "the alpha of the colours of vertices is not read");
        fine = ok && (t == COLOUR ? append_colours(g, tables[t].list, numbers, corners->vertices, components)
                                  : append(g, tables[t].list, numbers, corners->vertices, components, tables[t].kept));
        mem_free(numbers);
    }
    skinning_destroy(&skinning);
    return fine;
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
                          const struct gltf_deformation *by, struct model_mesh *mesh) {
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
    ok = ok && add_vertices(g, p, &corners, plan, by, mesh) && add_triangles(g, p, &corners, plan, &bases, mesh);
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

bool gltf_read_mesh(struct gltf *g, uint32_t number, const struct gltf_deformation *by) {
    const json_t *source = json_array_get(gltf_array(g, "meshes"), number);
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
            (void)snprintf(p.where, sizeof p.where, "meshes[%u].primitives[%zu]", number, i);
            /* A look at a primitive and its targets takes as long as some vertices, and many nodes may need one. */
            if (!gltf_produce(g, 16 * (1 + (uint64_t)by->weight_count), p.where) ||
                !read_primitive(g, json_array_get(primitives, i), &p))
                return false;
            if (p.mode > 6)
                return gltf_fail(g, p.where, "the mode %llu is unknown", (unsigned long long)p.mode);
            if (p.mode < 4) {
                if (pass == 0)
                    gltf_lacks(g, p.where, "points and lines are not shown");
                continue;
            }
            if (!keep_readable(g, &p))
                continue;
            if (p.uv == MODEL_NONE)
                p.uv = p.second_uv;
            plan.normals |= p.normal != MODEL_NONE;
            plan.uvs |= p.uv != MODEL_NONE;
            plan.second_uvs |= p.second_uv != MODEL_NONE;
            plan.colours |= p.colour != MODEL_NONE;
            uint32_t slot;
            if (pass == 1 && (!slot_of(g, mesh, p.material, &slot) || !add_primitive(g, &p, &plan, slot, by, mesh)))
                return false;
        }
    return true;
}

#else
/* This file is empty without jansson. */
typedef int gltf_mesh_is_empty;
#endif
