/* The parts of the analysis that look at how the plant hangs together: analysis.c puts them in their places. */
#ifndef REFLUX_COMMISSION_ANALYSIS_STRUCTURE_H
#define REFLUX_COMMISSION_ANALYSIS_STRUCTURE_H

#include "commission/analysis_state.h"
#include "exchange/config.h"

/* Cascades, and which of them are to be used: a->cascade, a->inner_outputs. Before the pairing. */
void analysis_find_cascades(struct analysis *a);
/* The pairing by gains, residence times considered: a->second, a->pair_phi. After the pairing. */
void analysis_ask_second(struct analysis *a);
/* Puts the inner loops that are used into the plant: from here on the input of an outer loop's pair is the setpoint of its
 * inner loop. After everything that looks at the plant as it is. */
void analysis_close_inner_loops(struct analysis *a);

/* Whether a loop of the firmware takes these settings. */
bool analysis_loop_takes(const struct tuning *t);

/* A loop that an input of the plant has to itself, on output `inner`, below the loop of pair k; INTERACT_NONE: none. */
uint8_t analysis_inner_of(const struct analysis *a, uint8_t k);
/* Loops that the proposal has: pairs and inner loops. */
uint8_t analysis_loops(const struct analysis *a);

/* Feedforward from the input of pair `from` to that of pair `to`, as docs/commissioning-method.md has it. */
enum feed_verdict {
    FEED_NONE, /* there is no way, or the two disturb each other */
    FEED_USED,
    FEED_COMPANY, /* the loop that would be corrected shares a block with others: this is not its only disturbance */
    FEED_LATE,  /* it would come too late to halve the integral of the error */
    FEED_LARGE, /* gain or times outside of what an element takes */
    FEED_FULL   /* stronger ones take all the places */
};
struct feed {
    struct cross_way
        way; /* in spans; dead_s less the tick by which an element is late, lag_s as long as noise wants */
    real_t left; /* of the integral of the error without it, about: 0 to 1 */
    enum feed_verdict verdict;
};
/* Those that are to be used, the strongest first, and how many. None without a design. */
uint8_t analysis_feeds(const struct analysis *a, struct feed feeds[CONFIG_FEEDFORWARDS]);
struct feed analysis_feed(const struct analysis *a, uint8_t from, uint8_t to);

#endif
