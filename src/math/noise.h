/* Perlin's improved noise of 2002 and the patterns made of it. Every coordinate is allowed: if one of the (scaled)
 * coordinates is not finite, the noise is 0, its value at every lattice point. The same bits on every machine. */
#ifndef GRAY_MATH_NOISE_H
#define GRAY_MATH_NOISE_H

#include "math/vec3.h"

/* a + (b - a) (1 - cos(pi t)) / 2 */
double noise_cosine_mix(double t, double a, double b);

/* In about [-1, 1], zero at lattice points, period 256 in each coordinate. interpolation 0: the reference, quintic fade
 * then linear; anything else: noise_cosine_mix on the faded parameter. */
double noise_perlin(double x, double y, double z, int interpolation);

/* Of interpolation 0: the gradient, 0 where a coordinate is not finite; and bounds of the absolute values of the noise
 * and of its derivatives, the second ones in one coordinate and in two (test_expr_bounds.c finds them). */
void noise_perlin_gradient(double x, double y, double z, double gradient[3]);
/* The same gradient up to rounding, faster; returns the bits of noise_perlin(x, y, z, 0). */
double noise_perlin_with_gradient(double x, double y, double z, double gradient[3]);
#define NOISE_MAX 1.0365
#define NOISE_FIRST_MAX 3.85
#define NOISE_SECOND_MAX 13.0
#define NOISE_MIXED_MAX 12.0

/* The weight in [0, 1] of a pattern's first colour at the point (x, y, z) or p; the rest is the weight of the mix
 * colour. factor multiplies the coordinates before the noise is taken. A NaN parameter gives share 1. */
double noise_wood(double x, double y, double z, double factor, double density, int interpolation);
double noise_marble(struct vec3 p, double factor, double multiplier, double vein_frequency, int interpolation);

/* A number in [0, 1), another one for each point; equal points (-0 is 0) have equal numbers. */
double noise_hash(double x, double y, double z);

/* Distances from the nearest and the second nearest of points that are spread at random, one in each cell of the
 * lattice of integers, and the nearest one's number in [0, 1). S. Worley, "A Cellular Texture Basis Function", SIGGRAPH
 * 1996. The search is exact, so nothing jumps at the borders of cells. All 0 where a coordinate is not finite. */
struct noise_cells {
    double nearest, second, id;
};
struct noise_cells noise_cells(double x, double y, double z);
/* The gradients of both distances: unit vectors from the points, 0 where a distance or a coordinate gives none. */
void noise_cells_gradients(double x, double y, double z, double nearest[3], double second[3]);

#endif
