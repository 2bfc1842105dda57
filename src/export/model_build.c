#include "export/model_build.h"

#include "base/mem.h"
#include "csg/csg_build.h"
#include "export/solid_cast_internal.h"
#include "export/solid_mesh_internal.h"
#include "math/elementary.h"
#include "mesh/mesh.h"

#include <stdio.h>
#include <string.h>

enum { WORLD_LEAVES = 65535 };

struct model_builder {
    const struct model_build_input *input;
    struct export_model *out;
    double tolerance;
    uint32_t *cluster;     /* by primitive: the first one of those that it is united with */
    uint32_t *material_of; /* by material of the world: number in the model and 1, or 0 */
    struct csg_leaf *leaves;
    struct csg_token *program;
    uint32_t leaf_count, length;
};

/* --- what can be printed --- */

static bool check_primitive(const struct world *world, uint32_t primitive, struct error *error) {
    const struct geometry *geometry = primitive_geometry(world, primitive);
    const struct mesh *mesh = geometry_mesh(geometry);
    const char *name = primitive_node(world, primitive)->name;
    const struct box *box = &world->boxes[primitive];
    char edges[600];
    if (mesh && mesh_is_open(mesh)) {
        mesh_describe_open_edges(mesh, edges, sizeof edges);
        return error_set(error, ERROR_SCENE, "node '%.100s' is no solid, because its mesh is open: %s", name, edges);
    }
    if (!geometry_is_closed(geometry))
        return error_set(error, ERROR_SCENE, "node '%.100s' is no solid, because it %s", name,
                         geometry->csg ? "is clipped, cut open without caps; intersect it instead"
                                       : shape_why_open(&geometry->shape));
    if (!vec3_finite(box->min) || !vec3_finite(box->max) || (geometry->csg && geometry->csg->inside_out))
        return error_set(error, ERROR_SCENE, "node '%.100s' has no end, so it cannot be written as a model", name);
    return true;
}

static struct box box_of_all(const struct world *world) {
    struct box box = box_empty();
    for (uint32_t i = 0; i < world->primitive_count; i++)
        box = box_join(box, world->boxes[i]);
    return box;
}

/* --- clusters --- */

static uint32_t first_of(const struct model_builder *b, uint32_t primitive) {
    while (b->cluster[primitive] != primitive)
        primitive = b->cluster[primitive];
    return primitive;
}

static bool boxes_touch(const struct box *a, const struct box *b) {
    struct box both = box_meet(*a, *b);
    return !box_is_empty(&both);
}

/* Those whose boxes touch, directly or through others. */
static void find_clusters(const struct model_builder *b) {
    const struct world *world = b->input->world;
    for (uint32_t i = 0; i < world->primitive_count; i++) {
        b->cluster[i] = i;
        for (uint32_t k = 0; k < i; k++) {
            if (!boxes_touch(&world->boxes[i], &world->boxes[k]))
                continue;
            uint32_t one = first_of(b, i), other = first_of(b, k);
            b->cluster[one > other ? one : other] = one < other ? one : other;
        }
    }
}

/* --- materials --- */

/* Names in files: of the material if it has one, and different. */
static void name_material(const struct model_builder *b, uint32_t number, uint32_t index, char out[64]) {
    const struct material *material = b->input->world->authored.materials[index];
    (void)snprintf(out, 64, "m%u%s%.40s", number + 1, material->name ? "_" : "", material->name ? material->name : "");
    for (char *at = out; *at; at++) {
        bool fine = (*at >= 'a' && *at <= 'z') || (*at >= 'A' && *at <= 'Z') || (*at >= '0' && *at <= '9');
        *at = fine || strchr("_-.", *at) ? *at : '_';
    }
}

static double encode_srgb(double light) {
    return light <= 0.0031308 ? 12.92 * light : 1.055 * el_pow(light, 1 / 2.4) - 0.055;
}

/* The number in the model of a material of the world; UINT32_MAX: no memory. */
static uint32_t number_material(struct model_builder *b, uint32_t index) {
    const struct surface_tables *surfaces = &b->input->world->surfaces;
    if (b->material_of[index])
        return b->material_of[index] - 1;
    uint32_t number = (uint32_t)b->out->materials.count;
    struct export_material *material = list_room(&b->out->materials, 1, sizeof *material);
    if (!material)
        return UINT32_MAX;
    struct colour diffuse = surface_diffuse(surfaces, &surfaces->materials[index]);
    const double parts[3] = {diffuse.r, diffuse.g, diffuse.b};
    material->diffuse = diffuse;
    for (int k = 0; k < 3; k++) {
        double shown = b->input->linear ? encode_srgb(parts[k]) : parts[k];
        material->display[k] = (uint8_t)(fmin(fmax(shown, 0), 1) * 255 + 0.5);
    }
    name_material(b, number, index, material->name);
    b->out->materials.count++;
    b->material_of[index] = number + 1;
    return number;
}

