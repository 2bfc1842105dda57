/* The child never has an opinion: it does what it is told, says what became of it, and asks again. Changes are taken
 * off and laid over anew as a whole, so that their order is that of the list, as it is when a script makes them. */
#include "viewer/preview_session.h"

#include "inspect/inspect.h"
#include "inspect/pick.h"
#include "output/progress.h"
#include "viewer/view_overlay.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

struct at_work {
    struct studio *studio;
    struct change_list changes;
    struct changed_scene changed;
    bool stale; /* the world is not that of the changes, or there is none */
    bool told;  /* the world was told of for the first time */
    struct live_view view;
    double build_seconds;
};

/* Settings of a pass: coarse ones have one sample a pixel, and a soft light few rays. */
static void set_pass(struct render_job *job, const struct render_job *own, const struct live_view *view,
                     const struct picture_request *asked, struct film *film, void *block) {
    *job = *own;
    *film = live_film(asked, block, view->divide);
    job->film = film;
    job->width = film->full_width;
    job->height = film->full_height;
    job->settings.show_marks = true;
    job->settings.order = ORDER_CENTRE;
    job->settings.tone.exposure = view->exposure;
    if (view->divide > 1) { /* the film says which part it is */
        job->settings.cropped = false;
        job->settings.keep_first = false;
    }
    if (!view->own) {
        job->camera = view->camera;
        job->settings.view_is_target = false;
        job->settings.motion = (struct camera_motion){0};
    }
    if (view->plain) {
        job->settings.full = false;
        job->settings.side_tolerance = job->settings.corner_tolerance = HUGE_VAL;
        job->settings.area_samples = job->settings.area_samples < 2 ? job->settings.area_samples : 2;
        job->settings.samples = 1;
        job->settings.lens.aperture = 0;
        job->settings.caustics.photons = 0;
    }
}

/* Of everything that has an end. */
static struct box finite_bounds(const struct world *world) {
    struct box bounds = box_empty();
    for (uint32_t i = 0; i < world->placed_count; i++) {
        if (vec3_finite(world->boxes[i].min) && vec3_finite(world->boxes[i].max))
            bounds = box_join(bounds, world->boxes[i]);
    }
    return bounds;
}

/* The wish to stop is the supervisor's: it takes it back before it sends the next order. */
bool studio_was_stopped(const struct control *control, const struct error *error) {
    return error->kind == ERROR_CANCELLED && atomic_load(&control->cancel) != CANCEL_ALL;
}

static bool make_pass(struct at_work *work, struct picture_report *report, struct error *error) {
    struct studio *studio = work->studio;
    struct render_job job;
    struct film film;
    double begun = progress_clock();
    set_pass(&job, studio->job, &work->view, studio->asked, &film, studio->job->film->pixels);
    /* How long a coarse pass takes nobody needs to know. */
    struct outlook *outlook = &studio->services->control->outlook;
    bool fine = work->view.divide <= 1 && !work->view.plain;
    outlook_reset(outlook, fine);
    job.outlook = fine ? outlook : NULL;
    report->rays = (struct render_statistics){.build_seconds = work->build_seconds};
    bool ok = render_run(&job, studio->pool, &report->rays, error);
    report->stopped = !ok && studio_was_stopped(studio->services->control, error);
    if (!ok && !report->stopped)
        return false;
    pool_reset_cancel(studio->pool);
    report->rays.render_seconds = progress_clock() - begun;
    studio->fill(studio->context, &film, report);
    return true;
}

/* The light as changed, which may not be built yet; of a mesh the world, if there is one, knows where it is. */
static void tell_light(const struct world *world, const struct light *light, uint32_t number, struct told_light *out) {
    const struct light *built = world && number < world->light_count ? &world->lights[number] : light;
    unsigned properties = light_properties(light);
    struct vec3 position = light->position;
    bool placed = light_can_move(light) || light_centre(built, &position);
    *out = (struct told_light){.kind = (uint32_t)light->kind,
                               .properties = properties,
                               .placed = placed,
                               .position = position,
                               .colour = light->colour,
                               .direction = properties & LIGHT_HAS_DIRECTION ? light->direction : vec3_all(0),
                               .edge1 = light->edge1,
                               .edge2 = light->edge2,
                               .radius = light->radius,
                               .cos_outer = light->cos_outer,
                               .moves = light_can_move(light),
                               .turns = light_can_turn(light),
                               .sizes = light_can_size(light)};
}

