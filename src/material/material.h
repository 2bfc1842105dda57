/* Materials: a base (Phong) plus decorators that hold the material below them as `base`. Evaluated once per hit into a
 * struct shading. Immutable, in the arena of the script; images are shared assets. A chain is at most MATERIAL_DEPTH
 * long. */
#ifndef GRAY_MATERIAL_MATERIAL_H
#define GRAY_MATERIAL_MATERIAL_H

#include "geom/hit.h"
#include "image/image.h"
#include "material/shading.h"

#include <stdbool.h>
#include <stdint.h>

enum { MATERIAL_DEPTH = 1000 };

enum material_kind {
    MATERIAL_PHONG,
    MATERIAL_MARBLE,
    MATERIAL_WOOD,
    MATERIAL_IMAGE,
    MATERIAL_BUMP,   /* turns the normal as if the picture's heights stood on the surface */
    MATERIAL_NORMAL, /* turns the normal to where the picture's colours point */
    MATERIAL_METAL,  /* glTF: splits the colour below by a picture of metalness and roughness */
    MATERIAL_FRESNEL
};

/* AS_SET: what the settings of the picture say. */
enum material_highlight { HIGHLIGHT_AS_SET, HIGHLIGHT_PHONG, HIGHLIGHT_BLINN };

/* How a hit becomes a place on an image. SPHERE, CUBE: the decorators td_sphere_material and td_cube_material;
 * SPHERE_CLASSIC: set_texture on a sphere (the formulas stand in image_place.c); UV: the shape's own parameters;
 * BY_SHAPE: SPHERE on spheres, CUBE on boxes, else UV. */
enum image_mapping { MAPPING_SPHERE, MAPPING_CUBE, MAPPING_SPHERE_CLASSIC, MAPPING_UV, MAPPING_BY_SHAPE };

/* What a picture is the picture of. OPACITY: how much of the surface is there; the rest is a hole. */
enum image_target { IMAGE_TO_KD, IMAGE_TO_KS, IMAGE_TO_EMISSION, IMAGE_TO_OPACITY };

/* A height that is not told: white stands this much of the picture's own size on the surface above black. */
#define RELIEF_HEIGHT 0.02

struct material {
    enum material_kind kind;
    const struct material *base; /* NULL for MATERIAL_PHONG */
    int depth;                   /* 1 for a base */
    uint32_t serial;             /* order of creation in a scene, from 1; 0: of no scene */
    struct material *older;      /* the one created before it, or NULL */
    const char *name;            /* for messages; may be NULL */
    union {
        struct {
            struct vec3 kd, ks;
            double shininess, reflect, refract, ior;
            bool has_ior, two_sided, unlit;
            enum material_highlight highlight;
            struct vec3 emission, absorption;
            double roughness;
            int glossy_samples;
            bool by_vertex; /* kd is multiplied by the colours of a mesh's vertices */
        } phong;
        struct {
            double f, multiplier, vein_frequency;
            int interpolation;
            struct vec3 mix;
        } marble;
        struct {
            double f, density;
            int interpolation;
            struct vec3 mix;
        } wood;
        struct {
            struct image *image;
            enum image_mapping mapping;
            enum image_filter filter;
            enum image_wrap wrap;   /* of MAPPING_UV */
            enum image_wrap wrap_v; /* where `apart` says so, else wrap is for both */
            bool flip_u;
            /* The place is scale * uv + offset (v from below), the colour is multiplied by tint. */
            bool apart;
            double scale[2], offset[2];
            struct vec3 tint;
            enum image_target target;
            bool without_alpha; /* the picture covers everything, whatever its alpha says */
            bool by_alpha;      /* OPACITY: alpha says it, not the colour */
            double cutoff;      /* OPACITY: > 0: all or nothing, from here on */
            /* BUMP: white over black, in units of the object; `relative`: of the picture's size on the surface.
             * NORMAL: factor of the slopes. */
            double height;
            bool relative;
            /* METAL: factors of blue and green; the reflectance of what is no metal. */
            double metallic, roughness, f0;
        } image; /* of BUMP, NORMAL and METAL as well */
    };
};

/* What decorators change; turned into lobes at the end. */
struct surface_look {
    struct vec3 kd, ks;
    double shininess, reflect, refract, ior;
    bool has_ior, two_sided;
    bool unlit;         /* kd is shown as it is, whatever light there is */
    struct vec3 normal; /* unit, world, on the outward side: the hit's, or as relief has turned it */
    double opacity;     /* of a surface with holes; what lies behind shows by 1 - opacity */
    enum material_highlight highlight;
    struct vec3 emission;   /* added to what is reflected */
    struct vec3 absorption; /* inside: the logarithm of light falls by this per unit */
    double roughness;       /* of reflection and refraction; 0: a mirror */
    int glossy_samples;     /* N x N rays where it is rough; 0: the default */
    bool fresnel;           /* the integrator, which knows the media, replaces reflect and refract by F and 1 - F */
};

void material_look(const struct material *material, const struct hit *hit, struct surface_look *out);
/* The same; `told` (or NULL) hears of every link, from the base on, when `look` is what it made of it. */
typedef void material_told(void *context, const struct material *link, const struct surface_look *look);
void material_look_told(const struct material *material, const struct hit *hit, struct surface_look *out,
                        material_told *told, void *context);
/* What hits must know for it: the footprint in pattern space; where bumps rise (hit->raise). */
bool material_has_image(const struct material *material);
bool material_has_relief(const struct material *material);
bool material_has_holes(const struct material *material); /* its opacity may be below 1 */
/* The lobes of a look whose reflect and refract are final. ambient_plain: the ambient colour is not multiplied by kd.
 */
void material_shading(const struct surface_look *look, enum specular_kind specular, bool ambient_plain,
                      struct shading *out);
/* Of the base below all decorators: whether light passes into the solid (refract > 0 or Fresnel), and its index. */
bool material_is_transparent(const struct material *material, double *ior);
/* Of the base: how the inside absorbs light, per unit of length. */
struct vec3 material_absorption(const struct material *material);
/* Of the base: its own light. */
struct vec3 material_emission(const struct material *material);
/* The share of light that its mirror and its refraction give back together, at most; 0: neither. */
double material_specular(const struct material *material);
bool material_has_ior(const struct material *material);

#endif
