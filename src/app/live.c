/* Passes: while somebody walks, one sample for every divide x divide pixels, with divide so that a pass takes about a
 * thirtieth of a second; then finer ones, and at last the picture as the script wants it. The cost of a pass goes with
 * the square of 1 / divide, which is how divide is found. */
#include "app/live.h"

#include "base/mem.h"
#include "image/png_write.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FIRST_DIVIDE = 16, MIDDLE_DIVIDE = 4, DIVIDE_LIMIT = 32 };
static const double pass_goal = 0.033, frame_pause = 0.016, title_pause = 0.25;

struct live_view live_first_view(const struct camera *camera) {
    return (struct live_view){.camera = *camera, .divide = FIRST_DIVIDE, .plain = true, .own = true};
}

struct film live_film(const struct picture_request *request, void *block, uint32_t divide) {
    struct film film = {.x0 = request->x0 / divide,
                        .y0 = request->y0 / divide,
                        .full_width = (request->full_width + divide - 1) / divide,
                        .full_height = (request->full_height + divide - 1) / divide};
    uint32_t right = film.x0 + (request->width + divide - 1) / divide;
    uint32_t bottom = film.y0 + (request->height + divide - 1) / divide;
    right = right > film.full_width ? film.full_width : right;
    bottom = bottom > film.full_height ? film.full_height : bottom;
    film_place(&film, block, right - film.x0, bottom - film.y0);
    return film;
}

/* Somebody has flown somewhere: the first pass, which begins by itself, is the script's; the next one is there. */
static void keep_walk(struct live *live, const struct walk *walk) {
    struct pose home = live->walk.home;
    live->walk = *walk;
    live->walk.home = home;
    live->moved = live->flown = true;
}

bool live_begin(struct live *live, const struct window_driver *driver, const struct picture_request *request,
                void *block, const char *name, double now, struct error *error) {
    struct film whole = live_film(request, block, 1);
    bool was_open = live->open, kept = live->keep && live->flown && was_open;
    struct walk walk = live->walk;
    unsigned number = live->number;
    if (was_open && (live->request.width != request->width || live->request.height != request->height)) {
        live_end(live);
        was_open = false;
    }
    uint8_t *canvas = live->canvas, *drawn = live->drawn;
    *live = (struct live){.driver = driver,
                          .request = *request,
                          .block = block,
                          .view = live_first_view(&request->camera),
                          .canvas = canvas,
                          .drawn = drawn,
                          .tiles = film_tile_count(&whole),
                          .number = number,
                          .open = was_open,
                          .running = true,
                          .divide = FIRST_DIVIDE / 2,
                          .pass_began = now,
                          .stepped = now,
                          .shown = now,
                          .titled = now};
    live->film = live_film(request, block, live->view.divide);
    const struct box unknown = box_empty();
    walk_begin(&live->walk, &request->camera, &unknown);
    if (kept)
        keep_walk(live, &walk);
    (void)snprintf(live->name, sizeof live->name, "%s", name);
    if (!was_open) {
        live->canvas = mem_alloc_zero((size_t)request->width * request->height, 3);
        live->drawn = mem_alloc_zero(live->tiles, 1);
        if (!live->canvas || !live->drawn)
            return error_no_memory(error, "the window");
        if (!driver->open(driver->context, request->width, request->height, name, error))
            return false;
        live->open = true;
    }
    memset(live->drawn, 0, live->tiles);
    return true;
}

void live_end(struct live *live) {
    if (live->open)
        live->driver->close(live->driver->context);
    mem_free(live->canvas);
    mem_free(live->drawn);
    *live = (struct live){0};
}

void live_detach(struct live *live) {
    live->block = NULL;
    live->film = (struct film){0};
    live->running = live->waiting = live->stopping = false;
    live->titled = 0;
}

void live_keep(struct live *live) {
    live->keep = live->open;
}

bool live_skips(const struct live *live, unsigned number) {
    return live->keep && number < live->number;
}

void live_tell(struct live *live, const char *text) {
    size_t length = strcspn(text, "\n");
    (void)snprintf(live->message, sizeof live->message, "%.*s", (int)(length < 500 ? length : 500), text);
    live->titled = 0;
}

/* Drawing. */

static void draw_pixel(struct live *live, uint32_t x, uint32_t y, bool red) {
    const struct picture_request *request = &live->request;
    const struct tone tone = {request->exposure, (enum tone_curve)request->curve, request->srgb != 0};
    uint32_t divide = live->view.divide;
    const float *colour = live->film.pixels[(size_t)y * live->film.width + x].rgb;
    uint8_t rgb[3];
    for (int c = 0; c < 3; c++)
        rgb[c] = red ? (c == 0 ? 255 : 0) : png_write_byte(tone_apply(&tone, (double)colour[c]));
    for (uint32_t v = y * divide; v < (y + 1) * divide && v < request->height; v++) {
        for (uint32_t u = x * divide; u < (x + 1) * divide && u < request->width; u++)
            memcpy(live->canvas + 3 * ((size_t)v * request->width + u), rgb, 3);
    }
}

