/* Shapes that have a simple parametrisation are grids over it; meshes are their own triangles; other solids are meshed
 * as for printers (solid_mesh.c). Spheres and boxes are made once, of unit size, and placed. */
#include "export/gltf_surface_internal.h"

#include "base/arena.h"
#include "base/hash.h"
#include "base/key_map.h"
#include "csg/csg_build.h"
#include "export/solid_cast_internal.h"
#include "export/solid_mesh_internal.h"
#include "export/triangles_internal.h"
#include "math/elementary.h"
#include "math/frame.h"
#include "mesh/mesh.h"
#include "shape/curve.h"
#include "shape/height_field.h"
#include "shape/sweep.h"

#include <math.h>
#include <stdlib.h>

void gltf_surface_destroy(struct gltf_surface *surface) {
    list_destroy(&surface->vertices);
    list_destroy(&surface->triangles);
}

static void set_floats(float out[3], struct vec3 v) {
    for (int i = 0; i < 3; i++)
        out[i] = (float)vec3_get(v, i) + 0.0F; /* -0 is 0 */
}

static struct gltf_vertex vertex_make(struct vec3 point, struct vec3 normal, double u, double v) {
    struct gltf_vertex vertex = {.uv = {(float)u, (float)v}, .colour = {1, 1, 1}};
    set_floats(vertex.point, point);
    set_floats(vertex.normal, vec3_max_abs(normal) > 0 ? vec3_normalize(normal) : vec3_make(0, 1, 0));
    return vertex;
}

/* Triangles with a side of no length are left out. */
static bool add_triangle(struct gltf_surface *s, uint32_t a, uint32_t b, uint32_t c) {
    const struct gltf_vertex *v = gltf_vertices(s);
    const size_t size = sizeof v->point;
    const struct gltf_triangle triangle = {{a, b, c}, s->material};
    return memcmp(v[a].point, v[b].point, size) == 0 || memcmp(v[b].point, v[c].point, size) == 0 ||
           memcmp(v[c].point, v[a].point, size) == 0 || list_add(&s->triangles, &triangle, 1, sizeof triangle);
}

/* --- grids --- */

/* A point and its normal for u and v from 0 to 1, u to the right and v upwards as seen from outside. */
typedef void grid_function(const void *context, double u, double v, struct vec3 *point, struct vec3 *normal);
struct surface_grid {
    grid_function *at;
    const void *context;
    uint32_t columns, rows;
};
static const double whole[4] = {0, 0, 1, 1}; /* of the unit square: a corner, and the size */

static bool add_grid(struct gltf_surface *s, const struct surface_grid *grid, const double part[4]) {
    uint32_t first = (uint32_t)s->vertices.count, width = grid->columns + 1;
    bool ok = true;
    for (uint32_t i = 0; ok && i < width * (grid->rows + 1); i++) {
        double u = (double)(i % width) / grid->columns, v = (double)(i / width) / grid->rows;
        struct vec3 point, normal;
        grid->at(grid->context, u, v, &point, &normal);
        struct gltf_vertex vertex = vertex_make(point, normal, part[0] + u * part[2], part[1] + v * part[3]);
        ok = list_add(&s->vertices, &vertex, 1, sizeof vertex);
    }
    for (uint32_t i = 0; ok && i < grid->columns * grid->rows; i++) {
        uint32_t a = first + i / grid->columns * width + i % grid->columns, d = a + width;
        ok = add_triangle(s, a, a + 1, s->falls ? d : d + 1) && add_triangle(s, s->falls ? a + 1 : a, d + 1, d);
    }
    s->has_normals = s->is_unfolded = true;
    return ok;
}

/* The number of chords of a circle that are within a share of its diameter. */
static uint32_t chords(double share) {
    double count = PI / el_acos(math_max(1 - 2 * share, -1));
    return 4 * (uint32_t)math_min(math_max(ceil(count / 4), 3), 256);
}

static struct vec3 circle_at(double u, struct vec3 x, struct vec3 y) {
    double sine, cosine;
    el_sincos(2 * PI * u, &sine, &cosine);
    return vec3_add(vec3_scale(x, cosine), vec3_scale(y, sine));
}

static const struct vec3 x_axis = {1, 0, 0}, y_axis = {0, 1, 0}, back = {0, 0, -1};

