#include "identify/relay.h"

#include <string.h>

#include "base/assertion.h"
#include "identify/common.h"
#include "lti/fopdt.h" /* real_is_finite */
#include "num/real_trig.h"

#define PI          REAL_C(3.14159265358979)
#define OUT_SAMPLES 2u           /* in a row out of the hysteresis: noise is not */
#define SAME_HALF   REAL_C(0.1)  /* of a half: two that agree */
#define SAME_PEAK   REAL_C(0.03) /* of the way between the peaks */
#define SAME_GAIN   REAL_C(0.2)  /* of the gain */
#define PEAK_NOISE  REAL_C(3.0)  /* deviations: and of its noise */
/* If the halves of a period differ by more than this part of it, the bias is moved. */
#define UNEVEN       REAL_C(0.15)
#define STUCK        6u /* times the longest half before */
#define PERIODS_MOST 24u
#define GROWTH_MOST  REAL_C(4.0)
#define LIMIT_SHARE  REAL_C(0.7) /* of a limit that a new amplitude may aim at */
#define SHRINK_SHARE REAL_C(0.9) /* of a limit from which on the amplitude is made smaller */
#define HALF_LARGEST (1u << 28)
/* Part of the room for an amplitude that is to be found: the rest is for the bias. */
#define FOUND_SHARE REAL_C(0.5)
#define BACK_LEAST  REAL_C(0.2) /* of |G|: what of the output comes back against the input */
#define BACK_FULL   REAL_C(0.8)
/* Parts of the way that the output has gone away from where it is asked: it turns back by itself; or goes on, the input turned round, by
 * more than dead time explains. */
#define TURNING_SHARE REAL_C(0.8)
#define AWAY_SHARE    REAL_C(1.5)
#define BACK_TIMES    2u /* as long as it went away it may take to come back to the other side */
#define AGAIN_TIMES   2u /* as long as it came back it may take to go away again */
/* Several lags in a row go on so many times as long as it took to leave, the input turned. */
#define COASTS 4u

static bool positive_up_to(real_t x, real_t most)
{
    return x > ZERO && x <= most;
}

enum err relay_begin(struct relay *r, const struct relay_config *c)
{
    memset(r, 0, sizeof *r);
    enum err err = check_real(c->h_s, REAL_C(1e-3), REAL_C(1e5));
    if (!err)
        err = check_real(c->reference, -VALUE_MAX, VALUE_MAX);
    if (!err)
        err = check_real(c->noise_sd, ZERO, ONE);
    if (!err)
        err = check_real(c->amplitude, ZERO, ONE);
    if (!err)
        err = check_real(c->drift, -ONE, ONE);
    if (err)
        return err;
    if (!positive_up_to(c->hysteresis, ONE) || !positive_up_to(c->most, ONE) ||
        !positive_up_to(c->wanted, ONE) || !positive_up_to(c->first, c->most) ||
        c->amplitude > c->most || c->patience == 0 || c->half_most <= c->patience ||
        c->half_most > HALF_LARGEST || (c->sign != 1 && c->sign != -1))
        return ERR_RANGE;
    r->config = *c;
    r->high = true;
    r->amplitude = c->amplitude > ZERO ? c->amplitude : c->first;
    return ERR_OK;
}

static void fail_with(struct relay *r, enum relay_failure failure)
{
    r->phase = RELAY_FAILED;
    r->failure = failure;
    r->level = ZERO;
}

static bool is_found(const struct relay *r)
{
    return r->config.amplitude <= ZERO;
}

/* Input for the side that is asked for; upwards of the output is downwards of the input where the gain is below 0. */
static void put_level(struct relay *r)
{
    bool up = (r->high != r->turned) == (r->config.sign > 0);
    r->level = r->bias + (up ? r->amplitude : -r->amplitude);
}

