/* EXR by OpenEXRCore, the C half of OpenEXR. It never sees a file: what it writes is gathered in memory, since it goes
 * back to fill in a table at the front, and what it reads is in memory already. Memory comes from base/mem.h. */
#include "image/exr.h"

#include "base/fault.h"
#include "base/mem.h"
#include "image/levels.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

bool exr_is(const uint8_t *data, size_t size) {
    return size >= 4 && memcmp(data, "\x76\x2f\x31\x01", 4) == 0;
}

#ifndef HAVE_EXR

const char *exr_library(void) {
    return "none";
}

bool exr_can_write(void) {
    return false;
}

static bool no_library(const char *path, struct error *error) {
    return error_set(error, ERROR_SCENE, "%s: EXR pictures need OpenEXR, and this build was made without it", path);
}

bool exr_write(const struct file_target *target, uint32_t width, uint32_t height, float_rows *rows, void *context,
               struct error *error) {
    (void)width, (void)height, (void)rows, (void)context;
    return no_library(target->path, error);
}

bool exr_write_channels(const struct file_target *target, uint32_t width, uint32_t height,
                        const struct exr_channel *channels, uint32_t count, struct error *error) {
    (void)width, (void)height, (void)channels, (void)count;
    return no_library(target->path, error);
}

struct image *image_parse_exr(const char *path, const uint8_t *data, size_t size, struct error *error) {
    (void)data, (void)size;
    no_library(path, error);
    return NULL;
}

#else

#include <openexr.h>

const char *exr_library(void) {
    return "OpenEXR " OPENEXR_VERSION_STRING;
}

bool exr_can_write(void) {
    return true;
}

/* Messages of the library go into `message`, not to standard error. */
struct stream {
    uint8_t *bytes; /* written: grows; read: borrowed */
    size_t size, capacity;
    bool no_memory;
    char message[160];
};

/* The library reports some errors with its own lock held, so its context must not be queried for our data then: that
 * would wait for ever. Hence this one variable, which lives while a picture is written or read. */
static _Thread_local struct stream *to_report;

static void on_error(exr_const_context_t context, exr_result_t code, const char *message) {
    struct stream *stream = to_report;
    (void)context;
    stream->no_memory = stream->no_memory || code == EXR_ERR_OUT_OF_MEMORY;
    (void)snprintf(stream->message, sizeof stream->message, "%s", message);
    for (char *c = stream->message; *c; c++)
        *c = *c == '\n' ? ' ' : *c;
}

static int64_t on_write(exr_const_context_t context, void *data, const void *buffer, uint64_t size, uint64_t offset,
                        exr_stream_error_func_ptr_t report_error) {
    struct stream *stream = data;
    (void)context, (void)report_error;
    uint64_t end = offset + size;
    if (end > stream->capacity) {
        size_t capacity = (size_t)end * 2; /* a picture in memory is smaller than half of the address space */
        uint8_t *bytes = mem_resize(stream->bytes, capacity);
        stream->no_memory = !bytes;
        if (!bytes)
            return -1;
        stream->bytes = bytes;
        stream->capacity = capacity;
    }
    if (offset > stream->size) /* skipped bytes are filled in later */
        memset(stream->bytes + stream->size, 0, (size_t)offset - stream->size);
    memcpy(stream->bytes + offset, buffer, (size_t)size);
    stream->size = end > stream->size ? (size_t)end : stream->size;
    return (int64_t)size;
}

static int64_t on_read(exr_const_context_t context, void *data, void *buffer, uint64_t size, uint64_t offset,
                       exr_stream_error_func_ptr_t report_error) {
    const struct stream *stream = data;
    (void)context, (void)report_error;
    if (offset >= stream->size)
        return 0;
    uint64_t left = stream->size - offset, count = size < left ? size : left;
    memcpy(buffer, stream->bytes + offset, (size_t)count);
    return (int64_t)count;
}

static int64_t on_size(exr_const_context_t context, void *data) {
    (void)context;
    return (int64_t)((const struct stream *)data)->size;
}

static exr_context_initializer_t callbacks(struct stream *stream) {
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.error_handler_fn = on_error;
    init.alloc_fn = mem_alloc;
    init.free_fn = mem_free;
    init.user_data = stream;
    init.read_fn = on_read;
    init.size_fn = on_size;
    init.write_fn = on_write;
    return init;
}

