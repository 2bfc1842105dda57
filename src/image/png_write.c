/* PNG out, through libpng. As in png_read.c, what must be given back lives in a struct outside the function with the
 * setjmp. The bytes depend on the pixels alone: no time chunk, fixed filters, level and strategy. */
#include "image/png_write.h"

#include "base/file.h"
#include "base/mem.h"

#include <math.h>
#include <png.h>
#include <setjmp.h>
#include <stdio.h>

/* Measured on a picture of 1280 x 960 with spheres, floor and gradient sky (size, time of one core): these settings
 * 350 kB in 0.055 s, all five filters 366 kB in 0.073 s, level 9 327 kB in 0.30 s, level 1 479 kB in 0.02 s. */
enum { FILTERS = PNG_FILTER_SUB | PNG_FILTER_UP, LEVEL = 6, MEMORY_LEVEL = 9, STRATEGY = 0, OUTPUT_BUFFER = 1 << 16 };

struct writer {
    const char *path;
    struct file_output output;
    struct error *error; /* set by output failures before the longjmp */
    bool out_of_memory;
    char message[160];
    png_structp png;
    png_infop info;
    uint8_t *line;
    int bits;        /* 8 or 16 */
    uint16_t *words; /* of a row, with 16 bits */
    void (*rows_16)(void *context, uint32_t y, uint16_t *line);
};

/* PNG has the upper byte first. */
static void row_of_words(struct writer *writer, void *context, uint32_t width, uint32_t y) {
    writer->rows_16(context, y, writer->words);
    for (size_t i = 0; i < (size_t)width * 3; i++) {
        writer->line[2 * i] = (uint8_t)(writer->words[i] >> 8);
        writer->line[2 * i + 1] = (uint8_t)writer->words[i];
    }
}

static void on_write(png_structp png, png_bytep data, size_t size) {
    struct writer *writer = png_get_io_ptr(png);
    if (!file_output_write(&writer->output, data, size, writer->error))
        png_error(png, "write error");
}

/* Everything is flushed by the commit. */
static void on_flush(png_structp png) {
    (void)png;
}

static void on_error(png_structp png, png_const_charp message) {
    struct writer *writer = png_get_error_ptr(png);
    (void)snprintf(writer->message, sizeof writer->message, "%s", message);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message) {
    (void)png, (void)message;
}

static png_voidp on_alloc(png_structp png, png_alloc_size_t size) {
    struct writer *writer = png_get_mem_ptr(png);
    void *block = mem_alloc(size);
    writer->out_of_memory |= block == NULL;
    return block;
}

static void on_free(png_structp png, png_voidp block) {
    (void)png;
    mem_free(block);
}

static bool encode(struct writer *writer, uint32_t width, uint32_t height,
                   void (*rows)(void *context, uint32_t y, uint8_t *line), void *context) {
    if (setjmp(png_jmpbuf(writer->png)))
        return false;
    png_structp const png = writer->png;
    png_set_write_fn(png, writer, on_write, on_flush);
    png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_set_compression_buffer_size(png, OUTPUT_BUFFER);
    png_set_compression_level(png, LEVEL);
    png_set_compression_mem_level(png, MEMORY_LEVEL);
    png_set_compression_strategy(png, STRATEGY);
    png_set_filter(png, PNG_FILTER_TYPE_BASE, FILTERS);
    png_set_IHDR(png, writer->info, width, height, writer->bits, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, writer->info);
    for (uint32_t y = 0; y < height; y++) {
        if (rows)
            rows(context, y, writer->line);
        else
            row_of_words(writer, context, width, y);
        png_write_row(png, writer->line);
    }
    png_write_end(png, writer->info);
    return true;
}

static bool write_file(const char *path, uint32_t width, uint32_t height,
                       void (*rows)(void *context, uint32_t y, uint8_t *line),
                       void (*rows_16)(void *context, uint32_t y, uint16_t *line), void *context, struct error *error) {
    if (width == 0 || height == 0 || width > PNG_UINT_31_MAX / 8 || height > PNG_UINT_31_MAX)
        return error_set(error, ERROR_SCENE, "%s: a PNG file cannot have %u x %u pixels", path, width, height);
    struct writer writer = {.path = path, .error = error, .bits = rows_16 ? 16 : 8, .rows_16 = rows_16};
    if (!file_output_open(&writer.output, path, error))
        return false;
    error->kind = ERROR_NONE;
    writer.line = mem_alloc((size_t)width * 3 * (rows_16 ? 2 : 1));
    writer.words = rows_16 ? mem_alloc_zero((size_t)width * 3, sizeof *writer.words) : NULL;
    writer.png = writer.line && (writer.words || !rows_16)
                     ? png_create_write_struct_2(PNG_LIBPNG_VER_STRING, &writer, on_error, on_warning, &writer,
                                                 on_alloc, on_free)
                     : NULL;
    writer.info = writer.png ? png_create_info_struct(writer.png) : NULL;
    bool ok = writer.info != NULL && encode(&writer, width, height, rows, context);
    if (!ok && error->kind == ERROR_NONE) {
        if (writer.out_of_memory || !writer.info)
            error_no_memory(error, path);
        else
            error_set(error, ERROR_MACHINE, "%s: cannot be written: %s", path, writer.message);
    }
    png_destroy_write_struct(&writer.png, &writer.info);
    mem_free(writer.line);
    mem_free(writer.words);
    if (!ok) {
        file_output_abandon(&writer.output);
        return false;
    }
    return file_output_commit(&writer.output, error);
}

bool png_write(const char *path, uint32_t width, uint32_t height,
               void (*rows)(void *context, uint32_t y, uint8_t *line), void *context, struct error *error) {
    return write_file(path, width, height, rows, NULL, context, error);
}

bool png_write_16(const char *path, uint32_t width, uint32_t height,
                  void (*rows)(void *context, uint32_t y, uint16_t *line), void *context, struct error *error) {
    return write_file(path, width, height, NULL, rows, context, error);
}

uint8_t png_write_byte(double c) {
    if (!(c > 0))
        return 0;
    return c < 1 ? (uint8_t)floor(255 * c + 0.5) : 255;
}
