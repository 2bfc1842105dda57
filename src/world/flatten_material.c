/* Effective materials: a node's texture (set_texture) and relief (set_bump) go over its material, a node without
 * material is plain gray. Each distinct set gets one index, in order of first use; the table that finds pairs again is
 * hashed by address, which decides where an entry stands and never which index it gets. */
#include "world/flatten.h"

#include "base/random.h"
#include "material/material_inputs.h"

#include <stdio.h>

struct material_entry {
    const void *material; /* a material, or the list of those of the slots */
    const struct texture_image *texture;
    const struct relief *relief;
    enum shape_kind shape; /* a texture is mapped by the kind of its shape */
    uint32_t index;
    bool used;
};

struct material_table {
    struct material_entry *entries; /* capacity a power of two, at most half full */
    uint32_t capacity, count;
    const struct material **list;
    uint32_t list_capacity, list_count;
};

static const struct material plain_gray = {
    .kind = MATERIAL_PHONG,
    .depth = 1,
    .name = "plain gray",
    .phong = {.kd = {0.5, 0.5, 0.5}, .ks = {0, 0, 0}, .shininess = 1, .ior = 1},
};

static bool same(const struct material_entry *a, const struct material_entry *b) {
    return a->material == b->material && a->texture == b->texture && a->relief == b->relief &&
           ((!a->texture && !a->relief) || a->shape == b->shape);
}

/* Where the entry is, or would be. */
static struct material_entry *find(struct material_table *table, const struct material_entry *wanted) {
    uint64_t key = random_combine((uint64_t)(uintptr_t)wanted->material, (uint64_t)(uintptr_t)wanted->texture);
    key = random_combine(key, (uint64_t)(uintptr_t)wanted->relief);
    for (uint32_t at = (uint32_t)key;; at++) {
        struct material_entry *entry = &table->entries[at & (table->capacity - 1)];
        if (!entry->used || same(entry, wanted))
            return entry;
    }
}

static bool grow(struct flattening *f) {
    struct material_table old = f->materials ? *f->materials : (struct material_table){0};
    struct material_table *table = f->materials;
    if (!table)
        table = arena_alloc(f->arena, sizeof *table);
    uint32_t capacity = old.capacity ? old.capacity * 2 : 64;
    struct material_entry *entries = arena_alloc_array(f->arena, capacity, sizeof *entries);
    if (!table || !entries)
        return error_no_memory(f->error, "the materials of the scene");
    *table = (struct material_table){.entries = entries,
                                     .capacity = capacity,
                                     .count = old.count,
                                     .list = old.list,
                                     .list_capacity = old.list_capacity,
                                     .list_count = old.list_count};
    for (uint32_t i = 0; i < old.capacity; i++) {
        const struct material_entry *entry = &old.entries[i];
        if (entry->used)
            *find(table, entry) = *entry;
    }
    f->materials = table;
    return true;
}

static void warn_once(struct flattening *f, const struct node *node, const char *what) {
    if (!f->warn || !scene_warns(f->scene, node))
        return;
    char text[512];
    (void)snprintf(text, sizeof text, "warning: node '%.100s' %s", node->name, what);
    f->warn(f->warn_context, text);
}

/* The mapping of an image that a node gives to its shape (docs/language.md 6.2). */
static enum texture_mapping mapping_of(enum surface_layout layout) {
    switch (layout) {
    case LAYOUT_SPHERE:
        return MAPPING_SPHERE_CLASSIC;
    case LAYOUT_FACES:
        return MAPPING_CUBE;
    case LAYOUT_UV:
        break;
    }
    return MAPPING_UV;
}

static struct material *derived(struct flattening *f, enum material_kind kind, const struct material *base) {
    struct material *material = arena_alloc(f->arena, sizeof *material);
    if (!material) {
        error_no_memory(f->error, "the materials of the scene");
        return NULL;
    }
    material_derive(material, kind, base);
    return material;
}

