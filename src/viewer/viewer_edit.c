/* Selecting and changing. What is selected is kept as it was when it was picked, with the change of its place at that
 * time; where it is now follows from the change that holds now, so undoing needs no word from the child. All maps are
 * made in the world and carried into the space that the node stands in. */
#include "inspect/pick.h"
#include "math/elementary.h"
#include "viewer/viewer_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { WAY_DOWN = 1 << 20 }; /* farther than any operand is */

/* Seeing. */

bool live_frame(const struct live *live, struct camera_frame *frame) {
    struct settings settings = settings_default();
    struct error ignored;
    char warning[256];
    settings.lens = live->request.lens;
    settings.lens.aperture = 0;
    return camera_prepare(&live->view.camera, &settings, live->request.full_width, live->request.full_height, frame,
                          warning, &ignored);
}

/* Pixels of the window for one of the picture. */
static double zoom(const struct live *live) {
    return live->place.shown_width / live->request.width;
}

bool live_project(const struct live *live, const struct camera_frame *frame, struct vec3 point, double *x, double *y) {
    double u, v;
    if (!camera_project(frame, point, &u, &v))
        return false;
    *x = live->place.left + (u - live->request.x0) * zoom(live);
    *y = live->place.top + (v - live->request.y0) * zoom(live);
    return true;
}

/* Making changes. */

void live_make(struct live *live, const struct change *change, bool present, bool join) {
    if (!edits_make(&live->edits, change, present, join) || !change_list_set(&live->pending, change, true))
        live_tell(live, "gray: there is no room for more changes");
    live_halt(live, false);
    live->over_dirty = true;
}

void live_undo(struct live *live, bool again) {
    struct change target;
    bool did = again ? edits_redo(&live->edits, &target) : edits_undo(&live->edits, &target);
    live->joins = false;
    if (!did)
        return;
    (void)change_list_set(&live->pending, &target, true);
    live_halt(live, false);
    /* What is not there any more cannot be selected. */
    bool gone = target.kind == CHANGE_OWN || target.kind == CHANGE_ADD || target.kind == CHANGE_GONE ||
                target.kind == CHANGE_ADD_LIGHT || target.kind == CHANGE_DARK;
    if (gone)
        live->selection.kind = SELECTED_NOTHING;
    live->over_dirty = true;
}

void live_resend(struct live *live) {
    for (uint32_t i = 0; i < live->edits.now.count; i++)
        (void)change_list_set(&live->pending, &live->edits.now.items[i], true);
}

static struct vec3 three(const double *numbers) {
    return vec3_make(numbers[0], numbers[1], numbers[2]);
}

/* The change of one kind of what is selected as it holds now, or one that changes nothing. */
static struct change node_change(const struct live *live, enum change_kind kind) {
    const struct picked *picked = &live->selection.picked;
    struct change change = {.kind = kind, .serial = picked->serial};
    (void)snprintf(change.name, sizeof change.name, "%s", picked->name);
    const struct change *now = change_list_find(&live->edits.now, &change);
    const struct affine none = affine_identity();
    if (now)
        return *now;
    if (kind == CHANGE_PLACE)
        memcpy(change.numbers, none.m, sizeof none.m);
    return change;
}

static bool map_of(const struct change *change, struct transform *out) {
    struct affine matrix;
    memcpy(matrix.m, change->numbers, sizeof matrix.m);
    return transform_from_affine(&matrix, out);
}

/* The same map, told in the space that the node stands in. False: that space is flat. */
static bool carry(const struct live *live, const struct transform *in_world, struct transform *out) {
    struct transform world_from_parent;
    if (!transform_from_affine(&live->selection.picked.world_from_parent, &world_from_parent))
        return false;
    struct transform parent_from_world = transform_invert(&world_from_parent);
    struct transform half = transform_compose(in_world, &world_from_parent);
    *out = transform_compose(&parent_from_world, &half);
    return true;
}

struct vec3 live_moved_point(const struct live *live, struct vec3 point) {
    struct change change = node_change(live, CHANGE_PLACE);
    struct transform now, parent, then_back = transform_invert(&live->selection.placed);
    if (!map_of(&change, &now) || !transform_from_affine(&live->selection.picked.world_from_parent, &parent))
        return point;
    struct vec3 p = affine_point(&parent.inverse, point);
    p = affine_point(&now.forward, affine_point(&then_back.forward, p));
    return affine_point(&parent.forward, p);
}

