/* A name from a scene is untrusted: it must have the extension of a picture, be in a folder where scenes may write
 * pictures, and may only replace a picture. A name from the command line is trusted. */
#include "output/picture_files.h"

#include "base/error.h"
#include "film/aov.h"
#include "film/tile_file.h"
#include "formats/model_format.h"
#include "image/animation.h"
#include "image/picture_file.h"
#include "image/png_write.h"
#include "output/layers_internal.h"
#include "output/solution_file_internal.h"

#include <stdio.h>
#include <string.h>

/* Picture or part, two debug pictures, all layers. */
enum { FIRST_LAYER = 3, FILES_LIMIT = FIRST_LAYER + AOV_COUNT };

void picture_files_init(struct picture_files *files, const struct options *options) {
    static const char advice[] = " (-o FILE chooses another file)";
    bool by_user = options->output != NULL;
    memset(files, 0, sizeof *files);
    files->options = options;
    files->interrupt.descriptor = -1;
    char size[SIZE_WORDS];
    files->quota.limit = options_picture_bytes(options);
    (void)snprintf(files->quota.words, sizeof files->quota.words,
                   "the pictures of the run take more than %s (--picture-bytes allows more)",
                   size_words(files->quota.limit, size));
    /* Names that scripts choose lie below these folders; those of the user may lie anywhere. */
    bool ok = path_policy_add(&files->folders, ".", PATH_POLICY_WRITE, &files->folders_error);
    for (int i = 0; ok && i < options->script.allow_write_count; i++)
        ok = path_policy_add(&files->folders, options->script.allow_write[i], PATH_POLICY_WRITE, &files->folders_error);
    const struct path_policy *folders = options->script.no_sandbox ? NULL : &files->folders;
    /* What may be replaced depends on what a file is for. */
    files->picture = (struct file_rules){.may_replace = picture_file_is,
                                         .expected = "a picture",
                                         .advice = by_user ? NULL : advice,
                                         .role = FILE_ROLE_PICTURE,
                                         .is_direct = by_user,
                                         .named_by_user = by_user,
                                         .force = by_user && options->force,
                                         .folders = by_user ? NULL : folders,
                                         .guard = &files->guard,
                                         .quota = &files->quota,
                                         .interrupt = &files->interrupt};
    files->beside = files->picture;
    files->beside.is_direct = false;
    files->beside.role = FILE_ROLE_BESIDE;
    files->partial = files->beside;
    files->partial.may_replace = png_is_unfinished;
    files->partial.expected = "an unfinished picture";
    files->partial.advice = NULL;
    files->partial.force = files->partial.named_by_user = false;
    files->animation = files->picture;
    files->animation.may_replace = animation_is;
    files->animation.expected = "an animation";
    files->model = files->beside;
    files->model.may_replace = model_file_is;
    files->model.expected = "a model";
    files->model.advice = NULL;
    files->model.named_by_user = files->model.force = false;
    files->model.folders = folders;
    files->user_model = files->model;
    files->user_model.folders = NULL;
    files->user_model.named_by_user = true;
    files->user_model.force = options->force;
    files->part = (struct file_rules){.may_replace = tile_file_is,
                                      .expected = "a checkpoint or part",
                                      .advice = advice,
                                      .folders = files->picture.folders,
                                      .guard = &files->guard,
                                      .quota = &files->quota};
    files->checkpoint = files->named_checkpoint = files->part;
    files->checkpoint.advice = files->named_checkpoint.advice = " (--checkpoint FILE chooses another file)";
    files->named_checkpoint.folders = NULL;
    files->checkpoint.quota = files->named_checkpoint.quota = NULL;
    files->solution = options_are_named(options->radiosity_file) ? files->named_checkpoint : files->checkpoint;
    files->solution.may_replace = solution_file_is;
    files->solution.expected = "a solution of radiosity";
    files->solution.advice = " (--radiosity-file FILE chooses another file)";
    files->saved = (struct file_rules){
        .never_replace = true, .role = FILE_ROLE_BESIDE, .folders = files->picture.folders, .guard = &files->guard};
    /* No picture replaces a script of the run. */
    for (int i = 0; i < options->script_count; i++) {
        struct file_identity identity;
        if (file_identity_of(options->scripts[i], &identity))
            picture_files_keep(files, identity, false);
    }
}

