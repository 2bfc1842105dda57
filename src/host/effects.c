/* Notices about options and fields that have no effect on a picture (setting_effect): once in a run for each option,
 * once for each line of a script with such a field. An option on the command line chooses the integrator for scenes
 * that were written for another one, so their fields get no notice then. */
#include "host/render_process_internal.h"

#include "session/options.h"
#include "settings/setting.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

static bool is_linear_file(const struct picture_work *work, const char *file) {
    const char *dot = strrchr(file, '.');
    bool linear = dot && (!strcasecmp(dot, ".pfm") || !strcasecmp(dot, ".hdr") || !strcasecmp(dot, ".exr"));
    return linear && !work->picture_request.in_window && !work->process->options->display;
}

static bool has_effect(enum setting_effect effect, const struct picture_work *work, const char *file) {
    const struct settings *settings = &work->job.settings;
    switch (effect) {
    case EFFECT_ALWAYS:
        return true;
    case EFFECT_WHITTED:
        return settings->integrator == INTEGRATOR_WHITTED;
    case EFFECT_PATH:
        return settings->integrator == INTEGRATOR_PATH;
    case EFFECT_TOON:
        return settings->style == STYLE_TOON;
    case EFFECT_DISPLAY:
        return !is_linear_file(work, file);
    case EFFECT_BYTES:
        return !is_linear_file(work, file) && !settings->deep;
    case EFFECT_FRAMES:
        return work->request->frame.number > 0 || work->process->options->animation != ANIMATION_NONE;
    case EFFECT_GIF:
        return work->process->options->animation == ANIMATION_GIF;
    }
    return true;
}

/* A value that turns something off is never in vain. */
static bool is_off(const struct setting *row, const void *base) {
    uint64_t bits = setting_bits(row, base);
    return bits == 0 || (row->kind == SETTING_DENOISE && bits == DENOISER_NONE);
}

/* Whether the film is that of the picture before. --check and other processes leave films without pixels here. */
void effects_count_frame(struct picture_work *work) {
    struct render_process *process = work->process;
    const struct film *film = &work->film;
    struct digest seen = {0};
    if (film->pixels && !work->job.handout && !work->picture_request.check && !work->picture_request.in_window)
        seen = digest_bytes(film->pixels, (size_t)film->width * film->height * sizeof *film->pixels, seen);
    if (process->frames_shown == 0)
        process->first_frame = seen;
    process->frames_differ |= digest_is_zero(seen) || !digest_equal(seen, process->first_frame);
    process->frames_shown++;
}

void effects_note_frames(struct render_process *process) {
    const struct options *options = process->options;
    bool one = options->animation != ANIMATION_NONE && options->script.frames.selection.step == 0;
    char line[NAME_LIMIT + 256];
    if (options->watch || options->check || options->window)
        return;
    if (process->frames_shown == 1 && one) {
        (void)snprintf(line, sizeof line,
                       "gray: %.600s has one frame: --frames N runs the script for N of them, and gr.frames draws them",
                       options->output);
        render_process_report(process, LINE_NOTICE, line);
    } else if (process->frames_shown > 1 && !process->frames_differ) {
        (void)snprintf(line, sizeof line,
                       "%.4095s: all %u frames are equal: nothing in them depends on gr.time, gr.clock or gr.frame "
                       "(--turntable N moves the camera)",
                       process->script, (unsigned)process->frames_shown);
        render_process_report_scene(process, LINE_NOTICE, line);
    }
}

void effects_note(struct picture_work *work) {
    static const char *const words[] = {SETTING_EFFECTS(LIST_WORD)};
    struct render_process *process = work->process;
    const struct options *options = process->options;
    const char *const *given = options->script.given;
    const char *file = options->output ? options->output : work->request->file;
    char line[2048], key[1600];
    for (int i = 0; i < option_count(); i++) {
        const struct setting *row = option_at(i);
        bool set = i < setting_count, by_integrator = given && given[SETTING_INDEX(integrator)];
        bool option = set ? given && given[i] : row->effect != EFFECT_ALWAYS;
        bool field = set && !option && !by_integrator && work->request->fields >> i & 1;
        if ((!option && !field) || is_off(row, set ? (const void *)&work->job.settings : (const void *)options) ||
            has_effect(row->effect, work, file))
            continue;
        uint64_t bit = UINT64_C(1) << (set ? i : i - setting_count), *vain = &process->vain[!set];
        if (option && *vain & bit)
            continue;
        *vain |= option ? bit : 0;
        (void)snprintf(key, sizeof key, "%.1400s: %.*s", work->request->where,
                       option ? (int)strcspn(row->option, "|") : 64, option ? row->option : row->field);
        (void)snprintf(line, sizeof line, "%s has no effect: it is for %s", key, words[row->effect]);
        render_process_notice_once(process, key, line);
    }
}
