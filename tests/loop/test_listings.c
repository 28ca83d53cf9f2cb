/* Replies of `status`, `loop`, `stats`, `tune` and rows of `log`, to the letter and the last digit. Values are such that
 * float and Q7.24 hold them exactly. */
#include "board_bench.h"

void setUp(void)
{
    running();
    board.values[1] = 110; /* half of its span */
    samples(1);
}
void tearDown(void) {}

/* Sets in one transaction and has it in force: pairs of parameter and value, NULL ends them. */
static void with(const char *const *settings)
{
    char line[80];
    ask_ok("begin");
    for (; settings[0]; settings += 2) {
        snprintf(line, sizeof line, "set %s %s", settings[0], settings[1]);
        ask_ok(line);
    }
    ask_ok("apply");
    samples(1);
}

#define WITH(...) with((const char *const[]){__VA_ARGS__, NULL})

#define OPEN "engineer level open: no key is set (`key NEW` sets one)"

/* Line of the last reply that begins so. */
static const char *line_of(const char *begin)
{
    for (unsigned i = 0; i < n_reply; i++)
        if (strncmp(reply[i], begin, strlen(begin)) == 0)
            return reply[i];
    TEST_FAIL_MESSAGE(begin);
    return "";
}

/* ---- status ---- */

static void status_says_state_link_time_and_every_channel(void)
{
    ANSWERS("status",
            "state safe, plant link ready handmade, plant time 6.000 s, base tick 1 s ticks 6, "
            "storage ok",
            OPEN, "T1 = 85 degC good", "T10 = 110 degC good", "reflux = 0 l/h", "heat = 0.5 kW");
    ask_ok("out heat 1.5");
    ask_ok("begin");
    samples(1);
    ANSWERS("status",
            "state run, plant link ready handmade, plant time 7.000 s, base tick 1 s ticks 7, "
            "transaction open, storage ok",
            OPEN, "T1 = 85 degC good", "T10 = 110 degC good", "reflux = 0 l/h", "heat = 1.5 kW");
}

static void status_tells_a_link_that_is_down_and_one_that_greets(void)
{
    board.mute = true;
    pass(3000);
    ask_ok("status");
    TEST_ASSERT_EQUAL_STRING_LEN("state safe, plant link down, plant time 6.000 s", reply[0], 47);
    board.mute = false;
    board.deaf_to_pages = true;
    pass(1500);
    ask_ok("status");
    TEST_ASSERT_EQUAL_STRING_LEN("state safe, plant link greeting, plant time", reply[0], 43);
}

/* Held for a minute, as meas2.hold says; then what the plant says of it. */
static void status_says_how_good_each_measurement_is(void)
{
    static const char *const at_once[] = {"good", "uncertain", "uncertain", "uncertain"};
    static const char *const later[] = {"good", "uncertain", "bad", "bad"};
    char line[60];
    for (uint8_t q = 0; q < 4; q++) {
        board.quality[1] = q;
        samples(1);
        ask_ok("status");
        snprintf(line, sizeof line, "T10 = 110 degC %s", at_once[q]);
        TEST_ASSERT_EQUAL_STRING(line, line_of("T10"));
        samples(60);
        ask_ok("status");
        snprintf(line, sizeof line, "T10 = 110 degC %s", later[q]);
        TEST_ASSERT_EQUAL_STRING(line, line_of("T10"));
        TEST_ASSERT_EQUAL_STRING("T1 = 85 degC good", line_of("T1 "));
        board.quality[1] = 0;
        samples(1);
    }
}

static void status_names_channels_the_plant_does_not_announce(void)
{
    WITH("meas4.name", "lost", "meas4.unit", "bar", "mv3.name", "vent", "mv3.unit", "%");
    ask_ok("status");
    TEST_ASSERT_EQUAL_STRING("lost = 0 bar not announced by the plant", line_of("lost"));
    TEST_ASSERT_EQUAL_STRING("vent = 0 % not announced by the plant", line_of("vent"));
    TEST_ASSERT_EQUAL_STRING("T1 = 85 degC good", line_of("T1 "));
    TEST_ASSERT_EQUAL_STRING("heat = 0.5 kW", line_of("heat"));
}

