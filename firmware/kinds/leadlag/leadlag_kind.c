#include "kinds/leadlag/leadlag.h"

#include <string.h>

#include "base/assertion.h"
#include "base/channel.h"
#include "block/feedforward.h"
#include "block/refuse.h"
#include "signal/washout.h"

struct leadlag_term {
    struct feedforward element;
    struct washout washout;
    float dead_s, reference;
    /* The input as it counts for this term. */
    num_t d, dead_band;
    /* Input, MV, and number in the settings, from 0. */
    uint8_t from, to, number;
};

_Static_assert(LEADLAG_TERMS == SWITCH_OFF_TERMS, "rows of so many values are those of the terms");

struct leadlag {
    struct leadlag_term term[LEADLAG_TERMS];
    uint8_t terms, inputs, mvs;
    bool washes;
    bool begun;
    /* The last good inputs. */
    num_t d[LEADLAG_INPUTS];
    /* Steps without a good one. */
    uint32_t missing[LEADLAG_INPUTS];
    uint32_t hold_steps;
    num_t lo[LEADLAG_MVS], hi[LEADLAG_MVS];
    /* Largest move in a step. */
    float step[LEADLAG_MVS];
    num_t given[LEADLAG_MVS];
    /* Terms that were switched off in the last step. */
    uint8_t silenced;
    /* behind it the rings of the terms, one after the other */
};

enum { EVENT_LOST, EVENT_LIMIT, LEADLAG_EVENTS };

#define AT(field) offsetof(struct leadlag_settings, field)

static const struct block_parameter leadlag_parameters[] = {
    {1, BLOCK_U16, AT(from), 1, LEADLAG_TERMS, "from", "-",
     "of each term: number of the input; 0: no term", 0, LEADLAG_INPUTS, 0},
    {2, BLOCK_U16, AT(to), 1, LEADLAG_TERMS, "to", "-", "of each term: number of the MV", 0,
     LEADLAG_MVS, 0},
    {TERM_GAIN, BLOCK_FLOAT, AT(gain), 1, LEADLAG_TERMS, "gain", "-",
     "MV span per span of the input; 0: off", -100, 100, 0},
    {TERM_LEAD, BLOCK_FLOAT, AT(lead_s), 1, LEADLAG_TERMS, "lead", "s", "lead times", 0, 1e5f, 0},
    {TERM_LAG, BLOCK_FLOAT, AT(lag_s), 1, LEADLAG_TERMS, "lag", "s", "lag times", 0, 1e5f, 0},
    {TERM_DEAD, BLOCK_FLOAT, AT(dead_s), 1, LEADLAG_TERMS, "dead", "s", "dead times, exact", 0,
     1e5f, 0},
    {7, BLOCK_FLOAT, AT(reference), 1, LEADLAG_TERMS, "reference", "EU",
     "value of the input that calls for nothing", -1e9f, 1e9f, 0},
    {8, BLOCK_FLOAT, AT(lo), 1, LEADLAG_MVS, "lo", "-", "least that is added to each MV", -1, 1,
     -1},
    {9, BLOCK_FLOAT, AT(hi), 1, LEADLAG_MVS, "hi", "-", "most that is added to each MV", -1, 1, 1},
    {10, BLOCK_FLOAT, AT(rate), 1, LEADLAG_MVS, "rate", "1/s",
     "how fast what is added moves, of the MV's span; 0: any", 0, 1e3f, 0},
    {11, BLOCK_FLOAT, AT(kick), 1, 1, "kick", "-",
     "largest lead/(lag + base tick): how much more a jump is at first than at rest", 1, 100, 100},
    {12, BLOCK_FLOAT, AT(washout_s), 1, 1, "washout", "s",
     "what stays so long calls for less and less; 0: none", 0, 1e6f, 0},
    {13, BLOCK_FLOAT, AT(hold_s), 1, 1, "hold", "s",
     "how long an input that is lost stays what it was, before the element gives up", 0, 1e6f, 0},
    {14, BLOCK_FLOAT, AT(dead_band), 1, LEADLAG_TERMS, "dead_band", "EU",
     "of each term: noise of the input within +/- so much moves nothing; 0: none", 0, 1e9f, 0},
};

/* ---- settings ---- */

static bool is_term(const struct leadlag_settings *c, unsigned k)
{
    return c->from[k] > 0;
}

