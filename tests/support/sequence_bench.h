/* supervisor_bench.h with a small tank beside the column: cooling water, a level by feed and draw, a heater, and
 * the rows of a start-up and a shut-down. The tank is linear; a test may take any reading out of its hands. */
#ifndef REFLUX_TESTS_SEQUENCE_BENCH_H
#define REFLUX_TESTS_SEQUENCE_BENCH_H

#include "supervisor_bench.h"

enum { LEVEL = 4, FLOW = 5 }; /* measurements after those of the bench */
enum { DRAW = 3, COOL = 4, INLET = 5 };
enum { LEVEL_LOOP = 2 };

/* Rows of the start, 0-based; the numbers people see are one higher. */
enum {
    ROW_COOL,
    ROW_GUARD,
    ROW_FILL,
    ROW_HEAT,
    ROW_OFFSET,
    ROW_REFLUX,
    ROW_CONFIRM,
    ROW_DRAW,
    ROW_DRAW_SP,
    ROW_AUTO,
    ROW_SP,
    ROW_STEADY,
    ROW_STOP_HEAT,
    ROW_STOP_WAIT,
    ROW_STOP_COOL
};

struct tank {
    double level, temperature, flow;
    bool level_mine, temperature_mine, flow_mine; /* the test gives the reading */
};
static struct tank tank;

static inline void bench_rows(void)
{
    static const char *const pairs[] = {
        /* channels */
        "meas5.name", "level", "meas5.unit", "cm", "meas5.hi", "40", "meas5.hold", "10",
        "meas5.offset", "8", "meas6.name", "CW", "meas6.unit", "l/h", "meas6.hi", "100",
        "meas6.hold", "10", "mv4.name", "draw", "mv5.name", "cool", "mv6.name", "inlet",
        /* the level by two positions */
        "loop3.name", "sump", "loop3.pv", "level", "loop3.out", "draw", "loop3.algorithm",
        "two_position", "loop3.action", "direct", "loop3.band", "2", "loop3.out_hi", "0.6",
        "loop3.out_lo", "0.1",
        /* start */
        "step1.seq", "start", "step1.do", "out", "step1.what", "cool", "step1.value", "60",
        "step1.until", "above", "step1.meas", "CW", "step1.limit", "30", "step1.hold", "5",
        "step1.timeout", "60",
        /* cooling stays */
        "step2.seq", "start", "step2.do", "guard", "step2.until", "above", "step2.meas", "CW",
        "step2.limit", "20", "step2.hold", "5",
        /* fill */
        "step3.seq", "start", "step3.do", "out", "step3.what", "inlet", "step3.value", "50",
        "step3.until", "above", "step3.meas", "level", "step3.limit", "20", "step3.timeout", "300",
        /* heat until it boils */
        "step4.seq", "start", "step4.do", "out", "step4.what", "heat", "step4.value", "0.9",
        "step4.until", "above", "step4.meas", "T10", "step4.limit", "100", "step4.hold", "10",
        "step4.timeout", "600", "step4.else", "hold",
        /* from now on the level reads too high */
        "step5.seq", "start", "step5.do", "offset_on", "step5.what", "level",
        /* total reflux */
        "step6.seq", "start", "step6.until", "time", "step6.hold", "60",
        /* a person looks */
        "step7.seq", "start", "step7.until", "confirm",
        /* the loops */
        "step8.seq", "start", "step8.do", "auto", "step8.what", "sump", "step9.seq", "start",
        "step9.do", "sp", "step9.what", "sump", "step9.value", "15", "step10.seq", "start",
        "step10.do", "auto", "step10.what", "bottom", "step11.seq", "start", "step11.do", "sp",
        "step11.what", "bottom", "step11.value", "118",
        /* done when it stands */
        "step12.seq", "start", "step12.until", "steady", "step12.meas", "T10", "step12.limit", "2",
        "step12.hold", "30", "step12.timeout", "900", "step12.else", "go_on",
        /* stop */
        "step13.seq", "stop", "step13.do", "out", "step13.what", "heat", "step13.value", "0",
        "step14.seq", "stop", "step14.until", "below", "step14.meas", "T10", "step14.limit", "80",
        "step14.timeout", "7200", "step15.seq", "stop", "step15.do", "out", "step15.what", "cool",
        "step15.value", "0", NULL};
    put_all(pairs);
}

/* One second of the tank, by what was sent. */
static inline void tank_tick(void)
{
    tank.flow += (sent(COOL) * 100 - tank.flow) * 0.2;
    tank.temperature += (60 + 70 * sent(HEAT) * 2 - tank.temperature) * 0.01;
    tank.level += sent(INLET) * 0.1 - sent(DRAW) * 0.2;
    tank.level = tank.level < 0 ? 0 : tank.level > 40 ? 40 : tank.level;
    if (!tank.flow_mine)
        reading(FLOW, tank.flow);
    if (!tank.temperature_mine)
        reading(T10, tank.temperature);
    if (!tank.level_mine) /* boiling pushes the reading up */
        reading(LEVEL, tank.level + (tank.temperature > 95 ? 8 : 0));
    tick();
}

static inline void tank_ticks(unsigned n)
{
    while (n--)
        tank_tick();
}

static inline void seq_at(enum sequence_command what, uint8_t row)
{
    struct request r = {.kind = REQUEST_SEQUENCE,
                        .loop = PLAN_NONE,
                        .output = row,
                        .mode = (uint8_t)what,
                        .plan = bench.s.plan->serial};
    (void)supervisor_request(&bench.s, &r);
    bench_events();
}

static inline void seq(enum sequence_command what)
{
    seq_at(what, bench.s.sequence.step);
}

static inline const struct sequence *seq_state(void)
{
    return &bench.s.sequence;
}

/* Ticks until it stands at this row (or is no longer active), at most n. Returns whether it does. */
static inline bool reaches(uint8_t row, unsigned n)
{
    while (n-- && !(sequence_active(seq_state()) && seq_state()->step == row && seq_state()->acted))
        tank_tick();
    return sequence_active(seq_state()) && seq_state()->step == row;
}

static inline unsigned ended(enum event_code code, enum sequence_reason reason)
{
    unsigned n = 0;
    bench_events();
    for (unsigned i = 0; i < bench.n_seen; i++)
        n += bench.seen[i].code == code && (bench.seen[i].detail & 15) == reason;
    return n;
}

static inline void start_bench_with(void (*more)(void))
{
    bench_start_with(more ? more : bench_rows);
    out(TOP, 0);
    out(BOTTOM, 0);
    memset(&tank, 0, sizeof tank);
    tank.temperature = 60;
    tank.level = 15;
    tank_ticks(2);
    bench_forget_events();
}

static inline void started_at(uint8_t row)
{
    seq(SEQUENCE_DO_START);
    for (unsigned n = 0; n < 5000 && !(seq_state()->step == row && seq_state()->acted); n++) {
        tank_tick();
        if (seq_state()->state == SEQUENCE_CONFIRM && seq_state()->step != row)
            seq(SEQUENCE_DO_CONFIRM);
    }
    TEST_ASSERT_EQUAL(row, seq_state()->step);
    TEST_ASSERT_TRUE(sequence_active(seq_state()));
}

#endif
