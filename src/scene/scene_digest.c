/* The nodes are visited in the order of the one traversal, each once: a node that is met again counts by its serial
 * number alone. With the number of children and operands of every node, the sequence determines the graph.
 *
 * A field that is added to one of the structs below changes its size; the assertions remind of this file. */
#include "scene/scene_digest.h"

#include "base/mem.h"
#include "material/bump.h"
#include "material/openpbr.h"
#include "scene/traversal.h"

#include <assert.h>

enum { MATERIALS_KNOWN = 256, MATERIALS_NEAR = 8 /* slots that are searched */ };

/* The most recent materials, by their address, with their digests. */
struct known_material {
    const struct material *material;
    struct digest digest;
};

struct scene_digest {
    struct digest_sum *sum;
    struct known_material known[MATERIALS_KNOWN];
};

static void add_address(struct digest_sum *sum, const void *pointer) {
    digest_sum_add(sum, (uint64_t)(uintptr_t)pointer);
}

/* Bits of truth values. */
static void add_flags(struct digest_sum *sum, int bits) {
    digest_sum_add(sum, (uint64_t)bits);
}

static void add_number(struct digest_sum *sum, double number) {
    digest_sum_add_numbers(sum, &number, 1);
}

static void add_transform(struct digest_sum *sum, const struct transform *t) {
    digest_sum_add_numbers(sum, t->forward.m[0], sizeof t->forward.m / sizeof(double));
    digest_sum_add_numbers(sum, t->inverse.m[0], sizeof t->inverse.m / sizeof(double));
}

static void add_program(struct digest_sum *sum, const struct expr_program *program);

static void add_loop(struct digest_sum *sum, const struct expr_loop *loop) {
    add_program(sum, &loop->body);
    digest_sum_add(sum, (uint64_t)loop->first << 32 | loop->last);
    digest_sum_add(sum, (uint64_t)loop->state_count << 32 | (uint64_t)loop->argument_count << 1 | loop->ends);
    digest_sum_add(sum, loop->offset);
    for (uint32_t i = 0; i < loop->state_count; i++)
        digest_sum_add(sum, (uint64_t)loop->next[i] << 32 | (uint64_t)loop->type[i]);
}

/* Constants of EXPR_TEXEL are addresses of images, which stay until the script ends. */
static void add_program(struct digest_sum *sum, const struct expr_program *program) {
    digest_sum_add(sum, program != NULL);
    if (!program)
        return;
    struct digest digest = {0};
    digest_sum_add(sum, (uint64_t)program->count << 32 | program->constant_count);
    digest_sum_add(sum, (uint64_t)program->register_count << 32 | program->row_count);
    digest_sum_add(sum, (uint64_t)program->input_count << 32 | (uint32_t)program->output_count);
    for (int i = 0; i < program->input_count; i++)
        digest_sum_add(sum, (uint64_t)program->inputs[i].input << 16 | program->inputs[i].value);
    for (int i = 0; i < program->output_count; i++)
        digest_sum_add(sum, program->outputs[i]);
    digest_sum_add(sum, (uint64_t)program->direct_inputs << 16 | program->direct_output);
    digest = digest_bytes(program->code, program->count * sizeof *program->code, digest);
    digest = digest_bytes(program->constants, program->constant_count * sizeof *program->constants, digest);
    digest_sum_add_digest(sum, digest);
    digest_sum_add(sum, program->loop_work);
    digest_sum_add(sum, program->loop_count);
    for (uint32_t i = 0; i < program->loop_count; i++)
        add_loop(sum, &program->loops[i]);
}
static_assert(sizeof(struct expr_instruction) == 6 * sizeof(uint16_t), "instructions have no padding");
/* But for the source of a program. */
static_assert(sizeof(struct expr_program) == 144 && sizeof(struct expr_loop) == 184, "scene_digest.c adds every field");

/* --- textures and materials --- */

