/* Textures: a colour or a number as a function of the hit. A texture is a value: a constant, a picture with its
 * mapping, filter and wrap, a pattern, or an operation on other textures, which never change. So marble over wood over
 * a picture is one tree. A world has lists in place of trees (texture_tables.h). Source of the word and of the split
 * into mappings and textures: M. Pharr, W. Jakob, G. Humphreys, "Physically Based Rendering", 4th edition, chapter 10.
 *
 * Every texture can be read as a colour and as a number. The number of a colour is the mean of its three components;
 * the number of a product is the product of the numbers, and likewise for mixes. A tree has at most TEXTURE_SIZE
 * textures, counted once for every path to them, which bounds the time and the memory of its evaluation. */
#ifndef GRAY_MATERIAL_TEXTURE_H
#define GRAY_MATERIAL_TEXTURE_H

#include "base/arena.h"
#include "base/error.h"
#include "base/list.h"
#include "expr/expr_program.h"
#include "geometry/hit.h"
#include "image/image.h"
#include "material/dispersion.h"
#include "math/colour.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

/* FUNCTION_POINTS: the maximum number of points of a footprint at which a function is evaluated. */
enum { TEXTURE_SIZE = 16384, FUNCTION_POINTS = 16 };

/* PARAMETER: the number that a material has for one of its inputs; white outside of materials. VERTEX_COLOUR: the
 * colours of a mesh's vertices, interpolated; white where there are none. MARBLE, WOOD: patterns between 0 and 1 of the
 * point in object space, so that they stick to the object. MIX: a * ratio + b * (1 - ratio). MULTIPLY: a * b, by
 * components. MAP: a function of another texture, by components. FUNCTION: a recorded function of the hit. */
#define TEXTURE_KINDS(X)                                                                                               \
    X(TEXTURE_CONSTANT)                                                                                                \
    X(TEXTURE_PARAMETER)                                                                                               \
    X(TEXTURE_VERTEX_COLOUR)                                                                                           \
    X(TEXTURE_IMAGE)                                                                                                   \
    X(TEXTURE_MARBLE)                                                                                                  \
    X(TEXTURE_WOOD)                                                                                                    \
    X(TEXTURE_MIX)                                                                                                     \
    X(TEXTURE_MULTIPLY)                                                                                                \
    X(TEXTURE_MAP)                                                                                                     \
    X(TEXTURE_FUNCTION)
enum texture_kind { TEXTURE_KINDS(LIST_MEMBER) };
enum { TEXTURE_KIND_COUNT = LIST_COUNT(TEXTURE_KINDS) };

/* How a hit becomes a point of an image; the formulas are in texture_mapping.c. The mapping that scripts and files
 * request depends on the shape for spheres and boxes: texture_mapping_on resolves it when the world is built. */
enum texture_mapping {
    MAPPING_SPHERE,   /* spherical, from the origin: td_sphere_material */
    MAPPING_CUBE,     /* by the side that the normal faces: td_cube_material */
    MAPPING_UV,       /* the coordinates that the shape supplies; those of balls are BALL_CLASSIC */
    MAPPING_BY_SHAPE, /* the same; those of balls are BALL */
    MAPPING_FACES,    /* the coordinates of the faces of a box */
    MAPPING_BALL,     /* SPHERE, from the centre of a sphere */
    MAPPING_BALL_CLASSIC,
};

/* What the alpha of an image means. */
enum texture_alpha {
    ALPHA_COVERS,   /* the texture below has the weight 1 - alpha */
    ALPHA_IGNORED,  /* the image is opaque where alpha is not 0 */
    ALPHA_DARKENS,  /* the colour is multiplied by alpha; no texture below */
    ALPHA_STRAIGHT, /* the colour without alpha; no texture below */
    ALPHA_ONLY      /* the value is alpha */
};

/* What the numbers of an image mean in linear colours. AUTO: sRGB where 8 bits are read as a colour, else light. */
#define TEXTURE_ENCODINGS(X)                                                                                           \
    X(ENCODING_AUTO, "auto")                                                                                           \
    X(ENCODING_SRGB, "srgb")                                                                                           \
    X(ENCODING_LINEAR, "linear")
enum texture_encoding { TEXTURE_ENCODINGS(LIST_MEMBER) };

/* The mapping and lookup of an image; zero: MAPPING_SPHERE, the nearest texel. */
struct texture_image {
    struct image *image;
    enum texture_mapping mapping;
    enum image_filter filter;
    enum image_wrap wrap;   /* of coordinates that a shape supplies */
    enum image_wrap wrap_v; /* if `apart` is set, else wrap is for both */
    bool flip_u;
    bool outside; /* on spheres, u runs to the right as seen from outside; the classic mappings are mirrored */
    /* The point is scale * uv + cross * vu + offset (v from below), the colour is multiplied by tint. */
    bool apart;
    double scale[2], cross[2], offset[2];
    bool second; /* the second coordinates of a mesh */
    struct colour tint;
    enum texture_alpha alpha;
    enum texture_encoding encoding;
    double gamma; /* in place of `encoding`, where it is above 0: light is the number to this power */
    bool cuts;    /* its alpha is the opacity of the surface that it colours (material_cut_by_alpha) */
};

