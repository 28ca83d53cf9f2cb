/* Wiring files: what they say is what is there, and errors say file, line, what is wrong and what would be right. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "chips/chip.h"
#include "chips/wiring.h"
#include "unity.h"

static char path[64];
static char err[512];
static struct wiring *w;

void setUp(void)
{
    w = NULL;
    (void)snprintf(path, sizeof(path), "/tmp/wiring_test_XXXXXX");
    int file = mkstemp(path);
    TEST_ASSERT_TRUE(file >= 0);
    (void)close(file);
}

void tearDown(void)
{
    wiring_free(w);
    (void)remove(path);
}

static struct wiring *read_text(const char *text)
{
    FILE *f = fopen(path, "w");
    TEST_ASSERT_NOT_NULL(f);
    (void)fputs(text, f);
    (void)fclose(f);
    wiring_free(w);
    w = wiring_read(path, 1, err, sizeof(err));
    return w;
}

static void expect_refused(const char *text, unsigned line, const char *words)
{
    char expected[640];
    TEST_ASSERT_NULL(read_text(text));
    (void)snprintf(expected, sizeof(expected), "%s, line %u: %s", path, line, words);
    TEST_ASSERT_EQUAL_STRING(expected, err);
}

static const char column[] = "# a column\n"
                             "T1   max31865  spi1 PA4   reference=400 wires=3\n"
                             "T2   max31856  spi1 PA3   type=T # tail\n"
                             "\n"
                             "T10  ds18b20   wire1      rom=28-000005e2fdc3\n"
                             "T11  ds18b20   wire1\n"
                             "dP   ads1115   i2c1 0x49 2  lo=0 hi=60 lo_in=0.4 hi_in=2\n"
                             "F    ads1115   i2c1 0x49 3  quantity=flow\n"
                             "P    bme280    i2c1 0x76 pressure hi_in=100\n"
                             "Q    ssr       PB0        hi=3\n"
                             "E    relay     PB1        active=low\n"
                             "W    pwm       PB6        lo=2 hi=10 active=high\n"
                             "Lr   valve     PB8 PB9    hi=20 travel=60\n"
                             "V    valve     PC1\n";

static void a_file_makes_a_table_of_sensors_and_outputs(void)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(read_text(column), err);
    TEST_ASSERT_EQUAL_size_t(7, wiring_n_sensors(w));
    TEST_ASSERT_EQUAL_size_t(5, wiring_n_outputs(w));
    const struct wiring_sensor *s = wiring_sensor(w, 0);
    TEST_ASSERT_EQUAL_STRING("T1", s->name);
    TEST_ASSERT_EQUAL_STRING("T1", s->quantity);
    TEST_ASSERT_EQUAL_STRING("temperature", s->input);
    TEST_ASSERT_EQUAL_INT(CHIP_SPI, s->bus);
    TEST_ASSERT_EQUAL_UINT(1, s->bus_number);
    TEST_ASSERT_EQUAL_UINT(HAL_PIN('A', 4), s->select);
    TEST_ASSERT_EQUAL_UINT(2, s->line);
    TEST_ASSERT_EQUAL_STRING("max31865", s->chip->kind->name);
    TEST_ASSERT_EQUAL_DOUBLE(400, s->chip->property[0]);
    TEST_ASSERT_EQUAL_DOUBLE(7, wiring_sensor(w, 1)->chip->property[0]);
    s = wiring_sensor(w, 4);
    TEST_ASSERT_EQUAL_HEX8(0x49, s->address);
    TEST_ASSERT_EQUAL_STRING("in2", s->input);
    TEST_ASSERT_EQUAL_DOUBLE(0x49, s->chip->property[0]);
    TEST_ASSERT_EQUAL_PTR(s->chip, wiring_sensor(w, 5)->chip); /* two inputs of one chip */
    TEST_ASSERT_EQUAL_STRING("flow", wiring_sensor(w, 5)->quantity);
    const struct wiring_output *o = wiring_output(w, 1);
    TEST_ASSERT_EQUAL_STRING("E", o->name);
    TEST_ASSERT_EQUAL_INT(WIRING_RELAY, o->kind);
    TEST_ASSERT_EQUAL_UINT(HAL_PIN('B', 1), o->pin);
    TEST_ASSERT_TRUE(o->low_active);
    TEST_ASSERT_EQUAL_UINT(HAL_PIN_NONE, o->close_pin);
    o = wiring_output(w, 2);
    TEST_ASSERT_EQUAL_INT(WIRING_PWM, o->kind);
    TEST_ASSERT_EQUAL_DOUBLE(2, o->lo);
    TEST_ASSERT_EQUAL_DOUBLE(10, o->hi);
    TEST_ASSERT_FALSE(o->low_active);
    o = wiring_output(w, 3);
    TEST_ASSERT_EQUAL_INT(WIRING_VALVE, o->kind);
    TEST_ASSERT_EQUAL_UINT(HAL_PIN('B', 9), o->close_pin);
    TEST_ASSERT_EQUAL_DOUBLE(60, o->travel_s);
    TEST_ASSERT_NOT_NULL(wiring_bus(w, CHIP_SPI, 1));
    TEST_ASSERT_NOT_NULL(wiring_bus(w, CHIP_I2C, 1));
    TEST_ASSERT_NOT_NULL(wiring_bus(w, CHIP_ONEWIRE, 1));
    TEST_ASSERT_NULL(wiring_bus(w, CHIP_SPI, 2));
    TEST_ASSERT_NULL(wiring_bus(w, CHIP_SPI, 0));
    TEST_ASSERT_NULL(wiring_bus(w, CHIP_SPI, 10));
}

