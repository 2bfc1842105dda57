/* The image is updated from the film tile by tile, and shown at most every 16 milliseconds; the lines over it and what
 * the widgets show are made anew only when they may have changed. */
#include "viewer/viewer_internal.h"

#include "base/clock.h"
#include "base/mem.h"
#include "light/light_edit.h"
#include "math/elementary.h"
#include "math/frame.h"
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
    double fit = math_min(width / w, height / h);
    if (layout->width == 0 && viewer->built > 0) /* the picture had to wait for the window */
        viewer->built = clock_now();
    *layout = (struct window_layout){.width = width,
                                     .height = height,
                                     .density = density,
                                     .shown_width = math_max(1, floor(w * fit + 0.5)),
                                     .shown_height = math_max(1, floor(h * fit + 0.5))};
    layout->left = floor((width - layout->shown_width) / 2);
    layout->top = floor((height - layout->shown_height) / 2);
    viewer->display.hud_dirty = true;
    (void)snprintf(viewer->note, sizeof viewer->note, "%.60s: picture of %dx%d pixels, density %g",
                   viewer->request.file, width, height, density);
}

/* The image. */

static void tone_pixel(const struct viewer *viewer, size_t pixel) {
    float rgb[3];
    memcpy(rgb, viewer->window.light + 3 * pixel, sizeof rgb);
    if (viewer->overlay.has_lines)
        overlay_blend(viewer->overlay.lines[pixel], rgb);
    tone_lookup_bytes(viewer->window.tones, rgb, 3, viewer->window.image + 3 * pixel);
}

static void begin_tone(const struct viewer *viewer) {
    const struct tone tone = picture_tone(&viewer->request);
    tone_lookup_set(viewer->window.tones, &tone);
}

/* One pixel of the image. */
static void draw_again(struct viewer *viewer, size_t pixel) {
    begin_tone(viewer);
    tone_pixel(viewer, pixel);
}

void viewer_redraw(struct viewer *viewer) {
    begin_tone(viewer);
    for (size_t i = 0; i < (size_t)viewer->request.width * viewer->request.height; i++)
        tone_pixel(viewer, i);
    viewer->window.dirty = true;
    viewer->window.large.stale = viewer->window.large.shown;
}

/* One pixel of the film is a square of the image. */
static void draw_pixel(struct viewer *viewer, uint32_t x, uint32_t y) {
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
                tone_pixel(viewer, pixel);
            else
                memcpy(viewer->window.image + 3 * pixel, viewer->window.image + 3 * first, 3);
            first = lined || begun ? first : pixel;
            begun = begun || !lined;
        }
    }
}

/* Pixels of the film that are pixels of the image. */
static void draw_row(struct viewer *viewer, uint32_t y, uint32_t first, uint32_t count) {
    const struct film *film = &viewer->pass.film;
    const size_t from = (size_t)y * film->width + first, to = (size_t)y * viewer->request.width + first;
    float *light = viewer->window.light + 3 * to;
    memcpy(light, &film->pixels[from], count * sizeof *film->pixels);
    tone_lookup_bytes(viewer->window.tones, light, (size_t)3 * count, viewer->window.image + 3 * to);
}
_Static_assert(sizeof(struct film_pixel) == 3 * sizeof(float), "a row of them is a row of floats");

/* The pixels of the film on both sides of the middle of a pixel, and how far it is to the second one, of 256. */
struct interpolation {
    uint32_t first, second, far;
};

static struct interpolation interpolate_pixels(uint32_t at, uint32_t divide, uint32_t count) {
    uint32_t middle = (256 * at + 128) / divide, first = middle < 128 ? 0 : (middle - 128) >> 8;
    return (struct interpolation){first, first + 1 < count ? first + 1 : first,
                                  middle < 128 ? 0 : (middle - 128) & 255};
}

static void blend(uint8_t *restrict out, const uint8_t *a, const uint8_t *b, uint32_t far, size_t count) {
    for (size_t i = 0; i < count; i++)
        out[i] = (uint8_t)((a[i] * (256 - far) + b[i] * far) >> 8);
}

