#include "world/device_search.h"

#include "base/key_map.h"
#include "base/mem.h"
#include "world/world_internal.h"

#include <string.h>

/* --- building --- */

struct building {
    const struct world *world;
    struct device_search *search;
    struct float_trees trees;
    struct pool *pool;
    struct error *error;
    struct key_map in_top; /* by address of a mesh: the primitive whose triangles are in the top */
    struct key_map rooted; /* the same of meshes with a hierarchy: its root */
    uint32_t *first;       /* by primitive: the number of the first of its triangles in the top, or NOT_IN_TOP */
    uint32_t *owners;      /* of the triangles in the top: their primitives */
    uint32_t triangles_in_top, triangles, triangle_room;
};
#define NOT_IN_TOP UINT32_MAX

/* The mesh of a primitive if it is plain; or NULL. */
static const struct mesh *plain_mesh(const struct world *world, uint32_t primitive) {
    const struct prototype *prototype = primitive_prototype(world, primitive);
    const struct mesh *mesh = geometry_mesh(&prototype->geometry);
    return mesh && prototype->cull == CULL_NONE && !prototype->holes && mesh_triangle_count(mesh) > 0 ? mesh : NULL;
}

static uint64_t key_of(const struct mesh *mesh) {
    return (uint64_t)(uintptr_t)mesh;
}

/* False: a bound cuts the mesh. Such a primitive is a leaf with its box. */
static bool is_whole(const struct world *world, uint32_t primitive, const struct mesh *mesh) {
    const struct box bounds = mesh_bounds(mesh), *box = &world->boxes[primitive];
    return (world->group.index && mesh_group_run(&world->group, primitive).count > 0) ||
           (box_contains(box, bounds.min) && box_contains(box, bounds.max));
}

/* Which meshes are in the top: of each the first primitive in world space. Meshes count once, or once more if other
 * primitives need their hierarchy; those beyond the limit are asked as a whole. */
static bool choose_meshes(struct building *b) {
    const struct world *world = b->world;
    for (uint32_t i = 0; i < world->primitive_count; i++) {
        const struct mesh *mesh = plain_mesh(world, i);
        b->first[i] = NOT_IN_TOP;
        if (!mesh)
            continue;
        const uint32_t count = mesh_triangle_count(mesh);
        const bool in_top = world->primitives[i].linear == LINEAR_NONE && is_whole(world, i, mesh) &&
                            !key_map_find(&b->in_top, key_of(mesh));
        if ((!in_top && key_map_find(&b->rooted, key_of(mesh))) || count > FLOAT_TREE_MANY - b->triangles)
            continue;
        if (!key_map_add(in_top ? &b->in_top : &b->rooted, key_of(mesh), in_top ? i : FLOAT_TREE_NONE))
            return false;
        b->triangles += count;
        if (in_top) {
            b->first[i] = b->triangles_in_top;
            b->triangles_in_top += count;
        }
    }
    return true;
}

static void put_triangle(struct building *b, uint32_t primitive, uint32_t part, const struct mesh *mesh) {
    struct device_triangle *triangle = &b->search->triangles[b->search->triangle_count++];
    struct vec3 corners[3];
    uint32_t slot;
    mesh_triangle(mesh, part, corners, &slot);
    *triangle = (struct device_triangle){.part = part, .primitive = primitive};
    memcpy(triangle->corners, corners, sizeof triangle->corners);
}

static void put_boxes(const struct mesh *mesh, struct box *boxes) {
    struct vec3 corners[3];
    uint32_t slot;
    for (uint32_t k = 0; k < mesh_triangle_count(mesh); k++) {
        mesh_triangle(mesh, k, corners, &slot);
        boxes[k] = box_add_point(box_add_point((struct box){corners[0], corners[0]}, corners[1]), corners[2]);
    }
}

