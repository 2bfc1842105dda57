/* JPEG in ("Information technology - Digital compression and coding of continuous-tone still images", ITU-T T.81).
 *
 * libjpeg reports errors by a callback that must not return: it jumps. So one struct reader in image_parse_jpeg owns
 * everything that must be freed, and decode, the function with the setjmp, has no local variables that change after it.
 * libjpeg only warns of truncated data and unknown codes; they mean missing or wrong texels, so here they are errors.
 * Sizes that the bytes of the file cannot fill are refused before memory is allocated: a block of 64 texels needs at
 * least a bit. The scans of a progressive file are limited. */
#include "image/jpeg_read.h"

#ifndef HAVE_JPEG

struct image *image_parse_jpeg(const char *path, const uint8_t *data, size_t size, struct error *error) {
    (void)data, (void)size;
    error_set(error, ERROR_SCENE, "%s: this is a JPEG, which this build cannot read (it was made without libjpeg)",
              path);
    return NULL;
}

const char *jpeg_library(void) {
    return "none";
}

#else

#include "base/mem.h"
#include "image/levels.h"

#include <assert.h>
#include <setjmp.h>
#include <stdio.h>
#include <string.h>

/* These come last: jpeglib.h needs stdio.h. */
#include <jerror.h>
#include <jpeglib.h>

enum { SCAN_LIMIT = 200, TEXELS_PER_BYTE = 1024 };

#define TEXT_OF(x) #x
#define TEXT(x) TEXT_OF(x)

struct reader {
    struct jpeg_error_mgr errors; /* first, so that cinfo->err leads here */
    struct jpeg_progress_mgr progress;
    struct jpeg_decompress_struct jpeg;
    jmp_buf back;
    char message[JMSG_LENGTH_MAX];
    int code;
    const char *path;
    size_t size;
    uint64_t reserved; /* for libjpeg's own memory, which is not from mem.h */
    struct image *image;
};

static _Noreturn void on_error(j_common_ptr jpeg) {
    struct reader *reader = (struct reader *)(void *)jpeg->err;
    reader->code = jpeg->err->msg_code;
    jpeg->err->format_message(jpeg, reader->message);
    longjmp(reader->back, 1);
}

static void on_message(j_common_ptr jpeg, int level) {
    int code = jpeg->err->msg_code;
    bool harmless = code == JWRN_EXTRANEOUS_DATA || code == JWRN_JFIF_MAJOR || code == JWRN_ADOBE_XFORM;
    if (level < 0 && !harmless)
        on_error(jpeg);
}

static void on_progress(j_common_ptr jpeg) {
    if (((j_decompress_ptr)jpeg)->input_scan_number > SCAN_LIMIT) {
        struct reader *reader = (struct reader *)(void *)jpeg->err;
        (void)snprintf(reader->message, sizeof reader->message, "more than %d scans", SCAN_LIMIT);
        longjmp(reader->back, 1);
    }
}

/* Converts libjpeg's output, 1, 3 or 4 bytes per texel, to RGBA; the row may be at the end of its own target. */
static __attribute__((noinline)) void to_rgba(const uint8_t *from, int components, uint32_t width, uint8_t *to) {
    for (uint32_t x = 0; x < width; x++, from += components, to += 4) {
        uint8_t c[4] = {from[0], components > 1 ? from[1] : from[0], components > 1 ? from[2] : from[0], 255};
        if (components == 4) /* CMYK as commonly written: 255 is no ink */
            for (int k = 0; k < 3; k++)
                c[k] = (uint8_t)((c[k] * from[3] + 127) / 255);
        memcpy(to, c, 4);
    }
}

/* The memory of libjpeg: rows of samples in several stages, and all coefficients of a picture with several scans. */
static uint64_t library_memory(struct jpeg_decompress_struct *jpeg) {
    enum { STAGES = 8 };
    uint64_t rows = (uint64_t)jpeg->max_v_samp_factor * DCTSIZE, bytes = 0;
    for (int i = 0; i < jpeg->num_components; i++) {
        const jpeg_component_info *component = &jpeg->comp_info[i];
        /* Rounded up to complete groups of blocks. */
        uint64_t wide = component->width_in_blocks + (uint64_t)component->h_samp_factor;
        uint64_t high = component->height_in_blocks + (uint64_t)component->v_samp_factor;
        bytes += wide * DCTSIZE * rows * STAGES;
        bytes += jpeg_has_multiple_scans(jpeg) ? wide * high * sizeof(JBLOCK) : 0;
    }
    return bytes;
}