static void status_shows_an_output_that_does_not_follow_where_it_is(void)
{
    board.with_readback = true;
    board.readback[1] = 1.5;
    ask_ok("out heat 0.5");
    samples(2);
    ask_ok("status");
    TEST_ASSERT_EQUAL_STRING("heat = 1.5 kW not following its command", line_of("heat"));
    TEST_ASSERT_EQUAL_STRING("reflux = 0 l/h", line_of("reflux"));
    ask_ok("alarm");
    TEST_ASSERT_EQUAL_STRING("NOT_FOLLOWING heat", reply[0]);
    board.readback[1] = 0.5;
    samples(1);
    ask_ok("alarm");
    TEST_ASSERT_EQUAL(1, n_reply);
}

static void status_and_alarm_name_what_an_interlock_forces_and_has_left(void)
{
    WITH("lock2.meas", "T10", "lock2.mv", "heat", "lock2.limit", "120", "lock2.hysteresis", "5",
         "lock2.value", "0", "mv2.min", "0.25");
    ask_ok("out heat 1");
    board.values[1] = 125;
    samples(1);
    ask_ok("status");
    TEST_ASSERT_EQUAL_STRING("heat = 0 kW interlocked", line_of("heat"));
    ANSWERS("alarm", "INTERLOCK_ON lock2 holds heat, T10 = 125 degC, limit 120 degC");
    board.values[1] = 110;
    samples(1);
    ask_ok("status");
    TEST_ASSERT_EQUAL_STRING("heat = 0 kW outside its limits, left there by an interlock",
                             line_of("heat"));
    ask_ok("out heat 0.5");
    samples(1);
    ask_ok("status");
    TEST_ASSERT_EQUAL_STRING("heat = 0.5 kW", line_of("heat"));
}

/* ---- version ---- */

static void version_says_what_runs_where_and_with_what_limits(void)
{
    ask_ok("save");
    ask_ok("version");
    TEST_ASSERT_EQUAL_STRING_LEN("reflux ", reply[0], 7);
    TEST_ASSERT_NOT_NULL(strstr(reply[0], " on memory, numbers "));
    TEST_ASSERT_NOT_NULL(strstr(reply[0], ", plant link version 1"));
    TEST_ASSERT_EQUAL_STRING("in the bench's own process", reply[1]);
    TEST_ASSERT_EQUAL_STRING("clock Hz 0, set by the bench", reply[2]);
    TEST_ASSERT_EQUAL_STRING("limits: channels 16 loops 16 feedforwards 4 interlocks 8 events 100 "
                             "alarms 8 arena bytes 19456 steps 32",
                             reply[3]);
    TEST_ASSERT_EQUAL_STRING("limits: plant channels 16 name bytes 896 requests 32 rows 8 line 200"
                             ", recalls lines",
                             reply[4]);
    TEST_ASSERT_EQUAL_STRING("no watchdog, flash for storage, bytes: 32768; supply not watched",
                             reply[5]);
    TEST_ASSERT_EQUAL_STRING("image without a checksum", reply[6]);
    TEST_ASSERT_EQUAL_STRING_LEN("started by: power-on boot ", reply[7], 26);
    TEST_ASSERT_EQUAL_STRING(OPEN, reply[8]);
    TEST_ASSERT_EQUAL_STRING_LEN("storage: ok, set 1 bytes ", reply[9], 25);
    TEST_ASSERT_EQUAL(11, n_reply);
}

/* ---- loop ---- */

static void loop_lists_all_loops_and_what_they_drive(void)
{
    ANSWERS("loop", "top manual  pv T1 = 85 degC  sp 85 degC  out reflux = 0 l/h",
            "bottom manual  pv T10 = 110 degC  sp 110 degC  out heat = 0.5 kW");
    WITH("meas3.name", "feed", "meas3.unit", "l/h", "meas3.hi", "8", "loop3.name", "outer",
         "loop3.pv", "feed", "loop3.out", "bottom", "loop3.gain", "1", "loop3.ti", "100");
    ask_ok("mode bottom cascade");
    samples(1);
    ask_ok("out outer 122.5");
    samples(1);
    ask_ok("loop");
    TEST_ASSERT_EQUAL_STRING("outer manual  pv feed = 5 l/h  sp 5 l/h  out bottom = 122.5 degC",
                             reply[2]);
    TEST_ASSERT_EQUAL_STRING_LEN(
        "bottom cascade  pv T10 = 110 degC  sp 122.5 degC  out heat = ", reply[1], 60);
}

