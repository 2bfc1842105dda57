/* The reports of the render process: lines, warnings about scenes, and the numbers of a picture. */
#include "host/render_reports.h"

#include "base/hash.h"
#include "film/aov.h"
#include "image/image.h"
#include "material/density.h"
#include "session/options.h"
#include "session/options_table.h"
#include "settings/setting.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/resource.h>

/* Writes the output of the script; the supervisor reports failures, once for all scripts. */
void render_process_finish_output(const struct render_process *process) {
    scene_writer_flush(process->errors);
    if (fflush(stdout) != 0 || ferror(stdout))
        atomic_store(&process->services->control->lost, 1);
}

void render_process_report(const struct render_process *process, enum line_kind kind, const char *text) {
    render_process_finish_output(process); /* earlier output of the script comes first */
    process->services->line(process->services->context, kind, text);
}

/* A line whose beginning the scene may have chosen: by a chunk's name, or that of its file. */
void render_process_report_scene(const struct render_process *process, enum line_kind kind, const char *text) {
    const char *mark = scene_mark(text);
    char line[MESSAGE_TEXT_LIMIT];
    if (mark[0] != '\0')
        (void)snprintf(line, sizeof line, "%s%s", mark, text);
    render_process_report(process, kind, mark[0] != '\0' ? line : text);
}

void render_process_say(const struct render_process *process, enum line_kind kind, const char *format, ...) {
    char text[2 * NAME_LIMIT];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    render_process_report_scene(process, kind, text);
}

/* A script may render hundreds of frames of one scene; each warning about it is printed once, by the hash of `key`. */
static bool is_first(struct render_process *process, const char *key) {
    uint64_t hash = hash_bytes(key, strlen(key), 0);
    for (int i = 0; i < process->warned_count; i++) {
        if (process->warned[i] == hash)
            return false;
    }
    if (process->warned_count < WARNINGS_LIMIT)
        process->warned[process->warned_count++] = hash;
    return true;
}

void render_process_notice_once(struct render_process *process, const char *key, const char *text) {
    if (is_first(process, key))
        render_process_report_scene(process, LINE_NOTICE, text);
}

static void warn_once(struct render_process *process, const char *key, const char *text) {
    static const char word[] = "warning: ";
    if (!is_first(process, key))
        return;
    bool has_word = strncmp(text, word, strlen(word)) == 0;
    render_process_say(process, LINE_WARNING, "%s: %s%s", process->script, has_word ? "" : word, text);
}

void render_process_warn(void *context, const char *text) {
    warn_once(context, text, text);
}

void render_process_count_replaced(struct render_process *process, uint64_t fields) {
    uint64_t options = 0;
    for (int i = 0; i < setting_field_count; i++) {
        if (!(fields >> i & 1))
            continue;
        int option = script_option_given(&process->options->script, i) ? i : setting_rival(i);
        options |= UINT64_C(1) << option;
        process->replaced[option].fields |= UINT64_C(1) << i;
    }
    for (int i = 0; i < setting_field_count; i++)
        process->replaced[i].pictures += options >> i & 1;
}

/* "--integrator path replaces the fields integrator and style of 3 pictures" */
void render_process_report_replaced(const struct render_process *process) {
    for (int i = 0; i < setting_field_count; i++) {
        const struct setting *row = &setting_table[i];
        const struct replaced_fields *replaced = &process->replaced[i];
        if (replaced->pictures == 0)
            continue;
        const char *value = process->options->script.given[i];
        bool needs_sign = row->kind == SETTING_FLAG || row->kind == SETTING_DENOISE;
        const char *joint = value[0] == '\0' ? "" : needs_sign ? "=" : " ";
        const char *rival = replaced->fields & ~(UINT64_C(1) << i) ? setting_table[setting_rival(i)].field : "";
        bool own = replaced->fields >> i & 1, both = own && rival[0] != '\0';
        render_process_say(
            process, LINE_NOTICE, "%.4000s: %.*s%s%.64s replaces the field%s %s%s%s of %" PRIu64 " picture%s",
            process->script, (int)strcspn(row->option, "|"), row->option, joint, value, both ? "s" : "",
            own ? row->field : "", both ? " and " : "", rival, replaced->pictures, replaced->pictures > 1 ? "s" : "");
    }
}

