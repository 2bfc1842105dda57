/* What a syntax error of Lua usually means, from the tokens around its position. */
#ifndef GRAY_SANDBOX_SYNTAX_HINTS_INTERNAL_H
#define GRAY_SANDBOX_SYNTAX_HINTS_INTERNAL_H

struct sandbox;

/* "; 'not equal' is ~=", or "": the message begins with the position of a file. Must not raise. */
const char *hint_of_syntax(struct sandbox *sandbox, const char *message);

#endif
