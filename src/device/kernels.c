/* The kernels of a card: each thread takes every so many-th path of a wave, with a lane of its own. Arguments are
 * addresses on the card. Compiled for cards alone (tools/device_scan.sh). */
#include "device/arithmetic_internal.h"
#include "device/wave_internal.h"

#if defined GRAY_DEVICE || defined GRAY_PLAYED_CARD

#if defined GRAY_PLAYED_CARD
extern uint32_t played_thread, played_threads; /* by the test that plays a card */
static uint32_t thread_index(void) {
    return played_thread;
}
static uint32_t thread_count(void) {
    return played_threads;
}
#elif defined __NVPTX__
static uint32_t thread_index(void) {
    return (uint32_t)(__nvvm_read_ptx_sreg_ctaid_x() * __nvvm_read_ptx_sreg_ntid_x() + __nvvm_read_ptx_sreg_tid_x());
}
static uint32_t thread_count(void) {
    return (uint32_t)(__nvvm_read_ptx_sreg_nctaid_x() * __nvvm_read_ptx_sreg_ntid_x());
}
#else /* AMD: 256 threads of a group */
static uint32_t thread_index(void) {
    return __builtin_amdgcn_workgroup_id_x() * 256 + __builtin_amdgcn_workitem_id_x();
}
static uint32_t thread_count(void) {
    return __builtin_amdgcn_grid_size_x();
}
#endif

/* crossings: of the memory of each lane. */
void kernel_lanes(uint64_t lanes, uint64_t scene, uint32_t crossings);
void kernel_arithmetic(uint64_t digests);
void kernel_begin(uint64_t wave, uint64_t lanes, uint32_t crossings);
void kernel_extend(uint64_t wave, uint64_t lanes, uint32_t crossings, uint32_t turn);
void kernel_sort_questions(uint64_t wave);
void kernel_ask(uint64_t wave, uint64_t lanes, uint32_t crossings, uint32_t turn);
void kernel_keep(uint64_t wave, uint64_t lanes, uint32_t crossings, uint32_t turn);
void kernel_sort(uint64_t wave, uint64_t lanes, uint32_t crossings, uint32_t turn);
void kernel_shade(uint64_t wave, uint64_t lanes, uint32_t crossings, uint32_t turn);
void kernel_shadow(uint64_t wave, uint64_t lanes, uint32_t crossings, uint32_t turn);
void kernel_add(uint64_t wave, uint64_t lanes, uint32_t crossings);
void kernel_finish(uint64_t wave, uint64_t lanes, uint32_t crossings, uint32_t count);

static void *lane_of(uint64_t lanes, uint32_t crossings) {
    return (char *)(uintptr_t)lanes + thread_index() * path_lane_size(crossings);
}

void kernel_lanes(uint64_t lanes, uint64_t scene, uint32_t crossings) {
    (void)path_lane_init(lane_of(lanes, crossings), (const struct path_scene *)(uintptr_t)scene, crossings);
}

void kernel_arithmetic(uint64_t digests) {
    for (uint32_t i = thread_index(); i < ARITHMETIC_NUMBERS; i += thread_count())
        ((uint64_t *)(uintptr_t)digests)[i] = arithmetic_digest(i);
}

void kernel_begin(uint64_t wave, uint64_t lanes, uint32_t crossings) {
    struct wave *w = (struct wave *)(uintptr_t)wave;
    struct path_lane *lane = lane_of(lanes, crossings);
    for (uint32_t i = thread_index(); i < w->count; i += thread_count())
        wave_begin(w, lane, i);
}

void kernel_extend(uint64_t wave, uint64_t lanes, uint32_t crossings, uint32_t turn) {
    struct wave *w = (struct wave *)(uintptr_t)wave;
    struct path_lane *lane = lane_of(lanes, crossings);
    for (uint32_t k = thread_index(); k < w->living_count[turn % 2]; k += thread_count())
        wave_extend(w, lane, turn, k);
}

void kernel_sort_questions(uint64_t wave) {
    struct wave *w = (struct wave *)(uintptr_t)wave;
    for (uint32_t k = thread_index(); k < wave_questions(w); k += thread_count())
        wave_sort_question(w, k);
}

void kernel_ask(uint64_t wave, uint64_t lanes, uint32_t crossings, uint32_t turn) {
    struct wave *w = (struct wave *)(uintptr_t)wave;
    struct path_lane *lane = lane_of(lanes, crossings);
    for (uint32_t k = thread_index(); k < wave_questions(w); k += thread_count())
        wave_ask(w, lane, turn, k);
}

void kernel_keep(uint64_t wave, uint64_t lanes, uint32_t crossings, uint32_t turn) {
    struct wave *w = (struct wave *)(uintptr_t)wave;
    (void)lanes, (void)crossings;
    for (uint32_t k = thread_index(); k < w->living_count[turn % 2]; k += thread_count())
        wave_keep(w, turn, k);
}

void kernel_sort(uint64_t wave, uint64_t lanes, uint32_t crossings, uint32_t turn) {
    struct wave *w = (struct wave *)(uintptr_t)wave;
    (void)lanes, (void)crossings;
    for (uint32_t k = thread_index(); k < w->living_count[turn % 2]; k += thread_count())
        wave_sort(w, turn, k);
}

void kernel_shade(uint64_t wave, uint64_t lanes, uint32_t crossings, uint32_t turn) {
    struct wave *w = (struct wave *)(uintptr_t)wave;
    struct path_lane *lane = lane_of(lanes, crossings);
    if (thread_index() == 0)
        wave_clear_next(w, turn);
    for (uint32_t k = thread_index(); k < w->living_count[turn % 2]; k += thread_count())
        wave_shade(w, lane, turn, k);
}

void kernel_shadow(uint64_t wave, uint64_t lanes, uint32_t crossings, uint32_t turn) {
    struct wave *w = (struct wave *)(uintptr_t)wave;
    struct path_lane *lane = lane_of(lanes, crossings);
    for (uint32_t k = thread_index(); k < w->living_count[turn % 2]; k += thread_count())
        wave_shadow(w, lane, turn, k);
}

void kernel_add(uint64_t wave, uint64_t lanes, uint32_t crossings) {
    struct wave *w = (struct wave *)(uintptr_t)wave;
    (void)lanes, (void)crossings;
    for (uint32_t i = thread_index(); i < wave_pixels(w); i += thread_count())
        wave_add(w, i);
}

/* count: of lanes. */
void kernel_finish(uint64_t wave, uint64_t lanes, uint32_t crossings, uint32_t count) {
    struct wave *w = (struct wave *)(uintptr_t)wave;
    for (uint32_t i = thread_index(); i < count; i += thread_count()) {
        const char *lane = (const char *)(uintptr_t)lanes + i * path_lane_size(crossings);
        const struct path_counts made = path_lane_counts((const struct path_lane *)(const void *)lane);
        wave_count(w, &made);
    }
    if (thread_index() == 0)
        w->met_fault = path_scene_met_fault(w->scene);
}

#endif