static void tell_lights(const struct at_work *work, uint32_t first, struct studio_news *news) {
    bool over = work->changes.count > 0;
    const struct light *lights = over ? work->changed.lights : work->studio->request->lights;
    news->light_count = over ? work->changed.light_count : work->studio->request->light_count;
    news->first_light = first;
    for (uint32_t i = 0; i < TOLD_LIGHTS && first < news->light_count && i < news->light_count - first; i++)
        tell_light(work->stale ? NULL : work->studio->world, &lights[first + i], first + i, &news->lights[i]);
}

static bool build_again(struct at_work *work, struct error *error) {
    struct studio *studio = work->studio;
    const struct render_request *request = studio->request;
    bool over = work->changes.count > 0;
    double begun = progress_clock();
    bool ok = studio->build(studio->context, over ? work->changed.lights : request->lights,
                            over ? work->changed.light_count : request->light_count, error);
    work->build_seconds = progress_clock() - begun;
    work->stale = !ok;
    pool_reset_cancel(studio->pool);
    return ok;
}

/* The world of the changes; where people stop its building it stays stale, and `news` says so. False: an error. */
static bool need_world(struct at_work *work, struct studio_news *news, struct error *error) {
    if (!work->stale || build_again(work, error))
        return true;
    news->unbuilt = studio_was_stopped(work->studio->services->control, error);
    if (news->unbuilt)
        news->kind = NEWS_CHANGED;
    return news->unbuilt;
}

static bool change_scene(struct at_work *work, const struct studio_order *order, struct studio_news *news,
                         struct error *error) {
    struct studio *studio = work->studio;
    const struct render_request *request = studio->request;
    news->kind = NEWS_CHANGED;
    if ((unsigned)order->change.kind >= CHANGE_KINDS || (unsigned)order->change.added >= ADDED_KINDS ||
        (unsigned)order->change.part >= LOOK_PARTS ||
        !change_list_set(&work->changes, &order->change, order->present)) {
        (void)snprintf(news->text, sizeof news->text, "there are too many changes");
        return true;
    }
    changes_take_off(&work->changed);
    if (!changes_lay_over(work->changes.items, work->changes.count, request->scene, request->root, request->lights,
                          request->light_count, studio->warn, studio->context, &work->changed, error))
        return false;
    work->stale = work->stale || !change_keeps_world(&order->change);
    if (!order->more && !need_world(work, news, error))
        return false;
    if (!work->stale)
        world_update_materials(studio->world);
    news->unbuilt = work->stale;
    tell_lights(work, order->first_light, news);
    return true;
}

/* The job with the camera that people look through. */
static struct render_job looking_job(const struct at_work *work, const struct live_view *view) {
    struct render_job job = *work->studio->job;
    if (!view->own) {
        job.camera = view->camera;
        job.settings.view_is_target = false;
        job.settings.motion = (struct camera_motion){0};
    }
    return job;
}

/* The look is told as it was before the changes of the window, which knows these itself. */
static bool answer_click(const struct at_work *work, const struct studio_order *order, struct picked *picked,
                         struct error *error) {
    struct render_job job = looking_job(work, &order->view);
    if (!pick_at(&job, work->studio->request->root, order->x, order->y, order->up, picked, error))
        return false;
    const struct material *before = changes_before(&work->changed, picked->material_serial);
    for (int part = 0; before && part < LOOK_PARTS; part++)
        look_part_get(before, (enum look_part)part, picked->look[part]);
    return true;
}

static void print_piece(void *context, const char *text) {
    const struct studio *studio = context;
    studio->services->line(studio->services->context, LINE_OUTPUT, text);
}

static bool tell_story(struct at_work *work, const struct studio_order *order, struct error *error) {
    struct studio *studio = work->studio;
    struct render_job job = looking_job(work, &order->view);
    struct inspected picture = {studio->request->file, &job, studio->request->root};
    struct sheet sheet = {.put = print_piece, .context = studio};
    const uint32_t pixel[1][2] = {{(uint32_t)order->x, (uint32_t)order->y}};
    /* The supervisor asks for pixels of the picture; another one has no story. */
    if (!(order->x >= 0 && order->y >= 0 && order->x < job.width && order->y < job.height))
        return true;
    return inspect_pixels(&picture, pixel, 1, false, studio->pool, &sheet, error);
}

