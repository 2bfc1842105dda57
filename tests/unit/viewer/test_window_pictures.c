/* Pictures of the window with the demo for it, kept below build/window for inspection. */
#define _GNU_SOURCE
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The share of pixels that differ. */
static double difference(const struct test_picture *a, const struct test_picture *b) {
    size_t count = (size_t)a->width * a->height, other = 0;
    CHECK(a->width == b->width && a->height == b->height);
    for (size_t i = 0; i < count && a->width == b->width && a->height == b->height; i++)
        other += memcmp(a->rgb + 3 * i, b->rgb + 3 * i, 3) != 0;
    return (double)other / (double)count;
}

TEST_LONG(window_pictures_of_the_demo_are_made_and_kept) {
    static const char *const names[] = {"ready", "picked", "story",  "error",  "dark",
                                        "start", "keys",   "scale2", "playing"};
    enum { COUNT = sizeof names / sizeof *names, OF_ONE_SIZE = 5 };
    struct test_picture pictures[COUNT];
    test_need_window();
    if (system("command -v import >/dev/null && command -v convert >/dev/null") != 0)
        test_skip("there is no ImageMagick, which takes the pictures");
    CHECK(system("rm -rf build/window && tools/window_pictures.sh build/window") == 0);
    for (int i = 0; i < COUNT; i++) {
        char path[64];
        (void)snprintf(path, sizeof path, "build/window/%s.png", names[i]);
        pictures[i] = test_read_picture(path);
        CHECK(pictures[i].rgb != NULL);
        if (!pictures[i].rgb)
            return;
    }
    /* Each differs from the finished picture: from the outline of a ball to another theme. */
    for (int i = 1; i < OF_ONE_SIZE; i++)
        CHECK(difference(&pictures[0], &pictures[i]) > 0.005);
    for (int i = 0; i < COUNT; i++)
        free(pictures[i].rgb);
}
