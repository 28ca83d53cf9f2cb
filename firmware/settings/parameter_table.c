/* Declares every parameter. Ids never change: take the next free one for a new field. */
#include <stddef.h>

#include "exchange/rows.h"
#include "outputs/output_numbers.h"
#include "settings/parameter_table.h"

#define BIG 1e9f

/* List of limits and defaults. They are a few numbers that many rows share, so a row holds places in this list. A new
 * number goes to the end. */
/* clang-format off */
#define VALUES(V, x)                                                                                \
    V(0, 0.0f, x) V(1, BIG, x) V(2, -BIG, x) V(3, 1.0f, x) V(4, -1.0f, x) V(5, 100.0f, x)           \
    V(6, -100.0f, x) V(7, 1e5f, x) V(8, 1e6f, x) V(9, 2.0f, x) V(10, 60.0f, x) V(11, 0.01f, x)      \
    V(12, 65535.0f, x) V(13, 9999.0f, x) V(14, 10000.0f, x) V(15, 1e-6f, x)   V(16, 8.0f, x)        \
    V(17, 3600.0f, x) V(18, 86400.0f, x) V(19, 900.0f, x) V(20, 1000.0f, x) V(21, 4.0f, x)          \
    V(22, 5.0f, x) V(23, 10.0f, x) V(24, 16.0f, x) V(25, 20.0f, x) V(26, 30.0f, x) V(27, 0.5f, x)   \
    V(28, 0.975f, x) V(29, 0.9999f, x) V(30, 0.1f, x) V(31, 1.5f, x) \
    DEVICE_VALUES(V(32, 120.0f, x) V(33, 0.02f, x) V(34, 600.0f, x) V(35, 3.0f, x) V(36, 0.98f, x)  \
                  V(37, 0.001f, x) V(38, 50.0f, x) V(39, 500.0f, x) V(40, 0.2f, x) V(41, 0.05f, x))
/* clang-format on */

#define ENTRY(place, value, x) [place] = (value),
const float parameter_numbers[] = {VALUES(ENTRY, )};

/* A number that is not in the list gets a place that no byte holds, so the compiler refuses it. */
#define PLACE_IF(place, value, x) (float)(x) == (value) ? (place):
#define PLACE(x)                  (VALUES(PLACE_IF, x) 0x100)

/* Row of the table. unit: the words of a PARAMETER_WORD; PARAMETER_SECRET, PARAMETER_SUBJECT or "" of a PARAMETER_NAME. */
#define ROW(id, type, offset, name, unit, lo, hi, initial, help)                                   \
    {                                                                                              \
        id, type, offset, name, unit, help, PLACE(lo), PLACE(hi), PLACE(initial), false            \
    }

#define F(s, member, id, name, unit, lo, hi, initial, help)                                        \
    ROW(id, PARAMETER_FLOAT, offsetof(struct s, member), name, unit, lo, hi, initial, help)
#define W(s, member, id, name, words, initial, help)                                               \
    ROW(id, PARAMETER_WORD, offsetof(struct s, member), name, words, 0, 0, initial, help)
#define N(s, member, id, name, help)                                                               \
    ROW(id, PARAMETER_NAME, offsetof(struct s, member), name, "", 0, 0, 0, help)

/* Fields of a group that a board may lack. */
#define OPTIONAL_FIELDS static const __attribute__((unused)) struct parameter_field

static const struct parameter_field config_fields[] = {
    ROW(1, PARAMETER_FIXED, offsetof(struct config, schema), "schema", "", 0, 0, CONFIG_SCHEMA,
        "version of this list of parameters"),
};

static const struct parameter_field tick_fields[] = {
    F(config, tick_s, 1, "base", "s", 0, 3600, 0,
      "base tick; 0 = what the plant announces, else 0.05 or more"),
    ROW(2, PARAMETER_U32, offsetof(struct config, miss_limit), "miss_limit", "ticks", 1, 1000000, 5,
        "missing samples in a row that lead to the safe state"),
    F(config, sample_timeout_s, 3, "timeout", "s", 0, 1e5f, 0,
      "no sample for this long of the board's clock: safe state; 0 = off, for plants that may "
      "wait"),
};

