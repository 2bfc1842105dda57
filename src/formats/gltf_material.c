/* Materials of glTF, turned into ours as they are read. Source: glTF 2.0, section 3.9 and appendix B; extensions
 * KHR_materials_ior, _transmission, _unlit, KHR_texture_transform.
 *
 * A metallic-roughness surface is not a Phong surface; this is what we take for it. Base colour c, metallic m,
 * roughness r: kd = c (1 - m); ks = F0 (1 - m) + c m, F0 = ((ior - 1) / (ior + 1))^2; the width of the highlight is
 * that of the microfacet distribution at the same roughness, n = 2 / r^4 - 2 (B. Walter et al., "Microfacet Models for
 * Refraction through Rough Surfaces", EGSR 2007, section 5.2), at most 1998; what is smooth mirrors: reflect = (1 -
 * r)^2 for metals, and for others by Fresnel when they let light through. Pictures are used as they are stored, as all
 * ours. */
#ifdef HAVE_JANSSON

#include "formats/gltf_internal.h"

#include "image/image.h"

#include <stdio.h>

enum { MATERIAL_LIMIT = 65536 };

static double number_or(const json_t *object, const char *key, double otherwise) {
    const json_t *value = json_object_get(object, key);
    return json_is_number(value) ? json_number_value(value) : otherwise;
}

static double unit(double x) {
    return x < 0 ? 0 : x > 1 ? 1 : x;
}

/* The picture of images[index] into the map: decoded when it is inside the file, else its path. */
static bool find_image(struct gltf *g, uint32_t index, struct model_texture *map) {
    char where[64];
    (void)snprintf(where, sizeof where, "images[%u]", index);
    const json_t *image = json_array_get(gltf_array(g, "images"), index);
    const char *uri = json_string_value(json_object_get(image, "uri"));
    uint8_t *decoded = NULL;
    const uint8_t *data;
    size_t size, stride;
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
        if (!map->path && !g->model->options.single_file)
            model_warn(g->model, "%s: the picture '%.200s' is not there", g->path, name);
        return true;
    }
    if (!g->images[index]) {
        if (uri) {
            if (!gltf_decode_data(g, uri, &decoded, &size, where))
                return false;
            data = decoded;
        } else {
            uint32_t view;
            if (!gltf_index(g, image, "bufferView", "bufferViews", &view, where))
                return false;
            if (view == MODEL_NONE)
                return gltf_fail(g, where, "it has neither uri nor bufferView");
            if (!gltf_view(g, view, &data, &size, &stride))
                return false;
        }
        char *title = arena_format(&g->model->arena, "%s: %s", g->path, where);
        g->images[index] = title ? image_parse(title, data, size, g->error) : NULL;
        mem_free(decoded);
        if (!title)
            return error_no_memory(g->error, g->path);
        if (!g->images[index])
            return false;
    }
    map->image = image_share(g->images[index]);
    return true;
}

static enum image_wrap wrap_of(uint64_t code) {
    return code == 33071 ? IMAGE_CLAMP : code == 33648 ? IMAGE_MIRROR : IMAGE_REPEAT;
}

