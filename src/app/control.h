/* A few words of memory that supervisor and child share from the fork on, for what is too frequent or too urgent for
 * the channel. The supervisor only shows what it reads here. */
#ifndef GRAY_APP_CONTROL_H
#define GRAY_APP_CONTROL_H

#include <stdatomic.h>
#include <stdint.h>

struct control {
    _Atomic int cancel;          /* set by the supervisor: give up the picture, end the script */
    _Atomic uint32_t tiles_done; /* of the picture being made */
    _Atomic uint32_t tiles;      /* 0 until its scene is built */
};

#endif
