#include "commission/analysis_structure.h"

#include "base/assertion.h"
#include "exchange/plan.h"
#include "interact/measure.h"

#include <string.h>

#define SHARPEST REAL_C(5.0) /* largest lead over lag of a feedforward, whose input carries noise */
/* Largest share of the integral of the error that a feedforward may leave to be worth an element. */
#define LEFT_MOST   REAL_C(0.5)
#define GAIN_MOST   REAL_C(100.0)
#define HIDES_SDS   REAL_C(3.0)
#define HIDES_SHARE REAL_C(0.1)
#define TIME_MOST   REAL_C(1e5) /* s; ranges of an element of the firmware */

/* Ranges of a loop of the firmware. */
#define LOOP_GAIN_LEAST REAL_C(1e-6)
#define LOOP_GAIN_MOST  REAL_C(100.0)
#define LOOP_TI_LEAST_S REAL_C(0.01)
#define LOOP_TI_MOST_S  REAL_C(1e6)

/* Largest dead time of an element in samples: the elements share half of the arena, states have the other half. */
static const uint32_t samples_most =
    PLAN_ARENA_BYTES / 2u / sizeof(num_t) / CONFIG_FEEDFORWARDS - 4u;

bool analysis_loop_takes(const struct tuning *t)
{
    return t->gain >= LOOP_GAIN_LEAST && t->gain <= LOOP_GAIN_MOST && t->ti_s >= LOOP_TI_LEAST_S &&
           t->ti_s <= LOOP_TI_MOST_S; /* false for NaN */
}

/* ---- cascades ---- */

/* Tunes an inner loop by itself: SIMC, tau_c = max(theta, T/8), as the others begin in design/detune.h. */
static enum err tune_inner(const struct analysis *a, const struct fopdt *e, struct tuning *t,
                           real_t *tau_c_s)
{
    struct fopdt model = *e;
    model.dead_time_s += REAL_C(0.5) * a->config.h_s;
    real_t eighth = REAL_C(0.125) * model.time_constant_s;
    *tau_c_s = model.dead_time_s > eighth ? model.dead_time_s : eighth;
    enum err err = tuning_simc_pi(&model, *tau_c_s, t, NULL);
    return err || analysis_loop_takes(t) ? err : ERR_RANGE;
}

static unsigned members(uint16_t mask)
{
    unsigned n = 0;
    for (; mask; mask = (uint16_t)(mask & (mask - 1u)))
        n++;
    return n;
}

/* A gain that was not seen may still be there: its error could hide one that is not small beside the others of its row. */
static bool may_be_there(const struct analysis *a, uint8_t j, uint8_t i)
{
    REFLUX_ASSERT(j < a->plant.outputs && i < a->plant.inputs);
    real_t most = REAL_C(0.0);
    for (uint8_t k = 0; k < a->plant.inputs; k++)
        if (real_abs(a->plant.element[j][k].gain) > most)
            most = real_abs(a->plant.element[j][k].gain);
    return HIDES_SDS * a->plant.gain_sd[j][i] > HIDES_SHARE * most;
}

static bool nothing_hides(const struct analysis *a, uint16_t outputs, uint16_t inputs)
{
    for (uint8_t j = 0; j < a->plant.outputs; j++)
        for (uint8_t i = 0; i < a->plant.inputs; i++)
            if (((outputs & (1u << j)) != 0u) != ((inputs & (1u << i)) != 0u) &&
                may_be_there(a, j, i))
                return false;
    return true;
}

/* Johansson's case: a part of the plant with one input and two outputs, (G1, G2 G1). A loop on the inner output must have
 * its input to itself, so the input may move only these two, and no other input may move them. */
static bool usable(struct analysis *a, const struct cascade *c)
{
    uint16_t both = (uint16_t)(1u << c->inner | 1u << c->outer);
    for (uint8_t p = 0; p < a->layout.structure.parts; p++) {
        if (a->layout.structure.part_outputs[p] != both ||
            members(a->layout.structure.part_inputs[p]) != 1u)
            continue;
        if (!nothing_hides(a, both, a->layout.structure.part_inputs[p])) {
            a->layout.hidden_cascade = true;
            continue;
        }
        struct tuning t;
        real_t tau_c_s;
        uint8_t j = 0;
        while (((unsigned)a->layout.structure.part_inputs[p] >> j & 1u) == 0u)
            j++;
        return tune_inner(a, &a->plant.element[c->inner][j], &t, &tau_c_s) == ERR_OK;
    }
    return false;
}