static void add_image_lookup(struct digest_sum *sum, const struct texture_image *image) {
    add_address(sum, image->image);
    digest_sum_add(sum, (uint64_t)image->mapping << 32 | (uint64_t)image->filter);
    digest_sum_add(sum, (uint64_t)image->wrap << 32 | (uint64_t)image->wrap_v);
    add_flags(sum, image->flip_u | image->outside << 1 | image->apart << 2);
    digest_sum_add_numbers(sum, image->scale, 2);
    digest_sum_add_numbers(sum, image->offset, 2);
    digest_sum_add_vector(sum, image->tint);
    digest_sum_add(sum, (uint64_t)image->alpha << 32 | (uint64_t)image->encoding);
    add_number(sum, image->gamma);
}
static_assert(sizeof(struct texture_image) == 104, "scene_digest.c adds every field");

/* Recursion is bounded by TEXTURE_SIZE, as that of reading the texture. */
static void add_texture(struct digest_sum *sum, const struct texture *texture) {
    digest_sum_add(sum, texture ? 1 + (uint64_t)texture->kind : 0);
    if (!texture)
        return;
    add_flags(sum, texture->shared | texture->has_image << 1 | texture->has_function << 2);
    switch (texture->kind) {
    case TEXTURE_CONSTANT:
        digest_sum_add_vector(sum, texture->constant.colour);
        add_number(sum, texture->constant.number);
        digest_sum_add(sum, texture->constant.display);
        break;
    case TEXTURE_PARAMETER:
        digest_sum_add(sum, (uint64_t)texture->parameter);
        break;
    case TEXTURE_VERTEX_COLOUR:
        break;
    case TEXTURE_IMAGE:
        add_image_lookup(sum, &texture->image.lookup);
        break;
    case TEXTURE_MARBLE:
        digest_sum_add_vector(sum,
                              vec3_make(texture->marble.f, texture->marble.multiplier, texture->marble.vein_frequency));
        digest_sum_add(sum, (uint64_t)texture->marble.interpolation);
        break;
    case TEXTURE_WOOD:
        add_number(sum, texture->wood.f);
        add_number(sum, texture->wood.density);
        digest_sum_add(sum, (uint64_t)texture->wood.interpolation);
        break;
    case TEXTURE_MIX:
    case TEXTURE_MULTIPLY:
        break;
    case TEXTURE_MAP:
        digest_sum_add(sum, (uint64_t)texture->map.function);
        add_number(sum, texture->map.amount);
        break;
    case TEXTURE_FUNCTION:
        add_program(sum, texture->recorded.program);
        digest_sum_add(sum, (uint64_t)texture->recorded.mapping << 32 | (uint64_t)texture->recorded.points);
        digest_sum_add_vector(sum, texture->recorded.average);
        digest_sum_add_vector(sum, texture->recorded.largest);
        break;
    }
    struct texture own = *texture;
    union texture_ref *parts[TEXTURE_PARTS];
    int count = texture_parts(&own, parts);
    for (int i = 0; i < count; i++)
        add_texture(sum, parts[i]->authored);
}
static_assert(sizeof(struct texture) == 128, "scene_digest.c adds every field");

static void add_bump(struct digest_sum *sum, const struct bump *bump) {
    for (; bump; bump = bump->below.authored) {
        digest_sum_add(sum, 1 + (uint64_t)bump->kind);
        add_number(sum, bump->height);
        add_flags(sum, bump->relative | bump->from_above << 1);
        add_texture(sum, bump->texture.authored);
    }
    digest_sum_add(sum, 0);
}
static_assert(sizeof(struct bump) == 48, "scene_digest.c adds every field");

static void add_phong(struct digest_sum *sum, const struct phong *phong) {
    digest_sum_add_vector(sum, phong->kd);
    digest_sum_add_vector(sum, phong->ks);
    digest_sum_add_vector(sum, vec3_make(phong->shininess, phong->reflect, phong->refract));
    digest_sum_add_vector(sum, phong->emission);
    digest_sum_add_vector(sum, phong->absorption);
    add_number(sum, phong->ior);
    add_number(sum, phong->roughness);
    add_flags(sum, phong->has_ior | phong->two_sided << 1 | phong->unlit << 2);
    digest_sum_add(sum, (uint64_t)phong->highlight << 32 | (uint32_t)phong->glossy_samples);
}
static_assert(sizeof(struct phong) == 152, "scene_digest.c adds every field");

