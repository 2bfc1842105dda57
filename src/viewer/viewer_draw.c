/* The image is updated from the film tile by tile; the menu and the figures are drawn over it. The window is drawn at
 * most every 16 milliseconds, and the drawing over the picture only when it may have changed. */
#include "viewer/viewer_internal.h"

#include "base/clock.h"
#include "base/mem.h"
#include "image/png_write.h"
#include "session/text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

struct figures {
    char state[64], size[48], rays[48], triangles[48], voxels[64], frames[48], frame[64];
    double share; /* of the work */
};

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
    /* A pixel of a coarse pass covers a square; only lines over it make its pixels differ. */
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

/* Bytes between those of four pixels of a row of 3 bytes each: part of 256. */
static void blend_row(uint8_t *out, const uint8_t *above, const uint8_t *below, uint32_t down, uint32_t width) {
    for (size_t i = 0; i < (size_t)3 * width; i++)
        out[i] = (uint8_t)((above[i] * (256 - down) + below[i] * down) >> 8);
}

/* A pass of few samples, enlarged smoothly: what it shows is replaced soon. */
static bool draw_smooth(struct viewer *viewer) {
    const struct film *film = &viewer->pass.film;
    uint32_t width = film->width, divide = viewer->pass.view.divide;
    struct tone tone = picture_tone(&viewer->request);
    uint8_t *small = mem_alloc_zero((size_t)3 * width, (size_t)film->height + 1), *row = small;
    if (!small)
        return false;
    for (size_t i = 0; i < (size_t)width * film->height; i++)
        for (size_t c = 0; c < 3; c++)
            small[3 * i + c] = png_write_byte(tone_apply(&tone, (double)film->pixels[i].rgb[c]));
    row += (size_t)3 * width * film->height;
    /* A row between two of the film, then pixels between two of that; positions in parts of 256, of pixels' middles. */
    for (uint32_t y = 0; y < viewer->request.height; y++) {
        uint8_t *out = viewer->window.image + (size_t)3 * viewer->request.width * y;
        uint32_t v = (256 * y + 128) / divide, v0 = v < 128 ? 0 : (v - 128) >> 8,
                 v1 = v0 + 1 < film->height ? v0 + 1 : v0;
        blend_row(row, small + (size_t)3 * width * v0, small + (size_t)3 * width * v1, v < 128 ? 0 : (v - 128) & 255,
                  width);
        for (uint32_t x = 0; x < viewer->request.width; x++) {
            uint32_t u = (256 * x + 128) / divide, u0 = u < 128 ? 0 : (u - 128) >> 8, u1 = u0 + 1 < width ? u0 + 1 : u0;
            blend_row(out + (size_t)3 * x, row + (size_t)3 * u0, row + (size_t)3 * u1, u < 128 ? 0 : (u - 128) & 255,
                      1);
        }
    }
    mem_free(small);
    viewer->window.dirty = true;
    return true;
}

/* Draws tiles that are finished or, after a pass over the picture, have more samples than before. In tiles in progress,
 * pixels that are being sampled again are red. */
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
        bool in_progress = state == FILM_TILE_TAKEN && !viewer->pass.view.plain && !viewer_has_widgets(viewer);
        /* Only what has changed since the last time. */
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
    /* From what the user has asked for to what the render process does. */
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

/* --- over the picture --- */

/* Draws over the picture: the outline of the selection, markers of the lights, the menu, the figures, and the
 * selection's properties. Everything is drawn again for every frame; a click has its effect immediately. */

static const struct canvas_colour outline = {255, 190, 60, 255}, gray = {170, 176, 186, 255};

/* On the picture. */

static void draw_selection(struct viewer *viewer, const struct camera_frame *frame) {
    const struct picked *picked = &viewer->edit.selection.picked;
    struct vec3 corners[8];
    if (viewer->edit.selection.kind != SELECTED_NODE)
        return;
    double x, y;
    if (viewer_project(viewer, frame, viewer_moved_point(viewer, picked->position), &x, &y))
        canvas_ring(&viewer->window.panel.canvas, x, y, 3 * viewer->window.panel.canvas.scale, outline);
    /* Large parts of an operand may be invisible: its box shows its position. */
    if (viewer_draw_outline(viewer, outline) && picked->solid == 0)
        return;
    for (int i = 0; i < 8 && picked->has_box; i++)
        corners[i] = viewer_moved_point(viewer, picked->corners[i]);
    for (int i = 0; i < 8 && picked->has_box; i++) {
        for (int axis = 1; axis < 8; axis *= 2) {
            if (!(i & axis))
                viewer_draw_edge(viewer, frame, corners[i], corners[i | axis], outline);
        }
    }
}

