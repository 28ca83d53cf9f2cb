/* The tests of the whole plant, input by input: the phase COMMISSION_TESTING. Tick. */
#ifndef REFLUX_COMMISSION_TESTS_H
#define REFLUX_COMMISSION_TESTS_H

#include "supervise/supervisor.h"

#define MISSED_MOST 8u /* missing samples in a row that a test tolerates */

struct commission;

void commission_begin(struct commission *c, struct supervisor *s);
/* The next test of the input whose turn it is, from its start. */
void commission_start_input(struct commission *c, struct supervisor *s);
/* A tick of it. */
void commission_test(struct commission *c, struct supervisor *s);

#endif
