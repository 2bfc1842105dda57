/* An edge of a box is a straight line in perspective and parallel projections, once the part behind the eye is cut off;
 * elsewhere it is drawn in 32 straight pieces. The visible surface is computed once for each pixel that a line touches.
 * The depth along a line in the picture: in perspective 1 / depth is linear. */
#include "render/overlay.h"

#include "base/mem.h"
#include "base/random.h"
#include "radiosity/radiosity.h"
#include "render/camera.h"

#include <math.h>

/* A position in the picture, and its depth. */
struct place3 {
    double x, y, depth;
};

/* A line in the picture, cut at its borders; depth, or 1 / depth, goes evenly from one end to the other. */
struct stroke {
    struct place3 from, delta;
    double steps; /* dots are drawn at from + i / steps * way */
    uint32_t box; /* of the chunk */
};

/* A box, or the triangle of a patch. */
struct overlay_box {
    struct box box;
    bool is_patch;
    struct vec3 corners[3];
    struct colour colour;
};

/* Boxes are drawn in chunks: first each one's strokes are found, box by box, then they are drawn, band of rows by band.
 * So every thread has its own memory, and every dot gets its lines in the order of the boxes. */
enum { CHUNK = 512, PIECES = 32, EDGES = 12 };

struct overlay_drawing {
    const struct render_job *job;
    struct pool *pool;
    const struct overlay_request *request;
    struct camera_frame camera;
    struct world_scratch *scratch; /* by worker */
    float *depths;                 /* of the surface in each cell of the film: negative until the first request */
    uint32_t cells_across;
    float (*lines)[4];
    bool planar;  /* lines are straight in the picture */
    bool inverse; /* 1 / depth is linear along them, not depth */
    bool pair;    /* two pictures side by side */
    struct colour colour;
    uint32_t drawn;
    struct overlay_box *boxes; /* of the chunk */
    uint32_t count, band;
    struct stroke *strokes; /* `room` for each box */
    uint32_t *stroke_count;
    uint32_t room;
};

static double depth_of(const struct overlay_drawing *drawing, struct vec3 point) {
    struct vec3 d = vec3_sub(point, drawing->camera.eye);
    return drawing->planar ? vec3_dot(d, drawing->camera.forward) : vec3_length(d);
}

/* Through the middle of the cell. */
static double surface_depth(struct overlay_drawing *drawing, struct world_scratch *scratch, uint32_t x, uint32_t y) {
    const struct film *film = drawing->job->film;
    uint32_t cell = drawing->request->cell;
    float *depth = &drawing->depths[(size_t)(y / cell) * drawing->cells_across + x / cell];
    struct ray ray;
    struct hit hit;
    if (*depth >= 0)
        return (double)*depth;
    double px = x / cell * cell + film->x0 + 0.5 * cell, py = y / cell * cell + film->y0 + 0.5 * cell;
    *depth = INFINITY;
    if (camera_ray_through(&drawing->camera, px, py, (struct sample2){0.5, 0.5}, NULL, &ray) &&
        world_nearest(drawing->job->world, &ray, scratch, &hit))
        *depth = (float)math_max(0, depth_of(drawing, hit.point));
    return (double)*depth;
}

/* Finding strokes. */

/* The part of a line from 0 to 1 on which low <= from + t * way <= high; false: none. */
static bool cut(double from, double delta, double low, double high, double *t0, double *t1) {
    if (delta == 0)
        return from >= low && from <= high;
    double a = (low - from) / delta, b = (high - from) / delta;
    *t0 = math_max(*t0, math_min(a, b));
    *t1 = math_min(*t1, math_max(a, b));
    return *t0 < *t1;
}

