/* Lights in the window: the data that the render process has reported, their marks on the picture, and changing them.
 * Lights without a position (directional ones, skies) are marked in the direction of their light, at the border of the
 * picture if that is not in view. A change made here is used until the render process reports the same. */
#include "viewer/viewer_internal.h"

#include "base/mem.h"
#include "light/light_edit.h"
#include "math/elementary.h"

#include <math.h>
#include <string.h>

/* The largest distance of a click from a light, and the smallest distance of its mark from the border, in dots of the
 * desktop. */
enum { MARKER = 8, MARGIN = 12 };
enum { LIGHT_LIMIT = 4096 }; /* the window ignores further ones */

/* What is known. */

static bool make_room(struct viewer *viewer, uint32_t count) {
    if (count <= viewer->lights.room)
        return true;
    struct light_info *more = mem_resize_array(viewer->lights.items, count, sizeof *more);
    if (!more)
        return false;
    memset(more + viewer->lights.room, 0, (count - viewer->lights.room) * sizeof *more);
    viewer->lights.items = more;
    viewer->lights.room = count;
    return true;
}

void viewer_receive_lights(struct viewer *viewer, const struct preview_reply *reply) {
    uint32_t count = reply->light_count < LIGHT_LIMIT ? reply->light_count : LIGHT_LIMIT, first = reply->first_light;
    if (!make_room(viewer, count))
        count = viewer->lights.room;
    viewer->lights.count = count;
    uint32_t figures_at = first < count ? count - first : 0;
    figures_at = figures_at < LIGHTS_PER_MESSAGE ? figures_at : LIGHTS_PER_MESSAGE;
    if (figures_at > 0)
        memcpy(viewer->lights.items + first, reply->lights, figures_at * sizeof *reply->lights);
    if (first <= viewer->lights.known && first + figures_at > viewer->lights.known)
        viewer->lights.known = first + figures_at;
    viewer->lights.known = viewer->lights.known < count ? viewer->lights.known : count;
    viewer->display.hud_dirty = true;
}

const struct light_info *viewer_light(const struct viewer *viewer, uint32_t number) {
    return number >= 1 && number <= viewer->lights.known ? &viewer->lights.items[number - 1] : NULL;
}

static struct light_info *selected(struct viewer *viewer) {
    uint32_t number = viewer->edit.selection.light;
    bool known = viewer->edit.selection.kind == SELECTED_LIGHT && number >= 1 && number <= viewer->lights.known;
    return known ? &viewer->lights.items[number - 1] : NULL;
}

static double largest(struct colour v) {
    return fmax(v.r, fmax(v.g, v.b));
}

/* Markers. */

/* The part of the picture within the margin. */
static bool free_part(const struct viewer *viewer, double *left, double *top, double *right, double *bottom) {
    const struct window_layout *layout = &viewer->window.layout;
    double margin = MARGIN * layout->density;
    *left = fmax(layout->left, 0) + margin;
    *top = fmax(layout->top, 0) + margin;
    *right = fmin(layout->left + layout->shown_width, layout->width) - margin;
    *bottom = fmin(layout->top + layout->shown_height, layout->height) - margin;
    return *left < *right && *top < *bottom;
}

/* The position of that point, or the point at the border in its direction. */
static bool marker_point(const struct viewer *viewer, const struct camera_frame *frame, struct vec3 point, double *x,
                         double *y, bool *seen) {
    double left, top, right, bottom;
    if (!free_part(viewer, &left, &top, &right, &bottom))
        return false;
    *seen = viewer_project(viewer, frame, point, x, y) && *x >= left && *x <= right && *y >= top && *y <= bottom;
    if (*seen)
        return true;
    struct vec3 toward = vec3_sub(point, frame->eye);
    double dx = vec3_dot(toward, frame->unit_right), dy = vec3_dot(toward, frame->unit_down);
    double wide = (right - left) / 2, high = (bottom - top) / 2, size = fmax(fabs(dx), fabs(dy));
    dx = size > 0 ? dx / size : 0;
    dy = size > 0 ? dy / size : 1;
    double extent = fmin(wide / fmax(fabs(dx), 1e-9), high / fmax(fabs(dy), 1e-9));
    *x = left + wide + extent * dx;
    *y = top + high + extent * dy;
    return isfinite(*x) && isfinite(*y);
}

