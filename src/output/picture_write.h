/* A picture from its beginning until it is written or given up, and its way from the film into files. */
#ifndef GRAY_OUTPUT_PICTURE_WRITE_H
#define GRAY_OUTPUT_PICTURE_WRITE_H

#include "base/pool.h"
#include "base/share.h"
#include "output/picture_files.h"
#include "render/film.h"
#include "render/tile_file.h"
#include "session/messages.h"

#include <stdbool.h>

/* The film is owned. */
struct picture {
    bool open;
    char name[NAME_LIMIT];
    struct picture_request request;
    bool written;              /* before it is complete: what a window shows */
    struct tile_picture tiles; /* how its tiles are kept */
    struct share memory;
    struct film film;
};

struct tone picture_tone(const struct picture_request *request);
/* Upper and lower case are the same. */
bool picture_name_ends_in(const char *name, const char *extension);

/* One file. The extension of the target says the format; whatever is not .pfm, .hdr or .exr is PNG. Tone is for PNG
 * alone: the others hold light. pool: or NULL, for this thread alone. */
bool picture_write_view(const struct picture *picture, const struct file_target *target, enum film_view view,
                        struct pool *pool, struct error *error);
/* All files of the picture under that name, denoised if its film has features and the options do not forbid it: itself,
 * its layers, those of -write-...; with --shard the part. */
bool picture_write_files(const struct picture_files *files, const struct picture *picture, const char *name,
                         struct error *error);
/* Seconds of one core that packing some finished tiles takes; *pixels: of them. Negative: it could not be measured. */
double picture_packing_time(const struct picture *picture, uint32_t *pixels);

#endif
