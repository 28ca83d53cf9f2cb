#include "kinds/gmv/gmv_shape.h"

#include "base/assertion.h"

static unsigned inputs_of(const struct gmv_shape *shape, unsigned i)
{
    unsigned count = 0;
    for (unsigned j = 0; j < shape->loops; j++)
        count += shape->delay[i][j] != 0;
    return count;
}

static bool has_bias(const struct gmv_shape *shape)
{
    return shape->form == GMV_POSITIONAL && shape->bias < GMV_BIAS_NONE;
}

unsigned gmv_pv_and_mv_terms(const struct gmv_shape *shape, unsigned i)
{
    return shape->na + inputs_of(shape, i) * shape->nb;
}

unsigned gmv_parameters(const struct gmv_shape *shape, unsigned i)
{
    return gmv_pv_and_mv_terms(shape, i) + shape->disturbances + shape->nc + has_bias(shape);
}

int gmv_place_of_u(const struct gmv_shape *shape, unsigned i, unsigned j)
{
    REFLUX_ASSERT(i < GMV_LOOPS && j < GMV_LOOPS);
    unsigned place = shape->na;
    if (!shape->delay[i][j])
        return -1;
    for (unsigned k = 0; k < shape->loops && j != i; k++) /* its own stands first */
        place += (k == i || k < j) && shape->delay[i][k] ? shape->nb : 0u;
    return (int)place;
}

int gmv_place_of_disturbance(const struct gmv_shape *shape, unsigned i)
{
    return shape->disturbances ? (int)gmv_pv_and_mv_terms(shape, i) : -1;
}

int gmv_place_of_noise(const struct gmv_shape *shape, unsigned i)
{
    return shape->nc ? (int)(gmv_pv_and_mv_terms(shape, i) + shape->disturbances) : -1;
}

int gmv_place_of_bias(const struct gmv_shape *shape, unsigned i)
{
    return has_bias(shape) ? (int)gmv_parameters(shape, i) - 1 : -1;
}

unsigned gmv_horizon(const struct gmv_shape *shape, unsigned i)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    return shape->way == GMV_EXPLICIT ? 1u : shape->delay[i][i];
}

unsigned gmv_behind(const struct gmv_shape *shape, unsigned i, unsigned j)
{
    REFLUX_ASSERT(i < GMV_LOOPS && j < GMV_LOOPS);
    return shape->delay[i][j] - gmv_horizon(shape, i);
}

static unsigned more_steps(unsigned a, unsigned b)
{
    return a > b ? a : b;
}

unsigned gmv_reach(const struct gmv_shape *shape)
{
    unsigned reach = 0;
    for (unsigned i = 0; i < shape->loops; i++) {
        unsigned k = shape->delay[i][i], last = shape->na - 1u;
        for (unsigned j = 0; j < shape->loops; j++)
            if (shape->delay[i][j])
                last = more_steps(last, shape->delay[i][j] + shape->nb - 2u);
        last = more_steps(last, more_steps(shape->nc, shape->disturbance_delay));
        reach = more_steps(reach, 2u * k + last + shape->average);
    }
    return reach;
}

unsigned gmv_history(const struct gmv_shape *shape)
{
    return gmv_reach(shape) + 1u;
}
