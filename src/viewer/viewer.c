/* Passes: while somebody walks, one sample for every divide x divide pixels, with divide so that a pass takes about a
 * thirtieth of a second; then finer ones, and at last the picture as the script wants it. The cost of a pass goes with
 * the square of 1 / divide, which is how divide is found. */
#include "base/mem.h"
#include "viewer/viewer_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FIRST_DIVIDE = 16, MIDDLE_DIVIDE = 4, DIVIDE_LIMIT = 32 };
static const double pass_goal = 0.033;

static bool differ(double a, double b) {
    return a < b || a > b;
}

static struct live_view view_now(const struct live *live, uint32_t divide, bool plain) {
    return (struct live_view){.camera = live->flown ? walk_camera(&live->walk) : live->request.camera,
                              .exposure = live->request.exposure,
                              .divide = divide,
                              .plain = plain,
                              .own = !live->flown};
}

/* The scripts ran again: where somebody has flown to and what was changed stays. */
static void keep_work(struct live *live, const struct live *before) {
    struct pose home = live->walk.home;
    if (before->flown) {
        live->walk = before->walk;
        live->walk.home = home;
        live->flown = true;
    }
    if (differ(before->request.exposure, before->script_exposure))
        live->request.exposure = before->request.exposure;
    live->edits = before->edits;
    live->pending = before->pending;
    live->tool = before->tool;
    live_resend(live);
}

static void forget_work(struct live *live) {
    edits_destroy(&live->edits);
    change_list_destroy(&live->pending);
}

static void close_window(struct live *live) {
    if (live->open)
        live->driver->close(live->driver->context);
    mem_free(live->image);
    mem_free(live->light);
    mem_free(live->drawn);
    live_destroy_marks(live);
    mem_free(live->panel.paper.rgba);
    live->image = live->drawn = live->panel.paper.rgba = NULL;
    live->light = NULL;
    live->place = (struct live_place){0};
    live->open = false;
}

/* The window with all that belongs to it. */
static void keep_window(struct live *live, const struct live *before) {
    live->control = before->control;
    live->number = before->number;
    live->tells = before->tells;
    live->image = before->image;
    live->light = before->light;
    live->drawn = before->drawn;
    live->place = before->place;
    live->panel = before->panel;
    live->bare = before->bare;
    live->overlay = before->open ? before->overlay : live->overlay;
    live->open = before->open;
}

static bool open_window(struct live *live, struct error *error) {
    const struct picture_request *request = &live->request;
    size_t pixels = (size_t)request->width * request->height;
    live->image = mem_alloc_zero(pixels, 3);
    live->light = mem_alloc_zero(pixels, 3 * sizeof(float));
    live->drawn = mem_alloc_zero(live->tiles, 1);
    if (!live->image || !live->light || !live->drawn)
        return error_no_memory(error, "the window");
    live->open = live->driver->open(live->driver->context, request->width, request->height, live->name, error);
    return live->open;
}

bool live_begin(struct live *live, const struct window_driver *driver, const struct picture_request *request,
                void *block, const char *name, double now, struct error *error) {
    struct film whole = live_film(request, block, 1);
    const struct box unknown = box_empty();
    bool kept = live->keep && live->open;
    if (live->open && (live->request.width != request->width || live->request.height != request->height))
        close_window(live);
    live_destroy_marks(live);
    struct live before = *live;
    *live =
        (struct live){.driver = driver,
                      .request = *request,
                      .block = block,
                      .script_exposure = request->exposure,
                      .overlay = request->overlay <= OVERLAY_OF_GRID ? (enum overlay)request->overlay : OVERLAY_NONE,
                      .tiles = film_tile_count(&whole),
                      .moved = true,
                      .again = true,
                      .divide = FIRST_DIVIDE / 2,
                      .pass_began = now,
                      .stepped = now,
                      .shown = now};
    mem_free(before.lights);
    keep_window(live, &before);
    (void)snprintf(live->name, sizeof live->name, "%s", name);
    walk_begin(&live->walk, &request->camera, &unknown);
    live->view = view_now(live, FIRST_DIVIDE, true);
    if (kept)
        keep_work(live, &before);
    else
        forget_work(&before);
    if (!live->open && !open_window(live, error))
        return false;
    memset(live->drawn, 0, live->tiles);
    return true;
}

void live_end(struct live *live) {
    close_window(live);
    forget_work(live);
    mem_free(live->lights);
    *live = (struct live){.control = live->control, .tells = live->tells};
}

void live_detach(struct live *live) {
    live->block = NULL;
    live->film = (struct film){0};
    live->running = live->waiting = live->stopping = live->partial = live->asks = live->asks_story = false;
    live->halted = live->unbuilt = false;
    live->selection.kind = SELECTED_NOTHING;
    live->told = 0;
}

