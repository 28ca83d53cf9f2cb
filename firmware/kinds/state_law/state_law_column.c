#include "kinds/state_law/state_law_column.h"

#include <string.h>

#include "kinds/state_law/state_law_column_state.h"
#include "law/state_law_job.h"

unsigned state_law_loops(const struct block_signal *input, unsigned inputs)
{
    unsigned loops = 0;
    for (unsigned k = 0; k < inputs; k++)
        loops += input[k].is_mv ? 1u : 0u;
    return loops;
}

void state_law_column_begin(struct state_law_column *c, const struct state_law_settings *s,
                            const struct block_signal *input, unsigned inputs,
                            const struct column_record *record)
{
    memset(c, 0, sizeof *c);
    c->record = record;
    state_law_job_begin(&c->job, s, state_law_loops(input, inputs));
    state_law_linear_put(&c->linear, s, input, inputs);
    for (unsigned k = 0; k < inputs; k++)
        state_law_job_add_input(&c->job, input[k].is_mv, state_law_is_of_stage(s->role[k]));
}

static void read_table(struct state_law_column *c)
{
    enum err err = state_law_linear_begin(&c->linear, c->record, state_law_job_plant(&c->job),
                                          state_law_job_seen(&c->job));
    if (err == ERR_FULL)
        state_law_job_refuse(&c->job, "column",
                             "of 16 mole fractions at most, and holdups that do not move", 0);
    else if (err)
        state_law_job_refuse(&c->job, "column", "a table that is in order", 0);
    c->phase = err ? STATE_LAW_COLUMN_LAW : STATE_LAW_COLUMN_LINEAR;
}

static void linearise_column(struct state_law_column *c)
{
    enum err err = state_law_linear_piece(&c->linear);
    if (err == ERR_BUSY)
        return;
    if (err)
        state_law_job_refuse(
            &c->job, "column",
            "a column with a solution around its profile, and flows that are not 0", 0);
    c->phase = STATE_LAW_COLUMN_LAW;
}

bool state_law_column_piece(struct state_law_column *c)
{
    if (c->phase == STATE_LAW_COLUMN_LAW)
        return state_law_job_piece(&c->job);
    if (c->phase == STATE_LAW_COLUMN_TABLE)
        read_table(c);
    else
        linearise_column(c);
    return !state_law_column_is_over(c);
}

bool state_law_column_is_over(const struct state_law_column *c)
{
    return state_law_job_is_over(&c->job);
}

const struct state_law_found *state_law_column_found(const struct state_law_column *c)
{
    return state_law_job_found(&c->job);
}
