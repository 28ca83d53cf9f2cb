#include "kinds/inferential/inferential.h"

#include <string.h>

#include "base/assertion.h"
#include "kinds/inferential/inferential_state.h"

/* An output that is cut by less, fraction of span, has not been cut: rounding behind a compensator. */
#define CUT 1e-4f

static bool uses_second(uint8_t law)
{
    return law == LAW_CASCADE || law == LAW_CLF;
}

static const struct inferential_coefficients *coefficients(const struct inferential *s)
{
    return uses_second(s->acts) ? &s->pair : &s->alone;
}

/* ---- what the law gives ---- */

static struct accumulator away_of_second(const struct inferential *s)
{
    struct accumulator away;
    accumulator_set(&away, num_sub(s->t2, s->from2));
    accumulator_take_sum(&away, &s->wanted);
    return away;
}

/* -u~ for the last inputs. */
static struct accumulator secondary(const struct inferential *s)
{
    struct accumulator sum;
    accumulator_set(&sum, num_zero());
    if (uses_second(s->acts)) {
        struct accumulator away = away_of_second(s);
        accumulator_add_product(&sum, s->pair.q1, num_sub(s->t1, s->setpoint));
        accumulator_add_scaled(&sum, s->pair.q2, &away);
    }
    return sum;
}

/* Returns -u* for the last inputs, but for x1. */
static struct accumulator primary_but_load(const struct inferential *s)
{
    const struct inferential_coefficients *c = coefficients(s);
    struct accumulator sum;
    accumulator_set(&sum, num_zero());
    accumulator_add_product(&sum, c->o1, num_sub(s->t1, s->from1));
    accumulator_add_product(&sum, c->p1, num_sub(s->t1, s->setpoint));
    if (uses_second(s->acts)) {
        struct accumulator away = away_of_second(s);
        accumulator_add_scaled(&sum, c->p2, &away);
    }
    return sum;
}

/* The output for the last inputs. */
static num_t output(struct inferential *s)
{
    if (s->acts == LAW_HOLD)
        return s->primary = s->given;
    struct accumulator sum = primary_but_load(s), other = secondary(s);
    accumulator_add_sum(&sum, &s->x1);
    s->primary = num_neg(accumulator_get(&sum));
    accumulator_add_sum(&sum, &other);
    return num_neg(accumulator_get(&sum));
}

/* x1 such that the last inputs give u. */
static void meet(struct inferential *s, num_t u)
{
    struct accumulator sum = primary_but_load(s), other = secondary(s);
    accumulator_set(&s->x1, num_neg(u));
    accumulator_take_sum(&s->x1, &sum);
    accumulator_take_sum(&s->x1, &other);
}

/* T2* is where T2 is, which is taken to stand still. */
static void begin_second(struct inferential *s)
{
    s->from2 = s->t2;
    accumulator_set(&s->wanted, num_zero());
    accumulator_set(&s->x2, num_neg(s->applied));
}

/* ---- settings ---- */

static void set_config(struct inferential *s, const struct inferential_config *c)
{
    s->config = *c;
    if (c->law == LAW_HOLD)
        return;
    inferential_coefficients_of(c, false, &s->alone);
    if (uses_second(c->law))
        inferential_coefficients_of(c, true, &s->pair);
}

void inferential_init(struct inferential *s, const struct inferential_config *c)
{
    memset(s, 0, sizeof *s);
    set_config(s, c);
    s->acts = uses_second(c->law) ? (uint8_t)LAW_CONVENTIONAL : c->law;
}

/* The estimated load of the secondary, dT2/dt - a2 u, is kept, though slope and observer are others. */
static void keep_second_load(struct inferential *s, float load, float slope_before)
{
    float slope = s->config.a[SECONDARY] * s->config.u_span;
    load += (slope_before - slope) * num_to_float(s->applied);
    accumulator_set(&s->x2, num_from_float(load / slope));
    accumulator_add_product(&s->x2, s->pair.o2, num_sub(s->from2, s->t2));
}

/* Puts waiting settings in force; with these inputs they give what the settings before give. */
static void take_waiting(struct inferential *s)
{
    num_t u = output(s);
    float load = inferential_load(s, SECONDARY);
    float slope_before = s->config.a[SECONDARY] * s->config.u_span;
    uint8_t law = s->next.law;
    bool pair = uses_second(law) && uses_second(s->acts) && s->same_second;
    set_config(s, &s->next);
    s->waits = false;
    s->acts = pair || !uses_second(law) ? law : (uint8_t)LAW_CONVENTIONAL;
    if (pair)
        keep_second_load(s, load, slope_before);
    if (law == LAW_HOLD)
        s->given = u;
    meet(s, u);
}

void inferential_retune(struct inferential *s, const struct inferential_config *c, bool same_second)
{
    s->same_second = same_second && (s->same_second || !s->waits);
    s->next = *c;
    s->waits = true;
}

/* ---- steps ---- */

