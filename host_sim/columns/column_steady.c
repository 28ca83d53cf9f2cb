/* The steady state: KINSOL's Newton with line search and GMRES, and when that fails ever longer transients. */
#include "columns/column_solver_inside.h"

#include <kinsol/kinsol.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sunlinsol/sunlinsol_spgmr.h>

/* Directions of GMRES: what the preconditioner holds fixed, three flows and the holdups, needs fewer. */
#define KRYLOV_MAX 60
#define NEWTON_MAX 60
/* Rates in one search by Newton: KINSOL's line search may turn round for ever on rounding errors. */
#define RATES_MAX  2000
#define DAMPING    1e-3 /* 1/h, of the preconditioner: without vapour the Jacobian is singular */
#define ROUGH      1e-3 /* tolerance of a transient that only has to end near the steady state */
#define STEPS_MAX  2000 /* of one such transient */
#define ROUNDS_MAX 14
#define BALANCED   1e-6  /* of the flows through a vessel: what its level may gain at rest */
#define ROUNDING   1e-15 /* of a flow through a stage: what may be left of its balance by rounding */

/* Change per hour of every mole fraction is zero. */
static int residual(N_Vector y, N_Vector f, void *user)
{
    struct column_solver *s = user;
    if (s->work.rates >= s->rates_max)
        return -1;
    int failed = column_solver_rates(0.0, y, f, s);
    if (!failed)
        N_VScale(HOUR, f, f);
    return failed;
}

/* The preconditioner: the Jacobian with flows and holdups held. */
static int prepare(N_Vector y, N_Vector y_scale, N_Vector f, N_Vector f_scale, void *user)
{
    struct column_solver *s = user;
    (void)y_scale, (void)f_scale;
    if (residual(y, f, s))
        return 1;
    s->work.jacobians++;
    column_newton_read(s->newton, &s->column, NV_DATA_S(y));
    return column_newton_factor(s->newton, DAMPING, -HOUR) ? 0 : 1;
}

static int precondition(N_Vector y, N_Vector y_scale, N_Vector f, N_Vector f_scale, N_Vector v,
                        void *user)
{
    const struct column_solver *s = user;
    (void)y, (void)y_scale, (void)f, (void)f_scale;
    column_newton_solve(s->newton, NV_DATA_S(v), NV_DATA_S(v));
    N_VScale(-1.0, v, v);
    return isfinite(N_VMaxNorm(v)) ? 0 : 1;
}

bool column_steady_create(struct column_solver *s, char *err, size_t size)
{
    s->kinsol = KINCreate(s->context);
    s->krylov = SUNLinSol_SPGMR(s->y, SUN_PREC_RIGHT, KRYLOV_MAX, s->context);
    if (!s->kinsol || !s->krylov ||
        !rosenbrock_init(&s->rough, &s->one_step.problem, ROUGH, 1e-3 * ROUGH))
        return column_solver_fail(err, size, "column", "no memory for the steady-state solver");

    char *(*name)(long) = KINGetReturnFlagName, *(*linear)(long) = KINGetLinReturnFlagName;
    const struct {
        int flag;
        char *(*name)(long);
        const char *call;
    } calls[] = {
        {KINSetErrHandlerFn(s->kinsol, column_solver_keep_message, s), name, "KINSetErrHandlerFn"},
        {KINSetUserData(s->kinsol, s), name, "KINSetUserData"},
        {KINInit(s->kinsol, residual, s->y), name, "KINInit"},
        {KINSetLinearSolver(s->kinsol, s->krylov, NULL), linear, "KINSetLinearSolver"},
        {KINSetPreconditioner(s->kinsol, prepare, precondition), linear, "KINSetPreconditioner"},
        {KINSetFuncNormTol(s->kinsol, s->options.residual), name, "KINSetFuncNormTol"},
        {KINSetScaledStepTol(s->kinsol, 1e-15), name, "KINSetScaledStepTol"},
        {KINSetMaxSetupCalls(s->kinsol, 1), name, "KINSetMaxSetupCalls"},
        {KINSetNumMaxIters(s->kinsol, NEWTON_MAX), name, "KINSetNumMaxIters"},
    };
    for (size_t i = 0; i < sizeof calls / sizeof calls[0]; i++)
        if (!column_solver_checked(s, calls[i].flag, calls[i].name, calls[i].call, err, size))
            return false;
    return true;
}

void column_steady_free(struct column_solver *s)
{
    if (s->kinsol)
        KINFree(&s->kinsol);
    if (s->krylov)
        SUNLinSolFree(s->krylov);
    rosenbrock_free(&s->rough);
}

/* Weights of the rates, by what flows now: 1, and less for the mole fractions of a stage that holds so little for what
 * flows through it, a tray that is all but dry, that rounding alone is more than the residual. */
static void weigh(struct column_solver *s)
{
    const struct column *c = &s->column;
    size_t m = c->config->components - 1;
    double *weight = NV_DATA_S(s->weight);

    for (size_t i = 0; i < s->n; i++)
        weight[i] = 1.0;
    for (size_t i = 0; i < s->column.n_fractions; i++) {
        double through = fabs(c->liquid[i / m]) + c->vapour_flow[i / m];
        double noise = ROUNDING * HOUR * through / c->holdup[i / m];
        if (noise > s->options.residual)
            weight[i] = s->options.residual / noise;
    }
}

