/* Parsing goes along the table: the kind of a row says how its value is read, `offset` where it goes. The long spelling
 * of an option takes one dash or two, and '_' counts as '-'; `--name value` and `--name=value` are the same. Words that
 * are no options are scripts; after "--" everything is. */
#include "app/options.h"
#include "accel/isa.h"

#include "app/display.h"

#include "base/size.h"
#include "render/aov.h"

#include <assert.h>
#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum option_kind {
    OPTION_FLAG,    /* bool, set to true; takes no value */
    OPTION_INTEGER, /* int in low..high */
    OPTION_NUMBER,  /* double in low..high */
    OPTION_BYTES,   /* uint64_t in low..high: a size with its unit, in MiB without one */
    OPTION_CHOICE,  /* enum or bool: the position of the word in `value`, words parted by '|' */
    OPTION_TEXT,    /* const char *, not empty */
    OPTION_ACTION,  /* options.action; `low` says which */
    OPTION_SIZE,    /* --size */
    OPTION_CROP,    /* --crop */
    OPTION_PIXEL,   /* --pixel */
    OPTION_SEED,    /* --seed */
    OPTION_DEFINE,  /* -D */
    OPTION_FOLDER,  /* --allow-read, --allow-write: `low` says which */
    OPTION_SHARD,   /* I/N: two uint32_t from the field on */
    OPTION_LAYERS,  /* --aov */
    OPTION_STATS,   /* --stats, --stats=text, --stats=json */
};

enum option_group {
    GROUP_PICTURE,
    GROUP_LOOK,
    GROUP_FILES,
    GROUP_OLD,
    GROUP_TRUST,
    GROUP_RUN,
    GROUP_PARTS,
    GROUP_TALK,
    GROUP_COUNT
};

struct option {
    enum option_group group;
    const char *names; /* parted by '|'; the first is the one that is shown, with its dashes */
    enum option_kind kind;
    const char *value; /* what the value is called, or its choices; NULL for none */
    double low, high;
    size_t offset, size;
    const char *initial; /* the default in words, or NULL */
    const char *help;
};

#define FIELD(name) offsetof(struct options, name), sizeof(((struct options *)NULL)->name)
#define NO_FIELD 0, 0
#define NO_RANGE 0, 0
/* The first choice is the best set that the processor has. */
#define ISA_CHOICES "auto" ACCEL_ISAS(LIST_BAR_WORD)
#define WORD_AFTER_AUTO(member, word) [(member) + 1] = (word),
#define LAYER_NAME(aov, name, channels) " " name ","
#define SIZES 0x1p10, 0x1p50 /* 1 KiB to 1 PiB */

static const char *const group_titles[GROUP_COUNT] = {
    [GROUP_PICTURE] = "Anti-aliasing and rays",        [GROUP_LOOK] = "Size, part and search", [GROUP_FILES] = "Files",
    [GROUP_OLD] = "Scenes written for other programs", [GROUP_TRUST] = "What scenes may do",   [GROUP_RUN] = "The run",
    [GROUP_PARTS] = "Long runs and many machines",     [GROUP_TALK] = "What is told",
};