static uint8_t law_with(const struct inferential *s, bool second)
{
    uint8_t law = s->config.law;
    return uses_second(law) && !second ? (uint8_t)LAW_CONVENTIONAL : law;
}

void inferential_follow(struct inferential *s, num_t setpoint, num_t t1, num_t t2, bool second,
                        num_t u)
{
    if (s->waits)
        set_config(s, &s->next);
    s->waits = false;
    s->acts = law_with(s, second);
    s->setpoint = setpoint;
    s->t1 = s->from1 = t1;
    s->t2 = t2;
    s->given = s->applied = u;
    s->cut = 0;
    begin_second(s);
    meet(s, u);
}

/* Another law computes from now on; with these inputs it gives what the one before gives. */
static void change_law(struct inferential *s, uint8_t law)
{
    num_t u = output(s);
    bool begins = uses_second(law) && !uses_second(s->acts);
    s->acts = law;
    if (begins)
        begin_second(s);
    meet(s, u);
}

num_t inferential_step(struct inferential *s, num_t setpoint, num_t t1, num_t t2, bool second)
{
    s->setpoint = setpoint;
    s->t1 = t1;
    if (second && !(s->waits && !s->same_second)) /* else where it was last */
        s->t2 = t2;
    if (s->waits)
        take_waiting(s);
    if (second)
        s->t2 = t2;
    uint8_t law = law_with(s, second);
    if (law != s->acts)
        change_law(s, law);
    s->given = output(s);
    return s->given;
}

static bool is_above(num_t a, num_t b)
{
    return num_lt(num_add(b, num_from_float(CUT)), a);
}

/* x += k (x + u + o (T - from)); into *by, what is added before k multiplies it. */
static void observer_error(const struct accumulator *x, num_t u, struct coefficient o, num_t t,
                           struct accumulator *by)
{
    *by = *x;
    accumulator_add(by, u);
    accumulator_add_product(by, o, t);
}

/* u* as far as the MV goes. */
static num_t primary_in_effect(const struct inferential *s)
{
    num_t u = s->primary;
    if (s->cut > 0)
        u = num_min(u, s->applied);
    if (s->cut < 0)
        u = num_max(u, s->applied);
    return num_clamp(u, num_zero(), num_one());
}

static void second_goes_on(struct inferential *s)
{
    struct accumulator by;
    observer_error(&s->x2, primary_in_effect(s), s->pair.o2, num_sub(s->t2, s->from2), &by);
    accumulator_add_scaled(&s->wanted, s->pair.g2, &by);
    observer_error(&s->x2, s->applied, s->pair.o2, num_sub(s->t2, s->from2), &by);
    accumulator_add_scaled(&s->x2, s->pair.k, &by);
}

void inferential_back_calculate(struct inferential *s, num_t applied, uint8_t clamp)
{
    struct accumulator by;
    s->applied = applied;
    s->cut = is_above(s->given, applied) ? 1 : is_above(applied, s->given) ? -1 : 0;
    if (s->acts == LAW_HOLD)
        return;
    if (uses_second(s->acts))
        second_goes_on(s);
    observer_error(&s->x1, applied, s->alone.o1, num_sub(s->t1, s->from1), &by);
    num_t up = accumulator_get(&by); /* x falls, and u rises */
    if (((clamp & INTEGRAL_CLAMP_UP) && num_lt(num_zero(), up)) ||
        ((clamp & INTEGRAL_CLAMP_DOWN) && num_lt(up, num_zero())))
        return;
    accumulator_add_scaled(&s->x1, s->alone.k, &by);
}

/* ---- what it shows ---- */

float inferential_load(const struct inferential *s, unsigned i)
{
    REFLUX_ASSERT(i < 2);
    struct accumulator sum = i == PRIMARY ? s->x1 : s->x2;
    if (i == SECONDARY && !uses_second(s->acts))
        return 0;
    accumulator_add_product(&sum, i == PRIMARY ? s->alone.o1 : s->pair.o2,
                            i == PRIMARY ? num_sub(s->t1, s->from1) : num_sub(s->t2, s->from2));
    return num_to_float(accumulator_get(&sum)) * s->config.a[i] * s->config.u_span;
}

num_t inferential_away(const struct inferential *s)
{
    struct accumulator away = away_of_second(s);
    return uses_second(s->acts) ? accumulator_get(&away) : num_zero();
}

const struct inferential_config *inferential_config(const struct inferential *s)
{
    return &s->config;
}

uint8_t inferential_acts(const struct inferential *s)
{
    return s->acts;
}

num_t inferential_applied(const struct inferential *s)
{
    return s->applied;
}

struct inferential_inner inferential_inner(const struct inferential *s)
{
    return (struct inferential_inner){.y1 = num_sub(s->t1, s->setpoint),
                                      .primary = s->primary,
                                      .secondary = num_sub(s->given, s->primary),
                                      .cut = s->cut};
}
