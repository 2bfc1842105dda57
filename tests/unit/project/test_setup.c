/* tools/setup.sh, with an archive, a user and libraries that the test makes up; render_all.sh, with a program and
 * scenes that it makes up. */
#define _GNU_SOURCE
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>

/* Programs that stand before those of the machine: pkg-config and command -v know what is listed in the file `have`,
 * apt-get adds to it, except what is in $refuse. */
static void make_machine(void) {
    CHECK(system(NULL) != 0);
    char *line = NULL;
    if (asprintf(
            &line,
            "cd '%s' && mkdir bin && cd bin && "
            "printf '#!/bin/sh\\ngrep -qx \"$2\" ../have\\n' >pkg-config && "
            "printf '#!/bin/sh\\necho $uid\\n' >id && "
            "printf '#!/bin/sh\\n[ \"$sudo\" = yes ] && shift && exec \"$@\"\\n' >sudo && "
            "cat >apt-get <<'END'\n"
            "#!/bin/sh\n"
            "echo \"$@\" >>../log\n"
            "for word in \"$@\"; do case $word in lib*-dev) case \" $refuse \" in *\" $word \"*) exit 100 ;; esac ;; "
            "esac; done\n"
            "for word in \"$@\"; do case $word in lib*-dev) echo $word >>../installed ;; esac; done\n"
            "exit 0\n"
            "END\n"
            "chmod +x *",
            test_folder()) < 0)
        exit(1);
    CHECK(system(line) == 0);
    free(line);
}

#define NEEDED "lua5.4\\nlibpng\\nzlib\\n"
#define ALL NEEDED "libjpeg\\njansson\\nfreetype2\\nOpenEXR\\nlibwebpmux\\n"

