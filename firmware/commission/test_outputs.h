/* The measurements under test, called outputs (of the process): which they are, to which plan they belong, their noise, and when the
 * tests saw them last. The tick writes it; the main loop reads it, under hal_tick_lock. */
#ifndef REFLUX_COMMISSION_TEST_OUTPUTS_H
#define REFLUX_COMMISSION_TEST_OUTPUTS_H

#include "commission/origin.h"
#include "num/real.h"
#include "supervise/supervisor.h"

struct test_outputs;

/* The tests belong to the plan in force; all is 0 before, and the outputs are added next. */
void outputs_begin(struct test_outputs *t, const struct supervisor *s);
void outputs_add(struct test_outputs *t, uint8_t measurement);

/* Name of output j. */
const char *outputs_name(const struct test_outputs *t, const struct supervisor *s, uint8_t j);

/* The configuration has the channels and spans that were tested. */
bool outputs_are_those_of(const struct test_outputs *t, const struct config *config);

/* Counts for how many samples in a row each output has read an end of its span; once a tick. */
void outputs_watch_spans(struct test_outputs *t, const struct supervisor *s);
/* An output that has done so for two samples; negative: none. */
int outputs_at_end(const struct test_outputs *t);

/* The present sample of every output, fraction of span. */
void outputs_read(const struct test_outputs *t, const struct supervisor *s, real_t *y);
/* Samples since the last one that the tests have seen; this one is seen. */
uint32_t outputs_see_sample(struct test_outputs *t, const struct supervisor *s);
/* As outputs_mark_sample(); time without samples for the tests makes the operating point older. */
void outputs_age_origin(struct test_outputs *t, struct origin *origin, const struct supervisor *s);

#endif
