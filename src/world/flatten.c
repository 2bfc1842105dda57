/* Flattening of the node DAG. First a traversal of the distinct nodes finds cycles and counts the primitives of each
 * node (saturating), so that a tree that doubles at every level is refused, or skipped if it has no primitives, before
 * memory is allocated. Then every path from the root to a primitive makes one primitive. Temporary data of nodes are in
 * tables beside the nodes, which are only read. */
#include "world/flatten_internal.h"

#include "base/hash.h"
#include "base/mem.h"
#include "math/portable.h"
#include "scene/traversal.h"
#include "world/flatten_csg_internal.h"
#include "world/flatten_material_internal.h"
#include "world/node_path.h"
#include "world/world_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { PRIMITIVE_LIMIT = 1 << 28 };
/* In the table of prototypes by node. */
#define PROTOTYPE_UNKNOWN UINT32_MAX
#define PROTOTYPE_NOTHING (UINT32_MAX - 1)

/* --- counting and cycles --- */

static bool report_cycle(struct flattening *f, const struct scene_step *steps, uint32_t depth) {
    enum { NAMES = 6 };
    char names[512];
    size_t used = 0;
    uint32_t first = 0, last = depth - 1;
    while (steps[first].node != steps[last].node)
        first++;
    for (uint32_t i = first; i <= last && used < sizeof names - 120; i++) {
        if (i - first >= NAMES && i != last) {
            if (i - first == NAMES)
                used += (size_t)snprintf(names + used, sizeof names - used, " > ...");
            continue;
        }
        used += (size_t)snprintf(names + used, sizeof names - used, "%s'%.60s'", i > first ? " > " : "",
                                 steps[i].node->name);
    }
    return error_set(f->error, ERROR_SCENE, "the nodes form a cycle: %s", names);
}

static uint32_t add_saturating(uint32_t a, uint32_t b) {
    return a > UINT32_MAX - b ? UINT32_MAX : a + b;
}

static uint32_t multiply_saturating(uint32_t a, uint32_t b) {
    return b > 0 && a > UINT32_MAX / b ? UINT32_MAX : a * b;
}

/* The number of primitives of a node and everything below it; children: that of all its children. */
static uint32_t count_node(const uint32_t *drawable, const struct node *node, uint32_t children) {
    uint32_t own = node_is_placing(node) ? drawable[node->operands[0]->index]
                                         : node->kind == NODE_GEOMETRY || node->kind == NODE_CSG;
    if (node->placements)
        children = multiply_saturating(children, node->placements->count);
    return node->singular ? 0 : add_saturating(own, children);
}

/* Adds the number of the node to the sum of the node that it is a child of: nodes are read once. */
static void count_child(const struct scene_traversal *t, uint32_t count) {
    if (t->depth < 2 || scene_traversal_operand(t) != SCENE_CHILD)
        return;
    uint32_t *children = scene_traversal_frame(t, 1);
    *children = add_saturating(*children, count);
}

static bool count_nodes(struct flattening *f, const struct node *root, uint32_t *drawable, uint8_t *draws) {
    enum { UNSEEN, ON_PATH, FINISHED };
    struct scene_traversal t = {.operands = OPERANDS_ALL, .distinct = true, .frame_size = sizeof(uint32_t)};
    uint8_t *state = mem_alloc_zero(f->scene->node_total, 1);
    enum scene_event event = SCENE_NO_MEMORY;
    bool cycle = false;
    scene_traversal_begin(&t, root);
    while (state && !cycle && (event = scene_traversal_next(&t)) < SCENE_END) {
        const struct node *node = scene_traversal_node(&t);
        uint32_t *children = scene_traversal_frame(&t, 0);
        /* A node that is met again counts as before, or is above itself. */
        if (event == SCENE_ENTER && state[node->index] != UNSEEN) {
            cycle = state[node->index] == ON_PATH;
            if (cycle)
                report_cycle(f, t.steps, t.depth);
            count_child(&t, drawable[node->index]);
            scene_traversal_skip(&t);
        } else if (event == SCENE_ENTER) {
            state[node->index] = ON_PATH;
            *children = 0;
        } else if (event == SCENE_LEAVE) {
            drawable[node->index] = count_node(drawable, node, *children);
            draws[node->index] = drawable[node->index] > 0;
            state[node->index] = FINISHED;
            count_child(&t, drawable[node->index]);
        }
    }
    scene_traversal_end(&t);
    mem_free(state);
    return !cycle && (event == SCENE_END || error_no_memory(f->error, "flattening the scene"));
}

