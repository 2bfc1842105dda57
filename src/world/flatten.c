/* Flattening of the node DAG. First a walk over the distinct nodes finds cycles and counts what each node will place
 * (saturating), so that a tree that doubles at every level is refused, or skipped where it places nothing, before any
 * memory is taken. Then every path from the root to a primitive makes one placed primitive. Both walks keep their own
 * stack: depth is limited by memory alone. */
#include "world/flatten.h"

#include "base/mem.h"

#include <stdio.h>
#include <string.h>

enum { PLACED_LIMIT = 1 << 28 };

/* --- counting and cycles --- */

struct count_frame {
    struct node *node;
    struct node_child *next;
    uint32_t operand; /* of a CSG node, to visit before the children */
};

struct stack {
    void *items;
    size_t count, capacity, size;
};

static void *stack_push(struct stack *stack) {
    if (stack->count == stack->capacity) {
        size_t capacity = stack->capacity ? stack->capacity * 2 : 64;
        void *items = mem_resize_array(stack->items, capacity, stack->size);
        if (!items)
            return NULL;
        stack->items = items;
        stack->capacity = capacity;
    }
    return (char *)stack->items + stack->count++ * stack->size;
}

static void *stack_top(const struct stack *stack) {
    return (char *)stack->items + (stack->count - 1) * stack->size;
}

static bool tell_cycle(struct flattening *f, const struct stack *stack, const struct node *again) {
    char names[512];
    size_t used = 0, first = 0;
    const struct count_frame *frames = stack->items;
    while (frames[first].node != again)
        first++;
    for (size_t i = first; i <= stack->count && used < sizeof names - 120; i++) {
        const struct node *node = i == stack->count ? again : frames[i].node;
        if (i - first >= 6 && i != stack->count) {
            if (i - first == 6)
                used += (size_t)snprintf(names + used, sizeof names - used, " > ...");
            continue;
        }
        used += (size_t)snprintf(names + used, sizeof names - used, "%s'%.60s'", i > first ? " > " : "", node->name);
    }
    return error_set(f->error, ERROR_SCENE, "the nodes form a cycle: %s", names);
}

static struct node *next_below(struct count_frame *frame) {
    struct node *node = frame->node;
    if (node->kind == NODE_CSG && frame->operand < node->operand_count)
        return node->operands[frame->operand++];
    if (!frame->next)
        return NULL;
    struct node *child = frame->next->node;
    frame->next = frame->next->next;
    return child;
}

static uint64_t add_saturating(uint64_t a, uint64_t b) {
    return a > UINT64_MAX - b ? UINT64_MAX : a + b;
}

static uint64_t multiply_saturating(uint64_t a, uint64_t b) {
    return b > 0 && a > UINT64_MAX / b ? UINT64_MAX : a * b;
}

static void clear_marks(struct node *root, struct stack *stack) {
    /* Marks are cleared by the same walk backwards: 2 becomes 0 where it is met first. */
    stack->count = 0;
    struct node **slot = stack_push(stack);
    if (!slot)
        return;
    *slot = root;
    while (stack->count > 0) {
        struct node *node = *(struct node **)stack_top(stack);
        stack->count--;
        if (node->mark == 0)
            continue;
        node->mark = 0;
        for (uint32_t i = 0; node->kind == NODE_CSG && i < node->operand_count; i++)
            if (node->operands[i]->mark && (slot = stack_push(stack)))
                *slot = node->operands[i];
        for (struct node_child *child = node->first_child; child; child = child->next) {
            if (child->node->mark && (slot = stack_push(stack)))
                *slot = child->node;
        }
    }
}

/* What a node places itself, without its children. */
static uint64_t own_drawable(const struct node *node) {
    if (node->kind == NODE_CSG && (node->operation == NODE_CLIPPED || node->operation == NODE_BOUNDED))
        return node->operands[0]->drawable;
    return node->kind == NODE_GEOMETRY || node->kind == NODE_CSG ? 1 : 0;
}

