#include "kinds/ff_tune/tune_settings.h"

#include <string.h>

#include "base/assertion.h"
#include "block/refuse.h"
#include "block/step_period.h"

#define PLACE(field) offsetof(struct tune_settings, field)
#define NUMBER(id, field, name, unit, help, lo, hi, initial)                                       \
    {                                                                                              \
        id, BLOCK_FLOAT, PLACE(field), 1, 1, name, unit, help, lo, hi, initial                     \
    }
#define COUNT(id, field, name, unit, help, lo, hi, initial)                                        \
    {                                                                                              \
        id, BLOCK_U16, PLACE(field), 1, 1, name, unit, help, lo, hi, initial                       \
    }
#define WORD(id, field, name, words, help, initial)                                                \
    {                                                                                              \
        id, BLOCK_WORD, PLACE(field), 1, 1, name, words, help, 0, 0, initial                       \
    }

const struct block_parameter tune_parameter_rows[TUNE_PARAMETERS] = {
    WORD(1, method, "method", TUNE_METHOD_WORDS, "what is identified: Siddha's A, B, C, D",
         TUNE_JOINT),
    COUNT(2, element, "element", "-", "number of the ff, or of the term, that it tunes", 1, 8, 1),
    NUMBER(3, period_s, "period", "s", "sample of the models; 0: a base tick", 0, 1e5f, 0),
    {4, BLOCK_U16, PLACE(order), 2, 3, "order", "-",
     "na, nb, delay; row: of MV or setpoint, of the disturbance; nb 0: the source's", 0, 100, 0},
    NUMBER(5, gain, "gain", "span/span", "of the loop's PI, with the sign of its action", -100, 100,
           0),
    NUMBER(6, ti_s, "ti", "s", "of the loop's PI", 0, 1e6f, 0),
    NUMBER(7, b, "b", "-", "its setpoint weight", 0, 1, 1),
    NUMBER(8, band_lo, "band_lo", "rad/s", "where it is tuned; 0: found", 0, 1e4f, 0),
    NUMBER(9, band_hi, "band_hi", "rad/s", "where it is tuned; 0: found", 0, 1e4f, 0),
    NUMBER(10, learn_s, "learn", "s", "least time of a stage; twice that is the most", 1, 1e7f,
           3000),
    NUMBER(11, check_s, "check", "s", "of fresh data that tests a candidate", 1, 1e7f, 1500),
    NUMBER(12, every_s, "every", "s", "anew while it runs; 0: when asked or changed", 0, 1e8f, 0),
    NUMBER(13, bias_s, "bias", "s", "high-pass on all signals; 0: a quarter of learn", 0, 1e7f, 0),
    WORD(14, forgetting, "forgetting", RLS_FORGETTING_WORDS, "rule", RLS_CONSTANT),
    NUMBER(15, forget, "forget", "-", "factor", 0.9f, 1, 0.999f),
    NUMBER(16, forget_least, "forget_least", "-", "of rules with a factor that varies", 0.01f, 1,
           0.95f),
    NUMBER(17, p0, "p0", "span^-2", "P(0)", 1e-3f, 1e9f, 1e7f),
    NUMBER(18, memory, "memory", "span^2", "of fortescue and ydstie", 1e-12f, 1e6f, 1e-3f),
    NUMBER(19, trace, "trace", "span^-2", "of rules that have one", 1e-6f, 1e12f, 1e9f),
    NUMBER(20, step, "step", "EU", "test signal on the setpoint, to either side; 0: none", 0, 1e9f,
           0),
    NUMBER(21, step_period_s, "step_period", "s", "of that square wave", 0, 1e7f, 600),
    NUMBER(22, disturb, "disturb", "EU", "on the disturbance, where it is an MV; 0: none", 0, 1e9f,
           0),
    NUMBER(23, disturb_period_s, "disturb_period", "s", "of that square wave", 0, 1e7f, 450),
    NUMBER(24, settled, "settled", "%", "change of the response that counts as none", 0.1f, 100,
           10),
    NUMBER(25, doubt, "doubt", "-", "times a standard deviation counts", 0, 100, 3),
    NUMBER(26, confident, "confident", "%", "of the ratio, most that it may be doubted", 1, 1000,
           50),
    NUMBER(27, better, "better", "%", "least by which a candidate lowers the squares", 0, 100, 10),
    NUMBER(28, kick, "kick", "-", "most by which the element amplifies a jump", 1, 100, 10),
    NUMBER(29, lag_most_s, "lag_most", "s", "of the element", 0, 1e6f, 600),
    NUMBER(30, dead_most_s, "dead_most", "s", "of the element; 0: without", 0, 1e5f, 600),
    WORD(31, alone, "alone", "off|on", "feedforward off while the disturbance is identified", 0),
    WORD(32, adopt, "adopt", "ask|at_once", "what was found", TUNE_ADOPT_ASKED),
    WORD(33, protect, "protect", "off|on", "off by itself where the loop is worse for it", 1),
    WORD(34, begin, "begin", "asked|at_once", "when it acts for the first time", 0),
    COUNT(35, tries, "tries", "-", "times it may have been worse before it stays off", 0, 100, 3),
    COUNT(36, smooth, "smooth", "samples",
          "two lags in series on all signals before they are learnt from; 0: none", 0, 100, 6),
    WORD(37, rules, "rules", "compare|fall_back",
         "Shinskey's, tested where the search is unsure or does no better", 1),
    COUNT(TUNE_ID_BLOCK, block, "block", "-", "number of the leadlag with the term; 0: an ff", 0,
          CONFIG_BLOCKS, 0),
    NUMBER(TUNE_ID_K, k, "k", "span/span", "what the element has", -100, 100, 0),
    NUMBER(TUNE_ID_K + 1, lead_s, "lead", "s", "what the element has", 0, 1e6f, 0),
    NUMBER(TUNE_ID_K + 2, lag_s, "lag", "s", "what the element has", 0, 1e6f, 0),
    NUMBER(TUNE_ID_K + 3, dead_s, "dead", "s", "what the element has", 0, 1e6f, 0),
};
_Static_assert(TUNE_ID_K + 3 <= 63, "ids end at 63");

