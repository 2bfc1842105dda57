/* Poses of primitives: their maps, at a time if they move, and their boxes in the world. */
#include "base/hash.h"
#include "base/mem.h"
#include "world/flatten_internal.h"
#include "world/world_internal.h"

#include <string.h>

static struct transform moved(const struct world *world, const struct moving *moving, double ray_time) {
    double time = shutter_time(world->shutter, ray_time);
    struct transform out = moving->link_from_object;
    for (uint32_t number = moving->link; number != LINK_NONE; number = world->links[number].above) {
        const struct moving_link *link = &world->links[number];
        struct transform by = motion_at(&link->motion, time);
        out = transform_compose(&by, &out);
        out = transform_compose(&link->above_from_node, &out);
    }
    return out;
}

struct transform world_placement(const struct world *world, uint32_t primitive, double ray_time) {
    const struct primitive *p = &world->primitives[primitive];
    if (p->linear == LINEAR_NONE)
        return transform_identity();
    if (p->linear & LINEAR_MOVING)
        return moved(world, &world->moving[p->linear & ~LINEAR_MOVING], ray_time);
    const struct linear_map *map = &world->linear_maps[p->linear];
    struct transform out;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            out.forward.m[i][j] = map->forward[i][j];
            out.inverse.m[i][j] = map->inverse[i][j];
        }
        out.forward.m[i][3] = vec3_get(p->shift, i);
        out.inverse.m[i][3] = vec3_get(p->shift_back, i);
    }
    return out;
}

struct ray world_ray_of_moving(const struct world *world, uint32_t primitive, const struct ray *ray) {
    struct transform world_from_object = world_placement(world, primitive, ray->time);
    return ray_transform(&world_from_object.inverse, ray);
}

/* The box of everything that a moving primitive covers while the shutter is open: link by link, ignoring how the
 * motions of two links depend on each other, so the box may be too large, never too small. */
static struct box moving_bounds(const struct world *world, const struct geometry *geometry,
                                const struct moving *moving) {
    struct box box = box_pad(geometry_bounds_under(geometry, &moving->link_from_object.forward));
    for (uint32_t number = moving->link; number != LINK_NONE; number = world->links[number].above) {
        const struct moving_link *link = &world->links[number];
        box = box_pad(motion_bounds(&link->motion, &box, world->shutter));
        box = box_pad(box_transform(&link->above_from_node.forward, &box));
    }
    return box;
}

/* The tightest box of a mesh looks at all its corners: done for the first placements, until so many triangles have been
 * looked at; the others take the box of the mapped box. Polls for cancellation between two of them. */
enum { EXACT_AT_ONCE = 1 << 20, EXACT_IN_ALL = 1 << 22 };

static struct box primitive_bounds(const struct world *world, uint32_t primitive, uint32_t *exact) {
    const struct geometry *geometry = primitive_geometry(world, primitive);
    uint32_t linear = world->primitives[primitive].linear;
    if (linear != LINEAR_NONE && (linear & LINEAR_MOVING))
        return moving_bounds(world, geometry, &world->moving[linear & ~LINEAR_MOVING]);
    struct transform world_from_object = world_placement(world, primitive, 0);
    const struct mesh *mesh = geometry_mesh(geometry);
    uint32_t triangles = mesh ? mesh_triangle_count(mesh) : UINT32_MAX;
    if (linear != LINEAR_NONE && triangles <= EXACT_AT_ONCE && triangles <= *exact) {
        *exact -= triangles;
        return box_pad(mesh_bounds_under(mesh, &world_from_object.forward));
    }
    return box_pad(geometry_bounds_under(geometry, &world_from_object.forward));
}

bool world_update_box(struct world *world, uint32_t primitive) {
    bool exact = world->triangles <= EXACT_IN_ALL; /* then those of all meshes are, up to EXACT_AT_ONCE */
    uint32_t at_once = EXACT_AT_ONCE;
    if (!exact && geometry_mesh(primitive_geometry(world, primitive)))
        return false;
    struct box box = primitive_bounds(world, primitive, &at_once);
    world->boxes[primitive] = box_is_empty(&box) ? box_empty() : box;
    return true;
}