/* Rows of an analyser, and of a calibration. */
#define A(member, id, lo, hi, initial, help)                                                       \
    {                                                                                              \
        id, PARAMETER_U16, offsetof(struct measurement_config, analyser.member), #member, "ticks", \
            help, PLACE(lo), PLACE(hi), PLACE(initial), true                                       \
    }
#define C(member, id, unit, lo, hi, initial, help)                                                 \
    {                                                                                              \
        id, PARAMETER_FLOAT, offsetof(struct measurement_config, calibration.member), #member,     \
            unit, help, PLACE(lo), PLACE(hi), PLACE(initial), true                                 \
    }

static const struct parameter_field measurement_fields[] = {
    N(measurement_config, name, 1, "name", "measurement as the plant announces it; - = unused"),
    ROW(2, PARAMETER_UNIT, offsetof(struct measurement_config, unit), "unit", "", 0, 0, 0,
        "engineering unit; must equal what the plant announces"),
    F(measurement_config, lo, 3, "lo", "EU", -BIG, BIG, 0, "lower end of the span (0 %)"),
    F(measurement_config, hi, 4, "hi", "EU", -BIG, BIG, 100, "upper end of the span (100 %)"),
    F(measurement_config, filter_s, 5, "filter", "s", 0, 1e5f, 0,
      "first-order filter time constant; 0 = none"),
    F(measurement_config, sensor_hold_s, 6, "hold", "s", 0, 1e5f, 60,
      "a bad reading is held this long, then the fall-back follows"),
    W(measurement_config, fallback, 7, "fallback", "hold|substitute|manual|safe", FALLBACK_HOLD,
      "without a valid reading: hold, then manual; hold, then substitute; manual at once; "
      "hold, "
      "then the safe state"),
    F(measurement_config, substitute, 8, "substitute", "EU", -BIG, BIG, 0,
      "value that stands in, with fallback substitute"),
    F(measurement_config, rate_limit, 9, "rate_limit", "EU/s", 0, BIG, 0,
      "a faster change is not valid; 0 = off"),
    F(measurement_config, frozen_s, 10, "frozen", "s", 0, 1e6f, 0,
      "a reading that has not changed at all for this long is not valid; 0 = off"),
    N(measurement_config, infer, 11, "infer",
      CONFIG_BLOCKS ? "manipulated variable, or point that a block writes, that stands in for a "
                      "lost reading; - = "
                      "none"
                    : "manipulated variable whose output stands in for a lost reading; - = none"),
    F(measurement_config, infer_gain, 12, "infer_gain", "EU/EU", -BIG, BIG, 1,
      "inferred value per unit of that output"),
    F(measurement_config, infer_offset, 13, "infer_offset", "EU", -BIG, BIG, 0,
      "inferred value where that output is 0"),
    START_UP_ROWS(W(measurement_config, start_up.test, 14, "test", "off|on", 1,
                    "automatic start-up finds a loop for it"),
                  F(measurement_config, start_up.limit, 15, "test_limit", "EU", 0, BIG, 0,
                    "largest deviation from rest during a test; 0 = a fifth of the span"),
                  W(measurement_config, start_up.critical, 16, "test_critical", "off|on", 0,
                    "during a test it may deviate only half as far"))
        SEQUENCE_ROWS(
            F(measurement_config, offset.eu, 17, "offset", "EU", -BIG, BIG, 0,
              "subtracted from the reading while a sequence has switched it on (offset_on)"))
            ANALYSER_ROWS(
                A(every, 18, 1, 10000, 1,
                  "base ticks from one sample of it to the next (an analyser)"),
                A(phase, 19, 0, 9999, 0,
                  "base tick of plant time within these in which a sample comes"),
                A(delay, 20, 0, 10000, 0, "base ticks from sampling until the sample comes"))
                CALIBRATION_ROWS(
                    C(gain, 21, "EU/EU", 1e-6f, 1e6f, 1,
                      "calibration: reading = zero + gain times what the plant sends"),
                    C(zero, 22, "EU", -BIG, BIG, 0,
                      "calibration: added to that (inside/faults.md)"),
                    C(valid_lo, 23, "EU", -BIG, BIG, 0,
                      "a lower reading is not valid; both 0 = -2.5 % and 106.25 % of the span, as "
                      "NAMUR NE 43"),
                    C(valid_hi, 24, "EU", -BIG, BIG, 0, "a higher reading is not valid"))};

