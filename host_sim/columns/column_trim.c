#include "columns/column_trim.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "model/vle.h"

#define TRIMS_MAX    COLUMN_DRIVES_MAX
#define ROUNDS_MAX   80
#define HALVINGS_MAX 12
/* Slopes are differences to both sides, of inputs' sizes. Two inputs may do nearly the same (reflux and boil-up of pure
 * products): what they do differently is a thousandth of a slope. So no difference moves a miss by more than a little. */
#define DIFFERENCE       1e-5  /* at most */
#define FINEST           1e-11 /* at least */
#define MOVED            1e-3
#define LONGEST_STEP     0.5 /* of an input's size, in one round */
#define LONGEST_MOVE     1.0 /* of a miss, in one round: so far a column is nearly linear in logits */
#define RESIDUAL         1e-11 /* of steady states, 1/h: what is rare in a product changes slowly */
#define MET              1e-6  /* largest miss: of a logit, or of the channel's span or value */
#define NEAR_ENOUGH      1e-11 /* no further round is worth it */
#define MARGIN           1e-12 /* logits end so near 0 and 1 */
#define AZEOTROPE_ROUNDS 40    /* halvings between the composition reached and the one wanted */

struct search {
    const struct column_config *config;
    struct column_terms *terms;
    struct plant_channel *channels;
    const struct column_trim *trim;
    size_t n;
    struct column_solver *solver;
    double size[TRIMS_MAX]; /* of the inputs: what a step is measured by */
    double point[TRIMS_MAX], miss[TRIMS_MAX], reached[TRIMS_MAX]; /* where the search has come to */
    double seen[TRIMS_MAX]; /* values of the state that was settled last */
    bool stuck; /* the inputs do not move the values apart where the search has come to */
    char *err;
    size_t err_size;
};

static double *input_of(struct search *s, size_t driven)
{
    return driven < s->terms->n_inputs ? &s->channels[driven].nominal
                                       : &s->terms->driven[driven].value;
}

static const struct plant_channel *channel_of(const struct search *s, size_t seen)
{
    return &s->channels[s->terms->n_inputs + seen];
}

static double logit(double x)
{
    x = fmin(fmax(x, MARGIN), 1.0 - MARGIN);
    return log(x / (1.0 - x));
}

/* Distance left, in the scale in which a column is nearest to linear. */
static double miss_of(const struct search *s, size_t i, double value)
{
    const struct column_seen *c = &s->terms->seen[s->trim[i].seen];
    const struct plant_channel *channel = channel_of(s, s->trim[i].seen);
    if (c->sight == SIGHT_FRACTION || c->sight == SIGHT_VAPOUR_FRACTION)
        return logit(value / c->unit->times) - logit(s->trim[i].value / c->unit->times);
    /* A span far wider than the value must not make the search content with less. */
    return (value - s->trim[i].value) /
           fmin(channel->hi - channel->lo, fmax(fabs(s->trim[i].value), 1.0));
}

static bool inputs_now(struct search *s, struct column_inputs *in)
{
    double u[COLUMN_DRIVES_MAX];
    for (size_t i = 0; i < s->terms->n_inputs; i++)
        u[i] = s->channels[i].nominal;
    const char *wrong = column_terms_inputs(s->terms, s->config, u, in);
    if (wrong)
        snprintf(s->err, s->err_size, "what is nominal %s", wrong);
    return !wrong;
}

/* The steady state at the values v, and how far off it is. */
static bool settle_at(struct search *s, const double *v, double *miss)
{
    struct column_inputs in;

    for (size_t i = 0; i < s->n; i++)
        *input_of(s, s->trim[i].driven) = v[i];
    if (!inputs_now(s, &in) || !column_solver_set_inputs(s->solver, &in, s->err, s->err_size) ||
        !column_solver_settle(s->solver, s->err, s->err_size))
        return false;
    for (size_t i = 0; i < s->n; i++) {
        s->seen[i] = column_terms_value(s->terms, column_solver_column(s->solver),
                                        column_solver_state(s->solver), s->trim[i].seen);
        miss[i] = miss_of(s, i, s->seen[i]);
    }
    return true;
}

static double largest(const double *x, size_t n)
{
    double most = 0.0;
    for (size_t i = 0; i < n; i++)
        most = fmax(most, fabs(x[i]));
    return most;
}

/* The misses with input j moved by a step, within its bounds; *moved: by how much it was. */
static bool beside(struct search *s, size_t j, double step, double *moved, double *miss)
{
    double v[TRIMS_MAX];
    memcpy(v, s->point, sizeof v);
    v[j] = fmin(fmax(v[j] + step, s->trim[j].lo), s->trim[j].hi);
    *moved = v[j] - s->point[j];
    return settle_at(s, v, miss);
}

