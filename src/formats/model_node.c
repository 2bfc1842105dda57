/* Converts the materials of a file, which have more parameters than those of gray:
 *   Kd, Ks, Ns, map_Kd (multiplied by Kd, with its -s, -o, -clamp) as they are; illum 0 and 1 switch Ks off, 3 to 9 let
 * it mirror. d or Tr below 1: refract = 1 - d, filtered by Tf, with the index Ni where illum (6, 7, or none) asks for
 * refraction; illum 7 is a dielectric by Fresnel's equations. Ka is Kd here. Ke is emission. map_Ks and map_Ke are
 * multiplied by Ks and Ke (by 1 where those are black or missing), map_d cuts holes. map_bump has no unit in files: -bm
 * times a fiftieth of the picture's size on the surface; norm and glTF's normalTexture are normal maps.
 * Materials of glTF have the layers of OpenPBR (gltf_material.c). */
#include "formats/model_node.h"

#include "material/bump.h"
#include "material/material_inputs.h"

#include <stdio.h>
#include <string.h>

/* The highlight of transparent materials that have none. */
enum { CLEAR_SHININESS = 1000 };

static void destroy_model(void *object) {
    model_destroy(object);
    mem_free(object);
}

/* Meshes that the last reading of the file made at another time take no memory again. */
static void share_meshes(const struct assets *assets, const char *canonical, struct model *model) {
    const struct asset_object *entry = assets->objects;
    size_t length = strlen(canonical);
    while (entry && (entry->destroy != destroy_model || strncmp(entry->key, canonical, length) != 0 ||
                     entry->key[length] != '|'))
        entry = entry->next;
    const struct model *last = entry ? entry->object : NULL;
    for (size_t i = 0; last && i < model->meshes.count && i < last->meshes.count; i++) {
        struct model_mesh *mesh = &model_meshes(model)[i];
        struct mesh *other = model_meshes(last)[i].mesh;
        if (!mesh_equals(mesh->mesh, other))
            continue;
        mesh_release(mesh->mesh);
        mesh->mesh = mesh_share(other);
    }
}

struct model *model_asset(struct assets *assets, const char *path, const char *canonical,
                          const struct model_options *options, bool *fresh, struct error *error) {
    char key[4096 + 400];
    int length = snprintf(key, sizeof key, "%s|%d %.17g %d %.17g %d %d|%d %.17g %s|%s", canonical, options->smooth,
                          options->smooth_angle, options->weld, options->weld_distance, options->flip, options->forgive,
                          options->animated, options->time, options->animation ? options->animation : "",
                          options->variant ? options->variant : "");
    *fresh = false;
    if ((size_t)length >= sizeof key) {
        error_set(error, ERROR_SCENE, "%s: %s is too long", path,
                  strlen(canonical) > 4000 ? "its path" : "the name of an animation or a variant");
        return NULL;
    }
    /* The same file, read in the same way. */
    struct model *model = assets_find_object(assets, key);
    if (model)
        return model;
    model = mem_alloc_zero(1, sizeof *model);
    if (!model) {
        error_no_memory(error, path);
        return NULL;
    }
    if (!model_read(model, path, options, error)) {
        mem_free(model);
        return NULL;
    }
    if (options->animated)
        share_meshes(assets, canonical, model);
    for (size_t i = 0; i < model->meshes.count; i++)
        if (!assets_keep_mesh(assets, model_meshes(model)[i].mesh, error)) {
            destroy_model(model);
            return NULL;
        }
    *fresh = true;
    return assets_add_object(assets, key, model, destroy_model, error) ? model : NULL;
}

/* --- materials --- */

static bool is_usable(const struct model_texture *map) {
    return map->image || map->path;
}

/* A picture that cannot be read has no effect, as if it were missing; only a lack of memory is an error. */
static bool check_picture(struct scene *scene, struct model *model, struct model_texture *map, struct error *error) {
    struct error reason = {0};
    struct file_identity identity;
    if (!map->path)
        return true;
    bool known = file_identity_of(map->path, &identity);
    if (!known || !file_set_has(&model->broken, identity)) {
        if (assets_image(scene->assets, map->path, &reason))
            return true;
        if (reason.kind != ERROR_SCENE || reason.limit) {
            *error = reason;
            return false;
        }
        model_warn(model, "%s (the picture has no effect)", reason.text);
        if (known && !file_set_add(&model->broken, identity))
            return error_no_memory(error, model->path);
    }
    map->path = NULL;
    return true;
}

