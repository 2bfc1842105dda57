/* BSDF: the scattering of light by a surface at one hit, as a short list of lobes. material_eval fills it; integrators
 * read nothing else of a surface. Directions are unit vectors in world space that point away from the surface. wo is
 * the direction from which a path comes, on the side of `geometric_side`; wi is the direction in which it continues.
 *
 * There are two kinds of lobes. Classic lobes (docs/language.md 5.2) reflect the lights of the scene by a formula,
 * bsdf_classic; traced lobes show the hit of a ray in their direction and do not reflect lights. docs/design/light.md
 * defines f for both. */
#ifndef GRAY_MATERIAL_BSDF_H
#define GRAY_MATERIAL_BSDF_H

#include "base/list.h"
#include "material/medium.h"
#include "material/microfacet_internal.h"
#include "material/subsurface.h"
#include "material/thin_film.h"
#include "math/sampling.h"
#include "math/vec3.h"

#include <stdbool.h>
#include <stdint.h>

enum bsdf_flags {
    BSDF_CLASSIC = 1,
    BSDF_TRACED = 2,
    BSDF_REFLECTS = 4,
    BSDF_TRANSMITS = 8,
    BSDF_DELTA = 16,    /* one direction only: f and pdf are 0 everywhere else */
    BSDF_LAMBERT = 32,  /* f is the same for all directions */
    BSDF_EXPONENT = 64, /* it has one */
    BSDF_ROUGH = 128,   /* of layered materials, in rough_lobes.c */
    BSDF_TINTED = 256,  /* f has a colour beside the weight: Fresnel's shares of metals and thin films */
    BSDF_DIFFUSE = 512, /* render layers count it as diffuse */
    BSDF_BELOW = 1024,  /* light comes out elsewhere: f and pdf are 0 */
};

/* Kind, name in pixel traces, flags. f is weight times: */
#define SIMPLE_LOBES(X)                                                                                                \
    X(LOBE_DIFFUSE, "diffuse", BSDF_CLASSIC | BSDF_REFLECTS | BSDF_LAMBERT | BSDF_DIFFUSE) /* 1 / pi */                \
    X(LOBE_PHONG, "phong", BSDF_CLASSIC | BSDF_REFLECTS | BSDF_EXPONENT) /* max(0, r.v)^exponent / (pi n.l) */         \
    X(LOBE_BLINN, "blinn", BSDF_CLASSIC | BSDF_REFLECTS | BSDF_EXPONENT) /* max(0, n.h)^exponent / (pi n.l) */         \
    X(LOBE_MIRROR, "mirror", BSDF_TRACED | BSDF_REFLECTS | BSDF_DELTA)                                                 \
    X(LOBE_COAT, "coat", BSDF_TRACED | BSDF_REFLECTS | BSDF_DELTA) /* a mirror with the normal of its facets */        \
    X(LOBE_REFRACTION, "refract", BSDF_TRACED | BSDF_TRANSMITS | BSDF_DELTA)                                           \
    X(LOBE_GGX_REFLECTION, "mirror", BSDF_TRACED | BSDF_REFLECTS)                                                      \
    X(LOBE_GGX_TRANSMISSION, "refract", BSDF_TRACED | BSDF_TRANSMITS) /* facets with total reflection reflect it */    \
    /* Goes in as Lambert's lobe would come out. Its weight has the colour, which the walk divides by again. */        \
    X(LOBE_SUBSURFACE, "subsurface", BSDF_REFLECTS | BSDF_DELTA | BSDF_DIFFUSE | BSDF_BELOW)
/* Of layered materials; rough_lobes.c has the formulas. */
#define ROUGH_LOBES(X)                                                                                                 \
    X(LOBE_OREN_NAYAR, "rough diffuse", BSDF_ROUGH | BSDF_CLASSIC | BSDF_REFLECTS | BSDF_DIFFUSE)                      \
    X(LOBE_OREN_NAYAR_MULTIPLE, "rough diffuse, multiple", BSDF_ROUGH | BSDF_CLASSIC | BSDF_REFLECTS | BSDF_DIFFUSE)   \
    X(LOBE_DIFFUSE_THROUGH, "diffuse through", BSDF_ROUGH | BSDF_TRANSMITS) /* 1 / pi, behind a thin wall */           \
    X(LOBE_FUZZ, "fuzz", BSDF_ROUGH | BSDF_CLASSIC | BSDF_REFLECTS)                                                    \
    X(LOBE_GLOSS, "gloss", BSDF_ROUGH | BSDF_CLASSIC | BSDF_TRACED | BSDF_REFLECTS)                                    \
    X(LOBE_METAL, "metal", BSDF_ROUGH | BSDF_CLASSIC | BSDF_TRACED | BSDF_REFLECTS | BSDF_TINTED)                      \
    X(LOBE_GLASS, "glass", BSDF_ROUGH | BSDF_TRACED | BSDF_TRANSMITS)                                                  \
    X(LOBE_PANE, "pane", BSDF_ROUGH | BSDF_TRACED | BSDF_TRANSMITS)                                                    \
    X(LOBE_FILM, "film", BSDF_ROUGH | BSDF_CLASSIC | BSDF_TRACED | BSDF_REFLECTS | BSDF_TINTED)                        \
    X(LOBE_FILM_GLASS, "glass below a film", BSDF_ROUGH | BSDF_TRACED | BSDF_TRANSMITS | BSDF_TINTED)                  \
    X(LOBE_FILM_PANE, "pane below a film", BSDF_ROUGH | BSDF_TRACED | BSDF_TRANSMITS | BSDF_TINTED)                    \
    X(LOBE_FACETS_MULTIPLE, "facets, multiple", BSDF_ROUGH | BSDF_CLASSIC | BSDF_REFLECTS)                             \
    X(LOBE_FACETS_THROUGH, "facets through, multiple", BSDF_ROUGH | BSDF_TRANSMITS)
