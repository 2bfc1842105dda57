/* The store of assets: outlives scripts and renders. */
#ifndef GRAY_SCENE_ASSETS_H
#define GRAY_SCENE_ASSETS_H

#include "image/image.h"
#include "mesh/mesh.h"

struct asset_mesh {
    struct mesh *mesh;
    uint64_t key;
    bool of_file;               /* the key is that of the pointer; else that of the tables */
    struct asset_mesh *next;    /* older */
    struct asset_mesh *chained; /* in the same slot of the hash table */
};
struct asset_image {
    struct image *image;
    char *path;
    struct asset_image *next;
};
/* Any other object that was made from a file and is kept; only its maker knows its type. */
struct asset_object {
    void *object;
    void (*destroy)(void *object);
    char *key;
    struct asset_object *next;
};
struct assets {
    struct asset_object *objects;
    struct asset_mesh *meshes;      /* the newest first */
    struct asset_mesh **mesh_slots; /* the same by key: a power of two of chains, as many as meshes or more */
    size_t mesh_slot_count;
    struct asset_image *images;
    uint32_t mesh_count, image_count;
    uint64_t memory; /* bytes that scripts with a limit have left here */
    uint64_t epochs; /* of all scenes */
};
void assets_destroy(struct assets *assets);
/* The mesh of this input: an equal one from the store or a new one. Owned by the store. */
struct mesh *assets_mesh(struct assets *assets, const struct mesh_input *input, struct error *error);
struct image *assets_image(struct assets *assets, const char *path, struct error *error);
/* Whether it has the picture in that file. */
bool assets_has_image(const struct assets *assets, const char *path);
/* By key (the canonical path and how it was read); NULL when it is not there yet; and the way to add it: the store
 * takes over object, also when it fails. */
void *assets_find_object(struct assets *assets, const char *key);
bool assets_add_object(struct assets *assets, const char *key, void *object, void (*destroy)(void *object),
                       struct error *error);
/* Releases the meshes of tables that are newer than `until`. */
void assets_drop_meshes(struct assets *assets, const struct asset_mesh *until);
/* A mesh that something in the store owns is counted with the others. The store becomes one more owner. */
bool assets_keep_mesh(struct assets *assets, struct mesh *mesh, struct error *error);

#endif
