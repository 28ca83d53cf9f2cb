#include "kinds/composition/covariance_band.h"

#include "base/assertion.h"
#include "num/ud.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

#define M_MAX COVARIANCE_BAND_M_MAX

/* Phases of a step. The sweeps go from the condenser down and back. */
enum { BAND_BEGINS, BAND_SWEEPS_DOWN, BAND_SWEEPS_UP };

size_t covariance_band_bytes(size_t stages, size_t m, size_t extras)
{
    return (stages * covariance_band_stride(m, extras) + ud_count(extras)) * sizeof(real_t);
}

static enum err check_band(size_t stages, size_t m, size_t extras, const real_t *variance)
{
    if (stages < 2 || m < 1 || m > M_MAX || stages > COLUMN_STAGES_MAX ||
        extras > COVARIANCE_EXTRAS_MAX)
        return ERR_RANGE;
    for (size_t i = 0; i < stages * m + extras; i++) {
        if (!isfinite(variance[i]))
            return ERR_NOT_FINITE;
        if (variance[i] < ZERO)
            return ERR_RANGE;
    }
    return ERR_OK;
}

enum err covariance_band_begin(struct covariance_band *c, size_t stages, size_t m, size_t extras,
                               const real_t *variance, void *memory)
{
    enum err err = check_band(stages, m, extras, variance);
    size_t stride = covariance_band_stride(m, extras);
    real_t least[COVARIANCE_EXTRAS_MAX];

    if (err)
        return err;
    *c = (struct covariance_band){.stages = stages, .m = m, .extras = extras, .blocks = memory};
    c->ud = c->blocks + stages * stride;
    for (size_t i = 0; i < stages * stride; i++)
        c->blocks[i] = ZERO;
    for (size_t i = 0; i < stages * m; i++)
        c->blocks[i / m * stride + i % m * (m + 1)] = band_at_least(variance[i]);
    for (size_t e = 0; e < extras; e++)
        least[e] = band_at_least(variance[stages * m + e]);
    ud_set_diagonal(c->ud, extras, least);
    return ERR_OK;
}

/* ---- extras ---- */

/* Extra e, given the others of before: sum of mix and a rest of that variance. */
static real_t rest_of(const struct covariance_band *c, size_t e, real_t *mix)
{
    for (size_t i = 0; i < c->extras; i++)
        mix[i] = i == e ? ONE : ZERO;
    ud_solve(c->ud, c->extras, mix, mix);
    real_t variance = ONE / mix[e];
    for (size_t i = 0; i < c->extras; i++)
        mix[i] *= -variance;
    return variance;
}

/* One extra becomes keep t + n. The old one, which is what moved the fractions, is by what the others and the new one say of it
 *
 *     sum_i mix_i t_i + kept (t_new - keep sum_i mix_i t_i),   kept = keep v / (g + keep^2 v)
 *
 * and a rest of the variance v g / (g + keep^2 v). */
static void renew_extra(struct covariance_band *c, size_t e, real_t keep, real_t grown)
{
    struct covariance_band_fresh *fresh = &c->fresh[e];
    real_t v[COVARIANCE_EXTRAS_MAX], rest = rest_of(c, e, fresh->mix);
    real_t part = ONE / (grown + keep * keep * rest), new_share = grown * part;

    fresh->unknown = rest * new_share;
    for (size_t i = 0; i < c->extras; i++)
        fresh->mix[i] *= new_share;
    fresh->mix[e] = keep * rest * part - ONE;
    for (size_t i = 0; i < e; i++)
        c->ud[ud_count(e) + i] /= keep;
    c->ud[ud_count(e) + e] *= keep * keep;
    for (size_t j = e + 1; j < c->extras; j++)
        c->ud[ud_count(j) + e] *= keep;
    for (size_t i = 0; i < c->extras; i++)
        v[i] = i == e ? ONE : ZERO;
    ud_add(c->ud, c->extras, grown, v);
}

static void renew_extras(struct covariance_band *c, const struct covariance_step *step)
{
    for (size_t e = 0; e < c->extras; e++) {
        real_t keep = step->keep[e] > COVARIANCE_BAND_KEEP ? step->keep[e] : COVARIANCE_BAND_KEEP;
        real_t grown = step->grown[e], least = (ONE - keep * keep) * COVARIANCE_LEAST;
        c->fresh[e].unknown = ZERO;
        grown = grown > least ? grown : least; /* in the end it has that variance */
        if (grown > ZERO)
            renew_extra(c, e, keep, grown);
    }
}

