/* Every event: name, text, level. The order gives the codes. The history in retained memory keeps them for as long as the firmware
 * is the same. The macros say which boards have an event. Where a board's limits leave out the cause of an event, the event keeps
 * its code but has no name; events of blocks then have no code either.
 *
 * The text says what the value of the event means. Actions are requests from the console: the history keeps them, and the console
 * does not announce them. */
#ifndef REFLUX_BASE_EVENT_LIST_H
#define REFLUX_BASE_EVENT_LIST_H

#define EVENT_LIST(ALWAYS, SEQUENCE, START_UP, GUARD, JOB, BLOCK)                                  \
    ALWAYS(STARTED, "firmware started in its safe state; cause", INFO)                             \
    ALWAYS(LINK_UP, "plant connected", INFO)                                                       \
    ALWAYS(LINK_DOWN, "plant silent, s", ALARM)                                                    \
    ALWAYS(LINK_VERSION, "plant speaks another protocol version", ALARM)                           \
    ALWAYS(CHANNEL_MISSING, "configured channel not announced by the plant", WARNING)              \
    ALWAYS(CHANNEL_UNIT, "plant announces another unit than configured", WARNING)                  \
    ALWAYS(SAFE_STATE, "all loops manual, outputs at safe values", ALARM)                          \
    ALWAYS(CONFIG_APPLIED, "configuration applied; base tick, s", INFO)                            \
    ALWAYS(CONFIG_REFUSED, "configuration does not fit the plant's base tick", ALARM)              \
    ALWAYS(MODE, "loop is in", INFO)                                                               \
    ALWAYS(MODE_REFUSED, "loop stays in manual: measurement or plant not usable", WARNING)         \
    ALWAYS(SETPOINT, "new setpoint", INFO)                                                         \
    ALWAYS(OUTPUT, "new manual output", INFO)                                                      \
    ALWAYS(REQUEST_REFUSED, "request came too late for the mode in force", WARNING)                \
    ALWAYS(SAMPLE_TWICE, "sample repeated or out of order, number", WARNING)                       \
    ALWAYS(SAMPLE_EARLY, "sample before the base tick was over, s early", WARNING)                 \
    ALWAYS(SAMPLE_LATE, "sample after its time, s late", WARNING)                                  \
    ALWAYS(SAMPLE_MISSING, "samples missing", WARNING)                                             \
    ALWAYS(MEASUREMENT_BAD, "measurement not usable, last value held", ALARM)                      \
    ALWAYS(MEASUREMENT_GOOD, "measurement usable again", INFO)                                     \
    ALWAYS(INTERLOCK_ON, "interlock holds its output; measurement", ALARM)                         \
    ALWAYS(INTERLOCK_OFF, "interlock released; measurement", INFO)                                 \
    ALWAYS(NOT_FOLLOWING, "output does not follow its command; read-back", WARNING)                \
    ALWAYS(FOLLOWING, "output follows its command again; read-back", INFO)                         \
    ALWAYS(TELEMETRY_LOST, "telemetry rows lost, the console is too slow", WARNING)                \
    ALWAYS(ALARM_ON, "alarm limit passed; measurement, or distance from the setpoint", ALARM)      \
    ALWAYS(ALARM_OFF, "alarm condition is over; measurement, or distance from the setpoint", INFO) \
    ALWAYS(ALARM_ACK, "alarm acknowledged", INFO)                                                  \
    ALWAYS(ALARM_SHELVED, "alarm silent for, s; 0: no longer", INFO)                               \
    ALWAYS(SAMPLE_OVERDUE, "plant connected but sends no sample, s", ALARM)                        \
    ALWAYS(SAMPLE_STALLED,                                                                         \
           "samples come, plant time stands still or was set back; without a tick for, s", ALARM)  \
    ALWAYS(RESTART_DONE, "outputs as before the reset (1), modes and setpoints as well (2)",       \
           WARNING)                                                                                \
    ALWAYS(RESTART_REFUSED, "the safe state stays after this reset", WARNING)                      \
    ALWAYS(WRONG_KEY, "wrong keys at the console since then; count", WARNING)                      \
    ALWAYS(PLANT_REFUSED, "plant refused", ALARM)                                                  \
    ALWAYS(                                                                                        \
        SAMPLE_REFUSED,                                                                            \
        "sample of another shape than announced, or with an unknown quality; measurements in it",  \
        WARNING)                                                                                   \
    ALWAYS(STORAGE_LOADED, "stored settings are being applied; set", INFO)                         \
    ALWAYS(STORAGE_OLDER, "a newer stored set is not whole, an older one is used; set", WARNING)   \
    ALWAYS(STORAGE_CLIPPED, "stored value replaced: not allowed, or of another type; new value",   \
           WARNING)                                                                                \
    ALWAYS(STORAGE_REFUSED, "stored settings are not in force; `load` says why", ALARM)            \
    ALWAYS(STORAGE_DAMAGED, "no whole set is stored, defaults are in force", ALARM)                \
    ALWAYS(STORAGE_LEFT_OUT,                                                                       \
           "stored settings left out: resets in a row, each soon after its start", ALARM)          \
    ALWAYS(STORAGE_NEWER, "settings of newer firmware are stored: nothing is written; format",     \
           ALARM)                                                                                  \
    ALWAYS(BLOCK_UNKNOWN, "kind that this build lacks, or no room for it: kept, not run; block",   \
           ALARM)                                                                                  \
    ALWAYS(IMAGE_DAMAGED,                                                                          \
           "firmware is not the one that was built: nothing acts, outputs stay safe", ALARM)       \
    SEQUENCE(SEQUENCE_STEP, "sequence waits at step", INFO)                                        \
    SEQUENCE(SEQUENCE_HELD, "sequence held at step", WARNING)                                      \
    SEQUENCE(SEQUENCE_GOES_ON, "sequence goes on at step", INFO)                                   \
    SEQUENCE(SEQUENCE_CONFIRMED, "step confirmed", INFO)                                           \
    SEQUENCE(SEQUENCE_SKIPPED, "wait of the step skipped", WARNING)                                \
    SEQUENCE(SEQUENCE_TIMEOUT, "step took longer than allowed", WARNING)                           \
    SEQUENCE(SEQUENCE_DONE, "sequence done, last step", INFO)                                      \
    SEQUENCE(SEQUENCE_ABORTED, "sequence aborted into the safe state at step", ALARM)              \
    SEQUENCE(OFFSET, "subtracted from the readings from now on", INFO)                             \
    START_UP(COMMISSION_BEGUN, "automatic start-up has begun; inputs to test", INFO)               \
    START_UP(COMMISSION_ENDED, "automatic start-up given up", ALARM)                               \
    START_UP(TEST_STEP, "test of this input; amplitude, fraction of span", INFO)                   \
    START_UP(TEST_CUT,                                                                             \
             "test cut short, this would pass its limit; predicted peak, fraction of span", INFO)  \
    START_UP(TEST_DONE, "input tested; length of half a double step, s", INFO)                     \
    START_UP(TEST_LONGER,                                                                          \
             "an output did not come to rest, test repeated; half of a double step, s", INFO)      \
    START_UP(TEST_SMALLER,                                                                         \
             "step too large, test repeated with a smaller one; amplitude, fraction of span",      \
             INFO)                                                                                 \
    START_UP(TEST_EXTENDED, "pairing not determined yet, tests are repeated; probability", INFO)   \
    START_UP(RELAY_DONE, "relay test done, see `commission relay`; ultimate period, s", INFO)      \
    START_UP(PROPOSAL, "pairing determined, see `commission proposal`; probability", INFO)         \
    START_UP(NOT_DETERMINED, "no proposal, see `commission pairing`; probability", WARNING)        \
    START_UP(TRIAL_BEGUN, "proposed loops on trial; loops", INFO)                                  \
    START_UP(                                                                                      \
        TRIAL_KEPT,                                                                                \
        "proposed loops matched the prediction and stay, `commission watch` watches them for "     \
        "a day; loops",                                                                            \
        INFO)                                                                                      \
    START_UP(TRIAL_FAILED, "trial failed, the old settings return", ALARM)                         \
    JOB(JOB_LATE, "job not done at its tick; ticks it was given", WARNING)                         \
    START_UP(BLOCK_GAVE_UP, "a block gave up, its loops go on without it; block", ALARM)           \
    START_UP(BLOCK_ON, "a block acts for its loops again; block", INFO)                            \
    BLOCK(CHANNEL_WRITTEN,                                                                         \
          "a block writes this measurement, the plant's readings are ignored; block", WARNING)     \
    BLOCK(LOOP_DIVISOR,                                                                            \
          "divisor is no multiple of the ticks between samples of its measurement; ticks",         \
          WARNING)                                                                                 \
    BLOCK(BLOCK_VERB, "verb done; the number given with it", INFO)                                 \
    BLOCK(BLOCK_REFUSED, "a block refused its verb; block", WARNING)                               \
    BLOCK(BLOCK_EVENT, "a block says", INFO)                                                       \
    BLOCK(BLOCK_ALARM, "a block says", ALARM)                                                      \
    BLOCK(EXCITATION_BEGUN, "a block excites the plant with a test signal; block", INFO)           \
    BLOCK(EXCITATION_ENDED, "the test signal of a block is over; block", INFO)                     \
    BLOCK(BLOCK_PROPOSES, "a block proposes settings, see `proposal`; block", INFO)                \
    BLOCK(BLOCK_ADOPTED, "settings that a block proposes are being applied; block", INFO)          \
    BLOCK(PROPOSAL_REFUSED, "proposal of a block refused, see `proposal`; value", WARNING)         \
    GUARD(DEVIATION, "the PV has been far from its setpoint for long; distance", ALARM)            \
    GUARD(DEVIATION_OVER, "the PV is near its setpoint again, or the loop in manual; distance",    \
          INFO)                                                                                    \
    GUARD(DOUBTFUL, "a loop acts on a reading that has long been uncertain; reading", ALARM)       \
    GUARD(DOUBTFUL_OVER, "no loop acts on an uncertain reading any more; reading", INFO)           \
    START_UP(FIRST_READING, "the first reading was far from the next ones; reading", WARNING)      \
    START_UP(SAME_READING, "sends the same numbers as another measurement, meas", WARNING)         \
    ALWAYS(DO_MODE, "mode requested:", ACTION)                                                     \
    ALWAYS(DO_SETPOINT, "setpoint requested", ACTION)                                              \
    ALWAYS(DO_OUTPUT, "output requested", ACTION)                                                  \
    ALWAYS(DO_SET, "parameter set; 0 for a word", ACTION)                                          \
    ALWAYS(DO_APPLY, "transaction applied; parameters it changes", ACTION)                         \
    ALWAYS(DO_STORAGE, "stored settings saved, loaded or replaced", ACTION)                        \
    ALWAYS(DO_ALARM, "alarm acknowledged or shelved", ACTION)                                      \
    SEQUENCE(DO_SEQUENCE, "sequence started, stopped or commanded", ACTION)                        \
    ALWAYS(DO_KEY, "key changed", ACTION)                                                          \
    ALWAYS(DO_UNLOCK, "engineer level unlocked", ACTION)                                           \
    ALWAYS(DO_LOCK, "engineer level locked", ACTION)                                               \
    START_UP(DO_COMMISSION, "automatic start-up commanded", ACTION)                                \
    ALWAYS(DO_REBOOT, "restart requested", ACTION)                                                 \
    BLOCK(DO_BLOCK, "block switched, or given a verb; its number", ACTION)                         \
    BLOCK(DO_PROPOSAL, "proposal of a block accepted, rejected or taken back; its values", ACTION) \
    BLOCK(SWITCHED_OFF, "adds nothing until its settings change; block that switched it off",      \
          WARNING)                                                                                 \
    BLOCK(PROPOSAL_WITHDRAWN, "a block withdraws its proposal; block", INFO)                       \
    START_UP(WATCH_BEGUN, "the kept loops are watched; hours", INFO)                               \
    START_UP(WATCH_LOOP, "watched, see `commission watched`; largest error", INFO)                 \
    START_UP(WATCH_ENDED, "the watch of the kept loops is over; hours", INFO)                      \
    START_UP(WATCH_FAILED, "a kept loop went wrong, the old settings return", ALARM)               \
    START_UP(WATCH_SIGN,                                                                           \
             "a kept loop went wrong, its settings stay: put it into manual, or lower its gain",   \
             ALARM)                                                                                \
    START_UP(SENSOR_POOR,                                                                          \
             "sensor hides responses, see `commission advice`; share of its span, or ticks",       \
             WARNING)

/* A board without automatic start-up has no blocks either (CONFIG_BLOCKS). */
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

#endif