static const struct option table[] = {
    {GROUP_PICTURE, "--integrator", OPTION_CHOICE, LIST_BARS(INTEGRATORS), NO_RANGE, FIELD(settings.integrator),
     "whitted", "how light becomes a picture"},
    {GROUP_PICTURE, "-ss", OPTION_INTEGER, "N", 1, 64, FIELD(settings.samples), "3",
     "N x N samples for a marked pixel"},
    {GROUP_PICTURE, "-full", OPTION_FLAG, NULL, NO_RANGE, FIELD(settings.full), NULL,
     "N x N samples for every pixel, not only for marked ones"},
    {GROUP_PICTURE, "-side-tolerance", OPTION_NUMBER, "X", 0, HUGE_VAL, FIELD(settings.side_tolerance), "0.005",
     "a pixel is marked when the squared RGB distance to a side neighbour exceeds X"},
    {GROUP_PICTURE, "-corner-tolerance", OPTION_NUMBER, "X", 0, HUGE_VAL, FIELD(settings.corner_tolerance), "0.01",
     "the same for the corner neighbours"},
    {GROUP_PICTURE, "-reflect-limit", OPTION_INTEGER, "N", 0, 1000, FIELD(settings.reflect_limit), "2",
     "how often a path may reflect"},
    {GROUP_PICTURE, "-refract-limit", OPTION_INTEGER, "N", 0, 1000, FIELD(settings.refract_limit), "4",
     "how often a path may refract"},
    {GROUP_PICTURE, "-use-tir", OPTION_FLAG, NULL, NO_RANGE, FIELD(settings.use_tir), NULL,
     "beyond the critical angle the refracted share is reflected instead of lost"},
    {GROUP_PICTURE, "-al-samples|alsamples", OPTION_INTEGER, "N", 1, 64, FIELD(settings.area_samples), "4",
     "N x N shadow rays for each area light"},
    {GROUP_PICTURE, "--caustics", OPTION_INTEGER, "N", 0, PHOTONS_MOST, FIELD(settings.caustics.photons), "0",
     "N photons make the light that glass and mirrors throw"},
    {GROUP_PICTURE, "--cutoff", OPTION_NUMBER, "X", 0, 1, FIELD(settings.cutoff), "0.0001",
     "rays that can change a pixel by less than X (of 1) are not followed; 0: all are"},
    {GROUP_PICTURE, "--seed", OPTION_SEED, "N", NO_RANGE, NO_FIELD, "0",
     "start of all random numbers, the scripts' math.random included"},

    {GROUP_PICTURE, "--quick", OPTION_FLAG, NULL, NO_RANGE, FIELD(quick), NULL,
     "a draft: one sample a pixel, few shadow rays, no caustics, no blur by lens or motion, whatever else is asked "
     "for"},
    {GROUP_PICTURE, "--preview", OPTION_FLAG, NULL, NO_RANGE, FIELD(preview), NULL,
     "a smaller draft: a quarter of the width and height (unless --size is given), and neither reflections nor "
     "refractions"},

    {GROUP_LOOK, "--size", OPTION_SIZE, "WxH", NO_RANGE, NO_FIELD, "the script's", "size of the pictures in pixels"},
    {GROUP_LOOK, "--crop", OPTION_CROP, "X,Y,W,H", NO_RANGE, NO_FIELD, "all",
     "write a W x H picture, exactly that part of the whole; X,Y is its upper left pixel"},
    {GROUP_LOOK, "--accel", OPTION_CHOICE, LIST_BARS(ACCEL_KINDS), NO_RANGE, FIELD(settings.accel), "auto",
     "how rays find what they hit; the picture is the same"},
    {GROUP_LOOK, "--isa", OPTION_CHOICE, ISA_CHOICES, NO_RANGE, FIELD(isa), "auto",
     "instruction set of the kernels; the picture is the same"},

    {GROUP_LOOK, "--exposure", OPTION_NUMBER, "STOPS", -100, 100, FIELD(settings.tone.exposure), "0",
     "light is multiplied by 2^STOPS on its way into a PNG file"},
    {GROUP_LOOK, "--tone", OPTION_CHOICE, LIST_BARS(TONE_CURVES), NO_RANGE, FIELD(settings.tone.curve), "none",
     "the curve that brings bright light into the range of a PNG file"},
    {GROUP_LOOK, "--srgb", OPTION_FLAG, NULL, NO_RANGE, FIELD(settings.tone.srgb), NULL,
     "values of a PNG file follow the sRGB transfer function instead of light itself"},
    {GROUP_LOOK, "--deep", OPTION_FLAG, NULL, NO_RANGE, FIELD(settings.deep), NULL, "16 bits a channel in PNG files"},

    {GROUP_FILES, "-o", OPTION_TEXT, "FILE", NO_RANGE, FIELD(output), "the script's",
     "name of the picture (.png, or .pfm, .hdr and .exr for light as it is), '-' for standard output; with several "
     "pictures "
     "FILE needs %d (or %03d), which counts from "
     "1"},
    {GROUP_FILES, "--force", OPTION_FLAG, NULL, NO_RANGE, FIELD(force), NULL,
     "-o FILE also replaces a file that is no picture"},
    {GROUP_FILES, "-write-aa-targets", OPTION_TEXT, "X", NO_RANGE, FIELD(targets_prefix), NULL,
     "for dir/foo.png also write dir/Xfoo.png: the first pass with the marked pixels in red"},
    {GROUP_FILES, "-write-pre-aa", OPTION_TEXT, "X", NO_RANGE, FIELD(first_pass_prefix), NULL,
     "for dir/foo.png also write dir/Xfoo.png: the first pass, one sample for each pixel"},

    {GROUP_FILES, "--aov", OPTION_LAYERS, "LIST", NO_RANGE, NO_FIELD, NULL,
     "for dir/foo.png also write dir/foo.NAME.png for each NAME of LIST, parted by commas:" AOVS(LAYER_NAME) " or all"},

    {GROUP_FILES, "--overlay", OPTION_CHOICE, LIST_BARS(OVERLAYS), NO_RANGE, FIELD(settings.overlay), "none",
     "lines over the picture: the boxes of all that is placed, or the cells of what rays search (see --accel)"},

    {GROUP_OLD, "--transform-order", OPTION_CHOICE, LIST_BARS(SCRIPT_ORDERS), NO_RANGE, FIELD(script.transform_order),
     "auto",
     "new: transforms act in the order they are written; old: the last one acts first; separate: scale, rotate, "
     "translate are kept apart; auto: decided from the text of the script"},
    {GROUP_OLD, "--view", OPTION_CHOICE, "direction|target", NO_RANGE, FIELD(settings.view_is_target), "direction",
     "whether the view argument is a direction or a point to look at"},
    {GROUP_OLD, "--pixel-sample", OPTION_CHOICE, "centre|corner", NO_RANGE, FIELD(settings.pixel_corner), "centre",
     "where the first sample of a pixel lies"},
    {GROUP_OLD, "--specular", OPTION_CHOICE, LIST_BARS(SPECULAR_KINDS), NO_RANGE, FIELD(settings.specular), "phong",
     "formula of the highlight"},
    {GROUP_OLD, "--ambient", OPTION_CHOICE, "kd|plain", NO_RANGE, FIELD(settings.ambient_plain), "kd",
     "ambient light is multiplied with kd, or added as it is"},
    {GROUP_OLD, "--lenient", OPTION_FLAG, NULL, NO_RANGE, FIELD(script.lenient), NULL,
     "a gr function that does not exist is a warning and does nothing"},

    {GROUP_RUN, "-j", OPTION_INTEGER, "N", 1, 1024, FIELD(threads), "one for each processor",
     "number of threads; the picture is the same for any number"},
    {GROUP_RUN, "--tile-order", OPTION_CHOICE, LIST_BARS(TILE_ORDERS), NO_RANGE, FIELD(settings.order), "spread",
     "in which order tiles are made (in a window always from the centre); the picture is the same"},
    {GROUP_RUN, "-D", OPTION_DEFINE, "name=value", NO_RANGE, NO_FIELD, NULL,
     "set the Lua global `name` before the script runs: a Lua literal, else a string; may be repeated"},
    {GROUP_TRUST, "--allow-read", OPTION_FOLDER, "DIR", 0, 0, NO_FIELD, NULL,
     "scenes may read below DIR too; without it: below their own folder, the folder above it, the working directory "
     "and the library; may be repeated"},
    {GROUP_TRUST, "--allow-write", OPTION_FOLDER, "DIR", 1, 0, NO_FIELD, NULL,
     "scenes may write files below DIR; without it they write none (pictures are written by gray); may be repeated"},
    {GROUP_TRUST, "--script-memory", OPTION_BYTES, "SIZE", SIZES, FIELD(script.memory_limit), "4G",
     "memory a script and the files it reads may use, as in 512M or 2G (a plain number is MiB); a picture and "
     "the script together may use three quarters more"},
    {GROUP_TRUST, "--script-time", OPTION_NUMBER, "SECONDS", 0.001, HUGE_VAL, FIELD(script.time_limit), "60",
     "processor time a script may use for itself; rendering is not counted"},
    {GROUP_TRUST, "--script-output", OPTION_BYTES, "SIZE", SIZES, FIELD(script.output_limit), "64M",
     "how much a script may print and write (a plain number is MiB); pictures are not counted"},
    {GROUP_TRUST, "--picture-count", OPTION_INTEGER, "N", 1, INT_MAX, FIELD(picture_count), "100000",
     "how many pictures the scripts of a run may render, one that replaces another counted again"},
    {GROUP_TRUST, "--picture-bytes", OPTION_BYTES, "SIZE", SIZES, FIELD(picture_bytes), "64G",
     "how much is written into files of pictures in a run (a plain number is MiB)"},
    {GROUP_TRUST, "--no-sandbox", OPTION_FLAG, NULL, NO_RANGE, FIELD(script.no_sandbox), NULL,
     "scenes may do whatever the user may: read and write all files, start programs; for scenes you trust"},

    {GROUP_RUN, "--check", OPTION_FLAG, NULL, NO_RANGE, FIELD(check), NULL,
     "run the scripts and build their scenes, render nothing, report every problem"},
    {GROUP_RUN, "--no-fork", OPTION_FLAG, NULL, NO_RANGE, FIELD(no_fork), NULL,
     "render in this process (for debuggers)"},

    {GROUP_PARTS, "--checkpoint", OPTION_TEXT, "FILE", NO_RANGE, FIELD(checkpoint), NULL,
     "keep finished tiles in FILE while rendering, for --resume; auto: a file beside the first picture; SIGUSR1 writes "
     "it "
     "at once; it is removed when all pictures are written"},
    {GROUP_PARTS, "--checkpoint-every", OPTION_NUMBER, "SECONDS", 0, HUGE_VAL, FIELD(checkpoint_every), "10",
     "how often, at least; writing never takes more than a twentieth of the time"},
    {GROUP_PARTS, "--resume", OPTION_FLAG, NULL, NO_RANGE, FIELD(resume), NULL,
     "go on with what the checkpoint holds (--checkpoint auto, unless it is named); a changed scene is refused; a "
     "--shard whose part is there already is done"},
    {GROUP_PARTS, "--partial", OPTION_FLAG, NULL, NO_RANGE, FIELD(partial), NULL,
     "of a picture that is interrupted write dir/foo.partial.png: the tiles that are done, the others black"},
    {GROUP_PARTS, "--shard", OPTION_SHARD, "I/N", NO_RANGE, FIELD(shard), NULL,
     "make part I of N of every picture, a file of tiles beside it; `gray merge PART ...` puts the parts together"},
    {GROUP_PARTS, "--shard-pictures", OPTION_SHARD, "I/N", NO_RANGE, FIELD(shard_of_pictures), NULL,
     "of many pictures make every Nth, from the Ith on"},
    {GROUP_PARTS, "--mpi", OPTION_FLAG, NULL, NO_RANGE, FIELD(mpi), NULL,
     "under mpirun: all processes make each picture together, tiles are handed out on demand"},
    {GROUP_PARTS, "--farm-stall", OPTION_NUMBER, "SECONDS", 0, 1e9, FIELD(farm_stall), "30",
     "with --mpi: a rendering process that uses no processor time for so long, though none is missing, is killed, and "
     "another one makes its tiles; 0: never"},
    {GROUP_PARTS, "--farm-silence", OPTION_NUMBER, "SECONDS", 0, 1e9, FIELD(farm_silence), "60",
     "with --mpi: a process that is not heard for so long is regarded as lost, and others make its tiles; 0: never"},

    {GROUP_TALK, "-gui", OPTION_FLAG, NULL, NO_RANGE, FIELD(window), NULL,
     "show the picture in a window while it is made, and walk through the scene: R renders, S saves what is shown, V "
     "the camera, Space walks (W A S D Q E and the mouse, Esc leaves), N goes on, Q quits"},
    {GROUP_TALK, "--watch", OPTION_FLAG, NULL, NO_RANGE, FIELD(watch), NULL,
     "run the scripts again whenever one of them, or a file that they read, has changed; Ctrl-C ends it"},
    {GROUP_TALK, "-q|quiet", OPTION_FLAG, NULL, NO_RANGE, FIELD(quiet), NULL, "say nothing but errors"},
    {GROUP_TALK, "--verbose", OPTION_FLAG, NULL, NO_RANGE, FIELD(verbose), NULL, "say what is done and why"},
    {GROUP_TALK, "--stats", OPTION_STATS, "=text|json", NO_RANGE, NO_FIELD, NULL,
     "what each picture cost: a table on standard error, or one JSON line a picture on standard output"},
    {GROUP_TALK, "--progress", OPTION_CHOICE, LIST_BARS(PROGRESS_MODES), NO_RANGE, FIELD(progress), "auto",
     "how far the picture is and how long it will take, on standard error; auto: a bar on a terminal, else a line now "
     "and then when it takes long"},
    {GROUP_TALK, "--display", OPTION_TEXT, "WHERE", NO_RANGE, FIELD(display), NULL,
     "show the picture while it is made: tev[:HOST[:PORT]] in the image viewer tev (port 14158), term in the terminal "
     "(term:kitty, term:sixel or term:blocks if it does not find out itself)"},
    {GROUP_TALK, "--pixel", OPTION_PIXEL, "X,Y", NO_RANGE, NO_FIELD, NULL,
     "render nothing, but tell on standard output how this pixel of every picture comes about: its rays, what they "
     "meet, "
     "lights and weights, down to the byte; may be repeated"},
    {GROUP_TALK, "--dump-scene", OPTION_FLAG, NULL, NO_RANGE, FIELD(dump_scene), NULL,
     "render nothing, but tell what every picture's world is made of"},
    {GROUP_TALK, "--json", OPTION_FLAG, NULL, NO_RANGE, FIELD(json), NULL,
     "--pixel and --dump-scene as JSON, one line a picture"},
    {GROUP_TALK, "--help|h", OPTION_ACTION, NULL, ACTION_HELP, 0, NO_FIELD, NULL, "this text"},
    {GROUP_TALK, "--man", OPTION_ACTION, NULL, ACTION_MANUAL, 0, NO_FIELD, NULL,
     "this text and all functions of the scene language"},
    {GROUP_TALK, "--annotations", OPTION_ACTION, NULL, ACTION_ANNOTATIONS, 0, NO_FIELD, NULL,
     "the functions as an annotation file for editors (lua/gr.lua)"},
    {GROUP_TALK, "--version", OPTION_ACTION, NULL, ACTION_VERSION, 0, NO_FIELD, NULL,
     "version of this program and of its libraries"},
};
enum { TABLE_SIZE = sizeof table / sizeof *table };

