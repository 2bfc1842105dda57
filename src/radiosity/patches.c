#include "radiosity/patches.h"

#include "base/mem.h"
#include "export/primitive_mesh.h"
#include "mesh/mesh_topology.h"
#include "world/world_describe.h"

#include <math.h>

static const double smooth_cosine = 0.866; /* of 30 degrees: normals at a common vertex */
static const double curved_part = 0.15;    /* of an edge: how far a patch may be from a curved surface */

void patch_corners(const struct patches *patches, uint32_t index, struct vec3 out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = patch_vertex_at(patches, patch_at(patches, index)->vertex[k])->point;
}

/* The edge from corner k to the next one that is longest. */
static int longest_edge(const struct vec3 c[3], double *length) {
    double squares[3];
    int longest = 0;
    for (int k = 0; k < 3; k++) {
        squares[k] = vec3_length_squared(vec3_sub(c[(k + 1) % 3], c[k]));
        longest = squares[k] > squares[longest] ? k : longest;
    }
    *length = sqrt(squares[longest]);
    return longest;
}

bool patches_hit(const struct patches *patches, uint32_t patch, struct vec3 point, struct world_scratch *scratch,
                 struct hit *hit) {
    const struct world *world = patches->world;
    const uint32_t primitive = patch_primitive(patches, patch);
    struct vec3 c[3];
    double size;
    patch_corners(patches, patch, c);
    (void)longest_edge(c, &size);
    const struct vec3 normal = vec3_normalize(patch_normal(c));
    /* From nearby first: another surface of the primitive may be above. */
    for (double height = 0x1p-10 * size; height <= size; height *= 32) {
        const struct ray ray = {
            .origin = vec3_add_scaled(point, normal, height), .direction = vec3_negate(normal), .t_max = 2 * height};
        struct crossing crossing;
        if (!world_nearest_of(world, primitive, &ray, scratch, &crossing))
            continue;
        world_describe(world, &ray, primitive, &crossing, hit);
        if (hit->front && vec3_dot(hit->normal_geometric, normal) > 0.5)
            return true;
    }
    return false;
}

/* --- kinds --- */

static bool is_diffuse(const struct world *world, uint32_t material) {
    const struct surface_material *surface = &world->surfaces.materials[material];
    return surface->has_layers || surface_has_texture(surface, INPUT_KD) ||
           (!surface->phong.unlit && colour_max_abs(surface_diffuse(&world->surfaces, surface)) > 0);
}

enum patch_kind patches_kind(const struct world *world, uint32_t primitive) {
    const struct geometry *geometry = primitive_geometry(world, primitive);
    const struct box *box = &world->boxes[primitive];
    if (box_is_empty(box) || !primitive_has_material(world, primitive, is_diffuse))
        return PATCHES_BLACK;
    if (!vec3_finite(box->min) || !vec3_finite(box->max))
        return PATCHES_BARE;
    if (geometry->csg)
        return geometry->csg->clipped || geometry->csg->inside_out ? PATCHES_BARE : PATCHES_SOLID;
    return geometry->shape.kind == SHAPE_MESH     ? PATCHES_MESH
           : geometry->shape.kind == SHAPE_PLANAR ? PATCHES_PLANAR
           : geometry->shape.kind == SHAPE_BOX    ? PATCHES_BOX
           : geometry->shape.kind == SHAPE_SPHERE ? PATCHES_BALL
           : geometry_is_closed(geometry)         ? PATCHES_SOLID
                                                  : PATCHES_BARE;
}

/* Its patches are only near its surface. */
static bool is_curved(const struct world *world, uint32_t primitive) {
    enum patch_kind kind = patches_kind(world, primitive);
    return kind == PATCHES_BALL || kind == PATCHES_SOLID;
}

/* --- triangles of a primitive --- */

