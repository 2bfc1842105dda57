/* Names that scenes give to pictures. The rows are attacks: see attack.h. Everything that a row does not name must be
 * unchanged. */
#define _GNU_SOURCE
#include "tests/attack.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NAME_250 "string.rep('n', 250)" /* a Lua expression; 254 bytes with .png, too long with a dot and digits */
#define LISTS ".png|.pfm|.hdr|.exr|-o"

TEST(hostile_names_without_an_ending_get_one_and_one_notice) {
    static const struct attack rows[] = {
        {.name = "a name without a dot",
         .scene = "p'frame'",
         .says = "frame.png|notice:",
         .notices = 1,
         .after = "picture frame.png"},
        {.name = "digits after the dot",
         .scene = "p'frame.001'",
         .says = "frame.001.png|notice:",
         .notices = 1,
         .after = "picture frame.001.png"},
        {.name = "digits only", .scene = "p'007'", .notices = 1, .after = "picture 007.png"},
        {.name = "two dots and digits", .scene = "p'a.1.2'", .notices = 1, .after = "picture a.1.2.png"},
        {.name = "an ending and digits",
         .scene = "p'build.sh.001'",
         .before = "sh build.sh",
         .notices = 1,
         .after = "picture build.sh.001.png"},
        {.name = "the dot is in the folder",
         .scene = "p'v1.sh/frame'",
         .notices = 1,
         .after = "dir v1.sh; picture v1.sh/frame.png"},
        {.name = "a folder without an ending in another",
         .scene = "p'a/b/c'",
         .notices = 1,
         .after = "dir a; dir a/b; picture a/b/c.png"},
        {.name = "Makefile stays",
         .before = "text Makefile",
         .scene = "p'Makefile'",
         .notices = 1,
         .after = "picture Makefile.png"},
        {.name = "a picture without an ending stays",
         .before = "png frame",
         .scene = "p'frame'",
         .notices = 1,
         .after = "picture frame.png"},
        {.name = "a program without an ending stays",
         .before = "bytes run %7fELF%02%01%01; mode run 755",
         .scene = "p'run'",
         .notices = 1,
         .after = "picture run.png"},
        {.name = "the name with its new ending is text",
         .before = "text frame.png",
         .scene = "p'frame'",
         .status = 1,
         .says = "frame.png"},
        {.name = "the name with its new ending is a link",
         .before = "link frame.png ../out/canary.png",
         .scene = "p'frame'",
         .status = 1,
         .says = "frame.png|-o"},
        {.name = "the name with its new ending is a FIFO",
         .before = "fifo frame.png; reader frame.png",
         .scene = "p'frame'",
         .status = 1,
         .says = "frame.png"},
        {.name = "many names without an ending",
         .scene = "for i = 1, 9 do p('f' .. i) end",
         .notices = 1,
         .after = "picture f1.png; picture f2.png; picture f3.png; picture f4.png; picture f5.png; picture f6.png; "
                  "picture f7.png; picture f8.png; picture f9.png"},
        {.name = "a dot that is not ASCII",
         .scene = "p'x\xef\xbc\x8esh'",
         .notices = 1,
         .after = "picture x\xef\xbc\x8esh.png"},
        {.name = "without an ending under --lenient",
         .options = "--lenient",
         .scene = "p'frame.7'",
         .notices = 1,
         .after = "picture frame.7.png"},
    };
    ATTACKS(rows);
}