void live_keep(struct live *live) {
    live->keep = live->open;
}

bool live_skips(const struct live *live, unsigned number) {
    return live->keep && number < live->number;
}

void live_hear(struct live *live, const char *text) {
    size_t used = strlen(live->story);
    (void)snprintf(live->story + used, sizeof live->story - used, "%s", text);
    live->over_dirty = true;
}

void live_tell(struct live *live, const char *text) {
    size_t length = strcspn(text, "\n");
    (void)snprintf(live->message, sizeof live->message, "%.*s", (int)(length < 500 ? length : 500), text);
    live->told = 0;
}

/* Orders. */

void live_note_stop(struct live *live, double seconds) {
    (void)snprintf(live->note, sizeof live->note, "%.100s: stopped in %.1f ms", live->request.file, 1000 * seconds);
}

bool live_is_idle(const struct live *live) {
    return live->waiting && live->complete && !live->moved && !live->asks && !live->asks_story &&
           live->pending.count == 0;
}

static void end_pass(struct live *live, const struct picture_report *report, double now) {
    bool known = live->report.threads > 0;
    live->partial = report->stopped != 0;
    if (report->stopped)
        return;
    live_draw_tiles(live);
    /* Passes that take no time say nothing about how coarse they must be. */
    double took = now - live->pass_began, divide = live->view.divide * sqrt(took / pass_goal);
    if (live->view.plain && live->view.divide == live->divide && known)
        live->divide = divide < 1 ? 1 : divide > DIVIDE_LIMIT ? DIVIDE_LIMIT : (uint32_t)ceil(divide);
    live->complete = !live->view.plain;
    live->report = *report;
}

void live_take_news(struct live *live, const struct studio_news *news, double now) {
    if (live->halted && live->halted_at > 0)
        live_note_stop(live, now - live->halted_at);
    live->halted_at = 0;
    live->running = live->stopping = false;
    live->waiting = live->over_dirty = true;
    live->unbuilt = news->unbuilt;
    switch (news->kind) {
    case NEWS_BUILT:
        walk_measure(&live->walk, &news->report.bounds);
        live->moved = true;
        live->built = news->built;
        live->scene = *news;
        live_take_lights(live, news);
        return;
    case NEWS_PASS:
        end_pass(live, &news->report, now);
        if (!news->report.stopped && live->order.marks.lines.limit > 0)
            live_take_marks(live, &live->order.marks, &news->marks);
        return;
    case NEWS_MARKS:
        live_take_marks(live, &live->order.marks, &news->marks);
        return;
    case NEWS_PICKED:
        live_take_picked(live, &news->picked);
        live->order.marks = live_marks_wish(live, false);
        live->order.marks.lines.kind = OVERLAY_NONE;
        live_take_marks(live, &live->order.marks, &news->marks);
        return;
    case NEWS_CHANGED:
        if (!news->unbuilt || news->light_count > 0)
            live_take_lights(live, news);
        if (news->text[0] != '\0')
            live_tell(live, news->text);
        live->moved = true;
        live_stale_marks(live);
        return;
    case NEWS_LIGHTS:
        live_take_lights(live, news);
        return;
    case NEWS_STORY:
        return;
    }
}

/* resume: the tiles that are done stay. */
static void begin_pass(struct live *live, uint32_t divide, bool plain, bool resume, double now) {
    if (!resume) {
        live->view = view_now(live, divide, plain);
        live->film = live_film(&live->request, live->block, divide);
        live->edited = live->edits.now.count > 0 || differ(live->request.exposure, live->script_exposure);
        memset(live->drawn, 0, live->tiles);
        if (live->film.marked)
            memset(live->film.marked, 0, (size_t)live->film.width * live->film.height);
    }
    for (uint32_t tile = 0; tile < film_tile_count(&live->film); tile++) {
        if (!resume || atomic_load(&live->film.tiles[tile]) != FILM_TILE_DONE)
            atomic_store(&live->film.tiles[tile], FILM_TILE_WANTED);
    }
    live->order = (struct studio_order){.kind = ORDER_PASS, .view = live->view};
    if (live->moved)
        live_stale_marks(live);
    if (plain && !resume && live_wants_marks(live))
        live->order.marks = live_marks_wish(live, live->moved);
    live->moved = live->complete = live->partial = false;
    live->running = true;
    live->pass_began = now;
}

/* The first of what the child has not been told yet. */
static void order_change(struct live *live) {
    struct change target = live->pending.items[0];
    const struct change *now = change_list_find(&live->edits.now, &target);
    (void)change_list_set(&live->pending, &target, false);
    bool light = target.kind == CHANGE_LIGHT || target.kind == CHANGE_DARK;
    live->order = (struct studio_order){.kind = ORDER_CHANGE,
                                        .change = now ? *now : target,
                                        .present = now != NULL,
                                        .more = live->pending.count > 0,
                                        .first_light = light ? target.serial - 1 : 0};
}