/* The rectangle at a corner, or with the radius of a ball a quarter of it over the ball. */
static bool add_rectangle(struct list *corners, struct vec3 corner, struct vec3 u, struct vec3 v,
                          const struct shape *ball) {
    enum { PARTS = 2 };
    int n = ball ? PARTS : 1;
    bool ok = true;
    for (int i = 0; i < n * n; i++) {
        struct vec3 c[4];
        for (int k = 0; k < 4; k++) {
            double x = (double)(i % n + (k == 1 || k == 2)) / n, y = (double)(i / n + k / 2) / n;
            c[k] = vec3_add_scaled(vec3_add_scaled(corner, u, x), v, y);
            if (ball)
                c[k] = vec3_add_scaled(ball->sphere.centre, vec3_normalize(c[k]), ball->sphere.radius);
        }
        const struct vec3 two[6] = {c[0], c[1], c[2], c[0], c[2], c[3]};
        ok = ok && list_add(corners, two, 6, sizeof *two);
    }
    return ok;
}

/* Six rectangles. */
static bool add_box(struct list *corners, const struct box *box, const struct shape *ball) {
    const struct vec3 size = vec3_sub(box->max, box->min);
    const struct vec3 edges[3] = {{size.x, 0, 0}, {0, size.y, 0}, {0, 0, size.z}};
    bool ok = true;
    for (int i = 0; i < 3; i++) {
        const struct vec3 u = edges[(i + 1) % 3], v = edges[(i + 2) % 3];
        ok = ok && add_rectangle(corners, box->min, v, u, ball) &&
             add_rectangle(corners, vec3_add(box->min, edges[i]), u, v, ball);
    }
    return ok;
}

/* The rectangle along its axes that contains the shape. */
static bool add_planar(struct list *corners, const struct planar *planar) {
    struct vec3 u = planar->u, v = planar->v, n = vec3_cross(u, v), corner = planar->origin;
    const struct vec3 across[2] = {vec3_cross(v, n), vec3_cross(n, u)};
    double low[2], high[2], squared = vec3_length_squared(n);
    for (int i = 0; i < 2; i++) {
        double start = vec3_dot(across[i], planar->origin);
        planar_extent(planar, across[i], &low[i], &high[i]);
        low[i] = (low[i] - start) / squared;
        high[i] = (high[i] - start) / squared;
    }
    corner = vec3_add_scaled(vec3_add_scaled(corner, u, low[0]), v, low[1]);
    u = vec3_scale(u, high[0] - low[0]);
    v = vec3_scale(v, high[1] - low[1]);
    return vec3_dot(n, planar->normal) < 0 ? add_rectangle(corners, corner, v, u, NULL)
                                           : add_rectangle(corners, corner, u, v, NULL);
}

static bool add_mesh(struct list *corners, const struct mesh *mesh) {
    bool ok = true;
    for (uint32_t i = 0; ok && i < mesh_triangle_count(mesh); i++) {
        struct vec3 c[3];
        uint32_t slot;
        mesh_triangle(mesh, i, c, &slot);
        ok = list_add(corners, c, 3, sizeof *c);
    }
    return ok;
}

/* From the space of the primitive to the world, where a mirrored one has its outside on the other side. */
static void map_corners(const struct world *world, uint32_t primitive, struct list *corners) {
    struct vec3 *c = corners->items;
    struct transform map = world_placement(world, primitive, 0);
    bool turned = affine_determinant(&map.forward) < 0;
    for (size_t i = 0; i < corners->count; i++)
        c[i] = affine_point(&map.forward, c[i]);
    for (size_t i = 0; turned && i < corners->count; i += 3) {
        struct vec3 second = c[i + 1];
        c[i + 1] = c[i + 2];
        c[i + 2] = second;
    }
}

/* A corner of a triangle. last: of the first corner at a position, the last one there that made a vertex; before: the
 * one there before that. */
struct weld_corner {
    struct vec3 normal;
    uint32_t vertex, last, before;
};