static bool add_mesh(struct building *b, const struct mesh *mesh, uint32_t *root) {
    const uint32_t count = mesh_triangle_count(mesh);
    struct box *boxes = mem_alloc(count * sizeof *boxes);
    if (!boxes)
        return error_no_memory(b->error, "the scene for a device");
    put_boxes(mesh, boxes);
    const struct float_tree_items items = {boxes, count, 0};
    const bool ok = float_trees_add(&b->trees, &items, b->pool, root, b->error);
    mem_free(boxes);
    for (uint32_t k = b->search->triangle_count; ok && k < b->trees.order_count; k++)
        put_triangle(b, WORLD_NOTHING, b->trees.order[k], mesh);
    return ok;
}

static bool is_slow(const struct geometry *geometry) {
    const struct shape *shape = &geometry->shape;
    return geometry->csg || (!geometry_mesh(geometry) && (shape_is_listed(shape) || shape->kind == SHAPE_TORUS ||
                                                          shape->kind == SHAPE_SUPERELLIPSOID));
}

/* The hierarchies of meshes that are not, or not only, in the top. */
static bool add_meshes(struct building *b) {
    const struct world *world = b->world;
    uint32_t *roots = b->search->roots;
    for (uint32_t i = 0; i < world->prototype_count; i++) {
        roots[i] = is_slow(&world->prototypes[i].geometry) ? DEVICE_SLOW : FLOAT_TREE_NONE;
        b->search->has_slow = b->search->has_slow || roots[i] == DEVICE_SLOW;
    }
    for (uint32_t i = 0; i < world->primitive_count; i++) {
        const struct mesh *mesh = b->first[i] == NOT_IN_TOP ? plain_mesh(world, i) : NULL;
        uint32_t *root = mesh ? key_map_find(&b->rooted, key_of(mesh)) : NULL;
        if (root && *root == FLOAT_TREE_NONE && !add_mesh(b, mesh, root))
            return false;
        if (root)
            roots[world->primitives[i].prototype] = *root;
    }
    return true;
}

static bool add_top(struct building *b) {
    const struct world *world = b->world;
    const uint32_t primitives = world->primitive_count;
    struct box *boxes = mem_alloc(((size_t)primitives + b->triangles_in_top) * sizeof *boxes);
    if (!boxes)
        return error_no_memory(b->error, "the scene for a device");
    for (uint32_t i = 0; i < primitives; i++) {
        boxes[i] = b->first[i] == NOT_IN_TOP ? world->boxes[i] : box_empty();
        if (b->first[i] == NOT_IN_TOP)
            continue;
        const struct mesh *mesh = geometry_mesh(primitive_geometry(world, i));
        put_boxes(mesh, boxes + primitives + b->first[i]);
        for (uint32_t k = 0; k < mesh_triangle_count(mesh); k++)
            b->owners[b->first[i] + k] = i;
    }
    const struct float_tree_items items = {boxes, primitives + b->triangles_in_top, primitives};
    const bool ok = float_trees_add(&b->trees, &items, b->pool, &b->search->top, b->error);
    mem_free(boxes);
    for (uint32_t k = b->search->triangle_count; ok && k < b->trees.order_count; k++) {
        const uint32_t number = b->trees.order[k] - primitives, owner = b->owners[number];
        put_triangle(b, owner, number - b->first[owner], geometry_mesh(primitive_geometry(world, owner)));
    }
    return ok;
}

bool device_search_build(struct device_search *search, const struct world *world, struct pool *pool,
                         struct error *error) {
    struct building b = {.world = world, .search = search, .pool = pool, .error = error};
    *search = (struct device_search){.prototype_count = world->prototype_count, .top = FLOAT_TREE_NONE};
    search->roots = mem_alloc(world->prototype_count * sizeof *search->roots);
    b.first = mem_alloc(world->primitive_count * sizeof *b.first);
    bool ok = search->roots && b.first && choose_meshes(&b);
    search->triangles = ok ? mem_alloc_aligned(64, b.triangles * sizeof *search->triangles) : NULL;
    b.owners = mem_alloc(b.triangles_in_top * sizeof *b.owners);
    ok = search->triangles && b.owners ? add_meshes(&b) && add_top(&b)
                                       : error_no_memory(error, "the scene for a device");
    search->nodes = b.trees.nodes;
    search->node_count = b.trees.node_count;
    b.trees.nodes = NULL;
    float_trees_destroy(&b.trees);
    mem_free(b.owners);
    mem_free(b.first);
    key_map_destroy(&b.rooted);
    key_map_destroy(&b.in_top);
    if (!ok)
        device_search_destroy(search);
    return ok;
}

