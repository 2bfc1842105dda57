/* Rules between options: every incompatible pair is refused with the message of its rule, and either of the two alone
 * is accepted. Words at the limits of the parser; failing allocations. */
#include "base/fault.h"
#include "session/options_internal.h"
#include "session/options_table.h"
#include "tests/harness.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WORDS = 16 };

/* Parses the words of a line, split at single blanks; "~" stands for an empty word. The words stay in `copy`. */
static bool parse(const char *line, char copy[512], struct options *options, struct arena *arena, struct error *error) {
    char *words[WORDS] = {copy};
    int count = 1;
    *error = (struct error){0};
    strcpy(copy, line);
    for (char *word = strtok(copy, " "); word && count < WORDS; word = strtok(NULL, " "))
        words[count++] = strcmp(word, "~") == 0 ? word + 1 : word;
    return options_parse(options, count, words, arena, error);
}

/* Accepted if the message is NULL. */
static void expect(const char *line, const char *sentence) {
    char copy[512];
    struct options options;
    struct arena arena = {0};
    struct error error;
    bool ok = parse(line, copy, &options, &arena, &error);
    if (ok != !sentence || (sentence && (error.kind != ERROR_USAGE || strcmp(error.text, sentence) != 0)))
        test_fail(__FILE__, __LINE__, "'%s': %s", line, ok ? "taken" : error.text);
    arena_destroy(&arena);
}

/* Each of the options (separated by bars) together with `first`: refused with this message; each alone is accepted. */
static void exclude(const char *first, const char *options, const char *sentence) {
    char copy[512], line[600];
    strcpy(copy, options);
    for (char *rest = copy, *option; (option = strtok_r(rest, "|", &rest));) {
        (void)snprintf(line, sizeof line, "%s x %s", first, option);
        expect(line, sentence);
        (void)snprintf(line, sizeof line, "%s x", option);
        expect(line, NULL);
    }
    (void)snprintf(line, sizeof line, "%s x", first);
    expect(line, NULL);
}

TEST(options_that_do_not_go_together_are_refused_pair_by_pair) {
    static const char
        pixel[] = "--pixel renders nothing: it cannot be combined with -gui, --check, --shard, --mpi, --checkpoint "
                  "or --resume",
        display[] = "--display cannot be combined with -gui, --check or --shard, and term not with -o -",
        mpi[] = "--mpi cannot be combined with --shard, --shard-pictures, --no-fork or --check",
        window[] = "-gui cannot be combined with --checkpoint, --resume, --shard, --mpi, --no-fork, --check or --aov",
        watch[] = "--watch cannot be combined with --checkpoint, --resume, --shard, --mpi, --no-fork or -o -",
        no_fork[] = "--no-fork is for debuggers: it cannot be combined with --checkpoint, --resume or --shard",
        aov[] = "--aov works only for pictures that one process renders at once: no --shard, --mpi, "
                "--checkpoint or --resume",
        overlay[] = "--overlay works only for pictures that one process renders at once: no --shard, --mpi, "
                    "--checkpoint or --resume",
        debug[] = "--shard writes no debug pictures; give -write-... to gray merge";
    exclude("--pixel 1,2", "-gui|--check|--shard 1/2|--shard-pictures 1/2|--mpi|--checkpoint c|--resume", pixel);
    exclude("--display tev", "-gui|--check|--shard 1/2", display);
    exclude("--display term", "-o -", display);
    expect("--display tev -o - x", NULL);
    exclude("--mpi", "--shard 1/2|--shard-pictures 1/2|--no-fork|--check", mpi);
    exclude("-gui", "--checkpoint c|--resume|--shard 1/2|--shard-pictures 1/2|--mpi|--no-fork|--check|--aov all",
            window);
    exclude("--watch", "--checkpoint c|--resume|--shard 1/2|--shard-pictures 1/2|--mpi|--no-fork|-o -", watch);
    exclude("--no-fork", "--checkpoint c|--resume|--shard 1/2", no_fork);
    exclude("--aov depth", "--shard 1/2|--mpi|--checkpoint c|--resume", aov);
    exclude("--overlay boxes", "--shard 1/2|--mpi|--checkpoint c|--resume", overlay);
    exclude("--shard 1/2", "-write-aa-targets t-|-write-pre-aa p-", debug);
    exclude("--resume", "-o -", "with -o - there is no file name for a checkpoint; --checkpoint FILE sets one");
    expect("-o - --checkpoint c x", NULL);
    exclude("--shard 1/2", "-o -", "with -o - there is no file name for the parts of --shard");
    exclude("-write-aa-targets t-", "-o -", "with -o - there is no file name for -write-aa-targets and -write-pre-aa");
    exclude("-write-pre-aa t-", "-o -", "with -o - there is no file name for -write-aa-targets and -write-pre-aa");
    exclude("-write-pre-aa t-", "-write-aa-targets t-",
            "-write-aa-targets and -write-pre-aa would write the same file");
    expect("-write-pre-aa t- -write-aa-targets u- x", NULL);
    exclude("--stats=json", "-o -", "-o - and --stats=json both write to standard output");
    exclude("--aov uv", "-o -", "with -o - there is no file name for --aov");
}

