/* The command line. One table describes every option: it parses, it checks ranges, it prints the help, and it suggests
 * the nearest name for a misspelt one. */
#ifndef GRAY_SESSION_OPTIONS_H
#define GRAY_SESSION_OPTIONS_H

#include "base/arena.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/list.h"
#include "settings/script_options.h"
#include "settings/settings.h"

#include <stdbool.h>
#include <stdio.h>

enum options_action {
    ACTION_RENDER,
    ACTION_MERGE /* the arguments are parts of pictures */,
    ACTION_COMPARE /* two pictures */,
    ACTION_VIEW /* a light field or a panorama */,
    ACTION_HELP,
    ACTION_VERSION,
    ACTION_ANNOTATIONS,
    ACTION_SCHEMA,
    /* The words after these are no scripts but a topic, a page, a folder, a command line. */
    ACTION_MANUAL,
    ACTION_ROFF,
    ACTION_INIT,
    ACTION_COMPLETE
};
#define PROGRESS_MODES(X)                                                                                              \
    X(PROGRESS_AUTO, "auto")                                                                                           \
    X(PROGRESS_BAR, "bar")                                                                                             \
    X(PROGRESS_LINES, "lines")                                                                                         \
    X(PROGRESS_JSON, "json")                                                                                           \
    X(PROGRESS_NONE, "none")
enum progress_mode { PROGRESS_MODES(LIST_MEMBER) };
enum statistics_mode { STATISTICS_NONE, STATISTICS_TEXT, STATISTICS_JSON };

#define TERMINAL_GRAPHICS(X)                                                                                           \
    X(TERMINAL_AUTO, "auto")                                                                                           \
    X(TERMINAL_KITTY, "kitty")                                                                                         \
    X(TERMINAL_SIXEL, "sixel")                                                                                         \
    X(TERMINAL_BLOCKS, "blocks")
enum terminal_graphics { TERMINAL_GRAPHICS(LIST_MEMBER) };
enum display_kind { DISPLAY_NONE, DISPLAY_TEV, DISPLAY_TERMINAL };
struct display_choice {
    enum display_kind kind;
    char host[256], port[8];
    enum terminal_graphics graphics;
};

/* Formats of animations by the extension of -o; none: every picture is a file. */
#define ANIMATION_FORMATS(X)                                                                                           \
    X(ANIMATION_NONE, "")                                                                                              \
    X(ANIMATION_APNG, ".apng")                                                                                         \
    X(ANIMATION_GIF, ".gif")                                                                                           \
    X(ANIMATION_WEBP, ".webp")                                                                                         \
    X(ANIMATION_Y4M, ".y4m")                                                                                           \
    X(ANIMATION_MP4, ".mp4")                                                                                           \
    X(ANIMATION_WEBM, ".webm")
enum animation_format { ANIMATION_FORMATS(LIST_MEMBER) };