static bool has_area(const struct vec3 c[3]) {
    double length;
    (void)longest_edge(c, &length);
    return patch_area(c) > 0x1p-41 * length * length;
}

/* Corners at one position become a vertex where triangles have no edge, on a ball all. */
static bool weld(struct patches *out, uint32_t primitive, const struct list *list, bool is_ball) {
    const struct vec3 *corners = list->items;
    uint32_t count = (uint32_t)list->count;
    struct weld_corner *c = mem_alloc(count * sizeof *c);
    uint32_t *same = mem_alloc(count * sizeof *same);
    bool ok = c && same && mesh_weld(list->items, count, same);
    for (uint32_t i = 0; ok && i < count; i++) {
        c[i] =
            (struct weld_corner){vec3_normalize(patch_normal(&corners[i / 3 * 3])), PATCH_NONE, PATCH_NONE, PATCH_NONE};
        uint32_t last = c[same[i]].last, at = last;
        if (!has_area(&corners[i / 3 * 3]))
            continue;
        while (at != PATCH_NONE && !is_ball && vec3_dot(c[at].normal, c[i].normal) < smooth_cosine)
            at = c[at].before;
        if (at == PATCH_NONE) {
            const struct patch_vertex own = {corners[i], primitive};
            c[i].before = last;
            c[same[i]].last = at = i;
            c[i].vertex = (uint32_t)out->vertices.count;
            ok = list_add(&out->vertices, &own, 1, sizeof own);
        }
        c[i].vertex = c[at].vertex;
    }
    for (uint32_t i = 0; ok && i < count; i += 3) {
        if (!has_area(&corners[i]))
            continue;
        const struct patch patch = {{c[i].vertex, c[i + 1].vertex, c[i + 2].vertex}};
        ok = list_add(&out->all, &patch, 1, sizeof patch);
    }
    mem_free(c);
    mem_free(same);
    return ok;
}

static bool add_primitive(struct patches *out, uint32_t primitive, struct list *corners, struct pool *pool,
                          struct error *error) {
    static const struct box cube = {{-1, -1, -1}, {1, 1, 1}};
    const struct world *world = out->world;
    const struct shape *shape = &primitive_geometry(world, primitive)->shape;
    const struct box *box = &world->boxes[primitive];
    enum patch_kind kind = patches_kind(world, primitive);
    bool ok = true;
    corners->count = 0;
    switch (kind) {
    case PATCHES_BLACK:
    case PATCHES_BARE:
        return true;
    case PATCHES_PLANAR:
        ok = add_planar(corners, &shape->planar);
        break;
    case PATCHES_BOX:
        ok = add_box(corners, &shape->box, NULL);
        break;
    case PATCHES_BALL:
        ok = add_box(corners, &cube, shape);
        break;
    case PATCHES_MESH:
        ok = add_mesh(corners, shape->mesh);
        break;
    case PATCHES_SOLID:
        if (!primitive_mesh_build(world, primitive, vec3_max_abs(vec3_sub(box->max, box->min)) / 100, pool, corners,
                                  error))
            return error->kind == ERROR_SCENE; /* it has no mesh, so it is bare */
        break;
    }
    if (kind != PATCHES_SOLID)
        map_corners(world, primitive, corners);
    return (ok && weld(out, primitive, corners, kind == PATCHES_BALL)) || error_no_memory(error, "patches");
}

/* --- division --- */

static uint64_t edge_key(uint32_t a, uint32_t b) {
    return ((uint64_t)(a < b ? a : b) << 32 | (a < b ? b : a)) + 1;
}

bool patches_mark(struct key_map *edges, uint32_t a, uint32_t b) {
    return key_map_find(edges, edge_key(a, b)) || key_map_add(edges, edge_key(a, b), PATCH_NONE);
}

static uint32_t *marked(const struct key_map *edges, const struct patch *patch, int k) {
    return key_map_find(edges, edge_key(patch->vertex[k % 3], patch->vertex[(k + 1) % 3]));
}