/* Each option of the table, with a value that is accepted: gray merge takes it or refuses it, and the two lists name
 * all of them. */
TEST(merge_refuses_every_option_that_it_does_not_use) {
    static const char *const used[] = {
        "-o x.gif",        "--force",           "-write-aa-targets t-", "-write-pre-aa p-", "--fps 5", "--loop",
        "--palette frame", "--keep-frames",     "--contact-sheet",      "--denoise=none",   "-j 2",    "--isa base",
        "--allow-write d", "--picture-count 3", "--picture-bytes 1M",   "--no-sandbox",     "-q",      "--verbose",
        "--progress none"};
    char line[200], sentence[200];
    int taken = 0;
    for (int i = 0; i < option_count(); i++) {
        const struct setting *option = option_at(i);
        if (!option->option)
            continue;
        const char *rest = option->option;
        struct piece piece = option_next_piece(&rest);
        char name[32];
        (void)snprintf(name, sizeof name, "%.*s", (int)piece.length, piece.text);
        if (option->kind == SETTING_ACTION)
            continue;
        const char *with = NULL;
        for (size_t j = 0; j < sizeof used / sizeof used[0]; j++) {
            if (strncmp(used[j], name, piece.length) == 0 && !isalpha((unsigned char)used[j][piece.length]) &&
                used[j][piece.length] != '-')
                with = used[j];
        }
        taken += with != NULL;
        if (with) {
            bool animates = option->group == OPTION_GROUP_ANIMATION;
            (void)snprintf(line, sizeof line, "merge%s %s a.part", animates ? " -o x.gif" : "", with);
            expect(line, NULL);
            continue;
        }
        static const char *const values[] = {
            [SETTING_WHOLE] = "1",          [SETTING_NUMBER] = "1",  [SETTING_CAUSTICS] = "1",
            [SETTING_BYTES] = "1M",         [SETTING_TEXT] = "term", [SETTING_SIZE] = "8x8",
            [SETTING_CROP] = "0,0,1,1",     [SETTING_PIXEL] = "1,1", [SETTING_SEED] = "1",
            [SETTING_DEFINE] = "a=1",       [SETTING_FOLDER] = "d",  [SETTING_SHARD] = "1/2",
            [SETTING_DEFAULT] = "full=yes", [SETTING_FRAMES] = "2",  [SETTING_LAYERS] = "all",
            [SETTING_DENOISE] = NULL};
        enum setting_kind kind = option->kind;
        char choice[64] = "";
        if (kind == SETTING_CHOICE || kind == SETTING_TONE)
            (void)snprintf(choice, sizeof choice, "%.*s", (int)strcspn(option->words, "|"), option->words);
        const char *value = kind == SETTING_STATS || kind == SETTING_FLAG ? "" : choice[0] ? choice : values[kind];
        (void)snprintf(sentence, sizeof sentence,
                       "merge cannot be combined with %s: it only joins parts that are rendered", name);
        (void)snprintf(line, sizeof line, "merge %s %s a.part", name, value);
        expect(line, sentence);
        (void)snprintf(line, sizeof line, "%s %s merge a.part", name, value);
        expect(line, sentence);
    }
    CHECK(taken == (int)(sizeof used / sizeof used[0]));
    static const char *const only[] = {"--fps 5", "--loop", "--palette frame", "--keep-frames", "--contact-sheet"};
    for (size_t i = 0; i < sizeof only / sizeof only[0]; i++) {
        (void)snprintf(line, sizeof line, "merge %s a.part", only[i]);
        (void)snprintf(sentence, sizeof sentence, "%.*s is only for animations, such as -o x.gif",
                       (int)strcspn(only[i], " "), only[i]);
        expect(line, sentence);
    }
    expect("merge -q -- --spp.part", NULL);
}