/* The number of primitives, as far as known before solids are split; and world->authored.draws. */
static bool count_drawable(struct flattening *f, const struct node *root, uint32_t *count) {
    uint32_t *drawable = mem_alloc_zero(f->scene->node_total, sizeof *drawable);
    uint8_t *draws = arena_alloc_array(f->arena, f->scene->node_total, sizeof *draws);
    bool ok = (drawable && draws) || error_no_memory(f->error, "flattening the scene");
    ok = ok && count_nodes(f, root, drawable, draws);
    *count = ok ? drawable[root->index] : 0;
    f->world->authored.draws = draws;
    mem_free(drawable);
    return ok;
}

/* --- placing --- */

typedef bool surface_test(const struct surface_material *material);

static bool any_slot(const struct flattening *f, uint32_t material, uint32_t slot_count, surface_test *is) {
    const struct material **materials = f->world->authored.materials;
    for (uint32_t i = 0; i < (slot_count > 1 ? slot_count : 1); i++) {
        struct surface_material surface = surface_material_make(materials[material + i], false, NULL);
        if (is(&surface))
            return true;
    }
    return false;
}

static bool has_holes(const struct surface_material *material) {
    return surface_has_holes(material);
}

static bool holds_medium(const struct surface_material *material) {
    return material->holds_medium;
}

static bool hides_medium(const struct surface_material *material) {
    return material->holds_medium && !surface_passes(material);
}

/* Whether one of the materials of a prototype is such; what clips it has none. */
static bool any_material(const struct flattening *f, const struct prototype *prototype, surface_test *is) {
    const struct csg *csg = prototype->geometry.csg;
    uint32_t end = !csg ? 0 : csg->clipped ? csg->program[csg->solid_length].leaf : csg->leaf_count;
    for (uint32_t i = 0; i < end; i++)
        if (any_slot(f, csg->leaves[i].material, csg->leaves[i].slot_count, is))
            return true;
    return !csg && any_slot(f, prototype->material, prototype->slot_count, is);
}

/* Whether a box is wholly in a leaf, which its corners tell of convex ones; of others it is not known. */
static bool holds_box(const struct csg_leaf *leaf, const struct box *box) {
    enum hit_convexity convexity = shape_convexity(&leaf->shape);
    bool holds = convexity == CONVEXITY_BEHIND || convexity == CONVEXITY_PLANAR;
    for (unsigned i = 0; i < 8 && holds; i++) {
        struct vec3 corner = box_corner(box, i);
        holds = vec3_finite(corner) &&
                shape_contains(&leaf->shape, affine_point(&leaf->csg_from_leaf.inverse, corner), NULL);
    }
    return holds;
}

/* Whether a clipped solid is certainly whole: in the intersection of convex solids. */
static bool is_whole(const struct csg *csg) {
    uint32_t shown = csg->program[csg->solid_length].leaf;
    struct box solid = box_empty();
    bool whole = !csg->open;
    for (uint32_t i = 0; i < shown; i++) {
        struct box box = shape_bounds_under(&csg->leaves[i].shape, &csg->leaves[i].csg_from_leaf.forward);
        solid = box_join(solid, box);
    }
    for (uint32_t i = csg->solid_length; whole && i < csg->program_length; i++) {
        const struct csg_token *token = &csg->program[i];
        whole = token->operation == CSG_LEAF ? holds_box(&csg->leaves[token->leaf], &solid)
                                             : token->operation == CSG_INTERSECTION;
    }
    return whole;
}

/* A transparent surface that encloses nothing is a thin wall, unless the node says otherwise; solids with small holes
 * enclose nearly all that they seem to. */
static bool find_walls(struct flattening *f, enum node_walls walls, struct prototype *prototype) {
    const double smallest_opening = 0.05; /* of a sheet, as a share of its area */
    const struct mesh *mesh = geometry_mesh(&prototype->geometry);
    const struct csg *csg = prototype->geometry.csg;
    bool by_shape = walls == WALLS_BY_SHAPE && !f->unqueried && !geometry_is_closed(&prototype->geometry);
    if ((walls != WALLS_THIN && !by_shape) || !any_material(f, prototype, surface_divides_media))
        return true;
    double opening = 1;
    if (by_shape && mesh && !mesh_opening(mesh, &opening))
        return error_no_memory(f->error, "the edges of a mesh");
    by_shape = by_shape && opening > smallest_opening && !(csg && is_whole(csg));
    prototype->is_thin = by_shape || walls == WALLS_THIN;
    prototype->by_shape = by_shape;
    f->world->has_thin_walls = f->world->has_thin_walls || prototype->is_thin;
    return true;
}

