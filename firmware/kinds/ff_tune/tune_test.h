/* The test of a candidate of a block of the kind `ff_tune`, on fresh data: parts in which the disturbance moves are compared with the loop as it is
 * and with feedback alone. */
#ifndef REFLUX_FF_TUNE_TUNE_TEST_H
#define REFLUX_FF_TUNE_TUNE_TEST_H

#include "kinds/ff_tune/tune_shadows.h"
#include "kinds/ff_tune/tune_stage.h"

struct tune_test;

/* The candidate's shadow begins at the disturbance d. */
void tune_test_begin(struct tune_test *t, const struct tune_context *c);
/* Takes a sample; d: its disturbance, move_square: mean square of d while the element was learnt, samples: since the test began. TUNE_NONE: the test
 * goes on; TUNE_ADOPTED: the candidate has passed. */
enum tune_verdict tune_test_step(struct tune_test *t, const struct tune_context *c,
                                 const struct tune_shadows *s, real_t d, real_t move_square,
                                 uint32_t samples);

/* Parts that are over. */
unsigned tune_test_parts(const struct tune_test *t);
/* The element was changed by others: nothing is promised of it. */
void tune_test_forget(struct tune_test *t);
/* The squares that the candidate takes off those of feedback alone, as tested. */
real_t tune_test_promised(const struct tune_test *t);
/* Mean square of the error under feedback alone, as it was in the test. */
real_t tune_test_square(const struct tune_test *t);
/* The same over that of the disturbance. */
real_t tune_test_alone(const struct tune_test *t);

#endif
