/* The animation of a run (-o x.gif and its like). Its frames are PNG files in the folder x.gif.frames, each complete
 * or not there, until the last one is written; then they are assembled. So a run that was killed continues with its
 * frames, and shards and ranks can write them. `-o -` with gr.frames is a stream of Y4M frames instead. */
#ifndef GRAY_OUTPUT_ANIMATION_H
#define GRAY_OUTPUT_ANIMATION_H

#include "base/file_output.h"
#include "image/animation.h"
#include "output/picture_files.h"
#include "output/picture_write.h"
#include "session/options.h"

#include <stdbool.h>
#include <stdint.h>

/* Zero value: the pictures of the run are no animation, and every call does nothing. */
struct animation {
    enum animation_format format;
    const struct picture_files *files; /* not owned */
    const char **frames;               /* the files that are there; owned, with their names */
    uint32_t count, room, last;        /* last: number of the newest frame */
    uint32_t width, height;
    double rate;
    bool loops, srgb;
    bool incomplete;           /* other shards make some of the frames */
    bool borrowed;             /* the frames are files of the user */
    struct file_output stream; /* Y4M on standard output, once its first frame is there */
};

void animation_init(struct animation *animation, const struct options *options, const struct picture_files *files);
/* Forgets the frames: they count from the first one again. */
void animation_restart(struct animation *animation);
/* Whether this picture is a frame of the stream on standard output. */
bool animation_streams(const struct animation *animation, const struct picture_request *request);
/* Called for every picture that begins, before it is rendered: whether it can be a frame, and (for the first) whether
 * the file can be written. number: that of picture_files_number. */
bool animation_begin(struct animation *animation, const struct picture_request *request, uint32_t number,
                     struct error *error);
/* The frame is in this file. */
bool animation_add(struct animation *animation, const char *name, struct error *error);
/* The frame of a stream: its rows as they would be in a PNG file. */
bool animation_put(struct animation *animation, const struct picture *picture, struct error *error);
/* The frames are these PNG files, which stay. */
bool animation_take_files(struct animation *animation, const char *const *names, uint32_t count, struct error *error);
/* All frames are there: writes the file, the contact sheet, and removes the frames unless they are to stay. */
bool animation_finish(struct animation *animation, struct error *error);
/* Frees it. *left: the number of frames that stay in the folder of an animation that was not written. */
void animation_destroy(struct animation *animation, uint32_t *left);

#endif
