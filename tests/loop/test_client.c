/* A client in C and without text: its requests go through operate/, the results over the bytes of the plant link. */
#include <math.h>

#include "client_bench.h"
#include "console/commands.h"

void setUp(void) {}
void tearDown(void) {}

static void without_text_wood_berry_is_commissioned_and_a_setpoint_stepped(void)
{
    struct loop_reading top, bottom;
    power_on_wood_berry();
    configures();
    plant_side_connect();
    brings_to_nominal();
    was_recorded(EVENT_DO_OUTPUT, "S", 1.71, ENGINEER);

    DO(operate_startup(&client, COMMISSION_ASK_BEGIN, &answer));
    was_recorded(EVENT_DO_COMMISSION, "begin", 0, ENGINEER);
    waits_until(COMMISSION_TESTING, 3);
    REFUSED(ERR_STATE, operate_accept(&client, &answer));
    waits_until(COMMISSION_READY, 3000);
    TEST_ASSERT_TRUE(operate_startup_reading(&client).proposal);
    TEST_ASSERT_FALSE(operate_loop(&client, 0, &top)); /* still proposed only */

    DO(operate_accept(&client, &answer));
    was_recorded(EVENT_DO_COMMISSION, "accept", 0, ENGINEER);
    TEST_ASSERT_TRUE(operate_is_in_acceptance(&client));
    DO(operate_save(&client, false, &answer));
    REFUSED(ERR_STATE, operate_result(&client, &answer)); /* nothing on trial is stored */
    TEST_ASSERT_FALSE(operate_waits(&client));
    waits_until(COMMISSION_KEPT, 4000);

    uint8_t loop = loop_of("xD", &top);
    (void)loop_of("xB", &bottom);
    TEST_ASSERT_EQUAL_STRING("R", top.mv->name);
    TEST_ASSERT_EQUAL_STRING("S", bottom.mv->name);
    TEST_ASSERT_EQUAL_INT(LOOP_AUTO, top.mode);
    TEST_ASSERT_EQUAL_INT(LOOP_AUTO, bottom.mode);
    client_steps(200);
    double before = truly_is("xD"), below = truly_is("xB"), reflux = is_commanded("R");
    DO(operate_setpoint(&client, loop, (float)before + 1.0f, &answer));
    was_recorded(EVENT_DO_SETPOINT, operate_in_force(&client)->loop[loop].name, before + 1.0,
                 ENGINEER);
    client_steps(3);
    TEST_ASSERT_TRUE(is_commanded("R") > reflux); /* more reflux for a purer top */
    client_steps(200);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, before + 1.0, truly_is("xD"));
    TEST_ASSERT_DOUBLE_WITHIN(0.05, below, truly_is("xB"));
    (void)loop_of("xD", &top);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, before + 1.0, (double)top.value);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, before + 1.0, (double)top.setpoint);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, is_commanded("R"), (double)top.output);
    TEST_ASSERT_EQUAL_INT(QUALITY_GOOD, top.quality);
}

/* Goes on from the test above. */
static void what_it_has_commissioned_is_saved_and_comes_back(void)
{
    struct loop_reading top;
    uint8_t loop = loop_of("xD", &top);
    double gain = loop_has(loop, "gain"), action = loop_has(loop, "action");
    DO(operate_mode(&client, loop, LOOP_MANUAL, &answer));
    uint8_t below = loop_of("xB", &top);
    DO(operate_mode(&client, below, LOOP_MANUAL, &answer));
    was_recorded(EVENT_DO_MODE, operate_in_force(&client)->loop[below].name, LOOP_MANUAL, ENGINEER);
    client_steps(2);
    enum err err = operate_save(&client, false, &answer);
    TEST_ASSERT_TRUE(operate_waits(&client));
    REFUSED(ERR_BUSY, operate_load(&client, &answer)); /* one after the other */
    for (unsigned turn = 0; !err && operate_waits(&client) && turn < 1000; turn++) {
        err = operate_result(&client, &answer);
        err = err == ERR_BUSY ? ERR_OK : err;
        board_side_run();
    }
    is_done(err, "save");
    TEST_ASSERT_FALSE(operate_waits(&client));
    was_recorded(EVENT_DO_STORAGE, "save", 0, ENGINEER);
    DO(number(&client, "loop1.gain", 0.125));
    was_recorded(EVENT_DO_SET, "loop1.gain", 0.125, ENGINEER);
    client_steps(1);
    DO(operate_defaults(&client, &answer));
    client_steps(1);
    TEST_ASSERT_FALSE(operate_loop(&client, loop, &top));
    DO(operate_load(&client, &answer));
    DO(operate_result(&client, &answer));
    client_steps(1);
    TEST_ASSERT_EQUAL_UINT8(loop, loop_of("xD", &top));
    TEST_ASSERT_EQUAL_DOUBLE(gain, loop_has(loop, "gain"));
    TEST_ASSERT_EQUAL_DOUBLE(action, loop_has(loop, "action"));
    TEST_ASSERT_EQUAL_INT(LOOP_MANUAL, top.mode);
}

