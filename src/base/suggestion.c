/* "Did you mean": the optimal string alignment form of the Damerau-Levenshtein distance (insert, delete, replace, swap
 * of neighbours), letters compared without case. A suggestion is made when at most a third of the word, and at least
 * one letter, has to change. Words longer than WORD_LIMIT are ignored. */
#include "base/suggestion.h"

#include <stdbool.h>
#include <string.h>

enum { WORD_LIMIT = 40 };

static int lower(char c) {
    return c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c;
}

static size_t smaller(size_t a, size_t b) {
    return a < b ? a : b;
}

static size_t distance(const char *a, size_t a_length, const char *b, size_t b_length) {
    size_t rows[3][WORD_LIMIT + 1]; /* of the matrix: row i is rows[i % 3] */
    for (size_t j = 0; j <= b_length; j++)
        rows[0][j] = j;
    for (size_t i = 1; i <= a_length; i++) {
        size_t *row = rows[i % 3], *above = rows[(i + 2) % 3], *above2 = rows[(i + 1) % 3];
        row[0] = i;
        for (size_t j = 1; j <= b_length; j++) {
            size_t cost = lower(a[i - 1]) != lower(b[j - 1]);
            row[j] = smaller(smaller(above[j] + 1, row[j - 1] + 1), above[j - 1] + cost);
            bool swapped = i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
            if (swapped)
                row[j] = smaller(row[j], above2[j - 2] + 1);
        }
    }
    return rows[a_length % 3][b_length];
}

void suggest_begin(struct suggestion *suggestion, const char *word) {
    size_t third = strlen(word) / 3;
    *suggestion = (struct suggestion){.word = word, .distance = (third > 0 ? third : 1) + 1};
}

void suggest_offer(struct suggestion *suggestion, const char *candidate) {
    size_t a_length = strlen(suggestion->word), b_length = strlen(candidate);
    if (a_length > WORD_LIMIT || b_length > WORD_LIMIT)
        return;
    size_t d = distance(suggestion->word, a_length, candidate, b_length);
    if (d < suggestion->distance) { /* the first of equally near words is kept, so the result depends only on the order
                                       of the candidates */
        suggestion->distance = d;
        suggestion->best = candidate;
    }
    bool contains = strstr(suggestion->word, candidate) || strstr(candidate, suggestion->word);
    for (size_t rank = contains ? d / 3 : d, i = 0; i < SUGGESTIONS_NEAR; i++) {
        if (suggestion->near[i] && suggestion->near_distance[i] <= rank)
            continue;
        const char *moved = suggestion->near[i];
        size_t moved_rank = suggestion->near_distance[i];
        suggestion->near[i] = candidate;
        suggestion->near_distance[i] = rank;
        if (!moved)
            break;
        candidate = moved;
        rank = moved_rank;
    }
}
