/* Masters that know nothing of a data sheet: whatever they send, no model writes beyond its memory or hangs, and each of them works by the book
 * afterwards. To be run with the sanitizers. */
#include <stdio.h>

#include "chip_bench.h"

#define SEED   38u
#define ROUNDS 20000u

static uint64_t state;

void setUp(void)
{
    state = SEED;
}

void tearDown(void) {}

static uint32_t draw(uint32_t below)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(state >> 33) % below;
}

/* A command that exists is worth more than one that does not. */
static uint8_t draw_byte(void)
{
    static const uint8_t known[] = {0x00, 0x01, 0x80, 0x81, 0x03, 0x30, 0x0A, 0xF4,
                                    0x25, 0xF7, 0xCC, 0x44, 0xBE, 0x4E, 0x48, 0xF0,
                                    0x55, 0x33, 0xB6, 0xE0, 0xC3, 0xFF};
    return draw(2) ? known[draw(sizeof(known))] : (uint8_t)draw(256);
}

static void change_the_world(void)
{
    const struct chip_kind *kind = bench_chip->kind;
    const struct chip_input *in = &kind->inputs[draw((uint32_t)kind->n_inputs)];
    bench_set(in->name, draw(4) == 0 ? in->lo : draw(4) == 0 ? in->hi : in->at_first);
    if (draw(50) == 0) {
        bench_set("dead", draw(2));
        chip_power(bench_chip, bench_ns, draw(3) != 0);
    }
}

static void spi_rubbish(void)
{
    bench_mode = draw(20) == 0 ? draw(4) : 1;
    bench_select(true);
    for (uint32_t n = draw(12); n > 0; n--) {
        (void)bench_exchange(draw_byte());
    }
    if (draw(20) == 0) {
        chips_clock_bits(bench_bus, bench_ns, 1 + draw(7));
    }
    bench_select(draw(20) == 0);
}

static void i2c_rubbish(uint8_t own)
{
    for (uint32_t starts = 1 + draw(3); starts > 0; starts--) {
        bool read = draw(2);
        bench_ns += 90000;
        (void)chips_start(bench_bus, bench_ns, draw(8) == 0 ? (uint8_t)draw(128) : own, read);
        for (uint32_t n = draw(40); n > 0; n--) {
            bench_ns += 90000;
            if (draw(10) ? read : !read) {
                (void)chips_read(bench_bus, bench_ns, draw(2));
            } else {
                (void)chips_write(bench_bus, bench_ns, draw_byte());
            }
        }
    }
    chips_stop(bench_bus, bench_ns);
}

static void wire_rubbish(void)
{
    if (draw(4)) {
        (void)chips_reset(bench_bus, bench_ns);
    }
    for (uint32_t n = draw(14); n > 0; n--) {
        uint8_t byte = draw_byte();
        for (unsigned i = 0; i < 8; i++) {
            bench_ns += 70000;
            (void)chips_slot(bench_bus, bench_ns, ((unsigned)byte >> i) & 1u);
        }
    }
}

static void send_rubbish(const char *kind, uint8_t address)
{
    printf("%s, seed %u\n", kind, SEED);
    bench_make(kind, "", SEED);
    for (unsigned i = 0; i < ROUNDS; i++) {
        if (draw(5) == 0) {
            change_the_world();
        }
        if (draw(200) == 0) {
            TEST_ASSERT_TRUE(
                chips_set(bench_bus, "noise", draw(2) ? 0.01 : 0.0, bench_err, sizeof(bench_err)));
        }
        switch (bench_chip->kind->bus) {
        case CHIP_SPI:
            spi_rubbish();
            break;
        case CHIP_I2C:
            i2c_rubbish(address);
            break;
        case CHIP_ONEWIRE:
            wire_rubbish();
            break;
        case CHIP_PIN:
            break;
        }
        bench_wait_us(draw(20000));
    }
    TEST_ASSERT_TRUE(bench_chip->wrongs > ROUNDS / 100u);
    /* The world is in order again. */
    TEST_ASSERT_TRUE(chips_set(bench_bus, "noise", 0.0, bench_err, sizeof(bench_err)));
    for (size_t i = 0; i < bench_chip->kind->n_inputs; i++) {
        bench_set(bench_chip->kind->inputs[i].name, bench_chip->kind->inputs[i].at_first);
    }
    bench_set("dead", 0);
    bench_mode = 3;
    if (bench_chip->kind->bus == CHIP_SPI) {
        bench_select(false);
    }
    chip_power(bench_chip, bench_ns, false);
    chip_power(bench_chip, bench_ns, true);
    bench_wait_ms(10);
    bench_chip->wrong[0] = '\0';
}

