/* The choice among pairings that would do: settings are made for each, and the one whose loops correct loads fastest is taken.
 * A step at the input of loop k leaves an integral of its error of T_i/K_c, in output spans times s per input span, so the
 * product of K_c/T_i over all loops compares pairings of the same channels whatever their units. Loops of which some run away
 * with the others in manual must be faster by half each to be taken. Main loop. */
#ifndef REFLUX_COMMISSION_ANALYSIS_CHOICE_H
#define REFLUX_COMMISSION_ANALYSIS_CHOICE_H

#include "base/error.h"
#include "interact/plant.h"

struct analysis;

/* Inputs that output j is kept apart from, bit i input i: pairs that are given are kept apart from all others. */
void choice_keep_apart(const struct analysis *a, uint16_t apart[INTERACT_MAX]);

/* Looks for pairings of the channels of a->pairs. Errors as candidates_begin(). */
enum err choice_begin(struct analysis *a);
/* A step of that, as candidates_step(). */
enum err choice_find(struct analysis *a);
/* A step of the settings of all of them: ERR_BUSY while there is more to do. In the end a->pairs, relative gains, index and
 * probability are those of the one that is taken. Where none would do they stay, and the probability is that of the first. */
enum err choice_step(struct analysis *a);

#endif
