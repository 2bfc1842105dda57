/* The image is updated from the film tile by tile, and shown at most every 16 milliseconds; the lines over it and what
 * the widgets show are made anew only when they may have changed. */
#include "viewer/viewer_internal.h"

#include "base/clock.h"
#include "base/mem.h"
#include "image/png_write.h"
#include "session/text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double redraw_pause = 0.016, status_pause = 0.25, notice_seconds = 5;

void viewer_resize(struct viewer *viewer, int width, int height, double density) {
    struct window_layout *layout = &viewer->window.layout;
    double w = viewer->request.width, h = viewer->request.height;
    if (width < 1 || height < 1)
        return;
    double fit = fmin(width / w, height / h);
    *layout = (struct window_layout){.width = width,
                                     .height = height,
                                     .density = density,
                                     .shown_width = fmax(1, floor(w * fit + 0.5)),
                                     .shown_height = fmax(1, floor(h * fit + 0.5))};
    layout->left = floor((width - layout->shown_width) / 2);
    layout->top = floor((height - layout->shown_height) / 2);
    viewer->display.hud_dirty = true;
    (void)snprintf(viewer->note, sizeof viewer->note, "%.60s: picture of %dx%d pixels, density %g",
                   viewer->request.file, width, height, density);
}

/* The image. */

static void tone_pixel(const struct viewer *viewer, const struct tone *tone, size_t pixel) {
    float rgb[3];
    memcpy(rgb, viewer->window.light + 3 * pixel, sizeof rgb);
    if (viewer->overlay.has_lines)
        overlay_blend(viewer->overlay.lines[pixel], rgb);
    for (size_t c = 0; c < 3; c++)
        viewer->window.image[3 * pixel + c] = png_write_byte(tone_apply(tone, (double)rgb[c]));
}

void viewer_draw_again(struct viewer *viewer, size_t pixel) {
    struct tone tone = picture_tone(&viewer->request);
    tone_pixel(viewer, &tone, pixel);
}

void viewer_redraw(struct viewer *viewer) {
    struct tone tone = picture_tone(&viewer->request);
    for (size_t i = 0; i < (size_t)viewer->request.width * viewer->request.height; i++)
        tone_pixel(viewer, &tone, i);
    viewer->window.dirty = true;
    viewer->window.large.stale = viewer->window.large.shown;
}

/* One pixel of the film is a square of the image. */
static void draw_pixel(struct viewer *viewer, const struct tone *tone, uint32_t x, uint32_t y) {
    const struct picture_request *request = &viewer->request;
    uint32_t divide = viewer->pass.view.divide;
    const float *colour = viewer->pass.film.pixels[(size_t)y * viewer->pass.film.width + x].rgb;
    size_t first = 0;
    bool begun = false;
    /* A pixel of a coarse pass covers a square; only lines over it make its pixels differ. */
    for (uint32_t v = y * divide; v < (y + 1) * divide && v < request->height; v++) {
        for (uint32_t u = x * divide; u < (x + 1) * divide && u < request->width; u++) {
            size_t pixel = (size_t)v * request->width + u;
            memcpy(viewer->window.light + 3 * pixel, colour, 3 * sizeof *colour);
            bool lined = viewer->overlay.has_lines && viewer->overlay.lines[pixel][3] < 1;
            if (!begun || lined)
                tone_pixel(viewer, tone, pixel);
            else
                memcpy(viewer->window.image + 3 * pixel, viewer->window.image + 3 * first, 3);
            first = lined || begun ? first : pixel;
            begun = begun || !lined;
        }
    }
}

/* The pixels of the film on both sides of the middle of a pixel, and how far it is to the second one, of 256. */
struct between {
    uint32_t first, second, far;
};

static struct between between_pixels(uint32_t at, uint32_t divide, uint32_t count) {
    uint32_t middle = (256 * at + 128) / divide, first = middle < 128 ? 0 : (middle - 128) >> 8;
    return (struct between){first, first + 1 < count ? first + 1 : first, middle < 128 ? 0 : (middle - 128) & 255};
}

static void blend(uint8_t *restrict out, const uint8_t *a, const uint8_t *b, uint32_t far, size_t count) {
    for (size_t i = 0; i < count; i++)
        out[i] = (uint8_t)((a[i] * (256 - far) + b[i] * far) >> 8);
}

