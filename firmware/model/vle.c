#include "model/vle.h"

#include "model/column_sizes.h"

#define ITERATIONS_MAX 60

/* A last Newton step smaller than FINISH_K is finished by two terms of the series of the vapour pressures,
 * with d2(ln P)/dT2 left out, which saves one evaluation of all exponentials. That derivative, and the
 * spread of the slopes d(ln P)/dT over the components, are below 1e-4 1/K2, so the relative error left is
 * 1e-4 FINISH_K^2. The slopes of activity coefficients are differences over SLOPE_K, taken near the bubble point:
 * what they miss times the last step is left. */
#if defined REFLUX_REAL_DOUBLE
#define FINISH_K          REAL_C(1e-3) /* leaves 1e-10 */
#define FINISH_ACTIVITY_K REAL_C(1e-5)
#define SLOPE_K           REAL_C(1e-2)
#define SLOPE_FRACTION    REAL_C(1e-6) /* the same by mole fractions */
#elif defined REFLUX_REAL_LONG
#define FINISH_K          REAL_C(1e-8) /* leaves 1e-20: derivatives are taken of this build */
#define FINISH_ACTIVITY_K (REAL_EPSILON < REAL_C(1e-17) ? REAL_C(1e-15) : REAL_C(2e-12))
#define SLOPE_K           REAL_C(1e-4)
#define SLOPE_FRACTION    REAL_C(1e-8)
#else
#define FINISH_K          REAL_C(2e-2) /* leaves 4e-8, less than the rounding of a float */
#define FINISH_ACTIVITY_K REAL_C(2e-3)
#define SLOPE_K           REAL_C(1.0)
#define SLOPE_FRACTION    REAL_C(1e-3)
#endif

/* d(ln gamma)/dT, at the temperature it was taken at; good for those near it. */
struct activity_slope {
    real_t temperature; /* K */
    real_t number[COLUMN_COMPONENTS_MAX];
};
#define SLOPE_HOLDS_K REAL_C(1.0)

/* gamma: at this temperature. */
static void take_activity_slope(const struct vle *vle, const real_t *x, real_t temperature,
                                const real_t *gamma, struct activity_slope *slope)
{
    slope->temperature = temperature;
    vle->activity(vle->activity_context, x, temperature + SLOPE_K, slope->number);
    for (size_t j = 0; j < vle->n; j++)
        slope->number[j] = (slope->number[j] / gamma[j] - REAL_C(1.0)) / SLOPE_K;
}

static void equilibrium_ratios(const struct vle *vle, const real_t *x, real_t pressure,
                               real_t temperature, real_t *k, real_t *dk,
                               struct activity_slope *slope)
{
    real_t gamma[COLUMN_COMPONENTS_MAX];
    real_t scale = REAL_C(1.0) / pressure;

    component_vapour_pressures(vle->component, vle->n, temperature, k, dk);
    for (size_t j = 0; j < vle->n; j++) {
        k[j] *= scale;
        dk[j] *= scale;
    }
    if (!vle->activity)
        return;
    vle->activity(vle->activity_context, x, temperature, gamma);
    if (real_abs(temperature - slope->temperature) > SLOPE_HOLDS_K)
        take_activity_slope(vle, x, temperature, gamma, slope);
    for (size_t j = 0; j < vle->n; j++) {
        k[j] *= gamma[j];
        dk[j] = dk[j] * gamma[j] + k[j] * slope->number[j];
    }
}

/* Two terms of the series of the vapour pressures. */
static void move_ratios(size_t n, real_t step, real_t *k, real_t *dk)
{
    for (size_t j = 0; j < n; j++) {
        real_t change = dk[j] * step;
        if (k[j] > REAL_C(0.0)) {
            real_t relative = change / k[j];
            k[j] += change * (REAL_C(1.0) + REAL_C(0.5) * relative);
            dk[j] *= REAL_C(1.0) + relative;
        }
    }
}

/* Newton on ln(sum), nearly a straight line in T. 2 (s - 1)/(s + 1) stands for ln s: equal to third order at the solution and bounded
 * far from it, so that no step runs away. */
static real_t newton_step(real_t sum, real_t slope)
{
    return REAL_C(-2.0) * (sum - REAL_C(1.0)) * sum / ((sum + REAL_C(1.0)) * slope);
}

bool vle_bubble_point_near(const struct vle *vle, const real_t *x, real_t *temperature, real_t *y,
                           real_t *k, real_t *dk)
{
    real_t sum = REAL_C(0.0), slope = REAL_C(0.0);

    for (size_t j = 0; j < vle->n; j++) {
        sum += x[j] * k[j];
        slope += x[j] * dk[j];
    }
    real_t step = newton_step(sum, slope), t = *temperature + step;
    if (vle->activity || !(slope > REAL_C(0.0)) || !(real_abs(step) <= VLE_NEAR_K) ||
        t < vle->temperature_min || t > vle->temperature_max)
        return false;
    move_ratios(vle->n, step, k, dk);
    for (size_t j = 0; j < vle->n; j++)
        y[j] = x[j] * k[j];
    *temperature = t;
    return true;
}