TEST(hostile_names_with_a_picture_s_ending_are_kept) {
    static const struct attack rows[] = {
        {.name = "png", .scene = "p'x.png'", .notices = -1, .after = "picture x.png"},
        {.name = "capitals",
         .scene = "p'x.PNG' p'x.Pfm' p'x.HDR'",
         .notices = -1,
         .after = "picture x.PNG; picture x.Pfm; picture x.HDR"},
        {.name = "two dots",
         .scene = "p'x..png' p'x.sh.png'",
         .notices = -1,
         .after = "picture x..png; picture x.sh.png"},
        {.name = "a blank", .scene = "p'a b.png'", .notices = -1, .after = "picture a%20b.png"},
        {.name = "a dash before it",
         .scene = "p'-.png' p'-o.png'",
         .notices = -1,
         .after = "picture -.png; picture -o.png"},
        {.name = "signs of format",
         .scene = "p'%d.png' p'%s%n.png'",
         .notices = -1,
         .after = "picture %25d.png; picture %25s%25n.png"},
        {.name = "signs of the shell",
         .scene = "p'$(touch harm).png' p'`touch harm`;&|.png'",
         .notices = -1,
         .after = "picture $(touch%20harm).png; picture `touch%20harm`%3b&|.png"},
        {.name = "UTF-8", .scene = "p'b\xc3\xa4r.png'", .notices = -1, .after = "picture b\xc3\xa4r.png"},
        {.name = "the way leads through folders that are there",
         .before = "dir a; dir b",
         .scene = "p'a/../b/./x.png' p'.//y.png'",
         .notices = -1,
         .after = "picture b/x.png; picture y.png"},
        {.name = "a link to a folder inside",
         .before = "dir a; link b a",
         .scene = "p'b/x.png'",
         .after = "picture a/x.png"},
        {.name = "the same picture twice", .scene = "p'x.png' p('x.png', 5, 4)", .after = "picture x.png"},
        {.name = "a picture, read as a texture, and again",
         .scene = "p'x.png' t'x.png' p'x.png' t'./x.png' p'./x.png'",
         .after = "picture x.png"},
    };
    ATTACKS(rows);
}

TEST(hostile_names_with_another_ending_are_errors_that_list_the_endings) {
    static const struct attack rows[] = {
        {.name = "build.sh, which is there",
         .before = "sh build.sh; mode build.sh 755",
         .scene = "p'build.sh'",
         .status = 1,
         .says = "build.sh|" LISTS},
        {.name = "build.sh, which is not there", .scene = "p'build.sh'", .status = 1, .says = "build.sh|" LISTS},
        {.name = "build.sh, which is empty",
         .before = "empty build.sh; mode build.sh 755",
         .scene = "p'build.sh'",
         .status = 1,
         .says = "build.sh|" LISTS},
        {.name = "build.sh, which begins as a picture",
         .before = "png build.sh; mode build.sh 755",
         .scene = "p'build.sh'",
         .status = 1,
         .says = "build.sh|" LISTS},
        {.name = "x.ppm", .scene = "p'x.ppm'", .status = 1, .says = "x.ppm|" LISTS},
        {.name = "jpeg, which gray reads only",
         .before = "jpeg x.jpg",
         .scene = "p'x.jpg'",
         .status = 1,
         .says = "x.jpg|" LISTS},
        {.name = "an ending after a picture's",
         .before = "sh x.png.sh",
         .scene = "p'x.png.sh'",
         .status = 1,
         .says = "x.png.sh|" LISTS},
        {.name = "the scene by its name", .scene = "p'scene.lua'", .status = 1, .says = "scene.lua|" LISTS},
        {.name = "digits and a letter", .scene = "p'x.00a'", .status = 1, .says = LISTS},
        {.name = "a number with a sign", .scene = "p'x.-1'", .status = 1, .says = LISTS},
        {.name = "a number with an exponent", .scene = "p'x.1e5'", .status = 1, .says = LISTS},
        {.name = "digits of another script", .scene = "p'x.\xd9\xa1'", .status = 1, .says = LISTS},
        {.name = "a blank after the ending", .scene = "p'x.png '", .status = 1, .says = LISTS},
        {.name = "a line end after the ending", .scene = "p'x.png\\n'", .status = 1},
        {.name = "a blank after the dot", .scene = "p'x. png'", .status = 1, .says = LISTS},
        {.name = "a stream of another system", .scene = "p'x.png:y'", .status = 1, .says = LISTS},
        {.name = "a dotted I", .scene = "p'x.p\xc4\xb0g'", .status = 1, .says = LISTS},
        {.name = "an ending that is not UTF-8", .scene = "p'x.png\\xff'", .status = 1},
        {.name = "a library", .before = "bytes x.so %7fELF", .scene = "p'x.so'", .status = 1, .says = LISTS},
        {.name = "caught, and the next picture is made",
         .before = "sh build.sh",
         .scene = "assert(not pcall(p, 'build.sh')) p'x.png'",
         .after = "picture x.png"},
    };
    ATTACKS(rows);
}

