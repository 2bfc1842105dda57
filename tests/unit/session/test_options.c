/* The command line: every option in its spellings, every error with its message. */
#include "session/options.h"
#include "session/options_internal.h"
#include "tests/harness.h"

#include <stdlib.h>
#include <string.h>

struct parsed {
    struct options options;
    struct arena arena;
    struct error error;
    char *words[64];
    bool ok;
};

/* Parses "gray" and the words of a line, split at single blanks; "~" stands for an empty word. */
static struct parsed *parse(const char *line) {
    struct parsed *parsed = calloc(1, sizeof *parsed);
    char *copy = strdup(line);
    int count = 0;
    parsed->words[count++] = copy;
    for (char *word = strtok(copy, " "); word && count < 63; word = strtok(NULL, " "))
        parsed->words[count++] = strcmp(word, "~") == 0 ? word + 1 : word;
    parsed->words[0] = (char[]){"gray"};
    parsed->ok = options_parse(&parsed->options, count, parsed->words, &parsed->arena, &parsed->error);
    parsed->words[0] = copy;
    return parsed;
}

static void forget(struct parsed *parsed) {
    arena_destroy(&parsed->arena);
    free(parsed->words[0]);
    free(parsed);
}

/* The line is refused as wrong usage with this message. */
static void refused(const char *line, const char *sentence) {
    struct parsed *parsed = parse(line);
    if (parsed->ok)
        test_fail(__FILE__, __LINE__, "'%s' was taken", line);
    CHECK_EQ_INT(parsed->error.kind, ERROR_USAGE);
    CHECK_TEXT(parsed->error.text, sentence);
    forget(parsed);
}

static struct options *taken(struct parsed *parsed) {
    if (!parsed->ok)
        test_fail(__FILE__, __LINE__, "refused: %s", parsed->error.text);
    return &parsed->options;
}

TEST(options_have_the_defaults_of_the_manual) {
    struct parsed *parsed = parse("scene.lua");
    struct options *o = taken(parsed);
    CHECK_EQ_INT(o->action, ACTION_RENDER);
    CHECK_EQ_INT(o->script_count, 1);
    CHECK_TEXT(o->scripts[0], "scene.lua");
    CHECK_EQ_INT(o->settings.samples, 3);
    CHECK_EQ_INT(o->settings.integrator, INTEGRATOR_WHITTED);
    CHECK(!o->settings.full);
    CHECK_EQ_INT(o->settings.reflect_limit, 2);
    CHECK_EQ_INT(o->settings.refract_limit, 4);
    CHECK_NEAR(o->settings.side_tolerance, 0.005, 0);
    CHECK_NEAR(o->settings.corner_tolerance, 0.01, 0);
    CHECK_EQ_INT(o->settings.aa_pattern, AA_ROTATED);
    CHECK(!o->settings.use_tir);
    CHECK_NEAR(o->settings.cutoff, 0.0001, 0);
    CHECK_EQ_INT(o->settings.area_samples, 4);
    CHECK_EQ_INT(o->settings.seed, 0);
    CHECK_EQ_INT(o->settings.accel, ACCEL_AUTO);
    CHECK(!o->settings.cropped && !o->settings.view_is_target && !o->settings.pixel_corner);
    CHECK(!o->settings.ambient_plain && !o->script.lenient);
    CHECK_EQ_INT(o->settings.specular, SPECULAR_PHONG);
    CHECK_EQ_INT(o->script.transform_order, SCRIPT_ORDER_AUTO);
    CHECK_EQ_INT(o->threads, 0);
    CHECK_EQ_INT(o->progress, PROGRESS_AUTO);
    CHECK_EQ_INT(o->statistics, STATISTICS_NONE);
    CHECK(finish_is_plain(&o->settings.finish));
    CHECK(!o->output && !o->targets_prefix && !o->first_pass_prefix);
    forget(parsed);
}

TEST(long_options_take_one_dash_or_two_and_either_joint) {
    static const char *const spellings[] = {"-reflect-limit 7",  "--reflect-limit 7", "-reflect_limit 7",
                                            "--reflect_limit=7", "-reflect-limit=7",  "--reflect_limit 7"};
    for (size_t i = 0; i < sizeof spellings / sizeof *spellings; i++) {
        char line[64];
        (void)snprintf(line, sizeof line, "%s scene.lua", spellings[i]);
        struct parsed *parsed = parse(line);
        CHECK_EQ_INT(taken(parsed)->settings.reflect_limit, 7);
        CHECK_EQ_INT(parsed->options.script_count, 1);
        forget(parsed);
    }
}

