/* Radiance pictures (Ward, "Real Pixels", Graphics Gems II, 1991, and the file format reference of Radiance): a text
 * header, a line with the size, then rows of four bytes a pixel, flat, with repeated pixels (1, 1, 1, n), or channel by
 * channel in runs. A mantissa m represents the middle of the values that were rounded down to it, (m + 1/2) 2^(e -
 * 136). PFM (Debevec): two or three lines of text and floats, rows from the bottom. Every length is checked against the
 * remaining bytes before it is used. */
#include "image/float_read_internal.h"

#include "base/mem.h"
#include "image/levels.h"
#include "math/portable.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINE_LIMIT = 512, HEADER_LINES = 1000, PIXELS_PER_BYTE = 64 };

struct reading {
    const char *path;
    const uint8_t *data;
    size_t size, at;
    struct error *error;
};

static bool report_error(struct reading *r, const char *what) {
    return error_set(r->error, ERROR_SCENE, "%s: %s (before byte %zu)", r->path, what, r->at);
}

/* The next line without its end; false if there is none, or it is too long. */
static bool next_line(struct reading *r, char line[LINE_LIMIT]) {
    size_t length = 0;
    while (r->at + length < r->size && r->data[r->at + length] != '\n')
        length++;
    if (length >= LINE_LIMIT || r->at + length >= r->size)
        return false;
    memcpy(line, r->data + r->at, length);
    r->at += length + 1;
    length -= length > 0 && line[length - 1] == '\r';
    line[length] = '\0';
    return memchr(line, 0, length) == NULL;
}

/* The sides have at most nine digits; those that are 0 or too large are refused with the messages for all images. */
static struct image *allocate(struct reading *r, unsigned long long width, unsigned long long height) {
    if (width > 0 && height > 0 && width <= IMAGE_MAX_SIDE && height <= IMAGE_MAX_SIDE &&
        width * height / PIXELS_PER_BYTE > r->size) {
        report_error(r, "the file is too short for its pixels");
        return NULL;
    }
    assert(width <= UINT32_MAX && height <= UINT32_MAX);
    return image_allocate(r->path, (uint32_t)width, (uint32_t)height, 32, r->error);
}

static struct image *finish(struct reading *r, struct image *image, bool ok) {
    if (!ok) {
        image_release(image);
        return NULL;
    }
    bool built = image_build_levels(image, r->error);
    assert(built); /* floats take no memory for it */
    (void)built;
    return image;
}

static float bounded(double light) {
    return light > 0 ? (float)math_min(light, FLT_MAX) : 0; /* NaN too */
}

/* --- Radiance --- */

struct hdr_header {
    double factor; /* radiance of one unit of the file */
    unsigned long long width, height;
    bool from_below, from_right;
};

/* "-Y 480 +X 640" */
static bool hdr_size(struct reading *r, const char *line, struct hdr_header *header) {
    char sign_y, sign_x, letter_y, letter_x, rest;
    unsigned long long y, x;
    bool negative = false; /* which sscanf would read as a large number */
    for (const char *p = line; *p; p++)
        negative = negative || ((*p == '-' || *p == '+') && p[1] >= '0' && p[1] <= '9');
    if (negative || strspn(line, "+-XY0123456789 ") != strlen(line) ||
        sscanf(line, "%c%c %9llu %c%c %9llu %c", &sign_y, &letter_y, &y, &sign_x, &letter_x, &x, &rest) != 6)
        return report_error(r, "the line with the size of a Radiance picture cannot be read");
    if (letter_y != 'Y' || letter_x != 'X')
        return report_error(r, "Radiance pictures whose columns come first are not read");
    header->width = x;
    header->height = y;
    header->from_below = sign_y == '+';
    header->from_right = sign_x == '-';
    return true;
}

