/* The switch over shapes. A new shape is in a list of shape.h and has a case in every function that does not treat its
 * list alike; the compiler names those it forgot. */
#include "shape/shape.h"

#include "mesh/mesh.h"
#include "shape/bevelled.h"
#include "shape/blob.h"
#include "shape/box_shape_internal.h"
#include "shape/curve.h"
#include "shape/height_field.h"
#include "shape/implicit.h"
#include "shape/implicit_search_internal.h"
#include "shape/lathe.h"
#include "shape/prism.h"
#include "shape/shape_part.h"
#include "shape/sweep.h"

/* The expected number of crossings of a mesh on the scratch; if there are more, the scratch grows between rays. */
#define MESH_CROSSINGS_GUESS 256
/* The most crossings that the shapes answered by analytic_crossings can have. */
enum { ANALYTIC_MAX = SUPERELLIPSOID_MAX };

/* The shapes whose functions are called alike, family_question(shape, ...), each a case of a switch. */
#define ANALYTIC_FAMILIES(X)                                                                                           \
    X(SHAPE_REVOLVED_QUADRIC, revolved_quadric, &shape->revolved_quadric)                                              \
    X(SHAPE_ELLIPSOID, ellipsoid, &shape->ellipsoid)                                                                   \
    X(SHAPE_TORUS, torus, &shape->torus)                                                                               \
    X(SHAPE_SUPERELLIPSOID, superellipsoid, &shape->superellipsoid)                                                    \
    X(SHAPE_PLANAR, planar, &shape->planar)
#define LISTED_SOLIDS(X)                                                                                               \
    X(SHAPE_LATHE, lathe, shape->lathe)                                                                                \
    X(SHAPE_PRISM, prism, shape->prism)                                                                                \
    X(SHAPE_BEVELLED, bevelled, shape->bevelled)                                                                       \
    X(SHAPE_SWEEP, sweep, shape->sweep)                                                                                \
    X(SHAPE_HEIGHT_FIELD, height_field, shape->height_field)                                                           \
    X(SHAPE_BLOB, blob, shape->blob)
#define LISTED_FAMILIES(X)                                                                                             \
    LISTED_SOLIDS(X) X(SHAPE_IMPLICIT, implicit, shape->implicit) X(SHAPE_CURVE, curve, shape->curve)

const char *shape_kind_name(enum shape_kind kind) {
    static const char *const names[] = {SHAPE_KINDS(LIST_WORD)};
    return names[kind];
}

#define EXTENT(kind, family, of)                                                                                       \
    case kind:                                                                                                         \
        family##_extent(of, g, lo, hi);                                                                                \
        return true;
/* The minimum and the maximum of dot(g, p) over a shape with a closed form for it; false for the others. */
static bool shape_extent(const struct shape *shape, struct vec3 g, double *lo, double *hi) {
    switch (shape->kind) {
    case SHAPE_SPHERE: {
        double middle = vec3_dot(g, shape->sphere.centre), extent = vec3_length(g) * shape->sphere.radius;
        *lo = middle - extent;
        *hi = middle + extent;
        return true;
    }
        ANALYTIC_FAMILIES(EXTENT)
        LISTED_SOLIDS(EXTENT)
        EXTENT(SHAPE_CURVE, curve, shape->curve)
    case SHAPE_QUADRIC:
        return quadric_extent(shape->quadric, g, lo, hi);
    case SHAPE_BOX:
    case SHAPE_IMPLICIT:
    case SHAPE_MESH:
        return false;
    }
    return false;
}

struct box shape_bounds_under(const struct shape *shape, const struct affine *map) {
    double lo[3], hi[3];
    for (int i = 0; i < 3; i++) {
        const double *row = map->m[i];
        if (!shape_extent(shape, vec3_make(row[0], row[1], row[2]), &lo[i], &hi[i])) {
            struct box own = shape_bounds(shape);
            return box_transform(map, &own);
        }
        lo[i] += row[3];
        hi[i] += row[3];
    }
    return (struct box){{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}};
}

