/* The law of state feedback found from the pilot column's table, 12 stages: the job of the kind `state_law`, whole and its largest piece; then from a
 * model of two lags. */
#include <string.h>

#include "composition_tables.h"
#include "cost.h"
#include "kinds/state_law/state_law_column.h"
#include "kinds/state_law/state_law_column_state.h"
#include "law/state_law_job.h"

static struct state_law_column column;
static struct state_law_job *const job = &column.job;
static struct column_record record;
static struct state_law_settings settings;
static struct block_signal input[BLOCK_INPUTS_MAX];

static void input_is(unsigned k, uint8_t is, uint16_t stage, float si, struct block_signal signal)
{
    settings.role[k] = is;
    settings.place[k][STATE_LAW_STAGE] = stage;
    settings.place[k][STATE_LAW_COMPONENT] = 1;
    settings.si[k] = si;
    input[k] = signal;
}

static void pilot(void)
{
    static const uint16_t stages[8] = {11, 2, 12, 10, 1, 9, 8, 4};
    memset(&settings, 0, sizeof settings);
    PUT_RECORD(&record, pilot_values);
    settings.period_s = 30;
    settings.tau_s[0] = settings.tau_s[1] = 33.3f;
    settings.ti_s[0] = settings.ti_s[1] = 600;
    settings.left = 2;
    for (unsigned k = 0; k < 8; k++)
        input_is(k, STATE_LAW_TEMPERATURE, stages[k], 1, (struct block_signal){70, 130, false});
    input_is(8, STATE_LAW_REFLUX, 0, 1 / 3.6e6f, (struct block_signal){0, 12, true});
    input_is(9, STATE_LAW_HEAT, 0, 1000, (struct block_signal){0, 1.5f, true});
}

static void say_job(const char *what, unsigned loops)
{
    enum { PHASES = STATE_LAW_COLUMN_LAW + STATE_LAW_PHASE_OVER };
    struct cost all = {0}, of[PHASES + 1];
    static const char *const names[] = {"law_table",  "law_linear", "law_sample",
                                        "law_design", "law_inputs", "law_loop"};
    memset(of, 0, sizeof of);
    bool more = true;
    cost_paint_stack();
    while (more) {
        unsigned phase =
            column.phase < STATE_LAW_COLUMN_LAW ? column.phase : STATE_LAW_COLUMN_LAW + job->phase;
        uint32_t from = cost_now();
        more = state_law_column_piece(&column);
        uint32_t to = cost_now();
        cost_add(&all, from, to);
        cost_add(&of[phase], from, to);
    }
    cost_stack(&all);
    if (job->found.field[0])
        return; /* a row is missing */
    cost_say(what, loops, all.sum, all.most, sizeof column);
    cost_say("stack", loops, all.stack, all.stack, 0);
    for (unsigned k = 0; k < PHASES; k++)
        if (of[k].count)
            cost_say(names[k], loops, of[k].sum, of[k].most, of[k].count);
}

int main(void)
{
    pilot();
    state_law_column_begin(&column, &settings, input, 10, &record);
    say_job("law", 2);
    static const real_t b[2][2] = {{REAL_C(0.32), REAL_C(0.12)}, {REAL_C(-0.08), REAL_C(0.24)}};
    state_law_job_of_model(job, &settings, 2);
    struct state_model *m = &job->sampled;
    m->a.rows = m->a.cols = m->b.rows = m->b.cols = m->c.rows = m->c.cols = 2;
    for (unsigned i = 0; i < 2; i++) {
        m->a.value[i][i] = REAL_C(0.9);
        m->c.value[i][i] = REAL_C(1.0);
        for (unsigned j = 0; j < 2; j++)
            m->b.value[i][j] = b[i][j];
    }
    say_job("law_model", 2);
    cost_say("done", 0, 0, 0, 0);
    for (;;) {
    }
}
