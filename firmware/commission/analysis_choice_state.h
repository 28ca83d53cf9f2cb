/* The state of analysis_choice.c. */
#ifndef REFLUX_COMMISSION_ANALYSIS_CHOICE_STATE_H
#define REFLUX_COMMISSION_ANALYSIS_CHOICE_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "interact/candidates.h"

/* A pairing that would do. */
struct choice_candidate {
    uint8_t input[INTERACT_MAX]; /* of pair k */
    uint16_t negative;           /* struct candidate */
    real_t negative_index, niederlinski;
    real_t sound; /* share of draws in which it would do */
    real_t speed; /* sum of ln(K_c/T_i) of its loops; none where it has no settings */
    bool has_settings;
};

struct pairing_choice {
    uint8_t n;      /* how many would do */
    uint8_t turn;   /* the one whose settings are being made */
    uint8_t chosen; /* of the list */
    bool searching; /* by design/robust.h, from what the rule has given */
    struct choice_candidate list[CANDIDATES_MAX];
};

#endif
