#include "columns/column_solver_inside.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define OVERSHOOT_ALLOWED                                                                          \
    1e-4 /* mole fraction outside [0, 1], relative holdup below 0, that is set back silently */
/* Tolerances of a stretch that has to be done again, and the steps it may take. */
#define CAREFUL           1e-2
#define CAREFUL_SHORTER   1e-4
#define CAREFUL_STEPS_MAX 100000
#define HOLDUP_MAX        1e6 /* over the nominal one; what comes near that is no holdup any more */

/* After a jump of inputs or state the one-step method integrates, which loses nothing by it. A stretch that stays
 * smooth for so many of its steps is handed over to CVODE, whose restart costs about as much as that. */
#define ONE_STEP_MAX 40
/* The embedded solution is one order lower than the result, so its error lies above the result's: with tolerances this
 * much wider than CVODE's the temperatures of the reference runs come out as near. */
#define ONE_STEP_WIDER 3.0

bool column_solver_fail(char *err, size_t size, const char *what, const char *reason)
{
    snprintf(err, size, "%s: %s", what, reason);
    return false;
}

/* SUNDIALS names its return codes; the names are malloc'ed by it. */
bool column_solver_checked(struct column_solver *s, int flag, char *(*name_of)(long),
                           const char *call, char *err, size_t size)
{
    if (flag >= 0)
        return true;
    char *name = name_of(flag);
    if (s->model_error)
        snprintf(err, size, "column: %s returned %s; the model said: %s", call, name,
                 err_text(s->model_error));
    else
        snprintf(err, size, "column: %s returned %s. %s", call, name, s->message);
    free(name);
    return false;
}

void column_solver_keep_message(int code, const char *module, const char *function, char *text,
                                void *user)
{
    struct column_solver *s = user;
    (void)code;
    (void)module;
    snprintf(s->message, sizeof s->message, "%s: %s", function, text);
    for (char *c = s->message; *c; c++)
        if (*c == '\n')
            *c = ' ';
}

int column_solver_rates(realtype t, N_Vector y, N_Vector ydot, void *user)
{
    struct column_solver *s = user;
    (void)t;
    s->work.rates++;
    s->model_error = column_rates(&s->column, NV_DATA_S(y), NV_DATA_S(ydot));
    if (s->held)
        column_solver_hold(s, NV_DATA_S(ydot));
    return s->model_error ? 1 : 0; /* recoverable: a shorter step may do */
}

static bool make_vectors(struct column_solver *s)
{
    sunindextype n = (sunindextype)s->n;
    s->y = N_VNew_Serial(n, s->context);
    s->rates = N_VNew_Serial(n, s->context);
    s->saved = N_VNew_Serial(n, s->context);
    s->absolute = N_VNew_Serial(n, s->context);
    s->scale = N_VNew_Serial(n, s->context);
    s->weight = N_VNew_Serial(n, s->context);
    if (!s->y || !s->rates || !s->saved || !s->absolute || !s->scale || !s->weight)
        return false;
    N_VConst(s->options.absolute, s->absolute);
    N_VConst(1.0, s->scale);
    return true;
}

bool column_solver_refresh(struct column_solver *s, bool again, char *err, size_t size)
{
    double *y = NV_DATA_S(s->y), *rates = NV_DATA_S(s->rates);
    enum err code =
        again ? column_rates_again(&s->column, y, rates) : column_rates(&s->column, y, rates);
    return !code ||
           (!column_boiling_lost(s, err, size) &&
            column_solver_fail(err, size, "column: outputs at the present state", err_text(code)));
}

/* The one-step method's view of the column. */
static bool step_rates(void *context, const double *y, double *f)
{
    struct column_solver *s = context;
    s->work.rates++;
    s->model_error = column_rates(&s->column, y, f);
    if (s->held)
        column_solver_hold(s, f);
    return s->model_error == ERR_OK;
}

static void step_linearise(void *context, const double *y)
{
    struct column_solver *s = context;
    s->work.jacobians++;
    column_newton_read(s->newton, &s->column, y);
}

static bool step_factor(void *context, double g)
{
    struct column_solver *s = context;
    return column_newton_factor(s->newton, 1.0, -g);
}

static void step_solve(void *context, double *b)
{
    const struct column_solver *s = context;
    column_newton_solve(s->newton, b, b);
}

