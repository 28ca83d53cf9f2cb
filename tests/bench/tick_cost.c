/* The cost of a tick without the link: LOOPS (2 or 16, or 16 of which 8 are decoupled), TICKS. For a tool that counts
 * instructions (tools/bench): the ticks are those of bench_ticks(), which nothing else runs.
 *
 *     tick_cost 2|16|decoupled TICKS
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if __has_include("settings/parameters.h")
#include "settings/parameters.h"
#else /* another version */
#include "service/parameters.h"
#endif
#if __has_include("plan/plan_build.h")
#include "plan/plan_build.h"
#endif
#include "supervise/supervisor.h"

/* Other versions, beside which this one is measured, have other names (tick_cost.cmake). */
#ifdef BEFORE_MV_STATE
#define supervisor_bind_mv supervisor_bind_output
#define MV_STATE(s)        (s).output
#else
#define MV_STATE(s) (s).mv
#endif

static struct config config;
static struct plan plan;
static struct supervisor supervisor;
static struct event_queue events;
static struct tick_input input;

static void put(const char *name, const char *value)
{
    struct parameter p;
    if (parameter_find(name, &p) || parameter_set(&p, &config, value)) {
        fprintf(stderr, "set %s %s\n", name, value);
        exit(1);
    }
}

static void numbered(const char *format, unsigned i, const char *value)
{
    char name[40];
    snprintf(name, sizeof name, format, i);
    put(name, value);
}

static void configure(unsigned loops, unsigned decoupled)
{
    parameters_defaults(&config);
    for (unsigned i = 1; i <= loops; i++) {
        char y[12], u[12], l[12];
        snprintf(y, sizeof y, "y%u", i);
        snprintf(u, sizeof u, "u%u", i);
        snprintf(l, sizeof l, "l%u", i);
        numbered("meas%u.name", i, y);
        numbered("meas%u.filter", i, "5");
        numbered("mv%u.name", i, u);
        numbered("loop%u.name", i, l);
        numbered("loop%u.pv", i, y);
        numbered("loop%u.out", i, u);
        numbered("loop%u.ti", i, "60");
        numbered("loop%u.td", i, "5");
        if (i > decoupled)
            continue;
        numbered("loop%u.decouple", i, "on");
        for (unsigned k = 1; k <= decoupled; k++) {
            char name[40];
            snprintf(name, sizeof name, "decouple%u.d%u", i, k);
            put(name, i == k ? "1" : "-0.1");
        }
    }
}

__attribute__((noinline)) void bench_ticks(unsigned ticks, unsigned loops);
void bench_ticks(unsigned ticks, unsigned loops)
{
    for (unsigned n = 0; n < ticks; n++) {
        input.time_ms += 1000;
        for (unsigned i = 0; i < loops; i++)
            input.measurement[i] =
                (struct reading){40.0f + (float)((n * 7u + i) % 16u), QUALITY_GOOD};
        supervisor_validate(&supervisor, &input);
        supervisor_control(&supervisor);
    }
}

int main(int n, char **word)
{
    struct config_fault fault;
    bool decoupled = n == 3 && strcmp(word[1], "decoupled") == 0;
    unsigned loops = decoupled ? 16 : n == 3 ? (unsigned)atoi(word[1]) : 0;
    if (loops < 1 || loops > CONFIG_LOOPS) {
        fputs("tick_cost 2|16|decoupled TICKS\n", stderr);
        return 2;
    }
    configure(loops, decoupled ? 8 : 0);
    event_queue_init(&events);
    supervisor_init(&supervisor, &events);
    if (plan_build(&plan, &config, 1.0f, &fault) != ERR_OK) {
        fprintf(stderr, "%s%u.%s %s\n", fault.group, fault.index, fault.field, fault.wanted);
        return 1;
    }
    supervisor_take_plan(&supervisor, &plan);
    for (unsigned i = 0; i < CHANNEL_MAX; i++)
        input.measurement[i].quality = input.readback[i].quality = QUALITY_MISSING;
    for (uint8_t i = 0; i < (uint8_t)loops; i++) {
        supervisor_bind_measurement(&supervisor, i);
        supervisor_bind_mv(&supervisor, i);
    }
    bench_ticks(2, loops);
    for (uint8_t i = 0; i < (uint8_t)loops; i++) {
        struct request r = {.kind = REQUEST_MODE,
                            .loop = i,
                            .output = PLAN_NONE,
                            .mode = LOOP_AUTO,
                            .plan = plan.serial};
        if (!supervisor_request(&supervisor, &r))
            return 1;
    }
    unsigned ticks = (unsigned)atoi(word[2]);
    bench_ticks(ticks, loops);
    double sum = 0;
    for (unsigned i = 0; i < loops; i++)
        sum += (double)num_to_float(MV_STATE(supervisor)[i].constrained);
    printf("%u ticks of %u loops, outputs %.9g in all\n", ticks, loops, sum);
    return 0;
}
