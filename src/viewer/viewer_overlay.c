/* The overlay in the window: lines are part of the image that is shown and saved, the outline of the selection is drawn
 * over it. While the camera moves, there are fewer lines with coarse depth, and the outline is a box; both are made
 * again before the finest pass continues. */
#include "viewer/viewer_internal.h"

#include "base/mem.h"

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

static bool add_side(struct viewer *viewer, uint32_t x, uint32_t y, bool upright) {
    if (viewer->overlay.side_count == viewer->overlay.side_room) {
        uint32_t room = viewer->overlay.side_room ? 2 * viewer->overlay.side_room : 1024;
        struct outline_side *more = mem_resize_array(viewer->overlay.sides, room, sizeof *more);
        if (!more)
            return false;
        viewer->overlay.sides = more;
        viewer->overlay.side_room = room;
    }
    viewer->overlay.sides[viewer->overlay.side_count++] = (struct outline_side){x, y, upright};
    return true;
}

/* Edges between a pixel that shows the node and one that does not. There are none at the borders of the picture. */
static void take_outline(struct viewer *viewer, const struct view_overlay_buffers *buffers,
                         struct film_rectangle area) {
    uint32_t width = viewer->request.width, height = viewer->request.height;
    bool ok = true;
    viewer->overlay.side_count = 0;
    area.x1 = area.x1 < width ? area.x1 : width;
    area.y1 = area.y1 < height ? area.y1 : height;
    for (uint32_t y = area.y0; ok && y < area.y1; y++) {
        const uint8_t *row = buffers->shows + (size_t)y * width;
        for (uint32_t x = area.x0; ok && x < area.x1; x++) {
            bool left = x > area.x0 && row[x - 1], above = y > area.y0 && row[(ptrdiff_t)x - (ptrdiff_t)width];
            if (x > 0 && left != (row[x] != 0))
                ok = add_side(viewer, x, y, true);
            if (ok && y > 0 && above != (row[x] != 0))
                ok = add_side(viewer, x, y, false);
        }
        /* The node is not visible beyond the last pixel of the area. */
        if (ok && area.x1 < width && area.x1 > area.x0 && row[area.x1 - 1])
            ok = add_side(viewer, area.x1, y, true);
    }
    for (uint32_t x = area.x0; ok && area.y1 < height && area.y1 > area.y0 && x < area.x1; x++)
        if (buffers->shows[(size_t)(area.y1 - 1) * width + x])
            ok = add_side(viewer, x, area.y1, false);
    viewer->overlay.side_count = ok ? viewer->overlay.side_count : 0;
}

void viewer_receive_overlay(struct viewer *viewer, const struct view_overlay_request *request,
                            const struct view_overlay *overlay) {
    struct view_overlay_buffers buffers;
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
        viewer->overlay.side_count = 0;
        if (overlay->has_outline)
            take_outline(viewer, &buffers, overlay->outline);
        viewer->overlay.outline_fresh = true;
    }
    viewer->display.hud_dirty = true;
}

bool viewer_draw_outline(struct viewer *viewer, struct canvas_colour colour) {
    const struct canvas *canvas = &viewer->window.panel.canvas;
    const struct window_layout *buffers = &viewer->window.layout;
    double zoom = buffers->shown_width / viewer->request.width;
    int thick = canvas->scale + 1, long_side = (int)(zoom + 0.999);
    if (!viewer->overlay.outline_fresh || viewer->pass.outdated || viewer->edit.pending.count > 0 ||
        viewer->overlay.side_count == 0)
        return false;
    for (uint32_t i = 0; i < viewer->overlay.side_count; i++) {
        const struct outline_side *side = &viewer->overlay.sides[i];
        int x = (int)(buffers->left + side->x * zoom), y = (int)(buffers->top + side->y * zoom);
        if (side->upright)
            canvas_box(canvas, x - thick / 2, y - thick / 2, thick, long_side + thick, colour);
        else
            canvas_box(canvas, x - thick / 2, y - thick / 2, long_side + thick, thick, colour);
    }
    return true;
}

void viewer_destroy_overlay(struct viewer *viewer) {
    mem_free(viewer->overlay.lines);
    mem_free(viewer->overlay.sides);
    viewer->overlay.lines = NULL;
    viewer->overlay.sides = NULL;
    viewer->overlay.side_room = viewer->overlay.side_count = 0;
    viewer->overlay.has_lines = false;
    viewer_invalidate_overlay(viewer);
}
