#include "export/primitive_mesh.h"

#include "base/arena.h"
#include "csg/csg_build.h"
#include "export/solid_mesh_internal.h"

bool solid_program_add(struct solid_program *program, const struct world *world, uint32_t primitive) {
    const struct prototype *prototype = primitive_prototype(world, primitive);
    const struct csg *csg = prototype->geometry.csg;
    struct transform map = world_placement(world, primitive, 0);
    uint32_t first = program->leaf_count, count = csg ? csg->leaf_count : 1;
    if (count > SOLID_LEAVES - first)
        return false;
    for (uint32_t i = 0; i < count; i++) {
        struct csg_leaf *leaf = &program->leaves[program->leaf_count++];
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
    const struct csg_token *tokens = csg ? csg->program : &own;
    for (uint32_t i = 0; i < (csg ? csg->program_length : 1); i++) {
        struct csg_token token = tokens[i];
        token.leaf = (uint16_t)(token.operation == CSG_LEAF ? token.leaf + first : 0);
        program->tokens[program->length++] = token;
    }
    if (first > 0)
        program->tokens[program->length++] = (struct csg_token){.operation = CSG_UNION};
    return true;
}

static bool add_corners(const struct solid_mesh *mesh, struct list *corners) {
    struct vec3 *out = list_room(corners, 3 * mesh->triangles.count, sizeof *out);
    for (uint32_t i = 0; out && i < 3 * mesh->triangles.count; i++)
        out[i] = solid_vertex_at(mesh, solid_triangle_at(mesh, i / 3)->vertex[i % 3])->point;
    corners->count += out ? 3 * mesh->triangles.count : 0;
    return out != NULL;
}

bool primitive_mesh_build(const struct world *world, uint32_t primitive, double tolerance, struct pool *pool,
                          struct list *corners, struct error *error) {
    const struct csg *csg = primitive_geometry(world, primitive)->csg;
    struct arena arena = {0};
    struct solid_program program = {
        .leaves = arena_alloc_array(&arena, csg ? csg->leaf_count : 1, sizeof *program.leaves),
        .tokens = arena_alloc_array(&arena, csg ? csg->program_length : 1, sizeof *program.tokens)};
    struct solid_input input = {.name = primitive_node(world, primitive)->name, .tolerance = tolerance, .pool = pool};
    struct solid_mesh mesh = {0};
    struct solid_findings findings;
    bool ok = (program.leaves && program.tokens) || error_no_memory(error, "the mesh of a solid");
    if (ok && solid_program_add(&program, world, primitive))
        input.csg = csg_build(&arena, program.leaves, program.leaf_count, program.tokens, program.length, error);
    ok = ok && input.csg && solid_mesh_build(&input, &mesh, &findings, error);
    if (ok && !add_corners(&mesh, corners))
        ok = error_no_memory(error, "the mesh of a solid");
    solid_mesh_destroy(&mesh);
    arena_destroy(&arena);
    return ok;
}
