/* What is drawn over the picture. The lines of --overlay are part of the image that is shown and saved; the outline of
 * the selection and the symbols of lights are lines that the window draws over it. While the camera moves, there are
 * fewer lines of --overlay with coarse depth, and the outline is a box; both are made again before the finest pass
 * continues. */
#include "viewer/viewer_internal.h"

#include "base/mem.h"
#include "light/light_edit.h"
#include "math/elementary.h"
#include "math/frame.h"

#include <math.h>
#include <string.h>

enum { BOXES_WALKING = 1500 };

void viewer_invalidate_overlay(struct viewer *viewer) {
    viewer->overlay.lines_fresh = viewer->overlay.outline_fresh = false;
}

bool viewer_needs_overlay(const struct viewer *viewer) {
    bool lines = viewer->overlay.kind != OVERLAY_NONE && !viewer->overlay.lines_fresh;
    bool outline = viewer->edit.selection.kind == SELECTED_NODE && !viewer->overlay.outline_fresh;
    return (lines || outline) && !viewer->pass.unbuilt;
}

struct view_overlay_request viewer_overlay_request(const struct viewer *viewer, bool walking) {
    bool outline = viewer->edit.selection.kind == SELECTED_NODE && !walking;
    return (struct view_overlay_request){
        .lines = {viewer->overlay.kind, walking ? BOXES_WALKING : OVERLAY_BOXES, walking ? viewer->pass.divide : 1},
        .outline = outline,
        .serial = outline ? viewer->edit.selection.picked.serial : 0,
        .route = outline ? viewer->edit.selection.picked.route : 0,
        .solid = outline ? viewer->edit.selection.picked.solid : 0};
}

void viewer_choose_overlay(struct viewer *viewer, enum overlay overlay) {
    viewer->overlay.kind = viewer->overlay.kind == overlay ? OVERLAY_NONE : overlay;
    viewer->overlay.lines_fresh = false;
    viewer->display.hud_dirty = true;
    if (viewer->overlay.kind != OVERLAY_NONE)
        return;
    viewer->overlay.has_lines = false;
    viewer_redraw(viewer);
}

static void take_lines(struct viewer *viewer, const struct view_overlay_buffers *buffers) {
    size_t pixels = (size_t)viewer->request.width * viewer->request.height;
    if (!viewer->overlay.lines)
        viewer->overlay.lines = mem_alloc_zero(pixels, sizeof *viewer->overlay.lines);
    if (!viewer->overlay.lines)
        return;
    bool had = viewer->overlay.has_lines;
    viewer->overlay.has_lines = true;
    for (size_t i = 0; i < pixels; i++) {
        bool other = memcmp(viewer->overlay.lines[i], buffers->lines[i], sizeof viewer->overlay.lines[i]) != 0;
        if (other)
            memcpy(viewer->overlay.lines[i], buffers->lines[i], sizeof viewer->overlay.lines[i]);
        if (other || (!had && viewer->overlay.lines[i][3] < 1))
            viewer_draw_again(viewer, i);
    }
    viewer->window.dirty = true;
    viewer->window.large.stale = viewer->window.large.shown;
}

/* The outline. */

struct silhouette {
    const uint8_t *shows;
    uint32_t width;
    struct film_rectangle area; /* outside it the node is not visible */
};

/* Whether the node is visible on one side of the line `across` and not on the other, beside the pixel `along` it. */
static bool is_edge(const struct silhouette *s, bool upright, uint32_t across, uint32_t along) {
    bool sides[2];
    for (uint32_t i = 0; i < 2; i++) {
        uint32_t x = upright ? across - i : along, y = upright ? along : across - i;
        bool inside = x >= s->area.x0 && x < s->area.x1 && y >= s->area.y0 && y < s->area.y1;
        sides[i] = inside && s->shows[(size_t)y * s->width + x];
    }
    return sides[0] != sides[1];
}

/* The edges between a pixel that shows the node and one that does not, in runs. There are none at the borders of the
 * picture. An outline of too many runs is none. */
