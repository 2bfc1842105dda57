#include "export/model_build.h"

#include "base/arena.h"
#include "csg/csg_build.h"
#include "export/primitive_mesh.h"
#include "export/solid_cast_internal.h"
#include "export/solid_mesh_internal.h"
#include "export/triangles_internal.h"
#include "image/png_write.h"
#include "material/material_eval.h"
#include "mesh/mesh.h"
#include "world/world_describe.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

struct model_builder {
    const struct model_build_input *input;
    struct export_model *out;
    double tolerance;
    uint32_t *cluster;     /* by primitive: the first one of those that it is united with */
    uint32_t *material_of; /* by material of the world: number in the model and 1, or 0 */
    struct solid_program program;
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
    if (box_is_empty(box))
        return error_set(error, ERROR_SCENE, "node '%.100s' is empty: there is nothing to write", name);
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
    char name[64];
    (void)snprintf(name, 64, "m%u%s%.40s", number + 1, material->name ? "_" : "", material->name ? material->name : "");
    (void)export_plain_name(name, out);
}

static void encode(const struct model_builder *b, struct colour colour, uint8_t out[3]) {
    const struct tone tone = {.srgb = b->input->linear};
    for (int k = 0; k < 3; k++)
        out[k] = png_write_byte(tone_apply(&tone, colour_get(colour, k)));
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
    material->diffuse = surface_diffuse(surfaces, &surfaces->materials[index]);
    material->textured = surface_has_texture(&surfaces->materials[index], INPUT_KD);
    encode(b, material->diffuse, material->display);
    name_material(b, number, index, material->name);
    b->out->materials.count++;
    b->material_of[index] = number + 1;
    return number;
}

/* The colour of the surface near a point, on a line against the normal. */
static void colour_corner(const struct model_builder *b, struct world_scratch *scratch, struct vec3 point,
                          struct vec3 normal, uint8_t out[3]) {
    const struct world *world = b->input->world;
    struct surface_inputs inputs;
    struct hit hit;
    /* Nearby first: in a narrow gap, the other surface is further away. */
    for (double height = b->tolerance / 64; height <= 2 * b->tolerance; height *= 128) {
        struct ray ray = {
            .origin = vec3_add_scaled(point, normal, height), .direction = vec3_negate(normal), .t_max = 2 * height};
        if (!world_nearest_surface(world, &ray, scratch, &hit))
            continue;
        material_inputs_at(&world->surfaces, &world->surfaces.materials[hit.material], &hit, &inputs);
        encode(b, inputs.kd, out);
        return;
    }
}

/* Corners have the colour a little inside of their triangle, since the next one may have another material. */
static void colour_triangle(const struct model_builder *b, struct world_scratch *scratch,
                            const struct export_part *part, size_t triangle) {
    struct export_triangle *at = &export_triangles(part)[triangle];
    const struct export_material *material = (struct export_material *)b->out->materials.items + at->material;
    struct vec3 c[3];
    export_corners(part, triangle, c);
    struct vec3 normal = vec3_normalize(triangle_normal(c));
    struct vec3 middle = vec3_scale(vec3_add(c[0], vec3_add(c[1], c[2])), 1.0 / 3);
    for (int k = 0; k < 3; k++) {
        memcpy(at->display[k], material->display, 3);
        if (material->textured)
            colour_corner(b, scratch, vec3_add_scaled(c[k], vec3_sub(middle, c[k]), 0.01), normal, at->display[k]);
    }
}

static bool colour_corners(const struct model_builder *b, struct error *error) {
    struct world_scratch scratch;
    bool ok = world_scratch_init(&scratch, b->input->world);
    for (size_t i = 0; ok && i < b->out->parts.count; i++)
        for (size_t t = 0; t < export_parts(b->out)[i].triangles.count && !pool_cancelled(b->input->pool); t++)
            colour_triangle(b, &scratch, &export_parts(b->out)[i], t);
    ok = ok && !scratch.failed;
    world_scratch_destroy(&scratch);
    if (!ok)
        return error_no_memory(error, "the colours of a model");
    return !pool_cancelled(b->input->pool) || error_set(error, ERROR_CANCELLED, "stopped while a model was coloured");
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
        export_points(part)[part->points.count++] = solid_vertex_at(mesh, i)->point;
    for (uint32_t i = 0; ok && i < mesh->triangles.count; i++) {
        const struct solid_triangle *at = solid_triangle_at(mesh, i);
        uint32_t material = number_material(b, material_of(b, at->surface));
        ok = material != UINT32_MAX;
        if (ok)
            export_triangles(part)[part->triangles.count++] =
                (struct export_triangle){.vertex = {at->vertex[0], at->vertex[1], at->vertex[2]}, .material = material};
    }
    return ok || error_no_memory(error, "a model");
}

