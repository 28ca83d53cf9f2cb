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
    [REASON_RESTLESS] = "does not come to rest before the test",
    [REASON_LIMIT] = "went past its test limit",
    [REASON_AWAY] = "does not come back after the test: unstable or integrating",
    [REASON_INTEGRATES] =
        "integrates, or is many times slower than `test.longest`: it must come to rest by itself",
    [REASON_TOO_SLOW] =
        "is slower than `test.longest` or its `test_time` allows: set more, or leave it out",
    [REASON_LEFT] =
        "is farther from where it was than its drift explains: bring it back, and begin anew",
    [REASON_SPAN] = "reads an end of its span, not the plant: widen the span, or repair the sensor",
    [REASON_REVERSAL] =
        "would go past its test limit at the reversal: a smaller `test_step`, or a wider limit",
    [REASON_NO_INPUT] = "every input was skipped",
    [REASON_NUMBERS] = "the analysis refused the model",
    [REASON_SAMPLES] = "samples were missing",
    [REASON_RESET] = "the board was reset",
    [REASON_TRIAL_LIMIT] = "went past its test limit on trial",
    [REASON_TRIAL_SLOW] = "took far longer than predicted on trial",
    [REASON_TRIAL_PEAK] = "overshot far more than predicted on trial",
    [REASON_TRIAL_REST] = "did not come to rest on trial",
    [REASON_TRIAL_ROOM] = "an output stood at its limit on trial",
    [REASON_SEQUENCE] = "a sequence is under way; `seq` shows it",
    [REASON_EXCITED] =
        "excites the plant; `block BLOCK off` ends that, or a change of mode of its loop",
    [REASON_TRIAL_SWINGS] = "oscillated on trial without decaying fast enough",
    [REASON_NO_ANSWER] =
        "its measurement does not answer to the relay, or its action is the wrong one",
    [REASON_ACTION] =
        "its action is the wrong one, the measurement went the other way: change `action`",
    [REASON_NO_CYCLE] = "no steady cycle under the relay",
};

const char *commission_reason_text(enum commission_reason reason)
{
    return reason < REASON_COUNT ? reason_texts[reason] : "";
}
