#include "kinds/experiment/experiment_settings.h"

#include <string.h>

#include "base/assertion.h"
#include "base/workspace.h"
#include "block/refuse.h"
#include "block/step_period.h"
#include "identify/prbs.h"
#include "kinds/experiment/experiment_ids.h"
#include "kinds/experiment/experiment_job.h"
#include "kinds/experiment/plant_model.h"

#define PLACE(field) offsetof(struct experiment_settings, field)
#define NUMBER(id, field, name, unit, help, lo, hi, initial)                                       \
    {                                                                                              \
        id, BLOCK_FLOAT, PLACE(field), 1, 1, name, unit, help, lo, hi, initial                     \
    }
#define EACH(id, field, name, help)                                                                \
    {                                                                                              \
        id, BLOCK_FLOAT, PLACE(field), EXPERIMENT_MOST, 1, name, "EU", help, 0, 1e9f, 0            \
    }
#define COUNT(id, field, name, unit, help, lo, hi, initial)                                        \
    {                                                                                              \
        id, BLOCK_U16, PLACE(field), 1, 1, name, unit, help, lo, hi, initial                       \
    }
#define WORD(id, field, name, words, help, initial)                                                \
    {                                                                                              \
        id, BLOCK_WORD, PLACE(field), 1, 1, name, words, help, 0, 0, initial                       \
    }
