/* The film: one picture in memory that supervisor and child share. The child's workers write pixels, the supervisor
 * reads whole tiles. Colours are linear floats, nothing is clamped. */
#ifndef GRAY_FILM_FILM_H
#define GRAY_FILM_FILM_H

#include "base/error.h"
#include "image/tone.h"
#include "settings/settings.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The side of a tile in pixels; bench/growth.sh measures others. */
#ifndef GRAY_TILE
#define GRAY_TILE 32
#endif
enum { FILM_TILE = GRAY_TILE, FILM_MARK_WAITS = 2 };

/* Header at the start of the shared block; arrays follow. Width and height are those of the part that is rendered (the
 * crop), x0, y0 its place in the whole picture. */
struct film_pixel {
    float rgb[3]; /* final, or as far as it is */
};

/* The additional record of a pixel: the integrator of the picture defines it (render_record). */
struct film_record {
    uint32_t floats; /* at most FILM_RECORD_FLOATS, all finite; the integrator defines their meaning */
    uint32_t marks;  /* 1: pixels may be marked, and those that are not repeat their colour in the first three floats */
};
enum { FILM_RECORD_FLOATS = 99 };

struct film {
    uint32_t width, height;
    uint32_t x0, y0, full_width, full_height;
    struct film_record record;
    struct film_pixel *pixels; /* width * height, row-major, top row first */
    float *floats;             /* record.floats of each pixel; Whitted: the first pass, one sample */
    uint8_t *marked;           /* 1 = resampled; FILM_MARK_WAITS while it is to be; NULL without marks */
    _Atomic uint8_t *tiles;    /* an enum film_tile each; set after the pixels of the tile */
    /* Render layers (render/aov.h): the layers of the mask one after the other, width * height each; NULL
     * without any. Filled after the tiles are done. */
    uint32_t layer_mask;
    float (*layers)[3];
};

/* The state of a tile. Tiles are aligned to the grid of the whole picture, so that a crop has the same tiles. */
enum film_tile {
    FILM_TILE_WANTED,
    FILM_TILE_DONE,
    FILM_TILE_ELSEWHERE, /* another shard's, or passed on */
    FILM_TILE_LATER,     /* in a farm: not handed out yet */
    FILM_TILE_TAKEN,     /* in progress, here or, in a farm, elsewhere */
    /* With the number of a check added (--noise): the pixels have the samples of that check, until the state
     * changes. */
    FILM_TILE_BEGUN = 0x40,
    /* With the number of the pass added: some samples are in the pixels, more will come. */
    FILM_TILE_PASSED = 0x80
};
enum { FILM_CHECKS = 0x40, FILM_PASSES = 0x80 }; /* numbers of checks and passes, which begin again then */

/* Whether a tile in that state has samples that can be kept, and gets more. */
static inline bool film_tile_is_begun(uint8_t state) {
    return state >= FILM_TILE_BEGUN && state < FILM_TILE_PASSED;
}
/* Whether a tile in that state is visible. */
static inline bool film_tile_shows(uint8_t state) {
    return state == FILM_TILE_DONE || state >= FILM_TILE_BEGUN;
}

/* Rectangle of pixels of the whole picture: x0 <= x < x1. */
struct film_rectangle {
    uint32_t x0, y0, x1, y1;
};
/* With a rim of so many pixels, as far as that is in a picture of this size. */
struct film_rectangle film_rectangle_grown(const struct film_rectangle *r, uint32_t rim, uint32_t width,
                                           uint32_t height);

static inline bool film_record_equal(struct film_record a, struct film_record b) {
    return a.floats == b.floats && a.marks == b.marks;
}
/* Whether such a record is valid. */
static inline bool film_record_valid(struct film_record record) {
    return record.floats <= FILM_RECORD_FLOATS && record.marks <= 1;
}
/* Bytes of a pixel: colour, floats and mark. */
static inline size_t film_record_size(struct film_record record) {
    return sizeof(struct film_pixel) + record.floats * sizeof(float) + record.marks;
}