TEST(hostile_names_under_lenient_get_a_picture_s_ending) {
    static const struct attack rows[] = {
        {.name = "x.ppm", .options = "--lenient", .scene = "p'x.ppm'", .after = "picture x.ppm.png"},
        {.name = "build.sh",
         .before = "sh build.sh; mode build.sh 755",
         .options = "--lenient",
         .scene = "p'build.sh'",
         .after = "picture build.sh.png"},
        {.name = "a link at build.sh",
         .before = "link build.sh ../out/canary.txt",
         .options = "--lenient",
         .scene = "p'build.sh'",
         .after = "picture build.sh.png"},
        {.name = "a FIFO at x.ppm",
         .before = "fifo x.ppm; reader x.ppm",
         .options = "--lenient",
         .scene = "p'x.ppm'",
         .after = "picture x.ppm.png"},
        {.name = "text at the name with its new ending",
         .before = "text x.ppm.png",
         .options = "--lenient",
         .scene = "p'x.ppm'",
         .status = 1,
         .says = "x.ppm.png"},
        {.name = "a link at the name with its new ending",
         .before = "link x.ppm.png ../out/canary.png",
         .options = "--lenient",
         .scene = "p'x.ppm'",
         .status = 1,
         .says = "x.ppm.png|-o"},
        {.name = "a folder's name", .options = "--lenient", .scene = "p'x.png/'", .status = 1},
        {.name = "a hidden name", .options = "--lenient", .scene = "p'.profile'", .status = 1},
        {.name = "standard output", .options = "--lenient", .scene = "p'-'", .status = 1, .says = "!PNG"},
        {.name = "outside", .options = "--lenient", .scene = "p'../out/canary.txt'", .status = 1},
        {.name = "x.png stays x.png",
         .options = "--lenient",
         .scene = "p'x.png'",
         .notices = -1,
         .after = "picture x.png"},
        {.name = "too long with its new ending",
         .options = "--lenient",
         .scene = "p(" NAME_250 " .. '.sh')",
         .status = 1},
    };
    ATTACKS(rows);
}

TEST(hostile_names_of_no_file_are_errors) {
    static const struct attack rows[] = {
        {.name = "the empty name", .scene = "p''", .status = 1},
        {.name = "standard output", .scene = "p'-'", .status = 1, .says = "!PNG"},
        {.name = "standard output below --check", .options = "--check", .scene = "p'-'", .status = 1},
        {.name = "an ending alone", .scene = "p'.png'", .status = 1},
        {.name = "a hidden name", .scene = "p'.bashrc'", .status = 1},
        {.name = "a hidden picture", .before = "png .x.png", .scene = "p'.x.png'", .status = 1},
        {.name = "a hidden folder", .before = "dir .ssh", .scene = "p'.ssh/x.png'", .status = 1},
        {.name = "a hidden folder behind a link",
         .before = "dir .ssh; link ssh .ssh",
         .scene = "p'ssh/x.png'",
         .status = 1},
        {.name = "dots", .scene = "p'..'", .status = 1},
        {.name = "a dot", .scene = "p'.'", .status = 1},
        {.name = "a name that ends in a slash", .scene = "p'x.png/'", .status = 1},
        {.name = "a picture as a folder", .before = "png x.png", .scene = "p'x.png/'", .status = 1},
        {.name = "the folder itself", .before = "dir x.png", .scene = "p'x.png'", .status = 1, .says = "x.png"},
        {.name = "a dot at the end", .scene = "p'x.png.'", .status = ATTACK_ANY, .after = "maybe x.png..png"},
        {.name = "a zero byte before another ending",
         .before = "sh build.sh",
         .scene = "p'build.sh\\0.png'",
         .status = 1},
        {.name = "a zero byte after the ending", .scene = "p'x.png\\0'", .status = 1},
        {.name = "a name of 256 bytes", .scene = "p(" NAME_250 " .. 'nn.png')", .status = 1},
        {.name = "a name of 252 bytes that gets an ending", .scene = "p(" NAME_250 " .. 'nn')", .status = 1},
        {.name = "a name of 5000 bytes", .scene = "p(string.rep('n', 5000) .. '.png')", .status = 1},
        {.name = "a way of 5000 bytes", .scene = "p(string.rep('./', 2500) .. 'x.png')", .status = 1},
    };
    ATTACKS(rows);
}