/* RED, GREEN, BLUE: one component, as a number. COMPLEMENT: 1 - x. SATURATE: between 0 and 1. STEP: 1 from `amount` on,
 * else 0. PHONG_EXPONENT: of roughness r 2 / r^4 - 2, 1 to 2000 (formats/gltf_material.c gives the source). */
#define TEXTURE_FUNCTIONS(X)                                                                                           \
    X(FUNCTION_RED)                                                                                                    \
    X(FUNCTION_GREEN)                                                                                                  \
    X(FUNCTION_BLUE)                                                                                                   \
    X(FUNCTION_COMPLEMENT)                                                                                             \
    X(FUNCTION_SATURATE)                                                                                               \
    X(FUNCTION_STEP)
enum texture_function { TEXTURE_FUNCTIONS(LIST_MEMBER) };
enum { FUNCTION_COUNT = LIST_COUNT(TEXTURE_FUNCTIONS) };

/* AS_SET: by the settings of the picture. */
enum material_highlight { HIGHLIGHT_AS_SET, HIGHLIGHT_PHONG, HIGHLIGHT_BLINN };

/* The numbers of a material without textures, whose inputs textures replace or change. */
struct phong {
    struct colour kd, ks;
    double shininess, reflect, refract, ior;
    bool has_ior, two_sided, unlit;
    enum material_highlight highlight;
    struct colour emission, absorption;
    double roughness;
    int glossy_samples;
    struct dispersion dispersion; /* of the index, inside of solids */
};

/* Inputs of materials: the names that scripts use, and whether it is a colour; first those of gr.openpbr_material
 * alone, whose numbers are in struct openpbr. Opacity is that of a surface with holes: 1 without a texture. */
#define OPENPBR_INPUTS(X)                                                                                              \
    X(INPUT_BASE_WEIGHT, "base_weight", false)                                                                         \
    X(INPUT_DIFFUSE_ROUGHNESS, "base_diffuse_roughness", false)                                                        \
    X(INPUT_METALNESS, "base_metalness", false)                                                                        \
    X(INPUT_SPECULAR_WEIGHT, "specular_weight", false)                                                                 \
    X(INPUT_SPECULAR_ANISOTROPY, "specular_roughness_anisotropy", false)                                               \
    X(INPUT_SPECULAR_IOR, "specular_ior", false)                                                                       \
    X(INPUT_TRANSMISSION_COLOUR, "transmission_color", true)                                                           \
    X(INPUT_SUBSURFACE_WEIGHT, "subsurface_weight", false)                                                             \
    X(INPUT_SUBSURFACE_COLOUR, "subsurface_color", true)                                                               \
    X(INPUT_SUBSURFACE_RADIUS, "subsurface_radius", false)                                                             \
    X(INPUT_COAT_WEIGHT, "coat_weight", false)                                                                         \
    X(INPUT_COAT_COLOUR, "coat_color", true)                                                                           \
    X(INPUT_COAT_ROUGHNESS, "coat_roughness", false)                                                                   \
    X(INPUT_COAT_ANISOTROPY, "coat_roughness_anisotropy", false)                                                       \
    X(INPUT_COAT_IOR, "coat_ior", false)                                                                               \
    X(INPUT_COAT_DARKENING, "coat_darkening", false)                                                                   \
    X(INPUT_FUZZ_WEIGHT, "fuzz_weight", false)                                                                         \
    X(INPUT_FUZZ_COLOUR, "fuzz_color", true)                                                                           \
    X(INPUT_FUZZ_ROUGHNESS, "fuzz_roughness", false)                                                                   \
    X(INPUT_FILM_WEIGHT, "thin_film_weight", false)                                                                    \
    X(INPUT_FILM_THICKNESS, "thin_film_thickness", false)
#define MATERIAL_INPUTS(X)                                                                                             \
    X(INPUT_KD, "kd", true)                                                                                            \
    X(INPUT_KS, "ks", true)                                                                                            \
    X(INPUT_SHININESS, "shininess", false)                                                                             \
    X(INPUT_REFLECT, "reflect", false)                                                                                 \
    X(INPUT_REFRACT, "refract", false)                                                                                 \
    X(INPUT_ROUGHNESS, "roughness", false)                                                                             \
    X(INPUT_EMISSION, "emission", true)                                                                                \
    X(INPUT_OPACITY, "opacity", false)                                                                                 \
    OPENPBR_INPUTS(X)
enum material_input { MATERIAL_INPUTS(LIST_MEMBER) };
enum { INPUT_COUNT = LIST_COUNT(MATERIAL_INPUTS) };

/* The point where a recorded function returned NaN. Of several points it is the smallest one, so that it does not
 * depend on the order of threads. */