static void a_quantity_reaches_the_chip_over_its_line(void)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(read_text(column), err);
    wiring_measure(w, 0, 78.3);
    TEST_ASSERT_EQUAL_DOUBLE(78.3, wiring_sensor(w, 0)->chip->input[0]);
    wiring_measure(w, 4, 30); /* half of 0 to 60 at 0.4 to 2 V */
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.2, wiring_sensor(w, 4)->chip->input[2]);
    wiring_measure(w, 6, 1000); /* mbar */
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 100000, wiring_sensor(w, 6)->chip->input[0]);
    wiring_measure(w, 6, 2000); /* the chip ends there */
    TEST_ASSERT_EQUAL_DOUBLE(110000, wiring_sensor(w, 6)->chip->input[0]);
}

static void chips_of_a_file_answer_on_their_buses(void)
{
    unsigned count;
    TEST_ASSERT_NOT_NULL_MESSAGE(read_text(column), err);
    struct chips *spi = wiring_bus(w, CHIP_SPI, 1);
    struct chips *wire = wiring_bus(w, CHIP_ONEWIRE, 1);
    TEST_ASSERT_EQUAL_INT(CHIPS_SILENT, chips_reset(wire, 0));
    wiring_power(w, 0, true);
    wiring_at(w, 1000);
    TEST_ASSERT_EQUAL_INT(CHIPS_ANSWER, chips_reset(wire, 2000));
    TEST_ASSERT_EQUAL_INT(CHIPS_ANSWER, chips_start(wiring_bus(w, CHIP_I2C, 1), 2000, 0x49, false));
    chips_select(spi, 3000, HAL_PIN('A', 3), true);
    (void)chips_exchange(spi, 11000, 1, 0x01);
    TEST_ASSERT_EQUAL_HEX8(0x03, chips_exchange(spi, 19000, 1, 0)); /* CR1 of the MAX31856 */
    chips_select(spi, 20000, HAL_PIN('A', 3), false);
    TEST_ASSERT_EQUAL_STRING("", wiring_wrong(w, &count));
    chips_select(spi, 30000, HAL_PIN('A', 4), true);
    (void)chips_exchange(spi, 38000, 0, 0x00);
    TEST_ASSERT_EQUAL_STRING("max31865: SPI mode 0; it takes modes 1 and 3",
                             wiring_wrong(w, &count));
    TEST_ASSERT_EQUAL_UINT(1, count);
}

static void chips_without_an_address_get_different_ones(void)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(read_text("A ds18b20 wire1\nB ds18b20 wire1\n"), err);
    wiring_power(w, 0, true);
    TEST_ASSERT_TRUE(wiring_sensor(w, 0)->chip->property[0] !=
                     wiring_sensor(w, 1)->chip->property[0]);
}

