/* Selecting and changing nodes and lights. A node is stored in its state at the time of picking, with the change of its
 * pose at that time; its current pose follows from the current change, so undoing needs no reply of the render process.
 * All maps are computed in world space and converted to the space of the node's parent. Lights are those that the
 * render process reports; the position of a light that is moved is used before. */
#include "viewer/viewer_internal.h"

#include "base/mem.h"
#include "inspect/pick.h"
#include "light/light_edit.h"
#include "math/elementary.h"
#include "script/addable.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { OPERANDS_BELOW = 1 << 20 }; /* deeper than any operand */
enum { LIGHT_LIMIT = 4096 };       /* the window ignores further ones */
/* Dots of the desktop: the largest distance of a click from a light or a handle, the smallest of the mark of a light
 * from the border, the length of a handle. */
static const double near_mark = 8, mark_margin = 12, handle_length = 90;

static const struct vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

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

/* From pixels of the window to those of the whole picture. False: outside it. */
static bool pixel_at(const struct viewer *viewer, double x, double y, double *u, double *v) {
    *u = floor((x - viewer->window.layout.left) / zoom(viewer));
    *v = floor((y - viewer->window.layout.top) / zoom(viewer));
    bool inside = *u >= 0 && *v >= 0 && *u < viewer->request.width && *v < viewer->request.height;
    *u += viewer->request.x0;
    *v += viewer->request.y0;
    return inside;
}

/* World units of a pixel of the window at the depth of a point. */
static double pixel_size(const struct viewer *viewer, const struct camera_frame *frame, struct vec3 at) {
    double size = vec3_length(frame->right) / zoom(viewer);
    bool parallel = viewer->request.settings.lens.projection == PROJECTION_ORTHOGRAPHIC;
    return parallel ? size : size * fabs(vec3_dot(vec3_sub(at, frame->eye), frame->forward));
}

/* Lights. */

void viewer_receive_lights(struct viewer *viewer, const struct preview_reply *reply) {
    struct viewer_lights *lights = &viewer->lights;
    uint32_t count = reply->light_count < LIGHT_LIMIT ? reply->light_count : LIGHT_LIMIT, first = reply->first_light;
    if (!lights->items)
        lights->items = mem_alloc_zero(LIGHT_LIMIT, sizeof *lights->items);
    lights->count = lights->items ? count : 0;
    uint32_t fresh = first < lights->count ? lights->count - first : 0;
    fresh = fresh < LIGHTS_PER_MESSAGE ? fresh : LIGHTS_PER_MESSAGE;
    if (fresh > 0)
        memcpy(lights->items + first, reply->lights, fresh * sizeof *reply->lights);
    if (first <= lights->known && first + fresh > lights->known)
        lights->known = first + fresh;
    lights->known = lights->known < lights->count ? lights->known : lights->count;
    viewer->display.hud_dirty = true;
}

const struct light_info *viewer_light(const struct viewer *viewer, uint32_t number) {
    return number >= 1 && number <= viewer->lights.known ? &viewer->lights.items[number - 1] : NULL;
}

static const struct light_info *selected_light(const struct viewer *viewer) {
    return viewer->edit.selection.kind == SELECTED_LIGHT ? viewer_light(viewer, viewer->edit.selection.light) : NULL;
}

/* Where the point is, or the point at the border in its direction. */
static bool marker_point(const struct viewer *viewer, const struct camera_frame *frame, struct vec3 point, double *x,
                         double *y, bool *seen) {
    const struct window_layout *layout = &viewer->window.layout;
    double margin = mark_margin * layout->density, left = math_max(layout->left, 0) + margin,
           top = math_max(layout->top, 0) + margin,
           right = math_min(layout->left + layout->shown_width, layout->width) - margin,
           bottom = math_min(layout->top + layout->shown_height, layout->height) - margin;
    if (left >= right || top >= bottom)
        return false;
    *seen = viewer_project(viewer, frame, point, x, y) && *x >= left && *x <= right && *y >= top && *y <= bottom;
    if (*seen)
        return true;
    struct vec3 toward = vec3_sub(point, frame->eye);
    double dx = vec3_dot(toward, frame->unit_right), dy = vec3_dot(toward, frame->unit_down);
    double wide = (right - left) / 2, high = (bottom - top) / 2, size = math_max(fabs(dx), fabs(dy));
    dx = size > 0 ? dx / size : 0;
    dy = size > 0 ? dy / size : 1;
    double extent = math_min(wide / math_max(fabs(dx), 1e-9), high / math_max(fabs(dy), 1e-9));
    *x = left + wide + extent * dx;
    *y = top + high + extent * dy;
    return isfinite(*x) && isfinite(*y);
}

