#include "kinds/ahead/column_ahead_model.h"

#include <string.h>

#include "base/assertion.h"
#include "kinds/ahead/column_ahead_model_state.h"
#include "model/column_implicit.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)
#define TWO  REAL_C(2.0)

/* A temperature moves its component by no more than this in one correction: slopes belong to one point. */
#define MOVE_MOST REAL_C(0.2)
/* Mole fractions are not taken to be nearer to their ends. */
#define LEAST REAL_C(1e-6)

size_t ahead_model_numbers(size_t stages, size_t components)
{
    size_t m = components - 1;
    return 3 * stages * m + stages * column_transition_stride(m);
}

static void place_numbers(struct ahead_model *m, real_t *numbers)
{
    size_t n = m->column.n_fractions;
    m->x = numbers;
    m->later = numbers + n;
    m->rates = numbers + 2 * n;
    m->transition.factors = numbers + 3 * n;
}

void ahead_model_rest(struct ahead_model *m)
{
    m->column.warm = false;
    for (size_t i = 0; i < m->column.n_fractions; i++)
        m->x[i] = m->table.profile[i];
    for (size_t s = 0; s < m->table.config.stages; s++)
        m->column.temperature[s] =
            (m->table.config.temperature_min + m->table.config.temperature_max) / TWO;
}

enum err ahead_model_begin(struct ahead_model *m, const struct column_record *record,
                           real_t *numbers)
{
    enum err err = column_record_open(record, &m->table, &m->column);
    if (err)
        return err;
    place_numbers(m, numbers);
    m->inputs = m->table.nominal;
    ahead_model_rest(m);
    return ERR_OK;
}

void ahead_model_relocate(struct ahead_model *m, real_t *numbers)
{
    if (m->column.config != &m->table.config) {
        column_table_moved(&m->table);
        m->column.config = &m->table.config;
        m->column.vle.component = m->table.config.component;
        m->column.vle.activity_context = m->table.config.activity_context;
    }
    place_numbers(m, numbers);
}

/* ---- what drives it ---- */

void ahead_model_set(struct ahead_model *m, uint16_t parts, real_t interval_s)
{
    m->parts = parts;
    m->h = interval_s / (real_t)parts;
}

const real_t *ahead_model_x(const struct ahead_model *m)
{
    return m->x;
}

const real_t *ahead_model_later(const struct ahead_model *m)
{
    return m->later;
}

struct column_inputs *ahead_model_inputs(struct ahead_model *m)
{
    return &m->inputs;
}

/* The closing component gives way, then the others in proportion. */
void ahead_model_take_fraction(struct column_inputs *inputs, size_t components, size_t j,
                               real_t value)
{
    REFLUX_ASSERT(components <= COLUMN_COMPONENTS_MAX && j + 1 < components);
    real_t *z = inputs->feed_fraction, rest = ZERO;
    z[j] = value < ZERO ? ZERO : value > ONE ? ONE : value;
    for (size_t i = 0; i + 1 < components; i++)
        rest += z[i];
    if (rest > ONE) {
        for (size_t i = 0; i + 1 < components; i++)
            z[i] /= rest;
        rest = ONE;
    }
    z[components - 1] = ONE - rest;
}

void ahead_model_take_feed(const struct ahead_model *m, struct column_inputs *inputs, size_t j,
                           real_t value)
{
    ahead_model_take_fraction(inputs, m->table.config.components, j, value);
}

void ahead_model_take_drive(const struct ahead_model *m, struct column_inputs *inputs,
                            enum column_drive drive, real_t value)
{
    column_drive_take(&m->table, inputs, drive, value);
}

/* ---- where it will be ---- */

static enum err put_model_inputs(struct ahead_model *m, const struct column_inputs *inputs)
{
    struct column_fault fault;
    return column_set_inputs(&m->column, inputs, &fault);
}

/* One step of linearly implicit Euler: x moves by Phi h f. */
static enum err carry_part(struct ahead_model *m, real_t *x)
{
    enum err err = column_rates(&m->column, x, m->rates);
    if (!err)
        err = column_transition_make(&m->column, x, m->h, &m->transition);
    if (err)
        return err;
    for (size_t i = 0; i < m->column.n_fractions; i++)
        m->rates[i] *= m->h;
    column_transition_apply(&m->transition, m->rates);
    (void)column_move(&m->column, x, m->rates);
    return ERR_OK;
}

static enum err carry_on(struct ahead_model *m, const struct column_inputs *inputs, real_t *x)
{
    enum err err = put_model_inputs(m, inputs);
    for (uint16_t part = 0; !err && part < m->parts; part++)
        err = carry_part(m, x);
    return err;
}

enum err ahead_model_predict(struct ahead_model *m, const struct column_inputs *inputs)
{
    memcpy(m->later, m->x, m->column.n_fractions * sizeof(real_t));
    enum err err = carry_on(m, inputs, m->later);
    return err ? err : column_evaluate(&m->column, m->later);
}

enum err ahead_model_carry(struct ahead_model *m, const struct column_inputs *inputs)
{
    return carry_on(m, inputs, m->x);
}