static void faults_are_set_by_name(void)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(read_text(column), err);
    TEST_ASSERT_TRUE(wiring_set(w, "T1", "open", 1, err, sizeof(err)));
    TEST_ASSERT_EQUAL_DOUBLE(1, wiring_sensor(w, 0)->chip->input[2]);
    TEST_ASSERT_TRUE(wiring_set(w, "spi1", "noise", 0.1, err, sizeof(err)));
    TEST_ASSERT_TRUE(wiring_set(w, "wire1", "stuck", 1, err, sizeof(err)));
    TEST_ASSERT_EQUAL_INT(CHIPS_HELD_LOW, chips_reset(wiring_bus(w, CHIP_ONEWIRE, 1), 0));
    TEST_ASSERT_FALSE(wiring_set(w, "spi2", "noise", 0.1, err, sizeof(err)));
    TEST_ASSERT_EQUAL_STRING("nothing is wired to spi2", err);
    TEST_ASSERT_FALSE(wiring_set(w, "T3", "open", 1, err, sizeof(err)));
    TEST_ASSERT_EQUAL_STRING("nothing called T3 is wired", err);
    TEST_ASSERT_FALSE(wiring_set(w, "Q", "open", 1, err, sizeof(err)));
    TEST_ASSERT_EQUAL_STRING("output Q has no fault open; it has shorted, broken", err);
}

static void a_load_follows_its_pin_unless_it_is_shorted_or_broken(void)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(read_text(column), err);
    const struct wiring_output *ssr = wiring_output(w, 0);
    const struct wiring_output *low = wiring_output(w, 1);
    TEST_ASSERT_TRUE(wiring_load(ssr, true));
    TEST_ASSERT_FALSE(wiring_load(ssr, false));
    TEST_ASSERT_FALSE(wiring_load(low, true));
    TEST_ASSERT_TRUE(wiring_load(low, false));
    TEST_ASSERT_TRUE(wiring_set(w, "Q", "shorted", 1, err, sizeof(err)));
    TEST_ASSERT_TRUE(wiring_load(ssr, false));
    TEST_ASSERT_TRUE(wiring_set(w, "Q", "broken", 1, err, sizeof(err)));
    TEST_ASSERT_FALSE(wiring_load(ssr, true));
}

static void lines_that_are_not_whole_are_refused(void)
{
    expect_refused("T1\n", 1, "a line is a name, a chip or output, its place and properties");
    expect_refused("T1 reference=400\n", 1,
                   "a line is a name, a chip or output, its place and properties");
    expect_refused("\n\nT1 max31866 spi1 PA4\n", 3,
                   "max31866 is no chip and no output; there are max31865, max31856, ds18b20, "
                   "ads1115, bme280, bmp280, xgzp6897, ad5422, "
                   "analog, flow, mains, level, ssr, relay, pwm, valve, stepper");
    expect_refused("F flow\n", 1, "flow stands at one pin, as in PC0");
    expect_refused("F flow PC9 PC8\n", 1, "flow stands at one pin, as in PC0");
    expect_refused("F flow spi1\n", 1, "spi1 is no pin; pins are PA0 to PI15");
    expect_refused("F flow PC9\nL level PC9\n", 2,
                   "PC9 is the pin of F in line 1; each has its own pin");
    expect_refused("T1 max31865\n", 1, "max31865 stands on a bus, as in spi1 PA4");
    expect_refused("T1 max31865 PA4\n", 1, "max31865 stands on a bus, as in spi1 PA4");
    expect_refused("T1 max31865 spi1\n", 1, "max31865 has its place as in spi1 PA4");
    expect_refused("T1 max31865 i2c1 0x48\n", 1,
                   "i2c1 is no bus for a max31865; it stands on one as in spi1 PA4");
    expect_refused("T1 max31865 spi1 PA4 temperature lead\n", 1,
                   "max31865 has its place as in spi1 PA4, and one input");
    expect_refused("T1 max31865 spi1 PA16\n", 1, "PA16 is no pin; pins are PA0 to PI15");
    expect_refused("T1 max31865 spi1 4\n", 1, "4 is no pin; pins are PA0 to PI15");
    expect_refused("dP ads1115 i2c1 72 2\n", 1, "72 is no address; one is written 0x48");
    expect_refused("T1 max31865 spi1 PA4 reference=400 4\n", 1,
                   "4 stands behind properties, which are name=value");
    expect_refused("1T max31865 spi1 PA4\n", 1,
                   "1T is no name; it has up to 15 letters, digits, - and _, a letter in front");
    expect_refused("spi1 max31865 spi1 PA4\n", 1, "spi1 is the name of a bus");
}

