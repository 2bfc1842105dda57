/* An edge of a box is a straight line in perspective and parallel projections, once the part behind the eye is cut off;
 * elsewhere it goes in 32 straight pieces. Which surface a pixel shows is asked once for each pixel that a line
 * touches. The depth along a line in the picture: in perspective 1 / depth is linear. */
#include "render/overlay.h"

#include "base/mem.h"
#include "base/random.h"
#include "math/elementary.h"
#include "render/camera.h"

#include <math.h>

struct pen {
    const struct render_job *job;
    const struct pool *pool;
    struct camera_frame camera;
    struct world_scratch scratch;
    float *depths; /* of the surface in each pixel of the film: negative while nobody has asked */
    bool flat;     /* lines are straight in the picture */
    bool inverse;  /* 1 / depth is linear along them, not depth */
    int eye;       /* -1, 1 of a pair side by side; else 0 */
    struct vec3 colour;
    uint32_t drawn;
};

/* A place in the picture, and how deep it lies. */
struct place3 {
    double x, y, depth;
};

static double depth_of(const struct pen *pen, struct vec3 point) {
    struct vec3 d = vec3_sub(point, pen->camera.eye);
    return pen->flat ? vec3_dot(d, pen->camera.forward) : vec3_length(d);
}

static double surface_depth(struct pen *pen, uint32_t x, uint32_t y) {
    const struct film *film = pen->job->film;
    float *depth = &pen->depths[(size_t)y * film->width + x];
    struct ray ray;
    struct hit hit;
    if (*depth >= 0)
        return (double)*depth;
    double px = x + film->x0 + 0.5, py = y + film->y0 + 0.5;
    *depth = INFINITY;
    if (camera_ray_through(&pen->camera, px, py, (struct sample2){0.5, 0.5}, 0, &ray) &&
        world_nearest(pen->job->world, &ray, &pen->scratch, &hit))
        *depth = (float)fmax(0, depth_of(pen, hit.point));
    return (double)*depth;
}

static void dot(struct pen *pen, int64_t x, int64_t y, double depth) {
    const struct film *film = pen->job->film;
    x -= film->x0;
    y -= film->y0;
    if (x < 0 || y < 0 || x >= film->width || y >= film->height)
        return;
    /* A box often lies in the faces of its shape: those lines are in front. */
    bool seen = depth <= surface_depth(pen, (uint32_t)x, (uint32_t)y) * 1.002;
    double share = seen ? 0.8 : 0.2;
    float *rgb = film->pixels[(size_t)y * film->width + (size_t)x].rgb;
    for (int c = 0; c < 3; c++)
        rgb[c] = (float)((1 - share) * (double)rgb[c] + share * vec3_get(pen->colour, c));
}

/* The part of a line from 0 to 1 on which low <= from + t * way <= high; false: none. */
static bool cut(double from, double way, double low, double high, double *t0, double *t1) {
    if (way == 0)
        return from >= low && from <= high;
    double a = (low - from) / way, b = (high - from) / way;
    *t0 = fmax(*t0, fmin(a, b));
    *t1 = fmin(*t1, fmax(a, b));
    return *t0 < *t1;
}

static void line(struct pen *pen, struct place3 a, struct place3 b) {
    const struct film *film = pen->job->film;
    double t0 = 0, t1 = 1, dx = b.x - a.x, dy = b.y - a.y;
    double left = pen->eye > 0 ? pen->camera.width : 0, right = pen->eye < 0 ? pen->camera.width : INFINITY;
    left = fmax(left, film->x0);
    right = fmin(right, (double)film->x0 + film->width);
    if (!isfinite(dx) || !isfinite(dy) || !cut(a.x, dx, left, right, &t0, &t1) ||
        !cut(a.y, dy, film->y0, (double)film->y0 + film->height, &t0, &t1))
        return;
    double from = pen->inverse ? 1 / a.depth : a.depth, to = pen->inverse ? 1 / b.depth : b.depth;
    double steps = ceil(fmax(fabs(dx), fabs(dy)) * (t1 - t0));
    int64_t last_x = INT64_MIN, last_y = INT64_MIN;
    for (double i = 0; i <= steps; i++) {
        double t = t0 + (t1 - t0) * (steps > 0 ? i / steps : 0), depth = from + t * (to - from);
        int64_t x = (int64_t)floor(a.x + t * dx), y = (int64_t)floor(a.y + t * dy);
        if (x != last_x || y != last_y)
            dot(pen, x, y, pen->inverse ? 1 / depth : depth);
        last_x = x;
        last_y = y;
    }
}