/* Makes room for one more entry in a list that doubles. */
static void *room_for_one(void *list, uint32_t count, uint32_t *capacity, size_t size) {
    if (count < *capacity)
        return list;
    uint32_t wanted = *capacity ? *capacity * 2 : 64;
    void *moved = mem_resize_array(list, wanted, size);
    if (moved)
        *capacity = wanted;
    return moved;
}

static bool instantiate_moving(struct flattening *f, const struct pose *pose, struct primitive *out) {
    struct world *world = f->world;
    struct moving *moving =
        room_for_one(world->moving, world->moving_count, &f->moving_capacity, sizeof *world->moving);
    if (!moving)
        return error_no_memory(f->error, "the moving primitives");
    world->moving = moving;
    out->linear = LINEAR_MOVING | world->moving_count;
    moving[world->moving_count++] = (struct moving){pose->above, pose->from_node};
    return true;
}

/* Makes room for more than was counted: a union of several parts. */
static bool grow_primitives(struct flattening *f) {
    uint32_t count = f->world->primitive_count, capacity = f->primitive_capacity + f->primitive_capacity / 2 + 16;
    if (count >= PRIMITIVE_LIMIT)
        return error_set(f->error, ERROR_SCENE, "the scene places more than %d primitives", PRIMITIVE_LIMIT);
    struct primitive *primitive = arena_alloc_array(f->arena, capacity, sizeof *primitive);
    struct box *limits = f->limits ? arena_alloc_array(f->arena, capacity, sizeof *limits) : NULL;
    if (!primitive || (f->limits && !limits))
        return error_set(f->error, ERROR_MACHINE, "out of memory for %u placed primitives", capacity);
    memcpy(primitive, f->primitives, count * sizeof *primitive);
    if (limits)
        memcpy(limits, f->limits, count * sizeof *limits);
    f->world->primitives = f->primitives = primitive;
    f->limits = limits;
    f->primitive_capacity = capacity;
    return true;
}

/* The box of the next primitive. The list is created with the first one. */
static bool keep_limit(struct flattening *f, const struct box *limit) {
    const struct box everywhere = {vec3_all(-INFINITY), vec3_all(INFINITY)};
    if (!f->limits) {
        f->limits = arena_alloc_array(f->arena, f->primitive_capacity, sizeof *f->limits);
        if (!f->limits)
            return error_no_memory(f->error, "the boxes of the scene");
        for (uint32_t i = 0; i < f->world->primitive_count; i++)
            f->limits[i] = everywhere;
    }
    f->limits[f->world->primitive_count] = limit ? *limit : everywhere;
    return true;
}

static bool instantiate(struct flattening *f, const struct pose *pose, const struct graphics_state *state,
                        uint32_t prototype) {
    struct world *world = f->world;
    if (world->primitive_count == f->primitive_capacity && !grow_primitives(f))
        return false;
    if ((state || f->limits) && !keep_limit(f, state && pose->above == LINK_NONE ? &state->limit : NULL))
        return false;
    struct primitive *primitive = &f->primitives[world->primitive_count++];
    primitive->prototype = prototype;
    return pose->above != LINK_NONE ? instantiate_moving(f, pose, primitive)
                                    : flatten_map(f, &pose->from_node, primitive);
}

bool flatten_mesh_accel(struct flattening *f, const struct shape *shape) {
    return shape->kind != SHAPE_MESH || mesh_build_accel(shape->mesh, f->world->mesh_accel, f->pool, f->error);
}

/* The name of a prototype's node in messages. */
static bool add_prototype(struct flattening *f, const struct node *node, struct prototype *prototype) {
    if (!find_walls(f, node->walls, prototype))
        return false;
    if (prototype->is_thin && any_material(f, prototype, holds_medium))
        return error_set(f->error, ERROR_SCENE, "node '%.100s' is open, so it holds no medium", node->name);
    if (any_material(f, prototype, hides_medium))
        return error_set(f->error, ERROR_SCENE, "node '%.100s': its material is opaque, so no light reaches its medium",
                         node->name);
    struct world *world = f->world;
    uint32_t capacity = f->prototype_capacity;
    struct prototype *prototypes =
        room_for_one(world->prototypes, world->prototype_count, &capacity, sizeof *world->prototypes);
    if (prototypes)
        world->prototypes = prototypes;
    const struct node **nodes = prototypes ? room_for_one(world->authored.nodes, world->prototype_count,
                                                          &f->prototype_capacity, sizeof *world->authored.nodes)
                                           : NULL;
    if (!nodes)
        return error_no_memory(f->error, "the primitives of the scene");
    world->authored.nodes = nodes;
    prototype->holes = any_material(f, prototype, has_holes);
    prototypes[world->prototype_count] = *prototype;
    nodes[world->prototype_count++] = node;
    return true;
}

