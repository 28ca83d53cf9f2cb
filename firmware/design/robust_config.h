/* What is asked of the search of design/robust.h. */
#ifndef REFLUX_DESIGN_ROBUST_CONFIG_H
#define REFLUX_DESIGN_ROBUST_CONFIG_H

#include "design/loops.h"

/* Ranges of the settings that it finds. */
#define ROBUST_GAIN_LEAST REAL_C(1e-6)
#define ROBUST_GAIN_MOST  REAL_C(100.0)
#define ROBUST_TI_LEAST_S REAL_C(1e-3)
#define ROBUST_TI_MOST_S  REAL_C(1e6)

struct robust_config {
    real_t s_most; /* 1.2 to 10 */
    /* 1.05 to 10, of all plants; and of the nominal one alone while it is searched, at most t_most. The second keeps its loops from
     * swinging; the first leaves room for what members add. */
    real_t t_most, t_nominal;
    real_t gain_most[INTERACT_MAX]; /* of loop k, 1e-6 to 100: detune_largest_gain() */
    uint8_t part[INTERACT_MAX]; /* of loop k: loops of different numbers do not act on each other */
    uint16_t members;           /* 0 to 1000 */
    /* Puts row `output` of member 0 to members - 1 into member_plant, row 0 first, which brings all else that is not drawn: always
     * the same for the same numbers, of the size of the nominal plant. NULL where there are no members. About 1e5 instructions at
     * most. */
    void (*draw)(const void *context, uint16_t member, uint8_t output,
                 struct interact_plant *member_plant);
    const void *context;
};

/* s_most 2, t_most 1.5, t_nominal 1.3, gains to 100, all of one part, no members. */
void robust_config_default(struct robust_config *config);

/* ERR_RANGE, ERR_NOT_FINITE: a field out of its range, or a loop with a derivative; reason says which. start is checked. */
MUST_CHECK enum err robust_config_check(const struct robust_config *config,
                                        const struct loops *start, struct interact_refusal *reason);

#endif
