/* Listings of `commission` before anything is known, with a proposal, and after the trial. */
#include "commission_wood_berry.h"

void setUp(void) {}
void tearDown(void) {}

static void shows(const char *command, const char *const *words)
{
    ask_ok(command);
    for (; *words; words++)
        TEST_ASSERT_TRUE_MESSAGE(said(*words), *words);
}

#define SHOWS(command, ...) shows(command, (const char *const[]){__VA_ARGS__, NULL})

static void before_the_tests_there_is_nothing_but_the_plant(void)
{
    wood_berry(NULL);
    SHOWS("commission", "phase idle");
    SHOWS("commission plant", "plant tick s 60", "measurement xD unit %w lo 80 hi 112",
          "output R unit lb/min");
    /* 60 samples of a minute in all that is known least, 1000 at most, both inputs, 4 rounds and 3 tests again; nothing has
     * moved. */
    SHOWS("commission plan", "plan inputs 2 outputs 2 rounds 4 hours at least 10 at most 991.6667",
          "input R held 1.95 step 0.08 at most 0.08 lb/min", "output xD limit 6.4 %w");
    ask_ok("commission model");
    TEST_ASSERT_FALSE(said("element"));
    SHOWS("commission gains", "nothing yet");
    SHOWS("commission pairing", "nothing yet");
    SHOWS("commission proposal", "nothing yet");
    ask_refused("commission nonsense", "PARSE");
    ask_refused("commission accept", "STATE");
    ask_refused("commission resume", "STATE");
}

/* Number after `name`, the nth of that name, in the line of the last reply that begins so. */
static double number(const char *begin, const char *name, unsigned nth)
{
    char word[40];
    snprintf(word, sizeof word, " %s ", name);
    for (unsigned i = 0; i < n_reply; i++) {
        if (strncmp(reply[i], begin, strlen(begin)) != 0)
            continue;
        const char *at = reply[i] + strlen(begin) - 1; /* the blank at its end may be the word's */
        while ((at = strstr(at, word)) != NULL && nth-- > 0)
            at++;
        TEST_ASSERT_NOT_NULL_MESSAGE(at, word);
        return strtod(at + strlen(word), NULL);
    }
    TEST_FAIL_MESSAGE(begin);
    return 0;
}

#define NEAR(share, want, begin, name)                                                             \
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE((share)*fabs((double)(want)), want, number(begin, name, 0),  \
                                      name)

static void before_it_begins_every_listing_says_so_and_no_more(void)
{
    static const char *const nothing[] = {"nothing yet: `commission begin` first", NULL};
    static const char *const later[] = {"commission gains", "commission pairing",
                                        "commission proposal"};
    ANSWERS("commission", "phase idle");
    ANSWERS("commission plant", "plant tick s 60 name handmade",
            "measurement xD unit %w lo 80 hi 112", "measurement xB unit %w lo -20 hi 20",
            "output R unit lb/min lo 0 hi 4 safe 1.95", "output S unit lb/min lo 0 hi 4 safe 0");
    for (unsigned i = 0; i < sizeof later / sizeof later[0]; i++)
        answers_with(later[i], nothing);
    ANSWERS("commission structure", "structure none: the pairing must be determined first");
    ANSWERS("commission trial", "no trial yet: `commission accept` begins one");
    ask_ok("commission model");
    TEST_ASSERT_EQUAL(1, n_reply);
}

