/* What the files of the command line share: a row of the table of options, and names in it. */
#ifndef GRAY_SESSION_OPTIONS_INTERNAL_H
#define GRAY_SESSION_OPTIONS_INTERNAL_H

#include "session/options.h"

enum option_kind {
    OPTION_FLAG,    /* bool, set to true; takes no value */
    OPTION_INTEGER, /* int in low..high */
    OPTION_NUMBER,  /* double in low..high */
    OPTION_BYTES,   /* uint64_t in low..high: a size with its unit, in MiB without one */
    OPTION_CHOICE,  /* enum or bool: the position of the word in `value`, words separated by '|' */
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
    OPTION_DENOISE, /* --denoise, --denoise=gray, --denoise=oidn */
};

enum option_group {
    OPTION_GROUP_PICTURE,
    OPTION_GROUP_SHADING,
    OPTION_GROUP_FILES,
    OPTION_GROUP_COMPATIBILITY,
    OPTION_GROUP_SANDBOX,
    OPTION_GROUP_RUN,
    OPTION_GROUP_PARTS,
    OPTION_GROUP_REPORTS,
    OPTION_GROUP_COUNT
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

extern const char *const option_group_titles[OPTION_GROUP_COUNT];
extern const struct option option_table[];
extern const int option_count;

struct piece {
    const char *text;
    size_t length;
};
/* The next piece of a text separated by '|'; *rest moves behind it. Empty at the end. */
struct piece option_next_piece(const char **rest);

/* What can only be said of the options together; fills in what one of them says of another. */
bool options_check(struct options *options, struct error *error);

#endif