struct ball {
    struct vec3 centre;
    double radius;
};

static void ball_at(const void *context, double u, double v, struct vec3 *point, struct vec3 *normal) {
    const struct ball *ball = context;
    struct vec3 side = circle_at(v == 1 ? 0.25 : v / 2 - 0.25, x_axis, y_axis);
    double radius = v == 0 || v == 1 ? 0 : side.x;
    *normal = vec3_add_scaled(vec3_scale(y_axis, side.y), circle_at(u == 1 ? 0 : u, x_axis, back), radius);
    *point = vec3_add_scaled(ball->centre, *normal, ball->radius);
}

static bool add_ball(struct gltf_surface *s, const struct ball *ball, uint32_t columns) {
    return ball->radius == 0 || add_grid(s, &(struct surface_grid){ball_at, ball, columns, columns / 2}, whole);
}

static void torus_at(const void *context, double u, double v, struct vec3 *point, struct vec3 *normal) {
    const struct torus *torus = context;
    struct vec3 out = circle_at(u == 1 ? 0 : u, x_axis, back);
    *normal = circle_at(v == 1 ? -0.5 : v - 0.5, out, y_axis);
    *point = vec3_add(vec3_scale(out, torus->major), vec3_scale(*normal, torus->minor));
}

struct turned {
    const struct revolved_quadric *shape;
    struct vec3 x, y;
    double height, radius; /* of an end */
};

static void side_at(const void *context, double u, double v, struct vec3 *point, struct vec3 *normal) {
    const struct turned *t = context;
    const struct revolved_quadric *q = t->shape;
    double s = q->lo + v * (q->hi - q->lo), radius = sqrt(math_max((q->a * s + q->b) * s + q->c, 0));
    struct vec3 out = circle_at(u == 1 ? 0 : u, t->x, t->y);
    /* The gradient; at a tip, where it is 0, that of points nearby. */
    double slope = q->a * s + q->b / 2, near = radius;
    if (radius == 0) {
        double other = s == q->lo ? q->lo + (q->hi - q->lo) / 1024 : s - (q->hi - q->lo) / 1024;
        near = sqrt(math_max((q->a * other + q->b) * other + q->c, 0));
        slope = q->a * other + q->b / 2;
    }
    *normal = vec3_add_scaled(vec3_scale(out, near), q->axis, -slope);
    *point = vec3_add_scaled(vec3_add_scaled(q->base, q->axis, s), out, radius);
}

/* v runs inwards, where u runs to the right seen from the outside of the end. */
static void end_at(const void *context, double u, double v, struct vec3 *point, struct vec3 *normal) {
    const struct turned *t = context;
    struct vec3 out = circle_at(u == 1 ? 0 : u, t->x, t->y);
    *normal = vec3_cross(t->x, t->y);
    *point = vec3_add_scaled(vec3_add_scaled(t->shape->base, t->shape->axis, t->height), out, t->radius * (1 - v));
}

static bool add_turned(struct gltf_surface *s, const struct revolved_quadric *q, uint32_t columns) {
    struct vec3 x, y;
    frame_tangents(q->axis, &x, &y);
    y = vec3_cross(q->axis, x);
    struct turned turned = {.shape = q, .x = x, .y = y};
    bool straight = fabs(q->b * q->b - 4 * q->a * q->c) <= 1e-12 * (q->b * q->b + fabs(4 * q->a * q->c));
    const double rim = q->open ? 0 : 0.25, side[4] = {0, 0, 1, 1 - rim};
    bool ok = add_grid(s, &(struct surface_grid){side_at, &turned, columns, straight ? 1 : columns}, side);
    for (int end = 0; ok && end < 2 && !q->open; end++) {
        const double part[4] = {end / 2.0, 1 - rim, 0.5, rim};
        turned.height = end ? q->hi : q->lo;
        turned.radius = sqrt(math_max((q->a * turned.height + q->b) * turned.height + q->c, 0));
        turned.y = end ? y : vec3_negate(y);
        ok = turned.radius == 0 || add_grid(s, &(struct surface_grid){end_at, &turned, columns, 1}, part);
    }
    s->is_open = q->open;
    return ok;
}