/* eye: -1, 1 of a pair; else 0. */
static void line(struct overlay_drawing *drawing, uint32_t box, int eye, struct place3 a, struct place3 b) {
    const struct film *film = drawing->job->film;
    double t0 = 0, t1 = 1, dx = b.x - a.x, dy = b.y - a.y;
    double left = eye > 0 ? drawing->camera.width : 0, right = eye < 0 ? drawing->camera.width : INFINITY;
    left = math_max(left, film->x0);
    right = math_min(right, (double)film->x0 + film->width);
    if (!isfinite(dx) || !isfinite(dy) || !cut(a.x, dx, left, right, &t0, &t1) ||
        !cut(a.y, dy, film->y0, (double)film->y0 + film->height, &t0, &t1))
        return;
    double from = drawing->inverse ? 1 / a.depth : a.depth, to = drawing->inverse ? 1 / b.depth : b.depth,
           delta = t1 - t0;
    drawing->strokes[(size_t)box * drawing->room + drawing->stroke_count[box]++] =
        (struct stroke){{a.x + t0 * dx - film->x0, a.y + t0 * dy - film->y0, from + t0 * (to - from)},
                        {delta * dx, delta * dy, delta * (to - from)},
                        ceil(math_max(fabs(dx), fabs(dy)) * delta),
                        box};
}

static bool position(const struct overlay_drawing *drawing, int eye, struct vec3 point, struct place3 *out) {
    out->depth = depth_of(drawing, point);
    if (eye == 0)
        return camera_project(&drawing->camera, point, &out->x, &out->y);
    /* The eyes of a pair are displaced, and their windows are shifted so that both see the same at the screen. */
    struct camera_frame beside = drawing->camera;
    double offset = 0.5 * eye * beside.lens.eye_distance;
    beside.eye = vec3_add_scaled(beside.eye, beside.unit_right, offset);
    bool seen = camera_project(&beside, point, &out->x, &out->y);
    out->x += offset / beside.lens.screen / vec3_length(beside.right) + (eye > 0 ? beside.width : 0);
    return seen;
}

static void edge(struct overlay_drawing *drawing, uint32_t box, int eye, struct vec3 a, struct vec3 b) {
    struct place3 from, to;
    if (drawing->planar) {
        /* Before the eye. */
        double near = 1e-6 * math_max(vec3_length(vec3_sub(b, a)), vec3_length(vec3_sub(a, drawing->camera.eye)));
        double da = depth_of(drawing, a), db = depth_of(drawing, b);
        if (da < near && db < near)
            return;
        struct vec3 delta = vec3_sub(b, a);
        if (da < near)
            a = vec3_add_scaled(a, delta, (near - da) / (db - da));
        else if (db < near)
            b = vec3_add_scaled(a, delta, (near - da) / (db - da));
        if (position(drawing, eye, a, &from) && position(drawing, eye, b, &to))
            line(drawing, box, eye, from, to);
        return;
    }
    bool have = position(drawing, eye, a, &from);
    for (int i = 1; i <= PIECES; i++) {
        bool next = position(drawing, eye, vec3_add_scaled(a, vec3_sub(b, a), (double)i / PIECES), &to);
        /* A panorama ends at the back: what jumps from edge to edge is no line. */
        if (have && next && fabs(to.x - from.x) < drawing->camera.width / 2)
            line(drawing, box, eye, from, to);
        from = to;
        have = next;
    }
}

static void find_strokes(void *context, uint32_t number, int worker) {
    struct overlay_drawing *drawing = context;
    const struct overlay_box *figure = &drawing->boxes[number];
    const struct box *box = &figure->box;
    struct vec3 c[8];
    (void)worker;
    drawing->stroke_count[number] = 0;
    for (int eye = drawing->pair ? -1 : 0; figure->is_patch && eye <= (drawing->pair ? 1 : 0); eye += 2)
        for (int i = 0; i < 3; i++)
            edge(drawing, number, eye, figure->corners[i], figure->corners[(i + 1) % 3]);
    if (figure->is_patch)
        return;
    for (int i = 0; i < 8; i++)
        c[i] = vec3_make(i & 1 ? box->max.x : box->min.x, i & 2 ? box->max.y : box->min.y,
                         i & 4 ? box->max.z : box->min.z);
    for (int eye = drawing->pair ? -1 : 0; eye <= (drawing->pair ? 1 : 0); eye += 2)
        for (int i = 0; i < 8; i++)
            for (int axis = 1; axis <= 4; axis *= 2)
                if (!(i & axis))
                    edge(drawing, number, eye, c[i], c[i | axis]);
}