static bool report_error(const char *path, const struct stream *stream, const char *fallback, struct error *error) {
    if (stream->no_memory)
        return error_no_memory(error, path);
    return error_set(error, ERROR_SCENE, "%s: %s", path, stream->message[0] ? stream->message : fallback);
}

/* --- writing --- */

static bool add_channels(exr_context_t context, int part) {
    static const char *const names[3] = {"B", "G", "R"};
    for (int i = 0; i < 3; i++) {
        if (exr_add_channel(context, part, names[i], EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1) !=
            EXR_ERR_SUCCESS)
            return false;
    }
    return true;
}

enum { CHANNEL_RY = 3, CHANNEL_OTHER = 5 };

/* The index of a channel: red, green, blue, the chroma RY and BY, another. Y counts as red. */
static int channel_number(const char *name) {
    static const char *const names[] = {"R", "G", "B", "RY", "BY"};
    for (int i = 0; i < CHANNEL_OTHER; i++) {
        if (strcmp(name, names[i]) == 0)
            return i;
    }
    return strcmp(name, "Y") == 0 ? 0 : CHANNEL_OTHER;
}

/* The source of the values: rows on demand, stored in `lines`, which has room for one chunk; or channels in memory. */
struct source {
    float_rows *rows;
    void *rows_context;
    float *lines;
    const struct exr_channel *channels;
    uint32_t count;
};

static bool add_all_channels(exr_context_t context, int part, const struct source *source) {
    if (source->rows)
        return add_channels(context, part);
    for (uint32_t i = 0; i < source->count; i++)
        if (exr_add_channel(context, part, source->channels[i].name, EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LINEAR, 1, 1) !=
            EXR_ERR_SUCCESS)
            return false;
    return true;
}

/* The library orders channels by name. */
static void set_encoder(exr_coding_channel_info_t *channel, const struct source *source, uint32_t width, uint32_t y) {
    uint32_t stride = 3;
    const float *from = source->lines;
    if (source->rows)
        from += channel_number(channel->channel_name);
    for (uint32_t i = 0; i < source->count; i++) {
        if (strcmp(source->channels[i].name, channel->channel_name) == 0) {
            stride = source->channels[i].stride;
            from = source->channels[i].values + (size_t)y * width * stride;
        }
    }
    channel->user_bytes_per_element = 4;
    channel->user_data_type = EXR_PIXEL_FLOAT;
    channel->user_pixel_stride = (int32_t)stride * 4;
    channel->user_line_stride = (int32_t)(width * stride) * 4;
    channel->encode_from_ptr = (const uint8_t *)from;
}

static bool write_chunks(exr_context_t context, int part, uint32_t width, uint32_t height,
                         const struct source *source) {
    exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
    bool ok = true, begun = false;
    int step = 0;
    (void)exr_get_scanlines_per_chunk(context, part, &step);
    for (uint32_t y = 0; ok && y < height; y += (uint32_t)step) {
        exr_chunk_info_t chunk;
        ok = MAY_FAIL(exr_write_scanline_chunk_info(context, part, (int)y, &chunk)) == EXR_ERR_SUCCESS;
        ok = ok && MAY_FAIL(begun ? exr_encoding_update(context, part, &chunk, &encoder)
                                  : exr_encoding_initialize(context, part, &chunk, &encoder)) == EXR_ERR_SUCCESS;
        for (int32_t i = 0; ok && source->rows && i < chunk.height; i++)
            source->rows(source->rows_context, y + (uint32_t)i, source->lines + (size_t)i * width * 3);
        for (int16_t i = 0; ok && i < encoder.channel_count; i++)
            set_encoder(&encoder.channels[i], source, width, y);
        ok =
            ok && (begun || MAY_FAIL(exr_encoding_choose_default_routines(context, part, &encoder)) == EXR_ERR_SUCCESS);
        begun = true;
        ok = ok && MAY_FAIL(exr_encoding_run(context, part, &encoder)) == EXR_ERR_SUCCESS;
    }
    (void)exr_encoding_destroy(context, &encoder);
    return ok;
}

