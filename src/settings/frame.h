/* Frames of an animation: their numbers, and their times. Frames are numbered from 1 everywhere. */
#ifndef GRAY_SETTINGS_FRAME_H
#define GRAY_SETTINGS_FRAME_H

#include <stdbool.h>
#include <stdint.h>

enum { FRAMES_MAX = 10000000 };
#define FRAME_RATE_MIN 0.01
#define FRAME_RATE_MAX 1000.0
#define FRAME_RATE_DEFAULT 30.0

/* One frame of `count`; number 0: a picture outside of animations. */
struct frame {
    uint32_t number, count;
    double rate;     /* frames per second */
    bool loops;      /* after the last frame comes the first */
    uint32_t before; /* --turntable: number of frames of the previous pictures, which -o also counts */
};

/* The frames that a run renders: first, first + step ... up to last. Zero value: all. */
struct frame_selection {
    uint32_t first, last, step;
};

/* The options of the command line for animations. */
struct frame_options {
    struct frame_selection selection; /* --frames */
    double rate;                      /* --fps, or 0 */
    bool loops;                       /* --loop */
    int turntable;                    /* --turntable: the number of its frames, or 0 */
};

/* Seconds since the first frame. */
static inline double frame_time(const struct frame *frame) {
    return frame->number > 0 ? (frame->number - 1) / frame->rate : 0;
}

/* From 0 on: below 1 in a loop, otherwise 1 for the last frame. */
static inline double frame_clock(const struct frame *frame) {
    uint32_t steps = frame->loops ? frame->count : frame->count - 1;
    return frame->number > 1 ? (double)(frame->number - 1) / steps : 0;
}

static inline bool frame_is_selected(const struct frame_selection *selection, uint32_t number) {
    if (selection->step == 0)
        return true;
    return number >= selection->first && number <= selection->last &&
           (number - selection->first) % selection->step == 0;
}

/* The selected frame that follows; 0: none. */
static inline uint32_t frame_after(const struct frame_selection *selection, const struct frame *frame) {
    uint32_t last = selection->step > 0 && selection->last < frame->count ? selection->last : frame->count;
    for (uint32_t number = frame->number + 1; number <= last; number++) {
        if (frame_is_selected(selection, number))
            return number;
    }
    return 0;
}

#endif