void analysis_find_cascades(struct analysis *a)
{
    static const struct pairs none = {0};
    struct cascade_config cascades;
    struct structure_config structure;
    cascade_config_default(&cascades);
    structure_config_default(&structure);
    if (cascade_detect(&a->plant, &cascades, a->layout.cascade, &a->layout.n_cascades) != ERR_OK ||
        structure_detect(&a->plant, &none, &structure, &a->work.structure, &a->layout.structure) !=
            ERR_OK)
        a->layout.n_cascades = 0;
    for (uint8_t n = 0; n < a->layout.n_cascades; n++)
        if (a->given[a->layout.cascade[n].inner] == 0 && usable(a, &a->layout.cascade[n]))
            a->layout.inner_outputs =
                (uint16_t)(a->layout.inner_outputs | 1u << a->layout.cascade[n].inner);
}

void analysis_find_structure(struct analysis *a)
{
    struct structure_config c;
    structure_config_default(&c);
    a->layout.has_structure = structure_detect(&a->plant, &a->pairs, &c, &a->work.structure,
                                               &a->layout.structure) == ERR_OK;
}

static const struct cascade *cascade_of(const struct analysis *a, uint8_t k)
{
    REFLUX_ASSERT(k < a->pairs.n && a->layout.n_cascades <= INTERACT_MAX);
    for (uint8_t n = 0; n < a->layout.n_cascades; n++)
        if (a->layout.cascade[n].outer == a->pairs.output[k] &&
            (a->layout.inner_outputs >> a->layout.cascade[n].inner & 1u))
            return &a->layout.cascade[n];
    return NULL;
}

uint8_t analysis_inner_of(const struct analysis *a, uint8_t k)
{
    const struct cascade *c = cascade_of(a, k);
    return c ? c->inner : INTERACT_NONE;
}

uint8_t analysis_loops(const struct analysis *a)
{
    return (uint8_t)(a->pairs.n + members(a->layout.inner_outputs));
}

/* G2 behind the closed inner loop, exp(-L1 s)/(tau_c s + 1), as a first order again by the half rule (Skogestad 2003):
 * half of the smaller lag goes to the larger one, half to the dead time. */
static void close_inner(struct analysis *a, struct interact_plant *plant, uint8_t k,
                        const struct cascade *c)
{
    REFLUX_ASSERT(k < a->pairs.n);
    uint8_t j = a->pairs.input[k];
    const struct fopdt inner = plant->element[c->inner][j];
    real_t part = plant->gain_sd[c->inner][j] / inner.gain, tau_c_s;
    if (tune_inner(a, &inner, &a->layout.inner_tuning[k], &tau_c_s) != ERR_OK)
        return;                                         /* usable() has tried it */
    memset(plant->along_sd, 0, sizeof plant->along_sd); /* it was about other gains */
    for (uint8_t i = 0; i < plant->outputs; i++) {
        real_t *gain = &plant->element[i][j].gain, *sd = &plant->gain_sd[i][j];
        *gain /= inner.gain;
        *sd = real_abs(*sd / inner.gain);
    }
    struct fopdt *e = &plant->element[c->outer][j];
    real_t *sd = &plant->gain_sd[c->outer][j];
    *sd = real_sqrt(*sd * *sd + e->gain * e->gain * part * part);
    real_t lag = c->between.time_constant_s;
    real_t large = lag > tau_c_s ? lag : tau_c_s, small = lag > tau_c_s ? tau_c_s : lag;
    e->time_constant_s = large + REAL_C(0.5) * small;
    e->dead_time_s = c->between.dead_time_s + inner.dead_time_s + REAL_C(0.5) * small;
    plant->shape[c->outer][j] = (struct interact_shape){REAL_C(0.0), REAL_C(0.0)};
}

void analysis_close_inner_loops(struct analysis *a, struct interact_plant *plant)
{
    for (uint8_t k = 0; k < a->pairs.n; k++) {
        const struct cascade *c = cascade_of(a, k);
        if (c)
            close_inner(a, plant, k, c);
    }
}

/* ---- second opinion ---- */

