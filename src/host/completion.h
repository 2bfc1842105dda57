/* Completion of command lines in shells. */
#ifndef GRAY_HOST_COMPLETION_H
#define GRAY_HOST_COMPLETION_H

#include "session/options.h"

/* The words of the options are those of a command line behind the program; the last one is being typed. Prints the kind
 * of files that it may be (scenes, files, folders or none), and then lines of a word that it may be, a tab and its
 * description. Shells that divide words at '=' give it as a word. */
void completion_print(const struct options *options);

#endif
