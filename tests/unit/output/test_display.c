/* External displays: every byte that the viewer tev receives, and the output for terminals. */
#define _GNU_SOURCE
#include "output/display.h"
#include "output/terminal.h"
#include "session/options_check.h"
#include "tests/harness.h"

#include <arpa/inet.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

/* --- a receiver instead of tev --- */

struct receiver {
    int listening, max; /* most: it closes the connection after this many bytes; 0: never */
    unsigned port;
    uint8_t *bytes;
    size_t size;
    pthread_t thread;
};

static void *receive(void *context) {
    struct receiver *r = context;
    size_t room = 1 << 16;
    int peer = accept(r->listening, NULL, NULL);
    r->bytes = malloc(room);
    for (ssize_t got; r->bytes && (got = read(peer, r->bytes + r->size, room - r->size)) > 0;) {
        r->size += (size_t)got;
        if (r->max > 0 && r->size >= (size_t)r->max)
            break;
        if (r->size == room)
            r->bytes = realloc(r->bytes, room *= 2);
    }
    (void)close(peer);
    return NULL;
}

static bool receiver_begin(struct receiver *r, int max) {
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t length = sizeof address;
    *r = (struct receiver){.max = max};
    r->listening = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    bool ok = bind(r->listening, (struct sockaddr *)&address, length) == 0 && listen(r->listening, 1) == 0 &&
              getsockname(r->listening, (struct sockaddr *)&address, &length) == 0;
    r->port = ntohs(address.sin_port);
    return ok && pthread_create(&r->thread, NULL, receive, r) == 0;
}