static bool make_csg(struct flattening *f, const struct node *node, const struct pose *pose,
                     const struct graphics_state *state) {
    const struct csg **parts;
    uint32_t count;
    if (!flatten_csg(f, node, pose, state, &parts, &count))
        return false;
    for (uint32_t i = 0; i < count; i++) {
        struct prototype prototype = {.geometry = geometry_of_csg(parts[i]), .slot_count = 1, .parts = count - i};
        prototype.is_later_part = i > 0;
        if (!add_prototype(f, node, &prototype))
            return false;
    }
    return true;
}

/* Prepares the shape of a node for rays, and its materials: the prototypes from `first` on, or none. */
static bool make_prototype(struct flattening *f, const struct node *node, const struct pose *pose,
                           const struct graphics_state *state, uint32_t *first, uint32_t *parts) {
    *first = f->world->prototype_count;
    *parts = 0;
    if (node->kind == NODE_GEOMETRY && !node_has_surface(node))
        return true;
    if (node->kind == NODE_CSG || (state && state->clips)) {
        if (!make_csg(f, node, pose, state))
            return false;
    } else {
        struct prototype prototype = {.geometry = geometry_of_shape(&node->shape), .cull = node->cull, .parts = 1};
        const struct material *inherited = state ? state->inherited : NULL;
        if ((!f->unqueried && !flatten_mesh_accel(f, &node->shape)) ||
            !flatten_material(f, node, inherited, &prototype.material, &prototype.slot_count) ||
            !add_prototype(f, node, &prototype))
            return false;
    }
    *parts = f->world->prototype_count - *first;
    return true;
}

/* Prototypes are made at the first instance of their node, or at every one if ancestors affect them. */
static bool find_prototype(struct flattening *f, const struct node *node, const struct pose *pose,
                           const struct graphics_state *state, uint32_t *first, uint32_t *parts) {
    if (state && (state->clips || state->inherited))
        return make_prototype(f, node, pose, state, first, parts);
    uint32_t *known = &f->prototype_of[node->index];
    if (*known == PROTOTYPE_UNKNOWN) {
        if (!make_prototype(f, node, pose, state, first, parts))
            return false;
        *known = *parts > 0 ? *first : PROTOTYPE_NOTHING;
        return true;
    }
    *first = *known;
    *parts = *known == PROTOTYPE_NOTHING ? 0 : f->world->prototypes[*known].parts;
    return true;
}

static bool instantiate_node(struct flattening *f, const struct node *node, const struct pose *pose,
                             const struct graphics_state *state) {
    uint32_t first, parts;
    if ((node->kind != NODE_GEOMETRY && node->kind != NODE_CSG) || node_is_placing(node))
        return true;
    if (!find_prototype(f, node, pose, state, &first, &parts))
        return false;
    for (uint32_t i = 0; i < parts; i++)
        if (!instantiate(f, pose, state, first + i))
            return false;
    return true;
}

/* --- the log --- */

void flatten_log_clear(struct flatten_log *log) {
    mem_free(log->records);
    mem_free(log->inside);
    linear_table_destroy(log->linear_table);
    *log = (struct flatten_log){.on = false};
}

/* Empty, but it keeps room for records. */
static void flatten_log_begin(struct flatten_log *log, uint32_t node_total) {
    struct flatten_record *records = log->records;
    uint32_t capacity = log->capacity;
    log->records = NULL;
    flatten_log_clear(log);
    *log = (struct flatten_log){.on = true, .records = records, .capacity = capacity, .node_total = node_total};
}

/* The operands of a solid are part of its prototype. */
static bool mark_inside(struct flattening *f, const struct node *solid) {
    struct flatten_log *log = f->log;
    struct scene_traversal t = {.operands = OPERANDS_ALL, .distinct = true, .inside = true};
    enum scene_event event = SCENE_NO_MEMORY;
    if (!log->inside)
        log->inside = mem_alloc_zero(f->scene->node_total, 1);
    scene_traversal_begin(&t, solid);
    while (log->inside && (event = scene_traversal_next(&t)) < SCENE_END) {
        const struct node *node = scene_traversal_node(&t);
        if (event != SCENE_ENTER || node == solid)
            continue;
        if (log->inside[node->index])
            scene_traversal_skip(&t);
        log->inside[node->index] = 1;
    }
    scene_traversal_end(&t);
    return event == SCENE_END;
}