void device_search_destroy(struct device_search *search) {
    mem_free(search->nodes);
    mem_free(search->triangles);
    mem_free(search->roots);
    *search = (struct device_search){.nodes = NULL};
}

void device_search_bundle(struct bundle *bundle, void *device_search) {
    struct device_search *search = device_search;
    BUNDLE(bundle, search->nodes, search->node_count, NULL);
    BUNDLE(bundle, search->triangles, search->triangle_count, NULL);
    BUNDLE(bundle, search->roots, search->prototype_count, NULL);
}

struct world device_search_world(const struct device_search *search, const struct world *world) {
    struct world out = *world;
    out.accel = (struct scene_accel){.kind = ACCEL_NONE};
    out.group = (struct mesh_group){.index = NULL};
    out.device = search;
    return out;
}

/* --- searching --- */

/* Always constants where they are passed: each search is compiled without the other. */
enum search_mode { SEARCH_NEAREST, SEARCH_ANY };
#define FOR_EACH_MODE static inline __attribute__((always_inline))

enum { STACK = 2 * FLOAT_TREE_DEPTH + 2 }; /* both levels, and one entry below each */
#define STACK_END UINT32_MAX               /* below everything; the root of nothing, too */
#define STACK_RETURN (UINT32_MAX - 1)      /* below the hierarchy of a mesh */
_Static_assert(FLOAT_TREE_NONE == STACK_END, "nothing is searched in nothing");

/* The ray in one space. */
struct view {
    struct float_ray boxes;
    double origin[3], shear[3]; /* by the axes of the ray, for triangles */
    int x, y, z;
    bool meets_triangles; /* rays that are not finite meet none */
};

struct search {
    const struct world *world;
    const struct ray *ray;
    struct world_scratch *scratch;
    struct view outer, view; /* in the world, and in the space that is searched */
    uint32_t inside;         /* the primitive whose hierarchy is searched; WORLD_NOTHING: the top */
    /* SEARCH_NEAREST: */
    struct packet_answer *best;
    struct device_questions *questions; /* or NULL */
    double t_max;                       /* of limit_of */
};

/* No memory at an index that only the ray knows. */
static inline double along(const double v[3], int axis) {
    return axis == 0 ? v[0] : axis == 1 ? v[1] : v[2];
}

static void view_set(struct view *view, const struct ray *ray) {
    struct triangle_ray line;
    float_ray_set(&view->boxes, ray);
    view->meets_triangles = triangle_ray_init(&line, ray);
    if (!view->meets_triangles)
        return;
    view->x = line.x, view->y = line.y, view->z = line.z;
    view->origin[0] = along(line.origin, line.x);
    view->origin[1] = along(line.origin, line.y);
    view->origin[2] = along(line.origin, line.z);
    for (int i = 0; i < 3; i++)
        view->shear[i] = line.shear[i];
}

/* The numbers are those of triangle_cross. */
static inline bool crosses(const struct view *view, const struct device_triangle *triangle, struct triangle_hit *hit) {
    const double_pair *pairs = (const double_pair *)(const void *)triangle, p = pairs[0], q = pairs[1], r = pairs[2],
                      s = pairs[3];
    const double all[9] = {p[0], p[1], q[0], q[1], r[0], r[1], s[0], s[1], triangle->corners[8]};
    double seen[3][3];
    for (int i = 0; i < 3; i++) {
        seen[i][0] = along(all + 3 * i, view->x) - view->origin[0];
        seen[i][1] = along(all + 3 * i, view->y) - view->origin[1];
        seen[i][2] = along(all + 3 * i, view->z) - view->origin[2];
    }
    return triangle_cross_seen(view->shear, seen[0], seen[1], seen[2], hit);
}

