#include "libreflux.h"

#include <stdio.h>
#include <string.h>

#include "design/detune.h"
#include "design/static_decoupler.h"
#include "design/trial.h"
#include "interact/cascade.h"
#include "interact/gains.h"
#include "interact/measure.h"
#include "interact/pairing.h"
#include "interact/structure.h"

const char *reflux_error_text(int32_t error)
{
    return err_text((enum err)error);
}

static enum err take_plant(const struct reflux_plant *from, struct interact_plant *plant)
{
    memset(plant, 0, sizeof *plant);
    if (from->outputs < 1 || from->outputs > INTERACT_MAX || from->inputs < 1 ||
        from->inputs > INTERACT_MAX)
        return ERR_RANGE;
    plant->outputs = (uint8_t)from->outputs;
    plant->inputs = (uint8_t)from->inputs;
    for (int i = 0; i < from->outputs; i++)
        for (int j = 0; j < from->inputs; j++) {
            int k = i * from->inputs + j;
            plant->element[i][j] =
                (struct fopdt){from->gain[k], from->dead_time_s[k], from->time_constant_s[k]};
            plant->gain_sd[i][j] = from->gain_sd[k];
        }
    return interact_check(plant, NULL);
}

static enum err take_pairs(int32_t n, const int32_t *output, const int32_t *input,
                           struct pairs *pairs)
{
    if (n < 0 || n > INTERACT_MAX)
        return ERR_RANGE;
    pairs->n = (uint8_t)n;
    for (int k = 0; k < n; k++) {
        if (output[k] < 0 || output[k] >= INTERACT_MAX || input[k] < 0 || input[k] >= INTERACT_MAX)
            return ERR_RANGE;
        pairs->output[k] = (uint8_t)output[k];
        pairs->input[k] = (uint8_t)input[k];
    }
    return ERR_OK;
}

static enum err take_matrix(int32_t n, const double *from, struct matrix *to)
{
    if (n < 1 || n > MATRIX_MAX)
        return ERR_RANGE;
    to->rows = to->cols = (uint8_t)n;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            to->value[i][j] = from[i * n + j];
    return ERR_OK;
}

static void give_matrix(const struct matrix *from, double *to)
{
    for (int i = 0; i < from->rows; i++)
        for (int j = 0; j < from->cols; j++)
            to[i * from->cols + j] = from->value[i][j];
}

static void say_why(const struct interact_refusal *from, char *reason)
{
    if (!reason)
        return;
    int at = snprintf(reason, REFLUX_WHY_BYTES, "%s: %s", from->field ? from->field : "",
                      from->wanted ? from->wanted : "");
    if (from->output != INTERACT_NONE && at > 0 && at < REFLUX_WHY_BYTES)
        snprintf(reason + at, (size_t)(REFLUX_WHY_BYTES - at), " (output %u, input %u)",
                 from->output + 1u, from->input + 1u);
}

int32_t reflux_rga(const struct reflux_plant *plant, double *lambda)
{
    struct interact_plant p;
    struct matrix k, l;
    struct rga_work work;
    enum err err = take_plant(plant, &p);
    if (err)
        return err;
    interact_gains(&p, NULL, &k);
    err = rga_compute(&k, &work, &l);
    if (!err)
        give_matrix(&l, lambda);
    return err;
}

int32_t reflux_rga_at(const struct reflux_plant *plant, int32_t n_omega, const double *omega,
                      double *modulus, double *real_part)
{
    struct interact_plant p;
    struct rga_at_work work;
    struct matrix m, r;
    enum err err = take_plant(plant, &p);
    for (int k = 0; k < n_omega && !err; k++) {
        err = rga_at(&p, NULL, omega[k], &work, &m, &r);
        if (err)
            break;
        size_t at = (size_t)k * p.outputs * p.inputs;
        give_matrix(&m, modulus + at);
        give_matrix(&r, real_part + at);
    }
    return err;
}