static void begin_period(struct relay *r, uint32_t samples)
{
    memset(&r->present, 0, sizeof r->present);
    r->share = ZERO;
    r->present.block = 1u + samples / (RELAY_POINTS * 3u / 4u);
    r->present.whole = true;
}

/* The sample that has just begun, with the input that goes with it. */
static void count_sample(struct relay *r, real_t y)
{
    REFLUX_ASSERT(r->present.block >= 1);
    struct relay_period *p = &r->present;
    real_t away = y - r->config.reference;
    uint32_t point = p->samples / p->block;
    p->samples++;
    p->high += r->high;
    p->mean += away;
    if (away > p->top) /* 0 at first: every whole period goes beyond it on both sides */
        p->top = away;
    if (away < p->bottom)
        p->bottom = away;
    if (point < RELAY_POINTS)
        p->y[point] += away;
    else
        p->whole = false; /* much longer than the one before: nothing to go by */
}

static bool agree(uint32_t a, uint32_t b, real_t share)
{
    real_t apart = (real_t)(a > b ? a - b : b - a);
    return apart <= ONE + share * (real_t)b;
}

static bool is_same(const struct relay *r, const struct relay_period *a,
                    const struct relay_period *b)
{
    /* Samples are where they are: a peak may be missed by the way of one. */
    real_t way = b->top - b->bottom, sample = TWO * way / (real_t)b->samples;
    real_t most = SAME_PEAK * way + PEAK_NOISE * r->config.noise_sd + sample;
    /* Noise switches early or late by its share of the way. */
    real_t half = SAME_HALF + PEAK_NOISE * r->config.noise_sd / way;
    return agree(a->high, b->high, half) &&
           agree(a->samples - a->high, b->samples - b->high, half) &&
           real_abs(a->top - b->top) <= most && real_abs(a->bottom - b->bottom) <= most;
}

/* Halves of different lengths: the load asks for another mean of the input. */
static bool move_bias(struct relay *r, const struct relay_period *p)
{
    real_t more = TWO * (real_t)p->high - (real_t)p->samples;
    if (real_abs(more) <= UNEVEN * (real_t)p->samples + TWO)
        return false;
    real_t uneven = more / (real_t)p->samples;
    real_t room = r->config.most - r->amplitude;
    real_t bias = r->bias + (r->config.sign > 0 ? uneven : -uneven) * r->amplitude;
    bias = bias > room ? room : bias < -room ? -room : bias;
    if (real_abs(bias - r->bias) < REAL_C(0.01) * r->amplitude)
        return false; /* no room left: what is uneven stays so */
    r->bias = bias;
    return true;
}

/* Another amplitude where the cycle is too small to be told from noise, or too large for a limit. */
static bool change_amplitude(struct relay *r, const struct relay_period *p)
{
    if (!is_found(r))
        return false;
    real_t peak = (p->top - p->bottom) / TWO, factor = ONE;
    if (peak < r->config.wanted) {
        factor = REAL_C(1.2) * r->config.wanted / peak;
        if (factor > GROWTH_MOST)
            factor = GROWTH_MOST;
    }
    if (factor * r->share > LIMIT_SHARE && (factor > ONE || r->share > SHRINK_SHARE))
        factor = LIMIT_SHARE / r->share;
    if (peak < r->config.wanted && factor < ONE && r->share < SHRINK_SHARE)
        factor = ONE; /* would grow, and has no room */
    real_t amplitude = factor * r->amplitude, room = FOUND_SHARE * r->config.most;
    if (amplitude > room)
        amplitude = room;
    if (real_abs(amplitude - r->amplitude) < REAL_C(0.1) * r->amplitude)
        return false;
    r->amplitude = amplitude;
    return true;
}

