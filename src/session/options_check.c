/* Checks options that exclude, require or imply one another. */
#include "session/options_check.h"
#include "session/options_internal.h"

#include "formats/model.h"
#include "formats/model_format.h"
#include "image/picture_file.h"

#include <string.h>
#include <strings.h>

static bool check_together(const struct options *options, struct error *error) {
    /* Actions other than rendering. */
    bool merge = options->action == ACTION_MERGE;
    if (options->action == ACTION_COMPARE)
        return options->script_count == 2 || error_set(error, ERROR_USAGE, "compare needs two pictures");
    if (options->action == ACTION_VIEW)
        return options->script_count == 1 || error_set(error, ERROR_USAGE, "view needs one light field or panorama");
    const char *of_view = options->eyes           ? "--eye"
                          : options->directions   ? "--direction"
                          : options->focus > 0    ? "--focus"
                          : options->aperture > 0 ? "--aperture"
                          : options->fov > 0      ? "--fov"
                                                  : NULL;
    if (of_view)
        return error_set(error, ERROR_USAGE, "%s is for gray view; the camera of a scene has fields of gr.render",
                         of_view);
    if (options->threshold > 0)
        return error_set(error, ERROR_USAGE, "--threshold is for gray compare; the noise of a picture is --noise X");
    if (options->action != ACTION_RENDER && !merge)
        return true;
    if (options->script_count == 0 && (merge || !options->window)) /* a window may be empty */
        return error_set(error, ERROR_USAGE, merge ? "no parts to merge were given" : "no scene script was given");
    /* The names of scripts. */
    for (int i = 0; i < options->script_count; i++) {
        if (options->scripts[i][0] == '\0')
            return error_set(error, ERROR_USAGE, "the name of a script is empty");
        if (strcmp(options->scripts[i], "-") == 0)
            return error_set(error, ERROR_USAGE, "scripts are not read from standard input; give the name of a file");
        bool for_model = options->script.camera || options->script.up != MODEL_UP_AUTO;
        if (for_model && !merge && !model_is_named(options->scripts[i]))
            return error_set(error, ERROR_USAGE,
                             options->script.camera
                                 ? "--camera is for models, but %.600s is a script: the field eye of its gr.render is "
                                   "its camera"
                                 : "--up is for models, but %.600s is a script: the field up of its gr.render is up",
                             options->scripts[i]);
    }
    /* Files that would have one name, or none. */
    if (options->targets_prefix && options->first_pass_prefix &&
        strcmp(options->targets_prefix, options->first_pass_prefix) == 0)
        return error_set(error, ERROR_USAGE, "-write-aa-targets and -write-pre-aa would write the same file");
    if (options->output && strcmp(options->output, "-") == 0 && (options->targets_prefix || options->first_pass_prefix))
        return error_set(error, ERROR_USAGE, "with -o - there is no file name for -write-aa-targets and -write-pre-aa");
    if (options->output && strcmp(options->output, "-") == 0 && options->settings.aov)
        return error_set(error, ERROR_USAGE, "with -o - there is no file name for --aov");
    if (options->output && strcmp(options->output, "-") == 0 && options->statistics == STATISTICS_JSON)
        return error_set(error, ERROR_USAGE, "-o - and --stats=json both write to standard output");
    return true;
}

/* --pixel, --dump-scene and --dump-expr. */
static bool check_questions(const struct options *options, struct error *error) {
    const char *asked = options->pixel_count > 0 ? "--pixel" : options->dump_scene ? "--dump-scene" : "--dump-expr";
    if (options->pixel_count == 0 && !options->dump_scene && !options->dump_expr)
        return !options->json || error_set(error, ERROR_USAGE, "--json needs --pixel, --dump-scene or --dump-expr");
    if (options->window || options->check || options->shards || options->shards_of_pictures || options->mpi ||
        options->checkpoint || options->resume)
        return error_set(error, ERROR_USAGE,
                         "%s renders nothing: it cannot be combined with -gui, --check, --shard, --mpi, --checkpoint "
                         "or --resume",
                         asked);
    return true;
}

