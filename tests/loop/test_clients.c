/* Rights of two clients at once: the console, and one without text. */
#include "client_bench.h"
#include "random_source.h"
#include "storage/storage.h"

void setUp(void) {}
void tearDown(void) {}

static void a_transaction_belongs_to_who_opened_it(void)
{
    one_loop();
    console_does("begin");
    console_does("set loop1.ti 1600");
    TEST_ASSERT_TRUE(operate_is_open(&client));
    REFUSED(ERR_STATE, operate_begin(&client, &answer));
    REFUSED(ERR_BUSY, number(&client, "loop1.ti", 1700));
    REFUSED(ERR_BUSY, operate_set(&client, "loop1.ti", "1700", &answer));
    REFUSED(ERR_BUSY, operate_key(&client, "secret", &answer));
    REFUSED(ERR_BUSY, operate_apply(&client, &answer));
    REFUSED(ERR_BUSY, operate_defaults(&client, &answer));
    DO(operate_load(&client, &answer));
    REFUSED(ERR_BUSY, operate_result(&client, &answer));
    TEST_ASSERT_FALSE(operate_waits(&client));
    DO(operate_save(&client, false, &answer));
    REFUSED(ERR_STATE, operate_result(&client, &answer));
    console_does("get loop1.ti");
    TEST_ASSERT_TRUE(console_has_said("1600"));
    console_does("apply");
    plant_side_step();
    TEST_ASSERT_EQUAL_DOUBLE(1600, has("loop1.ti"));

    /* A client that has gone away with one does not keep the others from theirs. */
    console_does("begin");
    console_does("set loop1.ti 1800");
    DO(operate_abandon(&client, &answer));
    console_is_refused("apply", "STATE");
    DO(operate_begin(&client, &answer));
    console_is_refused("set loop1.ti 1900", "BUSY");
    DO(number(&client, "loop1.ti", 2000));
    TEST_ASSERT_EQUAL_DOUBLE(1600, has("loop1.ti"));
    DO(operate_apply(&client, &answer));
    was_recorded(EVENT_DO_APPLY, "", 1, ENGINEER);
    plant_side_step();
    TEST_ASSERT_EQUAL_DOUBLE(2000, has("loop1.ti"));
}

static void a_proposal_is_not_accepted_into_the_transaction_of_another(void)
{
    power_on_wood_berry();
    configures();
    plant_side_connect();
    brings_to_nominal();
    DO(operate_startup(&client, COMMISSION_ASK_BEGIN, &answer));
    waits_until(COMMISSION_READY, 3000);
    console_does("commission edit");
    REFUSED(ERR_BUSY, operate_accept(&client, &answer));
    REFUSED(ERR_STATE, operate_edit(&client, &answer));
    console_does("abandon");
    DO(operate_edit(&client, &answer));
    console_is_refused("commission accept", "BUSY");
    DO(operate_accept(&client, &answer));
    TEST_ASSERT_FALSE(operate_is_open(&client));
    waits_until(COMMISSION_TRIAL, 3);
}

static void while_one_saves_no_other_touches_the_settings(void)
{
    one_loop();
    DO(operate_save(&client, false, &answer));
    REFUSED(ERR_BUSY, operate_result(&client, &answer));
    TEST_ASSERT_TRUE(operate_waits(&client));
    REFUSED(ERR_BUSY, operate_begin(&other, &answer));
    REFUSED(ERR_BUSY, number(&other, "loop1.ti", 1700));
    DO(operate_save(&other, false, &answer));
    REFUSED(ERR_BUSY, operate_result(&other, &answer)); /* waits for its turn */
    TEST_ASSERT_TRUE(operate_waits(&other));
    board_side_run();
    DO(operate_result(&client, &answer));
    TEST_ASSERT_FALSE(operate_waits(&client));
    (void)!operate_result(&other, &answer);
    board_side_run();
    DO(operate_result(&other, &answer));
    DO(operate_begin(&other, &answer));
}

/* The console is held (XOFF) in the midst of a row, which still needs the names of its plan. */
static void a_row_half_printed_keeps_its_plan(void)
{
    one_loop();
    console_does("log on");
    console_types("\x13");
    enum err err = ERR_OK;
    unsigned steps = 0;
    for (; !err && steps < 200; steps++) {
        plant_side_step();
        err = operate_begin(&client, &answer);
        if (!err)
            DO(operate_abandon(&client, &answer));
    }
    TEST_ASSERT_EQUAL_INT(ERR_BUSY, err);
    console_types("\x11");
    board_side_run();
    DO(operate_set(&client, "loop1.name", "renamed", &answer));
    plant_side_step();
    TEST_ASSERT_TRUE(console_has_said("renamed.mode"));
}

/* ---- two of them, at random, beside what ought to be ---- */

#define SEED 1u

static struct {
    const struct session *editor;   /* who has the open transaction; NULL: nobody */
    unsigned ti, edited;            /* of loop 1, s: for everybody, and in the transaction */
    unsigned applied, busy, stored; /* how often, so that the test is known to try it */
} ought;

static double ti_of(const struct config *config)
{
    struct parameter p = parameter("loop1.ti");
    float value;
    TEST_ASSERT_EQUAL_INT(ERR_OK, parameter_get_number(&p, config, &value));
    return (double)value;
}

/* The place where settings are written is somebody else's. */
static bool is_taken(const struct session *session)
{
    return ought.editor ? ought.editor != session : storage_saving(session->door->service->storage);
}

static enum err changes(struct session *session, unsigned ti)
{
    if (is_taken(session)) {
        ought.busy++;
        return ERR_BUSY;
    }
    *(ought.editor ? &ought.edited : &ought.ti) = ti;
    return ERR_OK;
}

