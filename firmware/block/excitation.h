/* Test signals that blocks ask for: excitation of a manipulated variable, or of a setpoint.
 *
 * One block at a time has the plant, or automatic start-up has it. A block asks in its step, and anew in every following one
 * for as long as it wants to go on (block_io.requests.excite); with the first asking it says what it excites, how far at most, and
 * within which limits, and that holds until the end. Whatever comes between ends all of it in the same tick, and the block is
 * told why in its next step. After an end it has to let one step pass without asking; where the plant was taken it may go on
 * asking, and gets it when it is free. */
#ifndef REFLUX_BLOCK_EXCITATION_H
#define REFLUX_BLOCK_EXCITATION_H

#include <stdint.h>

#include "num/num.h"

#define BLOCK_EXCITES_MAX 4 /* what one block may excite at the same time */

enum excite_what {
    EXCITE_NOTHING,
    EXCITE_MV, /* the MV that member `which` drives: added to what the block and feedforward give */
    EXCITE_INPUT,   /* the MV that is input `which`: added to what its loop, or a hand, gives */
    EXCITE_SETPOINT /* the setpoint of member `which`, after ramp and filter; from its next turn on */
};

/* All numbers are fractions of span, of the MV or of the member's PV. */
struct block_excitation {
    uint8_t what, which; /* enum excite_what */
    num_t value;         /* that is added, until the next step */
    num_t amplitude;     /* above 0: no |value| is larger */
    num_t lo, hi;        /* the MV's command, or the setpoint, with what is added stays within */
};

/* What a block is told of what it asked for in its last step. */
enum excite_state { EXCITE_OFF, EXCITE_RUNS, EXCITE_REFUSED, EXCITE_ENDED };

/* Why it was refused, or has ended. */
enum excite_reason {
    EXCITE_FINE,
    EXCITE_TAKEN, /* somebody else has the plant: block_io.requests.excite_holder */
    EXCITE_ASKED, /* the block asked no more */
    EXCITE_LIMIT, /* command or setpoint came to a limit: its own, the loop's, the operating limits; or has no room */
    EXCITE_INTERLOCK, /* holds the MV */
    EXCITE_MODE,      /* of the loop has changed; of a setpoint: it is in manual */
    EXCITE_HAND,      /* somebody moved the MV */
    EXCITE_CHANNEL,   /* MV or PV is lost */
    EXCITE_SAFE,      /* the safe state */
    EXCITE_SEQUENCE,  /* runs */
    EXCITE_PLAN,      /* changes what is excited, or the block */
    EXCITE_GAVE_UP,   /* the block, or it was switched off */
    EXCITE_WRONG, /* what it asks for is no MV or setpoint it may excite, or not what it began with; or numbers */
    EXCITE_REASONS
};

#endif