/* Without memory nothing is recorded, which is no error. Moving nodes, clips and bounds affect what is below them. */
static void add_record(struct flattening *f, const struct flatten_record *record) {
    struct flatten_log *log = f->log;
    enum { RECORDS_MAX = 1 << 22 };
    if (!log || !log->on)
        return;
    bool fits = log->count < RECORDS_MAX && !node_moves(record->node) && !node_is_placing(record->node) &&
                (record->node->kind != NODE_CSG || mark_inside(f, record->node));
    struct flatten_record *records =
        fits ? room_for_one(log->records, log->count, &log->capacity, sizeof *records) : NULL;
    if (!records) {
        flatten_log_clear(log);
        return;
    }
    log->records = records;
    records[log->count++] = *record;
}

/* Data of every node on the path. Clips and bounds of an operand do not apply to the children of the node. */
struct instance_frame {
    struct pose pose, of_children;
    uint32_t record;
    const struct graphics_state *state_of_operand, *state; /* NULL: no ancestor has a state */
};

/* A spin goes on over the frames of an animation. */
static double spin_start(const struct flattening *f, const struct node *node) {
    return math_fmod(node->spin->degrees * f->scene->time, 360);
}

/* A moving node has a link, which is the base of its children. */
static bool pose_moving(struct flattening *f, const struct node *node, const struct pose *parent, struct pose *out) {
    struct world *world = f->world;
    struct moving_link *links = room_for_one(world->links, world->link_count, &f->link_capacity, sizeof *links);
    if (!links)
        return error_no_memory(f->error, "the moving primitives");
    world->links = links;
    struct moving_link *link = &links[world->link_count];
    struct transform parent_from_node = node_parent_from_node(node);
    *link = (struct moving_link){.above = parent->above, .above_from_node = parent->from_node};
    *out = (struct pose){world->link_count++, parent_from_node};
    /* A motion that begins and ends in the same pose counts as none. The pose itself moves, so nothing is below it. */
    bool moves_on = node->moves_to && node->moves_to != node;
    if (!moves_on && node->spin) {
        link->motion = motion_of_spin(&parent_from_node, node->velocity, node->spin->axis, node->spin->degrees);
        link->motion.spin_start = spin_start(f, node);
        out->from_node = transform_identity();
        return flatten_check_transform(f, node, &parent_from_node);
    }
    if (!moves_on) {
        link->motion = motion_of_velocity(node->velocity);
        return true;
    }
    /* From one pose to the other, as rotation, scale and translation. */
    struct transform end = node_parent_from_node(node->moves_to);
    if (!flatten_check_transform(f, node, &parent_from_node) || !flatten_check_transform(f, node->moves_to, &end))
        return false;
    out->from_node = transform_identity();
    if (!motion_interpolate(&parent_from_node, &end, node->velocity, &link->motion))
        return error_set(f->error, ERROR_SCENE, "node '%.100s' moves to its mirror image, which no rotation reaches",
                         node->name);
    if (node->spin) {
        link->motion.spins = true;
        link->motion.spin_axis = node->spin->axis;
        link->motion.spin = node->spin->degrees;
        link->motion.spin_start = spin_start(f, node);
    }
    return true;
}

/* The state that a clipped or bounded node gives its operand; NULL without memory or for an error. */
static const struct graphics_state *surround(struct flattening *f, const struct node *node, const struct pose *pose,
                                             const struct graphics_state *state) {
    struct graphics_state *own = arena_alloc(f->arena, sizeof *own);
    struct clip *clip = arena_alloc(f->arena, sizeof *clip);
    if (!own || !clip) {
        error_no_memory(f->error, "flattening the scene");
        return NULL;
    }
    *own = (struct graphics_state){.limit = {vec3_all(-INFINITY), vec3_all(INFINITY)}};
    if (state)
        *own = *state;
    if (node->material)
        own->inherited = node->material;
    if (node->operation == NODE_BOUNDED) /* the hint is ignored below moving nodes */
        return pose->above != LINK_NONE || flatten_limit(f, node->operands[1], &pose->from_node, &own->limit) ? own
                                                                                                              : NULL;
    *clip = (struct clip){node->operands[1], *pose, own->clips};
    own->clips = clip;
    return own;
}

bool flatten_check_transform(struct flattening *f, const struct node *node, const struct transform *t) {
    return transform_is_finite(t) ||
           error_set(f->error, ERROR_SCENE,
                     "node '%.100s': its transforms and those above it multiply to numbers that are too large or too "
                     "small",
                     node->name);
}

