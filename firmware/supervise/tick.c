/* The order of a tick (docs/inside/tick.md), and its shorter steps: readings in, loops, commands. */

#include "supervise/alarms.h"
#include "supervise/back_calculate.h"
#include "supervise/block_excitation.h"
#include "supervise/blocks.h"
#include "supervise/by_board.h"
#include "supervise/compensate.h"
#include "supervise/constrain.h"
#include "supervise/estimates.h"
#include "supervise/estimators.h"
#include "supervise/feed_forward.h"
#include "supervise/histories.h"
#include "supervise/numbered_control.h"
#include "supervise/numbered_switch.h"
#include "supervise/sequence.h"
#include "supervise/setpoint.h"
#include "supervise/supervisor.h"
#include "supervise/transfer.h"
#include "supervise/validate.h"
#include "supervise/watch.h"

void supervisor_validate(struct supervisor *s, const struct tick_input *input)
{
    if (input->time_ms < s->time_ms) {
        alarms_time_back(s);
        /* Delays begin anew, because the time in which they counted is no longer valid. */
        for (uint8_t k = 0; k < s->placed[PLACED_INTERLOCKS]; k++)
            s->interlock[k].pending = false;
    }
    estimates_keep(s);
    s->time_ms = input->time_ms;
    uint8_t rows = s->placed[PLACED_MEASUREMENTS];
    if (rows < s->placed[PLACED_MVS])
        rows = s->placed[PLACED_MVS];
    for (uint8_t i = 0; i < rows; i++) {
        if (s->plan->config.measurement[i].name[0] && !plan_is_estimate(s->plan, i))
            validate_measurement(s, i, &input->measurement[i]);
        if (s->plan->config.mv[i].name[0])
            validate_readback(s, i, &input->readback[i]);
    }
    watch_twins(s);
    estimators_step(s);
}

/* Puts loop i into manual if the plant lacks its channels, because a new plan may name channels that the plant does
 * not have, or has with another unit. */
static void drop_unbound(struct supervisor *s, uint8_t i)
{
    const struct loop_plan *p = &s->plan->loop[i];
    if (!loop_acts(s, i) ||
        (s->measurement[p->pv].bound && (p->mv == PLAN_NONE || s->mv[p->mv].bound)))
        return;
    board_to_manual(s, i, BY_BOARD_UNBOUND);
}

static void advance_setpoint(struct supervisor *s, uint8_t i)
{
    if (s->loop[i].mode == LOOP_MANUAL)
        setpoint_idle(s, i);
    else if (loop_due(s, i, s->ticks))
        setpoint_advance(s, i);
}

/* The loop's own controller, if it acts and no other block acts for it. */
static void control_loop(struct supervisor *s, uint8_t i)
{
    if (!loop_drives(s, i) || loop_server(s, i) != PLAN_NONE || !loop_due(s, i, s->ticks))
        return;
    block_close(s, i);
    block_step(s, i);
}

static void run_controllers(struct supervisor *s)
{
    uint8_t end = plan_stage_end(s->plan, STAGE_CONTROL);
    for (uint8_t k = plan_stage_begin(s->plan, STAGE_CONTROL); k < end; k++) {
        uint8_t block = s->plan->listed[k];
        if (block >= BLOCK_NUMBERED) {
            numbered_control(s, block);
            continue;
        }
        advance_setpoint(s, block);
        control_loop(s, block);
    }
}

static void make_commands(struct supervisor *s)
{
    num_t u[CONFIG_LOOPS];
    for (uint8_t i = 0; i < s->placed[PLACED_LOOPS]; i++)
        u[i] = s->loop[i].v;
    compensators_step(s, u);
    for (uint8_t j = 0; j < s->placed[PLACED_MVS]; j++) {
        if (!s->plan->config.mv[j].name[0])
            continue;
        uint8_t i = s->plan->owner[j];
        bool drives = i != PLAN_NONE && loop_drives(s, i);
        num_t wanted = drives ? num_add(u[i], s->loop[i].feedforward) : s->mv[j].manual;
        /* The limit holds in floating point too, so that the command is finite in EU. */
        num_t most = num_from_float(NUM_MAX_MAGNITUDE);
        s->mv[j].commanded = num_clamp(num_add(wanted, s->mv[j].excitation), num_neg(most), most);
    }
}

void supervisor_control(struct supervisor *s)
{
    sequence_run(s);
    for (uint8_t i = 0; i < s->placed[PLACED_LOOPS]; i++) {
        drop_unbound(s, i);
        loop_find_driving(s, i);
    }
    numbered_check_inputs(s);
    excitation_watch(s);
    num_t before[CONFIG_LOOPS];
    feed_forward(s, before);
    bumpless_transfer(s, before);
    run_controllers(s);
    make_commands(s);
    excitation_check_commands(s);
    constrain_mvs(s);
    back_calculate_loops(s);
    alarms_run(s);
    histories_append(s);
    s->ticks++;
}
