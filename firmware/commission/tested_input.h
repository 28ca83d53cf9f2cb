/* An input and what its tests have found: a record of test_inputs.c, which alone writes it. */
#ifndef REFLUX_COMMISSION_TESTED_INPUT_H
#define REFLUX_COMMISSION_TESTED_INPUT_H

#include <stdbool.h>
#include <stdint.h>

#include "num/real.h"

struct tested_input {
    real_t test_base; /* where the output is held, fraction of span */
    real_t amplitude; /* of the latest test */
    real_t half_s;    /* length of its positive half */
    /* Wishes for the next test: its shortest half in samples, its first amplitude and its largest one as fractions of span.
     * 0: no wish. */
    uint32_t half_wanted;
    real_t amplitude_wanted;
    real_t amplitude_most;
    real_t cut_predicted; /* peak for which the guard cut the test, fraction of span */
    real_t worst;         /* largest share of a limit that was reached */
    uint8_t output;       /* index of the manipulated variable in the configuration */
    uint8_t rounds;       /* tests that count */
    /* Tests that were repeated: with longer halves, because an output had not come to rest; with a smaller step, because an
     * output is not linear; with a smaller step, because the guard had cut the test. */
    uint8_t longer_retries, linear_retries, cut_retries;
    uint8_t cut_by; /* index of the tested measurement for which the guard cut the test */
    bool skipped, cut;
    bool small;     /* the response did not stand out of the noise as it should */
    bool unsettled; /* the latest analysis wants a longer test to see the end of a response */
};

#endif
