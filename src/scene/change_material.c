/* Everything here is simple arithmetic on the numbers of scripts, so that a change in the window and the same change by
 * a script give the same bits. */
#include "scene/change_material.h"

#include <math.h>

const char *material_part_name(enum material_part part) {
    static const char *const names[] = {MATERIAL_PART_LIST(LIST_WORD)};
    return names[part];
}

int material_part_count(enum material_part part) {
    return part == MATERIAL_PART_KD || part == MATERIAL_PART_KS || part == MATERIAL_PART_EMISSION ||
                   part == MATERIAL_PART_ABSORPTION
               ? 3
               : 1;
}

void material_part_range(enum material_part part, double *low, double *high) {
    bool share = part == MATERIAL_PART_REFLECT || part == MATERIAL_PART_REFRACT || part == MATERIAL_PART_ROUGHNESS;
    bool any = part == MATERIAL_PART_KD || part == MATERIAL_PART_KS || part == MATERIAL_PART_EMISSION;
    *low = any ? -INFINITY : part == MATERIAL_PART_IOR ? 1 : 0;
    *high = share ? 1 : INFINITY;
}

bool material_part_keeps_world(enum material_part part) {
    return part == MATERIAL_PART_KD || part == MATERIAL_PART_KS || part == MATERIAL_PART_SHININESS;
}

static void put(double numbers[3], struct vec3 v) {
    numbers[0] = v.x;
    numbers[1] = v.y;
    numbers[2] = v.z;
}

static struct vec3 three(const double numbers[3]) {
    return vec3_make(numbers[0], numbers[1], numbers[2]);
}

void material_part_get(const struct material *base, enum material_part part, double numbers[3]) {
    numbers[0] = numbers[1] = numbers[2] = 0;
    switch (part) {
    case MATERIAL_PART_KD:
        put(numbers, base->phong.kd);
        return;
    case MATERIAL_PART_KS:
        put(numbers, base->phong.ks);
        return;
    case MATERIAL_PART_SHININESS:
        numbers[0] = base->phong.shininess;
        return;
    case MATERIAL_PART_REFLECT:
        numbers[0] = base->phong.reflect;
        return;
    case MATERIAL_PART_ROUGHNESS:
        numbers[0] = base->phong.roughness;
        return;
    case MATERIAL_PART_REFRACT:
        numbers[0] = base->phong.refract;
        return;
    case MATERIAL_PART_IOR:
        numbers[0] = base->phong.ior;
        return;
    case MATERIAL_PART_EMISSION:
        put(numbers, base->phong.emission);
        return;
    case MATERIAL_PART_ABSORPTION:
        put(numbers, base->phong.absorption);
        return;
    }
}

void material_part_set(struct material *base, enum material_part part, const double numbers[3]) {
    switch (part) {
    case MATERIAL_PART_KD:
        base->phong.kd = three(numbers);
        return;
    case MATERIAL_PART_KS:
        base->phong.ks = three(numbers);
        return;
    case MATERIAL_PART_SHININESS:
        base->phong.shininess = numbers[0];
        return;
    case MATERIAL_PART_REFLECT:
        base->phong.reflect = numbers[0];
        return;
    case MATERIAL_PART_ROUGHNESS:
        base->phong.roughness = numbers[0];
        return;
    case MATERIAL_PART_REFRACT:
        base->phong.refract = numbers[0];
        return;
    case MATERIAL_PART_IOR:
        base->phong.ior = numbers[0];
        base->phong.has_ior = true;
        return;
    case MATERIAL_PART_EMISSION:
        base->phong.emission = three(numbers);
        return;
    case MATERIAL_PART_ABSORPTION:
        base->phong.absorption = three(numbers);
        return;
    }
}
