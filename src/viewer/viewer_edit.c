/* Selecting, changing, saving. The selection is stored in its state at the time of picking, with the change of its pose
 * at that time; its current pose follows from the current change, so undoing needs no reply of the render process. All
 * maps are computed in world space and converted to the space of the node's parent. */
#include "viewer/viewer_internal.h"

#include "inspect/pick.h"
#include "math/elementary.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { OPERANDS_BELOW = 1 << 20 }; /* deeper than any operand */

/* Seeing. */

bool viewer_camera_frame(const struct viewer *viewer, struct camera_frame *frame) {
    struct settings settings = settings_default();
    struct error ignored;
    char warning[256];
    settings.lens = viewer->request.settings.lens;
    settings.lens.aperture = 0;
    return camera_prepare(&viewer->pass.view.camera, &settings,
                          (struct picture_size){viewer->request.full_width, viewer->request.full_height}, frame,
                          warning, &ignored);
}

/* Pixels of the window per pixel of the picture. */
static double zoom(const struct viewer *viewer) {
    return viewer->window.layout.shown_width / viewer->request.width;
}

bool viewer_project(const struct viewer *viewer, const struct camera_frame *frame, struct vec3 point, double *x,
                    double *y) {
    double u, v;
    if (!camera_project(frame, point, &u, &v))
        return false;
    *x = viewer->window.layout.left + (u - viewer->request.x0) * zoom(viewer);
    *y = viewer->window.layout.top + (v - viewer->request.y0) * zoom(viewer);
    return true;
}

/* Making changes. */

void viewer_make_edit(struct viewer *viewer, const struct change *change, bool present, bool join) {
    if (!edits_make(&viewer->edit.steps, change, present, join) ||
        !change_list_set(&viewer->edit.pending, change, true))
        viewer_show_message(viewer, "gray: no more changes can be stored");
    viewer_halt(viewer, false);
    viewer->display.hud_dirty = true;
}

void viewer_undo(struct viewer *viewer, bool again) {
    struct change target;
    bool did = again ? edits_redo(&viewer->edit.steps, &target) : edits_undo(&viewer->edit.steps, &target);
    viewer->edit.joins = false;
    if (!did)
        return;
    (void)change_list_set(&viewer->edit.pending, &target, true);
    viewer_halt(viewer, false);
    /* A node that no longer exists cannot be selected. */
    bool gone = target.kind == CHANGE_OWN || target.kind == CHANGE_ADD || target.kind == CHANGE_GONE ||
                target.kind == CHANGE_ADD_LIGHT || target.kind == CHANGE_DARK;
    if (gone)
        viewer->edit.selection.kind = SELECTED_NOTHING;
    viewer->edit.selection.picked.idle_parts = 0; /* they were computed before the change */
    viewer->display.hud_dirty = true;
}

void viewer_resend_edits(struct viewer *viewer) {
    for (uint32_t i = 0; i < viewer->edit.steps.now.count; i++)
        (void)change_list_set(&viewer->edit.pending, &viewer->edit.steps.now.items[i], true);
}

static struct colour three(const double *numbers) {
    return colour_make(numbers[0], numbers[1], numbers[2]);
}

/* The current change of one kind of the selection, or a change without effect. */
static struct change node_change(const struct viewer *viewer, enum change_kind kind) {
    const struct picked *picked = &viewer->edit.selection.picked;
    struct change change = {.kind = kind, .serial = picked->serial};
    (void)snprintf(change.name, sizeof change.name, "%s", picked->name);
    const struct change *now = change_list_find(&viewer->edit.steps.now, &change);
    const struct affine none = affine_identity();
    if (now)
        return *now;
    if (kind == CHANGE_TRANSFORM)
        memcpy(change.numbers, none.m, sizeof none.m);
    return change;
}

