#include "columns/rosenbrock.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define STAGES ROSENBROCK_STAGES
#define SAFETY 0.9
#define GROW   6.0
#define SHRINK 0.15

/* In the notation of Hairer and Wanner IV.7: gamma, alpha_ij, gamma_ij, b_i and the embedded b_i. The last stage
 * is the result itself: alpha_4j + gamma_4j = b_j. */
static const double gamma_ii = 0.43586652150845900;
static const double alpha[STAGES][STAGES] = {
    {0.0},
    {0.87173304301691801},
    {0.84457060015369423, -0.11299064236484185},
    {0.0, 0.0, 1.0},
};
static const double gamma_ij[STAGES][STAGES] = {
    {0.0},
    {-0.87173304301691801},
    {-0.90338057013044082, 0.054180672388095326},
    {0.24212380706095346, -1.2232505839045147, 0.54526025533510214},
};
static const double weight[STAGES] = {0.24212380706095346, -1.2232505839045147, 1.5452602553351020,
                                      0.43586652150845900};
static const double embedded[STAGES] = {0.37810903145819369, -0.096042292212423178, 0.5,
                                        0.21793326075422950};

/* Parts of the work space, n numbers each: stages, rates at the step's start and at a stage, a stage's point, the
 * sum over its predecessors (then the error), the result. */
enum { K, OWN = K + STAGES, RATES, AT, PAST, NEW, PARTS };

static double *part(const struct rosenbrock *r, size_t i)
{
    return r->work + i * r->problem.n;
}

bool rosenbrock_init(struct rosenbrock *r, const struct rosenbrock_problem *problem,
                     double relative, double absolute)
{
    *r = (struct rosenbrock){.problem = *problem,
                             .relative = relative,
                             .absolute = absolute,
                             .shortest = 1e-9,
                             .jumped = true};
    r->work = calloc(problem->n * PARTS, sizeof(double));
    return r->work != NULL;
}

void rosenbrock_free(struct rosenbrock *r)
{
    free(r->work);
    r->work = NULL;
}

void rosenbrock_jump(struct rosenbrock *r)
{
    r->jumped = true;
}

static double norm(const struct rosenbrock *r, const double *y, const double *v)
{
    size_t n = r->problem.n;
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        double part = v[i] / (r->relative * fabs(y[i]) + r->absolute);
        sum += part * part;
    }
    return sqrt(sum / (double)n);
}

/* Stage i of a step h from y, with f the rates at its own point:
 * (I - g J) k = h f + g J sum gamma_ij / gamma k_j, g = gamma h; the sum is added to k and taken off again, which
 * saves the product with J. */
static void stage(struct rosenbrock *r, size_t i, double h, const double *f)
{
    size_t n = r->problem.n;
    double *k = part(r, K + i), *past = part(r, PAST);

    if (i == 0) {
        for (size_t q = 0; q < n; q++)
            k[q] = h * f[q];
        r->problem.solve(r->problem.context, k);
        return;
    }
    memset(past, 0, n * sizeof *past);
    for (size_t j = 0; j < i; j++) {
        const double *kj = part(r, K + j);
        double c = gamma_ij[i][j] / gamma_ii;
        for (size_t q = 0; q < n; q++)
            past[q] += c * kj[q];
    }
    for (size_t q = 0; q < n; q++)
        k[q] = h * f[q] + past[q];
    r->problem.solve(r->problem.context, k);
    for (size_t q = 0; q < n; q++)
        k[q] -= past[q];
}

/* One step from y into the part NEW: the weighted error, or a large number where the step cannot be done. */
static double attempt(struct rosenbrock *r, double h, const double *y, const double *f)
{
    const struct rosenbrock_problem *p = &r->problem;
    double *at = part(r, AT), *rates = part(r, RATES), *new = part(r, NEW), *error = part(r, PAST);
    static const double hopeless = 1e9;

    if (!p->factor(p->context, gamma_ii * h))
        return hopeless;
    stage(r, 0, h, f);
    for (size_t i = 1; i < STAGES; i++) {
        memcpy(at, y, p->n * sizeof *at);
        for (size_t j = 0; j < i; j++) {
            const double *kj = part(r, K + j);
            if (alpha[i][j] != 0.0)
                for (size_t q = 0; q < p->n; q++)
                    at[q] += alpha[i][j] * kj[q];
        }
        if (!p->rates(p->context, at, rates))
            return hopeless;
        stage(r, i, h, rates);
    }
    memcpy(new, y, p->n * sizeof *new);
    memset(error, 0, p->n * sizeof *error);
    for (size_t i = 0; i < STAGES; i++) {
        const double *k = part(r, K + i);
        for (size_t q = 0; q < p->n; q++) {
            new[q] += weight[i] * k[q];
            error[q] += (weight[i] - embedded[i]) * k[q];
        }
    }
    double size = norm(r, y, error);
    return isfinite(size) ? size : hopeless;
}

/* Evaluates rates and Jacobian at the result; the next step begins with them. */
static bool prepare(struct rosenbrock *r)
{
    const struct rosenbrock_problem *p = &r->problem;
    double *new = part(r, NEW), *rates = part(r, RATES);

    if (!p->rates(p->context, new, rates))
        return false;
    memcpy(part(r, OWN), rates, p->n * sizeof *rates);
    p->linearise(p->context, new);
    return true;
}

/* The step that would just meet the tolerance, relative to the one that left this error. */
static double factor_of(double error)
{
    return fmin(GROW, fmax(SHRINK, SAFETY * pow(fmax(error, 1e-12), -1.0 / 3.0)));
}

/* A step that moves y by ten times the tolerance, when nothing better is known. */
static double guess(const struct rosenbrock *r, const double *y, const double *f, double stretch)
{
    double speed = norm(r, y, f);
    return speed * stretch > 10.0 ? 10.0 / speed : stretch;
}

double rosenbrock_run(struct rosenbrock *r, double t, double end, double *y, const double *f,
                      int steps_max)
{
    const struct rosenbrock_problem *p = &r->problem;
    double *own = part(r, OWN), stretch = end - t, h = r->jumped ? r->first : r->next;
    bool rejected = false;

    memcpy(own, f, p->n * sizeof *own);
    p->linearise(p->context, y);
    if (!(h > 0.0))
        h = guess(r, y, own, stretch);
    while (t < end && steps_max > 0) {
        double rest = end - t;
        bool last = h >= 0.95 * rest;
        double now = last ? rest : fmin(h, 0.5 * rest); /* no tiny step at the end */
        double error = attempt(r, now, y, own);
        double better = now * factor_of(error);

        if (error > 1.0 || (!last && !prepare(r))) {
            better = fmin(better, 0.5 * now);
            r->rejected++;
            rejected = true;
            h = better;
            if (h < r->shortest * stretch)
                break;
            continue;
        }
        memcpy(y, part(r, NEW), p->n * sizeof *y);
        t = last ? end : t + now;
        r->steps++;
        steps_max--;
        if (rejected)
            better = fmin(better, now);
        rejected = false;
        if (now < h) /* cut short by the end: what was known still holds */
            better = fmax(better, h);
        h = better;
        if (r->jumped)
            r->first = h;
        r->jumped = false;
    }
    r->next = h;
    return t;
}