/* ---- what they come to ---- */

static float tune_period_ticks(const struct block_setup *setup)
{
    const struct tune_settings *s = setup->settings;
    return step_period_ticks(s->period_s, setup->interval_s);
}

static uint32_t tune_ticks(const struct block_setup *setup)
{
    return step_period_rounded(tune_period_ticks(setup));
}

static uint8_t small(uint16_t n)
{
    return (uint8_t)(n < 255u ? n : 255u);
}

static void order_of(const uint16_t order[3], uint8_t inputs, const struct high_order_shape *source,
                     unsigned j, struct high_order_shape *shape)
{
    REFLUX_ASSERT(j < HIGH_ORDER_INPUTS);
    bool set = order[1] > 0;
    shape->inputs = inputs;
    if (j == 0)
        shape->na = set ? small(order[0]) : source->na;
    shape->nb[j] = set ? small(order[1]) : source->nb[j];
    shape->delay[j] = set ? small(order[2]) : source->delay[j];
}

void tune_shapes(const struct tune_settings *s, struct high_order_shape shape[2])
{
    const struct high_order_shape *disturbance =
        s->method == TUNE_INPUT ? &high_order_siddha_input : &high_order_siddha_sensitivity;
    shape[0] = shape[1] = (struct high_order_shape){0};
    if (s->method == TUNE_JOINT) {
        order_of(s->order[0], 2, &high_order_siddha_joint, 0, &shape[1]);
        order_of(s->order[1], 2, &high_order_siddha_joint, 1, &shape[1]);
        return;
    }
    order_of(s->order[0], 1,
             s->method == TUNE_SENSITIVITY ? &high_order_siddha_process
                                           : &high_order_siddha_tracking,
             0, &shape[0]);
    order_of(s->order[1], 1, disturbance, 0, &shape[1]);
}

struct high_order_settings tune_rules(const struct tune_settings *s)
{
    return (struct high_order_settings){.forgetting = s->forgetting,
                                        .forget = s->forget,
                                        .forget_least = s->forget_least,
                                        .memory = s->memory,
                                        .sigma0 = s->memory,
                                        .trace = s->trace,
                                        .p0 = s->p0};
}

/* Pieces of work for each second of a step, as the experiment has them. */
#define PIECES_A_SECOND 100.0f
#define PIECES_MOST     1000.0f

void tune_context_take(struct tune_context *c, const struct block_setup *setup)
{
    float pieces = PIECES_A_SECOND * setup->interval_s;
    memcpy(&c->s, setup->settings, sizeof c->s);
    c->ticks = (uint16_t)tune_ticks(setup);
    c->tick_s = setup->interval_s;
    c->h_s = setup->interval_s * (real_t)c->ticks;
    c->pieces = (uint16_t)(pieces < 1 ? 1 : pieces < PIECES_MOST ? pieces : PIECES_MOST);
    c->y_signal = setup->input[0];
    c->d_signal = setup->input[1];
    tune_shapes(&c->s, c->shape);
}

uint32_t tune_model_bytes(const struct tune_settings *s)
{
    struct high_order_shape shape[2];
    tune_shapes(s, shape);
    uint32_t one = shape[0].inputs ? high_order_bytes(&shape[0]) : 0;
    uint32_t two = high_order_bytes(&shape[1]);
    return one > two ? one : two;
}

