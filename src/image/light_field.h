/* Light fields: pictures from a grid of cameras on a plane, all with one direction of view, and the file of them
 * (docs/light-fields.md). All cameras see the same rectangle at the distance `screen`. A picture of one camera is a
 * light field of one view. */
#ifndef GRAY_IMAGE_LIGHT_FIELD_H
#define GRAY_IMAGE_LIGHT_FIELD_H

#include "base/error.h"
#include "base/file.h"
#include "base/file_output.h"
#include "base/pool.h"
#include "image/picture_file.h"
#include "image/tone.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Of pictures without a camera, such as layers; degrees. */
enum { LIGHT_FIELD_FOV = 50 };
/* A writer has one of its own; the file has all of it. */
struct light_field_head {
    uint32_t columns, rows, width, height; /* of the grid, and of a view in pixels */
    bool depth;                            /* pixels have the depth of their surface along the view; 0: none */
    double spacing;                        /* between neighbouring cameras */
    double screen;                         /* distance */
    double fov;                            /* full vertical angle of a view, degrees */
    struct tone tone;                      /* of PNG files; its table is borrowed */
};

/* Writes the rows of a picture that shows the views of source->field as a grid (with depth: below it the grid of
 * depths), or one view without a head. With a pool, its threads compress. */
bool light_field_write(const struct file_target *target, const struct picture_source *source, struct pool *pool,
                       struct error *error);

/* Where a view lies in the file; once it is loaded, the reciprocals of its smallest and of its largest depth. */
struct light_field_entry {
    uint64_t at, size;
    double nearest, farthest;
};
/* A file that is open: its head and table are checked; views are read when they are needed. Zero value: closed. */
struct light_field {
    const char *path; /* borrowed */
    struct light_field_head head;
    struct tone_table table;           /* of head.tone */
    struct light_field_entry *entries; /* row by row, the upper left view first */
    float **views;                     /* NULL until they are loaded */
    struct file_source source;
};
/* Whether a file begins so. */
bool light_field_is(const uint8_t *head, size_t size);
/* Errors name the path, which must stay. */
bool light_field_open(struct light_field *field, const char *path, struct error *error);
void light_field_close(struct light_field *field);
/* Reads the views of a part of the grid that are not there yet: LIGHT_FIELD_NUMBERS for each pixel, red, green, blue
 * and the reciprocal of the depth (0: nothing is there), rows from the top. Errors: the file is damaged, no memory,
 * cancelled. */
enum { LIGHT_FIELD_NUMBERS = 4 };
struct light_field_part {
    uint32_t column, row, columns, rows;
};
bool light_field_load_part(struct light_field *field, const struct light_field_part *part, struct pool *pool,
                           struct error *error);

#endif