static bool check_pictures(struct scene *scene, struct model *model, struct model_material *m, struct error *error) {
    struct model_texture *map;
    for (size_t i = 0; (map = model_map(m, i)); i++)
        if (!check_picture(scene, model, map, error))
            return false;
    /* A cut by the colour's alpha alone, without its picture. */
    if (m->map_d.name && !is_usable(&m->map_d) && m->map_d.cutoff > 1)
        m->dissolve = 0;
    return true;
}

/* The image of a map; *there is false if there is none. */
static bool find_map(struct scene *scene, const struct model_texture *map, struct texture_image *out, bool *there,
                     struct error *error) {
    struct image *image = map->image;
    *there = is_usable(map);
    if (!*there)
        return true;
    if (!image)
        image = assets_image(scene->assets, map->path, error);
    if (!image)
        return false;
    *out = (struct texture_image){.image = image,
                                  .mapping = MAPPING_UV,
                                  .filter = map->filter,
                                  .wrap = map->wrap_u,
                                  .wrap_v = map->wrap_v,
                                  .apart = true,
                                  .scale = {map->scale[0], map->scale[1]},
                                  .cross = {map->cross[0], map->cross[1]},
                                  .offset = {map->offset[0], map->offset[1]},
                                  .second = map->second,
                                  .tint = colour_all(1)};
    return true;
}

static struct colour or_white(struct colour colour) {
    return colour_max_abs(colour) == 0 ? colour_all(1) : colour;
}

/* A map over an input of *top, which becomes the new top; does nothing without a map. */
static bool cover(struct scene *scene, const struct model_texture *map, enum material_input input, struct colour tint,
                  const struct material **top, struct error *error) {
    struct texture_image image;
    bool there;
    if (!find_map(scene, map, &image, &there, error) || !there)
        return !there;
    image.tint = tint;
    image.alpha = map->without_alpha ? ALPHA_IGNORED : ALPHA_COVERS;
    struct material *m = scene_material(scene, MATERIAL_IMAGE, *top, error);
    if (!m || !material_cover(m, input, &image, &scene->arena, error))
        return false;
    *top = m;
    return true;
}

/* Likewise. */
static bool cut(struct scene *scene, const struct model_texture *map, const struct material **top,
                struct error *error) {
    struct texture_image image;
    bool there;
    if (!find_map(scene, map, &image, &there, error) || !there)
        return !there;
    image.alpha = map->by_alpha ? ALPHA_ONLY : ALPHA_DARKENS;
    struct material *m = scene_material(scene, MATERIAL_IMAGE, *top, error);
    if (!m || !material_cut(m, &image, map->cutoff, &scene->arena, error))
        return false;
    *top = m;
    return true;
}

static bool add_bump_map(struct scene *scene, const struct model_texture *map, enum material_kind kind, bool of_coat,
                         const struct material **top, struct error *error) {
    struct texture_image image;
    bool there;
    if (!find_map(scene, map, &image, &there, error) || !there)
        return !there;
    struct material *m = scene_material(scene, kind, *top, error);
    const struct texture *texture = m ? texture_keep(&scene->arena, texture_image(&image, NULL), error) : NULL;
    if (!texture)
        return false;
    struct bump bump = bump_make(kind, texture);
    bump.height *= map->strength;
    bump.of_coat = of_coat;
    if (!material_add_bump(m, &bump, &scene->arena, error))
        return false;
    *top = m;
    return true;
}

/* The maps of everything except kd, one over the other. */
static const struct material *with_maps(struct scene *scene, const struct model_material *from,
                                        const struct material *top, struct error *error) {
    bool shiny = from->illum != 0 && from->illum != 1;
    bool ok = (!shiny || cover(scene, &from->map_ks, INPUT_KS, or_white(from->ks), &top, error)) &&
              cover(scene, &from->map_ke, INPUT_EMISSION, or_white(from->ke), &top, error) &&
              cut(scene, &from->map_d, &top, error) &&
              add_bump_map(scene, &from->map_bump, MATERIAL_BUMP, false, &top, error) &&
              add_bump_map(scene, &from->map_normal, MATERIAL_NORMAL, false, &top, error) &&
              add_bump_map(scene, &from->map_coat_normal, MATERIAL_NORMAL, true, &top, error);
    return ok ? top : NULL;
}