/* A corner, and the edges along u and v. */
static void rectangle_at(const void *context, double u, double v, struct vec3 *point, struct vec3 *normal) {
    const struct vec3 *corner = context;
    *normal = vec3_cross(corner[1], corner[2]);
    *point = vec3_add_scaled(vec3_add_scaled(corner[0], corner[1], u), corner[2], v);
}

static bool add_rectangle(struct gltf_surface *s, const struct vec3 corner[3], const double part[4]) {
    return add_grid(s, &(struct surface_grid){rectangle_at, corner, 1, 1}, part);
}

static bool add_box(struct gltf_surface *s) {
    bool ok = true;
    for (int side = 0; ok && side < 6; side++) {
        const int i = side / 2;
        const double part[4] = {side % 3 / 3.0, side / 3 / 2.0, 1 / 3.0, 1 / 2.0};
        struct vec3 u = vec3_make(i == 2, i == 0, i == 1), v = vec3_make(i == 1, i == 2, i == 0);
        const struct vec3 corner[3] = {side % 2 ? vec3_sub(vec3_all(1), vec3_add(u, v)) : vec3_all(0), side % 2 ? u : v,
                                       side % 2 ? v : u};
        ok = add_rectangle(s, corner, part);
    }
    return ok;
}

/* --- flat shapes --- */

static bool add_planar_vertex(struct gltf_surface *s, const struct planar *p, double a, double b) {
    struct vec3 point = vec3_add_scaled(vec3_add_scaled(p->origin, p->u, a), p->v, b);
    struct gltf_vertex vertex = vertex_make(point, p->normal, a, b);
    return list_add(&s->vertices, &vertex, 1, sizeof vertex);
}

/* The ring from the hole to the edge, which u follows. */
static void ring_at(const void *context, double u, double v, struct vec3 *point, struct vec3 *normal) {
    const struct planar *p = context;
    *normal = p->normal;
    *point = vec3_add_scaled(p->origin, circle_at(u == 1 ? 0 : u, p->u, p->v), p->inner * v + 1 - v);
}

struct slab_crossing {
    double low, high; /* a at the two ends of a slab */
};

static int by_number(const void *left, const void *right) {
    double a = *(const double *)left, b = *(const double *)right;
    return (a > b) - (a < b);
}

static int by_middle(const void *left, const void *right) {
    const struct slab_crossing *a = left, *b = right;
    double x = a->low + a->high, y = b->low + b->high;
    return (x > y) - (x < y);
}

/* Between two levels of b next to each other, the outlines are lines: the even ones begin trapezoids. */
static bool add_slab(struct gltf_surface *s, const struct planar *p, const double levels[2]) {
    struct list found = {0};
    const double(*points)[2];
    uint32_t count;
    bool ok = true;
    for (uint32_t outline = 0; (points = planar_outline(p, outline, &count)); outline++)
        for (uint32_t i = 0; ok && i < count; i++) {
            const double *next = points[(i + 1) % count], *low = points[i][1] < next[1] ? points[i] : next,
                         *high = low == next ? points[i] : next;
            if (low[1] > levels[0] || high[1] < levels[1])
                continue;
            const double slope = (high[0] - low[0]) / (high[1] - low[1]);
            const struct slab_crossing at = {low[0] + (levels[0] - low[1]) * slope,
                                             low[0] + (levels[1] - low[1]) * slope};
            ok = list_add(&found, &at, 1, sizeof at);
        }
    const struct slab_crossing *at = found.items;
    if (found.count > 1)
        qsort(found.items, found.count, sizeof *at, by_middle);
    for (size_t i = 0; ok && i + 1 < found.count; i += 2) {
        uint32_t first = (uint32_t)s->vertices.count;
        ok = add_planar_vertex(s, p, at[i].low, levels[0]) && add_planar_vertex(s, p, at[i + 1].low, levels[0]) &&
             add_planar_vertex(s, p, at[i + 1].high, levels[1]) && add_planar_vertex(s, p, at[i].high, levels[1]) &&
             add_triangle(s, first, first + 1, first + 2) && add_triangle(s, first, first + 2, first + 3);
    }
    list_destroy(&found);
    return ok;
}