static bool enter_node(struct flattening *f, const struct node *node, const struct pose *parent,
                       const struct graphics_state *state, struct instance_frame *frame) {
    frame->pose.above = parent->above;
    frame->state = state;
    if (node_moves(node)) {
        if (!pose_moving(f, node, parent, &frame->pose))
            return false;
    } else {
        struct transform parent_from_node = node_parent_from_node(node);
        frame->pose.from_node = transform_compose(&parent->from_node, &parent_from_node);
    }
    if (!flatten_check_transform(f, node, &frame->pose.from_node) || !instantiate_node(f, node, &frame->pose, state))
        return false;
    bool operand = node_is_placing(node) && f->world->authored.draws[node->operands[0]->index];
    frame->state_of_operand = operand ? surround(f, node, &frame->pose, state) : NULL;
    return !operand || frame->state_of_operand;
}

static bool instantiate_all(struct flattening *f, struct scene_traversal *t) {
    const struct pose ground = {LINK_NONE, transform_identity()};
    enum scene_event event;
    uint32_t steps = 0;
    while ((event = scene_traversal_next(t)) < SCENE_END) {
        struct instance_frame *frame = scene_traversal_frame(t, 0);
        if ((++steps & 4095) == 0 && pool_cancelled(f->pool))
            return error_set(f->error, ERROR_CANCELLED, "stopped while the scene was flattened");
        if (event == SCENE_CHILDREN)
            frame->of_children =
                (struct pose){frame->pose.above, scene_step_map(&t->steps[t->depth - 1], &frame->pose.from_node)};
        if (event != SCENE_ENTER)
            continue;
        /* Operands stand in the space of their node, children in that of its placement. */
        const struct instance_frame *above = t->depth > 1 ? scene_traversal_frame(t, 1) : NULL;
        bool operand = above && scene_traversal_operand(t) != SCENE_CHILD;
        const struct pose *parent = !above ? &ground : operand ? &above->pose : &above->of_children;
        const struct graphics_state *state = !above ? NULL : operand ? above->state_of_operand : above->state;
        const struct node *node = scene_traversal_node(t);
        frame->record = f->log ? f->log->count : 0;
        add_record(f, &(struct flatten_record){.node = node,
                                               .index = node->index,
                                               .above = above ? above->record : RECORD_NONE,
                                               .placement = above ? t->steps[t->depth - 2].placement : 0,
                                               .first = f->world->primitive_count});
        if (!enter_node(f, node, parent, state, frame))
            return false;
    }
    return event == SCENE_END || error_no_memory(f->error, "flattening the scene");
}

static bool instantiate_scene(struct flattening *f, const struct node *root) {
    uint32_t total = f->scene->node_total;
    f->prototype_of = mem_alloc(total * sizeof *f->prototype_of);
    if (!f->prototype_of)
        return error_no_memory(f->error, "flattening the scene");
    for (uint32_t i = 0; i < total; i++)
        f->prototype_of[i] = PROTOTYPE_UNKNOWN;
    struct scene_traversal t = world_traversal(f->world, root, sizeof(struct instance_frame));
    bool ok = instantiate_all(f, &t);
    scene_traversal_end(&t);
    mem_free(f->prototype_of);
    return ok;
}

bool flatten_scene(struct flattening *f, const struct node *root) {
    uint32_t count;
    if (!count_drawable(f, root, &count))
        return false;
    if (count > PRIMITIVE_LIMIT)
        return error_set(f->error, ERROR_SCENE, "the scene places more than %d primitives (instances of instances?)",
                         PRIMITIVE_LIMIT);
    f->primitive_capacity = count;
    f->primitives = arena_alloc_array(f->arena, f->primitive_capacity, sizeof *f->primitives);
    if (!f->primitives)
        return error_set(f->error, ERROR_MACHINE, "out of memory for %u placed primitives", f->primitive_capacity);
    f->world->primitives = f->primitives;
    if (f->log)
        flatten_log_begin(f->log, f->scene->node_total);
    bool ok = instantiate_scene(f, root);
    flatten_map_end(f);
    if (f->log && f->log->on)
        f->log->primitives = f->primitives;
    return ok;
}

/* --- maps --- */

/* Placements as a translation and the number of a linear map: a million pots in rows share one map, and cost 56 bytes
 * each instead of 192 for a map with its inverse. A hash over the bits finds equal maps; the newest is tested first. */

struct linear_table {
    uint32_t *slots; /* number of a map and 1, or 0 */
    uint64_t mask;
};