static bool map_of(const struct change *change, struct transform *out) {
    struct affine matrix;
    memcpy(matrix.m, change->numbers, sizeof matrix.m);
    return transform_from_affine(&matrix, out);
}

/* The same map in the space of the node's parent. False: that space has a singular matrix. */
static bool map_to_parent(const struct viewer *viewer, const struct transform *in_world, struct transform *out) {
    struct transform world_from_parent;
    if (!transform_from_affine(&viewer->edit.selection.picked.world_from_parent, &world_from_parent))
        return false;
    struct transform parent_from_world = transform_invert(&world_from_parent);
    struct transform half = transform_compose(in_world, &world_from_parent);
    *out = transform_compose(&parent_from_world, &half);
    return true;
}

struct vec3 viewer_moved_point(const struct viewer *viewer, struct vec3 point) {
    struct change change = node_change(viewer, CHANGE_TRANSFORM);
    struct transform now, parent, then_back = transform_invert(&viewer->edit.selection.applied);
    if (!map_of(&change, &now) || !transform_from_affine(&viewer->edit.selection.picked.world_from_parent, &parent))
        return point;
    struct vec3 p = affine_point(&parent.inverse, point);
    p = affine_point(&now.forward, affine_point(&then_back.forward, p));
    return affine_point(&parent.forward, p);
}

static void apply_in_world(struct viewer *viewer, const struct transform *in_world) {
    struct change change = node_change(viewer, CHANGE_TRANSFORM);
    struct transform before, by;
    if (!map_of(&change, &before) || !map_to_parent(viewer, in_world, &by))
        return;
    struct transform after = transform_compose(&by, &before), checked;
    if (!transform_from_affine(&after.forward, &checked)) /* scaled so small that it has no inverse */
        return;
    memcpy(change.numbers, after.forward.m, sizeof after.forward.m);
    viewer_make_edit(viewer, &change, true, viewer->edit.joins);
    viewer->edit.joins = true;
}

/* The centre of the box, or the point that was hit. */
static struct vec3 pivot(const struct viewer *viewer) {
    const struct picked *picked = &viewer->edit.selection.picked;
    struct vec3 sum = {0, 0, 0};
    for (int i = 0; i < 8; i++)
        sum = vec3_add_scaled(sum, picked->corners[i], 0.125);
    return viewer_moved_point(viewer, picked->has_box ? sum : picked->position);
}

static void move_by(struct viewer *viewer, struct vec3 route) {
    struct transform map = transform_translate(route);
    if (viewer->edit.selection.kind == SELECTED_NODE)
        apply_in_world(viewer, &map);
    else
        viewer_light_move(viewer, route);
}

struct vec3 viewer_selection_position(const struct viewer *viewer) {
    const struct light_info *light = viewer_light(viewer, viewer->edit.selection.light);
    if (viewer->edit.selection.kind == SELECTED_LIGHT)
        return light && light->has_position ? light->position : viewer->fly_camera.centre;
    return pivot(viewer);
}

/* The linear part about a point. */
static struct transform about(struct vec3 point, const struct transform *linear) {
    struct transform there = transform_translate(vec3_negate(point)), back = transform_translate(point);
    struct transform half = transform_compose(linear, &there);
    return transform_compose(&back, &half);
}

/* A linear map, about the middle of the selection. */
static void change_form(struct viewer *viewer, const struct transform *map, bool sizes) {
    struct transform whole = about(viewer_selection_position(viewer), map);
    if (viewer->edit.selection.kind == SELECTED_LIGHT)
        viewer_light_turn(viewer, map, sizes);
    else
        apply_in_world(viewer, &whole);
}

