/* Everything here is plain arithmetic on the numbers that scripts give, so that a change of the window and the same
 * change by a script are the same bits. */
#include "scene/change_look.h"

#include "math/elementary.h"

#include <math.h>

bool light_can_move(const struct light *light) {
    return light->kind == LIGHT_POINT || light->kind == LIGHT_SPOT || light_has_extent(light);
}

bool light_can_turn(const struct light *light) {
    return light->kind == LIGHT_SPOT || light->kind == LIGHT_DIRECTIONAL || light->kind == LIGHT_PARALLELOGRAM ||
           light->kind == LIGHT_DISC || light->kind == LIGHT_SKY;
}

bool light_can_size(const struct light *light) {
    return light_has_extent(light) || light->kind == LIGHT_SPOT ||
           (light->kind == LIGHT_POINT && light->fading == FADING_RANGE);
}

void light_move(struct light *light, struct vec3 way) {
    light->position = vec3_add(light->position, way);
    light->corner = vec3_add(light->corner, way);
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

static void turn_sky(struct light *light, const double turn[TURN_NUMBERS]) {
    double sine, cosine;
    if (!turn_about_y(turn, &sine, &cosine))
        return;
    double s = light->sky_turned ? light->turn_sine : 0, c = light->sky_turned ? light->turn_cosine : 1;
    light->sky_turned = true;
    light->turn_sine = s * cosine + c * sine;
    light->turn_cosine = c * cosine - s * sine;
}

void light_turn(struct light *light, const double turn[TURN_NUMBERS]) {
    double size = el_cbrt(fabs(light_turn_volume(turn)));
    struct vec3 direction = row_times(turn, light->direction);
    if (light->kind == LIGHT_DIRECTIONAL || light->kind == LIGHT_SPOT || light->kind == LIGHT_DISC)
        light->direction = vec3_normalize(direction);
    if (light->kind == LIGHT_PARALLELOGRAM) {
        light->corner = vec3_add(light->position, row_times(turn, vec3_sub(light->corner, light->position)));
        light->edge1 = row_times(turn, light->edge1);
        light->edge2 = row_times(turn, light->edge2);
    }
    if (light->kind == LIGHT_SPOT) {
        light->cos_inner = cone_sized(light->cos_inner, size);
        light->cos_outer = cone_sized(light->cos_outer, size);
    }
    if (light->kind == LIGHT_SKY)
        turn_sky(light, turn);
    if (light->kind == LIGHT_POINT)
        light->range *= size;
    light->radius *= size;
}

const char *look_part_name(enum look_part part) {
    static const char *const names[LOOK_PARTS] = {"kd",      "ks",  "shininess", "reflect",   "roughness",
                                                  "refract", "ior", "emission",  "absorption"};
    return names[part];
}

int look_part_count(enum look_part part) {
    return part == LOOK_KD || part == LOOK_KS || part == LOOK_EMISSION || part == LOOK_ABSORPTION ? 3 : 1;
}

void look_part_range(enum look_part part, double *low, double *high) {
    bool share = part == LOOK_REFLECT || part == LOOK_REFRACT || part == LOOK_ROUGHNESS;
    bool any = part == LOOK_KD || part == LOOK_KS || part == LOOK_EMISSION;
    *low = any ? -INFINITY : part == LOOK_IOR ? 1 : 0;
    *high = share ? 1 : INFINITY;
}

bool look_part_keeps_world(enum look_part part) {
    return part == LOOK_KD || part == LOOK_KS || part == LOOK_SHININESS;
}

static void put(double numbers[3], struct vec3 v) {
    numbers[0] = v.x;
    numbers[1] = v.y;
    numbers[2] = v.z;
}

static struct vec3 three(const double numbers[3]) {
    return vec3_make(numbers[0], numbers[1], numbers[2]);
}

void look_part_get(const struct material *base, enum look_part part, double numbers[3]) {
    numbers[0] = numbers[1] = numbers[2] = 0;
    switch (part) {
    case LOOK_KD:
        put(numbers, base->phong.kd);
        return;
    case LOOK_KS:
        put(numbers, base->phong.ks);
        return;
    case LOOK_SHININESS:
        numbers[0] = base->phong.shininess;
        return;
    case LOOK_REFLECT:
        numbers[0] = base->phong.reflect;
        return;
    case LOOK_ROUGHNESS:
        numbers[0] = base->phong.roughness;
        return;
    case LOOK_REFRACT:
        numbers[0] = base->phong.refract;
        return;
    case LOOK_IOR:
        numbers[0] = base->phong.ior;
        return;
    case LOOK_EMISSION:
        put(numbers, base->phong.emission);
        return;
    case LOOK_ABSORPTION:
        put(numbers, base->phong.absorption);
        return;
    case LOOK_PARTS:
        return;
    }
}

void look_part_set(struct material *base, enum look_part part, const double numbers[3]) {
    switch (part) {
    case LOOK_KD:
        base->phong.kd = three(numbers);
        return;
    case LOOK_KS:
        base->phong.ks = three(numbers);
        return;
    case LOOK_SHININESS:
        base->phong.shininess = numbers[0];
        return;
    case LOOK_REFLECT:
        base->phong.reflect = numbers[0];
        return;
    case LOOK_ROUGHNESS:
        base->phong.roughness = numbers[0];
        return;
    case LOOK_REFRACT:
        base->phong.refract = numbers[0];
        return;
    case LOOK_IOR:
        base->phong.ior = numbers[0];
        base->phong.has_ior = true;
        return;
    case LOOK_EMISSION:
        base->phong.emission = three(numbers);
        return;
    case LOOK_ABSORPTION:
        base->phong.absorption = three(numbers);
        return;
    case LOOK_PARTS:
        return;
    }
}
