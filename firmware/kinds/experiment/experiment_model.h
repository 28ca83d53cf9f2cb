/* The model that an experiment has found. Its coefficients stand behind the state of the block, EU per EU: [n][A], then [n][n][B]. */
#ifndef REFLUX_EXPERIMENT_EXPERIMENT_MODEL_H
#define REFLUX_EXPERIMENT_EXPERIMENT_MODEL_H

#include "kinds/experiment/experiment_context.h"
#include "kinds/experiment/experiment_found.h"
#include "kinds/experiment/experiment_record.h"
#include "kinds/experiment/plant_model.h"

struct experiment_model;

/* Number of coefficients. */
static inline size_t experiment_coefficients(size_t n)
{
    return n * DIFFERENCE_A_MOST + n * n * DIFFERENCE_B_MOST;
}

/* Place of A of output i, of B of output i and input j. */
static inline size_t experiment_a(size_t i)
{
    return i * DIFFERENCE_A_MOST;
}

static inline size_t experiment_b(size_t n, size_t i, size_t j)
{
    return n * DIFFERENCE_A_MOST + (i * n + j) * DIFFERENCE_B_MOST;
}

void experiment_model_clear(struct experiment_model *m, float *coefficients, unsigned n);
/* Takes the outputs of a search that is over. Returns the verdict of the model, enum plant_verdict or VERDICT_LOOPS; *at_fault: the input of the
 * block that is to blame, from 1 on, left alone where there is none. */
uint8_t experiment_model_take(struct experiment_model *m, float *coefficients,
                              const struct experiment_context *c, const struct plant_finding *f,
                              const struct experiment_record *r, uint8_t *at_fault);
const struct experiment_found *experiment_model_found(const struct experiment_model *m, unsigned i);
/* The least fit of n outputs, %. */
float experiment_model_fit(const struct experiment_model *m, unsigned n);
/* Gain at rest, EU per EU; 0 where it integrates. */
float experiment_model_gain(const float *coefficients, unsigned n, unsigned i, unsigned j);

#endif
