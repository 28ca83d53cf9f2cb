#include "exchange/config.h"

#include "commission/proposal.h"

#include "commission/commission.h"
#include "commission/commission_internal.h"
#include "commission/proposal_structure.h"

#include <string.h>

const char *proposal_measurement_name(const struct commission *c, const struct config *config,
                                      uint8_t k)
{
    const struct analysis *a = &c->work->analysis;
    return config->measurement[c->measurement[a->pairs.output[k]]].name;
}

const char *proposal_output_name(const struct commission *c, const struct config *config, uint8_t k)
{
    const struct analysis *a = &c->work->analysis;
    return config->mv[c->input[c->column[a->pairs.input[k]]].output].name;
}

uint8_t proposal_loop(const struct commission *c, const struct config *config, uint8_t k)
{
    const char *drives = proposal_output_name(c, config, k);
    if (analysis_inner_of(&c->work->analysis, k) != INTERACT_NONE) {
        uint8_t inner = proposal_inner_loop(c, config, k);
        if (inner == PLAN_NONE)
            return PLAN_NONE;
        drives = config->loop[inner].name;
    }
    return proposal_find_loop(config, proposal_measurement_name(c, config, k), drives);
}

static bool is_tested_output(const struct commission *c, const struct config *config,
                             const char *name)
{
    for (uint8_t k = 0; k < c->inputs; k++)
        if (!c->input[k].skipped && strcmp(config->mv[c->input[k].output].name, name) == 0)
            return true;
    return false;
}

void proposal_decouple_alone(struct config *config, uint8_t i)
{
    for (uint8_t k = 0; i < DECOUPLER_MAX && k < DECOUPLER_MAX; k++)
        config->decoupler[i][k] = config->decoupler[k][i] = i == k ? 1.0f : 0.0f;
}

/* Loops on tested outputs, loops that drive such loops, and feedforwards onto those outputs. */
static void make_room(const struct commission *c, struct config *config)
{
    bool drops = true;
    for (unsigned depth = 0; drops && depth < CONFIG_LOOPS; depth++) {
        drops = false;
        for (uint8_t i = 0; i < CONFIG_LOOPS; i++) {
            struct loop_config *l = &config->loop[i];
            bool inner = config_find_loop(config, l->out) != PLAN_NONE ||
                         config_find_mv(config, l->out) != PLAN_NONE;
            if (!l->name[0] || (inner && !is_tested_output(c, config, l->out)))
                continue;
            for (uint8_t k = 0; k < CONFIG_ALARMS; k++)
                if (config->alarm[k].side == ALARM_DEVIATION &&
                    strcmp(config->alarm[k].on, l->name) == 0)
                    config->alarm[k].on[0] = '\0';
            memset(l->name, 0, sizeof l->name);
            proposal_decouple_alone(config, i);
            drops = true;
        }
    }
    for (uint8_t k = 0; k < CONFIG_FEEDFORWARDS; k++)
        if (is_tested_output(c, config, config->feedforward[k].to))
            config->feedforward[k].from[0] = '\0';
}

static bool is_taken(const struct config *config, const char *name)
{
    return config_find_mv(config, name) != PLAN_NONE || config_find_loop(config, name) != PLAN_NONE;
}

void proposal_name_loop(struct config *config, uint8_t i, const char *pv, const char *out)
{
    char name[CHANNEL_NAME_SIZE] = {0};
    strncpy(name, pv, sizeof name - 1);
    /* There are more letters than names that could be taken. */
    for (char letter = 'A'; letter <= 'Z' && is_taken(config, name); letter++) {
        memset(name, 0, sizeof name);
        name[0] = letter;
        name[1] = '_';
        strncpy(name + 2, out, sizeof name - 3);
    }
    memcpy(config->loop[i].name, name, sizeof name);
}