static void apply_in_world(struct live *live, const struct transform *in_world) {
    struct change change = node_change(live, CHANGE_PLACE);
    struct transform before, by;
    if (!map_of(&change, &before) || !carry(live, in_world, &by))
        return;
    struct transform after = transform_compose(&by, &before), checked;
    if (!transform_from_affine(&after.forward, &checked)) /* made so small that it has no inverse */
        return;
    memcpy(change.numbers, after.forward.m, sizeof after.forward.m);
    live_make(live, &change, true, live->joins);
    live->joins = true;
}

/* The middle of the box, or where it was hit. */
static struct vec3 pivot(const struct live *live) {
    const struct picked *picked = &live->selection.picked;
    struct vec3 sum = {0, 0, 0};
    for (int i = 0; i < 8; i++)
        sum = vec3_add_scaled(sum, picked->corners[i], 0.125);
    return live_moved_point(live, picked->has_box ? sum : picked->position);
}

static void move_by(struct live *live, struct vec3 way) {
    struct transform map = transform_translate(way);
    if (live->selection.kind == SELECTED_NODE)
        apply_in_world(live, &map);
    else
        live_light_move(live, way);
}

static struct vec3 place_of_selection(const struct live *live) {
    const struct told_light *light = live_light(live, live->selection.light);
    if (live->selection.kind == SELECTED_LIGHT)
        return light && light->placed ? light->position : live->walk.centre;
    return pivot(live);
}

/* About a point: there, the linear part, and back. */
static struct transform about(struct vec3 point, const struct transform *linear) {
    struct transform there = transform_translate(vec3_negate(point)), back = transform_translate(point);
    struct transform half = transform_compose(linear, &there);
    return transform_compose(&back, &half);
}

void live_drag(struct live *live, double dx, double dy) {
    struct camera_frame frame;
    if (live->selection.kind == SELECTED_NOTHING || !live_frame(live, &frame))
        return;
    struct vec3 at = place_of_selection(live);
    double depth = vec3_dot(vec3_sub(at, frame.eye), frame.forward), pixel = vec3_length(frame.right) / zoom(live);
    if (live->request.lens.projection != PROJECTION_ORTHOGRAPHIC)
        pixel *= fabs(depth);
    if (live->tool == TOOL_MOVE) {
        struct vec3 way = vec3_scale(frame.unit_right, dx * pixel);
        move_by(live, vec3_add_scaled(way, frame.unit_down, dy * pixel));
        return;
    }
    struct transform map;
    if (live->tool == TOOL_TURN) {
        /* As a ball under the mouse: about the axis in the film's plane that is across the way. */
        struct vec3 axis = vec3_add_scaled(vec3_scale(frame.unit_right, -dy), frame.unit_down, dx);
        double length = vec3_length(axis);
        if (!(length > 0))
            return;
        map = transform_rotate_about(axis, -180 * length / live->place.shown_height);
    } else {
        map = transform_scale(vec3_all(el_exp(-2 * dy / live->place.shown_height)));
    }
    if (live->selection.kind == SELECTED_LIGHT) {
        live_light_turn(live, &map, live->tool == TOOL_SIZE);
        return;
    }
    map = about(at, &map);
    apply_in_world(live, &map);
}

void live_push(struct live *live, double steps) {
    struct camera_frame frame;
    if (live->selection.kind == SELECTED_NOTHING || !live_frame(live, &frame))
        return;
    struct vec3 to = vec3_sub(place_of_selection(live), frame.eye);
    move_by(live, vec3_scale(to, 0.05 * steps));
}

/* Selecting. */

/* From pixels of the window to those of the whole picture. False: beside it. */
static bool pixel_at(const struct live *live, double x, double y, double *u, double *v) {
    *u = floor((x - live->place.left) / zoom(live));
    *v = floor((y - live->place.top) / zoom(live));
    bool inside = *u >= 0 && *v >= 0 && *u < live->request.width && *v < live->request.height;
    *u += live->request.x0;
    *v += live->request.y0;
    return inside;
}

void live_click(struct live *live, double x, double y, bool operand) {
    uint32_t number;
    live->joins = false;
    live->over_dirty = true;
    if (!live->bare && !operand && live_near_light(live, x, y, &number)) {
        live_select_light(live, number);
        return;
    }
    /* The middle of the pixel: what is told is what its first ray meets. */
    live->asked = (struct selection){0};
    if (!pixel_at(live, x, y, &live->asked.x, &live->asked.y))
        return;
    live->asked.up = operand ? -WAY_DOWN : 0;
    live->asked.x += 0.5;
    live->asked.y += 0.5;
    live->asks = true;
}

