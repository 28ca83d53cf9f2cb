/* The state behind tune_search.h, for its file and for whoever gives it its place. */
#ifndef REFLUX_FF_TUNE_TUNE_SEARCH_STATE_H
#define REFLUX_FF_TUNE_TUNE_SEARCH_STATE_H

#include "kinds/ff_tune/feedforward_search.h"

enum tune_work { WORK_NONE, WORK_RESPONSES, WORK_RATIO, WORK_PROCESS, WORK_PATH, WORK_SEARCH };

struct tune_search {
    struct feedforward_wanted wanted;
    struct feedforward_search search;
    struct feedforward_shape candidate;
    real_t spread;
    /* Pieces until the next step. */
    uint16_t pieces;
    /* enum tune_work and its point: the work's own while it is wanted. */
    uint8_t work, point;
    /* enum tune_verdict */
    uint8_t outcome;
    bool look_only;
    bool computing, idle, reading;
    /* The ratio is in too much doubt for a search. */
    bool unsure;
    bool by_rule;
};

#endif
