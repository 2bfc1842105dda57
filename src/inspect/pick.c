/* The box of a node with one shape is that of its shape, rotated with it; the box of a group is the axis-aligned box in
 * world space around all its descendants. The route to a combined solid continues to the operand whose surface was hit;
 * the user selects one of its nodes by moving up or down the route. */
#include "inspect/pick.h"

#include "base/hash.h"
#include "csg/csg.h"
#include "material/material_eval.h"
#include "render/camera.h"

#include <stdio.h>
#include <string.h>

enum { ROUTE_LIMIT = 256 };

struct picking {
    const struct world *world;
    struct picked *out;
    uint32_t primitive; /* what was hit */
    /* The route to it, and on to the operand; the selected node is the last of `depth`. */
    struct scene_step steps[ROUTE_LIMIT];
    uint32_t route, whole, depth;
    struct box box; /* of everything under it */
};

static struct transform world_from_parent(const struct scene_step *steps, uint32_t depth) {
    struct transform out = transform_identity();
    for (uint32_t i = 0; i + 1 < depth; i++) {
        struct transform parent_from_node = node_parent_from_node(steps[i].node);
        out = transform_compose(&out, &parent_from_node);
        out = scene_step_map(&steps[i], &out);
    }
    return out;
}

void pick_copy_name(char out[PICK_NAME], const char *text) {
    (void)snprintf(out, PICK_NAME, "%s", text);
    for (char *c = out; *c; c++)
        *c = (unsigned char)*c < 32 || *c == 127 ? '?' : *c;
}

uint64_t route_hash(const struct scene_step *steps, uint32_t depth) {
    uint64_t route = depth;
    for (uint32_t i = 0; i < depth; i++) {
        const uint32_t words[2] = {steps[i].node->serial, i + 1 < depth ? steps[i].placement : 0};
        route = hash_bytes(words, sizeof words, route);
    }
    return route ? route : 1;
}

/* The route to the primitive that was hit; the traversal ends there. */
static bool find_route(void *context, uint32_t first, uint32_t count, const struct scene_step *steps, uint32_t depth) {
    struct picking *p = context;
    if (p->primitive < first || p->primitive >= first + count)
        return true;
    p->route = depth <= ROUTE_LIMIT ? depth : 0;
    memcpy(p->steps, steps, p->route * sizeof *steps);
    return false;
}

/* The node that is this many levels above the primitive's node, or below. */
static bool choose_node(struct picking *p, const struct hit *hit, int32_t up) {
    const struct csg *csg = primitive_geometry(p->world, p->primitive)->csg;
    uint32_t length = 0;
    if (csg && !world_operand_path(p->steps[p->route - 1].node, csg->leaves[hit->leaf].origin, p->steps + p->route,
                                   ROUTE_LIMIT - p->route, &length))
        return false;
    int32_t route = (int32_t)p->route, below = (int32_t)length;
    up = up > route - 1 ? route - 1 : up < -below ? -below : up;
    p->whole = (uint32_t)(route + below);
    p->depth = (uint32_t)(route - up);
    p->out->up = up;
    p->out->below = p->whole - p->depth;
    p->out->levels = p->depth - 1;
    (void)node_path_text(p->steps, p->depth, p->out->node_path, sizeof p->out->node_path);
    return true;
}

