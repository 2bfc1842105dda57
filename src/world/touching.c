/* See touching.h. Each prototype has a list of what its surface is made of. Two primitives are compared if their boxes
 * meet. Not compared: hairs; two opaque meshes of more than PLANES planes; opaque primitives in worlds of more than
 * OPAQUE_LIMIT. */
#include "world/touching.h"

#include "base/mem.h"
#include "mesh/mesh.h"
#include "world/flatten_material_internal.h"
#include "world/world_internal.h"

#include <stdio.h>
#include <string.h>

/* What a surface is made of. MADE_OF_ANYTHING: its surfaces may be equal to those of every other kind. */
enum made_of { MADE_OF_PLANES = 1, MADE_OF_ROUND = 2, MADE_OF_AXIAL = 4, MADE_OF_TORUS = 8, MADE_OF_ANYTHING = 16 };

enum { PLANES = 64, LISTED = 32, OPAQUE_LIMIT = 1 << 17 };
static const uint64_t plane_tests_limit = UINT64_C(1) << 24; /* of planes and triangles of large meshes, in all */

struct plane {
    struct vec3 point, normal; /* normal: unit */
};
struct axis {
    struct vec3 point, direction; /* direction: unit */
};

/* The surface of a prototype, in object space. */
struct make {
    unsigned kinds; /* a set of enum made_of */
    bool many;      /* it has more planes than are listed */
    /* How many of them are listed, and where they begin: planes, centres of round surfaces, axes. */
    uint32_t planes, centres, axes, first_plane, first_centre, first_axis;
};

struct pair {
    uint32_t a, b;
};

/* A list that grows. */
struct list {
    void *items;
    size_t count, capacity;
};

struct finder {
    const struct world *world;
    struct make *makes;                       /* of prototypes */
    struct list planes, centres, axes, pairs; /* struct plane, struct vec3, struct axis, struct pair */
    uint64_t plane_tests;
    bool failed;
};

/* False: no memory. */
static bool add_to(struct finder *f, struct list *list, const void *item, size_t size) {
    if (list->count == list->capacity) {
        size_t capacity = list->capacity ? 2 * list->capacity : 64;
        void *items = mem_resize_array(list->items, capacity, size);
        if (!items) {
            f->failed = true;
            return false;
        }
        list->items = items;
        list->capacity = capacity;
    }
    memcpy((char *)list->items + list->count++ * size, item, size);
    return true;
}

/* --- what a surface is made of --- */

/* Planes are compared more loosely than hits are: a pair too many costs little. */
static const double alike = 0x1p-26;

static bool planes_equal(const struct plane *a, const struct plane *b, struct vec3 near) {
    double size = vec3_max_abs(near) + vec3_max_abs(a->point) + vec3_max_abs(b->point);
    double turn = vec3_max_abs(vec3_cross(a->normal, b->normal));
    double apart = vec3_dot(a->normal, vec3_sub(near, a->point)) -
                   copysign(1, vec3_dot(a->normal, b->normal)) * vec3_dot(b->normal, vec3_sub(near, b->point));
    return turn <= alike && fabs(apart) <= alike * size;
}

static struct plane plane_mapped(const struct transform *map, struct plane plane) {
    return (struct plane){affine_point(&map->forward, plane.point),
                          vec3_normalize(transform_normal(map, plane.normal))};
}

static void add_plane(struct finder *f, struct make *make, const struct transform *map, struct plane plane) {
    const struct plane *listed = (const struct plane *)f->planes.items + make->first_plane;
    plane = plane_mapped(map, plane);
    make->kinds |= MADE_OF_PLANES;
    if (make->many || !vec3_finite(plane.normal) || !vec3_finite(plane.point))
        return;
    for (uint32_t i = 0; i < make->planes; i++)
        if (planes_equal(&listed[i], &plane, plane.point))
            return;
    make->many = make->planes == PLANES;
    if (make->many)
        return;
    make->planes += add_to(f, &f->planes, &plane, sizeof plane);
}