static bool place(const struct pen *pen, struct vec3 point, struct place3 *out) {
    out->depth = depth_of(pen, point);
    if (pen->eye == 0)
        return camera_project(&pen->camera, point, &out->x, &out->y);
    /* The eye of a pair stands beside, and its window is moved back to where both see the same. */
    struct camera_frame beside = pen->camera;
    double offset = 0.5 * pen->eye * beside.lens.eye_distance;
    beside.eye = vec3_add_scaled(beside.eye, beside.unit_right, offset);
    bool seen = camera_project(&beside, point, &out->x, &out->y);
    out->x += offset / beside.lens.screen / vec3_length(beside.right) + (pen->eye > 0 ? beside.width : 0);
    return seen;
}

static void edge(struct pen *pen, struct vec3 a, struct vec3 b) {
    enum { PIECES = 32 };
    struct place3 from, to;
    if (pen->flat) {
        /* Before the eye. */
        double near = 1e-6 * fmax(vec3_length(vec3_sub(b, a)), vec3_length(vec3_sub(a, pen->camera.eye)));
        double da = depth_of(pen, a), db = depth_of(pen, b);
        if (da < near && db < near)
            return;
        struct vec3 way = vec3_sub(b, a);
        if (da < near)
            a = vec3_add_scaled(a, way, (near - da) / (db - da));
        else if (db < near)
            b = vec3_add_scaled(a, way, (near - da) / (db - da));
        if (place(pen, a, &from) && place(pen, b, &to))
            line(pen, from, to);
        return;
    }
    bool have = place(pen, a, &from);
    for (int i = 1; i <= PIECES; i++) {
        bool next = place(pen, vec3_add_scaled(a, vec3_sub(b, a), (double)i / PIECES), &to);
        /* A panorama ends at the back: what jumps from edge to edge is no line. */
        if (have && next && fabs(to.x - from.x) < pen->camera.width / 2)
            line(pen, from, to);
        from = to;
        have = next;
    }
}

static void draw_box(struct pen *pen, const struct box *box) {
    struct vec3 c[8];
    if (!vec3_finite(box->min) || !vec3_finite(box->max) || !(box->min.x <= box->max.x))
        return;
    for (int i = 0; i < 8; i++)
        c[i] = vec3_make(i & 1 ? box->max.x : box->min.x, i & 2 ? box->max.y : box->min.y,
                         i & 4 ? box->max.z : box->min.z);
    for (int i = 0; i < 8; i++)
        for (int axis = 1; axis <= 4; axis *= 2)
            if (!(i & axis))
                edge(pen, c[i], c[i | axis]);
    pen->drawn++;
}

static bool stopped(const struct pen *pen) {
    return (pen->drawn & 63) == 0 && pen->pool && pool_cancelled(pen->pool);
}

/* --- what is drawn --- */

static uint32_t step_for(uint64_t count) {
    return (uint32_t)((count + OVERLAY_BOXES - 1) / OVERLAY_BOXES);
}

static void number_colour(struct pen *pen, uint64_t number) {
    pen->colour = vec3_make(0.25 + 0.75 * random_unit(random_combine(number, 0)),
                            0.25 + 0.75 * random_unit(random_combine(number, 1)),
                            0.25 + 0.75 * random_unit(random_combine(number, 2)));
}

/* Boxes of one node have one colour, that of --aov node. */
static void draw_boxes(struct pen *pen) {
    const struct world *world = pen->job->world;
    uint32_t step = step_for(world->placed_count);
    for (uint32_t i = 0; i < world->placed_count && !stopped(pen); i += step) {
        number_colour(pen, placed_node(world, i)->serial + UINT64_C(1));
        draw_box(pen, &world->boxes[i]);
    }
}

/* From blue for few over green to red for many. */
static void share_colour(struct pen *pen, double share) {
    share = share > 1 ? 1 : share;
    pen->colour = vec3_make(share, 1 - fabs(2 * share - 1), 1 - share);
}

/* Voxels that hold something. */
static void draw_voxels(struct pen *pen) {
    const struct grid *grid = &pen->job->world->grid;
    uint64_t count = (uint64_t)grid->cells[0] * grid->cells[1] * grid->cells[2];
    uint32_t step = step_for(count);
    pen->colour = vec3_all(1);
    draw_box(pen, &grid->bounds);
    for (uint64_t i = 0; i < count && !stopped(pen); i += step) {
        uint32_t items = grid->cell_start[i + 1] - grid->cell_start[i];
        struct vec3 at = {(double)(i % grid->cells[0]), (double)(i / grid->cells[0] % grid->cells[1]),
                          (double)(i / grid->cells[0] / grid->cells[1])};
        struct box cell = {vec3_add(grid->bounds.min, vec3_mul(at, grid->cell_size)), {0, 0, 0}};
        cell.max = vec3_add(cell.min, grid->cell_size);
        share_colour(pen, items / 8.0);
        if (items > 0)
            draw_box(pen, &cell);
    }
}

