/* Settings of an analysis' pairs: what they are made for, and within which bounds. Main loop. */
#ifndef REFLUX_COMMISSION_ANALYSIS_SETTINGS_H
#define REFLUX_COMMISSION_ANALYSIS_SETTINGS_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"

struct analysis;

/* Begins with the settings of a->pairs, with a->d where decoupled; parts of the plant that do not act on each other count where
 * they are known. First a rule for each loop, all slowed until they are stable together (design/detune.h). From there begins a
 * search for the best settings that are sound for the plant and for every plant that it may be (design/robust.h).
 * ERR_UNSUPPORTED: gains or times that no rule is for. */
enum err settings_begin(struct analysis *a, bool decoupled);
/* A step of the rule, ERR_BUSY while there is more to do; then a->loops are its settings. */
enum err settings_by_rule(struct analysis *a);
/* Begins the search, for the worst of the first `members` plants that are drawn; steps of it likewise. Then a->loops are the
 * settings. ERR_TIMEOUT: none are slow enough. One plant for which there are none is left out, and another drawn in its place. */
enum err settings_begin_search(struct analysis *a, uint16_t members);
enum err settings_by_search(struct analysis *a);

#endif
