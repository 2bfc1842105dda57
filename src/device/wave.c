#include "device/wave_internal.h"

static struct path_wave_state *state_of(const struct wave *wave, uint32_t i) {
    return (struct path_wave_state *)(void *)(wave->states + i * wave->state_size);
}

/* Their order depends on the threads of a card. No path knows of another one, so no byte does. */
static void keep_alive(struct wave *wave, uint32_t turn, uint32_t i) {
    wave->living[turn % 2][__atomic_fetch_add(&wave->living_count[turn % 2], 1, __ATOMIC_RELAXED)] = i;
}

void wave_begin(struct wave *wave, struct path_lane *lane, uint32_t i) {
    if (path_wave_begin(wave->scene, lane, state_of(wave, i), &wave->order, wave->first + i))
        keep_alive(wave, 0, i);
}

void wave_extend(struct wave *wave, struct path_lane *lane, uint32_t turn, uint32_t k) {
    struct path_wave_state *state = state_of(wave, wave->living[turn % 2][k]);
    path_wave_extend(wave->scene, lane, state);
    (void)__atomic_fetch_add(&wave->class_count[path_wave_class(wave->scene, state)], 1, __ATOMIC_RELAXED);
}

void wave_sort(struct wave *wave, uint32_t turn, uint32_t k) {
    const uint32_t i = wave->living[turn % 2][k], class = path_wave_class(wave->scene, state_of(wave, i));
    uint32_t first = 0;
    for (uint32_t c = 0; c < class; c++)
        first += wave->class_count[c];
    wave->sorted[first + __atomic_fetch_add(&wave->class_used[class], 1, __ATOMIC_RELAXED)] = i;
}

void wave_shade(struct wave *wave, struct path_lane *lane, uint32_t k) {
    path_wave_shade(wave->scene, lane, state_of(wave, wave->sorted[k]));
}

void wave_shadow(struct wave *wave, struct path_lane *lane, uint32_t turn, uint32_t k) {
    const uint32_t i = wave->sorted[k];
    if (path_wave_shadow(wave->scene, lane, state_of(wave, i)))
        keep_alive(wave, turn + 1, i);
}

void wave_clear_next(struct wave *wave, uint32_t turn) {
    wave->living_count[(turn + 1) % 2] = 0;
    for (uint32_t c = 0; c < PATH_CLASSES; c++)
        wave->class_count[c] = wave->class_used[c] = 0;
}

/* The samples of a pixel that the order has. */
static uint32_t samples_of(const struct wave *wave) {
    return wave->order.end - wave->order.begin;
}

uint32_t wave_pixels(const struct wave *wave) {
    const uint64_t last = wave->first + wave->count - 1;
    return (uint32_t)(last / samples_of(wave) - wave->first / samples_of(wave)) + 1;
}

void wave_add(struct wave *wave, struct path_lane *lane, uint32_t i) {
    const uint64_t each = samples_of(wave), number = wave->first / each + i, end = wave->first + wave->count;
    struct path_pixel *pixel = &wave->pixels[number];
    uint64_t path = number * each > wave->first ? number * each : wave->first;
    for (; path < (number + 1) * each && path < end; path++)
        if (pixel->samples == wave->order.begin + (uint32_t)(path % each))
            (void)path_wave_add(wave->scene, lane, state_of(wave, (uint32_t)(path - wave->first)), pixel);
}

void wave_leave_pixels(const struct path_order *order, struct path_pixel *pixels) {
    const uint64_t count = path_order_pixels(order);
    for (uint64_t i = 0; i < count; i++)
        pixels[i].samples = order->begin;
}
