/* Each part of a primitive (shape/shape_part.h) is in a box with edges in any directions. The convex hull of the
 * corners of the box in the picture contains the part. Narrow hulls are drawn into the map. A part that is long but not
 * narrow as a whole, because it comes near the camera or is bent, is split in two. Pixels take the maximum of 1 / t, so
 * the order of primitives does not matter. In a fisheye or a panorama, edges are curves: a part is split until they are
 * close to their chords, and the hull is extended by the remaining distance. */
#include "render/thin_map_internal.h"

#include "base/mem.h"
#include "shape/shape_part.h"

#include <math.h>

/* Pixels. A line of width 1 or more is hit by a first sample in every column or row that it passes, a ball of width
 * sqrt(2) or more by one sample. Hulls are wider than their contents: for a cylinder by up to sqrt(2), for a ball by
 * sqrt(3). */
static const double narrow = 1.5, small = 2.5;
/* Hulls below this width are lines that need samples without a regular pattern. */
static const double line = 1.2;
/* The maximum distance of a curved edge from its chord. */
static const double max_bend = 0.25;
enum { SPLITS = 12, CORNERS = 8, CHUNK = 256 };

/* The projection of one eye; `left`, `right`, `top` and `bottom` are its part of the picture. */
struct view {
    struct camera_frame camera;
    double shift, shift_down, left, right, top, bottom; /* pixels */
    bool planar;
};

struct thin_drawing {
    struct thin_map *map;
    const struct renderer *renderer;
    struct view *views;
    uint32_t view_count;
    double margin;
    _Atomic bool found;
};

/* The projection of a part. */
struct outline {
    double x[CORNERS], y[CORNERS];
    double nearness;      /* at least 1 / t */
    double length, width; /* of the hull, pixels */
    double bend;          /* how far edges leave their chords, pixels */
    double far_width;     /* the smallest width, where it is farthest */
};

enum outline_kind {
    OUTLINE_NOWHERE, /* not in the picture */
    OUTLINE_NARROW,
    OUTLINE_WIDE,    /* nowhere narrow, or it cannot be measured */
    OUTLINE_TO_SPLIT /* perhaps narrow in parts */
};

/* --- the hull of a part --- */

static double turn(const struct outline *o, int a, int b, int c) {
    return (o->x[b] - o->x[a]) * (o->y[c] - o->y[a]) - (o->y[b] - o->y[a]) * (o->x[c] - o->x[a]);
}

/* The corners of the convex hull in order (A. Andrew, "Another efficient algorithm for convex hulls in two dimensions",
 * 1979); returns their number. */
static int convex_corners(const struct outline *outline, int out[2 * CORNERS]) {
    int order[CORNERS], count = 0;
    for (int i = 0; i < CORNERS; i++) {
        int at = i;
        for (; at > 0 && (outline->x[order[at - 1]] > outline->x[i] ||
                          (outline->x[order[at - 1]] == outline->x[i] && outline->y[order[at - 1]] > outline->y[i]));
             at--)
            order[at] = order[at - 1];
        order[at] = i;
    }
    for (int pass = 0; pass < 2; pass++) {
        int begin = count;
        for (int i = 0; i < CORNERS; i++) {
            int next = order[pass == 0 ? i : CORNERS - 1 - i];
            while (count >= begin + 2 && turn(outline, out[count - 2], out[count - 1], next) <= 0)
                count--;
            out[count++] = next;
        }
        count--; /* the first one of the other chain */
    }
    return count > 0 ? count : 1;
}

/* The largest distance of two corners, and the smallest width. The smallest width is perpendicular to one of the edges
 * (H. Freeman and R. Shapira, "Determining the minimum-area encasing rectangle for an arbitrary closed curve", CACM
 * 1975). */
static void measure(struct outline *outline) {
    int corners[2 * CORNERS], count = convex_corners(outline, corners);
    outline->length = 0;
    outline->width = INFINITY;
    for (int i = 0; i < count; i++) {
        int a = corners[i], b = corners[(i + 1) % count];
        double dx = outline->x[b] - outline->x[a], dy = outline->y[b] - outline->y[a], edge = sqrt(dx * dx + dy * dy);
        double across = 0;
        for (int k = 0; k < count; k++) {
            double x = outline->x[corners[k]] - outline->x[a], y = outline->y[corners[k]] - outline->y[a];
            outline->length = math_max(outline->length, sqrt(x * x + y * y));
            across = math_max(across, fabs(dx * y - dy * x));
        }
        if (edge > 0)
            outline->width = math_min(outline->width, across / edge);
    }
    if (!(outline->length > 0))
        outline->width = 0;
}

