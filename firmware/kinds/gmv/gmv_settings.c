#include "kinds/gmv/gmv_settings.h"

#include <string.h>

#include "block/refuse.h"
#include "num/real.h"

#define PLACE(field) offsetof(struct gmv_settings, field)
#define NUMBER(id, field, name, unit, help, lo, hi, initial)                                       \
    {                                                                                              \
        id, BLOCK_FLOAT, PLACE(field), 1, 1, name, unit, help, lo, hi, initial                     \
    }
#define PAIR(id, field, name, unit, help, lo, hi, initial)                                         \
    {                                                                                              \
        id, BLOCK_FLOAT, PLACE(field), 1, 2, name, unit, help, lo, hi, initial                     \
    }
#define COUNT(id, field, name, unit, help, lo, hi, initial)                                        \
    {                                                                                              \
        id, BLOCK_U16, PLACE(field), 1, 1, name, unit, help, lo, hi, initial                       \
    }
#define WORD(id, field, name, words, help, initial)                                                \
    {                                                                                              \
        id, BLOCK_WORD, PLACE(field), 1, 1, name, words, help, 0, 0, initial                       \
    }
/* Single numbers, because a row of a table cannot be proposed. */
#define NTH_THETA(i, p) (GMV_PARAMETERS * ((i)-1) + ((p)-1))
#define THETA(i, p)                                                                                \
    {                                                                                              \
        GMV_ID_THETA + NTH_THETA(i, p), BLOCK_FLOAT,                                               \
            PLACE(theta) + NTH_THETA(i, p) * sizeof(float), 1, 1, "theta" #i "_" #p, "-",          \
            "start value, or as adopted", -100, 100, 0                                             \
    }
#define THETAS(i)                                                                                  \
    THETA(i, 1), THETA(i, 2), THETA(i, 3), THETA(i, 4), THETA(i, 5), THETA(i, 6), THETA(i, 7),     \
        THETA(i, 8), THETA(i, 9), THETA(i, 10), THETA(i, 11), THETA(i, 12)

const struct block_parameter gmv_parameter_rows[GMV_PARAMETER_ROWS] = {
    WORD(1, form, "form", "positional|incremental", "values of signals, or changes", 1),
    WORD(2, way, "way", "implicit|explicit", "estimates the law, or a model", 0),
    WORD(3, weight, "weight", "delta|scalar|relative", "lambda weighs moves, MVs, moves times g0",
         2),
    WORD(4, bias, "bias", "one|residuals|none|error", "last regressor; error: incremental form", 0),
    COUNT(5, na, "na", "-", "terms of each PV", 1, 4, 1),
    COUNT(6, nb, "nb", "-", "terms of each MV; 0: 5 with one loop, 3 with two", 0, 5, 0),
    COUNT(7, nc, "nc", "-", "past predictions", 0, 2, 0),
    {8, BLOCK_U16, PLACE(delay), 2, 2, "delay", "steps", "row: PV, column: MV; 0: not in its model",
     0, 8, 1},
    COUNT(9, load_delay, "load_delay", "steps", "delay of disturbances", 0, 8, 0),
    COUNT(10, average, "average", "steps", "length of the data filter", 1, 8, 1),
    PAIR(11, tau_p_s, "tau_p", "s", "time constant of P; -1: half the delay, at least 2 steps", -1,
         1e6f, -1),
    PAIR(12, tau_r_s, "tau_r", "s", "time constant of R; -1: R is P", -1, 1e6f, -1),
    PAIR(13, lambda, "lambda", "-", "weight of the MV, span/span; relative: times g0", -100, 100,
         1),
    PAIR(14, p0, "p0", "-", "P(0): of PVs and the rest, of MVs", 1e-6f, 1e9f, 1e6f),
    WORD(15, forgetting, "forgetting", RLS_FORGETTING_WORDS, "rule of forgetting", RLS_DIRECTIONAL),
    NUMBER(16, forget, "forget", "-", "v of the constant rule", 0.5f, 1, 0.99f),
    NUMBER(17, forget_least, "forget_least", "-", "least v of any rule", 0.01f, 1, 0.5f),
    NUMBER(18, memory, "memory", "-", "N0 of ydstie, sigma0 of fortescue, PV spans squared", 1e-12f,
           1e6f, 1),
    NUMBER(19, trace, "trace", "-", "tr P, held or largest", 1e-6f, 1e12f, 1e9f),
    WORD(20, correction, "correction", RLS_CORRECTION_WORDS, "of parameters outside lo and hi", 0),
    NUMBER(21, correct_rate, "correct_rate", "-", "alpha of pc, mu of spc", 0, 2, 0.5f),
    NUMBER(22, error_most, "error_most", "-", "largest error used, PV spans; 0: any", 0, 100, 0),
    NUMBER(23, dead_zone, "dead_zone", "-", "smaller errors, in sd, are ignored", 0, 100, 0),
    WORD(24, normalise, "normalise", "off|on", "data by its largest entry", 0),
    {25, BLOCK_FLOAT, PLACE(lo), 12, 2, "lo", "-", "row: parameter, column: loop", -100, 100, 0},
    {26, BLOCK_FLOAT, PLACE(hi), 12, 2, "hi", "-", "the same; none unless above lo", -100, 100, 0},
    WORD(27, supervise, "supervise", "off|on", "off: adopts untested after tune_time", 1),
    WORD(28, adopt, "adopt", "at_once|ask", "a model that passed its test", 0),
    PAIR(29, tune_gain, "tune_gain", "-", "gain of the PI while tuning, with the plant's sign",
         -100, 100, 0),
    PAIR(30, tune_ti_s, "tune_ti", "s", "its integral time; 0: none", 0, 1e6f, 300),
    NUMBER(31, tune_time_s, "tune_time", "s", "least time of tuning", 0, 1e6f, 1800),
    NUMBER(32, check_time_s, "check_time", "s", "length of a test or check, at least 10 steps", 0,
           1e6f, 1800),
    NUMBER(33, excite, "excite", "-", "sd that gains must differ from 0", 0, 1000, 3),
    NUMBER(34, gain_least, "gain_least", "-", "least |g0|, span/span", 1e-6f, 1, 1e-4f),
    NUMBER(35, margin, "margin", "-", "gain margin in the trial", 1, 10, 1.25f),
    NUMBER(36, speed, "speed", "-", "largest change of parameters per step", 1e-4f, 1, 0.05f),
    NUMBER(37, quiet, "quiet", "-", "least information, part of the usual", 0, 1, 1),
    NUMBER(38, burst, "burst", "-", "mean square of moves over the long mean", 2, 1e6f, 25),
    COUNT(39, tries, "tries", "-", "returns to the PI a day, then off; 0: any", 0, GMV_TRIES_MOST,
          3),
    THETAS(1),
    THETAS(2),
    NUMBER(GMV_ID_LAST - 1, better, "better", "-", "least part of the PI's error saved", -10, 0.9f,
           0.05f),
    NUMBER(GMV_ID_LAST, detune, "detune", "-", "largest multiple of lambda in a trial", 1, 1000,
           64),
};
_Static_assert(GMV_PARAMETERS == 12 && GMV_LOOPS == 2, "rows of theta, lo and hi");

