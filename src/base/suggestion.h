/* "Did you mean": the nearest of some words, if it is near enough. */
#ifndef GRAY_BASE_SUGGESTION_H
#define GRAY_BASE_SUGGESTION_H

#include <stddef.h>

/* The nearest of the words by Damerau-Levenshtein distance if the distance is small enough, else `best` is NULL. */
struct suggestion {
    const char *word, *best;
    size_t distance;
};
void suggest_begin(struct suggestion *suggestion, const char *word);
void suggest_offer(struct suggestion *suggestion, const char *candidate);

#endif
