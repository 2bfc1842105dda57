/* While something moves, pictures have fewer pixels if they would take too long; the last one has all. The window
 * enlarges them. */
#include "host/view_window.h"

#include "base/clock.h"
#include "base/mem.h"
#include "math/elementary.h"
#include "math/portable.h"
#include "output/view.h"
#include "session/text.h"

#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>

static const double picture_seconds = 1 / 35.0, click_pixels = 4;
enum { DIVIDE_LIMIT = 8, WHEEL_STEPS = 16 };

struct view_window {
    struct view *view;
    const struct window_driver *driver;
    struct view_state initial, now; /* of a picture with all pixels */
    uint32_t divide;                /* pixels of the picture in one that is drawn while something moves */
    uint8_t *bytes;
    bool outdated, coarse, closed;
    bool fine; /* what is being drawn ends when something happens */
    bool drags, has_moved;
    double pressed_x, pressed_y;
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
    struct light_field_camera *camera = &w->now.camera;
    if (w->view->is_field) {
        (void)light_field_clamp(&w->view->field.head, camera);
        camera->aperture = math_min(math_max(camera->aperture, 0), largest_aperture(w));
    } else {
        camera->x = remainder(camera->x, 360);
        camera->y = math_min(math_max(camera->y, -90), 90);
        w->now.fov = math_min(math_max(w->now.fov, 5), 150);
    }
    w->outdated = true;
}

/* The size, and the options of gray view. */
static void describe(struct view_window *w) {
    struct window_state *state = w->driver->state;
    const struct light_field_camera *c = &w->now.camera;
    int length = snprintf(state->figures, sizeof state->figures, "%ux%u, ", c->width, c->height);
    if (w->view->is_field)
        (void)snprintf(state->figures + length, sizeof state->figures - (size_t)length,
                       "--eye %.4g,%.4g,%.4g --focus %.4g --aperture %.4g", c->x, c->y, c->z, c->focus, c->aperture);
    else
        (void)snprintf(state->figures + length, sizeof state->figures - (size_t)length,
                       "--direction %.4g,%.4g --fov %.4g", c->x, c->y, w->now.fov);
    (void)snprintf(state->state, sizeof state->state, w->coarse ? "moving" : "ready");
    state->share = 1;
}

/* A picture of the present view, with fewer pixels while something moves. */
static bool draw(struct view_window *w, bool coarse, struct error *error) {
    const uint32_t divide = coarse ? w->divide : 1;
    struct view_state state = w->now;
    struct tone_bytes tone;
    double began = clock_now();
    state.camera.width = (state.camera.width + divide - 1) / divide;
    state.camera.height = (state.camera.height + divide - 1) / divide;
    state.camera.quick = coarse;
    if (!view_draw(w->view, &state, error))
        return false;
    tone_bytes_make(&w->view->tone, &tone);
    const float *light = w->view->light[0];
    for (size_t i = 0; i < (size_t)3 * w->view->width * w->view->height; i++)
        w->bytes[i] = tone_byte(&tone, light[i]);
    double seconds = clock_now() - began, fits = divide * sqrt(seconds / picture_seconds);
    w->divide = (uint32_t)math_min(math_max(ceil(fits - 0.1), 1), DIVIDE_LIMIT);
    w->coarse = coarse && (divide > 1 || (state.camera.aperture > 0 && w->view->field.head.depth));
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
    w->fine = !coarse;
    bool ok = draw(w, coarse, &error);
    w->fine = false;
    pool_reset_cancel(w->view->pool);
    if (!ok && error.kind == ERROR_CANCELLED)
        return;
    (void)snprintf(state->message, sizeof state->message, "%.500s", ok ? "" : error.text);
    describe(w);
    w->driver->show(w->driver->context, w->bytes, ok ? w->view->width : w->now.camera.width,
                    ok ? w->view->height : w->now.camera.height);
}

/* --- input --- */

