#include "interact/measure.h"

#include <stddef.h>

static real_t residence_at_least(const struct interact_plant *plant, size_t output, size_t input,
                                 real_t shortest_s)
{
    real_t sum = interact_residence(plant, output, input);
    return sum > shortest_s ? sum : shortest_s;
}

enum err measure_compute(const struct interact_plant *plant, const struct pairs *pairs,
                         real_t shortest_s, struct measure_work *work, struct measure *result)
{
    enum err err = interact_check(plant, NULL);
    if (!err)
        err = pairs_check(plant, pairs, NULL);
    if (err)
        return err;
    if (!real_is_finite(shortest_s))
        return ERR_NOT_FINITE;
    if (shortest_s <= REAL_C(0.0) || shortest_s > REAL_C(1e6) || pairs->n < 1)
        return ERR_RANGE;
    interact_gains(plant, pairs, &work->gains);
    err = rga_compute(&work->gains, &work->rga, &result->lambda);
    if (err)
        return err;
    for (size_t k = 0; k < pairs->n; k++)
        for (size_t l = 0; l < pairs->n; l++)
            work->gains.value[k][l] =
                work->gains.value[k][l] /
                residence_at_least(plant, pairs->output[k], pairs->input[l], shortest_s);
    err = rga_compute(&work->gains, &work->rga, &result->phi);
    if (err)
        return err;
    result->gamma.rows = result->gamma.cols = pairs->n;
    for (size_t k = 0; k < pairs->n; k++)
        for (size_t l = 0; l < pairs->n; l++) {
            real_t lambda = result->lambda.value[k][l];
            result->gamma.value[k][l] =
                real_abs(lambda) > REAL_C(1e-9) ? result->phi.value[k][l] / lambda : REAL_C(0.0);
        }
    return ERR_OK;
}

bool measure_agrees(const struct measure *m, struct assignment *work)
{
    int32_t own = 0, best;
    uint8_t partner[INTERACT_MAX];
    work->rows = work->cols = m->phi.rows;
    for (size_t k = 0; k < m->phi.rows; k++)
        for (size_t l = 0; l < m->phi.rows; l++) {
            real_t phi = m->phi.value[k][l];
            bool positive = phi > REAL_C(1e-9) && phi < REAL_C(1e9);
            work->cost[k][l] =
                positive ? (int32_t)(real_abs(real_log(phi)) * REAL_C(1e4)) : ASSIGNMENT_FORBIDDEN;
        }
    for (size_t k = 0; k < m->phi.rows; k++) {
        if (work->cost[k][k] == ASSIGNMENT_FORBIDDEN)
            return false;
        own += work->cost[k][k];
    }
    return assignment_solve(work, partner, &best) == ERR_OK && best == own;
}

enum err measure_equivalent(const struct measure *m, const struct interact_plant *plant,
                            const struct pairs *pairs, uint8_t k, struct fopdt *equivalent)
{
    if (k >= pairs->n || k >= m->lambda.rows)
        return ERR_RANGE;
    real_t lambda = m->lambda.value[k][k], gamma = m->gamma.value[k][k];
    if (!(lambda > REAL_C(0.0)) || !(gamma > REAL_C(0.0)))
        return ERR_RANGE;
    const struct fopdt *own = &plant->element[pairs->output[k]][pairs->input[k]];
    *equivalent = (struct fopdt){.gain = own->gain / lambda,
                                 .dead_time_s = own->dead_time_s * gamma,
                                 .time_constant_s = own->time_constant_s * gamma};
    return ERR_OK;
}