static void take_outline(struct viewer *viewer, const struct silhouette *s) {
    enum { LIMIT = WINDOW_LINES / 2 };
    struct viewer_overlay *overlay = &viewer->overlay;
    if (!overlay->outline)
        overlay->outline = mem_alloc_zero(LIMIT, sizeof *overlay->outline);
    for (int upright = 0; upright < 2; upright++) {
        uint32_t first = upright ? s->area.x0 : s->area.y0, last = upright ? s->area.x1 : s->area.y1;
        uint32_t end = upright ? viewer->request.width : viewer->request.height;
        uint32_t from = upright ? s->area.y0 : s->area.x0, to = upright ? s->area.y1 : s->area.x1;
        for (uint32_t across = first > 0 ? first : 1; across <= last && across < end; across++) {
            for (uint32_t along = from, run; along < to; along = run + 1) {
                for (run = along; run < to && is_edge(s, upright, across, run);)
                    run++;
                float a = (float)along, b = (float)run, c = (float)across;
                if (run > along && overlay->outline && overlay->outline_count < LIMIT)
                    overlay->outline[overlay->outline_count++] =
                        upright ? (struct window_line){c, a, c, b, LINE_COLOUR_SELECTED}
                                : (struct window_line){a, c, b, c, LINE_COLOUR_SELECTED};
            }
        }
    }
    overlay->outline_count = overlay->outline_count < LIMIT ? overlay->outline_count : 0;
}

void viewer_receive_overlay(struct viewer *viewer, const struct view_overlay_request *request,
                            const struct view_overlay *overlay) {
    struct view_overlay_buffers buffers = {0};
    struct view_overlay_request now = viewer_overlay_request(viewer, false);
    if (overlay->stopped)
        return;
    if (overlay->has_lines || overlay->has_outline)
        view_overlay_buffers(&viewer->request, viewer->block, &buffers);
    if (request->lines.kind == viewer->overlay.kind && viewer->overlay.kind != OVERLAY_NONE) {
        if (overlay->has_lines)
            take_lines(viewer, &buffers);
        viewer->overlay.lines_fresh = request->lines.cell == 1 && request->lines.limit == OVERLAY_BOXES;
    }
    if (request->outline && request->serial == now.serial && request->route == now.route) {
        struct silhouette s = {buffers.shows, viewer->request.width, overlay->outline};
        s.area.x1 = s.area.x1 < s.width ? s.area.x1 : s.width;
        s.area.y1 = s.area.y1 < viewer->request.height ? s.area.y1 : viewer->request.height;
        viewer->overlay.outline_count = 0;
        if (overlay->has_outline)
            take_outline(viewer, &s);
        viewer->overlay.outline_fresh = true;
    }
    viewer->display.hud_dirty = true;
}

/* Lines over the picture. */

struct drawing {
    struct viewer *viewer;
    struct camera_frame frame;
};

/* Lines beyond the limit are not drawn. */
static void draw(const struct drawing *drawing, double x0, double y0, double x1, double y1, enum line_colour colour) {
    struct window_state *state = drawing->viewer->window.driver->state;
    if (state->line_count < WINDOW_LINES)
        state->lines[state->line_count++] = (struct window_line){(float)x0, (float)y0, (float)x1, (float)y1, colour};
}

/* In short pieces, since a line is not straight in every projection, and may begin behind the camera. */
static void draw_edge(const struct drawing *drawing, struct vec3 a, struct vec3 b, enum line_colour colour) {
    enum { PIECES = 12 };
    double x0 = 0, y0 = 0, x1, y1;
    bool had = false, straight = drawing->viewer->request.settings.lens.projection == PROJECTION_PERSPECTIVE;
    int pieces = straight && viewer_project(drawing->viewer, &drawing->frame, a, &x0, &y0) &&
                         viewer_project(drawing->viewer, &drawing->frame, b, &x1, &y1)
                     ? 1
                     : PIECES;
    for (int i = 0; i <= pieces; i++) {
        struct vec3 p = vec3_add_scaled(a, vec3_sub(b, a), (double)i / pieces);
        bool has = viewer_project(drawing->viewer, &drawing->frame, p, &x1, &y1);
        if (has && had)
            draw(drawing, x0, y0, x1, y1, colour);
        had = has;
        x0 = x1;
        y0 = y1;
    }
}

