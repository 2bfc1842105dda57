/* Transfer functions: from the numbers that a file or a script gives for a colour to light. */
#ifndef GRAY_IMAGE_TRANSFER_H
#define GRAY_IMAGE_TRANSFER_H

#include "math/colour.h"
#include "math/elementary.h"

#include <stdbool.h>

/* SRGB: IEC 61966-2-1. POWER: light is c^exponent; 1 is linear. BT709: the inverse of the camera's function of ITU-R
 * BT.709, which cICP's values 1, 6, 14 and 15 mean (ITU-T H.273, table 3). */
enum transfer_kind { TRANSFER_UNSTATED, TRANSFER_SRGB, TRANSFER_POWER, TRANSFER_BT709 };
struct transfer_function {
    enum transfer_kind kind;
    double exponent;
};

static inline bool transfer_is_linear(struct transfer_function transfer) {
    return transfer.kind == TRANSFER_UNSTATED || (transfer.kind == TRANSFER_POWER && transfer.exponent == 1);
}

static inline bool transfer_same(struct transfer_function a, struct transfer_function b) {
    return a.kind == b.kind && (a.kind != TRANSFER_POWER || a.exponent == b.exponent);
}

/* Odd: a negative number gives minus the light of its magnitude. */
static inline double transfer_decode(struct transfer_function transfer, double c) {
    double x = fabs(c), light = x;
    switch (transfer.kind) {
    case TRANSFER_UNSTATED:
        break;
    case TRANSFER_SRGB:
        light = x <= 0.04045 ? x / 12.92 : el_pow((x + 0.055) / 1.055, 2.4);
        break;
    case TRANSFER_POWER:
        light = transfer.exponent == 1 ? x : el_pow(x, transfer.exponent);
        break;
    case TRANSFER_BT709:
        light = x < 0.081 ? x / 4.5 : el_pow((x + 0.099) / 1.099, 1 / 0.45);
        break;
    }
    return c < 0 ? -light : light;
}

static inline struct colour transfer_decode_colour(struct transfer_function transfer, struct colour c) {
    return colour_make(transfer_decode(transfer, c.r), transfer_decode(transfer, c.g), transfer_decode(transfer, c.b));
}

#endif