/* A row of the film as bytes, enlarged to the width of the picture. small: room for the former. */
static void enlarge_row(const struct viewer *viewer, const struct tone_bytes *bytes, uint32_t y, uint8_t *small,
                        uint8_t *out) {
    const struct film *film = &viewer->pass.film;
    for (size_t i = 0; i < film->width; i++)
        for (size_t c = 0; c < 3; c++)
            small[3 * i + c] = tone_byte(bytes, film->pixels[y * film->width + i].rgb[c]);
    for (uint32_t x = 0; x < viewer->request.width; x++) {
        struct interpolation u = interpolate_pixels(x, viewer->pass.view.divide, film->width);
        blend(out + (size_t)3 * x, small + (size_t)3 * u.first, small + (size_t)3 * u.second, u.far, 3);
    }
}

/* A pass with fewer pixels, enlarged smoothly: what it shows is replaced soon. */
static bool draw_smooth(struct viewer *viewer) {
    const struct film *film = &viewer->pass.film;
    size_t row = (size_t)3 * viewer->request.width;
    struct tone tone = picture_tone(&viewer->request);
    struct tone_bytes bytes;
    uint8_t *rows = mem_alloc_zero(3, row); /* two rows of the film, enlarged */
    uint32_t done = 0;                      /* rows of the film */
    if (!rows)
        return false;
    tone_bytes_make(&tone, &bytes);
    for (uint32_t y = 0; y < viewer->request.height; y++) {
        struct interpolation v = interpolate_pixels(y, viewer->pass.view.divide, film->height);
        for (; done <= v.second; done++)
            enlarge_row(viewer, &bytes, done, rows + 2 * row, rows + done % 2 * row);
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
    bool smooth = (view->plain || view->samples > 0) && view->divide > 1 && !viewer->overlay.has_lines;
    bool denoised = !view->plain && viewer_shows_denoised(viewer);
    if (smooth && (viewer->pass.result != RESULT_COARSE || draw_smooth(viewer)))
        return;
    begin_tone(viewer);
    const bool in_rows = view->divide == 1 && !viewer->overlay.has_lines;
    for (uint32_t tile = 0; tile < film_tile_count(film); tile++) {
        uint8_t state = atomic_load_explicit(&film->tiles[tile], memory_order_acquire);
        bool shows = denoised ? state == FILM_TILE_DONE : film_tile_shows(state);
        if (!shows || viewer->window.drawn[tile] == state)
            continue;
        struct film_rectangle r = film_tile_rectangle(film, tile);
        for (uint32_t y = r.y0 - film->y0; y < r.y1 - film->y0; y++) {
            if (in_rows)
                draw_row(viewer, y, r.x0 - film->x0, r.x1 - r.x0);
            for (uint32_t x = r.x0 - film->x0; x < r.x1 - film->x0 && !in_rows; x++)
                draw_pixel(viewer, x, y);
        }
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
    } else if (control && atomic_load_explicit(&control->unshot, memory_order_relaxed) > 0) {
        (void)snprintf(words, size, "%.3g %% of the light is not shot",
                       100 * (double)atomic_load_explicit(&control->unshot, memory_order_relaxed));
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
    state->frame[0] = '\0';
    if (report->threads == 0)
        return;
    add_count(text, sizeof state->figures, seconds > 0 ? traced / seconds : 0, "rays/s");
    add_count(text, sizeof state->figures, (double)report->triangles, "triangles");
    add_count(text, sizeof state->figures, voxels, voxels > 1 ? "voxels" : "voxel");
    double rate = viewer_plays(viewer) ? viewer->player.rate : seconds > 0 ? 1 / seconds : 0;
    size_t used = strlen(text);
    (void)snprintf(text + used, sizeof state->figures - used, ", %.*f frames/s", rate < 10 ? 2 : rate < 100, rate);
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
    state->unsaved = edits_differ(&viewer->edit.steps, viewer->edit.saved_at);
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
    if (viewer->edit.selection.kind == SELECTED_LIGHT)
        state->selected = (struct node_query){.depth = 2, .path = {SECTION_LIGHTS, viewer->edit.selection.light - 1}};
    else if (viewer->edit.selection.kind != SELECTED_NOTHING)
        state->selected = viewer->edit.selection.picked.path;
    state->hidden_count = 0;
    for (uint32_t i = 0; i < viewer->edit.steps.now.count && state->hidden_count < WINDOW_HIDDEN; i++) {
        enum change_kind kind = viewer->edit.steps.now.items[i].kind;
        if (kind == CHANGE_GONE || kind == CHANGE_HIDDEN)
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

/* --- What is drawn over the picture --- */

/* What is drawn over the picture. The lines of --overlay are part of the image that is shown and saved; the outline of
 * the selection and the symbols of lights are lines that the window draws over it. While the camera moves, there are
 * fewer lines of --overlay with coarse depth, and the outline is a box; both are made again before the finest pass
 * continues. */

enum { BOXES_WALKING = 1500 };

void viewer_invalidate_overlay(struct viewer *viewer) {
    viewer->overlay.lines_fresh = viewer->overlay.outline_fresh = false;
}

bool viewer_needs_overlay(const struct viewer *viewer) {
    bool lines = viewer->overlay.kind != OVERLAY_NONE && !viewer->overlay.lines_fresh;
    bool outline = viewer->edit.selection.kind == SELECTED_NODE && !viewer->overlay.outline_fresh;
    return (lines || outline) && !viewer->pass.unbuilt;
}

struct view_overlay_request viewer_overlay_request(const struct viewer *viewer, bool walking) {
    bool outline = viewer->edit.selection.kind == SELECTED_NODE && !walking;
    return (struct view_overlay_request){
        .lines = {viewer->overlay.kind, walking ? BOXES_WALKING : OVERLAY_BOXES, walking ? viewer->pass.divide : 1},
        .outline = outline,
        .serial = outline ? viewer->edit.selection.picked.serial : 0,
        .route = outline ? viewer->edit.selection.picked.route : 0,
        .solid = outline ? viewer->edit.selection.picked.solid : 0};
}

void viewer_choose_overlay(struct viewer *viewer, enum overlay overlay) {
    viewer->overlay.kind = viewer->overlay.kind == overlay ? OVERLAY_NONE : overlay;
    viewer->overlay.lines_fresh = false;
    viewer->display.hud_dirty = true;
    if (viewer->overlay.kind != OVERLAY_NONE)
        return;
    viewer->overlay.has_lines = false;
    viewer_redraw(viewer);
}

static void take_lines(struct viewer *viewer, const struct view_overlay_buffers *buffers) {
    size_t pixels = (size_t)viewer->request.width * viewer->request.height;
    if (!viewer->overlay.lines)
        viewer->overlay.lines = mem_alloc_zero(pixels, sizeof *viewer->overlay.lines);
    if (!viewer->overlay.lines)
        return;
    bool had = viewer->overlay.has_lines;
    viewer->overlay.has_lines = true;
    for (size_t i = 0; i < pixels; i++) {
        bool other = memcmp(viewer->overlay.lines[i], buffers->lines[i], sizeof viewer->overlay.lines[i]) != 0;
        if (other)
            memcpy(viewer->overlay.lines[i], buffers->lines[i], sizeof viewer->overlay.lines[i]);
        if (other || (!had && viewer->overlay.lines[i][3] < 1))
            draw_again(viewer, i);
    }
    viewer->window.dirty = true;
    viewer->window.large.stale = viewer->window.large.shown;
}

/* The outline. */

struct silhouette {
    const uint8_t *shows;
    uint32_t width;
    struct film_rectangle area; /* outside it the node is not visible */
};

/* Whether the node is visible on one side of the line `across` and not on the other, beside the pixel `along` it. */
static bool is_edge(const struct silhouette *s, bool upright, uint32_t across, uint32_t along) {
    bool sides[2];
    for (uint32_t i = 0; i < 2; i++) {
        uint32_t x = upright ? across - i : along, y = upright ? along : across - i;
        bool inside = x >= s->area.x0 && x < s->area.x1 && y >= s->area.y0 && y < s->area.y1;
        sides[i] = inside && s->shows[(size_t)y * s->width + x];
    }
    return sides[0] != sides[1];
}

/* The edges between a pixel that shows the node and one that does not, in runs. There are none at the borders of the
 * picture. An outline of too many runs is none. */
static void take_outline(struct viewer *viewer, const struct silhouette *s) {
    enum { LIMIT = WINDOW_LINES / 2 };
    struct viewer_overlay *overlay = &viewer->overlay;
    if (!overlay->outline)
        overlay->outline = mem_alloc_zero(LIMIT, sizeof *overlay->outline);
    for (int upright = 0; upright < 2; upright++) {
        uint32_t first = upright ? s->area.x0 : s->area.y0, last = upright ? s->area.x1 : s->area.y1;
        uint32_t end = upright ? viewer->request.width : viewer->request.height;
        uint32_t from = upright ? s->area.y0 : s->area.x0, to = upright ? s->area.y1 : s->area.x1;
        for (uint32_t across = first > 0 ? first : 1; across <= last && across < end; across++) {
            for (uint32_t along = from, run; along < to; along = run + 1) {
                for (run = along; run < to && is_edge(s, upright, across, run);)
                    run++;
                float a = (float)along, b = (float)run, c = (float)across;
                if (run > along && overlay->outline && overlay->outline_count < LIMIT)
                    overlay->outline[overlay->outline_count++] =
                        upright ? (struct window_line){c, a, c, b, LINE_COLOUR_SELECTED}
                                : (struct window_line){a, c, b, c, LINE_COLOUR_SELECTED};
            }
        }
    }
    overlay->outline_count = overlay->outline_count < LIMIT ? overlay->outline_count : 0;
}

void viewer_receive_overlay(struct viewer *viewer, const struct view_overlay_request *request,
                            const struct view_overlay *overlay) {
    struct view_overlay_buffers buffers = {0};
    struct view_overlay_request now = viewer_overlay_request(viewer, false);
    if (overlay->stopped)
        return;
    if (overlay->has_lines || overlay->has_outline)
        view_overlay_buffers(&viewer->request, viewer->block, &buffers);
    if (request->lines.kind == viewer->overlay.kind && viewer->overlay.kind != OVERLAY_NONE) {
        if (overlay->has_lines)
            take_lines(viewer, &buffers);
        viewer->overlay.lines_fresh = request->lines.cell == 1 && request->lines.limit == OVERLAY_BOXES;
    }
    if (request->outline && request->serial == now.serial && request->route == now.route) {
        struct silhouette s = {buffers.shows, viewer->request.width, overlay->outline};
        s.area.x1 = s.area.x1 < s.width ? s.area.x1 : s.width;
        s.area.y1 = s.area.y1 < viewer->request.height ? s.area.y1 : viewer->request.height;
        viewer->overlay.outline_count = 0;
        if (overlay->has_outline)
            take_outline(viewer, &s);
        viewer->overlay.outline_fresh = true;
    }
    viewer->display.hud_dirty = true;
}

/* Lines over the picture. */

struct drawing {
    struct viewer *viewer;
    struct camera_frame frame;
};

/* Lines beyond the limit are not drawn. */
static void draw(const struct drawing *drawing, double x0, double y0, double x1, double y1, enum line_colour colour) {
    struct window_state *state = drawing->viewer->window.driver->state;
    if (state->line_count < WINDOW_LINES)
        state->lines[state->line_count++] = (struct window_line){(float)x0, (float)y0, (float)x1, (float)y1, colour};
}

/* In short pieces, since a line is not straight in every projection, and may begin behind the camera. */
static void draw_edge(const struct drawing *drawing, struct vec3 a, struct vec3 b, enum line_colour colour) {
    enum { PIECES = 12 };
    double x0 = 0, y0 = 0, x1, y1;
    bool had = false, straight = drawing->viewer->request.settings.lens.projection == PROJECTION_PERSPECTIVE;
    int pieces = straight && viewer_project(drawing->viewer, &drawing->frame, a, &x0, &y0) &&
                         viewer_project(drawing->viewer, &drawing->frame, b, &x1, &y1)
                     ? 1
                     : PIECES;
    for (int i = 0; i <= pieces; i++) {
        struct vec3 p = vec3_add_scaled(a, vec3_sub(b, a), (double)i / pieces);
        bool has = viewer_project(drawing->viewer, &drawing->frame, p, &x1, &y1);
        if (has && had)
            draw(drawing, x0, y0, x1, y1, colour);
        had = has;
        x0 = x1;
        y0 = y1;
    }
}

/* A circle about an axis (unit). */
static void draw_circle(const struct drawing *drawing, struct vec3 centre, struct vec3 axis, double radius,
                        enum line_colour colour) {
    enum { SIDES = 24 };
    struct vec3 right, up, from = centre;
    frame_tangents(axis, &right, &up);
    for (int i = 0; i <= SIDES; i++) {
        double sine, cosine;
        el_sincos(2 * PI * i / SIDES, &sine, &cosine);
        struct vec3 to = vec3_add_scaled(vec3_add_scaled(centre, right, radius * cosine), up, radius * sine);
        if (i > 0)
            draw_edge(drawing, from, to, colour);
        from = to;
    }
}

static void draw_ring(const struct drawing *drawing, double x, double y, double radius, enum line_colour colour) {
    enum { SIDES = 16 };
    for (int i = 0; i < SIDES; i++) {
        double s0, c0, s1, c1;
        el_sincos(2 * PI * i / SIDES, &s0, &c0);
        el_sincos(2 * PI * (i + 1) / SIDES, &s1, &c1);
        draw(drawing, x + radius * c0, y + radius * s0, x + radius * c1, y + radius * s1, colour);
    }
}

/* False: the outline is out of date, or there is none. */
static bool draw_outline(const struct drawing *drawing) {
    const struct viewer *viewer = drawing->viewer;
    const struct window_layout *layout = &viewer->window.layout;
    double zoom = layout->shown_width / viewer->request.width;
    if (!viewer->overlay.outline_fresh || viewer->pass.outdated || viewer->edit.pending.count > 0)
        return false;
    for (uint32_t i = 0; i < viewer->overlay.outline_count; i++) {
        const struct window_line *line = &viewer->overlay.outline[i];
        draw(drawing, layout->left + (double)line->x0 * zoom, layout->top + (double)line->y0 * zoom,
             layout->left + (double)line->x1 * zoom, layout->top + (double)line->y1 * zoom, LINE_COLOUR_SELECTED);
    }
    return viewer->overlay.outline_count > 0;
}

static void draw_node(const struct drawing *drawing) {
    const struct picked *picked = &drawing->viewer->edit.selection.picked;
    struct vec3 corners[8];
    double x, y;
    if (viewer_project(drawing->viewer, &drawing->frame, viewer_moved_point(drawing->viewer, picked->position), &x, &y))
        draw_ring(drawing, x, y, 3 * drawing->viewer->window.layout.density, LINE_COLOUR_SELECTED);
    /* Large parts of an operand may be invisible: its box shows its position. */
    if ((draw_outline(drawing) && picked->solid == 0) || !picked->has_box)
        return;
    for (int i = 0; i < 8; i++)
        corners[i] = viewer_moved_point(drawing->viewer, picked->corners[i]);
    for (int i = 0; i < 8; i++) {
        for (int axis = 1; axis < 8; axis *= 2) {
            if (!(i & axis))
                draw_edge(drawing, corners[i], corners[i | axis], LINE_COLOUR_SELECTED);
        }
    }
}

/* The extent and direction of the selected light. */
static void draw_light(const struct drawing *drawing, const struct light_info *light) {
    struct vec3 at = light->position, a = vec3_scale(light->edge1, 0.5), b = vec3_scale(light->edge2, 0.5);
    double extent = 0.2 * vec3_length(vec3_sub(at, drawing->frame.eye));
    struct vec3 corners[4] = {vec3_add(at, vec3_add(a, b)), vec3_add(at, vec3_sub(a, b)), vec3_sub(at, vec3_add(a, b)),
                              vec3_sub(at, vec3_sub(a, b))};
    uint32_t has = light->properties;
    for (int i = 0; (has & LIGHT_HAS_EDGES) && i < 4; i++)
        draw_edge(drawing, corners[i], corners[(i + 1) % 4], LINE_COLOUR_SELECTED);
    if (has & LIGHT_HAS_RADIUS) {
        struct vec3 to_eye = vec3_normalize(vec3_sub(drawing->frame.eye, at));
        draw_circle(drawing, at, has & LIGHT_HAS_DIRECTION ? light->direction : to_eye, light->radius,
                    LINE_COLOUR_SELECTED);
    }
    if (has & LIGHT_HAS_CONE) {
        double along = light->cos_outer, aside = sqrt(math_max(0, 1 - along * along));
        draw_circle(drawing, vec3_add_scaled(at, light->direction, extent * along), light->direction, extent * aside,
                    LINE_COLOUR_SELECTED);
    }
    if (!(has & LIGHT_HAS_DIRECTION))
        return;
    /* An arrow; that of a light without a position goes through the middle of the view. */
    double half = 0.15 * vec3_length(vec3_sub(drawing->viewer->fly_camera.centre, drawing->frame.eye));
    struct vec3 from = at, tip = vec3_add_scaled(at, light->direction, extent), right, up;
    if (!light->has_position) {
        from = vec3_add_scaled(drawing->viewer->fly_camera.centre, light->direction, -half);
        tip = vec3_add_scaled(from, light->direction, 2 * half);
        frame_tangents(light->direction, &right, &up);
        struct vec3 back = vec3_add_scaled(tip, light->direction, -0.3 * half);
        draw_edge(drawing, vec3_add_scaled(back, right, 0.12 * half), tip, LINE_COLOUR_SELECTED);
        draw_edge(drawing, vec3_add_scaled(back, right, -0.12 * half), tip, LINE_COLOUR_SELECTED);
    }
    draw_edge(drawing, from, tip, LINE_COLOUR_SELECTED);
}

/* A small lamp: a ring with a cross, of a light far away with rays. */
static void draw_symbol(const struct drawing *drawing, uint32_t number) {
    const struct viewer *viewer = drawing->viewer;
    const struct light_info *light = viewer_light(viewer, number);
    bool chosen = viewer->edit.selection.kind == SELECTED_LIGHT && viewer->edit.selection.light == number, seen;
    double x, y, r = 5 * viewer->window.layout.density;
    if (!viewer_light_marker(viewer, &drawing->frame, number, &x, &y, &seen))
        return;
    enum line_colour colour = chosen ? LINE_COLOUR_SELECTED : seen ? LINE_COLOUR_LIGHT : LINE_COLOUR_FAINT;
    draw_ring(drawing, x, y, chosen ? 1.5 * r : r, colour);
    draw(drawing, x - r / 2, y, x + r / 2, y, colour);
    if (!(light->properties & LIGHT_IS_ENVIRONMENT))
        draw(drawing, x, y - r / 2, x, y + r / 2, colour);
    bool distant = !light->has_position && (light->properties & LIGHT_HAS_DIRECTION);
    for (int ray = 0; distant && ray < 4; ray++) {
        double u = ray < 2 ? r : -r, v = ray % 2 ? r : -r;
        draw(drawing, x + u, y + v, x + 1.6 * u, y + 1.6 * v, colour);
    }
}

/* The cube in the upper right corner: the faces that look at the eye, with the letters of their axes. A click on one
 * looks along its axis. */

static const struct vec3 cube_axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
static const double cube_size = 22, cube_margin = 46; /* half of an edge, and of the corner, in dots of the desktop */

/* A point of the face in pixels of the window; u and v along its edges, from -1 to 1. */
static void cube_point(const struct viewer *viewer, const struct camera_frame *frame, int face, const double uv[2],
                       double out[2]) {
    const struct window_layout *layout = &viewer->window.layout;
    int axis = face / 2;
    double sign = face % 2 ? -1 : 1, size = cube_size * layout->density;
    struct vec3 p = vec3_scale(cube_axes[axis], sign);
    p = vec3_add_scaled(p, cube_axes[(axis + 1) % 3], uv[0]);
    p = vec3_add_scaled(p, cube_axes[(axis + 2) % 3], uv[1]);
    out[0] = math_min(layout->left + layout->shown_width, layout->width) - cube_margin * layout->density +
             size * vec3_dot(p, frame->unit_right);
    out[1] = math_max(layout->top, 0) + cube_margin * layout->density + size * vec3_dot(p, frame->unit_down);
}

static bool faces_eye(const struct camera_frame *frame, int face) {
    double along = vec3_dot(cube_axes[face / 2], frame->forward) / vec3_length(frame->forward);
    return (face % 2 ? along : -along) > 0.05;
}

bool viewer_click_cube(struct viewer *viewer, double x, double y) {
    static const double corners[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    struct camera_frame frame;
    if (viewer->window.hides_lines || !viewer_camera_frame(viewer, &frame))
        return false;
    for (int face = 0; face < 6; face++) {
        int left = 0, right = 0;
        for (int i = 0; i < 4 && faces_eye(&frame, face); i++) {
            double a[2], b[2];
            cube_point(viewer, &frame, face, corners[i], a);
            cube_point(viewer, &frame, face, corners[(i + 1) % 4], b);
            double side = (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
            left += side > 0;
            right += side < 0;
        }
        if (left != 4 && right != 4)
            continue;
        fly_camera_face(&viewer->fly_camera, vec3_scale(cube_axes[face / 2], face % 2 ? 1 : -1));
        return true;
    }
    return false;
}

static void draw_cube(const struct drawing *drawing) {
    /* Strokes of the letters, and those of a minus before them: pairs of points of the face. */
    static const double strokes[3][3][4] = {{{-.3, -.4, .3, .4}, {-.3, .4, .3, -.4}, {0, 0, 0, 0}},
                                            {{0, -.4, 0, 0}, {0, 0, -.3, .4}, {0, 0, .3, .4}},
                                            {{-.3, .4, .3, .4}, {.3, .4, -.3, -.4}, {-.3, -.4, .3, -.4}}};
    static const double edges[4][4] = {{-1, -1, 1, -1}, {1, -1, 1, 1}, {1, 1, -1, 1}, {-1, 1, -1, -1}},
                        minus[4] = {-.7, 0, -.45, 0};
    for (int face = 0; face < 6; face++) {
        for (int i = 0; i < 8 && faces_eye(&drawing->frame, face); i++) {
            const double *stroke = i < 4 ? edges[i] : i < 7 ? strokes[face / 2][i - 4] : minus;
            double a[2], b[2];
            if (i == 7 && face % 2 == 0)
                continue;
            cube_point(drawing->viewer, &drawing->frame, face, stroke, a);
            cube_point(drawing->viewer, &drawing->frame, face, stroke + 2, b);
            draw(drawing, a[0], a[1], b[0], b[1],
                 i < 4 ? LINE_COLOUR_FAINT : (enum line_colour)(LINE_COLOUR_X + face / 2));
        }
    }
}

/* Of the selection, where nothing is being done with it; while a handle is held, that handle. */
static void draw_handles(const struct drawing *drawing) {
    const struct viewer *viewer = drawing->viewer;
    for (enum edit_tool tool = TOOL_MOVE; tool <= TOOL_SIZE; tool++) {
        for (int axis = 0; axis < 3; axis++) {
            bool free = viewer->edit.tool == TOOL_NONE,
                 held = viewer->edit.tool == tool && (viewer->edit.axis == 0 || viewer->edit.axis == axis + 1);
            enum line_colour colour = (enum line_colour)(LINE_COLOUR_X + axis);
            double points[HANDLE_POINTS][2], density = viewer->window.layout.density;
            if (!(free || held) || !viewer_handle(viewer, &drawing->frame, tool, axis, points))
                continue;
            for (int i = 1; i < HANDLE_POINTS; i++)
                draw(drawing, points[i - 1][0], points[i - 1][1], points[i][0], points[i][1], colour);
            const double *end = points[HANDLE_POINTS - 1];
            if (tool != TOOL_TURN)
                draw_ring(drawing, end[0], end[1], (tool == TOOL_MOVE ? 2.5 : 4) * density, colour);
        }
    }
}

/* Outline and symbols. */
static void make_lines(struct viewer *viewer) {
    struct drawing drawing = {.viewer = viewer};
    viewer->window.driver->state->line_count = 0;
    if (!viewer->block || viewer->window.hides_lines || !viewer_camera_frame(viewer, &drawing.frame))
        return;
    if (viewer->edit.selection.kind == SELECTED_NODE)
        draw_node(&drawing);
    for (uint32_t i = 1; i <= viewer->lights.known; i++)
        draw_symbol(&drawing, i);
    const struct light_info *light = viewer_light(viewer, viewer->edit.selection.light);
    if (viewer->edit.selection.kind == SELECTED_LIGHT && light)
        draw_light(&drawing, light);
    draw_handles(&drawing);
    draw_cube(&drawing);
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
        make_lines(viewer);
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

void viewer_destroy_overlay(struct viewer *viewer) {
    mem_free(viewer->overlay.lines);
    mem_free(viewer->overlay.outline);
    viewer->overlay.lines = NULL;
    viewer->overlay.outline = NULL;
    viewer->overlay.outline_count = 0;
    viewer->overlay.has_lines = false;
    viewer_invalidate_overlay(viewer);
}