/* Tiles that are finished, and in those under way the pixels that are being sampled again, in red. */
static void draw_tiles(struct live *live) {
    const struct film *film = &live->film;
    for (uint32_t tile = 0; tile < film_tile_count(film); tile++) {
        uint8_t state = atomic_load_explicit(&film->tiles[tile], memory_order_acquire);
        bool done = state == FILM_TILE_DONE, under_way = state == FILM_TILE_TAKEN && !live->view.plain;
        if (live->drawn[tile] || (!done && !under_way))
            continue;
        struct film_rectangle r = film_tile_rectangle(film, tile);
        for (uint32_t y = r.y0 - film->y0; y < r.y1 - film->y0; y++) {
            for (uint32_t x = r.x0 - film->x0; x < r.x1 - film->x0; x++) {
                bool red = film->marked[(size_t)y * film->width + x] == FILM_MARK_WAITS;
                if (done || red)
                    draw_pixel(live, x, y, red && !done);
            }
        }
        live->drawn[tile] = done;
        live->dirty = true;
    }
}

static void show(struct live *live, double now) {
    const struct picture_report *report = &live->report;
    const struct window_driver *driver = live->driver;
    if (live->dirty && now - live->shown >= frame_pause) {
        driver->show(driver->context, live->canvas, live->request.width, live->request.height);
        live->shown = now;
        live->dirty = false;
    }
    if (now - live->titled < title_pause)
        return;
    char title[512], how[64];
    uint32_t done = film_tiles_in(&live->film, FILM_TILE_DONE), count = film_tile_count(&live->film);
    double seconds = report->rays.render_seconds;
    uint64_t rays =
        report->rays.camera_rays + report->rays.reflected_rays + report->rays.refracted_rays + report->rays.shadow_rays;
    if (live->message[0] != '\0') {
        driver->title(driver->context, live->message);
        live->titled = now;
        return;
    }
    if (report->threads == 0)
        (void)snprintf(how, sizeof how, "building");
    else if (live->complete)
        (void)snprintf(how, sizeof how, "ready");
    else
        (void)snprintf(how, sizeof how, "%.0f %%", 100.0 * done / count);
    (void)snprintf(title, sizeof title, "%.200s  %ux%u  %s  %.2f Mrays/s  %llu triangles  %.0f frames/s%s",
                   live->request.file, live->request.width, live->request.height, how,
                   seconds > 0 ? (double)rays / seconds * 1e-6 : 0, (unsigned long long)report->triangles,
                   seconds > 0 ? 1 / seconds : 0, live->grabbed ? "  (Esc leaves)" : "");
    driver->title(driver->context, title);
    live->titled = now;
}

/* Events. */

static void move_with(struct live *live, enum walk_key key, bool down) {
    live->walk.down[key] = down;
}

static void change_view(struct live *live) {
    live->moved = live->flown = true;
}

static void grab(struct live *live, bool on) {
    live->grabbed = on;
    memset(live->walk.down, 0, sizeof live->walk.down);
    live->driver->grab(live->driver->context, on);
}

/* Keys that are held. True: it was one. */
static bool take_held_key(struct live *live, int key, bool down) {
    static const struct {
        int key;
        enum walk_key walk;
        bool only_grabbed; /* the letter is a command otherwise */
    } keys[] = {{WINDOW_ARROW_UP, WALK_FORWARD, false},
                {WINDOW_ARROW_DOWN, WALK_BACK, false},
                {WINDOW_ARROW_LEFT, WALK_LEFT, false},
                {WINDOW_ARROW_RIGHT, WALK_RIGHT, false},
                {WINDOW_SHIFT, WALK_FAST, false},
                {WINDOW_CONTROL, WALK_SLOW, false},
                {'w', WALK_FORWARD, true},
                {'s', WALK_BACK, true},
                {'a', WALK_LEFT, true},
                {'d', WALK_RIGHT, true},
                {'e', WALK_UP, true},
                {'q', WALK_DOWN, true}};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        if (keys[i].key == key && (live->grabbed || !keys[i].only_grabbed)) {
            move_with(live, keys[i].walk, down);
            return true;
        }
    }
    return false;
}

static void take_view_key(struct live *live, int key, bool control) {
    struct walk *walk = &live->walk;
    if (key >= '0' && key <= '9' && control) {
        walk_save(walk, key - '0');
        return;
    }
    switch (key) {
    case 'l':
        walk_level(walk);
        break;
    case '[':
        walk_roll(walk, -5);
        break;
    case ']':
        walk_roll(walk, 5);
        break;
    case WINDOW_HOME:
        walk_home(walk);
        live->moved = true;
        live->flown = false;
        return;
    default:
        if (key < '0' || key > '9' || !walk_recall(walk, key - '0'))
            return;
    }
    change_view(live);
}