/* slope[i][j]: of miss i by input j, a whole size of it. */
static bool slopes(struct search *s, double slope[TRIMS_MAX][TRIMS_MAX])
{
    double up[TRIMS_MAX] = {0}, down[TRIMS_MAX] = {0}, above = 0.0, below = 0.0;

    for (size_t j = 0; j < s->n; j++) {
        double step = DIFFERENCE * s->size[j], most;
        do {
            if (!beside(s, j, step, &above, up) || !beside(s, j, -step, &below, down))
                return false;
            most = 0.0;
            for (size_t i = 0; i < s->n; i++)
                most = fmax(most, fabs(up[i] - down[i]));
            step *= fmin(0.5, MOVED / fmax(most, MOVED));
        } while (most > 2.0 * MOVED && step >= FINEST * s->size[j]);
        for (size_t i = 0; i < s->n; i++)
            slope[i][j] = (up[i] - down[i]) / (above - below) * s->size[j];
    }
    return true;
}

/* Solves slope * step = -miss by elimination with row exchange; false where the inputs do not move the values apart. */
static bool newton_step(struct search *s, double slope[TRIMS_MAX][TRIMS_MAX], double *step)
{
    size_t n = s->n;

    for (size_t i = 0; i < n; i++)
        step[i] = -s->miss[i];
    for (size_t k = 0; k < n; k++) {
        size_t pivot = k;
        for (size_t i = k + 1; i < n; i++)
            pivot = fabs(slope[i][k]) > fabs(slope[pivot][k]) ? i : pivot;
        if (!(fabs(slope[pivot][k]) > 1e-12)) {
            s->stuck = true;
            return false;
        }
        for (size_t j = 0; j < n && pivot != k; j++) {
            double swap = slope[k][j];
            slope[k][j] = slope[pivot][j];
            slope[pivot][j] = swap;
        }
        double swap = step[k];
        step[k] = step[pivot];
        step[pivot] = swap;
        for (size_t i = k + 1; i < n; i++) {
            double f = slope[i][k] / slope[k][k];
            for (size_t j = k; j < n; j++)
                slope[i][j] -= f * slope[k][j];
            step[i] -= f * step[k];
        }
    }
    for (size_t k = n; k-- > 0;) {
        for (size_t j = k + 1; j < n; j++)
            step[k] -= slope[k][j] * step[j];
        step[k] /= slope[k][k];
    }
    double part = fmin(1.0, fmin(LONGEST_STEP / fmax(largest(step, n), LONGEST_STEP),
                                 LONGEST_MOVE / fmax(largest(s->miss, n), LONGEST_MOVE)));
    for (size_t k = 0; k < n; k++)
        step[k] *= part;
    return true;
}

/* Goes as much of the step as makes it better. */
static bool improve(struct search *s, const double *step)
{
    double part = 1.0, v[TRIMS_MAX], miss[TRIMS_MAX];

    for (int k = 0; k < HALVINGS_MAX; k++, part *= 0.5) {
        for (size_t i = 0; i < s->n; i++)
            v[i] =
                fmin(fmax(s->point[i] + part * step[i] * s->size[i], s->trim[i].lo), s->trim[i].hi);
        if (settle_at(s, v, miss) && largest(miss, s->n) < largest(s->miss, s->n)) {
            memcpy(s->point, v, sizeof v);
            memcpy(s->miss, miss, sizeof miss);
            memcpy(s->reached, s->seen, sizeof s->reached);
            return true;
        }
    }
    return false;
}

static double rounded(double x)
{
    char text[40];
    snprintf(text, sizeof text, "%.7g", x);
    return strtod(text, NULL);
}

/* " with L = 1 mol/s, its highest, ..." */
static void say_inputs(const struct search *s, char *at, size_t size)
{
    size_t used = 0;
    for (size_t i = 0; i < s->n && used < size; i++) {
        const struct column_trim *t = &s->trim[i];
        const char *name =
            t->driven < s->terms->n_inputs ? s->channels[t->driven].name : "the constant";
        int n = snprintf(at + used, size - used, "%s%s = %.6g %s%s", i > 0 ? ", " : " with ", name,
                         s->point[i], s->terms->driven[t->driven].unit->name,
                         s->point[i] <= t->lo   ? ", its lowest"
                         : s->point[i] >= t->hi ? ", its highest"
                                                : "");
        used += n > 0 ? (size_t)n : 0;
    }
    if (s->stuck && used < size)
        snprintf(
            at + used, size - used,
            ", where they do not move them apart: a search from other nominal values may help");
}

/* Mole fraction of the first of two components, by mole or by mass. */
static double mole_fraction(const struct column_config *config, const struct column_seen *c,
                            double fraction)
{
    if (c->unit->measure != MEASURE_MASS_FRACTION)
        return fraction;
    const struct component *own = &config->component[c->component[0]],
                           *other = &config->component[1 - c->component[0]];
    return fraction / own->molar_mass /
           (fraction / own->molar_mass + (1.0 - fraction) / other->molar_mass);
}