static bool check_bake(const struct options *options, struct error *error) {
    if (!options->bake)
        return true;
    if (model_format_baked(options->bake) == FORMAT_OTHER)
        return error_set(error, ERROR_USAGE, "--bake %.400s: the name must end in .ply or .glb", options->bake);
    return options->script_count == 1 || error_set(error, ERROR_USAGE, "--bake writes the light of one script");
}

/* -o MODEL and --check-print: no picture is rendered, unless another -o names one. */
static bool check_model(const struct options *options, struct error *error) {
    bool model = options->model || options->check_print;
    bool is_scene = options->model && model_format_is_scene(model_format_written(options->model));
    const struct frame_selection *frames = &options->script.frames.selection;
    const char *only = options->tolerance > 0 ? "--tolerance"
                       : options->node        ? "--node"
                       : options->picture > 0 ? "--picture"
                                              : NULL;
    if (!model)
        return !only || error_set(error, ERROR_USAGE, "%s is only for -o MODEL, such as -o part.stl", only);
    if (options->script_count != 1)
        return error_set(error, ERROR_USAGE, "a model is made of one script");
    if (options->other_model)
        return error_set(error, ERROR_USAGE, "-o %.400s, -o %.400s: a run writes one model", options->other_model,
                         options->model);
    if (options->window || options->shards || options->shards_of_pictures || options->mpi || options->watch)
        return error_set(error, ERROR_USAGE,
                         "-o MODEL and --check-print cannot be combined with -gui, --shard, --mpi or --watch");
    if (is_scene && options->check_print)
        return error_set(error, ERROR_USAGE, "--check-print is for solids, not for scenes such as %.400s",
                         options->model);
    return frames->step == 0 || frames->first == frames->last || is_scene ||
           error_set(error, ERROR_USAGE, "a model shows one frame: --frames N-N chooses it");
}

static bool ends(const char *name, const char *with) {
    size_t length = name ? strlen(name) : 0, end = strlen(with);
    return length > end && strcasecmp(name + length - end, with) == 0;
}

/* --to-json, --to-lua, or -o with their endings. */
static bool check_scene_text(struct options *options, struct error *error) {
    options->to_json |= ends(options->output, ".json");
    options->to_lua |= ends(options->output, ".lua");
    const char *option = options->to_json ? "--to-json" : "--to-lua";
    if (!options->to_json && !options->to_lua)
        return true;
    if (options->to_json && options->to_lua)
        return error_set(error, ERROR_USAGE, "--to-json and --to-lua write different files; give one of them");
    if (options->output && strcmp(options->output, "-") != 0 &&
        !ends(options->output, options->to_json ? ".json" : ".lua"))
        return error_set(error, ERROR_USAGE, "%s -o %.400s: the name must end in %s", option, options->output,
                         options->to_json ? ".json" : ".lua");
    if (options->window || options->check || options->shards || options->shards_of_pictures || options->mpi ||
        options->checkpoint || options->resume || options->watch || options->model || options->check_print ||
        options->script.lenient || options->script.frames.turntable > 0)
        return error_set(error, ERROR_USAGE,
                         "%s renders nothing: it cannot be combined with -gui, --check, --shard, --mpi, --checkpoint, "
                         "--resume, --watch, --lenient, --turntable or a model",
                         option);
    return true;
}

static const char tev_port[] = "14158";

static bool take_word(const char **text, char *out, size_t size) {
    size_t length = strcspn(*text, ":");
    if (length == 0 || length >= size)
        return false;
    memcpy(out, *text, length);
    out[length] = '\0';
    *text += length;
    return true;
}

