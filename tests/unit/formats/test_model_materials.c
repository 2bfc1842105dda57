/* The effect of the maps of MTL and glTF materials on a surface: inputs of the BSDF at a hit, by the formulas of the
 * formats. */
#include "tests/unit/model_makers.h"
#include "tests/unit/surface_makers.h"

#include "formats/model_node.h"
#include "image/png_write.h"
#include "material/material_inputs.h"
#include "material/openpbr.h"

static void even_row(void *context, uint32_t y, uint8_t *line) {
    const uint8_t *colour = context;
    (void)y;
    for (int x = 0; x < 16; x++)
        memcpy(line + (ptrdiff_t)3 * x, colour, 3);
}

/* Increases to the right by 10 of 255 per texel. */
static void ramp_row(void *context, uint32_t y, uint8_t *line) {
    (void)context, (void)y;
    for (int x = 0; x < 16; x++)
        memset(line + (ptrdiff_t)3 * x, 10 * x, 3);
}

static void write_even(const char *name, uint8_t r, uint8_t g, uint8_t b) {
    uint8_t colour[3] = {r, g, b};
    struct error error = {0};
    CHECK(png_write_from(FILE_AT(in_folder(name)),
                         &(struct png_source){.width = 16, .height = 16, .bytes = even_row, .context = colour}, NULL,
                         &error));
}

/* In the middle of a square as large as its picture, seen from the front. */
static struct hit middle(void) {
    return (struct hit){.has_uv = true,
                        .u = 0.5,
                        .v = 0.5,
                        .normal = {0, 0, 1},
                        .normal_geometric = {0, 0, 1},
                        .raise = {0, 0, 1},
                        .dpdu = {1, 0, 0},
                        .dpdv = {0, 1, 0},
                        .has_second = true,
                        .second = {3.5 / 16, 0.25, {1, 0, 0}, {0, 1, 0}}};
}

static struct colour vertex_colour = {1, 1, 1};

/* inputs, bsdf: what a hit in the middle has. */
static bool surface_of_file(const char *name, const char *material, struct surface_inputs *inputs, struct bsdf *bsdf) {
    struct assets assets = {0};
    struct scene scene;
    struct error error = {0};
    struct model_options options = {0};
    struct model_placing placing = {.name = "p"};
    bool fresh, found = false;
    scene_init(&scene, &assets);
    struct model *model = model_asset(&assets, in_folder(name), name, &options, &fresh, &error);
    struct node *node = model ? model_add_nodes(&scene, model, &placing, &error) : NULL;
    CHECK_TEXT(error.text, "");
    for (uint32_t i = 0; node && i < node->slot_count; i++) {
        if (!node->slots[i] || strcmp(node->slot_names[i], material) != 0)
            continue;
        struct hit hit = middle();
        hit.view = (struct vec3){0, 0, 1};
        hit.front = true;
        hit.has_colour = true;
        hit.colour = vertex_colour;
        surface_inputs_of(node->slots[i], &hit, inputs);
        surface_eval(node->slots[i], &hit, NULL, NULL, bsdf);
        found = true;
    }
    scene_destroy(&scene);
    assets_destroy(&assets);
    CHECK(found);
    return found;
}

static bool inputs_of_file(const char *name, const char *material, struct surface_inputs *inputs) {
    struct bsdf bsdf;
    return surface_of_file(name, material, inputs, &bsdf);
}

TEST(colours_of_vertices_multiply_the_picture_of_a_material_and_its_kd) {
    write_even("colour 1.png", 51, 102, 255);
    test_write_text(in_folder("c.mtl"), "newmtl picture\nKd 1 1 .5\nmap_Kd colour 1.png\nnewmtl plain\nKd .2 1 1\n");
    test_write_text(in_folder("c.obj"), "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nvt 0 0\nmtllib c.mtl\n"
                                        "usemtl picture\nf 1/1 2/1 3/1\nusemtl plain\nf 1 2 3\n");
    struct surface_inputs inputs = {0};
    vertex_colour.r = 0.5;
    if (inputs_of_file("c.obj", "picture", &inputs)) {
        CHECK_NEAR(inputs.kd.r, 0.5 * 0.2, 1e-12);
        CHECK_NEAR(inputs.kd.g, 0.4, 1e-12);
        CHECK_NEAR(inputs.kd.b, 0.5, 1e-12);
    }
    if (inputs_of_file("c.obj", "plain", &inputs))
        CHECK_NEAR(inputs.kd.r, 0.1, 1e-12);
}

