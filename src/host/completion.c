/* The table of options says what may follow: the completions of the shells (tools/completion) have no list of their
 * own. */
#include "host/completion.h"

#include "film/aov.h"
#include "script/document.h"
#include "session/options_table.h"
#include "settings/setting.h"

#include <stdio.h>
#include <string.h>

/* A line for each word of a text with bars between them, after a prefix. */
static void print_words(const char *prefix, const char *words) {
    while (*words) {
        size_t length = strcspn(words, "|");
        (void)printf("%s%.*s\n", prefix, (int)length, words);
        words += length + (words[length] == '|');
    }
}

static void print_topic(void *context, const char *owner, const char *name, const char *help) {
    (void)context;
    if (owner[0])
        (void)printf("%s\t%s\n", name, help);
}

/* The name of the value in the help says what it is. The words of --option=word for a shell that does not divide them
 * begin with the prefix. */
static void print_value(const struct setting *option, const char *prefix) {
    const char *value = option->value ? option->value : "";
    (void)puts(strstr(value, ".lua")   ? "scenes"
               : strstr(value, "FILE") ? "files"
               : strstr(value, "DIR")  ? "folders"
                                       : "none");
    print_words(prefix, option->kind == SETTING_FLAG ? "yes|no" : option->words);
    for (int i = 0; option->kind == SETTING_LAYERS && i < AOV_COUNT; i++)
        (void)printf("%s%s\n", prefix, aov_name((enum aov)i));
    for (int i = 0; option->kind == SETTING_DEFAULT && i < setting_field_count; i++)
        (void)printf("%s%s=\n", prefix, setting_table[i].field);
}

static void print_options(void) {
    (void)puts("none");
    for (int i = 0; i < option_count(); i++) {
        const struct setting *option = option_at(i);
        for (const char *name = option->option ? option->option : ""; *name;) {
            int length = (int)strcspn(name, "|");
            const char *dashes = name == option->option ? "" : length > 1 ? "--" : "-";
            (void)printf("%s%.*s\t%s\n", dashes, length, name, option->help);
            name += length + (name[length] == '|');
        }
    }
}

/* Whether an option takes the next word as its value. */
static bool takes_word(const struct setting *option) {
    return option && (option->value || option->words[0]) && option->kind != SETTING_DENOISE &&
           option->kind != SETTING_STATS && option->kind != SETTING_ACTION;
}

void completion_print(const struct options *options) {
    const char *const *words = options->scripts;
    int last = options->script_count - 1;
    const char *word = last >= 0 ? words[last] : "", *sign = strchr(word, '=');
    bool only_scripts = false, has_action = false;
    const struct setting *before = NULL; /* whose value the last word is */
    for (int i = 0; i < last; i++) {
        const struct setting *option = words[i][0] == '-' && !only_scripts ? option_named(words[i]) : NULL;
        bool divided = i + 1 <= last && strcmp(words[i + 1], "=") == 0;
        if (option && option->kind == SETTING_ACTION) {
            (void)puts(option->low == ACTION_INIT ? "folders" : "none");
            if (option->low == ACTION_MANUAL)
                script_each_name(print_topic, NULL);
            return;
        }
        for (int k = 0; options_action_word(k) && !before; k++)
            has_action = has_action || strcmp(words[i], options_action_word(k)) == 0;
        only_scripts = only_scripts || strcmp(words[i], "--") == 0;
        before = before && strcmp(words[i], "=") == 0                                  ? before
                 : option && !strchr(words[i], '=') && (divided || takes_word(option)) ? option
                                                                                       : NULL;
    }
    if (before) {
        print_value(before, "");
    } else if (word[0] == '-' && sign && !only_scripts && option_named(word)) {
        char prefix[64];
        (void)snprintf(prefix, sizeof prefix, "%.*s", (int)(sign + 1 - word), word);
        print_value(option_named(word), prefix);
    } else if (word[0] == '-' && !only_scripts) {
        print_options();
    } else {
        (void)puts(has_action ? "files" : "scenes");
        for (int k = 0; options_action_word(k) && last <= 0; k++)
            (void)puts(options_action_word(k));
    }
}
