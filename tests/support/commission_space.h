/* The workspace as start-up leases it, for tests below the console. */
#ifndef REFLUX_TESTS_COMMISSION_SPACE_H
#define REFLUX_TESTS_COMMISSION_SPACE_H

#include <string.h>

#include "commission/acceptance.h"
#include "commission/analysis.h"
#include "commission/analysis_structure.h"
#include "commission/background.h"
#include "commission/certainty.h"
#include "commission/combine.h"
#include "commission/commission.h"
#include "commission/experiment.h"
#include "commission/lease.h"
#include "commission/model.h"
#include "commission/proposal.h"
#include "commission/proposal_loops.h"
#include "commission/results.h"
#include "commission/start_stop.h"
#include "commission/tests.h"
#include "commission/trial_plan.h"
#include "unity.h"

static struct commission_work commission_space;
static struct workspace commission_region;

/* Empty, and not leased. */
static inline struct workspace *commission_fresh_region(void)
{
    memset(&commission_space, 0, sizeof commission_space);
    workspace_init(&commission_region, &commission_space, sizeof commission_space);
    return &commission_region;
}

/* Empty, and leased by *c. */
static inline void commission_lease(struct commission *c)
{
    void *memory;
    c->lease.workspace = commission_fresh_region();
    TEST_ASSERT_EQUAL_INT(ERR_OK, workspace_lease(c->lease.workspace, COMMISSION_HOLDER,
                                                  "commission abort", sizeof *c->work, &memory));
    c->work = memory;
}

#endif
