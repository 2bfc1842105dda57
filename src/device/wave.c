#include "device/wave_internal.h"

/* side: the turn, or the next one after its states have moved. */
static struct path_wave_state *state_of(const struct wave *wave, uint32_t side, uint32_t i) {
    return (struct path_wave_state *)(void *)(wave->states[side % 2] + i * wave->state_size);
}

static struct path_wave_light *light_of(const struct wave *wave, uint32_t turn, uint32_t i) {
    return (struct path_wave_light *)(void *)(wave->states[turn % 2] + i * wave->state_size);
}

static struct path_wave_result *result_of(const struct wave *wave, uint32_t number) {
    return (struct path_wave_result *)(void *)(wave->results + number * wave->result_size);
}

/* Their order depends on the threads of a card. No path knows of another one, so no byte does. */
static void keep_alive(struct wave *wave, uint32_t turn, uint32_t i) {
    wave->living[turn % 2][__atomic_fetch_add(&wave->living_count[turn % 2], 1, __ATOMIC_RELAXED)] = i;
}

/* The order of a path, or of a pixel. */
static const struct wave_order *order_of(const struct wave *wave, uint64_t number, bool of_pixel) {
    uint32_t first = 0, count = wave->order_count;
    while (count > 1) {
        const uint32_t half = count / 2;
        const struct wave_order *middle = &wave->orders[first + half];
        const bool is_behind = (of_pixel ? middle->pixel : middle->path) <= number;
        first += is_behind ? half : 0;
        count = is_behind ? count - half : half;
    }
    return &wave->orders[first];
}

static uint32_t samples_of(const struct path_order *order) {
    return order->end - order->begin;
}

static uint64_t pixel_of(const struct wave *wave, uint64_t path) {
    const struct wave_order *order = order_of(wave, path, false);
    return order->pixel + (path - order->path) / samples_of(&order->order);
}

void wave_begin(struct wave *wave, struct path_lane *lane, uint32_t i) {
    const struct wave_order *order = order_of(wave, wave->first + i, false);
    const struct path_wave_start start = {&order->order, wave->first + i - order->path, i};
    if (path_wave_begin(wave->scene, lane, &start, state_of(wave, 0, i), result_of(wave, i)))
        keep_alive(wave, 0, i);
}

void wave_extend(struct wave *wave, struct path_lane *lane, uint32_t turn, uint32_t k) {
    struct path_wave_state *state = state_of(wave, turn, wave->living[turn % 2][k]);
    path_wave_extend(wave->scene, lane, state);
    (void)__atomic_fetch_add(&wave->class_count[path_wave_class(wave->scene, state)], 1, __ATOMIC_RELAXED);
}

void wave_sort(struct wave *wave, uint32_t turn, uint32_t k) {
    const struct path_wave_state *state = state_of(wave, turn, wave->living[turn % 2][k]);
    const uint32_t class = path_wave_class(wave->scene, state);
    uint32_t first = 0;
    for (uint32_t c = 0; c < class; c++)
        first += wave->class_count[c];
    first += __atomic_fetch_add(&wave->class_used[class], 1, __ATOMIC_RELAXED);
    path_wave_move(state_of(wave, turn + 1, first), state);
}

void wave_shade(struct wave *wave, struct path_lane *lane, uint32_t turn, uint32_t k) {
    struct path_wave_state *state = state_of(wave, turn + 1, k);
    path_wave_shade(wave->scene, lane, state, light_of(wave, turn, k), result_of(wave, path_wave_number(state)));
}

void wave_shadow(struct wave *wave, struct path_lane *lane, uint32_t turn, uint32_t k) {
    struct path_wave_state *state = state_of(wave, turn + 1, k);
    struct path_wave_result *result = result_of(wave, path_wave_number(state));
    if (path_wave_shadow(wave->scene, lane, state, light_of(wave, turn, k), result))
        keep_alive(wave, turn + 1, k);
}

void wave_clear_next(struct wave *wave, uint32_t turn) {
    wave->living_count[(turn + 1) % 2] = 0;
    for (uint32_t c = 0; c < PATH_CLASSES; c++)
        wave->class_count[c] = wave->class_used[c] = 0;
}

uint32_t wave_pixels(const struct wave *wave) {
    return (uint32_t)(pixel_of(wave, wave->first + wave->count - 1) - pixel_of(wave, wave->first)) + 1;
}

void wave_add(struct wave *wave, uint32_t i) {
    const uint64_t number = pixel_of(wave, wave->first) + i, end = wave->first + wave->count;
    const struct wave_order *order = order_of(wave, number, true);
    const uint32_t each = samples_of(&order->order);
    const uint64_t first = order->path + (number - order->pixel) * each;
    struct path_pixel *pixel = &wave->pixels[number];
    for (uint64_t path = first > wave->first ? first : wave->first; path < first + each && path < end; path++)
        if (pixel->samples == order->order.begin + (uint32_t)(path - first))
            (void)path_wave_add(wave->scene, result_of(wave, (uint32_t)(path - wave->first)), pixel);
}

void wave_leave_pixels(const struct path_orders *orders) {
    struct path_pixel *pixel = orders->pixels;
    for (uint32_t i = 0; i < orders->count; i++)
        for (uint64_t k = path_order_pixels(&orders->all[i]); k > 0; k--)
            (pixel++)->samples = orders->all[i].begin;
}

void wave_number_orders(const struct path_orders *orders, struct wave_order *out) {
    uint64_t path = 0, pixel = 0;
    for (uint32_t i = 0; i < orders->count; i++) {
        out[i] = (struct wave_order){orders->all[i], path, pixel};
        path += path_order_paths(&orders->all[i]);
        pixel += path_order_pixels(&orders->all[i]);
    }
}
