/* Only the program's own lines on standard error begin with "gray:": output of scenes, in any fragments, with invisible
 * characters and cursor movements, never begins so. */
#include "base/terminal_text.h"

#include "base/error.h"
#include "session/text.h"
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct page {
    char text[8192];
    size_t size;
};

static void put(void *context, const char *text, size_t size) {
    struct page *page = context;
    if (page->size + size >= sizeof page->text) {
        test_fail(__FILE__, __LINE__, "more came out than there is room for");
        return;
    }
    memcpy(page->text + page->size, text, size);
    page->size += size;
    page->text[page->size] = '\0';
}

static struct line_guard guard_of(struct page *page) {
    *page = (struct page){.size = 0};
    return (struct line_guard){.context = page, .put = put};
}

static void shown(const char *text, size_t size, const char *wanted) {
    struct page page;
    struct line_guard guard = guard_of(&page);
    line_guard_take(&guard, text, size);
    line_guard_flush(&guard);
    CHECK_TEXT(page.text, wanted);
    /* Written byte by byte, the result is the same. */
    guard = guard_of(&page);
    for (size_t i = 0; i < size; i++)
        line_guard_take(&guard, text + i, 1);
    line_guard_flush(&guard);
    CHECK_TEXT(page.text, wanted);
}

TEST(a_scene_begins_no_line_as_the_program_does) {
#define SHOWN(text, wanted) shown(text, sizeof text - 1, wanted)
    SHOWN("", "");
    SHOWN("plain text\nand more", "plain text\nand more");
    SHOWN("gray: x\n", "scene: gray: x\n");
    SHOWN("gray:", "scene: gray:");
    SHOWN("gray", "gray");
    SHOWN("gra\ngray: x", "gra\nscene: gray: x");
    SHOWN("ggray: x grgray: y gray: z", "ggray: x grgray: y gray: z");
    SHOWN("a gray: x\n\n\ngray: y", "a gray: x\n\n\nscene: gray: y");
    SHOWN(" gray: x\n\tgray: y\nGray: z\ngray :", " gray: x\n\tgray: y\nGray: z\ngray :");
    SHOWN("x\rgray: y", "x\nscene: gray: y");
    SHOWN("\rgray: y\r\rz\r\n\r\nq", "scene: gray: y\nz\n\nq");
    SHOWN("gra\ry: x", "gra\ny: x");
    SHOWN("x\fgray: y\vgray: z", "x\nscene: gray: y\nscene: gray: z");
    SHOWN("x\xc2\x85gray: y\xe2\x80\xa8gray: z\xe2\x80\xa9gray:", "x\nscene: gray: y\nscene: gray: z\nscene: gray:");
    SHOWN("\33[2Kgray: x", "?[2Kscene: gray: x");
    SHOWN("a\33[1Ggray: b gray: c\ngray: d", "a?[1Gscene: gray: b scene: gray: c\nscene: gray: d");
    SHOWN("x\b\bgray: y\177gray: z\agray:\0gray:", "x??scene: gray: y?scene: gray: z?scene: gray:?scene: gray:");
    SHOWN("\x9bgray: y\xc2\x9bgray: z", "?scene: gray: y?scene: gray: z");
    SHOWN("\xe2\x80\xae:yarg\xe2\x81\xa6\xd8\x9c\xe2\x80\x8e", "?:yarg???");
    SHOWN("\xe2\x80\x8bgray: x", "\xe2\x80\x8bscene: gray: x");
    SHOWN("g\xe2\x80\x8bra\xef\xbb\xbfy\xcd\x8f: x", "scene: g\xe2\x80\x8bra\xef\xbb\xbfy\xcd\x8f: x");
    SHOWN("\xcc\x81\xf3\xa0\x81\xa7gray: x", "\xcc\x81\xf3\xa0\x81\xa7scene: gray: x");
    SHOWN("g\xe2\x80\x8breen", "g\xe2\x80\x8breen");
    SHOWN("\xff\xfe\xe2\x82gray: \xc3", "\xff\xfe\xe2?scene: gray: \xc3");
    SHOWN("\xc3\xa4 \xe2\x82\xac \xf4\x8f\xbf\xbf\n", "\xc3\xa4 \xe2\x82\xac \xf4\x8f\xbf\xbf\n");
    SHOWN("scene: gray: x\n", "scene: gray: x\n");
    /* More invisible characters than are held back. */
    char many[2048] = "g", wanted[2100] = "scene: g";
    for (int i = 0; i < 100; i++) {
        strcat(many, "\xe2\x80\x8b");
        strcat(wanted, "\xe2\x80\x8b");
    }
    strcat(many, "ray: x");
    strcat(wanted, "ray: x");
    shown(many, strlen(many), wanted);
}

