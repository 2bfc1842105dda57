/* Effective materials: a node's texture (set_texture) and bump (set_bump) go over its material, a node without
 * material is plain gray. Each distinct set gets one number, in order of first use, and one index for each layout of
 * shapes on which its images have another mapping (material/material_mapping.h). The table that finds sets again is
 * hashed by address, which decides the position of an entry and never its number. */
#include "base/mem.h"

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
    .phong = {.kd = {0.85, 0.85, 0.85}, .ks = {0, 0, 0}, .shininess = 1, .ior = 1},
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
    if (texture_as_image(bump->texture.authored)) {
        struct texture own = *bump->texture.authored;
        own.image.lookup.mapping = MAPPING_UV;
        mapped.texture.authored = texture_keep(f->arena, own, f->error);
    }
    return material && mapped.texture.authored && material_add_bump(material, &mapped, f->arena, f->error) ? material
                                                                                                           : NULL;
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

/* Tables of textures and bumps. Authored materials refer to textures by pointers;
 * here each distinct texture and each distinct bump gets an index, in order of first use, parts before their readers,
 * and the world's materials refer to them by it. The numbering that finds them again is hashed by address, which
 * decides the position of an entry and never its index. */

struct numbered {
    const void *authored; /* NULL: free */
    uint32_t index;
};

/* Indices of authored textures and bumps. */
struct numbering {
    struct numbered *entries; /* capacity a power of two, at most half full */
    uint32_t capacity, count;
};

static struct numbered *find_number(const struct numbering *numbering, const void *authored) {
    for (uint32_t at = (uint32_t)random_combine((uint64_t)(uintptr_t)authored, 0);; at++) {
        struct numbered *entry = &numbering->entries[at & (numbering->capacity - 1)];
        if (!entry->authored || entry->authored == authored)
            return entry;
    }
}

static bool is_numbered(const struct numbering *numbering, const void *authored) {
    return numbering->capacity > 0 && find_number(numbering, authored)->authored;
}

/* The next index. False: no memory. */
static bool number(struct numbering *numbering, const void *authored) {
    if (numbering->count * 2 >= numbering->capacity) {
        struct numbering old = *numbering;
        numbering->capacity = old.capacity ? old.capacity * 2 : 64;
        numbering->entries = mem_alloc_zero(numbering->capacity, sizeof *numbering->entries);
        if (!numbering->entries) {
            *numbering = old;
            return false;
        }
        for (uint32_t i = 0; i < old.capacity; i++)
            if (old.entries[i].authored)
                *find_number(numbering, old.entries[i].authored) = old.entries[i];
        mem_free(old.entries);
    }
    *find_number(numbering, authored) = (struct numbered){authored, numbering->count++};
    return true;
}

/* The texture, after all below it. */
static bool number_texture(struct numbering *textures, const struct texture *texture) {
    if (!texture || is_numbered(textures, texture))
        return true;
    struct texture own = *texture;
    union texture_ref *parts[TEXTURE_PARTS];
    int count = texture_parts(&own, parts);
    for (int i = 0; i < count; i++)
        if (!number_texture(textures, parts[i]->authored))
            return false;
    return number(textures, texture);
}

static bool number_bump(struct numbering *bumps, struct numbering *textures, const struct bump *bump) {
    if (!bump || is_numbered(bumps, bump))
        return true;
    return number_bump(bumps, textures, bump->below.authored) && number_texture(textures, bump->texture.authored) &&
           number(bumps, bump);
}

static union texture_ref texture_index(const struct numbering *textures, union texture_ref ref) {
    return (union texture_ref){.index = ref.authored ? find_number(textures, ref.authored)->index : TEXTURE_NONE};
}

static union bump_ref bump_index(const struct numbering *bumps, union bump_ref ref) {
    return (union bump_ref){.index = ref.authored ? find_number(bumps, ref.authored)->index : BUMP_NONE};
}

