/* Effective materials: a node's texture (set_texture) and bump (set_bump) go over its material, a node without
 * material is plain gray. Each distinct set gets one number, in order of first use, and one index for each layout of
 * shapes on which its images have another mapping (material/material_mapping.h). The table that finds sets again is
 * hashed by address, which decides the position of an entry and never its number. */
#include "base/random.h"
#include "material/material_inputs.h"
#include "material/material_mapping.h"
#include "world/flatten_material_internal.h"

#include <stdio.h>
#include <string.h>

struct material_entry {
    const void *material; /* a material, or the list of those of the slots */
    const struct texture_image *texture;
    const struct bump *bump;
    enum shape_kind shape; /* a texture is mapped by the kind of its shape */
    uint32_t number;
    uint32_t after[SURFACE_LAYOUTS]; /* its index + 1; 0: not known yet */
    bool used;
};

struct material_table {
    struct material_entry *entries; /* capacity a power of two, at most half full */
    uint32_t capacity, count;
    const struct material **list;
    uint32_t *numbers; /* of the list */
    uint32_t list_capacity, list_count, number_count;
    struct material_mapping mapping;
};

static const struct material plain_gray = {
    .kind = MATERIAL_PHONG,
    .depth = 1,
    .name = "plain gray",
    .phong = {.kd = {0.5, 0.5, 0.5}, .ks = {0, 0, 0}, .shininess = 1, .ior = 1},
};

/* In the light of the studio. */
static const struct material light_gray = {
    .kind = MATERIAL_PHONG,
    .depth = 1,
    .name = "light gray",
    .phong = {.kd = {STUDIO_GRAY, STUDIO_GRAY, STUDIO_GRAY}, .ks = {0, 0, 0}, .shininess = 1, .ior = 1},
};

/* Where shapes without a material are meant to have none. */
static bool is_plain_meant(const struct flattening *f) {
    return f->scene->studio || f->scene->is_model;
}

/* Of a shape without a material. */
static const struct material *plain_of(const struct flattening *f) {
    return is_plain_meant(f) ? &light_gray : &plain_gray;
}

static bool same(const struct material_entry *a, const struct material_entry *b) {
    return a->material == b->material && a->texture == b->texture && a->bump == b->bump &&
           ((!a->texture && !a->bump) || a->shape == b->shape);
}

/* The slot of the entry, existing or free. */
static struct material_entry *find(struct material_table *table, const struct material_entry *wanted) {
    uint64_t key = random_combine((uint64_t)(uintptr_t)wanted->material, (uint64_t)(uintptr_t)wanted->texture);
    key = random_combine(key, (uint64_t)(uintptr_t)wanted->bump);
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
    *table = old;
    table->entries = entries;
    table->capacity = capacity;
    table->mapping.arena = f->arena;
    for (uint32_t i = 0; i < old.capacity; i++) {
        const struct material_entry *entry = &old.entries[i];
        if (entry->used)
            *find(table, entry) = *entry;
    }
    f->materials = table;
    return true;
}

