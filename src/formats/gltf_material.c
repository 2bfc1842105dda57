/* Materials of glTF, converted to layers of OpenPBR while they are read. Source: glTF 2.0, section 3.9 and appendix
 * B; extensions KHR_materials_ior, _specular, _transmission, _volume, _clearcoat, _sheen, _emissive_strength,
 * _iridescence, _dispersion, _unlit, _pbrSpecularGlossiness, KHR_texture_transform.
 *
 * Both describe a metal and a dielectric over a diffuse base, with facets of width roughness^2. The clear coat of
 * glTF has the index 1.5 and does not darken the layers below it. A transmitting surface without a volume is a thin
 * wall. Sheen is fuzz. Unlit materials are classic ones. */
#ifdef HAVE_JANSSON

#include "formats/gltf_data_internal.h"

#include "formats/gltf_material_internal.h"
#include "image/image.h"
#include "math/elementary.h"

#include <stdio.h>

enum { MATERIAL_LIMIT = 65536 };

static double number_or(const json_t *object, const char *key, double otherwise) {
    const json_t *value = json_object_get(object, key);
    return json_is_number(value) ? json_number_value(value) : otherwise;
}

static double unit(double x) {
    return x < 0 ? 0 : x > 1 ? 1 : x;
}

/* A picture inside the file; NULL and an error if it cannot be read. */
static struct image *decode_image(struct gltf *g, const json_t *image, const char *uri, const char *where) {
    uint8_t *decoded = NULL;
    const uint8_t *data;
    size_t size, stride;
    uint32_t view;
    char *title = arena_format(&g->model->arena, "%s: %s", g->path, where);
    if (!title) {
        error_no_memory(g->error, g->path);
        return NULL;
    }
    if (uri) {
        if (!gltf_decode_data(g, uri, &decoded, &size, where))
            return NULL;
        data = decoded;
    } else if (!gltf_index(g, image, "bufferView", "bufferViews", &view, where) ||
               (view == MODEL_NONE && !gltf_fail(g, where, "it has neither uri nor bufferView")) ||
               !gltf_view(g, view, &data, &size, &stride)) {
        return NULL;
    }
    struct image *out = image_parse(title, data, size, g->error);
    mem_free(decoded);
    return out;
}

/* A picture without a name takes the place of one that cannot be read, so that it is tried and reported once. */
static bool replace_image(struct gltf *g, uint32_t index) {
    if (g->error->kind != ERROR_SCENE || g->error->limit)
        return false;
    model_warn(g->model, "%s (the picture has no effect)", g->error->text);
    *g->error = (struct error){0};
    g->images[index] = image_create("", 1, 1, 8, (const uint8_t[4]){0}, g->error);
    return g->images[index] != NULL;
}

/* Adds the picture images[index] to the map: decoded if it is inside the file, otherwise its path; neither if it cannot
 * be used. */
static bool find_image(struct gltf *g, uint32_t index, struct model_texture *map) {
    char where[64];
    (void)snprintf(where, sizeof where, "images[%u]", index);
    const json_t *image = json_array_get(gltf_array(g, "images"), index);
    const char *uri = json_string_value(json_object_get(image, "uri"));
    map->name = arena_format(&g->model->arena, "%s", where);
    if (!map->name)
        return error_no_memory(g->error, g->path);
    if (uri && strncmp(uri, "data:", 5) != 0) {
        char *name = gltf_decode_uri(g, uri);
        if (!name)
            return error_no_memory(g->error, g->path);
        map->name = name;
        if (!model_find(g->model, name, strlen(name), &map->path, g->error))
            return false;
        if (!map->path)
            model_warn_missing(g->model, g->path, name);
        return true;
    }
    /* An embedded picture is decoded once, for all materials that use it. */
    if (!g->images[index])
        g->images[index] = decode_image(g, image, uri, where);
    if (!g->images[index] && !replace_image(g, index))
        return false;
    if (image_name(g->images[index])[0] != '\0')
        map->image = image_share(g->images[index]);
    return true;
}

static enum image_wrap wrap_of(uint64_t code) {
    return code == 33071 ? IMAGE_CLAMP : code == 33648 ? IMAGE_MIRROR : IMAGE_REPEAT;
}