/* Inner nodes of the hierarchy: those near the root are red. */
static void draw_tree(struct pen *pen) {
    const struct box_tree *tree = &pen->job->world->tree;
    uint32_t step = step_for((uint64_t)tree->node_count * BOX_TREE_WIDTH);
    pen->colour = vec3_all(1);
    draw_box(pen, &tree->bounds);
    for (uint32_t i = 0; i < tree->node_count && !stopped(pen); i += step) {
        const struct box_tree_node *node = &tree->nodes[i];
        for (int k = 0; k < BOX_TREE_WIDTH; k++) {
            if (node->child[k] == BOX_TREE_NONE || (node->child[k] & BOX_TREE_ITEM))
                continue;
            struct box box = {{node->planes[0][0][k], node->planes[1][0][k], node->planes[2][0][k]},
                              {node->planes[0][1][k], node->planes[1][1][k], node->planes[2][1][k]}};
            share_colour(pen, 1 - el_log2(1 + (double)node->child[k]) / 16);
            draw_box(pen, &box);
        }
    }
}

/* Leaves that hold something; the cell of a node is that of its parent, cut. */
static void draw_halves(struct pen *pen) {
    const struct kd_tree *tree = &pen->job->world->kd_tree;
    struct {
        struct box cell;
        uint32_t node;
    } stack[KD_DEPTH + 2];
    int depth = 0;
    if (tree->node_count == 0)
        return;
    stack[depth].cell = tree->bounds;
    stack[depth++].node = 0;
    while (depth > 0 && !stopped(pen) && pen->drawn < OVERLAY_BOXES) {
        struct box cell = stack[--depth].cell, lower = cell, upper = cell;
        uint32_t number = stack[depth].node;
        const struct kd_node *node = &tree->nodes[number];
        if (node->axis == KD_LEAF) {
            share_colour(pen, (double)node->count / 8);
            if (node->count > 0)
                draw_box(pen, &cell);
            continue;
        }
        double *high = node->axis == 0 ? &lower.max.x : node->axis == 1 ? &lower.max.y : &lower.max.z;
        double *low = node->axis == 0 ? &upper.min.x : node->axis == 1 ? &upper.min.y : &upper.min.z;
        *high = *low = node->split;
        stack[depth].cell = upper;
        stack[depth++].node = node->place;
        stack[depth].cell = lower;
        stack[depth++].node = number + 1;
    }
}

static void draw_cells(struct pen *pen) {
    switch (pen->job->world->frame) {
    case ACCEL_GRID:
        draw_voxels(pen);
        return;
    case ACCEL_AUTO:
    case ACCEL_BVH:
        draw_tree(pen);
        return;
    case ACCEL_KDTREE:
        draw_halves(pen);
        return;
    case ACCEL_NONE:
        return;
    }
}

static void draw(struct pen *pen) {
    switch (pen->job->settings.overlay) {
    case OVERLAY_NONE:
        return;
    case OVERLAY_OF_BOXES:
        draw_boxes(pen);
        return;
    case OVERLAY_OF_GRID:
        draw_cells(pen);
        return;
    }
}

bool overlay_draw(const struct render_job *job, const struct pool *pool, struct error *error) {
    const struct film *film = job->film;
    struct camera camera = job->camera;
    char warning[256];
    struct pen pen = {.job = job, .pool = pool};
    size_t pixels = (size_t)film->width * film->height;
    if (job->settings.overlay == OVERLAY_NONE)
        return true;
    if (job->settings.motion.moves)
        camera = camera_at(&job->camera, &job->settings.motion, shutter_time(job->settings.shutter, 0));
    if (!camera_prepare(&camera, &job->settings, job->width, job->height, &pen.camera, warning, error))
        return false;
    enum projection projection = pen.camera.lens.projection;
    pen.inverse = projection == PROJECTION_PERSPECTIVE;
    pen.flat = pen.inverse || projection == PROJECTION_ORTHOGRAPHIC;
    pen.depths = mem_alloc_zero(pixels, sizeof *pen.depths);
    if (!pen.depths || !world_scratch_init(&pen.scratch, job->world)) {
        mem_free(pen.depths);
        return error_no_memory(error, "the lines over a picture");
    }
    for (size_t i = 0; i < pixels; i++)
        pen.depths[i] = -1;
    bool pair = pen.camera.lens.stereo == STEREO_SIDE;
    for (pen.eye = pair ? -1 : 0; pen.eye <= (pair ? 1 : 0); pen.eye += 2)
        draw(&pen);
    bool failed = pen.scratch.failed;
    world_scratch_destroy(&pen.scratch);
    mem_free(pen.depths);
    if (failed)
        return error_no_memory(error, "the lines over a picture");
    return !(pool && pool_cancelled(pool)) || error_set(error, ERROR_CANCELLED, "stopped while rendering");
}