/* Prior knowledge counts for its input and its measurement, and for no other. */
static void the_plan_counts_what_is_set_for_each_channel(void)
{
    ask_ok("begin");
    ask_ok("set mv1.test_step 0.2");
    ask_ok("set mv2.test_time 1800");
    ask_ok("set meas1.test_limit 3");
    ask_ok("set meas1.test_critical on");
    ask_ok("set test.rounds 2");
    ask_ok("set test.window 40");
    ask_ok("apply");
    plant_steps(2);
    /* R: halves of 40 samples or of 1000, S of 1800 s, three each; and four windows of rest */
    ask_ok("commission plan");
    TEST_ASSERT_EQUAL_STRING("input R held 1.95 step 0.2 at most 0.2 lb/min", reply[1]);
    TEST_ASSERT_EQUAL_STRING("input S held 1.71 step 0.08 at most 0.08 lb/min", reply[2]);
    TEST_ASSERT_EQUAL_STRING("output xD limit 1.5 %w", reply[3]);
    TEST_ASSERT_EQUAL_STRING("output xB limit 8 %w", reply[4]);
    TEST_ASSERT_EQUAL_STRING("ok", reply[5]);
    double least_h = (5 * 2400 + 3 * 1800 + 2 * 2400) / 3600.0;
    /* Rests are watched over a quarter of a half; R may be tested again three times, over two rounds each. */
    double most_h = (5 * (3.5 * 60000 + 3 * 15000) + 2 * (3.5 * 1800 + 3 * 2400)) / 3600.0;
    NEAR(1e-5, least_h, "plan inputs 2 outputs 2 rounds 2 ", "hours at least");
    NEAR(1e-5, most_h, "plan inputs 2 outputs 2 rounds 2 ", "at most");
}

static void a_pair_known_beforehand_counts_for_its_input_only(void)
{
    static const char *const known[] = {"set pair1.meas xB",
                                        "set pair1.mv S",
                                        "set pair1.gain 10",
                                        "set pair1.time 1000",
                                        "set mv1.test_step 0",
                                        "set mv2.test_step 0",
                                        NULL};
    wood_berry(known);
    ask_ok("commission begin");
    until("TEST_STEP R", 300);
    TEST_ASSERT_TRUE(said("info TEST_STEP R 0.002 "));
    /* A quarter of its limit of 8 %w: 0.2 lb/min. */
    until("TEST_STEP S", 3000);
    TEST_ASSERT_TRUE_MESSAGE(said("info TEST_STEP S 0.05 "), board.said);
    ask_ok("commission abort");
}

static void pairs_that_are_given_are_the_only_ones_looked_for(void)
{
    static const char *const crossed[] = {"set pair1.meas xD",
                                          "set pair1.mv S",
                                          "set pair2.meas xB",
                                          "set pair2.mv R",
                                          "set test.pairs given",
                                          "set test.rounds 1",
                                          NULL};
    wood_berry(crossed);
    ask_ok("commission begin");
    until("NOT_DETERMINED", 3000);
    ask_ok("commission pairing");
    TEST_ASSERT_TRUE(said("impossible: no pairs with positive relative gains and indices"));
    static const char *const straight[] = {"set pair1.meas xD",    "set pair1.mv R",
                                           "set pair2.meas xB",    "set pair2.mv S",
                                           "set test.pairs given", NULL};
    wood_berry(straight);
    proposal();
}

static void each_half_of_a_test_is_shown_with_the_worst_so_far(void)
{
    wood_berry(NULL);
    ask_ok("commission begin");
    plant_step();
    ask_ok("commission");
    ANSWERS("commission", "phase testing, outputs 2, inputs 2, plant time s 0.000",
            "input R (1 of 2), round 1: waits for rest, amplitude 0 lb/min",
            "left at least 36000 s, at most 3570000 s"); /* by the plan */
    until("TEST_STEP R", 300);
    plant_steps(20);
    ask_ok("commission");
    double share = 12.8 * 0.08 / 6.4 * (1 - exp((60.0 - 20 * 60) / 1002));
    static const char up[] = "input R (1 of 2), round 1: positive half, amplitude 0.08 lb/min, "
                             "worst xD at ";
    TEST_ASSERT_EQUAL_STRING_LEN(up, reply[1], strlen(up));
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * share, share, strtod(reply[1] + strlen(up), NULL));
    TEST_ASSERT_TRUE(said(" of its limit\n"));
    static const char *const after[] = {"negative half", "back, waits for rest"};
    char line[80];
    for (unsigned n = 0; n < 2; n++) {
        snprintf(line, sizeof line, "input R (1 of 2), round 1: %s, amplitude 0.08 lb/min",
                 after[n]);
        unsigned ticks = 400;
        do {
            plant_step();
            ask_ok("commission");
        } while (ticks-- && strncmp(reply[1], line, strlen(line)) != 0);
        TEST_ASSERT_EQUAL_STRING_LEN(line, reply[1], strlen(line));
    }
    until("TEST_STEP S", 3000);
    ask_ok("commission");
    TEST_ASSERT_EQUAL_STRING("input S (2 of 2), round 1: positive half, amplitude 0.08 lb/min",
                             reply[1]);
    unsigned round_s, all_s; /* one test of the two of this round is left, then three rounds */
    TEST_ASSERT_EQUAL_INT(2, sscanf(reply[2],
                                    "left about %u s of this round, %u s if all rounds are needed",
                                    &round_s, &all_s));
    TEST_ASSERT_TRUE(round_s > 0);
    TEST_ASSERT_TRUE(all_s - round_s >= 6 * round_s);
    ask_ok("commission abort");
    plant_step();
    ask_ok("commission");
    TEST_ASSERT_EQUAL_STRING_LEN("phase ended, outputs 2, inputs 2, plant time s ", reply[0], 47);
    TEST_ASSERT_EQUAL_STRING("- asked for", reply[1]);
}