static void fill_textures(const struct numbering *textures, struct texture *out) {
    for (uint32_t i = 0; i < textures->capacity; i++) {
        if (!textures->entries[i].authored)
            continue;
        struct texture *texture = &out[textures->entries[i].index];
        union texture_ref *parts[TEXTURE_PARTS];
        *texture = *(const struct texture *)textures->entries[i].authored;
        for (int k = texture_parts(texture, parts); k-- > 0;)
            *parts[k] = texture_index(textures, *parts[k]);
    }
}

static void fill_bumps(const struct numbering *bumps, const struct numbering *textures, struct bump *out) {
    for (uint32_t i = 0; i < bumps->capacity; i++) {
        if (!bumps->entries[i].authored)
            continue;
        struct bump *bump = &out[bumps->entries[i].index];
        *bump = *(const struct bump *)bumps->entries[i].authored;
        bump->below = bump_index(bumps, bump->below);
        bump->texture = texture_index(textures, bump->texture);
    }
}

/* For each function a place for reports of the workers. */
static bool add_reports(struct arena *arena, struct texture *table, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        if (table[i].kind != TEXTURE_FUNCTION)
            continue;
        table[i].recorded.nan = arena_alloc(arena, sizeof *table[i].recorded.nan);
        if (!table[i].recorded.nan)
            return false;
        atomic_flag_clear(&table[i].recorded.nan->lock);
    }
    return true;
}

static bool number_all(const struct world *world, struct numbering *textures, struct numbering *bumps) {
    for (uint32_t i = 0; i < world->material_count; i++) {
        const struct material *material = &world->materials[i];
        for (int k = 0; k < INPUT_COUNT; k++)
            if (!number_texture(textures, material->inputs[k].authored))
                return false;
        if (!number_bump(bumps, textures, material->bump.authored))
            return false;
    }
    return true;
}

static void refer(struct world *world, const struct numbering *textures, const struct numbering *bumps) {
    for (uint32_t i = 0; i < world->material_count; i++) {
        struct material *material = &world->materials[i];
        material->plain = !material->bump.authored;
        for (int k = 0; k < INPUT_COUNT; k++) {
            material->plain = material->plain && !material->inputs[k].authored;
            material->inputs[k] = texture_index(textures, material->inputs[k]);
        }
        material->bump = bump_index(bumps, material->bump);
        material->textures = world->textures;
        material->bumps = world->bumps;
    }
}

/* --- linear colours --- */

/* Whether an input is a colour; the numbers of others mean themselves. */
#define INPUT_IS_COLOUR(input, word, is_colour) [input] = (is_colour),
static const bool is_colour[] = {MATERIAL_INPUTS(INPUT_IS_COLOUR)};

/* A texture that is read as a colour, and its parts that are. */
static void mark_colours(const struct texture *table, union texture_ref ref, bool *is_read) {
    if (ref.index == TEXTURE_NONE || is_read[ref.index])
        return;
    struct texture own = table[ref.index];
    union texture_ref *parts[TEXTURE_PARTS];
    (void)texture_parts(&own, parts);
    is_read[ref.index] = true;
    for (int i = 0; i < texture_colour_parts(&own); i++)
        mark_colours(table, *parts[i], is_read);
}

/* How an image becomes light; colour: it is read as one. */
static struct transfer_function image_transfer_in(const struct texture_image *lookup, bool colour) {
    if (lookup->gamma > 0)
        return (struct transfer_function){TRANSFER_POWER, lookup->gamma};
    switch (lookup->encoding) {
    case ENCODING_AUTO:
        break;
    case ENCODING_SRGB:
        return (struct transfer_function){TRANSFER_SRGB, 0};
    case ENCODING_LINEAR:
        return (struct transfer_function){TRANSFER_POWER, 1};
    }
    return colour ? image_colour_transfer(lookup->image) : (struct transfer_function){TRANSFER_UNSTATED, 0};
}