static uint32_t material_of_leaf(const struct model_builder *b, uint32_t surface) {
    return b->program.leaves[solid_leaf(surface)].material;
}

static uint32_t material_of_slot(const struct model_builder *b, uint32_t slot) {
    return b->program.leaves[0].material + (b->program.leaves[0].slot_count > 1 ? slot : 0);
}

/* The leaves and the program of a cluster, as one solid in the space of the world. */
static const struct csg *unite(struct model_builder *b, uint32_t first, struct error *error) {
    const struct world *world = b->input->world;
    b->program.leaf_count = b->program.length = 0;
    for (uint32_t i = first; i < world->primitive_count; i++) {
        if (b->cluster[i] != first || solid_program_add(&b->program, world, i))
            continue;
        error_set(error, ERROR_SCENE, "solids that touch have more than %d operands together", SOLID_LEAVES);
        return NULL;
    }
    return csg_build(b->input->arena, b->program.leaves, b->program.leaf_count, b->program.tokens, b->program.length,
                     error);
}

static void note(const struct model_builder *b, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void note(const struct model_builder *b, const char *format, ...) {
    char text[512];
    va_list values;
    va_start(values, format);
    (void)vsnprintf(text, sizeof text, format, values);
    va_end(values);
    if (b->input->notice)
        b->input->notice(b->input->context, text);
}

/* The triangles of a mesh as they are, with the vertices that its file has. */
static bool add_mesh(struct model_builder *b, const struct mesh *mesh, struct export_part *about, struct error *error) {
    struct solid_mesh own = {0};
    bool ok = solid_mesh_of_triangles(mesh, &b->program.leaves[0].csg_from_leaf.forward, &own) ||
              error_no_memory(error, "a model");
    ok = ok && add_part(b, about, &own, material_of_slot, error);
    solid_mesh_destroy(&own);
    if (ok && !export_parts(b->out)[b->out->parts.count - 1].closed)
        note(b, "node '%.100s': surfaces of its mesh meet in edges or vertices; slicers may repair it", about->name);
    return ok;
}

static bool add_solid(struct model_builder *b, struct export_part *about, struct error *error) {
    const struct solid_input input = {
        .csg = about->csg, .name = about->name, .tolerance = b->tolerance, .pool = b->input->pool};
    struct solid_mesh mesh;
    struct solid_findings findings;
    if (!solid_mesh_build(&input, &mesh, &findings, error))
        return false;
    if (findings.separated > 0)
        note(b,
             "node '%.100s': its surface touches itself, for example at (%.6g, %.6g, %.6g); the parts are %.3g apart "
             "there in the model",
             about->name, findings.position.x, findings.position.y, findings.position.z, 0.3 * b->tolerance);
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
    double far = math_max(vec3_max_abs(box.min), vec3_max_abs(box.max));
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
    struct arena *arena = b->input->arena;
    b->cluster = arena_alloc_array(arena, world->primitive_count, sizeof *b->cluster);
    b->material_of = arena_alloc_array(arena, world->material_count, sizeof *b->material_of);
    b->program.leaves = arena_alloc_array(arena, leaves, sizeof *b->program.leaves);
    b->program.tokens = arena_alloc_array(arena, tokens, sizeof *b->program.tokens);
    return (b->cluster && b->material_of && b->program.leaves && b->program.tokens) ||
           error_no_memory(error, "a model");
}

bool model_build(const struct model_build_input *input, struct export_model *out, struct error *error) {
    struct model_builder b = {.input = input, .out = out};
    *out = (struct export_model){0};
    if (input->world->primitive_count == 0)
        return error_set(error, ERROR_SCENE, "node '%.100s' is empty: there is nothing to write", input->name);
    for (uint32_t i = 0; i < input->world->primitive_count; i++)
        if (!check_primitive(input->world, i, error))
            return false;
    bool ok = choose_tolerance(&b, error) && make_room(&b, error) && add_clusters(&b, error) &&
              (!input->corners || colour_corners(&b, error));
    if (!ok)
        export_model_destroy(out);
    return ok;
}
