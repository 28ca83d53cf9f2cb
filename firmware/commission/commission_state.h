/* struct commission: nothing but the parts of start-up, each with a file of its own that alone touches its fields. The files of
 * start-up hand a part to the functions of its file. */
#ifndef REFLUX_COMMISSION_COMMISSION_STATE_H
#define REFLUX_COMMISSION_COMMISSION_STATE_H

#include "commission/adoption_state.h"
#include "commission/analysis_job_state.h"
#include "commission/analysis_state.h"
#include "commission/background_state.h"
#include "commission/by_relay_state.h"
#include "commission/element.h"
#include "commission/experiment_state.h"
#include "commission/lease_state.h"
#include "commission/model_state.h"
#include "commission/origin_state.h"
#include "commission/requests_state.h"
#include "commission/sensor_watch.h"
#include "commission/status_state.h"
#include "commission/test_inputs_state.h"
#include "commission/test_outputs_state.h"

/* In the workspace (lease.h). After the trial its figures are still in struct commission. */
struct commission_work {
    struct element element[CHANNEL_MAX][CHANNEL_MAX]; /* [output][input] */
    struct sensor_watch sensor[CHANNEL_MAX];          /* by output */
    real_t share[CHANNEL_MAX]; /* of the direction under test, by input: 1 the largest */
    union {
        struct experiment experiment;
        struct relay_test relay;
        struct analysis analysis;
    };
};

struct commission {
    struct commission_work *work;
    struct startup_status status;
    struct startup_background background;
    struct startup_lease lease;
    struct startup_requests requests; /* from here on all is 0 when start-up begins anew */
    struct test_outputs outputs;
    struct test_inputs inputs;
    struct origin origin; /* from before the first test to the end of the trial */
    struct model_fits model;
    struct analysis_job analysis_job;
    struct by_relay by_relay;
    struct adoption adoption;
};

#endif
