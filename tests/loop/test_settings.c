/* Guards a promise to owners of stored sets and .conf files: later firmware takes what this firmware takes, and a parameter keeps its
 * name, id, unit, range and default. Each parameter is set at, just below and just above both ends of its range. Then values beside the
 * limits that parameters set each other are applied, alone and in pairs, and the answer is taken or a code with a subject.
 *
 * Kept in reference/settings.txt, which support/kept_transcript.h says how to write anew. Lines may be added and ranges may widen. A line
 * that changes otherwise breaks a set or a file of somebody, and needs a reason. */
#include "board_bench.h"
#include "kept_transcript.h"

void setUp(void) {}
void tearDown(void) {}

/* ---- each by itself ---- */

static void its_ends(const char *name, const char *lo, const char *hi)
{
    char line[120];
    double ends[2] = {strtod(lo, NULL), strtod(hi, NULL)};
    static const double beside[] = {0, -1e-3, 1e-3};
    char codes[120] = "";
    for (unsigned e = 0; e < 2; e++)
        for (unsigned b = 0; b < 3; b++) {
            double x = ends[e] + beside[b] * (ends[e] != 0 ? ends[e] : 1);
            snprintf(line, sizeof line, "set %.31s %.9g", name, x);
            const char *end = ask(line);
            snprintf(codes + strlen(codes), sizeof codes - strlen(codes), " %.*s",
                     (int)strcspn(end[0] == 'e' ? end + 4 : end, " "),
                     end[0] == 'e' ? end + 4 : end);
        }
    kept_line("%s%s", name, codes);
}

/* The first of each group, and what it says of itself. */
static void each_parameter_has_its_range(void)
{
    static char names[400][32];
    unsigned n = 0;
    power_on();
    ask_ok("list all");
    for (unsigned i = 0; i + 1 < n_reply; i++) {
        const char *dot = strchr(reply[i], '.');
        TEST_ASSERT_NOT_NULL(dot);
        bool other = dot[-1] >= '0' && dot[-1] <= '9' &&
                     (dot[-1] != '1' || (dot[-2] >= '0' && dot[-2] <= '9'));
        if (other)
            continue;
        TEST_ASSERT_TRUE(n < 400);
        snprintf(names[n++], sizeof names[0], "%.*s", (int)strcspn(reply[i], " "), reply[i]);
    }
    for (unsigned k = 0; k < n; k++) {
        char line[60], lo[40] = "", hi[40] = "", dots[8] = "";
        snprintf(line, sizeof line, "help %.31s", names[k]);
        ask_ok(line);
        for (unsigned i = 0; i + 1 < n_reply; i++)
            kept_line("%s", reply[i]);
        if (n_reply > 2 && sscanf(reply[2], " allowed: %39s %7s %39s", lo, dots, hi) == 3 &&
            strcmp(dots, "..") == 0) {
            ask_ok("begin");
            its_ends(names[k], lo, hi);
            ask_ok("abandon");
        }
    }
}

/* ---- together ---- */

static const char *const base[] = {"begin",
                                   "set meas1.name a",
                                   "set meas1.unit K",
                                   "set meas2.name b",
                                   "set meas2.lo -50",
                                   "set meas3.name c",
                                   "set mv1.name u",
                                   "set mv2.name v",
                                   "set mv3.name w",
                                   "set mv3.min 10",
                                   "set mv3.max 90",
                                   "set mv3.safe 5",
                                   "set loop1.name la",
                                   "set loop1.pv a",
                                   "set loop1.out u",
                                   "set loop2.name lb",
                                   "set loop2.pv b",
                                   "set loop2.out v",
                                   "set loop3.name lc",
                                   "set loop3.pv c",
                                   "set loop3.out la",
                                   "set ff1.from c",
                                   "set ff1.to u",
                                   "set lock1.meas a",
                                   "set lock1.mv v",
                                   "set alarm1.on a",
                                   "set alarm2.on lb",
                                   "set alarm2.side deviation",
                                   "set step1.seq start",
                                   "set step1.do out",
                                   "set step1.what w",
                                   "set step1.value 50",
                                   "set step1.until above",
                                   "set step1.meas c",
                                   "set step1.limit 50",
                                   "set step1.timeout 60",
                                   "apply",
                                   NULL};

