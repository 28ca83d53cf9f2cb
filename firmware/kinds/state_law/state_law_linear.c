#include "kinds/state_law/state_law_linear.h"

#include <string.h>

#include "base/assertion.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)
#define TWO  REAL_C(2.0)

/* Distances of the differences: what rounding of a temperature, 1.5e-5 K, makes of a slope of some 30 K is 3e-5 of it at that of the mole
 * fractions; what the fifth derivative leaves is less. */
#define OF_FRACTION       REAL_C(0.015625)
#define OF_FRACTION_LEAST REAL_C(0.0009765625)
#define OF_FLOW           REAL_C(0.03125) /* part of the nominal one */
#define OF_QUALITY        REAL_C(0.03125)
#define OF_KELVIN         ONE

void state_law_linear_put(struct state_law_linear *l, const struct state_law_settings *s,
                          const struct block_signal *input, unsigned inputs)
{
    REFLUX_ASSERT(inputs <= BLOCK_INPUTS_MAX);
    l->inputs = (uint8_t)inputs;
    l->loops = 0;
    l->basis = s->basis;
    for (unsigned k = 0; k < inputs; k++) {
        const uint16_t *place = s->place[k];
        real_t si = s->si[k] < 0 || s->si[k] > 0 ? s->si[k] : ONE;
        l->loops = (uint8_t)(l->loops + (input[k].is_mv ? 1u : 0u));
        l->place[k] = (struct state_law_place){
            .span = si * (input[k].hi - input[k].lo),
            .role = s->role[k],
            .stage = (uint8_t)(place[STATE_LAW_STAGE] ? place[STATE_LAW_STAGE] - 1u : 0),
            .component =
                (uint8_t)(place[STATE_LAW_COMPONENT] ? place[STATE_LAW_COMPONENT] - 1u : 0),
            .is_mv = input[k].is_mv};
    }
}

enum err state_law_linear_begin(struct state_law_linear *l, const struct column_record *record,
                                struct state_model *plant, struct matrix *seen)
{
    struct column_fault fault;
    enum err err = column_record_open(record, &l->table, &l->column);
    if (err)
        return err;
    size_t n = l->column.n_fractions;
    if (n > STATE_MODEL_STATES || l->column.n_states != n)
        return ERR_FULL;
    memcpy(l->x, l->table.profile, n * sizeof(real_t));
    l->plant = plant;
    l->seen = seen;
    memset(plant, 0, sizeof *plant);
    memset(seen, 0, sizeof *seen);
    l->next = 0;
    l->plant->a.rows = l->plant->a.cols = (uint8_t)n;
    l->plant->b.rows = l->plant->e.rows = (uint8_t)n;
    l->plant->c.cols = l->seen->cols = (uint8_t)n;
    l->plant->b.cols = l->plant->c.rows = l->loops;
    for (unsigned k = 0; k < l->inputs; k++) {
        if (state_law_is_of_stage(l->place[k].role))
            l->seen->rows++;
        else if (!l->place[k].is_mv)
            l->plant->e.cols++;
    }
    return column_set_inputs(&l->column, &l->table.nominal, &fault);
}

/* ---- one point ---- */

/* Returns the input of the column that a direction moves, and the distance. */
static real_t *nudged(const struct state_law_place *place, struct column_inputs *in,
                      real_t *distance)
{
    REFLUX_ASSERT(place->component < COLUMN_COMPONENTS_MAX);
    real_t *flow = place->role == STATE_LAW_FEED     ? &in->feed_flow
                   : place->role == STATE_LAW_REFLUX ? &in->reflux_flow
                   : place->role == STATE_LAW_HEAT   ? &in->heat
                                                     : &in->boilup;
    switch (place->role) {
    case STATE_LAW_FEED_FRACTION:
        *distance = OF_FRACTION;
        return &in->feed_fraction[place->component];
    case STATE_LAW_FEED_TEMPERATURE:
        *distance = OF_KELVIN;
        return &in->feed_temperature;
    case STATE_LAW_FEED_QUALITY:
        *distance = OF_QUALITY;
        return &in->feed_quality;
    default:
        *distance = OF_FLOW * *flow;
        return flow;
    }
}

/* Returns the distance, or less where twice that would pass an end. */
static real_t room_around(real_t at, real_t hi, real_t distance)
{
    real_t room = (at < hi - at ? at : hi - at) / TWO;
    return room < distance ? room : distance;
}

