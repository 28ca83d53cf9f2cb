#include "kinds/ahead/column_ahead_place.h"

#include <string.h>

#include "base/assertion.h"
#include "kinds/ahead/column_ahead_place_state.h"

#define ONE REAL_C(1.0)

/* Before it begins, nobody knows the state of the column: the model is corrected so often, and carried on in between, so that stages
 * without a reading come to stand with the others. */
#define ROUNDS 8

/* ---- settings ---- */

static struct ahead_place place_of(const struct block_signal *signal, const float unit[AHEAD_UNIT],
                                   uint8_t role, const uint16_t place[AHEAD_PLACE])
{
    real_t factor = column_drive_factor(unit[AHEAD_FACTOR]);
    return (struct ahead_place){
        .zero = factor * signal->lo + unit[AHEAD_ZERO],
        .span = factor * (signal->hi - signal->lo),
        .role = role,
        .stage = (uint8_t)(place[AHEAD_STAGE] ? place[AHEAD_STAGE] - 1u : 0),
        .component = (uint8_t)(place[AHEAD_COMPONENT] ? place[AHEAD_COMPONENT] - 1u : 0)};
}

static void take_places(const struct block_setup *setup, struct ahead_places *p)
{
    const struct ahead_settings *s = setup->settings;
    memset(p, 0, sizeof *p);
    p->loops = setup->members;
    p->inputs = setup->inputs;
    p->basis = s->basis;
    for (unsigned k = 0; k < setup->inputs; k++)
        p->input[k] = place_of(&setup->input[k], s->si[k], s->role[k], s->place[k]);
    for (unsigned i = 0; i < setup->members; i++) {
        p->pv[i] = place_of(&setup->pv[i], s->pv_si[i],
                            s->target[i][AHEAD_COMPONENT] ? AHEAD_FRACTION : AHEAD_TEMPERATURE,
                            s->target[i]);
        p->mv[i] = (uint8_t)(s->moves[i] - 1u);
    }
}

static bool is_same_place(const struct ahead_place *a, const struct ahead_place *b)
{
    return a->role == b->role && a->stage == b->stage && a->component == b->component;
}

bool ahead_places_set(struct ahead_places *p, const struct block_setup *setup)
{
    REFLUX_ASSERT(setup->members <= AHEAD_LOOPS && setup->inputs <= BLOCK_INPUTS_MAX);
    struct ahead_places wanted;
    bool same = true;
    take_places(setup, &wanted);
    for (unsigned k = 0; same && k < setup->inputs; k++)
        same = is_same_place(&p->input[k], &wanted.input[k]);
    for (unsigned i = 0; same && i < setup->members; i++)
        same = is_same_place(&p->pv[i], &wanted.pv[i]);
    *p = wanted;
    return same;
}

unsigned ahead_places_loops(const struct ahead_places *p)
{
    return p->loops;
}

unsigned ahead_places_mv(const struct ahead_places *p, unsigned j)
{
    REFLUX_ASSERT(j < p->loops && p->mv[j] < p->inputs);
    return p->mv[j];
}

/* ---- units ---- */

real_t ahead_places_span(const struct ahead_places *p, unsigned i)
{
    REFLUX_ASSERT(i < p->loops);
    return p->pv[i].span;
}

static real_t value_si(const struct ahead_places *p, const struct ahead_model *m,
                       const struct ahead_place *place, num_t fraction)
{
    real_t value = place->zero + place->span * num_to_float(fraction);
    return place->role == AHEAD_FRACTION && p->basis == AHEAD_MASS
               ? ahead_model_mole_fraction(m, place->stage, place->component, value)
               : value;
}

real_t ahead_places_pv_si(const struct ahead_places *p, const struct ahead_model *m, unsigned i,
                          num_t fraction)
{
    REFLUX_ASSERT(i < p->loops);
    return value_si(p, m, &p->pv[i], fraction);
}

