#include "commission/analysis_crossover.h"

#include "base/assertion.h"
#include "commission/analysis_state.h"

#define PI          REAL_C(3.14159265)
#define BELOW       REAL_C(0.01) /* of the frequency at which the integral part alone would cross 1 */
#define STEP        REAL_C(1.25)
#define STEPS_MOST  100u /* over nine decades */
#define A_CALL      8u   /* frequencies in one piece of work */
#define HALVES_MOST 10u  /* of the last step: to a part in 5000 */

/* Gain of loop k broken, the other loops in manual. */
static real_t broken_gain(struct analysis *a, uint8_t k, real_t omega)
{
    const struct pairs one = {.n = 1, .output = {a->pairs.output[k]}, .input = {a->pairs.input[k]}};
    real_t h_s = a->config.h_s;
    interact_response(&a->plant, &one, omega, &a->work.crossover.pair.response);
    struct cplx c = loops_controller(&a->loops, k, h_s, loops_z_less_1(omega * h_s));
    return cplx_abs(a->work.crossover.pair.response.value[0][0]) * cplx_abs(c);
}

void analysis_crossover_begin(struct analysis *a, uint8_t k)
{
    REFLUX_ASSERT(k < a->pairs.n && a->pairs.n <= INTERACT_MAX);
    const struct tuning *t = &a->loops.tuning[k];
    real_t gain = real_abs(a->plant.element[a->pairs.output[k]][a->pairs.input[k]].gain * t->gain);
    real_t lo = BELOW * (gain < REAL_C(1.0) ? gain : REAL_C(1.0)) / t->ti_s;
    a->work.crossover.search = (struct crossover_search){.lo = lo, .hi = lo};
    a->crossover[k] = a->crossover_lambda[k] = REAL_C(0.0);
}

/* A frequency of the way up, until the gain is no longer above 1; then of the halves of the last step. True: there is more. */
static bool look_at_frequency(struct analysis *a, uint8_t k)
{
    struct crossover_search *s = &a->work.crossover.search;
    bool beyond = s->hi >= PI / a->config.h_s;
    if (!s->between) {
        s->between = beyond || s->steps == STEPS_MOST || !(broken_gain(a, k, s->hi) > REAL_C(1.0));
        if (!s->between) {
            s->lo = s->hi;
            s->hi = STEP * s->hi;
            s->steps++;
        }
        return true;
    }
    if (beyond || s->halves == HALVES_MOST)
        return false;
    s->halves++;
    real_t middle = real_sqrt(s->lo) * real_sqrt(s->hi);
    if (broken_gain(a, k, middle) > REAL_C(1.0))
        s->lo = middle;
    else
        s->hi = middle;
    return true;
}

enum err analysis_crossover_step(struct analysis *a, uint8_t k)
{
    REFLUX_ASSERT(k < a->pairs.n && a->pairs.n <= INTERACT_MAX);
    const struct crossover_search *s = &a->work.crossover.search;
    bool more = true;
    for (unsigned i = 0; i < A_CALL && more; i++)
        more = look_at_frequency(a, k);
    if (more)
        return ERR_BUSY;
    real_t most = PI / a->config.h_s, lambda, omega = s->hi < most ? s->hi : most;
    if (rga_of_pair(&a->plant, &a->pairs, k, omega, &a->work.crossover.pair, &lambda) != ERR_OK)
        return ERR_OK;
    a->crossover[k] = omega;
    a->crossover_lambda[k] = lambda;
    return ERR_OK;
}
