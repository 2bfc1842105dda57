/* See mesh_group.h. In rooms of small meshes nearly every ray hits one. There, the hierarchy over boxes and the starts
 * of searches in several meshes cost more than the triangle tests. */
#include "world/mesh_group.h"

#include "base/mem.h"
#include "world/world_describe.h"

/* A group costs every ray the start of a search, so it needs several members and most of the scene; its triangles are
 * stored twice. */
enum { MIN_MEMBERS = 4, MAX_TRIANGLES = 4096 };

/* The number of triangles that a primitive contributes; 0: it is not a member. */
static uint32_t triangles_of(const struct world *world, uint32_t primitive) {
    const struct prototype *prototype = primitive_prototype(world, primitive);
    const struct mesh *mesh = geometry_mesh(&prototype->geometry);
    if (!mesh || prototype->cull != CULL_NONE || prototype->holes || world->primitives[primitive].linear != LINEAR_NONE)
        return 0;
    return mesh_triangle_count(mesh);
}

/* Whether a group is useful, and its size. */
static bool is_worthwhile(const struct world *world, uint32_t *triangles) {
    uint32_t members = 0;
    *triangles = 0;
    if (world->triangles == 0)
        return false;
    for (uint32_t i = 0; i < world->primitive_count; i++) {
        uint32_t count = triangles_of(world, i);
        if (count > MAX_TRIANGLES - *triangles)
            return false;
        *triangles += count;
        members += count > 0;
    }
    return members >= MIN_MEMBERS && members > world->primitive_count / 2;
}

struct group_tables {
    double (*vertices)[3];
    uint32_t (*corners)[3], *first, *primitive;
    struct group_facet *facets;
};

static void fill(struct mesh_group *group, const struct world *world, const struct group_tables *tables) {
    uint32_t number = 0;
    group->set.bounds = box_empty();
    for (uint32_t i = 0; i < world->primitive_count; i++) {
        uint32_t count = triangles_of(world, i), slot;
        tables->first[i] = number;
        for (uint32_t k = 0; k < count; k++, number++) {
            struct vec3 corner[3];
            mesh_triangle(geometry_mesh(primitive_geometry(world, i)), k, corner, &slot);
            tables->primitive[number] = i;
            tables->facets[number] = world_facet(world, i, k);
            for (uint32_t j = 0; j < 3; j++) {
                double *vertex = tables->vertices[3 * number + j];
                vertex[0] = corner[j].x;
                vertex[1] = corner[j].y;
                vertex[2] = corner[j].z;
                tables->corners[number][j] = 3 * number + j;
                group->set.bounds = box_add_point(group->set.bounds, corner[j]);
            }
        }
    }
    tables->first[world->primitive_count] = number;
}

/* The hierarchy over all other primitives. */
static bool build_rest(struct mesh_group *group, const struct world *world, struct pool *pool, struct error *error) {
    struct box *boxes = mem_alloc((size_t)world->primitive_count * sizeof *boxes);
    if (!boxes)
        return error_no_memory(error, "the boxes of the scene");
    for (uint32_t i = 0; i < world->primitive_count; i++)
        boxes[i] = mesh_group_run(group, i).count > 0 ? box_empty() : world->boxes[i];
    bool ok = box_tree_build(&group->rest, boxes, world->primitive_count, pool, error);
    mem_free(boxes);
    return ok;
}

bool mesh_group_build(struct mesh_group *group, const struct world *world, struct arena *arena, struct pool *pool,
                      struct error *error) {
    uint32_t count;
    if (!is_worthwhile(world, &count))
        return true;
    struct group_tables tables = {
        .vertices = arena_alloc_array(arena, 3 * (size_t)count, sizeof *tables.vertices),
        .corners = arena_alloc_array(arena, count, sizeof *tables.corners),
        .first = arena_alloc_array(arena, (size_t)world->primitive_count + 1, sizeof *tables.first),
        .primitive = arena_alloc_array(arena, count, sizeof *tables.primitive),
        .facets = arena_alloc_array(arena, count, sizeof *tables.facets),
    };
    if (!tables.vertices || !tables.corners || !tables.first || !tables.primitive || !tables.facets)
        return error_no_memory(error, "the meshes of the scene");
    group->first = tables.first;
    group->primitive = tables.primitive;
    group->facets = tables.facets;
    group->set = (struct triangle_set){(const double(*)[3])tables.vertices, (const uint32_t(*)[3])tables.corners, count,
                                       box_empty()};
    fill(group, world, &tables);
    return build_rest(group, world, pool, error) && triangle_index_build(&group->index, &group->set, 1, pool, error);
}

void mesh_group_destroy(struct mesh_group *group) {
    triangle_index_destroy(group->index);
    box_tree_destroy(&group->rest);
    *group = (struct mesh_group){.index = NULL};
}

size_t mesh_group_memory(const struct mesh_group *group) {
    size_t triangle =
        3 * sizeof *group->set.vertices + sizeof *group->set.corners + sizeof *group->primitive + sizeof *group->facets;
    if (!group->index)
        return 0;
    return group->set.count * triangle + triangle_index_memory(group->index) + box_tree_memory(&group->rest);
}
