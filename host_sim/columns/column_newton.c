#include "columns/column_newton.h"

#include "columns/newton_holdups.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* One stage s, changes d of: its liquid x, the vapour v it sends up, the liquid of the stage above (+) and below (-).
 *
 *   H (J d)       = own dx + liquid_in dx+ + drawn dx- + vapour_in dv- - vapour_out dv
 *   dv            = (1 - E) dv- + E slopes dx          (reboiler: slopes dx)
 *
 * Elimination from the reboiler up leaves, as functions of the stage above,
 *   dx = q - liquid_in inverse dx+,   dv = carried dx+ + w
 * with q and w the parts that come from the right-hand side. */
struct stage {
    double holdup, own, liquid_in, drawn, vapour_in, vapour_out;
    double efficiency;
};

struct column_newton {
    size_t stages, m;
    double c;
    struct stage *stage; /* [stages] */
    double *slopes;      /* [stages m m] dy/dx */
    double *inverse;     /* [stages m m] */
    double *up;          /* [stages m m] dv by dx of the same stage, with what comes from below */
    struct newton_holdups *holdups; /* NULL where none moves */
};

struct column_newton *column_newton_create(const struct column_config *config)
{
    struct column_newton *n = calloc(1, sizeof *n);
    if (!n)
        return NULL;
    size_t m = config->components - 1, block = config->stages * m * m;
    n->stages = config->stages;
    n->m = m;
    n->stage = calloc(n->stages, sizeof *n->stage);
    n->slopes = calloc(block, sizeof(double));
    n->inverse = calloc(block, sizeof(double));
    n->up = calloc(block, sizeof(double));
    bool moves = config->levels == COLUMN_LEVELS_HOLDUPS || config->hydraulic_time > 0.0;
    if (moves)
        n->holdups = newton_holdups_create(config);
    if (n->stage && n->slopes && n->inverse && n->up && (n->holdups || !moves))
        return n;
    column_newton_destroy(n);
    return NULL;
}

void column_newton_destroy(struct column_newton *n)
{
    if (!n)
        return;
    newton_holdups_destroy(n->holdups);
    free(n->stage);
    free(n->slopes);
    free(n->inverse);
    free(n->up);
    free(n);
}

void column_newton_read(struct column_newton *n, const struct column *column, const double *x)
{
    size_t m = n->m, c = m + 1, top = n->stages - 1;
    double full[COLUMN_COMPONENTS_MAX], dt[COLUMN_COMPONENTS_MAX];

    if (n->holdups)
        newton_holdups_read(n->holdups, column, x);
    for (size_t s = 0; s <= top; s++) {
        struct stage *at = &n->stage[s];
        bool fed = s + 1 == column->config->feed_stage;
        double feed = fed ? column->flows.feed : 0.0;

        at->holdup = column->holdup[s];
        at->efficiency = s == 0 ? 1.0 : fed ? column->feed_efficiency : column->config->efficiency;
        at->liquid_in = s == top ? 0.0 : fmax(column->liquid[s + 1], 0.0);
        at->drawn = s == 0 || s == top ? 0.0 : fmax(-column->liquid[s], 0.0);
        at->vapour_in = s == 0 ? 0.0 : column->vapour_flow[s - 1];
        at->vapour_out = column->vapour_flow[s];
        at->own = at->vapour_out - at->liquid_in - at->drawn - at->vapour_in - feed;
        if (s == top)
            break; /* no vapour leaves it */
        full[m] = 1.0;
        for (size_t j = 0; j < m; j++) {
            full[j] = x[s * m + j];
            full[m] -= full[j];
        }
        const double *k = &column->k[s * c], *dk = &column->dk[s * c];
        if (column->vle.activity)
            vle_full_slopes(&column->vle, column->temperature[s], full, k, dk, dt,
                            &n->slopes[s * m * m]);
        else
            vle_slopes(c, full, k, dk, dt, &n->slopes[s * m * m]);
    }
}

void column_newton_copy(const struct column_newton *from, struct column_newton *to)
{
    memcpy(to->stage, from->stage, from->stages * sizeof *from->stage);
    memcpy(to->slopes, from->slopes, from->stages * from->m * from->m * sizeof(double));
    if (from->holdups)
        newton_holdups_copy(from->holdups, to->holdups);
}

void column_newton_hold(struct column_newton *n, bool held)
{
    if (n->holdups)
        newton_holdups_hold(n->holdups, held);
}

static void swap_rows(double *a, size_t m, size_t r, size_t s)
{
    for (size_t j = 0; j < m; j++) {
        double keep = a[r * m + j];
        a[r * m + j] = a[s * m + j];
        a[s * m + j] = keep;
    }
}

