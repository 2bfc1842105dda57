/* The layers of OpenPBR are those of glTF with its extensions; classic materials are taken for the layers that
 * openpbr_classic makes them of. Colours are linear light; those of a scene with classic colours are what a screen
 * shows.
 *
 * A picture over the coordinates of the shape is copied. Other textures are baked: evaluated at the points of the
 * surface that the texels of a picture have by the surface's u and v. A surface that has no u and v of its own, or the
 * same ones at several places, is unfolded first: each of its triangles gets a place in the picture. */
#include "export/gltf_paint_internal.h"

#include "image/png_write.h"
#include "material/dispersion.h"
#include "material/material_eval.h"
#include "math/elementary.h"
#include "world/world_describe.h"

#include <lauxlib.h>
#include <math.h>

/* --- numbers --- */

/* A material at a place, with the names that Lua gives it. */
#define VALUES(X)                                                                                                      \
    X(struct colour, base)                                                                                             \
    X(struct colour, specular)                                                                                         \
    X(struct colour, emission)                                                                                         \
    X(struct colour, sheen)                                                                                            \
    X(struct colour, attenuation)                                                                                      \
    X(double, alpha)                                                                                                   \
    X(double, metallic)                                                                                                \
    X(double, roughness)                                                                                               \
    X(double, ior)                                                                                                     \
    X(double, specular_weight)                                                                                         \
    X(double, transmission)                                                                                            \
    X(double, distance)                                                                                                \
    X(double, coat)                                                                                                    \
    X(double, coat_roughness)                                                                                          \
    X(double, sheen_roughness)                                                                                         \
    X(double, film)                                                                                                    \
    X(double, film_ior)                                                                                                \
    X(double, film_thickness)                                                                                          \
    X(double, dispersion)
#define VALUE_MEMBER(type, name) type name;
#define VALUE_FIELD(type, name) {#name, offsetof(struct values, name), sizeof(type) / sizeof(double)},
struct values {
    VALUES(VALUE_MEMBER)
    bool unlit, is_solid;
    struct vec3 normal;
};

static struct colour mix(struct colour a, struct colour b, double share) {
    return colour_add_scaled(colour_scale(a, 1 - share), b, share);
}

/* 20 over Abbe's number. */
static double dispersion_of(const struct phong *phong, double ior) {
    const double blue = 0.4861327, red = 0.6562725; /* the lines F and C */
    struct dispersion d = phong->dispersion;
    double spread = dispersion_ior(d, ior, blue) - dispersion_ior(d, ior, red);
    return d.amount > 0 && ior > 1 ? math_max(20 * spread / (ior - 1), 0) : 0;
}

/* White light has the colour after the distance. */
static void set_volume(struct colour absorption, struct values *out) {
    double largest = colour_max_abs(absorption);
    out->distance = largest > 0 ? 1 / largest : 0;
    out->attenuation = colour_make(el_exp(-absorption.r * out->distance), el_exp(-absorption.g * out->distance),
                                   el_exp(-absorption.b * out->distance));
}

static double index_of_reflectance(double reflectance) {
    double root = sqrt(math_min(math_max(reflectance, 0), 0.98));
    return (1 + root) / (1 - root);
}

/* The inverse of openpbr_classic. */
static void set_classic(const struct surface_material *material, const struct surface_inputs *in, struct values *out) {
    double ks = colour_max_abs(in->ks), mirrored = in->reflect * ks;
    double exponent = 4 * in->shininess, width = sqrt(2 / (exponent + 2));
    double gloss = math_min(8 * ks / (exponent + 8), 1);
    struct colour tint = ks > 0 ? colour_scale(in->ks, 1 / ks) : colour_all(1);
    bool is_clear = in->refract > 0 || in->fresnel;
    out->base = in->kd;
    out->roughness = mirrored > 0 || is_clear ? in->roughness : sqrt(width);
    out->specular = tint;
    out->ior = index_of_reflectance(mirrored > 0 ? mirrored : gloss);
    out->specular_weight = ks > 0;
    if (is_clear) {
        out->transmission = in->fresnel ? 1 : math_min(in->refract, 1);
        out->base = mix(in->kd, in->ks, out->transmission);
        out->is_solid = in->has_ior;
        out->specular = colour_all(1);
        out->ior = in->has_ior ? in->ior : out->ior;
        out->dispersion = dispersion_of(&material->phong, in->ior);
        set_volume(in->absorption, out);
    } else if (mirrored > 0 && (colour_is_black(in->kd) || mirrored > 0.5)) {
        out->metallic = 1;
        out->base = colour_min(colour_add_scaled(in->kd, in->ks, in->reflect), colour_all(1));
        out->specular = colour_all(1);
        out->ior = 1.5;
        out->specular_weight = 1;
    }
}

