/* While something moves, pictures have fewer pixels if they would take too long; the last one has all. The window
 * enlarges them. */
#include "host/view_window.h"

#include "base/clock.h"
#include "base/mem.h"
#include "image/light_field_view.h"
#include "math/elementary.h"
#include "math/portable.h"
#include "output/view.h"
#include "session/text.h"

#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>

static const double picture_seconds = 1 / 35.0, click_pixels = 4, flight_seconds = 2; /* across the grid, half around */
enum { AT = 1, FOCUS, APERTURE, LONGITUDE, LATITUDE, FOV, DIVIDE_LIMIT = 8, WHEEL_STEPS = 16 }; /* numbers of fields */

struct view_window {
    struct view *view;
    const struct window_driver *driver;
    struct view_state initial, now;
    uint32_t width, height; /* of a picture with all pixels */
    uint32_t divide;        /* pixels of the picture in one that is drawn while something moves */
    uint8_t *bytes;
    bool outdated, coarse, closed;
    bool fine;             /* what is drawn ends when something happens */
    double shown, seconds; /* when the last picture was; between pictures of a movement */
    bool drags, has_moved;
    double pressed_x, pressed_y, stepped;
    bool held[FLY_KEYS];
    char name[1024]; /* of a picture to be saved; or empty */
    bool saves;
};

/* --- what is shown --- */

static const char *file_name_of(const struct options *options) {
    const char *slash = strrchr(options->scripts[0], '/');
    return slash ? slash + 1 : options->scripts[0];
}

static double half_grid(const struct view_window *w, bool across) {
    const struct light_field_head *head = &w->view->field.head;
    return ((across ? head->columns : head->rows) - 1) / 2.0 * head->spacing;
}

static double largest_aperture(const struct view_window *w) {
    return math_max(half_grid(w, true), half_grid(w, false));
}

/* The eye stays in the field, and the plane in focus in front of it. */
static void limit(struct view_window *w) {
    struct view_state *now = &w->now;
    if (w->view->is_field) {
        struct light_field_camera camera = view_camera(w->view, now);
        (void)light_field_clamp(&w->view->field.head, &camera);
        now->at = vec3_make(camera.x, camera.y, math_min(camera.z, 0.9 * w->view->field.head.screen));
        now->focus = math_max(now->focus, math_max(1e-3 * w->view->field.head.screen, 1e-3 - now->at.z));
        now->aperture = math_min(math_max(now->aperture, 0), largest_aperture(w));
    } else {
        now->at.y = math_min(math_max(now->at.y, -90), 90);
        now->at.x = remainder(now->at.x, 360);
        now->fov = math_min(math_max(now->fov, 5), 150);
    }
    w->outdated = true;
}

static struct window_field *add_field(struct window_form *form, uint32_t number, const char *name, const char *help) {
    struct window_field *field = &form->fields[form->count++];
    *field = (struct window_field){.kind = FIELD_NUMBER, .number = number, .low = -HUGE_VAL, .high = HUGE_VAL};
    (void)snprintf(field->group, sizeof field->group, "View");
    (void)snprintf(field->name, sizeof field->name, "%s", name);
    (void)snprintf(field->help, sizeof field->help, "%s", help);
    return field;
}

static struct window_field *add_number(struct window_form *form, uint32_t number, const char *name, const char *help,
                                       const double values[2]) {
    struct window_field *field = add_field(form, number, name, help);
    field->numbers[0] = values[0];
    field->initial = values[1];
    field->resets = true;
    return field;
}

static void make_form(const struct view_window *w, struct window_form *form) {
    const struct view_state *now = &w->now, *first = &w->initial;
    *form = (struct window_form){.subject = 1};
    if (w->view->is_field) {
        (void)snprintf(form->title, sizeof form->title, "Light Field");
        struct window_field *eye =
            add_field(form, AT, "eye", "From the middle of the cameras to the right, up and along the view.");
        eye->kind = FIELD_VECTOR;
        eye->numbers[0] = now->at.x;
        eye->numbers[1] = now->at.y;
        eye->numbers[2] = now->at.z;
        (void)add_number(form, FOCUS, "focus", "The distance from the eye to the plane that is sharp.",
                         (double[]){now->focus, first->focus});
        struct window_field *lens = add_number(form, APERTURE, "aperture", "The radius of the lens.",
                                               (double[]){now->aperture, first->aperture});
        lens->low = 0;
        lens->high = largest_aperture(w);
        return;
    }
    (void)snprintf(form->title, sizeof form->title, "Panorama");
    (void)add_number(form, LONGITUDE, "longitude", "To the right of the middle.", (double[]){now->at.x, first->at.x});
    (void)add_number(form, LATITUDE, "latitude", "Above the middle.", (double[]){now->at.y, first->at.y});
    (void)add_number(form, FOV, "fov", "The vertical angle of view.", (double[]){now->fov, first->fov});
    for (uint32_t i = 0; i < form->count; i++) {
        struct window_field *field = &form->fields[i];
        (void)snprintf(field->unit, sizeof field->unit, "degrees");
        field->low = i == 0 ? -180 : i == 1 ? -90 : 5;
        field->high = i == 0 ? 180 : i == 1 ? 90 : 150;
    }
}

