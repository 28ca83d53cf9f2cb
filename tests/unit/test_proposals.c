/* Proposals of blocks in the tick: one place, which the main loop frees. The kinds are of this test alone. */
#include "verb_bench.h"

#include "supervise/proposals.h"

void setUp(void)
{
    memset(&watch_proposes, 0, sizeof watch_proposes);
    memset(&pair_proposes, 0, sizeof pair_proposes);
    pair_is_spent = pair_gives_up = false;
    no_room = 0;
}
void tearDown(void) {}

static void put_proposal(struct block_proposal *p, uint32_t id, float value)
{
    p->value[p->n++] = (struct proposed_value){id, value};
}

static void an_id_of_the_contract_is_the_parameter_it_is_called_after(void)
{
    const struct {
        uint32_t id;
        const char *name;
    } all[] = {
        {proposed_setting(PROPOSED_LOOP_GAIN, 1), "loop2.gain"},
        {proposed_setting(PROPOSED_LOOP_TI, 0), "loop1.ti"},
        {proposed_setting(PROPOSED_LOOP_TD, 0), "loop1.td"},
        {proposed_setting(PROPOSED_LOOP_B, 2), "loop3.b"},
        {proposed_setting(PROPOSED_DECOUPLE_D1, 2), "decouple3.d1"},
        {proposed_setting(PROPOSED_DECOUPLE_D1, 0) + 0x40, "decouple1.d2"},
        {proposed_setting(PROPOSED_FF_GAIN, 3), "ff4.gain"},
        {proposed_setting(PROPOSED_FF_LEAD, 0), "ff1.lead"},
        {proposed_setting(PROPOSED_FF_LAG, 0), "ff1.lag"},
        {proposed_setting(PROPOSED_FF_DEAD, 0), "ff1.dead"},
        {(proposed_own(1) & ~PROPOSED_SELF) | WATCH, "block1.limit"},
    };
    bench_start_with(watch_and_pair);
    for (unsigned i = 0; i < sizeof all / sizeof all[0]; i++) {
        struct parameter by_id, by_name;
        char name[40] = "";
        struct text t = text_on(name, sizeof name);
        TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, parameter_find_in(&bench.config, all[i].name, &by_name),
                                  all[i].name);
        TEST_ASSERT_EQUAL_HEX32_MESSAGE(parameter_id(&by_name), all[i].id, all[i].name);
        TEST_ASSERT_EQUAL(ERR_OK, parameter_find_id(&bench.config, all[i].id, &by_id));
        parameter_name(&by_id, &t);
        TEST_ASSERT_EQUAL_STRING(all[i].name, name);
    }
}

static void what_a_step_proposes_waits_for_the_main_loop_and_is_not_written_over(void)
{
    bench_start_with(watch_and_pair);
    put_proposal(&watch_proposes, proposed_setting(PROPOSED_LOOP_GAIN, 0), 3);
    tick();
    TEST_ASSERT_EQUAL(PROPOSAL_GIVEN, bench.s.proposal.state);
    TEST_ASSERT_EQUAL_UINT8(WATCH, bench.s.proposal.block);
    TEST_ASSERT_EQUAL_UINT32(bench.s.plan->serial, bench.s.proposal.plan);
    TEST_ASSERT_EQUAL_UINT8(PROPOSAL_WHEN_ACCEPTED, bench.s.proposal.content.manner);
    put_proposal(&watch_proposes, proposed_setting(PROPOSED_LOOP_GAIN, 0), 4);
    ticks(3);
    TEST_ASSERT_EQUAL_UINT(3, no_room);
    TEST_ASSERT_EQUAL_FLOAT(3, bench.s.proposal.content.value[0].value);
    bench.s.proposal.state = PROPOSAL_FREE;
    tick();
    TEST_ASSERT_EQUAL_FLOAT(4, bench.s.proposal.content.value[0].value);
    TEST_ASSERT_EQUAL(PROPOSAL_GIVEN, bench.s.proposal.state);
}

