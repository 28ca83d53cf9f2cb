/* Every event: name, text, level, unit of its value. The order gives the codes. The history in retained memory keeps them for as long as
 * the firmware is the same. The macros say which boards have an event. Where a board's limits leave out the cause of an event, the event
 * keeps its code but has no name; events of blocks, and of devices at the board's pins, then have no code either.
 *
 * The text says what the value of the event means. Its unit is that of the loop's PV (OF_LOOP), of the measurement (OF_MEASUREMENT), of
 * the manipulated variable or of what the loop drives (OF_OUTPUT), or of what the alarm or the interlock watches. PLAIN: the value has no
 * unit, or the text has it. The subject names the loop, the channel or the alarm; of an interlock it names the output.
 *
 * Actions are requests from the console: the history keeps them, and the console does not announce them. */
#ifndef REFLUX_BASE_EVENT_LIST_H
#define REFLUX_BASE_EVENT_LIST_H

#define EVENT_LIST(ALWAYS, SEQUENCE, START_UP, GUARD, JOB, BLOCK, CHECK, PINS)                     \
    ALWAYS(STARTED, "firmware started in its safe state; cause", INFO, PLAIN)                      \
    ALWAYS(LINK_UP, "plant connected", INFO, PLAIN)                                                \
    ALWAYS(LINK_DOWN, "plant silent, s", ALARM, PLAIN)                                             \
    ALWAYS(LINK_VERSION, "plant speaks another protocol version", ALARM, PLAIN)                    \
    ALWAYS(CHANNEL_MISSING, "configured channel not announced by the plant", WARNING, PLAIN)       \
    ALWAYS(CHANNEL_UNIT, "plant announces another unit than configured", WARNING, PLAIN)           \
    ALWAYS(SAFE_STATE, "all loops manual, outputs at safe values", ALARM, PLAIN)                   \
    ALWAYS(CONFIG_APPLIED, "configuration applied; base tick, s", INFO, PLAIN)                     \
    ALWAYS(CONFIG_REFUSED, "configuration does not fit the plant's base tick", ALARM, PLAIN)       \
    ALWAYS(MODE, "loop is in", INFO, PLAIN)                                                        \
    ALWAYS(MODE_REFUSED, "loop stays in manual: measurement or plant not usable", WARNING, PLAIN)  \
    ALWAYS(SETPOINT, "new setpoint", INFO, OF_LOOP)                                                \
    ALWAYS(OUTPUT, "new manual output", INFO, OF_OUTPUT)                                           \
    ALWAYS(REQUEST_REFUSED, "request came too late for the mode in force", WARNING, PLAIN)         \
    ALWAYS(SAMPLE_TWICE, "sample repeated or out of order, number", WARNING, PLAIN)                \
    ALWAYS(SAMPLE_EARLY, "sample before the base tick was over, s early", WARNING, PLAIN)          \
    ALWAYS(SAMPLE_LATE, "sample after its time, s late", WARNING, PLAIN)                           \
    ALWAYS(SAMPLE_MISSING, "samples missing", WARNING, PLAIN)                                      \
    ALWAYS(MEASUREMENT_BAD, "measurement not usable, last value held", ALARM, OF_MEASUREMENT)      \
    ALWAYS(MEASUREMENT_GOOD, "measurement usable again", INFO, OF_MEASUREMENT)                     \
    ALWAYS(INTERLOCK_ON, "interlock holds its output; measurement", ALARM, OF_INTERLOCK)           \
    ALWAYS(INTERLOCK_OFF, "interlock released; measurement", INFO, OF_INTERLOCK)                   \
    ALWAYS(NOT_FOLLOWING, "output does not follow its command; read-back", WARNING, OF_OUTPUT)     \
    ALWAYS(FOLLOWING, "output follows its command again; read-back", INFO, OF_OUTPUT)              \
    ALWAYS(TELEMETRY_LOST, "telemetry rows lost, the console is too slow", WARNING, PLAIN)         \
    ALWAYS(ALARM_ON, "alarm limit passed; measurement, or distance from the setpoint", ALARM,      \
           OF_ALARM)                                                                               \
    ALWAYS(ALARM_OFF, "alarm condition is over; measurement, or distance from the setpoint", INFO, \
           OF_ALARM)                                                                               \
    ALWAYS(ALARM_ACK, "alarm acknowledged", INFO, PLAIN)                                           \
    ALWAYS(ALARM_SHELVED, "alarm silent for, s; 0: no longer", INFO, PLAIN)                        \
    ALWAYS(SAMPLE_OVERDUE, "plant connected but sends no sample, s", ALARM, PLAIN)                 \
    ALWAYS(SAMPLE_STALLED,                                                                         \
           "samples come, plant time stands still or was set back; without a tick for, s", ALARM,  \
           PLAIN)                                                                                  \
    ALWAYS(RESTART_DONE, "outputs as before the reset (1), modes and setpoints as well (2)",       \
           WARNING, PLAIN)                                                                         \
    ALWAYS(RESTART_REFUSED, "the safe state stays after this reset", WARNING, PLAIN)               \
    ALWAYS(WRONG_KEY, "wrong keys at the console since then; count", WARNING, PLAIN)               \
    ALWAYS(PLANT_REFUSED, "plant refused", ALARM, PLAIN)                                           \
    ALWAYS(                                                                                        \
        SAMPLE_REFUSED,                                                                            \
        "sample of another shape than announced, or with an unknown quality; measurements in it",  \
        WARNING, PLAIN)                                                                            \
    ALWAYS(STORAGE_LOADED, "stored settings are being applied; set", INFO, PLAIN)                  \
    ALWAYS(STORAGE_OLDER, "a newer stored set is not whole, an older one is used; set", WARNING,   \
           PLAIN)                                                                                  \
    ALWAYS(STORAGE_CLIPPED, "stored value replaced: not allowed, or of another type; new value",   \
           WARNING, PLAIN)                                                                         \
    ALWAYS(STORAGE_REFUSED, "stored settings are not in force; `load` says why", ALARM, PLAIN)     \
    ALWAYS(STORAGE_DAMAGED, "no whole set is stored, defaults are in force", ALARM, PLAIN)         \
    ALWAYS(STORAGE_LEFT_OUT,                                                                       \
           "stored settings left out: resets in a row, each soon after its start", ALARM, PLAIN)   \
    ALWAYS(STORAGE_NEWER, "settings of newer firmware are stored: nothing is written; format",     \
           ALARM, PLAIN)                                                                           \
    ALWAYS(BLOCK_UNKNOWN, "kind that this build lacks, or no room for it: kept, not run; block",   \
           ALARM, PLAIN)                                                                           \
    ALWAYS(IMAGE_DAMAGED,                                                                          \
           "firmware is not the one that was built: nothing acts, outputs stay safe", ALARM,       \
           PLAIN)                                                                                  \
    SEQUENCE(SEQUENCE_STEP, "sequence waits at step", INFO, PLAIN)                                 \
    SEQUENCE(SEQUENCE_HELD, "sequence held at step", WARNING, PLAIN)                               \
    SEQUENCE(SEQUENCE_GOES_ON, "sequence goes on at step", INFO, PLAIN)                            \
    SEQUENCE(SEQUENCE_CONFIRMED, "step confirmed", INFO, PLAIN)                                    \
    SEQUENCE(SEQUENCE_SKIPPED, "wait of the step skipped", WARNING, PLAIN)                         \
    SEQUENCE(SEQUENCE_TIMEOUT, "step took longer than allowed", WARNING, PLAIN)                    \
    SEQUENCE(SEQUENCE_DONE, "sequence done, last step", INFO, PLAIN)                               \
    SEQUENCE(SEQUENCE_ABORTED, "sequence aborted into the safe state at step", ALARM, PLAIN)       \
    SEQUENCE(OFFSET, "subtracted from the readings from now on", INFO, OF_MEASUREMENT)             \
    START_UP(COMMISSION_BEGUN, "automatic start-up has begun; inputs to test", INFO, PLAIN)        \
    START_UP(COMMISSION_ENDED, "automatic start-up given up", ALARM, PLAIN)                        \
    START_UP(TEST_STEP, "test of this input; amplitude, fraction of span", INFO, PLAIN)            \
    START_UP(TEST_CUT,                                                                             \
             "test cut short, this would pass its limit; predicted peak, fraction of span", INFO,  \
             PLAIN)                                                                                \
    START_UP(TEST_DONE, "input tested; length of half a double step, s", INFO, PLAIN)              \
    START_UP(TEST_LONGER,                                                                          \
             "an output did not come to rest, test repeated; half of a double step, s", INFO,      \
             PLAIN)                                                                                \
    START_UP(TEST_SMALLER,                                                                         \
             "step too large, test repeated with a smaller one; amplitude, fraction of span",      \
             INFO, PLAIN)                                                                          \
    START_UP(TEST_EXTENDED, "not sure enough yet, tests are repeated; probability", INFO, PLAIN)   \
    START_UP(RELAY_DONE, "relay test done, see `commission relay`; ultimate period, s", INFO,      \
             PLAIN)                                                                                \
    START_UP(PROPOSAL, "pairing determined, see `commission proposal`; probability", INFO, PLAIN)  \
    START_UP(NOT_DETERMINED, "no proposal, see `commission pairing`; probability", WARNING, PLAIN) \
    START_UP(TRIAL_BEGUN, "proposed loops on trial; loops", INFO, PLAIN)                           \
    START_UP(                                                                                      \
        TRIAL_KEPT,                                                                                \
        "proposed loops matched the prediction and stay, `commission watch` watches them for "     \
        "a day; loops",                                                                            \
        INFO, PLAIN)                                                                               \
    START_UP(TRIAL_FAILED, "trial failed, the old settings return", ALARM, PLAIN)                  \
    JOB(JOB_LATE, "job not done at its tick; ticks it was given", WARNING, PLAIN)                  \
    START_UP(BLOCK_GAVE_UP, "a block gave up, its loops go on without it; block", ALARM, PLAIN)    \
    START_UP(BLOCK_ON, "a block acts for its loops again; block", INFO, PLAIN)                     \
    BLOCK(CHANNEL_WRITTEN,                                                                         \
          "a block writes this measurement, the plant's readings are ignored; block", WARNING,     \
          PLAIN)                                                                                   \
    BLOCK(LOOP_DIVISOR,                                                                            \
          "divisor is no multiple of the ticks between samples of its measurement; ticks",         \
          WARNING, PLAIN)                                                                          \
    BLOCK(BLOCK_VERB, "verb done; the number given with it", INFO, PLAIN)                          \
    BLOCK(BLOCK_REFUSED, "a block refused its verb; block", WARNING, PLAIN)                        \
    BLOCK(BLOCK_EVENT, "a block says", INFO, PLAIN)                                                \
    BLOCK(BLOCK_ALARM, "a block says", ALARM, PLAIN)                                               \
    BLOCK(EXCITATION_BEGUN, "a block excites the plant with a test signal; block", INFO, PLAIN)    \
    BLOCK(EXCITATION_ENDED, "the test signal of a block is over; block", INFO, PLAIN)              \
    BLOCK(BLOCK_PROPOSES, "a block proposes settings, see `proposal`; block", INFO, PLAIN)         \
    BLOCK(BLOCK_ADOPTED, "settings that a block proposes are being applied; block", INFO, PLAIN)   \
    BLOCK(PROPOSAL_REFUSED, "proposal of a block refused, see `proposal`; value", WARNING, PLAIN)  \
    GUARD(DEVIATION, "the PV has been far from its setpoint for long; distance", ALARM, OF_LOOP)   \
    GUARD(DEVIATION_OVER, "the PV is near its setpoint again, or the loop in manual; distance",    \
          INFO, OF_LOOP)                                                                           \
    GUARD(DOUBTFUL, "a loop acts on a reading that has long been uncertain; reading", ALARM,       \
          OF_MEASUREMENT)                                                                          \
    GUARD(DOUBTFUL_OVER, "no loop acts on an uncertain reading any more; reading", INFO,           \
          OF_MEASUREMENT)                                                                          \
    START_UP(FIRST_READING, "the first reading was far from the next ones; reading", WARNING,      \
             OF_MEASUREMENT)                                                                       \
    START_UP(SAME_READING, "sends the same numbers as another measurement, meas", WARNING, PLAIN)  \
    ALWAYS(DO_MODE, "mode requested:", ACTION, PLAIN)                                              \
    ALWAYS(DO_SETPOINT, "setpoint requested", ACTION, OF_LOOP)                                     \
    ALWAYS(DO_OUTPUT, "output requested", ACTION, OF_OUTPUT)                                       \
    ALWAYS(DO_SET, "parameter set; 0 for a word", ACTION, PLAIN)                                   \
    ALWAYS(DO_APPLY, "transaction applied; parameters it changes", ACTION, PLAIN)                  \
    ALWAYS(DO_STORAGE, "stored settings saved, loaded or replaced", ACTION, PLAIN)                 \
    ALWAYS(DO_ALARM, "alarm acknowledged or shelved", ACTION, PLAIN)                               \
    SEQUENCE(DO_SEQUENCE, "sequence started, stopped or commanded", ACTION, PLAIN)                 \
    ALWAYS(DO_KEY, "key changed", ACTION, PLAIN)                                                   \
    ALWAYS(DO_UNLOCK, "engineer level unlocked", ACTION, PLAIN)                                    \
    ALWAYS(DO_LOCK, "engineer level locked", ACTION, PLAIN)                                        \
    START_UP(DO_COMMISSION, "automatic start-up commanded", ACTION, PLAIN)                         \
    ALWAYS(DO_REBOOT, "restart requested", ACTION, PLAIN)                                          \
    BLOCK(DO_BLOCK, "block switched, or given a verb; its number", ACTION, PLAIN)                  \
    BLOCK(DO_PROPOSAL, "proposal of a block accepted, rejected or taken back; its values", ACTION, \
          PLAIN)                                                                                   \
    BLOCK(SWITCHED_OFF, "adds nothing until its settings change; block that switched it off",      \
          WARNING, PLAIN)                                                                          \
    BLOCK(PROPOSAL_WITHDRAWN, "a block withdraws its proposal; block", INFO, PLAIN)                \
    START_UP(WATCH_BEGUN, "the kept loops are watched; hours", INFO, PLAIN)                        \
    START_UP(WATCH_LOOP, "watched, see `commission watched`; largest error", INFO, OF_LOOP)        \
    START_UP(WATCH_ENDED, "the watch of the kept loops is over; hours", INFO, PLAIN)               \
    START_UP(WATCH_FAILED, "a kept loop went wrong, the old settings return", ALARM, PLAIN)        \
    START_UP(WATCH_SIGN,                                                                           \
             "a kept loop went wrong, its settings stay: put it into manual, or lower its gain",   \
             ALARM, PLAIN)                                                                         \
    START_UP(SENSOR_POOR,                                                                          \
             "sensor hides responses, see `commission advice`; share of its span, or ticks",       \
             WARNING, PLAIN)                                                                       \
    CHECK(RAM_FAILED, "the RAM failed its test at power-on: nothing acts, outputs stay safe",      \
          ALARM, PLAIN)                                                                            \
    BLOCK(MANUAL_BY_BOARD, "the board has put this loop into manual", ALARM, PLAIN)                \
    BLOCK(MANUAL_BY_BOARD_OVER, "somebody has set the mode of this loop", INFO, PLAIN)             \
    PINS(SENSOR_FAULT, "sensor at the board's pins has a fault", ALARM, PLAIN)                     \
    PINS(SENSOR_FINE, "sensor at the board's pins has no fault any more", INFO, PLAIN)             \
    PINS(VALVE_FAULT, "end contact of a motor valve not closed in time (1), or both closed (2)",   \
         ALARM, PLAIN)                                                                             \
    PINS(OUTPUT_FAULT, "output at the board's pins has a fault", ALARM, PLAIN)                     \
    PINS(OUTPUT_FINE, "output at the board's pins has no fault any more; mains, Hz", INFO, PLAIN)  \
    PINS(OUTPUT_CONTRADICTED,                                                                      \
         "output at the board's pins does not act as told; its channel reads", ALARM, PLAIN)       \
    PINS(OUTPUT_ACTS, "output at the board's pins acts as told again; its channel reads", INFO,    \
         PLAIN)