static void set_layers(const struct surface_material *material, const struct surface_inputs *in,
                       const struct openpbr *v, struct values *out) {
    struct colour base = mix(colour_scale(in->kd, v->base_weight), v->subsurface_colour, v->subsurface_weight);
    if (in->refract > 0)
        base = mix(base, v->deep ? colour_all(1) : v->transmission_colour, in->refract);
    if (v->coat_weight > 0)
        base = colour_mul(base, mix(colour_all(1), v->coat_colour, v->coat_weight));
    out->base = base;
    out->metallic = v->base_metalness;
    out->roughness = in->roughness;
    out->specular = in->ks;
    out->specular_weight = math_min(v->specular_weight, 1);
    out->ior = math_max(v->specular_ior, 1);
    if (v->specular_weight > 1) { /* glTF has it up to 1: the index changes in its place */
        double root = (out->ior - 1) / (out->ior + 1);
        out->ior = index_of_reflectance(v->specular_weight * root * root);
    }
    out->transmission = in->refract;
    out->is_solid = !v->thin_walled && in->refract > 0;
    out->dispersion = dispersion_of(&material->phong, out->ior);
    set_volume(colour_add(in->absorption, v->transmission_scattering), out);
    out->coat = v->coat_weight;
    out->coat_roughness = v->coat_roughness;
    out->sheen = colour_scale(v->fuzz_colour, v->fuzz_weight);
    out->sheen_roughness = v->fuzz_roughness;
    out->film = v->film_weight;
    out->film_ior = v->film_ior;
    out->film_thickness = 1000 * v->film_thickness;
}

static const struct transfer_function srgb = {.kind = TRANSFER_SRGB};

struct colour gltf_light_of(const struct gltf_painter *p, struct colour colour) {
    colour = colour_max(colour, colour_all(0));
    return p->linear ? colour : transfer_decode_colour(srgb, colour);
}

static struct values values_at(const struct gltf_painter *p, uint32_t index, const struct hit *hit) {
    const struct world *world = p->world;
    const struct surface_material *material = &world->surfaces.materials[index];
    struct values out = {.specular = {1, 1, 1}, .specular_weight = 1, .ior = 1.5};
    struct surface_inputs in;
    material_inputs_at(&world->surfaces, material, hit, &in);
    if (material->has_layers) {
        struct openpbr layers = material->openpbr;
        openpbr_read(&world->surfaces, material, hit, &layers);
        set_layers(material, &in, &layers, &out);
    } else {
        set_classic(material, &in, &out);
    }
    out.base = gltf_light_of(p, colour_min(out.base, colour_all(1)));
    out.specular = gltf_light_of(p, out.specular);
    out.sheen = gltf_light_of(p, out.sheen);
    double brightest = math_max(colour_max_abs(in.emission), 1);
    out.emission = colour_scale(gltf_light_of(p, colour_scale(in.emission, 1 / brightest)), brightest);
    out.alpha = math_min(math_max(in.opacity, 0), 1);
    out.unlit = in.unlit;
    out.normal = in.normal;
    return out;
}

/* --- what varies --- */

enum { BY_VERTEX = 1 << TEXTURE_VERTEX_COLOUR, BY_IMAGE = 1 << TEXTURE_IMAGE };
enum { VARIES = BY_IMAGE | 1 << TEXTURE_MARBLE | 1 << TEXTURE_WOOD | 1 << TEXTURE_FUNCTION };

