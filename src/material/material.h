/* Materials: a flat set of inputs, each a number or a texture, and flags. A material is a base or is derived from
 * another one: a derived material reads the numbers of the base at the end of that chain and has the same textures
 * except for the input that was replaced or mixed (material_inputs.h). Evaluated once per hit into a struct
 * surface_inputs. Immutable, in the arena of the script; images are shared assets. A chain is at most MATERIAL_DEPTH
 * long. */
#ifndef GRAY_MATERIAL_MATERIAL_H
#define GRAY_MATERIAL_MATERIAL_H

#include "base/list.h"
#include "geometry/hit.h"
#include "material/medium.h"
#include "material/texture.h"
#include "settings/settings.h"

#include <stdbool.h>
#include <stdint.h>

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

/* A bump or NULL; in a table, its index or BUMP_NONE. */
union bump_ref {
    const struct bump *authored;
    uint32_t index;
};
#define BUMP_NONE UINT32_MAX

/* A texture that turns the normal, over those below it. */
struct bump {
    enum material_kind kind; /* MATERIAL_BUMP or MATERIAL_NORMAL */
    /* Of a bump: white over black, in units of the object; `relative`, of one image alone: of its size on the surface.
     * Of a normal map: factor of the slopes. */
    double height;
    bool relative;
    /* Its number is the height, or its colour the normal along the coordinates that the shape supplies; of one image
     * alone, along those of the image. */
    union texture_ref texture;
    bool from_above; /* the shape's v counts from the top (material_mapping.h) */
    union bump_ref below;
};

/* The referenced bump, or NULL. bumps: the table that holds it; NULL: it is authored. */
static inline const struct bump *bump_at(const struct bump *bumps, union bump_ref ref) {
    if (!bumps)
        return ref.authored;
    return ref.index != BUMP_NONE ? &bumps[ref.index] : NULL;
}

struct material {
    enum material_kind kind;
    const struct material *base;           /* what it was derived from; NULL for a base */
    const struct material *origin;         /* the base at the end of that chain; NULL for itself */
    int depth;                             /* 1 for a base */
    uint32_t serial;                       /* order of creation in a scene, from 1; 0: not in a scene */
    struct material *older;                /* the one created before it, or NULL */
    const char *name;                      /* for messages; may be NULL */
    union texture_ref inputs[INPUT_COUNT]; /* none: the number of the origin */
    union bump_ref bump;                   /* or none */
    /* The tables that `inputs` and `bump` are indices of, those of a world; NULL: the material is authored. */
    const struct texture *textures;
    const struct bump *bumps;
    bool plain;                  /* in a world: every input is a number, and nothing turns the normal */
    enum material_input changed; /* of MATERIAL_IMAGE */
    bool fresnel;
    struct phong phong; /* of a base */
    /* The layers of OpenPBR Surface, which take the place of the classic lobes; NULL: none (openpbr.h). */
    const struct openpbr *openpbr;
};

/* The inputs at a hit; material_eval turns them into a BSDF. */
struct surface_inputs {
    struct vec3 kd, ks;
    double shininess, reflect, refract, ior;
    bool has_ior, two_sided;
    bool unlit;         /* kd is shown unchanged, without light */
    struct vec3 normal; /* unit, world, on the outward side: the hit's, or changed by bumps */
    double opacity;     /* of a surface with holes; objects behind it have the weight 1 - opacity */
    enum material_highlight highlight;
    struct vec3 emission;   /* added to reflected light */
    struct vec3 absorption; /* inside: the logarithm of light decreases by this per unit */
    double roughness;       /* of reflection and refraction; 0: a mirror */
    int glossy_samples;     /* N x N rays where it is rough; 0: the default */
    bool fresnel;           /* material_eval, which has the media, replaces reflect and refract by F and 1 - F */
};

/* A copy that refers to no other material: it has its own copy of the numbers of the base at the end of its chain, or
 * with `classic`, those of openpbr_classic if the material wants them.
 * Tables of worlds have such copies, with indices instead of pointers (flatten_textures). */
struct material material_flatten(const struct material *material, bool classic);
/* The texture of an input, NULL where it is a number. */
static inline const struct texture *material_texture(const struct material *material, enum material_input input) {
    return texture_at(material->textures, material->inputs[input]);
}
void material_inputs_at(const struct material *material, const struct hit *hit, struct surface_inputs *out);
/* Is called for every material of a chain, from the base on, with its inputs. */
typedef void material_observer(void *context, const struct material *link, const struct surface_inputs *inputs);
/* The original base at the end of its chain: the world's copies (material_mapping.h) have the numbers of that. */
const struct material *material_origin(const struct material *material);
/* What a material of a chain does, in a word for descriptions: "wood", "image on ks". */
const char *material_step_name(const struct material *link);
/* Data that hits must compute for it: the footprint in pattern space; the direction of bumps and the tangents of the
 * pattern (hit->raise, along_a); the tangents only. */
bool material_has_image(const struct material *material);
bool material_has_bump(const struct material *material);
bool material_has_function(const struct material *material);
bool material_has_holes(const struct material *material); /* its opacity may be below 1 */
/* Whether light passes into a solid of it, everywhere, so that a camera inside is in its medium. */
bool material_is_transparent(const struct material *material);
/* Whether light may pass the surface of the solid at some points. */
bool material_passes(const struct material *material);
/* The inside of a solid, by the numbers of the base. */
struct medium material_medium(const struct material *material);
/* Whether light may pass through the surface into another medium; thin walls have the same one on both sides. */
bool material_divides_media(const struct material *material);
/* Of the base: its average emission, and a bound (texture_estimate). */
struct vec3 material_emission(const struct material *material);
struct vec3 material_emission_bound(const struct material *material);
/* Whether it may differ between hits. */
bool material_emission_varies(const struct material *material);
/* The largest share of light that it mirrors and refracts together; 0: neither. */
double material_specular(const struct material *material);
/* Approximately the largest share of light that it reflects. */
double material_albedo_bound(const struct material *material);
bool material_has_ior(const struct material *material);

#endif