static void add_openpbr(struct digest_sum *sum, const struct openpbr *pbr) {
    digest_sum_add(sum, pbr != NULL);
    if (!pbr)
        return;
    digest_sum_add_vector(sum, vec3_make(pbr->base_weight, pbr->base_diffuse_roughness, pbr->base_metalness));
    digest_sum_add_vector(sum, vec3_make(pbr->specular_weight, pbr->specular_anisotropy, pbr->specular_ior));
    digest_sum_add_vector(sum, pbr->transmission_colour);
    digest_sum_add_vector(sum, vec3_make(pbr->coat_weight, pbr->coat_roughness, pbr->coat_anisotropy));
    digest_sum_add_vector(sum, vec3_make(pbr->coat_ior, pbr->coat_darkening, pbr->fuzz_weight));
    digest_sum_add_vector(sum, pbr->coat_colour);
    add_number(sum, pbr->fuzz_roughness);
    digest_sum_add_vector(sum, pbr->fuzz_colour);
    add_flags(sum, pbr->deep | pbr->thin_walled << 1);
    digest_sum_add_vector(sum, pbr->tangent);
    digest_sum_add_vector(sum, pbr->coat_tangent);
}
static_assert(sizeof(struct openpbr) == 232, "scene_digest.c adds every field");

/* Worlds have a flat copy of a material: its inputs, and the numbers of the base at the end of its chain. */
static struct digest digest_of_material(const struct material *material) {
    const struct material *origin = material_origin(material);
    struct digest_sum sum = {.count = 0};
    digest_sum_add(&sum, (uint64_t)material->kind << 32 | (uint64_t)origin->kind);
    digest_sum_add(&sum, (uint64_t)material->changed << 1 | material->fresnel);
    add_phong(&sum, &origin->phong);
    add_openpbr(&sum, material->openpbr);
    add_openpbr(&sum, origin->openpbr);
    for (int k = 0; k < INPUT_COUNT; k++)
        add_texture(&sum, material->inputs[k].authored);
    add_bump(&sum, material->bump.authored);
    return digest_sum_end(&sum);
}
static_assert(sizeof(struct material) == 440, "scene_digest.c adds every field");

static void add_material(struct scene_digest *digest, const struct material *material) {
    digest_sum_add(digest->sum, material != NULL);
    if (!material)
        return;
    uint64_t first = random_mix((uint64_t)(uintptr_t)material), at = first;
    struct known_material *known = &digest->known[first % MATERIALS_KNOWN];
    while (known->material && known->material != material && at - first < MATERIALS_NEAR)
        known = &digest->known[++at % MATERIALS_KNOWN];
    if (known->material != material)
        *known = (struct known_material){material, digest_of_material(material)};
    digest_sum_add_digest(digest->sum, known->digest);
}

/* --- nodes --- */

/* node:displace gives a shape another mesh or height field; other data of a shape never change. */
static const void *replaceable_part(const struct shape *shape) {
    if (shape->kind == SHAPE_MESH)
        return shape->mesh;
    return shape->kind == SHAPE_HEIGHT_FIELD ? shape->height_field : NULL;
}

static void add_shape(struct scene_digest *digest, const struct node *node) {
    struct digest_sum *sum = digest->sum;
    add_material(digest, node->material);
    if (node->kind == NODE_CSG)
        return;
    add_address(sum, replaceable_part(&node->shape));
    digest_sum_add(sum, (uint64_t)node->slot_count << 8 | (uint64_t)node->cull);
    for (uint32_t i = 0; node->slots && i < node->slot_count; i++)
        add_material(digest, node->slots[i]);
    digest_sum_add(sum, node->texture != NULL);
    if (node->texture)
        add_image_lookup(sum, node->texture);
    add_bump(sum, node->bump);
}

