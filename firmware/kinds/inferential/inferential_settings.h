/* Settings of the kind `inferential` (docs/methods/inferential.md), as its parameters fill them. Row k: loop k of the block. */
#ifndef REFLUX_INFERENTIAL_INFERENTIAL_SETTINGS_H
#define REFLUX_INFERENTIAL_INFERENTIAL_SETTINGS_H

#include "block/block.h"

#if CONFIG_BLOCKS

#define INFERENTIAL_LOOPS 2

enum inferential_law { LAW_HOLD, LAW_CONVENTIONAL, LAW_CASCADE, LAW_CLF };
enum inferential_form { FORM_EULER, FORM_JOINT };
enum inferential_moves { MOVES_NONE, MOVES_REFLUX, MOVES_HEAT };
enum inferential_scaling { SCALING_CONSISTENT, SCALING_PRINTED };
enum { PRIMARY, SECONDARY };

struct inferential_settings {
    float a[INFERENTIAL_LOOPS][2];        /* EU/h per unit of the MV; 0: from the next ones */
    float gradient[INFERENTIAL_LOOPS][2]; /* K, from its stage to the next one up; 0: not given */
    float holdup[INFERENTIAL_LOOPS][2];   /* kmol */
    float lv[INFERENTIAL_LOOPS][2];       /* liquid to vapour in its section */
    float flow[INFERENTIAL_LOOPS];        /* kmol per unit of the MV */
    float w[INFERENTIAL_LOOPS];           /* 1/h */
    float kc[INFERENTIAL_LOOPS], kc2[INFERENTIAL_LOOPS], ko[INFERENTIAL_LOOPS]; /* 1/h; 0: from w */
    float wh[INFERENTIAL_LOOPS];                                                /* 1/h; 0: 100 w */
    float kc_w, kc2_kc, ko_kc;                                                  /* of the rule */
    uint16_t stage[INFERENTIAL_LOOPS][2];                                       /* 0: not given */
    uint16_t second[INFERENTIAL_LOOPS]; /* 0: the k-th of the secondary temperatures */
    uint16_t parts;                     /* components */
    uint8_t law[INFERENTIAL_LOOPS];     /* enum inferential_law */
    uint8_t moves[INFERENTIAL_LOOPS];   /* enum inferential_moves */
    uint8_t form, scaling;
};

extern const struct block_kind inferential_kind;

#endif
#endif
