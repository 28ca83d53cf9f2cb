/* What the analysis has found, in words for console and report. All constant text. */
#ifndef REFLUX_COMMISSION_WORDS_H
#define REFLUX_COMMISSION_WORDS_H

#include "commission/analysis_structure.h"
#include "commission/certainty.h"

const char *words_of_verdict(const struct analysis *a);
/* "" where there is none. */
const char *words_of_second(enum analysis_second second);
/* Why a determined pairing has no settings. */
const char *words_of_no_design(enum err reason);
const char *words_of_decoupler(enum analysis_decoupler decoupler);
const char *words_of_feed(enum feed_verdict verdict);
/* Why a channel has no loop; "" where it has one. */
const char *words_of_left(enum left_over reason);

/* Something that speaks against the pairing as a whole: its name, its figure, and what that means. */
struct words_doubt {
    const char *what, *text;
    real_t value;
};
#define WORDS_DOUBTS 3u
/* The n-th of WORDS_DOUBTS; false where it does not. */
bool words_of_doubt(const struct analysis *a, unsigned n, struct words_doubt *doubt);

#endif