/* ---- configurations made of them ---- */

#define DETERMINANT_LEAST 0.01f
/* Time constant of P where none is set, which makes minimum variance gentler: least steps, and part of the delay. */
#define STEPS_OF_P 2.0f
#define DELAY_OF_P 0.5f
/* Terms of each MV where none are set. */
#define TERMS_ALONE    5u
#define TERMS_TOGETHER 3u

static bool terms_fit(const struct gmv_shape *shape)
{
    for (unsigned i = 0; i < shape->loops; i++)
        if (gmv_parameters(shape, i) > GMV_PARAMETERS)
            return false;
    return true;
}

static void choose_terms(struct gmv_shape *shape)
{
    shape->nb = shape->loops > 1 ? TERMS_TOGETHER : TERMS_ALONE;
    while (shape->nb > 1 && !terms_fit(shape))
        shape->nb--;
}

static float time_of_p(const struct gmv_settings *c, unsigned i, float interval_s)
{
    float steps = DELAY_OF_P * (float)c->delay[i][i];
    if (c->tau_p_s[i] >= 0)
        return c->tau_p_s[i];
    return (steps > STEPS_OF_P ? steps : STEPS_OF_P) * interval_s;
}

static void shape_of_settings(const struct block_setup *setup, struct gmv_shape *shape)
{
    const struct gmv_settings *c = setup->settings;
    memset(shape, 0, sizeof *shape);
    shape->loops = setup->members < GMV_LOOPS ? setup->members : GMV_LOOPS;
    shape->form = c->form;
    shape->way = c->way;
    shape->weight =
        c->weight == GMV_WORD_SCALAR ? (uint8_t)GMV_WEIGHT_SCALAR : (uint8_t)GMV_WEIGHT_DELTA;
    shape->bias = c->bias;
    shape->na = (uint8_t)c->na;
    shape->nb = (uint8_t)c->nb;
    shape->nc = (uint8_t)c->nc;
    for (unsigned i = 0; i < shape->loops; i++)
        for (unsigned j = 0; j < shape->loops; j++)
            shape->delay[i][j] = (uint8_t)c->delay[i][j];
    if (setup->inputs > setup->members)
        shape->disturbances = (uint8_t)(setup->inputs - setup->members);
    shape->disturbance_delay = (uint8_t)c->load_delay;
    shape->average = (uint8_t)c->average;
    if (shape->nb == 0)
        choose_terms(shape);
}