/* A row of the film as bytes, enlarged to the width of the picture. small: room for the former. */
static void enlarge_row(const struct viewer *viewer, const struct tone *tone, uint32_t y, uint8_t *small,
                        uint8_t *out) {
    const struct film *film = &viewer->pass.film;
    for (size_t i = 0; i < film->width; i++)
        for (size_t c = 0; c < 3; c++)
            small[3 * i + c] = png_write_byte(tone_apply(tone, (double)film->pixels[y * film->width + i].rgb[c]));
    for (uint32_t x = 0; x < viewer->request.width; x++) {
        struct between u = between_pixels(x, viewer->pass.view.divide, film->width);
        blend(out + (size_t)3 * x, small + (size_t)3 * u.first, small + (size_t)3 * u.second, u.far, 3);
    }
}

/* A pass of few samples, enlarged smoothly: what it shows is replaced soon. */
static bool draw_smooth(struct viewer *viewer) {
    const struct film *film = &viewer->pass.film;
    size_t row = (size_t)3 * viewer->request.width;
    struct tone tone = picture_tone(&viewer->request);
    uint8_t *rows = mem_alloc_zero(3, row); /* two rows of the film, enlarged */
    uint32_t done = 0;                      /* rows of the film */
    if (!rows)
        return false;
    for (uint32_t y = 0; y < viewer->request.height; y++) {
        struct between v = between_pixels(y, viewer->pass.view.divide, film->height);
        for (; done <= v.second; done++)
            enlarge_row(viewer, &tone, done, rows + 2 * row, rows + done % 2 * row);
        blend(viewer->window.image + row * y, rows + v.first % 2 * row, rows + v.second % 2 * row, v.far, row);
    }
    mem_free(rows);
    viewer->window.dirty = true;
    return true;
}

/* Draws tiles that are finished or, after a pass over the picture, have more samples than before. */
void viewer_draw_tiles(struct viewer *viewer) {
    if (viewer->pass.view.width > 0) {
        viewer_draw_large(viewer);
        return;
    }
    const struct film *film = &viewer->pass.film;
    const struct pass_view *view = &viewer->pass.view;
    bool smooth = (view->headlight || view->samples > 0) && view->divide > 1 && !viewer->overlay.has_lines;
    bool denoised = !view->plain && viewer_shows_denoised(viewer);
    if (smooth && (viewer->pass.result != RESULT_COARSE || draw_smooth(viewer)))
        return;
    struct tone tone = picture_tone(&viewer->request);
    for (uint32_t tile = 0; tile < film_tile_count(film); tile++) {
        uint8_t state = atomic_load_explicit(&film->tiles[tile], memory_order_acquire);
        bool shows = denoised ? state == FILM_TILE_DONE : film_tile_shows(state);
        if (!shows || viewer->window.drawn[tile] == state)
            continue;
        struct film_rectangle r = film_tile_rectangle(film, tile);
        for (uint32_t y = r.y0 - film->y0; y < r.y1 - film->y0; y++)
            for (uint32_t x = r.x0 - film->x0; x < r.x1 - film->x0; x++)
                draw_pixel(viewer, &tone, x, y);
        viewer->window.drawn[tile] = state;
        viewer->window.dirty = true;
    }
}

/* The status. */

/* ", 12.3 k triangles" at the end of the text. */
static void add_count(char *text, size_t size, double count, const char *what) {
    const char *unit = count >= 1e9 ? " G" : count >= 1e6 ? " M" : count >= 1e4 ? " k" : " ";
    double value = count >= 1e9 ? count * 1e-9 : count >= 1e6 ? count * 1e-6 : count >= 1e4 ? count * 1e-3 : count;
    size_t used = strlen(text);
    (void)snprintf(text + used, size - used, ", %.*f%s%s", count >= 1e4 && value < 100 ? 2 : 0, value, unit, what);
}

/* The finished share: of the picture itself by its work, with the remaining time once it is known
 * (render/time_estimate.h); coarse ones by their tiles. */
static void describe_pass(const struct viewer *viewer, struct window_state *state, double now) {
    const struct progress_estimate *estimate =
        viewer->window.control && !viewer->pass.view.plain ? &viewer->window.control->progress_estimate : NULL;
    double share = estimate ? progress_estimate_share(estimate) : -1,
           left = estimate ? progress_estimate_left(estimate, now) : -1;
    char time[48];
    state->share = share >= 0 ? share : state->share;
    text_duration(left > 0 ? left : 0, time, sizeof time);
    (void)snprintf(state->state, sizeof state->state, left > 0 ? "%.0f %%%s, %s left" : "%.0f %%%s", 100 * state->share,
                   viewer->pass.view.plain ? " (coarse)" : "", time);
}