TEST(mtl_maps_of_highlight_emission_opacity_bumps_and_normals_are_shown) {
    struct error error = {0};
    write_even("colour 1.png", 51, 102, 255);
    write_even("flat.png", 128, 128, 255);
    write_even("tilt.png", 204, 128, 230);
    CHECK(png_write_from(FILE_AT(in_folder("ramp.png")),
                         &(struct png_source){.width = 16, .height = 16, .bytes = ramp_row}, NULL, &error));
    test_write_text(in_folder("m.mtl"), "newmtl ks\nKd 1 1 1\nKs .5 .5 .5\nmap_Ks colour 1.png\n"
                                        "newmtl ks alone\nKd 1 1 1\nmap_Ks colour 1.png\n"
                                        "newmtl dull\nKd 1 1 1\nKs 1 1 1\nillum 1\nmap_Ks colour 1.png\n"
                                        "newmtl ke\nKd 0 0 0\nKe 2 2 2\nmap_Ke colour 1.png\n"
                                        "newmtl ke alone\nKd 0 0 0\nmap_Ke colour 1.png\n"
                                        "newmtl glow\nKe 0 3 0\n"
                                        "newmtl holes\nKd 1 1 1\nmap_d colour 1.png\n"
                                        "newmtl bump\nKd 1 1 1\nmap_Bump -bm 2 ramp.png\n"
                                        "newmtl other bump\nKd 1 1 1\nbump ramp.png\n"
                                        "newmtl flat\nKd 1 1 1\nnorm flat.png\n"
                                        "newmtl tilt\nKd 1 1 1\nmap_Kd colour 1.png\nnorm tilt.png\n");
    test_write_text(in_folder("m.obj"),
                    SQUARE "mtllib m.mtl\nusemtl ks\nf 1 2 3\nusemtl ks alone\nf 1 2 3\nusemtl dull\nf 1 2 3\n"
                           "usemtl ke\nf 1 2 3\nusemtl ke alone\nf 1 2 3\nusemtl glow\nf 1 2 3\nusemtl holes\nf 1 2 3\n"
                           "usemtl bump\nf 1 2 3\nusemtl other bump\nf 1 2 3\nusemtl flat\nf 1 2 3\n"
                           "usemtl tilt\nf 1 2 3\n");
    struct surface_inputs inputs = {0};
    if (inputs_of_file("m.obj", "ks", &inputs)) {
        CHECK_NEAR(inputs.ks.r, 0.1, 1e-12);
        CHECK_NEAR(inputs.ks.g, 0.2, 1e-12);
        CHECK_NEAR(inputs.ks.b, 0.5, 1e-12);
    }
    if (inputs_of_file("m.obj", "ks alone", &inputs))
        CHECK_NEAR(inputs.ks.g, 0.4, 1e-12);
    if (inputs_of_file("m.obj", "dull", &inputs))
        CHECK_NEAR(inputs.ks.b, 0, 0);
    if (inputs_of_file("m.obj", "ke", &inputs)) {
        CHECK_NEAR(inputs.emission.r, 0.4, 1e-12);
        CHECK_NEAR(inputs.emission.b, 2, 1e-12);
    }
    if (inputs_of_file("m.obj", "ke alone", &inputs))
        CHECK_NEAR(inputs.emission.r, 0.2, 1e-12);
    if (inputs_of_file("m.obj", "glow", &inputs))
        CHECK_NEAR(inputs.emission.g, 3, 0);
    if (inputs_of_file("m.obj", "holes", &inputs))
        CHECK_NEAR(inputs.opacity, (0.2 + 0.4 + 1) / 3, 1e-12);
    double slope = 10.0 / 255 * 16 * BUMP_HEIGHT;
    if (inputs_of_file("m.obj", "bump", &inputs))
        CHECK_NEAR(inputs.normal.x / inputs.normal.z, -2 * slope, 1e-12);
    if (inputs_of_file("m.obj", "other bump", &inputs))
        CHECK_NEAR(inputs.normal.x / inputs.normal.z, -slope, 1e-12);
    if (inputs_of_file("m.obj", "flat", &inputs))
        CHECK_NEAR(inputs.normal.z, 1, 0);
    if (inputs_of_file("m.obj", "tilt", &inputs)) {
        CHECK_NEAR(inputs.normal.x / inputs.normal.z, (2 * 76.0 / 255) / (2 * 230.0 / 255 - 1), 1e-12);
        CHECK_NEAR(inputs.kd.g, 0.4, 1e-12);
    }
}