bool display_parse(const char *text, struct display_choice *out) {
    static const char *const graphics[] = {TERMINAL_GRAPHICS(LIST_WORD)};
    *out = (struct display_choice){.host = "127.0.0.1"};
    /* tev, with a host, with a port. */
    memcpy(out->port, tev_port, sizeof tev_port);
    if (strncmp(text, "tev", 3) == 0 && (text[3] == '\0' || text[3] == ':')) {
        out->kind = DISPLAY_TEV;
        text += 3;
        if (*text++ == '\0')
            return true;
        if (!take_word(&text, out->host, sizeof out->host))
            return false;
        if (*text++ == '\0')
            return true;
        return take_word(&text, out->port, sizeof out->port) && *text == '\0' &&
               out->port[strspn(out->port, "0123456789")] == '\0';
    }
    if (strncmp(text, "term", 4) != 0 || (text[4] != '\0' && text[4] != ':'))
        return false;
    /* "term" alone: gray asks the terminal what it can draw. */
    out->kind = DISPLAY_TERMINAL;
    for (int i = 0; i < LIST_COUNT(TERMINAL_GRAPHICS); i++) {
        if (text[4] == '\0' || strcmp(text + 5, graphics[i]) == 0) {
            out->graphics = text[4] ? (enum terminal_graphics)i : TERMINAL_AUTO;
            return true;
        }
    }
    return false;
}

/* The conditions between --checkpoint, --resume, --shard and -o. */
static bool check_parts(struct options *options, struct error *error) {
    bool pipe = options->output && strcmp(options->output, "-") == 0;
    struct display_choice display;
    if (options->display && !display_parse(options->display, &display))
        return error_set(error, ERROR_USAGE,
                         "--display needs tev, tev:HOST, tev:HOST:PORT, term, term:kitty, term:sixel or term:blocks, "
                         "not '%s'",
                         options->display);
    if (options->display &&
        (options->window || options->check || options->shards || (pipe && display.kind == DISPLAY_TERMINAL)))
        return error_set(error, ERROR_USAGE,
                         "--display cannot be combined with -gui, --check or --shard, and term not with -o -");
    /* --resume alone means the checkpoint with the name of the picture. */
    if (options->resume && !options->checkpoint)
        options->checkpoint = "auto";
    if (options->mpi && (options->shards || options->shards_of_pictures || options->no_fork || options->check))
        return error_set(error, ERROR_USAGE,
                         "--mpi cannot be combined with --shard, --shard-pictures, --no-fork or --check");
    if (options->window && (options->checkpoint || options->shards || options->shards_of_pictures || options->mpi ||
                            options->no_fork || options->check || options->settings.aov))
        return error_set(
            error, ERROR_USAGE,
            "-gui cannot be combined with --checkpoint, --resume, --shard, --mpi, --no-fork, --check or --aov");
    if (options->watch && (options->checkpoint || options->shards || options->shards_of_pictures || options->mpi ||
                           options->no_fork || pipe))
        return error_set(error, ERROR_USAGE,
                         "--watch cannot be combined with --checkpoint, --resume, --shard, --mpi, --no-fork or -o -");
    if (options->no_fork && (options->checkpoint || options->shards))
        return error_set(error, ERROR_USAGE,
                         "--no-fork is for debuggers: it cannot be combined with --checkpoint, --resume or --shard");
    if (pipe && options->checkpoint && !options_are_named(options->checkpoint))
        return error_set(error, ERROR_USAGE,
                         "with -o - there is no file name for a checkpoint; --checkpoint FILE sets one");
    if (pipe && options_keep_solution(options) && !options_are_named(options->radiosity_file))
        return error_set(error, ERROR_USAGE,
                         "with -o - there is no file name for a solution of radiosity; --radiosity-file FILE sets one");
    if (pipe && options->shards)
        return error_set(error, ERROR_USAGE, "with -o - there is no file name for the parts of --shard");
    if ((options->shards || options->mpi || options->checkpoint) && options->settings.aov)
        return error_set(
            error, ERROR_USAGE,
            "--aov works only for pictures that one process renders at once: no --shard, --mpi, --checkpoint or "
            "--resume");
    if ((options->shards || options->mpi || options->checkpoint) && options->settings.overlay != OVERLAY_NONE)
        return error_set(
            error, ERROR_USAGE,
            "--overlay works only for pictures that one process renders at once: no --shard, --mpi, --checkpoint or "
            "--resume");
    if (options->shards && (options->targets_prefix || options->first_pass_prefix))
        return error_set(error, ERROR_USAGE, "--shard writes no debug pictures; give -write-... to gray merge");
    return true;
}

