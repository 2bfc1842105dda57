/* What a side of a vertex receives: direct light, and what its rays meet. Positions are drawn with the density of the
 * hat function of the vertex over its patches. So the sum over all vertices by their areas is the mean over the surface
 * without bias, and no ray starts in a corner. */
#ifndef GRAY_RADIOSITY_RECEIVE_INTERNAL_H
#define GRAY_RADIOSITY_RECEIVE_INTERNAL_H

#include "radiosity/radiosity.h"
#include "world/world_lights.h"

enum { RECEIVE_POSITIONS = 64 }; /* of a side of a vertex, each with one sample of a light */

struct receiver_input {
    const struct radiosity *radiosity;
    const struct world_lights *lights;
    uint8_t *buries;   /* by primitive: an opaque solid inside of which no light is seen */
    uint8_t *emissive; /* by material: receive_is_emissive */
    struct box bounds; /* of all that rays can meet */
    uint64_t seed;
    uint32_t rays; /* a square, and a multiple of RECEIVE_POSITIONS */
    /* For receive_rays: the light of samples of lights that patches reflect, by area, and the rising shares of the
     * fronts and backs of patches in it. In `unshot` of each side is that light. */
    double power;
    const double *until;
};

/* Sets reflectance, area and weight, and as light that of samples of lights. */
void receive_direct(const struct receiver_input *input, uint32_t side, struct world_scratch *scratch,
                    struct side_light *out);
/* How bright a side of a patch is by its three vertices. */
double receive_brightness(const struct radiosity *radiosity, uint32_t patch, bool back);
/* Adds the direct light that rays meet, and the light of samples of lights that comes by one reflection: by rays and by
 * positions on bright patches. targets: of each ray the side of a vertex that it meets, or SIDE_NONE. */
void receive_rays(const struct receiver_input *input, uint32_t side, struct world_scratch *scratch,
                  struct side_light *out, uint32_t *targets);

/* Adds to a digest what a random ray through a point of the box sees of a primitive. */
struct digest receive_probe(const struct receiver_input *input, uint32_t primitive, const struct box *box, uint64_t key,
                            struct world_scratch *scratch, struct digest digest);

/* Fills these flags. */
void receive_find_buries(const struct world *world, uint8_t *buries);
bool receive_is_emissive(const struct world *world, uint32_t material);

#endif
