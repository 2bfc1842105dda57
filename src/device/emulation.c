#include "device/emulation.h"

#include "base/mem.h"
#include "base/unreachable.h"
#include "device/wave_internal.h"
#include "render/path_view.h"

#include <math.h>

enum { USUAL_WAVE = 4096 };

struct emulation {
    const struct pool *pool;
    uint32_t wave, crossings;
    void *bytes; /* the opened bundle */
    struct path_scene *scene;
};

struct emulation *emulation_create(const struct pool *pool, uint32_t wave, uint32_t crossings) {
    struct emulation *emulation = mem_alloc_zero(1, sizeof *emulation);
    if (emulation)
        *emulation = (struct emulation){.pool = pool, .wave = wave > 0 ? wave : USUAL_WAVE, .crossings = crossings};
    return emulation;
}

void emulation_destroy(struct emulation *emulation) {
    if (emulation)
        mem_free(emulation->bytes);
    mem_free(emulation);
}

bool emulation_open(struct emulation *emulation, void *bytes, size_t size, struct error *error) {
    emulation->scene = bundle_open(bytes, size, (uint64_t)(uintptr_t)bytes, path_scene_size(), error);
    return emulation->scene != NULL;
}

const struct path_scene *emulation_scene(const struct emulation *emulation) {
    return emulation->scene;
}

bool emulation_set_view(struct emulation *emulation, const struct path_view *view) {
    if (!path_view_fits(emulation->scene, view))
        return false;
    path_view_set(emulation->scene, view, (uint64_t)(uintptr_t)emulation->scene);
    return true;
}

static bool begin(void *context, struct bundle *scene, bool *is_used, struct error *error) {
    struct emulation *emulation = context;
    const size_t size = bundle_size(scene);
    *is_used = true;
    mem_free(emulation->bytes);
    emulation->bytes = mem_alloc_aligned(64, size);
    if (!emulation->bytes)
        return error_no_memory(error, "the scene for a device");
    bundle_write(scene, emulation->bytes);
    return emulation_open(emulation, emulation->bytes, size, error);
}

/* --- waves --- */

/* All kernels of a wave, one path after the other. False: stopped. */
static bool run_wave(const struct emulation *emulation, struct wave *wave, struct path_lane *lane) {
    wave->living_count[0] = 0;
    for (uint32_t i = 0; i < wave->count; i++)
        wave_begin(wave, lane, i);
    for (uint32_t turn = 0; wave->living_count[turn % 2] > 0; turn++) {
        const uint32_t count = wave->living_count[turn % 2];
        if (pool_cancelled(emulation->pool))
            return false;
        for (uint32_t k = 0; k < count; k++)
            wave_extend(wave, lane, turn, k);
        for (uint32_t k = 0; k < wave_questions(wave); k++)
            wave_sort_question(wave, k);
        for (uint32_t k = 0; k < wave_questions(wave); k++)
            wave_ask(wave, lane, turn, k);
        for (uint32_t k = 0; k < count && path_scene_leaves_solids(wave->scene); k++)
            wave_keep(wave, turn, k);
        for (uint32_t k = 0; k < count; k++)
            wave_sort(wave, turn, k);
        wave_clear_next(wave, turn);
        for (uint32_t k = 0; k < count; k++)
            wave_shade(wave, lane, turn, k);
        for (uint32_t k = 0; k < count; k++)
            wave_shadow(wave, lane, turn, k);
    }
    for (uint32_t i = 0; i < wave_pixels(wave); i++)
        wave_add(wave, i);
    return true;
}

static bool has_nan(const double *numbers, size_t count) {
    bool has = false;
    for (size_t i = 0; i < count; i++)
        has = has || isnan(numbers[i]);
    return has;
}

/* NaN has other bits on other machines, so no record has one. */
static void check_numbers(const struct path_pixel *pixel, bool has_parts) {
    bool has = has_nan(&pixel->sums[0].r, 6) || has_nan(pixel->weights, 2) || has_nan(pixel->divisors, 2) ||
               has_nan(&pixel->squares.r, 3) || isnan(pixel->seen_through) || isnan(pixel->line) ||
               (has_parts && has_nan(&pixel->light[0].r, (size_t)3 * PATH_LIGHT_GROUPS));
    for (int i = 0; has_parts && i < 2 * PATH_FEATURES; i++)
        has = has || isnan(pixel->features[i / PATH_FEATURES][i % PATH_FEATURES]);
    if (has)
        UNREACHABLE("NaN in a record");
}

static bool make(void *context, const struct path_orders *orders, struct path_counts *counts) {
    const struct emulation *emulation = context;
    const struct path_scene *scene = emulation->scene;
    const uint64_t paths = path_orders_paths(orders);
    const uint32_t crossings = emulation->crossings > 0 ? emulation->crossings : path_scene_crossings(scene);
    struct wave_order numbered[PATH_ORDERS];
    struct wave wave = {.scene = scene,
                        .orders = numbered,
                        .order_count = orders->count,
                        .pixels = orders->pixels,
                        .pixel_size = orders->pixel_size};
    const uint32_t room = paths < emulation->wave ? (uint32_t)paths : emulation->wave;
    wave_number_orders(orders, numbered);
    void *block = mem_alloc_aligned(16, wave_lay(&wave, scene, 0, room));
    void *memory = mem_alloc_aligned(16, path_lane_size(crossings));
    if (!block || !memory) { /* threads make them */
        mem_free(memory);
        mem_free(block);
        return true;
    }
    bool goes_on = true;
    (void)wave_lay(&wave, scene, (uint64_t)(uintptr_t)block, room);
    struct path_lane *lane = path_lane_init(memory, scene, crossings);
    for (; goes_on && wave.first < paths; wave.first += wave.count) {
        const uint64_t left = paths - wave.first;
        wave.count = left < room ? (uint32_t)left : room;
        goes_on = run_wave(emulation, &wave, lane);
    }
    if (goes_on && path_scene_met_fault(scene))
        wave_leave_pixels(orders);
    for (uint64_t i = 0; goes_on && i < path_orders_pixels(orders); i++)
        check_numbers(path_orders_pixel(orders, i), orders->pixel_size == path_pixel_size(true));
    const struct path_counts made = path_lane_counts(lane);
    path_counts_add(counts, &made);
    mem_free(memory);
    mem_free(block);
    return goes_on;
}

struct path_device emulation_device(struct emulation *emulation) {
    return (struct path_device){.begin = begin, .make = make, .context = emulation};
}