/* The menu. */

#define MENU(X)                                                                                                        \
    X(MENU_RENDER, "Render")                                                                                           \
    X(MENU_QUIT, "Quit")                                                                                               \
    X(MENU_STOP, "Stop")                                                                                               \
    X(MENU_SAVE_PICTURE, "Save picture")                                                                               \
    X(MENU_SAVE_VIEW, "Save view")                                                                                     \
    X(MENU_SAVE_CHANGES, "Save changes")                                                                               \
    X(MENU_HIDE, "Hide")                                                                                               \
    X(MENU_LIGHTS, "Lights")                                                                                           \
    X(MENU_BOXES, "Boxes")                                                                                             \
    X(MENU_GRID, "Grid")
enum { MENU(LIST_MEMBER) };

static void draw_menu(struct viewer *viewer) {
    static const char *const words[] = {MENU(LIST_WORD)};
    struct panel *panel = &viewer->window.panel;
    bool used[LIST_COUNT(MENU)] = {false};
    unsigned on = (viewer->pass.halted ? 1u << MENU_STOP : 0) |
                  (viewer->overlay.kind == OVERLAY_OF_BOXES ? 1u << MENU_BOXES : 0) |
                  (viewer->overlay.kind == OVERLAY_OF_GRID ? 1u << MENU_GRID : 0);
    panel_ground(panel, 0, 0, panel->canvas.width, 15 * panel->canvas.scale);
    (void)panel_button_row(panel, 2 * panel->canvas.scale, words, LIST_COUNT(MENU), on, used);
    if (used[MENU_RENDER])
        viewer_render(viewer);
    viewer->quit = viewer->quit || used[MENU_QUIT];
    if (used[MENU_STOP])
        viewer_halt(viewer, !viewer->pass.halted);
    if (viewer->name[0] == '\0') /* no picture yet */
        used[MENU_SAVE_PICTURE] = used[MENU_SAVE_CHANGES] = false;
    if (used[MENU_SAVE_PICTURE])
        viewer->action = VIEWER_SAVE_IMAGE;
    else if (used[MENU_SAVE_VIEW] && viewer->block)
        viewer->action = VIEWER_SAVE_CAMERA;
    else if (used[MENU_SAVE_CHANGES])
        viewer->action = VIEWER_SAVE_EDITS;
    viewer->window.hides_hud = viewer->window.hides_hud || used[MENU_HIDE];
    if (used[MENU_BOXES] || used[MENU_GRID])
        viewer_choose_overlay(viewer, used[MENU_BOXES] ? OVERLAY_OF_BOXES : OVERLAY_OF_GRID);
    viewer->lights.listed = viewer->lights.listed != used[MENU_LIGHTS];
}

/* The animation: a row at the bottom. Its controls come first, because they also exist between two frames, when others
 * do not, and so keep their numbers. Returns its top. */
static int draw_timeline(struct viewer *viewer, const struct figures *figures) {
    struct panel *panel = &viewer->window.panel;
    struct viewer_player *player = &viewer->player;
    int scale = panel->canvas.scale, height = 15 * scale, top = panel->canvas.height - height, x = 2 * scale;
    if (player->count == 0)
        return panel->canvas.height;
    const char *const words[] = {player->playing ? "Pause" : "Play ", "Loop"};
    bool used[] = {false, false};
    panel_ground(panel, 0, top, panel->canvas.width, height);
    x = panel_button_row(panel, top + 2 * scale, words, 2, player->loops ? 2 : 0, used);
    if (used[0])
        viewer_play(viewer, !player->playing);
    if (used[1])
        viewer_player_loop(viewer);
    int words_width = (int)(strlen(figures->frame) + 2) * CANVAS_CELL * scale;
    int width = panel->canvas.width - x - words_width - 4 * scale;
    double index = viewer_frame_index(viewer);
    const struct panel_slider slider = {x + 2 * scale, top + 4 * scale, width, 0, player->count - 1.0, gray};
    if (width > 8 * CANVAS_CELL * scale && player->count > 1 && panel_slider(panel, &slider, &index))
        viewer_go_to_frame(viewer, viewer_frame_number(viewer, index));
    panel_text(panel, panel->canvas.width - words_width + CANVAS_CELL * scale, top + 4 * scale, figures->frame);
    return top;
}

