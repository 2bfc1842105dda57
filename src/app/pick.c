/* The node's box is that of its own shape, turned with it, where the node is one shape; of a group it is the box along
 * the world's axes round everything under it. */
#include "app/pick.h"

#include "app/inspect.h"
#include "geom/csg.h"
#include "render/camera.h"
#include "world/path.h"

#include <stdio.h>
#include <string.h>

struct picking {
    const struct world *world;
    struct picked *out;
    uint32_t placed; /* what was hit */
    uint32_t up;
    /* The way to the node, once it is known. */
    struct path_step steps[256];
    uint32_t depth;
    struct box box; /* of everything under it */
};

static struct transform world_from_parent(const struct path_step *steps, uint32_t depth) {
    struct transform out = transform_identity();
    for (uint32_t i = 0; i + 1 < depth; i++) {
        struct transform parent_from_node = node_parent_from_node(steps[i].node);
        out = transform_compose(&out, &parent_from_node);
        if (steps[i].place > 0) {
            struct transform node_from_child = placement_transform(steps[i].node->placements, steps[i].place - 1);
            out = transform_compose(&out, &node_from_child);
        }
    }
    return out;
}

void pick_words(char out[PICK_WORDS], const char *text) {
    (void)snprintf(out, PICK_WORDS, "%s", text);
    for (char *c = out; *c; c++)
        *c = (unsigned char)*c < 32 || *c == 127 ? '?' : *c;
}

/* The way to what was hit; the walk ends there. */
static bool find_way(void *context, uint32_t first, uint32_t count, const struct path_step *steps, uint32_t depth) {
    struct picking *p = context;
    if (p->placed < first || p->placed >= first + count)
        return true;
    uint32_t up = p->up < depth - 1 ? p->up : depth - 1;
    p->depth = depth - up;
    p->out->levels = p->depth - 1;
    if (p->depth > 256) {
        p->depth = 0;
        return false;
    }
    memcpy(p->steps, steps, p->depth * sizeof *steps);
    (void)world_path_text(steps, p->depth, p->out->path, sizeof p->out->path);
    return false;
}

static bool join_boxes(void *context, uint32_t first, uint32_t count, const struct path_step *steps, uint32_t depth) {
    struct picking *p = context;
    bool below = depth >= p->depth;
    for (uint32_t i = 0; below && i < p->depth; i++) {
        bool last = i + 1 == p->depth;
        below = steps[i].node == p->steps[i].node && (last || steps[i].place == p->steps[i].place);
    }
    for (uint32_t i = first; below && i < first + count; i++)
        p->box = box_join(p->box, p->world->boxes[i]);
    return true;
}

static void set_corners(struct picked *out, const struct box *box, const struct affine *map) {
    out->has_box = !box_is_empty(box) && vec3_finite(box->min) && vec3_finite(box->max);
    for (int i = 0; i < 8 && out->has_box; i++) {
        struct vec3 p = {i & 1 ? box->max.x : box->min.x, i & 2 ? box->max.y : box->min.y,
                         i & 4 ? box->max.z : box->min.z};
        out->corners[i] = map ? affine_point(map, p) : p;
    }
}

static bool box_node(struct picking *p, const struct node *root, bool whole, struct error *error) {
    const struct thing *thing = placed_thing(p->world, p->placed);
    if (whole && thing->parts == 1 && !thing->is_later_part) {
        struct transform map = world_placement(p->world, p->placed, 0);
        struct box box = shape_bounds(&thing->shape);
        set_corners(p->out, &box, &map.forward);
        return true;
    }
    p->box = box_empty();
    if (!world_walk_paths(p->world, root, join_boxes, p, error))
        return false;
    set_corners(p->out, &p->box, NULL);
    return true;
}

/* "marble over phong", and the base. */
static void tell_material(const struct material *material, struct picked *out) {
    char words[256] = "";
    size_t used = 0;
    const struct material *base = material;
    for (const struct material *link = material; link; link = link->base) {
        int length = snprintf(words + used, sizeof words - used, "%s%s", used > 0 ? " over " : "",
                              link->name ? link->name : inspect_material(link));
        used = length < 0 || used + (size_t)length >= sizeof words ? sizeof words - 1 : used + (size_t)length;
        base = link;
    }
    pick_words(out->material, words);
    if (base->kind != MATERIAL_PHONG)
        return;
    out->material_serial = base->serial;
    for (int part = 0; part < LOOK_PARTS; part++)
        look_part_get(base, (enum look_part)part, out->look[part]);
}

static bool describe(struct picking *p, const struct node *root, const struct hit *hit, struct error *error) {
    struct picked *out = p->out;
    if (!world_walk_paths(p->world, root, find_way, p, error))
        return false;
    out->hit = p->depth > 0;
    if (!out->hit)
        return true;
    const struct node *node = p->steps[p->depth - 1].node;
    out->serial = node->serial;
    pick_words(out->name, node->name);
    if (p->depth > 1) {
        out->parent_serial = p->steps[p->depth - 2].node->serial;
        pick_words(out->parent_name, p->steps[p->depth - 2].node->name);
    }
    bool itself = node == placed_node(p->world, p->placed);
    pick_words(out->shape, itself ? inspect_shape(placed_shape(p->world, p->placed)->kind) : "group");
    tell_material(p->world->materials[hit->material], out);
    out->can_own = itself && node->kind == NODE_GEOMETRY;
    out->world_from_parent = world_from_parent(p->steps, p->depth).forward;
    return box_node(p, root, itself, error);
}

bool pick_at(const struct render_job *job, const struct node *root, double x, double y, uint32_t up, struct picked *out,
             struct error *error) {
    struct settings settings = job->settings;
    struct camera_frame frame;
    struct world_scratch scratch;
    struct ray ray;
    struct hit hit;
    char ignored[256];
    *out = (struct picked){0};
    settings.lens.aperture = 0;
    if (!camera_prepare(&job->camera, &settings, job->width, job->height, &frame, ignored, error))
        return false;
    if (!camera_ray_through(&frame, x, y, (struct sample2){0.5, 0.5}, 0, &ray))
        return true;
    if (!world_scratch_init(&scratch, job->world))
        return error_no_memory(error, "the ray of a click");
    bool found = world_nearest(job->world, &ray, &scratch, &hit), ok = true;
    if (found) {
        struct picking p = {.world = job->world, .out = out, .placed = hit.placed, .up = up};
        out->distance = vec3_length(vec3_sub(hit.point, ray.origin));
        out->position = hit.point;
        out->normal = hit.normal;
        ok = describe(&p, root, &hit, error);
    }
    world_scratch_destroy(&scratch);
    return ok;
}