real_t ahead_places_target(const struct ahead_places *p, const struct ahead_model *m, unsigned i,
                           const real_t *x)
{
    REFLUX_ASSERT(i < p->loops);
    return ahead_model_value(m, x, p->pv[i].stage, p->pv[i].role == AHEAD_FRACTION,
                             p->pv[i].component);
}

static void take_drive(const struct ahead_model *m, struct column_inputs *inputs,
                       const struct ahead_place *place, real_t fraction)
{
    real_t value = place->zero + place->span * fraction;
    if (place->role == AHEAD_FEED_FRACTION)
        ahead_model_take_feed(m, inputs, place->component, value);
    else if (place->role >= AHEAD_FEED)
        ahead_model_take_drive(m, inputs, (enum column_drive)(place->role - AHEAD_FEED), value);
}

void ahead_places_drive(const struct ahead_places *p, struct ahead_model *m, const real_t *u,
                        struct column_inputs *inputs)
{
    *inputs = *ahead_model_inputs(m);
    for (unsigned j = 0; j < p->loops; j++)
        take_drive(m, inputs, &p->input[p->mv[j]], u[j]);
}

/* ---- where the column is ---- */

static void insert_reading(struct ahead_reading *reading, size_t *n, struct ahead_reading one)
{
    REFLUX_ASSERT(*n < AHEAD_READINGS_MOST);
    size_t place = *n;
    for (size_t k = 0; k < *n; k++)
        if (reading[k].stage == one.stage && reading[k].component == one.component)
            return; /* inputs come first: a PV there may be the noisier of the two */
    for (; place > 0 && reading[place - 1].stage > one.stage; place--)
        reading[place] = reading[place - 1];
    reading[place] = one;
    ++*n;
}

static struct ahead_reading reading_of(const struct ahead_places *p, const struct ahead_model *m,
                                       const struct ahead_place *place, num_t fraction)
{
    return (struct ahead_reading){.stage = place->stage,
                                  .component = place->component,
                                  .is_fraction = place->role == AHEAD_FRACTION,
                                  .value = value_si(p, m, place, fraction)};
}

static size_t gather_readings(const struct ahead_places *p, const struct ahead_model *m,
                              const struct block_io *io, struct ahead_reading *reading)
{
    size_t n = 0;
    for (unsigned k = 0; k < p->inputs; k++)
        if (ahead_is_of_stage(p->input[k].role))
            insert_reading(reading, &n, reading_of(p, m, &p->input[k], io->inputs.value[k]));
    for (unsigned i = 0; i < p->loops; i++)
        insert_reading(reading, &n, reading_of(p, m, &p->pv[i], io->members.in[i]));
    return n;
}

/* The MVs as they were in the interval that is over, everything else as it is now. */
static void take_drives(const struct ahead_places *p, struct ahead_model *m,
                        const struct block_io *io)
{
    for (unsigned k = 0; k < p->inputs; k++)
        take_drive(m, ahead_model_inputs(m), &p->input[k], num_to_float(io->inputs.value[k]));
}

static enum err correct_model(const struct ahead_places *p, struct ahead_model *m,
                              const struct block_io *io, real_t trust)
{
    struct ahead_reading reading[AHEAD_READINGS_MOST];
    size_t n = gather_readings(p, m, io, reading);
    return ahead_model_correct(m, reading, n, trust);
}

enum err ahead_places_observe(const struct ahead_places *p, struct ahead_model *m,
                              const struct block_io *io, real_t trust)
{
    take_drives(p, m, io);
    enum err err = ahead_model_carry(m, ahead_model_inputs(m));
    return err ? err : correct_model(p, m, io, trust);
}

enum err ahead_places_find(const struct ahead_places *p, struct ahead_model *m,
                           const struct block_io *io)
{
    take_drives(p, m, io);
    enum err err = correct_model(p, m, io, ONE);
    for (unsigned k = 0; !err && k < ROUNDS; k++) {
        err = ahead_model_carry(m, ahead_model_inputs(m));
        if (!err)
            err = correct_model(p, m, io, ONE);
    }
    return err;
}
