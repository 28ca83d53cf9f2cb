/* Settings of the kind `experiment`, and what they come to. */
#include "adapt/prbs_inside.h"

#if CONFIG_BLOCKS

#include "base/workspace.h"

#define PLACE_IN(field) offsetof(struct experiment_settings, field)
#define EXPERIMENT_NUMBER(id, field, name, unit, help, lo, hi, initial)                            \
    {                                                                                              \
        id, BLOCK_FLOAT, PLACE_IN(field), 1, 1, name, unit, help, lo, hi, initial                  \
    }
#define EXPERIMENT_COUNT(id, field, name, unit, help, lo, hi, initial)                             \
    {                                                                                              \
        id, BLOCK_U16, PLACE_IN(field), 1, 1, name, unit, help, lo, hi, initial                    \
    }
#define EXPERIMENT_WORD(id, field, name, words, help, initial)                                     \
    {                                                                                              \
        id, BLOCK_WORD, PLACE_IN(field), 1, 1, name, words, help, 0, 0, initial                    \
    }
#define EXPERIMENT_ROW(id, field, name, help, hi)                                                  \
    {                                                                                              \
        id, BLOCK_FLOAT, PLACE_IN(field), 1, DIFFERENCE_MOST, name, "span", help, 0, hi, 0         \
    }
/* Single numbers, since a row of a table cannot be proposed. */
#define OF_OUTPUT (EXPERIMENT_A + EXPERIMENT_PAIRS * EXPERIMENT_B)
#define MODEL_NUMBER(at, name)                                                                     \
    {                                                                                              \
        EXPERIMENT_ID_MODEL + (at), BLOCK_FLOAT, PLACE_IN(model) + (at) * sizeof(float), 1, 1,     \
            name, "-", "of the model in force", -100, 100, 0                                       \
    }