/* The kinds of the textures of an input, as bits. */
static unsigned kinds_of(const struct world *world, uint32_t program) {
    const struct texture_tables *tables = &world->surfaces.textures;
    unsigned kinds = 0;
    if (program == TEXTURE_NONE)
        return 0;
    for (uint32_t i = 0; i < tables->programs[program].count; i++)
        kinds |= 1U << tables->instructions[tables->programs[program].first + i].kind;
    return kinds;
}

static unsigned kinds_of_inputs(const struct world *world, uint32_t material, const enum material_input *inputs,
                                size_t count) {
    unsigned kinds = 0;
    for (size_t i = 0; i < count; i++)
        kinds |= kinds_of(world, world->surfaces.materials[material].inputs[inputs[i]]);
    return kinds;
}

/* The inputs of each picture of a material. */
static const enum material_input of_base[] = {
    INPUT_KD, INPUT_OPACITY, INPUT_BASE_WEIGHT, INPUT_REFRACT, INPUT_SUBSURFACE_COLOUR, INPUT_TRANSMISSION_COLOUR,
    INPUT_KS, INPUT_REFLECT};
static const enum material_input of_rough[] = {INPUT_ROUGHNESS, INPUT_METALNESS, INPUT_SHININESS};
static const enum material_input of_emission[] = {INPUT_EMISSION};
#define KINDS(world, material, inputs) kinds_of_inputs(world, material, inputs, sizeof(inputs) / sizeof *(inputs))

static unsigned kinds_of_bumps(const struct world *world, uint32_t material) {
    const struct surface_material *m = &world->surfaces.materials[material];
    unsigned kinds = 0;
    for (uint32_t i = 0; i < m->bump_count; i++)
        kinds |= kinds_of(world, world->surfaces.bumps[m->first_bump + i].program);
    return kinds;
}

static unsigned kinds_of_material(const struct world *world, uint32_t material) {
    return KINDS(world, material, of_base) | KINDS(world, material, of_rough) | KINDS(world, material, of_emission) |
           kinds_of_bumps(world, material);
}

/* A product of numbers and of at most one image, which is *image. False: something else. */
static bool find_image(const struct gltf_painter *p, const struct texture *t, const struct phong *numbers,
                       const struct texture_image **image, struct colour *factor) {
    switch (t->operation.kind) {
    case TEXTURE_CONSTANT: {
        struct colour colour = t->operation.constant.colour;
        *factor = colour_mul(*factor, p->linear && t->operation.constant.display ? transfer_decode_colour(srgb, colour)
                                                                                 : colour);
        return true;
    }
    case TEXTURE_PARAMETER:
        *factor = colour_mul(*factor, texture_parameter_colour(t->operation.parameter, numbers));
        return true;
    case TEXTURE_VERTEX_COLOUR:
        return true;
    case TEXTURE_IMAGE: {
        const struct texture_image *own = &t->operation.image;
        bool is_opaque = own->alpha == ALPHA_IGNORED || own->alpha == ALPHA_STRAIGHT ||
                         image_largest(own->image).a >= 1; /* of alpha that is the smallest one */
        bool fits = (own->mapping == MAPPING_UV || own->mapping == MAPPING_BY_SHAPE) && !own->flip_u && !own->second &&
                    own->alpha != ALPHA_ONLY && image_bits(own->image) <= 16;
        if (*image || !is_opaque || !fits)
            return false;
        *image = own;
        *factor = colour_mul(*factor, own->tint);
        return true;
    }
    case TEXTURE_MULTIPLY:
        return t->size < 64 && find_image(p, t->parts[PART_A], numbers, image, factor) &&
               find_image(p, t->parts[PART_B], numbers, image, factor);
    case TEXTURE_MARBLE:
    case TEXTURE_WOOD:
    case TEXTURE_MIX:
    case TEXTURE_MAP:
    case TEXTURE_FUNCTION:
        break;
    }
    return false;
}

/* Pictures that a file has as they are. */
struct copies {
    const struct texture_image *base, *normal;
    struct colour factor;
    double height;
};

