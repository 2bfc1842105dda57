/* Properties of lights, for listings and editors. Changes depend only on the properties (light_properties), not on the
 * kind: simple arithmetic on the numbers of scripts, so that a change in the window and the same change by a script
 * give the same bits. */
#include "light/light_edit.h"

#include "light/light_mesh.h"
#include "math/elementary.h"

#include <math.h>

#define KIND_NAME(kind, name)                                                                                          \
    case kind:                                                                                                         \
        return name;

const char *light_kind_name(enum light_kind kind) {
    switch (kind) { LIGHT_KINDS(KIND_NAME) }
    return "?";
}

bool light_is_seen(const struct light *light) {
    switch (light->kind) {
    case LIGHT_SKY:
        return true;
    case LIGHT_MESH: /* the mesh shows the emission of its material */
        return !light->has_emission && light->mesh->shown;
        POINT_LIGHTS(LIST_LABEL)
        SURFACE_LIGHTS(LIST_LABEL)
        break;
    }
    return light->visible;
}

unsigned light_properties(const struct light *light) {
    switch (light->kind) {
    case LIGHT_POINT:
        return LIGHT_HAS_POSITION | (light->attenuation == ATTENUATION_RANGE ? LIGHT_HAS_RANGE : 0U);
    case LIGHT_PARALLELOGRAM:
        return LIGHT_HAS_POSITION | LIGHT_HAS_EDGES;
    case LIGHT_DIRECTIONAL:
        return LIGHT_HAS_DIRECTION;
    case LIGHT_SPOT:
        return LIGHT_HAS_POSITION | LIGHT_HAS_DIRECTION | LIGHT_HAS_CONE;
    case LIGHT_DISC:
        return LIGHT_HAS_POSITION | LIGHT_HAS_DIRECTION | LIGHT_HAS_RADIUS;
    case LIGHT_SPHERE:
        return LIGHT_HAS_POSITION | LIGHT_HAS_RADIUS;
    case LIGHT_SKY:
        return LIGHT_IS_ENVIRONMENT;
    case LIGHT_MESH:
        break;
    }
    return 0;
}

bool light_centre(const struct light *light, struct vec3 *out) {
    struct light_target middle;
    if (light->mesh)
        *out = light->mesh->centre;
    else if (light_middle(light, &middle) && !middle.distant)
        *out = middle.at;
    else
        return false;
    return true;
}

static bool has(const struct light *light, unsigned properties) {
    return (light_properties(light) & properties) != 0;
}

bool light_can_move(const struct light *light) {
    return has(light, LIGHT_HAS_POSITION);
}

bool light_can_turn(const struct light *light) {
    return has(light, LIGHT_HAS_DIRECTION | LIGHT_HAS_EDGES | LIGHT_IS_ENVIRONMENT);
}

bool light_can_size(const struct light *light) {
    return has(light, LIGHT_HAS_EDGES | LIGHT_HAS_RADIUS | LIGHT_HAS_CONE | LIGHT_HAS_RANGE);
}

void light_move(struct light *light, struct vec3 offset) {
    light->position = vec3_add(light->position, offset);
    light->corner = vec3_add(light->corner, offset);
}

static struct vec3 row_times(const double turn[TURN_NUMBERS], struct vec3 v) {
    return vec3_make(turn[0] * v.x + turn[1] * v.y + turn[2] * v.z, turn[3] * v.x + turn[4] * v.y + turn[5] * v.z,
                     turn[6] * v.x + turn[7] * v.y + turn[8] * v.z);
}

double light_turn_volume(const double turn[TURN_NUMBERS]) {
    const double *t = turn;
    return t[0] * (t[4] * t[8] - t[5] * t[7]) - t[1] * (t[3] * t[8] - t[5] * t[6]) + t[2] * (t[3] * t[7] - t[4] * t[6]);
}

/* With t = tan(h/2): t^2 = (1 - cos h) / (1 + cos h). */
static double cone_sized(double cosine, double size) {
    double near = 1 + cosine, far = size * size * (1 - cosine);
    return near + far > 0 ? (near - far) / (near + far) : cosine;
}

/* The trace of its product with the map is largest. */
bool turn_about_y(const double turn[TURN_NUMBERS], double *sine, double *cosine) {
    double s = turn[2] - turn[6], c = turn[0] + turn[8], length = sqrt(s * s + c * c);
    *sine = s / length;
    *cosine = c / length;
    return length > 0 && length < INFINITY;
}

void light_turn_sky(const struct light *light, const double turn[TURN_NUMBERS], struct sky_turn *sky) {
    double sine, cosine;
    if (!has(light, LIGHT_IS_ENVIRONMENT) || !turn_about_y(turn, &sine, &cosine))
        return;
    double s = sky->turned ? sky->sine : 0, c = sky->turned ? sky->cosine : 1;
    *sky = (struct sky_turn){true, s * cosine + c * sine, c * cosine - s * sine};
}

void light_turn(struct light *light, const double turn[TURN_NUMBERS]) {
    double size = el_cbrt(fabs(light_turn_volume(turn)));
    if (has(light, LIGHT_HAS_DIRECTION))
        light->direction = vec3_normalize(row_times(turn, light->direction));
    if (has(light, LIGHT_HAS_EDGES)) {
        light->corner = vec3_add(light->position, row_times(turn, vec3_sub(light->corner, light->position)));
        light->edge1 = row_times(turn, light->edge1);
        light->edge2 = row_times(turn, light->edge2);
    }
    if (has(light, LIGHT_HAS_CONE)) {
        light->cos_inner = cone_sized(light->cos_inner, size);
        light->cos_outer = cone_sized(light->cos_outer, size);
    }
    if (has(light, LIGHT_HAS_RANGE))
        light->range *= size;
    light->radius *= size;
}
