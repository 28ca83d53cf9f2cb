#include "base/event.h"

#include <string.h>

/* Level, name, zero, text: one pointer for each event. */
#define INFO    "\0"
#define WARNING "\1"
#define ALARM   "\2"
#define ACTION  "\3"
_Static_assert(EVENT_INFO == 0 && EVENT_WARNING == 1 && EVENT_ALARM == 2 && EVENT_ACTION == 3,
               "levels are as above");
#define E(name, text, level) level name "\0" text
/* What the limits of a board leave out (they are read before every file) does not happen there. */
#define ABSENT INFO "?\0?"
#if defined(CONFIG_STEPS) && CONFIG_STEPS == 0
#define S(name, text, level) ABSENT
#else
#define S E
#endif
#if defined(COMMISSION_CHANNELS) && COMMISSION_CHANNELS == 0
#define C(name, text, level) ABSENT
#else
#define C E
#endif
#if defined(CONFIG_LOOP_GUARD) && CONFIG_LOOP_GUARD == 0
#define G(name, text, level) ABSENT
#else
#define G E
#endif
#if defined(JOBS_MAX) && JOBS_MAX == 0
#define J(name, text, level) ABSENT
#else
#define J E
#endif

static const char *const table[] = {
    E("STARTED", "firmware started in its safe state; why it started", INFO),
    E("LINK_UP", "plant connected", INFO),
    E("LINK_DOWN", "plant silent, s", ALARM),
    E("LINK_VERSION", "plant speaks another protocol version", ALARM),
    E("CHANNEL_MISSING", "configured channel not announced by the plant", WARNING),
    E("CHANNEL_UNIT", "plant announces another unit than configured", WARNING),
    E("SAFE_STATE", "all loops manual, outputs at safe values", ALARM),
    E("CONFIG_APPLIED", "configuration in force; base tick, s", INFO),
    E("CONFIG_REFUSED", "configuration does not fit the plant's base tick", ALARM),
    E("MODE", "loop mode is now (0 manual, 1 auto, 2 cascade)", INFO),
    E("MODE_REFUSED", "loop stays in manual: measurement or plant not usable", WARNING),
    E("SETPOINT", "setpoint is now", INFO),
    E("OUTPUT", "manual output is now", INFO),
    E("REQUEST_REFUSED", "request came too late for the mode in force", WARNING),
    E("SAMPLE_TWICE", "sample repeated or out of order, number", WARNING),
    E("SAMPLE_EARLY", "sample before the base tick was over, s early", WARNING),
    E("SAMPLE_LATE", "sample after its time, s late", WARNING),
    E("SAMPLE_MISSING", "samples missing", WARNING),
    E("MEASUREMENT_BAD", "measurement not usable, last value held", ALARM),
    E("MEASUREMENT_GOOD", "measurement usable again", INFO),
    E("INTERLOCK_ON", "interlock holds its output; measurement", ALARM),
    E("INTERLOCK_OFF", "interlock released; measurement", INFO),
    E("NOT_FOLLOWING", "output does not follow its command; read-back", WARNING),
    E("FOLLOWING", "output follows its command again; read-back", INFO),
    E("TELEMETRY_LOST", "telemetry rows lost, the console is too slow", WARNING),
    E("ALARM_ON", "alarm limit passed; measurement, or distance from the setpoint", ALARM),
    E("ALARM_OFF", "alarm condition is over; measurement, or distance from the setpoint", INFO),
    E("ALARM_ACK", "alarm acknowledged", INFO),
    E("ALARM_SHELVED", "alarm silent for, s; 0: no longer", INFO),
    E("SAMPLE_OVERDUE", "the plant is there but sends no sample, s", ALARM),
    E("SAMPLE_STALLED",
      "samples come, plant time stands still or was set back; without a tick for, s", ALARM),
    E("RESTART_DONE", "outputs as before the reset (1), modes and setpoints as well (2)", WARNING),
    E("RESTART_REFUSED", "the safe state stays after this reset", WARNING),
    E("WRONG_KEY", "wrong keys at the console since then; how many", WARNING),
    E("PLANT_REFUSED", "plant is not taken", ALARM),
    E("SAMPLE_REFUSED",
      "sample of another shape than announced, or with an unknown quality; measurements in it",
      WARNING),
    E("STORAGE_LOADED", "stored settings are asked into force; set", INFO),
    E("STORAGE_OLDER", "a newer stored set is not whole, an older one is used; set", WARNING),
    E("STORAGE_CLIPPED", "stored value replaced: not allowed, or of another type; value now",
      WARNING),
    E("STORAGE_REFUSED", "stored settings are not in force; `load` says why", ALARM),
    E("STORAGE_DAMAGED", "no whole set is stored, defaults are in force", ALARM),
    E("STORAGE_LEFT_OUT", "stored settings left out: resets in a row, each soon after its start",
      ALARM),
    E("STORAGE_NEWER", "settings of newer firmware are stored: nothing is written; format", ALARM),
    E("BLOCK_UNKNOWN", "kind that this build lacks, or no room for it: kept, not run; block",
      ALARM),
    E("IMAGE_DAMAGED", "firmware is not the one that was built: nothing acts, outputs stay safe",
      ALARM),
    S("SEQUENCE_STEP", "sequence waits at step", INFO),
    S("SEQUENCE_HELD", "sequence held at step", WARNING),
    S("SEQUENCE_GOES_ON", "sequence goes on at step", INFO),
    S("SEQUENCE_CONFIRMED", "step confirmed", INFO),
    S("SEQUENCE_SKIPPED", "step no longer waited for", WARNING),
    S("SEQUENCE_TIMEOUT", "step took longer than allowed", WARNING),
    S("SEQUENCE_DONE", "sequence done, last step", INFO),
    S("SEQUENCE_ABORTED", "sequence aborted into the safe state at step", ALARM),
    S("OFFSET", "subtracted from the readings from now on", INFO),
    C("COMMISSION_BEGUN", "automatic start-up has begun; inputs to test", INFO),
    C("COMMISSION_ENDED", "automatic start-up given up", ALARM),
    C("TEST_STEP", "test of this input; amplitude, fraction of span", INFO),
    C("TEST_CUT", "test cut short, this would pass its limit; peak seen coming, fraction of span",
      INFO),
    C("TEST_DONE", "input tested; length of half a double step, s", INFO),
    C("TEST_LONGER", "an output did not come to rest, test done again; half of a double step, s",
      INFO),
    C("TEST_SMALLER",
      "too large a step, test done again with a smaller one; amplitude, fraction of span", INFO),
    C("TEST_EXTENDED", "pairing not determined yet, tests are repeated; probability", INFO),
    C("RELAY_DONE", "relay test done, see `commission relay`; ultimate period, s", INFO),
    C("PROPOSAL", "pairing determined, see `commission proposal`; probability", INFO),
    C("NOT_DETERMINED", "pairing not determined, see `commission pairing`; probability", WARNING),
    C("TRIAL_BEGUN", "proposed loops on trial; loops", INFO),
    C("TRIAL_KEPT", "proposed loops did as predicted and stay; loops", INFO),
    C("TRIAL_FAILED", "proposed loops are taken back, the old settings return", ALARM),
    J("JOB_LATE", "the result of this work is not there at its tick; ticks it was given", WARNING),
    C("BLOCK_GAVE_UP", "a block is off, its loops go on without it; which block", ALARM),
    C("BLOCK_ON", "a block acts for its loops again; which block", INFO),
#if EVENTS_OF_BLOCKS
    E("CHANNEL_WRITTEN",
      "a block writes this measurement, the plant's own readings are not looked at; which block",
      WARNING),
    E("LOOP_DIVISOR",
      "divisor is no multiple of the ticks between samples of its measurement; these", WARNING),
    E("BLOCK_VERB", "the block has done that; the number it was given", INFO),
    E("BLOCK_REFUSED", "a block has not done what it was told; which block", WARNING),
    E("BLOCK_EVENT", "a block says", INFO),
    E("BLOCK_ALARM", "a block says", ALARM),
    E("EXCITATION_BEGUN", "a block excites the plant with a test signal; which block", INFO),
    E("EXCITATION_ENDED", "the test signal of a block is over; which block", INFO),
    E("BLOCK_PROPOSES", "a block proposes settings, see `proposal`; which block", INFO),
    E("BLOCK_ADOPTED", "settings that a block proposes are asked into force; which block", INFO),
    E("PROPOSAL_REFUSED", "what a block proposes is refused, see `proposal`; value", WARNING),
#endif
    G("DEVIATION", "the PV is far from its setpoint, and has been for long; distance", ALARM),
    G("DEVIATION_OVER", "the PV is near its setpoint again, or the loop in manual; distance", INFO),
    G("DOUBTFUL", "a loop acts on a reading that has long been uncertain; it reads", ALARM),
    G("DOUBTFUL_OVER", "no loop acts on an uncertain reading any more; it reads", INFO),
    C("FIRST_READING", "the first reading was far from those that followed; it was", WARNING),
    C("SAME_READING", "sends the same numbers as another measurement, meas", WARNING),
    E("DO_MODE", "mode asked for (0 manual, 1 auto, 2 cascade)", ACTION),
    E("DO_SETPOINT", "setpoint asked for", ACTION),
    E("DO_OUTPUT", "output asked for", ACTION),
    E("DO_SET", "parameter set; 0 for a word", ACTION),
    E("DO_APPLY", "transaction applied; parameters it changes", ACTION),
    E("DO_STORAGE", "stored settings saved, loaded or replaced", ACTION),
    E("DO_ALARM", "alarm acknowledged or shelved", ACTION),
    S("DO_SEQUENCE", "sequence started, stopped or told what to do", ACTION),
    E("DO_KEY", "key changed", ACTION),
    E("DO_UNLOCK", "engineer level unlocked", ACTION),
    E("DO_LOCK", "engineer level locked", ACTION),
    C("DO_COMMISSION", "automatic start-up told something", ACTION),
    E("DO_REBOOT", "restart asked for", ACTION),
#if EVENTS_OF_BLOCKS
    E("DO_BLOCK", "block switched, or told something; the number it was given", ACTION),
    E("DO_PROPOSAL", "proposal of a block accepted, rejected or taken back; its values", ACTION),
    E("SWITCHED_OFF", "adds nothing until its settings change; which block has switched it off",
      WARNING),
    E("PROPOSAL_WITHDRAWN", "a block takes back what it has proposed; which block", INFO),
#endif
};
_Static_assert(sizeof table / sizeof table[0] == EVENT_COUNT, "every event has a name and a text");

