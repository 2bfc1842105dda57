/* The files of pictures: the name of a picture from a scene or -o, the names of its further files, and whether they can
 * be written, decided before rendering. docs/security.md has the rules as a table. */
#ifndef GRAY_OUTPUT_PICTURE_FILES_H
#define GRAY_OUTPUT_PICTURE_FILES_H

#include "base/file_output.h"
#include "base/path_policy.h"
#include "session/options.h"

#include <stdbool.h>
#include <stdint.h>

enum { NAME_LIMIT = 4096 };

/* One for each run. picture_files_destroy releases its memory. */
struct picture_files {
    const struct options *options; /* not owned */
    struct path_policy folders; /* the folders where scripts may write pictures: the working directory, --allow-write */
    struct error folders_error; /* why some are missing */
    struct file_guard guard;
    struct file_interrupt interrupt; /* descriptor -1: none */
    struct file_quota quota;         /* --picture-bytes: of all files of pictures */
    struct file_rules picture;       /* the picture itself */
    struct file_rules beside;        /* layers, -write-*: as the picture, but never written in place */
    struct file_rules partial;       /* an unfinished picture: replaces only such pictures */
    struct file_rules animation;     /* an animation, such as -o x.gif */
    struct file_rules part;          /* --shard */
    struct file_rules checkpoint;    /* --checkpoint auto */
    struct file_rules named_checkpoint;
    struct file_rules solution; /* of radiosity */
    struct file_rules model;    /* a model of a script; of -o: user_model */
    struct file_rules user_model;
    struct file_rules saved; /* views and edits saved from the window: never replace a file */
    bool ending_noticed;
};

void picture_files_init(struct picture_files *files, const struct options *options);
void picture_files_destroy(struct picture_files *files);
/* A file that this run reads or uses for another purpose is never replaced, unless it is a picture of this run.
 * written: a script has opened it for writing, so it is no such picture any more. */
void picture_files_keep(struct picture_files *files, struct file_identity identity, bool written);
/* A picture that an earlier run wrote and this one does not change: treated as written by this run. */
void picture_files_own(struct picture_files *files, const char *name);
/* Whether this run wrote the file before as a picture. */
bool picture_files_is_own(const struct picture_files *files, const char *name);

/* The names of a picture: the name in the script, and its number in -o, from 1; for a frame also the number in its
 * animation, else 0. */
struct picture_label {
    const char *from_script;
    unsigned number;
    unsigned frame;
};
/* Before the run: false with an error if -o FILE has the ending of a format that gray does not write. */
bool picture_files_check_output(const struct options *options, struct error *error);
/* Its name. notice: a line to report, or empty. */
bool picture_files_name(struct picture_files *files, const struct picture_label *label, char name[NAME_LIMIT],
                        char notice[NAME_LIMIT + 128], struct error *error);
/* Puts the number of a frame into a name of a script: for %d or ####, else before the extension. */
bool picture_files_number_frame(unsigned number, char name[NAME_LIMIT], struct error *error);
/* The folder for the frames of an animation, and its contact sheet. */
bool animation_folder(const char *animation, char out[NAME_LIMIT]);
bool animation_sheet_name(const char *animation, char out[NAME_LIMIT], struct error *error);
/* The name of its main file: the picture, or with --shard its part. */
bool picture_files_written(const struct picture_files *files, const char *name, char out[NAME_LIMIT],
                           struct error *error);
/* dir/foo.partial.png of dir/foo.exr or of a frame of the animation dir/foo.gif. False: there is none, since the
 * picture is no file. */
bool picture_files_partial(const struct picture_files *files, const char *name, char out[NAME_LIMIT]);
/* Removes that file, if it is an unfinished picture. */
void picture_files_remove_partial(const struct picture_files *files, const char *name);
/* dir/foo.png with prefix X is dir/Xfoo.png. */
bool picture_files_prefixed(const char *name, const char *prefix, char out[NAME_LIMIT], struct error *error);
/* The name of the checkpoint; with --checkpoint auto it is that of the first picture. */
bool picture_files_checkpoint(const struct picture_files *files, const char *name, char out[NAME_LIMIT],
                              struct error *error);
/* That of the solution of radiosity: of --radiosity-file, or beside the first picture or the animation. */
bool picture_files_solution(const struct picture_files *files, const char *name, char out[NAME_LIMIT],
                            struct error *error);
/* Whether every file of the picture can be written: see file_output_check. layers: a mask of enum aov. checkpoint: its
 * name, or NULL; it is checked when check_checkpoint is set. */
bool picture_files_check(struct picture_files *files, const char *name, uint32_t layers, const char *checkpoint,
                         bool check_checkpoint, struct error *error);

#endif