#define BOUNDS(kind, family, of)                                                                                       \
    case kind:                                                                                                         \
        return family##_bounds(of);
struct box shape_bounds(const struct shape *shape) {
    switch (shape->kind) {
    case SHAPE_SPHERE: {
        struct vec3 c = shape->sphere.centre, r = vec3_all(shape->sphere.radius);
        return box_pad((struct box){vec3_sub(c, r), vec3_add(c, r)});
    }
    case SHAPE_BOX:
        return shape->box;
    case SHAPE_REVOLVED_QUADRIC:
    case SHAPE_ELLIPSOID:
    case SHAPE_TORUS:
    case SHAPE_SUPERELLIPSOID:
    case SHAPE_PLANAR: {
        struct affine identity = affine_identity();
        return box_pad(shape_bounds_under(shape, &identity));
    }
    case SHAPE_QUADRIC:
        return box_pad(quadric_bounds(shape->quadric));
        LISTED_FAMILIES(BOUNDS)
    case SHAPE_MESH:
        return mesh_bounds(shape->mesh);
    }
    return box_empty();
}

/* Whether the shape under the map is exactly its box. */
static bool is_box_under(const struct shape *shape, const struct affine *map, const struct box *box) {
    switch (shape->kind) {
    case SHAPE_BOX: /* placed along the axes */
        for (int i = 0; i < 3; i++)
            if ((map->m[i][0] != 0) + (map->m[i][1] != 0) + (map->m[i][2] != 0) != 1)
                return false;
        return true;
    case SHAPE_PLANAR: /* a half-space with an end */
        return shape->planar.kind == PLANAR_PLANE &&
               !(box->min.x == -box->max.x && box->min.y == -box->max.y && box->min.z == -box->max.z);
    case SHAPE_SPHERE:
    case SHAPE_MESH:
        ANALYTIC_SOLIDS(LIST_LABEL)
        LISTED_SHAPES(LIST_LABEL)
        break;
    }
    return false;
}

bool shape_inner_box(const struct shape *shape, const struct affine *map, struct box *out) {
    struct box b = shape_bounds_under(shape, map);
    if (!is_box_under(shape, map, &b))
        return false;
    const double all[6] = {b.min.x, b.min.y, b.min.z, b.max.x, b.max.y, b.max.z};
    double largest = 0;
    for (int i = 0; i < 6; i++)
        largest = isfinite(all[i]) && fabs(all[i]) > largest ? fabs(all[i]) : largest;
    struct vec3 margin = vec3_all(largest * 0x1p-40);
    *out = (struct box){vec3_add(b.min, margin), vec3_sub(b.max, margin)};
    return true;
}

enum surface_layout shape_layout(const struct shape *shape) {
    switch (shape->kind) {
    case SHAPE_SPHERE:
        return LAYOUT_SPHERE;
    case SHAPE_BOX:
        return LAYOUT_FACES;
    case SHAPE_PLANAR:
    case SHAPE_MESH:
        ANALYTIC_SOLIDS(LIST_LABEL)
        LISTED_SHAPES(LIST_LABEL)
        break;
    }
    return LAYOUT_UV;
}

enum shape_area shape_area(const struct shape *shape) {
    switch (shape->kind) {
    case SHAPE_SPHERE:
        return SHAPE_AREA_SPHERE;
    case SHAPE_PLANAR:
        return SHAPE_AREA_PLANAR;
    case SHAPE_MESH:
        return SHAPE_AREA_TRIANGLES;
    case SHAPE_BOX:
        ANALYTIC_SOLIDS(LIST_LABEL)
        LISTED_SHAPES(LIST_LABEL)
        break;
    }
    return SHAPE_AREA_UNKNOWN;
}

