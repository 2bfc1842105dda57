/* Fog in a box whose density, and optionally colour, is a recorded function of the point. The light along a ray is an
 * integral, computed by Gauss quadrature at points that depend only on the ray, so there is no noise. Bounds of the
 * density over cells of the box (interval arithmetic) determine which cells are empty, and how many points the others
 * need. */
#ifndef GRAY_MATERIAL_FOG_FIELD_H
#define GRAY_MATERIAL_FOG_FIELD_H

#include "base/arena.h"
#include "base/bundle.h"
#include "base/error.h"
#include "expr/expr_program.h"
#include "math/vec3.h"

struct fog_field;

struct fog_field_input {
    const struct expr_program *density; /* of p, s.world and s.time, with one output >= 0; optical depth per unit */
    const char *source;                 /* of the density, for messages: "scene.lua:12" */
    const char *name;                   /* that it has there; NULL: "density" */
    const struct expr_program *colour;  /* of these and s.view, with one output or three; NULL: one colour */
    struct vec3 corner, size;           /* of the box, in world space; size > 0 */
};

/* The programs must outlive it. Errors: no memory; a program reads an input that a fog does not have, or is too large;
 * the density is negative or not a number at one of 1,000 points of the box. */
const struct fog_field *fog_field_build(struct arena *arena, const struct fog_field_input *in, struct error *error);
/* A bound of the components of the colour, or an estimate from 1,000 points if the interval bounds are infinite. Only
 * with a colour. */
double fog_field_brightest(const struct fog_field *field);

/* Of the density, and of the colour, which may be NULL. */
const struct expr_program *fog_field_density(const struct fog_field *field);
const struct expr_program *fog_field_colour(const struct fog_field *field);

/* Its cells, and for each the minimum and the maximum of the density. */
struct fog_cells;
const float (*fog_field_cells(const struct fog_field *field, struct fog_cells *cells))[2];
/* The density at a point; it may be negative or NaN. */
double fog_field_at(const struct fog_field *field, struct vec3 p, double time);

/* A line through media. */
struct medium_line {
    struct vec3 origin, direction; /* unit */
    double distance, time;         /* the distance may be infinite */
};
/* The transmittance along the line, 0 to 1. source: the light that the fog adds is source * (1 - transmittance); set
 * only with a colour. */
double fog_field_transmittance(const struct fog_field *field, const struct medium_line *line, struct colour *source);
/* Copies what *field points to (base/bundle.h). */
void fog_field_bundle(struct bundle *bundle, const struct fog_field **field);

#endif