TEST(hostile_names_of_other_folders_are_errors) {
    static const struct attack rows[] = {
        {.name = "the folder above", .scene = "p'../x.png'", .status = 1, .says = "x.png|-o"},
        {.name = "a picture beside", .scene = "p'../out/canary.png'", .status = 1, .says = "canary.png|-o"},
        {.name = "by way of a folder that is not there", .scene = "p'a/../../out/x.png'", .status = 1},
        {.name = "a link to the folder beside", .before = "link far ../out", .scene = "p'far/x.png'", .status = 1},
        {.name = "a link to a link to it",
         .before = "link far ../out; link near far",
         .scene = "p'near/new/x.png'",
         .status = 1},
        {.name = "a link that leads nowhere yet",
         .before = "link far ../out/new",
         .scene = "p'far/x.png'",
         .status = 1},
        {.name = "a link to the root", .before = "link far /", .scene = "p'far/tmp/x.png'", .status = 1},
        {.name = "standard output as a device", .scene = "p'/dev/stdout'", .status = 1, .says = "!PNG"},
        {.name = "standard output as a descriptor", .scene = "p'/dev/fd/1.png'", .status = 1, .says = "!PNG"},
        {.name = "standard error of the process", .scene = "p'/proc/self/fd/2'", .status = 1, .says = "!PNG"},
        {.name = "a link to the descriptors",
         .before = "link d /proc/self/fd",
         .scene = "p'd/1'",
         .status = 1,
         .says = "!PNG"},
        {.name = "the working directory of the process",
         .scene = "p'/proc/self/cwd/x.png'",
         .status = ATTACK_ANY,
         .after = "maybe x.png"},
        {.name = "a FIFO as a folder", .before = "fifo f; reader f", .scene = "p'f/x.png'", .status = 1},
        {.name = "a file as a folder", .before = "text f", .scene = "p'f/x.png'", .status = 1},
        {.name = "a picture of this run as a folder",
         .scene = "p'f.png' p'f.png/x.png'",
         .status = 1,
         .after = "picture f.png"},
        {.name = "a folder that --allow-write names",
         .options = "--allow-write ../out",
         .scene = "p'../out/new.png' p'../out/canary.png'",
         .after = "picture ../out/new.png; picture ../out/canary.png"},
        {.name = "text in a folder that --allow-write names",
         .before = "text ../out/x.png",
         .options = "--allow-write ../out",
         .scene = "p'../out/x.png'",
         .status = 1},
        {.name = "another ending in a folder that --allow-write names",
         .options = "--allow-write ../out",
         .scene = "p'../out/canary.txt'",
         .status = 1,
         .says = LISTS},
        {.name = "a FIFO in a folder that --allow-write names",
         .before = "fifo ../out/x.png",
         .options = "--allow-write ../out",
         .scene = "p'../out/x.png'",
         .status = 1},
    };
    ATTACKS(rows);
}