static void add_node(struct scene_digest *digest, const struct node *node) {
    struct digest_sum *sum = digest->sum;
    bool moves = node_moves(node), has_end = node->moves_to && node->moves_to != node;
    uint64_t operands = node->kind == NODE_CSG ? node->operand_count : 0;
    digest_sum_add(sum,
                   (uint64_t)node->serial << 32 | (uint64_t)node->kind << 8 | (uint64_t)node->singular << 1 | moves);
    digest_sum_add(sum, (uint64_t)node->child_count << 32 | operands);
    add_transform(sum, &node->parent_from_node);
    add_address(sum, node->placements);
    if (moves) {
        digest_sum_add_vector(sum, node->velocity);
        add_flags(sum, (node->spin != NULL) | has_end << 1);
    }
    if (node->spin) {
        digest_sum_add_vector(sum, node->spin->axis);
        add_number(sum, node->spin->degrees);
    }
    if (has_end) {
        struct transform end = node_parent_from_node(node->moves_to);
        add_transform(sum, &end);
    }
    switch (node->kind) {
    case NODE_GROUP:
        break;
    case NODE_JOINT:
        add_number(sum, node->joint_x.init);
        add_number(sum, node->joint_y.init);
        break;
    case NODE_GEOMETRY:
    case NODE_CSG:
        add_shape(digest, node);
        break;
    }
}

/* Adds the node and all nodes below it. seen: by index, the nodes that were added. */
static bool add_nodes(struct scene_digest *digest, const struct node *root, uint8_t *seen) {
    struct scene_traversal t = {.operands = OPERANDS_ALL, .distinct = true};
    enum scene_event event;
    scene_traversal_begin(&t, root);
    while ((event = scene_traversal_next(&t)) < SCENE_END) {
        const struct node *node = scene_traversal_node(&t);
        if (event != SCENE_ENTER)
            continue;
        if (seen[node->index]) {
            digest_sum_add(digest->sum, ~(uint64_t)node->serial);
            scene_traversal_skip(&t);
            continue;
        }
        seen[node->index] = 1;
        add_node(digest, node);
    }
    scene_traversal_end(&t);
    return event == SCENE_END;
}

/* --- light --- */

static void add_sky(struct digest_sum *sum, const struct sky *sky) {
    digest_sum_add(sum, sky ? 1 + (uint64_t)sky->kind : 0);
    if (!sky)
        return;
    digest_sum_add_vector(sum, sky->colour);
    add_address(sum, sky->image);
    for (int i = 0; i < 6; i++)
        add_address(sum, sky->faces[i]);
    add_flags(sum, sky->mirror | sky->adjusted << 1 | sky->display << 2);
    digest_sum_add(sum, sky->stop_count);
    for (uint32_t i = 0; i < sky->stop_count; i++)
        digest_sum_add_numbers(sum, sky->stops[i], 4);
    digest_sum_add_vector(sum, sky->clear.sun);
    digest_sum_add_vector(sum, sky->clear.ground);
    digest_sum_add_numbers(sum, sky->clear.perez[0], sizeof sky->clear.perez / sizeof(double));
    digest_sum_add_numbers(sum, sky->clear.scale, 3);
    add_program(sum, sky->program);
    add_number(sum, sky->largest);
    digest_sum_add_vector(sum, vec3_make(sky->turn_sine, sky->turn_cosine, sky->intensity));
}
static_assert(sizeof(struct sky) == 360, "scene_digest.c adds every field");

