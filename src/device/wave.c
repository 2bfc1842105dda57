#include "device/wave_internal.h"

/* Addresses of a card have the size of those here. */
static void *part(uint64_t *end, uint64_t size) {
    const uint64_t at = *end;
    *end += (size + 15) / 16 * 16;
    return (void *)(uintptr_t)at;
}

uint64_t wave_lay(struct wave *wave, const struct path_scene *scene, uint64_t address, uint32_t room) {
    uint64_t end = address;
    wave->state_size = path_wave_state_size();
    wave->result_size = path_wave_result_size(scene);
    wave->room = path_scene_leaves_solids(scene) ? room : 0;
    for (int i = 0; i < 2; i++) {
        wave->states[i] = part(&end, room * wave->state_size);
        wave->living[i] = part(&end, room * sizeof *wave->living[i]);
    }
    wave->results = part(&end, room * wave->result_size);
    wave->questions = part(&end, wave->room * sizeof *wave->questions);
    wave->answers = part(&end, wave->room * sizeof *wave->answers);
    wave->first_question = part(&end, wave->room * sizeof *wave->first_question);
    wave->asked = part(&end, wave->room * sizeof *wave->asked);
    return end - address;
}

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

static void count(uint32_t *counts, uint32_t class) {
    (void)__atomic_fetch_add(&counts[class], 1, __ATOMIC_RELAXED);
}

/* The next position of a class, behind those of all classes before it. */
static uint32_t position(const uint32_t counts[PATH_CLASSES], uint32_t used[PATH_CLASSES], uint32_t class) {
    uint32_t first = 0;
    for (uint32_t c = 0; c < class; c++)
        first += counts[c];
    return first + __atomic_fetch_add(&used[class], 1, __ATOMIC_RELAXED);
}

static struct path_wave_answer *answer_of(const struct wave *wave, uint32_t number) {
    return (struct path_wave_answer *)(void *)wave->answers[number];
}

/* Puts a question into the list of its state, or answers it. */
static void put_question(struct wave *wave, struct path_lane *lane, uint32_t turn, struct wave_question question) {
    const uint32_t number = __atomic_fetch_add(&wave->question_count, 1, __ATOMIC_RELAXED);
    struct path_wave_state *state = state_of(wave, turn, question.state);
    char answer[PATH_ANSWER_ROOM] __attribute__((aligned(16)));
    if (number < wave->room) {
        question.next = wave->first_question[question.state];
        wave->questions[number] = question;
        wave->first_question[question.state] = number + 1;
        count(wave->question_class_count, path_wave_question_class(wave->scene, question.primitive));
        return;
    }
    struct path_wave_answer *own = (struct path_wave_answer *)(void *)answer;
    path_wave_ask(wave->scene, lane, state, question.primitive, own);
    path_wave_keep(state, own);
}

void wave_extend(struct wave *wave, struct path_lane *lane, uint32_t turn, uint32_t k) {
    const uint32_t number = wave->living[turn % 2][k];
    struct path_wave_state *state = state_of(wave, turn, number);
    struct device_questions questions;
    path_wave_extend(wave->scene, lane, state, &questions);
    if (path_scene_leaves_solids(wave->scene))
        wave->first_question[number] = 0;
    for (uint32_t i = 0; i < questions.count; i++)
        put_question(wave, lane, turn, (struct wave_question){number, questions.primitives[i], 0});
    if (!path_scene_leaves_solids(wave->scene) || wave->first_question[number] == 0)
        count(wave->class_count, path_wave_class(wave->scene, state));
}

uint32_t wave_questions(const struct wave *wave) {
    return wave->question_count < wave->room ? wave->question_count : wave->room;
}

void wave_sort_question(struct wave *wave, uint32_t k) {
    const uint32_t class = path_wave_question_class(wave->scene, wave->questions[k].primitive);
    wave->asked[position(wave->question_class_count, wave->question_class_used, class)] = k;
}