/* What a run over chunks of primitives and prototypes finds. */
enum { CHUNK = 4096 };
struct box_chunk {
    uint32_t scratch_need;
    bool has_meshes; /* their boxes are still to be made: they share EXACT_IN_ALL, in order */
};
struct box_run {
    struct world *world;
    const struct box *limits; /* or NULL */
    uint32_t chunks;          /* of primitives; those of prototypes follow */
    struct box_chunk *found;
};

static void set_box(const struct box_run *run, uint32_t primitive, struct box box) {
    if (run->limits)
        box = box_meet(box, box_pad(run->limits[primitive]));
    run->world->boxes[primitive] = box_is_empty(&box) ? box_empty() : box;
}

static uint32_t chunk_end(uint32_t chunk, uint32_t count) {
    return count - chunk * CHUNK < CHUNK ? count : (chunk + 1) * CHUNK;
}

static void measure_primitives(const struct box_run *run, uint32_t chunk) {
    const struct world *world = run->world;
    for (uint32_t i = chunk * CHUNK; i < chunk_end(chunk, world->primitive_count); i++) {
        uint32_t no_mesh = 0;
        if (geometry_mesh(primitive_geometry(world, i)))
            run->found[chunk].has_meshes = true;
        else
            set_box(run, i, primitive_bounds(world, i, &no_mesh));
    }
}

static void measure_prototypes(const struct box_run *run, uint32_t chunk) {
    struct world *world = run->world;
    uint32_t *need = &run->found[run->chunks + chunk].scratch_need;
    for (uint32_t i = chunk * CHUNK; i < chunk_end(chunk, world->prototype_count); i++) {
        uint32_t own = geometry_scratch_need(&world->prototypes[i].geometry);
        *need = own > *need ? own : *need;
        world->prototypes[i].convexity = geometry_convexity(&world->prototypes[i].geometry);
    }
}

static void measure_chunk(void *context, uint32_t item, int worker) {
    const struct box_run *run = context;
    (void)worker;
    if (item < run->chunks)
        measure_primitives(run, item);
    else
        measure_prototypes(run, item - run->chunks);
}

static bool measure_meshes(const struct box_run *run, uint32_t chunk, uint32_t *exact, const struct pool *pool) {
    struct world *world = run->world;
    for (uint32_t i = chunk * CHUNK; i < chunk_end(chunk, world->primitive_count); i++) {
        const struct mesh *mesh = geometry_mesh(primitive_geometry(world, i));
        uint32_t before = *exact;
        if (!mesh)
            continue;
        set_box(run, i, primitive_bounds(world, i, exact));
        world->triangles += mesh_triangle_count(mesh);
        if (before != *exact && pool_cancelled(pool))
            return false;
    }
    return true;
}

/* Small scenes are measured by this thread. */
static bool measure_all(const struct box_run *run, uint32_t items, struct pool *pool) {
    struct box_run own = *run;
    uint32_t exact = EXACT_IN_ALL;
    bool ok = true;
    if (items > 2)
        ok = pool_run(pool, items, measure_chunk, &own);
    else
        for (uint32_t item = 0; item < items; item++)
            measure_chunk(&own, item, 0);
    for (uint32_t chunk = 0; ok && chunk < run->chunks; chunk++)
        ok = !run->found[chunk].has_meshes || measure_meshes(run, chunk, &exact, pool);
    return ok;
}

bool world_primitive_boxes(struct world *world, const struct box *limits, struct pool *pool, struct error *error) {
    uint32_t chunks = (world->primitive_count + CHUNK - 1) / CHUNK;
    uint32_t items = chunks + (world->prototype_count + CHUNK - 1) / CHUNK;
    const struct box_run run = {world, limits, chunks, mem_alloc_zero((size_t)items + 1, sizeof *run.found)};
    world->moves = world->moving_count > 0;
    if (!run.found)
        return error_no_memory(error, "the boxes of the scene");
    bool ok = measure_all(&run, items, pool);
    for (uint32_t item = 0; item < items; item++)
        world->scratch_need =
            run.found[item].scratch_need > world->scratch_need ? run.found[item].scratch_need : world->scratch_need;
    mem_free(run.found);
    return ok || error_set(error, ERROR_CANCELLED, "stopped while the scene was measured");
}