bool viewer_light_marker(const struct viewer *viewer, const struct camera_frame *frame, uint32_t number, double *x,
                         double *y, bool *seen) {
    const struct light_info *light = viewer_light(viewer, number);
    if (!light ||
        !(math_max(light->colour.r, math_max(light->colour.g, light->colour.b)) > 0)) /* a removed light is black */
        return false;
    if (light->has_position)
        return marker_point(viewer, frame, light->position, x, y, seen);
    struct vec3 from = light->properties & LIGHT_HAS_DIRECTION ? vec3_negate(light->direction) : vec3_make(0, 1, 0);
    double far = 1e6 * (1 + vec3_max_abs(frame->eye));
    return marker_point(viewer, frame, vec3_add_scaled(frame->eye, from, far), x, y, seen);
}

/* The light whose mark is there, or 0. */
static uint32_t light_at(const struct viewer *viewer, double x, double y) {
    struct camera_frame frame;
    double best = near_mark * viewer->window.layout.density, u, v;
    uint32_t number = 0;
    bool seen;
    if (!viewer_camera_frame(viewer, &frame))
        return 0;
    for (uint32_t i = 1; i <= viewer->lights.known; i++) {
        if (!viewer_light_marker(viewer, &frame, i, &u, &v, &seen))
            continue;
        double apart = sqrt((u - x) * (u - x) + (v - y) * (v - y));
        number = apart < best ? i : number;
        best = math_min(apart, best);
    }
    return number;
}

/* Changes. */

static void make(struct viewer *viewer, const struct change *change, bool present) {
    if (!edits_make(&viewer->edit.steps, change, present, viewer->edit.joins) ||
        !change_list_set(&viewer->edit.pending, change, true))
        viewer_show_message(viewer, "gray: no more changes can be stored");
    viewer_halt(viewer, false);
    viewer->edit.joins = true;
    viewer->display.hud_dirty = true;
}

static void make_step(struct viewer *viewer, const struct change *change, bool present) {
    viewer->edit.joins = false;
    make(viewer, change, present);
    viewer->edit.joins = false;
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
    bool made = target.kind == CHANGE_ADD || target.kind == CHANGE_ADD_LIGHT;
    bool gone = target.kind == CHANGE_OWN || target.kind == CHANGE_GONE || target.kind == CHANGE_DARK ||
                (made && !change_list_find(&viewer->edit.steps.now, &target));
    if (gone)
        viewer->edit.selection.kind = SELECTED_NOTHING;
    else if (target.kind == CHANGE_ADD && viewer->edit.selection.kind == SELECTED_NODE)
        viewer_select_node(viewer, &(struct node_query){.serial = viewer->edit.selection.picked.serial});
    viewer->edit.selection.picked.idle_parts = 0; /* they were computed before the change */
    viewer->display.hud_dirty = true;
}

/* An edit had no effect: a changed call goes back to the one before. */
void viewer_take_back(struct viewer *viewer, const char *text) {
    const struct edits *steps = &viewer->edit.steps;
    const struct edit *last = steps->at > 0 ? &steps->steps[steps->at - 1] : NULL;
    const struct change *sent = &viewer->command.change;
    viewer_show_notice(viewer, text, true);
    if (last && last->had && last->has && change_same_target(&last->after, sent) && sent->call[0] != '\0' &&
        strcmp(last->after.call, sent->call) == 0)
        viewer_undo(viewer, false);
}

void viewer_resend_edits(struct viewer *viewer) {
    for (uint32_t i = 0; i < viewer->edit.steps.now.count; i++)
        (void)change_list_set(&viewer->edit.pending, &viewer->edit.steps.now.items[i], true);
}

static uint32_t count_of(const struct viewer *viewer, enum change_kind kind) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < viewer->edit.steps.now.count; i++)
        count += viewer->edit.steps.now.items[i].kind == kind;
    return count;
}