static bool find_copies(const struct gltf_painter *p, uint32_t index, struct copies *out) {
    const struct world *world = p->world;
    const struct surface_material *m = &world->surfaces.materials[index];
    const struct material *authored = world->authored.materials[index];
    const struct texture *kd = authored->inputs[INPUT_KD];
    const struct bump *bump = authored->bump;
    unsigned others = KINDS(world, index, of_rough) | KINDS(world, index, of_emission);
    *out = (struct copies){.factor = {1, 1, 1}};
    for (size_t i = 1; i < sizeof of_base / sizeof *of_base; i++)
        others |= kinds_of(world, m->inputs[of_base[i]]);
    if (others & VARIES)
        return false;
    if (bump) {
        struct colour unused = colour_all(1);
        out->height = bump->height;
        if (bump->below || bump->kind != MATERIAL_NORMAL || bump->of_coat || bump->from_above ||
            !find_image(p, bump->texture, &m->phong, &out->normal, &unused) || !out->normal)
            return false;
    }
    return !kd || !(kinds_of(world, m->inputs[INPUT_KD]) & VARIES) ||
           find_image(p, kd, &m->phong, &out->base, &out->factor);
}

/* --- pictures --- */

static bool put_into_list(void *list, const void *bytes, size_t size, struct error *error) {
    return list_add_bytes(list, bytes, size) || error_no_memory(error, "a picture");
}

static uint8_t encode(double light) {
    const struct tone tone = {.srgb = true};
    return png_write_byte(tone_apply(&tone, light));
}

/* Puts a PNG file into the buffer: its view. False: no memory. */
static bool add_picture(const struct gltf_painter *p, const struct png_source *source, uint32_t *view) {
    struct list png = {0};
    struct error error = {0};
    bool ok = png_encode(source, NULL, put_into_list, &png, &error) &&
              gltf_add_view(p->buffer, png.items, png.count, GLTF_NO_TARGET, view);
    list_destroy(&png);
    return ok;
}

struct copy {
    const struct image *image;
    struct transfer_function transfer;
    bool same; /* its numbers as they are */
};

static void copy_row(void *context, uint32_t y, uint8_t *line) {
    const struct copy *copy = context;
    for (uint32_t x = 0; x < image_width(copy->image); x++, line += 4) {
        const struct rgba texel = image_texel(copy->image, x, y);
        const double colour[3] = {texel.r, texel.g, texel.b};
        for (int k = 0; k < 3; k++)
            line[k] = copy->same ? png_write_byte(colour[k]) : encode(transfer_decode(copy->transfer, colour[k]));
        line[3] = 255;
    }
}

/* Of several textures with the picture, one is copied. */
static bool copy_image(const struct gltf_painter *p, const struct texture_image *image, bool is_colour,
                       uint32_t *view) {
    struct copy copy = {.image = image->image, .transfer = p->linear ? texture_image_transfer(image, true) : srgb};
    copy.same = !is_colour || (copy.transfer.kind == TRANSFER_SRGB && image_bits(image->image) == 8);
    const struct png_source source = {.width = image_width(image->image),
                                      .height = image_height(image->image),
                                      .bytes = copy_row,
                                      .context = &copy,
                                      .alpha = true,
                                      .srgb = is_colour};
    const uint64_t key = (uint64_t)(uintptr_t)image->image << 1 | is_colour;
    const uint32_t *known = key_map_find(p->images, key);
    *view = known ? *known : GLTF_NONE;
    return known || (add_picture(p, &source, view) && key_map_add(p->images, key, *view));
}

/* --- baking --- */

struct texel {
    float base[4], rough, metal, emission[3], normal[3];
};

struct baking {
    const struct gltf_painter *painter;
    const struct gltf_surface *surface;
    uint32_t primitive, size; /* of the picture */
    uint32_t *owners;         /* by texel: the triangle and 1, or 0 */
    struct texel *texels;
    struct world_scratch *scratches;
};

/* The weights of the corners at a place in the unit square. */
static void weights_at(const struct baking *b, const struct gltf_triangle *t, double u, double v, double out[3]) {
    const struct gltf_vertex *all = gltf_vertices(b->surface);
    const float *o = all[t->vertex[0]].uv, *p = all[t->vertex[1]].uv, *q = all[t->vertex[2]].uv;
    double px = (double)p[0] - (double)o[0], py = (double)p[1] - (double)o[1], qx = (double)q[0] - (double)o[0],
           qy = (double)q[1] - (double)o[1], x = u - (double)o[0], y = v - (double)o[1];
    double area = px * qy - py * qx;
    out[1] = area != 0 ? (x * qy - y * qx) / area : 0;
    out[2] = area != 0 ? (px * y - py * x) / area : 0;
    out[0] = 1 - out[1] - out[2];
}