static void tell_world(struct at_work *work, struct studio_news *news) {
    const struct node *root = work->studio->request->root;
    news->kind = NEWS_BUILT;
    news->built = progress_clock();
    news->added = work->studio->request->added;
    news->owned = work->studio->request->owned;
    news->report.bounds = finite_bounds(work->studio->world);
    news->root = root->serial;
    news->world_from_root = node_parent_from_node(root).forward;
    pick_words(news->root_name, root->name);
    tell_lights(work, 0, news);
    work->told = true;
}

/* Marks that are stopped are made later. False: an error. */
static bool make_marks(struct at_work *work, const struct live_view *view, const struct marks_wish *wish,
                       struct studio_news *news, struct error *error) {
    struct studio *studio = work->studio;
    struct render_job job = looking_job(work, view);
    struct marks_place place;
    marks_place(studio->asked, job.film->pixels, &place);
    if (wish->lines.limit == 0 || wish->lines.cell == 0) /* nothing is asked for */
        return true;
    double begun = progress_clock();
    bool ok = marks_make(&job, studio->request->root, studio->pool, wish, &place, &news->marks, error);
    news->report.rays.render_seconds += progress_clock() - begun; /* a frame is not there before its lines */
    news->marks.stopped = !ok && studio_was_stopped(studio->services->control, error);
    pool_reset_cancel(studio->pool);
    return ok || news->marks.stopped;
}

/* What stands there, and where it is seen. */
static bool pick(struct at_work *work, const struct studio_order *order, struct studio_news *news,
                 struct error *error) {
    struct marks_wish wish = {.lines = {OVERLAY_NONE, 1, 1}, .outline = true};
    if (!answer_click(work, order, &news->picked, error))
        return false;
    wish.serial = news->picked.serial;
    wish.way = news->picked.way;
    wish.solid = news->picked.solid;
    return !news->picked.hit || make_marks(work, &order->view, &wish, news, error);
}

static bool obey(struct at_work *work, const struct studio_order *order, struct studio_news *news,
                 struct error *error) {
    if (order->kind != ORDER_CHANGE && (!need_world(work, news, error) || news->unbuilt))
        return news->unbuilt;
    if (order->kind != ORDER_CHANGE && !work->told) {
        tell_world(work, news);
        return true;
    }
    switch (order->kind) {
    case ORDER_PASS:
        news->kind = NEWS_PASS;
        work->view = order->view;
        return make_pass(work, &news->report, error) &&
               (news->report.stopped || make_marks(work, &order->view, &order->marks, news, error));
    case ORDER_PICK:
        news->kind = NEWS_PICKED;
        return pick(work, order, news, error);
    case ORDER_MARKS:
        news->kind = NEWS_MARKS;
        return make_marks(work, &order->view, &order->marks, news, error);
    case ORDER_CHANGE:
        return change_scene(work, order, news, error);
    case ORDER_STORY:
        news->kind = NEWS_STORY;
        return tell_story(work, order, error);
    case ORDER_LIGHTS:
        news->kind = NEWS_LIGHTS;
        tell_lights(work, order->first_light, news);
        return true;
    case ORDER_END:
        break;
    }
    return true;
}

static bool work_on(struct at_work *work, struct picture_report *report, struct error *error) {
    struct studio *studio = work->studio;
    struct studio_news news = {.kind = NEWS_CHANGED, .report = *report, .unbuilt = work->stale};
    struct studio_order order;
    if (!work->stale)
        tell_world(work, &news);
    for (;;) {
        if (news.kind == NEWS_BUILT)
            report->bounds = news.report.bounds;
        if (!studio->services->news(studio->services->context, &news, &order, error))
            return false;
        if (order.kind == ORDER_END)
            return !order.quit || error_set(error, ERROR_CANCELLED, "the window was closed");
        news = (struct studio_news){.report = *report};
        if (!obey(work, &order, &news, error))
            return false;
        if (news.kind == NEWS_PASS)
            *report = news.report;
    }
}

bool studio_run(struct studio *studio, bool built, struct picture_report *report, double build_seconds,
                struct error *error) {
    struct at_work work = {.studio = studio, .stale = !built, .build_seconds = build_seconds};
    bool ok = work_on(&work, report, error);
    changes_take_off(&work.changed);
    change_list_destroy(&work.changes);
    return ok;
}
