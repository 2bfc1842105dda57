/* Lights in the window: what the child has told of them, where they are marked on the picture, and changing them.
 * Lights without a place (from afar, skies) are marked in the direction that they come from, at the border of the
 * picture where that is not to be seen. What is changed here is believed until the child tells the same. */
#include "base/mem.h"
#include "math/elementary.h"
#include "viewer/viewer_internal.h"

#include <math.h>
#include <string.h>

/* How near a click must be to a light, and how far its mark is kept from the border: dots of letters. */
enum { MARKER = 8, MARGIN = 12 };
enum { LIGHT_LIMIT = 4096 }; /* further ones are not known in the window */

/* What is known. */

static bool make_room(struct live *live, uint32_t count) {
    if (count <= live->light_room)
        return true;
    struct told_light *more = mem_resize_array(live->lights, count, sizeof *more);
    if (!more)
        return false;
    memset(more + live->light_room, 0, (count - live->light_room) * sizeof *more);
    live->lights = more;
    live->light_room = count;
    return true;
}

void live_take_lights(struct live *live, const struct studio_news *news) {
    uint32_t count = news->light_count < LIGHT_LIMIT ? news->light_count : LIGHT_LIMIT, first = news->first_light;
    if (!make_room(live, count))
        count = live->light_room;
    live->light_count = count;
    uint32_t told = first < count ? count - first : 0;
    told = told < TOLD_LIGHTS ? told : TOLD_LIGHTS;
    if (told > 0)
        memcpy(live->lights + first, news->lights, told * sizeof *news->lights);
    if (first <= live->lights_known && first + told > live->lights_known)
        live->lights_known = first + told;
    live->lights_known = live->lights_known < count ? live->lights_known : count;
    live->over_dirty = true;
}

const struct told_light *live_light(const struct live *live, uint32_t number) {
    return number >= 1 && number <= live->lights_known ? &live->lights[number - 1] : NULL;
}

static struct told_light *selected(struct live *live) {
    uint32_t number = live->selection.light;
    bool known = live->selection.kind == SELECTED_LIGHT && number >= 1 && number <= live->lights_known;
    return known ? &live->lights[number - 1] : NULL;
}

static double largest(struct vec3 v) {
    return fmax(v.x, fmax(v.y, v.z));
}

/* Marks. */

/* What is left of the picture beside the menu and the margin. */
static bool free_part(const struct live *live, double *left, double *top, double *right, double *bottom) {
    const struct live_place *place = &live->place;
    int scale = live->panel.paper.scale;
    double margin = MARGIN * scale, menu = (live->panel.paper.height >= 24 * panel_line_height(&live->panel) ? 30 : 15);
    *left = fmax(place->left, 0) + margin;
    *top = fmax(place->top, menu * scale) + margin;
    *right = fmin(place->left + place->shown_width, place->width) - margin;
    *bottom = fmin(place->top + place->shown_height, place->height) - margin;
    return *left < *right && *top < *bottom;
}

/* Where that point is, or at the border on the way there. */
static bool mark_point(const struct live *live, const struct camera_frame *frame, struct vec3 point, double *x,
                       double *y, bool *seen) {
    double left, top, right, bottom;
    if (!free_part(live, &left, &top, &right, &bottom))
        return false;
    *seen = live_project(live, frame, point, x, y) && *x >= left && *x <= right && *y >= top && *y <= bottom;
    if (*seen)
        return true;
    struct vec3 toward = vec3_sub(point, frame->eye);
    double dx = vec3_dot(toward, frame->unit_right), dy = vec3_dot(toward, frame->unit_down);
    double wide = (right - left) / 2, high = (bottom - top) / 2, size = fmax(fabs(dx), fabs(dy));
    dx = size > 0 ? dx / size : 0;
    dy = size > 0 ? dy / size : 1;
    double reach = fmin(wide / fmax(fabs(dx), 1e-9), high / fmax(fabs(dy), 1e-9));
    *x = left + wide + reach * dx;
    *y = top + high + reach * dy;
    return isfinite(*x) && isfinite(*y);
}

