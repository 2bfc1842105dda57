/* The primitives of nodes whose transforms have changed since the world was flattened. The log lists the nodes in the
 * order in which they were visited, each after the node above it, so one pass finds the nodes whose pose may differ.
 * Their poses are composed anew from the root, in the order of flattening: the bits are those of a new world. Only the
 * numbers of linear maps may differ, which nothing depends on. */
#include "base/mem.h"
#include "scene/traversal.h"
#include "world/flatten_internal.h"
#include "world/world_internal.h"

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
