/* The chunks of a PNG file that state what its numbers mean (PNG Specification, third edition, W3C 2025, 4.3 and
 * 11.3.2): cICP before iCCP, iCCP before sRGB, sRGB before gAMA. Chunks are read without libpng, which skips them; it
 * checks their checksums later. A profile counts as sRGB if its description says so (ICC.1:2022, 9.2.41). */
#include "image/levels.h"

#include "base/mem.h"
#include "image/zlib_memory.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

enum { HEADER = 33, CHUNK = 12, NAME_LIMIT = 79, PROFILE_LIMIT = 1 << 20, PROFILE_HEAD = 132, TAG = 12 };

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

bool png_colour_read(struct image *image, const uint8_t *data, size_t size) {
    struct chunk cicp = find_chunk(data, size, "cICP"), profile = find_chunk(data, size, "iCCP");
    struct chunk srgb = find_chunk(data, size, "sRGB"), gamma = find_chunk(data, size, "gAMA");
    char text[256] = "", name[NAME_LIMIT + 1];
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