/* Texels whose middle is on a triangle, then those around it, which filters read. */
static void find_owners(const struct baking *b, bool rim) {
    const double size = b->size;
    for (size_t i = 0; i < b->surface->triangles.count; i++) {
        const struct gltf_triangle *t = &gltf_triangles(b->surface)[i];
        double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        for (int k = 0; k < 6; k++) {
            double x = size * (double)gltf_vertices(b->surface)[t->vertex[k / 2]].uv[k % 2];
            low[k % 2] = math_min(low[k % 2], x);
            high[k % 2] = math_max(high[k % 2], x);
        }
        double margin = rim ? 1.5 : 0,
               slack = 1e-6 + margin / math_max(math_max(high[0] - low[0], high[1] - low[1]), 1);
        uint32_t x1 = (uint32_t)math_min(math_max(high[0] + margin + 0.5, 0), size),
                 y1 = (uint32_t)math_min(math_max(high[1] + margin + 0.5, 0), size);
        for (uint32_t y = (uint32_t)math_max(low[1] - margin - 0.5, 0); y < y1; y++)
            for (uint32_t x = (uint32_t)math_max(low[0] - margin - 0.5, 0); x < x1; x++) {
                uint32_t *owner = &b->owners[y * b->size + x];
                double w[3];
                weights_at(b, t, (x + 0.5) / size, (y + 0.5) / size, w);
                if (*owner == 0 && w[0] >= -slack && w[1] >= -slack && w[2] >= -slack)
                    *owner = (uint32_t)i + 1;
            }
    }
}

/* The hit of the exact surface near a place on a triangle. */
static bool find_hit(const struct baking *b, const struct gltf_triangle *t, const double w[3],
                     struct world_scratch *scratch, struct hit *hit) {
    const struct world *world = b->painter->world;
    const struct gltf_vertex *all = gltf_vertices(b->surface);
    struct transform map = world_placement(world, b->primitive, 0);
    struct vec3 c[3], point = vec3_all(0);
    if (b->surface->is_unit)
        map = transform_compose(&map, &b->surface->object_from_surface);
    for (int k = 0; k < 3; k++) {
        c[k] = gltf_point(all[t->vertex[k]].point);
        point = vec3_add_scaled(point, c[k], w[k]);
    }
    struct vec3 normal = vec3_normalize(vec3_cross(vec3_sub(c[1], c[0]), vec3_sub(c[2], c[0])));
    for (double height = 2 * b->surface->tolerance; height < 100 * b->surface->tolerance; height *= 8) {
        struct vec3 from = affine_point(&map.forward, vec3_add_scaled(point, normal, height));
        struct vec3 to = affine_point(&map.forward, vec3_add_scaled(point, normal, -height));
        struct ray ray = {.origin = from, .direction = vec3_sub(to, from), .t_max = 1};
        struct crossing crossing;
        if (world_nearest_of(world, b->primitive, &ray, scratch, &crossing)) {
            world_describe(world, &ray, b->primitive, &crossing, hit);
            return true;
        }
    }
    return false;
}

/* The turned normal in the frame of u and v. */
static void frame_normal(const struct baking *b, const struct gltf_triangle *t, const struct hit *hit,
                         struct vec3 turned, float out[3]) {
    struct transform map = world_placement(b->painter->world, b->primitive, 0);
    struct vec3 directions[2];
    if (b->surface->is_unit)
        map = transform_compose(&map, &b->surface->object_from_surface);
    gltf_directions(b->surface, t, &map.forward, directions);
    struct vec3 along = directions[0], up = directions[1];
    along = vec3_normalize(vec3_add_scaled(along, hit->normal, -vec3_dot(along, hit->normal)));
    struct vec3 across = vec3_cross(hit->normal, along);
    across = vec3_dot(across, up) < 0 ? vec3_negate(across) : across;
    out[0] = (float)vec3_dot(turned, along);
    out[1] = (float)vec3_dot(turned, across);
    out[2] = (float)vec3_dot(turned, hit->normal);
}

