/* A record of the column of Kotyk and Machacek (1995) with PRBS on both inputs at the same time; noise of the measurement
 * if wanted. Sizes of the test signals and of the noise are ours. */
#ifndef REFLUX_TESTS_KOTYK_RECORD_H
#define REFLUX_TESTS_KOTYK_RECORD_H

#include "identify/arx_fit.h"
#include "identify/prbs.h"
#include "kotyk_model.h"
#include "num/random.h"

#define KOTYK_SAMPLES 2046 /* twice the period of ten bits */

static real_t kotyk_u[KOTYK_SAMPLES][2], kotyk_y[KOTYK_SAMPLES][2];

static inline struct arx_data kotyk_record(uint32_t samples, real_t noise, uint64_t seed)
{
    const struct difference_model model = kotyk_column();
    const struct prbs_settings settings = {
        .inputs = 2, .bits = 10, .clock = 1, .amplitude = {1, 1}, .independence = PRBS_SHIFTS};
    struct difference_state state = {0};
    struct random random = random_from(seed);
    struct prbs prbs;
    real_t y[2] = {0};
    prbs_init(&prbs, &settings);
    for (uint32_t k = 0; k < samples; k++) {
        for (int i = 0; i < 2; i++)
            kotyk_y[k][i] = noise > 0 ? y[i] + noise * random_normal(&random) : y[i];
        prbs_step(&prbs, kotyk_u[k]);
        difference_step(&model, &state, kotyk_u[k], y);
    }
    return (struct arx_data){
        .samples = samples, .outputs = 2, .inputs = 2, .u = &kotyk_u[0][0], .y = &kotyk_y[0][0]};
}

#endif