/* Text at the start of a line after a message of the program, or after a flush, is not a continuation. */
TEST(what_was_held_back_is_not_completed_later) {
    static const char *const pieces[][2] = {
        {"gra", "y: x"}, {"g", "ray: x"}, {"gray", ":"}, {"\xef\xbb", "\xbfgray: x"}, {"g\xe2\x80\x8b", "ray: x"}};
    for (size_t i = 0; i < sizeof pieces / sizeof *pieces; i++) {
        struct page page;
        struct line_guard guard = guard_of(&page);
        line_guard_take(&guard, pieces[i][0], strlen(pieces[i][0]));
        line_guard_flush(&guard);
        line_guard_take(&guard, pieces[i][1], strlen(pieces[i][1]));
        line_guard_flush(&guard);
        const char *end = strchr(page.text, '\n');
        CHECK(end && !scene_mark(page.text)[0] && !scene_mark(end + 1)[0]);
        guard = guard_of(&page);
        line_guard_take(&guard, pieces[i][0], strlen(pieces[i][0]));
        line_guard_new_line(&guard);
        line_guard_take(&guard, "gray: x", 7);
        CHECK(!scene_mark(page.text)[0]);
    }
    struct page page;
    struct line_guard guard = guard_of(&page);
    line_guard_take(&guard, "gra", 3);
    line_guard_flush(&guard);
    CHECK(guard.open);
    line_guard_take(&guard, "\n", 1);
    CHECK_TEXT(page.text, "gra\n");
    CHECK(!guard.open);
}

/* The visible letters of a line, by an independent list. */
static bool resembles_the_program(const char *line, size_t size) {
    static const char *const unseen[] = {"\xe2\x80\x8b", "\xef\xbb\xbf", "\xcc\x81", "\xf3\xa0\x81\xa7", "\xc2\xad"};
    char seen[8] = "";
    for (size_t i = 0; i < size && strlen(seen) < 5;) {
        size_t step = 0;
        for (size_t k = 0; k < sizeof unseen / sizeof *unseen; k++)
            if (i + strlen(unseen[k]) <= size && memcmp(line + i, unseen[k], strlen(unseen[k])) == 0)
                step = strlen(unseen[k]);
        if (step == 0)
            strncat(seen, line + i, 1);
        i += step ? step : 1;
    }
    return strcmp(seen, "gray:") == 0;
}

TEST(no_random_text_in_random_pieces_imitates_the_program) {
    static const char *const words[] = {"g",
                                        "r",
                                        "a",
                                        "y",
                                        ":",
                                        "gray:",
                                        "gra",
                                        "y:",
                                        "gray: x",
                                        " ",
                                        "x",
                                        "\n",
                                        "\r",
                                        "\t",
                                        "\33[2K",
                                        "\33",
                                        "\b",
                                        "\v",
                                        "\f",
                                        "\a",
                                        "\177",
                                        "\xc2\x85",
                                        "\xe2\x80\xa8",
                                        "\xe2\x80\xa9",
                                        "\xe2\x80\x8b",
                                        "\xcc\x81",
                                        "\xe2\x80\xae",
                                        "\xd8\x9c",
                                        "\xf3\xa0\x81\xa7",
                                        "\xff",
                                        "\x9b",
                                        "\xc2\x9b",
                                        "\xc2\xad",
                                        "\xef\xbb\xbf",
                                        "\xef\xbb",
                                        "\xbf",
                                        "\xe2",
                                        "\x80",
                                        "\x8b",
                                        "\xc3\xa4",
                                        "scene: ",
                                        "?"};
    enum { WORDS = sizeof words / sizeof *words };
    struct test_random random = {.state = 14};
    for (int round = 0; round < 20000; round++) {
        struct page page;
        struct line_guard guard = guard_of(&page);
        int count = (int)test_uniform(&random, 1, 40);
        for (int i = 0; i < count; i++) {
            const char *word = words[(int)test_uniform(&random, 0, WORDS)];
            size_t size = strlen(word), first = (size_t)test_uniform(&random, 0, (double)size + 1);
            line_guard_take(&guard, word, first);
            line_guard_take(&guard, word + first, size - first);
            double what = test_uniform(&random, 0, 1);
            if (what < 0.05)
                line_guard_flush(&guard);
            else if (what < 0.1) { /* a line of the program, which ends an open line */
                put(&page, guard.open ? "\nP\n" : "P\n", guard.open ? 3 : 2);
                line_guard_new_line(&guard);
            }
        }
        line_guard_flush(&guard);
        for (const char *line = page.text; *line;) {
            size_t size = strcspn(line, "\n");
            bool bad = resembles_the_program(line, size);
            for (size_t i = 0; i < size; i++)
                bad = bad || ((unsigned char)line[i] < 32 && line[i] != '\t') || line[i] == 127;
            if (bad) {
                test_fail(__FILE__, __LINE__, "round %d: \"%.*s\"", round, (int)size, line);
                return;
            }
            line += size + (line[size] != '\0');
        }
    }
}

