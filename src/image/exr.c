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

/* The index of a channel: red, green, blue; 3: another. Y counts as red. */
static int channel_number(const char *name) {
    static const char *const names[] = {"R", "G", "B"};
    for (int i = 0; i < 3; i++) {
        if (strcmp(name, names[i]) == 0)
            return i;
    }
    return strcmp(name, "Y") == 0 ? 0 : 3;
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
    return light > 0 ? fminf(light, FLT_MAX) : 0; /* NaN too */
}

/* The three channels of the picture are decoded in place; the others are skipped. Returns which were found. */
static unsigned set_channels(exr_decode_pipeline_t *decoder, float *out, uint32_t width) {
    unsigned met = 0;
    for (int16_t i = 0; i < decoder->channel_count; i++) {
        exr_coding_channel_info_t *channel = &decoder->channels[i];
        int number = channel_number(channel->channel_name);
        channel->decode_to_ptr = NULL;
        if (number > 2 || channel->x_samples != 1 || channel->y_samples != 1)
            continue;
        met |= strcmp(channel->channel_name, "Y") == 0 ? 8u : 1u << number;
        channel->user_bytes_per_element = 4;
        channel->user_data_type = EXR_PIXEL_FLOAT;
        channel->user_pixel_stride = 16;
        channel->user_line_stride = (int32_t)width * 16;
        channel->decode_to_ptr = (uint8_t *)(out + number);
    }
    return met;
}

static bool decode_chunks(exr_context_t context, const exr_attr_box2i_t *window, struct image *image, unsigned *met) {
    exr_decode_pipeline_t decoder = EXR_DECODE_PIPELINE_INITIALIZER;
    uint32_t width = image->levels[0].width, height = image->levels[0].height;
    int step = 0;
    bool ok = MAY_FAIL(exr_get_scanlines_per_chunk(context, 0, &step)) == EXR_ERR_SUCCESS, begun = false;
    assert(!ok || step > 0); /* 1 to 256, depending on the compression */
    for (uint32_t y = 0; ok && y < height; y += (uint32_t)step) {
        exr_chunk_info_t chunk;
        ok = exr_read_scanline_chunk_info(context, 0, window->min.y + (int)y, &chunk) == EXR_ERR_SUCCESS;
        /* The library counts chunks from the top of the data window and cuts the last one off at its end. */
        assert(!ok || ((uint32_t)chunk.width == width && chunk.height > 0 && (uint32_t)chunk.height <= height - y));
        ok = ok && MAY_FAIL(begun ? exr_decoding_update(context, 0, &chunk, &decoder)
                                  : exr_decoding_initialize(context, 0, &chunk, &decoder)) == EXR_ERR_SUCCESS;
        if (ok)
            *met = set_channels(&decoder, (float *)image->levels[0].texels + (size_t)y * width * 4, width);
        ok = ok && (begun || MAY_FAIL(exr_decoding_choose_default_routines(context, 0, &decoder)) == EXR_ERR_SUCCESS);
        begun = true;
        ok = ok && exr_decoding_run(context, 0, &decoder) == EXR_ERR_SUCCESS;
    }
    (void)exr_decoding_destroy(context, &decoder);
    return ok;
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

static struct image *decode(exr_context_t context, const char *path, struct stream *stream, struct error *error) {
    exr_storage_t storage;
    exr_attr_box2i_t window;
    if (MAY_FAIL(exr_get_storage(context, 0, &storage)) != EXR_ERR_SUCCESS ||
        MAY_FAIL(exr_get_data_window(context, 0, &window)) != EXR_ERR_SUCCESS) {
        report_error(path, stream, "broken EXR", error);
        return NULL;
    }
    if (storage != EXR_STORAGE_SCANLINE) {
        error_set(error, ERROR_SCENE, "%s: only EXR pictures in scan lines are read, not tiled or deep ones", path);
        return NULL;
    }
    int64_t width = (int64_t)window.max.x - window.min.x + 1, height = (int64_t)window.max.y - window.min.y + 1;
    /* Every row costs a few bytes even when it is black, in chunks of at most 256 rows. */
    assert(width >= 1 && height >= 1 && width <= IMAGE_MAX_SIDE &&
           height <= IMAGE_MAX_SIDE); /* the header claims this */
    if ((uint64_t)height / 256 > stream->size / 8 ||
        (uint64_t)width * (uint64_t)height / pixels_per_byte(context) > stream->size) {
        error_set(error, ERROR_SCENE, "%s: broken EXR: the file is too short for its pixels", path);
        return NULL;
    }
    struct image *image = image_allocate(path, (uint32_t)width, (uint32_t)height, 32, error);
    if (!image)
        return NULL;
    memset(image->levels[0].texels, 0, (size_t)width * (size_t)height * 16);
    unsigned met = 0;
    bool ok = decode_chunks(context, &window, image, &met) || report_error(path, stream, "broken EXR", error);
    if (ok && met != 7 && met != 8)
        ok = error_set(error, ERROR_SCENE, "%s: an EXR picture needs the channels R, G and B, or Y", path);
    float *texels = image->levels[0].texels;
    for (size_t i = 0; ok && i < (size_t)width * (size_t)height * 4; i += 4) {
        for (size_t k = 0; k < 3; k++)
            texels[i + k] = bounded(texels[i + (met == 8 ? 0 : k)]);
        texels[i + 3] = 1;
    }
    if (!ok) {
        image_release(image);
        return NULL;
    }
    bool built = image_build_levels(image, error);
    assert(built); /* floats need no extra memory for it */
    (void)built;
    return image;
}

struct image *image_parse_exr(const char *path, const uint8_t *data, size_t size, struct error *error) {
    /* Borrowed: reading never writes to it. */
    struct stream stream = {.bytes = (uint8_t *)(uintptr_t)data, .size = size};
    exr_context_initializer_t init = callbacks(&stream);
    exr_context_t context;
    init.max_image_width = init.max_image_height = IMAGE_MAX_SIDE;
    init.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    to_report = &stream;
    exr_result_t begun = exr_start_read(&context, path, &init);
    struct image *image = NULL;
    stream.no_memory |= begun == EXR_ERR_OUT_OF_MEMORY;
    if (begun == EXR_ERR_SUCCESS) {
        image = decode(context, path, &stream, error);
        (void)exr_finish(&context);
    } else {
        report_error(path, &stream, "broken EXR", error);
    }
    to_report = NULL;
    return image;
}

#endif
