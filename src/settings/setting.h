/* A row that describes one value of a struct by its place: a setting (settings.h) or another option of the command line
 * (session/options_table.c). Everything that treats all settings alike is a loop over such rows. */
#ifndef GRAY_SETTINGS_SETTING_H
#define GRAY_SETTINGS_SETTING_H

#include "base/hash.h"
#include "settings/settings.h"

/* The kinds of values. Those of settings are one number each (setting_bits); the others are read by the command line
 * only. */
enum setting_kind {
    SETTING_FLAG,     /* bool; the option may have =yes or =no */
    SETTING_WHOLE,    /* int in low..high */
    SETTING_NUMBER,   /* double in low..high; each of its words is the next number above, in steps of 1 */
    SETTING_CHOICE,   /* an enum or a bool: the position of the word */
    SETTING_SEED,     /* uint64_t, in a script up to `high` */
    SETTING_LAYERS,   /* uint32_t: a mask of layers */
    SETTING_TONE,     /* as CHOICE; in a script also a function */
    SETTING_DENOISE,  /* as CHOICE; the option may lack its word, and a script has a boolean */
    SETTING_CAUSTICS, /* as WHOLE; in a script also the radius */
    SETTING_CROP,     /* a flag, and the numbers of the rectangle */
    SETTING_STATS,    /* as CHOICE; the option may lack its word */
    SETTING_BYTES,    /* uint64_t in low..high: a size with its unit, in MiB without one */
    SETTING_TEXT,     /* const char *, not empty */
    SETTING_SIZE,     /* two ints */
    SETTING_SHARD,    /* two uint32_t: I/N */
    SETTING_FRAMES,   /* a struct frame_selection */
    SETTING_ACTION,   /* an int: `low` */
    SETTING_PIXEL,    /* may be repeated, as the next three */
    SETTING_DEFINE,
    SETTING_DEFAULT,
    SETTING_FOLDER, /* `low` selects one of two lists */
};

/* The kinds that no setting has. */
#define OPTION_KINDS(X)                                                                                                \
    X(SETTING_BYTES)                                                                                                   \
    X(SETTING_TEXT)                                                                                                    \
    X(SETTING_SIZE)                                                                                                    \
    X(SETTING_SHARD)                                                                                                   \
    X(SETTING_FRAMES)                                                                                                  \
    X(SETTING_ACTION)                                                                                                  \
    X(SETTING_PIXEL)                                                                                                   \
    X(SETTING_DEFINE)                                                                                                  \
    X(SETTING_DEFAULT)                                                                                                 \
    X(SETTING_FOLDER)

struct setting {
    enum setting_kind kind;
    enum setting_change changes;
    enum option_group group;
    const char *option; /* its spellings, separated by '|', the first one with its dashes; NULL: no option */
    const char *value;  /* the name of its value in the help; of a choice that may lack it, the word it then is */
    const char *words;  /* of a choice, separated by '|' */
    const char *field;  /* of gr.render; NULL: none */
    size_t offset, size;
    double initial, low, high;
    const char *initial_words; /* the default in words; NULL: made from `initial` */
    const char *help;          /* sentences */
    enum setting_effect effect;
};

/* The rows of struct settings; those with a field come first. */
extern const struct setting setting_table[];
extern const int setting_count, setting_field_count;

/* The index of the row of a member. */
#define SETTING_INDEX(member) setting_index(offsetof(struct settings, member))
int setting_index(size_t offset);
/* The index of the setting that this one may exclude (settings_exclude), or -1. */
int setting_rival(int index);

/* The value of a scalar row in the struct at `base` as 64 bits: of doubles their bits, else the number. -0 is 0. */
uint64_t setting_bits(const struct setting *row, const void *base);
/* False: the bits are no value of the row; then nothing is stored. */
bool setting_set_bits(const struct setting *row, void *base, uint64_t bits);
/* Whether the bytes are a value of the row: in its range, or its default. Any bytes may be there. */
bool setting_is_valid(const struct setting *row, const void *base);
/* Stores a number of the row's range. */
void setting_store(const struct setting *row, void *base, double number);
/* The number of a word of a NUMBER, or 0. */
double setting_number_of_word(const struct setting *row, const char *word);
/* The default in words: that of the row, or made of its default. */
const char *setting_initial_words(const struct setting *row, char out[64]);
/* Adds the value to a digest. The denoisers count as one here and where settings are compared: their films are the
 * same. */
struct digest setting_digest(const struct setting *row, const void *base, struct digest before);

/* All settings of a picture, but the lens, the shutter, the motion of the camera and the table of the tone curve. */
bool settings_are_valid(const struct settings *settings); /* the bytes may be any */
bool settings_equal(const struct settings *a, const struct settings *b);
/* The settings that change the finished picture. */
bool settings_finish_equal(const struct settings *a, const struct settings *b);

#endif