static bool add_polygon(struct gltf_surface *s, const struct planar *p) {
    struct list levels = {0};
    const double(*points)[2];
    uint32_t count;
    bool ok = true;
    for (uint32_t outline = 0; (points = planar_outline(p, outline, &count)); outline++)
        for (uint32_t i = 0; ok && i < count; i++)
            ok = list_add(&levels, &points[i][1], 1, sizeof(double));
    double *level = levels.items;
    if (levels.count > 1)
        qsort(level, levels.count, sizeof *level, by_number);
    for (size_t i = 0; ok && i + 1 < levels.count; i++)
        ok = level[i] == level[i + 1] || add_slab(s, p, &level[i]);
    list_destroy(&levels);
    return ok;
}

static bool add_planar(struct gltf_surface *s, const struct planar *p, uint32_t columns) {
    const struct vec3 corner[3] = {p->origin, p->u, p->v};
    bool ok = true;
    switch (p->kind) {
    case PLANAR_PLANE:
        break;
    case PLANAR_PARALLELOGRAM:
        s->has_uv = true;
        ok = add_rectangle(s, corner, whole);
        break;
    case PLANAR_DISC:
        ok = add_grid(s, &(struct surface_grid){ring_at, p, columns, 1}, whole);
        break;
    case PLANAR_TRIANGLE:
        ok = add_planar_vertex(s, p, 0, 0) && add_planar_vertex(s, p, 1, 0) && add_planar_vertex(s, p, 0, 1) &&
             add_triangle(s, 0, 1, 2);
        break;
    case PLANAR_POLYGON:
        ok = add_polygon(s, p);
        break;
    }
    s->has_normals = s->is_unfolded = s->is_open = true;
    return ok;
}

/* --- other shapes --- */

/* The number of a vertex, which is new if there is none of these bytes. */
static bool find_vertex(struct gltf_surface *s, struct key_map *known, const struct gltf_vertex *vertex,
                        uint32_t *number) {
    uint64_t key = hash_bytes(vertex, sizeof *vertex, 0) | 1;
    const uint32_t *at = key_map_find(known, key);
    *number = at ? *at : (uint32_t)s->vertices.count;
    if (at && memcmp(&gltf_vertices(s)[*at], vertex, sizeof *vertex) == 0)
        return true;
    *number = (uint32_t)s->vertices.count;
    return (at || key_map_add(known, key, *number)) && list_add(&s->vertices, vertex, 1, sizeof *vertex);
}

static bool add_mesh(struct gltf_surface *s, const struct mesh *mesh, const struct prototype *prototype) {
    const struct ray ray = {.direction = {0, 0, 1}};
    struct key_map known = {0};
    bool ok = true;
    s->has_uv = mesh_has_uv(mesh);
    s->is_open = !mesh_is_closed(mesh);
    for (uint32_t i = 0; ok && i < mesh_triangle_count(mesh); i++)
        s->has_normals = s->has_normals || !mesh_is_plain(mesh, i);
    for (uint32_t i = 0; ok && i < mesh_triangle_count(mesh); i++) {
        struct vec3 corners[3];
        uint32_t slot, vertex[3];
        mesh_triangle(mesh, i, corners, &slot);
        for (int k = 0; ok && k < 3; k++) {
            const struct crossing crossing = {.u = k == 1, .v = k == 2, .part = i, .enter = true};
            struct surface at;
            mesh_describe(mesh, &ray, &crossing, &at);
            struct gltf_vertex own = vertex_make(corners[k], s->has_normals ? at.shading_normal : y_axis, at.u, at.v);
            if (at.has_colour)
                set_floats(own.colour, vec3_make(at.colour.r, at.colour.g, at.colour.b));
            s->has_colours = s->has_colours || at.has_colour;
            ok = find_vertex(s, &known, &own, &vertex[k]);
        }
        s->material = prototype->material + (prototype->slot_count > 1 ? slot : 0);
        ok = ok && add_triangle(s, vertex[0], vertex[1], vertex[2]);
    }
    key_map_destroy(&known);
    return ok;
}

struct heights {
    struct height_field_input field;
    struct vec3 corner, along; /* of a wall */
};

static double height_at(const struct height_field_input *f, int64_t x, int64_t z) {
    int64_t column = x < 0 ? 0 : x >= f->columns ? f->columns - 1 : x, row = z < 0 ? 0 : z >= f->rows ? f->rows - 1 : z;
    return f->heights[row * f->columns + column];
}