void picture_files_destroy(struct picture_files *files) {
    path_policy_destroy(&files->folders);
    file_guard_destroy(&files->guard);
}

void picture_files_keep(struct picture_files *files, struct file_identity identity, bool written) {
    for (int role = 0; written && role < FILE_ROLES; role++)
        file_set_remove(&files->guard.own[role], identity);
    if (!file_set_add(&files->guard.kept, identity))
        (void)error_no_memory(&files->folders_error, "the list of files that are read");
}

void picture_files_own(struct picture_files *files, const char *name) {
    struct file_identity identity;
    if (file_identity_of(name, &identity))
        (void)file_set_add(&files->guard.own[FILE_ROLE_PICTURE], identity);
}

bool picture_files_is_own(const struct picture_files *files, const char *name) {
    struct file_identity identity;
    return file_is_regular(name) && file_identity_of(name, &identity) &&
           file_set_has(&files->guard.own[FILE_ROLE_PICTURE], identity);
}

/* Names. */

static const char *last_part(const char *name) {
    const char *slash = strrchr(name, '/');
    return slash ? slash + 1 : name;
}

enum ending { ENDING_PICTURE, ENDING_NONE, ENDING_OTHER };

/* Old scenes have names such as "frame" and "frame.001": no extension. */
static enum ending ending_of(const char *name) {
    const char *dot = strrchr(last_part(name), '.');
    if (!dot)
        return ENDING_NONE;
    if (picture_format(name) != PICTURE_OTHER)
        return ENDING_PICTURE;
    bool digits = dot[1] != '\0' && dot[1 + strspn(dot + 1, "0123456789")] == '\0';
    return digits ? ENDING_NONE : ENDING_OTHER;
}

static bool is_there(const char *name) {
    struct file_identity identity;
    return file_identity_of(name, &identity);
}

/* Whether this is a regular file that begins as `is` decides. */
static bool begins(const char *name, bool (*is)(const uint8_t *head, size_t size)) {
    uint8_t head[FILE_HEAD_SIZE];
    struct file_source source;
    struct error ignored;
    if (!file_is_regular(name) || !file_source_open(&source, name, &ignored))
        return false;
    size_t size = source.size < sizeof head ? (size_t)source.size : sizeof head;
    bool begins = file_source_read(&source, 0, head, size) && is(head, size);
    file_source_close(&source);
    return begins;
}

/* What a picture may replace. */
static bool is_replaced(const uint8_t *head, size_t size) {
    return size == 0 || picture_file_is(head, size);
}

bool picture_files_check_output(const struct options *options, struct error *error) {
    static const char *const animations[] = {ANIMATION_FORMATS(LIST_WORD)};
    char name[NAME_LIMIT], extensions[PICTURE_EXTENSIONS_SIZE], moving[128] = "";
    bool free_name = !options->output || options->to_json || options->to_lua || strcmp(options->output, "-") == 0 || options->force;
    if (free_name || options->animation != ANIMATION_NONE || !output_name(options->output, 1, name, NAME_LIMIT) ||
        ending_of(name) != ENDING_OTHER ||
        /* Later checks refuse it by its contents, or write to it. */
        (is_there(name) && !begins(name, is_replaced)))
        return true;
    for (int i = ANIMATION_NONE + 1; i < LIST_COUNT(ANIMATION_FORMATS); i++)
        snprintf(moving + strlen(moving), sizeof moving - strlen(moving), "%s%s", moving[0] ? ", " : "", animations[i]);
    return error_set(
        error, ERROR_USAGE,
        "-o %.600s: gray writes no %.100s files; a name ends in %s, or for animations in %s, or for models "
        "in" MODEL_FORMATS_HELP " (--force writes a PNG file with any name)",
        options->output, strrchr(name, '.'), picture_extensions(extensions), moving);
}