static bool count_drawable(struct flattening *f, struct node *root) {
    struct stack stack = {.size = sizeof(struct count_frame)};
    bool ok = true;
    struct count_frame *frame = stack_push(&stack);
    if (!frame)
        return error_no_memory(f->error, "flattening the scene");
    *frame = (struct count_frame){.node = root, .next = root->first_child};
    root->mark = 1;
    root->thing = 0;
    while (ok && stack.count > 0) {
        frame = stack_top(&stack);
        struct node *below = next_below(frame);
        if (below && below->mark == 1) {
            ok = tell_cycle(f, &stack, below);
        } else if (below && below->mark == 0) {
            below->mark = 1;
            below->thing = 0;
            frame = stack_push(&stack);
            if (!frame)
                ok = error_no_memory(f->error, "flattening the scene");
            else
                *frame = (struct count_frame){.node = below, .next = below->first_child};
        } else if (!below) {
            struct node *node = frame->node;
            uint64_t own = own_drawable(node), below_it = 0;
            for (struct node_child *child = node->first_child; child; child = child->next)
                below_it = add_saturating(below_it, child->node->drawable);
            if (node->placements)
                below_it = multiply_saturating(below_it, node->placements->count);
            node->drawable = node->singular ? 0 : add_saturating(own, below_it);
            node->mark = 2;
            stack.count--;
        }
    }
    mem_free(stack.items);
    struct stack marks = {.size = sizeof(struct node *)};
    clear_marks(root, &marks);
    mem_free(marks.items);
    return ok;
}

/* --- placing --- */

static bool any_holes(const struct flattening *f, const struct shape *shape, uint32_t material, uint32_t slot_count) {
    const struct material **materials = f->world->materials;
    if (shape->kind == SHAPE_CSG) {
        for (uint32_t i = 0; i < shape->csg->leaf_count; i++) {
            const struct csg_leaf *leaf = &shape->csg->leaves[i];
            if (any_holes(f, &leaf->shape, leaf->material, leaf->slot_count))
                return true;
        }
        return false;
    }
    for (uint32_t i = 0; i < (slot_count > 1 ? slot_count : 1); i++)
        if (material_has_holes(materials[material + i]))
            return true;
    return false;
}

/* Room for one more in a list that doubles. */
static void *room_for_one(void *list, uint32_t count, uint32_t *capacity, size_t size) {
    if (count < *capacity)
        return list;
    uint32_t wanted = *capacity ? *capacity * 2 : 64;
    void *moved = mem_resize_array(list, wanted, size);
    if (moved)
        *capacity = wanted;
    return moved;
}

static bool place_moving(struct flattening *f, const struct stand *stand, struct placed *out) {
    struct world *world = f->world;
    struct moving *moving =
        room_for_one(world->moving, world->moving_count, &f->moving_capacity, sizeof *world->moving);
    if (!moving)
        return error_no_memory(f->error, "what moves in the scene");
    world->moving = moving;
    out->linear = LINEAR_MOVING | world->moving_count;
    moving[world->moving_count++] = (struct moving){stand->above, stand->from_node};
    return true;
}

/* Room for more than was counted: a union that is placed in parts. */
static bool grow_placed(struct flattening *f) {
    uint32_t count = f->world->placed_count, capacity = f->placed_capacity + f->placed_capacity / 2 + 16;
    if (count >= PLACED_LIMIT)
        return error_set(f->error, ERROR_SCENE, "the scene places more than %d primitives", PLACED_LIMIT);
    struct placed *placed = arena_alloc_array(f->arena, capacity, sizeof *placed);
    struct box *limits = f->limits ? arena_alloc_array(f->arena, capacity, sizeof *limits) : NULL;
    if (!placed || (f->limits && !limits))
        return error_set(f->error, ERROR_MACHINE, "out of memory for %u placed primitives", capacity);
    memcpy(placed, f->placed, count * sizeof *placed);
    if (limits)
        memcpy(limits, f->limits, count * sizeof *limits);
    f->world->placed = f->placed = placed;
    f->limits = limits;
    f->placed_capacity = capacity;
    return true;
}

/* The box of what is placed next. The list of them is made when the first one comes. */
static bool keep_limit(struct flattening *f, const struct box *limit) {
    const struct box everywhere = {vec3_all(-INFINITY), vec3_all(INFINITY)};
    if (!f->limits) {
        f->limits = arena_alloc_array(f->arena, f->placed_capacity, sizeof *f->limits);
        if (!f->limits)
            return error_no_memory(f->error, "the boxes of the scene");
        for (uint32_t i = 0; i < f->world->placed_count; i++)
            f->limits[i] = everywhere;
    }
    f->limits[f->world->placed_count] = limit ? *limit : everywhere;
    return true;
}

static bool place(struct flattening *f, const struct stand *stand, const struct surroundings *around, uint32_t thing) {
    struct world *world = f->world;
    if (world->placed_count == f->placed_capacity && !grow_placed(f))
        return false;
    if ((around || f->limits) && !keep_limit(f, around && !stand->above ? &around->limit : NULL))
        return false;
    struct placed *placed = &f->placed[world->placed_count++];
    placed->thing = thing;
    return stand->above ? place_moving(f, stand, placed) : flatten_map(f, &stand->from_node, placed);
}