/* Reads a texture reference such as baseColorTexture; does nothing if it is absent. */
static bool read_map(struct gltf *g, const json_t *object, const char *key, struct model_texture *map,
                     const char *where) {
    const json_t *info = json_object_get(object, key);
    const json_t *transform = json_object_get(json_object_get(info, "extensions"), "KHR_texture_transform");
    uint32_t texture, image, sampler;
    uint64_t set;
    if (!info)
        return true;
    map->name = key; /* there is one, even if it cannot be used */
    if (!gltf_index(g, info, "index", "textures", &texture, where) ||
        !gltf_whole(g, info, "texCoord", 0, &set, where) || !gltf_whole(g, transform, "texCoord", set, &set, where))
        return false;
    if (texture == MODEL_NONE)
        return gltf_fail(g, where, "%s has no index", key);
    if (set > 1) {
        gltf_lacks(g, where, "a picture by texture coordinates beyond number 1 is not shown");
        return true;
    }
    map->second = set == 1;
    const json_t *source = json_array_get(gltf_array(g, "textures"), texture);
    const json_t *webp = json_object_get(json_object_get(source, "extensions"), "EXT_texture_webp");
    if (!gltf_index(g, json_object_get(source, "source") ? source : webp, "source", "images", &image, where) ||
        !gltf_index(g, source, "sampler", "samplers", &sampler, where))
        return false;
    if (image == MODEL_NONE) {
        char name[64];
        (void)snprintf(name, sizeof name, "textures[%u]", texture);
        gltf_lacks(g, name, "its picture is of a kind that is not read");
        return true;
    }
    if (sampler != MODEL_NONE) {
        const json_t *s = json_array_get(gltf_array(g, "samplers"), sampler);
        uint64_t u, v, nearest;
        if (!gltf_whole(g, s, "wrapS", 10497, &u, where) || !gltf_whole(g, s, "wrapT", 10497, &v, where) ||
            !gltf_whole(g, s, "magFilter", 9729, &nearest, where))
            return false;
        map->wrap_u = wrap_of(u);
        map->wrap_v = wrap_of(v);
        map->filter = nearest == 9728 ? IMAGE_NEAREST : IMAGE_MIPMAP;
    }
    map->strength = number_or(info, "scale", 1);
    if (transform) {
        double scale[2] = {1, 1}, offset[2] = {0, 0}, sine, cosine;
        if (!gltf_numbers(g, transform, "scale", scale, 2, where) ||
            !gltf_numbers(g, transform, "offset", offset, 2, where))
            return false;
        /* u' = a u + b v + o, v' = c u + d v + o with v from the upper edge; in gray it is from the lower one: v is
         * replaced by 1 - v. */
        el_sincos(number_or(transform, "rotation", 0), &sine, &cosine);
        double a = cosine * scale[0], b = sine * scale[1], c = -sine * scale[0], d = cosine * scale[1];
        map->scale[0] = a, map->scale[1] = d;
        map->cross[0] = -b, map->cross[1] = -c;
        map->offset[0] = offset[0] + b, map->offset[1] = 1 - d - offset[1];
    }
    return find_image(g, image, map);
}

static struct colour unit_colour(const double colour[3]) {
    return colour_make(unit(colour[0]), unit(colour[1]), unit(colour[2]));
}

static void warn_of_pictures(struct gltf *g, const json_t *extensions, const char *where) {
    static const char *const keys[][2] = {{"KHR_materials_volume", "thicknessTexture"},
                                          {"KHR_materials_sheen", "sheenColorTexture"}};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
        if (json_object_get(json_object_get(extensions, keys[i][0]), keys[i][1]))
            gltf_lacks(g, where, "the %s of %s is not read", keys[i][1], keys[i][0]);
}

/* A factor of an extension, between 0 and 1. */
static double share(const json_t *extension, const char *key, double otherwise) {
    return unit(number_or(extension, key, otherwise));
}

/* Beer's law: white light has this colour after the distance. */
static bool read_volume(struct gltf *g, const json_t *volume, struct model_material *m, const char *where) {
    double colour[3] = {1, 1, 1}, distance = number_or(volume, "attenuationDistance", 0), absorption[3] = {0, 0, 0};
    if (!gltf_numbers(g, volume, "attenuationColor", colour, 3, where))
        return false;
    for (int i = 0; i < 3 && distance > 0 && !m->layers.thin_walled; i++)
        absorption[i] = colour[i] < 1 ? -el_log(math_max(colour[i], 1e-6)) / distance : 0;
    m->absorption = colour_make(absorption[0], absorption[1], absorption[2]);
    return true;
}