/* A circle about an axis (unit). */
static void draw_circle(const struct drawing *drawing, struct vec3 centre, struct vec3 axis, double radius,
                        enum line_colour colour) {
    enum { SIDES = 24 };
    struct vec3 right, up, from = centre;
    frame_tangents(axis, &right, &up);
    for (int i = 0; i <= SIDES; i++) {
        double sine, cosine;
        el_sincos(2 * PI * i / SIDES, &sine, &cosine);
        struct vec3 to = vec3_add_scaled(vec3_add_scaled(centre, right, radius * cosine), up, radius * sine);
        if (i > 0)
            draw_edge(drawing, from, to, colour);
        from = to;
    }
}

static void draw_ring(const struct drawing *drawing, double x, double y, double radius, enum line_colour colour) {
    enum { SIDES = 16 };
    for (int i = 0; i < SIDES; i++) {
        double s0, c0, s1, c1;
        el_sincos(2 * PI * i / SIDES, &s0, &c0);
        el_sincos(2 * PI * (i + 1) / SIDES, &s1, &c1);
        draw(drawing, x + radius * c0, y + radius * s0, x + radius * c1, y + radius * s1, colour);
    }
}

/* False: the outline is out of date, or there is none. */
static bool draw_outline(const struct drawing *drawing) {
    const struct viewer *viewer = drawing->viewer;
    const struct window_layout *layout = &viewer->window.layout;
    double zoom = layout->shown_width / viewer->request.width;
    if (!viewer->overlay.outline_fresh || viewer->pass.outdated || viewer->edit.pending.count > 0)
        return false;
    for (uint32_t i = 0; i < viewer->overlay.outline_count; i++) {
        const struct window_line *line = &viewer->overlay.outline[i];
        draw(drawing, layout->left + (double)line->x0 * zoom, layout->top + (double)line->y0 * zoom,
             layout->left + (double)line->x1 * zoom, layout->top + (double)line->y1 * zoom, LINE_COLOUR_SELECTED);
    }
    return viewer->overlay.outline_count > 0;
}

static void draw_node(const struct drawing *drawing) {
    const struct picked *picked = &drawing->viewer->edit.selection.picked;
    struct vec3 corners[8];
    double x, y;
    if (viewer_project(drawing->viewer, &drawing->frame, viewer_moved_point(drawing->viewer, picked->position), &x, &y))
        draw_ring(drawing, x, y, 3 * drawing->viewer->window.layout.density, LINE_COLOUR_SELECTED);
    /* Large parts of an operand may be invisible: its box shows its position. */
    if ((draw_outline(drawing) && picked->solid == 0) || !picked->has_box)
        return;
    for (int i = 0; i < 8; i++)
        corners[i] = viewer_moved_point(drawing->viewer, picked->corners[i]);
    for (int i = 0; i < 8; i++) {
        for (int axis = 1; axis < 8; axis *= 2) {
            if (!(i & axis))
                draw_edge(drawing, corners[i], corners[i | axis], LINE_COLOUR_SELECTED);
        }
    }
}

/* The extent and direction of the selected light. */
static void draw_light(const struct drawing *drawing, const struct light_info *light) {
    struct vec3 at = light->position, a = vec3_scale(light->edge1, 0.5), b = vec3_scale(light->edge2, 0.5);
    double extent = 0.2 * vec3_length(vec3_sub(at, drawing->frame.eye));
    struct vec3 corners[4] = {vec3_add(at, vec3_add(a, b)), vec3_add(at, vec3_sub(a, b)), vec3_sub(at, vec3_add(a, b)),
                              vec3_sub(at, vec3_sub(a, b))};
    uint32_t has = light->properties;
    for (int i = 0; (has & LIGHT_HAS_EDGES) && i < 4; i++)
        draw_edge(drawing, corners[i], corners[(i + 1) % 4], LINE_COLOUR_SELECTED);
    if (has & LIGHT_HAS_RADIUS) {
        struct vec3 to_eye = vec3_normalize(vec3_sub(drawing->frame.eye, at));
        draw_circle(drawing, at, has & LIGHT_HAS_DIRECTION ? light->direction : to_eye, light->radius,
                    LINE_COLOUR_SELECTED);
    }
    if (has & LIGHT_HAS_CONE) {
        double along = light->cos_outer, aside = sqrt(fmax(0, 1 - along * along));
        draw_circle(drawing, vec3_add_scaled(at, light->direction, extent * along), light->direction, extent * aside,
                    LINE_COLOUR_SELECTED);
    }
    if (!(has & LIGHT_HAS_DIRECTION))
        return;
    /* An arrow; that of a light without a position goes through the middle of the view. */
    double half = 0.15 * vec3_length(vec3_sub(drawing->viewer->fly_camera.centre, drawing->frame.eye));
    struct vec3 from = at, tip = vec3_add_scaled(at, light->direction, extent), right, up;
    if (!light->has_position) {
        from = vec3_add_scaled(drawing->viewer->fly_camera.centre, light->direction, -half);
        tip = vec3_add_scaled(from, light->direction, 2 * half);
        frame_tangents(light->direction, &right, &up);
        struct vec3 back = vec3_add_scaled(tip, light->direction, -0.3 * half);
        draw_edge(drawing, vec3_add_scaled(back, right, 0.12 * half), tip, LINE_COLOUR_SELECTED);
        draw_edge(drawing, vec3_add_scaled(back, right, -0.12 * half), tip, LINE_COLOUR_SELECTED);
    }
    draw_edge(drawing, from, tip, LINE_COLOUR_SELECTED);
}