/* ---- a step ---- */

static void add_band_noise(struct covariance_band *c, const struct covariance_step *step)
{
    REFLUX_ASSERT(step->noise_first <= c->stages * c->m);
    size_t m = c->m, n = c->stages * m, stride = covariance_band_stride(m, c->extras);
    size_t i = step->noise_first;

    for (size_t count = step->noise_count; count-- > 0; i++) {
        i = i < n ? i : 0;
        c->blocks[i / m * stride + i % m * (m + 1)] += step->noise[i];
    }
}

static bool is_finite_band(const struct covariance_band *c)
{
    size_t count = c->stages * covariance_band_stride(c->m, c->extras) + ud_count(c->extras);
    real_t sum = ZERO; /* what is no number stays so */
    for (size_t i = 0; i < count; i++)
        sum += c->blocks[i] * ZERO;
    return sum == ZERO;
}

static void clear_between(struct covariance_band *c)
{
    for (size_t k = 0; k < 4; k++)
        for (size_t i = 0; i < COVARIANCE_BAND_BLOCK; i++)
            c->block[k][i] = ZERO;
    for (size_t i = 0; i < c->extras * c->m; i++)
        c->row[i] = ZERO;
}

static struct band_view view_of(struct covariance_band *c)
{
    return (struct band_view){.stages = c->stages,
                              .m = c->m,
                              .extras = c->extras,
                              .blocks = c->blocks,
                              .fresh = c->fresh,
                              .block = c->block,
                              .row = c->row,
                              .next = c->next,
                              .down = c->phase == BAND_SWEEPS_DOWN};
}

bool covariance_band_carry_piece(struct covariance_band *c, const struct covariance_step *step,
                                 size_t effort)
{
    REFLUX_ASSERT(c->stages <= COLUMN_STAGES_MAX && c->m >= 1 && c->m <= M_MAX &&
                  c->extras <= COVARIANCE_EXTRAS_MAX && c->next <= c->stages);
    if (c->phase == BAND_BEGINS) {
        add_band_noise(c, step);
        renew_extras(c, step);
        clear_between(c);
        c->phase = BAND_SWEEPS_DOWN;
        c->next = c->stages;
    }
    size_t left = c->phase == BAND_SWEEPS_DOWN ? c->next : c->stages - c->next;
    size_t count = effort / covariance_band_stride(c->m, c->extras);
    count = count < 1 ? 1 : count;
    count = count < left ? count : left;
    struct band_view view = view_of(c);
    if (c->m == 2)
        covariance_band_sweep_two(&view, step, count);
    else
        covariance_band_sweep_any(&view, step, count);
    c->next = view.next;
    if (count < left)
        return true;
    if (c->phase == BAND_SWEEPS_DOWN) {
        clear_between(c);
        c->phase = BAND_SWEEPS_UP;
        return true;
    }
    c->err = is_finite_band(c) ? ERR_OK : ERR_NOT_FINITE;
    c->phase = BAND_BEGINS;
    return false;
}

/* ---- measurements ---- */

/* Measurements of the banded form. One of fractions of stage s with the slopes h is, given the extras, one of S alone. With
 * a = h S_ss h' + variance and g = S h' on every stage,
 *
 *     S <- S - g g'/a,   M <- M - g f'/a,   T by ud_correct as after that,   f = M'h' + the extra's own slope
 *
 * and g goes from stage to stage through the blocks that are kept. This is the whole measurement of the whole P. */
static bool see_stage(const struct covariance_band *c, const struct covariance_measurement *z,
                      struct band_seen *seen)
{
    size_t m = c->m, stage = z->first / m, first = z->first % m;
    const real_t *own = &c->blocks[stage * covariance_band_stride(m, c->extras)];
    const real_t *said = own + 2 * m * m;