static void a_proposal_is_shown_with_what_it_rests_on(void)
{
    wood_berry(NULL);
    SHOWS("commission begin", "plan inputs 2", "input R held 1.95 step 0.08", "output xB limit");
    until("TEST_STEP R", 300);
    SHOWS("commission", "phase testing", "input R (1 of 2), round 1: positive half");
    until("PROPOSAL", 3000);
    SHOWS("commission", "phase ready", "a proposal waits");
    SHOWS("commission model", "input R held 1.95", "output xD noise", "element xD R gain 12.",
          "element xB S gain -19.", "moments xD R");
    SHOWS("commission gains", "rank 2", "singular", "rga R S", "rga xD 2.0");
    SHOWS("commission pairing", "pairing determined", "pair xD R lambda 2.0", "pair xB S");
    SHOWS("commission structure", "block");
    SHOWS("commission proposal", "settings PI for the worst of the plants drawn Ms ", " nominal ",
          " Mt ", "decoupler none", "loop xD R gain", "loop xB S gain");
}

/* ---- the numbers, beside those of the plant ---- */

/* Wood and Berry 1973. Spans: xD 32, xB 40 %w, R and S 4 lb/min. */
static const double gain_true[2][2] = {{12.8, -18.9}, {6.6, -19.4}};
static const double lag_true[2][2] = {{1002, 1260}, {654, 864}};
static const double dead_true[2][2] = {{60, 180}, {420, 180}};
static const double span_true[2] = {32, 40};
static const double limit_true[2] = {6.4, 8};

static double scaled(unsigned j, unsigned k)
{
    return gain_true[j][k] * 4 / span_true[j];
}

/* A lag is found to a hundredth; its gain's standard deviation is that of a sample over the amplitude where one sample
 * counts, and less by the root of their number where all do. A fifth of what was still to come is doubted, too. */
