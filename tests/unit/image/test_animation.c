/* Files of animations against decoders of this test, and their frames over kills, shards and errors. */
#define _GNU_SOURCE
#include "image/animation.h"
#include "image/palette_internal.h"
#include "image/png_write.h"
#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef HAVE_WEBP
#include <webp/demux.h>
#endif
#include <zlib.h>

enum { WIDTH = 37, HEIGHT = 29, FRAMES = 7, PIXELS = WIDTH * HEIGHT };

/* A gradient over a still half, with a square that moves; frame 3 is frame 2 again. */
static bool picture_frame(void *context, uint32_t index, uint8_t *rgb, struct error *error) {
    (void)context, (void)error;
    uint32_t k = index == 3 ? 2 : index;
    for (uint32_t i = 0; i < PIXELS; i++) {
        uint32_t x = i % WIDTH, y = i / WIDTH;
        bool square = x >= 3 * k && x < 3 * k + 8 && y >= 15 && y < 23;
        rgb[3 * i] = (uint8_t)(square ? 250 : 6 * x);
        rgb[3 * i + 1] = (uint8_t)(square ? 20 * k : 8 * y);
        rgb[3 * i + 2] = (uint8_t)(x * y);
    }
    return true;
}

static const struct animation_source pictures = {
    .width = WIDTH, .height = HEIGHT, .count = FRAMES, .rate = 30, .loops = true, .frame = picture_frame};