TEST(every_option_sets_what_it_says) {
    struct parsed *parsed = parse(
        "--integrator whitted -ss 5 -full -side-tolerance .25 -corner-tolerance 1e-3 -reflect-limit 0 -refract-limit "
        "1000 -use-tir "
        "-al-samples 8 --aa-pattern grid "
        "--seed 18446744073709551615 --size 640x480 --crop 1,2,3,4 --accel none -o a.png -write-aa-targets T "
        "-write-pre-aa P --transform-order separate --view target --pixel-sample corner --specular blinn --ambient "
        "plain "
        "--lenient -j 3 -D x=1 -Dy=a=b --check --no-fork -q --verbose --stats=json --progress none one.lua two.lua");
    struct options *o = taken(parsed);
    CHECK_EQ_INT(o->settings.samples, 5);
    CHECK(o->settings.full && o->settings.use_tir && o->settings.keep_first);
    CHECK_NEAR(o->settings.side_tolerance, 0.25, 0);
    CHECK_EQ_INT(o->settings.aa_pattern, AA_GRID);
    CHECK_NEAR(o->settings.corner_tolerance, 1e-3, 0);
    CHECK_EQ_INT(o->settings.reflect_limit, 0);
    CHECK_EQ_INT(o->settings.refract_limit, 1000);
    CHECK_EQ_INT(o->settings.area_samples, 8);
    CHECK(o->settings.seed == UINT64_MAX && o->script.seed == UINT64_MAX);
    CHECK_EQ_INT(o->width, 640);
    CHECK_EQ_INT(o->height, 480);
    CHECK(o->settings.cropped);
    CHECK_EQ_INT(o->settings.crop_x, 1);
    CHECK_EQ_INT(o->settings.crop_y, 2);
    CHECK_EQ_INT(o->settings.crop_width, 3);
    CHECK_EQ_INT(o->settings.crop_height, 4);
    CHECK_EQ_INT(o->settings.accel, ACCEL_NONE);
    CHECK_TEXT(o->output, "a.png");
    CHECK_TEXT(o->targets_prefix, "T");
    CHECK_TEXT(o->first_pass_prefix, "P");
    CHECK_EQ_INT(o->script.transform_order, SCRIPT_ORDER_SEPARATE);
    CHECK(o->settings.view_is_target && o->settings.pixel_corner && o->settings.ambient_plain);
    CHECK_EQ_INT(o->settings.specular, SPECULAR_BLINN);
    CHECK(o->script.lenient);
    CHECK_EQ_INT(o->threads, 3);
    CHECK_EQ_INT(o->script.define_count, 2);
    CHECK_TEXT(o->script.defines[0].name, "x");
    CHECK_TEXT(o->script.defines[0].value, "1");
    CHECK_TEXT(o->script.defines[1].name, "y");
    CHECK_TEXT(o->script.defines[1].value, "a=b");
    CHECK(o->check && o->no_fork && o->quiet && o->verbose);
    CHECK_EQ_INT(o->statistics, STATISTICS_JSON);
    CHECK_EQ_INT(o->progress, PROGRESS_NONE);
    CHECK_EQ_INT(o->script_count, 2);
    CHECK_TEXT(o->scripts[1], "two.lua");
    forget(parsed);
}

TEST(options_and_scripts_mix_and_two_dashes_end_the_options) {
    struct parsed *parsed = parse("a.lua -full b.lua -- -ss --help");
    struct options *o = taken(parsed);
    CHECK(o->settings.full);
    CHECK_EQ_INT(o->script_count, 4);
    CHECK_TEXT(o->scripts[2], "-ss");
    CHECK_TEXT(o->scripts[3], "--help");
    CHECK_EQ_INT(o->action, ACTION_RENDER);
    forget(parsed);
}

TEST(stats_takes_its_form_only_behind_an_equals_sign) {
    struct parsed *parsed = parse("--stats json");
    CHECK_EQ_INT(taken(parsed)->statistics, STATISTICS_TEXT);
    CHECK_TEXT(parsed->options.scripts[0], "json");
    forget(parsed);
    parsed = parse("--stats=text s.lua");
    CHECK_EQ_INT(taken(parsed)->statistics, STATISTICS_TEXT);
    forget(parsed);
    refused("--stats=csv s.lua", "--stats needs one of none|text|json, not 'csv'");
}

TEST(alsamples_and_attached_thread_counts_are_understood) {
    struct parsed *parsed = parse("-alsamples 2 -j12 s.lua");
    CHECK_EQ_INT(taken(parsed)->settings.area_samples, 2);
    CHECK_EQ_INT(parsed->options.threads, 12);
    forget(parsed);
}

TEST(a_removed_option_is_answered_with_what_replaces_it) {
    refused("--no-copies s.lua",
            "there is no --no-copies any more: leave it out; copied frames have the bytes of rendered ones");
}