static void one_thing_at_two_places_is_refused(void)
{
    expect_refused("T1 max31865 spi1 PA4\nT1 ds18b20 wire1\n", 2, "T1 is there already, in line 1");
    expect_refused("Q ssr PB0\nT1 max31865 spi1 PA4\nR ssr PB0\n", 3,
                   "PB0 is a pin of Q in line 1; each has its own pin");
    expect_refused("T1 max31865 spi1 PA4\nQ ssr PA4\n", 2,
                   "PA4 is the select of T1 in line 1; each has its own pin");
    expect_refused("Q ssr PA4\nT1 max31865 spi1 PA4\n", 2,
                   "PA4 is a pin of Q in line 1; each has its own pin");
    expect_refused("T1 max31865 spi1 PA4\nT2 max31856 spi1 PA4\n", 2,
                   "PA4 has max31865 already, T1 in line 1; each chip has its own");
    expect_refused("T1 max31865 spi1 PA4\nT2 max31865 spi1 PA4\n", 2,
                   "temperature at PA4 is T1 in line 1 already; each has an input of its own");
    expect_refused("a ads1115 i2c1 0x48 0\nb bme280 i2c2 0x76\nc ads1115 i2c1 0x48 in0\n", 3,
                   "in0 at 0x48 is a in line 1 already; each has an input of its own");
    expect_refused("a ads1115 i2c1 0x48 0\nb ads1115 i2c1 0x48 1 supply=5\n", 2,
                   "properties of the chip stand in line 1, with a");
    expect_refused("a ds18b20 wire1 rom=28-000005e2fdc3\nb ds18b20 wire1 rom=28-000005E2FDC3\n", 2,
                   "the rom is that of a in line 1; each chip has its own");
    expect_refused("V valve PB0 PB1 travel=9\nQ ssr PB1\n", 2,
                   "PB1 is a pin of V in line 1; each has its own pin");
    expect_refused("V valve PB0 PB1 PC0 PC1 travel=9\nQ ssr PC1\n", 2,
                   "PC1 is a pin of V in line 1; each has its own pin");
    expect_refused("V valve PB0 PB1 PC0 PB1 travel=9\n", 1,
                   "PB1 stands twice; a valve has a pin for each way and each end");
    expect_refused("V valve PB0 PB0 travel=9\n", 1,
                   "PB0 stands twice; a valve has a pin for each way and each end");
}

static void two_quantities_of_one_chip_are_two_lines(void)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(
        read_text("T max31856 spi1 PA4 type=T\nC max31856 spi1 PA4 cold\n"), err);
    TEST_ASSERT_EQUAL_PTR(wiring_sensor(w, 0)->chip, wiring_sensor(w, 1)->chip);
    wiring_measure(w, 0, 80);
    wiring_measure(w, 1, 30);
    TEST_ASSERT_EQUAL_DOUBLE(80, wiring_sensor(w, 0)->chip->input[0]);
    TEST_ASSERT_EQUAL_DOUBLE(30, wiring_sensor(w, 0)->chip->input[1]);
}

static void the_same_address_on_two_buses_is_two_chips(void)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(read_text("a ads1115 i2c1 0x48 0\nb ads1115 i2c2 0x48 0\n"), err);
    TEST_ASSERT_TRUE(wiring_sensor(w, 0)->chip != wiring_sensor(w, 1)->chip);
}

