/* Is a pairing that the draws hold for sure to be valid? Whatever else is known of the model has to agree; what does not
 * is said, and the pairing is not determined. And what of the plant is left over by the pairs, and why. */
#ifndef REFLUX_COMMISSION_CERTAINTY_H
#define REFLUX_COMMISSION_CERTAINTY_H

#include "commission/analysis_state.h"
#include "identify/identified.h"

/* The end of the response was not seen, so its gain may be anything: while any element has one of these, nothing is
 * determined. Longer tests may resolve them. */
#define CERTAINTY_OPEN_FLAGS (IDENTIFIED_INTEGRATING | IDENTIFIED_SHORT | IDENTIFIED_NOT_SETTLED)
/* No loop is made of such an element, and longer tests change nothing. */
#define CERTAINTY_FINAL_FLAGS IDENTIFIED_OSCILLATORY
#define CERTAINTY_FLAGS       (CERTAINTY_OPEN_FLAGS | CERTAINTY_FINAL_FLAGS)

/* Why a channel that was tested has no loop. */
enum left_over {
    LEFT_NOT,    /* it has one, or nothing is determined yet */
    LEFT_UNSEEN, /* none of its gains stands out of its error */
    LEFT_OVER /* there are more of these than of the others, which the pairs reach better by the rest */
};

/* Once the draws are done: rank, determinant, signs and flags, into a->doubts. */
void certainty_of_gains(struct analysis *a);
/* Once the second opinion is there. */
void certainty_of_second(struct analysis *a);

/* Flags of the element from input i to output j that speak against the pairing: all of CERTAINTY_FLAGS where a pair uses the
 * element, else CERTAINTY_OPEN_FLAGS. */
uint16_t certainty_flags(const struct analysis *a, uint8_t j, uint8_t i);
/* Is the sign of a pair's gain unsure? k: of the pair. */
bool certainty_sign_is_unsure(const struct analysis *a, uint8_t k);
/* Only what more tests do not change speaks against the pairing. */
bool certainty_is_final(const struct analysis *a);

/* Of an output, of an input. Where nothing is determined, too, those of which nothing is seen. */
enum left_over certainty_output_left(const struct analysis *a, uint8_t j);
enum left_over certainty_input_left(const struct analysis *a, uint8_t i);

#endif