/* Drawing them. */

static void dot(struct overlay_drawing *drawing, struct world_scratch *scratch, uint32_t x, uint32_t y, double depth,
                const struct colour *colour) {
    float *ink = drawing->lines[(size_t)y * drawing->job->film->width + x];
    /* A box often lies in the faces of its shape: those lines are in front. */
    bool seen = depth <= surface_depth(drawing, scratch, x, y) * 1.002;
    double share = seen ? 0.8 : 0.2;
    for (int c = 0; c < 3; c++)
        ink[c] = (float)((1 - share) * (double)ink[c] + share * colour_get(*colour, c));
    ink[3] = (float)((1 - share) * (double)ink[3]);
}

/* The dots of a stroke in rows from top to bottom - 1. Some more are looked at, so that what is one dot in the whole
 * picture is one here. */
static void draw_stroke(struct overlay_drawing *drawing, struct world_scratch *scratch, const struct stroke *stroke,
                        double top, double bottom) {
    double t0 = 0, t1 = 1, width = drawing->job->film->width;
    const struct colour *colour = &drawing->boxes[stroke->box].colour;
    if (!cut(stroke->from.y, stroke->delta.y, top, bottom, &t0, &t1))
        return;
    double last = math_min(stroke->steps, ceil(t1 * stroke->steps) + 1), last_x = -1, last_y = -1;
    for (double i = math_max(0, floor(t0 * stroke->steps) - 1); i <= last; i++) {
        double t = stroke->steps > 0 ? i / stroke->steps : 0, depth = stroke->from.depth + t * stroke->delta.depth;
        double x = floor(stroke->from.x + t * stroke->delta.x), y = floor(stroke->from.y + t * stroke->delta.y);
        bool another = x < last_x || x > last_x || y < last_y || y > last_y;
        if (another && x >= 0 && x < width && y >= top && y < bottom)
            dot(drawing, scratch, (uint32_t)x, (uint32_t)y, drawing->inverse ? 1 / depth : depth, colour);
        last_x = x;
        last_y = y;
    }
}

static void draw_band(void *context, uint32_t band, int worker) {
    struct overlay_drawing *drawing = context;
    uint32_t top = band * drawing->band, bottom = top + drawing->band, height = drawing->job->film->height;
    bottom = bottom < height ? bottom : height;
    for (uint32_t box = 0; box < drawing->count && !pool_cancelled(drawing->pool); box++)
        for (uint32_t i = 0; i < drawing->stroke_count[box]; i++)
            draw_stroke(drawing, &drawing->scratch[worker], &drawing->strokes[(size_t)box * drawing->room + i], top,
                        bottom);
}

static void draw_chunk(struct overlay_drawing *drawing) {
    uint32_t height = drawing->job->film->height;
    if (drawing->count > 0 && pool_run(drawing->pool, drawing->count, find_strokes, drawing))
        (void)pool_run(drawing->pool, (height + drawing->band - 1) / drawing->band, draw_band, drawing);
    drawing->count = 0;
}

static void draw_figure(struct overlay_drawing *drawing, const struct overlay_box *figure) {
    drawing->boxes[drawing->count++] = *figure;
    drawing->drawn++;
    if (drawing->count == CHUNK)
        draw_chunk(drawing);
}

