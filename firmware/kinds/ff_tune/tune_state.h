/* The state of a block of the kind `ff_tune`: a place for each of its parts, which their own files know. Only the kind includes this. */
#ifndef REFLUX_FF_TUNE_TUNE_STATE_H
#define REFLUX_FF_TUNE_TUNE_STATE_H

#include "kinds/ff_tune/tune_disturbance_state.h"
#include "kinds/ff_tune/tune_events_state.h"
#include "kinds/ff_tune/tune_learner_state.h"
#include "kinds/ff_tune/tune_paths_state.h"
#include "kinds/ff_tune/tune_proposals_state.h"
#include "kinds/ff_tune/tune_responses_state.h"
#include "kinds/ff_tune/tune_samples_state.h"
#include "kinds/ff_tune/tune_search_state.h"
#include "kinds/ff_tune/tune_settings.h"
#include "kinds/ff_tune/tune_shadows_state.h"
#include "kinds/ff_tune/tune_signals_state.h"
#include "kinds/ff_tune/tune_stages.h"
#include "kinds/ff_tune/tune_stages_state.h"
#include "kinds/ff_tune/tune_test_state.h"
#include "kinds/ff_tune/tune_watch_state.h"

struct tune {
    struct tune_samples samples;
    struct tune_context context;
    struct tune_stages stages;
    struct tune_events events;
    struct tune_signals signals;
    struct tune_proposals proposals;
    struct tune_disturbance disturbance;
    struct tune_learner learner;
    struct tune_watch watch;
    struct tune_test test;
    struct tune_search search;
    struct tune_paths paths;
    struct tune_responses responses;
    struct tune_shadows shadows;
    /* The estimator of the stage. */
    _Alignas(8) char estimator[];
};

NOT_INLINE struct tune_parts tune_parts_of(struct tune *t);

#endif
