/* The parts of the analysis about the structure of the plant; analysis.c calls them in turn. Main loop. */
#ifndef REFLUX_COMMISSION_ANALYSIS_STRUCTURE_H
#define REFLUX_COMMISSION_ANALYSIS_STRUCTURE_H

#include "commission/analysis_state.h"
#include "exchange/config.h"

/* Finds cascades and chooses those to use. Before the pairing. */
void analysis_find_cascades(struct analysis *a);
/* Compares the pairing with one by gains over residence times. After the pairing. */
void analysis_ask_second(struct analysis *a);
/* Finds parts and blocks of the plant. After the pairing. */
void analysis_find_structure(struct analysis *a);
/* Puts the inner loops that are used into *plant, that of *a: from here on the input of an outer loop's pair is the setpoint of its
 * inner loop. After everything that needs the plant as it is. */
void analysis_close_inner_loops(struct analysis *a, struct interact_plant *plant);

/* The settings are within the ranges of a loop of the firmware. */
bool analysis_loop_takes(const struct tuning *t);

/* Output of the inner loop below the loop of pair k; INTERACT_NONE: it has none. */
uint8_t analysis_inner_of(const struct analysis *a, uint8_t k);
/* Number of loops of the proposal, inner ones included. */
uint8_t analysis_loops(const struct analysis *a);

/* Feedforward from the input of pair `from` to that of pair `to`, as docs/inside/commissioning.md has it. */
enum feed_verdict {
    FEED_NONE, /* there is no path, or the two disturb each other */
    FEED_USED,
    FEED_COMPANY, /* the corrected loop shares a block with others: this is not its only disturbance */
    FEED_LATE,    /* it would come too late to halve the integral of the error */
    FEED_LARGE, /* gain or times exceed an element's range */
    FEED_FULL   /* stronger ones take all places */
};
struct feed {
    /* In spans; dead_s without the tick by which an element is late, lag_s as long as noise demands. */
    struct cross_way way;
    real_t left; /* approximate share of the integral of the error without it, 0 to 1 */
    enum feed_verdict verdict;
};
/* Lists the feedforwards to use, the strongest first, and returns their number; 0 without a design. */
uint8_t analysis_feeds(const struct analysis *a, struct feed feeds[CONFIG_FEEDFORWARDS]);
struct feed analysis_feed(const struct analysis *a, uint8_t from, uint8_t to);

#endif
