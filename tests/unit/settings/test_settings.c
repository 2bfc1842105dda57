/* The list of settings, and what is made from it. */
#include "session/options_internal.h"
#include "settings/setting.h"
#include "tests/harness.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A value of the row that is not its default. */
static uint64_t other_value(const struct setting *row) {
    bool has_range = row->kind == SETTING_NUMBER || row->kind == SETTING_WHOLE || row->kind == SETTING_CAUSTICS;
    struct settings settings = settings_default();
    if (!has_range)
        return row->initial > 0 ? 0 : 1;
    setting_store(row, &settings, row->high < HUGE_VAL ? row->high : fmax(row->low, row->initial) + 1);
    return setting_bits(row, &settings);
}

static const struct settings *defaults(void) {
    static struct settings settings;
    settings = settings_default();
    return &settings;
}

TEST(every_setting_has_its_default_which_is_valid) {
    for (int i = 0; i < setting_count; i++) {
        const struct setting *row = &setting_table[i];
        struct settings settings = settings_default();
        CHECK(setting_is_valid(row, &settings));
        setting_store(row, &settings, row->initial);
        if (!settings_equal(&settings, defaults()))
            test_fail(__FILE__, __LINE__, "the default of row %d (%s) is not stored", i, row->option);
    }
    CHECK(settings_are_valid(defaults()));
}

/* A part that is made with another value is refused, whichever setting it is. */
TEST(every_setting_that_changes_a_picture_is_in_the_key_of_its_files) {
    for (int i = 0; i < setting_count; i++) {
        const struct setting *row = &setting_table[i];
        struct options options = {.settings = settings_default()}, other = options;
        CHECK(setting_set_bits(row, &other.settings, other_value(row)));
        bool same = digest_equal(options_digest(&options), options_digest(&other));
        if (same != (row->changes == CHANGES_RUN) || settings_equal(&options.settings, &other.settings) ||
            settings_finish_equal(&options.settings, &other.settings) != (row->changes != CHANGES_FINISH))
            test_fail(__FILE__, __LINE__, "row %d (%s) is not compared as it should be", i, row->option);
    }
}

/* The bytes of the setting may be any: a bool of 2, an enum without a word, a number that is not one. */
TEST(values_outside_of_their_range_are_refused) {
    for (int i = 0; i < setting_count; i++) {
        const struct setting *row = &setting_table[i];
        struct settings settings = settings_default();
        if (row->kind == SETTING_SEED)
            continue; /* every number is one */
        memset((char *)&settings + row->offset, row->size == 1 ? 2 : 0xff, row->size);
        if (setting_is_valid(row, &settings) || settings_are_valid(&settings))
            test_fail(__FILE__, __LINE__, "row %d (%s) takes any bytes", i, row->option);
        CHECK(!setting_set_bits(row, &settings, setting_bits(row, &settings)));
        bool has_range = row->kind == SETTING_WHOLE || row->kind == SETTING_NUMBER;
        for (int side = 0; side < 2 && has_range; side++) {
            bool has_word = row->kind == SETTING_NUMBER && row->words && row->words[0]; /* that is high + 1 */
            double beyond = side == 0 ? row->low - 1 : row->high + 1 + has_word;
            bool stays = !isfinite(beyond) || (beyond >= row->initial && beyond <= row->initial);
            settings = settings_default();
            setting_store(row, &settings, beyond);
            CHECK(stays || settings_equal(&settings, defaults()));
        }
    }
}

/* No two rows describe one place, and each place is inside the struct. */
TEST(settings_do_not_overlap) {
    static unsigned char used[sizeof(struct settings)];
    for (int i = 0; i < setting_count; i++) {
        for (size_t k = 0; k < setting_table[i].size; k++) {
            CHECK(setting_table[i].offset + k < sizeof used);
            if (used[setting_table[i].offset + k]++)
                test_fail(__FILE__, __LINE__, "row %d (%s) is where another one is", i, setting_table[i].option);
        }
    }
}

TEST(an_option_is_read_as_the_field_with_its_value) {
    static const char *const words[] = {"gray", "--bloom=.25", "--tone", "filmic", "--dither=blue", "s.lua"};
    struct options options;
    struct arena arena = {0};
    struct error error;
    char *argv[6];
    for (int i = 0; i < 6; i++)
        argv[i] = strdup(words[i]);
    CHECK(options_parse(&options, 6, argv, &arena, &error));
    CHECK_NEAR(options.settings.finish.bloom, 0.25, 0);
    CHECK(options.settings.tone.curve == TONE_FILMIC);
    CHECK(options.settings.finish.dither == DITHER_BLUE);
    CHECK_TEXT(options.script.given[SETTING_INDEX(finish.bloom)], ".25");
    CHECK(options.script.given[SETTING_INDEX(finish.vignette)] == NULL);
    for (int i = 0; i < 6; i++)
        free(argv[i]);
    arena_destroy(&arena);
}