static void what_it_gives_as_a_number_is_looked_at_like_a_word(void)
{
    one_loop();
    TEST_ASSERT_EQUAL_DOUBLE(1500, has("loop1.ti"));
    REFUSED(ERR_RANGE, number(&client, "loop1.ti", -1));
    TEST_ASSERT_EQUAL_INT(ANSWER_VALUE, answer.more);
    TEST_ASSERT_EQUAL_STRING("ti", answer.value.parameter.field->name);
    REFUSED(ERR_RANGE, number(&client, "loop1.ti", (double)NAN));
    REFUSED(ERR_RANGE, number(&client, "loop1.ti", (double)INFINITY));
    REFUSED(ERR_RANGE, number(&client, "loop1.divisor", 1.5)); /* whole numbers */
    REFUSED(ERR_RANGE, number(&client, "loop1.divisor", 0));
    REFUSED(ERR_RANGE, number(&client, "loop1.action", 2)); /* of two words */
    REFUSED(ERR_PARSE, number(&client, "loop1.name", 7));
    REFUSED(ERR_READ_ONLY, number(&client, "config.schema", 1));
    DO(number(&client, "loop1.divisor", 3));
    client_steps(1);
    DO(number(&client, "loop1.action", 1));
    client_steps(1);
    DO(number(&client, "meas1.offset", -0.0));
    client_steps(1);
    TEST_ASSERT_EQUAL_DOUBLE(3, has("loop1.divisor"));
    TEST_ASSERT_EQUAL_DOUBLE(1, has("loop1.action"));
    TEST_ASSERT_EQUAL_DOUBLE(0, has("mv1.rate"));
    struct parameter name = parameter("loop1.name");
    float none;
    REFUSED(ERR_PARSE, parameter_get_number(&name, operate_settings(&client), &none));
    TEST_ASSERT_FALSE(signbit(operate_settings(&client)->measurement[0].offset.eu));
    TEST_ASSERT_EQUAL_DOUBLE(1500, has("loop1.ti"));
    /* Each may be right and all together wrong: said as the field and what would be right. */
    REFUSED(ERR_RANGE, number(&client, "meas1.lo", 1e6));
    TEST_ASSERT_EQUAL_INT(ANSWER_CONFIG, answer.more);
    TEST_ASSERT_EQUAL_STRING("meas", answer.config.group);
    TEST_ASSERT_EQUAL_UINT8(1, answer.config.index);
}