static struct plane plane_of_triangle(const struct mesh *mesh, uint32_t triangle) {
    struct vec3 c[3];
    uint32_t slot;
    mesh_triangle(mesh, triangle, c, &slot);
    return (struct plane){c[0], vec3_normalize(vec3_cross(vec3_sub(c[1], c[0]), vec3_sub(c[2], c[0])))};
}

static void add_round(struct finder *f, struct make *make, const struct transform *map, struct vec3 centre) {
    make->kinds |= MADE_OF_ROUND;
    centre = affine_point(&map->forward, centre);
    make->centres += add_to(f, &f->centres, &centre, sizeof centre);
}

static void add_ends(struct finder *f, struct make *make, const struct transform *map,
                     const struct revolved_quadric *q) {
    const double ends[2] = {q->lo, q->hi};
    const struct axis axis = {affine_point(&map->forward, q->base),
                              vec3_normalize(affine_vector(&map->forward, q->axis))};
    make->kinds |= MADE_OF_AXIAL;
    make->axes += add_to(f, &f->axes, &axis, sizeof axis);
    for (int i = 0; i < 2 && !q->open; i++)
        if (isfinite(ends[i]))
            add_plane(f, make, map, (struct plane){vec3_add_scaled(q->base, q->axis, ends[i]), q->axis});
}

static void add_shape(struct finder *f, struct make *make, const struct transform *map, const struct shape *shape) {
    switch (shape->kind) {
    case SHAPE_SPHERE:
        add_round(f, make, map, shape->sphere.centre);
        return;
    case SHAPE_ELLIPSOID:
        add_round(f, make, map, shape->ellipsoid.centre);
        return;
    case SHAPE_BOX:
        for (int i = 0; i < 6; i++) {
            struct vec3 normal = {i / 2 == 0, i / 2 == 1, i / 2 == 2};
            add_plane(f, make, map, (struct plane){i % 2 ? shape->box.max : shape->box.min, normal});
        }
        return;
    case SHAPE_PLANAR:
        add_plane(f, make, map, (struct plane){shape->planar.origin, vec3_normalize(shape->planar.normal)});
        return;
    case SHAPE_REVOLVED_QUADRIC:
        add_ends(f, make, map, &shape->revolved_quadric);
        return;
    case SHAPE_TORUS:
        make->kinds |= MADE_OF_TORUS;
        return;
    case SHAPE_MESH:
        for (uint32_t i = 0; i < mesh_triangle_count(shape->mesh) && !make->many; i++)
            add_plane(f, make, map, plane_of_triangle(shape->mesh, i));
        return;
    case SHAPE_CURVE:
        return;
    case SHAPE_QUADRIC:
    case SHAPE_SUPERELLIPSOID:
    case SHAPE_LATHE:
    case SHAPE_PRISM:
    case SHAPE_BEVELLED:
    case SHAPE_SWEEP:
    case SHAPE_HEIGHT_FIELD:
    case SHAPE_BLOB:
    case SHAPE_IMPLICIT:
        make->kinds |= MADE_OF_ANYTHING;
        return;
    }
}

static void find_make(struct finder *f, const struct prototype *prototype, struct make *make) {
    const struct csg *csg = prototype->geometry.csg;
    const struct transform as_it_is = transform_identity();
    *make = (struct make){.first_plane = (uint32_t)f->planes.count,
                          .first_centre = (uint32_t)f->centres.count,
                          .first_axis = (uint32_t)f->axes.count};
    if (!csg) {
        add_shape(f, make, &as_it_is, &prototype->geometry.shape);
        return;
    }
    for (uint32_t i = 0; i < csg->leaf_count; i++) {
        const struct csg_leaf *leaf = &csg->leaves[i];
        add_shape(f, make, &leaf->csg_from_leaf, &leaf->shape);
    }
}

/* --- pairs --- */

/* Light passes some of its surface. */
static bool is_transparent(const struct finder *f, uint32_t primitive) {
    const uint32_t *first = f->world->first_solid;
    return first && first[primitive] < first[primitive + 1];
}

static const struct make *make_of(const struct finder *f, uint32_t primitive) {
    return &f->makes[f->world->primitives[primitive].prototype];
}

