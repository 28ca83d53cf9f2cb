#include "kinds/experiment/experiment_stages.h"

#include "base/assertion.h"
#include "base/channel.h"
#include "kinds/experiment/experiment_finding.h"
#include "kinds/experiment/experiment_job.h"
#include "kinds/experiment/experiment_law.h"
#include "kinds/experiment/experiment_lease.h"
#include "kinds/experiment/experiment_model.h"
#include "kinds/experiment/experiment_proposals.h"
#include "kinds/experiment/experiment_record.h"
#include "kinds/experiment/experiment_stages_state.h"

bool experiment_runs(const struct experiment_stages *s)
{
    return s->stage >= EXPERIMENT_ASKED && s->stage <= EXPERIMENT_COMPUTES;
}

/* Ends it. The MVs return to where they rested, since it asks for no signal any longer. */
static void abort_experiment(const struct experiment_parts *p, enum experiment_reason reason)
{
    experiment_lease_end(p->lease);
    p->stages->stage = EXPERIMENT_ABORTED;
    p->stages->reason = (uint8_t)reason;
    p->stages->asked_signal = false;
    p->stages->event = EVENT_ABORTED + 1;
}

static void stage_begins(const struct experiment_parts *p, enum experiment_stage stage)
{
    p->stages->stage = (uint8_t)stage;
    experiment_record_stage(p->record);
}

/* The workspace, and a reading of everything. */
static void wait_for_workspace(const struct experiment_parts *p, struct block_io *io)
{
    bool leased = experiment_leased(p->lease) != NULL, whole = true;
    for (unsigned i = 0; i < p->context->n; i++)
        whole = whole && io->inputs.quality[i] == QUALITY_GOOD;
    if (leased && whole) {
        experiment_settling_begin(p->record, p->context);
        stage_begins(p, EXPERIMENT_SETTLES);
    } else if (io->requests.work_done && !leased) {
        abort_experiment(p, REASON_WORKSPACE);
    } else if (!leased && !io->requests.work_wanted) {
        io->requests.ask_work = 1;
    }
}

static void settle_on(const struct experiment_parts *p, const struct block_io *io)
{
    if (!experiment_settle(p->record, p->context, io, &p->stages->at_fault))
        return;
    if (p->stages->at_fault) {
        abort_experiment(p, REASON_UNSTEADY);
    } else {
        experiment_signal_begin(p->record, p->context);
        stage_begins(p, EXPERIMENT_EXCITES);
    }
}

static void excite_on(const struct experiment_parts *p, struct block_io *io)
{
    struct experiment_rows *rows = experiment_job_rows(experiment_leased(p->lease));
    if (!experiment_record_tick(p->record, p->context, rows, io)) {
        p->stages->asked_signal = experiment_ask_signal(p->record, p->context, io);
        return;
    }
    p->stages->asked_signal = false;
    stage_begins(p, EXPERIMENT_COMPUTES);
}

static void take_found_model(const struct experiment_parts *p, const struct experiment_finding *f)
{
    struct experiment_stages *s = p->stages;
    s->verdict = experiment_model_take(p->model, p->coefficients, p->context,
                                       experiment_finding_result(f), p->record, &s->at_fault);
    experiment_lease_end(p->lease);
    stage_begins(p, EXPERIMENT_DONE);
    s->event = (s->verdict == PLANT_USABLE ? EVENT_MODEL : EVENT_NO_MODEL) + 1;
    if (s->verdict == PLANT_USABLE)
        experiment_propose(p->proposals, p->context->n);
}

static void compute_on(const struct experiment_parts *p, struct block_io *io)
{
    const struct experiment_finding *f = experiment_job_finding(experiment_leased(p->lease));
    if (io->requests.work_wanted)
        return;
    if (experiment_finding_is_over(f)) {
        take_found_model(p, f);
        return;
    }
    p->stages->pieces = p->context->pieces;
    io->requests.ask_work = 1;
}

static void go_on_with_stage(const struct experiment_parts *p, struct block_io *io)
{
    struct experiment_stages *s = p->stages;
    enum experiment_reason reason = REASON_NONE;
    if (s->asked_signal && io->requests.excite_state != EXCITE_RUNS)
        reason = (enum experiment_reason)(REASON_EXCITE + io->requests.excite_reason);
    else if (s->stage <= EXPERIMENT_EXCITES)
        reason = experiment_read(p->record, p->context, io, s->stage == EXPERIMENT_EXCITES,
                                 &s->at_fault);
    if (reason != REASON_NONE)
        abort_experiment(p, reason);
    else if (s->stage == EXPERIMENT_ASKED)
        wait_for_workspace(p, io);
    else if (s->stage == EXPERIMENT_SETTLES)
        settle_on(p, io);
    else if (s->stage == EXPERIMENT_EXCITES)
        excite_on(p, io);
    else
        compute_on(p, io);
}

/* ---- between ticks ---- */

/* Without a lease the next step sees that there is none. */
static void lease_for_record(const struct experiment_parts *p)
{
    const struct experiment_context *c = p->context;
    void *job = experiment_lease_ask(p->lease, experiment_job_bytes(c->n, c->wanted));
    if (!job)
        return;
    experiment_job_begin(job, c);
    experiment_lease_hold(p->lease, job);
}

