/* Directional albedos: the share of light from one direction that a surface reflects or transmits, looked up in tables.
 * Cosines are to the normal, in (0, 1]; roughness is the square root of the width of the slopes
 * (microfacet_internal.h), in [0, 1].
 *
 * The tables are made by tools/albedo_tables.c and read by cubics. Means over directions have errors of about 3e-5 from
 * outside and 5e-4 from inside; single values beside the angle of total reflection, of a few percent. Indices of
 * refraction above 3 count as 3 in the tables. */
#ifndef GRAY_MATERIAL_ALBEDO_INTERNAL_H
#define GRAY_MATERIAL_ALBEDO_INTERNAL_H

/* Of rough surfaces whose facets reflect all light: the share that leaves after one facet, and the mean of that over
 * directions with the cosine. */
double albedo_mirror(double cosine, double roughness);
double albedo_mirror_average(double roughness);

/* Facets whose slopes are wider along one tangent (Heitz 2014): the share that does not leave after one facet, over
 * that of facets of one width with the same mean square. cos_double: the cosine of twice the azimuth to the wide
 * direction. Errors of the share for facets that reflect all: .001 in the mean, .01 at most. */
double albedo_stretch(double cosine, double cos_double, double alpha_along, double alpha_across);
double albedo_stretch_average(double alpha_along, double alpha_across);

/* Of rough boundaries between dielectrics; eta = index on the side of the direction / index behind. The share reflected
 * by one facet; the share reflected or transmitted by one facet; and the mean of the latter. */
double albedo_reflection(double cosine, double roughness, double eta);
double albedo_boundary(double cosine, double roughness, double eta);
double albedo_boundary_average(double roughness, double eta);

/* Of fuzz (bsdf.h). */
double albedo_fuzz(double cosine, double roughness);

#endif