/* sum[0] + i sum[1] of exp(-i angle n) over n from a to b - 1, times weight, on top of what is there. */
static void add_phasors(uint32_t a, uint32_t b, real_t angle, real_t weight, real_t sum[2])
{
    real_t half, width, unused, c, s;
    real_sincos(REAL_C(0.5) * angle, &half, &unused);
    real_sincos(REAL_C(0.5) * angle * (real_t)(b - a), &width, &unused);
    real_sincos(REAL_C(0.5) * angle * (real_t)(a + b - 1u), &s, &c);
    sum[0] += weight * width / half * c;
    sum[1] -= weight * width / half * s;
}

/* G at the frequency of two periods in a row: first harmonic of the output over that of the input, which is up for the first
 * `high` samples. Two, because a cycle of few samples may have every other period a sample longer. */
static enum err ratio(const struct relay *r, unsigned first, real_t g[2])
{
    REFLUX_ASSERT(first + 1u < RELAY_PERIODS);
    const struct relay_period *p = &r->period[first];
    if (!p[0].whole || !p[1].whole)
        return ERR_RANGE;
    real_t y[2] = {ZERO, ZERO}, u[2] = {ZERO, ZERO}, up = r->config.sign > 0 ? ONE : -ONE;
    real_t all = (real_t)(p[0].samples + p[1].samples), angle = REAL_C(4.0) * PI / all;
    real_t mean = (p[0].mean * (real_t)p[0].samples + p[1].mean * (real_t)p[1].samples) / all;
    uint32_t start = 0;
    for (unsigned k = 0; k < 2; k++, p++) {
        for (uint32_t i = 0, a = 0; a < p->samples; i++) {
            uint32_t b = a + p->block < p->samples ? a + p->block : p->samples;
            real_t c, s, value = p->y[i] - mean * (real_t)(b - a);
            real_sincos(angle * ((real_t)start + REAL_C(0.5) * (real_t)(a + b - 1u)), &s, &c);
            y[0] += value * c;
            y[1] -= value * s;
            a = b;
        }
        add_phasors(start, start + p->high, angle, up * r->amplitude, u);
        add_phasors(start + p->high, start + p->samples, angle, -up * r->amplitude, u);
        start += p->samples;
    }
    real_t size = u[0] * u[0] + u[1] * u[1];
    if (!(size > ZERO))
        return ERR_RANGE;
    g[0] = (y[0] * u[0] + y[1] * u[1]) / size;
    g[1] = (y[1] * u[0] - y[0] * u[1]) / size;
    return ERR_OK;
}

/* G of the latest periods, and how far its first and last two are apart. ERR_RANGE: they are not whole. */
static enum err spread_of(const struct relay *r, real_t g[2], real_t *spread)
{
    real_t before[2], after[2];
    if (ratio(r, 0, before) != ERR_OK || ratio(r, RELAY_PERIODS - 2, after) != ERR_OK)
        return ERR_RANGE;
    real_t x = before[0] - after[0], y = before[1] - after[1];
    g[0] = REAL_C(0.5) * (before[0] + after[0]);
    g[1] = REAL_C(0.5) * (before[1] + after[1]);
    real_t size = g[0] * g[0] + g[1] * g[1];
    if (!(size > ZERO))
        return ERR_RANGE;
    *spread = real_sqrt((x * x + y * y) / size);
    return ERR_OK;
}

static bool is_settled(const struct relay *r)
{
    real_t g[2], spread;
    return r->same >= RELAY_PERIODS - 1 && spread_of(r, g, &spread) == ERR_OK &&
           spread <= SAME_GAIN;
}

static void end_period(struct relay *r)
{
    struct relay_period *last = &r->period[RELAY_PERIODS - 1], *p = &r->present;
    if (p->high == 0) { /* it began with the lower half */
        begin_period(r, 0);
        return;
    }
    uint32_t low = p->samples - p->high;
    p->mean /= (real_t)p->samples;
    r->longest = p->high > low ? p->high : low;
    r->periods++;
    bool same = r->periods > 1 && is_same(r, p, last);
    bool changes = change_amplitude(r, p) || move_bias(r, p);
    p->whole = p->whole && !changes;
    r->same = (uint8_t)(same && !changes ? r->same + 1 : 0);
    for (unsigned i = 1; i < RELAY_PERIODS; i++)
        r->period[i - 1] = r->period[i];
    *last = *p;
    if (!is_settled(r)) {
        begin_period(r, last->samples);
        if (r->periods >= PERIODS_MOST)
            fail_with(r, RELAY_UNSETTLED);
    } else {
        r->phase = RELAY_DONE;
        r->level = ZERO;
    }
}

