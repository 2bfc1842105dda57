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

/* A solid that a ray may meet first, and that it has not asked yet. */
struct wave_question {
    uint32_t state, primitive;
    uint32_t next; /* of the same path: its number and 1; 0: it was the last */
};

struct wave {
    const struct path_scene *scene;
    const struct wave_order *orders;
    uint32_t order_count;
    char *pixels;        /* of all orders */
    uint64_t pixel_size; /* bytes */
    uint64_t first;      /* path of the wave */
    uint32_t count;      /* of paths */
    /* States of an even turn before shade, of an odd one from shade on; and the reverse. Where the states of the turn
     * are not, from shade on, is the light that they ask for. Room for `count`, as in all that follow. */
    char *states[2];
    char *results;
    uint64_t state_size, result_size; /* path_wave_state_size, path_wave_result_size */
    uint32_t *living[2];              /* numbers of states, in any order: of an even turn, of an odd one */
    uint32_t living_count[2];
    uint32_t class_count[PATH_CLASSES], class_used[PATH_CLASSES]; /* of the turn: paths, and those that have moved */
    /* With path_scene_leaves_solids, of a turn: questions, in any order, and their answers; more than there is room for
     * are answered at once. By state: the number of its first question and 1, or 0. */
    struct wave_question *questions;
    char (*answers)[PATH_ANSWER_ROOM];
    uint32_t *first_question, *asked; /* asked: the questions by their classes (path_wave_question_class) */
    uint32_t question_count, room;    /* of questions; the count may be larger than the room */
    uint32_t question_class_count[PATH_CLASSES], question_class_used[PATH_CLASSES];
    struct path_counts counts; /* of all waves, when they are made */
    bool met_fault;
};

/* Sets where the states, lists, questions and results of so many paths lie in one block of memory. Returns its bytes.
 */
uint64_t wave_lay(struct wave *wave, const struct path_scene *scene, uint64_t address, uint32_t room);
/* Path i of the wave; counts it among the living of turn 0. */
void wave_begin(struct wave *wave, struct path_lane *lane, uint32_t i);
/* Living path k of the turn. If there are solids to ask: question k, in any order and then by classes; and living path
 * k again, which keeps its answers. */
void wave_extend(struct wave *wave, struct path_lane *lane, uint32_t turn, uint32_t k);
uint32_t wave_questions(const struct wave *wave);
void wave_sort_question(struct wave *wave, uint32_t k);
void wave_ask(struct wave *wave, struct path_lane *lane, uint32_t turn, uint32_t k);
void wave_keep(struct wave *wave, uint32_t turn, uint32_t k);
/* sort moves the state of living path k to those of the same class (path_wave_class). Then state k; the last one counts
 * it among those of the next turn. */
void wave_sort(struct wave *wave, uint32_t turn, uint32_t k);
void wave_shade(struct wave *wave, struct path_lane *lane, uint32_t turn, uint32_t k);
void wave_shadow(struct wave *wave, struct path_lane *lane, uint32_t turn, uint32_t k);
/* Runs beside wave_shade: empties the list of the next turn, the classes and the questions. */
void wave_clear_next(struct wave *wave, uint32_t turn);
/* Pixel i of those that have paths in the wave. A pixel that has lost a sample gets no more, so that it lacks them in
 * the end. */
void wave_add(struct wave *wave, uint32_t i);
uint32_t wave_pixels(const struct wave *wave);
/* Adds the counts of a lane to those of the wave. */
void wave_count(struct wave *wave, const struct path_counts *made);
/* From a fault of the scene on, threads make all pixels, and note where it is. */
void wave_leave_pixels(const struct path_orders *orders);
/* out: orders->count of them. */
void wave_number_orders(const struct path_orders *orders, struct wave_order *out);

#endif
