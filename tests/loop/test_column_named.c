/* A block that names the table of a column: it is given the table, told when it becomes another, and refused when it names
 * something else. The kind that names it is only here: it reads the table and shows what it has read. */
#include "pasted_table.h"

#include "kinds/column/column.h"
#include "kinds/decoupler/decoupler.h"
#include "kinds/feedforward/feedforward.h"
#include "kinds/pid/pid.h"
#include "kinds/two_position/two_position.h"

struct reader_settings {
    uint16_t column;
};

struct reader {
    float stages, configured;
    const struct column_record *record;
};

static const struct block_parameter reader_parameters[] = {
    {.id = 5,
     .type = BLOCK_U16,
     .name = "column",
     .unit = "",
     .help = "block that has the table, 0: none",
     .lo = 0,
     .hi = 65535,
     .initial = 0},
};

static float times_configured;

static uint32_t reader_bytes(const struct block_setup *setup)
{
    (void)setup;
    return sizeof(struct reader);
}

static enum err reader_check(const struct block_setup *setup, struct block_fault *fault)
{
    struct column_table table;
    struct column_fault reason;
    if (!setup->named)
        return ERR_OK;
    enum err err = column_record_read(setup->named, &table, &reason);
    *fault = (struct block_fault){.field = "column", .wanted = "names a table that is none"};
    return err;
}

static enum err reader_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct reader *r = state;
    (void)retune;
    *r = (struct reader){.record = setup->named, .configured = ++times_configured};
    return ERR_OK;
}

/* As an estimator would: it looks into the table in every step. */
static void reader_step(void *state, struct block_io *io)
{
    struct reader *r = state;
    (void)io;
    r->stages = r->record ? r->record->value[COLUMN_TABLE_N_STAGES] : 0.0f;
}

static const char *reader_describe(const void *state, size_t i, float *value)
{
    const struct reader *r = state;
    *value = i == 0 ? r->stages : r->configured;
    return i == 0 ? "stages" : i == 1 ? "configured" : NULL;
}

static const struct block_kind reader_kind = {
    .name = "reader",
    .stage = STAGE_ESTIMATE,
    .parameter = reader_parameters,
    .parameters = 1,
    .settings_bytes = 4,
    .names = 5,
    .named_kind = "column",
    .bytes = reader_bytes,
    .check = reader_check,
    .configure = reader_configure,
    .step = reader_step,
    .describe = reader_describe,
};

const struct block_kind *const block_kinds[] = {
    &pid_kind, &two_position_kind, &decoupler_kind, &feedforward_kind, &column_kind, &reader_kind};
const uint8_t block_kind_count = sizeof block_kinds / sizeof block_kinds[0];

static struct table_lines splitter, pilot;

void setUp(void)
{
    memory_port_erase_all();
    if (!splitter.size) {
        splitter_table(&splitter);
        pilot_table(&pilot);
    }
    times_configured = 0.0f;
    running();
}

void tearDown(void) {}

/* A splitter's table in block 2, read by block 3. */
static void read_by_another(void)
{
    paste_lines(&splitter, 2, UINT32_MAX);
    ask_ok("set block3.kind reader");
    ask_ok("set block3.column 2");
    ask_ok("apply");
    samples(2);
}

static void shows(unsigned stages, unsigned configured)
{
    char line[40];
    ask_ok("block 3");
    snprintf(line, sizeof line, "  stages = %u\n", stages);
    TEST_ASSERT_TRUE_MESSAGE(said(line), board.said);
    snprintf(line, sizeof line, "  configured = %u\n", configured);
    TEST_ASSERT_TRUE_MESSAGE(said(line), board.said);
}

static void who_names_a_table_is_given_it(void)
{
    read_by_another();
    shows(37, 1);
    ask_ok("set block3.column 0");
    samples(2);
    shows(0, 2);
}

static void who_names_anything_else_is_refused(void)
{
    static const char wanted[] =
        "block3.column: 'column' must be the kind of the block it is the number of";
    read_by_another();
    static const char *const bad[] = {"1", "3", "4", "5", "65535"};
    for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        char line[40];
        snprintf(line, sizeof line, "set block3.column %s", bad[i]);
        ask_refused(line, "UNKNOWN");
        TEST_ASSERT_TRUE_MESSAGE(said(wanted), board.said);
    }
    ask_refused("set block2.kind -", "UNKNOWN");
    TEST_ASSERT_TRUE_MESSAGE(said(wanted), board.said);
    shows(37, 1);
}

static void another_table_is_told_and_an_equal_one_is_not(void)
{
    read_by_another();
    ask_ok("set loop1.gain 1.1");
    samples(2);
    paste(&splitter, 2); /* once more, in another place until it is in force */
    samples(2);
    shows(37, 1);
    paste(&pilot, 2);
    samples(2);
    shows(12, 2);
    for (unsigned i = 0; i < 4; i++) { /* what is staged is not what is read */
        paste_lines(&splitter, 2, UINT32_MAX);
        samples(2);
        shows(12, 2);
        ask_ok("abandon");
    }
    ask_ok("set loop1.gain 1.2");
    samples(2);
    shows(12, 2);
}

static void both_come_back_after_a_restart_and_a_load(void)
{
    read_by_another();
    ask_ok("save");
    ask_ok("load");
    samples(2);
    shows(37, 1);
    power_on();
    connect_plant();
    samples(1);
    pass(1000);
    samples(2);
    shows(37, 2);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(who_names_a_table_is_given_it);
    RUN_TEST(who_names_anything_else_is_refused);
    RUN_TEST(another_table_is_told_and_an_equal_one_is_not);
    RUN_TEST(both_come_back_after_a_restart_and_a_load);
    plant_library_free();
    return UNITY_END();
}