static bool name_is_too_long(struct error *error) {
    return error_set(error, ERROR_SCENE, "the name of the picture is longer than %d bytes", NAME_LIMIT - 1);
}

/* `given` is the name as it was written. */
static bool add_ending(struct picture_files *files, const char *given, char name[NAME_LIMIT],
                       char notice[NAME_LIMIT + 128], struct error *error) {
    size_t length = strlen(name);
    if (length + sizeof ".png" > NAME_LIMIT)
        return name_is_too_long(error);
    memcpy(name + length, ".png", sizeof ".png");
    if (!files->ending_noticed)
        (void)snprintf(notice, NAME_LIMIT + 128,
                       "gray: notice: '%.1500s' has no ending of a picture and becomes %.1500s", given, name);
    files->ending_noticed = true;
    return true;
}

static bool name_from_script(struct picture_files *files, const char *from_script, char name[NAME_LIMIT],
                             char notice[NAME_LIMIT + 128], struct error *error) {
    size_t length = strlen(from_script);
    if (length == 0)
        return error_set(error, ERROR_SCENE, "the name of the picture is empty");
    if (strcmp(from_script, "-") == 0)
        return error_set(error, ERROR_SCENE, "the name '-' means standard output only on the command line (-o -)");
    if (from_script[length - 1] == '/')
        return error_set(error, ERROR_SCENE, "%.600s: is a folder, a picture cannot be written there", from_script);
    if (!files->options->script.no_sandbox && !path_policy_may_create(&files->folders, from_script))
        return error_set(error, ERROR_SCENE,
                         "%s: pictures of scripts must be below the working directory, without a hidden name "
                         "(-o FILE or --allow-write DIR allow other places)",
                         from_script);
    /* A missing ending is added, an unknown one is an error. */
    enum ending ending = ending_of(from_script);
    bool lenient = files->options->script.lenient;
    char extensions[PICTURE_EXTENSIONS_SIZE];
    if (ending == ENDING_OTHER && !lenient)
        return error_set(error, ERROR_SCENE, "%.600s: the name of a picture ends in %s (-o FILE chooses another one)",
                         from_script, picture_extensions(extensions));
    if (length >= NAME_LIMIT)
        return name_is_too_long(error);
    memcpy(name, from_script, length + 1);
    return ending == ENDING_PICTURE || add_ending(files, from_script, name, notice, error);
}

bool animation_folder(const char *animation, char out[NAME_LIMIT]) {
    return snprintf(out, NAME_LIMIT, "%s.frames", animation) < NAME_LIMIT;
}

/* dir/foo.gif with the word X is dir/foo.X.png. */
static bool name_beside(const char *name, const char *word, char out[NAME_LIMIT]) {
    const char *last = last_part(name), *dot = strrchr(last, '.');
    int length = dot ? (int)(dot - name) : (int)strlen(name);
    return snprintf(out, NAME_LIMIT, "%.*s.%s.png", length, name, word) < NAME_LIMIT;
}

bool animation_sheet_name(const char *animation, char out[NAME_LIMIT], struct error *error) {
    return name_beside(animation, "sheet", out) || name_is_too_long(error);
}

bool picture_files_partial(const struct picture_files *files, const char *name, char out[NAME_LIMIT]) {
    const struct options *options = files->options;
    bool is_file = !is_there(name) || file_is_regular(name);
    return options->keeps_picture && is_file &&
           name_beside(options->animation != ANIMATION_NONE ? options->output : name, "partial", out);
}

