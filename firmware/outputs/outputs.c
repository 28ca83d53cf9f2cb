/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "outputs/outputs.h"

#include <stdatomic.h>

#include "base/assertion.h"
#include "outputs/ad5422_state.h"
#include "outputs/analog_state.h"
#include "outputs/burst_state.h"
#include "outputs/enable_state.h"
#include "outputs/motor_valve_state.h"
#include "outputs/output_kind.h"
#include "outputs/pwm_state.h"
#include "outputs/relay_state.h"
#include "outputs/stepper_state.h"
#include "outputs/window_state.h"

/* A command as a word: the whole command, whether it is driven, and a number that differs from that of the command before. */
#define WORD_COMMAND 0x1FFFFu
#define WORD_DRIVEN  0x20000u
#define WORD_NEXT    0x40000u /* added to the number */
#define WORD_NUMBER  (~(WORD_COMMAND | WORD_DRIVEN))

/* Times that the tick reads what the clock writes. Two turns of the clock within a few instructions do not happen. */
#define READS 3u

union output_state {
    struct output_window window;
    struct output_relay relay;
    struct output_enable enable;
    OUTPUT_FURTHER(struct output_burst burst; struct output_pwm pwm; struct output_analog analog;
                   struct output_stepper stepper; struct output_motor_valve motor_valve;
                   struct output_ad5422 ad5422;)
};

struct output {
    const struct output_kind *kind; /* NULL: not used */
    hal_pin pin[OUTPUT_PINS];
    bool heater;
    uint32_t safe_command;
    uint32_t dead_man_ms;
    float full;               /* as the kind's open() says */
    _Atomic uint32_t word;    /* by the tick */
    uint32_t number;          /* of the word that the clock saw last */
    uint32_t age_ms;          /* of that word; stops at its largest value */
    volatile uint64_t amount; /* since it was opened, by the clock */
    volatile uint8_t rule;    /* enum output_rule, by the clock */
    uint64_t read_amount;     /* when the tick read it last */
    uint32_t read_ms;
    union output_state state;
};

struct output_report {
    _Atomic uint32_t turns; /* by itself */
    uint32_t seen;          /* by the clock */
    uint32_t age_ms;        /* stops at its largest value */
};

static struct {
    _Atomic bool open; /* the clock may step */
    _Atomic bool safe;
    _Atomic bool made_safe;      /* the clock has not turned since outputs_safe() */
    _Atomic uint32_t stuck;      /* a bit for each output, by the tick */
    bool begun;                  /* the clock has turned since outputs_open() */
    uint32_t now_ms;             /* at the clock's last turn */
    volatile uint32_t passed_ms; /* since outputs_open(), by the clock; wraps */
    struct output *enable;       /* the enable output, or NULL */
    struct output_report reporter[OUTPUTS_REPORTERS];
    struct output output[OUTPUTS_MAX];
} all;

static uint32_t older(uint32_t age_ms, uint32_t elapsed_ms)
{
    return age_ms < UINT32_MAX - elapsed_ms ? age_ms + elapsed_ms : UINT32_MAX;
}

static void close_all(void)
{
    hal_output_safe();
    for (unsigned k = 0; k < OUTPUTS_MAX; k++) {
        struct output *o = &all.output[k];
        if (o->kind && o->kind->close)
            o->kind->close(&o->state);
        for (unsigned m = 0; m < OUTPUT_PINS && o->kind; m++)
            if (o->pin[m] != HAL_PIN_NONE)
                hal_pin_use(o->pin[m], HAL_PIN_CLOSED);
        o->kind = NULL;
        o->rule = OUTPUT_UNUSED;
    }
    all.enable = NULL;
}

static enum err open_one(struct output *o, const struct output_settings *s)
{
    o->kind = output_kind(s->type);
    for (unsigned k = 0; k < OUTPUT_PINS; k++)
        o->pin[k] = output_uses(s->type, k) ? s->pin[k] : HAL_PIN_NONE;
    o->heater = s->heater;
    o->safe_command = output_whole_command(s->safe);
    o->dead_man_ms = output_ms(s->dead_man);
    o->number = atomic_load(&o->word) & WORD_NUMBER;
    o->age_ms = UINT32_MAX;
    o->amount = 0;
    o->rule = OUTPUT_DEAD_MAN;
    o->read_amount = 0;
    o->read_ms = 0;
    return o->kind->open(&o->state, s, &o->full);
}