static const struct parameter_field mv_fields[] = {
    N(mv_config, name, 1, "name", "manipulated variable as announced; - = unused"),
    ROW(2, PARAMETER_UNIT, offsetof(struct mv_config, unit), "unit", "", 0, 0, 0,
        "engineering unit; must equal what the plant announces"),
    F(mv_config, lo, 3, "lo", "EU", -BIG, BIG, 0, "lower end of the span (0 %)"),
    F(mv_config, hi, 4, "hi", "EU", -BIG, BIG, 100, "upper end of the span (100 %)"),
    F(mv_config, min, 5, "min", "EU", -BIG, BIG, 0, "lowest value ever commanded while acting"),
    F(mv_config, max, 6, "max", "EU", -BIG, BIG, 100,
      "highest value ever commanded while acting; moves with hi while it is hi"),
    F(mv_config, rate_per_s, 7, "rate", "EU/s", 0, BIG, 0, "fastest change; 0 = no limit"),
    F(mv_config, safe, 8, "safe", "EU", -BIG, BIG, 0, "value at start, on silence, in safe state"),
    F(mv_config, readback_band, 9, "band", "fraction", 0, 1, 0.01f,
      "read-back this close to the command counts as followed"),
    F(mv_config, follow_s, 10, "follow", "s", 0, 1e5f, 0,
      "a command not followed for this long is an alarm"),
    START_UP_ROWS(
        W(mv_config, start_up.test, 11, "test", "off|on", 1, "automatic start-up moves it"),
        F(mv_config, start_up.step, 12, "test_step", "EU", 0, BIG, 0,
          "amplitude of the test; 0 = rises until the response stands out"),
        F(mv_config, start_up.time_s, 13, "test_time", "s", 0, 1e6f, 0,
          "length of half a double step; 0 = until the plant is at rest"),
        W(mv_config, start_up.critical, 14, "test_critical", "off|on", 0,
          "tested first: its times are the first guess for the others"))};

static const struct parameter_field loop_fields[] = {
    N(loop_config, name, 1, "name", "name of the loop; - = unused"),
    N(loop_config, pv, 2, "pv", "measurement to control"),
    N(loop_config, out, 3, "out", "manipulated variable, or loop whose setpoint it drives"),
    F(loop_config, own.gain, 4, "gain", "fraction/fraction", 1e-6f, 100, 1,
      "proportional gain, output span per measurement span"),
    F(loop_config, own.ti_s, 5, "ti", "s", 0, 1e6f, 0, "integral time; 0 = no integral action"),
    F(loop_config, own.td_s, 6, "td", "s", 0, 1e5f, 0, "derivative time; 0 = no derivative action"),
    F(loop_config, own.n, 7, "n", "-", 1, 100, 8, "derivative filter ratio: filter time is td/n"),
    F(loop_config, own.b, 8, "b", "-", 0, 1, 1, "setpoint weight of the proportional part"),
    F(loop_config, own.c, 9, "c", "-", 0, 1, 0, "setpoint weight of the derivative part"),
    F(loop_config, own.tt_s, 10, "tt", "s", 0, 1e6f, 0, "tracking time constant; 0 = automatic"),
    F(loop_config, own.inhibit_s, 11, "inhibit", "s", 0, 1e5f, 0,
      "overshoot inhibitor, prediction time; 0 = off"),
    F(loop_config, own.out_lo, 12, "out_lo", "fraction", -1, 2, 0,
      "lower limit of the loop's output"),
    F(loop_config, own.out_hi, 13, "out_hi", "fraction", -1, 2, 1,
      "upper limit of the loop's output"),
    F(loop_config, own.out_rate_per_s, 14, "out_rate", "fraction/s", 0, 100, 0,
      "fastest change of the loop's output; 0 = no limit"),
    F(loop_config, sp_lo, 15, "sp_lo", "EU", -BIG, BIG, 0, "lowest setpoint; both 0 = the span"),
    F(loop_config, sp_hi, 16, "sp_hi", "EU", -BIG, BIG, 0, "highest setpoint; both 0 = the span"),
    F(loop_config, sp_ramp_per_min, 17, "sp_ramp", "EU/min", 0, BIG, 0,
      "fastest change of the setpoint; 0 = jump"),
    F(loop_config, sp_filter_s, 18, "sp_filter", "s", 0, 1e5f, 0,
      "first-order setpoint filter; 0 = none"),
    W(loop_config, own.action, 19, "action", "reverse|direct", LOOP_REVERSE,
      "reverse: output rises when the measurement is below setpoint (heating)"),
    W(loop_config, own.algorithm, 20, "algorithm", "positional|velocity|two_position",
      LOOP_POSITIONAL, "form of the PID; two_position: out_hi or out_lo (use/loops.md)"),
    W(loop_config, sp_track, 21, "sp_track", "off|on", 1,
      "in manual the setpoint follows the measurement"),
    W(loop_config, decouple, 22, "decouple", "off|on", 0, "takes part in the static decoupler"),
    ROW(23, PARAMETER_U16, offsetof(struct loop_config, divisor), "divisor", "ticks", 1, 10000, 1,
        "base ticks from one run to the next"),
    ROW(24, PARAMETER_U16, offsetof(struct loop_config, phase), "phase", "ticks", 0, 9999, 0,
        "base tick within the divisor at which it runs"),
    F(loop_config, own.band, 25, "band", "EU", 0, BIG, 0,
      "two_position: distance from the setpoint at which the output switches"),
};