#ifdef HAVE_JANSSON

#define TRIANGLE_URI "data:application/gltf-buffer;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAECAA=="

/* One triangle for each of four materials; the images are in the same folder. */
static void write_two_materials(const char *materials) {
    char text[5000];
    (void)snprintf(text, sizeof text,
                   "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":40,\"uri\":\"" TRIANGLE_URI
                   "\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,"
                   "\"byteLength\":3}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,"
                   "\"type\":\"VEC3\"},{\"bufferView\":1,\"componentType\":5121,\"count\":3,\"type\":\"SCALAR\"}],"
                   "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,\"material\":0},"
                   "{\"attributes\":{\"POSITION\":0},\"indices\":1,\"material\":1}]}],"
                   "\"images\":[{\"uri\":\"colour%%201.png\"},{\"uri\":\"tilt.png\"}],"
                   "\"textures\":[{\"source\":0},{\"source\":1}],\"materials\":[%s]}",
                   materials);
    test_write_text(in_folder("m.gltf"), text);
}

static struct colour weight_of(const struct bsdf *bsdf, enum lobe_kind kind) {
    struct colour sum = {0, 0, 0};
    for (int i = 0; i < bsdf->count; i++)
        if (bsdf->lobes[i].kind == kind)
            sum = colour_add(sum, bsdf->lobes[i].weight);
    return sum;
}

TEST(gltf_maps_of_metal_roughness_emission_and_normals_are_shown) {
    write_even("colour 1.png", 51, 102, 255);
    write_even("tilt.png", 204, 128, 230);
    write_two_materials(
        "{\"name\":\"a\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,0.5,0.25,1],\"metallicFactor\":0.75,"
        "\"roughnessFactor\":0.5,\"metallicRoughnessTexture\":{\"index\":0}},\"emissiveFactor\":[1,0.5,0.5],"
        "\"emissiveTexture\":{\"index\":0},\"normalTexture\":{\"index\":1,\"scale\":0.5}},"
        "{\"name\":\"b\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,0.5,0.25,0.8],"
        "\"baseColorTexture\":{\"index\":0}},\"emissiveTexture\":{\"index\":0},\"alphaMode\":\"MASK\"}");
    struct surface_inputs inputs = {0};
    struct bsdf bsdf;
    if (surface_of_file("m.gltf", "a", &inputs, &bsdf)) {
        CHECK_NEAR(inputs.kd.g, 0.5, 1e-12);
        CHECK_NEAR(inputs.ks.b, 1, 0);
        CHECK_NEAR(inputs.roughness, 0.5 * 0.4, 1e-12);
        CHECK_NEAR(weight_of(&bsdf, LOBE_METAL).r, 0.75, 1e-12); /* times 1, the blue of the picture */
        CHECK_NEAR(inputs.emission.r, 0.2, 1e-12);
        CHECK_NEAR(inputs.emission.b, 0.5, 1e-12);
        CHECK_NEAR(inputs.normal.x / inputs.normal.z, 0.5 * (2 * 76.0 / 255) / (2 * 230.0 / 255 - 1), 1e-12);
        CHECK_NEAR(inputs.opacity, 1, 0);
    }
    if (surface_of_file("m.gltf", "b", &inputs, &bsdf)) {
        CHECK_NEAR(inputs.emission.r, 0, 0); /* the factor is black */
        CHECK_NEAR(inputs.opacity, 1, 0);    /* alpha 0.8 is not cut at 0.5 */
        CHECK_NEAR(inputs.kd.r, 0.2, 1e-12);
        CHECK_NEAR(inputs.kd.g, 0.5 * 0.4, 1e-12);
        CHECK_NEAR(weight_of(&bsdf, LOBE_METAL).r, 1, 1e-12);
    }
}

