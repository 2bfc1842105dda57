/* PNG in, through libpng ("Portable Network Graphics Specification (Second Edition)", ISO/IEC 15948:2003).
 *
 * libpng reports errors by longjmp. So one struct reader in image_parse_png owns everything that must be freed; decode,
 * the function with the setjmp, has no local variables that change after it. Nothing is used before it is checked:
 * invalid sizes are refused before memory is allocated, and so is a picture that the bytes of the file cannot fill
 * (deflate shrinks by 1032 : 1 at most), so a small hostile file costs little memory. libpng
 * skips chunks that do not change texels, except for their checksums; find_chunk finds those about colours. */

#include "base/mem.h"
#include "image/png_read_internal.h"
#include "image/zlib_memory.h"

#include <assert.h>
#include <ctype.h>
#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <string.h>

/* Larger files are not reasonable even for the largest size. */
#define FILE_LIMIT ((size_t)1 << 32)

enum { SIGNATURE = 8, HEADER = 33 }; /* the signature; with the IHDR chunk that must follow */

struct reader {
    const char *path;
    const uint8_t *data;   /* the whole file */
    size_t size, position; /* of the next byte libpng gets */
    bool truncated, out_of_memory;
    char message[160]; /* what libpng said */
    png_structp png;
    png_infop info;
    struct image *image;
};

static void on_read(png_structp png, png_bytep data, size_t size) {
    struct reader *reader = png_get_io_ptr(png);
    if (size > reader->size - reader->position) {
        reader->truncated = true;
        png_error(png, "end of file");
    }
    memcpy(data, reader->data + reader->position, size);
    reader->position += size;
}

static void on_error(png_structp png, png_const_charp message) {
    struct reader *reader = png_get_error_ptr(png);
    (void)snprintf(reader->message, sizeof reader->message, "%s", message);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message) {
    (void)png, (void)message;
}

static png_voidp on_alloc(png_structp png, png_alloc_size_t size) {
    struct reader *reader = png_get_mem_ptr(png);
    void *block = mem_alloc(size);
    reader->out_of_memory |= block == NULL;
    return block;
}

static void on_free(png_structp png, png_voidp block) {
    (void)png;
    mem_free(block);
}

