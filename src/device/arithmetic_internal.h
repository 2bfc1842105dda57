/* Operations and elementary functions whose bits two machines compare before they make one picture together. */
#ifndef GRAY_DEVICE_ARITHMETIC_INTERNAL_H
#define GRAY_DEVICE_ARITHMETIC_INTERNAL_H

#include <stdint.h>

/* A digest of what they give for two random numbers; so many numbers of them are compared. */
uint64_t arithmetic_digest(uint32_t number);
enum { ARITHMETIC_NUMBERS = 1 << 12 };

#endif