/* gain 1.5, error 0.125 of span; each second 1.5 * 0.125 / 192 = 1/1024 is integrated, from where manual was. */
static void a_loop_is_shown_with_its_parts(void)
{
    ask_ok("set loop2.ti 192");
    samples(1);
    ask_ok("mode bottom auto");
    ask_ok("sp bottom 122.5");
    samples(5);
    ANSWERS("loop bottom", "bottom auto  pv T10 = 110 degC  sp 122.5 degC  out heat = 0.8828125 kW",
            "  error = 0.125", "  proportional = 0.1875", "  integral = 0.2548828",
            "  derivative = 0", "  computed = 0.44140625", "  output = 0.44140625",
            "  inhibited = 0");
    ask_refused("loop nobody", "UNKNOWN");
}

/* ---- stats ---- */

static void counted(const char *begin, const char *name, unsigned long n)
{
    char word[40];
    ask_ok("stats");
    for (unsigned i = 0; i < n_reply; i++) {
        snprintf(word, sizeof word, " %s ", name);
        const char *at =
            strncmp(reply[i], begin, strlen(begin)) == 0 ? strstr(reply[i], word) : NULL;
        if (!at)
            continue;
        TEST_ASSERT_EQUAL_MESSAGE(n, strtoul(at + strlen(word), NULL, 10), reply[i]);
        return;
    }
    TEST_FAIL_MESSAGE(name);
}

static void give_damaged(unsigned at)
{
    struct frame f;
    uint8_t wire[FRAME_WIRE_MAX];
    pack_keep_alive(&f);
    f.sequence = board.sequence++;
    size_t n = frame_encode(&f, wire);
    wire[at] ^= 0x40;
    (void)memory_port_give(HAL_UART_LINK, wire, n);
    board_run();
}

static void stats_count_what_comes_over_the_link(void)
{
    static const uint8_t stub[] = {2, 1, 0}, end = 0;
    uint8_t many[600];
    struct frame f;
    samples(1);
    ask_ok("stats");
    unsigned long good = strtoul(strstr(board.said, " good ") + 6, NULL, 10);
    give_damaged(4);
    for (unsigned n = 0; n < 2; n++)
        (void)memory_port_give(HAL_UART_LINK, stub, sizeof stub);
    memset(many, 0x55, sizeof many);
    for (unsigned n = 0; n < 3; n++) {
        (void)memory_port_give(HAL_UART_LINK, many, sizeof many);
        (void)memory_port_give(HAL_UART_LINK, &end, 1);
        board_run();
    }
    board.sequence = (uint16_t)(board.sequence + 3); /* with the damaged one four are missing */
    samples(1);
    for (unsigned n = 0; n < 5; n++) {
        pack_keep_alive(&f);
        f.type = 0x77;
        link_give(&f);
        board_run();
    }
    counted("link ", "samples", 8);
    counted("link ", "commands", 8);
    counted("link ", "good", good + 6);
    counted("link ", "bad_crc", 1);
    counted("link ", "malformed", 2);
    counted("link ", "overlong", 3);
    counted("link ", "lost_frames", 4);
    counted("link ", "refused", 5);
    counted("link ", "silences", 0);
    counted("tick ", "n", 8);
    board.mute = true;
    pass(3000);
    counted("link ", "silences", 1);
    counted("board", "up_ms", 3600);
}

static void stats_count_what_stands_at_the_console(void)
{
    ask_ok("stats");
    unsigned long lines = strtoul(strstr(board.said, "lines ") + 6, NULL, 10);
    ask_refused("sp bottom", "PARSE");
    ask_refused("frobnicate", "UNKNOWN");
    type("\n"); /* one as well */
    ask_ok("get loop1.ti");
    counted("console ", "lines", lines + 5);
    counted("console ", "errors", 2);
    counted("console ", "dropped", 0);
    counted("console ", "events_lost", 0);
}

/* ---- tune ---- */