void wave_ask(struct wave *wave, struct path_lane *lane, uint32_t turn, uint32_t k) {
    const uint32_t number = wave->asked[k];
    const struct wave_question *question = &wave->questions[number];
    path_wave_ask(wave->scene, lane, state_of(wave, turn, question->state), question->primitive,
                  answer_of(wave, number));
}

void wave_keep(struct wave *wave, uint32_t turn, uint32_t k) {
    const uint32_t number = wave->living[turn % 2][k];
    struct path_wave_state *state = state_of(wave, turn, number);
    if (wave->first_question[number] == 0)
        return;
    for (uint32_t i = wave->first_question[number]; i > 0; i = wave->questions[i - 1].next)
        path_wave_keep(state, answer_of(wave, i - 1));
    count(wave->class_count, path_wave_class(wave->scene, state));
}

void wave_sort(struct wave *wave, uint32_t turn, uint32_t k) {
    const struct path_wave_state *state = state_of(wave, turn, wave->living[turn % 2][k]);
    const uint32_t class = path_wave_class(wave->scene, state);
    path_wave_move(state_of(wave, turn + 1, position(wave->class_count, wave->class_used, class)), state);
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
    wave->living_count[(turn + 1) % 2] = wave->question_count = 0;
    for (uint32_t c = 0; c < PATH_CLASSES; c++) {
        wave->class_count[c] = wave->class_used[c] = 0;
        wave->question_class_count[c] = wave->question_class_used[c] = 0;
    }
}

uint32_t wave_pixels(const struct wave *wave) {
    return (uint32_t)(pixel_of(wave, wave->first + wave->count - 1) - pixel_of(wave, wave->first)) + 1;
}

void wave_add(struct wave *wave, uint32_t i) {
    const uint64_t number = pixel_of(wave, wave->first) + i, end = wave->first + wave->count;
    const struct wave_order *order = order_of(wave, number, true);
    const uint32_t each = samples_of(&order->order);
    const uint64_t first = order->path + (number - order->pixel) * each;
    struct path_pixel *pixel = (struct path_pixel *)(void *)(wave->pixels + number * wave->pixel_size);
    for (uint64_t path = first > wave->first ? first : wave->first; path < first + each && path < end; path++)
        if (pixel->samples == order->order.begin + (uint32_t)(path - first))
            (void)path_wave_add(wave->scene, result_of(wave, (uint32_t)(path - wave->first)), pixel);
}

static void add(uint64_t *to, uint64_t more) {
    (void)__atomic_fetch_add(to, more, __ATOMIC_RELAXED);
}

void wave_count(struct wave *wave, const struct path_counts *made) {
    struct path_counts *counts = &wave->counts;
    add(&counts->camera_rays, made->camera_rays);
    add(&counts->reflected_rays, made->reflected_rays);
    add(&counts->refracted_rays, made->refracted_rays);
    add(&counts->shadow_rays, made->shadow_rays);
    add(&counts->hits, made->hits);
    add(&counts->medium_events, made->medium_events);
    if (made->clamped)
        (void)__atomic_fetch_add(&counts->clamped, 1, __ATOMIC_RELAXED);
}

void wave_leave_pixels(const struct path_orders *orders) {
    uint64_t pixel = 0;
    for (uint32_t i = 0; i < orders->count; i++)
        for (uint64_t k = path_order_pixels(&orders->all[i]); k > 0; k--)
            path_orders_pixel(orders, pixel++)->samples = orders->all[i].begin;
}

void wave_number_orders(const struct path_orders *orders, struct wave_order *out) {
    uint64_t path = 0, pixel = 0;
    for (uint32_t i = 0; i < orders->count; i++) {
        out[i] = (struct wave_order){orders->all[i], path, pixel};
        path += path_order_paths(&orders->all[i]);
        pixel += path_order_pixels(&orders->all[i]);
    }
}
