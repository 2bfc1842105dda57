/* What can be changed of the base of a material, and how. */
#ifndef GRAY_SCENE_CHANGE_LOOK_H
#define GRAY_SCENE_CHANGE_LOOK_H

#include "base/list.h"
#include "material/material.h"

/* Parts of a base (MATERIAL_PHONG), by the names that scripts use. */
#define LOOK_PART_LIST(X)                                                                                              \
    X(LOOK_KD, "kd")                                                                                                   \
    X(LOOK_KS, "ks")                                                                                                   \
    X(LOOK_SHININESS, "shininess")                                                                                     \
    X(LOOK_REFLECT, "reflect")                                                                                         \
    X(LOOK_ROUGHNESS, "roughness")                                                                                     \
    X(LOOK_REFRACT, "refract")                                                                                         \
    X(LOOK_IOR, "ior")                                                                                                 \
    X(LOOK_EMISSION, "emission")                                                                                       \
    X(LOOK_ABSORPTION, "absorption")
enum look_part { LOOK_PART_LIST(LIST_MEMBER) };
enum { LOOK_PARTS = LIST_COUNT(LOOK_PART_LIST) };
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
