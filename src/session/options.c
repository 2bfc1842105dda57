/* The table of options controls parsing: the kind of a row determines how its value is read, `offset` where it is
 * stored. The long spelling of an option may have one dash or two, and '_' is read as '-'; `--name value` and
 * `--name=value` are the same. Words that are no options are scripts; after "--" all words are. */
#include "session/options_internal.h"

#include "base/error.h"
#include "base/isa.h"
#include "base/suggestion.h"
#include "film/aov.h"
#include "formats/model_format.h"
#include "session/options_check.h"
#include "session/options_table.h"
#include "settings/foreign_words.h"

#include <assert.h>
#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { NAME_LIMIT_OF_OPTIONS = 32 };

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

static char dash_of(char letter) {
    return letter == '_' ? '-' : letter;
}

/* A word of the command line and a name of an option or a field. */
static bool same_name(struct piece a, struct piece b) {
    if (a.length != b.length)
        return false;
    for (size_t i = 0; i < a.length; i++) {
        if (dash_of(a.text[i]) != dash_of(b.text[i]))
            return false;
    }
    return true;
}

/* The spellings of an option; none of a setting without one. */
static const char *option_names(int index) {
    return option_at(index)->option ? option_at(index)->option : "";
}

static const struct setting *find_option(struct piece name) {
    for (int i = 0; i < option_count(); i++) {
        for (const char *rest = option_names(i); *rest;) {
            if (same_name(name, without_dashes(option_next_piece(&rest))))
                return option_at(i);
        }
    }
    return NULL;
}

const struct setting *option_named(const char *word) {
    return find_option(without_dashes((struct piece){word, strcspn(word, "=")}));
}

