/* Refused settings: not taken, and the fault is named. */
#ifndef REFLUX_TESTS_REFUSAL_H
#define REFLUX_TESTS_REFUSAL_H

#include "interact/plant.h"
#include "unity.h"

static inline void expect_refusal(enum err err, const struct interact_refusal *reason,
                                  const char *field)
{
    TEST_ASSERT_TRUE(err == ERR_RANGE || err == ERR_NOT_FINITE);
    TEST_ASSERT_EQUAL_STRING(field, reason->field);
}

#endif
