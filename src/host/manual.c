/* Everything is read from the tables of options and functions and from the comments of the library's modules. A topic
 * is first the name of an option, function, method, field or module; then a word of another program; then a word that
 * occurs in descriptions. Case, '-' and '_' do not matter. */
#define _GNU_SOURCE
#include "host/manual.h"

#include "base/document.h"
#include "base/file.h"
#include "base/suggestion.h"
#include "base/version.h"
#include "script/document.h"
#include "script/schema.h"
#include "session/options_table.h"
#include "session/text.h"
#include "settings/foreign_words.h"
#include "settings/setting.h"

#include <ctype.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { TOPIC_SIZE = 96, MODULE_LIMIT = 1 << 24 };

static int print(const struct document *document) {
    if (document->failed) {
        (void)fputs("gray: out of memory for the text\n", stderr);
        return ERROR_MACHINE;
    }
    (void)fputs(document->text, stdout);
    return 0;
}

/* On a terminal, through $PAGER or less; if that cannot be started, directly. */
static int print_paged(const struct document *document) {
    const char *pager = getenv("PAGER");
    if (document->failed || !isatty(STDOUT_FILENO))
        return print(document);
    (void)setenv("LESS", "FRX", 0); /* ends by itself if a screen holds the text */
    FILE *pipe = popen(pager && pager[0] ? pager : "less", "w");
    if (!pipe)
        return print(document);
    (void)signal(SIGINT, SIG_IGN); /* Ctrl-C is for the pager */
    (void)fputs(document->text, pipe);
    int status = pclose(pipe);
    return WIFEXITED(status) && WEXITSTATUS(status) == 127 ? print(document) : 0;
}

static void add_usage(struct document *document) {
    document_lines(document,
                   "gray [options] [--] scene.lua|model.glb ...\n"
                   "gray merge [-o FILE] [options] PART ...\n"
                   "gray compare [-o DIFFERENCE.png] [--threshold LEVEL] PICTURE REFERENCE\n"
                   "gray view [-o FILE] [--eye X,Y,Z] [--focus DISTANCE] [--aperture RADIUS] FIELD.lf|PANORAMA\n"
                   "gray --man [TOPIC ...]\n"
                   "gray --init [FOLDER]\n");
}

static void add_help(struct document *document) {
    document_paragraph(
        document, "gray renders scenes that are written as Lua scripts, and models: OBJ, PLY, STL and glTF files.");
    document_section(document, "Usage");
    add_usage(document);
    document_gap(document);
    options_describe(document);
}

/* Without "gr.", "node:", dashes and brackets, in lower case. */
static void plain(const char *word, char out[TOPIC_SIZE]) {
    word += strncasecmp(word, "gr.", 3) == 0 ? 3 : strncasecmp(word, "node:", 5) == 0 ? 5 : strspn(word, "-");
    size_t size = 0, end = strcspn(word, "({= ");
    for (; size < end && size < TOPIC_SIZE - 1; size++)
        out[size] = word[size] == '-' ? '_' : (char)tolower((unsigned char)word[size]);
    out[size] = '\0';
}

/* The first comment of a module of the library and its documented functions, or only the function after the point. */
static void describe_module(struct document *document, const char *library, const char *topic) {
    char path[4096], text[DOCUMENT_LINE] = "";
    struct file_bytes file;
    struct error error;
    /* module or module.function. */
    int length = (int)strspn(topic, "abcdefghijklmnopqrstuvwxyz_0123456789");
    const char *function = topic[length] == '.' ? topic + length + 1 : NULL;
    (void)snprintf(path, sizeof path, "%s/%.*s.lua", library ? library : "", length, topic);
    if (!library || (topic[length] && !function) || !file_map(path, MODULE_LIMIT, &file, &error))
        return;
    /* The lines of the file. */
    bool is_head = !function;
    for (const char *line = (const char *)file.data, *end = line + file.size, *next; line < end; line = next) {
        const char *stop = memchr(line, '\n', (size_t)(end - line));
        int size = (int)((stop ? stop : end) - line);
        next = stop ? stop + 1 : end;
        /* The first comment is printed. */
        is_head = is_head && size >= 2 && memcmp(line, "--", 2) == 0 && !(size > 2 && line[2] == '-');
        if (is_head) {
            document_add(document, "%.*s\n", size > 3 ? size - 3 : 0, line + 3);
        } else if (size > 4 && memcmp(line, "---", 3) == 0) {
            /* A comment of a function is collected. */
            size_t used = strlen(text);
            if (line[3] != '@')
                (void)snprintf(text + used, sizeof text - used, "%s%.*s", used ? " " : "", size - 4, line + 4);
        } else {
            /* It belongs to the function of the next line. */
            const char *name = line + strlen("function M."), *bracket = memchr(line, ')', (size_t)size);
            bool is_function = bracket && strncmp(line, "function M.", strlen("function M.")) == 0;
            size_t name_size = is_function ? strcspn(name, "(") : 0;
            if (is_function && text[0] &&
                (!function || (strlen(function) == name_size && strncasecmp(function, name, name_size) == 0))) {
                char term[256];
                (void)snprintf(term, sizeof term, "%.*s.%.*s", length, topic, (int)(bracket + 1 - name), name);
                document_gap(document);
                document_entry(document, DOCUMENT_FUNCTION, term, text);
            }
            text[0] = '\0';
        }
    }
    file_unmap(&file);
}