int32_t reflux_gains(const struct reflux_plant *plant, double floor, double *singular,
                     double *numbers, double *null_inputs, double *null_outputs)
{
    struct interact_plant p;
    struct gains g;
    enum err err = take_plant(plant, &p);
    if (!err)
        err = gains_begin(&g, &p, floor);
    if (err)
        return err;
    while ((err = gains_step(&g)) == ERR_BUSY)
        ;
    if (err)
        return err;
    for (int k = 0; k < p.outputs && k < p.inputs; k++)
        singular[k] = g.singular[k];
    numbers[0] = g.condition;
    numbers[1] = g.condition_scaled;
    numbers[2] = g.rank;
    numbers[3] = g.rank_exact;
    numbers[4] = g.smallest_in_sd;
    for (unsigned k = 0; gains_null_input(&g, k, null_inputs + (size_t)k * p.inputs) == ERR_OK; k++)
        ;
    for (unsigned k = 0; gains_null_output(&g, k, null_outputs + (size_t)k * p.outputs) == ERR_OK;
         k++)
        ;
    return ERR_OK;
}

void reflux_pairing_defaults(double *settings)
{
    struct pairing_config c;
    pairing_config_default(&c);
    const double all[] = {c.smallest_lambda, c.floor,       c.confidence, c.draws,
                          (double)c.seed,    c.outputs_out, c.inputs_out};
    memcpy(settings, all, sizeof all);
}

int32_t reflux_pairing(const struct reflux_plant *plant, const double *settings, int32_t *n,
                       int32_t *output, int32_t *input, double *lambda, double *numbers,
                       double *share, int32_t *rival, char *reason)
{
    static struct pairing work; /* 20 KiB; the library is not for threads */
    struct interact_plant p;
    struct interact_refusal refusal = {0};
    enum err err = take_plant(plant, &p);
    for (int k = 3; k < 7 && !err; k++)
        if (!(settings[k] >= 0.0 && settings[k] < (k == 4 ? 9e15 : 65536.0)))
            err = ERR_RANGE;
    if (err)
        return err;
    struct pairing_config c;
    pairing_config_default(&c);
    c.smallest_lambda = settings[0];
    c.floor = settings[1];
    c.confidence = settings[2];
    c.draws = (uint16_t)settings[3];
    c.seed = (uint64_t)settings[4];
    c.outputs_out = (uint16_t)settings[5];
    c.inputs_out = (uint16_t)settings[6];
    err = pairing_begin(&work, &p, &c, &refusal);
    if (err) {
        say_why(&refusal, reason);
        return err;
    }
    while ((err = pairing_step(&work)) == ERR_BUSY)
        ;
    *n = work.pairs.n;
    for (int k = 0; k < work.pairs.n; k++) {
        output[k] = work.pairs.output[k];
        input[k] = work.pairs.input[k];
        lambda[k] = work.lambda[k];
    }
    numbers[0] = work.verdict;
    numbers[1] = work.niederlinski;
    numbers[2] = work.cost;
    numbers[3] = work.probability;
    for (int i = 0; i < p.outputs; i++) {
        share[i] = work.share[i];
        rival[i] = work.rival[i];
    }
    return err;
}

int32_t reflux_measure(const struct reflux_plant *plant, int32_t n, const int32_t *output,
                       const int32_t *input, double shortest_s, double *lambda, double *phi,
                       double *gamma)
{
    struct interact_plant p;
    struct pairs pairs;
    struct measure_work work;
    struct measure m;
    enum err err = take_plant(plant, &p);
    if (!err)
        err = take_pairs(n, output, input, &pairs);
    if (!err)
        err = measure_compute(&p, &pairs, shortest_s, &work, &m);
    if (err)
        return err;
    give_matrix(&m.lambda, lambda);
    give_matrix(&m.phi, phi);
    give_matrix(&m.gamma, gamma);
    return ERR_OK;
}

int32_t reflux_structure(const struct reflux_plant *plant, int32_t n, const int32_t *output,
                         const int32_t *input, int32_t *effect, int32_t *uncertain, int32_t *part,
                         int32_t *block, int32_t *mimo, double *worst)
{
    struct interact_plant p;
    struct pairs pairs;
    struct structure_config c;
    struct structure_work work;
    struct structure s;
    structure_config_default(&c);
    enum err err = take_plant(plant, &p);
    if (!err)
        err = take_pairs(n, output, input, &pairs);
    if (!err)
        err = structure_detect(&p, &pairs, &c, &work, &s);
    if (err)
        return err;
    for (int i = 0; i < p.outputs; i++) {
        part[i] = -1;
        for (int k = 0; k < s.parts; k++)
            if (s.part_outputs[k] & (1u << i))
                part[i] = k;
        for (int j = 0; j < p.inputs; j++) {
            effect[i * p.inputs + j] = (s.effect[i] >> j) & 1;
            uncertain[i * p.inputs + j] = (s.uncertain[i] >> j) & 1;
        }
    }
    for (int k = 0; k < n; k++) {
        block[k] = s.pair_block[k];
        mimo[k] = (s.block[s.pair_block[k]].mimo >> k) & 1;
    }
    for (int b = 0; b < s.blocks; b++)
        worst[b] = s.block[b].worst_lambda;
    return ERR_OK;
}

