/* Motor valve: one pin opens, the other one closes, never both; the position is reckoned from the time that the motor has run.
 *
 * At first the position is not known, and the valve goes to the end that is nearer to its safe position. It has arrived when the contact of that
 * end has closed. Without a contact the motor runs for the travel time and an eighth more, against the switch or clutch within the drive. A
 * command of 0 or 1 goes on to its end in the same way. Each arrival sets the position anew, and so does a contact that closes earlier than
 * reckoned, so that the reckoning cannot drift away.
 *
 * A contact that has not closed after half the travel time beyond the reckoned end is missed: the valve counts as arrived, and the output tells.
 * With both contacts closed the motor stands, because one of them is wrong.
 *
 * The valve starts when the command is further away than the dead band and stops when the reckoned position is there. Before it turns back the
 * motor rests for the pause.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "outputs/motor_valve_state.h"

#include "outputs/output_kind.h"

#define OPENS      1
#define CLOSES     (-1)
#define BOUNCE_MS  5u /* a contact is closed when it has been so long */
#define OPEN_END   0u /* indices of closed_ms */
#define CLOSED_END 1u

static const char *valve_check(const struct output_settings *s)
{
    if (s->pause > s->travel)
        return "the pause is longer than the travel time";
    return NULL;
}

static enum err valve_open(void *state, const struct output_settings *s, float *full)
{
    struct output_motor_valve *v = state;
    *full = 1.0f;
    *v = (struct output_motor_valve){
        .travel_ms = output_ms(s->travel),
        .band_ms = output_ms(s->travel * s->dead_band),
        .pause_ms = output_ms(s->pause),
        .home = s->safe < 0.5f ? CLOSES : OPENS,
    };
    v->scale = UINT32_MAX / v->travel_ms;
    v->place_ms = v->home == CLOSES ? v->travel_ms : 0;
    enum err err = ERR_OK;
    for (unsigned k = 0; k < VALVE_PINS; k++) {
        v->pin[k] = s->pin[k];
        if (k < OUTPUT_OPEN_END && !err)
            err = hal_output_open(s->pin[k], s->low);
        else if (s->pin[k] != HAL_PIN_NONE)
            hal_pin_use(s->pin[k], HAL_PIN_INPUT_PULLED);
    }
    return err;
}

static void valve_stop(struct output_motor_valve *v)
{
    hal_output_set(v->pin[OUTPUT_PIN], false);
    hal_output_set(v->pin[OUTPUT_SECOND_PIN], false);
    if (v->running)
        v->rest_ms = 0;
    v->running = 0;
}

/* Starts the motor unless it has to rest first. */
static void valve_start(struct output_motor_valve *v, int8_t direction)
{
    if (direction != v->turned && v->rest_ms < v->pause_ms)
        return;
    hal_output_set(v->pin[direction == OPENS ? OUTPUT_PIN : OUTPUT_SECOND_PIN], true);
    v->running = direction;
    v->turned = direction;
    v->seated = 0;
    v->beyond_ms = 0;
}

/* The valve is certainly at this end. */
static void valve_seat(struct output_motor_valve *v, int8_t end)
{
    v->place_ms = end == OPENS ? v->travel_ms : 0;
    v->seated = end;
    v->homed = true;
}

/* Reckons the way of the time that has passed. */
static void valve_pass(struct output_motor_valve *v, uint32_t elapsed_ms)
{
    uint32_t room = v->running == OPENS ? v->travel_ms - v->place_ms : v->place_ms;
    uint32_t way = elapsed_ms < room ? elapsed_ms : room;
    if (v->running == OPENS)
        v->place_ms += way;
    else if (v->running == CLOSES)
        v->place_ms -= way;
    if (v->running)
        v->beyond_ms += elapsed_ms - way;
    else
        v->rest_ms = v->rest_ms < UINT32_MAX - elapsed_ms ? v->rest_ms + elapsed_ms : UINT32_MAX;
}