#define MODEL_A(i, k) MODEL_NUMBER(((i)-1) * OF_OUTPUT + (k)-1, "a" #i "_" #k)
#define MODEL_B(i, j, k)                                                                           \
    MODEL_NUMBER(((i)-1) * OF_OUTPUT + EXPERIMENT_A + ((j)-1) * EXPERIMENT_B + (k)-1,              \
                 "b" #i #j "_" #k)
#define MODEL_BS(i, j)                                                                             \
    MODEL_B(i, j, 1), MODEL_B(i, j, 2), MODEL_B(i, j, 3), MODEL_B(i, j, 4), MODEL_B(i, j, 5)

const struct block_parameter experiment_parameter_rows[EXPERIMENT_PARAMETER_ROWS] = {
    EXPERIMENT_NUMBER(1, period_s, "period", "s", "of samples and of z; 0: a base tick", 0, 1e5f,
                      0),
    EXPERIMENT_NUMBER(2, cutoff, "cutoff", "-",
                      "filter of faster measurements, part of half the samples' rate", 0.01f, 1, 1),
    EXPERIMENT_COUNT(3, bits, "bits", "-", "of the first register: 2^bits - 1 steps", 3, 12, 6),
    EXPERIMENT_COUNT(4, clock, "clock", "samples", "between steps of the signals", 1, 10000, 1),
    EXPERIMENT_COUNT(5, repeats, "repeats", "-", "sequences of the first register", 1, 20, 3),
    EXPERIMENT_COUNT(6, rest, "rest", "samples", "before it moves: levels and noise", 4, 10000, 20),
    EXPERIMENT_ROW(7, amplitude, "amplitude", "of MVs to either side", 0.5f),
    EXPERIMENT_ROW(8, move, "move", "MVs may be as far from where they were; 0: 1.5 amplitudes", 1),
    EXPERIMENT_ROW(9, reach, "reach", "measurements may be as far from where they were; 0: any", 1),
    EXPERIMENT_COUNT(10, na, "na", "-", "highest order of A tried", 0, DIFFERENCE_A_MOST,
                     EXPERIMENT_A),
    EXPERIMENT_COUNT(11, nb, "nb", "-", "highest order of B tried, dead time with it", 1,
                     DIFFERENCE_B_MOST, EXPERIMENT_B),
    EXPERIMENT_WORD(12, method, "method", ARX_METHOD_WORDS, "least squares, instruments, extended",
                    ARX_IV),
    EXPERIMENT_WORD(13, criterion, "criterion", ARX_CRITERION_WORDS, "by which orders are found",
                    ARX_BIC),
    EXPERIMENT_WORD(14, independence, "independence", PRBS_INDEPENDENCE_WORDS,
                    "one register for all MVs, or one each", PRBS_SHIFTS),
    EXPERIMENT_NUMBER(15, fit_least, "fit_least", "-",
                      "part of the movement that the model has to explain", 0, 0.99f, 0.6f),
    EXPERIMENT_WORD(16, adopt, "adopt", "ask|at_once", "the model as settings", EXPERIMENT_ASKS),
    MODEL_A(1, 1),
    MODEL_A(1, 2),
    MODEL_BS(1, 1),
    MODEL_BS(1, 2),
    MODEL_A(2, 1),
    MODEL_A(2, 2),
    MODEL_BS(2, 1),
    MODEL_BS(2, 2),
};
_Static_assert(EXPERIMENT_PARAMETER_ROWS == 16 + EXPERIMENT_MODEL, "a row for each");
_Static_assert(EXPERIMENT_ID_MODEL + EXPERIMENT_MODEL <= 64, "ids end at 63");
_Static_assert(EXPERIMENT_PAIRS == 2 && EXPERIMENT_A == 2 && EXPERIMENT_B == 5, "rows");

/* ---- what they come to ---- */

unsigned experiment_outputs(const struct block_setup *setup)
{
    unsigned n = 0;
    while (n < setup->inputs && !setup->input[n].is_mv)
        n++;
    return n;
}

static float ticks_of_sample(const struct block_setup *setup)
{
    const struct experiment_settings *s = setup->settings;
    return s->period_s > 0 ? s->period_s / setup->interval_s : 1;
}

uint16_t experiment_ratio(const struct block_setup *setup)
{
    return (uint16_t)(ticks_of_sample(setup) + 0.5f);
}

void experiment_signal(const struct experiment_settings *s, unsigned mvs, struct prbs_settings *p)
{
    *p = (struct prbs_settings){.inputs = (uint8_t)mvs,
                                .bits = (uint8_t)s->bits,
                                .independence = s->independence,
                                .clock = s->clock};
    for (unsigned j = 0; j < mvs; j++)
        p->amplitude[j] = (real_t)s->amplitude[j];
}

uint32_t experiment_samples(const struct experiment_settings *s)
{
    return ((UINT32_C(1) << s->bits) - 1u) * s->clock * s->repeats;
}

unsigned experiment_live_parameters(const struct experiment_settings *s, unsigned mvs)
{
    unsigned n = s->na + mvs * s->nb + 1u;
    return n <= RLS_MAX ? n : 0;
}

static uint32_t live_bytes(const struct experiment_settings *s, unsigned outputs, unsigned mvs)
{
    unsigned n = experiment_live_parameters(s, mvs);
    return n ? outputs * ((rls_bytes(n) + 7u) & ~UINT32_C(7)) : 0;
}

uint32_t experiment_work_bytes(const struct experiment_settings *s, unsigned outputs, unsigned mvs)
{
    uint32_t numbers = experiment_samples(s) * (outputs + mvs);
    numbers += numbers & 1u;
    return (uint32_t)sizeof(struct experiment_work) + 8u + numbers * (uint32_t)sizeof(real_t) +
           live_bytes(s, outputs, mvs);
}

/* ---- whether they are right ---- */

static enum err refuse_experiment(struct block_fault *fault, const char *field, const char *wanted)
{
    *fault = (struct block_fault){.field = field, .wanted = wanted};
    return ERR_RANGE;
}

static enum err check_period(const struct block_setup *setup, struct block_fault *fault)
{
    float ticks = ticks_of_sample(setup), away = ticks - (float)(uint32_t)(ticks + 0.5f);
    if (!(ticks >= 0.999f && ticks <= 10000.0f))
        return refuse_experiment(fault, "period", "must be 1 to 10000 base ticks");
    if (!(away <= 1e-3f * ticks && away >= -1e-3f * ticks))
        return refuse_experiment(fault, "period", "must be a whole number of base ticks");
    return ERR_OK;
}

static enum err check_signal(const struct block_setup *setup, unsigned mvs,
                             struct block_fault *fault)
{
    const struct experiment_settings *s = setup->settings;
    struct prbs_settings signal;
    const char *field, *wanted;
    for (unsigned j = 0; j < mvs; j++) {
        if (!(s->amplitude[j] > 0))
            return refuse_experiment(fault, "amplitude", "must be above 0 for each MV");
        if (s->move[j] > 0 && !(s->move[j] > s->amplitude[j]))
            return refuse_experiment(fault, "move",
                                     "must be above the amplitude, or 0: 1.5 amplitudes");
    }
    experiment_signal(s, mvs, &signal);
    return prbs_check(&signal, &field, &wanted) ? refuse_experiment(fault, field, wanted) : ERR_OK;
}

enum err experiment_check(const struct block_setup *setup, struct block_fault *fault)
{
    const struct experiment_settings *s = setup->settings;
    unsigned outputs = experiment_outputs(setup), mvs = setup->inputs - outputs;
    bool in_order = true;
    for (unsigned k = outputs; k < setup->inputs; k++)
        in_order = in_order && setup->input[k].is_mv;
    if (!in_order || outputs < 1 || outputs > CHANNELS || mvs < 1 || mvs > CHANNELS)
        return refuse_experiment(
            fault, "inputs", "needs one to four measurements, then one to four MVs, and no others");
    enum err err = check_period(setup, fault);
    if (!err)
        err = check_signal(setup, mvs, fault);
    if (err)
        return err;
    /* Two thirds of the record have to tell the largest model. */
    if (experiment_samples(s) / 3u * 2u < 3u * (s->na + mvs * s->nb + 1u) + s->nb)
        return refuse_experiment(fault, "repeats",
                                 "must be more, or bits: the record has fewer samples than three "
                                 "for each parameter of the largest model");
    if (experiment_samples(s) > 100000u || experiment_work_bytes(s, outputs, mvs) > WORKSPACE_BYTES)
        return refuse_experiment(fault, "repeats",
                                 "must be fewer, or bits or clock: the workspace has no room for "
                                 "so many samples");
    return ERR_OK;
}

#endif