/* Towards where the output is asked, as far as there is room. */
static bool lean(struct relay *r)
{
    real_t room = r->config.most - r->amplitude;
    real_t way = r->high == (r->config.sign > 0) ? r->amplitude : -r->amplitude;
    real_t bias = r->bias + REAL_C(0.5) * way;
    bias = bias > room ? room : bias < -room ? -room : bias;
    if (real_abs(bias - r->bias) < REAL_C(0.01) * r->amplitude)
        return false;
    r->bias = bias;
    return true;
}

/* Is the output away from where it is asked, and whether by its sign is not known yet? */
static bool is_going_wrong(const struct relay *r)
{
    return r->against > 0 && !r->sign_seen;
}

static void end_turn(struct relay *r, bool sign_seen)
{
    r->turned = false;
    r->sign_seen = sign_seen;
    r->half = 0;
    r->against = 0;
}

/* While the input is turned round, and after: the wrong sign brings the output to the other side, and away again. A drift may turn
 * by itself, but hardly twice and in time. */
static void judge_sign(struct relay *r, real_t wrong)
{
    real_t hysteresis = r->config.hysteresis;
    r->against++;
    if (!r->turned) {
        if (wrong > hysteresis)
            fail_with(r, RELAY_WRONG_SIGN);
        else if (r->against > AGAIN_TIMES * r->came_back)
            end_turn(r, true);
    } else if (wrong < -hysteresis) {
        r->came_back = r->against;
        end_turn(r, false);
    } else if (r->against > BACK_TIMES * r->half || wrong > AWAY_SHARE * r->farthest) {
        end_turn(r, true);
    }
}

/* True: the sign is looked at, or is wrong, and nothing else is to be decided. */
static bool watch_sign(struct relay *r, real_t y)
{
    real_t away = y - r->config.reference - r->config.drift * (real_t)r->age++;
    real_t wrong = r->high ? -away : away;
    if (r->sign_seen)
        return false;
    if (r->turned || r->came_back > 0) {
        judge_sign(r, wrong);
        return !r->sign_seen;
    }
    if (wrong <= r->config.hysteresis) {
        r->against = 0;
        return false;
    }
    if (r->against == 0 || wrong > r->farthest)
        r->farthest = wrong;
    bool starts = r->phase == RELAY_START;
    uint32_t left_after = starts ? r->started - r->against : COASTS * r->started;
    r->against++;
    r->turned = r->against > r->config.patience + left_after && wrong > TURNING_SHARE * r->farthest;
    if (r->turned) {
        r->against = 0;
        r->present.whole = false;
    }
    return r->turned;
}

/* No answer, or none that comes back: in time, twice the amplitude; then a load is against it. */
static bool grows(struct relay *r, uint32_t patience)
{
    real_t room = FOUND_SHARE * r->config.most;
    if (is_going_wrong(r))
        return false; /* more of it before its sign is known may be more of the wrong thing */
    if (!is_found(r) || r->half < patience || TWO * r->share >= LIMIT_SHARE)
        return false;
    if (r->amplitude < room)
        r->amplitude = TWO * r->amplitude < room ? TWO * r->amplitude : room;
    else if (!lean(r))
        return false;
    r->half = 0;
    r->same = 0;
    r->present.whole = false;
    return true;
}