/* A small lamp: a ring with a cross, of a light far away with rays. */
static void draw_symbol(const struct drawing *drawing, uint32_t number) {
    const struct viewer *viewer = drawing->viewer;
    const struct light_info *light = viewer_light(viewer, number);
    bool chosen = viewer->edit.selection.kind == SELECTED_LIGHT && viewer->edit.selection.light == number, seen;
    double x, y, r = 5 * viewer->window.layout.density;
    if (!viewer_light_marker(viewer, &drawing->frame, number, &x, &y, &seen))
        return;
    enum line_colour colour = chosen ? LINE_COLOUR_SELECTED : seen ? LINE_COLOUR_LIGHT : LINE_COLOUR_FAINT;
    draw_ring(drawing, x, y, chosen ? 1.5 * r : r, colour);
    draw(drawing, x - r / 2, y, x + r / 2, y, colour);
    if (!(light->properties & LIGHT_IS_ENVIRONMENT))
        draw(drawing, x, y - r / 2, x, y + r / 2, colour);
    bool distant = !light->has_position && (light->properties & LIGHT_HAS_DIRECTION);
    for (int ray = 0; distant && ray < 4; ray++) {
        double u = ray < 2 ? r : -r, v = ray % 2 ? r : -r;
        draw(drawing, x + u, y + v, x + 1.6 * u, y + 1.6 * v, colour);
    }
}

/* The cube in the upper right corner: the faces that look at the eye, with the letters of their axes. A click on one
 * looks along its axis. */

static const struct vec3 cube_axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
static const double cube_size = 22, cube_margin = 46; /* half of an edge, and of the corner, in dots of the desktop */

/* A point of the face in pixels of the window; u and v along its edges, from -1 to 1. */
static void cube_point(const struct viewer *viewer, const struct camera_frame *frame, int face, const double uv[2],
                       double out[2]) {
    const struct window_layout *layout = &viewer->window.layout;
    int axis = face / 2;
    double sign = face % 2 ? -1 : 1, size = cube_size * layout->density;
    struct vec3 p = vec3_scale(cube_axes[axis], sign);
    p = vec3_add_scaled(p, cube_axes[(axis + 1) % 3], uv[0]);
    p = vec3_add_scaled(p, cube_axes[(axis + 2) % 3], uv[1]);
    out[0] = fmin(layout->left + layout->shown_width, layout->width) - cube_margin * layout->density +
             size * vec3_dot(p, frame->unit_right);
    out[1] = fmax(layout->top, 0) + cube_margin * layout->density + size * vec3_dot(p, frame->unit_down);
}

static bool faces_eye(const struct camera_frame *frame, int face) {
    double along = vec3_dot(cube_axes[face / 2], frame->forward) / vec3_length(frame->forward);
    return (face % 2 ? along : -along) > 0.05;
}

