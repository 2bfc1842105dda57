/* A window that is larger than the picture: when the view is complete at the size of the picture, it is rendered again
 * at the resolution of the window. This film has separate memory, which is sent to the render process with each such
 * pass. The film of the picture, and everything that is picked, saved or drawn over it, keeps the size of the picture.
 * Until a tile is finished, the window shows that part of the picture at the resolution of the picture. */
#include "viewer/viewer_internal.h"

#include "base/mem.h"
#include "image/png_write.h"

#include <string.h>

enum { LARGE_PIXELS = 1 << 26 };

/* The size of the picture in the window; false: it has no more pixels than the picture itself. */
static bool wanted_size(const struct viewer *viewer, uint32_t *width, uint32_t *height) {
    const struct window_layout *layout = &viewer->window.layout;
    if (!(layout->shown_width > viewer->request.width && layout->shown_height >= viewer->request.height) ||
        layout->shown_width * layout->shown_height > LARGE_PIXELS)
        return false;
    *width = (uint32_t)layout->shown_width;
    *height = (uint32_t)layout->shown_height;
    return true;
}

bool viewer_large_is_outdated(const struct viewer *viewer) {
    uint32_t width, height;
    const struct pass_view *view = &viewer->pass.view;
    return view->width > 0 && (!wanted_size(viewer, &width, &height) || view->width != width || view->height != height);
}

bool viewer_wants_large(const struct viewer *viewer) {
    uint32_t width, height;
    const struct viewer_large *large = &viewer->window.large;
    return viewer->pass.result == RESULT_COMPLETE && viewer->pass.view.width == 0 && viewer->block &&
           viewer->window.sends_memory && wanted_size(viewer, &width, &height) &&
           !(large->refused_width == width && large->refused_height == height);
}

void viewer_drop_large(struct viewer *viewer) {
    viewer->window.dirty = viewer->window.dirty || viewer->window.large.shown;
    viewer->window.large.shown = false;
    if (viewer->pass.view.width == 0)
        return;
    viewer->pass.view.width = viewer->pass.view.height = 0;
    viewer->pass.film = pass_film(&viewer->request, viewer->block, viewer->pass.view.divide);
    viewer->pass.result = RESULT_COMPLETE; /* that of the picture's size, which came before */
}

void viewer_destroy_large(struct viewer *viewer) {
    share_destroy(&viewer->window.large.memory);
    mem_free(viewer->window.large.image);
    mem_free(viewer->window.large.drawn);
    viewer->window.large = (struct viewer_large){0};
}

/* Memory for a film and an image of this size. */
static bool make_room(struct viewer_large *large, const struct picture_request *request) {
    struct error ignored;
    size_t bytes;
    struct film film = {.width = request->width, .height = request->height, .x0 = request->x0, .y0 = request->y0};
    if (!picture_film_size(request, &bytes, &ignored))
        return false;
    if (large->memory.block && large->memory.size != bytes)
        share_destroy(&large->memory);
    if (!large->memory.block && !share_create(&large->memory, bytes, &ignored))
        return false;
    mem_free(large->image);
    mem_free(large->drawn);
    large->tiles = film_tile_count(&film);
    large->image = mem_alloc_zero((size_t)request->width * request->height, 3);
    large->drawn = mem_alloc_zero(large->tiles, 1);
    return large->image && large->drawn;
}

bool viewer_begin_large(struct viewer *viewer) {
    struct viewer_large *large = &viewer->window.large;
    struct picture_request request;
    uint32_t width, height;
    if (!wanted_size(viewer, &width, &height))
        return false;
    if (!picture_request_enlarge(&viewer->request, width, height, &request) || !make_room(large, &request)) {
        viewer_destroy_large(viewer);
        large->refused_width = width;
        large->refused_height = height;
        viewer_show_notice(viewer, "gray: out of memory for a picture as large as the window", true);
        return false;
    }
    viewer->pass.view.width = large->width = width;
    viewer->pass.view.height = large->height = height;
    viewer->pass.film = pass_film(&request, large->memory.block, 1);
    if (viewer->pass.film.marked)
        memset(viewer->pass.film.marked, 0, (size_t)width * height);
    large->shown = large->stale = true;
    return true;
}

static void tone_large(struct viewer *viewer, const struct tone *tone, uint32_t x, uint32_t y) {
    const struct viewer_large *large = &viewer->window.large;
    size_t at = (size_t)y * large->width + x;
    uint32_t u = (uint32_t)((uint64_t)x * viewer->request.width / large->width);
    uint32_t v = (uint32_t)((uint64_t)y * viewer->request.height / large->height);
    float rgb[3];
    memcpy(rgb, viewer->pass.film.pixels[at].rgb, sizeof rgb);
    if (viewer->overlay.has_lines)
        overlay_blend(viewer->overlay.lines[(size_t)v * viewer->request.width + u], rgb);
    for (size_t c = 0; c < 3; c++)
        large->image[3 * at + c] = png_write_byte(tone_apply(tone, (double)rgb[c]));
}

/* The picture at its own resolution. */
static void copy_picture(struct viewer *viewer) {
    const struct viewer_large *large = &viewer->window.large;
    uint32_t width = viewer->request.width, height = viewer->request.height;
    for (uint32_t y = 0; y < large->height; y++) {
        const uint8_t *row = viewer->window.image + 3 * (size_t)width * ((uint64_t)y * height / large->height);
        uint8_t *out = large->image + 3 * (size_t)large->width * y;
        for (uint32_t x = 0; x < large->width; x++)
            memcpy(out + 3 * (size_t)x, row + 3 * ((uint64_t)x * width / large->width), 3);
    }
}

void viewer_draw_large(struct viewer *viewer) {
    struct viewer_large *large = &viewer->window.large;
    const struct film *film = &viewer->pass.film;
    struct tone tone = picture_tone(&viewer->request);
    /* The enlarged image of the display is below tiles that are not finished. */
    if (large->stale) {
        copy_picture(viewer);
        memset(large->drawn, 0, large->tiles);
        large->stale = false;
        viewer->window.dirty = true;
    }
    for (uint32_t tile = 0; tile < large->tiles; tile++) {
        uint8_t state = atomic_load_explicit(&film->tiles[tile], memory_order_acquire);
        bool shows = viewer_shows_denoised(viewer) ? state == FILM_TILE_DONE : film_tile_shows(state);
        if (!shows || large->drawn[tile] == state)
            continue;
        struct film_rectangle r = film_tile_rectangle(film, tile);
        for (uint32_t y = r.y0 - film->y0; y < r.y1 - film->y0; y++)
            for (uint32_t x = r.x0 - film->x0; x < r.x1 - film->x0; x++)
                tone_large(viewer, &tone, x, y);
        large->drawn[tile] = state;
        viewer->window.dirty = true;
    }
}
