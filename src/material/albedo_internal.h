/* Directional albedos: the share of light from one direction that a surface sends on, looked up in tables. Cosines are
 * to the normal, in (0, 1]; roughness is the square root of the width of the slopes (microfacet_internal.h), in [0, 1].
 *
 * The tables are made by tools/albedo_tables.c and read by cubics, so that a value is off by some 2e-4. Indices of
 * refraction above 3 count as 3. */
#ifndef GRAY_MATERIAL_ALBEDO_INTERNAL_H
#define GRAY_MATERIAL_ALBEDO_INTERNAL_H

/* Of rough surfaces whose facets reflect all: what leaves after one facet, and the mean of that over directions with
 * the cosine. */
double albedo_mirror(double cosine, double roughness);
double albedo_mirror_average(double roughness);

/* Of rough boundaries between dielectrics; eta = index on the side of the direction / index behind. What is reflected
 * by one facet; what is reflected or transmitted by one facet; and the mean of the latter. */
double albedo_reflection(double cosine, double roughness, double eta);
double albedo_boundary(double cosine, double roughness, double eta);
double albedo_boundary_average(double roughness, double eta);

/* Of fuzz (bsdf.h). */
double albedo_fuzz(double cosine, double roughness);

#endif
