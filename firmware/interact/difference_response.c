#include "interact/difference_response.h"

#include <stddef.h>

#include "lti/fopdt.h"
#include "num/real_trig.h"

/* pi, and room for the rounding of omega h. */
#define HALF_TURN REAL_C(3.141594)

/* c[0] + c[1] back + ... + c[n - 1] back^(n - 1), back = 1/z. */
static struct cplx sum_of_powers(const real_t *c, size_t n, struct cplx back)
{
    struct cplx sum = cplx(REAL_C(0.0), REAL_C(0.0));
    for (size_t k = n; k-- > 0;) {
        sum = cplx_mul(sum, back);
        sum.re += c[k];
    }
    return sum;
}

enum err difference_response(const struct difference_model *model, real_t omega,
                             struct cmatrix *response)
{
    enum err err = difference_check(model, NULL, NULL);
    if (err)
        return err;
    if (!real_is_finite(omega))
        return ERR_NOT_FINITE;
    if (!real_within(omega * model->period_s, REAL_C(0.0), HALF_TURN))
        return ERR_RANGE;
    real_t sine, cosine;
    real_sincos(omega * model->period_s, &sine, &cosine);
    struct cplx back = cplx(cosine, -sine);
    response->rows = model->outputs;
    response->cols = model->inputs;
    for (size_t i = 0; i < model->outputs; i++) {
        struct cplx a = cplx_mul(sum_of_powers(model->a[i], model->na, back), back);
        a.re += REAL_C(1.0);
        real_t size = REAL_C(1.0);
        for (size_t k = 0; k < model->na; k++)
            size += real_abs(model->a[i][k]);
        if (real_abs(a.re) + real_abs(a.im) <= REAL_C(8.0) * REAL_EPSILON * size)
            return ERR_SINGULAR;
        for (size_t j = 0; j < model->inputs; j++) {
            struct cplx b = cplx_mul(sum_of_powers(model->b[i][j], model->nb, back), back);
            response->value[i][j] = cplx_div(b, a);
        }
    }
    return ERR_OK;
}
