/* Proposals of the self-tuner, step by step: parameters in use that differ from the settings are offered once, until the settings have
 * them or the offer fails. */
#include <string.h>

#include "gmv_bench.h"
#include "kinds/gmv/gmv_proposals_state.h"
#include "kinds/gmv/gmv_settings.h"
#include "unity.h"

static struct gmv_bench b;
static struct gmv_proposals s;
static struct block_proposal room;

/* One loop with two parameters; the second one differs from the settings. */
void setUp(void)
{
    memset(&b, 0, sizeof b);
    memset(&s, 0, sizeof s);
    memset(&room, 0, sizeof room);
    b.config = gmv_plain_config(1);
    b.config.theta[0][0] = 0.5f;
    b.config.theta[0][1] = 0.25f;
    gmv_bench_begin(&b, 0);
    gmv_proposals_configure(&s, b.config.theta);
    gmv_use(b.gmv, 0, 1, num_from_float(0.125f));
    gmv_proposals_begin(&s, b.gmv);
}

void tearDown(void) {}

static enum gmv_answer step(bool ask)
{
    room.n = 0;
    return gmv_proposals_step(&s, b.gmv, &room, ask);
}

static void parameters_that_differ_are_offered(void)
{
    TEST_ASSERT_EQUAL(GMV_NO_ANSWER, step(false));
    TEST_ASSERT_EQUAL_UINT(1, room.n);
    TEST_ASSERT_EQUAL(PROPOSAL_AT_ONCE, room.manner);
    TEST_ASSERT_EQUAL_FLOAT(0.125f, room.value[0].value);
    TEST_ASSERT_TRUE(gmv_proposals_open(&s));
}

static void with_ask_the_operator_must_accept(void)
{
    (void)step(true);
    TEST_ASSERT_EQUAL(PROPOSAL_WHEN_ACCEPTED, room.manner);
}

static void a_rejected_proposal_is_not_offered_again(void)
{
    (void)step(false);
    TEST_ASSERT_EQUAL(GMV_REJECTED, step(false));
    TEST_ASSERT_EQUAL_UINT(0, room.n);
    TEST_ASSERT_FALSE(gmv_proposals_open(&s));
    TEST_ASSERT_EQUAL_UINT(0, gmv_proposals_stored(&s));
    TEST_ASSERT_EQUAL(GMV_NO_ANSWER, step(false));
    TEST_ASSERT_EQUAL_UINT(0, room.n);
}

static void a_proposal_is_accepted_when_the_settings_have_it(void)
{
    (void)step(false);
    b.config.theta[0][1] = 0.125f;
    gmv_proposals_configure(&s, b.config.theta);
    TEST_ASSERT_EQUAL(GMV_ACCEPTED, step(false));
    TEST_ASSERT_EQUAL_UINT(0, room.n);
    TEST_ASSERT_EQUAL_UINT(2, gmv_proposals_stored(&s));
}

static void without_room_nothing_is_offered(void)
{
    TEST_ASSERT_EQUAL(GMV_NO_ANSWER, gmv_proposals_step(&s, b.gmv, NULL, false));
    TEST_ASSERT_TRUE(gmv_proposals_open(&s));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(parameters_that_differ_are_offered);
    RUN_TEST(with_ask_the_operator_must_accept);
    RUN_TEST(a_rejected_proposal_is_not_offered_again);
    RUN_TEST(a_proposal_is_accepted_when_the_settings_have_it);
    RUN_TEST(without_room_nothing_is_offered);
    return UNITY_END();
}
