/* From a model to what blocks of the kinds `polynomial` and `rst` compute with: the decoupler, and a controller by pole placement for each
 * loop, by the code behind tools/decouple. Loop k is measurement k by MV k. In the workspace, one design in each piece of work. */
#include "kinds/experiment/plant_experiment_block.h"

#include <string.h>

#include "design/pole_placement.h"
#include "design/polynomial_decoupler.h"

struct experiment_loops_job {
    struct difference_model model;
    struct polynomial_decoupler decoupler;
    struct pole_placement placed;
    union {
        struct polynomial_decoupler_work decoupler;
        struct pole_placement_work placement;
    } work;
    uint8_t done; /* designs */
    /* What comes of it. */
    struct experiment_loops loops;
    struct state_law_found found; /* radius, or what is refused */
};

const uint32_t experiment_loops_bytes = sizeof(struct experiment_loops_job);

/* The model that is kept, of fractions of span. */
void experiment_loops_begin(struct experiment *e)
{
    struct experiment_loops_job *job = e->law.job;
    struct difference_model *m = &job->model;
    memset(job, 0, sizeof *job);
    m->outputs = m->inputs = e->n;
    m->na = DIFFERENCE_A_MOST;
    m->nb = DIFFERENCE_B_MOST;
    m->period_s = (real_t)e->ticks * (real_t)e->step_s;
    for (unsigned i = 0; i < e->n; i++) {
        memcpy(m->a[i], e->s.a[i], sizeof e->s.a[i]);
        for (unsigned j = 0; j < e->n; j++) {
            const struct block_signal *y = &e->input[i], *u = &e->input[e->n + j];
            for (unsigned k = 0; k < DIFFERENCE_B_MOST; k++)
                m->b[i][j][k] = (real_t)(e->s.b[i][j][k] * (u->hi - u->lo) / (y->hi - y->lo));
        }
    }
    job->loops.period_s = (float)m->period_s;
    job->found.field = job->found.wanted = "";
}

/* ---- between ticks ---- */

static void refuse_loops(struct experiment_loops_job *job, const char *field, const char *wanted,
                         unsigned loop)
{
    job->found.field = field;
    job->found.wanted = wanted;
    job->found.loop = (uint8_t)loop;
}

/* Fills a row of a block's settings; false: it is too long. */
static bool put_row(float row[POLYNOMIAL_TAPS], const struct polynomial *p, unsigned from)
{
    for (unsigned k = from; k < p->n && k < POLYNOMIAL_TAPS + from; k++)
        row[k - from] = (float)p->at[k];
    return p->n <= POLYNOMIAL_TAPS + from;
}

#define TOO_LONG "of 8 coefficients at most: a longer period"

static void design_decoupler(const struct experiment *e, struct experiment_loops_job *job)
{
    struct polynomial_decoupler_config config;
    struct polynomial_decoupler_refusal reason;
    struct polynomial_decoupler *d = &job->decoupler;
    bool fits = true;
    polynomial_decoupler_config_default(&config);
    if (polynomial_decoupler_design(&job->model, &config, &job->work.decoupler, d, &reason)) {
        refuse_loops(job, reason.field, reason.wanted,
                     reason.output == DECOUPLED_NONE ? 0 : reason.output + 1u);
        return;
    }
    for (unsigned k = 0; k < (unsigned)e->n * e->n; k++)
        fits &= put_row(job->loops.g[k], &d->g.at[k / e->n][k % e->n], 0);
    job->loops.limits = d->recursive ? POLYNOMIAL_RECURSE : POLYNOMIAL_SCALE;
    if (!fits)
        refuse_loops(job, "g", TOO_LONG, 0);
}

static void design_controller(const struct experiment *e, struct experiment_loops_job *job,
                              unsigned i)
{
    struct pole_placement_goal goal;
    struct pole_placement_refusal reason;
    struct polynomial a = {.n = DIFFERENCE_A_MOST + 1, .at = {REAL_C(1.0)}};
    struct pole_placement *c = &job->placed;
    float(*to)[POLYNOMIAL_TAPS] = job->loops.rst[i];
    pole_placement_goal_default(&goal);
    goal.overshoot = (real_t)e->s.overshoot / 100;
    goal.settling_s = (real_t)e->s.settling_s[i];
    goal.observer = (real_t)e->s.observer;
    memcpy(&a.at[1], job->model.a[i], sizeof job->model.a[i]);
    if (pole_placement_design(&a, &job->decoupler.h[i], job->model.period_s, &goal,
                              &job->work.placement, c, &reason)) {
        refuse_loops(job, reason.field, reason.wanted, i + 1u);
        return;
    }
    bool fits = put_row(to[0], &c->p, 1);
    fits &= put_row(to[1], &c->q, 0);
    fits &= put_row(to[2], &c->r, 0);
    if (!fits)
        refuse_loops(job, "p", TOO_LONG, i + 1u);
    if ((float)c->radius > job->found.radius)
        job->found.radius = (float)c->radius;
}