static const char *const alone[] = {"meas1.lo 99.98",
                                    "meas1.lo 99.99",
                                    "meas1.hi 0",
                                    "meas1.lo 100",
                                    "meas1.hi 0.000001",
                                    "meas1.hi 0.0000009",
                                    "meas2.hi -49.995",
                                    "meas2.hi -49.98",
                                    "meas1.name b",
                                    "meas1.name ok",
                                    "meas1.name err",
                                    "meas2.name -",
                                    "meas9.infer nobody",
                                    "meas1.infer nobody",
                                    "meas1.infer u",
                                    "meas9.fallback substitute",
                                    "meas9.substitute 500",
                                    "meas1.fallback substitute",
                                    "meas1.substitute 100",
                                    "meas1.substitute 100.1",
                                    "meas1.substitute -0.1",
                                    "meas1.unit ,K",
                                    "meas1.name +a",
                                    "meas1.name a+",
                                    "meas1.unit K]",
                                    "meas1.unit -",
                                    "meas1.name -",
                                    "mv1.min 100",
                                    "mv1.min 0",
                                    "mv1.min -0.1",
                                    "mv1.max 100.1",
                                    "mv1.max 0",
                                    "mv1.safe 100",
                                    "mv1.safe 100.1",
                                    "mv1.safe -0.1",
                                    "mv1.rate 1e-7",
                                    "mv1.rate 9e-8",
                                    "mv1.rate 1e8",
                                    "mv1.rate 1.1e8",
                                    "mv1.name v",
                                    "mv1.name la",
                                    "mv1.name ok",
                                    "mv1.lo 100",
                                    "mv1.hi 0.000001",
                                    "mv1.test_step 50",
                                    "mv1.test_step 50.1",
                                    "mv2.name -",
                                    "loop1.name lb",
                                    "loop1.name err",
                                    "loop1.pv nobody",
                                    "loop1.out nobody",
                                    "loop1.out v",
                                    "loop1.out la",
                                    "loop1.out lc",
                                    "loop2.out la",
                                    "loop3.out lb",
                                    "loop1.sp_lo 100",
                                    "loop1.sp_hi 100",
                                    "loop1.sp_hi 100.1",
                                    "loop1.sp_lo -0.1",
                                    "loop1.sp_lo 50",
                                    "loop1.sp_hi 50",
                                    "loop1.phase 1",
                                    "loop1.divisor 2",
                                    "loop1.phase 2",
                                    "loop1.decouple on",
                                    "loop2.decouple on",
                                    "loop3.decouple on",
                                    "loop9.name lz",
                                    "loop9.pv a",
                                    "loop9.out w",
                                    "loop9.decouple on",
                                    "loop8.name ly",
                                    "loop8.pv a",
                                    "loop8.out w",
                                    "loop8.decouple on",
                                    "tick.base 3600",
                                    "tick.base 0.05",
                                    "tick.base 0.049",
                                    "loop1.divisor 27",
                                    "loop1.divisor 28",
                                    "loop1.sp_ramp 0.0000066",
                                    "loop1.sp_ramp 0.0000054",
                                    "loop1.algorithm two_position",
                                    "loop1.band 0.0001",
                                    "loop1.band 0.00009",
                                    "loop1.band 1000",
                                    "loop1.band 1001",
                                    "loop1.out_lo 1",
                                    "loop1.out_lo 0.999",
                                    "loop1.out_hi 0",
                                    "loop1.ti 0.01",
                                    "loop1.ti 0.009",
                                    "loop1.tt 0.009",
                                    "loop1.tt 0.01",
                                    "loop1.out_rate 1e-9",
                                    "loop1.out_rate 9e-10",
                                    "loop3.out_lo 1",
                                    "decouple1.d2 1",
                                    "decouple2.d1 1",
                                    "decouple2.d1 0.9921",
                                    "decouple2.d1 0.9922",
                                    "decouple1.d1 0.008",
                                    "decouple1.d1 0.0078",
                                    "decouple2.d2 0",
                                    "decouple1.d2 50",
                                    "ff1.from nobody",
                                    "ff1.from u",
                                    "ff1.from v",
                                    "ff1.from w",
                                    "ff1.to nobody",
                                    "ff1.to w",
                                    "ff1.to v",
                                    "ff2.from u",
                                    "ff2.to v",
                                    "ff2.from v",
                                    "ff2.to u",
                                    "ff3.from v",
                                    "ff3.to u",
                                    "ff1.lo 1",
                                    "ff1.hi -1",
                                    "ff1.lead 100",
                                    "ff1.lead 100.1",
                                    "ff1.lag 1",
                                    "ff1.dead 2000",
                                    "ff1.dead 1200",
                                    "ff2.dead 1500",
                                    "ff1.reference 200",
                                    "ff1.reference 201",
                                    "ff1.reference -100",
                                    "ff1.reference -101",
                                    "ff1.hi 0.5",
                                    "ff1.lo -0.5",
                                    "lock1.meas nobody",
                                    "lock1.mv nobody",
                                    "lock1.value 100",
                                    "lock1.value 100.1",
                                    "lock1.value -0.1",
                                    "alarm1.on nobody",
                                    "alarm1.side deviation",
                                    "alarm2.side hi",
                                    "alarm2.on nobody",
                                    "pair1.meas a",
                                    "pair1.mv u",
                                    "pair1.mv nobody",
                                    "pair1.meas nobody",
                                    "step1.what nobody",
                                    "step1.value 4.9",
                                    "step1.value 5",
                                    "step1.value 90",
                                    "step1.value 90.1",
                                    "step1.do auto",
                                    "step1.do cascade",
                                    "step1.do sp",
                                    "step1.what la",
                                    "step1.what lb",
                                    "step1.what a",
                                    "step1.do offset_on",
                                    "step1.do offset_off",
                                    "step1.do drop",
                                    "step1.do guard",
                                    "step1.do manual",
                                    "step1.do nothing",
                                    "step1.until below",
                                    "step1.until steady",
                                    "step1.until time",
                                    "step1.until confirm",
                                    "step1.until at_once",
                                    "step1.else go_on",
                                    "step1.else hold",
                                    "step1.hold 1",
                                    "step1.hold 59",
                                    "step1.hold 60",
                                    "step1.timeout 0",
                                    "step1.timeout 1",
                                    "step1.limit 0",
                                    "step1.limit -0.1",
                                    "step1.limit 100",
                                    "step1.limit 100.1",
                                    "step1.meas nobody",
                                    "step1.value 100.1",
                                    "step1.value -0.1",
                                    "step2.seq stop",
                                    "step2.until time",
                                    "step2.hold 5",
                                    "step2.timeout 5",
                                    "step2.timeout 6"};