/* kd times the colours of the mesh's vertices. */
static bool by_vertex(struct scene *scene, struct material *m, struct error *error) {
    const struct texture *colours = texture_keep(&scene->arena, texture_vertex_colour(), error);
    return colours && material_multiply(m, INPUT_KD, colours, &scene->arena, error);
}

/* --- layers --- */

/* Colour and transmitted colour are multiplied by a picture. */
static bool multiply_by_colours(struct scene *scene, const struct model_material *from, struct material *m,
                                struct error *error) {
    struct texture_image image;
    bool there;
    if (!find_map(scene, &from->map_kd, &image, &there, error) || !there)
        return !there;
    image.alpha = ALPHA_IGNORED;
    struct arena *arena = &scene->arena;
    const struct texture *white = texture_keep(arena, texture_number(1), error);
    const struct texture *picture = white ? texture_keep(arena, texture_image(&image, white), error) : NULL;
    return picture && material_multiply(m, INPUT_KD, picture, arena, error) &&
           (m->phong.refract == 0 ||
            (material_multiply_constant(m, INPUT_TRANSMISSION_COLOUR, texture_constant(from->kd), arena, error) &&
             material_multiply(m, INPUT_TRANSMISSION_COLOUR, picture, arena, error)));
}

/* Roughness is multiplied by green, metalness by blue. */
static bool multiply_by_metal(struct scene *scene, const struct model_material *from, struct material *m,
                              struct error *error) {
    struct texture_image image;
    bool there;
    if (!find_map(scene, &from->map_metal, &image, &there, error) || !there)
        return !there;
    image.alpha = ALPHA_STRAIGHT;
    struct arena *arena = &scene->arena;
    const struct texture *white = texture_keep(arena, texture_number(1), error);
    struct texture both = white ? texture_image(&image, white) : texture_number(1);
    both.shared = true;
    const struct texture *picture = white ? texture_keep(arena, both, error) : NULL;
    const struct texture *green = picture ? texture_keep(arena, texture_map(picture, FUNCTION_GREEN, 0), error) : NULL;
    const struct texture *blue = green ? texture_keep(arena, texture_map(picture, FUNCTION_BLUE, 0), error) : NULL;
    return blue && material_multiply(m, INPUT_ROUGHNESS, green, arena, error) &&
           material_multiply_constant(m, INPUT_METALNESS, texture_number(from->layers.base_metalness), arena, error) &&
           material_multiply(m, INPUT_METALNESS, blue, arena, error);
}

/* A picture of the reflectance head on makes the surface a metal of that colour where it is above that of all common
 * dielectrics, and its alpha is the gloss. */
static bool multiply_by_gloss(struct scene *scene, const struct model_material *from, struct openpbr *layers,
                              struct material *m, struct error *error) {
    static const double metal_from = 0.3;
    struct texture_image image, diffuse;
    bool there, coloured;
    if (!find_map(scene, &from->map_gloss, &image, &there, error) || !there)
        return !there && multiply_by_colours(scene, from, m, error);
    if (!find_map(scene, &from->map_kd, &diffuse, &coloured, error))
        return false;
    struct arena *arena = &scene->arena;
    const struct texture *white = texture_keep(arena, texture_number(1), error), *parts[6];
    if (!white)
        return false;
    image.alpha = ALPHA_STRAIGHT;
    image.tint = from->gloss_colour;
    diffuse.alpha = ALPHA_IGNORED;
    diffuse.tint = from->kd;
    struct texture below = coloured ? texture_image(&diffuse, white) : texture_constant(from->kd);
    bool ok = (parts[0] = texture_keep(arena, texture_image(&image, white), error)) &&
              (parts[1] = texture_keep(arena, texture_map(parts[0], FUNCTION_STEP, metal_from), error)) &&
              (parts[2] = texture_keep(arena, below, error)) &&
              (parts[3] = texture_keep(arena, texture_mix(parts[0], parts[2], parts[1]), error));
    image.alpha = ALPHA_ONLY;
    ok = ok && (parts[4] = texture_keep(arena, texture_image(&image, white), error)) &&
         (parts[5] = texture_keep(arena, texture_number(1 - from->roughness), error)) &&
         (parts[4] = texture_keep(arena, texture_multiply(parts[4], parts[5]), error)) &&
         (parts[5] = texture_keep(arena, texture_map(parts[4], FUNCTION_COMPLEMENT, 0), error));
    m->phong.kd = m->phong.ks = colour_all(1);
    m->phong.roughness = m->phong.reflect = layers->base_metalness = 1;
    layers->specular_ior = 1.5;
    return ok && material_multiply(m, INPUT_KD, parts[3], arena, error) &&
           material_multiply(m, INPUT_METALNESS, parts[1], arena, error) &&
           material_multiply(m, INPUT_ROUGHNESS, parts[5], arena, error);
}