void picture_files_remove_partial(const struct picture_files *files, const char *name) {
    char partial[NAME_LIMIT];
    struct file_identity identity;
    struct error ignored; /* another file of this name */
    const struct file_target target = {.path = partial, .rules = &files->partial};
    if (picture_files_partial(files, name, partial) && begins(partial, png_is_unfinished) &&
        file_identity_of(partial, &identity))
        (void)file_output_remove(&target, identity, &ignored);
}

static bool name_in_folder(const char *animation, unsigned number, char name[NAME_LIMIT], struct error *error) {
    char folder[NAME_LIMIT];
    bool fits = animation_folder(animation, folder) &&
                snprintf(name, NAME_LIMIT, "%.*s/%06u.png", NAME_LIMIT - 32, folder, number) < NAME_LIMIT &&
                strlen(folder) <= NAME_LIMIT - 32;
    return fits || name_is_too_long(error);
}

bool picture_files_number_frame(unsigned number, char name[NAME_LIMIT], struct error *error) {
    char pattern[NAME_LIMIT + 8];
    const char *last = last_part(name), *dot = strrchr(last, '.');
    int length = dot ? (int)(dot - name) : (int)strlen(name);
    if (output_name_numbered(name))
        (void)snprintf(pattern, sizeof pattern, "%s", name);
    else
        (void)snprintf(pattern, sizeof pattern, "%.*s.####%s", length, name, name + length);
    return output_name(pattern, number, name, NAME_LIMIT) || name_is_too_long(error);
}

bool picture_files_name(struct picture_files *files, const struct picture_label *label, char name[NAME_LIMIT],
                        char notice[NAME_LIMIT + 128], struct error *error) {
    const char *output = files->options->output;
    notice[0] = '\0';
    if (output && files->options->animation != ANIMATION_NONE)
        return name_in_folder(output, label->number, name, error);
    if (output) {
        if (!output_name(output, label->number, name, NAME_LIMIT))
            return name_is_too_long(error);
        if (strcmp(output, "-") != 0 && ending_of(name) == ENDING_NONE && !is_there(name))
            return add_ending(files, output, name, notice, error);
        return true;
    }
    if (files->folders_error.kind != ERROR_NONE) {
        *error = files->folders_error;
        return false;
    }
    return name_from_script(files, label->from_script, name, notice, error) &&
           (label->frame == 0 || picture_files_number_frame(label->frame, name, error));
}

bool picture_files_prefixed(const char *name, const char *prefix, char out[NAME_LIMIT], struct error *error) {
    size_t folder = (size_t)(last_part(name) - name);
    int length = snprintf(out, NAME_LIMIT, "%.*s%s%s", (int)folder, name, prefix, name + folder);
    return length < NAME_LIMIT ||
           error_set(error, ERROR_SCENE, "%s: with %s before it the name is longer than %d bytes", name, prefix,
                     NAME_LIMIT - 1);
}

bool picture_files_written(const struct picture_files *files, const char *name, char out[NAME_LIMIT],
                           struct error *error) {
    const struct options *options = files->options;
    int length = options->shards ? snprintf(out, NAME_LIMIT, "%s.%u-of-%u.part", name, options->shard, options->shards)
                                 : snprintf(out, NAME_LIMIT, "%s", name);
    return length < NAME_LIMIT ||
           error_set(error, ERROR_SCENE, "%.100s...: the name of its part is longer than %d bytes", name,
                     NAME_LIMIT - 1);
}

bool picture_files_checkpoint(const struct picture_files *files, const char *name, char out[NAME_LIMIT],
                              struct error *error) {
    const struct options *options = files->options;
    bool named = options_are_named(options->checkpoint);
    char folder[NAME_LIMIT], shard[64] = "";
    int length;
    if (named) {
        length = snprintf(out, NAME_LIMIT, "%s", options->checkpoint);
    } else if (options->animation != ANIMATION_NONE && animation_folder(options->output, folder)) {
        if (options->shards || options->shards_of_pictures)
            (void)snprintf(shard, sizeof shard, "%u-of-%u.", options->shard + options->shard_of_pictures,
                           options->shards + options->shards_of_pictures);
        length = snprintf(out, NAME_LIMIT, "%.4000s/%scheckpoint", folder, shard);
    } else {
        length = snprintf(out, NAME_LIMIT, "%s.checkpoint", name);
    }
    return length < NAME_LIMIT ||
           error_set(error, ERROR_SCENE, "%.100s...: the name of its checkpoint is longer than %d bytes", name,
                     NAME_LIMIT - 1);
}

