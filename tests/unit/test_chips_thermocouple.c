/* Reference functions of thermocouples against the tables of NIST Monograph 175, in mV with three decimals. */
#include "chips/thermocouple.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

static void voltages_are_those_of_the_published_tables(void)
{
    /* K to -130 degC: instrumentation.com/RTDTables/emfk_c_1.htm. T below 0 degC: srdata.nist.gov/its90/download/type_t.tab. The others: ends of the
     * ranges of the approximate inverse functions in NIST's allcoeff.tab, voltage and temperature; without those of S at -50, 1200 and 1768.1 degC,
     * which are cut there, not rounded. */
    static const struct {
        char type;
        double degc, mv;
    } rows[] = {
        {'K', -270, -6.458},   {'K', -250, -6.404},   {'K', -215, -6.099}, {'K', -200, -5.891},
        {'K', -150, -4.913},   {'K', 0, 0},           {'K', 500, 20.644},  {'K', 1372, 54.886},
        {'T', -270, -6.258},   {'T', -200, -5.603},   {'T', -155, -4.759}, {'T', -100, -3.379},
        {'T', -50, -1.819},    {'T', 0, 0},           {'T', 400, 20.872},  {'B', 250, 0.291},
        {'B', 700, 2.431},     {'B', 1820, 13.820},   {'E', -200, -8.825}, {'E', 0, 0},
        {'E', 1000, 76.373},   {'J', -210, -8.095},   {'J', 0, 0},         {'J', 760, 42.919},
        {'J', 1200, 69.553},   {'N', -200, -3.990},   {'N', 0, 0},         {'N', 600, 20.613},
        {'N', 1300, 47.513},   {'R', -50, -0.226},    {'R', 250, 1.923},   {'R', 1200, 13.228},
        {'R', 1664.5, 19.739}, {'R', 1768.1, 21.103}, {'S', 250, 1.874},   {'S', 1664.5, 17.536}};
    for (unsigned i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
        TEST_ASSERT_DOUBLE_WITHIN(0.0005000001, rows[i].mv,
                                  thermocouple_mv(rows[i].type, rows[i].degc));
    }
}

static void pieces_of_a_function_meet(void)
{
    static const struct {
        char type;
        double degc;
    } joints[] = {{'B', 630.615}, {'E', 0},      {'J', 760},     {'K', 0},      {'N', 0},
                  {'R', 1064.18}, {'R', 1664.5}, {'S', 1064.18}, {'S', 1664.5}, {'T', 0}};
    for (unsigned i = 0; i < sizeof(joints) / sizeof(joints[0]); i++) {
        double below = thermocouple_mv(joints[i].type, joints[i].degc);
        double above = thermocouple_mv(joints[i].type, joints[i].degc + 1e-9);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, below, above); /* 10 nV */
    }
}

static void the_way_back_ends_where_it_began(void)
{
    for (const char *type = THERMOCOUPLES; *type != '\0'; type++) {
        double lo;
        double hi;
        TEST_ASSERT_TRUE(thermocouple_range(*type, &lo, &hi));
        lo = *type == 'B' ? 42.0 : lo;
        for (unsigned i = 0; i <= 100; i++) {
            double degc = lo + (hi - lo) * i / 100.0;
            double back = thermocouple_degc(*type, thermocouple_mv(*type, degc), lo, hi);
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, degc, back);
        }
    }
}

static void letters_have_their_places_and_others_none(void)
{
    double lo;
    double hi;
    TEST_ASSERT_EQUAL_INT(0, thermocouple_index('B'));
    TEST_ASSERT_EQUAL_INT(3, thermocouple_index('K'));
    TEST_ASSERT_EQUAL_INT(7, thermocouple_index('T'));
    TEST_ASSERT_EQUAL_INT(-1, thermocouple_index('X'));
    TEST_ASSERT_EQUAL_INT(-1, thermocouple_index('\0'));
    TEST_ASSERT_FALSE(thermocouple_range('X', &lo, &hi));
    TEST_ASSERT_TRUE(thermocouple_mv('X', 20) != thermocouple_mv('X', 20));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(voltages_are_those_of_the_published_tables);
    RUN_TEST(pieces_of_a_function_meet);
    RUN_TEST(the_way_back_ends_where_it_began);
    RUN_TEST(letters_have_their_places_and_others_none);
    return UNITY_END();
}