static void height_field_at(const void *context, double u, double v, struct vec3 *point, struct vec3 *normal) {
    const struct height_field_input *f = &((const struct heights *)context)->field;
    int64_t x = (int64_t)(u * (f->columns - 1) + 0.5), z = (int64_t)((1 - v) * (f->rows - 1) + 0.5);
    double across =
        (height_at(f, x + 1, z) - height_at(f, x - 1, z)) * (f->columns - 1) / (x > 0 && x + 1 < f->columns ? 2 : 1);
    double along =
        (height_at(f, x, z + 1) - height_at(f, x, z - 1)) * (f->rows - 1) / (z > 0 && z + 1 < f->rows ? 2 : 1);
    *point = vec3_make((double)x / (f->columns - 1), height_at(f, x, z), (double)z / (f->rows - 1));
    *normal = vec3_make(-across, 1, -along);
}

static void wall_at(const void *context, double u, double v, struct vec3 *point, struct vec3 *normal) {
    const struct heights *h = context;
    const struct height_field_input *f = &h->field;
    struct vec3 at = vec3_add_scaled(h->corner, h->along, u);
    at.y = v == 0 ? f->floor
                  : height_at(f, (int64_t)(at.x * (f->columns - 1) + 0.5), (int64_t)(at.z * (f->rows - 1) + 0.5));
    *normal = vec3_cross(h->along, y_axis);
    *point = at;
}

static bool add_height_field(struct gltf_surface *s, const struct height_field *field, struct arena *arena,
                             struct error *error) {
    struct heights h = {.corner = {0, 0, 0}};
    if (!height_field_refine(field, 1, arena, &h.field, error))
        return false;
    const uint32_t columns = h.field.columns - 1, rows = h.field.rows - 1;
    const double top[4] = {0, 0, 1, h.field.open ? 1 : 0.75}, below[4] = {0.8, 0.75, 0.2, 0.25};
    const struct vec3 floor[3] = {{0, h.field.floor, 0}, x_axis, vec3_negate(back)};
    s->falls = true;
    bool ok = add_grid(s, &(struct surface_grid){height_field_at, &h, columns, rows}, top);
    s->falls = false;
    for (int i = 0; ok && i < 4 && !h.field.open; i++) {
        const double part[4] = {0.2 * i, 0.75, 0.2, 0.25};
        h.corner = vec3_make(i == 1 || i == 2, 0, i < 2);
        h.along = i == 0 ? x_axis : i == 1 ? back : i == 2 ? vec3_negate(x_axis) : vec3_negate(back);
        ok = add_grid(s, &(struct surface_grid){wall_at, &h, i % 2 ? rows : columns, 1}, part);
    }
    ok = ok && (h.field.open || add_rectangle(s, floor, below));
    s->is_open = h.field.open;
    s->has_normals = h.field.smooth;
    return ok || error_no_memory(error, "a height field");
}

/* A piece of a sweep, or of a curve, which faces every ray: the balls along it touch their envelope in circles. */
struct tube {
    double points[4][4]; /* of x, y, z and of the radius, the four Bezier points */
};

/* The ball at w, and how its place and radius grow there. */
static struct vec3 tube_ball(const struct tube *tube, double w, double *radius, struct vec3 *along, double *widening) {
    const double(*p)[4] = tube->points;
    double at[4], to[4], v = 1 - w;
    for (int k = 0; k < 4; k++) {
        at[k] = v * v * (v * p[k][0] + 3 * w * p[k][1]) + w * w * (3 * v * p[k][2] + w * p[k][3]);
        to[k] = 3 * (v * v * (p[k][1] - p[k][0]) + 2 * v * w * (p[k][2] - p[k][1]) + w * w * (p[k][3] - p[k][2]));
    }
    *radius = at[3];
    *along = vec3_make(to[0], to[1], to[2]);
    *widening = to[3];
    return vec3_make(at[0], at[1], at[2]);
}

static void tube_at(const void *context, double u, double v, struct vec3 *point, struct vec3 *normal) {
    struct vec3 along, x, y;
    double radius, widening;
    *point = tube_ball(context, v, &radius, &along, &widening);
    double speed = vec3_length(along), slope = speed > 0 ? math_min(math_max(widening / speed, -1), 1) : 0;
    along = speed > 0 ? vec3_scale(along, 1 / speed) : y_axis;
    frame_tangents(along, &x, &y);
    y = vec3_cross(along, x);
    *normal = vec3_scale(circle_at(u == 1 ? 0 : u, x, y), sqrt(1 - slope * slope));
    *normal = vec3_add_scaled(*normal, along, -slope);
    *point = vec3_add_scaled(*point, *normal, radius);
}