static bool make_one_step(struct column_solver *s)
{
    const struct rosenbrock_problem problem = {.n = s->n,
                                               .context = s,
                                               .rates = step_rates,
                                               .linearise = step_linearise,
                                               .factor = step_factor,
                                               .solve = step_solve};
    s->newton = column_newton_create(s->column.config);
    return s->newton &&
           rosenbrock_init(&s->one_step, &problem, ONE_STEP_WIDER * s->options.relative,
                           ONE_STEP_WIDER * s->options.absolute);
}

struct column_solver *column_solver_create(const struct column_config *config,
                                           const struct column_inputs *inputs,
                                           const struct column_solver_options *options, char *err,
                                           size_t err_size)
{
    struct column_fault fault;
    struct column_solver *s = calloc(1, sizeof *s);

    if (!s) {
        column_solver_fail(err, err_size, "column", "no memory");
        return NULL;
    }
    if (column_init(&s->column, config, &fault)) {
        snprintf(err, err_size, "column: %s must be %s", fault.field, fault.wanted);
        free(s);
        return NULL;
    }
    if (options)
        s->options = *options;
    /* Holdups that move pass their errors on to the mole fractions. */
    double nearer = s->column.n_states > s->column.n_fractions ? 1.0 / 3.0 : 1.0;
    s->options.relative = s->options.relative > 0.0 ? s->options.relative : 3e-6 * nearer;
    s->options.absolute = s->options.absolute > 0.0 ? s->options.absolute : 3e-8 * nearer;
    s->options.residual = s->options.residual > 0.0 ? s->options.residual : 1e-9;
    s->n = s->column.n_states;
    s->jumped = true;

    if (SUNContext_Create(NULL, &s->context) < 0 || !make_vectors(s) || !make_one_step(s)) {
        column_solver_fail(err, err_size, "column", "no memory for the integrators");
        column_solver_destroy(s);
        return NULL;
    }
    if (!column_nominal_start(s, inputs, err, err_size) ||
        !column_solver_set_inputs(s, inputs, err, err_size) ||
        !column_bdf_create(s, err, err_size) || !column_steady_create(s, err, err_size)) {
        column_solver_destroy(s);
        return NULL;
    }
    return s;
}

void column_solver_destroy(struct column_solver *s)
{
    if (!s)
        return;
    column_bdf_free(s);
    column_steady_free(s);
    rosenbrock_free(&s->one_step);
    column_newton_destroy(s->newton);
    N_Vector *vectors[] = {&s->y, &s->rates, &s->saved, &s->absolute, &s->scale, &s->weight};
    for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; i++)
        if (*vectors[i])
            N_VDestroy(*vectors[i]);
    if (s->context)
        SUNContext_Free(&s->context);
    free(s);
}

bool column_solver_set_inputs(struct column_solver *s, const struct column_inputs *inputs,
                              char *err, size_t err_size)
{
    struct column_inputs before = s->column.inputs;
    struct column_fault fault;
    char ignored[80];

    if (column_set_inputs(&s->column, inputs, &fault)) {
        snprintf(err, err_size, "column input %s must be %s", fault.field, fault.wanted);
        return false;
    }
    s->jumped = true;
    if (column_solver_refresh(s, true, err, err_size))
        return true;
    if (!column_set_inputs(&s->column, &before, &fault))
        (void)column_solver_refresh(s, true, ignored, sizeof ignored);
    return false;
}

/* Holdups: an overshoot below 0 is set back. */
static bool confine_holdups(struct column_solver *s, bool *moved)
{
    double *y = NV_DATA_S(s->y);

    for (size_t i = s->column.n_fractions; i < s->n; i++) {
        if (!(y[i] > -OVERSHOOT_ALLOWED && y[i] < HOLDUP_MAX))
            return false;
        if (y[i] < 0.0) {
            y[i] = 0.0;
            *moved = true;
        }
    }
    return true;
}

bool column_solver_confine(struct column_solver *s, bool *moved)
{
    size_t m = s->column.config->components - 1;
    double *x = NV_DATA_S(s->y);

    for (size_t i = 0; i < s->column.config->stages; i++, x += m) {
        double sum = 0.0;
        for (size_t j = 0; j < m; j++) {
            if (!(x[j] > -OVERSHOOT_ALLOWED && x[j] < 1.0 + OVERSHOOT_ALLOWED))
                return false;
            if (x[j] < 0.0) {
                x[j] = 0.0;
                *moved = true;
            }
            sum += x[j];
        }
        if (sum > 1.0 + OVERSHOOT_ALLOWED)
            return false;
        for (size_t j = 0; sum > 1.0 && j < m; j++) {
            x[j] = m == 1 ? 1.0 : x[j] / sum;
            *moved = true;
        }
    }
    return confine_holdups(s, moved);
}