TEST(gltf_pictures_by_second_or_turned_coordinates_are_looked_up_there) {
    struct error error = {0};
    CHECK(png_write_from(FILE_AT(in_folder("tilt.png")),
                         &(struct png_source){.width = 16, .height = 16, .bytes = ramp_row}, NULL, &error));
    write_even("colour 1.png", 51, 102, 255);
    write_two_materials(
        "{\"name\":\"a\",\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":1,\"texCoord\":1}},"
        "\"emissiveFactor\":[1,1,1],\"emissiveTexture\":{\"index\":1,\"extensions\":{\"KHR_texture_transform\":{"
        "\"scale\":[0.5,1]}}}},{\"name\":\"b\",\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":1,"
        "\"extensions\":{\"KHR_texture_transform\":{\"rotation\":1.5707963267948966,\"texCoord\":1}}}}}");
    struct surface_inputs inputs = {0};
    if (inputs_of_file("m.gltf", "a", &inputs)) {
        CHECK_NEAR(inputs.kd.r, 30.0 / 255, 1e-12);
        CHECK_NEAR(inputs.emission.r, 35.0 / 255, 1e-12);
    }
    if (inputs_of_file("m.gltf", "b", &inputs)) /* u is v, which counts from the upper edge */
        CHECK_NEAR(inputs.kd.r, 115.0 / 255, 1e-12);
}

TEST(gltf_materials_of_specular_colour_and_gloss_are_layers) {
    write_even("colour 1.png", 128, 102, 204);
    write_even("tilt.png", 26, 13, 13);
    write_two_materials(
        "{\"name\":\"a\",\"extensions\":{\"KHR_materials_pbrSpecularGlossiness\":{\"diffuseFactor\":[0.5,1,1,1],"
        "\"specularFactor\":[0.25,0.125,0.25],\"glossinessFactor\":0.75,\"diffuseTexture\":{\"index\":0}}}},"
        "{\"name\":\"b\",\"extensions\":{\"KHR_materials_pbrSpecularGlossiness\":{\"glossinessFactor\":0.75,"
        "\"diffuseTexture\":{\"index\":1},\"specularGlossinessTexture\":{\"index\":0}}}}");
    struct surface_inputs inputs = {0};
    struct bsdf bsdf;
    if (surface_of_file("m.gltf", "a", &inputs, &bsdf)) {
        CHECK_NEAR(inputs.kd.r, 0.5 * 128 / 255, 1e-12);
        CHECK_NEAR(inputs.ks.g, 0.5, 1e-12);
        CHECK_NEAR(inputs.roughness, 0.25, 1e-12);
        CHECK_NEAR(weight_of(&bsdf, LOBE_METAL).r, 0, 0);
    }
    if (surface_of_file("m.gltf", "b", &inputs, &bsdf)) { /* as bright as a metal */
        CHECK_NEAR(inputs.kd.b, 204.0 / 255, 1e-12);
        CHECK_NEAR(inputs.roughness, 0.25, 1e-12);
        CHECK_NEAR(weight_of(&bsdf, LOBE_METAL).r, 1, 1e-12);
    }
}

/* By the parameters of gr.openpbr_material. */
TEST(a_gltf_mask_without_a_picture_shows_or_hides_the_whole_surface) {
    write_two_materials(
        "{\"name\":\"a\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,1,1,0.4]},\"alphaMode\":\"MASK\"},"
        "{\"name\":\"b\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,1,1,0.4]},"
        "\"alphaMode\":\"MASK\",\"alphaCutoff\":0.3}");
    struct surface_inputs inputs = {0};
    struct bsdf bsdf;
    if (surface_of_file("m.gltf", "a", &inputs, &bsdf))
        CHECK_NEAR(inputs.opacity, 0, 0);
    if (surface_of_file("m.gltf", "b", &inputs, &bsdf))
        CHECK_NEAR(inputs.opacity, 1, 0);
}

TEST(pictures_of_gltf_extensions_that_are_not_read_have_one_warning_each) {
    write_two_materials("{\"name\":\"a\",\"extensions\":{\"KHR_materials_sheen\":{"
                        "\"sheenColorTexture\":{\"index\":0}},\"KHR_materials_volume\":{"
                        "\"thicknessTexture\":{\"index\":0}}}},{\"name\":\"b\"}");
    struct model model = {0};
    struct model_options options = {0};
    struct error error = {0};
    CHECK(model_read(&model, in_folder("m.gltf"), &options, &error));
    CHECK_EQ_INT(model.warning_count, 2);
    CHECK(strstr(model.warnings[0], "the thicknessTexture of KHR_materials_volume is not read"));
    CHECK(strstr(model.warnings[1], "the sheenColorTexture of KHR_materials_sheen is not read"));
    model_destroy(&model);
}