TEST(words_at_the_borders_of_what_is_read_are_taken_or_refused) {
    static const char ss[] = "-ss needs a whole number from 1 to 64, not '%s'";
    char sentence[200], line[200], name[8];
    static const char *const wrong[] = {
        "+", "-", "65", "0", "3x", "123456789012345678901234567890", "99999999999999999999"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        (void)snprintf(line, sizeof line, "-ss %s x", wrong[i]);
        (void)snprintf(sentence, sizeof sentence, ss, wrong[i]);
        expect(line, sentence);
    }
    expect("-ss +3 x", NULL);
    expect("--cutoff 1 x", NULL);
    expect("--cutoff +.5 x", NULL);
    expect("--cutoff 1.5 x", "--cutoff needs a number from 0 to 1, not '1.5'");
    expect("--cutoff ~ x", "--cutoff needs a number from 0 to 1, not ''");
    expect("--cutoff 1e999 x", "--cutoff needs a number from 0 to 1, not '1e999'");
    expect("--cutoff 0x1p-3 x", "--cutoff needs a number from 0 to 1, not '0x1p-3'");
    expect("--shard 2/2 x", NULL);
    expect("--shard 3/2 x", "--shard needs I/N, whole numbers with I from 1 to N, not '3/2'");
    expect("--shard 3 x", "--shard needs I/N, whole numbers with I from 1 to N, not '3'");
    expect("--seed 12a x", "--seed needs a whole number from 0 to 18446744073709551615, not '12a'");
    expect("-D _a=1 x", NULL);
    expect("-D {=1 x", "-D needs name=value with a Lua name, not '{=1'");
    expect("-D [=1 x", "-D needs name=value with a Lua name, not '[=1'");
    expect("-D5=1 x", "there is no option '-D5=1' (gray --help lists all)");
    expect("-x x", "there is no option '-x' (gray --help lists all)");
    expect("-=5 x", "there is no option '-=5' (gray --help lists all)");
    expect("--an-option-with-a-name-that-is-longer-than-any x",
           "there is no option '--an-option-with-a-name-that-is-longer-than-any' (gray --help lists all)");
    expect("--help=5", "--help takes no value");
    expect("--lenient=yes x", NULL);
    CHECK(!output_name("picture-%d.png", 1, name, sizeof name));
    CHECK(!output_name("%d", 12345678, name, sizeof name));
    CHECK(output_name("%d", 1234567, name, sizeof name));
    CHECK_TEXT(name, "1234567");
}

static bool flag_of(const struct setting *option, struct options *options) {
    return *(const bool *)((const char *)option_base(option, options) + option->offset);
}

/* The last of several holds. Some need or refuse others, which is checked after all are read. */
TEST(every_flag_has_a_negative) {
    static const char *const values[] = {"=no", "=yes", ""};
    int count = 0;
    for (int i = 0; i < option_count(); i++) {
        const struct setting *option = option_at(i);
        if (option->kind != SETTING_FLAG || !option->option)
            continue;
        char name[32], line[200], copy[512], sentence[200];
        (void)snprintf(name, sizeof name, "%.*s", (int)strcspn(option->option, "|"), option->option);
        for (int k = 0; k < 3; k++) {
            struct options options;
            struct arena arena = {0};
            struct error error;
            (void)snprintf(line, sizeof line, "-o x.gif --dump-scene %s%s x", name, values[k]);
            bool ok = parse(line, copy, &options, &arena, &error);
            if ((k == 0 && !ok) || flag_of(option, &options) != (k > 0))
                test_fail(__FILE__, __LINE__, "'%s': %s", line, ok ? "another value" : error.text);
            arena_destroy(&arena);
        }
        (void)snprintf(line, sizeof line, "-o x.gif --dump-scene %s %s=no x", name, name);
        expect(line, NULL);
        (void)snprintf(line, sizeof line, "%s=maybe x", name);
        (void)snprintf(sentence, sizeof sentence, "%s needs yes or no, not 'maybe'", name);
        expect(line, sentence);
        count++;
    }
    CHECK(count > 20);
    expect("-q=no --quiet=yes -gui=no --json=no x", NULL);
}