struct texture_nan {
    atomic_flag lock;
    bool found;
    double point[3];
};

/* What a texture does by itself, without its parts. */
struct texture_operation {
    enum texture_kind kind;
    union {
        struct {
            struct colour colour;
            double number;
            bool display; /* decoded from sRGB in linear colours */
        } constant;
        enum material_input parameter;
        struct texture_image image;
        struct {
            double f, multiplier, vein_frequency;
            int interpolation;
        } marble;
        struct {
            double f, density;
            int interpolation;
        } wood;
        struct {
            enum texture_function function;
            double amount;
        } map;
        struct {
            const struct expr_program *program; /* one output or three; of the script's arena */
            struct texture_nan *nan;            /* of a world, where all workers report; NULL: nowhere */
            enum texture_mapping mapping;       /* of u and v */
            bool has_coordinates;               /* it reads u or v */
            int points;                         /* of a footprint at most: a power of two up to FUNCTION_POINTS */
            struct colour average, largest;     /* of some points: estimates */
        } recorded;
    };
};

/* MIX: a, b, ratio. MULTIPLY: a, b. MAP: what it is a function of. IMAGE: the texture below, which is also used if the
 * surface has no coordinates; NULL: black. */
enum { TEXTURE_PARTS = 3, PART_A = 0, PART_B = 1, PART_RATIO = 2 };
struct texture {
    struct texture_operation operation;
    const struct texture *parts[TEXTURE_PARTS];
    const char *source; /* of a recorded function: "scene.lua:12", or "" */
    bool shared;        /* several inputs of a material use it: evaluated once per hit */
    bool has_image;     /* of the whole tree: it needs the footprint of the ray */
    bool has_function;  /* of the whole tree: it needs the tangents of the pattern */
    uint8_t depth;      /* so many values are known at a time while it is evaluated (texture_tables.h) */
    uint32_t size;      /* of the tree */
};

struct texture texture_constant(struct colour colour);
/* A colour as a screen shows it: decoded from sRGB where colours are linear. */
struct texture texture_display_colour(struct colour colour);
struct texture texture_number(double number);
struct texture texture_vertex_colour(void);
/* The arguments of noise_marble and noise_wood (math/noise.h). */
struct texture texture_marble(double f, double multiplier, double vein_frequency, int interpolation);
struct texture texture_wood(double f, double density, int interpolation);
struct texture texture_image(const struct texture_image *image, const struct texture *below);
struct texture texture_mix(const struct texture *a, const struct texture *b, const struct texture *ratio);
struct texture texture_multiply(const struct texture *a, const struct texture *b);
struct texture texture_map(const struct texture *of, enum texture_function function, double amount);
/* A function of the inputs in EXPR_INPUTS, with one output or three. has_coordinates: it reads u or v. The estimates
 * are results of texture_estimate. */
struct texture texture_function(const struct expr_program *program, bool has_coordinates, struct colour average,
                                struct colour largest);
/* The number of that input of the evaluated material. */
const struct texture *texture_parameter(enum material_input input);
/* The image if the texture is only an image; else NULL. */
static inline const struct texture_image *texture_as_image(const struct texture *texture) {
    return texture->operation.kind == TEXTURE_IMAGE && texture->size == 1 ? &texture->operation.image : NULL;
}

/* A copy in the arena. NULL and error: no memory, or the tree is larger than TEXTURE_SIZE. */
const struct texture *texture_keep(struct arena *arena, struct texture value, struct error *error);

/* How an image becomes light; colour: it is read as one. */
struct transfer_function texture_image_transfer(const struct texture_image *lookup, bool colour);
/* The number of parts; that of an image may be NULL. */
int texture_part_count(enum texture_kind kind);
/* So many of them, the first ones, are read as colours if the texture is: not the ratio of a mix, and not what a
 * function is of. */
int texture_colour_parts(enum texture_kind kind);

/* The value of an input among the numbers of a material, which may be NULL. */
struct colour texture_parameter_colour(enum material_input input, const struct phong *numbers);
/* One component. */
double texture_map_number(const struct texture_operation *map, double x);
/* Whether the function selects one component of a colour; which. */
bool texture_map_component(const struct texture_operation *map, struct colour colour, double *out);
struct colour texture_map_colour(const struct texture_operation *map, struct colour of);

/* Estimates of a texture without a hit, for a material with these numbers. */
enum texture_estimate {
    TEXTURE_AVERAGE,      /* of images: of all texels; of patterns: one half */
    TEXTURE_LARGEST,      /* a bound of each component if none is negative and no texel above 1 */
    TEXTURE_LARGEST_TEXEL /* a closer bound, which reads all texels of images */
};
struct colour texture_estimate(const struct texture *texture, const struct phong *numbers, enum texture_estimate which);
/* From the estimates of its parts. */
struct colour texture_operation_estimate(const struct texture_operation *operation,
                                         const struct colour parts[TEXTURE_PARTS], const struct phong *numbers,
                                         enum texture_estimate which);

#endif