/* Whether a hit there comes before the best one. */
static inline bool is_before(const struct packet_answer *best, double t, uint32_t primitive, uint32_t part) {
    const struct crossing *crossing = &best->crossing;
    return best->primitive == WORLD_NOTHING || t < crossing->t ||
           (t == crossing->t &&
            (primitive < best->primitive || (primitive == best->primitive && part < crossing->part)));
}

/* Where a search ends: just behind the best hit, so that an equal t is still found. */
static inline double limit_of(const struct ray *ray, const struct packet_answer *best) {
    const double t = best->crossing.t;
    if (best->primitive == WORLD_NOTHING)
        return ray->t_max;
    const double just_behind = t + fabs(t) * 0x1p-52;
    return just_behind < ray->t_max ? just_behind : ray->t_max;
}

/* True: the search is over. */
FOR_EACH_MODE bool try_run(struct search *s, uint32_t reference, enum search_mode mode) {
    const struct ray *ray = s->ray;
    const uint32_t first = reference & (FLOAT_TREE_MANY - 1);
    const uint32_t count = (reference >> FLOAT_TREE_RUN_SHIFT & (FLOAT_TREE_RUN - 1)) + 1;
    for (uint32_t i = first; i < first + count && s->view.meets_triangles; i++) {
        const struct device_triangle *triangle = &s->world->device->triangles[i];
        const uint32_t primitive = s->inside == WORLD_NOTHING ? triangle->primitive : s->inside;
        struct crossing crossing;
        if ((primitive + 1 == ray->skip_primitive && (ray->skip_part == 0 || triangle->part + 1 == ray->skip_part)) ||
            !crosses(&s->view, triangle, &crossing.on_mesh) || !(crossing.t > ray->t_min && crossing.t < ray->t_max))
            continue;
        if (mode == SEARCH_ANY)
            return true;
        if (!is_before(s->best, crossing.t, primitive, triangle->part))
            continue;
        crossing.part = triangle->part;
        crossing.flip = false;
        crossing.leaf = 0;
        *s->best = (struct packet_answer){crossing, primitive};
        s->t_max = limit_of(ray, s->best);
    }
    return false;
}

void device_search_keep(struct packet_answer *best, const struct packet_answer *answer) {
    if (answer->primitive != WORLD_NOTHING &&
        is_before(best, answer->crossing.t, answer->primitive, answer->crossing.part))
        *best = *answer;
}

__attribute__((noinline)) void device_search_ask(const struct device_query *query, uint32_t of,
                                                 const struct packet_answer *best, struct packet_answer *answer) {
    struct ray limited = *query->ray;
    limited.t_max = limit_of(query->ray, best);
    const struct ray ray_object = primitive_ray(query->world, of, &limited);
    const bool found = world_ask_nearest(query->world, of, &ray_object, query->scratch, &answer->crossing);
    answer->primitive = found ? of : WORLD_NOTHING;
}

/* What is rare or large stays out of the loop of the search. */
#define APART static __attribute__((noinline))

APART void enter_mesh(struct search *s, uint32_t primitive) {
    const struct ray ray_object = primitive_ray(s->world, primitive, s->ray);
    view_set(&s->view, &ray_object);
    s->inside = primitive;
}

APART bool ask_any(const struct search *s, uint32_t primitive) {
    return world_ask_any(s->world, primitive, s->ray, s->scratch);
}

APART void ask_nearest(struct search *s, uint32_t primitive) {
    struct packet_answer answer;
    device_search_ask(&(struct device_query){s->world, s->ray, s->scratch}, primitive, s->best, &answer);
    device_search_keep(s->best, &answer);
    s->t_max = limit_of(s->ray, s->best);
}

