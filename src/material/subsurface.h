/* Light under a surface (OpenPBR Surface 1.1, "Subsurface"). It goes in and comes out as Lambert's lobe would scatter
 * it, which the specification allows, and is scattered in between by a medium that is the same everywhere. In uniform
 * light a plane shows the colour for every view: a table has the albedo of single scattering that this takes
 * (tools/subsurface_table.c). As the radius becomes small the surface becomes Lambert's. */
#ifndef GRAY_MATERIAL_SUBSURFACE_H
#define GRAY_MATERIAL_SUBSURFACE_H

#include "math/colour.h"

struct subsurface {
    struct colour colour; /* 0..1 */
    struct colour radius; /* the mean free path in world units; one component is above 0 */
    double g;             /* of Henyey and Greenstein's function, in (-1, 1) */
};

/* The share of scattering in the extinction for a colour in [0, 1] of light from all sides; beyond |g| .95 by
 * similarity. */
double subsurface_albedo(double colour, double g);

#endif