static bool join_boxes(void *context, uint32_t first, uint32_t count, const struct scene_step *steps, uint32_t depth) {
    struct picking *p = context;
    bool below = depth >= p->depth;
    for (uint32_t i = 0; below && i < p->depth; i++) {
        bool last = i + 1 == p->depth;
        below = steps[i].node == p->steps[i].node && (last || steps[i].placement == p->steps[i].placement);
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

struct box_frame {
    struct transform world_from_node, of_children;
};

/* Of all shapes under an operand. False: no memory. */
static bool join_operand(struct box *box, const struct node *operand, const struct transform *world_from_above) {
    struct scene_traversal t = {.operands = OPERANDS_ALL, .frame_size = sizeof(struct box_frame)};
    enum scene_event event;
    scene_traversal_begin(&t, operand);
    while ((event = scene_traversal_next(&t)) < SCENE_END) {
        struct box_frame *frame = scene_traversal_frame(&t, 0);
        const struct node *node = scene_traversal_node(&t);
        if (event == SCENE_ENTER) {
            const struct box_frame *above = t.depth > 1 ? scene_traversal_frame(&t, 1) : NULL;
            /* The map of the node above depends on whether this one is a child or an operand. */
            const struct transform *map = !above                                       ? world_from_above
                                          : scene_traversal_operand(&t) == SCENE_CHILD ? &above->of_children
                                                                                       : &above->world_from_node;
            struct transform above_from_node = node_parent_from_node(node);
            frame->world_from_node = transform_compose(map, &above_from_node);
            if (node->singular) {
                scene_traversal_skip(&t);
            } else if (node->kind == NODE_GEOMETRY) {
                struct box own = shape_bounds(&node->shape);
                if (!box_is_empty(&own))
                    own = box_transform(&frame->world_from_node.forward, &own);
                *box = box_join(*box, own);
            }
        } else if (event == SCENE_CHILDREN) {
            frame->of_children = scene_step_map(&t.steps[t.depth - 1], &frame->world_from_node);
        }
    }
    scene_traversal_end(&t);
    return event == SCENE_END;
}

static bool box_operand(struct picking *p, const struct node *node, const struct transform *above) {
    struct transform above_from_node = node_parent_from_node(node);
    struct transform map = transform_compose(above, &above_from_node);
    bool shape = node->kind == NODE_GEOMETRY && !node->first_child;
    p->box = shape ? shape_bounds(&node->shape) : box_empty();
    if (!shape && !join_operand(&p->box, node, above))
        return false;
    set_corners(p->out, &p->box, shape ? &map.forward : NULL);
    return true;
}

static bool box_node(struct picking *p, const struct node *root, struct error *error) {
    const struct prototype *prototype = primitive_prototype(p->world, p->primitive);
    if (p->depth == p->route && prototype->parts == 1 && !prototype->is_later_part) {
        struct transform map = world_placement(p->world, p->primitive, 0);
        struct box box = geometry_bounds(&prototype->geometry);
        set_corners(p->out, &box, &map.forward);
        return true;
    }
    if (p->depth > p->route) {
        struct transform above = world_from_parent(p->steps, p->depth);
        return box_operand(p, p->steps[p->depth - 1].node, &above) || error_no_memory(error, "the box of a node");
    }
    p->box = box_empty();
    if (!world_visit_node_paths(p->world, root, join_boxes, p, error))
        return false;
    set_corners(p->out, &p->box, NULL);
    return true;
}

static const char *shape_description(const struct picking *p, const struct node *node) {
    if (p->depth == p->route)
        return geometry_kind_name(primitive_geometry(p->world, p->primitive));
    bool solid = p->depth > p->route && node->kind != NODE_GROUP && node->kind != NODE_JOINT;
    return !solid ? "group" : node->kind == NODE_CSG ? "csg" : shape_kind_name(node->shape.kind);
}

/* "marble over phong", and the base. */
static void describe_material(const struct material *material, struct picked *out) {
    char words[256] = "";
    size_t used = 0;
    const struct material *base = material_origin(material);
    for (const struct material *link = material; link; link = link->base) {
        int length = snprintf(words + used, sizeof words - used, "%s%s", used > 0 ? " over " : "",
                              link->name ? link->name : material_step_name(link));
        used = length < 0 || used + (size_t)length >= sizeof words ? sizeof words - 1 : used + (size_t)length;
    }
    pick_copy_name(out->material, words);
    out->material_serial = base->serial;
    for (int part = 0; part < MATERIAL_PART_PARTS; part++)
        material_part_get(base, (enum material_part)part, out->inputs[part]);
}

static bool same_inputs(const struct surface_inputs *a, const struct surface_inputs *b) {
    const struct colour colours[][2] = {
        {a->kd, b->kd}, {a->ks, b->ks}, {a->emission, b->emission}, {a->absorption, b->absorption}};
    const double numbers[][2] = {{a->shininess, b->shininess}, {a->reflect, b->reflect},
                                 {a->refract, b->refract},     {a->ior, b->ior},
                                 {a->opacity, b->opacity},     {a->roughness, b->roughness}};
    bool same = true;
    for (size_t i = 0; i < sizeof colours / sizeof *colours; i++)
        same = same && memcmp(&colours[i][0], &colours[i][1], sizeof colours[i][0]) == 0;
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        same = same && numbers[i][0] == numbers[i][1];
    return same;
}

/* Found by trial: each part gets another value, and the inputs at the hit are compared. */
static uint32_t idle_parts(const struct surface_tables *tables, const struct hit *hit) {
    const struct surface_material *material = &tables->materials[hit->material];
    struct surface_inputs before, after;
    uint32_t idle = 0;
    material_inputs_at(tables, material, hit, &before);
    for (int k = 0; k < MATERIAL_PART_PARTS; k++) {
        enum material_part part = (enum material_part)k;
        struct surface_material other = *material;
        struct material base = {.phong = material->phong};
        double numbers[3];
        material_part_get(&base, part, numbers);
        for (int i = 0; i < 3; i++)
            numbers[i] = numbers[i] > 0.5 ? 0.25 : 0.75;
        material_part_set(&base, part, numbers);
        other.phong = base.phong;
        material_inputs_at(tables, &other, hit, &after);
        idle |= same_inputs(&before, &after) ? 1U << k : 0;
    }
    return idle;
}

/* The numbers of children along the route. */
static void set_path(const struct picking *p) {
    struct node_query *path = &p->out->path;
    for (uint32_t i = 1; i < p->depth && p->depth <= NODE_LEVELS; i++) {
        path->path[i] = node_list_number(p->steps[i - 1].node, p->steps[i].node);
        if (path->path[i] == UINT32_MAX)
            return;
    }
    path->depth = p->depth <= NODE_LEVELS ? p->depth : 0;
}

static bool describe_node(struct picking *p, const struct node *root, struct error *error) {
    struct picked *out = p->out;
    const struct node *node = p->steps[p->depth - 1].node;
    out->serial = node->serial;
    set_path(p);
    out->route = route_hash(p->steps, p->depth);
    out->solid = p->depth > p->route ? route_hash(p->steps, p->route) : 0;
    pick_copy_name(out->name, node->name);
    if (p->depth > 1) {
        out->parent_serial = p->steps[p->depth - 2].node->serial;
        pick_copy_name(out->parent_name, p->steps[p->depth - 2].node->name);
    }
    pick_copy_name(out->shape, shape_description(p, node));
    out->can_own = p->depth == p->whole && node->kind == NODE_GEOMETRY;
    out->world_from_parent = world_from_parent(p->steps, p->depth).forward;
    return box_node(p, root, error);
}

static bool describe(struct picking *p, const struct node *root, const struct hit *hit, int32_t up,
                     struct error *error) {
    struct picked *out = p->out;
    if (!world_visit_node_paths(p->world, root, find_route, p, error))
        return false;
    out->hit = p->route > 0;
    if (!out->hit)
        return true;
    /* The route leads to the shape; the user moves up and down on it. */
    if (!choose_node(p, hit, up))
        return error_no_memory(error, "the route to an operand");
    /* Of the material, what can be changed, and which changes would not be seen. */
    describe_material(p->world->authored.materials[hit->material], out);
    out->idle_parts = idle_parts(&p->world->surfaces, hit);
    return describe_node(p, root, error);
}

/* The path to the first primitive under the nodes that are known: `depth` of them, without placements. */
static bool find_first(void *context, uint32_t first, uint32_t count, const struct scene_step *steps, uint32_t depth) {
    struct picking *p = context;
    bool below = depth >= p->depth && depth <= ROUTE_LIMIT && count > 0;
    for (uint32_t i = 0; below && i < p->depth; i++)
        below = steps[i].node == p->steps[i].node;
    if (!below)
        return true;
    p->primitive = first;
    p->route = p->whole = depth;
    memcpy(p->steps, steps, depth * sizeof *steps);
    return false;
}

bool pick_node(const struct render_job *job, const struct node *root, const struct node_query *query,
               struct picked *out, struct error *error) {
    struct picking p = {.world = job->world, .out = out};
    struct node_query part = *query;
    *out = (struct picked){0};
    if (query->depth == 0 && (query->serial == 0 || !node_list_locate(root, query->serial, &part)))
        return true;
    uint32_t depth = part.depth, outer = 0; /* outer: the depth of the solid whose operand it is */
    if (depth > NODE_LEVELS)
        return true;
    for (part.depth = 1; part.depth <= depth; part.depth++) {
        const struct node *node = p.steps[part.depth - 1].node = node_list_find(root, &part);
        if (!node)
            return true;
        bool solid = node->kind == NODE_CSG && !node_is_placing(node);
        outer = outer == 0 && solid && part.depth < depth ? part.depth : outer;
    }
    p.depth = outer > 0 ? outer : depth;
    if (!world_visit_node_paths(p.world, root, find_first, &p, error))
        return false;
    out->hit = p.route > 0;
    if (!out->hit)
        return true;
    p.depth = depth;
    p.whole = p.route > depth ? p.route : depth;
    out->up = (int32_t)p.route - (int32_t)depth;
    out->levels = p.depth - 1;
    (void)node_path_text(p.steps, p.depth, out->node_path, sizeof out->node_path);
    const struct node *node = p.steps[p.depth - 1].node;
    if (node->kind == NODE_GEOMETRY && node->material)
        describe_material(node->material, out);
    if (!describe_node(&p, root, error))
        return false;
    for (int i = 0; i < 8; i++)
        out->position = vec3_add_scaled(out->position, out->corners[i], 0.125);
    out->distance = vec3_length(vec3_sub(out->position, job->camera.eye));
    return true;
}

void material_rows(const struct world *world, const struct node_query *query, struct node_rows *out) {
    if (query->depth == 0)
        out->rows[SECTION_MATERIALS] =
            (struct node_row){.children = world->material_count, .name = "Materials", .kind = " "};
    if (query->depth != 1 || query->path[0] != SECTION_MATERIALS)
        return;
    for (uint32_t i = query->first; i < world->material_count && out->count < NODE_ROWS; i++) {
        struct node_row *row = &out->rows[out->count++];
        struct picked picked = {0};
        describe_material(world->authored.materials[i], &picked);
        (void)snprintf(row->name, sizeof row->name, "%u", picked.material_serial);
        (void)snprintf(row->kind, sizeof row->kind, "%.15s", picked.material);
    }
}

void pick_material(const struct world *world, const struct node_query *query, struct picked *out) {
    *out = (struct picked){.path = *query};
    if (query->depth != 2 || query->path[1] >= world->material_count)
        return;
    out->hit = true;
    describe_material(world->authored.materials[query->path[1]], out);
}

bool pick_at(const struct render_job *job, const struct node *root, struct pick_query query, struct picked *out,
             struct error *error) {
    struct settings settings = job->settings;
    struct camera_frame frame;
    struct world_scratch scratch;
    struct ray ray;
    struct hit hit;
    char ignored[256];
    *out = (struct picked){0};
    /* A click means what is in the middle of the pixel, without blur. */
    settings.lens.aperture = 0;
    if (!camera_prepare(&job->camera, &settings, (struct picture_size){job->width, job->height}, &frame, ignored,
                        error))
        return false;
    if (!camera_ray_through(&frame, query.x, query.y, (struct sample2){0.5, 0.5}, NULL, &ray))
        return true;
    if (!world_scratch_init(&scratch, job->world))
        return error_no_memory(error, "the ray of a click");
    bool found = world_nearest(job->world, &ray, &scratch, &hit), ok = true;
    if (found) {
        struct picking p = {.world = job->world, .out = out, .primitive = hit.primitive};
        out->distance = vec3_length(vec3_sub(hit.point, ray.origin));
        out->position = hit.point;
        out->normal = hit.normal;
        ok = describe(&p, root, &hit, query.up, error);
    }
    world_scratch_destroy(&scratch);
    return ok;
}