/* What has exactly this name. With dashes it is only an option, with "gr." or "node:" only a function. */
static void describe_named(struct document *document, const char *word, const char *library) {
    bool is_option = word[0] == '-', is_title = strncasecmp(word, "gr.", 3) == 0 || strncasecmp(word, "node:", 5) == 0;
    const struct setting *option = is_title ? NULL : option_named(word);
    char topic[TOPIC_SIZE];
    plain(word, topic);
    if (option)
        option_describe(option, document);
    if (!is_option)
        script_describe_function(document, topic);
    if (!is_option && !is_title) {
        script_describe_field(document, topic);
        describe_module(document, library, topic);
    }
}

static bool has_any_field(const void *function, const char *name) {
    (void)function;
    (void)name;
    return true;
}

/* Words of other programs: what gray has in their place, and its description. */
static void describe_foreign(struct document *document, const char *word, const char *library) {
    bool is_field = false;
    const char *uses[] = {foreign_option(word, strlen(word)), foreign_function(word), foreign_method(word),
                          foreign_field(word, has_any_field, NULL, &is_field)};
    for (size_t i = 0; i < sizeof uses / sizeof *uses; i++) {
        bool again = false;
        for (size_t k = 0; k < i; k++)
            again = again || (uses[i] && uses[k] && strcmp(uses[i], uses[k]) == 0);
        if (!uses[i] || again)
            continue;
        document_add(document, "gray has no '%.80s'; use %s%s\n\n", word, i == 3 && is_field ? "the field " : "",
                     uses[i]);
        describe_named(document, uses[i], library);
    }
}

/* Options, functions, methods and fields. */
static void each_name(void (*visit)(void *context, const char *owner, const char *name, const char *help),
                      void *context) {
    for (int i = 0; i < option_count(); i++)
        if (option_at(i)->option)
            visit(context, "", option_at(i)->option, option_at(i)->help);
    script_each_name(visit, context);
}

/* A search for a word in all descriptions. `seen` has the names of entries, one a line. */
struct mentions {
    struct document *document, seen;
    const char *word;
};

/* Whether a word of the text begins so. */
static bool has_word(const char *text, const char *word) {
    for (const char *at = text; (at = strcasestr(at, word)) != NULL; at++)
        if (at == text || !isalnum((unsigned char)at[-1]))
            return true;
    return false;
}

static void add_mention(void *context, const char *owner, const char *name, const char *help) {
    struct mentions *mentions = context;
    char line[TOPIC_SIZE];
    (void)snprintf(line, sizeof line, "\n%s%.*s\n", owner, (int)strcspn(name, "|"), name);
    if ((!has_word(help, mentions->word) && !has_word(name, mentions->word)) ||
        (mentions->seen.text && strstr(mentions->seen.text, line)))
        return;
    document_add(&mentions->seen, "%s", line);
    line[strlen(line) - 1] = '\0';
    document_entry(mentions->document, DOCUMENT_OPTION, line + 1, help);
}

static void offer(void *suggestion, const char *owner, const char *name, const char *help) {
    (void)owner;
    (void)help;
    if (strlen(name) > 2)
        suggest_offer(suggestion, name + strspn(name, "-"));
}

