/* One ray through the centre of each pixel determines which pixels show a node, within the rectangle around the boxes
 * of the node's primitives in the picture. The first hit of the ray is used: a node behind another one has no outline
 * there. */
#include "preview/view_overlay_internal.h"

#include "base/mem.h"
#include "csg/csg.h"
#include "inspect/pick.h"
#include "render/camera.h"

#include <math.h>
#include <string.h>

enum { ROWS = 8 }; /* of an item of work */

struct node_members {
    const struct world *world;
    const struct view_overlay_request *request;
    uint8_t *member; /* for each primitive: whether it is part of the node, or of the solid that contains the node as
                        operand */
    struct box box;
    uint32_t first_leaf, end_leaf; /* for each origin in that solid: whether it belongs to the operand */
    const struct scene_step *to_solid;
    uint32_t depth;
    bool no_memory;
};

static bool note_leaves(void *context, uint32_t first, uint32_t end, const struct scene_step *steps, uint32_t depth) {
    struct scene_step route[2 * OPERAND_DEPTH];
    struct node_members *s = context;
    if (steps[depth - 1].node->serial != s->request->serial || s->depth > OPERAND_DEPTH)
        return true;
    memcpy(route, s->to_solid, s->depth * sizeof *route);
    memcpy(route + s->depth, steps, depth * sizeof *route);
    if (route_hash(route, s->depth + depth) != s->request->route)
        return true;
    s->first_leaf = first;
    s->end_leaf = end;
    return false;
}

static bool note_members(void *context, uint32_t first, uint32_t count, const struct scene_step *steps,
                         uint32_t depth) {
    struct node_members *s = context;
    bool below = s->request->solid != 0 && route_hash(steps, depth) == s->request->solid;
    if (below) {
        s->to_solid = steps;
        s->depth = depth;
        s->no_memory = s->no_memory || !world_visit_operands(steps[depth - 1].node, note_leaves, s);
    }
    for (uint32_t i = 0; i < depth && !below && s->request->solid == 0; i++)
        below = steps[i].node->serial == s->request->serial &&
                (s->request->route == 0 || route_hash(steps, i + 1) == s->request->route);
    for (uint32_t i = first; below && i < first + count; i++) {
        s->member[i] = 1;
        s->box = box_join(s->box, s->world->boxes[i]);
    }
    return true;
}

/* The rectangle of the box in the film; the whole film if that is not easily computed. */
static struct film_rectangle rectangle_of(const struct camera_frame *frame, const struct film *film,
                                          const struct box *box) {
    const struct film_rectangle all = {0, 0, film->width, film->height};
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
    enum projection projection = frame->lens.projection;
    if ((projection != PROJECTION_PERSPECTIVE && projection != PROJECTION_ORTHOGRAPHIC) || camera_has_views(frame) ||
        !vec3_finite(box->min) || !vec3_finite(box->max))
        return all;
    for (int i = 0; i < 8; i++) {
        struct vec3 p = {i & 1 ? box->max.x : box->min.x, i & 2 ? box->max.y : box->min.y,
                         i & 4 ? box->max.z : box->min.z};
        double at[2];
        if (!camera_project(frame, p, &at[0], &at[1]))
            return all;
        for (int k = 0; k < 2; k++) {
            low[k] = math_min(low[k], at[k]);
            high[k] = math_max(high[k], at[k]);
        }
    }
    /* One more pixel, because of rounding. */
    low[0] = math_min(math_max(floor(low[0]) - 1 - film->x0, 0), film->width);
    low[1] = math_min(math_max(floor(low[1]) - 1 - film->y0, 0), film->height);
    high[0] = math_min(math_max(ceil(high[0]) + 1 - film->x0, low[0]), film->width);
    high[1] = math_min(math_max(ceil(high[1]) + 1 - film->y0, low[1]), film->height);
    return (struct film_rectangle){(uint32_t)low[0], (uint32_t)low[1], (uint32_t)high[0], (uint32_t)high[1]};
}

struct outline_job {
    const struct render_job *job;
    const struct camera_frame *frame;
    const struct pool *pool;
    const struct node_members *node_members;
    struct world_scratch *scratch; /* by worker */
    struct film_rectangle area;
    uint8_t *shows;
};