/* KHR_materials_diffuse_transmission: all of the diffuse light that it takes comes through a thin wall; in a solid it
 * is light under the surface, where KHR_materials_volume_scatter has its colour. Under a transmitting surface that
 * extension makes a part of the extinction scattering. */
static bool read_scattering(struct gltf *g, const json_t *extensions, struct model_material *m, const char *where) {
    const json_t *diffuse = json_object_get(extensions, "KHR_materials_diffuse_transmission");
    const json_t *scatter = json_object_get(extensions, "KHR_materials_volume_scatter");
    double tint[3] = {1, 1, 1}, colour[3] = {0, 0, 0}, g_scatter = number_or(scatter, "scatterAnisotropy", 0);
    struct openpbr *v = &m->layers;
    struct colour extinction = m->absorption;
    if (!gltf_numbers(g, diffuse, "diffuseTransmissionColorFactor", tint, 3, where) ||
        !gltf_numbers(g, scatter, "multiscatterColor", colour, 3, where))
        return false;
    g_scatter = math_min(math_max(g_scatter, -0.99), 0.99);
    v->subsurface_weight = share(diffuse, "diffuseTransmissionFactor", 0);
    v->subsurface_colour = unit_colour(tint);
    v->subsurface_anisotropy = v->thin_walled ? 1 : g_scatter;
    /* Channels without extinction are all but clear. */
    struct colour minimum = colour_all(colour_max_abs(extinction) / 1024);
    v->subsurface_radius_scale = colour_share(colour_all(1), colour_max(extinction, minimum));
    if (v->thin_walled || !scatter)
        return true;
    v->subsurface_colour = unit_colour(colour);
    v->transmission_anisotropy = g_scatter;
    v->transmission_scattering = colour_mul(extinction, colour_make(subsurface_albedo(unit(colour[0]), g_scatter),
                                                                    subsurface_albedo(unit(colour[1]), g_scatter),
                                                                    subsurface_albedo(unit(colour[2]), g_scatter)));
    m->absorption = colour_sub(extinction, v->transmission_scattering);
    return true;
}

/* Thicknesses are in nanometres. */
static void read_film(const json_t *film, struct openpbr *layers) {
    layers->film_weight = share(film, "iridescenceFactor", 0);
    layers->film_ior = math_max(number_or(film, "iridescenceIor", 1.3), 1);
    layers->film_thickness = math_max(number_or(film, "iridescenceThicknessMaximum", 400), 0) / 1000;
}

static bool read_sheen(struct gltf *g, const json_t *sheen, struct model_material *m, const char *where) {
    double colour[3] = {0, 0, 0};
    if (!gltf_numbers(g, sheen, "sheenColorFactor", colour, 3, where))
        return false;
    double weight = unit(math_max(colour[0], math_max(colour[1], colour[2])));
    m->layers.fuzz_weight = weight;
    m->layers.fuzz_roughness = share(sheen, "sheenRoughnessFactor", 0);
    if (weight > 0)
        m->layers.fuzz_colour =
            colour_make(unit(colour[0] / weight), unit(colour[1] / weight), unit(colour[2] / weight));
    return true;
}

/* KHR_materials_pbrSpecularGlossiness: a dielectric whose index gives the reflectance head on. */
static bool read_gloss(struct gltf *g, const json_t *gloss, struct model_material *m, const char *where) {
    double colour[3] = {1, 1, 1};
    if (!gltf_numbers(g, gloss, "specularFactor", colour, 3, where))
        return false;
    struct colour specular = unit_colour(colour);
    double max = colour_max_abs(specular), root = sqrt(math_min(max, 0.98));
    m->layers.base_metalness = 0;
    m->layers.specular_ior = (1 + root) / (1 - root);
    m->ks = max > 0 ? colour_scale(specular, 1 / max) : specular;
    m->gloss_colour = specular;
    m->roughness = 1 - share(gloss, "glossinessFactor", 1);
    return read_map(g, gloss, "specularGlossinessTexture", &m->map_gloss, where);
}

