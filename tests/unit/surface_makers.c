#include "tests/unit/surface_makers.h"

#include "tests/harness.h"

/* A material without textures needs no tables but itself. */
static struct surface_tables tables_of(const struct material *material, struct surface_material *own,
                                       struct arena *arena) {
    struct surface_tables out = {.materials = own};
    *own = surface_material_make(material, false, NULL);
    *arena = (struct arena){.head = NULL};
    if (!own->plain)
        CHECK(surface_tables_build(&out, &material, 1, false, arena, NULL));
    return out;
}

void surface_inputs_of(const struct material *material, const struct hit *hit, struct surface_inputs *out) {
    struct surface_material own;
    struct arena arena;
    struct surface_tables tables = tables_of(material, &own, &arena);
    material_inputs_at(&tables, tables.materials, hit, out);
    arena_destroy(&arena);
}

void surface_eval(const struct material *material, const struct hit *hit, const struct medium_stack *media,
                  const struct material_context *context, struct bsdf *out) {
    struct surface_material own;
    struct arena arena;
    struct surface_tables tables = tables_of(material, &own, &arena);
    struct hit first = *hit;
    first.material = 0;
    material_eval(&tables, &first, media, context, out);
    arena_destroy(&arena);
}

double surface_albedo_bound_of(const struct material *material) {
    struct surface_material own;
    struct arena arena;
    struct surface_tables tables = tables_of(material, &own, &arena);
    double bound = surface_albedo_bound(&tables, tables.materials);
    arena_destroy(&arena);
    return bound;
}

static struct colour read_alone(const struct texture *texture, bool is_number, const struct hit *hit) {
    struct texture_builder builder = {.count = 0};
    struct texture_tables tables;
    struct texture_reader reader;
    struct arena arena = {.head = NULL};
    struct colour value = {0, 0, 0};
    uint32_t program;
    bool ok = texture_builder_add(&builder, texture, is_number, &program) &&
              texture_builder_finish(&builder, &arena, &tables);
    CHECK(ok);
    if (ok) {
        texture_reader_init(&reader, hit, &tables, NULL);
        value = texture_read(program, &reader);
    }
    texture_builder_destroy(&builder);
    arena_destroy(&arena);
    return value;
}

struct colour texture_colour_at(const struct texture *texture, const struct hit *hit) {
    return read_alone(texture, false, hit);
}

double texture_number_at(const struct texture *texture, const struct hit *hit) {
    return read_alone(texture, true, hit).r;
}