bool shape_native_uv(const struct shape *shape, const struct hit *hit, double *u, double *v) {
    *u = hit->u;
    *v = hit->v;
    switch (shape_layout(shape)) {
    case LAYOUT_SPHERE: {
        struct surface ball = {.normal = vec3_normalize(hit->pattern_normal)};
        sphere_uv(1, &ball);
        *u = ball.u;
        *v = 1 - ball.v;
        return true;
    }
    case LAYOUT_UV:
    case LAYOUT_FACES:
        break;
    }
    return hit->has_uv;
}

enum hit_convexity shape_convexity(const struct shape *shape) {
    switch (shape->kind) {
    case SHAPE_SPHERE:
    case SHAPE_BOX:
    case SHAPE_ELLIPSOID:
        return CONVEXITY_BEHIND;
    case SHAPE_REVOLVED_QUADRIC:
        return revolved_quadric_is_convex(&shape->revolved_quadric) ? CONVEXITY_BEHIND : CONVEXITY_NONE;
    case SHAPE_PLANAR:
        return CONVEXITY_PLANAR;
    case SHAPE_MESH:
        return CONVEXITY_FACETS;
    case SHAPE_QUADRIC:
    case SHAPE_TORUS:
    case SHAPE_SUPERELLIPSOID:
        LISTED_SHAPES(LIST_LABEL)
        break;
    }
    return CONVEXITY_NONE;
}

const char *shape_why_open(const struct shape *shape) {
    static const char *const no_caps = "has no caps (open = true), so it has no inside";
    switch (shape->kind) {
    case SHAPE_SPHERE:
    case SHAPE_BOX:
    case SHAPE_ELLIPSOID:
    case SHAPE_TORUS:
    case SHAPE_SUPERELLIPSOID:
    case SHAPE_PRISM:
    case SHAPE_BEVELLED:
    case SHAPE_SWEEP:
    case SHAPE_BLOB:
        return NULL;
    case SHAPE_REVOLVED_QUADRIC:
        return revolved_quadric_is_closed(&shape->revolved_quadric) ? NULL : no_caps;
    case SHAPE_QUADRIC:
        return quadric_is_closed(shape->quadric) ? NULL : no_caps;
    case SHAPE_PLANAR:
        return shape->planar.kind == PLANAR_PLANE
                   ? NULL
                   : "is flat, so it has no inside; only a plane with a normal is a half-space";
    case SHAPE_LATHE:
        return lathe_is_closed(shape->lathe) ? NULL
                                             : "is an open lathe: its profile ends off the axis, so it has no inside";
    case SHAPE_HEIGHT_FIELD:
        return height_field_is_closed(shape->height_field)
                   ? NULL
                   : "is a sheet without walls and floor (open = true), so it has no inside";
    case SHAPE_IMPLICIT:
        return implicit_is_closed(shape->implicit)
                   ? NULL
                   : "is an implicit surface without caps on its bounds (open = true), so it has no inside";
    case SHAPE_CURVE:
        return "is a curve, a ribbon without inside";
    case SHAPE_MESH:
        return mesh_is_closed(shape->mesh) ? NULL : "is a mesh with open edges, so it has no inside";
    }
    return NULL;
}

bool shape_is_closed(const struct shape *shape) {
    return !shape_why_open(shape);
}

#define CROSSINGS(kind, family, of)                                                                                    \
    case kind:                                                                                                         \
        return family##_crossings(of, ray, out);
/* All crossings of the whole line in order with a shape that has only a few. */
static int analytic_crossings(const struct shape *shape, const struct ray *ray, struct crossing out[ANALYTIC_MAX]) {
    switch (shape->kind) {
    case SHAPE_SPHERE:
        return sphere_crossings(shape->sphere.centre, shape->sphere.radius, ray, out) ? 2 : 0;
    case SHAPE_BOX:
        return box_shape_crossings(&shape->box, ray, out) ? 2 : 0;
        ANALYTIC_FAMILIES(CROSSINGS)
        CROSSINGS(SHAPE_QUADRIC, quadric, shape->quadric)
    case SHAPE_MESH:
        LISTED_SHAPES(LIST_LABEL)
        break;
    }
    return 0;
}

