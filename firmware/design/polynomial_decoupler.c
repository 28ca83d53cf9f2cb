#include "design/polynomial_decoupler.h"

#include <stddef.h>

#include "base/assertion.h"

void polynomial_decoupler_config_default(struct polynomial_decoupler_config *config)
{
    *config = (struct polynomial_decoupler_config){.element_hi = REAL_C(100.0),
                                                   .determinant_lo = REAL_C(0.02),
                                                   .zero_hi = REAL_C(1.0),
                                                   .recursion_hi = REAL_C(0.95)};
}

static enum err refuse_decoupler(struct polynomial_decoupler_refusal *reason, enum err code,
                                 const char *field, const char *wanted, size_t output, size_t input)
{
    *reason = (struct polynomial_decoupler_refusal){field, wanted, (uint8_t)output, (uint8_t)input};
    return code;
}

static enum err refuse_field(struct polynomial_decoupler_refusal *reason, const char *field,
                             const char *wanted)
{
    return refuse_decoupler(reason, ERR_RANGE, field, wanted, DECOUPLED_NONE, DECOUPLED_NONE);
}

static enum err check_polynomial_config(const struct polynomial_decoupler_config *c,
                                        struct polynomial_decoupler_refusal *reason)
{
    if (!real_within(c->element_hi, REAL_C(1.0), REAL_C(127.0)))
        return refuse_field(reason, "element_hi", "1 to 127");
    if (!real_within(c->determinant_lo, REAL_C(1e-6), REAL_C(1.0)))
        return refuse_field(reason, "determinant_lo", "1e-6 to 1");
    if (!real_within(c->zero_hi, REAL_C(1e-6), REAL_C(1e6)))
        return refuse_field(reason, "zero_hi", "1e-6 to 1e6");
    if (!real_within(c->recursion_hi, REAL_C(0.1), REAL_C(0.999)))
        return refuse_field(reason, "recursion_hi", "0.1 to 0.999");
    return ERR_OK;
}

/* B with the z^-1 that every element has left away, and row i divided by the power of two next to its largest coefficient: units of
 * outputs are apart by magnitudes, and neither moves a zero nor, but for a factor of its column, G. */
static void take_model(const struct difference_model *model, struct polynomial_matrix *b)
{
    b->rows = model->outputs;
    b->cols = model->inputs;
    for (unsigned i = 0; i < b->rows; i++) {
        real_t most = REAL_C(0.0), scale = REAL_C(1.0);
        for (unsigned j = 0; j < b->cols; j++)
            for (unsigned k = 0; k < model->nb; k++)
                if (real_abs(model->b[i][j][k]) > most)
                    most = real_abs(model->b[i][j][k]);
        for (unsigned k = 0; k < 100 && most > REAL_C(0.0) && most * scale < REAL_C(0.5); k++)
            scale *= REAL_C(2.0);
        for (unsigned k = 0; k < 100 && most * scale > REAL_C(1.0); k++)
            scale *= REAL_C(0.5);
        for (unsigned j = 0; j < b->cols; j++) {
            polynomial_set(&b->value[i][j], model->b[i][j], model->nb);
            for (unsigned k = 0; k < model->nb; k++)
                b->value[i][j].value[k] *= scale;
        }
    }
}

/* Zeros in z of a polynomial in z^-1 that has no delay: those of the polynomial written backwards. */
enum err polynomial_decoupler_zeros(struct polynomial_decoupler *d)
{
    struct polynomial backwards = {.n = d->det.n};
    for (unsigned k = 0; k < backwards.n; k++)
        backwards.value[k] = d->det.value[backwards.n - 1u - k];
    enum err err = polynomial_find_roots(&backwards, &d->zeros);
    d->outermost = REAL_C(0.0);
    for (unsigned k = 0; k < d->zeros.n && !err; k++) {
        real_t size = cplx_abs(d->zeros.value[k]) + d->zeros.radius[k];
        if (size > d->outermost)
            d->outermost = size;
    }
    return err;
}

static enum err find_determinant(const struct polynomial_decoupler_config *c,
                                 struct polynomial_decoupler_work *work,
                                 struct polynomial_decoupler *d,
                                 struct polynomial_decoupler_refusal *reason)
{
    enum err err = polynomial_determinant(&work->b, &work->minors, &d->det);
    if (err)
        return err;
    if (!d->det.n)
        return refuse_decoupler(reason, ERR_SINGULAR, "determinant", "not 0", DECOUPLED_NONE,
                                DECOUPLED_NONE);
    d->delay = (uint8_t)polynomial_delay(&d->det);
    polynomial_advance(&d->det, d->delay);
    /* Every element has z^-1 besides. */
    d->delay = (uint8_t)(d->delay + work->b.rows);
    real_t terms =
        work->b.rows == 1 ? polynomial_size(&d->det) : polynomial_size(&work->minors.part_size);
    if (!(real_abs(polynomial_value(&d->det, REAL_C(1.0))) >= c->determinant_lo * terms))
        return refuse_decoupler(reason, ERR_SINGULAR, "determinant",
                                "farther from 0 at rest; its terms nearly cancel", DECOUPLED_NONE,
                                DECOUPLED_NONE);
    return ERR_OK;
}

