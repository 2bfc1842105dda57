/* The table of options controls parsing: the kind of a row determines how its value is read, `offset` where it is
 * stored. The long spelling of an option may have one dash or two, and '_' is read as '-'; `--name value` and
 * `--name=value` are the same. Words that are no options are scripts; after "--" all words are. */
#include "session/options_internal.h"

#include "base/error.h"
#include "base/isa.h"
#include "render/aov.h"

#include <assert.h>
#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

struct piece option_next_piece(const char **rest) {
    struct piece piece = {*rest, strcspn(*rest, "|")};
    *rest += piece.length;
    if (**rest == '|')
        (*rest)++;
    return piece;
}

static struct piece without_dashes(struct piece piece) {
    for (int i = 0; i < 2 && piece.length > 0 && piece.text[0] == '-'; i++) {
        piece.text++;
        piece.length--;
    }
    return piece;
}

/* A word of the command line and a name of the table, which has no '_'. */
static bool same_name(struct piece a, struct piece b) {
    if (a.length != b.length)
        return false;
    for (size_t i = 0; i < a.length; i++) {
        if ((a.text[i] == '_' ? '-' : a.text[i]) != b.text[i])
            return false;
    }
    return true;
}

static const struct option *find_option(struct piece name) {
    for (int i = 0; i < option_count; i++) {
        for (const char *rest = option_table[i].names; *rest;) {
            if (same_name(name, without_dashes(option_next_piece(&rest))))
                return &option_table[i];
        }
    }
    return NULL;
}

/* Edits (insert, delete, replace, swap of neighbours) between a word and a short name of the table; words with more
 * than 31 letters have a large distance. */
static int name_distance(struct piece a, struct piece b) {
    enum { LIMIT = 32 };
    int rows[3][LIMIT];
    assert(b.length < LIMIT);
    if (a.length >= LIMIT)
        return LIMIT;
    int *before = rows[0], *last = rows[1], *row = rows[2];
    for (size_t j = 0; j <= b.length; j++)
        last[j] = (int)j;
    for (size_t i = 1; i <= a.length; i++) {
        row[0] = (int)i;
        for (size_t j = 1; j <= b.length; j++) {
            char x = a.text[i - 1] == '_' ? '-' : a.text[i - 1], y = b.text[j - 1];
            int best = last[j - 1] + (x != y);
            if (last[j] + 1 < best)
                best = last[j] + 1;
            if (row[j - 1] + 1 < best)
                best = row[j - 1] + 1;
            if (i > 1 && j > 1 && x == b.text[j - 2] && a.text[i - 2] == y && before[j - 2] + 1 < best)
                best = before[j - 2] + 1;
            row[j] = best;
        }
        int *spare = before;
        before = last;
        last = row;
        row = spare;
    }
    return last[b.length];
}

/* The displayed spelling of the option nearest to a misspelt name, or an empty piece if none is near. */
static struct piece nearest_name(struct piece name) {
    struct piece best = {"", 0};
    int best_distance = name.length < 4 ? 2 : 3;
    for (int i = 0; i < option_count; i++) {
        for (const char *rest = option_table[i].names; *rest;) {
            struct piece candidate = option_next_piece(&rest), bare = without_dashes(candidate);
            int distance = name_distance(name, bare);
            if (distance < best_distance && bare.length > 1) {
                best_distance = distance;
                best = candidate;
            }
        }
    }
    return best;
}