enum err outputs_open(const struct output_settings *settings, uint8_t n, uint8_t *failed)
{
    REFLUX_ASSERT(n <= OUTPUTS_MAX);
    atomic_store(&all.open, false);
    close_all();
    for (uint8_t k = 0; k < n; k++) {
        if (settings[k].type == OUTPUT_NONE)
            continue;
        enum err err = open_one(&all.output[k], &settings[k]);
        if (err) {
            *failed = k;
            close_all();
            return err;
        }
        if (settings[k].type == OUTPUT_ENABLE)
            all.enable = &all.output[k];
    }
    for (unsigned k = 0; k < OUTPUTS_REPORTERS; k++) {
        struct output_report *r = &all.reporter[k];
        r->seen = atomic_load(&r->turns);
        r->age_ms = UINT32_MAX;
    }
    atomic_store(&all.stuck, 0);
    all.begun = false;
    all.passed_ms = 0;
    atomic_store(&all.open, true);
    return ERR_OK;
}

void outputs_command(uint8_t index, bool drive, float fraction)
{
    REFLUX_ASSERT(index < OUTPUTS_MAX);
    struct output *o = &all.output[index];
    uint32_t word = (atomic_load(&o->word) & WORD_NUMBER) + WORD_NEXT;
    if (drive && fraction == fraction)
        word |= WORD_DRIVEN | output_whole_command(fraction);
    atomic_store(&o->word, word);
}

void outputs_stuck(uint8_t index, bool stuck)
{
    REFLUX_ASSERT(index < OUTPUTS_MAX);
    uint32_t bits = atomic_load(&all.stuck), bit = (uint32_t)1 << index;
    atomic_store(&all.stuck, stuck ? bits | bit : bits & ~bit);
}

void outputs_report(enum output_reporter who)
{
    struct output_report *r = &all.reporter[who];
    atomic_store(&r->turns, atomic_load(&r->turns) + 1u);
}

enum output_rule outputs_rule(uint8_t index)
{
    REFLUX_ASSERT(index < OUTPUTS_MAX);
    return (enum output_rule)all.output[index].rule;
}

uint8_t outputs_faults(uint8_t index)
{
    REFLUX_ASSERT(index < OUTPUTS_MAX);
    const struct output *o = &all.output[index];
    return o->kind && o->kind->faults ? o->kind->faults(&o->state) : 0;
}

float outputs_mains(uint8_t index)
{
    REFLUX_ASSERT(index < OUTPUTS_MAX);
    const struct output *o = &all.output[index];
    return o->kind && o->kind->mains ? o->kind->mains(&o->state) : 0.0f;
}

float outputs_readback(uint8_t index)
{
    REFLUX_ASSERT(index < OUTPUTS_MAX);
    struct output *o = &all.output[index];
    uint32_t passed_ms = all.passed_ms;
    uint64_t amount = o->amount;
    /* The clock may have turned in between. */
    for (unsigned k = 1; k < READS && passed_ms != all.passed_ms; k++) {
        passed_ms = all.passed_ms;
        amount = o->amount;
    }
    uint32_t ms = passed_ms - o->read_ms;
    uint64_t more = amount - o->read_amount;
    o->read_ms = passed_ms;
    o->read_amount = amount;
    if (!o->kind || ms == 0)
        return 0.0f;
    /* In two parts, because the processor turns no whole number of 64 bits into a float. */
    float whole = (float)(uint32_t)(more >> 16);
    float part = (float)(uint32_t)(more & 0xFFFFu) / (float)OUTPUT_FULL;
    return (whole + part) / ((float)ms * o->full);
}

/* Whether all who have to report have done so, and no heater is stuck on. */
static bool may_heat(uint32_t elapsed_ms)
{
    bool well = elapsed_ms <= OUTPUTS_REPORT_MS && atomic_load(&all.stuck) == 0;
    for (unsigned k = 0; k < OUTPUTS_REPORTERS; k++) {
        struct output_report *r = &all.reporter[k];
        uint32_t turns = atomic_load(&r->turns);
        r->age_ms = turns != r->seen ? 0 : older(r->age_ms, elapsed_ms);
        r->seen = turns;
        well = well && r->age_ms < OUTPUTS_REPORT_MS;
    }
    return well;
}

