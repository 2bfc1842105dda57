/* How far a colour is from black, as the length of a vector. */
#ifndef GRAY_TESTS_UNIT_COLOUR_LENGTH_H
#define GRAY_TESTS_UNIT_COLOUR_LENGTH_H

#include "math/colour.h"

static inline double colour_length(struct colour c) {
    return sqrt(colour_dot(c, c));
}

#endif