static bool analytic_nearest(const struct shape *shape, const struct ray *ray, struct crossing *out) {
    struct crossing all[ANALYTIC_MAX];
    int count = analytic_crossings(shape, ray, all);
    for (int i = 0; i < count; i++)
        if (all[i].t > ray->t_min && all[i].t < ray->t_max) {
            *out = all[i];
            return true;
        }
    return false;
}

bool shape_is_listed(const struct shape *shape) {
    switch (shape->kind) {
        ANALYTIC_SHAPES(LIST_LABEL)
        return false;
    case SHAPE_MESH:
        LISTED_SHAPES(LIST_LABEL)
        break;
    }
    return true;
}

#define LISTED_CROSSINGS(kind, family, of)                                                                             \
    case kind:                                                                                                         \
        return family##_crossings(of, ray, scratch, out);
/* The lists of the shapes that may have many crossings. */
static bool listed_crossings(const struct shape *shape, const struct ray *ray, struct geom_scratch *scratch,
                             struct crossing_list *out) {
    switch (shape->kind) {
        LISTED_FAMILIES(LISTED_CROSSINGS)
    case SHAPE_MESH:
        ANALYTIC_SHAPES(LIST_LABEL)
        break;
    }
    *out = (struct crossing_list){scratch->used, 0};
    return true;
}

static bool listed_nearest(const struct shape *shape, const struct ray *ray, struct geom_scratch *scratch,
                           struct crossing *out) {
    struct crossing_list list;
    if (!listed_crossings(shape, ray, scratch, &list))
        return false;
    scratch->used = list.first;
    for (uint32_t i = 0; i < list.count; i++) {
        const struct crossing *c = &scratch->items[list.first + i];
        if (c->t > ray->t_min && c->t < ray->t_max) {
            *out = *c;
            return true;
        }
    }
    return false;
}

bool shape_nearest(const struct shape *shape, const struct ray *ray, struct geom_scratch *scratch,
                   struct crossing *out) {
    switch (shape->kind) {
        ANALYTIC_SHAPES(LIST_LABEL)
        scratch->shape_tests++;
        return analytic_nearest(shape, ray, out);
    case SHAPE_LATHE:
    case SHAPE_PRISM:
    case SHAPE_BEVELLED:
    case SHAPE_SWEEP:
    case SHAPE_BLOB:
    case SHAPE_CURVE:
        scratch->shape_tests++;
        return listed_nearest(shape, ray, scratch, out);
    case SHAPE_IMPLICIT: /* the same crossings, but only the requested ones */
        scratch->shape_tests++;
        return implicit_nearest(shape->implicit, ray, scratch, out);
    case SHAPE_HEIGHT_FIELD: /* the same crossings, without those that come later */
        scratch->shape_tests++;
        return height_field_nearest(shape->height_field, ray, scratch, out);
    case SHAPE_MESH:
        return mesh_nearest(shape->mesh, ray, ACCEL_AUTO, scratch, out);
    }
    return false;
}

bool shape_takes_packets(const struct shape *shape, const struct geom_scratch *scratch) {
    return shape->kind == SHAPE_IMPLICIT && implicit_takes_packets(shape->implicit, scratch);
}

uint64_t shape_nearest_packet(const struct shape *shape, const struct ray *rays, uint64_t active,
                              struct geom_scratch *scratch, struct crossing *out) {
    scratch->shape_tests += (uint64_t)__builtin_popcountll(active);
    return implicit_nearest_packet(shape->implicit, rays, active, scratch, out);
}

bool shape_any(const struct shape *shape, const struct ray *ray, struct geom_scratch *scratch) {
    struct crossing ignored;
    if (shape->kind == SHAPE_MESH)
        return mesh_any(shape->mesh, ray, ACCEL_AUTO, scratch);
    if (shape->kind != SHAPE_IMPLICIT)
        return shape_nearest(shape, ray, scratch, &ignored);
    scratch->shape_tests++;
    return implicit_any(shape->implicit, ray, scratch);
}

