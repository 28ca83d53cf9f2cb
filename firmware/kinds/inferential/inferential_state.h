/* State of a loop. For its owner inferential.c and for inferential_kind.c, which allocates it. */
#ifndef REFLUX_INFERENTIAL_INFERENTIAL_STATE_H
#define REFLUX_INFERENTIAL_INFERENTIAL_STATE_H

#include "kinds/inferential/inferential_gains.h"

#if CONFIG_BLOCKS

struct inferential {
    struct inferential_config config, next;      /* next: settings that wait */
    bool waits, same_second;                     /* same_second: T2 is what it was before them */
    struct inferential_coefficients alone, pair; /* without and with the secondary */
    uint8_t acts; /* enum inferential_law that computes, without the secondary conventional */
    int8_t cut;   /* the last output was cut from above (1), from below (-1) */
    struct accumulator x1, x2; /* observers */
    struct accumulator wanted; /* T2* - from2 */
    num_t from1, from2;        /* T1 and T2 when it began, so that products stay small */
    num_t setpoint, t1, t2;    /* inputs of the last step */
    num_t primary;             /* u* of the last step */
    num_t given, applied;      /* u of the last step; what took effect */
};

#endif
#endif