enum err vle_bubble_point(const struct vle *vle, const real_t *x, real_t pressure,
                          real_t *temperature, real_t *y, real_t *k, real_t *dk, bool warm)
{
    size_t n = vle->n;
    real_t t = *temperature;
    struct activity_slope by_temperature;

    if (!isfinite(t))
        return ERR_NOT_FINITE;
    if (t < vle->temperature_min)
        t = vle->temperature_min;
    if (t > vle->temperature_max)
        t = vle->temperature_max;
    real_t finish = vle->activity ? FINISH_ACTIVITY_K : FINISH_K;
    warm = warm && t == *temperature;
    by_temperature.temperature = REAL_C(-1e9);

    for (int i = 0; i < ITERATIONS_MAX; i++) {
        real_t sum = REAL_C(0.0), slope = REAL_C(0.0);

        if (!warm)
            equilibrium_ratios(vle, x, pressure, t, k, dk, &by_temperature);
        for (size_t j = 0; j < n; j++) {
            sum += x[j] * k[j];
            slope += x[j] * dk[j];
        }
        if (!isfinite(sum) || !isfinite(slope))
            return ERR_NOT_FINITE;
        if (slope <= REAL_C(0.0) || sum <= REAL_C(0.0))
            return ERR_RANGE;

        real_t step = newton_step(sum, slope);
        real_t next = t + step;
        if (next < vle->temperature_min || next > vle->temperature_max) {
            real_t edge = next < t ? vle->temperature_min : vle->temperature_max;
            if (t == edge)
                return ERR_RANGE;
            t = edge;
            warm = false;
            continue;
        }
        t = next;
        /* Old ratios only give a start: finishing on them would add up extrapolations call by call. */
        if (!warm && real_abs(step) <= finish) {
            move_ratios(n, step, k, dk);
            for (size_t j = 0; j < n; j++)
                y[j] = x[j] * k[j];
            *temperature = t;
            return ERR_OK;
        }
        warm = false;
    }
    return ERR_RANGE;
}

void vle_slopes(size_t n, const real_t *x, const real_t *k, const real_t *dk, real_t *dt,
                real_t *dy)
{
    size_t last = n - 1;
    real_t slope = REAL_C(0.0);

    for (size_t j = 0; j < n; j++)
        slope += x[j] * dk[j];
    for (size_t j = 0; j < last; j++)
        dt[j] = -(k[j] - k[last]) / slope;
    for (size_t i = 0; i < last; i++) {
        for (size_t j = 0; j < last; j++)
            dy[i * last + j] = x[i] * dk[i] * dt[j];
        dy[i * last + i] += k[i];
    }
}

/* d(ln gamma_i)/dx_j into slopes[i (n - 1) + j], the last fraction closing to 1. */
static void activity_by_fractions(const struct vle *vle, real_t temperature, const real_t *x,
                                  real_t *slopes)
{
    size_t n = vle->n, last = n - 1;
    real_t here[COLUMN_COMPONENTS_MAX], moved[COLUMN_COMPONENTS_MAX], at[COLUMN_COMPONENTS_MAX];

    vle->activity(vle->activity_context, x, temperature, here);
    for (size_t j = 0; j < last; j++) {
        /* inwards: outside [0, 1] coefficients stand still */
        real_t h = x[last] >= SLOPE_FRACTION ? SLOPE_FRACTION : -SLOPE_FRACTION;
        for (size_t i = 0; i < n; i++)
            at[i] = x[i] + (i == j ? h : i == last ? -h : REAL_C(0.0));
        vle->activity(vle->activity_context, at, temperature, moved);
        for (size_t i = 0; i < n; i++)
            slopes[i * last + j] = (moved[i] / here[i] - REAL_C(1.0)) / h;
    }
}

void vle_full_slopes(const struct vle *vle, real_t temperature, const real_t *x, const real_t *k,
                     const real_t *dk, real_t *dt, real_t *dy)
{
    size_t n = vle->n, last = n - 1;
    real_t by_fractions[COLUMN_COMPONENTS_MAX * COLUMN_COMPONENTS_MAX], slope = REAL_C(0.0);

    vle_slopes(n, x, k, dk, dt, dy);
    if (!vle->activity)
        return;
    activity_by_fractions(vle, temperature, x, by_fractions);
    for (size_t i = 0; i < n; i++)
        slope += x[i] * dk[i];
    for (size_t j = 0; j < last; j++) {
        real_t more = REAL_C(0.0); /* dT/dx_j that the coefficients add */
        for (size_t i = 0; i < n; i++)
            more -= x[i] * k[i] * by_fractions[i * last + j] / slope;
        dt[j] += more;
        for (size_t i = 0; i < last; i++)
            dy[i * last + j] += x[i] * (k[i] * by_fractions[i * last + j] + dk[i] * more);
    }
}
