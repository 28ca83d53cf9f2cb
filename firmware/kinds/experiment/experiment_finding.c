/* What the experiment does between ticks: gets the workspace, and finds the model from the record. */
#include "kinds/experiment/plant_experiment_block.h"

#include "base/workspace.h"

#define HOLDER "experiment"
#define FREES  "block N stop"

#define ROWS_A_PIECE 8u
/* Where loops have made more than this part of what an MV did, instruments depend on noise. */
#define OTHERS_MOST REAL_C(0.25)

void experiment_end_lease(struct experiment *e)
{
    if (e->job)
        workspace_end(workspace_shared(), e->lease);
    e->job = NULL;
}

/* The workspace, or a stage without: the next step sees which. */
static void lease_for_record(struct experiment *e)
{
    struct workspace *w = workspace_shared();
    void *memory = NULL;
    uint32_t bytes = experiment_job_bytes(e->n, e->wanted);
    if (!w || workspace_lease_for_now(w, HOLDER, FREES, bytes, &e->lease, &memory) != ERR_OK)
        return;
    experiment_record_begin(e, memory);
    e->job = memory;
}

/* Samples that the plant has to settle in. */
static uint32_t memory_of_sequence(const struct experiment *e)
{
    return prbs_memory(&(struct prbs_settings){.inputs = e->n,
                                               .bits = (uint8_t)e->s.bits,
                                               .independence = PRBS_SHIFTS,
                                               .clock = e->s.clock});
}

static void begin_finding(const struct experiment *e, struct experiment_job *job)
{
    const struct arx_data data = {
        .samples = e->wanted, .outputs = e->n, .inputs = e->n, .u = job->u, .y = job->y};
    const struct plant_wanted wanted = {.method = e->s.method,
                                        .criterion = e->s.criterion,
                                        .na = (uint8_t)e->s.na,
                                        .nb = (uint8_t)e->s.nb,
                                        .fit = e->s.fit / 100,
                                        .memory = memory_of_sequence(e)};
    plant_finding_begin(&job->finding, &data, &wanted);
    job->begun = true;
}

bool experiment_work(void *state)
{
    struct experiment *e = state;
    struct experiment_job *job = e->job;
    if (experiment_law_runs(e))
        return experiment_law_work(e);
    if (e->stage == EXPERIMENT_ASKED && !job)
        lease_for_record(e);
    if (e->stage != EXPERIMENT_COMPUTES || !job || job->over)
        return false;
    if (!job->begun) {
        begin_finding(e, job);
    } else if (!plant_finding_piece(&job->finding, ROWS_A_PIECE)) {
        job->over = true;
        return false;
    }
    return --e->pieces > 0;
}

/* ---- the result ---- */

static void take_output(struct experiment *e, unsigned i)
{
    const struct plant_output *from = &e->job->finding.found[i];
    struct experiment_found *to = &e->found[i];
    to->na = from->na;
    to->nb = from->nb;
    to->verdict = from->verdict;
    to->one_step = (float)(100 * from->one_step);
    to->fit = (float)(100 * from->fit);
    to->apart = (float)(100 * from->apart);
    for (unsigned k = 0; k < DIFFERENCE_A_MOST; k++)
        experiment_a(e, i)[k] = (float)from->a[k];
    for (unsigned j = 0; j < e->n; j++) {
        const struct block_signal *y = &e->input[i], *u = &e->input[e->n + j];
        for (unsigned k = 0; k < DIFFERENCE_B_MOST; k++)
            experiment_b(e, i, j)[k] = (float)from->b[j][k] * (y->hi - y->lo) / (u->hi - u->lo);
    }
    if (to->verdict > e->verdict) {
        e->verdict = to->verdict;
        e->at_fault = to->verdict == PLANT_USABLE ? 0 : (uint8_t)(i + 1u);
    }
}

void experiment_take_model(struct experiment *e)
{
    e->verdict = PLANT_UNJUDGED;
    for (unsigned i = 0; i < e->n; i++)
        take_output(e, i);
    for (unsigned j = 0; j < e->n && e->verdict == PLANT_USABLE; j++)
        if (e->s.method == ARX_IV && experiment_others(e, j) > OTHERS_MOST) {
            e->verdict = VERDICT_LOOPS;
            e->at_fault = (uint8_t)(e->n + j + 1u);
        }
}