/* A point in the common part of two boxes, or near it where that has no end. */
static struct vec3 middle_of(const struct box *a, const struct box *b) {
    struct box common = box_meet(*a, *b);
    double middle[3];
    for (int i = 0; i < 3; i++) {
        double lo = vec3_get(common.min, i), hi = vec3_get(common.max, i);
        middle[i] = isfinite(lo) && isfinite(hi) ? lo + (hi - lo) / 2 : isfinite(lo) ? lo : isfinite(hi) ? hi : 0;
    }
    return vec3_make(middle[0], middle[1], middle[2]);
}

/* Whether three corners of a mesh of many planes lie in one of these planes of the world. */
static bool mesh_has_plane(struct finder *f, uint32_t primitive, const struct plane *planes, uint32_t count) {
    const struct mesh *mesh = geometry_mesh(primitive_geometry(f->world, primitive));
    if (!mesh)
        return true;
    uint32_t corners;
    const double(*at)[3] = mesh_vertices(mesh, &corners);
    f->plane_tests += (uint64_t)corners * count;
    if (f->plane_tests > plane_tests_limit)
        return false;
    const struct box bounds = mesh_bounds(mesh);
    const double size = vec3_max_abs(bounds.min) + vec3_max_abs(bounds.max);
    struct transform map = world_placement(f->world, primitive, 0);
    map = transform_invert(&map);
    for (uint32_t k = 0; k < count; k++) {
        const struct plane plane = plane_mapped(&map, planes[k]);
        const struct vec3 n = plane.normal;
        const double distance = vec3_dot(n, plane.point);
        uint32_t in_plane = 0;
        for (uint32_t i = 0; i < corners && in_plane < 3; i++)
            in_plane += fabs(n.x * at[i][0] + n.y * at[i][1] + n.z * at[i][2] - distance) <= alike * size;
        if (in_plane == 3)
            return true;
    }
    return false;
}

/* The planes of a primitive in the world. */
static uint32_t planes_of(const struct finder *f, uint32_t primitive, struct plane out[PLANES]) {
    const struct make *make = make_of(f, primitive);
    const struct transform map = world_placement(f->world, primitive, 0);
    for (uint32_t i = 0; i < make->planes; i++)
        out[i] = plane_mapped(&map, ((const struct plane *)f->planes.items)[make->first_plane + i]);
    return make->planes;
}

static bool have_common_plane(struct finder *f, uint32_t a, uint32_t b) {
    const struct make *of_a = make_of(f, a), *of_b = make_of(f, b);
    struct vec3 near = middle_of(&f->world->boxes[a], &f->world->boxes[b]);
    struct plane first[PLANES], second[PLANES];
    if (of_a->many && of_b->many)
        return is_transparent(f, a) || is_transparent(f, b);
    if (of_a->many) {
        uint32_t count = planes_of(f, b, second);
        return mesh_has_plane(f, a, second, count);
    }
    uint32_t count = planes_of(f, a, first);
    if (of_b->many)
        return mesh_has_plane(f, b, first, count);
    uint32_t others = planes_of(f, b, second);
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < others; k++)
            if (planes_equal(&first[i], &second[k], near))
                return true;
    return false;
}

/* Whether two points are one, as far as the size of the primitive shows. */
static bool points_equal(const struct finder *f, uint32_t primitive, struct vec3 a, struct vec3 b) {
    double size = vec3_max_abs(vec3_sub(f->world->boxes[primitive].max, f->world->boxes[primitive].min));
    return vec3_max_abs(vec3_sub(a, b)) <= alike * (vec3_max_abs(a) + size);
}

static bool have_common_centre(const struct finder *f, uint32_t a, uint32_t b) {
    const struct make *of_a = make_of(f, a), *of_b = make_of(f, b);
    const struct transform map_a = world_placement(f->world, a, 0), map_b = world_placement(f->world, b, 0);
    const struct vec3 *centres = f->centres.items;
    for (uint32_t i = 0; i < of_a->centres; i++) {
        struct vec3 first = affine_point(&map_a.forward, centres[of_a->first_centre + i]);
        for (uint32_t k = 0; k < of_b->centres; k++)
            if (points_equal(f, a, first, affine_point(&map_b.forward, centres[of_b->first_centre + k])))
                return true;
    }
    return false;
}