void render_process_warn_at(struct render_process *process, const char *where, const char *text) {
    char line[1024];
    (void)snprintf(line, sizeof line, "%.700s: %s", where, text);
    warn_once(process, text, line);
}

/* After a picture: reports the functions that returned NaN at a hit. */
void render_process_warn_of_nan(struct render_process *process, const struct world *world) {
    char line[1024];
    const struct texture_tables *textures = &world->surfaces.textures;
    for (uint32_t i = 0; i < textures->count; i++) {
        const struct texture_operation *operation = &textures->operations[i];
        const struct texture_nan *nan = operation->kind == TEXTURE_FUNCTION ? operation->recorded.nan : NULL;
        const char *source = world->authored.textures[i]->source;
        if (!nan || !nan->found)
            continue;
        (void)snprintf(line, sizeof line,
                       "the function of %.400s is not a number (NaN) at p = {%.6g, %.6g, %.6g}; it counts as 0 there",
                       source, nan->point[0], nan->point[1], nan->point[2]);
        warn_once(process, source, line);
    }
}

void render_process_warn_of_density(struct render_process *process, const struct world *world) {
    for (uint32_t i = 0; i <= world->media.outside; i++) {
        for (const struct medium *medium = &world->media.all[i]; medium; medium = medium->inner) {
            struct box cell;
            double bound;
            char line[512];
            if (!medium->density || !density_excess(medium->density, &cell, &bound))
                continue;
            (void)snprintf(line, sizeof line,
                           "the density of a medium is above its bound %.6g, which counts there, between p = {%.6g, "
                           "%.6g, %.6g} and {%.6g, %.6g, %.6g} (bound = NUMBER is another one)",
                           bound, cell.min.x, cell.min.y, cell.min.z, cell.max.x, cell.max.y, cell.max.z);
            warn_once(process, "density", line);
        }
    }
}

void render_process_fill_report(const struct picture_work *work, const struct film *film,
                                struct picture_report *report) {
    const struct world *world = &work->world;
    struct rusage usage;
    struct error ignored;
    size_t film_bytes = 0;
    report->primitives = world->primitive_count;
    report->triangles = world->triangles;
    report->mesh_bytes = world->mesh_memory;
    report->primitive_bytes = world_primitive_memory(world);
    report->search_bytes = scene_accel_memory(&world->accel) + mesh_group_memory(&world->group);
    report->image_bytes = 0;
    for (const struct asset_image *entry = work->process->assets.images; entry; entry = entry->next)
        report->image_bytes += image_memory(entry->image);
    memcpy(report->grid_cells, world->accel.grid.cells, sizeof report->grid_cells);
    report->node_bytes = work->request->scene->arena.total;
    (void)film_size_layered(film->width, film->height, film->record, aov_layers(film->layer_mask), &film_bytes,
                            &ignored);
    report->film_bytes = film_bytes;
    report->threads = pool_workers(work->process->pool);
    if (getrusage(RUSAGE_SELF, &usage) == 0)
        report->peak_bytes = (uint64_t)usage.ru_maxrss * 1024;
}

void render_process_report_world(const struct render_process *process, const char *file,
                                 const struct picture_report *report) {
    char grid[64] = "";
    const uint32_t *cells = report->grid_cells;
    if (cells[0] > 0) /* not a hierarchy, a kd-tree or none */
        (void)snprintf(grid, sizeof grid, " grid of %u x %u x %u,", cells[0], cells[1], cells[2]);
    render_process_say(process, LINE_DETAIL, "%s: %s: %llu primitives, %llu triangles,%s built in %.3f s, %d threads",
                       process->script, file, (unsigned long long)report->primitives,
                       (unsigned long long)report->triangles, grid, report->rays.build_seconds, report->threads);
}

/* The name that -o gives the picture; that of the script if -o names many pictures or a stream. `room` is its
 * storage. */
