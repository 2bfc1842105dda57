/* Changes of the base of a material. */
#ifndef GRAY_SCENE_CHANGE_MATERIAL_H
#define GRAY_SCENE_CHANGE_MATERIAL_H

#include "base/list.h"
#include "material/material.h"

/* Parts of a base (MATERIAL_PHONG), by the names that scripts use. */
#define MATERIAL_PART_LIST(X)                                                                                          \
    X(MATERIAL_PART_KD, "kd")                                                                                          \
    X(MATERIAL_PART_KS, "ks")                                                                                          \
    X(MATERIAL_PART_SHININESS, "shininess")                                                                            \
    X(MATERIAL_PART_REFLECT, "reflect")                                                                                \
    X(MATERIAL_PART_ROUGHNESS, "roughness")                                                                            \
    X(MATERIAL_PART_REFRACT, "refract")                                                                                \
    X(MATERIAL_PART_IOR, "ior")                                                                                        \
    X(MATERIAL_PART_EMISSION, "emission")                                                                              \
    X(MATERIAL_PART_ABSORPTION, "absorption")
enum material_part { MATERIAL_PART_LIST(LIST_MEMBER) };
enum { MATERIAL_PART_PARTS = LIST_COUNT(MATERIAL_PART_LIST) };
const char *material_part_name(enum material_part part);
/* 3 for a colour, else 1. */
int material_part_count(enum material_part part);
/* The numbers a part may have: from *low to *high, both included; they may be infinite. */
void material_part_range(enum material_part part, double *low, double *high);
void material_part_get(const struct material *base, enum material_part part, double numbers[3]);
void material_part_set(struct material *base, enum material_part part, const double numbers[3]);
/* Whether the built world does not depend on it. */
bool material_part_keeps_world(enum material_part part);

#endif
