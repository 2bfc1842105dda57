/* A digest of all data of a scene that the renderer reads, so that equal frames of an animation need not be rendered
 * again. Data that scripts can change or create anew in each frame (lights, materials, textures, fogs, skies, recorded
 * functions) counts by value. Data that never changes (the shape of a node, meshes, images, tables of numbers) counts
 * by serial number or address. Addresses are used again after a scene is rewound or ends. So the digest includes the
 * epoch of the scene, which differs then. Digests of two processes cannot be compared. */
#ifndef GRAY_SCENE_SCENE_DIGEST_H
#define GRAY_SCENE_SCENE_DIGEST_H

#include "base/hash.h"
#include "light/sky.h"
#include "material/medium.h"
#include "scene/node.h"

struct scene_content {
    const struct scene *scene;
    const struct node *root;
    const struct scene_light *lights;
    uint32_t light_count;
    const struct sky *sky;
    const struct fog *fog; /* or NULL */
};
/* Adds the current state of the scene. The scene must not be changed by gr.change_... (scene/change.h), whose nodes
 * have separate serial numbers. False: no memory. */
bool scene_digest_add(const struct scene_content *content, struct digest_sum *sum);

static inline void digest_sum_add_vector(struct digest_sum *sum, struct vec3 v) {
    const double numbers[3] = {v.x, v.y, v.z};
    digest_sum_add_numbers(sum, numbers, 3);
}

#endif