struct change viewer_change(const struct viewer *viewer, enum change_kind kind, enum material_part part) {
    static const struct change light = {.kind = CHANGE_LIGHT, .numbers = {0, 0, 0, 1, 1, 1}};
    static const struct change pose = {.kind = CHANGE_TRANSFORM, .numbers = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
    const struct selection *selection = &viewer->edit.selection;
    const struct picked *picked = &selection->picked;
    bool of_light = kind == CHANGE_LIGHT || kind == CHANGE_DARK, of_material = kind == CHANGE_MATERIAL;
    struct change change = kind == CHANGE_LIGHT       ? light
                           : kind == CHANGE_TRANSFORM ? pose
                                                      : (struct change){.kind = kind};
    change.part = part;
    change.serial = of_light ? selection->light : of_material ? picked->material_serial : picked->serial;
    if (of_material)
        memcpy(change.numbers, picked->inputs[part], sizeof picked->inputs[part]);
    else if (!of_light)
        (void)snprintf(change.name, sizeof change.name, "%s", picked->name);
    const struct change *now = change_list_find(&viewer->edit.steps.now, &change);
    return now ? *now : change;
}

void viewer_set_numbers(struct viewer *viewer, enum change_kind kind, enum material_part part, uint32_t at,
                        const double *numbers) {
    struct change change = viewer_change(viewer, kind, part);
    struct picked *picked = &viewer->edit.selection.picked;
    if (change.serial == 0)
        return;
    memcpy(change.numbers + at, numbers, 3 * sizeof *numbers);
    change.colours = change.colours || at == COLOUR_AT;
    /* Other inputs of a material may have an effect now. */
    if (kind == CHANGE_MATERIAL && !(picked->idle_parts >> part & 1))
        picked->idle_parts = 0;
    make(viewer, &change, true);
}

/* Poses. */

static bool map_of(const struct change *change, struct transform *out) {
    struct affine matrix;
    memcpy(matrix.m, change->numbers, sizeof matrix.m);
    return transform_from_affine(&matrix, out);
}

/* A map of the world in the space of a parent. False: that space has a singular matrix. */
static bool map_to_parent(const struct affine *world_from_parent, const struct transform *in_world,
                          struct transform *out) {
    struct transform parent;
    if (!transform_from_affine(world_from_parent, &parent))
        return false;
    struct transform back = transform_invert(&parent), half = transform_compose(in_world, &parent);
    *out = transform_compose(&back, &half);
    return true;
}

struct vec3 viewer_moved_point(const struct viewer *viewer, struct vec3 point) {
    struct change change = viewer_change(viewer, CHANGE_TRANSFORM, 0);
    struct transform now, parent, then_back = transform_invert(&viewer->edit.selection.applied);
    if (!map_of(&change, &now) || !transform_from_affine(&viewer->edit.selection.picked.world_from_parent, &parent))
        return point;
    struct vec3 p = affine_point(&parent.inverse, point);
    p = affine_point(&now.forward, affine_point(&then_back.forward, p));
    return affine_point(&parent.forward, p);
}

/* The centre of the box, or the point that was hit. */
struct vec3 viewer_selection_position(const struct viewer *viewer) {
    const struct picked *picked = &viewer->edit.selection.picked;
    const struct light_info *light = selected_light(viewer);
    struct vec3 sum = {0, 0, 0};
    if (viewer->edit.selection.kind == SELECTED_LIGHT)
        return light && light->has_position ? light->position : viewer->fly_camera.centre;
    for (int i = 0; i < 8; i++)
        sum = vec3_add_scaled(sum, picked->corners[i], 0.125);
    return viewer_moved_point(viewer, picked->has_box ? sum : picked->position);
}

bool viewer_can(const struct viewer *viewer, enum edit_tool tool) {
    const struct light_info *light = selected_light(viewer);
    if (viewer->edit.selection.kind == SELECTED_NODE)
        return tool != TOOL_NONE;
    return light && ((tool == TOOL_MOVE && light->moves) || (tool == TOOL_TURN && light->turns) ||
                     (tool == TOOL_SIZE && light->sizes));
}

static void transform_node(struct viewer *viewer, const struct transform *in_world) {
    struct change change = viewer_change(viewer, CHANGE_TRANSFORM, 0);
    struct transform before, by, checked;
    if (!map_of(&change, &before) || !map_to_parent(&viewer->edit.selection.picked.world_from_parent, in_world, &by))
        return;
    struct transform after = transform_compose(&by, &before);
    if (!transform_from_affine(&after.forward, &checked)) /* scaled so small that it has no inverse */
        return;
    memcpy(change.numbers, after.forward.m, sizeof after.forward.m);
    make(viewer, &change, true);
}

/* The linear part of the map, about the position of the light. An environment is rotated about the y axis only. */
static void turn_light(struct viewer *viewer, const struct affine *map) {
    struct change change = viewer_change(viewer, CHANGE_LIGHT, 0);
    struct affine turn = *map, before = affine_identity();
    struct transform checked;
    double linear[TURN_NUMBERS], sine, cosine;
    for (int i = 0; i < TURN_NUMBERS; i++) {
        linear[i] = turn.m[i / 3][i % 3];
        before.m[i / 3][i % 3] = change.turns ? change.numbers[TURN_AT + i] : before.m[i / 3][i % 3];
    }
    if (selected_light(viewer)->properties & LIGHT_IS_ENVIRONMENT) {
        if (!turn_about_y(linear, &sine, &cosine))
            return;
        turn = (struct affine){{{cosine, 0, sine, 0}, {0, 1, 0, 0}, {-sine, 0, cosine, 0}}};
    }
    struct affine after = affine_compose(&turn, &before);
    if (!transform_from_affine(&after, &checked))
        return;
    change.turns = true;
    for (int i = 0; i < TURN_NUMBERS; i++)
        change.numbers[TURN_AT + i] = after.m[i / 3][i % 3];
    make(viewer, &change, true);
}

void viewer_move(struct viewer *viewer, struct vec3 by) {
    struct transform map = transform_translate(by);
    if (!viewer_can(viewer, TOOL_MOVE))
        return;
    if (viewer->edit.selection.kind == SELECTED_NODE) {
        transform_node(viewer, &map);
        return;
    }
    struct change change = viewer_change(viewer, CHANGE_LIGHT, 0);
    const double numbers[3] = {change.numbers[0] + by.x, change.numbers[1] + by.y, change.numbers[2] + by.z};
    viewer_set_numbers(viewer, CHANGE_LIGHT, 0, 0, numbers);
    struct light_info *light = &viewer->lights.items[viewer->edit.selection.light - 1];
    light->position = vec3_add(light->position, by);
}

/* A linear map about the middle of the selection. */
static void change_form(struct viewer *viewer, enum edit_tool tool, const struct transform *linear) {
    struct vec3 middle = viewer_selection_position(viewer);
    struct transform there = transform_translate(vec3_negate(middle)), back = transform_translate(middle);
    struct transform half = transform_compose(linear, &there), whole = transform_compose(&back, &half);
    if (!viewer_can(viewer, tool))
        return;
    if (viewer->edit.selection.kind == SELECTED_NODE)
        transform_node(viewer, &whole);
    else
        turn_light(viewer, &linear->forward);
}

void viewer_turn(struct viewer *viewer, struct vec3 axis, double degrees) {
    struct transform map = transform_rotate_about(axis, degrees);
    change_form(viewer, TOOL_TURN, &map);
}

void viewer_scale(struct viewer *viewer, struct vec3 factors) {
    struct transform map = transform_scale(factors);
    change_form(viewer, TOOL_SIZE, &map);
}

/* Along or about one axis: by how far the mouse goes along the axis on the screen, or about the middle. */
static void drag_on_axis(struct viewer *viewer, const struct camera_frame *frame, const double from[2],
                         const double to[2]) {
    int axis = viewer->edit.axis - 1;
    struct vec3 at = viewer_selection_position(viewer), factors = {1, 1, 1};
    double step = 50 * pixel_size(viewer, frame, at), x, y, u, v;
    if (!viewer_project(viewer, frame, at, &x, &y) ||
        !viewer_project(viewer, frame, vec3_add_scaled(at, axes[axis], step), &u, &v))
        return;
    double length = (u - x) * (u - x) + (v - y) * (v - y);
    double along = length > 1 ? ((to[0] - from[0]) * (u - x) + (to[1] - from[1]) * (v - y)) / length : 0;
    double turned = el_atan2(to[1] - y, to[0] - x) - el_atan2(from[1] - y, from[0] - x);
    switch (viewer->edit.tool) {
    case TOOL_MOVE:
        viewer_move(viewer, vec3_scale(axes[axis], along * step));
        return;
    case TOOL_SIZE:
        *(axis == 0 ? &factors.x : axis == 1 ? &factors.y : &factors.z) = el_exp(along);
        viewer_scale(viewer, factors);
        return;
    case TOOL_TURN:
        turned -= 2 * PI * floor(turned / (2 * PI) + 0.5);
        viewer_turn(viewer, axes[axis],
                    (vec3_dot(axes[axis], vec3_sub(frame->eye, at)) > 0 ? -180 : 180) / PI * turned);
        return;
    case TOOL_NONE:
        return;
    }
}

void viewer_drag_selection(struct viewer *viewer, double dx, double dy) {
    struct camera_frame frame;
    const double to[2] = {viewer->input.x, viewer->input.y}, from[2] = {to[0] - dx, to[1] - dy};
    if (viewer->edit.selection.kind == SELECTED_NOTHING || !viewer_camera_frame(viewer, &frame))
        return;
    double pixel = pixel_size(viewer, &frame, viewer_selection_position(viewer));
    if (viewer->edit.axis > 0) {
        drag_on_axis(viewer, &frame, from, to);
    } else if (viewer->edit.tool == TOOL_MOVE) {
        struct vec3 by = vec3_scale(frame.unit_right, dx * pixel);
        viewer_move(viewer, vec3_add_scaled(by, frame.unit_down, dy * pixel));
    } else if (viewer->edit.tool == TOOL_SIZE) {
        viewer_scale(viewer, vec3_all(el_exp(-2 * dy / viewer->window.layout.shown_height)));
    } else if (dx * dx + dy * dy > 0) {
        /* Like a ball under the mouse: about the axis in the film plane perpendicular to the motion. */
        struct vec3 axis = vec3_add_scaled(vec3_scale(frame.unit_right, -dy), frame.unit_down, dx);
        viewer_turn(viewer, axis, -180 * vec3_length(axis) / viewer->window.layout.shown_height);
    }
}

void viewer_push_selection(struct viewer *viewer, double steps) {
    struct vec3 to = vec3_sub(viewer_selection_position(viewer), viewer->pass.view.camera.eye);
    viewer_move(viewer, vec3_scale(to, 0.05 * steps));
}

/* Handles: an arrow along each axis moves, a quarter of a circle about it turns, a short line beyond the arrow scales.
 */

static struct vec3 handle_point(enum edit_tool tool, int axis, double t) {
    struct vec3 b = axes[(axis + 1) % 3], c = axes[(axis + 2) % 3];
    double sine, cosine;
    el_sincos(t * PI / 2, &sine, &cosine);
    if (tool == TOOL_TURN)
        return vec3_scale(vec3_add_scaled(vec3_scale(b, cosine), c, sine), 0.6);
    return vec3_scale(axes[axis], tool == TOOL_MOVE ? 0.2 + 0.8 * t : 1.1 + 0.12 * t);
}

bool viewer_handle(const struct viewer *viewer, const struct camera_frame *frame, enum edit_tool tool, int axis,
                   double points[HANDLE_POINTS][2]) {
    struct vec3 at = viewer_selection_position(viewer), toward = vec3_normalize(vec3_sub(frame->eye, at));
    double length = handle_length * viewer->window.layout.density * pixel_size(viewer, frame, at);
    double facing = fabs(vec3_dot(axes[axis], toward));
    /* Not in the direction of the eye, and no circle from its edge. */
    bool seen = viewer_can(viewer, tool) && (tool == TOOL_TURN ? facing > 0.2 : facing < 0.97);
    for (int i = 0; i < HANDLE_POINTS && seen; i++) {
        struct vec3 point = handle_point(tool, axis, (double)i / (HANDLE_POINTS - 1));
        seen = viewer_project(viewer, frame, vec3_add_scaled(at, point, length), &points[i][0], &points[i][1]);
    }
    return seen;
}

/* The distance of a point from a line on the screen. */
static double distance_from(const double p[2], const double a[2], const double b[2]) {
    double x = b[0] - a[0], y = b[1] - a[1], length = x * x + y * y;
    double t = length > 0 ? math_min(math_max(((p[0] - a[0]) * x + (p[1] - a[1]) * y) / length, 0), 1) : 0;
    double u = p[0] - a[0] - t * x, v = p[1] - a[1] - t * y;
    return sqrt(u * u + v * v);
}

bool viewer_take_handle(struct viewer *viewer, double x, double y) {
    struct camera_frame frame;
    const double p[2] = {x, y};
    double best = near_mark * viewer->window.layout.density, points[HANDLE_POINTS][2];
    bool found = false;
    if (viewer->window.hides_lines || !viewer_camera_frame(viewer, &frame))
        return false;
    for (enum edit_tool tool = TOOL_MOVE; tool <= TOOL_SIZE; tool++) {
        for (int axis = 0; axis < 3; axis++) {
            bool seen = viewer_handle(viewer, &frame, tool, axis, points);
            for (int i = 1; i < HANDLE_POINTS && seen; i++) {
                double apart = distance_from(p, points[i - 1], points[i]);
                if (apart >= best)
                    continue;
                best = apart;
                found = true;
                viewer->edit.tool = tool;
                viewer->edit.axis = axis + 1;
            }
        }
    }
    viewer->edit.handle = found;
    return found;
}

/* Selecting. */

void viewer_select_light(struct viewer *viewer, uint32_t number) {
    viewer->edit.selection = (struct selection){.kind = SELECTED_LIGHT, .light = number};
    viewer->edit.joins = false;
    viewer->display.hud_dirty = true;
}

void viewer_next_light(struct viewer *viewer, bool back) {
    uint32_t count = viewer->lights.known, at = viewer->edit.selection.light;
    if (count == 0)
        return;
    if (viewer->edit.selection.kind != SELECTED_LIGHT || at > count)
        at = back ? 1 : count;
    viewer_select_light(viewer, back ? (at + count - 2) % count + 1 : at % count + 1);
}

void viewer_select_node(struct viewer *viewer, const struct node_query *node) {
    viewer->edit.click = (struct selection){0};
    viewer->edit.node = *node;
    viewer->edit.by_node = viewer->edit.click_waits = viewer->block != NULL;
    viewer->edit.probes = false;
}

void viewer_click(struct viewer *viewer, double x, double y, bool operand) {
    uint32_t light = viewer->window.hides_lines || operand ? 0 : light_at(viewer, x, y);
    viewer->edit.joins = false;
    viewer->display.hud_dirty = true;
    if (light > 0) {
        viewer_select_light(viewer, light);
        return;
    }
    viewer->edit.click = (struct selection){.up = operand ? -OPERANDS_BELOW : 0};
    viewer->edit.probes = viewer->edit.by_node = false;
    viewer->edit.click_waits = pixel_at(viewer, x, y, &viewer->edit.click.x, &viewer->edit.click.y);
    /* The middle of the pixel: where its first ray goes. */
    viewer->edit.click.x += 0.5;
    viewer->edit.click.y += 0.5;
}

/* Not while another one, or a click, waits. */
void viewer_probe(struct viewer *viewer, double x, double y) {
    double u, v;
    if (viewer->edit.click_waits || !pixel_at(viewer, x, y, &u, &v))
        return;
    viewer->edit.click = (struct selection){.x = u + 0.5, .y = v + 0.5};
    viewer->edit.by_node = false;
    viewer->edit.click_waits = viewer->edit.probes = true;
}

void viewer_show_factors(struct viewer *viewer) {
    struct view_mode mode = {true, HEADLIGHT_FACTORS, {.camera = viewer->request.camera, .own = !viewer->camera_moved}};
    if (viewer->camera_moved)
        mode.patch.camera = fly_camera_current(&viewer->fly_camera);
    if (viewer->request.settings.integrator != INTEGRATOR_RADIOSITY)
        viewer_show_notice(viewer, "form factors and patches are those of integrator radiosity", true);
    else if (pixel_at(viewer, viewer->input.x, viewer->input.y, &mode.patch.x, &mode.patch.y))
        viewer_choose_mode(viewer, mode);
}

void viewer_request_pixel_trace(struct viewer *viewer, double x, double y) {
    viewer->trace.requested = pixel_at(viewer, x, y, &viewer->trace.x, &viewer->trace.y);
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
    fly_camera_frame(&viewer->fly_camera, &box, (double)viewer->request.full_width / viewer->request.full_height);
}

void viewer_select_up(struct viewer *viewer, bool down) {
    const struct selection *selection = &viewer->edit.selection;
    if (selection->kind != SELECTED_NODE || (down ? selection->picked.below == 0 : selection->picked.levels == 0))
        return;
    if (selection->node.depth > 0) { /* it may not be visible anywhere */
        struct node_query above = selection->node;
        above.depth--;
        if (!down && above.depth > 0)
            viewer_select_node(viewer, &above);
        return;
    }
    viewer->edit.click = *selection;
    viewer->edit.click.up += down ? -1 : 1;
    viewer->edit.click_waits = true;
    viewer->edit.probes = viewer->edit.by_node = false;
}

static void give_texture(struct viewer *viewer);

void viewer_receive_picked(struct viewer *viewer, const struct picked *picked) {
    struct selection *selection = &viewer->edit.selection;
    if (picked->hit && picked->path.path[0] == SECTION_NODES)
        viewer->fly_camera.centre = picked->position;
    if (viewer->command.probes) {
        fly_camera_near(&viewer->fly_camera, picked->hit ? picked->distance : HUGE_VAL);
        return;
    }
    bool material = picked->path.depth > 0 && picked->path.path[0] == SECTION_MATERIALS;
    *selection = (struct selection){.kind = !picked->hit ? SELECTED_NOTHING
                                            : material   ? SELECTED_MATERIAL
                                                         : SELECTED_NODE,
                                    .picked = *picked,
                                    .applied = transform_identity(),
                                    .x = viewer->command.x,
                                    .y = viewer->command.y,
                                    .node = viewer->command.by_node ? viewer->command.node : (struct node_query){0},
                                    .up = picked->up < -OPERANDS_BELOW  ? -OPERANDS_BELOW
                                          : picked->up > OPERANDS_BELOW ? OPERANDS_BELOW
                                                                        : picked->up};
    viewer->edit.joins = false;
    struct change change = viewer_change(viewer, CHANGE_TRANSFORM, 0);
    (void)map_of(&change, &selection->applied);
    if (viewer->edit.texture[0] != '\0')
        give_texture(viewer);
}

/* Adding and taking away. */

void viewer_delete_selection(struct viewer *viewer) {
    bool light = viewer->edit.selection.kind == SELECTED_LIGHT;
    if (viewer->edit.selection.kind != SELECTED_NODE && !light)
        return;
    struct change change = viewer_change(viewer, light ? CHANGE_DARK : CHANGE_GONE, 0);
    make_step(viewer, &change, true);
    viewer->edit.selection.kind = SELECTED_NOTHING;
}

void viewer_hide(struct viewer *viewer, uint32_t serial, const char *name) {
    struct change change = {.kind = CHANGE_GONE, .serial = serial};
    (void)snprintf(change.name, sizeof change.name, "%s", name);
    if (!change_list_find(&viewer->edit.steps.now, &change)) /* else it comes back */
        change.kind = CHANGE_HIDDEN;
    bool shown = change_list_find(&viewer->edit.steps.now, &change) == NULL;
    make_step(viewer, &change, shown);
}

void viewer_solo(struct viewer *viewer) {
    struct change change = viewer_change(viewer, CHANGE_SOLO, 0);
    bool shown = change_list_find(&viewer->edit.steps.now, &change) == NULL;
    if (!shown || viewer->edit.selection.kind == SELECTED_NODE)
        make_step(viewer, &change, shown);
}

/* The position of new nodes: the last clicked point, or in front of the camera. */
static struct vec3 new_position(const struct viewer *viewer) {
    if (viewer->edit.selection.kind == SELECTED_NODE)
        return viewer_moved_point(viewer, viewer->edit.selection.picked.position);
    struct vec3 eye = viewer->pass.view.camera.eye, forward = vec3_normalize(viewer->pass.view.camera.view);
    return vec3_add_scaled(eye, forward, vec3_length(vec3_sub(viewer->fly_camera.centre, eye)));
}

/* Adds the node at a pose, which is a map of the world, and selects it when the render process has it. */
static void add_node(struct viewer *viewer, struct change change, const struct affine *world_from_parent,
                     const struct transform *map) {
    struct change pose = {.kind = CHANGE_TRANSFORM};
    struct transform by = transform_identity();
    change.kind = CHANGE_ADD;
    change.number = viewer->scene.added + count_of(viewer, CHANGE_ADD);
    pose.serial = UINT32_MAX - change.number;
    (void)map_to_parent(world_from_parent, map, &by);
    memcpy(pose.numbers, by.forward.m, sizeof by.forward.m);
    make_step(viewer, &change, true);
    make_step(viewer, &pose, true);
    viewer->edit.selection.kind = SELECTED_NOTHING;
    viewer_select_node(viewer, &(struct node_query){.serial = pose.serial});
}

static void copy_node(struct viewer *viewer) {
    const struct picked *picked = &viewer->edit.selection.picked;
    struct change change = {.serial = picked->parent_serial, .source = picked->serial};
    struct camera_frame frame;
    if (picked->levels == 0 || !viewer_camera_frame(viewer, &frame))
        return;
    (void)snprintf(change.name, sizeof change.name, "%s", picked->parent_name);
    /* Beside the other one, by its own width. */
    double width = picked->has_box ? vec3_length(vec3_sub(picked->corners[7], picked->corners[0])) / 2 : 1;
    struct transform map = transform_translate(vec3_scale(frame.unit_right, width));
    const struct affine space = picked->world_from_parent;
    add_node(viewer, change, &space, &map);
    viewer->edit.tool = TOOL_MOVE;
}

/* An object of size 1 at the origin of the root's space comes to the new position, a tenth as large as it is far. */
static void add_object(struct viewer *viewer, const char *call, double size) {
    struct change change = {.serial = viewer->scene.root, .numbers = {0.7, 0.7, 0.7}};
    const struct affine *space = &viewer->scene.world_from_root;
    struct vec3 at = new_position(viewer), origin = affine_point(space, vec3_make(0, 0, 0));
    struct transform there = transform_translate(vec3_negate(origin)), back = transform_translate(at);
    struct transform scale = transform_scale(vec3_all(size)), half = transform_compose(&scale, &there);
    struct transform map = transform_compose(&back, &half);
    (void)snprintf(change.name, sizeof change.name, "%s", viewer->scene.root_name);
    (void)snprintf(change.call, sizeof change.call, "%s", call);
    add_node(viewer, change, space, &map);
}

/* A light of a call, or a copy with the changes of the other; the window selects it. */
static void add_light(struct viewer *viewer, const char *call, uint32_t source, struct vec3 by) {
    struct change change = {.kind = CHANGE_ADD_LIGHT,
                            .number = count_of(viewer, CHANGE_ADD_LIGHT),
                            .source = source,
                            .numbers = {by.x, by.y, by.z, 1, 1, 1}};
    struct change held = viewer_change(viewer, CHANGE_LIGHT, 0);
    bool changed = source > 0 && change_list_find(&viewer->edit.steps.now, &held) != NULL;
    if (viewer->lights.count >= LIGHT_LIMIT || viewer->lights.count != viewer->lights.known) {
        viewer_show_message(viewer, "gray: the window shows at most 4,096 lights");
        return;
    }
    (void)snprintf(change.call, sizeof change.call, "%s", call);
    make_step(viewer, &change, true);
    held.serial = viewer->lights.count + 1;
    if (changed)
        make_step(viewer, &held, true);
    viewer_select_light(viewer, viewer->lights.count + 1);
}

/* The lengths of a light of size 1; what has an axis shines that way. */
static void fit_call(char *call, double size, struct vec3 toward) {
    static const char *const lengths[] = {"radius", "corner", "v1", "v2", "normal", "direction"};
    char text[CHANGE_CALL], out[CHANGE_CALL];
    double n[3];
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        bool axis = i >= 4;
        if (!call_field(call, lengths[i], text, sizeof text) || !call_numbers(text, n))
            continue;
        struct vec3 v = axis ? toward : vec3_scale(vec3_make(n[0], n[1], n[2]), size);
        (void)snprintf(text, sizeof text, i == 0 ? "%.4g" : "{%.4g, %.4g, %.4g}", v.x, v.y, v.z);
        if (call_set_field(call, lengths[i], text, out, sizeof out))
            (void)snprintf(call, CHANGE_CALL, "%s", out);
    }
}

