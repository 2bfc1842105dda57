/* Paths of many pixels at a time: a piece of all of them, then the next piece (path_pieces_internal.h), as cards make
 * them. Each has the bits that a thread gives it, which makes all pieces of one path in a row. */
#ifndef GRAY_RENDER_PATH_WAVE_H
#define GRAY_RENDER_PATH_WAVE_H

#include "base/bundle.h"
#include "film/path_film.h"
#include "world/device_search.h"

/* What paths read; the root of a bundle. */
struct path_scene;
size_t path_scene_size(void);
size_t path_scene_pixel_size(const struct path_scene *scene); /* path_pixel_size of its orders */

/* The samples begin .. end - 1 of the pixels of a rectangle of the picture, which have the samples before. */
struct path_order {
    uint32_t x0, y0, x1, y1;
    uint32_t begin, end;
};
static inline uint64_t path_order_pixels(const struct path_order *order) {
    return (uint64_t)(order->x1 - order->x0) * (order->y1 - order->y0);
}
static inline uint64_t path_order_paths(const struct path_order *order) {
    return path_order_pixels(order) * (order->end - order->begin);
}

/* Orders that are made together: together they fill a card. pixels: of one order after the other, each row by row, of
 * so many bytes (path_pixel_size). */
enum { PATH_ORDERS = 128 /* at most */ };
struct path_orders {
    const struct path_order *all;
    uint32_t count;
    void *pixels;
    size_t pixel_size;
};
static inline struct path_pixel *path_orders_pixel(const struct path_orders *orders, uint64_t i) {
    return (struct path_pixel *)(void *)((char *)orders->pixels + i * orders->pixel_size);
}
uint64_t path_orders_pixels(const struct path_orders *orders);
uint64_t path_orders_paths(const struct path_orders *orders);

/* What a worker counts. */
struct path_counts {
    uint64_t camera_rays, reflected_rays, refracted_rays, shadow_rays, hits, medium_events;
    uint32_t clamped; /* not 0: some light was */
};
void path_counts_add(struct path_counts *to, const struct path_counts *counts);

/* Of a path: its state between two pieces, which moves; the light that it asks for at a vertex, from shade to shadow;
 * and its result, which does not move. Memory for a state is large enough for that light. Bytes: */
struct path_wave_state;
struct path_wave_light;
struct path_wave_result;
size_t path_wave_state_size(void);
size_t path_wave_result_size(const struct path_scene *scene);
/* What a thread needs for a piece. */
struct path_lane;
/* A lane in memory of that size, a multiple of 16, at a multiple of 16, for queries with at most so many crossings of a
 * line; path_scene_crossings is usually enough. */
uint32_t path_scene_crossings(const struct path_scene *scene);
size_t path_lane_size(uint32_t crossings);
struct path_lane *path_lane_init(void *memory, const struct path_scene *scene, uint32_t crossings);
struct path_counts path_lane_counts(const struct path_lane *lane); /* of all its pieces */

/* The first piece of a path of the order; these are numbered pixel by pixel. number: of the path in its wave, which its
 * state keeps. False: the path is not alive; it still has to be added. */
struct path_wave_start {
    const struct path_order *order;
    uint64_t path;
    uint32_t number;
};
bool path_wave_begin(const struct path_scene *scene, struct path_lane *lane, const struct path_wave_start *start,
                     struct path_wave_state *state, struct path_wave_result *result);
uint32_t path_wave_number(const struct path_wave_state *state);
/* The state lies elsewhere from now on. */
void path_wave_move(struct path_wave_state *to, const struct path_wave_state *from);
/* What the ray meets first; but some solids are left, for path_wave_ask. */
bool path_scene_leaves_solids(const struct path_scene *scene);
void path_wave_extend(const struct path_scene *scene, struct path_lane *lane, struct path_wave_state *state,
                      struct device_questions *questions);
/* The answer of a primitive that was left, which the path then keeps, in any order; and its class, of those that need
 * the same equations. */
struct path_wave_answer;
enum { PATH_ANSWER_ROOM = 64 }; /* bytes that are enough for it */
uint32_t path_wave_question_class(const struct path_scene *scene, uint32_t primitive);
void path_wave_ask(const struct path_scene *scene, struct path_lane *lane, const struct path_wave_state *state,
                   uint32_t primitive, struct path_wave_answer *answer);
void path_wave_keep(struct path_wave_state *state, const struct path_wave_answer *answer);
/* After them: paths of one class do the same next, by the material that they have met. */
enum { PATH_CLASSES = 16 };
uint32_t path_wave_class(const struct path_scene *scene, const struct path_wave_state *state);
/* shadow returns whether the path goes on; otherwise its result is complete. */
void path_wave_shade(const struct path_scene *scene, struct path_lane *lane, struct path_wave_state *state,
                     struct path_wave_light *light, struct path_wave_result *result);
bool path_wave_shadow(const struct path_scene *scene, struct path_lane *lane, struct path_wave_state *state,
                      struct path_wave_light *light, struct path_wave_result *result);
/* In the order of the samples. False: the memory of a query was too small, and the pixel has lost this sample. */
bool path_wave_add(const struct path_scene *scene, const struct path_wave_result *result, struct path_pixel *pixel);

/* So many samples of pixels in the middle of the picture, in a square with at most that side. */
struct path_order path_scene_trial(const struct path_scene *scene, uint32_t side, uint32_t samples);

/* Whether a function of a texture was NaN or a density above its bound: a thread has to note where. */
bool path_scene_met_fault(const struct path_scene *scene);

/* The samples of the picture, and how many all threads make in a second: 0, not tried. */
struct path_estimate {
    double samples, rate;
};

struct path_view;
enum path_device_answer {
    PATH_DEVICE_BEGINS, /* it has no scene, or the view is not one of it: `begin`, and once more */
    PATH_DEVICE_TAKES,
    PATH_DEVICE_LEAVES, /* threads make this picture */
};

/* Who makes the samples of rectangles in place of the threads of the render. */
struct path_device {
    /* Or NULL; in place of `begin`: the scene has something that devices do not have, in words. Errors end the render.
     */
    bool (*leave)(void *context, const char *what, struct error *error);
    /* Or NULL; before `begin`, with the estimate of a trial. False: threads make the picture. */
    bool (*is_worth)(void *context, const struct path_estimate *threads);
    /* Or NULL; before all but `leave`: the orders that follow are for this view (path_view.h). */
    enum path_device_answer (*take_view)(void *context, const struct path_view *view);
    /* Before the first order. *is_used false: threads make the picture. Errors end the render. */
    bool (*begin)(void *context, struct bundle *scene, bool *is_used, struct error *error);
    /* Where a pixel has not all samples of its order afterwards, the thread makes them. Adds to `counts`. Called from
     * any worker. False: stopped. */
    bool (*make)(void *context, const struct path_orders *orders, struct path_counts *counts);
    void *context;
    /* Threads that wait for orders, beside those of the processor, which make tiles, too. 0: the threads of the
     * processor wait, and make nothing. */
    uint32_t waiting;
    uint32_t tiles; /* that a thread orders in a go; 0: PATH_ORDERS, which is the most */
};

#endif