    if (z->count < 1 || first + z->count > m || stage >= c->stages)
        return false;
    seen->stage = stage;
    for (size_t i = 0; i < m; i++)
        seen->slope[i] = i < first || i - first >= z->count ? ZERO : z->slope[i - first];
    seen->spread = ZERO;
    for (size_t i = 0; i < m; i++)
        for (size_t j = 0; j < m; j++)
            seen->spread += seen->slope[i] * own[i * m + j] * seen->slope[j];
    if (seen->spread < ZERO) /* rounding */
        seen->spread = ZERO;
    for (size_t e = 0; e < c->extras; e++) {
        seen->by_extra[e] = e == z->extra ? z->extra_slope : ZERO;
        for (size_t i = 0; i < m; i++)
            seen->by_extra[e] += said[e * m + i] * seen->slope[i];
    }
    return true;
}

real_t covariance_band_of(const struct covariance_band *c, const struct covariance_measurement *z)
{
    real_t f[COVARIANCE_EXTRAS_MAX] = {ZERO}, g[COVARIANCE_EXTRAS_MAX] = {ZERO};
    struct band_seen seen;

    if (!see_stage(c, z, &seen))
        return ZERO;
    ud_project(c->ud, c->extras, seen.by_extra, f, g);
    return seen.spread + ud_variance(f, g, c->extras);
}

real_t covariance_band_take(struct covariance_band *c, const struct covariance_measurement *z,
                            real_t *gain)
{
    size_t n = c->stages * c->m;
    real_t f[COVARIANCE_EXTRAS_MAX] = {ZERO}, alpha = ZERO;
    struct band_seen seen = {.bound = ONE};

    if (see_stage(c, z, &seen)) {
        ud_project(c->ud, c->extras, seen.by_extra, f, seen.extra_gain);
        seen.bound = seen.spread + z->variance;
        alpha = seen.bound + ud_variance(f, seen.extra_gain, c->extras);
    }
    if (!(z->variance > ZERO && alpha > ZERO && isfinite(alpha))) {
        for (size_t i = 0; i < n + c->extras; i++)
            gain[i] = ZERO;
        return ZERO;
    }
    seen.per_bound = ONE / seen.bound;
    seen.per_alpha = ONE / alpha;
    seen.left = z->variance * seen.per_bound;
    (void)ud_correct(c->ud, c->extras, f, seen.extra_gain, seen.bound, ONE);
    struct band_view view = view_of(c);
    if (c->m == 2)
        covariance_band_spread_two(&view, &seen, gain);
    else
        covariance_band_spread_any(&view, &seen, gain);
    for (size_t e = 0; e < c->extras; e++)
        gain[n + e] = seen.extra_gain[e] * seen.per_alpha;
    return alpha;
}

/* Returns the variance that the extras give a fraction which depends on them by said[0], said[m], ... */
static real_t variance_by_extras(const struct covariance_band *c, const real_t *said, size_t m)
{
    const real_t *column = c->ud;
    real_t sum = ZERO;

    for (size_t k = 0; k < c->extras; column += ++k) {
        real_t f = said[k * m];
        for (size_t i = 0; i < k; i++)
            f = real_fma(column[i], said[i * m], f);
        sum = real_fma(column[k] * f, f, sum);
    }
    return sum;
}

static real_t extra_variance(const struct covariance_band *c, size_t e)
{
    const real_t *column = c->ud + ud_count(e);
    real_t sum = ZERO;

    for (size_t k = e; k < c->extras; column += ++k) {
        real_t f = k == e ? ONE : column[e];
        sum = real_fma(column[k] * f, f, sum);
    }
    return sum;
}

void covariance_band_extremes(const struct covariance_band *c, real_t *least, real_t *most)
{
    size_t m = c->m, stride = covariance_band_stride(m, c->extras);
    real_t lo = c->blocks[0], hi = ZERO;

    for (size_t s = 0; s <= c->stages; s++) { /* behind the stages the extras themselves */
        const real_t *own = &c->blocks[s * stride], *said = own + 2 * m * m;
        size_t count = s < c->stages ? m : c->extras;
        for (size_t i = 0; i < count; i++) {
            real_t v = s < c->stages ? variance_by_extras(c, said + i, m) + own[i * (m + 1)]
                                     : extra_variance(c, i);
            lo = s + i == 0 || v < lo ? v : lo;
            hi = s + i == 0 || v > hi ? v : hi;
        }
    }
    *least = lo;
    *most = hi;
}

enum err covariance_band_err(const struct covariance_band *c)
{
    return c->err;
}
