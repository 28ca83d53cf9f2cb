/* From a model to what blocks of the kinds `polynomial` and `rst` compute with: the decoupler, and a controller by pole placement for each loop, by
 * the code behind tools/decouple. Loop k is measurement k by MV k. In the workspace, a design in each piece of work. */
#include "adapt/plant_experiment_block.h"

#if CONFIG_EXPERIMENT

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
};

uint32_t experiment_loops_bytes(void)
{
    return sizeof(struct experiment_loops_job);
}

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
    memset(&e->law.loops, 0, sizeof e->law.loops);
    e->law.found = (struct state_law_found){.field = "", .wanted = ""};
}

/* ---- between ticks ---- */

static void refuse_loops(struct experiment *e, const char *field, const char *wanted, unsigned loop)
{
    e->law.found.field = field;
    e->law.found.wanted = wanted;
    e->law.found.loop = (uint8_t)loop;
}

/* A row of a block's settings: false: it is too long. */
static bool put_row(float row[EXPERIMENT_TAPS], const struct polynomial *p, unsigned from)
{
    for (unsigned k = from; k < p->n && k < EXPERIMENT_TAPS + from; k++)
        row[k - from] = (float)p->at[k];
    return p->n <= EXPERIMENT_TAPS + from;
}

#define TOO_LONG "of 8 coefficients at most: a longer period"

static void design_decoupler(struct experiment *e, struct experiment_loops_job *job)
{
    struct polynomial_decoupler_config config;
    struct polynomial_decoupler_refusal reason;
    struct polynomial_decoupler *d = &job->decoupler;
    bool fits = true;
    polynomial_decoupler_config_default(&config);
    if (polynomial_decoupler_design(&job->model, &config, &job->work.decoupler, d, &reason)) {
        refuse_loops(e, reason.field, reason.wanted,
                     reason.output == DECOUPLED_NONE ? 0 : reason.output + 1u);
        return;
    }
    for (unsigned k = 0; k < (unsigned)e->n * e->n; k++)
        fits &= put_row(e->law.loops.g[k], &d->g.at[k / e->n][k % e->n], 0);
    e->law.loops.limits = d->recursive ? 0 : 1; /* recurse, scale */
    if (!fits)
        refuse_loops(e, "g", TOO_LONG, 0);
}

static void design_controller(struct experiment *e, struct experiment_loops_job *job, unsigned i)
{
    struct pole_placement_goal goal;
    struct pole_placement_refusal reason;
    struct polynomial a = {.n = DIFFERENCE_A_MOST + 1, .at = {REAL_C(1.0)}};
    struct pole_placement *c = &job->placed;
    float (*to)[EXPERIMENT_TAPS] = e->law.loops.rst[i];
    pole_placement_goal_default(&goal);
    goal.overshoot = (real_t)e->s.overshoot / 100;
    goal.settling_s = (real_t)e->s.settling_s[i];
    goal.observer = (real_t)e->s.observer;
    memcpy(&a.at[1], job->model.a[i], sizeof job->model.a[i]);
    if (pole_placement_design(&a, &job->decoupler.h[i], job->model.period_s, &goal,
                              &job->work.placement, c, &reason)) {
        refuse_loops(e, reason.field, reason.wanted, i + 1u);
        return;
    }
    bool fits = put_row(to[0], &c->p, 1);
    fits &= put_row(to[1], &c->q, 0);
    fits &= put_row(to[2], &c->r, 0);
    if (!fits)
        refuse_loops(e, "p", TOO_LONG, i + 1u);
    if ((float)c->radius > e->law.found.radius)
        e->law.found.radius = (float)c->radius;
}

static bool loops_are_over(const struct experiment *e, const struct experiment_loops_job *job)
{
    return job->done > e->n || e->law.found.field[0];
}

bool experiment_loops_piece(struct experiment *e)
{
    struct experiment_loops_job *job = e->law.job;
    if (loops_are_over(e, job))
        return false;
    unsigned i = job->done++;
    if (i == 0)
        design_decoupler(e, job);
    else if (e->s.place[i - 1u])
        design_controller(e, job, i - 1u);
    return !loops_are_over(e, job);
}

bool experiment_loops_are_found(const struct experiment *e)
{
    return loops_are_over(e, e->law.job);
}

/* ---- proposals: the decoupler's values that change, then each controller whole, since its settings are not seen from here ---- */

#define GROUP_VALUES 24u

static void put_value(struct block_proposal *room, uint16_t number, uint8_t id, unsigned at,
                      float value)
{
    room->value[room->n++] = (struct proposed_value){
        proposed_in_row((uint8_t)(number - 1u), id, (uint16_t)(at / EXPERIMENT_TAPS),
                        (uint8_t)(at % EXPERIMENT_TAPS)),
        value};
}

static unsigned values_that_differ(const struct experiment *e,
                                   const struct polynomial_settings *is)
{
    unsigned n = 0;
    for (unsigned k = 0; k < (unsigned)e->n * e->n * EXPERIMENT_TAPS; k++)
        n += is->g[0][k] != e->law.loops.g[0][k] ? 1u : 0u;
    return n;
}