/* At rest: no mole fraction changes by more than the residual per hour. */
static bool at_rest(struct column_solver *s)
{
    s->rates_max = s->work.rates + 1;
    if (residual(s->y, s->rates, s))
        return false;
    weigh(s);
    const double *rates = NV_DATA_S(s->rates), *weight = NV_DATA_S(s->weight);
    for (size_t i = 0; i < s->n; i++)
        if (!(fabs(rates[i]) * weight[i] <= s->options.residual))
            return false;
    return true;
}

static bool newton(struct column_solver *s)
{
    bool moved;
    s->model_error = ERR_OK;
    s->rates_max = s->work.rates + RATES_MAX;
    weigh(s);
    int flag = KINSol(s->kinsol, s->y, KIN_LINESEARCH, s->scale, s->weight);
    return flag >= 0 && column_solver_confine(s, &moved) && at_rest(s);
}

/* Follows the transient for a span of time, roughly. */
static bool relax(struct column_solver *s, double span, char *err, size_t size)
{
    bool moved;
    if (column_solver_rates(0.0, s->y, s->rates, s))
        return !column_boiling_lost(s, err, size) &&
               column_solver_fail(err, size, "column", err_text(s->model_error));
    rosenbrock_jump(&s->rough);
    rosenbrock_run(&s->rough, 0.0, span, NV_DATA_S(s->y), NV_DATA_S(s->rates), STEPS_MAX);
    return column_solver_confine(s, &moved) ||
           column_solver_fail(err, size, "column",
                              "the integrator left mole fractions [0, 1] or holdups from 0 on");
}

/* Why there may be none: a product that is nothing lets what it should carry pile up without end. */
static bool nothing_found(const struct column_solver *s, char *err, size_t size)
{
    static const char *const reason[] = {
        "", ": nothing leaves at the bottom, the heat boils all of it away",
        ": nothing leaves at the top, the reflux takes all of it"};
    const struct column_flows *f = &s->column.flows;
    double least = 1e-3 * f->feed;
    int which = f->bottoms < least ? 1 : f->distillate < least ? 2 : 0;
    if (which == 0 && column_boiling_lost(s, err, size))
        return false;
    snprintf(err, size, "column: no steady state found for these inputs%s", reason[which]);
    return false;
}

/* Each round: Newton, and if that fails a longer transient from where it started. A column without vapour has no
 * unique steady state; there the transient alone ends it. guess: work space. */
static bool search(struct column_solver *s, double *guess, char *err, size_t size)
{
    double span = 2.0 * HOUR;

    for (int round = 0; round < ROUNDS_MAX; round++, span *= 2.0) {
        memcpy(guess, NV_DATA_S(s->y), s->n * sizeof *guess);
        if (newton(s))
            return true;
        memcpy(NV_DATA_S(s->y), guess, s->n * sizeof *guess);
        if (!relax(s, span, err, size))
            return false;
        if (at_rest(s))
            return true;
    }
    return nothing_found(s, err, size);
}

/* mol/s that the level of a stage which nothing holds gains. */
static double gained(const struct column_solver *s, size_t stage, enum column_level_by by)
{
    const struct column_config *c = s->column.config;
    size_t at = column_holdup_state(&s->column, stage);
    double nominal = stage == 0 ? c->holdup_reboiler : c->holdup_condenser;

    if (at == s->n || by != COLUMN_LEVEL_FREE)
        return 0.0;
    return nominal * NV_DATA_S(s->rates)[at];
}

/* With the compositions at rest: levels that nothing holds must stand still as well. */
static bool levels_balance(struct column_solver *s, char *err, size_t size)
{
    const struct column_config *c = s->column.config;
    const struct column_flows *f = &s->column.flows;
    const struct {
        const char *name;
        size_t stage;
        enum column_level_by by;
        double through; /* mol/s */
    } vessels[] = {{"reboiler", 0, c->reboiler_level.by, f->vapour_stripping + f->bottoms},
                   {"condenser", c->stages - 1, c->condenser_level.by, f->reflux + f->distillate}};

    if (c->levels != COLUMN_LEVELS_HOLDUPS)
        return true;
    if (!column_solver_refresh(s, false, err, size))
        return false;
    for (size_t i = 0; i < 2; i++) {
        double rate = gained(s, vessels[i].stage, vessels[i].by);
        if (fabs(rate) <= BALANCED * fmax(vessels[i].through, f->feed))
            continue;
        snprintf(err, size,
                 "column: no steady state: the level of the %s runs away, it %s by %.4g mol/s and "
                 "nothing holds it",
                 vessels[i].name, rate > 0.0 ? "rises" : "falls", fabs(rate));
        return false;
    }
    return true;
}

bool column_solver_settle(struct column_solver *s, char *err, size_t err_size)
{
    double *keep = malloc(2 * s->n * sizeof *keep);
    char ignored[80];

    if (!keep)
        return column_solver_fail(err, err_size, "column", "no memory");
    memcpy(keep, NV_DATA_S(s->y), s->n * sizeof *keep);
    s->held = true;
    column_newton_hold(s->newton, true);
    bool settled = search(s, keep + s->n, err, err_size);
    s->held = false;
    column_newton_hold(s->newton, false);
    settled = settled && levels_balance(s, err, err_size);
    if (!settled)
        memcpy(NV_DATA_S(s->y), keep, s->n * sizeof *keep);
    free(keep);
    s->jumped = true;
    bool fresh = column_solver_refresh(s, false, settled ? err : ignored,
                                       settled ? err_size : sizeof ignored);
    return settled && fresh;
}
