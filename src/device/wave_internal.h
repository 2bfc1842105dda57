/* Paths of orders that are in flight together. A kernel does one thing with one of them; the thread indices of a card
 * or a loop of the emulation choose which. All memory is that of who launches kernels. */
#ifndef GRAY_DEVICE_WAVE_INTERNAL_H
#define GRAY_DEVICE_WAVE_INTERNAL_H

#include "render/path_wave.h"

/* An order, and the numbers of its first path and pixel among those of all orders that are made together. */
struct wave_order {
    struct path_order order;
    uint64_t path, pixel;
};

struct wave {
    const struct path_scene *scene;
    const struct wave_order *orders;
    uint32_t order_count;
    struct path_pixel *pixels; /* of all orders */
    uint64_t first;            /* path of the wave */
    uint32_t count;            /* of paths */
    /* States of an even turn before shade, of an odd one from shade on; and the reverse. Where the states of the turn
     * are not, from shade on, is the light that they ask for. Room for `count`, as in all that follow. */
    char *states[2];
    char *results;
    uint64_t state_size, result_size; /* path_wave_state_size, path_wave_result_size */
    uint32_t *living[2];              /* numbers of states, in any order: of an even turn, of an odd one */
    uint32_t living_count[2];
    uint32_t class_count[PATH_CLASSES], class_used[PATH_CLASSES]; /* of the turn: paths, and those that have moved */
    struct path_counts counts;                                    /* of all waves, when they are made */
    bool met_fault;
};

/* Path i of the wave; counts it among the living of turn 0. */
void wave_begin(struct wave *wave, struct path_lane *lane, uint32_t i);
/* Living path k of the turn; sort moves its state to those of the same class (path_wave_class). Then state k; the last
 * one counts it among those of the next turn. */
void wave_extend(struct wave *wave, struct path_lane *lane, uint32_t turn, uint32_t k);
void wave_sort(struct wave *wave, uint32_t turn, uint32_t k);
void wave_shade(struct wave *wave, struct path_lane *lane, uint32_t turn, uint32_t k);
void wave_shadow(struct wave *wave, struct path_lane *lane, uint32_t turn, uint32_t k);
/* Beside wave_shade: nothing lives in the next turn; and the classes have no paths. */
void wave_clear_next(struct wave *wave, uint32_t turn);
/* Pixel i of those that have paths in the wave. A pixel that has lost a sample gets no more, so that it lacks them in
 * the end. */
void wave_add(struct wave *wave, uint32_t i);
uint32_t wave_pixels(const struct wave *wave);
/* From a fault of the scene on, threads make all pixels, and note where it is. */
void wave_leave_pixels(const struct path_orders *orders);
/* out: orders->count of them. */
void wave_number_orders(const struct path_orders *orders, struct wave_order *out);

#endif