static int count_marked(const struct key_map *edges, const struct patch *patch) {
    return (marked(edges, patch, 0) != NULL) + (marked(edges, patch, 1) != NULL) + (marked(edges, patch, 2) != NULL);
}

/* With any edge of a patch, its longest one is marked, too. */
static bool complete_marked(const struct patches *patches, struct key_map *edges, size_t *count) {
    for (bool more = true; more;) {
        more = false;
        *count = patches->all.count;
        for (uint32_t i = 0; i < patches->all.count; i++) {
            const struct patch *patch = patch_at(patches, i);
            struct vec3 c[3];
            double length;
            int found = count_marked(edges, patch);
            if (found == 0)
                continue;
            patch_corners(patches, i, c);
            int longest = longest_edge(c, &length);
            if (!marked(edges, patch, longest)) {
                if (!patches_mark(edges, patch->vertex[longest], patch->vertex[(longest + 1) % 3]))
                    return false;
                more = true;
            }
            *count += (size_t)found;
        }
    }
    return true;
}

/* The vertex in the middle of a marked edge, on the surface. */
static bool find_middle(struct patches *patches, uint32_t index, int k, uint32_t *middle,
                        struct world_scratch *scratch) {
    const uint32_t primitive = patch_primitive(patches, index);
    struct vec3 c[3];
    struct hit hit;
    if (*middle != PATCH_NONE)
        return true;
    patch_corners(patches, index, c);
    struct vec3 a = c[k], b = c[(k + 1) % 3];
    struct patch_vertex own = {vec3_scale(vec3_add(a, b), 0.5), primitive};
    double length = vec3_length(vec3_sub(b, a));
    if (is_curved(patches->world, primitive) && patches_hit(patches, index, own.point, scratch, &hit) &&
        vec3_length(vec3_sub(hit.point, own.point)) < curved_part * length)
        own.point = hit.point;
    *middle = (uint32_t)patches->vertices.count;
    return list_add(&patches->vertices, &own, 1, sizeof own);
}

static bool add_patch(struct patches *patches, uint32_t a, uint32_t b, uint32_t c) {
    const struct patch patch = {{a, b, c}};
    return list_add(&patches->all, &patch, 1, sizeof patch);
}

/* Divides one patch at its longest edge, and the halves at their other marked edges. One part takes its number. */
static bool divide(struct patches *patches, struct key_map *edges, uint32_t index, struct world_scratch *scratch) {
    const struct patch patch = *patch_at(patches, index);
    struct vec3 c[3];
    double length;
    uint32_t *middles[3];
    patch_corners(patches, index, c);
    int longest = longest_edge(c, &length);
    for (int k = 0; k < 3; k++) {
        middles[k] = marked(edges, &patch, longest + k);
        if (middles[k] && !find_middle(patches, index, (longest + k) % 3, middles[k], scratch))
            return false;
    }
    if (!middles[0])
        return true;
    uint32_t u = patch.vertex[longest], v = patch.vertex[(longest + 1) % 3], w = patch.vertex[(longest + 2) % 3];
    uint32_t m = *middles[0], last = middles[1] ? *middles[1] : v;
    bool ok = true;
    if (middles[1])
        ok = add_patch(patches, m, v, last);
    if (middles[2])
        ok = ok && add_patch(patches, m, w, *middles[2]) && add_patch(patches, m, *middles[2], u);
    else
        ok = ok && add_patch(patches, m, w, u);
    *patch_at(patches, index) = (struct patch){{m, last, w}};
    return ok;
}

