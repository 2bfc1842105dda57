/* The canvas follows the film tile by tile; over it lie the menu and the figures. The window is drawn at most every 16
 * milliseconds, and what lies over the picture only when something in it can have changed. */
#include "base/mem.h"
#include "image/png_write.h"
#include "output/progress.h"
#include "session/text.h"
#include "viewer/viewer_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double frame_pause = 0.016, figures_pause = 0.25;

bool live_resize(struct live *live, int width, int height, double density) {
    struct live_place *place = &live->place;
    struct paper *paper = &live->panel.paper;
    double w = live->request.width, h = live->request.height;
    if (width < 1 || height < 1)
        return true;
    if (width != place->width || height != place->height) {
        uint8_t *rgba = mem_alloc_zero((size_t)width * (size_t)height, 4);
        if (!rgba)
            return false;
        mem_free(paper->rgba);
        *paper = (struct paper){rgba, width, height, 1};
    }
    /* Letters of a size that can be read, and that leaves something of the picture. */
    double scale = floor(fmin(width / (440 * density), height / (330 * density)));
    paper->scale = (int)fmax(1, floor(density * fmax(1, fmin(scale, 2)) + 0.5));
    double fit = fmin(width / w, height / h);
    *place = (struct live_place){.width = width,
                                 .height = height,
                                 .density = density,
                                 .shown_width = fmax(1, floor(w * fit + 0.5)),
                                 .shown_height = fmax(1, floor(h * fit + 0.5))};
    place->left = floor((width - place->shown_width) / 2);
    place->top = floor((height - place->shown_height) / 2);
    live->over_dirty = true;
    (void)snprintf(live->note, sizeof live->note, "%.60s: window of %dx%d pixels, density %g, letters of %d",
                   live->request.file, width, height, density, paper->scale);
    return true;
}

/* The canvas. */

static void tone_pixel(const struct live *live, const struct tone *tone, size_t pixel) {
    float rgb[3];
    memcpy(rgb, live->light + 3 * pixel, sizeof rgb);
    if (live->has_lines)
        overlay_ink(live->lines[pixel], rgb);
    for (size_t c = 0; c < 3; c++)
        live->image[3 * pixel + c] = png_write_byte(tone_apply(tone, (double)rgb[c]));
}

static struct tone tone_of(const struct live *live) {
    const struct picture_request *request = &live->request;
    return (struct tone){request->exposure, (enum tone_curve)request->curve, request->srgb != 0};
}

void live_draw_again(struct live *live, size_t pixel) {
    struct tone tone = tone_of(live);
    tone_pixel(live, &tone, pixel);
}

void live_redraw(struct live *live) {
    struct tone tone = tone_of(live);
    for (size_t i = 0; i < (size_t)live->request.width * live->request.height; i++)
        tone_pixel(live, &tone, i);
    live->dirty = true;
}

/* One pixel of the film is a square of the canvas. */
static void draw_pixel(struct live *live, const struct tone *tone, uint32_t x, uint32_t y, bool red) {
    static const uint8_t mark[3] = {255, 0, 0};
    const struct picture_request *request = &live->request;
    uint32_t divide = live->view.divide;
    const float *colour = live->film.pixels[(size_t)y * live->film.width + x].rgb;
    size_t first = 0;
    bool begun = false;
    for (uint32_t v = y * divide; v < (y + 1) * divide && v < request->height; v++) {
        for (uint32_t u = x * divide; u < (x + 1) * divide && u < request->width; u++) {
            size_t pixel = (size_t)v * request->width + u;
            if (red) {
                memcpy(live->image + 3 * pixel, mark, 3);
                continue;
            }
            memcpy(live->light + 3 * pixel, colour, 3 * sizeof *colour);
            bool lined = live->has_lines && live->lines[pixel][3] < 1;
            if (!begun || lined)
                tone_pixel(live, tone, pixel);
            else
                memcpy(live->image + 3 * pixel, live->image + 3 * first, 3);
            first = lined || begun ? first : pixel;
            begun = begun || !lined;
        }
    }
}

/* Tiles that are finished, and in those under way the pixels that are being sampled again, in red. */
void live_draw_tiles(struct live *live) {
    const struct film *film = &live->film;
    struct tone tone = tone_of(live);
    for (uint32_t tile = 0; tile < film_tile_count(film); tile++) {
        uint8_t state = atomic_load_explicit(&film->tiles[tile], memory_order_acquire);
        bool done = state == FILM_TILE_DONE, under_way = state == FILM_TILE_TAKEN && !live->view.plain;
        if (live->drawn[tile] || (!done && !under_way))
            continue;
        struct film_rectangle r = film_tile_rectangle(film, tile);
        for (uint32_t y = r.y0 - film->y0; y < r.y1 - film->y0; y++) {
            for (uint32_t x = r.x0 - film->x0; x < r.x1 - film->x0; x++) {
                bool red = film->marked && film->marked[(size_t)y * film->width + x] == FILM_MARK_WAITS;
                if (done || red)
                    draw_pixel(live, &tone, x, y, red && !done);
            }
        }
        live->drawn[tile] = done;
        live->dirty = true;
    }
}

/* Figures. */

static void count_words(char *out, size_t size, double count, const char *what) {
    const char *unit = count >= 1e9 ? " G" : count >= 1e6 ? " M" : count >= 1e4 ? " k" : " ";
    double value = count >= 1e9 ? count * 1e-9 : count >= 1e6 ? count * 1e-6 : count >= 1e4 ? count * 1e-3 : count;
    (void)snprintf(out, size, "%.*f%s%s", count >= 1e4 && value < 100 ? 2 : 0, value, unit, what);
}