void viewer_drag_selection(struct viewer *viewer, double dx, double dy) {
    struct camera_frame frame;
    if (viewer->edit.selection.kind == SELECTED_NOTHING || !viewer_camera_frame(viewer, &frame))
        return;
    struct vec3 at = viewer_selection_position(viewer);
    double depth = vec3_dot(vec3_sub(at, frame.eye), frame.forward), pixel = vec3_length(frame.right) / zoom(viewer);
    if (viewer->request.settings.lens.projection != PROJECTION_ORTHOGRAPHIC)
        pixel *= fabs(depth);
    if (viewer->edit.tool == TOOL_MOVE) {
        struct vec3 route = vec3_scale(frame.unit_right, dx * pixel);
        move_by(viewer, vec3_add_scaled(route, frame.unit_down, dy * pixel));
        return;
    }
    struct transform map;
    if (viewer->edit.tool == TOOL_TURN) {
        /* Like a ball under the mouse: about the axis in the film plane perpendicular to the motion. */
        struct vec3 axis = vec3_add_scaled(vec3_scale(frame.unit_right, -dy), frame.unit_down, dx);
        double length = vec3_length(axis);
        if (!(length > 0))
            return;
        map = transform_rotate_about(axis, -180 * length / viewer->window.layout.shown_height);
    } else {
        map = transform_scale(vec3_all(el_exp(-2 * dy / viewer->window.layout.shown_height)));
    }
    change_form(viewer, &map, viewer->edit.tool == TOOL_SIZE);
}

void viewer_move_selection(struct viewer *viewer, struct vec3 to) {
    move_by(viewer, vec3_sub(to, viewer_selection_position(viewer)));
}

void viewer_turn_selection(struct viewer *viewer, const double degrees[3], double factor) {
    static const struct vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    struct transform map = transform_scale(vec3_all(factor));
    bool turns = false;
    for (int i = 0; i < 3; i++) {
        struct transform turn = transform_rotate_about(axes[i], degrees[i]);
        map = transform_compose(&turn, &map);
        turns = turns || degrees[i] < 0 || degrees[i] > 0;
    }
    change_form(viewer, &map, !turns);
}

void viewer_push_selection(struct viewer *viewer, double steps) {
    struct camera_frame frame;
    if (viewer->edit.selection.kind == SELECTED_NOTHING || !viewer_camera_frame(viewer, &frame))
        return;
    struct vec3 to = vec3_sub(viewer_selection_position(viewer), frame.eye);
    move_by(viewer, vec3_scale(to, 0.05 * steps));
}

/* Selecting. */

/* From pixels of the window to those of the whole picture. False: outside it. */
static bool pixel_at(const struct viewer *viewer, double x, double y, double *u, double *v) {
    *u = floor((x - viewer->window.layout.left) / zoom(viewer));
    *v = floor((y - viewer->window.layout.top) / zoom(viewer));
    bool inside = *u >= 0 && *v >= 0 && *u < viewer->request.width && *v < viewer->request.height;
    *u += viewer->request.x0;
    *v += viewer->request.y0;
    return inside;
}

void viewer_click(struct viewer *viewer, double x, double y, bool operand) {
    uint32_t number;
    viewer->edit.joins = false;
    viewer->display.hud_dirty = true;
    if (!viewer->window.hides_lines && !operand && viewer_near_light(viewer, x, y, &number)) {
        viewer_select_light(viewer, number);
        return;
    }
    /* The middle of the pixel: where its first ray goes. */
    viewer->edit.click = (struct selection){0};
    viewer->edit.probes = viewer->edit.by_node = false;
    if (!pixel_at(viewer, x, y, &viewer->edit.click.x, &viewer->edit.click.y))
        return;
    viewer->edit.click.up = operand ? -OPERANDS_BELOW : 0;
    viewer->edit.click.x += 0.5;
    viewer->edit.click.y += 0.5;
    viewer->edit.click_waits = true;
}

/* Not while another one, or a click, waits. */
void viewer_probe(struct viewer *viewer, double x, double y) {
    double u, v;
    if (viewer->edit.click_waits || !pixel_at(viewer, x, y, &u, &v))
        return;
    viewer->edit.click = (struct selection){.x = u + 0.5, .y = v + 0.5};
    viewer->edit.click_waits = viewer->edit.probes = true;
}