static void what_was_found_is_shown_in_units_of_the_plant(void)
{
    static const char *const element[2][2] = {{"element xD R ", "element xD S "},
                                              {"element xB R ", "element xB S "}};
    static const char *const moments[2][2] = {{"moments xD R ", "moments xD S "},
                                              {"moments xB R ", "moments xB S "}};
    static const char *const input[2] = {"input R held 1.95 amplitude 0.08 lb/min ",
                                         "input S held 1.71 amplitude 0.08 lb/min "};
    static const char *const noise[2] = {"output xD ", "output xB "};
    ask_ok("commission model");
    for (unsigned k = 0; k < 2; k++) {
        double half_s = number(input[k], "half", 0), worst = 0;
        for (unsigned j = 0; j < 2; j++) {
            double reached = fabs(gain_true[j][k]) * 0.08 / limit_true[j] *
                             (1 - exp((dead_true[j][k] - half_s) / lag_true[j][k]));
            double sample = number(noise[j], "noise", 0) / 0.08;
            double sd = number(element[j][k], "sd", 0);
            worst = fmax(worst, reached);
            NEAR(0.005, gain_true[j][k], element[j][k], "gain");
            NEAR(0.01, lag_true[j][k], element[j][k], "T");
            TEST_ASSERT_DOUBLE_WITHIN(5, dead_true[j][k], number(element[j][k], "L", 0));
            double to_come = 1 - reached * limit_true[j] / (fabs(gain_true[j][k]) * 0.08);
            double doubt = 0.2 * to_come * fabs(gain_true[j][k]);
            TEST_ASSERT_TRUE(sd <= hypot(sample, 1.1 * doubt));
            TEST_ASSERT_TRUE(sd >= hypot(sample / sqrt(4 * half_s / 60), 0.9 * doubt));
            NEAR(0.01, gain_true[j][k], moments[j][k], "gain");
            NEAR(0.02, lag_true[j][k], moments[j][k], "T");
            TEST_ASSERT_DOUBLE_WITHIN(20, dead_true[j][k], number(moments[j][k], "L", 0));
        }
        NEAR(0.02, worst, input[k], "worst");
    }
    NEAR(0.03, 6.6, "moments xB R ", "plateau"); /* the others had not come to rest */
    NEAR(0.03, -19.4, "moments xB S ", "plateau");
    TEST_ASSERT_EQUAL(8, times_said(" flags -\n"));
    TEST_ASSERT_EQUAL(2, times_said(" s rounds 1 worst "));
    double resolution = number(noise[0], "noise", 0) / span_true[0];
    NEAR(1e-5, resolution * span_true[1], noise[1], "noise");
}

/* Grosdidier, Skogestad and Morari 1985: the least condition of a plant of two by two, from its relative gains. */
static void figures_of_the_gains_are_shown_as_defined(void)
{
    double direct = scaled(0, 0) * scaled(1, 1), across = scaled(0, 1) * scaled(1, 0);
    double det = direct - across, lambda = direct / det, squares = 0;
    for (unsigned j = 0; j < 2; j++)
        for (unsigned k = 0; k < 2; k++)
            squares += scaled(j, k) * scaled(j, k);
    ask_ok("commission gains");
    double large = 0, small = 0;
    TEST_ASSERT_EQUAL(2, sscanf(reply[1], "singular %lf %lf", &large, &small));
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * fabs(det), fabs(det), large * small);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * squares, squares, large * large + small * small);
    TEST_ASSERT_EQUAL_STRING_LEN("rank 2 exact 2 ", reply[0], 15);
    NEAR(1e-5, large / small, "rank ", "condition");
    double sum = 2 * lambda - 1, own[2], other[2];
    NEAR(0.01, sum + sqrt(sum * sum - 1), "rank ", "scaled");
    TEST_ASSERT_EQUAL_STRING("rga R S", reply[2]);
    TEST_ASSERT_EQUAL(2, sscanf(reply[3], "rga xD %lf %lf", &own[0], &other[0]));
    TEST_ASSERT_EQUAL(2, sscanf(reply[4], "rga xB %lf %lf", &other[1], &own[1]));
    for (unsigned j = 0; j < 2; j++) {
        TEST_ASSERT_DOUBLE_WITHIN(0.01, lambda, own[j]);
        TEST_ASSERT_DOUBLE_WITHIN(0.01, 1 - lambda, other[j]);
    }
    ask_ok("commission pairing");
    NEAR(0.005, det / direct, "pairing determined ", "niederlinski");
    NEAR(0, 1.0, "pairing determined ", "probability");
    /* The second opinion takes gains over residence times. */
    double slow[2][2];
    for (unsigned j = 0; j < 2; j++)
        for (unsigned k = 0; k < 2; k++)
            slow[j][k] = gain_true[j][k] / (lag_true[j][k] + dead_true[j][k]);
    double phi = 1 / (1 - slow[0][1] * slow[1][0] / (slow[0][0] * slow[1][1]));
    static const char *const pairs[2] = {"pair xD R ", "pair xB S "};
    for (unsigned j = 0; j < 2; j++) {
        NEAR(0.005, lambda, pairs[j], "lambda");
        NEAR(0, 1.0, pairs[j], "share");
        NEAR(0.01, phi, pairs[j], "phi");
    }
    TEST_ASSERT_EQUAL_STRING(
        "second_opinion agrees: gains over residence times give the same pairs", reply[3]);
    ask_ok("commission structure");
    TEST_ASSERT_EQUAL_STRING("structure parts 1 blocks 1", reply[0]);
    NEAR(0.005, lambda, "block number 1 part 1 pairs 2 ", "worst_lambda");
    TEST_ASSERT_TRUE(said(" driven_by -\n"));
    TEST_ASSERT_EQUAL_STRING("member xD R block 1 single_loop yes", reply[2]);
    TEST_ASSERT_EQUAL_STRING("member xB S block 1 single_loop yes", reply[3]);
    TEST_ASSERT_EQUAL(5, n_reply);
}

