/* Results of the analysis in words for console and report; constant texts. Main loop. */
#ifndef REFLUX_COMMISSION_WORDS_H
#define REFLUX_COMMISSION_WORDS_H

#include "commission/analysis_structure.h"
#include "commission/certainty.h"

const char *words_of_verdict(const struct analysis *a);
/* "": there is none. */
const char *words_of_second(enum analysis_second second);
/* The reason why a determined pairing has no settings. */
const char *words_of_no_design(enum err reason);
const char *words_of_decoupler(enum analysis_decoupler decoupler);
const char *words_of_feed(enum feed_verdict verdict);
/* The reason why a channel has no loop; "": it has one. */
const char *words_of_left(enum left_over reason);

/* A doubt about the pairing as a whole: its name, its figure, and the meaning of that. */
struct words_doubt {
    const char *name, *text;
    real_t value;
};
#define WORDS_DOUBTS 2u
/* Gives the n-th of WORDS_DOUBTS doubts. False: the pairing has no such doubt. */
bool words_of_doubt(const struct analysis *a, unsigned n, struct words_doubt *doubt);

#endif
