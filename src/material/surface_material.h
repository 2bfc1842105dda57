/* Materials of a world, at the surfaces of its primitives: flat copies of authored ones (material.h), whose inputs are
 * numbers or programs of the world's textures. They refer to nothing outside of their tables, so what shades a hit
 * reads no authored object. */
#ifndef GRAY_MATERIAL_SURFACE_MATERIAL_H
#define GRAY_MATERIAL_SURFACE_MATERIAL_H

#include "base/bundle.h"
#include "material/material.h"
#include "material/openpbr.h"
#include "material/texture_tables.h"

/* See struct bump. */
struct surface_bump {
    enum material_kind kind;
    double height;
    bool relative, from_above, of_coat;
    uint32_t program; /* a number, or a colour of MATERIAL_NORMAL */
    uint32_t texture; /* of one image alone, or one recorded function: its index; else TEXTURE_NONE */
};

struct surface_material {
    uint32_t inputs[INPUT_COUNT];    /* programs, or TEXTURE_NONE: the number */
    uint32_t first_bump, bump_count; /* from the lowest to the highest */
    bool plain;                      /* every input is a number, and nothing turns the normal */
    bool fresnel;
    bool filled;       /* solids have a medium inside, behind an invisible surface */
    bool holds_medium; /* one of its own, beside or instead of its surface */
    bool has_layers;   /* those of `openpbr` take the place of the classic lobes */
    /* Data that hits must compute for it: the footprint in pattern space; the direction of bumps and the tangents of
     * the pattern (hit->raise, along_a). */
    bool needs_footprint, needs_tangents;
    struct phong phong;
    struct openpbr openpbr;
};

struct surface_tables {
    struct surface_material *materials;
    const struct surface_bump *bumps;
    uint32_t bump_count;
    struct texture_tables textures;
};

/* The numbers of a material; with `classic`, those of openpbr_classic if the material wants them. Its textures are in
 * no table yet: inputs that have one are 0. textures (or NULL): these textures, NULL for numbers. */
struct surface_material surface_material_make(const struct material *material, bool classic,
                                              const struct texture *textures[INPUT_COUNT]);
/* Copies the numbers again, after changes of nothing else. */
void surface_material_update(struct surface_material *surface, const struct material *material, bool classic);
/* Tables of `count` materials, in the arena. authored (or NULL): the textures by index. False: no memory. */
bool surface_tables_build(struct surface_tables *out, const struct material *const *materials, uint32_t count,
                          bool classic, struct arena *arena, const struct texture *const **authored);

static inline bool surface_has_texture(const struct surface_material *surface, enum material_input input) {
    return surface->inputs[input] != TEXTURE_NONE;
}
/* Its opacity may be below 1. */
static inline bool surface_has_holes(const struct surface_material *surface) {
    return surface_has_texture(surface, INPUT_OPACITY);
}
/* Whether light passes into a solid of it, everywhere, so that a camera inside is in its medium. */
bool surface_is_transparent(const struct surface_material *surface);
/* Whether light may pass the surface of the solid at some points. */
bool surface_passes(const struct surface_material *surface);
/* Whether some light is scattered under it (LOBE_SUBSURFACE) where the caller follows that. */
bool surface_walks(const struct surface_material *surface);
/* Whether it refracts wavelengths by different indices. */
bool surface_disperses(const struct surface_material *surface);
/* The inside of a solid, by the numbers. */
struct medium surface_medium(const struct surface_material *surface);
/* Whether light may pass through the surface into another medium; thin walls have the same one on both sides. */
bool surface_divides_media(const struct surface_material *surface);
/* The average colour of what is reflected in all directions. */
struct colour surface_diffuse(const struct surface_tables *tables, const struct surface_material *surface);
/* The average emission, and a bound (texture_estimate). */
struct colour surface_emission(const struct surface_tables *tables, const struct surface_material *surface);
struct colour surface_emission_bound(const struct surface_tables *tables, const struct surface_material *surface);
/* Whether it may differ between hits. */
bool surface_emission_varies(const struct surface_material *surface);
/* The largest share of light that it mirrors and refracts together; 0: neither. */
double surface_specular(const struct surface_material *surface);
/* Approximately the largest share of light that it reflects. */
double surface_albedo_bound(const struct surface_tables *tables, const struct surface_material *surface);
/* What the tables of so many materials point to (base/bundle.h). */
void surface_tables_bundle(struct bundle *bundle, struct surface_tables *tables, uint32_t material_count);

#endif
