/* Tokens of a text of Lua. Nothing is allocated: tokens point into the text. */
#ifndef GRAY_SANDBOX_LEXER_H
#define GRAY_SANDBOX_LEXER_H

#include <stdbool.h>
#include <stddef.h>

enum token_kind { TOKEN_END, TOKEN_NAME, TOKEN_STRING, TOKEN_NUMBER, TOKEN_SYMBOL };

struct token {
    enum token_kind kind;
    const char *text; /* without quotes */
    size_t length;
    int line;
};

struct lexer {
    const char *at, *end;
    int line;
};

/* The next token. At the end of the text it returns TOKEN_END, however often it is called. */
struct token lexer_next(struct lexer *lexer);
void lexer_skip_line(struct lexer *lexer);
bool token_is(const struct token *token, enum token_kind kind, const char *text);
bool token_is_symbol(const struct token *token, char c); /* of one character, as every symbol token is */

#endif
