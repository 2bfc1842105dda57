/* Half blocks: U+2580, with the foreground colour in its upper half and the background colour in its lower half.
 * Sixels: six rows at a time, for each of 6 x 6 x 6 colours one pass over the row; an ordered dither (Bayer) hides the
 * small number of colours. */
#define _GNU_SOURCE
#include "output/terminal.h"

#include "base/bytes.h"
#include "base/mem.h"
#include "image/png_write.h"
#include "session/standard_streams.h"

#include <math.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

enum { KITTY_PIECE = 4096 /* characters of base64 in a command */, PIXELS_MAX = 1600 };

static bool variable_has(const char *name, const char *word) {
    const char *value = getenv(name);
    return value && strstr(value, word);
}

/* The reply to a request for the terminal's attributes contains 4 if it draws sixels. */
static bool answers_sixel(void) {
    struct termios before, raw;
    char answer[64];
    size_t used = 0;
    if (!isatty(STDIN_FILENO) || !isatty(STDOUT_FILENO) || tcgetattr(STDIN_FILENO, &before) != 0)
        return false;
    raw = before;
    raw.c_lflag &= (tcflag_t) ~(ICANON | ECHO);
    (void)tcsetattr(STDIN_FILENO, TCSANOW, &raw);
    (void)fputs("\033[c", standard_output());
    (void)fflush(standard_output());
    struct pollfd in = {.fd = STDIN_FILENO, .events = POLLIN};
    while (used + 1 < sizeof answer && poll(&in, 1, 150) > 0 && read(STDIN_FILENO, answer + used, 1) == 1)
        if (answer[used++] == 'c')
            break;
    (void)tcsetattr(STDIN_FILENO, TCSANOW, &before);
    answer[used] = '\0';
    return strstr(answer, ";4;") || strstr(answer, ";4c");
}

void terminal_open(struct terminal *terminal, enum terminal_graphics wanted) {
    struct winsize size = {0};
    *terminal = (struct terminal){.graphics = wanted,
                                  .columns = 80,
                                  .lines = 24,
                                  .cell_width = 8,
                                  .cell_height = 16,
                                  .moves = isatty(STDOUT_FILENO)};
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 && size.ws_row > 0) {
        terminal->columns = size.ws_col;
        terminal->lines = size.ws_row;
        if (size.ws_xpixel >= size.ws_col && size.ws_ypixel >= size.ws_row) {
            terminal->cell_width = size.ws_xpixel / size.ws_col;
            terminal->cell_height = size.ws_ypixel / size.ws_row;
        }
    }
    if (wanted != TERMINAL_AUTO)
        return;
    bool kitty =
        terminal->moves && (getenv("KITTY_WINDOW_ID") || variable_has("TERM", "kitty") ||
                            variable_has("TERM_PROGRAM", "ghostty") || variable_has("TERM_PROGRAM", "WezTerm"));
    terminal->graphics = kitty ? TERMINAL_KITTY : answers_sixel() ? TERMINAL_SIXEL : TERMINAL_BLOCKS;
}

void terminal_begin(struct terminal *terminal) {
    terminal->rows = 0;
}

void terminal_blocks(FILE *stream, const uint8_t *rgb, uint32_t width, uint32_t height) {
    for (uint32_t y = 0; y < height; y += 2) {
        for (uint32_t x = 0; x < width; x++) {
            const uint8_t *up = rgb + ((size_t)y * width + x) * 3, *down = up + (size_t)width * 3;
            (void)fprintf(stream, "\033[38;2;%d;%d;%d", up[0], up[1], up[2]);
            if (y + 1 < height)
                (void)fprintf(stream, ";48;2;%d;%d;%d", down[0], down[1], down[2]);
            (void)fputs("m\342\226\200", stream);
        }
        (void)fputs("\033[0m\n", stream);
    }
}

static void put_base64(FILE *stream, const uint8_t *bytes, size_t size) {
    char four[4];
    for (size_t i = 0; i < size; i += 3) {
        bytes_base64(bytes + i, size - i, four);
        (void)fwrite(four, 1, sizeof four, stream);
    }
}

void terminal_kitty(FILE *stream, const uint8_t *rgb, uint32_t width, uint32_t height, int columns, int rows) {
    size_t size = (size_t)width * height * 3, piece = KITTY_PIECE / 4 * 3;
    for (size_t at = 0; at < size; at += piece) {
        bool more = size - at > piece;
        if (at == 0)
            (void)fprintf(stream, "\033_Ga=T,q=2,f=24,i=1,p=1,C=1,s=%u,v=%u,c=%d,r=%d,m=%d;", width, height, columns,
                          rows, more);
        else
            (void)fprintf(stream, "\033_Gq=2,m=%d;", more);
        put_base64(stream, rgb + at, more ? piece : size - at);
        (void)fputs("\033\\", stream);
    }
    for (int i = 0; i < rows; i++)
        (void)fputc('\n', stream);
}

