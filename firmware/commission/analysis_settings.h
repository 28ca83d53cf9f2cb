/* Settings of an analysis' pairs: what they are made for, and within which bounds. Main loop. */
#ifndef REFLUX_COMMISSION_ANALYSIS_SETTINGS_H
#define REFLUX_COMMISSION_ANALYSIS_SETTINGS_H

#include <stdbool.h>

#include "base/error.h"

struct analysis;

/* Exchanges the elements for their beginnings: the settings are made for those, all else for the whole elements. */
void settings_exchange_beginnings(struct analysis *a, bool begins);
/* Begins the settings of a->pairs in a->work.detune, with a->d where decoupled; parts of the plant that do not act on each other
 * count where they are known. ERR_UNSUPPORTED: gains or times that no rule is for. */
enum err settings_begin(struct analysis *a, bool decoupled);

#endif
