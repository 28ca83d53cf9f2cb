/* kinds/pid/pid.h: which settings are taken, and what is said of the others.
 *
 * Contract: each field is accepted at both ends of its range and refused just beyond them, with its name and
 * the range wanted; NaN and infinity in any field are ERR_NOT_FINITE; a refused call changes nothing.
 */
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "pid_bench.h"

void setUp(void) {}
void tearDown(void) {}

static const struct field {
    const char *name;
    size_t offset;
    float lo, hi;
    bool zero_too;
} fields[] = {
    {"gain", offsetof(struct pid_config, gain), 1e-6f, 100.0f, false},
    {"ti_s", offsetof(struct pid_config, ti_s), 0.01f, 1e6f, true},
    {"td_s", offsetof(struct pid_config, td_s), 0.0f, 1e5f, false},
    {"n", offsetof(struct pid_config, n), 1.0f, 100.0f, false},
    {"b", offsetof(struct pid_config, b), 0.0f, 1.0f, false},
    {"c", offsetof(struct pid_config, c), 0.0f, 1.0f, false},
    {"tt_s", offsetof(struct pid_config, tt_s), 0.01f, 1e6f, true},
    {"out_lo", offsetof(struct pid_config, out_lo), -127.0f, 0.9999f,
     false},                                                               /* against out_hi = 1 */
    {"out_hi", offsetof(struct pid_config, out_hi), 1e-6f, 127.0f, false}, /* against out_lo = 0 */
    {"rate_per_s", offsetof(struct pid_config, rate_per_s), 1e-9f, 1e6f, true},
    {"inhibit_s", offsetof(struct pid_config, inhibit_s), 0.0f, 1e5f, false},
};
#define FIELDS (sizeof fields / sizeof fields[0])

static struct pid_config with(const struct field *f, float value)
{
    struct pid_config c = pid_default_config();
    memcpy((char *)&c + f->offset, &value, sizeof value);
    return c;
}

static void the_default_settings_are_valid(void)
{
    struct pid_config c = pid_default_config();
    TEST_ASSERT_EQUAL_INT(ERR_OK, pid_validate(&c, NULL, NULL));
    TEST_ASSERT_TRUE(c.ti_s == 0.0f && c.b == 1.0f && c.c == 0.0f && c.n == 8.0f);
}

static void every_field_is_taken_at_both_ends_of_its_range(void)
{
    for (size_t i = 0; i < FIELDS; i++) {
        struct pid_config lo = with(&fields[i], fields[i].lo), hi = with(&fields[i], fields[i].hi);
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, pid_validate(&lo, NULL, NULL), fields[i].name);
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, pid_validate(&hi, NULL, NULL), fields[i].name);
        if (fields[i].zero_too) {
            struct pid_config zero = with(&fields[i], 0.0f);
            TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, pid_validate(&zero, NULL, NULL), fields[i].name);
        }
    }
}

static void refused(const struct field *f, float value, enum err want)
{
    struct pid_config c = with(f, value);
    const char *name = "", *wanted = "";
    TEST_ASSERT_EQUAL_INT_MESSAGE(want, pid_validate(&c, &name, &wanted), f->name);
    TEST_ASSERT_TRUE_MESSAGE(strlen(wanted) > 3, f->name);
    if (strcmp(f->name, "out_lo") != 0) /* out_lo above out_hi is reported of out_hi */
        TEST_ASSERT_EQUAL_STRING(f->name, name);
    struct pid pid, was;
    memset(&pid, 0x5A, sizeof pid);
    memcpy(&was, &pid, sizeof pid);
    TEST_ASSERT_EQUAL_INT(want, pid_init(&pid, &c, 1.0f));
    TEST_ASSERT_EQUAL_MEMORY(&was, &pid, sizeof pid);
}

static void every_field_is_refused_beyond_its_range_with_its_name(void)
{
    for (size_t i = 0; i < FIELDS; i++) {
        float below = fields[i].lo > 0.0f ? fields[i].lo * 0.99f : fields[i].lo - 0.01f;
        if (fields[i].offset == offsetof(struct pid_config, out_hi))
            below = 0.0f;
        if (!fields[i].zero_too || below < 0.0f || below > 0.0f)
            refused(&fields[i], below, ERR_RANGE);
        refused(&fields[i], fields[i].hi * 1.01f, ERR_RANGE);
    }
}

static void nan_and_infinity_are_refused_in_every_field(void)
{
    for (size_t i = 0; i < FIELDS; i++) {
        refused(&fields[i], nanf(""), ERR_NOT_FINITE);
        refused(&fields[i], HUGE_VALF, ERR_NOT_FINITE);
        refused(&fields[i], -HUGE_VALF, ERR_NOT_FINITE);
    }
}

static void the_range_of_the_gain_is_said_in_words(void)
{
    struct pid_config c = pid_default_config();
    c.gain = nanf("");
    const char *name, *wanted;
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, pid_validate(&c, &name, &wanted));
    TEST_ASSERT_EQUAL_STRING("gain", name);
    TEST_ASSERT_EQUAL_STRING("1e-6 to 100", wanted);
}