/* Row i of the decoupler is decouple<i>.d1 .. d8. Its diagonal is 1 by default (parameters_defaults). */
#define D(k)                                                                                       \
    ROW(k, PARAMETER_FLOAT, ((k)-1) * sizeof(float), "d" #k, "fraction/fraction", -100, 100, 0,    \
        "output of this row's loop per output of loop " #k)
static const struct parameter_field decoupler_fields[] = {
    D(1), D(2), D(3), D(4), D(5), D(6), D(7), D(8),
};

static const struct parameter_field feedforward_fields[] = {
    N(ff_config, from, 1, "from", "disturbance, measured or manipulated variable; - = unused"),
    N(ff_config, to, 2, "to", "manipulated variable that is corrected"),
    F(ff_config, gain, 3, "gain", "fraction/fraction", -100, 100, 0,
      "correction, output span per measurement span"),
    F(ff_config, lead_s, 4, "lead", "s", 0, 1e5f, 0, "lead time constant"),
    F(ff_config, lag_s, 5, "lag", "s", 0, 1e5f, 0, "lag time constant"),
    F(ff_config, dead_s, 6, "dead", "s", 0, 1e5f, 0, "dead time"),
    F(ff_config, reference, 7, "reference", "EU", -BIG, BIG, 0,
      "measurement at which the correction is 0"),
    F(ff_config, lo, 8, "lo", "fraction", -1, 1, -1, "most negative correction"),
    F(ff_config, hi, 9, "hi", "fraction", -1, 1, 1, "most positive correction"),
};

static const struct parameter_field interlock_fields[] = {
    N(interlock_config, measurement, 1, "meas", "measurement that is watched; - = unused"),
    N(interlock_config, mv, 2, "mv", "manipulated variable that is interlocked"),
    W(interlock_config, side, 3, "side", "above|below", INTERLOCK_ABOVE,
      "acts when the measurement is above or below the limit"),
    F(interlock_config, limit, 4, "limit", "EU", -BIG, BIG, 0, "limit of the measurement"),
    F(interlock_config, hysteresis, 5, "hysteresis", "EU", 0, BIG, 0,
      "released when back inside by this much"),
    F(interlock_config, delay_s, 6, "delay", "s", 0, 1e5f, 0, "the condition must hold this long"),
    F(interlock_config, value, 7, "value", "EU", -BIG, BIG, 0,
      "value of the output while interlocked"),
    W(interlock_config, on_bad, 8, "on_bad", "off|on", 1,
      "a bad measurement counts as the condition"),
    GUARD_ROWS(
        W(interlock_config, latch.on, 9, "latch", "off|on", 0, "holds until `alarm release`"))};

static const struct parameter_field alarm_fields[] = {
    ROW(1, PARAMETER_NAME, offsetof(struct alarm_config, on), "on",
        CONFIG_BLOCKS ? PARAMETER_SUBJECT : "", 0, 0, 0,
        CONFIG_BLOCKS ? "measurement that is watched, loop (deviation), or event of a block "
                        "(blockN.CODE); - = "
                        "unused"
                      : "measurement that is watched, or loop (deviation); - = unused"),
    W(alarm_config, side, 2, "side", "hi_hi|hi|lo|lo_lo|deviation", ALARM_HI,
      "which limit this is; deviation: distance from the setpoint of a loop that acts"),
    F(alarm_config, limit, 3, "limit", "EU", -BIG, BIG, 0, "limit of the measurement or distance"),
    F(alarm_config, hysteresis, 4, "hysteresis", "EU", 0, BIG, 0,
      "over when back inside by this much"),
    F(alarm_config, delay_s, 5, "delay", "s", 0, 1e5f, 0, "the condition must hold this long"),
    W(alarm_config, priority, 6, "priority", "low|medium|high", ALARM_PRIORITY_MEDIUM,
      "shown with the alarm"),
    W(alarm_config, latch, 7, "latch", "off|on", 0, "stays on the list until acknowledged"),
    W(alarm_config, group, 8, "group", "none|a|b|c|d|e|f", 0,
      "the first alarm of a group is marked"),
};

#define STEP_FIELD(member) offsetof(struct step_config, member)

static const struct parameter_field step_fields[] = {
#define S(member, id, name, words, initial, help)                                                  \
    ROW(id, PARAMETER_WORD, offsetof(struct step_config, member), name, words, 0, 0, initial, help)
    S(sequence, 1, "seq", "none|start|stop", SEQUENCE_NONE,
      "sequence the row belongs to (use/sequences.md); none = unused"),
    S(action, 2, "do", "nothing|out|manual|auto|cascade|sp|offset_on|offset_off|guard|drop",
      STEP_NOTHING,
      "what the row does; guard: its condition must hold from here on, drop: no longer"),
    ROW(3, PARAMETER_NAME, STEP_FIELD(what), "what", "", 0, 0, 0,
        "manipulated variable, loop or measurement that it acts on"),
    ROW(4, PARAMETER_FLOAT, STEP_FIELD(value), "value", "EU", -BIG, BIG, 0,
        "out: in the output's unit; sp: in the measurement's"),
    S(until, 5, "until", "at_once|above|below|steady|time|confirm", STEP_AT_ONCE,
      "condition to wait for"),
    ROW(6, PARAMETER_NAME, STEP_FIELD(measurement), "meas", "", 0, 0, 0,
        "measurement of the condition or guard"),
    ROW(7, PARAMETER_FLOAT, STEP_FIELD(limit), "limit", "EU", -BIG, BIG, 0,
        "above, below: limit; steady: width the measurement stays within"),
    ROW(8, PARAMETER_U16, STEP_FIELD(wait_s), "hold", "s", 0, 65535, 0,
        "the condition must hold this long; time: how long; guard: how long it may be broken"),
    ROW(9, PARAMETER_U16, STEP_FIELD(timeout_s), "timeout", "s", 0, 65535, 0,
        "longest wait; 0 = none, for time and confirm"),
    S(otherwise, 10, "else", "abort|go_on|hold", STEP_ABORT,
      "action of the time-out or of a guard"),
#undef S
#undef STEP
};

static const struct parameter_field restart_fields[] = {
    W(config, restart_policy, 1, "policy", "safe|hold|resume", RESTART_SAFE,
      "after a warm reset: safe state; outputs as they were, in manual; modes and setpoints as "
      "well"),
    F(config, restart_limit_s, 2, "limit", "s", 0, 3600, 60,
      "longest gap in plant time over the reset; after a longer one the safe state stays"),
};

OPTIONAL_FIELDS deviation_fields[] = {GUARD_ROWS(
    F(config, deviation.width, 1, "width", "fraction", 0, 1, 0.1f,
      "alarm of every loop that acts: its PV is further from the setpoint than this part of its "
      "span; "
      "0 = none. A loop with an alarm of side dev of its own has that instead"),
    F(config, deviation.delay_s, 2, "delay", "s", 0, 1e6f, 3600, "... for this long"))};

static const struct parameter_field console_fields[] = {
    ROW(1, PARAMETER_NAME, offsetof(struct config, console_key), "key", PARAMETER_SECRET, 0, 0, 0,
        "opens the engineer level of the console (use/console.md); - = always open"),
    F(config, relock_s, 2, "relock", "s", 0, 86400, 900,
      "the engineer level locks itself after this long without its commands; 0 = never"),
};

OPTIONAL_FIELDS test_fields[] = {START_UP_ROWS(
    F(config, test.noise_multiple, 1, "noise", "-", 2, 1000, 20,
      "a response this many times the noise is large enough"),
    F(config, test.blank_s, 2, "blank", "s", 0, 1e5f, 0,
      "the guard waits this long after a step, for inverse responses"),
    F(config, test.longest_s, 3, "longest", "s", 0, 1e6f, 0,
      "longest half of a double step; 0 = as long as responses ask, to 20000 ticks"),
    F(config, test.confidence, 4, "confidence", "-", 0.5f, 0.9999f, 0.975f,
      "a pairing less probable than this is not determined"),
    ROW(5, PARAMETER_U16, offsetof(struct config, test.rounds), "rounds", "-", 1, 16, 4,
        "most tests of each input until the pairing is determined"),
    ROW(6, PARAMETER_U16, offsetof(struct config, test.window), "window", "ticks", 10, 1000, 60,
        "base ticks over which rest is judged"),
    W(config, test.guard, 7, "guard", "line|model", TEST_GUARD_MODEL,
      "predicts the peak of a response by a straight line, or by a model of it so far"),
    W(config, test.pairs, 8, "pairs", "found|given", TEST_PAIRS_FOUND,
      "pairing: found by the tests, or given by pair<i>"),
    F(config, test.probe, 9, "probe", "-", 0, 2, 1.5f,
      "the trial raises each loop's gain by this factor on the way back, because so much must be "
      "left; 0 = off"))};

OPTIONAL_FIELDS pair_fields[] = {START_UP_ROWS(
    N(pair_config, measurement, 1, "meas", "measurement; - = unused"),
    N(pair_config, mv, 2, "mv", "manipulated variable"),
    F(pair_config, time_s, 3, "time", "s", 0, 1e6f, 0,
      "dead time and time constant together, as far as known; 0 = unknown"),
    F(pair_config, gain, 4, "gain", "EU/EU", -BIG, BIG, 0, "steady-state gain; 0 = unknown"))};

/* The words of `device`, `bus`, `type` and `kind` are stored by their place: new ones go to the end. */
OPTIONAL_FIELDS io_fields[] = {DEVICE_ROWS(
    W(config, pins.source, 1, "source", "link|board|both", IO_SOURCE_LINK,
      "where the plant is: at the other end of the link, at the board's own pins (chan, out), or "
      "some channels there and the others at the link"),
    W(config, pins.mains_60, 2, "mains", "50Hz|60Hz", 0,
      "frequency that inputs reject and outputs count"))};

OPTIONAL_FIELDS device_fields[] = {DEVICE_ROWS(
    N(device_config, name, 1, "name", "measurement that it gives; - = unused"),
    ROW(2, PARAMETER_UNIT, offsetof(struct device_config, unit), "unit", "", 0, 0, 0,
        "engineering unit of that"),
    W(device_config, device, 3, "device",
      "-|max31865|max31856|ds18b20|ads1115|bme280|bme280_temperature|xgzp6897|analog|flow|level|"
      "pulses",
      0, "what is at the pins"),
    W(device_config, bus, 4, "bus", "-|spi1|spi2|spi3|i2c1|i2c2|wire1|wire2", 0,
      "bus that it is on; - = none"),
    N(device_config, select, 5, "select",
      "its pin (PA4), address (0x48), or number on a wire (28000005e2fdc3)"),
    ROW(6, PARAMETER_U16, offsetof(struct device_config, input), "input", "", 0, 3, 0,
        "which input of a chip with several"),
    W(device_config, type, 7, "type", "-|2wire|3wire|4wire|B|E|J|K|N|R|S|T|4-20mA|0-10V|volt", 0,
      "of the sensor"),
    F(device_config, lo, 8, "lo", "EU", -BIG, BIG, 0, "value at the lower end of the signal"),
    F(device_config, hi, 9, "hi", "EU", -BIG, BIG, 100, "value at the upper end of the signal"),
    F(device_config, reference, 10, "reference", "ohm", 0, 1e6f, 0,
      "reference or shunt resistor, upper one of a divider; 0 = usual"),
    F(device_config, nominal, 11, "nominal", "ohm", 0, 1e6f, 0,
      "of the sensor at 0 degC; of a divider, its lower resistor; 0 = usual"))};

/* Place of each in the list: hal/pin.h and one more. */
#define PORT_PINS(p)                                                                               \
    "|P" p "0|P" p "1|P" p "2|P" p "3|P" p "4|P" p "5|P" p "6|P" p "7|P" p "8|P" p "9|P" p         \
    "10|P" p "11|P" p "12|P" p "13|P" p "14|P" p "15"
#define PINS_WORDS    "-" PORT_PINS("A") PORT_PINS("B") PORT_PINS("C") "|PD0|PD1|PD2"
#define CHANNEL_WORDS "-|chan1|chan2|chan3|chan4|chan5|chan6|chan7|chan8|chan9|chan10|chan11|chan12"
#define NUMBER(field, id, unit, types, lo, hi, initial, help)                                      \
    F(output_config, settings.field, 16 + (id), #field, unit, lo, hi, initial, help),

OPTIONAL_FIELDS output_fields[] = {DEVICE_ROWS(
    N(output_config, name, 1, "name", "manipulated variable that it is; - = unused"),
    ROW(2, PARAMETER_UNIT, offsetof(struct output_config, unit), "unit", "", 0, 0, 0,
        "engineering unit of that"),
    W(output_config, settings.type, 3, "kind",
      "-|window|burst|relay|pwm|analog|stepper|motor_valve|enable|ad5422", 0,
      "what is done with the pin"),
    W(output_config, settings.pin[0], 4, "pin", PINS_WORDS, 0,
      "its pin; motor valve: the one that opens; ad5422: its clear pin"),
    W(output_config, settings.pin[1], 5, "pin2", PINS_WORDS, 0,
      "stepper: direction; motor valve: the pin that closes; ad5422: its select"),
    W(output_config, settings.pin[2], 6, "end_open", PINS_WORDS, 0,
      "motor valve: contact that is closed when it is open"),
    W(output_config, settings.pin[3], 7, "end_closed", PINS_WORDS, 0,
      "motor valve: contact that is closed when it is closed"),
    F(output_config, lo, 8, "lo", "EU", -BIG, BIG, 0, "value at command 0"),
    F(output_config, hi, 9, "hi", "EU", -BIG, BIG, 100, "value at command 1"),
    W(output_config, settings.low, 10, "active", "high|low", 0,
      "level of the pin that switches it on"),
    W(output_config, settings.heater, 11, "heater", "off|on", 0,
      "off while the output of kind enable is off"),
    W(output_config, settings.reverse, 12, "reverse", "off|on", 0,
      "stepper: the direction pin is on"),
    W(output_config, settings.bus, 13, "bus", "-|spi1|spi2|spi3", 0, "bus of a chip"),
    W(output_config, settings.range, 14, "range", "4-20mA|0-20mA|0-24mA|0-5V|0-10V", 0,
      "of a chip"),
    W(output_config, settings.pin[4], 15, "zero_cross", PINS_WORDS, 0,
      "burst: falls when the mains cross 0"),
    W(output_config, proof.kind, 50, "proof", "-|warms|flows", PROOF_KIND_NONE,
      "how its channel shows that it acts: a heater warms, a pump or valve lets flow; - = not "
      "watched"),
    W(output_config, proof.device, 51, "proof_at", CHANNEL_WORDS, 0, "channel that shows it"),
    F(output_config, proof.change, 52, "proof_change", "EU", 0, BIG, 0,
      "warms: rise or fall that counts, many times the noise; flows: least flow that counts"),
    ROW(53, PARAMETER_U16, offsetof(struct output_config, proof.on_s), "proof_on", "s", 0, 65535, 0,
        "three quarters on, that much warmer within this time, or that much flow over it; 0 = not "
        "watched"),
    ROW(54, PARAMETER_U16, offsetof(struct output_config, proof.off_s), "proof_off", "s", 0, 65535,
        0,
        "off and hot, that much cooler within this time; off, no such flow over it; 0 = not "
        "watched"),
    ROW(55, PARAMETER_U16, offsetof(struct output_config, proof.limit), "proof_below", "EU", 0,
        65535, 0, "warms: temperature below its boiling points, above that of all that flows in"))
                                       DEVICE_NUMBER_ROWS(OUTPUT_NUMBERS(NUMBER))};

#define COUNT(a) (sizeof(a) / sizeof((a)[0]))
/* Group with an index. most: the count of the largest board, which is the default in the headers. */
#define GROUP(id, name, member, type, count, most, fields)                                         \
    {                                                                                              \
        id, count, COUNT(fields), true, offsetof(struct config, member), sizeof(type), name,       \
            fields, most                                                                           \
    }

const struct parameter_group parameter_groups[] = {
    {1, 1, COUNT(tick_fields), false, 0, 0, "tick", tick_fields, 1},
    {8, 1, COUNT(config_fields), false, 0, 0, "config", config_fields, 1},
    GROUP(2, "meas", measurement, struct measurement_config, CHANNEL_MAX, 16, measurement_fields),
    GROUP(3, "mv", mv, struct mv_config, CHANNEL_MAX, 16, mv_fields),
    GROUP(4, "loop", loop, struct loop_config, CONFIG_LOOPS, 16, loop_fields),
    {5, DECOUPLER_MAX, DECOUPLER_MAX, true, offsetof(struct config, decoupler),
     DECOUPLER_MAX * sizeof(float), "decouple", decoupler_fields, 8},
    GROUP(6, "ff", feedforward, struct ff_config, CONFIG_FEEDFORWARDS, 4, feedforward_fields),
    GROUP(7, "lock", interlock, struct interlock_config, CONFIG_INTERLOCKS, 8, interlock_fields),
    {9, 1, COUNT(console_fields), false, 0, 0, "console", console_fields, 1},
    GROUP(10, "alarm", alarm, struct alarm_config, CONFIG_ALARMS, 8, alarm_fields),
    {11, 1, COUNT(restart_fields), false, 0, 0, "restart", restart_fields, 1},
    GUARD_ROWS({13, 1, COUNT(deviation_fields), false, 0, 0, "deviation", deviation_fields, 1})
        START_UP_ROWS({14, 1, COUNT(test_fields), false, 0, 0, "test", test_fields, 1},
                      GROUP(15, "pair", pair, struct pair_config, CONFIG_PAIRS, 4, pair_fields))
    /* A board without sequences has the names only, so that it refuses them with ERR_UNSUPPORTED. */
    GROUP(12, "step", step, struct step_config, CONFIG_STEPS, 32, step_fields),
    DEVICE_ROWS(
        {17, 1, COUNT(io_fields), false, 0, 0, "io", io_fields, 1},
        GROUP(18, "chan", pins.device, struct device_config, CONFIG_DEVICES, 16, device_fields),
        GROUP(19, "out", pins.output, struct output_config, CONFIG_OUTPUTS, 8, output_fields))};
const unsigned parameter_group_count = COUNT(parameter_groups);

#define B(member, id, type, name, help)                                                            \
    ROW(id, type, offsetof(struct block_config, member), name, "", 0, 0, 0, help)
static const struct parameter_field block_fields[BLOCK_FIELDS] = {
    B(kind, 1 + BLOCK_FIELD_KIND, PARAMETER_KIND, "kind",
      "kind of the block, which has parameters of its own; - = unused"),
    B(loops, 1 + BLOCK_FIELD_LOOPS, PARAMETER_LIST, "loops", "loops that it serves"),
    B(inputs, 1 + BLOCK_FIELD_INPUTS, PARAMETER_LIST, "inputs", "further points that it reads"),
    B(points, 1 + BLOCK_FIELD_POINTS, PARAMETER_LIST, "points",
      "points that it writes, or MVs it adds to"),
};

const struct parameter_group parameter_blocks =
    GROUP(16, "block", block, struct block_config, CONFIG_BLOCKS, 4, block_fields);

/* Types of the rows of kinds, in the order of enum block_value, then of tables. The row of the kind has all else. */
const struct parameter_field parameter_own_fields[] = {
    ROW(0, PARAMETER_FLOAT, 0, "", "", 0, 0, 0, ""),
    ROW(0, PARAMETER_U16, 0, "", "", 0, 0, 0, ""),
    ROW(0, PARAMETER_WORD, 0, "", "", 0, 0, 0, ""),
    ROW(0, PARAMETER_ROW, 0, "", "", 0, 0, 0, ""),
};