/* --- parts --- */

/* A mesh becomes a part; material_of gives the material of the world for the surface of a triangle. */
static bool add_part(struct model_builder *b, const struct export_part *about, const struct solid_mesh *mesh,
                     uint32_t (*material_of)(const struct model_builder *b, uint32_t surface), struct error *error) {
    struct export_part *part = list_room(&b->out->parts, 1, sizeof *part);
    bool ok = part != NULL;
    if (ok) {
        *part = *about;
        b->out->parts.count++;
    }
    ok = ok && list_room(&part->points, mesh->vertices.count, sizeof(struct vec3)) &&
         list_room(&part->triangles, mesh->triangles.count, sizeof(struct export_triangle)) &&
         solid_mesh_is_closed(mesh, &part->closed, error);
    for (uint32_t i = 0; ok && i < mesh->vertices.count; i++)
        ((struct vec3 *)part->points.items)[part->points.count++] = solid_vertex_at(mesh, i)->point;
    for (uint32_t i = 0; ok && i < mesh->triangles.count; i++) {
        const struct solid_triangle *at = solid_triangle_at(mesh, i);
        uint32_t material = number_material(b, material_of(b, at->surface));
        ok = material != UINT32_MAX;
        if (ok)
            ((struct export_triangle *)part->triangles.items)[part->triangles.count++] =
                (struct export_triangle){{at->vertex[0], at->vertex[1], at->vertex[2]}, material};
    }
    return ok || error_no_memory(error, "a model");
}

static uint32_t material_of_leaf(const struct model_builder *b, uint32_t surface) {
    return b->leaves[solid_leaf(surface)].material;
}

static uint32_t material_of_slot(const struct model_builder *b, uint32_t slot) {
    return b->leaves[0].material + (b->leaves[0].slot_count > 1 ? slot : 0);
}

/* Adds the solid of a primitive to the program, in the space of the world. False: too many. */
static bool add_leaves(struct model_builder *b, uint32_t primitive) {
    const struct world *world = b->input->world;
    const struct prototype *prototype = primitive_prototype(world, primitive);
    const struct csg *csg = prototype->geometry.csg;
    struct transform map = world_placement(world, primitive, 0);
    uint32_t first = b->leaf_count, count = csg ? csg->leaf_count : 1;
    if (count > WORLD_LEAVES - first)
        return false;
    for (uint32_t i = 0; i < count; i++) {
        struct csg_leaf *leaf = &b->leaves[b->leaf_count++];
        if (csg)
            *leaf = csg->leaves[i];
        else
            *leaf = (struct csg_leaf){.shape = prototype->geometry.shape,
                                      .csg_from_leaf = transform_identity(),
                                      .material = prototype->material,
                                      .slot_count = prototype->slot_count};
        leaf->csg_from_leaf = transform_compose(&map, &leaf->csg_from_leaf);
        leaf->limit = NULL;
    }
    const struct csg_token own = {.operation = CSG_LEAF};
    const struct csg_token *program = csg ? csg->program : &own;
    for (uint32_t i = 0; i < (csg ? csg->program_length : 1); i++) {
        struct csg_token token = program[i];
        token.leaf = (uint16_t)(token.operation == CSG_LEAF ? token.leaf + first : 0);
        b->program[b->length++] = token;
    }
    if (first > 0)
        b->program[b->length++] = (struct csg_token){.operation = CSG_UNION};
    return true;
}

/* The leaves and the program of a cluster, as one solid in the space of the world. */
static const struct csg *unite(struct model_builder *b, uint32_t first, struct error *error) {
    const struct world *world = b->input->world;
    b->leaf_count = b->length = 0;
    for (uint32_t i = first; i < world->primitive_count; i++) {
        if (b->cluster[i] != first || add_leaves(b, i))
            continue;
        error_set(error, ERROR_SCENE, "solids that touch have more than %d operands together", WORLD_LEAVES);
        return NULL;
    }
    return csg_build(b->input->arena, b->leaves, b->leaf_count, b->program, b->length, error);
}