static void a_step_that_proposes_nothing_leaves_the_place_free(void)
{
    bench_start_with(watch_and_pair);
    ticks(3);
    TEST_ASSERT_EQUAL(PROPOSAL_FREE, bench.s.proposal.state);
}

static void of_two_in_one_tick_the_first_has_the_place(void)
{
    bench_start_with(watch_and_pair);
    mode(TOP, LOOP_AUTO);
    put_proposal(&watch_proposes, proposed_setting(PROPOSED_LOOP_GAIN, 0), 3);
    put_proposal(&pair_proposes, proposed_setting(PROPOSED_LOOP_GAIN, 1), 4);
    tick();
    TEST_ASSERT_EQUAL_UINT8(WATCH, bench.s.proposal.block);
    TEST_ASSERT_EQUAL_UINT(1, no_room);
    bench.s.proposal.state = PROPOSAL_FREE;
    tick();
    TEST_ASSERT_EQUAL_UINT8(PAIR, bench.s.proposal.block);
}

static void what_is_its_own_is_named_with_its_number(void)
{
    bench_start_with(watch_and_pair);
    mode(TOP, LOOP_AUTO);
    put_proposal(&pair_proposes, proposed_own(1), 0.25f);
    put_proposal(&pair_proposes, proposed_setting(PROPOSED_LOOP_GAIN, 1), 4);
    put_proposal(&pair_proposes, proposed_setting(PROPOSED_LOOP_GAIN, PROPOSED_SELF), 4);
    tick();
    struct parameter p;
    char name[40] = "";
    struct text t = text_on(name, sizeof name);
    TEST_ASSERT_EQUAL(ERR_OK,
                      parameter_find_id(&bench.config, bench.s.proposal.content.value[0].id, &p));
    parameter_name(&p, &t);
    TEST_ASSERT_EQUAL_STRING("block2.rate", name);
    TEST_ASSERT_EQUAL_HEX32(0x4101, bench.s.proposal.content.value[1].id);
    TEST_ASSERT_EQUAL_HEX32(0x413F,
                            bench.s.proposal.content.value[2].id); /* a loop like any other */
}

static void a_block_that_gives_up_in_that_step_proposes_nothing(void)
{
    bench_start_with(watch_and_pair);
    mode(TOP, LOOP_AUTO);
    tick();
    put_proposal(&pair_proposes, proposed_own(1), 0.25f);
    pair_gives_up = true;
    tick();
    TEST_ASSERT_EQUAL(PROPOSAL_FREE, bench.s.proposal.state);
}

/* A kind that does not mention the manner means the one that waits. */
static void one_that_says_nothing_of_its_manner_waits_although_the_one_before_did_not(void)
{
    bench_start_with(watch_and_pair);
    watch_proposes.manner = PROPOSAL_AT_ONCE;
    put_proposal(&watch_proposes, proposed_setting(PROPOSED_LOOP_GAIN, 0), 3);
    tick();
    TEST_ASSERT_EQUAL_UINT8(PROPOSAL_AT_ONCE, bench.s.proposal.content.manner);
    bench.s.proposal.state = PROPOSAL_FREE;
    const struct block_proposal *room = proposal_room(&bench.s);
    TEST_ASSERT_NOT_NULL(room);
    TEST_ASSERT_EQUAL_UINT8(0, room->n);
    TEST_ASSERT_EQUAL_UINT8(PROPOSAL_WHEN_ACCEPTED, room->manner);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(an_id_of_the_contract_is_the_parameter_it_is_called_after);
    RUN_TEST(what_a_step_proposes_waits_for_the_main_loop_and_is_not_written_over);
    RUN_TEST(a_step_that_proposes_nothing_leaves_the_place_free);
    RUN_TEST(of_two_in_one_tick_the_first_has_the_place);
    RUN_TEST(what_is_its_own_is_named_with_its_number);
    RUN_TEST(a_block_that_gives_up_in_that_step_proposes_nothing);
    RUN_TEST(one_that_says_nothing_of_its_manner_waits_although_the_one_before_did_not);
    return UNITY_END();
}
