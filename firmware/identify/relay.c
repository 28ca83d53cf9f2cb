#include "identify/relay.h"

#include <string.h>

#include "identify/common.h"
#include "num/real_trig.h"

#define PI          REAL_C(3.14159265358979)
#define OUT_SAMPLES 2u           /* in a row out of the hysteresis: noise is not */
#define SAME_HALF   REAL_C(0.1)  /* of a half: two that agree */
#define SAME_PEAK   REAL_C(0.03) /* of the way between the peaks */
#define SAME_GAIN   REAL_C(0.2)  /* of the gain */
#define PEAK_NOISE  REAL_C(3.0)  /* deviations: and of its noise */
#define UNEVEN                                                                                     \
    REAL_C(0.15)        /* of the period: halves differ by more than this, and the bias is moved */
#define STUCK        6u /* times the longest half before */
#define PERIODS_MOST 24u
#define GROWTH_MOST  REAL_C(4.0)
#define LIMIT_SHARE  REAL_C(0.7) /* of a limit that a new amplitude may aim at */
#define SHRINK_SHARE REAL_C(0.9) /* of a limit from which on the amplitude is made smaller */
#define HALF_LARGEST (1u << 28)
#define HARDLY       REAL_C(1.3) /* hystereses: a cycle that is no more than its own hysteresis */

static bool positive(real_t x, real_t most)
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
        err = check_real(c->drift_per_s, -VALUE_MAX, VALUE_MAX);
    if (!err)
        err = check_real(c->noise_sd, ZERO, ONE);
    if (!err)
        err = check_real(c->amplitude, ZERO, ONE);
    if (err)
        return err;
    if (!positive(c->hysteresis, ONE) || !positive(c->most, ONE) || !positive(c->wanted, ONE) ||
        !positive(c->first, c->most) || c->amplitude > c->most || c->patience == 0 ||
        c->half_most <= c->patience || c->half_most > HALF_LARGEST)
        return ERR_RANGE;
    r->config = *c;
    r->reference = c->reference;
    r->amplitude = c->amplitude > ZERO ? c->amplitude : c->first;
    return ERR_OK;
}

static void fail(struct relay *r, enum relay_failure failure)
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
    bool up = r->high == (r->sign >= 0);
    r->level = r->bias + (up ? r->amplitude : -r->amplitude);
}

/* The wheel of the first harmonic turns once in the latest period. */
static void begin_period(struct relay *r, uint32_t samples)
{
    memset(&r->now, 0, sizeof r->now);
    r->share = ZERO;
    r->wheel[0] = ONE;
    r->wheel[1] = ZERO;
    r->now.whole = samples > 0;
    if (samples > 0)
        real_sincos(TWO * PI / (real_t)samples, &r->turn[1], &r->turn[0]);
}

/* The sample that has just begun, with the input that goes with it. The output is taken from the mean of the period
 * before: should this one be a sample longer, a mean would count for a harmonic. */
static void count(struct relay *r, real_t y)
{
    struct relay_period *p = &r->now;
    real_t away = y - r->reference, centre = r->period[RELAY_PERIODS - 1].mean;
    p->samples++;
    p->high += r->high;
    p->mean += away;
    if (p->samples == 1 || away > p->top)
        p->top = away;
    if (p->samples == 1 || away < p->bottom)
        p->bottom = away;
    if (!p->whole)
        return;
    for (unsigned i = 0; i < 2; i++) {
        p->output[i] += r->wheel[i] * (away - centre);
        p->input[i] += r->wheel[i] * (r->level - r->bias);
    }
    real_t c = r->wheel[0] * r->turn[0] - r->wheel[1] * r->turn[1];
    r->wheel[1] = r->wheel[1] * r->turn[0] + r->wheel[0] * r->turn[1];
    r->wheel[0] = c;
}

static bool agree(uint32_t a, uint32_t b)
{
    real_t apart = (real_t)(a > b ? a - b : b - a);
    return apart <= ONE + SAME_HALF * (real_t)b;
}

static bool is_same(const struct relay *r, const struct relay_period *a,
                    const struct relay_period *b)
{
    /* Samples are where they are: a peak may be missed by the way of one. */
    real_t way = b->top - b->bottom, sample = TWO * way / (real_t)b->samples;
    real_t most = SAME_PEAK * way + PEAK_NOISE * r->config.noise_sd + sample;
    return agree(a->high, b->high) && agree(a->samples - a->high, b->samples - b->high) &&
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
    real_t bias = r->bias + (r->sign >= 0 ? uneven : -uneven) * r->amplitude;
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
    real_t amplitude = factor * r->amplitude, room = r->config.most - real_abs(r->bias);
    if (amplitude > room)
        amplitude = room;
    if (real_abs(amplitude - r->amplitude) < REAL_C(0.1) * r->amplitude)
        return false;
    r->amplitude = amplitude;
    return true;
}

/* G at the frequency of a period, real and imaginary part: output over input. ERR_RANGE: there is no input. */
static enum err ratio(const struct relay_period *p, real_t g[2])
{
    real_t size = p->input[0] * p->input[0] + p->input[1] * p->input[1];
    if (!(size > ZERO))
        return ERR_RANGE;
    g[0] = (p->output[0] * p->input[0] + p->output[1] * p->input[1]) / size;
    g[1] = (p->output[0] * p->input[1] - p->output[1] * p->input[0]) / size;
    return ERR_OK;
}