int32_t reflux_cascades(const struct reflux_plant *plant, int32_t *found, int32_t *which,
                        double *between)
{
    struct interact_plant p;
    struct cascade_config c;
    struct cascade all[INTERACT_MAX];
    uint8_t count;
    cascade_config_default(&c);
    enum err err = take_plant(plant, &p);
    if (!err)
        err = cascade_detect(&p, &c, all, &count);
    if (err)
        return err;
    *found = count;
    for (size_t k = 0; k < count; k++) {
        which[2 * k] = all[k].inner;
        which[2 * k + 1] = all[k].outer;
        between[4 * k] = all[k].between.gain;
        between[4 * k + 1] = all[k].between.dead_time_s;
        between[4 * k + 2] = all[k].between.time_constant_s;
        between[4 * k + 3] = all[k].misfit_sd;
    }
    return ERR_OK;
}

void reflux_detune_defaults(double *settings)
{
    struct detune_config c;
    detune_config_default(&c);
    const double all[] = {c.db_per_loop, c.db_most, c.gain_margin, c.factor_hi, c.gain_hi};
    memcpy(settings, all, sizeof all);
}

int32_t reflux_detune(const struct reflux_plant *plant, int32_t n, const int32_t *output,
                      const int32_t *input, double interval_s, const double *decoupler,
                      const double *settings, double *gain, double *ti_s, double *numbers,
                      char *reason)
{
    static struct detune d;
    struct interact_plant p;
    struct pairs pairs;
    struct matrix m;
    struct interact_refusal refusal = {0};
    const struct detune_config c = {.db_per_loop = settings[0],
                                    .db_most = settings[1],
                                    .gain_margin = settings[2],
                                    .factor_hi = settings[3],
                                    .gain_hi = settings[4],
                                    .noise_times = REAL_C(1.0)};
    enum err err = take_plant(plant, &p);
    if (!err)
        err = take_pairs(n, output, input, &pairs);
    if (!err && decoupler)
        err = take_matrix(n, decoupler, &m);
    if (err)
        return err;
    err = detune_begin(&d, &p, &pairs, interval_s, decoupler ? &m : NULL, &c, &refusal);
    if (err) {
        say_why(&refusal, reason);
        return err;
    }
    while ((err = detune_step(&d)) == ERR_BUSY)
        ;
    for (int k = 0; k < n; k++) {
        const struct tuning *t = &d.loops.tuning[k];
        gain[k] = t->action == TUNING_DIRECT ? -t->gain : t->gain;
        ti_s[k] = t->ti_s;
    }
    numbers[0] = d.factor;
    numbers[1] = d.log_modulus_db;
    numbers[2] = d.omega;
    numbers[3] = d.tried;
    return err;
}

static enum err take_loops(const struct reflux_loops *from, struct loops *loops,
                           struct matrix *decoupler)
{
    memset(loops, 0, sizeof *loops);
    enum err err = take_pairs(from->n, from->output, from->input, &loops->pairs);
    if (!err && from->decoupler)
        err = take_matrix(from->n, from->decoupler, decoupler);
    if (err)
        return err;
    loops->interval_s = from->interval_s;
    loops->derivative_filter = 8.0;
    loops->decoupler = from->decoupler ? decoupler : NULL;
    for (int k = 0; k < from->n; k++)
        loops->tuning[k] =
            (struct tuning){.gain = from->gain[k] < 0.0 ? -from->gain[k] : from->gain[k],
                            .ti_s = from->ti_s[k],
                            .action = from->gain[k] < 0.0 ? TUNING_DIRECT : TUNING_REVERSE};
    return ERR_OK;
}

int32_t reflux_nyquist(const struct reflux_plant *plant, const struct reflux_loops *loops,
                       double gain_times, double *numbers)
{
    static struct nyquist nyquist;
    struct interact_plant p;
    struct loops l;
    struct matrix d;
    enum err err = take_plant(plant, &p);
    if (!err)
        err = take_loops(loops, &l, &d);
    if (!err)
        err = nyquist_begin(&nyquist, &p, &l, gain_times, INFINITY);
    if (err)
        return err;
    while ((err = nyquist_step(&nyquist)) == ERR_BUSY)
        ;
    numbers[0] = nyquist.stable;
    numbers[1] = nyquist.log_modulus_db;
    numbers[2] = nyquist.omega;
    numbers[3] = nyquist.points;
    return err;
}

