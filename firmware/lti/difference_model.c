#include "lti/difference_model.h"

#include <stddef.h>

#include "lti/fopdt.h" /* real_is_finite */

static enum err coefficients_fault(const struct difference_model *m, const char **field)
{
    for (size_t i = 0; i < m->outputs; i++) {
        *field = "a";
        for (size_t k = 0; k < m->na; k++)
            if (!real_is_finite(m->a[i][k]))
                return ERR_NOT_FINITE;
        *field = "b";
        for (size_t j = 0; j < m->inputs; j++)
            for (size_t k = 0; k < m->nb; k++)
                if (!real_is_finite(m->b[i][j][k]))
                    return ERR_NOT_FINITE;
    }
    return ERR_OK;
}

enum err difference_check(const struct difference_model *m, const char **field, const char **wanted)
{
    const char *unused;
    field = field ? field : &unused;
    wanted = wanted ? wanted : &unused;
    const struct {
        const char *name, *range;
        unsigned value, least, most;
    } size[] = {
        {"outputs", "1 to 4", m->outputs, 1, DIFFERENCE_MOST},
        {"inputs", "1 to 4", m->inputs, 1, DIFFERENCE_MOST},
        {"na", "0 to 4 coefficients", m->na, 0, DIFFERENCE_A_MOST},
        {"nb", "1 to 8 coefficients", m->nb, 1, DIFFERENCE_B_MOST},
    };
    for (size_t k = 0; k < sizeof size / sizeof size[0]; k++)
        if (size[k].value < size[k].least || size[k].value > size[k].most) {
            *field = size[k].name;
            *wanted = size[k].range;
            return ERR_RANGE;
        }
    *field = "period_s";
    *wanted = "above 0, to 1e6 s";
    if (!real_is_finite(m->period_s))
        return ERR_NOT_FINITE;
    if (m->period_s <= REAL_C(0.0) || m->period_s > REAL_C(1e6))
        return ERR_RANGE;
    *wanted = "finite numbers";
    return coefficients_fault(m, field);
}

/* *at_one = A_ii(1). False where it is 0 but for the rounding of its coefficients and of the sum. */
static bool settles(const struct difference_model *m, size_t i, real_t *at_one)
{
    real_t sum = REAL_C(1.0), size = REAL_C(1.0);
    for (size_t k = 0; k < m->na; k++) {
        sum += m->a[i][k];
        size += real_abs(m->a[i][k]);
    }
    *at_one = sum;
    return real_abs(sum) > (real_t)(m->na + 1u) * REAL_EPSILON * size;
}

enum err difference_gain(const struct difference_model *m,
                         real_t gain[DIFFERENCE_MOST][DIFFERENCE_MOST])
{
    real_t at_one[DIFFERENCE_MOST] = {0};
    for (size_t i = 0; i < m->outputs; i++)
        if (!settles(m, i, &at_one[i]))
            return ERR_SINGULAR;
    for (size_t i = 0; i < m->outputs; i++)
        for (size_t j = 0; j < m->inputs; j++) {
            real_t sum = REAL_C(0.0);
            for (size_t k = 0; k < m->nb; k++)
                sum += m->b[i][j][k];
            gain[i][j] = sum / at_one[i];
        }
    return ERR_OK;
}

static void push(real_t *newest_first, size_t n, real_t x)
{
    for (size_t k = n - 1u; k > 0; k--)
        newest_first[k] = newest_first[k - 1u];
    newest_first[0] = x;
}

void difference_step(const struct difference_model *m, struct difference_state *s, const real_t *u,
                     real_t *y)
{
    for (size_t j = 0; j < m->inputs; j++)
        push(s->u[j], DIFFERENCE_B_MOST, u[j]);
    for (size_t i = 0; i < m->outputs; i++) {
        real_t sum = REAL_C(0.0);
        for (size_t k = 0; k < m->na; k++)
            sum -= m->a[i][k] * s->y[i][k];
        for (size_t j = 0; j < m->inputs; j++)
            for (size_t k = 0; k < m->nb; k++)
                sum += m->b[i][j][k] * s->u[j][k];
        y[i] = sum;
    }
    for (size_t i = 0; i < m->outputs; i++)
        push(s->y[i], DIFFERENCE_A_MOST, y[i]);
}
