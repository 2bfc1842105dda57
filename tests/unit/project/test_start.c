/* The pages for newcomers: their listings are the files beside them, and render. */
#define _GNU_SOURCE
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAME = 64 };

/* Takes the next listing in Lua from a page; *at moves behind it. The caller frees it; NULL: there is none. */
static char *next_listing(const char **at) {
    static const char fence[] = "```lua\n";
    const char *begin = strstr(*at, fence), *end = begin ? strstr(begin + strlen(fence), "```\n") : NULL;
    if (!end)
        return NULL;
    *at = end + strlen("```\n");
    return strndup(begin + strlen(fence), (size_t)(end - begin) - strlen(fence));
}

/* The last name of a Lua file in back quotes before a listing. */
static void name_before(const char *page, const char *listing_end, char name[NAME]) {
    name[0] = '\0';
    const char *fence = memmem(page, (size_t)(listing_end - page), "```lua\n", 7), *next = fence;
    while (next && next < listing_end) {
        fence = next;
        next = memmem(next + 7, (size_t)(listing_end - next - 7), "```lua\n", 7);
    }
    for (const char *at = page; fence && (at = memmem(at, (size_t)(fence - at), ".lua`", 5)) != NULL; at += 5) {
        const char *quote = memrchr(page, '`', (size_t)(at - page));
        if (quote)
            (void)snprintf(name, NAME, "%.*s", (int)(at + 4 - quote - 1), quote + 1);
    }
}

/* Writes a listing and renders it, small and with few samples. */
static void render(const char *name, const char *text, const char *options) {
    char line[512];
    test_write_text(test_path(name), text);
    (void)snprintf(line, sizeof line, "$gray -q --size 48x30 --spp 2 %s %s && { ls *.png *.gif 2>/dev/null; true; }",
                   options, name);
    test_shell(line, 0, strstr(options, ".gif") ? ".gif" : ".png");
    (void)test_run_shell("rm -f *.png *.gif", "");
}

TEST(every_step_of_the_first_page_is_a_file_that_renders) {
    char *page = test_read_file("docs/start.md", NULL), *listing;
    int count = 0;
    for (const char *at = page; at && (listing = next_listing(&at)) != NULL; count++) {
        char name[NAME], path[NAME + 16];
        name_before(page, at, name);
        (void)snprintf(path, sizeof path, "docs/start/%s", name);
        char *file = test_read_file(path, NULL);
        if (!file || strcmp(file, listing) != 0)
            test_fail(__FILE__, __LINE__, "listing %d is not the file '%s'", count + 1, path);
        if (strcmp(name, "things.lua") == 0)
            test_write_text(test_path(name), listing);
        else
            render(name, listing, strstr(listing, "gr.frames") ? "--frames 2 -o x.gif" : "");
        free(file);
        free(listing);
    }
    CHECK_EQ_INT(count, 7);
    free(page);
}

static void render_page(const char *path, int wanted) {
    char *page = test_read_file(path, NULL), *listing;
    int count = 0;
    for (const char *at = page; at && (listing = next_listing(&at)) != NULL; count++) {
        char name[NAME];
        (void)snprintf(name, sizeof name, "listing-%d.lua", count + 1);
        render(name, listing, strstr(listing, "--dialect icesl") ? "--dialect icesl" : "");
        free(listing);
    }
    CHECK_EQ_INT(count, wanted);
    free(page);
}

TEST(every_scene_of_the_pages_coming_from_renders) {
    render_page("docs/from-course.md", 4);
    render_page("docs/from-pov-ray.md", 1);
    render_page("docs/from-openscad.md", 2);
}

/* The numbers of the page about POV-Ray's side of it are read by POV-Ray itself, and the pictures agree. */
TEST(the_scene_of_the_page_about_pov_ray_is_that_of_pov_ray) {
    if (system("command -v povray >/dev/null 2>&1") != 0)
        test_skip("povray is not installed");
    char *page = test_read_file("docs/from-pov-ray.md", NULL);
    const char *at = page, *begin = page ? strstr(page, "```pov\n") : NULL,
               *end = begin ? strstr(begin, "```\n\n") : NULL;
    char *listing = at ? next_listing(&at) : NULL;
    CHECK(listing && end);
    if (listing && end) {
        char *scene = strndup(begin + 7, (size_t)(end - begin) - 7);
        test_write_text(test_path("s.lua"), listing);
        test_write_text(test_path("s.pov"), scene);
        test_shell(
            "$gray -q --size 128x80 -o gray.png s.lua && povray +Is.pov +Opov.png +W128 +H80 +A0.1 -D 2>/dev/null; ls",
            0, "pov.png");
        struct test_picture ours = test_read_picture(test_path("gray.png")),
                            theirs = test_read_picture(test_path("pov.png"));
        double sum = 0;
        CHECK_EQ_INT(theirs.width, 128);
        for (size_t i = 0; i < (size_t)3 * 128 * 80; i++)
            sum += abs(ours.rgb[i] - theirs.rgb[i]);
        CHECK_NEAR(sum / (3 * 128 * 80), 0, 4);
        free(ours.rgb);
        free(theirs.rgb);
        free(scene);
    }
    free(listing);
    free(page);
}