bool experiment_stages_work(const struct experiment_parts *p)
{
    struct experiment_job *job = experiment_leased(p->lease);
    if (experiment_law_runs(p->law))
        return experiment_law_work(p->law, p->context);
    if (p->stages->stage == EXPERIMENT_ASKED && !job)
        lease_for_record(p);
    if (p->stages->stage != EXPERIMENT_COMPUTES || !job ||
        !experiment_finding_piece(experiment_job_finding(job), p->context,
                                  experiment_job_rows(job)))
        return false;
    return --p->stages->pieces > 0;
}

/* ---- a step ---- */

static void keep_workspace(const struct experiment_parts *p)
{
    if (!experiment_runs(p->stages))
        experiment_lease_end(p->lease);
    else if (!experiment_lease_renew(p->lease))
        abort_experiment(p, REASON_WORKSPACE);
}

static float value_of_experiment_event(const struct experiment_parts *p)
{
    REFLUX_ASSERT(p->stages->event >= 1 && p->stages->event <= EXPERIMENT_EVENTS);
    switch (p->stages->event - 1) {
    case EVENT_LAW:
        return experiment_law_radius(p->law);
    case EVENT_NO_LAW:
        return experiment_law_loop(p->law);
    case EVENT_ABORTED:
        return p->stages->reason;
    case EVENT_NO_MODEL:
        return p->stages->verdict;
    default:
        return experiment_model_fit(p->model, p->context->n);
    }
}

void experiment_stages_step(const struct experiment_parts *p, struct block_io *io)
{
    struct experiment_stages *s = p->stages;
    keep_workspace(p);
    if (experiment_runs(s))
        go_on_with_stage(p, io);
    experiment_proposals_step(p->proposals, p->context, p->coefficients, io->requests.proposal);
    enum experiment_law_end law = experiment_law_step(p->law, p->loops, p->context, io);
    if (law != LAW_GOES_ON)
        s->event = (law == LAW_FOUND ? EVENT_LAW : EVENT_NO_LAW) + 1;
    io->requests.withdraws = !experiment_proposes(p->proposals) && !experiment_law_proposes(p->law);
    io->requests.raised = 0;
    if (s->event) {
        io->requests.raised = (uint16_t)(1u << (s->event - 1u));
        io->requests.event_value[s->event - 1u] = value_of_experiment_event(p);
        s->event = 0;
    }
}

/* A whole record has no gap: the search for the model goes on. */
void experiment_stages_gap(const struct experiment_parts *p)
{
    if (experiment_runs(p->stages) && p->stages->stage != EXPERIMENT_COMPUTES)
        abort_experiment(p, REASON_PLANT);
}

/* ---- settings and verbs ---- */

static void stop_law(const struct experiment_parts *p, const char *field, const char *wanted)
{
    if (experiment_law_stop(p->law, field, wanted))
        p->stages->event = EVENT_NO_LAW + 1;
}

void experiment_stages_settings(const struct experiment_parts *p)
{
    if (experiment_runs(p->stages))
        abort_experiment(p, REASON_SETTINGS);
}

void experiment_stages_law_settings(const struct experiment_parts *p)
{
    stop_law(p, "settings", "left as they are while the law is found");
    experiment_law_withdraw(p->law);
}

const char *experiment_stages_start(const struct experiment_parts *p)
{
    struct experiment_stages *s = p->stages;
    if (experiment_runs(s) || experiment_law_runs(p->law))
        return "runs";
    s->reason = REASON_NONE;
    s->verdict = PLANT_UNJUDGED;
    s->at_fault = 0;
    experiment_proposals_stop(p->proposals);
    experiment_record_start(p->record);
    experiment_model_clear(p->model, p->coefficients, p->context->n);
    stage_begins(p, EXPERIMENT_ASKED);
    return NULL;
}

const char *experiment_stages_stop(const struct experiment_parts *p)
{
    if (experiment_law_runs(p->law)) {
        stop_law(p, "it", "let go on to its end");
        return NULL;
    }
    if (experiment_runs(p->stages))
        abort_experiment(p, REASON_STOPPED);
    else if (!experiment_proposes(p->proposals) && !experiment_law_proposes(p->law))
        return "runs not";
    experiment_proposals_stop(p->proposals);
    experiment_law_withdraw(p->law);
    return NULL;
}

const char *experiment_stages_design(const struct experiment_parts *p)
{
    return experiment_runs(p->stages) ? "runs" : experiment_law_begin(p->law, p->context);
}

/* ---- values ---- */

enum experiment_stage experiment_stages_stage(const struct experiment_stages *s)
{
    return (enum experiment_stage)s->stage;
}

enum experiment_reason experiment_stages_reason(const struct experiment_stages *s)
{
    return (enum experiment_reason)s->reason;
}

unsigned experiment_stages_verdict(const struct experiment_stages *s)
{
    return s->verdict;
}

unsigned experiment_stages_at_fault(const struct experiment_stages *s)
{
    return s->at_fault;
}