/* Placements as a translation and the number of a linear map: a million pots in rows share one map, and cost 56 bytes
 * each instead of 192 for a map with its inverse. A hash over the bits finds equal maps; the newest is tested first. */

struct linear_table {
    uint32_t *slots; /* number of a map and 1, or 0 */
    uint64_t mask;
};

static uint64_t hash_of(const struct linear_map *map) {
    return hash_bytes(map, sizeof map->forward + sizeof map->inverse, 0);
}

static bool same(const struct linear_map *a, const struct linear_map *b) {
    return memcmp(a, b, sizeof a->forward + sizeof a->inverse) == 0;
}

static uint32_t *find(const struct flattening *f, const struct linear_map *map) {
    const struct linear_table *table = f->linear_table;
    uint64_t at = hash_of(map) & table->mask;
    while (table->slots[at] && !same(&f->world->linear_maps[table->slots[at] - 1], map))
        at = (at + 1) & table->mask;
    return &table->slots[at];
}

/* Room for one more map, in the list and in the table, which is at most half full. */
static bool grow(struct flattening *f) {
    struct world *world = f->world;
    if (world->linear_count < f->linear_capacity)
        return true;
    uint32_t capacity = f->linear_capacity ? f->linear_capacity * 2 : 64;
    struct linear_map *maps = mem_resize_array(world->linear_maps, capacity, sizeof *maps);
    if (!maps)
        return false;
    world->linear_maps = maps;
    if (!f->linear_table && !(f->linear_table = mem_alloc_zero(1, sizeof *f->linear_table)))
        return false;
    uint32_t *slots = mem_alloc_zero((size_t)capacity * 2, sizeof *slots);
    if (!slots)
        return false;
    mem_free(f->linear_table->slots);
    *f->linear_table = (struct linear_table){slots, (uint64_t)capacity * 2 - 1};
    f->linear_capacity = capacity;
    for (uint32_t i = 0; i < world->linear_count; i++)
        *find(f, &maps[i]) = i + 1;
    return true;
}

bool flatten_map(struct flattening *f, const struct transform *world_from_object, struct primitive *out) {
    struct transform nothing = transform_identity();
    struct world *world = f->world;
    if (memcmp(&nothing, world_from_object, sizeof nothing) == 0) {
        out->linear = LINEAR_NONE;
        return true;
    }
    struct linear_map map = {.stretch = transform_stretch(world_from_object)};
    const double(*forward)[4] = world_from_object->forward.m, (*inverse)[4] = world_from_object->inverse.m;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            map.forward[i][j] = forward[i][j];
            map.inverse[i][j] = inverse[i][j];
        }
    }
    out->shift = vec3_make(forward[0][3], forward[1][3], forward[2][3]);
    out->shift_back = vec3_make(inverse[0][3], inverse[1][3], inverse[2][3]);
    out->linear = world->linear_count - 1;
    if (world->linear_count > 0 && same(&map, &world->linear_maps[out->linear]))
        return true;
    if (!grow(f))
        return error_no_memory(f->error, "the positions of the primitives");
    uint32_t *slot = find(f, &map);
    if (*slot == 0) {
        world->linear_maps[world->linear_count++] = map;
        *slot = world->linear_count;
    }
    out->linear = *slot - 1;
    return true;
}

void linear_table_destroy(struct linear_table *table) {
    if (table)
        mem_free(table->slots);
    mem_free(table);
}

void flatten_map_end(struct flattening *f) {
    struct flatten_log *log = f->log;
    if (log && log->on) {
        log->linear_table = f->linear_table;
        log->linear_capacity = f->linear_capacity;
        log->linear_count = f->world->linear_count;
        f->linear_table = NULL;
        return;
    }
    linear_table_destroy(f->linear_table);
    f->linear_table = NULL;
    /* Frees the unused part of the list; on failure it is kept. */
    struct world *world = f->world;
    struct linear_map *maps = mem_resize_array(world->linear_maps, world->linear_count, sizeof *maps);
    world->linear_maps = maps ? maps : world->linear_maps;
}
