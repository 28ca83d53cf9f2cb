#include "kinds/experiment/experiment_loops.h"

#include <string.h>

#include "base/assertion.h"
#include "design/pole_placement.h"
#include "design/polynomial_decoupler.h"
#include "kinds/experiment/experiment_loops_state.h"
#include "law/state_law_found.h"

struct experiment_loops_job {
    struct difference_model model;
    struct polynomial_decoupler decoupler;
    struct pole_placement placed;
    union {
        struct polynomial_decoupler_work decoupler;
        struct pole_placement_work placement;
    } work;
    /* Designs that are done. */
    uint8_t done;
    struct experiment_loops loops;
    /* Radius, or what is refused. */
    struct state_law_found found;
};

const uint32_t experiment_loops_bytes = sizeof(struct experiment_loops_job);

/* Puts the model that is kept, of fractions of span. */
void experiment_loops_begin(struct experiment_loops_job *job, const struct experiment_context *c)
{
    struct difference_model *m = &job->model;
    memset(job, 0, sizeof *job);
    m->outputs = m->inputs = c->n;
    m->na = DIFFERENCE_A_MOST;
    m->nb = DIFFERENCE_B_MOST;
    m->period_s = (real_t)c->ticks * (real_t)c->step_s;
    for (unsigned i = 0; i < c->n; i++) {
        memcpy(m->a[i], c->s.a[i], sizeof c->s.a[i]);
        for (unsigned j = 0; j < c->n; j++) {
            float u = experiment_span(c, c->n + j), y = experiment_span(c, i);
            for (unsigned k = 0; k < DIFFERENCE_B_MOST; k++)
                m->b[i][j][k] = (real_t)(c->s.b[i][j][k] * u / y);
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

/* Fills a row of a block's settings. False: the polynomial is too long. */
static bool put_row(float row[POLYNOMIAL_TAPS], const struct polynomial *p, unsigned from)
{
    for (unsigned k = from; k < p->n && k < POLYNOMIAL_TAPS + from; k++)
        row[k - from] = (float)p->value[k];
    return p->n <= POLYNOMIAL_TAPS + from;
}

#define TOO_LONG "of 8 coefficients at most: a longer period"

static void design_decoupler(struct experiment_loops_job *job, const struct experiment_context *c)
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
    for (unsigned k = 0; k < (unsigned)c->n * c->n; k++)
        fits &= put_row(job->loops.g[k], &d->g.value[k / c->n][k % c->n], 0);
    job->loops.limits = d->recursive ? POLYNOMIAL_RECURSE : POLYNOMIAL_SCALE;
    if (!fits)
        refuse_loops(job, "g", TOO_LONG, 0);
}

static void design_controller(struct experiment_loops_job *job, const struct experiment_context *c,
                              unsigned i)
{
    REFLUX_ASSERT(i < EXPERIMENT_KEPT && i < c->n);
    struct pole_placement_goal goal;
    struct pole_placement_refusal reason;
    struct polynomial a = {.n = DIFFERENCE_A_MOST + 1, .value = {REAL_C(1.0)}};
    struct pole_placement *placed = &job->placed;
    float(*to)[POLYNOMIAL_TAPS] = job->loops.rst[i];
    pole_placement_goal_default(&goal);
    goal.overshoot = (real_t)c->s.overshoot / 100;
    goal.settling_s = (real_t)c->s.settling_s[i];
    goal.observer = (real_t)c->s.observer;
    memcpy(&a.value[1], job->model.a[i], sizeof job->model.a[i]);
    if (pole_placement_design(&a, &job->decoupler.h[i], job->model.period_s, &goal,
                              &job->work.placement, placed, &reason)) {
        refuse_loops(job, reason.field, reason.wanted, i + 1u);
        return;
    }
    bool fits = put_row(to[0], &placed->p, 1);
    fits &= put_row(to[1], &placed->q, 0);
    fits &= put_row(to[2], &placed->r, 0);
    if (!fits)
        refuse_loops(job, "p", TOO_LONG, i + 1u);
    if ((float)placed->radius > job->found.radius)
        job->found.radius = (float)placed->radius;
}

bool experiment_loops_are_found(const struct experiment_loops_job *job,
                                const struct experiment_context *c)
{
    return job->done > c->n || job->found.field[0];
}

void experiment_loops_piece(struct experiment_loops_job *job, const struct experiment_context *c)
{
    unsigned i = job->done++;
    if (i == 0)
        design_decoupler(job, c);
    else if (c->s.place[i - 1u])
        design_controller(job, c, i - 1u);
}

void experiment_loops_take(struct experiment_loops *l, const struct experiment_loops_job *job,
                           struct state_law_found *found)
{
    *l = job->loops;
    *found = job->found;
}

/* ---- proposals: of the decoupler the values that change, then each controller whole, because its settings are not known here ---- */

static void put_coefficient(struct block_proposal *room, uint16_t number, uint8_t id, unsigned at,
                            float value)
{
    REFLUX_ASSERT(number >= 1 && room->n < PROPOSAL_MAX);
    room->value[room->n++] = (struct proposed_value){
        proposed_in_row((uint8_t)(number - 1u), id, (uint16_t)(at / POLYNOMIAL_TAPS),
                        (uint8_t)(at % POLYNOMIAL_TAPS)),
        value};
}

/* Puts the values that differ, as far as there is room. Where some are left the decoupler is incomplete until they follow, because
 * somebody may save, cut the power or take the last part back in between. Returns how many values differ. */
static unsigned put_decoupler(const struct experiment_loops *to, const struct experiment_context *c,
                              struct block_proposal *room)
{
    const struct polynomial_settings *actual = c->decoupler;
    unsigned left = 0;
    for (unsigned k = 0; k < (unsigned)c->n * c->n * POLYNOMIAL_TAPS; k++) {
        float wanted = to->g[k / POLYNOMIAL_TAPS][k % POLYNOMIAL_TAPS];
        if (actual->g[k / POLYNOMIAL_TAPS][k % POLYNOMIAL_TAPS] != wanted &&
            ++left <= PROPOSAL_MAX - 2u)
            put_coefficient(room, c->s.law, POLYNOMIAL_ID_G, k, wanted);
    }
    uint8_t limits = left > PROPOSAL_MAX - 2u ? (uint8_t)POLYNOMIAL_INCOMPLETE : to->limits;
    if (actual->period_s != to->period_s)
        put_coefficient(room, c->s.law, POLYNOMIAL_ID_PERIOD, 0, to->period_s);
    if (actual->limits != limits)
        put_coefficient(room, c->s.law, POLYNOMIAL_ID_LIMITS, 0, limits);
    return left > room->n ? left : room->n;
}

/* Puts all that the design can have: R is shorter than its row. */
static void put_controller(const struct experiment_loops *l, const struct experiment_context *c,
                           unsigned i, struct block_proposal *room)
{
    REFLUX_ASSERT(i < EXPERIMENT_KEPT && i < c->n);
    put_coefficient(room, c->s.place[i], RST_ID_PERIOD, 0, l->period_s);
    for (unsigned id = RST_ID_P; id <= RST_ID_R; id++)
        for (unsigned k = 0; k < RST_COEFFICIENTS && room->n < PROPOSAL_MAX; k++)
            put_coefficient(room, c->s.place[i], (uint8_t)id, k, l->rst[i][id - RST_ID_P][k]);
}
_Static_assert(1 + 3 * RST_COEFFICIENTS - 1 == PROPOSAL_MAX &&
                   DIFFERENCE_A_MOST + 1 < RST_COEFFICIENTS,
               "a controller is one proposal");

/* Returns true when the decoupler's turn is over: all of it is in force. What is left when a part was accepted follows at once. *goes_on: false when
 * it was refused, or rejected. */
static bool decoupler_is_over(struct experiment_loops *l, const struct experiment_context *c,
                              struct block_proposal *room, bool *goes_on)
{
    if (!c->decoupler || l->part > 0)
        return true;
    unsigned left = put_decoupler(l, c, room);
    if (l->waits && left >= l->left) {
        room->n = 0;
        *goes_on = false;
    }
    if (l->waits && left > 0)
        room->manner = PROPOSAL_AT_ONCE;
    l->waits = left > 0;
    l->left = (uint8_t)left;
    return left == 0;
}

/* Each is handed over when the one before is gone. */
bool experiment_loops_propose(struct experiment_loops *l, const struct experiment_context *c,
                              struct block_proposal *room)
{
    bool goes_on = true;
    if (!room || room->n) /* taken, or just filled by the experiment itself */
        return true;
    room->manner =
        c->s.adopt == EXPERIMENT_ADOPT_AT_ONCE ? PROPOSAL_AT_ONCE : PROPOSAL_WHEN_ACCEPTED;
    if (!decoupler_is_over(l, c, room, &goes_on))
        return goes_on;
    while (l->part < c->n && !c->s.place[l->part])
        l->part++;
    if (l->part >= c->n)
        return false;
    put_controller(l, c, l->part++, room);
    return true;
}
