/* A lexer for reading the text of Lua scenes: it skips comments; names, strings, numbers and single symbols are tokens.
 * It follows section 3.1 of the Lua 5.4 manual for comments, strings and names. */
#include "sandbox/lexer.h"

#include <string.h>

static bool is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/* At "[": the level of a long bracket, or -1. */
static int long_level(const struct lexer *lexer) {
    const char *p = lexer->at + 1;
    while (p < lexer->end && *p == '=')
        p++;
    return p < lexer->end && *p == '[' ? (int)(p - lexer->at - 1) : -1;
}

static struct token long_text(struct lexer *lexer, int level) {
    lexer->at += level + 2;
    struct token token = {TOKEN_STRING, lexer->at, 0, lexer->line};
    for (; lexer->at < lexer->end; lexer->at++) {
        if (*lexer->at == '\n')
            lexer->line++;
        if (*lexer->at != ']' || lexer->end - lexer->at < level + 2)
            continue;
        int k = 1;
        while (k <= level && lexer->at[k] == '=')
            k++;
        if (k == level + 1 && lexer->at[k] == ']') {
            token.length = (size_t)(lexer->at - token.text);
            lexer->at += level + 2;
            return token;
        }
    }
    token.length = (size_t)(lexer->at - token.text);
    return token;
}

static struct token quoted_text(struct lexer *lexer) {
    char quote = *lexer->at++;
    struct token token = {TOKEN_STRING, lexer->at, 0, lexer->line};
    while (lexer->at < lexer->end && *lexer->at != quote && *lexer->at != '\n') {
        if (*lexer->at == '\\' && lexer->at + 1 < lexer->end) {
            lexer->at++;
            if (*lexer->at == '\n')
                lexer->line++;
        }
        lexer->at++;
    }
    token.length = (size_t)(lexer->at - token.text);
    if (lexer->at < lexer->end)
        lexer->at += *lexer->at == quote;
    return token;
}

void lexer_skip_line(struct lexer *lexer) {
    while (lexer->at < lexer->end && *lexer->at != '\n')
        lexer->at++;
}

static void skip_blanks_and_comments(struct lexer *lexer) {
    while (lexer->at < lexer->end) {
        char c = *lexer->at;
        if (c == '\n')
            lexer->line++;
        if (c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v') {
            lexer->at++;
            continue;
        }
        if (c != '-' || lexer->end - lexer->at < 2 || lexer->at[1] != '-')
            return;
        lexer->at += 2;
        int level = lexer->at < lexer->end && *lexer->at == '[' ? long_level(lexer) : -1;
        if (level >= 0)
            (void)long_text(lexer, level);
        else
            lexer_skip_line(lexer);
    }
}

struct token lexer_next(struct lexer *lexer) {
    skip_blanks_and_comments(lexer);
    struct token token = {TOKEN_END, lexer->at, 0, lexer->line};
    if (lexer->at == lexer->end)
        return token;
    char c = *lexer->at;
    if (c == '"' || c == '\'')
        return quoted_text(lexer);
    if (c == '[' && long_level(lexer) >= 0)
        return long_text(lexer, long_level(lexer));
    const char *p = lexer->at + 1;
    if (is_letter(c) || is_digit(c)) {
        token.kind = is_letter(c) ? TOKEN_NAME : TOKEN_NUMBER;
        while (p < lexer->end && (is_letter(*p) || is_digit(*p) || (token.kind == TOKEN_NUMBER && *p == '.')))
            p++;
    } else {
        token.kind = TOKEN_SYMBOL;
    }
    token.length = (size_t)(p - lexer->at);
    lexer->at = p;
    return token;
}

bool token_is(const struct token *token, enum token_kind kind, const char *text) {
    return token->kind == kind && strlen(text) == token->length && memcmp(token->text, text, token->length) == 0;
}

bool token_is_symbol(const struct token *token, char c) {
    return token->kind == TOKEN_SYMBOL && token->text[0] == c;
}