void viewer_add(struct viewer *viewer, const char *call) {
    const struct script_function *function = call_function(call);
    struct vec3 at = new_position(viewer), toward = vec3_sub(viewer->pass.view.camera.eye, at);
    double size = 0.1 * vec3_length(toward);
    char sized[CHANGE_CALL];
    size = size > 0 ? size : 1;
    (void)snprintf(sized, sizeof sized, "%s", call);
    if (!function || function->result != RESULT_LIGHT) {
        add_object(viewer, call, size);
        return;
    }
    /* Before what was clicked, and above it. */
    struct vec3 by = vec3_add(vec3_scale(toward, 0.5), vec3_make(0, 4 * size, 0));
    fit_call(sized, size, vec3_negate(vec3_normalize(by)));
    add_light(viewer, sized, 0, vec3_add(at, by));
}

bool viewer_added(const struct viewer *viewer, struct change *out) {
    const struct selection *selection = &viewer->edit.selection;
    bool light = selection->kind == SELECTED_LIGHT;
    struct change like = {.kind = light ? CHANGE_ADD_LIGHT : CHANGE_ADD};
    uint32_t before = viewer->lights.count - count_of(viewer, CHANGE_ADD_LIGHT);
    if (light ? selection->light <= before : added_number(selection->picked.serial) == 0)
        return false;
    like.number = light ? selection->light - before - 1 : added_number(selection->picked.serial) - 1;
    const struct change *found = change_list_find(&viewer->edit.steps.now, &like);
    if (found)
        *out = *found;
    return found && found->call[0] != '\0';
}