/* Bytes for the arrays of a film; false if the numbers are too large (over 2^31 pixels). The record is valid. */
bool film_size(uint32_t width, uint32_t height, struct film_record record, size_t *bytes, struct error *error);
/* Lays the arrays into a zeroed block of film_size bytes: all colours, all floats, all marks, the tiles. */
void film_layout(struct film *film, void *block, uint32_t width, uint32_t height, struct film_record record);

/* The same with `layers` more of three floats a pixel, laid behind by film_layout_layers after film_layout. */
bool film_size_layered(uint32_t width, uint32_t height, struct film_record record, uint32_t layers, size_t *bytes,
                       struct error *error);
void film_layout_layers(struct film *film, void *block, uint32_t mask);

/* The division of the rendered part into tiles, numbered row by row; x0 and y0 must be set. */
uint32_t film_tiles_across(const struct film *film);
uint32_t film_tile_count(const struct film *film);
struct film_rectangle film_tile_rectangle(const struct film *film, uint32_t tile);
/* The number of tiles in that state, and of those that are begun. */
uint32_t film_tiles_in(const struct film *film, enum film_tile state);
uint32_t film_tiles_begun(const struct film *film);
/* Black for invisible tiles. */
void film_clear_unfinished(struct film *film);

/* Whether a final colour is the largest float, i.e. clamped light. */
bool film_holds_largest(const struct film *film);

/* A tile as bytes: with marks a bit for each pixel that is marked; then of each pixel the colour and the floats, of one
 * that is not marked without the first three. At most FILM_PACKED_LIMIT bytes, little-endian. */
enum { FILM_PACKED_LIMIT = FILM_TILE * FILM_TILE * ((3 + FILM_RECORD_FLOATS) * 4) + FILM_TILE * FILM_TILE / 8 };
size_t film_tile_pack(const struct film *film, uint32_t tile, uint8_t *out);
/* Whether the size of the bytes agrees with their own mask, and all colours are finite; only needs the rectangle and
 * the record of the film. */
bool film_tile_fits(const struct film *film, uint32_t tile, const uint8_t *bytes, size_t size);
/* Unpacks it and marks the tile as done; false: not the bytes of such a tile, and nothing changes. */
bool film_tile_unpack(struct film *film, uint32_t tile, const uint8_t *bytes, size_t size);

enum film_view {
    FILM_FINAL,
    FILM_FIRST,
    FILM_TARGETS
}; /* TARGETS: first pass with marked pixels in pure red. Without a first pass
    * (no marks) it is the picture. */
/* 3 * width numbers of row y: tone-mapped to 8 or 16 bits, and as in the film. */
void film_row_toned(const struct film *film, enum film_view view, const struct tone *tone, uint32_t y, uint8_t *line);
void film_row_16(const struct film *film, enum film_view view, const struct tone *tone, uint32_t y, uint16_t *line);
void film_row_linear(const struct film *film, enum film_view view, uint32_t y, float *line);
/* The film as width x height RGB bytes, at most as large: tone-mapped means of the light of its pixels. */
void film_shrink(const struct film *film, const struct tone *tone, uint32_t width, uint32_t height, uint8_t *rgb);

/* The assignment of tiles to machines: each machine computes it alone, with the same result. */

/* cost: of every tile of the film, in any unit. Marks the tiles that belong to other shards (1 <= shard <= shards).
 * False: no memory. The tiles are distributed from the most expensive to the cheapest, alternately forwards and
 * backwards, so the numbers of tiles of two shards differ by at most one, and their costs are nearly equal. Allocates
 * nothing that outlives the call. */
bool shard_choose(const uint64_t *cost, struct film *film, uint32_t shard, uint32_t shards);

/* The order of tiles: the picture does not depend on it, but the view during rendering and the time estimate do. */

/* out[k] is the k-th tile to be made; room for film_tile_count(film). False: no memory. */
bool film_tile_order(const struct film *film, enum tile_order order, uint32_t *out);

#endif