TEST(a_default_names_a_field_and_has_a_value_of_its_option) {
    expect("--default samples=4 --default=area-samples=2 --default full=no --default caustics=5 x", NULL);
    expect("--default samples x", "--default needs FIELD=VALUE, a field of gr.render and its value, not 'samples'");
    expect("--default samples=65 x", "--default samples needs a whole number from 1 to 64, not '65'");
    expect("--default full=maybe x", "--default full needs yes or no, not 'maybe'");
    expect("--default tone=film x", "--default tone needs one of none|reinhard|filmic, not 'film'");
    expect("--default sample=4 x",
           "--default sets fields of gr.render that are settings, not 'sample'; did you mean samples?");
    expect("--default ss=4 x", "--default sets fields of gr.render that are settings, not 'ss'; did you mean samples?");
    expect("--default width=4 x", "--default sets fields of gr.render that are settings, not 'width'");
    expect("--default =4 x", "--default sets fields of gr.render that are settings, not ''");
    expect("--default crop=0,0,1,1 x", "--default sets fields of gr.render that are settings, not 'crop'");
}

TEST(an_option_has_priority_over_a_default_before_or_after_it) {
    static const char *const lines[] = {"-ss 5 --default samples=2 --default seed=3 x",
                                        "--default samples=2 --default seed=3 -ss 5 x"};
    for (int i = 0; i < 2; i++) {
        char copy[512];
        struct options options;
        struct arena arena = {0};
        struct error error;
        CHECK(parse(lines[i], copy, &options, &arena, &error));
        CHECK(options.settings.samples == 5 && script_option_given(&options.script, SETTING_INDEX(samples)));
        CHECK(options.settings.seed == 3 && options.script.seed == 0);
        CHECK(!script_option_given(&options.script, SETTING_INDEX(seed)) &&
              script_option_chosen(&options.script, SETTING_INDEX(seed)));
        arena_destroy(&arena);
    }
}

/* Their pictures differ if the script sets the field. */
TEST(options_and_defaults_of_one_value_have_different_keys) {
    static const char *const lines[] = {"x", "-ss 3 x", "--default samples=3 x", "-full=no x", "--default full=no x"};
    struct digest digests[5];
    for (int i = 0; i < 5; i++) {
        char copy[512];
        struct options options;
        struct arena arena = {0};
        struct error error;
        CHECK(parse(lines[i], copy, &options, &arena, &error));
        digests[i] = options_digest(&options);
        for (int k = 0; k < i; k++)
            CHECK(!digest_equal(digests[k], digests[i]));
        arena_destroy(&arena);
    }
}

TEST(a_command_line_of_no_words_names_no_scene) {
    struct options options;
    struct arena arena = {0};
    struct error error = {0};
    CHECK(!options_parse(&options, 0, (char *[]){NULL}, &arena, &error));
    CHECK_TEXT(error.text, "no scene script was given");
    arena_destroy(&arena);
}

#ifdef GRAY_FAULTS
/* An arena allocates rarely: each list here is larger than one block. */
TEST(memory_may_end_anywhere_in_a_command_line) {
    enum { MANY = 20000 };
    static char option[] = "-D", define[] = "a_name_that_is_rather_long=1", script[] = "x";
    char **words = malloc(MANY * sizeof *words);
    for (int i = 0; i < MANY; i++)
        words[i] = i > 1000 || i == 0 ? script : i % 2 ? option : define;
    for (uint64_t k = 1, over = 0; !over; k++) {
        struct options options;
        struct arena arena = {0};
        struct error error = {0};
        uint64_t before = fault_count(FAULT_OF_ALLOCATION);
        fault_at(FAULT_OF_ALLOCATION, k);
        bool ok = options_parse(&options, MANY, words, &arena, &error);
        fault_at(FAULT_OF_ALLOCATION, 0);
        over = fault_count(FAULT_OF_ALLOCATION) - before < k;
        CHECK(over ? ok : !ok && error.kind == ERROR_MACHINE);
        arena_destroy(&arena);
    }
    free(words);
}
#endif