void live_ask_story(struct live *live, double x, double y) {
    live->asks_story = pixel_at(live, x, y, &live->story_x, &live->story_y);
}

void live_select_up(struct live *live, bool down) {
    const struct picked *picked = &live->selection.picked;
    if (live->selection.kind != SELECTED_NODE || (down ? picked->below == 0 : picked->levels == 0))
        return;
    live->asked = live->selection;
    live->asked.up += down ? -1 : 1;
    live->asks = true;
}

void live_take_picked(struct live *live, const struct picked *picked) {
    live->selection = (struct selection){.kind = picked->hit ? SELECTED_NODE : SELECTED_NOTHING,
                                         .picked = *picked,
                                         .placed = transform_identity(),
                                         .x = live->asked.x,
                                         .y = live->asked.y,
                                         .up = picked->up < -WAY_DOWN  ? -WAY_DOWN
                                               : picked->up > WAY_DOWN ? WAY_DOWN
                                                                       : picked->up};
    live->joins = false;
    if (!picked->hit)
        return;
    struct change change = node_change(live, CHANGE_PLACE);
    (void)map_of(&change, &live->selection.placed);
    live->walk.centre = picked->position;
}

/* Adding and taking away. */

void live_delete(struct live *live) {
    struct change change;
    live->joins = false;
    if (live->selection.kind == SELECTED_NOTHING)
        return;
    if (live->selection.kind == SELECTED_LIGHT) {
        live_light_delete(live);
    } else {
        change = node_change(live, CHANGE_GONE);
        live_make(live, &change, true, false);
    }
    live->selection.kind = SELECTED_NOTHING;
}

static uint32_t count_of(const struct live *live, enum change_kind kind) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < live->edits.now.count; i++)
        count += live->edits.now.items[i].kind == kind;
    return count;
}

/* Where new things go: where somebody clicked last, or before the camera. */
struct vec3 live_new_place(const struct live *live) {
    if (live->selection.kind == SELECTED_NODE)
        return live_moved_point(live, live->selection.picked.position);
    struct vec3 eye = live->view.camera.eye, ahead = vec3_normalize(live->view.camera.view);
    return vec3_add_scaled(eye, ahead, vec3_length(vec3_sub(live->walk.centre, eye)));
}

/* What the child would say of a new ball or cube under the root. */
static struct picked new_picked(const struct live *live, const struct change *change, struct vec3 place, double size) {
    struct picked picked = {.hit = true,
                            .serial = UINT32_MAX - change->number,
                            .parent_serial = change->serial,
                            .levels = 1,
                            .material_serial = UINT32_MAX - change->number,
                            .distance = vec3_length(vec3_sub(place, live->view.camera.eye)),
                            .position = place,
                            .has_box = true,
                            .world_from_parent = live->scene.world_from_root};
    const struct material look = added_material(three(change->numbers));
    for (int part = 0; part < LOOK_PARTS; part++)
        look_part_get(&look, (enum look_part)part, picked.look[part]);
    pick_words(picked.name, added_kind_name(change->added));
    pick_words(picked.shape, added_kind_name(change->added));
    pick_words(picked.material, "phong");
    (void)snprintf(picked.path, sizeof picked.path, "%s#%u / %s#%u", live->scene.root_name, change->serial, picked.name,
                   picked.serial);
    for (int i = 0; i < 8; i++)
        picked.corners[i] =
            vec3_add(place, vec3_make(i & 1 ? size : -size, i & 2 ? size : -size, i & 4 ? size : -size));
    return picked;
}

static void select_new(struct live *live, const struct picked *picked) {
    live->selection = (struct selection){.kind = SELECTED_NODE, .picked = *picked};
    live->selection.placed = transform_identity();
    live->joins = false;
}