enum err ahead_model_look(struct ahead_model *m, const real_t *x)
{
    enum err err = put_model_inputs(m, &m->inputs);
    return err ? err : column_evaluate(&m->column, x);
}

/* ---- where it is ---- */

real_t ahead_model_value(const struct ahead_model *m, const real_t *x, size_t stage,
                         bool is_fraction, size_t component)
{
    REFLUX_ASSERT(stage < m->table.config.stages && component < m->table.config.components);
    return is_fraction ? column_fraction(&m->column, x, stage, component)
                       : m->column.temperature[stage];
}

real_t ahead_model_mole_fraction(const struct ahead_model *m, size_t stage, size_t j, real_t mass)
{
    REFLUX_ASSERT(stage < m->table.config.stages && j < m->table.config.components);
    const struct component *c = m->table.component;
    size_t n = m->table.config.components;
    real_t rest = ZERO, weight = ZERO; /* moles and kilograms of the others */
    for (size_t i = 0; i < n; i++) {
        real_t x = i == j ? ZERO : column_fraction(&m->column, m->x, stage, i);
        rest += x;
        weight += x * c[i].molar_mass;
    }
    real_t others = rest > ZERO ? weight / rest : c[j].molar_mass;
    real_t own = real_clamp(mass, ZERO, ONE) / c[j].molar_mass;
    return own / (own + (ONE - real_clamp(mass, ZERO, ONE)) / others);
}

/* A place's own mole fraction, off its ends. */
static real_t inside(real_t x)
{
    return real_clamp(x, LEAST, ONE - LEAST);
}

static real_t component_at(const struct ahead_model *m, size_t stage, size_t j)
{
    REFLUX_ASSERT(stage < m->table.config.stages && j + 1 < m->table.config.components);
    return inside(m->x[stage * (m->table.config.components - 1) + j]);
}

/* Returns by how much the mole fraction at the place has to move for the reading. */
static real_t wanted_move(const struct ahead_model *m, const struct ahead_reading *reading)
{
    real_t off = reading->value - ahead_model_value(m, m->x, reading->stage, reading->is_fraction,
                                                    reading->component);
    if (reading->is_fraction)
        return real_clamp(off, -MOVE_MOST, MOVE_MOST);
    size_t n = m->table.config.components, s = reading->stage;
    real_t full[COLUMN_COMPONENTS_MAX], dt[COLUMN_COMPONENTS_MAX],
        dy[COLUMN_COMPONENTS_MAX * COLUMN_COMPONENTS_MAX];
    for (size_t j = 0; j < n; j++)
        full[j] = column_fraction(&m->column, m->x, s, j);
    vle_full_slopes(&m->column.vle, m->column.temperature[s], full, &m->column.k[s * n],
                    &m->column.dk[s * n], dt, dy);
    real_t slope = dt[reading->component];
    return real_abs(slope) > REAL_C(1e-3) ? real_clamp(off / slope, -MOVE_MOST, MOVE_MOST) : ZERO;
}

/* Returns the same of ln(x/(1 - x)). */
static real_t wanted_shift(const struct ahead_model *m, const struct ahead_reading *reading)
{
    real_t x = component_at(m, reading->stage, reading->component);
    real_t to = inside(x + wanted_move(m, reading));
    return real_log(to * (ONE - x) / (x * (ONE - to)));
}

/* Returns by how much component j shifts on a stage: in proportion between the nearest readings of it below and above, beyond the last one
 * as there. */
static real_t shift_at(const struct ahead_reading *reading, const real_t *shift, size_t n, size_t j,
                       size_t stage)
{
    size_t below = n, above = n;
    for (size_t k = 0; k < n; k++) {
        if (reading[k].component != j)
            continue;
        if (reading[k].stage <= stage)
            below = k;
        if (reading[k].stage >= stage && above == n)
            above = k;
    }
    if (below == n || above == n || below == above)
        return below < n ? shift[below] : above < n ? shift[above] : ZERO;
    real_t part = (real_t)(stage - reading[below].stage) /
                  (real_t)(reading[above].stage - reading[below].stage);
    return shift[below] + part * (shift[above] - shift[below]);
}

enum err ahead_model_correct(struct ahead_model *m, const struct ahead_reading *reading, size_t n,
                             real_t trust)
{
    REFLUX_ASSERT(n <= AHEAD_READINGS_MOST);
    real_t shift[AHEAD_READINGS_MOST];
    size_t fractions = m->table.config.components - 1;
    enum err err = ahead_model_look(m, m->x);
    if (err)
        return err;
    for (size_t k = 0; k < n; k++)
        shift[k] = trust * wanted_shift(m, &reading[k]);
    for (size_t s = 0; s < m->table.config.stages; s++)
        for (size_t j = 0; j < fractions; j++) {
            real_t x = component_at(m, s, j), part = real_exp(shift_at(reading, shift, n, j, s));
            m->rates[s * fractions + j] = x * part / (ONE - x + x * part) - x;
        }
    (void)column_move(&m->column, m->x, m->rates);
    return ahead_model_look(m, m->x);
}