static uint32_t big_endian(const uint8_t *bytes) {
    return (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 | bytes[3];
}

static const char *why_no_png(const uint8_t *data, size_t size) {
    if (size == 0)
        return "the file is empty";
    if (size >= 4 && memcmp(data, "\x89PNG", 4) == 0)
        return "it looks like a PNG that was copied as text, which changed its line ends";
    return "it starts with other bytes";
}

static bool report_truncated(const struct reader *reader, struct error *error) {
    return error_set(error, ERROR_SCENE, "%s: truncated PNG: the file ends at byte %zu, before the picture is complete",
                     reader->path, reader->size);
}

/* Reads signature and sizes without libpng, for better error messages. */
static bool check_header(const struct reader *reader, struct error *error) {
    static const uint8_t signature[SIGNATURE] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    const uint8_t *data = reader->data;
    size_t size = reader->size;
    if (size > 0 && size < SIGNATURE && memcmp(data, signature, size) == 0)
        return report_truncated(reader, error);
    if (size < SIGNATURE || memcmp(data, signature, SIGNATURE) != 0)
        return error_set(error, ERROR_SCENE, "%s: not a PNG file: %s", reader->path, why_no_png(data, size));
    if (size < HEADER)
        return report_truncated(reader, error);
    if (big_endian(data + 8) != 13 || memcmp(data + 12, "IHDR", 4) != 0)
        return error_set(error, ERROR_SCENE, "%s: broken PNG: the first chunk is not IHDR (at byte 8)", reader->path);
    uint32_t width = big_endian(data + 16), height = big_endian(data + 20);
    if (width == 0 || height == 0)
        return error_set(error, ERROR_SCENE, "%s: broken PNG: its size is %u x %u (at byte 16)", reader->path, width,
                         height);
    if (width > IMAGE_MAX_SIDE || height > IMAGE_MAX_SIDE || (uint64_t)width * height > IMAGE_MAX_TEXELS)
        return error_set(error, ERROR_SCENE, "%s: %u x %u pixels are too many (at most %d a side and %d in all)",
                         reader->path, width, height, IMAGE_MAX_SIDE, IMAGE_MAX_TEXELS);
    return true;
}

/* Whether the bytes after the header could inflate to this size, with a tolerance: up to 1040 : 1 plus 64 bytes. */
static bool can_hold(const struct reader *reader, uint64_t bytes) {
    return bytes <= (reader->size - HEADER) * UINT64_C(1040) + 64;
}

/* The picture as RGBA rows in reader->image, levels not yet built. Only `reader` survives a longjmp. False:
 * reader->message or *error is set. */
static bool decode(struct reader *reader, struct error *error) {
    if (setjmp(png_jmpbuf(reader->png)))
        return false;
    png_structp const png = reader->png;
    png_infop const info = reader->info;
    png_set_read_fn(png, reader, on_read);
    png_set_crc_action(png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    png_set_user_limits(png, IMAGE_MAX_SIDE, IMAGE_MAX_SIDE);
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, NULL, -1); /* including known chunks without use */
    png_read_info(png, info);

    png_uint_32 const width = png_get_image_width(png, info), height = png_get_image_height(png, info);
    int const bits = png_get_bit_depth(png, info) == 16 ? 16 : 8;
    if (!can_hold(reader, (uint64_t)png_get_rowbytes(png, info) * height)) {
        (void)snprintf(reader->message, sizeof reader->message, "the file is too short for %lu x %lu pixels",
                       (unsigned long)width, (unsigned long)height);
        return false;
    }

    png_set_expand(png); /* palettes, small depths and tRNS */
    png_set_gray_to_rgb(png);
    png_set_add_alpha(png, 0xffff, PNG_FILLER_AFTER);
    if (bits == 16 && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__)
        png_set_swap(png);
    int const passes = png_set_interlace_handling(png);
    png_read_update_info(png, info);
    size_t const row = (size_t)width * (bits == 16 ? 8 : 4);
    assert(png_get_rowbytes(png, info) == row); /* as requested above */

    reader->image = image_allocate(reader->path, width, height, bits, error);
    if (!reader->image)
        return false;
    for (int pass = 0; pass < passes; pass++)
        for (png_uint_32 y = 0; y < height; y++)
            png_read_row(png, (png_bytep)reader->image->levels[0].texels + y * row, NULL);
    png_read_end(png, NULL);
    return true;
}

/* --- what the numbers mean --- */

/* The chunks of a PNG file that state what its numbers mean (PNG Specification, third edition, W3C 2025, 4.3 and
 * 11.3.2): cICP before iCCP, iCCP before sRGB, sRGB before gAMA. Chunks are read without libpng, which skips them; it
 * checks their checksums later. A profile counts as sRGB if its description says so (ICC.1:2022, 9.2.41). */

enum { CHUNK = 12, NAME_LIMIT = 79, PROFILE_LIMIT = 1 << 20, PROFILE_HEAD = 132, TAG = 12 };

struct chunk {
    const uint8_t *bytes;
    size_t size; /* 0: there is none */
};

static uint32_t word(const uint8_t *bytes) {
    return (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 | bytes[3];
}

/* The first chunk of this kind before the picture. */
static struct chunk find_chunk(const uint8_t *data, size_t size, const char *kind) {
    for (size_t at = HEADER; at + CHUNK <= size;) {
        uint32_t length = word(data + at);
        if (length > size - at - CHUNK || memcmp(data + at + 4, "IDAT", 4) == 0)
            break;
        if (memcmp(data + at + 4, kind, 4) == 0)
            return (struct chunk){data + at + 8, length};
        at += CHUNK + (size_t)length;
    }
    return (struct chunk){NULL, 0};
}

/* --- profiles --- */

/* Text of a description, ASCII or UTF-16 with ASCII letters: other characters become '?'. */
static void copy_description(const uint8_t *text, size_t size, size_t step, char out[NAME_LIMIT + 1]) {
    size_t used = 0;
    for (size_t i = 0; i + step <= size && used < NAME_LIMIT; i += step) {
        uint8_t high = step == 2 ? text[i] : 0, low = text[i + step - 1];
        if (high == 0 && low == 0)
            break;
        out[used++] = high == 0 && isprint(low) ? (char)low : '?';
    }
    out[used] = '\0';
}

/* False: the profile has no description that can be read. */
static bool describe_profile(const uint8_t *profile, size_t size, char out[NAME_LIMIT + 1]) {
    uint32_t count = size >= PROFILE_HEAD ? word(profile + PROFILE_HEAD - 4) : 0;
    for (uint32_t i = 0; i < count && PROFILE_HEAD + (i + 1) * (size_t)TAG <= size; i++) {
        const uint8_t *tag = profile + PROFILE_HEAD + i * (size_t)TAG;
        size_t at = word(tag + 4), length = word(tag + 8);
        if (memcmp(tag, "desc", 4) != 0 || at > size || length > size - at || length < 28)
            continue;
        const uint8_t *body = profile + at;
        if (memcmp(body, "desc", 4) == 0) {
            copy_description(body + 12, length - 12, 1, out);
            return true;
        }
        size_t text_length = word(body + 20), text = word(body + 24);
        if (memcmp(body, "mluc", 4) == 0 && text <= length) {
            copy_description(body + text, text_length < length - text ? text_length : length - text, 2, out);
            return true;
        }
    }
    return false;
}

/* The description of a compressed profile, or its name in the chunk. */
static void name_profile(struct chunk chunk, char out[NAME_LIMIT + 1]) {
    const uint8_t *end = memchr(chunk.bytes, '\0', chunk.size < NAME_LIMIT + 1 ? chunk.size : NAME_LIMIT + 1);
    size_t name = end ? (size_t)(end - chunk.bytes) : 0;
    copy_description(chunk.bytes, name, 1, out);
    uint8_t *profile = end && chunk.size > name + 2 ? mem_alloc(PROFILE_LIMIT) : NULL;
    z_stream stream = {.zalloc = zlib_alloc, .zfree = zlib_free};
    if (!profile || inflateInit(&stream) != Z_OK) {
        mem_free(profile);
        return;
    }
    stream.next_in = chunk.bytes + name + 2;
    stream.avail_in = (uInt)(chunk.size - name - 2);
    stream.next_out = profile;
    stream.avail_out = PROFILE_LIMIT;
    (void)inflate(&stream, Z_FINISH);
    char described[NAME_LIMIT + 1];
    if (describe_profile(profile, PROFILE_LIMIT - stream.avail_out, described) && described[0] != '\0')
        memcpy(out, described, sizeof described);
    (void)inflateEnd(&stream);
    mem_free(profile);
}

/* --- all of them --- */

static struct transfer_function by_number(uint8_t number, const char **unknown) {
    switch (number) {
    case 1:
    case 6:
    case 14:
    case 15:
        return (struct transfer_function){TRANSFER_BT709, 0};
    case 4:
        return (struct transfer_function){TRANSFER_POWER, 2.2};
    case 5:
        return (struct transfer_function){TRANSFER_POWER, 2.8};
    case 8:
        return (struct transfer_function){TRANSFER_POWER, 1};
    case 13:
        break;
    default:
        *unknown = number == 16 ? "PQ (SMPTE ST 2084)" : number == 18 ? "HLG (ARIB STD-B67)" : "a rare one";
        break;
    }
    return (struct transfer_function){TRANSFER_SRGB, 0};
}

/* Sets what the file states about its colours: `transfer` and `colours`. False: no memory. */
static bool read_colours(struct image *image, const uint8_t *data, size_t size) {
    struct chunk cicp = find_chunk(data, size, "cICP"), profile = find_chunk(data, size, "iCCP");
    struct chunk srgb = find_chunk(data, size, "sRGB"), gamma = find_chunk(data, size, "gAMA");
    char text[256] = "", name[NAME_LIMIT + 1];
    /* The first one that exists counts; what it states beyond sRGB is reported. */
    if (cicp.size == 4) {
        const char *unknown = NULL;
        image->transfer = by_number(cicp.bytes[1], &unknown);
        if (unknown)
            (void)snprintf(text, sizeof text, "the transfer function %s (cICP)", unknown);
        else if (cicp.bytes[0] != 1)
            (void)snprintf(text, sizeof text, "other primaries than sRGB's (%d in cICP)", cicp.bytes[0]);
    } else if (profile.size > 0) {
        name_profile(profile, name);
        image->transfer.kind = TRANSFER_SRGB;
        if (!strstr(name, "sRGB"))
            (void)snprintf(text, sizeof text, "the colour profile '%s'", name);
    } else if (srgb.size > 0) {
        image->transfer.kind = TRANSFER_SRGB;
    } else if (gamma.size == 4 && word(gamma.bytes) > 0) {
        image->transfer = (struct transfer_function){TRANSFER_POWER, 100000.0 / word(gamma.bytes)};
    }
    if (text[0] == '\0')
        return true;
    image->colours = mem_alloc(strlen(text) + 1);
    if (!image->colours)
        return false;
    memcpy(image->colours, text, strlen(text) + 1);
    return true;
}

/* --- the whole file --- */

struct image *image_parse_png(const char *path, const uint8_t *data, size_t size, struct error *error) {
    struct reader reader = {.path = path, .data = data, .size = size};
    if (!check_header(&reader, error))
        return NULL;
    error->kind = ERROR_NONE;
    reader.png =
        png_create_read_struct_2(PNG_LIBPNG_VER_STRING, &reader, on_error, on_warning, &reader, on_alloc, on_free);
    reader.info = reader.png ? png_create_info_struct(reader.png) : NULL;
    bool ok = reader.info ? decode(&reader, error) : error_no_memory(error, path);
    /* What libpng reports last is not always the cause. */
    if (!ok && error->kind == ERROR_NONE) {
        if (reader.out_of_memory)
            error_no_memory(error, path);
        else if (reader.truncated)
            report_truncated(&reader, error);
        else
            error_set(error, ERROR_SCENE, "%s: broken PNG: %s (before byte %zu)", path, reader.message,
                      reader.position);
    }
    png_destroy_read_struct(&reader.png, &reader.info, NULL);
    if (ok && !read_colours(reader.image, data, size))
        ok = error_no_memory(error, path);
    ok = ok && image_build_levels(reader.image, error);
    if (ok)
        return reader.image;
    image_release(reader.image);
    return NULL;
}
