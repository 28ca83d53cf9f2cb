/* The state behind tune_paths.h, for its file and for whoever gives it its place. */
#ifndef REFLUX_FF_TUNE_TUNE_PATHS_STATE_H
#define REFLUX_FF_TUNE_TUNE_PATHS_STATE_H

#include "design/response_fit.h"
#include "kinds/ff_tune/tune_results.h"

struct tune_paths {
    struct tune_model process;
    struct response_fit fit;
    struct tune_rule rule;
    /* A fit is under way. */
    bool fitting;
};

#endif
