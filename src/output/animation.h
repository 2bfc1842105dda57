/* The animation of a run (for instance -o x.gif). Until the last frame is written, its frames are PNG files in the
 * folder x.gif.frames, each of them complete. Then they are assembled. So a run that was killed continues with its
 * frames, and shards and ranks can write frames. `-o -` with gr.frames is a stream of Y4M frames instead. */
#ifndef GRAY_OUTPUT_ANIMATION_H
#define GRAY_OUTPUT_ANIMATION_H

#include "base/file_output.h"
#include "image/animation.h"
#include "output/picture_files.h"
#include "output/picture_write.h"
#include "session/options.h"

#include <stdbool.h>
#include <stdint.h>

/* Zero value: the pictures of the run are not an animation, and every call does nothing. */
struct animation {
    enum animation_format format;
    const struct picture_files *files; /* not owned */
    const char **frames;               /* the files that exist; owned, with their names */
    uint32_t count, room, last;        /* last: number of the newest frame */
    uint32_t width, height;
    double rate;
    bool loops, srgb;
    bool incomplete;           /* other shards render some of the frames */
    bool borrowed;             /* the frames are files of the user */
    struct file_lock lock;     /* on the folder of the frames */
    struct file_output stream; /* Y4M on standard output, once its first frame is there */
};

void animation_init(struct animation *animation, const struct options *options, const struct picture_files *files);
/* Forgets the frames; their numbers start at the first one again. */
void animation_restart(struct animation *animation);
/* Whether this picture is a frame of the stream on standard output. */
bool animation_streams(const struct animation *animation, const struct picture_request *request);
/* Called for every picture before it is rendered. Errors: it cannot be a frame, or (for the first picture) the file
 * cannot be written. number: that of picture_files_number. */
bool animation_begin(struct animation *animation, const struct picture_request *request, uint32_t number,
                     struct error *error);
/* Before the first frame is written: false if another run writes into the folder. Shards share it. */
bool animation_lock(struct animation *animation, struct error *error);
/* Records that the frame is in this file. */
bool animation_add(struct animation *animation, const char *name, struct error *error);
/* Writes a frame of the stream; its rows are those of a PNG file. */
bool animation_put(struct animation *animation, const struct picture *picture, struct error *error);
/* Uses these PNG files as the frames; they are not removed. */
bool animation_take_files(struct animation *animation, const char *const *names, uint32_t count, struct error *error);
/* Writes the file of -o from these frames. */
bool animation_write(const struct picture_files *files, const struct animation_source *source, struct error *error);
/* When all frames exist: writes the file and the contact sheet, and removes the frames unless they are to be kept. */
bool animation_finish(struct animation *animation, struct error *error);
/* Frees it. *left: the number of frames that remain in the folder of an animation that was not written. */
void animation_destroy(struct animation *animation, uint32_t *left);

#endif