/* Gauss-Jordan with pivots in columns; a is used up. */
static bool invert(double *a, double *inverse, size_t m)
{
    for (size_t i = 0; i < m * m; i++)
        inverse[i] = i % (m + 1) == 0 ? 1.0 : 0.0;
    for (size_t k = 0; k < m; k++) {
        size_t best = k;
        for (size_t r = k + 1; r < m; r++)
            if (fabs(a[r * m + k]) > fabs(a[best * m + k]))
                best = r;
        double pivot = a[best * m + k];
        if (!(fabs(pivot) > 0.0 && fabs(pivot) < 1e300))
            return false;
        if (best != k) {
            swap_rows(a, m, best, k);
            swap_rows(inverse, m, best, k);
        }
        for (size_t j = 0; j < m; j++) {
            a[k * m + j] /= pivot;
            inverse[k * m + j] /= pivot;
        }
        for (size_t r = 0; r < m; r++) {
            double times = a[r * m + k];
            if (r == k || times == 0.0)
                continue;
            for (size_t j = 0; j < m; j++) {
                a[r * m + j] -= times * a[k * m + j];
                inverse[r * m + j] -= times * inverse[k * m + j];
            }
        }
    }
    return true;
}

bool column_newton_factor(struct column_newton *n, double a, double c)
{
    enum { BLOCK = COLUMN_COMPONENTS_MAX * COLUMN_COMPONENTS_MAX };
    size_t m = n->m, top = n->stages - 1;
    double carried[BLOCK] = {0}, own[BLOCK] = {0};

    n->c = c;
    if (n->holdups && !newton_holdups_factor(n->holdups, a, c))
        return false;
    for (size_t s = 0; s <= top; s++) {
        const struct stage *at = &n->stage[s];
        const double *slopes = &n->slopes[s * m * m];
        double *up = &n->up[s * m * m], *inverse = &n->inverse[s * m * m];
        double e = at->efficiency;

        for (size_t i = 0; i < m * m; i++) {
            double below = s == 0 ? 0.0 : carried[i];
            up[i] = s == top ? 0.0 : (1.0 - e) * below + e * slopes[i];
            own[i] = at->vapour_in * below - at->vapour_out * up[i];
        }
        for (size_t i = 0; i < m; i++)
            own[i * m + i] += a * at->holdup / c + at->own;
        if (!invert(own, inverse, m))
            return false;
        for (size_t i = 0; i < m; i++)
            for (size_t j = 0; j < m; j++) {
                double sum = 0.0;
                for (size_t k = 0; k < m; k++)
                    sum += up[i * m + k] * inverse[k * m + j];
                carried[i * m + j] = -at->liquid_in * sum;
            }
    }
    return true;
}

void column_newton_solve(const struct column_newton *n, const double *b, double *x)
{
    size_t m = n->m, top = n->stages - 1;
    double w[COLUMN_COMPONENTS_MAX] = {0}, right[COLUMN_COMPONENTS_MAX];

    if (n->holdups)
        b = newton_holdups_solve(n->holdups, b, x);
    for (size_t s = 0; s <= top; s++, b += m, x += m) {
        const struct stage *at = &n->stage[s];
        const double *up = &n->up[s * m * m], *inverse = &n->inverse[s * m * m];
        double keep = 1.0 - at->efficiency;
        double from_below = at->vapour_in - at->vapour_out * keep, scale = at->holdup / n->c;

        for (size_t i = 0; i < m; i++) {
            right[i] = scale * b[i] - from_below * w[i];
            if (at->drawn > 0.0)
                right[i] -= at->drawn * x[i - m]; /* no liquid comes down there: x is final */
        }
        for (size_t i = 0; i < m; i++) {
            double sum = 0.0;
            for (size_t j = 0; j < m; j++)
                sum += inverse[i * m + j] * right[j];
            x[i] = sum;
        }
        for (size_t i = 0; i < m; i++) {
            double sum = keep * w[i];
            for (size_t j = 0; j < m; j++)
                sum += up[i * m + j] * x[j];
            w[i] = sum;
        }
    }
    x -= m;
    for (size_t s = top; s-- > 0;) {
        const double *inverse = &n->inverse[s * m * m];
        const double *above = x;
        x -= m;
        for (size_t i = 0; i < m; i++) {
            double sum = 0.0;
            for (size_t j = 0; j < m; j++)
                sum += inverse[i * m + j] * above[j];
            x[i] -= n->stage[s].liquid_in * sum;
        }
    }
}