static bool encode(struct stream *stream, uint32_t width, uint32_t height, const struct source *source) {
    exr_context_initializer_t init = callbacks(stream);
    exr_context_t context;
    int part;
    exr_result_t begun = exr_start_write(&context, "picture", EXR_WRITE_FILE_DIRECTLY, &init);
    bool ok = begun == EXR_ERR_SUCCESS;
    stream->no_memory = begun == EXR_ERR_OUT_OF_MEMORY; /* not reported, since there is no context yet */
    if (ok) {
        ok = exr_add_part(context, "light", EXR_STORAGE_SCANLINE, &part) == EXR_ERR_SUCCESS &&
             exr_initialize_required_attr_simple(context, part, (int32_t)width, (int32_t)height, EXR_COMPRESSION_ZIP) ==
                 EXR_ERR_SUCCESS &&
             add_all_channels(context, part, source) && exr_write_header(context) == EXR_ERR_SUCCESS &&
             write_chunks(context, part, width, height, source);
        exr_result_t finished = exr_finish(&context);
        ok = MAY_FAIL(finished) == EXR_ERR_SUCCESS && ok;
    }
    return ok;
}

static bool write_source(const struct file_target *target, uint32_t width, uint32_t height, const struct source *source,
                         struct error *error) {
    struct stream stream = {0};
    struct file_output output;
    to_report = &stream;
    bool ok = encode(&stream, width, height, source) || report_error(target->path, &stream, "cannot be written", error);
    to_report = NULL;
    if (ok) {
        ok = file_output_open(&output, target, error);
        if (ok && file_output_write(&output, stream.bytes, stream.size, error))
            ok = file_output_commit(&output, error);
        else if (ok)
            file_output_abandon(&output), ok = false;
    }
    mem_free(stream.bytes);
    return ok;
}

bool exr_write(const struct file_target *target, uint32_t width, uint32_t height, float_rows *rows, void *context,
               struct error *error) {
    enum { CHUNK_ROWS = 16 }; /* of zip compression */
    struct source source = {.rows = rows, .rows_context = context};
    source.lines = mem_alloc_zero((size_t)width * 3 * CHUNK_ROWS, sizeof *source.lines);
    if (!source.lines)
        return error_no_memory(error, target->path);
    bool ok = write_source(target, width, height, &source, error);
    mem_free(source.lines);
    return ok;
}

bool exr_write_channels(const struct file_target *target, uint32_t width, uint32_t height,
                        const struct exr_channel *channels, uint32_t count, struct error *error) {
    struct source source = {.channels = channels, .count = count};
    return write_source(target, width, height, &source, error);
}

/* --- reading --- */

static float bounded(float light) {
    return light > FLT_MAX ? FLT_MAX : light > 0 ? light : 0; /* NaN too */
}

/* Floats of a pixel of a chunk. With 1, 3 or 4 the library takes shortcuts that do not know channels to skip. */
enum { CHUNK_FLOATS = 5 };

/* Bits of the channels that were met. */
enum { MET_RGB = 7, MET_CHROMA = 3 << CHANNEL_RY, MET_Y = 1 << CHANNEL_OTHER };

/* A picture while it is read. Positions x, y count from the corner of the data window. */
struct picture {
    exr_context_t context;
    const char *path;
    exr_attr_box2i_t data, display;
    int32_t width, height; /* of the data window */
    struct image *image;   /* of the display window */
    float *chunk;          /* R or Y, G, B */
    int32_t chunk_width, chunk_height;
    float *chroma[2]; /* RY and BY, with one sample for some columns and rows */
    int32_t columns[2], rows[2], chroma_width[2], chroma_height[2];
    exr_decode_pipeline_t decoder;
    bool begun, no_memory;
    unsigned met;
};

static void set_target(exr_coding_channel_info_t *channel, float *target, int32_t floats, int32_t width) {
    channel->user_bytes_per_element = 4;
    channel->user_data_type = EXR_PIXEL_FLOAT;
    channel->user_pixel_stride = floats * 4;
    channel->user_line_stride = width * floats * 4;
    channel->decode_to_ptr = (uint8_t *)target;
}

/* Samples of RY or BY are kept for the whole picture: they are at some of its columns and rows. */
static bool set_chroma(struct picture *p, exr_coding_channel_info_t *channel, int which, int32_t x, int32_t y) {
    int32_t columns = channel->x_samples, rows = channel->y_samples;
    if (!p->chroma[which]) {
        p->columns[which] = columns;
        p->rows[which] = rows;
        p->chroma_width[which] = (p->width + columns - 1) / columns;
        p->chroma_height[which] = (p->height + rows - 1) / rows;
        p->chroma[which] = mem_alloc_zero((size_t)p->chroma_width[which] * (size_t)p->chroma_height[which], 4);
        p->no_memory = !p->chroma[which];
    }
    int32_t column = (x + columns - 1) / columns, row = (y + rows - 1) / rows;
    if (p->no_memory || channel->width > p->chroma_width[which] - column ||
        channel->height > p->chroma_height[which] - row)
        return false;
    size_t at = (size_t)row * (size_t)p->chroma_width[which] + (size_t)column;
    set_target(channel, p->chroma[which] + at, 1, p->chroma_width[which]);
    return true;
}