bool picture_files_solution(const struct picture_files *files, const char *name, char out[NAME_LIMIT],
                            struct error *error) {
    const struct options *options = files->options;
    const char *beside = options->animation != ANIMATION_NONE ? options->output : name;
    int length = options_are_named(options->radiosity_file) ? snprintf(out, NAME_LIMIT, "%s", options->radiosity_file)
                                                            : snprintf(out, NAME_LIMIT, "%s.radiosity", beside);
    return length < NAME_LIMIT ||
           error_set(error, ERROR_SCENE, "%.100s...: the name of its solution is longer than %d bytes", name,
                     NAME_LIMIT - 1);
}

/* Checks. */

/* A file named after a picture; rules NULL: it is not written. */
struct picture_file {
    char path[NAME_LIMIT];
    const struct file_rules *rules;
};

/* The file with this number of those that a picture may have. */
static bool name_file(const struct picture_files *files, const char *name, uint32_t layers, int number,
                      struct picture_file *file, struct error *error) {
    const struct options *options = files->options;
    const char *prefixes[2] = {options->targets_prefix, options->first_pass_prefix};
    file->rules = NULL;
    if (number == 0) {
        file->rules = options->shards ? &files->part : &files->picture;
        return picture_files_written(files, name, file->path, error);
    }
    if (options->shards)
        return true;
    file->rules = &files->beside;
    if (number <= 2 && prefixes[number - 1])
        return picture_files_prefixed(name, prefixes[number - 1], file->path, error);
    int layer = number - FIRST_LAYER;
    if (layer >= 0 && picture_format(name) != PICTURE_EXR && (layers >> layer & 1))
        return layers_name(name, aov_name((enum aov)layer), file->path, error);
    file->rules = NULL;
    return true;
}

/* Checks that one of them can be written, and differs from those before it and the checkpoint. */
static bool check_file(const struct picture_files *files, const char *name, uint32_t layers, int number,
                       const char *checkpoint, struct error *error) {
    struct picture_file file, other;
    if (!name_file(files, name, layers, number, &file, error))
        return false;
    if (!file.rules)
        return true;
    const struct file_target target = {.path = file.path, .rules = file.rules};
    if (!file_output_check(&target, error))
        return false;
    for (int i = 0; i < number; i++) {
        if (name_file(files, name, layers, i, &other, error) && other.rules &&
            file_is_same_folder(file.path, other.path))
            return error_set(error, ERROR_USAGE, "%.600s: two files of one picture would have this name", file.path);
    }
    if (checkpoint && file_is_same_folder(file.path, checkpoint))
        return error_set(error, files->options->output ? ERROR_USAGE : ERROR_SCENE,
                         "%.600s: is the name of the checkpoint of this run, and cannot be that of a picture",
                         file.path);
    return true;
}

bool picture_files_check(struct picture_files *files, const char *name, uint32_t layers, const char *checkpoint,
                         bool check_checkpoint, struct error *error) {
    if (checkpoint && check_checkpoint) {
        bool named = options_are_named(files->options->checkpoint);
        const struct file_target target = {.path = checkpoint,
                                           .rules = named ? &files->named_checkpoint : &files->checkpoint};
        if (!file_output_check(&target, error))
            return named ? error_elsewhere(error) : false;
    }
    for (int number = 0; number < FILES_LIMIT; number++) {
        if (!check_file(files, name, layers, number, checkpoint, error))
            return files->options->output ? error_elsewhere(error) : false;
    }
    return true;
}