static void add_light(struct digest_sum *sum, const struct light *light) {
    digest_sum_add(sum, (uint64_t)light->kind << 32 | (uint64_t)light->attenuation);
    digest_sum_add_vector(sum, light->position);
    digest_sum_add_vector(sum, light->corner);
    digest_sum_add_vector(sum, light->edge1);
    digest_sum_add_vector(sum, light->edge2);
    digest_sum_add_vector(sum, light->colour);
    add_program(sum, light->profile);
    add_number(sum, light->profile_largest);
    digest_sum_add_vector(sum, light->display);
    digest_sum_add_numbers(sum, light->falloff, 3);
    digest_sum_add_vector(sum, vec3_make(light->range, light->intensity, light->radius));
    digest_sum_add_vector(sum, light->direction);
    add_number(sum, light->cos_inner);
    add_number(sum, light->cos_outer);
    add_flags(sum, light->has_display | light->emissive << 1 | light->one_sided << 2 | light->visible << 3 |
                       light->has_emission << 4);
    digest_sum_add(sum, (uint64_t)light->samples);
    digest_sum_add_vector(sum, light->emission);
    add_sky(sum, light->sky);
}
static_assert(sizeof(struct light) == 344, "scene_digest.c adds every field");

static void add_list(struct digest_sum *sum, const struct node *const *nodes, uint32_t count) {
    digest_sum_add(sum, nodes ? 1 + (uint64_t)count : 0);
    for (uint32_t i = 0; nodes && i < count; i++)
        digest_sum_add(sum, nodes[i]->serial);
}

/* The lists count by the serial numbers of their nodes. These nodes, and the node of a mesh light, may be outside the
 * tree below the root, so they are added here. */
static bool add_scene_light(struct scene_digest *digest, const struct scene_light *light, uint8_t *seen) {
    struct digest_sum *sum = digest->sum;
    add_light(sum, &light->light);
    add_list(sum, light->include, light->include_count);
    add_list(sum, light->exclude, light->exclude_count);
    digest_sum_add(sum, light->sky_turn.turned);
    add_number(sum, light->sky_turn.sine);
    add_number(sum, light->sky_turn.cosine);
    digest_sum_add(sum, light->node != NULL);
    bool ok = !light->node || add_nodes(digest, light->node, seen);
    for (uint32_t i = 0; ok && light->include && i < light->include_count; i++)
        ok = add_nodes(digest, light->include[i], seen);
    for (uint32_t i = 0; ok && light->exclude && i < light->exclude_count; i++)
        ok = add_nodes(digest, light->exclude[i], seen);
    return ok;
}
static_assert(sizeof(struct scene_light) == 400, "scene_digest.c adds every field");

static void add_fog(struct digest_sum *sum, const struct fog *fog) {
    digest_sum_add(sum, fog ? 1 + (uint64_t)fog->kind : 0);
    if (!fog)
        return;
    digest_sum_add_vector(sum, fog->colour);
    add_number(sum, fog->density);
    add_number(sum, fog->near);
    add_number(sum, fog->far);
    add_number(sum, fog->base);
    add_number(sum, fog->scale);
    digest_sum_add(sum, fog->count);
    add_address(sum, fog->heights);
    add_address(sum, fog->densities);
    digest_sum_add_vector(sum, fog->corner);
    digest_sum_add_vector(sum, fog->size);
    digest_sum_add(sum, (uint64_t)fog->cells[0] << 32 | fog->cells[1]);
    digest_sum_add(sum, fog->cells[2]);
    add_flags(sum, fog->display | fog->clear_sky << 1);
    add_address(sum, fog->field);
}
static_assert(sizeof(struct fog) == 192, "scene_digest.c adds every field");

bool scene_digest_add(const struct scene_content *content, struct digest_sum *sum) {
    struct scene_digest *digest = mem_alloc_zero(1, sizeof *digest);
    uint8_t *seen = mem_alloc_zero(content->scene->node_total, 1);
    bool ok = digest && seen;
    if (ok) {
        digest->sum = sum;
        digest_sum_add(sum, content->scene->epoch);
        ok = add_nodes(digest, content->root, seen);
        digest_sum_add(sum, content->light_count);
        for (uint32_t i = 0; ok && i < content->light_count; i++)
            ok = add_scene_light(digest, &content->lights[i], seen);
        add_sky(sum, content->sky);
        add_fog(sum, content->fog);
    }
    mem_free(digest);
    mem_free(seen);
    return ok;
}