/* Undoing, adding, exposure: a second row. */
#define WORK(X)                                                                                                        \
    X(WORK_UNDO, "Undo")                                                                                               \
    X(WORK_REDO, "Redo")                                                                                               \
    X(WORK_SPHERE, "Sphere")                                                                                           \
    X(WORK_CUBE, "Cube")                                                                                               \
    X(WORK_CYLINDER, "Cylinder")                                                                                       \
    X(WORK_CONE, "Cone")                                                                                               \
    X(WORK_TORUS, "Torus")                                                                                             \
    X(WORK_LIGHT, "Light")
enum { WORK(LIST_MEMBER) };

static void draw_work(struct viewer *viewer) {
    static const char *const words[] = {WORK(LIST_WORD)};
    struct panel *panel = &viewer->window.panel;
    int scale = panel->canvas.scale, y = 17 * scale, wide = 10 * CANVAS_CELL * scale;
    bool used[LIST_COUNT(WORK)] = {false};
    panel_ground(panel, 0, 15 * scale, panel->canvas.width, 15 * scale);
    /* The slider of the exposure comes behind the buttons, if there is room. */
    int x = panel_button_row(panel, y, words, LIST_COUNT(WORK), 0, used);
    if (used[WORK_UNDO] || used[WORK_REDO])
        viewer_undo(viewer, used[WORK_REDO]);
    if (used[WORK_SPHERE])
        viewer_add_node(viewer, ADDED_SPHERE);
    if (used[WORK_CUBE])
        viewer_add_node(viewer, ADDED_CUBE);
    if (used[WORK_CYLINDER])
        viewer_add_node(viewer, ADDED_CYLINDER);
    if (used[WORK_CONE])
        viewer_add_node(viewer, ADDED_CONE);
    if (used[WORK_TORUS])
        viewer_add_node(viewer, ADDED_TORUS);
    if (used[WORK_LIGHT])
        viewer_add_light(viewer);
    char text[48];
    double stops = viewer->request.settings.tone.exposure;
    (void)snprintf(text, sizeof text, "%+.2f stops", stops);
    if (x + 2 * wide > panel->canvas.width)
        return;
    const struct panel_slider slider = {x + 2 * scale, y + 2 * scale, wide, -4, 4, gray};
    if (panel_slider(panel, &slider, &stops))
        viewer_set_exposure(viewer, stops);
    panel_text(panel, x + 4 * scale + wide, y + 2 * scale, text);
}

static int draw_figures(struct viewer *viewer, const struct figures *figures, int top) {
    struct panel *panel = &viewer->window.panel;
    int scale = panel->canvas.scale, line = panel_line_height(panel), y = top + 2 * scale, x = 2 * scale;
    const char *const rows[] = {figures->rays, figures->triangles, figures->voxels, figures->frames};
    int count = panel->canvas.height >= 24 * line ? 4 : 0, width = 33 * CANVAS_CELL * scale;
    int height = (count + 1) * line + 3 * scale;
    panel_ground(panel, 0, top, width, height);
    panel_bar(panel, x, y, 8 * CANVAS_CELL * scale, figures->share);
    panel_text(panel, x + 9 * CANVAS_CELL * scale, y, figures->state);
    for (int i = 0; i < count; i++)
        panel_text(panel, x, y + (i + 1) * line, rows[i]);
    return top + height;
}

/* The trace of a pixel, from the scrolled line on; after the end it starts again. */
static void draw_pixel_trace(struct viewer *viewer, int top) {
    struct panel *panel = &viewer->window.panel;
    int scale = panel->canvas.scale, line = panel_line_height(panel), y = top + 2 * scale;
    const char *at = viewer->trace.text;
    if (at[0] == '\0')
        return;
    for (int i = 0; i < viewer->trace.line && *at; i++)
        at += strcspn(at, "\n") + (at[strcspn(at, "\n")] == '\n');
    if (*at == '\0') {
        viewer->trace.line = 0;
        at = viewer->trace.text;
    }
    panel_ground(panel, 0, top, panel->canvas.width, panel->canvas.height - top);
    for (; *at && y + line <= panel->canvas.height; y += line) {
        size_t length = strcspn(at, "\n");
        char row[400];
        (void)snprintf(row, sizeof row, "%.*s", (int)(length < sizeof row ? length : sizeof row - 1), at);
        panel_text(panel, 2 * scale, y, row);
        at += length + (at[length] == '\n');
    }
}