_Static_assert(offsetof(struct options, shards) == offsetof(struct options, shard) + sizeof(uint32_t) &&
                   offsetof(struct options, shards_of_pictures) ==
                       offsetof(struct options, shard_of_pictures) + sizeof(uint32_t),
               "a shard is two numbers in a row");

/* Values are stored through their size: an enum is an int here. */
_Static_assert(sizeof(enum specular_kind) == sizeof(int) && sizeof(enum accel_kind) == sizeof(int) &&
                   sizeof(enum script_order) == sizeof(int) && sizeof(enum tone_curve) == sizeof(int) &&
                   sizeof(enum progress_mode) == sizeof(int) && sizeof(enum order) == sizeof(int) &&
                   sizeof(enum overlay) == sizeof(int) && sizeof(enum integrator_kind) == sizeof(int),
               "choices are stored as int");

/* The next piece of a text parted by '|'; *rest moves behind it. Empty at the end. */
struct piece {
    const char *text;
    size_t length;
};

static struct piece next_piece(const char **rest) {
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
    for (int i = 0; i < TABLE_SIZE; i++) {
        for (const char *rest = table[i].names; *rest;) {
            if (same_name(name, without_dashes(next_piece(&rest))))
                return &table[i];
        }
    }
    return NULL;
}

/* Edits (insert, delete, replace, swap of neighbours) between a word and a short name of the table; words over 31
 * letters count as far. */
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

