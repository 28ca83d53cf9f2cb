#include "commission/reasons.h"

static const char *const reason_texts[REASON_COUNT] = {
    [REASON_NOT] = "",
    [REASON_ASKED] = "asked for",
    [REASON_SAFE] = "safe state",
    [REASON_LOST] = "measurement is not valid",
    [REASON_INTERLOCK] = "an interlock holds the output",
    [REASON_ACTUATOR] = "the output does not follow its command",
    [REASON_HAND] = "moved by somebody else",
    [REASON_CONFIG] = "another configuration was applied",
    [REASON_RESTLESS] = "did not settle before the test",
    [REASON_LIMIT] = "went past its test limit",
    [REASON_AWAY] = "did not return after the test: unstable or integrating",
    [REASON_INTEGRATES] =
        "integrates, or is far slower than `test.longest`: it must settle by itself",
    [REASON_TOO_SLOW] = "is too slow for `test.longest` or its `test_time`: raise it",
    [REASON_LEFT] = "left the operating point by more than its drift: bring it back, begin again",
    [REASON_SPAN] = "reads an end of its span: widen the span, or repair the sensor",
    [REASON_REVERSAL] =
        "would exceed its test limit at the reversal: smaller `test_step` or wider limit",
    [REASON_NO_INPUT] = "every input was skipped",
    [REASON_NUMBERS] = "the analysis refused the model",
    [REASON_SAMPLES] = "samples were missing",
    [REASON_RESET] = "the board was reset",
    [REASON_TRIAL_LIMIT] = "went past its test limit on trial",
    [REASON_TRIAL_SLOW] = "took far longer than predicted on trial",
    [REASON_TRIAL_PEAK] = "overshot far more than predicted on trial",
    [REASON_TRIAL_REST] = "did not come to rest on trial",
    [REASON_TRIAL_ROOM] = "an output saturated on trial",
    [REASON_SEQUENCE] = "a sequence is under way; `seq` shows it",
    [REASON_EXCITED] = "excites the plant: `block BLOCK off` or a new mode of its loop ends that",
    [REASON_TRIAL_SWINGS] = "oscillated on trial with too little damping",
    [REASON_NO_ANSWER] =
        "its measurement does not answer to the relay, or its action is the wrong one",
    [REASON_ACTION] = "its action is wrong, the measurement went the other way: change `action`",
    [REASON_TRIAL_MARGIN] =
        "oscillated with its gain raised: less than `test.probe` times the gain is left",
    [REASON_WATCH_LIMIT] = "went further from its setpoint than its test limit",
    [REASON_WATCH_SWINGS] = "oscillates without decaying",
    [REASON_WATCH_STUCK] = "its output stands at a limit",
    [REASON_WATCH_MANUAL] = "was in manual for more than a tenth of the watch",
    [REASON_NO_CYCLE] = "no steady cycle under the relay",
};

const char *commission_reason_text(enum commission_reason reason)
{
    return reason < REASON_COUNT ? reason_texts[reason] : "";
}
