/* Everything here is plain arithmetic on the numbers that scripts give, so that a change of the window and the same
 * change by a script are the same bits. */
#include "scene/change_look.h"

#include <math.h>

const char *look_part_name(enum look_part part) {
    static const char *const names[] = {LOOK_PART_LIST(LIST_WORD)};
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
    }
}
