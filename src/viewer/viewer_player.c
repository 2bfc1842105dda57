/* Plays an animation. Each frame is a picture of the script. When its pass is finished, it is shown at its time, and
 * the next frame is requested immediately, so that the script and the build of the next world run while it is visible.
 * The number of samples controls the frame rate: the time of a frame that remains after script and building determines
 * how coarse its pass is. Frames are skipped only if the coarsest pass is too slow. Frames have numbers (in the
 * animation) and indices (among the selected frames, from 0). */
#include "viewer/viewer_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Seconds: the minimum duration of a pass, the interval between two checks of the clock, and a delay after which the
 * time starts again, because the machine did other work. */
static const double pass_min = 0.004, clock_step = 0.004, delay_max = 1;
/* Seconds that a frame stays unchanged on the screen while the next one is rendered. */
static const double patience = 0.5;

static uint32_t index_of(const struct viewer_player *player, uint32_t number) {
    return number > player->first ? (number - player->first) / player->step : 0;
}

static uint32_t number_of(const struct viewer_player *player, uint32_t index) {
    return player->first + index * player->step;
}

static double period_of(const struct viewer *viewer) {
    return viewer->player.step / viewer->request.frame.rate;
}

bool viewer_plays(const struct viewer *viewer) {
    return viewer->player.count > 0 && viewer->player.playing;
}

/* The selected frames of this animation; count is at least 1. */
static void select_frames(struct viewer_player *player, const struct frame_selection *selection,
                          const struct frame *frame) {
    bool all = selection->step == 0 || selection->first > frame->count;
    uint32_t last = all || selection->last > frame->count ? frame->count : selection->last;
    player->first = all ? 1 : selection->first;
    player->step = all ? 1 : selection->step;
    player->count = (last - player->first) / player->step + 1;
}

void viewer_player_begin(struct viewer *viewer, const struct viewer *before) {
    const struct frame *frame = &viewer->request.frame;
    struct viewer_player *player = &viewer->player;
    bool continues = viewer_player_continues(before, &viewer->request);
    if (frame->number == 0) {
        *player = (struct viewer_player){0};
        return;
    }
    *player = before->player;
    if (!continues)
        *player = (struct viewer_player){.loops = frame->loops, .restarts_clock = true};
    select_frames(player, &viewer->window.frames, frame);
    player->playing = player->count > 1 && (player->playing || !continues);
    uint32_t last = number_of(player, player->count - 1);
    player->target = player->target > last ? last : player->target;
    if (player->target == frame->number)
        player->target = 0;
    player->seeking = player->shown = false;
    viewer->written = true; /* a played animation writes no files */
    if (!continues)
        return;
    viewer->input = before->input;
    viewer->pass.divide = before->pass.divide;
    viewer->pass.from_coarse = false;
    memcpy(viewer->fly_camera.down, before->fly_camera.down, sizeof viewer->fly_camera.down);
}

bool viewer_player_continues(const struct viewer *before, const struct picture_request *request) {
    return before->window.open && before->player.count > 0 && request->frame.number > 0 &&
           (before->player.seeking || before->keep);
}

/* Commands of the user. */

static void note_played(struct viewer *viewer) {
    const struct viewer_player *player = &viewer->player;
    double seconds = viewer->stepped - player->began;
    if (player->played < 2 || !(seconds > 0))
        return;
    (void)snprintf(viewer->note, sizeof viewer->note,
                   "%.60s: played %u frames in %.1f s, left out %u, one sample for %u x %u pixels",
                   viewer->request.file, player->played, seconds, player->left_out, viewer->pass.view.divide,
                   viewer->pass.view.divide);
}

void viewer_play(struct viewer *viewer, bool on) {
    struct viewer_player *player = &viewer->player;
    on = on && player->count > 1;
    if (on == player->playing)
        return;
    if (!on)
        note_played(viewer);
    player->playing = on;
    player->restarts_clock = true;
    player->played = player->left_out = 0;
    viewer->display.hud_dirty = true;
    viewer->display.figures_at = 0;
    if (on)
        viewer_halt(viewer, false);
    else if (viewer->block && viewer->pass.result == RESULT_COARSE)
        viewer_draw_tiles(viewer); /* a frame that waited for its time */
    /* After the end, playing continues at the first frame. */
    if (on && !player->loops && index_of(player, viewer->request.frame.number) + 1 == player->count)
        player->target = player->first;
}

void viewer_go_to_frame(struct viewer *viewer, uint32_t number) {
    struct viewer_player *player = &viewer->player;
    viewer_play(viewer, false);
    player->target = number;
    player->shown_at = viewer->stepped;
    if (!player->seeking && number == viewer->request.frame.number)
        player->target = 0;
    else
        viewer_halt(viewer, false);
    viewer->display.hud_dirty = true;
}

