/* The whole firmware on the board in memory, its plant the small linear column behind the bench's own instruments, which make
 * the faults; one sample after the other, each answered, each command within its span. */
#ifndef REFLUX_TESTS_FAULT_BENCH_H
#define REFLUX_TESTS_FAULT_BENCH_H

#include "bench/events.h"
#include "board_bench.h"
#include "instruments.h"
#include "matrix_column.h"

static struct instruments instruments;
static char err[512];

/* ---- one sample after the other ---- */

#ifndef AT_ONCE
#define AT_ONCE 6u
#endif

static bool waits =
    true; /* the plant, for its answer; else it sends so many samples at once before the board gets to run */

static inline void sample_comes(void)
{
    struct frame f;
    struct link_sample sample;
    instruments_measure(&instruments, &column, 1.0, &sample);
    board.number++;
    board.time_ms += 1000;
    sample.number = board.number;
    sample.time_ms = board.time_ms;
    pack_sample(&sample, &f);
    link_give(&f);
}

static inline void plant_goes_on(void)
{
    instruments_command(&instruments, &board.command);
    TEST_ASSERT_TRUE(instruments_drive(&instruments, &column, 1.0, err, sizeof err));
    TEST_ASSERT_TRUE(advance(&column, column.time_s + 1.0, err, sizeof err));
}

static inline void step(void)
{
    unsigned before = board.commands, n = waits ? 1u : AT_ONCE;
    for (unsigned k = 1; k < n; k++) {
        sample_comes();
        plant_goes_on();
    }
    sample_comes();
    board_run();
    if (!board.ready || board.mute)
        return;
    TEST_ASSERT_EQUAL(before + n, board.commands); /* whatever comes, it is answered */
    for (unsigned j = 0; j < 2; j++) {
        float u = board.command.output[j].value;
        TEST_ASSERT_TRUE(u >= (float)channels[j].lo && u <= (float)channels[j].hi);
    }
    plant_goes_on();
}

static inline void steps(unsigned n)
{
    while (n--)
        step();
}

/* ---- faults ---- */

static inline void event(const char *what)
{
    static struct events events;
    char text[80];
    if (!what)
        return;
    memset(&events, 0, sizeof events);
    snprintf(text, sizeof text, "0:%s", what);
    TEST_ASSERT_TRUE_MESSAGE(events_add(&events, &class, text, err, sizeof err), err);
    TEST_ASSERT_TRUE_MESSAGE(events_apply(&events, 0, &column, &instruments, err, sizeof err), err);
}

/* ---- what the console says ---- */

static inline bool loop_is(const char *loop, const char *mode)
{
    char text[40];
    ask_ok("loop");
    snprintf(text, sizeof text, "%s %s ", loop, mode);
    return said(text);
}

static inline bool alarm_says(const char *text)
{
    ask_ok("alarm");
    return said(text);
}

static inline bool quality_is(const char *measurement, const char *quality)
{
    ask_ok("status");
    for (unsigned i = 0; i < n_reply; i++)
        if (strncmp(reply[i], measurement, strlen(measurement)) == 0 &&
            reply[i][strlen(measurement)] == ' ')
            return strstr(reply[i], quality) != NULL;
    return false;
}

/* ---- the table of tests/loop/fault-matrix.md ---- */

/* The text of row f of the test's own table. */
typedef void fault_row(unsigned f, char *line, size_t size);

static inline void document_has_rows(unsigned rows, fault_row *row)
{
    static char page[60000];
    char line[240];
    FILE *file = fopen("loop/fault-matrix.md", "r");
    TEST_ASSERT_NOT_NULL(file);
    page[fread(page, 1, sizeof page - 1, file)] = '\0';
    fclose(file);
    for (unsigned f = 0; f < rows; f++) {
        row(f, line, sizeof line);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(page, line), line);
    }
}

/* With the argument `table` a test prints its rows for the page instead. */
static inline bool prints_rows(int argc, char **argv, unsigned rows, fault_row *row)
{
    char line[240];
    if (argc != 2 || strcmp(argv[1], "table") != 0)
        return false;
    for (unsigned f = 0; f < rows; f++) {
        row(f, line, sizeof line);
        fputs(line, stdout);
    }
    return true;
}

#endif