/* The status; standard error is in the file err. */
static int set_up(const char *have, const char *environment, const char *option) {
    char *line = NULL, root[4096];
    CHECK(realpath(".", root) != NULL);
    if (asprintf(&line,
                 "cd '%s/bin' && rm -f ../log ../installed && printf '%s' >../have && "
                 "DISPLAY= WAYLAND_DISPLAY= %s PATH=\"$PWD:$PATH\" CC=gcc sh '%s/tools/setup.sh' %s 2>../err",
                 test_folder(), have, environment, root, option) < 0)
        exit(1);
    int status = system(line);
    free(line);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void check_file(const char *name, const char *text) {
    char *found = test_read_file(test_path(name), NULL);
    if (!found && text)
        test_fail(__FILE__, __LINE__, "%s is not there", name);
    else if (found && (!text || strcmp(found, text) != 0))
        test_fail(__FILE__, __LINE__, "%s has \"%s\", not \"%s\"", name, found, text ? text : "");
    free(found);
}

TEST(the_set_up_installs_the_optional_libraries_too) {
    make_machine();
    CHECK_EQ_INT(set_up(NEEDED, "uid=0", ""), 0);
    check_file("installed", "libjpeg-dev\nlibjansson-dev\nlibfreetype-dev\nlibopenexr-dev\nlibwebp-dev\n");
    CHECK_EQ_INT(set_up(NEEDED, "uid=7 sudo=yes", ""), 0);
    check_file("installed", "libjpeg-dev\nlibjansson-dev\nlibfreetype-dev\nlibopenexr-dev\nlibwebp-dev\n");
    CHECK_EQ_INT(set_up(ALL, "uid=0", ""), 0);
    check_file("err", "");
    check_file("log", NULL);
}

/* On request, or where there is a display and apt-get names fewer than 100 packages; then its tests have tools. */
TEST(the_set_up_installs_gtk_where_it_is_wanted) {
    make_machine();
    CHECK_EQ_INT(set_up(ALL, "uid=0", "--window"), 0);
    check_file("installed", "libgtk-4-dev\n");
    CHECK_EQ_INT(set_up(ALL, "uid=0", "--tests --window"), 0);
    char *said = test_read_file(test_path("err"), NULL);
    CHECK(said && strstr(said, "installing with apt-get (window): libgtk-4-dev"));
    free(said);
    for (int large = 0; large < 2; large++) {
        test_write_text(test_path("bin/plan"), large ? "0 upgraded, 310 newly installed, 0 to remove.\n"
                                                     : "0 upgraded, 44 newly installed, 0 to remove.\n"
                                                       "After this operation, 70 MB of additional disk space\n");
        CHECK(rename(test_path("bin/apt-get"), test_path("bin/rest")) == 0);
        test_write_text(test_path("bin/apt-get"),
                        "#!/bin/sh\ncase \"$*\" in *assume-no*) cat plan ;; *) exec ./rest \"$@\" ;; "
                        "esac\n");
        CHECK(chmod(test_path("bin/apt-get"), 0755) == 0);
        CHECK_EQ_INT(set_up(ALL, "uid=0 DISPLAY=:9", ""), 0);
        check_file("installed", large ? NULL : "libgtk-4-dev\n");
        CHECK_EQ_INT(set_up(ALL, "uid=0 DISPLAY=:9", "--no-window"), 0);
        check_file("installed", NULL);
        CHECK(rename(test_path("bin/rest"), test_path("bin/apt-get")) == 0);
    }
}

TEST(a_library_that_cannot_be_had_is_named_and_left_out) {
    make_machine();
    CHECK_EQ_INT(set_up(NEEDED, "uid=0 refuse='libjansson-dev libopenexr-dev'", ""), 0);
    check_file("installed", "libjpeg-dev\nlibfreetype-dev\nlibwebp-dev\n");
    check_file("err", "installing with apt-get (libraries): libjpeg-dev libjansson-dev libfreetype-dev libopenexr-dev "
                      "libwebp-dev\n"
                      "libjansson-dev could not be installed: it is left out\n"
                      "libopenexr-dev could not be installed: it is left out\n");
}

TEST(a_minimal_set_up_has_what_the_build_needs) {
    make_machine();
    CHECK_EQ_INT(set_up(NEEDED, "uid=0", "--minimal"), 0);
    check_file("log", NULL);
    CHECK_EQ_INT(set_up("lua5.4\\nzlib\\n", "uid=0", "--minimal"), 0);
    check_file("installed", "libpng-dev\n");
    CHECK_EQ_INT(set_up("lua5.4\\nzlib\\n", "uid=0 refuse=libpng-dev", "--minimal"), 1);
    CHECK_EQ_INT(set_up(ALL, "uid=0", "--check"), 0);
    CHECK_EQ_INT(set_up("zlib\\n", "uid=0", "--check"), 1);
    check_file("log", NULL);
}

TEST(a_user_who_may_not_install_gets_one_line_with_the_command) {
    make_machine();
    CHECK_EQ_INT(set_up("lua5.4\\n", "uid=7", ""), 1);
    check_file("err",
               "gray needs packages; to install them: sudo apt-get install -y --no-install-recommends libpng-dev "
               "zlib1g-dev libjpeg-dev libjansson-dev libfreetype-dev libopenexr-dev libwebp-dev\n");
    CHECK_EQ_INT(set_up(ALL "no", "uid=7", ""), 0);
    check_file("err", "");
    CHECK_EQ_INT(set_up(NEEDED, "uid=7", ""), 0);
    check_file("err", "optional packages are missing; to install them: sudo apt-get install -y --no-install-recommends "
                      "libjpeg-dev libjansson-dev libfreetype-dev libopenexr-dev libwebp-dev\n");
    check_file("log", NULL);
}

TEST(the_set_up_names_the_packages_of_other_systems) {
    make_machine();
    CHECK_EQ_INT(set_up(ALL, "", "--for fedora >../fedora"), 0);
    check_file("fedora", "sudo dnf install make gcc glibc-devel pkgconf-pkg-config lua-devel libpng-devel zlib-devel "
                         "libjpeg-turbo-devel jansson-devel freetype-devel openexr-devel libwebp-devel\n");
    CHECK_EQ_INT(set_up(ALL, "", "--for arch --minimal >../arch"), 0);
    check_file("arch", "sudo pacman -S --needed make gcc glibc pkgconf lua libpng zlib\n");
    CHECK_EQ_INT(set_up(ALL, "", "--for alpine --minimal >../alpine"), 0);
    check_file("alpine", "sudo apk add make gcc musl-dev pkgconf lua5.4-dev libpng-dev zlib-dev\n");
    CHECK_EQ_INT(set_up(ALL, "", "--for"), 2);
    check_file("err", "setup.sh: --for is fedora, arch or alpine\n");
    check_file("log", NULL);
}

/* Every group has one line, and what apt-get prints is not shown. Of the tools this machine may have any. */
TEST(the_set_up_prints_one_line_for_each_group) {
    make_machine();
    CHECK_EQ_INT(set_up("lua5.4\\nzlib\\n", "uid=0", "--tests"), 0);
    char *said = test_read_file(test_path("err"), NULL);
    CHECK(said && strncmp(said, "installing with apt-get (build): libpng-dev\n", 44) == 0);
    CHECK(said && strstr(said, "installing with apt-get (libraries): libjpeg-dev libjansson-dev libfreetype-dev "
                               "libopenexr-dev libwebp-dev\n"));
    CHECK(said && !strstr(said, "(window)"));
    CHECK(said && strstr(said, "installing with apt-get (machines): libopenmpi-dev"));
    for (const char *line = said; line && line[0] != '\0'; line = strchr(line, '\n') + 1)
        CHECK(strncmp(line, "installing with apt-get (", 25) == 0);
    free(said);
}

TEST(an_archive_that_does_not_answer_is_tried_once) {
    make_machine();
    test_write_text(test_path("bin/apt-get"), "#!/bin/sh\necho \"$@\" >>../log\nexit 100\n");
    CHECK_EQ_INT(set_up(NEEDED, "uid=0", "--tests"), 0);
    char *said = test_read_file(test_path("err"), NULL), *log = test_read_file(test_path("log"), NULL);
    CHECK(said && strstr(said, "the archive does not answer: tests that need it are skipped\n"));
    int calls = 0;
    for (const char *line = log; line && (line = strchr(line, '\n')) != NULL; line++)
        calls++;
    CHECK_EQ_INT(calls, 3); /* the first group, the lists, the group again */
    free(said);
    free(log);
}

/* A tree with render_all.sh, a program that writes what is no picture, and two scenes beside those of the plan. */
static void make_gallery(const char *plan) {
    char *line = NULL, root[4096];
    CHECK(realpath(".", root) != NULL);
    test_write_text(test_path("plan"), plan);
    if (asprintf(&line,
                 "cd '%s' && mkdir -p tools data/path data/csg data/functions data/library data/classic && "
                 "cp '%s/render_all.sh' . && cp '%s/data/gallery.html' data && cp plan data/gallery.txt && "
                 "printf '#!/bin/sh\\necho set up $@\\n' >tools/setup.sh && chmod +x tools/setup.sh && "
                 "printf 'all:\\n' >Makefile && "
                 "for f in $(sed -n 's/ [0-9]*$//p' plan | grep ^data) data/path/new.lua data/csg/make_it.lua; do "
                 "echo '-- TITLE: '$(basename $f .lua) '& more' >$f; done && "
                 "cat >gray <<'END'\n"
                 "#!/bin/sh\n"
                 "for word in \"$@\"; do case $word in *%%02d.png) out=${word%%%%%%02d*}; esac; done\n"
                 "case $out in *broken*) exit 1;; *sleeper*) [ -z \"$GRAY_SCENE_LIMIT\" ] || sleep 100;; *clock*) echo "
                 "picture >${out}02.png;; *path*) "
                 "echo printed;; *14demo*) printf 'header, 16 bytes\\0\\0\\1\\220\\0\\0\\1\\54' >${out}01.png; exit "
                 "0;; esac\n"
                 "echo picture >${out}01.png\n"
                 "END\n"
                 "chmod +x gray",
                 test_folder(), root, root) < 0)
        exit(1);
    CHECK(system(line) == 0);
    free(line);
}

/* Runs it; out.txt has what it prints. */
static int render_all(void) {
    return test_run_shell("sh render_all.sh", ">out.txt 2>err.txt");
}

static void check_has(const char *name, const char *words) {
    char *text = test_read_file(test_path(name), NULL);
    if (!text || !strstr(text, words))
        test_fail(__FILE__, __LINE__, "%s does not have \"%s\"", name, words);
    free(text);
}

TEST(a_minimal_set_up_is_an_option_of_rendering_all_scenes) {
    make_gallery("[A]\ndata/14demo.lua 1\n[B]\ndata/10demo.lua 1\n");
    CHECK_EQ_INT(test_run_shell("sh render_all.sh --minimal", ">out.txt"), 0);
    check_has("out.txt", "\nset up --minimal --no-window\n");
    CHECK_EQ_INT(test_run_shell("sh render_all.sh --small", "2>err.txt"), 2);
    check_has("err.txt", "Usage: ./render_all.sh [--minimal]\n");
}

/* The picture of 14demo has 400 x 300 pixels. */
TEST(the_gallery_has_the_shape_of_each_picture_and_the_command_that_made_it) {
    make_gallery("[A]\ndata/14demo.lua 1\n[B]\ndata/10demo.lua 1\n");
    CHECK_EQ_INT(render_all(), 0);
    check_has("gallery/index.html",
              "<figure style=\"--shape: 1.33333\">\n<a class=\"picture\" href=\"14demo.png\"><img "
              "src=\"14demo.png\" width=\"400\" height=\"300\" alt=\"14demo &amp; more\"");
    check_has("gallery/index.html", "./gray --size 1280x960 -ss 3 -al-samples 8 -o gallery/14demo-%02d.png <a "
                                    "href=\"../data/14demo.lua\">data/14demo.lua</a></code>");
    check_has("out.txt", "\ndone: open gallery/index.html in a browser; docs/start.md leads to your first scene; ");
}

TEST(the_gallery_opens_with_the_first_finished_picture_and_shows_its_loop) {
    make_gallery("[A]\ndata/10demo.lua 1\n[B]\ndata/14demo.lua 1\n");
    CHECK_EQ_INT(render_all(), 0);
    CHECK_EQ_INT(test_run_shell("cp gallery/14demo.png data && echo film >data/14demo.mp4", ""), 0);
    CHECK_EQ_INT(render_all(), 0);
    check_has("gallery/index.html", "<p><img class=\"best\" src=\"../data/14demo.png\" width=\"400\" height=\"300\"");
    check_has("gallery/index.html", "<a class=\"picture\" href=\"../data/14demo.png\"><img src=\"14demo.png\"");
    check_has("gallery/index.html", "<video src=\"../data/14demo.mp4\" autoplay loop muted playsinline controls>");
}

TEST(rendering_all_scenes_says_how_long_it_takes_and_puts_the_best_first) {
    make_gallery("# a comment\n[Best pictures]\ndata/14demo.lua 95000\ndata/10demo.lua 3\n[Classic]\n"
                 "data/classic/clock.lua 1\n[Test charts]\ndata/01demo.lua 1\n");
    CHECK_EQ_INT(render_all(), 0);
    char *out = test_read_file(test_path("out.txt"), NULL),
         *page = test_read_file(test_path("gallery/index.html"), NULL);
    CHECK(out && strncmp(out, "rendering 5 scenes takes about ", 31) == 0 && strstr(out, " minutes with ") &&
          strstr(out, ", plus the build\n"));
    CHECK(strstr(out, "scene 1 of 5: data/14demo.lua --size 1280x960"));
    CHECK(strstr(out, "scene 5 of 5: data/01demo.lua"));
    CHECK(strstr(out, "left\nscene 5 of 5"));
    const char *const order[] = {"<h2>Best pictures</h2>", ">14demo &amp; more<",  ">10demo &amp; more<",
                                 "<h2>Classic</h2>",       "classic-clock-01.png", "<h2>More</h2>",
                                 ">new &amp; more<",       "<h2>Test charts</h2>", ">01demo &amp; more<"};
    const char *at = page;
    for (size_t i = 0; at && i < sizeof order / sizeof *order; i++) {
        at = strstr(at, order[i]);
        if (!at)
            test_fail(__FILE__, __LINE__, "%s is not in its place", order[i]);
    }
    CHECK(page && !strstr(page, "make_it"));
    free(out);
    free(page);
}

TEST(a_scene_that_fails_is_named_at_the_end) {
    make_gallery("[A]\ndata/broken.lua 1\ndata/14demo.lua 1\n[B]\ndata/10demo.lua 1\n");
    CHECK_EQ_INT(render_all(), 1);
    char *err = test_read_file(test_path("err.txt"), NULL);
    CHECK(err && strstr(err, "render_all.sh: data/broken.lua failed with status 1\n"));
    CHECK(err && strstr(err, "render_all.sh: these failed: data/broken.lua; "));
    check_has("gallery/index.html", ">no picture: render_all.sh: data/broken.lua failed with status 1");
    free(err);
}

/* The script `sleeper` takes longer than a limit that the environment sets. */
TEST(a_scene_that_is_ended_at_its_limit_is_named_with_the_limit) {
    make_gallery("[A]\ndata/sleeper.lua 1\ndata/14demo.lua 1\n[B]\ndata/10demo.lua 1\n");
    CHECK_EQ_INT(render_all(), 0);
    CHECK(setenv("GRAY_SCENE_LIMIT", "3", 1) == 0);
    CHECK_EQ_INT(render_all(), 1);
    char *err = test_read_file(test_path("err.txt"), NULL);
    CHECK(err && strstr(err, "render_all.sh: data/sleeper.lua was ended at its limit of 3 seconds; "
                             "GRAY_SCENE_LIMIT=SECONDS sets another\n"));
    CHECK(err && strstr(err, "render_all.sh: these failed: data/sleeper.lua; "));
    free(err);
}

TEST(every_scene_of_the_gallery_is_there_with_its_time) {
    char *plan = test_read_file("data/gallery.txt", NULL);
    int scenes = 0;
    CHECK(plan != NULL);
    for (char *line = strtok(plan, "\n"); line; line = strtok(NULL, "\n")) {
        char script[256];
        double seconds;
        if (strncmp(line, "data/", 5) != 0)
            continue;
        CHECK(sscanf(line, "%255s %lf", script, &seconds) == 2 && seconds > 0);
        char *text = test_read_file(script, NULL);
        if (!text)
            test_fail(__FILE__, __LINE__, "%s is not there", script);
        free(text);
        scenes++;
    }
    CHECK(scenes > 40);
    free(plan);
}
