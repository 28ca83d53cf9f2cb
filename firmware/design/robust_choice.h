/* The moves that the climb of design/robust.h makes after a pass. */
#ifndef REFLUX_DESIGN_ROBUST_CHOICE_H
#define REFLUX_DESIGN_ROBUST_CHOICE_H

#include "design/robust_pass.h"

/* Puts the numbers of the best moves that keep the bounds into chosen, the best first: one move in all where most is 1, else at
 * most one of each loop. Returns how many. The best raises the sum that is climbed most and stays farthest from the bounds. */
uint8_t robust_choose(const struct robust_pass *pass, uint8_t most, uint8_t chosen[INTERACT_MAX]);

/* Returns by how many steps the first n of the chosen moves may have raised the frequencies at which the loops act, in their
 * logarithm. */
real_t robust_rise(uint8_t loops, const uint8_t chosen[INTERACT_MAX], uint8_t n);

#endif