void viewer_set_call(struct viewer *viewer, const char *call) {
    struct change change;
    if (!viewer_added(viewer, &change) || strlen(call) >= sizeof change.call)
        return;
    (void)snprintf(change.call, sizeof change.call, "%s", call);
    make(viewer, &change, true);
    if (change.kind == CHANGE_ADD) /* another size and material */
        viewer_select_node(viewer, &(struct node_query){.serial = viewer->edit.selection.picked.serial});
}

void viewer_copy_selection(struct viewer *viewer) {
    const struct light_info *light = selected_light(viewer);
    struct camera_frame frame;
    if (viewer->edit.selection.kind == SELECTED_NODE)
        copy_node(viewer);
    if (!light || !viewer_camera_frame(viewer, &frame))
        return;
    double aside = light->moves ? 0.1 * vec3_length(vec3_sub(light->position, frame.eye)) : 0;
    add_light(viewer, "", viewer->edit.selection.light, vec3_scale(frame.unit_right, aside));
}

/* The copy is made of the script's material; the changes of that are applied to the copy, too. */
void viewer_make_own_material(struct viewer *viewer) {
    struct picked *picked = &viewer->edit.selection.picked;
    struct change held[MATERIAL_PART_PARTS];
    int count = 0;
    if (viewer->edit.selection.kind != SELECTED_NODE || !picked->can_own)
        return;
    for (int part = 0; part < MATERIAL_PART_PARTS; part++) {
        held[count] = viewer_change(viewer, CHANGE_MATERIAL, (enum material_part)part);
        count += change_list_find(&viewer->edit.steps.now, &held[count]) != NULL;
    }
    struct change change = viewer_change(viewer, CHANGE_OWN, 0);
    change.number = viewer->scene.owned + count_of(viewer, CHANGE_OWN);
    change.source = picked->material_serial;
    make_step(viewer, &change, true);
    picked->material_serial = OWN_SERIAL - change.number;
    picked->can_own = false;
    for (int i = 0; i < count; i++) {
        held[i].serial = picked->material_serial;
        make_step(viewer, &held[i], true);
    }
}

