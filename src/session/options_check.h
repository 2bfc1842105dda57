/* The rules for several options together. */
#ifndef GRAY_SESSION_OPTIONS_CHECK_H
#define GRAY_SESSION_OPTIONS_CHECK_H

#include "session/options.h"

/* Checks the options together, and sets those that others imply. */
bool options_check(struct options *options, struct error *error);
/* --display: tev, tev:host, tev:host:port, term, term:kitty, term:sixel, term:blocks. False: none of these. */
bool display_parse(const char *text, struct display_choice *out);

#endif
