/* A tick of the kind `ahead` with two loops: step and back-calculation, with the temperatures of six stages as inputs; its beginning
 * (follow); and one prediction alone, of which it makes four beside the observer's own. */
#include <stdalign.h>
#include <string.h>

#include "composition_tables.h"
#include "cost.h"
#include "kinds/ahead/column_ahead_block.h"
#include "kinds/ahead/column_ahead_model.h"
#include "kinds/ahead/column_ahead_parameters.h"

#define SAMPLES 60u
#define FIRST   5u
#define SEEN    6u

static alignas(8) char state[12000];
static struct column_record record;
static struct ahead_settings settings;
static struct block_setup setup;
static num_t pv[2], setpoint[2], output[2], input[SEEN + 2];
static uint8_t quality[SEEN + 2], clamp[2], at_limit[2];
static float event_value[BLOCK_EVENTS_MAX];

static void settings_for(unsigned stages)
{
    struct block_fault fault;
    memset(&settings, 0, sizeof settings);
    memset(&setup, 0, sizeof setup);
    settings.column = 1;
    settings.trust = 1;
    settings.parts = 3;
    for (unsigned k = 0; k < SEEN; k++) {
        settings.role[k] = AHEAD_TEMPERATURE;
        settings.place[k][AHEAD_STAGE] = (uint16_t)(3 + k * (stages - 4) / SEEN);
        settings.place[k][AHEAD_COMPONENT] = 1;
        setup.input[k] = (struct block_signal){250, 450, false};
    }
    settings.role[SEEN] = AHEAD_REFLUX;
    settings.role[SEEN + 1] = AHEAD_HEAT;
    for (unsigned i = 0; i < 2; i++) {
        settings.moves[i] = (uint16_t)(SEEN + 1u + i);
        settings.target[i][AHEAD_STAGE] = (uint16_t)(i ? 2 : stages - 1);
        settings.tau_s[i] = 60;
        setup.pv[i] = (struct block_signal){250, 450, false};
        setup.member[i] = (struct block_member){.loop = (uint8_t)i, .drives_mv = true};
    }
    setup.settings = &settings;
    setup.named = &record;
    setup.interval_s = 30;
    setup.members = 2;
    setup.present = 3;
    setup.inputs = SEEN + 2;
    struct ahead *b = (struct ahead *)(void *)state;
    /* MVs between nothing and twice what they nominally are. */
    struct column_table table;
    struct column_fault wrong;
    if (column_record_read(&record, &table, &wrong) != ERR_OK)
        return;
    setup.input[SEEN] = (struct block_signal){0, 2 * table.nominal.reflux_flow, true};
    setup.input[SEEN + 1] =
        (struct block_signal){0, 2 * (table.nominal.heat + table.heat_loss), true};
    if (ahead_kind.check(&setup, &fault) != ERR_OK || ahead_kind.bytes(&setup) > sizeof state ||
        ahead_kind.configure(state, &setup, false) != ERR_OK)
        b->places.loops = 0;
}

/* Sets readings to the model's values at its profile, with some scatter. */
static void readings(const real_t *temperature)
{
    for (unsigned k = 0; k < SEEN; k++)
        input[k] = num_from_float(
            (temperature[settings.place[k][AHEAD_STAGE] - 1] + 0.05f * cost_random() - 250) / 200);
    input[SEEN] = input[SEEN + 1] = num_from_float(0.5f);
    for (unsigned i = 0; i < 2; i++)
        pv[i] = num_from_float(
            (temperature[settings.target[i][AHEAD_STAGE] - 1] + 0.05f * cost_random() - 250) / 200);
}

static void cost_of_column(unsigned stages)
{
    struct ahead *b = (struct ahead *)(void *)state;
    struct cost step = {0}, begin = {0}, prediction = {0};
    real_t temperature[COLUMN_STAGES_MAX];
    settings_for(stages);
    if (!b->places.loops || ahead_model_look(&b->m, b->m.x) != ERR_OK)
        return; /* a row is missing */
    memcpy(temperature, b->m.column.temperature, sizeof temperature);
    struct block_io io = {.members.acting = 3,
                          .members.setpoint = setpoint,
                          .members.in = pv,
                          .members.out = output,
                          .members.clamp = clamp,
                          .members.limited = at_limit,
                          .inputs.value = input,
                          .inputs.quality = quality,
                          .requests.event_value = event_value,
                          .members.divisor = 1};
    for (unsigned t = 0; t < SAMPLES; t++) {
        readings(temperature);
        uint32_t from = cost_now();
        if (t == 0) {
            memcpy(setpoint, pv, sizeof setpoint);
            output[0] = output[1] = num_from_float(0.5f);
            ahead_kind.follow(state, &io);
            cost_add(&begin, from, cost_now());
        }
        cost_paint_stack();
        from = cost_now();
        ahead_kind.step(state, &io);
        ahead_kind.back_calculate(state, &io);
        uint32_t to = cost_now();
        if (t >= FIRST)
            cost_add(&step, from, to);
        cost_stack(&step);
        from = cost_now();
        enum err err = ahead_model_predict(&b->m, &b->m.inputs);
        to = cost_now();
        if (io.requests.gives_up || err)
            return;
        cost_add(&prediction, from, to);
    }
    begin.stack = prediction.stack = step.stack;
    cost_tell("ahead", stages, &step, ahead_kind.bytes(&setup));
    cost_tell("ahead_begins", stages, &begin, ahead_kind.bytes(&setup));
    cost_tell("ahead_predicts", stages, &prediction, ahead_kind.bytes(&setup));
}

int main(void)
{
    PUT_RECORD(&record, pilot_values);
    cost_of_column(12);
    PUT_RECORD(&record, splitter_values);
    change_record(&record, COLUMN_TABLE_TRUNCATED, 0);
    change_record(&record, COLUMN_TABLE_TRUNCATED + 1, 0);
    cost_of_column(37);
    cost_say("done", 0, 0, 0, 0);
    for (;;) {
    }
}