static bool is_luminance(const exr_coding_channel_info_t *channel) {
    return strcmp(channel->channel_name, "Y") == 0 && channel->x_samples == 1 && channel->y_samples == 1;
}

/* The channels of the picture are decoded; the others are skipped, and so are RY and BY without Y. */
static void set_channels(struct picture *p, const exr_chunk_info_t *chunk, int32_t x, int32_t y) {
    bool has_luminance = false;
    for (int16_t i = 0; i < p->decoder.channel_count; i++)
        has_luminance = has_luminance || is_luminance(&p->decoder.channels[i]);
    for (int16_t i = 0; i < p->decoder.channel_count; i++) {
        exr_coding_channel_info_t *channel = &p->decoder.channels[i];
        int number = channel_number(channel->channel_name);
        bool whole = channel->x_samples == 1 && channel->y_samples == 1, chroma = number >= CHANNEL_RY;
        channel->decode_to_ptr = NULL;
        if (number == CHANNEL_OTHER || (chroma ? !has_luminance : !whole) || channel->x_samples < 1 ||
            channel->y_samples < 1)
            continue;
        if (!chroma)
            set_target(channel, p->chunk + number, CHUNK_FLOATS, chunk->width);
        else if (!set_chroma(p, channel, number - CHANNEL_RY, x, y))
            continue;
        p->met |= is_luminance(channel) ? (unsigned)MET_Y : 1u << number;
    }
}

/* The part of the chunk that the display window shows. */
static void copy_chunk(const struct picture *p, const exr_chunk_info_t *chunk, int32_t x, int32_t y) {
    int64_t left = (int64_t)p->data.min.x - p->display.min.x + x, top = (int64_t)p->data.min.y - p->display.min.y + y;
    const struct image_level *to = &p->image->levels[0];
    for (int32_t row = 0; row < chunk->height; row++) {
        for (int32_t column = 0; column < chunk->width; column++) {
            int64_t at_x = left + column, at_y = top + row;
            if (at_x >= 0 && at_y >= 0 && at_x < to->width && at_y < to->height)
                memcpy((float *)to->texels + ((size_t)at_y * to->width + (size_t)at_x) * 4,
                       p->chunk + ((size_t)row * (size_t)chunk->width + (size_t)column) * CHUNK_FLOATS, 12);
        }
    }
}

static bool decode_chunk(struct picture *p, const exr_chunk_info_t *chunk, int32_t x, int32_t y) {
    exr_decode_pipeline_t *decoder = &p->decoder;
    /* The first chunk is the largest; the library cuts chunks off at the end of the data window. */
    if (!p->chunk) {
        p->chunk_width = chunk->width;
        p->chunk_height = chunk->height;
        p->chunk = mem_alloc_zero((size_t)chunk->width * (size_t)chunk->height, CHUNK_FLOATS * 4);
        p->no_memory = !p->chunk;
    }
    assert(chunk->width <= p->chunk_width && chunk->height <= p->chunk_height);
    bool ok =
        p->chunk && MAY_FAIL(p->begun ? exr_decoding_update(p->context, 0, chunk, decoder)
                                      : exr_decoding_initialize(p->context, 0, chunk, decoder)) == EXR_ERR_SUCCESS;
    if (ok)
        set_channels(p, chunk, x, y);
    ok = ok && !p->no_memory;
    ok = ok && (p->begun || MAY_FAIL(exr_decoding_choose_default_routines(p->context, 0, decoder)) == EXR_ERR_SUCCESS);
    p->begun = true;
    ok = ok && exr_decoding_run(p->context, 0, decoder) == EXR_ERR_SUCCESS;
    if (ok)
        copy_chunk(p, chunk, x, y);
    return ok;
}