static struct axis axis_mapped(const struct transform *map, struct axis axis) {
    return (struct axis){affine_point(&map->forward, axis.point),
                         vec3_normalize(affine_vector(&map->forward, axis.direction))};
}

static bool have_common_axis(const struct finder *f, uint32_t a, uint32_t b) {
    const struct make *of_a = make_of(f, a), *of_b = make_of(f, b);
    const struct transform map_a = world_placement(f->world, a, 0), map_b = world_placement(f->world, b, 0);
    const struct axis *axes = f->axes.items;
    for (uint32_t i = 0; i < of_a->axes; i++) {
        struct axis first = axis_mapped(&map_a, axes[of_a->first_axis + i]);
        for (uint32_t k = 0; k < of_b->axes; k++) {
            struct axis second = axis_mapped(&map_b, axes[of_b->first_axis + k]);
            double along = vec3_dot(vec3_sub(second.point, first.point), first.direction);
            if (vec3_max_abs(vec3_cross(first.direction, second.direction)) <= alike &&
                points_equal(f, a, vec3_add_scaled(first.point, first.direction, along), second.point))
                return true;
        }
    }
    return false;
}

static bool may_share(struct finder *f, uint32_t a, uint32_t b) {
    unsigned of_a = make_of(f, a)->kinds, of_b = make_of(f, b)->kinds;
    if (of_a == 0 || of_b == 0)
        return false;
    unsigned common = of_a & of_b;
    if (((of_a | of_b) & MADE_OF_ANYTHING) || (common & MADE_OF_TORUS) ||
        (common && (primitive_moves(f->world, a) || primitive_moves(f->world, b))))
        return true;
    return ((common & MADE_OF_ROUND) && have_common_centre(f, a, b)) ||
           ((common & MADE_OF_AXIAL) && have_common_axis(f, a, b)) ||
           ((common & MADE_OF_PLANES) && have_common_plane(f, a, b));
}

/* Each pair is found once: from a transparent primitive, or from the first one. */
static bool find_pairs(struct finder *f, const struct box_tree *tree, struct pool *pool, struct error *error) {
    const struct world *world = f->world;
    bool all = world->primitive_count <= OPAQUE_LIMIT;
    for (uint32_t i = 0; i < world->primitive_count && !f->failed; i++) {
        bool own = all || is_transparent(f, i);
        struct box_tree_meeting meeting;
        uint32_t other;
        if (i % 1024 == 0 && pool_cancelled(pool))
            return error_set(error, ERROR_CANCELLED, "stopped while the scene was measured");
        if (!own || make_of(f, i)->kinds == 0)
            continue;
        box_tree_meeting_begin(&meeting, tree, &world->boxes[i]);
        while (box_tree_meeting_next(&meeting, &other)) {
            bool from_other = other < i && (all || is_transparent(f, other));
            if (other != i && !from_other && may_share(f, i, other))
                (void)add_to(f, &f->pairs, &(struct pair){i, other}, sizeof(struct pair));
        }
    }
    return true;
}

/* --- the lists --- */

static bool pair_before(const void *a, const void *b) {
    const struct pair *x = a, *y = b;
    return x->a < y->a || (x->a == y->a && x->b < y->b);
}

static bool make_lists(struct finder *f, struct touching *touching, struct arena *arena) {
    uint32_t primitives = f->world->primitive_count, *first, *partners;
    size_t once = f->pairs.count;
    for (size_t i = 0; i < once && !f->failed; i++) {
        struct pair pair = ((const struct pair *)f->pairs.items)[i];
        (void)add_to(f, &f->pairs, &(struct pair){pair.b, pair.a}, sizeof pair);
    }
    if (f->failed || f->pairs.count == 0)
        return !f->failed;
    first = arena_alloc_array(arena, (size_t)primitives + 1, sizeof *first);
    partners = arena_alloc_array(arena, f->pairs.count, sizeof *partners);
    if (!first || !partners || f->pairs.count > UINT32_MAX)
        return false;
    sort_items(f->pairs.items, f->pairs.count, sizeof(struct pair), pair_before);
    const struct pair *pairs = f->pairs.items;
    uint32_t next = 0;
    for (uint32_t i = 0; i <= primitives; i++) {
        first[i] = next;
        for (; next < f->pairs.count && pairs[next].a == i; next++)
            partners[next] = pairs[next].b;
    }
    touching->first = first;
    touching->partners = partners;
    return true;
}

