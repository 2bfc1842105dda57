/* The store of assets: equal assets are stored once, however often scripts request them. Keys are content (tables) or
 * canonical path (files). Scenes make meshes by the hundred thousand, so a hash table finds them; files are few, and a
 * look-up in their lists costs far less than reading one. */
#include "scene/assets.h"
#include "base/file.h"
#include "base/hash.h"
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
    mem_free(assets->mesh_slots);
    while (assets->images) {
        struct asset_image *next = assets->images->next;
        image_release(assets->images->image);
        mem_free(assets->images->path);
        mem_free(assets->images);
        assets->images = next;
    }
    *assets = (struct assets){.epochs = assets->epochs};
}

enum { FIRST_MESH_SLOTS = 64 };

static struct asset_mesh **slot_of(const struct assets *assets, uint64_t key) {
    return &assets->mesh_slots[key & (assets->mesh_slot_count - 1)];
}

static struct asset_mesh *chain_of(const struct assets *assets, uint64_t key) {
    return assets->mesh_slot_count ? *slot_of(assets, key) : NULL;
}

static void chain(struct assets *assets, struct asset_mesh *entry) {
    struct asset_mesh **slot = slot_of(assets, entry->key);
    entry->chained = *slot;
    *slot = entry;
}

static void unchain(struct assets *assets, const struct asset_mesh *entry) {
    struct asset_mesh **link = slot_of(assets, entry->key);
    while (*link != entry)
        link = &(*link)->chained;
    *link = entry->chained;
}

/* Slots for one more mesh; a failure changes nothing. */
static bool grow_slots(struct assets *assets) {
    if (assets->mesh_count < assets->mesh_slot_count)
        return true;
    size_t count = assets->mesh_slot_count ? assets->mesh_slot_count * 2 : FIRST_MESH_SLOTS;
    struct asset_mesh **slots = mem_alloc_zero(count, sizeof(struct asset_mesh *));
    if (!slots)
        return false;
    mem_free(assets->mesh_slots);
    assets->mesh_slots = slots;
    assets->mesh_slot_count = count;
    for (struct asset_mesh *entry = assets->meshes; entry; entry = entry->next)
        chain(assets, entry);
    return true;
}

/* Takes over the mesh of `made`, also when it fails. */
static bool keep_mesh(struct assets *assets, const struct asset_mesh *made, struct error *error) {
    struct asset_mesh *entry = grow_slots(assets) ? mem_alloc_zero(1, sizeof *entry) : NULL;
    if (!entry) {
        mesh_release(made->mesh);
        return error_no_memory(error, "the store of meshes");
    }
    *entry = *made;
    entry->next = assets->meshes;
    assets->meshes = entry;
    chain(assets, entry);
    assets->mesh_count++;
    return true;
}

struct mesh *assets_mesh(struct assets *assets, const struct mesh_input *input, struct error *error) {
    uint64_t key = mesh_input_hash(input);
    for (struct asset_mesh *entry = chain_of(assets, key); entry; entry = entry->chained) {
        if (entry->key == key && !entry->of_file && mesh_equals_input(entry->mesh, input))
            return entry->mesh;
    }
    struct asset_mesh made = {.mesh = mesh_create(input, error), .key = key};
    return made.mesh && keep_mesh(assets, &made, error) ? made.mesh : NULL;
}

bool assets_keep_mesh(struct assets *assets, struct mesh *mesh, struct error *error) {
    uint64_t key = random_mix((uintptr_t)mesh);
    for (struct asset_mesh *entry = chain_of(assets, key); entry; entry = entry->chained)
        if (entry->mesh == mesh)
            return true;
    return keep_mesh(assets, &(struct asset_mesh){.mesh = mesh_share(mesh), .key = key, .of_file = true}, error);
}

void assets_drop_meshes(struct assets *assets, const struct asset_mesh *until) {
    struct asset_mesh **link = &assets->meshes;
    while (*link != until) {
        struct asset_mesh *entry = *link;
        if (entry->of_file) {
            link = &entry->next;
            continue;
        }
        *link = entry->next;
        unchain(assets, entry);
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

bool assets_has_image(const struct assets *assets, const char *path) {
    struct file_identity wanted, found;
    if (!file_identity_of(path, &wanted))
        return false;
    for (const struct asset_image *entry = assets->images; entry; entry = entry->next)
        if (file_identity_of(entry->path, &found) && found.device == wanted.device && found.inode == wanted.inode)
            return true;
    return false;
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