static void properties_that_do_not_fit_are_refused(void)
{
    expect_refused(
        "T1 max31865 spi1 PA4 refrence=4\n", 1,
        "max31865 has no property refrence; it has reference, nominal, wires, capacitor, noise");
    expect_refused("T1 max31865 spi1 PA4 wires=5\n", 1, "max31865: wires is 2 to 4, not 5");
    expect_refused("T1 max31865 spi1 PA4 lo=x\n", 1, "lo is a number, not x");
    expect_refused("T1 max31865 spi1 PA4 lo=1 hi=1\n", 1,
                   "lo and hi, lo_in and hi_in are two values each, not one");
    expect_refused("T1 max31865 spi1 PA4 active=low\n", 1,
                   "active and travel are properties of outputs");
    expect_refused("T1 max31865 spi1 PA4 open\n", 1,
                   "max31865 does not measure open; it measures temperature lead");
    expect_refused("dP ads1115 i2c1 0x48\n", 1,
                   "ads1115 has several inputs; the number of one stands behind the address");
    expect_refused("dP ads1115 i2c1 0x48 4\n", 1,
                   "ads1115 does not measure 4; it measures in0 in1 in2 in3");
    expect_refused("dP ads1115 i2c1 0x4c 0\n", 1,
                   "ads1115: address 0x4c is none that it can have: 0x48 to 0x4b");
    expect_refused("dP ads1115 i2c1 0x48 0 address=0x49\n", 1,
                   "the address stands behind the bus, not as a property");
    expect_refused("T1 max31865 spi1 PA4 quantity=\n", 1,
                   "quantity is a name of up to 15 characters");
    expect_refused("Q ssr PB0 period=1\n", 1,
                   "ssr has no property period=1; it has quantity, active, lo, hi");
    expect_refused("Q ssr PB0 active=yes\n", 1, "active is high or low, not yes");
    expect_refused("Q ssr\n", 1, "ssr stands with no pin; it has one pin");
    expect_refused("Q ssr PB0 PB1\n", 1, "ssr stands with too many pins; it has one pin");
    expect_refused("V valve PB0 PB1\n", 1,
                   "travel=, in s, stands with a valve that pins open and close and nowhere else");
    expect_refused("V valve PB0 PB1 PC0 travel=60\n", 1,
                   "valve stands with too many pins; it has one pin, or two that open and close "
                   "it, and then two or none of contacts at its ends");
    expect_refused("V valve PB0 travel=60\n", 1,
                   "travel=, in s, stands with a valve that pins open and close and nowhere else");
    expect_refused("Q ssr PB0 lo_in=0.5\n", 1,
                   "ssr has no property lo_in or hi_in; it has quantity, active, lo, hi");
}

static void a_chip_with_a_load_is_an_output_with_latch_and_clear(void)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(
        read_text("Lr ad5422 spi1 PC4 loop=500 clear=PC5 supply=30 hi=12\n"
                  "Q  ad5422 spi2 PC0 clear=PC1 signal=voltage quantity=heat\n"
                  "D  ad5422 spi2 PC2 clear=PC3 lo_in=0 hi_in=24\n"),
        err);
    TEST_ASSERT_EQUAL_size_t(0, wiring_n_sensors(w));
    TEST_ASSERT_EQUAL_size_t(3, wiring_n_outputs(w));
    const struct wiring_output *o = wiring_output(w, 0);
    TEST_ASSERT_EQUAL_INT(WIRING_CHIP, o->kind);
    TEST_ASSERT_EQUAL_UINT(HAL_PIN('C', 4), o->pin);
    TEST_ASSERT_EQUAL_UINT(HAL_PIN('C', 5), o->clear_pin);
    TEST_ASSERT_EQUAL_DOUBLE(12, o->hi);
    TEST_ASSERT_EQUAL_DOUBLE(4, o->lo_in);
    TEST_ASSERT_EQUAL_DOUBLE(20, o->hi_in);
    TEST_ASSERT_EQUAL_DOUBLE(500, o->chip->property[1]);
    TEST_ASSERT_EQUAL_DOUBLE(30, o->chip->property[2]);
    o = wiring_output(w, 1);
    TEST_ASSERT_EQUAL_STRING("heat", o->quantity);
    TEST_ASSERT_EQUAL_DOUBLE(0, o->lo_in);
    TEST_ASSERT_EQUAL_DOUBLE(10, o->hi_in);
    TEST_ASSERT_EQUAL_DOUBLE(24, wiring_output(w, 2)->hi_in);
    TEST_ASSERT_NOT_NULL(wiring_bus(w, CHIP_SPI, 2));
}

static void a_line_of_a_chip_with_a_load_that_is_not_whole_is_refused(void)
{
    expect_refused("Lr ad5422 spi1 PC4\n", 1, "ad5422 needs clear=, the pin of its CLEAR");
    expect_refused("Lr ad5422 PC4 clear=PC5\n", 1, "ad5422 has its place as in spi1 PA4");
    expect_refused("Lr ad5422 i2c1 0x48 clear=PC5\n", 1, "ad5422 has its place as in spi1 PA4");
    expect_refused("Lr ad5422 spi1 PC4 clear=C5\n", 1, "C5 is no pin; pins are PA0 to PI15");
    expect_refused("Lr ad5422 spi1 PC4 clear=PC4\n", 1,
                   "PC4 stands twice; LATCH and CLEAR are two pins");
    expect_refused("Lr ad5422 spi1 PC4 clear=PC5\nQ ssr PC5\n", 2,
                   "PC5 is a pin of Lr in line 1; each has its own pin");
    expect_refused("T1 max31865 spi1 PC4\nLr ad5422 spi1 PC4 clear=PC5\n", 2,
                   "PC4 is the select of T1 in line 1; each has its own pin");
    expect_refused("Lr ad5422 spi1 PC4 clear=PC5 active=low\n", 1,
                   "ad5422 has no property active or travel");
    expect_refused("Lr ad5422 spi1 PC4 clear=PC5 signal=mA\n", 1,
                   "ad5422: signal is current or voltage, not mA");
}