void viewer_frame(struct viewer *viewer, bool selection) {
    const struct picked *picked = &viewer->edit.selection.picked;
    struct box box = viewer->scene.report.bounds;
    if (selection && viewer->edit.selection.kind == SELECTED_NODE && picked->has_box) {
        box = box_empty();
        for (int i = 0; i < 8; i++)
            box = box_add_point(box, viewer_moved_point(viewer, picked->corners[i]));
    } else if (selection) {
        struct vec3 at = viewer_selection_position(viewer), half = vec3_all(0.25 * viewer->fly_camera.speed);
        box = (struct box){vec3_sub(at, half), vec3_add(at, half)};
    }
    fly_camera_frame(&viewer->fly_camera, &box);
}

void viewer_request_pixel_trace(struct viewer *viewer, double x, double y) {
    viewer->trace.requested = pixel_at(viewer, x, y, &viewer->trace.x, &viewer->trace.y);
}

void viewer_select_up(struct viewer *viewer, bool down) {
    const struct picked *picked = &viewer->edit.selection.picked;
    if (viewer->edit.selection.kind != SELECTED_NODE || (down ? picked->below == 0 : picked->levels == 0))
        return;
    if (viewer->edit.selection.node.depth > 0) { /* it may not be visible anywhere */
        viewer->edit.node = viewer->edit.selection.node;
        viewer->edit.by_node = viewer->edit.click_waits = !down && --viewer->edit.node.depth > 0;
        return;
    }
    viewer->edit.click = viewer->edit.selection;
    viewer->edit.click.up += down ? -1 : 1;
    viewer->edit.click_waits = true;
    viewer->edit.probes = viewer->edit.by_node = false;
}

void viewer_receive_picked(struct viewer *viewer, const struct picked *picked) {
    if (viewer->edit.probes) {
        if (picked->hit)
            viewer->fly_camera.centre = picked->position;
        return;
    }
    viewer->edit.selection =
        (struct selection){.kind = picked->hit ? SELECTED_NODE : SELECTED_NOTHING,
                           .picked = *picked,
                           .applied = transform_identity(),
                           .x = viewer->edit.click.x,
                           .y = viewer->edit.click.y,
                           .node = viewer->command.by_node ? viewer->command.node : (struct node_query){0},
                           .up = picked->up < -OPERANDS_BELOW  ? -OPERANDS_BELOW
                                 : picked->up > OPERANDS_BELOW ? OPERANDS_BELOW
                                                               : picked->up};
    viewer->edit.joins = false;
    if (!picked->hit)
        return;
    struct change change = node_change(viewer, CHANGE_TRANSFORM);
    (void)map_of(&change, &viewer->edit.selection.applied);
    viewer->fly_camera.centre = picked->position;
}

/* Adding and taking away. */

void viewer_delete_selection(struct viewer *viewer) {
    struct change change;
    viewer->edit.joins = false;
    if (viewer->edit.selection.kind == SELECTED_NOTHING)
        return;
    if (viewer->edit.selection.kind == SELECTED_LIGHT) {
        viewer_light_delete(viewer);
    } else {
        change = node_change(viewer, CHANGE_GONE);
        viewer_make_edit(viewer, &change, true, false);
    }
    viewer->edit.selection.kind = SELECTED_NOTHING;
}

static uint32_t count_of(const struct viewer *viewer, enum change_kind kind) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < viewer->edit.steps.now.count; i++)
        count += viewer->edit.steps.now.items[i].kind == kind;
    return count;
}

/* The position of new nodes: the last clicked point, or in front of the camera. */
struct vec3 viewer_new_position(const struct viewer *viewer) {
    if (viewer->edit.selection.kind == SELECTED_NODE)
        return viewer_moved_point(viewer, viewer->edit.selection.picked.position);
    struct vec3 eye = viewer->pass.view.camera.eye, forward = vec3_normalize(viewer->pass.view.camera.view);
    return vec3_add_scaled(eye, forward, vec3_length(vec3_sub(viewer->fly_camera.centre, eye)));
}