bool flatten_mesh_accel(struct flattening *f, const struct shape *shape) {
    return shape->kind != SHAPE_MESH || mesh_build_accel(shape->mesh, f->world->mesh_accel, f->pool, f->error);
}

/* node->thing: 0 where it is not known yet, else its number and 1, or nothing to draw. */
enum { THING_NOTHING = -1 };

static bool add_thing(struct flattening *f, struct thing *thing) {
    struct world *world = f->world;
    struct thing *things = room_for_one(world->things, world->thing_count, &f->thing_capacity, sizeof *world->things);
    if (!things)
        return error_no_memory(f->error, "the things of the scene");
    world->things = things;
    thing->holes = any_holes(f, &thing->shape, thing->material, thing->slot_count);
    things[world->thing_count++] = *thing;
    return true;
}

static bool make_csg(struct flattening *f, struct node *node, const struct stand *stand,
                     const struct surroundings *around) {
    const struct csg **parts;
    uint32_t count;
    if (!flatten_csg(f, node, stand, around, &parts, &count))
        return false;
    for (uint32_t i = 0; i < count; i++) {
        struct thing thing = {
            .node = node, .shape = {.kind = SHAPE_CSG, .csg = parts[i]}, .slot_count = 1, .parts = count - i};
        thing.is_later_part = i > 0;
        if (!add_thing(f, &thing))
            return false;
    }
    return true;
}

/* The first time that a node is placed, or always where nodes above it have something to say: its shape, ready for
 * rays, and its materials. */
static bool make_thing(struct flattening *f, struct node *node, const struct stand *stand,
                       const struct surroundings *around) {
    uint32_t first = f->world->thing_count;
    node->thing = THING_NOTHING;
    if (node->kind == NODE_GEOMETRY && node->shape.kind == SHAPE_MESH && mesh_triangle_count(node->shape.mesh) == 0)
        return true;
    if (node->kind == NODE_CSG || (around && around->clips)) {
        if (!make_csg(f, node, stand, around))
            return false;
    } else {
        struct thing thing = {.node = node, .shape = node->shape, .cull = node->cull, .parts = 1};
        const struct material *inherited = around ? around->inherited : NULL;
        if (!flatten_mesh_accel(f, &node->shape) ||
            !flatten_material(f, node, inherited, &thing.material, &thing.slot_count) || !add_thing(f, &thing))
            return false;
    }
    if (f->world->thing_count > first)
        node->thing = (int)first + 1;
    return true;
}

static bool place_node(struct flattening *f, struct node *node, const struct stand *stand,
                       const struct surroundings *around) {
    if (node->kind != NODE_GEOMETRY && node->kind != NODE_CSG)
        return true;
    if (node->kind == NODE_CSG && (node->operation == NODE_CLIPPED || node->operation == NODE_BOUNDED))
        return true;
    bool special = around && (around->clips || around->inherited);
    if ((node->thing == 0 || special) && !make_thing(f, node, stand, around))
        return false;
    if (node->thing == THING_NOTHING) {
        node->thing = special ? 0 : THING_NOTHING;
        return true;
    }
    uint32_t first = (uint32_t)node->thing - 1, parts = f->world->things[first].parts;
    if (special)
        node->thing = 0;
    for (uint32_t i = 0; i < parts; i++)
        if (!place(f, stand, around, first + i))
            return false;
    return true;
}

struct place_frame {
    struct stand stand, of_children;
    struct node *node;
    struct node *operand; /* to be placed before the children, in surroundings of its own */
    const struct surroundings *around_operand, *around; /* NULL: nothing above says anything */
    struct node_child *next;
    uint32_t at; /* of the node's placements */
};

/* Children are placed once, or once for each placement of their node. */
static void begin_children(struct place_frame *frame, uint32_t at) {
    const struct placements *placements = frame->node->placements;
    frame->at = at;
    frame->next = frame->node->first_child;
    frame->of_children = frame->stand;
    if (placements) {
        struct transform node_from_child = placement_transform(placements, at);
        frame->of_children.from_node = transform_compose(&frame->stand.from_node, &node_from_child);
    }
}

/* A node that moves: a link of its own, on which what is under it stands. */
static bool stand_moving(struct flattening *f, const struct node *node, const struct stand *parent, struct stand *out) {
    struct moving_link *link = arena_alloc(f->arena, sizeof *link);
    if (!link)
        return error_no_memory(f->error, "what moves in the scene");
    struct transform parent_from_node = node_parent_from_node(node);
    *link = (struct moving_link){.above = parent->above, .above_from_node = parent->from_node};
    *out = (struct stand){link, parent_from_node};
    if (!node->moves_to || node->moves_to == node) {
        link->motion = motion_of_velocity(node->velocity);
        return true;
    }
    struct transform end = node_parent_from_node(node->moves_to);
    if (!flatten_check_transform(f, node, &parent_from_node) || !flatten_check_transform(f, node->moves_to, &end))
        return false;
    out->from_node = transform_identity();
    if (!motion_between(&parent_from_node, &end, node->velocity, &link->motion))
        return error_set(f->error, ERROR_SCENE, "node '%.100s' moves to its mirror image: there is no way between",
                         node->name);
    return true;
}