static bool decode_lines(struct picture *p) {
    int32_t step = 0;
    bool ok = MAY_FAIL(exr_get_scanlines_per_chunk(p->context, 0, &step)) == EXR_ERR_SUCCESS;
    assert(!ok || step > 0); /* 1 to 256, depending on the compression */
    for (int32_t y = 0; ok && y < p->height; y += step) {
        exr_chunk_info_t chunk;
        ok = exr_read_scanline_chunk_info(p->context, 0, p->data.min.y + y, &chunk) == EXR_ERR_SUCCESS &&
             decode_chunk(p, &chunk, 0, y);
    }
    return ok;
}

/* Of the largest level. */
static bool decode_tiles(struct picture *p, size_t size) {
    int32_t width = 0, height = 0;
    bool ok = MAY_FAIL(exr_get_tile_sizes(p->context, 0, 0, 0, &width, &height)) == EXR_ERR_SUCCESS && width > 0 &&
              height > 0;
    /* The file has a number of 8 bytes for each tile. */
    if (ok && (uint64_t)((p->width - 1) / width + 1) * (uint64_t)((p->height - 1) / height + 1) > size / 8)
        return false;
    for (int32_t y = 0; ok && y < p->height; y += height)
        for (int32_t x = 0; ok && x < p->width; x += width) {
            exr_chunk_info_t chunk;
            ok = exr_read_tile_chunk_info(p->context, 0, x / width, y / height, 0, 0, &chunk) == EXR_ERR_SUCCESS &&
                 decode_chunk(p, &chunk, x, y);
        }
    return ok;
}

/* Between its samples, RY or BY is interpolated. */
static double chroma_at(const struct picture *p, int which, int32_t x, int32_t y) {
    int32_t columns = p->columns[which], rows = p->rows[which], width = p->chroma_width[which];
    int32_t x0 = x / columns, y0 = y / rows, x1 = x0 + 1 < width ? x0 + 1 : x0;
    int32_t y1 = y0 + 1 < p->chroma_height[which] ? y0 + 1 : y0;
    double s = (double)(x % columns) / columns, t = (double)(y % rows) / rows;
    const float *top = p->chroma[which] + (size_t)y0 * (size_t)width;
    const float *bottom = p->chroma[which] + (size_t)y1 * (size_t)width;
    return (1 - t) * ((1 - s) * (double)top[x0] + s * (double)top[x1]) +
           t * ((1 - s) * (double)bottom[x0] + s * (double)bottom[x1]);
}

/* RY = (R - Y) / Y and BY = (B - Y) / Y, where Y is the luminance of Rec. 709 ("Technical Introduction to OpenEXR").
 * Outside of the data window Y is 0. */
static void set_colour(const struct picture *p, int64_t x, int64_t y, float *texel) {
    double luminance = (double)texel[0];
    bool inside = x >= 0 && y >= 0 && x < p->width && y < p->height;
    double red = inside ? (1 + chroma_at(p, 0, (int32_t)x, (int32_t)y)) * luminance : 0;
    double blue = inside ? (1 + chroma_at(p, 1, (int32_t)x, (int32_t)y)) * luminance : 0;
    texel[0] = (float)red;
    texel[1] = (float)((luminance - 0.212639 * red - 0.072192 * blue) / 0.715169);
    texel[2] = (float)blue;
}

static void set_colours(const struct picture *p) {
    const struct image_level *to = &p->image->levels[0];
    bool chroma = (p->met & MET_CHROMA) == MET_CHROMA && p->met & MET_Y;
    for (uint32_t y = 0; y < to->height; y++)
        for (uint32_t x = 0; x < to->width; x++) {
            float *texel = (float *)to->texels + ((size_t)y * to->width + x) * 4;
            if (chroma)
                set_colour(p, (int64_t)x + p->display.min.x - p->data.min.x,
                           (int64_t)y + p->display.min.y - p->data.min.y, texel);
            else if (p->met & MET_Y)
                texel[1] = texel[2] = texel[0];
            for (int k = 0; k < 3; k++)
                texel[k] = bounded(texel[k]);
            texel[3] = 1;
        }
}

/* The largest number of pixels per byte of the file: one channel of two bytes through zlib (1032 : 1), and with lossy
 * compression the same for one number per block of 8 x 8. */
static uint64_t pixels_per_byte(exr_context_t context) {
    const uint64_t zipped = 520;
    exr_compression_t compression;
    bool blocks = MAY_FAIL(exr_get_compression(context, 0, &compression)) == EXR_ERR_SUCCESS &&
                  (compression == EXR_COMPRESSION_DWAA || compression == EXR_COMPRESSION_DWAB);
    return blocks ? 64 * zipped : zipped;
}