static struct feedforward_settings element_of(const struct block_setup *setup, unsigned k)
{
    REFLUX_ASSERT(k < LEADLAG_TERMS);
    const struct leadlag_settings *c = setup->settings;
    const struct block_signal *d = &setup->input[c->from[k] - 1u];
    return (struct feedforward_settings){.gain = c->gain[k],
                                         .lead_s = c->lead_s[k],
                                         .lag_s = c->lag_s[k],
                                         .dead_time_s = c->dead_s[k],
                                         .reference = (c->reference[k] - d->lo) / (d->hi - d->lo),
                                         .out_lo = -2,
                                         .out_hi = 2};
}

/* Returns the dead band as a fraction of the input's span. */
static float dead_band_of(const struct block_setup *setup, unsigned k)
{
    REFLUX_ASSERT(k < LEADLAG_TERMS);
    const struct leadlag_settings *c = setup->settings;
    const struct block_signal *d = &setup->input[c->from[k] - 1u];
    return c->dead_band[k] / (d->hi - d->lo);
}

static enum err check_term(const struct block_setup *setup, unsigned k, struct block_fault *fault)
{
    const struct leadlag_settings *c = setup->settings;
    if (c->from[k] > setup->inputs)
        return block_refuse(fault, 0, "from", "must be the number of an input that there is");
    if (c->to[k] < 1 || c->to[k] > setup->points)
        return block_refuse(fault, 0, "to", "must be the number of an MV that there is");
    if (c->lead_s[k] / (c->lag_s[k] + setup->interval_s) > c->kick)
        return block_refuse(fault, 0, "lead", "is more than kick allows: lead/(lag + base tick)");
    const struct feedforward_settings element = element_of(setup, k);
    if (!(element.reference >= -1 && element.reference <= 2))
        return block_refuse(fault, 0, "reference", "must be within a span of the input's range");
    if (!(dead_band_of(setup, k) <= 1))
        return block_refuse(fault, 0, "dead_band", "must be at most the input's span");
    const char *field, *wanted;
    if (feedforward_validate(&element, setup->interval_s, &field, &wanted))
        return block_refuse(fault, 0, "dead", "must be at most 100000 base ticks");
    return ERR_OK;
}

static enum err leadlag_check(const struct block_setup *setup, struct block_fault *fault)
{
    const struct leadlag_settings *c = setup->settings;
    unsigned terms = 0;
    if (setup->inputs < 1)
        return block_refuse(fault, 0, "inputs", "needs a disturbance at least");
    if (setup->points < 1)
        return block_refuse(fault, 0, "points", "needs an MV at least that it adds to");
    for (unsigned k = 0; k < LEADLAG_TERMS; k++) {
        if (!is_term(c, k))
            continue;
        enum err err = check_term(setup, k, fault);
        if (err)
            return err;
        terms++;
    }
    if (!terms)
        return block_refuse(fault, 0, "from", "needs a term at least: the number of its input");
    for (unsigned p = 0; p < setup->points; p++)
        if (!(c->lo[p] <= 0 && c->hi[p] >= 0 && c->lo[p] < c->hi[p]))
            return block_refuse(fault, 0, "hi", "needs a range around 0 with lo");
    return ERR_OK;
}

static uint32_t ring_bytes(const struct block_setup *setup, unsigned k)
{
    const struct leadlag_settings *c = setup->settings;
    if (!is_term(c, k) || c->from[k] > setup->inputs)
        return 0;
    const struct feedforward_settings element = element_of(setup, k);
    return (uint32_t)feedforward_bytes(&element, setup->interval_s);
}

static uint32_t leadlag_bytes(const struct block_setup *setup)
{
    size_t bytes = sizeof(struct leadlag);
    for (unsigned k = 0; k < LEADLAG_TERMS; k++)
        bytes += ring_bytes(setup, k);
    return (uint32_t)((bytes + 7u) & ~(size_t)7u);
}

static bool is_same_number(float a, float b)
{
    return a <= b && a >= b;
}

/* Only gains, leads and lags have changed: what is under way goes on. */
static bool has_same_terms(const struct leadlag *s, const struct block_setup *setup)
{
    const struct leadlag_settings *c = setup->settings;
    unsigned n = 0;
    for (unsigned k = 0; k < LEADLAG_TERMS; k++) {
        if (!is_term(c, k))
            continue;
        const struct leadlag_term *t = &s->term[n++];
        if (n > s->terms || t->from + 1u != c->from[k] || t->to + 1u != c->to[k] ||
            !is_same_number(t->dead_s, c->dead_s[k]) ||
            !is_same_number(t->reference, element_of(setup, k).reference))
            return false;
    }
    return n == s->terms;
}