static void set_colour(float out[3], struct colour colour) {
    for (int k = 0; k < 3; k++)
        out[k] = (float)colour_get(colour, k);
}

static bool bake_at(const struct baking *b, const struct gltf_triangle *t, const double w[3],
                    struct world_scratch *scratch, struct texel *out) {
    struct hit hit;
    if (!find_hit(b, t, w, scratch, &hit))
        return false;
    const struct values at = values_at(b->painter, hit.material, &hit);
    set_colour(out->base, at.base);
    out->base[3] = (float)at.alpha;
    out->rough = (float)math_min(math_max(at.roughness, 0), 1);
    out->metal = (float)math_min(math_max(at.metallic, 0), 1);
    set_colour(out->emission, at.emission);
    frame_normal(b, t, &hit, at.normal, out->normal);
    return true;
}

static void bake_row(void *context, uint32_t y, int worker) {
    const struct baking *b = context;
    for (uint32_t x = 0; x < b->size; x++) {
        uint32_t owner = b->owners[y * b->size + x];
        double w[3], sum = 0;
        if (owner == 0)
            continue;
        const struct gltf_triangle *t = &gltf_triangles(b->surface)[owner - 1];
        weights_at(b, t, (x + 0.5) / b->size, (y + 0.5) / b->size, w);
        for (int k = 0; k < 3; k++)
            sum += w[k] = math_max(w[k], 1e-4);
        for (int k = 0; k < 3; k++)
            w[k] /= sum;
        if (!bake_at(b, t, w, &b->scratches[worker], &b->texels[y * b->size + x]))
            b->owners[y * b->size + x] = 0;
    }
}

struct baked {
    const struct baking *baking;
    enum gltf_map which;
    double strongest;
};

static void baked_row(void *context, uint32_t y, uint8_t *line) {
    const struct baked *baked = context;
    const uint32_t size = baked->baking->size;
    /* The first row of a picture is the upper one. */
    size_t i = (size_t)(size - 1 - y) * size;
    for (const size_t end = i + size; i < end; i++, line += 4) {
        const struct texel *at = &baked->baking->texels[i];
        const float rough[3] = {1, at->rough, at->metal};
        for (int k = 0; k < 3; k++)
            line[k] = baked->which == GLTF_BASE       ? encode((double)at->base[k])
                      : baked->which == GLTF_EMISSION ? encode((double)at->emission[k] / baked->strongest)
                      : baked->which == GLTF_ROUGH    ? png_write_byte((double)rough[k])
                                                      : png_write_byte((double)at->normal[k] / 2 + 0.5);
        line[3] = baked->which == GLTF_BASE && baked->baking->owners[i] ? png_write_byte((double)at->base[3]) : 255;
    }
}

static bool add_all_baked(const struct baking *b, unsigned maps, struct gltf_paint *out) {
    bool ok = true;
    for (size_t i = 0; i < (size_t)b->size * b->size; i++) {
        double alpha = (double)b->texels[i].base[3];
        for (int k = 0; k < 3; k++)
            out->strongest = math_max(out->strongest, (double)b->texels[i].emission[k]);
        out->has_holes = out->has_holes || (b->owners[i] && alpha < 1);
        out->has_veils = out->has_veils || (b->owners[i] && alpha > 0.02 && alpha < 0.98);
    }
    for (int k = 0; k < GLTF_MAP_COUNT; k++) {
        struct baked baked = {b, (enum gltf_map)k, out->strongest};
        const struct png_source source = {.width = b->size,
                                          .height = b->size,
                                          .bytes = baked_row,
                                          .context = &baked,
                                          .alpha = true,
                                          .srgb = k == GLTF_BASE || k == GLTF_EMISSION};
        if (maps & 1U << k && (k != GLTF_EMISSION || out->strongest > 0))
            ok = ok && add_picture(b->painter, &source, &out->maps[k]);
    }
    return ok;
}

