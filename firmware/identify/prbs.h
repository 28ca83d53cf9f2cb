/* Pseudorandom binary signals that excite several inputs at the same time, without correlation between them over the
 * memory of a plant: maximal-length sequences of shift registers, as Kotyk and Machacek (1995), section 3, had them for
 * two inputs; their register length, clock and amplitudes are not told, those here are ours.
 *
 * A register of n bits repeats after L = 2^n - 1 steps. A sequence of +-1 has the correlation 1 with itself, -1/L with any
 * shift of itself. So one register serves all inputs, each with a shift of L/inputs of its own (PRBS_SHIFTS): exactly
 * uncorrelated but for 1/L up to that lag, over a whole period. Or each input has a register one bit longer than the one
 * before (PRBS_REGISTERS): nearly uncorrelated at every lag in the long run, not within one period. S. W. Golomb, Shift Register
 * Sequences (1967). */
#ifndef REFLUX_IDENTIFY_PRBS_H
#define REFLUX_IDENTIFY_PRBS_H

#include <stdint.h>

#include "base/error.h"
#include "num/real.h"

#define PRBS_INPUTS     4
#define PRBS_BITS_LEAST 3
#define PRBS_BITS_MOST  15

/* In the order of words for it. */
enum prbs_independence { PRBS_SHIFTS, PRBS_REGISTERS };
#define PRBS_INDEPENDENCE_WORDS "shifts|registers"

struct prbs_settings {
    uint8_t inputs;       /* 1 to PRBS_INPUTS */
    uint8_t bits;         /* of the first register: 3 to 15, to 12 where 4 have their own */
    uint8_t independence; /* enum prbs_independence */
    uint16_t clock;       /* samples between steps of the registers, 1 to 10000 */
    real_t amplitude[PRBS_INPUTS]; /* deviation to either side, input's unit, [0, 1e6]; 0 rests */
};

struct prbs {
    uint8_t inputs;
    uint16_t clock, waited;
    uint16_t state[PRBS_INPUTS], taps[PRBS_INPUTS];
    real_t amplitude[PRBS_INPUTS];
};

/* Everything is checked. *field: the member that is wrong, *wanted: what would be right; either may be NULL. NaN and
 * infinity are ERR_NOT_FINITE, all else ERR_RANGE. */
MUST_CHECK enum err prbs_check(const struct prbs_settings *settings, const char **field,
                               const char **wanted);

/* Settings that prbs_check accepts. Shifts are walked through: up to 3 x 2^15 register steps. */
void prbs_init(struct prbs *p, const struct prbs_settings *settings);

/* A sample: u [inputs] gets the deviation of each input, + or - its amplitude. */
void prbs_step(struct prbs *p, real_t *u);

/* Samples until the sequence of the first register begins anew: (2^bits - 1) clock. */
uint32_t prbs_period(const struct prbs_settings *settings);

/* Samples up to which no input is correlated with another (but for 1/L): the shift between neighbours, of PRBS_SHIFTS. The
 * plant has to settle within it. Of PRBS_REGISTERS: the period. */
uint32_t prbs_memory(const struct prbs_settings *settings);

#endif
