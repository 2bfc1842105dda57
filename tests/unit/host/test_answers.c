/* Answers at hand: topics of the manual, the manual pages, completion in shells, the first scene, and messages on a
 * terminal. */
#define _GNU_SOURCE
#include "tests/harness.h"

#include "session/options.h"
#include "session/options_table.h"
#include "settings/setting.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What gray --man prints of the words. */
static char *manual_of(const char *words, int status) {
    char line[1024];
    (void)snprintf(line, sizeof line, "$gray --man %s", words);
    test_shell(line, status, "");
    return test_read_file(test_path("out.txt"), NULL);
}

static void check_topic(const char *words, const char *has, const char *has_not) {
    char *text = manual_of(words, 0);
    if (!text || !strstr(text, has) || (has_not && strstr(text, has_not)))
        test_fail(__FILE__, __LINE__, "gray --man %s prints \"%.400s\"", words, text);
    free(text);
}

TEST(a_topic_is_answered_with_its_entries_and_nothing_else) {
    check_topic("sphere", "gr.sphere{name = ..., ...}\n    A sphere", "gr.torus");
    check_topic("gr.sphere", "gr.sphere{name", "Of gr.");
    check_topic("Node:Rotate", "node:rotate(axis, angle)", "gr.sphere");
    check_topic("node:rotate", "node:rotate(axis, angle)", "node:rotate_quat(");
    check_topic("--spp", "--spp N", "Of gr.render");
    check_topic("spp", "--spp N", "gr.sphere");
    check_topic("Spp", "Of gr.render, gr.render_skybox, gr.light_field, node:render\n", NULL);
    check_topic("shininess", "Exponent of the highlight. Of gr.material", "gr.sphere");
    check_topic("srgb", "gr.srgb(colour)", NULL);
    check_topic("knot", "require 'knot'", NULL);
    check_topic("sdf.smooth_union", "sdf.smooth_union(", "sdf.sphere(");
}

TEST(words_of_other_programs_and_of_descriptions_are_topics) {
    check_topic("extrude", "gray has no 'extrude'; use gr.prism\n\ngr.prism(", NULL);
    check_topic("transparency", "use the field refract", NULL);
    check_topic("shadow", "gr.area_light ", NULL);
}

TEST(an_unknown_topic_names_the_nearest_and_is_wrong_usage) {
    test_shell_errors("$gray --man sphre >out.txt", 2, "gray: nothing is known of 'sphre'; did you mean sphere?\n");
    test_shell_errors("$gray --man zzzz torus >out.txt", 2, "nothing is known of 'zzzz' (gray --man lists everything)");
    char *text = test_read_file(test_path("out.txt"), NULL);
    CHECK(text && strstr(text, "gr.torus("));
    free(text);
}

TEST(every_option_and_field_and_module_is_a_topic) {
    char line[16384] = "$gray --man >/dev/null";
    for (int i = 0; i < option_count(); i++) {
        size_t used = strlen(line);
        const char *name = option_at(i)->option ? option_at(i)->option : option_at(i)->field;
        if (name)
            (void)snprintf(line + used, sizeof line - used, " %.*s", (int)strcspn(name, "|"), name);
    }
    test_shell_errors(line, 0, NULL);
    char root[4096];
    CHECK(realpath("lua", root) != NULL);
    (void)snprintf(line, sizeof line, "cd '%s' && for f in [a-fh-z]*.lua; do $gray --man ${f%%.lua} || exit; done",
                   root);
    test_shell(line, 0, "local colour = require 'colour'");
}

TEST(the_manual_goes_through_the_pager_on_a_terminal_and_nowhere_else) {
    test_need_tools("script");
    test_shell("PAGER='sed s/^/paged:/' script -qec \"$gray --man sphere\" /dev/null", 0, "paged:gr.sphere(");
    test_shell("PAGER=/no/such/program script -qec \"$gray --man sphere\" /dev/null", 0, "gr.sphere(");
    test_shell("PAGER='sed s/^/paged:/' $gray --man sphere | tee copy.txt", 0, "gr.sphere(");
    char *text = test_read_file(test_path("copy.txt"), NULL);
    CHECK(text && !strstr(text, "paged:"));
    free(text);
}

