/* Materials: a flat set of inputs, each a number or a texture, and flags. A material is a base or is derived from
 * another one: a derived material reads the numbers of the base at the end of that chain and has the same textures
 * except for the input that was replaced or mixed (material_inputs.h). A world has flat copies (surface_material.h).
 * Immutable, in the arena of the script; images are shared assets. A chain is at most MATERIAL_DEPTH
 * long. */
#ifndef GRAY_MATERIAL_MATERIAL_H
#define GRAY_MATERIAL_MATERIAL_H

#include "base/list.h"
#include "material/texture.h"

#include <stdbool.h>
#include <stdint.h>

struct medium;

enum { MATERIAL_DEPTH = 1000 };

/* What a material was made of its base by, with its name in descriptions of the chain. PHONG, OPENPBR: by nothing, it
 * is a base. IMAGE: over `changed`. BUMP: turns the normal as if the texture's heights stood on the surface. NORMAL:
 * turns the normal to where the image's colours point. METAL (glTF): splits the colour below by metalness and
 * roughness. */
#define MATERIAL_KINDS(X)                                                                                              \
    X(MATERIAL_PHONG, "phong")                                                                                         \
    X(MATERIAL_MARBLE, "marble")                                                                                       \
    X(MATERIAL_WOOD, "wood")                                                                                           \
    X(MATERIAL_IMAGE, "image")                                                                                         \
    X(MATERIAL_BUMP, "bump")                                                                                           \
    X(MATERIAL_NORMAL, "normal map")                                                                                   \
    X(MATERIAL_FRESNEL, "fresnel")                                                                                     \
    X(MATERIAL_OPENPBR, "openpbr")
enum material_kind { MATERIAL_KINDS(LIST_MEMBER) };
enum { MATERIAL_KIND_COUNT = LIST_COUNT(MATERIAL_KINDS) };

/* The default height: white is this fraction of the size of the image on the surface above black. */
#define BUMP_HEIGHT 0.02

/* A texture that turns the normal, over those below it. */
struct bump {
    enum material_kind kind; /* MATERIAL_BUMP or MATERIAL_NORMAL */
    /* Of a bump: white over black, in units of the object; `relative`, of one image alone: of its size on the surface.
     * Of a normal map: factor of the slopes. */
    double height;
    bool relative;
    /* Its number is the height, or its colour the normal along the coordinates that the shape supplies; of one image
     * alone, along those of the image. */
    const struct texture *texture;
    bool of_coat;             /* turns the normal of the clear coat alone */
    bool from_above;          /* the shape's v counts from the top (material_mapping.h) */
    const struct bump *below; /* or NULL */
};

struct material {
    enum material_kind kind;
    const struct material *base;               /* what it was derived from; NULL for a base */
    const struct material *origin;             /* the base at the end of that chain; NULL for itself */
    int depth;                                 /* 1 for a base */
    uint32_t serial;                           /* order of creation in a scene, from 1; 0: not in a scene */
    struct material *older;                    /* the one created before it, or NULL */
    const char *name;                          /* for messages; may be NULL */
    const struct texture *inputs[INPUT_COUNT]; /* NULL: the number of the origin */
    const struct bump *bump;                   /* or NULL */
    enum material_input changed;               /* of MATERIAL_IMAGE */
    bool fresnel;
    struct phong phong; /* of a base */
    /* The layers of OpenPBR Surface, which take the place of the classic lobes; NULL: none (openpbr.h). */
    const struct openpbr *openpbr;
    const struct medium *medium; /* fills solids of it; or NULL */
};

/* The original base at the end of its chain: the world's copies (material_mapping.h) have the numbers of that. */
const struct material *material_origin(const struct material *material);
/* What a material of a chain does, in a word for descriptions: "wood", "image on ks". */
const char *material_step_name(const struct material *link);
/* Whether images, or bumps, are in it, which depend on the layout of shapes (material_mapping.h). */
bool material_has_image(const struct material *material);
/* Its average emission, and a bound (texture_estimate). */
struct colour material_emission(const struct material *material);
struct colour material_emission_bound(const struct material *material);
bool material_has_ior(const struct material *material);

#endif