static void rubbish_for_a_max31865(void)
{
    uint8_t bytes[2];
    send_rubbish("max31865", 0);
    bench_set("temperature", 0);
    bench_spi_put(0x80, 0x81);
    bench_wait_ms(10);
    bench_spi_put(0x80, 0xA1);
    bench_wait_ms(66);
    bench_spi_read(0x01, bytes, 2);
    TEST_ASSERT_INT_WITHIN(1, 7621, (bytes[0] << 8 | bytes[1]) >> 1); /* 100 of 430 ohm */
    bench_expect_right();
    bench_free();
}

static void rubbish_for_a_max31856(void)
{
    uint8_t bytes[3];
    send_rubbish("max31856", 0);
    bench_set("temperature", 100);
    bench_spi_put(0x80, 0x41);
    bench_wait_ms(186);
    bench_spi_read(0x0C, bytes, 3);
    TEST_ASSERT_EQUAL_HEX8(0x06, bytes[0]);
    TEST_ASSERT_EQUAL_HEX8(0x40, bytes[1]);
    bench_expect_right();
    bench_free();
}

static void rubbish_for_a_ds18b20(void)
{
    unsigned code = 0;
    static const uint8_t words[2][2] = {{0xCC, 0x44}, {0xCC, 0xBE}};
    send_rubbish("ds18b20", 0);
    for (unsigned part = 0; part < 2; part++) {
        bench_ns += 1000000;
        TEST_ASSERT_EQUAL_INT(CHIPS_ANSWER, chips_reset(bench_bus, bench_ns));
        for (unsigned i = 0; i < 16; i++) {
            bench_ns += 70000;
            (void)chips_slot(bench_bus, bench_ns, ((unsigned)words[part][i / 8] >> (i % 8)) & 1u);
        }
        bench_wait_ms(part == 0 ? 750 : 0);
    }
    for (unsigned i = 0; i < 16; i++) {
        bench_ns += 70000;
        code |= (unsigned)chips_slot(bench_bus, bench_ns, true) << i;
    }
    TEST_ASSERT_EQUAL_HEX16(0x0140, code);
    bench_expect_right();
    bench_free();
}

static void rubbish_for_an_ads1115(void)
{
    static const uint8_t shot[3] = {1, 0xC5, 0x83};
    uint8_t bytes[2];
    send_rubbish("ads1115", 0x48);
    bench_set("in0", 1.024);
    TEST_ASSERT_TRUE(bench_i2c_write(0x48, shot, 3));
    bench_wait_ms(9);
    TEST_ASSERT_TRUE(bench_i2c_read(0x48, 0, bytes, 2));
    TEST_ASSERT_EQUAL_HEX16(0x4000, bytes[0] << 8 | bytes[1]);
    bench_expect_right();
    bench_free();
}

static void rubbish_for_barometers(void)
{
    static const char *const kinds[2] = {"bme280", "bmp280"};
    for (unsigned i = 0; i < 2; i++) {
        uint8_t id;
        send_rubbish(kinds[i], 0x76);
        TEST_ASSERT_TRUE(bench_i2c_read(0x76, 0xD0, &id, 1));
        TEST_ASSERT_EQUAL_HEX8(i == 0 ? 0x60 : 0x58, id);
        bench_expect_right();
        bench_free();
    }
}

static void rubbish_for_an_xgzp6897(void)
{
    static const uint8_t once[2] = {0x30, 0x0A};
    uint8_t bytes[3];
    send_rubbish("xgzp6897", 0x6D);
    bench_set("pressure", 1);
    TEST_ASSERT_TRUE(bench_i2c_write(0x6D, once, 2));
    bench_wait_ms(20);
    TEST_ASSERT_TRUE(bench_i2c_read(0x6D, 0x06, bytes, 3));
    TEST_ASSERT_EQUAL_HEX16(0x1000, bytes[1] << 8 | bytes[2]);
    bench_expect_right();
    bench_free();
}

static void rubbish_for_an_ad5422(void)
{
    send_rubbish("ad5422", 0);
    static const uint8_t reset[2] = {0, 1}, range[2] = {0x10, 0x05}, half[2] = {0x80, 0};
    bench_spi_write(0x56, reset, 2);
    bench_spi_write(0x55, range, 2);
    bench_wait_us(5);
    bench_spi_write(0x01, half, 2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 12.0, chip_drives(bench_chip, bench_ns));
    bench_expect_right();
    bench_free();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(rubbish_for_a_max31865);
    RUN_TEST(rubbish_for_a_max31856);
    RUN_TEST(rubbish_for_a_ds18b20);
    RUN_TEST(rubbish_for_an_ads1115);
    RUN_TEST(rubbish_for_barometers);
    RUN_TEST(rubbish_for_an_xgzp6897);
    RUN_TEST(rubbish_for_an_ad5422);
    return UNITY_END();
}
