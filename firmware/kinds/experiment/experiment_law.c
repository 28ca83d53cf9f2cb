#include "kinds/experiment/experiment_law.h"

#include <string.h>

#include "base/assertion.h"
#include "kinds/experiment/experiment_law_state.h"
#include "kinds/experiment/experiment_lease.h"
#include "kinds/experiment/experiment_loops.h"
#include "law/state_law_job.h"
#include "law/state_law_job_state.h"
#include "law/state_law_proposal.h"

/* Steps that the job gets: two states are a millisecond. */
#define STEPS 2u

/* A plant of one loop needs no decoupler. */
static bool is_of_loops(const struct experiment_context *c)
{
    return c->decoupler || (c->n == 1 && !c->s.law && c->s.place[0]);
}

bool experiment_law_runs(const struct experiment_law *l)
{
    return l->stage == EXPERIMENT_LAW_ASKED || l->stage == EXPERIMENT_LAW_WORKS;
}

/* Ends it with what was found, which refuses a setting. */
static void end_refused_design(struct experiment_law *l)
{
    state_law_words(&l->found, l->words, sizeof l->words);
    experiment_lease_end(&l->lease);
    l->stage = EXPERIMENT_LAW_REFUSED;
}

static void refuse_design(struct experiment_law *l, const char *field, const char *wanted,
                          unsigned loop)
{
    l->found = (struct state_law_found){
        .field = field, .wanted = wanted, .loop = (uint8_t)loop, .radius = 0};
    end_refused_design(l);
}

bool experiment_law_stop(struct experiment_law *l, const char *field, const char *wanted)
{
    if (!experiment_law_runs(l))
        return false;
    refuse_design(l, field, wanted, 0);
    return true;
}

const char *experiment_law_begin(struct experiment_law *l, const struct experiment_context *c)
{
    if (experiment_law_runs(l))
        return "designs";
    if (!c->law && !is_of_loops(c))
        return "law"; /* it names nobody */
    if (!c->s.known || c->n > EXPERIMENT_KEPT)
        return "no_model";
    l->words[0] = '\0';
    l->proposes = false;
    l->stage = EXPERIMENT_LAW_ASKED;
    return NULL;
}

/* ---- values ---- */

bool experiment_law_proposes(const struct experiment_law *l)
{
    return l->proposes;
}

void experiment_law_withdraw(struct experiment_law *l)
{
    l->proposes = false;
}

float experiment_law_radius(const struct experiment_law *l)
{
    return l->found.radius;
}

float experiment_law_loop(const struct experiment_law *l)
{
    return l->found.loop;
}

const char *experiment_law_words(const struct experiment_law *l)
{
    return l->stage == EXPERIMENT_LAW_REFUSED ? l->words : NULL;
}

/* ---- the model ---- */

static bool is_first_order(const struct experiment_context *c, unsigned i)
{
    REFLUX_ASSERT(i < EXPERIMENT_KEPT && c->n <= EXPERIMENT_KEPT);
    bool more = false;
    for (unsigned k = 1; k < DIFFERENCE_A_MOST; k++)
        more = more || c->s.a[i][k] < 0 || c->s.a[i][k] > 0;
    for (unsigned j = 0; j < c->n; j++)
        for (unsigned k = 1; k < DIFFERENCE_B_MOST; k++)
            more = more || c->s.b[i][j][k] < 0 || c->s.b[i][j][k] > 0;
    return !more;
}

static bool is_period_of(const struct experiment_context *c, float period_s)
{
    float own = (float)c->ticks * c->step_s, off = period_s - own;
    return off <= 1e-3f * own && off >= -1e-3f * own;
}

/* Puts the model, of fractions of span. */
static void put_plant(const struct experiment_context *c, struct state_model *plant)
{
    memset(plant, 0, sizeof *plant);
    plant->period_s = c->law->period_s;
    plant->a.rows = plant->a.cols = plant->b.rows = plant->b.cols = c->n;
    plant->c.rows = plant->c.cols = plant->e.rows = c->n;
    for (unsigned i = 0; i < c->n; i++) {
        plant->a.value[i][i] = -(real_t)c->s.a[i][0];
        plant->c.value[i][i] = REAL_C(1.0);
        for (unsigned j = 0; j < c->n; j++) {
            float u = experiment_span(c, c->n + j), y = experiment_span(c, i);
            plant->b.value[i][j] = (real_t)(c->s.b[i][j][0] * u / y);
        }
    }
}

static void put_order_of_law(struct experiment_law *l, const struct experiment_context *c)
{
    REFLUX_ASSERT(experiment_leased(&l->lease));
    struct state_law_job *job = experiment_leased(&l->lease);
    if (!is_period_of(c, c->law->period_s)) {
        refuse_design(l, "period", "that of the experiment in the block with the law", 0);
        return;
    }
    for (unsigned i = 0; i < c->n; i++)
        if (!is_first_order(c, i)) {
            refuse_design(
                l, "the model",
                "of first order without dead time (na 1, nb 1): its outputs are then its states",
                i + 1u);
            return;
        }
    memcpy(l->goal, c->law, sizeof l->goal);
    state_law_job_of_model(job, c->law, c->n);
    put_plant(c, state_law_job_sampled(job));
    l->stage = EXPERIMENT_LAW_WORKS;
}

