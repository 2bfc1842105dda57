/* A digest of everything that the renderer reads of a scene, so that equal frames of an animation need not be rendered
 * again. What scripts can change of an object, or make anew in each frame (lights, materials, textures, fogs, skies,
 * recorded functions), counts by its values. What never changes (the shape of a node, meshes, images, tables of
 * numbers) counts by its serial number or its address. Addresses are used again when a scene is rewound or ends, so the
 * epoch of the scene is in the digest, too: it differs after that. Digests of two processes cannot be compared. */
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
/* Adds the scene in its current state. The scene must not be changed by gr.change_... (scene/change.h), whose nodes
 * have serial numbers of their own. False: no memory. */
bool scene_digest_add(const struct scene_content *content, struct digest_sum *sum);

#endif