bool viewer_light_marker(const struct viewer *viewer, const struct camera_frame *frame, uint32_t number, double *x,
                         double *y, bool *seen) {
    const struct light_info *light = viewer_light(viewer, number);
    if (!light || !(largest(light->colour) > 0)) /* a removed light is black */
        return false;
    if (light->has_position)
        return marker_point(viewer, frame, light->position, x, y, seen);
    struct vec3 from = light->properties & LIGHT_HAS_DIRECTION ? vec3_negate(light->direction) : vec3_make(0, 1, 0);
    double far = 1e6 * (1 + vec3_max_abs(frame->eye));
    return marker_point(viewer, frame, vec3_add_scaled(frame->eye, from, far), x, y, seen);
}

bool viewer_near_light(const struct viewer *viewer, double x, double y, uint32_t *number) {
    struct camera_frame frame;
    double best = MARKER * viewer->window.layout.density, u, v;
    bool found = false, seen;
    if (!viewer_camera_frame(viewer, &frame))
        return false;
    for (uint32_t i = 1; i <= viewer->lights.known; i++) {
        if (!viewer_light_marker(viewer, &frame, i, &u, &v, &seen))
            continue;
        double apart = sqrt((u - x) * (u - x) + (v - y) * (v - y));
        if (apart < best) {
            best = apart;
            *number = i;
            found = true;
        }
    }
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

/* Changing. */

static struct change light_change(const struct viewer *viewer, enum change_kind kind) {
    struct change change = {.kind = kind, .serial = viewer->edit.selection.light, .numbers = {0, 0, 0, 1, 1, 1}};
    const struct change *now = change_list_find(&viewer->edit.steps.now, &change);
    return now ? *now : change;
}

static void put(double *numbers, struct vec3 v) {
    numbers[0] = v.x;
    numbers[1] = v.y;
    numbers[2] = v.z;
}

static void put_colour(double *numbers, struct colour c) {
    numbers[0] = c.r;
    numbers[1] = c.g;
    numbers[2] = c.b;
}

static struct vec3 three(const double *numbers) {
    return vec3_make(numbers[0], numbers[1], numbers[2]);
}

static struct colour colour_of(const double *numbers) {
    return colour_make(numbers[0], numbers[1], numbers[2]);
}

static void make(struct viewer *viewer, const struct change *change) {
    viewer_make_edit(viewer, change, true, viewer->edit.joins);
    viewer->edit.joins = true;
}

void viewer_light_move(struct viewer *viewer, struct vec3 route) {
    struct light_info *light = selected(viewer);
    struct change change = light_change(viewer, CHANGE_LIGHT);
    if (!light || !light->moves)
        return;
    put(change.numbers, vec3_add(three(change.numbers), route));
    make(viewer, &change);
    light->position = vec3_add(light->position, route);
}

void viewer_light_turn(struct viewer *viewer, const struct transform *map, bool sizes) {
    struct light_info *light = selected(viewer);
    struct change change = light_change(viewer, CHANGE_LIGHT);
    struct affine before = affine_identity();
    if (!light || !(sizes ? light->sizes : light->turns))
        return;
    struct affine turn = map->forward;
    if (light->properties & LIGHT_IS_ENVIRONMENT) { /* it is rotated about the y axis only */
        double linear[TURN_NUMBERS], sine, cosine;
        for (int i = 0; i < TURN_NUMBERS; i++)
            linear[i] = turn.m[i / 3][i % 3];
        if (!turn_about_y(linear, &sine, &cosine))
            return;
        turn = (struct affine){{{cosine, 0, sine, 0}, {0, 1, 0, 0}, {-sine, 0, cosine, 0}}};
    }
    for (int i = 0; change.turns && i < TURN_NUMBERS; i++)
        before.m[i / 3][i % 3] = change.numbers[TURN_AT + i];
    struct affine after = affine_compose(&turn, &before);
    struct transform checked;
    if (!transform_from_affine(&after, &checked)) /* scaled so small that it has no inverse */
        return;
    change.turns = true;
    for (int i = 0; i < TURN_NUMBERS; i++)
        change.numbers[TURN_AT + i] = after.m[i / 3][i % 3];
    make(viewer, &change);
    light->edge1 = affine_vector(&turn, light->edge1);
    light->edge2 = affine_vector(&turn, light->edge2);
    light->radius *= el_cbrt(fabs(affine_determinant(&turn)));
    if (vec3_max_abs(light->direction) > 0)
        light->direction = vec3_normalize(affine_vector(&turn, light->direction));
}

double viewer_light_stops_now(const struct viewer *viewer) {
    struct change change = light_change(viewer, CHANGE_LIGHT);
    return el_log2(change.numbers[3]);
}

void viewer_brighten_light(struct viewer *viewer, double stops) {
    struct light_info *light = selected(viewer);
    struct change change = light_change(viewer, CHANGE_LIGHT);
    double before = change.numbers[3], after = el_exp2(stops);
    put_colour(change.numbers + 3, colour_all(after));
    make(viewer, &change);
    if (light && before > 0)
        light->colour = colour_scale(light->colour, after / before);
}

struct colour viewer_light_colour_now(const struct viewer *viewer) {
    const struct light_info *light = viewer_light(viewer, viewer->edit.selection.light);
    struct change change = light_change(viewer, CHANGE_LIGHT);
    if (change.colours)
        return colour_of(change.numbers + COLOUR_AT);
    return light && change.numbers[3] > 0 ? colour_scale(light->colour, 1 / change.numbers[3]) : colour_all(0);
}

void viewer_light_colour(struct viewer *viewer, struct colour colour) {
    struct light_info *light = selected(viewer);
    struct change change = light_change(viewer, CHANGE_LIGHT);
    change.colours = true;
    put_colour(change.numbers + COLOUR_AT, colour);
    make(viewer, &change);
    if (light)
        light->colour = colour_mul(colour, colour_of(change.numbers + 3));
}

void viewer_light_delete(struct viewer *viewer) {
    struct change change = {.kind = CHANGE_DARK, .serial = viewer->edit.selection.light};
    viewer_make_edit(viewer, &change, true, false);
}

/* Whether another light can be added. */
static bool room_for_one(struct viewer *viewer) {
    if (viewer->lights.count >= LIGHT_LIMIT)
        viewer_show_message(viewer, "gray: the window shows at most 4,096 lights");
    return viewer->lights.count < LIGHT_LIMIT && viewer->lights.count == viewer->lights.known;
}

/* Adds a light; its values are used until the render process reports them. */
static struct change new_light(struct viewer *viewer) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < viewer->edit.steps.now.count; i++)
        count += viewer->edit.steps.now.items[i].kind == CHANGE_ADD_LIGHT;
    return (struct change){.kind = CHANGE_ADD_LIGHT, .number = count};
}