bool patches_divide(struct patches *patches, struct key_map *edges, uint32_t limit, bool *done, struct error *error) {
    struct world_scratch scratch;
    size_t count = 0;
    bool ok = complete_marked(patches, edges, &count);
    *done = ok && count <= limit;
    if (!*done)
        return ok || error_no_memory(error, "patches");
    count = patches->all.count;
    ok = world_scratch_init(&scratch, patches->world);
    for (uint32_t i = 0; ok && i < count; i++)
        ok = divide(patches, edges, i, &scratch);
    ok = ok && !scratch.failed;
    world_scratch_destroy(&scratch);
    return ok || error_no_memory(error, "patches");
}

static bool divide_long(struct patches *patches, uint32_t limit, struct error *error) {
    for (bool done = true; done;) {
        struct key_map edges = {0};
        bool ok = true;
        for (uint32_t i = 0; ok && i < patches->all.count; i++) {
            const struct patch *patch = patch_at(patches, i);
            struct vec3 c[3];
            double length;
            patch_corners(patches, i, c);
            int k = longest_edge(c, &length);
            const struct box *box = &patches->world->boxes[patch_primitive(patches, i)];
            /* Small objects have some patches, too. */
            if (length > math_min(patches->edge, vec3_length(vec3_sub(box->max, box->min)) / 2))
                ok = patches_mark(&edges, patch->vertex[k], patch->vertex[(k + 1) % 3]);
        }
        done = edges.count > 0;
        ok = ok ? !done || patches_divide(patches, &edges, limit, &done, error) : error_no_memory(error, "patches");
        key_map_destroy(&edges);
        if (!ok)
            return false;
    }
    return true;
}

bool patches_build(struct patches *patches, const struct world *world, uint32_t limit, struct pool *pool,
                   struct error *error) {
    struct list corners = {0}; /* struct vec3, three for each triangle of one primitive */
    double area = 0;
    bool ok = true;
    *patches = (struct patches){.world = world};
    for (uint32_t i = 0; ok && i < world->primitive_count; i++) {
        ok = add_primitive(patches, i, &corners, pool, error);
        if (ok && patches->all.count > limit)
            ok =
                error_set(error, ERROR_SCENE,
                          "the scene has more than %u triangles, the limit of --radiosity-patches; a larger one allows "
                          "them",
                          limit);
    }
    for (uint32_t i = 0; ok && i < patches->all.count; i++) {
        struct vec3 c[3];
        patch_corners(patches, i, c);
        area += patch_area(c);
    }
    /* A quarter of the limit, as right isosceles triangles with edges from .7 to 1 of the longest. */
    patches->edge = sqrt(6 * area / (0.25 * limit));
    ok = ok && divide_long(patches, limit / 2, error);
    list_destroy(&corners);
    if (!ok)
        patches_destroy(patches);
    return ok;
}

void patches_destroy(struct patches *patches) {
    list_destroy(&patches->vertices);
    list_destroy(&patches->all);
    mem_free(patches->first);
    mem_free(patches->of_vertex);
    box_tree_destroy(&patches->tree);
    *patches = (struct patches){0};
}

/* --- searching --- */

bool patches_group(const uint32_t *keys, size_t count, uint32_t groups, size_t **first, uint32_t **items) {
    *first = mem_alloc_zero((size_t)groups + 2, sizeof **first);
    *items = mem_alloc(count * sizeof **items + 1);
    if (!*first || !*items)
        return false;
    for (size_t i = 0; i < count; i++)
        if (keys[i] != PATCH_NONE)
            (*first)[keys[i] + 2]++;
    for (uint32_t k = 0; k < groups; k++)
        (*first)[k + 2] += (*first)[k + 1];
    /* first[k + 1] moves from the beginning of k to its end. */
    for (size_t i = 0; i < count; i++)
        if (keys[i] != PATCH_NONE)
            (*items)[(*first)[keys[i] + 1]++] = (uint32_t)i;
    return true;
}

