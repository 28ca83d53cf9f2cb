/* Properties and inputs of chips: what is taken, and words for what is not. */
#include <string.h>

#include "chips/chip.h"
#include "unity.h"

static char err[256];

void setUp(void)
{
    err[0] = '\0';
}

void tearDown(void) {}

static void expect_refused(const char *kind, const char *properties, const char *words)
{
    TEST_ASSERT_NULL(chip_new(kind, properties, 1, err, sizeof(err)));
    TEST_ASSERT_EQUAL_STRING(words, err);
}

static void properties_have_their_values_and_others_those_at_first(void)
{
    struct chip *c = chip_new("max31865", "  reference=400\twires=3 ", 1, err, sizeof(err));
    TEST_ASSERT_NOT_NULL_MESSAGE(c, err);
    TEST_ASSERT_EQUAL_DOUBLE(400, c->property[0]);
    TEST_ASSERT_EQUAL_DOUBLE(100, c->property[1]);
    TEST_ASSERT_EQUAL_DOUBLE(3, c->property[2]);
    chip_free(c);
}

static void properties_that_are_not_numbers_are_read(void)
{
    struct chip *c = chip_new("max31856", "type=T", 1, err, sizeof(err));
    TEST_ASSERT_EQUAL_DOUBLE(7, c->property[0]);
    chip_free(c);
    c = chip_new("ads1115", "address=0x4A", 1, err, sizeof(err));
    TEST_ASSERT_EQUAL_DOUBLE(0x4A, c->property[0]);
    chip_free(c);
    c = chip_new("ds18b20", "rom=28-000005e2fdc3", 1, err, sizeof(err));
    TEST_ASSERT_EQUAL_DOUBLE(0x5E2FDC3, c->property[0]);
    chip_free(c);
}

static void what_cannot_be_a_property_is_refused_in_words(void)
{
    expect_refused("max31866", "",
                   "no chip is called max31866; there are max31865, max31856, ds18b20, ads1115, "
                   "bme280, bmp280, xgzp6897, ad5422, analog, flow, mains, level");
    expect_refused(
        "max31865", "refrence=400",
        "max31865 has no property refrence; it has reference, nominal, wires, capacitor, noise");
    expect_refused("max31865", "reference=400 reference=430", "max31865: reference is there twice");
    expect_refused("max31865", "reference=4k", "max31865: reference is a number, not 4k");
    expect_refused("max31865", "reference=4", "max31865: reference is 50 to 20000 ohm, not 4");
    expect_refused("max31865", "wires=5", "max31865: wires is 2 to 4, not 5");
    expect_refused("max31865", "400", "max31865: 400 is no property; one is written name=value");
    expect_refused("max31856", "type=KK", "max31856: type is a letter of BEJKNRST, not KK");
    expect_refused("max31856", "type=", "max31856: type is a letter of BEJKNRST, not ");
    expect_refused("ads1115", "address=0x4c",
                   "ads1115: address 0x4c is none that it can have: 0x48 to 0x4b");
    expect_refused("ads1115", "address=72", "ads1115: address is 0x48 to 0x4b, not 72");
    expect_refused("ds18b20", "rom=10-000005e2fdc3",
                   "ds18b20: rom is 28- and 12 hexadecimal digits, not 10-000005e2fdc3");
    expect_refused("ds18b20", "rom=28-05e2fdc3",
                   "ds18b20: rom is 28- and 12 hexadecimal digits, not 28-05e2fdc3");
    char lengthy[300];
    memset(lengthy, 'a', sizeof(lengthy));
    lengthy[sizeof(lengthy) - 1] = '\0';
    expect_refused("max31865", lengthy, "max31865: property of more than 127 characters");
}