/* Tubes; a sweep has balls where its path ends or turns. */
static bool add_tubes(struct gltf_surface *s, const struct shape *shape, double tolerance) {
    const bool is_sweep = shape->kind == SHAPE_SWEEP;
    struct vec3 before = {0, 0, 0};
    struct ball last = {.radius = 0};
    struct tube tube;
    bool ok = true;
    for (uint32_t i = 0; ok && (is_sweep ? sweep_piece_tube(shape->sweep, i, tube.points)
                                         : curve_piece_tube(shape->curve, i, tube.points));
         i++) {
        struct vec3 along;
        struct ball first;
        double unused;
        first.centre = tube_ball(&tube, 0, &first.radius, &along, &unused);
        const uint32_t columns = is_sweep ? chords(tolerance / math_max(2 * first.radius, tolerance)) : 8;
        bool goes_on = vec3_length(vec3_sub(first.centre, last.centre)) <= 1e-9 * first.radius &&
                       vec3_dot(before, along) > 0.999 * vec3_length(before) * vec3_length(along);
        if (is_sweep && !goes_on)
            ok = add_ball(s, &last, columns) && add_ball(s, &first, columns);
        ok = ok && add_grid(s, &(struct surface_grid){tube_at, &tube, columns, 4}, whole);
        last.centre = tube_ball(&tube, 1, &last.radius, &before, &unused);
    }
    ok = ok && (!is_sweep || add_ball(s, &last, chords(tolerance / math_max(2 * last.radius, tolerance))));
    s->is_unfolded = false;
    s->is_open = !is_sweep;
    return ok;
}

/* The normal of a vertex for a triangle: of those of its piece of the surface, else of all, the one that is nearest to
 * the triangle's own. */
static struct vec3 normal_for(const struct solid_vertex *vertex, uint32_t surface, struct vec3 facet) {
    const double smooth = 0.5; /* cosine of the largest angle to the triangle */
    struct vec3 best = facet;
    double nearest = smooth;
    for (int i = 0; i <= vertex->sharp; i++) {
        double cosine = vec3_dot(vec3_normalize(vertex->normal[i]), facet), own = vertex->surface[i] == surface;
        if (cosine <= smooth || cosine + own <= nearest)
            continue;
        best = vertex->normal[i];
        nearest = cosine + own;
    }
    return best;
}

static bool add_solid_mesh(struct gltf_surface *s, const struct solid_mesh *mesh, const struct csg *csg) {
    struct key_map known = {0};
    bool ok = true;
    for (uint32_t i = 0; ok && i < mesh->triangles.count; i++) {
        const struct solid_triangle *triangle = solid_triangle_at(mesh, i);
        const struct corners corners = corners_of(mesh, i);
        struct vec3 facet = vec3_normalize(triangle_normal(corners.point));
        uint32_t vertex[3];
        for (int k = 0; ok && k < 3; k++) {
            const struct solid_vertex *at = solid_vertex_at(mesh, triangle->vertex[k]);
            struct gltf_vertex own = vertex_make(at->point, normal_for(at, triangle->surface, facet), 0, 0);
            ok = find_vertex(s, &known, &own, &vertex[k]);
        }
        s->material = csg->leaves[solid_leaf(triangle->surface)].material;
        ok = ok && add_triangle(s, vertex[0], vertex[1], vertex[2]);
    }
    s->has_normals = true;
    key_map_destroy(&known);
    return ok;
}