/* Vapour fraction less liquid fraction of the component that is seen, of two. NAN: no bubble point. */
static double enrichment(const struct search *s, const struct column_seen *c, double fraction)
{
    const struct column_config *config = s->config;
    const struct column *column = column_solver_column(s->solver);
    struct vle vle = {.component = config->component,
                      .n = 2,
                      .activity = config->activity,
                      .activity_context = config->activity_context,
                      .temperature_min = config->temperature_min,
                      .temperature_max = config->temperature_max};
    double x[2], y[2], k[2], dk[2], temperature = column->temperature[c->stage[0]];
    x[c->component[0]] = mole_fraction(config, c, fraction);
    x[1 - c->component[0]] = 1.0 - x[c->component[0]];
    if (vle_bubble_point(&vle, x, column->pressure[c->stage[0]], &temperature, y, k, dk, false) !=
        ERR_OK)
        return NAN;
    return y[c->component[0]] - x[c->component[0]];
}

/* Finds, with two components, a composition between what was reached and what was wanted that no stage gets past. */
static bool azeotrope(const struct search *s, size_t i, double *value)
{
    const struct column_seen *c = &s->terms->seen[s->trim[i].seen];
    if (c->sight != SIGHT_FRACTION || c->n_components != 1 || c->n_stages != 1 ||
        s->config->components != 2)
        return false;
    double reached = s->reached[i] / c->unit->times, wanted = s->trim[i].value / c->unit->times;
    double at_reached = enrichment(s, c, reached);
    if (!(at_reached * enrichment(s, c, wanted) < 0.0))
        return false;
    for (int k = 0; k < AZEOTROPE_ROUNDS; k++) {
        double middle = 0.5 * (reached + wanted);
        if (enrichment(s, c, middle) * at_reached > 0.0)
            reached = middle;
        else
            wanted = middle;
    }
    *value = reached * c->unit->times;
    return true;
}

/* One line: every value as it came and as it was wanted, and the inputs there. */
static bool not_met(const struct search *s)
{
    size_t used = (size_t)snprintf(s->err, s->err_size, "cannot be met");
    double at;

    for (size_t i = 0; i < s->n && used < s->err_size; i++)
        if (azeotrope(s, i, &at))
            used += (size_t)snprintf(
                s->err + used, s->err_size - used, ": an azeotrope is in the way, at %s = %.4g %s",
                channel_of(s, s->trim[i].seen)->name, at, channel_of(s, s->trim[i].seen)->unit);
    if (used < s->err_size)
        used += (size_t)snprintf(s->err + used, s->err_size - used, "; nearest is ");
    for (size_t i = 0; i < s->n && used < s->err_size; i++) {
        const struct plant_channel *c = channel_of(s, s->trim[i].seen);
        int n = snprintf(s->err + used, s->err_size - used, "%s%s = %.6g %s (wanted %.6g)",
                         i > 0 ? ", " : "", c->name, s->reached[i], c->unit, s->trim[i].value);
        used += n > 0 ? (size_t)n : 0;
    }
    if (used < s->err_size)
        say_inputs(s, s->err + used, s->err_size - used);
    return false;
}

/* Says why the search has no steady state to start from, and names the inputs. */
static bool no_start(const struct search *s)
{
    size_t used = strlen(s->err);
    if (s->n > 0)
        say_inputs(s, s->err + used, s->err_size - used);
    return false;
}

static bool seek(struct search *s)
{
    double slope[TRIMS_MAX][TRIMS_MAX], step[TRIMS_MAX] = {0};

    for (size_t i = 0; i < s->n; i++)
        s->point[i] = *input_of(s, s->trim[i].driven);
    if (!settle_at(s, s->point, s->miss))
        return no_start(s);
    memcpy(s->reached, s->seen, sizeof s->reached);
    for (int round = 0; round < ROUNDS_MAX && largest(s->miss, s->n) > NEAR_ENOUGH; round++)
        if (!slopes(s, slope) || !newton_step(s, slope, step) || !improve(s, step))
            break;
    if (!(largest(s->miss, s->n) <= MET))
        return not_met(s);
    for (size_t i = 0; i < s->n; i++)
        s->point[i] = fmin(fmax(rounded(s->point[i]), s->trim[i].lo), s->trim[i].hi);
    return settle_at(s, s->point, s->miss);
}

bool column_trim_find(const struct column_config *config, struct column_terms *terms,
                      struct plant_channel *channels, const struct column_trim *trim, size_t n,
                      struct column *at, double *x, char *err, size_t err_size)
{
    struct column_config perfect = *config;
    struct column_inputs in;
    struct search s = {.config = config,
                       .terms = terms,
                       .channels = channels,
                       .trim = trim,
                       .n = n,
                       .err = err,
                       .err_size = err_size};

    perfect.levels = COLUMN_LEVELS_PERFECT;
    perfect.hydraulic_time = 0.0;
    for (size_t i = 0; i < n; i++) {
        double start = fabs(*input_of(&s, trim[i].driven));
        s.size[i] = start > 0.0 ? start : 0.1 * (trim[i].hi - trim[i].lo);
    }
    if (!inputs_now(&s, &in))
        return false;
    s.solver = column_solver_create(
        &perfect, &in, &(struct column_solver_options){.residual = RESIDUAL}, err, err_size);
    bool found = s.solver && seek(&s);
    if (found) {
        *at = *column_solver_column(s.solver);
        at->config = config;
        memcpy(x, column_solver_state(s.solver), at->n_states * sizeof *x);
    }
    column_solver_destroy(s.solver);
    return found;
}