static void describe_state(const struct viewer *viewer, struct window_state *state, double now) {
    const struct control *control = viewer->window.control;
    char time[48], *words = state->state;
    const size_t size = sizeof state->state;
    uint32_t step = control ? atomic_load_explicit(&control->build_step, memory_order_relaxed) : 0;
    uint32_t done = viewer->block ? film_tiles_in(&viewer->pass.film, FILM_TILE_DONE) : 0;
    uint32_t count = viewer->block ? film_tile_count(&viewer->pass.film) : 0;
    state->share = count > 0 ? (double)done / count : viewer->pass.result == RESULT_COMPLETE ? 1 : 0;
    /* From what the user has asked for to what the render process does. */
    if (viewer_plays(viewer)) {
        (void)snprintf(words, size, "playing");
    } else if (viewer->player.seeking) {
        (void)snprintf(words, size, "going to frame %u", viewer->player.target);
    } else if (viewer->pass.halted && viewer->block) {
        (void)snprintf(words, size, viewer->pass.unbuilt ? "stopped building" : "stopped, %.0f %%", 100 * state->share);
    } else if (step > 0) {
        state->share = 0.001 * atomic_load_explicit(&control->build_done, memory_order_relaxed);
        (void)snprintf(words, size, "building, step %u: %.0f %%", step, 100 * state->share);
    } else if (!viewer->block) {
        text_duration(viewer->window.script_began > 0 ? now - viewer->window.script_began : 0, time, sizeof time);
        (void)snprintf(words, size, viewer->window.waits ? "waiting for a change" : "the script runs, %s", time);
    } else if (viewer->pass.report.threads == 0 && done == 0) {
        (void)snprintf(words, size, "building");
    } else if (viewer_is_enlarging(viewer)) {
        (void)snprintf(words, size, "ready, enlarging: %.0f %%", 100 * state->share);
    } else if (viewer->pass.result == RESULT_COMPLETE) {
        (void)snprintf(words, size, viewer_is_idle(viewer) ? "ready" : "working");
    } else {
        describe_pass(viewer, state, now);
    }
}

/* Size, rays, triangles, voxels and frames a second, of the last pass; the frame of an animation. */
static void describe_work(const struct viewer *viewer, struct window_state *state) {
    const struct picture_report *report = &viewer->pass.report;
    const struct render_statistics *rays = &report->rays;
    const struct frame *frame = &viewer->request.frame;
    char *text = state->figures;
    double seconds = rays->render_seconds;
    double traced = (double)rays->camera_rays + (double)rays->reflected_rays + (double)rays->refracted_rays +
                    (double)rays->shadow_rays;
    /* A hierarchy is stored in one voxel that contains everything. */
    double voxels = 1;
    for (int i = 0; i < 3; i++)
        voxels *= report->grid_cells[i] > 1 ? report->grid_cells[i] : 1;
    (void)snprintf(text, sizeof state->figures, "%ux%u", viewer->request.width, viewer->request.height);
    add_count(text, sizeof state->figures, seconds > 0 ? traced / seconds : 0, "rays/s");
    add_count(text, sizeof state->figures, (double)report->triangles, "triangles");
    add_count(text, sizeof state->figures, voxels, voxels > 1 ? "voxels" : "voxel");
    double rate = viewer_plays(viewer) ? viewer->player.rate : seconds > 0 ? 1 / seconds : 0;
    size_t used = strlen(text);
    (void)snprintf(text + used, sizeof state->figures - used, ", %.*f frames/s", rate < 10 ? 2 : rate < 100, rate);
    state->frame[0] = '\0';
    if (frame->number > 0)
        (void)snprintf(state->frame, sizeof state->frame, "frame %*u/%u %7.2f s", snprintf(NULL, 0, "%u", frame->count),
                       frame->number, frame->count, frame_time(frame));
}