/* Takes another gain, lead, lag and washout; dead time, reference and what is under way stay. */
static enum err retune_term(const struct block_setup *setup, unsigned k, struct leadlag_term *t)
{
    const struct leadlag_settings *c = setup->settings;
    const struct feedforward_settings element = element_of(setup, k);
    enum err err = washout_retune(&t->washout, 1, c->washout_s, c->washout_s, setup->interval_s);
    return err ? err : feedforward_retune(&t->element, &element, setup->interval_s);
}

static enum err make_term(const struct block_setup *setup, unsigned k, struct leadlag_term *t,
                          num_t *ring)
{
    const struct leadlag_settings *c = setup->settings;
    const struct feedforward_settings element = element_of(setup, k);
    t->from = (uint8_t)(c->from[k] - 1u);
    t->to = (uint8_t)(c->to[k] - 1u);
    t->dead_s = c->dead_s[k];
    t->reference = element.reference;
    enum err err = washout_init(&t->washout, 1, c->washout_s, c->washout_s, setup->interval_s);
    return err ? err
               : feedforward_init(&t->element, &element, setup->interval_s, ring,
                                  ring_bytes(setup, k));
}

static void take_leadlag_limits(struct leadlag *s, const struct block_setup *setup)
{
    const struct leadlag_settings *c = setup->settings;
    s->inputs = setup->inputs;
    s->mvs = setup->points;
    s->washes = c->washout_s > 0;
    s->hold_steps = (uint32_t)(c->hold_s / setup->interval_s);
    for (unsigned p = 0; p < s->mvs; p++) {
        float step = c->rate[p] * setup->interval_s;
        s->lo[p] = num_from_float(c->lo[p]);
        s->hi[p] = num_from_float(c->hi[p]);
        s->step[p] = step > 0 ? step : 4.0f;
    }
}

static enum err leadlag_configure(void *state, const struct block_setup *setup, bool retune)
{
    REFLUX_ASSERT(setup->inputs <= LEADLAG_INPUTS && setup->points <= LEADLAG_MVS);
    struct leadlag *s = state;
    const struct leadlag_settings *c = setup->settings;
    bool goes_on = retune && has_same_terms(s, setup);
    if (!goes_on)
        memset(s, 0, sizeof *s);
    take_leadlag_limits(s, setup);
    num_t *ring = (num_t *)(void *)(s + 1);
    uint8_t n = 0;
    for (unsigned k = 0; k < LEADLAG_TERMS; k++) {
        if (!is_term(c, k))
            continue;
        struct leadlag_term *t = &s->term[n++];
        t->number = (uint8_t)k;
        t->dead_band = num_from_float(dead_band_of(setup, k));
        enum err err = goes_on ? retune_term(setup, k, t) : make_term(setup, k, t, ring);
        if (err)
            return err;
        ring = feedforward_place_ring(&t->element, ring);
    }
    s->terms = n;
    return ERR_OK;
}

/* ---- steps ---- */

/* The state may stand elsewhere than in the last call. */
static void stand_rings(struct leadlag *s)
{
    REFLUX_ASSERT(s->terms <= LEADLAG_TERMS && s->inputs <= LEADLAG_INPUTS &&
                  s->mvs <= LEADLAG_MVS);
    num_t *ring = (num_t *)(void *)(s + 1);
    for (unsigned k = 0; k < s->terms; k++)
        ring = feedforward_place_ring(&s->term[k].element, ring);
}

/* Takes the inputs as they count: a bad one stays what it was. Returns true when one has been bad for too long. */
static bool take_disturbances(struct leadlag *s, struct block_io *io)
{
    bool lost = false;
    for (unsigned k = 0; k < s->inputs; k++) {
        bool good = quality_usable((enum quality)io->inputs.quality[k]);
        if (good || !s->begun) {
            s->d[k] = io->inputs.value[k];
            s->missing[k] = 0;
        } else {
            s->missing[k]++;
            io->requests.raised |= 1u << EVENT_LOST;
            io->requests.event_value[EVENT_LOST] = (float)(k + 1u);
            lost = lost || s->missing[k] > s->hold_steps;
        }
        lost = lost || (!good && !s->begun);
    }
    return lost;
}

static void begin_at_rest(struct leadlag *s)
{
    for (unsigned k = 0; k < s->terms; k++) {
        struct leadlag_term *t = &s->term[k];
        REFLUX_ASSERT(t->from < s->inputs);
        t->d = s->d[t->from];
        feedforward_reset(&t->element, t->d);
        washout_reset(&t->washout, feedforward_output(&t->element));
    }
    s->begun = true;
}

