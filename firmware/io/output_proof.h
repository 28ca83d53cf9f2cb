/* Proof of an output: does the channel that an output acts on say that it acts when it is told to, and rests when it is told to rest?
 *
 * A heater (proof `warms`) is judged by what its temperature does in a time, never by where it stands:
 *   on    at least OUTPUT_PROOF_FULL, below `limit`: warmer by `change` within `on_s`, or it is dead. At `limit` and above liquid may boil,
 *         and there more heat gives no more temperature: nothing is said. A dead heater comes to `limit` from above by itself. Where the
 *         reading falls by `change` something cold comes in, and the time begins anew.
 *   off   below `limit`: not warmer by half of `change` in each of three halves of `on_s` in a row; at `limit` two have been enough. So
 *         warm liquor that is poured in within half of `on_s` accuses nobody. While another output of the board is on, what it brings may be
 *         warm, and nothing is said. The heat that metal and pipes had is given `on_s` to come out; where it still comes, each half brings
 *         less of it, and the third is no quarter of the three.
 *   off   at `limit` or above: cooler by `change` within `off_s`, again and again. A heater that boils although it is off does not cool.
 *         Nothing that flows in may be so hot.
 * Of a heater that is partly on nothing is said: at rest losses take all that it gives.
 * A pump or valve (proof `flows`) is judged by the mean of its flow over a window; one reading counts for OUTPUT_PROOF_SPIKE x `change` at most.
 *   on    at least OUTPUT_PROOF_FULL: `change` at least over `on_s`
 *   off   no more than `change` over `off_s`; the flow is given `off_s` to run out.
 * Off counts only while every output with the same channel is off. Without a usable reading all times begin anew.
 *
 * Bounds, from the later one of fault and command, and two samples more (tests/unit/test_output_proof_pots.c measures them):
 *   NO_HEAT      2 x on_s below the limit; longer only as long as it cools by `change` in less than on_s
 *   WARMS        3 x on_s, where the fault heats by `change` in on_s at least, and as long as it is below the limit
 *   NOT_COOLING  off_s
 *   STILL_HOT    after one of the two before: the same once more
 *   FLOWS        2 x off_s; 3 x off_s after it was switched off
 *   NO_FLOW      2 x on_s
 * An on_s or off_s of 0 leaves out what it belongs to.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_IO_OUTPUT_PROOF_H
#define REFLUX_IO_OUTPUT_PROOF_H

#include "exchange/pins.h"
#include "hal/io.h"

/* Fractions of the output's span: as good as on, and as good as off (a motor valve may rest so far from its end). */
#define OUTPUT_PROOF_FULL  0.75f
#define OUTPUT_PROOF_OFF   0.01f
#define OUTPUT_PROOF_SPIKE 4.0f

/* What is known of an output. The numbers are the detail of EVENT_OUTPUT_CONTRADICTED. */
enum output_proof_fault {
    PROOF_FINE, /* or nothing is known yet */
    PROOF_NO_HEAT,
    PROOF_WARMS,
    PROOF_NOT_COOLING,
    PROOF_STILL_HOT, /* after one of the two before */
    PROOF_NO_FLOW,
    PROOF_FLOWS,
    PROOF_FAULTS /* at most 8: three bits */
};

/* All zero: nothing is known. */
struct output_proof {
    float first;              /* reading that this window began with */
    float extreme;            /* its lowest or highest, or where warming began; of a pump EU x s */
    uint32_t passed_ms : 26;  /* of this window; stops at its largest value */
    uint32_t phase : 3;       /* enum proof_phase, output_proof.c */
    uint32_t known_fault : 3; /* enum output_proof_fault */
};

/* What there is to judge an output by at a sample. */
struct output_proof_look {
    float part;   /* what it really is, fraction of its span */
    float others; /* the largest part of another output with the same channel; 0: there is none */
    float elsewhere;   /* the largest part of any other output of the board */
    float reading;     /* of its channel, EU */
    bool usable;       /* whether there is such a reading */
    uint32_t since_ms; /* since the sample before */
};

/* A sample later. Returns what is known now. A heater that has been said to be on while it is off (output_proof_stuck()) stays so. */
enum output_proof_fault output_proof_step(struct output_proof *p, const struct proof_config *c,
                                          const struct output_proof_look *look);

/* Whether this is a fault that must take the power from all heaters. */
static inline bool output_proof_stuck(enum output_proof_fault fault)
{
    return fault >= PROOF_WARMS && fault <= PROOF_STILL_HOT;
}

/* The fault in words; "?" for PROOF_FINE and out of range. */
const char *output_proof_text(uint8_t fault);

#endif
