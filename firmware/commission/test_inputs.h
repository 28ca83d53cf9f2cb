/* The inputs under test: their order, whose turn it is, in which round, and what each test has left. The tick writes it; the main
 * loop reads it, under hal_tick_lock where it wants several values that agree. */
#ifndef REFLUX_COMMISSION_TEST_INPUTS_H
#define REFLUX_COMMISSION_TEST_INPUTS_H

#include "commission/tested_input.h"

struct test_inputs;

/* The first round begins; all is 0 before, and the inputs are added next. */
void inputs_begin(struct test_inputs *t);
void inputs_add(struct test_inputs *t, uint8_t output, real_t test_base);
/* Adds a direction behind the inputs, of whose shares that of input `largest` is the largest; its turn is next. Fewer than
 * CHANNEL_MAX inputs, and none yet. */
void inputs_line_up_direction(struct test_inputs *t, uint8_t largest);

/* The input whose turn it is. */
const struct tested_input *inputs_under_test(const struct test_inputs *t);

/* Input k is to be tested in this round. */
bool inputs_is_due(const struct test_inputs *t, uint8_t k);
/* Number of inputs that are due from this turn on. */
uint8_t inputs_due_from(const struct test_inputs *t, uint8_t turn);
/* Goes to the next input that is due. False: there is none in this round. */
bool inputs_next(struct test_inputs *t);
/* Begins another round. False: the first input is not due in it. */
bool inputs_next_round(struct test_inputs *t, bool only_unsettled);
/* Goes one turn back; what its tests have found is discarded. */
void inputs_repeat(struct test_inputs *t);
void inputs_skip(struct test_inputs *t);

/* Results of a test of the input whose turn it is. */
struct test_result {
    real_t amplitude, half_s, worst;
    real_t took_s; /* with its rests */
    bool cut, small;
};
void inputs_note_test(struct test_inputs *t, const struct test_result *result);
void inputs_note_cut(struct test_inputs *t, uint8_t culprit, real_t predicted);
void inputs_note_worst(struct test_inputs *t, real_t worst);
/* As inputs_note_worst() where this share is larger than the one before. */
void inputs_raise_worst(struct test_inputs *t, real_t worst);
void inputs_set_amplitude(struct test_inputs *t, real_t amplitude);
/* The test counts. */
void inputs_count_round(struct test_inputs *t);

/* Wishes for the repeated test of the input whose turn it is; they return how often such a wish has been made. */
uint8_t inputs_want_longer(struct test_inputs *t, uint32_t half);
/* Sets the least length of the next half, samples. */
void inputs_want_half(struct test_inputs *t, uint32_t half);
uint8_t inputs_want_linear(struct test_inputs *t, real_t amplitude);
uint8_t inputs_want_uncut(struct test_inputs *t, real_t amplitude);
/* The smallest step with which a test was repeated because an output is not linear, fraction of span; 0: none was. */
real_t inputs_small_step(const struct test_inputs *t);

/* Mean duration of the tests that are over, s. */
real_t inputs_mean_test_s(const struct test_inputs *t);

#endif
