/* Shading: what a surface does with light at one hit, as a short list of lobes. Materials become shadings, integrators
 * read shadings; no material kinds after this point. Directions are unit vectors in world space. */
#ifndef GRAY_MATERIAL_SHADING_H
#define GRAY_MATERIAL_SHADING_H

#include "base/list.h"
#include "math/vec3.h"

#include <stdbool.h>

#define SPECULAR_KINDS(X)                                                                                              \
    X(SPECULAR_PHONG, "phong")                                                                                         \
    X(SPECULAR_BLINN, "blinn")
enum specular_kind { SPECULAR_KINDS(LIST_MEMBER) };

enum lobe_kind {
    LOBE_DIFFUSE, /* weight * max(0, n.l) */
    LOBE_PHONG,   /* weight * max(0, r.v)^exponent on the lit side */
    LOBE_BLINN,   /* weight * max(0, n.h)^exponent on the lit side */
    LOBE_MIRROR,  /* weight * colour of the reflected ray */
    LOBE_REFRACT, /* weight * colour of the refracted ray */
};

struct lobe {
    enum lobe_kind kind;
    struct vec3 weight;
    double exponent;
};

enum { SHADING_LOBES = 4 };

struct shading {
    int count;
    struct lobe lobes[SHADING_LOBES];
    struct vec3 ambient;  /* multiplied with the scene's ambient colour */
    struct vec3 emission; /* added as it is */
    double alpha;         /* width of the facets' slopes for mirror and refraction; 0: smooth */
};

/* Light reflected towards `view` for unit light arriving from `to_light`, by the lobes of finite width (SPEC 1.2). */
struct vec3 shading_evaluate(const struct shading *shading, struct vec3 normal, struct vec3 view, struct vec3 to_light);
struct vec3 shading_reflect(struct vec3 normal, struct vec3 view); /* 2 (n.v) n - v */
/* Snell's law with the normal on the side of `view`; eta = index on view's side / index on the other side. False: total
 * internal reflection. */
bool shading_refract(struct vec3 normal, struct vec3 view, double eta, struct vec3 *out);
/* Unpolarised Fresnel reflectance of a dielectric; 1 beyond the critical angle. cos_view > 0. */
double shading_fresnel(double cos_view, double eta);

#endif