/* The pictures of extensions whose factors are not 0. */
static bool read_layer_maps(struct gltf *g, const json_t *extensions, struct model_material *m, const char *where) {
    const struct openpbr *layers = &m->layers;
    const double transmission = m->transmission > 0, thickness = layers->film_weight > 0 ? layers->film_thickness : 0;
    const json_t *film = json_object_get(extensions, "KHR_materials_iridescence");
    const double thinnest = math_max(number_or(film, "iridescenceThicknessMinimum", 100), 0) / 1000;
    const struct {
        const char *extension, *key;
        enum material_input input;
        char channel;
        double factor; /* 0: the layer is not there; the colour and the transmission have theirs already */
    } rows[MODEL_LAYER_MAPS] = {
        {"KHR_materials_specular", "specularTexture", INPUT_SPECULAR_WEIGHT, 'a', layers->specular_weight},
        {"KHR_materials_specular", "specularColorTexture", INPUT_KS, 'c', 1},
        {"KHR_materials_transmission", "transmissionTexture", INPUT_REFRACT, 'r', transmission},
        {"KHR_materials_clearcoat", "clearcoatTexture", INPUT_COAT_WEIGHT, 'r', layers->coat_weight},
        {"KHR_materials_clearcoat", "clearcoatRoughnessTexture", INPUT_COAT_ROUGHNESS, 'g', layers->coat_roughness},
        {"KHR_materials_sheen", "sheenRoughnessTexture", INPUT_FUZZ_ROUGHNESS, 'a', layers->fuzz_roughness},
        {"KHR_materials_diffuse_transmission", "diffuseTransmissionTexture", INPUT_SUBSURFACE_WEIGHT, 'a',
         layers->subsurface_weight},
        {"KHR_materials_diffuse_transmission", "diffuseTransmissionColorTexture", INPUT_SUBSURFACE_COLOUR, 'c',
         layers->subsurface_weight > 0},
        {"KHR_materials_iridescence", "iridescenceTexture", INPUT_FILM_WEIGHT, 'r', layers->film_weight},
        {"KHR_materials_iridescence", "iridescenceThicknessTexture", INPUT_FILM_THICKNESS, 'g', thickness}};
    for (size_t i = 0; i < MODEL_LAYER_MAPS; i++) {
        const json_t *extension = json_object_get(extensions, rows[i].extension);
        if (rows[i].factor == 0 || !json_object_get(extension, rows[i].key))
            continue;
        struct model_layer_map *map = &m->layer_maps[m->layer_map_count++];
        map->input = rows[i].input;
        map->channel = rows[i].channel;
        map->factor = rows[i].factor;
        map->low = rows[i].input == INPUT_FILM_THICKNESS ? thinnest : 0;
        if (!read_map(g, extension, rows[i].key, &map->map, where))
            return false;
    }
    return true;
}

static bool read_layers(struct gltf *g, const json_t *source, struct model_material *m, const char *where) {
    const json_t *extensions = json_object_get(source, "extensions");
    const json_t *rough = json_object_get(source, "pbrMetallicRoughness");
    const json_t *specular = json_object_get(extensions, "KHR_materials_specular");
    const json_t *volume = json_object_get(extensions, "KHR_materials_volume");
    const json_t *coat = json_object_get(extensions, "KHR_materials_clearcoat");
    double colour[3] = {1, 1, 1}, ior = number_or(json_object_get(extensions, "KHR_materials_ior"), "ior", 1.5);
    if (!gltf_numbers(g, specular, "specularColorFactor", colour, 3, where))
        return false;
    warn_of_pictures(g, extensions, where);
    m->layered = true;
    m->layers = openpbr_defaults();
    m->layers.base_weight = 1;
    m->layers.base_metalness = share(rough, "metallicFactor", 1);
    m->layers.specular_ior = ior >= 1 ? ior : 1.5;
    m->layers.specular_weight = share(specular, "specularFactor", 1);
    m->layers.coat_weight = share(coat, "clearcoatFactor", 0);
    m->layers.coat_roughness = share(coat, "clearcoatRoughnessFactor", 0);
    m->layers.coat_ior = 1.5;
    m->layers.coat_darkening = 0;
    m->layers.transmission_colour = m->kd;
    /* Without a thickness the surface is a sheet, not a solid. */
    m->layers.thin_walled = !(number_or(volume, "thicknessFactor", 0) > 0);
    m->ks = unit_colour(colour);
    m->roughness = share(rough, "roughnessFactor", 1);
    read_film(json_object_get(extensions, "KHR_materials_iridescence"), &m->layers);
    /* 20 / Abbe's number. */
    m->dispersion =
        math_max(number_or(json_object_get(extensions, "KHR_materials_dispersion"), "dispersion", 0), 0) / 20;
    m->transmission = share(json_object_get(extensions, "KHR_materials_transmission"), "transmissionFactor", 0);
    const json_t *gloss = json_object_get(extensions, "KHR_materials_pbrSpecularGlossiness");
    return read_volume(g, volume, m, where) && read_scattering(g, extensions, m, where) &&
           (!gloss || read_gloss(g, gloss, m, where)) &&
           read_sheen(g, json_object_get(extensions, "KHR_materials_sheen"), m, where) &&
           read_layer_maps(g, extensions, m, where) &&
           (m->layers.coat_weight == 0 || read_map(g, coat, "clearcoatNormalTexture", &m->map_coat_normal, where)) &&
           (gloss || read_map(g, rough, "metallicRoughnessTexture", &m->map_metal, where));
}

