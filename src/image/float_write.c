/* PFM stores the floats unchanged. Radiance pictures have 8 bits a channel and a common exponent; each row is coded
 * channel by channel in runs (more than 2 equal bytes) and literal stretches, as the Radiance file format reference
 * says for widths from 8 to 32767; other widths are written flat. */
#include "image/float_write.h"

#include "base/mem.h"
#include "math/portable.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { HDR_MIN = 8, HDR_MAX = 32767, RUN_MIN = 3, RUN_MAX = 127, LITERAL_MAX = 128 };

struct writing {
    struct file_output output;
    float *line;
    uint8_t *bytes, *coded;
};

static bool begin(struct writing *writing, const struct file_target *target, uint32_t width, struct error *error) {
    *writing = (struct writing){0};
    if (!file_output_open(&writing->output, target, error))
        return false;
    size_t channels = (size_t)width * 3;
    writing->line = mem_alloc_zero(channels, sizeof *writing->line);
    writing->bytes = mem_alloc_zero((size_t)width, 4 * sizeof(float)); /* either format's row */
    writing->coded = mem_alloc_zero((size_t)width + 64, 8);            /* literals cost one more byte per 128 */
    if (writing->line && writing->bytes && writing->coded)
        return true;
    return error_no_memory(error, target->path);
}

static bool finish(struct writing *writing, bool ok, struct error *error) {
    mem_free(writing->line);
    mem_free(writing->bytes);
    mem_free(writing->coded);
    if (!writing->output.open)
        return false;
    if (ok)
        return file_output_commit(&writing->output, error);
    file_output_abandon(&writing->output);
    return false;
}

bool pfm_write(const struct file_target *target, uint32_t width, uint32_t height, float_rows *rows, void *context,
               struct error *error) {
    struct writing writing;
    char header[64];
    bool ok = begin(&writing, target, width, error);
    int length = snprintf(header, sizeof header, "PF\n%u %u\n-1.0\n", width, height);
    ok = ok && file_output_write(&writing.output, header, (size_t)length, error);
    for (uint32_t y = height; ok && y-- > 0;) {
        rows(context, y, writing.line);
        for (size_t i = 0; i < (size_t)width * 3; i++) {
            uint32_t bits;
            memcpy(&bits, &writing.line[i], sizeof bits);
            for (size_t k = 0; k < 4; k++)
                writing.bytes[4 * i + k] = (uint8_t)(bits >> (8 * k));
        }
        ok = file_output_write(&writing.output, writing.bytes, (size_t)width * 12, error);
    }
    return finish(&writing, ok, error);
}

void hdr_pixel(const float rgb[3], uint8_t out[4]) {
    double c[3], max = 0;
    for (int i = 0; i < 3; i++) {
        c[i] = rgb[i] > 0 ? math_min((double)rgb[i], 0x1p126) : 0; /* NaN is 0, infinity the largest value */
        max = math_max(max, c[i]);
    }
    memset(out, 0, 4);
    if (max < 0x1p-126)
        return;
    int exponent;
    (void)math_frexp(max, &exponent);
    for (int i = 0; i < 3; i++)
        out[i] = (uint8_t)floor(math_ldexp(c[i], 8 - exponent));
    out[3] = (uint8_t)(exponent + 128);
}

/* One channel of a row, every fourth byte. Returns the number of bytes. */
static size_t code_channel(const uint8_t *bytes, uint32_t width, uint8_t *out) {
    size_t used = 0;
    for (uint32_t at = 0; at < width;) {
        uint32_t begun = at, run = 0;
        /* Literal bytes up to the next run that is longer than its two bytes. */
        while (at < width && at - begun < LITERAL_MAX) {
            run = 1;
            while (run < RUN_MAX && at + run < width && bytes[4 * (at + run)] == bytes[4 * at])
                run++;
            if (run >= RUN_MIN)
                break;
            at++;
            run = 0;
        }
        if (at > begun) {
            out[used++] = (uint8_t)(at - begun);
            for (uint32_t i = begun; i < at; i++)
                out[used++] = bytes[4 * i];
        }
        if (run >= RUN_MIN) {
            out[used++] = (uint8_t)(128 + run);
            out[used++] = bytes[4 * at];
            at += run;
        }
    }
    return used;
}

bool hdr_write(const struct file_target *target, uint32_t width, uint32_t height, float_rows *rows, void *context,
               struct error *error) {
    struct writing writing;
    char header[128];
    bool ok = begin(&writing, target, width, error);
    int length = snprintf(header, sizeof header, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %u +X %u\n", height, width);
    ok = ok && file_output_write(&writing.output, header, (size_t)length, error);
    for (uint32_t y = 0; ok && y < height; y++) {
        rows(context, y, writing.line);
        for (uint32_t x = 0; x < width; x++)
            hdr_pixel(writing.line + 3 * (size_t)x, writing.bytes + 4 * (size_t)x);
        if (width < HDR_MIN || width > HDR_MAX) {
            ok = file_output_write(&writing.output, writing.bytes, (size_t)width * 4, error);
            continue;
        }
        size_t used = 4;
        const uint8_t start[4] = {2, 2, (uint8_t)(width >> 8), (uint8_t)width};
        memcpy(writing.coded, start, sizeof start);
        for (int channel = 0; channel < 4; channel++)
            used += code_channel(writing.bytes + channel, width, writing.coded + used);
        ok = file_output_write(&writing.output, writing.coded, used, error);
    }
    return finish(&writing, ok, error);
}