bool column_solver_set_state(struct column_solver *s, const double *x, char *err, size_t err_size)
{
    char ignored[80];

    N_VScale(1.0, s->y, s->saved);
    memcpy(NV_DATA_S(s->y), x, s->n * sizeof *x);
    if (!column_solver_confine(s, &s->jumped))
        column_solver_fail(err, err_size, "column state",
                           s->n > s->column.n_fractions
                               ? "mole fractions must be in [0, 1], holdups 0 or more"
                               : "mole fractions must be in [0, 1]");
    else if (column_solver_refresh(s, false, err, err_size)) {
        s->jumped = true;
        return true;
    }
    N_VScale(1.0, s->saved, s->y);
    (void)column_solver_refresh(s, false, ignored, sizeof ignored);
    return false;
}

const double *column_solver_state(const struct column_solver *s)
{
    return NV_DATA_S(s->y);
}

double column_solver_time(const struct column_solver *s)
{
    return s->t;
}

/* From s->t to t; leaves s->t wherever it came to. */
static bool integrate(struct column_solver *s, double t, char *err, size_t size)
{
    bool afresh = false;

    if (s->jumped) {
        s->jumped = s->multistep = false;
        s->since_jump = 0;
        rosenbrock_jump(&s->one_step);
    }
    if (!s->multistep) {
        long before = s->one_step.steps;
        if (s->since_jump < ONE_STEP_MAX)
            s->t = rosenbrock_run(&s->one_step, s->t, t, NV_DATA_S(s->y), NV_DATA_S(s->rates),
                                  ONE_STEP_MAX - s->since_jump);
        s->since_jump += (int)(s->one_step.steps - before);
        s->work.steps += s->one_step.steps - before;
        afresh = s->multistep = s->t < t; /* too many steps for it, or too hard: CVODE's turn */
    }
    if (s->multistep && !column_bdf_run(s, t, afresh, err, size))
        return false;
    bool moved = false;
    if (!column_solver_confine(s, &moved))
        return column_solver_fail(err, size, "column",
                                  "the integrator left mole fractions [0, 1] or holdups from 0 on");
    s->jumped = moved && s->multistep; /* one step remembers no state */
    return true;
}

/* Back to where the last advance began. */
static void go_back(struct column_solver *s, double t)
{
    char ignored[80];

    N_VScale(1.0, s->saved, s->y);
    s->t = t;
    s->jumped = true;
    (void)column_solver_refresh(s, false, ignored, sizeof ignored);
}

/* A stretch that overshot, as a vessel may do that runs empty or fills up from nothing: once more in one-step steps of far
 * smaller error, however short. */
static bool carefully(struct column_solver *s, double t)
{
    struct rosenbrock *r = &s->one_step;
    double relative = r->relative, absolute = r->absolute, shortest = r->shortest;
    bool moved = false;

    r->shortest *= CAREFUL_SHORTER;
    r->relative *= CAREFUL;
    r->absolute *= CAREFUL;
    rosenbrock_jump(r);
    s->t = rosenbrock_run(r, s->t, t, NV_DATA_S(s->y), NV_DATA_S(s->rates), CAREFUL_STEPS_MAX);
    r->shortest = shortest;
    r->relative = relative;
    r->absolute = absolute;
    s->jumped = true;
    return s->t == t && column_solver_confine(s, &moved);
}

bool column_solver_advance(struct column_solver *s, double t, char *err, size_t err_size)
{
    double before = s->t;

    if (!(t >= s->t && t < 1e300)) {
        snprintf(err, err_size, "column: advance to %g s, which is before the present %g s", t,
                 s->t);
        return false;
    }
    if (t == s->t)
        return true;
    N_VScale(1.0, s->y, s->saved);
    bool done = integrate(s, t, err, err_size);
    if (!done) {
        go_back(s, before);
        done = carefully(s, t);
        if (!done)
            (void)column_boiling_lost(s, err, err_size);
    }
    if (done && column_solver_refresh(s, false, err, err_size)) {
        s->t = t;
        return true;
    }
    go_back(s, before);
    return false;
}

const struct column *column_solver_column(const struct column_solver *s)
{
    return &s->column;
}

struct column_solver_work column_solver_work(const struct column_solver *s)
{
    return s->work;
}