/* Looks at the contact of an end; true: it is closed. */
static bool valve_contact(struct output_motor_valve *v, unsigned pin, unsigned k,
                          uint32_t elapsed_ms)
{
    if (v->pin[pin] == HAL_PIN_NONE || hal_pin_read(v->pin[pin])) {
        v->closed_ms[k] = 0;
        return false;
    }
    uint32_t closed = v->closed_ms[k] + elapsed_ms;
    v->closed_ms[k] = (uint8_t)(closed < BOUNCE_MS ? closed : BOUNCE_MS);
    return v->closed_ms[k] == BOUNCE_MS;
}

/* Whether a motor that runs to an end, or would, has arrived there. */
static bool valve_arrived(struct output_motor_valve *v, int8_t end, bool contact)
{
    bool has_contact = v->pin[end == OPENS ? OUTPUT_OPEN_END : OUTPUT_CLOSED_END] != HAL_PIN_NONE;
    if (contact) {
        v->faults &= (uint8_t)~OUTPUT_END_MISSED;
        return true;
    }
    if (v->running != end || v->beyond_ms < v->travel_ms / (has_contact ? 2u : 8u))
        return false;
    if (has_contact)
        v->faults |= OUTPUT_END_MISSED;
    return true;
}

/* Direction in which the valve has to go for a target; 0: it may stay. */
static int8_t valve_way(const struct output_motor_valve *v, uint32_t target_ms)
{
    int8_t way = target_ms > v->place_ms ? OPENS : target_ms < v->place_ms ? CLOSES : 0;
    if (!v->homed)
        return v->home;
    if (target_ms == 0)
        return v->seated == CLOSES ? 0 : CLOSES;
    if (target_ms == v->travel_ms)
        return v->seated == OPENS ? 0 : OPENS;
    if (v->running)
        return way; /* as far as it goes, or past the target: another way than the motor's stops it */
    uint32_t distance = way == OPENS ? target_ms - v->place_ms : v->place_ms - target_ms;
    return distance > v->band_ms ? way : 0;
}

static uint32_t valve_amount(const struct output_motor_valve *v, uint32_t elapsed_ms)
{
    if (v->place_ms == v->travel_ms)
        return elapsed_ms * OUTPUT_FULL;
    return elapsed_ms * (uint32_t)(((uint64_t)v->place_ms * v->scale) >> 16);
}

static uint32_t valve_step(void *state, uint32_t command, uint32_t elapsed_ms)
{
    struct output_motor_valve *v = state;
    uint32_t target = (uint32_t)(((uint64_t)v->travel_ms * command + OUTPUT_FULL / 2u) >> 16);
    valve_pass(v, elapsed_ms);
    bool open = valve_contact(v, OUTPUT_OPEN_END, OPEN_END, elapsed_ms);
    bool closed = valve_contact(v, OUTPUT_CLOSED_END, CLOSED_END, elapsed_ms);
    int8_t way = valve_way(v, target);
    v->faults =
        (uint8_t)((v->faults & ~OUTPUT_BOTH_ENDS) | (open && closed ? OUTPUT_BOTH_ENDS : 0));
    if (open && closed) {
        way = 0;
    } else if (way && valve_arrived(v, way, way == OPENS ? open : closed)) {
        valve_seat(v, way);
        way = 0;
    }
    if (v->running && way != v->running)
        valve_stop(v);
    else if (way && !v->running)
        valve_start(v, way);
    return valve_amount(v, elapsed_ms);
}

static uint32_t valve_off(void *state, uint32_t elapsed_ms)
{
    struct output_motor_valve *v = state;
    valve_pass(v, elapsed_ms);
    valve_stop(v);
    return valve_amount(v, elapsed_ms);
}

static uint8_t valve_faults(const void *state)
{
    const struct output_motor_valve *v = state;
    return v->homed ? v->faults : v->faults | OUTPUT_NO_POSITION;
}

const struct output_kind motor_valve_output = {.check = valve_check,
                                               .open = valve_open,
                                               .step = valve_step,
                                               .off = valve_off,
                                               .faults = valve_faults,
                                               .keeps_position = true};
