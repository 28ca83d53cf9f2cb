#include "kinds/composition/covariance_ud.h"

#include "base/assertion.h"
#include "kinds/composition/covariance_root.h"
#include "num/ud.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

#define M_MAX ((size_t)COLUMN_COMPONENTS_MAX - 1)

/* A step's parts, in this order. */
enum phase { PHASE_NOISE, PHASE_EXTRAS, PHASE_UP, PHASE_BACK, PHASE_GROWN, PHASE_DONE };

static size_t triangle_of(const struct covariance_ud *c)
{
    return c->n + c->extras;
}

size_t covariance_ud_bytes(size_t stages, size_t m, size_t extras)
{
    size_t n = stages * m;
    return (ud_count(n + extras) + 2 * n * m + 2 * (n + extras)) * sizeof(real_t);
}

enum err covariance_ud_begin(struct covariance_ud *c, size_t stages, size_t m, size_t extras,
                             const real_t *variance, void *memory)
{
    if (stages < 2 || m < 1 || m > M_MAX || stages > COLUMN_STAGES_MAX ||
        extras > COVARIANCE_EXTRAS_MAX)
        return ERR_RANGE;
    size_t n = stages * m, all = n + extras;
    for (size_t i = 0; i < all; i++) {
        if (!isfinite(variance[i]))
            return ERR_NOT_FINITE;
        if (variance[i] < ZERO)
            return ERR_RANGE;
    }
    *c = (struct covariance_ud){.stages = stages, .m = m, .n = n, .extras = extras, .ud = memory};
    real_t *own = c->ud + ud_count(all), *left = own + n * m;
    c->spare = left + n * m;
    covariance_root_begin(&c->root, stages, m, c->ud, own, left);
    for (size_t i = 0; i < all; i++)
        c->spare[i] = variance[i] > COVARIANCE_LEAST ? variance[i] : COVARIANCE_LEAST;
    ud_set_diagonal(c->ud, all, c->spare);
    return ERR_OK;
}

/* ---- a step ---- */

/* Adds variance to state `at`, and to the next one where two of `left` are left. Returns the number of states. */
static size_t add_from(struct covariance_ud *c, size_t at, const real_t *variance, size_t left)
{
    REFLUX_ASSERT(at < triangle_of(c) && left <= triangle_of(c) - at);
    if (!(variance[0] > ZERO))
        return 1;
    if (left > 1 && variance[1] > ZERO) {
        ud_add_pair(c->ud, at + 1, variance[1], variance[0], c->spare);
        return 2;
    }
    ud_add_at(c->ud, at, variance[0], c->spare);
    return 1;
}

static size_t noisy_one(const struct covariance_ud *c, const struct covariance_step *step)
{
    return (step->noise_first + c->next) % c->n;
}

static size_t add_noise(struct covariance_ud *c, const struct covariance_step *step)
{
    size_t i = noisy_one(c, step), left = step->noise_count - c->next;
    return add_from(c, i, step->noise + i, left < c->n - i ? left : c->n - i);
}

static size_t length_of(const struct covariance_ud *c, const struct covariance_step *step)
{
    switch ((enum phase)c->phase) {
    case PHASE_EXTRAS:
    case PHASE_GROWN:
        return c->extras;
    case PHASE_UP:
    case PHASE_BACK:
        return c->stages;
    case PHASE_NOISE:
        return step->noise_count;
    case PHASE_DONE:
        REFLUX_ASSERT(false); /* the step is over, and none of this is called */
        break;
    }
    return 0;
}

/* Effort for a stage however many are below it, in elements. */
#define STAGE_EFFORT 50

/* Returns the effort of the next part of a phase, in elements. */
static size_t effort_of(const struct covariance_ud *c, const struct covariance_step *step)
{
    switch ((enum phase)c->phase) {
    case PHASE_EXTRAS:
        return 2 * c->n;
    case PHASE_UP:
        return (c->next + 1) * c->m * c->m * c->m + STAGE_EFFORT;
    case PHASE_BACK:
        return (c->stages - c->next) * c->m * c->m + STAGE_EFFORT;
    case PHASE_GROWN:
        return step->grown[c->next] > ZERO ? ud_count(c->n + c->next) : 1;
    case PHASE_NOISE: {
        size_t i = noisy_one(c, step);
        return step->noise[i] > ZERO ? ud_count(i) : 1;
    }
    case PHASE_DONE:
        REFLUX_ASSERT(false); /* the step is over, and none of this is called */
        break;
    }
    return 1;
}