int32_t reflux_open_loop(const struct reflux_plant *plant, const struct reflux_loops *loops,
                         double omega, double *open)
{
    struct interact_plant p;
    struct loops l;
    struct matrix d;
    struct cplx response[MATRIX_MAX][MATRIX_MAX];
    struct loops_sampled sampled;
    enum err err = take_plant(plant, &p);
    if (!err)
        err = take_loops(loops, &l, &d);
    if (!err)
        err = loops_check(&p, &l, NULL);
    if (err)
        return err;
    loops_sample(&p, &l, NYQUIST_DELAY, 0.0, &sampled);
    loops_open(&l, &sampled, omega, response);
    size_t n = l.pairs.n;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            open[2 * (i * n + j)] = response[i][j].re;
            open[2 * (i * n + j) + 1] = response[i][j].im;
        }
    return ERR_OK;
}

int32_t reflux_trial(const struct reflux_plant *plant, const struct reflux_loops *loops,
                     const double *settings, int32_t room, double *rows, int32_t *n_rows,
                     double *numbers)
{
    static struct trial t;
    struct interact_plant p;
    struct loops l;
    struct matrix d;
    enum err err = take_plant(plant, &p);
    if (!err)
        err = take_loops(loops, &l, &d);
    if (!err && !(settings[0] >= 0.0 && settings[0] < INTERACT_MAX))
        err = ERR_RANGE;
    if (err)
        return err;
    const struct trial_config c = {.loop = (uint8_t)settings[0],
                                   .load = settings[1] != 0.0,
                                   .size = settings[2],
                                   .duration_s = settings[3],
                                   .setpoint_weight = settings[4]};
    err = trial_begin(&t, &p, &l, &c);
    if (err)
        return err;
    *n_rows = 0;
    do {
        err = trial_step(&t);
        if (*n_rows < room) {
            double *row = rows + (size_t)*n_rows * (l.pairs.n + 1u);
            row[0] = t.time_s;
            for (int k = 0; k < l.pairs.n; k++)
                row[1 + k] = t.y[k];
            (*n_rows)++;
        }
    } while (err == ERR_BUSY);
    for (size_t k = 0; k < l.pairs.n; k++) {
        numbers[4 * k] = t.loop[k].iae;
        numbers[4 * k + 1] = t.loop[k].peak;
        numbers[4 * k + 2] = t.loop[k].settled_s;
        numbers[4 * k + 3] = t.loop[k].moved;
    }
    double *rest = numbers + (size_t)4 * l.pairs.n;
    rest[0] = t.bounded;
    rest[1] = t.coarse;
    rest[2] = t.step_s;
    return err;
}

void reflux_decoupler_defaults(double *settings)
{
    struct static_decoupler_config c;
    static_decoupler_config_default(&c);
    const double all[] = {c.element_hi, c.lambda_hi, c.significance, c.floor, c.left_hi};
    memcpy(settings, all, sizeof all);
}

int32_t reflux_decoupler(const struct reflux_plant *plant, int32_t n, const int32_t *output,
                         const int32_t *input, const double *settings, double *d, double *gain,
                         double *gain_sd, double *left, char *reason)
{
    struct interact_plant p;
    struct pairs pairs;
    struct static_decoupler_work work;
    struct static_decoupler_result r;
    struct interact_refusal refusal = {0};
    const struct static_decoupler_config c = {.element_hi = settings[0],
                                              .lambda_hi = settings[1],
                                              .significance = settings[2],
                                              .floor = settings[3],
                                              .left_hi = settings[4]};
    enum err err = take_plant(plant, &p);
    if (!err)
        err = take_pairs(n, output, input, &pairs);
    if (err)
        return err;
    err = static_decoupler(&p, &pairs, &c, &work, &r, &refusal);
    if (err) {
        say_why(&refusal, reason);
        return err;
    }
    give_matrix(&r.d, d);
    for (int k = 0; k < n; k++) {
        gain[k] = r.gain[k];
        gain_sd[k] = r.gain_sd[k];
    }
    *left = r.left_sd;
    return ERR_OK;
}