void flatten_warn_once(struct flattening *f, const struct node *node, const char *what) {
    if (!f->warn || !scene_warns(f->scene, node))
        return;
    char text[512], line[160] = "";
    if (node->line > 0)
        (void)snprintf(line, sizeof line, " (made at %.120s:%u)", node->file, (unsigned)node->line);
    (void)snprintf(text, sizeof text, "warning: node '%.100s' %s%s", node->name, what, line);
    f->warn(f->warn_context, text);
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
static const struct material *covered(struct flattening *f, const struct texture_image *image,
                                      const struct material *base) {
    if (!image)
        return base;
    struct material *material = derived(f, MATERIAL_IMAGE, base);
    struct texture_image mapped = *image;
    mapped.mapping = MAPPING_UV;
    return material && material_cover(material, INPUT_KD, &mapped, f->arena, f->error) &&
                   material_cut_by_alpha(material, &mapped, f->arena, f->error)
               ? material
               : NULL;
}

/* Likewise its bump or normal map. */
static const struct material *raised(struct flattening *f, const struct bump *bump, const struct material *base) {
    if (!bump || !base)
        return base;
    struct material *material = derived(f, bump->kind, base);
    struct bump mapped = *bump;
    if (texture_as_image(bump->texture)) {
        struct texture own = *bump->texture;
        own.operation.image.mapping = MAPPING_UV;
        mapped.texture = texture_keep(f->arena, own, f->error);
    }
    return material && mapped.texture && material_add_bump(material, &mapped, f->arena, f->error) ? material : NULL;
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
    uint32_t *numbers = arena_alloc_array(f->arena, capacity, sizeof *numbers);
    if (!list || !numbers)
        return error_no_memory(f->error, "the materials of the scene");
    for (uint32_t i = 0; i < table->list_count; i++) {
        list[i] = table->list[i];
        numbers[i] = table->numbers[i];
    }
    table->list = list;
    table->numbers = numbers;
    table->list_capacity = (uint32_t)capacity;
    return true;
}

/* Appends the set of an entry for shapes of one layout to the list, which has room. *alike: every image has the
 * requested mapping. */
static bool add_set(struct flattening *f, const struct material_entry *entry, const struct material *const *bases,
                    uint32_t count, enum surface_layout layout, bool *alike) {
    struct material_table *table = f->materials;
    *alike = true;
    for (uint32_t i = 0; i < count; i++) {
        const struct material *base = bases[i] ? bases[i] : plain_of(f);
        const struct material *set = raised(f, entry->bump, covered(f, entry->texture, base));
        const struct material *on = set ? material_on_layout(&table->mapping, set, layout, f->error) : NULL;
        if (!on)
            return false;
        *alike = *alike && on == set;
        table->list[table->list_count + i] = on;
        table->numbers[table->list_count + i] = entry->number + i;
    }
    return true;
}

/* The index of an entry's first material on shapes of a layout. */
static bool find_index(struct flattening *f, struct material_entry *entry, const struct material *const *bases,
                       uint32_t count, enum surface_layout layout, uint32_t *out) {
    struct material_table *table = f->materials;
    bool alike = true;
    if (entry->after[layout] == 0) {
        if (!grow_list(f, count) || !add_set(f, entry, bases, count, layout, &alike))
            return false;
        uint32_t *as_asked = &entry->after[LAYOUT_UV];
        if (!alike || *as_asked == 0) {
            entry->after[layout] = table->list_count + 1;
            table->list_count += count;
        }
        if (alike && *as_asked == 0)
            *as_asked = entry->after[layout];
        entry->after[layout] = alike ? *as_asked : entry->after[layout];
    }
    *out = entry->after[layout] - 1;
    return true;
}

bool flatten_material(struct flattening *f, const struct node *node, const struct material *inherited, uint32_t *out,
                      uint32_t *count) {
    bool by_slot = !node->material && node->slot_count > 0;
    const struct material *only = node->material ? node->material : inherited;
    const struct material *const *bases = by_slot ? node->slots : &only;
    *count = by_slot ? node->slot_count : 1;
    const struct texture_image *texture = node->texture;
    const struct bump *bump = node->bump;
    for (uint32_t i = 0; i < *count; i++) {
        if (!bases[i] && !is_plain_meant(f))
            flatten_warn_once(f, node,
                              by_slot ? "has faces without a material, which are shown in plain gray"
                                      : "has no material and is shown in plain gray");
        if (bases[i] && bases[i]->depth + (texture != NULL) + (bump != NULL) > MATERIAL_DEPTH)
            return error_set(f->error, ERROR_SCENE, "node '%.100s': more than %d materials are nested", node->name,
                             MATERIAL_DEPTH);
    }
    if ((texture || bump) && node->shape.kind == SHAPE_MESH && !mesh_has_uv(node->shape.mesh)) {
        flatten_warn_once(f, node,
                          texture
                              ? "has a texture, but its mesh has no texture coordinates (vt): the texture is not shown"
                              : "has a bump map, but its mesh has no texture coordinates (vt): it is not shown");
        texture = NULL;
        bump = NULL;
    }
    if ((!f->materials || f->materials->count * 2 >= f->materials->capacity) && !grow(f))
        return false;
    /* The same set of material, texture and bump has one number. */
    const void *key = by_slot ? (const void *)node->slots : only ? (const void *)only : plain_of(f);
    struct material_entry wanted = {
        .material = key, .texture = texture, .bump = bump, .shape = node->shape.kind, .used = true};
    struct material_entry *entry = find(f->materials, &wanted);
    if (!entry->used) {
        wanted.number = f->materials->number_count;
        *entry = wanted;
        f->materials->count++;
        f->materials->number_count += *count;
    }
    if (!find_index(f, entry, bases, *count, shape_layout(&node->shape), out))
        return false;
    f->world->authored.materials = f->materials->list;
    f->world->material_numbers = f->materials->numbers;
    f->world->material_count = f->materials->list_count;
    f->world->material_number_count = f->materials->number_count;
    return true;
}

/* --- textures --- */

/* For each function a place for reports of the workers. */
static bool add_reports(struct arena *arena, const struct texture_tables *tables) {
    for (uint32_t i = 0; i < tables->count; i++) {
        struct texture_operation *operation = &tables->operations[i];
        if (operation->kind != TEXTURE_FUNCTION)
            continue;
        operation->recorded.nan = arena_alloc(arena, sizeof *operation->recorded.nan);
        if (!operation->recorded.nan)
            return false;
        atomic_flag_clear(&operation->recorded.nan->lock);
    }
    return true;
}

/* --- linear colours --- */

/* Of the first texture that reads the image. */
static void warn_of_colours(const struct flattening *f, const struct texture_operation *table, uint32_t index) {
    const struct image *image = table[index].image.image;
    char text[1024];
    if (!f->warn || !image_colours(image))
        return;
    for (uint32_t i = 0; i < index; i++)
        if (table[i].kind == TEXTURE_IMAGE && strcmp(image_name(table[i].image.image), image_name(image)) == 0)
            return;
    (void)snprintf(
        text, sizeof text,
        "warning: %s has %s; gray decodes it as sRGB; encoding of gr.texture selects another transfer function",
        image_name(image), image_colours(image));
    f->warn(f->warn_context, text);
}

/* Images that a colour is read of become linear, those that say what they are, and colours of the screen. */
static bool decode_colours(const struct flattening *f, const struct texture_tables *tables) {
    for (uint32_t i = 0; i < tables->count; i++) {
        struct texture_operation *operation = &tables->operations[i];
        struct texture_image *lookup = &operation->image;
        bool is_colour = tables->are_colours[i];
        if (operation->kind == TEXTURE_CONSTANT && operation->constant.display)
            *operation = texture_constant(transfer_decode_colour((struct transfer_function){TRANSFER_SRGB, 0},
                                                                 operation->constant.colour))
                             .operation;
        if (operation->kind != TEXTURE_IMAGE)
            continue;
        struct transfer_function transfer = texture_image_transfer(lookup, is_colour);
        if (is_colour && lookup->encoding == ENCODING_AUTO && !(lookup->gamma > 0))
            warn_of_colours(f, tables->operations, i);
        lookup->image = image_decode(lookup->image, transfer, f->error);
        if (!lookup->image)
            return false;
    }
    return true;
}

/* Classic colours whose output is encoded: pictures become lighter than they are. */
static void warn_of_encoding(const struct flattening *f, const struct texture_tables *tables) {
    for (uint32_t i = 0; i < tables->count; i++) {
        const struct texture_operation *operation = &tables->operations[i];
        if (!tables->are_colours[i] || operation->kind != TEXTURE_IMAGE || image_bits(operation->image.image) != 8)
            continue;
        f->warn(f->warn_context, "note: --srgb encodes pictures that were not decoded: a texture value of 128 becomes "
                                 "188; --colour linear decodes them");
        return;
    }
}

bool flatten_surfaces(struct flattening *f) {
    struct world *world = f->world;
    const struct texture_tables *textures = &world->surfaces.textures;
    bool ok = surface_tables_build(&world->surfaces, world->authored.materials, world->material_count, world->classic,
                                   f->arena, &world->authored.textures) &&
              add_reports(f->arena, textures);
    if (ok && f->linear_colours)
        ok = decode_colours(f, textures);
    else if (ok && f->encodes && f->warn)
        warn_of_encoding(f, textures);
    return ok || error_no_memory(f->error, "the materials of the scene");
}