static void describe(const struct view_window *w) {
    struct window_state *state = w->driver->state;
    const struct light_field_head *head = &w->view->field.head;
    make_form(w, &state->form);
    char rate[32] = "", field[64] = "";
    if (w->seconds > 0)
        (void)snprintf(rate, sizeof rate, ", %.0f pictures/s", 1 / w->seconds);
    if (w->view->is_field)
        (void)snprintf(field, sizeof field, " of %ux%u cameras%s", head->columns, head->rows,
                       head->depth ? ", with depths" : "");
    (void)snprintf(state->figures, sizeof state->figures, "%ux%u%s%s", w->width, w->height, field, rate);
    (void)snprintf(state->state, sizeof state->state, w->coarse ? "moving" : "ready");
    state->share = 1;
}

/* A picture of the present view, with fewer pixels while something moves. */
static bool draw(struct view_window *w, bool coarse, struct error *error) {
    uint32_t divide = coarse ? w->divide : 1;
    struct tone_bytes tone;
    double began = clock_now();
    w->fine = !coarse && !w->saves;
    w->now.quick = coarse;
    pool_reset_cancel(w->view->pool);
    if (!view_resize(w->view, (w->width + divide - 1) / divide, (w->height + divide - 1) / divide, error) ||
        !view_draw(w->view, &w->now, error))
        return false;
    tone_bytes_make(&w->view->tone, &tone);
    const float *light = w->view->light[0];
    for (size_t i = 0; i < (size_t)3 * w->view->width * w->view->height; i++)
        w->bytes[i] = tone_byte(&tone, light[i]);
    double seconds = clock_now() - began, fits = divide * sqrt(seconds / picture_seconds);
    w->divide = (uint32_t)math_min(math_max(ceil(fits - 0.1), 1), DIVIDE_LIMIT);
    w->coarse = coarse && (divide > 1 || (w->now.aperture > 0 && w->view->field.head.depth));
    return true;
}

static void stop_for_events(void *context) {
    const struct view_window *w = context;
    struct pollfd watched = {.fd = w->driver->descriptor(w->driver->context), .events = POLLIN};
    if (w->fine && poll(&watched, 1, 0) > 0)
        pool_cancel(w->view->pool);
}

static void show(struct view_window *w, bool coarse) {
    struct window_state *state = w->driver->state;
    struct error error;
    bool ok = draw(w, coarse, &error);
    if (!ok && error.kind == ERROR_CANCELLED)
        return;
    double now = clock_now(), passed = now - w->shown;
    if (coarse && passed < 0.5)
        w->seconds = w->seconds > 0 ? 0.8 * w->seconds + 0.2 * passed : passed;
    w->shown = now;
    (void)snprintf(state->message, sizeof state->message, "%.500s", ok ? "" : error.text);
    describe(w);
    w->driver->show(w->driver->context, w->bytes, ok ? w->view->width : w->width, ok ? w->view->height : w->height);
}

/* --- input --- */

/* The picture in the place for it: all of a view of a field; a panorama fills the place. */
static void fit(struct view_window *w, const struct window_event *event) {
    struct window_state *state = w->driver->state;
    struct error error;
    if (!w->view->is_field) {
        uint8_t *bytes = mem_alloc_zero((size_t)event->x * (size_t)event->y, 3);
        if (bytes && view_resize(w->view, (uint32_t)event->x, (uint32_t)event->y, &error)) {
            w->width = w->view->width;
            w->height = w->view->height;
            mem_free(w->bytes);
            w->bytes = bytes;
        }
    }
    double scale = math_min(event->x / w->width, event->y / w->height);
    state->shown_width = (int)math_max(1, floor(w->width * scale));
    state->shown_height = (int)math_max(1, floor(w->height * scale));
    state->left = (int)(event->x - state->shown_width) / 2;
    state->top = (int)(event->y - state->shown_height) / 2;
    w->outdated = true;
}