static bool hdr_read_header(struct reading *r, struct hdr_header *header) {
    char line[LINE_LIMIT];
    *header = (struct hdr_header){.factor = 1};
    bool known = false;
    for (int i = 0; i < HEADER_LINES; i++) {
        if (!next_line(r, line))
            return report_error(r, "the header of a Radiance picture has no end");
        /* An empty line ends the header; the size follows. */
        if (line[0] == '\0') {
            if (!known)
                return report_error(r, "a Radiance picture must say FORMAT=32-bit_rle_rgbe");
            return next_line(r, line) ? hdr_size(r, line, header) : report_error(r, "a Radiance picture has no size");
        }
        if (strncmp(line, "FORMAT=", 7) == 0) {
            known = strcmp(line + 7, "32-bit_rle_rgbe") == 0;
            if (!known)
                return report_error(r, "only Radiance pictures of FORMAT=32-bit_rle_rgbe are read");
        } else if (strncmp(line, "EXPOSURE=", 9) == 0) {
            /* Exposures multiply; the picture is divided by all of them. */
            double exposure = strtod(line + 9, NULL);
            if (!(exposure >= 1e-30 && exposure <= 1e30))
                return report_error(r, "the EXPOSURE of a Radiance picture must be above 0");
            header->factor /= exposure;
        }
    }
    return report_error(r, "the header of a Radiance picture has no end");
}

/* One row channel by channel, the four bytes of its mark already read. */
static bool hdr_read_runs(struct reading *r, uint8_t *row, size_t width) {
    for (size_t channel = 0; channel < 4; channel++) {
        for (size_t x = 0; x < width;) {
            if (r->at >= r->size)
                return report_error(r, "a Radiance picture ends early");
            size_t count = r->data[r->at++];
            bool run = count > 128;
            count -= run ? 128 : 0;
            if (count == 0 || count > width - x)
                return report_error(r, "a run in a Radiance picture is longer than its row");
            if (r->size - r->at < (run ? 1 : count))
                return report_error(r, "a Radiance picture ends early");
            for (size_t i = 0; i < count; i++)
                row[4 * (x + i) + channel] = r->data[r->at + (run ? 0 : i)];
            r->at += run ? 1 : count;
            x += count;
        }
    }
    return true;
}

/* One row of pixels; (1, 1, 1, n) repeats the previous one n times; each directly following mark counts 256 times as
 * much. */
static bool hdr_read_flat(struct reading *r, uint8_t *row, size_t width) {
    unsigned shift = 0;
    for (size_t x = 0; x < width;) {
        if (r->size - r->at < 4)
            return report_error(r, "a Radiance picture ends early");
        const uint8_t *p = r->data + r->at;
        r->at += 4;
        if (p[0] != 1 || p[1] != 1 || p[2] != 1) {
            memcpy(row + 4 * x++, p, 4);
            shift = 0;
            continue;
        }
        size_t count = shift < 24 ? (size_t)p[3] << shift : SIZE_MAX;
        if (x == 0 || count > width - x)
            return report_error(r, "a run in a Radiance picture is longer than its row");
        for (size_t i = 0; i < count; i++, x++)
            memcpy(row + 4 * x, row + 4 * x - 4, 4);
        shift += 8;
    }
    return true;
}

static bool hdr_read_row(struct reading *r, uint8_t *row, size_t width) {
    const uint8_t *mark = r->data + r->at;
    if (width < 8 || width > 0x7fff || r->size - r->at < 4 || mark[0] != 2 || mark[1] != 2 || mark[2] > 127)
        return hdr_read_flat(r, row, width);
    if ((size_t)mark[2] << 8 != (width & 0xff00) || mark[3] != (width & 0xff))
        return report_error(r, "a row of a Radiance picture has another width");
    r->at += 4;
    return hdr_read_runs(r, row, width);
}

static void hdr_store(const uint8_t *row, size_t width, const struct hdr_header *header, float *out) {
    for (size_t x = 0; x < width; x++) {
        const uint8_t *p = row + 4 * (header->from_right ? width - 1 - x : x);
        double unit = p[3] ? math_ldexp(header->factor, (int)p[3] - 136) : 0;
        for (size_t i = 0; i < 3; i++)
            out[4 * x + i] = bounded((p[i] + 0.5) * unit);
        out[4 * x + 3] = 1;
    }
}

bool hdr_is(const uint8_t *data, size_t size) {
    return size >= 2 && data[0] == '#' && data[1] == '?';
}