bool experiment_loops_are_found(const struct experiment *e)
{
    const struct experiment_loops_job *job = e->law.job;
    return job->done > e->n || job->found.field[0];
}

void experiment_loops_piece(struct experiment *e)
{
    struct experiment_loops_job *job = e->law.job;
    unsigned i = job->done++;
    if (i == 0)
        design_decoupler(e, job);
    else if (e->s.place[i - 1u])
        design_controller(e, job, i - 1u);
}

void experiment_loops_take(struct experiment *e)
{
    const struct experiment_loops_job *job = e->law.job;
    e->law.loops = job->loops;
    e->law.found = job->found;
}

/* ---- proposals: of the decoupler the values that change, then each controller whole, whose settings are not seen from here ---- */

static void put_coefficient(struct block_proposal *room, uint16_t number, uint8_t id, unsigned at,
                            float value)
{
    room->value[room->n++] = (struct proposed_value){
        proposed_in_row((uint8_t)(number - 1u), id, (uint16_t)(at / POLYNOMIAL_TAPS),
                        (uint8_t)(at % POLYNOMIAL_TAPS)),
        value};
}

/* Puts the values that differ, as far as there is room. Where some are left the decoupler is incomplete until they follow, because
 * somebody may save, cut the power or take the last part back in between. Returns how many values differ. */
static unsigned put_decoupler(const struct experiment *e, struct block_proposal *room)
{
    const struct polynomial_settings *is = e->law.decoupler;
    const struct experiment_loops *to = &e->law.loops;
    unsigned left = 0;
    for (unsigned k = 0; k < (unsigned)e->n * e->n * POLYNOMIAL_TAPS; k++) {
        float wanted = to->g[k / POLYNOMIAL_TAPS][k % POLYNOMIAL_TAPS];
        if (is->g[k / POLYNOMIAL_TAPS][k % POLYNOMIAL_TAPS] != wanted &&
            ++left <= PROPOSAL_MAX - 2u)
            put_coefficient(room, e->s.law, POLYNOMIAL_ID_G, k, wanted);
    }
    uint8_t limits = left > PROPOSAL_MAX - 2u ? (uint8_t)POLYNOMIAL_INCOMPLETE : to->limits;
    if (is->period_s != to->period_s)
        put_coefficient(room, e->s.law, POLYNOMIAL_ID_PERIOD, 0, to->period_s);
    if (is->limits != limits)
        put_coefficient(room, e->s.law, POLYNOMIAL_ID_LIMITS, 0, limits);
    return left > room->n ? left : room->n;
}

/* All that the design can have: R is shorter than its row. */
static void put_controller(const struct experiment *e, unsigned i, struct block_proposal *room)
{
    put_coefficient(room, e->s.place[i], RST_ID_PERIOD, 0, e->law.loops.period_s);
    for (unsigned id = RST_ID_P; id <= RST_ID_R; id++)
        for (unsigned k = 0; k < RST_COEFFICIENTS && room->n < PROPOSAL_MAX; k++)
            put_coefficient(room, e->s.place[i], (uint8_t)id, k,
                            e->law.loops.rst[i][id - RST_ID_P][k]);
}
_Static_assert(1 + 3 * RST_COEFFICIENTS - 1 == PROPOSAL_MAX &&
                   DIFFERENCE_A_MOST + 1 < RST_COEFFICIENTS,
               "a controller is one proposal");

/* Returns whether the decoupler's turn is over: all of it is in force. What is left when a part was accepted follows at once. */
static bool decoupler_is_over(struct experiment *e, struct block_proposal *room)
{
    struct experiment_law *law = &e->law;
    if (!law->decoupler || law->loops.part > 0)
        return true;
    unsigned left = put_decoupler(e, room);
    if (law->waits && left >= law->loops.left) { /* it was refused, or rejected */
        room->n = 0;
        law->proposes = false;
    }
    if (law->waits && left > 0)
        room->manner = PROPOSAL_AT_ONCE;
    law->waits = left > 0;
    law->loops.left = (uint8_t)left;
    return left == 0;
}

/* Each is handed over when the one before is gone. */
void experiment_loops_propose(struct experiment *e, struct block_proposal *room)
{
    struct experiment_law *law = &e->law;
    if (!law->proposes || !room)
        return;
    room->manner =
        e->s.adopt == EXPERIMENT_ADOPT_AT_ONCE ? PROPOSAL_AT_ONCE : PROPOSAL_WHEN_ACCEPTED;
    if (!decoupler_is_over(e, room))
        return;
    while (law->loops.part < e->n && !e->s.place[law->loops.part])
        law->loops.part++;
    law->proposes = law->loops.part < e->n;
    if (law->proposes)
        put_controller(e, law->loops.part++, room);
}