static enum live_order take_key(struct live *live, const struct window_event *event) {
    if (take_held_key(live, event->key, event->down) || !event->down)
        return LIVE_NOTHING;
    switch (event->key) {
    case 'q':
        live->quit = true;
        return LIVE_NOTHING;
    case 'r':
        live->again = live->moved = true;
        return LIVE_NOTHING;
    case 'n':
        live->next = true;
        return LIVE_NOTHING;
    case 's':
        return LIVE_SAVE;
    case 'v':
        return LIVE_RECORD;
    case 'f':
        live->driver->full_screen(live->driver->context);
        return LIVE_NOTHING;
    case WINDOW_SPACE:
        grab(live, !live->grabbed);
        return LIVE_NOTHING;
    case WINDOW_ESCAPE:
        grab(live, false);
        return LIVE_NOTHING;
    default:
        take_view_key(live, event->key, event->control);
        return LIVE_NOTHING;
    }
}

static enum live_order take_event(struct live *live, const struct window_event *event) {
    /* Without a scene there is nowhere to walk to. */
    bool idle_key =
        event->kind == WINDOW_KEY && event->down && (event->key == 'q' || event->key == 's' || event->key == 'f');
    if (!live->block && event->kind != WINDOW_CLOSE && !idle_key)
        return LIVE_NOTHING;
    switch (event->kind) {
    case WINDOW_CLOSE:
        live->quit = true;
        break;
    case WINDOW_KEY:
        return take_key(live, event);
    case WINDOW_MOVE:
        if (!live->grabbed && !live->turning)
            break;
        if (live->grabbed)
            walk_look(&live->walk, event->x, event->y);
        else
            walk_orbit(&live->walk, event->x, event->y);
        change_view(live);
        break;
    case WINDOW_WHEEL:
        walk_zoom(&live->walk, event->y);
        change_view(live);
        break;
    case WINDOW_PRESS:
        if (event->button == WINDOW_RIGHT)
            grab(live, !live->grabbed);
        else if (event->button == WINDOW_LEFT && !live->grabbed)
            live->turning = WINDOW_LEFT;
        break;
    case WINDOW_RELEASE:
        if (event->button == live->turning)
            live->turning = 0;
        break;
    case WINDOW_LEAVE:
        memset(live->walk.down, 0, sizeof live->walk.down);
        live->turning = 0;
        break;
    }
    return LIVE_NOTHING;
}

/* Passes. */

void live_pass_ended(struct live *live, const struct picture_report *report, double now) {
    bool known = live->report.threads > 0;
    live->running = false;
    live->waiting = true;
    if (!known)
        walk_measure(&live->walk, &report->bounds);
    if (!report->stopped) {
        draw_tiles(live);
        /* Passes that take no time say nothing about how coarse they must be. */
        double took = now - live->pass_began, divide = live->view.divide * sqrt(took / pass_goal);
        if (live->view.plain && live->view.divide == live->divide && known)
            live->divide = divide < 1 ? 1 : divide > DIVIDE_LIMIT ? DIVIDE_LIMIT : (uint32_t)ceil(divide);
        live->complete = !live->view.plain;
        live->report = *report;
    }
    live->stopping = false;
}

static void begin_pass(struct live *live, uint32_t divide, bool plain, double now) {
    live->view = (struct live_view){.camera = live->flown ? walk_camera(&live->walk) : live->request.camera,
                                    .divide = divide,
                                    .plain = plain,
                                    .own = !live->flown};
    live->film = live_film(&live->request, live->block, divide);
    for (uint32_t tile = 0; tile < film_tile_count(&live->film); tile++)
        atomic_store(&live->film.tiles[tile], FILM_TILE_WANTED);
    memset(live->film.marked, 0, (size_t)live->film.width * live->film.height);
    memset(live->drawn, 0, live->tiles);
    live->moved = live->waiting = live->complete = false;
    live->running = true;
    live->pass_began = now;
}

static enum live_order next_pass(struct live *live, double now) {
    const struct live_view *view = &live->view;
    if (live->moved) {
        uint32_t divide = live->again ? FIRST_DIVIDE : live->divide;
        live->again = false;
        begin_pass(live, divide, true, now);
    } else if (live->complete) {
        return LIVE_NOTHING;
    } else if (view->divide > MIDDLE_DIVIDE) {
        begin_pass(live, MIDDLE_DIVIDE, true, now);
    } else {
        begin_pass(live, 1, false, now);
    }
    return LIVE_VIEW;
}

enum live_order live_step(struct live *live, double now) {
    struct window_event event;
    double seconds = now - live->stepped;
    live->stepped = now;
    if (live->block && walk_step(&live->walk, seconds < 0.1 ? seconds : 0.1))
        change_view(live);
    while (live->driver->poll(live->driver->context, &event)) {
        enum live_order order = take_event(live, &event);
        if (order != LIVE_NOTHING)
            return order;
    }
    if (live->running)
        draw_tiles(live);
    show(live, now);
    if (live->quit)
        return LIVE_QUIT;
    if (live->complete && live->view.own && !live->written) {
        live->written = true;
        return LIVE_WRITE;
    }
    if (live->waiting && live->next && live->written)
        return LIVE_NEXT;
    if (live->waiting)
        return next_pass(live, now);
    /* A coarse pass is over soon and is worth showing; a fine one is not. */
    bool coarse = live->view.plain && live->view.divide >= live->divide;
    if (live->running && live->moved && !live->stopping && !coarse) {
        live->stopping = true;
        return LIVE_STOP;
    }
    return LIVE_NOTHING;
}