/* --- what is hidden --- */

/* Places on a flat primitive: those below the points of a grid in its box. */
enum { GRID = 5 };

/* Whether the surface of `other` covers the flat primitive at a place next to the point. seen: whether the primitive is
 * there at all. */
static bool is_covered(const struct finder *f, struct pair pair, const struct plane *plane, struct vec3 point,
                       struct world_scratch *scratch, bool *seen) {
    const struct world *world = f->world;
    struct vec3 foot = vec3_add_scaled(point, plane->normal, -vec3_dot(plane->normal, vec3_sub(point, plane->point)));
    double size = vec3_max_abs(foot) + vec3_max_abs(vec3_sub(world->boxes[pair.b].max, world->boxes[pair.b].min));
    struct ray ray = {.origin = vec3_add_scaled(foot, plane->normal, alike * size),
                      .direction = vec3_negate(plane->normal),
                      .t_max = 2 * alike * size};
    struct ray own = primitive_ray(world, pair.b, &ray), others = primitive_ray(world, pair.a, &ray);
    struct crossing crossing, other = {.t = 0};
    *seen = world_ask_nearest(world, pair.b, &own, scratch, &crossing);
    return *seen && world_ask_nearest(world, pair.a, &others, scratch, &other) &&
           fabs(crossing.t - other.t) <= 0x1p-40 * size;
}

/* Whether the second primitive of a pair is flat, and lies in the surface of the first. */
static bool is_hidden(const struct finder *f, struct pair pair, struct world_scratch *scratch, struct vec3 *point) {
    const struct make *make = make_of(f, pair.b);
    const struct box *box = &f->world->boxes[pair.b];
    struct plane planes[PLANES];
    if (make->kinds != MADE_OF_PLANES || make->many || make->planes != 1 || is_transparent(f, pair.a) ||
        is_transparent(f, pair.b) || !vec3_finite(box->min) || !vec3_finite(box->max))
        return false;
    (void)planes_of(f, pair.b, planes);
    int samples = 0;
    for (int i = 0; i < GRID * GRID * GRID; i++) {
        const double at[3] = {(i % GRID + 0.5) / GRID, (i / GRID % GRID + 0.5) / GRID, (i / GRID / GRID + 0.5) / GRID};
        struct vec3 share = {at[0], at[1], at[2]}, edges = vec3_sub(box->max, box->min);
        *point = vec3_add(box->min, vec3_mul(edges, share));
        bool seen, covered = is_covered(f, pair, planes, *point, scratch, &seen);
        if (seen && !covered)
            return false;
        samples += seen;
    }
    return samples > 2;
}

/* Of the first one: many of them have one cause. */
static bool warn_of_hidden(struct finder *f, struct flattening *flattening) {
    struct world_scratch scratch;
    if (f->pairs.count == 0)
        return true;
    if (!world_scratch_init(&scratch, f->world))
        return false;
    for (size_t i = 0; i < f->pairs.count; i++) {
        struct pair pair = ((const struct pair *)f->pairs.items)[i];
        struct vec3 point;
        if (pair.a > pair.b || !is_hidden(f, pair, &scratch, &point))
            continue;
        char text[256];
        (void)snprintf(text, sizeof text,
                       "lies in a face of '%.100s', which is first in the scene and hides it; move it out by %.0e",
                       primitive_node(f->world, pair.a)->name, 1e-6 * math_max(vec3_max_abs(point), 0x1p-100));
        flatten_warn_once(flattening, primitive_node(f->world, pair.b), text);
        break;
    }
    bool ok = !scratch.failed;
    world_scratch_destroy(&scratch);
    return ok;
}

