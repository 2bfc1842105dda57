/* The flattened world as it was built: one line for each primitive, in flattening order, then materials and lights. */
#include "inspect/inspect.h"
#include "light/light_edit.h"
#include "mesh/mesh.h"

#include <stdio.h>

struct dump {
    const struct inspected *picture;
    const struct world *world;
    struct text_writer *writer;
    bool json;
};

/* Of a material in the world, from 1. */
static uint32_t number_of(const struct dump *d, uint32_t material) {
    return d->world->material_numbers[material] + 1;
}

static void dump_line(const struct dump *d, uint32_t primitive, const char *path) {
    const struct prototype *prototype = primitive_prototype(d->world, primitive);
    const struct mesh *mesh = geometry_mesh(&prototype->geometry);
    const struct box *box = &d->world->boxes[primitive];
    char material[24] = "-", triangles[24] = "-";
    bool moves = d->world->primitives[primitive].linear != LINEAR_NONE &&
                 (d->world->primitives[primitive].linear & LINEAR_MOVING);
    uint32_t first = !prototype->geometry.csg ? number_of(d, prototype->material) : 0;
    if (first > 0)
        (void)snprintf(material, sizeof material, prototype->slot_count > 1 ? "%u-%u" : "%u", first,
                       first + prototype->slot_count - 1);
    if (mesh)
        (void)snprintf(triangles, sizeof triangles, "%u", mesh_triangle_count(mesh));
    text_writer_print(d->writer, "%8u  %-14s %9s %9s  %-5s ", primitive + 1, geometry_kind_name(&prototype->geometry),
                      triangles, material, moves ? "moves" : "");
    text_writer_put(d->writer, "%v to %v  %n\n", box->min, box->max, path);
    if (!prototype->geometry.csg)
        return;
    for (uint32_t i = 0; i < prototype->geometry.csg->leaf_count; i++) {
        const struct csg_leaf *leaf = &prototype->geometry.csg->leaves[i];
        text_writer_print(d->writer, "          . operand %u: %s, material %u\n", i + 1,
                          shape_kind_name(leaf->shape.kind), number_of(d, leaf->material));
    }
}

static void dump_json(const struct dump *d, uint32_t primitive, const char *path) {
    const struct prototype *prototype = primitive_prototype(d->world, primitive);
    const struct mesh *mesh = geometry_mesh(&prototype->geometry);
    struct text_writer *writer = d->writer;
    /* The node and its shape. */
    text_writer_put(writer, "%s{\"number\":%u,\"node\":%q,\"node_number\":%u,\"shape\":\"%s\"",
                    primitive > 0 ? "," : "", primitive + 1, path, primitive_node(d->world, primitive)->serial,
                    geometry_kind_name(&prototype->geometry));
    if (mesh)
        text_writer_print(writer, ",\"triangles\":%u", mesh_triangle_count(mesh));
    if (mesh && mesh_dropped_faces(mesh) > 0)
        text_writer_print(writer, ",\"dropped_faces\":%u", mesh_dropped_faces(mesh));
    /* The materials. */
    if (prototype->geometry.csg) {
        text_writer_print(writer, ",\"operands\":[");
        for (uint32_t i = 0; i < prototype->geometry.csg->leaf_count; i++)
            text_writer_print(writer, "%s{\"shape\":\"%s\",\"material\":%u}", i > 0 ? "," : "",
                              shape_kind_name(prototype->geometry.csg->leaves[i].shape.kind),
                              number_of(d, prototype->geometry.csg->leaves[i].material));
        text_writer_print(writer, "]");
    } else {
        text_writer_print(writer, ",\"material\":%u,\"slots\":%u", number_of(d, prototype->material),
                          prototype->slot_count > 1 ? prototype->slot_count : 1);
    }
    /* The position. */
    struct transform map = world_placement(d->world, primitive, 0);
    text_writer_put(writer, ",\"min\":%a,\"max\":%a,\"world_from_object\":[", d->world->boxes[primitive].min,
                    d->world->boxes[primitive].max);
    for (int i = 0; i < 12; i++)
        text_writer_put(writer, i > 0 ? ",%j" : "%j", map.forward.m[i / 4][i % 4]);
    text_writer_put(writer, "]}");
}

