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
    int operand; /* 0, 1: operands of a CSG node to visit first; 2: children */
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
    while (frame->operand < 2) {
        struct node *operand = node->kind == NODE_CSG ? node->operands[frame->operand] : NULL;
        frame->operand++;
        if (operand)
            return operand;
    }
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
        for (int i = 0; i < 2; i++) {
            if (node->kind == NODE_CSG && node->operands[i] && node->operands[i]->mark) {
                if ((slot = stack_push(stack)))
                    *slot = node->operands[i];
            }
        }
        for (struct node_child *child = node->first_child; child; child = child->next) {
            if (child->node->mark && (slot = stack_push(stack)))
                *slot = child->node;
        }
    }
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
            uint64_t own = node->kind == NODE_GEOMETRY || node->kind == NODE_CSG ? 1 : 0, below_it = 0;
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

/* Where a node stands: fixed to the world, or to the moving node above it. */
struct stand {
    const struct moving_link *above; /* NULL: nothing above moves */
    struct transform from_node;      /* to the space of `above`, or to the world */
};

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

static bool place(struct flattening *f, const struct stand *stand, uint32_t thing) {
    struct world *world = f->world;
    if (world->placed_count == f->placed_capacity)
        return error_set(f->error, ERROR_MACHINE, "the scene changed while it was flattened");
    struct placed *placed = &f->placed[world->placed_count++];
    placed->thing = thing;
    return stand->above ? place_moving(f, stand, placed) : flatten_map(f, &stand->from_node, placed);
}

bool flatten_mesh_index(struct flattening *f, const struct shape *shape) {
    if (shape->kind != SHAPE_MESH)
        return true;
    /* The mesh is an asset: immutable but for its index, which is made at its first render. */
    struct mesh *mesh = (struct mesh *)(uintptr_t)shape->mesh;
    switch (f->world->accel) {
    case ACCEL_GRID:
        return mesh_build_grid(mesh, f->pool, f->error);
    case ACCEL_KDTREE:
        return mesh_build_kd_tree(mesh, f->pool, f->error);
    case ACCEL_AUTO:
    case ACCEL_BVH:
    case ACCEL_NONE:
        return mesh_build_index(mesh, f->pool, f->error);
    }
    return true;
}

/* node->thing: 0 where it is not known yet, else its number and 1, or nothing to draw. */
enum { THING_NOTHING = -1 };

static bool add_thing(struct flattening *f, struct node *node, struct thing *thing) {
    struct world *world = f->world;
    struct thing *things = room_for_one(world->things, world->thing_count, &f->thing_capacity, sizeof *world->things);
    if (!things)
        return error_no_memory(f->error, "the things of the scene");
    world->things = things;
    thing->holes = any_holes(f, &thing->shape, thing->material, thing->slot_count);
    things[world->thing_count++] = *thing;
    node->thing = (int)world->thing_count;
    return true;
}

/* The first time that a node is placed: its shape, ready for rays, and its materials. */
static bool make_thing(struct flattening *f, struct node *node) {
    struct thing thing = {.node = node};
    node->thing = THING_NOTHING;
    if (node->kind == NODE_GEOMETRY) {
        if (node->shape.kind == SHAPE_MESH && mesh_triangle_count(node->shape.mesh) == 0)
            return true;
        thing.shape = node->shape;
        thing.cull = node->cull;
        return flatten_mesh_index(f, &node->shape) &&
               flatten_material(f, node, NULL, &thing.material, &thing.slot_count) && add_thing(f, node, &thing);
    }
    thing.shape.kind = SHAPE_CSG;
    thing.slot_count = 1;
    return flatten_csg(f, node, &thing.shape.csg) && (!thing.shape.csg || add_thing(f, node, &thing));
}

static bool place_node(struct flattening *f, struct node *node, const struct stand *stand) {
    if (node->kind != NODE_GEOMETRY && node->kind != NODE_CSG)
        return true;
    if (node->thing == 0 && !make_thing(f, node))
        return false;
    return node->thing == THING_NOTHING || place(f, stand, (uint32_t)node->thing - 1);
}

struct place_frame {
    struct stand stand, of_children;
    struct node *node;
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
    out->from_node = transform_identity();
    if (!motion_between(&parent_from_node, &end, node->velocity, &link->motion))
        return error_set(f->error, ERROR_SCENE, "node '%.100s' moves to its mirror image: there is no way between",
                         node->name);
    return true;
}

static bool enter_node(struct flattening *f, struct stack *stack, const struct stand *parent, struct node *node) {
    struct stand stand = {.above = parent->above};
    if (node_moves(node)) {
        if (!stand_moving(f, node, parent, &stand))
            return false;
    } else {
        struct transform parent_from_node = node_parent_from_node(node);
        stand.from_node = transform_compose(&parent->from_node, &parent_from_node);
    }
    if (!place_node(f, node, &stand))
        return false;
    if (!node->first_child || (node->placements && node->placements->count == 0))
        return true;
    struct place_frame *frame = stack_push(stack);
    if (!frame)
        return error_no_memory(f->error, "flattening the scene");
    frame->stand = stand;
    frame->node = node;
    begin_children(frame, 0);
    return true;
}

static bool place_all(struct flattening *f, struct stack *stack) {
    uint32_t steps = 0;
    while (stack->count > 0) {
        struct place_frame *frame = stack_top(stack);
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
        if (link->node->drawable > 0 && !enter_node(f, stack, &parent, link->node))
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
    bool ok = root->drawable == 0 || (enter_node(f, &stack, &ground, root) && place_all(f, &stack));
    mem_free(stack.items);
    flatten_map_end(f);
    return ok;
}