/* The shown spelling of the option nearest to a misspelt name, or an empty piece when none is near. */
static struct piece nearest_name(struct piece name) {
    struct piece best = {"", 0};
    int best_distance = name.length < 4 ? 2 : 3;
    for (int i = 0; i < TABLE_SIZE; i++) {
        for (const char *rest = table[i].names; *rest;) {
            struct piece candidate = next_piece(&rest), bare = without_dashes(candidate);
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

static bool read_number(const char *text, double low, double high, double *out) {
    if (!isdigit((unsigned char)text[0]) && !strchr("+-.", text[0]))
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

/* Whole numbers parted by `separator`: exactly `count` of them. */
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
        struct piece word = next_piece(&rest);
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

/* Room for one more definition was made by options_parse. */
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
        struct piece word = next_piece(&rest);
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
    int shown = (int)next_piece(&rest).length;
    switch (option->kind) {
    case OPTION_INTEGER:
        return error_set(error, ERROR_USAGE, "%.*s needs a whole number from %.0f to %.0f, not '%s'", shown,
                         option->names, option->low, option->high, text);
    case OPTION_NUMBER:
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
    case OPTION_STATS:
        return error_set(error, ERROR_USAGE, "%.*s needs one of %s, not '%s'", shown, option->names,
                         option->value + (option->value[0] == '='), text);
    case OPTION_LAYERS:
        return error_set(error, ERROR_USAGE,
                         "%.*s needs names parted by commas (depth, normal, albedo, uv, node, material, cost, samples, "
                         "lights) or all, not '%s'",
                         shown, option->names, text);
    case OPTION_TEXT:
        return error_set(error, ERROR_USAGE, "%.*s needs a text that is not empty", shown, option->names);
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
};

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
    case OPTION_LAYERS:
        ok = aov_parse(text, &options->settings.aov);
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

static bool unknown_option(const char *word, struct piece name, struct error *error) {
    struct piece near = nearest_name(name);
    if (near.length == 0)
        return error_set(error, ERROR_USAGE, "there is no option '%s'", word);
    return error_set(error, ERROR_USAGE, "there is no option '%s'; did you mean %.*s?", word, (int)near.length,
                     near.text);
}

/* What can only be said of the options together. */
static bool check_together(const struct options *options, struct error *error) {
    bool merge = options->action == ACTION_MERGE;
    if (options->action != ACTION_RENDER && !merge)
        return true;
    if (options->script_count == 0)
        return error_set(error, ERROR_USAGE, merge ? "no parts to merge were given" : "no scene script was given");
    for (int i = 0; i < options->script_count; i++) {
        if (options->scripts[i][0] == '\0')
            return error_set(error, ERROR_USAGE, "the name of a script is empty");
        if (strcmp(options->scripts[i], "-") == 0)
            return error_set(error, ERROR_USAGE, "scripts are not read from standard input; give the name of a file");
    }
    if (options->targets_prefix && options->first_pass_prefix &&
        strcmp(options->targets_prefix, options->first_pass_prefix) == 0)
        return error_set(error, ERROR_USAGE, "-write-aa-targets and -write-pre-aa would write the same file");
    if (options->output && strcmp(options->output, "-") == 0 && (options->targets_prefix || options->first_pass_prefix))
        return error_set(error, ERROR_USAGE, "-o - leaves no name for -write-aa-targets and -write-pre-aa");
    if (options->output && strcmp(options->output, "-") == 0 && options->settings.aov)
        return error_set(error, ERROR_USAGE, "-o - leaves no name for --aov");
    if (options->output && strcmp(options->output, "-") == 0 && options->statistics == STATISTICS_JSON)
        return error_set(error, ERROR_USAGE, "-o - and --stats=json both write to standard output");
    return true;
}

/* --pixel and --dump-scene. */
static bool check_questions(const struct options *options, struct error *error) {
    const char *asked = options->pixel_count > 0 ? "--pixel" : "--dump-scene";
    if (options->pixel_count == 0 && !options->dump_scene)
        return !options->json || error_set(error, ERROR_USAGE, "--json is for --pixel and --dump-scene");
    if (options->window || options->check || options->shards || options->shards_of_pictures || options->mpi ||
        options->checkpoint || options->resume || options->action == ACTION_MERGE)
        return error_set(error, ERROR_USAGE,
                         "%s renders nothing: it goes with no -gui, --check, --shard, --mpi, --checkpoint, --resume "
                         "or merge",
                         asked);
    return true;
}

/* What --checkpoint, --resume and --shard ask of one another and of -o. */
static bool check_parts(struct options *options, struct error *error) {
    bool pipe = options->output && strcmp(options->output, "-") == 0;
    if (options->action == ACTION_MERGE &&
        (options->checkpoint || options->resume || options->shards || options->shards_of_pictures || options->check))
        return error_set(error, ERROR_USAGE, "merge takes no --checkpoint, --resume, --shard or --check");
    struct display_choice display;
    if (options->display && !display_parse(options->display, &display))
        return error_set(error, ERROR_USAGE,
                         "--display needs tev, tev:HOST, tev:HOST:PORT, term, term:kitty, term:sixel or term:blocks, "
                         "not '%s'",
                         options->display);
    if (options->display && (options->window || options->check || options->shards || options->action == ACTION_MERGE ||
                             (pipe && display.kind == DISPLAY_TERMINAL)))
        return error_set(error, ERROR_USAGE, "--display takes no -gui, --check, --shard or merge, nor term with -o -");
    if (options->partial && (options->window || options->shards || options->mpi || options->no_fork || pipe ||
                             options->action == ACTION_MERGE))
        return error_set(error, ERROR_USAGE, "--partial takes no -gui, --shard, --mpi, --no-fork, merge or -o -");
    if (options->resume && !options->checkpoint)
        options->checkpoint = "auto";
    if (options->mpi && (options->shards || options->shards_of_pictures || options->no_fork || options->check))
        return error_set(error, ERROR_USAGE, "--mpi takes no --shard, --shard-pictures, --no-fork or --check");
    if (options->window && (options->checkpoint || options->shards || options->shards_of_pictures || options->mpi ||
                            options->no_fork || options->check || options->settings.aov))
        return error_set(error, ERROR_USAGE,
                         "-gui takes no --checkpoint, --resume, --shard, --mpi, --no-fork, --check or --aov");
    if (options->watch && (options->checkpoint || options->shards || options->shards_of_pictures || options->mpi ||
                           options->no_fork || pipe))
        return error_set(error, ERROR_USAGE,
                         "--watch takes no --checkpoint, --resume, --shard, --mpi, --no-fork or -o -");
    if (options->no_fork && (options->checkpoint || options->shards))
        return error_set(error, ERROR_USAGE,
                         "--no-fork is for debuggers: it takes no --checkpoint, --resume or --shard");
    if (pipe && options->checkpoint && strcmp(options->checkpoint, "auto") == 0)
        return error_set(error, ERROR_USAGE, "-o - leaves no name for a checkpoint; --checkpoint FILE gives one");
    if (pipe && options->shards)
        return error_set(error, ERROR_USAGE, "-o - leaves no name for the parts of --shard");
    if ((options->shards || options->mpi || options->checkpoint || options->action == ACTION_MERGE) &&
        options->settings.aov)
        return error_set(error, ERROR_USAGE,
                         "--aov is for pictures that one process makes in one go: no --shard, --mpi, --checkpoint, "
                         "--resume or merge");
    if ((options->shards || options->mpi || options->checkpoint || options->action == ACTION_MERGE) &&
        options->settings.overlay != OVERLAY_NONE)
        return error_set(error, ERROR_USAGE,
                         "--overlay is for pictures that one process makes in one go: no --shard, --mpi, --checkpoint, "
                         "--resume or merge");
    if (options->shards && (options->targets_prefix || options->first_pass_prefix))
        return error_set(error, ERROR_USAGE, "--shard writes no debug pictures; give -write-... to gray merge");
    return true;
}

/* Two options may change the order in which they are written, not what they are: so the values are looked at. */
static struct digest digest_option(const struct option *option, const struct options *options, struct digest digest) {
    assert(option->kind != OPTION_TEXT); /* of those the pointer would be looked at */
    return digest_bytes((const char *)options + option->offset, option->size, digest);
}

struct digest options_digest(const struct options *options) {
    struct digest digest = {0};
    for (int i = 0; i < TABLE_SIZE; i++) {
        const struct option *option = &table[i];
        bool picture = option->group == GROUP_PICTURE || option->group == GROUP_LOOK || option->group == GROUP_OLD;
        bool search = option->offset == offsetof(struct options, settings.accel) ||
                      option->offset == offsetof(struct options, isa);
        bool integrator = option->offset == offsetof(struct options, settings.integrator);
        if (picture && option->size > 0 && !search && !integrator)
            digest = digest_option(option, options, digest);
    }
    const struct settings *settings = &options->settings;
    /* Files from before there was a choice have the key of the first. */
    if (settings->integrator != INTEGRATOR_WHITTED)
        digest = digest_bytes(&settings->integrator, sizeof settings->integrator, digest);
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

bool options_allow_picture(const struct options *options, uint64_t number, struct error *error) {
    enum { STANDARD = 100000 };
    int limit = options->picture_count > 0 ? options->picture_count : STANDARD;
    if (number <= (uint64_t)limit || (options->picture_count == 0 && options->script.no_sandbox))
        return true;
    return error_set_limit(error, "the scripts render more than %d picture%s (--picture-count allows more)", limit,
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
                                      arena_alloc_array(arena, room, sizeof *lists.folders[1])}};
    if (!scripts || !lists.defines || !lists.pixels || !lists.folders[0] || !lists.folders[1])
        return error_no_memory(error, "the command line");
    options->scripts = scripts;
    options->script.defines = lists.defines;
    options->pixels = (const uint32_t(*)[2])lists.pixels;
    options->script.allow_read = lists.folders[0];
    options->script.allow_write = lists.folders[1];
    bool only_scripts = false;
    for (int i = 1; i < argc; i++) {
        const char *word = argv[i];
        /* The first word of its own; `gray -- merge` is a scene of that name. */
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
        /* The value: behind '=', or attached to a letter, or the next word. */
        struct piece name = without_dashes((struct piece){word, strcspn(word, "=")});
        const char *text = strchr(word, '=');
        text = text ? text + 1 : NULL;
        const struct option *option = find_option(name);
        if (!option)
            option = find_attached(word, &text);
        if (!option)
            return unknown_option(word, name, error);
        if (!option->value && text)
            return value_error(option, text, error);
        if (option->kind == OPTION_STATS && !text)
            text = "text";
        if (option->value && !text) {
            if (i + 1 >= argc)
                return error_set(error, ERROR_USAGE, "%s needs a value: %s", word, option->value);
            text = argv[++i];
        }
        if (!apply_option(option, text, options, &lists, arena, error))
            return false;
    }
    options->settings.keep_first = options->targets_prefix || options->first_pass_prefix;
    return check_together(options, error) && check_questions(options, error) && check_parts(options, error);
}

bool options_output_is_stream(const struct options *options) {
    bool asks = options->pixel_count > 0 || options->dump_scene; /* then there is no picture */
    return options->output && strcmp(options->output, "-") == 0 && !asks;
}

/* Prints words from `column` on, broken so that no line is longer than 100 columns. */
static void print_wrapped(FILE *stream, const char *text, int column) {
    enum { INDENT = 36, WIDTH = 100 };
    if (column >= INDENT) {
        (void)fputc('\n', stream);
        column = 0;
    }
    (void)fprintf(stream, "%*s", INDENT - column, "");
    column = INDENT;
    while (*text) {
        size_t length = strcspn(text, " ");
        if (column > INDENT && column + 1 + (int)length > WIDTH) {
            (void)fprintf(stream, "\n%*s", INDENT, "");
            column = INDENT;
        }
        column += fprintf(stream, "%s%.*s", column > INDENT ? " " : "", (int)length, text);
        text += length + (text[length] == ' ');
    }
    (void)fputc('\n', stream);
}

static void print_option(FILE *stream, const struct option *option) {
    int column = fprintf(stream, "  ");
    for (const char *rest = option->names; *rest;) {
        bool first = rest == option->names;
        struct piece name = next_piece(&rest);
        column += fprintf(stream, "%s%.*s", first ? "" : name.length > 1 ? ", --" : ", -", (int)name.length, name.text);
    }
    if (option->value && option->value[0] == '=')
        column += fprintf(stream, "[%s]", option->value);
    else if (option->value)
        column += fprintf(stream, " %s", option->value);
    char help[512];
    (void)snprintf(help, sizeof help, "%s%s%s%s", option->help, option->initial ? " (default: " : "",
                   option->initial ? option->initial : "", option->initial ? ")" : "");
    print_wrapped(stream, help, column);
}

void options_print_help(FILE *stream) {
    (void)fputs(
        "gray renders scenes that are written as Lua scripts.\n"
        "usage: gray [options] [--] scene.lua ...\n"
        "       gray merge [-o FILE] [options] PART ...\n"
        "Long options take one dash or two, and '_' or '-' between words; the value follows after a blank or '='.\n",
        stream);
    for (int group = 0; group < GROUP_COUNT; group++) {
        (void)fprintf(stream, "\n%s\n", group_titles[group]);
        for (int i = 0; i < TABLE_SIZE; i++) {
            if (table[i].group == (enum option_group)group)
                print_option(stream, &table[i]);
        }
    }
    (void)fputs(
        "\nExit status: 0 all pictures were written; 1 a scene or a file was wrong; 2 wrong usage; 3 the machine\n"
        "failed (disk full, out of memory, a crash); 130 interrupted. Of several scripts each is tried, and the\n"
        "highest status counts. Wrong usage and an interruption end the run.\n"
        "Environment: GRAY_LUA names the folder of the Lua library that is searched last by require.\n",
        stream);
}

/* The %d of a name pattern: its place and length, or a length of 0. Digits between % and d are a width. */
static struct piece find_number(const char *pattern) {
    for (const char *at = pattern; *at; at++) {
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

bool output_name(const char *pattern, unsigned number, char *out, size_t size) {
    struct piece place = find_number(pattern);
    size_t length = 0;
    for (const char *at = pattern; *at && length < size;) {
        if (place.length > 0 && at == place.text) {
            int width = atoi(at + 1);
            bool zeros = at[1] == '0';
            int printed = snprintf(out + length, size - length, zeros ? "%0*u" : "%*u", width, number);
            length += (size_t)printed;
            at += place.length;
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

const char *options_isa_name(const struct options *options) {
    static const char *const names[] = {"auto", ACCEL_ISAS(WORD_AFTER_AUTO)};
    return names[options->isa];
}