static int report_unknown(const char *word) {
    struct suggestion suggestion;
    char topic[TOPIC_SIZE], line[300];
    plain(word, topic);
    suggest_begin(&suggestion, topic);
    each_name(offer, &suggestion);
    (void)snprintf(line, sizeof line, "gray: nothing is known of '%.80s'%s%s%s", word,
                   suggestion.best ? "; did you mean " : "", suggestion.best ? suggestion.best : "",
                   suggestion.best ? "?" : " (gray --man lists everything)");
    text_print_message(stderr, TEXT_ERROR, line);
    return ERROR_USAGE;
}

/* Everything about a word; nothing is added if nothing is known. */
static void describe_topic(struct document *document, const char *word, const char *library) {
    size_t before = document->used;
    describe_named(document, word, library);
    if (document->used > before)
        return;
    describe_foreign(document, word, library);
    struct mentions mentions = {document, {.arena = document->arena}, word};
    if (strlen(word) > 2)
        each_name(add_mention, &mentions);
    document->failed = document->failed || mentions.seen.failed;
}

int manual_print(const struct options *options, const char *library, struct arena *arena) {
    struct document document = {.arena = arena};
    bool has_help = options->action == ACTION_HELP;
    int status = 0;
    for (int i = 0; i < options->script_count && !has_help; i++) {
        size_t before = document.used;
        describe_topic(&document, options->scripts[i], library);
        if (document.used == before && !document.failed)
            status = report_unknown(options->scripts[i]);
    }
    if (has_help || options->script_count == 0)
        add_help(&document);
    if (!has_help && options->script_count == 0) {
        document_gap(&document);
        script_describe_function(&document, NULL);
    }
    if (!document.text && !document.failed)
        return status;
    int printed = has_help ? print(&document) : print_paged(&document);
    return printed ? printed : status;
}

int manual_print_annotations(struct arena *arena) {
    struct document document = {.arena = arena};
    script_annotations(&document);
    return print(&document);
}

int manual_print_schema(struct arena *arena) {
    struct document document = {.arena = arena};
    script_json_schema(&document);
    return print(&document);
}

static void add_page_of_program(struct document *document) {
    document_add(document, ".TH GRAY 1 \"\" \"gray %s\" \"User Commands\"\n", GRAY_VERSION);
    document_section(document, "Name");
    document_add(document, "gray \\- render scenes that are written as Lua scripts\n");
    document_section(document, "Synopsis");
    add_usage(document);
    document_section(document, "Description");
    document_paragraph(document, "gray is a ray tracer and path tracer. A scene is a Lua script; it builds solids, "
                                 "materials and lights with the functions of the table gr, and gr.render writes a "
                                 "picture. Scripts run in a sandbox. The picture does not depend on the number of "
                                 "threads, processes or machines.");
    document_section(document, "Examples");
    document_lines(document, "gray --init && gray first.lua\n"
                             "gray --integrator path --noise 0.02 --denoise first.lua\n"
                             "gray -gui --watch first.lua\n"
                             "gray -o turn.gif --turntable 60 first.lua\n"
                             "gray --man sphere\n");
    document_section(document, "Options");
    options_describe(document);
    document_section(document, "See also");
    document_paragraph(document, "gray-scene(5)");
}

static void add_page_of_language(struct document *document) {
    document_add(document, ".TH GRAY\\-SCENE 5 \"\" \"gray %s\" \"File Formats\"\n", GRAY_VERSION);
    document_section(document, "Name");
    document_add(document, "gray\\-scene \\- the functions of scene scripts for gray\n");
    document_section(document, "Description");
    document_paragraph(document, "A scene is a Lua 5.4 script. The table gr has the functions below; those with a form "
                                 "in braces also take one table with named fields. Points, directions and colours are "
                                 "tables of three numbers; angles are in degrees; y is up. gray --man TOPIC prints one "
                                 "entry, and the functions of a module of the library.");
    document_section(document, "Functions");
    script_describe_function(document, NULL);
    document_section(document, "See also");
    document_paragraph(document, "gray(1)");
}

int manual_print_page(const struct options *options, struct arena *arena) {
    struct document document = {.arena = arena, .is_roff = true};
    const char *page = options->script_count == 1 ? options->scripts[0] : "";
    if (strcmp(page, "gray") == 0) {
        add_page_of_program(&document);
    } else if (strcmp(page, "gray-scene") == 0) {
        add_page_of_language(&document);
    } else {
        (void)fputs("gray: --roff prints the page gray or gray-scene\n", stderr);
        return ERROR_USAGE;
    }
    return print(&document);
}