static bool analytic_list(const struct shape *shape, const struct ray *ray, struct geom_scratch *scratch,
                          struct crossing_list *out) {
    struct crossing all[ANALYTIC_MAX];
    if (scratch->capacity - scratch->used >= ANALYTIC_MAX) { /* nearly always */
        uint32_t found = (uint32_t)analytic_crossings(shape, ray, &scratch->items[scratch->used]);
        *out = (struct crossing_list){scratch->used, found};
        scratch->used += found;
        return true;
    }
    int count = analytic_crossings(shape, ray, all);
    *out = (struct crossing_list){scratch->used, (uint32_t)count};
    for (int i = 0; i < count; i++)
        if (!geom_scratch_push(scratch, all[i])) {
            scratch->used = out->first;
            return false;
        }
    return true;
}

bool shape_crossings(const struct shape *shape, const struct ray *ray, struct geom_scratch *scratch,
                     struct crossing_list *out) {
    switch (shape->kind) {
        ANALYTIC_SHAPES(LIST_LABEL)
        scratch->shape_tests++;
        return analytic_list(shape, ray, scratch, out);
        LISTED_SHAPES(LIST_LABEL)
        scratch->shape_tests++;
        return listed_crossings(shape, ray, scratch, out);
    case SHAPE_MESH:
        return mesh_crossings(shape->mesh, ray, ACCEL_AUTO, scratch, out);
    }
    return false;
}

/* Parity along one fixed direction, oblique to the usual directions of models; crossings ahead of the point are
 * counted. */
static bool mesh_contains(const struct mesh *mesh, struct vec3 point, struct geom_scratch *scratch) {
    struct box bounds = mesh_bounds(mesh);
    if (!box_contains(&bounds, point))
        return false;
    struct ray ray = {.origin = point,
                      .direction = {0.5773128394, 0.2138497211, 0.7881094327},
                      .t_min = -INFINITY,
                      .t_max = INFINITY};
    struct crossing_list list;
    if (!mesh_crossings(mesh, &ray, ACCEL_AUTO, scratch, &list))
        return false;
    bool inside = false;
    for (uint32_t i = 0; i < list.count; i++)
        inside ^= scratch->items[list.first + i].t > 0;
    scratch->used = list.first;
    return inside;
}

#define CONTAINS(kind, family, of)                                                                                     \
    case kind:                                                                                                         \
        return family##_contains(of, point);
bool shape_contains(const struct shape *shape, struct vec3 point, struct geom_scratch *scratch) {
    switch (shape->kind) {
    case SHAPE_SPHERE:
        return sphere_contains(shape->sphere.centre, shape->sphere.radius, point);
        CONTAINS(SHAPE_BOX, box_shape, &shape->box)
        CONTAINS(SHAPE_QUADRIC, quadric, shape->quadric)
        ANALYTIC_FAMILIES(CONTAINS)
        LISTED_SOLIDS(CONTAINS)
        CONTAINS(SHAPE_IMPLICIT, implicit, shape->implicit)
    case SHAPE_CURVE:
        return false;
    case SHAPE_MESH:
        return mesh_contains(shape->mesh, point, scratch);
    }
    return false;
}

#define DESCRIBE(kind, family, of)                                                                                     \
    case kind:                                                                                                         \
        family##_describe(of, ray, crossing, out);                                                                     \
        return;
void shape_describe(const struct shape *shape, const struct ray *ray, const struct crossing *crossing,
                    struct surface *out) {
    switch (shape->kind) {
    case SHAPE_SPHERE:
        sphere_describe(shape->sphere.centre, shape->sphere.radius, ray, crossing, out);
        return;
        DESCRIBE(SHAPE_BOX, box_shape, &shape->box)
        DESCRIBE(SHAPE_QUADRIC, quadric, shape->quadric)
        DESCRIBE(SHAPE_MESH, mesh, shape->mesh)
        ANALYTIC_FAMILIES(DESCRIBE)
        LISTED_FAMILIES(DESCRIBE)
    }
}

