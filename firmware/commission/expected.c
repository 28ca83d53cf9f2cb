#include "commission/expected.h"

#include "base/assertion.h"
#include "commission/channels.h"
#include "commission/commission_state.h"
#include "commission/next_test.h"
#include "commission/status.h"
#include "commission/test_inputs.h"

#define KNOWN_TIMES REAL_C(4.0) /* shortest half, in times given for a pair */
#define HALVES      REAL_C(3.0) /* of a test: up, down, and back to rest */
#define WINDOWS     REAL_C(2.0) /* of rest before and after */
/* The longest test waits at the end until a remaining slope counts as a drift. */
#define HALVES_MOST   REAL_C(3.5)
#define WINDOWS_MOST  REAL_C(3.0)
#define WINDOW_WIDEST REAL_C(0.25) /* of a half */

static real_t least_of(real_t a, real_t b)
{
    return a < b ? a : b;
}

/* Shortest half by the times given for the input, s. */
static real_t least_half_s(const struct config *config, uint8_t j, real_t window_s)
{
    real_t half_s = window_s;
    for (unsigned p = 0; p < CONFIG_PAIRS; p++) {
        const struct pair_config *pair = &config->pair[p];
        bool of_it = pair->measurement[0] && config_find_mv(config, pair->mv) == j;
        if (of_it && pair->time_s * KNOWN_TIMES > half_s)
            half_s = pair->time_s * KNOWN_TIMES;
    }
    return half_s;
}

/* First amplitude where the test finds it, fraction of span. */
static real_t first_found(const struct supervisor *s)
{
    real_t first = AMPLITUDE_FIRST;
    for (uint8_t i = 0; i < CHANNEL_MAX; i++)
        if (commission_measurement_is_tested(s, i))
            first =
                least_of(first, FIRST_OF_LIMIT * commission_limit(&s->plan->config.measurement[i]));
    return first;
}

struct expected_input expected_of_input(const struct supervisor *s, uint8_t j)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    const struct config *config = &s->plan->config;
    const struct mv_config *o = &config->mv[j];
    struct expected_input e = {.tested = commission_input_is_tested(s, j)};
    if (!e.tested)
        return e;
    e.test_base = commission_test_base(s, j);
    real_t room = commission_room(s, j, e.test_base), given = o->start_up.step / (o->hi - o->lo);
    bool found = !(given > REAL_C(0.0));
    e.first = least_of(room, found ? first_found(s) : given);
    e.most = least_of(room, found ? AMPLITUDE_MOST : given);
    real_t window_s = (real_t)config->test.window * s->plan->tick_s;
    uint32_t longest =
        config->test.longest_s > 0.0f ? commission_longest(s) : COMMISSION_HALF_PLENTY;
    real_t longest_s = (real_t)longest * s->plan->tick_s;
    real_t least_s = least_of(least_half_s(config, j, window_s), longest_s);
    if (o->start_up.time_s > 0.0f)
        least_s = longest_s = o->start_up.time_s;
    e.least_s = HALVES * least_s + WINDOWS * window_s;
    real_t widest_s = WINDOW_WIDEST * longest_s;
    widest_s = widest_s > window_s ? widest_s : window_s;
    e.most_s = HALVES_MOST * longest_s + WINDOWS_MOST * widest_s;
    unsigned again = found ? LINEAR_RETRIES_MAX + RETRIES_MAX : 0u;
    if (!(o->start_up.time_s > 0.0f))
        again += LONGER_RETRIES_MAX;
    e.tests_most = (uint16_t)(config->test.rounds + again);
    return e;
}

struct expected expected_of(const struct supervisor *s)
{
    struct expected all = {0};
    for (uint8_t i = 0; i < CHANNEL_MAX; i++)
        all.outputs = (uint8_t)(all.outputs + commission_measurement_is_tested(s, i));
    for (uint8_t j = 0; j < CHANNEL_MAX; j++) {
        struct expected_input e = expected_of_input(s, j);
        all.inputs = (uint8_t)(all.inputs + e.tested);
        all.least_s += e.least_s;
        all.most_s += e.most_s * (real_t)e.tests_most;
    }
    return all;
}

static real_t less(real_t a, real_t b)
{
    return a > b ? a - b : REAL_C(0.0);
}

struct expected_left expected_left(const struct commission *c, const struct supervisor *s)
{
    struct expected_left left = {.planned = inputs_tests(&c->inputs) == 0};
    if (left.planned) {
        struct expected all = expected_of(s);
        real_t gone_s = status_run_s(&c->status, s->time_ms);
        left.round_s = less(all.least_s, gone_s);
        left.most_s = less(all.most_s, gone_s);
        return left;
    }
    real_t each_s = inputs_mean_test_s(&c->inputs);
    bool testing = status_phase(&c->status) == COMMISSION_TESTING;
    real_t gone_s = testing ? status_phase_s(&c->status, s->time_ms) : REAL_C(0.0);
    uint8_t next = (uint8_t)(inputs_turn(&c->inputs) + !testing);
    unsigned rounds = s->plan->config.test.rounds, round = inputs_round(&c->inputs);
    unsigned more = rounds > round ? rounds - round : 0u;
    left.round_s = less(each_s * (real_t)inputs_due_from(&c->inputs, next), gone_s);
    left.most_s = left.round_s + each_s * (real_t)(more * inputs_due_from(&c->inputs, 0));
    return left;
}