static void order_pick(struct live *live) {
    live->asks = false;
    live->order = (struct studio_order){.kind = ORDER_PICK,
                                        .view = view_now(live, 1, true),
                                        .x = live->asked.x,
                                        .y = live->asked.y,
                                        .up = live->asked.up};
}

static void order_story(struct live *live) {
    live->asks_story = false;
    live->story[0] = '\0';
    live->story_line = 0;
    live->order = (struct studio_order){
        .kind = ORDER_STORY, .view = view_now(live, 1, false), .x = live->story_x, .y = live->story_y};
}

static void order_marks(struct live *live) {
    live->order = (struct studio_order){
        .kind = ORDER_MARKS, .view = view_now(live, 1, true), .marks = live_marks_wish(live, false)};
}

static enum live_order next_order(struct live *live, double now) {
    uint32_t divide = live->again ? FIRST_DIVIDE : live->divide;
    bool coarse = live->view.plain && live->view.divide > MIDDLE_DIVIDE && !live->halted;
    if (live->halted && live->unbuilt) /* what is asked now has no answer */
        live->asks = live->asks_story = false;
    if (live->pending.count > 0 && !live->halted) {
        order_change(live);
    } else if (live->asks) {
        order_pick(live);
    } else if (live->asks_story) {
        order_story(live);
    } else if (!live->moved && !coarse && live_wants_marks(live)) {
        order_marks(live);
    } else if (live->halted) {
        return LIVE_NOTHING;
    } else if (live->moved) {
        live->again = false;
        begin_pass(live, divide, true, false, now);
    } else if (live->lights_known < live->light_count) {
        live->order = (struct studio_order){.kind = ORDER_LIGHTS, .first_light = live->lights_known};
    } else if (!live->view.plain && differ(live->view.exposure, live->request.exposure)) {
        begin_pass(live, 1, false, false, now);
    } else if (live->partial) {
        begin_pass(live, 0, false, true, now);
    } else if (live->complete) {
        return LIVE_NOTHING;
    } else if (live->view.divide > MIDDLE_DIVIDE) {
        begin_pass(live, MIDDLE_DIVIDE, true, false, now);
    } else {
        begin_pass(live, 1, false, false, now);
    }
    live->waiting = false;
    return LIVE_ORDER;
}

/* What can be done while the child works. */
static enum live_order step_running(struct live *live) {
    /* A coarse pass is over soon and is worth showing; a fine one is not. */
    bool coarse = live->view.plain && live->view.divide >= live->divide;
    if (live->halted && live->block && !live->stopping) {
        live->stopping = true;
        return LIVE_STOP;
    }
    bool wanted = live->moved || (!coarse && live_wants_marks(live)) || live->asks || live->asks_story ||
                  live->pending.count > 0 || differ(live->view.exposure, live->request.exposure);
    if (!live->running || !wanted || live->stopping || coarse)
        return LIVE_NOTHING;
    live->stopping = true;
    return LIVE_STOP;
}

/* The picture is written with the lines of the command line, which are there where people look at them. */
static bool lines_of_script(const struct live *live) {
    return live->request.overlay == OVERLAY_NONE || (live->overlay == (enum overlay)live->request.overlay &&
                                                     live->lines_fresh && live->has_lines && !live->moved);
}

enum live_order live_step(struct live *live, double now) {
    struct window_event event;
    double seconds = now - live->stepped;
    live->stepped = now;
    if (live->block && walk_step(&live->walk, seconds < 0.1 ? seconds : 0.1))
        live_change_view(live);
    while (live->wish == LIVE_NOTHING && !live->quit && live->driver->poll(live->driver->context, &event))
        live_take_event(live, &event);
    if (live->running)
        live_draw_tiles(live);
    live_show(live, now);
    enum live_order wish = live->wish;
    live->wish = LIVE_NOTHING;
    if (wish != LIVE_NOTHING)
        return wish;
    if (live->tells && live->note[0] != '\0')
        return LIVE_NOTE;
    if (live->quit)
        return LIVE_QUIT;
    if (live->complete && live->view.own && !live->edited && !live->written && lines_of_script(live)) {
        live->written = true;
        if (live->request.overlay != OVERLAY_NONE)
            overlay_lay(&live->film, live->lines);
        return LIVE_WRITE;
    }
    if (live->waiting && live->next && live->written)
        return LIVE_NEXT;
    return live->waiting ? next_order(live, now) : step_running(live);
}