static void put_order_of_loops(struct experiment_law *l, const struct experiment_context *c)
{
    if (c->s.cutoff > 0 && c->ticks > 1) {
        refuse_design(l, "cutoff", "0, and the model found anew: the loops have no filter", 0);
        return;
    }
    experiment_loops_begin(experiment_leased(&l->lease), c);
    l->stage = EXPERIMENT_LAW_WORKS;
}

/* ---- between ticks ---- */

bool experiment_law_work(struct experiment_law *l, const struct experiment_context *c)
{
    void *job = experiment_leased(&l->lease);
    bool of_loops = is_of_loops(c);
    if (l->stage == EXPERIMENT_LAW_ASKED && !job)
        experiment_lease_hold(
            &l->lease, experiment_lease_ask(&l->lease, of_loops ? experiment_loops_bytes
                                                                : sizeof(struct state_law_job)));
    if (l->stage != EXPERIMENT_LAW_WORKS || !job)
        return false;
    if (!of_loops)
        return state_law_job_piece(job);
    experiment_loops_piece(job, c);
    return false; /* the next step asks for the next one */
}

/* ---- in the tick ---- */

static bool law_is_found(const struct experiment_law *l, const struct experiment_context *c)
{
    const void *job = experiment_leased(&l->lease);
    if (l->stage != EXPERIMENT_LAW_WORKS || !job)
        return false;
    return is_of_loops(c) ? experiment_loops_are_found(job, c) : state_law_job_is_over(job);
}

static void take_found_law(struct experiment_law *l, struct experiment_loops *loops,
                           const struct experiment_context *c)
{
    const void *job = experiment_leased(&l->lease);
    if (is_of_loops(c)) {
        experiment_loops_take(loops, job, &l->found);
    } else {
        l->found = *state_law_job_found(job);
        if (!c->law || memcmp(l->goal, c->law, sizeof l->goal) != 0) {
            refuse_design(l, "settings", "left as they are while the law is found", 0);
            return;
        }
    }
    if (l->found.field[0]) {
        end_refused_design(l);
        return;
    }
    experiment_lease_end(&l->lease);
    l->stage = EXPERIMENT_LAW_DONE;
    l->proposes = true;
    l->waits = false;
}

static void propose_law(struct experiment_law *l, const struct experiment_context *c,
                        struct block_proposal *room)
{
    if (!room || room->n || !c->law)
        return;
    if (!l->waits)
        state_law_put_values(c->law, &l->found, c->law->period_s, c->n, (uint8_t)(c->s.law - 1u),
                             room);
    l->proposes = l->waits = room->n > 0; /* else it is in force, or refused, or rejected */
    room->manner = c->law->adopt == STATE_LAW_AT_ONCE ? PROPOSAL_AT_ONCE : PROPOSAL_WHEN_ACCEPTED;
}

static void go_on_with_law(struct experiment_law *l, struct experiment_loops *loops,
                           const struct experiment_context *c, struct block_io *io)
{
    bool asked = l->stage == EXPERIMENT_LAW_ASKED, of_loops = is_of_loops(c);
    bool leased = experiment_leased(&l->lease) != NULL;
    if (asked && !c->law && !of_loops)
        refuse_design(l, "law", "the number of the block that keeps it", 0);
    else if (asked && leased && of_loops)
        put_order_of_loops(l, c);
    else if (asked && leased)
        put_order_of_law(l, c);
    else if (asked && io->requests.work_done)
        refuse_design(l, "the workspace", "free", 0);
    else if (law_is_found(l, c))
        take_found_law(l, loops, c);
    if (experiment_law_runs(l))
        io->requests.ask_work = STEPS;
}

enum experiment_law_end experiment_law_step(struct experiment_law *l,
                                            struct experiment_loops *loops,
                                            const struct experiment_context *c, struct block_io *io)
{
    bool ran = experiment_law_runs(l), lost = !experiment_lease_renew(&l->lease);
    if (!ran)
        experiment_lease_end(&l->lease);
    else if (lost)
        refuse_design(l, "the workspace", "free", 0);
    else if (!io->requests.work_wanted)
        go_on_with_law(l, loops, c, io);
    bool ended = ran && !experiment_law_runs(l), refused = l->stage == EXPERIMENT_LAW_REFUSED;
    if (l->proposes && is_of_loops(c))
        l->proposes = experiment_loops_propose(loops, c, io->requests.proposal);
    else if (l->proposes)
        propose_law(l, c, io->requests.proposal);
    return !ended ? LAW_GOES_ON : refused ? LAW_REFUSED : LAW_FOUND;
}