static uint64_t hash_of(const struct linear_map *map) {
    return hash_bytes(map, sizeof map->forward + sizeof map->inverse, 0);
}

static bool same_map(const struct linear_map *a, const struct linear_map *b) {
    return memcmp(a, b, sizeof a->forward + sizeof a->inverse) == 0;
}

static uint32_t *find_map(const struct flattening *f, const struct linear_map *map) {
    const struct linear_table *table = f->linear_table;
    uint64_t at = hash_of(map) & table->mask;
    while (table->slots[at] && !same_map(&f->world->linear_maps[table->slots[at] - 1], map))
        at = (at + 1) & table->mask;
    return &table->slots[at];
}

/* Room for one more map, in the list and in the table, which is at most half full. */
static bool grow_maps(struct flattening *f) {
    struct world *world = f->world;
    if (world->linear_count < f->linear_capacity)
        return true;
    uint32_t capacity = f->linear_capacity ? f->linear_capacity * 2 : 64;
    struct linear_map *maps = mem_resize_array(world->linear_maps, capacity, sizeof *maps);
    if (!maps)
        return false;
    world->linear_maps = maps;
    if (!f->linear_table && !(f->linear_table = mem_alloc_zero(1, sizeof *f->linear_table)))
        return false;
    uint32_t *slots = mem_alloc_zero((size_t)capacity * 2, sizeof *slots);
    if (!slots)
        return false;
    mem_free(f->linear_table->slots);
    *f->linear_table = (struct linear_table){slots, (uint64_t)capacity * 2 - 1};
    f->linear_capacity = capacity;
    for (uint32_t i = 0; i < world->linear_count; i++)
        *find_map(f, &maps[i]) = i + 1;
    return true;
}

bool flatten_map(struct flattening *f, const struct transform *world_from_object, struct primitive *out) {
    struct transform nothing = transform_identity();
    struct world *world = f->world;
    if (memcmp(&nothing, world_from_object, sizeof nothing) == 0) {
        out->linear = LINEAR_NONE;
        return true;
    }
    struct linear_map map = {.stretch = transform_stretch(world_from_object)};
    const double(*forward)[4] = world_from_object->forward.m, (*inverse)[4] = world_from_object->inverse.m;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            map.forward[i][j] = forward[i][j];
            map.inverse[i][j] = inverse[i][j];
        }
    }
    out->shift = vec3_make(forward[0][3], forward[1][3], forward[2][3]);
    out->shift_back = vec3_make(inverse[0][3], inverse[1][3], inverse[2][3]);
    /* Placements in a row often share the map of the one before. */
    out->linear = world->linear_count - 1;
    if (world->linear_count > 0 && same_map(&map, &world->linear_maps[out->linear]))
        return true;
    if (!grow_maps(f))
        return error_no_memory(f->error, "the positions of the primitives");
    uint32_t *slot = find_map(f, &map);
    if (*slot == 0) {
        world->linear_maps[world->linear_count++] = map;
        *slot = world->linear_count;
    }
    out->linear = *slot - 1;
    return true;
}

void linear_table_destroy(struct linear_table *table) {
    if (table)
        mem_free(table->slots);
    mem_free(table);
}

void flatten_map_end(struct flattening *f) {
    struct flatten_log *log = f->log;
    if (log && log->on) {
        log->linear_table = f->linear_table;
        log->linear_capacity = f->linear_capacity;
        log->linear_count = f->world->linear_count;
        f->linear_table = NULL;
        return;
    }
    linear_table_destroy(f->linear_table);
    f->linear_table = NULL;
    /* Frees the unused part of the list; on failure it is kept. */
    struct world *world = f->world;
    struct linear_map *maps = mem_resize_array(world->linear_maps, world->linear_count, sizeof *maps);
    world->linear_maps = maps ? maps : world->linear_maps;
}

/* --- changes of transforms --- */

/* The primitives of nodes whose transforms have changed since the world was flattened. The log lists the nodes in the
 * order in which they were visited, each after the node above it, so one pass finds the nodes whose pose may differ.
 * Their poses are composed anew from the root, in the order of flattening: the bits are those of a new world. Only the
 * numbers of linear maps may differ, which nothing depends on. */

enum { NODE_DEPTH_MAX = 64 };

struct update {
    struct flattening *f;
    uint8_t *posed;          /* by index of a node: its transforms have changed */
    uint32_t *number;        /* by record: that of its pose, or RECORD_NONE: it is as before */
    struct transform *poses; /* of those records */
    uint32_t count, capacity;
};