/* Of the first texture that reads the image. */
static void warn_of_colours(const struct flattening *f, const struct texture *table, uint32_t index) {
    const struct image *image = table[index].image.lookup.image;
    char text[1024];
    if (!f->warn || !image_colours(image))
        return;
    for (uint32_t i = 0; i < index; i++)
        if (table[i].kind == TEXTURE_IMAGE && strcmp(image_name(table[i].image.lookup.image), image_name(image)) == 0)
            return;
    (void)snprintf(
        text, sizeof text,
        "warning: %s has %s; gray decodes it as sRGB; encoding of gr.texture selects another transfer function",
        image_name(image), image_colours(image));
    f->warn(f->warn_context, text);
}

/* Which textures of the table are read as colours; NULL: no memory. */
static bool *find_colours(const struct world *world, const struct texture *table) {
    bool *is_read = mem_alloc_zero((size_t)world->texture_count + 1, sizeof *is_read);
    for (uint32_t i = 0; is_read && i < world->material_count; i++)
        for (int k = 0; k < INPUT_COUNT; k++)
            if (is_colour[k])
                mark_colours(table, world->materials[i].inputs[k], is_read);
    return is_read;
}

/* Images that a colour is read of become linear, those that say what they are, and colours of the screen. */
static bool decode_colours(const struct flattening *f, struct texture *table) {
    bool *is_read = find_colours(f->world, table), ok = is_read != NULL;
    for (uint32_t i = 0; ok && i < f->world->texture_count; i++) {
        struct texture_image *lookup = &table[i].image.lookup;
        if (table[i].kind == TEXTURE_CONSTANT && table[i].constant.display)
            table[i] = texture_constant(
                transfer_decode_colour((struct transfer_function){TRANSFER_SRGB, 0}, table[i].constant.colour));
        if (table[i].kind != TEXTURE_IMAGE)
            continue;
        struct transfer_function transfer = image_transfer_in(lookup, is_read[i]);
        if (is_read[i] && lookup->encoding == ENCODING_AUTO && !(lookup->gamma > 0))
            warn_of_colours(f, table, i);
        lookup->image = image_decode(lookup->image, transfer, f->error);
        ok = lookup->image != NULL;
    }
    mem_free(is_read);
    return ok;
}

/* Classic colours whose output is encoded: pictures become lighter than they are. */
static bool warn_of_encoding(const struct flattening *f, const struct texture *table) {
    bool *is_read = find_colours(f->world, table), found = false;
    for (uint32_t i = 0; is_read && i < f->world->texture_count; i++)
        found = found || (is_read[i] && table[i].kind == TEXTURE_IMAGE && image_bits(table[i].image.lookup.image) == 8);
    if (found)
        f->warn(f->warn_context, "note: --srgb encodes pictures that were not decoded: a texture value of 128 becomes "
                                 "188; --colour linear decodes them");
    mem_free(is_read);
    return is_read != NULL;
}

bool flatten_textures(struct flattening *f) {
    struct world *world = f->world;
    struct arena *arena = f->arena;
    struct numbering textures = {.count = 0}, bumps = {.count = 0};
    bool ok = number_all(world, &textures, &bumps);
    struct texture *texture_table =
        ok ? arena_alloc_array(arena, (size_t)textures.count + 1, sizeof *texture_table) : NULL;
    struct bump *bump_table = ok ? arena_alloc_array(arena, (size_t)bumps.count + 1, sizeof *bump_table) : NULL;
    ok = texture_table && bump_table;
    if (ok) {
        /* References become indices when every texture has one. */
        fill_textures(&textures, texture_table);
        fill_bumps(&bumps, &textures, bump_table);
        world->textures = texture_table;
        world->bumps = bump_table;
        world->texture_count = textures.count;
        world->bump_count = bumps.count;
        refer(world, &textures, &bumps);
        ok = add_reports(arena, texture_table, textures.count);
        if (ok && f->linear_colours)
            ok = decode_colours(f, texture_table);
        else if (ok && f->encodes && f->warn)
            ok = warn_of_encoding(f, texture_table);
    }
    mem_free(textures.entries);
    mem_free(bumps.entries);
    return ok || error_no_memory(f->error, "the textures of the scene");
}
