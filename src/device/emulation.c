#include "device/emulation.h"

#include "base/mem.h"

enum { USUAL_WAVE = 4096 };

struct emulation {
    const struct pool *pool;
    uint32_t wave, crossings;
    void *bytes; /* the opened bundle */
    const struct path_scene *scene;
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

static bool begin(void *context, struct bundle *scene, struct error *error) {
    struct emulation *emulation = context;
    const size_t size = bundle_size(scene);
    mem_free(emulation->bytes);
    emulation->bytes = mem_alloc_aligned(64, size);
    if (!emulation->bytes)
        return error_no_memory(error, "the scene for a device");
    bundle_write(scene, emulation->bytes);
    return emulation_open(emulation, emulation->bytes, size, error);
}

/* --- waves --- */

struct wave {
    const struct path_scene *scene;
    const struct path_order *order;
    uint64_t first; /* path */
    uint32_t count, living_count;
    char *states;
    size_t state_size;
    uint32_t *living; /* in the wave, ascending */
    struct path_lane *lane;
};

static struct path_wave_state *state_of(const struct wave *wave, uint32_t i) {
    return (struct path_wave_state *)(void *)(wave->states + i * wave->state_size);
}

static void begin_wave(struct wave *wave) {
    wave->living_count = 0;
    for (uint32_t i = 0; i < wave->count; i++)
        if (path_wave_begin(wave->scene, wave->lane, state_of(wave, i), wave->order, wave->first + i))
            wave->living[wave->living_count++] = i;
}

/* One vertex of each path. */
static void advance(struct wave *wave) {
    uint32_t kept = 0;
    for (uint32_t k = 0; k < wave->living_count; k++)
        path_wave_extend(wave->scene, wave->lane, state_of(wave, wave->living[k]));
    for (uint32_t k = 0; k < wave->living_count; k++)
        path_wave_shade(wave->scene, wave->lane, state_of(wave, wave->living[k]));
    for (uint32_t k = 0; k < wave->living_count; k++)
        if (path_wave_shadow(wave->scene, wave->lane, state_of(wave, wave->living[k])))
            wave->living[kept++] = wave->living[k];
    wave->living_count = kept;
}

/* From a fault of the scene on, threads make all pixels, and note where it is. */
static void leave_pixels(const struct wave *wave, struct path_pixel *pixels) {
    const uint64_t count = path_order_pixels(wave->order);
    if (path_scene_met_fault(wave->scene))
        for (uint64_t i = 0; i < count; i++)
            pixels[i].samples = wave->order->begin;
}

/* A pixel that has lost a sample gets no more, so that the thread that asked finds it. */
static void add_wave(const struct wave *wave, struct path_pixel *pixels) {
    const uint32_t each = wave->order->end - wave->order->begin;
    for (uint32_t i = 0; i < wave->count; i++) {
        const uint64_t number = wave->first + i;
        struct path_pixel *pixel = &pixels[number / each];
        if (pixel->samples == wave->order->begin + (uint32_t)(number % each))
            (void)path_wave_add(wave->scene, wave->lane, state_of(wave, i), pixel);
    }
}

static bool make(void *context, const struct path_order *order, struct path_pixel *pixels, struct path_counts *counts) {
    const struct emulation *emulation = context;
    const uint64_t paths = path_order_paths(order);
    struct wave wave = {
        .scene = emulation->scene, .order = order, .state_size = path_wave_state_size(emulation->scene)};
    wave.states = mem_alloc(emulation->wave * wave.state_size);
    wave.living = mem_alloc(emulation->wave * sizeof *wave.living);
    uint32_t crossings = emulation->crossings > 0 ? emulation->crossings : path_scene_crossings(emulation->scene);
    void *lane = mem_alloc_aligned(16, path_lane_size(crossings));
    bool goes_on = wave.states && wave.living && lane;
    if (goes_on)
        wave.lane = path_lane_init(lane, emulation->scene, crossings);
    for (; goes_on && wave.first < paths; wave.first += wave.count) {
        const uint64_t left = paths - wave.first;
        wave.count = left < emulation->wave ? (uint32_t)left : emulation->wave;
        for (begin_wave(&wave); wave.living_count > 0 && goes_on; goes_on = !pool_cancelled(emulation->pool))
            advance(&wave);
        if (goes_on)
            add_wave(&wave, pixels);
    }
    if (goes_on)
        leave_pixels(&wave, pixels);
    if (wave.lane) {
        const struct path_counts made = path_lane_counts(wave.lane);
        path_counts_add(counts, &made);
    }
    mem_free(lane);
    mem_free(wave.living);
    mem_free(wave.states);
    return goes_on;
}

struct path_device emulation_device(struct emulation *emulation) {
    return (struct path_device){NULL, begin, make, emulation};
}