static bool add_solid(struct gltf_surface *s, const struct gltf_source *source, struct arena *arena,
                      struct error *error) {
    const struct prototype *prototype = primitive_prototype(source->world, source->primitive);
    const struct csg_leaf leaf = {.shape = prototype->geometry.shape,
                                  .csg_from_leaf = transform_identity(),
                                  .material = prototype->material,
                                  .slot_count = prototype->slot_count};
    const struct csg_token token = {.operation = CSG_LEAF};
    const struct csg *csg = prototype->geometry.csg;
    if (!csg && !(csg = csg_build(arena, &leaf, 1, &token, 1, error)))
        return false;
    struct box box = csg->bounds;
    struct solid_input input = {.csg = csg,
                                .name = primitive_node(source->world, source->primitive)->name,
                                .tolerance = source->solid_share * vec3_max_abs(vec3_sub(box.max, box.min)),
                                .pool = source->pool,
                                .may_have_faults = true};
    struct solid_mesh mesh = {0};
    struct solid_findings findings;
    bool ok = solid_mesh_build(&input, &mesh, &findings, error);
    if (!ok && error->kind == ERROR_SCENE && !error->limit) {
        *error = (struct error){0};
        s->why = "is empty";
        return true;
    }
    s->why = findings.has_faults ? "has finer details than its mesh, which is further away than the tolerance" : NULL;
    ok = ok && (add_solid_mesh(s, &mesh, csg) || error_no_memory(error, "the mesh of a solid"));
    solid_mesh_destroy(&mesh);
    return ok;
}

static const char *why_left_out(const struct geometry *geometry) {
    struct box box = geometry_bounds(geometry);
    if (box_is_empty(&box))
        return "is empty";
    if (!vec3_finite(box.min) || !vec3_finite(box.max) || (geometry->csg && geometry->csg->inside_out))
        return "has no end";
    return geometry->csg && geometry->csg->clipped ? "is cut open" : NULL;
}

bool gltf_surface_is_unit(const struct geometry *geometry, struct transform *object_from_surface) {
    const struct shape *shape = &geometry->shape;
    struct vec3 origin = vec3_all(0), size = vec3_all(1);
    bool is_sphere = shape->kind == SHAPE_SPHERE, is_ellipsoid = shape->kind == SHAPE_ELLIPSOID;
    if (geometry->csg || !(is_sphere || is_ellipsoid || shape->kind == SHAPE_BOX))
        return false;
    origin = is_sphere ? shape->sphere.centre : is_ellipsoid ? shape->ellipsoid.centre : shape->box.min;
    size = is_sphere      ? vec3_all(shape->sphere.radius)
           : is_ellipsoid ? shape->ellipsoid.radii
                          : vec3_sub(shape->box.max, shape->box.min);
    struct transform scale = transform_scale(size), move = transform_translate(origin);
    *object_from_surface = transform_compose(&move, &scale);
    return true;
}

/* Whether the side is there from end to end. */
static bool is_whole(const struct revolved_quadric *q) {
    double middle = -q->b / (2 * q->a), slack = 1e-12 * fabs(q->c);
    double min_square = q->a > 0 && middle > q->lo && middle < q->hi ? (q->a * middle + q->b) * middle + q->c : 0;
    return min_square >= -slack && (q->a * q->lo + q->b) * q->lo + q->c >= -slack &&
           (q->a * q->hi + q->b) * q->hi + q->c >= -slack;
}