static void proposes(const char *command, double gain, double ti, double td, const char *action)
{
    char line[80];
    const double want[] = {gain, ti, td};
    static const char *const begin[] = {"set loop2.gain ", "set loop2.ti ", "set loop2.td "};
    ask_ok(command);
    TEST_ASSERT_EQUAL(5, n_reply);
    for (unsigned i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_STRING_LEN(begin[i], reply[i], strlen(begin[i]));
        float told = strtof(reply[i] + strlen(begin[i]), NULL);
        TEST_ASSERT_FLOAT_WITHIN_MESSAGE(1e-5f * (float)want[i], (float)want[i], told, reply[i]);
    }
    snprintf(line, sizeof line, "set loop2.action %s", action);
    TEST_ASSERT_EQUAL_STRING(line, reply[3]);
}

/* A process gain of 50 degC/kW is 50 * 2/100 = 1 of spans. Skogestad 2003; Cohen and Coon 1953. */
static void tune_proposes_what_the_rules_say(void)
{
    double r = 20.0 / 600.0;
    proposes("tune bottom simc 50 20 600", 600.0 / 40.0, 160, 0, "reverse");
    proposes("tune bottom simc 50 20 600 40", 600.0 / 60.0, 240, 0, "reverse");
    proposes("tune bottom simc -100 20 60 40", 60.0 / 60.0 / 2.0, 60, 0, "direct");
    proposes("tune bottom cohen-coon 50 20 600", (0.9 + r / 12.0) / r,
             20.0 * (30.0 + 3.0 * r) / (9.0 + 20.0 * r), 0, "reverse");
    proposes("tune bottom cohen-coon-pid -50 20 600", (4.0 / 3.0 + r / 4.0) / r,
             20.0 * (32.0 + 6.0 * r) / (13.0 + 8.0 * r), 20.0 * 4.0 / (11.0 + 2.0 * r), "direct");
    ask_refused("tune bottom cohen-coon 50 20 600 40", "PARSE");
    TEST_ASSERT_TRUE(said("LAMBDA goes with the rule simc only"));
}

/* The output of an outer loop is the setpoint of the inner one: 100 degC of span over 8 l/h. */
static void tune_counts_the_span_of_the_inner_loop_for_an_outer_one(void)
{
    WITH("meas3.name", "feed", "meas3.unit", "l/h", "meas3.hi", "8", "loop3.name", "outer",
         "loop3.pv", "feed", "loop3.out", "bottom", "loop3.gain", "1", "loop3.ti", "100");
    ask_ok("tune outer simc 0.08 20 600");
    TEST_ASSERT_EQUAL_STRING("set loop3.gain 15", reply[0]);
}

/* ---- log ---- */

static void rows_and_their_header_hold_every_channel_in_its_place(void)
{
    ask_ok("set loop2.ti 192");
    samples(1);
    ask_ok("mode bottom auto");
    ask_ok("sp bottom 122.5");
    samples(3);
    board_forget();
    type("log on\n");
    TEST_ASSERT_EQUAL_STRING(
        "H,1,number,time[s],state,ev,T1[degC],T1.q,T10[degC],T10.q,top.mode,top.sp[degC],"
        "bottom.mode,bottom.sp[degC],reflux.cmd[l/h],reflux.app[l/h],heat.cmd[kW],heat.app[kW],"
        "stat.tick\nok\n",
        board.said);
    board.with_readback = true;
    board.readback[0] = 2.5;
    board.readback[1] = 0.8828125;
    board.quality[0] = 1;
    samples(1);
    board_forget();
    samples(1);
    char row[200];
    snprintf(row, sizeof row, "T,1,%u,12.000,1,", (unsigned)board.number);
    TEST_ASSERT_EQUAL_STRING_LEN(row, board.said, strlen(row));
    const char *rest = strchr(board.said + strlen(row), ',');
    TEST_ASSERT_EQUAL_STRING(",85,1,110,0,0,85,1,122.5,0,2.5,0.8828125,0.8828125,0\n", rest);
}

/* ---- events ---- */

static void what_is_only_looked_at_is_no_action(void)
{
    static const char *const looks[] = {"help",
                                        "version",
                                        "status",
                                        "loop",
                                        "loop top",
                                        "list",
                                        "get loop1.gain",
                                        "diff",
                                        "dump",
                                        "log off",
                                        "alarm",
                                        "seq",
                                        "seq list",
                                        "events",
                                        "stats",
                                        "commission",
                                        "commission plant",
                                        "commission plan",
                                        "commission gains",
                                        "commission model",
                                        "commission pairing",
                                        "commission structure",
                                        "commission proposal",
                                        "commission trial",
                                        "commission relay",
                                        "tune bottom simc 50 20 600",
                                        "mode machine"};
    ask_ok("events");
    unsigned before = n_reply;
    for (unsigned i = 0; i < sizeof looks / sizeof looks[0]; i++)
        ask_ok(looks[i]);
    ask_ok("events");
    TEST_ASSERT_EQUAL_MESSAGE(before, n_reply, board.said);
}