TEST(a_misspelt_option_is_answered_with_the_nearest_name) {
    refused("-fulll s.lua", "there is no option '-fulll'; did you mean -full?");
    refused("--reflectlimit=3 s.lua", "there is no option '--reflectlimit=3'; did you mean -reflect-limit?");
    refused("--transform_ordre old s.lua", "there is no option '--transform_ordre'; did you mean --transform-order?");
    refused("--siez 3x3 s.lua", "there is no option '--siez'; did you mean --size?");
    refused("--gui --check s.lua",
            "-gui cannot be combined with --checkpoint, --resume, --shard, --mpi, --no-fork, --check or --aov");
    refused("--zebra s.lua", "there is no option '--zebra' (gray --help lists all)");
    refused("-old s.lua", "there is no option '-old' (gray --help lists all)");
}

TEST(values_outside_their_range_are_refused_with_the_range) {
    static const char *const samples[] = {"0",  "65", "-1", "3.5", "x", "1e1", "0x10", "99999999999999999999",
                                          " 3", "3 "};
    for (size_t i = 0; i < sizeof samples / sizeof *samples; i++) {
        char line[64], sentence[128];
        (void)snprintf(line, sizeof line, "-ss=%s s.lua", samples[i]);
        (void)snprintf(sentence, sizeof sentence, "-ss needs a whole number from 1 to 64, not '%s'", samples[i]);
        if (!strchr(samples[i], ' '))
            refused(line, sentence);
    }
    refused("-reflect-limit 1001 s.lua", "-reflect-limit needs a whole number from 0 to 1000, not '1001'");
    refused("-j 0 s.lua", "-j needs a whole number from 1 to 1024, not '0'");
    refused("-side-tolerance -1 s.lua", "-side-tolerance needs a number of at least 0, not '-1'");
    refused("-side-tolerance nan s.lua", "-side-tolerance needs a number of at least 0, not 'nan'");
    refused("-side-tolerance inf s.lua", "-side-tolerance needs a number of at least 0, not 'inf'");
    refused("-side-tolerance +inf s.lua", "-side-tolerance needs a number of at least 0, not '+inf'");
    refused("-side-tolerance 1x s.lua", "-side-tolerance needs a number of at least 0, not '1x'");
    refused("--seed -1 s.lua", "--seed needs a whole number from 0 to 18446744073709551615, not '-1'");
    refused("--seed 18446744073709551616 s.lua",
            "--seed needs a whole number from 0 to 18446744073709551615, not '18446744073709551616'");
    refused(
        "--aov depth,dept s.lua",
        "--aov needs names separated by commas (depth, normal, albedo, uv, node, material, "
        "cost, samples, lights, and with --integrator path raw, variance, emission, diffuse_direct, diffuse_indirect, "
        "specular_direct, specular_indirect, transmission_direct, transmission_indirect, volume_direct, "
        "volume_indirect) or all, not 'depth,dept'");
    refused("--accel octree s.lua", "--accel needs one of auto|grid|bvh|kdtree|none, not 'octree'");
    refused("--view targe s.lua", "--view needs one of direction|target, not 'targe'");
    refused("-o= s.lua", "-o needs a text");
    refused("-write-pre-aa ~ s.lua", "-write-pre-aa needs a text");
    refused("-full=1 s.lua", "-full needs yes or no, not '1'");
    refused("s.lua -ss", "-ss needs a value: N");
}

TEST(sizes_and_crops_are_read_exactly) {
    static const char *const sizes[] = {"640", "640x", "x480", "640x480x3", "640X480",
                                        "0x5", "5x0",  "-1x5", "1048577x1"};
    static const char *const crops[] = {"1,2,3", "1,2,3,", "1,2,3,4,5", "-1,0,1,1", "0,0,0,1", "0,0,1,0", "a,b,c,d"};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        char line[64], sentence[200];
        (void)snprintf(line, sizeof line, "--size=%s s.lua", sizes[i]);
        (void)snprintf(sentence, sizeof sentence, "--size needs WxH, two whole numbers from 1 to 1048576, not '%s'",
                       sizes[i]);
        refused(line, sentence);
    }
    for (size_t i = 0; i < sizeof crops / sizeof *crops; i++) {
        char line[64], sentence[200];
        (void)snprintf(line, sizeof line, "--crop=%s s.lua", crops[i]);
        (void)snprintf(sentence, sizeof sentence,
                       "--crop needs X,Y,W,H, whole numbers with X and Y not negative and W and H at least 1, not '%s'",
                       crops[i]);
        refused(line, sentence);
    }
}

TEST(definitions_need_a_lua_name) {
    refused("-D 1x=3 s.lua", "-D needs name=value with a Lua name, not '1x=3'");
    refused("-D x s.lua", "-D needs name=value with a Lua name, not 'x'");
    refused("-D =3 s.lua", "-D needs name=value with a Lua name, not '=3'");
    refused("-D end=3 s.lua", "-D needs name=value with a Lua name, not 'end=3'");
    refused("-D a.b=3 s.lua", "-D needs name=value with a Lua name, not 'a.b=3'");
    struct parsed *parsed = parse("-D ending= s.lua");
    CHECK_TEXT(taken(parsed)->script.defines[0].name, "ending");
    CHECK_TEXT(parsed->options.script.defines[0].value, "");
    forget(parsed);
}