/* One input is multiplied by a channel or the colour of a picture. */
static bool multiply_by_map(struct scene *scene, const struct model_layer_map *from, struct material *m,
                            struct error *error) {
    struct texture_image image;
    bool there;
    if (!find_map(scene, &from->map, &image, &there, error) || !there)
        return !there;
    image.alpha = from->channel == 'a' ? ALPHA_ONLY : ALPHA_STRAIGHT;
    if (from->input == INPUT_SUBSURFACE_COLOUR)
        image.tint = m->openpbr->subsurface_colour;
    struct arena *arena = &scene->arena;
    const struct texture *white = texture_keep(arena, texture_number(1), error);
    const struct texture *part = white ? texture_keep(arena, texture_image(&image, white), error) : NULL;
    if (part && (from->channel == 'r' || from->channel == 'g'))
        part = texture_keep(arena, texture_map(part, from->channel == 'r' ? FUNCTION_RED : FUNCTION_GREEN, 0), error);
    if (!part || from->low == 0)
        return part && material_multiply_constant(m, from->input, texture_number(from->factor), arena, error) &&
               material_multiply(m, from->input, part, arena, error);
    const struct texture *high = texture_keep(arena, texture_number(from->factor), error);
    const struct texture *low = high ? texture_keep(arena, texture_number(from->low), error) : NULL;
    part = low ? texture_keep(arena, texture_mix(high, low, part), error) : NULL;
    return part && material_multiply_constant(m, from->input, texture_number(1), arena, error) &&
           material_multiply(m, from->input, part, arena, error);
}

/* Opacity below 1 is that of a surface with holes. */
static bool multiply_by_opacity(struct scene *scene, const struct model_material *from, struct material *m,
                                struct error *error) {
    return from->dissolve >= 1 ||
           material_multiply_constant(m, INPUT_OPACITY, texture_number(from->dissolve), &scene->arena, error);
}

static const struct material *make_layers(struct scene *scene, const struct model_material *from, struct error *error) {
    struct material *m = scene_material(scene, MATERIAL_OPENPBR, NULL, error);
    struct openpbr *layers = m ? arena_alloc(&scene->arena, sizeof *layers) : NULL;
    if (!layers) {
        if (m)
            error_no_memory(error, "a material");
        return NULL;
    }
    *layers = from->layers;
    m->name = from->name;
    m->openpbr = layers;
    m->phong.kd = from->kd;
    m->phong.ks = from->ks;
    m->phong.shininess = 1;
    m->phong.roughness = from->roughness;
    /* What the classic integrator and photons read of the layers. */
    m->phong.reflect = layers->base_metalness;
    m->phong.refract = from->transmission;
    m->phong.has_ior = from->transmission > 0 && !layers->thin_walled;
    m->phong.ior = m->phong.has_ior ? openpbr_ior(layers->specular_ior, layers->specular_weight) : 1;
    m->phong.absorption = from->absorption;
    m->phong.dispersion.amount = from->dispersion;
    m->phong.two_sided = from->two_sided || from->transmission > 0;
    m->phong.emission = from->map_ke.name ? colour_all(0) : from->ke;
    bool ok = (!from->by_vertex || by_vertex(scene, m, error)) && multiply_by_gloss(scene, from, layers, m, error) &&
              multiply_by_metal(scene, from, m, error) && multiply_by_opacity(scene, from, m, error);
    for (uint32_t i = 0; ok && i < from->layer_map_count; i++)
        ok = multiply_by_map(scene, &from->layer_maps[i], m, error);
    return ok ? with_maps(scene, from, m, error) : NULL;
}

/* --- classic materials --- */

