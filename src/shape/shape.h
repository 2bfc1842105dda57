/* Shapes: a closed tagged union; one file for the mathematics of each family, this module switches (no default, so that
 * the compiler names the switch a new kind forgot). All rays are in the shape's object space; their directions are not
 * normalised. For analytic shapes one root-finder serves all: shape_crossings gives every crossing of the whole line in
 * order, the nearest hit is the first of them inside the ray's interval, CSG merges the lists. */
#ifndef GRAY_SHAPE_SHAPE_H
#define GRAY_SHAPE_SHAPE_H

#include "base/bundle.h"
#include "base/list.h"
#include "geometry/crossing.h"
#include "geometry/hit.h"
#include "math/box.h"
#include "math/ray.h"
#include "shape/planar.h"
#include "shape/quadric.h"
#include "shape/revolved_quadric.h"
#include "shape/sphere.h"
#include "shape/superellipsoid.h"
#include "shape/torus.h"

struct mesh;
struct lathe;
struct prism;
struct bevelled;
struct sweep_path;
struct height_field;
struct blob;
struct curve;
struct implicit;

/* Every kind, with its name in scene dumps and traces. A switch names a whole list where its shapes have one answer.
 * Analytic shapes have few crossings, from a formula; listed shapes a list of any length. */
#define ANALYTIC_SOLIDS(X)                                                                                             \
    X(SHAPE_REVOLVED_QUADRIC, "conic")                                                                                 \
    X(SHAPE_ELLIPSOID, "ellipsoid")                                                                                    \
    X(SHAPE_QUADRIC, "quadric")                                                                                        \
    X(SHAPE_TORUS, "torus")                                                                                            \
    X(SHAPE_SUPERELLIPSOID, "superellipsoid")
#define ANALYTIC_SHAPES(X)                                                                                             \
    X(SHAPE_SPHERE, "sphere")                                                                                          \
    X(SHAPE_BOX, "box")                                                                                                \
    ANALYTIC_SOLIDS(X)                                                                                                 \
    X(SHAPE_PLANAR, "flat")
#define LISTED_SHAPES(X)                                                                                               \
    X(SHAPE_LATHE, "lathe")                                                                                            \
    X(SHAPE_PRISM, "prism")                                                                                            \
    X(SHAPE_BEVELLED, "bevelled")                                                                                      \
    X(SHAPE_SWEEP, "sweep")                                                                                            \
    X(SHAPE_HEIGHT_FIELD, "height field")                                                                              \
    X(SHAPE_BLOB, "blob")                                                                                              \
    X(SHAPE_IMPLICIT, "implicit")                                                                                      \
    X(SHAPE_CURVE, "curve")
#define SHAPE_KINDS(X) ANALYTIC_SHAPES(X) LISTED_SHAPES(X) X(SHAPE_MESH, "mesh")
enum shape_kind { SHAPE_KINDS(LIST_MEMBER) };
enum { SHAPE_KIND_COUNT = LIST_COUNT(SHAPE_KINDS) };

struct shape {
    enum shape_kind kind;
    union {
        struct {
            struct vec3 centre;
            double radius; /* > 0 */
        } sphere;
        struct box box; /* min < max on every axis */
        struct revolved_quadric revolved_quadric;
        struct ellipsoid ellipsoid;
        const struct quadric *quadric;
        struct torus torus;
        struct superellipsoid superellipsoid;
        struct planar planar;
        const struct lathe *lathe;
        const struct prism *prism;
        const struct bevelled *bevelled;
        const struct sweep_path *sweep;
        const struct height_field *height_field;
        const struct blob *blob;
        const struct curve *curve;
        const struct implicit *implicit;
        const struct mesh *mesh;
    };
};

const char *shape_kind_name(enum shape_kind kind);
/* Sides without an end are infinite. */
struct box shape_bounds(const struct shape *shape);
/* The box of the shape as `map` places it: the tightest one for analytic shapes whose reach has a closed form, else the
 * box of the mapped bounds. */
struct box shape_bounds_under(const struct shape *shape, const struct affine *map);
/* A box that is completely inside the shape under `map`, for solids that are boxes there, too: an axis-aligned box, an
 * axis-aligned half-space. */