/* The node's image over the base; the base itself without an image, NULL without memory. */
static const struct material *covered(struct flattening *f, const struct node *node, const struct texture_image *image,
                                      const struct material *base) {
    if (!image)
        return base;
    struct material *material = derived(f, MATERIAL_IMAGE, base);
    struct texture_image mapped = *image;
    mapped.mapping = mapping_of(shape_layout(&node->shape));
    return material && material_cover(material, INPUT_KD, &mapped, f->arena, f->error) ? material : NULL;
}

/* Likewise its bump or normal map. */
static const struct material *raised(struct flattening *f, const struct node *node, const struct relief *relief,
                                     const struct material *base) {
    if (!relief || !base)
        return base;
    struct material *material = derived(f, relief->kind, base);
    struct relief mapped = *relief;
    mapped.image.mapping = mapping_of(shape_layout(&node->shape));
    return material && material_raise(material, &mapped, f->arena, f->error) ? material : NULL;
}

/* Room for `count` more at the end of the list. */
static bool grow_list(struct flattening *f, uint32_t count) {
    struct material_table *table = f->materials;
    if (table->list_capacity - table->list_count >= count)
        return true;
    size_t capacity = ((size_t)table->list_count + count) * 2;
    if (capacity > UINT32_MAX)
        return error_set(f->error, ERROR_SCENE, "the scene has more than 2^31 materials");
    const struct material **list = arena_alloc_array(f->arena, capacity, sizeof *list);
    if (!list)
        return error_no_memory(f->error, "the materials of the scene");
    for (uint32_t i = 0; i < table->list_count; i++)
        list[i] = table->list[i];
    table->list = list;
    table->list_capacity = (uint32_t)capacity;
    return true;
}

bool flatten_material(struct flattening *f, const struct node *node, const struct material *inherited, uint32_t *out,
                      uint32_t *count) {
    bool by_slot = !node->material && node->slot_count > 0;
    const struct material *only = node->material ? node->material : inherited;
    const struct material *const *bases = by_slot ? node->slots : &only;
    *count = by_slot ? node->slot_count : 1;
    const struct texture_image *texture = node->texture;
    const struct relief *relief = node->relief;
    for (uint32_t i = 0; i < *count; i++) {
        if (!bases[i])
            warn_once(f, node,
                      by_slot ? "has faces without a material, which are shown in plain gray"
                              : "has no material and is shown in plain gray");
        if (bases[i] && bases[i]->depth + (texture != NULL) + (relief != NULL) > MATERIAL_DEPTH)
            return error_set(f->error, ERROR_SCENE, "node '%.100s': more than %d materials are stacked on each other",
                             node->name, MATERIAL_DEPTH);
    }
    if ((texture || relief) && node->shape.kind == SHAPE_MESH && !mesh_has_uv(node->shape.mesh)) {
        warn_once(f, node,
                  texture ? "has a texture, but its mesh has no texture coordinates (vt): the texture is not shown"
                          : "has a bump map, but its mesh has no texture coordinates (vt): it is not shown");
        texture = NULL;
        relief = NULL;
    }
    if ((!f->materials || f->materials->count * 2 >= f->materials->capacity) && !grow(f))
        return false;
    const void *key = by_slot ? (const void *)node->slots : only ? (const void *)only : &plain_gray;
    struct material_entry wanted = {key, texture, relief, node->shape.kind, 0, true};
    struct material_entry *entry = find(f->materials, &wanted);
    if (!entry->used) {
        if (!grow_list(f, *count))
            return false;
        struct material_table *table = f->materials;
        *entry = wanted;
        entry->index = table->list_count;
        table->count++;
        for (uint32_t i = 0; i < *count; i++) {
            const struct material *base = bases[i] ? bases[i] : &plain_gray;
            const struct material *effective = raised(f, node, relief, covered(f, node, texture, base));
            if (!effective)
                return false;
            table->list[table->list_count++] = effective;
        }
    }
    f->world->authored.materials = f->materials->list;
    f->world->material_count = f->materials->list_count;
    *out = entry->index;
    return true;
}