TEST(manual_pages_have_all_options_and_functions_and_no_warnings) {
    test_need_tools("man");
    test_shell(
        "export LC_ALL=C.UTF-8 MANROFFSEQ= MANWIDTH=80; for page in gray gray-scene; do "
        "$gray --roff $page >$page.1 && man --warnings -l $page.1 2>&1 >$page.txt; done; cat gray.txt gray-scene.txt",
        0, "gr.sphere{name = ..., ...}");
    char *text = test_read_file(test_path("out.txt"), NULL);
    CHECK(text && strncmp(text, "GRAY(1)", 7) == 0); /* nothing before the pages */
    for (int i = 0; i < option_count() && text; i++)
        if (option_at(i)->option &&
            !memmem(text, strlen(text), option_at(i)->option, strcspn(option_at(i)->option, "|")))
            test_fail(__FILE__, __LINE__, "gray(1) has no %s", option_at(i)->option);
    CHECK(text && strstr(text, "EXIT STATUS") && strstr(text, "'_'"));
    free(text);
    test_shell_errors("$gray --roff nothing", 2, "gray: --roff prints the page gray or gray-scene");
}

/* Completion: every shell is asked the same. The last word of a line is being typed. */
static const struct {
    const char *line, *offers, *offers_not;
} questions[] = {
    {"gray --integr", "--integrator", "--spp"},
    {"gray --accel ", "kdtree", "scene.lua"},
    {"gray --accel k", "kdtree", "grid"},
    {"gray --accel=k", "kdtree", "grid"},
    {"gray sce", "scene.lua", "scene.txt"},
    {"gray -o sce", "scene.txt", "merge"},
    {"gray --allow-read ", "folder", "fresh"},
    {"gray --man spher", "sphere", "torus"},
    {"gray -q --tone fil", "filmic", "reinhard"},
    {"gray merge sce", "scene.txt", NULL},
    {"gray comp", "compare", "merge"},
    {"gray compare sce", "scene.txt", NULL},
};

/* The script prints "== " and the rest of a line before the answer to it. */
static void ask_shell(const char *program, const char *shell, const char *script) {
    char line[6000], mark[64];
    test_need_tools(program);
    CHECK_EQ_INT(test_run_shell("mkdir bin folder && ln -s $gray bin/gray && touch scene.lua scene.txt fresh", ""), 0);
    test_write_text(test_path("ask"), script);
    (void)snprintf(line, sizeof line, "completion=$(dirname $gray)/../../tools/completion PATH=$PWD/bin:$PATH %s ask",
                   shell);
    for (size_t i = 0; i < sizeof questions / sizeof *questions; i++) {
        size_t used = strlen(line);
        (void)snprintf(line + used, sizeof line - used, " '%s'", questions[i].line);
    }
    test_shell(line, 0, "== ");
    char *text = test_read_file(test_path("out.txt"), NULL);
    for (size_t i = 0; i < sizeof questions / sizeof *questions && text; i++) {
        (void)snprintf(mark, sizeof mark, "== %s\n", questions[i].line);
        char *answer = strstr(text, mark), *end = answer ? strstr(answer + 3, "== ") : NULL;
        size_t size = end ? (size_t)(end - answer) : answer ? strlen(answer) : 0;
        const char *offers = questions[i].offers, *offers_not = questions[i].offers_not;
        answer += answer ? strlen(mark) : 0;
        size -= answer ? strlen(mark) : 0;
        if (!answer || !memmem(answer, size, offers, strlen(offers)) ||
            (offers_not && memmem(answer, size, offers_not, strlen(offers_not))))
            test_fail(__FILE__, __LINE__, "%s: %s: %.*s", program, mark, (int)size, answer);
    }
    free(text);
}

/* The words are divided as the shell does it, at '=' too. */
TEST(bash_completes_options_words_scenes_files_and_topics) {
    ask_shell("bash", "bash",
              "source \"$completion\"/gray.bash; for question; do line=${question//=/ = }\n"
              "read -r -a COMP_WORDS <<<\"$line\"; [ \"${line: -1}\" != ' ' ] || COMP_WORDS+=('')\n"
              "COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _gray gray\n"
              "printf '%s\\n' \"== $question\" \"${COMPREPLY[@]}\"; done\n");
}