static bool is_member(const struct node_members *s, const struct hit *hit) {
    const struct csg *csg = primitive_geometry(s->world, hit->primitive)->csg;
    if (!s->member[hit->primitive] || s->request->solid == 0 || !csg)
        return s->member[hit->primitive];
    uint32_t origin = csg->leaves[hit->leaf].origin;
    return origin >= s->first_leaf && origin < s->end_leaf;
}

static void outline_rows(void *context, uint32_t item, int worker) {
    const struct outline_job *o = context;
    const struct film *film = o->job->film;
    struct ray ray;
    struct hit hit;
    for (uint32_t y = o->area.y0 + item * ROWS; y < o->area.y1 && y < o->area.y0 + (item + 1) * ROWS; y++) {
        for (uint32_t x = o->area.x0; x < o->area.x1; x++) {
            bool shows = camera_ray_through(o->frame, film->x0 + x + 0.5, film->y0 + y + 0.5,
                                            (struct sample2){0.5, 0.5}, NULL, &ray) &&
                         world_nearest(o->job->world, &ray, &o->scratch[worker], &hit) &&
                         is_member(o->node_members, &hit);
            o->shows[(size_t)y * film->width + x] = shows;
        }
        if (pool_cancelled(o->pool))
            return;
    }
}

static bool run_outline(struct outline_job *o, struct pool *pool, struct error *error) {
    int workers = pool_workers(pool);
    o->scratch = mem_alloc_zero((size_t)workers, sizeof *o->scratch);
    bool ok = o->scratch != NULL;
    for (int i = 0; ok && i < workers; i++)
        ok = world_scratch_init(&o->scratch[i], o->job->world);
    uint32_t items = (o->area.y1 - o->area.y0 + ROWS - 1) / ROWS;
    bool complete = ok && (items == 0 || pool_run(pool, items, outline_rows, o));
    for (int i = 0; o->scratch && i < workers; i++) {
        ok = ok && !o->scratch[i].failed;
        world_scratch_destroy(&o->scratch[i]);
    }
    mem_free(o->scratch);
    if (!ok)
        return error_no_memory(error, "the outline of a node");
    return complete || error_set(error, ERROR_CANCELLED, "stopped while rendering");
}

static bool make_outline(const struct view_overlay_scene *scene, const struct view_overlay_request *request,
                         uint8_t *shows, struct film_rectangle *found, struct error *error) {
    const struct render_job *job = scene->job;
    struct node_members members = {.world = job->world, .request = request, .box = box_empty()};
    struct settings settings = job->settings;
    struct camera_frame frame;
    char ignored[256];
    settings.lens.aperture = 0;
    *found = (struct film_rectangle){0};
    if (!camera_prepare(&job->camera, &settings, (struct picture_size){job->width, job->height}, &frame, ignored,
                        error))
        return false;
    /* Which primitives belong to the node, and a box around them: only there rays are needed. */
    members.member = mem_alloc_zero((size_t)job->world->primitive_count + 1, 1);
    if (!members.member)
        return error_no_memory(error, "the outline of a node");
    bool ok = world_visit_node_paths(job->world, scene->root, note_members, &members, error) &&
              (!members.no_memory || error_no_memory(error, "the outline of a node"));
    if (ok && !box_is_empty(&members.box)) {
        struct outline_job o = {
            .job = job, .frame = &frame, .pool = scene->pool, .node_members = &members, .shows = shows};
        o.area = rectangle_of(&frame, job->film, &members.box);
        ok = run_outline(&o, scene->pool, error);
        *found = o.area;
    }
    mem_free(members.member);
    return ok;
}

bool view_overlay_make(const struct view_overlay_scene *scene, const struct view_overlay_request *request,
                       const struct view_overlay_buffers *buffers, struct view_overlay *overlay, struct error *error) {
    *overlay = (struct view_overlay){0};
    if (request->outline && !make_outline(scene, request, buffers->shows, &overlay->outline, error))
        return false;
    overlay->has_outline = request->outline;
    if (request->lines.kind != OVERLAY_NONE &&
        !overlay_lines(scene->job, scene->pool, &request->lines, buffers->lines, error))
        return false;
    overlay->has_lines = request->lines.kind != OVERLAY_NONE;
    return true;
}