/* Too many triangles for a picture: each vertex has its colour. */
static bool bake_vertices(const struct baking *b, struct gltf_surface *surface, struct gltf_paint *out) {
    uint8_t *done = mem_alloc_zero(surface->vertices.count, 1);
    for (size_t i = 0; done && i < 3 * surface->triangles.count; i++) {
        const struct gltf_triangle *t = &gltf_triangles(surface)[i / 3];
        double w[3] = {0.005, 0.005, 0.005};
        struct texel texel;
        w[i % 3] = 0.99;
        if (!done[t->vertex[i % 3]] && bake_at(b, t, w, &b->scratches[0], &texel)) {
            memcpy(gltf_vertices(surface)[t->vertex[i % 3]].colour, texel.base, sizeof(float[3]));
            done[t->vertex[i % 3]] = 1;
        }
    }
    surface->has_colours = out->by_vertex = true;
    mem_free(done);
    return done != NULL;
}

static bool bake(struct baking *b, struct gltf_surface *surface, unsigned maps, struct gltf_paint *out,
                 struct error *error) {
    const size_t texels = (size_t)b->size * b->size;
    struct pool *pool = b->painter->pool;
    const int workers = pool_workers(pool);
    b->owners = mem_alloc_zero(texels, sizeof *b->owners);
    b->texels = mem_alloc_zero(texels, sizeof *b->texels);
    b->scratches = mem_alloc_zero((size_t)workers, sizeof *b->scratches);
    bool ok = b->owners && b->texels && b->scratches;
    for (int i = 0; ok && i < workers; i++)
        ok = world_scratch_init(&b->scratches[i], b->painter->world);
    out->baked = true;
    if (ok && !surface->is_unfolded && !gltf_surface_unfold(surface, b->size, GLTF_BAKED_CELL)) {
        ok = bake_vertices(b, surface, out);
    } else if (ok) {
        find_owners(b, false);
        find_owners(b, true);
        if (!pool_run(pool, b->size, bake_row, b))
            (void)error_set(error, ERROR_CANCELLED, "stopped while textures were baked");
        ok = add_all_baked(b, maps, out);
    }
    for (int i = 0; b->scratches && i < workers; i++)
        world_scratch_destroy(&b->scratches[i]);
    mem_free(b->owners);
    mem_free(b->texels);
    mem_free(b->scratches);
    return (ok && error->kind == ERROR_NONE) || (error->kind == ERROR_NONE && error_no_memory(error, "a picture"));
}

static bool is_in_square(const struct gltf_surface *surface) {
    bool fits = surface->has_uv;
    for (size_t i = 0; fits && i < 2 * surface->vertices.count; i++) {
        float x = gltf_vertices(surface)[i / 2].uv[i % 2];
        fits = x >= 0 && x <= 1;
    }
    return fits;
}

bool gltf_paint_make(const struct gltf_painter *painter, uint32_t primitive, struct gltf_surface *surface,
                     struct gltf_paint *out, struct error *error) {
    const struct world *world = painter->world;
    unsigned maps = 0, kinds = 0;
    bool bakes = false;
    uint32_t last = GLTF_NONE;
    *out = (struct gltf_paint){.maps = {GLTF_NONE, GLTF_NONE, GLTF_NONE, GLTF_NONE}};
    for (size_t i = 0; surface->has_colours && i < surface->vertices.count; i++) {
        float *c = gltf_vertices(surface)[i].colour;
        set_colour(c, gltf_light_of(painter, colour_make((double)c[0], (double)c[1], (double)c[2])));
    }
    for (size_t i = 0; i < surface->triangles.count; i++) {
        uint32_t m = gltf_triangles(surface)[i].material;
        struct copies copies;
        if (m == last)
            continue;
        last = m;
        bakes =
            bakes || ((kinds_of_material(world, m) & VARIES) && !(surface->has_uv && find_copies(painter, m, &copies)));
        kinds |= kinds_of_material(world, m);
        maps |= KINDS(world, m, of_base) & VARIES ? 1U << GLTF_BASE | 1U << GLTF_ROUGH : 0;
        maps |= KINDS(world, m, of_rough) & VARIES ? 1U << GLTF_ROUGH | 1U << GLTF_BASE : 0;
        maps |= KINDS(world, m, of_emission) & VARIES ? 1U << GLTF_EMISSION : 0;
        maps |= kinds_of_bumps(world, m) ? 1U << GLTF_NORMAL : 0;
    }
    /* Images follow u and v, also where several places have the same. */
    surface->is_unfolded = surface->is_unfolded || ((kinds & VARIES) == BY_IMAGE && is_in_square(surface));
    struct baking baking = {
        .painter = painter, .surface = surface, .primitive = primitive, .size = gltf_baked_size(world)};
    return !bakes || bake(&baking, surface, maps, out, error);
}