static bool dump_primitives(void *context, uint32_t first, uint32_t count, const struct scene_step *steps,
                            uint32_t depth) {
    const struct dump *d = context;
    char path[4096];
    (void)node_path_text(steps, depth, path, sizeof path);
    for (uint32_t i = first; i < first + count; i++)
        d->json ? dump_json(d, i, path) : dump_line(d, i, path);
    return true;
}

static void dump_link(const struct dump *d, const struct material *link) {
    const struct phong *phong = &material_origin(link)->phong;
    const char *name = link->name ? link->name : "";
    text_writer_put(d->writer, d->json ? "{\"kind\":\"%s\"" : "%s", material_step_name(link));
    if (name[0])
        text_writer_put(d->writer, d->json ? ",\"name\":%q" : " '%n'", name);
    if (!link->base)
        text_writer_put(d->writer, d->json ? ",\"kd\":%r,\"ks\":%r" : " kd %c ks %c", phong->kd, phong->ks);
    text_writer_put(d->writer, "%s%s", d->json ? "}" : "", !link->base ? "" : d->json ? "," : " over ");
}

static void dump_material(const struct dump *d, uint32_t material) {
    struct text_writer *writer = d->writer;
    uint32_t number = number_of(d, material);
    text_writer_print(writer, d->json ? "%s{\"number\":%u,\"links\":[" : "%.0s%8u  ", d->json && number > 1 ? "," : "",
                      number);
    for (const struct material *link = d->world->authored.materials[material]; link; link = link->base)
        dump_link(d, link);
    text_writer_print(writer, d->json ? "]}" : "\n");
}

static void dump_light(const struct dump *d, uint32_t number) {
    const struct light *light = &d->world->lights[number];
    unsigned has = light_properties(light);
    bool area_light = !light_is_delta(light);
    const char *kind = light_kind_name(light->kind);
    if (d->json)
        text_writer_put(d->writer, "%s{\"number\":%u,\"kind\":\"%s\",\"lamp\":%b,\"colour\":%r", number > 0 ? "," : "",
                        number + 1, kind, area_light, light->colour);
    else
        text_writer_print(d->writer, "%8u  ", number + 1);
    if (!d->json)
        text_writer_put(d->writer, "%s of %c%s", kind, light->colour, area_light ? ", a lamp" : "");
    if (has & LIGHT_HAS_POSITION)
        text_writer_put(d->writer, d->json ? ",\"position\":%a" : " at %v", light->position);
    else if (has & LIGHT_HAS_DIRECTION)
        text_writer_put(d->writer, d->json ? ",\"direction\":%a" : " along %v", light->direction);
    text_writer_print(d->writer, d->json ? "}" : "\n");
}

static void dump_rest(const struct dump *d) {
    const struct world *world = d->world;
    text_writer_print(d->writer, d->json ? "],\"materials\":[" : "\n  number  material\n");
    for (uint32_t i = 0, numbers = 0; i < world->material_count; i++) {
        if (world->material_numbers[i] != numbers) /* already listed for another shape */
            continue;
        dump_material(d, i);
        numbers++;
    }
    text_writer_print(d->writer, d->json ? "],\"lights\":[" : "\n  number  light\n");
    for (uint32_t i = 0; i < world->light_count; i++)
        dump_light(d, i);
    text_writer_print(d->writer, d->json ? "]}\n" : "");
}

bool inspect_world(const struct inspected *picture, struct text_writer *writer, struct error *error) {
    bool json = picture->json;
    const struct world *world = picture->job->world;
    struct dump d = {picture, world, writer, json};
    text_writer_put(writer, json ? "{\"picture\":%q,\"primitives\":[" : "%n", picture->file);
    if (!json)
        text_writer_print(writer,
                          ": %u primitives, %llu triangles, %u materials, %u lights; background: %s\n\n"
                          "  number  shape          triangles  material        box  node\n",
                          world->primitive_count, (unsigned long long)world->triangles, world->material_number_count,
                          world->light_count, sky_kind_name(world->sky.kind));
    bool ok = world_visit_node_paths(world, picture->root, dump_primitives, &d, error);
    if (ok)
        dump_rest(&d);
    text_writer_flush(writer);
    return ok;
}
