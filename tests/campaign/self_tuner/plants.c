/* Linear plants, exact between steps of a second. */
#include <math.h>

#include "self_tuner.h"

double random_uniform(struct random_source *r, double lo, double hi)
{
    return lo + (hi - lo) * ((double)(random_next(r) >> 11) + 0.5) / 9007199254740992.0;
}

double random_normal(struct random_source *r)
{
    double u = random_uniform(r, 0, 1), v = random_uniform(r, 0, 1);
    return sqrt(-2 * log(u)) * cos(6.283185307179586 * v);
}

/* x(t + 1) = exp(A) x + integral of exp(A s) ds b, by halving and Taylor's series. */
static void discretise(struct element *e, double a[STATES][STATES], const double *b)
{
    enum { HALVINGS = 10, TERMS = 8 };
    double term[STATES + 1][STATES + 1] = {{0}}, sum[STATES + 1][STATES + 1] = {{0}};
    double rate[STATES + 1][STATES + 1] = {{0}}, next[STATES + 1][STATES + 1];
    for (unsigned i = 0; i < STATES; i++) {
        for (unsigned j = 0; j < STATES; j++)
            rate[i][j] = ldexp(a[i][j], -HALVINGS);
        rate[i][STATES] = ldexp(b[i], -HALVINGS);
    }
    for (unsigned i = 0; i <= STATES; i++)
        term[i][i] = sum[i][i] = 1;
    for (unsigned n = 1; n <= TERMS + HALVINGS; n++) {
        for (unsigned i = 0; i <= STATES; i++)
            for (unsigned j = 0; j <= STATES; j++) {
                next[i][j] = 0;
                for (unsigned k = 0; k <= STATES; k++)
                    next[i][j] += n <= TERMS ? term[i][k] * rate[k][j] / n : sum[i][k] * sum[k][j];
            }
        for (unsigned i = 0; i <= STATES; i++)
            for (unsigned j = 0; j <= STATES; j++) {
                term[i][j] = next[i][j];
                sum[i][j] = n <= TERMS ? sum[i][j] + next[i][j] : next[i][j];
            }
    }
    for (unsigned i = 0; i < STATES; i++) {
        for (unsigned j = 0; j < STATES; j++)
            e->a[i][j] = sum[i][j];
        e->b[i] = sum[i][STATES];
    }
}

/* Two lags with the zero behind the second one, then the resonance. */
static void element_begin(struct element *e, const struct element_spec *s)
{
    double a[STATES][STATES] = {{0}}, b[STATES] = {0}, out[2] = {0, 0};
    double w = s->resonance_s > 0 ? 1 / s->resonance_s : 0;
    memset(e, 0, sizeof *e);
    e->gain = s->gain;
    e->dead = (unsigned)lround(s->dead);
    if (s->t1 <= 0)
        return;
    a[0][0] = -1 / s->t1;
    b[0] = 1 / s->t1;
    if (s->t2 > 0) {
        a[1][0] = 1 / s->t2;
        a[1][1] = -1 / s->t2;
        out[0] = -s->zero / s->t2;
        out[1] = 1 + s->zero / s->t2;
    } else {
        out[0] = 1;
    }
    if (w > 0) {
        a[2][3] = 1;
        a[3][0] = w * w * out[0];
        a[3][1] = w * w * out[1];
        a[3][2] = -w * w;
        a[3][3] = -2 * s->damping * w;
    }
    e->c[0] = w > 0 ? 0 : out[0];
    e->c[1] = w > 0 ? 0 : out[1];
    e->c[2] = w > 0;
    discretise(e, a, b);
}

static double element_out(const struct element *e)
{
    double y = 0;
    for (unsigned i = 0; i < STATES; i++)
        y += e->c[i] * e->x[i];
    return y * e->gain;
}

static void element_second(struct element *e, double u, unsigned dead)
{
    double next[STATES];
    e->late[e->newest] = u;
    u = e->late[(e->newest + DEAD_MOST - dead) % DEAD_MOST];
    e->newest = (e->newest + 1u) % DEAD_MOST;
    for (unsigned i = 0; i < STATES; i++) {
        next[i] = e->b[i] * u;
        for (unsigned j = 0; j < STATES; j++)
            next[i] += e->a[i][j] * e->x[j];
    }
    memcpy(e->x, next, sizeof next);
}

void plant_begin(struct linear_plant *p, const struct plant_spec *spec)
{
    memset(p, 0, sizeof *p);
    p->spec = spec;
    for (unsigned i = 0; i < spec->loops; i++)
        for (unsigned j = 0; j < spec->loops; j++)
            element_begin(&p->element[i][j], &spec->element[i][j]);
}

void plant_second(struct linear_plant *p, const double *u, const double *load)
{
    bool late = p->spec->late_s > 0 && p->time_s >= p->spec->late_from_s;
    for (unsigned j = 0; j < p->spec->loops; j++) {
        double half = p->spec->stuck / 2;
        p->valve[j] = fmin(fmax(p->valve[j], u[j] - half), u[j] + half);
    }
    for (unsigned i = 0; i < p->spec->loops; i++)
        for (unsigned j = 0; j < p->spec->loops; j++) {
            struct element *e = &p->element[i][j];
            element_second(e, p->valve[j] + load[j],
                           late ? (unsigned)lround(p->spec->late_s) : e->dead);
        }
    p->time_s += 1;
}

double plant_pv(const struct linear_plant *p, unsigned i)
{
    double y = 0;
    for (unsigned j = 0; j < p->spec->loops; j++)
        y += element_out(&p->element[i][j]);
    return REST + y * (p->spec->gain_times > 0 && p->time_s >= p->spec->gain_from_s
                           ? p->spec->gain_times
                           : 1);
}