static const struct material *make_material(struct scene *scene, const struct model_material *from,
                                            struct error *error) {
    if (from->layered)
        return make_layers(scene, from, error);
    struct material *m = scene_material(scene, MATERIAL_PHONG, NULL, error);
    if (!m)
        return NULL;
    bool shiny = from->illum != 0 && from->illum != 1, clear = from->dissolve < 1;
    bool bends = from->has_ior && (from->illum < 0 || from->illum == 6 || from->illum == 7);
    m->name = from->name;
    m->phong.kd = colour_scale(from->kd, from->dissolve);
    m->phong.ks = shiny ? from->ks : colour_all(0);
    m->phong.shininess = from->has_shininess && from->shininess > 0 ? from->shininess : 1;
    m->phong.reflect = from->illum >= 3 && from->illum <= 9 ? 1 : from->reflect;
    m->phong.ior = bends && from->ior >= 1 ? from->ior : 1;
    m->phong.two_sided = from->two_sided;
    m->phong.emission = from->map_ke.name ? colour_all(0) : from->ke;
    m->phong.unlit = from->unlit;
    if (clear) {
        bool dark = colour_max_abs(m->phong.ks) == 0;
        m->phong.shininess = dark ? CLEAR_SHININESS : m->phong.shininess;
        m->phong.ks = from->filter;
        m->phong.reflect = 0;
        m->phong.refract = 1 - from->dissolve;
        m->phong.has_ior = true;
    }
    /* The picture is multiplied by the final kd. */
    struct colour tint = m->phong.kd;
    if (colour_max_abs(tint) == 0 && from->map_kd.name && from->illum >= 0)
        tint = colour_all(
            from->dissolve); /* exporters that write a black kd with a picture intend the picture's colours */
    const struct material *top = m;
    if (!cover(scene, &from->map_kd, INPUT_KD, tint, &top, error))
        return NULL;
    /* The colours of the mesh multiply the picture, too. */
    if (from->by_vertex) {
        struct material *coloured = top == m ? m : scene_material(scene, MATERIAL_IMAGE, top, error);
        if (!coloured || !by_vertex(scene, coloured, error))
            return NULL;
        top = coloured;
    }
    top = with_maps(scene, from, top, error);
    if (!top || !clear || from->illum != 7)
        return top;
    return scene_material(scene, MATERIAL_FRESNEL, top, error);
}

/* --- parts --- */

const char *model_part(const struct model *model, size_t index) {
    for (size_t i = 0; i < model->meshes.count; i++) {
        const struct model_mesh *mesh = &model_meshes(model)[i];
        if (index < mesh->slot_names.count)
            return ((const char *const *)mesh->slot_names.items)[index];
        index -= mesh->slot_names.count;
    }
    return NULL;
}

bool model_has_part(const struct model *model, const char *name) {
    const char *part;
    for (size_t i = 0; (part = model_part(model, i)); i++)
        if (strcmp(part, name) == 0)
            return true;
    return false;
}

static const struct material *part_material(const struct model_placing *placing, const char *name) {
    for (uint32_t i = 0; i < placing->part_count; i++)
        if (strcmp(placing->part_names[i], name) == 0)
            return placing->part_materials[i];
    return NULL;
}

/* --- nodes --- */

struct placer {
    struct scene *scene;
    struct model *model;
    const struct model_placing *placing;
    struct error *error;
    const struct material **materials; /* of the model; NULL until its first use */
};

static const struct material *material_of(struct placer *p, uint32_t index) {
    struct model_material *from = &model_materials(p->model)[index];
    if (!p->materials[index] && check_pictures(p->scene, p->model, from, p->error))
        p->materials[index] = make_material(p->scene, from, p->error);
    return p->materials[index];
}

/* The inputs of such materials are as if no picture were named. */
static void warn_without_coordinates(const struct placer *p, const struct model_mesh *mesh, uint32_t index) {
    struct model_material *m = &model_materials(p->model)[index];
    const struct model_texture *map;
    bool any = false;
    for (size_t i = 0; (map = model_map(m, i)); i++)
        any = any || is_usable(map);
    if (any && !mesh_has_uv(mesh->mesh))
        model_warn(p->model, "%s: the pictures of the material '%.200s' have no effect on meshes without coordinates",
                   p->model->path, m->name);
}

