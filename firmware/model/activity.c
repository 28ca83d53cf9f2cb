#include "model/activity.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

#define LOGARITHM_MAX REAL_C(50.0) /* of a coefficient: what comes of it stays a number in float */
#define WILSON_MAX    REAL_C(10.0) /* of ln L */
#define NRTL_MAX      REAL_C(20.0) /* of t */

/* Lower mole fractions count as this: an integrator may try points just outside. Derivatives want a liquid that goes on
 * evenly there. */
#ifdef REFLUX_REAL_LONG
#define FRACTION_MIN REAL_C(-0.01)
#else
#define FRACTION_MIN ZERO
#endif

/* a_ij + b_ij / T */
static real_t interaction(const struct activity *activity, size_t at, real_t inverse)
{
    return activity->b ? activity->a[at] + activity->b[at] * inverse : activity->a[at];
}

static enum err entry_wrong(struct column_fault *fault, const char *field, const char *wanted,
                            real_t value)
{
    fault->field = field;
    fault->wanted = wanted;
    return isfinite(value) ? ERR_RANGE : ERR_NOT_FINITE;
}

static enum err check_entry(const struct activity *activity, size_t i, size_t j, const real_t *ends,
                            struct column_fault *fault)
{
    bool nrtl = activity->model == ACTIVITY_NRTL;
    size_t at = i * activity->components + j, across = j * activity->components + i;
    real_t a = activity->a[at], b = activity->b ? activity->b[at] : ZERO;
    real_t most = nrtl ? NRTL_MAX : WILSON_MAX;

    if (i == j && a != ZERO)
        return entry_wrong(fault, "activity.a", "0 on the diagonal", a);
    if (i == j && b != ZERO)
        return entry_wrong(fault, "activity.b", "0 on the diagonal", b);
    if (!isfinite(b))
        return entry_wrong(fault, "activity.b", "a finite number of K", b);
    for (int end = 0; end < 2; end++)
        if (!(real_abs(interaction(activity, at, ONE / ends[end])) <= most))
            return entry_wrong(fault, "activity.a",
                               nrtl ? "such that a + b / T is -20 to 20 at every temperature"
                                    : "such that a + b / T is -10 to 10 at every temperature",
                               a);
    if (!nrtl)
        return ERR_OK;
    if (!real_within(activity->alpha[at], ZERO, ONE))
        return entry_wrong(fault, "activity.alpha", "0 to 1", activity->alpha[at]);
    if (activity->alpha[at] != activity->alpha[across])
        return entry_wrong(fault, "activity.alpha", "symmetric", ZERO);
    return ERR_OK;
}

enum err activity_validate(const struct activity *activity, real_t temperature_min,
                           real_t temperature_max, struct column_fault *fault, size_t *row,
                           size_t *column)
{
    const real_t ends[2] = {temperature_min, temperature_max};

    *row = *column = 0;
    fault->field = "";
    fault->wanted = "";
    if ((unsigned)activity->model > ACTIVITY_NRTL)
        return entry_wrong(fault, "activity.model", "one of enum activity_model", ZERO);
    if (activity->components < 2 || activity->components > COLUMN_COMPONENTS_MAX)
        return entry_wrong(fault, "activity.components", "those of the column", ZERO);
    if (!activity->a)
        return entry_wrong(fault, "activity.a", "a row and a column for every component", ZERO);
    if (activity->model == ACTIVITY_NRTL && !activity->alpha)
        return entry_wrong(fault, "activity.alpha", "a row and a column for every component", ZERO);
    for (size_t i = 0; i < activity->components; i++)
        for (size_t j = 0; j < activity->components; j++) {
            enum err err = check_entry(activity, i, j, ends, fault);
            if (err) {
                *row = i;
                *column = j;
                return err;
            }
        }
    return ERR_OK;
}

static void wilson(const struct activity *activity, const real_t *x, real_t inverse,
                   real_t *logarithm)
{
    size_t n = activity->components;

    for (size_t i = 0; i < n; i++)
        logarithm[i] = ONE;
    for (size_t i = 0; i < n; i++) {
        real_t row[COLUMN_COMPONENTS_MAX], sum = ZERO;
        for (size_t j = 0; j < n; j++) {
            row[j] = i == j ? ONE : real_exp(interaction(activity, i * n + j, inverse));
            sum += x[j] * row[j];
        }
        logarithm[i] -= real_log(sum);
        for (size_t j = 0; j < n; j++)
            logarithm[j] -= x[i] * row[j] / sum;
    }
}

/* Column by column of t and G: that of j belongs to S_j and C_j. */
static void nrtl(const struct activity *activity, const real_t *x, real_t inverse,
                 real_t *logarithm)
{
    size_t n = activity->components;

    for (size_t i = 0; i < n; i++)
        logarithm[i] = ZERO;
    for (size_t j = 0; j < n; j++) {
        real_t t[COLUMN_COMPONENTS_MAX], g[COLUMN_COMPONENTS_MAX], s = ZERO, c = ZERO;
        for (size_t k = 0; k < n; k++) {
            t[k] = k == j ? ZERO : interaction(activity, k * n + j, inverse);
            g[k] = k == j ? ONE : real_exp(-activity->alpha[k * n + j] * t[k]);
            s += x[k] * g[k];
            c += x[k] * t[k] * g[k];
        }
        real_t mean = c / s;
        logarithm[j] += mean;
        for (size_t k = 0; k < n; k++)
            logarithm[k] += x[j] * g[k] / s * (t[k] - mean);
    }
}

void activity_coefficients(void *context, const real_t *x, real_t temperature, real_t *gamma)
{
    const struct activity *activity = context;
    real_t inverse = ONE / temperature, inside[COLUMN_COMPONENTS_MAX];

    for (size_t j = 0; j < activity->components; j++)
        inside[j] = x[j] > FRACTION_MIN ? x[j] : FRACTION_MIN;
    if (activity->model == ACTIVITY_WILSON)
        wilson(activity, inside, inverse, gamma);
    else
        nrtl(activity, inside, inverse, gamma);
    for (size_t j = 0; j < activity->components; j++) {
        real_t logarithm = gamma[j];
        if (logarithm > LOGARITHM_MAX)
            logarithm = LOGARITHM_MAX;
        if (logarithm < -LOGARITHM_MAX)
            logarithm = -LOGARITHM_MAX;
        gamma[j] = real_exp(logarithm);
    }
}