/* The picture follows the mouse: a point at the plane in focus, a direction. */
static void drag(struct view_window *w, double dx, double dy) {
    const struct window_state *state = w->driver->state;
    struct vec3 *at = &w->now.at;
    if (w->view->is_field) {
        at->x -= dx / state->shown_width * 2 * half_grid(w, true);
        at->y += dy / state->shown_height * 2 * half_grid(w, false);
    } else {
        at->x -= dx * w->now.fov / state->shown_height;
        at->y += dy * w->now.fov / state->shown_height;
    }
    limit(w);
}

static void focus_at(struct view_window *w, double x, double y) {
    struct window_state *state = w->driver->state;
    struct view *view = w->view;
    const double across = (x - state->left) / state->shown_width, down = (y - state->top) / state->shown_height;
    struct error error;
    if (!view->is_field || !(across >= 0 && across < 1 && down >= 0 && down < 1))
        return;
    struct light_field_camera camera = view_camera(view, &w->now);
    camera.width = w->width;
    camera.height = w->height;
    camera.quick = false;
    const double pixel[2] = {across * w->width, down * w->height};
    if (light_field_distance(&view->field, &camera, pixel, view->pool, &w->now.focus, &error))
        (void)snprintf(state->notice, sizeof state->notice, "Focus at %.4g", w->now.focus);
    else
        (void)snprintf(state->notice, sizeof state->notice, "%.500s",
                       error.text[0] != '\0' ? error.text : "Nothing is there to focus on");
    limit(w);
}

static void turn_wheel(struct view_window *w, double steps) {
    if (w->view->is_field)
        w->now.aperture += steps * largest_aperture(w) / WHEEL_STEPS;
    else
        w->now.fov *= el_pow(0.9, steps);
    limit(w);
}

static void change_field(struct view_window *w, const struct window_event *event) {
    switch (event->field) {
    case AT:
        w->now.at = vec3_make(event->numbers[0], event->numbers[1], event->numbers[2]);
        break;
    case LONGITUDE:
        w->now.at.x = event->numbers[0];
        break;
    case LATITUDE:
        w->now.at.y = event->numbers[0];
        break;
    case FOCUS:
        w->now.focus = event->numbers[0];
        break;
    case APERTURE:
        w->now.aperture = event->numbers[0];
        break;
    case FOV:
        w->now.fov = event->numbers[0];
        break;
    default:
        return;
    }
    limit(w);
}

static void do_action(struct view_window *w, const struct window_event *event) {
    struct window_state *state = w->driver->state;
    if (event->action == DO_QUIT)
        w->closed = true;
    else if (event->action == DO_CAMERA || event->action == DO_FRAME_ALL)
        w->now = w->initial;
    else if (event->action == DO_BRIGHTER || event->action == DO_DARKER)
        w->view->tone.exposure += event->action == DO_BRIGHTER ? 0.25 : -0.25;
    else if (event->action == DO_FULL_SCREEN)
        state->full_screen = !state->full_screen;
    w->saves = event->action == DO_SAVE_PICTURE;
    (void)snprintf(w->name, sizeof w->name, "%s", event->text);
    w->outdated = true;
}

static void handle(struct view_window *w, const struct window_event *event) {
    switch (event->kind) {
    case WINDOW_CLOSE:
        w->closed = true;
        return;
    case WINDOW_KEY:
        w->held[event->key] = event->down;
        return;
    case WINDOW_LEAVE:
        memset(w->held, 0, sizeof w->held);
        return;
    case WINDOW_MOVE:
        w->has_moved = w->has_moved || fabs(event->x - w->pressed_x) + fabs(event->y - w->pressed_y) >= click_pixels;
        if (w->drags && w->has_moved)
            drag(w, event->dx, event->dy);
        return;
    case WINDOW_WHEEL:
        turn_wheel(w, event->y);
        return;
    case WINDOW_PRESS:
        w->drags = true;
        w->has_moved = false;
        w->pressed_x = event->x;
        w->pressed_y = event->y;
        return;
    case WINDOW_RELEASE:
        if (w->drags && !w->has_moved && event->button == WINDOW_LEFT)
            focus_at(w, event->x, event->y);
        w->drags = false;
        w->outdated = true;
        return;
    case WINDOW_SIZE:
        fit(w, event);
        return;
    case WINDOW_ACTION:
        do_action(w, event);
        return;
    case WINDOW_FIELD:
        change_field(w, event);
        return;
    case WINDOW_TYPE:
    case WINDOW_NODES:
    case WINDOW_SELECT:
    case WINDOW_ADD:
    case WINDOW_TEXTURE:
    case WINDOW_HIDE:
        return;
    }
}