bool viewer_click_cube(struct viewer *viewer, double x, double y) {
    static const double corners[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    struct camera_frame frame;
    if (viewer->window.hides_lines || !viewer_camera_frame(viewer, &frame))
        return false;
    for (int face = 0; face < 6; face++) {
        int left = 0, right = 0;
        for (int i = 0; i < 4 && faces_eye(&frame, face); i++) {
            double a[2], b[2];
            cube_point(viewer, &frame, face, corners[i], a);
            cube_point(viewer, &frame, face, corners[(i + 1) % 4], b);
            double side = (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
            left += side > 0;
            right += side < 0;
        }
        if (left != 4 && right != 4)
            continue;
        fly_camera_face(&viewer->fly_camera, vec3_scale(cube_axes[face / 2], face % 2 ? 1 : -1));
        return true;
    }
    return false;
}

static void draw_cube(const struct drawing *drawing) {
    /* Strokes of the letters, and those of a minus before them: pairs of points of the face. */
    static const double strokes[3][3][4] = {{{-.3, -.4, .3, .4}, {-.3, .4, .3, -.4}, {0, 0, 0, 0}},
                                            {{0, -.4, 0, 0}, {0, 0, -.3, .4}, {0, 0, .3, .4}},
                                            {{-.3, .4, .3, .4}, {.3, .4, -.3, -.4}, {-.3, -.4, .3, -.4}}};
    static const double edges[4][4] = {{-1, -1, 1, -1}, {1, -1, 1, 1}, {1, 1, -1, 1}, {-1, 1, -1, -1}},
                        minus[4] = {-.7, 0, -.45, 0};
    for (int face = 0; face < 6; face++) {
        for (int i = 0; i < 8 && faces_eye(&drawing->frame, face); i++) {
            const double *stroke = i < 4 ? edges[i] : i < 7 ? strokes[face / 2][i - 4] : minus;
            double a[2], b[2];
            if (i == 7 && face % 2 == 0)
                continue;
            cube_point(drawing->viewer, &drawing->frame, face, stroke, a);
            cube_point(drawing->viewer, &drawing->frame, face, stroke + 2, b);
            draw(drawing, a[0], a[1], b[0], b[1],
                 i < 4 ? LINE_COLOUR_FAINT : (enum line_colour)(LINE_COLOUR_X + face / 2));
        }
    }
}

/* Of the selection, where nothing is being done with it; while a handle is held, that handle. */
static void draw_handles(const struct drawing *drawing) {
    const struct viewer *viewer = drawing->viewer;
    for (enum edit_tool tool = TOOL_MOVE; tool <= TOOL_SIZE; tool++) {
        for (int axis = 0; axis < 3; axis++) {
            bool free = viewer->edit.tool == TOOL_NONE,
                 held = viewer->edit.tool == tool && (viewer->edit.axis == 0 || viewer->edit.axis == axis + 1);
            enum line_colour colour = (enum line_colour)(LINE_COLOUR_X + axis);
            double points[HANDLE_POINTS][2], density = viewer->window.layout.density;
            if (!(free || held) || !viewer_handle(viewer, &drawing->frame, tool, axis, points))
                continue;
            for (int i = 1; i < HANDLE_POINTS; i++)
                draw(drawing, points[i - 1][0], points[i - 1][1], points[i][0], points[i][1], colour);
            const double *end = points[HANDLE_POINTS - 1];
            if (tool != TOOL_TURN)
                draw_ring(drawing, end[0], end[1], (tool == TOOL_MOVE ? 2.5 : 4) * density, colour);
        }
    }
}

void viewer_make_lines(struct viewer *viewer) {
    struct drawing drawing = {.viewer = viewer};
    viewer->window.driver->state->line_count = 0;
    if (!viewer->block || viewer->window.hides_lines || !viewer_camera_frame(viewer, &drawing.frame))
        return;
    if (viewer->edit.selection.kind == SELECTED_NODE)
        draw_node(&drawing);
    for (uint32_t i = 1; i <= viewer->lights.known; i++)
        draw_symbol(&drawing, i);
    const struct light_info *light = viewer_light(viewer, viewer->edit.selection.light);
    if (viewer->edit.selection.kind == SELECTED_LIGHT && light)
        draw_light(&drawing, light);
    draw_handles(&drawing);
    draw_cube(&drawing);
}

void viewer_destroy_overlay(struct viewer *viewer) {
    mem_free(viewer->overlay.lines);
    mem_free(viewer->overlay.outline);
    viewer->overlay.lines = NULL;
    viewer->overlay.outline = NULL;
    viewer->overlay.outline_count = 0;
    viewer->overlay.has_lines = false;
    viewer_invalidate_overlay(viewer);
}