static uint32_t word_at(const uint8_t *bytes) {
    return (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 | bytes[3];
}

static void add_chunk(FILE *file, const char *kind, const uint8_t *bytes, uint32_t size) {
    uint8_t head[8] = {(uint8_t)(size >> 24), (uint8_t)(size >> 16), (uint8_t)(size >> 8), (uint8_t)size};
    memcpy(head + 4, kind, 4);
    uLong crc = crc32(0, head + 4, 4);
    if (size > 0)
        crc = crc32(crc, bytes, size);
    uint8_t tail[4] = {(uint8_t)(crc >> 24), (uint8_t)(crc >> 16), (uint8_t)(crc >> 8), (uint8_t)crc};
    CHECK(fwrite(head, 1, 8, file) == 8 && (size == 0 || fwrite(bytes, 1, size, file) == size) &&
          fwrite(tail, 1, 4, file) == 4);
}

/* The data of one frame as a PNG file, read by libpng, at its place on the canvas. */
static void draw_frame(const uint8_t *control, const uint8_t *data, uint32_t size, uint8_t *canvas) {
    uint8_t header[13] = {[8] = 8, [9] = 2};
    memcpy(header, control + 4, 8);
    const char *path = test_path("frame.png");
    FILE *file = fopen(path, "wb");
    CHECK(file != NULL);
    if (!file)
        return;
    CHECK(fwrite("\x89PNG\r\n\x1a\n", 1, 8, file) == 8);
    add_chunk(file, "IHDR", header, 13);
    add_chunk(file, "IDAT", data, size);
    add_chunk(file, "IEND", NULL, 0);
    (void)fclose(file);
    struct test_picture part = test_read_picture(path);
    uint32_t x0 = word_at(control + 12), y0 = word_at(control + 16);
    CHECK(x0 + part.width <= WIDTH && y0 + part.height <= HEIGHT);
    for (uint32_t y = 0; y < part.height; y++)
        memcpy(canvas + 3 * ((y0 + y) * WIDTH + x0), part.rgb + (size_t)3 * part.width * y, (size_t)3 * part.width);
    free(part.rgb);
}

TEST(an_apng_file_has_the_bytes_of_every_frame) {
    static uint8_t canvas[3 * PIXELS], wanted[3 * PIXELS];
    struct error error;
    const char *path = test_path("x.apng");
    CHECK(apng_write(FILE_AT(path), &pictures, &error));
    size_t size = 0, changed = 0;
    uint8_t *file = (uint8_t *)test_read_file(path, &size);
    const uint8_t *control = NULL;
    uint32_t frames = 0, sequence = 0;
    for (size_t at = 8; at + 12 <= size; at += 12 + word_at(file + at)) {
        const uint8_t *data = file + at + 8;
        uint32_t length = word_at(file + at);
        bool first = memcmp(file + at + 4, "IDAT", 4) == 0, later = memcmp(file + at + 4, "fdAT", 4) == 0;
        if (memcmp(file + at + 4, "acTL", 4) == 0) {
            CHECK_EQ_INT(word_at(data), FRAMES);
            CHECK_EQ_INT(word_at(data + 4), 0);
        }
        if (memcmp(file + at + 4, "fcTL", 4) == 0) {
            control = data;
            CHECK_EQ_INT(word_at(data), sequence++);
            CHECK_EQ_INT(word_at(data + 20), 1 << 16 | 30);
            changed += frames > 0 ? (size_t)word_at(data + 4) * word_at(data + 8) : 0;
        }
        if (!first && !later)
            continue;
        if (later)
            CHECK_EQ_INT(word_at(data), sequence++);
        draw_frame(control, later ? data + 4 : data, later ? length - 4 : length, canvas);
        (void)picture_frame(NULL, frames++, wanted, &error);
        CHECK(memcmp(canvas, wanted, sizeof wanted) == 0);
    }
    CHECK_EQ_INT(frames, FRAMES);
    CHECK_EQ_INT(changed, 4 * 8 * 11 + 8 * 14 + 1); /* the square and where it was; one pixel where nothing changes */
    free(file);
}

/* --- GIF --- */

struct gif_reader {
    const uint8_t *at;
    uint8_t canvas[PIXELS][3];
    uint8_t palette[256][3];
};

/* All codes of a picture into `out`; how many there are. */
static size_t lzw_decode(struct gif_reader *reader, uint8_t *out, size_t room) {
    static uint16_t prefix[4096];
    static uint8_t last[4096], bytes[1 << 20];
    size_t size = 0, bit = 0, made = 0;
    uint32_t depth = *reader->at++, clear = 1u << depth, next = clear + 2, width = depth + 1, before = UINT32_MAX;
    while (*reader->at) {
        memcpy(bytes + size, reader->at + 1, *reader->at);
        size += *reader->at;
        reader->at += 1 + *reader->at;
    }
    reader->at++;
    while (bit + width <= 8 * size) {
        uint32_t code = 0;
        for (uint32_t k = 0; k < width; k++, bit++)
            code |= (uint32_t)(bytes[bit / 8] >> (bit % 8) & 1) << k;
        if (code == clear + 1)
            return made;
        if (code == clear) {
            next = clear + 2;
            width = depth + 1;
            before = UINT32_MAX;
            continue;
        }
        uint8_t string[4096];
        size_t length = 0;
        bool unknown = code >= next;
        for (uint32_t at = unknown ? before : code;; at = prefix[at]) {
            string[length++] = at < clear ? (uint8_t)at : last[at];
            if (at < clear)
                break;
        }
        uint8_t begin = string[length - 1];
        CHECK(!unknown || (code == next && before != UINT32_MAX));
        for (size_t k = length; k-- > 0 && made < room;)
            out[made++] = string[k];
        if (unknown && made < room)
            out[made++] = begin;
        if (before != UINT32_MAX && next < 4096) {
            prefix[next] = (uint16_t)before;
            last[next++] = begin;
            width += next == 1u << width && width < 12;
        }
        before = code;
    }
    test_fail(__FILE__, __LINE__, "the code for the end is missing");
    return made;
}

static void check_gif(bool for_each) {
    static struct gif_reader reader;
    static uint8_t rgb[3 * PIXELS], part[PIXELS];
    struct error error;
    const char *path = test_path(for_each ? "each.gif" : "all.gif");
    CHECK(gif_write(FILE_AT(path), &pictures, for_each, &error));
    size_t size = 0;
    uint8_t *file = (uint8_t *)test_read_file(path, &size);
    struct palette_count *count = palette_count_create();
    struct palette_search *search = palette_search_create();
    struct palette palette;
    CHECK(memcmp(file, "GIF89a", 6) == 0 && file[6] == WIDTH && file[8] == HEIGHT);
    reader.at = file + 13;
    if (file[10] & 0x80) {
        memcpy(reader.palette, reader.at, sizeof reader.palette);
        reader.at += sizeof reader.palette;
    }
    for (uint32_t k = 0; k < FRAMES && !for_each; k++) {
        (void)picture_frame(NULL, k, rgb, &error);
        palette_count_add(count, rgb, PIXELS);
    }
    CHECK(memcmp(reader.at, "\x21\xff\x0bNETSCAPE2.0\x03\x01\0\0\0", 19) == 0);
    reader.at += 19;
    static const uint32_t delays[3] = {3, 3, 4};
    for (uint32_t k = 0; k < FRAMES; k++) {
        CHECK(memcmp(reader.at, "\x21\xf9\x04", 3) == 0);
        CHECK_EQ_INT(reader.at[4], delays[k % 3]);
        reader.at += 8;
        uint32_t x0 = reader.at[1], y0 = reader.at[3], width = reader.at[5], height = reader.at[7];
        bool own = reader.at[9] & 0x80;
        CHECK(own == for_each);
        reader.at += 10;
        if (own) {
            memcpy(reader.palette, reader.at, sizeof reader.palette);
            reader.at += sizeof reader.palette;
        }
        CHECK_EQ_INT(lzw_decode(&reader, part, PIXELS), width * height);
        for (uint32_t i = 0; i < width * height; i++)
            memcpy(reader.canvas[(y0 + i / width) * WIDTH + x0 + i % width], reader.palette[part[i]], 3);
        (void)picture_frame(NULL, k, rgb, &error);
        if (for_each) {
            palette_count_clear(count);
            palette_count_add(count, rgb, PIXELS);
        }
        CHECK(palette_make(count, &palette));
        palette_search_begin(search, &palette);
        for (uint32_t i = 0; i < PIXELS; i++) {
            uint8_t colour = palette_find(search, rgb + 3 * i, i % WIDTH, i / WIDTH);
            CHECK(memcmp(reader.canvas[i], palette.colours[colour], 3) == 0);
        }
    }
    CHECK_EQ_INT(*reader.at, 0x3b);
    CHECK(reader.at + 1 == file + size);
    palette_count_destroy(count);
    palette_search_destroy(search);
    free(file);
}

TEST(a_gif_file_has_the_colours_of_its_palette_after_the_dither) {
    check_gif(false);
    check_gif(true);
}

/* So many different strings that the table of codes is full several times. */
static bool noise_frame(void *context, uint32_t index, uint8_t *rgb, struct error *error) {
    (void)context, (void)error;
    struct test_random random = {index + 1};
    for (int i = 0; i < 3 * PIXELS; i++)
        rgb[i] = (uint8_t)test_uniform(&random, 0, 256);
    return true;
}

TEST(ffmpeg_reads_what_is_written_where_it_is_installed) {
    test_need_tools("ffmpeg");
    static uint8_t wanted[3 * PIXELS];
    struct animation_source noise = pictures;
    struct error error;
    noise.frame = noise_frame;
    CHECK(apng_write(FILE_AT(test_path("n.apng")), &noise, &error));
    CHECK(y4m_write(FILE_AT(test_path("n.y4m")), &noise, &error));
    CHECK(gif_write(FILE_AT(test_path("n.gif")), &noise, true, &error));
    static const char *const names[] = {"n.apng", "n.y4m", "n.gif"};
    static const int tolerance[] = {0, 2, 255};
    for (int f = 0; f < 3; f++) {
        char line[2048];
        (void)snprintf(line, sizeof line,
                       "cd '%s' && ffmpeg -v error -i %s -f rawvideo -pix_fmt rgb24 -vsync 0 -y out.rgb 2>err.txt && "
                       "! test -s err.txt",
                       test_folder(), names[f]);
        CHECK_EQ_INT(system(line), 0);
        size_t size = 0;
        uint8_t *out = (uint8_t *)test_read_file(test_path("out.rgb"), &size);
        CHECK_EQ_INT(size, sizeof wanted * FRAMES);
        int worst = 0;
        for (uint32_t k = 0; k < FRAMES && size == sizeof wanted * FRAMES; k++) {
            (void)noise_frame(NULL, k, wanted, &error);
            for (int i = 0; i < 3 * PIXELS; i++) {
                int difference = abs(out[(size_t)k * sizeof wanted + (size_t)i] - wanted[i]);
                worst = difference > worst ? difference : worst;
            }
        }
        if (worst > tolerance[f])
            test_fail(__FILE__, __LINE__, "%s differs by %d levels", names[f], worst);
        free(out);
    }
}

/* apngdis composes the frames and writes them as PNG files. */
TEST(apngdis_finds_the_bytes_of_every_frame_where_it_is_installed) {
    test_need_tools("apngdis");
    static uint8_t wanted[3 * PIXELS];
    struct animation_source sources[2] = {pictures, pictures};
    struct error error;
    sources[1].frame = noise_frame;
    for (int s = 0; s < 2; s++) {
        char line[2048];
        CHECK(apng_write(FILE_AT(test_path("x.apng")), &sources[s], &error));
        (void)snprintf(line, sizeof line, "cd '%s' && rm -f part* && apngdis x.apng part >log.txt", test_folder());
        CHECK_EQ_INT(system(line), 0);
        for (uint32_t k = 0; k < FRAMES; k++) {
            char name[32];
            (void)snprintf(name, sizeof name, "part%u.png", k + 1);
            struct test_picture picture = test_read_picture(test_path(name));
            (void)sources[s].frame(NULL, k, wanted, &error);
            CHECK(picture.width == WIDTH && picture.height == HEIGHT);
            CHECK(picture.rgb && memcmp(picture.rgb, wanted, sizeof wanted) == 0);
            free(picture.rgb);
        }
    }
}

#ifdef HAVE_WEBP
static void check_webp(const struct animation_source *source) {
    static uint8_t wanted[3 * PIXELS];
    struct error error;
    WebPAnimDecoderOptions options;
    WebPAnimInfo info;
    size_t size = 0;
    int seen = 0, time = 0;
    uint8_t *canvas = NULL;
    CHECK(webp_write(FILE_AT(test_path("x.webp")), source, &error));
    uint8_t *file = (uint8_t *)test_read_file(test_path("x.webp"), &size);
    CHECK(WebPAnimDecoderOptionsInit(&options));
    WebPAnimDecoder *decoder = WebPAnimDecoderNew(&(WebPData){file, size}, &options);
    CHECK(decoder && WebPAnimDecoderGetInfo(decoder, &info));
    CHECK_EQ_INT(info.loop_count, source->loops ? 0 : 1);
    for (uint32_t k = 0; k < FRAMES; k++) {
        int end = (int)floor(1000 * ((k + 1) / source->rate) + 0.5);
        if (end > time) { /* equal frames became one, whose end is that of the last of them */
            CHECK(WebPAnimDecoderGetNext(decoder, &canvas, &time));
            seen++;
        }
        (void)source->frame(NULL, k, wanted, &error);
        for (int i = 0; canvas && i < PIXELS; i++)
            CHECK(memcmp(canvas + 4 * i, wanted + 3 * i, 3) == 0);
    }
    CHECK_EQ_INT(time, (int)floor(1000 * (FRAMES / source->rate) + 0.5));
    CHECK_EQ_INT(seen, (int)info.frame_count);
    WebPAnimDecoderDelete(decoder);
    free(file);
}
#endif

TEST(a_webp_file_has_the_bytes_of_every_frame) {
#ifdef HAVE_WEBP
    struct animation_source source = pictures;
    check_webp(&source);
    source.frame = noise_frame;
    source.loops = false;
    source.rate = 24;
    check_webp(&source);
#else
    struct error error;
    CHECK(!webp_write(FILE_AT(test_path("x.webp")), &pictures, &error));
    CHECK(strstr(error.text, "this build was made without it") != NULL);
#endif
}

TEST(delays_of_a_gif_file_add_up_to_its_duration) {
    const double rates[] = {30, 25, 24, 60, 29.97, 7, 0.5};
    for (size_t i = 0; i < sizeof rates / sizeof *rates; i++) {
        uint32_t sum = 0;
        for (uint32_t k = 0; k < 1000; k++) {
            sum += gif_delay(rates[i], k);
            CHECK(fabs(sum - 100 * (k + 1) / rates[i]) < 1);
        }
    }
}

TEST(few_colours_are_kept_and_thresholds_are_a_permutation) {
    struct palette_count *count = palette_count_create();
    struct palette_search *search = palette_search_create();
    struct palette palette;
    uint8_t colours[200][3];
    bool found[64] = {false};
    for (int i = 0; i < 200; i++) {
        colours[i][0] = (uint8_t)(i % 10 * 25 + 3);
        colours[i][1] = (uint8_t)(i / 10 * 12 + 1);
        colours[i][2] = (uint8_t)(i + 50);
    }
    palette_count_add(count, &colours[0][0], 200);
    CHECK(palette_make(count, &palette));
    CHECK_EQ_INT(palette.spread, 0);
    palette_search_begin(search, &palette);
    for (uint32_t i = 0; i < 200; i++)
        CHECK(memcmp(palette.colours[palette_find(search, colours[i], i, 3 * i)], colours[i], 3) == 0);
    int sum = 0;
    for (uint32_t y = 8; y < 16; y++) {
        for (uint32_t x = 16; x < 24; x++) {
            int value = palette_threshold(x, y);
            CHECK(value >= -126 && value <= 126 && (value + 126) % 4 == 0);
            CHECK(!found[(value + 126) / 4]);
            found[(value + 126) / 4] = true;
            sum += value;
        }
    }
    CHECK_EQ_INT(sum, 0);
    palette_count_destroy(count);
    palette_search_destroy(search);
}

static void noise_row(void *context, uint32_t y, uint8_t *line) {
    const uint8_t *rgb = context;
    memcpy(line, rgb + (size_t)3 * WIDTH * y, (size_t)3 * WIDTH);
}

TEST(frames_are_read_back_to_the_byte_and_damaged_ones_are_refused) {
    static uint8_t rgb[3 * PIXELS], back[3 * PIXELS];
    struct error error;
    const char *path = test_path("frame.png"), *cut = test_path("cut.png");
    (void)noise_frame(NULL, 3, rgb, &error);
    CHECK(png_write_from(FILE_AT(path),
                         &(struct png_source){.width = WIDTH, .height = HEIGHT, .bytes = noise_row, .context = rgb},
                         NULL, &error));
    CHECK(png_frame_read(path, WIDTH, HEIGHT, back, &error));
    CHECK(memcmp(rgb, back, sizeof rgb) == 0);
    CHECK(!png_frame_read(path, HEIGHT, WIDTH, back, &error));
    CHECK(strstr(error.text, "has 37 x 29 pixels, not 29 x 37 as the first frame") != NULL);
    size_t size = 0;
    char *file = test_read_file(path, &size);
    for (size_t length = 0; length + 16 < size; length += length < 100 ? 1 : 13) {
        test_write_file(cut, file, length);
        CHECK(!png_frame_read(cut, WIDTH, HEIGHT, back, &error));
    }
    for (size_t at = 0; at + 16 < size; at += at < 100 ? 1 : 13) {
        file[at] = (char)(file[at] ^ 0x41);
        test_write_file(cut, file, size);
        CHECK(!png_frame_read(cut, WIDTH, HEIGHT, back, &error));
        file[at] = (char)(file[at] ^ 0x41);
    }
    free(file);
}

/* --- the program --- */

#define SCENE                                                                                                          \
    "local root, ball = gr.node('r'), gr.sphere(gr.material({0.9, 0.4, 0.2}, {0.5, 0.5, 0.5}, 20))\n"                  \
    "root:add_child(ball)\n"                                                                                           \
    "local lamp = gr.light({4, 5, 6}, {1, 1, 1}, {1, 0, 0})\n"                                                         \
    "gr.frames{count = 12, loop = true, draw = function(t, k)\n"                                                       \
    "  if k == FAIL then error('no') end\n"                                                                            \
    "  ball:translate(0.1, math.random() / 10, 0)\n"                                                                   \
    "  return {node = root, width = 60, height = 44, eye = {0, 0, 6}, view = {0, 0, -1}, up = {0, 1, 0}, fov = 40,\n"  \
    "          ambient = {0.2, 0.2, 0.2}, lights = {lamp}}\n"                                                          \
    "end}\n"

static void gives(const char *line, int status, const char *says) {
    test_write_text(test_path("scene.lua"), SCENE);
    test_shell(line, status, says);
}

/* Runs end after `milliseconds`, one after the other, until one is complete. */
static void kill_and_resume(const int *milliseconds, int kills) {
    char line[1024], *end = line;
    for (int k = 0; k < kills; k++)
        end += snprintf(end, sizeof line - (size_t)(end - line),
                        "$gray -q -j 1 scene.lua -o x.gif --checkpoint auto --checkpoint-every 0 --resume & p=$!; "
                        "sleep %d.%03d; kill -9 $p; wait $p; ",
                        milliseconds[k] / 1000, milliseconds[k] % 1000);
    (void)snprintf(end, sizeof line - (size_t)(end - line),
                   "$gray -q scene.lua -o x.gif --resume && cmp x.gif one.gif && ! test -e x.gif.frames && rm x.gif");
    gives(line, 0, "");
}

TEST(an_animation_that_was_killed_goes_on_to_the_bytes_of_one_run) {
    gives("$gray -q scene.lua -o one.gif && ! test -e one.gif.frames", 0, "");
    for (int k = 1; k <= 8; k++)
        kill_and_resume(&(const int){10 * k}, 1);
}

TEST_LONG(two_hundred_kills_of_an_animation_leave_the_bytes_of_one_run) {
    struct test_random random = {20};
    gives("$gray -q scene.lua -o one.gif", 0, "");
    for (int k = 0; k < 100; k++) {
        const int times[2] = {(int)test_uniform(&random, 1, 200), (int)test_uniform(&random, 1, 200)};
        kill_and_resume(times, 2);
    }
}

TEST(any_division_of_an_animation_gives_the_bytes_of_one_run) {
    gives("$gray -q scene.lua -o one.apng; for n in 2 3 5 12 13; do for i in $(seq $n); do "
          "$gray -q scene.lua -o a.apng --shard-pictures $i/$n || exit 1; done; "
          "$gray merge -q --loop -o a.apng a.apng.frames/*.png && cmp a.apng one.apng || exit 1; "
          "rm -r a.apng a.apng.frames; done",
          0, "");
    /* Pictures of several tiles. */
    gives("size='--size 150x110 --frames 1-3'; $gray -q scene.lua -o two.apng $size; for n in 2 3; do "
          "for i in $(seq $n); do $gray -q scene.lua -o b.apng $size --shard $i/$n || exit 1; done; "
          "$gray merge -q --loop -o b.apng b.apng.frames/*.part && cmp b.apng two.apng || exit 1; "
          "rm -r b.apng b.apng.frames; done; "
          "for i in 1 2; do for k in 1 2; do $gray -q scene.lua -o d.apng $size --shard $i/2 --shard-pictures $k/2 "
          "|| exit 1; done; done; $gray merge -q --loop -o d.apng d.apng.frames/*.part && cmp d.apng two.apng",
          0, "");
    gives("$gray -q scene.lua -o 'c.##.png'; $gray merge -q --loop -o c.apng c.*.png && cmp c.apng one.apng && "
          "test -e c.12.png",
          0, "");
}

/* The first run is stopped while it has the lock. One that ended before, or has the file only, is done again. */
#define HELD(options)                                                                                                  \
    "size='--size 240x160'; while :; do $gray -q -j 1 scene.lua $size -o x.gif " options " & p=$!; "                   \
    "await 'test -e x.gif.frames/lock || test -e x.gif || test -e x.gif.frames/000011.png'; kill -STOP $p; "           \
    "test -e x.gif.frames/lock && ! flock -n x.gif.frames/lock true && break; "                                        \
    "kill -CONT $p; wait $p; rm -rf x.gif x.gif.frames; done; "

TEST(a_second_run_of_an_animation_is_refused_and_the_first_one_is_not_disturbed) {
    static const char refused[] = "gray: x.gif.frames: another run writes its frames into this folder\n";
    gives("$gray -q scene.lua --size 240x160 -o one.gif", 0, "");
    gives(HELD("") "$gray -q scene.lua $size -o x.gif; s=$?; kill -CONT $p; wait $p && cmp x.gif one.gif && "
                   "! test -e x.gif.frames && rm x.gif; exit $s",
          2, refused);
    gives(HELD("") "$gray -q scene.lua $size -o x.gif --shard-pictures 1/3; s=$?; kill -CONT $p; wait $p && "
                   "cmp x.gif one.gif && rm x.gif; exit $s",
          2, refused);
    /* Other animations, and questions about this one, are not affected. */
    gives(HELD("") "$gray -q scene.lua $size -o y.gif && cmp y.gif one.gif && $gray -q --check scene.lua -o x.gif && "
                   "$gray -q --dump-scene scene.lua -o x.gif >dump; s=$?; kill -CONT $p; wait $p && exit $s",
          0, "");
    /* The lock ends with the process, and so does the folder with the animation. */
    gives(HELD("") "kill -9 $p; wait $p; test -e x.gif.frames/lock && $gray -q scene.lua $size -o x.gif --resume && "
                   "cmp x.gif one.gif && ! test -e x.gif.frames",
          0, "");
}

TEST(jobs_share_the_folder_of_an_animation_and_a_whole_run_waits_for_none_of_them) {
    gives("$gray -q scene.lua --size 240x160 -o one.gif", 0, "");
    gives(HELD("--shard-pictures 1/2") "$gray -q scene.lua $size -o x.gif --shard-pictures 2/2 && "
                                       "test -e x.gif.frames/lock; s=$?; kill -CONT $p; wait $p; "
                                       "! test -e x.gif.frames/lock && $gray merge -q --loop -o x.gif "
                                       "x.gif.frames/*.png && cmp x.gif one.gif && exit $s",
          0, "");
    gives(HELD("--shard-pictures 1/2") "$gray -q scene.lua $size -o x.gif; s=$?; kill -CONT $p; wait $p; exit $s", 2,
          "another run writes its frames into this folder");
}

/* A stand-in that never ends. */
TEST(a_signal_ends_the_program_that_makes_the_video_and_the_frames_are_kept) {
    gives("mkdir bin && printf '#!/bin/sh\\ncat >/dev/null; touch %s/started\\nexec sleep 100\\n' $PWD > bin/ffmpeg && "
          "chmod +x bin/ffmpeg && PATH=$PWD/bin:$PATH $gray scene.lua -o x.mp4 & p=$!; await 'test -e started'; "
          "kill -TERM $p; wait $p; s=$?; test -e x.mp4 && exit 1; exit $s",
          130, "gray: interrupted\ngray: notice: x.mp4.frames holds 12 frames (--resume continues)\n");
    gives("$gray -q scene.lua -o 'y.####.png' && cmp x.mp4.frames/000012.png y.0012.png", 0, "");
}

/* As a scheduler of job arrays: four jobs at once, and every third is killed and queued again. */
TEST(a_job_array_makes_an_animation_with_the_bytes_of_one_run) {
    test_write_text(test_path("job.sh"),
                    "run=\"$gray -q -j 1 scene.lua -o x.apng --shard-pictures $1/6 --resume --checkpoint-every 0\"\n"
                    "if [ $(($1 % 3)) = 0 ]; then $run & p=$!; sleep 0.1; kill -9 $p; wait $p; fi\n"
                    "exec $run\n");
    gives("export gray; seq 6 | xargs -P 4 -n 1 sh job.sh && $gray merge -q --loop -o x.apng x.apng.frames/*.png && "
          "$gray -q scene.lua -o one.apng && cmp x.apng one.apng",
          0, "");
}

TEST(ranks_make_an_animation_with_the_bytes_of_one_run) {
    test_need_mpi();
    test_write_text(test_path("farm.sh"), "exec env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
                                          "OMPI_MCA_btl_vader_backing_directory=${TMPDIR:-/tmp} "
                                          "mpirun --oversubscribe -n 3 $gray --mpi -q -j 1 \"$@\"\n");
    gives("export gray; sh farm.sh scene.lua -o x.gif && $gray -q scene.lua -o one.gif && cmp x.gif one.gif && "
          "! test -e x.gif.frames && sh farm.sh scene.lua -o - --frames 2-11/3 > y && "
          "$gray -q scene.lua -o - --frames 2-11/3 > z && cmp y z && sh farm.sh scene.lua -o 'p.##.png' && "
          "$gray merge -q --loop -o p.gif p.*.png && cmp p.gif one.gif",
          0, "");
    gives("export gray; sh farm.sh scene.lua -D FAIL=8 -o e.gif", 1, "no (frame 8)");
    gives("ls e.gif.frames | grep -c png", 0, "7");
    gives("export gray; sh farm.sh scene.lua -o r.gif --checkpoint auto --checkpoint-every 0 & p=$!; "
          "await 'test -e r.gif.frames/000003.png || test -e r.gif'; "
          "kill -9 $(pgrep -P $p | tail -n 1); wait $p; "
          "test -e r.gif || sh farm.sh scene.lua -o r.gif --resume; cmp r.gif one.gif",
          0, "");
}

TEST(an_error_in_a_frame_keeps_the_frames_before_it_and_names_it) {
    gives("$gray scene.lua -D FAIL=8 -o x.gif", 1, "no (frame 8)");
    gives("ls x.gif.frames | grep -c png; test -e x.gif", 1, "7");
    gives("$gray scene.lua -D FAIL=8 -o 'x.####.png'; ls x.0*.png | wc -l", 0, "7");
    gives("sed -i 's/count = 12/count = 20/' scene.lua && $gray scene.lua -D FAIL=17 -o y.gif", 1,
          "scene.lua:5: no (frame 17)");
    gives("sed -i 's/count = 12/count = 20/' scene.lua && $gray scene.lua -q -o 'z.####.png' && "
          "$gray scene.lua -D FAIL=17 -o y.gif; ls y.gif.frames | grep -c png",
          0, "16");
    gives("sed -i 's/count = 12/count = 20/' scene.lua && $gray scene.lua -q -o 'z.####.png' && for k in $(seq 16); do "
          "cmp y.gif.frames/$(printf %06d $k).png z.$(printf %04d $k).png || exit 1; done",
          0, "");
}

/* A file system with room for a few frames. */
TEST(a_full_disk_keeps_the_frames_before_it) {
    if (system("unshare -rm sh -c 'mount -t tmpfs -o size=8k t /mnt' 2>/dev/null") != 0)
        test_skip("this user may not mount a small file system");
    gives("$gray -q scene.lua -o 'a.##.png' && mkdir disk && export gray && "
          "unshare -rm sh -c \"mount -t tmpfs -o size=24k t disk && $gray -q scene.lua -o 'disk/a.##.png'; s=\\$?; "
          "n=\\$(ls disk | wc -l); test \\$n -ge 2 && test \\$n -lt 12 && test -e disk/a.01.png && "
          "for f in \\$(ls disk); do cmp disk/\\$f \\$f || exit 1; done; exit \\$s\"",
          3, "No space left on device");
}

/* A file takes whole pages of the file system: there is room for just 29. */
TEST(a_disk_that_is_full_at_frame_30_keeps_29_frames) {
    if (system("unshare -rm sh -c 'mount -t tmpfs -o size=8k t /mnt' 2>/dev/null") != 0)
        test_skip("this user may not mount a small file system");
    gives(
        "sed -i 's/count = 12/count = 40/' scene.lua && $gray -q scene.lua -o 'a.##.png' && mkdir disk && export gray "
        "&& size=$(for k in $(seq -w 29); do stat -c %s a.$k.png; done | "
        "awk '{pages += int(($1 + 4095) / 4096)} END {print 4 * pages}') && "
        "unshare -rm sh -c \"mount -t tmpfs -o size=${size}k t disk && $gray -q scene.lua -o 'disk/a.##.png'; s=\\$?; "
        "test \\$(ls disk | wc -l) = 29 && for f in \\$(ls disk); do cmp disk/\\$f \\$f || exit 1; done; exit \\$s\"",
        3, "a.30.png: cannot be written: No space left on device");
}

/* The frame after the last one of a loop has the time of the first turn's end. */
TEST(a_loop_closes_where_its_script_is_periodic) {
    static const char text[] =
        "local root, ball = gr.node('r'), gr.torus(gr.material({0.9, 0.4, 0.2}, {0.5, 0.5, 0.5}, 20), 1, 0.3)\n"
        "root:add_child(gr.node('arm'):add_child(ball))\n"
        "local k = gr.keys{{0, 0}, {0.1, 1}, {0.2, 0}, curve = 'catmull'}\n"
        "gr.frames{count = COUNT, fps = 30, loop = LOOPS, draw = function(t)\n"
        "  ball:reset():rotate('x', 360 * t):rotate('z', -720 * t):translate(0, k(), 0)\n"
        "  return {node = root, width = 60, height = 44, eye = {0, 0, 6}, view = {0, 0, -1}, fov = 40,\n"
        "          lights = {gr.light({4, 5, 6}, {1, 1, 1}, {1, 0, 0})}} end}\n";
    test_write_text(test_path("loop.lua"), text);
    gives("$gray -q loop.lua -D COUNT=6 -D LOOPS=true -o 'l.##.png'; $gray -q loop.lua -D COUNT=7 -D LOOPS=false "
          "-o 'w.##.png'; for k in 1 2 3 4 5 6; do cmp l.0$k.png w.0$k.png || exit 1; done; cmp w.07.png w.01.png && "
          "! cmp -s w.02.png w.01.png",
          0, "");
}

/* Renders what draw returns at the beginning and at the end of the loop, in place of the frames. */
TEST(demos_of_animations_close_their_loops) {
    static const char *const demos[] = {"bounce", "clockwork", "flight", "walker", "waves"};
    char folder[4096], line[8192];
    CHECK(realpath("data/animation", folder) != NULL);
    test_write_text(test_path("ends.lua"), "gr.frames = function(a)\n"
                                           "  for i = 0, 1 do\n"
                                           "    local show = a.draw(i, 1 + i * a.count)\n"
                                           "    show.file = 'frame'\n"
                                           "    gr.render(show)\n"
                                           "  end\nend\n");
    for (size_t i = 0; i < sizeof demos / sizeof *demos; i++) {
        (void)snprintf(
            line, sizeof line,
            "cat ends.lua '%s'/%s.lua >demo.lua && $gray -q demo.lua --size 60x44 -D quick=true -o %%d.png && "
            "cmp 1.png 2.png && ! test -e 3.png",
            folder, demos[i]);
        gives(line, 0, "");
    }
}

TEST(every_picture_of_an_old_script_is_a_frame) {
    gives("cat > old.lua <<'END'\n"
          "local node = gr.node('r')\nnode:add_child(gr.sphere{})\n"
          "for i = 1, 4 do node:translate(0.3, 0, 0) gr.render(node, 'old' .. i .. '.png', 30, 20, {0, 0, 6}, "
          "{0, 0, -1}, {0, 1, 0}, 40, {1, 1, 1}, {}) end\n"
          "END\n"
          "$gray -q old.lua -o old.apng && $gray -q old.lua && $gray merge -q -o m.apng old?.png && cmp m.apng "
          "old.apng && $gray -q old.lua -o sheet.gif --contact-sheet --keep-frames && ls sheet.gif.frames && "
          "test -s sheet.sheet.png",
          0, "000001.png\n000002.png\n000003.png\n000004.png\n");
    /* Turntables of several pictures follow each other; frame 1 of each is the picture. */
    gives("$gray -q old.lua --turntable 3 -o 't.##.png' && ls t.*.png | wc -l && cmp t.01.png old1.png && cmp t.04.png "
          "old2.png && cmp t.10.png old4.png && ! cmp -s t.05.png old2.png && $gray -q old.lua --turntable 3 -o t.apng "
          "--keep-frames && for k in 01 02 03 04 05 06 07 08 09 10 11 12; do cmp t.$k.png t.apng.frames/0000$k.png || "
          "exit 1; done; $gray -q old.lua --turntable 3 --frames 2-2 && ls old?.0002.png | wc -l; cmp old4.0002.png "
          "t.11.png",
          0, "12\n4\n");
    gives("$gray -q old.lua -o x.png", 2,
          "several pictures are rendered, so the name needs %d, or an ending of animations such as .gif or .mp4");
    gives("$gray -q old.lua -o x%04d%d.png", 2, "-o x%04d%d.png: a name has one number: %d, %04d or ####");
    gives("$gray -q old.lua -o x%d.gif", 2,
          "-o x%d.gif: .gif is one file of all frames, without a number; names with a number end in .png, ");
    gives("$gray -q old.lua -o x.####.####.png; ls x*", 2, "-o x.####.####.png: a name has one number");
    gives("cat > two.lua <<'END'\n"
          "local node = gr.node('r')\nnode:add_child(gr.sphere{})\n"
          "for i = 1, 2 do gr.render(node, 'x.png', 30 + i, 20, {0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 40, {1, 1, 1}, {}) "
          "end\n"
          "END\n"
          "$gray -q two.lua -o two.gif",
          1, "-o two.gif: frame 2 has 32 x 20 pixels, and the first one 31 x 20");
    gives("echo text > t.gif; $gray -q old.lua -o t.gif", 1, "t.gif: ");
}

TEST(a_stream_is_the_y4m_file) {
    gives("$gray -q scene.lua -o x.y4m && $gray -q scene.lua -o - > y && cmp x.y4m y && head -c 66 y", 0,
          "YUV4MPEG2 W60 H44 F30:1 Ip A1:1 C444 XCOLORRANGE=LIMITED\nFRAME\n");
}

/* A program ffmpeg of this test: it fails, or is killed. */
TEST(an_ffmpeg_that_fails_leaves_the_frames_for_the_next_one) {
    gives("mkdir bin; printf '#!/bin/sh\\nexit 7\\n' >bin/ffmpeg; chmod +x bin/ffmpeg; "
          "PATH=$PWD/bin:$PATH $gray -q scene.lua -o x.mp4",
          3, "x.mp4: ffmpeg failed (status 7)");
    gives("ls x.mp4.frames | grep -c png; test -e x.mp4", 1, "12");
    gives("printf '#!/bin/sh\\nkill -9 $$\\n' >bin/ffmpeg; PATH=$PWD/bin:$PATH $gray -q scene.lua -o x.webm", 3,
          "x.webm: ffmpeg was ended by signal 9");
    if (system("ffmpeg -hide_banner -encoders 2>/dev/null | grep -q libx264") == 0)
        gives("$gray -q scene.lua -o x.mp4 --resume && test -s x.mp4 && ! test -e x.mp4.frames", 0, "");
}

TEST(files_of_one_pixel_and_of_odd_sizes_are_written) {
    gives("for f in gif apng y4m; do $gray -q scene.lua --size 1x1 -o one.$f && $gray -q scene.lua --size 25x17 -o "
          "odd.$f && test -s one.$f && test -s odd.$f || exit 1; done; head -c 31 odd.y4m",
          0, "YUV4MPEG2 W25 H17 F30:1 Ip A1:1");
}

TEST(videos_have_the_same_bytes_each_time) {
    test_need_tools("ffmpeg");
    if (system("ffmpeg -hide_banner -encoders 2>/dev/null | grep -q libx264") != 0)
        test_lacks("ffmpeg has no libx264");
    gives("$gray -q scene.lua -o x.mp4 && $gray -q scene.lua -o y.mp4 && cmp x.mp4 y.mp4", 0, "");
    gives("PATH=/nowhere $gray -q scene.lua -o z.mp4", 3, "z.mp4: there is no program ffmpeg on PATH");
    gives("ls z.mp4.frames | grep -c png", 0, "12");
}