static bool is_word_start(char c) {
    return c == '_' || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/* Decimal digits with an optional sign, nothing else. */
static bool read_integer(const char *text, size_t length, long long low, long long high, long long *out) {
    char copy[24];
    size_t start = length > 0 && (text[0] == '-' || text[0] == '+') ? 1 : 0;
    if (length <= start || length >= sizeof copy)
        return false;
    for (size_t i = start; i < length; i++) {
        if (!isdigit((unsigned char)text[i]))
            return false;
    }
    memcpy(copy, text, length);
    copy[length] = '\0';
    errno = 0;
    long long value = strtoll(copy, NULL, 10);
    if (errno != 0 || value < low || value > high)
        return false;
    *out = value;
    return true;
}

/* A decimal number; strtod would also read hexadecimal ones. */
static bool read_number(const char *text, double low, double high, double *out) {
    if ((!isdigit((unsigned char)text[0]) && !strchr("+-.", text[0])) || strpbrk(text, "xX"))
        return false;
    char *end = NULL;
    double value = strtod(text, &end);
    if (*text == '\0' || *end != '\0' || !isfinite(value) || value < low || value > high)
        return false;
    *out = value;
    return true;
}

static bool read_bytes(const char *text, double low, double high, uint64_t *out) {
    uint64_t bytes;
    if (!size_parse(text, &bytes) || (double)bytes < low || (double)bytes > high)
        return false;
    *out = bytes;
    return true;
}

/* Whole numbers separated by `separator`: exactly `count` of them. */
static bool read_list(const char *text, char separator, int count, const long long *low, long long high,
                      long long *out) {
    for (int i = 0; i < count; i++) {
        const char *end = i + 1 < count ? strchr(text, separator) : text + strlen(text);
        if (!end || !read_integer(text, (size_t)(end - text), low[i], high, &out[i]))
            return false;
        text = end + 1;
    }
    return true;
}

static bool read_size(struct options *options, const char *text) {
    static const long long low[] = {1, 1};
    long long values[2];
    if (!read_list(text, 'x', 2, low, 1 << 20, values))
        return false;
    options->width = (int)values[0];
    options->height = (int)values[1];
    return true;
}

static bool read_pixel(struct options *options, uint32_t (*pixels)[2], const char *text) {
    static const long long low[] = {0, 0};
    long long values[2];
    if (!read_list(text, ',', 2, low, (1 << 20) - 1, values))
        return false;
    pixels[options->pixel_count][0] = (uint32_t)values[0];
    pixels[options->pixel_count++][1] = (uint32_t)values[1];
    return true;
}

static bool read_crop(struct options *options, const char *text) {
    static const long long low[] = {0, 0, 1, 1};
    long long values[4];
    if (!read_list(text, ',', 4, low, 1 << 20, values))
        return false;
    options->settings.cropped = true;
    options->settings.crop_x = values[0];
    options->settings.crop_y = values[1];
    options->settings.crop_width = values[2];
    options->settings.crop_height = values[3];
    return true;
}

/* The part and the number of parts. */
static bool read_shard(const char *text, uint32_t field[2]) {
    static const long long low[] = {1, 1};
    long long values[2];
    if (!read_list(text, '/', 2, low, 1000000, values) || values[0] > values[1])
        return false;
    field[0] = (uint32_t)values[0];
    field[1] = (uint32_t)values[1];
    return true;
}

/* N: the frames 1 to N; A-B: A to B; A-B/STEP: every STEPth of these. */
static bool read_frames(struct frame_selection *selection, const char *text) {
    const char *dash = strchr(text, '-'), *slash = strchr(text, '/'), *end = text + strlen(text);
    long long first = 1, last = 0, step = 1;
    if (slash && (!dash || dash > slash || !read_integer(slash + 1, (size_t)(end - slash - 1), 1, FRAMES_MAX, &step)))
        return false;
    if (dash && !read_integer(text, (size_t)(dash - text), 1, FRAMES_MAX, &first))
        return false;
    const char *from = dash ? dash + 1 : text;
    if (!read_integer(from, (size_t)((slash ? slash : end) - from), 1, FRAMES_MAX, &last) || first > last)
        return false;
    *selection = (struct frame_selection){(uint32_t)first, (uint32_t)last, (uint32_t)step};
    return true;
}

static bool read_seed(struct options *options, const char *text) {
    if (!isdigit((unsigned char)text[0]) || text[strspn(text, "0123456789")] != '\0')
        return false;
    errno = 0;
    unsigned long long value = strtoull(text, NULL, 10);
    if (errno != 0)
        return false;
    options->settings.seed = value;
    options->script.seed = value;
    return true;
}

static bool is_lua_keyword(struct piece name) {
    const char *rest = "and|break|do|else|elseif|end|false|for|function|goto|if|in|local|nil|not|or|repeat|return|then|"
                       "true|until|while";
    while (*rest) {
        struct piece word = option_next_piece(&rest);
        if (word.length == name.length && memcmp(word.text, name.text, word.length) == 0)
            return true;
    }
    return false;
}

static bool is_define(const char *text) {
    struct piece name = {text, strcspn(text, "=")};
    bool ok = name.length > 0 && text[name.length] == '=' && is_word_start(text[0]) && !is_lua_keyword(name);
    for (size_t i = 0; ok && i < name.length; i++)
        ok = is_word_start(text[i]) || isdigit((unsigned char)text[i]);
    return ok;
}

/* options_parse has made room for one more definition. */
static bool note_define(struct options *options, struct script_define *defines, const char *text, struct arena *arena,
                        struct error *error) {
    struct piece name = {text, strcspn(text, "=")};
    char *copy = arena_copy_text(arena, name.text, name.length);
    if (!copy)
        return error_no_memory(error, "the command line");
    defines[options->script.define_count++] = (struct script_define){copy, text + name.length + 1};
    return true;
}

static bool read_choice(const struct option *option, void *field, const char *text) {
    int position = 0;
    for (const char *rest = option->value; *rest; position++) {
        struct piece word = option_next_piece(&rest);
        if (strlen(text) != word.length || memcmp(text, word.text, word.length) != 0)
            continue;
        if (option->size == sizeof(bool))
            *(bool *)field = position != 0;
        else
            memcpy(field, &position, sizeof position);
        return true;
    }
    return false;
}

static bool value_error(const struct option *option, const char *text, struct error *error) {
    const char *rest = option->names;
    int shown = (int)option_next_piece(&rest).length;
    switch (option->kind) {
    case OPTION_INTEGER:
        return error_set(error, ERROR_USAGE, "%.*s needs a whole number from %.0f to %.0f, not '%s'", shown,
                         option->names, option->low, option->high, text);
    case OPTION_NUMBER:
        if (option->high < HUGE_VAL)
            return error_set(error, ERROR_USAGE, "%.*s needs a number from %g to %g, not '%s'", shown, option->names,
                             option->low, option->high, text);
        return error_set(error, ERROR_USAGE, "%.*s needs a number of at least %g, not '%s'", shown, option->names,
                         option->low, text);
    case OPTION_BYTES:
        return error_set(error, ERROR_USAGE,
                         "%.*s needs a size from 1K to 1024T, as in 512M or 2G (a plain number is MiB), not '%s'",
                         shown, option->names, text);
    case OPTION_SEED:
        return error_set(error, ERROR_USAGE, "%.*s needs a whole number from 0 to 18446744073709551615, not '%s'",
                         shown, option->names, text);
    case OPTION_CHOICE:
    case OPTION_TONE:
    case OPTION_STATS:
    case OPTION_DENOISE:
        return error_set(error, ERROR_USAGE, "%.*s needs one of %s, not '%s'", shown, option->names,
                         option->value + (option->value[0] == '='), text);
    case OPTION_LAYERS:
        return error_set(
            error, ERROR_USAGE,
            "%.*s needs names separated by commas (depth, normal, albedo, uv, node, material, cost, samples, "
            "lights, and with --integrator path raw, variance, emission, diffuse_direct, diffuse_indirect, "
            "specular_direct, specular_indirect, transmission_direct, transmission_indirect) or all, not '%s'",
            shown, option->names, text);
    case OPTION_TEXT:
        return error_set(error, ERROR_USAGE, "%.*s needs a text", shown, option->names);
    case OPTION_SIZE:
        return error_set(error, ERROR_USAGE, "%.*s needs WxH, two whole numbers from 1 to 1048576, not '%s'", shown,
                         option->names, text);
    case OPTION_CROP:
        return error_set(error, ERROR_USAGE,
                         "%.*s needs X,Y,W,H, whole numbers with X and Y not negative and W and H at least 1, not '%s'",
                         shown, option->names, text);
    case OPTION_PIXEL:
        return error_set(error, ERROR_USAGE, "%.*s needs X,Y, two whole numbers from 0, not '%s'", shown, option->names,
                         text);
    case OPTION_SHARD:
        return error_set(error, ERROR_USAGE, "%.*s needs I/N, whole numbers with I from 1 to N, not '%s'", shown,
                         option->names, text);
    case OPTION_FRAMES:
        return error_set(error, ERROR_USAGE,
                         "%.*s needs N, A-B or A-B/STEP, whole numbers from 1 to %d with A not above B, not '%s'",
                         shown, option->names, FRAMES_MAX, text);
    case OPTION_FOLDER:
        return error_set(error, ERROR_USAGE, "%.*s needs the name of a folder", shown, option->names);
    case OPTION_DEFINE:
        return error_set(error, ERROR_USAGE, "%.*s needs name=value with a Lua name, not '%s'", shown, option->names,
                         text);
    case OPTION_FLAG:
    case OPTION_ACTION:
        break;
    }
    return error_set(error, ERROR_USAGE, "%.*s takes no value", shown, option->names);
}

/* Room for lists that grow with the words of the command line. */
struct lists {
    struct script_define *defines;
    uint32_t (*pixels)[2];
    const char **folders[2]; /* --allow-read, --allow-write */
    struct given_option *given;
};

/* Options that fields of gr.render override are noted for a notice; of several equal ones the last. */
static void note_given(const struct option *option, const char *text, struct options *options,
                       struct given_option *given) {
    const size_t start = offsetof(struct options, settings);
    bool picture = option->group == OPTION_GROUP_PICTURE || option->group == OPTION_GROUP_SHADING ||
                   option->group == OPTION_GROUP_FINISH || option->group == OPTION_GROUP_COMPATIBILITY;
    int at = 0;
    if (!picture || option->size == 0 || option->offset < start || option->offset >= start + sizeof options->settings)
        return;
    while (at < options->script.given_count && given[at].offset != option->offset - start)
        at++;
    options->script.given_count += at == options->script.given_count;
    given[at] = (struct given_option){option->offset - start, option->size, option->names, option->value ? text : NULL};
}

static bool apply_option(const struct option *option, const char *text, struct options *options,
                         const struct lists *lists, struct arena *arena, struct error *error) {
    void *field = (char *)options + option->offset;
    long long integer = 0;
    bool ok = false;
    switch (option->kind) {
    case OPTION_FLAG:
        *(bool *)field = true;
        return true;
    case OPTION_ACTION:
        options->action = (enum options_action)option->low;
        return true;
    case OPTION_INTEGER:
        ok = read_integer(text, strlen(text), (long long)option->low, (long long)option->high, &integer);
        if (ok)
            *(int *)field = (int)integer;
        break;
    case OPTION_NUMBER:
        ok = read_number(text, option->low, option->high, field);
        break;
    case OPTION_BYTES:
        ok = read_bytes(text, option->low, option->high, field);
        break;
    case OPTION_CHOICE:
        ok = read_choice(option, field, text);
        break;
    case OPTION_TONE:
        ok = read_choice(option, field, text);
        options->settings.keeps_tone = true;
        break;
    case OPTION_TEXT:
        ok = text[0] != '\0';
        *(const char **)field = text;
        break;
    case OPTION_SIZE:
        ok = read_size(options, text);
        break;
    case OPTION_CROP:
        ok = read_crop(options, text);
        break;
    case OPTION_PIXEL:
        ok = read_pixel(options, lists->pixels, text);
        break;
    case OPTION_SEED:
        ok = read_seed(options, text);
        break;
    case OPTION_DEFINE:
        ok = is_define(text);
        if (ok)
            return note_define(options, lists->defines, text, arena, error);
        break;
    case OPTION_FOLDER:
        ok = text[0] != '\0';
        lists->folders[(int)option->low][option->low == 0 ? options->script.allow_read_count++
                                                          : options->script.allow_write_count++] = text;
        break;
    case OPTION_SHARD:
        ok = read_shard(text, field);
        break;
    case OPTION_FRAMES:
        ok = read_frames(field, text);
        break;
    case OPTION_LAYERS:
        ok = aov_parse(text, &options->settings.aov);
        break;
    case OPTION_DENOISE:
        options->settings.keeps_noise = strcmp(text, "none") == 0;
        options->settings.denoise = strcmp(text, "oidn") == 0   ? DENOISER_OIDN
                                    : strcmp(text, "gray") == 0 ? DENOISER_GRAY
                                                                : DENOISER_NONE;
        ok = options->settings.keeps_noise || options->settings.denoise != DENOISER_NONE;
        break;
    case OPTION_STATS:
        ok = strcmp(text, "text") == 0 || strcmp(text, "json") == 0;
        options->statistics = strcmp(text, "json") == 0 ? STATISTICS_JSON : STATISTICS_TEXT;
        break;
    }
    if (!ok)
        return value_error(option, text, error);
    return true;
}

/* -j4 and -Dname=value: the one-letter options whose value may follow without a blank. */
static const struct option *find_attached(const char *word, const char **text) {
    bool threads = word[1] == 'j' && isdigit((unsigned char)word[2]), define = word[1] == 'D' && is_word_start(word[2]);
    if (!threads && !define)
        return NULL;
    *text = word + 2;
    return find_option((struct piece){word + 1, 1});
}

/* Options of the version before, and what replaces them. */
static const struct {
    const char *name, *instead;
} removed_options[] = {
    {"no-copies", "leave it out; copied frames have the bytes of rendered ones"},
};

static bool unknown_option(const char *word, struct piece name, struct error *error) {
    for (size_t i = 0; i < sizeof removed_options / sizeof *removed_options; i++)
        if (same_name(name, (struct piece){removed_options[i].name, strlen(removed_options[i].name)}))
            return error_set(error, ERROR_USAGE, "there is no --%s any more: %s", removed_options[i].name,
                             removed_options[i].instead);
    struct piece near = nearest_name(name);
    if (near.length == 0)
        return error_set(error, ERROR_USAGE, "there is no option '%s'", word);
    return error_set(error, ERROR_USAGE, "there is no option '%s'; did you mean %.*s?", word, (int)near.length,
                     near.text);
}

/* What gray merge uses: the parts contain the results of all other options. */
static bool serves_merge(const struct option *option) {
    static const char names[] = "o|force|write-aa-targets|write-pre-aa|fps|loop|palette|keep-frames|contact-sheet|"
                                "denoise|j|isa|allow-write|picture-count|picture-bytes|no-sandbox|q|verbose|progress";
    const char *own = option->names;
    struct piece first = without_dashes(option_next_piece(&own));
    for (const char *rest = names; *rest;) {
        if (same_name(first, option_next_piece(&rest)))
            return true;
    }
    return false;
}

static bool refuse_for_merge(const struct option *option, struct error *error) {
    const char *rest = option->names;
    return error_set(error, ERROR_USAGE, "merge cannot be combined with %.*s: it only joins parts that are rendered",
                     (int)option_next_piece(&rest).length, option->names);
}

/* The meaning of two options does not depend on their order: so the values are hashed. */
static struct digest digest_option(const struct option *option, const struct options *options, struct digest digest) {
    assert(option->kind != OPTION_TEXT); /* of strings the pointer would be hashed */
    return digest_bytes((const char *)options + option->offset, option->size, digest);
}

static struct digest digest_finish(const struct finish *finish, struct digest digest) {
    const double shares[] = {finish->bloom, finish->vignette};
    const uint32_t numbers[] = {finish->gray, finish->edges, finish->fxaa, (uint32_t)finish->dither};
    if (finish_is_plain(finish))
        return digest;
    return digest_bytes(numbers, sizeof numbers, digest_bytes(shares, sizeof shares, digest));
}

struct digest options_digest(const struct options *options) {
    struct digest digest = {0};
    for (int i = 0; i < option_count; i++) {
        const struct option *option = &option_table[i];
        bool picture = option->group == OPTION_GROUP_PICTURE || option->group == OPTION_GROUP_SHADING ||
                       option->group == OPTION_GROUP_COMPATIBILITY;
        bool search = option->offset == offsetof(struct options, settings.accel) ||
                      option->offset == offsetof(struct options, isa);
        bool path = option->offset == offsetof(struct options, settings.integrator) ||
                    option->offset == offsetof(struct options, settings.path_samples) ||
                    option->offset == offsetof(struct options, settings.max_depth) ||
                    option->offset == offsetof(struct options, settings.roulette_depth) ||
                    option->offset == offsetof(struct options, settings.noise) ||
                    option->offset == offsetof(struct options, settings.time_limit) ||
                    option->offset == offsetof(struct options, settings.clamp) ||
                    option->offset == offsetof(struct options, settings.colour) ||
                    option->offset == offsetof(struct options, settings.aa_pattern) ||
                    option->offset == offsetof(struct options, settings.filter);
        bool text = option->kind == OPTION_TEXT; /* a dialect counts as a file that is read */
        if (picture && option->size > 0 && !search && !path && !text)
            digest = digest_option(option, options, digest);
    }
    const struct settings *settings = &options->settings;
    /* Files from the time before this option existed have the key of the first choice. */
    if (settings->integrator != INTEGRATOR_WHITTED)
        digest = digest_bytes(&settings->integrator, sizeof settings->integrator, digest);
    if (settings->path_samples != 0)
        digest = digest_bytes(&settings->path_samples, sizeof settings->path_samples, digest);
    if (settings->max_depth != DEPTH_DEFAULT)
        digest = digest_bytes(&settings->max_depth, sizeof settings->max_depth, digest);
    if (settings->roulette_depth != ROULETTE_DEPTH_DEFAULT)
        digest = digest_bytes(&settings->roulette_depth, sizeof settings->roulette_depth, digest);
    if (settings->colour != COLOUR_AUTO)
        digest = digest_bytes(&settings->colour, sizeof settings->colour, digest);
    if (settings->aa_pattern != AA_GRID)
        digest = digest_bytes(&settings->aa_pattern, sizeof settings->aa_pattern, digest);
    if (settings->filter != FILTER_BOX)
        digest = digest_bytes(&settings->filter, sizeof settings->filter, digest);
    if (settings->noise > 0 || settings->clamp > 0) {
        digest = digest_bytes(&settings->noise, sizeof settings->noise, digest);
        digest = digest_bytes(&settings->clamp, sizeof settings->clamp, digest);
    }
    digest = digest_finish(&settings->finish, digest);
    if (settings->style != STYLE_NONE || settings_line_width(settings) > 0) {
        const double numbers[] = {(double)settings->style, settings_line_width(settings), settings->toon_steps};
        digest = digest_bytes(numbers, sizeof numbers, digest);
    }
    const struct frame_options *frames = &options->script.frames;
    if (frames->selection.step > 0 || frames->rate > 0 || frames->loops || frames->turntable > 0) {
        const uint32_t numbers[] = {frames->selection.first, frames->selection.last, frames->selection.step,
                                    frames->loops, (uint32_t)frames->turntable};
        digest = digest_bytes(numbers, sizeof numbers, digest);
        digest = digest_bytes(&frames->rate, sizeof frames->rate, digest);
    }
    /* Films are the same for all denoisers. */
    if (settings->denoise != DENOISER_NONE)
        digest = digest_bytes("denoise", sizeof "denoise", digest);
    if (settings->keeps_noise)
        digest = digest_bytes("raw", sizeof "raw", digest);
    if (settings->keeps_tone && settings->tone.curve == TONE_NONE)
        digest = digest_bytes("tone", sizeof "tone", digest);
    const int64_t numbers[] = {options->width,          options->height,
                               (int64_t)settings->seed, settings->cropped,
                               settings->crop_x,        settings->crop_y,
                               settings->crop_width,    settings->crop_height,
                               options->script_count,   options->script.define_count};
    digest = digest_bytes(numbers, sizeof numbers, digest);
    for (int i = 0; i < options->script.define_count; i++) {
        const struct script_define *define = &options->script.defines[i];
        digest = digest_bytes(define->name, strlen(define->name) + 1, digest);
        digest = digest_bytes(define->value, strlen(define->value) + 1, digest);
    }
    return digest;
}

uint32_t options_picture_limit(const struct options *options) {
    enum { STANDARD = 100000 };
    if (options->picture_count > 0)
        return (uint32_t)options->picture_count;
    return options->script.no_sandbox ? UINT32_MAX : STANDARD;
}

bool options_allow_picture(const struct options *options, uint64_t number, struct error *error) {
    uint32_t limit = options_picture_limit(options);
    if (number <= limit || limit == UINT32_MAX)
        return true;
    return error_set_limit(error, "the scripts render more than %u picture%s (--picture-count allows more)", limit,
                           limit > 1 ? "s" : "");
}

uint64_t options_picture_bytes(const struct options *options) {
    uint64_t otherwise = options->script.no_sandbox ? UINT64_MAX : 64 * GIBIBYTE;
    return options->picture_bytes > 0 ? options->picture_bytes : otherwise;
}

bool options_parse(struct options *options, int argc, char *const *argv, struct arena *arena, struct error *error) {
    *options =
        (struct options){.settings = settings_default(), .checkpoint_every = 10, .farm_stall = 30, .farm_silence = 60};
    size_t room = argc > 0 ? (size_t)argc : 1;
    const char **scripts = arena_alloc_array(arena, room, sizeof *scripts);
    struct lists lists = {.defines = arena_alloc_array(arena, room, sizeof *lists.defines),
                          .pixels = arena_alloc_array(arena, room, sizeof *lists.pixels),
                          .folders = {arena_alloc_array(arena, room, sizeof *lists.folders[0]),
                                      arena_alloc_array(arena, room, sizeof *lists.folders[1])},
                          .given = arena_alloc_array(arena, room, sizeof *lists.given)};
    if (!lists.given || !scripts || !lists.defines || !lists.pixels || !lists.folders[0] || !lists.folders[1])
        return error_no_memory(error, "the command line");
    options->scripts = scripts;
    options->script.defines = lists.defines;
    options->script.given = lists.given;
    options->pixels = (const uint32_t(*)[2])lists.pixels;
    options->script.allow_read = lists.folders[0];
    options->script.allow_write = lists.folders[1];
    bool only_scripts = false;
    const struct option *not_of_merge = NULL; /* the first option that gray merge does not use */
    for (int i = 1; i < argc; i++) {
        const char *word = argv[i];
        /* The first word that is no option; `gray -- merge` is a scene of that name. */
        if (!only_scripts && options->action == ACTION_RENDER && options->script_count == 0 &&
            strcmp(word, "merge") == 0) {
            options->action = ACTION_MERGE;
            continue;
        }
        if (only_scripts || word[0] != '-' || word[1] == '\0') {
            scripts[options->script_count++] = word;
            continue;
        }
        if (strcmp(word, "--") == 0) {
            only_scripts = true;
            continue;
        }
        /* The value: after '=', or directly after a letter, or the next word. */
        struct piece name = without_dashes((struct piece){word, strcspn(word, "=")});
        const char *text = strchr(word, '=');
        text = text ? text + 1 : NULL;
        const struct option *option = find_option(name);
        if (!option)
            option = find_attached(word, &text);
        if (!option)
            return unknown_option(word, name, error);
        if (!not_of_merge && !serves_merge(option))
            not_of_merge = option;
        if (!option->value && text)
            return value_error(option, text, error);
        if (option->kind == OPTION_STATS && !text)
            text = "text";
        if (option->kind == OPTION_DENOISE && !text)
            text = "gray";
        if (option->value && !text) {
            if (i + 1 >= argc)
                return error_set(error, ERROR_USAGE, "%s needs a value: %s", word, option->value);
            text = argv[++i];
        }
        if (!apply_option(option, text, options, &lists, arena, error))
            return false;
        note_given(option, text, options, lists.given);
    }
    options->settings.keep_first = options->targets_prefix || options->first_pass_prefix;
    if (options->action == ACTION_MERGE && not_of_merge)
        return refuse_for_merge(not_of_merge, error);
    return options_check(options, error);
}

bool options_output_is_stream(const struct options *options) {
    bool asks = options->pixel_count > 0 || options->dump_scene || options->dump_expr; /* then there is no picture */
    return options->output && strcmp(options->output, "-") == 0 && !asks;
}

/* The %d or ## of a name pattern: its offset and length, or a length of 0. Digits between % and d are a width. */
static struct piece find_number(const char *pattern) {
    for (const char *at = pattern; *at; at++) {
        size_t digits_wanted = strspn(at, "#");
        if (digits_wanted >= 2)
            return (struct piece){at, digits_wanted};
        if (digits_wanted == 1)
            continue;
        if (at[0] != '%')
            continue;
        if (at[1] == '%') {
            at++;
            continue;
        }
        size_t digits = strspn(at + 1, "0123456789");
        if (digits <= 2 && at[1 + digits] == 'd')
            return (struct piece){at, digits + 2};
    }
    return (struct piece){pattern + strlen(pattern), 0};
}

bool output_name_numbered(const char *pattern) {
    return find_number(pattern).length > 0;
}

bool output_name_numbered_twice(const char *pattern) {
    struct piece position = find_number(pattern);
    return position.length > 0 && output_name_numbered(position.text + position.length);
}

bool output_name(const char *pattern, unsigned number, char *out, size_t size) {
    struct piece position = find_number(pattern);
    size_t length = 0;
    for (const char *at = pattern; *at && length < size;) {
        if (position.length > 0 && at == position.text) {
            bool hashes = at[0] == '#', zeros = hashes || at[1] == '0';
            int width = hashes ? (int)position.length : atoi(at + 1);
            int printed = snprintf(out + length, size - length, zeros ? "%0*u" : "%*u", width, number);
            length += (size_t)printed;
            at += position.length;
            continue;
        }
        if (at[0] == '%' && at[1] == '%')
            at++;
        out[length++] = *at++;
    }
    if (length >= size)
        return false;
    out[length] = '\0';
    return true;
}

#define WORD_AFTER_AUTO(member, word) [(member) + 1] = (word),

const char *options_isa_name(const struct options *options) {
    static const char *const names[] = {"auto", CPU_ISAS(WORD_AFTER_AUTO)};
    return names[options->isa];
}