static bool mark_posed(struct update *u, const struct scene_changes *changes, bool *done) {
    const struct flatten_log *log = u->f->log;
    for (uint32_t i = 0; i < changes->posed_count; i++) {
        const struct node *node = changes->posed[i].node;
        if (node->index >= log->node_total)
            continue; /* newer than the world, so it is not below the root */
        if (node->singular || (log->inside && log->inside[node->index]))
            *done = false;
        u->posed[node->index] = 1;
    }
    return *done;
}

static const struct transform *known_pose(const struct update *u, uint32_t record) {
    return u->number[record] == RECORD_NONE ? NULL : &u->poses[u->number[record]];
}

/* world_from_node, composed from the nearest node above it whose pose is known. False: the path is too long. */
static bool find_pose(const struct update *u, uint32_t record, struct transform *out) {
    const struct flatten_record *records = u->f->log->records;
    uint32_t path[NODE_DEPTH_MAX];
    int depth = 0;
    *out = transform_identity();
    /* Upwards to a pose that is known, then down again in the order of flattening, which decides the bits. */
    for (uint32_t at = record; at != RECORD_NONE; at = records[at].above) {
        const struct transform *known = at == record ? NULL : known_pose(u, at);
        if (known) {
            *out = *known;
            break;
        }
        if (depth == NODE_DEPTH_MAX)
            return false;
        path[depth++] = at;
    }
    while (depth > 0) {
        const struct flatten_record *r = &records[path[--depth]];
        struct transform parent_from_node = node_parent_from_node(r->node);
        if (r->above != RECORD_NONE) {
            const struct scene_step step = {records[r->above].node, r->placement};
            *out = scene_step_map(&step, out);
        }
        *out = transform_compose(out, &parent_from_node);
    }
    return true;
}

static struct transform *room_for_pose(struct update *u) {
    if (u->count == u->capacity) {
        uint32_t capacity = 2 * u->capacity + 64;
        struct transform *poses = mem_resize_array(u->poses, capacity, sizeof *poses);
        if (!poses)
            return NULL;
        u->poses = poses;
        u->capacity = capacity;
    }
    return &u->poses[u->count];
}

static bool update_record(struct update *u, uint32_t record, bool *done) {
    struct flattening *f = u->f;
    struct world *world = f->world;
    const struct flatten_log *log = f->log;
    struct transform *pose = room_for_pose(u);
    if (!pose)
        return error_no_memory(f->error, "flattening the scene");
    *done = find_pose(u, record, pose);
    if (!*done)
        return true;
    u->number[record] = u->count++;
    if (!flatten_check_transform(f, log->records[record].node, pose))
        return false;
    uint32_t end = record + 1 < log->count ? log->records[record + 1].first : world->primitive_count;
    for (uint32_t i = log->records[record].first; *done && i < end; i++) {
        log->primitives[i] = (struct primitive){.prototype = log->primitives[i].prototype};
        if (!flatten_map(f, pose, &log->primitives[i]))
            return false;
        *done = world_update_box(world, i);
    }
    return true;
}

/* Stops where most linear maps are out of use. */
static bool update_records(struct update *u, bool *done) {
    const struct flatten_log *log = u->f->log;
    const struct world *world = u->f->world;
    bool ok = true;
    for (uint32_t i = 0; ok && *done && i < log->count; i++) {
        const struct flatten_record *r = &log->records[i];
        u->number[i] = RECORD_NONE;
        if (!u->posed[r->index] && (r->above == RECORD_NONE || u->number[r->above] == RECORD_NONE))
            continue;
        ok = update_record(u, i, done);
        *done = *done && world->linear_count <= 4096 + 2 * log->linear_count;
    }
    return ok;
}

bool flatten_update(struct flattening *f, const struct scene_changes *changes, bool *done) {
    struct flatten_log *log = f->log;
    *done = log->on && !changes->other;
    if (!*done || changes->posed_count == 0)
        return true;
    struct update update = {.f = f,
                            .posed = mem_alloc_zero(log->node_total, 1),
                            .number = mem_alloc((size_t)log->count * sizeof *update.number)};
    f->linear_table = log->linear_table;
    f->linear_capacity = log->linear_capacity;
    log->linear_table = NULL;
    bool ok = (update.posed && update.number) || error_no_memory(f->error, "flattening the scene");
    ok = ok && (!mark_posed(&update, changes, done) || update_records(&update, done));
    log->linear_table = f->linear_table;
    log->linear_capacity = f->linear_capacity;
    f->linear_table = NULL;
    f->linear_capacity = 0;
    mem_free(update.posed);
    mem_free(update.number);
    mem_free(update.poses);
    return ok;
}