static void a_stepper_is_an_output_with_steps(void)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(
        read_text("Lr stepper PB3 PB4 steps=120 hi=12\nD stepper PB5 hi=2 steps=500 active=low\n"),
        err);
    const struct wiring_output *o = wiring_output(w, 0);
    TEST_ASSERT_EQUAL_INT(WIRING_STEPPER, o->kind);
    TEST_ASSERT_EQUAL_UINT(HAL_PIN('B', 4), o->close_pin);
    TEST_ASSERT_EQUAL_DOUBLE(120, o->steps);
    o = wiring_output(w, 1);
    TEST_ASSERT_EQUAL_UINT(HAL_PIN_NONE, o->close_pin);
    TEST_ASSERT_TRUE(o->low_active);
    expect_refused("Lr stepper PB3 hi=12\n", 1, "stepper needs steps=, a number for each ml");
    expect_refused("Lr stepper PB3 hi=12 steps=0\n", 1,
                   "stepper needs steps=, a number for each ml");
    expect_refused("Lr stepper steps=5\n", 1,
                   "stepper has the pin of its steps, and one of its direction or none");
    expect_refused("Lr stepper PB3 PB4 PB5 steps=5\n", 1,
                   "stepper has the pin of its steps, and one of its direction or none");
    expect_refused("Lr stepper PB3 PB3 steps=5\n", 1,
                   "PB3 stands twice; steps and direction are two pins");
    expect_refused("Lr stepper PB3 steps=5 lo=1 hi=2\n", 1,
                   "a stepper gives from 0 to hi l/h, and has no lo");
    expect_refused("Lr stepper PB3 steps=5 speed=1\n", 1,
                   "stepper has no property speed=1; it has quantity, active, hi, steps");
}

static void a_file_that_is_not_there_is_told(void)
{
    TEST_ASSERT_NULL(wiring_read("no/such/file", 1, err, sizeof(err)));
    TEST_ASSERT_EQUAL_STRING("no/such/file: No such file or directory", err);
}

static void lines_beyond_bounds_are_refused(void)
{
    char text[4096] = "T1 max31865 spi1 PA4 ";
    memset(text + strlen(text), 'a', 600);
    expect_refused(text, 1, "longer than 510 characters");
    (void)snprintf(text, sizeof(text), "%s", "");
    for (unsigned i = 0; i < 17; i++) {
        (void)snprintf(text + strlen(text), sizeof(text) - strlen(text), "T%u ds18b20 wire1\n", i);
    }
    expect_refused(text, 17, "ds18b20: more than 16 chips on one bus");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_file_makes_a_table_of_sensors_and_outputs);
    RUN_TEST(a_quantity_reaches_the_chip_over_its_line);
    RUN_TEST(chips_of_a_file_answer_on_their_buses);
    RUN_TEST(chips_without_an_address_get_different_ones);
    RUN_TEST(faults_are_set_by_name);
    RUN_TEST(a_load_follows_its_pin_unless_it_is_shorted_or_broken);
    RUN_TEST(lines_that_are_not_whole_are_refused);
    RUN_TEST(one_thing_at_two_places_is_refused);
    RUN_TEST(two_quantities_of_one_chip_are_two_lines);
    RUN_TEST(the_same_address_on_two_buses_is_two_chips);
    RUN_TEST(properties_that_do_not_fit_are_refused);
    RUN_TEST(a_chip_with_a_load_is_an_output_with_latch_and_clear);
    RUN_TEST(a_line_of_a_chip_with_a_load_that_is_not_whole_is_refused);
    RUN_TEST(a_stepper_is_an_output_with_steps);
    RUN_TEST(a_file_that_is_not_there_is_told);
    RUN_TEST(lines_beyond_bounds_are_refused);
    return UNITY_END();
}