/* --time-limit: the number of samples of a picture is known only when it is finished. */
static bool check_time(const struct options *options, struct error *error) {
    if (options->settings.time_limit > 0 && (options->shards || options->mpi || options->checkpoint))
        return error_set(error, ERROR_USAGE,
                         "--time-limit cannot be combined with --shard, --mpi, --checkpoint or --resume: their parts "
                         "would have different numbers of samples; use --spp N");
    return true;
}

/* By the extension. */
static enum animation_format animation_of(const char *output) {
    static const char *const endings[] = {ANIMATION_FORMATS(LIST_WORD)};
    const char *dot = output ? strrchr(output, '.') : NULL;
    if (!dot || strchr(dot, '/'))
        return ANIMATION_NONE;
    for (int i = ANIMATION_NONE + 1; i < LIST_COUNT(ANIMATION_FORMATS); i++) {
        if (strcasecmp(dot, endings[i]) == 0)
            return (enum animation_format)i;
    }
    return ANIMATION_NONE;
}

static bool check_name(const struct options *options, struct error *error) {
    const char *output = options->output;
    char extensions[PICTURE_EXTENSIONS_SIZE];
    if (!output || !output_name_numbered(output))
        return true;
    if (output_name_numbered_twice(output))
        return error_set(error, ERROR_USAGE, "-o %.600s: a name has one number: %%d, %%04d or ####", output);
    return animation_of(output) == ANIMATION_NONE ||
           error_set(error, ERROR_USAGE,
                     "-o %.600s: %s is one file of all frames, without a number; names with a number end in %s", output,
                     strrchr(output, '.'), picture_extensions(extensions));
}

/* Frames are kept until the animation is complete, as if --checkpoint auto were given. */
static bool check_animation(struct options *options, struct error *error) {
    const struct settings *settings = &options->settings;
    options->animation = animation_of(options->output);
    /* Options that would have no effect without an animation. */
    if (options->animation == ANIMATION_NONE) {
        bool sheet = options->contact_sheet && options->action != ACTION_VIEW;
        const char *only = options->keep_frames ? "--keep-frames" : sheet ? "--contact-sheet" : NULL;
        if (options->action == ACTION_MERGE && !only)
            only = options->script.frames.rate > 0 ? "--fps"
                   : options->script.frames.loops  ? "--loop"
                   : options->frame_palettes       ? "--palette"
                                                   : NULL;
        return !only || error_set(error, ERROR_USAGE, "%s is only for animations, such as -o x.gif", only);
    }
    if (options->window || settings->aov || options->targets_prefix || options->first_pass_prefix)
        return error_set(error, ERROR_USAGE,
                         "-o %.600s is an animation: it cannot be combined with -gui, --aov, -write-aa-targets or "
                         "-write-pre-aa",
                         options->output);
    /* An interrupted animation continues: its frames are kept without an option. */
    bool questions = options->pixel_count > 0 || options->dump_scene || options->dump_expr;
    if (options->checkpoint || options->no_fork || options->watch || options->check || questions ||
        options->action != ACTION_RENDER || settings->time_limit > 0 || settings->overlay != OVERLAY_NONE)
        return true;
    options->checkpoint = "auto";
    options->checkpoint_implied = true;
    return true;
}

/* What an interruption leaves. */
static void choose_kept(struct options *options) {
    const struct settings *settings = &options->settings;
    bool questions = options->pixel_count > 0 || options->dump_scene || options->dump_expr;
    bool others = options->shards || options->mpi || options->no_fork || options->watch || options->check;
    options->keeps_picture = options->partial && options->action == ACTION_RENDER && !questions && !others &&
                             !options_output_is_stream(options);
    options->keeps_tiles = options->keeps_picture && !options->checkpoint && settings->time_limit <= 0 &&
                           !settings->aov && settings->overlay == OVERLAY_NONE;
}

bool options_check(struct options *options, struct error *error) {
    bool ok = check_together(options, error) && check_questions(options, error) && check_model(options, error) &&
              check_scene_text(options, error) && check_bake(options, error) && check_parts(options, error) &&
              check_time(options, error) && check_name(options, error) && check_animation(options, error);
    if (ok)
        choose_kept(options);
    return ok;
}