/* A gain of 0 has no times and would count for much when it is divided by none. */
void analysis_ask_second(struct analysis *a)
{
    struct interact_plant *plant = &a->plant;
    struct measure *m = &a->work.second.result;
    for (uint8_t i = 0; i < plant->outputs; i++)
        for (uint8_t j = 0; j < plant->inputs; j++) {
            real_t *gain = &plant->element[i][j].gain;
            a->work.second.gain[i][j] = *gain;
            if (real_abs(*gain) <= REAL_C(3.0) * plant->gain_sd[i][j])
                *gain = REAL_C(0.0);
        }
    a->layout.second = SECOND_NONE;
    enum err err = measure_compute(plant, &a->pairs, a->config.h_s, &a->work.second.work, m);
    for (uint8_t i = 0; i < plant->outputs; i++)
        for (uint8_t j = 0; j < plant->inputs; j++)
            plant->element[i][j].gain = a->work.second.gain[i][j];
    if (err)
        return;
    for (uint8_t k = 0; k < a->pairs.n; k++)
        a->layout.pair_phi[k] = m->phi.value[k][k];
    a->layout.second =
        measure_agrees(m, &a->work.second.assignment) ? SECOND_AGREES : SECOND_DIFFERS;
}

/* ---- feedforward ---- */

/* Delay of the correction in relation to the time that the loop's own controller takes: without feedforward the integral of
 * the error is K_ij Ti/(K_ii Kc), with it K_ij times the delay. The loop reacts to that as well, so this is an estimate. */
static struct feed feed_verdict(const struct analysis *a, uint8_t from, uint8_t to)
{
    REFLUX_ASSERT(from < a->pairs.n && to < a->pairs.n);
    struct feed f = {.verdict = FEED_NONE};
    if (!a->designed || from == to ||
        structure_cross_way(&a->plant, &a->pairs, &a->layout.structure, from, to, &f.way) != ERR_OK)
        return f;
    const struct tuning *t = &a->loops.tuning[to];
    const struct fopdt *own = &a->plant.element[a->pairs.output[to]][a->pairs.input[to]];
    real_t h = a->config.h_s, late = f.way.late_s + h - f.way.dead_s;
    f.way.dead_s = late < REAL_C(0.0) ? -late : REAL_C(0.0);
    late = late > REAL_C(0.0) ? late : REAL_C(0.0);
    real_t longer = f.way.lead_s / SHARPEST - h;
    if (longer > f.way.lag_s) {
        late += longer - f.way.lag_s;
        f.way.lag_s = longer;
    }
    f.way.late_s = late;
    f.left = late * t->gain * real_abs(own->gain) / t->ti_s;
    if (a->layout.structure.block[a->layout.structure.pair_block[to]].size > 1)
        f.verdict = FEED_COMPANY;
    else if (!(real_abs(f.way.gain) <= GAIN_MOST) || !(f.way.lead_s <= TIME_MOST) ||
             !(f.way.lag_s <= TIME_MOST) || !(f.way.dead_s <= TIME_MOST) ||
             !(f.way.dead_s <= (real_t)samples_most * h))
        f.verdict = FEED_LARGE;
    else
        f.verdict = f.left <= LEFT_MOST ? FEED_USED : FEED_LATE;
    return f;
}

uint8_t analysis_feeds(const struct analysis *a, struct feed feeds[CONFIG_FEEDFORWARDS])
{
    uint8_t n = 0;
    for (uint8_t k = 0; k < a->pairs.n; k++)
        for (uint8_t l = 0; l < a->pairs.n; l++) {
            struct feed f = feed_verdict(a, k, l);
            uint8_t at = n;
            while (at > 0 && real_abs(feeds[at - 1u].way.gain) < real_abs(f.way.gain))
                at--;
            if (f.verdict != FEED_USED || at == CONFIG_FEEDFORWARDS)
                continue;
            n = n < CONFIG_FEEDFORWARDS ? (uint8_t)(n + 1u) : n;
            for (uint8_t m = (uint8_t)(n - 1u); m > at; m--)
                feeds[m] = feeds[m - 1u];
            feeds[at] = f;
        }
    return n;
}

struct feed analysis_feed(const struct analysis *a, uint8_t from, uint8_t to)
{
    struct feed f = feed_verdict(a, from, to), feeds[CONFIG_FEEDFORWARDS];
    if (f.verdict != FEED_USED)
        return f;
    f.verdict = FEED_FULL;
    for (uint8_t n = analysis_feeds(a, feeds); n > 0; n--)
        if (feeds[n - 1u].way.from == from && feeds[n - 1u].way.to == to)
            f.verdict = FEED_USED;
    return f;
}