TEST(hostile_names_cannot_speak_for_the_program) {
    static const struct attack rows[] = {
        {.name = "a line end before words of the program",
         .scene = "p'x\\ngray: error: all is lost.sh'",
         .status = 1,
         .says = "!\ngray: error"},
        {.name = "a return before words of the program",
         .scene = "p'x\\rgray: all is well.sh'",
         .status = 1,
         .says = "!\rgray"},
        {.name = "an escape sequence", .scene = "p'\\27[2Jx\\27]0;title\\7.sh'", .status = 1, .says = "!\x1b|!\a"},
        {.name = "a control character of eight bits", .scene = "p'\\xc2\\x9b2Jx.sh'", .status = 1, .says = "!\xc2\x9b"},
        {.name = "a mark of direction", .scene = "p'x\\u{202e}gnp.sh'", .status = 1, .says = "!\xe2\x80\xae"},
        {.name = "isolates of direction",
         .scene = "p'x\\u{2066}gnp\\u{2069}.sh'",
         .status = 1,
         .says = "!\xe2\x81\xa6|!\xe2\x81\xa9"},
        {.name = "a mark of direction in a picture's name",
         .options = "--verbose --stats",
         .scene = "p'x\\u{202e}gnp.png'",
         .status = ATTACK_ANY,
         .says = "!\xe2\x80\xae",
         .after = "maybe x\xe2\x80\xaegnp.png"},
        {.name = "a line end in a picture's name",
         .options = "--verbose --stats --progress=lines",
         .scene = "p'x\\ngray: harm.png'",
         .status = ATTACK_ANY,
         .says = "!\ngray: harm",
         .after = "maybe x%0agray:%20harm.png"},
        {.name = "a name that gets an ending and a notice",
         .scene = "p'x\\ngray: harm'",
         .status = ATTACK_ANY,
         .says = "!\ngray: harm",
         .after = "maybe x%0agray:%20harm.png"},
        {.name = "a name that is not UTF-8",
         .scene = "p'x\\xff\\xfe.png'",
         .status = ATTACK_ANY,
         .says = "!\xff",
         .after = "maybe x\xff\xfe.png"},
        {.name = "a name under the name of the program", .scene = "p'gray: done.sh'", .status = 1, .says = "scene.lua"},
    };
    ATTACKS(rows);
}

/* Reads one JSON text; NULL if it is invalid. Enough for lines of progress and statistics. */
static const char *json_end(const char *at);
static const char *json_text(const char *at) {
    if (*at++ != '"')
        return NULL;
    while (*at && *at != '"') {
        if ((unsigned char)*at < ' ')
            return NULL;
        at += 1 + (*at == '\\' && at[1] != '\0');
    }
    return *at == '"' ? at + 1 : NULL;
}

static const char *json_list(const char *at, char last) {
    for (at++; *at != last;) {
        if (last == '}') {
            at = json_text(at);
            if (!at || *at++ != ':')
                return NULL;
        }
        at = json_end(at);
        if (!at || (*at != ',' && *at != last))
            return NULL;
        at += *at == ',';
    }
    return at + 1;
}

static const char *json_end(const char *at) {
    if (*at == '"')
        return json_text(at);
    if (*at == '{' || *at == '[')
        return json_list(at, *at == '{' ? '}' : ']');
    size_t length = strspn(at, "-+.0123456789eEtrufalsn");
    return length > 0 ? at + length : NULL;
}

static void check_json(const char *what, char *text) {
    int lines = 0;
    char *rest = NULL;
    for (char *line = strtok_r(text, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
        const char *end = line[0] == '{' ? json_end(line) : NULL;
        if (line[0] == '{')
            lines++;
        if ((line[0] == '{' && (!end || *end != '\0')) || strncmp(line, "{\"harm\"", 7) == 0)
            test_fail(__FILE__, __LINE__, "%s is no JSON: %.300s", what, line);
    }
    CHECK(lines > 0);
}

TEST(hostile_names_leave_json_json) {
    static const char *const names[] = {"a\\\",\\\"event\\\":\\\"harm.png",
                                        "a\\\\\\\\.png",
                                        "b\\n{\\\"harm\\\":1}\\n.png",
                                        "c\\1\\27[0m\\127.png",
                                        "d\\xff\\xc0\\x80.png",
                                        "e\\u{202e}\\u{2028}.png"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char *scene = NULL;
        CHECK(asprintf(&scene, "%sp(\"%s\", 30, 30)\n", attack_prelude, names[i]) > 0);
        struct test_result result = test_gray_scene(scene, "--progress=json --stats=json scene.lua", NULL);
        CHECK(result.status == 0 || result.status == 1);
        if (result.status == 0) {
            check_json("progress", result.err);
            check_json("statistics", result.out);
        }
        test_free_result(&result);
        free(scene);
    }
}