struct image *image_parse_hdr(const char *path, const uint8_t *data, size_t size, struct error *error) {
    struct reading r = {path, data, size, 0, error};
    struct hdr_header header;
    if (!hdr_read_header(&r, &header))
        return NULL;
    struct image *image = allocate(&r, header.width, header.height);
    if (!image)
        return NULL;
    size_t width = (size_t)header.width, height = (size_t)header.height;
    uint8_t *row = mem_alloc(width * 4);
    bool ok = row || error_no_memory(error, path);
    for (size_t y = 0; ok && y < height; y++) {
        size_t at = header.from_below ? height - 1 - y : y;
        ok = hdr_read_row(&r, row, width);
        if (ok)
            hdr_store(row, width, &header, (float *)image->levels[0].texels + at * width * 4);
    }
    mem_free(row);
    return finish(&r, image, ok);
}

/* --- PFM --- */

bool pfm_is(const uint8_t *data, size_t size) {
    return size >= 3 && data[0] == 'P' && (data[1] == 'F' || data[1] == 'f') &&
           (data[2] == '\n' || data[2] == ' ' || data[2] == '\r');
}

static bool is_space(uint8_t c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

/* Comments reach from # to the end of the line. */
static void skip_space(struct reading *r) {
    while (r->at < r->size && (is_space(r->data[r->at]) || r->data[r->at] == '#')) {
        const uint8_t *start = r->data + r->at, *end = start;
        if (*start == '#')
            end = memchr(start, '\n', r->size - r->at);
        r->at += end ? (size_t)(end - start) + 1 : r->size - r->at;
    }
}

/* The next word of the header and the one white-space byte after it, or CR LF. */
static bool next_word(struct reading *r, char word[64]) {
    size_t length = 0;
    skip_space(r);
    while (r->at < r->size && length < 63 && !is_space(r->data[r->at]))
        word[length++] = (char)r->data[r->at++];
    word[length] = '\0';
    if (length == 0 || r->at >= r->size || !is_space(r->data[r->at]))
        return false;
    r->at += r->size - r->at > 1 && memcmp(r->data + r->at, "\r\n", 2) == 0 ? 2 : 1;
    return true;
}

static bool pfm_side(struct reading *r, unsigned long long *side) {
    char word[64];
    if (!next_word(r, word) || strspn(word, "0123456789") != strlen(word) || strlen(word) > 9)
        return report_error(r, "the size of a PFM picture cannot be read");
    *side = strtoull(word, NULL, 10);
    return true;
}

static float float_at(const uint8_t *bytes, bool little) {
    uint32_t bits = 0;
    float value;
    for (int i = 0; i < 4; i++)
        bits |= (uint32_t)bytes[little ? i : 3 - i] << 8 * i;
    memcpy(&value, &bits, sizeof value);
    return value;
}

struct image *image_parse_pfm(const char *path, const uint8_t *data, size_t size, struct error *error) {
    struct reading r = {path, data, size, 3, error};
    size_t channels = data[1] == 'F' ? 3 : 1;
    unsigned long long width = 0, height = 0;
    char word[64], *end;
    if (!pfm_side(&r, &width) || !pfm_side(&r, &height))
        return NULL;
    double scale = next_word(&r, word) ? strtod(word, &end) : 0;
    if (!(fabs(scale) >= 1e-30 && fabs(scale) <= 1e30) || *end != '\0') {
        report_error(&r, "the scale of a PFM picture cannot be read");
        return NULL;
    }
    if (width <= IMAGE_MAX_SIDE && height <= IMAGE_MAX_SIDE && (size - r.at) / (4 * channels) < width * height) {
        report_error(&r, "the file is too short for its pixels");
        return NULL;
    }
    struct image *image = allocate(&r, width, height);
    if (!image)
        return NULL;
    /* PFM files begin with the bottom row. A negative scale means little-endian numbers. */
    for (size_t y = 0; y < height; y++) {
        float *out = (float *)image->levels[0].texels + (size_t)(height - 1 - y) * (size_t)width * 4;
        for (size_t x = 0; x < width; x++) {
            const uint8_t *pixel = data + r.at + 4 * channels * (y * (size_t)width + x);
            for (size_t i = 0; i < 3; i++)
                out[4 * x + i] =
                    bounded((double)float_at(pixel + (channels == 3 ? 4 * i : 0), scale < 0) * fabs(scale));
            out[4 * x + 3] = 1;
        }
    }
    return finish(&r, image, true);
}