bool live_light_mark(const struct live *live, const struct camera_frame *frame, uint32_t number, double *x, double *y,
                     bool *seen) {
    const struct told_light *light = live_light(live, number);
    if (!light || !(largest(light->colour) > 0)) /* one that was taken away is black */
        return false;
    if (light->placed)
        return mark_point(live, frame, light->position, x, y, seen);
    struct vec3 from = light->properties & LIGHT_HAS_DIRECTION ? vec3_negate(light->direction) : vec3_make(0, 1, 0);
    double far = 1e6 * (1 + vec3_max_abs(frame->eye));
    return mark_point(live, frame, vec3_add_scaled(frame->eye, from, far), x, y, seen);
}

bool live_near_light(const struct live *live, double x, double y, uint32_t *number) {
    struct camera_frame frame;
    double best = MARKER * live->panel.paper.scale, u, v;
    bool found = false, seen;
    if (!live_frame(live, &frame))
        return false;
    for (uint32_t i = 1; i <= live->lights_known; i++) {
        if (!live_light_mark(live, &frame, i, &u, &v, &seen))
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

void live_select_light(struct live *live, uint32_t number) {
    live->selection = (struct selection){.kind = SELECTED_LIGHT, .light = number};
    live->joins = false;
    live->over_dirty = true;
    live->light_colour_max = fmax(1, largest(live_light_colour_now(live)));
}

void live_next_light(struct live *live, bool back) {
    uint32_t count = live->lights_known, at = live->selection.light;
    if (count == 0)
        return;
    if (live->selection.kind != SELECTED_LIGHT || at > count)
        at = back ? 1 : count;
    live_select_light(live, back ? (at + count - 2) % count + 1 : at % count + 1);
}

/* Changing. */

static struct change light_change(const struct live *live, enum change_kind kind) {
    struct change change = {.kind = kind, .serial = live->selection.light, .numbers = {0, 0, 0, 1, 1, 1}};
    const struct change *now = change_list_find(&live->edits.now, &change);
    return now ? *now : change;
}

static void put(double *numbers, struct vec3 v) {
    numbers[0] = v.x;
    numbers[1] = v.y;
    numbers[2] = v.z;
}

static struct vec3 three(const double *numbers) {
    return vec3_make(numbers[0], numbers[1], numbers[2]);
}

static void make(struct live *live, const struct change *change) {
    live_make(live, change, true, live->joins);
    live->joins = true;
}

void live_light_move(struct live *live, struct vec3 way) {
    struct told_light *light = selected(live);
    struct change change = light_change(live, CHANGE_LIGHT);
    if (!light || !light->moves)
        return;
    put(change.numbers, vec3_add(three(change.numbers), way));
    make(live, &change);
    light->position = vec3_add(light->position, way);
}

void live_light_turn(struct live *live, const struct transform *map, bool sizes) {
    struct told_light *light = selected(live);
    struct change change = light_change(live, CHANGE_LIGHT);
    struct affine before = affine_identity();
    if (!light || !(sizes ? light->sizes : light->turns))
        return;
    struct affine turn = map->forward;
    if (light->properties & LIGHT_IS_ENVIRONMENT) { /* it is turned about the y axis alone */
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
    if (!transform_from_affine(&after, &checked)) /* made so small that it has no inverse */
        return;
    change.turns = true;
    for (int i = 0; i < TURN_NUMBERS; i++)
        change.numbers[TURN_AT + i] = after.m[i / 3][i % 3];
    make(live, &change);
    light->edge1 = affine_vector(&turn, light->edge1);
    light->edge2 = affine_vector(&turn, light->edge2);
    light->radius *= el_cbrt(fabs(affine_determinant(&turn)));
    if (vec3_max_abs(light->direction) > 0)
        light->direction = vec3_normalize(affine_vector(&turn, light->direction));
}

double live_stops_now(const struct live *live) {
    struct change change = light_change(live, CHANGE_LIGHT);
    return el_log2(change.numbers[3]);
}

void live_brighten(struct live *live, double stops) {
    struct told_light *light = selected(live);
    struct change change = light_change(live, CHANGE_LIGHT);
    double before = change.numbers[3], after = el_exp2(stops);
    put(change.numbers + 3, vec3_all(after));
    make(live, &change);
    if (light && before > 0)
        light->colour = vec3_scale(light->colour, after / before);
}

struct vec3 live_light_colour_now(const struct live *live) {
    const struct told_light *light = live_light(live, live->selection.light);
    struct change change = light_change(live, CHANGE_LIGHT);
    if (change.colours)
        return three(change.numbers + COLOUR_AT);
    return light && change.numbers[3] > 0 ? vec3_scale(light->colour, 1 / change.numbers[3]) : vec3_all(0);
}

void live_light_colour(struct live *live, struct vec3 colour) {
    struct told_light *light = selected(live);
    struct change change = light_change(live, CHANGE_LIGHT);
    change.colours = true;
    put(change.numbers + COLOUR_AT, colour);
    make(live, &change);
    if (light)
        light->colour = vec3_mul(colour, three(change.numbers + 3));
}

void live_light_delete(struct live *live) {
    struct change change = {.kind = CHANGE_DARK, .serial = live->selection.light};
    live_make(live, &change, true, false);
}

/* Whether there is a number for one more. */
static bool room_for_one(struct live *live) {
    if (live->light_count >= LIGHT_LIMIT)
        live_tell(live, "gray: the window knows no more lights than 4,096");
    return live->light_count < LIGHT_LIMIT && live->light_count == live->lights_known;
}

/* The next one that is added; what it is told to be holds until the child says the same. */
static struct change new_light(struct live *live) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < live->edits.now.count; i++)
        count += live->edits.now.items[i].kind == CHANGE_ADD_LIGHT;
    return (struct change){.kind = CHANGE_ADD_LIGHT, .number = count};
}

static void select_new(struct live *live, const struct told_light *light) {
    if (make_room(live, live->light_count + 1)) {
        live->lights[live->light_count] = *light;
        live->lights_known += live->lights_known == live->light_count;
        live->light_count++;
    }
    live_select_light(live, live->light_count);
    live->tool = light->moves ? TOOL_MOVE : light->turns ? TOOL_TURN : TOOL_NONE;
}

void live_add_light(struct live *live) {
    struct change change = new_light(live);
    struct vec3 place = live_new_place(live), eye = live->view.camera.eye;
    if (!room_for_one(live))
        return;
    put(change.numbers, vec3_add_scaled(place, vec3_sub(eye, place), 0.5));
    put(change.numbers + 3, vec3_all(0.5));
    live_make(live, &change, true, false);
    select_new(live, &(struct told_light){.properties = LIGHT_HAS_POSITION,
                                          .placed = true,
                                          .position = three(change.numbers),
                                          .colour = vec3_all(0.5),
                                          .moves = true});
}

/* What was changed of the light is changed of its copy, which stands a little to the right. */
void live_copy_light(struct live *live) {
    const struct told_light *light = selected(live);
    struct change change = new_light(live), held = light_change(live, CHANGE_LIGHT);
    bool has = change_list_find(&live->edits.now, &held) != NULL;
    struct camera_frame frame;
    if (!light || !room_for_one(live) || !live_frame(live, &frame))
        return;
    struct told_light copy = *light;
    struct vec3 way = vec3_scale(frame.unit_right, 0.1 * vec3_length(vec3_sub(light->position, frame.eye)));
    if (!light->moves)
        way = vec3_all(0);
    change.source = live->selection.light;
    put(change.numbers, way);
    put(change.numbers + 3, vec3_all(1));
    live_make(live, &change, true, false);
    held.serial = live->light_count + 1;
    if (has)
        live_make(live, &held, true, false);
    copy.position = vec3_add(copy.position, way);
    select_new(live, &copy);
}