TEST(diffuse_transmission_and_scattering_of_gltf_are_light_under_the_surface) {
    write_two_materials(
        "{\"name\":\"a\",\"extensions\":{\"KHR_materials_diffuse_transmission\":{\"diffuseTransmissionFactor\":0.25,"
        "\"diffuseTransmissionColorFactor\":[1,0.5,0.25]}}},"
        "{\"name\":\"b\",\"extensions\":{\"KHR_materials_diffuse_transmission\":{\"diffuseTransmissionFactor\":1},"
        "\"KHR_materials_volume\":{\"thicknessFactor\":1,\"attenuationDistance\":2,\"attenuationColor\":[1,0.5,0.25]},"
        "\"KHR_materials_volume_scatter\":{\"multiscatterColor\":[1,1,0.5],\"scatterAnisotropy\":0.5}}}");
    struct model model = {0};
    struct model_options options = {0};
    struct error error = {0};
    CHECK(model_read(&model, in_folder("m.gltf"), &options, &error));
    CHECK_TEXT(error.text, "");
    const struct model_material *m = model_materials(&model);
    CHECK_NEAR(m[0].layers.subsurface_weight, 0.25, 0);
    CHECK_NEAR(m[0].layers.subsurface_colour.g, 0.5, 0);
    CHECK(m[0].layers.thin_walled && m[0].layers.subsurface_anisotropy == 1);
    CHECK_NEAR(m[1].layers.subsurface_colour.b, 0.5, 0);
    CHECK_NEAR(m[1].layers.subsurface_anisotropy, 0.5, 0);
    CHECK_NEAR(m[1].layers.subsurface_radius_scale.g, 2 / log(2), 1e-12);
    CHECK_NEAR(m[1].layers.transmission_scattering.g, log(2) / 2, 1e-12);
    CHECK_NEAR(m[1].absorption.g, 0, 1e-12);
    CHECK_NEAR(m[1].layers.transmission_scattering.b, subsurface_albedo(0.5, 0.5) * log(4) / 2, 1e-12);
    model_destroy(&model);
}

TEST(iridescence_dispersion_and_normals_of_the_coat_are_those_of_gltf) {
    write_even("colour 1.png", 51, 102, 255);
    write_two_materials(
        "{\"name\":\"a\",\"extensions\":{\"KHR_materials_iridescence\":{\"iridescenceFactor\":0.5,\"iridescenceIor\":1."
        "5,"
        "\"iridescenceThicknessMinimum\":200,\"iridescenceThicknessMaximum\":600,"
        "\"iridescenceThicknessTexture\":{\"index\":0}},"
        "\"KHR_materials_clearcoat\":{\"clearcoatFactor\":1,\"clearcoatNormalTexture\":{\"index\":0,\"scale\":0.5}}}},"
        "{\"name\":\"b\",\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"roughnessFactor\":0},\"extensions\":{"
        "\"KHR_materials_transmission\":{\"transmissionFactor\":1},\"KHR_materials_dispersion\":{\"dispersion\":0.5},"
        "\"KHR_materials_iridescence\":{\"iridescenceFactor\":1},\"KHR_materials_volume\":{\"thicknessFactor\":1}}}");
    struct model model = {0};
    struct model_options options = {0};
    struct error error = {0};
    CHECK(model_read(&model, in_folder("m.gltf"), &options, &error));
    CHECK_TEXT(error.text, "");
    CHECK_EQ_INT(model.warning_count, 0);
    const struct model_material *m = model_materials(&model);
    CHECK_NEAR(m[0].layers.film_weight, 0.5, 0);
    CHECK_NEAR(m[0].layers.film_ior, 1.5, 0);
    CHECK_NEAR(m[0].layers.film_thickness, 0.6, 1e-15);
    CHECK_EQ_INT(m[0].layer_map_count, 1);
    CHECK_NEAR(m[0].layer_maps[0].factor, 0.6, 1e-15);
    CHECK_NEAR(m[0].layer_maps[0].low, 0.2, 1e-15);
    CHECK_NEAR(m[0].map_coat_normal.strength, 0.5, 0);
    CHECK_NEAR(m[1].layers.film_thickness, 0.4, 1e-15);
    CHECK_NEAR(m[1].layers.film_ior, 1.3, 0);
    CHECK_NEAR(m[1].dispersion, 1 / 40.0, 1e-15); /* Abbe's number is 20 / .5 */
    model_destroy(&model);
    struct surface_inputs inputs = {0};
    struct bsdf bsdf;
    if (surface_of_file("m.gltf", "a", &inputs, &bsdf)) {
        CHECK_NEAR(bsdf.film.weight, 0.5, 0);
        CHECK_NEAR(bsdf.film.thickness, 0.2 + 0.4 * 0.4, 1e-12); /* by green */
        CHECK(weight_of(&bsdf, LOBE_COAT).g > 0);
    }
    if (surface_of_file("m.gltf", "b", &inputs, &bsdf))
        CHECK_NEAR(bsdf.film.thickness, 0.4, 1e-15);
}