struct loop_config proposal_settings(const struct tuning *t, real_t derivative_filter)
{
    return (struct loop_config){
        .own.gain = (float)t->gain,
        .own.ti_s = (float)t->ti_s,
        .own.td_s = (float)t->td_s,
        .own.n = (float)derivative_filter,
        .own.b = 1.0f,
        .own.out_hi = 1.0f,
        .own.action = t->action == TUNING_DIRECT ? LOOP_DIRECT : LOOP_REVERSE,
        .sp_track = 1,
        .divisor = 1,
    };
}

enum err by_relay_write(const struct commission *c, struct config *config)
{
    uint8_t i = proposal_loop(c, config, 0);
    if (i == PLAN_NONE)
        return ERR_UNKNOWN;
    struct loop_config *l = &config->loop[i];
    l->own.gain = (float)real_abs(c->by_relay.gain);
    l->own.ti_s = (float)c->by_relay.ti_s;
    l->own.td_s = 0.0f;
    l->own.action = c->by_relay.gain < REAL_C(0.0) ? LOOP_DIRECT : LOOP_REVERSE;
    return ERR_OK;
}

enum err proposal_write(const struct commission *c, struct config *config)
{
    const struct analysis *a = &c->work->analysis;
    if (!commission_has_proposal(c) || !commission_has_results(c))
        return ERR_STATE;
    if (commission_channels(config) != c->channels)
        return ERR_CONFLICT;
    if (c->by_relay.on)
        return by_relay_write(c, config);
    make_room(c, config);
    uint8_t place[CONFIG_LOOPS];
    uint8_t n = 0;
    bool decoupled = a->decoupler == DECOUPLER_USED;
    unsigned places = decoupled ? DECOUPLER_MAX : CONFIG_LOOPS; /* the matrix has the first loops */
    for (uint8_t i = 0; i < places && n < a->pairs.n; i++)
        if (!config->loop[i].name[0])
            place[n++] = i;
    if (n < a->pairs.n)
        return ERR_FULL;
    for (uint8_t k = 0; k < n; k++)
        proposal_decouple_alone(config, place[k]);
    for (uint8_t k = 0; k < n; k++) {
        struct loop_config *l = &config->loop[place[k]];
        const char *pv = proposal_measurement_name(c, config, k);
        const char *out = proposal_output_name(c, config, k);
        *l = proposal_settings(&a->loops.tuning[k], a->loops.derivative_filter);
        l->decouple = decoupled;
        strncpy(l->pv, pv, sizeof l->pv - 1);
        strncpy(l->out, out, sizeof l->out - 1);
        proposal_name_loop(config, place[k], pv, out);
        for (uint8_t j = 0; j < n && decoupled; j++)
            config->decoupler[place[k]][place[j]] = (float)a->d.at[k][j];
    }
    return proposal_add_structure(c, config, place);
}

#define STEP_IN_NOISE REAL_C(8.0)
#define STEP_LEAST    REAL_C(0.01) /* fraction of span */
#define STEP_SHARE    REAL_C(0.25) /* of the test limit */
#define STEP_MOST     REAL_C(0.5)
#define ROOM_SHARE    REAL_C(0.8)
#define OTHERS_SHARE  REAL_C(0.7) /* of a limit: how far a step may drive what it is not for */
#define WINDOW_MOST   10000u

/* The largest step of loop k's setpoint for which, on the model, every input stays within its room, and what no loop holds
 * within its limit. */
static real_t step_by_model(const struct commission *c, const struct supervisor *s, uint8_t k)
{
    const struct analysis *a = &c->work->analysis;
    const struct adoption *t = &c->adoption;
    const struct trial_mark *by = &a->tried[k];
    real_t most = REAL_C(1.0);
    for (uint8_t l = 0; l < a->pairs.n; l++) {
        if (analysis_inner_of(a, l) != INTERACT_NONE)
            continue; /* proposal_prepare_inner() */
        uint8_t j = c->input[c->column[a->pairs.input[l]]].output;
        real_t room = ROOM_SHARE * commission_room(s, j, num_to_float(s->mv[j].manual));
        if (by->moved[l] * most > room * a->config.step)
            most = room * a->config.step / by->moved[l];
    }
    for (uint8_t j = t->n; j < t->channels; j++) {
        uint8_t output = t->channel[j].output;
        real_t goes = REAL_C(0.0), limit = OTHERS_SHARE * t->channel[j].limit;
        for (uint8_t l = 0; l < a->pairs.n; l++)
            goes += a->plant.element[output][a->pairs.input[l]].gain * by->input[l];
        if (real_abs(goes) * most > limit * a->config.step)
            most = limit * a->config.step / real_abs(goes);
    }
    return most;
}