static uint32_t building_step(const struct live *live) {
    return live->control ? atomic_load_explicit(&live->control->build_step, memory_order_relaxed) : 0;
}

/* The picture itself by its work, with the time left once it is known (render/outlook.h); coarse ones by their tiles.
 */
static void tell_pass(const struct live *live, struct figures *figures, double now) {
    const struct outlook *outlook = live->control && !live->view.plain ? &live->control->outlook : NULL;
    double share = outlook ? outlook_share(outlook) : -1, left = outlook ? outlook_left(outlook, now) : -1;
    char time[48];
    figures->share = share >= 0 ? share : figures->share;
    text_time(left > 0 ? left : 0, time, sizeof time);
    (void)snprintf(figures->state, sizeof figures->state, left > 0 ? "%.0f %%%s, %s left" : "%.0f %%%s",
                   100 * figures->share, live->view.plain ? " (coarse)" : "", time);
}

static void tell_state(const struct live *live, struct figures *figures, double now) {
    uint32_t step = building_step(live);
    uint32_t done = live->block ? film_tiles_in(&live->film, FILM_TILE_DONE) : 0;
    uint32_t count = live->block ? film_tile_count(&live->film) : 0;
    figures->share = count > 0 ? (double)done / count : live->complete ? 1 : 0;
    if (live->halted && live->block) {
        (void)snprintf(figures->state, sizeof figures->state, live->unbuilt ? "stopped building" : "stopped, %.0f %%",
                       100 * figures->share);
    } else if (step > 0) {
        figures->share = 0.001 * atomic_load_explicit(&live->control->build_done, memory_order_relaxed);
        (void)snprintf(figures->state, sizeof figures->state, "building, step %u: %.0f %%", step, 100 * figures->share);
    } else if (!live->block) {
        (void)snprintf(figures->state, sizeof figures->state, "waiting for a change");
    } else if (live->report.threads == 0 && done == 0) {
        (void)snprintf(figures->state, sizeof figures->state, "building");
    } else if (live->complete) {
        (void)snprintf(figures->state, sizeof figures->state, live_is_idle(live) ? "ready" : "working");
    } else {
        tell_pass(live, figures, now);
    }
}

static void work_out(const struct live *live, struct figures *figures, double now) {
    const struct picture_report *report = &live->report;
    const struct render_statistics *rays = &report->rays;
    double seconds = rays->render_seconds;
    double traced = (double)rays->camera_rays + (double)rays->reflected_rays + (double)rays->refracted_rays +
                    (double)rays->shadow_rays;
    /* A hierarchy stands in one voxel that holds everything. */
    double voxels = 1;
    for (int i = 0; i < 3; i++)
        voxels *= report->grid_cells[i] > 1 ? report->grid_cells[i] : 1;
    *figures = (struct figures){0};
    tell_state(live, figures, now);
    (void)snprintf(figures->size, sizeof figures->size, "%ux%u", live->request.width, live->request.height);
    count_words(figures->rays, sizeof figures->rays, seconds > 0 ? traced / seconds : 0, "rays/s");
    count_words(figures->triangles, sizeof figures->triangles, (double)report->triangles, "triangles");
    count_words(figures->voxels, sizeof figures->voxels, voxels, voxels > 1 ? "voxels" : "voxel");
    (void)snprintf(figures->frames, sizeof figures->frames, seconds > 0 ? "%.*f frames/s" : "- frames/s",
                   seconds > 0.1 ? 2 : 0, seconds > 0 ? 1 / seconds : 0);
}

static void set_title(struct live *live, const struct figures *figures) {
    char title[1024];
    (void)snprintf(title, sizeof title, "%.200s  %s  %s  %s  %s  %s  %s%s", live->request.file, figures->size,
                   figures->state, figures->rays, figures->triangles, figures->voxels, figures->frames,
                   live->grabbed ? "  (Esc leaves)" : "");
    live->driver->title(live->driver->context, live->message[0] != '\0' ? live->message : title);
}

void live_show(struct live *live, double now) {
    const struct window_driver *driver = live->driver;
    bool due = now - live->told >= figures_pause;
    if (!live->panel.paper.rgba || (!due && !((live->dirty || live->over_dirty) && now - live->shown >= frame_pause)))
        return;
    bool over = due || live->over_dirty;
    if (over) {
        struct figures figures;
        live->over_dirty = false; /* what is used in the panel asks for another frame */
        work_out(live, &figures, now);
        live_tell_over(live, &figures);
        if (due)
            set_title(live, &figures);
        live->told = due ? now : live->told;
    }
    const struct live_place *place = &live->place;
    struct window_frame frame = {.picture = live->image,
                                 .width = live->request.width,
                                 .height = live->request.height,
                                 .picture_changed = live->dirty,
                                 .left = (int)place->left,
                                 .top = (int)place->top,
                                 .shown_width = (int)place->shown_width,
                                 .shown_height = (int)place->shown_height,
                                 .overlay = live->panel.paper.rgba,
                                 .window_width = (uint32_t)place->width,
                                 .window_height = (uint32_t)place->height,
                                 .overlay_changed = over};
    driver->show(driver->context, &frame);
    /* The picture that is on the screen now, coarse as it may be, is of the world that was built. */
    if (live->built > 0 && live->report.threads > 0) {
        (void)snprintf(live->note, sizeof live->note, "%.100s: on the screen %.1f ms after its world was built",
                       live->request.file, 1000 * (progress_clock() - live->built));
        live->built = 0;
    }
    live->shown = now;
    live->dirty = false;
}