#define LOBES(X) SIMPLE_LOBES(X) ROUGH_LOBES(X)
enum lobe_kind { LOBES(LIST_MEMBER) };
enum { LOBE_KINDS = LIST_COUNT(LOBES) };

struct lobe {
    enum lobe_kind kind;
    int facets; /* of rough lobes of layered materials: index in the BSDF's facets */
    struct colour weight;
    double exponent; /* of OREN_NAYAR and FUZZ: the roughness, in [0, 1] */
    double share;    /* the approximate share of its weight that it contributes, for choosing it; 0: unknown */
};

/* The reflection and transmission by the facets of a rough surface. BOUNDARY: that between two dielectrics. METAL:
 * Fresnel's shares by F82 (N. Hoffman, "Fresnel Equations Considered Harmful", 2019; OpenPBR Surface 1.1): F0 + (1 -
 * F0) (1 - c)^5 - edge c (1 - c)^6. PANE: the two sides of a thin wall together, with all reflections between them. */
enum facet_kind { FACETS_BOUNDARY, FACETS_METAL, FACETS_PANE };

struct bsdf_facets {
    enum facet_kind kind;
    struct facet_distribution distribution;
    double eta; /* index on the ray's side over that behind; 1 for metals */
    struct colour f0, edge;
    double reflected; /* of a boundary: by one facet, of light from the view */
    /* Light that is scattered by more than one facet (rough_lobes_internal.h). */
    double roughness;         /* for an isotropic surface */
    double lack, lack_behind; /* 1 - mean albedo, on the ray's side and behind */
    double lack_seen;         /* 1 - albedo for the view */
    double through;           /* the share of that light that is transmitted */
};

enum { BSDF_LOBES = 14, BSDF_FACETS = 4, BSDF_ALL = (1 << BSDF_LOBES) - 1 };

struct bsdf {
    int count;
    struct lobe lobes[BSDF_LOBES];
    /* The shading frame, unit vectors. */
    struct vec3 normal;               /* on the outer side of the surface */
    struct vec3 lit;                  /* the same, turned to the viewer where the surface has two sides */
    struct vec3 side, geometric_side; /* on the ray's side; `side` has an angle below 90 degrees to the view */
    bool dark;                        /* seen from behind: classic lobes reflect no light */
    struct colour albedo;             /* kd, also without a diffuse lobe */
    struct colour ambient;            /* multiplied with the scene's ambient colour */
    struct colour emission;           /* added as it is */
    double opacity;                   /* the rest is a hole, through which the ray continues unchanged */
    /* Traced lobes. */
    double alpha;       /* width of the facets' slopes; 0: smooth */
    int glossy_samples; /* N x N rays where it is rough; 0: the default */
    double eta;         /* index on the ray's side / index behind; 1 where nothing is refracted */
    double fresnel;     /* the share that a smooth surface reflects, or negative */
    /* The GGX lobes have Fresnel's share of each facet beside their weights. */
    bool fresnel_of_facets;
    bool transmits;      /* the smooth surface transmits refracted light; `boundary` is set if any lobe refracts */
    struct vec3 through; /* if it transmits: the refracted direction for the view of the hit */
    bool turns_back;     /* at total reflection its share is reflected; else lost */
    struct medium_boundary boundary;
    const struct medium_stack *behind; /* if light passes other surfaces too: the media behind them all; else NULL */
    bool passes;                       /* some light enters the solid or passes the thin wall */
    double roughness;                  /* if it passes: that of the boundary, 2 where some light is diffuse */
    struct thin_film film;             /* over the facets of lobes with a film; else undefined */
    struct bsdf_facets facets[BSDF_FACETS]; /* those that lobes refer to */
    struct subsurface subsurface;           /* of LOBE_SUBSURFACE */
};