/* What the widgets show. */
static void describe(struct viewer *viewer, double now) {
    static const char *const tools[] = {
        [TOOL_NONE] = "", [TOOL_MOVE] = "Move", [TOOL_TURN] = "Turn", [TOOL_SIZE] = "Size"};
    static const char axes[] = " xyz";
    struct window_state *state = viewer->window.driver->state;
    state->flies = viewer->input.flies;
    state->action_on = viewer_needs_met(viewer);
    state->halted = viewer->pass.halted;
    if (viewer->finished <= 0 && viewer->block && viewer_is_idle(viewer))
        viewer->finished = now;
    state->waits = viewer->window.waits;
    state->changed = viewer->window.changed;
    state->runs = viewer->name[0] == '\0' && !viewer->window.waits && now - viewer->window.script_began > 0.3;
    state->busy = !viewer->window.waits && (!viewer->block || !viewer_is_idle(viewer));
    state->playing = viewer->player.playing;
    state->loops = viewer->player.loops;
    state->unsaved = viewer->edit.steps.at != viewer->edit.saved_at;
    state->frame_index = viewer->player.count > 0 ? viewer_frame_index(viewer) : 0;
    state->frame_count = viewer->player.count;
    state->types = viewer->edit.tool != TOOL_NONE && !viewer->edit.handle;
    (void)snprintf(state->tool, sizeof state->tool, "%s%s%.1s %s", tools[viewer->edit.tool],
                   viewer->edit.axis > 0 ? " along " : "", axes + viewer->edit.axis, viewer->edit.typed);
    describe_state(viewer, state, now);
    describe_work(viewer, state);
    (void)snprintf(state->file, sizeof state->file, "%.250s", viewer->request.file);
    (void)snprintf(state->message, sizeof state->message, "%s", viewer->message);
    (void)snprintf(state->notice, sizeof state->notice, "%s", viewer->window.notice.text);
    (void)snprintf(state->trace, sizeof state->trace, "%s", viewer->trace.text);
    state->selected = (struct node_query){0};
    if (viewer->edit.selection.kind == SELECTED_NODE)
        state->selected = viewer->edit.selection.picked.path;
    state->hidden_count = 0;
    for (uint32_t i = 0; i < viewer->edit.steps.now.count && state->hidden_count < WINDOW_HIDDEN; i++) {
        if (viewer->edit.steps.now.items[i].kind == CHANGE_GONE)
            state->hidden[state->hidden_count++] = viewer->edit.steps.now.items[i].serial;
    }
    viewer_make_form(viewer, state);
}

/* The window. */

static void end_notice(struct viewer_notice *notice, double now) {
    if (notice->text[0] == '\0')
        return;
    if (notice->until <= 0)
        notice->until = now + notice_seconds;
    else if (now >= notice->until)
        notice->text[0] = '\0';
}

/* The picture on the screen now, even a coarse one, shows the new world. */
static void note_first_picture(struct viewer *viewer) {
    if (viewer->built <= 0 || viewer->pass.report.threads == 0 || viewer_plays(viewer) || viewer->note[0] != '\0')
        return;
    (void)snprintf(viewer->note, sizeof viewer->note, "%.100s: on the screen %.1f ms after its world was built",
                   viewer->request.file, 1000 * (clock_now() - viewer->built));
    viewer->built = 0;
}

void viewer_show(struct viewer *viewer, double now) {
    const struct window_layout *layout = &viewer->window.layout;
    const struct viewer_large *large = &viewer->window.large;
    bool due = now - viewer->display.figures_at >= status_pause;
    bool changed = viewer->window.dirty || viewer->display.hud_dirty;
    if (layout->width == 0 || viewer_awaits_frame(viewer, now) ||
        (!due && !(changed && now - viewer->display.shown_at >= redraw_pause)))
        return;
    if (large->shown && large->stale && viewer->block && viewer->pass.view.width > 0)
        viewer_draw_large(viewer);
    end_notice(&viewer->window.notice, now);
    if (due || viewer->display.hud_dirty) {
        viewer->display.hud_dirty = false;
        viewer_make_lines(viewer);
        describe(viewer, now);
        viewer->display.figures_at = due ? now : viewer->display.figures_at;
    }
    struct window_state *state = viewer->window.driver->state;
    state->left = (int)layout->left;
    state->top = (int)layout->top;
    state->shown_width = (int)layout->shown_width;
    state->shown_height = (int)layout->shown_height;
    viewer->window.driver->show(viewer->window.driver->context, large->shown ? large->image : viewer->window.image,
                                large->shown ? large->width : viewer->request.width,
                                large->shown ? large->height : viewer->request.height);
    note_first_picture(viewer);
    viewer->display.shown_at = now;
    viewer->window.dirty = false;
}