const char *event_name(uint8_t code)
{
    return code < EVENT_COUNT ? table[code] + 1 : "?";
}

const char *event_text(uint8_t code)
{
    return code < EVENT_COUNT ? strchr(event_name(code), 0) + 1 : "?";
}

enum event_level event_level(uint8_t code)
{
    return code < EVENT_COUNT ? (enum event_level)table[code][0] : EVENT_ALARM;
}

bool event_may_repeat(uint8_t code)
{
    bool of_test = code >= EVENT_SEQUENCE_STEP && code <= EVENT_TRIAL_FAILED;
    enum event_level level = event_level(code);
    if (level == EVENT_WARNING || level == EVENT_ALARM)
        return !of_test && code != EVENT_WRONG_KEY; /* which counts itself */
    return code == EVENT_LINK_UP || code == EVENT_MEASUREMENT_GOOD || code == EVENT_INTERLOCK_OFF ||
           code == EVENT_FOLLOWING || code == EVENT_ALARM_OFF || code == EVENT_DEVIATION_OVER ||
           code == EVENT_DOUBTFUL_OVER
#if EVENTS_OF_BLOCKS
           || code == EVENT_BLOCK_EVENT
#endif
        ;
}

const char *event_level_name(enum event_level level)
{
    static const char *const names[] = {"info", "warning", "alarm", "action"};
    return level <= EVENT_ACTION ? names[level] : "?";
}

struct event event_make(uint64_t time_ms, enum event_code code, const char *subject, float value,
                        uint8_t detail)
{
    struct event e;
    memset(&e, 0, sizeof e);
    e.time_ms = time_ms;
    e.code = (uint8_t)code;
    e.detail = detail;
    e.value = value;
    if (subject)
        strncpy(e.subject, subject, sizeof e.subject - 1);
    return e;
}

void event_queue_init(struct event_queue *queue)
{
    memset(queue, 0, sizeof *queue);
    spsc_init(&queue->index, EVENT_QUEUE_SIZE);
}

void event_put(struct event_queue *queue, uint64_t time_ms, enum event_code code,
               const char *subject, float value, uint8_t detail)
{
    if (!spsc_can_write(&queue->index)) {
        queue->lost++;
        return;
    }
    queue->slot[spsc_write_index(&queue->index)] =
        event_make(time_ms, code, subject, value, detail);
    spsc_write_done(&queue->index);
}