/* The gains of the latest periods, and how far the last two are apart. ERR_RANGE: there are none. */
static enum err spread_of(const struct relay *r, real_t g[2], real_t *spread)
{
    real_t size[RELAY_PERIODS];
    g[0] = g[1] = ZERO;
    for (unsigned i = 0; i < RELAY_PERIODS; i++) {
        real_t of[2];
        if (ratio(&r->period[i], of) != ERR_OK)
            return ERR_RANGE;
        size[i] = real_sqrt(of[0] * of[0] + of[1] * of[1]);
        g[0] += of[0] / (real_t)RELAY_PERIODS;
        g[1] += of[1] / (real_t)RELAY_PERIODS;
    }
    real_t latest = size[RELAY_PERIODS - 1];
    if (!(latest > ZERO))
        return ERR_RANGE;
    *spread = real_abs(latest - size[RELAY_PERIODS - 2]) / latest;
    return ERR_OK;
}

static bool is_settled(const struct relay *r)
{
    real_t g[2], spread;
    return r->same >= RELAY_PERIODS && spread_of(r, g, &spread) == ERR_OK && spread <= SAME_GAIN;
}

static void end_period(struct relay *r)
{
    struct relay_period *last = &r->period[RELAY_PERIODS - 1], *p = &r->now;
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
    r->same = (uint8_t)(same && !changes ? r->same + 1 : 0);
    for (unsigned i = 1; i < RELAY_PERIODS; i++)
        r->period[i - 1] = r->period[i];
    *last = *p;
    if (!is_settled(r)) {
        begin_period(r, last->samples);
        if (r->periods >= PERIODS_MOST)
            fail(r, RELAY_UNSETTLED);
    } else if (last->top - last->bottom < TWO * HARDLY * r->config.hysteresis) {
        fail(r, RELAY_NO_ANSWER);
    } else {
        r->phase = RELAY_DONE;
        r->level = ZERO;
    }
}

/* The first answer to the input: it says which way the process goes. */
static void start(struct relay *r, real_t y)
{
    const struct relay_config *c = &r->config;
    /* A drift may go on or may have been the end of something: an answer is away from both. */
    real_t away = y - r->reference, still = y - c->reference;
    real_t nearer = real_abs(still) < real_abs(away) ? still : away;
    bool is_out = real_abs(nearer) > c->hysteresis && away * still > ZERO;
    r->outside = (uint8_t)(is_out ? r->outside + 1 : 0);
    if (r->outside >= OUT_SAMPLES) {
        r->reference = y - nearer;
        r->sign = away > ZERO ? 1 : -1;
        r->phase = RELAY_CYCLE;
        r->high = r->sign < 0; /* the input is up; back from here */
        r->half = 0;
        begin_period(r, 0);
        put_level(r);
        return;
    }
    r->reference += c->drift_per_s * c->h_s;
    r->half++;
    r->started++;
    bool may_grow = is_found(r) && r->amplitude < c->most && TWO * r->share < LIMIT_SHARE;
    if (r->half >= c->patience && may_grow) {
        r->amplitude = TWO * r->amplitude < c->most ? TWO * r->amplitude : c->most;
        r->half = 0;
    } else if (r->half >= c->half_most) {
        fail(r, RELAY_NO_ANSWER);
        return;
    }
    r->level = r->amplitude;
}

static void cycle(struct relay *r, real_t y)
{
    real_t away = y - r->reference;
    uint32_t most = r->longest > 0 ? STUCK * r->longest + 10u : r->config.half_most;
    bool crossed = r->high ? away > r->config.hysteresis : away < -r->config.hysteresis;
    if (++r->half > most) {
        fail(r, RELAY_STUCK);
        return;
    }
    if (crossed) {
        r->high = !r->high;
        r->half = 0;
        if (r->high)
            end_period(r);
        if (r->phase != RELAY_CYCLE)
            return;
    }
    put_level(r);
    count(r, y);
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
    if (r->phase == RELAY_START)
        start(r, y);
    else
        cycle(r, y);
    return ERR_OK;
}

enum err relay_missed(struct relay *r)
{
    if ((r->phase != RELAY_START && r->phase != RELAY_CYCLE) || (r->started == 0 && r->sign == 0))
        return ERR_STATE;
    r->half++;
    if (r->phase == RELAY_CYCLE)
        count(r, r->last);
    else
        r->reference += r->config.drift_per_s * r->config.h_s;
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
    real_t size = g[0] * g[0] + g[1] * g[1], eps = r->config.hysteresis;
    real_t sine = x.peak * x.peak - eps * eps;
    real_t against =
        r->sign >= 0 ? -g[0] : g[0]; /* what of the output comes back against the input */
    if (!(against * against > REAL_C(0.1) * size) || !(against > ZERO) || !(sine > ZERO))
        return ERR_RANGE;
    real_t sign = r->sign >= 0 ? ONE : -ONE;
    x.gain = sign / against;
    x.described = sign * REAL_C(4.0) * r->amplitude / (PI * real_sqrt(sine));
    x.period_s = samples / (real_t)RELAY_PERIODS * r->config.h_s;
    x.bias = r->bias + sign * r->amplitude * (TWO * high / samples - ONE);
    if (!real_is_finite(x.gain) || !real_is_finite(x.described) || !real_is_finite(x.period_s))
        return ERR_RANGE;
    *result = x;
    return ERR_OK;
}
