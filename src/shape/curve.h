/* The curve with thickness, for hair, fur and grass: a ribbon of given width along a spline that always faces the ray.
 * It is as wide as the curve's width across the ray and has no thickness along it; open. Owner: the arena it was built
 * in. */
#ifndef GRAY_SHAPE_CURVE_H
#define GRAY_SHAPE_CURVE_H

#include "base/arena.h"
#include "base/bundle.h"
#include "base/error.h"
#include "geometry/crossing.h"
#include "geometry/hit.h"
#include "geometry/spline.h"
#include "math/box.h"
#include "math/ray.h"

struct curve;

struct curve_input {
    enum spline_kind kind;
    const double (*points)[3];
    const double *widths; /* whole widths, >= 0, interpolated by the same spline */
    uint32_t count;
    bool flat; /* shaded as a ribbon, not as a round hair */
};

const struct curve *curve_build(struct arena *arena, const struct curve_input *input, struct error *error);
struct box curve_bounds(const struct curve *curve);
/* The least and the greatest dot(g, p) over the shape. */
void curve_extent(const struct curve *curve, struct vec3 g, double *lo, double *hi);
/* Piece `number` as Bezier points of x, y, z and of half the width; the direction changes little within a piece. False:
 * there are fewer pieces. */
bool curve_piece_tube(const struct curve *curve, uint32_t number, double tube[4][4]);
/* The part is a piece of the spline, u the place on it. Every crossing enters: the ribbon faces the ray. */
bool curve_crossings(const struct curve *curve, const struct ray *ray, struct geom_scratch *scratch,
                     struct crossing_list *out);
/* u runs along the curve from 0 to 1, v across from 0 to 1. The normal, also the geometric one, and the point are those
 * of the surface of a round hair. A flat one has the normal of the ribbon, and the point half a width above it. */
void curve_describe(const struct curve *curve, const struct ray *ray, const struct crossing *crossing,
                    struct surface *out);
uint32_t curve_scratch_need(const struct curve *curve);
/* Copies what *curve points to (base/bundle.h). */
void curve_bundle(struct bundle *bundle, const struct curve **curve);

#endif