uint32_t tune_samples_in(const struct tune_context *c, float seconds)
{
    float n = seconds / (float)c->h_s;
    return n < 1 ? 1u : n > 1e8f ? 100000000u : (uint32_t)n;
}

bool tune_is_known(const struct tune_context *c, const struct high_order_point *p)
{
    return c->s.doubt * p->sd < cplx_abs(p->value);
}

real_t tune_dead_reach(const struct tune_context *c)
{
    return c->h_s * (real_t)(SHADOW_REACH - 2u);
}

/* ---- check ---- */

static bool same_span(const struct block_signal *a, const struct block_signal *b)
{
    return a->lo == b->lo && a->hi == b->hi;
}

static enum err check_tuning_inputs(const struct block_setup *setup, struct block_fault *fault)
{
    if (setup->inputs != 2 || setup->input[0].is_mv || !same_span(&setup->input[0], &setup->pv[0]))
        return block_refuse(fault, 0, "inputs", "needs the PV of the loop, then the disturbance");
    if (!setup->member[0].drives_mv)
        return block_refuse(fault, 0, "loops", "needs a loop that drives an MV");
    return ERR_OK;
}

static enum err check_models(const struct block_setup *setup, struct block_fault *fault)
{
    const struct tune_settings *s = setup->settings;
    struct high_order_shape shape[2];
    struct high_order_settings rules = tune_rules(s);
    const char *wanted;
    tune_shapes(s, shape);
    for (unsigned k = 0; k < 2; k++)
        if (shape[k].inputs && high_order_check(&shape[k], &rules, NULL, &wanted) != ERR_OK)
            return block_refuse(fault, 0, "order",
                                "needs up to 35 parameters, and delay with nb up to 100 samples");
    float h = setup->interval_s * (float)tune_ticks(setup);
    if (!(s->learn_s >= 4 * h * (float)high_order_parameters(&shape[1])))
        return block_refuse(fault, 0, "learn", "must be four samples for each parameter or more");
    if (!(s->check_s >= 4 * h * TUNE_PARTS))
        return block_refuse(fault, 0, "check", "must be 32 samples or more");
    if ((s->step > 0 && !(s->step_period_s >= 4 * h)) ||
        (s->disturb > 0 && !(s->disturb_period_s >= 4 * h)))
        return block_refuse(fault, 0,
                            s->step > 0 && !(s->step_period_s >= 4 * h) ? "step_period"
                                                                        : "disturb_period",
                            "must be four samples or more");
    return ERR_OK;
}

static enum err check_tuning_band(const struct block_setup *setup, struct block_fault *fault)
{
    const struct tune_settings *s = setup->settings;
    float h = setup->interval_s * (float)tune_ticks(setup);
    bool none = !(s->band_lo > 0) && !(s->band_hi > 0);
    if (!none && !(s->band_lo > 0 && s->band_hi > s->band_lo))
        return block_refuse(fault, 0, "band_hi", "must be above band_lo, or both 0");
    if (!none && !(s->band_hi * h <= 2.8f))
        return block_refuse(fault, 0, "band_hi", "must be at most 2.8 rad per sample");
    return ERR_OK;
}

static enum err check_tuning_sizes(const struct block_setup *setup, struct block_fault *fault)
{
    const struct tune_settings *s = setup->settings;
    const struct block_signal *y = &setup->input[0], *d = &setup->input[1];
    if (!(s->gain > 0 || s->gain < 0))
        return block_refuse(fault, 0, "gain", "needs that of the loop's PI, with its sign");
    if (s->method != TUNE_JOINT && !(s->ti_s > 0))
        return block_refuse(fault, 0, "ti", "needs that of the loop's PI");
    if (!(s->step <= 0.5f * (y->hi - y->lo)))
        return block_refuse(fault, 0, "step", "must be up to half the span of the PV");
    if (s->disturb > 0 && !(d->is_mv && s->disturb <= 0.5f * (d->hi - d->lo)))
        return block_refuse(fault, 0, "disturb",
                            "needs a disturbance that is an MV, and up to half its span");
    if (!(s->lead_s <= 100 * (s->lag_s + setup->interval_s)))
        return block_refuse(fault, 0, "lead", "must be at most 100 times lag and a base tick");
    return ERR_OK;
}

enum err tune_check(const struct block_setup *setup, struct block_fault *fault)
{
    enum err err = check_tuning_inputs(setup, fault);
    if (!err)
        err = step_period_check(tune_period_ticks(setup), fault);
    if (!err)
        err = check_tuning_sizes(setup, fault);
    if (!err)
        err = check_tuning_band(setup, fault);
    return err ? err : check_models(setup, fault);
}
