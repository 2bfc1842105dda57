/* Marks in the window: lines are part of what is shown and saved, the outline of what is selected lies over it. While
 * somebody moves, lines are few and their depth is coarse, and the outline is a box; both are made anew before the
 * finest pass goes on. */
#include "base/mem.h"
#include "viewer/viewer_internal.h"

#include <string.h>

enum { BOXES_WALKING = 1500 };

void viewer_invalidate_overlay(struct viewer *viewer) {
    viewer->lines_fresh = viewer->outline_fresh = false;
}

bool viewer_needs_overlay(const struct viewer *viewer) {
    bool lines = viewer->overlay != OVERLAY_NONE && !viewer->lines_fresh;
    bool outline = viewer->selection.kind == SELECTED_NODE && !viewer->outline_fresh;
    return (lines || outline) && !viewer->unbuilt;
}

struct view_overlay_request viewer_overlay_request(const struct viewer *viewer, bool walking) {
    bool outline = viewer->selection.kind == SELECTED_NODE && !walking;
    return (struct view_overlay_request){
        .lines = {viewer->overlay, walking ? BOXES_WALKING : OVERLAY_BOXES, walking ? viewer->divide : 1},
        .outline = outline,
        .serial = outline ? viewer->selection.picked.serial : 0,
        .route = outline ? viewer->selection.picked.route : 0,
        .solid = outline ? viewer->selection.picked.solid : 0};
}

void viewer_choose_overlay(struct viewer *viewer, enum overlay overlay) {
    viewer->overlay = viewer->overlay == overlay ? OVERLAY_NONE : overlay;
    viewer->lines_fresh = false;
    viewer->over_dirty = true;
    if (viewer->overlay != OVERLAY_NONE)
        return;
    viewer->has_lines = false;
    viewer_redraw(viewer);
}

static void take_lines(struct viewer *viewer, const struct view_overlay_buffers *layout) {
    size_t pixels = (size_t)viewer->request.width * viewer->request.height;
    if (!viewer->lines)
        viewer->lines = mem_alloc_zero(pixels, sizeof *viewer->lines);
    if (!viewer->lines)
        return;
    bool had = viewer->has_lines;
    viewer->has_lines = true;
    for (size_t i = 0; i < pixels; i++) {
        bool other = memcmp(viewer->lines[i], layout->lines[i], sizeof viewer->lines[i]) != 0;
        if (other)
            memcpy(viewer->lines[i], layout->lines[i], sizeof viewer->lines[i]);
        if (other || (!had && viewer->lines[i][3] < 1))
            viewer_draw_again(viewer, i);
    }
    viewer->dirty = true;
}

static bool add_side(struct viewer *viewer, uint32_t x, uint32_t y, bool upright) {
    if (viewer->side_count == viewer->side_room) {
        uint32_t room = viewer->side_room ? 2 * viewer->side_room : 1024;
        struct outline_side *more = mem_resize_array(viewer->sides, room, sizeof *more);
        if (!more)
            return false;
        viewer->sides = more;
        viewer->side_room = room;
    }
    viewer->sides[viewer->side_count++] = (struct outline_side){x, y, upright};
    return true;
}

/* Sides between a pixel that shows the node and one that does not. At the borders of the picture there are none. */
static void take_outline(struct viewer *viewer, const struct view_overlay_buffers *layout, struct film_rectangle area) {
    uint32_t width = viewer->request.width, height = viewer->request.height;
    bool ok = true;
    viewer->side_count = 0;
    area.x1 = area.x1 < width ? area.x1 : width;
    area.y1 = area.y1 < height ? area.y1 : height;
    for (uint32_t y = area.y0; ok && y < area.y1; y++) {
        const uint8_t *row = layout->shows + (size_t)y * width;
        for (uint32_t x = area.x0; ok && x < area.x1; x++) {
            bool left = x > area.x0 && row[x - 1], above = y > area.y0 && row[(ptrdiff_t)x - (ptrdiff_t)width];
            if (x > 0 && left != (row[x] != 0))
                ok = add_side(viewer, x, y, true);
            if (ok && y > 0 && above != (row[x] != 0))
                ok = add_side(viewer, x, y, false);
        }
        /* Beyond the last pixel of the area nothing is of the node. */
        if (ok && area.x1 < width && area.x1 > area.x0 && row[area.x1 - 1])
            ok = add_side(viewer, area.x1, y, true);
    }
    for (uint32_t x = area.x0; ok && area.y1 < height && area.y1 > area.y0 && x < area.x1; x++)
        if (layout->shows[(size_t)(area.y1 - 1) * width + x])
            ok = add_side(viewer, x, area.y1, false);
    viewer->side_count = ok ? viewer->side_count : 0;
}

void viewer_take_overlay(struct viewer *viewer, const struct view_overlay_request *asked,
                         const struct view_overlay *overlay) {
    struct view_overlay_buffers layout;
    struct view_overlay_request now = viewer_overlay_request(viewer, false);
    if (overlay->stopped)
        return;
    if (overlay->has_lines || overlay->has_outline)
        view_overlay_buffers(&viewer->request, viewer->block, &layout);
    if (asked->lines.kind == viewer->overlay && viewer->overlay != OVERLAY_NONE) {
        if (overlay->has_lines)
            take_lines(viewer, &layout);
        viewer->lines_fresh = asked->lines.cell == 1 && asked->lines.limit == OVERLAY_BOXES;
    }
    if (asked->outline && asked->serial == now.serial && asked->route == now.route) {
        viewer->side_count = 0;
        if (overlay->has_outline)
            take_outline(viewer, &layout, overlay->outline);
        viewer->outline_fresh = true;
    }
    viewer->over_dirty = true;
}

bool viewer_draw_outline(struct viewer *viewer, struct canvas_colour colour) {
    const struct canvas *canvas = &viewer->panel.canvas;
    const struct window_layout *layout = &viewer->layout;
    double zoom = layout->shown_width / viewer->request.width;
    int thick = canvas->scale + 1, long_side = (int)(zoom + 0.999);
    if (!viewer->outline_fresh || viewer->moved || viewer->pending.count > 0 || viewer->side_count == 0)
        return false;
    for (uint32_t i = 0; i < viewer->side_count; i++) {
        const struct outline_side *side = &viewer->sides[i];
        int x = (int)(layout->left + side->x * zoom), y = (int)(layout->top + side->y * zoom);
        if (side->upright)
            canvas_box(canvas, x - thick / 2, y - thick / 2, thick, long_side + thick, colour);
        else
            canvas_box(canvas, x - thick / 2, y - thick / 2, long_side + thick, thick, colour);
    }
    return true;
}

void viewer_destroy_overlay(struct viewer *viewer) {
    mem_free(viewer->lines);
    mem_free(viewer->sides);
    viewer->lines = NULL;
    viewer->sides = NULL;
    viewer->side_room = viewer->side_count = 0;
    viewer->has_lines = false;
    viewer_invalidate_overlay(viewer);
}