/* Without a client the thread still waits: connect from here. */
static void receiver_end(struct receiver *r) {
    struct sockaddr_in address = {
        .sin_family = AF_INET, .sin_port = htons((uint16_t)r->port), .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    int caller = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    (void)connect(caller, (struct sockaddr *)&address, sizeof address);
    (void)close(caller);
    (void)pthread_join(r->thread, NULL);
    (void)close(r->listening);
}

static void put_word(uint8_t **at, uint64_t word, int bytes) {
    for (int i = 0; i < bytes; i++)
        *(*at)++ = (uint8_t)(word >> (8 * i));
}

static uint32_t word_at(const uint8_t *at) {
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static const char scene[] =
    "local r = gr.node('root')\n"
    "r:add_child(gr.geometry('ball', gr.sphere(gr.material({0.8, 0.3, 0.2}, {0.5, 0.5, 0.5}, 20))))\n"
    "gr.render(r, 'out.pfm', 75, 50, {0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 40, {0.2, 0.2, 0.2},\n"
    "          {gr.light({0, 9, 9}, {1.9, 0.9, 0.9}, {1, 0, 0})})\n";

static char *read_in_folder(const char *name, size_t *size) {
    return test_read_file(test_path(name), size);
}

/* The floats of a PFM file, whose rows are stored bottom to top. */
static const float *pfm_at(const char *file, size_t size, uint32_t x, uint32_t y) {
    const char *floats = file + size - (size_t)75 * 50 * 12;
    return (const float *)(const void *)(floats + (((size_t)(49 - y) * 75) + x) * 12);
}

/* The bytes that tev must receive for a tile with corner x, y; from the description of the protocol, not from
 * display.c. */
static size_t expected_update(uint8_t *out, const char *file, size_t size, uint32_t x, uint32_t y) {
    uint32_t w = 75 - x < 32 ? 75 - x : 32, h = 50 - y < 32 ? 50 - y : 32;
    uint8_t *at = out;
    put_word(&at, 0, 4);
    put_word(&at, 6, 1);
    put_word(&at, 0, 1);
    memcpy(at, "out.pfm\0\3\0\0\0R\0G\0B", 18);
    at += 18;
    put_word(&at, x, 4);
    put_word(&at, y, 4);
    put_word(&at, w, 4);
    put_word(&at, h, 4);
    for (uint64_t c = 0; c < 3; c++)
        put_word(&at, c, 8);
    for (int c = 0; c < 3; c++)
        put_word(&at, 3, 8);
    for (uint32_t j = 0; j < h; j++)
        for (uint32_t i = 0; i < w; i++, at += 12)
            memcpy(at, pfm_at(file, size, x + i, y + j), 12);
    uint8_t *length = out;
    put_word(&length, (uint64_t)(at - out), 4);
    return (size_t)(at - out);
}

TEST(tev_gets_the_picture_and_every_tile_once_byte_for_byte) {
    static const uint8_t created[] = "\x20\0\0\0\4\1out.pfm\0\x4b\0\0\0\x32\0\0\0\3\0\0\0R\0G\0B"; /* and its NUL */
    struct receiver r;
    char arguments[100];
    CHECK(receiver_begin(&r, 0));
    (void)snprintf(arguments, sizeof arguments, "--display tev:127.0.0.1:%u scene.lua", r.port);
    struct test_result result = test_gray_scene(scene, arguments, NULL);
    receiver_end(&r);
    CHECK_EQ_INT(result.status, 0);
    CHECK_TEXT(result.err, "");
    size_t size = 0, at = sizeof created;
    char *file = read_in_folder("out.pfm", &size);
    CHECK(file && r.size > sizeof created);
    CHECK_EQ_INT(sizeof created, 0x20);
    CHECK(memcmp(r.bytes, created, sizeof created) == 0);
    bool seen[6] = {false};
    static uint8_t expected[DISPLAY_PACKET];
    int tiles = 0;
    while (file && at + 48 < r.size) {
        uint32_t length = word_at(r.bytes + at), x = word_at(r.bytes + at + 24), y = word_at(r.bytes + at + 28);
        if (x % 32 != 0 || y % 32 != 0 || x >= 75 || y >= 50 || at + length > r.size) {
            test_fail(__FILE__, __LINE__, "a packet of %u bytes for %u,%u", length, x, y);
            break;
        }
        CHECK(!seen[y / 32 * 3 + x / 32]);
        seen[y / 32 * 3 + x / 32] = true;
        CHECK_EQ_INT(length, expected_update(expected, file, size, x, y));
        CHECK(memcmp(r.bytes + at, expected, length) == 0);
        at += length;
        tiles++;
    }
    CHECK_EQ_INT(tiles, 6);
    CHECK_EQ_INT(at, r.size);
    free(file);
    free(r.bytes);
    test_free_result(&result);
}

TEST(a_viewer_that_goes_away_or_is_not_there_is_done_without) {
    struct receiver r;
    char arguments[100];
    CHECK(receiver_begin(&r, 1));
    (void)snprintf(arguments, sizeof arguments, "--size 800x600 --display tev:localhost:%u scene.lua", r.port);
    struct test_result result = test_gray_scene(scene, arguments, NULL);
    receiver_end(&r);
    CHECK_EQ_INT(result.status, 0);
    CHECK(strstr(result.err, "gray: warning: --display tev: the viewer is gone"));
    free(r.bytes);
    test_free_result(&result);
    /* A free port: no program listens there. */
    (void)snprintf(arguments, sizeof arguments, "--display tev:127.0.0.1:%u scene.lua", r.port);
    result = test_gray_scene(NULL, arguments, NULL);
    CHECK_EQ_INT(result.status, 0);
    CHECK(strstr(result.err, "gray: warning: --display tev:127.0.0.1:"));
    test_free_result(&result);
}

TEST(addresses_of_displays_are_read_or_refused) {
    struct display_choice choice;
    CHECK(display_parse("tev", &choice) && choice.kind == DISPLAY_TEV);
    CHECK_TEXT(choice.port, "14158");
    CHECK(display_parse("tev:pc", &choice));
    CHECK_TEXT(choice.host, "pc");
    CHECK(display_parse("tev:pc:99", &choice));
    CHECK_TEXT(choice.port, "99");
    CHECK(display_parse("term", &choice) && choice.graphics == TERMINAL_AUTO);
    CHECK(display_parse("term:sixel", &choice) && choice.graphics == TERMINAL_SIXEL);
    static const char *const wrong[] = {
        "", "te", "tevx", "tev:", "tev:a:", "tev:a:b", "tev:a:1:2", "term:", "term:x", "terminal"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        CHECK(!display_parse(wrong[i], &choice));
    struct test_result result = test_gray_scene(scene, "--display tivi scene.lua", NULL);
    CHECK_EQ_INT(result.status, 2);
    test_free_result(&result);
}

/* --- terminals --- */

/* The output of a function, from malloc. */
static char *printed(void (*print)(FILE *, const uint8_t *, uint32_t, uint32_t), const uint8_t *rgb, uint32_t width,
                     uint32_t height) {
    char *text = NULL;
    size_t size;
    FILE *stream = open_memstream(&text, &size);
    print(stream, rgb, width, height);
    (void)fclose(stream);
    return text;
}

static void fill(uint8_t *rgb, uint32_t width, uint32_t height) {
    for (uint32_t i = 0; i < width * height * 3; i++)
        rgb[i] = (uint8_t)(i * 7 + i / 90 * 13);
}

TEST(half_blocks_show_two_pixels_a_letter_in_their_colours) {
    uint8_t rgb[9 * 5 * 3];
    fill(rgb, 9, 5);
    char *text = printed(terminal_blocks, rgb, 9, 5), *at = text;
    for (uint32_t y = 0; y < 5; y += 2) {
        for (uint32_t x = 0; x < 9; x++) {
            int c[6], used = 0;
            const uint8_t *up = rgb + (y * 9 + x) * 3;
            int found = sscanf(at, "\033[38;2;%d;%d;%d%n", &c[0], &c[1], &c[2], &used);
            CHECK(found == 3 && c[0] == up[0] && c[1] == up[1] && c[2] == up[2]);
            at += used;
            if (y + 1 < 5) {
                CHECK(sscanf(at, ";48;2;%d;%d;%d%n", &c[3], &c[4], &c[5], &used) == 3);
                CHECK(c[3] == up[27] && c[4] == up[28] && c[5] == up[29]);
                at += used;
            }
            CHECK(strncmp(at, "m\342\226\200", 4) == 0);
            at += 4;
        }
        CHECK(strncmp(at, "\033[0m\n", 5) == 0);
        at += 5;
    }
    CHECK(*at == '\0');
    free(text);
}

static int value64(char c) {
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const char *at = c ? strchr(letters, c) : NULL;
    return at ? (int)(at - letters) : -1;
}

static void print_kitty(FILE *stream, const uint8_t *rgb, uint32_t width, uint32_t height) {
    terminal_kitty(stream, rgb, width, height, 7, 3);
}

TEST(kitty_gets_all_bytes_of_the_image_in_pieces) {
    enum { WIDTH = 61, HEIGHT = 43, SIZE = WIDTH * HEIGHT * 3 };
    static uint8_t rgb[SIZE], have[SIZE + 6];
    fill(rgb, WIDTH, HEIGHT);
    char *text = printed(print_kitty, rgb, WIDTH, HEIGHT), *at = text;
    size_t size = 0;
    int pieces = 0;
    CHECK(strncmp(text, "\033_Ga=T,q=2,f=24,i=1,p=1,C=1,s=61,v=43,c=7,r=3,m=1;", 50) == 0);
    while (*at == '\033') {
        char *begin = strchr(at, ';') + 1, *end = strstr(begin, "\033\\");
        bool last = strstr(at, "m=0;") == begin - 4;
        CHECK(end - begin <= 4096 && (end - begin) % 4 == 0);
        for (char *four = begin; four < end; four += 4) {
            int word = value64(four[0]) << 18 | value64(four[1]) << 12 | (four[2] == '=' ? 0 : value64(four[2])) << 6 |
                       (four[3] == '=' ? 0 : value64(four[3]));
            for (int i = 0; i < 3 && size < SIZE; i++)
                have[size++] = (uint8_t)(word >> (16 - 8 * i));
        }
        at = end + 2;
        pieces++;
        CHECK(last == (*at != '\033'));
    }
    CHECK_TEXT(at, "\n\n\n");
    CHECK_EQ_INT(size, SIZE);
    CHECK_EQ_INT(pieces, 3);
    CHECK(memcmp(have, rgb, SIZE) == 0);
    free(text);
}

/* Draws a sixel image; returns a pointer past its end. */
static const char *draw_sixels(const char *at, uint8_t *rgb, unsigned width, unsigned height) {
    static int palette[256][3];
    unsigned w = 0, h = 0, x = 0, top = 0, colour = 0, repeat = 1;
    int used = 0;
    CHECK(sscanf(at, "\033P0;1q\"1;1;%u;%u%n", &w, &h, &used) == 2 && w == width && h == height);
    for (at += used; *at && *at != '\033';) {
        if (*at == '#') {
            unsigned r, g, b;
            if (sscanf(at, "#%u;2;%u;%u;%u%n", &colour, &r, &g, &b, &used) == 4)
                palette[colour][0] = (int)r, palette[colour][1] = (int)g, palette[colour][2] = (int)b;
            else
                CHECK(sscanf(at, "#%u%n", &colour, &used) == 1);
            at += used;
        } else if (*at == '!') {
            CHECK(sscanf(at, "!%u%n", &repeat, &used) == 1);
            at += used;
        } else if (*at == '$') {
            x = 0;
            at++;
        } else if (*at == '-') {
            x = 0;
            top += 6;
            at++;
        } else {
            for (; repeat > 0; repeat--, x++)
                for (unsigned k = 0; k < 6; k++)
                    if ((*at - '?') >> k & 1 && x < width && top + k < height)
                        for (int c = 0; c < 3; c++)
                            rgb[((top + k) * width + x) * 3 + (unsigned)c] = (uint8_t)(palette[colour][c] * 255 / 100);
            repeat = 1;
            at++;
        }
    }
    return at;
}

TEST(sixels_cover_every_pixel_and_their_means_are_the_colours) {
    enum { WIDTH = 64, HEIGHT = 50 };
    static uint8_t rgb[WIDTH * HEIGHT * 3], have[WIDTH * HEIGHT * 3];
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        rgb[3 * i] = (uint8_t)(i % WIDTH < 32 ? 100 : 255);
        rgb[3 * i + 1] = 37;
        rgb[3 * i + 2] = (uint8_t)(i / WIDTH < 24 ? 0 : 200);
    }
    memset(have, 77, sizeof have);
    char *text = printed(terminal_sixel, rgb, WIDTH, HEIGHT);
    CHECK_TEXT(draw_sixels(text, have, WIDTH, HEIGHT), "\033\\\n");
    double sum[3] = {0};
    for (int y = 0; y < 24; y++)
        for (int x = 0; x < 32; x++)
            for (int c = 0; c < 3; c++) {
                int shown = have[(y * WIDTH + x) * 3 + c];
                CHECK(shown % 51 == 0 && abs(shown - rgb[(y * WIDTH + x) * 3 + c]) <= 51);
                sum[c] += shown / (32.0 * 24);
            }
    CHECK_NEAR(sum[0], 100, 4);
    CHECK_NEAR(sum[1], 37, 4);
    CHECK_NEAR(sum[2], 0, 1e-9);
    CHECK_EQ_INT(have[(49 * WIDTH + 63) * 3], 255);
    free(text);
}

TEST(a_small_view_of_a_film_is_the_mean_of_its_light) {
    struct film_pixel pixels[6 * 4] = {0};
    struct film film = {.width = 6, .height = 4, .pixels = pixels};
    uint8_t rgb[3 * 2 * 3];
    for (int i = 0; i < 24; i++)
        pixels[i].rgb[0] = (float)(i % 2), pixels[i].rgb[2] = i / 12 ? 1.0f : 0.0f;
    film_shrink(&film, &(struct tone){0}, 3, 2, rgb);
    for (int i = 0; i < 6; i++)
        CHECK(rgb[3 * i] == 128 && rgb[3 * i + 1] == 0 && rgb[3 * i + 2] == (i / 3 ? 255 : 0));
}

TEST(a_picture_in_the_terminal_is_the_picture) {
    struct test_result result = test_gray_scene(scene, "--size 40x30 -o out.png --display term:blocks scene.lua", NULL);
    struct test_picture p = test_read_picture(test_path("out.png"));
    const char *at = result.out;
    CHECK_EQ_INT(result.status, 0);
    for (uint32_t y = 0; p.rgb && y < 30; y += 2)
        for (uint32_t x = 0; x < 40; x++) {
            int c[6];
            const uint8_t *up = p.rgb + (y * 40 + x) * 3;
            at = strstr(at, "\033[38");
            bool ok =
                at && sscanf(at, "\033[38;2;%d;%d;%d;48;2;%d;%d;%d", &c[0], &c[1], &c[2], &c[3], &c[4], &c[5]) == 6;
            for (int k = 0; ok && k < 3; k++)
                ok = c[k] == up[k] && c[3 + k] == up[120 + k];
            if (!ok) {
                test_fail(__FILE__, __LINE__, "pixel %u,%u", x, y);
                break;
            }
            at++;
        }
    free(p.rgb);
    test_free_result(&result);
}