/* Of the waiting call, as the kd of the selection. */
static void give_texture(struct viewer *viewer) {
    const struct selection *selection = &viewer->edit.selection;
    if (selection->kind == SELECTED_NODE && selection->picked.material_serial == 0)
        viewer_make_own_material(viewer);
    struct change change = {.kind = CHANGE_TEXTURE, .serial = selection->picked.material_serial};
    (void)snprintf(change.call, sizeof change.call, "%s", viewer->edit.texture);
    viewer->edit.texture[0] = '\0';
    if ((selection->kind == SELECTED_NODE || selection->kind == SELECTED_MATERIAL) && change.serial != 0)
        make_step(viewer, &change, true);
    else
        viewer_show_notice(viewer, "a picture is for a surface: drop it on one, or select one before", true);
}

void viewer_drop_texture(struct viewer *viewer, const struct window_event *event) {
    (void)snprintf(viewer->edit.texture, sizeof viewer->edit.texture, "%.500s", event->text);
    if (event->down)
        viewer_click(viewer, event->x, event->y, false);
    if (!viewer->edit.click_waits)
        give_texture(viewer);
}

void viewer_set_exposure(struct viewer *viewer, double stops) {
    viewer->request.settings.tone.exposure = stops < -100 ? -100 : stops > 100 ? 100 : stops;
    viewer_redraw(viewer);
    viewer->display.hud_dirty = true;
}