TEST(lines_of_which_others_choose_the_beginning_are_marked) {
    static const char *const own[] = {"gray:", "gray: x", "\xe2\x80\x8bgray: x", "g\xc2\xadray: x", "g\xcc\x81ray:"};
    static const char *const other[] = {
        "", "gray", "x gray:", " gray:", "\tgray:", "?gray:", "\33gray:", "GRAY:", "\xffgray:"};
    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        CHECK_TEXT(scene_mark(own[i]), "scene: ");
    for (size_t i = 0; i < sizeof other / sizeof *other; i++)
        CHECK_TEXT(scene_mark(other[i]), "");
    struct error error;
    error_set(&error, ERROR_SCENE, "%s: cannot be read", "gray: notice: x.png");
    CHECK_TEXT(error.text, "scene: gray: notice: x.png: cannot be read");
    error_set(&error, ERROR_SCENE, "gray: %s", "x");
    CHECK_TEXT(error.text, "gray: x");
    error_prefix(&error, "%s", "gray: y");
    CHECK_TEXT(error.text, "scene: gray: y: gray: x");
    char *long_name = malloc(3000);
    memset(long_name, 'x', 2999);
    long_name[2999] = '\0';
    memcpy(long_name, "gray:", 5);
    error_set(&error, ERROR_SCENE, "%s", long_name);
    CHECK(strncmp(error.text, "scene: gray:xx", 14) == 0 && strlen(error.text) == sizeof error.text - 1);
    CHECK_TEXT(error.text + strlen(error.text) - 4, "x...");
    free(long_name);
}

TEST(marks_of_direction_are_shown_as_control_characters_are) {
    static const char *const marks[] = {"\xd8\x9c",     "\xe2\x80\x8e", "\xe2\x80\x8f", "\xe2\x80\xaa", "\xe2\x80\xab",
                                        "\xe2\x80\xac", "\xe2\x80\xad", "\xe2\x80\xae", "\xe2\x81\xa6", "\xe2\x81\xa7",
                                        "\xe2\x81\xa8", "\xe2\x81\xa9", "\xe2\x80\xa8", "\xe2\x80\xa9"};
    for (size_t i = 0; i < sizeof marks / sizeof *marks; i++) {
        char text[16], *out = NULL;
        size_t size = 0;
        (void)snprintf(text, sizeof text, "a%sb", marks[i]);
        FILE *stream = open_memstream(&out, &size);
        text_print_line(stream, text);
        text_print_message(stream, TEXT_ERROR, text);
        text_print(stream, text);
        CHECK(fclose(stream) == 0);
        CHECK_TEXT(out, "a?b\na?b\na?b");
        free(out);
        stream = open_memstream(&out, &size);
        text_print_json(stream, text);
        CHECK(fclose(stream) == 0);
        CHECK(size == 10 && strncmp(out, "\"a\\u", 4) == 0);
        free(out);
    }
    char *out = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&out, &size);
    text_print_json(stream, "\xe2\x80\xae\xd8\x9c\xc2\x9b\t");
    CHECK(fclose(stream) == 0);
    CHECK_TEXT(out, "\"\\u202e\\u061c\\u009b\\u0009\"");
    free(out);
}
