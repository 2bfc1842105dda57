/* Writes the pixels of a PNG file: a line with width, height, channels and bits, and the rows from above, without what
 * depends on the version of zlib. For tools/picture_hashes.sh, which compiles it. Usage: pixels FILE.png */
#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>

int main(int count, char **words) {
    FILE *file = count == 2 ? fopen(words[1], "rb") : NULL;
    png_structp png = file ? png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL) : NULL;
    png_infop info = png ? png_create_info_struct(png) : NULL;
    if (!info || setjmp(png_jmpbuf(png))) {
        (void)fprintf(stderr, "pixels: %s cannot be read\n", count == 2 ? words[1] : "no file");
        return 1;
    }
    png_init_io(png, file);
    png_read_png(png, info, PNG_TRANSFORM_EXPAND, NULL);
    size_t size = png_get_rowbytes(png, info);
    png_uint_32 height = png_get_image_height(png, info);
    (void)printf("%u %u %u %u\n", png_get_image_width(png, info), height, png_get_channels(png, info),
                 png_get_bit_depth(png, info));
    for (png_uint_32 y = 0; y < height; y++)
        (void)fwrite(png_get_rows(png, info)[y], 1, size, stdout);
    return ferror(stdout) != 0;
}
