/* Enums and the words for their members from one list, so that the two cannot disagree:
 *
 *     #define TONE_CURVES(X) X(TONE_NONE, "none") X(TONE_REINHARD, "reinhard") X(TONE_FILMIC, "filmic")
 *     enum tone_curve { TONE_CURVES(LIST_MEMBER) };
 *     static const char *const words[] = {TONE_CURVES(LIST_WORD)};
 *
 * The members are counted from 0 and written in full, so that a search finds them. A list with more columns has macros
 * of its own for them. */
#ifndef GRAY_BASE_LIST_H
#define GRAY_BASE_LIST_H

/* A list may have one column: clang requires the 0 for the second parameter. */
#define LIST_FIRST(member, ...) member,
#define LIST_MEMBER(...) LIST_FIRST(__VA_ARGS__, 0)
#define LIST_WORD(member, word) [member] = (word),
#define LIST_ONE(...) +1
/* The labels of a switch for the members of a list that have one answer. */
#define LIST_LABEL_OF(member, ...) case member:
#define LIST_LABEL(...) LIST_LABEL_OF(__VA_ARGS__, 0)
/* The number of members of a list, as a constant. */
#define LIST_COUNT(list) (0 list(LIST_ONE))

/* All words as one literal: separated by blanks, for parameters of gr functions, and by '|', for options. */
#define LIST_BLANK_WORD(member, word) " " word
#define LIST_BAR_WORD(member, word) "|" word
#define LIST_BLANKS(list) (&(list(LIST_BLANK_WORD))[1])
#define LIST_BARS(list) (&(list(LIST_BAR_WORD))[1])

#endif
