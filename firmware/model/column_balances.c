/* Component balances of the stages: rates of the states from flows that are known. Frau (3.2a)-(3.2f), repaired. */
#include "model/column_inside.h"

#define ZERO REAL_C(0.0)

/* Mean molar volume of a composition, by the volumes of a stage. */
static real_t mean_volume(const real_t *x, const real_t *volume, size_t m)
{
    real_t mean = volume[m];
    for (size_t j = 0; j < m; j++)
        mean += x[j] * (volume[j] - volume[m]);
    return mean;
}

/* Conservative form: the liquid leaving a stage, from what its molar holdup gives up. excess: what the flows
 * bring, mol/s. Where the stage needs more than that, it draws liquid from the stage below, of that one's
 * composition and volume: the balances stay closed and every mole fraction stays in [0, 1]. */
static real_t conservative_outflow(const struct column *column, const real_t *x, size_t s,
                                   real_t excess, real_t *rates)
{
    size_t m = column->config->components - 1;
    const real_t *here = &x[s * m], *volume = &column->molar_volume[s * (m + 1)];
    real_t mean = mean_volume(here, volume, m), growth = ZERO; /* of the molar volume, m3/(mol s) */

    for (size_t j = 0; j < m; j++)
        growth += (volume[j] - volume[m]) * rates[s * m + j];
    real_t out = excess + column->holdup[s] * growth / mean; /* excess - dH/dt */
    if (out >= ZERO || s == 0 || s == column->config->stages - 1)
        return out;
    real_t drawn = -out * mean / mean_volume(here - m, volume, m);
    for (size_t j = 0; j < m; j++)
        rates[s * m + j] += drawn * (x[(s - 1) * m + j] - here[j]) / column->holdup[s];
    return -drawn;
}

/* From the top down, because the conservative form hands the change of liquid flow downwards. Written with
 * the holdup's change taken out: H dc/dt = sum of in-flows times (c_in - c), which equals (3.2a)-(3.2f), as
 * repaired, whenever the flows of the stage balance. */
void column_balances(struct column *column, const real_t *x, real_t *rates)
{
    const struct column_config *config = column->config;
    size_t c = config->components, m = c - 1;
    size_t top = config->stages - 1, feed = config->feed_stage - 1;

    for (size_t s = top + 1; s-- > 0;) {
        const real_t *here = &x[s * m];
        const real_t *v = &column->vapour[s * c];
        real_t liquid_in = s == top ? ZERO : column->liquid[s + 1];
        real_t vapour_in = s == 0 ? ZERO : column->vapour_flow[s - 1];
        real_t vapour_out = column->vapour_flow[s];
        real_t feed_in = s == feed ? column->flows.feed : ZERO;

        for (size_t j = 0; j < m; j++) {
            real_t sum = -vapour_out * (v[j] - here[j]);
            if (liquid_in > ZERO)
                sum += liquid_in * (here[m + j] - here[j]);
            if (s > 0)
                sum += vapour_in * (v[j - c] - here[j]);
            if (feed_in > ZERO)
                sum += feed_in * (column->inputs.feed_fraction[j] - here[j]);
            rates[s * m + j] = sum / column->holdup[s];
        }
        if (config->holdup != COLUMN_HOLDUP_CONSERVATIVE)
            continue;
        real_t out =
            conservative_outflow(column, x, s, liquid_in + vapour_in + feed_in - vapour_out, rates);
        if (s == top)
            column->flows.distillate = out - column->flows.reflux;
        else
            column->liquid[s] = out;
        if (s == 0)
            column->flows.bottoms = out;
    }
    if (column_holdups_move(column))
        column_holdup_rates(column, rates);
}