/* The one of 6 levels that shows a byte at this pixel: the fraction is compared with the threshold of the pixel. */
static int dithered(int byte, uint32_t x, uint32_t y) {
    static const int bayer[4][4] = {{0, 8, 2, 10}, {12, 4, 14, 6}, {3, 11, 1, 9}, {15, 7, 13, 5}};
    int scaled = byte * 5, step = scaled / 255, rest = scaled % 255;
    return step + (rest * 16 > (bayer[y & 3][x & 3] * 255 + 127) ? 1 : 0);
}

static int sixel_colour(const uint8_t *pixel, uint32_t x, uint32_t y) {
    return 36 * dithered(pixel[0], x, y) + 6 * dithered(pixel[1], x, y) + dithered(pixel[2], x, y);
}

static void sixel_run(FILE *stream, int bits, uint32_t length) {
    if (length > 3)
        (void)fprintf(stream, "!%u%c", length, '?' + bits);
    else
        for (uint32_t i = 0; i < length; i++)
            (void)fputc('?' + bits, stream);
}

static void sixel_band(FILE *stream, const uint8_t *rgb, uint32_t width, uint32_t height, uint32_t top) {
    uint32_t rows = height - top < 6 ? height - top : 6;
    bool used[216] = {false};
    /* Only colours of the band are printed. */
    for (uint32_t k = 0; k < rows; k++)
        for (uint32_t x = 0; x < width; x++)
            used[sixel_colour(rgb + ((size_t)(top + k) * width + x) * 3, x, top + k)] = true;
    for (int colour = 0; colour < 216; colour++) {
        int before = 0;
        uint32_t length = 0;
        if (!used[colour])
            continue;
        (void)fprintf(stream, "#%d", colour);
        /* Runs of equal columns; bit k is the pixel of row k. */
        for (uint32_t x = 0; x < width; x++) {
            int bits = 0;
            for (uint32_t k = 0; k < rows; k++)
                bits |= (sixel_colour(rgb + ((size_t)(top + k) * width + x) * 3, x, top + k) == colour) << k;
            if (bits != before) {
                sixel_run(stream, before, length);
                before = bits;
                length = 0;
            }
            length++;
        }
        if (before)
            sixel_run(stream, before, length);
        (void)fputc('$', stream);
    }
    (void)fputc('-', stream);
}

void terminal_sixel(FILE *stream, const uint8_t *rgb, uint32_t width, uint32_t height) {
    (void)fprintf(stream, "\033P0;1q\"1;1;%u;%u", width, height);
    for (int i = 0; i < 216; i++) /* percents */
        (void)fprintf(stream, "#%d;2;%d;%d;%d", i, i / 36 * 20, i / 6 % 6 * 20, i % 6 * 20);
    for (uint32_t top = 0; top < height; top += 6)
        sixel_band(stream, rgb, width, height, top);
    (void)fputs("\033\\\n", stream);
}

/* The largest size with the picture's aspect ratio within these limits, at least 1 x 1. */
static void fit(const struct film *film, double widest, double highest, uint32_t *width, uint32_t *height) {
    double scale = math_min(1, math_min(widest / film->width, highest / film->height));
    *width = (uint32_t)math_max(1, floor(film->width * scale));
    *height = (uint32_t)math_max(1, floor(film->height * scale));
}

void terminal_draw(struct terminal *terminal, const struct film *film, const struct tone *tone) {
    uint32_t width, height;
    double lines = terminal->lines > 3 ? terminal->lines - 2 : 1;
    bool blocks = terminal->graphics == TERMINAL_BLOCKS;
    double across = blocks ? terminal->columns : terminal->columns * terminal->cell_width;
    double down = blocks ? 2 * lines : lines * terminal->cell_height;
    /* As large as the window allows with two lines for the progress. */
    fit(film, math_min(across, PIXELS_MAX), math_min(down, PIXELS_MAX), &width, &height);
    uint8_t *rgb = mem_alloc_zero((size_t)width * height, 3);
    if (!rgb)
        return;
    film_shrink(film, tone, width, height, rgb);
    /* A later pass goes over the earlier one. */
    int per_row = blocks ? 2 : terminal->cell_height, rows = ((int)height + per_row - 1) / per_row;
    if (terminal->moves && terminal->rows > 0)
        (void)printf("\033[%dA\r", terminal->rows);
    if (blocks)
        terminal_blocks(standard_output(), rgb, width, height);
    else if (terminal->graphics == TERMINAL_KITTY)
        terminal_kitty(standard_output(), rgb, width, height,
                       ((int)width + terminal->cell_width - 1) / terminal->cell_width, rows);
    else
        terminal_sixel(standard_output(), rgb, width, height);
    (void)fflush(standard_output());
    terminal->rows = rows;
    mem_free(rgb);
}