/* A board without automatic start-up has no blocks either (CONFIG_BLOCKS), and no MANUAL_BY_BOARD. */
#if defined(COMMISSION_CHANNELS) && COMMISSION_CHANNELS == 0
#define EVENT_OF_START_UP EVENT_ABSENT
#define EVENT_OF_BLOCK    EVENT_NO_ROW
#else
#define EVENT_OF_START_UP EVENT_ROW
#define EVENT_OF_BLOCK    EVENT_ROW
#endif
#if defined(CONFIG_STEPS) && CONFIG_STEPS == 0
#define EVENT_OF_SEQUENCE EVENT_ABSENT
#else
#define EVENT_OF_SEQUENCE EVENT_ROW
#endif
#if defined(CONFIG_LOOP_GUARD) && CONFIG_LOOP_GUARD == 0
#define EVENT_OF_GUARD EVENT_ABSENT
#else
#define EVENT_OF_GUARD EVENT_ROW
#endif
#if defined(JOBS_MAX) && JOBS_MAX == 0
#define EVENT_OF_JOB EVENT_ABSENT
#else
#define EVENT_OF_JOB EVENT_ROW
#endif
/* hal/self_check.h */
#if defined(BOARD_CHECKS) && BOARD_CHECKS == 0
#define EVENT_OF_CHECK EVENT_NO_ROW
#else
#define EVENT_OF_CHECK EVENT_ROW
#endif
/* exchange/pins.h */
#if defined(CONFIG_DEVICES) && CONFIG_DEVICES == 0
#define EVENT_OF_PINS EVENT_NO_ROW
#else
#define EVENT_OF_PINS EVENT_ROW
#endif

#endif
