/* "Did you mean": the nearest of some words, if it is near enough. */
#ifndef GRAY_BASE_SUGGESTION_H
#define GRAY_BASE_SUGGESTION_H

#include <stddef.h>

enum { SUGGESTIONS_NEAR = 3 };

/* The nearest of the words by Damerau-Levenshtein distance if the distance is small enough, else `best` is NULL.
 * `near`: the nearest ones at any distance, for lists; NULL after the last one. Words that contain one another count as
 * near. */
struct suggestion {
    const char *word, *best;
    size_t distance;
    const char *near[SUGGESTIONS_NEAR];
    size_t near_distance[SUGGESTIONS_NEAR];
};
void suggest_begin(struct suggestion *suggestion, const char *word);
void suggest_offer(struct suggestion *suggestion, const char *candidate);

#endif
