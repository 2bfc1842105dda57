/* gray compare: closed forms of small pictures. */
#include "base/file_output.h"
#include "image/png_write.h"
#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDE = 4, HIGH = 3 };

/* Of light: every pixel (value, value, value), but one. */
static void put_pfm(const char *name, float value, float of_one) {
    struct {
        char head[14];
        float rgb[WIDE * HIGH][3];
    } __attribute__((packed)) file = {.head = "PF\n4 3\n-1.0\n"};
    size_t head = strlen(file.head), size = sizeof file.rgb;
    uint8_t bytes[sizeof file];
    for (int i = 0; i < WIDE * HIGH; i++)
        for (int c = 0; c < 3; c++)
            file.rgb[i][c] = value;
    file.rgb[WIDE + 2][1] = of_one; /* rows from the bottom */
    memcpy(bytes, file.head, head);
    memcpy(bytes + head, file.rgb, size);
    test_write_file(test_path(name), bytes, head + size);
}

static void row(void *context, uint32_t y, uint8_t *line) {
    (void)y;
    memset(line, *(const int *)context, (size_t)3 * WIDE);
}

static void put_png(const char *name, int level, bool srgb) {
    struct error error;
    const struct png_source source = {.width = WIDE, .height = HIGH, .bytes = row, .context = &level, .srgb = srgb};
    CHECK(png_write_from(FILE_AT(test_path(name)), &source, NULL, &error));
}

struct measures {
    int status;
    char bytes[16], position[32];
    double largest, mean, beyond, relative, similarity;
};

static struct measures compare(const char *arguments) {
    struct measures measured = {0};
    char line[200], limit[16];
    (void)snprintf(line, sizeof line, "compare %s", arguments);
    struct test_result result = test_gray(NULL, line);
    measured.status = result.status;
    const char *rest = strchr(result.out, '\n');
    CHECK(rest && sscanf(result.out, "bytes %15s", measured.bytes) == 1);
    CHECK(rest && sscanf(rest, " largest difference %lf%31[^\n]", &measured.largest, measured.position) >= 1);
    rest = strstr(result.out, "mean");
    CHECK(rest && sscanf(rest, "mean difference %lf pixels beyond %15s %lf %% relMSE %lf SSIM %lf", &measured.mean,
                         limit, &measured.beyond, &measured.relative, &measured.similarity) == 5);
    test_free_result(&result);
    return measured;
}

TEST(light_is_compared_by_its_differences_relative_errors_and_similarity) {
    put_pfm("a.pfm", 0.5F, 0.75F);
    put_pfm("b.pfm", 0.5F, 0.5F);
    struct measures measured = compare("a.pfm b.pfm");
    CHECK_EQ_INT(measured.status, 1);
    CHECK_TEXT(measured.bytes, "different");
    CHECK_TEXT(measured.position, " at 2,1");
    CHECK_NEAR(measured.largest, 0.25, 0);
    CHECK_NEAR(measured.mean, 0.25 / (3 * WIDE * HIGH), 1e-7);
    CHECK_NEAR(measured.beyond, 100.0 / (WIDE * HIGH), 1e-4);
    CHECK_NEAR(measured.relative, 0.0625 / 0.26 / (3 * WIDE * HIGH), 1e-7);
    CHECK(measured.similarity > 0.3 && measured.similarity < 1);
    CHECK_EQ_INT(compare("--threshold 0.25 a.pfm b.pfm").status, 0);
    CHECK_EQ_INT(compare("--threshold 0.2499 a.pfm b.pfm").status, 1);
    /* Of constant pictures only the means count. */
    put_pfm("a.pfm", 0.25F, 0.25F);
    double a = pow(0.25, 1 / 2.2), b = pow(0.5, 1 / 2.2);
    CHECK_NEAR(compare("a.pfm b.pfm").similarity, (2 * a * b + 1e-4) / (a * a + b * b + 1e-4), 1e-6);
}

TEST(pictures_for_a_display_are_compared_in_levels_and_equal_pixels_in_other_bytes_are_seen) {
    put_png("a.png", 100, false);
    put_png("b.png", 110, false);
    put_png("c.png", 100, true);
    struct measures measured = compare("a.png b.png -o d.png");
    double a = 100 / 255.0, b = 110 / 255.0;
    CHECK_EQ_INT(measured.status, 1);
    CHECK_TEXT(measured.position, " of 255 at 0,0");
    CHECK_NEAR(measured.largest, 10, 1e-4);
    CHECK_NEAR(measured.mean, 10, 1e-4);
    CHECK_NEAR(measured.beyond, 100, 0);
    CHECK_NEAR(measured.similarity, (2 * a * b + 1e-4) / (a * a + b * b + 1e-4), 1e-6);
    struct test_picture difference = test_read_picture(test_path("d.png"));
    CHECK(difference.width == WIDE && difference.height == HIGH && difference.rgb[0] == 255);
    free(difference.rgb);
    CHECK_EQ_INT(compare("a.png b.png --threshold=10").status, 0);
    measured = compare("a.png c.png");
    CHECK_TEXT(measured.bytes, "different");
    CHECK(measured.status == 0 && measured.largest == 0 && measured.similarity == 1);
    CHECK_TEXT(compare("a.png a.png").bytes, "equal");
}

TEST(pictures_that_cannot_be_compared_are_one_line_and_status_2) {
    put_png("a.png", 100, false);
    put_pfm("a.pfm", 0.5F, 0.5F);
    test_write_text(test_path("x.png"), "no picture");
    test_shell_errors("$gray -q --size 8x8 -o big.png scene.lua 2>/dev/null; echo \"gr.render{node = gr.sphere{}}\" "
                      ">s.lua; $gray -q --size 8x6 -o big.png s.lua; $gray compare a.png big.png",
                      2, "a.png has 4 x 3 pixels, and big.png 8 x 6\n");
    test_shell_errors("$gray compare a.png a.pfm", 2, "a.pfm has light, and a.png numbers for a display\n");
    test_shell_errors("$gray compare a.png x.png", 2, "x.png");
    test_shell_errors("$gray compare a.png none.png", 2, "none.png: cannot be read");
    test_shell_errors("$gray compare a.png", 2, "gray: compare needs two pictures");
    test_shell_errors("$gray compare a.png big.png a.png", 2, "gray: compare needs two pictures");
    test_shell_errors("$gray compare --spp 4 a.png a.png", 2, "compare cannot be combined with --spp");
    test_shell_errors("$gray --threshold 4 s.lua", 2, "--threshold is for gray compare");
    test_shell_errors("$gray compare -q a.png big.png -o x.png", 2, "pixels");
    /* A picture that is compared is not replaced, nor is another file. */
    test_shell_errors("$gray compare -q a.png a.png -o a.png", 2, "a.png: is a file that this run reads");
    test_shell_errors("$gray compare -q a.png a.png -o x.png", 2, "x.png: exists already and is not a picture");
    test_shell_errors("$gray compare -q a.png a.png -o x.gif", 2, "-o x.gif: the difference is a picture");
    test_shell_errors("$gray compare -q a.png a.png -o -", 2, "-o -: the difference is a picture");
}
