/* Passes: while somebody walks, one sample for every divide x divide pixels, with divide so that a pass takes about a
 * thirtieth of a second; then finer ones, and at last the picture as the script wants it. The cost of a pass goes with
 * the square of 1 / divide, which is how divide is found. */
#include "app/live_parts.h"
#include "base/mem.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FIRST_DIVIDE = 16, MIDDLE_DIVIDE = 4, DIVIDE_LIMIT = 32 };
static const double pass_goal = 0.033;

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
    struct live before = *live;
    bool was_open = live->open, kept = live->keep && live->flown && was_open;
    if (was_open && (live->request.width != request->width || live->request.height != request->height)) {
        live_end(live);
        was_open = false;
        before.canvas = before.drawn = before.panel.paper.rgba = NULL;
        before.place = (struct live_place){0};
    }
    *live = (struct live){.driver = driver,
                          .control = before.control,
                          .request = *request,
                          .block = block,
                          .view = live_first_view(&request->camera),
                          .canvas = before.canvas,
                          .drawn = before.drawn,
                          .place = before.place,
                          .panel = before.panel,
                          .bare = before.bare,
                          .tiles = film_tile_count(&whole),
                          .number = before.number,
                          .open = was_open,
                          .running = true,
                          .divide = FIRST_DIVIDE / 2,
                          .pass_began = now,
                          .stepped = now,
                          .shown = now};
    live->film = live_film(request, block, live->view.divide);
    const struct box unknown = box_empty();
    walk_begin(&live->walk, &request->camera, &unknown);
    if (kept)
        keep_walk(live, &before.walk);
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
    mem_free(live->panel.paper.rgba);
    *live = (struct live){.control = live->control};
}

void live_detach(struct live *live) {
    live->block = NULL;
    live->film = (struct film){0};
    live->running = live->waiting = live->stopping = false;
    live->told = 0;
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
    live->told = 0;
}

/* Passes. */

void live_pass_ended(struct live *live, const struct picture_report *report, double now) {
    bool known = live->report.threads > 0;
    live->running = false;
    live->waiting = true;
    if (!known)
        walk_measure(&live->walk, &report->bounds);
    if (!report->stopped) {
        live_draw_tiles(live);
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

/* What can be done while the child works. */
static enum live_order step_running(struct live *live) {
    /* A coarse pass is over soon and is worth showing; a fine one is not. */
    bool coarse = live->view.plain && live->view.divide >= live->divide;
    if (!live->running || !live->moved || live->stopping || coarse)
        return LIVE_NOTHING;
    live->stopping = true;
    return LIVE_STOP;
}

enum live_order live_step(struct live *live, double now) {
    struct window_event event;
    double seconds = now - live->stepped;
    live->stepped = now;
    if (live->block && walk_step(&live->walk, seconds < 0.1 ? seconds : 0.1))
        live_change_view(live);
    while (live->wish == LIVE_NOTHING && live->driver->poll(live->driver->context, &event))
        live_take_event(live, &event);
    if (live->running)
        live_draw_tiles(live);
    live_show(live, now);
    enum live_order wish = live->wish;
    live->wish = LIVE_NOTHING;
    if (wish != LIVE_NOTHING)
        return wish;
    if (live->quit)
        return LIVE_QUIT;
    if (live->complete && live->view.own && !live->written) {
        live->written = true;
        return LIVE_WRITE;
    }
    if (live->waiting && live->next && live->written)
        return LIVE_NEXT;
    return live->waiting ? next_pass(live, now) : step_running(live);
}