static enum err ends(const struct session *session, bool applied)
{
    if (!ought.editor)
        return ERR_STATE;
    if (applied && ought.editor != session)
        return ERR_BUSY;
    if (applied)
        ought.ti = ought.edited;
    ought.applied += applied;
    ought.editor = NULL;
    return ERR_OK;
}

static void acts(struct session *session, struct random_source *source)
{
    unsigned ti = 1000 + random_below(source, 1000);
    enum err wanted;
    switch (random_below(source, 8)) {
    case 0:
        wanted = ought.editor ? ERR_STATE : is_taken(session) ? ERR_BUSY : ERR_OK;
        REFUSED(wanted, operate_begin(session, &answer));
        if (!wanted)
            ought.edited = ought.ti;
        ought.editor = wanted ? ought.editor : session;
        break;
    case 1:
        REFUSED(ends(session, true), operate_apply(session, &answer));
        break;
    case 2:
        REFUSED(ends(session, false), operate_abandon(session, &answer));
        break;
    case 3:
        wanted = operate_waits(session) ? ERR_BUSY : ERR_OK;
        REFUSED(wanted, operate_save(session, false, &answer));
        break;
    default:
        REFUSED(changes(session, ti), number(session, "loop1.ti", ti));
        break;
    }
}

/* A turn of the main loop for that client. */
static void goes_on(struct session *session)
{
    if (!operate_waits(session))
        return;
    bool begun = session->waits_for == WAITS_SAVING;
    enum err err = operate_result(session, &answer);
    if (operate_waits(session))
        return;
    /* Stored, or never begun. */
    REFUSED(begun ? ERR_OK : ERR_STATE, err);
    TEST_ASSERT_TRUE(begun || ought.editor);
    ought.stored += begun;
}

static void what_two_do_at_random_is_what_ought_to_be(void)
{
    struct random_source source = {SEED};
    struct session *both[2] = {&client, &other};
    printf("seed %u\n", SEED);
    one_loop();
    memset(&ought, 0, sizeof ought);
    ought.ti = (unsigned)has("loop1.ti");
    for (unsigned n = 0; n < 4000; n++) {
        acts(both[random_below(&source, 2)], &source);
        goes_on(&client);
        goes_on(&other);
        if (random_below(&source, 4) == 0)
            app_background(app_instance());
        if (random_below(&source, 16) == 0)
            plant_side_step();
        TEST_ASSERT_EQUAL(ought.editor != NULL, operate_is_open(&other));
        TEST_ASSERT_EQUAL_DOUBLE(ought.ti, ti_of(operate_settings(&client)));
        TEST_ASSERT_EQUAL_DOUBLE(ought.editor ? ought.edited : ought.ti,
                                 ti_of(operate_view(&other)));
    }
    plant_side_step();
    TEST_ASSERT_EQUAL_DOUBLE(ought.ti, ti_of(operate_in_force(&client)));
    TEST_ASSERT_TRUE(ought.applied > 20 && ought.busy > 200 && ought.stored > 50);
}

/* ---- levels ---- */

static void each_client_has_its_own_level(void)
{
    one_loop();
    console_does("set console.relock 100");
    plant_side_step();
    console_does("key secret");
    plant_side_step();
    session_init(&other, client.door);
    TEST_ASSERT_TRUE(operate_is_engineer(&client)); /* has acted while there was no key */
    TEST_ASSERT_FALSE(operate_is_engineer(&other));
    REFUSED(ERR_LOCKED, number(&other, "loop1.ti", 1700));
    REFUSED(ERR_LOCKED, operate_startup(&other, COMMISSION_ASK_BEGIN, &answer));
    REFUSED(ERR_LOCKED, operate_reboot(&other, &answer));
    DO(operate_mode(&other, 0, LOOP_AUTO, &answer));
    was_recorded(EVENT_DO_MODE, "top", LOOP_AUTO, 0); /* by an operator */
    console_does("lock");
    DO(number(&client, "loop1.ti", 1700));
    console_is_refused("set loop1.ti 1800", "LOCKED");

    /* Nobody tries twice as fast by two ways in. */
    REFUSED(ERR_LOCKED, operate_unlock(&other, "guess", &answer));
    TEST_ASSERT_EQUAL_INT(ANSWER_WAIT, answer.more);
    TEST_ASSERT_EQUAL_UINT32(2000, answer.wait_ms);
    console_is_refused("unlock secret", "BUSY");
    board_side_pass(2000);
    console_does("unlock secret");
    DO(operate_unlock(&other, "secret", &answer));
    was_recorded(EVENT_DO_UNLOCK, "", 0, ENGINEER);
    DO(operate_lock(&other, &answer));
    TEST_ASSERT_FALSE(operate_is_engineer(&other));
    TEST_ASSERT_TRUE(operate_is_engineer(&client));

    board_side_pass(99000);
    DO(number(&client, "loop1.ti", 1800));
    board_side_pass(1000);
    session_poll(&client);
    TEST_ASSERT_TRUE(operate_is_engineer(&client));
    board_side_pass(100000);
    session_poll(&client);
    TEST_ASSERT_FALSE(operate_is_engineer(&client));
    was_recorded(EVENT_DO_LOCK, "time", 0, ENGINEER);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_transaction_belongs_to_who_opened_it);
    RUN_TEST(a_proposal_is_not_accepted_into_the_transaction_of_another);
    RUN_TEST(while_one_saves_no_other_touches_the_settings);
    RUN_TEST(a_row_half_printed_keeps_its_plan);
    RUN_TEST(what_two_do_at_random_is_what_ought_to_be);
    RUN_TEST(each_client_has_its_own_level);
    return UNITY_END();
}