static bool set_shape(struct placer *p, struct node *node, uint32_t index) {
    const struct model_mesh *mesh = &model_meshes(p->model)[index];
    const uint32_t *slots = mesh->slots.items;
    node->shape.kind = SHAPE_MESH;
    node->shape.mesh = mesh->mesh;
    node->cull = p->placing->cull;
    node->walls = p->placing->walls;
    node->material = p->placing->part_count ? NULL : p->placing->material;
    bool any = p->placing->part_count > 0 && mesh->slot_names.count > 0;
    for (size_t i = 0; i < mesh->slots.count; i++)
        any |= slots[i] != MODEL_NONE;
    if (mesh->slots.count == 0 || (!any && mesh->slots.count == 1)) {
        node->material = p->placing->material;
        return true;
    }
    const struct material **list = arena_alloc_array(&p->scene->arena, mesh->slots.count, sizeof *list);
    const char **names = arena_alloc_array(&p->scene->arena, mesh->slots.count, sizeof *names);
    if (!list || !names)
        return error_no_memory(p->error, "the materials of a mesh");
    for (size_t i = 0; i < mesh->slots.count; i++) {
        bool named = mesh->slot_names.count > i;
        names[i] = named ? ((const char *const *)mesh->slot_names.items)[i] : "";
        /* Under a material of the script, the file's materials are not made: their pictures may be missing. */
        list[i] = part_material(p->placing, names[i]);
        if (!list[i])
            list[i] = p->placing->material;
        if (slots[i] == MODEL_NONE || list[i])
            continue;
        list[i] = material_of(p, slots[i]);
        if (!list[i])
            return false;
        warn_without_coordinates(p, mesh, slots[i]);
    }
    node->slots = list;
    node->slot_names = names;
    node->slot_count = (uint32_t)mesh->slots.count;
    return true;
}

static struct node *add_single_node(struct placer *p, uint32_t index) {
    const struct model_node *nodes = model_nodes(p->model);
    struct node *node = scene_node(p->scene, NODE_GEOMETRY, p->placing->name, p->error);
    if (!node || !set_shape(p, node, nodes[index].mesh))
        return NULL;
    for (uint32_t at = index; at != MODEL_NONE; at = nodes[at].parent)
        node->parent_from_node = transform_compose(&nodes[at].parent_from_node, &node->parent_from_node);
    return node;
}

static struct node *add_node_tree(struct placer *p) {
    const struct model_node *nodes = model_nodes(p->model);
    struct node *root = scene_node(p->scene, NODE_GROUP, p->placing->name, p->error);
    struct node **made = mem_alloc_zero(p->model->nodes.count, sizeof *made);
    bool ok = root && made;
    if (root && !made)
        error_no_memory(p->error, p->model->path);
    for (size_t i = 0; ok && i < p->model->nodes.count; i++) {
        bool drawn = nodes[i].mesh != MODEL_NONE && mesh_triangle_count(model_meshes(p->model)[nodes[i].mesh].mesh) > 0;
        const char *name = nodes[i].name[0] ? nodes[i].name : p->placing->name;
        made[i] = scene_node(p->scene, drawn ? NODE_GEOMETRY : NODE_GROUP, name, p->error);
        ok = made[i] && (!drawn || set_shape(p, made[i], nodes[i].mesh));
        if (!ok)
            break;
        made[i]->parent_from_node = nodes[i].parent_from_node;
        ok = node_add_child(p->scene, nodes[i].parent == MODEL_NONE ? root : made[nodes[i].parent], made[i], p->error);
    }
    mem_free(made);
    return ok ? root : NULL;
}

struct node *model_add_nodes(struct scene *scene, struct model *model, const struct model_placing *placing,
                             struct error *error) {
    struct placer p = {.scene = scene, .model = model, .placing = placing, .error = error};
    p.materials = arena_alloc_array(&scene->arena, model->materials.count, sizeof *p.materials);
    if (!p.materials && model->materials.count) {
        error_no_memory(error, model->path);
        return NULL;
    }
    uint32_t drawn = 0, single = 0;
    for (uint32_t i = 0; i < model->nodes.count; i++)
        if (model_nodes(model)[i].mesh != MODEL_NONE) {
            single = i;
            drawn++;
        }
    return drawn == 1 ? add_single_node(&p, single) : add_node_tree(&p);
}