/* A texture reference such as baseColorTexture; nothing when it is absent. */
static bool read_map(struct gltf *g, const json_t *object, const char *key, struct model_texture *map,
                     const char *where) {
    const json_t *info = json_object_get(object, key);
    uint32_t texture, image, sampler;
    uint64_t set;
    if (!info)
        return true;
    if (!gltf_index(g, info, "index", "textures", &texture, where) || !gltf_whole(g, info, "texCoord", 0, &set, where))
        return false;
    if (texture == MODEL_NONE)
        return gltf_fail(g, where, "%s has no index", key);
    if (set != 0) {
        model_warn(g->model, "%s: %s: %s uses the texture coordinates number %llu; only number 0 is read", g->path,
                   where, key, (unsigned long long)set);
        return true;
    }
    const json_t *source = json_array_get(gltf_array(g, "textures"), texture);
    if (!gltf_index(g, source, "source", "images", &image, where) ||
        !gltf_index(g, source, "sampler", "samplers", &sampler, where))
        return false;
    if (image == MODEL_NONE) {
        model_warn(g->model, "%s: textures[%u]: its picture is of a kind that is not read", g->path, texture);
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
    const json_t *transform = json_object_get(json_object_get(info, "extensions"), "KHR_texture_transform");
    if (transform) {
        double scale[2] = {1, 1}, offset[2] = {0, 0};
        if (!gltf_numbers(g, transform, "scale", scale, 2, where) ||
            !gltf_numbers(g, transform, "offset", offset, 2, where))
            return false;
        if (number_or(transform, "rotation", 0) != 0)
            model_warn(g->model, "%s: %s: a turned texture is shown unturned", g->path, where);
        /* glTF counts v from above, we from below: v' = 1 - (s (1 - v) + o) = s v + (1 - s - o). */
        map->scale[0] = scale[0], map->scale[1] = scale[1];
        map->offset[0] = offset[0], map->offset[1] = 1 - scale[1] - offset[1];
    }
    return find_image(g, image, map);
}

static bool read_material(struct gltf *g, const json_t *source, struct model_material *m, const char *where) {
    const json_t *rough = json_object_get(source, "pbrMetallicRoughness");
    const json_t *extensions = json_object_get(source, "extensions");
    const char *name = json_string_value(json_object_get(source, "name"));
    const char *alpha_mode = json_string_value(json_object_get(source, "alphaMode"));
    double base[4] = {1, 1, 1, 1}, emitted[3] = {0, 0, 0};
    if (name)
        m->name = arena_copy_text(&g->model->arena, name, strlen(name));
    if (!m->name)
        return error_no_memory(g->error, g->path);
    if (!gltf_numbers(g, rough, "baseColorFactor", base, 4, where) ||
        !gltf_numbers(g, source, "emissiveFactor", emitted, 3, where))
        return false;
    double metallic = unit(number_or(rough, "metallicFactor", 1)), r = unit(number_or(rough, "roughnessFactor", 1));
    const json_t *glass = json_object_get(extensions, "KHR_materials_transmission");
    double transmission = unit(number_or(glass, "transmissionFactor", 0)) * (1 - metallic);
    double ior = number_or(json_object_get(extensions, "KHR_materials_ior"), "ior", 1.5);
    ior = ior >= 1 ? ior : 1.5;
    double f0 = (ior - 1) / (ior + 1) * ((ior - 1) / (ior + 1));
    struct vec3 colour = {base[0], base[1], base[2]};
    /* Where a picture has a say in it the split is made point by point. */
    m->by_metal = json_object_get(rough, "metallicRoughnessTexture") ||
                  (metallic > 0 && json_object_get(rough, "baseColorTexture"));
    m->metallic = metallic;
    m->roughness = r;
    m->f0 = f0;
    m->kd = m->by_metal ? colour : vec3_scale(colour, 1 - metallic);
    m->ks = vec3_add(vec3_scale(vec3_all(f0), 1 - metallic), vec3_scale(colour, metallic));
    double n = 2 / fmax(r * r * r * r, 1e-3) - 2;
    m->shininess = n < 1 ? 1 : n;
    m->has_shininess = true;
    m->reflect = metallic * (1 - r) * (1 - r);
    m->ke = vec3_make(emitted[0], emitted[1], emitted[2]);
    m->two_sided = json_is_true(json_object_get(source, "doubleSided"));
    m->by_vertex = true;
    if (json_object_get(extensions, "KHR_materials_unlit")) {
        m->ks = vec3_all(0);
        m->kd = colour;
        m->by_metal = false;
        m->unlit = true;
    }
    bool blend = alpha_mode && strcmp(alpha_mode, "BLEND") == 0, mask = alpha_mode && strcmp(alpha_mode, "MASK") == 0;
    if (blend)
        m->dissolve = unit(base[3]);
    if (transmission > 0) {
        m->dissolve = 1 - transmission;
        m->filter = colour;
        m->ior = ior;
        m->has_ior = true;
        m->fresnel = transmission == 1;
    }
    m->map_kd.without_alpha = true;
    if (blend || mask) { /* the alpha of the colour's picture; factors below 1 count before the cut */
        double cutoff = number_or(source, "alphaCutoff", 0.5);
        m->map_d.by_alpha = true;
        m->map_d.cutoff = blend ? 0 : base[3] > 0 ? fmax(cutoff / base[3], 1e-9) : INFINITY;
        if (!read_map(g, rough, "baseColorTexture", &m->map_d, where))
            return false;
    }
    return read_map(g, rough, "baseColorTexture", &m->map_kd, where) &&
           (!m->by_metal || read_map(g, rough, "metallicRoughnessTexture", &m->map_metal, where)) &&
           read_map(g, source, "normalTexture", &m->map_normal, where) &&
           (vec3_max_abs(m->ke) == 0 || read_map(g, source, "emissiveTexture", &m->map_ke, where));
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
    /* The last one is that of primitives without any: white and rough. */
    struct model_material *m = model_add_material(g->model, g->error);
    if (!m)
        return false;
    m->kd = vec3_all(1);
    m->by_vertex = true;
    return true;
}

#else
/* Without jansson there is nothing in here. */
typedef int gltf_material_is_default;
#endif
