/* `design`: from the model that is kept to what other blocks compute with: a decoupler and controllers for its loops
 * (plant_experiment_loops.c), or the law of state feedback that a block of the kind `state_law` keeps. For that law, of a model of first order
 * without dead time, A y(k) = B u(k), the outputs are all there is to its state:
 *
 *     y(k + 1) = -diag(a) y(k) + B u(k)
 *
 * so F and G are for the measurements themselves. Of higher orders states would be samples of the past, which no measurement is: refused. */
#include "kinds/experiment/plant_experiment_block.h"

#include <string.h>

#include "base/workspace.h"

#define HOLDER "experiment"
#define FREES  "block N stop"
#define STEPS  2u /* for the job: two states are a millisecond */

/* A plant of one loop needs no decoupler. */
static bool is_of_loops(const struct experiment *e)
{
    return e->law.decoupler || (e->n == 1 && !e->s.law && e->s.place[0]);
}

bool experiment_law_runs(const struct experiment *e)
{
    return e->law.stage == EXPERIMENT_LAW_ASKED || e->law.stage == EXPERIMENT_LAW_WORKS;
}

static void end_lease_of_law(struct experiment *e)
{
    if (e->law.job)
        workspace_end(workspace_shared(), e->law.lease);
    e->law.job = NULL;
}

static void law_ends(struct experiment *e, const char *field, const char *wanted, unsigned loop)
{
    if (field)
        e->law.found = (struct state_law_found){
            .field = field, .wanted = wanted, .loop = (uint8_t)loop, .radius = 0};
    state_law_words(&e->law.found, e->law.words, sizeof e->law.words);
    end_lease_of_law(e);
    e->law.stage = EXPERIMENT_LAW_REFUSED;
    e->tells = EVENT_NO_LAW + 1;
}

void experiment_law_stop(struct experiment *e, const char *field, const char *wanted)
{
    if (experiment_law_runs(e))
        law_ends(e, field, wanted, 0);
}

const char *experiment_law_begin(struct experiment *e)
{
    if (experiment_law_runs(e))
        return "designs";
    if (!e->law.to && !is_of_loops(e))
        return "law"; /* it names nobody */
    if (!e->s.known || e->n > EXPERIMENT_KEPT)
        return "no_model";
    e->law.words[0] = '\0';
    e->law.proposes = false;
    e->law.stage = EXPERIMENT_LAW_ASKED;
    return NULL;
}

/* ---- the model ---- */

static bool is_first_order(const struct experiment *e, unsigned i)
{
    bool more = false;
    for (unsigned k = 1; k < DIFFERENCE_A_MOST; k++)
        more = more || e->s.a[i][k] < 0 || e->s.a[i][k] > 0;
    for (unsigned j = 0; j < e->n; j++)
        for (unsigned k = 1; k < DIFFERENCE_B_MOST; k++)
            more = more || e->s.b[i][j][k] < 0 || e->s.b[i][j][k] > 0;
    return !more;
}

static bool is_period_of(const struct experiment *e, float period_s)
{
    float own = (float)e->ticks * e->step_s, off = period_s - own;
    return off <= 1e-3f * own && off >= -1e-3f * own;
}

/* Of fractions of span. */
static void put_plant(const struct experiment *e, struct state_model *plant)
{
    memset(plant, 0, sizeof *plant);
    plant->period_s = e->law.to->period_s;
    plant->a.rows = plant->a.cols = plant->b.rows = plant->b.cols = e->n;
    plant->c.rows = plant->c.cols = plant->e.rows = e->n;
    for (unsigned i = 0; i < e->n; i++) {
        const struct block_signal *y = &e->input[i];
        plant->a.at[i][i] = -(real_t)e->s.a[i][0];
        plant->c.at[i][i] = REAL_C(1.0);
        for (unsigned j = 0; j < e->n; j++) {
            const struct block_signal *u = &e->input[e->n + j];
            plant->b.at[i][j] = (real_t)(e->s.b[i][j][0] * (u->hi - u->lo) / (y->hi - y->lo));
        }
    }
}

static void put_order_of_law(struct experiment *e)
{
    if (!is_period_of(e, e->law.to->period_s)) {
        law_ends(e, "period", "that of the experiment in the block with the law", 0);
        return;
    }
    for (unsigned i = 0; i < e->n; i++)
        if (!is_first_order(e, i)) {
            law_ends(
                e, "the model",
                "of first order without dead time (na 1, nb 1): its outputs are then its states",
                i + 1u);
            return;
        }
    struct state_law_job *job = e->law.job;
    memcpy(e->law.goal, e->law.to, sizeof e->law.goal);
    state_law_job_of_model(job, e->law.to, e->n);
    put_plant(e, &job->sampled);
    e->law.stage = EXPERIMENT_LAW_WORKS;
}

