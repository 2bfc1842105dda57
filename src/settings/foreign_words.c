/* The table of foreign words is foreign_words.txt. Every name of gray in it exists, which a test checks. */
#include "settings/foreign_words.h"

#include <string.h>

enum { WORD_SIZE = 40 };

/* Lower case, without '_' and '-', colour as color, without the prefixes of setters and counts. False: too long. */
static bool plain(const char *word, size_t length, char out[WORD_SIZE]) {
    static const char *const prefixes[] = {"set", "max", "num"};
    size_t size = 0;
    for (size_t i = 0; i < length && size < WORD_SIZE - 1; i++) {
        char c = word[i] >= 'A' && word[i] <= 'Z' ? (char)(word[i] - 'A' + 'a') : word[i];
        bool is_british = c == 'u' && size >= 4 && memcmp(out + size - 4, "colo", 4) == 0;
        if (c != '_' && c != '-' && !is_british)
            out[size++] = c;
    }
    out[size] = '\0';
    for (size_t i = 0; i < sizeof prefixes / sizeof *prefixes; i++) {
        if (size > 4 && strncmp(out, prefixes[i], 3) == 0) {
            memmove(out, out + 3, size - 2);
            break;
        }
    }
    return length < WORD_SIZE;
}

/* Whether the words have a plain one, which may have a plural s where they have none, or the other way round. */
static bool words_have(const char *words, const char *word) {
    size_t length = strlen(word);
    for (const char *at = words; *at;) {
        size_t end = strcspn(at, " "), common = end < length ? end : length;
        bool plural =
            length > 2 && ((end + 1 == length && word[end] == 's') || (length + 1 == end && at[length] == 's'));
        if ((plural || end == length) && strncmp(at, word, common) == 0)
            return true;
        at += end + (at[end] == ' ');
    }
    return false;
}

/* The rows of that kind with the word, from `row` on; NULL: there are no more. */
static const char *const *next_row(const char *const *row, const char *kind, const char *plain_word) {
    while (*row && !(strncmp(row[FOREIGN_KIND], kind, strlen(kind)) == 0 && words_have(row[FOREIGN_WORDS], plain_word)))
        row += FOREIGN_COLUMNS;
    return *row ? row : NULL;
}

static const char *use_of(const char *kind, const char *word, size_t length) {
    char text[WORD_SIZE];
    const char *const *row = plain(word, length, text) ? next_row(foreign_words_txt, kind, text) : NULL;
    return row ? row[FOREIGN_USE] : NULL;
}

const char *foreign_option(const char *word, size_t length) {
    return use_of("option", word, length);
}

const char *foreign_function(const char *word) {
    return use_of("function", word, strlen(word));
}

const char *foreign_method(const char *word) {
    return use_of("method", word, strlen(word));
}

const char *foreign_field(const char *word, bool (*has_field)(const void *function, const char *name),
                          const void *function, bool *is_name) {
    char text[WORD_SIZE];
    const char *const *row = plain(word, strlen(word), text) ? next_row(foreign_words_txt, ".", text) : NULL;
    while (row && !has_field(function, row[FOREIGN_KIND] + 1))
        row = next_row(row + FOREIGN_COLUMNS, ".", text);
    *is_name = row && row[FOREIGN_USE][0] == '\0';
    return *is_name ? row[FOREIGN_KIND] + 1 : row ? row[FOREIGN_USE] : NULL;
}