/* Every error leaves this function through on_error. */
static bool decode_to_the_end(struct reader *reader, const uint8_t *data, struct error *error) {
    struct jpeg_decompress_struct *const jpeg = &reader->jpeg;
    jpeg_create_decompress(jpeg);
    jpeg->progress = &reader->progress;
    jpeg_mem_src(jpeg, data, (unsigned long)reader->size);
    (void)jpeg_read_header(jpeg, TRUE);
    uint32_t const width = jpeg->image_width, height = jpeg->image_height;
    if (width > IMAGE_MAX_SIDE || height > IMAGE_MAX_SIDE || (uint64_t)width * height > IMAGE_MAX_TEXELS)
        return error_set(error, ERROR_SCENE, "%s: %u x %u pixels are too many (at most %d a side and %d in all)",
                         reader->path, width, height, IMAGE_MAX_SIDE, IMAGE_MAX_TEXELS);
    if ((uint64_t)width * height > reader->size * (uint64_t)TEXELS_PER_BYTE) {
        (void)snprintf(reader->message, sizeof reader->message, "the file is too short for %u x %u pixels", width,
                       height);
        return false;
    }
    if (jpeg->jpeg_color_space == JCS_CMYK || jpeg->jpeg_color_space == JCS_YCCK)
        jpeg->out_color_space = JCS_CMYK;
    else if (jpeg->jpeg_color_space != JCS_GRAYSCALE)
        jpeg->out_color_space = JCS_RGB;
    jpeg->dct_method = JDCT_ISLOW;
    uint64_t needed = library_memory(jpeg);
    if (!mem_reserve(needed))
        return error_no_memory(error, reader->path);
    reader->reserved = needed;
    (void)jpeg_start_decompress(jpeg);
    int const components = jpeg->output_components;
    assert(components == 1 || components == 3 || components == 4); /* as the colour space was chosen above */
    reader->image = image_allocate(reader->path, width, height, 8, error);
    if (!reader->image)
        return false;
    while (jpeg->output_scanline < height) {
        uint8_t *target = (uint8_t *)reader->image->levels[0].texels + (size_t)jpeg->output_scanline * width * 4;
        /* At the end of its target: expansion from the front never overwrites unread data. */
        JSAMPROW row = target + (size_t)width * (size_t)(4 - components);
        (void)jpeg_read_scanlines(jpeg, &row, 1);
        to_rgba(row, components, width, target);
    }
    (void)jpeg_finish_decompress(jpeg);
    return true;
}

static bool decode(struct reader *reader, const uint8_t *data, struct error *error) {
    if (setjmp(reader->back))
        return false;
    return decode_to_the_end(reader, data, error);
}

struct image *image_parse_jpeg(const char *path, const uint8_t *data, size_t size, struct error *error) {
    struct reader reader = {.path = path, .size = size};
    reader.jpeg.err = jpeg_std_error(&reader.errors);
    reader.errors.error_exit = on_error;
    reader.errors.emit_message = on_message;
    reader.progress.progress_monitor = on_progress;
    error->kind = ERROR_NONE;
    bool ok = decode(&reader, data, error);
    if (!ok && error->kind == ERROR_NONE) {
        if (reader.code == JERR_OUT_OF_MEMORY)
            error_no_memory(error, path);
        else if (reader.code == JWRN_JPEG_EOF)
            error_set(error, ERROR_SCENE,
                      "%s: truncated JPEG: the file ends at byte %zu, before the picture is complete", path, size);
        else {
            size_t left = reader.jpeg.src ? reader.jpeg.src->bytes_in_buffer : 0; /* of an empty file */
            assert(left <= size); /* no more than there is, or the two bytes of an artificial end */
            error_set(error, ERROR_SCENE, "%s: broken JPEG: %s (before byte %zu)", path, reader.message, size - left);
        }
    }
    jpeg_destroy_decompress(&reader.jpeg);
    mem_unreserve(reader.reserved);
    ok = ok && image_build_levels(reader.image, error);
    if (ok)
        return reader.image;
    image_release(reader.image);
    return NULL;
}

const char *jpeg_library(void) {
#ifdef LIBJPEG_TURBO_VERSION
    return "libjpeg-turbo " TEXT(LIBJPEG_TURBO_VERSION);
#else
    return "libjpeg " TEXT(JPEG_LIB_VERSION);
#endif
}

#endif