/* A primitive that is a leaf of the top. True: the search is over, or *root is to be searched in its space. */
FOR_EACH_MODE bool try_single(struct search *s, uint32_t primitive, enum search_mode mode, uint32_t *root) {
    const struct world *world = s->world;
    *root = FLOAT_TREE_NONE;
    if (ray_skips(s->ray, primitive))
        return false;
    *root = world->device->roots[world->primitives[primitive].prototype];
    const bool is_slow = *root == DEVICE_SLOW;
    if (is_slow)
        *root = FLOAT_TREE_NONE;
    if (*root != FLOAT_TREE_NONE) {
        enter_mesh(s, primitive);
        return true;
    }
    if (mode == SEARCH_ANY)
        return ask_any(s, primitive);
    if (is_slow && s->questions && s->questions->count < DEVICE_QUESTIONS)
        s->questions->primitives[s->questions->count++] = primitive;
    else
        ask_nearest(s, primitive);
    return false;
}

/* The nearer child of a node that the ray meets; of two the other one waits. */
static inline uint32_t next_below(const struct search *s, const struct float_node *node, float end, uint32_t *stack,
                                  uint32_t *height) {
    const struct float_ray *ray = &s->view.boxes;
    const float_quad *quads = (const float_quad *)(const void *)node, p = quads[0], q = quads[1], r = quads[2];
    const float boxes[2][6] = {{p[0], p[1], p[2], p[3], q[0], q[1]}, {q[2], q[3], r[0], r[1], r[2], r[3]}};
    const uint32_t left = node->child[0], right = node->child[1];
    float to_left, to_right;
    const bool meets_left = float_ray_meets(ray, boxes[0], end, &to_left);
    const bool meets_right = float_ray_meets(ray, boxes[1], end, &to_right);
    if (!meets_left && !meets_right)
        return stack[--*height];
    const bool right_first = meets_right && (!meets_left || to_right < to_left);
    if (meets_left && meets_right)
        stack[(*height)++] = right_first ? left : right;
    return right_first ? right : left;
}

FOR_EACH_MODE bool search(struct search *s, enum search_mode mode) {
    const struct device_search *device = s->world->device;
    uint32_t stack[STACK], height = 1, reference = device->top;
    stack[0] = STACK_END;
    s->inside = WORLD_NOTHING;
    s->t_max = s->ray->t_max;
    view_set(&s->outer, s->ray);
    s->view = s->outer;
    float end = float_ray_end(s->t_max);
    for (;;) {
        while (!(reference & FLOAT_TREE_LEAF))
            reference = next_below(s, &device->nodes[reference], end, stack, &height);
        if (reference == STACK_END)
            return false;
        if (reference == STACK_RETURN) {
            s->view = s->outer;
            s->inside = WORLD_NOTHING;
        } else if (!(reference & FLOAT_TREE_SINGLE)) {
            if (try_run(s, reference, mode))
                return true;
        } else {
            uint32_t root;
            const bool over = try_single(s, reference & ~(FLOAT_TREE_LEAF | FLOAT_TREE_SINGLE), mode, &root);
            if (over && root == FLOAT_TREE_NONE)
                return true;
            if (over) {
                stack[height++] = STACK_RETURN;
                reference = root;
                continue;
            }
        }
        if (mode == SEARCH_NEAREST)
            end = float_ray_end(s->t_max);
        reference = stack[--height];
    }
}

__attribute__((noinline)) void device_search_nearest(const struct device_query *query, struct packet_answer *answer,
                                                     struct device_questions *questions) {
    struct search s;
    s.world = query->world;
    s.ray = query->ray;
    s.scratch = query->scratch;
    s.best = answer;
    s.questions = questions;
    answer->primitive = WORLD_NOTHING;
    (void)search(&s, SEARCH_NEAREST);
}

bool device_search_crossing(const struct device_query *query, uint32_t *primitive, struct crossing *crossing) {
    struct packet_answer answer;
    device_search_nearest(query, &answer, NULL);
    *primitive = answer.primitive;
    *crossing = answer.crossing;
    return answer.primitive != WORLD_NOTHING;
}

__attribute__((noinline)) bool device_search_any(const struct world *world, const struct ray *ray,
                                                 struct world_scratch *scratch) {
    struct search s;
    s.world = world;
    s.ray = ray;
    s.scratch = scratch;
    return search(&s, SEARCH_ANY);
}
