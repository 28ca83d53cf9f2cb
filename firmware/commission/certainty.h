/* Certainty of a pairing that the draws hold for certain: everything else that is known of the model has to agree. A doubt is
 * reported, and the pairing is not determined. Also which channels the pairs leave over, and why. Main loop. */
#ifndef REFLUX_COMMISSION_CERTAINTY_H
#define REFLUX_COMMISSION_CERTAINTY_H

#include <stdbool.h>
#include <stdint.h>

#include "identify/identified.h"
#include "interact/pairing.h"

struct analysis;

/* The test did not show the end of the response, so its gain may be anything: while any element has one of these, nothing is
 * determined. Longer tests may resolve them. */
#define CERTAINTY_OPEN_FLAGS (IDENTIFIED_SLOW | IDENTIFIED_UNKNOWN)

/* Reasons why a channel that was tested has no loop. */
enum left_over {
    LEFT_NOT,    /* it has one, or nothing is determined yet */
    LEFT_UNSEEN, /* none of its gains exceeds its error */
    LEFT_OVER    /* surplus: the pairs are better without it */
};

/* Notes doubts about draws, rank, determinant, signs and flags, once the pairs are chosen, and lowers *verdict. */
void certainty_of_gains(struct analysis *a, enum pairing_verdict *verdict);

/* Returns the flags of the element from input i to output j that cause a doubt, whether a pair uses it or not. */
uint16_t certainty_flags(const struct analysis *a, uint8_t j, uint8_t i);
/* The sign of the gain of pair k is uncertain. */
bool certainty_sign_is_unsure(const struct analysis *a, uint8_t k);

/* The reason for an output, for an input. Where nothing is determined only LEFT_UNSEEN. */
enum left_over certainty_output_left(const struct analysis *a, uint8_t j);
enum left_over certainty_input_left(const struct analysis *a, uint8_t i);

#endif