/* Whether it is completely beyond one side of the view. */
static bool is_outside(const struct view *view, const struct outline *outline, double margin) {
    double left = INFINITY, right = -INFINITY, top = INFINITY, bottom = -INFINITY, more = margin + outline->bend;
    for (int i = 0; i < CORNERS; i++) {
        left = math_min(left, outline->x[i]);
        right = math_max(right, outline->x[i]);
        top = math_min(top, outline->y[i]);
        bottom = math_max(bottom, outline->y[i]);
    }
    return right < view->left - more || left > view->right + more || bottom < view->top - more ||
           top > view->bottom + more;
}

/* The corners in the picture. */
static enum outline_kind project(const struct view *view, const struct vec3 corners[CORNERS], double margin,
                                 struct outline *out) {
    const struct camera_frame *camera = &view->camera;
    double near = INFINITY, far = 0;
    int before = 0;
    for (int i = 0; i < CORNERS; i++) {
        struct vec3 from_eye = vec3_sub(corners[i], camera->eye);
        double depth = view->planar ? vec3_dot(from_eye, camera->forward) : vec3_length(from_eye);
        bool seen = depth > 0;
        if (seen)
            (void)camera_project(camera, corners[i], &out->x[i], &out->y[i]);
        before += seen && isfinite(out->x[i]) && isfinite(out->y[i]);
        out->x[i] += view->shift;
        out->y[i] += view->shift_down;
        near = math_min(near, depth);
        far = math_max(far, depth);
    }
    if (before < CORNERS)
        return view->planar && !(far > 0) ? OUTLINE_NOWHERE : OUTLINE_TO_SPLIT;
    if (!view->planar)
        near -= vec3_length(vec3_sub(corners[CORNERS - 1], corners[0]));
    out->nearness = near > 1e-30 ? 1 / near : 1e30;
    measure(out);
    out->far_width = camera->lens.projection == PROJECTION_PERSPECTIVE ? out->width * (near / far) : out->width;
    out->bend = view->planar ? 0 : out->length * out->length / camera->height;
    /* Around the eye, or across the seam of a panorama. */
    if (!view->planar && out->length > camera->height / 4)
        return OUTLINE_TO_SPLIT;
    if (is_outside(view, out, margin))
        return OUTLINE_NOWHERE;
    if (out->width > narrow && out->length > small)
        return out->far_width > 2 * narrow ? OUTLINE_WIDE : OUTLINE_TO_SPLIT;
    return out->bend > max_bend ? OUTLINE_TO_SPLIT : OUTLINE_NARROW;
}

/* --- drawing --- */

