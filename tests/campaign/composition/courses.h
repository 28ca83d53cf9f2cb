/* Changes that nobody tells the block in the campaign of compositions. */
#ifndef REFLUX_CAMPAIGN_COURSES_H
#define REFLUX_CAMPAIGN_COURSES_H

#include <stdbool.h>

#define REST    "rest"
#define COUNTED 17 /* of the cases below; the others are only printed */

struct course {
    const char *name;
    double pressure, z, flow, loss, bias; /* mmHg, mole fraction, part, part, K */
    unsigned biased;
    double lag_s, noise, efficiency; /* s, K, of the model's; 0: as in plain cases, and 1 */
    bool feeds, has_meter, has_pressure;
};

#define PLAIN_LAG_S 5
#define PLAIN_NOISE 0.05

static const struct course courses[] = {
    {.name = REST},
    {"feed composition +0.03", .z = 0.03},
    {"feed composition -0.03", .z = -0.03},
    {"feed flow -15 %", .flow = -0.15},
    {"feed flow -15 %, metered", .flow = -0.15, .has_meter = true},
    {"+20 mmHg", .pressure = 20},
    {"-20 mmHg", .pressure = -20},
    {"+20 mmHg, measured", .pressure = 20, .has_pressure = true},
    {"heat loss 5 %", .loss = 0.05},
    {"+0.5 K on the first", .bias = 0.5, .biased = 0},
    {"+0.5 K on the second", .bias = 0.5, .biased = 1},
    {"+0.5 K on the third", .bias = 0.5, .biased = 2},
    {"+0.5 K on the fourth", .bias = 0.5, .biased = 3},
    {"lag 60 s", .lag_s = 60},
    {"noise 0.3 K", .noise = 0.3},
    {"changes of the feed", .feeds = true},
    {"changes of the feed, metered", .feeds = true, .has_meter = true},
    {"efficiency 80 %", .efficiency = 0.8},
    {"+2 K on the first", .bias = 2},
};
_Static_assert(sizeof courses / sizeof courses[0] == COUNTED + 2, "apart from two");

#endif