/* Does it; returns the number of parts done. */
static size_t do_next(struct covariance_ud *c, const struct covariance_step *step)
{
    switch ((enum phase)c->phase) {
    case PHASE_EXTRAS:
        covariance_root_extra(&c->root, step, c->next);
        return 1;
    case PHASE_UP:
        covariance_root_up(&c->root, step->transition, c->next);
        return 1;
    case PHASE_BACK:
        covariance_root_back(&c->root, c->stages - 1 - c->next);
        return 1;
    case PHASE_GROWN:
        return add_from(c, c->n + c->next, step->grown + c->next, c->extras - c->next);
    case PHASE_NOISE:
        return add_noise(c, step);
    case PHASE_DONE:
        REFLUX_ASSERT(false); /* the step is over, and none of this is called */
        break;
    }
    return 1;
}

bool covariance_ud_carry_piece(struct covariance_ud *c, const struct covariance_step *step,
                               size_t effort)
{
    REFLUX_ASSERT(c->stages <= COLUMN_STAGES_MAX && c->m >= 1 && c->m <= M_MAX &&
                  c->extras <= COVARIANCE_EXTRAS_MAX);
    size_t done = 0;

    if (c->phase == PHASE_NOISE && c->next == 0)
        covariance_root_start(&c->root);
    while (c->phase < PHASE_DONE) {
        if (c->next == length_of(c, step)) {
            c->phase++;
            c->next = 0;
            continue;
        }
        size_t next = effort_of(c, step);
        if (done > 0 && done + next > effort)
            return true;
        done += next;
        c->next += do_next(c, step);
    }
    c->phase = PHASE_NOISE;
    return false;
}

/* ---- measurements ---- */

/* From `at` on: f = U'h, g = D f. Returns f'g. */
static real_t project(const struct covariance_ud *c, const struct covariance_measurement *z,
                      real_t *f, real_t *g)
{
    REFLUX_ASSERT(z->count <= c->m && z->first + z->count <= c->n);
    size_t end = z->first + z->count, all = triangle_of(c), extra = c->n + z->extra;
    const real_t *column = c->ud + ud_count(z->first);
    real_t variance = ZERO;

    if (z->extra >= c->extras)
        extra = all;
    for (size_t j = z->first; j < all; column += ++j) {
        real_t sum = j < end ? z->slope[j - z->first] : ZERO, own = column[j];
        for (size_t i = z->first, above = j < end ? j : end; i < above; i++)
            sum = real_fma(column[i], z->slope[i - z->first], sum);
        if (j >= extra)
            sum = real_fma(j == extra ? ONE : column[extra], z->extra_slope, sum);
        own *= sum;
        f[j] = sum;
        g[j] = own;
        variance = real_fma(sum, own, variance);
    }
    return variance;
}

real_t covariance_ud_of(struct covariance_ud *c, const struct covariance_measurement *z)
{
    return project(c, z, c->spare, c->spare + triangle_of(c));
}

real_t covariance_ud_take(struct covariance_ud *c, const struct covariance_measurement *z,
                          real_t *gain)
{
    size_t all = triangle_of(c);
    real_t alpha = project(c, z, c->spare, gain) + z->variance, scale = ZERO;

    for (size_t j = 0; j < z->first; j++)
        c->spare[j] = gain[j] = ZERO;
    if (!(z->variance > ZERO) || !(alpha > ZERO) || !isfinite(alpha)) {
        for (size_t j = 0; j < all; j++)
            gain[j] = ZERO;
        return ZERO;
    }
    alpha = ud_correct_from(c->ud, all, z->first, c->spare, gain, z->variance, ONE);
    scale = ONE / alpha;
    for (size_t j = 0; j < all; j++)
        gain[j] *= scale;
    return alpha;
}

void covariance_ud_extremes(struct covariance_ud *c, real_t *least, real_t *most)
{
    size_t all = triangle_of(c);
    real_t *variance = c->spare;
    const real_t *column = c->ud;

    for (size_t j = 0; j < all; column += ++j) {
        real_t d = column[j];
        for (size_t i = 0; i < j; i++)
            variance[i] = real_fma(column[i] * column[i], d, variance[i]);
        variance[j] = d;
    }
    *least = *most = variance[0];
    for (size_t j = 1; j < all; j++) {
        *least = variance[j] < *least ? variance[j] : *least;
        *most = variance[j] > *most ? variance[j] : *most;
    }
}

enum err covariance_ud_err(const struct covariance_ud *c)
{
    return covariance_root_err(&c->root);
}
