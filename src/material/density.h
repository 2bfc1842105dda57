/* The density of a medium: 1 in a box, which may be infinite; a recorded function of the point in a box; or a
 * grid over a box, trilinear between the centres of its voxels. Cells of the box have bounds of the density, which say
 * how long steps along a line may be (medium_mix.h). A density above the bound of its cell counts as the bound; the
 * first such cell is noted. */
#ifndef GRAY_MATERIAL_DENSITY_H
#define GRAY_MATERIAL_DENSITY_H

#include "base/arena.h"
#include "base/bundle.h"
#include "base/error.h"
#include "material/fog_field.h"
#include "math/box.h"

struct density;

/* Errors: no memory. */
const struct density *density_of_box(struct arena *arena, const struct box *box, struct error *error);

/* field: a fog_field without colour. bound: of the density, for functions whose intervals have none; INFINITY: not
 * given. looseness: the factor of the bounds, 1; for tests. Errors: no memory, a cell without a bound. */
struct density_function {
    const struct fog_field_input *field;
    double bound, looseness;
};
const struct density *density_of_function(struct arena *arena, const struct density_function *in, struct error *error);

/* Values of at least 0, x fastest, which must outlive the density. Errors: no memory. */
struct density_grid {
    struct box box;
    uint32_t count[3];
    const float *values;
    double looseness;
    bool fits; /* the unit box stands for that of the solid */
};
const struct density *density_of_grid(struct arena *arena, const struct density_grid *in, struct error *error);

/* The box outside of which the density is 0. */
struct box density_box(const struct density *density);
/* Whether it is to fill the box of its solid. */
bool density_fits(const struct density *density);
/* The first cell in which the density was above its bound. False: none. */
bool density_excess(const struct density *density, struct box *cell, double *bound);

/* The integral of the density along the line, by quadrature. */
double density_depth(const struct density *density, const struct medium_line *line);
/* Copies what *density points to (base/bundle.h). */
void density_bundle(struct bundle *bundle, const struct density **density);

#endif