TEST(extensions_of_gltf_materials_are_layers_of_openpbr) {
    write_two_materials(
        "{\"name\":\"a\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,1,0.25,0.25],\"metallicFactor\":0,"
        "\"roughnessFactor\":0.25},\"alphaMode\":\"BLEND\",\"emissiveFactor\":[1,0.5,0],\"extensions\":{"
        "\"KHR_materials_clearcoat\":{\"clearcoatFactor\":0.75,\"clearcoatRoughnessFactor\":0.125},"
        "\"KHR_materials_sheen\":{\"sheenColorFactor\":[0.5,0.25,0],\"sheenRoughnessFactor\":0.75},"
        "\"KHR_materials_specular\":{\"specularFactor\":0.5,\"specularColorFactor\":[1,0.5,0]},"
        "\"KHR_materials_emissive_strength\":{\"emissiveStrength\":8}}},"
        "{\"name\":\"b\",\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"roughnessFactor\":0},\"extensions\":{"
        "\"KHR_materials_transmission\":{\"transmissionFactor\":1},\"KHR_materials_ior\":{\"ior\":1.25},"
        "\"KHR_materials_volume\":{\"thicknessFactor\":1,\"attenuationDistance\":2,"
        "\"attenuationColor\":[1,0.5,0.25]}}}");
    struct model model = {0};
    struct model_options options = {0};
    struct error error = {0};
    CHECK(model_read(&model, in_folder("m.gltf"), &options, &error));
    CHECK_TEXT(error.text, "");
    const struct model_material *m = model_materials(&model);
    CHECK_NEAR(m[0].layers.coat_weight, 0.75, 0);
    CHECK_NEAR(m[0].layers.coat_roughness, 0.125, 0);
    CHECK_NEAR(m[0].layers.coat_ior, 1.5, 0);
    CHECK_NEAR(m[0].layers.coat_darkening, 0, 0);
    CHECK_NEAR(m[0].layers.fuzz_weight, 0.5, 0);
    CHECK_NEAR(m[0].layers.fuzz_colour.g, 0.5, 0);
    CHECK_NEAR(m[0].layers.fuzz_roughness, 0.75, 0);
    CHECK_NEAR(m[0].layers.specular_weight, 0.5, 0);
    CHECK_NEAR(m[0].ks.g, 0.5, 0);
    CHECK(m[0].layers.thin_walled && !m[1].layers.thin_walled);
    CHECK_NEAR(m[1].layers.specular_ior, 1.25, 0);
    model_destroy(&model);
    struct surface_inputs inputs = {0};
    struct bsdf bsdf;
    if (surface_of_file("m.gltf", "a", &inputs, &bsdf)) {
        CHECK_NEAR(inputs.opacity, 0.25, 0);
        CHECK_NEAR(inputs.emission.g, 4, 0);
        CHECK(weight_of(&bsdf, LOBE_FUZZ).r > 0);
    }
    if (surface_of_file("m.gltf", "b", &inputs, &bsdf)) {
        CHECK(bsdf.transmits);
        CHECK_NEAR(bsdf.eta, 1 / 1.25, 1e-12);
        CHECK_NEAR(inputs.absorption.r, 0, 0);
        CHECK_NEAR(inputs.absorption.b, log(4) / 2, 1e-12);
    }
}

#endif

