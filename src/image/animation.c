/* Common parts of animation files: frames read back exactly from the PNG files that this program wrote; frame rates;
 * and YUV4MPEG2, which every video encoder reads from a pipe. Y, Cb and Cr are those of BT.601 in their limited ranges,
 * 16..235 and 16..240, without subsampling: decoding gives each byte within two levels. */
#include "image/animation.h"

#include "base/file.h"
#include "base/mem.h"
#include "image/zlib_memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- frames from PNG files --- */

enum { SIGNATURE = 8, CHUNK_HEAD = 8, CHUNK_END = 4, HEAD_SIZE = 13, FILE_LIMIT = 1 << 30 };

struct chunks {
    const uint8_t *data;
    size_t size, at; /* at: the next chunk */
};

struct chunk {
    const uint8_t *kind, *bytes;
    size_t size;
};

static uint32_t word_at(const uint8_t *bytes) {
    return (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 | bytes[3];
}

static bool next_chunk(struct chunks *chunks, struct chunk *out) {
    if (chunks->size - chunks->at < CHUNK_HEAD + CHUNK_END)
        return false;
    const uint8_t *head = chunks->data + chunks->at;
    size_t size = word_at(head), room = chunks->size - chunks->at - CHUNK_HEAD - CHUNK_END;
    if (size > room)
        return false;
    *out = (struct chunk){head + 4, head + CHUNK_HEAD, size};
    chunks->at += CHUNK_HEAD + size + CHUNK_END;
    return word_at(out->bytes + size) == (uint32_t)crc32_z(0, out->kind, size + 4);
}

static bool is_kind(const struct chunk *chunk, const char *kind) {
    return memcmp(chunk->kind, kind, 4) == 0;
}

static bool no_frame(const char *path, struct error *error) {
    return error_set(error, ERROR_SCENE, "%.600s: is not a PNG file of 8 bits per channel that gray wrote", path);
}

/* The signature and the IHDR chunk. */
static bool read_head(struct chunks *chunks, struct png_frame *out) {
    static const uint8_t rgb_8[5] = {8, 2, 0, 0, 0};
    struct chunk chunk;
    if (chunks->size < SIGNATURE || memcmp(chunks->data, "\x89PNG\r\n\x1a\n", SIGNATURE) != 0)
        return false;
    chunks->at = SIGNATURE;
    if (!next_chunk(chunks, &chunk) || !is_kind(&chunk, "IHDR") || chunk.size != HEAD_SIZE ||
        memcmp(chunk.bytes + 8, rgb_8, sizeof rgb_8) != 0)
        return false;
    *out = (struct png_frame){.width = word_at(chunk.bytes), .height = word_at(chunk.bytes + 4)};
    return out->width > 0 && out->height > 0 && out->width <= 1u << 20 && out->height <= 1u << 20;
}

static uint8_t paeth(uint8_t left, uint8_t above, uint8_t corner) {
    int p = left + above - corner, a = abs(p - left), b = abs(p - above), c = abs(p - corner);
    return a <= b && a <= c ? left : b <= c ? above : corner;
}

/* One row; above: the row before it, or NULL. */
static bool unfilter(uint8_t filter, uint8_t *row, const uint8_t *above, size_t size) {
    for (size_t i = 0; i < size; i++) {
        uint8_t left = i >= 3 ? row[i - 3] : 0, up = above ? above[i] : 0, corner = above && i >= 3 ? above[i - 3] : 0;
        switch (filter) {
        case 0:
            return true;
        case 1:
            row[i] = (uint8_t)(row[i] + left);
            break;
        case 2:
            row[i] = (uint8_t)(row[i] + up);
            break;
        case 3:
            row[i] = (uint8_t)(row[i] + (left + up) / 2);
            break;
        case 4:
            row[i] = (uint8_t)(row[i] + paeth(left, up, corner));
            break;
        default:
            return false;
        }
    }
    return true;
}

/* The compressed rows of all IDAT chunks, one after the other, into rgb. */
static bool inflate_rows(struct chunks *chunks, z_stream *stream, const struct png_frame *frame, uint8_t *rgb) {
    size_t row_size = (size_t)frame->width * 3, filled = 0, size = (row_size + 1) * frame->height;
    uint8_t *row = mem_alloc(row_size + 1);
    struct chunk chunk;
    bool sound = row != NULL;
    while (sound && filled < size && next_chunk(chunks, &chunk)) {
        if (!is_kind(&chunk, "IDAT"))
            continue;
        stream->next_in = chunk.bytes;
        stream->avail_in = (uInt)chunk.size;
        while (sound && filled < size) {
            /* A row is complete before it is unfiltered; one row is in memory. */
            size_t within = filled % (row_size + 1);
            uint32_t y = (uint32_t)(filled / (row_size + 1));
            stream->next_out = row + within;
            stream->avail_out = (uInt)(row_size + 1 - within);
            int state = inflate(stream, Z_NO_FLUSH);
            filled += row_size + 1 - within - stream->avail_out;
            if (stream->avail_out == 0) {
                uint8_t *out = rgb + y * row_size;
                memcpy(out, row + 1, row_size);
                sound = unfilter(row[0], out, y > 0 ? out - row_size : NULL, row_size);
            } else if (state != Z_OK || stream->avail_in == 0) {
                sound = state == Z_OK || state == Z_BUF_ERROR;
                break;
            }
        }
    }
    mem_free(row);
    return sound && filled == size;
}

bool png_frame_head(const char *path, struct png_frame *out, struct error *error) {
    struct file_bytes file;
    struct chunk chunk;
    if (!file_map(path, FILE_LIMIT, &file, error))
        return false;
    struct chunks chunks = {.data = file.data, .size = file.size};
    bool ok = read_head(&chunks, out);
    while (ok && next_chunk(&chunks, &chunk) && !is_kind(&chunk, "IDAT"))
        out->srgb = out->srgb || is_kind(&chunk, "sRGB");
    file_unmap(&file);
    return ok || no_frame(path, error);
}

bool png_frame_read(const char *path, uint32_t width, uint32_t height, uint8_t *rgb, struct error *error) {
    struct file_bytes file;
    struct png_frame frame = {0};
    if (!file_map(path, FILE_LIMIT, &file, error))
        return false;
    struct chunks chunks = {.data = file.data, .size = file.size};
    z_stream stream = {.zalloc = zlib_alloc, .zfree = zlib_free};
    bool ok = read_head(&chunks, &frame) || no_frame(path, error);
    if (ok && (frame.width != width || frame.height != height))
        ok = error_set(error, ERROR_SCENE, "%.600s: has %u x %u pixels, not %u x %u as the first frame", path,
                       frame.width, frame.height, width, height);
    if (ok && inflateInit(&stream) != Z_OK) {
        ok = error_no_memory(error, path);
    } else if (ok) {
        ok = inflate_rows(&chunks, &stream, &frame, rgb) || no_frame(path, error);
        (void)inflateEnd(&stream);
    }
    file_unmap(&file);
    return ok;
}

/* --- Y4M --- */

/* Products of the matrix of ITU-R BT.601 with 219 / 255 and 224 / 255, in 65536ths; the rows of Cb and Cr sum to 0. */
static const int32_t matrix[3][3] = {{16829, 33039, 6416}, {-9714, -19070, 28784}, {28784, -24103, -4681}};
static const int32_t offset[3] = {16, 128, 128};

size_t y4m_head(const struct animation_source *source, char out[Y4M_HEAD_SIZE]) {
    struct frame_rate rate = frame_rate_fraction(source->rate);
    return (size_t)snprintf(out, Y4M_HEAD_SIZE, "YUV4MPEG2 W%u H%u F%u:%u Ip A1:1 C444 XCOLORRANGE=LIMITED\n",
                            source->width, source->height, rate.over, rate.under);
}

void y4m_frame(const uint8_t *rgb, size_t pixels, uint8_t *out) {
    memcpy(out, "FRAME\n", Y4M_FRAME_HEAD);
    out += Y4M_FRAME_HEAD;
    for (int plane = 0; plane < 3; plane++) {
        const int32_t *row = matrix[plane], base = offset[plane] * 65536 + 32768;
        for (size_t i = 0; i < pixels; i++)
            *out++ =
                (uint8_t)((base + row[0] * rgb[3 * i] + row[1] * rgb[3 * i + 1] + row[2] * rgb[3 * i + 2]) / 65536);
    }
}

bool y4m_write(const struct file_target *target, const struct animation_source *source, struct error *error) {
    struct file_output output;
    char head[Y4M_HEAD_SIZE];
    size_t pixels = (size_t)source->width * source->height, head_size = y4m_head(source, head);
    if (!file_output_open(&output, target, error))
        return false;
    uint8_t *rgb = mem_alloc(3 * pixels), *frame = mem_alloc(Y4M_FRAME_HEAD + 3 * pixels);
    bool ok = rgb && frame ? file_output_write(&output, head, head_size, error) : error_no_memory(error, target->path);
    for (uint32_t index = 0; ok && index < source->count; index++) {
        ok = source->frame(source->context, index, rgb, error);
        if (ok)
            y4m_frame(rgb, pixels, frame);
        ok = ok && file_output_write(&output, frame, Y4M_FRAME_HEAD + 3 * pixels, error);
    }
    mem_free(rgb);
    mem_free(frame);
    if (ok)
        return file_output_commit(&output, error);
    file_output_abandon(&output);
    return false;
}

struct frame_rate frame_rate_fraction(double rate) {
    double whole = floor(rate + 0.5);
    if (rate == whole)
        return (struct frame_rate){(uint32_t)whole, 1};
    return (struct frame_rate){(uint32_t)(rate * 1000 + 0.5), 1000};
}

bool animation_is(const uint8_t *head, size_t size) {
    static const struct {
        size_t at, size;
        const char *bytes;
    } signatures[] = {{0, 4, "GIF8"}, {0, 8, "\x89PNG\r\n\x1a\n"}, {0, 9, "YUV4MPEG2"}, {8, 4, "WEBP"},
                      {4, 4, "ftyp"}, {0, 4, "\x1a\x45\xdf\xa3"}};
    for (size_t i = 0; i < sizeof signatures / sizeof *signatures; i++) {
        if (size >= signatures[i].at + signatures[i].size &&
            memcmp(head + signatures[i].at, signatures[i].bytes, signatures[i].size) == 0)
            return true;
    }
    return false;
}