/* Column k: its common delay goes, its diagonal element becomes 1 at rest. *taken: the delay that went. */
static enum err normalise_column(const struct polynomial_decoupler_config *c,
                                 struct polynomial_matrix *g, unsigned k, unsigned *taken,
                                 real_t *scale, struct polynomial_decoupler_refusal *reason)
{
    REFLUX_ASSERT(k < g->cols && k < g->rows);
    real_t rest = polynomial_value(&g->value[k][k], REAL_C(1.0));
    *taken = POLYNOMIAL_MOST;
    for (unsigned i = 0; i < g->rows; i++)
        if (g->value[i][k].n && polynomial_delay(&g->value[i][k]) < *taken)
            *taken = polynomial_delay(&g->value[i][k]);
    for (unsigned i = 0; i < g->rows; i++)
        if (!(polynomial_size(&g->value[i][k]) <= c->element_hi * real_abs(rest)) ||
            rest == REAL_C(0.0))
            return refuse_decoupler(reason, ERR_SINGULAR, "element",
                                    "within bounds where a loop moves its own input by 1", i, k);
    *scale = REAL_C(1.0) / rest;
    for (unsigned i = 0; i < g->rows; i++) {
        polynomial_advance(&g->value[i][k], *taken);
        for (unsigned l = 0; l < g->value[i][k].n; l++)
            g->value[i][k].value[l] *= *scale;
    }
    return ERR_OK;
}

/* det B, as it is in the scaled rows of B, in the units of loop i and with what column i lost. */
static void find_numerator(const struct difference_model *model, const struct polynomial_matrix *b,
                           unsigned i, real_t scale, unsigned delay, struct polynomial_decoupler *d)
{
    REFLUX_ASSERT(i < DIFFERENCE_MOST && delay + d->det.n <= POLYNOMIAL_MOST);
    struct polynomial *h = &d->h[i];
    real_t row = REAL_C(1.0);
    for (unsigned j = 0; j < b->cols; j++)
        for (unsigned k = 0; k < model->nb; k++)
            if (b->value[i][j].value[k] != REAL_C(0.0))
                row = model->b[i][j][k] / b->value[i][j].value[k];
    h->n = 0;
    for (; h->n < delay; h->n++)
        h->value[h->n] = REAL_C(0.0);
    for (unsigned k = 0; k < d->det.n; k++)
        h->value[h->n++] = d->det.value[k] * scale * row;
}

enum err polynomial_decoupler_check(const struct difference_model *model,
                                    const struct polynomial_decoupler_config *config,
                                    struct polynomial_decoupler_refusal *reason)
{
    struct polynomial_decoupler_refusal unused;
    reason = reason ? reason : &unused;
    *reason = (struct polynomial_decoupler_refusal){"", "", DECOUPLED_NONE, DECOUPLED_NONE};
    enum err err = difference_check(model, &reason->field, &reason->wanted);
    if (!err)
        err = check_polynomial_config(config, reason);
    if (!err && model->outputs != model->inputs)
        err = refuse_field(reason, "outputs", "as many as inputs");
    return err;
}

enum err polynomial_decoupler_design(const struct difference_model *model,
                                     const struct polynomial_decoupler_config *config,
                                     struct polynomial_decoupler_work *work,
                                     struct polynomial_decoupler *result,
                                     struct polynomial_decoupler_refusal *reason)
{
    struct polynomial_decoupler_refusal unused;
    enum err err;
    reason = reason ? reason : &unused;
    *result = (struct polynomial_decoupler){0};
    /* Whatever returns an error without a reason of its own leaves this one. */
    (void)!refuse_field(reason, "model", "one that can be designed for");
    unsigned n = model->outputs, delays = 0;
    take_model(model, &work->b);
    err = find_determinant(config, work, result, reason);
    if (!err)
        err = polynomial_adjugate(&work->b, &work->minors, &result->g);
    if (err)
        return err;
    for (unsigned k = 0; k < n; k++) {
        unsigned taken;
        real_t scale;
        err = normalise_column(config, &result->g, k, &taken, &scale, reason);
        if (err)
            return err;
        /* B's own z^-1 is left of those of det B; what the column lost is gone. */
        find_numerator(model, &work->b, k, scale, result->delay - (n - 1u) - taken, result);
        delays += taken;
    }
    if (!polynomial_zeros_within(&result->det, config->zero_hi))
        return refuse_decoupler(reason, ERR_RANGE, "zero",
                                "inside: one of det B outside stays in every loop", DECOUPLED_NONE,
                                DECOUPLED_NONE);
    /* det G is det(B)^(n - 1) but for factors and delays: with none of the latter its first coefficients have an inverse. */
    result->recursive = delays == (n - 1u) * (result->delay - n) &&
                        polynomial_zeros_within(&result->det, config->recursion_hi);
    *reason = (struct polynomial_decoupler_refusal){"", "", DECOUPLED_NONE, DECOUPLED_NONE};
    return ERR_OK;
}