bool patches_index(struct patches *patches, struct error *error) {
    const size_t corners = 3 * patches->all.count;
    mem_free(patches->first);
    mem_free(patches->of_vertex);
    if (!patches_group(patches->all.items, corners, (uint32_t)patches->vertices.count, &patches->first,
                       &patches->of_vertex))
        return error_no_memory(error, "patches");
    for (size_t i = 0; i < corners; i++)
        patches->of_vertex[i] /= 3;
    return true;
}

bool patches_index_space(struct patches *patches, struct pool *pool, struct error *error) {
    uint32_t count = (uint32_t)patches->all.count;
    struct box *boxes = mem_alloc((size_t)count * sizeof *boxes);
    for (uint32_t i = 0; boxes && i < count; i++) {
        struct vec3 c[3];
        double length;
        patch_corners(patches, i, c);
        (void)longest_edge(c, &length);
        boxes[i] = (struct box){vec3_min(c[0], vec3_min(c[1], c[2])), vec3_max(c[0], vec3_max(c[1], c[2]))};
        double margin = is_curved(patches->world, patch_primitive(patches, i)) ? curved_part : 0x1p-20;
        double far = math_max(vec3_max_abs(boxes[i].min), vec3_max_abs(boxes[i].max));
        boxes[i] = box_grow(boxes[i], margin * length + 0x1p-40 * far);
    }
    bool ok = boxes ? box_tree_build(&patches->tree, boxes, count, pool, error) : error_no_memory(error, "patches");
    mem_free(boxes);
    return ok;
}

/* The point of a triangle near p by its shares of the corners, and the squared distance. Beyond an edge it is a point
 * of the edge, though not always the nearest one. */
static double shares_of(const struct vec3 c[3], struct vec3 normal, struct vec3 p, double shares[3]) {
    double squared = vec3_length_squared(normal), sum = 0;
    struct vec3 at = vec3_all(0);
    for (int k = 0; k < 3; k++) {
        struct vec3 edge = vec3_sub(c[(k + 2) % 3], c[(k + 1) % 3]);
        double share = vec3_dot(normal, vec3_cross(edge, vec3_sub(p, c[(k + 1) % 3]))) / squared;
        shares[k] = share > 0 ? share : 0;
        sum += shares[k];
    }
    for (int k = 0; k < 3; k++) {
        shares[k] /= sum;
        at = vec3_add_scaled(at, c[k], shares[k]);
    }
    return vec3_length_squared(vec3_sub(p, at));
}

/* The nearest patch whose box meets a region. */
static bool find_within(const struct patches *patches, const struct hit *hit, double margin, uint32_t *patch,
                        double shares[3]) {
    const struct box region = box_grow((struct box){hit->point, hit->point}, margin);
    struct box_tree_meeting meeting;
    double nearest = INFINITY;
    uint32_t item;
    *patch = PATCH_NONE;
    box_tree_meeting_begin(&meeting, &patches->tree, &region);
    while (box_tree_meeting_next(&meeting, &item)) {
        struct vec3 c[3];
        double own[3];
        if (patch_primitive(patches, item) != hit->primitive)
            continue;
        patch_corners(patches, item, c);
        struct vec3 normal = patch_normal(c);
        if (!(vec3_dot(normal, hit->normal_geometric) > 0))
            continue;
        double distance = shares_of(c, normal, hit->point, own);
        if (distance < nearest || (distance == nearest && item < *patch)) {
            nearest = distance;
            *patch = item;
            for (int k = 0; k < 3; k++)
                shares[k] = own[k];
        }
    }
    return *patch != PATCH_NONE;
}

bool patches_find(const struct patches *patches, const struct hit *hit, uint32_t *patch, double shares[3]) {
    if (patches->tree.node_count == 0)
        return false;
    if (find_within(patches, hit, 0, patch, shares))
        return true;
    /* Where a curved surface is further away than boxes of patches go. */
    for (double margin = patches->edge / 8; is_curved(patches->world, hit->primitive) && margin <= patches->edge;
         margin *= 2)
        if (find_within(patches, hit, margin, patch, shares))
            return true;
    return false;
}