static void select_new(struct viewer *viewer, const struct light_info *light) {
    if (make_room(viewer, viewer->lights.count + 1)) {
        viewer->lights.items[viewer->lights.count] = *light;
        viewer->lights.known += viewer->lights.known == viewer->lights.count;
        viewer->lights.count++;
    }
    viewer_select_light(viewer, viewer->lights.count);
    viewer->edit.tool = light->moves ? TOOL_MOVE : light->turns ? TOOL_TURN : TOOL_NONE;
}

void viewer_add_light(struct viewer *viewer) {
    struct change change = new_light(viewer);
    struct vec3 layout = viewer_new_position(viewer), eye = viewer->pass.view.camera.eye;
    if (!room_for_one(viewer))
        return;
    put(change.numbers, vec3_add_scaled(layout, vec3_sub(eye, layout), 0.5));
    put_colour(change.numbers + 3, colour_all(0.5));
    viewer_make_edit(viewer, &change, true, false);
    select_new(viewer, &(struct light_info){.properties = LIGHT_HAS_POSITION,
                                            .has_position = true,
                                            .position = three(change.numbers),
                                            .colour = colour_all(0.5),
                                            .moves = true});
}

/* Edits of the light apply to its copy, too, which is displaced slightly to the right. */
void viewer_copy_light(struct viewer *viewer) {
    const struct light_info *light = selected(viewer);
    struct change change = new_light(viewer), held = light_change(viewer, CHANGE_LIGHT);
    bool has = change_list_find(&viewer->edit.steps.now, &held) != NULL;
    struct camera_frame frame;
    if (!light || !room_for_one(viewer) || !viewer_camera_frame(viewer, &frame))
        return;
    struct light_info copy = *light;
    struct vec3 route = vec3_scale(frame.unit_right, 0.1 * vec3_length(vec3_sub(light->position, frame.eye)));
    if (!light->moves)
        route = vec3_all(0);
    change.source = viewer->edit.selection.light;
    put(change.numbers, route);
    put_colour(change.numbers + 3, colour_all(1));
    viewer_make_edit(viewer, &change, true, false);
    held.serial = viewer->lights.count + 1;
    if (has)
        viewer_make_edit(viewer, &held, true, false);
    copy.position = vec3_add(copy.position, route);
    select_new(viewer, &copy);
}