/* A text, broken into lines, above the line `bottom` of the canvas. Returns its top. */
static int draw_lines(struct panel *panel, const char *line, bool warns, int bottom) {
    int scale = panel->canvas.scale, height = panel_line_height(panel);
    int columns = (panel->canvas.width - 4 * scale) / (CANVAS_CELL * scale), length = (int)strlen(line);
    if (length == 0 || columns < 8)
        return bottom;
    int rows = (length + columns - 1) / columns, top = bottom - rows * height - 3 * scale;
    panel_ground(panel, 0, top, panel->canvas.width, bottom - top);
    for (int i = 0; i < rows; i++) {
        char text[512];
        (void)snprintf(text, sizeof text, "%.*s", columns, line + i * columns);
        if (warns)
            panel_warning(panel, 2 * scale, top + 2 * scale + i * height, text);
        else
            panel_text(panel, 2 * scale, top + 2 * scale + i * height, text);
    }
    return top;
}

/* On the picture: the selection and the symbols of the lights. */
static void draw_symbols(struct viewer *viewer) {
    struct camera_frame frame;
    if (!viewer->block || !viewer_camera_frame(viewer, &frame))
        return;
    draw_selection(viewer, &frame);
    viewer_draw_lights(viewer, &frame);
}

/* What a window with widgets shows in them. */
static void show_widgets(struct viewer *viewer, const struct figures *figures) {
    const struct window_driver *driver = viewer->window.driver;
    const struct viewer_notice *notice = &viewer->window.notice;
    struct window_status status = {.share = figures->share,
                                   .action_on = viewer_needs_met(viewer),
                                   .warns = notice->warns,
                                   .halted = viewer->pass.halted,
                                   .busy = !viewer->window.waits && (!viewer->block || !viewer_is_idle(viewer)),
                                   .playing = viewer->player.playing,
                                   .loops = viewer->player.loops,
                                   .unsaved = viewer->edit.steps.at != viewer->edit.saved_at,
                                   .frame_index = viewer->player.count > 0 ? viewer_frame_index(viewer) : 0,
                                   .frame_count = viewer->player.count,
                                   .exposure = viewer->request.settings.tone.exposure};
    (void)snprintf(status.file, sizeof status.file, "%.250s", viewer->request.file);
    (void)snprintf(status.state, sizeof status.state, "%s", figures->state);
    (void)snprintf(status.figures, sizeof status.figures, "%s, %s, %s, %s, %s", figures->size, figures->rays,
                   figures->triangles, figures->voxels, figures->frames);
    (void)snprintf(status.frame, sizeof status.frame, "%s", figures->frame);
    (void)snprintf(status.message, sizeof status.message, "%s", viewer->message);
    (void)snprintf(status.notice, sizeof status.notice, "%s", notice->text);
    driver->status(driver->context, &status);
    driver->trace(driver->context, viewer->trace.text);
    viewer_show_form(viewer);
}

static void draw_hud(struct viewer *viewer, const struct figures *figures) {
    struct panel *panel = &viewer->window.panel;
    panel_begin(panel);
    int bottom = panel->canvas.height;
    if (viewer_has_widgets(viewer)) {
        if (!viewer->window.hides_hud)
            draw_symbols(viewer);
        show_widgets(viewer, figures);
        panel_end(panel);
        return;
    }
    if (!viewer->window.hides_hud) {
        /* A low window has one row of buttons. From the picture outwards: what is drawn later lies above. */
        bool room = viewer->window.panel.canvas.height >= 24 * panel_line_height(&viewer->window.panel);
        int top = (room && viewer->block ? 30 : 15) * viewer->window.panel.canvas.scale;
        draw_symbols(viewer);
        bottom = draw_timeline(viewer, figures);
        draw_menu(viewer);
        if (room && viewer->block)
            draw_work(viewer);
        int below = draw_figures(viewer, figures, top);
        if (viewer->block)
            viewer_draw_selection_panel(viewer, top);
        if (viewer->block && viewer->trace.text[0] == '\0')
            viewer_draw_light_list(viewer, below + viewer->window.panel.canvas.scale);
        draw_pixel_trace(viewer, below + viewer->window.panel.canvas.scale);
    }
    bottom = draw_lines(panel, viewer->message, true, bottom);
    (void)draw_lines(panel, viewer->window.notice.text, viewer->window.notice.warns, bottom);
    panel_end(&viewer->window.panel);
}

/* --- the window --- */

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
        draw_hud(viewer, &figures);
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