/* The picture in the place for it: all of a view of a field; a panorama fills the place. */
static void fit(struct view_window *w, const struct window_event *event) {
    struct window_state *state = w->driver->state;
    struct light_field_camera *camera = &w->now.camera;
    uint8_t *bytes = w->view->is_field ? NULL : mem_resize_array(w->bytes, (size_t)event->x * (size_t)event->y, 3);
    if (bytes) {
        camera->width = w->initial.camera.width = (uint32_t)event->x;
        camera->height = w->initial.camera.height = (uint32_t)event->y;
        w->bytes = bytes;
    }
    double scale = math_min(event->x / camera->width, event->y / camera->height);
    state->shown_width = (int)math_max(1, floor(camera->width * scale));
    state->shown_height = (int)math_max(1, floor(camera->height * scale));
    state->left = (int)(event->x - state->shown_width) / 2;
    state->top = (int)(event->y - state->shown_height) / 2;
    w->outdated = true;
}

/* The picture follows the mouse: a point at the plane in focus, a direction. */
static void drag(struct view_window *w, double dx, double dy) {
    const struct window_state *state = w->driver->state;
    const double across = dx / state->shown_width, down = dy / state->shown_height;
    struct light_field_camera *camera = &w->now.camera;
    if (w->view->is_field) {
        camera->x -= across * 2 * half_grid(w, true);
        camera->y += down * 2 * half_grid(w, false);
    } else {
        camera->x -= dx * w->now.fov / state->shown_height;
        camera->y += down * w->now.fov;
    }
    limit(w);
}

static void focus_at(struct view_window *w, double x, double y) {
    struct window_state *state = w->driver->state;
    struct view *view = w->view;
    struct light_field_camera *camera = &w->now.camera;
    const double across = (x - state->left) / state->shown_width, down = (y - state->top) / state->shown_height;
    struct error error;
    double distance;
    if (!view->is_field || !(across >= 0 && across < 1 && down >= 0 && down < 1))
        return;
    const double pixel[2] = {across * camera->width, down * camera->height};
    if (light_field_distance(&view->field, camera, pixel, view->pool, &distance, &error)) {
        (void)snprintf(state->notice, sizeof state->notice, "Focus at %.4g", distance);
        camera->focus = distance;
    } else {
        (void)snprintf(state->notice, sizeof state->notice, "%.500s",
                       error.text[0] != '\0' ? error.text : "Nothing is there to focus on");
    }
    limit(w);
}

static void turn_wheel(struct view_window *w, double steps) {
    if (w->view->is_field)
        w->now.camera.aperture += steps * largest_aperture(w) / WHEEL_STEPS;
    else
        w->now.fov *= el_pow(0.9, steps);
    limit(w);
}

static void save(struct view_window *w, const char *name) {
    struct window_state *state = w->driver->state;
    struct error error;
    char own[1024];
    const char *base = file_name_of(w->view->options), *dot = strrchr(base, '.');
    (void)snprintf(own, sizeof own, "%.*s-view.png", (int)(dot ? dot - base : (long)strlen(base)), base);
    name = name[0] == '\0' ? own : name;
    bool ok = draw(w, false, &error) && view_write(w->view, name, &error);
    (void)snprintf(state->notice, sizeof state->notice, ok ? "%.480s is written" : "%.480s", ok ? name : error.text);
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
    else if (event->action == DO_SAVE_PICTURE)
        save(w, event->text);
    w->outdated = true;
}

static void handle(struct view_window *w, const struct window_event *event) {
    switch (event->kind) {
    case WINDOW_CLOSE:
        w->closed = true;
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
    case WINDOW_KEY:
    case WINDOW_LEAVE:
    case WINDOW_FIELD:
    case WINDOW_TYPE:
    case WINDOW_NODES:
    case WINDOW_SELECT:
    case WINDOW_ADD:
    case WINDOW_TEXTURE:
    case WINDOW_HIDE:
        return;
    }
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
        wait_for_events(w, w->outdated ? 0 : w->coarse ? rest : -1);
        if (!w->closed && (w->outdated || w->coarse) && w->driver->state->shown_width > 0) {
            bool moves = w->outdated;
            w->outdated = false;
            show(w, moves);
        }
    }
}

int view_window_run(const struct options *options, const struct window_driver *driver) {
    struct error error;
    struct view_window w = {.driver = driver, .divide = DIVIDE_LIMIT, .view = view_open(options, &error)};
    bool ok = w.view != NULL;
    if (ok) {
        w.now = w.initial = view_state_of(w.view, 0);
        w.bytes = mem_alloc_zero((size_t)w.view->width * w.view->height, 3);
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
    mem_free(w.bytes);
    return view_close(w.view, ok ? NULL : &error);
}
