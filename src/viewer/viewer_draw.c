/* The image is updated from the film tile by tile; the menu and the figures are drawn over it. The window is drawn at
 * most every 16 milliseconds, and the drawing over the picture only when it may have changed. */
#include "base/clock.h"
#include "base/mem.h"
#include "image/png_write.h"
#include "output/progress.h"
#include "session/text.h"
#include "viewer/viewer_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double redraw_pause = 0.016, figures_pause = 0.25, notice_seconds = 5;

bool viewer_resize(struct viewer *viewer, int width, int height, double density) {
    struct window_layout *layout = &viewer->window.layout;
    struct canvas *canvas = &viewer->window.panel.canvas;
    double w = viewer->request.width, h = viewer->request.height;
    if (width < 1 || height < 1)
        return true;
    if (width != layout->width || height != layout->height) {
        uint8_t *rgba = mem_alloc_zero((size_t)width * (size_t)height, 4);
        if (!rgba)
            return false;
        mem_free(canvas->rgba);
        *canvas = (struct canvas){rgba, width, height, 1};
    }
    /* A size of letters that is readable and leaves room for the picture. */
    double scale = floor(fmin(width / (440 * density), height / (330 * density)));
    canvas->scale = (int)fmax(1, floor(density * fmax(1, fmin(scale, 2)) + 0.5));
    double fit = fmin(width / w, height / h);
    *layout = (struct window_layout){.width = width,
                                     .height = height,
                                     .density = density,
                                     .shown_width = fmax(1, floor(w * fit + 0.5)),
                                     .shown_height = fmax(1, floor(h * fit + 0.5))};
    layout->left = floor((width - layout->shown_width) / 2);
    layout->top = floor((height - layout->shown_height) / 2);
    viewer->display.hud_dirty = true;
    (void)snprintf(viewer->note, sizeof viewer->note, "%.60s: window of %dx%d pixels, density %g, letters of %d",
                   viewer->request.file, width, height, density, canvas->scale);
    return true;
}

/* The canvas. */

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