/* What the render process would report for a new ball or cube under the root. */
static struct picked new_picked(const struct viewer *viewer, const struct change *change, struct vec3 layout,
                                double size) {
    struct picked picked = {.hit = true,
                            .serial = UINT32_MAX - change->number,
                            .parent_serial = change->serial,
                            .levels = 1,
                            .material_serial = UINT32_MAX - change->number,
                            .distance = vec3_length(vec3_sub(layout, viewer->pass.view.camera.eye)),
                            .position = layout,
                            .has_box = true,
                            .world_from_parent = viewer->scene.world_from_root};
    const struct material inputs = added_material(three(change->numbers));
    for (int part = 0; part < MATERIAL_PART_PARTS; part++)
        material_part_get(&inputs, (enum material_part)part, picked.inputs[part]);
    pick_copy_name(picked.name, added_kind_name(change->added));
    pick_copy_name(picked.shape, added_kind_name(change->added));
    pick_copy_name(picked.material, "phong");
    (void)snprintf(picked.node_path, sizeof picked.node_path, "%s#%u / added %s#%u", viewer->scene.root_name,
                   change->serial, picked.name, added_number(picked.serial));
    for (int i = 0; i < 8; i++)
        picked.corners[i] =
            vec3_add(layout, vec3_make(i & 1 ? size : -size, i & 2 ? size : -size, i & 4 ? size : -size));
    return picked;
}

static void select_new(struct viewer *viewer, const struct picked *picked) {
    viewer->edit.selection = (struct selection){.kind = SELECTED_NODE, .picked = *picked};
    viewer->edit.selection.applied = transform_identity();
    viewer->edit.joins = false;
}

static void add_copy(struct viewer *viewer) {
    struct picked picked = viewer->edit.selection.picked;
    if (viewer->edit.selection.kind != SELECTED_NODE || picked.levels == 0)
        return;
    struct change change = {.kind = CHANGE_ADD,
                            .serial = picked.parent_serial,
                            .number = viewer->scene.added + count_of(viewer, CHANGE_ADD),
                            .added = ADDED_COPY,
                            .source = picked.serial};
    (void)snprintf(change.name, sizeof change.name, "%s", picked.parent_name);
    for (int i = 0; i < 8; i++)
        picked.corners[i] = viewer_moved_point(viewer, picked.corners[i]);
    picked.position = viewer_moved_point(viewer, picked.position);
    picked.serial = UINT32_MAX - change.number;
    pick_copy_name(picked.name, added_kind_name(ADDED_COPY));
    viewer_make_edit(viewer, &change, true, false);
    select_new(viewer, &picked);
    viewer->edit.tool = TOOL_MOVE;
    /* Beside the other one, by its own width. */
    double width = picked.has_box ? vec3_length(vec3_sub(picked.corners[7], picked.corners[0])) / 2 : 1;
    struct camera_frame frame;
    if (viewer_camera_frame(viewer, &frame))
        move_by(viewer, vec3_scale(frame.unit_right, width));
    viewer->edit.joins = false;
}

