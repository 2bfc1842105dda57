/* Any bytes as a mesh file of one kind: a model whose meshes can be searched, or one line that names the file. */
#ifndef GRAY_TESTS_FUZZ_MODEL_H
#define GRAY_TESTS_FUZZ_MODEL_H

#include "formats/model.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static inline void fuzz_model(const char *path, const uint8_t *data, size_t size) {
    struct error error = {0};
    struct model model;
    /* The last byte chooses what is done with the mesh, and the moment of an animation. */
    struct model_options options = {.single_file = true};
    if (size > 0) {
        options.smooth = data[size - 1] & 1;
        options.smooth_angle = 30;
        options.weld = data[size - 1] & 2;
        options.weld_distance = data[size - 1] & 8 ? 0.5 : 0;
        options.flip = data[size - 1] & 4;
        options.animated = data[size - 1] & 16;
        options.time = (data[size - 1] >> 5) * 0.25;
        options.variant = data[size - 1] & 64 ? "v" : NULL;
    }
    if (!model_parse(&model, path, data, size, &options, &error)) {
        if (error.kind == ERROR_NONE || !strstr(error.text, path) || strchr(error.text, '\n'))
            abort();
        return;
    }
    for (size_t i = 0; i < model.nodes.count; i++) {
        const struct model_node *node = &model_nodes(&model)[i];
        if ((node->mesh != MODEL_NONE && node->mesh >= model.meshes.count) ||
            (node->parent != MODEL_NONE && node->parent >= i))
            abort();
    }
    for (size_t i = 0; i < model.meshes.count; i++) {
        struct model_mesh *m = &model_meshes(&model)[i];
        const struct mesh *mesh = m->mesh;
        uint32_t vertices, corners;
        (void)mesh_vertices(mesh, &vertices);
        for (uint32_t f = 0; f < mesh_face_count(mesh); f++) {
            const uint32_t *face = mesh_face(mesh, f, &corners);
            for (uint32_t k = 0; k < corners; k++)
                if (face[k] >= vertices)
                    abort();
        }
        for (uint32_t t = 0; t < mesh_triangle_count(mesh) && t < 1000; t++) {
            struct crossing crossing = {.part = t, .u = 0.25, .v = 0.25};
            struct ray ray = {.direction = {0, 0, 1}, .t_max = INFINITY};
            struct surface surface;
            mesh_describe(mesh, &ray, &crossing, &surface);
            if (surface.material_slot && surface.material_slot >= m->slots.count)
                abort();
        }
        for (size_t k = 0; k < m->slots.count; k++)
            if (((uint32_t *)m->slots.items)[k] != MODEL_NONE &&
                ((uint32_t *)m->slots.items)[k] >= model.materials.count)
                abort();
    }
    model_destroy(&model);
}

#endif