static uint32_t bits_of(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* Positive floats are ordered as their bits; the lowest bits are flags. */
static void raise(_Atomic uint32_t *at, uint32_t bits) {
    uint32_t old = atomic_load_explicit(at, memory_order_relaxed), raised;
    do
        raised = ((old > bits ? old : bits) & ~THIN_FLAGS) | ((old | bits) & THIN_FLAGS);
    while (old != raised &&
           !atomic_compare_exchange_weak_explicit(at, &old, raised, memory_order_relaxed, memory_order_relaxed));
}

static double limited(double x, double low, double high) {
    return x < low ? low : x > high ? high : x;
}

/* Every pixel whose samples may be in the hull: all pixels at most `more` from it in rows and columns. */
static void draw(struct thin_drawing *drawing, const struct view *view, const struct outline *outline) {
    const struct thin_map *map = drawing->map;
    int corners[2 * CORNERS], count = convex_corners(outline, corners);
    double more = drawing->margin + outline->bend + 0.01, top = INFINITY, bottom = -INFINITY;
    for (int i = 0; i < count; i++) {
        top = math_min(top, outline->y[corners[i]]);
        bottom = math_max(bottom, outline->y[corners[i]]);
    }
    /* The rows that it may touch. */
    double first = math_max(math_max(map->y0, view->top), floor(top - more)),
           last = math_min(math_min((double)map->y0 + map->height, view->bottom) - 1, floor(bottom + more));
    if (!(first <= last))
        return;
    atomic_store_explicit(&drawing->found, true, memory_order_relaxed);
    /* The nearest drawing of a pixel stays: numbers of nearness compare like their bits. */
    uint32_t bits = bits_of((float)(outline->nearness * (1 + 1e-6))) & ~THIN_FLAGS;
    bits |= outline->length <= small ? THIN_SMALL : outline->width < line ? THIN_LINE : 0;
    double x_min = math_max(map->x0, view->left), x_max = math_min((double)map->x0 + map->width, view->right) - 1;
    for (double y = first; y <= last; y++) {
        double left = INFINITY, right = -INFINITY, above = y - more, below = y + 1 + more;
        /* The extent of the hull over the height of a row, edge by edge. */
        for (int i = 0; i < count; i++) {
            int a = corners[i], b = corners[(i + 1) % count];
            double ay = outline->y[a], by = outline->y[b], dy = by - ay, dx = outline->x[b] - outline->x[a];
            if (math_max(ay, by) < above || math_min(ay, by) > below)
                continue;
            double t0 = dy != 0 ? limited((above - ay) / dy, 0, 1) : 0,
                   t1 = dy != 0 ? limited((below - ay) / dy, 0, 1) : 1;
            double x0 = outline->x[a] + t0 * dx, x1 = outline->x[a] + t1 * dx;
            left = math_min(left, math_min(x0, x1));
            right = math_max(right, math_max(x0, x1));
        }
        double end = math_min(x_max, floor(right + more));
        for (double x = math_max(x_min, floor(left - more)); x <= end; x++)
            raise(&map->nearness[(size_t)(y - map->y0) * map->width + (size_t)(x - map->x0)], bits);
    }
}

/* --- primitives --- */

static void corners_of(const struct oriented_box *box, const struct affine *map, struct vec3 out[CORNERS]) {
    struct vec3 edges[3];
    out[0] = affine_point(map, box->corner);
    for (int k = 0; k < 3; k++)
        edges[k] = affine_vector(map, box->edges[k]);
    for (int i = 1; i < CORNERS; i++) {
        int k = i & 1 ? 0 : i & 2 ? 1 : 2;
        out[i] = vec3_add(out[i & ~(1 << k)], edges[k]);
    }
}

/* Twice as long as wide and thick. */
static bool is_long(const struct vec3 corners[CORNERS]) {
    double lengths[3], longest = 0, sum = 0;
    for (int k = 0; k < 3; k++) {
        lengths[k] = vec3_length(vec3_sub(corners[1 << k], corners[0]));
        longest = math_max(longest, lengths[k]);
        sum += lengths[k];
    }
    return longest > 2 * (sum - longest);
}

static void draw_part(struct thin_drawing *drawing, const struct view *view, const struct affine *map,
                      const struct shape_part *part, int depth) {
    struct oriented_box box = shape_part_box(part);
    struct vec3 corners[CORNERS];
    struct outline outline;
    corners_of(&box, map, corners);
    switch (project(view, corners, drawing->margin, &outline)) {
    case OUTLINE_NARROW:
        draw(drawing, view, &outline);
        return;
    case OUTLINE_WIDE: /* a tube that is bent has a wide box */
        if (part->kind == SHAPE_PART_BOX)
            return;
        break;
    case OUTLINE_TO_SPLIT:
        break;
    case OUTLINE_NOWHERE:
        return;
    }
    if (depth == SPLITS || !is_long(corners))
        return;
    struct shape_part halves[2];
    shape_part_split(part, map, halves);
    draw_part(drawing, view, map, &halves[0], depth + 1);
    draw_part(drawing, view, map, &halves[1], depth + 1);
}

static bool geometry_part(const struct geometry *geometry, uint32_t number, struct shape_part *out) {
    if (!geometry->csg)
        return shape_part(&geometry->shape, number, out);
    out->kind = SHAPE_PART_BOX;
    out->box = oriented_box_of(&geometry->csg->bounds);
    return number == 0 && oriented_box_is_finite(&out->box);
}

/* Whether a view can contain it at all. */
static bool is_near(const struct thin_drawing *drawing, const struct view *view, uint32_t primitive) {
    const struct affine same = affine_identity();
    struct oriented_box box = oriented_box_of(&drawing->renderer->job->world->boxes[primitive]);
    struct vec3 corners[CORNERS];
    struct outline outline;
    corners_of(&box, &same, corners);
    return oriented_box_is_finite(&box) && project(view, corners, drawing->margin, &outline) != OUTLINE_NOWHERE;
}

static void draw_chunk(void *context, uint32_t chunk, int worker) {
    struct thin_drawing *drawing = context;
    const struct world *world = drawing->renderer->job->world;
    uint32_t begin = chunk * CHUNK,
             end = begin + CHUNK < world->primitive_count ? begin + CHUNK : world->primitive_count;
    (void)worker;
    for (uint32_t i = begin; i < end && !pool_cancelled(drawing->renderer->pool); i++) {
        for (uint32_t v = 0; v < drawing->view_count; v++) {
            struct shape_part part;
            if (!is_near(drawing, &drawing->views[v], i))
                continue;
            struct affine map = world_placement(world, i, 0).forward;
            for (uint32_t k = 0; geometry_part(primitive_geometry(world, i), k, &part); k++)
                draw_part(drawing, &drawing->views[v], &map, &part, 0);
        }
    }
}

/* --- the map --- */

/* Eyes are displaced, with windows shifted so that all show the same point at the screen. */
static void add_view(struct thin_drawing *drawing, const struct camera_view *from) {
    struct view *view = &drawing->views[drawing->view_count++];
    struct camera_frame *camera = &view->camera;
    const struct lens *lens = &camera->lens;
    *camera = drawing->renderer->camera;
    view->planar = lens->projection == PROJECTION_PERSPECTIVE || lens->projection == PROJECTION_ORTHOGRAPHIC;
    view->left = from->x;
    view->right = from->x + camera->width;
    view->top = from->y;
    view->bottom = from->y + camera->height;
    if (!camera_has_views(camera))
        return;
    camera->eye = vec3_add_scaled(camera->eye, camera->unit_right, from->right);
    camera->eye = vec3_add_scaled(camera->eye, camera->unit_down, from->down);
    view->shift = from->right / lens->screen / vec3_length(camera->right) + from->x;
    view->shift_down = from->down / lens->screen / vec3_length(camera->down) + from->y;
}

/* The views with colours: both eyes of a stereo pair, all of a light field. */
static bool add_views(struct thin_drawing *drawing) {
    const struct camera_frame *camera = &drawing->renderer->camera;
    const struct lens *lens = &camera->lens;
    uint32_t columns = lens->columns > 0 ? (uint32_t)lens->columns : lens->stereo == STEREO_NONE ? 1 : 2;
    uint32_t rows = lens->columns > 0 ? (uint32_t)lens->rows : 1;
    drawing->views = mem_alloc_zero((size_t)columns * rows, sizeof *drawing->views);
    for (uint32_t i = 0; drawing->views && i < columns * rows; i++) {
        struct camera_view view =
            camera_view_at(camera, (i % columns + 0.5) * camera->width, (double)(i / columns + 0.5) * camera->height);
        if (lens->stereo == STEREO_ANAGLYPH)
            view = camera_view_of_eye(camera, i == 0 ? -1 : 1);
        add_view(drawing, &view);
    }
    return drawing->views != NULL;
}

bool thin_map_build(struct thin_map *map, const struct renderer *renderer, double margin, struct error *error) {
    const struct film *film = renderer->job->film;
    struct thin_drawing drawing = {.map = map, .renderer = renderer, .margin = margin};
    *map = (struct thin_map){.x0 = film->x0, .y0 = film->y0, .width = film->width, .height = film->height};
    if (renderer->roams)
        *map = (struct thin_map){.width = renderer->job->width, .height = renderer->job->height};
    uint32_t count = renderer->job->world->primitive_count;
    if (count == 0)
        return true;
    map->nearness = mem_alloc_zero((size_t)map->width * map->height, sizeof *map->nearness);
    if (!map->nearness)
        return error_no_memory(error, "the map of thin primitives");
    if (!add_views(&drawing)) {
        thin_map_destroy(map);
        return error_no_memory(error, "the map of thin primitives");
    }
    bool ok = pool_run(renderer->pool, (count + CHUNK - 1) / CHUNK, draw_chunk, &drawing);
    mem_free(drawing.views);
    if (!ok || !atomic_load(&drawing.found))
        thin_map_destroy(map);
    return ok || error_set(error, ERROR_CANCELLED, "stopped while rendering");
}

void thin_map_destroy(struct thin_map *map) {
    mem_free(map->nearness);
    map->nearness = NULL;
}