static void sum_terms(struct leadlag *s, struct accumulator *sum)
{
    for (unsigned k = 0; k < s->terms; k++) {
        struct leadlag_term *t = &s->term[k];
        REFLUX_ASSERT(t->from < s->inputs && t->to < s->mvs);
        num_t d = s->d[t->from];
        t->d = num_clamp(t->d, num_sub(d, t->dead_band), num_add(d, t->dead_band));
        num_t u = feedforward_step(&t->element, t->d);
        u = s->washes ? washout_step(&t->washout, u) : u;
        if (!(s->silenced & 1u << t->number))
            accumulator_add(&sum[t->to], u);
    }
}

/* Keeps an output within the limits and no faster than the rate. One that jumps has no rate. */
static num_t limited_output(const struct leadlag *s, unsigned p, num_t asked, bool jumps)
{
    REFLUX_ASSERT(p < s->mvs);
    num_t u = num_clamp(asked, s->lo[p], s->hi[p]);
    if (jumps)
        return u;
    num_t step = num_from_float(s->step[p]);
    return num_clamp(u, num_sub(s->given[p], step), num_add(s->given[p], step));
}

static void give(struct leadlag *s, struct block_io *io, bool jumps)
{
    struct accumulator sum[LEADLAG_MVS];
    for (unsigned p = 0; p < s->mvs; p++)
        accumulator_set(&sum[p], num_zero());
    sum_terms(s, sum);
    for (unsigned p = 0; p < s->mvs; p++) {
        num_t asked = accumulator_get(&sum[p]);
        s->given[p] = limited_output(s, p, asked, jumps);
        if (!num_eq(s->given[p], asked)) {
            io->requests.raised |= 1u << EVENT_LIMIT;
            io->requests.event_value[EVENT_LIMIT] = (float)(p + 1u);
        }
        io->members.out[p] = s->given[p];
    }
}

static void leadlag_step(void *state, struct block_io *io)
{
    struct leadlag *s = state;
    stand_rings(s);
    bool begins = !s->begun;
    bool jumps = begins || s->silenced != io->requests.silenced; /* the loops make room for it */
    s->silenced = io->requests.silenced;
    if (take_disturbances(s, io)) {
        s->begun = false;
        io->requests.gives_up = "input";
        return;
    }
    if (begins)
        begin_at_rest(s);
    give(s, io, jumps);
}

static void leadlag_follow(void *state, struct block_io *io)
{
    struct leadlag *s = state;
    (void)io;
    s->begun = false; /* it begins with the inputs of its first step */
}

static const char *leadlag_describe(const void *state, size_t i, float *value)
{
    static const char *const added[LEADLAG_MVS] = {"added_1", "added_2", "added_3", "added_4"};
    static const char *const of_term[LEADLAG_TERMS] = {"term_1", "term_2", "term_3", "term_4",
                                                       "term_5", "term_6", "term_7", "term_8"};
    const struct leadlag *s = state;
    if (i < s->mvs) {
        *value = num_to_float(s->given[i]);
        return added[i];
    }
    i -= s->mvs;
    if (i >= s->terms)
        return NULL;
    *value = num_to_float(feedforward_output(&s->term[i].element));
    return of_term[i];
}

static const struct block_event leadlag_events[LEADLAG_EVENTS] = {
    [EVENT_LOST] = {"lost", BLOCK_ALARM, "an input stays what it was, number of the input"},
    [EVENT_LIMIT] = {"limit", BLOCK_INFO,
                     "what is added is at a limit or moves as fast as it may, number of the MV"},
};

const struct block_kind leadlag_kind = {
    .name = "leadlag",
    .stage = STAGE_FEED_FORWARD,
    .parameter = leadlag_parameters,
    .parameters = sizeof leadlag_parameters / sizeof leadlag_parameters[0],
    .settings_bytes = sizeof(struct leadlag_settings),
    .inputs_most = LEADLAG_INPUTS,
    .points_most = LEADLAG_MVS,
    .bad_input = BAD_INPUT_IS_TOLD,
    .event = leadlag_events,
    .events = LEADLAG_EVENTS,
    .bytes = leadlag_bytes,
    .check = leadlag_check,
    .configure = leadlag_configure,
    .step = leadlag_step,
    .follow = leadlag_follow,
    .describe = leadlag_describe,
};