/* Single numbers, since a row of a table cannot be proposed. */
#define OF_A(i, k)                                                                                 \
    NUMBER(EXPERIMENT_ID_A + ((i)-1) * DIFFERENCE_A_MOST + ((k)-1), a[(i)-1][(k)-1],               \
           "a" #i "_" #k, "-", "found", -1e6f, 1e6f, 0)
#define OF_B(i, j, k)                                                                              \
    NUMBER(EXPERIMENT_ID_B + (((i)-1) * EXPERIMENT_KEPT + ((j)-1)) * DIFFERENCE_B_MOST + ((k)-1),  \
           b[(i)-1][(j)-1][(k)-1], "b" #i #j "_" #k, "EU/EU", "found", -1e9f, 1e9f, 0)
#define ALL_A(i) OF_A(i, 1), OF_A(i, 2), OF_A(i, 3), OF_A(i, 4)
#define ALL_B(i, j)                                                                                \
    OF_B(i, j, 1), OF_B(i, j, 2), OF_B(i, j, 3), OF_B(i, j, 4), OF_B(i, j, 5), OF_B(i, j, 6),      \
        OF_B(i, j, 7), OF_B(i, j, 8)

const struct block_parameter experiment_parameter_rows[EXPERIMENT_PARAMETERS] = {
    NUMBER(1, period_s, "period", "s", "control interval; 0: a base tick", 0, 1e5f, 0),
    NUMBER(2, cutoff, "cutoff", "-",
           "of a filter of faster samples, of half the frequency; 0: none", 0, 1, 0),
    COUNT(3, bits, "bits", "-", "of the register: 2^bits - 1 steps", PRBS_BITS_LEAST, 10, 7),
    COUNT(4, clock, "clock", "periods", "of a step", 1, 1000, 2),
    COUNT(5, periods, "periods", "-", "times the sequence", 1, 100, 2),
    EACH(6, amplitude, "amplitude", "row: MV; to either side"),
    EACH(7, reach, "reach", "row: MV; farthest from its rest; 0: twice the amplitude"),
    EACH(8, band, "band", "row: measurement; farther from its rest all ends"),
    COUNT(9, settle, "settle", "periods", "of rest before", 2, 10000, 20),
    WORD(10, method, "method", ARX_METHOD_WORDS, "of the model", ARX_IV),
    WORD(11, criterion, "criterion", ARX_CRITERION_WORDS, "of its orders", ARX_BIC),
    COUNT(12, na, "na", "-", "highest order of A", 0, DIFFERENCE_A_MOST, 2),
    COUNT(13, nb, "nb", "-", "highest power in B, dead time included", 1, DIFFERENCE_B_MOST,
          DIFFERENCE_B_MOST),
    NUMBER(14, fit, "fit", "%", "least, simulated, on data not seen", 0, 100, 50),
    WORD(15, adopt, "adopt", "ask|at_once", "a model that is usable", EXPERIMENT_ADOPT_ASKED),
    COUNT(17, law, "law", "-",
          "number of the state_law or polynomial block that `design` designs for; 0: none", 0,
          CONFIG_BLOCKS, 0),
    {18, BLOCK_U16, PLACE(place), EXPERIMENT_KEPT, 1, "place", "-",
     "row: loop; number of its rst block, by pole placement; 0: none", 0, CONFIG_BLOCKS, 0},
    NUMBER(19, overshoot, "overshoot", "%", "of a setpoint step with these", 0, 50, 10),
    {28, BLOCK_FLOAT, PLACE(settling_s), EXPERIMENT_KEPT, 1, "settling", "s",
     "row: loop; of a setpoint step, to 2 %", 0, 1e6f, 0},
    NUMBER(29, observer, "observer", "-", "pole that filters their measurements", 0, 0.95f, 0),
    WORD(EXPERIMENT_ID_KNOWN, known, "known", "off|on", "what follows is a whole model", 0),
    ALL_A(1),
    ALL_A(2),
    ALL_B(1, 1),
    ALL_B(1, 2),
    ALL_B(2, 1),
    ALL_B(2, 2),
};
_Static_assert(EXPERIMENT_ID_B + EXPERIMENT_KEPT * EXPERIMENT_KEPT * DIFFERENCE_B_MOST <= 64 &&
                   EXPERIMENT_ID_A + EXPERIMENT_KEPT * DIFFERENCE_A_MOST <= EXPERIMENT_ID_B,
               "ids end at 63");
_Static_assert(EXPERIMENT_KEPT == 2 && DIFFERENCE_A_MOST == 4 && DIFFERENCE_B_MOST == 8,
               "rows of the model");

/* ---- what they come to ---- */

static float experiment_period_ticks(const struct block_setup *setup)
{
    const struct experiment_settings *s = setup->settings;
    return step_period_ticks(s->period_s, setup->interval_s);
}

uint32_t experiment_ticks(const struct block_setup *setup)
{
    return step_period_rounded(experiment_period_ticks(setup));
}

uint32_t experiment_samples(const struct experiment_settings *s)
{
    return ((UINT32_C(1) << s->bits) - 1u) * s->clock * s->periods;
}

/* Pieces of work for each second of a step: about a quarter of the time of a board. */
#define PIECES_A_SECOND 100.0f
#define PIECES_MOST     1000.0f

void experiment_context_take(struct experiment_context *c, const struct block_setup *setup)
{
    REFLUX_ASSERT(setup->inputs <= 2u * EXPERIMENT_MOST);
    float pieces = PIECES_A_SECOND * setup->interval_s;
    memcpy(&c->s, setup->settings, sizeof c->s);
    c->law = c->s.law && !setup->named_other ? setup->named : NULL;
    c->decoupler = c->s.law && setup->named_other ? setup->named : NULL;
    c->step_s = setup->interval_s;
    c->n = (uint8_t)(setup->inputs / 2u);
    memcpy(c->input, setup->input, (size_t)2 * c->n * sizeof c->input[0]);
    c->ticks = (uint16_t)experiment_ticks(setup);
    c->wanted = (uint16_t)experiment_samples(&c->s); /* checked */
    c->pieces = (uint16_t)(pieces < 1 ? 1 : pieces < PIECES_MOST ? pieces : PIECES_MOST);
}

/* ---- check ---- */

static enum err check_experiment_inputs(const struct block_setup *setup, struct block_fault *fault)
{
    unsigned n = setup->inputs / 2u;
    if (setup->inputs != 2u * n || n < 1 || n > EXPERIMENT_MOST)
        return block_refuse(fault, 0, "inputs", "needs one to four measurements, then as many MVs");
    for (unsigned k = 0; k < 2u * n; k++)
        if (setup->input[k].is_mv != (k >= n))
            return block_refuse(fault, k, "inputs",
                                "needs one to four measurements, then as many MVs");
    return ERR_OK;
}

static float span_of_input(const struct block_setup *setup, unsigned k)
{
    return setup->input[k].hi - setup->input[k].lo;
}

static enum err check_cutoff(const struct block_setup *setup, struct block_fault *fault)
{
    float cutoff = ((const struct experiment_settings *)setup->settings)->cutoff;
    if (cutoff > 0 && cutoff < 0.01f)
        return block_refuse(fault, 0, "cutoff", "must be 0, or 0.01 to 1");
    return ERR_OK;
}

static enum err check_sizes(const struct block_setup *setup, struct block_fault *fault)
{
    const struct experiment_settings *s = setup->settings;
    unsigned n = setup->inputs / 2u;
    for (unsigned k = 0; k < n; k++) {
        if (!(s->amplitude[k] > 0 && s->amplitude[k] <= 0.5f * span_of_input(setup, n + k)))
            return block_refuse(fault, k, "amplitude",
                                "must be above 0, to half the span, for each MV");
        if (s->reach[k] > 0 && s->reach[k] < s->amplitude[k])
            return block_refuse(fault, k, "reach", "must be 0, or the amplitude or more");
        if (!(s->band[k] > 0))
            return block_refuse(fault, k, "band", "needs a limit for each measurement");
    }
    return ERR_OK;
}

/* Rows that the first two thirds have besides the parameters of the largest model, at the least. */
#define ROWS_LEAST 20u

static enum err check_length(const struct block_setup *setup, struct block_fault *fault)
{
    const struct experiment_settings *s = setup->settings;
    unsigned n = setup->inputs / 2u;
    uint32_t samples = experiment_samples(s);
    if (samples > 65535u || experiment_job_bytes(n, samples) > WORKSPACE_BYTES)
        return block_refuse(fault, 0, "bits",
                            "makes, with clock and periods, a record that does not fit in the "
                            "board's workspace");
    if (samples / 3u < s->na + n * s->nb + ROWS_LEAST)
        return block_refuse(fault, 0, "bits",
                            "makes, with clock and periods, too few samples for na and nb");
    return ERR_OK;
}

enum err experiment_check(const struct block_setup *setup, struct block_fault *fault)
{
    enum err err = check_experiment_inputs(setup, fault);
    if (!err)
        err = step_period_check(experiment_period_ticks(setup), fault);
    if (!err)
        err = check_cutoff(setup, fault);
    if (!err)
        err = check_sizes(setup, fault);
    return err ? err : check_length(setup, fault);
}