static void what_is_not_there_is_unknown_and_what_is_out_of_range_says_the_range(void)
{
    one_loop();
    REFUSED(ERR_UNKNOWN, operate_mode(&client, 1, LOOP_AUTO, &answer));
    REFUSED(ERR_UNKNOWN, operate_mode(&client, CONFIG_LOOPS, LOOP_AUTO, &answer));
    REFUSED(ERR_UNKNOWN, operate_setpoint(&client, PLAN_NONE, 96, &answer));
    REFUSED(ERR_UNKNOWN, operate_output(&client, PLAN_NONE, PLAN_NONE, 1, &answer));
    REFUSED(ERR_UNKNOWN, operate_output(&client, PLAN_NONE, 2, 1, &answer));
    REFUSED(ERR_UNKNOWN, operate_relay(&client, 1, &answer));
    REFUSED(ERR_UNKNOWN, operate_acknowledge(&client, "xD.hi", &answer));
    REFUSED(ERR_UNKNOWN, operate_shelve(&client, NULL, 10, &answer));
    REFUSED(ERR_RANGE, operate_mode(&client, 0, (enum loop_mode)3, &answer));
    REFUSED(ERR_UNKNOWN, operate_startup(&client, COMMISSION_ASK_TRIAL, &answer));
    REFUSED(ERR_UNKNOWN, operate_startup(&client, (enum commission_ask)99, &answer));
    REFUSED(ERR_UNKNOWN, operate_sequence(&client, (enum sequence_command)99, &answer));
    REFUSED(ERR_STATE, operate_sequence(&client, SEQUENCE_DO_START, &answer));
    TEST_ASSERT_EQUAL_STRING("start", answer.subject);

    REFUSED(ERR_RANGE, operate_output(&client, 0, PLAN_NONE, NAN, &answer));
    REFUSED(ERR_RANGE, operate_output(&client, 0, PLAN_NONE, 1e3f, &answer));
    TEST_ASSERT_EQUAL_STRING("top", answer.subject);
    TEST_ASSERT_EQUAL_INT(ANSWER_RANGE, answer.more);
    const struct mv_config *o = &operate_settings(&client)->mv[output_named("R")];
    TEST_ASSERT_EQUAL_FLOAT(1e3f, answer.range.value);
    TEST_ASSERT_EQUAL_FLOAT(o->min, answer.range.lo);
    TEST_ASSERT_EQUAL_FLOAT(o->max, answer.range.hi);
    TEST_ASSERT_EQUAL_STRING(o->unit, answer.range.unit);

    DO(operate_mode(&client, 0, LOOP_AUTO, &answer));
    REFUSED(ERR_STATE, operate_output(&client, 0, PLAN_NONE, 1.9f, &answer)); /* at once */
    client_steps(1);
    REFUSED(ERR_RANGE, operate_setpoint(&client, 0, NAN, &answer));
    REFUSED(ERR_CONFLICT, operate_mode(&client, 0, LOOP_CASCADE, &answer));
    TEST_ASSERT_TRUE(is_commanded("R") > 1.9 && is_commanded("R") < 2.0);
}

static void settings_from_a_model_are_for_the_spans_of_its_loop(void)
{
    struct tuning t;
    struct fopdt process = {.gain = 12.8f, .dead_time_s = 60, .time_constant_s = 1002};
    one_loop();
    const struct config *c = operate_settings(&client);
    double mv = (double)(c->mv[output_named("R")].hi - c->mv[output_named("R")].lo);
    double pv = (double)(c->measurement[0].hi - c->measurement[0].lo);
    DO(operate_tune(&client, 0, TUNE_SIMC, &process, 60, &t, &answer));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 1002.0 / (12.8 * mv / pv * 120.0), (double)t.gain);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 480, (double)t.ti_s);
    TEST_ASSERT_EQUAL_INT(TUNING_REVERSE, t.action);
    process.time_constant_s = 0;
    REFUSED(ERR_RANGE, operate_tune(&client, 0, TUNE_COHEN_COON, &process, 0, &t, &answer));
    TEST_ASSERT_EQUAL_STRING("time_constant_s", answer.subject);
    REFUSED(ERR_UNKNOWN, operate_tune(&client, 1, TUNE_SIMC, &process, 60, &t, &answer));
}

/* ---- the console's rows ---- */

/* The arguments of a command stand in its row as text, and completion offers what stands there. */
static bool row_has(const char *command, const char *word)
{
    static const char *const rows[][2] = {
#define ROW(name, arguments, help, words_min, words_max) {#name, arguments},
        CONSOLE_COMMANDS(ROW)
#undef ROW
    };
    for (unsigned i = 0; i < sizeof rows / sizeof rows[0]; i++)
        if (strcmp(rows[i][0], command) == 0)
            return strstr(rows[i][1], word) != NULL;
    return false;
}

static void rows_of_commands_have_every_request(void)
{
    for (unsigned k = 0; k < SEQUENCE_COMMANDS; k++)
        TEST_ASSERT_TRUE_MESSAGE(row_has("seq", operate_sequence_word((enum sequence_command)k)),
                                 "write the new word into the row `seq` of console/commands.h");
    for (unsigned k = 0; k <= COMMISSION_ASK_REJECT; k++) {
        const char *word = operate_startup_word((enum commission_ask)k);
        TEST_ASSERT_TRUE_MESSAGE(!word || row_has("commission", word),
                                 "write the new word into the row `commission` of "
                                 "console/commands.h");
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(rows_of_commands_have_every_request);
    RUN_TEST(without_text_wood_berry_is_commissioned_and_a_setpoint_stepped);
    RUN_TEST(what_it_has_commissioned_is_saved_and_comes_back);
    RUN_TEST(what_it_gives_as_a_number_is_looked_at_like_a_word);
    RUN_TEST(what_is_not_there_is_unknown_and_what_is_out_of_range_says_the_range);
    RUN_TEST(settings_from_a_model_are_for_the_spans_of_its_loop);
    return UNITY_END();
}