/* The hierarchy over the primitives. */
static const struct box_tree *tree_of(const struct world *world) {
    const struct box_tree *tree = scene_accel_hierarchy(&world->accel);
    return tree ? tree : &world->touching.tree;
}

/* Lists what prototypes are made of. False: no two of them need a search, or no memory. */
static bool find_makes(struct finder *f) {
    const struct world *world = f->world;
    bool any = world->primitive_count > 1 && (world->primitive_count <= OPAQUE_LIMIT || world->first_solid);
    f->makes = any ? mem_resize_array(NULL, world->prototype_count, sizeof *f->makes) : NULL;
    f->failed = any && !f->makes;
    for (uint32_t i = 0; any && i < world->prototype_count && !f->failed; i++)
        find_make(f, &world->prototypes[i], &f->makes[i]);
    return any && !f->failed;
}

bool touching_find(struct world *world, struct flattening *flattening) {
    struct touching *touching = &world->touching;
    struct pool *pool = flattening->pool;
    struct error *error = flattening->error;
    struct finder f = {.world = world};
    bool ok = true, searches = find_makes(&f);
    *touching = (struct touching){0};
    if (searches && !scene_accel_hierarchy(&world->accel))
        ok = box_tree_build(&touching->tree, world->boxes, world->primitive_count, pool, error);
    if (searches && ok)
        ok = find_pairs(&f, tree_of(world), pool, error);
    if (ok && (f.failed || !make_lists(&f, touching, flattening->arena) || !warn_of_hidden(&f, flattening)))
        ok = error_no_memory(error, "the surfaces that touch");
    if (ok && !touching->first)
        touching_destroy(touching);
    mem_free(f.makes);
    mem_free(f.planes.items);
    mem_free(f.centres.items);
    mem_free(f.axes.items);
    mem_free(f.pairs.items);
    return ok;
}

void touching_destroy(struct touching *touching) {
    box_tree_destroy(&touching->tree);
    *touching = (struct touching){0};
}

/* --- queries --- */

static bool boxes_meet(const struct box *a, const struct box *b) {
    return a->min.x <= b->max.x && a->max.x >= b->min.x && a->min.y <= b->max.y && a->max.y >= b->min.y &&
           a->min.z <= b->max.z && a->max.z >= b->min.z;
}

void touching_begin(struct touching_query *query, const struct world *world, uint32_t primitive,
                    const struct box *region) {
    const struct touching *touching = &world->touching;
    query->world = world;
    query->region = *region;
    query->primitive = primitive;
    query->list = touching->partners + touching->first[primitive];
    query->end = touching->partners + touching->first[primitive + 1];
    if (query->end - query->list <= LISTED)
        return;
    query->list = NULL;
    box_tree_meeting_begin(&query->meeting, tree_of(world), region);
}

bool touching_next(struct touching_query *query, uint32_t *partner) {
    while (query->list && query->list < query->end) {
        *partner = *query->list++;
        if (boxes_meet(&query->world->boxes[*partner], &query->region))
            return true;
    }
    while (!query->list && box_tree_meeting_next(&query->meeting, partner))
        if (*partner != query->primitive)
            return true;
    return false;
}

bool touching_any(const struct world *world, uint32_t primitive, const struct box *region) {
    const struct touching *touching = &world->touching;
    const uint32_t *list = touching->partners + touching->first[primitive],
                   *end = touching->partners + touching->first[primitive + 1];
    for (const uint32_t *partner = list; end - list <= LISTED && partner < end; partner++)
        if (boxes_meet(&world->boxes[*partner], region))
            return true;
    return end - list > LISTED;
}

void touching_bundle(struct bundle *bundle, struct touching *touching, uint32_t primitive_count) {
    BUNDLE(bundle, touching->partners, touching->first ? touching->first[primitive_count] : 0, NULL);
    BUNDLE(bundle, touching->first, primitive_count + 1, NULL);
    box_tree_bundle(bundle, &touching->tree);
}