/* The triangles of a mesh as they are, with the vertices that its file has. */
static bool add_mesh(struct model_builder *b, const struct mesh *mesh, struct export_part *about, struct error *error) {
    struct solid_mesh own = {0};
    bool ok =
        solid_mesh_of_triangles(mesh, &b->leaves[0].csg_from_leaf.forward, &own) || error_no_memory(error, "a model");
    ok = ok && add_part(b, about, &own, material_of_slot, error);
    solid_mesh_destroy(&own);
    return ok;
}

static void note_separation(const struct model_builder *b, const char *name, const struct solid_findings *findings) {
    char text[512];
    struct vec3 at = findings->position;
    (void)snprintf(text, sizeof text,
                   "node '%.100s': its surface touches itself, for example at (%.6g, %.6g, %.6g); the parts are %.3g "
                   "apart there in the model",
                   name, at.x, at.y, at.z, 0.3 * b->tolerance);
    b->input->notice(b->input->context, text);
}

static bool add_solid(struct model_builder *b, struct export_part *about, struct error *error) {
    const struct solid_input input = {about->csg, about->name, b->tolerance, b->input->pool};
    struct solid_mesh mesh;
    struct solid_findings findings;
    if (!solid_mesh_build(&input, &mesh, &findings, error))
        return false;
    if (findings.separated > 0 && b->input->notice)
        note_separation(b, about->name, &findings);
    bool ok = add_part(b, about, &mesh, material_of_leaf, error);
    solid_mesh_destroy(&mesh);
    return ok;
}

static bool add_cluster(struct model_builder *b, uint32_t first, struct error *error) {
    const struct world *world = b->input->world;
    uint32_t members = 0;
    for (uint32_t i = first; i < world->primitive_count; i++)
        members += b->cluster[i] == first;
    if (members == 0)
        return true;
    struct export_part about = {.name = members == 1 ? primitive_node(world, first)->name : b->input->name,
                                .csg = unite(b, first, error)};
    const struct mesh *mesh = members == 1 ? geometry_mesh(primitive_geometry(world, first)) : NULL;
    return about.csg && (mesh ? add_mesh(b, mesh, &about, error) : add_solid(b, &about, error));
}

static bool add_clusters(struct model_builder *b, struct error *error) {
    uint32_t count = b->input->world->primitive_count;
    bool ok = true;
    find_clusters(b);
    for (uint32_t i = 0; i < count; i++)
        b->cluster[i] = first_of(b, i);
    for (uint32_t i = 0; ok && i < count; i++)
        ok = add_cluster(b, i, error);
    return ok;
}

static bool choose_tolerance(struct model_builder *b, struct error *error) {
    struct box box = box_of_all(b->input->world);
    double size = vec3_max_abs(vec3_sub(box.max, box.min));
    double far = fmax(vec3_max_abs(box.min), vec3_max_abs(box.max));
    b->tolerance = b->out->tolerance = b->input->tolerance > 0 ? b->input->tolerance : size / 1000;
    if (b->tolerance < 0x1p-20 * far)
        return error_set(error, ERROR_SCENE,
                         "the tolerance %g is too small for coordinates up to %g: models have numbers of single "
                         "precision",
                         b->tolerance, far);
    return true;
}

static bool make_room(struct model_builder *b, struct error *error) {
    const struct world *world = b->input->world;
    size_t leaves = 0, tokens = 0;
    for (uint32_t i = 0; i < world->primitive_count; i++) {
        const struct csg *csg = primitive_geometry(world, i)->csg;
        leaves += csg ? csg->leaf_count : 1;
        tokens += csg ? csg->program_length + 1 : 2;
    }
    b->cluster = mem_alloc(world->primitive_count * sizeof *b->cluster);
    b->material_of = mem_alloc_zero(world->material_count, sizeof *b->material_of);
    b->leaves = mem_alloc_zero(leaves, sizeof *b->leaves);
    b->program = mem_alloc_zero(tokens, sizeof *b->program);
    return (b->cluster && b->material_of && b->leaves && b->program) || error_no_memory(error, "a model");
}

bool model_build(const struct model_build_input *input, struct export_model *out, struct error *error) {
    struct model_builder b = {.input = input, .out = out};
    *out = (struct export_model){0};
    if (input->world->primitive_count == 0)
        return error_set(error, ERROR_SCENE, "node '%.100s' is empty: there is nothing to write", input->name);
    for (uint32_t i = 0; i < input->world->primitive_count; i++)
        if (!check_primitive(input->world, i, error))
            return false;
    bool ok = choose_tolerance(&b, error) && make_room(&b, error) && add_clusters(&b, error);
    mem_free(b.cluster);
    mem_free(b.material_of);
    mem_free(b.leaves);
    mem_free(b.program);
    if (!ok)
        export_model_destroy(out);
    return ok;
}