/* With the key Tab, in a terminal of its own: after each question the line is deleted. */
TEST(zsh_completes_options_words_scenes_files_and_topics) {
    ask_shell(
        "zsh", "zsh -f",
        "zmodload zsh/zpty; zpty -b z 'zsh -f -i'\n"
        "zpty -w z \"fpath=($completion \\$fpath); autoload -U compinit; compinit -u -D; LISTMAX=999; "
        "PS1=rea''dy\"\n"
        "await() { until zpty -r -t z out && print -r -- $out && [[ $out = *$1* ]]; do sleep .02; done }\n"
        "await ready; for question; do print -r -- \"== $question\"\n"
        "zpty -w -n z \"$question\"$'\\t\\t\\x15print do\\'\\'ne\\n'; await done; await ready; done; zpty -d z\n");
}

TEST(fish_completes_options_words_scenes_files_and_topics) {
    ask_shell("fish", "HOME=$PWD fish",
              "source $completion/gray.fish; for line in $argv; echo \"== $line\"; complete -C $line; end\n");
}

TEST(the_first_scene_renders_without_a_message_and_no_file_is_replaced) {
    test_shell(
        "$gray --init new/place", 0,
        "new/place/first.lua is written\nnew/place/.luarc.json is written\nnext: cd new/place && gray first.lua\n");
    test_shell_errors("cd new/place && $gray --size 160x100 first.lua", 0, "");
    free(test_read_picture(test_path("new/place/first.png")).rgb);
    test_shell("cd new/place && echo own >first.lua && $gray --init", 0,
               "first.lua is there and stays as it is\n.luarc.json is there and stays as it is\n");
    test_shell("cat new/place/first.lua", 0, "own\n");
    test_shell(
        "cat new/place/.luarc.json; ls \"$(sed -n 's/.*library\": \\[\"\\(.*\\)\"\\],/\\1/p' new/place/.luarc.json)\"",
        0, "gr.lua\n");
    test_shell_errors("$gray --init a b", 2, "gray: --init takes the name of one folder\n");
    test_shell_errors("touch file && $gray --init file", 1, "file");
}

TEST(messages_on_a_terminal_have_the_word_of_their_kind_and_its_colour) {
    test_need_tools("script");
    test_write_text(test_path("e.lua"), "gr.sphere{radius = -1}\n");
    test_write_text(test_path("n.lua"), "gr.render{node = gr.sphere{}, width = 8, height = 8}\n");
    test_write_text(test_path("w.lua"), "gr.spher{}\ngr.render{node = gr.sphere{}, width = 8, height = 8}\n");
    static const char terminal[] =
        "env -u NO_COLOR -u CLICOLOR -u CLICOLOR_FORCE %s script -qec \"$gray %s\" /dev/null";
    static const struct {
        const char *environment, *arguments, *says;
        int status;
    } cases[] = {
        {"", "e.lua", "e.lua:1: \033[1;31merror: \033[0mgr.sphere: ", 1},
        {"", "n.lua", "n.lua:1: \033[1;36mnotice: \033[0mgr.render: ", 0},
        {"", "--lenient w.lua", "w.lua:1: \033[1;33mwarning: \033[0m", 0},
        {"", "--nothing", "gray: \033[1;31merror: \033[0mthere is no option", 2},
        {"NO_COLOR=1 CLICOLOR_FORCE=1", "e.lua", "e.lua:1: error: gr.sphere: ", 1},
        {"CLICOLOR=0", "n.lua", "n.lua:1: notice: gr.render: ", 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char line[512];
        (void)snprintf(line, sizeof line, terminal, cases[i].environment, cases[i].arguments);
        test_shell(line, cases[i].status, cases[i].says);
    }
    test_shell_errors("env -u CLICOLOR_FORCE $gray e.lua", 1, "e.lua:1: gr.sphere: ");
    test_shell_errors("env -u NO_COLOR CLICOLOR_FORCE=1 $gray n.lua", 0,
                      "n.lua:1: \033[1;36mnotice: \033[0mgr.render: ");
}