/* The spelling of the option nearest to a misspelt name, or an empty piece if none is near. */
static struct piece nearest_name(struct piece name) {
    char word[NAME_LIMIT_OF_OPTIONS], bare[NAME_LIMIT_OF_OPTIONS];
    struct piece best = {"", 0};
    struct suggestion suggestion;
    if (name.length >= sizeof word)
        return best;
    for (size_t i = 0; i < name.length; i++)
        word[i] = name.text[i] == '_' ? '-' : name.text[i];
    word[name.length] = '\0';
    suggest_begin(&suggestion, word);
    suggestion.distance = name.length < 4 ? 2 : 3;
    for (int i = 0; i < option_count(); i++) {
        for (const char *rest = option_names(i); *rest;) {
            struct piece candidate = option_next_piece(&rest), plain = without_dashes(candidate);
            size_t before = suggestion.distance;
            (void)snprintf(bare, sizeof bare, "%.*s", (int)plain.length, plain.text);
            if (plain.length > 1)
                suggest_offer(&suggestion, bare);
            if (suggestion.distance < before)
                best = candidate;
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

static bool read_size(const char *text, int field[2]) {
    static const long long low[] = {1, 1};
    long long values[2];
    if (!read_list(text, 'x', 2, low, 1 << 20, values))
        return false;
    field[0] = (int)values[0];
    field[1] = (int)values[1];
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

static bool read_crop(struct settings *settings, const char *text) {
    static const long long low[] = {0, 0, 1, 1};
    long long values[4];
    if (!read_list(text, ',', 4, low, CROP_MAX, values))
        return false;
    settings->cropped = true;
    settings->crop_x = (int)values[0];
    settings->crop_y = (int)values[1];
    settings->crop_width = (int)values[2];
    settings->crop_height = (int)values[3];
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

static bool read_choice(const struct setting *option, void *base, const char *text) {
    int position = 0;
    for (const char *rest = option->words; *rest; position++) {
        struct piece word = option_next_piece(&rest);
        if (strlen(text) == word.length && memcmp(text, word.text, word.length) == 0)
            return setting_set_bits(option, base, (uint64_t)position);
    }
    return false;
}

/* What the value of an option is to be; NULL: it takes none. room: for a text with numbers. */
static const char *needed_value(const struct setting *option, char room[128]) {
    bool has_unit = option->value && strlen(option->value) > 1; /* SECONDS, STOPS, PIXELS; others have one letter */
    const char *unit = has_unit ? option->value : "", *comma = has_unit ? ", " : "";
    switch (option->kind) {
    case SETTING_CAUSTICS:
    case SETTING_WHOLE:
        (void)snprintf(room, 128, "%s%sa whole number from %.0f to %.0f", unit, comma, option->low, option->high);
        return room;
    case SETTING_NUMBER:
        if (option->high < HUGE_VAL)
            (void)snprintf(room, 128, "%s%sa number from %g to %g%s%s", unit, comma, option->low, option->high,
                           option->words && option->words[0] ? ", or " : "", option->words ? option->words : "");
        else
            (void)snprintf(room, 128, "%s%sa number of at least %g", unit, comma, option->low);
        return room;
    case SETTING_BYTES:
        return "a size from 1K to 1024T, as in 512M or 2G (a plain number is MiB)";
    case SETTING_SEED:
        return "a whole number from 0 to 18446744073709551615";
    case SETTING_CHOICE:
    case SETTING_TONE:
    case SETTING_STATS:
    case SETTING_DENOISE:
        (void)snprintf(room, 128, "one of %s", option->words);
        return room;
    case SETTING_LAYERS:
        return "names separated by commas (depth, normal, albedo, uv, node, material, cost, samples, lights, and with "
               "--integrator path raw, variance, emission, diffuse_direct, diffuse_indirect, specular_direct, "
               "specular_indirect, transmission_direct, transmission_indirect, volume_direct, volume_indirect) or all";
    case SETTING_TEXT:
        return "a text";
    case SETTING_SIZE:
        return "WxH, two whole numbers from 1 to 1048576";
    case SETTING_CROP:
        return "X,Y,W,H, whole numbers with X and Y not negative and W and H at least 1";
    case SETTING_PIXEL:
        return "X,Y, two whole numbers from 0";
    case SETTING_SHARD:
        return "I/N, whole numbers with I from 1 to N";
    case SETTING_FRAMES:
        (void)snprintf(room, 128, "N, A-B or A-B/STEP, whole numbers from 1 to %d with A not above B", FRAMES_MAX);
        return room;
    case SETTING_FOLDER:
        return "the name of a folder";
    case SETTING_DEFINE:
        return "name=value with a Lua name";
    case SETTING_DEFAULT:
        return "FIELD=VALUE, a field of gr.render and its value";
    case SETTING_FLAG:
        return "yes or no";
    case SETTING_ACTION:
        break;
    }
    return NULL;
}

/* name: of the option, or of --default and its field. */
static bool value_error(const struct setting *option, struct piece name, const char *text, struct error *error) {
    char room[128];
    const char *need = needed_value(option, room);
    bool empty = option->kind == SETTING_TEXT || option->kind == SETTING_FOLDER;
    if (!need)
        return error_set(error, ERROR_USAGE, "%.*s takes no value", (int)name.length, name.text);
    return error_set(error, ERROR_USAGE, empty ? "%.*s needs %s" : "%.*s needs %s, not '%s'", (int)name.length,
                     name.text, need, text);
}

/* Room for lists that grow with the words of the command line. */
struct lists {
    struct script_define *defines;
    uint32_t (*pixels)[2];
    const char **folders[2]; /* --allow-read, --allow-write */
    const char **given;      /* by setting: the text of its option */
};

/* Reads the value of an option into the options; of a flag, text may be NULL. */
static bool read_value(const struct setting *option, const char *text, struct options *options,
                       const struct lists *lists) {
    void *base = option_base(option, options), *field = (char *)base + option->offset;
    long long integer = 0;
    bool ok = false;
    /* The kind decides the type behind the pointer. */
    switch (option->kind) {
    case SETTING_FLAG:
        ok = !text || strcmp(text, "yes") == 0 || strcmp(text, "no") == 0;
        *(bool *)field = !text || strcmp(text, "yes") == 0;
        break;
    case SETTING_ACTION:
        options->action = (enum options_action)option->low;
        return true;
    case SETTING_CAUSTICS:
    case SETTING_WHOLE:
        ok = read_integer(text, strlen(text), (long long)option->low, (long long)option->high, &integer);
        if (ok)
            *(int *)field = (int)integer;
        break;
    case SETTING_NUMBER:
        *(double *)field = setting_number_of_word(option, text);
        ok = *(double *)field > 0 || read_number(text, option->low, option->high, field);
        break;
    case SETTING_BYTES:
        ok = read_bytes(text, option->low, option->high, field);
        break;
    case SETTING_CHOICE:
    case SETTING_TONE:
    case SETTING_DENOISE:
    case SETTING_STATS:
        ok = read_choice(option, base, text);
        break;
    case SETTING_TEXT:
        ok = text[0] != '\0';
        if (field == (void *)&options->output && model_format_written(text) != FORMAT_OTHER) {
            options->other_model = options->model;
            options->model = text;
        } else
            *(const char **)field = text;
        break;
    case SETTING_SIZE:
        ok = read_size(text, field);
        break;
    case SETTING_CROP:
        ok = read_crop(&options->settings, text);
        break;
    case SETTING_PIXEL:
        ok = read_pixel(options, lists->pixels, text);
        break;
    case SETTING_SEED:
        ok = read_seed(options, text);
        break;
    case SETTING_DEFINE:
    case SETTING_DEFAULT:
        break;
    case SETTING_FOLDER:
        ok = text[0] != '\0';
        lists->folders[(int)option->low][option->low == 0 ? options->script.allow_read_count++
                                                          : options->script.allow_write_count++] = text;
        break;
    case SETTING_SHARD:
        ok = read_shard(text, field);
        break;
    case SETTING_FRAMES:
        ok = read_frames(field, text);
        break;
    case SETTING_LAYERS:
        ok = aov_parse(text, field);
        break;
    }
    return ok;
}

/* The first spelling of an option. */
static struct piece shown_name(const struct setting *option) {
    const char *rest = option->option;
    return option_next_piece(&rest);
}

/* No setting has the field: it may be the name of an option, or misspelt. */
static bool unknown_field(struct piece name, struct error *error) {
    const struct setting *option = find_option(name);
    char word[NAME_LIMIT_OF_OPTIONS];
    struct suggestion suggestion;
    (void)snprintf(word, sizeof word, "%.*s", (int)name.length, name.text);
    suggest_begin(&suggestion, word);
    for (int i = 0; i < setting_field_count; i++)
        suggest_offer(&suggestion, setting_table[i].field);
    const char *near = option ? option->field : suggestion.best;
    return error_set(error, ERROR_USAGE, "--default sets fields of gr.render that are settings, not '%.*s'%s%s%s",
                     (int)name.length, name.text, near ? "; did you mean " : "", near ? near : "", near ? "?" : "");
}

/* --default: the value is read as that of the option. If the option is given, before or after, it has priority. */
static bool apply_default(const char *text, struct options *options, const struct lists *lists, struct error *error) {
    struct piece name = {text, strcspn(text, "=")};
    int index = 0;
    while (index < setting_field_count &&
           !same_name(name, (struct piece){setting_table[index].field, strlen(setting_table[index].field)}))
        index++;
    if (index == setting_field_count)
        return unknown_field(name, error);
    const struct setting *row = &setting_table[index];
    char words[64];
    int length = snprintf(words, sizeof words, "--default %s", row->field);
    const char *value = text + name.length + 1;
    struct options read = *options;
    if (!read_value(row, value, &read, lists))
        return value_error(row, (struct piece){words, (size_t)length}, value, error);
    if (!lists->given[index])
        (void)setting_set_bits(row, &options->settings, setting_bits(row, &read.settings));
    options->script.defaults |= UINT64_C(1) << index;
    return true;
}

static bool apply_option(const struct setting *option, const char *text, struct options *options,
                         const struct lists *lists, struct arena *arena, struct error *error) {
    if (option->kind == SETTING_DEFINE && is_define(text))
        return note_define(options, lists->defines, text, arena, error);
    if (option->kind == SETTING_DEFAULT && strchr(text, '='))
        return apply_default(text, options, lists, error);
    return read_value(option, text, options, lists) || value_error(option, shown_name(option), text, error);
}

/* -j4 and -Dname=value: the one-letter options whose value may follow without a blank. */
static const struct setting *find_attached(const char *word, const char **text) {
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
    const char *use = foreign_option(name.text, name.length);
    if (use)
        return error_set(error, ERROR_USAGE, "there is no option '%s'; use %s", word, use);
    struct piece near = nearest_name(name);
    if (near.length == 0)
        return error_set(error, ERROR_USAGE, "there is no option '%s' (gray --help lists all)", word);
    return error_set(error, ERROR_USAGE, "there is no option '%s'; did you mean %s%.*s?", word,
                     near.text[0] == '-' ? "" : "--", (int)near.length, near.text);
}

/* Actions whose first argument is their name, and what they use. Parts contain the results of all other options. */
static const struct {
    const char *word, *options, *why;
} actions[] = {
    [ACTION_RENDER] = {NULL, NULL, NULL},
    [ACTION_MERGE] = {"merge",
                      "o|force|write-aa-targets|write-pre-aa|fps|loop|palette|keep-frames|contact-sheet|"
                      "denoise|j|isa|allow-write|picture-count|picture-bytes|no-sandbox|q|verbose|progress",
                      "it only joins parts that are rendered"},
    [ACTION_COMPARE] = {"compare", "o|force|threshold|q", "it only compares two pictures"},
    [ACTION_VIEW] = {"view",
                     "o|force|size|eye|focus|aperture|direction|fov|frames|fps|loop|palette|contact-sheet|deep|j|q|gui",
                     "it shows a file that is rendered"},
};
enum { ACTIONS_WITH_WORDS = sizeof actions / sizeof *actions };

const char *options_action_word(int index) {
    return index + 1 < ACTIONS_WITH_WORDS ? actions[index + 1].word : NULL;
}

static bool serves(const struct setting *option, int action) {
    struct piece first = without_dashes(shown_name(option));
    for (const char *rest = actions[action].options; *rest;) {
        if (same_name(first, option_next_piece(&rest)))
            return true;
    }
    return false;
}

static bool refuse_for_action(const struct setting *option, int action, struct error *error) {
    return error_set(error, ERROR_USAGE, "%s cannot be combined with %.*s: %s", actions[action].word,
                     (int)shown_name(option).length, option->option, actions[action].why);
}

/* Options that change a picture without being settings. A dialect and a sky count as files that are read. */
static struct digest digest_option(const struct setting *option, const struct options *options, struct digest digest) {
    const char *field = (const char *)options + option->offset;
    if (option->kind == SETTING_SIZE || option->kind == SETTING_FRAMES) /* numbers without padding */
        return digest_bytes(field, option->kind == SETTING_SIZE ? 2 * option->size : option->size, digest);
    if (option->kind == SETTING_TEXT) {
        const char *text = *(const char *const *)field;
        return digest_bytes(text ? text : "", text ? strlen(text) + 1 : 0, digest);
    }
    assert(option->size <= sizeof(uint64_t));
    return setting_digest(option, options, digest);
}

struct digest options_digest(const struct options *options) {
    struct digest digest = {0};
    for (int i = 0; i < option_count(); i++) {
        const struct setting *option = option_at(i);
        if (option->changes == CHANGES_RUN)
            continue;
        if (!option_is_setting(option)) {
            digest = digest_option(option, options, digest);
            continue;
        }
        /* Fields have no priority over an option, but over a default. */
        bool is_option = script_option_given(&options->script, i), chosen = script_option_chosen(&options->script, i);
        digest = setting_digest(option, &options->settings, digest_bytes(&(char){is_option + chosen}, 1, digest));
    }
    const int numbers[] = {SETTINGS_VERSION, options->script_count, options->script.define_count};
    digest = digest_bytes(numbers, sizeof numbers, digest);
    for (int i = 0; i < options->script.define_count; i++) {
        const struct script_define *define = &options->script.defines[i];
        digest = digest_bytes(define->name, strlen(define->name) + 1, digest);
        digest = digest_bytes(define->value, strlen(define->value) + 1, digest);
    }
    return digest;
}

bool options_keep_solution(const struct options *options) {
    bool implied = options->checkpoint && !options->checkpoint_implied && !options_output_is_stream(options);
    return (options->radiosity_file || implied) && !options->window && !options->mpi;
}

bool options_are_named(const char *file) {
    return file && strcmp(file, "auto") != 0;
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

/* GRAY_DEVICE, where there is no option. */
static bool take_device(struct options *options, struct error *error) {
    static const char *const words[] = {DEVICES(LIST_WORD)};
    const char *text = getenv("GRAY_DEVICE");
    if (!text || text[0] == '\0')
        return true;
    for (int i = 0; i < LIST_COUNT(DEVICES); i++) {
        if (strcmp(text, words[i]) != 0)
            continue;
        options->device = i;
        return true;
    }
    return error_set(error, ERROR_USAGE, "GRAY_DEVICE is '%.64s', not one of %s", text, LIST_BARS(DEVICES));
}

bool options_parse(struct options *options, int argc, char *const *argv, struct arena *arena, struct error *error) {
    *options = (struct options){
        .settings = settings_default(), .partial = true, .checkpoint_every = 10, .farm_stall = 30, .farm_silence = 60};
    size_t room = argc > 0 ? (size_t)argc : 1;
    const char **scripts = arena_alloc_array(arena, room, sizeof *scripts);
    if (!take_device(options, error))
        return false;
    struct lists lists = {.defines = arena_alloc_array(arena, room, sizeof *lists.defines),
                          .pixels = arena_alloc_array(arena, room, sizeof *lists.pixels),
                          .folders = {arena_alloc_array(arena, room, sizeof *lists.folders[0]),
                                      arena_alloc_array(arena, room, sizeof *lists.folders[1])},
                          .given = arena_alloc_array(arena, (size_t)setting_count, sizeof *lists.given)};
    if (!lists.given || !scripts || !lists.defines || !lists.pixels || !lists.folders[0] || !lists.folders[1])
        return error_no_memory(error, "the command line");
    options->scripts = scripts;
    options->script.defines = lists.defines;
    options->script.given = lists.given;
    options->pixels = (const uint32_t(*)[2])lists.pixels;
    options->script.allow_read = lists.folders[0];
    options->script.allow_write = lists.folders[1];
    bool only_scripts = false;
    const struct setting *unused[ACTIONS_WITH_WORDS] = {NULL}; /* the first option that an action does not use */
    for (int i = 1; i < argc; i++) {
        const char *word = argv[i];
        /* The first word that is no option; `gray -- merge` is a scene of that name. */
        bool is_first = !only_scripts && options->action == ACTION_RENDER && options->script_count == 0;
        for (int action = ACTION_MERGE; is_first && action < ACTIONS_WITH_WORDS; action++) {
            if (strcmp(word, actions[action].word) == 0)
                options->action = (enum options_action)action;
        }
        if (is_first && options->action != ACTION_RENDER)
            continue;
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
        const struct setting *option = find_option(name);
        if (!option)
            option = find_attached(word, &text);
        if (!option)
            return unknown_option(word, name, error);
        for (int action = ACTION_MERGE; action < ACTIONS_WITH_WORDS; action++) {
            if (!unused[action] && !serves(option, action))
                unused[action] = option;
        }
        bool has_value = option_value(option) != NULL && option->kind != SETTING_ACTION;
        if (!has_value && text && option->kind != SETTING_FLAG)
            return value_error(option, shown_name(option), text, error);
        if (!text && option_may_lack_value(option))
            text = option->value;
        if (has_value && !text) {
            if (i + 1 >= argc)
                return error_set(error, ERROR_USAGE, "%s needs a value: %s", word, option_value(option));
            text = argv[++i];
        }
        if (!apply_option(option, text, options, &lists, arena, error))
            return false;
        only_scripts = options->action >= ACTION_MANUAL;
        /* --denoise=auto leaves the field to the scene. */
        bool leaves = option->kind == SETTING_DENOISE && options->settings.denoise == DENOISER_AUTO;
        if (option_is_setting(option))
            lists.given[option - setting_table] = leaves ? NULL : text ? text : "";
    }
    options->settings.keep_first = options->targets_prefix || options->first_pass_prefix;
    if ((int)options->action < (int)ACTIONS_WITH_WORDS && unused[options->action])
        return refuse_for_action(unused[options->action], (int)options->action, error);
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