static void draw_box(struct overlay_drawing *drawing, const struct box *box) {
    if (vec3_finite(box->min) && vec3_finite(box->max) && box->min.x <= box->max.x)
        draw_figure(drawing, &(struct overlay_box){.box = *box, .colour = drawing->colour});
}

static bool stopped(const struct overlay_drawing *drawing) {
    return (drawing->drawn & 63) == 0 && pool_cancelled(drawing->pool);
}

/* --- boxes and cells --- */

static uint32_t step_for(const struct overlay_drawing *drawing, uint64_t count) {
    return (uint32_t)((count + drawing->request->limit - 1) / drawing->request->limit);
}

static void number_colour(struct overlay_drawing *drawing, uint64_t number) {
    drawing->colour = colour_make(0.25 + 0.75 * random_unit(random_combine(number, 0)),
                                  0.25 + 0.75 * random_unit(random_combine(number, 1)),
                                  0.25 + 0.75 * random_unit(random_combine(number, 2)));
}

/* Boxes of one node have one colour, that of --aov node. */
static void draw_boxes(struct overlay_drawing *drawing) {
    const struct world *world = drawing->job->world;
    uint32_t step = step_for(drawing, world->primitive_count);
    for (uint32_t i = 0; i < world->primitive_count && !stopped(drawing); i += step) {
        number_colour(drawing, primitive_node(world, i)->serial + UINT64_C(1));
        draw_box(drawing, &world->boxes[i]);
    }
}

/* Of the solution for this world, if there is one. */
static void draw_patches(struct overlay_drawing *drawing) {
    const struct radiosity *radiosity = drawing->job->radiosity;
    if (!radiosity || radiosity->patches.world != drawing->job->world)
        return;
    uint32_t step = step_for(drawing, radiosity->patches.all.count);
    for (uint32_t i = 0; i < radiosity->patches.all.count && !stopped(drawing); i += step) {
        struct overlay_box figure = {.is_patch = true, .colour = {0.1, 0.6, 1}};
        patch_corners(&radiosity->patches, i, figure.corners);
        draw_figure(drawing, &figure);
    }
}

/* From blue for few over green to red for many. */
static void share_colour(struct overlay_drawing *drawing, double share) {
    share = share > 1 ? 1 : share;
    drawing->colour = colour_make(share, 1 - fabs(2 * share - 1), 1 - share);
}

static bool draw_cell(void *context, const struct box *cell, bool whole, double share) {
    struct overlay_drawing *drawing = context;
    if (whole)
        drawing->colour = colour_all(1);
    else
        share_colour(drawing, share);
    draw_box(drawing, cell);
    return !stopped(drawing);
}

static void draw(struct overlay_drawing *drawing) {
    switch (drawing->request->kind) {
    case OVERLAY_NONE:
        return;
    case OVERLAY_OF_BOXES:
        draw_boxes(drawing);
        return;
    case OVERLAY_OF_GRID:
        scene_accel_cells(&drawing->job->world->accel, drawing->request->limit, draw_cell, drawing);
        return;
    case OVERLAY_OF_PATCHES:
        draw_patches(drawing);
        return;
    }
}

static void give_back(struct overlay_drawing *drawing) {
    for (int i = 0; drawing->scratch && i < pool_workers(drawing->pool); i++)
        world_scratch_destroy(&drawing->scratch[i]);
    mem_free(drawing->scratch);
    mem_free(drawing->depths);
    mem_free(drawing->boxes);
    mem_free(drawing->strokes);
    mem_free(drawing->stroke_count);
}

