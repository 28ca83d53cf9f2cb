#include "commission/analysis_crossover.h"

#include "base/assertion.h"
#include "commission/analysis_state.h"

#define PI          REAL_C(3.14159265)
#define BELOW       REAL_C(0.01) /* of the frequency at which the integral part alone would cross 1 */
#define STEP        REAL_C(1.25)
#define STEPS_MOST  100u /* over nine decades */
#define HALVES_MOST 10u  /* of the last step: to a part in 5000 */

/* Gain of loop k broken, the other loops in manual. */
static real_t broken_gain(struct analysis *a, uint8_t k, real_t omega)
{
    const struct pairs one = {.n = 1, .output = {a->pairs.output[k]}, .input = {a->pairs.input[k]}};
    real_t h_s = a->config.h_s;
    interact_response(&a->plant, &one, omega, &a->work.crossover.response);
    struct cplx c = loops_controller(&a->loops, k, h_s, loops_z_less_1(omega * h_s));
    return cplx_abs(a->work.crossover.response.value[0][0]) * cplx_abs(c);
}

void analysis_find_crossover(struct analysis *a, uint8_t k)
{
    REFLUX_ASSERT(k < a->pairs.n && a->pairs.n <= INTERACT_MAX);
    const struct tuning *t = &a->loops.tuning[k];
    real_t gain = real_abs(a->plant.element[a->pairs.output[k]][a->pairs.input[k]].gain * t->gain);
    real_t most = PI / a->config.h_s;
    real_t lo = BELOW * (gain < REAL_C(1.0) ? gain : REAL_C(1.0)) / t->ti_s, hi = lo;
    a->crossover[k] = a->crossover_lambda[k] = REAL_C(0.0);
    for (unsigned i = 0; i < STEPS_MOST && hi < most && broken_gain(a, k, hi) > REAL_C(1.0); i++) {
        lo = hi;
        hi = STEP * hi;
    }
    for (unsigned i = 0; i < HALVES_MOST && hi < most; i++) {
        real_t middle = real_sqrt(lo) * real_sqrt(hi);
        if (broken_gain(a, k, middle) > REAL_C(1.0))
            lo = middle;
        else
            hi = middle;
    }
    real_t omega = hi < most ? hi : most, lambda;
    if (rga_of_pair(&a->plant, &a->pairs, k, omega, &a->work.crossover, &lambda) != ERR_OK)
        return;
    a->crossover[k] = omega;
    a->crossover_lambda[k] = lambda;
}
