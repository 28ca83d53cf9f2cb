#include "interact/plant.h"

#include "base/assertion.h"
#include "num/real_trig.h"

#define GAIN_MAX REAL_C(1e9)
#define TIME_MAX REAL_C(1e6)
/* Square of twice the least damping, 0.01: T^2 over square_s2. */
#define DAMPING_LEAST REAL_C(4e-4)

static enum err check_number(real_t x, real_t lo, real_t hi)
{
    if (!real_is_finite(x))
        return ERR_NOT_FINITE;
    return x < lo || x > hi ? ERR_RANGE : ERR_OK;
}

enum err interact_check_ranges(const struct interact_range *ranges, size_t n,
                               struct interact_refusal *reason)
{
    for (size_t k = 0; k < n; k++) {
        enum err err = check_number(ranges[k].value, ranges[k].lo, ranges[k].hi);
        if (err) {
            *reason = (struct interact_refusal){ranges[k].field, ranges[k].wanted, INTERACT_NONE,
                                                INTERACT_NONE};
            return err;
        }
    }
    return ERR_OK;
}

static enum err check_shape(const struct fopdt *e, const struct interact_shape *shape,
                            struct interact_refusal *reason)
{
    reason->field = "square_s2";
    reason->wanted = "0 to 1e12 s2, a damping of at least 0.01";
    enum err err = check_number(shape->square_s2, REAL_C(0.0), TIME_MAX * TIME_MAX);
    if (err)
        return err;
    if (e->time_constant_s * e->time_constant_s < DAMPING_LEAST * shape->square_s2)
        return ERR_RANGE;
    reason->field = "zero_s";
    reason->wanted = "-1e6 to 1e6 s, 0 without a lag";
    err = check_number(shape->zero_s, -TIME_MAX, TIME_MAX);
    if (err)
        return err;
    bool lags = e->time_constant_s > REAL_C(0.0);
    return !lags && real_abs(shape->zero_s) > REAL_C(0.0) ? ERR_RANGE : ERR_OK;
}

enum err interact_check(const struct interact_plant *plant, struct interact_refusal *reason)
{
    struct interact_refusal unused;
    reason = reason ? reason : &unused;
    *reason = (struct interact_refusal){"outputs", "1 to 16 outputs and inputs", INTERACT_NONE,
                                        INTERACT_NONE};
    if (plant->outputs < 1 || plant->outputs > INTERACT_MAX || plant->inputs < 1 ||
        plant->inputs > INTERACT_MAX)
        return ERR_RANGE;
    for (uint8_t i = 0; i < plant->outputs; i++)
        for (uint8_t j = 0; j < plant->inputs; j++) {
            const struct fopdt *e = &plant->element[i][j];
            *reason = (struct interact_refusal){"gain", "-1e9 to 1e9", i, j};
            enum err err = check_number(e->gain, -GAIN_MAX, GAIN_MAX);
            if (err)
                return err;
            *reason = (struct interact_refusal){"gain_sd", "0 to 1e9", i, j};
            err = check_number(plant->gain_sd[i][j], REAL_C(0.0), GAIN_MAX);
            if (err)
                return err;
            *reason = (struct interact_refusal){"dead_time_s", "0 to 1e6 s", i, j};
            err = check_number(e->dead_time_s, REAL_C(0.0), TIME_MAX);
            if (err)
                return err;
            *reason = (struct interact_refusal){"time_constant_s", "0 to 1e6 s", i, j};
            err = check_number(e->time_constant_s, REAL_C(0.0), TIME_MAX);
            if (!err)
                err = check_shape(e, &plant->shape[i][j], reason);
            if (err)
                return err;
        }
    *reason = (struct interact_refusal){"", "", INTERACT_NONE, INTERACT_NONE};
    return ERR_OK;
}

enum err pairs_check(const struct interact_plant *plant, const struct pairs *pairs,
                     struct interact_refusal *reason)
{
    struct interact_refusal unused;
    reason = reason ? reason : &unused;
    *reason =
        (struct interact_refusal){"pairs", "every output and input at most once, all of the plant",
                                  INTERACT_NONE, INTERACT_NONE};
    if (pairs->n > INTERACT_MAX)
        return ERR_RANGE;
    uint16_t outputs = 0, inputs = 0;
    for (uint8_t k = 0; k < pairs->n; k++) {
        uint8_t i = pairs->output[k], j = pairs->input[k];
        reason->output = i;
        reason->input = j;
        if (i >= plant->outputs || j >= plant->inputs)
            return ERR_RANGE;
        if ((outputs & (1u << i)) != 0u || (inputs & (1u << j)) != 0u)
            return ERR_RANGE;
        outputs = (uint16_t)(outputs | (1u << i));
        inputs = (uint16_t)(inputs | (1u << j));
    }
    *reason = (struct interact_refusal){"", "", INTERACT_NONE, INTERACT_NONE};
    return ERR_OK;
}

void interact_gains(const struct interact_plant *plant, const struct pairs *pairs,
                    struct matrix *gains)
{
    REFLUX_ASSERT(!pairs || pairs->n <= INTERACT_MAX);
    gains->rows = pairs ? pairs->n : plant->outputs;
    gains->cols = pairs ? pairs->n : plant->inputs;
    for (size_t k = 0; k < gains->rows; k++)
        for (size_t l = 0; l < gains->cols; l++) {
            size_t i = pairs ? pairs->output[k] : k, j = pairs ? pairs->input[l] : l;
            gains->value[k][l] = plant->element[i][j].gain;
        }
}

struct cplx fopdt_response(const struct fopdt *model, real_t omega)
{
    real_t sine, cosine, x = omega * model->time_constant_s;
    real_sincos(omega * model->dead_time_s, &sine, &cosine);
    /* exp(-i a)/(1 + i x) = (cos a - i sin a)(1 - i x)/(1 + x^2) */
    real_t scale = model->gain / (REAL_C(1.0) + x * x);
    return cplx(scale * (cosine - x * sine), -scale * (sine + x * cosine));
}

/* The same times (1 + i omega zero_s), with the square in the denominator. */
static struct cplx element_with_shape(const struct fopdt *e, const struct interact_shape *shape,
                                      real_t omega)
{
    if (interact_one_lag(shape))
        return fopdt_response(e, omega);
    real_t sine, cosine;
    real_sincos(omega * e->dead_time_s, &sine, &cosine);
    struct cplx above =
        cplx_mul(cplx(e->gain, e->gain * omega * shape->zero_s), cplx(cosine, -sine));
    real_t turned = omega * omega * shape->square_s2;
    return cplx_div(above, cplx(REAL_C(1.0) - turned, omega * e->time_constant_s));
}

void interact_response(const struct interact_plant *plant, const struct pairs *pairs, real_t omega,
                       struct cmatrix *response)
{
    REFLUX_ASSERT(!pairs || pairs->n <= INTERACT_MAX);
    response->rows = pairs ? pairs->n : plant->outputs;
    response->cols = pairs ? pairs->n : plant->inputs;
    for (size_t k = 0; k < response->rows; k++)
        for (size_t l = 0; l < response->cols; l++) {
            size_t i = pairs ? pairs->output[k] : k, j = pairs ? pairs->input[l] : l;
            response->value[k][l] =
                element_with_shape(&plant->element[i][j], &plant->shape[i][j], omega);
        }
}
