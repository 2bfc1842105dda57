/* What can be changed of the base of a material, and how. */
#ifndef GRAY_SCENE_CHANGE_LOOK_H
#define GRAY_SCENE_CHANGE_LOOK_H

#include "material/material.h"

/* Parts of a base (MATERIAL_PHONG), by the names that scripts use. */
enum look_part {
    LOOK_KD,
    LOOK_KS,
    LOOK_SHININESS,
    LOOK_REFLECT,
    LOOK_ROUGHNESS,
    LOOK_REFRACT,
    LOOK_IOR,
    LOOK_EMISSION,
    LOOK_ABSORPTION,
    LOOK_PARTS
};
const char *look_part_name(enum look_part part);
/* 3 for a colour, else 1. */
int look_part_count(enum look_part part);
/* The numbers a part may have: from *low to *high, both included; they may be infinite. */
void look_part_range(enum look_part part, double *low, double *high);
void look_part_get(const struct material *base, enum look_part part, double numbers[3]);
void look_part_set(struct material *base, enum look_part part, const double numbers[3]);
/* The world that was built does not depend on it. */
bool look_part_keeps_world(enum look_part part);

#endif
