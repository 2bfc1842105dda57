/* The rows of the settings, made from the list, and the operations on any row. */
#include "settings/setting.h"

#include <stdio.h>
#include <string.h>

/* `...`: the help, and the effect where it has a column. */
#define SETTING_ROW(kind_, type, member, change, initial_, low_, high_, list, option_, value_, unit, field_, words_,   \
                    group_, ...)                                                                                       \
    {.kind = SETTING_##kind_,                                                                                          \
     .changes = CHANGES_##change,                                                                                      \
     .group = OPTION_GROUP_##group_,                                                                                   \
     .option = option_,                                                                                                \
     .value = value_,                                                                                                  \
     .words = LIST_BARS(list),                                                                                         \
     .field = field_,                                                                                                  \
     .offset = offsetof(struct settings, member),                                                                      \
     .size = sizeof(((struct settings *)NULL)->member),                                                                \
     .initial = (double)(initial_),                                                                                    \
     .low = (double)(low_),                                                                                            \
     .high = (double)(high_),                                                                                          \
     .initial_words = words_,                                                                                          \
     __VA_ARGS__},

const struct setting setting_table[] = {SETTINGS(SETTING_ROW)};
const int setting_count = sizeof setting_table / sizeof *setting_table;
const int setting_field_count = LIST_COUNT(SETTINGS_WITH_FIELD);

/* A member of struct settings, or of a struct in it, that no list names is missing here too, which is a warning: an
 * error in the tests. */
#define ZERO(...) 0,
extern const struct settings settings_zero;
const struct settings settings_zero = {{SETTINGS_OF_TONE(ZERO) NULL},
                                       {SETTINGS_OF_FINISH(ZERO)},
                                       {SETTINGS_OF_CAUSTICS(ZERO) SETTINGS_OF_RADIUS(ZERO)},
                                       {.blades = 0},
                                       {.open = 0},
                                       {.moves = false},
                                       SETTINGS_OF_SCENES(ZERO) SETTINGS_OF_RUNS(ZERO) SETTINGS_WITHIN(ZERO)};

/* Values are stored through their size: an enum is an int here. */
#define CHOICE_IS_STORED(kind, type, member, ...)                                                                      \
    _Static_assert(SETTING_##kind != SETTING_CHOICE || sizeof(type) == sizeof(int) || sizeof(type) == sizeof(bool),    \
                   "choices are stored as int or bool");
SETTINGS(CHOICE_IS_STORED)

int setting_index(size_t offset) {
    int index = 0;
    while (index < setting_count - 1 && setting_table[index].offset != offset)
        index++;
    return index;
}

int setting_rival(int index) {
    int integrator = SETTING_INDEX(integrator), style = SETTING_INDEX(style);
    return index == integrator ? style : index == style ? integrator : -1;
}

static const void *field_of(const struct setting *row, const void *base) {
    return (const char *)base + row->offset;
}

uint64_t setting_bits(const struct setting *row, const void *base) {
    const void *at = field_of(row, base);
    uint64_t bits = 0;
    if (row->kind == SETTING_NUMBER) {
        double number;
        memcpy(&number, at, sizeof number);
        number += 0; /* -0 + 0 is 0 */
        memcpy(&bits, &number, sizeof bits);
        return bits;
    }
    /* The sign of an int is extended, so that bits are numbers. */
    if (row->size == sizeof(int)) {
        int whole;
        memcpy(&whole, at, sizeof whole);
        return (uint64_t)(int64_t)whole;
    }
    memcpy(&bits, at, row->size);
    return bits;
}

static int count_words(const char *words) {
    int count = 1;
    for (; *words; words++)
        count += *words == '|';
    return count;
}

double setting_number_of_word(const struct setting *row, const char *word) {
    const char *at = row->words;
    for (int i = 1; at && *at; i++, at += *at == '|') {
        size_t length = strcspn(at, "|");
        if (strlen(word) == length && strncmp(at, word, length) == 0)
            return row->high + i;
        at += length;
    }
    return 0;
}