/* What a clipped or bounded node says about its operand; NULL without memory or for an error. */
static const struct surroundings *surround(struct flattening *f, const struct node *node, const struct stand *stand,
                                           const struct surroundings *around) {
    struct surroundings *own = arena_alloc(f->arena, sizeof *own);
    struct clip *clip = arena_alloc(f->arena, sizeof *clip);
    if (!own || !clip) {
        error_no_memory(f->error, "flattening the scene");
        return NULL;
    }
    *own = (struct surroundings){.limit = {vec3_all(-INFINITY), vec3_all(INFINITY)}};
    if (around)
        *own = *around;
    if (node->material)
        own->inherited = node->material;
    if (node->operation == NODE_BOUNDED) /* under what moves the hint is not taken */
        return stand->above || flatten_limit(f, node->operands[1], &stand->from_node, &own->limit) ? own : NULL;
    *clip = (struct clip){node->operands[1], *stand, own->clips};
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

static bool enter_node(struct flattening *f, struct stack *stack, const struct stand *parent,
                       const struct surroundings *around, struct node *node) {
    struct stand stand = {.above = parent->above};
    if (node_moves(node)) {
        if (!stand_moving(f, node, parent, &stand))
            return false;
    } else {
        struct transform parent_from_node = node_parent_from_node(node);
        stand.from_node = transform_compose(&parent->from_node, &parent_from_node);
    }
    if (!flatten_check_transform(f, node, &stand.from_node))
        return false;
    struct node *operand = node_places_operand(node);
    const struct surroundings *around_operand = NULL;
    if (!place_node(f, node, &stand, around))
        return false;
    if (operand && !(around_operand = surround(f, node, &stand, around)))
        return false;
    bool childless = !node->first_child || (node->placements && node->placements->count == 0);
    if (childless && !operand)
        return true;
    struct place_frame *frame = stack_push(stack);
    if (!frame)
        return error_no_memory(f->error, "flattening the scene");
    *frame = (struct place_frame){
        .stand = stand, .node = node, .operand = operand, .around_operand = around_operand, .around = around};
    if (!childless)
        begin_children(frame, 0);
    return true;
}

static bool place_all(struct flattening *f, struct stack *stack) {
    uint32_t steps = 0;
    while (stack->count > 0) {
        struct place_frame *frame = stack_top(stack);
        if (frame->operand) {
            struct node *operand = frame->operand;
            struct stand stand = frame->stand; /* the stack may move */
            frame->operand = NULL;
            if (!enter_node(f, stack, &stand, frame->around_operand, operand))
                return false;
            continue;
        }
        struct node_child *link = frame->next;
        if ((++steps & 4095) == 0 && pool_cancelled(f->pool))
            return error_set(f->error, ERROR_CANCELLED, "stopped while the scene was flattened");
        if (!link) {
            const struct placements *placements = frame->node->placements;
            if (placements && frame->at + 1 < placements->count)
                begin_children(frame, frame->at + 1);
            else
                stack->count--;
            continue;
        }
        frame->next = link->next;
        struct stand parent = frame->of_children; /* the stack may move */
        if (link->node->drawable > 0 && !enter_node(f, stack, &parent, frame->around, link->node))
            return false;
    }
    return true;
}

bool flatten_scene(struct flattening *f, struct node *root) {
    if (!count_drawable(f, root))
        return false;
    if (root->drawable > PLACED_LIMIT)
        return error_set(f->error, ERROR_SCENE, "the scene places more than %d primitives (instances of instances?)",
                         PLACED_LIMIT);
    f->placed_capacity = (uint32_t)root->drawable;
    f->placed = arena_alloc_array(f->arena, f->placed_capacity, sizeof *f->placed);
    if (!f->placed)
        return error_set(f->error, ERROR_MACHINE, "out of memory for %u placed primitives", f->placed_capacity);
    f->world->placed = f->placed;
    struct stack stack = {.size = sizeof(struct place_frame)};
    struct stand ground = {.from_node = transform_identity()};
    bool ok = root->drawable == 0 || (enter_node(f, &stack, &ground, NULL, root) && place_all(f, &stack));
    mem_free(stack.items);
    flatten_map_end(f);
    return ok;
}
