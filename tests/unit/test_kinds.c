/* Whatever a kind of blocks does, its rows must be such that the console, storage and the tick can use them. The table is the
 * one this test is linked with: the product's, and that of the worked family. */
#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "base/channel.h"
#include "block/block.h"
#include "unity.h"

static const struct block_kind *kind;
static char about[80];

void setUp(void) {}
void tearDown(void) {}

#define ASSERT_OF(what, condition)                                                                 \
    do {                                                                                           \
        snprintf(about, sizeof about, "%s.%s", kind->name, what);                                  \
        TEST_ASSERT_TRUE_MESSAGE(condition, about);                                                \
    } while (0)

static bool is_name(const char *name, size_t longest)
{
    if (!name || !name[0] || strlen(name) > longest)
        return false;
    for (const char *c = name; *c; c++)
        if (!islower((unsigned char)*c) && !isdigit((unsigned char)*c) && *c != '_')
            return false;
    return true;
}

static void each_has_a_name_of_its_own_that_a_setting_can_hold(void)
{
    for (unsigned k = 0; k < block_kind_count; k++) {
        kind = block_kinds[k];
        ASSERT_OF("name", is_name(kind->name, CHANNEL_NAME_SIZE - 1));
        for (unsigned other = 0; other < k; other++)
            ASSERT_OF("name", strcmp(kind->name, block_kinds[other]->name) != 0);
    }
}

static void each_has_the_functions_that_its_stage_calls(void)
{
    for (unsigned k = 0; k < block_kind_count; k++) {
        kind = block_kinds[k];
        ASSERT_OF("bytes", kind->bytes);
        ASSERT_OF("check", kind->check);
        ASSERT_OF("configure", kind->configure);
        ASSERT_OF("step", kind->step);
        bool back = kind->stage == STAGE_CONTROL || kind->stage == STAGE_COMPENSATE;
        ASSERT_OF("back_calculate", !back || kind->back_calculate);
        bool follows = kind->stage == STAGE_CONTROL || kind->stage == STAGE_FEED_FORWARD;
        ASSERT_OF("follow", !follows || kind->follow);
        ASSERT_OF("shift", !kind->algorithms || kind->shift);
    }
}

#if CONFIG_BLOCKS

static unsigned size_of(const struct block_parameter *p)
{
    unsigned one = p->type == BLOCK_FLOAT ? 4 : p->type == BLOCK_U16 ? 2 : 1;
    return one * (p->rows ? p->rows : 1u) * (p->cols ? p->cols : 1u);
}

static void a_parameter_has_an_id_a_name_a_place_and_a_default_in_its_range(void)
{
    for (unsigned k = 0; k < block_kind_count; k++) {
        kind = block_kinds[k];
        ASSERT_OF("settings_bytes", kind->settings_bytes % 4 == 0);
        for (unsigned i = 0; i < kind->parameters; i++) {
            const struct block_parameter *p = &kind->parameter[i];
            ASSERT_OF(p->name, is_name(p->name, CHANNEL_NAME_SIZE - 1) && p->help && p->unit);
            ASSERT_OF(p->name, p->id >= 1 && p->id <= 127);
            ASSERT_OF(p->name, p->offset + size_of(p) <= kind->settings_bytes);
            ASSERT_OF(p->name,
                      p->type == BLOCK_WORD || p->offset % (p->type == BLOCK_U16 ? 2 : 4) == 0);
            ASSERT_OF(p->name,
                      p->type == BLOCK_WORD ? strchr(p->unit, '|') != NULL : p->lo <= p->hi);
            ASSERT_OF(p->name,
                      p->type == BLOCK_WORD || (p->lo <= p->initial && p->initial <= p->hi));
            for (unsigned j = 0; j < i; j++) {
                const struct block_parameter *q = &kind->parameter[j];
                ASSERT_OF(p->name, p->id != q->id && strcmp(p->name, q->name) != 0);
                ASSERT_OF(p->name, p->offset >= q->offset + size_of(q) ||
                                       q->offset >= p->offset + size_of(p));
            }
        }
    }
}

static void it_asks_for_no_more_than_a_block_can_have(void)
{
    for (unsigned k = 0; k < block_kind_count; k++) {
        kind = block_kinds[k];
        ASSERT_OF("members_most", kind->members_most <= BLOCK_MEMBERS_MAX);
        ASSERT_OF("inputs_most", kind->inputs_most <= BLOCK_INPUTS_MAX);
        ASSERT_OF("points_most", kind->points_most <= BLOCK_POINTS_MAX);
        ASSERT_OF("events", kind->events <= BLOCK_EVENTS_MAX);
    }
}

static void verbs_and_events_have_names_that_an_event_can_hold(void)
{
    for (unsigned k = 0; k < block_kind_count; k++) {
        kind = block_kinds[k];
        for (unsigned i = 0; i < kind->verbs; i++) {
            const struct block_verb *v = &kind->verb[i];
            ASSERT_OF(v->name, is_name(v->name, BLOCK_WORD_MAX) && v->help && v->run);
            ASSERT_OF(v->name, strcmp(v->name, "on") != 0 && strcmp(v->name, "off") != 0);
            ASSERT_OF(v->name, !v->number || v->lo <= v->hi);
            for (unsigned j = 0; j < i; j++)
                ASSERT_OF(v->name, strcmp(v->name, kind->verb[j].name) != 0);
        }
        for (unsigned i = 0; i < kind->events; i++) {
            const struct block_event *e = &kind->event[i];
            ASSERT_OF(e->code, is_name(e->code, BLOCK_WORD_MAX) && e->words);
            for (unsigned j = 0; j < i; j++)
                ASSERT_OF(e->code, strcmp(e->code, kind->event[j].code) != 0);
        }
    }
}

#endif

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(each_has_a_name_of_its_own_that_a_setting_can_hold);
    RUN_TEST(each_has_the_functions_that_its_stage_calls);
#if CONFIG_BLOCKS
    RUN_TEST(a_parameter_has_an_id_a_name_a_place_and_a_default_in_its_range);
    RUN_TEST(it_asks_for_no_more_than_a_block_can_have);
    RUN_TEST(verbs_and_events_have_names_that_an_event_can_hold);
#endif
    return UNITY_END();
}