void viewer_add_node(struct viewer *viewer, enum added_kind kind) {
    if (kind == ADDED_COPY) {
        if (viewer->edit.selection.kind == SELECTED_LIGHT)
            viewer_copy_light(viewer);
        else
            add_copy(viewer);
        return;
    }
    struct vec3 layout = viewer_new_position(viewer);
    double size = 0.1 * vec3_length(vec3_sub(layout, viewer->pass.view.camera.eye));
    struct change change = {.kind = CHANGE_ADD,
                            .serial = viewer->scene.root,
                            .number = viewer->scene.added + count_of(viewer, CHANGE_ADD),
                            .added = kind,
                            .numbers = {0.7, 0.7, 0.7}};
    (void)snprintf(change.name, sizeof change.name, "%s", viewer->scene.root_name);
    if (!(size > 0))
        size = 1;
    viewer_make_edit(viewer, &change, true, false);
    /* From a shape of size 1 at the origin of the root's space to its pose in the world. */
    struct picked picked = new_picked(viewer, &change, vec3_make(0, 0, 0), 1);
    for (int i = 0; i < 8; i++)
        picked.corners[i] = affine_point(&viewer->scene.world_from_root, picked.corners[i]);
    picked.position = affine_point(&viewer->scene.world_from_root, picked.position);
    picked.distance = size * 10;
    select_new(viewer, &picked);
    struct transform map = transform_scale(vec3_all(size));
    map = about(picked.position, &map);
    struct transform move = transform_translate(vec3_sub(layout, picked.position));
    map = transform_compose(&move, &map);
    apply_in_world(viewer, &map);
    viewer->edit.joins = false;
    viewer->edit.tool = TOOL_MOVE;
}

/* Looks. */

static struct change material_change(const struct viewer *viewer, enum material_part part) {
    const struct picked *picked = &viewer->edit.selection.picked;
    struct change change = {.kind = CHANGE_MATERIAL, .serial = picked->material_serial, .part = part};
    const struct change *now = change_list_find(&viewer->edit.steps.now, &change);
    if (!now)
        memcpy(change.numbers, picked->inputs[part], sizeof picked->inputs[part]);
    return now ? *now : change;
}

void viewer_material_now(const struct viewer *viewer, enum material_part part, double numbers[3]) {
    struct change change = material_change(viewer, part);
    memcpy(numbers, change.numbers, 3 * sizeof *numbers);
}

void viewer_set_material(struct viewer *viewer, enum material_part part, const double numbers[3]) {
    struct change change = material_change(viewer, part);
    if (change.serial == 0)
        return;
    memcpy(change.numbers, numbers, 3 * sizeof *numbers);
    /* Other material inputs may have an effect now. */
    if (!(viewer->edit.selection.picked.idle_parts >> part & 1))
        viewer->edit.selection.picked.idle_parts = 0;
    viewer_make_edit(viewer, &change, true, viewer->edit.joins);
    viewer->edit.joins = true;
}

/* The copy is made of the script's material; the changes of that are applied to the copy, too. */
void viewer_make_own_material(struct viewer *viewer) {
    struct picked *picked = &viewer->edit.selection.picked;
    struct change held[MATERIAL_PART_PARTS];
    int count = 0;
    if (viewer->edit.selection.kind != SELECTED_NODE || !picked->can_own)
        return;
    for (int part = 0; part < MATERIAL_PART_PARTS; part++) {
        struct change change = material_change(viewer, (enum material_part)part);
        if (change_list_find(&viewer->edit.steps.now, &change))
            held[count++] = change;
    }
    struct change change = {.kind = CHANGE_OWN,
                            .serial = picked->serial,
                            .number = viewer->scene.owned + count_of(viewer, CHANGE_OWN),
                            .source = picked->material_serial};
    (void)snprintf(change.name, sizeof change.name, "%s", picked->name);
    viewer_make_edit(viewer, &change, true, false);
    /* The changes of the shared material hold for the copy, too. */
    picked->material_serial = OWN_SERIAL - change.number;
    for (int i = 0; i < count; i++) {
        held[i].serial = picked->material_serial;
        viewer_make_edit(viewer, &held[i], true, false);
    }
    picked->can_own = false;
    viewer->edit.joins = false;
}

void viewer_set_exposure(struct viewer *viewer, double stops) {
    viewer->request.settings.tone.exposure = stops < -100 ? -100 : stops > 100 ? 100 : stops;
    viewer_redraw(viewer);
    viewer->display.hud_dirty = true;
}