/* Other surfaces that coincide with this one, for light that passes them all. */
struct bsdf_joint {
    double eta;         /* index before all of them over the index behind */
    struct colour tint; /* the product of the tints of the other ones */
    const struct medium_stack *behind;
};

/* The stack behind the surface, and behind all that coincide with it. */
static inline void bsdf_cross(const struct bsdf *bsdf, struct medium_stack *stack) {
    if (bsdf->behind)
        medium_stack_copy(stack, bsdf->behind);
    else
        medium_stack_cross(stack, &bsdf->boundary);
}

/* The transported quantity of the sampled direction. RADIANCE: light comes from there, and refraction scales it by the
 * square of eta (Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, section 5.2). IMPORTANCE:
 * the power of a photon goes there; refraction does not change it, nor radiance divided by n^2, which Whitted's colours
 * are. */
enum bsdf_mode { BSDF_RADIANCE, BSDF_IMPORTANCE };

const char *lobe_name(enum lobe_kind kind);
static inline unsigned lobe_flags(enum lobe_kind kind) {
#define LOBE_FLAGS(kind, name, flags) [kind] = (flags),
    static const uint16_t flags_of[] = {LOBES(LOBE_FLAGS)};
#undef LOBE_FLAGS
    return flags_of[kind];
}

/* Sets of lobes: bit i is lobes[i]. This one has the lobes with one of the flags. */
uint32_t bsdf_lobes_with(const struct bsdf *bsdf, unsigned flags);

/* The sum of the classic lobes in `lobes` for unit light from wi towards wo, by docs/language.md 5.2: pi f |cos|. 0 for
 * light from the other side than `geometric_side`. */
struct colour bsdf_classic(const struct bsdf *bsdf, uint32_t lobes, struct vec3 wo, struct vec3 wi);

/* f |cos wi| of the lobes that are not delta. */
struct colour bsdf_eval(const struct bsdf *bsdf, uint32_t lobes, enum bsdf_mode mode, struct vec3 wo, struct vec3 wi);
/* The density of bsdf_sample's directions per solid angle, delta lobes aside. */
double bsdf_pdf(const struct bsdf *bsdf, uint32_t lobes, struct vec3 wo, struct vec3 wi);

struct bsdf_sample {
    struct vec3 direction;
    struct colour weight; /* f |cos| / pdf; of delta lobes the limit of that */
    double pdf;           /* with BSDF_DELTA: the probability of the lobe */
    unsigned flags;       /* BSDF_REFLECTS or BSDF_TRANSMITS, BSDF_DELTA; with that BSDF_BELOW: it goes in */
};
/* A direction for a point of the unit square, of one of the lobes, chosen approximately in proportion to their
 * contributions. False: no direction, which counts as black (a sample below the surface, a lobe without
 * contribution). */
bool bsdf_sample(const struct bsdf *bsdf, uint32_t lobes, enum bsdf_mode mode, struct vec3 wo, struct sample2 u,
                 struct bsdf_sample *out);

/* For integrators that follow traced lobes one by one. At total reflection a smooth refracting lobe joins the
 * mirror. */
struct bsdf_branch {
    struct colour weight; /* not black */
    double expected;      /* approximately the mean share of `weight` in samples, above 0: for the choice of a branch */
    int lobe;
    bool rough;
};
/* The number of branches. */
int bsdf_branches(const struct bsdf *bsdf, struct bsdf_branch out[BSDF_LOBES]);
/* Whether `expected` is the mean of a rough branch, from a table. */
bool bsdf_branch_is_known(const struct bsdf *bsdf, const struct bsdf_branch *branch);

struct bsdf_branch_direction {
    struct vec3 direction;
    struct colour weight; /* mode IMPORTANCE */
    bool transmits;
};
/* A point in the unit square for all rough branches of one ray, and the normal of the facet that is there. */
struct bsdf_draw {
    struct sample2 u;
    struct vec3 facet;
};
struct bsdf_draw bsdf_draw(const struct bsdf *bsdf, struct vec3 wo, struct sample2 u);
/* A direction of a branch. wo: the view of the hit; draw: of rough branches, else ignored. False: none, which counts
 * as black. */
bool bsdf_branch_sample(const struct bsdf *bsdf, const struct bsdf_branch *branch, struct vec3 wo,
                        const struct bsdf_draw *draw, struct bsdf_branch_direction *out);

/* The refracted direction of the smooth surface. False: total reflection. */
bool bsdf_refract(const struct bsdf *bsdf, struct vec3 wo, struct vec3 *out);

#endif