bool shape_inner_box(const struct shape *shape, const struct affine *map, struct box *out);
/* Whether it may have many crossings, so that a query costs more than a formula. */
bool shape_is_listed(const struct shape *shape);
/* The image coordinates that a shape supplies: u and v with v from below (or nothing, has_uv); u and v on one of
 * several upright faces, each an image of its own with v from above; a pattern_normal that points from the centre of a
 * ball (shape_native_uv works out its u and v). */
enum surface_layout { LAYOUT_UV, LAYOUT_FACES, LAYOUT_SPHERE };
enum { SURFACE_LAYOUTS = LAYOUT_SPHERE + 1 };
enum surface_layout shape_layout(const struct shape *shape);
/* The u and v of a hit on it, v from below on LAYOUT_UV and LAYOUT_SPHERE; those of spheres are computed here, because
 * they are rarely needed. False: it has none. */
bool shape_native_uv(const struct shape *shape, const struct hit *hit, double *u, double *v);
/* How places on it are drawn evenly, where that has a closed form. */
enum shape_area { SHAPE_AREA_SPHERE, SHAPE_AREA_PLANAR, SHAPE_AREA_TRIANGLES, SHAPE_AREA_UNKNOWN };
enum shape_area shape_area(const struct shape *shape);
/* Closed: every line crosses it an even number of times, so it has an inside (CSG operand, media). A solid without end
 * (a half-space) is closed too: a line that begins or ends inside crosses it at t = -INFINITY or INFINITY. */
bool shape_is_closed(const struct shape *shape);
/* The position of the whole shape relative to the outside at any of its points: CONVEXITY_BEHIND for convex ones. */
enum hit_convexity shape_convexity(const struct shape *shape);
/* Why it is not closed, as the end of a sentence; NULL if it is closed. Of a mesh, mesh_describe_open_edges says more.
 */
const char *shape_why_open(const struct shape *shape);
/* Whether the nearest crossings of rays are found faster together: only within the tolerance of a preview. */
bool shape_takes_packets(const struct shape *shape, const struct geom_scratch *scratch);
/* The nearest crossings of the rays of which `active` has the bits; returns those that have one. Only of a shape that
 * takes packets. */
uint64_t shape_nearest_packet(const struct shape *shape, const struct ray *rays, uint64_t active,
                              struct geom_scratch *scratch, struct crossing *out);
/* The crossing with the smallest t in the open interval (ray->t_min, ray->t_max). On equal t the one that comes first
 * in the shape's own order. False also when scratch overflowed (then scratch->overflow is set). */
bool shape_nearest(const struct shape *shape, const struct ray *ray, struct geom_scratch *scratch,
                   struct crossing *out);
bool shape_any(const struct shape *shape, const struct ray *ray, struct geom_scratch *scratch);
/* All crossings of the whole line (the ray's interval is ignored), by ascending t, pushed on the scratch. The caller
 * pops by setting scratch->used = list.first. Tangential touches appear twice (enter, leave) or not at all. */
bool shape_crossings(const struct shape *shape, const struct ray *ray, struct geom_scratch *scratch,
                     struct crossing_list *out);
/* Whether a point of object space is inside a closed shape, decided pointwise. Used by tests and for the camera's first
 * media stack. Meshes: parity of crossings along a fixed ray. */
bool shape_contains(const struct shape *shape, struct vec3 point, struct geom_scratch *scratch);
void shape_describe(const struct shape *shape, const struct ray *ray, const struct crossing *crossing,
                    struct surface *out);
/* Upper bound of the scratch items one ray can need when it is known (analytic shapes), else a guess. */
uint32_t shape_scratch_need(const struct shape *shape);

struct shape_part; /* shape_part.h */
/* Part `number` of a shape, counted from 0, in its object space; together the parts contain the shape. False: it has no
 * such part, or it is infinite. */
bool shape_part(const struct shape *shape, uint32_t number, struct shape_part *out);
/* What it points to (base/bundle.h). */
bundle_fields shape_bundle;

#endif