/* An integral controller moves its output by gain/ti times the integral of its error, and what setpoints ask of the
 * outputs at rest the gains say. Within the time of a trial not all of it is seen. */
static void the_proposal_is_shown_as_it_is_put_in(void)
{
    static const char *const loops[2] = {"loop xD R ", "loop xB S "};
    char gain[2][40], ti[2][40], line[80];
    double det = scaled(0, 0) * scaled(1, 1) - scaled(0, 1) * scaled(1, 0);
    ask_ok("commission proposal");
    for (unsigned j = 0; j < 2; j++) {
        double step = 0.05 * span_true[j], g = number(loops[j], "gain", 0);
        double moves = fabs(0.05 * scaled(1 - j, 1 - j) / det);
        double integral = moves * number(loops[j], "ti", 0) / g * span_true[j];
        snprintf(gain[j], sizeof gain[j], "%.7g", g);
        snprintf(ti[j], sizeof ti[j], "%.7g", number(loops[j], "ti", 0));
        NEAR(0, 0.0, loops[j], "td");
        NEAR(1e-5, step, loops[j], "step");
        NEAR(0.25, integral, loops[j], "iae");
        double overshoot = number(loops[j], "overshoot", 0);
        TEST_ASSERT_TRUE(overshoot >= 0 && overshoot < 0.3);
        double settles = number(loops[j], "settles", 0);
        TEST_ASSERT_TRUE(settles > lag_true[j][j] && settles < 10 * lag_true[j][j]);
    }
    static const char settings[] = "settings PI for the worst of the plants drawn ";
    double worst = number(settings, "Ms", 0), nominal = number(settings, "nominal", 0);
    TEST_ASSERT_TRUE(worst <= 2.0 && nominal <= worst && nominal > 1.5);
    worst = number(settings, "Mt", 0);
    nominal = number(settings, "nominal", 1);
    TEST_ASSERT_TRUE(worst <= 1.5 && nominal <= worst && nominal >= 1.0);
    TEST_ASSERT_EQUAL(0, times_said(" lowered ")); /* nothing had to be */
    TEST_ASSERT_EQUAL(1, times_said(" reverse step 1.6 "));
    TEST_ASSERT_EQUAL(1, times_said(" direct step 2 "));
    ask_ok("commission edit");
    for (unsigned j = 0; j < 2; j++) {
        snprintf(line, sizeof line, "get loop%u.gain", j + 1);
        ask_ok(line);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6 * strtod(gain[j], NULL), strtod(gain[j], NULL),
                                  strtod(strchr(reply[0], '=') + 1, NULL));
        snprintf(line, sizeof line, "get loop%u.ti", j + 1);
        ask_ok(line);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6 * strtod(ti[j], NULL), strtod(ti[j], NULL),
                                  strtod(strchr(reply[0], '=') + 1, NULL));
    }
    ask_ok("abandon");
}