/* Who rules this output from now on; *command: what the tick wants, where it does. */
static enum output_rule look_at_command(struct output *o, uint32_t elapsed_ms, uint32_t *command)
{
    uint32_t word = atomic_load(&o->word);
    bool fresh = (word & WORD_NUMBER) != o->number;
    o->number = word & WORD_NUMBER;
    o->age_ms = fresh ? 0 : older(o->age_ms, elapsed_ms);
    *command = word & WORD_COMMAND;
    if (o->age_ms >= o->dead_man_ms)
        return OUTPUT_DEAD_MAN;
    return word & WORD_DRIVEN ? OUTPUT_COMMANDED : OUTPUT_NO_DRIVER;
}

/* Steps an output; in the enable output `heat` is its command. */
static void step_one(struct output *o, bool safe, bool heat, uint32_t elapsed_ms)
{
    uint32_t command;
    enum output_rule rule = look_at_command(o, elapsed_ms, &command);
    if (safe)
        rule = OUTPUT_SAFE;
    else if (o->heater && !heat)
        rule = OUTPUT_NO_ENABLE;
    bool begins = rule == OUTPUT_COMMANDED && o->rule != OUTPUT_COMMANDED;
    o->rule = (uint8_t)rule;
    if (begins && o->kind->align)
        o->kind->align(&o->state, all.now_ms - elapsed_ms);
    bool keeps = rule != OUTPUT_SAFE && rule != OUTPUT_NO_ENABLE && o->kind->keeps_position;
    if (rule == OUTPUT_COMMANDED)
        o->amount += o->kind->step(&o->state, command, elapsed_ms);
    else if (keeps)
        o->amount += o->kind->step(&o->state, o->safe_command, elapsed_ms);
    else
        o->amount += o->kind->off(&o->state, elapsed_ms);
}

/* Steps the enable output. Returns whether heaters may be on: it has been on and stays so. */
static bool step_enable(bool safe, uint32_t elapsed_ms)
{
    bool well = may_heat(elapsed_ms) && !safe;
    struct output *o = all.enable;
    if (!o)
        return true;
    uint32_t amount = o->kind->step(&o->state, well ? OUTPUT_FULL : 0, elapsed_ms);
    o->amount += amount;
    o->rule = safe ? OUTPUT_SAFE : well ? OUTPUT_COMMANDED : OUTPUT_DEAD_MAN;
    return well && amount > 0;
}

static void step_all(bool safe, uint32_t elapsed_ms)
{
    bool heat = step_enable(safe, elapsed_ms);
    for (unsigned k = 0; k < OUTPUTS_MAX; k++) {
        struct output *o = &all.output[k];
        if (o->kind && o != all.enable)
            step_one(o, safe, heat, elapsed_ms);
    }
    all.passed_ms += elapsed_ms;
}

void outputs_clock(uint32_t now_ms)
{
    uint32_t elapsed_ms = all.begun ? now_ms - all.now_ms : 0;
    if (!atomic_load(&all.open))
        return;
    all.begun = true;
    all.now_ms = now_ms;
    if (elapsed_ms == 0)
        return;
    if (elapsed_ms > OUTPUT_ELAPSED_MAX)
        elapsed_ms = OUTPUT_ELAPSED_MAX;
    bool made_safe = atomic_exchange(&all.made_safe, false);
    if (made_safe && elapsed_ms > 1u) {
        /* The pins have been off since outputs_safe(), not for the last millisecond only. */
        step_all(true, 1u);
        elapsed_ms--;
    }
    step_all(made_safe || atomic_load(&all.safe), elapsed_ms);
    for (unsigned k = 0; k < OUTPUTS_MAX; k++) {
        struct output *o = &all.output[k];
        if (o->kind && o->kind->clock)
            o->kind->clock(&o->state, now_ms);
    }
}

void outputs_safe(void)
{
    /* In this order: after a turn of the clock in between everything is off already. */
    atomic_store(&all.safe, true);
    atomic_store(&all.made_safe, true);
    hal_output_safe();
}

void outputs_resume(void)
{
    atomic_store(&all.safe, false);
}