static real_t distance_of(const struct state_law_linear *l, size_t k)
{
    REFLUX_ASSERT(k < l->column.n_fractions + l->inputs);
    size_t n = l->column.n_fractions;
    struct column_inputs in = l->table.nominal;
    real_t distance;
    if (k < n) { /* beyond 0 and 1 bubble points go on, but activity coefficients need not */
        real_t room = room_around(l->x[k], ONE, OF_FRACTION);
        return !l->table.config.activity  ? OF_FRACTION
               : room > OF_FRACTION_LEAST ? room
                                          : OF_FRACTION_LEAST;
    }
    const struct state_law_place *place = &l->place[k - n];
    real_t at = *nudged(place, &in, &distance);
    if (place->role == STATE_LAW_FEED_FRACTION) {
        real_t closing = in.feed_fraction[l->table.config.components - 1];
        distance = room_around(at, at + closing, distance);
    }
    return place->role == STATE_LAW_FEED_QUALITY ? room_around(at, TWO, distance) : distance;
}

static real_t seen_at(const struct state_law_linear *l, const struct state_law_place *place)
{
    REFLUX_ASSERT(place->stage < l->table.config.stages &&
                  place->component < l->table.config.components);
    size_t components = l->table.config.components;
    real_t full[COLUMN_COMPONENTS_MAX];
    if (place->role == STATE_LAW_TEMPERATURE)
        return l->column.temperature[place->stage];
    for (size_t j = 0; j < components; j++)
        full[j] = column_fraction(&l->column, l->x, place->stage, j);
    return l->basis == STATE_LAW_MASS
               ? mass_fraction_of(l->table.component, components, full, place->component)
               : full[place->component];
}

/* Adds the rates and the measured states `by` away in direction k, with that weight. */
static enum err add_point(struct state_law_linear *l, size_t k, real_t by, real_t weight,
                          real_t *slope, real_t *seen)
{
    size_t n = l->column.n_fractions;
    struct column_inputs in = l->table.nominal;
    struct column_fault fault;
    real_t unused;
    if (k < n) {
        l->x[k] += by;
    } else {
        *nudged(&l->place[k - n], &in, &unused) += by;
        if (l->place[k - n].role == STATE_LAW_FEED_FRACTION)
            in.feed_fraction[l->table.config.components - 1] -= by;
    }
    enum err err = column_set_inputs(&l->column, &in, &fault);
    if (!err)
        err = column_rates(&l->column, l->x, l->rates);
    size_t row = 0;
    for (size_t i = 0; !err && i < n; i++)
        slope[i] += weight * l->rates[i];
    for (unsigned i = 0; !err && i < l->inputs; i++)
        if (state_law_is_of_stage(l->place[i].role))
            seen[row++] += weight * seen_at(l, &l->place[i]);
    if (k < n)
        l->x[k] = l->table.profile[k];
    return err;
}

/* ---- a direction ---- */

static void take_state(struct state_law_linear *l, size_t k, const real_t *slope,
                       const real_t *seen)
{
    size_t row = 0;
    for (size_t i = 0; i < l->plant->a.rows; i++)
        l->plant->a.value[i][k] = slope[i];
    for (unsigned i = 0; i < l->inputs; i++) {
        if (!state_law_is_of_stage(l->place[i].role))
            continue;
        l->seen->value[row][k] = seen[row] / l->place[i].span;
        if (row < l->loops)
            l->plant->c.value[row][k] = l->seen->value[row][k];
        row++;
    }
}

/* Puts an input's column of B or E, behind those of its own kind. */
static void take_input(struct state_law_linear *l, unsigned k, const real_t *slope)
{
    REFLUX_ASSERT(k < l->inputs);
    const struct state_law_place *place = &l->place[k];
    struct matrix *to = place->is_mv ? &l->plant->b : &l->plant->e;
    size_t col = 0;
    for (unsigned i = 0; i < k; i++)
        if (!state_law_is_of_stage(l->place[i].role) && l->place[i].is_mv == place->is_mv)
            col++;
    for (size_t i = 0; i < to->rows; i++)
        to->value[i][col] = slope[i] * place->span;
}

enum err state_law_linear_piece(struct state_law_linear *l)
{
    size_t n = l->column.n_fractions, k = l->next, all = n + l->inputs;
    real_t slope[STATE_MODEL_STATES] = {ZERO}, seen[BLOCK_INPUTS_MAX] = {ZERO};
    real_t h = distance_of(l, k);
    if (!(h > ZERO))
        return ERR_RANGE;
    /* (8 (f(h) - f(-h)) - (f(2 h) - f(-2 h)))/12 h */
    real_t near = REAL_C(8.0) / (REAL_C(12.0) * h), far = -ONE / (REAL_C(12.0) * h);
    enum err err = add_point(l, k, h, near, slope, seen);
    if (!err)
        err = add_point(l, k, -h, -near, slope, seen);
    if (!err)
        err = add_point(l, k, TWO * h, far, slope, seen);
    if (!err)
        err = add_point(l, k, -TWO * h, -far, slope, seen);
    if (err)
        return err;
    if (k < n)
        take_state(l, k, slope, seen);
    else
        take_input(l, (unsigned)(k - n), slope);
    do {
        l->next++;
    } while (l->next >= n && l->next < all && state_law_is_of_stage(l->place[l->next - n].role));
    return l->next < all ? ERR_BUSY : ERR_OK;
}