static bool read_emission(struct gltf *g, const json_t *source, struct model_material *m, const char *where) {
    const json_t *strength = json_object_get(json_object_get(source, "extensions"), "KHR_materials_emissive_strength");
    double emitted[3] = {0, 0, 0};
    if (!gltf_numbers(g, source, "emissiveFactor", emitted, 3, where))
        return false;
    m->ke = colour_scale(colour_make(emitted[0], emitted[1], emitted[2]),
                         math_max(number_or(strength, "emissiveStrength", 1), 0));
    return colour_max_abs(m->ke) == 0 || read_map(g, source, "emissiveTexture", &m->map_ke, where);
}

static bool read_material(struct gltf *g, const json_t *source, struct model_material *m, const char *where) {
    const json_t *rough = json_object_get(source, "pbrMetallicRoughness");
    const json_t *gloss = json_object_get(json_object_get(source, "extensions"), "KHR_materials_pbrSpecularGlossiness");
    const json_t *colours = gloss ? gloss : rough;
    const char *picture = gloss ? "diffuseTexture" : "baseColorTexture";
    const char *alpha_mode = json_string_value(json_object_get(source, "alphaMode"));
    double base[4] = {1, 1, 1, 1};
    m->name = gltf_name(g, source);
    if (!m->name || !gltf_numbers(g, colours, gloss ? "diffuseFactor" : "baseColorFactor", base, 4, where))
        return false;
    m->kd = unit_colour(base);
    m->two_sided = json_is_true(json_object_get(source, "doubleSided"));
    m->by_vertex = true;
    m->unlit = json_object_get(json_object_get(source, "extensions"), "KHR_materials_unlit") != NULL;
    if (!m->unlit && !read_layers(g, source, m, where))
        return false;
    bool blend = alpha_mode && strcmp(alpha_mode, "BLEND") == 0, mask = alpha_mode && strcmp(alpha_mode, "MASK") == 0;
    if (blend)
        m->dissolve = unit(base[3]);
    m->map_kd.without_alpha = true;
    if (mask && base[3] < number_or(source, "alphaCutoff", 0.5) && !json_object_get(colours, picture))
        m->dissolve = 0;
    if (blend || mask) { /* the alpha channel of the colour's picture; factors below 1 apply before the cut */
        double cutoff = number_or(source, "alphaCutoff", 0.5);
        m->map_d.by_alpha = true;
        m->map_d.cutoff = blend ? 0 : base[3] > 0 ? math_max(cutoff / base[3], 1e-9) : INFINITY;
        if (!read_map(g, colours, picture, &m->map_d, where))
            return false;
    }
    return read_map(g, colours, picture, &m->map_kd, where) &&
           read_map(g, source, "normalTexture", &m->map_normal, where) && read_emission(g, source, m, where);
}

bool gltf_read_materials(struct gltf *g) {
    const json_t *materials = gltf_array(g, "materials");
    if (json_array_size(materials) > MATERIAL_LIMIT)
        return gltf_fail(g, "materials", "more than %d", MATERIAL_LIMIT);
    g->image_count = json_array_size(gltf_array(g, "images"));
    g->images = mem_alloc_zero(g->image_count ? g->image_count : 1, sizeof(struct image *));
    if (!g->images)
        return error_no_memory(g->error, g->path);
    for (size_t i = 0; i < json_array_size(materials); i++) {
        char where[64];
        (void)snprintf(where, sizeof where, "materials[%zu]", i);
        struct model_material *m = model_add_material(g->model, g->error);
        if (!m || !read_material(g, json_array_get(materials, i), m, where))
            return false;
    }
    /* The last material is that of primitives without a material: white and rough. */
    struct model_material *m = model_add_material(g->model, g->error);
    if (!m)
        return false;
    m->kd = colour_all(1);
    m->by_vertex = true;
    return true;
}

#else
/* This file is empty without jansson. */
typedef int gltf_material_is_default;
#endif