static const char *shown_name(const struct picture_work *work, char room[NAME_LIMIT]) {
    const struct options *options = work->process->options;
    const struct frame *frame = &work->picture_request.frame;
    if (!options->output || options_output_is_stream(options) || options->animation != ANIMATION_NONE)
        return work->name;
    if (!output_name_numbered(options->output))
        return options->output;
    bool numbered = frame->number > 0 && output_name(options->output, frame->before + frame->number, room, NAME_LIMIT);
    return numbered ? room : work->name;
}

/* With --time-limit the number of samples that were possible, with --noise the number that were needed, or the limit
 * that came first. */
void render_process_report_samples(const struct picture_work *work) {
    const struct settings *settings = &work->job.settings;
    const struct render_statistics *rays = &work->report.rays;
    char words[256], room[NAME_LIMIT];
    bool has_limit = settings->noise > 0 || settings->time_limit > 0;
    if (!has_limit || work->picture_request.in_window || rays->pixels == 0 ||
        (!integrator_traits(settings->integrator).progressive && rays->late_pixels == 0))
        return;
    /* The limit that ended the samples decides the sentence. */
    double mean = (double)rays->samples / (double)rays->pixels;
    unsigned long long samples = rays->passes_samples;
    if (rays->late_pixels > 0)
        (void)snprintf(
            words, sizeof words,
            "%.2g %% of the pixels have fewer samples than they need: --time-limit ended the rest after %.1f s",
            100 * (double)rays->late_pixels / (double)rays->pixels, rays->render_seconds);
    else if (!(settings->noise > 0))
        (void)snprintf(words, sizeof words, "%llu sample%s per pixel in %.1f s (--spp %llu makes the same picture)",
                       samples, samples == 1 ? "" : "s", rays->render_seconds, samples);
    else if (!rays->noisy)
        (void)snprintf(words, sizeof words, "%.1f samples per pixel, for a noise of %g", mean, settings->noise);
    else if (rays->out_of_time)
        (void)snprintf(words, sizeof words,
                       "%.1f samples per pixel in %.1f s (--time-limit); parts have more noise than %g", mean,
                       rays->render_seconds, settings->noise);
    else
        (void)snprintf(words, sizeof words, "%.1f samples per pixel, at most %u (--spp); parts have more noise than %g",
                       mean, settings_path_samples(settings), settings->noise);
    render_process_say(work->process, LINE_NOTICE, "%s: %s: %s", work->process->script, shown_name(work, room), words);
}

/* --- options and fields without effect --- */

/* Notices about options and fields that have no effect on a picture (setting_effect): once in a run for each option,
 * once for each line of a script with such a field. An option on the command line chooses the integrator for scenes
 * that were written for another one, so their fields get no notice then. */

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
        return integrator_traits(settings->integrator).has_styles;
    case EFFECT_TREES:
        return !integrator_traits(settings->integrator).progressive;
    case EFFECT_RADIOSITY:
        return settings->integrator == INTEGRATOR_RADIOSITY;
    case EFFECT_PATH:
        return integrator_traits(settings->integrator).progressive;
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
        render_process_say(process, LINE_NOTICE,
                           "%.4095s: all %u frames are equal: nothing in them depends on gr.time, gr.clock or gr.frame "
                           "(--turntable N moves the camera)",
                           process->script, (unsigned)process->frames_shown);
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
        bool field = i < setting_field_count && !option && !by_integrator && work->request->fields >> i & 1;
        if ((!option && !field) || is_off(row, set ? (const void *)&work->job.settings : (const void *)options) ||
            has_effect(row->effect, work, file))
            continue;
        /* An option is reported once in a run, a field once for each line of the script. */
        bool *vain = &process->vain[i];
        if (option && *vain)
            continue;
        *vain = *vain || option;
        (void)snprintf(key, sizeof key, "%.1400s: %.*s", work->request->where,
                       option ? (int)strcspn(row->option, "|") : 64, option ? row->option : row->field);
        (void)snprintf(line, sizeof line, "%s has no effect: it is for %s", key, words[row->effect]);
        render_process_notice_once(process, key, line);
    }
}