TEST(options_that_contradict_each_other_are_refused) {
    refused("-full", "no scene script was given");
    refused("-", "scripts are not read from standard input; give the name of a file");
    refused("~", "the name of a script is empty");
    refused("-write-aa-targets X -write-pre-aa X s.lua",
            "-write-aa-targets and -write-pre-aa would write the same file");
    refused("-o - -write-pre-aa X s.lua", "with -o - there is no file name for -write-aa-targets and -write-pre-aa");
    refused("-o - --stats=json s.lua", "-o - and --stats=json both write to standard output");
}

TEST(numbers_of_paths_that_mean_nothing_are_refused) {
    refused("--spp 0 s.lua", "--spp needs a whole number from 1 to 16777216, not '0'");
    refused("--noise 0 s.lua", "--noise needs a number from 1e-06 to 10, not '0'");
    refused("--noise nan s.lua", "--noise needs a number from 1e-06 to 10, not 'nan'");
    refused("--noise inf s.lua", "--noise needs a number from 1e-06 to 10, not 'inf'");
    refused("--spp 1000000000 --time-limit 2 s.lua", "--spp needs a whole number from 1 to 16777216, not '1000000000'");
    refused("--time-limit nan s.lua", "--time-limit needs SECONDS, a number from 0.001 to 1e+09, not 'nan'");
    refused("--max-depth -1 s.lua", "--max-depth needs a whole number from 0 to 1000000, not '-1'");
    refused("--max-depth 1000000000 s.lua", "--max-depth needs a whole number from 0 to 1000000, not '1000000000'");
    refused("--seed -1 s.lua", "--seed needs a whole number from 0 to 18446744073709551615, not '-1'");
    refused("--clamp -1 s.lua", "--clamp needs a number of at least 0, not '-1'");
}

TEST(help_needs_no_script) {
    static const char *const lines[] = {"--help", "-h", "--man", "--version", "--annotations"};
    static const enum options_action actions[] = {ACTION_HELP, ACTION_HELP, ACTION_MANUAL, ACTION_VERSION,
                                                  ACTION_ANNOTATIONS};
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        struct parsed *parsed = parse(lines[i]);
        CHECK_EQ_INT(taken(parsed)->action, actions[i]);
        forget(parsed);
    }
}

static void named(const char *pattern, unsigned number, const char *name) {
    char out[64];
    CHECK(output_name(pattern, number, out, sizeof out));
    CHECK_TEXT(out, name);
}

TEST(numbered_names_take_widths_zeros_and_percent_signs) {
    named("a%d.png", 7, "a7.png");
    named("a%03d.png", 7, "a007.png");
    named("a%3d.png", 7, "a  7.png");
    named("a%03d.png", 12345, "a12345.png");
    named("100%%-%d.png", 2, "100%-2.png");
    named("100%%.png", 2, "100%.png");
    named("50%.png", 2, "50%.png");
    named("%d%d.png", 3, "3%d.png");
    named("%s%d.png", 3, "%s3.png");
    named("%999d%d.png", 3, "%999d3.png");
    CHECK(output_name_numbered("x%d") && output_name_numbered("%%%04d"));
    CHECK(output_name_numbered_twice("x%04d%d.png") && output_name_numbered_twice("x.####.##.png"));
    CHECK(!output_name_numbered_twice("x%04d#.png") && !output_name_numbered_twice("100%%d-%d.png"));
    CHECK(!output_name_numbered("x") && !output_name_numbered("%%d") && !output_name_numbered("%s"));
    char small[8];
    CHECK(!output_name("12345678", 1, small, sizeof small));
    CHECK(!output_name("1234567%d", 1, small, sizeof small));
    CHECK(output_name("123456%d", 1, small, sizeof small));
}

TEST(merge_is_the_first_word_that_is_no_option) {
    static const char *const lines[] = {"merge a.part", "-q merge a.part", "-o merge -q merge a.part"};
    for (int i = 0; i < 3; i++) {
        struct parsed *parsed = parse(lines[i]);
        CHECK(parsed->ok && parsed->options.action == ACTION_MERGE && parsed->options.script_count == 1);
        forget(parsed);
    }
    static const char *const scenes[] = {"-- merge a.part", "a.lua merge"};
    for (int i = 0; i < 2; i++) {
        struct parsed *parsed = parse(scenes[i]);
        CHECK(parsed->ok && parsed->options.action == ACTION_RENDER && parsed->options.script_count == 2);
        forget(parsed);
    }
}
