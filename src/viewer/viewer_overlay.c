/* Marks in the window: lines are part of what is shown and saved, the outline of what is selected lies over it. While
 * somebody moves, lines are few and their depth is coarse, and the outline is a box; both are made anew before the
 * finest pass goes on. */
#include "base/mem.h"
#include "viewer/viewer_internal.h"

#include <string.h>

enum { BOXES_WALKING = 1500 };

void live_stale_marks(struct live *live) {
    live->lines_fresh = live->outline_fresh = false;
}

bool live_wants_marks(const struct live *live) {
    bool lines = live->overlay != OVERLAY_NONE && !live->lines_fresh;
    bool outline = live->selection.kind == SELECTED_NODE && !live->outline_fresh;
    return (lines || outline) && !live->unbuilt;
}

struct marks_wish live_marks_wish(const struct live *live, bool walking) {
    bool outline = live->selection.kind == SELECTED_NODE && !walking;
    return (struct marks_wish){
        .lines = {live->overlay, walking ? BOXES_WALKING : OVERLAY_BOXES, walking ? live->divide : 1},
        .outline = outline,
        .serial = outline ? live->selection.picked.serial : 0,
        .way = outline ? live->selection.picked.way : 0,
        .solid = outline ? live->selection.picked.solid : 0};
}

void live_choose_overlay(struct live *live, enum overlay overlay) {
    live->overlay = live->overlay == overlay ? OVERLAY_NONE : overlay;
    live->lines_fresh = false;
    live->over_dirty = true;
    if (live->overlay != OVERLAY_NONE)
        return;
    live->has_lines = false;
    live_redraw(live);
}

static void take_lines(struct live *live, const struct marks_place *place) {
    size_t pixels = (size_t)live->request.width * live->request.height;
    if (!live->lines)
        live->lines = mem_alloc_zero(pixels, sizeof *live->lines);
    if (!live->lines)
        return;
    bool had = live->has_lines;
    live->has_lines = true;
    for (size_t i = 0; i < pixels; i++) {
        bool other = memcmp(live->lines[i], place->lines[i], sizeof live->lines[i]) != 0;
        if (other)
            memcpy(live->lines[i], place->lines[i], sizeof live->lines[i]);
        if (other || (!had && live->lines[i][3] < 1))
            live_draw_again(live, i);
    }
    live->dirty = true;
}

static bool add_side(struct live *live, uint32_t x, uint32_t y, bool upright) {
    if (live->side_count == live->side_room) {
        uint32_t room = live->side_room ? 2 * live->side_room : 1024;
        struct live_side *more = mem_resize_array(live->sides, room, sizeof *more);
        if (!more)
            return false;
        live->sides = more;
        live->side_room = room;
    }
    live->sides[live->side_count++] = (struct live_side){x, y, upright};
    return true;
}

/* Sides between a pixel that shows the node and one that does not. At the borders of the picture there are none. */
static void take_outline(struct live *live, const struct marks_place *place, struct film_rectangle area) {
    uint32_t width = live->request.width, height = live->request.height;
    bool ok = true;
    live->side_count = 0;
    area.x1 = area.x1 < width ? area.x1 : width;
    area.y1 = area.y1 < height ? area.y1 : height;
    for (uint32_t y = area.y0; ok && y < area.y1; y++) {
        const uint8_t *row = place->shows + (size_t)y * width;
        for (uint32_t x = area.x0; ok && x < area.x1; x++) {
            bool left = x > area.x0 && row[x - 1], above = y > area.y0 && row[(ptrdiff_t)x - (ptrdiff_t)width];
            if (x > 0 && left != (row[x] != 0))
                ok = add_side(live, x, y, true);
            if (ok && y > 0 && above != (row[x] != 0))
                ok = add_side(live, x, y, false);
        }
        /* Beyond the last pixel of the area nothing is of the node. */
        if (ok && area.x1 < width && area.x1 > area.x0 && row[area.x1 - 1])
            ok = add_side(live, area.x1, y, true);
    }
    for (uint32_t x = area.x0; ok && area.y1 < height && area.y1 > area.y0 && x < area.x1; x++)
        if (place->shows[(size_t)(area.y1 - 1) * width + x])
            ok = add_side(live, x, area.y1, false);
    live->side_count = ok ? live->side_count : 0;
}

void live_take_marks(struct live *live, const struct marks_wish *asked, const struct marks *marks) {
    struct marks_place place;
    struct marks_wish now = live_marks_wish(live, false);
    if (marks->stopped)
        return;
    if (marks->has_lines || marks->has_outline)
        marks_place(&live->request, live->block, &place);
    if (asked->lines.kind == live->overlay && live->overlay != OVERLAY_NONE) {
        if (marks->has_lines)
            take_lines(live, &place);
        live->lines_fresh = asked->lines.cell == 1 && asked->lines.limit == OVERLAY_BOXES;
    }
    if (asked->outline && asked->serial == now.serial && asked->way == now.way) {
        live->side_count = 0;
        if (marks->has_outline)
            take_outline(live, &place, marks->outline);
        live->outline_fresh = true;
    }
    live->over_dirty = true;
}

bool live_draw_outline(struct live *live, struct ink ink) {
    const struct paper *paper = &live->panel.paper;
    const struct live_place *place = &live->place;
    double zoom = place->shown_width / live->request.width;
    int thick = paper->scale + 1, long_side = (int)(zoom + 0.999);
    if (!live->outline_fresh || live->moved || live->pending.count > 0 || live->side_count == 0)
        return false;
    for (uint32_t i = 0; i < live->side_count; i++) {
        const struct live_side *side = &live->sides[i];
        int x = (int)(place->left + side->x * zoom), y = (int)(place->top + side->y * zoom);
        if (side->upright)
            paper_box(paper, x - thick / 2, y - thick / 2, thick, long_side + thick, ink);
        else
            paper_box(paper, x - thick / 2, y - thick / 2, long_side + thick, thick, ink);
    }
    return true;
}

void live_destroy_marks(struct live *live) {
    mem_free(live->lines);
    mem_free(live->sides);
    live->lines = NULL;
    live->sides = NULL;
    live->side_room = live->side_count = 0;
    live->has_lines = false;
    live_stale_marks(live);
}