/* One pixel of the film is a square of the canvas. */
static void draw_pixel(struct viewer *viewer, const struct tone *tone, uint32_t x, uint32_t y, bool red) {
    static const uint8_t marked_colour[3] = {255, 0, 0};
    const struct picture_request *request = &viewer->request;
    uint32_t divide = viewer->pass.view.divide;
    const float *colour = viewer->pass.film.pixels[(size_t)y * viewer->pass.film.width + x].rgb;
    size_t first = 0;
    bool begun = false;
    for (uint32_t v = y * divide; v < (y + 1) * divide && v < request->height; v++) {
        for (uint32_t u = x * divide; u < (x + 1) * divide && u < request->width; u++) {
            size_t pixel = (size_t)v * request->width + u;
            if (red) {
                memcpy(viewer->window.image + 3 * pixel, marked_colour, 3);
                continue;
            }
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

/* Draws tiles that are finished or, after a pass over the picture, have more samples than before. In tiles in progress,
 * pixels that are being sampled again are red. */
void viewer_draw_tiles(struct viewer *viewer) {
    if (viewer->pass.view.width > 0) {
        viewer_draw_large(viewer);
        return;
    }
    const struct film *film = &viewer->pass.film;
    struct tone tone = picture_tone(&viewer->request);
    for (uint32_t tile = 0; tile < film_tile_count(film); tile++) {
        uint8_t state = atomic_load_explicit(&film->tiles[tile], memory_order_acquire);
        bool shows = film_tile_shows(state), in_progress = state == FILM_TILE_TAKEN && !viewer->pass.view.plain;
        if (shows ? viewer->window.drawn[tile] == state : !in_progress || !film->marked)
            continue;
        struct film_rectangle r = film_tile_rectangle(film, tile);
        for (uint32_t y = r.y0 - film->y0; y < r.y1 - film->y0; y++) {
            for (uint32_t x = r.x0 - film->x0; x < r.x1 - film->x0; x++) {
                bool red = film->marked && film->marked[(size_t)y * film->width + x] == FILM_MARK_WAITS;
                if (shows || red)
                    draw_pixel(viewer, &tone, x, y, red && !shows);
            }
        }
        if (shows)
            viewer->window.drawn[tile] = state;
        viewer->window.dirty = true;
    }
}

/* Figures. */

static void format_count(char *out, size_t size, double count, const char *what) {
    const char *unit = count >= 1e9 ? " G" : count >= 1e6 ? " M" : count >= 1e4 ? " k" : " ";
    double value = count >= 1e9 ? count * 1e-9 : count >= 1e6 ? count * 1e-6 : count >= 1e4 ? count * 1e-3 : count;
    (void)snprintf(out, size, "%.*f%s%s", count >= 1e4 && value < 100 ? 2 : 0, value, unit, what);
}

static uint32_t building_step(const struct viewer *viewer) {
    return viewer->window.control ? atomic_load_explicit(&viewer->window.control->build_step, memory_order_relaxed) : 0;
}

/* The finished share: of the picture itself by its work, with the remaining time once it is known
 * (render/time_estimate.h); coarse ones by their tiles. */
static void describe_pass(const struct viewer *viewer, struct figures *figures, double now) {
    const struct progress_estimate *progress_estimate =
        viewer->window.control && !viewer->pass.view.plain ? &viewer->window.control->progress_estimate : NULL;
    double share = progress_estimate ? progress_estimate_share(progress_estimate) : -1,
           left = progress_estimate ? progress_estimate_left(progress_estimate, now) : -1;
    char time[48];
    figures->share = share >= 0 ? share : figures->share;
    text_duration(left > 0 ? left : 0, time, sizeof time);
    (void)snprintf(figures->state, sizeof figures->state, left > 0 ? "%.0f %%%s, %s left" : "%.0f %%%s",
                   100 * figures->share, viewer->pass.view.plain ? " (coarse)" : "", time);
}

static void describe_state(const struct viewer *viewer, struct figures *figures, double now) {
    char time[48];
    uint32_t step = building_step(viewer);
    uint32_t done = viewer->block ? film_tiles_in(&viewer->pass.film, FILM_TILE_DONE) : 0;
    uint32_t count = viewer->block ? film_tile_count(&viewer->pass.film) : 0;
    figures->share = count > 0 ? (double)done / count : viewer->pass.result == RESULT_COMPLETE ? 1 : 0;
    if (viewer_plays(viewer)) {
        (void)snprintf(figures->state, sizeof figures->state, "playing");
    } else if (viewer->player.seeking) {
        (void)snprintf(figures->state, sizeof figures->state, "going to frame %u", viewer->player.target);
    } else if (viewer->pass.halted && viewer->block) {
        (void)snprintf(figures->state, sizeof figures->state,
                       viewer->pass.unbuilt ? "stopped building" : "stopped, %.0f %%", 100 * figures->share);
    } else if (step > 0) {
        figures->share = 0.001 * atomic_load_explicit(&viewer->window.control->build_done, memory_order_relaxed);
        (void)snprintf(figures->state, sizeof figures->state, "building, step %u: %.0f %%", step, 100 * figures->share);
    } else if (!viewer->block) {
        text_duration(viewer->window.script_began > 0 ? now - viewer->window.script_began : 0, time, sizeof time);
        (void)snprintf(figures->state, sizeof figures->state,
                       viewer->window.waits ? "waiting for a change" : "the script runs, %s", time);
    } else if (viewer->pass.report.threads == 0 && done == 0) {
        (void)snprintf(figures->state, sizeof figures->state, "building");
    } else if (viewer_is_enlarging(viewer)) {
        (void)snprintf(figures->state, sizeof figures->state, "ready, enlarging: %.0f %%", 100 * figures->share);
    } else if (viewer->pass.result == RESULT_COMPLETE) {
        (void)snprintf(figures->state, sizeof figures->state, viewer_is_idle(viewer) ? "ready" : "working");
    } else {
        describe_pass(viewer, figures, now);
    }
}

static void compute_figures(const struct viewer *viewer, struct figures *figures, double now) {
    const struct picture_report *report = &viewer->pass.report;
    const struct render_statistics *rays = &report->rays;
    double seconds = rays->render_seconds;
    double traced = (double)rays->camera_rays + (double)rays->reflected_rays + (double)rays->refracted_rays +
                    (double)rays->shadow_rays;
    /* A hierarchy is stored in one voxel that contains everything. */
    double voxels = 1;
    for (int i = 0; i < 3; i++)
        voxels *= report->grid_cells[i] > 1 ? report->grid_cells[i] : 1;
    *figures = (struct figures){0};
    describe_state(viewer, figures, now);
    (void)snprintf(figures->size, sizeof figures->size, "%ux%u", viewer->request.width, viewer->request.height);
    format_count(figures->rays, sizeof figures->rays, seconds > 0 ? traced / seconds : 0, "rays/s");
    format_count(figures->triangles, sizeof figures->triangles, (double)report->triangles, "triangles");
    format_count(figures->voxels, sizeof figures->voxels, voxels, voxels > 1 ? "voxels" : "voxel");
    (void)snprintf(figures->frames, sizeof figures->frames, seconds > 0 ? "%.*f frames/s" : "- frames/s",
                   seconds > 0.1 ? 2 : 0, seconds > 0 ? 1 / seconds : 0);
    const struct frame *frame = &viewer->request.frame;
    if (frame->number == 0)
        return;
    int digits = snprintf(NULL, 0, "%u", frame->count);
    (void)snprintf(figures->frame, sizeof figures->frame, "frame %*u/%u %7.2f s", digits, frame->number, frame->count,
                   frame_time(frame));
    if (viewer_plays(viewer))
        (void)snprintf(figures->frames, sizeof figures->frames, "%.1f frames/s", viewer->player.rate);
}

static void set_title(struct viewer *viewer, const struct figures *figures) {
    char title[1024];
    (void)snprintf(title, sizeof title, "%.200s  %s  %s  %s%s%s  %s  %s  %s%s%s%.400s", viewer->request.file,
                   figures->size, figures->state, figures->frame, figures->frame[0] != '\0' ? "  " : "", figures->rays,
                   figures->triangles, figures->voxels, figures->frames, viewer->input.grabbed ? "  (Esc leaves)" : "",
                   viewer->window.notice.text[0] != '\0' ? "  " : "", viewer->window.notice.text);
    viewer->window.driver->title(viewer->window.driver->context, viewer->message[0] != '\0' ? viewer->message : title);
}

static void end_notice(struct viewer_notice *notice, double now) {
    if (notice->text[0] == '\0')
        return;
    if (notice->until <= 0)
        notice->until = now + notice_seconds;
    else if (now >= notice->until)
        notice->text[0] = '\0';
}

void viewer_show(struct viewer *viewer, double now) {
    const struct window_driver *driver = viewer->window.driver;
    bool due = now - viewer->display.figures_at >= figures_pause;
    if (!viewer->window.panel.canvas.rgba || viewer_awaits_frame(viewer, now) ||
        (!due &&
         !((viewer->window.dirty || viewer->display.hud_dirty) && now - viewer->display.shown_at >= redraw_pause)))
        return;
    bool over = due || viewer->display.hud_dirty;
    if (viewer->window.large.shown && viewer->window.large.stale && viewer->block && viewer->pass.view.width > 0)
        viewer_draw_large(viewer);
    end_notice(&viewer->window.notice, now);
    if (over) {
        struct figures figures;
        viewer->display.hud_dirty = false; /* a used part of the panel requires another frame */
        compute_figures(viewer, &figures, now);
        viewer_draw_hud(viewer, &figures);
        if (due)
            set_title(viewer, &figures);
        viewer->display.figures_at = due ? now : viewer->display.figures_at;
    }
    const struct window_layout *layout = &viewer->window.layout;
    const struct viewer_large *large = &viewer->window.large;
    struct window_content frame = {.picture = large->shown ? large->image : viewer->window.image,
                                   .width = large->shown ? large->width : viewer->request.width,
                                   .height = large->shown ? large->height : viewer->request.height,
                                   .picture_changed = viewer->window.dirty,
                                   .left = (int)layout->left,
                                   .top = (int)layout->top,
                                   .shown_width = (int)layout->shown_width,
                                   .shown_height = (int)layout->shown_height,
                                   .overlay = viewer->window.panel.canvas.rgba,
                                   .window_width = (uint32_t)layout->width,
                                   .window_height = (uint32_t)layout->height,
                                   .overlay_changed = over};
    if (viewer->display.fits_window) {
        frame.fit_width = viewer->request.width;
        frame.fit_height = viewer->request.height;
    }
    driver->show(driver->context, &frame);
    viewer->display.fits_window = false;
    /* The picture on the screen now, even a coarse one, shows the new world. */
    if (viewer->built > 0 && viewer->pass.report.threads > 0 && !viewer_plays(viewer) && viewer->note[0] == '\0') {
        (void)snprintf(viewer->note, sizeof viewer->note, "%.100s: on the screen %.1f ms after its world was built",
                       viewer->request.file, 1000 * (clock_now() - viewer->built));
        viewer->built = 0;
    }
    viewer->display.shown_at = now;
    viewer->window.dirty = false;
}