bool gltf_surface_make(const struct gltf_source *source, struct gltf_surface *out, struct error *error) {
    const struct prototype *prototype = primitive_prototype(source->world, source->primitive);
    const double share = source->share;
    const struct shape *shape = &prototype->geometry.shape;
    const struct box box = geometry_bounds(&prototype->geometry);
    struct arena arena = {0};
    bool ok = true, is_solid = prototype->geometry.csg != NULL;
    const uint32_t columns = chords(share);
    uint32_t rows;
    *out = (struct gltf_surface){.object_from_surface = transform_identity(),
                                 .why = why_left_out(&prototype->geometry),
                                 .material = prototype->material};
    if (out->why)
        return true;
    out->is_unit = gltf_surface_is_unit(&prototype->geometry, &out->object_from_surface);
    switch (is_solid ? SHAPE_BLOB : shape->kind) {
    case SHAPE_SPHERE:
    case SHAPE_ELLIPSOID:
        ok = add_ball(out, &(struct ball){{0, 0, 0}, 1}, columns);
        break;
    case SHAPE_BOX:
        ok = add_box(out);
        break;
    case SHAPE_REVOLVED_QUADRIC:
        is_solid = !is_whole(&shape->revolved_quadric);
        if (is_solid && shape->revolved_quadric.open)
            out->why = "has no caps";
        ok = is_solid || add_turned(out, &shape->revolved_quadric, columns);
        break;
    case SHAPE_TORUS:
        is_solid = shape->torus.minor > shape->torus.major;
        rows = chords(share * (shape->torus.major + shape->torus.minor) / shape->torus.minor);
        ok = is_solid || add_grid(out, &(struct surface_grid){torus_at, &shape->torus, columns, rows}, whole);
        break;
    case SHAPE_PLANAR:
        ok = add_planar(out, &shape->planar, columns);
        break;
    case SHAPE_HEIGHT_FIELD:
        ok = add_height_field(out, shape->height_field, &arena, error);
        break;
    case SHAPE_CURVE:
    case SHAPE_SWEEP:
        ok = add_tubes(out, shape, share * vec3_max_abs(vec3_sub(box.max, box.min)));
        break;
    case SHAPE_MESH:
        ok = add_mesh(out, shape->mesh, prototype);
        break;
    case SHAPE_QUADRIC:
    case SHAPE_LATHE:
    case SHAPE_IMPLICIT:
        out->why = shape_why_open(shape);
        is_solid = true;
        break;
    case SHAPE_SUPERELLIPSOID:
    case SHAPE_PRISM:
    case SHAPE_BEVELLED:
    case SHAPE_BLOB:
        is_solid = true;
        break;
    }
    if (!ok && error->kind == ERROR_NONE)
        (void)error_no_memory(error, "the surfaces of a model");
    ok = ok && (!is_solid || out->why || add_solid(out, source, &arena, error));
    arena_destroy(&arena);
    double stretch = out->is_unit ? transform_stretch(&out->object_from_surface) : 1;
    out->tolerance = math_max(share, source->solid_share) * vec3_max_abs(vec3_sub(box.max, box.min)) / stretch;
    return ok;
}

void gltf_directions(const struct gltf_surface *surface, const struct gltf_triangle *triangle, const struct affine *map,
                     struct vec3 out[2]) {
    const struct gltf_vertex *all = gltf_vertices(surface), *o = &all[triangle->vertex[0]];
    struct vec3 edge[2];
    double du[2], dv[2];
    for (int k = 0; k < 2; k++) {
        const struct gltf_vertex *v = &all[triangle->vertex[k + 1]];
        du[k] = (double)v->uv[0] - (double)o->uv[0];
        dv[k] = (double)v->uv[1] - (double)o->uv[1];
        edge[k] = vec3_sub(gltf_point(v->point), gltf_point(o->point));
        edge[k] = map ? affine_vector(map, edge[k]) : edge[k];
    }
    double sign = du[0] * dv[1] - du[1] * dv[0] < 0 ? -1 : 1;
    out[0] = vec3_scale(vec3_add_scaled(vec3_scale(edge[0], dv[1]), edge[1], -dv[0]), sign);
    out[1] = vec3_scale(vec3_add_scaled(vec3_scale(edge[1], du[0]), edge[0], -du[1]), sign);
}

bool gltf_surface_unfold(struct gltf_surface *surface, uint32_t size, uint32_t smallest) {
    size_t count = surface->triangles.count, pairs = (count + 1) / 2;
    uint32_t side = (uint32_t)ceil(sqrt((double)pairs)), cell = side ? size / side : 0;
    struct list vertices = {0};
    if (cell < smallest)
        return false;
    for (size_t i = 0; i < count; i++) {
        /* Two triangles in a cell, with some steps between their long sides. */
        struct gltf_triangle *triangle = &gltf_triangles(surface)[i];
        double x = (double)(i / 2 % side * cell), y = (double)(i / 2 / side * cell), leg = cell - 4.0;
        double corner = i % 2 ? cell - 0.5 : 0.5, step = i % 2 ? -leg : leg;
        const double at[3][2] = {{corner, corner}, {corner + step, corner}, {corner, corner + step}};
        for (int k = 0; k < 3; k++) {
            struct gltf_vertex vertex = gltf_vertices(surface)[triangle->vertex[k]];
            vertex.uv[0] = (float)((x + at[k][0]) / size);
            vertex.uv[1] = (float)((y + at[k][1]) / size);
            triangle->vertex[k] = (uint32_t)vertices.count;
            if (!list_add(&vertices, &vertex, 1, sizeof vertex)) {
                list_destroy(&vertices);
                return false;
            }
        }
    }
    list_destroy(&surface->vertices);
    surface->vertices = vertices;
    surface->is_unfolded = true;
    surface->has_uv = false;
    return true;
}