void gmv_config_of(const struct block_setup *setup, struct gmv_config *c)
{
    const struct gmv_settings *from = setup->settings;
    memset(c, 0, sizeof *c);
    shape_of_settings(setup, &c->shape);
    c->interval_s = setup->interval_s;
    c->determinant = DETERMINANT_LEAST;
    c->p0 = from->p0[0];
    c->p0_u = from->p0[1];
    c->rls = (struct rls_settings){.forgetting = from->forgetting,
                                   .correction = from->correction,
                                   .normalise = from->normalise,
                                   .forget = from->forget,
                                   .forget_least = from->forget_least,
                                   .sigma0 = from->memory,
                                   .memory = from->memory,
                                   .trace = from->trace,
                                   .rate = from->correct_rate,
                                   .error_most = from->error_most,
                                   .dead_zone = from->dead_zone};
    for (unsigned i = 0; i < GMV_LOOPS; i++) {
        c->tau_p_s[i] = time_of_p(from, i, setup->interval_s);
        c->tau_r_s[i] = from->tau_r_s[i];
        c->lambda[i] = from->lambda[i];
        for (unsigned p = 0; p < GMV_PARAMETERS; p++) {
            c->theta[i][p] = from->theta[i][p];
            c->lo[i][p] = from->lo[p][i];
            c->hi[i][p] = from->hi[p][i];
        }
    }
}

/* Least steps of a test: fewer prove nothing. */
#define CHECK_STEPS_LEAST 10u

static uint32_t steps_of(float seconds, float interval_s)
{
    float steps = seconds / interval_s + 0.5f;
    return steps < 4e9f ? (uint32_t)steps : 4000000000u;
}

void gmv_supervise_config_of(const struct block_setup *setup, struct gmv_supervise_config *c)
{
    const struct gmv_settings *from = setup->settings;
    struct gmv_shape shape;
    uint32_t check_steps = steps_of(from->check_time_s, setup->interval_s);
    shape_of_settings(setup, &shape);
    *c = (struct gmv_supervise_config){
        .on = from->supervise,
        .ask = from->adopt,
        .loops = shape.loops,
        .tries = (uint8_t)from->tries,
        .tune_steps = steps_of(from->tune_time_s, setup->interval_s),
        .check_steps = check_steps > CHECK_STEPS_LEAST ? check_steps : CHECK_STEPS_LEAST,
        .day_steps = steps_of(86400, setup->interval_s),
        .reach = gmv_reach(&shape),
        .excite = from->excite,
        .gain_least = from->gain_least,
        .quiet = from->quiet,
        .burst = from->burst,
        .better = from->better};
    for (unsigned i = 0; i < GMV_LOOPS; i++)
        c->negative[i] = from->tune_gain[i] < 0;
}

/* ---- check ---- */

static enum err check_signals(const struct block_setup *setup, struct block_fault *fault)
{
    if (setup->members < 1 || setup->members > GMV_LOOPS)
        return block_refuse(fault, 0, "loops", "needs one or two");
    for (unsigned k = 0; k < setup->members; k++)
        if ((setup->present & (1u << k)) && !setup->member[k].drives_mv)
            return block_refuse(fault, k, "loops", "needs loops that drive an MV themselves");
    if (setup->inputs < setup->members)
        return block_refuse(fault, 0, "inputs", "needs the PVs of its loops, in their order");
    if (setup->inputs > setup->members + GMV_DISTURBANCES)
        return block_refuse(fault, 0, "inputs",
                            "needs no more than two disturbances behind the PVs");
    for (unsigned k = 0; k < setup->members; k++)
        if (setup->input[k].is_mv || setup->input[k].lo != setup->pv[k].lo ||
            setup->input[k].hi != setup->pv[k].hi)
            return block_refuse(fault, k, "inputs", "needs the PVs of its loops, in their order");
    return ERR_OK;
}

static enum err check_numbers(const struct block_setup *setup, struct block_fault *fault)
{
    const struct gmv_settings *c = setup->settings;
    for (unsigned i = 0; i < setup->members; i++) {
        if (!(real_abs(c->tune_gain[i]) >= 1e-6f))
            return block_refuse(fault, i, "tune_gain", "needs a gain for each PI, and its sign");
        if (c->tune_ti_s[i] > 0 && c->tune_ti_s[i] < 0.01f)
            return block_refuse(fault, i, "tune_ti", "must be 0, or 0.01 s or more");
        float lambda = c->weight == GMV_WORD_RELATIVE ? 1 : c->tune_gain[i];
        if (c->lambda[i] * lambda < 0)
            return block_refuse(fault, i, "lambda",
                                "must have the sign of tune_gain, and none if relative");
    }
    return ERR_OK;
}

enum err gmv_settings_check(const struct block_setup *setup, struct block_fault *fault)
{
    struct gmv_config config;
    const char *field = "", *wanted = "";
    unsigned loop = 0;
    enum err err = check_signals(setup, fault);
    if (!err)
        err = check_numbers(setup, fault);
    if (err)
        return err;
    gmv_config_of(setup, &config);
    err = gmv_check(&config, &loop, &field, &wanted);
    if (err) {
        if (strcmp(field, "sigma0") == 0)
            field = "memory";
        (void)block_refuse(fault, loop, field, wanted);
        fault->must_be = strncmp(wanted, "needs", 5) != 0 && strncmp(wanted, "must", 4) != 0 &&
                         strncmp(wanted, "makes", 5) != 0; /* a range */
    }
    return err;
}