static void a_trial_is_shown_beside_what_was_predicted(void)
{
    ask_ok("commission accept");
    until("TRIAL_BEGUN", 5);
    SHOWS("commission", "phase trial", "loop 1 of 2 on trial");
    until("TRIAL_KEPT", 4000);
    ask_ok("commission trial");
    for (unsigned j = 0; j < 2; j++) {
        static const char *const begins[2] = {"trial xD R step -1.6 ", "trial xB S step -2 "};
        double predicted = number(begins[j], "predicted", 0);
        NEAR(0.1, predicted, begins[j], "iae"); /* the model is the plant */
        double overshoot = number(begins[j], "predicted", 1);
        TEST_ASSERT_DOUBLE_WITHIN(0.01, overshoot, number(begins[j], "overshoot", 0));
    }
    SHOWS("commission", "phase kept, outputs 2, inputs 2, plant time s ");
}

/* y2 over u1: 0.8, lag 100 s, dead time 24 s; over u2: -1, 70 s, 14 s. What u1 does is there one sample of 10 s late. */
static void a_block_that_another_drives_is_shown_with_the_way_across(void)
{
    commission_plant("loop/data/triangular.json", 10000, 0.0, NULL);
    ask_ok("commission begin");
    until("PROPOSAL", 3000);
    ask_ok("commission structure");
    TEST_ASSERT_EQUAL_STRING("structure parts 1 blocks 2", reply[0]);
    TEST_ASSERT_EQUAL_STRING("block number 1 part 1 pairs 1 worst_lambda 1 driven_by -", reply[1]);
    TEST_ASSERT_EQUAL_STRING("block number 2 part 1 pairs 1 worst_lambda 1 driven_by 1", reply[2]);
    TEST_ASSERT_EQUAL_STRING("member y1 u1 block 1 single_loop yes", reply[3]);
    TEST_ASSERT_EQUAL_STRING("member y2 u2 block 2 single_loop yes", reply[4]);
    static const char way[] = "way from y1 u1 to y2 u2 ";
    static const char feed[] = "feedforward from y1 u1 to y2 u2 ";
    NEAR(0.005, 0.8, way, "gain");
    NEAR(0.01, 70.0, way, "lead");
    NEAR(0.01, 100.0, way, "lag");
    TEST_ASSERT_DOUBLE_WITHIN(1, 10, number(way, "dead", 0));
    NEAR(0, 0.0, way, "late");
    ask_ok("commission proposal");
    NEAR(0.005, 0.8, feed, "gain");
    NEAR(0.01, 70.0, feed, "lead");
    NEAR(0.01, 100.0, feed, "lag");
    TEST_ASSERT_DOUBLE_WITHIN(1, 0, number(feed, "dead", 0));
    TEST_ASSERT_EQUAL(1, times_said(" late 0 left 0 used yes\n"));
}

/* 0.9 degC/% over 2.2 kg/h/% in spans of 100 degC and 200 kg/h; 180 s of lag and 10 s of dead time between them. */
static void a_cascade_is_shown_with_what_lies_between_its_measurements(void)
{
    commission_plant("loop/data/cascade.json", 10000, 0.0, NULL);
    ask_ok("commission begin");
    until("PROPOSAL", 3000);
    ask_ok("commission structure");
    static const char begin[] = "cascade inner steam outer heated ";
    NEAR(0.005, 0.9 / 2.2 * 2, begin, "gain");
    TEST_ASSERT_DOUBLE_WITHIN(4, 190, number(begin, "lag", 0) + number(begin, "dead", 0));
    TEST_ASSERT_EQUAL(1, times_said(" misfit 0 used yes\n"));
    TEST_ASSERT_EQUAL_STRING("structure parts 2 blocks 2", reply[1]);
    TEST_ASSERT_EQUAL_STRING("block number 2 part 2 pairs 1 worst_lambda 1 driven_by -", reply[3]);
    TEST_ASSERT_EQUAL_STRING("member heated valve block 1 single_loop yes", reply[4]);
    TEST_ASSERT_EQUAL_STRING("member flow pump block 2 single_loop yes", reply[5]);
    TEST_ASSERT_EQUAL(7, n_reply);
    ask_ok("commission proposal");
    NEAR(0.01, 12.0, "inner steam valve ", "ti"); /* its lag */
    TEST_ASSERT_EQUAL(1, times_said(" td 0 reverse below heated\n"));
    ask_ok("commission model");
    static const char heated[] = "element heated valve ";
    NEAR(0.02, 192.0, heated, "T"); /* lags of 12 and 180 s */
    NEAR(0.2, 12.0 * 180.0, heated, "square");
    TEST_ASSERT_TRUE(said("element flow valve gain 0 "));
    TEST_ASSERT_EQUAL(6, times_said(" flags no_gain\n"));
}