static void output_limits_that_meet_or_cross_are_refused(void)
{
    struct pid_config c = pid_default_config();
    const char *name, *wanted;
    c.out_lo = 0.5f;
    c.out_hi = 0.5f;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, pid_validate(&c, &name, &wanted));
    TEST_ASSERT_EQUAL_STRING("out_hi", name);
    c.out_hi = 0.4f;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, pid_validate(&c, &name, &wanted));
}

static void an_unknown_action_or_form_is_refused(void)
{
    struct pid_config c = pid_default_config();
    const char *name;
    c.action = (enum pid_action)2;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, pid_validate(&c, &name, NULL));
    TEST_ASSERT_EQUAL_STRING("action", name);
    c = pid_default_config();
    c.form = (enum pid_form)7;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, pid_validate(&c, &name, NULL));
    TEST_ASSERT_EQUAL_STRING("form", name);
}

static void a_bad_step_interval_is_refused(void)
{
    struct pid_config c = pid_default_config();
    struct pid pid;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, pid_init(&pid, &c, 0.0f));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, pid_init(&pid, &c, -1.0f));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, pid_init(&pid, &c, 2e5f));
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, pid_init(&pid, &c, nanf("")));
}

static void a_refused_start_leaves_the_controller_as_it_was(void)
{
    struct pid_config c = pid_default_config();
    struct pid pid = make_pid(c, 1.0f), was;
    pid_follow(&pid, N(0.5), N(0.25), N(0.75));
    memcpy(&was, &pid, sizeof was);
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, pid_init(&pid, &c, 0.0f));
    TEST_ASSERT_EQUAL_MEMORY(&was, &pid, sizeof was);
    c.gain = -1.0f;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, pid_init(&pid, &c, 1.0f));
    TEST_ASSERT_EQUAL_MEMORY(&was, &pid, sizeof was);
}

static void a_refused_retune_leaves_the_controller_as_it_was(void)
{
    struct pid_config c = pid_default_config();
    c.ti_s = 10.0f;
    struct pid pid = make_pid(c, 1.0f), was;
    pid_follow(&pid, N(0.5), N(0.4), N(0.3));
    tick(&pid, 0.5, 0.41);
    memcpy(&was, &pid, sizeof pid);
    c.gain = nanf("");
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, pid_retune(&pid, &c, 1.0f));
    c.gain = 0.0f;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, pid_retune(&pid, &c, 1.0f));
    c.gain = 1.0f;
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, pid_retune(&pid, &c, nanf("")));
    TEST_ASSERT_EQUAL_MEMORY(&was, &pid, sizeof pid);
}

static void the_block_describes_its_inner_values_by_name(void)
{
    struct pid_config c = pid_default_config();
    c.gain = 2.0f;
    c.ti_s = 10.0f;
    for (int form = 0; form < 2; form++) {
        c.form = (enum pid_form)form;
        struct pid pid = make_pid(c, 1.0f);
        pid_follow(&pid, N(0.5), N(0.4), N(0.3));
        num_t u;
        num_t r = N(0.5), y = N(0.4);
        uint8_t limited;
        struct block_io io = {.members.acting = 1,
                              .members.setpoint = &r,
                              .members.in = &y,
                              .members.out = &u,
                              .members.limited = &limited};
        pid_kind.step(&pid, &io);
        float value;
        size_t n = 0;
        bool seen = false;
        for (const char *name; (name = pid_kind.describe(&pid, n, &value)); n++) {
            if (strcmp(name, "proportional") == 0)
                TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.2f, value);
            if (strcmp(name, "integral") == 0) {
                TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.1f, value);
                seen = true;
            }
        }
        TEST_ASSERT_TRUE(seen);
        TEST_ASSERT_EQUAL_UINT(7, n);
    }
}

/* Faster than a tick is within one tick, not beyond it. */
static void a_tracking_time_below_the_tick_takes_back_all_and_no_more(void)
{
    struct pid_config c = pid_default_config();
    c.ti_s = 100.0f;
    c.tt_s = 0.5f;
    struct pid pid = make_pid(c, 1.0f);
    (void)tick(&pid, 0, 0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1, tick(&pid, 3, 0)); /* 3 is wanted, 1 applied */
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1, tick(&pid, 3, 0));
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 1, D(pid.raw));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_tracking_time_below_the_tick_takes_back_all_and_no_more);
    RUN_TEST(the_default_settings_are_valid);
    RUN_TEST(every_field_is_taken_at_both_ends_of_its_range);
    RUN_TEST(every_field_is_refused_beyond_its_range_with_its_name);
    RUN_TEST(nan_and_infinity_are_refused_in_every_field);
    RUN_TEST(the_range_of_the_gain_is_said_in_words);
    RUN_TEST(output_limits_that_meet_or_cross_are_refused);
    RUN_TEST(an_unknown_action_or_form_is_refused);
    RUN_TEST(a_bad_step_interval_is_refused);
    RUN_TEST(a_refused_start_leaves_the_controller_as_it_was);
    RUN_TEST(a_refused_retune_leaves_the_controller_as_it_was);
    RUN_TEST(the_block_describes_its_inner_values_by_name);
    return UNITY_END();
}
