/* Copies of trees of textures, of bumps and of chains of materials, wherever an image below has another mapping. Trees
 * share parts, and chains share most of their trees: results are cached by address, so the work is that of the distinct
 * parts. Addresses only decide the position of an entry. */
#include "material/material_mapping.h"

#include "base/random.h"
#include "material/texture_mapping_internal.h"

struct material_mapping_entry {
    const void *of; /* a texture, a relief or a material; NULL: free */
    enum surface_layout layout;
    const void *on; /* its replacement; may be the same */
};

static struct material_mapping_entry *find(const struct material_mapping *mapping, const void *of,
                                           enum surface_layout layout) {
    for (uint32_t at = (uint32_t)random_combine((uint64_t)(uintptr_t)of, (uint64_t)layout);; at++) {
        struct material_mapping_entry *entry = &mapping->entries[at & (mapping->capacity - 1)];
        if (!entry->of || (entry->of == of && entry->layout == layout))
            return entry;
    }
}

static const void *known(const struct material_mapping *mapping, const void *of, enum surface_layout layout) {
    return mapping->capacity > 0 ? find(mapping, of, layout)->on : NULL;
}

static bool grow(struct material_mapping *mapping) {
    struct material_mapping old = *mapping;
    uint32_t capacity = old.capacity ? old.capacity * 2 : 64;
    struct material_mapping_entry *entries = arena_alloc_array(mapping->arena, capacity, sizeof *entries);
    if (!entries)
        return false;
    mapping->entries = entries;
    mapping->capacity = capacity;
    for (uint32_t i = 0; i < old.capacity; i++)
        if (old.entries[i].of)
            *find(mapping, old.entries[i].of, old.entries[i].layout) = old.entries[i];
    return true;
}

/* `on`, which is now in the cache; NULL: no memory. */
static const void *remember(struct material_mapping *mapping, const void *of, enum surface_layout layout,
                            const void *on) {
    if (!on || (mapping->count * 2 >= mapping->capacity && !grow(mapping)))
        return NULL;
    *find(mapping, of, layout) = (struct material_mapping_entry){of, layout, on};
    mapping->count++;
    return on;
}

static const struct texture *texture_on(struct material_mapping *mapping, const struct texture *texture,
                                        enum surface_layout layout) {
    const struct texture *on = known(mapping, texture, layout);
    if (on || !texture->has_image)
        return on ? on : texture;
    struct texture own = *texture, *kept = NULL;
    bool changed = false;
    /* Its own mapping, then those of its parts. A texture that stays as it is needs no copy. */
    if (own.operation.kind == TEXTURE_IMAGE) {
        own.operation.image.mapping = texture_mapping_on(own.operation.image.mapping, layout);
        changed = own.operation.image.mapping != texture->operation.image.mapping;
    }
    if (own.operation.kind == TEXTURE_FUNCTION) {
        own.operation.recorded.mapping = texture_mapping_on(own.operation.recorded.mapping, layout);
        changed = own.operation.recorded.mapping != texture->operation.recorded.mapping;
    }
    for (int i = 0; i < TEXTURE_PARTS; i++) {
        if (!own.parts[i])
            continue;
        own.parts[i] = texture_on(mapping, texture->parts[i], layout);
        if (!own.parts[i])
            return NULL;
        changed = changed || own.parts[i] != texture->parts[i];
    }
    if (changed && !(kept = arena_alloc(mapping->arena, sizeof *kept)))
        return NULL;
    if (kept)
        *kept = own;
    return remember(mapping, texture, layout, kept ? kept : texture);
}

/* Normals count along the coordinates of the shape, so theirs change on every layout. */
static const struct bump *bump_has_mapping(struct material_mapping *mapping, const struct bump *bump,
                                           enum surface_layout layout) {
    const struct bump *on = known(mapping, bump, layout);
    if (on)
        return on;
    struct bump *own = arena_alloc(mapping->arena, sizeof *own);
    if (!own)
        return NULL;
    *own = *bump;
    own->from_above = layout != LAYOUT_UV;
    own->texture = texture_on(mapping, bump->texture, layout);
    if (bump->below)
        own->below = bump_has_mapping(mapping, bump->below, layout);
    bool whole = own->texture && (own->below || !bump->below);
    return remember(mapping, bump, layout, whole ? own : NULL);
}

static const struct material *material_on(struct material_mapping *mapping, const struct material *material,
                                          enum surface_layout layout) {
    const struct material *on = known(mapping, material, layout);
    if (on)
        return on;
    struct material own = *material, *kept = NULL;
    bool changed = false;
    /* The base, the textures and the bump; a material that stays as it is needs no copy. */
    if (material->base) {
        own.base = material_on(mapping, material->base, layout);
        changed = own.base != material->base;
        if (!own.base)
            return NULL;
    }
    for (int i = 0; i < INPUT_COUNT; i++) {
        const struct texture *texture = material->inputs[i];
        own.inputs[i] = texture ? texture_on(mapping, texture, layout) : NULL;
        changed = changed || own.inputs[i] != texture;
        if (texture && !own.inputs[i])
            return NULL;
    }
    if (material->bump) {
        own.bump = bump_has_mapping(mapping, material->bump, layout);
        changed = true;
        if (!own.bump)
            return NULL;
    }
    own.origin = material_origin(material);
    if (changed && !(kept = arena_alloc(mapping->arena, sizeof *kept)))
        return NULL;
    if (kept)
        *kept = own;
    return remember(mapping, material, layout, kept ? kept : material);
}

const struct material *material_on_layout(struct material_mapping *mapping, const struct material *material,
                                          enum surface_layout layout, struct error *error) {
    if (layout == LAYOUT_UV || !material_has_image(material)) /* where MAPPING_BY_SHAPE is MAPPING_UV */
        return material;
    const struct material *on = material_on(mapping, material, layout);
    if (!on)
        error_no_memory(error, "the materials of the scene");
    return on;
}
