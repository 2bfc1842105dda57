/* Habits from other languages, as a table: the words of Lua's message, the token where it stopped, its neighbours, and
 * the hint. The text is read again only when a message is printed. */
#include "sandbox/syntax_hints_internal.h"

#include "base/file.h"
#include "sandbox/files.h"
#include "sandbox/lexer.h"
#include "sandbox/sandbox.h"

#include <stdlib.h>
#include <string.h>

/* A neighbour is one of some words separated by blanks, or NAME: a name, VALUE: the end of a value. NULL: anything. */
#define NAME "*name"
#define VALUE "*value"

/* The first row that fits. "@" in a hint is the token before. */
static const struct habit {
    const char *message, *before, *near, *after, *hint;
} habits[] = {
    {"'then' expected", NULL, "=", NULL, "; == compares, = sets a variable"},
    {"'do' expected", NULL, "=", NULL, "; == compares, = sets a variable"},
    {"'then' expected", NULL, "{", NULL, "; 'then' follows a condition, and 'end' ends its block: no braces"},
    {"'do' expected", NULL, "{", NULL, "; 'do' begins a block and 'end' ends it: no braces"},
    {NULL, ")", "{", NULL, "; the body of a function has no braces: 'end' ends it"},
    {NULL, NULL, "=", "=", "; = gives a value, == compares two"},
    {NULL, NAME, "+ - * / % ^", "=", "; Lua has no such assignment: write @ = @ + ... in full, without +="},
    {NULL, NAME, "+", "+", "; Lua has no ++: write @ = @ + 1"},
    {NULL, NULL, "/", "/ *", "; a comment begins with --"},
    {NULL, NULL, "#", NULL, "; a comment begins with --"},
    {NULL, NULL, "!", "=", "; 'not equal' is ~="},
    {NULL, NULL, "!", NULL, "; '!' is not"},
    {NULL, NULL, "&", "&", "; '&&' is and"},
    {NULL, NULL, "|", "|", "; '||' is or"},
    {NULL, NULL, "?", NULL, "; Lua has no ?: write condition and a or b"},
    {NULL, "var let const int float double auto def", NULL, NULL, "; a variable is made by local, as in local n = 3"},
    {NULL, "elif elsif", NULL, NULL, "; '@' is elseif"},
    {NULL, NULL, "elif elsif", NULL, "; the word is elseif"},
    {NULL, "new", NULL, NULL, "; objects are made by calls, without 'new'"},
    {"')' expected", NAME, "=", NULL, "; named fields need braces, as in gr.sphere{@ = ...}"},
    {"'}' expected", NULL, ":", NULL, "; a field is given by =, as in {@ = ...}, and blocks have no braces"},
    {"'}' expected", VALUE, NULL, NULL, "; a comma is missing after '@'"},
    {"')' expected", VALUE, "*token", NULL, "; a comma is missing after '@', or a bracket"},
    {NULL, ",", ",", NULL, "; there is one comma too many"},
};

static bool is_one_of(const struct token *token, const char *words) {
    size_t length;
    for (; *words; words += length + (words[length] == ' ')) {
        length = strcspn(words, " ");
        if (token->kind != TOKEN_STRING && token->length == length && memcmp(token->text, words, length) == 0)
            return true;
    }
    return false;
}

static bool fits(const struct token *token, const char *words) {
    if (!words)
        return true;
    bool is_end = token_is_symbol(token, ')') || token_is_symbol(token, '}') || token_is_symbol(token, ']');
    bool is_word = token->kind == TOKEN_NAME || token->kind == TOKEN_STRING || token->kind == TOKEN_NUMBER;
    if (strcmp(words, NAME) == 0)
        return token->kind == TOKEN_NAME;
    if (strcmp(words, VALUE) == 0)
        return is_word || is_end;
    if (strcmp(words, "*token") == 0)
        return is_word || token_is_symbol(token, '{');
    return is_one_of(token, words);
}

/* "“" and its like: a character that no program of Lua has outside of texts and comments. */
static const char *strange_character(struct sandbox *sandbox, const char *text, const char *end) {
    static const char *const quotes[] = {"\xE2\x80\x98", "\xE2\x80\x99", "\xE2\x80\x9C", "\xE2\x80\x9D",
                                         "\xE2\x80\x9E", "\xC2\xAB",     "\xC2\xBB"};
    int length = 1;
    while (text + length < end && length < 4 && ((unsigned char)text[length] & 0xC0) == 0x80)
        length++;
    for (size_t i = 0; i < sizeof quotes / sizeof *quotes; i++) {
        if (strlen(quotes[i]) == (size_t)length && memcmp(text, quotes[i], (size_t)length) == 0)
            return arena_format(&sandbox->call, "; %.*s is a curly quotation mark: use the straight ones, \" or '",
                                length, text);
    }
    if (length == 2 && memcmp(text, "\xC2\xA0", 2) == 0)
        return "; there is a blank that does not break lines: use an ordinary one";
    unsigned char first = (unsigned char)text[0]; /* of a character in UTF-8 */
    int whole = first < 0xC2 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : first < 0xF5 ? 4 : 0;
    if (length != whole)
        return "; the text is not in UTF-8";
    return arena_format(&sandbox->call, "; the character %.*s may stand in texts and comments only", length, text);
}

