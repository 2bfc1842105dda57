/* Shared by the files of the command line: a row of the table of options, and its names. */
#ifndef GRAY_SESSION_OPTIONS_INTERNAL_H
#define GRAY_SESSION_OPTIONS_INTERNAL_H

#include "session/options.h"

enum option_kind {
    OPTION_FLAG,    /* bool, set to true; takes no value */
    OPTION_INTEGER, /* int in low..high */
    OPTION_NUMBER,  /* double in low..high */
    OPTION_BYTES,   /* uint64_t in low..high: a size with its unit, in MiB without one */
    OPTION_CHOICE,  /* enum or bool: the position of the word in `value`, words separated by '|' */
    OPTION_TONE,    /* --tone: as OPTION_CHOICE */
    OPTION_TEXT,    /* const char *, not empty */
    OPTION_ACTION,  /* options.action; `low` is the action */
    OPTION_SIZE,    /* --size */
    OPTION_CROP,    /* --crop */
    OPTION_PIXEL,   /* --pixel */
    OPTION_SEED,    /* --seed */
    OPTION_DEFINE,  /* -D */
    OPTION_FOLDER,  /* --allow-read, --allow-write: `low` selects one */
    OPTION_SHARD,   /* I/N: two uint32_t from the field on */
    OPTION_FRAMES,  /* --frames: a struct frame_selection */
    OPTION_LAYERS,  /* --aov */
    OPTION_STATS,   /* --stats, --stats=text, --stats=json */
    OPTION_DENOISE, /* --denoise, --denoise=gray, --denoise=oidn, --denoise=none */
};

enum option_group {
    OPTION_GROUP_PICTURE,
    OPTION_GROUP_SHADING,
    OPTION_GROUP_FINISH,
    OPTION_GROUP_FILES,
    OPTION_GROUP_FRAMES,
    OPTION_GROUP_COMPATIBILITY,
    OPTION_GROUP_SANDBOX,
    OPTION_GROUP_RUN,
    OPTION_GROUP_PARTS,
    OPTION_GROUP_REPORTS,
    OPTION_GROUP_COUNT
};

struct option {
    enum option_group group;
    const char *names; /* separated by '|'; the first one is displayed, with its dashes */
    enum option_kind kind;
    const char *value; /* the name of the value, or its choices; NULL for none */
    double low, high;
    size_t offset, size;
    const char *initial; /* the default in words, or NULL */
    const char *help;
};

extern const char *const option_group_titles[OPTION_GROUP_COUNT];
extern const struct option option_table[];
extern const int option_count;

struct piece {
    const char *text;
    size_t length;
};

/* Whether a name has more than one number: output_name replaces the first. */
bool output_name_numbered_twice(const char *pattern);
/* The next piece of a text separated by '|'; *rest moves to the end of it. Empty at the end. */
struct piece option_next_piece(const char **rest);

/* Checks the options together, and sets those that others imply. */
bool options_check(struct options *options, struct error *error);

#endif