void viewer_step_frames(struct viewer *viewer, int by) {
    const struct viewer_player *player = &viewer->player;
    if (player->count == 0)
        return;
    uint32_t now = player->target > 0 ? player->target : viewer->request.frame.number;
    int64_t index = (int64_t)index_of(player, now) + by, count = player->count;
    if (player->loops)
        index = (index + count) % count;
    index = index < 0 ? 0 : index >= count ? count - 1 : index;
    viewer_go_to_frame(viewer, number_of(player, (uint32_t)index));
}

void viewer_player_loop(struct viewer *viewer) {
    viewer->player.loops = !viewer->player.loops;
    viewer->display.hud_dirty = true;
}

uint32_t viewer_frame_index(const struct viewer *viewer) {
    const struct viewer_player *player = &viewer->player;
    return index_of(player, player->target > 0 && !player->playing ? player->target : viewer->request.frame.number);
}

uint32_t viewer_frame_number(const struct viewer *viewer, double index) {
    const struct viewer_player *player = &viewer->player;
    double last = player->count - 1;
    return number_of(player, (uint32_t)(index < 0 ? 0 : index > last ? last : floor(index + 0.5)));
}

/* Time. */

void viewer_player_end_pass(struct viewer *viewer, double now) {
    struct viewer_player *player = &viewer->player;
    double took = now - viewer->pass.began, whole = now - player->requested_at;
    if (player->requested_at <= 0 || !viewer->pass.view.plain || viewer->pass.view.divide != viewer->pass.divide)
        return;
    double beside = math_max(0, whole - took);
    const double seconds = math_max(pass_min, period_of(viewer) - beside - clock_step);
    viewer_fit_resolution(viewer, now, seconds, seconds);
    player->requested_at = 0;
}

/* Shows the finished frame if it is due. */
static bool show_frame(struct viewer *viewer, double now) {
    struct viewer_player *player = &viewer->player;
    uint32_t index = index_of(player, viewer->request.frame.number);
    double due = player->origin + ((double)index - player->origin_index) * period_of(viewer);
    /* The clock begins anew where frames cannot keep to it. */
    if (player->restarts_clock || (player->forgives_delay && now > due) || now - due > delay_max ||
        due - now > 2 * period_of(viewer)) {
        player->restarts_clock = false;
        player->origin = due = now;
        player->origin_index = index;
    }
    if (now < due)
        return false;
    /* The rate is a mean that follows the last frames. */
    player->forgives_delay = false;
    if (player->played == 0)
        player->began = now;
    else if (now > player->shown_at)
        player->rate +=
            (1 / (now - player->shown_at) - player->rate) * (player->played < 8 ? 1.0 / player->played : 0.1);
    player->played++;
    player->late = now - due;
    player->shown = true;
    player->shown_at = now;
    viewer_draw_tiles(viewer);
    viewer->display.hud_dirty = true;
    viewer->display.shown_at = 0;
    viewer_show(viewer, now);
    return true;
}

/* The frame after this one: the next one that can be shown in time. */
static uint32_t frame_after_this(struct viewer *viewer) {
    struct viewer_player *player = &viewer->player;
    uint32_t index = index_of(player, viewer->request.frame.number) + 1;
    uint32_t skips = (uint32_t)(player->late / period_of(viewer));
    if (index + skips < player->count) {
        player->left_out += skips;
        return number_of(player, index + skips);
    }
    if (!player->loops && index >= player->count)
        return 0;
    if (index < player->count) /* the last one is not skipped */
        return number_of(player, player->count - 1);
    /* The script may have to run again. */
    player->origin += ((double)index - player->origin_index) * period_of(viewer);
    player->origin_index = 0;
    player->forgives_delay = true;
    return player->first;
}

enum player_decision viewer_player_decide(struct viewer *viewer, double now) {
    struct viewer_player *player = &viewer->player;
    bool waits = viewer->pass.state == PASS_WAITING && viewer->edit.pending.count == 0 && !viewer->edit.click_waits &&
                 !viewer->trace.requested;
    if (player->count == 0 || !waits || viewer->pass.result == RESULT_NONE || viewer->pass.halted)
        return PLAYER_REFINES;
    if (player->target == 0 && player->playing) {
        if (!player->shown && !show_frame(viewer, now))
            return PLAYER_WAITS;
        player->target = frame_after_this(viewer);
        if (player->target == 0)
            viewer_play(viewer, false);
    }
    if (player->target == 0)
        return PLAYER_REFINES;
    player->seeking = true;
    player->requested_at = now;
    return PLAYER_GOES;
}

bool viewer_awaits_frame(const struct viewer *viewer, double now) {
    const struct viewer_player *player = &viewer->player;
    bool next = player->seeking || (player->playing && !player->shown);
    return next && now - player->shown_at < patience;
}