/* The hint with the text of the token in place of each "@". */
static const char *with_token(struct sandbox *sandbox, const char *hint, const struct token *token) {
    char out[256], *to = out;
    const char *text = token->text ? token->text : ""; /* the first token of a script has none before it */
    size_t length = token->length < 40 ? token->length : 40;
    if (memchr(text, '\n', length))
        return "";
    for (; *hint && to + length + 1 < out + sizeof out; hint++) {
        if (*hint == '@') {
            memcpy(to, text, length);
            to += length;
        } else {
            *to++ = *hint;
        }
    }
    return arena_copy_text(&sandbox->call, out, (size_t)(to - out));
}

/* w: the token before the one where Lua stopped, that one, and the next. */
static const char *hint_of_tokens(struct sandbox *sandbox, const char *message, const struct token w[3],
                                  const char *end) {
    if (w[1].kind == TOKEN_SYMBOL && (unsigned char)w[1].text[0] >= 0x80)
        return strange_character(sandbox, w[1].text, end);
    for (size_t i = 0; i < sizeof habits / sizeof *habits; i++) {
        const struct habit *habit = &habits[i];
        if ((!habit->message || strstr(message, habit->message)) && fits(&w[0], habit->before) &&
            fits(&w[1], habit->near) && fits(&w[2], habit->after))
            return with_token(sandbox, habit->hint, &w[0]);
    }
    return "";
}

/* An "else if" opens a block of its own, whose `end` is easily forgotten. */
static bool has_else_if(const char *text, const char *end) {
    struct lexer lexer = {text, end, 1};
    struct token before = {0}, token;
    while ((token = lexer_next(&lexer)).kind != TOKEN_END) {
        if (token_is(&before, TOKEN_NAME, "else") && token_is(&token, TOKEN_NAME, "if") && before.line == token.line)
            return true;
        before = token;
    }
    return false;
}

/* Finds the token that the message ends with, in its line. */
static const char *hint_in_text(struct sandbox *sandbox, const char *message, int line,
                                const struct file_bytes *bytes) {
    const char *text = (const char *)bytes->data, *end = text + bytes->size;
    const char *near = strstr(message, " near '");
    if (strstr(message, " near <eof>"))
        return strstr(message, "'end' expected") && has_else_if(text, end)
                   ? "; 'else if' needs an end of its own: write elseif"
                   : "";
    if (!near)
        return "";
    near += strlen(" near '");
    struct lexer lexer = {text, end, 1};
    struct token w[3] = {{0}, {0}, lexer_next(&lexer)};
    while (w[2].kind != TOKEN_END) {
        w[0] = w[1], w[1] = w[2];
        w[2] = lexer_next(&lexer);
        bool same = near[0] == '<' && near[1] == '\\' ? (unsigned char)w[1].text[0] == strtoul(near + 2, NULL, 10)
                    : w[1].kind == TOKEN_STRING ? memcmp(near + 1, w[1].text, w[1].length < 2 ? w[1].length : 2) == 0
                                                : strncmp(near, w[1].text, w[1].length) == 0;
        if (w[1].line == line && same && w[1].length > 0 && !(fits(&w[0], "=") && fits(&w[1], "=")))
            return hint_of_tokens(sandbox, message, w, end);
    }
    return "";
}

const char *hint_of_syntax(struct sandbox *sandbox, const char *message) {
    const struct source_name *source = sandbox->files.sources;
    while (source &&
           (strncmp(message, source->path, strlen(source->path)) != 0 || message[strlen(source->path)] != ':'))
        source = source->next;
    if (!source || (!strstr(message, " near ") && !strstr(message, " expected")))
        return "";
    int line = (int)strtol(message + strlen(source->path) + 1, NULL, 10);
    struct file_bytes bytes;
    struct error error = {0};
    if (!path_policy_map(files_policy(sandbox, source->path), source->path, FILE_LIMIT, &bytes, &error))
        return "";
    const char *hint = hint_in_text(sandbox, message, line, &bytes);
    file_unmap(&bytes);
    return hint ? hint : "";
}