/* The arrow keys. */
static void step_keys(struct view_window *w, double now) {
    double seconds = math_min(now - w->stepped, 0.1), dx = w->held[FLY_RIGHT] - w->held[FLY_LEFT],
           dy = w->held[FLY_FORWARD] - w->held[FLY_BACK];
    double across = w->view->is_field ? 2 * half_grid(w, true) : 180,
           up = w->view->is_field ? 2 * half_grid(w, false) : 90;
    w->stepped = now;
    if (dx == 0 && dy == 0)
        return;
    w->now.at.x += dx * across * seconds / flight_seconds;
    w->now.at.y += dy * up * seconds / flight_seconds;
    limit(w);
}

static void save(struct view_window *w) {
    struct window_state *state = w->driver->state;
    struct error error;
    char name[sizeof w->name];
    const char *base = file_name_of(w->view->options), *dot = strrchr(base, '.');
    (void)snprintf(name, sizeof name, "%s", w->name);
    if (name[0] == '\0')
        (void)snprintf(name, sizeof name, "%.*s-view.png", (int)(dot ? dot - base : (long)strlen(base)), base);
    bool ok = draw(w, false, &error) && view_write(w->view, name, &error);
    (void)snprintf(state->notice, sizeof state->notice, ok ? "%.480s is written" : "%.480s", ok ? name : error.text);
    w->saves = false;
}

/* Waits for events for so many seconds, or without end if that is negative, and handles them. */
static void wait_for_events(struct view_window *w, double seconds) {
    struct pollfd watched = {.fd = w->driver->descriptor(w->driver->context), .events = POLLIN};
    struct window_event event;
    (void)poll(&watched, 1, seconds < 0 ? -1 : (int)(1000 * seconds));
    while (!w->closed && w->driver->poll(w->driver->context, &event))
        handle(w, &event);
}

static void loop(struct view_window *w) {
    const double rest = 0.15; /* seconds until all pixels are drawn */
    while (!w->closed) {
        step_keys(w, clock_now());
        wait_for_events(w, w->outdated ? 0 : w->coarse ? rest : -1);
        if (w->saves)
            save(w);
        if (!w->closed && (w->outdated || w->coarse) && w->driver->state->shown_width > 0) {
            bool moves = w->outdated;
            w->outdated = false;
            show(w, moves);
        }
    }
}

int view_window_run(const struct options *options, const struct window_driver *driver) {
    struct error error;
    struct view_window w = {.driver = driver, .divide = DIVIDE_LIMIT, .view = mem_alloc_zero(1, sizeof *w.view)};
    bool ok = (w.view || error_no_memory(&error, "the picture")) && view_open(w.view, options, &error);
    if (ok) {
        w.width = w.view->width;
        w.height = w.view->height;
        w.now = w.initial = view_state_of(w.view, 0);
        w.bytes = mem_alloc_zero((size_t)w.width * w.height, 3);
        ok = w.bytes || error_no_memory(&error, "the picture");
    }
    if (ok) {
        driver->state->has_scene = driver->state->lacks_nodes = true;
        driver->state->action_on = 1u << NEEDS_NOTHING | 1u << NEEDS_NAME | 1u << NEEDS_VIEW;
        (void)snprintf(driver->state->file, sizeof driver->state->file, "%.250s", file_name_of(options));
        (void)snprintf(driver->state->notice, sizeof driver->state->notice,
                       w.view->is_field ? "Drag: move the eye. Click: focus there. Wheel: aperture."
                                        : "Drag: turn. Wheel: angle of view.");
        ok = driver->open(driver->context, &error);
    }
    if (ok) {
        driver->nodes(driver->context, NULL, NULL);
        pool_set_poll(w.view->pool, stop_for_events, &w);
        loop(&w);
        driver->close(driver->context);
    }
    if (w.view)
        view_close(w.view);
    mem_free(w.view);
    mem_free(w.bytes);
    if (ok)
        return 0;
    char line[sizeof error.text + 16];
    (void)snprintf(line, sizeof line, "gray: %s", error.text);
    text_print_message(stderr, TEXT_ERROR, line);
    return (int)error.kind;
}
