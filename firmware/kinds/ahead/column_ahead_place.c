/* Of the kind `ahead`: what its signals are in the model's units, and where the column is from what they say. */
#include "kinds/ahead/column_ahead_block.h"

#define ONE REAL_C(1.0)

/* Before it begins, nobody knows where the model is: it is corrected so often, and carried on in between, so that stages that nothing is
 * said of come to stand with the others. */
#define ROUNDS 8

/* ---- units ---- */

real_t ahead_place_si(const struct ahead *b, const struct ahead_place *place, num_t fraction)
{
    real_t value = place->zero + place->span * num_to_float(fraction);
    return place->is == AHEAD_FRACTION && b->basis == AHEAD_MASS
               ? ahead_model_mole_fraction(&b->m, place->stage, place->component, value)
               : value;
}

real_t ahead_target_of(const struct ahead *b, unsigned i, const real_t *x)
{
    return ahead_model_value(&b->m, x, b->pv[i].stage, b->pv[i].is == AHEAD_FRACTION,
                             b->pv[i].component);
}

static void take_drive(const struct ahead *b, struct column_inputs *inputs,
                       const struct ahead_place *place, real_t fraction)
{
    real_t value = place->zero + place->span * fraction;
    if (place->is == AHEAD_FEED_FRACTION)
        ahead_model_take_fraction(inputs, b->m.table.config.components, place->component, value);
    else if (place->is >= AHEAD_FEED)
        column_drive_take(&b->m.table, inputs, (enum column_drive)(place->is - AHEAD_FEED), value);
}

void ahead_drive_by(const struct ahead *b, const real_t *u, struct column_inputs *inputs)
{
    *inputs = b->m.inputs;
    for (unsigned j = 0; j < b->loops; j++)
        take_drive(b, inputs, &b->input[b->mv[j]], u[j]);
}

/* ---- where the column is ---- */

static void insert_said(struct ahead_said *said, size_t *n, struct ahead_said one)
{
    size_t at = *n;
    for (size_t k = 0; k < *n; k++)
        if (said[k].stage == one.stage && said[k].component == one.component)
            return; /* inputs come first: a PV there may be the noisier of the two */
    for (; at > 0 && said[at - 1].stage > one.stage; at--)
        said[at] = said[at - 1];
    said[at] = one;
    ++*n;
}

static struct ahead_said said_by(const struct ahead *b, const struct ahead_place *place,
                                 num_t fraction)
{
    return (struct ahead_said){.stage = place->stage,
                               .component = place->component,
                               .is_fraction = place->is == AHEAD_FRACTION,
                               .value = ahead_place_si(b, place, fraction)};
}

static size_t gather_said(const struct ahead *b, const struct block_io *io, struct ahead_said *said)
{
    size_t n = 0;
    for (unsigned k = 0; k < b->inputs; k++)
        if (ahead_is_of_stage(b->input[k].is))
            insert_said(said, &n, said_by(b, &b->input[k], io->input[k]));
    for (unsigned i = 0; i < b->loops; i++)
        insert_said(said, &n, said_by(b, &b->pv[i], io->in[i]));
    return n;
}

/* The MVs as they were in the interval that is over, everything else as it is now. */
static void take_drives(struct ahead *b, const struct block_io *io)
{
    for (unsigned k = 0; k < b->inputs; k++)
        take_drive(b, &b->m.inputs, &b->input[k], num_to_float(io->input[k]));
}

/* What is said of the column now. */
static enum err correct(struct ahead *b, const struct block_io *io, real_t trust)
{
    struct ahead_said said[AHEAD_SAID_MOST];
    size_t n = gather_said(b, io, said);
    return ahead_model_correct(&b->m, said, n, trust);
}

enum err ahead_observe(struct ahead *b, const struct block_io *io)
{
    take_drives(b, io);
    enum err err = ahead_model_carry(&b->m, &b->m.inputs);
    return err ? err : correct(b, io, b->trust);
}

enum err ahead_find_column(struct ahead *b, const struct block_io *io)
{
    take_drives(b, io);
    enum err err = correct(b, io, ONE);
    for (unsigned k = 0; !err && k < ROUNDS; k++) {
        err = ahead_model_carry(&b->m, &b->m.inputs);
        if (!err)
            err = correct(b, io, ONE);
    }
    return err;
}