static void add_copy(struct live *live) {
    struct picked picked = live->selection.picked;
    if (live->selection.kind != SELECTED_NODE || picked.levels == 0)
        return;
    struct change change = {.kind = CHANGE_ADD,
                            .serial = picked.parent_serial,
                            .number = live->scene.added + count_of(live, CHANGE_ADD),
                            .added = ADDED_COPY,
                            .source = picked.serial};
    (void)snprintf(change.name, sizeof change.name, "%s", picked.parent_name);
    for (int i = 0; i < 8; i++)
        picked.corners[i] = live_moved_point(live, picked.corners[i]);
    picked.position = live_moved_point(live, picked.position);
    picked.serial = UINT32_MAX - change.number;
    pick_words(picked.name, added_kind_name(ADDED_COPY));
    live_make(live, &change, true, false);
    select_new(live, &picked);
    live->tool = TOOL_MOVE;
    /* Beside the other one, by its own width. */
    double width = picked.has_box ? vec3_length(vec3_sub(picked.corners[7], picked.corners[0])) / 2 : 1;
    struct camera_frame frame;
    if (live_frame(live, &frame))
        move_by(live, vec3_scale(frame.unit_right, width));
    live->joins = false;
}

void live_add(struct live *live, enum added_kind kind) {
    if (kind == ADDED_COPY) {
        if (live->selection.kind == SELECTED_LIGHT)
            live_copy_light(live);
        else
            add_copy(live);
        return;
    }
    struct vec3 place = live_new_place(live);
    double size = 0.1 * vec3_length(vec3_sub(place, live->view.camera.eye));
    struct change change = {.kind = CHANGE_ADD,
                            .serial = live->scene.root,
                            .number = live->scene.added + count_of(live, CHANGE_ADD),
                            .added = kind,
                            .numbers = {0.7, 0.7, 0.7}};
    (void)snprintf(change.name, sizeof change.name, "%s", live->scene.root_name);
    if (!(size > 0))
        size = 1;
    live_make(live, &change, true, false);
    /* From the size of 1 at the origin of the root's space to its place in the world. */
    struct picked picked = new_picked(live, &change, vec3_make(0, 0, 0), 1);
    for (int i = 0; i < 8; i++)
        picked.corners[i] = affine_point(&live->scene.world_from_root, picked.corners[i]);
    picked.position = affine_point(&live->scene.world_from_root, picked.position);
    picked.distance = size * 10;
    select_new(live, &picked);
    struct transform map = transform_scale(vec3_all(size));
    map = about(picked.position, &map);
    struct transform move = transform_translate(vec3_sub(place, picked.position));
    map = transform_compose(&move, &map);
    apply_in_world(live, &map);
    live->joins = false;
    live->tool = TOOL_MOVE;
}

/* Looks. */

static struct change material_change(const struct live *live, enum look_part part) {
    const struct picked *picked = &live->selection.picked;
    struct change change = {.kind = CHANGE_MATERIAL, .serial = picked->material_serial, .part = part};
    const struct change *now = change_list_find(&live->edits.now, &change);
    if (!now)
        memcpy(change.numbers, picked->look[part], sizeof picked->look[part]);
    return now ? *now : change;
}

void live_look_now(const struct live *live, enum look_part part, double numbers[3]) {
    struct change change = material_change(live, part);
    memcpy(numbers, change.numbers, 3 * sizeof *numbers);
}

void live_look(struct live *live, enum look_part part, const double numbers[3]) {
    struct change change = material_change(live, part);
    if (change.serial == 0)
        return;
    memcpy(change.numbers, numbers, 3 * sizeof *numbers);
    live_make(live, &change, true, live->joins);
    live->joins = true;
}

/* The copy is made of the script's material; what was changed of that is changed of the copy, too. */
void live_own(struct live *live) {
    struct picked *picked = &live->selection.picked;
    struct change held[LOOK_PARTS];
    int count = 0;
    if (live->selection.kind != SELECTED_NODE || !picked->can_own)
        return;
    for (int part = 0; part < LOOK_PARTS; part++) {
        struct change change = material_change(live, (enum look_part)part);
        if (change_list_find(&live->edits.now, &change))
            held[count++] = change;
    }
    struct change change = {.kind = CHANGE_OWN,
                            .serial = picked->serial,
                            .number = live->scene.owned + count_of(live, CHANGE_OWN),
                            .source = picked->material_serial};
    (void)snprintf(change.name, sizeof change.name, "%s", picked->name);
    live_make(live, &change, true, false);
    picked->material_serial = OWN_SERIAL - change.number;
    for (int i = 0; i < count; i++) {
        held[i].serial = picked->material_serial;
        live_make(live, &held[i], true, false);
    }
    picked->can_own = false;
    live->joins = false;
}

void live_expose(struct live *live, double stops) {
    live->request.exposure = stops < -100 ? -100 : stops > 100 ? 100 : stops;
    live_redraw(live);
    live->over_dirty = true;
}
