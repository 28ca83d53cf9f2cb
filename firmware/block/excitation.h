/* Test signals that blocks ask for: excitation of an MV, or of a setpoint.
 *
 * The plant belongs to one block at a time, or to automatic start-up. A block asks for excitation in its step, and
 * asks again in every following step for as long as it wants to go on (block_io.requests.excite). Its first request
 * says what it excites, the largest amplitude, and the limits, and these hold until the end. Any interruption ends
 * all of its test signals in the same tick, and the block learns why in its next step. After an end the block must
 * let one step pass without a request. If the plant was taken, the block may go on asking, and gets the plant when
 * it is free. */
#ifndef REFLUX_BLOCK_EXCITATION_H
#define REFLUX_BLOCK_EXCITATION_H

#include <stdint.h>

#include "num/num.h"

#define BLOCK_EXCITES_MAX 4 /* most test signals of one block at the same time */

enum excite_what {
    EXCITE_NOTHING,
    /* The MV that member `which` drives; the test signal is added to the outputs of block and feedforward. */
    EXCITE_MV,
    /* The MV that is input `which`; the test signal is added to the output of its loop, or to the manual value. */
    EXCITE_INPUT,
    /* The setpoint of member `which`, after ramp and filter; from the member's next execution on. */
    EXCITE_SETPOINT
};

/* All numbers are fractions of span, of the MV or of the member's PV. */
struct block_excitation {
    uint8_t what, which; /* enum excite_what */
    num_t value;         /* added until the next step */
    num_t amplitude;     /* largest |value|; above 0 */
    /* The MV's command, or the setpoint, stays within these limits with the test signal added. */
    num_t lo, hi;
};

/* Answer to the request that a block made in its last step. */
enum excite_state { EXCITE_OFF, EXCITE_RUNS, EXCITE_REFUSED, EXCITE_ENDED };

/* Why the excitation was refused, or has ended. */
enum excite_reason {
    EXCITE_FINE,
    EXCITE_TAKEN, /* another holds the plant: block_io.requests.excite_holder */
    EXCITE_ASKED, /* the block stopped asking */
    /* The command or setpoint reached a limit (its own, the loop's, or an operating limit), or has no room. */
    EXCITE_LIMIT,
    EXCITE_INTERLOCK, /* an interlock holds the MV */
    EXCITE_MODE,      /* the loop's mode has changed; for a setpoint: the loop is in manual */
    EXCITE_HAND,      /* somebody moved the MV by hand */
    EXCITE_CHANNEL,   /* the MV or the PV is lost */
    EXCITE_SAFE,      /* the safe state was taken */
    EXCITE_SEQUENCE,  /* a sequence runs */
    EXCITE_PLAN,      /* a new plan changes the excited MV or loop, or the block */
    EXCITE_GAVE_UP,   /* the block gave up, or was switched off */
    /* The request names an MV or setpoint that the block may not excite, or differs from the first request; or its
     * numbers are wrong. */
    EXCITE_WRONG,
    EXCITE_REASONS
};

#endif