static void start(struct relay *r, real_t y)
{
    bool is_out = y - r->config.reference > r->config.hysteresis;
    r->outside = (uint8_t)(is_out ? r->outside + 1 : 0);
    r->half++;
    r->started++;
    if (r->outside >= OUT_SAMPLES) {
        r->phase = RELAY_CYCLE;
        r->high = false;
        r->half = 0;
        begin_period(r, 0);
    } else if (!grows(r, r->config.patience) && r->half >= r->config.half_most) {
        fail_with(r, RELAY_NO_ANSWER);
        return;
    }
    put_level(r);
}

static void advance_cycle(struct relay *r, real_t y)
{
    real_t away = y - r->config.reference;
    uint32_t most = r->longest > 0 ? STUCK * r->longest + 10u : r->config.half_most;
    uint32_t patience = r->longest > 0 ? most / 2u : r->config.patience;
    bool crossed = r->high ? away > r->config.hysteresis : away < -r->config.hysteresis;
    r->half++;
    if (!crossed && !grows(r, patience) && r->half > most) {
        fail_with(r, RELAY_STUCK);
        return;
    }
    if (crossed) {
        r->sign_seen = true;
        r->high = !r->high;
        r->half = 0;
        if (r->high)
            end_period(r);
        if (r->phase != RELAY_CYCLE)
            return;
    }
    put_level(r);
    count_sample(r, y);
}

enum err relay_step(struct relay *r, real_t y, real_t share)
{
    if (r->phase != RELAY_START && r->phase != RELAY_CYCLE)
        return ERR_STATE;
    if (!real_is_finite(y) || !real_is_finite(share))
        return ERR_NOT_FINITE;
    if (real_abs(y) > VALUE_MAX)
        return ERR_RANGE;
    r->last = y;
    if (share > r->share)
        r->share = share;
    if (watch_sign(r, y)) {
        if (r->phase != RELAY_FAILED)
            put_level(r);
    } else if (r->phase == RELAY_START) {
        start(r, y);
    } else {
        advance_cycle(r, y);
    }
    return ERR_OK;
}

enum err relay_missed(struct relay *r)
{
    if ((r->phase != RELAY_START && r->phase != RELAY_CYCLE) || r->started == 0)
        return ERR_STATE;
    r->half++;
    if (r->phase == RELAY_CYCLE)
        count_sample(r, r->last);
    return ERR_OK;
}

enum err relay_look(const struct relay *r, struct relay_result *result)
{
    if (r->phase != RELAY_DONE)
        return ERR_EMPTY;
    struct relay_result x = {.amplitude = r->amplitude, .periods = r->periods};
    real_t g[2], samples = ZERO, high = ZERO;
    enum err err = spread_of(r, g, &x.spread);
    if (err)
        return err;
    for (unsigned i = 0; i < RELAY_PERIODS; i++) {
        const struct relay_period *p = &r->period[i];
        x.peak += (p->top - p->bottom) / (TWO * (real_t)RELAY_PERIODS);
        samples += (real_t)p->samples;
        high += (real_t)p->high;
    }
    real_t sign = r->config.sign > 0 ? ONE : -ONE, eps = r->config.hysteresis;
    real_t size = real_sqrt(g[0] * g[0] + g[1] * g[1]), back = -sign * g[0];
    real_t sine = x.peak * x.peak - eps * eps;
    if (!(back > BACK_LEAST * size) || !(sine > ZERO))
        return ERR_RANGE;
    x.gain = sign / (back > BACK_FULL * size ? back : BACK_FULL * size);
    x.described = sign * REAL_C(4.0) * r->amplitude / (PI * real_sqrt(sine));
    x.period_s = samples / (real_t)RELAY_PERIODS * r->config.h_s;
    x.bias = r->bias + sign * r->amplitude * (TWO * high / samples - ONE);
    if (!real_is_finite(x.gain) || !real_is_finite(x.described) || !real_is_finite(x.period_s))
        return ERR_RANGE;
    *result = x;
    return ERR_OK;
}