/* --- for Lua --- */

/* A picture that the file has as it is; `map`: of its coordinates, unless it is the identity. */
static void set_copy(lua_State *L, const char *field, const struct gltf_painter *p, const struct texture_image *image) {
    static const char *const wraps[] = {IMAGE_WRAPS(LIST_WORD)};
    uint32_t view;
    if (!image)
        return;
    if (!copy_image(p, image, strcmp(field, "base_copy") == 0, &view))
        luaL_error(L, GLTF_NO_MEMORY);
    lua_newtable(L);
    gltf_push_view(L, p->buffer, view);
    lua_setfield(L, -2, "picture");
    field_flag(L, "nearest", image->filter == IMAGE_NEAREST);
    field_text(L, "wrap_u", wraps[image->wrap]);
    field_text(L, "wrap_v", wraps[image->apart ? image->wrap_v : image->wrap]);
    const double map[6] = {image->scale[0], image->scale[1],  image->cross[0],
                           image->cross[1], image->offset[0], image->offset[1]};
    if (image->apart)
        field_numbers(L, "map", map, 6);
    lua_setfield(L, -2, field);
}

void gltf_paint_push(lua_State *L, const struct gltf_painter *painter, uint32_t material,
                     const struct gltf_surface *surface, const struct gltf_paint *paint) {
    static const struct {
        const char *name;
        size_t offset;
        int count;
    } fields[] = {VALUES(VALUE_FIELD)};
    const struct world *world = painter->world;
    const struct surface_material *m = &world->surfaces.materials[material];
    const struct openpbr *layers = &m->openpbr;
    const char *name = world->authored.materials[material]->name;
    const struct hit nowhere = {.normal = {0, 1, 0}, .normal_geometric = {0, 1, 0}, .view = {0, 1, 0}, .front = true};
    const bool varies = kinds_of_material(world, material) & VARIES;
    struct values v = values_at(painter, material, &nowhere);
    struct copies copies = {.base = NULL};
    bool copied = varies && !paint->baked && find_copies(painter, material, &copies);
    if (copied && copies.base)
        v.base = gltf_light_of(painter, colour_min(copies.factor, colour_all(1)));
    lua_newtable(L);
    field_text(L, "name", name ? name : "");
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
        const double *numbers = (const double *)(const void *)((const char *)&v + fields[i].offset);
        if (fields[i].count == 1)
            field_number(L, fields[i].name, *numbers);
        else
            field_numbers(L, fields[i].name, numbers, fields[i].count);
    }
    field_number(L, "height", copied && copies.normal ? copies.height : 1);
    field_flag(L, "unlit", v.unlit);
    field_flag(L, "is_solid", v.is_solid);
    field_flag(L, "two_sided", m->phong.two_sided);
    field_flag(L, "is_baked", varies && paint->baked);
    field_flag(L, "has_vertex_colours", (KINDS(world, material, of_base) & BY_VERTEX) && surface->has_colours);
    field_flag(L, "scatters",
               m->has_layers && (layers->subsurface_weight > 0 || colour_max_abs(layers->transmission_scattering) > 0));
    field_flag(L, "is_brushed", m->has_layers && (layers->specular_anisotropy > 0 || layers->coat_anisotropy > 0));
    field_flag(L, "is_filled", m->holds_medium || m->filled);
    set_copy(L, "base_copy", painter, copied ? copies.base : NULL);
    set_copy(L, "normal_copy", painter, copied ? copies.normal : NULL);
}