static void put_order_of_loops(struct experiment *e)
{
    if (e->s.cutoff > 0 && e->ticks > 1) {
        law_ends(e, "cutoff", "0, and the model found anew: the loops have no filter", 0);
        return;
    }
    experiment_loops_begin(e);
    e->law.stage = EXPERIMENT_LAW_WORKS;
}

/* ---- between ticks ---- */

bool experiment_law_work(struct experiment *e)
{
    struct workspace *w = workspace_shared();
    void *memory = NULL;
    uint32_t bytes = is_of_loops(e) ? experiment_loops_bytes : sizeof(struct state_law_job);
    if (e->law.stage == EXPERIMENT_LAW_ASKED && !e->law.job && w &&
        workspace_lease_for_now(w, HOLDER, FREES, bytes, &e->law.lease, &memory) == ERR_OK)
        e->law.job = memory;
    if (e->law.stage != EXPERIMENT_LAW_WORKS || !e->law.job)
        return false;
    if (!is_of_loops(e))
        return state_law_job_piece(e->law.job);
    experiment_loops_piece(e);
    return false; /* the next step asks for the next one */
}

/* ---- in the tick ---- */

static void take_found_law(struct experiment *e)
{
    const struct state_law_job *job = e->law.job;
    if (is_of_loops(e))
        experiment_loops_take(e);
    else
        e->law.found = job->found;
    /* It stands elsewhere after every apply. */
    if (!is_of_loops(e) &&
        (!e->law.to || memcmp(e->law.goal, e->law.to, sizeof e->law.goal) != 0)) {
        law_ends(e, "settings", "left as they are while the law is found", 0);
        return;
    }
    if (e->law.found.field[0]) {
        law_ends(e, NULL, NULL, 0);
        return;
    }
    end_lease_of_law(e);
    e->law.stage = EXPERIMENT_LAW_DONE;
    e->tells = EVENT_LAW + 1;
    e->law.proposes = true;
    e->law.waits = false;
}

static void propose_law(struct experiment *e, struct block_proposal *room)
{
    if (!e->law.proposes || !room || room->n || !e->law.to)
        return;
    if (!e->law.waits)
        state_law_put_values(e->law.to, &e->law.found, e->law.to->period_s, e->n,
                             (uint8_t)(e->s.law - 1u), room);
    e->law.proposes = e->law.waits = room->n > 0; /* else it is in force, or refused, or rejected */
    room->manner =
        e->law.to->adopt == STATE_LAW_AT_ONCE ? PROPOSAL_AT_ONCE : PROPOSAL_WHEN_ACCEPTED;
}

static bool law_is_found(const struct experiment *e)
{
    const struct state_law_job *job = e->law.job;
    return e->law.stage == EXPERIMENT_LAW_WORKS && job &&
           (is_of_loops(e) ? experiment_loops_are_found(e) : job->phase == STATE_LAW_PHASE_OVER);
}

void experiment_law_step(struct experiment *e, struct block_io *io)
{
    bool lost = e->law.job && !workspace_renew(workspace_shared(), e->law.lease);
    if (lost)
        e->law.job = NULL;
    if (!experiment_law_runs(e)) {
        end_lease_of_law(e);
    } else if (lost) {
        law_ends(e, "the workspace", "free", 0);
    } else if (!io->work_wanted) {
        if (e->law.stage == EXPERIMENT_LAW_ASKED && !e->law.to && !is_of_loops(e))
            law_ends(e, "law", "the number of the block that keeps it", 0);
        else if (e->law.stage == EXPERIMENT_LAW_ASKED && e->law.job && is_of_loops(e))
            put_order_of_loops(e);
        else if (e->law.stage == EXPERIMENT_LAW_ASKED && e->law.job)
            put_order_of_law(e);
        else if (e->law.stage == EXPERIMENT_LAW_ASKED && io->work_done)
            law_ends(e, "the workspace", "free", 0);
        else if (law_is_found(e))
            take_found_law(e);
        if (experiment_law_runs(e))
            io->ask_work = STEPS;
    }
    if (is_of_loops(e))
        experiment_loops_propose(e, io->proposal);
    else
        propose_law(e, io->proposal);
}
