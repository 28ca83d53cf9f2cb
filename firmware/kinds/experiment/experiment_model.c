#include "kinds/experiment/experiment_model.h"

#include <string.h>

#include "base/assertion.h"
#include "kinds/experiment/experiment_model_state.h"

/* Largest part of the movement of an MV that loops may have made. With more, instruments depend on noise. */
#define OTHERS_MOST REAL_C(0.25)

void experiment_model_clear(struct experiment_model *m, float *coefficients, unsigned n)
{
    memset(m->found, 0, sizeof m->found);
    memset(coefficients, 0, experiment_coefficients(n) * sizeof *coefficients);
}

static void take_output(struct experiment_model *m, float *coefficients,
                        const struct experiment_context *c, const struct plant_output *from,
                        unsigned i)
{
    REFLUX_ASSERT(i < c->n && c->n <= EXPERIMENT_MOST);
    struct experiment_found *to = &m->found[i];
    to->na = from->na;
    to->nb = from->nb;
    to->verdict = from->verdict;
    to->one_step = (float)(100 * from->one_step);
    to->fit = (float)(100 * from->fit);
    to->apart = (float)(100 * from->apart);
    for (unsigned k = 0; k < DIFFERENCE_A_MOST; k++)
        coefficients[experiment_a(i) + k] = (float)from->a[k];
    for (unsigned j = 0; j < c->n; j++)
        for (unsigned k = 0; k < DIFFERENCE_B_MOST; k++)
            coefficients[experiment_b(c->n, i, j) + k] =
                (float)from->b[j][k] * experiment_span(c, i) / experiment_span(c, c->n + j);
}

uint8_t experiment_model_take(struct experiment_model *m, float *coefficients,
                              const struct experiment_context *c, const struct plant_finding *f,
                              const struct experiment_record *r, uint8_t *at_fault)
{
    uint8_t verdict = PLANT_UNJUDGED;
    for (unsigned i = 0; i < c->n; i++) {
        const struct plant_output *from = plant_finding_output(f, i);
        take_output(m, coefficients, c, from, i);
        if (from->verdict > verdict) {
            verdict = from->verdict;
            *at_fault = verdict == PLANT_USABLE ? 0 : (uint8_t)(i + 1u);
        }
    }
    for (unsigned j = 0; j < c->n && verdict == PLANT_USABLE; j++)
        if (c->s.method == ARX_IV && experiment_others(r, j) > OTHERS_MOST) {
            verdict = VERDICT_LOOPS;
            *at_fault = (uint8_t)(c->n + j + 1u);
        }
    return verdict;
}

const struct experiment_found *experiment_model_found(const struct experiment_model *m, unsigned i)
{
    REFLUX_ASSERT(i < EXPERIMENT_MOST);
    return &m->found[i];
}

float experiment_model_fit(const struct experiment_model *m, unsigned n)
{
    REFLUX_ASSERT(n <= EXPERIMENT_MOST);
    float least = m->found[0].fit;
    for (unsigned i = 1; i < n; i++)
        least = m->found[i].fit < least ? m->found[i].fit : least;
    return least;
}

float experiment_model_gain(const float *coefficients, unsigned n, unsigned i, unsigned j)
{
    REFLUX_ASSERT(i < n && j < n && n <= EXPERIMENT_MOST);
    const float *a = &coefficients[experiment_a(i)], *b = &coefficients[experiment_b(n, i, j)];
    float at_rest = 1, sum = 0;
    for (unsigned k = 0; k < DIFFERENCE_A_MOST; k++)
        at_rest += a[k];
    for (unsigned k = 0; k < DIFFERENCE_B_MOST; k++)
        sum += b[k];
    return at_rest > 1e-6f ? sum / at_rest : 0;
}
