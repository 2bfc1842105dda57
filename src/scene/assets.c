/* The store of assets: equal assets are stored once, however often scripts request them. Keys are content (tables) or
 * canonical path (files); a list is enough, since a look-up costs far less than making the asset. */
#include "base/mem.h"
#include "image/image.h"
#include "scene/node.h"

#include <string.h>

static char *copy_path(const char *path) {
    size_t size = strlen(path) + 1;
    char *copy = mem_alloc(size);
    if (copy)
        memcpy(copy, path, size);
    return copy;
}

void assets_destroy(struct assets *assets) {
    while (assets->objects) {
        struct asset_object *next = assets->objects->next;
        assets->objects->destroy(assets->objects->object);
        mem_free(assets->objects->key);
        mem_free(assets->objects);
        assets->objects = next;
    }
    while (assets->meshes) {
        struct asset_mesh *next = assets->meshes->next;
        mesh_release(assets->meshes->mesh);
        mem_free(assets->meshes);
        assets->meshes = next;
    }
    while (assets->images) {
        struct asset_image *next = assets->images->next;
        image_release(assets->images->image);
        mem_free(assets->images->path);
        mem_free(assets->images);
        assets->images = next;
    }
    *assets = (struct assets){.epochs = assets->epochs};
}

/* Takes over mesh, also when it fails. */
static bool keep_mesh(struct assets *assets, struct mesh *mesh, uint64_t key, struct error *error) {
    struct asset_mesh *entry = mem_alloc_zero(1, sizeof *entry);
    if (!entry) {
        mesh_release(mesh);
        return error_no_memory(error, "the store of meshes");
    }
    *entry = (struct asset_mesh){.mesh = mesh, .key = key, .next = assets->meshes};
    assets->meshes = entry;
    assets->mesh_count++;
    return true;
}

struct mesh *assets_mesh(struct assets *assets, const struct mesh_input *input, struct error *error) {
    uint64_t key = mesh_input_hash(input);
    for (struct asset_mesh *entry = assets->meshes; entry; entry = entry->next) {
        if (entry->key == key && mesh_equals_input(entry->mesh, input))
            return entry->mesh;
    }
    struct mesh *mesh = mesh_create(input, error);
    return mesh && keep_mesh(assets, mesh, key, error) ? mesh : NULL;
}

void assets_drop_meshes(struct assets *assets, const struct asset_mesh *until) {
    struct asset_mesh **link = &assets->meshes;
    while (*link != until) {
        struct asset_mesh *entry = *link;
        if (entry->key == 0) {
            link = &entry->next;
            continue;
        }
        *link = entry->next;
        mesh_release(entry->mesh);
        mem_free(entry);
        assets->mesh_count--;
    }
}

void *assets_find_object(struct assets *assets, const char *key) {
    for (struct asset_object *entry = assets->objects; entry; entry = entry->next) {
        if (strcmp(entry->key, key) == 0)
            return entry->object;
    }
    return NULL;
}

bool assets_add_object(struct assets *assets, const char *key, void *object, void (*destroy)(void *object),
                       struct error *error) {
    struct asset_object *entry = mem_alloc_zero(1, sizeof *entry);
    char *copy = copy_path(key);
    if (!entry || !copy) {
        mem_free(entry);
        mem_free(copy);
        destroy(object);
        return error_no_memory(error, "the store of files");
    }
    *entry = (struct asset_object){.object = object, .destroy = destroy, .key = copy, .next = assets->objects};
    assets->objects = entry;
    return true;
}

bool assets_keep_mesh(struct assets *assets, struct mesh *mesh, struct error *error) {
    for (struct asset_mesh *entry = assets->meshes; entry; entry = entry->next)
        if (entry->mesh == mesh)
            return true;
    return keep_mesh(assets, mesh_share(mesh), 0, error);
}

struct image *assets_image(struct assets *assets, const char *path, struct error *error) {
    for (struct asset_image *entry = assets->images; entry; entry = entry->next) {
        if (strcmp(entry->path, path) == 0)
            return entry->image;
    }
    struct image *image = image_read(path, error);
    if (!image)
        return NULL;
    struct asset_image *entry = mem_alloc_zero(1, sizeof *entry);
    char *copy = copy_path(path);
    if (!entry || !copy) {
        mem_free(entry);
        mem_free(copy);
        image_release(image);
        error_no_memory(error, "the store of images");
        return NULL;
    }
    *entry = (struct asset_image){.image = image, .path = copy, .next = assets->images};
    assets->images = entry;
    assets->image_count++;
    return image;
}