static void every_kind_is_whole_and_has_words_for_its_inputs(void)
{
    size_t n;
    const struct chip_kind *const *kinds = chip_kinds(&n);
    TEST_ASSERT_EQUAL_size_t(12, n);
    for (size_t i = 0; i < n; i++) {
        const struct chip_kind *k = kinds[i];
        struct chip *c = chip_new(k->name, "", 3, err, sizeof(err));
        TEST_ASSERT_NOT_NULL_MESSAGE(c, err);
        TEST_ASSERT_TRUE(k->n_inputs <= CHIP_INPUTS_MAX && k->n_properties <= CHIP_INPUTS_MAX);
        TEST_ASSERT_TRUE(k->bus != CHIP_SPI || (k->select && k->exchange));
        TEST_ASSERT_TRUE(k->bus != CHIP_I2C || (k->address && k->write && k->read && k->stop));
        TEST_ASSERT_TRUE(k->bus != CHIP_ONEWIRE || (k->presence && k->bit_in && k->bit_out));
        TEST_ASSERT_TRUE(k->bus != CHIP_PIN ||
                         (k->begin && (k->pin_volts || (k->low && k->next_edge))));
        for (size_t m = 0; m < k->n_inputs; m++) {
            const struct chip_input *in = &k->inputs[m];
            TEST_ASSERT_TRUE(in->lo <= in->at_first && in->at_first <= in->hi && in->what[0]);
            TEST_ASSERT_EQUAL_DOUBLE(in->at_first, c->input[m]);
            TEST_ASSERT_EQUAL_INT(m, chip_input_index(k, in->name));
        }
        chip_free(c);
    }
}

static void inputs_are_set_and_refused_in_words(void)
{
    struct chip *c = chip_new("max31865", "", 1, err, sizeof(err));
    TEST_ASSERT_TRUE(chip_set(c, "temperature", 78.3, err, sizeof(err)));
    TEST_ASSERT_EQUAL_DOUBLE(78.3, c->input[0]);
    TEST_ASSERT_FALSE(chip_set(c, "temprature", 1, err, sizeof(err)));
    TEST_ASSERT_EQUAL_STRING("max31865 has no input temprature; it has temperature, lead, open, "
                             "force_open, short, ground, "
                             "overvoltage, brownout, dead",
                             err);
    TEST_ASSERT_FALSE(chip_set(c, "temperature", 900, err, sizeof(err)));
    TEST_ASSERT_EQUAL_STRING("max31865: temperature is -200 to 850 degC, not 900", err);
    TEST_ASSERT_FALSE(chip_set(c, "open", 2, err, sizeof(err)));
    TEST_ASSERT_FALSE(chip_set(c, "temperature", 0.0 / 0.0, err, sizeof(err)));
    TEST_ASSERT_EQUAL_DOUBLE(78.3, c->input[0]);
    chip_free(c);
}

static void a_chip_answers_with_power_unless_it_is_dead(void)
{
    struct chip *c = chip_new("ads1115", "", 1, err, sizeof(err));
    TEST_ASSERT_FALSE(chip_answers(c));
    chip_at(c, 5); /* without power nothing happens */
    chip_power(c, 10, true);
    TEST_ASSERT_TRUE(chip_answers(c));
    TEST_ASSERT_TRUE(chip_set(c, "dead", 1, err, sizeof(err)));
    TEST_ASSERT_FALSE(chip_answers(c));
    TEST_ASSERT_TRUE(chip_set(c, "dead", 0, err, sizeof(err)));
    chip_power(c, 20, false);
    TEST_ASSERT_FALSE(chip_answers(c));
    chip_free(c);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(properties_have_their_values_and_others_those_at_first);
    RUN_TEST(properties_that_are_not_numbers_are_read);
    RUN_TEST(what_cannot_be_a_property_is_refused_in_words);
    RUN_TEST(every_kind_is_whole_and_has_words_for_its_inputs);
    RUN_TEST(inputs_are_set_and_refused_in_words);
    RUN_TEST(a_chip_answers_with_power_unless_it_is_dead);
    return UNITY_END();
}