/* Two that are at a limit only with each other. */
static const char *const together[][2] = {
    {"tick.base 3600", "loop1.divisor 27"},
    {"tick.base 3600", "loop1.divisor 28"},
    {"tick.base 1000", "loop1.divisor 100"},
    {"tick.base 1000", "loop1.divisor 101"},
    {"meas3.lo 99.975", "step1.limit 99.99"},
    {"meas3.lo 99.985", "step1.limit 99.99"},
    {"meas3.lo 0.0000005", "meas3.hi 0.0000017"},
    {"ff1.lag 2", "ff1.lead 300"},
    {"ff1.lag 2", "ff1.lead 300.1"},
    {"decouple1.d1 2", "loop1.decouple on"},
    {"decouple1.d1 0.0079", "loop1.decouple on"},
    {"decouple1.d1 0.0078", "loop1.decouple on"},
    {"mv3.min 20", "step1.value 4.9"},
    {"mv3.safe 95", "step1.value 95"},
    {"loop1.algorithm two_position", "loop1.band 0.0001"},
    {"loop1.algorithm two_position", "loop1.band 0.00009"},
    {"loop1.algorithm two_position", "loop1.band 1000"},
    {"loop1.algorithm two_position", "loop1.band 1001"},
    {"loop1.sp_lo 10", "loop1.sp_hi 100"},
    {"loop1.sp_lo 10", "loop1.sp_hi 100.1"},
    {"loop1.sp_lo -0.1", "loop1.sp_hi 90"},
    {"loop1.sp_lo 50", "loop1.sp_hi 50"},
};

/* The code and the subject of a refusal, without its words. */
static void says_answer_to(const char *line, const char *answer)
{
    kept_line("%s: %.*s", line, (int)strcspn(answer, ":"), answer);
}

static void takes(const char *const *settings, unsigned n)
{
    char line[160] = "", set[80];
    ask_ok("begin");
    for (const char *const *s = base + 1; strcmp(*s, "apply") != 0; s++)
        ask_ok(*s);
    for (unsigned i = 0; i < n; i++) {
        snprintf(set, sizeof set, "set %s", settings[i]);
        snprintf(line + strlen(line), sizeof line - strlen(line), "%s%s", i ? ", " : "",
                 settings[i]);
        const char *answer = ask(set);
        if (strcmp(answer, "ok") != 0) {
            says_answer_to(line, answer);
            ask_ok("abandon");
            return;
        }
    }
    const char *answer = ask("apply");
    bool taken = strcmp(answer, "ok") == 0;
    says_answer_to(line, answer);
    if (!taken)
        ask_ok("abandon");
    pass(50);
    ask_ok("defaults");
    pass(1100);
}

static void settings_that_limit_each_other(void)
{
    for (unsigned k = 0; k < sizeof alone / sizeof alone[0]; k++)
        takes(&alone[k], 1);
    for (unsigned k = 0; k < sizeof together / sizeof together[0]; k++)
        takes(together[k], 2);
}

static void what_was_taken_is_taken_and_means_the_same(void)
{
    kept_open("reference/settings.txt",
              "a set or .conf file taken today is taken by later firmware, and means the same");
    each_parameter_has_its_range();
    settings_that_limit_each_other();
    kept_close();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(what_was_taken_is_taken_and_means_the_same);
    return UNITY_END();
}