static bool make_room(struct overlay_drawing *drawing) {
    const struct film *film = drawing->job->film;
    uint32_t cell = drawing->request->cell, workers = (uint32_t)pool_workers(drawing->pool);
    uint32_t rows = (film->height + cell - 1) / cell, share = (rows + 4 * workers - 1) / (4 * workers);
    drawing->cells_across = (film->width + cell - 1) / cell;
    drawing->band = share * cell;
    drawing->room = EDGES * (drawing->planar ? 1u : PIECES) * (drawing->pair ? 2u : 1u);
    size_t cells = (size_t)rows * drawing->cells_across;
    drawing->scratch = mem_alloc_zero(workers, sizeof *drawing->scratch);
    drawing->depths = mem_alloc_zero(cells, sizeof *drawing->depths);
    drawing->boxes = mem_alloc_zero(CHUNK, sizeof *drawing->boxes);
    drawing->strokes = mem_alloc_zero((size_t)CHUNK * drawing->room, sizeof *drawing->strokes);
    drawing->stroke_count = mem_alloc_zero(CHUNK, sizeof *drawing->stroke_count);
    bool ok = drawing->scratch && drawing->depths && drawing->boxes && drawing->strokes && drawing->stroke_count;
    for (uint32_t i = 0; ok && i < workers; i++)
        ok = world_scratch_init(&drawing->scratch[i], drawing->job->world);
    for (size_t i = 0; ok && i < cells; i++)
        drawing->depths[i] = -1;
    return ok;
}

bool overlay_lines(const struct render_job *job, struct pool *pool, const struct overlay_request *request,
                   float (*lines)[4], struct error *error) {
    const struct film *film = job->film;
    struct camera camera = job->camera;
    char warning[256];
    struct overlay_drawing drawing = {.job = job, .pool = pool, .request = request, .lines = lines};
    /* Without lines the picture shows through everywhere. */
    for (size_t i = 0; i < (size_t)film->width * film->height; i++) {
        lines[i][0] = lines[i][1] = lines[i][2] = 0;
        lines[i][3] = 1;
    }
    if (request->kind == OVERLAY_NONE)
        return true;
    if (job->settings.motion.moves)
        camera = camera_at(&job->camera, &job->settings.motion, shutter_time(job->settings.shutter, 0));
    if (!camera_prepare(&camera, &job->settings, (struct picture_size){job->width, job->height}, &drawing.camera,
                        warning, error))
        return false;
    /* What is linear in a projection: straight lines stay straight in planar ones. */
    enum projection projection = drawing.camera.lens.projection;
    drawing.inverse = projection == PROJECTION_PERSPECTIVE;
    drawing.planar = drawing.inverse || projection == PROJECTION_ORTHOGRAPHIC;
    drawing.pair = drawing.camera.lens.stereo == STEREO_SIDE;
    bool ok = make_room(&drawing);
    if (ok) {
        draw(&drawing);
        draw_chunk(&drawing);
    }
    for (int i = 0; ok && i < pool_workers(pool); i++)
        ok = !drawing.scratch[i].failed;
    give_back(&drawing);
    if (!ok)
        return error_no_memory(error, "the lines over a picture");
    return !pool_cancelled(pool) || error_set(error, ERROR_CANCELLED, "stopped while rendering");
}

void overlay_lay(struct film *film, float (*lines)[4]) {
    for (size_t i = 0; i < (size_t)film->width * film->height; i++)
        overlay_blend(lines[i], film->pixels[i].rgb);
}

bool overlay_draw(const struct render_job *job, struct pool *pool, struct error *error) {
    const struct overlay_request request = {job->settings.overlay, OVERLAY_BOXES, 1};
    struct film *film = job->film;
    if (request.kind == OVERLAY_NONE)
        return true;
    if (request.kind == OVERLAY_OF_PATCHES && job->settings.integrator != INTEGRATOR_RADIOSITY)
        return error_set(error, ERROR_USAGE, "--overlay patches shows those of --integrator radiosity");
    float(*lines)[4] = mem_alloc_zero((size_t)film->width * film->height, sizeof *lines);
    if (!lines)
        return error_no_memory(error, "the lines over a picture");
    bool ok = overlay_lines(job, pool, &request, lines, error);
    if (ok)
        overlay_lay(film, lines);
    mem_free(lines);
    return ok;
}