static void every_action_is_kept_with_its_subject_and_value(void)
{
    static const char *const done[][2] = {
        {"mode bottom auto", "DO_MODE bottom 1 mode requested: auto"},
        {"sp bottom 112.5", "DO_SETPOINT bottom 112.5 setpoint requested"},
        {"out top 2", "DO_OUTPUT top 2 output requested"},
        {"set alarm1.on T10", "DO_SET alarm1.on 0 parameter set; 0 for a word"},
        {"set alarm1.limit 120", "DO_SET alarm1.limit 120 parameter set; 0 for a word"},
        {"alarm shelve T10.hi 60", "DO_ALARM T10.hi 60 alarm acknowledged or shelved"},
        {"alarm ack all", "DO_ALARM all 0 alarm acknowledged or shelved"},
        {"set step1.seq stop", "DO_SET step1.seq 0 parameter set; 0 for a word"},
        {"seq stop", "DO_SEQUENCE stop 0 sequence started, stopped or commanded"},
        {"commission abort", NULL},
        {"save", "DO_STORAGE save 0 stored settings saved, loaded or replaced"},
        {"load", "DO_STORAGE load 0 stored settings saved, loaded or replaced"},
        {"commission begin", NULL},
        {"defaults", "DO_STORAGE defaults 0 stored settings saved, loaded or replaced"},
        {"key pot_still", "DO_KEY - 0 key changed"},
        {"lock", "DO_LOCK - 0 engineer level locked"},
        {"unlock pot_still", "DO_UNLOCK - 0 engineer level unlocked"}};
    char line[160];
    for (unsigned i = 0; i < sizeof done / sizeof done[0]; i++) {
        bool taken = strcmp(ask(done[i][0]), "ok") == 0;
        TEST_ASSERT_EQUAL_MESSAGE(done[i][1] != NULL, taken, board.said);
        samples(1);
        ask_ok("events");
        snprintf(line, sizeof line, "action %s, by engineer", done[i][1] ? done[i][1] : "");
        TEST_ASSERT_EQUAL_MESSAGE(taken ? 1 : 0, times_said(line), line);
    }
}

/* ---- room ---- */

static void a_listing_that_waits_for_room_lets_the_board_sleep(void)
{
    (void)memory_port_give(HAL_UART_CONSOLE, "list all\n", 9);
    (void)memory_port_run();
    TEST_ASSERT_EQUAL(2, memory_port_run()); /* nothing moves, and nobody is busy */
    board_forget();
    board_run();
    TEST_ASSERT_TRUE(said("\nok\n"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(status_says_state_link_time_and_every_channel);
    RUN_TEST(status_tells_a_link_that_is_down_and_one_that_greets);
    RUN_TEST(status_says_how_good_each_measurement_is);
    RUN_TEST(status_names_channels_the_plant_does_not_announce);
    RUN_TEST(status_shows_an_output_that_does_not_follow_where_it_is);
    RUN_TEST(status_and_alarm_name_what_an_interlock_forces_and_has_left);
    RUN_TEST(version_says_what_runs_where_and_with_what_limits);
    RUN_TEST(loop_lists_all_loops_and_what_they_drive);
    RUN_TEST(a_loop_is_shown_with_its_parts);
    RUN_TEST(stats_count_what_comes_over_the_link);
    RUN_TEST(stats_count_what_stands_at_the_console);
    RUN_TEST(tune_proposes_what_the_rules_say);
    RUN_TEST(tune_counts_the_span_of_the_inner_loop_for_an_outer_one);
    RUN_TEST(rows_and_their_header_hold_every_channel_in_its_place);
    RUN_TEST(what_is_only_looked_at_is_no_action);
    RUN_TEST(every_action_is_kept_with_its_subject_and_value);
    RUN_TEST(a_listing_that_waits_for_room_lets_the_board_sleep);
    return UNITY_END();
}