/* Whether the file can hold the data window, and the display window is not much larger than that. */
static bool check_sizes(const struct picture *p, int64_t width, int64_t height, size_t size, struct error *error) {
    const int64_t small = 1 << 22; /* pixels of a display window that any file may have */
    uint64_t max = pixels_per_byte(p->context) * size;
    /* Every row costs a few bytes even when it is black, in chunks of at most 256 rows. */
    if ((size_t)p->height / 256 > size / 8 || (uint64_t)p->width * (uint64_t)p->height > max)
        return error_set(error, ERROR_SCENE, "%s: broken EXR: the file is too short for its pixels", p->path);
    if (width < 1 || height < 1 || width > IMAGE_MAX_SIDE || height > IMAGE_MAX_SIDE ||
        (width * height > small && (uint64_t)width * (uint64_t)height > max))
        return error_set(error, ERROR_SCENE, "%s: broken EXR: its display window is no window, or too large", p->path);
    return true;
}

static bool decode(struct picture *p, struct stream *stream, struct error *error) {
    exr_storage_t storage;
    if (MAY_FAIL(exr_get_storage(p->context, 0, &storage)) != EXR_ERR_SUCCESS ||
        MAY_FAIL(exr_get_data_window(p->context, 0, &p->data)) != EXR_ERR_SUCCESS ||
        MAY_FAIL(exr_get_display_window(p->context, 0, &p->display)) != EXR_ERR_SUCCESS)
        return report_error(p->path, stream, "broken EXR", error);
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
        return error_set(error, ERROR_SCENE, "%s: deep EXR pictures are not read", p->path);
    int64_t data_width = (int64_t)p->data.max.x - p->data.min.x + 1;
    int64_t data_height = (int64_t)p->data.max.y - p->data.min.y + 1;
    int64_t width = (int64_t)p->display.max.x - p->display.min.x + 1;
    int64_t height = (int64_t)p->display.max.y - p->display.min.y + 1;
    assert(data_width >= 1 && data_height >= 1 && data_width <= IMAGE_MAX_SIDE &&
           data_height <= IMAGE_MAX_SIDE); /* the header claims this */
    p->width = (int32_t)data_width;
    p->height = (int32_t)data_height;
    if (!check_sizes(p, width, height, stream->size, error))
        return false;
    p->image = image_allocate(p->path, (uint32_t)width, (uint32_t)height, 32, error);
    if (!p->image)
        return false;
    memset(p->image->levels[0].texels, 0, (size_t)width * (size_t)height * 16);
    bool ok = storage == EXR_STORAGE_TILED ? decode_tiles(p, stream->size) : decode_lines(p);
    (void)exr_decoding_destroy(p->context, &p->decoder);
    stream->no_memory |= p->no_memory;
    if (!ok)
        return report_error(p->path, stream, "broken EXR", error);
    if (p->met & MET_Y ? p->met & MET_RGB : p->met != MET_RGB)
        return error_set(error, ERROR_SCENE, "%s: an EXR picture needs the channels R, G and B, or Y", p->path);
    set_colours(p);
    return true;
}

struct image *image_parse_exr(const char *path, const uint8_t *data, size_t size, struct error *error) {
    /* Borrowed: reading never writes to it. */
    struct stream stream = {.bytes = (uint8_t *)(uintptr_t)data, .size = size};
    struct picture picture = {.path = path, .decoder = EXR_DECODE_PIPELINE_INITIALIZER};
    exr_context_initializer_t init = callbacks(&stream);
    init.max_image_width = init.max_image_height = IMAGE_MAX_SIDE;
    init.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    to_report = &stream;
    exr_result_t begun = exr_start_read(&picture.context, path, &init);
    bool ok = false;
    stream.no_memory |= begun == EXR_ERR_OUT_OF_MEMORY;
    if (begun == EXR_ERR_SUCCESS) {
        ok = decode(&picture, &stream, error);
        (void)exr_finish(&picture.context);
    } else {
        report_error(path, &stream, "broken EXR", error);
    }
    to_report = NULL;
    mem_free(picture.chunk);
    mem_free(picture.chroma[0]);
    mem_free(picture.chroma[1]);
    return image_finish(picture.image, ok, error);
}

#endif