/* Whether the bits are a value of the row. */
static bool bits_are_valid(const struct setting *row, uint64_t bits) {
    double number = (double)(int64_t)bits;
    switch (row->kind) {
    case SETTING_NUMBER:
        memcpy(&number, &bits, sizeof number);
        if (row->words && row->words[0] && number > row->high && number <= row->high + count_words(row->words))
            return number == floor(number);
        break;
    case SETTING_FLAG:
    case SETTING_CROP:
        return bits <= 1;
    case SETTING_CHOICE:
    case SETTING_DENOISE:
    case SETTING_STATS:
        return bits < (uint64_t)count_words(row->words);
    case SETTING_TONE: /* a function follows the words */
        return bits <= (uint64_t)count_words(row->words);
    case SETTING_SEED:
        return true;
    case SETTING_LAYERS:
        return (bits & UINT32_MAX) <= (uint64_t)row->high;
    case SETTING_WHOLE:
    case SETTING_CAUSTICS:
        OPTION_KINDS(LIST_LABEL)
        break;
    }
    return (number >= row->low && number <= row->high) || (number >= row->initial && number <= row->initial);
}

bool setting_is_valid(const struct setting *row, const void *base) {
    return bits_are_valid(row, setting_bits(row, base));
}

bool setting_set_bits(const struct setting *row, void *base, uint64_t bits) {
    if (!bits_are_valid(row, bits))
        return false;
    if (row->size == sizeof(int)) { /* the low half, wherever it is in the word */
        uint32_t low = (uint32_t)bits;
        memcpy((char *)base + row->offset, &low, sizeof low);
    } else if (row->size == sizeof(bool)) {
        bool is_true = bits != 0;
        memcpy((char *)base + row->offset, &is_true, sizeof is_true);
    } else {
        memcpy((char *)base + row->offset, &bits, sizeof bits);
    }
    return true;
}

void setting_store(const struct setting *row, void *base, double number) {
    uint64_t bits;
    if (row->kind == SETTING_NUMBER)
        memcpy(&bits, &number, sizeof bits);
    else
        bits = row->kind == SETTING_SEED ? (uint64_t)number : (uint64_t)(int64_t)number;
    (void)setting_set_bits(row, base, bits);
}

/* The word of a choice. */
static const char *word_at(const char *words, int index, char out[64]) {
    while (index-- > 0)
        words = strchr(words, '|') + 1;
    (void)snprintf(out, 64, "%.*s", (int)strcspn(words, "|"), words);
    return out;
}

const char *setting_initial_words(const struct setting *row, char out[64]) {
    if (row->initial_words || row->kind == SETTING_FLAG || row->kind == SETTING_LAYERS)
        return row->initial_words;
    if (row->words && row->words[0] && row->kind != SETTING_NUMBER)
        return word_at(row->words, (int)row->initial, out);
    (void)snprintf(out, 64, "%g", row->initial);
    return out;
}

/* What is compared: films are the same for all denoisers. */
static uint64_t compared_bits(const struct setting *row, const void *base) {
    uint64_t bits = setting_bits(row, base);
    return row->kind == SETTING_DENOISE && bits == DENOISER_OIDN ? DENOISER_GRAY : bits;
}

struct digest setting_digest(const struct setting *row, const void *base, struct digest before) {
    uint64_t bits = compared_bits(row, base);
    return digest_bytes(&bits, sizeof bits, before);
}

bool settings_are_valid(const struct settings *settings) {
    bool valid = settings->lens.projection < LIST_COUNT(PROJECTIONS) && settings->lens.stereo < LIST_COUNT(STEREOS);
    for (int i = 0; i < setting_count && valid; i++)
        valid = setting_is_valid(&setting_table[i], settings);
    return valid;
}

/* Whether all settings are equal, or only those of one kind of change. */
static bool rows_equal(const struct settings *a, const struct settings *b, bool all, enum setting_change change) {
    bool equal = true;
    for (int i = 0; i < setting_count && equal; i++)
        equal = !(all || setting_table[i].changes == change) ||
                compared_bits(&setting_table[i], a) == compared_bits(&setting_table[i], b);
    return equal;
}

bool settings_equal(const struct settings *a, const struct settings *b) {
    return rows_equal(a, b, true, CHANGES_RUN);
}

bool settings_finish_equal(const struct settings *a, const struct settings *b) {
    return rows_equal(a, b, false, CHANGES_FINISH);
}