TEST(opacity_by_alpha_is_cut_where_a_mask_says) {
    static const double cutoffs[] = {0, 0.3, 0.6}, wanted[] = {0.4, 1, 0};
    uint8_t texels[4 * 4];
    struct error error = {0};
    for (int i = 0; i < 4; i++)
        memcpy(texels + (ptrdiff_t)4 * i, (uint8_t[]){10, 20, 30, 102}, 4);
    struct image *image = image_create("t", 2, 2, 8, texels, &error);
    for (int i = 0; i < 3; i++) {
        struct material base = {.kind = MATERIAL_PHONG}, cut, over;
        struct texture_image picture = {.image = image, .mapping = MAPPING_UV, .alpha = ALPHA_ONLY};
        struct arena arena = {0};
        struct surface_inputs inputs;
        struct hit hit = middle();
        material_derive(&cut, MATERIAL_IMAGE, &base);
        CHECK(material_cut(&cut, &picture, cutoffs[i], &arena, &error));
        surface_inputs_of(&cut, &hit, &inputs);
        CHECK_NEAR(inputs.opacity, wanted[i], 1e-12);
        picture.alpha = ALPHA_IGNORED;
        material_derive(&over, MATERIAL_IMAGE, &cut);
        CHECK(material_cover(&over, INPUT_KD, &picture, &arena, &error));
        surface_inputs_of(&over, &hit, &inputs);
        CHECK_NEAR(inputs.opacity, wanted[i], 1e-12);
        CHECK_NEAR(inputs.kd.g, 20 / 255.0, 1e-12);
        arena_destroy(&arena);
    }
    image_release(image);
}

/* --- pictures that cannot be used --- */

static void check_unusable(const char *name, const char *text, size_t size, const char *reason) {
    char library[400];
    struct assets assets = {0};
    struct scene scene;
    struct error error = {0};
    struct model_placing placing = {.name = "p"};
    bool fresh;
    if (text)
        test_write_file(in_folder(name), text, size);
    (void)snprintf(library, sizeof library,
                   "newmtl a\nKd 0.2 0.4 0.6\nKs 0.3 0.3 0.3\nKe 1 1 1\n"
                   "map_Kd %s\nmap_Ks %s\nmap_Ke %s\nmap_d %s\nmap_bump %s\nnorm %s\n",
                   name, name, name, name, name, name);
    test_write_text(in_folder("u.mtl"), library);
    test_write_text(in_folder("u.obj"), SQUARE "mtllib u.mtl\nusemtl a\nf 1/1 2/2 3/3\n");
    scene_init(&scene, &assets);
    struct model *model = model_asset(&assets, in_folder("u.obj"), "u", &(struct model_options){0}, &fresh, &error);
    struct node *node = model ? model_add_nodes(&scene, model, &placing, &error) : NULL;
    CHECK_TEXT(error.text, "");
    if (node) {
        struct hit hit = middle();
        struct surface_inputs got;
        surface_inputs_of(node->slots[0], &hit, &got);
        CHECK_NEAR(colour_max_abs(colour_sub(got.kd, colour_make(0.2, 0.4, 0.6))), 0, 0);
        CHECK_NEAR(got.ks.r, 0.3, 0);
        CHECK_NEAR(colour_max_abs(got.emission), 0, 0);
        CHECK_NEAR(got.opacity, 1, 0);
        CHECK_NEAR(got.normal.z, 1, 0);
        CHECK_EQ_INT(model->warning_count, 1);
        CHECK(strstr(model->warnings[0], name) && strstr(model->warnings[0], reason));
    }
    scene_destroy(&scene);
    assets_destroy(&assets);
}

TEST(a_picture_that_cannot_be_used_has_no_effect_and_emission_by_it_is_off) {
    check_unusable("nowhere.png", NULL, 0, "is not there");
    check_unusable("t.gif", "GIF89a....", 10, "the kind GIF, which gray does not read: convert it to PNG (the picture");
    check_unusable("t.tif", "II*\0....", 8, "the kind TIFF, which gray does not read: convert it to PNG (the picture");
    check_unusable("t.png", "\x89PNG\r\n\x1a\n", 8, "truncated PNG");
    check_unusable("t.bmp", "BM", 2, "broken BMP");
    check_unusable("t.tga", "", 0, "the file is empty");
}