/* Square: of lags of 90 and 30 s. */
static void a_shape_is_shown_with_the_parameters_that_it_has_and_no_others(void)
{
    static const char one[] = "element one u ", two[] = "element two u ",
                      inverse[] = "element inverse u ";
    static const char *const short_test[] = {"set test.rounds 1", NULL};
    commission_plant("loop/data/shapes.json", 10000, 0.0, short_test);
    ask_ok("commission begin");
    until("PROPOSAL", 3000);
    ask_ok("commission model");
    NEAR(0.02, 1.2, one, "gain");
    NEAR(0.05, 80.0, one, "T");
    NEAR(0.02, 86.0, one, "residence");
    NEAR(0.02, 1.6, two, "gain"); /* in units, not in spans */
    NEAR(0.02, 120.0, two, "T");
    NEAR(0.1, 2700.0, two, "square");
    NEAR(0.02, 126.0, two, "residence");
    NEAR(0.02, -0.8, inverse, "gain");
    NEAR(0.1, 2700.0, inverse, "square");
    NEAR(0.05, -40.0, inverse, "zero");
    NEAR(0.02, 166.0, inverse, "residence");
    TEST_ASSERT_EQUAL(2, times_said(" square "));
    TEST_ASSERT_EQUAL(1, times_said(" zero "));
    TEST_ASSERT_EQUAL(1, times_said(" s flags inverse\n"));
}

static void what_cannot_be_told_is_shown_as_open(void)
{
    static const char *const once[] = {"set test.rounds 1", NULL};
    commission_plant("paper-machine", 1000, 0.0, once);
    ask_ok("commission begin");
    until("NOT_DETERMINED", 12000);
    SHOWS("commission", "no proposal");
    SHOWS("commission gains", "rank 4", "null inputs u1", "null outputs y1");
    SHOWS("commission pairing", "pairing not determined", "open y");
    SHOWS("commission proposal", "no proposal: pairing not determined");
    ask_ok("commission structure");
    ask_ok("commission model");
    ask_refused("commission accept", "STATE");
    ask_refused("commission edit", "STATE");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(before_the_tests_there_is_nothing_but_the_plant);
    RUN_TEST(before_it_begins_every_listing_says_so_and_no_more);
    RUN_TEST(the_plan_counts_what_is_set_for_each_channel);
    RUN_TEST(a_pair_known_beforehand_counts_for_its_input_only);
    RUN_TEST(pairs_that_are_given_are_the_only_ones_looked_for);
    RUN_TEST(each_half_of_a_test_is_shown_with_the_worst_so_far);
    RUN_TEST(a_proposal_is_shown_with_what_it_rests_on);
    RUN_TEST(what_was_found_is_shown_in_units_of_the_plant);
    RUN_TEST(figures_of_the_gains_are_shown_as_defined);
    RUN_TEST(the_proposal_is_shown_as_it_is_put_in);
    RUN_TEST(a_trial_is_shown_beside_what_was_predicted);
    RUN_TEST(a_block_that_another_drives_is_shown_with_the_way_across);
    RUN_TEST(a_cascade_is_shown_with_what_lies_between_its_measurements);
    RUN_TEST(a_shape_is_shown_with_the_parameters_that_it_has_and_no_others);
    RUN_TEST(what_cannot_be_told_is_shown_as_open);
    int failed = UNITY_END();
    plant_power_off();
    plant_library_free();
    return failed;
}
