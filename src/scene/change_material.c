/* Everything here is simple arithmetic on the numbers of scripts, so that a change in the window and the same change by
 * a script give the same bits. */
#include "scene/change_material.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

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

/* Where the numbers of the parts begin. */
#define OFFSET(part, name) [part] = offsetof(struct phong, name)
static const size_t offsets[] = {
    OFFSET(MATERIAL_PART_KD, kd),
    OFFSET(MATERIAL_PART_KS, ks),
    OFFSET(MATERIAL_PART_SHININESS, shininess),
    OFFSET(MATERIAL_PART_REFLECT, reflect),
    OFFSET(MATERIAL_PART_ROUGHNESS, roughness),
    OFFSET(MATERIAL_PART_REFRACT, refract),
    OFFSET(MATERIAL_PART_IOR, ior),
    OFFSET(MATERIAL_PART_EMISSION, emission),
    OFFSET(MATERIAL_PART_ABSORPTION, absorption),
};
_Static_assert(sizeof offsets / sizeof *offsets == MATERIAL_PART_PARTS, "a part without its numbers");

void material_part_get(const struct material *base, enum material_part part, double numbers[3]) {
    numbers[0] = numbers[1] = numbers[2] = 0;
    memcpy(numbers, (const char *)&base->phong + offsets[part], (size_t)material_part_count(part) * sizeof *numbers);
}

void material_part_set(struct material *base, enum material_part part, const double numbers[3]) {
    memcpy((char *)&base->phong + offsets[part], numbers, (size_t)material_part_count(part) * sizeof *numbers);
    base->phong.has_ior |= part == MATERIAL_PART_IOR;
}