TEST(pictures_on_a_mesh_without_coordinates_have_no_effect_but_a_warning) {
    struct assets assets = {0};
    struct scene scene;
    struct error error = {0};
    struct model_placing placing = {.name = "p"};
    bool fresh;
    write_even("even.png", 255, 0, 0);
    test_write_text(in_folder("w.mtl"), "newmtl a\nKd 0.2 0.4 0.6\nKe 1 1 1\nmap_Kd even.png\nmap_Ke even.png\n");
    test_write_text(in_folder("w.obj"), SQUARE "mtllib w.mtl\nusemtl a\nf 1 2 3\n");
    scene_init(&scene, &assets);
    struct model *model = model_asset(&assets, in_folder("w.obj"), "w", &(struct model_options){0}, &fresh, &error);
    struct node *node = model ? model_add_nodes(&scene, model, &placing, &error) : NULL;
    CHECK_TEXT(error.text, "");
    if (node) {
        struct hit hit = middle();
        struct surface_inputs got;
        hit.has_uv = false;
        surface_inputs_of(node->slots[0], &hit, &got);
        CHECK_NEAR(colour_max_abs(colour_sub(got.kd, colour_make(0.2, 0.4, 0.6))), 0, 0);
        CHECK_NEAR(colour_max_abs(got.emission), 0, 0);
        CHECK_EQ_INT(model->warning_count, 1);
        CHECK(strstr(model->warnings[0],
                     "the pictures of the material 'a' have no effect on meshes without coordinates"));
    }
    scene_destroy(&scene);
    assets_destroy(&assets);
}

TEST(a_broken_picture_of_many_materials_is_tried_once) {
    test_write_text(in_folder("broken.png"), "\x89PNG");
    test_write_text(in_folder("b.mtl"),
                    "newmtl a\nmap_Kd broken.png\nnewmtl b\nmap_Kd ./broken.png\nmap_Ks broken.png\n");
    test_write_text(in_folder("b.obj"), "mtllib b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl a\n"
                                        "f 1/1 2/2 3/3\nusemtl b\nf 1/1 3/3 2/2\n");
    struct assets assets = {0};
    struct scene scene;
    struct error error = {0};
    struct model_placing placing = {.name = "b"};
    bool fresh;
    scene_init(&scene, &assets);
    struct model *model = model_asset(&assets, in_folder("b.obj"), "b", &(struct model_options){0}, &fresh, &error);
    CHECK(model && model_add_nodes(&scene, model, &placing, &error));
    CHECK_TEXT(error.text, "");
    if (model) {
        CHECK_EQ_INT(model->warning_count, 1);
        CHECK_EQ_INT(model->broken.count, 1);
    }
    scene_destroy(&scene);
    assets_destroy(&assets);
}

#ifdef HAVE_JANSSON
TEST(meshes_that_no_skin_or_morph_changes_are_shared_by_all_times_of_a_file) {
    test_write_text(in_folder("times.gltf"),
                    "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":52,\"uri\":\"data:;base64,"
                    "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAgD8AAAAAAACAPw==\"}],"
                    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":52}],\"accessors\":["
                    "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"
                    "{\"bufferView\":0,\"byteOffset\":36,\"componentType\":5126,\"count\":2,\"type\":\"SCALAR\"},"
                    "{\"bufferView\":0,\"componentType\":5126,\"count\":2,\"type\":\"VEC3\"}],"
                    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]},"
                    "{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"targets\":[{\"POSITION\":0}]}]}],"
                    "\"nodes\":[{\"mesh\":0},{\"mesh\":1}],\"animations\":[{\"samplers\":["
                    "{\"input\":1,\"output\":2},{\"input\":1,\"output\":1}],\"channels\":["
                    "{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"translation\"}},"
                    "{\"sampler\":1,\"target\":{\"node\":1,\"path\":\"weights\"}}]}]}");
    struct assets assets = {0};
    struct error error = {0};
    struct model *models[3];
    for (int i = 0; i < 3; i++) {
        struct model_options options = {.animated = true, .time = i / 2.0};
        bool fresh;
        models[i] = model_asset(&assets, in_folder("times.gltf"), "times", &options, &fresh, &error);
        CHECK(models[i] && fresh);
    }
    CHECK_TEXT(error.text, "");
    for (int i = 1; i < 3 && models[0] && models[i]; i++) {
        CHECK(model_meshes(models[0])[0].mesh == model_meshes(models[i])[0].mesh);
        CHECK(model_meshes(models[0])[1].mesh != model_meshes(models[i])[1].mesh);
        CHECK(model_nodes(models[i])[0].parent_from_node.forward.m[0][3] != 0);
    }
    CHECK_EQ_INT(assets.mesh_count, 4);
    assets_destroy(&assets);
}
#endif