#define SCRATCH_NEED(kind, family, of)                                                                                 \
    case kind:                                                                                                         \
        return family##_scratch_need(of);
uint32_t shape_scratch_need(const struct shape *shape) {
    switch (shape->kind) {
    case SHAPE_SPHERE:
    case SHAPE_BOX:
    case SHAPE_ELLIPSOID:
    case SHAPE_PLANAR:
        return 2;
    case SHAPE_REVOLVED_QUADRIC:
    case SHAPE_QUADRIC:
    case SHAPE_TORUS:
        return 4;
    case SHAPE_SUPERELLIPSOID:
        return SUPERELLIPSOID_MAX;
        LISTED_FAMILIES(SCRATCH_NEED)
    case SHAPE_MESH:
        return MESH_CROSSINGS_GUESS;
    }
    return 0;
}

bool shape_part(const struct shape *shape, uint32_t number, struct shape_part *out) {
    out->kind = SHAPE_PART_BOX;
    switch (shape->kind) {
    case SHAPE_CURVE:
        out->kind = SHAPE_PART_TUBE;
        return curve_piece_tube(shape->curve, number, out->tube);
    case SHAPE_SWEEP:
        out->kind = SHAPE_PART_TUBE;
        return sweep_piece_tube(shape->sweep, number, out->tube);
    case SHAPE_REVOLVED_QUADRIC:
        out->box = oriented_box_of_quadric(&shape->revolved_quadric);
        break;
    case SHAPE_PLANAR:
        out->box = oriented_box_of_planar(&shape->planar);
        break;
    case SHAPE_SPHERE:
    case SHAPE_BOX:
    case SHAPE_ELLIPSOID:
    case SHAPE_QUADRIC:
    case SHAPE_TORUS:
    case SHAPE_SUPERELLIPSOID:
    case SHAPE_LATHE:
    case SHAPE_PRISM:
    case SHAPE_BEVELLED:
    case SHAPE_HEIGHT_FIELD:
    case SHAPE_BLOB:
    case SHAPE_IMPLICIT:
    case SHAPE_MESH: {
        struct box bounds = shape_bounds(shape);
        out->box = oriented_box_of(&bounds);
        break;
    }
    }
    return number == 0 && oriented_box_is_finite(&out->box);
}

void shape_bundle(struct bundle *bundle, void *any) {
    struct shape *shape = any;
    switch (shape->kind) {
    case SHAPE_SPHERE:
    case SHAPE_BOX:
    case SHAPE_REVOLVED_QUADRIC:
    case SHAPE_ELLIPSOID:
    case SHAPE_TORUS:
    case SHAPE_SUPERELLIPSOID:
        return;
    case SHAPE_QUADRIC:
        BUNDLE(bundle, shape->quadric, 1, NULL);
        return;
    case SHAPE_PLANAR:
        planar_bundle(bundle, &shape->planar);
        return;
    case SHAPE_LATHE:
        lathe_bundle(bundle, &shape->lathe);
        return;
    case SHAPE_PRISM:
        prism_bundle(bundle, &shape->prism);
        return;
    case SHAPE_BEVELLED:
        bevelled_bundle(bundle, &shape->bevelled);
        return;
    case SHAPE_SWEEP:
        sweep_bundle(bundle, &shape->sweep);
        return;
    case SHAPE_HEIGHT_FIELD:
        height_field_bundle(bundle, &shape->height_field);
        return;
    case SHAPE_BLOB:
        blob_bundle(bundle, &shape->blob);
        return;
    case SHAPE_IMPLICIT:
        implicit_bundle(bundle, &shape->implicit);
        return;
    case SHAPE_CURVE:
        curve_bundle(bundle, &shape->curve);
        return;
    case SHAPE_MESH:
        mesh_bundle(bundle, &shape->mesh);
        return;
    }
}