/* The step of a loop's setpoint on trial: out of the noise, inside the limit, and no farther than the model says that inputs
 * and other measurements can go. */
static void choose_step(const struct commission *c, const struct supervisor *s, uint8_t k,
                        struct adoption_loop *l)
{
    const struct adoption_channel *m = &c->adoption.channel[k];
    real_t step = STEP_IN_NOISE * m->noise_sd;
    if (step < STEP_LEAST)
        step = STEP_LEAST;
    if (step < STEP_SHARE * m->limit)
        step = STEP_SHARE * m->limit;
    if (step > STEP_MOST * m->limit)
        step = STEP_MOST * m->limit;
    real_t most = step_by_model(c, s, k);
    if (step > most)
        step = most;
    if (step < STEP_NEVER)
        step = STEP_NEVER;
    real_t y = num_to_float(s->measurement[m->measurement].value);
    l->step = y > REAL_C(0.5) ? -step : step;
}

/* A measurement on trial, by its place in the tests. */
static void take_channel(struct commission *c, const struct config *config, uint8_t output)
{
    struct adoption *t = &c->adoption;
    struct adoption_channel *m = &t->channel[t->channels++];
    m->measurement = c->measurement[output];
    m->output = output;
    m->noise_sd = c->noise_sd[output];
    m->limit = commission_limit(&config->measurement[m->measurement]);
}

/* All measurements that were tested: those of the loops first, in their order. */
static void take_channels(struct commission *c, const struct config *config)
{
    const struct analysis *a = &c->work->analysis;
    uint32_t held = 0;
    for (uint8_t k = 0; k < a->pairs.n; k++) {
        take_channel(c, config, a->pairs.output[k]);
        held |= 1u << a->pairs.output[k];
    }
    for (uint8_t j = 0; j < c->outputs; j++)
        if (!(held >> j & 1u))
            take_channel(c, config, j);
}

enum err proposal_prepare_trial(struct commission *c, const struct supervisor *s,
                                const struct config *config)
{
    const struct analysis *a = &c->work->analysis;
    struct adoption *t = &c->adoption;
    if (commission_channels(config) != c->channels)
        return ERR_CONFLICT;
    memset(t, 0, sizeof *t);
    t->n = a->pairs.n;
    take_channels(c, config);
    t->back = c->half_least;
    t->window = c->half_least;
    if (t->window < config->test.window)
        t->window = config->test.window;
    if (t->window < STEADY_BLOCKS)
        t->window = STEADY_BLOCKS;
    if (t->window > WINDOW_MOST)
        t->window = WINDOW_MOST;
    for (uint8_t k = 0; k < a->pairs.n; k++) {
        struct adoption_loop *l = &t->loop[k];
        uint8_t i = proposal_loop(c, config, k);
        if (i == PLAN_NONE)
            return ERR_UNKNOWN;
        l->loop = i;
        l->output = c->input[c->column[a->pairs.input[k]]].output;
        l->predicted = a->predicted[k];
        l->predicted.iae = a->tried[k].iae;
        l->left = a->tried[k].left;
        l->duration_s = ADOPTION_DURATION * l->predicted.settled_s;
        if (l->duration_s > a->horizon_s)
            l->duration_s = a->horizon_s;
        l->size = a->config.step;
        choose_step(c, s, k, l);
    }
    return proposal_prepare_inner(c, s, config);
}