/* Texts point into argv or into the arena given to options_parse. */
struct options {
    enum options_action action;
    struct settings settings;
    struct script_options script; /* library_folder is filled in by main */
    const char *const *scripts;   /* or the words after ACTION_MANUAL and the like */
    int script_count;
    const char *output;              /* -o, or NULL: the names that the scripts choose */
    enum animation_format animation; /* of `output` */
    const char *model;               /* -o with the ending of a model, or NULL */
    const char *bake;                /* --bake, or NULL */
    const char *other_model;         /* the same, given before that one */
    double tolerance;                /* --tolerance, of models; 0: a thousandth of their size */
    int unit;                        /* --unit: an enum model_unit */
    const char *node;                /* --node: the part of the scene that is the model, or NULL */
    int picture;                     /* --picture: the number of the picture whose scene is the model, or 0 */
    bool check_print;                /* --check-print */
    bool to_json, to_lua;            /* --to-json, --to-lua, or -o with such an ending: scenes are written as text */
    bool keep_frames;                /* --keep-frames: the frames of an animation stay beside it */
    bool contact_sheet;              /* --contact-sheet */
    bool frame_palettes;             /* --palette frame: GIF files have a palette for each frame */
    double threshold;                /* --threshold, of gray compare */
    const char *eyes;                /* --eye, of gray view as the next ones, or NULL */
    const char *directions;          /* --direction, or NULL */
    double focus, aperture, fov;     /* --focus, --aperture, --fov; 0: not given */
    bool force;                      /* --force: -o may replace a file that is no picture */
    int width, height;               /* --size, or 0: the sizes that the scripts choose */
    const char *targets_prefix;      /* -write-aa-targets, or NULL */
    const char *first_pass_prefix;   /* -write-pre-aa, or NULL */
    int threads;                     /* 0: one per processor */
    int picture_count;               /* limits on the pictures of a run; 0: 100,000 and 64 GiB, */
    uint64_t picture_bytes;          /* without the sandbox none */
    bool window;                     /* -gui */
    bool quick, preview;             /* enum draft_level; preview also reduces the size to a quarter */
    bool watch;                      /* --watch */
    bool check, quiet, verbose, no_fork;
    const uint32_t (*pixels)[2]; /* --pixel: {x, y}; these are traced instead of rendering */
    uint32_t pixel_count;
    bool dump_scene;            /* --dump-scene: the world is listed instead of rendering */
    bool dump_expr;             /* --dump-expr: so are the recorded functions */
    bool json;                  /* all three: as JSON */
    const char *checkpoint;     /* --checkpoint: a file, or "auto", or NULL */
    const char *radiosity_file; /* --radiosity-file: a file, or "auto", or NULL */
    bool checkpoint_implied;    /* by an animation: a file of an earlier run is replaced */
    double checkpoint_every;    /* seconds */
    bool mpi;                   /* one of several processes that make a picture together */
    double farm_stall;   /* seconds after which a render process of a farm that does not respond is killed; 0: never */
    double farm_silence; /* seconds without a message after which a rank is regarded as lost; 0: never */
    const char *display; /* --display, or NULL */
    bool partial;        /* --partial: an interrupted picture is written beside the complete one */
    /* What follows from them: what an interruption leaves. */
    bool keeps_picture;     /* an unfinished picture */
    bool keeps_tiles;       /* without --checkpoint: after a minute the checkpoint */
    bool resume;            /* continue from the checkpoint */
    uint32_t shard, shards; /* --shard: the number of this shard, from 1, and the number of shards; 0 of 0: no shards */
    uint32_t shard_of_pictures; /* --shard-pictures: the same over whole pictures */
    uint32_t shards_of_pictures;
    int isa;    /* --isa: an index into options_isa_name */
    int device; /* --device: an enum device */
    enum progress_mode progress;
    enum statistics_mode statistics;
};

struct setting;
/* The words of actions that stand in place of a scene, merge and compare; NULL after the last one. */
const char *options_action_word(int index);
/* The option that a word of a command line begins with, with or without its dashes, or NULL. */
const struct setting *option_named(const char *word);
/* False: error is ERROR_USAGE (or no memory) and its text names the option. */
bool options_parse(struct options *options, int argc, char *const *argv, struct arena *arena, struct error *error);
/* A hash of all options that can change a picture, or the number of pictures; names of written files, threads,
 * acceleration structures and verbosity are not part of it. */
struct digest options_digest(const struct options *options);
/* Whether a solution of radiosity is kept in a file: by --radiosity-file, and beside a checkpoint that is requested.
 * Windows have none, and ranks of a farm solve on their own. */
bool options_keep_solution(const struct options *options);
/* Whether the value of --checkpoint or --radiosity-file is the name of a file. */
bool options_are_named(const char *file);
/* How many pictures the scripts of a run may render, and whether they may render one of this number, counted from 1. */
uint32_t options_picture_limit(const struct options *options);
bool options_allow_picture(const struct options *options, uint64_t number, struct error *error);
/* How many bytes may be written into files of pictures; UINT64_MAX: any number. */
uint64_t options_picture_bytes(const struct options *options);
/* Who makes the samples of paths; pictures do not depend on it. */
#define DEVICES(X) X(DEVICE_CPU, "cpu") X(DEVICE_GPU, "gpu") X(DEVICE_AUTO, "auto") X(DEVICE_EMULATE, "emulate")
enum device { DEVICES(LIST_MEMBER) };
/* What cpu_select_isa understands. */
const char *options_isa_name(const struct options *options);
/* The name of picture `number` under -o: %d, %3d or %03d is the number, and so are two # or more, which are its digits;
 * %% is a percent sign. */
bool output_name_numbered(const char *pattern);
bool output_name(const char *pattern, unsigned number, char *out, size_t size);

/* -o -: the picture is written to standard output. */
bool options_output_is_stream(const struct options *options);

#endif
